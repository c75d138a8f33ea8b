//! The sample programs and worked examples of the course text, chapter 5, against the positions they have.

use super::context;
use crate::{Context, gl};
use senca_math::glam::Vec4;

/// The text's way to keep the scale alike on both axes: at least [-half, half] on each.
fn ortho_about(c: &mut Context, [width, height]: [u32; 2], half: f64, near: f64, far: f64) {
    let (w, h) = (f64::from(width), f64::from(height));
    let [x, y] = if w <= h { [half, half * h / w] } else { [half * w / h, half] };
    c.viewport(0, 0, width as i32, height as i32);
    c.matrix_mode(gl::PROJECTION);
    c.load_identity();
    c.ortho(-x, x, -y, y, near, far);
    c.matrix_mode(gl::MODELVIEW);
    c.load_identity();
}

/// Section 5.4: a green segment to the left, a magenta one to the upper right.
fn first_program(size: [u32; 2]) -> Context {
    let mut c = context(size[0], size[1]);
    ortho_about(&mut c, size, 10.0, -1.0, 1.0);
    c.clear_color([0.0, 0.0, 0.0, 1.0]);
    c.clear(gl::COLOR_BUFFER_BIT);
    c.begin(gl::LINES);
    c.color([0.0f32, 1.0, 0.0]);
    c.vertex([0.0f32, 0.0, 0.0]);
    c.vertex([-9.0f32, 0.0, 0.0]);
    c.color([1.0f32, 0.0, 1.0]);
    c.vertex([0.0f32, 0.0, 0.0]);
    c.vertex([9.0f32, 9.0, 0.0]);
    c.end();
    c.flush();
    c
}

#[test]
fn the_first_program_draws_two_segments() {
    for (size, centre) in
        [([300u32, 300u32], [150usize, 150usize]), ([600, 300], [300, 150]), ([300, 600], [150, 300])]
    {
        let c = first_program(size);
        let at = |x: usize, y: usize| c.window_pixels()[y * size[0] as usize + x];
        let (green, magenta, black) = ([0, 255, 0, 255], [255, 0, 255, 255], [0, 0, 0, 255]);
        let [x, y] = centre;
        // The scene has 15 pixels a unit; a segment along a row of corners may be in the row above or below.
        let row = |x: usize| [at(x, y), at(x, y - 1)];
        assert!(row(x - 2).contains(&green) && row(x - 130).contains(&green), "{size:?}");
        assert_eq!(row(x - 137), [black; 2]);
        assert_eq!([at(x + 5, y + 5), at(x + 133, y + 133)], [magenta; 2]);
        assert_eq!([at(x + 137, y + 137), at(x + 20, y + 24), at(x - 20, y + 20)], [black; 3]);
        let count = |color| c.window_pixels().iter().filter(|p| **p == color).count();
        assert!((134..=136).contains(&count(green)) && (134..=136).contains(&count(magenta)));
    }
}

/// Section 5.3: what is drawn after the pop is in the first system; the origin in between is where it should be.
#[test]
fn a_stack_brings_the_system_back() {
    let mut c = context(4, 4);
    c.push_matrix();
    c.rotate(30.0, [0.0, 0.0, 1.0]);
    c.translate([3.0, 1.0, 0.0]);
    let origin = c.modelview.top() * Vec4::W;
    assert!((origin.x - 2.0981).abs() < 1e-4 && (origin.y - 2.3660).abs() < 1e-4, "{origin}");
    c.pop_matrix();
    assert_eq!(c.modelview.top() * Vec4::W, Vec4::W);
}

/// Section 5.5: letters that move on by one unit each; the list base is added to the codes of the string.
#[test]
fn a_string_is_a_row_of_lists() {
    let mut c = context(4, 4);
    let base = c.gen_lists(128);
    assert!(base > 0);
    c.new_list(base + u32::from(b'A'), gl::COMPILE);
    c.begin(gl::LINE_STRIP);
    c.vertex([0.0, 0.0]);
    c.vertex([0.4, 1.0]);
    c.vertex([0.8, 0.0]);
    c.end();
    c.begin(gl::LINES);
    c.vertex([0.133, 0.333]);
    c.vertex([0.533, 0.333]);
    c.end();
    c.translate([1.0, 0.0, 0.0]);
    c.end_list();
    c.list_base(base);
    c.call_lists_of(3, gl::BYTE, b"AAA");
    assert_eq!(c.modelview.top().w_axis.x, 3.0);
    assert_eq!(c.get_error(), gl::NO_ERROR);
}

fn curve(c: &mut Context) {
    let points = [-4.0, -4.0, 0.0, -2.0, 4.0, 0.0, 2.0, -4.0, 0.0, 4.0, 4.0, 0.0];
    ortho_about(c, [400, 400], 5.0, -1.0, 1.0);
    c.map1(gl::MAP1_VERTEX_3, [0.0, 1.0], 3, 4, &points);
    c.enable(gl::MAP1_VERTEX_3);
    c.color([1.0, 1.0, 1.0]);
}

/// Section 5.9, the Bézier curve: the mesh and the single coordinates give the same picture, at the places computed.
#[test]
fn the_curve_passes_its_points_either_way() {
    let mut one = context(400, 400);
    curve(&mut one);
    one.begin(gl::LINE_STRIP);
    (0..=30).for_each(|i| one.eval_coord1(i as f32 / 30.0));
    one.end();
    one.finish();
    let mut mesh = context(400, 400);
    curve(&mut mesh);
    mesh.map_grid1(30, [0.0, 1.0]);
    mesh.eval_mesh1(gl::LINE, 0, 30);
    mesh.finish();
    let differing = one.window_pixels().iter().zip(mesh.window_pixels()).filter(|(a, b)| a != b).count();
    assert!(differing < 8, "{differing} pixels differ");
    let lit = |x: usize, y: usize| {
        let near = |x: usize, y: usize| one.window_pixels()[y * 400 + x] != [0; 4];
        (x - 1..=x + 1).any(|x| (y - 1..=y + 1).any(|y| near(x, y)))
    };
    for [x, y] in [[40, 40], [140, 194], [200, 200], [259, 205], [359, 359]] {
        assert!(lit(x, y), "{x} {y}");
    }
}

/// Section 5.9, the Bézier surface: heights by rows of v.
const HEIGHTS: [[f32; 4]; 4] =
    [[4.0, 2.0, -1.0, 2.0], [1.0, 3.0, 0.0, -1.0], [4.0, 0.0, 3.0, 4.0], [-2.0, -2.0, 0.0, -1.0]];

fn surface() -> Context {
    let mut c = context(400, 400);
    let points: Vec<f32> =
        (0..16).flat_map(|k| [(k % 4) as f32 - 1.5, (k / 4) as f32 - 1.5, HEIGHTS[k / 4][k % 4]]).collect();
    c.clear_color([0.0, 0.0, 0.0, 1.0]);
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
    ortho_about(&mut c, [400, 400], 4.0, -4.0, 4.0);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    c.push_matrix();
    c.rotate(85.0, [1.0, 1.0, 1.0]);
    c.eval_mesh2(gl::FILL, [0, 20], [0, 20]);
    c.pop_matrix();
    c.finish();
    c
}

#[test]
fn the_surface_is_grey_lit_and_where_it_should_be() {
    let c = surface();
    let pixels = c.window_pixels();
    let background = [0, 0, 0, 255];
    let covered: Vec<usize> = (0..pixels.len()).filter(|k| pixels[*k] != background).collect();
    assert!((covered.len() as i32 - 27_100).abs() < 300, "{} pixels", covered.len());
    let xs = covered.iter().map(|k| k % 400);
    let ys = covered.iter().map(|k| k / 400);
    let near = |v: Option<usize>, expected: i32| (v.unwrap_or(0) as i32 - expected).abs() <= 1;
    assert!(near(xs.clone().min(), 62) && near(xs.max(), 366), "columns");
    assert!(near(ys.clone().min(), 51) && near(ys.max(), 308), "rows");
    assert!(covered.iter().all(|k| pixels[*k][0] == pixels[*k][1] && pixels[*k][1] == pixels[*k][2]));
    let darkest = covered.iter().map(|k| pixels[*k][0]).min().unwrap_or(0);
    assert!((i32::from(darkest) - 20).abs() <= 3, "{darkest}");
    let highlight = (143..=225).any(|y| (176..=207).any(|x| pixels[y * 400 + x][0] == 255));
    assert!(highlight);
    let centre = pixels[183 * 400 + 253][0];
    assert!((i32::from(centre) - 20).abs() <= 3, "{centre}");
}

#[test]
fn a_mesh_is_the_strips_it_stands_for() {
    let mesh = surface();
    let mut strips = surface();
    strips.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    strips.rotate(85.0, [1.0, 1.0, 1.0]);
    for j in 0..20 {
        strips.begin(gl::QUAD_STRIP);
        for i in 0..=20 {
            strips.eval_point2([i, j]);
            strips.eval_point2([i, j + 1]);
        }
        strips.end();
    }
    strips.finish();
    assert!(mesh.window_pixels() == strips.window_pixels());
}
