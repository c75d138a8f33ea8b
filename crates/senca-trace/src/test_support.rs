//! What tests of several modules need.

use senca_math::glam::{DVec2, DVec3, Vec4};

use crate::Interaction;

/// A white place in the origin that faces +z and is seen from there.
pub(crate) fn interaction_facing_z() -> Interaction {
    Interaction {
        point: DVec3::ZERO,
        normal: DVec3::Z,
        shading_normal: DVec3::Z,
        to_viewer: DVec3::Z,
        entering: true,
        texcoords: [DVec2::splat(0.5); 2],
        tangent: DVec3::X,
        handedness: 1.0,
        color: Vec4::ONE,
        material: 0,
        object: 0,
        error: 0.0,
    }
}
