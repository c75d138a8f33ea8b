//! The scene: what there is to see, and nothing of how it is drawn.
//!
//! A [`Scene`] is a set of arenas (nodes, geometries, materials, textures, images, lights, cameras,
//! animations) whose entries name each other by typed index. Nodes form trees; each places a
//! geometry, a light or a camera in its parent's frame, and several nodes may place the same
//! geometry (instances). Readers build scenes, renderers take `&Scene`.
//!
//! What can be done with one before it is drawn:
//!
//! | question | answer |
//! |---|---|
//! | does it hold together, and can it be mended? | [`Scene::validate`], [`Scene::sanitize`], [`Mesh::check`] |
//! | what does it look like at time t? | [`Scene::at_time`], [`Scene::pose`], [`posed_mesh`] |
//! | where is everything, how big is it? | [`Scene::instances`], [`Scene::bounds`], [`Scene::counts`] |
//! | from where is it seen? | [`Scene::placed_cameras`], [`Camera::view`], [`Scene::frame_all`] |
//! | what lights it? | [`Scene::is_lit`], [`default_lights`], [`Scene::light_by_default`] |
//! | which triangles is a shape? | [`tessellate`], [`patch_to_polygons`], [`triangulated`] |
//! | which normals does a mesh have? | [`compute_normals`], [`polygon_normals_1991`] |
//! | is a mesh closed, oriented, of one piece? | [`Topology`], [`Mesh::weld`], [`Mesh::flip`], [`Mesh::signed_volume`] |
//!
//! ```
//! use senca_scene::{Scene, Shape, TessellationSettings, Tolerance, Topology, tessellate};
//!
//! let scene = Scene::of_shape("ball", Shape::Sphere { radius: 2.0 });
//! let settings = TessellationSettings { tolerance: Tolerance::World(0.01), ..Default::default() };
//! let mesh = tessellate(&scene.geometries[0].shape, &settings)?;
//! assert!(Topology::new(&mesh).is_closed());
//!
//! let picture_aspect = 4.0 / 3.0;
//! let placed = scene.frame_all(picture_aspect);
//! let view = placed.camera.view(&placed.world_from_camera, picture_aspect, &scene.bounds())?;
//! let center = view.clip_from_world * senca_scene::math::glam::DVec4::W;
//! assert!(center.w > 0.0 && center.x.abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod animation;
mod bounds;
mod camera;
mod counts;
mod csg;
mod default_lights;
mod environment;
mod faces;
mod fog;
mod framing;
mod half_spaces;
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
pub use camera::{Camera, Lens, Projection};
pub use counts::SceneCounts;
pub use csg::{Csg, CsgLeaf, CsgNode};
pub use default_lights::{DefaultLights, default_lights};
pub use environment::{Environment, Irradiance};
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
pub use shape::{BezierPatch, ImplicitSurface, NurbsSurface, Shape};
pub use tessellate::{
    MAX_FACES, PixelTolerance, REVOLUTION_CREASE, ShapeError, TessellationSettings, Tolerance, tessellate,
    triangulated,
};
pub use texture::{ColorSpace, Filter, ImageData, Texture, TextureImage, TextureRef, Wrap};
pub use topology::{EdgeCounts, Topology};
