//! Pixels.

use crate::memory::{Few, In, Out, Pointer};
use senca_gl::pixel::{PixelStore, image_bytes};
use senca_gl::{Component, Context, gl};
use std::ffi::c_void;

/// Bytes of an image; `None` for one that is none.
fn bytes(store: &PixelStore, size: [i32; 3], volume: bool, format: u32, kind: u32) -> Option<usize> {
    let [width, height, depth] = size.map(|n| u32::try_from(n).ok());
    image_bytes(store, [width?, height?, depth?], volume, format, kind).ok()?
}

/// An image that a command reads; none for NULL, and where the numbers make no image.
pub(crate) fn image<'a>(
    c: &Context,
    data: &'a Pointer,
    size: [i32; 3],
    volume: bool,
    format: u32,
    kind: u32,
) -> Option<&'a [u8]> {
    data.bytes(bytes(&c.unpack_store(), size, volume, format, kind)?)
}

/// An image that a command writes.
pub(crate) fn image_mut<'a>(
    c: &Context,
    out: &'a mut Out<u8>,
    size: [i32; 3],
    volume: bool,
    format: u32,
    kind: u32,
) -> Option<&'a mut [u8]> {
    out.bytes(bytes(&c.pack_store(), size, volume, format, kind)?)
}

fn read_pixels(c: &mut Context, from: [i32; 2], size: [i32; 2], format: u32, kind: u32, out: Out<c_void>) {
    let mut out = Out::<u8>::at(out.address());
    let bytes = image_mut(c, &mut out, [size[0], size[1], 1], false, format, kind);
    c.read_pixels(from, size, format, kind, bytes.unwrap_or_default());
}

/// A map of numbers that are a part of `top`.
fn pixel_map<T: Component + crate::memory::Plain>(c: &mut Context, map: u32, n: i32, v: In<T>) {
    let by_index = matches!(map, gl::PIXEL_MAP_I_TO_I | gl::PIXEL_MAP_S_TO_S);
    let number = |v: T| if by_index { v.value() } else { v.normalized() };
    match v.values(n) {
        Some(v) => c.pixel_map(map, &v.into_iter().map(number).collect::<Few<f32>>()),
        None if n < 0 => c.raise(gl::INVALID_VALUE),
        None => {}
    }
}

/// Numbers of a map, as parts of `top` where they are colours.
fn get_pixel_map(c: &mut Context, map: u32, top: f64) -> Vec<f64> {
    let by_index = matches!(map, gl::PIXEL_MAP_I_TO_I | gl::PIXEL_MAP_S_TO_S);
    let number = |v: &f32| if by_index { f64::from(*v) } else { (f64::from(*v) * top).round() };
    c.get_pixel_map(map).iter().map(number).collect()
}

commands! { COMMANDS, c:
    glPixelStorei(name: u32, value: i32) { c.pixel_store(name, value) }
    glPixelStoref(name: u32, value: f32) { c.pixel_store(name, value.round() as i32) }
    glPixelTransferi(name: u32, value: i32) { c.pixel_transfer(name, value as f32) }
    glPixelTransferf(name: u32, value: f32) { c.pixel_transfer(name, value) }
    glPixelMapfv(map: u32, n: i32, v: In<f32>) { pixel_map(c, map, n, v) }
    glPixelMapuiv(map: u32, n: i32, v: In<u32>) { pixel_map(c, map, n, v) }
    glPixelMapusv(map: u32, n: i32, v: In<u16>) { pixel_map(c, map, n, v) }
    glGetPixelMapfv(map: u32, out: Out<f32>) { out.write(&c.get_pixel_map(map)) }
    glGetPixelMapuiv(map: u32, out: Out<u32>) {
        let values = get_pixel_map(c, map, f64::from(u32::MAX));
        values.iter().enumerate().for_each(|(k, v)| out.skip(k).put(*v as u32))
    }
    glGetPixelMapusv(map: u32, out: Out<u16>) {
        let values = get_pixel_map(c, map, f64::from(u16::MAX));
        values.iter().enumerate().for_each(|(k, v)| out.skip(k).put(*v as u16))
    }
    glPixelZoom(x: f32, y: f32) { c.pixel_zoom([x, y]) }
    glPolygonStipple(mask: In<u8>) {
        let mask = Pointer::at(mask.address());
        if let Some(bytes) = image(c, &mask, [32, 32, 1], false, gl::COLOR_INDEX, gl::BITMAP) {
            c.polygon_stipple(bytes)
        }
    }
    glBitmap(width: i32, height: i32, x: f32, y: f32, dx: f32, dy: f32, bits: In<u8>) {
        let bits = Pointer::at(bits.address());
        let bits = image(c, &bits, [width, height, 1], false, gl::COLOR_INDEX, gl::BITMAP);
        c.bitmap([width, height], [x, y], [dx, dy], bits)
    }
    glDrawPixels(width: i32, height: i32, format: u32, kind: u32, data: Pointer) {
        let data = image(c, &data, [width, height, 1], false, format, kind);
        c.draw_pixels([width, height], format, kind, data.unwrap_or_default())
    }
    glReadPixels(x: i32, y: i32, width: i32, height: i32, format: u32, kind: u32, out: Out<c_void>) {
        read_pixels(c, [x, y], [width, height], format, kind, out)
    }
    glCopyPixels(x: i32, y: i32, width: i32, height: i32, content: u32) {
        c.copy_pixels([x, y], [width, height], content)
    }
    glDrawBuffer(buffer: u32) { c.draw_buffer(buffer) }
    glReadBuffer(buffer: u32) { c.read_buffer(buffer) }
    glAccum(op: u32, value: f32) { c.accum(op, value) }
}
