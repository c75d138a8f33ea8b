//! Bicubic Bézier patches.

use glam::{DMat4, DVec3, DVec4};

use super::{
    BEZIER_MATRIX, CubicCurve, bernstein_cubic, bernstein_cubic_derivative, second_differences, steps_for,
    weighted,
};
use crate::Aabb;
use crate::frame::unit;

/// A bicubic Bézier patch: 4 x 4 control points, `points[j][i]` with i along u and j along v.
///
/// In files that list sixteen points the first four are `points[0]`: u is the fast index. Its normal
/// points to the side from which u, v run counter-clockwise. Source: 1991 thesis, section 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BicubicPatch {
    /// The control points, `points[j][i]` with i along u and j along v.
    pub points: [[DVec3; 4]; 4],
}

/// Position and derivatives at one place of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position.
    pub position: DVec3,
    /// Derivative along u.
    pub du: DVec3,
    /// Derivative along v.
    pub dv: DVec3,
    /// Mixed second derivative.
    pub duv: DVec3,
}

impl BicubicPatch {
    /// A patch from its sixteen points, u being the fast index.
    #[must_use]
    pub fn from_list(points: [DVec3; 16]) -> Self {
        Self { points: std::array::from_fn(|j| std::array::from_fn(|i| points[4 * j + i])) }
    }

    /// The point at `(u, v)`, by Bernstein weights.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        self.blend(bernstein_cubic(u), bernstein_cubic(v))
    }

    /// The point at `(u, v)`, by the matrix form `V B P B^T U^T`. The same up to rounding.
    #[must_use]
    pub fn at_by_matrix(&self, u: f64, v: f64) -> DVec3 {
        let powers = |t: f64| DVec4::new(t * t * t, t * t, t, 1.0);
        let coordinate = |axis: usize| {
            // Column j holds this coordinate of the control points of row j.
            let p = DMat4::from_cols_array_2d(&self.points.map(|row| row.map(|point| point[axis])));
            let coefficients = BEZIER_MATRIX * p * BEZIER_MATRIX;
            powers(u).dot(coefficients * powers(v))
        };
        DVec3::new(coordinate(0), coordinate(1), coordinate(2))
    }

    /// Position and derivatives at `(u, v)`.
    #[must_use]
    pub fn evaluate(&self, u: f64, v: f64) -> SurfacePoint {
        let (bu, bv) = (bernstein_cubic(u), bernstein_cubic(v));
        let (du, dv) = (bernstein_cubic_derivative(u), bernstein_cubic_derivative(v));
        SurfacePoint {
            position: self.blend(bu, bv),
            du: self.blend(du, bv),
            dv: self.blend(bu, dv),
            duv: self.blend(du, dv),
        }
    }

    /// Unit normal at `(u, v)`; `None` where the surface is a point or a curve.
    ///
    /// Where a row or column of control points collapses, as in the tip of the teapot's lid, a first
    /// derivative vanishes; the normal is then the limit from within the patch.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        surface_normal(u, v, self.size(), |u, v| self.evaluate(u, v))
    }

    /// The curve of constant v.
    #[must_use]
    pub fn curve_along_u(&self, v: f64) -> CubicCurve {
        let weights = bernstein_cubic(v);
        CubicCurve { points: std::array::from_fn(|i| weighted(weights, self.points.map(|row| row[i]))) }
    }

    /// The curve of constant u.
    #[must_use]
    pub fn curve_along_v(&self, u: f64) -> CubicCurve {
        let weights = bernstein_cubic(u);
        CubicCurve { points: self.points.map(|row| weighted(weights, row)) }
    }

    /// The patches below and above `u`.
    #[must_use]
    pub fn split_u(&self, u: f64) -> (Self, Self) {
        let halves = self.points.map(|points| CubicCurve { points }.split(u));
        (
            Self { points: halves.map(|(below, _)| below.points) },
            Self { points: halves.map(|(_, above)| above.points) },
        )
    }

    /// The patches below and above `v`.
    #[must_use]
    pub fn split_v(&self, v: f64) -> (Self, Self) {
        let (below, above) = self.transposed().split_u(v);
        (below.transposed(), above.transposed())
    }

    /// The same surface with u and v exchanged, and so the normal reversed.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { points: std::array::from_fn(|j| std::array::from_fn(|i| self.points[i][j])) }
    }

    /// A box around the control points, and so around the patch, though not the smallest.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.points.into_iter().flatten())
    }

    /// How many equal steps of u and of v keep the chords of the parameter lines within `tolerance`,
    /// > 0, of the surface; each at least 1.
    #[must_use]
    pub fn steps_for(&self, tolerance: f64) -> [u32; 2] {
        let along = |patch: &Self| {
            let bend = patch.points.iter().map(second_differences).fold(0.0, f64::max);
            steps_for(bend, tolerance)
        };
        [along(self), along(&self.transposed())]
    }

    /// Every control point through an affine map.
    #[must_use]
    pub fn transformed(&self, target_from_source: &DMat4) -> Self {
        Self { points: self.points.map(|row| row.map(|p| target_from_source.transform_point3(p))) }
    }

    fn blend(&self, u: [f64; 4], v: [f64; 4]) -> DVec3 {
        weighted(v, self.points.map(|row| weighted(u, row)))
    }

    pub(super) fn size(&self) -> f64 {
        self.bounds().diagonal()
    }
}

/// Unit normal of a surface over [0, 1]^2 of about this size, with limits where derivatives vanish.
///
/// Where the u derivative vanishes along an edge of constant v, it grows like the mixed derivative
/// times the distance from that edge, so that takes its place, reversed at v = 1; likewise for v.
/// Where that is nothing either, the normal a little further inside is taken.
pub(crate) fn surface_normal(
    u: f64,
    v: f64,
    size: f64,
    evaluate: impl Fn(f64, f64) -> SurfacePoint,
) -> Option<DVec3> {
    let enough = |n: DVec3| if n.length() > 1e-10 * size * size { unit(n) } else { None };
    let p = evaluate(u, v);
    if let Some(normal) = enough(p.du.cross(p.dv)) {
        return Some(normal);
    }
    let inwards = |t: f64| if t < 0.5 { 1.0 } else { -1.0 };
    let vanishes = |d: DVec3| d.length() <= 1e-9 * size;
    let limit = match (vanishes(p.du), vanishes(p.dv)) {
        (true, false) => enough(inwards(v) * p.duv.cross(p.dv)),
        (false, true) => enough(inwards(u) * p.du.cross(p.duv)),
        _ => None,
    };
    limit.or_else(|| {
        [1e-4, 1e-3, 1e-2].into_iter().find_map(|step| {
            let p = evaluate(u + (0.5 - u) * step, v + (0.5 - v) * step);
            enough(p.du.cross(p.dv))
        })
    })
}
