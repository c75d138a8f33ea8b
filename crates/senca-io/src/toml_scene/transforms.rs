//! Where things are: `translate`, `rotate`, `scale`, `matrix`, `look_at`, `transform`, and the frames
//! of lights and cameras.

use senca_math::glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use senca_scene::Transform;

use super::source::{Result, Table};
use super::values::Value;

/// The keys that place a node.
pub(super) const TRANSFORM_KEYS: [&str; 6] =
    ["translate", "rotate", "scale", "matrix", "look_at", "transform"];

/// A move and nothing else.
pub(super) fn translation(translation: DVec3) -> Transform {
    Transform::Parts { translation, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
}

/// A turn and a move.
pub(super) fn rigid(rotation: DQuat, translation: DVec3) -> Transform {
    Transform::Parts { translation, rotation, scale: DVec3::ONE }
}

/// First `inner`, then `outer`; stays in parts where a move follows.
pub(super) fn compose(outer: Transform, inner: Transform) -> Transform {
    if inner == Transform::default() {
        return outer;
    }
    if outer == Transform::default() {
        return inner;
    }
    Transform::Matrix(outer.matrix() * inner.matrix())
}

/// The transform that the table's keys give; `None` when there is none of them.
pub(super) fn read_transform(table: &mut Table<'_>) -> Result<Option<Transform>> {
    let present = table.first_of(&TRANSFORM_KEYS);
    let parts = read_parts(table)?;
    let matrix = table.get("matrix");
    let look_at = table.get("look_at");
    let list = table.get("transform");
    let ways = [parts.is_some(), matrix.is_some(), look_at.is_some(), list.is_some()];
    if ways.into_iter().filter(|&given| given).count() > 1 {
        let message = format!(
            "{} is placed in more than one way: give either translate, rotate and scale, or matrix, \
             or look_at, or transform",
            table.what()
        );
        let place = present.and_then(|key| table.get(key));
        return Err(place.map_or_else(|| table.error(message.clone()), |value| value.error(message.clone())));
    }
    match (matrix, look_at, list) {
        (Some(value), ..) => read_matrix(value).map(|matrix| Some(Transform::Matrix(matrix))),
        (_, Some(value), _) => read_look_at(value).map(Some),
        (_, _, Some(value)) => read_steps(value).map(Some),
        _ => Ok(parts),
    }
}

/// `translate`, `rotate` and `scale`, applied in the order scale, rotate, translate.
fn read_parts(table: &mut Table<'_>) -> Result<Option<Transform>> {
    let translation = table.read("translate", Value::vec3)?;
    let rotation = table.read("rotate", read_rotation)?;
    let scale = table.read("scale", read_scale)?;
    if translation.is_none() && rotation.is_none() && scale.is_none() {
        return Ok(None);
    }
    Ok(Some(Transform::Parts {
        translation: translation.unwrap_or(DVec3::ZERO),
        rotation: rotation.unwrap_or(DQuat::IDENTITY),
        scale: scale.unwrap_or(DVec3::ONE),
    }))
}

/// One factor or one per axis; negative ones mirror, 0 is refused.
pub(super) fn read_scale(value: Value<'_>) -> Result<DVec3> {
    let factor = |value: Value<'_>| match value.number()? {
        0.0 => Err(value.refuse("must not be 0: the object would be flat")),
        number => Ok(number),
    };
    if value.is_number() {
        return factor(value).map(DVec3::splat);
    }
    Ok(DVec3::from_array(value.array("a number or a list of three numbers", factor)?))
}

/// Degrees about x, then y, then z (all fixed in the parent), or `{ axis, angle }`, or
/// `{ quaternion }`.
pub(super) fn read_rotation(value: Value<'_>) -> Result<DQuat> {
    if !value.is_table() {
        return Ok(quat_of_degrees(value.vec3()?));
    }
    let mut table = value.table("the rotation")?;
    if let Some(quaternion) = table.read("quaternion", read_quaternion)? {
        table.finish()?;
        return Ok(quaternion);
    }
    let axis = table.require("axis")?.direction()?;
    let angle = table.require("angle")?.number()?;
    table.finish()?;
    Ok(DQuat::from_axis_angle(axis, angle.to_radians()))
}

/// The turn by `degrees.x` about x, then `.y` about y, then `.z` about z.
pub(super) fn quat_of_degrees(degrees: DVec3) -> DQuat {
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
}

/// `[x, y, z, w]`, made unit.
pub(super) fn read_quaternion(value: Value<'_>) -> Result<DQuat> {
    let v = DVec4::from_array(value.array("a list of four numbers: x, y, z, w", Value::number)?);
    let largest = v.abs().max_element();
    if largest == 0.0 {
        return Err(value.refuse("must not be zero"));
    }
    Ok(DQuat::from_vec4((v / largest).normalize()))
}

/// Four rows as on paper, for column vectors: the move stands in the last column.
fn read_matrix(value: Value<'_>) -> Result<DMat4> {
    let wanted = "a list of four rows of four numbers";
    let rows: [[f64; 4]; 4] = value.array(wanted, |row| row.array(wanted, Value::number))?;
    if rows[3] != [0.0, 0.0, 0.0, 1.0] {
        let hint = if rows.iter().zip([0.0, 0.0, 0.0, 1.0]).all(|(row, last)| row[3] == last) {
            "; this one is for row vectors, so exchange its rows and columns"
        } else {
            ""
        };
        return Err(value.refuse(format_args!(
            "must end with the row [0, 0, 0, 1]: it is for column vectors and has the move in its last column{hint}"
        )));
    }
    let matrix = DMat4::from_cols_array_2d(&rows).transpose();
    let linear = DMat3::from_mat4(matrix);
    let largest = linear.to_cols_array().into_iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let flat = largest == 0.0 || (linear * (1.0 / largest)).determinant().abs() < 1e-30;
    if flat {
        return Err(value.refuse("is singular: the object would be flat"));
    }
    Ok(matrix)
}

fn read_look_at(value: Value<'_>) -> Result<Transform> {
    let mut table = value.table("look_at")?;
    let transform = read_frame(&mut table, "eye")?;
    table.finish()?;
    Ok(transform)
}

/// A list of single steps, the first applied first.
fn read_steps(value: Value<'_>) -> Result<Transform> {
    let mut product = Transform::default();
    for step in value.items("a list of steps such as { rotate = [0, 30, 0] }")? {
        let mut table = step.table("the step")?;
        let count = TRANSFORM_KEYS.into_iter().filter(|key| table.has(key)).count();
        if count > 1 {
            return Err(table.error("give each step its own braces, so that their order is plain"));
        }
        let transform = match table.read("shear", read_shear)? {
            Some(shear) => Some(shear),
            None => read_transform(&mut table)?,
        };
        let Some(transform) = transform else {
            return Err(table.error("a step is one of translate, rotate, scale, shear, matrix and look_at"));
        };
        table.finish()?;
        product = compose(transform, product);
    }
    Ok(product)
}

/// `{ x = [by_y, by_z], y = [by_x, by_z], z = [by_x, by_y] }`: how much is added to each coordinate
/// per unit of the two others.
fn read_shear(value: Value<'_>) -> Result<Transform> {
    let mut table = value.table("the shear")?;
    let x = table.read_or("x", Default::default(), Value::vec2)?;
    let y = table.read_or("y", Default::default(), Value::vec2)?;
    let z = table.read_or("z", Default::default(), Value::vec2)?;
    table.finish()?;
    let linear =
        DMat3::from_cols(DVec3::new(1.0, y.x, z.x), DVec3::new(x.x, 1.0, z.y), DVec3::new(x.y, y.y, 1.0));
    if linear.determinant().abs() < 1e-12 {
        return Err(value.refuse("is singular: the object would be flat"));
    }
    Ok(Transform::Matrix(DMat4::from_mat3(linear)))
}

/// The frame of something that stands at `position_key` and looks along its -z: to `target`, or
/// along `direction`; `up` (default +y) is upright. Without target and direction it looks along -z.
pub(super) fn read_frame(table: &mut Table<'_>, position_key: &'static str) -> Result<Transform> {
    let position = table.read_or(position_key, DVec3::ZERO, Value::vec3)?;
    let target = table.get("target");
    let direction = table.get("direction");
    let towards = match (target, direction) {
        (Some(target), Some(_)) => {
            return Err(target.error("give either \"target\" or \"direction\", not both"));
        }
        (Some(target), None) => {
            let offset = target.vec3()? - position;
            if offset == DVec3::ZERO {
                return Err(target.refuse(format_args!("is the same place as \"{position_key}\"")));
            }
            offset.normalize()
        }
        (None, Some(direction)) => direction.direction()?,
        (None, None) => DVec3::NEG_Z,
    };
    let up = table.get("up");
    let rotation = match up {
        None => frame_towards(towards, DVec3::Y).unwrap_or_else(|| frame_towards_steep(towards)),
        Some(value) => frame_towards(towards, value.direction()?)
            .ok_or_else(|| value.refuse("is parallel to the direction of view; give one across it"))?,
    };
    Ok(rigid(rotation, position))
}

/// The turn that takes -z to the unit vector `towards` and y as near to `up` as can be; `None` when
/// the two are parallel.
pub(super) fn frame_towards(towards: DVec3, up: DVec3) -> Option<DQuat> {
    let z = -towards;
    let x = up.cross(z);
    if x.length() < 1e-9 {
        return None;
    }
    let x = x.normalize();
    Some(DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize())
}

/// Straight up or down: what lies at -z is then up in the picture when looking down, as on a map.
fn frame_towards_steep(towards: DVec3) -> DQuat {
    let up = if towards.y < 0.0 { DVec3::NEG_Z } else { DVec3::Z };
    frame_towards(towards, up).unwrap_or(DQuat::IDENTITY)
}

/// The turn that takes +y to the unit vector `axis` along the shortest way.
pub(super) fn turn_y_to(axis: DVec3) -> DQuat {
    DQuat::from_rotation_arc(DVec3::Y, axis)
}
