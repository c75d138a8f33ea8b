//! Animations. Paths, which glTF does not know, are written as positions along them.

use serde_json::{Value, json};

use senca_scene::math::glam::{DMat3, DQuat, DVec3};
use senca_scene::{Animation, Channel, ChannelValues, Interpolation, Scene};

use super::{Output, Target, named, set};

/// Straight pieces that stand for a path between two keys.
const PATH_STEPS: usize = 32;

/// One channel as glTF knows it.
struct Track {
    path: &'static str,
    times: Vec<f32>,
    values: Values,
    interpolation: Interpolation,
}

enum Values {
    Scalars(Vec<[f32; 1]>),
    Vectors(Vec<[f32; 3]>),
    Rotations(Vec<[f32; 4]>),
}

impl Output {
    pub(super) fn add_animations(&mut self, scene: &Scene) {
        for animation in &scene.animations {
            let json = self.animation_json(scene, animation);
            if json["channels"].as_array().is_some_and(|c| !c.is_empty()) {
                self.push("animations", json);
            }
        }
    }

    fn animation_json(&mut self, scene: &Scene, animation: &Animation) -> Value {
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        for channel in &animation.channels {
            let node = channel.target.node;
            if node.index() >= scene.nodes.len() || channel.times.is_empty() {
                continue;
            }
            for track in tracks(channel) {
                channels
                    .push(json!({"sampler": samplers.len(), "target": {"node": node.0, "path": track.path}}));
                let sampler = self.sampler_json(&track);
                samplers.push(sampler);
            }
        }
        let mut json = named(&animation.name);
        set(&mut json, "samplers", Value::Array(samplers));
        set(&mut json, "channels", Value::Array(channels));
        Value::Object(json)
    }

    fn sampler_json(&mut self, track: &Track) -> Value {
        let times: Vec<[f32; 1]> = track.times.iter().map(|&t| [t]).collect();
        let input = self.add_floats(&times, Target::Other, true);
        let output = match &track.values {
            Values::Scalars(v) => self.add_floats(v, Target::Other, false),
            Values::Vectors(v) => self.add_floats(v, Target::Other, false),
            Values::Rotations(v) => self.add_floats(v, Target::Other, false),
        };
        let interpolation = match track.interpolation {
            Interpolation::Step => "STEP",
            Interpolation::Linear => "LINEAR",
            Interpolation::CubicSpline => "CUBICSPLINE",
        };
        json!({"input": input, "output": output, "interpolation": interpolation})
    }
}

fn tracks(channel: &Channel) -> Vec<Track> {
    let times = channel.times.iter().map(|&t| t as f32).collect();
    let one = |path, values| vec![Track { path, times, values, interpolation: channel.interpolation }];
    match &channel.values {
        ChannelValues::Translation(v) => one("translation", vectors(v)),
        ChannelValues::Scale(v) => one("scale", vectors(v)),
        ChannelValues::Rotation(v) => one("rotation", rotations(v)),
        ChannelValues::Weights { values, .. } => {
            one("weights", Values::Scalars(values.iter().map(|&w| [w]).collect()))
        }
        ChannelValues::Path { points, parameters, look_ahead } => {
            path_tracks(channel, points, parameters, *look_ahead)
        }
    }
}

fn vectors(values: &[DVec3]) -> Values {
    Values::Vectors(values.iter().map(|v| v.as_vec3().to_array()).collect())
}

fn rotations(values: &[DQuat]) -> Values {
    Values::Rotations(values.iter().map(|q| q.as_quat().to_array()).collect())
}

/// Positions, and turns where the node looks along its path, at the keys and between them.
fn path_tracks(channel: &Channel, points: &[DVec3], parameters: &[f64], look_ahead: bool) -> Vec<Track> {
    if points.len() < 4 || parameters.len() < channel.times.len() {
        return Vec::new();
    }
    let stepped = channel.interpolation == Interpolation::Step;
    let mut keys: Vec<(f64, f64)> = Vec::new();
    let ends: Vec<(f64, f64)> = channel.times.iter().copied().zip(parameters.iter().copied()).collect();
    for pair in ends.windows(2) {
        let steps = if stepped { 1 } else { PATH_STEPS };
        let between = |i: usize| {
            let s = i as f64 / steps as f64;
            (pair[0].0 + (pair[1].0 - pair[0].0) * s, pair[0].1 + (pair[1].1 - pair[0].1) * s)
        };
        keys.extend((0..steps).map(between));
    }
    keys.extend(ends.last());
    let times: Vec<f32> = keys.iter().map(|k| k.0 as f32).collect();
    let interpolation = if stepped { Interpolation::Step } else { Interpolation::Linear };
    let places: Vec<DVec3> = keys.iter().map(|k| on_path(points, k.1).0).collect();
    let mut tracks =
        vec![Track { path: "translation", times: times.clone(), values: vectors(&places), interpolation }];
    if look_ahead {
        let turns: Vec<DQuat> = keys.iter().map(|k| along(on_path(points, k.1).1)).collect();
        tracks.push(Track { path: "rotation", times, values: rotations(&turns), interpolation });
    }
    tracks
}

/// Place and direction at `parameter` in [0, 1] of a chain of cubic Bézier pieces.
fn on_path(points: &[DVec3], parameter: f64) -> (DVec3, DVec3) {
    let pieces = (points.len() - 1) / 3;
    let at = parameter.clamp(0.0, 1.0) * pieces as f64;
    let piece = (at as usize).min(pieces - 1);
    let t = at - piece as f64;
    let p = &points[3 * piece..][..4];
    let halve = |a: DVec3, b: DVec3| a.lerp(b, t);
    let (a, b, c) = (halve(p[0], p[1]), halve(p[1], p[2]), halve(p[2], p[3]));
    let (a, b) = (halve(a, b), halve(b, c));
    let chord = p[3] - p[0];
    (halve(a, b), if (b - a).length_squared() > 0.0 { b - a } else { chord })
}

/// The turn that takes -z to `direction` and keeps +y up as far as that allows.
fn along(direction: DVec3) -> DQuat {
    let back = -direction.normalize_or(DVec3::NEG_Z);
    let right = DVec3::Y.cross(back).normalize_or(DVec3::X);
    DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back))
}
