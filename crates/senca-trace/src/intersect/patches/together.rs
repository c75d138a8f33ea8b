//! From many rays at once to the places where they meet patches.
//!
//! The fast twin of the search of one ray. Bounds on all rays of a block, a *beam*, go through the
//! hierarchy in their place; what the beam meets is asked for by sixteen rays at a time, and only those go
//! on that meet it themselves, the nearest box first. In a cell they are asked whether they meet its
//! plane, and Newton's method runs for eight of those that do, side by side, whichever cells of a patch they
//! are in.
//!
//! Every ray is decided by its own box, plane and steps of Newton's method, with the same bounds as alone,
//! and of its hits the one counts that comes before all others, so nothing depends on the rays beside it.
//!
//! Source of the beams: interval arithmetic on packets, Wald et al. 2006, Boulos et al. 2006; of sets of
//! rays that thin out on their way down, Wald et al. 2007.

use std::ops::Range;

use fearless_simd::{Simd, f32x16, prelude::*};

use super::block::{BLOCK, DIRECTION, FAR, INVERSE, NEAR, RayBlock, WIDE};
use super::cells::{Cell, MARGIN, PLACE_SLACK};
use super::hierarchy::{Beam, Bundle, Errand};
use super::search::{Hit, Nearest, Newton, SETTLED, Search, WIDEST, settle};
use super::{PatchSurface, SINGULAR};
use crate::lanes::{F, LANES, M, V, bits_of, channels, eight, first_lanes, lanes_of, larger};
use crate::{Counters, Crossing};
use senca_math::glam::{DVec2, Mat3};

impl PatchSurface {
    /// The nearest hits of the rays of a block.
    #[inline(never)]
    pub(crate) fn closest_of_block<S: Simd>(&self, simd: S, block: &mut RayBlock, counters: &mut Counters) {
        simd.vectorize(
            #[inline(always)]
            || self.search_block::<S, false>(simd, block, counters),
        );
    }

    /// Which rays of a block meet anything.
    #[inline(never)]
    pub(crate) fn blocked_of_block<S: Simd>(
        &self,
        simd: S,
        block: &mut RayBlock,
        counters: &mut Counters,
    ) -> u64 {
        simd.vectorize(
            #[inline(always)]
            || self.search_block::<S, true>(simd, block, counters),
        );
        block.hits()
    }

    /// Places and unit normals of eight crossings, where all are asked for that are of part `part`; `None`
    /// where they have to be computed one by one.
    #[inline(always)]
    pub(crate) fn points_of_eight<S: Simd>(
        &self,
        simd: S,
        part: u32,
        [u, v]: [F<S>; 2],
        of_part: M<S>,
    ) -> Option<[V<S>; 2]> {
        let jet = self.patches[part as usize].at_eight(simd, u, v)?;
        let cross = jet.du.cross(jet.dv);
        let squared = cross.dot(cross);
        let size = larger(jet.du.dot(jet.du), jet.dv.dot(jet.dv));
        let regular = squared.simd_gt(F::splat(simd, SINGULAR) * size * size);
        if (of_part & !regular).any_true() {
            return None;
        }
        let point = V::splat(simd, self.center).add(jet.value.times(F::splat(simd, self.scale)));
        Some([point, cross.times(F::splat(simd, 1.0) / squared.sqrt())])
    }

    #[inline(always)]
    fn search_block<S: Simd, const ANY: bool>(&self, simd: S, block: &mut RayBlock, counters: &mut Counters) {
        block.prepare(simd, self.center, self.scale);
        if block.live() == 0 {
            return;
        }
        let mut met = block.met.take().unwrap_or_default();
        let mut errands = std::mem::take(&mut met.errands);
        met.clear();
        let open = block.live();
        let far = f32::INFINITY;
        let mut search: BlockSearch<'_, ANY> =
            BlockSearch { surface: self, block, met: &mut met, open, far, of_patch: 0..0, tests: 0 };
        counters.nodes += self.hierarchy.walk(simd, self.root, &mut search, &mut errands);
        search.newton_all(simd);
        search.divide_rest();
        counters.tests += search.tests;
        met.errands = errands;
        block.met = Some(met);
    }

    /// A ray in a cell of a patch that is not evaluated eight places at once.
    #[cold]
    #[inline(never)]
    fn alone<S: Simd>(&self, simd: S, block: &mut RayBlock, lane: usize, cell: &Cell, any: bool) {
        let ray = block.ray(lane);
        let mut search =
            Search { surface: self, ray: &ray, local: block.line(lane), wanted: Nearest(None), tests: 0 };
        search.alone(simd, cell);
        if let Some(hit) = search.wanted.0 {
            block.take_alone(lane, &hit, any);
        }
    }

    /// A ray in a cell of which nothing is known, or in which Newton's method does not end, or ends beyond what is
    /// known.
    #[cold]
    #[inline(never)]
    fn divide(&self, block: &mut RayBlock, lane: usize, cell: &Cell, any: bool) {
        let ray = block.ray(lane);
        let mut search =
            Search { surface: self, ray: &ray, local: block.line(lane), wanted: Nearest(None), tests: 0 };
        search.divide(cell);
        if let Some(hit) = search.wanted.0 {
            block.take_alone(lane, &hit, any);
        }
    }

    /// Newton's method for eight rays in a cell: the twin of that of one ray.
    #[inline(always)]
    fn newton_eight<S: Simd>(&self, simd: S, block: &mut RayBlock, met: &mut Met, first: usize, any: bool) {
        let count = (met.len - first).min(LANES);
        met.len = first;
        let lanes = met.lanes(first, count);
        let cells: [&Cell; LANES] =
            eight!(k => &self.cells[met.cells[first + if k < count { k } else { 0 }] as usize]);
        let part = cells[0].patch;
        let patch = &self.patches[part as usize];
        if !patch.is_cubic() {
            for (&lane, cell) in lanes.iter().zip(cells).take(count) {
                self.alone(simd, block, usize::from(lane), cell, any);
            }
            return;
        }
        let of_cells = |k: usize| F::load_array(simd, eight!(i => f64::from(cells[i].uv[k])));
        let (center_u, center_v, half_u, half_v) = (of_cells(0), of_cells(1), of_cells(2), of_cells(3));
        let [o, d] = block.lines(simd, &lanes);
        let mut u = center_u + half_u * met.near(simd, 0, first);
        let mut v = center_v + half_v * met.near(simd, 1, first);
        let mut open = first_lanes(simd, count);
        let mut settled = M::splat(simd, false);
        let zero = F::splat(simd, 0.0);
        let (mut distance, mut error_u, mut error_v) = (zero, zero, zero);
        for _ in 0..10 {
            let Some(jet) = patch.at_eight(simd, u, v) else { break };
            let normal = jet.du.cross(jet.dv);
            let offset = o.sub(jet.value);
            let inverse = F::splat(simd, 1.0) / d.dot(normal);
            let moment = d.cross(offset);
            let step_u = jet.dv.dot(moment) * inverse;
            let step_v = -jet.du.dot(moment) * inverse;
            u = open.select(u + step_u, u);
            v = open.select(v + step_v, v);
            let small = step_u.abs().simd_le(F::splat(simd, SETTLED) * half_u)
                & step_v.abs().simd_le(F::splat(simd, SETTLED) * half_v);
            let now = open & small;
            if now.any_true() {
                distance = now.select(-offset.dot(normal) * inverse, distance);
                error_u = now.select(jet.dv.dot(jet.dv).sqrt() * inverse.abs(), error_u);
                error_v = now.select(jet.du.dot(jet.du).sqrt() * inverse.abs(), error_v);
                settled |= now;
            }
            let near = (u - center_u).abs().simd_le(F::splat(simd, 4.0) * half_u)
                & (v - center_v).abs().simd_le(F::splat(simd, 4.0) * half_v);
            open &= !small & near;
            if !open.any_true() {
                break;
            }
        }
        // Most are well within the cell, or well without; the others are near its border.
        let (off_u, off_v) = ((u - center_u).abs() - half_u, (v - center_v).abs() - half_v);
        let widest = F::splat(simd, WIDEST);
        let within = settled & off_u.simd_lt(-widest) & off_v.simd_lt(-widest);
        let in_margin =
            off_u.simd_lt(F::splat(simd, MARGIN) * half_u) & off_v.simd_lt(F::splat(simd, MARGIN) * half_v);
        let outside = settled & in_margin & (off_u.simd_gt(widest) | off_v.simd_gt(widest));
        let all = (1u64 << count) - 1;
        let left = all & !(within | outside).to_bitmask();
        let numbers = [u.to_array(), v.to_array(), distance.to_array()];
        block.take(&lanes, within.to_bitmask() & all, part, numbers, any);
        if left != 0 {
            let errors = [error_u.to_array(), error_v.to_array()];
            let settled = settled.to_bitmask();
            for k in lanes_of(left) {
                let [u, v, distance] = channels!(i => numbers[i][k]);
                let end = (settled >> k & 1 == 1).then_some((DVec2::new(u, v), distance));
                self.at_border(
                    block,
                    usize::from(lanes[k]),
                    cells[k],
                    end,
                    [errors[0][k], errors[1][k]],
                    any,
                );
            }
        }
    }

    /// A ray for which Newton's method ended near the border of a cell, or not at all.
    #[cold]
    #[inline(never)]
    fn at_border(
        &self,
        block: &mut RayBlock,
        lane: usize,
        cell: &Cell,
        end: Option<(DVec2, f64)>,
        errors: [f64; 2],
        any: bool,
    ) {
        let lane = lane % BLOCK;
        let settled = end.map(|(uv, distance)| settle(cell, uv, || DVec2::from_array(errors), distance, 1.0));
        match settled {
            Some(Newton::Outside) => {}
            Some(Newton::Inside { root, distance }) => {
                let t = block.line(lane).parameter(distance);
                if block.ray(lane).admits(t) {
                    let crossing = Crossing { t, part: cell.patch, uv: root.uv };
                    let hit = Hit { crossing, distance, sign: 1.0 };
                    block.take_alone(lane, &hit, any);
                }
            }
            Some(Newton::Lost) | None => self.divide(block, lane, cell, any),
        }
    }
}

/// The search of the rays of a block: for the nearest hits, or for any.
struct BlockSearch<'a, const ANY: bool> {
    surface: &'a PatchSurface,
    block: &'a mut RayBlock,
    met: &'a mut Met,
    /// Rays that still look for something.
    open: u64,
    /// How far the one looks that looks farthest.
    far: f32,
    /// Cells of the patch of the rays that wait for Newton's method.
    of_patch: Range<u32>,
    tests: u64,
}

impl<const ANY: bool> BlockSearch<'_, ANY> {
    /// Newton's method for all that wait for it.
    #[inline(always)]
    fn newton_all<S: Simd>(&mut self, simd: S) {
        while self.met.len > 0 {
            let first = self.met.len.saturating_sub(LANES);
            self.surface.newton_eight(simd, self.block, self.met, first, ANY);
        }
    }

    /// Looks at what was put off. For any hit, pieces are not divided before all else is tried.
    fn divide_rest(&mut self) {
        for i in 0..self.met.put_off.len() {
            let (lane, cell) = self.met.put_off[i];
            if self.block.hits() >> lane & 1 == 0 {
                self.surface.divide(self.block, usize::from(lane), &self.surface.cells[cell as usize], ANY);
            }
        }
    }
}

impl<S: Simd, const ANY: bool> Bundle<S> for BlockSearch<'_, ANY> {
    const SORTED: bool = !ANY;

    #[inline(always)]
    fn beam(&self, simd: S) -> Beam {
        beam_of(simd, self.block, self.open)
    }

    #[inline(always)]
    fn meet_box(&self, simd: S, among: u64, sides: &[[f32; 2]; 3]) -> u64 {
        let mut met = 0;
        for first in (0..BLOCK).step_by(WIDE) {
            if among >> first & 0xffff != 0 {
                met |= box_met(simd, self.block, first, sides) << first;
            }
        }
        met & among
    }

    #[inline(always)]
    fn one(&self, ray: usize) -> ([f32; 3], [f32; 3], [f32; 2]) {
        let at = |k: usize| self.block.single[k][ray % BLOCK];
        (channels!(k => at(k)), channels!(k => at(INVERSE + k)), [at(NEAR), at(FAR)])
    }

    #[inline(always)]
    fn open(&self) -> u64 {
        self.open
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.far
    }

    #[inline(always)]
    fn cell(&mut self, simd: S, number: u32, rays: u64, sides: &[[f32; 2]; 3]) {
        let cell = &self.surface.cells[number as usize];
        // By its number, which is known before the cell is read.
        if !self.of_patch.contains(&number) {
            self.newton_all(simd);
            self.of_patch = self.surface.parts[cell.patch as usize].2.clone();
        }
        // Some may have met something before it by now.
        let rays = if ANY { rays } else { self.meet_box(simd, rays, sides) };
        self.tests += u64::from(rays.count_ones());
        let mut unknown = 0;
        for first in (0..BLOCK).step_by(WIDE) {
            let sixteen = rays >> first & 0xffff;
            if sixteen != 0 {
                unknown |= meet_plane(simd, self.block, first, sixteen, (cell, number), self.met) << first;
            }
        }
        for lane in bits_of(unknown) {
            if ANY {
                self.met.put_off.push((lane as u8, number));
            } else {
                self.surface.divide(self.block, lane, cell, ANY);
            }
        }
        let is_full = self.met.len >= LANES;
        while self.met.len >= LANES {
            let first = self.met.len - LANES;
            self.surface.newton_eight(simd, self.block, self.met, first, ANY);
        }
        if ANY {
            self.open &= !self.block.hits();
        } else if is_full || unknown != 0 {
            self.far = greatest(simd, &self.block.single[FAR], self.open);
        }
    }
}

/// Rays of which is known that they meet a cell at most once; all cells are of one patch.
#[derive(Clone, Debug)]
pub(super) struct Met {
    /// Their numbers, the cells, and where in the frame of the cell, about.
    numbers: [u8; ROOM],
    cells: [u32; ROOM],
    near: [[f32; ROOM]; 2],
    len: usize,
    /// Rays and cells of which nothing is known, which are looked at in the end.
    put_off: Vec<(u8, u32)>,
    /// Room for the walk through the boxes.
    errands: Vec<Errand>,
}

/// Fewer than eight that wait, those of one more cell, and eight that are read beyond the last.
const ROOM: usize = BLOCK + 2 * LANES;

impl Default for Met {
    fn default() -> Self {
        Self {
            numbers: [0; ROOM],
            cells: [0; ROOM],
            near: [[0.0; ROOM]; 2],
            len: 0,
            put_off: Vec::new(),
            errands: Vec::new(),
        }
    }
}

impl Met {
    #[inline(always)]
    fn clear(&mut self) {
        self.len = 0;
        self.put_off.clear();
    }

    /// `count` numbers from `first` on; behind the last there is the first again.
    #[inline(always)]
    fn lanes(&self, first: usize, count: usize) -> [u8; LANES] {
        let mut lanes = [self.numbers[first]; LANES];
        lanes[..count].copy_from_slice(&self.numbers[first..][..count]);
        lanes
    }

    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, k: usize, first: usize) -> F<S> {
        F::from_fn(
            simd,
            #[inline(always)]
            |lane| f64::from(self.near[k][first + lane]),
        )
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, block: &RayBlock, k: usize, first: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &block.single[k][first..][..WIDE])
}

/// Which of sixteen rays meet a box before the end of their interest.
#[inline(always)]
fn box_met<S: Simd>(simd: S, block: &RayBlock, first: usize, sides: &[[f32; 2]; 3]) -> u64 {
    let (mut near, mut far) = (row(simd, block, NEAR, first), row(simd, block, FAR, first));
    for (axis, [low, high]) in sides.iter().enumerate() {
        let (origin, inverse) = (row(simd, block, axis, first), row(simd, block, INVERSE + axis, first));
        let low = (f32x16::splat(simd, *low) - origin) * inverse;
        let high = (f32x16::splat(simd, *high) - origin) * inverse;
        near = near.max(low.min(high));
        far = far.min(low.max(high));
    }
    near.simd_le(far).to_bitmask()
}

/// What the plane of a cell tells about sixteen rays: see [`Cell::meets`]. Gathers those that meet it once,
/// and returns those of which nothing is known.
#[inline(always)]
fn meet_plane<S: Simd>(
    simd: S,
    block: &RayBlock,
    first: usize,
    rays: u64,
    (cell, number): (&Cell, u32),
    met: &mut Met,
) -> u64 {
    let rows = rows_of(&cell.local_from_object);
    let center = cell.center.to_array();
    let [ox, oy, oz] = channels!(k => row(simd, block, k, first) - f32x16::splat(simd, center[k]));
    let [dx, dy, dz] = channels!(k => row(simd, block, DIRECTION + k, first));
    let o = channels!(k => along(simd, rows[k], [ox, oy, oz]));
    let d = channels!(k => along(simd, rows[k], [dx, dy, dz]));
    let fall = f32x16::splat(simd, 1.0) / d[2];
    let (slope_x, slope_y) = (d[0] * fall, d[1] * fall);
    let (x, y) = (o[0] - o[2] * slope_x, o[1] - o[2] * slope_y);
    let tilt = f32x16::splat(simd, cell.tilt);
    let reach_x = f32x16::splat(simd, cell.spread.x) + tilt * slope_x.abs();
    let reach_y = f32x16::splat(simd, cell.spread.y) + tilt * slope_y.abs();
    // Not a number when a ray runs along the plane.
    let least = f32x16::splat(simd, 0.95);
    let once = (reach_x.simd_lt(least) & reach_y.simd_lt(least)).to_bitmask() & rays;
    let mut unknown = rays & !once;
    if unknown != 0 && cell.tilt < f32::INFINITY {
        let limits = [row(simd, block, NEAR, first), row(simd, block, FAR, first)];
        unknown &= meet_frame(simd, cell, &o, &d, limits);
    }
    let (inner, one) = (f32x16::splat(simd, cell.inner), f32x16::splat(simd, 1.0));
    let inside = (x.abs() - inner * reach_x).simd_le(one) & (y.abs() - inner * reach_y).simd_le(one);
    let inside = inside.to_bitmask() & once;
    if inside == 0 {
        return unknown;
    }
    let (x, y): ([f32; WIDE], [f32; WIDE]) = (x.into(), y.into());
    for k in bits_of(inside) {
        let (k, len) = (k % WIDE, met.len % (BLOCK + LANES));
        met.numbers[len] = (first + k) as u8;
        met.cells[len] = number;
        met.near[0][len] = x[k];
        met.near[1][len] = y[k];
        met.len = len + 1;
    }
    unknown
}

/// Which of sixteen rays, given in the frame of a cell, can meet it at all before the end of their interest: the
/// twin of what [`Cell::meets`] asks of rays along the surface.
#[inline(always)]
fn meet_frame<S: Simd>(
    simd: S,
    cell: &Cell,
    o: &[f32x16<S>; 3],
    d: &[f32x16<S>; 3],
    [mut enter, mut leave]: [f32x16<S>; 2],
) -> u64 {
    let [low, high] = cell.extent.map(|corner| corner.to_array());
    let mut outside = 0;
    for k in 0..3 {
        let (low, high) = (f32x16::splat(simd, low[k]), f32x16::splat(simd, high[k]));
        let along = d[k].abs().simd_le(f32x16::splat(simd, 1e-20));
        outside |= (along & (o[k].simd_lt(low) | o[k].simd_gt(high))).to_bitmask();
        let (a, b) = ((low - o[k]) / d[k], (high - o[k]) / d[k]);
        enter = along.select(enter, enter.max(a.min(b)));
        leave = along.select(leave, leave.min(a.max(b)));
    }
    enter.simd_le(leave + f32x16::splat(simd, PLACE_SLACK)).to_bitmask() & !outside
}

/// The rows of a matrix.
#[inline(always)]
fn rows_of(m: &Mat3) -> [[f32; 3]; 3] {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    [[x.x, y.x, z.x], [x.y, y.y, z.y], [x.z, y.z, z.z]]
}

/// A row of a matrix times sixteen vectors.
#[inline(always)]
fn along<S: Simd>(simd: S, row: [f32; 3], [x, y, z]: [f32x16<S>; 3]) -> f32x16<S> {
    f32x16::splat(simd, row[0]) * x + f32x16::splat(simd, row[1]) * y + f32x16::splat(simd, row[2]) * z
}

/// The greatest number of a row among some rays.
#[inline(always)]
fn greatest<S: Simd>(simd: S, row: &[f32; BLOCK], rays: u64) -> f32 {
    let mut most = f32x16::splat(simd, f32::NEG_INFINITY);
    for first in (0..BLOCK).step_by(WIDE) {
        let among = among::<S>(simd, rays, first);
        let values = f32x16::from_slice(simd, &row[first..][..WIDE]);
        most = among.select(values, most).max(most);
    }
    most.reduce_max()
}

/// The least and the greatest number of a row among some rays.
#[inline(always)]
fn ends<S: Simd>(simd: S, row: &[f32; BLOCK], rays: u64) -> [f32; 2] {
    let mut least = f32x16::splat(simd, f32::INFINITY);
    let mut most = f32x16::splat(simd, f32::NEG_INFINITY);
    for first in (0..BLOCK).step_by(WIDE) {
        if rays >> first & 0xffff == 0 {
            continue;
        }
        let among = among::<S>(simd, rays, first);
        let values = f32x16::from_slice(simd, &row[first..][..WIDE]);
        least = among.select(values, least).min(least);
        most = among.select(values, most).max(most);
    }
    [least.reduce_min(), most.reduce_max()]
}

#[inline(always)]
fn among<S: Simd>(simd: S, rays: u64, first: usize) -> fearless_simd::mask32x16<S> {
    fearless_simd::mask32x16::from_bitmask(simd, rays >> first & 0xffff)
}

/// [`ends`] of three rows.
#[inline(always)]
fn ends_of_three<S: Simd>(simd: S, block: &RayBlock, k: usize, rays: u64) -> [[f32; 3]; 2] {
    let axes = channels!(axis => ends(simd, &block.single[k + axis], rays));
    [channels!(axis => axes[axis][0]), channels!(axis => axes[axis][1])]
}

/// Bounds on some rays of a block.
#[inline(always)]
fn beam_of<S: Simd>(simd: S, block: &RayBlock, rays: u64) -> Beam {
    Beam {
        origin: ends_of_three(simd, block, 0, rays),
        inverse: ends_of_three(simd, block, INVERSE, rays),
        direction: ends_of_three(simd, block, DIRECTION, rays),
        near: ends(simd, &block.single[NEAR], rays)[0],
        far: greatest(simd, &block.single[FAR], rays),
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use senca_math::glam::DVec3;

    use super::*;
    use crate::Ray;
    use crate::intersect::Intersect;
    use crate::intersect::patches::tests::{ball, rays_around, surface, teapot};

    /// The rays, up to 64, as a block.
    fn block<S: Simd>(simd: S, rays: &[Ray]) -> RayBlock {
        let mut block = RayBlock::default();
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let ray = |lane: usize| rays[lane.min(rays.len() - 1)];
            let row = |of: &dyn Fn(Ray) -> f64| F::from_fn(simd, |lane| of(ray(lane)));
            let vector = |of: &dyn Fn(Ray) -> DVec3| V {
                x: row(&|ray| of(ray).x),
                y: row(&|ray| of(ray).y),
                z: row(&|ray| of(ray).z),
            };
            let limits = [row(&|ray| ray.t_min), row(&|ray| ray.t_max)];
            let live = first_lanes(simd, rays.len());
            block.put(number, [vector(&|ray| ray.origin), vector(&|ray| ray.direction)], limits, live);
        }
        block
    }

    fn nearest(surface: &PatchSurface, rays: &[Ray], level: Level) -> Vec<Option<Crossing>> {
        dispatch!(level, simd => {
            let mut block = block(simd, rays);
            surface.closest_of_block(simd, &mut block, &mut Counters::default());
            (0..rays.len()).map(|lane| (block.hits() >> lane & 1 == 1).then(|| block.crossing(lane))).collect()
        })
    }

    /// Hit for hit what rays alone find, and the same whatever rays are beside them.
    fn assert_agree(surface: &PatchSurface, rays: &[Ray]) -> usize {
        let mut met = 0;
        for rays in rays.chunks(BLOCK) {
            let found = nearest(surface, rays, Level::new());
            assert!(found == nearest(surface, rays, Level::baseline()), "levels of vectors differ");
            let blocked = dispatch!(Level::new(), simd => {
                surface.blocked_of_block(simd, &mut block(simd, rays), &mut Counters::default())
            });
            for (lane, (ray, found)) in rays.iter().zip(&found).enumerate() {
                let alone = surface.closest(ray, &mut Counters::default());
                assert_eq!(alone.is_some(), found.is_some(), "{ray:?}");
                assert_eq!(alone.is_some(), blocked >> lane & 1 == 1, "{ray:?}");
                assert_eq!(nearest(surface, &[*ray], Level::new()), [*found], "{ray:?}");
                if let (Some(alone), Some(found)) = (alone, found) {
                    let scale = surface.scale / ray.direction.length();
                    assert!((alone.t - found.t).abs() < 1e-9 * scale.max(alone.t), "{alone:?} {found:?}");
                    met += 1;
                }
            }
        }
        met
    }

    #[test]
    fn rays_all_ways_meet_what_they_meet_alone() {
        let rays: Vec<Ray> = rays_around(1200).collect();
        assert!(assert_agree(&surface(&teapot()), &rays) > 100);
        assert!(assert_agree(&PatchSurface::from_nurbs(&ball(3.0)).unwrap(), &rays) > 100);
    }

    #[test]
    fn rays_of_a_picture_meet_what_they_meet_alone() {
        let teapot = surface(&teapot());
        let eye = DVec3::new(2.0, -9.0, 4.0);
        let forward = (DVec3::Z - eye).normalize();
        let (right, up) = forward.any_orthonormal_pair();
        let ray = |i: usize| {
            let (x, y) = ((i % 40) as f64 / 20.0 - 1.0, (i / 40) as f64 / 20.0 - 1.0);
            Ray::new(eye, forward + 0.8 * (x * right + y * up))
        };
        let rays: Vec<Ray> = (0..1600).map(ray).collect();
        assert!(assert_agree(&teapot, &rays) > 0);
    }

    #[test]
    fn bad_rays_of_a_block_meet_nothing() {
        let teapot = surface(&teapot());
        let (o, d) = (DVec3::new(0.0, -9.0, 1.0), DVec3::Y);
        let bad = f64::NAN;
        let rays = [
            Ray::new(o * bad, d),
            Ray::new(o, d * bad),
            Ray::new(o, DVec3::ZERO),
            Ray::new(o, d * f64::INFINITY),
            Ray { t_min: bad, ..Ray::new(o, d) },
            Ray { t_max: -1.0, ..Ray::new(o, d) },
            Ray::new(o * 1e300, d * 1e-300),
            Ray::new(o, d),
            Ray::new(o, d * 1e-200),
            Ray::new(o, d * 1e150),
        ];
        assert_eq!(assert_agree(&teapot, &rays), 3);
    }
}
