//! Moving, scaling and rotating points whose coordinates are integers.
//!
//! X is to the right, Y up, Z away from the viewer. Each transform may be read as moving the points or as moving space
//! the other way.
//!
//! The rotation exists for numbers of each kind by the same functions: [`Rotation<f32>`], `Rotation<Fixed<P>>`, and
//! [`Rotation<f64>`] as the reference. The floating-point one cuts its results towards zero; the fixed-point one shifts each
//! term and rounds it down. Points that are rotated over and over drift, so one rotates the original ones each time.
//!
//! Source: Savchenko 1995, chapter "3-D transformations".

use std::ops::{Add, Mul, Neg, Sub};

use super::angle::{Angle, Angles, Tables};
use super::fixed::{Fixed, saturate};

/// Adds `by` to each point (`T_translation`). Coordinates end at the largest integer.
pub fn translate(points: &mut [[i32; 3]], by: [i32; 3]) {
    for point in points {
        *point = std::array::from_fn(|k| point[k].saturating_add(by[k]));
    }
}

/// Multiplies each coordinate by the factor of its axis and cuts the product towards zero (`T_scaling`).
///
/// Factors between 0 and 1 make things smaller, those above larger; negative ones mirror, and 0 makes flat. A product
/// that has no place ends at the largest integer, and one that is not a number becomes 0.
pub fn scale(points: &mut [[i32; 3]], factors: [f64; 3]) {
    for point in points {
        *point = std::array::from_fn(|k| (f64::from(point[k]) * factors[k]) as i32);
    }
}

/// A number that a rotation is calculated with.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Neg<Output = T>> Number for T {}

/// A point turned in a plane, by the sine and cosine of the angle: the frame turns counter-clockwise, the point clockwise.
/// 4 multiplications.
pub fn rotate_in_plane<T: Number>([x, y]: [T; 2], sin: T, cos: T) -> [T; 2] {
    [y * sin + x * cos, y * cos - x * sin]
}

/// Sines and cosines of the three angles.
#[derive(Clone, Copy, Debug)]
pub struct SinCos<T> {
    /// Of the heading, `gam`.
    pub heading: [T; 2],
    /// Of the pitch, `bet`.
    pub pitch: [T; 2],
    /// Of the roll, `alp`.
    pub roll: [T; 2],
}

impl<T: Number> SinCos<T> {
    /// Looks up the angles.
    #[must_use]
    pub fn new(tables: &Tables<T>, angles: Angles) -> Self {
        let both = |a: Angle| [tables.sin(a), tables.cos(a)];
        Self { heading: both(angles.heading), pitch: both(angles.pitch), roll: both(angles.roll) }
    }

    /// Three planar rotations of a point, one after the other: 12 multiplications.
    #[must_use]
    pub fn rotate_by_planes(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        let [x, z] = rotate_in_plane([x, z], self.heading[0], self.heading[1]);
        // The pitch turns from Z to Y.
        let [z, y] = rotate_in_plane([z, y], self.pitch[0], self.pitch[1]);
        let [x, y] = rotate_in_plane([x, y], self.roll[0], self.roll[1]);
        [x, y, z]
    }

    /// The nine coefficients of all three rotations, a row for each coordinate of the result: 16 multiplications, and
    /// 9 for each point.
    #[must_use]
    pub fn coefficients(&self) -> [[T; 3]; 3] {
        let ([sg, cg], [sb, cb], [sa, ca]) = (self.heading, self.pitch, self.roll);
        [
            [sg * (sb * sa) + cg * ca, cb * sa, sg * ca - cg * (sb * sa)],
            [sg * (sb * ca) - cg * sa, cb * ca, -(cg * (sb * ca)) - sg * sa],
            [-(sg * cb), sb, cg * cb],
        ]
    }
}

/// A number whose rows multiply points of integers.
pub trait Coefficient: Number {
    /// The sum of the coordinates times a row, as an integer.
    fn row_times(row: [Self; 3], point: [i32; 3]) -> i32;
}

impl Coefficient for f32 {
    fn row_times(row: [Self; 3], [x, y, z]: [i32; 3]) -> i32 {
        (x as Self * row[0] + y as Self * row[1] + z as Self * row[2]) as i32
    }
}

impl Coefficient for f64 {
    /// Rounded to the nearest integer.
    fn row_times(row: [Self; 3], point: [i32; 3]) -> i32 {
        dot(row, point.map(Self::from)).round() as i32
    }
}

impl<const P: u32> Coefficient for Fixed<P> {
    fn row_times(row: [Self; 3], point: [i32; 3]) -> i32 {
        saturate((0..3).map(|k| i64::from(row[k].times_int(point[k]))).sum())
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A rotation by three angles (`T_mx1` to `T_mz3` of floating-point numbers, `T_wx1` to `T_wz3` of fixed-point ones).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<T> {
    /// A row for each coordinate of the result.
    pub rows: [[T; 3]; 3],
}

impl<T: Coefficient> Rotation<T> {
    /// By the angles (`T_set_rotation_gam_bet_alp`).
    #[must_use]
    pub fn new(tables: &Tables<T>, angles: Angles) -> Self {
        Self { rows: SinCos::new(tables, angles).coefficients() }
    }

    /// A point rotated.
    #[must_use]
    pub fn rotate_point(&self, point: [i32; 3]) -> [i32; 3] {
        self.rows.map(|row| T::row_times(row, point))
    }

    /// Rotates all points where they are (`T_rotation`).
    pub fn rotate(&self, points: &mut [[i32; 3]]) {
        points.iter_mut().for_each(|point| *point = self.rotate_point(*point));
    }
}

impl Rotation<f64> {
    /// A point rotated, not rounded.
    #[must_use]
    pub fn rotate_exact(&self, point: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| dot(row, point))
    }
}

#[cfg(test)]
#[path = "rotate_tests.rs"]
mod tests;
