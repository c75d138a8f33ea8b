//! The workloads a peer's OpenGL library is measured with, drawn by this crate: frames per second, and
//! pixels filled, as CSV.
//!
//!     cargo run --release -p senca-raster --example peer -- bunny.obj [--threads N] [--seconds S]
//!         [--reps N] [--only NAME] [--ppm DIR]
//!
//! A frame is everything the peer does: vertices transformed and lit, target cleared, triangles drawn.
#![expect(clippy::print_stdout, reason = "a program for the terminal")]

use rayon::prelude::*;
use senca_math::glam::{Mat4, Vec3, Vec4};
use senca_raster::{
    Clear, ColorPlane, ColorSource, Compare, FixedShading, Ids, Primitives, Rasterizer, Sampler, Shading,
    State, Target, Texels, Texture, TextureUnit, TiledRasterizer, TiledSettings,
};
use std::time::Instant;

const SIDE: u32 = 1024;

struct Options {
    obj: String,
    threads: usize,
    seconds: f64,
    reps: usize,
    only: Option<String>,
    ppm: Option<String>,
}

fn options() -> Option<Options> {
    let mut o = Options { obj: String::new(), threads: 0, seconds: 1.0, reps: 5, only: None, ppm: None };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--threads" => o.threads = words.next()?.parse().ok()?,
            "--seconds" => o.seconds = words.next()?.parse().ok()?,
            "--reps" => o.reps = words.next()?.parse().ok().filter(|n| *n > 0)?,
            "--only" => o.only = words.next(),
            "--ppm" => o.ppm = words.next(),
            _ => o.obj = word,
        }
    }
    (!o.obj.is_empty()).then_some(o)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let o = options()
        .ok_or("usage: peer FILE.obj [--threads N] [--seconds S] [--reps N] [--only NAME] [--ppm DIR]")?;
    let mesh = Mesh::load(&std::fs::read_to_string(&o.obj)?);
    let workloads: [(&str, f64, Box<dyn Workload>); 5] = [
        ("mesh_va_1024", 0.0, Box::new(LitMesh::new(mesh))),
        ("fill_gouraud_x16", 16.0, Box::new(Quads::gouraud())),
        ("tex_bilinear_x8", 8.0, Box::new(Quads::textured(Sampler::BILINEAR, false))),
        ("tex_trilinear_x8", 8.0, Box::new(Quads::textured(Sampler::TRILINEAR, false))),
        ("tex_trilinear_z_x8", 8.0, Box::new(Quads::textured(Sampler::TRILINEAR, true))),
    ];
    println!("label,workload,width,height,fps_median,fps_min,fps_max,mpixels_s");
    for (name, layers, mut workload) in workloads {
        if o.only.as_ref().is_none_or(|only| name.starts_with(only.as_str())) {
            measure(&o, name, layers, &mut *workload)?;
        }
    }
    Ok(())
}

fn measure(o: &Options, name: &str, layers: f64, workload: &mut dyn Workload) -> std::io::Result<()> {
    let mut rasterizer =
        TiledRasterizer::new(TiledSettings { threads: o.threads, ..TiledSettings::default() });
    let mut planes =
        Planes { color: vec![[0; 4]; (SIDE * SIDE) as usize], depth: vec![0.0; (SIDE * SIDE) as usize] };
    for frame in 0..3 {
        workload.draw(frame, &mut rasterizer, &mut planes);
    }
    let (mut rates, mut frame) = (Vec::new(), 2);
    for _ in 0..o.reps {
        let (start, first) = (Instant::now(), frame);
        while start.elapsed().as_secs_f64() < o.seconds / o.reps as f64 {
            workload.draw(frame, &mut rasterizer, &mut planes);
            frame += 1;
        }
        rates.push(f64::from(frame - first) / start.elapsed().as_secs_f64());
    }
    rates.sort_by(f64::total_cmp);
    let (median, low, high) = (rates[rates.len() / 2], rates[0], rates[rates.len() - 1]);
    let filled = median * layers * f64::from(SIDE * SIDE) * 1e-6;
    println!("senca-{}t,{name},{SIDE},{SIDE},{median:.3},{low:.3},{high:.3},{filled:.1}", o.threads);
    if let Some(dir) = &o.ppm {
        workload.draw(7, &mut rasterizer, &mut planes);
        let mut file = format!("P6\n{SIDE} {SIDE}\n255\n").into_bytes();
        file.extend(planes.color.iter().flat_map(|p| [p[0], p[1], p[2]]));
        std::fs::write(format!("{dir}/{name}.ppm"), file)?;
    }
    Ok(())
}

struct Planes {
    color: Vec<[u8; 4]>,
    depth: Vec<f32>,
}

impl Planes {
    fn target(&mut self, depth: bool) -> Target<'_> {
        let target = Target::new(SIDE, SIDE).and_then(|t| t.with_color(ColorPlane::Rgba8(&mut self.color)));
        let target = if depth { target.and_then(|t| t.with_depth(&mut self.depth)) } else { target };
        target.expect("planes are as large as the target")
    }
}

const BACKGROUND: [f32; 4] = [0.05, 0.05, 0.1, 1.0];

trait Workload {
    fn draw(&mut self, frame: u32, rasterizer: &mut TiledRasterizer, planes: &mut Planes);
}

/// Triangles with normals, fitted into [-1, 1].
#[derive(Default)]
struct Mesh {
    points: Vec<Vec3>,
    normals: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Mesh {
    fn load(text: &str) -> Self {
        let mut mesh = Self::default();
        for line in text.lines() {
            let mut words = line.split_ascii_whitespace();
            match words.next() {
                Some("v") => {
                    let mut number = || words.next().and_then(|w| w.parse().ok()).unwrap_or(0.0);
                    mesh.points.push(Vec3::new(number(), number(), number()));
                }
                Some("f") => {
                    let corner =
                        |w: &str| w.split('/').next().and_then(|n| n.parse::<u32>().ok()).map(|n| n - 1);
                    let corners: Vec<u32> = words.filter_map(corner).collect();
                    for k in 2..corners.len() {
                        mesh.indices.extend([corners[0], corners[k - 1], corners[k]]);
                    }
                }
                _ => {}
            }
        }
        mesh.fit();
        mesh.normals = mesh.vertex_normals();
        mesh
    }

    fn fit(&mut self) {
        let low = self.points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = self.points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let scale = 2.0 / (high - low).max_element();
        self.points.iter_mut().for_each(|p| *p = (*p - 0.5 * (low + high)) * scale);
    }

    fn vertex_normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.points.len()];
        for t in self.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| self.points[i as usize]);
            t.iter().for_each(|&i| normals[i as usize] += (b - a).cross(c - a));
        }
        normals.into_iter().map(Vec3::normalize_or_zero).collect()
    }
}

/// The projection with z in [0, w] of what OpenGL's glFrustum sees.
fn perspective(fov_y: f32, near: f32, far: f32) -> Mat4 {
    let t = near * (fov_y.to_radians() * 0.5).tan();
    Mat4::from_cols(
        Vec4::new(near / t, 0.0, 0.0, 0.0),
        Vec4::new(0.0, near / t, 0.0, 0.0),
        Vec4::new(0.0, 0.0, far / (near - far), -1.0),
        Vec4::new(0.0, 0.0, far * near / (near - far), 0.0),
    )
}

/// Vertices done together: points, normals, and where positions and colours go.
type Part<'a> = (((&'a [Vec3], &'a [Vec3]), &'a mut [Vec4]), &'a mut [f32]);

/// A mesh lit per vertex in every frame, as fixed-function OpenGL lights it.
struct LitMesh {
    mesh: Mesh,
    positions: Vec<Vec4>,
    colors: Vec<f32>,
}

impl LitMesh {
    fn new(mesh: Mesh) -> Self {
        let (positions, colors) = (vec![Vec4::ZERO; mesh.points.len()], vec![0.0; 3 * mesh.points.len()]);
        Self { mesh, positions, colors }
    }

    fn vertices(&mut self, frame: u32, threads: usize) {
        let view_from_object = Mat4::from_translation(Vec3::new(0.0, 0.0, -3.6))
            * Mat4::from_rotation_x(15f32.to_radians())
            * Mat4::from_rotation_y((5.0 * frame as f32).to_radians());
        let clip_from_object = perspective(40.0, 1.0, 10.0) * view_from_object;
        let light = Vec3::new(0.4, 0.6, 0.8).normalize();
        let half = (light + Vec3::Z).normalize();
        let color = Vec3::new(0.7, 0.6, 0.5);
        let step = 2048;
        let lit = |(((points, normals), positions), colors): Part<'_>| {
            let colors = colors.chunks_exact_mut(3);
            for (((point, normal), position), out) in points.iter().zip(normals).zip(positions).zip(colors) {
                *position = clip_from_object * point.extend(1.0);
                let normal = view_from_object.transform_vector3(*normal);
                let diffuse = normal.dot(light).max(0.0);
                let shine = if diffuse > 0.0 { normal.dot(half).max(0.0).powi(32) } else { 0.0 };
                let c = color * (0.3 + 0.9 * diffuse) + 0.5 * shine;
                out.copy_from_slice(&c.min(Vec3::ONE).to_array());
            }
        };
        let (points, normals) = (self.mesh.points.chunks(step), self.mesh.normals.chunks(step));
        if threads == 1 {
            let positions = self.positions.chunks_mut(step);
            points.zip(normals).zip(positions).zip(self.colors.chunks_mut(3 * step)).for_each(lit);
        } else {
            let (points, normals) = (self.mesh.points.par_chunks(step), self.mesh.normals.par_chunks(step));
            let positions = self.positions.par_chunks_mut(step);
            points.zip(normals).zip(positions).zip(self.colors.par_chunks_mut(3 * step)).for_each(lit);
        }
    }
}

impl Workload for LitMesh {
    fn draw(&mut self, frame: u32, rasterizer: &mut TiledRasterizer, planes: &mut Planes) {
        self.vertices(frame, rasterizer.settings().threads);
        let primitives = Primitives {
            positions: &self.positions,
            varyings: &self.colors,
            stride: 3,
            indices: &self.mesh.indices,
            ids: Ids::From(0),
        };
        let state =
            State { clear: Some(Clear { color: Some(BACKGROUND), ..Clear::default() }), ..State::default() };
        rasterizer.draw(&mut planes.target(true), &primitives, &state, &Shading::vertex_rgb());
    }
}

/// Layers of rectangles over the whole target.
struct Quads {
    positions: Vec<Vec4>,
    varyings: Vec<f32>,
    indices: Vec<u32>,
    texture: Option<(Texture, Sampler)>,
    depth: bool,
}

impl Quads {
    fn empty(layers: u32) -> Self {
        let quad = |n: u32| [0, 1, 2, 0, 2, 3].map(|k| 4 * n + k);
        let indices = (0..layers).flat_map(quad).collect();
        Self { positions: Vec::new(), varyings: Vec::new(), indices, texture: None, depth: false }
    }

    fn gouraud() -> Self {
        Self::empty(16)
    }

    fn textured(sampler: Sampler, depth: bool) -> Self {
        let side = 512u32;
        let texel = |i: u32| {
            let (x, y) = (i % side, i / side);
            let light = ((x >> 5) ^ (y >> 5)) & 1 == 1;
            [if light { 230 } else { 40 }, (x * 255 / side) as u8, (y * 255 / side) as u8, 255]
        };
        let texels = Texels::Rgba8((0..side * side).map(texel).collect());
        let texture = Texture::new(side, side, texels).expect("sides and count fit").with_mipmaps();
        Self { texture: Some((texture, sampler)), depth, ..Self::empty(8) }
    }

    fn colored_layers(&mut self, frame: u32) {
        for layer in 0..16u32 {
            let k = 0.013 * ((layer + frame) % 16) as f32;
            for (x, y, red, green, blue) in [
                (-1.0, -1.0, 0.2, 0.1 + k, 0.8 - k),
                (1.0, -1.0, 0.9, 0.1 + k, 0.5 - k),
                (1.0, 1.0, 0.9, 0.5 + k, 0.2 - k),
                (-1.0, 1.0, 0.2, 0.5 + k, 0.5 - k),
            ] {
                self.positions.push(Vec4::new(x, y, 0.5, 1.0));
                self.varyings.extend([red, green, blue, 1.0]);
            }
        }
    }

    fn textured_layers(&mut self, frame: u32) {
        for i in 0..8u32 {
            let (o, s) = (0.01 * (frame + 7 * i) as f32, 1.0 + 0.25 * i as f32);
            let far = 3.0 + 0.5 * i as f32;
            for (x, y, w) in [(-1.0, -1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, far), (-1.0, 1.0, far)] {
                self.positions.push(Vec4::new(x * w, y * w, 0.5 * w, w));
                self.varyings.extend([o + 0.5 * s * x * w, o + s * w]);
            }
        }
    }
}

impl Workload for Quads {
    fn draw(&mut self, frame: u32, rasterizer: &mut TiledRasterizer, planes: &mut Planes) {
        self.positions.clear();
        self.varyings.clear();
        let (stride, shading) = if self.texture.is_some() {
            self.textured_layers(frame);
            let (texture, sampler) = self.texture.as_ref().expect("checked above");
            let unit = TextureUnit { texture, sampler: *sampler, coords: 0 };
            (2, Shading::Fixed(FixedShading::textured(ColorSource::Constant([1.0, 1.0, 0.7, 1.0]), unit)))
        } else {
            self.colored_layers(frame);
            (4, Shading::Fixed(FixedShading::new(ColorSource::Rgba { first: 0 })))
        };
        let primitives = Primitives {
            positions: &self.positions,
            varyings: &self.varyings,
            stride,
            indices: &self.indices,
            ids: Ids::From(0),
        };
        let state = State {
            depth_test: if self.depth { Compare::LessEqual } else { Compare::Always },
            clear: Some(Clear { color: Some(BACKGROUND), ..Clear::default() }),
            ..State::default()
        };
        rasterizer.draw(&mut planes.target(self.depth), &primitives, &state, &shading);
    }
}
