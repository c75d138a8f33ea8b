//! `senca classic polygon`: the exercise in polygon shading.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use senca::classic::polygon::{
    EdgeSets, PolygonApplet, PolygonPicture, ScreenVertex, Slips, parse_polygons, polygons_text,
};
use serde_json::{Value, json};

use crate::cli::input::read_text;
use crate::cli::interactive::{self, InteractiveArguments};
use crate::cli::output::{self, check_writable, print};
use crate::cli::{Failure, Interrupt};

/// Space around the polygons, in pixels.
const MARGIN: i32 = 8;
/// Least and greatest sides of the window, unless they are given.
const SIDES: [usize; 2] = [240, 1024];

/// Which polygons, and which slips.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Polygons: a vertex a line, x y z b; an empty line between polygons; - is standard input
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    file: Option<PathBuf>,

    /// Keeps this slip of the text; may be given several times
    #[arg(long, value_name = "SLIP", value_enum)]
    slip: Vec<Slip>,

    /// Keeps all slips
    #[arg(long, conflicts_with = "slip")]
    as_printed: bool,

    /// Shows depths in place of intensities
    #[arg(long)]
    depths: bool,

    /// Shows outlines and vertices in -o, too
    #[arg(long)]
    outlines: bool,

    /// Writes the polygons as they are in the end
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    save: Option<PathBuf>,

    /// Prints edge sets, counts and sums as JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    interactive: InteractiveArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Slip {
    /// A shallow edge writes one point beyond its end
    ExtraPass,
    /// Horizontal edges go into the left set
    HorizontalEdges,
    /// The edge written last has the row
    LastEdgeWins,
    /// Polygons that run counter-clockwise are not turned around
    OneOrientation,
    /// Rows of one pixel become 0
    SinglePixels,
    /// Both ends of a row are the left one, so all is 0
    SameEndTwice,
    /// Rounding errors take away units
    LostUnits,
}

impl Arguments {
    fn slips(&self) -> Slips {
        if self.as_printed {
            return Slips::AS_PRINTED;
        }
        let has = |slip| self.slip.contains(&slip);
        Slips {
            extra_pass: has(Slip::ExtraPass),
            horizontal_edges: has(Slip::HorizontalEdges),
            last_edge_wins: has(Slip::LastEdgeWins),
            one_orientation: has(Slip::OneOrientation),
            single_pixels: has(Slip::SinglePixels),
            same_end_twice: has(Slip::SameEndTwice),
            lost_units: has(Slip::LostUnits),
        }
    }
}

/// Shades the polygons.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let polygons = match &arguments.file {
        Some(path) => {
            let (name, text) = read_text(path)?;
            parse_polygons(&name, &text)?
        }
        None => Vec::new(),
    };
    arguments.save.as_deref().map_or(Ok(()), check_writable)?;
    let slips = arguments.slips();
    let how = &arguments.interactive;
    let size = how.size.map_or_else(|| size_of(&polygons), |s| (s.width as usize, s.height as usize));
    let interactive = how.window || how.script.is_some();
    let mut applet = PolygonApplet::new(polygons, size, slips)
        .showing_depths(arguments.depths)
        .showing_outlines(interactive || arguments.outlines);
    let interrupt = Interrupt::listen();
    if interactive || how.output.is_some() || !arguments.json && arguments.save.is_none() {
        if how.output.is_none() {
            applet = applet.showing_outlines(true);
        }
        interactive::run(&mut applet, "polygon", how, &interrupt)?;
    }
    if let Some(path) = &arguments.save {
        output::write(path, polygons_text(applet.polygons()).as_bytes(), &interrupt)?;
    }
    if arguments.json { print(&report(applet.polygons(), size, &slips)) } else { Ok(()) }
}

/// A window that holds the polygons, within bounds.
fn size_of(polygons: &[Vec<ScreenVertex>]) -> (usize, usize) {
    let all = || polygons.iter().flatten();
    let side = |greatest: Option<i32>| {
        let side = greatest.unwrap_or(0).saturating_add(1 + MARGIN).max(0) as usize;
        side.clamp(SIDES[0], SIDES[1])
    };
    (side(all().map(|vertex| vertex.x).max()), side(all().map(|vertex| vertex.y).max()))
}

fn report(polygons: &[Vec<ScreenVertex>], size: (usize, usize), slips: &Slips) -> String {
    let mut picture = PolygonPicture::new(size.0 as u32, size.1 as u32);
    let one = |polygon: &Vec<ScreenVertex>| -> Value {
        let counts = picture.draw(polygon, slips);
        let point = |p: ScreenVertex| [p.x, p.y, p.z, p.b];
        let rows = EdgeSets::of(polygon, slips);
        let rows: Vec<_> = rows
            .rows()
            .map(|row| json!({ "y": row.y, "left": point(row.left), "right": point(row.right) }))
            .collect();
        json!({ "covered": counts.covered, "written": counts.written, "rows": rows })
    };
    let each: Vec<Value> = polygons.iter().map(one).collect();
    let (pixels, z, b) = picture.sums();
    format!("{:#}\n", json!({ "polygons": each, "pixels": pixels, "sum_z": z, "sum_b": b }))
}
