//! Materials: how a surface answers light.

use senca_math::LinearRgb;

use crate::TextureRef;

/// What a surface is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file, or empty.
    pub name: String,
    /// The reflection model with its constants.
    pub reflection: Reflection,
    /// Light given off, in linear light; may exceed 1. Default black.
    pub emission: LinearRgb,
    /// Picture that multiplies `emission`.
    pub emission_texture: Option<TextureRef>,
    /// Tangent-space normal map; the reference's `strength` scales its x and y.
    pub normal_texture: Option<TextureRef>,
    /// Occlusion of ambient light in the red channel; the reference's `strength` fades it.
    pub occlusion_texture: Option<TextureRef>,
    /// What alpha means. Default opaque.
    pub alpha_mode: AlphaMode,
    /// Whether the back is lit and drawn too. Default false.
    pub double_sided: bool,
    /// Whether light is ignored and the base colour shown as it is. Default false.
    pub unlit: bool,
    /// Part of mirrored light that is seen, k_r of the recursive tracer, per channel in [0, 1].
    /// Default black.
    pub mirror: LinearRgb,
    /// Part of transmitted light that is seen, k_t of the recursive tracer, per channel in [0, 1].
    /// Default black. Where it is not black it alone says how much a tracer sees through the surface,
    /// and `alpha` is for renderers that do not trace: see [`Material::tracer_alpha`].
    pub transmission: LinearRgb,
    /// Index of refraction of the inside, > 0. Default 1.5.
    pub ior: f32,
    /// Whether `mirror` and `transmission` are weighted by the Fresnel reflectance F of `ior` at the
    /// angle of incidence: the mirrored share is then `mirror F`, the transmitted one
    /// `transmission (1 - F)`. Otherwise both are taken as they are. Default false.
    pub fresnel: bool,
    /// Absorption of light inside the body, per channel and world unit, >= 0: over the length s the
    /// share `exp(-absorption s)` is left (Beer-Lambert). Default black, which takes nothing away.
    pub absorption: LinearRgb,
}

/// The reflection models.
#[derive(Clone, Debug, PartialEq)]
pub enum Reflection {
    /// Ambient, diffuse and specular coefficients (course text, section 2.5).
    Phong(Phong),
    /// Metallic-roughness as in glTF 2.0.
    MetallicRoughness(MetallicRoughness),
}

/// Coefficients of the Phong reflection model (course text, section 2.5, eq. 2.2).
#[derive(Clone, Debug, PartialEq)]
pub struct Phong {
    /// Oa, per channel in [0, 1]. Default equal to `diffuse`.
    pub ambient: LinearRgb,
    /// Od, per channel in [0, 1]. Default 0.8.
    pub diffuse: LinearRgb,
    /// Os, per channel in [0, 1]. Default 0.
    pub specular: LinearRgb,
    /// Exponent n of the highlight, >= 0, usually 1 to 200. Default 20.
    pub exponent: f32,
    /// Opacity in [0, 1]. Default 1.
    pub alpha: f32,
    /// Picture that multiplies `ambient`, `diffuse` and `alpha`.
    pub texture: Option<TextureRef>,
    /// Picture that multiplies `specular`.
    pub specular_texture: Option<TextureRef>,
}

/// Metallic-roughness material (glTF 2.0, section 3.9).
#[derive(Clone, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Colour of the diffuse part, or of the mirror of a metal. Default white.
    pub base_color: LinearRgb,
    /// Opacity in [0, 1]. Default 1.
    pub alpha: f32,
    /// 0 dielectric, 1 metal. Default 1.
    pub metallic: f32,
    /// Perceptual roughness in [0, 1]. Default 1.
    pub roughness: f32,
    /// sRGB picture that multiplies `base_color` and `alpha`.
    pub base_color_texture: Option<TextureRef>,
    /// Linear picture: roughness in green, metallic in blue.
    pub metallic_roughness_texture: Option<TextureRef>,
}

/// What the alpha of a material means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Fragments with alpha below the cut-off are not there, the others opaque.
    Mask {
        /// Cut-off; glTF's default is 0.5.
        cutoff: f32,
    },
    /// Laid over what is behind.
    Blend,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            ambient: LinearRgb::splat(0.8),
            diffuse: LinearRgb::splat(0.8),
            specular: LinearRgb::BLACK,
            exponent: 20.0,
            alpha: 1.0,
            texture: None,
            specular_texture: None,
        }
    }
}

impl Default for MetallicRoughness {
    fn default() -> Self {
        Self {
            base_color: LinearRgb::WHITE,
            alpha: 1.0,
            metallic: 1.0,
            roughness: 1.0,
            base_color_texture: None,
            metallic_roughness_texture: None,
        }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            reflection: Reflection::Phong(Phong::default()),
            emission: LinearRgb::BLACK,
            emission_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            mirror: LinearRgb::BLACK,
            transmission: LinearRgb::BLACK,
            ior: 1.5,
            fresnel: false,
            absorption: LinearRgb::BLACK,
        }
    }
}

impl Material {
    /// Whether light goes through.
    #[must_use]
    pub fn is_transmissive(&self) -> bool {
        self.transmission.max_component() > 0.0
    }

    /// The opacity, as a factor on alpha, by which a renderer without transmitted rays shows a material
    /// that transmits but is not written with an alpha for such renderers: what transmission leaves,
    /// at least 1/10 so that it stays visible. It is laid over what is behind. `None` for materials
    /// that do not transmit, and for those with an alpha of their own.
    #[must_use]
    pub fn overlay_alpha(&self) -> Option<f32> {
        let opaque = self.alpha_mode == AlphaMode::Opaque;
        let left = (1.0 - self.transmission.max_component()).max(0.1);
        (opaque && self.is_transmissive()).then_some(left)
    }

    /// The opacity that a renderer with transmitted rays gives a surface whose alpha, texture included,
    /// is `alpha`: 1 for opaque materials, and where a blended one transmits, so that what is behind is
    /// not counted twice. The alpha of a mask stays what it is.
    ///
    /// Glass is often written with both, an alpha for renderers that lay colours over each other and
    /// a transmission for those that trace.
    #[must_use]
    pub fn tracer_alpha(&self, alpha: f32) -> f32 {
        match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Blend if self.is_transmissive() => 1.0,
            AlphaMode::Blend | AlphaMode::Mask { .. } => alpha,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_is_seen_through_once() {
        let opaque = Material::default();
        assert_eq!((opaque.overlay_alpha(), opaque.tracer_alpha(0.3)), (None, 1.0));
        let veil = Material { alpha_mode: AlphaMode::Blend, ..Material::default() };
        assert_eq!((veil.overlay_alpha(), veil.tracer_alpha(0.3)), (None, 0.3));
        let glass = Material { transmission: LinearRgb::splat(0.75), ..Material::default() };
        assert_eq!((glass.overlay_alpha(), glass.tracer_alpha(0.3)), (Some(0.25), 1.0));
        let both = Material { transmission: LinearRgb::WHITE, ..veil };
        assert_eq!((both.overlay_alpha(), both.tracer_alpha(0.3)), (None, 1.0));
        let clear = Material { transmission: LinearRgb::WHITE, ..Material::default() };
        assert_eq!(clear.overlay_alpha(), Some(0.1));
    }
}
