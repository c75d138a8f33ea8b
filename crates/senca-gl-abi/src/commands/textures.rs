//! Textures.

use crate::commands::parameters::{is_color, one};
use crate::commands::pixels::{image, image_mut};
use crate::memory::{Few, In, Out, Plain, Pointer};
use senca_gl::{Component, Context, gl};

/// Values of a parameter; none for NULL.
fn values<T: Component + Plain>(name: u32, v: In<T>) -> Few<f64> {
    let number = |v: T| f64::from(if is_color(name) { v.normalized() } else { v.value() });
    let count = if name == gl::TEXTURE_BORDER_COLOR { 4 } else { 1 };
    v.values(count).unwrap_or_default().into_iter().map(number).collect()
}

/// A parameter given as a number.
fn single<T: Component>(name: u32, v: T) -> Few<f64> {
    one(name, v).into_iter().map(f64::from).collect()
}

/// A colour fills the range of the integers.
fn integers(name: u32, v: &[f64]) -> Few<i32> {
    let number = |v: f64| match name {
        gl::TEXTURE_BORDER_COLOR | gl::TEXTURE_PRIORITY => {
            ((v * f64::from(u32::MAX) - 1.0) / 2.0).round_ties_even()
        }
        _ => v.round(),
    };
    v.iter().map(|v| number(*v) as i32).collect()
}

fn prioritize(c: &mut Context, n: i32, names: In<u32>, priorities: In<f32>) {
    if n < 0 {
        return c.raise(gl::INVALID_VALUE);
    }
    if let (Some(names), Some(priorities)) = (names.values(n), priorities.values(n)) {
        let pairs: Vec<(u32, f32)> = names.into_iter().zip(priorities).collect();
        c.prioritize_textures(&pairs);
    }
}

/// Whether all are resident, which all textures are; answers for each are written only when some is not.
fn resident(c: &mut Context, n: i32, names: In<u32>) -> u8 {
    match names.values(n) {
        Some(names) => c.are_textures_resident(&names).into(),
        None => {
            if n < 0 {
                c.raise(gl::INVALID_VALUE);
            }
            0
        }
    }
}

fn get_image(c: &mut Context, target: u32, level: i32, format: u32, kind: u32, out: Pointer) {
    let size = c.tex_level_size(target, level).map(|n| n as i32);
    let mut out = Out::<u8>::at(out.address());
    let bytes = image_mut(c, &mut out, size, target == gl::TEXTURE_3D, format, kind);
    c.get_tex_image(target, level, format, kind, bytes.unwrap_or_default());
}

commands! { COMMANDS, c:
    glGenTextures | glGenTexturesEXT(n: i32, names: Out<u32>) { names.write(&c.gen_textures(n)) }
    glDeleteTextures | glDeleteTexturesEXT(n: i32, names: In<u32>) {
        crate::commands::names(c, n, names, |c, names| c.delete_textures(names))
    }
    glIsTexture | glIsTextureEXT(name: u32) -> u8 { c.is_texture(name).into() }
    glBindTexture | glBindTextureEXT(target: u32, name: u32) { c.bind_texture(target, name) }
    glPrioritizeTextures | glPrioritizeTexturesEXT(n: i32, names: In<u32>, priorities: In<f32>) {
        prioritize(c, n, names, priorities)
    }
    glAreTexturesResident | glAreTexturesResidentEXT(n: i32, names: In<u32>, _each: Out<u8>) -> u8 {
        resident(c, n, names)
    }

    glTexParameterf(target: u32, name: u32, v: f32) { c.tex_parameter(target, name, &single(name, v)) }
    glTexParameteri(target: u32, name: u32, v: i32) { c.tex_parameter(target, name, &single(name, v)) }
    glTexParameterfv(target: u32, name: u32, v: In<f32>) { c.tex_parameter(target, name, &values(name, v)) }
    glTexParameteriv(target: u32, name: u32, v: In<i32>) { c.tex_parameter(target, name, &values(name, v)) }
    glGetTexParameterfv(target: u32, name: u32, out: Out<f32>) {
        c.get_tex_parameter(target, name).iter().enumerate().for_each(|(k, v)| out.skip(k).put(*v as f32))
    }
    glGetTexParameteriv(target: u32, name: u32, out: Out<i32>) {
        out.write(&integers(name, &c.get_tex_parameter(target, name)))
    }
    glGetTexLevelParameterfv(target: u32, level: i32, name: u32, out: Out<f32>) {
        if let Some(v) = c.get_tex_level_parameter(target, level, name) { out.put(v as f32) }
    }
    glGetTexLevelParameteriv(target: u32, level: i32, name: u32, out: Out<i32>) {
        if let Some(v) = c.get_tex_level_parameter(target, level, name) { out.put(v) }
    }

    glTexImage1D(
        target: u32, level: i32, internal: i32, width: i32, border: i32, format: u32, kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, 1, 1], false, format, kind);
        c.tex_image_1d(target, level, internal, width, border, format, kind, data)
    }
    glTexImage2D(
        target: u32, level: i32, internal: i32, width: i32, height: i32, border: i32, format: u32, kind: u32,
        data: Pointer
    ) {
        let data = image(c, &data, [width, height, 1], false, format, kind);
        c.tex_image_2d(target, level, internal, [width, height], border, format, kind, data)
    }
    glTexImage3D(
        target: u32, level: i32, internal: i32, width: i32, height: i32, depth: i32, border: i32, format: u32,
        kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, height, depth], true, format, kind);
        c.tex_image_3d(target, level, internal, [width, height, depth], border, format, kind, data)
    }
    glTexImage3DEXT(
        target: u32, level: i32, internal: u32, width: i32, height: i32, depth: i32, border: i32, format: u32,
        kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, height, depth], true, format, kind);
        c.tex_image_3d(target, level, internal as i32, [width, height, depth], border, format, kind, data)
    }
    glTexSubImage1D | glTexSubImage1DEXT(
        target: u32, level: i32, x: i32, width: i32, format: u32, kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, 1, 1], false, format, kind);
        c.tex_sub_image_1d(target, level, x, width, format, kind, data)
    }
    glTexSubImage2D | glTexSubImage2DEXT(
        target: u32, level: i32, x: i32, y: i32, width: i32, height: i32, format: u32, kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, height, 1], false, format, kind);
        c.tex_sub_image_2d(target, level, [x, y], [width, height], format, kind, data)
    }
    glTexSubImage3D | glTexSubImage3DEXT(
        target: u32, level: i32, x: i32, y: i32, z: i32, width: i32, height: i32, depth: i32, format: u32,
        kind: u32, data: Pointer
    ) {
        let data = image(c, &data, [width, height, depth], true, format, kind);
        c.tex_sub_image_3d(target, level, [x, y, z], [width, height, depth], format, kind, data)
    }
    glGetTexImage(target: u32, level: i32, format: u32, kind: u32, out: Out<std::ffi::c_void>) {
        get_image(c, target, level, format, kind, In::at(out.address()))
    }

    glCopyTexImage1D | glCopyTexImage1DEXT(
        target: u32, level: i32, internal: u32, x: i32, y: i32, width: i32, border: i32
    ) {
        c.copy_tex_image_1d(target, level, internal, [x, y], width, border)
    }
    glCopyTexImage2D | glCopyTexImage2DEXT(
        target: u32, level: i32, internal: u32, x: i32, y: i32, width: i32, height: i32, border: i32
    ) {
        c.copy_tex_image_2d(target, level, internal, [x, y], [width, height], border)
    }
    glCopyTexSubImage1D | glCopyTexSubImage1DEXT(
        target: u32, level: i32, to_x: i32, x: i32, y: i32, width: i32
    ) {
        c.copy_tex_sub_image_1d(target, level, to_x, [x, y], width)
    }
    glCopyTexSubImage2D | glCopyTexSubImage2DEXT(
        target: u32, level: i32, to_x: i32, to_y: i32, x: i32, y: i32, width: i32, height: i32
    ) {
        c.copy_tex_sub_image_2d(target, level, [to_x, to_y], [x, y], [width, height])
    }
    glCopyTexSubImage3D | glCopyTexSubImage3DEXT(
        target: u32, level: i32, to_x: i32, to_y: i32, to_z: i32, x: i32, y: i32, width: i32, height: i32
    ) {
        c.copy_tex_sub_image_3d(target, level, [to_x, to_y, to_z], [x, y], [width, height])
    }

    glCompressedTexImage1D | glCompressedTexImage1DARB(
        target: u32, level: i32, internal: u32, _width: i32, _border: i32, _bytes: i32, _data: Pointer
    ) {
        c.compressed_tex_image(target, level, internal, None)
    }
    glCompressedTexImage2D | glCompressedTexImage2DARB(
        target: u32, level: i32, internal: u32, _width: i32, _height: i32, _border: i32, _bytes: i32, _data: Pointer
    ) {
        c.compressed_tex_image(target, level, internal, None)
    }
    glCompressedTexImage3D | glCompressedTexImage3DARB(
        target: u32, level: i32, internal: u32, _width: i32, _height: i32, _depth: i32, _border: i32, _bytes: i32,
        _data: Pointer
    ) {
        c.compressed_tex_image(target, level, internal, None)
    }
    glCompressedTexSubImage1D | glCompressedTexSubImage1DARB(
        target: u32, level: i32, _x: i32, _width: i32, format: u32, _bytes: i32, _data: Pointer
    ) {
        c.compressed_tex_sub_image(target, level, format, None)
    }
    glCompressedTexSubImage2D | glCompressedTexSubImage2DARB(
        target: u32, level: i32, _x: i32, _y: i32, _width: i32, _height: i32, format: u32, _bytes: i32,
        _data: Pointer
    ) {
        c.compressed_tex_sub_image(target, level, format, None)
    }
    glCompressedTexSubImage3D | glCompressedTexSubImage3DARB(
        target: u32, level: i32, _x: i32, _y: i32, _z: i32, _width: i32, _height: i32, _depth: i32, format: u32,
        _bytes: i32, _data: Pointer
    ) {
        c.compressed_tex_sub_image(target, level, format, None)
    }
    glGetCompressedTexImage | glGetCompressedTexImageARB(target: u32, level: i32, _out: Out<std::ffi::c_void>) {
        c.get_compressed_tex_image(target, level)
    }
    glGenerateMipmap | glGenerateMipmapEXT(target: u32) { c.generate_mipmap(target) }
}
