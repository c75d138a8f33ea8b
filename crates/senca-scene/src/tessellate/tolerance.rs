//! How close a mesh must be to its shape.

use senca_math::Aabb;
use senca_math::glam::{DMat4, DVec3, DVec4};

/// How close a mesh must be to its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Largest distance between shape and mesh, in object units, > 0.
    World(f64),
    /// Largest distance between shape and mesh as seen in a picture.
    Pixels(PixelTolerance),
    /// Fixed numbers of steps, each at least 1: around and along for round shapes (around at least
    /// 3), in u and v for patches. Patches that share an edge take the larger number there.
    Steps(u32, u32),
}

/// A tolerance in pixels of one picture, as an affine function of the place: the length in object
/// units that is seen as `pixels` pixels at point p is `gradient . p + offset`, at least `least`.
///
/// Being affine, its smallest value over a Bézier patch or a box is found at their corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTolerance {
    /// Growth of the tolerance per object unit.
    pub gradient: DVec3,
    /// Tolerance at the origin.
    pub offset: f64,
    /// Smallest tolerance, > 0; holds near and behind the eye.
    pub least: f64,
}

impl PixelTolerance {
    /// Distance of `pixels` pixels in a picture of `width` by `height` pixels whose normalised x and
    /// y, -1 to 1, come from `clip_from_object` (column vectors). `least_w` is the smallest w of
    /// visible points (the near distance of a central projection; 1 for a parallel one).
    #[must_use]
    pub fn new(clip_from_object: &DMat4, width: f64, height: f64, pixels: f64, least_w: f64) -> Self {
        let row = |r: usize| clip_from_object.row(r);
        let pixels_per_unit = |r: DVec4, size: f64| 0.5 * size * r.truncate().length();
        let scale = pixels_per_unit(row(0), width).max(pixels_per_unit(row(1), height));
        let per_w = pixels / scale.max(f64::MIN_POSITIVE);
        let w = row(3);
        let gradient = w.truncate() * per_w;
        Self { gradient, offset: w.w * per_w, least: (least_w * per_w).max(f64::MIN_POSITIVE) }
    }

    /// The tolerance in object units at `point`.
    #[must_use]
    pub fn at(&self, point: DVec3) -> f64 {
        (self.gradient.dot(point) + self.offset).max(self.least)
    }
}

impl Tolerance {
    /// Smallest tolerance over `points`, or `None` for fixed steps.
    pub(super) fn over(&self, points: &[DVec3]) -> Option<f64> {
        let smallest = |t: &PixelTolerance| points.iter().map(|&p| t.at(p)).fold(f64::INFINITY, f64::min);
        let tolerance = match self {
            Self::World(tolerance) => *tolerance,
            Self::Pixels(pixels) => smallest(pixels),
            Self::Steps(..) => return None,
        };
        // A tolerance that is no number asks for the finest mesh; so does 0.
        Some(if tolerance > 0.0 { tolerance } else { f64::MIN_POSITIVE })
    }

    /// Smallest tolerance over a box, or `None` for fixed steps.
    pub(super) fn over_box(&self, bounds: &Aabb) -> Option<f64> {
        self.over(&bounds.corners())
    }
}

/// Steps around a full circle of `radius` so that chords stay within `tolerance` of the arc, in
/// `least..=most`: the sagitta `r (1 - cos(pi / n))` is at most the tolerance.
pub(super) fn steps_around(radius: f64, tolerance: f64, least: u32, most: u32) -> u32 {
    let cosine = 1.0 - tolerance / radius.max(f64::MIN_POSITIVE);
    if cosine.is_nan() || cosine >= 1.0 {
        return most;
    }
    let half_step = cosine.max(-1.0).acos();
    let steps = (std::f64::consts::PI / half_step).ceil();
    if steps < f64::from(most) { (steps as u32).clamp(least, most) } else { most }
}

/// `ceil(x)` in `least..=most`; not a number gives `most`.
pub(super) fn bounded_steps(x: f64, least: u32, most: u32) -> u32 {
    if x <= f64::from(most) { (x.ceil() as u32).clamp(least, most) } else { most }
}
