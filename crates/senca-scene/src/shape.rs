//! Shapes that a geometry can have.
//!
//! Round shapes are centred on the origin; those with an axis have it along +y and stand on the
//! plane y = 0. Size and place come from the node's transform on top.

use senca_math::glam::{DVec2, DVec3};
use senca_math::{Aabb, Expression};

use crate::{Csg, Mesh};

/// The form of a geometry, in object space, lengths in world units.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A polygon mesh.
    Mesh(Mesh),
    /// All points at distance `radius` of the origin.
    Sphere {
        /// Radius, > 0.
        radius: f64,
    },
    /// A sphere scaled per axis.
    Ellipsoid {
        /// Half axes along x, y and z, each > 0.
        radii: DVec3,
    },
    /// A cuboid centred on the origin.
    Box {
        /// Edge lengths along x, y and z, each > 0.
        size: DVec3,
    },
    /// A right circular cylinder from y = 0 to y = `height`.
    Cylinder {
        /// Radius, > 0.
        radius: f64,
        /// Height, > 0.
        height: f64,
        /// Whether both ends are closed by discs.
        capped: bool,
    },
    /// A right circular cone or frustum from y = 0 to y = `height`.
    Cone {
        /// Radius at y = 0, >= 0.
        radius: f64,
        /// Radius at y = `height`, >= 0; 0 makes a tip there. Not both radii are 0.
        top_radius: f64,
        /// Height, > 0.
        height: f64,
        /// Whether ends with a radius above 0 are closed by discs.
        capped: bool,
    },
    /// A ring around the y axis.
    Torus {
        /// Distance of the tube's centre from the axis, > 0.
        major_radius: f64,
        /// Radius of the tube, > 0.
        minor_radius: f64,
    },
    /// A flat disc or ring in the plane y = 0 that faces +y.
    Disc {
        /// Outer radius, > 0.
        radius: f64,
        /// Radius of the hole, >= 0 and < `radius`.
        inner_radius: f64,
    },
    /// The plane y = 0, facing +y.
    Plane {
        /// Edge length of the square that is drawn, centred on the origin; `None` is endless (a
        /// renderer that needs an end cuts it far outside the rest of the scene).
        size: Option<f64>,
    },
    /// A flat polygon, convex or not, counter-clockwise seen from its front.
    Polygon {
        /// Corners of the outline, at least three, in one plane.
        outline: Vec<DVec3>,
        /// Corners of each hole.
        holes: Vec<Vec<DVec3>>,
    },
    /// A flat outline in the plane y = 0, drawn up to y = `height`.
    Prism {
        /// Corners `(x, z)` of the base, convex or not, in either order.
        base: Vec<DVec2>,
        /// Height, > 0.
        height: f64,
        /// Whether bottom and top are closed.
        capped: bool,
    },
    /// A profile turned around the y axis.
    Revolution {
        /// Points `(radius, y)` of the profile, radius >= 0, from bottom to top for an outside that
        /// faces away from the axis.
        profile: Vec<DVec2>,
        /// Whether the profile's points are control points of chained cubic Bézier pieces (3 n + 1
        /// points) instead of the corners of a polyline.
        bezier: bool,
        /// Angle swept, in radians, in (0, 2 pi].
        angle: f64,
        /// Whether the ends of less than a full turn are closed by flat sides, so that it bounds a body.
        /// Only where the profile encloses an area, alone or with the axis: its last point is the
        /// first, or both are on the axis. Of other profiles the ends stay open.
        capped: bool,
    },
    /// Bicubic Bézier patches.
    BezierPatches {
        /// The patches, each with the surface it belongs to; patches of one surface are smooth
        /// across common edges.
        patches: Vec<BezierPatch>,
    },
    /// A trimmed-free NURBS surface.
    Nurbs(NurbsSurface),
    /// The surface f(x, y, z) = 0.
    Implicit(ImplicitSurface),
    /// A body put together from closed bodies.
    Csg(Csg),
}

/// The surface f(x, y, z) = 0 within a box; the inside is where f < 0.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplicitSurface {
    /// The formula of f.
    pub expression: Expression,
    /// The box, in object space, in which the surface is looked for; what lies outside is not there.
    /// Default -1 to 1 along each axis.
    pub bounds: Aabb,
    /// Whether the body f < 0 is closed where the box cuts it, by parts of the box's sides; otherwise
    /// the surface ends there and shows its back. Default true.
    pub capped: bool,
}

impl ImplicitSurface {
    /// The surface in the box from -1 to 1, capped.
    #[must_use]
    pub fn new(expression: Expression) -> Self {
        Self { expression, bounds: Aabb { min: -DVec3::ONE, max: DVec3::ONE }, capped: true }
    }

    /// Whether `point` is in the body: f < 0 and within the box.
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        let Aabb { min, max } = self.bounds;
        point.cmpge(min).all() && point.cmple(max).all() && self.expression.value(point) < 0.0
    }
}

/// A bicubic Bézier patch.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierPatch {
    /// Control points in row order, index `4 * row + column`; u runs along columns, v along rows.
    pub points: [DVec3; 16],
    /// Surface number.
    pub surface: u32,
}

/// A tensor-product NURBS surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    /// Degrees in u and v, each >= 1.
    pub degree: [usize; 2],
    /// Knots in u and v, not decreasing; each has `count + degree + 1` entries.
    pub knots: [Vec<f64>; 2],
    /// Number of control points in u and v.
    pub counts: [usize; 2],
    /// Control points, u fastest.
    pub points: Vec<DVec3>,
    /// Weights, > 0, as many as points; empty stands for 1 throughout.
    pub weights: Vec<f64>,
}
