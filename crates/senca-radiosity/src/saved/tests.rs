use proptest::prelude::*;
use senca_math::glam::{DMat4, DVec3};
use senca_scene::{Camera, CameraId, Node, Projection, Shape, Transform};

use super::*;
use crate::MeshSettings;

fn scene() -> senca_scene::Scene {
    senca_scene::Scene::of_shape("box", Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) })
}

fn solution() -> Solution {
    let settings = MeshSettings { patch_size: Some(0.9), ..MeshSettings::default() };
    let mut mesh = ElementMesh::of_scene(&scene(), &settings).expect("a mesh");
    let deepest = mesh.leaves().last().expect("a leaf");
    assert!(mesh.divide(deepest));
    mesh.set_open(deepest, 0.25);
    let light =
        |scale: f32| (0..mesh.elements().len()).map(|i| LinearRgb::new(i as f32, scale, 0.5)).collect();
    let (incident, direct) = (light(1.0), light(0.25));
    let report =
        SolveReport { iterations: 7, residual: 1e-5, links: 12, converged: true, ..Default::default() };
    Solution { mesh, incident, direct, report }
}

#[test]
fn what_was_saved_is_what_is_loaded() {
    let solution = solution();
    let bytes = solution.save(42);
    assert!(Solution::load(&bytes, Some(42)) == Ok(solution.clone()));
    assert!(Solution::load(&bytes, None) == Ok(solution.clone()));
    assert_eq!(Solution::load(&bytes, Some(43)), Err(SavedSolutionError::OtherScene));
    assert!(
        bytes.len() < 300 + 48 * 48 + 128 * 12 + 30 * solution.mesh.elements().len(),
        "{} bytes",
        bytes.len()
    );
}

#[test]
fn an_empty_solution_can_be_saved() {
    let empty = Solution::default();
    assert_eq!(Solution::load(&empty.save(0), Some(0)), Ok(empty));
}

#[test]
fn other_files_and_damage_are_told_apart() {
    let bytes = solution().save(1);
    assert_eq!(Solution::load(b"\x89PNG\r\n\x1a\n....", None), Err(SavedSolutionError::NotASolution));
    assert_eq!(Solution::load(b"", None), Err(SavedSolutionError::NotASolution));
    let mut later = bytes.clone();
    later[8] = 9;
    assert_eq!(Solution::load(&later, None), Err(SavedSolutionError::Version(9)));
    let mut changed = bytes.clone();
    changed[200] ^= 1;
    assert_eq!(Solution::load(&changed, None), Err(SavedSolutionError::Damaged("its checksum is wrong")));
    for length in 0..bytes.len() {
        assert!(Solution::load(&bytes[..length], None).is_err(), "{length} bytes");
    }
}

/// `bytes` with `change` made and the checksum set right again, as a forger would do.
fn forged(mut bytes: Vec<u8>, change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    bytes.truncate(bytes.len() - CHECKSUM);
    change(&mut bytes);
    let sum = checksum(&bytes);
    bytes.extend_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn forged_counts_and_indices_are_refused() {
    let bytes = solution().save(1);
    let counts = 20..48;
    for at in counts.step_by(4) {
        let huge = forged(bytes.clone(), |b| b[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes()));
        assert_eq!(Solution::load(&huge, None), Err(SavedSolutionError::Damaged("its length is wrong")));
    }
    let last = bytes.len() - CHECKSUM - 4;
    let dark = forged(bytes.clone(), |b| b[last..last + 4].copy_from_slice(&f32::NAN.to_le_bytes()));
    assert_eq!(Solution::load(&dark, None), Err(SavedSolutionError::Damaged("its light is not a number")));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn forged_bytes_end_in_an_error_or_a_solution(changes in prop::collection::vec((12_usize..6000, any::<u8>()), 1..8)) {
        let bytes = forged(solution().save(1), |bytes| {
            for (at, value) in changes {
                let at = at % bytes.len();
                bytes[at.max(12)] = value;
            }
        });
        if let Ok(solution) = Solution::load(&bytes, None) {
            prop_assert_eq!(solution.incident.len(), solution.mesh.elements().len());
        }
    }

    #[test]
    fn arbitrary_bytes_end_in_an_error(tail in prop::collection::vec(any::<u8>(), 0..300)) {
        let bytes: Vec<u8> = MAGIC.iter().chain(&1_u32.to_le_bytes()).copied().chain(tail).collect();
        prop_assert!(Solution::load(&bytes, None).is_err());
    }
}

/// What the fuzz target `saved_light` does, on its seeds with some thousand changes that are always the same.
#[test]
fn changed_seeds_of_the_fuzzer_end_in_an_error_or_a_solution() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/corpus/saved_light");
    let seeds: Vec<Vec<u8>> = std::fs::read_dir(folder)
        .expect("the seeds")
        .map(|entry| std::fs::read(entry.expect("an entry").path()).expect("a seed"))
        .collect();
    assert!(!seeds.is_empty() && seeds.iter().all(|seed| Solution::load(seed, None).is_ok()));
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below.max(1)
    };
    let mut loaded = 0;
    for round in 0..4000 {
        let bytes = forged(seeds[round % seeds.len()].clone(), |bytes| {
            for _ in 0..=next(3) {
                let at = 12 + next(bytes.len() - 12);
                match next(4) {
                    0 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][next(5)],
                    1 => bytes[at] ^= 1 << next(8),
                    2 => drop(bytes.remove(at)),
                    _ => bytes.insert(at, next(256) as u8),
                }
            }
        });
        if let Ok(solution) = Solution::load(&bytes, None) {
            loaded += 1;
            assert_eq!(solution.incident.len(), solution.mesh.elements().len());
            let again = Solution::load(&solution.save(7), Some(7)).expect("what was saved");
            assert_eq!(again.incident, solution.incident);
            assert_eq!(again.mesh.elements().len(), solution.mesh.elements().len());
        }
    }
    assert!(loaded > 100, "{loaded}");
}

#[test]
fn the_fingerprint_knows_shapes_and_materials_but_no_cameras() {
    let base = scene();
    let first = light_fingerprint(&base);
    let mut seen = base.clone();
    let projection = Projection::Perspective { yfov: 1.0, aspect: None, near: None, far: None };
    seen.cameras.push(Camera::new("other", projection));
    let node = seen.add_node(Node { camera: Some(CameraId(0)), ..Node::default() });
    seen.roots.push(node);
    assert_eq!(light_fingerprint(&seen), first);
    let mut moved = base.clone();
    moved.nodes[0].transform = Transform::Matrix(DMat4::from_translation(DVec3::X));
    assert_ne!(light_fingerprint(&moved), first);
    let mut painted = base.clone();
    painted.add_material(senca_scene::Material::default());
    assert_ne!(light_fingerprint(&painted), first);
    let mut higher = base;
    higher.geometries[0].shape = Shape::Box { size: DVec3::new(1.0, 2.0, 3.5) };
    assert_ne!(light_fingerprint(&higher), first);
}
