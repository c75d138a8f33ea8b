//! What is asked of a hierarchy, and what it answers.

use senca_math::glam::{DVec3, Vec3};

/// A piece of a straight line, `x = origin + t direction` with t between two limits, in single
/// precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray32 {
    /// Where t is 0.
    pub origin: Vec3,
    /// Hits must have t > `t_min`.
    pub t_min: f32,
    /// Of any length but zero; t counts in multiples of it.
    pub direction: Vec3,
    /// Hits must have t < `t_max`; infinite for a half-line.
    pub t_max: f32,
}

impl Ray32 {
    /// The half-line from `origin` along `direction`.
    #[must_use]
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY }
    }

    /// The same ray, rounded.
    #[must_use]
    #[inline]
    pub fn from_f64(origin: DVec3, direction: DVec3, t_min: f64, t_max: f64) -> Self {
        Self {
            origin: origin.as_vec3(),
            t_min: t_min as f32,
            direction: direction.as_vec3(),
            t_max: t_max as f32,
        }
    }

    /// The point at parameter `t`.
    #[must_use]
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Whether origin and direction are finite, the direction is not zero and the limits leave
    /// something between them. Other rays meet nothing.
    #[must_use]
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != Vec3::ZERO
            && self.t_min < self.t_max
    }

    /// For a ray with negative t: the part behind the origin, turned round, and the part ahead of it.
    /// The first has t = 0 too.
    #[inline(always)]
    pub(crate) fn halves(&self) -> Option<[Self; 2]> {
        (self.t_min < 0.0).then(|| {
            let behind = Self {
                direction: -self.direction,
                t_min: (-f32::from_bits(1)).max(-self.t_max),
                t_max: -self.t_min,
                ..*self
            };
            [behind, Self { t_min: 0.0, ..*self }]
        })
    }
}

/// A ray meets a triangle with corners p0, p1, p2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Parameter of the ray.
    pub t: f32,
    /// Barycentric weight of p1: the point is `(1 - u - v) p0 + u p1 + v p2`.
    pub u: f32,
    /// Barycentric weight of p2.
    pub v: f32,
    /// Index of the triangle in the list the hierarchy was built from.
    pub triangle: u32,
}

impl TriangleHit {
    /// The same hit on the ray turned round.
    #[inline(always)]
    pub(crate) fn reversed(&self) -> Self {
        Self { t: 0.0 - self.t, ..*self }
    }
}

/// What a traversal cost. Counts add up over calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraversalCounts {
    /// Inner nodes whose boxes were tested, up to eight at a time.
    pub nodes: u64,
    /// Triangles tested, or items offered.
    pub triangles: u64,
}

impl std::ops::AddAssign for TraversalCounts {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.triangles += other.triangles;
    }
}
