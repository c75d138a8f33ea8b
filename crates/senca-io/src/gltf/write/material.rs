//! Materials, textures, samplers and pictures.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use senca_scene::math::LinearRgb;
use senca_scene::math::color::srgb_from_linear;
use senca_scene::math::glam::Mat3;
use senca_scene::{
    AlphaMode, Filter, ImageData, Material, MetallicRoughness, Reflection, Scene, Texture, TextureRef, Wrap,
};

use super::{Output, Target, named, numbers, set};
use crate::WriteError;

impl Output {
    /// Writes pictures, textures and materials, each under its own number.
    pub(super) fn add_materials(&mut self, scene: &Scene) -> Result<(), WriteError> {
        let linear = linear_images(scene);
        for (i, image) in scene.images.iter().enumerate() {
            if matches!(image.data, ImageData::RgbaF32 { .. }) {
                self.warn(format!("image {i} {:?} is written with 8 bits a channel", image.name));
            }
            let png = png(&image.data, linear[i]).map_err(|why| WriteError::Encode {
                message: format!("image {i} {:?}: {why}", image.name),
            })?;
            let mut json = named(&image.name);
            set(&mut json, "mimeType", json!("image/png"));
            set(&mut json, "bufferView", json!(self.add_view(&png, Target::Other)));
            self.push("images", Value::Object(json));
        }
        let mut samplers = BTreeMap::new();
        for texture in &scene.textures {
            let sampler = sampler_json(texture);
            let number =
                *samplers.entry(sampler.to_string()).or_insert_with(|| self.push("samplers", sampler));
            let mut json = named(&texture.name);
            set(&mut json, "sampler", json!(number));
            if texture.image.index() < scene.images.len() {
                set(&mut json, "source", json!(texture.image.0));
            }
            self.push("textures", Value::Object(json));
        }
        for material in &scene.materials {
            let json = MaterialWriter { output: self, textures: scene.textures.len() }.json(material);
            self.push("materials", json);
        }
        Ok(())
    }
}

/// For each picture whether it holds data rather than colour: no material shows it as a colour.
fn linear_images(scene: &Scene) -> Vec<bool> {
    let mut linear = vec![false; scene.images.len()];
    let mut mark = |texture: Option<TextureRef>, is_linear: bool| {
        let image = texture.and_then(|t| scene.textures.get(t.texture.index())).map(|t| t.image.index());
        if let Some(image) = image.and_then(|i| linear.get_mut(i)) {
            *image = is_linear;
        }
    };
    for material in &scene.materials {
        mark(material.normal_texture, true);
        mark(material.occlusion_texture, true);
        if let Reflection::MetallicRoughness(m) = &material.reflection {
            mark(m.metallic_roughness_texture, true);
        }
    }
    for material in &scene.materials {
        mark(material.emission_texture, false);
        match &material.reflection {
            Reflection::MetallicRoughness(m) => mark(m.base_color_texture, false),
            Reflection::Phong(p) => mark(p.texture, false),
        }
    }
    linear
}

fn sampler_json(texture: &Texture) -> Value {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    };
    let (enlarged, reduced) = match texture.filter {
        Filter::Nearest => (9728, 9728),
        Filter::Bilinear => (9729, 9729),
        Filter::Footprint | Filter::Trilinear => (9729, 9987),
    };
    json!({"magFilter": enlarged, "minFilter": reduced, "wrapS": wrap(texture.wrap_u), "wrapT": wrap(texture.wrap_v)})
}

struct MaterialWriter<'a> {
    output: &'a mut Output,
    /// How many textures there are.
    textures: usize,
}

impl MaterialWriter<'_> {
    fn json(&mut self, material: &Material) -> Value {
        let reflection = material.to_metallic_roughness();
        let mut json = named(&material.name);
        set(&mut json, "pbrMetallicRoughness", self.reflection(&reflection));
        for (key, texture, factor) in [
            ("normalTexture", material.normal_texture, "scale"),
            ("occlusionTexture", material.occlusion_texture, "strength"),
            ("emissiveTexture", material.emission_texture, ""),
        ] {
            self.texture(&mut json, key, texture, factor);
        }
        if material.double_sided {
            set(&mut json, "doubleSided", json!(true));
        }
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Blend => set(&mut json, "alphaMode", json!("BLEND")),
            AlphaMode::Mask { cutoff } => {
                set(&mut json, "alphaMode", json!("MASK"));
                set(&mut json, "alphaCutoff", json!(cutoff));
            }
        }
        let mut extensions = Map::new();
        self.emission(material, &mut json, &mut extensions);
        self.extensions(material, &reflection, &mut extensions);
        if !extensions.is_empty() {
            set(&mut json, "extensions", Value::Object(extensions));
        }
        Value::Object(json)
    }

    fn reflection(&mut self, m: &MetallicRoughness) -> Value {
        let mut json = Map::new();
        let [r, g, b] = unit(m.base_color);
        set(&mut json, "baseColorFactor", numbers(&[r, g, b, m.alpha.clamp(0.0, 1.0)]));
        set(&mut json, "metallicFactor", json!(m.metallic.clamp(0.0, 1.0)));
        set(&mut json, "roughnessFactor", json!(m.roughness.clamp(0.0, 1.0)));
        self.texture(&mut json, "baseColorTexture", m.base_color_texture, "");
        self.texture(&mut json, "metallicRoughnessTexture", m.metallic_roughness_texture, "");
        Value::Object(json)
    }

    /// The factor is at most 1; a strength makes up for what is above. Their product, in double
    /// precision, rounds back to the same bits.
    fn emission(
        &mut self,
        material: &Material,
        json: &mut Map<String, Value>,
        extensions: &mut Map<String, Value>,
    ) {
        let largest = f64::from(material.emission.max_component());
        if largest <= 0.0 || !material.emission.is_finite() {
            return;
        }
        let strength = largest.max(1.0);
        let factor = material.emission.to_array().map(|v| f64::from(v.max(0.0)) / strength);
        set(json, "emissiveFactor", numbers(&factor));
        if strength > 1.0 {
            self.extend(extensions, "KHR_materials_emissive_strength", json!({"emissiveStrength": strength}));
        }
    }

    fn extensions(
        &mut self,
        material: &Material,
        m: &MetallicRoughness,
        extensions: &mut Map<String, Value>,
    ) {
        if material.unlit {
            self.extend(extensions, "KHR_materials_unlit", json!({}));
        }
        if material.ior != 1.5 && material.ior >= 1.0 && material.ior.is_finite() {
            self.extend(extensions, "KHR_materials_ior", json!({"ior": material.ior}));
        }
        let coloured = (m.base_color * (1.0 - m.metallic)).max_component();
        if material.transmission.max_component() > 0.0 && coloured > 0.0 {
            let factor = (material.transmission.max_component() / coloured).clamp(0.0, 1.0);
            self.extend(extensions, "KHR_materials_transmission", json!({"transmissionFactor": factor}));
        }
        if material.absorption != LinearRgb::BLACK {
            let color = material.absorption.map(|a| (-a).exp()).to_array().map(f64::from);
            let volume = json!({"thicknessFactor": 1.0, "attenuationDistance": 1.0, "attenuationColor": numbers(&color)});
            self.extend(extensions, "KHR_materials_volume", volume);
        }
        if material.mirror != LinearRgb::BLACK {
            self.output
                .warn(format!("material {:?}: glTF has no mirror coefficient; left out", material.name));
        }
    }

    fn extend(&mut self, extensions: &mut Map<String, Value>, name: &'static str, value: Value) {
        set(extensions, name, value);
        self.output.extensions.insert(name);
    }

    fn texture(
        &mut self,
        json: &mut Map<String, Value>,
        key: &str,
        texture: Option<TextureRef>,
        factor: &str,
    ) {
        let Some(texture) = texture.filter(|t| t.texture.index() < self.textures) else { return };
        let mut info = json!({"index": texture.texture.0});
        if texture.texcoord != 0 {
            info["texCoord"] = json!(texture.texcoord);
        }
        if !factor.is_empty() && texture.strength != 1.0 && texture.strength.is_finite() {
            info[factor] = json!(texture.strength);
        }
        if texture.uv_transform != Mat3::IDENTITY && texture.uv_transform.is_finite() {
            info["extensions"] = json!({"KHR_texture_transform": self.uv_transform(&texture.uv_transform)});
            self.output.extensions.insert("KHR_texture_transform");
        }
        set(json, key, info);
    }

    /// Offset, rotation and scale of a matrix (see the reader for the sense of rotation).
    fn uv_transform(&mut self, matrix: &Mat3) -> Value {
        let (x, y, offset) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
        if x.y == 0.0 && y.x == 0.0 {
            return json!({"offset": [offset.x, offset.y], "scale": [x.x, y.y]});
        }
        let rotation = (-x.y).atan2(x.x);
        let across = y.x * rotation.sin() + y.y * rotation.cos();
        if x.truncate().dot(y.truncate()).abs() > 1e-4 * x.truncate().length() * y.truncate().length() {
            self.output.warn("a texture transform with shear is written without it".to_owned());
        }
        json!({"offset": [offset.x, offset.y], "rotation": rotation, "scale": [x.truncate().length(), across]})
    }
}

/// Components in [0, 1].
fn unit(color: LinearRgb) -> [f32; 3] {
    color.to_array().map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 0.0 })
}

/// A picture as PNG, with 8 bits a channel. Floats are encoded as sRGB unless they are data.
fn png(data: &ImageData, is_linear: bool) -> Result<Vec<u8>, String> {
    let (width, height) = data.size();
    let texels = match data {
        ImageData::Rgba8 { texels, .. } => texels.clone(),
        ImageData::RgbaF32 { texels, .. } => texels.iter().map(|t| texel(*t, is_linear)).collect(),
    };
    if texels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(format!("{} texels are not {width} x {height}", texels.len()));
    }
    let opaque = texels.iter().all(|t| t[3] == 255);
    let bytes: Vec<u8> = if opaque {
        texels.iter().flat_map(|t| [t[0], t[1], t[2]]).collect()
    } else {
        texels.into_flattened()
    };
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
    writer.write_image_data(&bytes).map_err(|error| error.to_string())?;
    writer.finish().map_err(|error| error.to_string())?;
    Ok(file)
}

fn texel([r, g, b, a]: [f32; 4], is_linear: bool) -> [u8; 4] {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let color = |v: f32| if is_linear { byte(v) } else { byte(srgb_from_linear(v.clamp(0.0, 1.0))) };
    [color(r), color(g), color(b), byte(a)]
}
