//! Framebuffer objects and renderbuffers.

use crate::commands::names;
use crate::memory::{In, Out};

commands! { COMMANDS, c:
    glGenRenderbuffers | glGenRenderbuffersEXT(n: i32, out: Out<u32>) { out.write(&c.gen_renderbuffers(n)) }
    glDeleteRenderbuffers | glDeleteRenderbuffersEXT(n: i32, ids: In<u32>) {
        names(c, n, ids, |c, ids| c.delete_renderbuffers(ids))
    }
    glIsRenderbuffer | glIsRenderbufferEXT(name: u32) -> u8 { c.is_renderbuffer(name).into() }
    glBindRenderbuffer | glBindRenderbufferEXT(target: u32, name: u32) { c.bind_renderbuffer(target, name) }
    glRenderbufferStorage | glRenderbufferStorageEXT(target: u32, internal: u32, width: i32, height: i32) {
        c.renderbuffer_storage(target, internal, [width, height])
    }
    glRenderbufferStorageMultisample | glRenderbufferStorageMultisampleEXT(
        target: u32, samples: i32, internal: u32, width: i32, height: i32
    ) {
        c.renderbuffer_storage_multisample(target, samples, internal, [width, height])
    }
    glGetRenderbufferParameteriv | glGetRenderbufferParameterivEXT(target: u32, name: u32, out: Out<i32>) {
        out.put(c.get_renderbuffer_parameter(target, name))
    }

    glGenFramebuffers | glGenFramebuffersEXT(n: i32, out: Out<u32>) { out.write(&c.gen_framebuffers(n)) }
    glDeleteFramebuffers | glDeleteFramebuffersEXT(n: i32, ids: In<u32>) {
        names(c, n, ids, |c, ids| c.delete_framebuffers(ids))
    }
    glIsFramebuffer | glIsFramebufferEXT(name: u32) -> u8 { c.is_framebuffer(name).into() }
    glBindFramebuffer | glBindFramebufferEXT(target: u32, name: u32) { c.bind_framebuffer(target, name) }
    glCheckFramebufferStatus | glCheckFramebufferStatusEXT(target: u32) -> u32 {
        c.check_framebuffer_status(target)
    }
    glFramebufferRenderbuffer | glFramebufferRenderbufferEXT(target: u32, point: u32, of: u32, name: u32) {
        c.framebuffer_renderbuffer(target, point, of, name)
    }
    glFramebufferTexture1D | glFramebufferTexture1DEXT(target: u32, point: u32, of: u32, name: u32, level: i32) {
        c.framebuffer_texture_1d(target, point, of, name, level)
    }
    glFramebufferTexture2D | glFramebufferTexture2DEXT(target: u32, point: u32, of: u32, name: u32, level: i32) {
        c.framebuffer_texture_2d(target, point, of, name, level)
    }
    glFramebufferTexture3D | glFramebufferTexture3DEXT(
        target: u32, point: u32, of: u32, name: u32, level: i32, layer: i32
    ) {
        c.framebuffer_texture_3d(target, point, of, name, level, layer)
    }
    glFramebufferTextureLayer(target: u32, point: u32, name: u32, level: i32, layer: i32) {
        c.framebuffer_texture_layer(target, point, name, level, layer)
    }
    glGetFramebufferAttachmentParameteriv | glGetFramebufferAttachmentParameterivEXT(
        target: u32, point: u32, name: u32, out: Out<i32>
    ) {
        out.put(c.get_framebuffer_attachment_parameter(target, point, name))
    }
    glBlitFramebuffer | glBlitFramebufferEXT(
        x0: i32, y0: i32, x1: i32, y1: i32, to_x0: i32, to_y0: i32, to_x1: i32, to_y1: i32, mask: u32, filter: u32
    ) {
        c.blit_framebuffer([x0, y0, x1, y1], [to_x0, to_y0, to_x1, to_y1], mask, filter)
    }
}
