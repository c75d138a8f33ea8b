//! The recursive tracer (course text, section 3.1; Whitted 1980).
//!
//! A ray that meets a surface brings back `I = I_l + k_r I_r + k_t I_t` (equation 3.1): the light of
//! the lamps that see the place (equation 3.2), what a mirrored ray brings, and what a ray through
//! the body brings. [`Tracer`] follows the tree of rays with a list of those still to be followed
//! and the product of the coefficients on the way to each, so that any depth needs no stack;
//! [`Tracer::ray_trac`] is the same as the text has it, a function that calls itself.
//!
//! Where the text is silent:
//!
//! - Levels 0 to MaxNest are evaluated; rays beyond bring nothing.
//! - Negative cosines count as 0, normals are turned to the ray, and the viewer of a reflected or
//!   transmitted ray is its origin.
//! - A ray knows which transparent bodies it is in, in the order of entering; the last one decides
//!   refraction and absorption. A camera may stand inside. Surfaces that bound no body are
//!   thin: rays go straight through.
//! - At total reflection the share k_t goes to the reflected ray.
//! - A parallel light has no distance: anything before the place that way blocks it.
//! - Surfaces with an alpha of their own are seen through by that share, and throw that much less
//!   shadow.
//! - A ray starts a little beside its surface: see [`World::spawn`].
//!
//! # Limits
//!
//! Light that reaches a place by way of a mirror or through a lens is not found: there are no caustics,
//! and no light goes from matt surface to matt surface. One primary ray makes at most
//! [`MAX_RAYS_PER_SAMPLE`] rays.

pub(crate) mod background;
mod follow;
mod lamps;
pub(crate) mod media;
pub mod optics;
mod plain;
mod polish;
pub(crate) mod recorder;
mod reflector;
mod settings;
mod shadow;
mod stream;
mod surface_light;
#[cfg(test)]
mod tests;

use senca_math::glam::DVec3;
use senca_math::{Aabb, LinearRgb, View, ViewKind};
use senca_scene::{AlphaMode, Background, Fog, Lens};
use senca_shading::AmbientLight;

use crate::{
    Counters, Crossings, Interaction, MaterialPoint, MaterialTable, PrimaryRays, Ray, SamplePlace, World,
};
use background::Sky;
use lamps::{TracedLight, lights_of};
use media::{Media, Medium};
use reflector::Reflector;
use stream::Stream;

pub(crate) use follow::Pending;
pub use follow::{MAX_RAYS_PER_SAMPLE, RayKind, Work};
pub use settings::{Backs, LightModel, RecursiveSettings};
use surface_light::Known;
pub use surface_light::{KnownLight, SurfaceLight};

/// A scene with all that is needed to follow rays into it. Shared by all threads.
#[derive(Debug)]
pub struct Tracer<'w> {
    world: &'w World<'w>,
    materials: MaterialTable<'w>,
    lights: Vec<TracedLight>,
    ambient: AmbientLight,
    fog: Option<Fog>,
    sky: Sky<'w>,
    rays: PrimaryRays,
    view: View,
    settings: RecursiveSettings,
    /// Per object, whether it is a transparent body with an inside.
    bodies: Vec<bool>,
    /// The bodies that the eye of a central view is in.
    media_at_eye: Media,
    blockers: Blockers,
    /// The fast way, where the scene can go it.
    stream: Option<Stream>,
    known: Known<'w>,
}

/// What kinds of surfaces shadow rays have to tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Blockers {
    /// All block.
    All,
    /// Some do not.
    Some,
    /// Some let part of the light through.
    Tinting,
}

impl<'w> Tracer<'w> {
    /// Ready to follow rays of `view` in a picture of `size` pixels into `world`. `background` is seen
    /// where nothing is.
    #[must_use]
    pub fn new(
        world: &'w World<'w>,
        view: &View,
        size: [u32; 2],
        background: Background,
        settings: &RecursiveSettings,
    ) -> Self {
        let scene = world.scene();
        let materials = MaterialTable::with_filter(scene, settings.texture_filter);
        let (lights, ambient) = lights_of(scene);
        let mut tracer = Self {
            world,
            lights,
            ambient,
            fog: scene.fog,
            sky: Sky::new(scene, background, size[1]),
            rays: PrimaryRays::new(view, size[0], size[1]),
            view: *view,
            settings: *settings,
            bodies: bodies_of(world, &materials),
            media_at_eye: Media::default(),
            blockers: blockers_of(world, &materials, settings),
            known: Known::default(),
            materials,
            stream: None,
        };
        if let ViewKind::Central { eye_world } = view.kind {
            tracer.media_at_eye = tracer.media_at(eye_world, &mut Counters::default());
        }
        tracer.stream = Stream::of(&tracer);
        tracer
    }

    /// The same following tree after tree of rays, each by itself: the plain twin of the default, which
    /// follows many rays at once.
    #[must_use]
    pub fn one_by_one(mut self) -> Self {
        self.stream = None;
        self
    }

    /// The same through a lens: what is not at its focus distance is blurred.
    #[must_use]
    pub fn with_lens(mut self, lens: Option<Lens>) -> Self {
        self.rays = self.rays.with_lens(&self.view, lens);
        self
    }

    /// The same with light on surfaces that was found beforehand, in place of the ambient light.
    /// Source: course text, task 4.9.
    #[must_use]
    pub fn with_surface_light(mut self, light: &'w dyn SurfaceLight) -> Self {
        self.known = Known(Some(light));
        self.stream = None;
        self
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &'w World<'w> {
        self.world
    }

    /// Names of the lights, in the order of shadow rays.
    #[must_use]
    pub fn light_names(&self) -> Vec<&str> {
        self.lights.iter().map(|light| light.name.as_str()).collect()
    }

    /// Whether pixels are transparent where nothing is seen.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        self.sky.is_transparent()
    }

    /// The transparent bodies that a place is in: those whose surface a ray from there crosses an odd
    /// number of times, in the order of the distance of leaving, the farthest first.
    fn media_at(&self, point: DVec3, counters: &mut Counters) -> Media {
        let mut inside: Vec<(f64, Medium)> = Vec::new();
        for (index, object) in self.world.objects().iter().enumerate() {
            if !self.bodies[index] || !contains(&object.bounds_world, point) {
                continue;
            }
            // Any direction would do; this one is unlikely to run along an edge.
            let ray = Ray::new(point, DVec3::new(0.36, 0.48, 0.8));
            let mut crossings = Crossings::new();
            object.surface.crossings(&ray.transformed(&object.object_from_world), counters, &mut crossings);
            if let Some(leaving) = crossings.first().filter(|_| crossings.len() % 2 == 1) {
                let medium = Medium { object: index as u32, material: object.materials[0] as u32 };
                inside.push((leaving.t, medium));
            }
        }
        inside.sort_by(|a, b| b.0.total_cmp(&a.0));
        inside.iter().fold(Media::default(), |media, (_, medium)| media.entered(*medium))
    }

    /// The primary ray through a place of the picture, the bodies it starts in, and its distance from the
    /// eye.
    fn primary(&self, place: &SamplePlace, counters: &mut Counters) -> (Ray, Media, f64) {
        let ray = self.rays.sample(place);
        match self.view.kind {
            ViewKind::Central { .. } => (ray, self.media_at_eye, 0.0),
            ViewKind::Parallel { .. } => {
                let depth = -self.view.view_from_world.transform_point3(ray.origin).z;
                let any = self.bodies.iter().any(|body| *body);
                let media = if any { self.media_at(ray.origin, counters) } else { Media::default() };
                (ray, media, depth)
            }
        }
    }
}

/// Whether a point is in a box, its border included.
fn contains(bounds: &Aabb, point: DVec3) -> bool {
    point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
}

/// Per object, whether it is a transparent body with an inside.
fn bodies_of(world: &World<'_>, materials: &MaterialTable<'_>) -> Vec<bool> {
    let of = |object: &crate::Object<'_>| {
        object.materials.iter().any(|m| materials.is_transparent(*m)) && object.surface.is_closed()
    };
    world.objects().iter().map(of).collect()
}

fn blockers_of(world: &World<'_>, materials: &MaterialTable<'_>, settings: &RecursiveSettings) -> Blockers {
    let used = || world.objects().iter().flat_map(|object| object.materials.iter().copied());
    let blends = used().any(|m| materials.alpha_mode(m) == AlphaMode::Blend);
    let transparent = used().any(|m| materials.is_transparent(m));
    if blends || (transparent && settings.transparent_shadows) {
        Blockers::Tinting
    } else if transparent
        || used().any(|m| materials.has_holes(m))
        || world.objects().iter().any(|object| !object.casts_shadow)
    {
        Blockers::Some
    } else {
        Blockers::All
    }
}

impl Tracer<'_> {
    /// Light that a place sends to the viewer without any lamp, and whether lamps are to be looked at.
    /// Source: course text, section 3.1, the first term of equation 3.2, and task 4.9.
    fn unlit_part(
        &self,
        at: &Interaction,
        material: &MaterialPoint,
        reflector: &Reflector,
    ) -> (LinearRgb, bool) {
        let own = match self.known.0.map(|light| light.at(at, material)) {
            None => reflector.ambient(&self.ambient, material.occlusion),
            Some(KnownLight::Arriving(light)) => reflector.of_known(light),
            Some(KnownLight::Leaving(light)) => return (light, false),
        };
        (material.emission + own, reflector.is_lit())
    }

    /// Share of light left after a way through what a ray is in.
    fn absorbed(&self, media: &Media, length: f64) -> LinearRgb {
        let Some(medium) = media.current() else { return LinearRgb::WHITE };
        let absorption = self.materials.constant(medium.material as usize).absorption;
        let left = |a: f32| if a > 0.0 { (-f64::from(a) * length).exp() as f32 } else { 1.0 };
        absorption.map(left)
    }

    /// Index of refraction of what a ray is in; 1 outside of all bodies.
    fn ior_in(&self, media: &Media) -> f64 {
        media.current().map_or(1.0, |m| f64::from(self.materials.constant(m.material as usize).ior))
    }
}
