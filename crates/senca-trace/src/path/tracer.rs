//! Following a path.

use senca_math::glam::DVec3;
use senca_math::{LinearRgb, View, ViewKind};
use senca_scene::{Background, Fog, Lens};
use senca_shading::fog_share;

use super::PathSettings;
use super::bsdf::{Border, Bsdf};
use super::lights::Lights;
use crate::film::{Integrator, SamplePlace};
use crate::recursive::background::Sky;
use crate::recursive::media::{Media, Medium};
use crate::{
    Counters, Crossings, Hit, Interaction, MaterialPoint, MaterialTable, PrimaryRays, Ray, ReflectionPoint,
    Sampler, TraceCounts, World,
};

/// Dimension of the sampler at which paths begin; those before are the camera's: place in the pixel,
/// place on the lens, time.
const FIRST_PATH_DIMENSION: u32 = 4;

/// Dimensions that a surface takes, and which of them is for what.
mod dimension {
    pub(super) const COUNT: u32 = 7;
    pub(super) const COVERAGE: u32 = 0;
    pub(super) const LIGHT: u32 = 1;
    pub(super) const WAY_ON: u32 = 3;
    pub(super) const ROULETTE: u32 = 5;
    pub(super) const SHADOW: u32 = 6;
}

/// Surfaces that one path sees through without being scattered, at most.
const MAX_SEEN_THROUGH: u32 = 1024;

/// Largest chance of going on where chance decides, so that every path ends.
const SURVIVAL: f64 = 0.95;

/// Share of the way to a light that a shadow ray leaves out, so that the light is not in its own way.
const SHORTER: f64 = 2e-6;

/// A scene with all that is needed to follow paths. Shared by all threads.
#[derive(Debug)]
pub struct PathTracer<'w> {
    world: &'w World<'w>,
    materials: MaterialTable<'w>,
    lights: Lights<'w>,
    fog: Option<Fog>,
    /// What the eye sees where nothing is.
    background: Sky<'w>,
    rays: PrimaryRays,
    settings: PathSettings,
    /// The bodies that the eye of a central view is in.
    media_at_eye: Option<Media>,
    /// Per object, whether it is a body that light enters.
    bodies: Vec<bool>,
    /// Whether every surface is wholly there, so that shadow rays need not ask.
    solid: bool,
}

/// What a thread needs to follow paths. Keep it from one sample to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathWork {
    /// Rays and tests.
    pub counts: TraceCounts,
    /// Paths that brought NaN or infinity and were counted as black.
    pub dropped: u64,
}

/// A path on its way.
#[derive(Debug)]
struct Path {
    ray: Ray,
    media: Media,
    /// Share of what it meets next in the sample.
    throughput: LinearRgb,
    /// Factor in `throughput` that comes from changes of medium.
    gathered: f64,
    /// Where it was scattered last.
    from: DVec3,
    /// Density of its direction there; `None` from the eye and for single directions.
    pdf: Option<f64>,
    bounces: u32,
    seen_through: u32,
    /// Light found so far.
    light: LinearRgb,
    /// Whether it left the scene without having been scattered.
    missed: bool,
    /// Share of the first surface's light that fog leaves.
    clear: f32,
}

/// Whether there is more to follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    GoOn,
    End,
}

impl<'w> PathTracer<'w> {
    /// Ready to follow paths of `view` in a picture of `size` pixels into `world`. The scene's own
    /// background lights it; `background` is what the eye sees where nothing is.
    #[must_use]
    pub fn new(
        world: &'w World<'w>,
        view: &View,
        size: [u32; 2],
        background: Background,
        settings: &PathSettings,
    ) -> Self {
        let materials = MaterialTable::with_filter(world.scene(), settings.texture_filter);
        let is_body = |object: &crate::Object<'_>| {
            object.materials.iter().any(|&m| materials.is_transparent(m)) && object.surface.is_closed()
        };
        let mut tracer = Self {
            world,
            lights: Lights::new(world, &materials),
            fog: world.scene().fog,
            background: Sky::new(world.scene(), background, size[1]),
            rays: PrimaryRays::new(view, size[0], size[1]),
            settings: *settings,
            media_at_eye: None,
            bodies: world.objects().iter().map(is_body).collect(),
            solid: !world.objects().iter().flat_map(|o| &o.materials).any(|&m| materials.has_holes(m)),
            materials,
        };
        if let ViewKind::Central { eye_world } = view.kind {
            tracer.media_at_eye = Some(tracer.media_at(eye_world, &mut Counters::default()));
        }
        tracer
    }

    /// The transparent bodies that a place is in: those whose surface a ray from there crosses an odd
    /// number of times, the one that is left last first.
    fn media_at(&self, point: DVec3, counters: &mut Counters) -> Media {
        let mut inside: Vec<(f64, Medium)> = Vec::new();
        for (index, object) in self.world.objects().iter().enumerate().filter(|(i, _)| self.bodies[*i]) {
            // Any direction would do; this one is unlikely to run along an edge.
            let ray = Ray::new(point, DVec3::new(0.36, 0.48, 0.8));
            let mut crossings = Crossings::new();
            object.surface.crossings(&ray.transformed(&object.object_from_world), counters, &mut crossings);
            if let Some(leaving) = crossings.first().filter(|_| crossings.len() % 2 == 1) {
                inside
                    .push((leaving.t, Medium { object: index as u32, material: object.materials[0] as u32 }));
            }
        }
        inside.sort_by(|a, b| b.0.total_cmp(&a.0));
        inside.iter().fold(Media::default(), |media, (_, medium)| media.entered(*medium))
    }

    /// The same through a lens: what is not at its focus distance is blurred.
    #[must_use]
    pub fn with_lens(mut self, view: &View, lens: Option<Lens>) -> Self {
        self.rays = self.rays.with_lens(view, lens);
        self
    }

    /// Light that one path brings to the eye from a place of the picture, times the share of the place
    /// that is covered, and that share. Finite and not negative.
    #[must_use]
    pub fn sample(&self, place: &SamplePlace, work: &mut PathWork) -> [f32; 4] {
        let ray = self.rays.sample(place);
        let path = self.trace(&ray, &place.sampler, work);
        let mut light = path.light;
        if path.missed {
            match self.background.in_row(place.row, ray.direction) {
                Some(color) => light += path.throughput * color,
                None => return [0.0; 4],
            }
        }
        if let Some(fog) = self.fog.filter(|_| path.clear < 1.0) {
            light = light * path.clear + fog.color * (1.0 - path.clear);
        }
        if !light.is_finite() {
            work.dropped += 1;
            light = LinearRgb::BLACK;
        }
        let LinearRgb { r, g, b } = light;
        [r, g, b, 1.0]
    }

    /// Follows one path from the eye to its end.
    fn trace(&self, ray: &Ray, sampler: &Sampler, work: &mut PathWork) -> Path {
        let counts = &mut work.counts;
        let media = self.media_at_eye.unwrap_or_else(|| self.media_at(ray.origin, &mut counts.work));
        let mut path = Path {
            ray: *ray,
            media,
            throughput: LinearRgb::WHITE,
            gathered: 1.0,
            from: ray.origin,
            pdf: None,
            bounces: 0,
            seen_through: 0,
            light: LinearRgb::BLACK,
            missed: false,
            clear: 1.0,
        };
        let mut sampler = *sampler;
        counts.rays.primary += 1;
        while self.follow(&mut path, &mut sampler, counts) == Then::GoOn {}
        path
    }

    /// Up to the next surface, and what becomes of the path there.
    fn follow(&self, path: &mut Path, sampler: &mut Sampler, counts: &mut TraceCounts) -> Then {
        let hit = self.world.closest(&path.ray, &mut counts.work);
        let t_hit = hit.map_or(path.ray.t_max, |hit| hit.crossing.t);
        if let Some(met) = self.lights.closest_rectangle(&Ray { t_max: t_hit, ..path.ray }) {
            self.travel(path, met.t);
            let (radiance, pdf) = self.lights.rectangle(met, &path.ray, path.from);
            self.add_met(path, radiance, pdf);
            return Then::End;
        }
        let Some(hit) = hit else {
            self.leave(path);
            return Then::End;
        };
        let at = self.world.interaction(&path.ray, &hit);
        if self.is_left_out(path, &at) {
            return see_through(path, t_hit);
        }
        let base = FIRST_PATH_DIMENSION + (path.bounces + path.seen_through) * dimension::COUNT;
        let material = self.materials.at(&at);
        if material.coverage < 1.0 {
            sampler.set_dimension(base + dimension::COVERAGE);
            if sampler.next_1d() >= f64::from(material.coverage) {
                return see_through(path, t_hit);
            }
        }
        self.travel(path, t_hit);
        if path.bounces == 0 {
            path.clear = self.fog.map_or(1.0, |fog| fog_share(&fog.falloff, t_hit as f32));
        }
        self.scatter(path, &at, &material, base, sampler, counts)
    }

    /// Whether a surface is not seen because it shows its back to the eye.
    fn is_left_out(&self, path: &Path, at: &Interaction) -> bool {
        self.settings.hide_backs
            && path.bounces == 0
            && !at.entering
            && !self.materials.is_double_sided(at.material)
            && !self.materials.is_transparent(at.material)
    }

    /// Takes away what the medium swallows on the way to t.
    fn travel(&self, path: &mut Path, t: f64) {
        path.throughput = path.throughput * self.absorbed(&path.media, t * path.ray.direction.length());
    }

    /// Share of light left after a way through what a ray is in.
    fn absorbed(&self, media: &Media, length: f64) -> LinearRgb {
        let Some(medium) = media.current() else { return LinearRgb::WHITE };
        let absorption = self.materials.constant(medium.material as usize).absorption;
        absorption.map(|a| if a > 0.0 { (-f64::from(a) * length).exp() as f32 } else { 1.0 })
    }

    /// The path leaves the scene.
    fn leave(&self, path: &mut Path) {
        if path.bounces == 0 {
            path.missed = true;
            return;
        }
        self.travel(path, f64::INFINITY);
        let radiance = self.lights.sky.towards(path.ray.direction);
        if radiance != LinearRgb::BLACK {
            let pdf = self.lights.pdf_of_sky(path.from, path.ray.direction);
            self.add_met(path, radiance, pdf);
        }
    }

    /// Adds light that the path met by itself, where the lights would have been asked with density
    /// `asked`.
    fn add_met(&self, path: &mut Path, radiance: LinearRgb, asked: f64) {
        let weight = path.pdf.map_or(1.0, |pdf| power_heuristic(pdf, asked));
        self.add(path, path.throughput * radiance * weight as f32, path.bounces);
    }

    /// Adds light that came over so many bounces.
    fn add(&self, path: &mut Path, mut light: LinearRgb, bounces: u32) {
        if let Some(limit) = self.settings.clamp.filter(|_| bounces > 1) {
            let most = light.max_component();
            if most > limit {
                light *= limit / most;
            }
        }
        path.light += light;
    }

    /// At a surface: what it gives off, what the lights send it, and the way on.
    fn scatter(
        &self,
        path: &mut Path,
        at: &Interaction,
        material: &MaterialPoint,
        base: u32,
        sampler: &mut Sampler,
        counts: &mut TraceCounts,
    ) -> Then {
        if let ReflectionPoint::Unlit(color) = material.reflection {
            self.add(path, path.throughput * color, path.bounces);
            return Then::End;
        }
        if material.emission != LinearRgb::BLACK && (at.entering || material.double_sided) {
            let asked = match path.pdf {
                Some(_) => self.lights.pdf_of_surface(&self.materials, path.from, at),
                None => 0.0,
            };
            self.add_met(path, material.emission, asked);
        }
        if path.bounces >= self.settings.max_bounces {
            return Then::End;
        }
        let side = if at.entering { at.normal } else { -at.normal };
        let (border, beyond) = self.border(path, at, material);
        let bsdf = Bsdf::new(material, side, at.to_viewer, border);
        if bsdf.scatters() && !self.lights.is_empty() {
            self.ask_lights(path, at, &bsdf, &beyond, base, sampler, counts);
        }
        sampler.set_dimension(base + dimension::WAY_ON);
        let (choice, u) = (sampler.next_1d(), sampler.next_2d());
        let Some(chosen) = bsdf.sample(choice, u) else { return Then::End };
        path.throughput = path.throughput * chosen.weight;
        path.gathered *= chosen.gathered;
        path.pdf = chosen.pdf;
        path.from = at.point;
        path.bounces += 1;
        if chosen.through {
            path.media = beyond;
        }
        path.ray = self.world.spawn(at, chosen.direction);
        counts.rays.bounce += 1;
        sampler.set_dimension(base + dimension::ROULETTE);
        self.roulette(path, sampler)
    }

    /// Lets chance end the path, in proportion to what it carries.
    fn roulette(&self, path: &mut Path, sampler: &mut Sampler) -> Then {
        let carried = f64::from(path.throughput.max_component()) / path.gathered;
        if carried.is_nan() || carried <= 0.0 {
            return Then::End;
        }
        if path.bounces <= self.settings.roulette_after {
            return Then::GoOn;
        }
        let chance = carried.min(SURVIVAL);
        if sampler.next_1d() >= chance {
            return Then::End;
        }
        path.throughput *= (1.0 / chance) as f32;
        Then::GoOn
    }

    /// What the surface lies between, and what a ray is in beyond it.
    fn border(&self, path: &Path, at: &Interaction, material: &MaterialPoint) -> (Border, Media) {
        let ior = f64::from(material.ior);
        if !material.transmits() {
            return (Border { eta: ior, thin: false }, path.media);
        }
        if !self.bodies[at.object as usize] {
            return (Border { eta: ior, thin: true }, path.media);
        }
        let own = Medium { object: at.object, material: at.material as u32 };
        let (here, beyond) = match at.entering {
            true => (path.media, path.media.entered(own)),
            // It has been inside all along without knowing.
            false if !path.media.holds(at.object) => (path.media.entered(own), path.media),
            false => (path.media, path.media.left(at.object)),
        };
        (Border { eta: self.ior_in(&beyond) / self.ior_in(&here), thin: false }, beyond)
    }

    /// Index of refraction of what a ray is in; 1 outside of all bodies.
    fn ior_in(&self, media: &Media) -> f64 {
        media.current().map_or(1.0, |m| f64::from(self.materials.constant(m.material as usize).ior))
    }

    /// Adds what one light, chosen by chance, sends by way of this surface.
    fn ask_lights(
        &self,
        path: &mut Path,
        at: &Interaction,
        bsdf: &Bsdf,
        beyond: &Media,
        base: u32,
        sampler: &mut Sampler,
        counts: &mut TraceCounts,
    ) {
        sampler.set_dimension(base + dimension::LIGHT);
        let (choice, u) = (sampler.next_1d(), sampler.next_2d());
        let Some(light) = self.lights.sample(self.world, &self.materials, at.point, choice, u) else {
            return;
        };
        let scattered = bsdf.eval(light.direction);
        if scattered.value == LinearRgb::BLACK {
            return;
        }
        let weight = if light.single { 1.0 } else { power_heuristic(light.pdf, scattered.pdf) };
        let side = if at.entering { at.normal } else { -at.normal };
        let media = if side.dot(light.direction) < 0.0 { beyond } else { &path.media };
        let share = scattered.value * self.absorbed(media, light.distance) * (weight / light.pdf) as f32;
        let arriving = path.throughput * share * light.radiance;
        if arriving == LinearRgb::BLACK {
            return;
        }
        let t_max = light.distance * (1.0 - SHORTER) - 4.0 * at.error;
        let ray = Ray { t_max, ..self.world.spawn(at, light.direction) };
        sampler.set_dimension(base + dimension::SHADOW);
        counts.rays.shadow += 1;
        if !self.is_shadowed(&ray, sampler, &mut counts.work) {
            self.add(path, arriving, path.bounces + 1);
        }
    }

    /// Whether anything is between. What is there in part only blocks by chance.
    fn is_shadowed(&self, ray: &Ray, sampler: &mut Sampler, counters: &mut Counters) -> bool {
        if self.solid {
            return self.world.occluded(ray, counters, &|_| true);
        }
        let chance = sampler.next_1d().to_bits();
        self.world.occluded(ray, counters, &|hit| self.blocks(ray, hit, chance))
    }

    fn blocks(&self, ray: &Ray, hit: &Hit, chance: u64) -> bool {
        let at = self.world.interaction(ray, hit);
        if !self.materials.has_holes(at.material) {
            return true;
        }
        let own = u64::from(hit.object) << 32 | u64::from(hit.crossing.part);
        crate::sampler::unit_hash(chance ^ own) < f64::from(self.materials.at(&at).coverage)
    }
}

/// The ray goes on behind a surface.
fn see_through(path: &mut Path, t: f64) -> Then {
    path.ray.t_min = t;
    path.seen_through += 1;
    if path.seen_through < MAX_SEEN_THROUGH { Then::GoOn } else { Then::End }
}

/// Share of a way of finding a direction with this density, when another has the density `other`.
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    if pdf.is_infinite() || other <= 0.0 {
        return 1.0;
    }
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

impl Integrator for PathTracer<'_> {
    type Work = PathWork;

    fn sample(&self, place: &SamplePlace, work: &mut PathWork) -> [f32; 4] {
        PathTracer::sample(self, place, work)
    }

    fn counts(work: &PathWork) -> TraceCounts {
        work.counts
    }
}
