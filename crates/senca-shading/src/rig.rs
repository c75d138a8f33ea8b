//! All lights of a scene, ready for many evaluations.

use senca_math::LinearRgb;
use senca_math::glam::Vec3;
use senca_scene::{Environment, LightKind, Scene};

use crate::{Incident, ShadingLight};

/// Lights in world space and the ambient light around them. There may be any number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightRig {
    /// Ia: the scene's, and the sum of its ambient lights.
    pub ambient: LinearRgb,
    /// The lights.
    pub lights: Vec<ShadingLight>,
}

/// Where a surface is evaluated, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingPoint {
    /// The place.
    pub position: Vec3,
    /// Unit normal on the side of the observer.
    pub normal: Vec3,
    /// Unit direction towards the observer.
    pub to_viewer: Vec3,
}

impl LightRig {
    /// The lights that the nodes of `scene` place, in the order of nodes. A scene with an environment
    /// for its background and no ambient light of its own gets the environment's mean colour as that.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let mut rig = Self { ambient: ambient_without_lights(scene), lights: Vec::new() };
        for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
            let (Some(id), Some(world_from_light)) = (node.light, world_from_node) else { continue };
            let Some(light) = scene.lights.get(id.index()) else { continue };
            if light.kind == LightKind::Ambient {
                rig.ambient += light.color;
            }
            ShadingLight::resolve(light, &world_from_light, |l| rig.lights.push(l));
        }
        rig
    }

    /// Calls `visit` with the light that each source sends to `position`, in order.
    #[inline]
    pub fn for_each_incident(&self, position: Vec3, mut visit: impl FnMut(Incident)) {
        for light in &self.lights {
            if let Some(incident) = light.incident(position) {
                visit(incident);
            }
        }
    }
}

/// Ambient light of a scene without its lights: its own, or the mean colour of the environment where it
/// has none of its own.
#[must_use]
pub fn ambient_without_lights(scene: &Scene) -> LinearRgb {
    if scene.ambient != LinearRgb::BLACK {
        return scene.ambient;
    }
    Environment::of(scene).map_or(LinearRgb::BLACK, |environment| environment.mean())
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::glam::{DMat4, DVec3};
    use senca_scene::{Attenuation, Light, LightId, Node, Transform};

    #[test]
    fn lights_come_in_the_order_of_nodes_and_ambient_adds_up() {
        let mut scene = Scene { ambient: LinearRgb::splat(0.25), ..Scene::default() };
        for (i, kind) in [LightKind::Point, LightKind::Ambient, LightKind::Parallel].into_iter().enumerate() {
            scene.lights.push(Light {
                name: String::new(),
                color: LinearRgb::splat(0.5),
                attenuation: Attenuation::None,
                kind,
            });
            let at = DMat4::from_translation(DVec3::X * i as f64);
            let node =
                Node { light: Some(LightId(i as u32)), transform: Transform::Matrix(at), ..Node::default() };
            let id = scene.add_node(node);
            scene.roots.push(id);
        }
        let rig = LightRig::of_scene(&scene);
        assert_eq!(rig.ambient, LinearRgb::splat(0.75));
        assert_eq!(rig.lights.iter().map(|l| l.position.x).collect::<Vec<_>>(), [0.0, 2.0]);
    }
}
