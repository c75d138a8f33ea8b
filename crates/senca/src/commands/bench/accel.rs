//! `senca bench accel`: the accelerators of the ray tracer beside each other.
//!
//! M equal spheres lie evenly spread in a cube, and the rays of one picture go through it. The table has
//! the counts that the theory speaks of: without help a ray is tested against all M; a grid with n cells
//! along each axis leaves of the order of M / n^2.

use std::fmt::Write;

use senca::math::glam::{DMat4, DVec3};
use senca::math::{Aabb, View};
use senca::scene::{Geometry, GeometryId, Node, NodeId, Scene, Shape, Transform};
use senca::trace::accel::{Comparison, compare};
use senca::trace::{Accel, AccelSettings, PrimaryRays, Ray, WorldSettings};
use serde::Serialize;

use super::significant;
use crate::cli::{Failure, Interrupt, Progress, output};

/// Rays along each side of the picture.
const SIDE: u32 = 64;
/// Share of the cube that the spheres fill.
const FILLED: f64 = 0.05;
/// Spheres that a group of the scene's tree may hold without being divided.
const GROUP: usize = 8;

/// A row of the table.
#[derive(Debug, Serialize)]
struct Row {
    objects: u32,
    accel: &'static str,
    build_seconds: f64,
    seconds: f64,
    rays: usize,
    tests_per_ray: f64,
    nodes_per_ray: f64,
    cells_per_ray: f64,
    /// M / n^2, for the grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    estimated_tests: Option<f64>,
    /// Time without acceleration over time with it.
    speedup: f64,
    memory_bytes: usize,
}

/// Compares on each of the numbers of objects and prints the table.
pub(super) fn run(objects: &[u32], json: bool, quiet: bool) -> Result<(), Failure> {
    let interrupt = Interrupt::listen();
    let progress = Progress::new(quiet);
    let mut rows = Vec::new();
    for (i, &count) in objects.iter().enumerate() {
        let scene = spheres(count);
        let rays = rays()?;
        let mut plain: Option<Comparison> = None;
        for (j, accel) in Accel::ALL.into_iter().enumerate() {
            progress.report((i as f32 + j as f32 / Accel::ALL.len() as f32) / objects.len() as f32);
            if interrupt.is_raised() {
                return Err(Failure::Interrupted);
            }
            let found = compare(&scene, &settings(accel, count), &rays).map_err(Failure::input)?;
            let plain = plain.get_or_insert_with(|| found.clone());
            if found.nearest != plain.nearest {
                return Err(Failure::input(format!("{accel} found other hits than {}", plain.accel)));
            }
            rows.push(row(count, &found, plain));
        }
    }
    progress.finish();
    output::print(&if json { in_json(&rows) } else { table(&rows) })
}

fn settings(accel: Accel, count: u32) -> WorldSettings {
    let accel = AccelSettings { grid_cells: Some(grid_cells(count)), ..accel.into() };
    WorldSettings { accel, ..WorldSettings::default() }
}

/// n: about two cells for each sphere.
fn grid_cells(count: u32) -> u32 {
    ((2.0 * f64::from(count)).cbrt().round() as u32).clamp(1, 256)
}

fn row(objects: u32, found: &Comparison, plain: &Comparison) -> Row {
    let n = f64::from(grid_cells(objects));
    let counters = &found.counters;
    Row {
        objects,
        accel: found.accel.name(),
        build_seconds: found.build_seconds,
        seconds: found.seconds,
        rays: found.rays,
        tests_per_ray: found.per_ray(counters.tests),
        nodes_per_ray: found.per_ray(counters.nodes),
        cells_per_ray: found.per_ray(counters.cells),
        estimated_tests: (found.accel == Accel::Grid).then(|| f64::from(objects) / (n * n)),
        speedup: plain.seconds / found.seconds,
        memory_bytes: found.memory_bytes,
    }
}

fn in_json(rows: &[Row]) -> String {
    let mut text = serde_json::to_string_pretty(rows).unwrap_or_default();
    text.push('\n');
    text
}

fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:>8}  {:<10}{:>10}{:>11}{:>9}{:>11}{:>11}{:>12}{:>12}\n",
        "M", "", "build ms", "tests/ray", "M/n^2", "nodes/ray", "cells/ray", "ns/ray", "speed-up"
    );
    for row in rows {
        let counted = |v: f64| if v == 0.0 { "-".to_owned() } else { significant(v) };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:>8}  {:<10}{:>10}{:>11}{:>9}{:>11}{:>11}{:>12}{:>12}",
            row.objects,
            row.accel,
            significant(1e3 * row.build_seconds),
            counted(row.tests_per_ray),
            row.estimated_tests.map_or_else(|| "-".to_owned(), significant),
            counted(row.nodes_per_ray),
            counted(row.cells_per_ray),
            significant(1e9 * row.seconds / row.rays as f64),
            format!("{} x", significant(row.speedup)),
        );
    }
    text
}

/// Rays of a picture of the cube, from a corner of it.
fn rays() -> Result<Vec<Ray>, Failure> {
    let world_from_camera =
        View::look_at(DVec3::new(1.3, 1.6, 2.2), DVec3::splat(0.5), DVec3::Y).map_err(Failure::input)?;
    let view = View::perspective(&world_from_camera, 0.7, 1.0, 0.1, None).map_err(Failure::input)?;
    let primary = PrimaryRays::new(&view, SIDE, SIDE);
    let through = |i: u32| primary.through(f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5);
    Ok((0..SIDE * SIDE).map(through).collect())
}

/// `count` spheres in the unit cube, grouped by halves of it.
fn spheres(count: u32) -> Scene {
    let radius = (FILLED / f64::from(count) * 0.75 / std::f64::consts::PI).cbrt();
    let mut scene = Scene::default();
    scene.add_geometry(Geometry {
        name: "sphere".to_owned(),
        shape: Shape::Sphere { radius },
        material: None,
    });
    let mut places: Vec<DVec3> = (0..count).map(spread).collect();
    let root = group(&mut scene, &mut places);
    scene.roots.push(root);
    scene
}

/// The i-th point of a sequence that fills the unit cube evenly (Roberts 2018).
fn spread(i: u32) -> DVec3 {
    /// The root of x^4 = x + 1.
    const G: f64 = 1.220_744_084_605_759_5;
    let share = DVec3::new(1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G));
    (0.5 + f64::from(i) * share).fract()
}

/// A node with spheres at `places` below it, halved across the longest side while there are many.
fn group(scene: &mut Scene, places: &mut [DVec3]) -> NodeId {
    let children = if places.len() <= GROUP {
        places.iter().map(|&place| sphere(scene, place)).collect()
    } else {
        let size = Aabb::of_points(places.iter().copied()).size();
        let axis = (0..3).fold(0, |a, b| if size[b] > size[a] { b } else { a });
        let middle = places.len() / 2;
        places.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
        let (low, high) = places.split_at_mut(middle);
        vec![group(scene, low), group(scene, high)]
    };
    scene.add_node(Node { children, ..Node::default() })
}

fn sphere(scene: &mut Scene, place: DVec3) -> NodeId {
    let transform = Transform::Matrix(DMat4::from_translation(place));
    scene.add_node(Node { geometry: Some(GeometryId(0)), transform, ..Node::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_the_counts_that_theory_gives() {
        let count = 200;
        let (scene, rays) = (spheres(count), rays().expect("rays"));
        let of = |accel| compare(&scene, &settings(accel, count), &rays).expect("in range");
        let none = of(Accel::None);
        assert_eq!(none.per_ray(none.counters.tests), 200.0);
        let hits = none.nearest.iter().flatten().count();
        assert!(hits > rays.len() / 10, "{hits} of {}", rays.len());
        for accel in Accel::ALL {
            let found = of(accel);
            assert_eq!(found.nearest, none.nearest, "{accel}");
            let row = row(count, &found, &none);
            assert!(accel == Accel::None || row.tests_per_ray < 20.0, "{row:?}");
        }
        let grid = row(count, &of(Accel::Grid), &none);
        let estimate = grid.estimated_tests.expect("for the grid");
        assert!(grid.tests_per_ray < 5.0 * estimate, "{grid:?}");
    }

    #[test]
    fn all_spheres_are_placed_once_in_the_cube() {
        let scene = spheres(100);
        let instances = scene.instances();
        assert_eq!(instances.len(), 100);
        for instance in instances {
            let place = instance.world_from_object.w_axis.truncate();
            assert!(place.cmpge(DVec3::ZERO).all() && place.cmplt(DVec3::ONE).all());
        }
    }
}
