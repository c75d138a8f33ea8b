//! From indices to triangles: reads corners and varyings, checks them, clips what must be.

use crate::api::{Counters, Interpolation, MAX_VARYINGS, Primitives, State};
use crate::clip::Polygon;
use crate::setup::{Plane, ScreenMap, ScreenVertex, Setup, SetupState, UNPROJECTED, double_area, is_culled};
use senca_math::glam::Vec4;

/// Number of vertices a draw may refer to: those with a position and all their varyings; 0 when a
/// vertex has more varyings than are allowed.
pub(crate) fn vertex_count(p: &Primitives<'_>) -> usize {
    match p.stride {
        0 => p.positions.len(),
        1..=MAX_VARYINGS => p.positions.len().min(p.varyings.len() / p.stride),
        _ => 0,
    }
}

/// Varyings of vertex `i`; the number has been checked.
#[inline(always)]
pub(crate) fn varyings_of<'a>(p: &Primitives<'a>, i: u32) -> &'a [f32] {
    &p.varyings[i as usize * p.stride..][..p.stride]
}

/// Varyings of a triangle, ready to be interpolated.
///
/// Where weights are linear on the screen, each varying is a [`Plane`]: constant, change in x, change
/// in y. Under perspective it is the value at corner 0 and what corners 1 and 2 add.
#[derive(Clone, Debug)]
pub(crate) struct TriangleVaryings {
    pub(crate) count: usize,
    pub(crate) terms: [[f32; 3]; MAX_VARYINGS],
}

impl Default for TriangleVaryings {
    fn default() -> Self {
        Self { count: 0, terms: [[0.0; 3]; MAX_VARYINGS] }
    }
}

impl TriangleVaryings {
    /// From the varyings of the three corners as submitted.
    pub(crate) fn set(&mut self, corners: [&[f32]; 3], setup: &Setup, interpolation: Interpolation) {
        let [c0, c1, c2] = match interpolation {
            Interpolation::FlatFirst => [corners[0]; 3],
            Interpolation::FlatLast => [corners[2]; 3],
            _ if setup.swapped => [corners[0], corners[2], corners[1]],
            _ => corners,
        };
        self.count = c0.len();
        for (terms, ((&a, &b), &c)) in self.terms.iter_mut().zip(c0.iter().zip(c1).zip(c2)) {
            *terms = [a, b - a, c - a];
            if setup.affine {
                let plane = Plane::combine(a, b - a, &setup.b1, c - a, &setup.b2);
                *terms = [plane.c, plane.dx, plane.dy];
            }
        }
    }

    /// Varying `k` at a pixel, `fx`, `fy` from the reference, with the weights there.
    pub(crate) fn at(&self, k: usize, affine: bool, [fx, fy]: [f32; 2], [b1, b2, _]: [f32; 3]) -> f32 {
        let [a, b, c] = self.terms[k];
        if affine { (a + c * fy) + b * fx } else { (a + b1 * b) + b2 * c }
    }
}

#[expect(clippy::large_enum_variant, reason = "lives on the stack for a moment, never stored")]
/// What became of a triangle on its way to the screen.
pub(crate) enum Assembled {
    /// Nothing to draw; counted.
    Nothing,
    /// Whole.
    Whole([ScreenVertex; 3]),
    /// Cut into a polygon.
    Cut(Polygon),
}

/// Classifies a triangle given its corners in clip space and projected, and counts it.
pub(crate) fn assemble(
    clip: [Vec4; 3],
    screen: [ScreenVertex; 3],
    map: &ScreenMap,
    counters: &mut Counters,
) -> Assembled {
    if screen.iter().all(|v| v.x != UNPROJECTED) {
        return Assembled::Whole(screen);
    }
    if !clip.iter().all(|c| c.is_finite()) {
        counters.invalid += 1;
        return Assembled::Nothing;
    }
    let Some(polygon) = map.clip(clip) else {
        counters.outside += 1;
        return Assembled::Nothing;
    };
    counters.clipped += 1;
    Assembled::Cut(polygon)
}

/// The varyings of a vertex made by clipping. The provoking corner's, whole, for flat shading.
pub(crate) fn clipped_varyings(
    corners: [&[f32]; 3],
    weights: [f32; 3],
    interpolation: Interpolation,
    k: usize,
) -> f32 {
    match interpolation {
        Interpolation::FlatFirst => corners[0][k],
        Interpolation::FlatLast => corners[2][k],
        _ => (corners[0][k] * weights[0] + corners[1][k] * weights[1]) + corners[2][k] * weights[2],
    }
}

/// Calls `emit` for every piece of every triangle that has pixels to draw, in order.
///
/// `emit` gets the set-up, the varyings and the identifier.
pub(crate) fn for_each_triangle(
    p: &Primitives<'_>,
    map: &ScreenMap,
    state: &State,
    counters: &mut Counters,
    mut emit: impl FnMut(&Setup, &TriangleVaryings, u32, &mut Counters),
) {
    let setup_state = SetupState::new(state);
    let (vertices, mut varyings) = (vertex_count(p), TriangleVaryings::default());
    for (n, index) in p.indices.chunks_exact(3).enumerate() {
        counters.primitives += 1;
        if index.iter().any(|&i| i as usize >= vertices) {
            counters.invalid += 1;
            continue;
        }
        let corners = [index[0], index[1], index[2]];
        let clip = corners.map(|i| p.positions[i as usize]);
        let values = corners.map(|i| varyings_of(p, i));
        let mut piece = |screen: [ScreenVertex; 3], values: [&[f32]; 3], counters: &mut Counters| {
            let area = double_area(&screen);
            if is_culled(area, setup_state.cull) {
                counters.culled += 1;
                return;
            }
            let setup = Setup::new(screen, area, &setup_state);
            varyings.set(values, &setup, state.interpolation);
            counters.drawn += 1;
            emit(&setup, &varyings, p.ids.of(n), counters);
        };
        match assemble(clip, clip.map(|c| map.project(c)), map, counters) {
            Assembled::Nothing => {}
            Assembled::Whole(screen) => piece(screen, values, counters),
            Assembled::Cut(polygon) => {
                for fan in polygon.triangles() {
                    let v = fan.map(|k| polygon.vertices()[k]);
                    let mut made = [[0.0; MAX_VARYINGS]; 3];
                    for (m, v) in made.iter_mut().zip(&v) {
                        for (k, m) in m.iter_mut().enumerate().take(p.stride) {
                            *m = clipped_varyings(values, v.weights, state.interpolation, k);
                        }
                    }
                    let made = [&made[0][..p.stride], &made[1][..p.stride], &made[2][..p.stride]];
                    piece(v.map(|v| map.project_clipped(v.position)), made, counters);
                }
            }
        }
    }
}
