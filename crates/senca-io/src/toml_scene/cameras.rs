//! Cameras: by eye and target, or by the viewing operations of the course text.

use senca_math::glam::DVec3;
use senca_math::view::{
    CentralByNormal, Normalization1991, ParallelByNormal, View1991, ViewError, ViewParameters, ViewWindow,
    ViewingOperation,
};
use senca_scene::{Camera, CameraId, Lens, Node, Projection, Transform};

use super::builder::{Builder, Part};
use super::source::{Result, Table};
use super::transforms::{TRANSFORM_KEYS, read_frame, read_transform};
use super::values::Value;
use crate::ReadError;

/// The viewing operations.
#[derive(Clone, Copy)]
enum Operation {
    A,
    B,
    C,
    P,
    In1991(Normalization1991),
}

const OPERATIONS: [(&str, Operation); 7] = [
    ("A", Operation::A),
    ("B", Operation::B),
    ("C", Operation::C),
    ("P", Operation::P),
    ("1991-perspective", Operation::In1991(Normalization1991::Perspective)),
    ("1991-parallel", Operation::In1991(Normalization1991::Parallel)),
    ("1991-gks", Operation::In1991(Normalization1991::ParallelGks)),
];

impl<'a> Builder<'a> {
    /// A camera with the node it stands at.
    pub(super) fn camera(&mut self, mut table: Table<'a>) -> Result<Part> {
        let name = table.read_or("name", "", Value::string)?.to_owned();
        if !name.is_empty() {
            table.set_what(format!("camera \"{name}\""));
        }
        let (projection, transform) = match table.read("operation", |value| value.choice(&OPERATIONS))? {
            None => lens(&mut table)?,
            Some(operation) => viewing_operation(&mut table, operation)?,
        };
        let lens = table.read("lens", thin_lens)?;
        let shutter = table.read("shutter", shutter)?;
        table.finish()?;
        self.scene.cameras.push(Camera { lens, shutter, ..Camera::new(name.clone(), projection) });
        let camera = Some(CameraId(self.scene.cameras.len() as u32 - 1));
        Ok(Part::of(Node { name, transform, camera, ..Node::default() }))
    }
}

/// `fov` or `height`, at `eye` looking to `target`, or placed like an object.
fn lens(table: &mut Table<'_>) -> Result<(Projection, Transform)> {
    let height_value = table.get("height");
    let fov_value = table.get("fov");
    if let (Some(height), Some(_)) = (height_value, fov_value) {
        return Err(
            height.error("give either \"fov\" (perspective) or \"height\" (parallel projection), not both")
        );
    }
    let aspect = table.read("aspect", Value::positive)?;
    let projection = match height_value {
        Some(height) => {
            let (near, far) = planes(table, Value::number)?;
            Projection::Orthographic { height: height.positive()?, aspect, near, far }
        }
        None => {
            let yfov = match fov_value {
                Some(value) => fov(value)?,
                None => 45f64.to_radians(),
            };
            let (near, far) = planes(table, Value::positive)?;
            Projection::Perspective { yfov, aspect, near, far }
        }
    };
    let by_view = table.first_of(&["eye", "target", "direction", "up"]);
    let by_transform = table.first_of(&TRANSFORM_KEYS);
    if let (Some(view), Some(transform)) = (by_view, by_transform) {
        let message = format!("place a camera either by \"{view}\" or by \"{transform}\", not both");
        return Err(table
            .get(transform)
            .map_or_else(|| table.error(message.clone()), |v| v.error(message.clone())));
    }
    let transform = match by_transform {
        Some(_) => read_transform(table)?.unwrap_or_default(),
        None => {
            table.know(&TRANSFORM_KEYS);
            read_frame(table, "eye")?
        }
    };
    Ok((projection, transform))
}

/// `[camera.lens]`: `radius` and `focus`.
fn thin_lens(value: Value<'_>) -> Result<Lens> {
    let mut table = value.table("the lens")?;
    let radius = table.require("radius")?.positive()?;
    let focus_distance = table.require("focus")?.positive()?;
    table.finish()?;
    Ok(Lens { radius, focus_distance })
}

/// How many seconds the shutter is open, from the moment shown on, or `[open, close]`.
fn shutter(value: Value<'_>) -> Result<[f64; 2]> {
    if value.is_number() {
        return Ok([0.0, value.not_negative()?]);
    }
    let times: [f64; 2] = value.array("a number of seconds, or two: open and close", Value::number)?;
    if times[0] <= times[1] { Ok(times) } else { Err(value.refuse("must open before it closes")) }
}

fn fov(value: Value<'_>) -> Result<f64> {
    let degrees = value.number()?;
    if degrees > 0.0 && degrees < 180.0 {
        Ok(degrees.to_radians())
    } else {
        Err(value.refuse(format_args!("must be an angle between 0 and 180 degrees, but is {degrees}")))
    }
}

/// `near` and `far`, in order.
fn planes<'a>(
    table: &mut Table<'a>,
    read_near: impl FnOnce(Value<'a>) -> Result<f64>,
) -> Result<(Option<f64>, Option<f64>)> {
    let near = table.read("near", read_near)?;
    let far_value = table.get("far");
    let far = far_value.map(Value::number).transpose()?;
    if let (Some(value), Some(far)) = (far_value, far)
        && far <= near.unwrap_or(0.0)
        && (near.is_some() || far <= 0.0)
    {
        let near = near.unwrap_or(0.0);
        return Err(value.refuse(format_args!("must be greater than \"near\", {near}, but is {far}")));
    }
    Ok((near, far))
}

/// One of the viewing operations; its world is the camera's node, which can be placed on top.
fn viewing_operation(table: &mut Table<'_>, kind: Operation) -> Result<(Projection, Transform)> {
    let (operation, checked) = match kind {
        Operation::A => central_by_normal(table)?,
        Operation::P => parallel_by_normal(table)?,
        _ => {
            let parameters = parameters(table)?;
            let operation = match kind {
                Operation::B => ViewingOperation::Central(parameters),
                Operation::C => ViewingOperation::Parallel(parameters),
                Operation::In1991(normalization) => {
                    ViewingOperation::View1991(View1991 { parameters, normalization })
                }
                Operation::A | Operation::P => return Err(table.error("an operation by normal has no VRP")),
            };
            (operation, operation.view().map(drop))
        }
    };
    checked.map_err(|error| view_error(table, error))?;
    let transform = read_transform(table)?.unwrap_or_default();
    Ok((Projection::Operation(operation), transform))
}

/// The error of a view at the key that it is about.
fn view_error(table: &mut Table<'_>, error: ViewError) -> ReadError {
    let key = match error {
        ViewError::ZeroVpn => "vpn",
        ViewError::ZeroVup | ViewError::VupParallelToVpn => "vup",
        ViewError::NormalNotUnit { .. } => "n",
        ViewError::ZeroFocal => "f",
        ViewError::EmptyWindow { .. } => "window",
        ViewError::PrpInViewPlane => "prp",
        ViewError::FrontEqualsBack(_) | ViewError::BackBeforeFront { .. } | ViewError::BackThroughPrp(_) => {
            "back"
        }
        ViewError::PlaneBehindEye { plane, .. } => plane,
        _ => "operation",
    };
    match table.get(key) {
        Some(value) => value.error(error.to_string()),
        None => table.error(error.to_string()),
    }
}

/// umin, umax, vmin, vmax.
fn window(value: Value<'_>) -> Result<ViewWindow> {
    let [umin, umax, vmin, vmax] = value.array("four numbers: umin, umax, vmin, vmax", Value::number)?;
    Ok(ViewWindow::new(umin, umax, vmin, vmax))
}

/// VRP, VPN, VUP, PRP, window, F and B.
fn parameters(table: &mut Table<'_>) -> Result<ViewParameters> {
    Ok(ViewParameters {
        vrp: table.read_or("vrp", DVec3::ZERO, Value::vec3)?,
        vpn: table.read_or("vpn", DVec3::Z, Value::vec3)?,
        vup: table.read_or("vup", DVec3::Y, Value::vec3)?,
        prp: table.require("prp")?.vec3()?,
        window: window(table.require("window")?)?,
        front: table.require("front")?.number()?,
        back: table.require("back")?.number()?,
    })
}

/// The operation, and whether it gives a view.
type Checked = (ViewingOperation, std::result::Result<(), ViewError>);

/// Window, front and back of an operation by normal, which are given all or not at all.
fn bounds(table: &mut Table<'_>) -> Result<Option<(ViewWindow, f64, f64)>> {
    if table.first_of(&["window", "front", "back"]).is_none() {
        table.know(&["window", "front", "back"]);
        return Ok(None);
    }
    let window = window(table.require("window")?)?;
    let front = table.require("front")?.number()?;
    Ok(Some((window, front, table.require("back")?.number()?)))
}

/// Operation A: centre `p`, unit normal `n`, distance `f`. With a window and planes it is B.
fn central_by_normal(table: &mut Table<'_>) -> Result<Checked> {
    let a = CentralByNormal {
        center: table.require("p")?.vec3()?,
        normal: table.require("n")?.vec3()?,
        focal: table.require("f")?.number()?,
    };
    let operation = ViewingOperation::CentralByNormal(a);
    Ok(match bounds(table)? {
        None => (operation, a.steps().map(drop)),
        Some((window, front, back)) => match a.parameters(window, front, back) {
            Ok(b) => (ViewingOperation::Central(b), b.central_view().map(drop)),
            Err(error) => (operation, Err(error)),
        },
    })
}

/// Parallel projection by a point `p` of the image plane and its unit normal `n`. With a window and
/// planes it is C.
fn parallel_by_normal(table: &mut Table<'_>) -> Result<Checked> {
    let by_normal =
        ParallelByNormal { point: table.require("p")?.vec3()?, normal: table.require("n")?.vec3()? };
    let operation = ViewingOperation::ParallelByNormal(by_normal);
    Ok(match bounds(table)? {
        None => (operation, by_normal.steps().map(drop)),
        Some((window, front, back)) => match by_normal.parameters(window, front, back) {
            Ok(c) => (ViewingOperation::Parallel(c), c.parallel_view().map(drop)),
            Err(error) => (operation, Err(error)),
        },
    })
}
