//! Implicit surfaces f(x, y, z) = 0.
//!
//! A ray is put into the formula, and the roots of f along it are found by one of [`RootMethod`]'s
//! methods: those of polynomials by their coefficients, those of any other formula by interval
//! arithmetic. The normal is the gradient (course text, section 3.2).
//!
//! The body is where f < 0, within a box. A surface that reaches out of the box is either closed by the
//! box's sides or open there.

mod interval;
mod polynomial;

use senca_math::glam::{DVec2, DVec3};
use senca_math::{Aabb, Expression};
use senca_scene::ShapeError;

use super::analytic::{Analytic, Chart};
use super::cuboid::{box_ends, side_frame};
use super::sphere::globe_chart;
use crate::{Crossing, Ray, SurfacePoint};
use interval::IntervalRoots;

/// Highest degree for which roots are found from coefficients unless something else is asked for.
/// Beyond, rounding in the coefficients moves the roots by more than intervals would.
const AUTOMATIC_DEGREE: u32 = 12;

/// Part of a crossing on the surface itself; the sides of the box follow, in the order of
/// [`super::Cuboid`].
const SURFACE: u32 = 0;

/// How the roots of a formula along a ray are found.
///
/// Where the method asked for cannot be used (coefficients of what is no polynomial, closed formulas
/// above degree four) the automatic choice is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RootMethod {
    /// [`RootMethod::Descartes`] for polynomials up to degree 12, [`RootMethod::Interval`] else.
    #[default]
    Automatic,
    /// The textbook's formulas up to degree four: Cardano's and Ferrari's.
    ClosedForm,
    /// Descartes' rule of signs on Bernstein coefficients; degree up to 32.
    Descartes,
    /// Sturm's sequence; degree up to 32.
    Sturm,
    /// Interval arithmetic and interval Newton: any formula. No root is missed but pairs nearer than
    /// 10^-10 of the ray's way through the box.
    Interval,
}

/// The surface f(x, y, z) = 0 in a box, the body being where f < 0.
#[derive(Clone, Debug)]
pub struct Implicit {
    expression: Expression,
    bounds: Aabb,
    capped: bool,
    method: RootMethod,
}

/// Where a ray is in the box, and the sides through which it comes and goes: `None` where its own
/// limits end it.
struct Stretch {
    start: f64,
    end: f64,
    sides: [Option<u32>; 2],
}

impl Implicit {
    /// The surface of a formula within `bounds`. `capped`: where the box cuts the body, parts of its
    /// sides close it; else the surface ends there.
    ///
    /// # Errors
    /// [`ShapeError::Malformed`] when the box is empty or not finite.
    pub fn new(expression: Expression, bounds: Aabb, capped: bool) -> Result<Self, ShapeError> {
        let finite = bounds.min.is_finite() && bounds.max.is_finite();
        if !finite || !bounds.min.cmplt(bounds.max).all() {
            return super::build::malformed(
                "implicit",
                "its box needs finite corners, the first below the second",
            );
        }
        Ok(Self { expression, bounds, capped, method: RootMethod::Automatic })
    }

    /// The same surface met by another method.
    #[must_use]
    pub fn with_method(self, method: RootMethod) -> Self {
        Self { method, ..self }
    }

    /// The method that is used for this formula.
    #[must_use]
    pub fn method(&self) -> RootMethod {
        let (method, degree) = (self.method, self.expression.degree());
        let fits = match method {
            RootMethod::Automatic => false,
            RootMethod::ClosedForm => degree.is_some_and(|degree| degree <= 4),
            RootMethod::Descartes | RootMethod::Sturm => degree.is_some(),
            RootMethod::Interval => true,
        };
        match degree {
            _ if fits => method,
            Some(..=AUTOMATIC_DEGREE) => RootMethod::Descartes,
            _ => RootMethod::Interval,
        }
    }

    /// The part of the ray inside the box and between its limits.
    fn stretch(&self, ray: &Ray) -> Option<Stretch> {
        let [(enter, first), (leave, last)] = box_ends(self.bounds.min, self.bounds.max, ray)?;
        let stretch = Stretch {
            start: enter.max(ray.t_min),
            end: leave.min(ray.t_max),
            sides: [(enter > ray.t_min).then_some(1 + first), (leave < ray.t_max).then_some(1 + last)],
        };
        (stretch.start < stretch.end).then_some(stretch)
    }

    /// Calls `found` with all roots of a stretch, ascending; tells whether its start is inside.
    fn each_root(&self, ray: &Ray, stretch: &Stretch, found: &mut impl FnMut(f64)) -> bool {
        let (start, end) = (stretch.start, stretch.end);
        match self.method() {
            RootMethod::Interval | RootMethod::Automatic => {
                let roots = IntervalRoots::new(&self.expression, ray, start, end);
                let inside = roots.is_inside(start);
                roots.for_each(found);
                inside
            }
            method => polynomial::each_root(&self.expression, method, ray, [start, end], found),
        }
    }

    /// A point of the surface near `near`, and the unit normal there.
    fn on_surface(&self, near: DVec3, ray: &Ray) -> (DVec3, DVec3) {
        let step = |p: DVec3| {
            let (value, gradient) = self.expression.value_and_gradient(p);
            let step = value / gradient.length_squared() * gradient;
            (gradient, if step.is_finite() { step } else { DVec3::ZERO })
        };
        let (_, first) = step(near);
        let small = first.length() < 1e-8 * self.bounds.diagonal();
        let point = if small { near - first } else { near };
        let against = || -ray.direction.normalize_or(DVec3::Y);
        let normal = step(point).0.try_normalize().or_else(|| self.gradient_around(point));
        (point, normal.unwrap_or_else(against))
    }

    /// Direction of the gradient where it vanishes or has no value, as at the tip of a cone: its mean
    /// around the place.
    fn gradient_around(&self, point: DVec3) -> Option<DVec3> {
        let reach = 1e-5 * self.bounds.diagonal();
        let gradients = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).map(|axis| {
            let gradient = self.expression.value_and_gradient(point + reach * axis).1;
            if gradient.is_finite() { gradient } else { DVec3::ZERO }
        });
        let sum: DVec3 = gradients.sum();
        (sum.length() > 0.0).then(|| sum.try_normalize()).flatten()
    }

    /// The picture around the middle of the box, as a sphere there shows it.
    fn chart(&self, point: DVec3, normal: DVec3) -> Chart {
        let from_center = point - self.bounds.center();
        let chart = globe_chart(from_center.normalize_or(DVec3::Y), DVec3::splat(from_center.length()));
        // Along the surface instead of the sphere: what of the direction the surface does not have goes
        // towards the middle.
        let on_surface = |along: DVec3| {
            let slide = along - from_center * (normal.dot(along) / normal.dot(from_center));
            if slide.is_finite() { slide } else { along }
        };
        Chart { along_u: on_surface(chart.along_u), along_v: on_surface(chart.along_v), ..chart }
    }
}

impl Analytic for Implicit {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let Some(stretch) = self.stretch(ray) else { return };
        let mut count = 0;
        let inside = self.each_root(ray, &stretch, &mut |t| {
            count += 1;
            meet(t, SURFACE, DVec2::ZERO);
        });
        if !self.capped {
            return;
        }
        let ends = [(stretch.start, inside), (stretch.end, inside != (count % 2 == 1))];
        for ((t, inside), side) in ends.into_iter().zip(stretch.sides) {
            if let Some(side) = side.filter(|_| inside) {
                meet(t, side, DVec2::ZERO);
            }
        }
    }

    /// Roots by intervals come one by one: the first is enough.
    fn nearest(&self, ray: &Ray) -> Option<Crossing> {
        if self.method() != RootMethod::Interval {
            return super::analytic::nearest_of_all(self, ray);
        }
        let stretch = self.stretch(ray)?;
        let crossing = |t: f64, part: u32| Crossing { t, part, uv: DVec2::ZERO };
        let roots = IntervalRoots::new(&self.expression, ray, stretch.start, stretch.end);
        let mut inside = self.capped && roots.is_inside(stretch.start);
        if let (true, Some(side)) = (inside, stretch.sides[0]) {
            return Some(crossing(stretch.start, side));
        }
        for t in roots {
            if ray.admits(t) {
                return Some(crossing(t, SURFACE));
            }
            inside = self.capped && !inside;
        }
        stretch.sides[1].filter(|_| inside).map(|side| crossing(stretch.end, side))
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let near = ray.at(crossing.t).clamp(self.bounds.min, self.bounds.max);
        let (point, normal) = match crossing.part {
            SURFACE => self.on_surface(near, ray),
            side => (near, side_frame(side - 1).0),
        };
        self.chart(point, normal).at(point, normal, 0)
    }

    fn is_closed(&self) -> bool {
        self.capped
    }
}

#[cfg(test)]
mod tests;
