//! The tree of rays of a pixel, to be looked at (course text, section 3.1, figure 3.7).
//!
//! [`PixelTrees::trace`] exposes a single pixel with a tracer that writes down what it does. The colour
//! is made by the same film from the same numbers, so it is that of the picture, bit by bit; and the
//! contributions of the rays of a tree add up to its sample.

mod drawing;
#[cfg(test)]
mod tests;
mod text;

use std::sync::{Mutex, PoisonError};

use senca_math::glam::DVec3;
use senca_math::{Control, LinearRgb};

use crate::film::{Area, Film, FilmSettings, Integrator, SamplePlace, Watch};
use crate::recursive::recorder::{Met, Recorder, ShadowRay, Unsent};
use crate::recursive::{Pending, RayKind, Tracer, Work};
use crate::{TraceCounts, TraceError};

/// Rays of one tree that are written down at most.
pub const MAX_RECORDED: usize = 100_000;

/// What happened for one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelTrees {
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Width and height of the picture.
    pub size: [u32; 2],
    /// Colour of the pixel in the picture: linear, alpha not multiplied in.
    pub color: [f32; 4],
    /// A tree for each sample, in the order of taking them.
    pub trees: Vec<RayTree>,
    /// Rays and tests that it took.
    pub counts: TraceCounts,
}

/// The rays of one sample.
#[derive(Clone, Debug, PartialEq)]
pub struct RayTree {
    /// Place of the sample in the picture, in pixels from the upper left corner.
    pub place: [f64; 2],
    /// Red, green and blue times alpha, and alpha.
    pub color: [f32; 4],
    /// Rays in the order of following them; the primary ray first. At most [`MAX_RECORDED`].
    pub rays: Vec<RayNode>,
    /// Whether there were more.
    pub cut: bool,
}

/// A ray of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct RayNode {
    /// Number of the ray that it comes from.
    pub parent: Option<u32>,
    /// What it is.
    pub kind: RayKind,
    /// Nest of the text: 0 for the primary ray.
    pub nest: u32,
    /// Where it starts, in the world.
    pub origin: DVec3,
    /// Where it goes, a unit vector.
    pub direction: DVec3,
    /// Product of the coefficients on the way: its share in the picture.
    pub weight: LinearRgb,
    /// What it met.
    pub end: RayEnd,
}

/// What a ray met.
#[derive(Clone, Debug, PartialEq)]
pub enum RayEnd {
    /// Nothing.
    Left {
        /// Background in its direction.
        light: LinearRgb,
        /// Share of that in the picture.
        weight: LinearRgb,
    },
    /// A surface.
    Met(Box<Meeting>),
}

/// A ray meets a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// Parameter of the ray, which is the distance.
    pub t: f64,
    /// X of the text.
    pub point: DVec3,
    /// Unit normal to shade with, on the ray's side.
    pub normal: DVec3,
    /// Whether the ray comes from the outside.
    pub entering: bool,
    /// Number of the object, in [`crate::World::objects`].
    pub object: u32,
    /// Name of its node.
    pub object_name: String,
    /// Name of the material; empty for one without.
    pub material_name: String,
    /// k_r.
    pub mirror: LinearRgb,
    /// k_t.
    pub transmission: LinearRgb,
    /// Index of refraction of the body.
    pub ior: f32,
    /// Share of the surface that is there.
    pub coverage: f32,
    /// I_l: light of the lamps and of the surface itself.
    pub local: LinearRgb,
    /// Share of `local` in the picture.
    pub weight: LinearRgb,
    /// What fog adds to the picture before the surface.
    pub fog: LinearRgb,
    /// Shadow rays.
    pub shadows: Vec<Shadow>,
    /// Whether a ray was not sent because MaxNest is reached.
    pub too_deep: bool,
    /// Rays not sent because the product of coefficients is too small.
    pub negligible: u32,
}

/// A shadow ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Shadow {
    /// Name of the light.
    pub light_name: String,
    /// Where the ray goes: the light, or for parallel light a direction (a unit vector).
    pub to_light: DVec3,
    /// Whether `to_light` is a direction.
    pub parallel: bool,
    /// S_i: share of the light that arrives.
    pub share: LinearRgb,
    /// Light that the place reflects of it.
    pub reflected: LinearRgb,
    /// What takes light from it first, and where.
    pub blocker: Option<(String, DVec3)>,
}

impl RayNode {
    /// What this ray alone adds to the colour of the sample.
    #[must_use]
    pub fn contribution(&self) -> LinearRgb {
        match &self.end {
            RayEnd::Left { light, weight } => *weight * *light,
            RayEnd::Met(m) => m.weight * m.local + m.fog,
        }
    }
}

impl RayTree {
    /// Sum of the contributions of all rays: the colour of the sample, where all rays are written down.
    #[must_use]
    pub fn total(&self) -> LinearRgb {
        self.rays.iter().fold(LinearRgb::BLACK, |mut sum, ray| {
            sum += ray.contribution();
            sum
        })
    }

    /// Numbers of the rays that come from ray `number`.
    pub fn children(&self, number: u32) -> impl Iterator<Item = u32> {
        let rays = self.rays.iter().enumerate().skip(number as usize + 1);
        rays.filter(move |(_, ray)| ray.parent == Some(number)).map(|(i, _)| i as u32)
    }
}

impl PixelTrees {
    /// Exposes one pixel of the picture that `film` describes; its area is not looked at.
    ///
    /// # Errors
    /// [`TraceError::Setting`] when the pixel lies outside, or the film's settings are wrong.
    pub fn trace(tracer: &Tracer<'_>, film: &FilmSettings, pixel: [u32; 2]) -> Result<Self, TraceError> {
        let names = ["column of the pixel", "row of the pixel"];
        for k in 0..2 {
            if pixel[k] >= film.size[k] {
                let (name, value) = (names[k], f64::from(pixel[k]));
                return Err(TraceError::Setting { name, value, expected: "inside the picture" });
            }
        }
        let area = Area { x: pixel[0], y: pixel[1], width: 1, height: 1 };
        let mut film = Film::new(&FilmSettings { area, ..*film })?;
        let witness = Witness { tracer, trees: Mutex::default() };
        let report = film.expose(&witness, &mut Watch::default(), &Control::default())?;
        let color = film.develop(tracer.is_transparent()).pixel(0, 0);
        let trees = witness.trees.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(Self { pixel, size: film.settings().size, color, trees, counts: report.counts })
    }
}

/// A tracer that writes down what it does.
struct Witness<'a, 'w> {
    tracer: &'a Tracer<'w>,
    trees: Mutex<Vec<RayTree>>,
}

impl Integrator for Witness<'_, '_> {
    type Work = Work;

    fn sample(&self, place: &SamplePlace, work: &mut Work) -> [f32; 4] {
        let mut recorded = Recording { tracer: self.tracer, rays: Vec::new(), cut: false };
        let color = self.tracer.sample_recorded(place, work, &mut recorded);
        let tree = RayTree { place: [place.x, place.y], color, rays: recorded.rays, cut: recorded.cut };
        self.trees.lock().unwrap_or_else(PoisonError::into_inner).push(tree);
        color
    }

    fn counts(work: &Work) -> TraceCounts {
        work.counts
    }
}

/// A tree being written down.
struct Recording<'a, 'w> {
    tracer: &'a Tracer<'w>,
    rays: Vec<RayNode>,
    cut: bool,
}

impl Recording<'_, '_> {
    fn object_name(&self, object: u32) -> String {
        let world = self.tracer.world();
        let placed = &world.objects()[object as usize];
        let scene = world.scene();
        let node = scene.nodes.get(placed.node.index()).map_or("", |n| &n.name);
        let geometry = scene.geometries.get(placed.geometry.index()).map_or("", |g| &g.name);
        match (node.is_empty(), geometry.is_empty()) {
            (false, _) => node.to_owned(),
            (true, false) => geometry.to_owned(),
            (true, true) => format!("object {object}"),
        }
    }

    /// The meeting at the end of a ray that is written down.
    fn meeting(&mut self, number: u32) -> Option<&mut Meeting> {
        match self.rays.get_mut(number as usize).map(|ray| &mut ray.end) {
            Some(RayEnd::Met(meeting)) => Some(meeting),
            _ => None,
        }
    }
}

impl Recorder for Recording<'_, '_> {
    const RECORDS: bool = true;

    fn ray(&mut self, _: u32, pending: &Pending) {
        if self.rays.len() >= MAX_RECORDED {
            self.cut = true;
            return;
        }
        let end = RayEnd::Left { light: LinearRgb::BLACK, weight: LinearRgb::BLACK };
        self.rays.push(RayNode {
            parent: (pending.parent != u32::MAX).then_some(pending.parent),
            kind: pending.kind,
            nest: pending.nest,
            origin: pending.ray.origin,
            direction: pending.ray.direction,
            weight: pending.weight,
            end,
        });
    }

    fn leaves(&mut self, number: u32, light: LinearRgb, weight: LinearRgb) {
        if let Some(ray) = self.rays.get_mut(number as usize) {
            ray.end = RayEnd::Left { light, weight };
        }
    }

    fn meets(&mut self, number: u32, met: &Met<'_>) {
        let object_name = self.object_name(met.at.object);
        let materials = &self.tracer.world().scene().materials;
        let material_name = materials.get(met.at.material).map_or_else(String::new, |m| m.name.clone());
        let Some(ray) = self.rays.get_mut(number as usize) else { return };
        ray.end = RayEnd::Met(Box::new(Meeting {
            t: met.t,
            point: met.at.point,
            normal: met.material.normal.as_dvec3(),
            entering: met.at.entering,
            object: met.at.object,
            object_name,
            material_name,
            mirror: met.material.mirror,
            transmission: met.material.transmission,
            ior: met.material.ior,
            coverage: met.material.coverage,
            local: LinearRgb::BLACK,
            weight: met.weight,
            fog: met.fog,
            shadows: Vec::new(),
            too_deep: false,
            negligible: 0,
        }));
    }

    fn shadow(&mut self, number: u32, shadow: &ShadowRay) {
        let names = self.tracer.light_names();
        let light_name = names.get(shadow.light as usize).copied().unwrap_or_default().to_owned();
        let blocker = shadow.blocker.map(|(object, place)| (self.object_name(object), place));
        let parallel = shadow.ray.t_max == f64::INFINITY;
        let to_light = if parallel { shadow.ray.direction } else { shadow.ray.at(1.0) };
        let light_name = if light_name.is_empty() { format!("light {}", shadow.light) } else { light_name };
        let (share, reflected) = (shadow.share, shadow.light_reflected);
        let Some(meeting) = self.meeting(number) else { return };
        meeting.shadows.push(Shadow { light_name, to_light, parallel, share, reflected, blocker });
    }

    fn local(&mut self, number: u32, local: LinearRgb) {
        if let Some(meeting) = self.meeting(number) {
            meeting.local = local;
        }
    }

    fn unsent(&mut self, number: u32, unsent: Unsent) {
        let Some(meeting) = self.meeting(number) else { return };
        match unsent {
            Unsent::TooDeep => meeting.too_deep = true,
            Unsent::Negligible => meeting.negligible += 1,
        }
    }
}
