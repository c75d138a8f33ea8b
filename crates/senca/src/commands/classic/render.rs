//! `senca classic render`: the renderer of 1991.

use std::path::{Component, Path, PathBuf};

use clap::{Args, ValueEnum, ValueHint};
use senca::classic::thesis::{
    BuildAlgorithm, Database, LutEditor, LutWindow, NormalsDrawn, Ranges, RenderSettings, Rendering,
    ThesisError, object_text, packed_size, paint, render, scene_text, transfer_seconds,
};
use senca::io::Directory;
use senca::io::classic::{ClassicScene, IndexBitmap, IntegerWidth};
use serde_json::json;

use super::colors::{Bits, ColorArguments, DiskFiles, write_picture};
use crate::cli::input::read_bytes;
use crate::cli::interactive::{self, InteractiveArguments};
use crate::cli::output::{self, check_writable, print, tell};
use crate::cli::values::{Size, positive};
use crate::cli::{Failure, Interrupt};

/// What is drawn, and what is written.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Scene file; its object files stand beside it
    #[arg(value_name = "SCENE", default_value = "scene1.dat", value_hint = ValueHint::FilePath)]
    scene: PathBuf,

    /// Picture in the colours of the palette or profile
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Bitmap of colour indices [default: the name in the scene file, in the current folder, when there
    /// is no --output]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    bitmap: Option<PathBuf>,

    /// Picture of the edges alone, which are drawn before any faces
    #[arg(long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    wire: Option<PathBuf>,

    #[command(flatten)]
    colors: ColorArguments,

    /// Operation in place of the scene file's, where that has a light
    #[arg(long, value_enum)]
    operation: Option<Operation>,

    /// After Phong, shades only polygons that can have a cosine from this one on after Phong, and the others,
    /// which have no highlight, after Gouraud
    #[arg(long, value_name = "COSINE", value_parser = cosine)]
    highlight: Option<f64>,

    /// What has a range of colour indices of its own, so that it can have a profile of its own
    #[arg(long, value_enum, default_value_t = RangesOf::Scene)]
    ranges: RangesOf,

    /// Draws polygons that turn their back, too, or not [default: not; faces are with --as-printed]
    #[arg(long, value_name = "yes|no", value_parser = yes_or_no)]
    back_faces: Option<bool>,

    /// Cuts polygons off at the sides of the window and at the planes of the scene file
    #[arg(long)]
    clip: bool,

    /// Which normals operation 1 shows
    #[arg(long, value_enum, default_value_t = Normals::Polygons)]
    normals: Normals,

    /// Refuses scenes that want more pixels than this screen has
    #[arg(long, value_name = "WxH")]
    screen: Option<Size>,

    /// Order in which the database is built: both make the same links
    #[arg(long, value_enum, default_value_t = Build::AsRead)]
    build: Build,

    /// Follows the printed listing where it differs from the text
    #[arg(long)]
    as_printed: bool,

    /// Opens the picture in the window of the look-up table editor
    #[arg(long)]
    show: bool,

    /// Prints the whole database
    #[arg(long, conflicts_with = "json")]
    dump: bool,

    /// Writes the scene and its objects into this folder, to be read again
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    save: Option<PathBuf>,

    /// Prints counts, pixels of each colour index, and what the picture takes on a serial line
    #[arg(long)]
    json: bool,

    /// Speed of that line in bits per second
    #[arg(long, value_name = "BITS", value_parser = positive, default_value = "19200")]
    baud: f64,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Operation {
    /// 0: edges
    Wire,
    /// 1: edges and vertex normals
    WireNormals,
    /// 2: faces after Phong
    Phong,
    /// 3: faces after Gouraud
    Gouraud,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Normals {
    /// Those of polygons' corners, of culled polygons too
    Polygons,
    /// All that vertices of visible polygons have
    Visible,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RangesOf {
    /// One for all
    Scene,
    /// Each object
    Objects,
    /// Each surface of each object
    Surfaces,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Build {
    /// All records in tables first, then the links
    Tables,
    /// Polygon by polygon
    AsRead,
}

fn cosine(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| (-1.0..=1.0).contains(value));
    value.ok_or_else(|| "a cosine lies between -1 and 1".to_owned())
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "yes" => Ok(true),
        "no" => Ok(false),
        _ => Err("it is yes or no".to_owned()),
    }
}

/// Draws the scene.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (name, bytes) = read_bytes(&arguments.scene)?;
    let mut scene = ClassicScene::parse(&name, &bytes)?;
    if let Some(operation) = arguments.operation {
        set_operation(&mut scene, operation)?;
    }
    let bitmap = bitmap_path(arguments, &scene)?;
    for path in [&arguments.output, &bitmap, &arguments.wire].into_iter().flatten() {
        check_writable(path)?;
    }
    let interrupt = Interrupt::listen();
    let build = match arguments.build {
        Build::Tables => BuildAlgorithm::Tables,
        Build::AsRead => BuildAlgorithm::AsRead,
    };
    let (mut database, warnings) = Database::load(&scene, &Directory::beside(&arguments.scene), build)?;
    warnings.iter().for_each(|warning| tell(&format!("senca: warning: {}", warning.0)));
    let rendering = render(&name, &scene, &mut database, &settings(arguments)).map_err(failure)?;
    write_all(arguments, &rendering, bitmap.as_deref(), &interrupt)?;
    if let Some(folder) = &arguments.save {
        save(folder, &scene, &database, &interrupt)?;
    }
    if arguments.dump {
        print(&database.dump())?;
    }
    if arguments.json {
        print(&report(arguments, &rendering))?;
    }
    if arguments.show { show(arguments, rendering.picture(), &interrupt) } else { Ok(()) }
}

fn failure(error: ThesisError) -> Failure {
    match error {
        ThesisError::Colors(_) | ThesisError::Ranges { .. } => Failure::usage(error),
        ThesisError::Read(_) | ThesisError::View { .. } => Failure::input(error),
    }
}

fn settings(arguments: &Arguments) -> RenderSettings {
    RenderSettings {
        colors: arguments.colors.count(),
        width: arguments.colors.width(),
        back_faces: arguments.back_faces,
        clip: arguments.clip,
        normals: match arguments.normals {
            Normals::Polygons => NormalsDrawn::OfPolygons,
            Normals::Visible => NormalsDrawn::OfVisibleVertices,
        },
        screen: arguments.screen.map(|size| [size.width, size.height]),
        ranges: match arguments.ranges {
            RangesOf::Scene => Ranges::Scene,
            RangesOf::Objects => Ranges::Objects,
            RangesOf::Surfaces => Ranges::Surfaces,
        },
        highlight: arguments.highlight,
        as_printed: arguments.as_printed,
    }
}

/// Puts another operation in place of the scene's. Wireframes pass over the light, so they cannot
/// become faces.
fn set_operation(scene: &mut ClassicScene, operation: Operation) -> Result<(), Failure> {
    use senca::io::classic::ClassicOperation;
    scene.operation = match operation {
        Operation::Wire => ClassicOperation::Wireframe,
        Operation::WireNormals => ClassicOperation::WireframeWithNormals,
        Operation::Phong => ClassicOperation::Phong,
        Operation::Gouraud => ClassicOperation::Gouraud,
    };
    if matches!(operation, Operation::Wire | Operation::WireNormals) {
        scene.light = None;
    } else if scene.light.is_none() {
        return Err(Failure::usage("the scene file is one of wireframes and gives no light for faces"));
    }
    Ok(())
}

/// Where the bitmap goes. A name in the scene file is taken for a file of the current folder only.
fn bitmap_path(arguments: &Arguments, scene: &ClassicScene) -> Result<Option<PathBuf>, Failure> {
    if arguments.bitmap.is_some() {
        return Ok(arguments.bitmap.clone());
    }
    let other = arguments.output.is_some() || arguments.wire.is_some() || arguments.save.is_some();
    if other || arguments.show || arguments.dump || arguments.json {
        return Ok(None);
    }
    let Some(name) = scene.output.as_ref().map(PathBuf::from) else {
        return Err(Failure::usage("the scene file names no bitmap; give --output or --bitmap"));
    };
    let mut parts = name.components();
    if matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None)) {
        return Ok(Some(name));
    }
    let message = format!("the scene file's bitmap {} is in another folder; give --bitmap", name.display());
    Err(Failure::usage(message))
}

fn write_all(
    arguments: &Arguments,
    rendering: &Rendering,
    bitmap: Option<&Path>,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    if let Some(path) = bitmap {
        let width = arguments.colors.width();
        let small = width == IntegerWidth::Bits16;
        if small && rendering.picture().width.max(rendering.picture().height) > u32::from(u16::MAX) {
            return Err(Failure::usage("a bitmap of 16-bit integers has sides up to 65535 pixels"));
        }
        output::write(path, &rendering.picture().write(width), interrupt)?;
        if arguments.bitmap.is_none() {
            tell(&format!("senca: wrote {}", path.display()));
        }
    }
    let lut = arguments.colors.lut(rendering.report.ranges)?;
    for (path, picture) in [(&arguments.output, rendering.picture()), (&arguments.wire, &rendering.wireframe)]
    {
        if let Some(path) = path {
            write_picture(path, &paint(picture, &lut), interrupt)?;
        }
    }
    Ok(())
}

/// Writes the database in the formats it was read from.
fn save(
    folder: &Path,
    scene: &ClassicScene,
    database: &Database,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::input(format!("{}: {e}", folder.display())))?;
    let files: Vec<String> = (0..database.objects.len()).map(|n| format!("object{n}.dat")).collect();
    for (object, file) in database.objects.iter().zip(&files) {
        output::write(&folder.join(file), object_text(object).as_bytes(), interrupt)?;
    }
    output::write(&folder.join("scene1.dat"), scene_text(scene, &files).as_bytes(), interrupt)
}

fn report(arguments: &Arguments, rendering: &Rendering) -> String {
    let (report, picture) = (&rendering.report, rendering.picture());
    let planes = 32 - (arguments.colors.count() - 1).leading_zeros();
    let bytes = match arguments.colors.bits {
        Bits::Pc16 => 2,
        Bits::Vax32 => 4,
    } * (2 + picture.indices.len());
    let object = json!({
        "width": picture.width,
        "height": picture.height,
        "vertices": report.vertices,
        "polygons": report.polygons,
        "surfaces": report.surfaces,
        "vertex_normals": report.normals,
        "culled": report.culled,
        "after_phong": report.after_phong,
        "ranges": report.ranges,
        "pixels_of_index": report.histogram,
        "bitmap_bytes": bytes,
        "packed_bytes": packed_size(picture),
        "transfer_seconds": transfer_seconds(picture.width, picture.height, planes, arguments.baud),
    });
    format!("{object:#}\n")
}

fn show(arguments: &Arguments, picture: &IndexBitmap, interrupt: &Interrupt) -> Result<(), Failure> {
    let mut editor = LutEditor::new(arguments.colors.count()).with_bitmap(picture.clone());
    if let Some(profile) = arguments.colors.profile()? {
        editor = editor.with_profile(profile);
    }
    let mut window = LutWindow::new(editor, Box::new(DiskFiles { interrupt: interrupt.clone() }));
    let how = InteractiveArguments { window: true, ..InteractiveArguments::default() };
    interactive::run(&mut window, "render", &how, interrupt)
}
