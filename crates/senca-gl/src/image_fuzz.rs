//! Arbitrary commands on pixels, textures and framebuffers: whatever they are, nothing panics.

use proptest::prelude::*;

use crate::{Config, Context, Enum, gl};

const TARGETS: [Enum; 9] = [
    gl::TEXTURE_1D,
    gl::TEXTURE_2D,
    gl::TEXTURE_3D,
    gl::TEXTURE_CUBE_MAP,
    gl::TEXTURE_CUBE_MAP_POSITIVE_X,
    gl::TEXTURE_CUBE_MAP_NEGATIVE_Z,
    gl::PROXY_TEXTURE_2D,
    gl::PROXY_TEXTURE_CUBE_MAP,
    gl::RGBA,
];
const INTERNALS: [Enum; 12] = [
    4,
    gl::RGBA,
    gl::RGB,
    gl::LUMINANCE8,
    gl::ALPHA16,
    gl::INTENSITY,
    gl::SRGB8,
    gl::RGBA16,
    gl::DEPTH_COMPONENT24,
    gl::DEPTH24_STENCIL8,
    gl::STENCIL_INDEX8,
    gl::TEXTURE_2D,
];
const FORMATS: [Enum; 9] = [
    gl::RGBA,
    gl::BGR,
    gl::LUMINANCE_ALPHA,
    gl::ALPHA,
    gl::COLOR_INDEX,
    gl::STENCIL_INDEX,
    gl::DEPTH_COMPONENT,
    gl::DEPTH_STENCIL,
    gl::ABGR_EXT,
];
const TYPES: [Enum; 9] = [
    gl::UNSIGNED_BYTE,
    gl::SHORT,
    gl::INT,
    gl::FLOAT,
    gl::HALF_FLOAT,
    gl::BITMAP,
    gl::UNSIGNED_INT_2_10_10_10_REV,
    gl::UNSIGNED_INT_24_8,
    gl::FLOAT_32_UNSIGNED_INT_24_8_REV,
];
const POINTS: [Enum; 6] = [
    gl::COLOR_ATTACHMENT0,
    gl::COLOR_ATTACHMENT1,
    gl::DEPTH_ATTACHMENT,
    gl::STENCIL_ATTACHMENT,
    gl::DEPTH_STENCIL_ATTACHMENT,
    gl::FRONT,
];
const BUFFERS: [Enum; 8] = [
    gl::NONE,
    gl::FRONT,
    gl::BACK,
    gl::FRONT_AND_BACK,
    gl::LEFT,
    gl::AUX0,
    gl::COLOR_ATTACHMENT0,
    gl::COLOR_ATTACHMENT1,
];
const CAPS: [Enum; 8] = [
    gl::DEPTH_TEST,
    gl::STENCIL_TEST,
    gl::SCISSOR_TEST,
    gl::ALPHA_TEST,
    gl::BLEND,
    gl::TEXTURE_2D,
    gl::TEXTURE_CUBE_MAP,
    gl::MULTISAMPLE,
];
const STORES: [Enum; 8] = [
    gl::UNPACK_ALIGNMENT,
    gl::UNPACK_ROW_LENGTH,
    gl::UNPACK_SKIP_PIXELS,
    gl::UNPACK_SWAP_BYTES,
    gl::PACK_ALIGNMENT,
    gl::PACK_ROW_LENGTH,
    gl::PACK_SKIP_ROWS,
    gl::PACK_LSB_FIRST,
];

/// What a command is made of.
#[derive(Clone, Debug)]
struct Command {
    which: usize,
    picks: [usize; 4],
    numbers: [i32; 8],
    reals: [f32; 4],
}

fn number() -> impl Strategy<Value = i32> {
    prop_oneof![9 => -2_i32..9, 1 => prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(1 << 20), any::<i32>()]]
}

fn real() -> impl Strategy<Value = f32> {
    prop_oneof![6 => -3.0_f32..9.0, 1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), any::<f32>()]]
}

fn commands() -> impl Strategy<Value = Vec<Command>> {
    let one = (
        0_usize..27,
        prop::array::uniform4(0_usize..1000),
        prop::array::uniform8(number()),
        prop::array::uniform4(real()),
    );
    let command = one.prop_map(|(which, picks, numbers, reals)| Command { which, picks, numbers, reals });
    prop::collection::vec(command, 1..40)
}

fn run(c: &mut Context, command: &Command, bytes: &mut [u8]) {
    let Command { which, picks, numbers: n, reals } = command;
    let pick = |i: usize, of: &[Enum]| of[picks[i] % of.len()];
    let (target, internal) = (pick(0, &TARGETS), pick(1, &INTERNALS));
    let (format, ty) = (pick(2, &FORMATS), pick(3, &TYPES));
    let name = n[0].rem_euclid(4) as u32;
    // Sides that must be bounded by memory, not by the command.
    let (pair, other) = ([n[1], n[2]], [n[3], n[4]]);
    match which {
        0 => c.tex_image_2d(target, n[0], internal as i32, pair, n[3] & 1, format, ty, Some(bytes)),
        1 => c.tex_image_3d(
            target,
            n[0],
            internal as i32,
            [n[1], n[2], n[3]],
            n[4] & 1,
            format,
            ty,
            Some(bytes),
        ),
        2 => c.tex_image_1d(target, n[0], internal as i32, n[1], n[3], format, ty, Some(bytes)),
        3 => c.tex_sub_image_2d(target, n[0], pair, other, format, ty, Some(bytes)),
        4 => {
            c.tex_sub_image_3d(target, n[0], [n[1], n[2], n[3]], [n[4], n[5], n[6]], format, ty, Some(bytes))
        }
        5 => c.copy_tex_image_2d(target, n[0], internal, [n[5], n[6]], [n[1] % 64, n[2] % 64], n[7]),
        6 => c.copy_tex_sub_image_2d(target, n[0], pair, [n[5], n[6]], other),
        7 => c.get_tex_image(target, n[0], format, ty, bytes),
        8 => c.generate_mipmap(target),
        9 => c.bind_texture(target, name),
        10 => c.delete_textures(&[name]),
        11 => c.tex_parameter(target, gl::TEXTURE_BASE_LEVEL, &[f64::from(reals[0])]),
        12 => c.tex_parameter(target, gl::TEXTURE_MIN_FILTER, &[f64::from(gl::LINEAR)]),
        13 => c.draw_pixels(pair, format, ty, bytes),
        14 => c.read_pixels(pair, other, format, ty, bytes),
        15 => c.copy_pixels(pair, other, pick(0, &[gl::COLOR, gl::DEPTH, gl::STENCIL, gl::DEPTH_STENCIL, 0])),
        16 => c.bitmap(pair, [reals[0], reals[1]], [reals[2], reals[3]], Some(bytes)),
        17 => c.pixel_zoom([reals[0], reals[1]]),
        18 => c.window_pos([reals[0], reals[1]]),
        19 => c.pixel_store(pick(0, &STORES), n[0]),
        20 => c.clear(n[0] as u32 & 0x4700),
        21 => c.accum(pick(0, &[gl::ACCUM, gl::LOAD, gl::RETURN, gl::MULT, gl::ADD]), reals[0]),
        22 => {
            let kind = pick(0, &[gl::FRAMEBUFFER, gl::DRAW_FRAMEBUFFER, gl::READ_FRAMEBUFFER]);
            c.bind_framebuffer(kind, name);
            c.framebuffer_texture_2d(kind, pick(1, &POINTS), pick(2, &TARGETS), name + 1, n[1]);
        }
        23 => {
            c.bind_renderbuffer(gl::RENDERBUFFER, name);
            let size = pair.map(|side| side.min(64));
            c.renderbuffer_storage_multisample(gl::RENDERBUFFER, n[3] & 4, internal, size);
            c.framebuffer_renderbuffer(gl::FRAMEBUFFER, pick(2, &POINTS), gl::RENDERBUFFER, name);
        }
        24 => {
            let (a, b) = ([n[0], n[1], n[2], n[3]], [n[4], n[5], n[6], n[7]]);
            c.blit_framebuffer(
                a,
                b,
                pick(0, &[0x4000, 0x100, 0x400, 0x4500]),
                pick(1, &[gl::NEAREST, gl::LINEAR]),
            );
        }
        25 => {
            c.draw_buffer(pick(0, &BUFFERS));
            c.read_buffer(pick(1, &BUFFERS));
        }
        _ => {
            c.set_enabled(pick(0, &CAPS), n[0] & 1 == 0);
            c.rect([reals[0], reals[1]], [reals[2], reals[3]]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn nothing_panics(commands in commands(), double_buffered: bool, float_color: bool) {
        let mut c = Context::new(Config { double_buffered, float_color, ..Config::default() });
        prop_assert!(c.resize(8, 6));
        c.gen_framebuffers(3);
        c.gen_renderbuffers(3);
        let mut bytes: Vec<u8> = (0..4096_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        for command in &commands {
            run(&mut c, command, &mut bytes);
        }
        c.finish();
    }
}
