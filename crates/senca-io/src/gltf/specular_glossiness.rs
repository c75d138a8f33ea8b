//! Materials of KHR_materials_pbrSpecularGlossiness as metallic-roughness.
//!
//! Both models agree on the light seen head-on: the diffuse colour is `base (1 - metallic) 0.96`
//! weakened by what the specular part takes, the specular colour `0.04 (1 - metallic) + base
//! metallic`. Given diffuse and specular brightness this is a quadratic equation for `metallic`.

use senca_scene::math::LinearRgb;
use senca_scene::math::color::{linear_from_srgb, srgb_from_linear};
use senca_scene::{
    ColorSpace, ImageData, ImageId, MetallicRoughness, Texture, TextureId, TextureImage, TextureRef,
};

use super::json;
use super::material::Reader;

/// Reflectance of a dielectric seen head-on, at an index of refraction of 1.5.
const DIELECTRIC: f32 = 0.04;

/// Conversions that are remembered; they are looked through one by one.
const MAX_SHARED: usize = 256;

/// One place of a specular-glossiness material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coat {
    diffuse: LinearRgb,
    specular: LinearRgb,
    glossiness: f32,
}

/// What two pictures were converted from, and the two they became: materials share them.
pub(super) struct ConvertedTextures {
    factor: Coat,
    diffuse: Option<TextureRef>,
    coat: TextureRef,
    result: [TextureRef; 2],
}

/// Base colour, metallic and roughness.
type Converted = (LinearRgb, f32, f32);

/// Reads the extension's object into the nearest metallic-roughness material.
pub(super) fn read(reader: &mut Reader<'_, '_>, json: &json::SpecularGlossiness) -> MetallicRoughness {
    let (diffuse, alpha) = reader.color_alpha("diffuseFactor", json.diffuse_factor);
    let coat = Coat {
        diffuse,
        specular: reader.color("specularFactor", json.specular_factor, 1.0).map(|v| v.min(1.0)),
        glossiness: reader.factor("glossinessFactor", json.glossiness_factor, 1.0),
    };
    let diffuse_texture = reader.texture("diffuseTexture", json.diffuse_texture.as_deref(), ColorSpace::Srgb);
    let name = "specularGlossinessTexture";
    let coat_texture = reader.texture(name, json.specular_glossiness_texture.as_deref(), ColorSpace::Srgb);
    if let Some(coat_texture) = coat_texture {
        if let Some(textures) = converted_textures(reader, coat, diffuse_texture, coat_texture) {
            let [base, metallic_roughness] = textures;
            return MetallicRoughness {
                alpha,
                base_color_texture: Some(base),
                metallic_roughness_texture: Some(metallic_roughness),
                ..MetallicRoughness::default()
            };
        }
        reader
            .document
            .warn(format!("{}.{name}: does not lie as diffuseTexture does; left out", reader.place));
    }
    let (base_color, metallic, roughness) = convert(coat);
    MetallicRoughness {
        base_color,
        alpha,
        metallic,
        roughness,
        base_color_texture: diffuse_texture,
        metallic_roughness_texture: None,
    }
}

fn convert(coat: Coat) -> Converted {
    let rest = 1.0 - coat.specular.max_component();
    let metallic = metallic(brightness(coat.diffuse), brightness(coat.specular), rest);
    let from_diffuse = coat.diffuse * (rest / (1.0 - DIELECTRIC) / (1.0 - metallic).max(1e-4));
    let dielectric = LinearRgb::splat(DIELECTRIC * (1.0 - metallic));
    let from_specular = (coat.specular - dielectric) * (1.0 / metallic.max(1e-4));
    let base = from_diffuse.lerp(from_specular, metallic * metallic).map(|v| v.clamp(0.0, 1.0));
    (base, metallic, 1.0 - coat.glossiness)
}

/// The metallic share at which both base colours are equally bright.
fn metallic(diffuse: f32, specular: f32, rest: f32) -> f32 {
    if specular < DIELECTRIC {
        return 0.0;
    }
    let b = diffuse * rest / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
    let c = DIELECTRIC - specular;
    let root = (b * b - 4.0 * DIELECTRIC * c).max(0.0).sqrt();
    ((root - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
}

/// Perceived brightness of a colour.
fn brightness(c: LinearRgb) -> f32 {
    (0.299 * c.r * c.r + 0.587 * c.g * c.g + 0.114 * c.b * c.b).sqrt()
}

/// The pictures of [`convert_textures`], made once for all materials that ask for the same.
fn converted_textures(
    reader: &mut Reader<'_, '_>,
    factor: Coat,
    diffuse: Option<TextureRef>,
    coat: TextureRef,
) -> Option<[TextureRef; 2]> {
    let same = |c: &&ConvertedTextures| c.factor == factor && c.diffuse == diffuse && c.coat == coat;
    if let Some(known) = reader.textures.converted.iter().find(same) {
        return Some(known.result);
    }
    let result = convert_textures(reader, factor, diffuse, coat)?;
    if reader.textures.converted.len() < MAX_SHARED {
        reader.textures.converted.push(ConvertedTextures { factor, diffuse, coat, result });
    }
    Some(result)
}

/// Base colour and metallic-roughness pictures of the two of the extension; `None` when these are
/// laid differently onto the surface or are not 8 bits deep.
fn convert_textures(
    reader: &mut Reader<'_, '_>,
    factor: Coat,
    diffuse: Option<TextureRef>,
    coat: TextureRef,
) -> Option<[TextureRef; 2]> {
    let same_place = |d: &TextureRef| d.texcoord == coat.texcoord && d.uv_transform == coat.uv_transform;
    if diffuse.is_some_and(|d| !same_place(&d)) {
        return None;
    }
    let diffuse_texels = match diffuse {
        Some(diffuse) => Texels::of(reader, diffuse)?,
        None => Texels { width: 1, height: 1, texels: &[[255; 4]] },
    };
    let coat_texels = Texels::of(reader, coat)?;
    let (width, height) =
        (diffuse_texels.width.max(coat_texels.width), diffuse_texels.height.max(coat_texels.height));
    let count = width as usize * height as usize;
    if !reader.textures.has_room_for(2 * count as u64) {
        return None;
    }
    let mut base = Vec::with_capacity(count);
    let mut metallic_roughness = Vec::with_capacity(count);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let [r, g, b, a] = diffuse_texels.at(x, y, width, height);
        let [sr, sg, sb, gloss] = coat_texels.at(x, y, width, height);
        let (color, metallic, roughness) = convert(Coat {
            diffuse: factor.diffuse * linear([r, g, b]),
            specular: factor.specular * linear([sr, sg, sb]),
            glossiness: factor.glossiness * f32::from(gloss) / 255.0,
        });
        let [r, g, b] = color.to_array().map(|v| byte(srgb_from_linear(v)));
        base.push([r, g, b, a]);
        metallic_roughness.push([255, byte(roughness), byte(metallic), 255]);
    }
    let laid_as = diffuse.unwrap_or(coat);
    Some([
        add(reader, laid_as, ImageData::Rgba8 { width, height, texels: base })?,
        add(reader, laid_as, ImageData::Rgba8 { width, height, texels: metallic_roughness })?,
    ])
}

fn linear(srgb: [u8; 3]) -> LinearRgb {
    LinearRgb::from_array(srgb.map(|v| linear_from_srgb(f32::from(v) / 255.0)))
}

fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// Adds a picture that is laid and sampled as `like` is.
fn add(reader: &mut Reader<'_, '_>, like: TextureRef, data: ImageData) -> Option<TextureRef> {
    let image = reader.textures.add_image(TextureImage { name: String::new(), data })?;
    let sampled = reader.textures.textures[like.texture.index()].clone();
    let texture = reader.textures.add(Texture { name: String::new(), image: ImageId(image), ..sampled });
    Some(TextureRef { texture: TextureId(texture), ..like })
}

/// Texels of an 8-bit picture.
#[derive(Clone, Copy)]
struct Texels<'a> {
    width: u32,
    height: u32,
    texels: &'a [[u8; 4]],
}

impl<'a> Texels<'a> {
    fn of(reader: &'a Reader<'_, '_>, texture: TextureRef) -> Option<Self> {
        let texture = reader.textures.textures.get(texture.texture.index())?;
        match &reader.textures.images.get(texture.image.index())?.data {
            ImageData::Rgba8 { width, height, texels } => {
                Some(Self { width: *width, height: *height, texels })
            }
            ImageData::RgbaF32 { .. } => None,
        }
    }

    /// The texel nearest to the place of texel `(x, y)` of a picture of `width` times `height`.
    fn at(&self, x: u32, y: u32, width: u32, height: u32) -> [u8; 4] {
        let nearest = |i: u32, from: u32, to: u32| (u64::from(i) * u64::from(to) / u64::from(from)) as usize;
        let at = nearest(y, height, self.height) * self.width as usize + nearest(x, width, self.width);
        self.texels.get(at).copied().unwrap_or([255; 4])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dielectric_keeps_its_diffuse_colour() {
        let coat = Coat {
            diffuse: LinearRgb::new(0.5, 0.2, 0.1),
            specular: LinearRgb::splat(0.04),
            glossiness: 0.7,
        };
        let (base, metallic, roughness) = convert(coat);
        assert!((base.r - 0.5).abs() < 1e-6 && (base.g - 0.2).abs() < 1e-6, "{base:?}");
        assert!(metallic.abs() < 1e-6 && (roughness - 0.3).abs() < 1e-6);
    }

    #[test]
    fn black_diffuse_with_a_coloured_mirror_is_metal() {
        let gold = LinearRgb::new(1.0, 0.77, 0.34);
        let (base, metallic, _) =
            convert(Coat { diffuse: LinearRgb::BLACK, specular: gold, glossiness: 1.0 });
        assert!((metallic - 1.0).abs() < 1e-5);
        assert!((base.g - gold.g).abs() < 1e-5 && (base.b - gold.b).abs() < 1e-5);
    }
}
