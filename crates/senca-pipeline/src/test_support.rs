//! What the tests of several modules share.

use senca_math::glam::{DMat4, DVec3, DVec4};
use senca_math::{Image, LinearRgb};
use senca_scene::{Attenuation, Light, LightId, LightKind, Node, Scene, Transform};

/// How two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Difference {
    /// Pixels that differ by more than the limit in some channel.
    pub(crate) pixels: usize,
    /// The first of them.
    pub(crate) first: Option<(u32, u32, [f32; 4], [f32; 4])>,
    /// Mean absolute difference over all channels.
    pub(crate) mean: f64,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} pixels differ, by {:.2e} in the mean", self.pixels, self.mean)?;
        if let Some((x, y, one, other)) = self.first {
            write!(f, "; the first at ({x}, {y}): {one:?} and {other:?}")?;
        }
        Ok(())
    }
}

/// How `one` and `other` differ, pixels within `limit` counting as alike.
pub(crate) fn picture_difference(one: &Image, other: &Image, limit: f32) -> Difference {
    assert_eq!((one.width(), one.height()), (other.width(), other.height()), "pictures of one size");
    let mut difference = Difference { pixels: 0, first: None, mean: 0.0 };
    for (i, (a, b)) in one.pixels().iter().zip(other.pixels()).enumerate() {
        difference.mean += a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>();
        if a.iter().zip(b).any(|(a, b)| (a - b).abs() > limit) {
            let place = (i as u32 % one.width(), i as u32 / one.width());
            difference.first = difference.first.or(Some((place.0, place.1, *a, *b)));
            difference.pixels += 1;
        }
    }
    difference.mean /= (4 * one.pixels().len()) as f64;
    difference
}

/// The largest difference of any channel.
pub(crate) fn largest_difference(one: &Image, other: &Image) -> f32 {
    let pairs = one.pixels().iter().flatten().zip(other.pixels().iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Adds parallel light that comes from the direction of `from`.
pub(crate) fn add_lamp(scene: &mut Scene, from: DVec3, intensity: f32) {
    let z = from.normalize();
    let x = z.any_orthonormal_vector();
    let frame = DMat4::from_cols(x.extend(0.0), z.cross(x).extend(0.0), z.extend(0.0), DVec4::W);
    scene.lights.push(Light {
        name: String::new(),
        color: LinearRgb::splat(intensity),
        attenuation: Attenuation::None,
        kind: LightKind::Parallel,
    });
    let light = Some(LightId(scene.lights.len() as u32 - 1));
    let node = scene.add_node(Node { light, transform: Transform::Matrix(frame), ..Node::default() });
    scene.roots.push(node);
}
