//! `senca lab 5`: the view transform both ways, and perspective.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca_classic::lab::programs::ViewProgram;
use senca_classic::lab::shading::Camera;
use senca_classic::lab::vectors::Row3;
use senca_classic::lab::view::{ViewScene, ViewTransform};
use serde_json::{Value, json};

use super::{CameraArguments, Failure, Shown, Source, json_rows, read_solid, row, rows};

/// What is seen, and from where.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// A solid to be seen, as OBJ or another model
    #[arg(long, value_name = "MODEL", value_hint = ValueHint::FilePath)]
    solid: Option<PathBuf>,

    /// Leaves the solid where its file says, instead of scaling it to [-1, 1]
    #[arg(long)]
    as_is: bool,

    #[command(flatten)]
    camera: CameraArguments,

    #[command(flatten)]
    shown: Shown,
}

/// The manual's eye, and a square.
const EXAMPLE: &str = "O 1 1 3  G 0 0 0  up 0 1 0  v -0.5 -0.5 0  v 0.5 -0.5 0  v 0.5 0.5 0  v -0.5 0.5 0";

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let wanted = "Lines 'O x y z', 'G x y z', 'up x y z' and 'v x y z' for the corners of a polygon";
    let mut scene = arguments.source.read(wanted, EXAMPLE, ViewScene::read)?;
    let mut solid = arguments.solid.as_deref().map(read_solid).transpose()?;
    if let (Some(read), false) = (&solid, arguments.as_is) {
        solid = Some(read.normalized()?);
    }
    if solid.is_some() && arguments.source.is_empty() {
        scene.polygon.clear();
    }
    let file = Camera { eye: scene.eye, target: scene.target, up: scene.up, ..Camera::default() };
    let camera = arguments.camera.camera(file);
    let view = camera.transform()?;
    let mut points = scene.polygon.clone();
    points.extend(solid.iter().flat_map(|s| s.vertices.iter().copied()));
    let (text, json) = report(&view, &points);
    arguments.shown.print(&text, &json)?;
    arguments.shown.present(&mut ViewProgram::new(scene.polygon, solid, camera), "lab-5")
}

fn report(view: &ViewTransform, points: &[Row3]) -> (String, Value) {
    let mut text = format!("H = {:.6}\n", view.distance);
    let mut steps = serde_json::Map::new();
    for (name, matrix) in &view.steps {
        text += &format!("{name}\n{}", rows(matrix));
        steps.insert((*name).to_owned(), json_rows(matrix));
    }
    text += &format!("T\n{}P\n{}", rows(&view.matrix), rows(&view.perspective()));
    text += "scene; xp, yp; zo\n";
    let mut projected = Vec::new();
    for &point in points {
        let seen = view.project(point);
        let flat = seen.map_or_else(|| "in the plane of the eye".to_owned(), |p| row(&[p.x, p.y, p.z]));
        text += &format!("  {}  ->  {flat}\n", row(&point));
        projected.push(json!({ "scene": point, "xp": seen.map(|p| p.x), "yp": seen.map(|p| p.y), "zo": view.eye_from_scene(point)[2] }));
    }
    let json = json!({
        "H": view.distance, "steps": steps, "T": json_rows(&view.matrix), "P": json_rows(&view.perspective()),
        "points": projected,
    });
    (text, json)
}
