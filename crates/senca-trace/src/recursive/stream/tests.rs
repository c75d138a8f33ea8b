//! The fast tracer against its plain twin.

use std::path::{Path, PathBuf};

use fearless_simd::Level;
use senca_math::{LinearRgb, View};
use senca_scene::{Background, Camera, Scene};

use super::Lamp;
use crate::recursive::{RecursiveSettings, Tracer, Work};
use crate::{Integrator, Pattern, SamplePlace, Sampler, TraceCounts, World};

/// Even by odd: no ray runs along the diagonals of the boxes among the samples, where walls meet and either
/// of two may be the one that is met.
const SIZE: [u32; 2] = [48, 35];

fn samples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples");
    let all = std::fs::read_dir(folder).expect("the samples").map(|e| e.expect("an entry").path());
    let mut scenes: Vec<_> = all.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    scenes.sort();
    scenes
}

/// The scene of a file, with light, and its view.
fn scene_of(path: &Path) -> Option<(Scene, View, Camera)> {
    let scene = senca_io::load(path).expect("a scene");
    let mut scene = scene.at_time(None, 0.0).into_owned();
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let found = scene
        .placed_cameras()
        .first()
        .map(|placed| (scene.cameras[placed.camera.index()].clone(), placed.world_from_camera));
    let (camera, world_from_camera) = found.unwrap_or_else(|| {
        let placed = scene.frame_all(aspect);
        (placed.camera, placed.world_from_camera)
    });
    if !scene.is_lit() {
        scene.light_by_default(&world_from_camera);
    }
    let view = camera.view(&world_from_camera, aspect, &scene.bounds()).ok()?;
    Some((scene, view, camera))
}

fn places() -> Vec<SamplePlace> {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let place = |(x, y)| SamplePlace {
        x: f64::from(x) + 0.5,
        y: f64::from(y) + 0.5,
        row: y,
        sampler: Sampler::new(Pattern::Sobol, 7, x, y, 0),
    };
    pixels.map(place).collect()
}

fn picture(tracer: &Tracer<'_>) -> (Vec<[f32; 4]>, TraceCounts) {
    let mut work = Work::default();
    let mut colors = Vec::new();
    tracer.sample_many(&places(), &mut work, &mut colors);
    (colors, work.counts)
}

/// How many pixels differ by more than rounding explains.
fn differing(a: &[[f32; 4]], b: &[[f32; 4]]) -> usize {
    let differs = |(a, b): &(&[f32; 4], &[f32; 4])| {
        (0..4).any(|k| (a[k] - b[k]).abs() > 2e-4 * a[k].abs().max(b[k].abs()).max(0.1))
    };
    a.iter().zip(b).filter(differs).count()
}

#[test]
fn all_samples_are_traced_as_by_the_plain_twin() {
    for path in samples() {
        let Some((scene, view, camera)) = scene_of(&path) else { continue };
        let world = World::new(&scene).expect("a world");
        let background = match scene.background {
            Background::None => Background::Color(LinearRgb::splat(0.2)),
            other => other,
        };
        for settings in [
            RecursiveSettings::default(),
            RecursiveSettings {
                backs: crate::recursive::Backs::Shown,
                transparent_shadows: true,
                adaptive_depth: 0.0,
                max_depth: 3,
                ..RecursiveSettings::default()
            },
        ] {
            let fast = Tracer::new(&world, &view, SIZE, background, &settings).with_lens(camera.lens);
            let plain = Tracer::new(&world, &view, SIZE, background, &settings).with_lens(camera.lens);
            let plain = plain.one_by_one();
            let ((fast_colors, fast_counts), (plain_colors, plain_counts)) =
                (picture(&fast), picture(&plain));
            let off = differing(&fast_colors, &plain_colors);
            // Edges of shadows and of texels may fall on either side of a pixel's middle.
            assert!(off <= 3, "{}: {off} pixels differ", path.display());
            let (fast, plain) = (fast_counts.rays, plain_counts.rays);
            assert_eq!(fast.primary, plain.primary, "{}", path.display());
            for (fast, plain) in [
                (fast.shadow, plain.shadow),
                (fast.reflected, plain.reflected),
                (fast.transmitted, plain.transmitted),
            ] {
                let off = fast.abs_diff(plain);
                assert!(off <= 8 + plain / 1000, "{}: {fast} rays, {plain}", path.display());
            }
        }
    }
}

/// The tracer of a sample scene that goes the fast way.
fn with_fast(name: &str, test: impl Fn(&mut Tracer<'_>)) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples").join(name);
    let (scene, view, _) = scene_of(&path).expect("a scene with a view");
    let world = World::new(&scene).expect("a world");
    let mut tracer = Tracer::new(&world, &view, SIZE, scene.background, &RecursiveSettings::default());
    assert!(tracer.stream.is_some(), "{name} goes the fast way");
    test(&mut tracer);
}

#[test]
fn every_simd_level_gives_the_same_bytes() {
    for name in ["mirrors.toml", "materials.toml", "texture.toml", "shadows.toml", "csg.toml"] {
        with_fast(name, |tracer| {
            let (best, counts) = picture(tracer);
            tracer.stream.as_mut().expect("the fast way").level = Level::baseline();
            assert!(picture(tracer) == (best, counts), "{name}");
        });
    }
}

#[test]
fn a_sample_does_not_depend_on_those_beside_it() {
    for name in ["mirrors.toml", "materials.toml", "glass.toml"] {
        with_fast(name, |tracer| {
            let (together, _) = picture(tracer);
            let (mut work, mut alone) = (Work::default(), Vec::new());
            for places in places().chunks(37) {
                tracer.sample_many(places, &mut work, &mut alone);
            }
            assert!(together == alone, "{name}");
        });
    }
}

#[test]
fn what_the_eye_and_the_lamps_see_of_balls_changes_nothing() {
    for name in ["mirrors.toml", "shadows.toml", "glass.toml"] {
        with_fast(name, |tracer| {
            let with_sights = picture(tracer);
            let stream = tracer.stream.as_mut().expect("the fast way");
            assert!(stream.eye.take().is_some(), "{name}");
            for lamp in &mut stream.lamps {
                if let Lamp::Simple(_, _, sight) = lamp {
                    *sight = None;
                }
            }
            assert!(picture(tracer) == with_sights, "{name}");
        });
    }
}
