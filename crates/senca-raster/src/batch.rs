//! Sixteen triangles set up at once, one per lane: the vector twin of [`Setup::new`],
//! [`TriangleVaryings::set`] and [`TileEdges::new`], to the same bits.
//!
//! Small triangles, which are most, fit 32-bit integers throughout: with sides below 64 pixels and a
//! corner within 128 pixels of the tile's first pixel, edge values stay below 2^31. A larger triangle
//! goes through the scalar functions into its lane.

use crate::api::{Interpolation, LANES, MAX_VARYINGS};
use crate::assemble::TriangleVaryings;
use crate::bin::pixel_box;
use crate::blend::pack;
use crate::cover::{ColorPath, Pass, TileEdges};
use crate::setup::{Bounds, HALF, SUB, SUB_BITS, ScreenVertex, Setup, double_area};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*};

/// Longest side, in fixed-point units, of a triangle set up in vectors: 64 pixels.
const SMALL: i32 = 64 << SUB_BITS;

/// A plane per lane: constant, change in x, change in y.
pub(crate) type PlaneLanes = [[f32; LANES]; 3];

/// Up to 16 triangles: corners in, set-up out.
#[derive(Debug)]
pub(crate) struct Batch {
    /// Lanes in use.
    pub(crate) len: usize,
    pub(crate) x: [[i32; LANES]; 3],
    pub(crate) y: [[i32; LANES]; 3],
    pub(crate) z: [[f32; LANES]; 3],
    pub(crate) q: [[f32; LANES]; 3],
    /// Varyings of the corners, by slot.
    pub(crate) values: Box<[[[f32; LANES]; 3]; MAX_VARYINGS]>,
    pub(crate) ids: [u32; LANES],

    /// Edge functions over the tile; see [`TileEdges`].
    pub(crate) edge: [[i32; LANES]; 3],
    pub(crate) edge_dx: [[i32; LANES]; 3],
    pub(crate) edge_dy: [[i32; LANES]; 3],
    /// Pixels of the tile to look at: `x0`, `y0`, `x1`, `y1`, half open; none when empty.
    pub(crate) area: [[i32; LANES]; 4],
    /// From the triangle's reference pixel to the tile's first.
    pub(crate) offset: [[i32; LANES]; 2],
    pub(crate) depth: PlaneLanes,
    pub(crate) z_min: [f32; LANES],
    pub(crate) z_max: [f32; LANES],
    pub(crate) b1: PlaneLanes,
    pub(crate) b2: PlaneLanes,
    pub(crate) inv_w: PlaneLanes,
    /// Terms of the varyings, by slot; see [`TriangleVaryings`].
    pub(crate) varyings: Box<[PlaneLanes; MAX_VARYINGS]>,
    /// Varyings of the fragments that go to a stage: memory that is used again.
    pub(crate) interpolated: Vec<[f32; LANES]>,
    /// Bit by lane: weights are linear on the screen.
    pub(crate) affine: u16,
    /// Bit by lane: corners 1 and 2 exchanged; the triangle shows its front.
    pub(crate) swapped: u16,
    /// Bit by lane: all corners have the same colour.
    pub(crate) flat: u16,
    /// Those colours in 8 bits, red in the low byte.
    pub(crate) flat_color: [u32; LANES],
}

impl Default for Batch {
    fn default() -> Self {
        let (i, f) = ([0; LANES], [0.0; LANES]);
        Self {
            len: 0,
            x: [i; 3],
            y: [i; 3],
            z: [f; 3],
            q: [f; 3],
            values: Box::new([[f; 3]; MAX_VARYINGS]),
            ids: [0; LANES],
            edge: [i; 3],
            edge_dx: [i; 3],
            edge_dy: [i; 3],
            area: [i; 4],
            offset: [i; 2],
            depth: [f; 3],
            z_min: f,
            z_max: f,
            b1: [f; 3],
            b2: [f; 3],
            inv_w: [f; 3],
            varyings: Box::new([[f; 3]; MAX_VARYINGS]),
            interpolated: Vec::with_capacity(MAX_VARYINGS),
            affine: 0,
            swapped: 0,
            flat: 0,
            flat_color: [0; LANES],
        }
    }
}

/// Linear quantities of 16 triangles; see [`crate::setup::Plane`].
#[derive(Clone, Copy)]
struct Planes<S: Simd> {
    c: f32x16<S>,
    dx: f32x16<S>,
    dy: f32x16<S>,
}

impl<S: Simd> Planes<S> {
    /// See [`crate::setup::Plane::combine`].
    #[inline(always)]
    fn combine(base: f32x16<S>, a: f32x16<S>, pa: &Self, b: f32x16<S>, pb: &Self) -> Self {
        Self { c: base + (a * pa.c + b * pb.c), dx: a * pa.dx + b * pb.dx, dy: a * pa.dy + b * pb.dy }
    }

    #[inline(always)]
    fn scaled_unless(self, keep: mask32x16<S>, s: f32x16<S>) -> Self {
        Self {
            c: keep.select(self.c, self.c * s),
            dx: keep.select(self.dx, self.dx * s),
            dy: keep.select(self.dy, self.dy * s),
        }
    }

    #[inline(always)]
    fn store(self, to: &mut PlaneLanes) {
        self.c.store_array(&mut to[0]);
        self.dx.store_array(&mut to[1]);
        self.dy.store_array(&mut to[2]);
    }
}

/// Corners of 16 triangles, 1 and 2 exchanged where the area was negative.
struct Corners<S: Simd> {
    x: [i32x16<S>; 3],
    y: [i32x16<S>; 3],
    swapped: mask32x16<S>,
    area: i32x16<S>,
}

impl Batch {
    /// Memory of its varyings.
    pub(crate) const BOXED_BYTES: usize =
        2 * MAX_VARYINGS * size_of::<PlaneLanes>() + MAX_VARYINGS * size_of::<[f32; LANES]>();

    /// Puts a triangle into the next lane; returns the lane. Varyings are the caller's to fill in.
    #[inline(always)]
    pub(crate) fn push(&mut self, v: &[ScreenVertex; 3], id: u32) -> usize {
        let lane = self.len % LANES;
        for (k, v) in v.iter().enumerate() {
            self.x[k][lane] = v.x;
            self.y[k][lane] = v.y;
            self.z[k][lane] = v.z;
            self.q[k][lane] = v.inv_w;
        }
        self.ids[lane] = id;
        self.len += 1;
        lane
    }

    /// Sets all lanes up for the tile whose first pixel is `first` from the origin of the fixed-point
    /// raster, and of whose pixels `bounds` (of the target) may be written.
    #[inline(always)]
    pub(crate) fn prepare<S: Simd>(
        &mut self,
        simd: S,
        pass: &Pass<'_>,
        tile: [i32; 2],
        bounds: &Bounds,
        slots: usize,
    ) {
        let origin = pass.map.origin;
        let first = [tile[0] - origin[0], tile[1] - origin[1]];
        let corners = self.corners(simd);
        self.set_edges(simd, &corners, first);
        self.set_area(simd, &corners, origin, tile, bounds);
        self.set_planes(simd, &corners, pass, first, slots);
        for lane in 0..self.len {
            let spread = |v: &[[i32; LANES]; 3]| {
                let (a, b, c) = (v[0][lane], v[1][lane], v[2][lane]);
                a.max(b).max(c) - a.min(b).min(c)
            };
            if spread(&self.x) >= SMALL || spread(&self.y) >= SMALL {
                self.set_large(lane, pass, tile, bounds, slots);
            }
        }
        self.flat = 0;
        if let ColorPath::Varying { alpha } = pass.color {
            self.set_flat(simd, if alpha { 4 } else { 3 });
        }
    }

    /// Finds the lanes whose colour, in the first `count` slots, is the same everywhere.
    #[inline(always)]
    fn set_flat<S: Simd>(&mut self, simd: S, count: usize) {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let (mut flat, mut color) = (mask32x16::splat(simd, true), [one; 4]);
        for (color, [c, dx, dy]) in color.iter_mut().zip(&self.varyings[..count]) {
            *color = f32x16::load_array_ref(simd, c);
            flat &= f32x16::load_array_ref(simd, dx).simd_eq(zero);
            flat &= f32x16::load_array_ref(simd, dy).simd_eq(zero);
        }
        self.flat = flat.to_bitmask() as u16;
        pack(simd, color).store_array(&mut self.flat_color);
    }

    #[inline(always)]
    fn corners<S: Simd>(&mut self, simd: S) -> Corners<S> {
        let [x0, x1, x2] = load3(simd, &self.x);
        let [y0, y1, y2] = load3(simd, &self.y);
        let area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
        let swapped = area.simd_lt(i32x16::splat(simd, 0));
        self.swapped = swapped.to_bitmask() as u16;
        Corners {
            x: [x0, swapped.select(x2, x1), swapped.select(x1, x2)],
            y: [y0, swapped.select(y2, y1), swapped.select(y1, y2)],
            swapped,
            area: area.abs(),
        }
    }

    #[inline(always)]
    fn set_edges<S: Simd>(&mut self, simd: S, c: &Corners<S>, first: [i32; 2]) {
        let cx = i32x16::splat(simd, first[0].wrapping_mul(SUB).wrapping_add(HALF));
        let cy = i32x16::splat(simd, first[1].wrapping_mul(SUB).wrapping_add(HALF));
        let zero = i32x16::splat(simd, 0);
        for k in 0..3 {
            let n = (k + 1) % 3;
            let (ex, ey) = (c.x[n] - c.x[k], c.y[n] - c.y[k]);
            let value = ex * (cy - c.y[k]) - ey * (cx - c.x[k]);
            let owns = ey.simd_lt(zero) | (ey.simd_eq(zero) & ex.simd_gt(zero));
            let value = owns.select(value, value - i32x16::splat(simd, 1)) >> SUB_BITS;
            value.store_array(&mut self.edge[k]);
            (zero - ey).store_array(&mut self.edge_dx[k]);
            ex.store_array(&mut self.edge_dy[k]);
        }
    }

    #[inline(always)]
    fn set_area<S: Simd>(&mut self, simd: S, c: &Corners<S>, origin: [i32; 2], tile: [i32; 2], b: &Bounds) {
        let low = [b.x0 - tile[0], b.y0 - tile[1]];
        let high = [b.x1 - tile[0], b.y1 - tile[1]];
        for (k, v) in [&c.x, &c.y].into_iter().enumerate() {
            let shift = i32x16::splat(simd, origin[k] - tile[k]);
            let round = i32x16::splat(simd, HALF - 1);
            let from = ((v[0].min(v[1]).min(v[2]) + round) >> SUB_BITS) + shift;
            let to = ((v[0].max(v[1]).max(v[2]) + round) >> SUB_BITS) + shift;
            from.max(i32x16::splat(simd, low[k])).store_array(&mut self.area[k]);
            to.min(i32x16::splat(simd, high[k])).store_array(&mut self.area[k + 2]);
        }
    }

    #[inline(always)]
    fn set_planes<S: Simd>(
        &mut self,
        simd: S,
        c: &Corners<S>,
        pass: &Pass<'_>,
        first: [i32; 2],
        slots: usize,
    ) {
        let one = f32x16::splat(simd, 1.0);
        let inv_area = one / c.area.to_float::<f32x16<S>>();
        let (rx, ry) = (c.x[0] >> SUB_BITS, c.y[0] >> SUB_BITS);
        let (sub, half) = (i32x16::splat(simd, SUB), i32x16::splat(simd, HALF));
        let s: [f32x16<S>; 2] =
            [(rx * sub + half - c.x[0]).to_float(), (ry * sub + half - c.y[0]).to_float()];
        (i32x16::splat(simd, first[0]) - rx).store_array(&mut self.offset[0]);
        (i32x16::splat(simd, first[1]) - ry).store_array(&mut self.offset[1]);
        let b1 = weight(simd, c.y[2] - c.y[0], c.x[0] - c.x[2], inv_area, s);
        let b2 = weight(simd, c.y[0] - c.y[1], c.x[1] - c.x[0], inv_area, s);
        self.set_depth(simd, c.swapped, pass, &b1, &b2);
        let [q0, q1, q2] = exchanged(simd, &self.q, c.swapped);
        let same = q0.simd_eq(q1) & q0.simd_eq(q2);
        let affine = if pass.setup.screen_space { mask32x16::splat(simd, true) } else { same };
        self.affine = affine.to_bitmask() as u16;
        Planes::combine(q0, q1 - q0, &b1, q2 - q0, &b2).store(&mut self.inv_w);
        for slot in 0..slots.min(MAX_VARYINGS) {
            let [v0, v1, v2] = exchanged(simd, &self.values[slot], c.swapped);
            let (e1, e2) = (v1 - v0, v2 - v0);
            let plane = Planes::combine(v0, e1, &b1, e2, &b2);
            let terms = Planes {
                c: affine.select(plane.c, v0),
                dx: affine.select(plane.dx, e1),
                dy: affine.select(plane.dy, e2),
            };
            terms.store(&mut self.varyings[slot]);
        }
        b1.scaled_unless(affine, q1).store(&mut self.b1);
        b2.scaled_unless(affine, q2).store(&mut self.b2);
    }

    #[inline(always)]
    fn set_depth<S: Simd>(
        &mut self,
        simd: S,
        swapped: mask32x16<S>,
        pass: &Pass<'_>,
        b1: &Planes<S>,
        b2: &Planes<S>,
    ) {
        let [z0, z1, z2] = exchanged(simd, &self.z, swapped);
        let mut depth = Planes::combine(z0, z1 - z0, b1, z2 - z0, b2);
        let slope = depth.dx.abs().max(depth.dy.abs());
        let bias = f32x16::splat(simd, pass.setup.bias_constant)
            + f32x16::splat(simd, pass.setup.bias_slope) * slope;
        depth.c += bias;
        depth.store(&mut self.depth);
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        (z0.min(z1).min(z2) + bias).max(zero).min(one).store_array(&mut self.z_min);
        (z0.max(z1).max(z2) + bias).max(zero).min(one).store_array(&mut self.z_max);
    }

    /// Sets one lane up with the scalar functions.
    #[inline(never)]
    fn set_large(&mut self, lane: usize, pass: &Pass<'_>, tile: [i32; 2], bounds: &Bounds, slots: usize) {
        let corner = |k: usize| ScreenVertex {
            x: self.x[k][lane],
            y: self.y[k][lane],
            z: self.z[k][lane],
            inv_w: self.q[k][lane],
        };
        let corners = [corner(0), corner(1), corner(2)];
        let map = pass.map;
        let first = [tile[0] - map.origin[0], tile[1] - map.origin[1]];
        let pixels = pixel_box(&corners, map).intersect(*bounds);
        let local = Bounds {
            x0: pixels.x0 - tile[0],
            y0: pixels.y0 - tile[1],
            x1: pixels.x1 - tile[0],
            y1: pixels.y1 - tile[1],
        };
        // Many do not meet the tile: only their box does.
        let area = double_area(&corners);
        let v = if area < 0 { [corners[0], corners[2], corners[1]] } else { corners };
        let edges = if local.is_empty() { None } else { TileEdges::new(&v, first, &local) };
        let Some(edges) = edges else {
            (0..4).for_each(|k| self.area[k][lane] = 0);
            return;
        };
        let setup = Setup::new(corners, area, &pass.setup);
        for (k, v) in [local.x0, local.y0, local.x1, local.y1].into_iter().enumerate() {
            self.area[k][lane] = v;
        }
        for k in 0..3 {
            self.edge[k][lane] = edges.c[k];
            self.edge_dx[k][lane] = edges.dx[k];
            self.edge_dy[k][lane] = edges.dy[k];
        }
        self.offset[0][lane] = first[0] - setup.reference[0];
        self.offset[1][lane] = first[1] - setup.reference[1];
        (self.z_min[lane], self.z_max[lane]) = (setup.z_min, setup.z_max);
        let planes = [&mut self.depth, &mut self.b1, &mut self.b2, &mut self.inv_w];
        for (to, from) in planes.into_iter().zip([setup.z, setup.b1, setup.b2, setup.q]) {
            set_plane(to, lane, [from.c, from.dx, from.dy]);
        }
        let bit = |mask: u16, on: bool| mask & !(1 << lane) | u16::from(on) << lane;
        (self.affine, self.swapped) = (bit(self.affine, setup.affine), bit(self.swapped, setup.swapped));
        let mut varyings = TriangleVaryings::default();
        for slot in 0..slots.min(MAX_VARYINGS) {
            let value = self.values[slot].map(|v| v[lane]);
            let slices = [&value[0..1], &value[1..2], &value[2..3]];
            varyings.set(slices, &setup, Interpolation::Perspective);
            set_plane(&mut self.varyings[slot], lane, varyings.terms[0]);
        }
    }
}

fn set_plane(to: &mut PlaneLanes, lane: usize, [c, dx, dy]: [f32; 3]) {
    (to[0][lane], to[1][lane], to[2][lane]) = (c, dx, dy);
}

#[inline(always)]
fn load3<S: Simd>(simd: S, v: &[[i32; LANES]; 3]) -> [i32x16<S>; 3] {
    [
        i32x16::load_array_ref(simd, &v[0]),
        i32x16::load_array_ref(simd, &v[1]),
        i32x16::load_array_ref(simd, &v[2]),
    ]
}

/// Values at corners 0, 1, 2, the latter two exchanged where told.
#[inline(always)]
fn exchanged<S: Simd>(simd: S, v: &[[f32; LANES]; 3], swapped: mask32x16<S>) -> [f32x16<S>; 3] {
    let (a, b) = (f32x16::load_array_ref(simd, &v[1]), f32x16::load_array_ref(simd, &v[2]));
    [f32x16::load_array_ref(simd, &v[0]), swapped.select(b, a), swapped.select(a, b)]
}

/// The weight of a corner; see [`Setup::new`].
#[inline(always)]
fn weight<S: Simd>(
    simd: S,
    ex: i32x16<S>,
    ey: i32x16<S>,
    inv_area: f32x16<S>,
    [sx, sy]: [f32x16<S>; 2],
) -> Planes<S> {
    let (ex, ey) = (ex.to_float::<f32x16<S>>() * inv_area, ey.to_float::<f32x16<S>>() * inv_area);
    let sub = f32x16::splat(simd, SUB as f32);
    Planes { c: ex * sx + ey * sy, dx: ex * sub, dy: ey * sub }
}
