use senca_window::{Canvas, Program, Script};

use super::*;
use crate::lab::draw;
use crate::lab::fractal::{Coloring, Picture, View};
use crate::lab::line::bresenham;
use crate::lab::polygon::Position;
use crate::lab::shading::{Camera, Light, Mode};
use crate::lab::solid::tests::cube;
use crate::lab::view::ViewMethod;

fn replay(program: &mut dyn Program, text: &str) -> Canvas {
    let script = Script::parse("script", text).expect("a script");
    script.run(program, |_, _| Ok::<_, std::convert::Infallible>(())).expect("nothing is saved")
}

fn count(canvas: &Canvas, color: u32) -> usize {
    canvas.pixels().iter().filter(|&&p| p == color).count()
}

#[test]
fn two_clicks_make_a_line() {
    let mut program = LineProgram::new();
    assert_eq!(program.title(), "Click the start of a line");
    let canvas = replay(&mut program, "click 10 20\nclick 90 60\n");
    assert_eq!(program.lines(), [[[10, 20], [90, 60]]]);
    assert!(bresenham([10, 20], [90, 60]).iter().all(|&[x, y]| canvas.get(x, y) == Some(draw::BLACK)));
    assert_eq!((count(&canvas, draw::BLACK), count(&canvas, draw::BLUE)), (81, 81));
    assert_eq!(canvas.get(90, 80), Some(draw::BLUE));
    assert!(program.title().starts_with("(10, 20) to (90, 60)"));
    let canvas = replay(&mut program, "key backspace\nclick 5 5");
    assert_eq!((count(&canvas, draw::BLACK), count(&canvas, draw::RED)), (0, 1));
}

#[test]
fn small_lines_are_magnified() {
    let mut program = LineProgram::with_line([[0, 0], [-8, -3]]);
    let canvas = replay(&mut program, "");
    assert_eq!(count(&canvas, draw::BLACK) % 9, 0);
    assert!(count(&canvas, draw::BLACK) > 9 * 64);
}

#[test]
fn a_polygon_is_clicked_and_tested() {
    let mut program = PolygonProgram::new();
    // Counter-clockwise as seen: it is turned round.
    let text = "click 100 350\nclick 300 250\nclick 150 50\nclick 50 200\nkey enter\nclick 150 200\n";
    let canvas = replay(&mut program, text);
    let polygon = program.polygon().expect("closed");
    assert_eq!(polygon.position([150.0, 199.0]), Position::Inside);
    assert!(program.title().ends_with("is inside the polygon"), "{}", program.title());
    assert_eq!(canvas.get(150, 204), Some(draw::YELLOW));
    let canvas = replay(&mut program, "click 10 10\nkey space\n");
    assert!(program.title().ends_with("is outside the polygon"));
    assert_eq!((canvas.get(150, 204), canvas.get(10, 10)), (Some(draw::WHITE), Some(draw::RED)));
    replay(&mut program, "drag 300 250 310 260\n");
    assert!(program.polygon().expect("closed").vertices().contains(&[310.0, 139.0]));
    replay(&mut program, "key n\nclick 0 0\nclick 9 9\nkey enter\n");
    assert!(program.title().starts_with("a polygon has at least 3 vertices"));
}

#[test]
fn the_polygon_of_the_manual_fills_its_pixels() {
    let vertices = vec![[50.0, 200.0], [150.0, 350.0], [300.0, 150.0], [100.0, 50.0]];
    let mut program = PolygonProgram::with_polygon(vertices, vec![[150.0, 200.0]]).expect("convex");
    assert_eq!(program.title(), "V (150, 200) is inside the polygon");
    let canvas = replay(&mut program, "");
    let filled = canvas.pixels().iter().filter(|&&p| p != draw::WHITE).count();
    assert!((38_874..39_700).contains(&filled), "{filled}");
    assert!(PolygonProgram::with_polygon(vec![[0.0; 2]; 4], vec![]).is_err());
}

#[test]
fn barycentric_coordinates_follow_the_mouse() {
    let corners = [[1.0, 0.0, 1.0], [5.0, 0.0, 2.0], [3.0, 3.0, 4.0]];
    let mut program = TriangleProgram::new(corners, [2.5, 0.75, 2.0]).expect("a triangle");
    assert_eq!(program.title(), "t = 0.500, 0.250, 0.250: in the triangle");
    replay(&mut program, "drag 200 200 200 260\n");
    assert!(program.found().in_plane && program.found().inside);
    let outside = replay(&mut program, "click 1 1");
    assert!(program.found().in_plane && !program.found().inside);
    assert!(outside.pixels().contains(&0xec_ecec));
}

#[test]
fn a_point_goes_through_a_solid() {
    let mut program = SolidProgram::new(cube(), [0.5; 3]).expect("has a size");
    assert_eq!(program.title(), "V (0.50, 0.50, 0.50) is inside the solid");
    let canvas = replay(&mut program, &"key pageup\n".repeat(11));
    assert_eq!(program.found().position, Position::Outside);
    assert!(count(&canvas, draw::RED) > 0);
    replay(&mut program, &format!("click 200 200\n{}", "key z\n".repeat(4)));
    assert_eq!(program.found().position, Position::Inside);
}

#[test]
fn the_eye_is_moved_by_keys() {
    let camera = Camera { eye: [1.0, 1.0, 3.0], ..Camera::default() };
    let mut program = ViewProgram::new(vec![], Some(cube()), camera);
    let first = replay(&mut program, "");
    let moved = replay(&mut program, "key X\nkey X\nkey y\nkey tab\nkey Z\n");
    assert_eq!((program.camera().eye, program.camera().target), ([1.5, 0.75, 3.0], [0.0, 0.0, 0.25]));
    assert!(first != moved && count(&moved, draw::BLACK) > 100);
    replay(&mut program, "key m\n");
    assert_eq!(program.camera().method, ViewMethod::Rotations);
    assert!(program.title().contains("by rotations; keys move G"));
    assert!(replay(&mut program, "key r\n") == first);
    let mut lost = ViewProgram::new(vec![], Some(cube()), Camera { eye: [0.0; 3], ..camera });
    assert_eq!(count(&replay(&mut lost, ""), draw::WHITE), 160_000);
    assert!(lost.title().contains("looks nowhere"));
}

#[test]
fn the_eye_goes_along_the_curve() {
    let path = vec![[1.0, 1.0, 3.0], [3.0, 1.0, 1.0], [1.0, 3.0, -1.0], [-3.0, 2.0, 0.0], [-1.0, 1.0, 4.0]];
    let mut program = CurveProgram::new(path.clone(), &cube(), [0.0, 1.0, 0.0], 0.0).expect("has a size");
    assert!(program.title().contains("2 faces seen"));
    let stopped = replay(&mut program, "tick 1\n");
    assert_eq!(program.t(), 0.0);
    let moved = replay(&mut program, "key space\ntick 0.1 25\n");
    assert!((program.t() - 0.25).abs() < 1e-12 && program.animated() && stopped != moved);
    assert!(program.title().contains("6 faces seen"));
    replay(&mut program, "tick 1 20\n");
    assert!(program.t() == 1.0 && !program.animated());
    replay(&mut program, "key left\nkey left\n");
    assert!((program.t() - 0.98).abs() < 1e-12);
    replay(&mut program, "key home\n");
    assert_eq!(program.t(), 0.0);
    assert_eq!(program.points(), path);
}

#[test]
fn control_points_can_be_dragged() {
    let path = vec![[0.0; 3], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]];
    let mut program = CurveProgram::new(path, &cube(), [0.0, 1.0, 0.0], 0.5).expect("has a size");
    // The origin is in the middle of the left half.
    replay(&mut program, "drag 160 160 200 120\n");
    let moved = program.points()[0];
    assert!(moved != [0.0; 3] && moved[1] > 0.0 && moved[0] > 0.0, "{moved:?}");
    replay(&mut program, "drag 200 120 160 160\n");
    assert!(program.points()[0].iter().all(|v| v.abs() < 1e-12));
}

#[test]
fn a_solid_is_shaded_each_way() {
    let mut program =
        ShadingProgram::new(&cube(), Camera::default(), Light::default(), Mode::Wire).expect("has a size");
    let light = format!("key tab\n{}", "key X\n".repeat(8));
    let texts = ["key 1", "key 2", "key 3", "key 4", &light];
    let pictures: Vec<Canvas> = texts.iter().map(|text| replay(&mut program, text)).collect();
    for i in 1..pictures.len() {
        assert!(pictures[i] != pictures[i - 1], "{i}");
    }
    assert_eq!(program.mode(), Mode::Gouraud);
    assert!(program.title().contains("light (4.00, 4.00, 6.00)"));
}

#[test]
fn clicks_zoom() {
    let size = [60, 40];
    let picture = Picture {
        view: View::of_area([-2.0, 1.0], [-1.0, 1.0], size),
        julia: None,
        bound: 100.0,
        iterations: 50,
        size,
    };
    let mut program = FractalProgram::new(picture, Coloring::default());
    let first = replay(&mut program, "");
    assert!(count(&first, 0) > 100);
    let closer = replay(&mut program, "click 20 20\nclick 20 20\n");
    assert!((program.picture().view.width.to_f64() - 0.75).abs() < 1e-12 && closer != first);
    replay(&mut program, "click right 20 20\nclick right 20 20\nkey +\nkey s\n");
    assert_eq!(program.picture().iterations, 100);
    assert!((program.picture().view.width.to_f64() - 3.0).abs() < 1e-12);
    replay(&mut program, "move 30 5\nkey j\n");
    assert!(program.title().starts_with("Julia set of -0.500000 -0.75"), "{}", program.title());
    assert!(replay(&mut program, "key r\nkey s\n") == first);
    replay(&mut program, "wheel 8\n".repeat(20).as_str());
    assert!(program.picture().is_deep());
    assert!(program.title().contains("e-2"), "{}", program.title());
}
