//! Depths kept in blocks are those that are drawn into a plane of depths.

use senca_math::glam::Vec4;
use senca_raster::simd::dispatch;
use senca_raster::{
    BlockDepths, Buffers, Clear, Compare, Counters, Cull, DepthBias, Draw, Ids, Primitives, Rect, SAMPLES,
    Shading, SimdLevel, State, Target, TiledRasterizer, TiledSettings,
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

#[derive(Default)]
struct Mesh {
    positions: Vec<Vec4>,
    indices: Vec<u32>,
}

impl Mesh {
    fn primitives(&self) -> Primitives<'_> {
        Primitives {
            positions: &self.positions,
            varyings: &[],
            stride: 0,
            indices: &self.indices,
            ids: Ids::Same(0),
        }
    }

    /// A tilted floor of `cells` x `cells` squares.
    fn floor(r: &mut Random, cells: u32) -> Self {
        let mut mesh = Self::default();
        let (tilt, turn) = (r.within(-0.3, 0.3), r.within(-0.2, 0.2));
        for y in 0..=cells {
            for x in 0..=cells {
                let [u, v] = [x, y].map(|n| 2.4 * n as f32 / cells as f32 - 1.2);
                let w = 1.0 + 0.2 * v;
                mesh.positions.push(Vec4::new(u + turn * v, v - turn * u, (0.5 + tilt * u) * w, w));
            }
        }
        for y in 0..cells {
            for x in 0..cells {
                let [a, b] = [y * (cells + 1) + x, (y + 1) * (cells + 1) + x];
                mesh.indices.extend([a, a + 1, b, a + 1, b + 1, b]);
            }
        }
        mesh
    }

    /// Triangles of all sizes, some across the near plane.
    fn random(r: &mut Random, triangles: usize) -> Self {
        let mut mesh = Self::default();
        for n in 0..triangles {
            let size = [0.02, 0.1, 0.5, 3.0][n % 4];
            let (x, y) = (r.within(-1.2, 1.2), r.within(-1.2, 1.2));
            for k in 0..3 {
                let w = r.within(-0.1, 3.0);
                let (dx, dy) = (r.within(-size, size), r.within(-size, size));
                mesh.positions.push(Vec4::new((x + dx) * w, (y + dy) * w, r.within(0.0, 1.0) * w, w));
                mesh.indices.push((3 * n + k) as u32);
            }
        }
        mesh
    }
}

/// The same triangles drawn into both: all depths must be equal.
fn check(size: [u32; 2], draws: &[(Primitives<'_>, State)], threads: usize, level: SimdLevel) {
    let [width, height] = size;
    let mut rasterizer = TiledRasterizer::new(TiledSettings { threads, level });
    let mut buffers = Buffers::new(width, height);
    let mut blocks = BlockDepths::new(width, height, 1.0).unwrap();
    for draws in draws.chunks(2) {
        let plain: Vec<Draw<'_>> = draws
            .iter()
            .map(|(triangles, state)| Draw { triangles: *triangles, state: *state, shading: Shading::None })
            .collect();
        let mut target = Target::new(width, height).unwrap().with_depth(&mut buffers.depth).unwrap();
        let counted = rasterizer.draw_all(&mut target, &plain);
        let in_blocks = rasterizer.draw_depths(&mut blocks, draws);
        // What is known to be hidden without a test differs.
        assert_eq!(counted, Counters { tested: counted.tested, ..in_blocks });
        assert!(buffers.depth == blocks.to_rows(), "{size:?} {:?}", draws[0].1.depth_test);
    }
    for (i, depth) in buffers.depth.iter().enumerate() {
        assert_eq!(*depth, blocks.get(i as u32 % width, i as u32 / width));
    }
}

fn state(depth_test: Compare, clear: Option<f32>) -> State {
    let clear = clear.map(|depth| Clear { color: None, depth: Some(depth), id: None, stencil: None });
    State { depth_test, clear, cull: Cull::None, ..State::default() }
}

#[test]
fn floors_and_all_kinds_of_triangles_have_the_same_depths() {
    let mut r = Random(7);
    for size in [[64, 64], [200, 120], [257, 131], [512, 384]] {
        for (nearer, clear) in [
            (Compare::Less, 1.0),
            (Compare::LessEqual, 1.0),
            (Compare::Greater, 0.0),
            (Compare::GreaterEqual, 0.0),
            (Compare::Less, 0.5),
        ] {
            let floors = [Mesh::floor(&mut r, 1), Mesh::floor(&mut r, 5)];
            let things = Mesh::random(&mut r, 200);
            let bias = State { depth_bias: DepthBias { constant: 1e-4, slope: 1.5 }, ..state(nearer, None) };
            let part = Rect { x: 13, y: 9, width: size[0] / 2, height: size[1] / 2 };
            let draws = [
                (floors[0].primitives(), state(nearer, Some(clear))),
                (things.primitives(), bias),
                (floors[1].primitives(), state(nearer, None)),
                (things.primitives(), State { scissor: Some(part), ..state(nearer, None) }),
                (floors[1].primitives(), state(nearer, Some(clear))),
                (floors[0].primitives(), state(Compare::Equal, None)),
                (things.primitives(), state(Compare::Always, None)),
                (floors[0].primitives(), state(Compare::Greater, None)),
                (floors[1].primitives(), state(Compare::Less, None)),
            ];
            check(size, &draws, 2, SimdLevel::new());
            check(size, &draws, 1, SimdLevel::baseline());
        }
    }
}

#[test]
fn depths_drawn_when_somebody_looks_are_those_drawn_at_once() {
    let mut r = Random(11);
    let (floor, things) = (Mesh::floor(&mut r, 6), Mesh::random(&mut r, 120));
    let size = [257, 131];
    for (nearer, clear) in [(Compare::Less, 1.0), (Compare::GreaterEqual, 0.0)] {
        let bias = State { depth_bias: DepthBias { constant: -1e-4, slope: -1.5 }, ..state(nearer, None) };
        let part = Rect { x: 13, y: 9, width: 90, height: 70 };
        let draws = [
            vec![(floor.primitives(), state(nearer, Some(clear))), (things.primitives(), bias)],
            vec![(things.primitives(), State { scissor: Some(part), ..state(nearer, None) })],
            vec![(floor.primitives(), state(Compare::Always, None))],
            vec![(things.primitives(), state(nearer, Some(clear)))],
            // A clear in the middle: at once.
            vec![
                (floor.primitives(), state(nearer, None)),
                (things.primitives(), state(nearer, Some(clear))),
            ],
            vec![(floor.primitives(), state(nearer, Some(0.5)))],
            vec![(things.primitives(), State { scissor: Some(part), ..state(nearer, Some(clear)) })],
        ];
        // Up to each of them, so that tiles wait when the next ones come.
        for end in 1..=draws.len() {
            let mut rasterizer = TiledRasterizer::new(TiledSettings { threads: 2, level: SimdLevel::new() });
            let [mut at_once, mut later] = [0.25; 2].map(|z| BlockDepths::new(size[0], size[1], z).unwrap());
            for draws in &draws[..end] {
                rasterizer.draw_depths(&mut at_once, draws);
                rasterizer.draw_depths_when_read(&mut later, draws);
                for _ in 0..3 {
                    let [x, y] = size.map(|n| (n as f32 * r.next()) as u32);
                    assert_eq!(later.get(x, y), at_once.get(x, y), "{nearer:?}, {end}: {x}, {y}");
                }
            }
            assert!(later.clone().to_rows() == at_once.to_rows(), "{nearer:?}, {end}");
            assert!(later.to_rows() == at_once.to_rows(), "{nearer:?}, {end}");
        }
    }
}

#[test]
fn many_threads_look_at_the_same_tiles() {
    let mut r = Random(5);
    let things = Mesh::random(&mut r, 300);
    let (mut rasterizer, mut depths) = (TiledRasterizer::default(), BlockDepths::new(300, 200, 0.0).unwrap());
    let draws = [(things.primitives(), state(Compare::Less, Some(1.0)))];
    rasterizer.draw_depths(&mut depths, &draws);
    let expected = depths.to_rows();
    for _ in 0..20 {
        rasterizer.draw_depths_when_read(&mut depths, &draws);
        let depths = &depths;
        std::thread::scope(|scope| {
            let looks = [0, 1, 2, 3].map(|_| scope.spawn(|| depths.to_rows()));
            assert!(looks.into_iter().all(|look| look.join().unwrap() == expected));
        });
    }
}

#[test]
fn squares_are_gathered_across_blocks() {
    let mut r = Random(3);
    let (floor, things) = (Mesh::floor(&mut r, 9), Mesh::random(&mut r, 40));
    let mut blocks = BlockDepths::new(150, 90, 1.0).unwrap();
    let draws = [
        (floor.primitives(), state(Compare::Less, Some(1.0))),
        (things.primitives(), state(Compare::Less, None)),
    ];
    TiledRasterizer::default().draw_depths(&mut blocks, &draws);
    let rows = blocks.to_rows();
    for _ in 0..200 {
        let [x, y] = [149.0, 89.0].map(|n| std::array::from_fn(|_| (n * r.next()) as i32));
        let (x1, y1) = (x.map(|x: i32| (x + 1) % 150), y.map(|y: i32| y + 1));
        let (mut square, mask) = ([[0.0; 16]; SAMPLES], (65_536.0 * r.next()) as u16);
        let level = SimdLevel::new();
        dispatch!(level, simd => blocks.gather(simd, mask, [&x, &x1], [&y, &y1], &mut square));
        for lane in (0..16).filter(|lane| mask >> lane & 1 == 1) {
            let at = |x: i32, y: i32| rows[(y * 150 + x) as usize];
            let [a, b, c, d] = [(x, y), (x1, y), (x, y1), (x1, y1)].map(|(x, y)| at(x[lane], y[lane]));
            assert_eq!(square.map(|depths| depths[lane]), [a, b, c, d]);
        }
    }
}

#[test]
fn an_empty_picture_has_the_depth_it_was_made_with() {
    let blocks = BlockDepths::new(70, 3, 0.25).unwrap();
    assert_eq!((blocks.width(), blocks.height()), (70, 3));
    assert_eq!(blocks.to_rows(), vec![0.25; 210]);
    assert_eq!((blocks.get(69, 2), blocks.get(70, 0), blocks.get(0, 3)), (0.25, 0.0, 0.0));
    assert!(BlockDepths::new(70_000, 1, 0.0).is_err());
    assert!(BlockDepths::new(0, 9, 1.0).unwrap().to_rows().is_empty());
}
