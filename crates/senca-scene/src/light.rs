//! Light sources.

use senca_math::LinearRgb;

/// A light source. It sits at the origin of its node and shines along the node's -z axis, with +y
/// up, where it has a direction at all.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name from the file, or empty.
    pub name: String,
    /// Colour times intensity per channel; may exceed 1.
    pub color: LinearRgb,
    /// Fall-off with distance.
    pub attenuation: Attenuation,
    /// Kind and its parameters.
    pub kind: LightKind,
}

/// The kinds of light sources (course text, sections 2.1 and 2.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Reaches every point from every side, in addition to `Scene::ambient`.
    Ambient,
    /// A bulb.
    Point,
    /// Parallel rays along the node's -z.
    Parallel,
    /// A cone of light around the node's -z.
    Spot(SpotFalloff),
    /// A prism of light with sharp sides: lit where, in the node's frame, x and y are within the
    /// limits and 0 <= -z <= `depth` (course text, section 2.5).
    BoxSpot {
        /// Smallest x and y.
        min: [f64; 2],
        /// Largest x and y.
        max: [f64; 2],
        /// Reach, > 0.
        depth: f64,
    },
    /// A rectangle in the node's xy plane, centred, that shines along -z.
    Area {
        /// Edge lengths along x and y, each > 0.
        size: [f64; 2],
        /// Whether the rectangle itself is seen, from the side it shines to, and mirrored. It lights the
        /// same in either case.
        visible: bool,
    },
}

/// How a cone of light ends at its side. Angles are in radians from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpotFalloff {
    /// Full intensity up to `angle`, none outside.
    Sharp {
        /// Half angle of the cone, in (0, pi].
        angle: f64,
    },
    /// Intensity falls as `cos(angle)^exponent`; none behind.
    Cosine {
        /// Exponent, usually 1 (wide) to 50 (narrow).
        exponent: f64,
    },
    /// glTF's: full inside `inner`, none outside `outer`, smooth in between.
    Smooth {
        /// Angle where the fall-off begins, >= 0 and < `outer`.
        inner: f64,
        /// Angle where the light ends, at most pi/2.
        outer: f64,
    },
}

/// Fall-off with the distance d from the source.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Attenuation {
    /// No fall-off.
    #[default]
    None,
    /// `min(1 / (constant + linear d + quadratic d^2), 1)` (course text, section 2.5, eq. 2.4).
    Polynomial {
        /// c0, >= 0.
        constant: f64,
        /// c1, >= 0.
        linear: f64,
        /// c2, >= 0.
        quadratic: f64,
    },
    /// `1 / d^2`, as light does, ended smoothly at `range` where one is given (glTF punctual lights).
    InverseSquare {
        /// Distance where the light has ended, > 0.
        range: Option<f64>,
    },
}
