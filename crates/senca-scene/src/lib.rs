//! The scene: what there is to see, and nothing of how it is drawn.
//!
//! A [`Scene`] is a set of arenas (nodes, geometries, materials, textures, images, lights, cameras,
//! animations) whose entries name each other by typed index. Nodes form trees; each places a
//! geometry, a light or a camera in its parent's frame, and several nodes may place the same
//! geometry (instances). Readers build scenes, renderers take `&Scene`.

mod animation;
mod camera;
mod fog;
mod ids;
mod light;
mod material;
mod mesh;
mod node;
mod scene;
mod shape;
mod texture;

pub use animation::{Animation, Channel, ChannelTarget, ChannelValues, Interpolation};
pub use camera::{Camera, Projection};
pub use fog::{Fog, FogFalloff};
pub use ids::{AnimationId, CameraId, GeometryId, ImageId, LightId, MaterialId, NodeId, SkinId, TextureId};
pub use light::{Attenuation, Light, LightKind, SpotFalloff};
pub use material::{AlphaMode, Material, MetallicRoughness, Phong, Reflection};
pub use mesh::{Faces, JointInfluence, Mesh, MorphTarget, Surface, Vertices};
pub use node::{Node, Skin, Transform};
pub use scene::{Background, Geometry, Instance, Scene, SceneError, Warning};
pub use senca_math as math;
pub use shape::{BezierPatch, NurbsSurface, Shape};
pub use texture::{ColorSpace, Filter, ImageData, Texture, TextureImage, TextureRef, Wrap};
