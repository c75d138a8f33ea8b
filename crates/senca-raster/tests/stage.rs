//! Per-fragment operations by the caller's code: both rasterizers hand over the same fragments and
//! pixels.

use senca_math::glam::Vec4;
use senca_raster::{
    Blend, Clear, ClearMasks, ColorPlane, Compare, Draw, FragmentStage, Fragments, Ids, PixelColors, Pixels,
    Primitives, Rasterizer, Rect, ScanlineRasterizer, Shaded, Shading, State, StencilOp, StencilTest, Target,
    TiledRasterizer, TiledSettings,
};

/// Counts coverage in the stencil plane, adds colours, and drops what it is told to.
#[derive(Clone, Copy, Default)]
struct Counting {
    tests_depth: bool,
    keeps_all: bool,
    compare: Compare,
}

impl FragmentStage for Counting {
    fn tests_depth(&self) -> bool {
        self.tests_depth
    }

    fn discards(&self) -> bool {
        !self.keeps_all
    }

    fn shade(&self, f: &Fragments<'_>, out: &mut Shaded) {
        for i in f.lanes() {
            let [dx, dy] = f.derivatives(&f.varyings[0], i);
            out.set(i, [f.varyings[1][i], dx + dy, f.depth[i], f.varyings[2][i]]);
            if !self.keeps_all && (f.column(i) + 3 * f.row(i)).is_multiple_of(5) {
                out.discard(i);
            }
        }
    }

    fn merge(&self, f: &Fragments<'_>, shaded: &Shaded, pixels: &mut Pixels<'_>) -> u16 {
        let mut passed = 0;
        for i in f.lanes() {
            let Some(depth) = &mut pixels.depth else { return 0 };
            let Some(stencil) = &mut pixels.stencil else { return 0 };
            stencil[i] = stencil[i].wrapping_add(1);
            if self.tests_depth {
                if !self.compare.passes(f.depth[i], depth[i]) {
                    stencil[i] ^= 0x80;
                    continue;
                }
                depth[i] = f.depth[i];
            }
            if !self.keeps_all && stencil[i] & 7 == 7 {
                continue;
            }
            match &mut pixels.color {
                PixelColors::None => {}
                PixelColors::Rgba8(p) => p[i] ^= (shaded.rgba[0][i] * 65_536.0) as u32 | u32::from(f.front),
                PixelColors::Rgba32F(p) => (0..4).for_each(|k| p[k][i] += shaded.rgba[k][i]),
            }
            passed |= 1 << i;
        }
        passed
    }
}

struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
}

/// Triangles of all sizes, and nearly all of the screen now and then.
fn triangles(count: u32) -> (Vec<Vec4>, Vec<f32>, Vec<u32>) {
    let mut r = Random(u64::from(count));
    let (mut positions, mut varyings) = (Vec::new(), Vec::new());
    for n in 0..count {
        let size = [0.02, 0.1, 0.5, 3.0][n as usize % 4];
        let (x, y) = (2.6 * r.next() - 1.3, 2.6 * r.next() - 1.3);
        for _ in 0..3 {
            let w = 0.2 + 2.0 * r.next();
            let (dx, dy) = (size * (2.0 * r.next() - 1.0), size * (2.0 * r.next() - 1.0));
            positions.push(Vec4::new((x + dx) * w, (y + dy) * w, (1.2 * r.next() - 0.1) * w, w));
            varyings.extend([r.next(), r.next(), r.next()]);
        }
    }
    (positions, varyings, (0..3 * count).collect())
}

struct Planes {
    size: [u32; 2],
    color8: Vec<[u8; 4]>,
    color: Vec<[f32; 4]>,
    depth: Vec<f32>,
    stencil: Vec<u8>,
    ids: Vec<u32>,
}

impl Planes {
    fn new(size: [u32; 2], depth: f32) -> Self {
        let n = (size[0] * size[1]) as usize;
        Self {
            size,
            color8: vec![[1, 2, 3, 4]; n],
            color: vec![[0.25; 4]; n],
            depth: vec![depth; n],
            stencil: vec![3; n],
            ids: vec![9; n],
        }
    }

    fn target(&mut self, floats: bool) -> Target<'_> {
        let color =
            if floats { ColorPlane::Rgba32F(&mut self.color) } else { ColorPlane::Rgba8(&mut self.color8) };
        Target::new(self.size[0], self.size[1])
            .and_then(|t| t.with_color(color))
            .and_then(|t| t.with_depth(&mut self.depth))
            .and_then(|t| t.with_stencil(&mut self.stencil))
            .and_then(|t| t.with_ids(&mut self.ids))
            .unwrap()
    }

    fn bits(&self) -> (Vec<u8>, Vec<u32>) {
        let bytes = self.color8.iter().flatten().chain(&self.stencil).copied().collect();
        let floats = self.color.iter().flatten().chain(&self.depth).map(|v| v.to_bits());
        (bytes, floats.chain(self.ids.iter().copied()).collect())
    }
}

#[test]
fn both_rasterizers_run_stages_alike() {
    let (positions, varyings, indices) = triangles(300);
    let p = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 3,
        indices: &indices,
        ids: Ids::From(100),
    };
    for compare in [Compare::Less, Compare::GreaterEqual, Compare::Greater, Compare::Always] {
        for k in 0..8 {
            let stage = Counting { tests_depth: k & 1 != 0, keeps_all: k & 2 != 0, compare };
            let cleared = Clear { depth: Some(0.5), stencil: Some(6), ..Clear::default() };
            let state = State {
                depth_test: compare,
                clear: (k & 4 != 0).then_some(cleared),
                scissor: (k == 3).then_some(Rect { x: 3, y: 5, width: 60, height: 50 }),
                ..State::default()
            };
            let draw = |rasterizer: &mut dyn Rasterizer, floats: bool, multisample: bool| {
                let mut planes = Planes::new(if multisample { [102, 78] } else { [101, 77] }, 0.5);
                let state = State { multisample, ..state };
                let c = rasterizer.draw(&mut planes.target(floats), &p, &state, &Shading::Stage(&stage));
                let l =
                    rasterizer.draw_lines(&mut planes.target(floats), &p, &state, &Shading::Stage(&stage));
                (planes.bits(), c.passed, l.passed)
            };
            for (floats, multisample) in [(false, false), (true, false), (false, true), (true, true)] {
                let plain = draw(&mut ScanlineRasterizer, floats, multisample);
                assert!(plain.1 > 0 && plain.2 > 0);
                for threads in [1, 3] {
                    let settings = TiledSettings { threads, ..TiledSettings::default() };
                    let tiled = draw(&mut TiledRasterizer::new(settings), floats, multisample);
                    assert!(plain == tiled, "{compare:?}, {k}, {threads} threads, {multisample}");
                }
            }
        }
    }
}

/// A stencil test of some kind.
fn stencil_test(k: usize) -> StencilTest {
    use StencilOp::{Decrement, DecrementWrap, Increment, IncrementWrap, Invert, Keep, Replace, Zero};
    let ops = [Increment, Decrement, Keep, Replace, Zero, IncrementWrap, DecrementWrap, Invert];
    let compares = [
        Compare::Always,
        Compare::Equal,
        Compare::NotEqual,
        Compare::Less,
        Compare::LessEqual,
        Compare::Greater,
        Compare::GreaterEqual,
        Compare::Never,
    ];
    StencilTest {
        compare: compares[k / 3 % 8],
        reference: (3 + k % 5) as u8,
        value_mask: [0xff, 0x0f, 0x55][k % 3],
        write_mask: [0xff, 0xff, 0x3c, 0][k % 4],
        fail: if k % 4 == 1 { Keep } else { ops[k % 8] },
        depth_fail: if k % 4 == 1 { Keep } else { ops[(k + 3) % 8] },
        pass: ops[(k + 5) % 8],
    }
}

#[test]
fn draws_together_are_draws_one_after_another() {
    let (positions, varyings, indices) = triangles(90);
    let compares = [Compare::LessEqual, Compare::Greater, Compare::Always, Compare::Less, Compare::Equal];
    let stage = Counting { keeps_all: true, ..Counting::default() };
    let dropping = Counting { tests_depth: true, compare: Compare::GreaterEqual, ..Counting::default() };
    let late = Counting { compare: Compare::Less, ..stage };
    for n in 0..60usize {
        let draw = |k: usize| {
            let at = (7 * n + 31 * k) % 240;
            let cleared = Clear { depth: Some(0.9), stencil: Some(4), ..Clear::default() };
            let state = State {
                depth_test: compares[(n + 2 * k) % 5],
                depth_write: (n + k) % 4 != 1,
                stencil: (!(n ^ k).is_multiple_of(3)).then(|| stencil_test(n + 5 * k)),
                blend: ((n + k) % 7 == 2).then_some(Blend::ADD),
                clear: (k == 0 && n % 2 == 0 || n == 9 && k == 2).then_some(cleared),
                scissor: (n + k == 11).then_some(Rect { x: 3, y: 5, width: 60, height: 50 }),
                multisample: n % 4 >= 2,
                ..State::default()
            };
            let shading = match (n / 4 + k) % 5 {
                0 | 3 => Shading::None,
                1 => Shading::constant([0.2, 0.3, 0.1, 0.5]),
                2 => Shading::Stage(&late),
                _ => Shading::Stage(if n % 3 == 0 { &dropping } else { &stage }),
            };
            let triangles = Primitives {
                positions: &positions,
                varyings: &varyings,
                stride: 3,
                indices: &indices[at..(at + 30 + 60 * (k % 2)).min(270)],
                ids: Ids::From(10 * k as u32),
            };
            Draw { triangles, state, shading }
        };
        let draws: Vec<Draw<'_>> = (0..4).map(draw).collect();
        let with = |draw: &mut dyn FnMut(&mut Target<'_>)| {
            let mut planes = Planes::new([146, 130], 0.5);
            // Identifiers keep the rasterizer from some short cuts.
            let ids = std::mem::take(&mut planes.ids);
            let mut target = Target::new(146, 130)
                .and_then(|t| t.with_color(ColorPlane::Rgba8(&mut planes.color8)))
                .and_then(|t| t.with_depth(&mut planes.depth))
                .and_then(|t| t.with_stencil(&mut planes.stencil))
                .unwrap();
            draw(&mut target);
            planes.ids = ids;
            planes.bits()
        };
        let plain = with(&mut |target| {
            for d in &draws {
                ScanlineRasterizer.draw(target, &d.triangles, &d.state, &d.shading);
            }
        });
        for threads in [1, 3] {
            let settings = TiledSettings { threads, ..TiledSettings::default() };
            let together = with(&mut |target| {
                TiledRasterizer::new(settings).draw_all(target, &draws);
            });
            assert!(plain == together, "number {n}, {threads} threads");
        }
    }
}

#[test]
fn a_stage_that_drops_nothing_counts_what_passes() {
    // Without a depth test every covered fragment is counted once: the sum over the plane is the count.
    let (positions, varyings, indices) = triangles(40);
    let p = Primitives {
        positions: &positions,
        varyings: &varyings,
        stride: 3,
        indices: &indices,
        ids: Ids::Same(1),
    };
    let mut planes = Planes::new([64, 64], 1.0);
    planes.stencil.fill(0);
    let stage = Counting { keeps_all: true, ..Counting::default() };
    let state = State { depth_test: Compare::Always, ..State::default() };
    let c = TiledRasterizer::default().draw(&mut planes.target(true), &p, &state, &Shading::Stage(&stage));
    let sum: u64 = planes.stencil.iter().map(|&v| u64::from(v)).sum();
    assert_eq!(sum, c.passed);
}

#[test]
fn clearing_heeds_masks_and_area() {
    let mut planes = Planes::new([8, 4], 0.5);
    let clear = Clear { color: Some([1.0; 4]), depth: None, id: Some(5), stencil: Some(0xff) };
    let masks = ClearMasks { color: [true, false, false, true], stencil: 0xf0 };
    planes.target(false).clear_masked(&clear, Rect { x: 6, y: -2, width: 90, height: 4 }, &masks);
    for y in 0..4 {
        for x in 0..8 {
            let i = y * 8 + x;
            let inside = x >= 6 && y < 2;
            assert_eq!(planes.color8[i], if inside { [255, 2, 3, 255] } else { [1, 2, 3, 4] });
            assert_eq!(planes.stencil[i], if inside { 0xf3 } else { 3 });
            assert_eq!((planes.ids[i], planes.depth[i]), (if inside { 5 } else { 9 }, 0.5));
        }
    }
}
