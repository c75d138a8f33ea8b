//! Exercise 6: Bézier curves of any degree by both forms, and an eye that moves along one.

use super::LabError;
use super::input::Input;
use super::solid::{Solid, value};
use super::vectors::{Row3, add, scale, subtract};

/// Steps that the curve is drawn with: t = i / 100. Adding up 0.01 instead loses the last point,
/// because the sum of a hundred rounded hundredths is greater than 1.
pub const STEPS: usize = 100;

/// Most control points that the exercise accepts.
pub const MAX_POINTS: usize = 1_000_000;

/// The parameters that the curve is drawn at.
pub fn parameters() -> impl Iterator<Item = f64> {
    (0..=STEPS).map(|i| i as f64 / STEPS as f64)
}

/// Reads the control points, three numbers each.
///
/// # Errors
/// There is none, too many, or something else than numbers.
pub fn read_control_points(input: &mut Input) -> Result<Vec<Row3>, LabError> {
    let mut points = Vec::new();
    while points.is_empty() || input.left() > 0 {
        if points.len() == MAX_POINTS {
            return Err(input.wrong(format!("there are more than {MAX_POINTS} control points")));
        }
        let point: Row3 = input.numbers(&format!("control point {}", points.len()))?;
        if point.iter().any(|v| v.abs() > 1e12) {
            return Err(input.wrong("a coordinate of a control point is greater than 1e12"));
        }
        points.push(point);
    }
    Ok(points)
}

/// Bernstein's weight i of degree n, with factorials as written (5). They are finite up to n = 170.
#[must_use]
pub fn bernstein_by_factorials(i: usize, n: usize, t: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let binomial = factorial(n) / (factorial(i) * factorial(n - i));
    binomial * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32)
}

/// All of Bernstein's weights of degree n at t in [0, 1], for any n.
///
/// Neighbours have the ratio (n-i)/(i+1) t/(1-t). The largest weight is set to 1, the others follow
/// from it, and all are divided by their sum: nothing overflows, and nothing that matters vanishes.
#[must_use]
pub fn bernstein_weights(n: usize, t: f64) -> Vec<f64> {
    let mut weights = vec![0.0; n + 1];
    if t <= 0.0 || t >= 1.0 {
        weights[if t <= 0.0 { 0 } else { n }] = 1.0;
        return weights;
    }
    let largest = (((n + 1) as f64 * t) as usize).min(n);
    weights[largest] = 1.0;
    for i in largest..n {
        weights[i + 1] = weights[i] * (n - i) as f64 * t / ((i + 1) as f64 * (1.0 - t));
    }
    for i in (0..largest).rev() {
        weights[i] = weights[i + 1] * (i + 1) as f64 * (1.0 - t) / ((n - i) as f64 * t);
    }
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    weights
}

/// Bézier's weights of the edges of the open control polygon, for any n: each is the sum of Bernstein's
/// weights from it on.
#[must_use]
pub fn bezier_weights(n: usize, t: f64) -> Vec<f64> {
    let mut weights = bernstein_weights(n, t);
    for i in (0..n).rev() {
        weights[i] += weights[i + 1];
    }
    // The sum of all.
    weights[0] = 1.0;
    weights
}

/// Bézier's weights by their recursion (3), with f(-1, k) = 1.
#[must_use]
pub fn bezier_weights_by_recursion(n: usize, t: f64) -> Vec<f64> {
    let mut weights = vec![1.0];
    for degree in 1..=n {
        let before = |i: usize| weights.get(i).copied().unwrap_or(0.0);
        let next = |i: usize| {
            let left = if i == 0 { 1.0 } else { before(i - 1) };
            (1.0 - t) * before(i) + t * left
        };
        weights = (0..=degree).map(next).collect();
    }
    weights
}

/// Bézier's weight i of degree n by its derivative (2), for i from 1 to n and small n.
///
/// Phi_n = (1 - (1-t)^n) / (-t) is the polynomial -sum C(n,k) (-t)^(k-1), so 0/0 does not occur.
#[must_use]
pub fn bezier_weight_by_derivative(i: usize, n: usize, t: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let binomial = |k: usize| factorial(n) / (factorial(k) * factorial(n - k));
    let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    // Coefficients of Phi, from t^0.
    let mut phi: Vec<f64> = (1..=n).map(|k| -binomial(k) * sign(k - 1)).collect();
    for _ in 1..i {
        phi = (1..phi.len()).map(|k| phi[k] * k as f64).collect();
    }
    let derivative = phi.iter().rev().fold(0.0, |sum, c| sum * t + c);
    (-t).powi(i as i32) / factorial(i - 1) * derivative
}

/// The curve's point at t by Bernstein's weights of the control points (4); the origin without points.
#[must_use]
pub fn point_by_bernstein(points: &[Row3], t: f64) -> Row3 {
    let Some(n) = points.len().checked_sub(1) else { return [0.0; 3] };
    weighted(points.iter().copied(), &bernstein_weights(n, t))
}

/// The curve's point at t by Bézier's weights of the vectors of the control polygon (1).
#[must_use]
pub fn point_by_bezier(points: &[Row3], t: f64) -> Row3 {
    let Some(n) = points.len().checked_sub(1) else { return [0.0; 3] };
    let first = points.iter().copied().take(1);
    let edges = points.windows(2).map(|pair| subtract(pair[1], pair[0]));
    weighted(first.chain(edges), &bezier_weights(n, t))
}

/// The curve's point at t by de Casteljau's repeated division, which needs no weights.
#[must_use]
pub fn point_by_de_casteljau(points: &[Row3], t: f64) -> Row3 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|p| add(scale(p[0], 1.0 - t), scale(p[1], t))).collect();
    }
    points.first().copied().unwrap_or([0.0; 3])
}

fn weighted(vectors: impl Iterator<Item = Row3>, weights: &[f64]) -> Row3 {
    vectors.zip(weights).fold([0.0; 3], |sum, (v, &w)| add(sum, scale(v, w)))
}

/// Points of the curve at all [`parameters`], by Bernstein's form.
#[must_use]
pub fn curve(points: &[Row3]) -> Vec<Row3> {
    parameters().map(|t| point_by_bernstein(points, t)).collect()
}

/// The faces of a solid that an eye sees from their front, from 0. A face in whose plane the eye lies
/// counts as not seen.
#[must_use]
pub fn visible_faces(solid: &Solid, eye: Row3) -> Vec<usize> {
    let planes = solid.planes();
    (0..planes.len()).filter(|&i| value(planes[i], eye) > 0.0).collect()
}

#[cfg(test)]
mod tests;
