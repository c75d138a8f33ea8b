//! Rational B-spline surfaces, and their Bézier patches.

use glam::{DVec3, DVec4};

use super::{KnotVector, NurbsError, homogeneous_points};
use crate::Aabb;
use crate::bezier::{BicubicPatch, SurfacePoint, bernstein, surface_normal};

/// A rational B-spline surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    u: KnotVector,
    v: KnotVector,
    points: Vec<DVec4>,
}

/// A rational Bézier patch of any degrees: one piece of a [`NurbsSurface`].
#[derive(Clone, Debug, PartialEq)]
pub struct RationalPatch {
    /// Parameters u of the whole surface at the patch's ends.
    pub interval_u: [f64; 2],
    /// Parameters v of the whole surface at the patch's ends.
    pub interval_v: [f64; 2],
    /// Degree along u.
    pub degree_u: usize,
    /// Homogeneous control points, u being the fast index, degree + 1 along each direction.
    pub points: Vec<DVec4>,
}

impl NurbsSurface {
    /// A surface from its knots along u and v, its control points with u as the fast index, and their
    /// weights; without weights all are 1.
    ///
    /// # Errors
    /// A count of points or weights that does not fit the knots, a point that is not finite, a weight
    /// that is not positive.
    pub fn new(
        u: KnotVector,
        v: KnotVector,
        points: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, NurbsError> {
        let expected = u.point_count() * v.point_count();
        if points.len() != expected {
            return Err(NurbsError::PointCount { expected, found: points.len() });
        }
        let points = homogeneous_points(points, weights)?;
        Ok(Self { u, v, points })
    }

    /// The knots along u.
    #[must_use]
    pub fn knots_u(&self) -> &KnotVector {
        &self.u
    }

    /// The knots along v.
    #[must_use]
    pub fn knots_v(&self) -> &KnotVector {
        &self.v
    }

    /// The homogeneous control points, u being the fast index.
    #[must_use]
    pub fn points(&self) -> &[DVec4] {
        &self.points
    }

    /// The point at `(u, v)`; parameters are clamped to the domain.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        self.evaluate(u, v).position
    }

    /// Position and derivatives at `(u, v)`; parameters are clamped to the domain.
    #[must_use]
    pub fn evaluate(&self, u: f64, v: f64) -> SurfacePoint {
        let (bu, bv) = (self.u.basis(u), self.v.basis(v));
        let width = self.u.point_count();
        let blend = |along_u: &[f64], along_v: &[f64]| -> DVec4 {
            let row = |j: usize| super::sum(along_u, &self.points[(bv.first + j) * width + bu.first..]);
            along_v.iter().enumerate().map(|(j, weight)| *weight * row(j)).sum()
        };
        rational_point(
            blend(bu.values(), bv.values()),
            blend(bu.derivatives(), bv.values()),
            blend(bu.values(), bv.derivatives()),
            blend(bu.derivatives(), bv.derivatives()),
        )
    }

    /// Unit normal at `(u, v)`, on the side from which u, v run counter-clockwise; `None` where the
    /// surface is a point or a curve. Collapsed edges give the limit from within.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        let ([u0, u1], [v0, v1]) = (self.u.domain(), self.v.domain());
        let (us, vs) = (u1 - u0, v1 - v0);
        surface_normal((u - u0) / us, (v - v0) / vs, self.bounds().diagonal(), |u, v| {
            let p = self.evaluate(u0 + u * us, v0 + v * vs);
            SurfacePoint { du: p.du * us, dv: p.dv * vs, duv: p.duv * (us * vs), ..p }
        })
    }

    /// A box around the control points, and so around the surface, though not the smallest.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        hull(&self.points)
    }

    /// The surface as rational Bézier patches, u being the fast index.
    #[must_use]
    pub fn bezier_patches(&self) -> Vec<RationalPatch> {
        let rows = self.points.chunks(self.u.point_count());
        // Every row of points into its pieces along u, then every column of a piece along v.
        let rows: Vec<_> = rows.map(|row| self.u.bezier_pieces(row)).collect();
        let pieces_u = rows.first().map_or(0, Vec::len);
        let columns: Vec<_> = (0..pieces_u)
            .map(|piece| {
                let column = |i: usize| rows.iter().map(|row| row[piece].points[i]).collect::<Vec<_>>();
                (0..=self.u.degree()).map(|i| self.v.bezier_pieces(&column(i))).collect::<Vec<_>>()
            })
            .collect();
        let pieces_v = columns.first().and_then(|c| c.first()).map_or(0, Vec::len);
        let all = (0..pieces_v).flat_map(|piece_v| (0..pieces_u).map(move |piece_u| (piece_u, piece_v)));
        all.map(|(piece_u, piece_v)| {
            let columns = &columns[piece_u];
            let point = |k: usize| columns[k % columns.len()][piece_v].points[k / columns.len()];
            RationalPatch {
                interval_u: rows[0][piece_u].interval,
                interval_v: columns[0][piece_v].interval,
                degree_u: self.u.degree(),
                points: (0..columns.len() * (self.v.degree() + 1)).map(point).collect(),
            }
        })
        .collect()
    }
}

impl RationalPatch {
    /// Degree along v.
    #[must_use]
    pub fn degree_v(&self) -> usize {
        (self.points.len() / (self.degree_u + 1)).max(1) - 1
    }

    /// The point at `(u, v)`, each from 0 to 1 over this patch.
    #[must_use]
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        let (bu, bv) = (bernstein(self.degree_u, u), bernstein(self.degree_v(), v));
        let rows = self.points.chunks(self.degree_u + 1);
        let h: DVec4 = rows.zip(&bv).map(|(row, weight)| *weight * super::sum(&bu, row)).sum();
        h.truncate() / h.w
    }

    /// A box around the control points, and so around the patch, though not the smallest.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        hull(&self.points)
    }

    /// The patch as a bicubic one: `None` when its weights differ or a degree is above 3. Lower
    /// degrees are raised, which keeps the shape.
    #[must_use]
    pub fn to_bicubic(&self) -> Option<BicubicPatch> {
        let w = self.points.first()?.w;
        let polynomial = self.points.iter().all(|p| (p.w - w).abs() <= 1e-12 * w);
        if !polynomial || self.degree_u > 3 || self.degree_v() > 3 {
            return None;
        }
        let points: Vec<DVec3> = self.points.iter().map(|p| p.truncate() / p.w).collect();
        let rows: Vec<[DVec3; 4]> = points.chunks(self.degree_u + 1).map(raised_to_cubic).collect();
        let columns: [[DVec3; 4]; 4] =
            std::array::from_fn(|i| raised_to_cubic(&rows.iter().map(|row| row[i]).collect::<Vec<_>>()));
        Some(BicubicPatch { points: columns }.transposed())
    }
}

/// The four control points of the cubic that a curve of lower degree is. Needs one to four points.
fn raised_to_cubic(points: &[DVec3]) -> [DVec3; 4] {
    let mut work = points.to_vec();
    while work.len() < 4 {
        let n = work.len() as f64;
        let between = |i: usize| work[i - 1].lerp(work[i], 1.0 - i as f64 / n);
        let inner: Vec<DVec3> = (1..work.len()).map(between).collect();
        work = [&work[..1], &inner, &work[work.len() - 1..]].concat();
    }
    std::array::from_fn(|i| work[i])
}

fn hull(points: &[DVec4]) -> Aabb {
    Aabb::of_points(points.iter().map(|p| p.truncate() / p.w))
}

/// Derivatives of the quotient from those of the homogeneous sums.
fn rational_point(h: DVec4, hu: DVec4, hv: DVec4, huv: DVec4) -> SurfacePoint {
    let position = h.truncate() / h.w;
    let du = (hu.truncate() - position * hu.w) / h.w;
    let dv = (hv.truncate() - position * hv.w) / h.w;
    let duv = (huv.truncate() - du * hv.w - dv * hu.w - position * huv.w) / h.w;
    SurfacePoint { position, du, dv, duv }
}
