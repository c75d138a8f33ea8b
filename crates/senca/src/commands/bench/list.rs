//! The benchmarks.

use std::sync::Arc;

use senca::Image;
use senca::io::NoFiles;
use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::math::glam::Vec4;
use senca::raster::{
    Buffers, Clear, ColorSource, FixedShading, Ids, Primitives, Rasterizer, Sampler, ScanlineRasterizer,
    Shading, State, Texels, Texture, TextureUnit, TiledRasterizer,
};
use senca::scene::{Shape, TessellationSettings, Tolerance, tessellate};

use super::data::{BumpySphere, busy_pixels, clip_from_world, tilted_square};
use super::measure::Run;
use crate::cli::Failure;

/// Side of the pictures that are drawn and encoded.
const SIDE: u32 = 1024;
/// Megapixels of such a picture.
const MEGAPIXELS: f64 = (SIDE * SIDE) as f64 / 1e6;
/// Times a square is drawn over itself in one run.
const LAYERS: usize = 8;

/// Something to measure.
#[derive(Debug)]
pub(super) struct Benchmark {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    /// What `work` counts.
    pub(super) unit: &'static str,
    /// Units of work in one run.
    pub(super) work: f64,
    /// Whether there is a plain form to compare with.
    pub(super) has_plain_twin: bool,
    /// Makes the data and gives what is run.
    pub(super) prepare: fn(Form) -> Result<Box<Run<'static>>, Failure>,
}

/// Which of the two forms is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// The one that is used.
    Fast,
    /// The textbook's.
    Plain,
}

/// All of them.
pub(super) const ALL: &[Benchmark] = &[
    Benchmark {
        name: "mesh",
        about: "70 k Gouraud triangles at 1024x1024, from indexed arrays",
        unit: "frames",
        work: 1.0,
        has_plain_twin: true,
        prepare: mesh,
    },
    Benchmark {
        name: "fill",
        about: "Gouraud squares over the whole of 1024x1024",
        unit: "Mpixel",
        work: MEGAPIXELS * LAYERS as f64,
        has_plain_twin: true,
        prepare: fill,
    },
    Benchmark {
        name: "texture",
        about: "the same with a trilinear texture in perspective",
        unit: "Mpixel",
        work: MEGAPIXELS * LAYERS as f64,
        has_plain_twin: true,
        prepare: texture,
    },
    Benchmark {
        name: "obj",
        about: "the text of a 70 k triangle OBJ file into a scene",
        unit: "Mtriangle",
        work: 0.069_696,
        has_plain_twin: false,
        prepare: obj,
    },
    Benchmark {
        name: "tessellate",
        about: "a torus into 262 144 triangles with normals",
        unit: "Mtriangle",
        work: 0.262_144,
        has_plain_twin: false,
        prepare: torus,
    },
    Benchmark {
        name: "png",
        about: "a busy 1024x1024 picture encoded as PNG",
        unit: "Mpixel",
        work: MEGAPIXELS,
        has_plain_twin: false,
        prepare: png,
    },
];

fn rasterizer(form: Form) -> Box<dyn Rasterizer + Send> {
    match form {
        Form::Fast => Box::new(TiledRasterizer::default()),
        Form::Plain => Box::new(ScanlineRasterizer),
    }
}

const CLEAR: Clear = Clear { color: Some([0.0, 0.0, 0.0, 1.0]), depth: Some(1.0), id: None, stencil: None };

fn mesh(form: Form) -> Result<Box<Run<'static>>, Failure> {
    let sphere = BumpySphere::new();
    let clip_from_world = clip_from_world().map_err(Failure::input)?;
    let positions: Vec<Vec4> = sphere.points.iter().map(|p| clip_from_world * p.extend(1.0)).collect();
    let varyings: Vec<f32> = sphere.normals.iter().flat_map(|n| (n * 0.5 + 0.5).to_array()).collect();
    let mut rasterizer = rasterizer(form);
    let mut buffers = Buffers::new(SIDE, SIDE);
    Ok(Box::new(move || {
        let primitives = Primitives {
            positions: &positions,
            varyings: &varyings,
            stride: 3,
            indices: &sphere.triangles,
            ids: Ids::From(0),
        };
        let state = State { clear: Some(CLEAR), ..State::default() };
        draw(&mut *rasterizer, &mut buffers, &primitives, &state, &Shading::vertex_rgb());
    }))
}

fn fill(form: Form) -> Result<Box<Run<'static>>, Failure> {
    let varyings = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    squares(form, varyings, 3, None)
}

fn texture(form: Form) -> Result<Box<Run<'static>>, Failure> {
    let texture = Texture::new(512, 512, Texels::Rgba32F(busy_pixels(512))).map_err(Failure::input)?;
    let varyings = vec![0.0, 4.0, 4.0, 4.0, 4.0, 0.0, 0.0, 0.0];
    squares(form, varyings, 2, Some(Arc::new(texture.with_mipmaps())))
}

/// Draws [`LAYERS`] squares over the whole picture.
fn squares(
    form: Form,
    varyings: Vec<f32>,
    stride: usize,
    texture: Option<Arc<Texture>>,
) -> Result<Box<Run<'static>>, Failure> {
    let positions = tilted_square();
    let indices: Vec<u32> = [0, 1, 2, 0, 2, 3].repeat(LAYERS);
    let mut rasterizer = rasterizer(form);
    let mut buffers = Buffers::new(SIDE, SIDE);
    Ok(Box::new(move || {
        let primitives = Primitives {
            positions: &positions,
            varyings: &varyings,
            stride,
            indices: &indices,
            ids: Ids::From(0),
        };
        let unit = |texture| TextureUnit { texture, sampler: Sampler::TRILINEAR, coords: 0 };
        let shading = match &texture {
            None => Shading::vertex_rgb(),
            Some(texture) => {
                Shading::Fixed(FixedShading::textured(ColorSource::Constant([1.0; 4]), unit(texture)))
            }
        };
        let state = State { depth_test: senca::raster::Compare::Always, ..State::default() };
        draw(&mut *rasterizer, &mut buffers, &primitives, &state, &shading);
    }))
}

fn draw(
    rasterizer: &mut dyn Rasterizer,
    buffers: &mut Buffers,
    primitives: &Primitives<'_>,
    state: &State,
    shading: &Shading<'_>,
) {
    // The buffers were made for this size and stay so.
    if let Ok(mut target) = buffers.target() {
        std::hint::black_box(rasterizer.draw(&mut target, primitives, state, shading));
    }
}

fn obj(_: Form) -> Result<Box<Run<'static>>, Failure> {
    let text = BumpySphere::new().obj();
    Ok(Box::new(move || {
        let scene = senca::io::obj::read("sphere.obj", text.as_bytes(), &NoFiles);
        drop(std::hint::black_box(scene));
    }))
}

fn torus(_: Form) -> Result<Box<Run<'static>>, Failure> {
    let shape = Shape::Torus { major_radius: 2.0, minor_radius: 0.5 };
    let settings = TessellationSettings { tolerance: Tolerance::Steps(512, 256), ..Default::default() };
    Ok(Box::new(move || drop(std::hint::black_box(tessellate(&shape, &settings)))))
}

fn png(_: Form) -> Result<Box<Run<'static>>, Failure> {
    let image =
        Image::from_pixels(SIDE, SIDE, busy_pixels(SIDE)).ok_or_else(|| Failure::input("no picture"))?;
    Ok(Box::new(move || {
        let bytes = encode(&image, PictureFormat::Png, &PictureOptions::default());
        drop(std::hint::black_box(bytes));
    }))
}
