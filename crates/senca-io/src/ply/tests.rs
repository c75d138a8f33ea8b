use super::*;
use crate::NoFiles;
use senca_scene::Mesh;
use senca_scene::math::Srgb8;
use senca_scene::math::glam::{Vec2, Vec3, Vec4};

fn mesh(bytes: &[u8]) -> Mesh {
    let scene = read("t.ply", bytes, &NoFiles).expect("reads");
    match scene.geometries.into_iter().next().map(|g| g.shape) {
        Some(Shape::Mesh(mesh)) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

fn error(bytes: &[u8]) -> String {
    read("t.ply", bytes, &NoFiles).expect_err("malformed").to_string()
}

const TEXT: &str = "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\
    3 0 1 2\n4 0 1 2 3\n";

/// A square with colours as doubles in odd order, a list to skip, and an element to skip.
fn binary(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement junk 2\r\nproperty list ushort double stuff\r\nproperty char c\r\n\
         element vertex 3\r\nproperty double z\r\nproperty uchar blue\r\nproperty uchar green\r\nproperty uchar red\r\n\
         property short x\r\nproperty list uchar float more\r\nproperty float y\r\n\
         element face 1\r\nproperty uchar flags\r\nproperty list int uint vertex_index\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |raw: &[u8]| if big { bytes.extend(raw.iter().rev()) } else { bytes.extend(raw) };
    for _ in 0..2 {
        put(&1u16.to_le_bytes());
        put(&f64::NAN.to_le_bytes());
        put(&[7]);
    }
    for (x, y) in [(0i16, 0f32), (-2, 0.0), (0, 3.5)] {
        put(&0.25f64.to_le_bytes());
        [0, 128, 255].iter().for_each(|c| put(&[*c]));
        put(&x.to_le_bytes());
        put(&[1]);
        put(&9f32.to_le_bytes());
        put(&y.to_le_bytes());
    }
    put(&[1]);
    put(&3i32.to_le_bytes());
    [0u32, 1, 2].iter().for_each(|i| put(&i.to_le_bytes()));
    bytes
}

#[test]
fn text_is_read() {
    let mesh = mesh(TEXT.as_bytes());
    assert_eq!(mesh.points, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.faces.starts, [0, 3, 7]);
    assert_eq!(mesh.faces.corners, [0, 1, 2, 0, 1, 2, 3]);
    assert!(mesh.dots.is_empty());
    assert_eq!(mesh.surfaces.len(), 1);
}

#[test]
fn both_byte_orders_any_types_and_unknown_lists_are_read() {
    let little = mesh(&binary(false));
    assert_eq!(
        little.points,
        [Vec3::new(0.0, 0.0, 0.25), Vec3::new(-2.0, 0.0, 0.25), Vec3::new(0.0, 3.5, 0.25)]
    );
    assert_eq!(little.faces.corners, [0, 1, 2]);
    let orange = Srgb8 { r: 255, g: 128, b: 0 }.to_linear();
    assert_eq!(little.vertices.color[0], Vec4::new(orange.r, orange.g, orange.b, 1.0));
    assert_eq!(little, mesh(&binary(true)));
}

#[test]
fn normals_and_texture_coordinates_are_read() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nproperty float red\n\
        property float green\nproperty float blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0 2 0.25 0.25 0.5 0.5 2\n1 0 0 0 0 0 0 0 0 0 0\n0 1 0 1 0 0 1 1 1 1 1\n3 0 1 2\n";
    let mesh = mesh(text.as_bytes());
    assert_eq!(mesh.vertices.normal, [Vec3::Z, Vec3::Z, Vec3::X]);
    assert_eq!(mesh.vertices.texcoord0[0], Vec2::new(0.25, 0.75));
    assert_eq!(mesh.vertices.color[0], Vec4::new(0.5, 0.5, 2.0, 1.0));
}

#[test]
fn strips_edges_and_clouds_are_read() {
    let head =
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
    let rows = "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
    let strips = format!(
        "{head}element tristrips 1\nproperty list int int vertex_indices\n{rows}8 0 1 2 3 -1 2 3 4\n"
    );
    assert_eq!(mesh(strips.as_bytes()).faces.corners, [0, 1, 2, 2, 1, 3, 2, 3, 4]);
    let edges = format!("{head}element edge 1\nproperty int vertex1\nproperty int vertex2\n{rows}0 4\n");
    assert_eq!(mesh(edges.as_bytes()).lines, [[0, 4]]);
    assert_eq!(mesh(format!("{head}{rows}").as_bytes()).dots, [0, 1, 2, 3, 4]);
}

#[test]
fn faces_with_their_own_colors_or_texture_coordinates_split_vertices() {
    let colored = TEXT
        .replace(
            "vertex_indices\n",
            "vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
        )
        .replace("3 0 1 2\n", "3 0 1 2 255 0 0\n")
        .replace("4 0 1 2 3\n", "4 0 1 2 3 0 0 255\n");
    let mesh1 = mesh(colored.as_bytes());
    assert_eq!((mesh1.points.len(), mesh1.vertices.point.len()), (4, 7));
    assert_eq!(mesh1.vertices.color[6], Vec4::new(0.0, 0.0, 1.0, 1.0));
    let textured = TEXT
        .replace("vertex_indices\n", "vertex_indices\nproperty list uchar float texcoord\n")
        .replace("3 0 1 2\n", "3 0 1 2 6 0 0 1 0 1 1\n")
        .replace("4 0 1 2 3\n", "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n");
    let mesh2 = mesh(textured.as_bytes());
    assert_eq!(mesh2.vertices.point.len(), 4);
    assert_eq!(mesh2.vertices.texcoord0[0], Vec2::new(0.0, 1.0));
}

#[test]
fn malformed_files_are_refused_where_they_err() {
    let with = |from: &str, to: &str| error(TEXT.replacen(from, to, 1).as_bytes());
    assert_eq!(error(b"plx"), "t.ply:1:1: a PLY file begins with \"ply\"");
    assert_eq!(
        with("ascii", "asci"),
        "t.ply:2:8: expected \"ascii\", \"binary_little_endian\" or \"binary_big_endian\", found \"asci\""
    );
    assert_eq!(with("1.0", "2.0"), "t.ply:2:14: expected the version \"1.0\", found \"2.0\"");
    assert_eq!(with("vertex 4", "vertex -4"), "t.ply:4:16: the number of rows must not be negative");
    assert_eq!(
        with("vertex 4", "vertex"),
        "t.ply:4:15: expected the number of rows, found the end of the line"
    );
    assert_eq!(
        with("float y", "flat y"),
        "t.ply:6:10: expected a type such as \"float\" or \"uchar\", found \"flat\""
    );
    assert_eq!(
        with("float z", "float w"),
        "t.ply:1:1: the element \"vertex\" needs the properties x, y and z"
    );
    assert_eq!(
        with("element face", "elephant face"),
        "t.ply:8:1: expected \"element\", \"property\" or \"end_header\", found \"elephant\""
    );
    assert_eq!(with("1 0 0\n", "1 0\n"), "t.ply:12:4: expected z, found the end of the line");
    assert_eq!(with("1 0 0\n", "1 0 0 0\n"), "t.ply:12:7: expected the end of the line, found \"0\"");
    assert_eq!(with("1 0 0\n", "1 nan 0\n"), "t.ply:12:3: expected y, found \"nan\"");
    assert_eq!(with("3 0 1 2", "3 0 1 4"), "t.ply:15:1: vertex 4 is out of range: there are 4");
    assert_eq!(
        with("3 0 1 2", "-3 0 1 2"),
        "t.ply:15:1: vertex_indices must be a whole number of 0 or more, not -3"
    );
    assert_eq!(with("4 0 1 2 3\n", ""), "t.ply:16:1: expected a row of \"face\", found the end of the file");
    assert_eq!(
        error(&TEXT.as_bytes()[..63]),
        "t.ply:5:9: expected a type such as \"float\" or \"uchar\", found the end of the file"
    );
    assert_eq!(error(b"ply\nelement vertex 0\nend_header\n"), "t.ply:3:1: the header has no line \"format\"");
    assert_eq!(error(b"ply\nproperty int x\n"), "t.ply:2:1: a property needs an element before it");
}

#[test]
fn promises_that_the_bytes_do_not_bear_out_are_refused_at_once() {
    let huge = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
        property float z\nend_header\n";
    assert_eq!(
        error(huge.as_bytes()),
        "t.ply: byte 124: the header says 4000000000 rows of \"vertex\", but the file has bytes for 0 at most"
    );
    let text = TEXT.replace("vertex 4", "vertex 4000000000");
    assert_eq!(error(text.as_bytes()), "t.ply:15:7: expected the end of the line, found \"2\"");
    let mut short = binary(false);
    short.truncate(short.len() - 2);
    let end = short.len();
    assert_eq!(error(&short), format!("t.ply: byte {end}: the file ends where vertex_index should be"));
}

#[test]
fn small_faces_are_left_out_with_a_warning() {
    let scene = read("t.ply", TEXT.replace("3 0 1 2", "2 0 1").as_bytes(), &NoFiles).expect("reads");
    assert_eq!(scene.warnings[0].0, "1 faces with fewer than three corners are left out");
}
