use super::*;
use crate::NoFiles;

const TEXT: &str = "solid two facets\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n  \
    endloop\n endfacet\n facet normal 0 0 0\n  outer loop\n   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 -0.0\n  \
    endloop\n endfacet\nendsolid two facets\n";

/// A binary file of one facet whose header is `header`.
fn binary(header: &str, facets: &[[f32; 12]], words: &[u16]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend((facets.len() as u32).to_le_bytes());
    for (facet, word) in facets.iter().zip(words) {
        facet.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
        bytes.extend(word.to_le_bytes());
    }
    bytes
}

const FACET_UP: [f32; 12] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

fn mesh(bytes: &[u8]) -> Mesh {
    let scene = read("part.stl", bytes, &NoFiles).expect("reads");
    match scene.geometries.into_iter().next().map(|g| g.shape) {
        Some(Shape::Mesh(mesh)) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

fn error(bytes: &[u8]) -> String {
    read("part.stl", bytes, &NoFiles).expect_err("malformed").to_string()
}

#[test]
fn text_facets_are_welded_and_missing_normals_found() {
    let mesh = mesh(TEXT.as_bytes());
    assert_eq!((mesh.points.len(), mesh.vertices.point.len()), (4, 4));
    assert_eq!(mesh.faces.corners, [0, 1, 2, 0, 2, 3]);
    assert_eq!(mesh.vertices.normal, [Vec3::Z; 4]);
    assert_eq!(mesh.surfaces[0].name, "two facets");
}

#[test]
fn several_solids_are_several_surfaces() {
    let mesh = mesh(format!("{TEXT}{}", TEXT.replace("two", "other")).as_bytes());
    assert_eq!(mesh.faces.surface, [0, 0, 1, 1]);
    assert_eq!(mesh.surfaces[1].name, "other facets");
    assert_eq!(mesh.points.len(), 4);
}

#[test]
fn normals_that_are_no_numbers_are_missing() {
    let mesh = mesh(TEXT.replace("normal 0 0 1", "normal nan -nan(ind) inf").as_bytes());
    assert!(mesh.vertices.normal.is_empty());
    assert!(!mesh.surfaces[0].smooth);
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    let bytes = binary("solid made by some program", &[FACET_UP], &[0]);
    assert!(!is_text(&bytes));
    let mesh = mesh(&bytes);
    assert_eq!(mesh.points, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.vertices.normal, [Vec3::Z; 3]);
    assert!(mesh.vertices.color.is_empty());
}

#[test]
fn facet_colors_are_read_in_both_dialects() {
    let viscam = mesh(&binary("", &[FACET_UP, FACET_UP], &[0x8000 | 31 << 10, 0]));
    assert_eq!(viscam.vertices.color[0], Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(viscam.vertices.color[3], Vec4::ONE);
    let magics = mesh(&binary("COLOR=\0\0\u{7f}\u{7f}", &[FACET_UP, FACET_UP], &[31, 0x8000]));
    assert_eq!(magics.vertices.color[0], Vec4::new(1.0, 0.0, 0.0, 1.0));
    let whole = Srgb8 { r: 0, g: 0, b: 0x7f }.to_linear().b;
    assert_eq!(magics.vertices.color[3], Vec4::new(0.0, 0.0, whole, 1.0));
}

#[test]
fn malformed_files_are_refused_where_they_err() {
    let with = |from: &str, to: &str| error(TEXT.replacen(from, to, 1).as_bytes());
    assert_eq!(with("vertex 1 0 0", "vertex 1 x 0"), "part.stl:5:13: expected y of a vertex, found \"x\"");
    assert_eq!(
        with("vertex 1 0 0", "vertex nan 0 0"),
        "part.stl:5:11: expected x of a vertex, found \"nan\""
    );
    assert_eq!(with("outer", "inner"), "part.stl:3:3: expected \"outer\", found \"inner\"");
    assert_eq!(with("endloop", "vertex 2 2 2"), "part.stl:7:3: expected \"endloop\", found \"vertex\"");
    assert_eq!(
        with("facet normal 0 0 1", "face"),
        "part.stl:2:2: expected \"facet\" or \"endsolid\", found \"face\""
    );
    assert_eq!(
        with("endsolid two facets\n", ""),
        "part.stl:16:1: expected \"facet\" or \"endsolid\", found the end of the file"
    );
    let good = binary("", &[FACET_UP, FACET_UP], &[0, 0]);
    assert_eq!(error(&good[..183]), "part.stl: byte 183: says 2 facets, but ends within facet 1 (from 0)");
    assert_eq!(error(&good[..50]), "part.stl: byte 50: a binary STL file has at least 84 bytes, this has 50");
    let mut not_finite = FACET_UP;
    not_finite[7] = f32::NAN;
    let bytes = binary("", &[FACET_UP, not_finite], &[0, 0]);
    assert_eq!(error(&bytes), "part.stl: byte 158: corner 1 of facet 1 is not a finite place");
}

#[test]
fn bytes_behind_the_last_facet_are_warned_of() {
    let mut bytes = binary("", &[FACET_UP], &[0]);
    bytes.extend([0; 7]);
    let scene = read("part.stl", &bytes, &NoFiles).expect("reads");
    assert_eq!(scene.warnings[0].0, "part.stl: 7 bytes behind the last of 1 facets are passed over");
    assert_eq!(scene.name, "part");
}

#[test]
fn an_empty_solid_is_an_empty_mesh() {
    assert!(mesh(b"solid\nendsolid\n").faces.is_empty());
}
