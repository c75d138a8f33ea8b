//! Keyframe animation.

use std::collections::{BTreeMap, HashMap};

use senca_math::glam::{DQuat, DVec3};
use senca_scene::{Animation, Channel, ChannelTarget, ChannelValues, Interpolation, NodeId, Scene};

use super::builder::Builder;
use super::names::hint;
use super::source::{Result, Table};
use super::transforms::{quat_of_degrees, read_quaternion, read_rotation, read_scale};
use super::values::Value;

/// Largest turn between two keys of a rotation, in degrees; wider ones get keys in between, because
/// a quaternion only knows the shorter way round.
const LARGEST_TURN: f64 = 60.0;

/// Most keys of one channel after that.
const MOST_KEYS: usize = 1 << 16;

#[derive(Clone, Copy)]
enum Property {
    Translate,
    Rotate,
    Scale,
    Weights,
    Path,
}

const PROPERTIES: [(&str, Property); 5] = [
    ("translate", Property::Translate),
    ("rotate", Property::Rotate),
    ("scale", Property::Scale),
    ("weights", Property::Weights),
    ("path", Property::Path),
];

const INTERPOLATIONS: [(&str, Interpolation); 3] =
    [("linear", Interpolation::Linear), ("step", Interpolation::Step), ("cubic", Interpolation::CubicSpline)];

impl<'a> Builder<'a> {
    /// Reads `[[animation]]`; entries of one name run together.
    pub(super) fn read_animations(&mut self, root: &mut Table<'a>) -> Result<()> {
        let mut animations = std::mem::take(&mut self.scene.animations);
        let nodes = nodes_by_name(&self.scene);
        let mut index_of: HashMap<String, usize> = HashMap::new();
        for (index, animation) in animations.iter().enumerate() {
            index_of.entry(animation.name.clone()).or_insert(index);
        }
        for mut table in root.tables("animation")? {
            let name = table.read_or("name", "", Value::string)?;
            let channel = channel(&mut table, &nodes)?;
            table.finish()?;
            let index = *index_of.entry(name.to_owned()).or_insert(animations.len());
            if index == animations.len() {
                animations.push(Animation { name: name.to_owned(), channels: Vec::new() });
            }
            animations[index].channels.push(channel);
        }
        self.scene.animations = animations;
        Ok(())
    }
}

/// The nodes that have names; `None` for a name that several have.
type NodesByName<'s> = BTreeMap<&'s str, Option<NodeId>>;

fn nodes_by_name(scene: &Scene) -> NodesByName<'_> {
    let mut nodes = NodesByName::new();
    for (i, node) in scene.nodes.iter().enumerate().filter(|(_, node)| !node.name.is_empty()) {
        let id = Some(NodeId(i as u32));
        nodes.entry(&node.name).and_modify(|known| *known = None).or_insert(id);
    }
    nodes
}

fn channel(table: &mut Table<'_>, nodes: &NodesByName<'_>) -> Result<Channel> {
    let node = node_named(table.require("node")?, nodes)?;
    let property = table.require("property")?.choice(&PROPERTIES)?;
    let times = times(table.require("times")?)?;
    let interpolation =
        table.read_or("interpolation", Interpolation::Linear, |value| value.choice(&INTERPOLATIONS))?;
    let target = ChannelTarget { node };
    if let Property::Path = property {
        let values = path(table, times.len(), interpolation)?;
        return Ok(Channel { target, times, values, interpolation });
    }
    let value = table.require("values")?;
    let keys = Keys { value, count: times.len(), cubic: interpolation == Interpolation::CubicSpline };
    let values = match property {
        Property::Translate | Property::Path => ChannelValues::Translation(keys.read(Value::vec3)?),
        Property::Scale if keys.cubic => ChannelValues::Scale(keys.read(Value::vec3)?),
        Property::Scale => ChannelValues::Scale(keys.read(read_scale)?),
        Property::Rotate => return keys.rotation(target, times, interpolation),
        Property::Weights => keys.weights()?,
    };
    Ok(Channel { target, times, values, interpolation })
}

/// The node of a name that only one node has.
fn node_named(value: Value<'_>, nodes: &NodesByName<'_>) -> Result<NodeId> {
    let name = value.string()?;
    match nodes.get(name) {
        Some(Some(node)) => Ok(*node),
        Some(None) => Err(value.error(format!(
            "several objects are called \"{name}\"; give the one that moves a name of its own"
        ))),
        None => {
            let names: Vec<&str> = nodes.keys().copied().collect();
            let message = format!("no object, light or camera is called \"{name}\"{}", hint(name, &names));
            Err(value.error(message))
        }
    }
}

/// At least one time in seconds, increasing.
fn times(value: Value<'_>) -> Result<Vec<f64>> {
    let times = value.list("a list of times in seconds", Value::number)?;
    if times.is_empty() {
        return Err(value.refuse("needs at least one time"));
    }
    match times.windows(2).find(|pair| pair[0] >= pair[1]) {
        None => Ok(times),
        Some(pair) => Err(value.refuse(format_args!("must increase, but {} follows {}", pair[1], pair[0]))),
    }
}

/// The list of values, one per key.
struct Keys<'a> {
    value: Value<'a>,
    count: usize,
    cubic: bool,
}

impl<'a> Keys<'a> {
    fn items(&self) -> Result<Vec<Value<'a>>> {
        let items: Vec<_> = self.value.items("a list with a value for each time")?.collect();
        if items.len() == self.count {
            return Ok(items);
        }
        let message = format!("needs a value for each of the {} times, but has {}", self.count, items.len());
        Err(self.value.refuse(message))
    }

    /// One value per key; in-tangent, value and out-tangent for cubic splines.
    fn read<T>(&self, mut read: impl FnMut(Value<'a>) -> Result<T>) -> Result<Vec<T>> {
        let mut values = Vec::new();
        for item in self.items()? {
            if self.cubic {
                let mut key = item.table("the key")?;
                for part in ["in", "value", "out"] {
                    values.push(read(key.require(part)?)?);
                }
                key.finish()?;
            } else {
                values.push(read(item)?);
            }
        }
        Ok(values)
    }

    fn weights(&self) -> Result<ChannelValues> {
        let keys = self.read(|value| value.list("a list of weights", Value::number))?;
        let count = keys[0].len();
        if keys.iter().any(|key| key.len() != count) {
            return Err(self.value.refuse("needs as many weights at every key"));
        }
        Ok(ChannelValues::Weights { count, values: keys.concat().into_iter().map(|v| v as f32).collect() })
    }

    /// Rotations; angles in degrees are followed as angles, so that 0 to 360 is a whole turn.
    fn rotation(
        &self,
        target: ChannelTarget,
        times: Vec<f64>,
        interpolation: Interpolation,
    ) -> Result<Channel> {
        if self.cubic {
            let raw = |value: Value<'a>| {
                value.array("a list of four numbers: x, y, z, w", Value::number).map(DQuat::from_array)
            };
            let values = self.read(raw)?;
            if values.iter().skip(1).step_by(3).any(|q| q.length() < 1e-9) {
                return Err(self.value.refuse("has a quaternion of length 0"));
            }
            return Ok(Channel { target, times, values: ChannelValues::Rotation(values), interpolation });
        }
        let keys = self.items()?.into_iter().map(Turn::read).collect::<Result<Vec<_>>>()?;
        let mut all_times = vec![times[0]];
        let mut values = vec![keys[0].quat(keys[0], 0.0)];
        for (pair, span) in keys.windows(2).zip(times.windows(2)) {
            let pieces = if interpolation == Interpolation::Linear { pair[0].pieces(pair[1]) } else { 1.0 };
            if pieces > MOST_KEYS as f64 || all_times.len() + pieces as usize > MOST_KEYS {
                return Err(self.value.refuse("turns too far between its keys"));
            }
            for piece in 1..=pieces as usize {
                let t = piece as f64 / pieces;
                let time = if piece == pieces as usize { span[1] } else { span[0] + (span[1] - span[0]) * t };
                // Keys may be too close together to be divided.
                if all_times.last().is_none_or(|&last| time > last) {
                    all_times.push(time);
                    values.push(pair[0].quat(pair[1], t));
                }
            }
        }
        Ok(Channel { target, times: all_times, values: ChannelValues::Rotation(values), interpolation })
    }
}

/// A rotation as it was written.
#[derive(Clone, Copy)]
enum Turn {
    Degrees(DVec3),
    About { axis: DVec3, degrees: f64 },
    Quaternion(DQuat),
}

impl Turn {
    fn read(value: Value<'_>) -> Result<Self> {
        if !value.is_table() {
            if value.is_list() && value.items("a rotation")?.len() == 4 {
                return read_quaternion(value).map(Self::Quaternion);
            }
            return value.vec3().map(Self::Degrees);
        }
        let mut table = value.table("the rotation")?;
        if table.has("quaternion") {
            return read_rotation(value).map(Self::Quaternion);
        }
        let axis = table.require("axis")?.direction()?;
        let degrees = table.require("angle")?.number()?;
        table.finish()?;
        Ok(Self::About { axis, degrees })
    }

    /// Into how many pieces the way to `next` is cut.
    fn pieces(self, next: Self) -> f64 {
        let degrees = match (self, next) {
            (Self::Degrees(a), Self::Degrees(b)) => (b - a).abs().max_element(),
            (Self::About { axis: a, degrees: from }, Self::About { axis: b, degrees: to }) if a == b => {
                (to - from).abs()
            }
            _ => 0.0,
        };
        (degrees / LARGEST_TURN).ceil().max(1.0)
    }

    /// The rotation at `t` in [0, 1] on the way to `next`.
    fn quat(self, next: Self, t: f64) -> DQuat {
        match (self, next) {
            (Self::Degrees(a), Self::Degrees(b)) => quat_of_degrees(a.lerp(b, t)),
            (Self::About { axis: a, degrees: from }, Self::About { axis: b, degrees: to }) if a == b => {
                DQuat::from_axis_angle(a, (from + (to - from) * t).to_radians())
            }
            // One piece: only its ends are asked for.
            _ if t < 0.5 => self.plain(),
            _ => next.plain(),
        }
    }

    fn plain(self) -> DQuat {
        match self {
            Self::Degrees(degrees) => quat_of_degrees(degrees),
            Self::About { axis, degrees } => DQuat::from_axis_angle(axis, degrees.to_radians()),
            Self::Quaternion(quaternion) => quaternion,
        }
    }
}

/// A chain of cubic Bézier pieces.
fn path(table: &mut Table<'_>, count: usize, interpolation: Interpolation) -> Result<ChannelValues> {
    if interpolation == Interpolation::CubicSpline {
        return Err(table.error("a path is run along in linear or step interpolation, not cubic"));
    }
    let value = table.require("points")?;
    let points = value.list("a list of points [x, y, z]", Value::vec3)?;
    if points.len() < 4 || points.len() % 3 != 1 {
        let message = format!("must have 4, 7, 10, ... control points, but has {}", points.len());
        return Err(value.refuse(message));
    }
    let parameters = match table.get("values") {
        Some(value) => Keys { value, count, cubic: false }.read(Value::share)?,
        None if count == 1 => vec![0.0],
        None => (0..count).map(|key| key as f64 / (count - 1) as f64).collect(),
    };
    let look_ahead = table.read_or("look_ahead", false, Value::boolean)?;
    Ok(ChannelValues::Path { points, parameters, look_ahead })
}
