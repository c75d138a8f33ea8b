//! Lines and points: which pixels, which depths.

use senca_math::glam::Vec4;
use senca_raster::{
    Blend, Buffers, ColorPlane, Compare, Factor, Ids, Interpolation, LineStipple, Primitives, Rasterizer,
    ScanlineRasterizer, Shading, SimdLevel, State, StippleJoins, StrokeRule, Target, TiledRasterizer,
    TiledSettings,
};

const SIDE: u32 = 16;

/// Clip space of a point given in pixels of a 16 x 16 target, y down.
fn at(x: f32, y: f32, z: f32) -> Vec4 {
    Vec4::new(x / 8.0 - 1.0, 1.0 - y / 8.0, z, 1.0)
}

fn rasterizers() -> [Box<dyn Rasterizer>; 2] {
    [Box::new(ScanlineRasterizer), Box::new(TiledRasterizer::default())]
}

/// Pixels drawn, with how often.
fn drawn(points: &[Vec4], indices: &[u32], state: &State, lines: bool) -> Vec<(u32, u32, f32)> {
    let mut all = Vec::new();
    for mut rasterizer in rasterizers() {
        let mut buffers = Buffers::new(SIDE, SIDE);
        let state = State { blend: Some(Blend::ADD), depth_test: Compare::Always, ..*state };
        let p = Primitives { positions: points, varyings: &[], stride: 0, indices, ids: Ids::From(0) };
        let shading = Shading::constant([1.0; 4]);
        let mut target = buffers.target().unwrap();
        if lines {
            rasterizer.draw_lines(&mut target, &p, &state, &shading);
        } else {
            rasterizer.draw_points(&mut target, &p, &state, &shading);
        }
        let pixels =
            (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE, buffers.color.pixel(i % SIDE, i / SIDE)[0]));
        all.push(pixels.filter(|p| p.2 != 0.0).collect::<Vec<_>>());
    }
    assert_eq!(all[0], all[1]);
    all.swap_remove(0)
}

fn pixels(from: [f32; 2], to: [f32; 2]) -> Vec<(u32, u32)> {
    let points = [at(from[0], from[1], 0.5), at(to[0], to[1], 0.5)];
    let found = drawn(&points, &[0, 1], &State::default(), true);
    found.into_iter().map(|(x, y, _)| (x, y)).collect()
}

#[test]
fn straight_lines_leave_out_their_end() {
    assert_eq!(pixels([2.5, 3.5], [6.5, 3.5]), [(2, 3), (3, 3), (4, 3), (5, 3)]);
    assert_eq!(pixels([6.5, 3.5], [2.5, 3.5]), [(3, 3), (4, 3), (5, 3), (6, 3)]);
    assert_eq!(pixels([4.5, 1.5], [4.5, 4.5]), [(4, 1), (4, 2), (4, 3)]);
    assert_eq!(pixels([1.5, 1.5], [4.5, 4.5]), [(1, 1), (2, 2), (3, 3)]);
    assert_eq!(pixels([1.5, 1.5], [7.5, 3.5]), [(1, 1), (2, 1), (3, 2), (4, 2), (5, 2), (6, 3)]);
    assert!(pixels([3.5, 3.5], [3.5, 3.5]).is_empty());
}

#[test]
fn joined_lines_share_no_pixel() {
    let points: Vec<Vec4> =
        [[2.5, 2.5], [12.5, 4.5], [13.5, 12.5], [3.5, 11.5]].map(|[x, y]| at(x, y, 0.5)).to_vec();
    let closed = drawn(&points, &[0, 1, 1, 2, 2, 3, 3, 0], &State::default(), true);
    assert!(closed.iter().all(|p| p.2 == 1.0), "{closed:?}");
    assert_eq!(closed.len(), 10 + 8 + 10 + 9);
}

#[test]
fn lines_are_cut_in_homogeneous_space() {
    // From behind the eye: only the part in front of the near plane is seen.
    let points = [Vec4::new(0.0, 0.0, -1.0, -0.5), Vec4::new(0.45, 0.03, 0.5, 1.0)];
    let found = drawn(&points, &[0, 1], &State::default(), true);
    assert!(!found.is_empty() && found.iter().all(|p| p.0 >= 8), "{found:?}");
    assert!(pixels([-200.0, 3.5], [216.0, 3.5]).len() == 16);
    assert!(pixels([-2e7, 3.5], [2e7, 3.6]).len() == 16);
    assert!(pixels([2.0, -5.0], [9.0, -1.0]).is_empty());
    assert!(pixels([f32::NAN, 1.0], [3.0, 3.0]).is_empty());
}

#[test]
fn wide_lines_and_large_points_are_centred() {
    let wide = State { line_width: 3.0, point_size: 3.0, ..State::default() };
    let points = [at(2.5, 6.5, 0.5), at(5.5, 6.5, 0.5)];
    let found: Vec<_> = drawn(&points, &[0, 1], &wide, true).into_iter().map(|p| (p.0, p.1)).collect();
    assert_eq!(found, [(2, 5), (3, 5), (4, 5), (2, 6), (3, 6), (4, 6), (2, 7), (3, 7), (4, 7)]);
    let point: Vec<_> = drawn(&points, &[0], &wide, false).into_iter().map(|p| (p.0, p.1)).collect();
    assert_eq!(point, [(1, 5), (2, 5), (3, 5), (1, 6), (2, 6), (3, 6), (1, 7), (2, 7), (3, 7)]);
    let one: Vec<_> =
        drawn(&points, &[1], &State::default(), false).into_iter().map(|p| (p.0, p.1)).collect();
    assert_eq!(one, [(5, 6)]);
}

#[test]
fn lines_have_depth_and_perspective() {
    // w runs from 1 to 3: the middle of the image is a quarter along.
    let points = [Vec4::new(-1.0, 0.0, 0.0, 1.0), Vec4::new(3.0, 0.0, 3.0, 3.0)];
    for (interpolation, middle) in [(Interpolation::Perspective, 0.25), (Interpolation::Screen, 0.5)] {
        let mut buffers = Buffers::new(100, 1);
        let varyings = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let p = Primitives {
            positions: &points,
            varyings: &varyings,
            stride: 3,
            indices: &[0, 1],
            ids: Ids::From(0),
        };
        let state = State { interpolation, ..State::default() };
        let mut target = buffers.target().unwrap();
        let c = ScanlineRasterizer.draw_lines(&mut target, &p, &state, &Shading::vertex_rgb());
        assert_eq!((c.primitives, c.drawn, c.passed), (1, 1, 100));
        assert!((buffers.color.pixel(50, 0)[0] - middle).abs() < 0.01);
        assert!((buffers.depth[50] - 0.5).abs() < 0.01);
    }
}

/// Scattered places, some outside the view volume or behind the eye.
fn scattered(count: u32) -> Vec<Vec4> {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    (0..count)
        .map(|_| {
            let w = 4.0 * next() - 0.5;
            let [x, y] = [2.6 * next() - 1.3, 2.6 * next() - 1.3];
            Vec4::new(x * w, y * w, next() * w, w)
        })
        .collect()
}

#[test]
fn any_number_of_threads_draws_the_same() {
    let places = scattered(1500);
    let indices: Vec<u32> = (0..1500).collect();
    let colors: Vec<f32> = (0..1500 * 3).map(|i| (i % 97) as f32 / 96.0).collect();
    let p =
        Primitives { positions: &places, varyings: &colors, stride: 3, indices: &indices, ids: Ids::From(7) };
    for (width, height) in [(61, 47), (1, 90), (90, 1), (1, 1)] {
        for (size, blend) in [(1.0, None), (5.0, Some(Blend::MULTIPLY)), (2.0, Some(Blend::ADD))] {
            let scissor = (size == 5.0).then_some(senca_raster::Rect { x: 3, y: 5, width: 40, height: 30 });
            let state = State { line_width: size, point_size: size, blend, scissor, ..State::default() };
            let draw = |rasterizer: &mut dyn Rasterizer| {
                let mut buffers = Buffers::with_ids(width, height);
                let mut target = buffers.target().unwrap();
                let lines = rasterizer.draw_lines(&mut target, &p, &state, &Shading::vertex_rgb());
                let points = rasterizer.draw_points(&mut target, &p, &state, &Shading::vertex_rgb());
                (buffers.color, buffers.depth, buffers.ids, lines, points)
            };
            let plain = draw(&mut ScanlineRasterizer);
            for threads in [1, 2, 3, 7] {
                let settings = TiledSettings { threads, ..TiledSettings::default() };
                assert!(draw(&mut TiledRasterizer::new(settings)) == plain, "{width}x{height}, {threads}");
            }
        }
    }
}

const OPENGL: State = State {
    viewport: None,
    scissor: None,
    cull: senca_raster::Cull::None,
    depth_test: Compare::Always,
    depth_write: true,
    depth_range: [0.0, 1.0],
    depth_bias: senca_raster::DepthBias { constant: 0.0, slope: 0.0 },
    interpolation: Interpolation::Perspective,
    blend: None,
    clear: None,
    clear_area: None,
    line_width: 1.0,
    point_size: 1.0,
    point_sizes: None,
    strokes: StrokeRule::OpenGl,
    stipple: None,
    multisample: false,
    stencil: None,
    antialias: false,
};

fn by_opengl(from: [f32; 2], to: [f32; 2]) -> Vec<(u32, u32)> {
    let points = [at(from[0], from[1], 0.5), at(to[0], to[1], 0.5)];
    drawn(&points, &[0, 1], &OPENGL, true).into_iter().map(|(x, y, _)| (x, y)).collect()
}

#[test]
fn lines_of_opengl_own_the_diamonds_they_leave() {
    // Begun beyond the centre: inside the diamond the pixel is left, outside it was never entered.
    assert_eq!(by_opengl([2.75, 3.5], [5.25, 3.5]), [(2, 3), (3, 3), (4, 3)]);
    assert_eq!(by_opengl([2.75, 3.9], [5.25, 3.9]), [(3, 3), (4, 3)]);
    // Ended beyond the centre: inside the diamond it is not left.
    assert_eq!(by_opengl([2.5, 3.5], [5.75, 3.5]), [(2, 3), (3, 3), (4, 3)]);
    assert_eq!(by_opengl([2.5, 3.9], [5.75, 3.9]), [(2, 3), (3, 3), (4, 3), (5, 3)]);
    // All of it in one diamond.
    assert!(by_opengl([2.3, 3.5], [2.7, 3.5]).is_empty());
    // On the border of rows and columns: a little lower and to the left.
    assert_eq!(by_opengl([2.0, 4.0], [5.0, 4.0]), [(2, 3), (3, 3), (4, 3)]);
    assert_eq!(by_opengl([5.0, 4.0], [5.0, 7.0]), [(4, 4), (4, 5), (4, 6)]);
}

#[test]
fn points_of_opengl_lie_about_their_pixel() {
    let point = |x: f32, y: f32, size: f32| {
        let state = State { point_size: size, ..OPENGL };
        drawn(&[at(x, y, 0.5)], &[0], &state, false).into_iter().map(|p| (p.0, p.1)).collect::<Vec<_>>()
    };
    assert_eq!(point(5.0, 7.0, 1.0), [(5, 7)]);
    assert_eq!(point(5.99, 7.3, 1.0), [(5, 7)]);
    assert_eq!(point(5.0, 7.0, 2.0), [(4, 6), (5, 6), (4, 7), (5, 7)]);
    assert_eq!(point(5.6, 7.0, 1.6), [(5, 6), (6, 6), (5, 7), (6, 7)]);
    assert_eq!(point(5.5, 7.5, 3.0).len(), 9);
}

#[test]
fn stipple_runs_on_from_line_to_line() {
    let points: Vec<Vec4> = [[0.5, 2.5], [6.5, 2.5], [12.5, 2.5]].map(|[x, y]| at(x, y, 0.5)).to_vec();
    let stipple = Some(LineStipple { factor: 2, pattern: 0x5555, joins: StippleJoins::ByIndex });
    for rule in [StrokeRule::Centres, StrokeRule::OpenGl] {
        let state = State { stipple, strokes: rule, ..State::default() };
        let columns = |indices: &[u32]| {
            drawn(&points, indices, &state, true).into_iter().map(|p| p.0).collect::<Vec<_>>()
        };
        assert_eq!(columns(&[0, 1, 1, 2]), [0, 1, 4, 5, 8, 9]);
        assert_eq!(columns(&[1, 2, 0, 1]), [0, 1, 4, 5, 6, 7, 10, 11]);
    }
}

#[test]
fn antialiased_lines_and_points_have_their_area() {
    for (size, along) in [(1.0, 10.0), (2.5, 7.0), (0.5, 4.0)] {
        let (dx, dy) = (along * 0.6, along * 0.8);
        let points = [at(4.3, 3.1, 0.5), at(4.3 + dx, 3.1 + dy, 0.5)];
        let state = State { antialias: true, line_width: size, point_size: size, ..State::default() };
        for lines in [true, false] {
            let mut sums = Vec::new();
            for mut rasterizer in rasterizers() {
                let mut buffers = Buffers::new(SIDE, SIDE);
                let state = State { blend: Some(Blend::ADD), depth_test: Compare::Always, ..state };
                let p = Primitives {
                    positions: &points,
                    varyings: &[],
                    stride: 0,
                    indices: if lines { &[0, 1] } else { &[0] },
                    ids: Ids::Same(1),
                };
                let mut target = buffers.target().unwrap();
                let shading = Shading::constant([1.0; 4]);
                if lines {
                    rasterizer.draw_lines(&mut target, &p, &state, &shading);
                } else {
                    rasterizer.draw_points(&mut target, &p, &state, &shading);
                }
                sums.push(buffers.color.pixels().iter().map(|p| p[3]).sum::<f32>());
            }
            let area = if lines { size * along } else { std::f32::consts::PI * size * size / 4.0 };
            assert!(sums[0] == sums[1] && (sums[0] - area).abs() < 0.02, "{sums:?} {area}");
        }
    }
}

#[test]
fn antialiased_neighbours_add_up_to_one() {
    let points = [[2.3, 1.7], [13.1, 3.2], [12.2, 14.4], [1.1, 12.9]].map(|[x, y]| at(x, y, 0.5));
    let p = Primitives {
        positions: &points,
        varyings: &[],
        stride: 0,
        indices: &[0, 1, 2, 0, 2, 3],
        ids: Ids::Same(1),
    };
    for mut rasterizer in rasterizers() {
        let mut buffers = Buffers::new(SIDE, SIDE);
        let state = State {
            antialias: true,
            blend: Some(Blend::ADD),
            depth_test: Compare::Always,
            ..State::default()
        };
        rasterizer.draw(&mut buffers.target().unwrap(), &p, &state, &Shading::constant([1.0; 4]));
        assert!((buffers.color.pixel(7, 7)[3] - 1.0).abs() < 1e-5);
        let most = buffers.color.pixels().iter().map(|p| p[3]).fold(0.0, f32::max);
        assert!(most < 1.000_01);
    }
}

#[test]
fn plain_colours_take_the_short_way_to_the_same_pixels() {
    let places = scattered(1500);
    let indices: Vec<u32> = (0..1500).collect();
    let colors: Vec<f32> = (0..1500 * 3).map(|i| (i % 97) as f32 / 96.0).collect();
    let p =
        Primitives { positions: &places, varyings: &colors, stride: 3, indices: &indices, ids: Ids::Same(0) };
    let same = Blend { source: Factor::One, destination: Factor::Zero };
    let scissor = Some(senca_raster::Rect { x: 3, y: 5, width: 40, height: 30 });
    let states = [
        State::default(),
        State { strokes: StrokeRule::OpenGl, point_size: 3.0, ..State::default() },
        State { interpolation: Interpolation::FlatLast, scissor, ..State::default() },
        State { interpolation: Interpolation::Screen, depth_write: false, ..State::default() },
    ];
    for state in states {
        let draw = |blend: Option<Blend>, level: SimdLevel| {
            let (mut color, mut depth) = (vec![[7u8; 4]; 61 * 47], vec![1f32; 61 * 47]);
            let mut target = Target::new(61, 47)
                .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut color)))
                .and_then(|t| t.with_depth(&mut depth))
                .unwrap();
            let state = State { blend, ..state };
            let mut rasterizer = TiledRasterizer::new(TiledSettings { level, ..TiledSettings::default() });
            let lines = rasterizer.draw_lines(&mut target, &p, &state, &Shading::vertex_rgb());
            let points = rasterizer.draw_points(&mut target, &p, &state, &Shading::vertex_rgb());
            (color, depth, lines, points)
        };
        let expected = draw(Some(same), SimdLevel::baseline());
        assert!([SimdLevel::baseline(), SimdLevel::new()].iter().all(|level| draw(None, *level) == expected));
    }
}
