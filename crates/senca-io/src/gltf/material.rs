//! Materials (glTF 2.0, section 3.9) with their extensions.

use std::collections::BTreeSet;

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{Mat3, Vec2};
use senca_scene::{AlphaMode, ColorSpace, Material, MetallicRoughness, Reflection, TextureId, TextureRef};

use super::document::Document;
use super::json;
use super::specular_glossiness;
use super::texture::Textures;

/// Reads all materials, in the order of the file.
pub(super) fn read_all<'d>(document: &'d Document<'_>, textures: &mut Textures<'d>) -> Vec<Material> {
    let materials = document.root.materials.iter().enumerate();
    materials
        .map(|(i, json)| {
            let (place, sets) = (format!("materials[{i}]"), coordinate_sets(json));
            Reader { document, textures, place, sets }.read(json)
        })
        .collect()
}

/// Which of the file's sets of texture coordinates are the two that a mesh has, for surfaces of this
/// material: the first two of those that it names, or 0 and 1 when they are enough.
pub(super) fn coordinate_sets(json: &json::Material) -> [u64; 2] {
    let reflection = json.pbr_metallic_roughness.as_deref();
    let coat = json.extensions.as_deref().and_then(|e| e.specular_glossiness.as_ref());
    let infos = [
        reflection.and_then(|r| r.base_color_texture.as_deref()),
        reflection.and_then(|r| r.metallic_roughness_texture.as_deref()),
        coat.and_then(|c| c.diffuse_texture.as_deref()),
        coat.and_then(|c| c.specular_glossiness_texture.as_deref()),
        json.normal_texture.as_deref(),
        json.occlusion_texture.as_deref(),
        json.emissive_texture.as_deref(),
    ];
    let named: BTreeSet<u64> = infos.into_iter().flatten().map(coordinate_set).collect();
    if named.iter().all(|&set| set <= 1) {
        return [0, 1];
    }
    let mut named = named.into_iter();
    let first = named.next().unwrap_or(0);
    [first, named.next().unwrap_or(1)]
}

fn coordinate_set(info: &json::TextureInfo) -> u64 {
    info.extensions.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(info.tex_coord).0
}

/// Reads one material.
pub(super) struct Reader<'t, 'd> {
    pub(super) document: &'d Document<'d>,
    pub(super) textures: &'t mut Textures<'d>,
    pub(super) place: String,
    /// See [`coordinate_sets`].
    pub(super) sets: [u64; 2],
}

impl Reader<'_, '_> {
    fn read(&mut self, json: &json::Material) -> Material {
        let none = json::MaterialExtensions::default();
        let extensions = json.extensions.as_deref().unwrap_or(&none);
        let reflection = match (&extensions.specular_glossiness, &json.pbr_metallic_roughness) {
            (Some(json), _) => specular_glossiness::read(self, json),
            (None, Some(json)) => self.metallic_roughness(json),
            (None, None) => MetallicRoughness::default(),
        };
        let strength = extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength).unwrap_or(1.0);
        let factor = json.emissive_factor.as_deref().map(|c| c.map(|v| v * strength.max(0.0)));
        let mut material = Material {
            name: json.name.clone(),
            emission: self.color("emissiveFactor", factor, 0.0),
            emission_texture: self.texture(
                "emissiveTexture",
                json.emissive_texture.as_deref(),
                ColorSpace::Srgb,
            ),
            normal_texture: self.texture("normalTexture", json.normal_texture.as_deref(), ColorSpace::Linear),
            occlusion_texture: self.texture(
                "occlusionTexture",
                json.occlusion_texture.as_deref(),
                ColorSpace::Linear,
            ),
            alpha_mode: self.alpha_mode(json),
            double_sided: json.double_sided,
            unlit: extensions.unlit.is_some(),
            ..Material::default()
        };
        if let Some(ior) = extensions.ior.as_ref().and_then(|i| i.ior) {
            material.ior = self.ior(ior);
        }
        if let Some(json) = &extensions.transmission {
            material.transmission = self.transmission(json, &reflection);
            material.fresnel = true;
        }
        if let Some(json) = &extensions.volume {
            material.absorption = self.absorption(json);
        }
        material.reflection = Reflection::MetallicRoughness(reflection);
        material
    }

    fn metallic_roughness(&mut self, json: &json::MetallicRoughness) -> MetallicRoughness {
        let (base_color, alpha) = self.color_alpha("baseColorFactor", json.base_color_factor);
        let place = "pbrMetallicRoughness";
        MetallicRoughness {
            base_color,
            alpha,
            metallic: self.factor("metallicFactor", json.metallic_factor, 1.0),
            roughness: self.factor("roughnessFactor", json.roughness_factor, 1.0),
            base_color_texture: self.texture(
                &format!("{place}.baseColorTexture"),
                json.base_color_texture.as_deref(),
                ColorSpace::Srgb,
            ),
            metallic_roughness_texture: self.texture(
                &format!("{place}.metallicRoughnessTexture"),
                json.metallic_roughness_texture.as_deref(),
                ColorSpace::Linear,
            ),
        }
    }

    /// Light that goes through is coloured by the base colour; metal lets none through
    /// (KHR_materials_transmission).
    fn transmission(&mut self, json: &json::Transmission, reflection: &MetallicRoughness) -> LinearRgb {
        if json.transmission_texture.is_some() {
            let place = &self.place;
            self.document.warn(format!("{place}: transmissionTexture is not read; its factor alone counts"));
        }
        let factor = self.factor("transmissionFactor", Some(json.transmission_factor), 0.0);
        reflection.base_color * (factor * (1.0 - reflection.metallic))
    }

    /// What the attenuation of a volume takes away per unit of length: light keeps the attenuation
    /// colour over the attenuation distance (KHR_materials_volume). Without thickness the surface is a
    /// thin wall, which has no inside.
    fn absorption(&self, json: &json::Volume) -> LinearRgb {
        let distance = json.attenuation_distance.filter(|d| *d > 0.0 && d.is_finite());
        let Some(distance) = distance.filter(|_| json.thickness_factor > 0.0) else {
            return LinearRgb::BLACK;
        };
        // Black would take everything away at once; a hundred-thousandth is left of it.
        let color = self.color("attenuationColor", json.attenuation_color, 1.0).map(|c| c.clamp(1e-5, 1.0));
        color.map(|c| (-f64::from(c).ln() / distance).min(f64::from(f32::MAX)) as f32)
    }

    /// 0 stands for a mirror without refraction, which an enormous index comes close to.
    fn ior(&self, ior: f64) -> f32 {
        if ior == 0.0 {
            return 1e6;
        }
        if (1.0..1e6).contains(&ior) {
            return ior as f32;
        }
        self.document
            .warn(format!("{}: an index of refraction of {ior} is not possible; 1.5 is used", self.place));
        1.5
    }

    fn alpha_mode(&self, json: &json::Material) -> AlphaMode {
        match json.alpha_mode.as_deref() {
            None | Some("OPAQUE") => AlphaMode::Opaque,
            Some("MASK") => {
                let cutoff = json.alpha_cutoff.unwrap_or(0.5).max(0.0);
                let [cutoff] = self.document.floats(&self.place, [cutoff], [0.5]);
                AlphaMode::Mask { cutoff }
            }
            Some("BLEND") => AlphaMode::Blend,
            Some(other) => {
                self.document
                    .warn(format!("{}.alphaMode: {other:?} is not known; OPAQUE is used", self.place));
                AlphaMode::Opaque
            }
        }
    }

    /// A factor in [0, 1].
    pub(super) fn factor(&self, name: &str, value: Option<f64>, default: f32) -> f32 {
        let Some(value) = value else { return default };
        if !(0.0..=1.0).contains(&value) {
            self.document.warn(format!("{}.{name}: {value} is outside of 0 to 1", self.place));
        }
        value.clamp(0.0, 1.0) as f32
    }

    /// A colour with components >= 0.
    pub(super) fn color(&self, name: &str, value: Option<[f64; 3]>, default: f32) -> LinearRgb {
        let Some(value) = value else { return LinearRgb::splat(default) };
        let place = format!("{}.{name}", self.place);
        LinearRgb::from_array(self.document.floats(&place, value.map(|v| v.max(0.0)), [default; 3]))
    }

    /// A colour and an alpha in [0, 1]; white and 1 when absent.
    pub(super) fn color_alpha(&self, name: &str, value: Option<[f64; 4]>) -> (LinearRgb, f32) {
        let Some([r, g, b, a]) = value else { return (LinearRgb::WHITE, 1.0) };
        (self.color(name, Some([r, g, b]), 1.0), self.factor(name, Some(a), 1.0))
    }

    /// The use of a texture; `None` when there is none or its picture cannot be had.
    pub(super) fn texture(
        &mut self,
        name: &str,
        info: Option<&json::TextureInfo>,
        space: ColorSpace,
    ) -> Option<TextureRef> {
        let info = info?;
        let place = format!("{}.{name}", self.place);
        let count = self.document.root.textures.len();
        let index =
            self.document.index_or_warn(format_args!("{place}.index"), info.index, "texture", count)?;
        let transform = info.extensions.transform.as_ref();
        let set = coordinate_set(info);
        let Some(texcoord) = self.sets.iter().position(|&known| known == set) else {
            let message = format!("{place}.texCoord: set {set} is the third of this material; left out");
            self.document.warn(message);
            return None;
        };
        let texture = self.textures.get(self.document, index as usize, space)?;
        let strength = info.scale.or(info.strength).unwrap_or(1.0);
        let [strength] = self.document.floats(&place, [strength], [1.0]);
        let uv_transform = transform.map_or(Mat3::IDENTITY, |t| uv_transform(self.document, &place, t));
        Some(TextureRef { texture: TextureId(texture), texcoord: texcoord as u32, uv_transform, strength })
    }
}

/// Scale, then rotate, then move (KHR_texture_transform).
///
/// The extension's text gives a matrix that turns one way and an example that turns the other. The
/// example ("the lower left quadrant, rotated clockwise") agrees with the sentence that the picture
/// turns clockwise and with what viewers do: u' = u cos + v sin, v' = v cos - u sin.
fn uv_transform(document: &Document<'_>, place: &str, json: &json::TextureTransform) -> Mat3 {
    let offset = document.floats(place, json.offset.unwrap_or([0.0; 2]), [0.0; 2]);
    let scale = document.floats(place, json.scale.unwrap_or([1.0; 2]), [1.0; 2]);
    let [rotation] = document.floats(place, [json.rotation], [0.0]);
    Mat3::from_translation(Vec2::from_array(offset))
        * Mat3::from_angle(-rotation)
        * Mat3::from_scale(Vec2::from_array(scale))
}
