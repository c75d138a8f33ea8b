//! Meshes as surfaces that rays meet.

use std::borrow::Cow;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use senca_scene::{Mesh, Shape, ShapeError, TessellationSettings, tessellate};

use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

/// A mesh of triangles.
#[derive(Debug)]
pub(crate) struct MeshSurface<'s> {
    mesh: Cow<'s, Mesh>,
    bounds: Aabb,
}

impl<'s> MeshSurface<'s> {
    /// The triangles of `shape`.
    pub(crate) fn new(shape: &'s Shape, settings: &TessellationSettings) -> Result<Self, ShapeError> {
        let mesh = tessellate(shape, settings)?;
        let bounds = mesh.bounds();
        Ok(Self { mesh, bounds })
    }

    /// Vertex numbers of a triangle's corners.
    fn corners(&self, triangle: u32) -> [u32; 3] {
        let first = 3 * triangle as usize;
        let corners = &self.mesh.faces.corners;
        [corners[first], corners[first + 1], corners[first + 2]]
    }

    fn points(&self, triangle: u32) -> [DVec3; 3] {
        self.corners(triangle).map(|c| self.mesh.position(c).as_dvec3())
    }
}

/// Möller and Trumbore 1997: t and the weights of the second and third corner.
fn meet(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<(f64, DVec2)> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let inverse = 1.0 / determinant;
    let s = ray.origin - a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    let t = e2.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ray.admits(t)).then_some((t, DVec2::new(u, v)))
}

impl Intersect for MeshSurface<'_> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let mut ray = *ray;
        let mut nearest = None;
        for triangle in 0..self.part_count() {
            if let Some(crossing) = self.closest_in_part(triangle, &ray, counters) {
                ray.t_max = crossing.t;
                nearest = Some(crossing);
            }
        }
        nearest
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        let first = out.len();
        for triangle in 0..self.part_count() {
            out.extend(self.closest_in_part(triangle, ray, counters));
        }
        out[first..].sort_by(|a, b| a.t.total_cmp(&b.t));
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let corners = self.corners(crossing.part);
        let [a, b, c] = self.points(crossing.part);
        let weights = [1.0 - crossing.uv.x - crossing.uv.y, crossing.uv.x, crossing.uv.y].map(|w| w as f32);
        let vertices = &self.mesh.vertices;
        let normal = (b - a).cross(c - a).normalize_or(-ray.direction.normalize_or_zero());
        let smooth = blend(&vertices.normal, corners, weights).map(Vec3::as_dvec3);
        let shading_normal = smooth.and_then(DVec3::try_normalize).unwrap_or(normal);
        let texcoord = |set: &[Vec2]| blend(set, corners, weights).unwrap_or_default().as_dvec2();
        let tangent = blend(&vertices.tangent, corners, weights).unwrap_or(Vec4::ZERO);
        SurfacePoint {
            point: f64::from(weights[0]) * a + f64::from(weights[1]) * b + f64::from(weights[2]) * c,
            normal,
            shading_normal,
            texcoords: [texcoord(&vertices.texcoord0), texcoord(&vertices.texcoord1)],
            tangent: tangent.truncate().as_dvec3(),
            handedness: if tangent.w < 0.0 { -1.0 } else { 1.0 },
            color: blend(&vertices.color, corners, weights).unwrap_or(Vec4::ONE),
            surface: self.mesh.faces.surface_of(crossing.part as usize),
        }
    }

    fn is_closed(&self) -> bool {
        senca_scene::Topology::new(&self.mesh).is_closed()
    }

    fn part_count(&self) -> u32 {
        (self.mesh.faces.corners.len() / 3) as u32
    }

    fn part_bounds(&self, part: u32) -> Aabb {
        Aabb::of_points(self.points(part))
    }

    fn closest_in_part(&self, part: u32, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        counters.tests += 1;
        let (t, uv) = meet(ray, self.points(part))?;
        Some(Crossing { t, part, uv })
    }
}

/// Weighted mean of the corners' values of an attribute, where there is one.
fn blend<T>(values: &[T], corners: [u32; 3], weights: [f32; 3]) -> Option<T>
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let [a, b, c] = corners.map(|corner| values.get(corner as usize).copied());
    Some(a? * weights[0] + b? * weights[1] + c? * weights[2])
}
