//! Shadow rays (course text, section 3.1).

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::lamps::ToLight;
use super::{Blockers, Tracer};
use crate::{Counters, Hit, Interaction, Ray};

/// Surfaces that tint the light on one shadow ray at most; more block it.
const MAX_TINTING: usize = 256;

impl Tracer<'_> {
    /// The shadow ray from a place to a light: the part between them.
    #[inline]
    pub(super) fn shadow_ray(&self, at: &Interaction, to_light: ToLight) -> Ray {
        match to_light {
            ToLight::Place(place) => self.world.spawn_to(at, place),
            ToLight::Far(direction) => self.world.spawn(at, direction),
        }
    }

    /// S_i: the share of a light that arrives over a shadow ray, 0 or 1 where nothing tints it.
    #[inline]
    pub(super) fn visibility(&self, ray: &Ray, counters: &mut Counters) -> LinearRgb {
        let shadowed = |blocked| if blocked { LinearRgb::BLACK } else { LinearRgb::WHITE };
        match self.blockers {
            Blockers::All => shadowed(self.world.occluded(ray, counters, &|_| true)),
            Blockers::Some => shadowed(self.world.occluded(ray, counters, &|hit| self.blocks(ray, hit))),
            Blockers::Tinting => self.tinted(ray, counters),
        }
    }

    /// Whether a surface in the way takes all light.
    pub(super) fn blocks(&self, ray: &Ray, hit: &Hit) -> bool {
        let object = &self.world.objects()[hit.object as usize];
        if !object.casts_shadow {
            return false;
        }
        if let &[material] = &object.materials[..] {
            if self.materials.is_transparent(material) {
                return false;
            }
            if !self.materials.has_holes(material) {
                return true;
            }
        }
        let at = self.world.interaction(ray, hit);
        let material = self.materials.at(&at);
        material.coverage > 0.0 && !material.transmits()
    }

    /// The share of light that is left after all surfaces on the way, in the order of meeting them.
    fn tinted(&self, ray: &Ray, counters: &mut Counters) -> LinearRgb {
        let mut ray = *ray;
        let mut left = LinearRgb::WHITE;
        let length = ray.direction.length();
        let mut entered = 0.0;
        for _ in 0..MAX_TINTING {
            let Some(hit) = self.world.closest(&ray, counters) else { return left };
            let t = hit.crossing.t;
            left = left * self.let_through(&ray, &hit, (t - entered) * length);
            if left == LinearRgb::BLACK {
                return left;
            }
            entered = t;
            ray.t_min = t;
        }
        LinearRgb::BLACK
    }

    /// Share of light that one surface lets through; `inside` is the way since the last one.
    fn let_through(&self, ray: &Ray, hit: &Hit, inside: f64) -> LinearRgb {
        if !self.world.objects()[hit.object as usize].casts_shadow {
            return LinearRgb::WHITE;
        }
        let at = self.world.interaction(ray, hit);
        let material = self.materials.at(&at);
        let around = LinearRgb::splat(1.0 - material.coverage);
        if !material.transmits() {
            return around;
        }
        if !self.settings.transparent_shadows {
            return LinearRgb::WHITE;
        }
        let lost = |a: f32| if at.entering { 1.0 } else { (-f64::from(a) * inside).exp() as f32 };
        around + material.transmission * material.absorption.map(lost) * material.coverage
    }

    /// The nearest thing on a shadow ray that takes light, for those who want to know what it is.
    pub(super) fn first_blocker(&self, ray: &Ray, counters: &mut Counters) -> Option<(Hit, DVec3)> {
        let mut ray = *ray;
        for _ in 0..MAX_TINTING {
            let hit = self.world.closest(&ray, counters)?;
            if self.let_through(&ray, &hit, 0.0) != LinearRgb::WHITE {
                return Some((hit, ray.at(hit.crossing.t)));
            }
            ray.t_min = hit.crossing.t;
        }
        None
    }
}
