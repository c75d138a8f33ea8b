//! The sample programs and worked examples of the course text, chapter 5, against the positions they have.

#[path = "../../examples/opengl/samples.rs"]
mod programs;

use super::context;
use crate::{Context, gl};
use senca_math::glam::Vec4;

/// A window with what a sample program draws.
fn drawn([width, height]: [u32; 2], program: impl Fn(&mut Context, f64)) -> Context {
    let mut c = context(width, height);
    c.viewport(0, 0, width as i32, height as i32);
    c.clear_color([0.0, 0.0, 0.0, 1.0]);
    c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
    program(&mut c, f64::from(width) / f64::from(height));
    c.finish();
    c
}

#[test]
fn the_first_program_draws_two_segments() {
    for (size, centre) in
        [([300u32, 300u32], [150usize, 150usize]), ([600, 300], [300, 150]), ([300, 600], [150, 300])]
    {
        let c = drawn(size, programs::first);
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

/// Section 5.9, the Bézier curve: the mesh and the single coordinates give the same picture, at the places computed.
#[test]
fn the_curve_passes_its_points_either_way() {
    let one = drawn([400, 400], programs::curve);
    // The same maps, matrices and colour; what is drawn already is cleared.
    let mut mesh = drawn([400, 400], programs::curve);
    mesh.clear(gl::COLOR_BUFFER_BIT);
    mesh.map_grid1(30, [0.0, 1.0]);
    mesh.eval_mesh1(gl::LINE, 0, 30);
    mesh.finish();
    let differing = one.window_pixels().iter().zip(mesh.window_pixels()).filter(|(a, b)| a != b).count();
    assert!(differing < 8, "{differing} pixels differ");
    let lit = |x: usize, y: usize| {
        let near = |x: usize, y: usize| one.window_pixels()[y * 400 + x] != [0, 0, 0, 255];
        (x - 1..=x + 1).any(|x| (y - 1..=y + 1).any(|y| near(x, y)))
    };
    for [x, y] in [[40, 40], [140, 194], [200, 200], [259, 205], [359, 359]] {
        assert!(lit(x, y), "{x} {y}");
    }
}

/// Section 5.9, the Bézier surface.
#[test]
fn the_surface_is_grey_lit_and_where_it_should_be() {
    let c = drawn([400, 400], programs::surface);
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
    let mesh = drawn([400, 400], programs::surface);
    let mut strips = drawn([400, 400], programs::surface);
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

/// Section 5.8: squares of equal width on the quadrilateral that faces the eye, and on the other one narrower
/// and narrower, as perspective has it: evenly spaced they would change every 8.82 pixels.
#[test]
fn the_chessboards_change_where_perspective_says() {
    let c = drawn([400, 400], programs::texture);
    let pixels = c.window_pixels();
    assert!(pixels.iter().all(|p| *p == [0, 0, 0, 255] || *p == [255; 4]));
    let row = &pixels[206 * 400..207 * 400];
    let changes: Vec<f64> = (1..400).filter(|x| row[*x] != row[x - 1]).map(|x| x as f64).collect();
    let near: Vec<f64> = (0..9).map(|k| 7.55 + 24.056 * f64::from(k)).collect();
    let turned = [296.23, 307.94, 318.60, 328.35, 337.30, 345.54, 353.16, 360.22, 366.79];
    // The outermost squares of a row are black at one end, like the background.
    let expected: Vec<f64> = near.into_iter().chain(turned).collect();
    assert!(changes.iter().all(|x| expected.iter().any(|e| (x - e).abs() <= 1.0)), "{changes:?}");
    assert_eq!(changes.len(), 16);
    assert_eq!(pixels[105 * 400 + 9], [0, 0, 0, 255], "black in the lower left corner");
}
