//! Time per stage of the rasterizers, on data made here from a fixed seed.
//!
//!     cargo bench -p senca-raster

use divan::{Bencher, counter::ItemsCount};
use senca_math::glam::Vec4;
use senca_raster::{
    Clear, ColorPlane, ColorSource, Compare, FixedShading, FragmentShader, Fragments, Ids, Primitives,
    Rasterizer, Sampler, ScanlineRasterizer, Shaded, Shading, SimdLevel, State, Target, Texels, Texture,
    TextureUnit, TiledRasterizer, TiledSettings, clip,
};

const SIDE: u32 = 1024;

fn main() {
    divan::main();
}

/// A sheet of `cells * cells * 2` triangles over the target, its depth waving.
struct Sheet {
    positions: Vec<Vec4>,
    varyings: Vec<f32>,
    indices: Vec<u32>,
}

impl Sheet {
    fn new(cells: u32) -> Self {
        let mut sheet = Self { positions: Vec::new(), varyings: Vec::new(), indices: Vec::new() };
        let mut seed = 1u32;
        for i in 0..(cells + 1) * (cells + 1) {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let jitter = (seed >> 8) as f32 / (1u32 << 24) as f32;
            let (x, y) = ((i % (cells + 1)) as f32 / cells as f32, (i / (cells + 1)) as f32 / cells as f32);
            let w = 1.0 + y;
            sheet.positions.push(Vec4::new(
                (2.0 * x - 1.0) * w,
                (2.0 * y - 1.0) * w,
                (0.3 + 0.4 * jitter) * w,
                w,
            ));
            sheet.varyings.extend([x, y, jitter, 4.0 * x, 4.0 * y]);
        }
        for y in 0..cells {
            for x in 0..cells {
                let a = y * (cells + 1) + x;
                sheet.indices.extend([a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1]);
            }
        }
        sheet
    }

    fn primitives(&self) -> Primitives<'_> {
        Primitives {
            positions: &self.positions,
            varyings: &self.varyings,
            stride: 5,
            indices: &self.indices,
            ids: Ids::From(0),
        }
    }

    /// Draws the sheet, clearing first, with what the bencher repeats.
    fn bench(
        &self,
        bencher: Bencher<'_, '_>,
        rasterizer: &mut dyn Rasterizer,
        shading: &Shading<'_>,
        state: State,
    ) {
        let (mut color, mut depth) =
            (vec![[0u8; 4]; (SIDE * SIDE) as usize], vec![1f32; (SIDE * SIDE) as usize]);
        let state = State { clear: Some(Clear::default()), ..state };
        bencher.counter(ItemsCount::new(self.indices.len() / 3)).bench_local(|| {
            let target = Target::new(SIDE, SIDE)
                .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
                .and_then(|t| t.with_depth(&mut depth));
            let mut target = target.expect("planes are as large as the target");
            rasterizer.draw(&mut target, &self.primitives(), &state, shading)
        });
    }
}

fn tiled(threads: usize) -> TiledRasterizer {
    TiledRasterizer::new(TiledSettings { threads, ..TiledSettings::default() })
}

/// Triangles 4, 20 and 500 pixels wide.
const CELLS: [u32; 3] = [256, 50, 2];

#[divan::bench(args = CELLS)]
fn depth_only(bencher: Bencher<'_, '_>, cells: u32) {
    Sheet::new(cells).bench(bencher, &mut tiled(1), &Shading::None, State::default());
}

#[divan::bench(args = CELLS)]
fn vertex_color(bencher: Bencher<'_, '_>, cells: u32) {
    Sheet::new(cells).bench(bencher, &mut tiled(1), &Shading::vertex_rgb(), State::default());
}

#[divan::bench(args = CELLS)]
fn vertex_color_two_threads(bencher: Bencher<'_, '_>, cells: u32) {
    Sheet::new(cells).bench(bencher, &mut tiled(2), &Shading::vertex_rgb(), State::default());
}

#[divan::bench(args = CELLS)]
fn vertex_color_baseline_level(bencher: Bencher<'_, '_>, cells: u32) {
    let mut plain = TiledRasterizer::new(TiledSettings { threads: 1, level: SimdLevel::baseline() });
    Sheet::new(cells).bench(bencher, &mut plain, &Shading::vertex_rgb(), State::default());
}

#[divan::bench(args = CELLS)]
fn vertex_color_scanline(bencher: Bencher<'_, '_>, cells: u32) {
    Sheet::new(cells).bench(bencher, &mut ScanlineRasterizer, &Shading::vertex_rgb(), State::default());
}

#[divan::bench(args = CELLS)]
fn bin_only(bencher: Bencher<'_, '_>, cells: u32) {
    // Everything is set up and binned, nothing passes.
    let state = State { depth_test: Compare::Never, ..State::default() };
    Sheet::new(cells).bench(bencher, &mut tiled(1), &Shading::None, state);
}

fn trilinear_of(bencher: Bencher<'_, '_>, cells: u32, rasterizer: &mut dyn Rasterizer, texels: Texels) {
    let texture = Texture::new(256, 256, texels).expect("sides and count fit").with_mipmaps();
    let unit = TextureUnit { texture: &texture, sampler: Sampler::TRILINEAR, coords: 3 };
    let shading = Shading::Fixed(FixedShading::textured(ColorSource::Rgb { first: 0 }, unit));
    Sheet::new(cells).bench(bencher, rasterizer, &shading, State::default());
}

fn texels() -> Vec<[u8; 4]> {
    (0..256u32 * 256).map(|i| [(i % 256) as u8, (i / 256) as u8, (i % 13 * 19) as u8, 255]).collect()
}

fn float_texels() -> Texels {
    Texels::Rgba32F(texels().into_iter().map(|t| t.map(|v| f32::from(v) / 255.0)).collect())
}

#[divan::bench(args = CELLS)]
fn trilinear(bencher: Bencher<'_, '_>, cells: u32) {
    trilinear_of(bencher, cells, &mut tiled(1), Texels::Rgba8(texels()));
}

#[divan::bench(args = CELLS)]
fn trilinear_srgb(bencher: Bencher<'_, '_>, cells: u32) {
    trilinear_of(bencher, cells, &mut tiled(1), Texels::Srgb8(texels()));
}

#[divan::bench(args = CELLS)]
fn trilinear_float(bencher: Bencher<'_, '_>, cells: u32) {
    trilinear_of(bencher, cells, &mut tiled(1), float_texels());
}

#[divan::bench(args = CELLS)]
fn trilinear_srgb_scanline(bencher: Bencher<'_, '_>, cells: u32) {
    trilinear_of(bencher, cells, &mut ScanlineRasterizer, Texels::Srgb8(texels()));
}

#[divan::bench(args = CELLS)]
fn trilinear_float_scanline(bencher: Bencher<'_, '_>, cells: u32) {
    trilinear_of(bencher, cells, &mut ScanlineRasterizer, float_texels());
}

/// A caller's shader: a little arithmetic per fragment.
struct Stripes;

impl FragmentShader for Stripes {
    fn shade(&self, f: &Fragments<'_>, out: &mut Shaded) {
        for i in 0..senca_raster::LANES {
            let v = f.varyings[3][i] * 8.0;
            let s = v - v.floor();
            (out.rgba[0][i], out.rgba[1][i], out.rgba[2][i]) = (s, s * f.varyings[0][i], 1.0 - s);
        }
    }
}

#[divan::bench(args = CELLS)]
fn custom_shader(bencher: Bencher<'_, '_>, cells: u32) {
    Sheet::new(cells).bench(bencher, &mut tiled(1), &Shading::Custom(&Stripes), State::default());
}

/// A square of 10 x 10 pixels into a target that is kept.
#[divan::bench]
fn one_small_square(bencher: Bencher<'_, '_>) {
    let at = |x: f32, y: f32| Vec4::new(x / 512.0 - 1.0, 1.0 - y / 512.0, 0.5, 1.0);
    let positions = [at(100.0, 100.0), at(110.0, 100.0), at(110.0, 110.0), at(100.0, 110.0)];
    let varyings = [0.5; 12];
    let p = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 3,
        indices: &[0, 1, 2, 0, 2, 3],
        ids: Ids::Same(0),
    };
    let pixels = (SIDE * SIDE) as usize;
    let (mut color, mut depth) = (vec![[0u8; 4]; pixels], vec![1f32; pixels]);
    let mut rasterizer = TiledRasterizer::default();
    let state = State { depth_test: Compare::LessEqual, ..State::default() };
    bencher.bench_local(|| {
        let target = Target::new(SIDE, SIDE)
            .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
            .and_then(|t| t.with_depth(&mut depth));
        let mut target = target.expect("planes are as large as the target");
        rasterizer.draw(&mut target, &p, &state, &Shading::vertex_rgb())
    });
}

#[divan::bench]
fn clip_one_triangle(bencher: Bencher<'_, '_>) {
    let corners =
        [Vec4::new(0.0, 0.0, -0.5, 1.0), Vec4::new(2.0, 0.0, 0.5, 1.0), Vec4::new(0.0, 3.0, 0.5, 2.0)];
    bencher.bench(|| clip::clip_triangle(divan::black_box(corners), &clip::VIEW_VOLUME).vertices().len());
}
