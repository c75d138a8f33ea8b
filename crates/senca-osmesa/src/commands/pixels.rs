//! Pixels.

use crate::memory::In;
use senca_gl::gl;

commands! { COMMANDS, c:
    glPixelStorei(name: u32, value: i32) { c.pixel_store(name, value) }
    glPixelStoref(name: u32, value: f32) { c.pixel_store(name, value.round() as i32) }
    glPixelTransferi(name: u32, value: i32) { c.pixel_transfer(name, value as f32) }
    glPixelTransferf(name: u32, value: f32) { c.pixel_transfer(name, value) }
    glPixelZoom(x: f32, y: f32) { c.pixel_zoom([x, y]) }
    glPolygonStipple(mask: In<u8>) {
        let size = senca_gl::pixel::image_bytes(&c.unpack_store(), [32, 32, 1], false, gl::COLOR_INDEX, gl::BITMAP);
        if let Ok(Some(size)) = size
            && let Some(bytes) = mask.bytes(size)
        {
            c.polygon_stipple(bytes)
        }
    }
}
