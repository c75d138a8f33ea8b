//! Meshes as surfaces that rays meet.

use std::borrow::Cow;
use std::sync::OnceLock;

use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use senca_scene::{Mesh, Topology};

use crate::accel::BoxTree;
use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

/// Share of the largest coordinate by which single precision, in which points are stored, may move
/// things.
const PRECISION: f64 = 1.0 / (1 << 21) as f64;
/// Triangles that a leaf of the hierarchy may hold.
const LEAF_SIZE: u32 = 4;

/// A mesh of triangles.
#[derive(Debug)]
pub(crate) struct MeshSurface<'s> {
    mesh: Cow<'s, Mesh>,
    bounds: Aabb,
    tree: Option<BoxTree>,
    closed: OnceLock<bool>,
}

impl<'s> MeshSurface<'s> {
    /// The triangles of `mesh`, which holds together and has no other faces. Without a hierarchy it is
    /// asked part by part.
    pub(crate) fn of_mesh(mesh: Cow<'s, Mesh>, hierarchy: bool) -> Self {
        let bounds = mesh.bounds();
        let mut surface = Self { mesh, bounds, tree: None, closed: OnceLock::new() };
        if hierarchy {
            let boxes: Vec<Aabb> = (0..surface.part_count()).map(|i| surface.widened(i)).collect();
            surface.tree = Some(BoxTree::new(&boxes, LEAF_SIZE));
        }
        surface
    }

    /// Box around a triangle, wider than rounding.
    fn widened(&self, triangle: u32) -> Aabb {
        let bounds = Aabb::of_points(self.points(triangle));
        let margin = DVec3::splat(1e-12 * self.bounds.min.abs().max(self.bounds.max.abs()).max_element());
        Aabb { min: bounds.min - margin, max: bounds.max + margin }
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
        let line = ray;
        let mut ray = *ray;
        let mut nearest = None;
        let mut ask = |triangle: u32, counters: &mut Counters| {
            if let Some(crossing) = self.closest_in_part(triangle, &ray, counters) {
                let before = |n: &Crossing| (crossing.t, crossing.part) < (n.t, n.part);
                if nearest.as_ref().is_none_or(before) {
                    ray.t_max = crossing.t.next_up();
                    nearest = Some(crossing);
                }
            }
            ray.t_max
        };
        match &self.tree {
            Some(tree) => tree.traverse(line, counters, |triangles, counters| {
                triangles.iter().map(|&triangle| ask(triangle, counters)).last()
            }),
            None => (0..self.part_count()).for_each(|triangle| {
                ask(triangle, counters);
            }),
        }
        nearest
    }

    fn occludes(&self, ray: &Ray, counters: &mut Counters) -> bool {
        let meets =
            |triangle: u32, counters: &mut Counters| self.closest_in_part(triangle, ray, counters).is_some();
        let Some(tree) = &self.tree else {
            return (0..self.part_count()).any(|triangle| meets(triangle, counters));
        };
        let mut met = false;
        tree.traverse(ray, counters, |triangles, counters| {
            met = triangles.iter().any(|&triangle| meets(triangle, counters));
            (!met).then_some(ray.t_max)
        });
        met
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        let first = out.len();
        let mut add = |triangle, counters: &mut Counters| {
            out.extend(self.closest_in_part(triangle, ray, counters));
        };
        match &self.tree {
            Some(tree) => tree.traverse(ray, counters, |triangles, counters| {
                triangles.iter().for_each(|&triangle| add(triangle, counters));
                Some(ray.t_max)
            }),
            None => (0..self.part_count()).for_each(|triangle| add(triangle, counters)),
        }
        out[first..].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
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
        *self.closed.get_or_init(|| Topology::new(&self.mesh).is_closed())
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

    fn precision(&self) -> f64 {
        PRECISION
    }

    fn memory_bytes(&self) -> usize {
        self.tree.as_ref().map_or(0, BoxTree::memory_bytes)
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
