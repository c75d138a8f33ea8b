//! Nothing that is in the file makes the reader panic, hang or swell.

use proptest::prelude::*;

use super::super::*;
use super::samples::{examples, samples};
use crate::Files;

struct AnyFile;

impl Files for AnyFile {
    fn read(&self, _: &str) -> Result<Vec<u8>, ReadError> {
        Ok(Vec::new())
    }
}

/// Reads the bytes; whatever comes out must hold together.
fn try_read(bytes: &[u8]) {
    match read("x.toml", bytes, &AnyFile, &super::no_models) {
        Ok(file) => check(&file.scene),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// All indices of the scene lead somewhere.
fn check(scene: &Scene) {
    let inside = |index: Option<usize>, count: usize| assert!(index.is_none_or(|index| index < count));
    for node in &scene.nodes {
        inside(node.geometry.map(|id| id.index()), scene.geometries.len());
        inside(node.material.map(|id| id.index()), scene.materials.len());
        inside(node.light.map(|id| id.index()), scene.lights.len());
        inside(node.camera.map(|id| id.index()), scene.cameras.len());
        node.children.iter().for_each(|id| inside(Some(id.index()), scene.nodes.len()));
        assert!(node.transform.matrix().is_finite());
    }
    for geometry in &scene.geometries {
        let senca_scene::Shape::Mesh(mesh) = &geometry.shape else { continue };
        mesh.faces.corners.iter().for_each(|&v| inside(Some(v as usize), mesh.vertices.point.len()));
        mesh.vertices.point.iter().for_each(|&p| inside(Some(p as usize), mesh.points.len()));
        assert!(mesh.points.iter().all(|p| p.is_finite()));
    }
}

fn texts() -> Vec<String> {
    samples().into_iter().map(|(_, text)| text).chain(examples().into_iter().map(|(_, text)| text)).collect()
}

#[test]
fn cut_off_files_end_in_an_error_or_a_scene() {
    for text in texts() {
        for length in (0..text.len()).step_by(text.len() / 150 + 1) {
            try_read(&text.as_bytes()[..length]);
        }
    }
}

/// Values that are put in place of words of the files.
const ODD: [&str; 16] = [
    "-1",
    "0",
    "1e999",
    "nan",
    "-inf",
    "\"\"",
    "[]",
    "{}",
    "true",
    "1979-05-27",
    "[[[]]]",
    "99999999999999999999",
    "1e-40",
    "\"\\u0000\"",
    "[0, 0, 0]",
    "0xffffffffffffffffffff",
];

#[test]
fn changed_values_end_in_an_error_or_a_scene() {
    for (round, text) in texts().into_iter().enumerate() {
        let values: Vec<usize> = text.match_indices(" = ").map(|(at, _)| at + 3).collect();
        for (i, &at) in values.iter().enumerate().step_by(values.len() / 40 + 1) {
            let end = at + text[at..].find('\n').unwrap_or(0);
            for odd in [ODD[(i + round) % ODD.len()], ODD[(3 * i + 7) % ODD.len()]] {
                try_read(format!("{}{odd}{}", &text[..at], &text[end..]).as_bytes());
            }
        }
    }
}

#[test]
fn long_lists_stay_in_proportion() {
    let zeros = "0,".repeat(200_000);
    try_read(format!("[[object]]\nshape = 'mesh'\npoints = [{zeros}]").as_bytes());
    let points = "[0,0,0],".repeat(20_000);
    let faces = "[0,1,2],".repeat(20_000);
    try_read(format!("[[object]]\nshape = 'mesh'\npoints = [{points}]\nfaces = [{faces}]").as_bytes());
    try_read(format!("[texture.t]\ntexels = [[{zeros}]]").as_bytes());
    try_read("[[object]]\n".repeat(20_000).as_bytes());
    let moved: String = (0..10_000)
        .map(|i| {
            let keys = "property = 'scale'\ntimes = [0]\nvalues = [1]";
            format!("[[object]]\nname = 'o{i}'\n[[animation]]\nname = 'a{i}'\nnode = 'o{i}'\n{keys}\n")
        })
        .collect();
    try_read(moved.as_bytes());
    let keys: String = (0..20_000).map(|i| format!("key{i} = 1\n")).collect();
    try_read(keys.as_bytes());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn mutated_bytes_end_in_an_error_or_a_scene(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let texts = texts();
        let mut bytes = which.get(&texts).clone().into_bytes();
        for (place, value) in changes {
            let at = place.index(bytes.len());
            bytes[at] = value;
        }
        try_read(&bytes);
    }
}
