//! Discs, planes and polygons.

use senca_math::glam::{DVec2, DVec3};
use senca_math::{Aabb, newell_normal};

use super::analytic::{Analytic, Chart, disc_chart};
use super::region::Region;
use super::{FlatTriangle, Form};
use crate::textbook::{dropped_coordinate, reduced};
use crate::{Crossing, Ray, SurfacePoint};

/// The parameter at which a line meets the plane y = 0; `None` when it is parallel to it.
#[inline]
fn level(ray: &Ray) -> Option<f64> {
    (ray.direction.y != 0.0).then(|| -ray.origin.y / ray.direction.y)
}

/// The point of the line in the plane y = 0.
#[inline]
fn on_level(ray: &Ray, t: f64) -> DVec3 {
    DVec3 { y: 0.0, ..ray.at(t) }
}

/// A disc or ring in the plane y = 0 that faces +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    radius: f64,
    inner: f64,
}

impl Disc {
    /// A disc of `radius` > 0 with a hole of radius `inner`, >= 0 and below `radius`.
    #[must_use]
    pub fn new(radius: f64, inner: f64) -> Self {
        Self { radius, inner }
    }
}

impl Analytic for Disc {
    fn bounds(&self) -> Aabb {
        let reach = DVec3::new(self.radius, 0.0, self.radius);
        Aabb { min: -reach, max: reach }
    }

    /// The outer border belongs to the disc, that of a hole too.
    #[inline]
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let Some(t) = level(ray) else { return };
        let place = ray.at(t);
        let squared = place.x * place.x + place.z * place.z;
        if squared <= self.radius * self.radius && squared >= self.inner * self.inner {
            meet(t, 0, DVec2::ZERO);
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let point = on_level(ray, crossing.t);
        disc_chart(point, self.radius, false).at(point, DVec3::Y, 0)
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn form(&self) -> Form {
        Form::Disc { radius: self.radius, inner: self.inner }
    }
}

/// The plane y = 0, endless or a square around the origin, facing +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneSurface {
    size: Option<f64>,
}

impl PlaneSurface {
    /// A square with edges of length `size` > 0, or the endless plane.
    #[must_use]
    pub fn new(size: Option<f64>) -> Self {
        Self { size }
    }
}

impl Analytic for PlaneSurface {
    fn bounds(&self) -> Aabb {
        let half = 0.5 * self.size.unwrap_or(f64::INFINITY);
        Aabb { min: DVec3::new(-half, 0.0, -half), max: DVec3::new(half, 0.0, half) }
    }

    #[inline]
    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let Some(t) = level(ray) else { return };
        let place = ray.at(t);
        let half = 0.5 * self.size.unwrap_or(f64::INFINITY);
        if place.x.abs() <= half && place.z.abs() <= half {
            meet(t, 0, DVec2::ZERO);
        }
    }

    /// A square shows its picture once, the endless plane once per unit of length.
    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let point = on_level(ray, crossing.t);
        let (edge, middle) = (self.size.unwrap_or(1.0), if self.size.is_some() { 0.5 } else { 0.0 });
        let uv = DVec2::new(point.x, point.z) / edge + middle;
        Chart { uv, along_u: DVec3::X * edge, along_v: DVec3::Z * edge }.at(point, DVec3::Y, 0)
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn form(&self) -> Form {
        Form::Plane { size: self.size }
    }
}

/// A flat polygon, convex or not, with holes.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Unit normal, and its product with the plane's points.
    normal: DVec3,
    distance: f64,
    /// Coordinate left out in `region`.
    dropped: usize,
    region: Region,
    bounds: Aabb,
    /// Where texture coordinates are (0, 1), and the edges of the picture to the right and up.
    corner: DVec3,
    right: DVec3,
    up: DVec3,
    /// Three corners, where the fourth makes a parallelogram of them.
    parallelogram: Option<[DVec3; 3]>,
}

impl Polygon {
    /// A polygon of one outline, counter-clockwise seen from its front, and holes inside of it, apart
    /// from each other; all in one plane, corners finite. `None` when the outline has no area.
    #[must_use]
    pub fn new(outline: &[DVec3], holes: &[Vec<DVec3>]) -> Option<Self> {
        let sum = newell_normal(outline);
        let origin = *outline.first()?;
        let size = outline.iter().map(|p| p.distance_squared(origin)).fold(0.0, f64::max);
        let normal = if sum.length() > 1e-12 * size { sum.try_normalize()? } else { return None };
        let dropped = dropped_coordinate(normal);
        let rings = std::iter::once(outline).chain(holes.iter().map(Vec::as_slice));
        let rings: Vec<Vec<DVec2>> =
            rings.map(|ring| ring.iter().map(|p| reduced(*p, dropped)).collect()).collect();
        // The picture is laid over the bounding rectangle, upright where the plane is.
        let (x_axis, y_axis) = axes_in_plane(normal);
        let flat = |p: &DVec3| DVec2::new((*p - origin).dot(x_axis), (*p - origin).dot(y_axis));
        let low = outline.iter().map(flat).fold(DVec2::INFINITY, DVec2::min);
        let high = outline.iter().map(flat).fold(DVec2::NEG_INFINITY, DVec2::max);
        Some(Self {
            normal,
            distance: normal.dot(origin),
            dropped,
            region: Region::new(&rings),
            bounds: Aabb::of_points(outline.iter().copied()),
            corner: origin + low.x * x_axis + low.y * y_axis,
            right: x_axis * (high.x - low.x),
            up: y_axis * (high.y - low.y),
            parallelogram: match outline {
                [a, b, c, d] if holes.is_empty() && *a + *c == *b + *d => Some([*a, *b, *d]),
                _ => None,
            },
        })
    }

    /// Coordinates of the picture at a place of the plane.
    fn uv(&self, point: DVec3) -> DVec2 {
        let share = |edge: DVec3| (point - self.corner).dot(edge) / edge.length_squared();
        DVec2::new(share(self.right), 1.0 - share(self.up))
    }
}

/// Two unit vectors that make a right-handed frame with `normal`; the first is horizontal where there
/// is a choice, so pictures on walls stand upright.
fn axes_in_plane(normal: DVec3) -> (DVec3, DVec3) {
    let x_axis = DVec3::Y.cross(normal);
    let x_axis = if x_axis.length() > 1e-6 { x_axis.normalize() } else { DVec3::X };
    (x_axis, normal.cross(x_axis).normalize_or(DVec3::Y))
}

impl Analytic for Polygon {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn each_crossing(&self, ray: &Ray, meet: &mut impl FnMut(f64, u32, DVec2)) {
        let t = (self.distance - self.normal.dot(ray.origin)) / self.normal.dot(ray.direction);
        if ray.admits(t) && self.region.contains(reduced(ray.at(t), self.dropped)) {
            meet(t, 0, DVec2::ZERO);
        }
    }

    fn surface_point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let near = ray.at(crossing.t);
        let point = near - self.normal * (self.normal.dot(near) - self.distance);
        let uv = self.uv(point);
        Chart { uv, along_u: self.right, along_v: -self.up }.at(point, self.normal, 0)
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn form(&self) -> Form {
        let square = |corners: [DVec3; 3]| FlatTriangle {
            corners,
            texcoords: corners.map(|corner| self.uv(corner)),
            surface: 0,
        };
        self.parallelogram.map_or(Form::Other, |corners| Form::Parallelogram(square(corners)))
    }
}
