//! `senca lab 3`: a convex polygon.

use clap::Args;
use senca_classic::lab::polygon::{Orientation, Point2, Polygon, Position, Rounding, Span, read_point};
use senca_classic::lab::programs::PolygonProgram;
use serde_json::{Value, json};

use super::{Failure, Shown, Source, row};

/// The polygon, and the points to be tested.
#[derive(Args, Debug)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Which pixels of a row are filled
    #[arg(long, value_name = "NAME", value_parser = ["within", "nearest", "truncate"], default_value = "within")]
    rounding: String,

    /// Prints the ends of all rows, too
    #[arg(long)]
    rows: bool,

    #[command(flatten)]
    shown: Shown,
}

impl Arguments {
    fn rounding(&self) -> Rounding {
        match self.rounding.as_str() {
            "nearest" => Rounding::Nearest,
            "truncate" => Rounding::Truncate,
            _ => Rounding::Within,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.source.is_empty() && arguments.shown.is_driven() {
        return arguments.shown.present(&mut PolygonProgram::new(), "lab-3");
    }
    let wanted = "The number of vertices, x and y of each, then x and y of points to be tested";
    let example = "4  50 200  150 350  300 150  100 50   150 200";
    let (vertices, points) = arguments.source.read(wanted, example, |input| {
        let vertices = Polygon::read_vertices(input)?;
        let mut points: Vec<Point2> = Vec::new();
        while input.left() > 0 {
            points.push(read_point(input, "the point V")?);
        }
        Ok((vertices, points))
    })?;
    let given = Polygon::new(vertices.clone());
    let polygon = Polygon::clockwise(vertices.clone())?;
    let spans = polygon.spans();
    let (text, json) = report(arguments, &given, &polygon, &points, &spans);
    arguments.shown.print(&text, &json)?;
    arguments.shown.present(&mut PolygonProgram::with_polygon(vertices, points)?, "lab-3")
}

fn report(
    arguments: &Arguments,
    given: &Polygon,
    polygon: &Polygon,
    points: &[Point2],
    spans: &[Span],
) -> (String, Value) {
    let reversed = given.orientation() == Orientation::CounterClockwise;
    let mut text = String::from("edges (a b c)\n");
    polygon.edges().iter().for_each(|edge| text += &format!("  {}\n", row(edge)));
    text += &format!("orientation: {}\n", row(&given.orientation_values()));
    text += if reversed { "the list was counter-clockwise and is reversed\n" } else { "clockwise\n" };
    for &point in points {
        let place = match polygon.position(point) {
            Position::Inside => "inside the polygon",
            Position::Boundary => "inside the polygon, on an edge",
            Position::Outside => "outside the polygon",
        };
        let values = polygon.values(point);
        text += &format!("V ({}, {}) is {place}; values {}\n", point[0], point[1], row(&values));
    }
    let pixels: usize = spans.iter().map(|s| s.pixels(arguments.rounding()).count()).sum();
    text += &format!("filled: {} rows, {pixels} pixels\n", spans.len());
    if arguments.rows {
        spans.iter().for_each(|s| text += &format!("  y {:>5}  {}\n", s.y, row(&[s.left, s.right])));
    }
    let tested = |&point: &Point2| {
        let position = polygon.position(point);
        json!({
            "point": point, "values": polygon.values(point), "inside": position.is_inside(),
            "boundary": position == Position::Boundary,
        })
    };
    let json = json!({
        "vertices": polygon.vertices(), "edges": polygon.edges(), "reversed": reversed,
        "orientation_values": given.orientation_values(),
        "points": points.iter().map(tested).collect::<Vec<_>>(),
        "rows": spans.iter().map(|s| json!([s.y, s.left, s.right])).collect::<Vec<_>>(),
        "pixels": pixels,
    });
    (text, json)
}
