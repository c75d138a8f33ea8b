//! Which element is at a place?

use std::collections::HashMap;

use senca_bvh::{BuildError, BuildSettings, Ray32, TriangleBvh};
use senca_math::glam::{DVec3, Vec3};

use crate::{ElementMesh, NONE};

/// Half the length of the needle that is stuck through a surface to find its polygon, as a share of the
/// diagonal of the mesh: several times as far as polygons are from curved shapes.
const REACH: f64 = 4e-3;

/// How far needles are moved aside, as shares of the diagonal, where the first passes between polygons.
const ASIDE: [f64; 3] = [1e-6, 1e-4, 2e-3];

/// A place on an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The leaf.
    pub element: u32,
    /// The place, moved onto the plane of the element.
    pub point: DVec3,
}

/// Finds elements by place.
///
/// A needle stuck through the surface meets the polygon there; the leaf is found down its tree. The
/// surface that was hit may be curved, and its polygons then are only near.
#[derive(Debug)]
pub struct ElementFinder<'m> {
    mesh: &'m ElementMesh,
    triangles: TriangleBvh,
    polygon_of: Vec<u32>,
    polygons_of_instance: HashMap<u32, Vec<u32>>,
    size: f64,
}

/// What is looked for.
#[derive(Clone, Copy)]
struct Wanted {
    instance: u32,
    material: u32,
    normal: DVec3,
}

impl<'m> ElementFinder<'m> {
    /// Over the polygons of `mesh`.
    ///
    /// # Errors
    /// [`BuildError`], for more polygons than a hierarchy holds.
    pub fn new(mesh: &'m ElementMesh) -> Result<Self, BuildError> {
        let points: Vec<Vec3> = mesh.positions().iter().map(|p| p.as_vec3()).collect();
        let (mut triangles, mut polygon_of) = (Vec::new(), Vec::new());
        let mut polygons_of_instance: HashMap<u32, Vec<u32>> = HashMap::new();
        for polygon in 0..mesh.polygons().len() as u32 {
            let [a, b, c, d] = mesh.elements()[polygon as usize].vertices;
            triangles.push([a, b, c]);
            polygon_of.push(polygon);
            if d != NONE {
                triangles.push([a, c, d]);
                polygon_of.push(polygon);
            }
            polygons_of_instance.entry(mesh.surface(polygon).instance).or_default().push(polygon);
        }
        let size = mesh.bounds().diagonal();
        let size = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let triangles = TriangleBvh::build(&points, &triangles, &BuildSettings::default())?;
        Ok(Self { mesh, triangles, polygon_of, polygons_of_instance, size })
    }

    /// The place on the mesh nearest to `point`, on the surface of this instance and material that faces
    /// where `normal` does. `None` where that side of the instance takes no part in the exchange of light.
    #[must_use]
    pub fn find(&self, instance: u32, material: u32, point: DVec3, normal: DVec3) -> Option<Place> {
        let wanted = Wanted { instance, material, normal };
        let polygon = self.polygon_at(point, &wanted)?;
        Some(self.on_polygon(polygon, point))
    }

    /// The place of a polygon nearest to `point`, which lies in its plane, or near it.
    #[must_use]
    pub fn on_polygon(&self, polygon: u32, point: DVec3) -> Place {
        let corner = self.mesh.shape(polygon).corners()[0];
        let up = self.mesh.normal(polygon);
        let point = point - up * (point - corner).dot(up);
        Place { element: self.leaf_at(polygon, point), point }
    }

    /// The leaf of a polygon that holds a place in its plane, or is nearest to it.
    fn leaf_at(&self, polygon: u32, point: DVec3) -> u32 {
        let mut element = polygon;
        while !self.mesh.elements()[element as usize].is_leaf() {
            let parts = self.mesh.elements()[element as usize].part_numbers();
            let inside = |part: &u32| self.inside(*part, point);
            let nearest = parts.max_by(|p, q| inside(p).total_cmp(&inside(q)));
            let Some(part) = nearest else { break };
            element = part;
        }
        element
    }

    /// How far a place is inside an element, negative outside.
    fn inside(&self, element: u32, point: DVec3) -> f64 {
        let normal = self.mesh.normal(element);
        let shape = self.mesh.shape(element);
        let corners = shape.corners();
        let next = corners.iter().cycle().skip(1);
        let beside = |(a, b): (&DVec3, &DVec3)| {
            let edge = *b - *a;
            edge.cross(point - *a).dot(normal) / edge.length()
        };
        corners.iter().zip(next).map(beside).fold(f64::INFINITY, f64::min)
    }

    fn polygon_at(&self, point: DVec3, wanted: &Wanted) -> Option<u32> {
        let reach = REACH * self.size;
        let found = self.needle(point, reach, wanted).or_else(|| self.needle(point, 8.0 * reach, wanted));
        found.or_else(|| self.aside(point, reach, wanted)).or_else(|| self.nearest(point, wanted))
    }

    /// The polygon nearest to `point` that a needle through it meets.
    fn needle(&self, point: DVec3, reach: f64, wanted: &Wanted) -> Option<u32> {
        let start = point + wanted.normal * reach;
        let ray = Ray32 {
            origin: start.as_vec3(),
            t_min: 0.0,
            direction: -wanted.normal.as_vec3(),
            t_max: 2.0 * reach as f32,
        };
        let mut best: Option<(f32, u32)> = None;
        self.triangles.all_hits(&ray, |hit| {
            let polygon = self.polygon_of[hit.triangle as usize];
            let Some(penalty) = self.penalty(polygon, wanted) else { return };
            let key = ((hit.t - reach as f32).abs() + penalty * reach as f32, polygon);
            if best.is_none_or(|best| key < best) {
                best = Some(key);
            }
        });
        best.map(|(_, polygon)| polygon)
    }

    /// 0 for a polygon that is wanted, 1 for one of another material, `None` for another instance or side.
    fn penalty(&self, polygon: u32, wanted: &Wanted) -> Option<f32> {
        let surface = self.mesh.surface(polygon);
        let fits = surface.instance == wanted.instance && self.mesh.normal(polygon).dot(wanted.normal) > 0.0;
        fits.then_some(if surface.material == wanted.material { 0.0 } else { 1.0 })
    }

    fn aside(&self, point: DVec3, reach: f64, wanted: &Wanted) -> Option<u32> {
        let (s, t) = wanted.normal.any_orthonormal_pair();
        let ways = [s, -s, t, -t, s + t, s - t, t - s, -s - t];
        let mut places = ASIDE.iter().flat_map(|far| ways.map(|way| point + way * (far * self.size)));
        places.find_map(|place| self.needle(place, reach, wanted))
    }

    /// The polygon whose centroid is nearest, for places that all needles miss.
    fn nearest(&self, point: DVec3, wanted: &Wanted) -> Option<u32> {
        let polygons = self.polygons_of_instance.get(&wanted.instance)?;
        let fitting = polygons.iter().filter(|&&polygon| self.penalty(polygon, wanted).is_some());
        let distance = |polygon: &u32| {
            let element = &self.mesh.elements()[*polygon as usize];
            element.center.distance_squared(point) - element.area
        };
        fitting.copied().min_by(|p, q| distance(p).total_cmp(&distance(q)))
    }
}
