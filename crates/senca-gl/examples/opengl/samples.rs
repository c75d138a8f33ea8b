//! The four sample programs.

use senca_gl::{Context, gl};

/// A parallel projection that shows at least [-half, half] on both axes, with the same scale.
pub(crate) fn ortho_about(c: &mut Context, aspect: f64, half: f64, near: f64, far: f64) {
    let [x, y] = if aspect <= 1.0 { [half, half / aspect] } else { [half * aspect, half] };
    c.matrix_mode(gl::PROJECTION);
    c.load_identity();
    c.ortho(-x, x, -y, y, near, far);
    c.matrix_mode(gl::MODELVIEW);
    c.load_identity();
}

pub(crate) fn first(c: &mut Context, aspect: f64) {
    ortho_about(c, aspect, 10.0, -1.0, 1.0);
    c.begin(gl::LINES);
    c.color([0.0, 1.0, 0.0]);
    c.vertex([0.0f32, 0.0, 0.0]);
    c.vertex([-9.0, 0.0, 0.0]);
    c.color([1.0, 0.0, 1.0]);
    c.vertex([0.0, 0.0, 0.0]);
    c.vertex([9.0, 9.0, 0.0]);
    c.end();
}

pub(crate) fn texture(c: &mut Context, aspect: f64) {
    let texel = |row: usize, column: usize| if (row & 8 == 0) != (column & 8 == 0) { 255 } else { 0 };
    let board: Vec<u8> = (0..64).flat_map(|r| (0..64).flat_map(move |k| [texel(r, k); 3])).collect();
    c.enable(gl::DEPTH_TEST);
    c.depth_func(gl::LEQUAL);
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    c.tex_image_2d(gl::TEXTURE_2D, 0, 3, [64, 64], 0, gl::RGB, gl::UNSIGNED_BYTE, Some(&board));
    for (name, value) in [
        (gl::TEXTURE_WRAP_S, gl::CLAMP),
        (gl::TEXTURE_WRAP_T, gl::CLAMP),
        (gl::TEXTURE_MAG_FILTER, gl::NEAREST),
        (gl::TEXTURE_MIN_FILTER, gl::NEAREST),
    ] {
        c.tex_parameter(gl::TEXTURE_2D, name, &[f64::from(value)]);
    }
    c.tex_env(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, &[gl::DECAL as f32]);
    c.enable(gl::TEXTURE_2D);
    c.shade_model(gl::FLAT);
    c.matrix_mode(gl::PROJECTION);
    c.load_identity();
    c.perspective(60.0, aspect, 1.0, 30.0);
    c.matrix_mode(gl::MODELVIEW);
    c.load_identity();
    c.translate([0.0, 0.0, -3.6]);
    c.begin(gl::QUADS);
    // The second one, two units wide, is turned by 45 degrees.
    let turned = std::f64::consts::SQRT_2;
    for [left, right, back] in [[-2.0, 0.0, 0.0], [1.0, 1.0 + turned, -turned]] {
        c.tex_coord([0.0, 0.0]);
        c.vertex([left, -1.0, 0.0]);
        c.tex_coord([0.0, 1.0]);
        c.vertex([left, 1.0, 0.0]);
        c.tex_coord([1.0, 1.0]);
        c.vertex([right, 1.0, back]);
        c.tex_coord([1.0, 0.0]);
        c.vertex([right, -1.0, back]);
    }
    c.end();
}

pub(crate) fn curve(c: &mut Context, aspect: f64) {
    let points = [-4.0, -4.0, 0.0, -2.0, 4.0, 0.0, 2.0, -4.0, 0.0, 4.0, 4.0, 0.0];
    ortho_about(c, aspect, 5.0, -1.0, 1.0);
    c.map1(gl::MAP1_VERTEX_3, [0.0, 1.0], 3, 4, &points);
    c.enable(gl::MAP1_VERTEX_3);
    c.shade_model(gl::FLAT);
    c.color([1.0, 1.0, 1.0]);
    c.begin(gl::LINE_STRIP);
    (0..=30).for_each(|i| c.eval_coord1(i as f32 / 30.0));
    c.end();
}

const HEIGHTS: [[f32; 4]; 4] =
    [[4.0, 2.0, -1.0, 2.0], [1.0, 3.0, 0.0, -1.0], [4.0, 0.0, 3.0, 4.0], [-2.0, -2.0, 0.0, -1.0]];

pub(crate) fn surface(c: &mut Context, aspect: f64) {
    let place = |k: usize| k as f32 - 1.5;
    let points: Vec<f32> =
        (0..16).flat_map(|k| [place(k % 4), place(k / 4), HEIGHTS[k / 4][k % 4]]).collect();
    c.enable(gl::DEPTH_TEST);
    c.map2(gl::MAP2_VERTEX_3, [0.0, 1.0], [0.0, 1.0], [3, 12], [4, 4], &points);
    c.enable(gl::MAP2_VERTEX_3);
    c.enable(gl::AUTO_NORMAL);
    c.enable(gl::NORMALIZE);
    c.map_grid2([20, 20], [0.0, 1.0], [0.0, 1.0]);
    c.enable(gl::LIGHTING);
    c.enable(gl::LIGHT0);
    c.light(gl::LIGHT0, gl::AMBIENT, &[0.2, 0.2, 0.2, 1.0]);
    c.light(gl::LIGHT0, gl::POSITION, &[0.0, 0.0, 2.0, 1.0]);
    c.material(gl::FRONT, gl::DIFFUSE, &[0.6, 0.6, 0.6, 1.0]);
    c.material(gl::FRONT, gl::SPECULAR, &[1.0, 1.0, 1.0, 1.0]);
    c.material(gl::FRONT, gl::SHININESS, &[50.0]);
    ortho_about(c, aspect, 4.0, -4.0, 4.0);
    c.push_matrix();
    c.rotate(85.0, [1.0, 1.0, 1.0]);
    c.eval_mesh2(gl::FILL, [0, 20], [0, 20]);
    c.pop_matrix();
}
