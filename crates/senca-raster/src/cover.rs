//! The pixels of one triangle in one tile: coverage, depth, colour, sixteen at a time.
//!
//! 1. Edge functions at the tile's pixel centres are exact integers (Pineda 1988). A centre is inside
//!    when all three are at least 0, those of edges that are neither left nor top less one (the
//!    top-left rule). Steps from pixel to pixel are multiples of 256, so the low 8 bits never matter
//!    and are shifted out; what is left of an edge that crosses the tile fits 32 bits (see
//!    [`TileEdges`]). Edges that do not cross are settled once per tile.
//! 2. Blocks of 8 x 8 pixels wholly outside an edge, or wholly behind what is there, are passed over.
//! 3. A vector is two rows of 8 pixels. Depth is tested before anything is interpolated.

use crate::api::{
    ColorSource, Compare, Fragments, Interpolation, LANES, MAX_VARYINGS, Shaded, Shading, State,
};
use crate::assemble::TriangleVaryings;
use crate::bin::pixel_box;
use crate::blend::{Rgba, blended, pack, unpack};
use crate::setup::{Bounds, HALF, Plane, SUB, ScreenMap, ScreenVertex, Setup, SetupState};
use crate::shade::{interpolate, shade_plain};
use crate::target::Clear;
use crate::tile::{BLOCKS, Band, ColorFormat, TileBuffer};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};

/// What a draw's kernel needs to know, the same for all its triangles.
pub(crate) struct Pass<'a> {
    pub(crate) map: &'a ScreenMap,
    pub(crate) state: &'a State,
    pub(crate) setup: SetupState,
    pub(crate) shading: &'a Shading<'a>,
    pub(crate) clear: Option<Clear>,
    pub(crate) format: ColorFormat,
    pub(crate) has_depth: bool,
    pub(crate) has_ids: bool,
    pub(crate) writes_depth: bool,
    /// The depth test passes nothing that is farther than what is there.
    pub(crate) hides_farther: bool,
    /// How fragments are coloured.
    pub(crate) color: ColorPath,
    /// Most varyings the colour path reads, for built-in shading.
    pub(crate) interpolation: Interpolation,
}

/// Which code colours fragments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColorPath {
    /// None: no colour target, or no shading.
    None,
    /// One colour.
    Constant([f32; 4]),
    /// Varyings from this one; three, or four with alpha.
    Varying { first: usize, alpha: bool },
    /// Lane by lane.
    Plain,
}

impl ColorPath {
    pub(crate) fn of(shading: &Shading<'_>, format: ColorFormat, stride: usize) -> Self {
        match (shading, format) {
            (Shading::Custom(_), _) => Self::Plain,
            (Shading::None, _) | (_, ColorFormat::None) => Self::None,
            (Shading::Fixed { texture: Some(_), .. }, _) => Self::Plain,
            (Shading::Fixed { color, texture: None }, _) => match *color {
                ColorSource::Constant(rgba) => Self::Constant(rgba),
                ColorSource::Rgb { first } if first + 3 <= stride => Self::Varying { first, alpha: false },
                ColorSource::Rgba { first } if first + 4 <= stride => Self::Varying { first, alpha: true },
                _ => Self::Plain,
            },
        }
    }
}

/// Fragments counted.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FragmentCounts {
    pub(crate) tested: u64,
    pub(crate) passed: u64,
    pub(crate) shaded: u64,
}

/// The three edge functions over a tile: value at the centre of its first pixel and steps, shifted
/// right by 8 bits.
///
/// Corners are within 2^23 of the origin (see [`crate::setup`]), so steps are below 2^24 and the
/// value varies over 63 pixels in x and y by less than 2 * 63 * 2^24 < 2^31: an edge that has both
/// signs in the tile fits `i32` everywhere in it. One that has not is replaced by 0, always inside,
/// or makes the tile empty.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileEdges {
    pub(crate) c: [i32; 3],
    pub(crate) dx: [i32; 3],
    pub(crate) dy: [i32; 3],
}

impl TileEdges {
    /// Edges about the pixel (`x`, `y`), counted from the origin of the fixed-point raster, for the
    /// pixels of `area`, counted from that pixel and widened to whole vectors. `None` when the triangle
    /// misses them all.
    #[inline(always)]
    pub(crate) fn new(v: &[ScreenVertex; 3], [x, y]: [i32; 2], area: &Bounds) -> Option<Self> {
        let (cx, cy) = (i64::from(x * SUB + HALF), i64::from(y * SUB + HALF));
        let mut edges = Self { c: [0; 3], dx: [0; 3], dy: [0; 3] };
        for k in 0..3 {
            let (a, b) = (&v[k], &v[(k + 1) % 3]);
            let (ex, ey) = (b.x - a.x, b.y - a.y);
            let value = i64::from(ex) * (cy - i64::from(a.y)) - i64::from(ey) * (cx - i64::from(a.x));
            let owns = ey < 0 || (ey == 0 && ex > 0);
            let c = (value - i64::from(!owns)) >> crate::setup::SUB_BITS;
            let (dx, dy) = (i64::from(-ey), i64::from(ex));
            let (x0, x1) = (dx * i64::from(area.x0 & !7), dx * i64::from((area.x1 - 1) | 7));
            let (y0, y1) = (dy * i64::from(area.y0 & !1), dy * i64::from((area.y1 - 1) | 1));
            if c + x0.max(x1) + y0.max(y1) < 0 {
                return None;
            }
            if c + x0.min(x1) + y0.min(y1) < 0 {
                edges.c[k] = c as i32;
                edges.dx[k] = -ey;
                edges.dy[k] = ex;
            }
        }
        Some(edges)
    }

    /// Value of edge `k` at pixel (`x`, `y`) of the tile.
    #[inline(always)]
    fn at(&self, k: usize, x: i32, y: i32) -> i32 {
        self.c[k].wrapping_add(self.dx[k].wrapping_mul(x)).wrapping_add(self.dy[k].wrapping_mul(y))
    }

    /// What to add to the value of edge `k` at a block's first pixel for its greatest in the block.
    #[inline(always)]
    fn reach(&self, k: usize) -> i32 {
        7i32.wrapping_mul(self.dx[k].max(0)).wrapping_add(7i32.wrapping_mul(self.dy[k].max(0)))
    }

    /// Value of edge `k` at the lanes of a vector, from that at its first lane.
    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, k: usize) -> i32x16<S> {
        i32x16::load_array(simd, LANE_X) * i32x16::splat(simd, self.dx[k])
            + i32x16::load_array(simd, LANE_Y) * i32x16::splat(simd, self.dy[k])
    }
}

/// Lane numbers within a vector: column 0 to 7, row 0 or 1.
const LANE_X: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
const LANE_Y: [i32; LANES] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];
const LANE_FX: [f32; LANES] = [0., 1., 2., 3., 4., 5., 6., 7., 0., 1., 2., 3., 4., 5., 6., 7.];
const LANE_FY: [f32; LANES] = [0., 0., 0., 0., 0., 0., 0., 0., 1., 1., 1., 1., 1., 1., 1., 1.];

/// One tile being drawn.
pub(crate) struct TileDraw<'a, 'b> {
    pub(crate) pass: &'a Pass<'a>,
    pub(crate) band: &'a Band<'b>,
    pub(crate) buffer: &'a mut TileBuffer,
    /// First pixel of the tile in the target.
    pub(crate) x: i32,
    pub(crate) y: i32,
    /// Pixels of the target that may be written, of this tile.
    pub(crate) bounds: Bounds,
    /// Whether they are fewer than the tile has.
    pub(crate) partial: bool,
    pub(crate) counts: FragmentCounts,
    pub(crate) varyings: TriangleVaryings,
}

/// One triangle in it.
struct Triangle<'a> {
    setup: &'a Setup,
    id: u32,
    /// Pixels from the triangle's reference pixel to the tile's first.
    offset: [i32; 2],
}

impl TileDraw<'_, '_> {
    /// Draws the part of a triangle in this tile. `area` is its double area, `corners` its varyings.
    #[inline(always)]
    pub(crate) fn triangle<S: Simd>(
        &mut self,
        simd: S,
        v: [ScreenVertex; 3],
        area: i64,
        corners: [&[f32]; 3],
        id: u32,
    ) {
        let map = self.pass.map;
        let pixels = pixel_box(&v, map).intersect(self.bounds);
        if pixels.is_empty() {
            return;
        }
        let setup = Setup::new(v, area, &self.pass.setup);
        let local = Bounds {
            x0: pixels.x0 - self.x,
            y0: pixels.y0 - self.y,
            x1: pixels.x1 - self.x,
            y1: pixels.y1 - self.y,
        };
        let first = [self.x - map.origin[0], self.y - map.origin[1]];
        let Some(edges) = TileEdges::new(&setup.v, first, &local) else { return };
        if self.pass.color != ColorPath::None {
            self.varyings.set(corners, setup.swapped, self.pass.interpolation);
        }
        let offset = [first[0] - setup.reference[0], first[1] - setup.reference[1]];
        let triangle = Triangle { setup: &setup, id, offset };
        self.blocks(simd, &triangle, &edges, &local);
    }

    /// Goes through the blocks of the triangle's box.
    #[inline(always)]
    fn blocks<S: Simd>(&mut self, simd: S, t: &Triangle<'_>, edges: &TileEdges, local: &Bounds) {
        let reach = [edges.reach(0), edges.reach(1), edges.reach(2)];
        let pattern = [edges.lanes(simd, 0), edges.lanes(simd, 1), edges.lanes(simd, 2)];
        for by in local.y0 >> 3..=(local.y1 - 1) >> 3 {
            for bx in local.x0 >> 3..=(local.x1 - 1) >> 3 {
                let at =
                    [edges.at(0, bx * 8, by * 8), edges.at(1, bx * 8, by * 8), edges.at(2, bx * 8, by * 8)];
                let best = [
                    at[0].wrapping_add(reach[0]),
                    at[1].wrapping_add(reach[1]),
                    at[2].wrapping_add(reach[2]),
                ];
                if best[0] | best[1] | best[2] < 0 {
                    continue;
                }
                let block = (by as usize * BLOCKS + bx as usize) & (BLOCKS * BLOCKS - 1);
                if self.buffer.present >> block & 1 == 0 {
                    self.buffer.fetch(self.band, self.x as usize, block, self.pass.clear.as_ref());
                }
                if self.pass.hides_farther && t.setup.z_min > self.buffer.farthest[block] {
                    continue;
                }
                let (first, last) = ((local.y0 - by * 8).max(0) >> 1, (local.y1 - 1 - by * 8).min(7) >> 1);
                for pair in first..=last {
                    let e0 = pattern[0]
                        + i32x16::splat(simd, at[0].wrapping_add(edges.dy[0].wrapping_mul(2 * pair)));
                    let e1 = pattern[1]
                        + i32x16::splat(simd, at[1].wrapping_add(edges.dy[1].wrapping_mul(2 * pair)));
                    let e2 = pattern[2]
                        + i32x16::splat(simd, at[2].wrapping_add(edges.dy[2].wrapping_mul(2 * pair)));
                    let mut inside = (e0 | e1 | e2).simd_ge(i32x16::splat(simd, 0));
                    if self.partial {
                        inside &= self.within_bounds(simd, bx * 8, by * 8 + 2 * pair);
                    }
                    if inside.any_true() {
                        self.vector(simd, t, block, pair as usize & 3, inside);
                    }
                }
            }
        }
    }

    /// Lanes that may be written, of the vector at pixel (`x`, `y`) of the tile.
    #[inline(always)]
    fn within_bounds<S: Simd>(&self, simd: S, x: i32, y: i32) -> mask32x16<S> {
        let b = &self.bounds;
        let column = i32x16::load_array(simd, LANE_X) + i32x16::splat(simd, self.x + x);
        let row = i32x16::load_array(simd, LANE_Y) + i32x16::splat(simd, self.y + y);
        column.simd_ge(i32x16::splat(simd, b.x0))
            & column.simd_lt(i32x16::splat(simd, b.x1))
            & row.simd_ge(i32x16::splat(simd, b.y0))
            & row.simd_lt(i32x16::splat(simd, b.y1))
    }

    /// Tests and writes two rows of 8 pixels.
    #[inline(always)]
    fn vector<S: Simd>(
        &mut self,
        simd: S,
        t: &Triangle<'_>,
        block: usize,
        pair: usize,
        inside: mask32x16<S>,
    ) {
        let (bx, by) = ((block % BLOCKS * 8) as i32, (block / BLOCKS * 8 + pair * 2) as i32);
        let fx = f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, (t.offset[0] + bx) as f32);
        let fy = f32x16::load_array(simd, LANE_FY) + f32x16::splat(simd, (t.offset[1] + by) as f32);
        let z = plane(simd, &t.setup.z, fx, fy)
            .max(f32x16::splat(simd, t.setup.z_min))
            .min(f32x16::splat(simd, t.setup.z_max));
        self.counts.tested += u64::from(inside.to_bitmask().count_ones());
        let mut pass = inside;
        if self.pass.has_depth {
            let stored = f32x16::load_array_ref(simd, &self.buffer.depth[block][pair]);
            pass &= compare(simd, self.pass.state.depth_test, z, stored);
        }
        let bits = pass.to_bitmask() as u16;
        if bits == 0 {
            return;
        }
        self.counts.passed += u64::from(bits.count_ones());
        let keep = self.color(simd, t, block, pair, pass, bits, [fx, fy], z);
        if self.pass.writes_depth {
            let plane = &mut self.buffer.depth[block][pair];
            let stored = f32x16::load_array_ref(simd, plane);
            keep.select(z, stored).store_array(plane);
        }
        if self.pass.has_ids {
            let plane = &mut self.buffer.ids[block][pair];
            let stored = u32x16::load_array_ref(simd, plane);
            keep.select(u32x16::splat(simd, t.id), stored).store_array(plane);
        }
    }

    /// Colours and writes the lanes of `pass`; returns those that were not discarded.
    #[inline(always)]
    fn color<S: Simd>(
        &mut self,
        simd: S,
        t: &Triangle<'_>,
        block: usize,
        pair: usize,
        pass: mask32x16<S>,
        bits: u16,
        at: [f32x16<S>; 2],
        z: f32x16<S>,
    ) -> mask32x16<S> {
        let mut keep = pass;
        let rgba = match self.pass.color {
            ColorPath::None => return pass,
            ColorPath::Constant([r, g, b, a]) => [
                f32x16::splat(simd, r),
                f32x16::splat(simd, g),
                f32x16::splat(simd, b),
                f32x16::splat(simd, a),
            ],
            ColorPath::Varying { first, alpha } => {
                let b = weights(simd, t.setup, at);
                let values = &self.varyings;
                let a = if alpha { varying(simd, values, first + 3, b) } else { f32x16::splat(simd, 1.0) };
                [
                    varying(simd, values, first, b),
                    varying(simd, values, first + 1, b),
                    varying(simd, values, first + 2, b),
                    a,
                ]
            }
            ColorPath::Plain => {
                let shaded = self.plain(t, block, pair, bits, z.to_array());
                keep &= mask32x16::from_bitmask(simd, u64::from(shaded.keep));
                let [r, g, b, a] = &shaded.rgba;
                [
                    f32x16::load_array_ref(simd, r),
                    f32x16::load_array_ref(simd, g),
                    f32x16::load_array_ref(simd, b),
                    f32x16::load_array_ref(simd, a),
                ]
            }
        };
        self.counts.shaded += u64::from(bits.count_ones());
        self.write(simd, block, pair, keep, rgba);
        keep
    }

    /// Colours lane by lane, or by the caller's code.
    #[cold]
    #[inline(never)]
    fn plain(
        &mut self,
        t: &Triangle<'_>,
        block: usize,
        pair: usize,
        mask: u16,
        depth: [f32; LANES],
    ) -> Shaded {
        let (bx, by) = ((block % BLOCKS * 8) as i32, (block / BLOCKS * 8 + pair * 2) as i32);
        let at = [(t.offset[0] + bx) as f32, (t.offset[1] + by) as f32];
        let mut values = [[0.0; LANES]; MAX_VARYINGS];
        let values = &mut values[..self.varyings.count];
        interpolate(t.setup, &self.varyings, at, values);
        let fragments = Fragments {
            x: (self.x + bx) as u32,
            y: (self.y + by) as u32,
            mask,
            depth,
            varyings: values,
            id: t.id,
            front: t.setup.swapped,
        };
        let mut shaded = Shaded::default();
        shade_plain(self.pass.shading, t.setup, &self.varyings, at, &fragments, &mut shaded);
        shaded
    }

    #[inline(always)]
    fn write<S: Simd>(&mut self, simd: S, block: usize, pair: usize, keep: mask32x16<S>, rgba: Rgba<S>) {
        match self.pass.format {
            ColorFormat::None => {}
            ColorFormat::Rgba8 => {
                let plane = &mut self.buffer.rgba8[block][pair];
                let stored = u32x16::load_array_ref(simd, plane);
                let rgba = match self.pass.state.blend {
                    None => rgba,
                    Some(blend) => blended(simd, blend, rgba, unpack(simd, stored)),
                };
                keep.select(pack(simd, rgba), stored).store_array(plane);
            }
            ColorFormat::Rgba32F => {
                let [r, g, b, a] = &mut self.buffer.rgba;
                let planes =
                    [&mut r[block][pair], &mut g[block][pair], &mut b[block][pair], &mut a[block][pair]];
                let stored = [
                    f32x16::load_array_ref(simd, planes[0]),
                    f32x16::load_array_ref(simd, planes[1]),
                    f32x16::load_array_ref(simd, planes[2]),
                    f32x16::load_array_ref(simd, planes[3]),
                ];
                let rgba = match self.pass.state.blend {
                    None => rgba,
                    Some(blend) => blended(simd, blend, rgba, stored),
                };
                for (k, plane) in planes.into_iter().enumerate() {
                    keep.select(rgba[k], stored[k]).store_array(plane);
                }
            }
        }
    }
}

/// Varying `k` at weights of corners 1 and 2; see [`TriangleVaryings::at`].
#[inline(always)]
fn varying<S: Simd>(simd: S, v: &TriangleVaryings, k: usize, [b1, b2]: [f32x16<S>; 2]) -> f32x16<S> {
    let k = k % MAX_VARYINGS;
    (f32x16::splat(simd, v.base[k]) + b1 * f32x16::splat(simd, v.d1[k])) + b2 * f32x16::splat(simd, v.d2[k])
}

/// A plane at 16 pixels; see [`Plane::at`].
#[inline(always)]
fn plane<S: Simd>(simd: S, p: &Plane, fx: f32x16<S>, fy: f32x16<S>) -> f32x16<S> {
    (f32x16::splat(simd, p.c) + f32x16::splat(simd, p.dy) * fy) + f32x16::splat(simd, p.dx) * fx
}

/// Weights of corners 1 and 2 at 16 pixels; see [`Setup::weights`].
#[inline(always)]
fn weights<S: Simd>(simd: S, setup: &Setup, [fx, fy]: [f32x16<S>; 2]) -> [f32x16<S>; 2] {
    let (b1, b2) = (plane(simd, &setup.b1, fx, fy), plane(simd, &setup.b2, fx, fy));
    if setup.affine {
        return [b1, b2];
    }
    let w = f32x16::splat(simd, 1.0) / plane(simd, &setup.q, fx, fy);
    [b1 * w, b2 * w]
}

/// Which lanes of `new` pass against `stored`.
#[inline(always)]
fn compare<S: Simd>(simd: S, test: Compare, new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    match test {
        Compare::Less => new.simd_lt(stored),
        Compare::LessEqual => new.simd_le(stored),
        Compare::Never => mask32x16::splat(simd, false),
        Compare::Equal => new.simd_eq(stored),
        Compare::Greater => new.simd_gt(stored),
        Compare::NotEqual => new.simd_ne(stored),
        Compare::GreaterEqual => new.simd_ge(stored),
        Compare::Always => mask32x16::splat(simd, true),
    }
}
