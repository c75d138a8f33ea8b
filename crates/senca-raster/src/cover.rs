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
    AlphaTest, Blend, ColorSource, Compare, FixedShading, Fragments, LANES, MAX_VARYINGS, Shaded, Shading,
    State, StencilOp, StencilTest, TextureUnit,
};
use crate::batch::{Batch, PlaneLanes};
use crate::blend::{Rgba, blended, pack, sum_of_bytes, unpack};
use crate::cube::CubeUnit;
use crate::setup::{Bounds, HALF, SUB, ScreenMap, ScreenVertex, SetupState};
use crate::shadow::ShadowUnit;
use crate::stage::{FragmentStage, PixelColors, Pixels, StageNeeds};
use crate::textured::{TextureQueue, Waiting};
use crate::tile::{BLOCKS, Band, ColorFormat, TileBuffer, Touches};
use fearless_simd::{Simd, f32x16, i32x16, mask8x16, mask32x16, prelude::*, u8x16, u32x16};

/// What a draw's kernel needs to know, the same for all its triangles.
pub(crate) struct Pass<'a> {
    pub(crate) map: &'a ScreenMap,
    pub(crate) state: &'a State,
    pub(crate) setup: SetupState,
    pub(crate) shading: &'a Shading<'a>,
    pub(crate) touches: Touches,
    pub(crate) format: ColorFormat,
    /// The caller's code for all that happens to fragments, and what it asks for.
    pub(crate) stage: Option<&'a dyn FragmentStage>,
    pub(crate) needs: StageNeeds,
    /// Depth is tested here.
    pub(crate) has_depth: bool,
    pub(crate) has_ids: bool,
    pub(crate) writes_depth: bool,
    /// The stencil test, where it is done here.
    pub(crate) stencil: Option<StencilTest>,
    /// The depth test passes nothing that is farther than what is there.
    pub(crate) hides_farther: bool,
    /// Farther and nearer are exchanged.
    pub(crate) reversed: bool,
    /// Blocks the triangle has covered hold nothing farther than it afterwards.
    pub(crate) lowers_farthest: bool,
    /// Depths of fragments are wanted.
    pub(crate) needs_depth: bool,
    /// Depths are tested in order and written, and nothing else is done; see [`crate::depth`].
    pub(crate) depth_only: bool,
    /// How fragments are coloured.
    pub(crate) color: ColorPath,
    /// The texture the colour is multiplied by, and the slot of u.
    pub(crate) texture: Option<(&'a TextureUnit<'a>, usize)>,
    /// The cube it is multiplied by, and the slot of x.
    pub(crate) cube: Option<(&'a CubeUnit<'a>, usize)>,
    /// The shadow map whose light it is seen in, and the slot of s.
    pub(crate) shadow: Option<(&'a ShadowUnit<'a>, usize)>,
    /// The test of the colours' alpha.
    pub(crate) alpha_test: Option<AlphaTest>,
    /// There is one of them: colours come later; see [`crate::textured`].
    pub(crate) waits: bool,
    /// The same, and nothing else is done.
    pub(crate) waits_only: bool,
    /// The same, and pixels have several samples; see [`crate::pixels`].
    pub(crate) per_pixel: bool,
    /// Fragments are given a colour, and nothing else is done; see [`crate::filled`].
    pub(crate) color_only: bool,
    /// Texels of its levels, if they have 8 bits.
    pub(crate) texels: Vec<&'a [[u8; 4]]>,
    /// Which varyings are interpolated.
    pub(crate) slots: Vec<usize>,
}

/// Which code colours fragments. Varyings are counted by slot; see [`slots`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColorPath {
    /// None: no colour target, or no shading.
    None,
    /// One colour.
    Constant([f32; 4]),
    /// Slots 0 to 2; or to 3, with alpha.
    Varying { alpha: bool },
    /// The caller's code.
    Plain,
}

impl ColorPath {
    pub(crate) fn of(shading: &Shading<'_>, format: ColorFormat) -> Self {
        match (shading, format) {
            (Shading::Custom(_) | Shading::Stage(_), _) => Self::Plain,
            (Shading::None, _) => Self::None,
            (Shading::Fixed(fixed), ColorFormat::None) if fixed.alpha_test.is_none() => Self::None,
            (Shading::Fixed(fixed), _) => match fixed.color {
                ColorSource::Constant(rgba) => Self::Constant(rgba),
                ColorSource::Rgb { .. } => Self::Varying { alpha: false },
                ColorSource::Rgba { .. } => Self::Varying { alpha: true },
            },
        }
    }
}

/// Varyings to interpolate, in the order of their slots: those of the colour, then u and v or the direction to a cube's
/// texel, then the coordinates of the shadow map; all, in their own order, for the caller's code.
pub(crate) fn slots(shading: &Shading<'_>, path: ColorPath, stride: usize) -> Vec<usize> {
    match (shading, path) {
        (_, ColorPath::Plain) => (0..stride.min(MAX_VARYINGS)).collect(),
        (Shading::Fixed(fixed), ColorPath::Constant(_) | ColorPath::Varying { .. }) => {
            let of_color = match fixed.color {
                ColorSource::Constant(_) => None,
                ColorSource::Rgb { first } => Some((first, 3)),
                ColorSource::Rgba { first } => Some((first, 4)),
            };
            let ranges = [of_color, of_texture(fixed), of_shadow(fixed)].into_iter().flatten();
            ranges.flat_map(|(first, count)| (0..count).map(move |k| first.saturating_add(k))).collect()
        }
        _ => Vec::new(),
    }
}

/// Number of the first coordinate of a texture or a cube, and how many there are.
pub(crate) fn of_texture(fixed: &FixedShading<'_>) -> Option<(usize, usize)> {
    match (&fixed.texture, &fixed.cube) {
        (Some(unit), _) => Some((unit.coords, 2)),
        (None, Some(unit)) => Some((unit.coords, 3)),
        (None, None) => None,
    }
}

/// The same of a shadow map.
pub(crate) fn of_shadow(fixed: &FixedShading<'_>) -> Option<(usize, usize)> {
    fixed.shadow.as_ref().map(|unit| (unit.coords, 4))
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
    /// pixels of `area`, counted from that pixel and widened to whole blocks. `None` when the triangle
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
            let (y0, y1) = (dy * i64::from(area.y0 & !7), dy * i64::from((area.y1 - 1) | 7));
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
}

/// Lane numbers within a vector: column 0 to 7, row 0 or 1.
const LANE_X: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
const LANE_Y: [i32; LANES] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];
pub(crate) const LANE_FX: [f32; LANES] = [0., 1., 2., 3., 4., 5., 6., 7., 0., 1., 2., 3., 4., 5., 6., 7.];
pub(crate) const LANE_FY: [f32; LANES] = [0., 0., 0., 0., 0., 0., 0., 0., 1., 1., 1., 1., 1., 1., 1., 1.];

/// One tile being drawn. `FAST` fixes what most draws have: an 8-bit colour target, no blending, no
/// identifiers; the rest of the code is the same.
pub(crate) struct TileDraw<'a, 'b, const FAST: bool> {
    pub(crate) pass: &'a Pass<'a>,
    pub(crate) band: &'a Band<'b>,
    pub(crate) buffer: &'a mut TileBuffer,
    pub(crate) batch: &'a mut Batch,
    pub(crate) queue: &'a mut TextureQueue,
    /// First pixel of the tile in the target.
    pub(crate) tile: [i32; 2],
    /// Pixels of the target that may be written, of this tile.
    pub(crate) bounds: Bounds,
    /// Whether they are fewer than the tile has.
    pub(crate) partial: bool,
    /// The triangle of the batch whose plane was put into the forms of the tile last, and its number there.
    pub(crate) form: Option<(usize, u8)>,
    pub(crate) counts: FragmentCounts,
}

/// What is the same for all vectors of one row of pixel pairs: the part of each plane that depends on
/// y.
#[derive(Clone, Copy)]
pub(crate) struct Row<S: Simd> {
    fy: f32x16<S>,
    depth: f32x16<S>,
}

/// Two rows of 8 pixels some of which have passed the tests.
pub(crate) struct Tested<S: Simd> {
    fx: f32x16<S>,
    pub(crate) z: f32x16<S>,
    /// Those that have.
    pub(crate) pass: mask32x16<S>,
    /// The same.
    pub(crate) bits: u16,
}

/// A plane's `c + dy * fy`; see [`Plane::at`].
#[inline(always)]
pub(crate) fn row_of<S: Simd>(simd: S, p: &PlaneLanes, lane: usize, fy: f32x16<S>) -> f32x16<S> {
    f32x16::splat(simd, p[0][lane]) + f32x16::splat(simd, p[2][lane]) * fy
}

/// A plane at 16 pixels, from its row.
#[inline(always)]
pub(crate) fn along<S: Simd>(
    simd: S,
    p: &PlaneLanes,
    lane: usize,
    row: f32x16<S>,
    fx: f32x16<S>,
) -> f32x16<S> {
    row + f32x16::splat(simd, p[1][lane]) * fx
}

/// Where a vector is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    pub(crate) lane: usize,
    pub(crate) block: usize,
    pub(crate) pair: usize,
}

/// Where fragments are, as interpolation wants it: pixels from the reference, and weights of corners 1
/// and 2 with w, which affine triangles do without.
#[derive(Clone, Copy)]
pub(crate) struct At<S: Simd> {
    pub(crate) fx: f32x16<S>,
    pub(crate) fy: f32x16<S>,
    pub(crate) weights: [f32x16<S>; 3],
    pub(crate) affine: bool,
}

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Draws the triangles of the batch and empties it.
    #[inline(always)]
    pub(crate) fn flush<S: Simd>(&mut self, simd: S) {
        self.batch.prepare(simd, self.pass, self.tile, &self.bounds, self.pass.slots.len());
        self.form = None;
        for lane in 0..self.batch.len.min(LANES) {
            self.triangle(simd, lane);
        }
        self.shade_waiting(simd);
        self.batch.len = 0;
    }

    /// Goes through the rows of blocks of a triangle's box.
    #[inline(always)]
    fn triangle<S: Simd>(&mut self, simd: S, lane: usize) {
        let b = &*self.batch;
        let [x0, y0, x1, y1] = [b.area[0][lane], b.area[1][lane], b.area[2][lane], b.area[3][lane]];
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        let lanes =
            [edge_lanes(simd, b, 0, lane), edge_lanes(simd, b, 1, lane), edge_lanes(simd, b, 2, lane)];
        let (first, last) = (x0 >> 3, (x1 - 1) >> 3);
        let (top, bottom) = (y0 >> 3, (y1 - 1) >> 3);
        if last - first > 1 || bottom - top > 2 {
            // Two rows of blocks at a time.
            for by in (top & !1..=bottom).step_by(2) {
                let [active, full, level] = self.blocks(simd, lane, &lanes, by, [first, last], [top, bottom]);
                self.fill_level(simd, lane, by, level);
                let active = active & !level;
                for row in 0..2 {
                    let of_row = |bits: u32| bits >> (8 * row) & 255;
                    self.row_of_blocks(
                        simd,
                        lane,
                        &lanes,
                        by + row,
                        [y0, y1],
                        [of_row(active), of_row(full)],
                    );
                }
            }
            return;
        }
        for by in top..=bottom {
            let mut active = 0u32;
            for bx in first..=last {
                active |= u32::from(self.block(simd, lane, bx, by)) << bx;
            }
            self.row_of_blocks(simd, lane, &lanes, by, [y0, y1], [active, 0]);
        }
    }

    /// Draws the blocks of a row that are `active`, of which those in `full` are wholly covered.
    #[inline(always)]
    fn row_of_blocks<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        by: i32,
        [y0, y1]: [i32; 2],
        [active, full]: [u32; 2],
    ) {
        if active == 0 {
            return;
        }
        if self.pass.touches.samples {
            for bx in (0..8).filter(|bx| active >> bx & 1 == 1) {
                self.block_of_samples(simd, lane, [bx, by], full >> bx & 1 == 1);
            }
            return;
        }
        let (top, bottom) = ((y0 - by * 8).max(0) >> 1, (y1 - 1 - by * 8).min(7) >> 1);
        if !FAST && self.pass.depth_only {
            return self.depths(simd, lane, lanes, by, [top, bottom], [active, full]);
        }
        if self.pass.per_pixel {
            return self.row_of_pixels(simd, lane, lanes, by, [top, bottom], [active, full]);
        }
        let mut active = active;
        if self.pass.waits_only {
            self.wait_blocks(simd, lane, by, active & full);
            active &= !full;
        }
        if self.pass.color_only && active & full != 0 && self.color_blocks(simd, lane, by, active & full) {
            active &= !full;
        }
        for pair in top..=bottom {
            self.row(simd, lane, lanes, [by, pair], [active, full]);
        }
    }

    /// Of two rows of blocks from `top` on the blocks that are to be drawn, those of them that the triangle
    /// covers wholly, and those of these for [`Self::fill_level`], bit by bit. Brings them in.
    #[inline(always)]
    fn blocks<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        top: i32,
        [first, last]: [i32; 2],
        [first_row, last_row]: [i32; 2],
    ) -> [u32; 3] {
        let b = &*self.batch;
        let zero = i32x16::splat(simd, 0);
        let (mut most, mut least) = (zero, zero);
        for (k, steps) in lanes.iter().enumerate() {
            let (dx, dy) = (b.edge_dx[k][lane], b.edge_dy[k][lane]);
            // Between blocks the steps are eight times as large.
            let at = (*steps << 3) + edge_at(simd, b, k, lane, [0, 8 * top]);
            most |= at + i32x16::splat(simd, 7 * dx.max(0).wrapping_add(dy.max(0)));
            least |= at + i32x16::splat(simd, 7 * dx.min(0).wrapping_add(dy.min(0)));
        }
        let columns = (255 >> (7 - (last - first))) << first;
        let rows = u32::from(first_row <= top) * 0x00ff + u32::from(last_row > top) * 0xff00;
        let mut active = most.simd_ge(zero).to_bitmask() as u32 & (columns | columns << 8) & rows;
        let full = if self.partial { 0 } else { least.simd_ge(zero).to_bitmask() as u32 };
        let at = (8 * top) as usize & 63;
        let mut missing = u64::from(active) & !(self.buffer.present >> at);
        while missing != 0 {
            let block = at + missing.trailing_zeros() as usize;
            missing &= missing - 1;
            self.buffer.fetch(simd, self.band, self.tile[0] as usize, block, &self.pass.touches);
        }
        if !self.pass.hides_farther || active == 0 {
            return [active, full & active, 0];
        }
        let [nearest, farthest] = self.blocks_depth(simd, lane, top);
        let Some(stored) = self.buffer.farthest.get_mut(at..at + LANES) else { return [0; 3] };
        let known = f32x16::from_slice(simd, stored);
        let level = (self.buffer.level & !self.buffer.written) >> at;
        let fresh = if self.pass.depth_only { farthest.simd_lt(known).to_bitmask() & level } else { 0 };
        active &= !(nearest.simd_gt(known).to_bitmask() as u32);
        if full & active != 0 && self.pass.lowers_farthest {
            // They will hold nothing farther than the triangle any more.
            let covered = mask32x16::from_bitmask(simd, u64::from(full & active));
            covered.select(known.min(farthest), known).store_slice(stored);
        }
        [active, full & active, full & active & fresh as u32]
    }

    /// Where depths are all that is drawn: writes those of the blocks in `level`, of two rows from `top` on, which
    /// the triangle covers, and which had one depth everywhere, farther away than all of the triangle's.
    #[inline(always)]
    fn fill_level<S: Simd>(&mut self, simd: S, lane: usize, top: i32, level: u32) {
        if level == 0 {
            return;
        }
        let at = (8 * top) as usize & 63;
        if self.pass.touches.keeps_forms && self.cover_level(lane, u64::from(level) << at) {
            return;
        }
        let b = &*self.batch;
        let (low, high) = (f32x16::splat(simd, b.z_min[lane]), f32x16::splat(simd, b.z_max[lane]));
        let mut left = level;
        while left != 0 {
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            // Of a block kept as planes nothing is left.
            self.buffer.formed &= !(1 << (at + bit));
            let (bx, by) = ((bit % 8) as i32, top + (bit / 8) as i32);
            let corner = [b.offset[0][lane] + 8 * bx, b.offset[1][lane] + 8 * by];
            let [fx, fy] = lanes_from(simd, corner.map(|c| c as f32));
            for (pair, plane) in self.buffer.depth[(at + bit) & 63].iter_mut().enumerate() {
                let row = row_of(simd, &b.depth, lane, fy + f32x16::splat(simd, (2 * pair) as f32));
                along(simd, &b.depth, lane, row, fx).max(low).min(high).store_array(plane);
            }
        }
        let count = 64 * u64::from(level.count_ones());
        (self.counts.tested, self.counts.passed) = (self.counts.tested + count, self.counts.passed + count);
        self.buffer.written |= u64::from(level) << at;
    }

    /// Nearest and farthest depth of the triangle's plane over the blocks of two rows, clamped to the
    /// triangle's; negated where the depth test is reversed. Rounding keeps order, so both are found at
    /// corners, exactly.
    #[inline(always)]
    fn blocks_depth<S: Simd>(&self, simd: S, lane: usize, top: i32) -> [f32x16<S>; 2] {
        let b = &*self.batch;
        let splat = |v: f32| f32x16::splat(simd, v);
        let first = |lanes: [i32; LANES], offset: i32| {
            ((i32x16::load_array(simd, lanes) << 3) + i32x16::splat(simd, offset)).to_float::<f32x16<S>>()
        };
        let (fx, fy) = (first(LANE_X, b.offset[0][lane]), first(LANE_Y, b.offset[1][lane] + 8 * top));
        let (left, right) = (fx, fx + splat(7.0));
        let (upper, lower) =
            (row_of(simd, &b.depth, lane, fy), row_of(simd, &b.depth, lane, fy + splat(7.0)));
        let corners = [
            along(simd, &b.depth, lane, upper, left),
            along(simd, &b.depth, lane, upper, right),
            along(simd, &b.depth, lane, lower, left),
            along(simd, &b.depth, lane, lower, right),
        ];
        let (low, high) = (splat(b.z_min[lane]), splat(b.z_max[lane]));
        let least = corners[0].min(corners[1]).min(corners[2].min(corners[3]));
        let most = corners[0].max(corners[1]).max(corners[2].max(corners[3]));
        let (least, most) = (least.max(low).min(high), most.max(low).min(high));
        if self.pass.reversed { [splat(0.0) - most, splat(0.0) - least] } else { [least, most] }
    }

    /// Whether a block of a small triangle is to be drawn. Brings it in if so.
    #[inline(always)]
    fn block<S: Simd>(&mut self, simd: S, lane: usize, bx: i32, by: i32) -> bool {
        let block = (by * 8 + bx) as usize & 63;
        if self.buffer.present >> block & 1 == 0 {
            self.buffer.fetch(simd, self.band, self.tile[0] as usize, block, &self.pass.touches);
        }
        let b = &*self.batch;
        let nearest = if self.pass.reversed { -b.z_max[lane] } else { b.z_min[lane] };
        !self.pass.hides_farther || nearest <= self.buffer.farthest[block]
    }

    /// Two rows of pixels, block by block.
    #[inline(always)]
    fn row<S: Simd>(
        &mut self,
        simd: S,
        lane: usize,
        lanes: &[i32x16<S>; 3],
        [by, pair]: [i32; 2],
        [active, full]: [u32; 2],
    ) {
        let b = &*self.batch;
        let y = 8 * by + 2 * pair;
        let row = self.row_at(simd, lane, y);
        let edges: [i32x16<S>; 3] = std::array::from_fn(|k| lanes[k] + edge_at(simd, b, k, lane, [0, y]));
        let steps: [i32; 3] = std::array::from_fn(|k| b.edge_dx[k][lane] << 3);
        let mut left = active;
        while left != 0 {
            let bx = left.trailing_zeros() as i32;
            left &= left - 1;
            let place = Place { lane, block: (8 * by + bx) as usize & 63, pair: pair as usize & 3 };
            let mut inside = mask32x16::splat(simd, true);
            if full >> bx & 1 == 0 {
                let at = |k: usize| edges[k] + i32x16::splat(simd, steps[k].wrapping_mul(bx));
                inside = (at(0) | at(1) | at(2)).simd_ge(i32x16::splat(simd, 0));
                if self.partial {
                    inside &= self.within_bounds(simd, bx * 8, y);
                }
            }
            self.vector(simd, place, &row, inside, bx);
        }
    }

    /// The pair of rows that begins at row `y` of the tile.
    #[inline(always)]
    pub(crate) fn row_at<S: Simd>(&self, simd: S, lane: usize, y: i32) -> Row<S> {
        let b = &*self.batch;
        let fy = f32x16::load_array(simd, LANE_FY) + f32x16::splat(simd, (b.offset[1][lane] + y) as f32);
        Row { fy, depth: row_of(simd, &b.depth, lane, fy) }
    }

    /// Lanes that may be written, of the vector at pixel (`x`, `y`) of the tile.
    #[inline(always)]
    pub(crate) fn within_bounds<S: Simd>(&self, simd: S, x: i32, y: i32) -> mask32x16<S> {
        let b = &self.bounds;
        let column = i32x16::load_array(simd, LANE_X) + i32x16::splat(simd, self.tile[0] + x);
        let row = i32x16::load_array(simd, LANE_Y) + i32x16::splat(simd, self.tile[1] + y);
        column.simd_ge(i32x16::splat(simd, b.x0))
            & column.simd_lt(i32x16::splat(simd, b.x1))
            & row.simd_ge(i32x16::splat(simd, b.y0))
            & row.simd_lt(i32x16::splat(simd, b.y1))
    }

    /// Tests and writes two rows of 8 pixels.
    #[inline(always)]
    fn vector<S: Simd>(&mut self, simd: S, place: Place, row: &Row<S>, inside: mask32x16<S>, bx: i32) {
        let Some(Tested { fx, z, pass, bits }) = self.test(simd, place, row, inside, bx) else { return };
        let keep = if self.pass.stage.is_some() {
            self.counts.shaded += u64::from(bits.count_ones());
            let passed = self.staged(simd, place, row, fx, z, bits);
            self.counts.passed += u64::from(passed.count_ones());
            if passed == 0 {
                return;
            }
            mask32x16::from_bitmask(simd, u64::from(passed))
        } else {
            self.color(simd, place, row, fx, z, pass, bits)
        };
        if self.pass.alpha_test.is_none() {
            self.keep_depth(simd, place, keep, z);
        }
    }

    /// Tests depth and stencil of two rows of 8 pixels, where that is done here, and does what the stencil test does.
    /// `None` if nothing passes.
    #[inline(always)]
    pub(crate) fn test<S: Simd>(
        &mut self,
        simd: S,
        place: Place,
        row: &Row<S>,
        inside: mask32x16<S>,
        bx: i32,
    ) -> Option<Tested<S>> {
        let Place { lane, block, pair } = place;
        let covered = inside.to_bitmask() as u16;
        if covered == 0 {
            return None;
        }
        if self.pass.alpha_test.is_some() && self.queue.has_some_of(block, pair, covered) {
            // What becomes of them is what this is tested against.
            self.shade_waiting(simd);
        }
        self.counts.tested += u64::from(covered.count_ones());
        let b = &*self.batch;
        let fx = f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, (b.offset[0][lane] + 8 * bx) as f32);
        let mut pass = inside;
        let mut z = row.depth;
        if self.pass.needs_depth {
            z = along(simd, &b.depth, lane, row.depth, fx)
                .max(f32x16::splat(simd, b.z_min[lane]))
                .min(f32x16::splat(simd, b.z_max[lane]));
        }
        if self.pass.has_depth {
            let stored = f32x16::load_array_ref(simd, &self.buffer.depth[block][pair]);
            pass &= compare(simd, self.pass.state.depth_test, z, stored);
        }
        let mut bits = pass.to_bitmask() as u16;
        if let Some(test) = &self.pass.stencil {
            let [passed, changed] = stencil(simd, test, &mut self.buffer.stencil[block][pair], covered, bits);
            if changed != 0 {
                self.buffer.written |= 1 << (block & 63);
            }
            bits = passed;
            pass &= mask32x16::from_bitmask(simd, u64::from(bits));
        }
        if bits == 0 {
            return None;
        }
        self.buffer.written |= 1 << (block & 63);
        Some(Tested { fx, z, pass, bits })
    }

    /// Depths of two rows of 8 pixels.
    #[inline(always)]
    pub(crate) fn depth_at<S: Simd>(&self, simd: S, Place { lane, block, pair }: Place) -> f32x16<S> {
        let (bx, y) = ((block % BLOCKS) as i32, (8 * (block / BLOCKS) + 2 * pair) as i32);
        let b = &*self.batch;
        let fx = f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, (b.offset[0][lane] + 8 * bx) as f32);
        along(simd, &b.depth, lane, self.row_at(simd, lane, y).depth, fx)
            .max(f32x16::splat(simd, b.z_min[lane]))
            .min(f32x16::splat(simd, b.z_max[lane]))
    }

    /// Writes depths and identifiers of the lanes in `keep`.
    #[inline(always)]
    pub(crate) fn keep_depth<S: Simd>(
        &mut self,
        simd: S,
        Place { lane, block, pair }: Place,
        keep: mask32x16<S>,
        z: f32x16<S>,
    ) {
        if self.pass.writes_depth {
            let plane = &mut self.buffer.depth[block][pair];
            let stored = f32x16::load_array_ref(simd, plane);
            keep.select(z, stored).store_array(plane);
        }
        if !FAST && self.pass.has_ids {
            let plane = &mut self.buffer.ids[block][pair];
            let stored = u32x16::load_array_ref(simd, plane);
            keep.select(u32x16::splat(simd, self.batch.ids[lane]), stored).store_array(plane);
        }
    }

    /// Colours and writes the lanes of `pass`; returns those that were not discarded.
    #[inline(always)]
    fn color<S: Simd>(
        &mut self,
        simd: S,
        place: Place,
        row: &Row<S>,
        fx: f32x16<S>,
        z: f32x16<S>,
        pass: mask32x16<S>,
        bits: u16,
    ) -> mask32x16<S> {
        let lane = place.lane;
        if self.pass.waits {
            let (x, y) =
                ((place.block % BLOCKS * 8) as i32, (8 * (place.block / BLOCKS) + 2 * place.pair) as i32);
            let b = &self.batch.offset;
            let offset = [(b[0][lane] + x) as f32, (b[1][lane] + y) as f32];
            self.counts.shaded += u64::from(bits.count_ones());
            if self.pass.alpha_test.is_none() {
                self.counts.passed += u64::from(bits.count_ones());
            }
            self.wait(simd, Waiting { place, offset, bits, samples: [0; 4], moves_depths: true });
            return pass;
        }
        let mut keep = pass;
        self.counts.passed += u64::from(bits.count_ones());
        let rgba = match self.pass.color {
            ColorPath::None => return pass,
            ColorPath::Constant(rgba) => splat4(simd, rgba),
            ColorPath::Varying { .. } if FAST && self.batch.flat >> lane & 1 == 1 => {
                self.counts.shaded += u64::from(bits.count_ones());
                let plane = &mut self.buffer.rgba8[place.block][place.pair];
                let stored = u32x16::load_array_ref(simd, plane);
                let color = u32x16::splat(simd, self.batch.flat_color[lane]);
                keep.select(color, stored).store_array(plane);
                return keep;
            }
            ColorPath::Varying { alpha } => {
                let at = self.at(simd, lane, fx, row.fy);
                colors(simd, self.batch, lane, 0, alpha, &at)
            }
            ColorPath::Plain => {
                let at = self.at(simd, lane, fx, row.fy);
                let shaded = self.custom(simd, place, &at, bits, z.to_array());
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
        self.write(simd, place, keep, rgba);
        keep
    }

    /// Weights at 16 pixels; see [`Setup::weights`].
    #[inline(always)]
    pub(crate) fn at<S: Simd>(&self, simd: S, lane: usize, fx: f32x16<S>, fy: f32x16<S>) -> At<S> {
        let b = &*self.batch;
        let one = f32x16::splat(simd, 1.0);
        if b.affine >> lane & 1 == 1 {
            return At { fx, fy, weights: [one, one, one], affine: true };
        }
        let of = [
            along(simd, &b.b1, lane, row_of(simd, &b.b1, lane, fy), fx),
            along(simd, &b.b2, lane, row_of(simd, &b.b2, lane, fy), fx),
            along(simd, &b.inv_w, lane, row_of(simd, &b.inv_w, lane, fy), fx),
        ];
        let w = one / of[2];
        At { fx, fy, weights: [of[0] * w, of[1] * w, w], affine: false }
    }

    /// Hands the lanes of `mask` to the stage; returns those that passed.
    #[inline(always)]
    fn staged<S: Simd>(
        &mut self,
        simd: S,
        place: Place,
        row: &Row<S>,
        fx: f32x16<S>,
        z: f32x16<S>,
        mask: u16,
    ) -> u16 {
        let Some(stage) = self.pass.stage else { return 0 };
        let (mut values, mut count) = (std::mem::take(&mut self.batch.interpolated), 0);
        if self.pass.needs.shades {
            count = self.pass.slots.len().min(MAX_VARYINGS);
            values.resize(count, [0.0; LANES]);
            let at = self.at(simd, place.lane, fx, row.fy);
            for (slot, value) in values.iter_mut().enumerate() {
                varying(simd, &self.batch.varyings[slot], place.lane, &at).store_array(value);
            }
        }
        let fragments = self.fragments(place, mask, z.to_array(), &values[..count]);
        let passed = self.run_stage(stage, &fragments, place);
        self.batch.interpolated = values;
        passed
    }

    /// Has the stage colour and merge fragments; returns those that passed.
    #[inline(always)]
    fn run_stage(&mut self, stage: &dyn FragmentStage, fragments: &Fragments<'_>, place: Place) -> u16 {
        let shades = self.pass.needs.shades;
        let mut pixels = self.pixels(place);
        let passed = if shades {
            stage.shade_and_merge(fragments, &mut pixels)
        } else {
            stage.merge(fragments, &Shaded::default(), &mut pixels)
        };
        passed & fragments.mask
    }

    /// The pixels of a vector, for the stage.
    #[inline(always)]
    pub(crate) fn pixels(&mut self, Place { block, pair, .. }: Place) -> Pixels<'_> {
        let (pass, buffer) = (self.pass, &mut *self.buffer);
        let [r, g, b, a] = &mut buffer.rgba;
        Pixels {
            color: match pass.format {
                ColorFormat::Rgba8 if pass.needs.color => PixelColors::Rgba8(&mut buffer.rgba8[block][pair]),
                ColorFormat::Rgba32F if pass.needs.color => PixelColors::Rgba32F([
                    &mut r[block][pair],
                    &mut g[block][pair],
                    &mut b[block][pair],
                    &mut a[block][pair],
                ]),
                _ => PixelColors::None,
            },
            depth: pass.touches.reads_depth.then_some(&mut buffer.depth[block][pair]),
            stencil: (self.band.stencil.is_some() && pass.needs.stencil)
                .then_some(&mut buffer.stencil[block][pair]),
        }
    }

    #[inline(always)]
    fn fragments<'v>(
        &self,
        place: Place,
        mask: u16,
        depth: [f32; LANES],
        varyings: &'v [[f32; LANES]],
    ) -> Fragments<'v> {
        Fragments {
            x: (self.tile[0] as usize + place.block % BLOCKS * 8) as u32,
            y: (self.tile[1] as usize + place.block / BLOCKS * 8 + place.pair * 2) as u32,
            columns: 8,
            sample: 0,
            mask,
            depth,
            varyings,
            id: self.batch.ids[place.lane],
            front: self.batch.swapped >> place.lane & 1 == 1,
            coverage: None,
        }
    }

    /// Colours by the caller's code.
    #[inline(always)]
    fn custom<S: Simd>(
        &mut self,
        simd: S,
        place: Place,
        at: &At<S>,
        mask: u16,
        depth: [f32; LANES],
    ) -> Shaded {
        let mut values = [[0.0; LANES]; MAX_VARYINGS];
        let count = self.pass.slots.len().min(MAX_VARYINGS);
        for (slot, value) in values.iter_mut().enumerate().take(count) {
            varying(simd, &self.batch.varyings[slot], place.lane, at).store_array(value);
        }
        let mut shaded = Shaded::default();
        let Shading::Custom(shader) = self.pass.shading else { return shaded };
        let fragments = self.fragments(place, mask, depth, &values[..count]);
        shader.shade(&fragments, &mut shaded);
        shaded
    }

    #[inline(always)]
    pub(crate) fn write<S: Simd>(&mut self, simd: S, place: Place, keep: mask32x16<S>, rgba: Rgba<S>) {
        let Place { block, pair, .. } = place;
        let format = if FAST { ColorFormat::Rgba8 } else { self.pass.format };
        let blend = if FAST { None } else { self.pass.state.blend };
        match format {
            ColorFormat::None => {}
            ColorFormat::Rgba8 => {
                let plane = &mut self.buffer.rgba8[block][pair];
                let stored = u32x16::load_array_ref(simd, plane);
                let packed = match blend {
                    None => pack(simd, rgba),
                    Some(Blend::ADD) => sum_of_bytes(simd, pack(simd, rgba), stored),
                    Some(blend) => pack(simd, blended(simd, blend, rgba, unpack(simd, stored))),
                };
                keep.select(packed, stored).store_array(plane);
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
                let rgba = match blend {
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

#[inline(always)]
pub(crate) fn splat4<S: Simd>(simd: S, [r, g, b, a]: [f32; 4]) -> Rgba<S> {
    [f32x16::splat(simd, r), f32x16::splat(simd, g), f32x16::splat(simd, b), f32x16::splat(simd, a)]
}

/// Columns and rows of 16 pixels, the first of which is at `offset`.
#[inline(always)]
pub(crate) fn lanes_from<S: Simd>(simd: S, [x, y]: [f32; 2]) -> [f32x16<S>; 2] {
    [
        f32x16::load_array(simd, LANE_FX) + f32x16::splat(simd, x),
        f32x16::load_array(simd, LANE_FY) + f32x16::splat(simd, y),
    ]
}

/// What edge `k` changes by from the first pixel of a vector to each of its lanes.
#[inline(always)]
fn edge_lanes<S: Simd>(simd: S, b: &Batch, k: usize, lane: usize) -> i32x16<S> {
    i32x16::load_array(simd, LANE_X) * i32x16::splat(simd, b.edge_dx[k][lane])
        + i32x16::load_array(simd, LANE_Y) * i32x16::splat(simd, b.edge_dy[k][lane])
}

/// The value of edge `k` at column `x`, row `y` of the tile.
#[inline(always)]
pub(crate) fn edge_at<S: Simd>(simd: S, b: &Batch, k: usize, lane: usize, [x, y]: [i32; 2]) -> i32x16<S> {
    let along = b.edge_dx[k][lane].wrapping_mul(x);
    i32x16::splat(simd, b.edge[k][lane].wrapping_add(along).wrapping_add(b.edge_dy[k][lane].wrapping_mul(y)))
}

/// A varying at 16 pixels; see [`crate::assemble::TriangleVaryings::at`].
#[inline(always)]
pub(crate) fn varying<S: Simd>(simd: S, terms: &PlaneLanes, lane: usize, at: &At<S>) -> f32x16<S> {
    if at.affine {
        return along(simd, terms, lane, row_of(simd, terms, lane, at.fy), at.fx);
    }
    (f32x16::splat(simd, terms[0][lane]) + at.weights[0] * f32x16::splat(simd, terms[1][lane]))
        + at.weights[1] * f32x16::splat(simd, terms[2][lane])
}

/// The colour in three or four slots.
#[inline(always)]
pub(crate) fn colors<S: Simd>(
    simd: S,
    b: &Batch,
    lane: usize,
    first: usize,
    alpha: bool,
    at: &At<S>,
) -> Rgba<S> {
    let slot = &b.varyings;
    [
        varying(simd, &slot[first % MAX_VARYINGS], lane, at),
        varying(simd, &slot[(first + 1) % MAX_VARYINGS], lane, at),
        varying(simd, &slot[(first + 2) % MAX_VARYINGS], lane, at),
        if alpha {
            varying(simd, &slot[(first + 3) % MAX_VARYINGS], lane, at)
        } else {
            f32x16::splat(simd, 1.0)
        },
    ]
}

/// Does a stencil test on the lanes of `mask`, of which those in `nearer` pass the depth test. Returns
/// the lanes that pass both, and those that may have changed.
#[inline(always)]
fn stencil<S: Simd>(
    simd: S,
    test: &StencilTest,
    plane: &mut [u8; LANES],
    mask: u16,
    nearer: u16,
) -> [u16; 2] {
    let splat = |v: u8| u8x16::splat(simd, v);
    let stored = u8x16::load_array_ref(simd, plane);
    let (a, b) = (splat(test.reference & test.value_mask), stored & splat(test.value_mask));
    let passes = match test.compare {
        Compare::Never => mask8x16::splat(simd, false),
        Compare::Less => a.simd_lt(b),
        Compare::Equal => a.simd_eq(b),
        Compare::LessEqual => a.simd_le(b),
        Compare::Greater => a.simd_gt(b),
        Compare::NotEqual => a.simd_ne(b),
        Compare::GreaterEqual => a.simd_ge(b),
        Compare::Always => mask8x16::splat(simd, true),
    };
    let passes = passes.to_bitmask() as u16 & mask;
    let passed = passes & nearer;
    let (mut value, mut changed) = (stored, 0);
    for (op, lanes) in [(test.pass, passed), (test.depth_fail, passes & !nearer), (test.fail, mask & !passes)]
    {
        if op == StencilOp::Keep || lanes == 0 {
            continue;
        }
        let after = match op {
            StencilOp::Keep => stored,
            StencilOp::Zero => splat(0),
            StencilOp::Replace => splat(test.reference),
            StencilOp::Increment => simd.saturating_add_u8x16(stored, splat(1)),
            StencilOp::Decrement => simd.saturating_sub_u8x16(stored, splat(1)),
            StencilOp::IncrementWrap => stored + splat(1),
            StencilOp::DecrementWrap => stored - splat(1),
            StencilOp::Invert => stored ^ splat(255),
        };
        value = mask8x16::from_bitmask(simd, u64::from(lanes)).select(after, value);
        changed |= lanes;
    }
    if changed != 0 {
        ((stored & splat(!test.write_mask)) | (value & splat(test.write_mask))).store_array(plane);
    }
    [passed, changed]
}

/// Which lanes of `new` pass against `stored`.
#[inline(always)]
pub(crate) fn compare<S: Simd>(simd: S, test: Compare, new: f32x16<S>, stored: f32x16<S>) -> mask32x16<S> {
    // The usual ones first: a predicted branch instead of a jump through a table.
    if test == Compare::Less {
        return new.simd_lt(stored);
    }
    if test == Compare::LessEqual {
        return new.simd_le(stored);
    }
    match test {
        Compare::Never | Compare::Less | Compare::LessEqual => mask32x16::splat(simd, false),
        Compare::Equal => new.simd_eq(stored),
        Compare::Greater => new.simd_gt(stored),
        Compare::NotEqual => new.simd_ne(stored),
        Compare::GreaterEqual => new.simd_ge(stored),
        Compare::Always => mask32x16::splat(simd, true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bin::TILE;
    use crate::setup::GUARD;

    /// The edge function at the centre of a pixel, exactly, less one where the edge does not own it.
    fn exact(v: &[ScreenVertex; 3], k: usize, [x, y]: [i64; 2]) -> i64 {
        let (a, b) = (&v[k], &v[(k + 1) % 3]);
        let (ex, ey) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
        let (cx, cy) = (x * i64::from(SUB) + i64::from(HALF), y * i64::from(SUB) + i64::from(HALF));
        let owns = ey < 0 || (ey == 0 && ex > 0);
        ex * (cy - i64::from(a.y)) - ey * (cx - i64::from(a.x)) - i64::from(!owns)
    }

    #[test]
    fn edge_value_fits() {
        // Corners at the very ends of the guard band, tiles all over it.
        let g = GUARD as i32;
        let ends = [-g, -g + 1, -77, 0, 1, 129, g - 1, g];
        let area = Bounds { x0: 0, y0: 0, x1: TILE as i32, y1: TILE as i32 };
        let mut seen = 0;
        for n in 0..8usize.pow(3) {
            let at = |k: u32| ends[n / 8usize.pow(k) % 8];
            let corner = |x: i32, y: i32| ScreenVertex { x, y, z: 0.5, inv_w: 1.0 };
            let v = [corner(at(0), at(1)), corner(at(1), at(2)), corner(at(2), -at(0))];
            let v = if crate::setup::double_area(&v) < 0 { [v[0], v[2], v[1]] } else { v };
            for tile in [[-32_704, -32_704], [-64, 0], [0, 0], [32_640, -64], [64, 32_640]] {
                let Some(edges) = TileEdges::new(&v, tile, &area) else {
                    continue;
                };
                for (k, x, y) in [(0, 0, 0), (1, 63, 0), (2, 0, 63), (0, 63, 63), (1, 31, 7), (2, 63, 63)] {
                    let value = i64::from(edges.c[k])
                        + i64::from(edges.dx[k]) * i64::from(x)
                        + i64::from(edges.dy[k]) * i64::from(y);
                    assert!(i32::try_from(value).is_ok(), "{v:?} {tile:?}");
                    let exact = exact(&v, k, [i64::from(tile[0] + x), i64::from(tile[1] + y)]);
                    assert_eq!(value >= 0, exact >= 0, "{v:?} {tile:?} edge {k} at {x}, {y}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 1000);
    }
}
