//! Lights with an extent: places on them, and how dense directions towards those places are.

use senca_math::LinearRgb;
use senca_math::glam::{DMat4, DVec2, DVec3};
use senca_scene::Attenuation;
use senca_shading::distance_attenuation;
use std::f64::consts::{PI, TAU};

use super::warp;
use crate::Ray;

/// A place on a light, seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Unit direction towards it.
    pub(super) direction: DVec3,
    /// How far it is.
    pub(super) distance: f64,
    /// Density per steradian of such directions.
    pub(super) pdf: f64,
}

/// Density per steradian of directions towards places that are spread with `density` per area, at
/// `way` from the point, on a surface with this unit normal.
pub(super) fn solid_angle_pdf(density: f64, way: DVec3, normal: DVec3) -> f64 {
    let d2 = way.length_squared();
    let facing = normal.dot(way).abs();
    if facing > 0.0 { density * d2 * d2.sqrt() / facing } else { 0.0 }
}

/// The way to a place that was chosen with `density` per area; `None` where the surface is seen
/// edge-on, or touched.
pub(super) fn place_at(way: DVec3, density: f64, normal: DVec3) -> Option<Place> {
    let distance = way.length();
    let pdf = solid_angle_pdf(density, way, normal);
    (pdf > 0.0 && pdf.is_finite()).then(|| Place { direction: way / distance, distance, pdf })
}

/// A rectangle that shines to one side (`LightKind::Area`), a parallelogram where its node shears it.
///
/// Its colour is that of a lamp that lights a surface as the other renderers have it: with the share
/// `fatt(d) cos` of it arriving at the distance d. A rectangle of area A and radiance
/// `pi color / A d^2 fatt(d)` does, which is a plain lambertian lamp where light falls with the square
/// of the distance, and one that knows how far it is seen from otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    corner: DVec3,
    edges: [DVec3; 2],
    /// Unit; the side that shines.
    normal: DVec3,
    pub(super) area: f64,
    /// pi color / area.
    pub(super) radiance: LinearRgb,
    /// Whether rays meet it.
    pub(super) visible: bool,
    attenuation: Attenuation,
}

impl Rectangle {
    /// Of a light of this size in the xy plane of its frame, which shines along -z. `None` where the
    /// frame flattens it.
    pub(super) fn new(
        size: [f64; 2],
        world_from_light: &DMat4,
        color: LinearRgb,
        attenuation: Attenuation,
    ) -> Option<Self> {
        let edges = [DVec3::X * size[0], DVec3::Y * size[1]].map(|e| world_from_light.transform_vector3(e));
        let across = edges[0].cross(edges[1]);
        let area = across.length();
        let forward = world_from_light.transform_vector3(DVec3::NEG_Z);
        let normal = across.try_normalize()? * -across.dot(-forward).signum();
        let middle = world_from_light.transform_point3(DVec3::ZERO);
        let corner = middle - 0.5 * (edges[0] + edges[1]);
        let usable = area.is_finite() && corner.is_finite();
        let radiance = color * (PI / area) as f32;
        usable.then_some(Self { corner, edges, normal, area, radiance, visible: true, attenuation })
    }

    pub(super) fn middle(&self) -> DVec3 {
        self.corner + 0.5 * (self.edges[0] + self.edges[1])
    }

    /// Radiance seen from this far.
    pub(super) fn seen(&self, distance: f64) -> LinearRgb {
        match self.attenuation {
            Attenuation::InverseSquare { range: None } => self.radiance,
            other => {
                let share = f64::from(distance_attenuation(&other, distance as f32));
                self.radiance * (distance * distance * share) as f32
            }
        }
    }

    /// Whether a point is on the side that shines.
    pub(super) fn shines_at(&self, point: DVec3) -> bool {
        self.normal.dot(point - self.corner) > 0.0
    }

    /// A place on it, evenly.
    pub(super) fn sample(&self, point: DVec3, [u, v]: [f64; 2]) -> Option<Place> {
        if !self.shines_at(point) {
            return None;
        }
        let way = self.corner + u * self.edges[0] + v * self.edges[1] - point;
        place_at(way, 1.0 / self.area, self.normal)
    }

    /// Density of [`Rectangle::sample`] towards the place at `way` from the point.
    pub(super) fn pdf_over(&self, way: DVec3) -> f64 {
        solid_angle_pdf(1.0 / self.area, way, self.normal)
    }

    /// Where a ray meets the shining side.
    pub(super) fn meet(&self, ray: &Ray) -> Option<f64> {
        let towards = ray.direction.dot(self.normal);
        if towards >= 0.0 {
            return None;
        }
        let t = (self.corner - ray.origin).dot(self.normal) / towards;
        if !ray.admits(t) {
            return None;
        }
        let at = ray.at(t) - self.corner;
        let inside = self.coordinates(at);
        (inside.cmpge(DVec2::ZERO).all() && inside.cmple(DVec2::ONE).all()).then_some(t)
    }

    /// Shares of the two edges in a vector of the plane.
    fn coordinates(&self, at: DVec3) -> DVec2 {
        let [a, b] = self.edges;
        let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
        let (ta, tb) = (at.dot(a), at.dot(b));
        DVec2::new(bb * ta - ab * tb, aa * tb - ab * ta) / (aa * bb - ab * ab)
    }
}

/// A ball, chosen by the cone in which it is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl Ball {
    /// The ball that a sphere of this radius at the origin becomes; `None` unless it stays round.
    pub(super) fn of_sphere(radius: f64, world_from_object: &DMat4) -> Option<Self> {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| world_from_object.transform_vector3(e));
        let scale = x.length();
        let tolerance = 1e-9 * scale;
        let round = (y.length() - scale).abs() < tolerance && (z.length() - scale).abs() < tolerance;
        let square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|d| d.abs() < tolerance * scale);
        let center = world_from_object.transform_point3(DVec3::ZERO);
        (round && square && scale > 0.0).then_some(Self { center, radius: radius * scale })
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    /// Axis of the cone in which it is seen, and 1 - cos of its half angle; `None` from inside.
    fn cone(&self, point: DVec3) -> Option<(DVec3, f64)> {
        let way = self.center - point;
        let d2 = way.length_squared();
        let sin2 = self.radius * self.radius / d2;
        (sin2 < 1.0).then(|| (way / d2.sqrt(), sin2 / (1.0 + (1.0 - sin2).sqrt())))
    }

    /// A direction towards it, evenly over its cone.
    pub(super) fn sample(&self, point: DVec3, u: [f64; 2]) -> Option<Place> {
        let (axis, versine) = self.cone(point)?;
        let (x, y) = axis.any_orthonormal_pair();
        let w = warp::cone(u, versine);
        let direction = x * w.x + y * w.y + axis * w.z;
        // The near crossing; the rim may miss by rounding.
        let way = self.center - point;
        let along = way.dot(direction);
        let off = way - along * direction;
        let half = (self.radius * self.radius - off.length_squared()).max(0.0).sqrt();
        Some(Place { direction, distance: along - half, pdf: 1.0 / (TAU * versine) })
    }

    /// Density of [`Ball::sample`] towards any place of it; 0 from inside.
    pub(super) fn pdf(&self, point: DVec3) -> f64 {
        self.cone(point).map_or(0.0, |(_, versine)| 1.0 / (TAU * versine))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pattern, Sampler};

    fn mean(n: u32, of: impl Fn([f64; 2]) -> f64) -> f64 {
        let one = |i| of(Sampler::new(Pattern::Sobol, 3, 1, 2, i).next_2d());
        (0..n).map(one).sum::<f64>() / f64::from(n)
    }

    fn lamp(attenuation: Attenuation) -> Rectangle {
        // Over the origin at height 2, shining down.
        let down = DMat4::from_translation(DVec3::Y * 2.0) * DMat4::from_rotation_x(-PI / 2.0);
        Rectangle::new([3.0, 1.0], &down, LinearRgb::WHITE, attenuation).expect("a rectangle")
    }

    /// Light that arrives at a white matt surface which faces +y, as it is shown: irradiance over pi.
    fn arrives(lamp: &Rectangle, point: DVec3) -> f64 {
        mean(4096, |u| {
            let place = lamp.sample(point, u);
            place.map_or(0.0, |p| f64::from(lamp.seen(p.distance).r) * p.direction.y.max(0.0) / p.pdf)
        }) / PI
    }

    #[test]
    fn a_rectangle_lights_as_its_closed_form_says() {
        let lamp = lamp(Attenuation::InverseSquare { range: None });
        // Irradiance under the middle: pi L times the form factor of four rectangles a x b with a
        // corner above the point (Siegel and Howell, configuration factor 4).
        let corner = |a: f64, b: f64| {
            let (x, y) = (a / 2.0, b / 2.0);
            let (sx, sy) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
            (x / sx * (y / sx).atan() + y / sy * (x / sy).atan()) / TAU
        };
        let expected = f64::from(lamp.radiance.r) * 4.0 * corner(1.5, 0.5);
        let found = arrives(&lamp, DVec3::ZERO);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found}, not {expected}");
        assert_eq!(arrives(&lamp, DVec3::Y * 3.0), 0.0, "nothing behind");
    }

    #[test]
    fn far_away_it_is_a_lamp_of_its_colour() {
        let lamp = lamp(Attenuation::None);
        let found = arrives(&lamp, DVec3::NEG_Y * 998.0);
        assert!((found - 1.0).abs() < 1e-3, "{found}");
        let falling = self::lamp(Attenuation::InverseSquare { range: None });
        assert!((arrives(&falling, DVec3::NEG_Y * 998.0) * 1e6 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn rays_meet_rectangles_where_samples_lie() {
        let lamp = lamp(Attenuation::None);
        let point = DVec3::new(0.3, -1.0, 0.4);
        for u in [[0.01, 0.99], [0.5, 0.5], [0.99, 0.01]] {
            let place = lamp.sample(point, u).expect("in front");
            let ray = Ray::new(point, place.direction);
            let t = lamp.meet(&ray).expect("met");
            assert!((t - place.distance).abs() < 1e-12);
            assert!((lamp.pdf_over(ray.direction * t) / place.pdf - 1.0).abs() < 1e-12);
        }
        let past = Ray::new(point, lamp.sample(point, [1.01, 0.5]).expect("outside").direction);
        assert_eq!(lamp.meet(&past), None);
        let behind = Ray::new(DVec3::Y * 3.0, DVec3::NEG_Y);
        assert_eq!(lamp.meet(&behind), None);
    }

    #[test]
    fn a_ball_lights_as_its_closed_form_says() {
        let ball = Ball { center: DVec3::Y * 3.0, radius: 1.2 };
        // Irradiance of a surface that faces the middle of a ball of radiance 1: pi (r / d)^2.
        let found = mean(4096, |u| {
            let place = ball.sample(DVec3::ZERO, u).expect("outside");
            place.direction.y / place.pdf
        });
        assert!((found / (PI * 0.16) - 1.0).abs() < 1e-3, "{found}");
        assert_eq!(ball.pdf(ball.center), 0.0);
        let place = ball.sample(DVec3::ZERO, [0.999_999, 0.3]).expect("outside");
        assert!((place.direction * place.distance - ball.center).length() < 1.2 + 1e-9);
    }

    #[test]
    fn only_round_spheres_are_balls() {
        let round = DMat4::from_translation(DVec3::X) * DMat4::from_scale(DVec3::splat(2.0));
        assert_eq!(Ball::of_sphere(1.5, &round), Some(Ball { center: DVec3::X, radius: 3.0 }));
        assert_eq!(Ball::of_sphere(1.5, &DMat4::from_scale(DVec3::new(1.0, 1.0, 2.0))), None);
    }
}
