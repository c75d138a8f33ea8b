//! The lights of a scene with what shadow rays need.

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec3};
use senca_scene::{LightKind, Scene};
use senca_shading::{AmbientLight, Lamp, ShadingLight};

use crate::Sampler;

/// A light of the scene.
#[derive(Clone, Debug)]
pub(crate) struct TracedLight {
    /// Name of the light, or of its node.
    pub(crate) name: String,
    /// What it sends where nothing is between; one of the places of an area light.
    light: ShadingLight,
    form: Form,
}

/// What a light is for shadow rays.
#[derive(Clone, Copy, Debug)]
enum Form {
    /// A place.
    Place(DVec3),
    /// Parallel light from infinitely far, towards it.
    Far(DVec3),
    /// Parallel light from a plane through a place, along an axis.
    Plane { place: DVec3, axis: DVec3 },
    /// A rectangle, as the frame whose unit square around the origin it is.
    Area(DMat4),
}

/// Where a shadow ray goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ToLight {
    /// To a place.
    Place(DVec3),
    /// Without end, along a unit vector.
    Far(DVec3),
}

/// The lights that the nodes of `scene` place, in the order of nodes, and all ambient light.
pub(crate) fn lights_of(scene: &Scene) -> (Vec<TracedLight>, AmbientLight) {
    let mut lights = Vec::new();
    for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
        let (Some(id), Some(world_from_light)) = (node.light, world_from_node) else { continue };
        let Some(light) = scene.lights.get(id.index()) else { continue };
        let mut first = None;
        ShadingLight::resolve(light, &world_from_light, |resolved| {
            first.get_or_insert(resolved);
        });
        let Some(mut resolved) = first else { continue };
        let form = form_of(light.kind, &world_from_light);
        if matches!(form, Form::Area(_)) {
            resolved.color = light.color;
        }
        let name = if light.name.is_empty() { &node.name } else { &light.name };
        lights.push(TracedLight { name: name.clone(), light: resolved, form });
    }
    (lights, AmbientLight::of_scene(scene))
}

fn form_of(kind: LightKind, world_from_light: &DMat4) -> Form {
    let place = world_from_light.transform_point3(DVec3::ZERO);
    let axis = world_from_light.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
    match kind {
        LightKind::Parallel => Form::Far(-axis),
        LightKind::BoxSpot { .. } => Form::Plane { place, axis },
        LightKind::Area { size, .. } => {
            Form::Area(*world_from_light * DMat4::from_scale(DVec3::new(size[0], size[1], 1.0)))
        }
        LightKind::Point | LightKind::Spot(_) | LightKind::Ambient => Form::Place(place),
    }
}

impl TracedLight {
    /// The way to the light and what it sends, where that is the same from everywhere.
    pub(crate) fn simple(&self) -> Option<(ToLight, LinearRgb)> {
        let to_light = match (self.form, self.light.lamp) {
            (Form::Place(place), Lamp::Point) => ToLight::Place(place),
            (Form::Far(direction), Lamp::Parallel) => ToLight::Far(direction),
            _ => return None,
        };
        let steady = self.light.attenuation == senca_scene::Attenuation::None;
        steady.then_some((to_light, self.light.color))
    }

    /// How many places of the light are looked at when an area light gets `per_side` along each side;
    /// 0 stands for its middle alone.
    #[inline]
    pub(crate) fn places(&self, per_side: u32) -> u32 {
        if matches!(self.form, Form::Area(_)) { (per_side * per_side).max(1) } else { 1 }
    }

    /// Place `index` of [`TracedLight::places`]: the light as it shines from there, and the way to it
    /// from `point`. The places of an area light are random ones, each in its own cell of a grid.
    #[inline]
    pub(crate) fn place(
        &self,
        index: u32,
        per_side: u32,
        sampler: Sampler,
        point: DVec3,
    ) -> (ShadingLight, ToLight) {
        match self.form {
            Form::Place(place) => (self.light, ToLight::Place(place)),
            Form::Far(direction) => (self.light, ToLight::Far(direction)),
            Form::Plane { place, axis } => {
                let length = (point - place).dot(axis);
                (self.light, ToLight::Place(point - length * axis))
            }
            Form::Area(world_from_square) => {
                let place = area_place(&world_from_square, index, per_side, sampler);
                let share = f64::from(self.places(per_side)).recip() as f32;
                let light =
                    ShadingLight { position: place.as_vec3(), color: self.light.color * share, ..self.light };
                debug_assert!(light.lamp == Lamp::Patch, "area lights shine as plane lamps");
                (light, ToLight::Place(place))
            }
        }
    }
}

/// A random place in cell `index` of a grid of `n` x `n` over a rectangle; its middle for n = 0.
fn area_place(world_from_square: &DMat4, index: u32, n: u32, mut sampler: Sampler) -> DVec3 {
    let within = if n == 0 { [0.5; 2] } else { sampler.next_2d() };
    let n = n.max(1);
    let along = |cell: u32, within: f64| (f64::from(cell) + within) / f64::from(n) - 0.5;
    let place = DVec3::new(along(index % n, within[0]), along(index / n, within[1]), 0.0);
    world_from_square.transform_point3(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pattern;
    use senca_scene::{
        Attenuation, Background, ImageData, ImageId, Light, LightId, Node, NodeId, TextureImage,
    };
    use senca_shading::LightRig;

    fn sampler() -> Sampler {
        Sampler::new(Pattern::Sobol, 0, 0, 0, 0)
    }

    fn only(kind: LightKind) -> TracedLight {
        let light =
            Light { name: String::new(), color: LinearRgb::WHITE, attenuation: Attenuation::None, kind };
        let node = Node { name: "lamp".into(), light: Some(LightId(0)), ..Node::default() };
        let scene =
            Scene { lights: vec![light], nodes: vec![node], roots: vec![NodeId(0)], ..Scene::default() };
        lights_of(&scene).0.remove(0)
    }

    #[test]
    fn surroundings_light_as_they_do_in_the_pipeline() {
        let data = ImageData::RgbaF32 { width: 1, height: 1, texels: vec![[0.5, 0.25, 0.125, 1.0]] };
        let images = vec![TextureImage { name: String::new(), data }];
        let background = Background::Environment { image: ImageId(0), strength: 1.0, rotation: 0.0 };
        let scene = Scene { images, background, ..Scene::default() };
        let ambient = lights_of(&scene).1;
        assert!((ambient.towards(senca_math::glam::Vec3::X).r - 0.5).abs() < 1e-4, "{ambient:?}");
        assert_eq!(ambient, LightRig::of_scene(&scene).ambient);
    }

    #[test]
    fn ways_end_at_the_light() {
        let point = DVec3::new(0.0, 0.0, -4.0);
        let way = |kind| only(kind).place(0, 0, sampler(), point).1;
        assert_eq!(way(LightKind::Point), ToLight::Place(DVec3::ZERO));
        assert_eq!(way(LightKind::Parallel), ToLight::Far(DVec3::Z));
        let prism = LightKind::BoxSpot { min: [-1.0; 2], max: [1.0; 2], depth: 9.0 };
        let aside = only(prism).place(0, 0, sampler(), point + DVec3::X).1;
        assert_eq!(aside, ToLight::Place(DVec3::X));
        assert_eq!(way(LightKind::Area { size: [2.0; 2], visible: true }), ToLight::Place(DVec3::ZERO));
    }

    #[test]
    fn places_of_an_area_light_lie_in_their_cells() {
        let light = only(LightKind::Area { size: [2.0, 4.0], visible: true });
        assert_eq!((light.places(3), only(LightKind::Point).places(3)), (9, 1));
        assert_eq!(light.name, "lamp");
        for index in 0..9 {
            let (at, _) = light.place(index, 3, sampler(), DVec3::NEG_Z);
            let cell = |v: f32, length: f32| ((v / length + 0.5) * 3.0) as u32;
            assert_eq!((cell(at.position.x, 2.0), cell(at.position.y, 4.0)), (index % 3, index / 3));
            assert!((at.color.r - 1.0 / 9.0).abs() < 1e-7);
        }
    }
}
