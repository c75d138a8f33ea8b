//! Control nets of tensor-product Bézier surfaces of any degrees.

use senca_math::bezier::ControlPoint;
use smallvec::SmallVec;

/// Control points of a surface over [0, 1]^2, u being the fast index. Both degrees are at least 1.
#[derive(Clone, Debug)]
pub(super) struct Net<T> {
    /// Points along u: the degree in u + 1.
    width: usize,
    points: SmallVec<[T; 16]>,
}

/// A direction of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    U,
    V,
}

/// Value and first derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet<T> {
    pub value: T,
    pub du: T,
    pub dv: T,
}

impl<T: ControlPoint> Net<T> {
    /// `width` points along u in each row.
    pub(super) fn new(width: usize, points: impl IntoIterator<Item = T>) -> Self {
        Self { width, points: points.into_iter().collect() }
    }

    /// Points along u and v.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.width, self.points.len() / self.width]
    }

    pub(super) fn points(&self) -> &[T] {
        &self.points
    }

    /// The same net of something else, made from each point alone.
    pub(super) fn map<U: ControlPoint>(&self, map: impl FnMut(&T) -> U) -> Net<U> {
        Net { width: self.width, points: self.points.iter().map(map).collect() }
    }

    /// Index of the first point of line `line` along `axis`, and the distance to the next in it.
    fn line(&self, axis: Axis, line: usize) -> (usize, usize) {
        match axis {
            Axis::U => (line * self.width, 1),
            Axis::V => (line, self.width),
        }
    }

    /// Number of lines along `axis`, and of points in each.
    fn lines(&self, axis: Axis) -> (usize, usize) {
        let [width, height] = self.size();
        if axis == Axis::U { (height, width) } else { (width, height) }
    }

    /// The part below `t`.
    pub(super) fn below(mut self, axis: Axis, t: f64) -> Self {
        let (lines, count) = self.lines(axis);
        for line in 0..lines {
            let (first, step) = self.line(axis, line);
            for round in 1..count {
                for i in (round..count).rev() {
                    let k = first + i * step;
                    self.points[k] = lerp(self.points[k - step], self.points[k], t);
                }
            }
        }
        self
    }

    /// The part above `t`.
    pub(super) fn above(mut self, axis: Axis, t: f64) -> Self {
        let (lines, count) = self.lines(axis);
        for line in 0..lines {
            let (first, step) = self.line(axis, line);
            for round in 1..count {
                for i in 0..count - round {
                    let k = first + i * step;
                    self.points[k] = lerp(self.points[k], self.points[k + step], t);
                }
            }
        }
        self
    }

    /// The part over `[low, high]`, 0 <= low < high <= 1.
    pub(super) fn restricted(self, axis: Axis, [low, high]: [f64; 2]) -> Self {
        let upper = if low > 0.0 { self.above(axis, low) } else { self };
        if high < 1.0 { upper.below(axis, (high - low) / (1.0 - low)) } else { upper }
    }

    /// The surface over `[low, high]`, which reach out of [0, 1] on both sides.
    pub(super) fn extended(self, axis: Axis, [low, high]: [f64; 2]) -> Self {
        self.below(axis, high).above(axis, low / high)
    }

    /// Control points of the derivative along `axis`.
    pub(super) fn derivative(&self, axis: Axis) -> impl Iterator<Item = T> + '_ {
        let (lines, count) = self.lines(axis);
        let degree = (count - 1) as f64;
        (0..lines).flat_map(move |line| {
            let (first, step) = self.line(axis, line);
            (0..count - 1).map(move |i| {
                let k = first + i * step;
                (self.points[k + step] + self.points[k] * -1.0) * degree
            })
        })
    }

    /// Largest second difference along an axis, measured by `length`, times degree (degree - 1): a
    /// bound on the second derivative.
    pub(super) fn bend(&self, axis: Axis, length: impl Fn(T) -> f64) -> f64 {
        let (lines, count) = self.lines(axis);
        let mut largest = 0.0f64;
        for line in 0..lines {
            let (first, step) = self.line(axis, line);
            for i in 0..count.saturating_sub(2) {
                let k = first + i * step;
                let second = self.points[k] + self.points[k + step] * -2.0 + self.points[k + 2 * step];
                largest = largest.max(length(second));
            }
        }
        largest * ((count - 1) * (count - 1).saturating_sub(1)) as f64
    }

    /// Value and derivatives at `(u, v)`, by de Casteljau's scheme.
    pub(super) fn at(&self, u: f64, v: f64) -> Jet<T> {
        let mut values: SmallVec<[T; 8]> = SmallVec::new();
        let mut slopes: SmallVec<[T; 8]> = SmallVec::new();
        for row in self.points.chunks_exact(self.width) {
            let (value, slope) = curve_at(row, u);
            values.push(value);
            slopes.push(slope);
        }
        let (value, dv) = curve_at(&values, v);
        Jet { value, du: curve_at(&slopes, v).0, dv }
    }
}

fn lerp<T: ControlPoint>(a: T, b: T, t: f64) -> T {
    a * (1.0 - t) + b * t
}

/// Value and derivative of a curve with at least two points.
fn curve_at<T: ControlPoint>(points: &[T], t: f64) -> (T, T) {
    let mut work: SmallVec<[T; 8]> = SmallVec::from_slice(points);
    for count in (2..points.len()).rev() {
        for i in 0..count {
            work[i] = lerp(work[i], work[i + 1], t);
        }
    }
    let slope = (work[1] + work[0] * -1.0) * (points.len() - 1) as f64;
    (lerp(work[0], work[1], t), slope)
}
