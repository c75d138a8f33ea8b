//! The Cornell box against the path tracer.

use std::path::Path;

use rayon::prelude::*;
use senca_math::View;
use senca_math::glam::DVec3;
use senca_scene::{Background, Scene};
use senca_trace::path::{PathTracer, PathWork};
use senca_trace::{PathSettings, Pattern, PrimaryRays, SamplePlace, Sampler, World};

use super::*;
use crate::system::StopRule;

const SIZE: u32 = 24;
const SAMPLES: u32 = 100;

fn cornell() -> (Scene, View) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/cornell.toml");
    let scene = senca_io::load(&path).expect("the sample");
    let placed = &scene.placed_cameras()[0];
    let camera = &scene.cameras[placed.camera.index()];
    let view = camera.view(&placed.world_from_camera, 1.0, &scene.bounds()).expect("a view");
    (scene, view)
}

/// Whether a ray passes through the lamp, which is no surface of the mesh.
fn sees_lamp(ray: &senca_trace::Ray) -> bool {
    let at = ray.origin + ray.direction * ((0.99 - ray.origin.y) / ray.direction.y);
    ray.direction.y > 0.0 && at.x.abs() < 0.24 && (at.z - 0.01).abs() < 0.2
}

/// Pixels without the lamp: by paths, and by radiosity constant over elements, at the same places.
fn pictures(scene: &Scene, view: &View, solved: &Solved) -> Vec<[LinearRgb; 2]> {
    let world = World::new(scene).expect("a world");
    let settings = PathSettings::default();
    let tracer = PathTracer::new(&world, view, [SIZE; 2], Background::None, &settings);
    let solution = &solved.solution;
    let occluders = Occluders::new(&solution.mesh).expect("few");
    let rays = PrimaryRays::new(view, SIZE, SIZE);
    let pixel = |i: u32| {
        let (x, y) = (i % SIZE, i / SIZE);
        let mut work = PathWork::default();
        let mut sums = [LinearRgb::BLACK; 2];
        let mut lamp = false;
        for sample in 0..SAMPLES {
            let mut sampler = Sampler::new(Pattern::Sobol, 5, x, y, sample);
            let [u, v] = sampler.next_2d();
            let place = SamplePlace { x: f64::from(x) + u, y: f64::from(y) + v, row: y, sampler };
            let [r, g, b, _] = tracer.sample(&place, &mut work);
            sums[0] += LinearRgb::new(r, g, b);
            let ray = rays.through(place.x, place.y);
            lamp |= sees_lamp(&ray);
            let hit = occluders.closest(ray.origin, ray.direction).filter(|hit| hit.front);
            if let Some(hit) = hit {
                let place = ray.origin + ray.direction * hit.t;
                sums[1] += solution.radiosity(leaf_at(&solution.mesh, hit.polygon, place));
            }
        }
        (!lamp).then(|| sums.map(|sum| sum * (1.0 / SAMPLES as f32)))
    };
    (0..SIZE * SIZE).into_par_iter().filter_map(pixel).collect()
}

fn leaf_at(mesh: &ElementMesh, polygon: u32, place: DVec3) -> u32 {
    let mut element = polygon;
    loop {
        let distance = |part: &u32| mesh.elements()[*part as usize].center.distance(place);
        let parts = mesh.elements()[element as usize].part_numbers();
        match parts.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
            Some(part) => element = part,
            None => return element,
        }
    }
}

#[test]
fn the_box_looks_as_light_itself_would_have_it() {
    let (scene, view) = cornell();
    let settings = BookSettings {
        factors: FactorMethod::RayCast { rays: 16 },
        rounds: 1,
        stop: StopRule { tolerance: 1e-4, ..StopRule::default() },
        ..BookSettings::default()
    };
    let solved = solve(&scene, &settings, &Control::default(), |_| ()).expect("solved");
    assert!(solved.warnings.is_empty(), "{:?}", solved.warnings);
    assert!(solved.solution.report.converged && solved.solution.report.energy_error < 1e-3);
    let seen = pictures(&scene, &view, &solved);
    assert!(seen.len() as u32 > SIZE * SIZE * 9 / 10);
    for channel in 0..3 {
        let sum = |which: usize| seen.iter().map(|pair| pair[which].to_array()[channel]).sum::<f32>();
        let ratio = sum(1) / sum(0);
        assert!((ratio - 1.0).abs() < 0.02, "channel {channel}: {ratio}");
    }
    let mean = seen.iter().map(|pair| pair[0].g).sum::<f32>() / seen.len() as f32;
    let squares = seen.iter().map(|[path, radiosity]| (path.g - radiosity.g).powi(2)).sum::<f32>();
    let error = (squares / seen.len() as f32).sqrt() / mean;
    assert!(error < 0.1, "{error}");
}
