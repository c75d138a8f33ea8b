//! Whole drawings, by the numbers of the course text's chapter 5.

use crate::{Config, Context, gl};

fn context(width: u32, height: u32) -> Context {
    let mut c = Context::new(Config::default());
    assert!(c.resize(width, height));
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c
}

/// A pixel, x to the right, y up.
fn pixel(c: &mut Context, width: usize, x: usize, y: usize) -> [u8; 4] {
    c.flush();
    c.window_pixels()[y * width + x]
}

fn triangle(c: &mut Context) {
    c.begin(gl::TRIANGLES);
    c.vertex([-1.0, -1.0]);
    c.vertex([1.0, -1.0]);
    c.vertex([-1.0, 1.0]);
    c.end();
}

#[test]
fn row_0_is_the_lowest() {
    let mut c = context(8, 8);
    triangle(&mut c);
    assert_eq!(pixel(&mut c, 8, 0, 0), [255; 4]);
    assert_eq!(pixel(&mut c, 8, 6, 0), [255; 4]);
    assert_eq!(pixel(&mut c, 8, 7, 7), [0; 4]);
    assert_eq!(pixel(&mut c, 8, 6, 6), [0; 4]);
}

#[test]
fn faces_are_culled_by_their_turn_in_the_window() {
    for (cull, front, drawn) in [
        (gl::BACK, gl::CCW, true),
        (gl::FRONT, gl::CCW, false),
        (gl::BACK, gl::CW, false),
        (gl::FRONT, gl::CW, true),
        (gl::FRONT_AND_BACK, gl::CCW, false),
    ] {
        let mut c = context(4, 4);
        c.enable(gl::CULL_FACE);
        c.cull_face(cull);
        c.front_face(front);
        triangle(&mut c);
        assert_eq!(pixel(&mut c, 4, 0, 0) == [255; 4], drawn, "{cull:#x} {front:#x}");
    }
}

#[test]
fn lists_arrays_and_single_vertices_draw_alike() {
    let draw = |c: &mut Context| {
        c.begin(gl::TRIANGLE_STRIP);
        for (k, v) in [[-0.9f32, -0.9], [0.9, -0.8], [-0.7, 0.9], [0.8, 0.7]].into_iter().enumerate() {
            c.color([k as f32 * 0.3, 0.5, 1.0 - k as f32 * 0.3]);
            c.vertex(v);
        }
        c.end();
    };
    let mut one = context(32, 32);
    draw(&mut one);
    one.finish();
    let mut list = context(32, 32);
    list.new_list(3, gl::COMPILE);
    draw(&mut list);
    list.end_list();
    list.call_list(3);
    list.finish();
    assert!(one.window_pixels() == list.window_pixels());
    let mut arrays = context(32, 32);
    let bytes: Vec<u8> = [[-0.9f32, -0.9], [0.9, -0.8], [-0.7, 0.9], [0.8, 0.7]]
        .iter()
        .enumerate()
        .flat_map(|(k, v)| [v[0], v[1], k as f32 * 0.3, 0.5, 1.0 - k as f32 * 0.3])
        .flat_map(f32::to_ne_bytes)
        .collect();
    let all: std::sync::Arc<[u8]> = bytes.into();
    arrays.vertex_pointer(2, gl::FLOAT, 20, crate::ArraySource::Owned(all.clone()));
    arrays.color_pointer(3, gl::FLOAT, 20, crate::ArraySource::Owned(all[8..].into()));
    arrays.enable_client_state(gl::VERTEX_ARRAY);
    arrays.enable_client_state(gl::COLOR_ARRAY);
    arrays.draw_elements(gl::TRIANGLE_STRIP, &[0, 1, 2, 3]);
    arrays.finish();
    assert!(one.window_pixels() == arrays.window_pixels());
}

#[test]
fn lists_of_many_triangles_share_their_corners_and_draw_alike() {
    let draw = |c: &mut Context| {
        c.begin(gl::TRIANGLES);
        for k in 0..200 {
            let (x, y) = (f64::from(k % 20) / 10.0 - 1.0, f64::from(k / 20) / 5.0 - 1.0);
            for (dx, dy) in [(0.0, 0.0), (0.1, 0.0), (0.0, 0.2), (0.1, 0.0), (0.1, 0.2), (0.0, 0.2)] {
                c.color([(x + dx).abs(), (y + dy).abs(), 0.5]);
                c.vertex([x + dx, y + dy]);
            }
        }
        c.end();
    };
    let (mut one, mut list) = (context(40, 40), context(40, 40));
    draw(&mut one);
    one.finish();
    list.new_list(1, gl::COMPILE);
    draw(&mut list);
    list.end_list();
    list.call_list(1);
    list.finish();
    assert!(one.window_pixels() == list.window_pixels());
}

#[test]
fn long_strips_and_loops_are_drawn_in_pieces() {
    // More vertices than are drawn at once: a strip of slivers that fills the window.
    let mut c = context(16, 4);
    let columns = 70_000;
    c.begin(gl::TRIANGLE_STRIP);
    for k in 0..=columns {
        let x = 2.0 * f64::from(k) / f64::from(columns) - 1.0;
        c.vertex([x, -1.0]);
        c.vertex([x, 1.0]);
    }
    c.end();
    c.finish();
    assert!(c.window_pixels().iter().all(|p| *p == [255; 4]));
}

#[test]
fn matrices_and_colours_between_objects_need_no_second_drawing() {
    let mut c = context(8, 4);
    for (x, color) in [(-0.5, [255u8, 0, 0]), (0.5, [0, 255, 0])] {
        c.load_identity();
        c.translate([x, 0.0, 0.0]);
        c.scale([0.5, 1.0, 1.0]);
        c.color(color);
        c.rect([-1, -1], [1, 1]);
    }
    assert_eq!(pixel(&mut c, 8, 0, 0), [255, 0, 0, 255]);
    assert_eq!(pixel(&mut c, 8, 7, 3), [0, 255, 0, 255]);
}

#[test]
fn flat_colours_come_from_the_last_vertex_and_of_polygons_from_the_first() {
    let mut c = context(8, 8);
    c.shade_model(gl::FLAT);
    c.begin(gl::POLYGON);
    for (k, v) in [[-1, -1], [1, -1], [1, 1], [-1, 1]].into_iter().enumerate() {
        c.color([(k * 80) as u8, 0, 0]);
        c.vertex(v);
    }
    c.end();
    assert_eq!(pixel(&mut c, 8, 4, 4), [0, 0, 0, 255]);
    c.begin(gl::QUADS);
    for (k, v) in [[-1, -1], [1, -1], [1, 1], [-1, 1]].into_iter().enumerate() {
        c.color([(k * 80) as u8, 0, 0]);
        c.vertex(v);
    }
    c.end();
    assert_eq!(pixel(&mut c, 8, 1, 6), [240, 0, 0, 255]);
}

#[test]
fn user_clip_planes_cut() {
    let mut c = context(8, 8);
    c.clip_plane(gl::CLIP_PLANE2, [1.0, 0.0, 0.0, 0.0]);
    c.enable(gl::CLIP_PLANE2);
    c.rect([-1, -1], [1, 1]);
    assert_eq!(pixel(&mut c, 8, 3, 3), [0; 4]);
    assert_eq!(pixel(&mut c, 8, 4, 3), [255; 4]);
}

/// Drawn with planes is what is drawn without, within the planes: whole triangles to the bit, cut ones but for rounding.
#[test]
fn user_clip_planes_leave_the_rest_as_it_was() {
    let draw = |planes: bool| {
        let mut c = context(64, 64);
        if planes {
            c.clip_plane(gl::CLIP_PLANE0, [1.0, 0.25, 0.0, 0.1]);
            c.clip_plane(gl::CLIP_PLANE3, [-0.5, 1.0, 0.0, 0.3]);
            c.enable(gl::CLIP_PLANE0);
            c.enable(gl::CLIP_PLANE3);
        }
        for row in 0..8 {
            c.begin(gl::QUAD_STRIP);
            for k in 0..18 {
                let (x, y) = ((k / 2) as f32 / 4.0 - 1.0, (row + k % 2) as f32 / 4.0 - 1.0);
                c.color([0.5 + 0.5 * x * y, (x * 3.0).sin().abs(), 1.0 - y.abs()]);
                c.vertex([x, y]);
            }
            c.end();
        }
        c.flush();
        c.window_pixels().to_vec()
    };
    let (whole, cut) = (draw(false), draw(true));
    let (mut within, mut same) = (0, 0);
    for (i, (whole, cut)) in whole.iter().zip(&cut).enumerate() {
        let [x, y] = [i % 64, i / 64].map(|p| (p as f32 + 0.5) / 32.0 - 1.0);
        let least = (x + 0.25 * y + 0.1).min(-0.5 * x + y + 0.3);
        if least > 1e-4 {
            within += 1;
            same += usize::from(whole == cut);
            assert!(whole.iter().zip(cut).all(|(a, b)| a.abs_diff(*b) <= 1), "{x} {y}");
        } else if least < -1e-4 {
            assert_eq!(*cut, [0; 4], "{x} {y}");
        }
    }
    assert!(within > 1000 && same > within * 9 / 10, "{same} of {within}");
}

/// The course text's picking example, section 5.10: three objects in the plane z = 0, all hit.
#[test]
fn three_hits_have_thirteen_words() {
    let mut c = context(8, 8);
    c.select_buffer(512);
    c.render_mode(gl::SELECT);
    c.init_names();
    c.push_name(1);
    triangle(&mut c);
    c.load_name(2);
    triangle(&mut c);
    c.push_name(1);
    triangle(&mut c);
    assert_eq!(c.render_mode(gl::RENDER), 3);
    let z = 1u32 << 31;
    assert_eq!(c.selected(), [1, z, z, 1, 1, z, z, 2, 2, z, z, 2, 1]);
    assert!(c.window_pixels().iter().all(|p| *p == [0; 4]));
}

#[test]
fn feedback_tells_window_coordinates() {
    let mut c = context(100, 50);
    c.feedback_buffer(64, gl::_3D_COLOR);
    c.render_mode(gl::FEEDBACK);
    c.color([0.5, 0.25, 0.125]);
    triangle(&mut c);
    c.pass_through(7.0);
    assert_eq!(c.render_mode(gl::RENDER), 2 + 3 * 7 + 2);
    let fed = c.fed_back().to_vec();
    assert_eq!(fed[..9], [gl::POLYGON_TOKEN as f32, 3.0, 0.0, 0.0, 0.5, 0.5, 0.25, 0.125, 1.0]);
    assert_eq!(fed[9..12], [100.0, 0.0, 0.5]);
    assert_eq!(fed[23..], [gl::PASS_THROUGH_TOKEN as f32, 7.0]);
    c.feedback_buffer(5, gl::_2D);
    c.render_mode(gl::FEEDBACK);
    triangle(&mut c);
    assert_eq!(c.render_mode(gl::RENDER), -1);
}

/// Ambient of the scene and of light 0, diffuse and specular, at full incidence, by hand.
#[test]
fn a_lit_vertex_has_the_colour_of_the_formula() {
    let mut c = context(4, 4);
    c.enable(gl::LIGHTING);
    c.enable(gl::LIGHT0);
    c.light(gl::LIGHT0, gl::AMBIENT, &[0.1, 0.1, 0.1, 1.0]);
    c.light(gl::LIGHT0, gl::DIFFUSE, &[0.5, 0.5, 0.5, 1.0]);
    c.light(gl::LIGHT0, gl::SPECULAR, &[0.25, 0.25, 0.25, 1.0]);
    c.material(gl::FRONT, gl::SPECULAR, &[1.0, 0.5, 0.0, 1.0]);
    c.material(gl::FRONT, gl::SHININESS, &[20.0]);
    c.rect([-1, -1], [1, 1]);
    // 0.2 * 0.2 + 0.2 * 0.1 + 0.8 * 0.5 = 0.46, and 0.25 times the specular colour.
    assert_eq!(pixel(&mut c, 4, 1, 1), [181, 149, 117, 255]);
}

mod parked;
mod samples;
mod shadow_map;

#[test]
fn all_units_with_fog_and_a_second_colour_are_drawn() {
    let mut c = context(4, 4);
    c.enable(gl::FOG);
    c.enable(gl::COLOR_SUM);
    c.fog(gl::FOG_MODE, &[gl::LINEAR as f32]);
    c.fog(gl::FOG_START, &[10.0]);
    c.fog(gl::FOG_END, &[20.0]);
    for unit in 0..crate::state::TEXTURE_UNITS as crate::Enum {
        c.active_texture(gl::TEXTURE0 + unit);
        c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, &[f64::from(gl::NEAREST)]);
        let (texel, format) = ([unit as u8 + 1, 2, 3, 255], gl::RGBA);
        let name = c.gen_textures(1)[0];
        c.bind_texture(gl::TEXTURE_2D, name);
        c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, &[f64::from(gl::NEAREST)]);
        c.tex_image_2d(gl::TEXTURE_2D, 0, format as i32, [1, 1], 0, format, gl::UNSIGNED_BYTE, Some(&texel));
        c.tex_env(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, &[gl::ADD as f32]);
        c.enable(gl::TEXTURE_2D);
    }
    c.color([10u8, 20, 30]);
    c.secondary_color([0u8, 0, 100]);
    triangle(&mut c);
    assert_eq!(pixel(&mut c, 4, 0, 0), [10 + 36, 20 + 16, 30 + 24 + 100, 255]);
}
