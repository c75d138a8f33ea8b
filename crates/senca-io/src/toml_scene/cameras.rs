//! Cameras: by eye and target, or by the viewing operations of the course text.

use senca_math::glam::DVec3;
use senca_scene::{Camera, CameraId, Node, Projection, Transform};

use super::builder::{Builder, Part};
use super::source::{Result, Table};
use super::transforms::{TRANSFORM_KEYS, frame_towards, read_frame, read_transform, rigid};
use super::values::Value;

/// How far the length of the normal of operation A may be from 1; enough for four typed digits.
const UNIT_TOLERANCE: f64 = 1e-3;

/// The viewing operations.
#[derive(Clone, Copy)]
enum Operation {
    A,
    B,
    C,
    ParallelByNormal,
}

const OPERATIONS: [(&str, Operation); 4] = [
    ("A", Operation::A),
    ("B", Operation::B),
    ("C", Operation::C),
    ("parallel", Operation::ParallelByNormal),
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
        table.finish()?;
        self.scene.cameras.push(Camera { name: name.clone(), projection });
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

fn viewing_operation(table: &mut Table<'_>, operation: Operation) -> Result<(Projection, Transform)> {
    match operation {
        Operation::A => central_by_normal(table),
        Operation::B => general(table, false),
        Operation::C => general(table, true),
        Operation::ParallelByNormal => parallel_by_normal(table),
    }
}

/// umin, umax, vmin, vmax.
fn window(table: &mut Table<'_>) -> Result<[f64; 4]> {
    let value = table.require("window")?;
    let window: [f64; 4] = value.array("four numbers: umin, umax, vmin, vmax", Value::number)?;
    let [umin, umax, vmin, vmax] = window;
    if umin < umax && vmin < vmax {
        return Ok(window);
    }
    Err(value.refuse(format_args!(
        "is empty: umin {umin} must be below umax {umax}, and vmin {vmin} below vmax {vmax}"
    )))
}

/// F and B with F > B, where F defaults to `default_front`.
fn front_and_back(table: &mut Table<'_>, default_front: Option<f64>) -> Result<(f64, f64)> {
    let front = match default_front {
        Some(default) => table.read_or("front", default, Value::number)?,
        None => table.require("front")?.number()?,
    };
    let value = table.require("back")?;
    let back = value.number()?;
    if back < front {
        return Ok((front, back));
    }
    Err(value.refuse(format_args!(
        "must be smaller than \"front\", {front}, but is {back}: both count along the normal, towards the viewer"
    )))
}

/// Refuses a front plane that does not lie before the eye at `eye` on the normal.
fn check_before_eye(table: &mut Table<'_>, front: f64, eye: f64) -> Result<()> {
    if front < eye {
        return Ok(());
    }
    let message = format!(
        "the front plane at {front} does not lie before the eye; \"front\" must be smaller than {eye}, \
         the eye's distance from the view plane"
    );
    Err(table.get("front").map_or_else(|| table.error(message.clone()), |value| value.error(message.clone())))
}

/// Operations B and C: VRP, VPN, VUP, PRP, window, F, B.
fn general(table: &mut Table<'_>, parallel: bool) -> Result<(Projection, Transform)> {
    let vrp = table.read_or("vrp", DVec3::ZERO, Value::vec3)?;
    let vpn = table.read_or("vpn", DVec3::Z, Value::direction)?;
    let vup_value = table.get("vup");
    let vup = vup_value.map(Value::direction).transpose()?.unwrap_or(DVec3::Y);
    let rotation = frame_towards(-vpn, vup).ok_or_else(|| {
        let message = "VUP is parallel to VPN, the direction of view; give an up vector across it";
        vup_value.map_or_else(|| table.error(message), |value| value.error(message))
    })?;
    let prp_value = table.require("prp")?;
    let prp = prp_value.vec3()?;
    if prp.z == 0.0 {
        return Err(prp_value.refuse("lies in the view plane; its third coordinate must not be 0"));
    }
    let window = window(table)?;
    let (front, back) = front_and_back(table, None)?;
    if !parallel {
        check_before_eye(table, front, prp.z)?;
    } else if back == prp.z {
        return Err(prp_value.refuse("lies in the back plane; move it along the direction of projection"));
    }
    Ok((Projection::ViewReference { parallel, prp, window, front, back }, rigid(rotation, vrp)))
}

/// The unit normal `n` and the frame it stands for: x across n and the world's z axis.
fn normal_frame(table: &mut Table<'_>) -> Result<(DVec3, senca_math::glam::DQuat)> {
    let value = table.require("n")?;
    let given = value.vec3()?;
    let length = given.length();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        return Err(value.refuse(format_args!("must have length 1, but its length is {length}")));
    }
    let n = given / length;
    let rotation = frame_towards(-n, DVec3::Z).or_else(|| frame_towards(-n, DVec3::Y));
    Ok((n, rotation.unwrap_or_default()))
}

/// Operation A: centre `p`, unit normal `n`, distance `f`.
fn central_by_normal(table: &mut Table<'_>) -> Result<(Projection, Transform)> {
    let p = table.require("p")?.vec3()?;
    let (n, rotation) = normal_frame(table)?;
    let f = table.require("f")?.positive()?;
    let window = window(table)?;
    let (front, back) = front_and_back(table, Some(0.0))?;
    check_before_eye(table, front, f)?;
    let prp = DVec3::new(0.0, 0.0, f);
    Ok((Projection::ViewReference { parallel: false, prp, window, front, back }, rigid(rotation, p - f * n)))
}

/// Parallel projection by a point `p` of the image plane and its unit normal `n`.
fn parallel_by_normal(table: &mut Table<'_>) -> Result<(Projection, Transform)> {
    let p = table.require("p")?.vec3()?;
    let (_, rotation) = normal_frame(table)?;
    let window = window(table)?;
    let (front, back) = front_and_back(table, None)?;
    // Any place on the normal through the window's centre gives the same direction.
    let center = [0.5 * (window[0] + window[1]), 0.5 * (window[2] + window[3])];
    let prp = DVec3::new(center[0], center[1], 1.0 + front.abs().max(back.abs()));
    Ok((Projection::ViewReference { parallel: true, prp, window, front, back }, rigid(rotation, p)))
}
