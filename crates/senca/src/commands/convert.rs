//! `senca convert`: a model or a picture into another format.

use std::path::{Path, PathBuf};

use clap::{Args, ValueHint};
use senca::io::gltf::{WriteSettings, write_glb, write_gltf};
use senca::io::images::{PictureFormat, PictureOptions, decode_picture, encode};
use senca::io::{Format as Content, Limits, classic, combined_mesh, combined_patches, detect, obj, ply, stl};
use senca::scene::{
    BezierPatch, PatchConversion, Scene, Shape, TessellationSettings, Tolerance, Warning, patch_to_polygons,
};

use crate::cli::input::{read_bytes, read_scene};
use crate::cli::output::{self, check_writable, is_standard, tell};
use crate::cli::values::{not_negative, positive, steps};
use crate::cli::{Failure, Interrupt};

/// From what to what, and how.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene, model or picture, told by its content; - is standard input
    #[arg(value_name = "IN", value_hint = ValueHint::FilePath)]
    input: PathBuf,

    /// Model: .glb .gltf .obj .stl .ply, or .dat and .bez for the object and patch files of 1991; from a
    /// picture: .png .exr .pfm .ppm .jpg .bmp; - is standard output
    #[arg(value_name = "OUT", value_hint = ValueHint::FilePath)]
    output: PathBuf,

    /// Format, in place of the one the extension of OUT names
    #[arg(long, value_name = "FORMAT")]
    format: Option<String>,

    /// Steps that each curved patch is divided into [default: as the tolerance asks; 4,4 for .dat]
    #[arg(long, value_name = "U,V", value_parser = steps)]
    steps: Option<[u32; 2]>,

    /// How far polygons may be from curved shapes, in world units [default: 1/1000 of the scene's size]
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    tolerance: Option<f64>,

    /// Divides patches as the converter of 1991: vertices nearer than this share of a step are one
    /// [default for .dat: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = not_negative)]
    epsilon: Option<f64>,

    /// As --epsilon, and the very first vertex is never compared, as in the printed program
    #[arg(long)]
    as_printed: bool,

    /// Writes STL and PLY as text
    #[arg(long, conflicts_with = "binary")]
    ascii: bool,

    /// Writes STL and PLY in binary; this is the default
    #[arg(long)]
    binary: bool,

    /// No warnings
    #[arg(long, short)]
    quiet: bool,
}

/// Formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Glb,
    Gltf,
    Obj,
    Stl,
    Ply,
    Object1991,
    Patches1991,
    Picture(PictureFormat),
}

/// Extensions of model formats.
const MODELS: [(&str, Format); 7] = [
    ("glb", Format::Glb),
    ("gltf", Format::Gltf),
    ("obj", Format::Obj),
    ("stl", Format::Stl),
    ("ply", Format::Ply),
    ("dat", Format::Object1991),
    ("bez", Format::Patches1991),
];

/// A file in the making, with those beside it and what it cannot hold.
#[derive(Default)]
struct Files {
    main: Vec<u8>,
    beside: Vec<(String, Vec<u8>)>,
    warnings: Vec<Warning>,
}

/// Converts the file.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let format = format(arguments)?;
    check_writable(&arguments.output)?;
    let interrupt = Interrupt::listen();
    let files = match format {
        Format::Picture(format) => picture(&arguments.input, format)?,
        _ => model(arguments, format)?,
    };
    let folder = arguments.output.parent().unwrap_or(Path::new(""));
    for (name, bytes) in files.beside.iter().filter(|_| !is_standard(&arguments.output)) {
        output::write(&folder.join(name), bytes, &interrupt)?;
    }
    output::write(&arguments.output, &files.main, &interrupt)?;
    for warning in files.warnings.iter().filter(|_| !arguments.quiet) {
        tell(&format!("senca: {}: warning: {}", arguments.output.display(), warning.0));
    }
    Ok(())
}

fn format(arguments: &Arguments) -> Result<Format, Failure> {
    let extension = arguments.output.extension().map(|e| e.to_string_lossy().into_owned());
    let Some(name) = arguments.format.clone().or(extension).map(|n| n.to_ascii_lowercase()) else {
        return Err(unknown(&format!("{} has no extension; it", arguments.output.display())));
    };
    let model = MODELS.iter().find(|m| m.0 == name).map(|m| m.1);
    let picture = || PictureFormat::from_extension(&name).map(Format::Picture);
    model.or_else(picture).ok_or_else(|| unknown(&format!("\"{name}\"")))
}

fn unknown(what: &str) -> Failure {
    let models = MODELS.iter().map(|m| m.0);
    let known: Vec<_> = models.chain(PictureFormat::ALL.iter().map(|f| f.extension())).collect();
    Failure::usage(format!("{what} names no format that is written; there are: {}", known.join(", ")))
}

fn picture(input: &Path, format: PictureFormat) -> Result<Files, Failure> {
    let (name, bytes) = read_bytes(input)?;
    if detect(&bytes, None).is_some_and(|content| content != Content::Picture) {
        let message = "is a scene or a model; 'senca render' makes a picture of it";
        return Err(Failure::input(format!("{name}: {message}")));
    }
    let picture = decode_picture(&name, &bytes, &Limits::default())?;
    Ok(Files { main: encode(&picture, format, &PictureOptions::default())?, ..Files::default() })
}

fn model(arguments: &Arguments, format: Format) -> Result<Files, Failure> {
    let mut scene = read_scene(&arguments.input)?;
    let name = arguments.input.display();
    let by_1991 = format == Format::Object1991 || arguments.epsilon.is_some() || arguments.as_printed;
    if by_1991 {
        convert_patches(&mut scene, arguments).map_err(|m| Failure::input(format!("{name}: {m}")))?;
    }
    let mut files = encoded(&scene, format, arguments).map_err(|failure| match failure {
        Failure::Input(message) => Failure::Input(format!("{name}: {message}")),
        other => other,
    })?;
    let mut warnings = std::mem::take(&mut scene.warnings);
    warnings.append(&mut files.warnings);
    Ok(Files { warnings, ..files })
}

/// Puts the polygons of the converter of 1991 in the place of patches.
fn convert_patches(scene: &mut Scene, arguments: &Arguments) -> Result<(), String> {
    let standard = PatchConversion::default();
    let settings = PatchConversion {
        steps: arguments.steps.unwrap_or(standard.steps),
        epsilon: arguments.epsilon.unwrap_or(standard.epsilon),
        as_printed: arguments.as_printed,
        ..standard
    };
    for geometry in &mut scene.geometries {
        if let Shape::BezierPatches { patches } = &geometry.shape {
            let patches: &[BezierPatch] = patches;
            let mesh = patch_to_polygons(patches, &settings).map_err(|e| e.to_string())?;
            geometry.shape = Shape::Mesh(mesh);
        }
    }
    Ok(())
}

fn encoded(scene: &Scene, format: Format, arguments: &Arguments) -> Result<Files, Failure> {
    let settings = tessellation(scene, arguments);
    let only = |main| Files { main, ..Files::default() };
    Ok(match format {
        Format::Glb | Format::Gltf => gltf(scene, format, settings)?,
        Format::Obj => obj_files(scene, &arguments.output, &settings)?,
        Format::Stl if arguments.ascii => only(stl::write(scene, stl::StlEncoding::Text, &settings)?),
        Format::Stl => only(stl::write(scene, stl::StlEncoding::Binary, &settings)?),
        Format::Ply if arguments.ascii => only(ply::write(scene, ply::PlyEncoding::Text, &settings)?),
        Format::Ply => only(ply::write(scene, ply::PlyEncoding::LittleEndian, &settings)?),
        Format::Patches1991 => only(classic::write_patches(&combined_patches(scene)?)?),
        Format::Object1991 | Format::Picture(_) => {
            only(classic::write_object(&combined_mesh(scene, &settings)?)?)
        }
    })
}

fn gltf(scene: &Scene, format: Format, tessellation: TessellationSettings) -> Result<Files, Failure> {
    let write = if format == Format::Glb { write_glb } else { write_gltf };
    let mut warnings = Vec::new();
    let main = write(scene, &WriteSettings { tessellation }, &mut warnings)?;
    Ok(Files { main, warnings, ..Files::default() })
}

/// An OBJ file, with its materials and pictures beside it.
fn obj_files(scene: &Scene, path: &Path, settings: &TessellationSettings) -> Result<Files, Failure> {
    let stem = path.file_stem().map_or_else(|| "model".into(), |s| s.to_string_lossy());
    let written = obj::write(scene, &stem, settings)?;
    let mut beside = written.pictures;
    beside.extend(written.mtl.map(|mtl| (format!("{stem}.mtl"), mtl)));
    Ok(Files { main: written.obj, beside, warnings: written.warnings })
}

fn tessellation(scene: &Scene, arguments: &Arguments) -> TessellationSettings {
    let size = scene.bounds().diagonal();
    let tolerance = match (arguments.steps, arguments.tolerance) {
        (Some([u, v]), _) => Tolerance::Steps(u, v),
        (None, Some(length)) => Tolerance::World(length),
        (None, None) => Tolerance::World(if size > 0.0 { 1e-3 * size } else { 1e-3 }),
    };
    TessellationSettings { tolerance, ..TessellationSettings::default() }
}
