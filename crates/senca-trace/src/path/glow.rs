//! Surfaces that give off light, as lights that can be chosen.
//!
//! Flat surfaces are chosen triangle by triangle, each as often as it has power, so the density over
//! the area of all is the brightness over the whole power and a place that was hit knows it without
//! knowing its triangle. Spheres are chosen by the cone in which they are seen. Other shapes are lit
//! up only by being met.

use std::borrow::Cow;

use senca_math::glam::{DMat4, DVec3};
use senca_math::{Aabb, LinearRgb};
use senca_scene::{Mesh, Shape, TessellationSettings, tessellate};

use super::area::{Ball, Place, place_at, solid_angle_pdf};
use super::distribution::Distribution;
use super::warp;
use crate::{Crossing, Hit, Interaction, MaterialTable, Object, Ray, World};

/// An object that shines.
#[derive(Debug)]
pub(super) struct Glow<'s> {
    /// Index of the object.
    pub(super) object: u32,
    form: Form<'s>,
    center: DVec3,
    radius: f64,
    /// Sum over the surface of luminance times area.
    power: f64,
}

#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few")]
enum Form<'s> {
    Ball { ball: Ball, material: usize },
    Triangles(Triangles<'s>),
}

#[derive(Debug)]
struct Triangles<'s> {
    mesh: Cow<'s, Mesh>,
    world_from_object: DMat4,
    /// Those that shine.
    numbers: Vec<u32>,
    chances: Distribution,
}

/// A place on a shining surface, seen from a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shining {
    pub(super) place: Place,
    pub(super) radiance: LinearRgb,
}

/// How often a colour is chosen: by luminance, but never never.
fn brightness(color: LinearRgb) -> f64 {
    f64::from(color.luminance().max(1e-3 * color.max_component()).max(0.0))
}

impl<'s> Glow<'s> {
    /// Of an object of `world`; `None` where nothing of it shines, or where it can only be met.
    pub(super) fn new(world: &World<'s>, materials: &MaterialTable<'_>, object: u32) -> Option<Self> {
        let placed = &world.objects()[object as usize];
        if placed.materials.iter().all(|&m| materials.emission(m).max_component() <= 0.0) {
            return None;
        }
        let shape = &world.scene().geometries[placed.geometry.index()].shape;
        let (form, power) = match shape {
            Shape::Sphere { radius } => {
                let material = placed.material_of(0);
                let ball = Ball::of_sphere(*radius, &placed.world_from_object)?;
                let plain = !materials.emission_varies(material);
                let power = ball.area() * brightness(materials.emission(material));
                plain.then_some((Form::Ball { ball, material }, power))?
            }
            Shape::Mesh(_) => triangles_of(placed, shape, materials, true)?,
            Shape::Box { .. }
            | Shape::Polygon { .. }
            | Shape::Prism { .. }
            | Shape::Plane { size: Some(_) } => triangles_of(placed, shape, materials, false)?,
            _ => return None,
        };
        let Aabb { min, max } = placed.bounds_world;
        let (center, radius) = (0.5 * (min + max), 0.5 * (max - min).length());
        let usable = power > 0.0 && power.is_finite() && center.is_finite() && radius.is_finite();
        usable.then_some(Self { object, form, center, radius, power })
    }

    /// About how much light arrives at a point.
    pub(super) fn importance(&self, point: DVec3) -> f64 {
        let d2 = (point - self.center).length_squared();
        self.power / d2.max(self.radius * self.radius).max(f64::MIN_POSITIVE)
    }

    /// A place that shines towards `point`.
    pub(super) fn sample(
        &self,
        world: &World<'_>,
        materials: &MaterialTable<'_>,
        point: DVec3,
        choice: f64,
        u: [f64; 2],
    ) -> Option<Shining> {
        match &self.form {
            Form::Ball { ball, material } => {
                Some(Shining { place: ball.sample(point, u)?, radiance: materials.emission(*material) })
            }
            Form::Triangles(triangles) => {
                let placed = &world.objects()[self.object as usize];
                let (index, chance, _) = triangles.chances.choose(choice)?;
                let number = triangles.numbers[index];
                let [a, b, c] = triangles.corners(number);
                let uv = warp::triangle(u);
                let across = (b - a).cross(c - a);
                let area = 0.5 * across.length();
                let normal = triangles.outward(across)?;
                let way = a + uv.x * (b - a) + uv.y * (c - a) - point;
                let material = placed.material_of(triangles.mesh.faces.surface_of(number as usize));
                if normal.dot(way) >= 0.0 && !materials.is_double_sided(material) {
                    return None;
                }
                let place = place_at(way, chance / area, normal)?;
                let radiance = if materials.emission_varies(material) {
                    let crossing = Crossing { t: place.distance, part: number, uv };
                    let ray = Ray::new(point, place.direction);
                    let at = world.interaction(&ray, &Hit { object: self.object, crossing });
                    let seen = materials.at(&at);
                    seen.emission * seen.coverage
                } else {
                    materials.emission(material)
                };
                Some(Shining { place, radiance })
            }
        }
    }

    /// Density of [`Glow::sample`] from `point` towards a place of this object that was met.
    pub(super) fn pdf(&self, materials: &MaterialTable<'_>, point: DVec3, at: &Interaction) -> f64 {
        match &self.form {
            Form::Ball { ball, .. } => ball.pdf(point),
            Form::Triangles(_) => {
                let density = brightness(materials.emission(at.material)) / self.power;
                solid_angle_pdf(density, at.point - point, at.normal)
            }
        }
    }
}

impl Triangles<'_> {
    fn corners(&self, number: u32) -> [DVec3; 3] {
        let first = 3 * number as usize;
        let corner = |i: usize| {
            let position = self.mesh.position(self.mesh.faces.corners[first + i]);
            self.world_from_object.transform_point3(position.as_dvec3())
        };
        [corner(0), corner(1), corner(2)]
    }

    /// The unit normal on the outside, from the product of the sides; placements that mirror turn the
    /// sense of corners, but not the outside.
    fn outward(&self, across: DVec3) -> Option<DVec3> {
        let sign = if self.world_from_object.determinant() < 0.0 { -1.0 } else { 1.0 };
        Some(across.try_normalize()? * sign)
    }
}

/// The triangles of a flat shape that shine, and their power. `None` where one of them varies and
/// textures cannot be asked.
fn triangles_of<'s>(
    placed: &Object<'s>,
    shape: &'s Shape,
    materials: &MaterialTable<'_>,
    are_parts: bool,
) -> Option<(Form<'s>, f64)> {
    let mesh = tessellate(shape, &TessellationSettings::default()).ok()?;
    let mut triangles = Triangles {
        mesh,
        world_from_object: placed.world_from_object,
        numbers: Vec::new(),
        chances: Distribution::default(),
    };
    let mut weights = Vec::new();
    for number in 0..(triangles.mesh.faces.corners.len() / 3) as u32 {
        let material = placed.material_of(triangles.mesh.faces.surface_of(number as usize));
        let emission = brightness(materials.emission(material));
        let [a, b, c] = triangles.corners(number);
        let weight = 0.5 * (b - a).cross(c - a).length() * emission;
        if weight > 0.0 && weight.is_finite() {
            if !are_parts && materials.emission_varies(material) {
                return None;
            }
            triangles.numbers.push(number);
            weights.push(weight);
        }
    }
    triangles.chances = Distribution::new(weights);
    let power = triangles.chances.total();
    Some((Form::Triangles(triangles), power))
}
