//! How two patches meet.
//!
//! Two bicubic patches share an edge when its four control points are the same. For the tangents to
//! agree across it, it suffices that on every row of control points that crosses the seam three are
//! collinear: the one on each side and the shared one. Source: 1991 thesis, section 5.2.

use glam::DVec3;

use super::BicubicPatch;
use crate::frame::unit;

/// An edge of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PatchEdge {
    /// u = 0.
    UMin,
    /// u = 1.
    UMax,
    /// v = 0.
    VMin,
    /// v = 1.
    VMax,
}

impl PatchEdge {
    /// All four.
    pub const ALL: [Self; 4] = [Self::UMin, Self::UMax, Self::VMin, Self::VMax];
}

/// How smoothly two patches meet in an edge. Each kind includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Continuity {
    /// They do not share the edge.
    Gap,
    /// The edge is shared, with a crease.
    C0,
    /// The tangents across the edge agree in direction.
    G1,
    /// The derivatives across the edge are equal.
    C1,
}

/// Measures of the seam between two patches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// Largest distance between control points of the edges that should coincide.
    pub gap: f64,
    /// Largest angle, in radians, between the tangents across the seam on a row of control points.
    pub tangent_angle: f64,
    /// Largest difference of the derivatives across the seam.
    pub derivative_difference: f64,
    /// Largest angle, in radians, between the normals on both sides, at nine points of the seam.
    pub normal_angle: f64,
}

impl Seam {
    /// Measures the seam between an edge of one patch and an edge of another, which may run either
    /// way; of the two ways the one with the smaller gap is taken.
    #[must_use]
    pub fn between(a: &BicubicPatch, a_edge: PatchEdge, b: &BicubicPatch, b_edge: PatchEdge) -> Self {
        let forward = Self::measure(&a.facing(a_edge), &b.facing(b_edge));
        let backward = Self::measure(&a.facing(a_edge), &b.facing(b_edge).reversed_along_seam());
        if backward.gap < forward.gap { backward } else { forward }
    }

    /// The continuity when lengths up to `length` and angles up to `angle` (radians) count as none.
    #[must_use]
    pub fn continuity(&self, length: f64, angle: f64) -> Continuity {
        match self {
            seam if seam.gap > length => Continuity::Gap,
            seam if seam.derivative_difference <= length => Continuity::C1,
            seam if seam.tangent_angle <= angle => Continuity::G1,
            _ => Continuity::C0,
        }
    }

    /// Both patches have the seam at v = 0, in the same direction of u.
    fn measure(a: &BicubicPatch, b: &BicubicPatch) -> Self {
        let mut seam = Self { gap: 0.0, tangent_angle: 0.0, derivative_difference: 0.0, normal_angle: 0.0 };
        for i in 0..4 {
            let (a0, b0) = (a.points[0][i], b.points[0][i]);
            let (leaving_a, leaving_b) = (a.points[1][i] - a0, b.points[1][i] - b0);
            seam.gap = seam.gap.max((a0 - b0).length());
            seam.tangent_angle = seam.tangent_angle.max(angle_between(-leaving_a, leaving_b));
            seam.derivative_difference =
                seam.derivative_difference.max(3.0 * (leaving_a + leaving_b).length());
        }
        for k in 0..=8 {
            let u = f64::from(k) / 8.0;
            // Seen from the seam the two patches lie on opposite sides, so their normals do too.
            if let (Some(a), Some(b)) = (a.normal(u, 0.0), b.normal(u, 0.0)) {
                seam.normal_angle = seam.normal_angle.max(angle_between(a, -b));
            }
        }
        seam
    }
}

/// 0 where one of the vectors is zero: a collapsed row has no tangent to disagree.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    match (unit(a), unit(b)) {
        (Some(a), Some(b)) => a.cross(b).length().atan2(a.dot(b)),
        _ => 0.0,
    }
}

impl BicubicPatch {
    /// The control points of an edge, in the direction of growing u or v.
    #[must_use]
    pub fn edge(&self, edge: PatchEdge) -> [DVec3; 4] {
        self.facing(edge).points[0]
    }

    /// The control points with this edge as row 0 and the rest behind it.
    fn facing(&self, edge: PatchEdge) -> Self {
        let mut patch =
            if matches!(edge, PatchEdge::UMin | PatchEdge::UMax) { self.transposed() } else { *self };
        if matches!(edge, PatchEdge::UMax | PatchEdge::VMax) {
            patch.points.reverse();
        }
        patch
    }

    fn reversed_along_seam(mut self) -> Self {
        self.points.iter_mut().for_each(|row| row.reverse());
        self
    }
}
