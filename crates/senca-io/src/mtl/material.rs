//! From the statements of a material to a material of the scene.

use senca_scene::math::LinearRgb;
use senca_scene::{AlphaMode, Material, MaterialId, MetallicRoughness, Phong, Reflection, Scene, TextureRef};

use super::pictures::Pictures;
use super::{Entry, Slot};

/// Adds `entry` to `scene` with the pictures that it names.
pub(super) fn add(entry: &Entry, scene: &mut Scene, pictures: &mut Pictures<'_>) -> MaterialId {
    let texture = pictures.base(entry.maps.get(&Slot::Diffuse), entry.maps.get(&Slot::Alpha), scene);
    let has_alpha_map = texture.is_some() && entry.maps.contains_key(&Slot::Alpha);
    let alpha = opacity(entry);
    let illum = entry.illum.unwrap_or(2);
    let physical = [Slot::Roughness, Slot::Metallic].iter().any(|slot| entry.maps.contains_key(slot));
    let reflection = if physical || entry.pr.is_some() || entry.pm.is_some() {
        metallic_roughness(entry, alpha, texture, scene, pictures)
    } else {
        phong(entry, alpha, texture, scene, pictures)
    };
    let emission_texture = pictures.color(entry.maps.get(&Slot::Emission), scene);
    let default_emission = if emission_texture.is_some() { LinearRgb::WHITE } else { LinearRgb::BLACK };
    let normal_texture = pictures.normals(entry.maps.get(&Slot::Normal), entry.maps.get(&Slot::Bump), scene);
    let occlusion_texture = pictures.data(entry.maps.get(&Slot::Occlusion), scene);
    let see_through = alpha < 1.0 || has_alpha_map;
    scene.add_material(Material {
        name: entry.name.clone(),
        reflection,
        emission: nonnegative(entry.ke.unwrap_or(default_emission)),
        emission_texture,
        normal_texture,
        occlusion_texture,
        alpha_mode: if see_through { AlphaMode::Blend } else { AlphaMode::Opaque },
        // The format knows no sides, and its models are often open.
        double_sided: true,
        unlit: illum == 0,
        mirror: if matches!(illum, 3..=7 | 9) { specular(entry) } else { LinearRgb::BLACK },
        transmission: transmission(entry, illum, alpha),
        ior: entry.ni.filter(|&ni| ni > 0.0).unwrap_or(1.5),
        fresnel: matches!(illum, 5 | 7),
        absorption: LinearRgb::BLACK,
    })
}

/// `d`, or what `Tr` leaves.
fn opacity(entry: &Entry) -> f32 {
    entry.d.or(entry.tr.map(|tr| 1.0 - tr)).unwrap_or(1.0).clamp(0.0, 1.0)
}

fn unit(color: LinearRgb) -> LinearRgb {
    color.map(|v| v.clamp(0.0, 1.0))
}

fn nonnegative(color: LinearRgb) -> LinearRgb {
    color.map(|v| v.max(0.0))
}

fn specular(entry: &Entry) -> LinearRgb {
    unit(entry.ks.unwrap_or(LinearRgb::BLACK))
}

fn diffuse(entry: &Entry, texture: Option<TextureRef>) -> LinearRgb {
    let default = if texture.is_some() { LinearRgb::WHITE } else { LinearRgb::splat(0.8) };
    unit(entry.kd.unwrap_or(default))
}

fn transmission(entry: &Entry, illum: i64, alpha: f32) -> LinearRgb {
    match illum {
        4 | 6 | 7 | 9 => unit(entry.tf.unwrap_or(LinearRgb::splat(1.0 - alpha))),
        _ => LinearRgb::BLACK,
    }
}

fn phong(
    entry: &Entry,
    alpha: f32,
    texture: Option<TextureRef>,
    scene: &mut Scene,
    pictures: &mut Pictures<'_>,
) -> Reflection {
    let diffuse = diffuse(entry, texture);
    let specular_texture = pictures.color(entry.maps.get(&Slot::Specular), scene);
    let default_specular = if specular_texture.is_some() { LinearRgb::WHITE } else { LinearRgb::BLACK };
    let without_highlight = matches!(entry.illum, Some(0 | 1));
    Reflection::Phong(Phong {
        ambient: entry.ka.map_or(diffuse, unit),
        diffuse,
        specular: if without_highlight {
            LinearRgb::BLACK
        } else {
            unit(entry.ks.unwrap_or(default_specular))
        },
        exponent: entry.ns.unwrap_or(Phong::default().exponent).max(0.0),
        alpha,
        texture,
        specular_texture,
    })
}

fn metallic_roughness(
    entry: &Entry,
    alpha: f32,
    texture: Option<TextureRef>,
    scene: &mut Scene,
    pictures: &mut Pictures<'_>,
) -> Reflection {
    let (rough, metal) = (entry.maps.get(&Slot::Roughness), entry.maps.get(&Slot::Metallic));
    let combined = pictures.metallic_roughness(rough, metal, scene);
    let or_map = |map: bool, default: f32| if map && combined.is_some() { 1.0 } else { default };
    // The width of the highlight of a Phong exponent (Walter et al. 2007, section 5.2), rooted once more
    // because roughness is perceptual.
    let from_exponent = entry.ns.map_or(0.5, |ns| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25));
    Reflection::MetallicRoughness(MetallicRoughness {
        base_color: diffuse(entry, texture),
        alpha,
        metallic: entry.pm.unwrap_or(or_map(metal.is_some(), 0.0)).clamp(0.0, 1.0),
        roughness: entry.pr.unwrap_or(or_map(rough.is_some(), from_exponent)).clamp(0.0, 1.0),
        base_color_texture: texture,
        metallic_roughness_texture: combined,
    })
}
