//! The scene: what there is to see, and nothing of how it is drawn.
//!
//! A [`Scene`] is a set of arenas (nodes, geometries, materials, textures, images, lights, cameras,
//! animations) whose entries name each other by typed index. Nodes form trees; each places a
//! geometry, a light or a camera in its parent's frame, and several nodes may place the same
//! geometry (instances). Readers build scenes, renderers take `&Scene`.

mod animation;
mod bounds;
mod camera;
mod counts;
mod default_lights;
mod faces;
mod fog;
mod framing;
mod ids;
mod light;
mod material;
mod material_models;
mod measure;
mod mesh;
mod mesh_check;
mod node;
mod normals;
mod patch_converter;
mod pose;
mod sample;
mod scene;
mod shape;
mod tessellate;
#[cfg(test)]
mod test_support;
mod texture;
mod topology;
mod validate;
mod weld;

pub use animation::{Animation, Channel, ChannelTarget, ChannelValues, Interpolation};
pub use camera::{Camera, Projection};
pub use counts::SceneCounts;
pub use default_lights::{DefaultLights, default_lights};
pub use faces::{is_flat_quad, split_quad};
pub use fog::{Fog, FogFalloff};
pub use framing::{DEFAULT_YFOV, PlacedCamera, SceneCamera, frame_bounds};
pub use ids::{AnimationId, CameraId, GeometryId, ImageId, LightId, MaterialId, NodeId, SkinId, TextureId};
pub use light::{Attenuation, Light, LightKind, SpotFalloff};
pub use material::{AlphaMode, Material, MetallicRoughness, Phong, Reflection};
pub use mesh::{Faces, JointInfluence, Mesh, MorphTarget, Surface, Vertices};
pub use mesh_check::MeshError;
pub use node::{Node, Skin, Transform};
pub use normals::{
    DegeneratePolygon, NormalSettings, NormalWeight, PolygonNormal, compute_normals, newell_vector,
    polygon_normal_1991, polygon_normals_1991,
};
pub use patch_converter::{PatchConversion, VertexSearch, patch_to_polygons};
pub use pose::posed_mesh;
pub use sample::ChannelValue;
pub use scene::{Background, Geometry, Instance, Scene, SceneError, Warning};
pub use senca_math as math;
pub use shape::{BezierPatch, NurbsSurface, Shape};
pub use tessellate::{
    MAX_FACES, PixelTolerance, REVOLUTION_CREASE, ShapeError, TessellationSettings, Tolerance, tessellate,
    triangulated,
};
pub use texture::{ColorSpace, Filter, ImageData, Texture, TextureImage, TextureRef, Wrap};
pub use topology::{EdgeCounts, Topology};
