//! Questions about textures and framebuffers (OpenGL 1.5, tables 6.16 to 6.35).

use crate::framebuffer::{MAX_COLOR_ATTACHMENTS, MAX_RENDERBUFFER_SIZE, SAMPLES};
use crate::get::Answer;
use crate::state::TexTarget;
use crate::texture::{InternalFormat, MAX_3D_TEXTURE_SIZE, MAX_TEXTURE_SIZE};
use crate::{Context, Enum, gl};

impl Context {
    /// The answer to a name of `glGet*` that is about textures or framebuffers.
    pub(crate) fn image_answer(&self, name: Enum) -> Option<Answer> {
        self.binding_answer(name).or_else(|| self.buffer_bits(name)).or_else(|| image_limit(name))
    }

    fn binding_answer(&self, name: Enum) -> Option<Answer> {
        let texture = |target| Some(Answer::ints([self.bound_texture(target).lock().name]));
        let f = &self.framebuffers;
        match name {
            gl::TEXTURE_BINDING_1D => texture(TexTarget::One),
            gl::TEXTURE_BINDING_2D => texture(TexTarget::Two),
            gl::TEXTURE_BINDING_3D => texture(TexTarget::Three),
            gl::TEXTURE_BINDING_CUBE_MAP => texture(TexTarget::Cube),
            gl::DRAW_FRAMEBUFFER_BINDING => Some(Answer::ints([f.draw])),
            gl::READ_FRAMEBUFFER_BINDING => Some(Answer::ints([f.read])),
            gl::RENDERBUFFER_BINDING => {
                Some(Answer::ints([f.renderbuffer.as_ref().map_or(0, |buffer| buffer.lock().name)]))
            }
            gl::DRAW_BUFFER => Some(Answer::token(f.draw_buffer())),
            gl::READ_BUFFER => Some(Answer::token(f.read_buffer())),
            gl::SAMPLES => Some(Answer::ints([f.draw_samples()])),
            gl::SAMPLE_BUFFERS => Some(Answer::ints([u32::from(f.draw_samples() > 0)])),
            _ => None,
        }
    }

    /// Bits of a component of the framebuffer that is drawn to.
    fn buffer_bits(&self, name: Enum) -> Option<Answer> {
        let [color, depth, stencil] = self.framebuffers.draw_formats();
        let is_float = self.framebuffers.draw == 0 && self.config.float_color;
        let bits = |format: Option<InternalFormat>, name| {
            let bits = format.and_then(|format| format.bits(name)).unwrap_or(0);
            if is_float && bits == 16 { 32 } else { bits }
        };
        let accum = if self.framebuffers.draw == 0 && self.config.accum_bits > 0 { 32 } else { 0_u32 };
        let bits = match name {
            gl::RED_BITS => bits(color, gl::TEXTURE_RED_SIZE),
            gl::GREEN_BITS => bits(color, gl::TEXTURE_GREEN_SIZE),
            gl::BLUE_BITS => bits(color, gl::TEXTURE_BLUE_SIZE),
            gl::ALPHA_BITS => bits(color, gl::TEXTURE_ALPHA_SIZE),
            gl::DEPTH_BITS => bits(depth, gl::TEXTURE_DEPTH_SIZE),
            gl::STENCIL_BITS => bits(stencil, gl::TEXTURE_STENCIL_SIZE),
            gl::ACCUM_RED_BITS | gl::ACCUM_GREEN_BITS | gl::ACCUM_BLUE_BITS | gl::ACCUM_ALPHA_BITS => accum,
            _ => return None,
        };
        Some(Answer::ints([bits]))
    }
}

/// What there is at most.
fn image_limit(name: Enum) -> Option<Answer> {
    Some(match name {
        gl::MAX_TEXTURE_SIZE | gl::MAX_CUBE_MAP_TEXTURE_SIZE => Answer::ints([MAX_TEXTURE_SIZE]),
        gl::MAX_3D_TEXTURE_SIZE => Answer::ints([MAX_3D_TEXTURE_SIZE]),
        gl::MAX_RENDERBUFFER_SIZE => Answer::ints([MAX_RENDERBUFFER_SIZE]),
        gl::MAX_COLOR_ATTACHMENTS => Answer::int(MAX_COLOR_ATTACHMENTS),
        gl::MAX_SAMPLES => Answer::ints([SAMPLES]),
        gl::NUM_COMPRESSED_TEXTURE_FORMATS => Answer::int(0),
        gl::COMPRESSED_TEXTURE_FORMATS => Answer::ints::<u32>([]),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use crate::{Config, Context, gl};

    #[test]
    fn state_of_images_can_be_asked_for() {
        let mut c = Context::new(Config::default());
        assert!(c.resize(4, 4));
        let texture = c.gen_textures(1)[0];
        c.bind_texture(gl::TEXTURE_3D, texture);
        c.pixel_store(gl::PACK_SKIP_ROWS, 3);
        c.pixel_store(gl::UNPACK_LSB_FIRST, 1);
        c.pixel_transfer(gl::GREEN_SCALE, 0.5);
        c.pixel_map(gl::PIXEL_MAP_S_TO_S, &[1.0, 2.0]);
        c.pixel_zoom([2.0, -1.0]);
        for (name, value) in [
            (gl::TEXTURE_BINDING_3D, texture as i32),
            (gl::TEXTURE_BINDING_2D, 0),
            (gl::PACK_SKIP_ROWS, 3),
            (gl::UNPACK_SKIP_ROWS, 0),
            (gl::UNPACK_LSB_FIRST, 1),
            (gl::UNPACK_ALIGNMENT, 4),
            (gl::PIXEL_MAP_S_TO_S_SIZE, 2),
            (gl::PIXEL_MAP_A_TO_A_SIZE, 1),
            (gl::ZOOM_X, 2),
            (gl::DRAW_BUFFER, gl::FRONT as i32),
            (gl::READ_BUFFER, gl::FRONT as i32),
            (gl::DEPTH_BITS, 24),
            (gl::STENCIL_BITS, 8),
            (gl::ALPHA_BITS, 8),
            (gl::SAMPLES, 0),
            (gl::MAX_TEXTURE_SIZE, 8192),
            (gl::FRAMEBUFFER_BINDING, 0),
        ] {
            assert_eq!(c.get_integer(name)[..], [value], "{name:#x}");
        }
        assert_eq!(c.get_float(gl::GREEN_SCALE)[..], [0.5]);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }
}
