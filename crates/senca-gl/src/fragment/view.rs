//! A texture as it was when drawing began.

use crate::texture::{TexImage, TexParams, Texels, Texture, TextureTarget};
use senca_raster::CubeTexture;
use std::sync::{Arc, OnceLock};

/// A complete texture as it was when drawing began: images are shared with the texture, which copies
/// them before it changes them.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) params: TexParams,
    /// The levels that are sampled, from the base level on; of each level its faces.
    pub(crate) levels: Vec<Vec<TexImage>>,
    /// Of a cube what the rasterizer reads, once it has: with faces that are not mixed, and with such that are.
    cubes: Arc<[OnceLock<Option<Arc<CubeTexture>>>; 2]>,
}

impl View {
    /// Of a texture; `None` if it is not complete, as if it were off.
    pub(crate) fn new(texture: &Texture) -> Option<Self> {
        let faces = if texture.target == TextureTarget::Cube { 6 } else { 1 };
        let level = |level: u32| (0..faces).map(|face| texture.image(face, level).cloned()).collect();
        let levels: Option<Vec<Vec<TexImage>>> = texture.sampled_levels()?.map(level).collect();
        Some(Self::of_levels(texture.params, levels?))
    }

    pub(crate) fn of_levels(params: TexParams, levels: Vec<Vec<TexImage>>) -> Self {
        Self { params, levels, cubes: Arc::default() }
    }

    /// The faces of a cube as the rasterizer reads them, if they have 8 bits.
    pub(crate) fn cube(&self, seamless: bool) -> Option<Arc<CubeTexture>> {
        self.cubes[usize::from(seamless)]
            .get_or_init(|| cube_of(&self.levels, seamless).map(Arc::new))
            .clone()
    }
}

fn cube_of(levels: &[Vec<TexImage>], seamless: bool) -> Option<CubeTexture> {
    let mut of_levels: Vec<(u32, [&[[u8; 4]]; 6])> = Vec::with_capacity(levels.len());
    for images in levels {
        let mut faces: [&[[u8; 4]]; 6] = [&[]; 6];
        for (face, image) in faces.iter_mut().zip(images) {
            let Texels::Rgba8(colors) = &*image.texels else { return None };
            *face = colors;
        }
        of_levels.push((images.first()?.width, faces));
    }
    CubeTexture::new(&of_levels, seamless).ok()
}

impl PartialEq for View {
    /// Whether drawing with one is drawing with the other.
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&TexImage, &TexImage)| {
            a.size() == b.size() && a.border == b.border && Arc::ptr_eq(&a.texels, &b.texels)
        };
        self.params == other.params
            && self.levels.len() == other.levels.len()
            && self.levels.iter().flatten().zip(other.levels.iter().flatten()).all(same)
    }
}
