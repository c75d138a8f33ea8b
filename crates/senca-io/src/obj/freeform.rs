//! Free-form surfaces: `cstype`, `deg`, `surf`, `parm`, `end`.
//!
//! Bicubic Bézier surfaces become patches, other Bézier surfaces and B-splines NURBS. Curves and trims
//! are passed over with a warning, and so are the bases `bmatrix`, `cardinal` and `taylor`.

use senca_scene::math::glam::DVec3;
use senca_scene::{BezierPatch, NurbsSurface, Shape};

use super::parse::{Soup, SurfaceKey};

/// Highest degree that is taken.
const HIGHEST_DEGREE: usize = 32;

/// Basis functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Basis {
    Bezier,
    BSpline,
    #[default]
    Other,
}

/// A surface in the making.
#[derive(Clone, Debug, Default)]
pub(super) struct Freeform {
    pub(super) basis: Basis,
    pub(super) rational: bool,
    pub(super) degree: [usize; 2],
    /// Ends of the parameter range, u then v.
    pub(super) range: [f64; 4],
    /// Indices of the control points, u fastest, and where the statement stands.
    pub(super) control: Vec<u32>,
    pub(super) pos: usize,
    /// Values of the statements `parm u` and `parm v`.
    pub(super) parameters: [Vec<f64>; 2],
}

/// A finished surface with what it belongs to.
#[derive(Clone, Debug)]
pub(super) struct FreeformSurface {
    pub(super) shape: Shape,
    pub(super) key: SurfaceKey,
    pub(super) name: String,
}

impl Freeform {
    /// The shape, or what is wrong with it.
    pub(super) fn shape(&self, soup: &Soup) -> Result<Shape, String> {
        let counts = [self.count(0)?, self.count(1)?];
        if counts[0].checked_mul(counts[1]) != Some(self.control.len()) {
            let there = self.control.len();
            return Err(format!("expected {} x {} control points, found {there}", counts[0], counts[1]));
        }
        let place = |&index: &u32| soup.points.get(index as usize).map(|point| point.as_dvec3());
        let points: Option<Vec<DVec3>> = self.control.iter().map(place).collect();
        let points = points.ok_or("control points must stand before the surface")?;
        if self.basis == Basis::Bezier && !self.rational && self.degree == [3, 3] {
            return Ok(Shape::BezierPatches { patches: patches(&points, counts) });
        }
        let weight = |&index: &u32| f64::from(soup.weights.get(index as usize).copied().unwrap_or(1.0));
        let weights: Vec<f64> =
            if self.rational { self.control.iter().map(weight).collect() } else { Vec::new() };
        if weights.iter().any(|&weight| weight <= 0.0) {
            return Err("weights must be positive".to_owned());
        }
        let knots = [self.knots(0), self.knots(1)];
        Ok(Shape::Nurbs(NurbsSurface { degree: self.degree, knots, counts, points, weights }))
    }

    /// Whether the surface asks for a part of its parameter range only.
    pub(super) fn is_cut(&self) -> bool {
        let ends = |d: usize| {
            let skip = if self.basis == Basis::BSpline { self.degree[d] } else { 0 };
            let all = &self.parameters[d];
            [all.get(skip).copied(), all.len().checked_sub(skip + 1).and_then(|last| all.get(last).copied())]
        };
        let [u, v] = [ends(0), ends(1)];
        let [s0, s1, t0, t1] = self.range.map(Some);
        u != [s0, s1] || v != [t0, t1]
    }

    /// Control points along direction `d`.
    fn count(&self, d: usize) -> Result<usize, String> {
        let (degree, parameters) = (self.degree[d], &self.parameters[d]);
        let direction = ["u", "v"][d];
        if degree == 0 || degree > HIGHEST_DEGREE {
            return Err(format!("the degree in {direction} must be 1 to {HIGHEST_DEGREE}, not {degree}"));
        }
        if parameters.windows(2).any(|pair| pair[1] < pair[0]) {
            return Err(format!("the parameters in {direction} must not decrease"));
        }
        let least = if self.basis == Basis::BSpline { 2 * degree + 2 } else { 2 };
        if parameters.len() < least {
            return Err(format!(
                "at least {least} parameters in {direction} are needed, found {}",
                parameters.len()
            ));
        }
        Ok(match self.basis {
            Basis::BSpline => parameters.len() - degree - 1,
            _ => degree * (parameters.len() - 1) + 1,
        })
    }

    /// Knots along direction `d`; those of Bézier pieces are repeated, so that the pieces stay apart.
    fn knots(&self, d: usize) -> Vec<f64> {
        let (degree, parameters) = (self.degree[d], &self.parameters[d]);
        if self.basis == Basis::BSpline {
            return parameters.clone();
        }
        let mut knots: Vec<f64> =
            parameters.iter().flat_map(|&knot| std::iter::repeat_n(knot, degree)).collect();
        knots.insert(0, parameters[0]);
        knots.push(parameters[parameters.len() - 1]);
        knots
    }
}

/// The patches of a grid of `counts` points.
fn patches(points: &[DVec3], counts: [usize; 2]) -> Vec<BezierPatch> {
    let [across, along] = counts.map(|count| (count - 1) / 3);
    let cell = |v: usize| (0..across).map(move |u| (3 * u, 3 * v));
    let patch = |(u, v): (usize, usize)| BezierPatch {
        points: std::array::from_fn(|i| points[(v + i / 4) * counts[0] + u + i % 4]),
        surface: 0,
    };
    (0..along).flat_map(cell).map(patch).collect()
}
