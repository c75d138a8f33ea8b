//! Area lights as they are seen: rectangles that shine, in the renderers that have no lamps among what
//! rays and polygons meet.
//!
//! A lamp shows the radiance that the path tracer gives it, pi times its colour over its area, from the side
//! it shines to. Where its light does not fall with the square of the distance, it shows what it sends to
//! the eye. The rectangle is put at the node of the light, so it throws no shadow.

use std::f32::consts::PI;

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec3};
use senca_math::{Aabb, View, ViewKind};
use senca_scene::{
    Attenuation, Geometry, Light, LightId, LightKind, Material, Node, NodeId, Phong, Reflection, Scene,
    Shape, Transform,
};
use senca_shading::distance_attenuation;

/// An area light that is seen.
#[derive(Clone, Copy, Debug)]
struct Seen {
    node: NodeId,
    light: LightId,
    world_from_light: DMat4,
    size: [f64; 2],
}

fn seen_lamps(scene: &Scene) -> Vec<Seen> {
    let places = scene.world_from_nodes();
    let nodes = (0..).map(NodeId).zip(scene.nodes.iter().zip(places));
    nodes
        .filter_map(|(node, (placed, world_from_light))| {
            // A node with a shape has its own look.
            let id = placed.light.filter(|_| placed.geometry.is_none())?;
            let light = scene.lights.get(id.index())?;
            let LightKind::Area { size, visible: true } = light.kind else { return None };
            let shines = light.color.max_component() > 0.0;
            shines.then_some(Seen { node, light: id, world_from_light: world_from_light?, size })
        })
        .collect()
}

impl Seen {
    /// Corners in the light's frame, counter-clockwise as seen from where it shines to.
    fn outline(&self) -> [DVec3; 4] {
        let [x, y] = self.size.map(|edge| 0.5 * edge);
        [[-x, -y], [-x, y], [x, y], [x, -y]].map(|[x, y]| DVec3::new(x, y, 0.0))
    }

    /// What it shows to someone this far from its middle; `None` in a parallel view.
    fn radiance(&self, light: &Light, eye: Option<DVec3>) -> LinearRgb {
        let [x, y] = [DVec3::X * self.size[0], DVec3::Y * self.size[1]];
        let edges = [x, y].map(|edge| self.world_from_light.transform_vector3(edge));
        let area = edges[0].cross(edges[1]).length() as f32;
        let middle = self.world_from_light.transform_point3(DVec3::ZERO);
        let share = match (light.attenuation, eye) {
            (Attenuation::InverseSquare { range: None }, _) | (_, None) => 1.0,
            (other, Some(eye)) => {
                let distance = eye.distance(middle) as f32;
                distance * distance * distance_attenuation(&other, distance)
            }
        };
        let radiance = light.color * (PI * share / area);
        if radiance.max_component().is_finite() { radiance } else { light.color }
    }
}

/// Box around the area lights of a scene that are seen.
pub(crate) fn bounds_of_lamps(scene: &Scene) -> Aabb {
    let place = |lamp: &Seen| lamp.outline().map(|p| lamp.world_from_light.transform_point3(p));
    Aabb::of_points(seen_lamps(scene).iter().flat_map(place))
}

/// What the brightest of the area lights that are seen shows, its largest channel; 0 without any.
pub(crate) fn brightest_lamp(scene: &Scene) -> f32 {
    let shows = |lamp: Seen| lamp.radiance(&scene.lights[lamp.light.index()], None).max_component();
    seen_lamps(scene).into_iter().map(shows).fold(0.0, f32::max)
}

/// Lets the area lights of `scene` be seen in it.
pub(crate) fn show_lamps(scene: &mut Scene, view: &View) {
    let eye = match view.kind {
        ViewKind::Central { eye_world } => Some(eye_world),
        ViewKind::Parallel { .. } => None,
    };
    for lamp in seen_lamps(scene) {
        let radiance = lamp.radiance(&scene.lights[lamp.light.index()], eye);
        let glow = Material {
            name: "lamp".into(),
            emission: radiance,
            reflection: Reflection::Phong(black()),
            ..Material::default()
        };
        add_shape(scene, &lamp, glow, Some(lamp.light));
        // The lamp has moved to the shape's node: at the end, so that other objects keep their numbers.
        scene.nodes[lamp.node.index()].light = None;
    }
}

/// Adds the area lights of `scene` to a scene of light that others show: as unlit surfaces, no brighter than
/// white.
pub(crate) fn bake_lamps(scene: &Scene, exposure: f32, baked: &mut Scene) {
    for lamp in seen_lamps(scene) {
        let radiance = lamp.radiance(&scene.lights[lamp.light.index()], None) * exposure;
        let color = radiance.map(|v| v.min(1.0));
        let reflection = Reflection::Phong(Phong { ambient: color, diffuse: color, ..Phong::default() });
        let glow = Material { name: "lamp".into(), reflection, unlit: true, ..Material::default() };
        add_shape(baked, &lamp, glow, None);
    }
}

/// Copies what [`show_lamps`] has put into `scene`.
pub(crate) fn copy_lamps(scene: &Scene, to: &mut Scene) {
    for node in &scene.nodes {
        let (Some(_), Some(geometry)) = (node.light, node.geometry) else { continue };
        let geometry = &scene.geometries[geometry.index()];
        let Some(material) = geometry.material else { continue };
        let material = Some(to.add_material(scene.materials[material.index()].clone()));
        let geometry = Some(to.add_geometry(Geometry { material, ..geometry.clone() }));
        let node = to.add_node(Node { transform: node.transform, geometry, ..Node::default() });
        to.roots.push(node);
    }
}

fn black() -> Phong {
    Phong {
        ambient: LinearRgb::BLACK,
        diffuse: LinearRgb::BLACK,
        specular: LinearRgb::BLACK,
        ..Phong::default()
    }
}

fn add_shape(scene: &mut Scene, lamp: &Seen, material: Material, light: Option<LightId>) {
    let material = Some(scene.add_material(material));
    let shape = Shape::Polygon { outline: lamp.outline().to_vec(), holes: Vec::new() };
    let geometry = Some(scene.add_geometry(Geometry { name: "lamp".into(), shape, material }));
    let transform = Transform::Matrix(lamp.world_from_light);
    let node = Node { name: "lamp".into(), transform, geometry, light, ..Node::default() };
    let node = scene.add_node(node);
    scene.roots.push(node);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Display, LookAt, Method, RadiositySettings, Settings, Viewpoint, render};
    use senca_scene::Background;

    /// A floor, an area light of 1 x 1 above it that shows 2, and a bulb above that.
    fn hall(visible: bool) -> Scene {
        let mut scene = Scene::of_shape("floor", Shape::Plane { size: Some(6.0) });
        scene.background = Background::Color(LinearRgb::BLACK);
        // Without highlights, in which the lamp is mirrored.
        let grey = LinearRgb::splat(0.5);
        let reflection = Reflection::Phong(Phong { diffuse: grey, ..black() });
        scene.geometries[0].material =
            Some(scene.add_material(Material { reflection, ..Material::default() }));
        let kinds = [LightKind::Area { size: [1.0, 1.0], visible }, LightKind::Point];
        for (kind, (y, color)) in kinds.into_iter().zip([(2.0, 2.0 / PI), (3.0, 0.5)]) {
            let color = LinearRgb::splat(color);
            let attenuation = Attenuation::InverseSquare { range: None };
            scene.lights.push(Light { name: String::new(), color, attenuation, kind });
            let light = Some(LightId(scene.lights.len() as u32 - 1));
            let down =
                DMat4::from_translation(DVec3::Y * y) * DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
            let node = scene.add_node(Node { light, transform: Transform::Matrix(down), ..Node::default() });
            scene.roots.push(node);
        }
        scene
    }

    fn seen(scene: &Scene, method: Method, display: Display, eye: DVec3, target: DVec3) -> f32 {
        let look = LookAt { eye: Some(eye), target: Some(target), up: Some(DVec3::Z) };
        let mut settings = Settings {
            size: Some([3, 3]),
            viewpoint: Viewpoint::LookAt(look),
            yfov: Some(0.05),
            method,
            radiosity: RadiositySettings { display, ..RadiositySettings::default() },
            ..Settings::default()
        };
        settings.radiosity.hierarchy.threshold = 0.01;
        render(scene, &settings).expect("a picture").0.pixel(1, 1)[0]
    }

    const METHODS: [(Method, Display); 5] = [
        (Method::Raster, Display::Bilinear),
        (Method::Trace, Display::Bilinear),
        (Method::Radiosity, Display::Bilinear),
        (Method::Radiosity, Display::Gouraud),
        (Method::Radiosity, Display::Trace),
    ];

    #[test]
    fn all_methods_see_area_lights_from_where_they_shine() {
        let [below, above] = [DVec3::new(0.0, 0.5, 0.1), DVec3::new(0.0, 2.5, 0.1)];
        let lamp = DVec3::new(0.0, 2.0, 0.0);
        let hidden = hall(false);
        let shown = hall(true);
        let path = seen(&shown, Method::Path, Display::default(), below, lamp);
        assert!((path - 2.0).abs() < 1e-4, "{path}");
        for (method, display) in METHODS {
            let found = seen(&shown, method, display, below, lamp);
            assert!((found - path).abs() < 1e-3, "{method:?} {display:?}: {found}");
            assert_eq!(seen(&hidden, method, display, below, lamp), 0.0, "{method:?} {display:?}");
            let behind = [&shown, &hidden].map(|scene| seen(scene, method, display, above, lamp));
            assert!((behind[0] - behind[1]).abs() < 0.01 && behind[0] > 0.0, "{method:?}: {behind:?}");
        }
        assert_eq!(seen(&hidden, Method::Path, Display::default(), below, lamp), 0.0);
    }

    #[test]
    fn area_lights_throw_no_shadow_and_light_the_same_when_hidden() {
        let (eye, floor) = (DVec3::new(0.0, 1.0, 0.1), DVec3::ZERO);
        for (method, display) in METHODS {
            let [shown, hidden] = [true, false].map(|v| seen(&hall(v), method, display, eye, floor));
            // The shadow of the bulb's light would take a quarter. Soft shadows are looked for elsewhere.
            assert!((shown / hidden - 1.0).abs() < 0.02, "{method:?} {display:?}: {shown} {hidden}");
        }
    }

    #[test]
    fn other_light_is_seen_as_what_it_sends_to_the_eye() {
        let mut scene = hall(true);
        scene.lights[0].attenuation = Attenuation::None;
        let (eye, lamp) = (DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.0, 2.0, 0.0));
        let [path, trace] =
            [Method::Path, Method::Trace].map(|m| seen(&scene, m, Display::default(), eye, lamp));
        assert!((path - 2.0 * 1.5 * 1.5).abs() < 0.01 && (trace - path).abs() < 0.01, "{path} {trace}");
    }
}
