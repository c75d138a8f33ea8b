//! The tracer as the text has it: a function that calls itself.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::Tracer;
use super::follow::{Child, Seen};
use super::media::Media;
use super::reflector::Reflector;
use crate::{Pattern, Ray, Sampler, TraceCounts};

/// Calls within calls at most, whatever MaxNest says: a thread's stack is small.
const DEEPEST_CALL: u32 = 256;

/// The state of a call of Ray_Trac beyond its three arguments.
#[derive(Clone, Copy, Debug)]
struct Call {
    /// Product of the coefficients from the root on.
    product: LinearRgb,
    media: Media,
    /// From the eye to the origin.
    distance: f64,
}

impl Tracer<'_> {
    /// Ray_Trac(Origin, Direction, Nest) of the text: light that comes to `origin` from `direction`
    /// (unit). Surfaces that are there in part, and the background of primary rays, are left to
    /// [`Tracer::sample`]; area lights are looked at in their middle.
    /// Source: course text, section 3.1.
    #[must_use]
    pub fn ray_trac(
        &self,
        origin: DVec3,
        direction: DVec3,
        nest: u32,
        counts: &mut TraceCounts,
    ) -> LinearRgb {
        let media = self.media_at(origin, &mut counts.work);
        let call = Call { product: LinearRgb::WHITE, media, distance: 0.0 };
        self.call(Ray::new(origin, direction), nest, &call, counts)
    }

    fn call(&self, mut ray: Ray, nest: u32, call: &Call, counts: &mut TraceCounts) -> LinearRgb {
        if nest > self.settings.max_depth.min(DEEPEST_CALL) {
            return LinearRgb::BLACK;
        }
        let direction = ray.direction;
        let Some(seen) = self.see(&mut ray, counts) else {
            return self.sky.towards(direction) * self.absorbed(&call.media, f64::INFINITY);
        };
        let clear = self.clear_share(call.distance, seen.t);
        let left = self.absorbed(&call.media, seen.t);
        let product = call.product * left * clear;
        let children = self.children(direction, &seen, &call.media);
        let mut follow = |child: Option<Child>| {
            let Some(child) = child else { return LinearRgb::BLACK };
            let product = product * child.share;
            if self.is_negligible(product) {
                return LinearRgb::BLACK;
            }
            let call = Call { product, media: child.media, distance: call.distance + seen.t };
            child.share * self.call(self.world.spawn(&seen.at, child.direction), nest + 1, &call, counts)
        };
        let reflected = follow(children.reflected);
        let transmitted = follow(children.transmitted);
        let local = self.local_light(&seen, counts);
        let fog = self.fog.map_or(LinearRgb::BLACK, |fog| fog.color * (1.0 - clear));
        left * ((local + reflected + transmitted) * clear + fog)
    }

    /// I_l of equation 3.2.
    fn local_light(&self, seen: &Seen, counts: &mut TraceCounts) -> LinearRgb {
        let Seen { at, material, .. } = seen;
        let reflector = Reflector::new(material, at.to_viewer.as_vec3(), self.settings.light_model);
        let (mut sum, is_lit) = self.unlit_part(at, material, &reflector);
        if !is_lit {
            return sum;
        }
        let sampler = Sampler::new(Pattern::Sobol, 0, 0, 0, 0);
        for light in &self.lights {
            let (light, to_light) = light.place(0, 0, sampler, at.point);
            let Some(incident) = light.incident(at.point.as_vec3()) else { continue };
            let shadow_ray = self.shadow_ray(at, to_light);
            let visible = match self.settings.shadows {
                true => self.visibility(&shadow_ray, &mut counts.work),
                false => LinearRgb::WHITE,
            };
            sum += visible * reflector.reflected(&incident);
        }
        sum
    }
}
