//! Textures: known answers of the plain sampler, and both rasterizers against each other.

use senca_math::Srgb8;
use senca_math::color::srgb_from_linear;
use senca_math::glam::{Mat4, Vec3, Vec4};
use senca_raster::{
    Buffers, ColorSource, Filter, FixedShading, Ids, Mip, Primitives, Rasterizer, Sampler,
    ScanlineRasterizer, Shading, State, TexelGrid, Texels, Texture, TextureError, TextureLevel, TextureUnit,
    TiledRasterizer, Wrap,
};

fn checks(width: u32, height: u32, float: bool) -> Texture {
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        [
            if (x / 3 + y / 3) % 2 == 0 { 230 } else { 15 },
            (x * 255 / width) as u8,
            (y * 255 / height) as u8,
            200,
        ]
    };
    let bytes: Vec<[u8; 4]> = (0..width * height).map(texel).collect();
    let texels = match float {
        false => Texels::Rgba8(bytes),
        true => Texels::Rgba32F(bytes.into_iter().map(|t| t.map(|v| f32::from(v) / 255.0)).collect()),
    };
    Texture::new(width, height, texels).unwrap()
}

/// 8-bit sRGB, and the same light in floats.
fn srgb_and_light(width: u32, height: u32) -> [Texture; 2] {
    let texel =
        |i: u32| [(i * 7 % 256) as u8, (i * 31 % 256) as u8, (i * 113 % 256) as u8, (i * 3 % 256) as u8];
    let bytes: Vec<[u8; 4]> = (0..width * height).map(texel).collect();
    let light = |&[r, g, b, a]: &[u8; 4]| {
        let c = Srgb8 { r, g, b }.to_linear();
        [c.r, c.g, c.b, f32::from(a) * (1.0 / 255.0)]
    };
    let floats = bytes.iter().map(light).collect();
    [Texels::Srgb8(bytes), Texels::Rgba32F(floats)].map(|t| Texture::new(width, height, t).unwrap())
}

fn ramp(n: u32) -> Texture {
    Texture::new(n, 1, Texels::Rgba32F((0..n).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect())).unwrap()
}

#[test]
fn texel_coordinates_of_the_course_text() {
    // u (N - 1): u = 0, 0.5, 1 with N = 256 -> 0, 127.5, 255; u = 0.25, N = 64 -> 15.75.
    let position = |u, n| TexelGrid::Points.position(u, n);
    assert_eq!([position(0.0, 256), position(0.5, 256), position(1.0, 256)], [0.0, 127.5, 255.0]);
    assert_eq!(position(0.25, 64), 15.75);
    // The bilinear value of a ramp is its coordinate.
    let sampler = Sampler { grid: TexelGrid::Points, ..Sampler::BILINEAR }.wrapped(Wrap::Clamp);
    assert_eq!(sampler.sample_lod(&ramp(256), [0.5, 0.0], 0.0)[0], 127.5);
    assert_eq!(sampler.sample_lod(&ramp(64), [0.25, 0.0], 0.0)[0], 15.75);
    let nearest = Sampler { magnify: Filter::Nearest, ..sampler };
    assert_eq!(nearest.sample_lod(&ramp(64), [0.25, 0.0], 0.0)[0], 16.0);
    // The usual grid: texel centres at (i + 1/2) / N.
    assert_eq!(TexelGrid::Areas.position(0.5 / 64.0, 64), 0.0);
}

#[test]
fn alignment_points_give_the_texture_coordinates_of_the_course_text() {
    // P = (1,1,1), (4,5,1), (1,1,3) with U = (.1,.2), (.9,.2), (.1,.8); T1 T2 T3 printed as rows.
    let rows =
        [[0.096, 0.0, 0.0, 0.0], [0.128, 0.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0], [-0.124, -0.1, 0.0, 1.0]];
    let texture_from_scene = Mat4::from_cols_array_2d(&rows);
    let corners = [
        (Vec3::new(1.0, 1.0, 1.0), [0.1, 0.2]),
        (Vec3::new(4.0, 5.0, 1.0), [0.9, 0.2]),
        (Vec3::new(1.0, 1.0, 3.0), [0.1, 0.8]),
    ];
    for (p, u) in corners {
        let found = texture_from_scene.transform_point3(p);
        assert!((found.x - u[0]).abs() < 1e-6 && (found.y - u[1]).abs() < 1e-6, "{p}: {found}");
    }
    // The same values by interpolation with the weights of a point: the centroid, and (2.5, 3, 2).
    let mix = |w: [f32; 3], k: usize| (0..3).map(|c| w[c] * corners[c].1[k]).sum::<f32>();
    let third = [1.0 / 3.0; 3];
    assert!((mix(third, 0) - 0.366_667).abs() < 1e-5 && (mix(third, 1) - 0.4).abs() < 1e-6);
    let at = texture_from_scene.transform_point3(Vec3::new(2.5, 3.0, 2.0));
    assert!((at.x - 0.5).abs() < 1e-6 && (at.y - 0.5).abs() < 1e-6);
}

#[test]
fn wrapping() {
    let of = |wrap: Wrap| (-5..7).map(|i| wrap.apply(i, 3)).collect::<Vec<_>>();
    assert_eq!(of(Wrap::Repeat), [1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
    assert_eq!(of(Wrap::Mirror), [1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
    assert_eq!(of(Wrap::Clamp), [0, 0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
}

#[test]
fn levels_are_means_of_what_they_cover() {
    let texture = checks(13, 6, true).with_mipmaps();
    let sizes: Vec<_> = texture.levels().iter().map(|l| [l.width(), l.height()]).collect();
    assert_eq!(sizes, [[13, 6], [6, 3], [3, 1], [1, 1]]);
    let mean = |l: &TextureLevel, k: usize| {
        let sum: f32 = (0..l.width() * l.height()).map(|i| l.texel(i % l.width(), i / l.width())[k]).sum();
        sum / (l.width() * l.height()) as f32
    };
    for level in texture.levels() {
        for k in 0..4 {
            assert!((mean(level, k) - mean(&texture.levels()[0], k)).abs() < 1e-5);
        }
    }
}

#[test]
fn level_of_detail_is_the_logarithm_of_the_footprint() {
    let texture = checks(64, 32, false).with_mipmaps();
    let lod = |d| Sampler::TRILINEAR.lod(&texture, d);
    for (spread, expected) in
        [(1.0, 0.0), (2.0, 1.0), (3.0, 3f32.log2()), (0.25, -2.0), (17.3, 17.3f32.log2())]
    {
        assert!((lod([[spread / 64.0, 0.0], [0.0, 0.0]]) - expected).abs() < 1e-4);
        assert!((lod([[0.0, 0.0], [0.0, spread / 32.0]]) - expected).abs() < 1e-4);
    }
    assert!(lod([[0.0; 2]; 2]) < -60.0);
    // Between levels the colours blend.
    let flat =
        |v: f32, n: u32| TextureLevel::new(n, n, Texels::Rgba32F(vec![[v; 4]; (n * n) as usize])).unwrap();
    let stack = Texture::from_levels(vec![flat(0.0, 4), flat(1.0, 2), flat(3.0, 1)]).unwrap();
    let at = |lod| Sampler::TRILINEAR.sample_lod(&stack, [0.3, 0.4], lod)[0];
    assert_eq!([at(-1.0), at(0.25), at(1.0), at(1.5), at(9.0)], [0.0, 0.25, 1.0, 2.0, 3.0]);
    let nearest = Sampler { mip: Mip::Nearest, ..Sampler::TRILINEAR };
    assert_eq!(nearest.sample_lod(&stack, [0.3, 0.4], 1.4)[0], 1.0);
}

#[test]
fn footprints_are_averaged() {
    let texture = checks(12, 12, true);
    let sampler = Sampler::BILINEAR;
    let whole = sampler.footprint_mean(&texture, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1000);
    let level = &texture.levels()[0];
    for (k, found) in whole.into_iter().enumerate() {
        let mean = (0..144).map(|i| level.texel(i % 12, i / 12)[k]).sum::<f32>() / 144.0;
        assert!((found - mean).abs() < 1e-5);
    }
    let square = sampler.square_mean(&texture, [0.5, 0.5], [[1.0, 0.0], [0.0, 1.0]], 1000);
    assert!((0..4).all(|k| (square[k] - whole[k]).abs() < 1e-5));
    // Smaller than a texel: the bilinear value.
    let tiny = sampler.square_mean(&texture, [0.31, 0.62], [[1e-4, 0.0], [0.0, 1e-4]], 1000);
    let bilinear = sampler.sample_lod(&texture, [0.31, 0.62], 0.0);
    assert!((0..4).all(|k| (tiny[k] - bilinear[k]).abs() < 1e-5));
    // Few samples allowed: still an average, still finite; no sample, no trouble.
    let coarse = sampler.footprint_mean(&texture, [[0.0, 0.0], [90.0, 0.0], [90.0, 80.0], [0.0, 80.0]], 500);
    assert!((0..3).all(|k| (coarse[k] - whole[k]).abs() < 0.2));
    let odd = sampler.footprint_mean(&texture, [[f32::NAN; 2], [f32::INFINITY; 2], [0.0; 2], [1e30; 2]], 100);
    assert!(odd.iter().all(|v| v.is_finite()));
}

#[test]
fn impossible_textures_are_refused() {
    assert_eq!(Texture::new(0, 3, Texels::Rgba8(vec![])), Err(TextureError::Side { width: 0, height: 3 }));
    assert_eq!(
        Texture::new(2, 2, Texels::Rgba8(vec![[0; 4]; 3])),
        Err(TextureError::Count { expected: 4, found: 3 })
    );
    let level = |n: u32| TextureLevel::new(n, n, Texels::Rgba8(vec![[0; 4]; (n * n) as usize])).unwrap();
    assert_eq!(Texture::from_levels(vec![level(8), level(3)]), Err(TextureError::Level { level: 1 }));
    assert!(Texture::from_levels(vec![]).is_err());
}

/// A floor seen at a slant, and a triangle facing the eye.
fn scene() -> (Vec<Vec4>, Vec<f32>, Vec<u32>) {
    let mut positions = Vec::new();
    let mut varyings = Vec::new();
    for (x, y, w, u, v) in [
        (-1.0, -1.0, 1.0, -1.3, 0.2),
        (1.0, -0.9, 1.0, 4.1, -0.1),
        (1.0, 0.8, 9.0, 3.3, 7.7),
        (-1.0, 0.9, 7.0, -2.0, 6.1),
        (-0.5, -0.5, 1.0, 0.1, 0.1),
        (0.9, -0.2, 1.0, 0.3, 0.12),
        (0.0, 0.95, 1.0, 0.15, 0.33),
    ] {
        positions.push(Vec4::new(x * w, y * w, 0.3 * w, w));
        varyings.extend([0.9, 0.7, 0.5, u, v]);
    }
    (positions, varyings, vec![0, 1, 2, 0, 2, 3, 4, 5, 6])
}

#[test]
fn srgb_of_8_bits_reads_as_the_same_light_in_floats() {
    let [srgb, light] = srgb_and_light(37, 19);
    for k in 0..400 {
        let uv = [k as f32 * 0.0173 - 1.0, k as f32 * 0.0291 - 2.0];
        for sampler in [Sampler::NEAREST, Sampler::BILINEAR] {
            assert_eq!(sampler.sample_lod(&srgb, uv, 0.0), sampler.sample_lod(&light, uv, 0.0));
        }
    }
    // Smaller levels are rounded to codes: half a code off from level to level.
    let [srgb, light] = [srgb, light].map(Texture::with_mipmaps);
    for (level, (a, b)) in srgb.levels().iter().zip(light.levels()).enumerate() {
        for i in 0..a.width() * a.height() {
            let (a, b) = (a.texel(i % a.width(), i / a.width()), b.texel(i % b.width(), i / b.width()));
            let codes = |c: [f32; 4]| [c[0], c[1], c[2]].map(|v| srgb_from_linear(v) * 255.0);
            let apart = codes(a).iter().zip(codes(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart <= 0.001 + 0.75 * level as f32, "level {level}: {apart}");
            assert!((a[3] - b[3]).abs() <= 0.75 * level as f32 / 255.0 + 1e-6);
        }
    }
}

#[test]
fn both_rasterizers_read_srgb_to_the_bit() {
    let (positions, varyings, indices) = scene();
    let ids = Ids::From(0);
    let primitives =
        Primitives { positions: &positions, varyings: &varyings, stride: 5, indices: &indices, ids };
    let [srgb, light] = srgb_and_light(37, 19);
    for sampler in [Sampler::NEAREST, Sampler::BILINEAR, Sampler::TRILINEAR] {
        let picture = |rasterizer: &mut dyn Rasterizer, texture: &Texture| {
            let unit = TextureUnit { texture, sampler, coords: 3 };
            let shading = Shading::Fixed(FixedShading::textured(ColorSource::Rgb { first: 0 }, unit));
            let mut buffers = Buffers::new(90, 70);
            rasterizer.draw(&mut buffers.target().unwrap(), &primitives, &State::default(), &shading);
            buffers.color
        };
        let plain = picture(&mut ScanlineRasterizer, &srgb);
        assert_eq!(plain, picture(&mut TiledRasterizer::default(), &srgb));
        assert_eq!(plain, picture(&mut TiledRasterizer::default(), &light));
        let levels = srgb.clone().with_mipmaps();
        assert_eq!(
            picture(&mut ScanlineRasterizer, &levels),
            picture(&mut TiledRasterizer::default(), &levels)
        );
    }
}

#[test]
fn both_rasterizers_read_textures_alike() {
    let (positions, varyings, indices) = scene();
    let primitives = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 5,
        indices: &indices,
        ids: Ids::From(0),
    };
    let state = State { depth_test: senca_raster::Compare::LessEqual, ..State::default() };
    let (mut exact, mut total) = (0, 0);
    for (width, height) in [(64, 32), (13, 7), (1, 1), (100, 3)] {
        for float in [false, true] {
            let texture = checks(width, height, float).with_mipmaps();
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for (magnify, minify, mip) in [
                    (Filter::Nearest, Filter::Nearest, Mip::None),
                    (Filter::Linear, Filter::Linear, Mip::None),
                    (Filter::Nearest, Filter::Linear, Mip::Nearest),
                    (Filter::Linear, Filter::Linear, Mip::Linear),
                ] {
                    for grid in [TexelGrid::Areas, TexelGrid::Points] {
                        let sampler =
                            Sampler { magnify, minify, mip, grid, ..Sampler::default() }.wrapped(wrap);
                        let unit = TextureUnit { texture: &texture, sampler, coords: 3 };
                        let shading =
                            Shading::Fixed(FixedShading::textured(ColorSource::Rgb { first: 0 }, unit));
                        let picture = |rasterizer: &mut dyn Rasterizer| {
                            let mut buffers = Buffers::new(90, 70);
                            rasterizer.draw(&mut buffers.target().unwrap(), &primitives, &state, &shading);
                            buffers.color
                        };
                        let (a, b) =
                            (picture(&mut ScanlineRasterizer), picture(&mut TiledRasterizer::default()));
                        for (a, b) in a.pixels().iter().zip(b.pixels()) {
                            let apart = (0..4).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
                            // 8-bit weights; floating-point textures are read to the bit.
                            let allowed = if float { 0.0 } else { 0.008 };
                            assert!(apart <= allowed, "{width}x{height} {sampler:?}: {a:?} {b:?}");
                            exact += usize::from(apart == 0.0);
                            total += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(exact * 2 > total);
}
