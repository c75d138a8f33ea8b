use crate::{Config, Context, Enum, gl};

fn context(width: u32, height: u32) -> Context {
    with(Config::default(), width, height)
}

fn with(config: Config, width: u32, height: u32) -> Context {
    let mut c = Context::new(config);
    assert!(c.resize(width, height));
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    c.pixel_store(gl::PACK_ALIGNMENT, 1);
    c
}

fn rgba(c: &mut Context, at: [i32; 2], size: [i32; 2]) -> Vec<[u8; 4]> {
    let mut out = vec![0xee; (size[0] * size[1] * 4) as usize];
    c.read_pixels(at, size, gl::RGBA, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out.as_chunks::<4>().0.to_vec()
}

fn reds(c: &mut Context, size: [i32; 2]) -> Vec<u8> {
    rgba(c, [0, 0], size).into_iter().map(|color| color[0]).collect()
}

fn depths(c: &mut Context, size: [i32; 2]) -> Vec<f32> {
    let mut out = vec![0; (size[0] * size[1] * 4) as usize];
    c.read_pixels([0, 0], size, gl::DEPTH_COMPONENT, gl::FLOAT, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out.as_chunks::<4>().0.iter().map(|bytes| f32::from_ne_bytes(*bytes)).collect()
}

fn stencils(c: &mut Context, size: [i32; 2]) -> Vec<u8> {
    let mut out = vec![0; (size[0] * size[1]) as usize];
    c.read_pixels([0, 0], size, gl::STENCIL_INDEX, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out
}

/// A framebuffer object, bound, with renderbuffers of colour and of depth with stencil.
fn object(c: &mut Context, size: [i32; 2], samples: i32) -> u32 {
    let name = c.gen_framebuffers(1)[0];
    c.bind_framebuffer(gl::FRAMEBUFFER, name);
    for (point, format) in
        [(gl::COLOR_ATTACHMENT0, gl::RGBA8), (gl::DEPTH_STENCIL_ATTACHMENT, gl::DEPTH24_STENCIL8)]
    {
        let buffer = c.gen_renderbuffers(1)[0];
        c.bind_renderbuffer(gl::RENDERBUFFER, buffer);
        c.renderbuffer_storage_multisample(gl::RENDERBUFFER, samples, format, size);
        c.framebuffer_renderbuffer(gl::FRAMEBUFFER, point, gl::RENDERBUFFER, buffer);
    }
    assert_eq!(c.get_error(), gl::NO_ERROR);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    name
}

fn clear_red(c: &mut Context, red: f32) {
    c.clear_color([red, 0.0, 0.0, 1.0]);
    c.clear(gl::COLOR_BUFFER_BIT);
}

#[test]
fn clear_obeys_scissor_and_masks() {
    let mut c = context(3, 2);
    c.clear_color([0.2, 0.4, 0.6, 0.8]);
    c.color_mask([true, false, true, false]);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(1, 0, 1, 2);
    c.clear_depth(0.25);
    c.clear_stencil(0xff);
    c.stencil_mask(0x0f);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
    assert_eq!(rgba(&mut c, [0, 0], [3, 1]), [[0; 4], [51, 0, 153, 0], [0; 4]]);
    assert_eq!(depths(&mut c, [3, 2]), [1.0, 0.25, 1.0, 1.0, 0.25, 1.0]);
    assert_eq!(stencils(&mut c, [3, 1]), [0, 15, 0]);
    c.depth_mask(false);
    c.clear_depth(0.5);
    c.scissor(-10, -10, 100, 100);
    c.clear(gl::DEPTH_BUFFER_BIT);
    assert_eq!(depths(&mut c, [1, 1]), [1.0]);
    c.clear(1);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
}

#[test]
fn large_clears_reach_every_pixel() {
    let mut c = context(701, 301);
    clear_red(&mut c, 1.0);
    c.finish();
    assert!(c.window_pixels().iter().all(|color| *color == [255, 0, 0, 255]));
}

/// The same commands, with a look at the buffers between clear and triangle or without.
#[test]
fn a_clear_waits_for_what_is_drawn() {
    let picture = |looks: bool, scissor: Option<[i32; 4]>| {
        let mut c = context(150, 90);
        clear_red(&mut c, 0.5);
        c.clear_depth(0.75);
        c.clear_stencil(9);
        c.clear(gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
        if looks {
            c.finish();
        }
        c.enable(gl::DEPTH_TEST);
        if let Some([x, y, width, height]) = scissor {
            c.enable(gl::SCISSOR_TEST);
            c.scissor(x, y, width, height);
        }
        c.begin(gl::TRIANGLES);
        c.color([0.0f32, 1.0, 0.0]);
        [[-0.9f32, -0.8, 0.9], [0.5, -0.7, 0.0], [0.1, 0.6, -0.5]].into_iter().for_each(|v| c.vertex(v));
        c.end();
        let colors = rgba(&mut c, [0, 0], [150, 90]);
        (colors, depths(&mut c, [150, 90]), stencils(&mut c, [150, 90]))
    };
    for scissor in [None, Some([-5, 0, 500, 500]), Some([10, 10, 60, 60])] {
        assert!(picture(false, scissor) == picture(true, scissor), "{scissor:?}");
    }
}

#[test]
fn a_clear_of_a_part_waits_for_what_is_drawn() {
    let picture = |looks: bool, samples: i32, multisample: bool, part: [i32; 4]| {
        let [x, y, width, height] = part;
        let mut c = context(96, 64);
        object(&mut c, [96, 64], samples);
        c.clear_color([0.0, 0.0, 1.0, 1.0]);
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
        c.finish();
        if !multisample {
            c.disable(gl::MULTISAMPLE);
        }
        c.viewport(x, y, width, height);
        c.enable(gl::SCISSOR_TEST);
        c.scissor(x, y, width, height);
        c.clear_depth(0.75);
        clear_red(&mut c, 0.5);
        c.clear(gl::DEPTH_BUFFER_BIT);
        c.disable(gl::SCISSOR_TEST);
        c.clear_stencil(5);
        c.clear(gl::STENCIL_BUFFER_BIT);
        if looks {
            c.finish();
        }
        c.enable(gl::DEPTH_TEST);
        c.begin(gl::TRIANGLES);
        c.color([0.0f32, 1.0, 0.0]);
        [[-0.9f32, -0.8, 0.9], [0.5, -0.7, 0.0], [0.1, 0.6, -0.5]].into_iter().for_each(|v| c.vertex(v));
        c.end();
        c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
        let buffers = gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT;
        c.blit_framebuffer([0, 0, 96, 64], [0, 0, 96, 64], buffers, gl::NEAREST);
        c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
        let colors = rgba(&mut c, [0, 0], [96, 64]);
        assert!(colors.contains(&[128, 0, 0, 255]) && colors.contains(&[0, 255, 0, 255]));
        (colors, depths(&mut c, [96, 64]), stencils(&mut c, [96, 64]))
    };
    for part in [[0, 0, 64, 32], [16, 8, 48, 40], [5, 6, 50, 41]] {
        for (samples, multisample) in [(0, true), (4, true), (4, false)] {
            let [waits, does_not] = [false, true].map(|looks| picture(looks, samples, multisample, part));
            assert!(waits == does_not, "{part:?} {samples} {multisample}");
        }
    }
}

#[test]
fn accumulation_adds_up() {
    let mut c = context(2, 1);
    clear_red(&mut c, 0.4);
    c.accum(gl::LOAD, 0.5);
    clear_red(&mut c, 0.8);
    c.accum(gl::ACCUM, 0.5);
    c.accum(gl::ADD, 0.1);
    c.accum(gl::MULT, 0.5);
    c.accum(gl::RETURN, 2.0);
    // 0.2 + 0.4 + 0.1 = 0.7, and 0.1 in green.
    assert_eq!(rgba(&mut c, [0, 0], [1, 1]), [[179, 26, 26, 255]]);
    c.clear_accum([-0.5, 0.25, 0.0, 1.0]);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(1, 0, 1, 1);
    c.clear(gl::ACCUM_BUFFER_BIT);
    c.color_mask([true, true, true, false]);
    c.accum(gl::RETURN, 1.0);
    assert_eq!(rgba(&mut c, [0, 0], [2, 1]), [[179, 26, 26, 255], [0, 64, 0, 255]]);
    c.accum(gl::COPY, 1.0);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    let mut c = with(Config { accum_bits: 0, ..Config::default() }, 1, 1);
    c.accum(gl::LOAD, 1.0);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn front_and_back_are_chosen_and_exchanged() {
    let mut c = with(Config { double_buffered: true, ..Config::default() }, 1, 1);
    clear_red(&mut c, 0.2);
    assert_eq!(c.window_pixels(), [[0; 4]]);
    assert_eq!(reds(&mut c, [1, 1]), [51]);
    c.swap_buffers();
    assert_eq!(c.window_pixels(), [[51, 0, 0, 255]]);
    c.draw_buffer(gl::FRONT_AND_BACK);
    clear_red(&mut c, 0.4);
    c.read_buffer(gl::FRONT);
    assert_eq!(reds(&mut c, [1, 1]), [102]);
    c.read_buffer(gl::BACK);
    assert_eq!(reds(&mut c, [1, 1]), [102]);
    c.draw_buffer(gl::NONE);
    clear_red(&mut c, 1.0);
    assert_eq!(reds(&mut c, [1, 1]), [102]);
    for (buffer, error) in [
        (gl::RIGHT, gl::INVALID_OPERATION),
        (gl::AUX0, gl::INVALID_OPERATION),
        (gl::COLOR_ATTACHMENT0, gl::INVALID_OPERATION),
        (gl::RGBA, gl::INVALID_ENUM),
    ] {
        c.draw_buffer(buffer);
        assert_eq!(c.get_error(), error);
        c.read_buffer(buffer);
        assert_eq!(c.get_error(), error);
    }
    let mut c = context(1, 1);
    c.draw_buffer(gl::BACK);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn drawing_to_both_buffers_tests_depth_for_each() {
    let mut c = with(Config { double_buffered: true, ..Config::default() }, 2, 2);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.draw_buffer(gl::FRONT_AND_BACK);
    c.enable(gl::DEPTH_TEST);
    c.rect([-1, -1], [1, 1]);
    c.finish();
    assert_eq!(c.window_pixels(), [[255; 4]; 4]);
    c.read_buffer(gl::BACK);
    assert_eq!(rgba(&mut c, [0, 0], [2, 2]), [[255; 4]; 4]);
}

#[test]
fn an_object_is_drawn_to_and_read() {
    let mut c = context(4, 4);
    object(&mut c, [2, 2], 0);
    c.viewport(0, 0, 2, 2);
    clear_red(&mut c, 0.0);
    c.clear(gl::DEPTH_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.rect([-1, -1], [0, 1]);
    assert_eq!(reds(&mut c, [2, 2]), [255, 0, 255, 0]);
    assert_eq!(depths(&mut c, [2, 1]), [0.5, 1.0]);
    c.bind_framebuffer(gl::FRAMEBUFFER, 0);
    assert_eq!(reds(&mut c, [2, 1]), [0, 0]);
}

#[test]
fn a_texture_is_drawn_to() {
    let mut c = context(2, 2);
    let texture = c.gen_textures(1)[0];
    c.bind_texture(gl::TEXTURE_3D, texture);
    c.tex_image_3d(
        gl::TEXTURE_3D,
        0,
        gl::RGB as i32,
        [2, 2, 2],
        0,
        gl::RGB,
        gl::UNSIGNED_BYTE,
        Some(&[7; 24]),
    );
    let name = c.gen_framebuffers(1)[0];
    c.bind_framebuffer(gl::FRAMEBUFFER, name);
    c.framebuffer_texture_3d(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::TEXTURE_3D, texture, 0, 1);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.clear_color([1.0, 0.0, 0.2, 0.0]);
    c.clear(gl::COLOR_BUFFER_BIT);
    let mut out = [0; 32];
    c.get_tex_image(gl::TEXTURE_3D, 0, gl::RGBA, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(out[..16], [[7, 7, 7, 255]; 4].concat());
    // There is no alpha to be cleared.
    assert_eq!(out[16..], [[255, 0, 51, 255]; 4].concat());
    c.delete_textures(&[texture]);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT);
}

#[test]
fn objects_of_different_sizes_are_drawn_to_where_all_are() {
    let mut c = context(4, 4);
    object(&mut c, [4, 4], 0);
    let depth = c.gen_renderbuffers(1)[0];
    c.bind_renderbuffer(gl::RENDERBUFFER, depth);
    c.renderbuffer_storage(gl::RENDERBUFFER, gl::DEPTH_COMPONENT24, [2, 3]);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::DEPTH_STENCIL_ATTACHMENT, gl::RENDERBUFFER, 0);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::RENDERBUFFER, depth);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.clear(gl::DEPTH_BUFFER_BIT | gl::COLOR_BUFFER_BIT);
    c.enable(gl::DEPTH_TEST);
    c.rect([-1, -1], [1, 1]);
    assert_eq!(reds(&mut c, [4, 4]), [255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn completeness_says_what_is_missing() {
    let mut c = context(1, 1);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    let name = c.gen_framebuffers(1)[0];
    assert!(!c.is_framebuffer(name));
    c.bind_framebuffer(gl::FRAMEBUFFER, name);
    assert!(c.is_framebuffer(name));
    let status = |c: &mut Context| c.check_framebuffer_status(gl::DRAW_FRAMEBUFFER);
    assert_eq!(status(&mut c), gl::FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT);
    c.clear(gl::COLOR_BUFFER_BIT);
    assert_eq!(c.get_error(), gl::INVALID_FRAMEBUFFER_OPERATION);
    c.read_pixels([0, 0], [1, 1], gl::RGBA, gl::UNSIGNED_BYTE, &mut [0; 4]);
    assert_eq!(c.get_error(), gl::INVALID_FRAMEBUFFER_OPERATION);

    let depth = c.gen_renderbuffers(1)[0];
    c.bind_renderbuffer(gl::RENDERBUFFER, depth);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::RENDERBUFFER, depth);
    assert_eq!(status(&mut c), gl::FRAMEBUFFER_INCOMPLETE_ATTACHMENT);
    c.renderbuffer_storage(gl::RENDERBUFFER, gl::DEPTH_COMPONENT24, [2, 2]);
    // Colours are drawn to and read from nowhere.
    assert_eq!(status(&mut c), gl::FRAMEBUFFER_COMPLETE);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.read_pixels([0, 0], [1, 1], gl::RGBA, gl::UNSIGNED_BYTE, &mut [0; 4]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT1, gl::RENDERBUFFER, depth);
    assert_eq!(status(&mut c), gl::FRAMEBUFFER_INCOMPLETE_ATTACHMENT);

    let color = c.gen_renderbuffers(1)[0];
    c.bind_renderbuffer(gl::RENDERBUFFER, color);
    c.renderbuffer_storage_multisample(gl::RENDERBUFFER, 2, gl::RGBA8, [2, 2]);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT1, gl::RENDERBUFFER, color);
    assert_eq!(status(&mut c), gl::FRAMEBUFFER_INCOMPLETE_MULTISAMPLE);
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

#[test]
fn questions_about_objects_are_answered() {
    let mut c = context(1, 1);
    object(&mut c, [5, 6], 3);
    let ask = |c: &mut Context, name| c.get_renderbuffer_parameter(gl::RENDERBUFFER, name);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_WIDTH), 5);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_HEIGHT), 6);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_SAMPLES), 4);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_INTERNAL_FORMAT), gl::DEPTH24_STENCIL8 as i32);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_DEPTH_SIZE), 24);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_STENCIL_SIZE), 8);
    assert_eq!(ask(&mut c, gl::RENDERBUFFER_RED_SIZE), 0);
    let ask =
        |c: &mut Context, point, name| c.get_framebuffer_attachment_parameter(gl::FRAMEBUFFER, point, name);
    let kind = gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE;
    assert_eq!(ask(&mut c, gl::COLOR_ATTACHMENT0, kind), gl::RENDERBUFFER as i32);
    assert_eq!(ask(&mut c, gl::COLOR_ATTACHMENT3, kind), gl::NONE as i32);
    assert_eq!(ask(&mut c, gl::DEPTH_STENCIL_ATTACHMENT, kind), gl::RENDERBUFFER as i32);
    assert_eq!(ask(&mut c, gl::COLOR_ATTACHMENT0, gl::FRAMEBUFFER_ATTACHMENT_OBJECT_NAME), 1);
    assert_eq!(ask(&mut c, gl::COLOR_ATTACHMENT0, gl::FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE), 8);
    assert_eq!(
        ask(&mut c, gl::COLOR_ATTACHMENT0, gl::FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE),
        gl::UNSIGNED_NORMALIZED as i32
    );
    assert_eq!(
        ask(&mut c, gl::COLOR_ATTACHMENT0, gl::FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING),
        gl::LINEAR as i32
    );
    assert_eq!(c.get_error(), gl::NO_ERROR);
    ask(&mut c, gl::COLOR_ATTACHMENT3, gl::FRAMEBUFFER_ATTACHMENT_RED_SIZE);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    ask(&mut c, gl::FRONT, kind);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.bind_framebuffer(gl::FRAMEBUFFER, 0);
    assert_eq!(ask(&mut c, gl::FRONT_LEFT, kind), gl::FRAMEBUFFER_DEFAULT as i32);
    assert_eq!(ask(&mut c, gl::DEPTH, gl::FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE), 24);
    assert_eq!(ask(&mut c, gl::BACK_LEFT, kind), gl::NONE as i32);
}

#[test]
fn wrong_commands_on_objects_do_nothing() {
    let mut c = context(1, 1);
    let mut wrong = |command: &dyn Fn(&mut Context), error: Enum| {
        command(&mut c);
        assert_eq!(c.get_error(), error);
    };
    wrong(&|c| c.bind_framebuffer(gl::FRAMEBUFFER, 77), gl::INVALID_OPERATION);
    wrong(&|c| c.bind_framebuffer(gl::TEXTURE_2D, 0), gl::INVALID_ENUM);
    wrong(&|c| c.bind_renderbuffer(gl::RENDERBUFFER, 77), gl::INVALID_OPERATION);
    wrong(&|c| c.renderbuffer_storage(gl::RENDERBUFFER, gl::RGBA8, [1, 1]), gl::INVALID_OPERATION);
    wrong(&|c| c.renderbuffer_storage(gl::RENDERBUFFER, gl::COMPRESSED_RGB, [1, 1]), gl::INVALID_ENUM);
    wrong(&|c| c.renderbuffer_storage(gl::RENDERBUFFER, gl::RGBA8, [-1, 1]), gl::INVALID_VALUE);
    wrong(&|c| c.renderbuffer_storage(gl::RENDERBUFFER, gl::RGBA8, [1, 1 << 20]), gl::INVALID_VALUE);
    wrong(&|c| c.renderbuffer_storage_multisample(gl::RENDERBUFFER, 5, gl::RGBA8, [1, 1]), gl::INVALID_VALUE);
    wrong(
        &|c| c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::RENDERBUFFER, 0),
        gl::INVALID_OPERATION,
    );
    wrong(&|c| assert_eq!(c.check_framebuffer_status(gl::RGBA), 0), gl::INVALID_ENUM);
    wrong(&|c| assert!(c.gen_framebuffers(-1).is_empty()), gl::INVALID_VALUE);
    object(&mut c, [1, 1], 0);
    let mut wrong = |command: &dyn Fn(&mut Context), error: Enum| {
        command(&mut c);
        assert_eq!(c.get_error(), error);
    };
    let (f, p) = (gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0);
    wrong(&|c| c.framebuffer_texture_2d(f, p, gl::TEXTURE_2D, 99, 0), gl::INVALID_OPERATION);
    wrong(&|c| c.framebuffer_renderbuffer(f, gl::RGBA, gl::RENDERBUFFER, 0), gl::INVALID_ENUM);
    wrong(&|c| c.framebuffer_renderbuffer(f, p, gl::TEXTURE, 0), gl::INVALID_ENUM);
    wrong(&|c| c.framebuffer_renderbuffer(f, p, gl::RENDERBUFFER, 99), gl::INVALID_OPERATION);
    wrong(&|c| c.draw_buffer(gl::FRONT), gl::INVALID_OPERATION);
    wrong(&|c| c.accum(gl::LOAD, 1.0), gl::INVALID_OPERATION);
    assert_eq!(c.check_framebuffer_status(f), gl::FRAMEBUFFER_COMPLETE);
}

fn draw_reds(c: &mut Context, size: [i32; 2], values: &[u8]) {
    c.window_pos([0, 0]);
    c.draw_pixels(size, gl::RED, gl::UNSIGNED_BYTE, values);
}

#[test]
fn blits_scale_mirror_and_cut() {
    let mut c = context(4, 2);
    let name = object(&mut c, [4, 2], 0);
    draw_reds(&mut c, [4, 2], &[10, 20, 30, 40, 50, 60, 70, 80]);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    let show = |c: &mut Context| {
        c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
        let reds = reds(c, [4, 2]);
        c.bind_framebuffer(gl::READ_FRAMEBUFFER, name);
        clear_red(c, 0.0);
        reds
    };
    let color = gl::COLOR_BUFFER_BIT;
    c.blit_framebuffer([0, 0, 4, 2], [0, 0, 4, 2], color, gl::NEAREST);
    assert_eq!(show(&mut c), [10, 20, 30, 40, 50, 60, 70, 80]);
    c.blit_framebuffer([0, 0, 4, 2], [4, 2, 0, 0], color, gl::NEAREST);
    assert_eq!(show(&mut c), [80, 70, 60, 50, 40, 30, 20, 10]);
    c.blit_framebuffer([4, 0, 0, 2], [4, 0, 0, 2], color, gl::NEAREST);
    assert_eq!(show(&mut c), [10, 20, 30, 40, 50, 60, 70, 80]);
    c.blit_framebuffer([0, 0, 2, 1], [0, 0, 4, 2], color, gl::NEAREST);
    assert_eq!(show(&mut c), [10, 10, 20, 20, 10, 10, 20, 20]);
    // The middle of 20 and 30 and of 60 and 70; ends as at the edge.
    c.blit_framebuffer([0, 0, 4, 2], [0, 0, 2, 1], color, gl::LINEAR);
    assert_eq!(show(&mut c)[..3], [35, 55, 0]);
    // What lies outside the source is not written.
    c.blit_framebuffer([-2, 0, 2, 2], [0, 0, 4, 2], color, gl::NEAREST);
    assert_eq!(show(&mut c), [0, 0, 10, 20, 0, 0, 50, 60]);
    c.enable(gl::SCISSOR_TEST);
    c.scissor(1, 0, 2, 1);
    c.blit_framebuffer([0, 0, 4, 2], [0, 0, 4, 2], color, gl::NEAREST);
    assert_eq!(show(&mut c), [0, 20, 30, 0, 0, 0, 0, 0]);
}

#[test]
fn blits_take_depth_and_stencil() {
    let mut c = context(2, 1);
    object(&mut c, [2, 1], 0);
    c.clear_depth(0.25);
    c.clear_stencil(3);
    c.clear(gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    c.blit_framebuffer([0, 0, 1, 1], [0, 0, 1, 1], gl::DEPTH_BUFFER_BIT, gl::NEAREST);
    c.blit_framebuffer([0, 0, 1, 1], [1, 0, 2, 1], gl::STENCIL_BUFFER_BIT, gl::NEAREST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    assert_eq!((depths(&mut c, [2, 1]), stencils(&mut c, [2, 1])), (vec![0.25, 1.0], vec![0, 3]));
}

#[test]
fn samples_are_resolved_to_their_mean() {
    let mut c = context(2, 2);
    let name = object(&mut c, [2, 2], 4);
    let fill = |c: &mut Context| {
        // Texels of the plane: two rows of 2 x 2 squares.
        let mut planes = c.framebuffers.take_planes();
        if let crate::texture::Texels::Rgba8(colors) = planes.color(0).texels_mut() {
            colors.iter_mut().enumerate().for_each(|(i, color)| *color = [i as u8 * 4, 0, 0, 255]);
        }
        if let Some(depths) = planes.depth().and_then(|plane| plane.texels_mut().depths_mut()) {
            depths.fill(0.5);
        }
        c.framebuffers.put_back(planes);
    };
    fill(&mut c);
    c.read_pixels([0, 0], [1, 1], gl::RGBA, gl::UNSIGNED_BYTE, &mut [0; 4]);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    c.blit_framebuffer([0, 0, 2, 2], [0, 0, 2, 2], gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT, gl::NEAREST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    // (0 + 1 + 4 + 5) / 4 * 4 and so on.
    assert_eq!(reds(&mut c, [2, 2]), [10, 18, 42, 50]);
    assert_eq!(depths(&mut c, [2, 2]), [0.5; 4]);

    // The other way all samples take the colour.
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, name);
    c.blit_framebuffer([0, 0, 2, 2], [0, 0, 2, 2], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    let mut planes = c.framebuffers.take_planes();
    let plane = planes.color(0).clone();
    c.framebuffers.put_back(planes);
    let found: Vec<u8> = (0..16).map(|i| (plane.texels.color(i)[0] * 255.0 + 0.5) as u8).collect();
    assert_eq!(found, [10, 10, 18, 18, 10, 10, 18, 18, 42, 42, 50, 50, 42, 42, 50, 50]);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    c.blit_framebuffer([0, 0, 2, 2], [0, 0, 1, 1], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
}

#[test]
fn wrong_blits_do_nothing() {
    let mut c = context(2, 2);
    let r = [0, 0, 1, 1];
    c.blit_framebuffer(r, r, 1, gl::NEAREST);
    assert_eq!(c.get_error(), gl::INVALID_VALUE);
    c.blit_framebuffer(r, r, gl::COLOR_BUFFER_BIT, gl::REPEAT);
    assert_eq!(c.get_error(), gl::INVALID_ENUM);
    c.blit_framebuffer(r, r, gl::DEPTH_BUFFER_BIT, gl::LINEAR);
    assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    let name = c.gen_framebuffers(1)[0];
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, name);
    c.blit_framebuffer(r, r, gl::COLOR_BUFFER_BIT, gl::NEAREST);
    assert_eq!(c.get_error(), gl::INVALID_FRAMEBUFFER_OPERATION);
    // Extreme corners.
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    let far = [i32::MIN, i32::MIN, i32::MAX, i32::MAX];
    c.blit_framebuffer(far, far, gl::COLOR_BUFFER_BIT, gl::LINEAR);
    c.blit_framebuffer(far, r, gl::COLOR_BUFFER_BIT, gl::NEAREST);
    c.blit_framebuffer([1, 1, 1, 1], r, gl::COLOR_BUFFER_BIT, gl::LINEAR);
    c.blit_framebuffer(r, [1, 1, 1, 1], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

#[test]
fn deleting_what_is_bound_goes_back_to_the_window() {
    let mut c = context(1, 1);
    let name = object(&mut c, [1, 1], 0);
    c.delete_framebuffers(&[0, name, 1234]);
    assert!(!c.is_framebuffer(name));
    clear_red(&mut c, 1.0);
    c.finish();
    assert_eq!(c.window_pixels(), [[255, 0, 0, 255]]);
    c.delete_renderbuffers(&[1, 2, 3]);
    assert!(!c.is_renderbuffer(1));
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

/// A red triangle over the lower left half of 8 x 8 pixels of four samples, resolved.
fn resolved_triangle(multisample: bool) -> Vec<u8> {
    let mut c = context(8, 8);
    object(&mut c, [8, 8], 4);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    if !multisample {
        c.disable(gl::MULTISAMPLE);
    }
    c.enable(gl::DEPTH_TEST);
    c.begin(gl::TRIANGLES);
    c.vertex([-1.0, -1.0]);
    c.vertex([1.0, -1.0]);
    c.vertex([-1.0, 1.0]);
    c.end();
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    c.blit_framebuffer([0, 0, 8, 8], [0, 0, 8, 8], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    reds(&mut c, [8, 8])
}

#[test]
fn samples_are_covered_each_for_itself() {
    let found = resolved_triangle(true);
    for (i, red) in found.iter().enumerate() {
        let (x, y) = (i % 8, i / 8);
        match (x + y).cmp(&7) {
            std::cmp::Ordering::Less => assert_eq!(*red, 255),
            std::cmp::Ordering::Greater => assert_eq!(*red, 0),
            std::cmp::Ordering::Equal => assert!((1..255).contains(red), "{x} {y} {red}"),
        }
    }
}

#[test]
fn without_multisampling_pixels_are_whole() {
    let found = resolved_triangle(false);
    assert!(found.iter().all(|red| matches!(red, 0 | 255)));
    assert!(found.iter().filter(|red| **red == 255).count() >= 28);
}

/// Pictures of 16 x 16 pixels in a framebuffer of some number of samples without multisampling: two triangles in
/// parts of it, by viewport or scissor, one with a clear before it, a line and a large point.
fn parts(samples: i32, scissors: bool) -> Vec<u8> {
    let mut c = context(16, 16);
    object(&mut c, [16, 16], samples);
    c.disable(gl::MULTISAMPLE);
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::LEQUAL);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    for (k, [x, y]) in [[1, 2], [7, 5]].into_iter().enumerate() {
        if scissors {
            c.enable(gl::SCISSOR_TEST);
            c.scissor(x, y, 8, 9);
        } else {
            c.viewport(x, y, 8, 9);
        }
        if k == 1 {
            c.clear(gl::DEPTH_BUFFER_BIT);
        }
        c.color([1.0 - 0.5 * k as f32, 0.0, 0.0]);
        c.begin(gl::TRIANGLES);
        [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0f32]].into_iter().for_each(|v| c.vertex(v));
        c.end();
        c.finish();
    }
    c.point_size(5.0);
    for mode in [gl::LINES, gl::POINTS] {
        c.color([0.3, 0.0, 0.0]);
        c.begin(mode);
        [[-0.9, -0.9], [0.9, 0.8f32]].into_iter().for_each(|v| c.vertex(v));
        c.end();
    }
    c.disable(gl::SCISSOR_TEST);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    c.blit_framebuffer([0, 0, 16, 16], [0, 0, 16, 16], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    reds(&mut c, [16, 16])
}

#[test]
fn without_multisampling_samples_follow_their_pixels_in_every_part() {
    for scissors in [false, true] {
        let single = parts(0, scissors);
        assert!(single.iter().filter(|red| **red == 255).count() > 9);
        assert_eq!(parts(4, scissors), single);
    }
}

#[test]
fn a_texture_is_depth_and_stencil_at_once() {
    let mut c = context(2, 2);
    let texture = c.gen_textures(1)[0];
    c.bind_texture(gl::TEXTURE_2D, texture);
    let (format, ty) = (gl::DEPTH_STENCIL, gl::UNSIGNED_INT_24_8);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::DEPTH_STENCIL as i32, [2, 2], 0, format, ty, None);
    let name = c.gen_framebuffers(1)[0];
    c.bind_framebuffer(gl::FRAMEBUFFER, name);
    let point = gl::DEPTH_STENCIL_ATTACHMENT;
    c.framebuffer_texture_2d(gl::DRAW_FRAMEBUFFER, point, gl::TEXTURE_2D, texture, 0);
    for point in [gl::DEPTH_ATTACHMENT, gl::STENCIL_ATTACHMENT, gl::DEPTH_STENCIL_ATTACHMENT] {
        let mut ask = |name| c.get_framebuffer_attachment_parameter(gl::FRAMEBUFFER, point, name);
        assert_eq!(ask(gl::FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE), gl::TEXTURE as i32);
        assert_eq!(ask(gl::FRAMEBUFFER_ATTACHMENT_OBJECT_NAME), texture as i32);
    }
    c.clear_depth(0.5);
    c.clear_stencil(7);
    c.clear(gl::DEPTH_BUFFER_BIT | gl::STENCIL_BUFFER_BIT);
    assert_eq!((depths(&mut c, [2, 2]), stencils(&mut c, [2, 2])), (vec![0.5; 4], vec![7; 4]));
}

#[test]
fn luminance_is_kept_but_not_drawn_to() {
    let mut c = context(1, 1);
    object(&mut c, [1, 1], 0);
    let buffer = c.gen_renderbuffers(1)[0];
    c.bind_renderbuffer(gl::RENDERBUFFER, buffer);
    c.renderbuffer_storage(gl::RENDERBUFFER, gl::LUMINANCE, [1, 1]);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::RENDERBUFFER, buffer);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_UNSUPPORTED);
    c.clear(gl::COLOR_BUFFER_BIT);
    assert_eq!(c.get_error(), gl::INVALID_FRAMEBUFFER_OPERATION);
}

#[test]
fn the_border_of_a_texture_is_drawn_to() {
    let mut c = context(1, 1);
    object(&mut c, [1, 1], 0);
    let texture = c.gen_textures(1)[0];
    c.bind_texture(gl::TEXTURE_2D, texture);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::RGBA as i32, [4, 4], 1, gl::RGBA, gl::UNSIGNED_BYTE, None);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::TEXTURE_2D, texture, 0);
    c.framebuffer_renderbuffer(gl::FRAMEBUFFER, gl::DEPTH_STENCIL_ATTACHMENT, gl::RENDERBUFFER, 0);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.clear_color([1.0, 0.0, 0.0, 1.0]);
    c.clear(gl::COLOR_BUFFER_BIT);
    let mut out = [0; 4 * 4 * 4];
    c.get_tex_image(gl::TEXTURE_2D, 0, gl::RGBA, gl::UNSIGNED_BYTE, &mut out);
    assert!(out.chunks_exact(4).all(|texel| texel == [255, 0, 0, 255]), "{out:?}");
}

/// OpenGL 1.5, section 3.8.8: the level of detail goes by pixels, however many samples they have.
#[test]
fn samples_read_the_level_of_their_pixel() {
    let red = |level: u8| [40 * level + 40, 0, 0, 255];
    for samples in [0, 4] {
        let mut c = context(16, 16);
        object(&mut c, [16, 16], samples);
        c.viewport(0, 0, 16, 16);
        for level in 0..6u8 {
            let side = 32 >> level;
            let texels = red(level).repeat((side * side) as usize);
            let (level, format) = (i32::from(level), gl::RGBA);
            let size = [side, side];
            c.tex_image_2d(
                gl::TEXTURE_2D,
                level,
                format as i32,
                size,
                0,
                format,
                gl::UNSIGNED_BYTE,
                Some(&texels),
            );
        }
        for (name, value) in
            [(gl::TEXTURE_MIN_FILTER, gl::NEAREST_MIPMAP_NEAREST), (gl::TEXTURE_MAG_FILTER, gl::NEAREST)]
        {
            c.tex_parameter(gl::TEXTURE_2D, name, &[f64::from(value)]);
        }
        c.enable(gl::TEXTURE_2D);
        for (repeats, level) in [(0.5, 0), (1.0, 1), (2.0, 2), (4.0, 3)] {
            c.begin(gl::QUADS);
            for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0f32]] {
                c.tex_coord([x * repeats, y * repeats]);
                c.vertex([2.0 * x - 1.0, 2.0 * y - 1.0]);
            }
            c.end();
            let name = c.framebuffers.draw;
            c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
            c.blit_framebuffer([0, 0, 16, 16], [0, 0, 16, 16], gl::COLOR_BUFFER_BIT, gl::NEAREST);
            c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
            let colors = rgba(&mut c, [0, 0], [16, 16]);
            assert!(colors.iter().all(|color| *color == red(level)), "{samples} samples, level {level}");
            c.bind_framebuffer(gl::FRAMEBUFFER, name);
        }
    }
}
