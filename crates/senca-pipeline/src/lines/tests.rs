use senca_math::glam::{DMat4, DVec3};
use senca_math::{Image, View};
use senca_scene::{Geometry, Node, Scene, Shape, Transform};

use super::*;
use crate::render;

const SIZE: u32 = 200;

fn camera(eye: DVec3) -> View {
    let world_from_camera = View::look_at(eye, DVec3::ZERO, DVec3::Y).expect("regular");
    View::perspective(&world_from_camera, 0.7, 1.0, 0.5, Some(50.0)).expect("regular")
}

fn cube() -> Scene {
    Scene::of_shape("cube", Shape::Box { size: DVec3::splat(2.0) })
}

fn line_settings(shading: Shading) -> Settings {
    Settings { shading, ..Settings::default() }
}

fn length(s: &Segment) -> f64 {
    (s.ends[0][0] - s.ends[1][0]).hypot(s.ends[0][1] - s.ends[1][1])
}

fn hidden(scene: &Scene, view: &View) -> Vec<Segment> {
    hidden_line_segments(scene, view, &line_settings(Shading::HiddenLine), SIZE, SIZE).expect("draws")
}

#[test]
fn a_cube_has_twelve_edges_and_shows_nine() {
    let view = camera(DVec3::new(4.0, 3.0, 5.0));
    let all = wire_segments(&cube(), &view, &line_settings(Shading::Wire), SIZE, SIZE).expect("draws");
    assert_eq!(all.len(), 12);
    let seen = hidden(&cube(), &view);
    assert_eq!(seen.len(), 9);
    for s in &seen {
        assert!(all.iter().any(|a| (length(a) - length(s)).abs() < 1e-3), "a visible edge is whole: {s:?}");
    }
}

#[test]
fn a_cube_in_parallel_view_shows_nine_edges_too() {
    let world_from_camera = View::look_at(DVec3::new(4.0, 3.0, 5.0), DVec3::ZERO, DVec3::Y).expect("regular");
    let view = View::orthographic(&world_from_camera, 5.0, 1.0, 0.5, 50.0).expect("regular");
    assert_eq!(hidden(&cube(), &view).len(), 9);
}

#[test]
fn a_triangulated_cube_shows_no_diagonals() {
    let settings = senca_scene::TessellationSettings::default();
    let shape = Shape::Box { size: DVec3::splat(2.0) };
    let mesh = senca_scene::tessellate(&shape, &settings).expect("a box").into_owned();
    assert_eq!(mesh.faces.len(), 12);
    let scene = Scene::of_shape("cube", Shape::Mesh(mesh));
    assert_eq!(hidden(&scene, &camera(DVec3::new(4.0, 3.0, 5.0))).len(), 9);
}

#[test]
fn an_edge_that_passes_behind_is_cut_where_it_disappears() {
    let mut scene = cube();
    // A long thin bar behind the cube, wider than it on both sides.
    let bar = scene.add_geometry(Geometry {
        name: String::new(),
        shape: Shape::Box { size: DVec3::new(10.0, 0.2, 0.2) },
        material: None,
    });
    let behind = Transform::Matrix(DMat4::from_translation(DVec3::new(0.0, 0.0, -3.0)));
    let node = scene.add_node(Node { geometry: Some(bar), transform: behind, ..Node::default() });
    scene.roots.push(node);
    let world_from_camera = View::look_at(DVec3::new(0.0, 0.0, 8.0), DVec3::ZERO, DVec3::Y).expect("regular");
    let view = View::orthographic(&world_from_camera, 20.0, 1.0, 0.5, 50.0).expect("regular");
    let lines = hidden(&scene, &view);
    // 10 pixels per unit: the cube covers 90..110, the bar runs from 50 to 150.
    let cut: Vec<_> = lines.iter().filter(|s| length(s) > 39.0 && length(s) < 41.0).collect();
    assert!(cut.len() >= 4, "two edges in two parts each: {lines:#?}");
    for s in cut {
        let mut x = s.ends.map(|e| e[0]);
        x.sort_by(f64::total_cmp);
        assert!(
            (x[0] - 50.0).abs() < 1e-3 && (x[1] - 90.0).abs() < 1e-3
                || (x[0] - 110.0).abs() < 1e-3 && (x[1] - 150.0).abs() < 1e-3,
            "{x:?}"
        );
    }
}

#[test]
fn faces_that_pierce_each_other_cut_their_edges() {
    // A horizontal square through the middle of the cube sticks out on all sides.
    let mut scene = cube();
    let square = scene.add_geometry(Geometry {
        name: String::new(),
        shape: Shape::Plane { size: Some(4.0) },
        material: None,
    });
    let node = scene.add_node(Node { geometry: Some(square), ..Node::default() });
    scene.roots.push(node);
    let lines = hidden(&scene, &camera(DVec3::new(4.0, 3.0, 5.0)));
    // The vertical edges of the cube are hidden below the square; three of them show above it, none
    // is drawn whole.
    let upright = |s: &&Segment| (s.ends[0][0] - s.ends[1][0]).abs() < 0.2 * length(s);
    let all =
        wire_segments(&cube(), &camera(DVec3::new(4.0, 3.0, 5.0)), &line_settings(Shading::Wire), SIZE, SIZE);
    let whole = all.expect("draws").iter().filter(upright).map(length).fold(f64::INFINITY, f64::min);
    let pieces: Vec<f64> = lines.iter().filter(upright).map(length).collect();
    assert!(pieces.iter().filter(|&&l| l < 0.75 * whole).count() >= 3, "{pieces:?} of {whole}");
    assert!(pieces.iter().all(|&l| l < 0.9 * whole), "{pieces:?} of {whole}");
}

#[test]
fn normals_are_a_thirtieth_of_the_window() {
    let world_from_camera = View::look_at(DVec3::new(0.0, 0.0, 8.0), DVec3::ZERO, DVec3::Y).expect("regular");
    let view = View::orthographic(&world_from_camera, 6.0, 1.0, 0.5, 50.0).expect("regular");
    let settings = line_settings(Shading::WireNormals);
    let lines = wire_segments(&cube(), &view, &settings, 300, 300).expect("draws");
    let normals: Vec<_> = lines.iter().filter(|s| s.kind == SegmentKind::Normal).collect();
    // Of 24 normals, three at each corner, the 8 along the line of sight have no length.
    assert_eq!(normals.iter().filter(|s| (length(s) - 10.0).abs() < 1e-6).count(), 16);
    let own =
        Settings { wire: crate::WireSettings { normal_length: Some(1.2), ..settings.wire }, ..settings };
    let lines = wire_segments(&cube(), &view, &own, 300, 300).expect("draws");
    assert!(lines.iter().any(|s| s.kind == SegmentKind::Normal && (length(s) - 60.0).abs() < 1e-6));
}

#[test]
fn culling_leaves_edges_of_fronts() {
    let view = camera(DVec3::new(4.0, 3.0, 5.0));
    let settings = Settings { cull: Culling::Always, ..line_settings(Shading::Wire) };
    assert_eq!(wire_segments(&cube(), &view, &settings, SIZE, SIZE).expect("draws").len(), 9);
}

#[test]
fn lines_end_at_the_near_plane() {
    let view = camera(DVec3::new(0.3, 0.2, 1.2));
    for s in wire_segments(&cube(), &view, &line_settings(Shading::Wire), SIZE, SIZE).expect("draws") {
        assert!(s.ends.iter().flatten().all(|v| v.is_finite() && v.abs() < 1e4), "{s:?}");
        assert!(s.depths.iter().all(|&d| (-1e-9..=1.0 + 1e-9).contains(&d)), "{s:?}");
    }
    assert!(hidden(&cube(), &view).len() < 12);
}

#[test]
fn a_drawing_is_black_on_white() {
    let mut image = Image::new(SIZE, SIZE, [0.0; 4]);
    let view = camera(DVec3::new(4.0, 3.0, 5.0));
    let report = render(&cube(), &view, &line_settings(Shading::HiddenLine), &mut image).expect("draws");
    assert_eq!(report.lines_drawn, 9);
    let dark = image.pixels().iter().filter(|p| p[0] < 0.5).count();
    assert!((300..900).contains(&dark), "{dark} dark pixels");
    assert_eq!(image.pixel(0, 0), [1.0; 4]);
}

#[test]
fn an_empty_picture_is_an_error() {
    let view = camera(DVec3::new(4.0, 3.0, 5.0));
    let error = wire_segments(&cube(), &view, &line_settings(Shading::Wire), 0, 5).expect_err("no pixels");
    assert_eq!(error, RenderError::EmptyImage { width: 0, height: 5 });
}
