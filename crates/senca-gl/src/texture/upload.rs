//! Commands that put images into textures.

use std::sync::Arc;

use super::{InternalFormat, MAX_IMAGE_BYTES, TexImage, Texture, Upload, levels_of};
use crate::pixel::{PixelLayout, PixelSource, PixelStore, Transfer};
use crate::state::TexTarget;
use crate::{Context, Enum, Error, gl};

/// Pixels a command was given: none, or the error that format, type and bytes come to.
pub(crate) type Pixels<'a> = Result<Option<PixelSource<'a>>, Error>;

/// Where an image goes and what it is, as commands say it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Definition {
    /// Dimensions of the command.
    pub(super) dimensions: usize,
    pub(super) target: Enum,
    pub(super) level: i32,
    pub(super) internal: i32,
    /// 1 where the command has no such side.
    pub(super) size: [i32; 3],
    pub(super) border: i32,
}

/// A definition found to be right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Checked {
    pub(super) target: TexTarget,
    pub(super) face: usize,
    pub(super) level: u32,
    pub(super) format: InternalFormat,
    pub(super) size: [u32; 3],
    pub(super) border: u32,
}

/// An image that a proxy would have.
pub(super) type Proxy = Checked;

impl Definition {
    /// Checks all but the target, the pixels and whether the image is too large.
    fn check(&self, target: TexTarget, face: usize) -> Result<Checked, Error> {
        let max = target.max_size();
        let level = u32::try_from(self.level).map_err(|_| Error::InvalidValue)?;
        if level >= levels_of(max) {
            return Err(Error::InvalidValue);
        }
        let format = InternalFormat::for_texture(self.internal as u32).ok_or(Error::InvalidValue)?;
        if !matches!(self.border, 0 | 1) {
            return Err(Error::InvalidValue);
        }
        for &side in &self.size[..self.dimensions] {
            if side.checked_sub(2 * self.border).is_none_or(|inner| inner < 0) {
                return Err(Error::InvalidValue);
            }
        }
        if target == TexTarget::Cube && self.size[0] != self.size[1] {
            return Err(Error::InvalidValue);
        }
        // Cube maps of depths are OpenGL 3.0's; programs that cast shadows of lamps have them.
        if format.base().has_depth() && target == TexTarget::Three {
            return Err(Error::InvalidOperation);
        }
        let size = self.size.map(|side| side as u32);
        Ok(Checked { target, face, level, format, size, border: self.border as u32 })
    }

    /// Target and face of an image, not of a proxy.
    fn image_target(&self) -> Result<(TexTarget, usize), Error> {
        image_target(self.dimensions, self.target)
    }

    pub(super) fn check_image(&self) -> Result<Checked, Error> {
        let (target, face) = self.image_target()?;
        let checked = self.check(target, face)?;
        if checked.is_too_large() { Err(Error::InvalidValue) } else { Ok(checked) }
    }
}

/// Target and face that a token names for commands of so many dimensions.
pub(super) fn image_target(dimensions: usize, token: Enum) -> Result<(TexTarget, usize), Error> {
    let fits = |(target, _): &(TexTarget, usize)| target.dimensions() == dimensions;
    TexTarget::from_image_token(token).filter(fits).ok_or(Error::InvalidEnum)
}

impl Checked {
    fn texels(&self) -> u64 {
        self.size.iter().fold(1, |texels: u64, &side| texels.saturating_mul(u64::from(side)))
    }

    /// Whether a side is longer than its level may have.
    fn is_too_large(&self) -> bool {
        let most = (self.target.max_size() >> self.level) + 2 * self.border;
        self.size[..self.target.dimensions()].iter().any(|side| *side > most)
    }

    fn fits_memory(&self) -> bool {
        self.texels().saturating_mul(self.format.storage().texel_bytes() as u64) <= MAX_IMAGE_BYTES as u64
    }

    /// The old image if it has the same shape and nobody else holds on to it, else a new one.
    fn image(&self, texture: &mut Texture) -> Result<TexImage, Error> {
        let old = texture.take_image(self.face, self.level);
        let alike = |old: &mut TexImage| {
            old.size() == self.size
                && old.border == self.border
                && old.format == self.format
                && old.is_present()
                && Arc::get_mut(&mut old.texels).is_some()
        };
        if let Some(mut old) = old
            && alike(&mut old)
        {
            return Ok(old);
        }
        TexImage::new(self.format, self.size, self.border)
    }
}

/// A rectangle or box within an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) dimensions: usize,
    pub(super) target: Enum,
    pub(super) level: i32,
    pub(super) offset: [i32; 3],
    pub(super) size: [i32; 3],
}

impl Region {
    /// Finds texture, face, level and the first texel counted from the corner of the border.
    pub(super) fn locate(&self, c: &Context) -> Result<(super::TextureRef, usize, u32, [u32; 3]), Error> {
        let (target, face) = image_target(self.dimensions, self.target)?;
        let level = u32::try_from(self.level).map_err(|_| Error::InvalidValue)?;
        if level >= levels_of(target.max_size()) {
            return Err(Error::InvalidValue);
        }
        let texture = c.bound_texture(target);
        let corner = {
            let texture = texture.lock();
            self.corner(texture.image(face, level).ok_or(Error::InvalidOperation)?)?
        };
        Ok((texture, face, level, corner))
    }

    fn corner(&self, image: &TexImage) -> Result<[u32; 3], Error> {
        let mut corner = [0; 3];
        for (axis, corner) in corner.iter_mut().enumerate() {
            let border = if axis < self.dimensions { i64::from(image.border) } else { 0 };
            let begin = i64::from(self.offset[axis]) + border;
            let end = begin + i64::from(self.size[axis]);
            if self.size[axis] < 0 || begin < 0 || end > i64::from(image.size()[axis]) {
                return Err(Error::InvalidValue);
            }
            *corner = begin as u32;
        }
        Ok(corner)
    }
}

impl Context {
    /// Pixels of client memory as the unpack state says where they are.
    pub(crate) fn source<'a>(
        &self,
        size: [i32; 3],
        volume: bool,
        format: Enum,
        ty: Enum,
        data: Option<&'a [u8]>,
    ) -> Pixels<'a> {
        let layout = PixelLayout::new(format, ty)?;
        // Negative sizes are an error that the command finds.
        let size = size.map(|side| side.max(0) as u32);
        let Some(data) = data else { return Ok(None) };
        let source = PixelSource::new(data, &self.pixels.store.unpack, layout, size, volume);
        source.map(Some).ok_or(Error::InvalidOperation)
    }

    /// Does a command with pixels that lists record: with those of the client now, with a copy in a list.
    pub(crate) fn submit_pixels(
        &mut self,
        pixels: Pixels<'_>,
        run: impl Fn(&mut Self, Pixels<'_>) + Send + Sync + 'static,
    ) {
        let Some(list) = &self.compiling else {
            return self.outside(|c| run(c, pixels));
        };
        if list.executes() {
            self.outside(|c| run(c, pixels));
        }
        let kept = pixels.and_then(|source| {
            let Some(source) = source else { return Ok(None) };
            let bytes = source.to_tight().ok_or(Error::OutOfMemory)?;
            Ok(Some((bytes, source.layout(), source.size())))
        });
        let Some(list) = &mut self.compiling else { return };
        list.push_call(move |c: &mut Self| {
            let pixels = match &kept {
                Ok(Some((bytes, layout, size))) => {
                    Ok(PixelSource::new(bytes, &PixelStore::TIGHT, *layout, *size, true))
                }
                Ok(None) => Ok(None),
                Err(error) => Err(*error),
            };
            c.outside(|c| run(c, pixels));
        });
    }

    /// The transfer that pixels go through now.
    pub(crate) fn transfer(&self) -> Transfer<'_> {
        self.pixels.transfer()
    }

    /// `glTexImage1D`.
    pub fn tex_image_1d(
        &mut self,
        target: Enum,
        level: i32,
        internal: i32,
        width: i32,
        border: i32,
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        let size = [width, 1, 1];
        self.tex_image(Definition { dimensions: 1, target, level, internal, size, border }, format, ty, data);
    }

    /// `glTexImage2D`; the size is width and height.
    pub fn tex_image_2d(
        &mut self,
        target: Enum,
        level: i32,
        internal: i32,
        size: [i32; 2],
        border: i32,
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        let size = [size[0], size[1], 1];
        self.tex_image(Definition { dimensions: 2, target, level, internal, size, border }, format, ty, data);
    }

    /// `glTexImage3D`; the size is width, height and depth.
    pub fn tex_image_3d(
        &mut self,
        target: Enum,
        level: i32,
        internal: i32,
        size: [i32; 3],
        border: i32,
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        self.tex_image(Definition { dimensions: 3, target, level, internal, size, border }, format, ty, data);
    }

    fn tex_image(&mut self, definition: Definition, format: Enum, ty: Enum, data: Option<&[u8]>) {
        if let Some(target) = TexTarget::from_proxy_token(definition.target) {
            return self.outside(|c| {
                let result = c.set_proxy(target, &definition, format, ty);
                c.check(result);
            });
        }
        let layout = PixelLayout::new(format, ty);
        let pixels = self.source(definition.size, definition.dimensions == 3, format, ty, data);
        self.submit_pixels(pixels, move |c, pixels| {
            let result = c.define_image(&definition, layout, pixels);
            c.check(result);
        });
    }

    fn define_image(
        &mut self,
        definition: &Definition,
        layout: Result<PixelLayout, Error>,
        pixels: Pixels<'_>,
    ) -> Result<(), Error> {
        definition.image_target()?;
        let checked = definition.check_image()?;
        TexImage::check_pixels(checked.format.base(), layout?)?;
        let pixels = pixels?;
        self.release_textures();
        let texture = self.bound_texture(checked.target);
        let mut texture = texture.lock();
        if checked.texels() == 0 {
            texture.set_image(checked.face, checked.level, None);
            return Ok(());
        }
        let mut image = checked.image(&mut texture)?;
        if let Some(source) = pixels {
            image.write([0; 3], &Upload { source, transfer: self.transfer() });
        }
        texture.set_image(checked.face, checked.level, Some(image));
        texture.follow(checked.face, checked.level)
    }

    fn set_proxy(
        &mut self,
        target: TexTarget,
        definition: &Definition,
        format: Enum,
        ty: Enum,
    ) -> Result<(), Error> {
        if target.dimensions() != definition.dimensions {
            return Err(Error::InvalidEnum);
        }
        let layout = PixelLayout::new(format, ty)?;
        let checked = definition.check(target, 0)?;
        TexImage::check_pixels(checked.format.base(), layout)?;
        // An image that is only too large has no size; that is no error.
        let fits = !checked.is_too_large() && checked.fits_memory() && checked.texels() > 0;
        let (images, level) = (&mut self.bindings.proxies[target as usize], checked.level as usize);
        images.resize((level + 1).max(images.len()), None);
        images[level] = fits.then_some(checked);
        Ok(())
    }

    /// `glTexSubImage1D`.
    pub fn tex_sub_image_1d(
        &mut self,
        target: Enum,
        level: i32,
        offset: i32,
        width: i32,
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        let (offset, size) = ([offset, 0, 0], [width, 1, 1]);
        self.tex_sub_image(Region { dimensions: 1, target, level, offset, size }, format, ty, data);
    }

    /// `glTexSubImage2D`.
    pub fn tex_sub_image_2d(
        &mut self,
        target: Enum,
        level: i32,
        offset: [i32; 2],
        size: [i32; 2],
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        let (offset, size) = ([offset[0], offset[1], 0], [size[0], size[1], 1]);
        self.tex_sub_image(Region { dimensions: 2, target, level, offset, size }, format, ty, data);
    }

    /// `glTexSubImage3D`.
    pub fn tex_sub_image_3d(
        &mut self,
        target: Enum,
        level: i32,
        offset: [i32; 3],
        size: [i32; 3],
        format: Enum,
        ty: Enum,
        data: Option<&[u8]>,
    ) {
        self.tex_sub_image(Region { dimensions: 3, target, level, offset, size }, format, ty, data);
    }

    fn tex_sub_image(&mut self, region: Region, format: Enum, ty: Enum, data: Option<&[u8]>) {
        let layout = PixelLayout::new(format, ty);
        let pixels = self.source(region.size, region.dimensions == 3, format, ty, data);
        self.submit_pixels(pixels, move |c, pixels| {
            let result = c.change_image(&region, layout, pixels);
            c.check(result);
        });
    }

    fn change_image(
        &mut self,
        region: &Region,
        layout: Result<PixelLayout, Error>,
        pixels: Pixels<'_>,
    ) -> Result<(), Error> {
        let (texture, face, level, corner) = region.locate(self)?;
        let layout = layout?;
        let base = texture.lock().image(face, level).map(|image| image.format.base());
        TexImage::check_pixels(base.ok_or(Error::InvalidOperation)?, layout)?;
        let Some(source) = pixels? else { return Ok(()) };
        self.release_textures();
        let mut texture = texture.lock();
        if let Some(image) = texture.image_mut(face, level) {
            image.write(corner, &Upload { source, transfer: self.transfer() });
        }
        texture.follow(face, level)
    }

    /// `glCompressedTexImage1D`, `2D` and `3D`: there are no compressed formats, so this is always an
    /// `INVALID_ENUM`. Images of the generic compressed formats are kept uncompressed.
    pub fn compressed_tex_image(
        &mut self,
        _target: Enum,
        _level: i32,
        _internal: Enum,
        _data: Option<&[u8]>,
    ) {
        self.submit(|c| c.error(gl::INVALID_ENUM));
    }

    /// `glCompressedTexSubImage1D`, `2D` and `3D`: always an `INVALID_ENUM`, as
    /// [`compressed_tex_image`](Self::compressed_tex_image).
    pub fn compressed_tex_sub_image(
        &mut self,
        _target: Enum,
        _level: i32,
        _format: Enum,
        _data: Option<&[u8]>,
    ) {
        self.submit(|c| c.error(gl::INVALID_ENUM));
    }

    /// `glGenerateMipmap`.
    pub fn generate_mipmap(&mut self, target: Enum) {
        self.outside(|c| {
            let result = c.make_mipmaps(target);
            c.check(result);
        });
    }

    fn make_mipmaps(&mut self, target: Enum) -> Result<(), Error> {
        let target = TexTarget::of(target).ok_or(Error::InvalidEnum)?;
        let texture = self.bound_texture(target);
        if target == TexTarget::Cube && !texture.lock().faces_agree() {
            return Err(Error::InvalidOperation);
        }
        self.release_textures();
        texture.lock().generate_mipmaps()
    }
}
