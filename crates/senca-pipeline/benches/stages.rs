//! Times of the stages of the pipeline, on a torus of 20 000 triangles or more.

use divan::{Bencher, black_box};
use senca_math::glam::DVec3;
use senca_math::{DeviceMap, Image, LinearRgb, View};
use senca_pipeline::stages::{
    ClipByVolume, Divide, LightVertices, Project, RejectBacks, Stage, ToDevice, Triangle,
    canonical_from_world, tessellate,
};
use senca_pipeline::{Settings, Shading, hidden_line_segments, render, wire_segments};
use senca_scene::{Scene, Shape, TessellationSettings, Tolerance};
use senca_shading::{LightRig, PhongConstants};

const WIDTH: u32 = 1024;
const HEIGHT: u32 = 768;

fn main() {
    divan::main();
}

fn view() -> View {
    let eye = DVec3::new(1.0, 2.5, 4.0);
    let world_from_camera = View::look_at(eye, DVec3::ZERO, DVec3::Y).expect("regular");
    View::perspective(&world_from_camera, 0.6, f64::from(WIDTH) / f64::from(HEIGHT), 0.5, Some(20.0))
        .expect("regular")
}

/// A torus as a mesh of 2 x 150 x 230 = 69 000 triangles, as many as the bunny has, lit by default.
fn torus() -> Scene {
    let shape = Shape::Torus { major_radius: 1.0, minor_radius: 0.4 };
    let settings = TessellationSettings { tolerance: Tolerance::Steps(230, 150), ..Default::default() };
    let mesh = senca_scene::tessellate(&shape, &settings).expect("a torus").into_owned();
    let mut scene = Scene::of_shape("torus", Shape::Mesh(mesh));
    let eye = DVec3::new(1.0, 2.5, 4.0);
    scene.light_by_default(&View::look_at(eye, DVec3::ZERO, DVec3::Y).expect("regular"));
    scene
}

/// The whole way of a picture.
#[divan::bench(args = [Shading::Flat, Shading::Gouraud, Shading::Phong, Shading::Material])]
fn picture(bencher: Bencher<'_, '_>, shading: Shading) {
    let (scene, view) = (torus(), view());
    let settings = Settings { shading, ..Settings::default() };
    let mut image = Image::new(WIDTH, HEIGHT, [0.0; 4]);
    bencher.bench_local(|| render(&scene, &view, &settings, &mut image).expect("draws"));
}

/// The same by threads.
#[divan::bench(args = [1, 2])]
fn threads(bencher: Bencher<'_, '_>, threads: usize) {
    let (scene, view) = (torus(), view());
    let settings = Settings { shading: Shading::Phong, threads, ..Settings::default() };
    let mut image = Image::new(WIDTH, HEIGHT, [0.0; 4]);
    bencher.bench_local(|| render(&scene, &view, &settings, &mut image).expect("draws"));
}

#[divan::bench]
fn wire(bencher: Bencher<'_, '_>) {
    let (scene, view) = (torus(), view());
    let settings = Settings { shading: Shading::Wire, ..Settings::default() };
    bencher.bench_local(|| wire_segments(&scene, &view, &settings, WIDTH, HEIGHT).expect("draws"));
}

#[divan::bench]
fn hidden_lines(bencher: Bencher<'_, '_>) {
    let (scene, view) = (torus(), view());
    let settings = Settings { shading: Shading::HiddenLine, ..Settings::default() };
    bencher.bench_local(|| hidden_line_segments(&scene, &view, &settings, WIDTH, HEIGHT).expect("draws"));
}

/// Each stage of the textbook pipeline, on the list that reaches it.
#[divan::bench(args = 0..6)]
fn textbook_stage(bencher: Bencher<'_, '_>, stage: usize) {
    let (scene, view) = (torus(), view());
    let stages: Vec<Box<dyn Stage>> = vec![
        Box::new(RejectBacks { view: view.kind }),
        Box::new(LightVertices {
            rig: LightRig::of_scene(&scene),
            materials: vec![PhongConstants::matte(LinearRgb::WHITE)],
            view: view.kind,
        }),
        Box::new(Project { canonical_from_world: canonical_from_world(&view) }),
        Box::new(ClipByVolume),
        Box::new(Divide),
        Box::new(ToDevice { map: DeviceMap::to_pixels(WIDTH, HEIGHT).expect("regular") }),
    ];
    let first: Vec<Triangle> = tessellate(&scene, &view, (WIDTH, HEIGHT), 0.25).expect("tessellates");
    let list = stages[..stage].iter().fold(first, |list, s| s.run(list));
    bencher.with_inputs(|| list.clone()).bench_local_values(|list| black_box(stages[stage].run(list)));
}
