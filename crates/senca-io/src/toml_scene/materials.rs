//! Materials and textures.

use senca_math::LinearRgb;
use senca_math::glam::{Mat3, Vec2};
use senca_scene::{
    AlphaMode, ColorSpace, Filter, ImageData, ImageId, Material, MaterialId, MetallicRoughness, Phong,
    Reflection, Texture, TextureId, TextureImage, TextureRef, Wrap,
};

use super::builder::Builder;
use super::names::hint;
use super::source::{Result, Table};
use super::values::Value;
use crate::images;

const PHONG_KEYS: [&str; 7] =
    ["color", "ambient", "diffuse", "specular", "exponent", "texture", "specular_texture"];

const METALLIC_KEYS: [&str; 5] =
    ["base_color", "metallic", "roughness", "base_color_texture", "metallic_roughness_texture"];

impl<'a> Builder<'a> {
    /// Reads the tables `[texture.NAME]`.
    pub(super) fn read_textures(&mut self, root: &mut Table<'a>) -> Result<()> {
        for (name, mut table) in root.named("texture")? {
            let id = self.read_texture(name, &mut table)?;
            table.finish()?;
            self.texture_of.insert(name, id);
        }
        Ok(())
    }

    /// Reads the tables `[material.NAME]`.
    pub(super) fn read_materials(&mut self, root: &mut Table<'a>) -> Result<()> {
        for (name, mut table) in root.named("material")? {
            let material = self.read_material(name, &mut table)?;
            table.finish()?;
            let id = self.scene.add_material(material);
            self.material_of.insert(name, id);
        }
        Ok(())
    }

    /// The material that a value names, or describes in braces.
    pub(super) fn material(&mut self, value: Value<'a>) -> Result<MaterialId> {
        if value.is_table() {
            let mut table = value.table("the material")?;
            let material = self.read_material("", &mut table)?;
            table.finish()?;
            return Ok(self.scene.add_material(material));
        }
        let name = value.string()?;
        self.material_of.get(name).copied().ok_or_else(|| {
            let defined: Vec<&str> = self.material_of.keys().copied().collect();
            value.error(format!("material \"{name}\" is not defined{}", hint(name, &defined)))
        })
    }

    fn read_material(&mut self, name: &str, table: &mut Table<'a>) -> Result<Material> {
        let reflection = self.read_reflection(table)?;
        let alpha = match &reflection {
            Reflection::Phong(phong) => phong.alpha,
            Reflection::MetallicRoughness(metallic) => metallic.alpha,
        };
        Ok(Material {
            name: name.to_owned(),
            reflection,
            emission: table.read_or("emission", LinearRgb::BLACK, Value::color)?,
            emission_texture: self.texture_ref(table, "emission_texture", ColorSpace::Srgb)?,
            normal_texture: self.texture_ref(table, "normal_texture", ColorSpace::Linear)?,
            occlusion_texture: self.texture_ref(table, "occlusion_texture", ColorSpace::Linear)?,
            alpha_mode: alpha_mode(table, alpha)?,
            double_sided: table.read_or("double_sided", false, Value::boolean)?,
            unlit: table.read_or("unlit", false, Value::boolean)?,
            mirror: table.read_or("mirror", LinearRgb::BLACK, Value::reflectance)?,
            transmission: table.read_or("transmission", LinearRgb::BLACK, Value::reflectance)?,
            ior: table.read_or("ior", 1.5, Value::positive)? as f32,
            fresnel: table.read_or("fresnel", false, Value::boolean)?,
            absorption: table.read_or("absorption", LinearRgb::BLACK, Value::color)?,
        })
    }

    /// Which model a material follows is told by its keys.
    fn read_reflection(&mut self, table: &mut Table<'a>) -> Result<Reflection> {
        let Some(key) = table.first_of(&METALLIC_KEYS) else {
            return self.read_phong(table).map(Reflection::Phong);
        };
        if let Some(other) = table.first_of(&PHONG_KEYS) {
            let message = format!(
                "{} mixes two models: \"{other}\" is of the Phong model, \"{key}\" of the \
                 metallic-roughness model",
                table.what()
            );
            return Err(match table.get(other) {
                Some(value) => value.error(message),
                None => table.error(message),
            });
        }
        self.read_metallic(table).map(Reflection::MetallicRoughness)
    }

    fn read_phong(&mut self, table: &mut Table<'a>) -> Result<Phong> {
        let default = Phong::default();
        let color = table.read("color", Value::reflectance)?;
        let diffuse = table.read_or("diffuse", color.unwrap_or(default.diffuse), Value::reflectance)?;
        Ok(Phong {
            ambient: table.read_or("ambient", color.unwrap_or(diffuse), Value::reflectance)?,
            diffuse,
            specular: table.read_or("specular", default.specular, Value::reflectance)?,
            exponent: table.read_or("exponent", f64::from(default.exponent), Value::not_negative)? as f32,
            alpha: table.read_or("alpha", 1.0, Value::share)? as f32,
            texture: self.texture_ref(table, "texture", ColorSpace::Srgb)?,
            specular_texture: self.texture_ref(table, "specular_texture", ColorSpace::Srgb)?,
        })
    }

    fn read_metallic(&mut self, table: &mut Table<'a>) -> Result<MetallicRoughness> {
        Ok(MetallicRoughness {
            base_color: table.read_or("base_color", LinearRgb::WHITE, Value::reflectance)?,
            alpha: table.read_or("alpha", 1.0, Value::share)? as f32,
            metallic: table.read_or("metallic", 0.0, Value::share)? as f32,
            roughness: table.read_or("roughness", 0.5, Value::share)? as f32,
            base_color_texture: self.texture_ref(table, "base_color_texture", ColorSpace::Srgb)?,
            metallic_roughness_texture: self.texture_ref(
                table,
                "metallic_roughness_texture",
                ColorSpace::Linear,
            )?,
        })
    }

    /// A texture by name, or a table with `name` or `file` and how it is laid on.
    fn texture_ref(
        &mut self,
        table: &mut Table<'a>,
        key: &'static str,
        space: ColorSpace,
    ) -> Result<Option<TextureRef>> {
        let Some(value) = table.get(key) else { return Ok(None) };
        if !value.is_table() {
            return Ok(Some(TextureRef::new(self.named_texture(value)?)));
        }
        let mut table = value.table("the texture")?;
        let texture = match table.get("name") {
            Some(name) => self.named_texture(name)?,
            None => self.read_texture_in(space, "", &mut table)?,
        };
        let texcoord = table.read_or("texcoord", 0, |value| value.whole(0, 1))?;
        let strength = table.read_or("strength", 1.0, Value::number)? as f32;
        let uv_transform = uv_transform(&mut table)?;
        table.finish()?;
        Ok(Some(TextureRef { texture, texcoord, uv_transform, strength }))
    }

    fn named_texture(&self, value: Value<'a>) -> Result<TextureId> {
        let name = value.string()?;
        self.texture_of.get(name).copied().ok_or_else(|| {
            let defined: Vec<&str> = self.texture_of.keys().copied().collect();
            let file = if name.contains('.') {
                format!(" (for a file write {{ file = \"{name}\" }})")
            } else {
                String::new()
            };
            value.error(format!("texture \"{name}\" is not defined{file}{}", hint(name, &defined)))
        })
    }

    fn read_texture(&mut self, name: &str, table: &mut Table<'a>) -> Result<TextureId> {
        let space = [("srgb", ColorSpace::Srgb), ("linear", ColorSpace::Linear)];
        let space = table.read_or("color_space", ColorSpace::Srgb, |value| value.choice(&space))?;
        self.read_texture_in(space, name, table)
    }

    /// A texture from `file` or `texels`. `space` matters to 16-bit files only.
    fn read_texture_in(&mut self, space: ColorSpace, name: &str, table: &mut Table<'a>) -> Result<TextureId> {
        let image = match (table.get("file"), table.get("texels")) {
            (Some(file), None) => self.image_file(file, space)?,
            (None, Some(value)) => {
                let data = texels(value, self.limits.image_texels)?;
                self.scene.images.push(TextureImage { name: name.to_owned(), data });
                ImageId(self.scene.images.len() as u32 - 1)
            }
            (Some(_), Some(value)) => {
                return Err(value.error("give either \"file\" or \"texels\", not both"));
            }
            (None, None) => {
                return Err(table.error(format!("{} needs \"file\" or \"texels\"", table.what())));
            }
        };
        let (wrap_u, wrap_v) = table.read_or("wrap", Default::default(), wrap)?;
        let filter = table.read_or("filter", Filter::default(), |value| value.choice(&FILTERS))?;
        self.scene.textures.push(Texture { name: name.to_owned(), image, wrap_u, wrap_v, filter });
        Ok(TextureId(self.scene.textures.len() as u32 - 1))
    }

    /// The picture file that a value names; each file is read once.
    pub(super) fn image_file(&mut self, value: Value<'a>, space: ColorSpace) -> Result<ImageId> {
        let uri = value.string()?;
        if let Some(&id) = self.image_of.get(&(uri, space == ColorSpace::Srgb)) {
            return Ok(id);
        }
        let bytes = self.files.read(uri).map_err(|error| super::builder::located(&value, error))?;
        let data = images::decode_as(uri, &bytes, &self.limits, space)?;
        self.scene.images.push(TextureImage { name: uri.to_owned(), data });
        let id = ImageId(self.scene.images.len() as u32 - 1);
        self.image_of.insert((uri, space == ColorSpace::Srgb), id);
        Ok(id)
    }
}

/// What alpha means: as said, or blending where `alpha` is below 1.
fn alpha_mode(table: &mut Table<'_>, alpha: f32) -> Result<AlphaMode> {
    let modes = [("opaque", 0), ("mask", 1), ("blend", 2)];
    let mode = table.read_or("alpha_mode", if alpha < 1.0 { 2 } else { 0 }, |value| value.choice(&modes))?;
    let cutoff_value = table.get("cutoff");
    match (mode, cutoff_value) {
        (1, None) => Ok(AlphaMode::Mask { cutoff: 0.5 }),
        (1, Some(value)) => Ok(AlphaMode::Mask { cutoff: value.share()? as f32 }),
        (_, Some(value)) => Err(value.refuse("only has a meaning with alpha_mode = \"mask\"")),
        (0, None) => Ok(AlphaMode::Opaque),
        (_, None) => Ok(AlphaMode::Blend),
    }
}

/// `scale`, then `rotate` (degrees), then `offset` of texture coordinates.
fn uv_transform(table: &mut Table<'_>) -> Result<Mat3> {
    let scale = |value: Value<'_>| {
        let scale = if value.is_number() { [value.number()?; 2].into() } else { value.vec2()? };
        Ok(scale.as_vec2())
    };
    let scale = table.read_or("scale", Vec2::ONE, scale)?;
    let rotation = table.read_or("rotate", 0.0, Value::number)?.to_radians() as f32;
    let offset = table.read_or("offset", Vec2::ZERO, |value| Ok(value.vec2()?.as_vec2()))?;
    Ok(Mat3::from_scale_angle_translation(scale, rotation, offset))
}

const WRAPS: [(&str, Wrap); 3] = [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)];

const FILTERS: [(&str, Filter); 4] = [
    ("nearest", Filter::Nearest),
    ("bilinear", Filter::Bilinear),
    ("footprint", Filter::Footprint),
    ("trilinear", Filter::Trilinear),
];

/// One word for both directions, or `[u, v]`.
fn wrap(value: Value<'_>) -> Result<(Wrap, Wrap)> {
    if value.is_list() {
        let [u, v] = value.array("a word or a list of two", |v| v.choice(&WRAPS))?;
        return Ok((u, v));
    }
    let both = value.choice(&WRAPS)?;
    Ok((both, both))
}

/// Rows of colours, the top row first.
fn texels(value: Value<'_>, limit: u64) -> Result<ImageData> {
    let rows = value.list("a list of rows of colours", |row| {
        row.list("a row of colours", |texel| {
            let color = texel.color()?;
            Ok([color.r, color.g, color.b, 1.0])
        })
    })?;
    let width = rows.first().map_or(0, Vec::len);
    if width == 0 || rows.iter().any(|row| row.len() != width) {
        return Err(value.refuse("needs at least one row, and as many colours in each row"));
    }
    if (width * rows.len()) as u64 > limit {
        return Err(value.source.limit(&value.span(), format!("more than the limit of {limit} texels")));
    }
    Ok(ImageData::RgbaF32 { width: width as u32, height: rows.len() as u32, texels: rows.concat() })
}
