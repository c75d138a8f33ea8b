//! Questions.

use crate::current::Current;
use crate::memory::{In, Out, Pointer};
use senca_gl::gl;
use senca_gl::pixel::{PixelLayout, PixelSink};
use std::collections::HashMap;
use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

/// A text with a closing zero that stays for ever; each is made once.
fn lasting(text: &'static str) -> *const u8 {
    static TEXTS: Mutex<Option<HashMap<&str, CString>>> = Mutex::new(None);
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    let text =
        texts.get_or_insert_default().entry(text).or_insert_with(|| CString::new(text).unwrap_or_default());
    text.as_ptr().cast()
}

/// Addresses that were given; those of the modes that this crate ends are its own.
fn pointer(c: &mut Current, name: u32) -> Option<usize> {
    match name {
        gl::SELECTION_BUFFER_POINTER => Some(c.select_buffer),
        gl::FEEDBACK_BUFFER_POINTER => Some(c.feedback_buffer),
        gl::DEBUG_CALLBACK_FUNCTION => Some(c.debug_callback[0]),
        gl::DEBUG_CALLBACK_USER_PARAM => Some(c.debug_callback[1]),
        _ => c.get_pointer(name),
    }
}

fn booleans(c: &mut Current, name: u32, out: Out<u8>) {
    let values: Vec<u8> = c.get_boolean(name).into_iter().map(u8::from).collect();
    out.write(&values);
}

/// Rows of a bit pattern of 32 x 32 as the program wants them.
fn polygon_stipple(c: &mut Current, mut out: Out<u8>) {
    let (Some(rows), store) = (c.get_polygon_stipple(), c.pack_store()) else { return };
    let size = [32, 32, 1];
    let Some(span) = store.span(PixelLayout::BITMAP, size, false) else { return };
    let Some(bytes) = out.bytes(span.bytes) else { return };
    let Some(mut sink) = PixelSink::new(bytes, &store, PixelLayout::BITMAP, size, false) else { return };
    for (y, row) in rows.iter().enumerate() {
        let bits: [u32; 32] = std::array::from_fn(|x| row >> (31 - x) & 1);
        sink.row(0, y).put_indices(0, &bits);
    }
}

commands! { COMMANDS, c:
    glGetBooleanv(name: u32, out: Out<u8>) { booleans(c, name, out) }
    glGetIntegerv(name: u32, out: Out<i32>) { out.write(&c.get_integer(name)) }
    glGetFloatv(name: u32, out: Out<f32>) { out.write(&c.get_float(name)) }
    glGetDoublev(name: u32, out: Out<f64>) { out.write(&c.get_double(name)) }
    glGetString(name: u32) -> *const u8 { c.get_string(name).map_or(std::ptr::null(), lasting) }
    glGetPointerv | glGetPointervEXT(name: u32, out: Out<Pointer>) {
        if let Some(address) = pointer(c, name) {
            out.put(In::at(address))
        }
    }
    glGetPolygonStipple(out: Out<u8>) { polygon_stipple(c, out) }
    glGetClipPlane(plane: u32, out: Out<f64>) {
        if let Some(equation) = c.get_clip_plane(plane) {
            out.write(&equation)
        }
    }
    glGetLightfv(light: u32, name: u32, out: Out<f32>) { out.write(&c.get_light(light, name)) }
    glGetLightiv(light: u32, name: u32, out: Out<i32>) { out.write(&c.get_light_integer(light, name)) }
    glGetMaterialfv(face: u32, name: u32, out: Out<f32>) { out.write(&c.get_material(face, name)) }
    glGetMaterialiv(face: u32, name: u32, out: Out<i32>) { out.write(&c.get_material_integer(face, name)) }
    glGetTexEnvfv(target: u32, name: u32, out: Out<f32>) { out.write(&c.get_tex_env(target, name)) }
    glGetTexEnviv(target: u32, name: u32, out: Out<i32>) { out.write(&c.get_tex_env_integer(target, name)) }
    glGetTexGendv(coordinate: u32, name: u32, out: Out<f64>) { out.write(&c.get_tex_gen(coordinate, name)) }
    glGetTexGenfv(coordinate: u32, name: u32, out: Out<f32>) {
        c.get_tex_gen(coordinate, name).iter().enumerate().for_each(|(k, v)| out.skip(k).put(*v as f32))
    }
    glGetTexGeniv(coordinate: u32, name: u32, out: Out<i32>) {
        c.get_tex_gen(coordinate, name).iter().enumerate().for_each(|(k, v)| out.skip(k).put(v.round() as i32))
    }
    glGetMapdv(target: u32, name: u32, out: Out<f64>) { out.write(&c.get_map(target, name)) }
    glGetMapfv(target: u32, name: u32, out: Out<f32>) {
        c.get_map(target, name).iter().enumerate().for_each(|(k, v)| out.skip(k).put(*v as f32))
    }
    glGetMapiv(target: u32, name: u32, out: Out<i32>) {
        c.get_map(target, name).iter().enumerate().for_each(|(k, v)| out.skip(k).put(v.round() as i32))
    }
}
