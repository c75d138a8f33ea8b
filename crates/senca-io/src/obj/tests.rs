use super::*;
use crate::NoFiles;
use senca_scene::math::glam::{Vec2, Vec3};
use senca_scene::{Mesh, Shape};

fn meshes(text: &str) -> Vec<Mesh> {
    let scene = read("t.obj", text.as_bytes(), &NoFiles).expect(text);
    let mesh = |g: senca_scene::Geometry| match g.shape {
        Shape::Mesh(mesh) => mesh,
        other => panic!("not a mesh: {other:?}"),
    };
    scene.geometries.into_iter().map(mesh).collect()
}

fn mesh(text: &str) -> Mesh {
    let mut all = meshes(text);
    assert_eq!(all.len(), 1);
    all.remove(0)
}

fn error(text: &str) -> String {
    read("t.obj", text.as_bytes(), &NoFiles).expect_err(text).to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn all_forms_of_references_are_read() {
    let attributes = "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 2\n";
    let mesh = mesh(&format!(
        "{SQUARE}{attributes}f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//1 3//1\nf 1/1/1 2/2/1 -2/-1/-1\n"
    ));
    assert_eq!(mesh.faces.len(), 4);
    assert_eq!(mesh.vertices.point.len(), 12);
    assert_eq!(mesh.vertices.normal[9], Vec3::Z);
    assert_eq!(
        mesh.vertices.texcoord0[3..6],
        [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)]
    );
    let last: Vec<u32> = mesh.faces.corners_of(3).iter().map(|&v| mesh.vertices.point[v as usize]).collect();
    assert_eq!(last, [0, 1, 2]);
}

#[test]
fn faces_without_attributes_keep_their_points_as_vertices() {
    let mesh = mesh(&format!("{SQUARE}f 1 2 3\nf -4 -2 -1\n"));
    assert_eq!(mesh.vertices.point, [0, 1, 2, 3]);
    assert_eq!(mesh.faces.corners, [0, 1, 2, 0, 2, 3]);
    assert!(mesh.faces.starts.is_empty() && mesh.vertices.normal.is_empty());
    assert_eq!(mesh.surfaces.len(), 1);
}

#[test]
fn polygons_stay_polygons() {
    let mesh = mesh(&format!("{SQUARE}f 1 2 3\nf 1 2 3 4\nf 2 3 4\n"));
    assert_eq!(mesh.faces.starts, [0, 3, 7, 10]);
    assert_eq!(mesh.faces.corners_of(1), [0, 1, 2, 3]);
}

#[test]
fn continued_lines_comments_and_any_line_end_are_understood() {
    let text = "# head\r\nv 0 0 \\\r\n 0 # origin\rv 1 0 0\n\tv\t1 1 0\n\n  v 0 1 0\nf 1 2 \\\n3 \\\n4#end";
    let mesh = mesh(text);
    assert_eq!(mesh.points[2], Vec3::new(1.0, 1.0, 0.0));
    assert_eq!(mesh.faces.corners_of(0), [0, 1, 2, 3]);
}

#[test]
fn objects_become_geometries_with_their_own_points() {
    let scene = read(
        "a/t.obj",
        format!("{SQUARE}o one\nf 2 3 4\no two\nf 1 2 3\no empty\no one\nf 3 4 2\n").as_bytes(),
        &NoFiles,
    )
    .expect("reads");
    let names: Vec<&str> = scene.geometries.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["one", "two"]);
    let Shape::Mesh(one) = &scene.geometries[0].shape else { panic!("not a mesh") };
    assert_eq!((one.points.len(), one.faces.len()), (3, 2));
    assert_eq!(
        one.faces.corners.iter().map(|&v| one.position(v).x).collect::<Vec<_>>(),
        [1.0, 1.0, 0.0, 1.0, 0.0, 1.0]
    );
    assert_eq!((scene.name.as_str(), scene.roots.len()), ("t", 2));
}

#[test]
fn points_repeated_along_a_seam_are_one_unless_normals_are_given() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 2 0 0.1\nv 2 1 0.1\nv 1 1 0\n";
    let seam = mesh(&format!("{square}f 1 2 3 4\nf 5 6 7 8\n"));
    assert_eq!((seam.points.len(), seam.vertices.point.len()), (6, 6));
    assert_eq!(seam.faces.corners_of(1), [1, 4, 5, 2]);
    let given = mesh(&format!("{square}vn 0 0 1\nf 1//1 2//1 3//1 4//1\nf 5//1 6//1 7//1 8//1\n"));
    assert_eq!(given.points.len(), 8);
}

#[test]
fn smoothing_groups_make_creases_and_materials_do_not() {
    let crease = mesh(&format!("{SQUARE}s 1\nf 1 2 3\ns 2\nf 1 3 4\n"));
    assert_eq!(crease.vertices.point.len(), 6);
    assert_eq!(crease.faces.surface, [0, 1]);
    let smooth = mesh(&format!("{SQUARE}s 1\ng a\nf 1 2 3\ng b\nf 1 3 4\ng a\nf 1 2 4\n"));
    assert_eq!(smooth.vertices.point.len(), 4);
    assert_eq!((smooth.surfaces.len(), smooth.surfaces[0].name.as_str()), (1, ""));
    let groups = mesh(&format!("{SQUARE}g a\ns 1\nf 1 2 3\ng b\ns 2\nf 1 3 4\n"));
    assert_eq!(groups.surfaces.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
    let flat = mesh(&format!("{SQUARE}s off\nf 1 2 3\n"));
    assert!(!flat.surfaces[0].smooth);
}

#[test]
fn lines_and_dots_are_read_and_bare_points_are_dots() {
    let mesh1 = mesh(&format!("{SQUARE}l 1 2 3\np 4 -1\n"));
    assert_eq!(mesh1.lines, [[0, 1], [1, 2]]);
    assert_eq!(mesh1.dots, [3, 3]);
    assert_eq!(mesh(SQUARE).dots, [0, 1, 2, 3]);
}

#[test]
fn colors_behind_positions_are_decoded() {
    let mesh = mesh("v 0 0 0 1 0 0.5\nv 1 0 0 0 0 0\nv 0 1 0\nf 1 2 3\n");
    let red = mesh.vertices.color[0];
    assert_eq!((red.x, red.y, red.w), (1.0, 0.0, 1.0));
    assert!((red.z - 0.214_041_14).abs() < 1e-6, "{red}");
    assert_eq!(mesh.vertices.color[2].to_array(), [1.0; 4]);
    let bytes = self::mesh("v 0 0 0 255 0 0\nv 1 0 0 0 51 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(bytes.vertices.color[0].x, 1.0);
}

#[test]
fn a_weight_behind_a_position_is_no_color() {
    let mesh = mesh("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 0.5\nf 1 2 3\n");
    assert!(mesh.vertices.color.is_empty());
}

#[test]
fn partly_missing_normals_come_from_the_faces() {
    let mesh = mesh(&format!("{SQUARE}vn 1 0 0\nvn 0 0 0\nf 1//1 2//2 3\n"));
    assert_eq!(mesh.vertices.normal, [Vec3::X, Vec3::Z, Vec3::Z]);
    let without = self::mesh(&format!("{SQUARE}vn 0 0 0\nf 1//1 2//1 3//1\n"));
    assert!(without.vertices.normal.is_empty());
}

#[test]
fn malformed_files_are_refused_where_they_err() {
    for (text, expected) in [
        ("v 1 2\n", "t.obj:1:6: expected z of a position, found the end of the line"),
        ("\n v 1 nan 3", "t.obj:2:6: expected y of a position, found \"nan\""),
        ("v 1 2 inf", "t.obj:1:7: expected z of a position, found \"inf\""),
        ("v 1 1e99 3", "t.obj:1:5: the number \"1e99\" is too large"),
        ("v 1 2 3x", "t.obj:1:7: expected z of a position, found \"3x\""),
        ("v 1 2 3 x", "t.obj:1:9: expected the end of the line, found \"x\""),
        ("v 1 2 3\nf 1 2 1", "t.obj:2:5: vertex 2 is out of range: there are 1"),
        ("v 1 2 3\nf 1 -2 1", "t.obj:2:5: vertex -2 is out of range: there are 1"),
        ("v 1 2 3\nf 1 1 0", "t.obj:2:7: vertex 0: indices count from 1, or from -1 backwards"),
        ("v 1 2 3\nf 1/1 1 1", "t.obj:2:5: texture coordinate 1 is out of range: there is none"),
        ("v 1 2 3\nf 1//9 1 1", "t.obj:2:6: normal 9 is out of range: there is none"),
        (
            "v 1 2 3\nf 1 1 99999999999999999999",
            "t.obj:2:7: vertex 1000000000000000000 is out of range: there are 1",
        ),
        ("v 1 2 3\nf 1 1 1.5", "t.obj:2:8: expected a blank after a corner, found \".5\""),
        ("v 1 2 3\nf 1 b", "t.obj:2:5: expected the end of the line, found \"b\""),
        ("vt", "t.obj:1:3: expected u of a texture coordinate, found the end of the file"),
        ("vn 1 2", "t.obj:1:7: expected z of a normal, found the end of the file"),
        ("s many", "t.obj:1:3: expected the number of a smoothing group or \"off\", found \"many\""),
        ("", "t.obj:1:1: no statement of an OBJ file is here"),
        ("hello world", "t.obj:1:1: no statement of an OBJ file is here"),
    ] {
        assert_eq!(error(text), expected);
    }
}

#[test]
fn faces_may_come_before_their_points() {
    let mesh = mesh(&format!("f 1 2 3\n{SQUARE}"));
    assert_eq!(mesh.faces.corners, [0, 1, 2]);
    assert_eq!(
        error("f 1 2 7\nf 9 1 1\nv 0 0 0\nv 0 0 0\n"),
        "t.obj:1:7: vertex 7 is out of range: there are 2"
    );
}

#[test]
fn oddities_are_warned_of_once() {
    let text = format!("{SQUARE}f 1 2\nf 1\nwhat 1\nwhat 2\nf 1 2 3\nmtllib no.mtl\nusemtl a\nf 2 3 4\n");
    let scene = read("t.obj", text.as_bytes(), &NoFiles).expect("reads");
    let warnings: Vec<&str> = scene.warnings.iter().map(|w| w.0.as_str()).collect();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert_eq!(warnings[0], "t.obj:5:3: a face needs at least three corners; left out");
    assert_eq!(warnings[1], "t.obj:7:1: the statement \"what\" is not known");
    assert!(warnings[2].contains("no.mtl"), "{warnings:?}");
    assert_eq!(scene.materials[0].name, "a");
}

#[test]
fn many_vertices_of_one_point_are_told_apart_quickly() {
    let mut text = SQUARE.to_owned();
    let count = 20_000;
    (0..count).for_each(|i| text.push_str(&format!("vt {i} 0\n")));
    (1..=count).for_each(|i| text.push_str(&format!("f 1/{i} 2/1 3/1\n")));
    (1..=count).for_each(|i| text.push_str(&format!("f 1/{i} 2/1 3/1\n")));
    let mesh = mesh(&text);
    assert_eq!(mesh.vertices.point.len(), count + 2);
    assert_eq!(mesh.faces.corners[..3 * count], mesh.faces.corners[3 * count..]);
}

/// A grid of `columns` by `rows` control points over the unit square.
fn grid(columns: usize, rows: usize) -> String {
    let place = |i: usize| format!("v {} {} 0 1\n", i % columns, i / columns);
    (0..columns * rows).map(place).collect()
}

fn list(count: usize) -> String {
    (1..=count).map(|i| format!(" {i}")).collect()
}

#[test]
fn bicubic_bezier_surfaces_become_patches() {
    let control = list(28);
    let text = format!(
        "{}cstype bezier\ndeg 3 3\nsurf 0 2 0 1{control}\nparm u 0 1 2\nparm v 0 1\nend\n",
        grid(7, 4)
    );
    let scene = read("t.obj", text.as_bytes(), &NoFiles).expect("reads");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let Shape::BezierPatches { patches } = &scene.geometries[0].shape else { panic!("not patches") };
    assert_eq!((scene.geometries.len(), patches.len()), (1, 2));
    let place = |p: usize, i: usize| (patches[p].points[i].x, patches[p].points[i].y);
    assert_eq!(
        (place(0, 0), place(0, 3), place(1, 0), place(1, 7)),
        ((0.0, 0.0), (3.0, 0.0), (3.0, 0.0), (6.0, 1.0))
    );
}

#[test]
fn splines_become_nurbs() {
    let text = format!(
        "{}v 3 2 0 0.5\ncstype rat bspline\ndeg 2 1\nsurf 0 2 0 1{} \\\n -1\nparm u 0 0 0 1 2 2 2\nparm v 0 0 1 1\nend\n",
        grid(4, 2).trim_end_matches("v 3 1 0 1\n"),
        list(7),
    );
    let scene = read("t.obj", text.as_bytes(), &NoFiles).expect("reads");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let Shape::Nurbs(surface) = &scene.geometries[0].shape else { panic!("not NURBS") };
    assert_eq!((surface.degree, surface.counts, surface.points.len()), ([2, 1], [4, 2], 8));
    assert_eq!((surface.knots[0].len(), surface.weights[7], surface.weights[0]), (7, 0.5, 1.0));
    let text = format!(
        "{}cstype bezier\ndeg 2 1\nsurf 0 2 0 1{}\nparm u 0 1 2\nparm v 0 1\nend\n",
        grid(5, 2),
        list(10)
    );
    let scene = read("t.obj", text.as_bytes(), &NoFiles).expect("reads");
    let Shape::Nurbs(surface) = &scene.geometries[0].shape else { panic!("not NURBS") };
    assert_eq!(surface.knots[0], [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
}

#[test]
fn malformed_surfaces_are_refused_where_they_stand() {
    let of = |basis: &str, parameters: &str| {
        let text =
            format!("{}cstype {basis}\ndeg 3 3\nsurf 0 1 0 1{}\n{parameters}\nend\n", grid(4, 4), list(16));
        read("t.obj", text.as_bytes(), &NoFiles)
    };
    let refused = |parameters: &str| of("bezier", parameters).expect_err(parameters).to_string();
    assert_eq!(refused("parm u 0 1"), "t.obj:19:1: at least 2 parameters in v are needed, found 0");
    assert_eq!(refused("parm u 0 1 2\nparm v 0 1"), "t.obj:19:1: expected 7 x 4 control points, found 16");
    assert_eq!(refused("parm u 1 0\nparm v 0 1"), "t.obj:19:1: the parameters in u must not decrease");
    assert_eq!(refused("parm w 1 0"), "t.obj:20:6: expected the direction \"u\" or \"v\", found \"w\"");
    let other = of("cardinal", "parm u 0 1\nparm v 0 1").expect("left out");
    assert_eq!(
        other.warnings[0].0,
        "t.obj:19:1: a surface in another basis than Bézier and B-spline is left out"
    );
    let cut = of("bezier", "parm u 0 2\nparm v 0 1").expect("whole");
    assert!(cut.warnings[0].0.contains("whole parameter range"), "{:?}", cut.warnings);
}
