//! The form factors of all patches of a scene.

use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use senca::math::Control;
use senca::radiosity::form_factor::{FormFactors, Method, MethodSettings, RowSums};
use senca::radiosity::{ElementMesh, MeshSettings, PatchPolygon, RadiosityError};
use serde::Serialize;

use super::Arguments;
use crate::cli::input::read_scene;
use crate::cli::{Failure, Interrupt, Progress, output};

/// Scenes with more patches than this show sums of rows alone.
const SHOWN: usize = 12;

/// A patch, for people and scripts.
#[derive(Debug, Serialize)]
struct Patch {
    object: u32,
    area: f64,
    center: [f64; 3],
    normal: [f64; 3],
}

/// The matrix by one method.
#[derive(Debug, Serialize)]
struct Matrix {
    method: &'static str,
    sees_obstacles: bool,
    seconds: f64,
    least_row_sum: f64,
    mean_row_sum: f64,
    greatest_row_sum: f64,
    reciprocity_error: f64,
    factors: Vec<Vec<f64>>,
}

#[derive(Debug, Serialize)]
struct Report {
    patches: Vec<Patch>,
    methods: Vec<Matrix>,
}

/// Prints the matrix of a scene by one method, or what all methods find.
pub(super) fn run(path: &Path, arguments: &Arguments, settings: &MethodSettings) -> Result<(), Failure> {
    let scene = read_scene(path)?;
    let name = path.display();
    // Not many more than a matrix may have: those that are divided count too.
    let max_elements = 2 * FormFactors::MAX_PATCHES;
    let mesh_settings =
        MeshSettings { patch_size: arguments.patch_size, max_elements, ..MeshSettings::default() };
    let refuse = |e: &dyn std::fmt::Display| Failure::input(format!("{name}: {e}"));
    let mesh = ElementMesh::of_scene(&scene, &mesh_settings).map_err(|e| refuse(&e))?;
    let leaves: Vec<u32> = mesh.leaves().collect();
    if leaves.is_empty() {
        return Err(refuse(&"there are no surfaces"));
    }
    let shapes: Vec<PatchPolygon> = leaves.iter().map(|&leaf| mesh.shape(leaf)).collect();
    let methods = arguments.method.map_or_else(|| Method::ALL.to_vec(), |method| vec![method]);
    let mut report =
        Report { patches: leaves.iter().map(|&leaf| patch(&mesh, leaf)).collect(), methods: vec![] };
    let interrupt = Interrupt::listen();
    for method in methods {
        let matrix = matrix(&shapes, method, settings, arguments, &interrupt);
        if interrupt.is_raised() {
            return Err(Failure::Interrupted);
        }
        report.methods.push(matrix.map_err(|e| refuse(&e))?);
    }
    output::print(&if arguments.json { json(&report)? } else { text(&report) })
}

fn patch(mesh: &ElementMesh, leaf: u32) -> Patch {
    let element = &mesh.elements()[leaf as usize];
    Patch {
        object: mesh.surface(leaf).instance,
        area: element.area,
        center: element.center.to_array(),
        normal: mesh.normal(leaf).to_array(),
    }
}

fn matrix(
    shapes: &[PatchPolygon],
    method: Method,
    settings: &MethodSettings,
    arguments: &Arguments,
    interrupt: &Interrupt,
) -> Result<Matrix, RadiosityError> {
    let progress = Progress::new(arguments.quiet);
    let report = |done: f32| progress.report(done);
    let control = Control { progress: Some(&report), cancel: Some(interrupt.flag()) };
    let start = Instant::now();
    let computed = FormFactors::compute(shapes, method, settings, &control);
    progress.finish();
    let mut factors = computed?;
    let seconds = start.elapsed().as_secs_f64();
    if arguments.normalize {
        factors.normalize_rows();
    }
    let none = RowSums { least: 0.0, greatest: 0.0, mean: 0.0, worst: 0 };
    let sums = factors.row_sums().unwrap_or(none);
    Ok(Matrix {
        method: method.name(),
        sees_obstacles: method.sees_obstacles(),
        seconds,
        least_row_sum: sums.least,
        mean_row_sum: sums.mean,
        greatest_row_sum: sums.greatest,
        reciprocity_error: factors.reciprocity_error(),
        factors: (0..factors.size()).map(|i| factors.row(i).to_vec()).collect(),
    })
}

fn json(report: &Report) -> Result<String, Failure> {
    Ok(serde_json::to_string(report).map_err(Failure::input)? + "\n")
}

// Writing to a string cannot fail, so that the results of `write!` are let go below.
fn text(report: &Report) -> String {
    let n = report.patches.len();
    let mut text = format!("{n} patches\n\n");
    if n <= SHOWN {
        push_patches(&mut text, &report.patches);
    }
    push_sums(&mut text, &report.methods);
    // Of all methods the matrix of the most exact with obstacles is shown.
    let shown = report.methods.iter().find(|m| m.method == Method::RayCast.name()).or(report.methods.first());
    match shown {
        Some(matrix) if n <= SHOWN => push_matrix(&mut text, matrix),
        _ => text += "\nThe factors themselves: --json.\n",
    }
    text
}

fn push_patches(text: &mut String, patches: &[Patch]) {
    let _ = writeln!(text, "{:>5}  {:>6}  {:>10}  {:<28}  normal", "patch", "object", "area", "center");
    for (k, patch) in patches.iter().enumerate() {
        let place = |p: [f64; 3]| p.map(|v| format!("{:.4}", v + 0.0)).join(" ");
        let (center, normal) = (place(patch.center), place(patch.normal));
        let _ = writeln!(text, "{k:>5}  {:>6}  {:>10.6}  {center:<28}  {normal}", patch.object, patch.area);
    }
    text.push('\n');
}

fn push_sums(text: &mut String, methods: &[Matrix]) {
    let _ = writeln!(
        text,
        "{:<12} {:>12} {:>12} {:>12} {:>12} {:>10}",
        "row sums", "least", "mean", "greatest", "reciprocity", "ms"
    );
    for m in methods {
        let _ = writeln!(
            text,
            "{:<12} {:>12.8} {:>12.8} {:>12.8} {:>12.1e} {:>10.3}",
            m.method,
            m.least_row_sum,
            m.mean_row_sum,
            m.greatest_row_sum,
            m.reciprocity_error,
            1e3 * m.seconds
        );
    }
    if methods.iter().any(|m| !m.sees_obstacles) {
        *text += "exact and contour do not see obstacles\n";
    }
}

fn push_matrix(text: &mut String, matrix: &Matrix) {
    let _ = writeln!(text, "\n{}: from the patch of the row to that of the column", matrix.method);
    let heads = (0..matrix.factors.len()).map(|k| format!("{k:>9}"));
    let _ = writeln!(text, "{:>5}{}", "", heads.collect::<String>());
    for (k, row) in matrix.factors.iter().enumerate() {
        let numbers = row.iter().map(|f| format!(" {f:>8.6}"));
        let _ = writeln!(text, "{k:>5}{}", numbers.collect::<String>());
    }
}
