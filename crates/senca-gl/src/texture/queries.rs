//! Questions about textures.

use super::{InternalFormat, TexImage, Texture, levels_of};
use crate::pixel::{PixelFormat, PixelLayout, PixelSink};
use crate::state::TexTarget;
use crate::{Context, Enum, Error, gl};

impl Context {
    /// `glGetTexParameter`: four numbers of `TEXTURE_BORDER_COLOR`, else one; none in case of error.
    pub fn get_tex_parameter(&mut self, target: Enum, name: Enum) -> Vec<f64> {
        self.ask(|c| {
            let found =
                TexTarget::of(target).and_then(|target| c.bound_texture(target).lock().params.get(name));
            let Some(values) = found else {
                c.error(gl::INVALID_ENUM);
                return Vec::new();
            };
            let n = if name == gl::TEXTURE_BORDER_COLOR { 4 } else { 1 };
            values[..n].to_vec()
        })
    }

    /// `glGetTexLevelParameter`: also of proxies. `None` in case of error.
    pub fn get_tex_level_parameter(&mut self, target: Enum, level: i32, name: Enum) -> Option<i32> {
        self.ask(|c| {
            let result = c.level_parameter(target, level, name);
            c.check(result)
        })
    }

    fn level_parameter(&self, token: Enum, level: i32, name: Enum) -> Result<i32, Error> {
        let proxy = TexTarget::from_proxy_token(token);
        let image = TexTarget::from_image_token(token);
        let target = proxy.or(image.map(|(target, _)| target)).ok_or(Error::InvalidEnum)?;
        let level = u32::try_from(level).map_err(|_| Error::InvalidValue)?;
        if level >= levels_of(target.max_size()) {
            return Err(Error::InvalidValue);
        }
        let shape = if proxy.is_some() {
            let found = self.bindings.proxies[target as usize].get(level as usize).copied().flatten();
            found.map(|proxy| (proxy.size, proxy.border, proxy.format))
        } else {
            let face = image.map_or(0, |(_, face)| face);
            let texture = self.bound_texture(target);
            let texture = texture.lock();
            texture.image(face, level).map(|image| (image.size(), image.border, image.format))
        };
        level_value(shape, name).ok_or_else(|| level_error(name))
    }

    /// `glGetTexImage`: writes an image into client memory as the pack state says. Bytes between rows stay.
    pub fn get_tex_image(&mut self, target: Enum, level: i32, format: Enum, ty: Enum, bytes: &mut [u8]) {
        self.ask(|c| {
            c.flush_batch();
            let result = c.read_image(target, level, format, ty, bytes);
            c.check(result);
        });
    }

    /// Width, height and depth of a level with its border, as `glGetTexImage` writes it; zeros if there is none.
    pub fn tex_level_size(&mut self, target: Enum, level: i32) -> [u32; 3] {
        let found = TexTarget::from_image_token(target).zip(u32::try_from(level).ok());
        let Some(((target, face), level)) = found else { return [0; 3] };
        self.bound_texture(target).lock().image(face, level).map_or([0; 3], TexImage::size)
    }

    fn read_image(
        &self,
        token: Enum,
        level: i32,
        format: Enum,
        ty: Enum,
        bytes: &mut [u8],
    ) -> Result<(), Error> {
        let (target, face) = TexTarget::from_image_token(token).ok_or(Error::InvalidEnum)?;
        let level = u32::try_from(level).map_err(|_| Error::InvalidValue)?;
        if level >= levels_of(target.max_size()) {
            return Err(Error::InvalidValue);
        }
        let layout = PixelLayout::new(format, ty)?;
        if layout.format() == PixelFormat::ColorIndex {
            return Err(Error::InvalidEnum);
        }
        let texture = self.bound_texture(target);
        let texture: &Texture = &texture.lock();
        let Some(image) = texture.image(face, level) else { return Ok(()) };
        TexImage::check_pixels(image.format.base(), layout)?;
        if layout.format() == PixelFormat::DepthStencil && !image.format.base().has_stencil() {
            return Err(Error::InvalidOperation);
        }
        let volume = target == TexTarget::Three;
        let sink = PixelSink::new(bytes, &self.pixels.store.pack, layout, image.size(), volume);
        image.read(&mut sink.ok_or(Error::InvalidOperation)?);
        Ok(())
    }

    /// `glGetCompressedTexImage`: no image is compressed, so this is always an `INVALID_OPERATION`, or an error of
    /// target or level.
    pub fn get_compressed_tex_image(&mut self, target: Enum, level: i32) {
        self.ask(|c| match TexTarget::from_image_token(target) {
            None => c.error(gl::INVALID_ENUM),
            Some((target, _)) if !(0..levels_of(target.max_size()) as i32).contains(&level) => {
                c.error(gl::INVALID_VALUE);
            }
            Some(_) => c.error(gl::INVALID_OPERATION),
        });
    }
}

/// A parameter of an image, or of one that is not there.
fn level_value(shape: Option<([u32; 3], u32, InternalFormat)>, name: Enum) -> Option<i32> {
    let (size, border, format) = match shape {
        Some((size, border, format)) => (size, border, Some(format)),
        None => ([0; 3], 0, None),
    };
    let value = match name {
        gl::TEXTURE_WIDTH => size[0],
        gl::TEXTURE_HEIGHT => size[1],
        gl::TEXTURE_DEPTH => size[2],
        gl::TEXTURE_BORDER => border,
        gl::TEXTURE_INTERNAL_FORMAT => format.map_or(1, InternalFormat::token),
        gl::TEXTURE_COMPRESSED => 0,
        _ => {
            let any = InternalFormat::for_texture(gl::RGBA)?;
            let bits = format.unwrap_or(any).bits(name)?;
            if format.is_some() { bits } else { 0 }
        }
    };
    i32::try_from(value).ok()
}

fn level_error(name: Enum) -> Error {
    // Its size could be told only if there were one.
    if name == gl::TEXTURE_COMPRESSED_IMAGE_SIZE { Error::InvalidOperation } else { Error::InvalidEnum }
}
