//! Framebuffer objects, what is bound, and what is complete.

use super::attach::{Attachment, Point, RenderbufferRef};
use super::plane::Plane;
use super::window::Window;
use crate::texture::{InternalFormat, Names, TextureRef};
use crate::{Config, Enum, Error, gl};

/// Points where colours can be attached.
pub(crate) const MAX_COLOR_ATTACHMENTS: usize = 8;

/// Renderbuffers of all contexts that share.
pub(crate) type Renderbuffers = Names<RenderbufferRef>;

/// A framebuffer object.
#[derive(Clone, Debug)]
pub(crate) struct FramebufferObject {
    pub(crate) colors: [Attachment; MAX_COLOR_ATTACHMENTS],
    pub(crate) depth: Attachment,
    pub(crate) stencil: Attachment,
    /// `COLOR_ATTACHMENT0` and so on, or `NONE`.
    pub(crate) draw_buffer: Enum,
    pub(crate) read_buffer: Enum,
}

impl Default for FramebufferObject {
    fn default() -> Self {
        Self {
            colors: Default::default(),
            depth: Attachment::None,
            stencil: Attachment::None,
            draw_buffer: gl::COLOR_ATTACHMENT0,
            read_buffer: gl::COLOR_ATTACHMENT0,
        }
    }
}

impl FramebufferObject {
    pub(crate) fn point(&self, point: Point) -> &Attachment {
        match point {
            Point::Color(i) => &self.colors[i],
            Point::Depth => &self.depth,
            Point::Stencil => &self.stencil,
        }
    }

    pub(crate) fn point_mut(&mut self, point: Point) -> &mut Attachment {
        match point {
            Point::Color(i) => &mut self.colors[i],
            Point::Depth => &mut self.depth,
            Point::Stencil => &mut self.stencil,
        }
    }

    /// Everything that is attached.
    pub(crate) fn attachments(&self) -> impl Iterator<Item = &Attachment> {
        self.points().map(|(_, attachment)| attachment).filter(|attachment| !attachment.is_none())
    }

    pub(crate) fn points(&self) -> impl Iterator<Item = (Point, &Attachment)> {
        let colors = self.colors.iter().enumerate().map(|(i, attachment)| (Point::Color(i), attachment));
        colors.chain([(Point::Depth, &self.depth), (Point::Stencil, &self.stencil)])
    }

    fn points_mut(&mut self) -> impl Iterator<Item = &mut Attachment> {
        self.colors.iter_mut().chain([&mut self.depth, &mut self.stencil])
    }

    /// Attachment that a draw or read buffer names; `None` for `NONE`.
    pub(crate) fn color_of(&self, buffer: Enum) -> Option<&Attachment> {
        self.colors.get(buffer.checked_sub(gl::COLOR_ATTACHMENT0)? as usize)
    }

    /// `FRAMEBUFFER_COMPLETE`, or what is missing.
    ///
    /// A draw or read buffer that names a point without an image is no fault, as later versions have it
    /// (ARB_ES2_compatibility): nothing is drawn to it, and reading from it is an error of its own.
    ///
    /// Source: ARB_framebuffer_object, section 4.4.4.2.
    pub(crate) fn status(&self) -> Enum {
        let mut samples = None;
        let mut any = false;
        for (point, attachment) in self.points().filter(|(_, attachment)| !attachment.is_none()) {
            any = true;
            let Some(plane) = attachment.plane() else { return gl::FRAMEBUFFER_INCOMPLETE_ATTACHMENT };
            let base = plane.format.base();
            if !point.takes(base) {
                // Luminance, intensity and alpha might be drawn to, but are not.
                let is_color = matches!(point, Point::Color(_)) && base.is_color();
                return if is_color {
                    gl::FRAMEBUFFER_UNSUPPORTED
                } else {
                    gl::FRAMEBUFFER_INCOMPLETE_ATTACHMENT
                };
            }
            if *samples.get_or_insert(plane.samples) != plane.samples {
                return gl::FRAMEBUFFER_INCOMPLETE_MULTISAMPLE;
            }
        }
        if !any {
            return gl::FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT;
        }
        gl::FRAMEBUFFER_COMPLETE
    }
}

/// Draw and read buffer, for the stack of attributes.
#[derive(Debug)]
pub(crate) struct SavedBuffers {
    draw: Enum,
    read: Enum,
}

/// What is drawn to and read from.
#[derive(Debug)]
pub(crate) struct Framebuffers {
    pub(crate) config: Config,
    pub(crate) window: Window,
    /// Whether there has been a window.
    pub(crate) had_window: bool,
    pub(crate) objects: Names<FramebufferObject>,
    /// Name of the framebuffer that is drawn to; 0 is the window.
    pub(crate) draw: u32,
    /// Name of the framebuffer that is read from.
    pub(crate) read: u32,
    pub(crate) renderbuffer: Option<RenderbufferRef>,
    /// The window's buffers to draw to and read from.
    pub(crate) window_draw: Enum,
    pub(crate) window_read: Enum,
    /// Planes that copies of pixels are made in; what is in them does not matter.
    pub(crate) spares: Vec<Plane>,
}

impl Framebuffers {
    pub(crate) fn new(config: Config) -> Self {
        let buffer = if config.double_buffered { gl::BACK } else { gl::FRONT };
        Self {
            config,
            window: Window::NONE,
            had_window: false,
            objects: Names::default(),
            draw: 0,
            read: 0,
            renderbuffer: None,
            window_draw: buffer,
            window_read: buffer,
            spares: Vec::new(),
        }
    }

    pub(crate) fn has_window(&self) -> bool {
        self.window.width > 0
    }

    /// Gives the window's buffers a size; `false` when there is no memory.
    pub(crate) fn resize_window(&mut self, width: u32, height: u32) -> bool {
        if width.max(height) > senca_raster::MAX_TARGET_SIDE {
            return false;
        }
        let Some(window) = Window::new(self.config, width, height) else { return false };
        self.window = window;
        self.had_window = true;
        true
    }

    /// The object that is drawn to; `None` for the window.
    pub(crate) fn draw_object(&self) -> Option<&FramebufferObject> {
        self.objects.get_ref(self.draw)
    }

    /// The object that is read from; `None` for the window.
    pub(crate) fn read_object(&self) -> Option<&FramebufferObject> {
        self.objects.get_ref(self.read)
    }

    pub(crate) fn draw_buffer(&self) -> Enum {
        self.draw_object().map_or(self.window_draw, |object| object.draw_buffer)
    }

    pub(crate) fn read_buffer(&self) -> Enum {
        self.read_object().map_or(self.window_read, |object| object.read_buffer)
    }

    pub(crate) fn save_buffers(&self) -> SavedBuffers {
        SavedBuffers { draw: self.draw_buffer(), read: self.read_buffer() }
    }

    pub(crate) fn restore_buffers(&mut self, saved: SavedBuffers, draw: bool, read: bool) {
        // Another framebuffer may be bound than when they were saved: what it does not have stays.
        if draw {
            let _ = self.set_draw_buffer(saved.draw);
        }
        if read {
            let _ = self.set_read_buffer(saved.read);
        }
    }

    /// Sets what is drawn to of the bound framebuffer.
    pub(crate) fn set_draw_buffer(&mut self, buffer: Enum) -> Result<(), Error> {
        if self.draw == 0 {
            window_colors(buffer, self.config.double_buffered)?;
            self.window_draw = buffer;
        } else {
            check_attachment_buffer(buffer)?;
            let name = self.draw;
            if let Some(object) = self.objects.get_mut(name) {
                object.draw_buffer = buffer;
            }
        }
        Ok(())
    }

    /// Sets what is read of the bound framebuffer.
    pub(crate) fn set_read_buffer(&mut self, buffer: Enum) -> Result<(), Error> {
        if self.read == 0 {
            if buffer == gl::FRONT_AND_BACK {
                return Err(Error::InvalidEnum);
            }
            window_colors(buffer, self.config.double_buffered)?;
            self.window_read = buffer;
        } else {
            check_attachment_buffer(buffer)?;
            let name = self.read;
            if let Some(object) = self.objects.get_mut(name) {
                object.read_buffer = buffer;
            }
        }
        Ok(())
    }

    /// Whether the framebuffer that is drawn to is complete.
    pub(crate) fn draw_status(&self) -> Enum {
        status(self.draw_object(), self)
    }

    /// Whether the framebuffer that is read from is complete.
    pub(crate) fn read_status(&self) -> Enum {
        status(self.read_object(), self)
    }

    /// Whether the colours drawn to have an alpha of their own. If not, theirs is 1 and must stay so.
    pub(crate) fn draws_alpha(&self) -> bool {
        let color = self.draw_object().and_then(|object| object.color_of(object.draw_buffer));
        color.and_then(Attachment::plane).is_none_or(|plane| plane.format.base().has_alpha())
    }

    /// Formats of colour, depth and stencil of the framebuffer that is drawn to.
    pub(crate) fn draw_formats(&self) -> [Option<InternalFormat>; 3] {
        let format = |plane: Option<Plane>| plane.map(|plane| plane.format);
        match self.draw_object() {
            Some(object) => {
                let color = object.color_of(object.draw_buffer).and_then(Attachment::plane);
                [format(color), format(object.depth.plane()), format(object.stencil.plane())]
            }
            None => {
                let depth_stencil = format(self.window.depth_stencil.clone());
                [format(self.window.colors.first().cloned()), depth_stencil, depth_stencil]
            }
        }
    }

    /// Samples of the framebuffer that is drawn to.
    pub(crate) fn draw_samples(&self) -> u32 {
        samples(self.draw_object())
    }

    /// Samples of the framebuffer that is read from.
    pub(crate) fn read_samples(&self) -> u32 {
        samples(self.read_object())
    }

    /// A deleted texture goes from the framebuffers that are bound.
    pub(crate) fn detach_texture(&mut self, texture: &TextureRef) {
        self.detach(
            |attachment| matches!(attachment, Attachment::Texture(image) if image.texture.is(texture)),
        );
    }

    /// A deleted renderbuffer goes from the framebuffers that are bound.
    pub(crate) fn detach_renderbuffer(&mut self, buffer: &RenderbufferRef) {
        self.detach(|attachment| matches!(attachment, Attachment::Renderbuffer(found) if found.is(buffer)));
        if self.renderbuffer.as_ref().is_some_and(|bound| bound.is(buffer)) {
            self.renderbuffer = None;
        }
    }

    fn detach(&mut self, is_meant: impl Fn(&Attachment) -> bool) {
        for name in [self.draw, self.read] {
            let Some(object) = self.objects.get_mut(name) else { continue };
            object.points_mut().filter(|point| is_meant(point)).for_each(|point| *point = Attachment::None);
        }
    }

    /// Colours that are read, shared; `None` if there are none.
    pub(crate) fn read_color(&self) -> Option<Plane> {
        match self.read_object() {
            Some(object) => object.color_of(object.read_buffer)?.plane(),
            None => {
                let colors = window_colors(self.window_read, self.config.double_buffered).ok()?;
                self.window.colors.get(*colors.first()?).cloned()
            }
        }
    }

    /// Depths or stencil values that are read, shared; `None` if there are none.
    pub(crate) fn read_depth_or_stencil(&self, depth: bool) -> Option<Plane> {
        let plane = match self.read_object() {
            Some(object) if depth => object.depth.plane(),
            Some(object) => object.stencil.plane(),
            None => self.window.depth_stencil.clone(),
        };
        let has = |plane: &Plane| {
            let base = plane.format.base();
            if depth { base.has_depth() } else { base.has_stencil() }
        };
        plane.filter(has)
    }
}

fn status(object: Option<&FramebufferObject>, framebuffers: &Framebuffers) -> Enum {
    match object {
        Some(object) => object.status(),
        None if framebuffers.has_window() => gl::FRAMEBUFFER_COMPLETE,
        None => gl::FRAMEBUFFER_UNDEFINED,
    }
}

fn samples(object: Option<&FramebufferObject>) -> u32 {
    let planes = object.into_iter().flat_map(|object| object.points().map(|(_, point)| point.plane()));
    planes.flatten().map(|plane| plane.samples).max().unwrap_or(0)
}

/// Numbers of the window's colour buffers (0 front, 1 back) that a name stands for.
///
/// # Errors
/// [`Error::InvalidEnum`] for no such name, [`Error::InvalidOperation`] for a buffer that is not there.
pub(crate) fn window_colors(buffer: Enum, double: bool) -> Result<Vec<usize>, Error> {
    match buffer {
        gl::NONE => Ok(Vec::new()),
        gl::FRONT | gl::FRONT_LEFT => Ok(vec![0]),
        gl::BACK | gl::BACK_LEFT if double => Ok(vec![1]),
        gl::LEFT | gl::FRONT_AND_BACK if double => Ok(vec![0, 1]),
        gl::LEFT | gl::FRONT_AND_BACK => Ok(vec![0]),
        gl::BACK | gl::BACK_LEFT | gl::RIGHT | gl::FRONT_RIGHT | gl::BACK_RIGHT => {
            Err(Error::InvalidOperation)
        }
        gl::AUX0..=gl::AUX3 => Err(Error::InvalidOperation),
        gl::COLOR_ATTACHMENT0..=gl::COLOR_ATTACHMENT15 => Err(Error::InvalidOperation),
        _ => Err(Error::InvalidEnum),
    }
}

/// Whether a framebuffer object can have a buffer of this name.
fn check_attachment_buffer(buffer: Enum) -> Result<(), Error> {
    const LAST: Enum = gl::COLOR_ATTACHMENT0 + MAX_COLOR_ATTACHMENTS as Enum - 1;
    match buffer {
        gl::NONE | gl::COLOR_ATTACHMENT0..=LAST => Ok(()),
        gl::COLOR_ATTACHMENT0..=gl::COLOR_ATTACHMENT15 | gl::FRONT_LEFT..=gl::AUX3 => {
            Err(Error::InvalidOperation)
        }
        _ => Err(Error::InvalidEnum),
    }
}
