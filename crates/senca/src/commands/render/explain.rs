//! `senca render --pixel X,Y --explain`: all rays of one pixel.

use std::borrow::Cow;
use std::path::Path;

use senca::math::LinearRgb;
use senca::math::glam::DVec3;
use senca::trace::recursive::RayKind;
use senca::trace::tree::{Meeting, PixelTrees, RayEnd, RayNode, Shadow};
use senca::{Error, Scene, Settings, explain_pixel};
use serde_json::{Value, json};

use crate::cli::output::is_standard;
use crate::cli::values::Pixel;
use crate::cli::{Failure, Interrupt, output};

/// How an explanation is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Text,
    Svg,
    Dot,
    Json,
}

/// The form that a file name asks for.
fn form_of(path: &Path) -> Result<Form, Failure> {
    if is_standard(path) {
        return Ok(Form::Text);
    }
    match path.extension().and_then(|e| e.to_str()) {
        Some("txt") => Ok(Form::Text),
        Some("svg") => Ok(Form::Svg),
        Some("dot" | "gv") => Ok(Form::Dot),
        Some("json") => Ok(Form::Json),
        _ => Err(Failure::usage(format!(
            "{}: an explanation is written as .txt, .svg, .dot or .json",
            path.display()
        ))),
    }
}

/// Finds out before the work whether the explanation can be written.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    form_of(path)?;
    output::check_writable(path)
}

/// Explains `pixel` and writes it to `path`.
pub(super) fn run(
    scene: Scene,
    settings: &Settings,
    pixel: Pixel,
    path: &Path,
    interrupt: &Interrupt,
    failure: impl Fn(&Error) -> Failure,
) -> Result<(), Failure> {
    let form = form_of(path)?;
    let explained = explain_pixel(Cow::Owned(scene), settings, [pixel.x, pixel.y]);
    let explained = explained.map_err(|error| failure(&error))?;
    let text = match form {
        Form::Text => explained.trees.to_text(),
        Form::Svg => explained.svg,
        Form::Dot => explained.trees.to_dot(),
        Form::Json => {
            let mut text =
                serde_json::to_string_pretty(&json_of(&explained.trees)).map_err(Failure::input)?;
            text.push('\n');
            text
        }
    };
    if is_standard(path) {
        return output::print(&text);
    }
    output::write(path, text.as_bytes(), interrupt)
}

fn json_of(trees: &PixelTrees) -> Value {
    let rays = &trees.counts.rays;
    let samples: Vec<Value> = trees
        .trees
        .iter()
        .map(|tree| {
            json!({
                "place": tree.place,
                "color": tree.color,
                "rays": tree.rays.iter().map(ray).collect::<Vec<_>>(),
                "cut": tree.cut,
            })
        })
        .collect();
    json!({
        "pixel": trees.pixel,
        "size": trees.size,
        "color": trees.color,
        "rays": {
            "primary": rays.primary,
            "shadow": rays.shadow,
            "reflected": rays.reflected,
            "transmitted": rays.transmitted,
        },
        "samples": samples,
    })
}

fn ray(ray: &RayNode) -> Value {
    let kind = match ray.kind {
        RayKind::Primary => "primary",
        RayKind::Reflected => "reflected",
        RayKind::Transmitted => "transmitted",
        RayKind::SeenThrough => "seen-through",
    };
    let hit = match &ray.end {
        RayEnd::Left { .. } => Value::Null,
        RayEnd::Met(m) => meeting(m),
    };
    json!({
        "parent": ray.parent,
        "kind": kind,
        "level": ray.nest,
        "origin": vector(ray.origin),
        "direction": vector(ray.direction),
        "share": rgb(ray.weight),
        "hit": hit,
        "adds": rgb(ray.contribution()),
    })
}

fn meeting(m: &Meeting) -> Value {
    json!({
        "object": m.object_name,
        "material": m.material_name,
        "t": m.t,
        "point": vector(m.point),
        "normal": vector(m.normal),
        "from_outside": m.entering,
        "k_r": rgb(m.mirror),
        "k_t": rgb(m.transmission),
        "ior": m.ior,
        "coverage": m.coverage,
        "local": rgb(m.local),
        "share": rgb(m.weight),
        "fog": rgb(m.fog),
        "too_deep": m.too_deep,
        "negligible": m.negligible,
        "lights": m.shadows.iter().map(shadow).collect::<Vec<_>>(),
    })
}

fn shadow(s: &Shadow) -> Value {
    json!({
        "light": s.light_name,
        "to": vector(s.to_light),
        "parallel": s.parallel,
        "visible": rgb(s.share),
        "adds": rgb(s.reflected),
        "blocked_by": s.blocker.as_ref().map(|(name, _)| name),
        "blocked_at": s.blocker.as_ref().map(|(_, place)| vector(*place)),
    })
}

fn rgb(color: LinearRgb) -> [f32; 3] {
    color.to_array()
}

fn vector(v: DVec3) -> [f64; 3] {
    v.to_array()
}
