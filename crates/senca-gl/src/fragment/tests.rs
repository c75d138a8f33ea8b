//! The fast form against the plain one, and textures by their numbers.

use super::*;
use crate::raster_state::UnitState;
use crate::state::{StencilBuffer, TexEnv, TexTarget};
use crate::texture::{InternalFormat, TexImage, TexParams, Texels, next_level};
use senca_math::glam::{Mat4, Vec3, Vec4};
use senca_raster::{
    ColorPlane, Compare, Ids, Primitives, Rasterizer, Shading, State, Target, TiledRasterizer,
};
use std::sync::Arc;

/// Numbers in [0, 1), the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[(self.next() * from.len() as f32) as usize]
    }
}

fn image(format: Enum, size: [u32; 3], border: u32, r: &mut Random) -> TexImage {
    let format = InternalFormat::for_texture(format).unwrap();
    let mut image = TexImage::new(format, size, border).unwrap();
    let base = format.base();
    match Arc::make_mut(&mut image.texels) {
        Texels::Rgba8(p) => p.iter_mut().for_each(|t| {
            let color = [0; 4].map(|_: u8| (r.next() * 256.0) as u8);
            *t = base.stored(color, 255);
        }),
        Texels::Rgba32F(p) => p.iter_mut().for_each(|t| {
            let color = [0.0; 4].map(|_: f32| r.next());
            *t = base.stored(color, 1.0);
        }),
        Texels::Depth(p) => p.iter_mut().for_each(|t| *t = r.next()),
        Texels::DepthStencil { depth, .. } => depth.iter_mut().for_each(|t| *t = r.next()),
        Texels::Stencil(_) => {}
    }
    image
}

/// A texture of random texels, with all levels if they are read.
fn view(target: TexTarget, params: TexParams, format: Enum, side: u32, r: &mut Random) -> View {
    let (size, faces) = match target {
        TexTarget::One => ([side, 1, 1], 1),
        TexTarget::Two => ([side, side / 2, 1], 1),
        TexTarget::Three => ([side, side / 2, side], 1),
        TexTarget::Cube => ([side, side, 1], 6),
    };
    let mut levels = vec![(0..faces).map(|_| image(format, size, 0, r)).collect::<Vec<_>>()];
    while params.uses_mipmaps() {
        let last = levels.last().unwrap();
        let Some(smaller) = last.iter().map(next_level).collect::<Option<Result<Vec<_>, _>>>() else { break };
        levels.push(smaller.unwrap());
    }
    View::of_levels(params, levels)
}

/// The layout of vertices with everything: colour, secondary colour, fog, two units.
fn layout() -> Layout {
    let mut tex_coords = [None; crate::state::TEXTURE_UNITS];
    (tex_coords[0], tex_coords[2]) = (Some(8), Some(12));
    Layout { secondary: Some(4), fog: Some(7), tex_coords, stride: 16 }
}

/// A picture of random triangles, some of them large.
fn draw(program: &Program, seed: u64, depth_test: Compare) -> (Vec<[u8; 4]>, Vec<f32>, Vec<u8>, u64) {
    let mut r = Random(seed);
    let (mut positions, mut varyings) = (Vec::new(), Vec::new());
    for n in 0..36 {
        let size = [0.3, 1.0, 4.0][n % 3];
        for _ in 0..3 {
            let w = 0.5 + r.next();
            positions.push(Vec4::new(
                (r.next() * 2.0 - 1.0) * w * size,
                (r.next() * 2.0 - 1.0) * w * size,
                r.next() * w,
                w,
            ));
            varyings.extend((0..8).map(|_| r.next()));
            for _ in 0..2 {
                varyings.extend((0..3).map(|_| 3.0 * r.next() - 1.0));
                varyings.push(0.7 + 0.3 * r.next());
            }
        }
    }
    let indices: Vec<u32> = (0..positions.len() as u32).collect();
    let p = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 16,
        indices: &indices,
        ids: Ids::Same(0),
    };
    let (w, h) = (61, 47);
    let mut color = vec![[30, 60, 90, 120]; w * h];
    let (mut depth, mut stencil) = (vec![0.5; w * h], vec![0; w * h]);
    let mut target = Target::new(w as u32, h as u32)
        .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
        .and_then(|t| t.with_depth(&mut depth))
        .and_then(|t| t.with_stencil(&mut stencil))
        .unwrap();
    let state = State { depth_test, ..State::default() };
    let passed = TiledRasterizer::default().draw(&mut target, &p, &state, &Shading::Stage(program)).passed;
    (color, depth, stencil, passed)
}

fn random_state(r: &mut Random) -> RasterState {
    let mut s = RasterState { color_sum: r.next() < 0.3, ..RasterState::default() };
    let wraps = [gl::CLAMP, gl::REPEAT, gl::CLAMP_TO_EDGE, gl::CLAMP_TO_BORDER, gl::MIRRORED_REPEAT];
    let filters = [
        gl::NEAREST,
        gl::LINEAR,
        gl::NEAREST_MIPMAP_NEAREST,
        gl::LINEAR_MIPMAP_NEAREST,
        gl::NEAREST_MIPMAP_LINEAR,
        gl::LINEAR_MIPMAP_LINEAR,
    ];
    let formats = [gl::RGBA8, gl::RGB, gl::LUMINANCE8, gl::ALPHA8, gl::INTENSITY8, gl::SRGB8, gl::RGBA16];
    let depths = [gl::DEPTH_COMPONENT24, gl::DEPTH24_STENCIL8];
    let modes = [gl::MODULATE, gl::REPLACE, gl::DECAL, gl::BLEND, gl::ADD, gl::COMBINE];
    for unit in [0, 2].into_iter().take((r.next() * 3.0) as usize) {
        let params = TexParams {
            min_filter: r.pick(&filters),
            mag_filter: r.pick(&[gl::NEAREST, gl::LINEAR]),
            wrap: [0; 3].map(|_: u32| r.pick(&wraps)),
            border_color: [0.9, 0.1, 0.4, 0.3],
            compare_mode: r.pick(&[gl::NONE, gl::COMPARE_R_TO_TEXTURE]),
            compare_func: gl::NEVER + (r.next() * 8.0) as u32,
            depth_mode: r.pick(&[gl::LUMINANCE, gl::INTENSITY, gl::ALPHA]),
            lod_bias: r.pick(&[0.0, 0.0, 1.5]),
            ..TexParams::default()
        };
        let target =
            r.pick(&[TexTarget::Two, TexTarget::Two, TexTarget::Cube, TexTarget::One, TexTarget::Three]);
        let depth = target == TexTarget::Two && r.next() < 0.3;
        let format = if depth { r.pick(&depths) } else { r.pick(&formats) };
        let env = TexEnv { mode: r.pick(&modes), color: [0.2, 0.4, 0.6, 0.8], ..TexEnv::default() };
        let view = view(target, params, format, 16, r);
        s.units.push(UnitState { unit, env, target, view });
    }
    let mut on = |cap: Cap, share: f32, r: &mut Random| s.enabled.set(cap, 0, r.next() < share);
    on(Cap::AlphaTest, 0.3, r);
    on(Cap::Blend, 0.5, r);
    on(Cap::ColorLogicOp, 0.15, r);
    on(Cap::DepthTest, 0.7, r);
    on(Cap::Fog, 0.3, r);
    on(Cap::PolygonStipple, 0.2, r);
    on(Cap::StencilTest, 0.4, r);
    on(Cap::TextureCubeMapSeamless, 0.5, r);
    s.fog.mode = r.pick(&[gl::LINEAR, gl::EXP, gl::EXP2]);
    s.fog.color = [0.5, 0.6, 0.7, 1.0];
    s.color.alpha_func = gl::NEVER + 1 + (r.next() * 7.0) as u32;
    s.color.alpha_ref = 0.4;
    s.color.blend_func = r.pick(&[
        [gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA, gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA],
        [gl::ONE, gl::ONE, gl::ZERO, gl::DST_ALPHA],
        [gl::DST_COLOR, gl::ONE_MINUS_SRC_COLOR, gl::SRC_ALPHA_SATURATE, gl::CONSTANT_ALPHA],
    ]);
    s.color.blend_equation = [r.pick(&[gl::FUNC_ADD, gl::MIN, gl::FUNC_REVERSE_SUBTRACT]), gl::FUNC_ADD];
    s.color.blend_color = [0.2, 0.3, 0.4, 0.5];
    s.color.logic_op = gl::CLEAR + (r.next() * 16.0) as u32;
    s.color.mask = r.pick(&[[true; 4], [true; 4], [true, false, true, false], [false; 4]]);
    s.polygon_stipple.0 = std::array::from_fn(|k| 0x1357_9bdf_u32.rotate_left(k as u32));
    let ops = [gl::KEEP, gl::ZERO, gl::REPLACE, gl::INCR, gl::DECR, gl::INCR_WRAP, gl::INVERT];
    s.stencil = StencilBuffer {
        func: gl::NEVER + (r.next() * 8.0) as u32,
        reference: 2,
        value_mask: 0x0f,
        write_mask: 0x3f,
        fail: r.pick(&ops),
        depth_fail: r.pick(&ops),
        depth_pass: r.pick(&ops),
        clear: 0,
    };
    s.depth.func = gl::NEVER + 1 + (r.next() * 7.0) as u32;
    s
}

#[test]
fn sixteen_at_a_time_is_one_at_a_time() {
    let mut r = Random(77);
    for n in 0..150 {
        let s = random_state(&mut r);
        let level = senca_raster::SimdLevel::new();
        let program = Program::new(&s, Kind::Triangles, &layout(), level, [true, true]);
        let test = if s.has(Cap::DepthTest) { Compare::Less } else { Compare::Always };
        let (color, depth, stencil, passed) = draw(&program, n, test);
        let plain = draw(&program.plain(), n, test);
        // A colour at the very border of two texels, or of passing, may fall on either side.
        let close = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
        let apart = color.iter().zip(&plain.0).filter(|(a, b)| !close(a, b)).count();
        let logic = s.has(Cap::ColorLogicOp);
        assert!(apart <= if logic { 400 } else { 12 }, "{n}: {apart} pixels differ: {s:?}");
        let apart = stencil.iter().zip(&plain.2).filter(|(a, b)| a != b).count();
        assert!(apart <= 8 && depth.len() == plain.1.len(), "{n}: {apart} stencil values differ");
        assert!(passed.abs_diff(plain.3) <= 12, "{n}: {passed}, {}", plain.3);
    }
}

/// A texture of one row of four texels, 10, 20, 30, 40 of red.
fn row(params: TexParams, border: u32) -> Sampled {
    let format = InternalFormat::for_texture(gl::RGB8).unwrap();
    let width = 4 + 2 * border;
    let mut image = TexImage::new(format, [width, 1, 1], border).unwrap();
    let red: &[u8] = if border == 0 { &[10, 20, 30, 40] } else { &[110, 10, 20, 30, 40, 120] };
    image.texels = Arc::new(Texels::Rgba8(red.iter().map(|&r| [r, 0, 0, 255]).collect()));
    Sampled::new(TexTarget::One, &params, &[vec![image]], 0.0, false).unwrap()
}

#[test]
fn coordinates_outside_are_wrapped_as_told() {
    let red = |wrap: Enum, filter: Enum, border: u32, s: f32| {
        let params = TexParams {
            wrap: [wrap; 3],
            min_filter: filter,
            mag_filter: filter,
            border_color: [1.0, 0.0, 0.0, 0.0],
            ..TexParams::default()
        };
        (row(params, border).sample([s, 0.0, 0.0], 0.0, 0.0)[0] * 255.0 * 10.0).round() / 10.0
    };
    let along = |wrap, filter, border| {
        [-0.375, -0.01, 0.0, 0.125, 0.25, 0.99, 1.0, 1.3].map(|s| red(wrap, filter, border, s))
    };
    assert_eq!(along(gl::REPEAT, gl::NEAREST, 0), [30., 40., 10., 10., 20., 40., 10., 20.]);
    assert_eq!(along(gl::CLAMP, gl::NEAREST, 0), [10., 10., 10., 10., 20., 40., 40., 40.]);
    assert_eq!(along(gl::CLAMP_TO_EDGE, gl::NEAREST, 0), [10., 10., 10., 10., 20., 40., 40., 40.]);
    assert_eq!(along(gl::CLAMP_TO_BORDER, gl::NEAREST, 0), [255., 255., 10., 10., 20., 40., 255., 255.]);
    assert_eq!(along(gl::CLAMP_TO_BORDER, gl::NEAREST, 1), [110., 110., 10., 10., 20., 40., 120., 120.]);
    assert_eq!(along(gl::MIRRORED_REPEAT, gl::NEAREST, 0), [20., 10., 10., 10., 20., 40., 40., 30.]);
    assert_eq!(along(gl::REPEAT, gl::LINEAR, 0), [30., 26.2, 25., 10., 15., 26.2, 25., 17.]);
    assert_eq!(along(gl::CLAMP, gl::LINEAR, 0), [132.5, 132.5, 132.5, 10., 15., 138.9, 147.5, 147.5]);
    assert_eq!(along(gl::CLAMP, gl::LINEAR, 1), [60., 60., 60., 10., 15., 76.8, 80., 80.]);
    assert_eq!(along(gl::CLAMP_TO_EDGE, gl::LINEAR, 0), [10., 10., 10., 10., 15., 40., 40., 40.]);
    assert_eq!(along(gl::CLAMP_TO_BORDER, gl::LINEAR, 0)[0], 255.0);
}

#[test]
fn levels_are_chosen_by_the_filter() {
    let mut r = Random(1);
    let mut at = |min_filter, mag_filter, lod: f32| {
        let params = TexParams { min_filter, mag_filter, ..TexParams::default() };
        view(TexTarget::Two, params, gl::RGBA8, 16, &mut r);
        let levels = view(TexTarget::Two, params, gl::RGBA8, 16, &mut r).levels;
        Sampled::new(TexTarget::Two, &params, &levels, 0.0, false).unwrap().levels_at(lod)
    };
    assert_eq!(at(gl::NEAREST, gl::LINEAR, 0.0), (true, 0, 0.0));
    assert_eq!(at(gl::NEAREST, gl::LINEAR, 0.1), (false, 0, 0.0));
    // Between a linear and a sharp filter the border is at half a level.
    assert_eq!(at(gl::NEAREST_MIPMAP_LINEAR, gl::LINEAR, 0.5), (true, 0, 0.0));
    assert_eq!(at(gl::NEAREST_MIPMAP_LINEAR, gl::LINEAR, 0.75), (false, 0, 0.75));
    assert_eq!(at(gl::LINEAR_MIPMAP_NEAREST, gl::LINEAR, 0.5), (true, 0, 0.0));
    assert_eq!(at(gl::LINEAR_MIPMAP_NEAREST, gl::LINEAR, 1.5), (true, 1, 0.0));
    assert_eq!(at(gl::LINEAR_MIPMAP_NEAREST, gl::LINEAR, 1.6), (true, 2, 0.0));
    assert_eq!(at(gl::LINEAR_MIPMAP_LINEAR, gl::LINEAR, 2.25), (true, 2, 0.25));
    assert_eq!(at(gl::LINEAR_MIPMAP_LINEAR, gl::LINEAR, 9.0), (true, 4, 0.0));
    assert_eq!(at(gl::LINEAR_MIPMAP_LINEAR, gl::LINEAR, f32::NAN), (true, 0, 0.0));
}

#[test]
fn depths_are_compared_as_told() {
    let format = InternalFormat::for_texture(gl::DEPTH_COMPONENT24).unwrap();
    let mut image = TexImage::new(format, [2, 1, 1], 0).unwrap();
    image.texels = Arc::new(Texels::Depth(vec![0.25, 0.75].into()));
    let at = |func: Enum, filter: Enum, mode: Enum, s: f32, r: f32| {
        let params = TexParams {
            compare_mode: gl::COMPARE_R_TO_TEXTURE,
            compare_func: func,
            min_filter: filter,
            mag_filter: filter,
            depth_mode: mode,
            ..TexParams::default()
        };
        let t = Sampled::new(TexTarget::Two, &params, &[vec![image.clone()]], 0.0, false).unwrap();
        t.sample([s, 0.5, 0.0], r, 0.0)
    };
    assert_eq!(at(gl::LEQUAL, gl::NEAREST, gl::LUMINANCE, 0.2, 0.25), [1.0; 4]);
    assert_eq!(at(gl::LEQUAL, gl::NEAREST, gl::LUMINANCE, 0.2, 0.3), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(at(gl::GEQUAL, gl::NEAREST, gl::INTENSITY, 0.9, 0.7), [0.0; 4]);
    assert_eq!(at(gl::GEQUAL, gl::NEAREST, gl::INTENSITY, 0.9, 7.0), [1.0; 4]);
    // Compared first, mixed then.
    assert_eq!(at(gl::LESS, gl::LINEAR, gl::ALPHA, 0.5, 0.5), [0.0, 0.0, 0.0, 0.5]);
}

#[test]
fn cube_faces_join() {
    let format = InternalFormat::for_texture(gl::RGB8).unwrap();
    let mut face = |n: u8| {
        let mut image = TexImage::new(format, [4, 4, 1], 0).unwrap();
        image.texels = Arc::new(Texels::Rgba8(vec![[n * 40, 0, 0, 255]; 16]));
        image
    };
    let images = vec![(0..6).map(&mut face).collect::<Vec<_>>()];
    let params = TexParams {
        min_filter: gl::LINEAR,
        mag_filter: gl::LINEAR,
        wrap: [gl::CLAMP_TO_EDGE; 3],
        ..TexParams::default()
    };
    let red = |seamless: bool, direction: [f32; 3]| {
        let t = Sampled::new(TexTarget::Cube, &params, &images, 0.0, seamless).unwrap();
        (t.sample(direction, 0.0, 0.0)[0] * 255.0).round()
    };
    let axes = [[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    for (n, axis) in axes.into_iter().enumerate() {
        assert_eq!(red(false, axis), 40.0 * n as f32);
        assert_eq!(red(true, axis), 40.0 * n as f32);
    }
    // On the edge of +x and +z: one of them, or half of both.
    assert_eq!(red(false, [1.0, 0.0, 1.0]), 0.0);
    assert_eq!(red(true, [1.0, 0.0, 1.0]), 80.0);
    assert_eq!(red(true, [-0.5, 1.0, -1.0]), 140.0);
}

/// The sample program of the course text, section 5.8: a chessboard on two quads, one turned away.
#[test]
fn the_chessboard_is_right_in_perspective() {
    let format = InternalFormat::for_texture(3).unwrap();
    let mut image = TexImage::new(format, [64, 64, 1], 0).unwrap();
    let texel = |i: usize| {
        let white = (i >> 3 & 1 == 0) != (i >> 9 & 1 == 0);
        [if white { 255 } else { 0 }; 3]
    };
    let texels = (0..64 * 64).map(|i| [texel(i)[0], texel(i)[1], texel(i)[2], 255]).collect();
    image.texels = Arc::new(Texels::Rgba8(texels));
    let params = TexParams {
        min_filter: gl::NEAREST,
        mag_filter: gl::NEAREST,
        wrap: [gl::CLAMP; 3],
        ..TexParams::default()
    };
    let env = TexEnv { mode: gl::DECAL, ..TexEnv::default() };
    let view = View::of_levels(params, vec![vec![image]]);
    let s = RasterState {
        units: vec![UnitState { unit: 0, env, target: TexTarget::Two, view }],
        ..RasterState::default()
    };
    let mut tex_coords = [None; crate::state::TEXTURE_UNITS];
    tex_coords[0] = Some(4);
    let layout = Layout { secondary: None, fog: None, tex_coords, stride: 8 };
    let program = Program::new(&s, Kind::Triangles, &layout, senca_raster::SimdLevel::new(), [false, false]);
    // The projection of section 5.3, and row 0 as the lowest.
    let f = 3f32.sqrt();
    let clip_from_eye = Mat4::from_cols(
        Vec4::new(f, 0.0, 0.0, 0.0),
        Vec4::new(0.0, f, 0.0, 0.0),
        Vec4::new(0.0, 0.0, -30.0 / 29.0, -1.0),
        Vec4::new(0.0, 0.0, -30.0 / 29.0, 0.0),
    );
    let far = 1.0 + std::f32::consts::SQRT_2;
    let corners = [
        (0.0, 0.0, [-2.0, -1.0, 0.0]),
        (0.0, 1.0, [-2.0, 1.0, 0.0]),
        (1.0, 1.0, [0.0, 1.0, 0.0]),
        (1.0, 0.0, [0.0, -1.0, 0.0]),
        (0.0, 0.0, [1.0, -1.0, 0.0]),
        (0.0, 1.0, [1.0, 1.0, 0.0]),
        (1.0, 1.0, [far, 1.0, -std::f32::consts::SQRT_2]),
        (1.0, 0.0, [far, -1.0, -std::f32::consts::SQRT_2]),
    ];
    let (mut positions, mut varyings) = (Vec::new(), Vec::new());
    for (u, v, point) in corners {
        let clip = clip_from_eye * (Vec3::from(point) - Vec3::Z * 3.6).extend(1.0);
        positions.push(Vec4::new(clip.x, -clip.y, clip.z, clip.w));
        varyings.extend([0.0, 0.0, 0.0, 1.0, u, v, 0.0, 1.0]);
    }
    let p = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 8,
        indices: &[0, 1, 3, 1, 2, 3, 4, 5, 7, 5, 6, 7],
        ids: Ids::Same(0),
    };
    let mut color = vec![[0, 0, 0, 255]; 400 * 400];
    let mut target = Target::new(400, 400).and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color))).unwrap();
    TiledRasterizer::default().draw(&mut target, &p, &State::default(), &Shading::Stage(&program));
    let white = |x: usize, y: usize| match color[y * 400 + x] {
        [0, 0, 0, 255] => false,
        [255, 255, 255, 255] => true,
        other => panic!("{other:?} at {x}, {y}"),
    };
    // Just above the lower side: squares alternate from black, at the places of the text.
    let changes = |y: usize, from: usize, to: usize| {
        (from..to).filter(|&x| white(x, y) != white(x - 1, y)).collect::<Vec<_>>()
    };
    assert_eq!(changes(110, 9, 200), [32, 56, 80, 104, 128, 152, 176]);
    assert_eq!(changes(200, 297, 366), [308, 319, 328, 337, 346, 353, 360]);
    assert!((104..296).all(|y| (1..400).filter(|&x| white(x, y)).all(|x| (8..367).contains(&x))));
}
