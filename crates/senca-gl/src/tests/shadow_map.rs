//! Depth textures that are drawn to: kept in blocks or row by row, nobody sees which.

use crate::texture::Texels;
use crate::{Config, Context, gl};

const SIZE: i32 = 200;
const VIEW: i32 = 64;

/// A context whose framebuffer is a depth texture and nothing else.
fn context() -> (Context, u32) {
    let mut c = Context::new(Config::default());
    assert!(c.resize(VIEW as u32, VIEW as u32));
    let texture = c.gen_textures(1)[0];
    c.bind_texture(gl::TEXTURE_2D, texture);
    let (format, ty) = (gl::DEPTH_COMPONENT, gl::FLOAT);
    c.tex_image_2d(gl::TEXTURE_2D, 0, gl::DEPTH_COMPONENT as i32, [SIZE; 2], 0, format, ty, None);
    for (name, value) in [
        (gl::TEXTURE_MIN_FILTER, gl::LINEAR),
        (gl::TEXTURE_MAG_FILTER, gl::LINEAR),
        (gl::TEXTURE_WRAP_S, gl::CLAMP_TO_EDGE),
        (gl::TEXTURE_WRAP_T, gl::CLAMP_TO_EDGE),
        (gl::TEXTURE_COMPARE_FUNC, gl::LEQUAL),
    ] {
        c.tex_parameter(gl::TEXTURE_2D, name, &[f64::from(value)]);
    }
    let name = c.gen_framebuffers(1)[0];
    c.bind_framebuffer(gl::FRAMEBUFFER, name);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, texture, 0);
    c.draw_buffer(gl::NONE);
    c.read_buffer(gl::NONE);
    assert_eq!(c.check_framebuffer_status(gl::FRAMEBUFFER), gl::FRAMEBUFFER_COMPLETE);
    c.viewport(0, 0, SIZE, SIZE);
    c.enable(gl::DEPTH_TEST);
    (c, name)
}

/// A tilted floor of quadrilaterals and something above it.
fn draw(c: &mut Context) {
    let at = |n: i32| f64::from(n) / 4.0 - 1.0;
    c.begin(gl::QUADS);
    for y in 0..8 {
        for x in 0..8 {
            for (x, y) in [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)] {
                c.vertex([at(x), at(y), 0.6 + 0.2 * at(x) - 0.1 * at(y)]);
            }
        }
    }
    c.end();
    c.begin(gl::TRIANGLES);
    for corner in [[-0.5, -0.4, 0.1], [0.6, -0.2, -0.3], [0.1, 0.7, 0.2]] {
        c.vertex(corner);
    }
    c.end();
}

/// Draws after a clear; `settled`: the clear is done before, so that depths stay rows.
fn drawn(settled: bool) -> (Context, u32) {
    let (mut c, name) = context();
    c.clear(gl::DEPTH_BUFFER_BIT);
    if settled {
        c.finish();
    }
    draw(&mut c);
    (c, name)
}

fn texels(c: &mut Context) -> Vec<u8> {
    let mut out = vec![0; (SIZE * SIZE * 4) as usize];
    c.get_tex_image(gl::TEXTURE_2D, 0, gl::DEPTH_COMPONENT, gl::FLOAT, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out
}

/// The texture on a square that fills the window, perhaps compared with a depth.
fn seen(c: &mut Context, compared: bool) -> Vec<u8> {
    c.bind_framebuffer(gl::FRAMEBUFFER, 0);
    c.viewport(0, 0, VIEW, VIEW);
    c.disable(gl::DEPTH_TEST);
    let mode = if compared { gl::COMPARE_R_TO_TEXTURE } else { gl::NONE };
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_COMPARE_MODE, &[f64::from(mode)]);
    c.enable(gl::TEXTURE_2D);
    c.begin(gl::QUADS);
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        c.tex_coord([x, y, 0.7]);
        c.vertex([2.0 * x - 1.0, 2.0 * y - 1.0]);
    }
    c.end();
    let mut out = vec![0; (VIEW * VIEW * 4) as usize];
    c.read_pixels([0, 0], [VIEW; 2], gl::RGBA, gl::UNSIGNED_BYTE, &mut out);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    out
}

#[test]
fn a_map_is_kept_in_blocks_after_a_clear_that_waited() {
    for settled in [false, true] {
        let (mut c, _) = drawn(settled);
        c.finish();
        let mut planes = c.framebuffers.take_planes();
        let Some(Texels::Depth(depths)) = planes.depth().map(|plane| (*plane.texels).clone()) else {
            panic!("a texture of depths")
        };
        c.framebuffers.put_back(planes);
        assert_eq!(depths.blocks().is_some(), !settled);
    }
}

#[test]
fn depths_in_blocks_are_read_and_sampled_as_rows_are() {
    assert_eq!(texels(&mut drawn(false).0), texels(&mut drawn(true).0));
    for compared in [false, true] {
        let (a, b) = (seen(&mut drawn(false).0, compared), seen(&mut drawn(true).0, compared));
        assert_eq!(a, b);
        assert!(a.iter().any(|v| *v != a[0]), "something is to be seen");
    }
}

#[test]
fn depths_in_blocks_are_drawn_to_in_all_ways() {
    // Read between, sampled between, written to by a line, a copy and an upload, cleared in part.
    let both = [false, true].map(|settled| {
        let (mut c, name) = drawn(settled);
        let mut all = texels(&mut c);
        all.extend(seen(&mut c, true));
        c.disable(gl::TEXTURE_2D);
        c.enable(gl::DEPTH_TEST);
        c.bind_framebuffer(gl::FRAMEBUFFER, name);
        c.viewport(0, 0, SIZE, SIZE);
        draw(&mut c);
        c.begin(gl::LINES);
        c.vertex([-1.0, -1.0, -0.9]);
        c.vertex([1.0, 0.7, -0.5]);
        c.end();
        all.extend(texels(&mut c));
        c.clear(gl::DEPTH_BUFFER_BIT);
        if settled {
            c.finish();
        }
        draw(&mut c);
        c.enable(gl::SCISSOR_TEST);
        c.scissor(30, 40, 90, 50);
        c.clear_depth(0.25);
        c.clear(gl::DEPTH_BUFFER_BIT);
        all.extend(texels(&mut c));
        all
    });
    assert!(both[0] == both[1]);
}
