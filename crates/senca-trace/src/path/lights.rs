//! The lights of a scene, one of which is asked at every place that scatters light.
//!
//! Which one is chosen by how much light it may send there: what a lamp sends is known, of the others
//! brightness, size and distance are. A tenth of the choices is even, so nothing that was judged too
//! dark is lost. Of very many lights the same choice is made once for the middle of the scene.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;
use senca_scene::{LightKind, Scene};
use senca_shading::{Lamp, ShadingLight};
use smallvec::SmallVec;
use std::f64::consts::PI;

use super::area::Rectangle;
use super::distribution::Distribution;
use super::glow::Glow;
use super::sky::Sky;
use crate::{Interaction, MaterialTable, Ray, World};

/// Up to this many lights the choice is made anew at every place.
const FEW: usize = 32;

/// Share of choices that does not look at brightness.
const EVEN_SHARE: f64 = 0.1;

/// All that lights the scene.
#[derive(Debug)]
pub(super) struct Lights<'s> {
    sources: Vec<Source<'s>>,
    /// Chances for the middle of the scene, where there are many.
    fixed: Option<Distribution>,
    /// Of each object, the source that it is.
    of_object: Vec<Option<u32>>,
    /// Sources that are rectangles which rays meet.
    rectangles: Vec<u32>,
    /// The source that is the sky.
    of_sky: Option<u32>,
    /// What rays see that leave the scene.
    pub(super) sky: Sky<'s>,
}

#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few, and all are visited")]
enum Source<'s> {
    /// A lamp without extent.
    Lamp(ShadingLight),
    Rectangle(Rectangle),
    Glow(Glow<'s>),
    Sky,
}

/// Light on its way to a place, if nothing is between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Unit direction towards the light.
    pub(super) direction: DVec3,
    /// How far the light is; infinite for the sky and for parallel light.
    pub(super) distance: f64,
    /// Its radiance; of a lamp without extent, what it gives to a surface that faces it.
    pub(super) radiance: LinearRgb,
    /// Density per steradian of its having been chosen; of a lamp without extent, its chance.
    pub(super) pdf: f64,
    /// Whether surfaces cannot find it by themselves.
    pub(super) single: bool,
}

/// A rectangle that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(super) struct MetRectangle {
    pub(super) t: f64,
    source: u32,
}

impl<'s> Lights<'s> {
    /// The lights of the scene of `world`. Ambient light is none of them: it stands for what surfaces
    /// send each other, and that is found here.
    pub(super) fn new(world: &World<'s>, materials: &MaterialTable<'_>) -> Self {
        let scene = world.scene();
        let mut lights = Self {
            sources: placed_lights(scene),
            fixed: None,
            of_object: vec![None; world.objects().len()],
            rectangles: Vec::new(),
            of_sky: None,
            sky: Sky::new(scene),
        };
        for (i, source) in lights.sources.iter().enumerate() {
            if matches!(source, Source::Rectangle(rectangle) if rectangle.visible) {
                lights.rectangles.push(i as u32);
            }
        }
        let places = scene.world_from_nodes();
        for (object, placed) in world.objects().iter().enumerate() {
            // Flattened objects are not where their node is; those can only be met.
            let as_told = places.get(placed.node.index()) == Some(&Some(placed.world_from_object));
            if let Some(glow) = Glow::new(world, materials, object as u32).filter(|_| as_told) {
                lights.of_object[object] = Some(lights.sources.len() as u32);
                lights.sources.push(Source::Glow(glow));
            }
        }
        if lights.sky.can_be_sampled() {
            lights.of_sky = Some(lights.sources.len() as u32);
            lights.sources.push(Source::Sky);
        }
        if lights.sources.len() > FEW {
            lights.fixed = Some(lights.chances_in_the_middle(world));
        }
        lights
    }

    fn chances_in_the_middle(&self, world: &World<'_>) -> Distribution {
        let boxes = world.objects().iter().map(|object| object.bounds_world);
        let bounds = boxes.filter(|b| b.min.is_finite() && b.max.is_finite());
        let bounds = bounds.fold(senca_math::Aabb::EMPTY, |all, b| all.union(b));
        let middle = if bounds.is_empty() { DVec3::ZERO } else { 0.5 * (bounds.min + bounds.max) };
        let weights: Vec<f64> = self.sources.iter().map(|s| self.importance(s, middle)).collect();
        Distribution::new(with_even_share(&weights))
    }

    /// Whether there is anything to ask.
    pub(super) fn is_empty(&self) -> bool {
        self.sources.is_empty()
    }

    /// About how much light a source sends to a point.
    fn importance(&self, source: &Source<'_>, point: DVec3) -> f64 {
        let weight = match source {
            Source::Lamp(lamp) => {
                let incident = lamp.incident(point.as_vec3());
                incident.map_or(0.0, |i| PI * f64::from(i.intensity.luminance()))
            }
            Source::Rectangle(rectangle) => {
                let d2 = (rectangle.middle() - point).length_squared();
                let seen = f64::from(rectangle.seen(d2.sqrt()).luminance());
                seen * rectangle.area / d2.max(rectangle.area)
            }
            Source::Glow(glow) => glow.importance(point),
            Source::Sky => PI * self.sky.brightness(),
        };
        if weight.is_finite() { weight.max(0.0) } else { 0.0 }
    }

    /// Chances of all sources at a point.
    fn chances_at(&self, point: DVec3) -> SmallVec<[f64; FEW]> {
        let weights: SmallVec<[f64; FEW]> =
            self.sources.iter().map(|source| self.importance(source, point)).collect();
        with_even_share(&weights)
    }

    /// The source that `u` falls to, its chance, and what is left of `u`.
    fn choose(&self, point: DVec3, u: f64) -> Option<(usize, f64, f64)> {
        match (&self.fixed, self.sources.len()) {
            (_, 0) => None,
            (_, 1) => Some((0, 1.0, u)),
            (Some(fixed), _) => fixed.choose(u),
            (None, _) => Distribution::new(self.chances_at(point)).choose(u),
        }
    }

    /// Chance of a source at a point.
    fn chance(&self, source: u32, point: DVec3) -> f64 {
        match (&self.fixed, self.sources.len()) {
            (_, 1) => 1.0,
            (Some(fixed), _) => fixed.chance(source as usize),
            (None, _) => self.chances_at(point)[source as usize],
        }
    }

    /// Light that may arrive at `point`. `choice` and `u` are in [0, 1).
    pub(super) fn sample(
        &self,
        world: &World<'_>,
        materials: &MaterialTable<'_>,
        point: DVec3,
        choice: f64,
        u: [f64; 2],
    ) -> Option<Arriving> {
        let (index, chance, rest) = self.choose(point, choice)?;
        match &self.sources[index] {
            Source::Lamp(lamp) => from_lamp(lamp, point, chance),
            Source::Rectangle(rectangle) => {
                let place = rectangle.sample(point, u)?;
                let radiance = rectangle.seen(place.distance);
                let arriving = arriving(place.direction, place.distance, radiance, place.pdf * chance);
                Some(Arriving { single: !rectangle.visible, ..arriving })
            }
            Source::Glow(glow) => {
                let shining = glow.sample(world, materials, point, rest, u)?;
                let place = shining.place;
                Some(arriving(place.direction, place.distance, shining.radiance, place.pdf * chance))
            }
            Source::Sky => {
                let (direction, pdf) = self.sky.sample(u)?;
                Some(arriving(direction, f64::INFINITY, self.sky.towards(direction), pdf * chance))
            }
        }
    }

    /// Density of [`Lights::sample`] at `point` towards a shining place that was met.
    pub(super) fn pdf_of_surface(
        &self,
        materials: &MaterialTable<'_>,
        point: DVec3,
        at: &Interaction,
    ) -> f64 {
        let Some(source) = self.of_object[at.object as usize] else { return 0.0 };
        let Source::Glow(glow) = &self.sources[source as usize] else { return 0.0 };
        glow.pdf(materials, point, at) * self.chance(source, point)
    }

    /// Density of [`Lights::sample`] at `point` towards the sky in a direction.
    pub(super) fn pdf_of_sky(&self, point: DVec3, direction: DVec3) -> f64 {
        self.of_sky.map_or(0.0, |source| self.sky.pdf(direction) * self.chance(source, point))
    }

    /// The nearest shining rectangle that the ray admits.
    pub(super) fn closest_rectangle(&self, ray: &Ray) -> Option<MetRectangle> {
        let mut ray = *ray;
        let mut nearest = None;
        for &source in &self.rectangles {
            let Source::Rectangle(rectangle) = &self.sources[source as usize] else { continue };
            if let Some(t) = rectangle.meet(&ray) {
                ray.t_max = t;
                nearest = Some(MetRectangle { t, source });
            }
        }
        nearest
    }

    /// Radiance of a rectangle at `distance` along a ray, and the density of [`Lights::sample`] at
    /// `point` towards there.
    pub(super) fn rectangle(&self, met: MetRectangle, ray: &Ray, point: DVec3) -> (LinearRgb, f64) {
        let Source::Rectangle(rectangle) = &self.sources[met.source as usize] else {
            return (LinearRgb::BLACK, 0.0);
        };
        let way = ray.at(met.t) - point;
        let pdf = rectangle.pdf_over(way) * self.chance(met.source, point);
        (rectangle.seen(way.length()), pdf)
    }
}

fn arriving(direction: DVec3, distance: f64, radiance: LinearRgb, pdf: f64) -> Arriving {
    Arriving { direction, distance, radiance, pdf, single: false }
}

/// What a lamp sends: pi times its intensity, so that a matt surface which sends 1/pi of it into each
/// direction shows the intensity.
fn from_lamp(lamp: &ShadingLight, point: DVec3, chance: f64) -> Option<Arriving> {
    let incident = lamp.incident(point.as_vec3())?;
    let (place, axis) = (lamp.position.as_dvec3(), lamp.axis.as_dvec3());
    let way = place - point;
    let (direction, distance) = match lamp.lamp {
        Lamp::Parallel => (-axis, f64::INFINITY),
        Lamp::Box { .. } => (-axis, -way.dot(axis)),
        Lamp::Point | Lamp::Spot(_) | Lamp::Patch => (way.try_normalize()?, way.length()),
    };
    let radiance = incident.intensity * std::f32::consts::PI;
    let direction = direction.try_normalize()?;
    Some(Arriving { direction, distance, radiance, pdf: chance, single: true })
}

/// Chances from weights: most by weight, the rest even. All even where there is no weight.
fn with_even_share(weights: &[f64]) -> SmallVec<[f64; FEW]> {
    let sum: f64 = weights.iter().sum();
    let even = 1.0 / weights.len() as f64;
    if !(sum > 0.0 && sum.is_finite()) {
        return weights.iter().map(|_| even).collect();
    }
    weights.iter().map(|w| (1.0 - EVEN_SHARE) * w / sum + EVEN_SHARE * even).collect()
}

/// The lights that the nodes of `scene` place, in the order of nodes.
fn placed_lights<'s>(scene: &Scene) -> Vec<Source<'s>> {
    let mut sources = Vec::new();
    for (node, world_from_node) in scene.nodes.iter().zip(scene.world_from_nodes()) {
        let (Some(id), Some(world_from_light)) = (node.light, world_from_node) else { continue };
        let Some(light) = scene.lights.get(id.index()) else { continue };
        if light.color.max_component() <= 0.0 {
            continue;
        }
        if let LightKind::Area { size, visible } = light.kind {
            let rectangle = Rectangle::new(size, &world_from_light, light.color, light.attenuation);
            sources.extend(rectangle.map(|mut rectangle| {
                rectangle.visible = visible;
                Source::Rectangle(rectangle)
            }));
        } else {
            ShadingLight::resolve(light, &world_from_light, |lamp| sources.push(Source::Lamp(lamp)));
        }
    }
    sources
}
