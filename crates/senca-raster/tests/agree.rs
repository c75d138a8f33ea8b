//! The two rasterizers draw the same pictures, whatever the vector instructions and the threads.

use senca_math::glam::Vec4;
use senca_raster::{
    AlphaTest, Blend, BlockDepths, Buffers, Clear, ColorPlane, ColorSource, Compare, Counters, CubeTexture,
    CubeUnit, Cull, DepthBias, Filter, FixedShading, FragmentShader, Fragments, Ids, Interpolation, Mip,
    Primitives, Rasterizer, Rect, Sampler, ScanlineRasterizer, Shaded, Shading, ShadowUnit, SimdLevel, State,
    Target, Texels, Texture, TextureUnit, TiledRasterizer, TiledSettings, Viewport,
};

/// Numbers in [0, 1), the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

struct Mesh {
    positions: Vec<Vec4>,
    varyings: Vec<f32>,
    indices: Vec<u32>,
}

const STRIDE: usize = 4;

impl Mesh {
    /// Triangles of all sizes, some across the near plane, behind the eye, or far outside.
    fn random(seed: u64, triangles: usize) -> Self {
        let mut r = Random(seed);
        let mut mesh = Self { positions: Vec::new(), varyings: Vec::new(), indices: Vec::new() };
        for n in 0..triangles {
            let size = [0.02, 0.1, 0.5, 3.0, 300.0][n % 5];
            let (x, y) = (r.within(-1.3, 1.3), r.within(-1.3, 1.3));
            for k in 0..3 {
                let w = if n % 3 == 0 { 1.0 } else { r.within(-0.3, 3.0) };
                let z = r.within(-0.1, 1.1) * w;
                let (dx, dy) = (r.within(-size, size), r.within(-size, size));
                mesh.positions.push(Vec4::new((x + dx) * w, (y + dy) * w, z, w));
                mesh.varyings.extend([r.next(), r.next(), r.next(), r.next()]);
                mesh.indices.push((3 * n + k) as u32);
            }
        }
        mesh
    }

    fn primitives(&self) -> Primitives<'_> {
        Primitives {
            positions: &self.positions,
            varyings: &self.varyings,
            stride: STRIDE,
            indices: &self.indices,
            ids: Ids::From(0),
        }
    }
}

fn levels() -> Vec<SimdLevel> {
    let best = SimdLevel::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        use senca_raster::simd::Simd;
        let all = [
            best.as_sse2().map(|s| s.level()),
            best.as_sse4_2().map(|s| s.level()),
            best.as_avx2().map(|s| s.level()),
            best.as_avx512().map(|s| s.level()),
        ];
        all.into_iter().flatten().collect()
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    vec![best]
}

fn tiled(threads: usize, level: SimdLevel) -> TiledRasterizer {
    TiledRasterizer::new(TiledSettings { threads, level })
}

fn draw(
    rasterizer: &mut dyn Rasterizer,
    size: [u32; 2],
    mesh: &Mesh,
    state: &State,
    shading: &Shading<'_>,
) -> (Buffers, Counters) {
    let mut buffers = Buffers::with_ids(size[0], size[1]);
    let counters = rasterizer.draw(&mut buffers.target().unwrap(), &mesh.primitives(), state, shading);
    (buffers, counters)
}

fn bits(buffers: &Buffers) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let color = buffers.color.pixels().iter().flatten().map(|v| v.to_bits()).collect();
    (color, buffers.depth.iter().map(|v| v.to_bits()).collect(), buffers.ids.clone())
}

const SIZES: [[u32; 2]; 9] =
    [[1, 1], [1, 37], [53, 1], [7, 9], [64, 64], [65, 63], [129, 200], [333, 77], [1021, 5]];

fn states() -> Vec<State> {
    let plain = State::default();
    vec![
        plain,
        State { cull: Cull::Back, interpolation: Interpolation::Screen, ..plain },
        State { cull: Cull::Front, depth_test: Compare::LessEqual, ..plain },
        State { depth_test: Compare::Always, blend: Some(Blend::OVER), ..plain },
        State {
            depth_test: Compare::GreaterEqual,
            clear: Some(Clear { depth: Some(0.0), ..Clear::default() }),
            ..plain
        },
        State { interpolation: Interpolation::FlatFirst, depth_range: [0.25, 0.75], ..plain },
        State { interpolation: Interpolation::FlatLast, depth_write: false, ..plain },
        State { depth_bias: DepthBias { constant: 0.01, slope: 1.5 }, ..plain },
        State {
            viewport: Some(Viewport { x: 3.5, y: -4.25, width: 41.0, height: 60.5 }),
            scissor: Some(Rect { x: 5, y: 2, width: 30, height: 400 }),
            clear: Some(Clear::default()),
            ..plain
        },
    ]
}

#[test]
fn both_rasterizers_draw_the_same_at_every_size() {
    let shading = Shading::Fixed(FixedShading::new(senca_raster::ColorSource::Rgba { first: 0 }));
    for (k, size) in SIZES.into_iter().enumerate() {
        let mesh = Mesh::random(k as u64 + 1, 120);
        for (s, state) in states().into_iter().enumerate() {
            let (a, ca) = draw(&mut ScanlineRasterizer, size, &mesh, &state, &shading);
            let (b, cb) = draw(&mut TiledRasterizer::default(), size, &mesh, &state, &shading);
            assert!(bits(&a) == bits(&b), "size {size:?}, state {s}");
            assert_eq!(ca.primitives, 120);
            assert_eq!(
                (ca.invalid, ca.culled, ca.outside, ca.clipped, ca.drawn, ca.passed, ca.shaded),
                (cb.invalid, cb.culled, cb.outside, cb.clipped, cb.drawn, cb.passed, cb.shaded)
            );
        }
    }
}

#[test]
fn levels_and_threads_do_not_change_a_byte() {
    let mesh = Mesh::random(99, 9000);
    let shading = Shading::Fixed(FixedShading::new(senca_raster::ColorSource::Rgba { first: 0 }));
    let (reference, counters) =
        draw(&mut tiled(1, SimdLevel::baseline()), [301, 190], &mesh, &State::default(), &shading);
    for level in levels() {
        for threads in [1, 2, 5] {
            let (other, c) = draw(&mut tiled(threads, level), [301, 190], &mesh, &State::default(), &shading);
            assert!(bits(&reference) == bits(&other), "{level:?}, {threads} threads");
            assert_eq!(counters, c);
        }
    }
}

/// Discards some pixels and colours the others by what it is told about them.
struct Probe;

impl FragmentShader for Probe {
    fn shade(&self, f: &Fragments<'_>, out: &mut Shaded) {
        for i in f.lanes() {
            let [dx, dy] = f.derivatives(&f.varyings[0], i);
            out.set(i, [f.varyings[1][i], dx + dy, f.depth[i] + f32::from(u8::from(f.front)), f.id as f32]);
            if (f.column(i) + 3 * f.row(i)).is_multiple_of(5) {
                out.discard(i);
            }
        }
    }
}

#[test]
fn textured_triangles_of_all_sizes_agree() {
    let texel =
        |i: u32| [(i * 37 % 251) as u8, (i * 91 % 256) as u8, (i % 16 * 16) as u8, 128 + (i % 128) as u8];
    let bytes: Vec<[u8; 4]> = (0..48 * 20).map(texel).collect();
    let mesh = Mesh::random(7, 400);
    let over = State { depth_test: Compare::Always, blend: Some(Blend::OVER), ..State::default() };
    for texels in [
        Texels::Rgba32F(bytes.iter().map(|t| t.map(|v| f32::from(v) / 255.0)).collect()),
        Texels::Rgba8(bytes),
    ] {
        let exact = matches!(texels, Texels::Rgba32F(_));
        let texture = Texture::new(48, 20, texels).unwrap().with_mipmaps();
        let unit = TextureUnit { texture: &texture, sampler: Sampler::TRILINEAR, coords: 2 };
        for color in [ColorSource::Constant([1.0, 0.5, 0.25, 0.5]), ColorSource::Rgba { first: 0 }] {
            let shading = Shading::Fixed(FixedShading::textured(color, unit));
            for state in [State::default(), over] {
                let (plain, _) = draw(&mut ScanlineRasterizer, [150, 90], &mesh, &state, &shading);
                let (reference, _) = draw(&mut tiled(1, levels()[0]), [150, 90], &mesh, &state, &shading);
                let pixels = plain.color.pixels().iter().zip(reference.color.pixels());
                let apart = pixels.flat_map(|(a, b)| (0..4).map(|k| (a[k] - b[k]).abs())).fold(0.0, f32::max);
                assert!(apart <= if exact { 0.0 } else { 0.016 }, "{apart}");
                for (threads, level) in levels().into_iter().map(|l| (1, l)).chain([(3, SimdLevel::new())]) {
                    let (found, _) = draw(&mut tiled(threads, level), [150, 90], &mesh, &state, &shading);
                    assert!(bits(&found) == bits(&reference), "{threads} threads, {level:?}");
                }
            }
        }
    }
}

#[test]
fn custom_shaders_see_the_same_fragments() {
    for size in [[65, 63], [129, 200]] {
        let mesh = Mesh::random(5, 100);
        let shading = Shading::Custom(&Probe);
        let (a, _) = draw(&mut ScanlineRasterizer, size, &mesh, &State::default(), &shading);
        let (b, _) = draw(&mut TiledRasterizer::default(), size, &mesh, &State::default(), &shading);
        assert!(bits(&a) == bits(&b), "{size:?}");
    }
}

#[test]
fn drawing_in_two_goes_equals_one() {
    let mesh = Mesh::random(7, 400);
    let shading = Shading::vertex_rgb();
    let (one, _) = draw(&mut TiledRasterizer::default(), [200, 150], &mesh, &State::default(), &shading);
    let mut two = Buffers::with_ids(200, 150);
    let mut rasterizer = TiledRasterizer::default();
    let all = mesh.primitives();
    let (front, back) = mesh.indices.split_at(600);
    for (indices, first) in [(front, 0), (back, 200)] {
        let part = Primitives { indices, ids: Ids::From(first), ..all };
        rasterizer.draw(&mut two.target().unwrap(), &part, &State::default(), &shading);
    }
    assert!(bits(&one) == bits(&two));
}

#[test]
fn a_part_is_cleared_as_it_is_drawn() {
    let (mesh, behind) = (Mesh::random(5, 60), Mesh::random(8, 60));
    let shading = Shading::vertex_rgb();
    let rect = |x, y, width, height| Rect { x, y, width, height };
    let areas = [rect(0, 0, 96, 64), rect(64, 32, 136, 118), rect(8, 16, 40, 8), rect(3, 5, 70, 61)];
    for area in areas.map(Some).into_iter().chain([None]) {
        for scissor in [None, Some(rect(16, 8, 160, 96)), Some(rect(20, 7, 50, 70))] {
            let clear =
                Clear { color: Some([0.2, 0.4, 0.6, 1.0]), depth: Some(0.9), id: None, stencil: Some(3) };
            let draw = |rasterizer: &mut dyn Rasterizer, state: &State| {
                let mut buffers = Buffers::with_stencil(200, 150);
                let before = State::default();
                rasterizer.draw(&mut buffers.target().unwrap(), &behind.primitives(), &before, &shading);
                rasterizer.draw(&mut buffers.target().unwrap(), &mesh.primitives(), state, &shading);
                (bits(&buffers), buffers.stencil)
            };
            let state = State { clear: Some(clear), clear_area: area, scissor, ..State::default() };
            let tiled = draw(&mut TiledRasterizer::default(), &state);
            assert!(tiled == draw(&mut ScanlineRasterizer, &state), "{area:?} {scissor:?}");
            // Depths alone are drawn, the other planes cleared only.
            let mut buffers = Buffers::with_stencil(200, 150);
            let mut rasterizer = TiledRasterizer::default();
            rasterizer.draw(
                &mut buffers.target().unwrap(),
                &behind.primitives(),
                &State::default(),
                &shading,
            );
            rasterizer.draw(&mut buffers.target().unwrap(), &mesh.primitives(), &state, &Shading::None);
            assert!(tiled.0.1 == bits(&buffers).1 && tiled.1 == buffers.stencil, "{area:?} {scissor:?}");
            let cleared = buffers.color.pixels().iter().filter(|c| **c == [0.2, 0.4, 0.6, 1.0]).count();
            assert!(cleared > 0, "{area:?} {scissor:?}");
        }
    }
}

#[test]
fn eight_bit_targets_agree() {
    let mesh = Mesh::random(11, 300);
    let shading = Shading::Fixed(FixedShading::new(senca_raster::ColorSource::Rgba { first: 0 }));
    for blend in [None, Some(Blend::OVER), Some(Blend::ADD), Some(Blend::MULTIPLY)] {
        let state = State {
            blend,
            clear: Some(Clear { color: Some([0.2, 0.4, 0.6, 0.8]), ..Clear::default() }),
            ..State::default()
        };
        let picture = |rasterizer: &mut dyn Rasterizer| {
            let (mut color, mut depth) = (vec![[0u8; 4]; 97 * 130], vec![1f32; 97 * 130]);
            let mut target = Target::new(97, 130)
                .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
                .and_then(|t| t.with_depth(&mut depth))
                .unwrap();
            rasterizer.draw(&mut target, &mesh.primitives(), &state, &shading);
            color
        };
        assert!(picture(&mut ScanlineRasterizer) == picture(&mut TiledRasterizer::default()), "{blend:?}");
    }
}

#[test]
fn whole_blocks_of_colour_agree() {
    // Colours beyond 0 to 1, too, where clamping counts.
    let mut mesh = Mesh::random(12, 60);
    mesh.varyings.iter_mut().for_each(|v| *v = *v * 1.4 - 0.2);
    let shadings = [
        ColorSource::Rgba { first: 0 },
        ColorSource::Rgb { first: 1 },
        ColorSource::Constant([0.9, 1.3, -0.2, 0.4]),
    ];
    for color in shadings {
        let shading = Shading::Fixed(FixedShading::new(color));
        for blend in [None, Some(Blend::OVER), Some(Blend::ADD)] {
            let state = State {
                blend,
                interpolation: Interpolation::Screen,
                clear: Some(Clear { color: Some([0.2, 0.4, 0.6, 0.8]), ..Clear::default() }),
                ..State::default()
            };
            let picture = |rasterizer: &mut dyn Rasterizer| {
                let mut color = vec![[0u8; 4]; 197 * 130];
                let mut target =
                    Target::new(197, 130).and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color))).unwrap();
                let counters = rasterizer.draw(&mut target, &mesh.primitives(), &state, &shading);
                (color, counters.passed)
            };
            let plain = picture(&mut ScanlineRasterizer);
            for level in levels() {
                assert!(plain == picture(&mut tiled(1, level)), "{color:?} {blend:?} {level:?}");
            }
        }
    }
}

#[test]
fn textured_bytes_are_rounded_numbers() {
    let texel =
        |i: u32| [(i * 37 % 251) as u8, (i * 91 % 256) as u8, (i % 16 * 16) as u8, 128 + (i % 128) as u8];
    let texture = Texture::new(48, 20, Texels::Rgba8((0..48 * 20).map(texel).collect())).unwrap();
    let texture = texture.with_mipmaps();
    let mesh = Mesh::random(7, 400);
    let state = State { depth_test: Compare::Always, depth_write: false, ..State::default() };
    for sampler in [Sampler::NEAREST, Sampler::BILINEAR, Sampler::TRILINEAR] {
        let unit = TextureUnit { texture: &texture, sampler, coords: 2 };
        for color in [[1.0; 4], [1.0, 0.7, 1.0, 0.3]] {
            let shading = Shading::Fixed(FixedShading::textured(ColorSource::Constant(color), unit));
            let mut numbers = vec![[0f32; 4]; 150 * 90];
            let mut bytes = vec![[0u8; 4]; 150 * 90];
            for plane in [ColorPlane::Rgba32F(&mut numbers), ColorPlane::Rgba8(&mut bytes)] {
                let mut target = Target::new(150, 90).and_then(|t| t.with_color(plane)).unwrap();
                TiledRasterizer::default().draw(&mut target, &mesh.primitives(), &state, &shading);
            }
            let apart = numbers.iter().zip(&bytes).flat_map(|(numbers, bytes)| {
                let rounded = senca_raster::rgba8_from_rgba(*numbers);
                (0..4).map(move |k| rounded[k].abs_diff(bytes[k]))
            });
            assert_eq!(apart.max(), Some(0), "{sampler:?} {color:?}");
        }
    }
}

#[test]
fn hostile_triangles_do_no_harm() {
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-40,
        1e30,
        -1e38,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        1e-20,
    ];
    let mut r = Random(3);
    let mut mesh = Mesh { positions: Vec::new(), varyings: Vec::new(), indices: Vec::new() };
    for i in 0..6000u32 {
        let mut pick = || odd[(r.next() * odd.len() as f32) as usize];
        mesh.positions.push(Vec4::new(pick(), pick(), pick(), pick()));
        let mut pick = || odd[(r.next() * odd.len() as f32) as usize];
        mesh.varyings.extend([pick(), pick(), pick(), pick()]);
        mesh.indices.push(if i % 97 == 0 { u32::MAX - i } else { i });
    }
    for shading in [Shading::vertex_rgb(), Shading::None, Shading::Custom(&Probe)] {
        let (a, _) = draw(&mut ScanlineRasterizer, [70, 50], &mesh, &State::default(), &shading);
        let (b, c) = draw(&mut TiledRasterizer::default(), [70, 50], &mesh, &State::default(), &shading);
        assert_eq!((a.ids, a.depth), (b.ids, b.depth));
        assert_eq!(c.primitives, 2000);
        assert!(c.invalid > 62);
    }
    let empty =
        Primitives { positions: &[], varyings: &[], stride: 0, indices: &[0, 1, 2, 3], ids: Ids::Same(1) };
    let mut none = Buffers::new(0, 0);
    let c = TiledRasterizer::default().draw(
        &mut none.target().unwrap(),
        &empty,
        &State::default(),
        &Shading::None,
    );
    assert_eq!((c.primitives, c.invalid), (1, 1));
}

/// Rectangles whose sides fall inside blocks of 8 x 8 pixels, nearest first, then one behind them all.
#[test]
fn what_shows_past_the_rim_of_a_near_triangle_is_drawn() {
    let size = [96u32, 96];
    for shift in 0..8 {
        let mut mesh = Mesh { positions: Vec::new(), varyings: Vec::new(), indices: Vec::new() };
        let mut quad = |x0: f32, y0: f32, x1: f32, y1: f32, z: f32| {
            let first = mesh.positions.len() as u32;
            for (x, y) in [(x0, y0), (x1, y0), (x1, y1), (x0, y1)] {
                let (x, y) = (x / size[0] as f32 * 2.0 - 1.0, 1.0 - y / size[1] as f32 * 2.0);
                mesh.positions.push(Vec4::new(x, y, z, 1.0));
                mesh.varyings.extend([z; 4]);
            }
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
        };
        let s = shift as f32;
        quad(s, s, 90.0 - s, 76.0 + s, 0.2);
        quad(-400.0, 10.0 + s, 400.0, 21.0 + 2.0 * s, 0.1);
        quad(10.0 + s, -400.0, 21.0 + 2.0 * s, 400.0, 0.15);
        quad(-1000.0, -1000.0, 1000.0, 1000.0, 0.9);
        quad(-1000.0, -900.0, 900.0, 1000.0, 0.5);
        let state = State::default();
        let (a, _) = draw(&mut ScanlineRasterizer, size, &mesh, &state, &Shading::vertex_rgb());
        let (b, _) = draw(&mut TiledRasterizer::default(), size, &mesh, &state, &Shading::vertex_rgb());
        assert!(bits(&a) == bits(&b), "shifted by {shift}");
    }
}

/// A sheet of `cells * cells * 2` triangles over the target.
fn sheet(cells: u32) -> Mesh {
    let mut mesh = Mesh { positions: Vec::new(), varyings: Vec::new(), indices: Vec::new() };
    let at = |i: u32| i as f32 / cells as f32 * 2.0 - 1.0;
    for i in 0..(cells + 1) * (cells + 1) {
        mesh.positions.push(Vec4::new(at(i % (cells + 1)), at(i / (cells + 1)), 0.5, 1.0));
        mesh.varyings.extend([0.5; STRIDE]);
    }
    for i in 0..cells * cells {
        let a = i / cells * (cells + 1) + i % cells;
        mesh.indices.extend([a, a + 1, a + cells + 2, a, a + cells + 2, a + cells + 1]);
    }
    mesh
}

#[test]
fn scratch_memory_is_bounded() {
    for side in [512, 4096] {
        let mesh = sheet(200);
        let mut rasterizer = tiled(1, SimdLevel::new());
        let mut depth = vec![1.0; (side * side) as usize];
        let mut target = Target::new(side, side).and_then(|t| t.with_depth(&mut depth)).unwrap();
        rasterizer.draw(&mut target, &mesh.primitives(), &State::default(), &Shading::None);
        let per_triangle = (rasterizer.scratch_bytes() - 150_000) as f64 / 80_000.0;
        assert!(per_triangle <= 100.0, "{per_triangle} bytes per triangle at {side}");
    }
}

/// Depths with flat and uneven parts, and some where nothing is: 1, or, if `reversed`, where the greatest is nearest, 0.
/// They are drawn when somebody looks at them.
fn depths_of_a_mesh(reversed: bool) -> BlockDepths {
    let mesh = Mesh::random(9, 60);
    let (far, depth_test) = if reversed { (0.0, Compare::Greater) } else { (1.0, Compare::Less) };
    let mut depths = BlockDepths::new(300, 170, far).unwrap();
    let clear = Clear { depth: Some(far), ..Clear::default() };
    let state = State { clear: Some(clear), depth_test, ..State::default() };
    TiledRasterizer::default().draw_depths_when_read(&mut depths, &[(mesh.primitives(), state)]);
    depths
}

/// Colours by vertex, textures, shadow maps and alpha tests, in all combinations.
fn fixed_shadings<'a>(texture: &'a Texture, depths: &'a [BlockDepths; 2]) -> Vec<Shading<'a>> {
    let unit = TextureUnit { texture, sampler: Sampler::TRILINEAR, coords: 1 };
    let light = |depths, filter, compare, dims_colors| {
        Some(ShadowUnit { depths, coords: 0, compare, filter, dims_colors, dims_alpha: !dims_colors })
    };
    let [depths, reversed] = depths;
    let shadows = [
        None,
        light(depths, Filter::Nearest, Compare::LessEqual, true),
        light(reversed, Filter::Linear, Compare::GreaterEqual, false),
    ];
    let tests = [None, Some(AlphaTest { compare: Compare::Greater, reference: 0.4 })];
    let mut shadings = Vec::new();
    for color in [ColorSource::Constant([1.0, 0.5, 0.75, 0.5]), ColorSource::Rgba { first: 0 }] {
        for (texture, shadow) in [None, Some(unit)].into_iter().flat_map(|t| shadows.map(|s| (t, s))) {
            shadings.extend(tests.map(|alpha_test| {
                Shading::Fixed(FixedShading { color, texture, shadow, alpha_test, ..FixedShading::default() })
            }));
        }
    }
    shadings
}

#[test]
fn textures_shadows_and_alpha_tests_agree_on_pixels_of_one_and_of_four_samples() {
    let texel = |i: u32| [i * 37 % 251, i * 91 % 256, i % 16 * 16, 64 + i % 192].map(|v| v as f32 / 255.0);
    let texture = Texture::new(48, 20, Texels::Rgba32F((0..48 * 20).map(texel).collect())).unwrap();
    let (texture, depths) = (texture.with_mipmaps(), [false, true].map(depths_of_a_mesh));
    let mesh = Mesh::random(12, 150);
    let states = [
        State::default(),
        State { depth_test: Compare::GreaterEqual, blend: Some(Blend::ADD), ..State::default() },
        State {
            depth_write: false,
            scissor: Some(Rect { x: 9, y: 21, width: 99, height: 60 }),
            ..State::default()
        },
    ];
    for (k, state) in
        states.into_iter().flat_map(|s| [false, true].map(|m| State { multisample: m, ..s })).enumerate()
    {
        for (n, shading) in fixed_shadings(&texture, &depths).into_iter().enumerate() {
            let (plain, counters) = draw(&mut ScanlineRasterizer, [150, 94], &mesh, &state, &shading);
            for (threads, level) in [(1, SimdLevel::new()), (2, SimdLevel::new()), (1, SimdLevel::baseline())]
            {
                let (fast, c) = draw(&mut tiled(threads, level), [150, 94], &mesh, &state, &shading);
                assert!(bits(&plain) == bits(&fast), "state {k}, shading {n}, {threads} threads, {level:?}");
                assert_eq!(counters.passed, c.passed, "state {k}, shading {n}");
            }
        }
    }
}

#[test]
fn pixels_of_four_samples_have_the_colour_of_their_middle() {
    // A ramp of depths as wide as the target: light where the reference is nearer.
    let mut ramp = BlockDepths::new(8, 8, 0.0).unwrap();
    let corner = |x: f32, y: f32, z: f32| Vec4::new(x, y, z, 1.0);
    let square = Mesh {
        positions: vec![corner(-1., -1., 0.), corner(1., -1., 1.), corner(1., 1., 1.), corner(-1., 1., 0.)],
        varyings: [[0., 1., 0.1, 1.], [1., 1., 0.1, 1.], [1., 0., 0.1, 1.], [0., 0., 0.1, 1.]].concat(),
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    let state = State { depth_test: Compare::Always, ..State::default() };
    TiledRasterizer::default().draw_depths(&mut ramp, &[(square.primitives(), state)]);
    let shadow = ShadowUnit {
        depths: &ramp,
        coords: 0,
        compare: Compare::Less,
        filter: Filter::Nearest,
        dims_colors: true,
        dims_alpha: false,
    };
    let color = ColorSource::Constant([1.0; 4]);
    let shading = Shading::Fixed(FixedShading { color, shadow: Some(shadow), ..FixedShading::default() });
    for (multisample, expected) in [
        // The depth of column 0 is 1/16, that of column 1 is 3/16.
        (false, [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        // The middle of columns 0 and 1 is where column 1 begins.
        (true, [1.0; 8]),
    ] {
        let state = State { multisample, ..State::default() };
        let (buffers, _) = draw(&mut TiledRasterizer::default(), [8, 8], &square, &state, &shading);
        let row: Vec<f32> = (0..8).map(|x| buffers.color.pixel(x, 3)[0]).collect();
        assert_eq!(row, expected, "{multisample}");
    }
    // A colour that changes from column to column, alone and with a test none fails: samples of a pixel have one colour.
    for alpha_test in [None, Some(AlphaTest { compare: Compare::GreaterEqual, reference: 0.0 })] {
        let color = ColorSource::Rgba { first: 0 };
        let shading = Shading::Fixed(FixedShading { color, alpha_test, ..FixedShading::default() });
        let state = State { multisample: true, ..State::default() };
        let (buffers, _) = draw(&mut TiledRasterizer::default(), [8, 8], &square, &state, &shading);
        for x in 0..8 {
            assert!((buffers.color.pixel(x, 5)[0] - (x / 2 * 2 + 1) as f32 / 8.0).abs() < 1e-6);
        }
    }
}

/// Faces of 16, 8, 4, 2 and 1 texels along an edge, smooth over all edges: of each level the colour is its direction.
fn cube() -> CubeTexture {
    let levels: Vec<(u32, [Vec<[u8; 4]>; 6])> = [16u32, 8, 4, 2, 1].map(|n| (n, cube_faces(n))).to_vec();
    let slices: Vec<_> = levels.iter().map(|(n, faces)| (*n, faces.each_ref().map(Vec::as_slice))).collect();
    CubeTexture::new(&slices, true).unwrap()
}

fn cube_faces(n: u32) -> [Vec<[u8; 4]>; 6] {
    senca_raster::cube::FACES.map(|axes| {
        let texel = |i: u32| {
            let place = |v: u32| (2 * v + 1) as f32 / n as f32 - 1.0;
            let mut direction = [0.0; 3];
            for ((axis, sign), v) in axes.into_iter().zip([1.0, place(i % n), place(i / n)]) {
                direction[axis] = sign * v;
            }
            let [x, y, z] = direction.map(|v| (127.5 + 127.5 * v).round() as u8);
            [x, y, z, 255]
        };
        (0..n * n).map(texel).collect()
    })
}

#[test]
fn cubes_agree_and_have_the_colour_of_their_direction() {
    let (texture, depths) = (cube(), depths_of_a_mesh(false));
    let mut mesh = Mesh::random(21, 120);
    mesh.varyings.iter_mut().for_each(|v| *v = 2.0 * *v - 1.0);
    for mip in [Mip::None, Mip::Nearest, Mip::Linear] {
        for (n, shadow) in [false, true].into_iter().enumerate() {
            let sampler = Sampler { mip, lod_bias: -1.0, ..Sampler::TRILINEAR };
            let shadow = shadow.then_some(ShadowUnit {
                depths: &depths,
                coords: 0,
                compare: Compare::Less,
                filter: Filter::Nearest,
                dims_colors: true,
                dims_alpha: true,
            });
            let cube = Some(CubeUnit { texture: &texture, sampler, coords: 1 });
            let shading = Shading::Fixed(FixedShading { cube, shadow, ..FixedShading::default() });
            for multisample in [false, true] {
                let state = State { multisample, ..State::default() };
                let (plain, _) = draw(&mut ScanlineRasterizer, [150, 94], &mesh, &state, &shading);
                let (fast, _) = draw(&mut tiled(1, SimdLevel::new()), [150, 94], &mesh, &state, &shading);
                let (base, _) =
                    draw(&mut tiled(2, SimdLevel::baseline()), [150, 94], &mesh, &state, &shading);
                assert!(bits(&fast) == bits(&base));
                let far = |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.01);
                let apart = plain.color.pixels().iter().zip(fast.color.pixels()).filter(|p| far(*p)).count();
                // Where the level of detail is nearly that of another level, or the face another face.
                assert!(apart < 20, "{mip:?} {n} {multisample}: {apart}");
            }
        }
    }
    // A square seen straight on from inside: the face +z, and beyond its edges the neighbours.
    let corner = |x: f32, y: f32| Vec4::new(x, y, 0.5, 1.0);
    let square = Mesh {
        positions: vec![corner(-1., -1.), corner(1., -1.), corner(1., 1.), corner(-1., 1.)],
        varyings: [[-1.5, -1.5, 1., 0.], [1.5, -1.5, 1., 0.], [1.5, 1.5, 1., 0.], [-1.5, 1.5, 1., 0.]]
            .concat(),
        indices: vec![0, 1, 2, 0, 2, 3],
    };
    let cube = Some(CubeUnit { texture: &texture, sampler: Sampler::TRILINEAR, coords: 0 });
    let shading = Shading::Fixed(FixedShading { cube, ..FixedShading::default() });
    let (buffers, _) = draw(&mut TiledRasterizer::default(), [60, 60], &square, &State::default(), &shading);
    for (x, y) in (0..60).flat_map(|y| (0..60).map(move |x| (x, y))) {
        let place = |v: usize| (v as f32 + 0.5) / 60.0 * 3.0 - 1.5;
        let direction = [place(x), -place(y), 1.0f32];
        let longest = direction.iter().fold(0.0f32, |m, v| m.max(v.abs()));
        for (found, d) in buffers.color.pixel(x as u32, y as u32).into_iter().zip(direction) {
            assert!((found - 0.5 - 0.5 * d / longest).abs() < 0.04, "{x} {y}: {found} {direction:?}");
        }
    }
}

#[test]
fn what_fails_the_alpha_test_is_not_counted() {
    let mesh = Mesh::random(31, 90);
    let alpha_test = Some(AlphaTest { compare: Compare::Less, reference: 0.5 });
    let color = ColorSource::Rgba { first: 0 };
    let shading = Shading::Fixed(FixedShading { color, alpha_test, ..FixedShading::default() });
    for multisample in [false, true] {
        // Colours and nothing else: no depth test, no identifiers.
        let state = State { multisample, depth_test: Compare::Always, ..State::default() };
        let draw = |rasterizer: &mut dyn Rasterizer| {
            let mut pixels = vec![[0u8; 4]; 130 * 70];
            let mut target =
                Target::new(130, 70).unwrap().with_color(ColorPlane::Rgba8(&mut pixels)).unwrap();
            let counters = rasterizer.draw(&mut target, &mesh.primitives(), &state, &shading);
            (counters.passed, pixels)
        };
        let (plain, tiled) = (draw(&mut ScanlineRasterizer), draw(&mut TiledRasterizer::default()));
        assert!(plain.0 > 0 && plain == tiled, "{multisample}: {} {}", plain.0, tiled.0);
    }
}
