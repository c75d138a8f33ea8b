//! Meshes as surfaces that rays meet.

use std::borrow::Cow;
use std::sync::OnceLock;

use senca_bvh::{BruteForce, BuildError, BuildSettings, Ray32, TraversalCounts, TriangleBvh, TriangleHit};
use senca_math::Aabb;
use senca_math::glam::{DVec2, DVec3, Vec2, Vec3, Vec4};
use senca_scene::{Mesh, Topology};

use crate::intersect::{FlatTriangle, Form, ray_triangle};
use crate::{Counters, Crossing, Crossings, Intersect, Ray, SurfacePoint};

/// Share of the largest coordinate by which single precision, in which points are stored, may move
/// things.
const PRECISION: f64 = 1.0 / (1 << 21) as f64;
/// Meshes of up to so many triangles are met in double precision, one triangle after the other.
const FEW: usize = 16;
/// Directions with a largest component in this range keep their digits in single precision.
const PLAIN: std::ops::Range<f64> = 1e-30..1e30;

/// A mesh of triangles.
///
/// Rays meet its triangles in single precision, in which its points are stored, without gaps between
/// neighbours; the place on the triangle is then found in double precision. Walls, boxes and others of
/// few triangles, which are often large, are met in double precision.
#[derive(Debug)]
pub(crate) struct MeshSurface<'s> {
    mesh: Cow<'s, Mesh>,
    bounds: Aabb,
    hierarchy: Option<TriangleBvh>,
    /// Corners of the triangles where there are few.
    few: Option<Box<[[DVec3; 3]]>>,
    closed: OnceLock<bool>,
}

impl<'s> MeshSurface<'s> {
    /// The triangles of `mesh`, which holds together and has no other faces. Without a hierarchy it is
    /// asked part by part.
    pub(crate) fn of_mesh(mesh: Cow<'s, Mesh>, hierarchy: bool) -> Result<Self, BuildError> {
        let few = (mesh.faces.corners.len() <= 3 * FEW).then(|| corners_of(&mesh));
        let hierarchy = (hierarchy && few.is_none()).then(|| hierarchy_of(&mesh)).transpose()?;
        Ok(Self { bounds: mesh.bounds(), mesh, hierarchy, few, closed: OnceLock::new() })
    }

    /// Vertex numbers of a triangle's corners.
    fn corners(&self, triangle: u32) -> [u32; 3] {
        let first = 3 * triangle as usize;
        let corners = &self.mesh.faces.corners;
        [corners[first], corners[first + 1], corners[first + 2]]
    }

    fn points(&self, triangle: u32) -> [Vec3; 3] {
        self.corners(triangle).map(|c| self.mesh.position(c))
    }
}

/// Corners of all triangles.
fn corners_of(mesh: &Mesh) -> Box<[[DVec3; 3]]> {
    let triangles = mesh.faces.corners.as_chunks::<3>().0;
    triangles.iter().map(|corners| corners.map(|c| mesh.position(c).as_dvec3())).collect()
}

fn hierarchy_of(mesh: &Mesh) -> Result<TriangleBvh, BuildError> {
    let triangles: Vec<[u32; 3]> = mesh
        .faces
        .corners
        .as_chunks::<3>()
        .0
        .iter()
        .map(|corners| corners.map(|corner| mesh.vertices.point[corner as usize]))
        .collect();
    TriangleBvh::build(&mesh.points, &triangles, &BuildSettings::default())
}

/// A ray in single precision, and what its parameters are to be multiplied with.
#[derive(Clone, Copy, Debug)]
struct Single {
    ray: Ray32,
    unit: f64,
}

impl Single {
    #[inline]
    fn new(ray: &Ray) -> Self {
        if PLAIN.contains(&ray.direction.abs().max_element()) {
            return Self::of(ray, 1.0);
        }
        Self::scaled(ray)
    }

    #[cold]
    fn scaled(ray: &Ray) -> Self {
        let unit = 1.0 / ray.direction.abs().max_element();
        let direction = ray.direction * unit;
        Self::of(&Ray { direction, t_min: ray.t_min / unit, t_max: ray.t_max / unit, ..*ray }, unit)
    }

    /// Limits are rounded up: nothing at or before `t_min` is met, and what is met too late is told from
    /// the rest afterwards.
    #[inline]
    fn of(ray: &Ray, unit: f64) -> Self {
        let ray = Ray32 {
            origin: ray.origin.as_vec3(),
            t_min: rounded_up(ray.t_min),
            direction: ray.direction.as_vec3(),
            t_max: rounded_up(ray.t_max),
        };
        Self { ray, unit }
    }

    #[inline]
    fn crossing(&self, hit: &TriangleHit) -> Crossing {
        let uv = DVec2::new(f64::from(hit.u), f64::from(hit.v));
        Crossing { t: f64::from(hit.t) * self.unit, part: hit.triangle, uv }
    }
}

/// The smallest number of single precision that is not below `x`.
#[inline]
pub(crate) fn rounded_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}

/// Weights of the second and third corner where the line of the ray meets the plane of the triangle
/// (Möller and Trumbore 1997), moved into the triangle where rounding has left them outside.
fn weights(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<DVec2> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let s = ray.origin - a;
    let weights = DVec2::new(s.dot(p), ray.direction.dot(s.cross(e1))) / e1.dot(p);
    let weights = weights.is_finite().then(|| weights.max(DVec2::ZERO))?;
    Some(weights / (weights.x + weights.y).max(1.0))
}

impl Intersect for MeshSurface<'_> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    #[inline]
    fn closest(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        let Some(hierarchy) = &self.hierarchy else { return self.closest_of_all(ray, counters) };
        let single = Single::new(ray);
        let mut counts = TraversalCounts::default();
        let hit = hierarchy.closest_counted(&single.ray, &mut counts);
        add(counters, counts);
        hit.map(|hit| single.crossing(&hit)).filter(|crossing| ray.admits(crossing.t))
    }

    #[inline]
    fn occludes(&self, ray: &Ray, counters: &mut Counters) -> bool {
        let Some(hierarchy) = &self.hierarchy else { return self.closest_of_all(ray, counters).is_some() };
        let single = Single::new(ray);
        if f64::from(single.ray.t_max) * single.unit != ray.t_max {
            return hierarchy.occluded_where(&single.ray, |hit| ray.admits(single.crossing(hit).t));
        }
        let mut counts = TraversalCounts::default();
        let met = hierarchy.occluded_counted(&single.ray, &mut counts);
        add(counters, counts);
        met
    }

    fn crossings(&self, ray: &Ray, counters: &mut Counters, out: &mut Crossings) {
        let first = out.len();
        match &self.hierarchy {
            Some(hierarchy) => {
                let single = Single::new(ray);
                hierarchy.all_hits(&single.ray, |hit| out.push(single.crossing(hit)));
                counters.tests += (out.len() - first) as u64;
            }
            None => {
                let all = 0..self.part_count();
                out.extend(all.filter_map(|triangle| self.closest_in_part(triangle, ray, counters)));
            }
        }
        out[first..].sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
        let too_late = out[first..].partition_point(|crossing| ray.admits(crossing.t));
        out.truncate(first + too_late);
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let corners = self.corners(crossing.part);
        let [a, b, c] = self.points(crossing.part).map(Vec3::as_dvec3);
        let uv = weights(ray, [a, b, c]).unwrap_or(crossing.uv);
        let weights = [1.0 - uv.x - uv.y, uv.x, uv.y].map(|w| w as f32);
        let vertices = &self.mesh.vertices;
        let normal = (b - a).cross(c - a).normalize_or(-ray.direction.normalize_or_zero());
        let smooth = blend(&vertices.normal, corners, weights).map(Vec3::as_dvec3);
        let shading_normal = smooth.and_then(DVec3::try_normalize).unwrap_or(normal);
        let texcoord = |set: &[Vec2]| texcoord(set, corners, uv);
        let tangent = blend(&vertices.tangent, corners, weights).unwrap_or(Vec4::ZERO);
        SurfacePoint {
            point: a + uv.x * (b - a) + uv.y * (c - a),
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
        Aabb::of_points(self.points(part).map(Vec3::as_dvec3))
    }

    fn closest_in_part(&self, part: u32, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
        counters.tests += 1;
        if let Some(few) = &self.few {
            let (t, uv) = ray_triangle(ray, few[part as usize]).filter(|_| ray.is_valid())?;
            return ray.admits(t).then_some(Crossing { t, part, uv });
        }
        let single = Single::new(ray);
        let one = BruteForce { points: &self.points(part), triangles: &[[0, 1, 2]] };
        let hit = TriangleHit { triangle: part, ..one.closest(&single.ray)? };
        Some(single.crossing(&hit)).filter(|crossing| ray.admits(crossing.t))
    }

    /// Flat pieces that have nothing but texture coordinates.
    fn form(&self) -> Form {
        let vertices = &self.mesh.vertices;
        let bare = vertices.color.is_empty() && vertices.tangent.is_empty() && vertices.texcoord1.is_empty();
        let parts = 0..self.few.as_ref().map_or(0, |few| few.len()) as u32;
        if !bare || parts.is_empty() || parts.clone().any(|part| !self.is_flat(part)) {
            return Form::Other;
        }
        let triangle = |part: u32| FlatTriangle {
            corners: self.points(part).map(Vec3::as_dvec3),
            texcoords: self.corners(part).map(|corner| {
                vertices.texcoord0.get(corner as usize).copied().unwrap_or_default().as_dvec2()
            }),
            surface: self.mesh.faces.surface_of(part as usize),
        };
        Form::Triangles(parts.map(triangle).collect())
    }

    fn precision(&self) -> f64 {
        if self.few.is_some() { 1e-10 } else { PRECISION }
    }

    fn memory_bytes(&self) -> usize {
        let few = self.few.as_ref().map_or(0, |few| size_of_val(&**few));
        few + self.hierarchy.as_ref().map_or(0, TriangleBvh::memory_bytes)
    }
}

impl MeshSurface<'_> {
    /// Whether the normals to shade a triangle with are those of the triangle itself.
    fn is_flat(&self, triangle: u32) -> bool {
        let [a, b, c] = self.points(triangle).map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let own = |corner: u32| self.mesh.vertices.normal.get(corner as usize);
        self.corners(triangle).into_iter().all(|c| own(c).is_none_or(|n| n.distance(normal) < 1e-6))
    }

    /// The nearest crossing, by asking every triangle.
    fn closest_of_all(&self, ray: &Ray, counters: &mut Counters) -> Option<Crossing> {
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
}

#[inline]
fn add(counters: &mut Counters, counts: TraversalCounts) {
    counters.nodes += counts.nodes;
    counters.tests += counts.triangles;
}

/// Texture coordinates where the second and third corner have the weights `uv`. In double precision: on
/// a large floor they are large, and what counts is behind the point.
fn texcoord(set: &[Vec2], corners: [u32; 3], uv: DVec2) -> DVec2 {
    let [a, b, c] = corners.map(|corner| set.get(corner as usize).copied().unwrap_or_default().as_dvec2());
    a + uv.x * (b - a) + uv.y * (c - a)
}

/// Weighted mean of the corners' values of an attribute, where there is one.
fn blend<T>(values: &[T], corners: [u32; 3], weights: [f32; 3]) -> Option<T>
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let [a, b, c] = corners.map(|corner| values.get(corner as usize).copied());
    Some(a? * weights[0] + b? * weights[1] + c? * weights[2])
}
