//! Keyframe animation of nodes.

use senca_math::glam::{DQuat, DVec3};

use crate::NodeId;

/// A named set of channels that run together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Name from the file, or empty.
    pub name: String,
    /// The channels.
    pub channels: Vec<Channel>,
}

/// One property of one node over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What is moved.
    pub target: ChannelTarget,
    /// Key times in seconds, strictly increasing, at least one.
    pub times: Vec<f64>,
    /// Values at the keys; three per key (in-tangent, value, out-tangent) for cubic splines.
    pub values: ChannelValues,
    /// What happens between keys.
    pub interpolation: Interpolation,
}

/// The node a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelTarget {
    /// The node.
    pub node: NodeId,
}

/// Values of a channel; the variant names the property.
#[derive(Clone, Debug, PartialEq)]
pub enum ChannelValues {
    /// Translation in the parent's frame.
    Translation(Vec<DVec3>),
    /// Rotation in the parent's frame.
    Rotation(Vec<DQuat>),
    /// Scale per axis.
    Scale(Vec<DVec3>),
    /// Morph weights, `count` per key.
    Weights {
        /// Number of morph targets.
        count: usize,
        /// The weights, key after key.
        values: Vec<f32>,
    },
    /// The node runs along a chain of cubic Bézier pieces (3 n + 1 points) from start to end as the
    /// keyed parameter goes from 0 to 1; `look_ahead` turns its -z along the path.
    Path {
        /// Control points in the parent's frame.
        points: Vec<DVec3>,
        /// Parameter in [0, 1] at each key.
        parameters: Vec<f64>,
        /// Whether the node looks along its path.
        look_ahead: bool,
    },
}

/// What happens between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value jumps at the keys.
    Step,
    /// Linear, spherical for rotations.
    #[default]
    Linear,
    /// Cubic Hermite spline with the tangents given at the keys.
    CubicSpline,
}
