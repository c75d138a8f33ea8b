//! What is attached to framebuffer objects.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::plane::Plane;
use crate::texture::{BaseFormat, TextureRef};

/// A renderbuffer.
#[derive(Debug)]
pub(crate) struct Renderbuffer {
    pub(crate) name: u32,
    /// None before its storage is defined, or if that has no pixels.
    pub(crate) plane: Option<Plane>,
}

/// A renderbuffer object, shared by all that bind it, attach it or know its name.
#[derive(Clone, Debug)]
pub(crate) struct RenderbufferRef(Arc<Mutex<Renderbuffer>>);

impl RenderbufferRef {
    pub(crate) fn new(name: u32) -> Self {
        Self(Arc::new(Mutex::new(Renderbuffer { name, plane: None })))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, Renderbuffer> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether both are the same object.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// An image of a texture: level, face of a cube, slice of a volume.
#[derive(Clone, Debug)]
pub(crate) struct TextureImage {
    pub(crate) texture: TextureRef,
    pub(crate) level: u32,
    pub(crate) face: usize,
    pub(crate) layer: u32,
}

/// What is attached to one point of a framebuffer object.
#[derive(Clone, Debug, Default)]
pub(crate) enum Attachment {
    /// Nothing.
    #[default]
    None,
    Renderbuffer(RenderbufferRef),
    Texture(TextureImage),
}

impl Attachment {
    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    pub(crate) fn is_texture(&self) -> bool {
        matches!(self, Self::Texture(_))
    }

    /// Name of the renderbuffer or texture, 0 for none.
    pub(crate) fn name(&self) -> u32 {
        match self {
            Self::None => 0,
            Self::Renderbuffer(buffer) => buffer.lock().name,
            Self::Texture(image) => image.texture.lock().name,
        }
    }

    /// The pixels, shared; `None` if there are none.
    pub(crate) fn plane(&self) -> Option<Plane> {
        match self {
            Self::None => None,
            Self::Renderbuffer(buffer) => buffer.lock().plane.clone(),
            Self::Texture(image) => image.plane(),
        }
    }

    /// Whether both are the same image.
    pub(crate) fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Renderbuffer(a), Self::Renderbuffer(b)) => a.is(b),
            (Self::Texture(a), Self::Texture(b)) => {
                a.texture.is(&b.texture) && (a.level, a.face, a.layer) == (b.level, b.face, b.layer)
            }
            _ => false,
        }
    }

    /// Takes the pixels out of where they are kept.
    pub(crate) fn take(&self) -> Option<Plane> {
        match self {
            Self::None => None,
            Self::Renderbuffer(buffer) => buffer.lock().plane.take(),
            Self::Texture(image) => {
                let plane = image.plane()?;
                let mut texture = image.texture.lock();
                let kept = texture.image_mut(image.face, image.level)?;
                kept.texels = Arc::new(crate::texture::Texels::EMPTY);
                Some(plane)
            }
        }
    }

    /// Puts pixels back that [`take`](Self::take) has taken.
    pub(crate) fn put_back(&self, plane: Plane) {
        match self {
            Self::None => {}
            Self::Renderbuffer(buffer) => buffer.lock().plane = Some(plane),
            Self::Texture(image) => {
                let mut texture = image.texture.lock();
                if let Some(kept) = texture.image_mut(image.face, image.level) {
                    kept.texels = plane.texels;
                }
            }
        }
    }
}

impl TextureImage {
    fn plane(&self) -> Option<Plane> {
        let texture = self.texture.lock();
        let image = texture.image(self.face, self.level)?;
        if !image.is_present() || self.layer >= image.depth {
            return None;
        }
        let first = image.index(0, 0, self.layer as usize);
        let (width, height) = (image.width, image.height);
        Some(Plane {
            texels: Arc::clone(&image.texels),
            first,
            width,
            height,
            samples: 0,
            format: image.format,
        })
    }
}

/// The points of attachment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Point {
    Color(usize),
    Depth,
    Stencil,
}

impl Point {
    /// Whether an image of these components fits here.
    pub(crate) fn takes(self, base: BaseFormat) -> bool {
        match self {
            Self::Color(_) => matches!(base, BaseFormat::Rgb | BaseFormat::Rgba),
            Self::Depth => base.has_depth(),
            Self::Stencil => base.has_stencil(),
        }
    }
}
