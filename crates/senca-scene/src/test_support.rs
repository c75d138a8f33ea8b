//! Data of the 1991 thesis for the tests of this crate.

use senca_math::glam::{DVec3, Vec3};

use crate::{BezierPatch, Mesh, Surface, Vertices};

fn numbers(text: &str) -> impl Iterator<Item = Vec<f64>> + '_ {
    text.lines().map(|line| line.split_whitespace().map_while(|word| word.parse().ok()).collect())
}

/// Patches of a patch file.
pub(crate) fn patches(text: &str) -> Vec<BezierPatch> {
    let mut lines = numbers(text);
    let header = lines.next().unwrap();
    let points: Vec<DVec3> =
        lines.by_ref().take(header[0] as usize).map(|l| DVec3::new(l[1], l[2], l[3])).collect();
    lines
        .take(header[1] as usize)
        .map(|l| BezierPatch {
            points: std::array::from_fn(|i| points[l[3 + i] as usize]),
            surface: l[1] as u32,
        })
        .collect()
}

/// The teapot as the thesis gives it.
pub(crate) fn teapot() -> Vec<BezierPatch> {
    // The sample has the digits of point 49 put right.
    let sample = include_str!("../../../samples/classic/teapot.bez");
    patches(&sample.replace("49 1.75000 -0.98000", "49 1.75000 -0.89000"))
}

/// Mesh of an object file, with a vertex per point.
pub(crate) fn object(text: &str) -> Mesh {
    let mut lines = numbers(text);
    let header = lines.next().unwrap();
    let points: Vec<Vec3> = lines
        .by_ref()
        .take(header[0] as usize)
        .map(|l| Vec3::new(l[1] as f32, l[2] as f32, l[3] as f32))
        .collect();
    let vertices = Vertices { point: (0..points.len() as u32).collect(), ..Vertices::default() };
    let surfaces = vec![Surface::default(); header[2] as usize];
    let mut mesh = Mesh { points, vertices, surfaces, ..Mesh::default() };
    for line in lines.take(header[1] as usize) {
        let corners: Vec<u32> = line[3..].iter().map(|&i| i as u32).collect();
        mesh.faces.push(&corners, line[1] as u32);
    }
    mesh
}

/// The gabled house of the thesis: 17 vertices, 13 polygons, 13 surfaces.
pub(crate) fn house() -> Mesh {
    object(include_str!("../../../samples/classic/house.dat"))
}

/// The octagonal cylinder of the thesis: 16 vertices, 10 polygons, 3 surfaces.
pub(crate) fn octagonal_cylinder() -> Mesh {
    object(include_str!("../../../samples/classic/cylinder.dat"))
}
