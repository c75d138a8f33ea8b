//! `senca info`: what is in a scene or a model.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::math::Aabb;
use senca::scene::{Scene, Shape, TessellationSettings, Tolerance, Topology, tessellate};
use serde::Serialize;

use crate::cli::input::read_scene;
use crate::cli::{Failure, output};

/// Which file, and how it is told.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene or model, told by its content; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    scene: PathBuf,

    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Curved shapes are counted as they are tessellated within this share of their own size.
const TOLERANCE: f64 = 1e-3;

/// What is in a scene.
#[derive(Debug, Serialize)]
struct Info {
    name: String,
    /// Different geometries that are placed.
    meshes: usize,
    /// Geometries placed.
    instances: usize,
    /// Triangles of all instances.
    triangles: usize,
    /// Points of all instances.
    vertices: usize,
    /// Smallest and largest corner; `None` when nothing is there.
    bounds: Option<[[f64; 3]; 2]>,
    materials: usize,
    textures: usize,
    lights: usize,
    /// Names.
    cameras: Vec<String>,
    animations: usize,
    animation_names: Vec<String>,
    /// Whether there is a mesh and each is closed.
    closed: bool,
    warnings: Vec<String>,
}

/// What one geometry has.
#[derive(Clone, Copy)]
struct Counts {
    triangles: usize,
    vertices: usize,
    closed: bool,
}

/// Tells what is in the scene.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scene = read_scene(&arguments.scene)?;
    let info = info(&scene).map_err(|m| Failure::input(format!("{}: {m}", arguments.scene.display())))?;
    if arguments.json {
        let text = serde_json::to_string_pretty(&info).map_err(Failure::input)?;
        return output::print(&format!("{text}\n"));
    }
    output::print(&text(&info))
}

fn info(scene: &Scene) -> Result<Info, String> {
    let mut counts = vec![None; scene.geometries.len()];
    let instances = scene.instances();
    let (mut triangles, mut vertices, mut closed) = (0, 0, !instances.is_empty());
    for instance in &instances {
        let known = &mut counts[instance.geometry.index()];
        let shape = &scene.geometries[instance.geometry.index()].shape;
        let of_shape = match *known {
            Some(of_shape) => of_shape,
            None => *known.insert(count(shape)?),
        };
        triangles += of_shape.triangles;
        vertices += of_shape.vertices;
        closed &= of_shape.closed;
    }
    let animation_names: Vec<_> = scene.animations.iter().map(|a| a.name.clone()).collect();
    Ok(Info {
        name: scene.name.clone(),
        meshes: counts.iter().flatten().count(),
        instances: instances.len(),
        triangles,
        vertices,
        bounds: corners(&scene.bounds()),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        lights: scene.lights.len(),
        cameras: scene.placed_cameras().into_iter().map(|c| c.name).collect(),
        animations: animation_names.len(),
        animation_names,
        closed,
        warnings: scene.warnings.iter().map(|w| w.0.clone()).collect(),
    })
}

fn count(shape: &Shape) -> Result<Counts, String> {
    let size = shape.bounds().diagonal();
    let tolerance = Tolerance::World(if size > 0.0 { TOLERANCE * size } else { TOLERANCE });
    let settings = TessellationSettings { tolerance, ..TessellationSettings::default() };
    let mesh = tessellate(shape, &settings).map_err(|e| e.to_string())?;
    Ok(Counts {
        triangles: mesh.faces.triangle_count(),
        vertices: mesh.points.len(),
        closed: !mesh.faces.is_empty() && Topology::new(&mesh).is_closed(),
    })
}

fn corners(bounds: &Aabb) -> Option<[[f64; 3]; 2]> {
    (!bounds.is_empty()).then(|| [bounds.min, bounds.max].map(|c| c.to_array()))
}

fn text(info: &Info) -> String {
    let list = |names: &[String]| names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ");
    let point =
        |p: [f64; 3]| p.map(|v| format!("{v:.6}").trim_end_matches('0').trim_end_matches('.').to_owned());
    let mut rows = vec![
        ("meshes", info.meshes.to_string()),
        ("instances", info.instances.to_string()),
        ("triangles", info.triangles.to_string()),
        ("vertices", info.vertices.to_string()),
        ("closed", if info.closed { "yes" } else { "no" }.to_owned()),
        ("materials", info.materials.to_string()),
        ("textures", info.textures.to_string()),
        ("lights", info.lights.to_string()),
        ("cameras", format!("{} {}", info.cameras.len(), list(&info.cameras))),
        ("animations", format!("{} {}", info.animations, list(&info.animation_names))),
    ];
    if !info.name.is_empty() {
        rows.insert(0, ("name", info.name.clone()));
    }
    if let Some([min, max]) = info.bounds {
        rows.push(("bounds", format!("{} to {}", point(min).join(" "), point(max).join(" "))));
    }
    rows.extend(info.warnings.iter().map(|w| ("warning", w.clone())));
    rows.iter().map(|(key, value)| format!("{key:<11}{}\n", value.trim_end())).collect()
}
