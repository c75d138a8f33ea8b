//! The exercises.

use crate::samples::ortho_about;
use crate::{letters, solids};
use senca_gl::{Context, gl};
use std::f64::consts::TAU;

/// Exercise 5.3: one of each primitive, in two rows.
pub(crate) fn primitives(c: &mut Context, aspect: f64) {
    ortho_about(c, aspect, 6.0, -1.0, 1.0);
    c.point_size(5.0);
    let ring = |n: u32| (0..n).map(move |k| (f64::from(k) / f64::from(n) * TAU).sin_cos());
    let zigzag = [[-1.0, -0.8], [-0.9, 0.8], [0.0, -0.7], [0.1, 0.9], [0.9, -0.8], [1.0, 0.7]];
    for mode in gl::POINTS..=gl::POLYGON {
        let column = f64::from(mode % 5) - 2.0;
        c.load_identity();
        c.translate([2.4 * column, if mode < 5 { 1.6 } else { -1.6 }, 0.0]);
        c.begin(mode);
        let mut say = |k: usize, v: [f64; 2]| {
            c.color([0.4 + 0.1 * k as f64, 0.9 - 0.12 * k as f64, 0.3 + 0.2 * (k % 3) as f64]);
            c.vertex(v);
        };
        match mode {
            gl::LINE_LOOP | gl::POLYGON | gl::POINTS => {
                ring(6).enumerate().for_each(|(k, (y, x))| say(k, [x, y]));
            }
            gl::TRIANGLE_FAN => {
                say(0, [0.0, 0.0]);
                ring(8).take(7).enumerate().for_each(|(k, (y, x))| say(k + 1, [x, y]));
            }
            gl::QUADS => {
                for (k, v) in [[-1.0, -0.8], [-0.2, -0.6], [-0.2, 0.7], [-1.0, 0.8]].into_iter().enumerate() {
                    say(k, v);
                }
                for (k, v) in [[0.2, -0.9], [1.0, -0.6], [0.9, 0.6], [0.2, 0.9]].into_iter().enumerate() {
                    say(k, v);
                }
            }
            _ => zigzag.into_iter().enumerate().for_each(|(k, v)| say(k, v)),
        }
        c.end();
    }
}

/// How the user has turned the eye of a central projection about what it looks at.
#[derive(Clone, Copy)]
pub(crate) struct Turn {
    /// About the z axis, in radians.
    pub(crate) around: f64,
    /// Up from where it begins, in radians.
    pub(crate) up: f64,
    /// Factor of the distance.
    pub(crate) distance: f64,
}

impl Turn {
    /// As it begins.
    pub(crate) const NONE: Self = Self { around: 0.0, up: 0.0, distance: 1.0 };

    /// The eye after turning; at most 89 degrees up or down.
    fn eye(self, eye: [f64; 3], target: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = [eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]];
        let flat = x.hypot(y);
        let (around, up) = (y.atan2(x) + self.around, z.atan2(flat) + self.up);
        let distance = flat.hypot(z) * self.distance;
        let steep = 89.0f64.to_radians();
        let ((sin, cos), (high, out)) = (around.sin_cos(), up.clamp(-steep, steep).sin_cos());
        [target[0] + distance * out * cos, target[1] + distance * out * sin, target[2] + distance * high]
    }
}

fn central(c: &mut Context, aspect: f64, eye: [f64; 3], target: [f64; 3], turn: Turn) {
    c.matrix_mode(gl::PROJECTION);
    c.load_identity();
    c.perspective(40.0, aspect, 0.5, 60.0);
    c.matrix_mode(gl::MODELVIEW);
    c.load_identity();
    c.look_at(turn.eye(eye, target), target, [0.0, 0.0, 1.0]);
}

/// Exercise 5.4: z = cos(2 pi a x) cos(2 pi b y), with a = b = 1 over [-1, 1].
pub(crate) fn waves(c: &mut Context, aspect: f64, turn: Turn) {
    const N: u32 = 60;
    c.enable(gl::DEPTH_TEST);
    central(c, aspect, [2.6, -3.4, 2.6], [0.0, 0.0, -0.1], turn);
    let at = |k: u32| 2.0 * f64::from(k) / f64::from(N) - 1.0;
    for i in 0..N {
        c.begin(gl::QUAD_STRIP);
        for j in 0..=N {
            for k in [i, i + 1] {
                let (x, y) = (at(k), at(j));
                let z = (TAU * x).cos() * (TAU * y).cos();
                let t = 0.5 + 0.5 * z;
                c.color([0.15 + 0.85 * t, 0.25 + 0.5 * t, 0.7 - 0.6 * t]);
                c.vertex([x, y, 0.35 * z]);
            }
        }
        c.end();
    }
}

/// Exercise 5.5: two arrays of ellipses out of the list of a disc, a square, and some words.
pub(crate) fn ellipses(c: &mut Context, aspect: f64) {
    ortho_about(c, aspect, 6.0, -1.0, 1.0);
    let disc = c.gen_lists(1);
    c.new_list(disc, gl::COMPILE);
    c.begin(gl::TRIANGLE_FAN);
    c.vertex([0.0, 0.0]);
    for k in 0..=64 {
        let (y, x) = (f64::from(k) / 64.0 * TAU).sin_cos();
        c.vertex([x, y]);
    }
    c.end();
    c.end_list();
    let mut ellipse = |centre: [f64; 2], size: [f64; 2], color: [f64; 3]| {
        c.push_matrix();
        c.translate([centre[0], centre[1], 0.0]);
        c.scale([size[0], size[1], 1.0]);
        c.color(color);
        c.call_list(disc);
        c.pop_matrix();
    };
    for k in 0..5 {
        let x = f64::from(k);
        ellipse([-4.4 + 2.2 * x, 3.6], [0.9, 0.4 + 0.1 * x], [0.9, 0.3 + 0.12 * x, 0.2]);
        ellipse([-4.4 + 2.2 * x, 1.4], [0.4 + 0.1 * x, 0.8], [0.2, 0.5, 0.4 + 0.12 * x]);
    }
    c.color([0.8, 0.8, 0.3]);
    c.rect([-5.3, -2.4], [-3.3, -0.4]);
    let font = letters::font(c);
    c.color([1.0, 1.0, 1.0]);
    c.translate([-2.6, -1.9, 0.0]);
    c.scale([0.9, 1.3, 1.0]);
    letters::write(c, font, "ELLIPSES");
    c.delete_lists(disc, 1);
    c.delete_lists(font, letters::LISTS);
}

/// How a texture is applied.
#[derive(Clone, Copy)]
pub(crate) struct Texture {
    /// The filter for minification.
    pub(crate) minifier: u32,
    /// `MODULATE`, `DECAL`, `BLEND` or `REPLACE`.
    pub(crate) mode: u32,
}

/// A chessboard of 64 x 64 texels, with all smaller levels.
fn chessboard(c: &mut Context, texture: Texture) {
    let texel =
        |r: usize, k: usize| if (r & 8 == 0) == (k & 8 == 0) { [240, 235, 220] } else { [70, 80, 110] };
    let board: Vec<u8> = (0..64).flat_map(|r| (0..64).flat_map(move |k| texel(r, k))).collect();
    c.pixel_store(gl::UNPACK_ALIGNMENT, 1);
    c.tex_image_2d(gl::TEXTURE_2D, 0, 3, [64, 64], 0, gl::RGB, gl::UNSIGNED_BYTE, Some(&board));
    c.generate_mipmap(gl::TEXTURE_2D);
    c.tex_parameter(gl::TEXTURE_2D, gl::TEXTURE_MIN_FILTER, &[f64::from(texture.minifier)]);
    c.tex_env(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE, &[texture.mode as f32]);
    c.hint(gl::PERSPECTIVE_CORRECTION_HINT, gl::NICEST);
    c.enable(gl::TEXTURE_2D);
}

/// Exercises 5.6 to 5.8: bodies on a pad, from far (0) to near (1), perhaps with a texture.
pub(crate) fn bodies(c: &mut Context, aspect: f64, nearness: f64, texture: Option<Texture>, turn: Turn) {
    c.enable(gl::DEPTH_TEST);
    c.enable(gl::LIGHTING);
    c.enable(gl::LIGHT0);
    c.enable(gl::NORMALIZE);
    c.light_model(gl::LIGHT_MODEL_AMBIENT, &[0.25, 0.25, 0.3, 1.0]);
    c.light_model(gl::LIGHT_MODEL_LOCAL_VIEWER, &[1.0]);
    c.light_model(gl::LIGHT_MODEL_COLOR_CONTROL, &[gl::SEPARATE_SPECULAR_COLOR as f32]);
    let distance = 8.5 + 30.0 * (1.0 - nearness.clamp(0.0, 1.0));
    central(c, aspect, [0.55 * distance, -0.72 * distance, 0.42 * distance], [0.0, 0.0, 0.6], turn);
    c.light(gl::LIGHT0, gl::POSITION, &[3.0, -4.0, 7.0, 1.0]);
    c.material(gl::FRONT_AND_BACK, gl::SPECULAR, &[0.6, 0.6, 0.6, 1.0]);
    c.material(gl::FRONT_AND_BACK, gl::SHININESS, &[40.0]);
    if let Some(texture) = texture {
        chessboard(c, texture);
    }
    let mut body = |place: [f64; 3], color: [f32; 3], solid: &dyn Fn(&mut Context)| {
        c.push_matrix();
        c.translate(place);
        let [r, g, b] = color;
        c.material(gl::FRONT_AND_BACK, gl::AMBIENT_AND_DIFFUSE, &[r, g, b, 1.0]);
        solid(c);
        c.pop_matrix();
    };
    body([0.0, 0.0, 0.0], [0.75, 0.75, 0.7], &|c| solids::square(c, 4.0, 16));
    body([-1.4, -0.6, 1.0], [0.85, 0.3, 0.25], &|c| solids::sphere(c, 1.0));
    body([1.3, 1.2, 0.0], [0.3, 0.65, 0.35], &|c| solids::cone(c, 1.1, 2.4));
    body([1.2, -1.5, 0.4], [0.3, 0.45, 0.85], &|c| solids::torus(c, 0.9, 0.4));
}

/// Exercise 5.9: a bowl of four patches that join smoothly.
pub(crate) fn patches(c: &mut Context, aspect: f64, turn: Turn) {
    c.enable(gl::DEPTH_TEST);
    c.enable(gl::LIGHTING);
    c.enable(gl::LIGHT0);
    c.enable(gl::AUTO_NORMAL);
    c.enable(gl::NORMALIZE);
    c.enable(gl::MAP2_VERTEX_3);
    c.light_model(gl::LIGHT_MODEL_TWO_SIDE, &[1.0]);
    // The quadrilaterals of a mesh run clockwise as seen from where the normals point.
    c.front_face(gl::CW);
    central(c, aspect, [3.4, -4.6, 3.6], [0.0, 0.0, 0.55], turn);
    c.light(gl::LIGHT0, gl::POSITION, &[2.0, -4.0, 6.0, 1.0]);
    c.material(gl::FRONT_AND_BACK, gl::SPECULAR, &[0.7, 0.7, 0.7, 1.0]);
    c.material(gl::FRONT_AND_BACK, gl::SHININESS, &[60.0]);
    c.map_grid2([16, 16], [0.0, 1.0], [0.0, 1.0]);
    // A quarter of a turn with its tangents, 4/3 (sqrt 2 - 1) long; a profile from the foot to the rim.
    let k = 4.0 / 3.0 * (std::f64::consts::SQRT_2 - 1.0);
    let quarter = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]];
    let profile = [[0.35, 0.0], [1.3, 0.05], [1.7, 0.6], [1.75, 1.3]];
    for (turn, color) in
        [[0.85f32, 0.5, 0.25], [0.3, 0.6, 0.8], [0.8, 0.75, 0.3], [0.5, 0.75, 0.45]].iter().enumerate()
    {
        let points: Vec<f32> = profile
            .iter()
            .flat_map(|[r, z]| quarter.map(|[x, y]| [r * x, r * y, *z]))
            .flatten()
            .map(|v| v as f32)
            .collect();
        let [r, g, b] = *color;
        c.material(gl::FRONT_AND_BACK, gl::AMBIENT_AND_DIFFUSE, &[r, g, b, 1.0]);
        c.push_matrix();
        c.rotate(90.0 * turn as f64, [0.0, 0.0, 1.0]);
        c.map2(gl::MAP2_VERTEX_3, [0.0, 1.0], [0.0, 1.0], [3, 12], [4, 4], &points);
        c.eval_mesh2(gl::FILL, [0, 16], [0, 16]);
        c.pop_matrix();
    }
}
