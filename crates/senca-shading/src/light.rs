//! A light of the scene, resolved to world space.

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec3, Mat4, Vec3};
use senca_scene::{Attenuation, Light, LightKind, SpotFalloff};

use crate::{distance_attenuation, spot_share};

/// Samples along each side of an area light. The 3 x 3 centres of equal cells stand for the whole
/// rectangle; each is a small plane lamp that shines with the cosine of the angle from its axis.
pub const AREA_SAMPLES_PER_SIDE: u32 = 3;

/// Light that arrives at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incident {
    /// Unit direction towards the light.
    pub to_light: Vec3,
    /// `I fatt`: colour times intensity, attenuated.
    pub intensity: LinearRgb,
}

/// A light source in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingLight {
    /// Colour times intensity.
    pub color: LinearRgb,
    /// Where the light is; for parallel light a point of its emitting plane.
    pub position: Vec3,
    /// Unit direction in which it shines.
    pub axis: Vec3,
    /// Fall-off with distance.
    pub attenuation: Attenuation,
    /// Kind with its parameters.
    pub lamp: Lamp,
}

/// What distinguishes the kinds of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// All directions.
    Point,
    /// Parallel rays along the axis; distance counts from the emitting plane.
    Parallel,
    /// A cone around the axis.
    Spot(SpotFalloff),
    /// Parallel rays inside a prism.
    Box {
        /// To the frame of the light's node, in which the beam runs along -z.
        light_from_world: Mat4,
        /// Smallest x and y there.
        min: [f32; 2],
        /// Largest x and y there.
        max: [f32; 2],
        /// Reach along -z there.
        depth: f32,
    },
    /// A small plane lamp: a point light times the cosine of the angle from the axis.
    Patch,
}

impl ShadingLight {
    /// Resolves `light`, placed by `world_from_light`, and hands the result to `add`: one light, or
    /// one per sample of an area light. Ambient light gives none, and neither does a light whose
    /// transform has lost its direction.
    pub fn resolve(light: &Light, world_from_light: &DMat4, mut add: impl FnMut(Self)) {
        let position = world_from_light.transform_point3(DVec3::ZERO);
        let axis = world_from_light.transform_vector3(DVec3::NEG_Z).try_normalize();
        let one = |color: LinearRgb, position: DVec3, axis: DVec3, lamp: Lamp| Self {
            color,
            position: position.as_vec3(),
            axis: axis.as_vec3(),
            attenuation: light.attenuation,
            lamp,
        };
        match (light.kind, axis) {
            (LightKind::Point, _) => {
                add(one(light.color, position, axis.unwrap_or(DVec3::NEG_Z), Lamp::Point));
            }
            (LightKind::Parallel, Some(axis)) => add(one(light.color, position, axis, Lamp::Parallel)),
            (LightKind::Spot(falloff), Some(axis)) => {
                add(one(light.color, position, axis, Lamp::Spot(falloff)));
            }
            (LightKind::BoxSpot { min, max, depth }, Some(axis)) => {
                let light_from_world = world_from_light.inverse().as_mat4();
                let f = |v: [f64; 2]| v.map(|v| v as f32);
                let lamp = Lamp::Box { light_from_world, min: f(min), max: f(max), depth: depth as f32 };
                add(one(light.color, position, axis, lamp));
            }
            (LightKind::Area { size, .. }, Some(axis)) => {
                let color = light.color * (AREA_SAMPLES_PER_SIDE.pow(2) as f32).recip();
                for sample in area_samples(size) {
                    add(one(color, world_from_light.transform_point3(sample), axis, Lamp::Patch));
                }
            }
            (LightKind::Ambient, _) | (_, None) => {}
        }
    }

    /// Light at `position` (world), or `None` where this light does not shine.
    #[must_use]
    #[inline]
    pub fn incident(&self, position: Vec3) -> Option<Incident> {
        match &self.lamp {
            Lamp::Parallel => self.parallel(position),
            Lamp::Box { light_from_world, min, max, depth } => {
                let p = light_from_world.transform_point3(position);
                let inside = (min[0]..=max[0]).contains(&p.x)
                    && (min[1]..=max[1]).contains(&p.y)
                    && (0.0..=*depth).contains(&-p.z);
                if inside { self.parallel(position) } else { None }
            }
            Lamp::Point => self.shine_from_place(position, |_| 1.0),
            Lamp::Spot(falloff) => self.shine_from_place(position, |cos| spot_share(falloff, cos)),
            Lamp::Patch => self.shine_from_place(position, |cos| cos.max(0.0)),
        }
    }

    #[inline]
    fn parallel(&self, position: Vec3) -> Option<Incident> {
        let share = match self.attenuation {
            Attenuation::None => 1.0,
            _ => {
                let d = (position - self.position).dot(self.axis).max(0.0);
                distance_attenuation(&self.attenuation, d)
            }
        };
        (share > 0.0).then(|| Incident { to_light: -self.axis, intensity: self.color * share })
    }

    /// Light from the lamp's place, times a share that depends on the cosine of the angle from the
    /// axis. A point at the lamp itself is lit along the axis.
    fn shine_from_place(&self, position: Vec3, share_at: impl Fn(f32) -> f32) -> Option<Incident> {
        let way = self.position - position;
        let d = way.length();
        let to_light = if d > 0.0 { way / d } else { -self.axis };
        let share = share_at(-to_light.dot(self.axis)) * distance_attenuation(&self.attenuation, d);
        (share > 0.0).then(|| Incident { to_light, intensity: self.color * share })
    }
}

/// Centres of the cells of a rectangle in the xy plane, centred on the origin, row by row.
fn area_samples(size: [f64; 2]) -> impl Iterator<Item = DVec3> {
    let n = AREA_SAMPLES_PER_SIDE;
    let along = move |i: u32, length: f64| length * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
    (0..n * n).map(move |i| DVec3::new(along(i % n, size[0]), along(i / n, size[1]), 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn resolve(kind: LightKind, world_from_light: DMat4) -> Vec<ShadingLight> {
        let light =
            Light { name: String::new(), color: LinearRgb::WHITE, attenuation: Attenuation::None, kind };
        let mut lights = Vec::new();
        ShadingLight::resolve(&light, &world_from_light, |l| lights.push(l));
        lights
    }

    #[test]
    fn a_box_light_lights_its_prism_only() {
        let kind = LightKind::BoxSpot { min: [-1.0; 2], max: [1.0; 2], depth: 10.0 };
        let down = DMat4::from_translation(DVec3::new(0.0, 5.0, 0.0)) * DMat4::from_rotation_x(-FRAC_PI_2);
        let light = resolve(kind, down)[0];
        for (point, lit) in [
            ([0.0, 0.0, 0.0], true),
            ([0.5, 1.0, 0.25], true),
            ([1.5, 1.0, 0.0], false),
            ([0.0, 6.0, 0.0], false),
            ([0.0, -6.0, 0.0], false),
        ] {
            let incident = light.incident(Vec3::from_array(point));
            assert_eq!(incident.is_some(), lit, "{point:?}");
            assert!(incident.is_none_or(|i| i.to_light.abs_diff_eq(Vec3::Y, 1e-6)));
        }
    }

    #[test]
    fn area_light_is_nine_patches_of_a_ninth() {
        let lights = resolve(LightKind::Area { size: [3.0, 6.0], visible: true }, DMat4::IDENTITY);
        assert_eq!(lights.len(), 9);
        assert_eq!(lights[0].position, Vec3::new(-1.0, -2.0, 0.0));
        assert_eq!(lights[8].position, Vec3::new(1.0, 2.0, 0.0));
        let far = Vec3::new(0.0, 0.0, -1e4);
        let sum: f32 = lights.iter().filter_map(|l| l.incident(far)).map(|i| i.intensity.r).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        assert!(lights.iter().all(|l| l.incident(-far).is_none()), "nothing behind");
    }

    #[test]
    fn ambient_and_collapsed_lights_resolve_to_nothing() {
        assert!(resolve(LightKind::Ambient, DMat4::IDENTITY).is_empty());
        assert!(resolve(LightKind::Parallel, DMat4::ZERO).is_empty());
    }

    #[test]
    fn a_point_at_the_lamp_is_lit() {
        let light = resolve(LightKind::Point, DMat4::IDENTITY)[0];
        assert_eq!(light.incident(Vec3::ZERO).map(|i| i.intensity), Some(LinearRgb::WHITE));
    }

    #[test]
    fn parallel_light_attenuates_from_its_plane() {
        let mut light = resolve(LightKind::Parallel, DMat4::IDENTITY)[0];
        light.attenuation = Attenuation::Polynomial { constant: 0.0, linear: 1.0, quadratic: 0.0 };
        let at = |z| light.incident(Vec3::new(7.0, 0.0, z)).map(|i| i.intensity.r);
        assert_eq!(at(-4.0), Some(0.25));
        assert_eq!(at(4.0), Some(1.0));
    }
}
