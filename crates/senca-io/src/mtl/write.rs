//! From materials to a library with its pictures.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::Vec3;
use senca_scene::{ImageData, ImageId, Material, Reflection, Scene, TextureRef, Wrap};

use crate::WriteError;

/// A name of one word for each material, no two equal.
pub(crate) fn unique_names(materials: &[Material]) -> Vec<String> {
    let mut used = HashSet::new();
    let name = |(i, material): (usize, &Material)| {
        let clean: String = material
            .name
            .trim()
            .chars()
            .map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c })
            .collect();
        let base = if clean.is_empty() { format!("material_{i}") } else { clean };
        let mut name = base.clone();
        let mut number = 1u32;
        while !used.insert(name.clone()) {
            number += 1;
            name = format!("{base}_{number}");
        }
        name
    };
    materials.iter().enumerate().map(name).collect()
}

/// Pictures with their file names.
pub(crate) type NamedPictures = Vec<(String, Vec<u8>)>;

/// Writes the library; pictures are named `stem` and a number.
pub(crate) fn write(
    scene: &Scene,
    names: &[String],
    stem: &str,
) -> Result<(Vec<u8>, NamedPictures), WriteError> {
    let mut library =
        Library { scene, stem, text: String::new(), pictures: Vec::new(), file_of_image: HashMap::new() };
    for (material, name) in scene.materials.iter().zip(names) {
        let _ = writeln!(library.text, "newmtl {name}");
        library.material(material)?;
        library.text.push('\n');
    }
    Ok((library.text.into_bytes(), library.pictures))
}

struct Library<'a> {
    scene: &'a Scene,
    stem: &'a str,
    text: String,
    pictures: NamedPictures,
    file_of_image: HashMap<ImageId, String>,
}

impl Library<'_> {
    fn color(&mut self, key: &str, color: LinearRgb) {
        let _ = writeln!(self.text, "{key} {} {} {}", color.r, color.g, color.b);
    }

    fn number(&mut self, key: &str, value: f32) {
        let _ = writeln!(self.text, "{key} {value}");
    }

    fn material(&mut self, material: &Material) -> Result<(), WriteError> {
        let alpha = match &material.reflection {
            Reflection::Phong(phong) => {
                self.color("Ka", phong.ambient);
                self.color("Kd", phong.diffuse);
                self.color("Ks", phong.specular);
                self.number("Ns", phong.exponent);
                self.map("map_Kd", phong.texture)?;
                self.map("map_Ks", phong.specular_texture)?;
                phong.alpha
            }
            Reflection::MetallicRoughness(physical) => {
                self.color("Kd", physical.base_color);
                self.number("Pm", physical.metallic);
                self.number("Pr", physical.roughness);
                self.map("map_Kd", physical.base_color_texture)?;
                physical.alpha
            }
        };
        self.number("d", alpha);
        self.number("Ni", material.ior);
        if material.emission != LinearRgb::BLACK {
            self.color("Ke", material.emission);
        }
        self.map("map_Ke", material.emission_texture)?;
        self.map("norm", material.normal_texture)?;
        let transmits = material.transmission != LinearRgb::BLACK;
        if transmits {
            self.color("Tf", material.transmission);
        }
        let illum = match (material.unlit, transmits, material.mirror != LinearRgb::BLACK) {
            (true, ..) => 0,
            (_, true, _) => 6,
            (_, _, true) => 3,
            _ => 2,
        };
        let _ = writeln!(self.text, "illum {illum}");
        Ok(())
    }

    fn map(&mut self, key: &str, reference: Option<TextureRef>) -> Result<(), WriteError> {
        let Some(reference) = reference else { return Ok(()) };
        let Some(texture) = self.scene.textures.get(reference.texture.index()) else { return Ok(()) };
        let Some(file) = self.picture(texture.image)? else { return Ok(()) };
        let (clamp, options) = (texture.wrap_u == Wrap::Clamp, options(&reference));
        let clamp = if clamp { " -clamp on" } else { "" };
        let _ = writeln!(self.text, "{key}{options}{clamp} {file}");
        Ok(())
    }

    /// File of a picture, encoded when it is first asked for.
    fn picture(&mut self, image: ImageId) -> Result<Option<String>, WriteError> {
        if let Some(file) = self.file_of_image.get(&image) {
            return Ok(Some(file.clone()));
        }
        let Some(picture) = self.scene.images.get(image.index()) else { return Ok(None) };
        let file = format!("{}_{}.png", self.stem.replace(char::is_whitespace, "_"), self.pictures.len());
        self.pictures.push((file.clone(), png(&picture.data)?));
        self.file_of_image.insert(image, file.clone());
        Ok(Some(file))
    }
}

/// Scale and offset, with v from the bottom, and the strength of bumps.
fn options(reference: &TextureRef) -> String {
    let mut text = String::new();
    let m = reference.uv_transform;
    let (scale, offset) = ([m.x_axis.x, m.y_axis.y], [m.z_axis.x, 1.0 - m.y_axis.y - m.z_axis.y]);
    let plain = Vec3::new(m.x_axis.y, m.y_axis.x, 0.0) == Vec3::ZERO;
    if plain && scale != [1.0, 1.0] {
        let _ = write!(text, " -s {} {} 1", scale[0], scale[1]);
    }
    if plain && offset != [0.0, 0.0] {
        let _ = write!(text, " -o {} {} 0", offset[0], offset[1]);
    }
    if reference.strength != 1.0 {
        let _ = write!(text, " -bm {}", reference.strength);
    }
    text
}

/// An 8-bit PNG; float pictures are encoded in sRGB.
fn png(data: &ImageData) -> Result<Vec<u8>, WriteError> {
    let (width, height) = data.size();
    let texels: Vec<u8> = match data {
        ImageData::Rgba8 { texels, .. } => texels.as_flattened().to_vec(),
        ImageData::RgbaF32 { texels, .. } => texels
            .iter()
            .flat_map(|&[r, g, b, a]| {
                let color = LinearRgb::new(r, g, b).to_srgb8();
                [color.r, color.g, color.b, (a.clamp(0.0, 1.0) * 255.0 + 0.5) as u8]
            })
            .collect(),
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let failed = |error: png::EncodingError| WriteError::Encode { message: format!("a texture: {error}") };
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&texels)).map_err(failed)?;
    Ok(bytes)
}
