//! Roots along a ray from the coefficients of a polynomial.

use senca_math::Expression;
use senca_math::roots::bernstein::MAX_COEFFICIENTS;
use senca_math::roots::{
    bernstein_from_power, bernstein_roots, bernstein_roots_of_any, restrict_to, roots_closed_form,
    sturm_roots,
};

use super::RootMethod;
use crate::Ray;

/// Calls `found` with the parameters between two limits at which the formula changes its sign, ascending;
/// tells whether it is negative at the first.
///
/// The line is taken from the middle between the limits, in half their distance, so that the polynomial
/// is wanted on [-1, 1], where its coefficients say most.
pub(super) fn each_root(
    expression: &Expression,
    method: RootMethod,
    ray: &Ray,
    [start, end]: [f64; 2],
    found: &mut impl FnMut(f64),
) -> bool {
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let Some(polynomial) = expression.along_ray(ray.at(middle), half * ray.direction) else { return false };
    let power = polynomial.coefficients();
    let mut place = |s: f64| found((middle + half * s).clamp(start, end));
    match (method, power.len()) {
        (RootMethod::Sturm, _) => {
            sturm_roots(power, -1.0, 1.0).into_iter().for_each(place);
            polynomial.value(-1.0) < 0.0
        }
        (RootMethod::ClosedForm, 0..=5) => by_closed_form(power, |s| polynomial.value(s), &mut place),
        (_, 0..=3) => by_descartes::<3>(power, &mut place),
        (_, 4..=5) => by_descartes::<5>(power, &mut place),
        _ => {
            let mut form = [0.0; MAX_COEFFICIENTS];
            let form = &mut form[..power.len().min(MAX_COEFFICIENTS)];
            to_form(power, form);
            bernstein_roots_of_any(form, &mut |s| place(2.0 * s - 1.0));
            form[0] < 0.0
        }
    }
}

/// Bernstein coefficients over [-1, 1] from power coefficients, of which there may be fewer.
fn to_form(power: &[f64], form: &mut [f64]) {
    form.iter_mut().zip(power).for_each(|(to, from)| *to = *from);
    restrict_to(form, -1.0, 1.0);
    bernstein_from_power(form);
}

fn by_descartes<const N: usize>(power: &[f64], found: &mut impl FnMut(f64)) -> bool {
    let mut form = [0.0; N];
    to_form(power, &mut form);
    bernstein_roots(&form, &mut |s| found(2.0 * s - 1.0));
    form[0] < 0.0
}

/// Roots by formula; those at which the sign does not change from one side to the other are left out.
fn by_closed_form(power: &[f64], value: impl Fn(f64) -> f64, found: &mut impl FnMut(f64)) -> bool {
    let mut highest_first = [0.0; 5];
    highest_first[5 - power.len()..].iter_mut().zip(power.iter().rev()).for_each(|(to, from)| *to = *from);
    let roots = roots_closed_form(&highest_first).unwrap_or_default();
    let inside: Vec<f64> = roots.iter().copied().filter(|s| s.abs() < 1.0).collect();
    let negative_before = |i: usize| {
        let low = if i == 0 { -1.0 } else { inside[i - 1] };
        let high = inside.get(i).copied().unwrap_or(1.0);
        value(0.5 * (low + high)) < 0.0
    };
    for (i, &root) in inside.iter().enumerate() {
        if negative_before(i) != negative_before(i + 1) {
            found(root);
        }
    }
    negative_before(0)
}
