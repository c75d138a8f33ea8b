//! Data that benchmarks make for themselves.

use std::f32::consts::{PI, TAU};
use std::fmt::Write;

use senca::math::glam::{DVec3, Mat4, Vec3, Vec4};
use senca::math::{View, ViewError};

/// Columns of the bumpy sphere; with half as many rows it has about 70 000 triangles, as many as the
/// well-known scanned bunny.
const COLUMNS: u32 = 264;
/// Rows of the bumpy sphere.
const ROWS: u32 = 132;

/// A closed surface with bumps: points, normals, triangles.
pub(super) struct BumpySphere {
    pub(super) points: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<u32>,
}

impl BumpySphere {
    pub(super) fn new() -> Self {
        let grid = || (0..=ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (column, row)));
        let points: Vec<_> = grid().map(|(column, row)| point(column, row)).collect();
        let normals = points.iter().map(|p| p.normalize_or_zero()).collect();
        Self { points, normals, triangles: triangles() }
    }

    /// The surface as the text of an OBJ file.
    pub(super) fn obj(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        for p in &self.points {
            let _ = writeln!(text, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z);
        }
        for t in self.triangles.as_chunks::<3>().0 {
            let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
        }
        text
    }
}

fn point(column: u32, row: u32) -> Vec3 {
    let (phi, theta) = (TAU * column as f32 / COLUMNS as f32, PI * row as f32 / ROWS as f32);
    let radius = 1.0 + 0.05 * (9.0 * phi).sin() * (11.0 * theta).sin();
    radius * Vec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin())
}

fn triangles() -> Vec<u32> {
    let mut corners = Vec::with_capacity(6 * (COLUMNS * ROWS) as usize);
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let next = (column + 1) % COLUMNS;
            let [a, b] = [row * COLUMNS + column, row * COLUMNS + next];
            let [c, d] = [a + COLUMNS, b + COLUMNS];
            corners.extend_from_slice(&[a, c, d, a, d, b]);
        }
    }
    corners
}

/// World to clip coordinates of a camera that frames the unit sphere.
pub(super) fn clip_from_world() -> Result<Mat4, ViewError> {
    let world_from_camera = View::look_at(DVec3::new(0.6, 0.8, 2.6), DVec3::ZERO, DVec3::Y)?;
    Ok(View::perspective(&world_from_camera, 0.8, 1.0, 0.5, Some(10.0))?.clip_from_world.as_mat4())
}

/// Two triangles over the whole picture, tilted in depth so that perspective matters.
pub(super) fn tilted_square() -> [Vec4; 4] {
    let corner = |x: f32, y: f32, w: f32| Vec4::new(x * w, y * w, 0.5 * w, w);
    [corner(-1.0, -1.0, 1.0), corner(1.0, -1.0, 1.0), corner(1.0, 1.0, 3.0), corner(-1.0, 1.0, 3.0)]
}

/// A picture with detail everywhere: row after row of `[r, g, b, a]`.
pub(super) fn busy_pixels(side: u32) -> Vec<[f32; 4]> {
    let of = |i: u32| {
        let (x, y) = ((i % side) as f32, (i / side) as f32);
        let wave = |a: f32, b: f32| 0.5 + 0.5 * (a * x + b * y).sin();
        [wave(0.11, 0.07), wave(0.05, -0.13), wave(-0.031, 0.029), 1.0]
    };
    (0..side * side).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bumpy_sphere_is_as_large_as_said_and_faces_outwards() {
        let sphere = BumpySphere::new();
        assert_eq!(sphere.triangles.len() / 3, 69_696);
        let at = |i: usize| sphere.points[sphere.triangles[3 * 30_000 + i] as usize];
        assert!((at(1) - at(0)).cross(at(2) - at(0)).dot(at(0)) > 0.0);
        assert_eq!(sphere.obj().lines().count(), sphere.points.len() + 69_696);
    }
}
