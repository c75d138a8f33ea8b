//! Animations (glTF 2.0, section 3.11).

use senca_scene::math::glam::{DQuat, DVec3};
use senca_scene::{
    Animation, Channel, ChannelTarget, ChannelValues, Interpolation, NodeId, Scene, Shape, Transform,
};

use super::accessor::Accessor;
use super::document::Document;
use super::json;
use super::node::unit_rotation;
use crate::ReadError;

/// Reads all animations of the file into `scene`, whose nodes and geometries are there already.
/// Channels that cannot be followed are left out with a warning.
pub(super) fn read_all(document: &Document<'_>, scene: &mut Scene) -> Result<(), ReadError> {
    for (a, json) in document.root.animations.iter().enumerate() {
        let mut animation = Animation { name: json.name.clone(), channels: Vec::new() };
        for c in 0..json.channels.len() {
            animation.channels.extend(channel(document, a, c, scene)?);
        }
        for channel in &animation.channels {
            split_matrix(&mut scene.nodes[channel.target.node.index()].transform);
        }
        scene.animations.push(animation);
    }
    Ok(())
}

/// A node that moves by parts needs its place in parts.
fn split_matrix(transform: &mut Transform) {
    if let Transform::Matrix(matrix) = *transform
        && matrix.determinant() != 0.0
    {
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        *transform = Transform::Parts { translation, rotation, scale };
    }
}

fn channel(document: &Document<'_>, a: usize, c: usize, scene: &Scene) -> Result<Option<Channel>, ReadError> {
    let animation = &document.root.animations[a];
    let json = &animation.channels[c];
    let place = format!("animations[{a}].channels[{c}]");
    let Some(node) = json.target.node else { return Ok(None) };
    let at = format!("{place}.target.node");
    let Some(node) = document.index_or_warn(&at, node, "node", document.root.nodes.len()) else {
        return Ok(None);
    };
    let at = format!("{place}.sampler");
    let Some(s) = document.index_or_warn(&at, json.sampler, "sampler", animation.samplers.len()) else {
        return Ok(None);
    };
    let sampler = &animation.samplers[s as usize];
    let place = format!("animations[{a}].samplers[{s}]");
    let interpolation = match sampler.interpolation.as_deref() {
        None | Some("LINEAR") => Interpolation::Linear,
        Some("STEP") => Interpolation::Step,
        Some("CUBICSPLINE") => Interpolation::CubicSpline,
        Some(other) => {
            document.warn(format!("{place}.interpolation: {other:?} is not known; LINEAR is used"));
            Interpolation::Linear
        }
    };
    let times = read_times(document, &place, sampler)?;
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let output = Accessor::open(document, &format!("{place}.output"), sampler.output)?;
    let shape = Keys { document, place: &place, per_key, times: &times, output: &output };
    let values = match json.target.path.as_str() {
        "translation" => shape.vectors()?.map(ChannelValues::Translation),
        "scale" => shape.vectors()?.map(ChannelValues::Scale),
        "rotation" => shape.rotations()?.map(ChannelValues::Rotation),
        "weights" => shape.weights(morph_count(scene, node))?,
        other => {
            document
                .warn(format!("animations[{a}].channels[{c}].target.path: {other:?} is not known; left out"));
            None
        }
    };
    let times = shape.rising().iter().map(|&k| f64::from(times[k])).collect();
    let target = ChannelTarget { node: NodeId(node) };
    Ok(values.map(|values| Channel { target, times, values, interpolation }))
}

/// Number of morph targets of the mesh at `node`.
fn morph_count(scene: &Scene, node: u32) -> usize {
    let geometry = scene.nodes.get(node as usize).and_then(|n| scene.geometries.get(n.geometry?.index()));
    match geometry.map(|g| &g.shape) {
        Some(Shape::Mesh(mesh)) => mesh.morph_targets.len(),
        _ => 0,
    }
}

fn read_times(
    document: &Document<'_>,
    place: &str,
    sampler: &json::AnimationSampler,
) -> Result<Vec<f32>, ReadError> {
    let at = format!("{place}.input");
    let input = Accessor::open(document, &at, sampler.input)?;
    if input.width() != 1 {
        return Err(document.malformed(format!("{at}: must hold scalars")));
    }
    Ok(input.floats::<1>(document, None)?.into_iter().flatten().collect())
}

/// The keys of one sampler.
struct Keys<'a> {
    document: &'a Document<'a>,
    place: &'a str,
    /// Values a key: 3 for splines.
    per_key: usize,
    times: &'a [f32],
    output: &'a Accessor<'a>,
}

impl Keys<'_> {
    /// Keys whose time is later than all before.
    fn rising(&self) -> Vec<usize> {
        let mut last = f32::NEG_INFINITY;
        let later = |&k: &usize| {
            let time = self.times[k];
            let keep = time.is_finite() && time > last;
            last = if keep { time } else { last };
            keep
        };
        (0..self.times.len()).filter(later).collect()
    }

    /// The rising keys when the output has `width` components and `elements` for each value of a
    /// key; otherwise a warning.
    fn checked(&self, width: usize, elements: usize) -> Option<Vec<usize>> {
        let Keys { place, document, .. } = self;
        let needed = (self.times.len() as u64) * (self.per_key * elements) as u64;
        if self.output.width() != width || (self.output.count as u64) < needed {
            document.warn(format!(
                "{place}.output: must hold {needed} elements of {width} components; the channel is left out"
            ));
            return None;
        }
        let rising = self.rising();
        if rising.len() < self.times.len() {
            let lost = self.times.len() - rising.len();
            document.warn(format!("{place}.input: {lost} times do not rise; these keys are left out"));
        }
        (!rising.is_empty()).then_some(rising)
    }

    /// Elements of the rising keys.
    fn elements<const N: usize>(
        &self,
        width: usize,
        per_value: usize,
    ) -> Result<Option<Vec<[f32; N]>>, ReadError> {
        let Some(rising) = self.checked(width, per_value) else { return Ok(None) };
        let per_key = self.per_key * per_value;
        self.document.charge(&self.place, (rising.len() * per_key) as u64)?;
        let select: Vec<u32> =
            rising.iter().flat_map(|k| k * per_key..(k + 1) * per_key).map(|e| e as u32).collect();
        let values = self.output.floats::<N>(self.document, Some(&select))?;
        if values.iter().flatten().all(|v| v.is_finite()) {
            return Ok(Some(values));
        }
        self.document.warn(format!("{}.output: values are not finite; the channel is left out", self.place));
        Ok(None)
    }

    fn vectors(&self) -> Result<Option<Vec<DVec3>>, ReadError> {
        let values = self.elements::<3>(3, 1)?;
        Ok(values.map(|values| values.into_iter().map(|v| DVec3::from_array(v.map(f64::from))).collect()))
    }

    /// Rotations; the tangents of splines are not unit quaternions.
    fn rotations(&self) -> Result<Option<Vec<DQuat>>, ReadError> {
        let Some(values) = self.elements::<4>(4, 1)? else { return Ok(None) };
        let is_tangent = |i: usize| self.per_key == 3 && i % 3 != 1;
        let rotation = |(i, q): (usize, [f32; 4])| {
            let q = DQuat::from_array(q.map(f64::from));
            if is_tangent(i) { q } else { near_unit(q) }
        };
        Ok(Some(values.into_iter().enumerate().map(rotation).collect()))
    }

    fn weights(&self, count: usize) -> Result<Option<ChannelValues>, ReadError> {
        if count == 0 {
            let place = self.place;
            self.document.warn(format!("{place}: moves weights of a node without morph targets; left out"));
            return Ok(None);
        }
        let values = self.elements::<1>(1, count)?;
        Ok(values.map(|v| ChannelValues::Weights { count, values: v.into_iter().flatten().collect() }))
    }
}

/// Unit quaternion in the direction of `q`, which was stored in single precision; one that is unit
/// up to that precision keeps its bits.
fn near_unit(q: DQuat) -> DQuat {
    if (q.length_squared() - 1.0).abs() < 1e-6 { q } else { unit_rotation(q).unwrap_or(DQuat::IDENTITY) }
}
