//! The JSON part of a glTF file as it is written (glTF 2.0, section 5), not yet checked.
//!
//! What most entries lack is boxed, so that a list of a million `{}` stays small.
//!
//! Numbers that name or count things are [`Whole`], which also takes `3.0`, as JSON knows one kind
//! of number only. What has a default in the format has it here.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, de};

/// A number without fraction, >= 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Whole(pub(super) u64);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WholeVisitor)
    }
}

struct WholeVisitor;

impl Visitor<'_> for WholeVisitor {
    type Value = Whole;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number, 0 or more")
    }

    fn visit_u64<E: Error>(self, v: u64) -> Result<Whole, E> {
        Ok(Whole(v))
    }

    fn visit_i64<E: Error>(self, v: i64) -> Result<Whole, E> {
        u64::try_from(v).map(Whole).map_err(|_| E::invalid_value(de::Unexpected::Signed(v), &self))
    }

    fn visit_f64<E: Error>(self, v: f64) -> Result<Whole, E> {
        let whole = v.fract() == 0.0 && (0.0..9.0e15).contains(&v);
        whole.then_some(Whole(v as u64)).ok_or_else(|| E::invalid_value(de::Unexpected::Float(v), &self))
    }
}

/// Field-less form of a structure's definition: every field optional or with a default.
macro_rules! json_objects {
    ($($(#[$doc:meta])* $name:ident { $($(#[$attr:meta])* $field:ident: $type:ty,)* })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        pub(super) struct $name { $($(#[$attr])* pub(super) $field: $type,)* }
    )*};
}

json_objects! {
    Root {
        asset: Option<Asset>,
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
        accessors: Vec<Accessor>,
        animations: Vec<Animation>,
        buffers: Vec<Buffer>,
        buffer_views: Vec<BufferView>,
        cameras: Vec<Camera>,
        images: Vec<Image>,
        materials: Vec<Material>,
        meshes: Vec<Mesh>,
        nodes: Vec<Node>,
        samplers: Vec<Sampler>,
        scene: Option<Whole>,
        scenes: Vec<Scene>,
        skins: Vec<Skin>,
        textures: Vec<Texture>,
        extensions: RootExtensions,
    }
    RootExtensions {
        #[serde(rename = "KHR_lights_punctual")]
        lights: Option<Lights>,
    }
    Lights { lights: Vec<Light>, }
    Light {
        name: String,
        r#type: String,
        color: Option<[f64; 3]>,
        intensity: Option<f64>,
        range: Option<f64>,
        spot: Option<Spot>,
    }
    Spot { inner_cone_angle: Option<f64>, outer_cone_angle: Option<f64>, }
    Asset { version: String, min_version: Option<String>, }
    Accessor {
        buffer_view: Option<Whole>,
        byte_offset: Whole,
        component_type: Whole,
        normalized: bool,
        count: Whole,
        r#type: String,
        sparse: Option<Box<Sparse>>,
    }
    Sparse { count: Whole, indices: SparseIndices, values: SparseValues, }
    SparseIndices { buffer_view: Whole, byte_offset: Whole, component_type: Whole, }
    SparseValues { buffer_view: Whole, byte_offset: Whole, }
    Buffer { uri: Option<String>, byte_length: Whole, }
    BufferView { buffer: Whole, byte_offset: Whole, byte_length: Whole, byte_stride: Option<Whole>, }
    Animation { name: String, channels: Vec<Channel>, samplers: Vec<AnimationSampler>, }
    Channel { sampler: Whole, target: ChannelTarget, }
    ChannelTarget { node: Option<Whole>, path: String, }
    AnimationSampler { input: Whole, output: Whole, interpolation: Option<String>, }
    Camera {
        name: String,
        r#type: String,
        perspective: Option<Box<Perspective>>,
        orthographic: Option<Box<Orthographic>>,
    }
    Perspective { yfov: f64, aspect_ratio: Option<f64>, znear: f64, zfar: Option<f64>, }
    Orthographic { xmag: f64, ymag: f64, znear: f64, zfar: f64, }
    Image {
        name: String,
        uri: Option<String>,
        buffer_view: Option<Whole>,
        mime_type: Option<String>,
    }
    Sampler { mag_filter: Option<Whole>, min_filter: Option<Whole>, wrap_s: Option<Whole>, wrap_t: Option<Whole>, }
    Texture { name: String, sampler: Option<Whole>, source: Option<Whole>, }
    TextureInfo {
        index: Whole,
        tex_coord: Whole,
        scale: Option<f64>,
        strength: Option<f64>,
        extensions: TextureInfoExtensions,
    }
    TextureInfoExtensions {
        #[serde(rename = "KHR_texture_transform")]
        transform: Option<Box<TextureTransform>>,
    }
    TextureTransform {
        offset: Option<[f64; 2]>,
        rotation: f64,
        scale: Option<[f64; 2]>,
        tex_coord: Option<Whole>,
    }
    Material {
        name: String,
        pbr_metallic_roughness: Option<Box<MetallicRoughness>>,
        normal_texture: Option<Box<TextureInfo>>,
        occlusion_texture: Option<Box<TextureInfo>>,
        emissive_texture: Option<Box<TextureInfo>>,
        emissive_factor: Option<Box<[f64; 3]>>,
        alpha_mode: Option<String>,
        alpha_cutoff: Option<f64>,
        double_sided: bool,
        extensions: Option<Box<MaterialExtensions>>,
    }
    MetallicRoughness {
        base_color_factor: Option<[f64; 4]>,
        base_color_texture: Option<Box<TextureInfo>>,
        metallic_factor: Option<f64>,
        roughness_factor: Option<f64>,
        metallic_roughness_texture: Option<Box<TextureInfo>>,
    }
    MaterialExtensions {
        #[serde(rename = "KHR_materials_unlit")]
        unlit: Option<Nothing>,
        #[serde(rename = "KHR_materials_emissive_strength")]
        emissive_strength: Option<EmissiveStrength>,
        #[serde(rename = "KHR_materials_ior")]
        ior: Option<Ior>,
        #[serde(rename = "KHR_materials_transmission")]
        transmission: Option<Transmission>,
        #[serde(rename = "KHR_materials_volume")]
        volume: Option<Volume>,
        #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
        specular_glossiness: Option<SpecularGlossiness>,
    }
    Nothing {}
    EmissiveStrength { emissive_strength: Option<f64>, }
    Ior { ior: Option<f64>, }
    Transmission { transmission_factor: f64, transmission_texture: Option<Box<TextureInfo>>, }
    Volume { thickness_factor: f64, attenuation_distance: Option<f64>, attenuation_color: Option<[f64; 3]>, }
    SpecularGlossiness {
        diffuse_factor: Option<[f64; 4]>,
        diffuse_texture: Option<Box<TextureInfo>>,
        specular_factor: Option<[f64; 3]>,
        glossiness_factor: Option<f64>,
        specular_glossiness_texture: Option<Box<TextureInfo>>,
    }
    Mesh {
        name: String,
        primitives: Vec<Primitive>,
        weights: Vec<f64>,
        extras: Option<Box<serde_json::Value>>,
    }
    Primitive {
        attributes: BTreeMap<String, Whole>,
        indices: Option<Whole>,
        material: Option<Whole>,
        mode: Option<Whole>,
        targets: Vec<BTreeMap<String, Whole>>,
    }
    Node {
        name: String,
        children: Vec<Whole>,
        matrix: Option<Box<[f64; 16]>>,
        translation: Option<Box<[f64; 3]>>,
        rotation: Option<Box<[f64; 4]>>,
        scale: Option<Box<[f64; 3]>>,
        mesh: Option<Whole>,
        camera: Option<Whole>,
        skin: Option<Whole>,
        weights: Option<Vec<f64>>,
        extensions: Option<Box<NodeExtensions>>,
    }
    NodeExtensions {
        #[serde(rename = "KHR_lights_punctual")]
        light: Option<LightUse>,
        #[serde(rename = "EXT_mesh_gpu_instancing")]
        instancing: Option<Instancing>,
    }
    LightUse { light: Whole, }
    Instancing { attributes: BTreeMap<String, Whole>, }
    Scene { name: String, nodes: Vec<Whole>, }
    Skin { name: String, inverse_bind_matrices: Option<Whole>, joints: Vec<Whole>, }
}
