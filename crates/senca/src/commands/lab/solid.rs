//! `senca lab 4`: the planes of a solid, and whether a point lies in it.

use std::path::PathBuf;

use clap::{Args, ValueHint};
use senca::math::glam::DVec3;
use senca_classic::lab::polygon::Position;
use senca_classic::lab::programs::SolidProgram;
use senca_classic::lab::solid::Method;
use serde_json::json;

use super::{Failure, Shown, read_solid, row};
use crate::cli::values::triple;

/// Faces whose planes are printed.
const PRINTED: usize = 100;

/// The solid, and the point.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// OBJ file, or another model; - is standard input
    #[arg(value_name = "MODEL", value_hint = ValueHint::FilePath)]
    model: PathBuf,

    /// The point V to be tested, in the coordinates of the file
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = triple)]
    point: DVec3,

    #[command(flatten)]
    shown: Shown,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let solid = read_solid(&arguments.model)?;
    let point = arguments.point.to_array();
    let planes = solid.planes();
    let found = solid.position(point);
    let (low, high) = solid.bounds();
    let (closed, convex) = (solid.is_closed(), solid.is_convex());

    let mut text =
        format!("{} vertices, {} faces, {} edges\n", solid.vertices.len(), planes.len(), solid.edges().len());
    text += &format!("from {} to {}\n", row(&low), row(&high));
    text += if closed { "closed" } else { "not closed: some edge is not used once in each direction" };
    text += if convex { ", convex\n" } else { ", not convex\n" };
    text += "planes (A B C D), value at V\n";
    for (i, (plane, value)) in planes.iter().zip(&found.values).take(PRINTED).enumerate() {
        text += &format!("  {:>4}  {}  {}\n", i + 1, row(plane), row(&[*value]));
    }
    if planes.len() > PRINTED {
        text += &format!("  and {} more; --json has all\n", planes.len() - PRINTED);
    }
    let by = match found.method {
        Method::Planes => "by the signs of the planes".to_owned(),
        Method::Ray => format!("by a ray that meets {} faces", found.crossings.len()),
    };
    let place = match found.position {
        Position::Inside => "inside the solid",
        Position::Boundary => "on the surface of the solid",
        Position::Outside => "outside the solid",
    };
    text += &format!("V ({}, {}, {}) is {place}, {by}\n", point[0], point[1], point[2]);
    let crossing = |c: &senca_classic::lab::solid::Crossing| json!({ "face": c.face + 1, "t": c.t });
    let json = json!({
        "vertices": solid.vertices.len(), "faces": planes.len(), "bounds": [low, high], "closed": closed,
        "convex": convex, "six_volumes": solid.six_volumes(), "planes": planes, "values": found.values,
        "point": point, "inside": found.position == Position::Inside,
        "boundary": found.position == Position::Boundary,
        "method": if found.method == Method::Planes { "planes" } else { "ray" },
        "crossings": found.crossings.iter().map(crossing).collect::<Vec<_>>(),
    });
    arguments.shown.print(&text, &json)?;
    if !arguments.shown.is_drawn() {
        return Ok(());
    }
    arguments.shown.present(&mut SolidProgram::new(solid, point)?, "lab-4")
}
