//! A texture as it was when drawing began.

use crate::texture::{TexImage, TexParams, Texture, TextureTarget};
use std::sync::Arc;

/// A complete texture as it was when drawing began: images are shared with the texture, which copies
/// them before it changes them.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) params: TexParams,
    /// The levels that are sampled, from the base level on; of each level its faces.
    pub(crate) levels: Vec<Vec<TexImage>>,
}

impl View {
    /// Of a texture; `None` if it is not complete, as if it were off.
    pub(crate) fn new(texture: &Texture) -> Option<Self> {
        let faces = if texture.target == TextureTarget::Cube { 6 } else { 1 };
        let level = |level: u32| (0..faces).map(|face| texture.image(face, level).cloned()).collect();
        let levels: Option<Vec<Vec<TexImage>>> = texture.sampled_levels()?.map(level).collect();
        Some(Self { params: texture.params, levels: levels? })
    }
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
