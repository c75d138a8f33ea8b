//! Commands on textures, through a context.

use crate::{Config, Context, Enum, gl};

fn context() -> Context {
    let mut c = Context::new(Config::default());
    assert!(c.resize(4, 4));
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    c.pixel_store(gl::PACK_ALIGNMENT, 1);
    c
}

fn image_2d(c: &mut Context, target: Enum, level: i32, size: [i32; 2], values: &[u8]) {
    let internal = gl::LUMINANCE as i32;
    c.tex_image_2d(target, level, internal, size, 0, gl::LUMINANCE, gl::UNSIGNED_BYTE, Some(values));
}

fn luminances(c: &mut Context, target: Enum, level: i32) -> Vec<u8> {
    let n = c.tex_level_size(target, level).iter().product::<u32>();
    let mut out = vec![0xee; n as usize];
    c.get_tex_image(target, level, gl::LUMINANCE, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out
}

fn level(c: &mut Context, target: Enum, level: i32, name: Enum) -> i32 {
    c.get_tex_level_parameter(target, level, name).expect("a parameter")
}

#[test]
fn images_come_and_go() {
    let mut c = context();
    image_2d(&mut c, gl::TEXTURE_2D, 0, [2, 2], &[1, 2, 3, 4]);
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [1, 2, 3, 4]);
    c.tex_sub_image_2d(gl::TEXTURE_2D, 0, [1, 0], [1, 2], gl::LUMINANCE, gl::UNSIGNED_BYTE, Some(&[8, 9]));
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [1, 8, 3, 9]);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_WIDTH), 2);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_INTERNAL_FORMAT), gl::LUMINANCE as i32);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_LUMINANCE_SIZE), 8);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 3, gl::TEXTURE_WIDTH), 0);
    image_2d(&mut c, gl::TEXTURE_2D, 0, [0, 2], &[]);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_HEIGHT), 0);
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

#[test]
fn borders_count_from_minus_one() {
    let mut c = context();
    let (format, ty) = (gl::LUMINANCE, gl::UNSIGNED_BYTE);
    c.tex_image_1d(gl::TEXTURE_1D, 0, 1, 4, 1, format, ty, Some(&[1, 2, 3, 4]));
    c.tex_sub_image_1d(gl::TEXTURE_1D, 0, -1, 2, format, ty, Some(&[9, 8]));
    assert_eq!(luminances(&mut c, gl::TEXTURE_1D, 0), [9, 8, 3, 4]);
    assert_eq!(level(&mut c, gl::TEXTURE_1D, 0, gl::TEXTURE_WIDTH), 4);
    assert_eq!(level(&mut c, gl::TEXTURE_1D, 0, gl::TEXTURE_BORDER), 1);
    c.tex_sub_image_1d(gl::TEXTURE_1D, 0, 2, 2, format, ty, Some(&[9, 8]));
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
}

#[test]
fn wrong_images_are_refused() {
    let mut c = context();
    let (rgba, byte) = (gl::RGBA, gl::UNSIGNED_BYTE);
    let data = [0u8; 64];
    let mut wrong = |target, level, internal: u32, size, border, format, ty, error: Enum| {
        c.tex_image_2d(target, level, internal as i32, size, border, format, ty, Some(&data));
        assert_eq!(
            c.get_error(),
            error,
            "{target:#x} {level} {internal:#x} {size:?} {border} {format:#x} {ty:#x}"
        );
    };
    let t = gl::TEXTURE_2D;
    wrong(gl::TEXTURE_1D, 0, rgba, [2, 2], 0, rgba, byte, gl::INVALID_ENUM);
    wrong(gl::TEXTURE_CUBE_MAP, 0, rgba, [2, 2], 0, rgba, byte, gl::INVALID_ENUM);
    wrong(gl::TEXTURE_3D, 0, rgba, [2, 2], 0, rgba, byte, gl::INVALID_ENUM);
    wrong(t, -1, rgba, [2, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 14, rgba, [2, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 13, rgba, [2, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, 5, [2, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [2, 2], 2, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [-1, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [1, 2], 1, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [i32::MIN, 2], 1, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [8193, 2], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(gl::TEXTURE_CUBE_MAP_NEGATIVE_Z, 0, rgba, [2, 4], 0, rgba, byte, gl::INVALID_VALUE);
    wrong(t, 0, rgba, [2, 2], 0, gl::STENCIL_INDEX, byte, gl::INVALID_ENUM);
    wrong(t, 0, rgba, [2, 2], 0, rgba, gl::BITMAP, gl::INVALID_ENUM);
    wrong(t, 0, rgba, [2, 2], 0, gl::RGB, gl::UNSIGNED_INT_8_8_8_8, gl::INVALID_OPERATION);
    wrong(t, 0, rgba, [2, 2], 0, gl::DEPTH_COMPONENT, byte, gl::INVALID_OPERATION);
    wrong(t, 0, gl::DEPTH_COMPONENT, [2, 2], 0, rgba, byte, gl::INVALID_OPERATION);
    // Fewer bytes than pixels.
    wrong(t, 0, rgba, [16, 16], 0, rgba, byte, gl::INVALID_OPERATION);
    assert_eq!(level(&mut c, t, 0, gl::TEXTURE_WIDTH), 0);
    // Depths have no third dimension, but the faces of a cube.
    let (depth, texels) = (gl::DEPTH_COMPONENT, [0; 8]);
    c.tex_image_3d(gl::TEXTURE_3D, 0, depth as i32, [2, 2, 2], 0, depth, byte, Some(&texels));
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    let cube = gl::TEXTURE_CUBE_MAP_POSITIVE_X;
    c.tex_image_2d(cube, 0, depth as i32, [2, 2], 0, depth, byte, Some(&texels));
    assert_eq!((c.get_error(), level(&mut c, cube, 0, gl::TEXTURE_WIDTH)), (gl::NO_ERROR, 2));
}

#[test]
fn wrong_parts_are_refused() {
    let mut c = context();
    let t = gl::TEXTURE_2D;
    c.tex_sub_image_2d(t, 0, [0, 0], [1, 1], gl::RED, gl::UNSIGNED_BYTE, Some(&[1]));
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    image_2d(&mut c, t, 0, [2, 2], &[1, 2, 3, 4]);
    for (offset, size, format, error) in [
        ([1, 0], [2, 1], gl::RED, gl::INVALID_VALUE),
        ([-1, 0], [1, 1], gl::RED, gl::INVALID_VALUE),
        ([0, i32::MAX], [1, i32::MAX], gl::RED, gl::INVALID_VALUE),
        ([0, 0], [-1, 1], gl::RED, gl::INVALID_VALUE),
        ([0, 0], [1, 1], gl::DEPTH_COMPONENT, gl::INVALID_OPERATION),
        ([0, 0], [1, 1], gl::STENCIL_INDEX, gl::INVALID_ENUM),
    ] {
        c.tex_sub_image_2d(t, 0, offset, size, format, gl::UNSIGNED_BYTE, Some(&[9; 4]));
        assert_eq!(c.get_error(), error);
    }
    assert_eq!(luminances(&mut c, t, 0), [1, 2, 3, 4]);
}

#[test]
fn proxies_tell_what_would_be() {
    let mut c = context();
    let p = gl::PROXY_TEXTURE_2D;
    let ask = |c: &mut Context, size, internal: u32| {
        c.tex_image_2d(p, 0, internal as i32, size, 0, gl::RGBA, gl::UNSIGNED_BYTE, None);
        (level(c, p, 0, gl::TEXTURE_WIDTH), c.get_error())
    };
    assert_eq!(ask(&mut c, [64, 32], gl::RGBA8), (64, gl::NO_ERROR));
    assert_eq!(level(&mut c, p, 0, gl::TEXTURE_ALPHA_SIZE), 8);
    assert_eq!(ask(&mut c, [1 << 20, 32], gl::RGBA8), (0, gl::NO_ERROR));
    assert_eq!(ask(&mut c, [8192, 8192], gl::RGBA8), (8192, gl::NO_ERROR));
    assert_eq!(ask(&mut c, [8192, 8193], gl::RGBA8), (0, gl::NO_ERROR));
    // What is wrong but for its size is an error, and changes nothing.
    assert_eq!(ask(&mut c, [8, 8], gl::RGBA8), (8, gl::NO_ERROR));
    assert_eq!(ask(&mut c, [-1, 1], gl::RGBA8), (8, gl::INVALID_VALUE));
    assert_eq!(ask(&mut c, [4, 4], gl::TEXTURE_2D), (8, gl::INVALID_VALUE));
    // A proxy is no texture.
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_WIDTH), 0);
    c.get_tex_image(p, 0, gl::RGBA, gl::UNSIGNED_BYTE, &mut []);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn the_framebuffer_is_copied() {
    let mut c = context();
    c.window_pos([0, 0]);
    c.draw_pixels([4, 1], gl::RED, gl::UNSIGNED_BYTE, &[10, 20, 30, 40]);
    c.copy_tex_image_2d(gl::TEXTURE_2D, 0, gl::LUMINANCE8, [1, 0], [2, 2], 0);
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [20, 30, 0, 0]);
    c.pixel_transfer(gl::RED_SCALE, 2.0);
    c.copy_tex_sub_image_2d(gl::TEXTURE_2D, 0, [0, 1], [-1, 0], [2, 1]);
    // The pixel outside the window leaves its texel.
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [20, 30, 0, 20]);
    c.pixel_transfer(gl::RED_SCALE, 1.0);
    c.copy_tex_image_1d(gl::TEXTURE_1D, 0, gl::INTENSITY, [0, 0], 4, 0);
    assert_eq!(luminances(&mut c, gl::TEXTURE_1D, 0), [10, 20, 30, 40]);
    c.clear_depth(0.25);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.copy_tex_image_2d(gl::TEXTURE_2D, 0, gl::DEPTH_COMPONENT24, [0, 0], [1, 1], 0);
    let mut out = [0; 4];
    c.get_tex_image(gl::TEXTURE_2D, 0, gl::DEPTH_COMPONENT, gl::FLOAT, &mut out);
    assert_eq!(out, 0.25f32.to_ne_bytes());
    c.copy_tex_image_2d(gl::TEXTURE_2D, 0, 4, [0, 0], [1, 1], 0);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.copy_tex_sub_image_2d(gl::TEXTURE_2D, 0, [0, 0], [0, 0], [2, 1]);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.copy_tex_sub_image_1d(gl::TEXTURE_2D, 0, 0, [0, 0], 1);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn mipmaps_follow_by_themselves_or_on_demand() {
    let mut c = context();
    let t = gl::TEXTURE_2D;
    c.tex_parameter(t, gl::GENERATE_MIPMAP, &[1.0]);
    image_2d(&mut c, t, 0, [4, 4], &[8; 16]);
    assert_eq!(luminances(&mut c, t, 2), [8]);
    c.tex_sub_image_2d(t, 0, [0, 0], [4, 4], gl::LUMINANCE, gl::UNSIGNED_BYTE, Some(&[9; 16]));
    assert_eq!(luminances(&mut c, t, 1), [9; 4]);
    c.tex_parameter(t, gl::GENERATE_MIPMAP, &[0.0]);
    image_2d(&mut c, t, 0, [4, 4], &[20; 16]);
    assert_eq!(luminances(&mut c, t, 1), [9; 4]);
    c.generate_mipmap(t);
    assert_eq!(luminances(&mut c, t, 2), [20]);
    c.generate_mipmap(gl::TEXTURE_CUBE_MAP);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.generate_mipmap(gl::RGBA);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn objects_keep_images_and_parameters() {
    let mut c = context();
    let names = c.gen_textures(2);
    assert!(!c.is_texture(names[0]));
    c.bind_texture(gl::TEXTURE_2D, names[0]);
    assert!(c.is_texture(names[0]));
    image_2d(&mut c, gl::TEXTURE_2D, 0, [1, 1], &[5]);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_WRAP_S, &[f64::from(gl::CLAMP)]);
    c.bind_texture(gl::TEXTURE_2D, 77);
    assert_eq!(c.tex_level_size(gl::TEXTURE_2D, 0), [0; 3]);
    assert_eq!(c.get_tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_WRAP_S), [f64::from(gl::REPEAT)]);
    c.bind_texture(gl::TEXTURE_2D, names[0]);
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [5]);
    assert_eq!(c.get_tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_WRAP_S), [f64::from(gl::CLAMP)]);
    c.bind_texture(gl::TEXTURE_3D, names[0]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.bind_texture(gl::RGBA, names[0]);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.prioritize_textures(&[(names[0], 0.25), (999, 1.0)]);
    assert_eq!(c.get_tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_PRIORITY), [0.25]);
    assert!(c.are_textures_resident(&[names[0], 77]));
    assert!(!c.are_textures_resident(&[names[0], 999]));
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.delete_textures(&[names[0], 0, 4321]);
    assert!(!c.is_texture(names[0]));
    assert_eq!(c.tex_level_size(gl::TEXTURE_2D, 0), [0; 3]);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_BORDER_COLOR, &[0.1, 0.2, 0.3, 0.4]);
    assert_eq!(c.get_tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_BORDER_COLOR).len(), 4);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MAX_LEVEL, &[-1.0]);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    assert!(c.get_tex_parameter(gl::TEXTURE_2D, gl::RGBA).is_empty());
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
}

#[test]
fn textures_are_shared_and_outlive_their_names() {
    let mut a = context();
    let mut b = Context::sharing(Config::default(), &a);
    let name = a.gen_textures(1)[0];
    a.bind_texture(gl::TEXTURE_2D, name);
    image_2d(&mut a, gl::TEXTURE_2D, 0, [1, 1], &[5]);
    b.bind_texture(gl::TEXTURE_2D, name);
    assert_eq!(luminances(&mut b, gl::TEXTURE_2D, 0), [5]);
    a.delete_textures(&[name]);
    assert!(!b.is_texture(name));
    assert_eq!(luminances(&mut b, gl::TEXTURE_2D, 0), [5]);
}

#[test]
fn the_attribute_stack_brings_bindings_and_parameters_back() {
    let mut c = context();
    c.bind_texture(gl::TEXTURE_2D, 5);
    c.push_attrib(gl::TEXTURE_BIT);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, &[f64::from(gl::NEAREST)]);
    c.bind_texture(gl::TEXTURE_2D, 6);
    c.pop_attrib();
    assert_eq!(c.get_integer(gl::TEXTURE_BINDING_2D)[..], [5]);
    let filter = c.get_tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER);
    assert_eq!(filter, [f64::from(gl::NEAREST_MIPMAP_LINEAR)]);
}

#[test]
fn a_list_keeps_its_pixels() {
    let mut c = context();
    let list = c.gen_lists(1);
    let values = vec![1, 2, 3, 4];
    c.new_list(list, gl::COMPILE);
    image_2d(&mut c, gl::TEXTURE_2D, 0, [2, 2], &values);
    c.tex_image_2d(gl::TEXTURE_2D, 0, 77, [2, 2], 0, gl::RGBA, gl::UNSIGNED_BYTE, None);
    c.end_list();
    drop(values);
    assert_eq!(c.tex_level_size(gl::TEXTURE_2D, 0), [0; 3]);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.call_list(list);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    assert_eq!(luminances(&mut c, gl::TEXTURE_2D, 0), [1, 2, 3, 4]);
}

#[test]
fn nothing_is_compressed() {
    let mut c = context();
    c.tex_image_2d(
        gl::TEXTURE_2D,
        0,
        gl::COMPRESSED_RGB as i32,
        [1, 1],
        0,
        gl::RGB,
        gl::UNSIGNED_BYTE,
        Some(&[1, 2, 3]),
    );
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_COMPRESSED), 0);
    assert_eq!(level(&mut c, gl::TEXTURE_2D, 0, gl::TEXTURE_INTERNAL_FORMAT), gl::RGB as i32);
    assert_eq!(c.get_tex_level_parameter(gl::TEXTURE_2D, 0, gl::TEXTURE_COMPRESSED_IMAGE_SIZE), None);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.compressed_tex_image(gl::TEXTURE_2D, 0, gl::COMPRESSED_RGB, Some(&[]));
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.get_compressed_tex_image(gl::TEXTURE_2D, 0);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn a_textured_draw_sees_the_texture_as_it_was() {
    let mut c = context();
    c.enable(gl::TEXTURE_2D);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, &[f64::from(gl::NEAREST)]);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MAG_FILTER, &[f64::from(gl::NEAREST)]);
    image_2d(&mut c, gl::TEXTURE_2D, 0, [1, 1], &[100]);
    c.rect([-1, -1], [0, 1]);
    image_2d(&mut c, gl::TEXTURE_2D, 0, [1, 1], &[200]);
    c.rect([0, -1], [1, 1]);
    let mut out = [0; 4];
    c.read_pixels([0, 0], [4, 1], gl::RED, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(out, [100, 100, 200, 200]);
}
