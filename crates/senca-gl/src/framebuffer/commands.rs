//! Commands on renderbuffers and framebuffer objects.

use super::MAX_RENDERBUFFER_SIZE;
use super::attach::{Attachment, Point, RenderbufferRef, TextureImage};
use super::object::{FramebufferObject, MAX_COLOR_ATTACHMENTS};
use super::plane::{Plane, SAMPLES};
use crate::arrays::MAX_NAMES;
use crate::state::TexTarget;
use crate::texture::{InternalFormat, levels_of};
use crate::{Context, Enum, Error, gl};

/// Points of attachment that a token names.
fn points(token: Enum) -> Result<&'static [Point], Error> {
    const COLORS: [[Point; 1]; MAX_COLOR_ATTACHMENTS] = {
        let mut colors = [[Point::Depth]; MAX_COLOR_ATTACHMENTS];
        let mut i = 0;
        while i < MAX_COLOR_ATTACHMENTS {
            colors[i] = [Point::Color(i)];
            i += 1;
        }
        colors
    };
    match token {
        gl::DEPTH_ATTACHMENT => Ok(&[Point::Depth]),
        gl::STENCIL_ATTACHMENT => Ok(&[Point::Stencil]),
        gl::DEPTH_STENCIL_ATTACHMENT => Ok(&[Point::Depth, Point::Stencil]),
        gl::COLOR_ATTACHMENT0..=gl::COLOR_ATTACHMENT15 => {
            let i = (token - gl::COLOR_ATTACHMENT0) as usize;
            COLORS.get(i).map(|point| &point[..]).ok_or(Error::InvalidOperation)
        }
        _ => Err(Error::InvalidEnum),
    }
}

/// Whether a target means the framebuffer that is drawn to and the one that is read from.
fn sides(target: Enum) -> Result<(bool, bool), Error> {
    match target {
        gl::FRAMEBUFFER => Ok((true, true)),
        gl::DRAW_FRAMEBUFFER => Ok((true, false)),
        gl::READ_FRAMEBUFFER => Ok((false, true)),
        _ => Err(Error::InvalidEnum),
    }
}

impl Context {
    /// `glGenRenderbuffers`: unused names.
    pub fn gen_renderbuffers(&mut self, n: i32) -> Vec<u32> {
        self.ask(|c| {
            if !(0..=MAX_NAMES).contains(&n) {
                c.error(gl::INVALID_VALUE);
                return Vec::new();
            }
            c.shared().renderbuffers.generate(n as usize)
        })
    }

    /// `glIsRenderbuffer`: whether the name has been bound.
    pub fn is_renderbuffer(&mut self, name: u32) -> bool {
        self.ask(|c| c.shared().renderbuffers.get_ref(name).is_some())
    }

    /// `glDeleteRenderbuffers`. Framebuffers bound now lose them.
    pub fn delete_renderbuffers(&mut self, names: &[u32]) {
        self.outside(|c| {
            c.flush_batch();
            for &name in names {
                let removed = c.shared().renderbuffers.remove(name);
                if let Some(buffer) = removed {
                    c.framebuffers.detach_renderbuffer(&buffer);
                }
            }
            c.touch_raster();
        });
    }

    /// `glBindRenderbuffer`: name 0 for none. Other names must come from `gen_renderbuffers`.
    pub fn bind_renderbuffer(&mut self, target: Enum, name: u32) {
        self.outside(|c| {
            let result = c.set_renderbuffer(target, name);
            c.check(result);
        });
    }

    fn set_renderbuffer(&mut self, target: Enum, name: u32) -> Result<(), Error> {
        if target != gl::RENDERBUFFER {
            return Err(Error::InvalidEnum);
        }
        let buffer = if name == 0 {
            None
        } else {
            let mut shared = self.shared();
            if !shared.renderbuffers.is_used(name) {
                return Err(Error::InvalidOperation);
            }
            Some(shared.renderbuffers.get_or_insert(name, || RenderbufferRef::new(name)).clone())
        };
        self.framebuffers.renderbuffer = buffer;
        Ok(())
    }

    /// `glRenderbufferStorage`.
    pub fn renderbuffer_storage(&mut self, target: Enum, internal: Enum, size: [i32; 2]) {
        self.renderbuffer_storage_multisample(target, 0, internal, size);
    }

    /// `glRenderbufferStorageMultisample`: 0 samples for no multisampling; 1 to 4 come to 4.
    pub fn renderbuffer_storage_multisample(
        &mut self,
        target: Enum,
        samples: i32,
        internal: Enum,
        size: [i32; 2],
    ) {
        self.outside(|c| {
            let result = c.define_renderbuffer(target, samples, internal, size);
            c.check(result);
        });
    }

    fn define_renderbuffer(
        &mut self,
        target: Enum,
        samples: i32,
        internal: Enum,
        size: [i32; 2],
    ) -> Result<(), Error> {
        if target != gl::RENDERBUFFER {
            return Err(Error::InvalidEnum);
        }
        let format = InternalFormat::for_renderbuffer(internal).ok_or(Error::InvalidEnum)?;
        let side = |side: i32| u32::try_from(side).ok().filter(|side| *side <= MAX_RENDERBUFFER_SIZE);
        let (Some(width), Some(height)) = (side(size[0]), side(size[1])) else {
            return Err(Error::InvalidValue);
        };
        if !(0..=SAMPLES as i32).contains(&samples) {
            return Err(Error::InvalidValue);
        }
        let samples = if samples == 0 { 0 } else { SAMPLES };
        let buffer = self.framebuffers.renderbuffer.clone().ok_or(Error::InvalidOperation)?;
        self.flush_batch();
        self.touch_raster();
        let plane = if width == 0 || height == 0 {
            None
        } else {
            Some(Plane::new(format, width, height, samples).ok_or(Error::OutOfMemory)?)
        };
        buffer.lock().plane = plane;
        Ok(())
    }

    /// `glGetRenderbufferParameter`; 0 in case of error.
    pub fn get_renderbuffer_parameter(&mut self, target: Enum, name: Enum) -> i32 {
        self.ask(|c| {
            let result = c.renderbuffer_parameter(target, name);
            c.check(result).unwrap_or(0)
        })
    }

    fn renderbuffer_parameter(&self, target: Enum, name: Enum) -> Result<i32, Error> {
        if target != gl::RENDERBUFFER {
            return Err(Error::InvalidEnum);
        }
        let buffer = self.framebuffers.renderbuffer.as_ref().ok_or(Error::InvalidOperation)?.lock();
        let plane = buffer.plane.as_ref();
        let value = match name {
            gl::RENDERBUFFER_WIDTH => plane.map_or(0, |plane| plane.width),
            gl::RENDERBUFFER_HEIGHT => plane.map_or(0, |plane| plane.height),
            gl::RENDERBUFFER_SAMPLES => plane.map_or(0, |plane| plane.samples),
            gl::RENDERBUFFER_INTERNAL_FORMAT => plane.map_or(gl::RGBA, |plane| plane.format.token()),
            gl::RENDERBUFFER_RED_SIZE
            | gl::RENDERBUFFER_GREEN_SIZE
            | gl::RENDERBUFFER_BLUE_SIZE
            | gl::RENDERBUFFER_ALPHA_SIZE
            | gl::RENDERBUFFER_DEPTH_SIZE
            | gl::RENDERBUFFER_STENCIL_SIZE => plane.and_then(|plane| plane.format.bits(name)).unwrap_or(0),
            _ => return Err(Error::InvalidEnum),
        };
        Ok(value as i32)
    }

    /// `glGenFramebuffers`: unused names.
    pub fn gen_framebuffers(&mut self, n: i32) -> Vec<u32> {
        self.ask(|c| {
            if !(0..=MAX_NAMES).contains(&n) {
                c.error(gl::INVALID_VALUE);
                return Vec::new();
            }
            c.framebuffers.objects.generate(n as usize)
        })
    }

    /// `glIsFramebuffer`: whether the name has been bound.
    pub fn is_framebuffer(&mut self, name: u32) -> bool {
        self.ask(|c| c.framebuffers.objects.get_ref(name).is_some())
    }

    /// `glDeleteFramebuffers`. Those that are bound give way to the window.
    pub fn delete_framebuffers(&mut self, names: &[u32]) {
        self.outside(|c| {
            c.flush_batch();
            for &name in names.iter().filter(|name| **name != 0) {
                c.framebuffers.objects.remove(name);
                for bound in [&mut c.framebuffers.draw, &mut c.framebuffers.read] {
                    if *bound == name {
                        *bound = 0;
                    }
                }
            }
            c.touch();
        });
    }

    /// `glBindFramebuffer`: name 0 for the window. Other names must come from `gen_framebuffers`.
    pub fn bind_framebuffer(&mut self, target: Enum, name: u32) {
        self.outside(|c| {
            let result = c.set_framebuffer(target, name);
            c.check(result);
        });
    }

    fn set_framebuffer(&mut self, target: Enum, name: u32) -> Result<(), Error> {
        let (draw, read) = sides(target)?;
        if name != 0 {
            if !self.framebuffers.objects.is_used(name) {
                return Err(Error::InvalidOperation);
            }
            self.framebuffers.objects.get_or_insert(name, FramebufferObject::default);
        }
        if draw {
            self.turn_to_framebuffer(name);
        }
        if read {
            self.framebuffers.read = name;
        }
        self.touch();
        Ok(())
    }

    /// `glCheckFramebufferStatus`; 0 in case of error.
    pub fn check_framebuffer_status(&mut self, target: Enum) -> Enum {
        self.ask(|c| match sides(target) {
            Ok((true, _)) => c.framebuffers.draw_status(),
            Ok(_) => c.framebuffers.read_status(),
            Err(error) => {
                c.error(error.code());
                0
            }
        })
    }

    /// Puts something at a point of attachment.
    fn attach(&mut self, target: Enum, point: Enum, attachment: Attachment) -> Result<(), Error> {
        let points = points(point)?;
        let name = self.attachable(target)?;
        self.release_textures();
        if let Some(object) = self.framebuffers.objects.get_mut(name) {
            points.iter().for_each(|point| *object.point_mut(*point) = attachment.clone());
        }
        self.touch();
        Ok(())
    }

    /// Name of the framebuffer object that a target means. The window has no points of attachment.
    fn attachable(&self, target: Enum) -> Result<u32, Error> {
        let (draw, _) = sides(target)?;
        let name = if draw { self.framebuffers.draw } else { self.framebuffers.read };
        if name == 0 { Err(Error::InvalidOperation) } else { Ok(name) }
    }

    /// `glFramebufferRenderbuffer`: name 0 detaches.
    pub fn framebuffer_renderbuffer(&mut self, target: Enum, point: Enum, buffer_target: Enum, name: u32) {
        self.outside(|c| {
            let result = c.attach_renderbuffer(target, point, buffer_target, name);
            c.check(result);
        });
    }

    fn attach_renderbuffer(
        &mut self,
        target: Enum,
        point: Enum,
        buffer_target: Enum,
        name: u32,
    ) -> Result<(), Error> {
        if buffer_target != gl::RENDERBUFFER {
            return Err(Error::InvalidEnum);
        }
        self.attachable(target)?;
        let attachment = if name == 0 {
            Attachment::None
        } else {
            Attachment::Renderbuffer(self.shared().renderbuffers.get(name).ok_or(Error::InvalidOperation)?)
        };
        self.attach(target, point, attachment)
    }

    /// `glFramebufferTexture1D`: name 0 detaches.
    pub fn framebuffer_texture_1d(&mut self, target: Enum, point: Enum, image: Enum, name: u32, level: i32) {
        self.attach_image(target, point, 1, image, name, level, 0);
    }

    /// `glFramebufferTexture2D`: of a texture of two dimensions or a face of a cube.
    pub fn framebuffer_texture_2d(&mut self, target: Enum, point: Enum, image: Enum, name: u32, level: i32) {
        self.attach_image(target, point, 2, image, name, level, 0);
    }

    /// `glFramebufferTexture3D`: a slice of a texture of three dimensions.
    pub fn framebuffer_texture_3d(
        &mut self,
        target: Enum,
        point: Enum,
        image: Enum,
        name: u32,
        level: i32,
        layer: i32,
    ) {
        self.attach_image(target, point, 3, image, name, level, layer);
    }

    /// `glFramebufferTextureLayer`: a slice of a texture of three dimensions.
    pub fn framebuffer_texture_layer(
        &mut self,
        target: Enum,
        point: Enum,
        name: u32,
        level: i32,
        layer: i32,
    ) {
        self.attach_image(target, point, 3, gl::TEXTURE_3D, name, level, layer);
    }

    fn attach_image(
        &mut self,
        target: Enum,
        point: Enum,
        dimensions: usize,
        image: Enum,
        name: u32,
        level: i32,
        layer: i32,
    ) {
        self.outside(|c| {
            let result = c
                .attachable(target)
                .and_then(|_| c.texture_attachment(dimensions, image, name, level, layer))
                .and_then(|attachment| c.attach(target, point, attachment));
            c.check(result);
        });
    }

    fn texture_attachment(
        &self,
        dimensions: usize,
        image: Enum,
        name: u32,
        level: i32,
        layer: i32,
    ) -> Result<Attachment, Error> {
        if name == 0 {
            return Ok(Attachment::None);
        }
        let (kind, face) = TexTarget::from_image_token(image).ok_or(Error::InvalidEnum)?;
        let texture = self.shared().textures.get(name).ok_or(Error::InvalidOperation)?;
        if kind.dimensions() != dimensions || texture.lock().target != kind {
            return Err(Error::InvalidOperation);
        }
        let level = u32::try_from(level).map_err(|_| Error::InvalidValue)?;
        let layer = u32::try_from(layer).map_err(|_| Error::InvalidValue)?;
        if level >= levels_of(kind.max_size()) || kind == TexTarget::Three && layer >= kind.max_size() {
            return Err(Error::InvalidValue);
        }
        Ok(Attachment::Texture(TextureImage { texture, level, face, layer }))
    }

    /// `glGetFramebufferAttachmentParameter`; 0 in case of error.
    pub fn get_framebuffer_attachment_parameter(&mut self, target: Enum, point: Enum, name: Enum) -> i32 {
        self.ask(|c| {
            let result = c.attachment_parameter(target, point, name);
            c.check(result).unwrap_or(0)
        })
    }

    fn attachment_parameter(&self, target: Enum, point: Enum, name: Enum) -> Result<i32, Error> {
        let (draw, _) = sides(target)?;
        let f = &self.framebuffers;
        let object = if draw { f.draw_object() } else { f.read_object() };
        match object {
            None => self.window_parameter(point, name),
            Some(object) => {
                let points = points(point)?;
                let attachment = object.point(points[0]);
                if points.len() == 2
                    && !(attachment.is(&object.stencil) || attachment.name() == object.stencil.name())
                {
                    return Err(Error::InvalidOperation);
                }
                attached_value(attachment, points[0], name)
            }
        }
    }

    /// A parameter of one of the window's buffers.
    fn window_parameter(&self, point: Enum, name: Enum) -> Result<i32, Error> {
        let window = &self.framebuffers.window;
        let (plane, depth) = match point {
            gl::FRONT_LEFT | gl::FRONT => (window.colors.first(), Point::Color(0)),
            gl::BACK_LEFT | gl::BACK => (window.colors.get(1), Point::Color(0)),
            gl::FRONT_RIGHT | gl::BACK_RIGHT | gl::AUX0..=gl::AUX3 => (None, Point::Color(0)),
            gl::DEPTH => (window.depth_stencil.as_ref(), Point::Depth),
            gl::STENCIL => (window.depth_stencil.as_ref(), Point::Stencil),
            _ => return Err(Error::InvalidEnum),
        };
        let plane = plane.filter(|plane| depth.takes(plane.format.base()));
        match (name, plane) {
            (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Some(_)) => Ok(gl::FRAMEBUFFER_DEFAULT as i32),
            (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, None) => Ok(gl::NONE as i32),
            (_, Some(plane)) => plane_value(plane, depth, name),
            (_, None) => Err(Error::InvalidOperation),
        }
    }
}

/// A parameter of an attachment.
fn attached_value(attachment: &Attachment, point: Point, name: Enum) -> Result<i32, Error> {
    let value = match (name, attachment) {
        (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Attachment::None) => gl::NONE,
        (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Attachment::Renderbuffer(_)) => gl::RENDERBUFFER,
        (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, Attachment::Texture(_)) => gl::TEXTURE,
        (gl::FRAMEBUFFER_ATTACHMENT_OBJECT_NAME, _) => attachment.name(),
        (_, Attachment::None) => return Err(Error::InvalidOperation),
        (gl::FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL, Attachment::Texture(image)) => image.level,
        (gl::FRAMEBUFFER_ATTACHMENT_TEXTURE_CUBE_MAP_FACE, Attachment::Texture(image)) => {
            let is_cube = image.texture.lock().target == TexTarget::Cube;
            if is_cube { gl::TEXTURE_CUBE_MAP_POSITIVE_X + image.face as u32 } else { 0 }
        }
        (gl::FRAMEBUFFER_ATTACHMENT_TEXTURE_LAYER, Attachment::Texture(image)) => image.layer,
        _ => {
            // Without storage there is nothing to measure.
            let Some(plane) = attachment.plane() else { return Ok(0) };
            return plane_value(&plane, point, name);
        }
    };
    Ok(value as i32)
}

/// A parameter of pixels.
fn plane_value(plane: &Plane, point: Point, name: Enum) -> Result<i32, Error> {
    let bits = |name| plane.format.bits(name).unwrap_or(0);
    let value = match name {
        gl::FRAMEBUFFER_ATTACHMENT_RED_SIZE => bits(gl::TEXTURE_RED_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_GREEN_SIZE => bits(gl::TEXTURE_GREEN_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_BLUE_SIZE => bits(gl::TEXTURE_BLUE_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE => bits(gl::TEXTURE_ALPHA_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE => bits(gl::TEXTURE_DEPTH_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE => bits(gl::TEXTURE_STENCIL_SIZE),
        gl::FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE => match point {
            Point::Stencil => gl::INDEX,
            Point::Depth if plane.format.is_float() => gl::FLOAT,
            _ => gl::UNSIGNED_NORMALIZED,
        },
        gl::FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING => {
            if plane.format.is_srgb() {
                gl::SRGB
            } else {
                gl::LINEAR
            }
        }
        _ => return Err(Error::InvalidEnum),
    };
    Ok(value as i32)
}
