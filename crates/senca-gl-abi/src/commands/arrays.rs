//! Vertex arrays and buffers.

use crate::memory::{In, Out, Pointer};
use senca_gl::{ArraySource, Context, Enum, gl};
use std::ffi::c_void;

/// What a pointer of an array means.
fn vertices(c: &Context, pointer: Pointer) -> ArraySource {
    c.pointer_source(gl::ARRAY_BUFFER, pointer.address())
}

/// What a pointer to numbers of vertices means.
fn elements(c: &Context, pointer: Pointer) -> ArraySource {
    c.pointer_source(gl::ELEMENT_ARRAY_BUFFER, pointer.address())
}

/// Bytes of a buffer that the program gives; none for NULL or a size below zero.
fn data(bytes: &Pointer, size: isize) -> Option<&[u8]> {
    bytes.bytes(usize::try_from(size).ok()?)
}

fn draw_elements(c: &mut Context, mode: Enum, count: i32, kind: Enum, pointer: Pointer) {
    let source = elements(c, pointer);
    c.draw_elements_of(mode, count, kind, &source);
}

commands! { COMMANDS, c:
    glEnableClientState(array: u32) { c.enable_client_state(array) }
    glDisableClientState(array: u32) { c.disable_client_state(array) }
    glClientActiveTexture | glClientActiveTextureARB(unit: u32) { c.client_active_texture(unit) }
    glVertexPointer(size: i32, kind: u32, stride: i32, pointer: Pointer) {
        c.gl.vertex_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glNormalPointer(kind: u32, stride: i32, pointer: Pointer) {
        c.gl.normal_pointer(kind, stride, vertices(&c.gl, pointer))
    }
    glColorPointer(size: i32, kind: u32, stride: i32, pointer: Pointer) {
        c.gl.color_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glSecondaryColorPointer | glSecondaryColorPointerEXT(size: i32, kind: u32, stride: i32, pointer: Pointer) {
        c.gl.secondary_color_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glFogCoordPointer | glFogCoordPointerEXT(kind: u32, stride: i32, pointer: Pointer) {
        c.gl.fog_coord_pointer(kind, stride, vertices(&c.gl, pointer))
    }
    glIndexPointer(kind: u32, stride: i32, pointer: Pointer) {
        c.gl.index_pointer(kind, stride, vertices(&c.gl, pointer))
    }
    glEdgeFlagPointer(stride: i32, pointer: Pointer) {
        c.gl.edge_flag_pointer(stride, vertices(&c.gl, pointer))
    }
    glTexCoordPointer(size: i32, kind: u32, stride: i32, pointer: Pointer) {
        c.gl.tex_coord_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glVertexPointerEXT(size: i32, kind: u32, stride: i32, _count: i32, pointer: Pointer) {
        c.gl.vertex_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glNormalPointerEXT(kind: u32, stride: i32, _count: i32, pointer: Pointer) {
        c.gl.normal_pointer(kind, stride, vertices(&c.gl, pointer))
    }
    glColorPointerEXT(size: i32, kind: u32, stride: i32, _count: i32, pointer: Pointer) {
        c.gl.color_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glIndexPointerEXT(kind: u32, stride: i32, _count: i32, pointer: Pointer) {
        c.gl.index_pointer(kind, stride, vertices(&c.gl, pointer))
    }
    glEdgeFlagPointerEXT(stride: i32, _count: i32, pointer: In<u8>) {
        c.gl.edge_flag_pointer(stride, vertices(&c.gl, Pointer::at(pointer.address())))
    }
    glTexCoordPointerEXT(size: i32, kind: u32, stride: i32, _count: i32, pointer: Pointer) {
        c.gl.tex_coord_pointer(size, kind, stride, vertices(&c.gl, pointer))
    }
    glInterleavedArrays(format: u32, stride: i32, pointer: Pointer) {
        c.gl.interleaved_arrays(format, stride, &vertices(&c.gl, pointer))
    }

    glArrayElement | glArrayElementEXT(i: i32) { c.array_element(i) }
    glDrawArrays | glDrawArraysEXT(mode: u32, first: i32, count: i32) { c.draw_arrays(mode, first, count) }
    glDrawElements(mode: u32, count: i32, kind: u32, indices: Pointer) {
        draw_elements(c, mode, count, kind, indices)
    }
    glDrawRangeElements | glDrawRangeElementsEXT(
        mode: u32, start: u32, end: u32, count: i32, kind: u32, indices: Pointer
    ) {
        if end < start {
            return c.raise(gl::INVALID_VALUE);
        }
        draw_elements(c, mode, count, kind, indices)
    }
    glMultiDrawArrays | glMultiDrawArraysEXT(mode: u32, first: In<i32>, count: In<i32>, draws: i32) {
        let (first, count) = (first.values(draws), count.values(draws));
        if draws < 0 || count.iter().flatten().any(|n| *n < 0) {
            return c.raise(gl::INVALID_VALUE);
        }
        if let (Some(first), Some(count)) = (first, count) {
            for (first, count) in first.into_iter().zip(count) {
                c.draw_arrays(mode, first, count);
            }
        }
    }
    glMultiDrawElements | glMultiDrawElementsEXT(
        mode: u32, count: In<i32>, kind: u32, indices: In<Pointer>, draws: i32
    ) {
        let (count, indices) = (count.values(draws), indices.values(draws));
        if draws < 0 || count.iter().flatten().any(|n| *n < 0) {
            return c.raise(gl::INVALID_VALUE);
        }
        if let (Some(count), Some(indices)) = (count, indices) {
            for (count, indices) in count.into_iter().zip(indices) {
                draw_elements(c, mode, count, kind, indices);
            }
        }
    }

    glGenBuffers | glGenBuffersARB(n: i32, names: Out<u32>) { names.write(&c.gen_buffers(n)) }
    glDeleteBuffers | glDeleteBuffersARB(n: i32, names: In<u32>) {
        crate::commands::names(c, n, names, |c, names| c.delete_buffers(names));
    }
    glIsBuffer | glIsBufferARB(name: u32) -> u8 { c.is_buffer(name).into() }
    glBindBuffer | glBindBufferARB(target: u32, name: u32) { c.bind_buffer(target, name) }
    glBufferData | glBufferDataARB(target: u32, size: isize, bytes: Pointer, usage: u32) {
        c.buffer_data(target, size, data(&bytes, size), usage)
    }
    glBufferSubData | glBufferSubDataARB(target: u32, offset: isize, size: isize, bytes: Pointer) {
        match data(&bytes, size) {
            Some(bytes) => c.buffer_sub_data(target, offset, bytes),
            None if size < 0 => c.raise(gl::INVALID_VALUE),
            None => {}
        }
    }
    glGetBufferSubData | glGetBufferSubDataARB(target: u32, offset: isize, size: isize, bytes: Out<c_void>) {
        let mut bytes = bytes;
        match usize::try_from(size) {
            Ok(size) => if let Some(bytes) = bytes.bytes(size) { c.get_buffer_sub_data(target, offset, bytes) },
            Err(_) => c.raise(gl::INVALID_VALUE),
        }
    }
    glMapBuffer | glMapBufferARB(target: u32, access: u32) -> *mut c_void {
        c.map_buffer(target, access).map_or(std::ptr::null_mut(), <*mut u8>::cast)
    }
    glUnmapBuffer | glUnmapBufferARB(target: u32) -> u8 { c.unmap_buffer(target).into() }
    glGetBufferParameteriv | glGetBufferParameterivARB(target: u32, name: u32, out: Out<i32>) {
        out.put(c.get_buffer_parameter(target, name))
    }
    glGetBufferPointerv | glGetBufferPointervARB(target: u32, name: u32, out: Out<*mut c_void>) {
        out.put(c.get_buffer_pointer(target, name).map_or(std::ptr::null_mut(), <*mut u8>::cast))
    }
}
