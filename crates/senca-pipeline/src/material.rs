//! Materials with their textures, ready for many pixels.

use std::collections::HashMap;
use std::sync::Arc;

use senca_math::LinearRgb;
use senca_math::glam::{Mat3, Vec2};
use senca_raster::{Sampler, Texels, Texture, TextureError};
use senca_scene::{
    AlphaMode, ColorSpace, Filter, ImageData, Material, Reflection, Scene, TextureImage, TextureRef, Wrap,
};
use senca_shading::PhongConstants;

use crate::RenderError;

/// Texels that a footprint average reads at most; larger footprints are sampled.
const FOOTPRINT_LIMIT: u32 = 1024;

/// A material of the scene with everything a pixel needs.
pub(crate) struct Resolved {
    pub(crate) model: Model,
    pub(crate) emission: LinearRgb,
    pub(crate) emission_texture: Option<Bound>,
    pub(crate) normal_texture: Option<Bound>,
    pub(crate) occlusion_texture: Option<Bound>,
    pub(crate) alpha_mode: AlphaMode,
    pub(crate) double_sided: bool,
    pub(crate) unlit: bool,
}

/// The reflection models.
pub(crate) enum Model {
    Phong {
        constants: PhongConstants,
        alpha: f32,
        texture: Option<Bound>,
        specular_texture: Option<Bound>,
    },
    MetallicRoughness {
        base_color: LinearRgb,
        alpha: f32,
        metallic: f32,
        roughness: f32,
        texture: Option<Bound>,
        metallic_roughness_texture: Option<Bound>,
    },
}

/// A texture as one material uses it.
#[derive(Clone)]
pub(crate) struct Bound {
    pub(crate) texture: Arc<Texture>,
    pub(crate) sampler: Sampler,
    pub(crate) filter: Filter,
    /// Set of coordinates, 0 or 1.
    pub(crate) texcoord: u32,
    pub(crate) uv_transform: Mat3,
    pub(crate) strength: f32,
}

/// Texture coordinates at a pixel with their change per pixel in x and in y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TexturePoint {
    pub(crate) uv: Vec2,
    pub(crate) dx: Vec2,
    pub(crate) dy: Vec2,
}

impl Bound {
    /// The texture at `point`, before the use's own factor.
    pub(crate) fn sample(&self, point: &TexturePoint) -> [f32; 4] {
        let uv = self.uv_transform.transform_point2(point.uv).to_array();
        let dx = self.uv_transform.transform_vector2(point.dx).to_array();
        let dy = self.uv_transform.transform_vector2(point.dy).to_array();
        if self.filter == Filter::Footprint {
            let corner = |a: f32, b: f32| [uv[0] + a * dx[0] + b * dy[0], uv[1] + a * dx[1] + b * dy[1]];
            let corners = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
            return self.sampler.footprint_mean(&self.texture, corners, FOOTPRINT_LIMIT);
        }
        self.sampler.sample(&self.texture, uv, [dx, dy])
    }
}

impl Resolved {
    /// Texture of the base colour.
    pub(crate) fn base_texture(&self) -> Option<&Bound> {
        match &self.model {
            Model::Phong { texture, .. } | Model::MetallicRoughness { texture, .. } => texture.as_ref(),
        }
    }

    /// Opacity without texture and vertex colour.
    pub(crate) fn alpha(&self) -> f32 {
        match self.model {
            Model::Phong { alpha, .. } | Model::MetallicRoughness { alpha, .. } => alpha,
        }
    }
}

/// All materials of `scene`, and behind them the default material, which has two sides: nothing is
/// known of a body that has no material, and many models of the kind are open.
///
/// `filter` replaces that of every texture; without `textures` none is read.
pub(crate) fn resolve_materials(
    scene: &Scene,
    filter: Option<Filter>,
    textures: bool,
) -> Result<Vec<Resolved>, RenderError> {
    let mut binder = Binder { scene, filter, textures, ready: HashMap::new() };
    let default = Material { double_sided: true, ..Material::default() };
    scene.materials.iter().chain([&default]).map(|m| binder.resolve(m)).collect()
}

struct Binder<'s> {
    scene: &'s Scene,
    filter: Option<Filter>,
    textures: bool,
    /// Textures by picture, meaning and need of levels.
    ready: HashMap<(u32, bool, bool), Arc<Texture>>,
}

impl Binder<'_> {
    fn resolve(&mut self, material: &Material) -> Result<Resolved, RenderError> {
        let glass = material.overlay_alpha();
        Ok(Resolved {
            model: self.model(&material.reflection, glass.unwrap_or(1.0))?,
            emission: material.emission,
            emission_texture: self.bind(material.emission_texture.as_ref(), ColorSpace::Srgb)?,
            normal_texture: self.bind(material.normal_texture.as_ref(), ColorSpace::Linear)?,
            occlusion_texture: self.bind(material.occlusion_texture.as_ref(), ColorSpace::Linear)?,
            alpha_mode: if glass.is_some() { AlphaMode::Blend } else { material.alpha_mode },
            double_sided: material.double_sided,
            unlit: material.unlit,
        })
    }

    /// The reflection model, its alpha multiplied by `share`.
    fn model(&mut self, reflection: &Reflection, share: f32) -> Result<Model, RenderError> {
        Ok(match reflection {
            Reflection::Phong(phong) => Model::Phong {
                constants: PhongConstants::new(phong),
                alpha: share * phong.alpha,
                texture: self.bind(phong.texture.as_ref(), ColorSpace::Srgb)?,
                specular_texture: self.bind(phong.specular_texture.as_ref(), ColorSpace::Srgb)?,
            },
            Reflection::MetallicRoughness(m) => Model::MetallicRoughness {
                base_color: m.base_color,
                alpha: share * m.alpha,
                metallic: m.metallic,
                roughness: m.roughness,
                texture: self.bind(m.base_color_texture.as_ref(), ColorSpace::Srgb)?,
                metallic_roughness_texture: self
                    .bind(m.metallic_roughness_texture.as_ref(), ColorSpace::Linear)?,
            },
        })
    }

    fn bind(&mut self, used: Option<&TextureRef>, space: ColorSpace) -> Result<Option<Bound>, RenderError> {
        let Some(used) = used.filter(|_| self.textures) else { return Ok(None) };
        let textures = &self.scene.textures;
        let texture = textures.get(used.texture.index()).ok_or(RenderError::IndexOutOfRange {
            kind: "texture",
            index: used.texture.0,
            count: textures.len(),
        })?;
        let filter = self.filter.unwrap_or(texture.filter);
        let sampler = match filter {
            Filter::Nearest => Sampler::NEAREST,
            Filter::Bilinear | Filter::Footprint => Sampler::BILINEAR,
            Filter::Trilinear => Sampler::TRILINEAR,
        };
        Ok(Some(Bound {
            texture: self.texture(texture.image.0, space, filter == Filter::Trilinear)?,
            sampler: Sampler { wrap_u: wrap_of(texture.wrap_u), wrap_v: wrap_of(texture.wrap_v), ..sampler },
            filter,
            texcoord: used.texcoord,
            uv_transform: used.uv_transform,
            strength: used.strength,
        }))
    }

    fn texture(&mut self, image: u32, space: ColorSpace, levels: bool) -> Result<Arc<Texture>, RenderError> {
        let key = (image, space == ColorSpace::Srgb, levels);
        if let Some(texture) = self.ready.get(&key) {
            return Ok(Arc::clone(texture));
        }
        let images = &self.scene.images;
        let source = images.get(image as usize).ok_or(RenderError::IndexOutOfRange {
            kind: "image",
            index: image,
            count: images.len(),
        })?;
        let texture = texture_of(source, space).map_err(|e| RenderError::Texture {
            image,
            name: source.name.clone(),
            reason: e.to_string(),
        })?;
        let texture = Arc::new(if levels { texture.with_mipmaps() } else { texture });
        self.ready.insert(key, Arc::clone(&texture));
        Ok(texture)
    }
}

fn wrap_of(wrap: Wrap) -> senca_raster::Wrap {
    match wrap {
        Wrap::Repeat => senca_raster::Wrap::Repeat,
        Wrap::Mirror => senca_raster::Wrap::Mirror,
        Wrap::Clamp => senca_raster::Wrap::Clamp,
    }
}

/// The picture as the sampler reads light from it: 8-bit colour stays in sRGB, which keeps the steps of
/// dark tones, and is decoded as it is read; 8-bit data is taken as it is.
fn texture_of(image: &TextureImage, space: ColorSpace) -> Result<Texture, TextureError> {
    let (width, height) = image.data.size();
    let texels = match (&image.data, space) {
        (ImageData::RgbaF32 { texels, .. }, _) => Texels::Rgba32F(texels.clone()),
        (ImageData::Rgba8 { texels, .. }, ColorSpace::Linear) => Texels::Rgba8(texels.clone()),
        (ImageData::Rgba8 { texels, .. }, ColorSpace::Srgb) => Texels::Srgb8(texels.clone()),
    };
    Texture::new(width, height, texels)
}
