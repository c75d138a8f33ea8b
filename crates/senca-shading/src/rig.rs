//! All lights of a scene, ready for many evaluations.

use senca_math::LinearRgb;
use senca_math::glam::Vec3;
use senca_scene::{Environment, Irradiance, LightKind, Scene};

use crate::{Incident, ShadingLight};

/// Lights in world space and the ambient light around them. There may be any number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightRig {
    /// Ia: the scene's, and the sum of its ambient lights.
    pub ambient: AmbientLight,
    /// The lights.
    pub lights: Vec<ShadingLight>,
}

/// Ambient light: the same from all sides, and the light of surroundings, which is not.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AmbientLight {
    even: LinearRgb,
    surroundings: Option<Irradiance>,
}

impl AmbientLight {
    /// The ambient light of `scene`: its own, that of the lights of this kind that its nodes place, and
    /// the light of its environment where it has none of its own.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let mut ambient = Self::from(scene.ambient);
        for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
            let light = node.light.filter(|_| world_from_node.is_some());
            let light = light.and_then(|id| scene.lights.get(id.index()));
            if let Some(light) = light.filter(|light| light.kind == LightKind::Ambient) {
                ambient.even += light.color;
            }
        }
        if scene.ambient == LinearRgb::BLACK {
            ambient.surroundings = Environment::of(scene).map(|environment| environment.irradiance());
        }
        ambient
    }

    /// What a white matt surface that faces this way (unit, world space) shows of it.
    #[must_use]
    #[inline]
    pub fn towards(&self, normal: Vec3) -> LinearRgb {
        match &self.surroundings {
            None => self.even,
            Some(surroundings) => self.even + surroundings.towards(normal),
        }
    }

    /// The light, where it is the same from all sides.
    #[must_use]
    pub fn even(&self) -> Option<LinearRgb> {
        self.surroundings.is_none().then_some(self.even)
    }

    /// Whether there is none.
    #[must_use]
    #[inline]
    pub fn is_none(&self) -> bool {
        self.surroundings.is_none() && self.even == LinearRgb::BLACK
    }
}

impl From<LinearRgb> for AmbientLight {
    fn from(even: LinearRgb) -> Self {
        Self { even, surroundings: None }
    }
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
    /// The lights that the nodes of `scene` place, in the order of nodes, and its ambient light; see
    /// [`AmbientLight::of_scene`].
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let mut rig = Self { ambient: AmbientLight::of_scene(scene), lights: Vec::new() };
        for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
            let (Some(id), Some(world_from_light)) = (node.light, world_from_node) else { continue };
            let Some(light) = scene.lights.get(id.index()) else { continue };
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
        assert_eq!(rig.ambient, LinearRgb::splat(0.75).into());
        assert_eq!(rig.lights.iter().map(|l| l.position.x).collect::<Vec<_>>(), [0.0, 2.0]);
    }
}
