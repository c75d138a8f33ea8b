//! Figures that need several rooms at once: culling of the 1991 teapot.

use std::path::Path;

use senca::math::glam::DVec3;
use senca::math::transform::world_from_object_1991;
use senca::scene::{BezierPatch, Mesh, PatchConversion, Shape, patch_to_polygons, polygon_normal_1991};

/// The teapot as printed: its point 49 has 0.89 where symmetry wants 0.98.
fn printed_teapot() -> Vec<BezierPatch> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/classic/teapot.bez");
    let mut scene = senca::io::load(&path).expect("the teapot");
    let Shape::BezierPatches { patches } = &mut scene.geometries[0].shape else { panic!("patches") };
    let (right, printed) = (DVec3::new(1.75, -0.98, 1.875), DVec3::new(1.75, -0.89, 1.875));
    for point in patches.iter_mut().flat_map(|patch| &mut patch.points).filter(|point| **point == right) {
        *point = printed;
    }
    std::mem::take(patches)
}

/// Polygons that turn their back to an eye at (0, 1.5, 70), with the pot turned by (-60, 2, 0) degrees.
fn culled(mesh: &Mesh) -> usize {
    let turns = DVec3::new(-60.0, 2.0, 0.0).map(f64::to_radians);
    let world_from_object = world_from_object_1991(DVec3::ONE, turns, DVec3::ZERO);
    let eye_world = DVec3::new(0.0, 1.5, 70.0);
    let place = |vertex: u32| world_from_object.transform_point3(mesh.position(vertex).as_dvec3());
    let faces = (0..mesh.faces.len()).map(|face| mesh.faces.corners_of(face));
    faces
        .filter(|corners| {
            let normal = polygon_normal_1991(corners.iter().map(|&v| place(v).as_vec3())).expect("a normal");
            normal.as_dvec3().dot(eye_world - place(corners[0])) < 0.0
        })
        .count()
}

#[test]
fn a_little_under_half_of_the_teapot_is_culled() {
    let patches = printed_teapot();
    for (steps, total, expected) in [(2, 128, 60), (4, 512, 236), (8, 2048, 954), (16, 8192, 3820)] {
        let settings = PatchConversion { steps: [steps, steps], ..PatchConversion::default() };
        let mesh = patch_to_polygons(&patches, &settings).expect("polygons");
        assert_eq!(mesh.faces.len(), total);
        assert_eq!(culled(&mesh), expected, "{steps} x {steps}");
    }
}
