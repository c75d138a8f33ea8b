//! Turning from one framebuffer to another and back: what waits for the one that is not drawn to is drawn as if it had
//! been drawn at once.

use crate::{Config, Context, gl};

const SIZE: i32 = 96;

/// Numbers below a bound, the same in every run.
struct Random(u32);

impl Random {
    fn below(&mut self, n: u32) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) % n
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.below(1 << 16)) / f64::from(1 << 16)
    }
}

/// A context with framebuffers: the window, renderbuffers of several samples, renderbuffers, a texture of depths,
/// a texture of colours with one of depths. The textures are bound to the units of their number.
fn context() -> (Context, [u32; 5]) {
    let mut c = Context::new(Config::default());
    assert!(c.resize(SIZE as u32, SIZE as u32));
    let textures = c.gen_textures(3);
    for (unit, texture) in textures.iter().enumerate() {
        c.active_texture(gl::TEXTURE0 + unit as u32);
        c.bind_texture(gl::TEXTURE_2D, *texture);
        let format = if unit == 1 { gl::RGBA } else { gl::DEPTH_COMPONENT };
        c.tex_image_2d(gl::TEXTURE_2D, 0, format as i32, [SIZE; 2], 0, format, gl::FLOAT, None);
        for name in [gl::TEXTURE_MIN_FILTER, gl::TEXTURE_MAG_FILTER] {
            c.tex_parameter(gl::TEXTURE_2D, name, &[f64::from(gl::LINEAR)]);
        }
        if unit != 1 {
            c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_COMPARE_MODE, &[f64::from(gl::COMPARE_R_TO_TEXTURE)]);
        }
    }
    let (names, buffers) = (c.gen_framebuffers(4), c.gen_renderbuffers(4));
    for (k, (color, depth)) in [(0, 1), (2, 3)].into_iter().enumerate() {
        c.bind_framebuffer(gl::FRAMEBUFFER, names[k]);
        let points =
            [(color, gl::RGBA8, gl::COLOR_ATTACHMENT0), (depth, gl::DEPTH_COMPONENT24, gl::DEPTH_ATTACHMENT)];
        for (buffer, format, point) in points {
            c.bind_renderbuffer(gl::RENDERBUFFER, buffers[buffer]);
            let samples = if k == 0 { 4 } else { 0 };
            c.renderbuffer_storage_multisample(gl::RENDERBUFFER, samples, format, [SIZE; 2]);
            c.framebuffer_renderbuffer(gl::FRAMEBUFFER, point, gl::RENDERBUFFER, buffers[buffer]);
        }
    }
    c.bind_framebuffer(gl::FRAMEBUFFER, names[2]);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, textures[0], 0);
    c.draw_buffer(gl::NONE);
    c.read_buffer(gl::NONE);
    c.bind_framebuffer(gl::FRAMEBUFFER, names[3]);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::COLOR_ATTACHMENT0, gl::TEXTURE_2D, textures[1], 0);
    c.framebuffer_texture_2d(gl::FRAMEBUFFER, gl::DEPTH_ATTACHMENT, gl::TEXTURE_2D, textures[2], 0);
    c.enable(gl::DEPTH_TEST);
    assert_eq!(c.get_error(), gl::NO_ERROR);
    (c, [0, names[0], names[1], names[2], names[3]])
}

/// Some triangles with texture coordinates on all units.
fn triangles(c: &mut Context, r: &mut Random) {
    c.begin(gl::TRIANGLES);
    for _ in 0..3 * (1 + r.below(3)) {
        c.color([r.unit(), r.unit(), r.unit(), 1.0]);
        for unit in 0..3 {
            c.multi_tex_coord(gl::TEXTURE0 + unit, [r.unit(), r.unit(), r.unit()]);
        }
        c.vertex([2.4 * r.unit() - 1.2, 2.4 * r.unit() - 1.2, 2.2 * r.unit() - 1.1]);
    }
    c.end();
}

fn read(c: &mut Context, out: &mut Vec<u8>) {
    let mut pixels = vec![0; (SIZE * SIZE * 4) as usize];
    c.read_pixels([0, 0], [SIZE; 2], gl::RGBA, gl::UNSIGNED_BYTE, &mut pixels);
    // There may be no colours to read, or several samples.
    c.get_error();
    out.extend(pixels);
}

/// Binds a framebuffer to be drawn to. What is drawn to its textures reads none.
fn turn(c: &mut Context, target: u32, name: u32, names: &[u32; 5]) {
    c.bind_framebuffer(target, name);
    for unit in (0..3).filter(|_| names[3..].contains(&name)) {
        c.active_texture(gl::TEXTURE0 + unit);
        c.disable(gl::TEXTURE_2D);
    }
}

/// One command of many; what it reads goes to `out`.
fn command(c: &mut Context, names: &[u32; 5], r: &mut Random, out: &mut Vec<u8>) {
    let any = |r: &mut Random| names[r.below(5) as usize];
    match r.below(24) {
        0..=7 => turn(c, gl::FRAMEBUFFER, any(r), names),
        8 => turn(c, gl::DRAW_FRAMEBUFFER, any(r), names),
        9 => c.bind_framebuffer(gl::READ_FRAMEBUFFER, any(r)),
        10..=11 => c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT),
        12 => c.clear(gl::DEPTH_BUFFER_BIT),
        13 => {
            c.active_texture(gl::TEXTURE0 + r.below(3));
            let may = !names[3..].contains(&c.framebuffers.draw);
            if may && r.below(3) > 0 { c.enable(gl::TEXTURE_2D) } else { c.disable(gl::TEXTURE_2D) }
        }
        14 => {
            c.active_texture(gl::TEXTURE0 + 1);
            let texels = [r.below(256) as u8; 4 * 8 * 8];
            let at = [r.below(80) as i32, r.below(80) as i32];
            c.tex_sub_image_2d(gl::TEXTURE_2D, 0, at, [8, 8], gl::RGBA, gl::UNSIGNED_BYTE, Some(&texels));
        }
        15 => read(c, out),
        16 => {
            let area = [0, 0, SIZE, SIZE];
            c.blit_framebuffer(area, area, gl::COLOR_BUFFER_BIT, gl::NEAREST);
        }
        17 => {
            c.active_texture(gl::TEXTURE0 + 1);
            c.copy_tex_sub_image_2d(gl::TEXTURE_2D, 0, [3, 5], [7, 9], [20, 30]);
        }
        18 => {
            if r.below(2) == 0 {
                c.enable(gl::SCISSOR_TEST)
            } else {
                c.disable(gl::SCISSOR_TEST)
            }
            c.scissor(8, 16, 40, 64);
        }
        _ => triangles(c, r),
    }
    c.get_error();
}

/// What is in all framebuffers that can be read after some commands.
fn drawn(seed: u32, flushed: bool) -> Vec<u8> {
    let ((mut c, names), mut r) = (context(), Random(seed));
    let mut out = Vec::new();
    for _ in 0..60 {
        command(&mut c, &names, &mut r, &mut out);
        if flushed {
            c.finish();
        }
    }
    for name in [0, 2, 4].map(|k| names[k]) {
        c.bind_framebuffer(gl::READ_FRAMEBUFFER, name);
        read(&mut c, &mut out);
    }
    // Those of several samples, seen through the window.
    c.disable(gl::SCISSOR_TEST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, names[1]);
    c.bind_framebuffer(gl::DRAW_FRAMEBUFFER, 0);
    c.blit_framebuffer([0, 0, SIZE, SIZE], [0, 0, SIZE, SIZE], gl::COLOR_BUFFER_BIT, gl::NEAREST);
    c.bind_framebuffer(gl::READ_FRAMEBUFFER, 0);
    read(&mut c, &mut out);
    for unit in [0, 2] {
        c.active_texture(gl::TEXTURE0 + unit);
        let mut depths = vec![0; (SIZE * SIZE * 4) as usize];
        c.get_tex_image(gl::TEXTURE_2D, 0, gl::DEPTH_COMPONENT, gl::FLOAT, &mut depths);
        out.extend(depths);
    }
    out
}

#[test]
fn nothing_shows_whether_commands_wait() {
    for seed in 0..80 {
        assert!(drawn(seed, false) == drawn(seed, true), "seed {seed}");
    }
}

#[test]
fn a_scene_waits_while_its_shadow_map_is_drawn() {
    let ((mut c, names), mut r) = (context(), Random(1));
    c.bind_framebuffer(gl::FRAMEBUFFER, names[1]);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    triangles(&mut c, &mut r);
    c.bind_framebuffer(gl::FRAMEBUFFER, names[3]);
    assert!(c.parked.is_some());
    c.clear(gl::DEPTH_BUFFER_BIT);
    triangles(&mut c, &mut r);
    c.bind_framebuffer(gl::FRAMEBUFFER, names[1]);
    assert!(c.parked.is_none() && c.waiting.len() == 1);
    // What reads the map does not wait while the map is drawn anew.
    c.active_texture(gl::TEXTURE0);
    c.enable(gl::TEXTURE_2D);
    triangles(&mut c, &mut r);
    c.bind_framebuffer(gl::FRAMEBUFFER, names[3]);
    assert!(c.parked.is_none() && c.waiting.is_empty());
    assert_eq!(c.get_error(), gl::NO_ERROR);
}
