use senca_math::glam::DVec3;
use senca_math::{Control, LinearRgb};

use super::*;
use crate::{DirectLight, ElementMesh, Solution};

type Quad = [DVec3; 4];

fn quad(origin: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Quad {
    let [o, u, v] = [origin, u, v].map(DVec3::from_array);
    [o, o + u, o + u + v, o + v]
}

/// The walls of a box, seen from inside: x = 0, x = 1, y = 0, y = 1, z = 0, z = 1 of its size.
fn room(size: [f64; 3]) -> [Quad; 6] {
    let [x, y, z] = size;
    [
        quad([0.0; 3], [0.0, y, 0.0], [0.0, 0.0, z]),
        quad([x, 0.0, 0.0], [0.0, 0.0, z], [0.0, y, 0.0]),
        quad([0.0; 3], [0.0, 0.0, z], [x, 0.0, 0.0]),
        quad([0.0, y, 0.0], [x, 0.0, 0.0], [0.0, 0.0, z]),
        quad([0.0; 3], [x, 0.0, 0.0], [0.0, y, 0.0]),
        quad([0.0, 0.0, z], [0.0, y, 0.0], [x, 0.0, 0.0]),
    ]
}

fn mesh_of(quads: &[(Quad, f32, f32)]) -> ElementMesh {
    let polygons: Vec<_> = quads
        .iter()
        .map(|(corners, grey, light)| (&corners[..], LinearRgb::splat(*grey), LinearRgb::splat(*light)))
        .collect();
    ElementMesh::of_polygons(&polygons)
}

fn solve(mesh: ElementMesh, settings: &HierarchySettings) -> Solution {
    solve_hierarchy(mesh, &DirectLight::default(), settings, &Control::default(), &mut |_| {})
        .expect("a solution")
}

#[test]
fn a_white_furnace_glows_evenly() {
    for size in [[1.0, 1.0, 1.0], [4.0, 1.0, 2.0]] {
        let walls = room(size).map(|wall| (wall, 0.5, 1.0));
        let solution = solve(mesh_of(&walls), &HierarchySettings::default());
        assert!(solution.report.converged && solution.report.energy_error < 1e-3, "{:?}", solution.report);
        for element in 0..solution.mesh.elements().len() as u32 {
            let shown = solution.radiosity(element).g;
            assert!((shown - 2.0).abs() < 2e-4, "{element}: {shown}");
        }
    }
}

#[test]
fn a_cube_with_one_wall_that_shines_agrees_with_the_closed_form() {
    let mut walls = room([1.0; 3]).map(|wall| (wall, 0.5, 0.0));
    walls[4].2 = 1.0;
    let settings = HierarchySettings { threshold: 1e-4, ..HierarchySettings::default() };
    let solution = solve(mesh_of(&walls), &settings);
    // Solved by six whole walls. Parts of them see differing shares, so it is about the same here.
    let expected = [0.181_836, 0.181_836, 0.181_836, 0.181_836, 1.090_909, 0.181_746];
    for (wall, expected) in (0..).zip(expected) {
        let shown = f64::from(solution.radiosity(wall).g);
        assert!((shown - expected).abs() < 0.01, "{wall}: {shown} {expected}");
    }
    assert!(solution.report.energy_error < 1e-3, "{:?}", solution.report);
}
