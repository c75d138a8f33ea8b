use senca_scene::math::glam::{DMat4, DVec3, DVec4, Vec3};
use senca_scene::{BezierPatch, Mesh, Projection, Scene, Shape};

use super::*;
use crate::{Directory, NoFiles};

const HOUSE: &[u8] = include_bytes!("../../../../samples/classic/house.dat");
const CYLINDER: &[u8] = include_bytes!("../../../../samples/classic/cylinder.dat");
const PATCH: &[u8] = include_bytes!("../../../../samples/classic/patch.bez");
const PATCH_MESH: &[u8] = include_bytes!("../../../../samples/classic/patch.dat");
const TEAPOT: &[u8] = include_bytes!("../../../../samples/classic/teapot.bez");
const TEAPOT_MESH: &[u8] = include_bytes!("../../../../samples/classic/teapot.dat");
const SCENE: &[u8] = include_bytes!("../../../../samples/classic/scene1.dat");

fn samples() -> Directory {
    Directory::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../samples/classic"))
}

fn mesh_of(scene: Scene) -> Mesh {
    match scene.geometries.into_iter().next().map(|g| g.shape) {
        Some(Shape::Mesh(mesh)) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

fn mesh(bytes: &[u8]) -> Mesh {
    let scene = read_object("t.dat", bytes, &NoFiles).expect("reads");
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    mesh_of(scene)
}

fn patches(bytes: &[u8]) -> Vec<BezierPatch> {
    match read_patches("t.bez", bytes, &NoFiles).expect("reads").geometries.remove(0).shape {
        Shape::BezierPatches { patches } => patches,
        other => panic!("not patches: {other:?}"),
    }
}

#[test]
fn the_house_has_a_surface_per_polygon() {
    let house = mesh(HOUSE);
    assert_eq!((house.points.len(), house.faces.len(), house.surfaces.len()), (17, 13, 13));
    assert_eq!(house.points[16], Vec3::new(4.0, 14.0, 54.0));
    assert_eq!(house.vertices.point.len(), house.faces.corners.len());
    let points = |face| {
        house.faces.corners_of(face).iter().map(|&v| house.vertices.point[v as usize]).collect::<Vec<_>>()
    };
    assert_eq!(points(1), [9, 8, 7, 6, 5]);
    assert_eq!(points(12), [0, 12, 11, 10]);
}

#[test]
fn the_cylinder_shares_vertices_within_its_surfaces_only() {
    let cylinder = mesh(CYLINDER);
    assert_eq!((cylinder.points.len(), cylinder.faces.len(), cylinder.surfaces.len()), (16, 10, 3));
    assert_eq!(cylinder.vertices.point.len(), 32);
    assert_eq!(cylinder.faces.corners_of(9).len(), 8);
}

#[test]
fn object_files_are_written_as_they_were_printed() {
    assert_eq!(write_object(&mesh(PATCH_MESH)).expect("writes"), PATCH_MESH);
    for sample in [HOUSE, CYLINDER] {
        let first = mesh(sample);
        assert_eq!(mesh(&write_object(&first).expect("writes")), first);
    }
}

#[test]
fn the_teapot_is_whole() {
    let teapot = patches(TEAPOT);
    assert_eq!(teapot.len(), 32);
    let per_surface: Vec<usize> = (0..5).map(|s| teapot.iter().filter(|p| p.surface == s).count()).collect();
    assert_eq!(per_surface, [12, 4, 4, 8, 4]);
    let all = || teapot.iter().flat_map(|p| p.points);
    let low = all().reduce(DVec3::min).expect("points");
    let high = all().reduce(DVec3::max).expect("points");
    assert_eq!((low, high), (DVec3::new(-3.0, -2.0, 0.0), DVec3::new(3.525, 2.0, 3.15)));
    // Point 49, which the page misprints, is the mirror image of point 79.
    assert_eq!(teapot[4].points[5], DVec3::new(1.75, -0.98, 1.875));
    assert!(all().all(|p| all().any(|q| q == DVec3::new(p.x, -p.y, p.z))));
}

#[test]
fn patches_survive_writing() {
    for sample in [PATCH, TEAPOT] {
        let first = patches(sample);
        let bytes = write_patches(&first).expect("writes");
        assert_eq!(patches(&bytes), first);
    }
    assert!(write_patches(&patches(TEAPOT)).expect("writes").starts_with(b"290 32 5\n"));
    let error =
        write_patches(&[BezierPatch { surface: 2, ..patches(PATCH).remove(0) }]).expect_err("surface 2");
    assert!(error.to_string().contains("on surface 2"), "{error}");
}

#[test]
fn patch_numbers_run_over_lines_and_remarks() {
    let text = String::from_utf8_lossy(PATCH)
        .replace(" 8 9", "\n8 {remark\n over lines} 9")
        .replace("16 1 1", "16 1\n1");
    assert_eq!(patches(text.as_bytes()), patches(PATCH));
}

#[test]
fn the_sample_scene_has_its_view_light_and_objects() {
    let classic = ClassicScene::parse("scene1.dat", SCENE).expect("reads");
    assert_eq!(classic.projection, ClassicProjection::Perspective);
    assert_eq!((classic.view_plane_distance, classic.projection_distance), (60.0, 70.0));
    assert_eq!((classic.vrp, classic.vpn, classic.vup), (DVec3::new(1.5, 2.0, 0.0), DVec3::Z, DVec3::Y));
    assert_eq!((classic.window, classic.raster_height, classic.raster_width()), ([8.0, 8.0], 150, 150));
    assert_eq!(
        (classic.operation, classic.light),
        (ClassicOperation::Phong, Some(DVec3::new(0.0, 1.0, 1.0)))
    );
    assert_eq!(classic.output.as_deref(), Some("phong.btm"));
    assert_eq!(classic.objects[0].file, "teapot.dat");
    let scene = read_scene("scene1.dat", SCENE, &samples()).expect("reads");
    assert_eq!((scene.geometries.len(), scene.lights.len(), scene.cameras.len()), (2, 1, 1));
    let world = scene.world_from_nodes();
    assert_eq!(world[0].map(|m| m.w_axis), Some(DVec4::new(1.5, 2.0, 70.0, 1.0)));
    let light_from = world[1].map(|m| m.z_axis.truncate()).expect("a light");
    assert!((light_from - DVec3::new(0.0, 1.0, 1.0).normalize()).length() < 1e-15);
    // The window's upper edge is seen at its half height.
    let Projection::Perspective { yfov, aspect, .. } = scene.cameras[0].projection else {
        panic!("not perspective")
    };
    assert!(((0.5 * yfov).tan() - 4.0 / 70.0).abs() < 1e-15 && aspect == Some(1.0));
}

#[test]
fn objects_are_turned_before_they_are_scaled() {
    let classic = ClassicScene::parse("scene1.dat", SCENE).expect("reads");
    let rows = DMat4::from_cols_array_2d(&[
        [1.599_025, -0.048_358, 0.027_92, 0.0],
        [0.0, 0.5, 0.866_025, 0.0],
        [-0.034_899, -0.865_498, 0.499_695, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]);
    assert!(classic.objects[0].world_from_object().abs_diff_eq(rows.transpose(), 1e-6));
}

#[test]
fn parallel_scenes_and_wireframes_are_read() {
    let text = String::from_utf8_lossy(SCENE).replacen("1  ", "0  ", 1).replace("\n2    ", "\n1    ");
    let text =
        text.replacen("0.0 1.0 1.0  ", "", 1).replacen("\n1                 {number", "\n2   {number", 1);
    let classic = ClassicScene::parse("t", text.as_bytes()).expect("reads");
    assert_eq!(
        (classic.projection, classic.operation),
        (ClassicProjection::Parallel, ClassicOperation::WireframeWithNormals)
    );
    assert_eq!((classic.light, classic.output.clone()), (None, None));
    let scene = classic.to_scene("t", &samples()).expect("reads");
    assert!(matches!(scene.cameras[0].projection, Projection::Orthographic { height: 8.0, .. }));
    assert!(scene.lights.is_empty());
}

/// The sample with its line `line` (from 1) replaced.
fn with_line(sample: &[u8], line: usize, new: &str) -> String {
    let text = String::from_utf8_lossy(sample);
    let replaced = text.lines().enumerate().map(|(i, old)| if i + 1 == line { new } else { old });
    replaced.collect::<Vec<_>>().join("\n")
}

#[test]
fn malformed_object_files_are_refused_where_they_err() {
    for (line, new, expected) in [
        (1, "", "house.dat:2:3: expected the number of polygons, found \"0.0\""),
        (1, "17 x 13", "house.dat:1:4: expected the number of polygons, found \"x\""),
        (1, "17 13", "house.dat:1:6: expected the number of surfaces, found the end of the line"),
        (1, "-17 13 13", "house.dat:1:1: the number of vertices must not be negative"),
        (1, "18 13 13", "house.dat:19:1: expected vertex 17, found 0"),
        (1, "17 14 13", "house.dat:31:19: expected polygon 13, found the end of the file"),
        (2, "1 0 0 54", "house.dat:2:1: expected vertex 0, found 1"),
        (3, "1 16.0 abc 54.0", "house.dat:3:8: expected y of a vertex, found \"abc\""),
        (3, "1 16.0 0.0", "house.dat:3:11: expected z of a vertex, found the end of the line"),
        (3, "1 16.0 0.0 1e50", "house.dat:3:2: the vertex is too far away for 32-bit floats"),
        (19, "0 1 5 0 1 2 3 4", "house.dat:19:3: the first polygon must be on surface 0, not 1"),
        (20, "1 2 5 9 8 7 6 5", "house.dat:20:3: expected surface 0 or 1, found 2"),
        (
            22,
            "3 1 4 2 1 6 7",
            "house.dat:22:3: returns to surface 1; the polygons of a surface must stand together",
        ),
        (20, "1 1 2 9 8", "house.dat:20:5: a polygon has at least 3 corners, not 2"),
        (20, "1 1 5 9 8 7 6", "house.dat:20:14: expected vertex, found the end of the line"),
        (20, "1 1 5 9 8 17 6 5", "house.dat:20:11: vertex 17 is out of range: there are 17"),
        (20, "1 1 5 9 8 -1 6 5", "house.dat:20:11: vertex -1 is out of range: there are 17"),
        (20, "2 1 5 9 8 7 6 5", "house.dat:20:1: expected polygon 1, found 2"),
    ] {
        let error =
            read_object("house.dat", with_line(HOUSE, line, new).as_bytes(), &NoFiles).expect_err(new);
        assert_eq!(error.to_string(), expected);
    }
    let error = read_object("e.dat", b"", &NoFiles).expect_err("empty");
    assert_eq!(error.to_string(), "e.dat:1:1: expected the number of vertices, found the end of the file");
}

#[test]
fn remarks_and_a_wrong_count_of_surfaces_are_lived_with() {
    let text = with_line(HOUSE, 1, "17 13 12 1 {house}");
    let text = with_line(text.as_bytes(), 5, "3 8.0 16.0 54.0 the ridge");
    let scene = read_object("house.dat", text.as_bytes(), &NoFiles).expect("reads");
    assert_eq!(scene.warnings[0].0, "house.dat: the header says 12 surfaces, but the polygons are on 13");
    assert_eq!(mesh_of(scene), mesh(HOUSE));
}

#[test]
fn malformed_patch_files_are_refused_where_they_err() {
    for (line, new, expected) in [
        (1, "16 1", "p.bez:6:3: expected point 4, found 0"),
        (3, "1 1 0 y", "p.bez:3:7: expected z of a point, found \"y\""),
        (4, "1 2 0 0", "p.bez:4:1: expected point 2, found 1"),
        (18, "0 0 12 0 1 2 3 4 5 6 7 8 9 10 11", "p.bez:18:5: a bicubic patch has 16 control points, not 12"),
        (
            18,
            "0 0 16 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 16",
            "p.bez:18:43: point 16 is out of range: there are 16",
        ),
        (18, "0 0 16 0 1 2", "p.bez:18:13: expected point, found the end of the file"),
        (18, "0 1 16 0 1 2", "p.bez:18:3: the first patch must be on surface 0, not 1"),
        (18, "{", "p.bez:18:1: the remark has no closing brace"),
    ] {
        let error = read_patches("p.bez", with_line(PATCH, line, new).as_bytes(), &NoFiles).expect_err(new);
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn malformed_scene_files_are_refused_where_they_err() {
    for (line, new, expected) in [
        (1, "2", "s.dat:1:1: expected the projection type, 0 (parallel) or 1 (perspective), found 2"),
        (
            1,
            "",
            "s.dat:1:1: expected the projection type, 0 (parallel) or 1 (perspective), found the end of the line",
        ),
        (2, "far", "s.dat:2:1: expected the distance of the view plane, found \"far\""),
        (3, "{}", "s.dat:3:1: expected the distance of the centre of projection, found \"{}\""),
        (3, "0", "s.dat:3:1: the distance of the centre of projection must be positive"),
        (4, "1.5 2", "s.dat:4:6: expected z of VRP, found the end of the line"),
        (5, "0 0 0", "s.dat:5:1: VPN must have a direction"),
        (6, "0 0 -3", "s.dat:6:1: VUP must have a direction other than VPN's"),
        (7, "8", "s.dat:7:2: expected the height of the window, found the end of the line"),
        (7, "8 -8", "s.dat:7:3: the height of the window must be positive, not -8"),
        (8, "0", "s.dat:8:1: the raster height must be 1 to 65536 pixels, not 0"),
        (9, "4", "s.dat:9:1: expected the operation, 0 to 3, found 4"),
        (10, "0 0 0", "s.dat:10:1: the light must have a direction"),
        (10, "0 0", "s.dat:10:4: expected z of the light, found the end of the line"),
        (11, "", "s.dat:11:1: expected the name of the bitmap, found the end of the line"),
        (12, "-1", "s.dat:12:1: the number of objects must not be negative"),
        (12, "3", "s.dat:20:12: expected the name of an object file, found the end of the file"),
        (14, "1 1", "s.dat:14:4: expected z of the scale, found the end of the line"),
        (15, "a", "s.dat:15:1: expected the angle about x, found \"a\""),
        (16, "0 0 z", "s.dat:16:5: expected z of the translation, found \"z\""),
    ] {
        let error = ClassicScene::parse("s.dat", with_line(SCENE, line, new).as_bytes()).expect_err(new);
        assert_eq!(error.to_string(), expected);
    }
    let missing = with_line(SCENE, 13, "no.dat");
    let error = read_scene("s.dat", missing.as_bytes(), &samples()).expect_err("a missing file");
    assert!(error.to_string().contains("no.dat"), "{error}");
}

#[test]
fn bitmaps_go_column_by_column_in_both_widths() {
    let bitmap = IndexBitmap { width: 2, height: 3, indices: vec![0, 1, 2, 10, 11, 255] };
    assert_eq!((bitmap.get(1, 0), bitmap.get(0, 2), bitmap.get(2, 0)), (Some(10), Some(2), None));
    let small = bitmap.write(IntegerWidth::Bits16);
    assert_eq!(small, [2, 0, 3, 0, 0, 0, 1, 0, 2, 0, 10, 0, 11, 0, 255, 0]);
    for width in [IntegerWidth::Bits16, IntegerWidth::Bits32] {
        assert_eq!(IndexBitmap::read("b", &bitmap.write(width)).expect("reads"), (bitmap.clone(), width));
    }
    let square = IndexBitmap { width: 150, height: 150, indices: vec![7; 22_500] };
    assert_eq!(square.write(IntegerWidth::Bits32).len(), 90_008);
    assert!(IndexBitmap::read("b", &small[..15]).is_err());
    assert!(IndexBitmap::read("b", &[]).is_err());
}

fn converted(sample: &[u8]) -> Vec<u8> {
    let settings = senca_scene::PatchConversion::default();
    let mesh = senca_scene::patch_to_polygons(&patches(sample), &settings).expect("converts");
    write_object(&mesh).expect("writes")
}

#[test]
fn the_converter_writes_what_was_printed() {
    assert_eq!(String::from_utf8_lossy(&converted(PATCH)), String::from_utf8_lossy(PATCH_MESH));
    assert_eq!(converted(TEAPOT), TEAPOT_MESH);
    let teapot = mesh(TEAPOT_MESH);
    assert_eq!((teapot.points.len(), teapot.faces.len(), teapot.surfaces.len()), (529, 512, 5));
    let per_surface: Vec<usize> =
        (0..5).map(|s| teapot.faces.surface.iter().filter(|&&x| x == s).count()).collect();
    assert_eq!(per_surface, [192, 64, 64, 128, 64]);
}
