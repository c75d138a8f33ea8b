//! Values of animation channels between their keys.
//!
//! Before the first key a channel has the first value, after the last the last. Cubic splines are
//! Hermite pieces with the tangents given at the keys, scaled by the length of the interval (glTF 2.0,
//! appendix C). Channels whose lists do not fit together give no value; [`crate::Scene::validate`]
//! reports them.

use senca_math::glam::{DMat3, DQuat, DVec3};
use senca_math::world_from_look_at;

use crate::{Animation, Channel, ChannelValues, Interpolation};

/// The value of a channel at one time.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValue {
    /// Translation in the parent's frame.
    Translation(DVec3),
    /// Unit quaternion.
    Rotation(DQuat),
    /// Scale per axis.
    Scale(DVec3),
    /// One weight per morph target.
    Weights(Vec<f32>),
    /// Place on a path, with the rotation that looks along it where that is wanted.
    Path {
        /// Translation in the parent's frame.
        translation: DVec3,
        /// Unit quaternion that turns -z along the path, +y as upright as it allows.
        rotation: Option<DQuat>,
    },
}

/// Interval between keys and the place in it.
#[derive(Clone, Copy)]
struct Place {
    key: usize,
    /// In [0, 1).
    t: f64,
    /// Length of the interval in seconds.
    length: f64,
}

/// What interpolation needs of a value.
trait Blend: Copy {
    fn scaled(self, factor: f64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn linear(self, other: Self, t: f64) -> Self {
        self.scaled(1.0 - t).plus(other.scaled(t))
    }
}

impl Blend for f64 {
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
}

impl Blend for f32 {
    fn scaled(self, factor: f64) -> Self {
        (f64::from(self) * factor) as f32
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
}

impl Blend for DVec3 {
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
}

impl Blend for DQuat {
    fn scaled(self, factor: f64) -> Self {
        self * factor
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
    /// Spherical, the short way around.
    fn linear(self, other: Self, t: f64) -> Self {
        unit(self).slerp(unit(other), t)
    }
}

/// Unit quaternion; the identity where there is no direction.
fn unit(q: DQuat) -> DQuat {
    let length = q.length();
    if length > 0.0 && length.is_finite() { q * (1.0 / length) } else { DQuat::IDENTITY }
}

impl Animation {
    /// Time of the last key of all channels, in seconds; 0 without any.
    #[must_use]
    pub fn duration(&self) -> f64 {
        let ends = self.channels.iter().filter_map(|c| c.times.last().copied());
        ends.filter(|t| t.is_finite()).fold(0.0, f64::max)
    }
}

impl Channel {
    /// The value at `seconds`; NaN counts as before the first key. `None` when the lists of the
    /// channel do not fit together.
    #[must_use]
    pub fn sample(&self, seconds: f64) -> Option<ChannelValue> {
        let place = self.place(seconds)?;
        Some(match &self.values {
            ChannelValues::Translation(values) => ChannelValue::Translation(self.blend(values, 1, 0, place)?),
            ChannelValues::Rotation(values) => ChannelValue::Rotation(unit(self.blend(values, 1, 0, place)?)),
            ChannelValues::Scale(values) => ChannelValue::Scale(self.blend(values, 1, 0, place)?),
            ChannelValues::Weights { count, values } => {
                let weights: Option<Vec<f32>> =
                    (0..*count).map(|i| self.blend(values, *count, i, place)).collect();
                ChannelValue::Weights(weights?)
            }
            ChannelValues::Path { points, parameters, look_ahead } => {
                let (translation, ahead) = on_path(points, self.blend(parameters, 1, 0, place)?)?;
                ChannelValue::Path { translation, rotation: look_ahead.then(|| look_along(ahead)) }
            }
        })
    }

    /// The interval that holds `seconds`.
    fn place(&self, seconds: f64) -> Option<Place> {
        let (first, last) = (*self.times.first()?, *self.times.last()?);
        if seconds.is_nan() || seconds <= first {
            return Some(Place { key: 0, t: 0.0, length: 0.0 });
        }
        if seconds >= last {
            return Some(Place { key: self.times.len() - 1, t: 0.0, length: 0.0 });
        }
        let key = self.times.partition_point(|&time| time <= seconds).max(1) - 1;
        let length = self.times.get(key + 1)? - self.times[key];
        let t = (seconds - self.times[key]) / length;
        Some(Place { key, t: if t > 0.0 { t.min(1.0) } else { 0.0 }, length })
    }

    /// Value number `i` of `count` per key at a place. Cubic splines have in-tangents, values and
    /// out-tangents of all `count` one after the other at each key.
    fn blend<T: Blend>(&self, values: &[T], count: usize, i: usize, place: Place) -> Option<T> {
        let Place { key, t, length } = place;
        if self.interpolation != Interpolation::CubicSpline {
            let at = |key: usize| values.get(key.checked_mul(count)?.checked_add(i)?).copied();
            let from = at(key)?;
            if t == 0.0 || self.interpolation == Interpolation::Step {
                return Some(from);
            }
            return Some(from.linear(at(key + 1)?, t));
        }
        let at = |key: usize, part: usize| {
            values.get((3 * key + part).checked_mul(count)?.checked_add(i)?).copied()
        };
        let from = at(key, 1)?;
        if t == 0.0 {
            return Some(from);
        }
        let (out, into, to) = (at(key, 2)?, at(key + 1, 0)?, at(key + 1, 1)?);
        let (t2, t3) = (t * t, t * t * t);
        let start = from.scaled(2.0 * t3 - 3.0 * t2 + 1.0).plus(out.scaled(length * (t3 - 2.0 * t2 + t)));
        let end = to.scaled(3.0 * t2 - 2.0 * t3).plus(into.scaled(length * (t3 - t2)));
        Some(start.plus(end))
    }
}

/// Place and direction on a chain of cubic Bézier pieces at `parameter`, cut to [0, 1]. `None` unless
/// there are 3 n + 1 points, n > 0.
fn on_path(points: &[DVec3], parameter: f64) -> Option<(DVec3, DVec3)> {
    if points.len() < 4 || points.len() % 3 != 1 {
        return None;
    }
    let pieces = points.len() / 3;
    let along = parameter.clamp(0.0, 1.0) * pieces as f64;
    let piece = (along as usize).min(pieces - 1);
    let t = if along.is_nan() { 0.0 } else { along - piece as f64 };
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| points[3 * piece + i]);
    let slope = |t: f64| (b - a).lerp(c - b, t).lerp((c - b).lerp(d - c, t), t);
    let (ab, bc, cd) = (a.lerp(b, t), b.lerp(c, t), c.lerp(d, t));
    let place = ab.lerp(bc, t).lerp(bc.lerp(cd, t), t);
    // Where the derivative vanishes, the direction from within the piece.
    let size = (b - a).length().max((c - b).length()).max((d - c).length());
    let ahead = [0.0, 1e-4, 1e-2, 0.2].map(|s| slope(t + s * (0.5 - t)));
    let ahead = ahead.into_iter().find(|v| v.length() > 1e-9 * size).unwrap_or(DVec3::NEG_Z);
    Some((place, ahead))
}

/// Rotation that turns -z along `ahead`, +y as upright as it allows.
fn look_along(ahead: DVec3) -> DQuat {
    let ahead = ahead.normalize_or(DVec3::NEG_Z);
    let frame = [DVec3::Y, DVec3::NEG_Z].into_iter().find_map(|up| {
        let across = ahead.cross(up).length() > 1e-6;
        if across { world_from_look_at(DVec3::ZERO, ahead, up).ok() } else { None }
    });
    frame.map_or(DQuat::IDENTITY, |frame| DQuat::from_mat3(&DMat3::from_mat4(frame)))
}

#[cfg(test)]
mod tests;
