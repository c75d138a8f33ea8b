//! Light for scenes that bring none.
//!
//! Three parallel lights that go with the camera (the photographer's key, fill and rim light) and a
//! little ambient light. The key comes from the upper left, as drawing programs have it, the fill
//! from the right without a highlight worth mentioning, the rim from behind above; so every side that
//! can be seen is lit by one or two of them, differently. A white matt surface stays below full white
//! whichever way it faces: ambient plus the largest sum of two lights is 0.96 (see the tests).

use senca_math::LinearRgb;
use senca_math::glam::{DMat3, DMat4, DVec3};

use crate::{Attenuation, Background, Light, LightKind, Node, Scene, Transform};

/// Lights with their places, and ambient light.
#[derive(Clone, Debug, PartialEq)]
pub struct DefaultLights {
    /// Lights with `world_from_light`, each shining along its -z.
    pub lights: Vec<(Light, DMat4)>,
    /// Ambient light.
    pub ambient: LinearRgb,
}

/// Name, intensity, and direction in the camera's frame from the scene towards the light.
const LIGHTS: [(&str, f32, DVec3); 3] = [
    ("key", 0.85, DVec3::new(-0.6, 0.75, 0.65)),
    ("fill", 0.20, DVec3::new(0.9, -0.2, 0.55)),
    ("rim", 0.35, DVec3::new(0.3, 0.8, -0.9)),
];

/// Ambient light that goes with the default lights.
const AMBIENT: f32 = 0.07;

/// The default lights for a camera.
#[must_use]
pub fn default_lights(world_from_camera: &DMat4) -> DefaultLights {
    let (_, rotation, _) = world_from_camera.to_scale_rotation_translation();
    let turn = if rotation.is_finite() { DMat3::from_quat(rotation.normalize()) } else { DMat3::IDENTITY };
    let placed = |&(name, intensity, towards): &(&str, f32, DVec3)| {
        let light = Light {
            name: name.to_owned(),
            color: LinearRgb::splat(intensity),
            attenuation: Attenuation::None,
            kind: LightKind::Parallel,
        };
        // z points from the scene to the light, so that -z shines on the scene.
        let z = (turn * towards).normalize_or(DVec3::Z);
        let (x, y) = z.any_orthonormal_pair();
        (light, DMat4::from_mat3(DMat3::from_cols(x, y, z)))
    };
    DefaultLights { lights: LIGHTS.iter().map(placed).collect(), ambient: LinearRgb::splat(AMBIENT) }
}

impl Scene {
    /// Whether a node that a root reaches places a light, or there is ambient light or an environment
    /// for a background. Surfaces that
    /// give off light count only for methods that spread it, so they do not count here.
    #[must_use]
    pub fn is_lit(&self) -> bool {
        let places = |(node, place): (&Node, &Option<DMat4>)| {
            place.is_some() && node.light.is_some_and(|light| light.index() < self.lights.len())
        };
        let surroundings =
            matches!(self.background, Background::Environment { strength, .. } if strength > 0.0);
        self.ambient.max_component() > 0.0
            || surroundings
            || self.nodes.iter().zip(&self.world_from_nodes()).any(places)
    }

    /// Adds the default lights for a camera, and their ambient light, unless the scene is lit.
    /// Returns whether it did.
    pub fn light_by_default(&mut self, world_from_camera: &DMat4) -> bool {
        if self.is_lit() {
            return false;
        }
        let default = default_lights(world_from_camera);
        self.ambient = default.ambient;
        for (light, world_from_light) in default.lights {
            let name = light.name.clone();
            let light = self.add_light(light);
            let transform = Transform::Matrix(world_from_light);
            let node = self.add_node(Node { name, light: Some(light), transform, ..Node::default() });
            self.roots.push(node);
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;

    /// Light on a matt white surface with this normal, under the default lights of an unturned camera.
    fn shade(normal: DVec3) -> f64 {
        let default = default_lights(&DMat4::IDENTITY);
        let direct = |(light, place): &(Light, DMat4)| {
            f64::from(light.color.r) * normal.dot(place.z_axis.truncate()).max(0.0)
        };
        f64::from(default.ambient.r) + default.lights.iter().map(direct).sum::<f64>()
    }

    #[test]
    fn nothing_is_burnt_out_and_no_visible_side_is_black() {
        let mut brightest: f64 = 0.0;
        let mut darkest = f64::INFINITY;
        for i in 0..64 {
            for j in 0..64 {
                let (theta, phi) =
                    (f64::from(i) / 63.0 * std::f64::consts::PI, f64::from(j) / 64.0 * std::f64::consts::TAU);
                let normal = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
                brightest = brightest.max(shade(normal));
                if normal.z > 0.3 {
                    darkest = darkest.min(shade(normal));
                }
            }
        }
        assert!(brightest <= 0.96 && brightest > 0.8, "{brightest}");
        assert!(darkest >= 0.069, "{darkest}");
    }

    #[test]
    fn the_three_visible_sides_of_a_box_differ() {
        let camera = crate::frame_bounds(&senca_math::Aabb { min: -DVec3::ONE, max: DVec3::ONE }, 1.0);
        let into_camera = DMat3::from_mat4(camera.world_from_camera).transpose();
        let mut sides = [DVec3::X, DVec3::Y, DVec3::Z].map(|n| shade(into_camera * n));
        sides.sort_by(f64::total_cmp);
        assert!(sides[0] > 0.12 && sides[1] / sides[0] > 1.15 && sides[2] / sides[1] > 1.15, "{sides:?}");
    }

    #[test]
    fn only_scenes_without_light_get_it() {
        let mut scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        assert!(!scene.is_lit() && scene.light_by_default(&DMat4::IDENTITY));
        assert_eq!((scene.lights.len(), scene.nodes.len(), scene.roots.len()), (3, 4, 4));
        assert!(scene.is_lit() && !scene.light_by_default(&DMat4::IDENTITY));
    }
}
