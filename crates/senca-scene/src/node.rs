//! Nodes: places in the scene.

use senca_math::glam::{DMat4, DQuat, DVec3};

use crate::{CameraId, GeometryId, LightId, MaterialId, NodeId, SkinId};

/// A place in the scene with what is there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// Name from the file, or empty.
    pub name: String,
    /// Place in the parent's frame.
    pub transform: Transform,
    /// Nodes placed in this one's frame.
    pub children: Vec<NodeId>,
    /// Geometry shown here.
    pub geometry: Option<GeometryId>,
    /// Material in place of the geometry's own where that names none.
    pub material: Option<MaterialId>,
    /// Light source here.
    pub light: Option<LightId>,
    /// Camera here.
    pub camera: Option<CameraId>,
    /// Skin that bends the geometry.
    pub skin: Option<SkinId>,
    /// Weights of the geometry's morph targets; missing ones are 0.
    pub morph_weights: Vec<f32>,
}

/// Place of a node in its parent's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// Scale, then rotate, then translate.
    Parts {
        /// Translation.
        translation: DVec3,
        /// Unit quaternion.
        rotation: DQuat,
        /// Scale per axis.
        scale: DVec3,
    },
    /// Any affine matrix.
    Matrix(DMat4),
}

impl Default for Transform {
    fn default() -> Self {
        Self::Parts { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Transform {
    /// The matrix `parent_from_node`.
    #[must_use]
    pub fn matrix(&self) -> DMat4 {
        match *self {
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
            Self::Matrix(matrix) => matrix,
        }
    }
}

/// Joints that bend meshes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Name from the file, or empty.
    pub name: String,
    /// Nodes that act as joints.
    pub joints: Vec<NodeId>,
    /// `joint_from_mesh` in the pose of binding, one per joint; empty stands for identities.
    pub inverse_bind_matrices: Vec<DMat4>,
}
