use std::f64::consts::FRAC_PI_2;

use proptest::prelude::*;

use super::*;
use crate::{ChannelTarget, NodeId};

fn channel(times: &[f64], values: ChannelValues, interpolation: Interpolation) -> Channel {
    Channel { target: ChannelTarget { node: NodeId(0) }, times: times.to_vec(), values, interpolation }
}

fn along_x(values: &[f64]) -> ChannelValues {
    ChannelValues::Translation(values.iter().map(|&x| DVec3::X * x).collect())
}

fn x_at(channel: &Channel, t: f64) -> f64 {
    match channel.sample(t) {
        Some(ChannelValue::Translation(v) | ChannelValue::Path { translation: v, .. }) => v.x,
        other => panic!("{other:?}"),
    }
}

#[test]
fn steps_jump_and_lines_do_not() {
    let step = channel(&[1.0, 2.0, 4.0], along_x(&[10.0, 20.0, 40.0]), Interpolation::Step);
    assert_eq!(
        [0.0, 1.0, 1.99, 2.0, 3.9, 4.0, 9.0].map(|t| x_at(&step, t)),
        [10.0, 10.0, 10.0, 20.0, 20.0, 40.0, 40.0]
    );
    let line = channel(&[1.0, 2.0, 4.0], along_x(&[10.0, 20.0, 40.0]), Interpolation::Linear);
    assert_eq!([0.0, 1.5, 3.0, 9.0, f64::NAN].map(|t| x_at(&line, t)), [10.0, 15.0, 30.0, 40.0, 10.0]);
    let single = channel(&[3.0], along_x(&[7.0]), Interpolation::Linear);
    assert_eq!([0.0, 3.0, 9.0].map(|t| x_at(&single, t)), [7.0; 3]);
}

#[test]
fn cubic_splines_are_hermite_pieces() {
    // x = t^2 has tangent 2 t: a cubic spline through its keys is exact.
    let keys = [0.0f64, 1.0, 3.0];
    let values: Vec<f64> = keys.iter().flat_map(|t| [2.0 * t, t * t, 2.0 * t]).collect();
    let spline = channel(&keys, along_x(&values), Interpolation::CubicSpline);
    for i in 0..=30 {
        let t = f64::from(i) / 10.0;
        assert!((x_at(&spline, t) - t * t).abs() < 1e-12);
    }
}

#[test]
fn rotations_go_the_short_way() {
    let (a, b) = (DQuat::IDENTITY, DQuat::from_rotation_y(FRAC_PI_2));
    let turn = channel(&[0.0, 1.0], ChannelValues::Rotation(vec![a, -b]), Interpolation::Linear);
    let Some(ChannelValue::Rotation(q)) = turn.sample(0.5) else { panic!("no rotation") };
    assert!(q.angle_between(DQuat::from_rotation_y(FRAC_PI_2 / 2.0)) < 1e-7);
    let broken = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let turn = channel(&[0.0, 1.0], ChannelValues::Rotation(vec![broken, b]), Interpolation::Linear);
    let Some(ChannelValue::Rotation(q)) = turn.sample(0.5) else { panic!("no rotation") };
    assert!((q.length() - 1.0).abs() < 1e-12);
}

#[test]
fn weights_come_key_by_key() {
    let weights = ChannelValues::Weights { count: 2, values: vec![0.0, 1.0, 1.0, 3.0] };
    let weights = channel(&[0.0, 1.0], weights, Interpolation::Linear);
    assert_eq!(weights.sample(0.5), Some(ChannelValue::Weights(vec![0.5, 2.0])));
    let cubic = ChannelValues::Weights {
        count: 2,
        values: vec![0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 4.0, 0.0, 0.0],
    };
    let cubic = channel(&[0.0, 1.0], cubic, Interpolation::CubicSpline);
    assert_eq!(cubic.sample(0.5), Some(ChannelValue::Weights(vec![2.0, 3.0])));
}

fn path(look_ahead: bool) -> Channel {
    let points = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|x| DVec3::X * x).to_vec();
    channel(
        &[0.0, 6.0],
        ChannelValues::Path { points, parameters: vec![0.0, 1.0], look_ahead },
        Interpolation::Linear,
    )
}

#[test]
fn paths_run_through_their_pieces() {
    for t in [0.0, 1.0, 2.9, 3.0, 3.1, 6.0, 7.0] {
        assert!((x_at(&path(false), t) - f64::min(t, 6.0)).abs() < 1e-12);
    }
    let Some(ChannelValue::Path { rotation: Some(q), .. }) = path(true).sample(2.0) else {
        panic!("no path")
    };
    assert!((q * DVec3::NEG_Z - DVec3::X).length() < 1e-9);
    assert!((q * DVec3::Y - DVec3::Y).length() < 1e-9);
    assert!((look_along(DVec3::Y) * DVec3::NEG_Z - DVec3::Y).length() < 1e-9, "straight up");
    assert!((look_along(DVec3::ZERO) * DVec3::NEG_Z - DVec3::NEG_Z).length() < 1e-9);
}

#[test]
fn a_path_that_starts_slowly_still_looks_ahead() {
    let points = vec![DVec3::ZERO, DVec3::ZERO, DVec3::Z, DVec3::Z * 3.0];
    let values = ChannelValues::Path { points, parameters: vec![0.0], look_ahead: true };
    let Some(ChannelValue::Path { rotation: Some(q), .. }) =
        channel(&[0.0], values, Interpolation::Step).sample(0.0)
    else {
        panic!("no path")
    };
    assert!((q * DVec3::NEG_Z - DVec3::Z).length() < 1e-9);
}

#[test]
fn lists_that_do_not_fit_give_nothing() {
    assert_eq!(channel(&[], along_x(&[1.0]), Interpolation::Linear).sample(0.0), None);
    assert_eq!(channel(&[0.0, 1.0], along_x(&[1.0]), Interpolation::Linear).sample(0.5), None);
    assert_eq!(channel(&[0.0], along_x(&[1.0]), Interpolation::CubicSpline).sample(0.0), None);
    let weights = ChannelValues::Weights { count: usize::MAX, values: vec![1.0] };
    assert_eq!(channel(&[0.0, 1.0], weights, Interpolation::Linear).sample(2.0), None);
    let short = ChannelValues::Path { points: vec![DVec3::ZERO; 3], parameters: vec![0.0], look_ahead: true };
    assert_eq!(channel(&[0.0], short, Interpolation::Linear).sample(0.0), None);
}

proptest! {
    #[test]
    fn any_numbers_are_survived(times in prop::collection::vec(any::<f64>(), 0..5), xs in prop::collection::vec(any::<f64>(), 0..13), t in any::<f64>()) {
        for interpolation in [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline] {
            let _ = channel(&times, along_x(&xs), interpolation).sample(t);
            let path = ChannelValues::Path { points: vec![DVec3::ONE; 7], parameters: xs.clone(), look_ahead: true };
            let _ = channel(&times, path, interpolation).sample(t);
        }
    }
}
