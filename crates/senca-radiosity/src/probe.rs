//! Light at any place in space, from the light on surfaces around it.
//!
//! What arrives at a place is gathered once more, in three parts that are known in different ways:
//!
//! 1. Lamps and the sky: looked at from the place ([`DirectLight`]).
//! 2. Emitters: the closed form of each (Lambert), times the share of lines of sight to places spread
//!    over it that are open.
//! 3. Light that surfaces reflect: from directions that are spread as the cosine weighs them, as much as
//!    the surface met there reflects.

use std::f64::consts::TAU;

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use crate::display::{ElementFinder, LightField};
use crate::form_factor::point_to_polygon;
use crate::{DirectLight, Occluders, PatchPolygon};

/// Emitters' parts and directions that a probe looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeSettings {
    /// Directions in which reflected light is looked for, > 0. Default 512.
    pub directions: u32,
    /// Lines of sight along each side of an emitter, > 0. Default 4.
    pub sights: u32,
}

impl Default for ProbeSettings {
    fn default() -> Self {
        Self { directions: 512, sights: 4 }
    }
}

/// Something that gives off light.
#[derive(Clone, Copy, Debug)]
struct Emitter {
    shape: PatchPolygon,
    light: LinearRgb,
}

/// Tells the light at any place. Shared by all threads.
#[derive(Clone, Debug)]
pub struct Probe<'a> {
    field: &'a LightField<'a>,
    finder: &'a ElementFinder<'a>,
    occluders: &'a Occluders,
    direct: &'a DirectLight,
    emitters: Vec<Emitter>,
    settings: ProbeSettings,
}

impl<'a> Probe<'a> {
    /// From what is known: light on surfaces, what is in the way, and lamps.
    #[must_use]
    pub fn new(
        field: &'a LightField<'a>,
        finder: &'a ElementFinder<'a>,
        occluders: &'a Occluders,
        direct: &'a DirectLight,
        settings: &ProbeSettings,
    ) -> Self {
        let mesh = field.mesh();
        let polygons = 0..mesh.polygons().len() as u32;
        let emitter =
            |polygon: u32| Emitter { shape: mesh.shape(polygon), light: mesh.surface(polygon).emission };
        let emitters = polygons.map(emitter).filter(|emitter| emitter.light != LinearRgb::BLACK).collect();
        let ProbeSettings { directions, sights } = *settings;
        let settings = ProbeSettings { directions: directions.max(1), sights: sights.max(1) };
        Self { field, finder, occluders, direct, emitters, settings }
    }

    /// Light that arrives at a place on a surface with this unit normal: what a white matt surface would
    /// show there. `turn` in [0, 1) turns the directions about the normal.
    #[must_use]
    pub fn at(&self, place: DVec3, normal: DVec3, turn: f64) -> LinearRgb {
        let lamps = self.direct.at(self.occluders, place, normal);
        let emitters = self.emitters.iter().map(|emitter| self.light_of(emitter, place, normal));
        let known = emitters.fold(lamps, |sum, light| sum + light);
        known + self.reflected(place, normal, turn)
    }

    fn light_of(&self, emitter: &Emitter, place: DVec3, normal: DVec3) -> LinearRgb {
        let factor = point_to_polygon(place, normal, emitter.shape.corners());
        if factor <= 0.0 {
            return LinearRgb::BLACK;
        }
        let n = self.settings.sights;
        let step = f64::from(n).recip();
        let (mut seen, mut all) = (LinearRgb::BLACK, 0.0_f32);
        for i in 0..n * n {
            let [u, v] = [i % n, i / n].map(|i| (f64::from(i) + 0.5) * step);
            let source = emitter.shape.place(u, v);
            // Lines of sight count as much as they bring.
            let way = source - place;
            let weight = (way.dot(normal).max(0.0) / way.length_squared().powi(2)) as f32;
            if weight > 0.0 {
                seen += self.occluders.transmittance(place, source) * weight;
                all += weight;
            }
        }
        let share = if all > 0.0 { seen * all.recip() } else { LinearRgb::BLACK };
        emitter.light * share * factor as f32
    }

    /// Light that surfaces around reflect to the place.
    fn reflected(&self, place: DVec3, normal: DVec3, turn: f64) -> LinearRgb {
        let (s, t) = normal.any_orthonormal_pair();
        let n = self.settings.directions;
        let mut sum = LinearRgb::BLACK;
        for i in 0..n {
            let [x, y, z] = cosine_direction(i, n, turn);
            sum += self.along(place, s * x + t * y + normal * z);
        }
        sum * (n as f32).recip()
    }

    /// Reflected light that comes from a direction.
    fn along(&self, place: DVec3, direction: DVec3) -> LinearRgb {
        let mesh = self.field.mesh();
        let (mut from, mut share) = (place, LinearRgb::WHITE);
        // Through thin panes, but not for ever.
        for _ in 0..8 {
            let Some(hit) = self.occluders.closest(from, direction) else { break };
            let point = from + direction * hit.t;
            let surface = mesh.surface(hit.polygon);
            if surface.transmittance == LinearRgb::BLACK {
                if !hit.front {
                    break;
                }
                let place = self.finder.on_polygon(hit.polygon, point);
                return share * surface.reflectance * self.field.at(place.element, place.point);
            }
            share = share * surface.transmittance;
            from = point;
        }
        LinearRgb::BLACK
    }
}

/// The `i`th of `n` directions about +z, spread evenly by the cosine: a spiral of golden angles on the
/// disc, raised to the hemisphere (Malley).
fn cosine_direction(i: u32, n: u32, turn: f64) -> [f64; 3] {
    /// Fraction of a turn that spreads points best: 2 minus the golden ratio.
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let share = (f64::from(i) + 0.5) / f64::from(n);
    let (sin, cos) = (TAU * (f64::from(i) * GOLDEN + turn).fract()).sin_cos();
    let radius = share.sqrt();
    [radius * cos, radius * sin, (1.0 - share).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::Interpolation;
    use crate::{DirectSettings, ElementMesh};
    use senca_scene::Scene;

    #[test]
    fn directions_have_the_mean_of_the_cosine_law() {
        let n = 1000;
        let mean = (0..n)
            .map(|i| cosine_direction(i, n, 0.3))
            .fold([0.0; 3], |s, d| [0, 1, 2].map(|k| s[k] + d[k] / f64::from(n)));
        assert!(
            mean[0].abs() < 2e-3 && mean[1].abs() < 2e-3 && (mean[2] - 2.0 / 3.0).abs() < 1e-3,
            "{mean:?}"
        );
    }

    /// Light at the middle of a closed cube whose walls show 1 is 1, whatever part of it is their own.
    #[test]
    fn in_a_room_of_even_light_the_light_is_even() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let walls = [
            [p(0., 0., 0.), p(0., 0., 1.), p(1., 0., 1.), p(1., 0., 0.)],
            [p(0., 1., 0.), p(1., 1., 0.), p(1., 1., 1.), p(0., 1., 1.)],
            [p(0., 0., 0.), p(1., 0., 0.), p(1., 1., 0.), p(0., 1., 0.)],
            [p(0., 0., 1.), p(0., 1., 1.), p(1., 1., 1.), p(1., 0., 1.)],
            [p(0., 0., 0.), p(0., 1., 0.), p(0., 1., 1.), p(0., 0., 1.)],
            [p(1., 0., 0.), p(1., 0., 1.), p(1., 1., 1.), p(1., 1., 0.)],
        ];
        let (grey, glow) = (LinearRgb::splat(0.75), LinearRgb::splat(0.25));
        let polygons: Vec<_> = walls.iter().map(|wall| (&wall[..], grey, glow)).collect();
        let mesh = ElementMesh::of_polygons(&polygons);
        let field = LightField::new(&mesh, vec![LinearRgb::WHITE; 6], Interpolation::Smooth);
        let finder = ElementFinder::new(&mesh).expect("a finder");
        let occluders = Occluders::new(&mesh).expect("occluders");
        let direct = DirectLight::of_scene(&Scene::default(), &DirectSettings::default()).expect("no lamps");
        let probe = Probe::new(&field, &finder, &occluders, &direct, &ProbeSettings::default());
        for place in [p(0.5, 0.5, 0.5), p(0.2, 0.9, 0.4)] {
            let light = probe.at(place, DVec3::new(0.6, 0.0, 0.8), 0.0);
            assert!((light.g - 1.0).abs() < 1e-4, "{light:?}");
        }
    }
}
