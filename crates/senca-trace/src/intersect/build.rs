//! From the shapes of a scene to surfaces that rays can meet.

use senca_math::glam::DVec3;
use senca_scene::{Csg, CsgNode, Shape, ShapeError};

use super::{
    CsgBody, CsgBuilder, CsgError, Cuboid, Disc, Ellipsoid, Frustum, Implicit, Operation, PatchSurface,
    PlaneSurface, Polygon, Prism, Revolution, Sphere, Torus,
};
use crate::Intersect;

/// What builds the surfaces of meshes.
pub type Elsewhere<'a, 's> = dyn FnMut(&'s Shape) -> Result<Box<dyn Intersect + 's>, ShapeError> + 'a;

/// The surface of any shape but meshes, for which `elsewhere` is asked.
///
/// # Errors
/// [`ShapeError`] when a parameter is out of range, in the same words as by tessellation, and whatever
/// `elsewhere` refuses.
pub fn surface_of<'s>(
    shape: &'s Shape,
    elsewhere: &mut Elsewhere<'_, 's>,
) -> Result<Box<dyn Intersect + 's>, ShapeError> {
    Ok(match shape {
        Shape::Mesh(_) => elsewhere(shape)?,
        Shape::BezierPatches { patches } => Box::new(PatchSurface::from_bezier(patches)?),
        Shape::Nurbs(nurbs) => Box::new(PatchSurface::from_nurbs(nurbs)?),
        Shape::Csg(csg) => Box::new(csg_body(csg, elsewhere)?),
        Shape::Implicit(surface) => {
            Box::new(Implicit::new(surface.expression.clone(), surface.bounds, surface.capped)?)
        }
        Shape::Sphere { radius } => Box::new(Sphere::new(positive("sphere", "radius", *radius)?)),
        Shape::Ellipsoid { radii } => {
            Box::new(Ellipsoid::new(all_positive("ellipsoid", "half axis", *radii)?))
        }
        Shape::Box { size } => Box::new(Cuboid::new(all_positive("box", "edge length", *size)?)),
        Shape::Cylinder { radius, height, capped } => {
            positive("cylinder", "radius", *radius)?;
            Box::new(Frustum::new(*radius, *radius, positive("cylinder", "height", *height)?, *capped))
        }
        Shape::Cone { radius, top_radius, height, capped } => {
            not_negative("cone", "radius", *radius)?;
            not_negative("cone", "top_radius", *top_radius)?;
            positive("cone", "the larger radius", radius.max(*top_radius))?;
            Box::new(Frustum::new(*radius, *top_radius, positive("cone", "height", *height)?, *capped))
        }
        Shape::Torus { major_radius, minor_radius } => Box::new(Torus::new(
            positive("torus", "major_radius", *major_radius)?,
            positive("torus", "minor_radius", *minor_radius)?,
        )),
        Shape::Disc { radius, inner_radius } => disc(*radius, *inner_radius)?,
        Shape::Plane { size } => {
            positive("plane", "size", size.unwrap_or(1.0))?;
            Box::new(PlaneSurface::new(*size))
        }
        Shape::Polygon { outline, holes } => polygon(outline, holes)?,
        Shape::Prism { base, height, capped } => {
            positive("prism", "height", *height)?;
            if base.len() < 3 || !base.iter().all(|p| p.is_finite()) {
                return malformed("prism", "the base needs at least three finite corners");
            }
            let Some(prism) = Prism::new(base, *height, *capped) else {
                return malformed("prism", "the base has no area");
            };
            Box::new(prism)
        }
        Shape::Revolution { profile, bezier, angle, capped } => {
            Box::new(Revolution::new(profile, *bezier, *angle, *capped)?)
        }
    })
}

/// The body of a tree of bodies; its surface numbers are those of the leaves, from left to right.
fn csg_body<'s>(csg: &'s Csg, elsewhere: &mut Elsewhere<'_, 's>) -> Result<CsgBody<'s>, ShapeError> {
    csg.check()?;
    let mut builder = CsgBuilder::new();
    add_node(&mut builder, &csg.root, elsewhere)?;
    builder.finish().map_err(|error| csg_error(&error))
}

/// Adds a part of a tree; [`Csg::check`] has seen to it that the tree is not deep.
fn add_node<'s>(
    builder: &mut CsgBuilder<'s>,
    node: &'s CsgNode,
    elsewhere: &mut Elsewhere<'_, 's>,
) -> Result<(), ShapeError> {
    let (operation, bodies) = match node {
        CsgNode::Union(bodies) => (Operation::Union, bodies),
        CsgNode::Intersection(bodies) => (Operation::Intersection, bodies),
        CsgNode::Difference(bodies) => (Operation::Difference, bodies),
        CsgNode::Leaf(leaf) => {
            let surface = surface_of(&leaf.shape, elsewhere)?;
            let object_from_leaf = leaf.transform.matrix();
            let added = match *leaf.shape {
                Shape::Plane { size: None } => builder.half_space(surface, object_from_leaf),
                _ => builder.leaf(surface, object_from_leaf),
            };
            return added.map_err(|error| csg_error(&error));
        }
    };
    builder.open(operation).map_err(|error| csg_error(&error))?;
    bodies.iter().try_for_each(|body| add_node(builder, body, elsewhere))?;
    builder.close().map_err(|error| csg_error(&error))
}

fn csg_error(error: &CsgError) -> ShapeError {
    ShapeError::Malformed { shape: "csg", reason: error.to_string() }
}

fn disc(radius: f64, inner: f64) -> Result<Box<dyn Intersect>, ShapeError> {
    positive("disc", "radius", radius)?;
    not_negative("disc", "inner_radius", inner)?;
    if inner >= radius {
        let (parameter, expected) = ("inner_radius", "below the outer radius");
        return Err(ShapeError::Parameter { shape: "disc", parameter, value: inner, expected });
    }
    Ok(Box::new(Disc::new(radius, inner)))
}

fn polygon(outline: &[DVec3], holes: &[Vec<DVec3>]) -> Result<Box<dyn Intersect>, ShapeError> {
    if !outline.iter().chain(holes.iter().flatten()).all(|p| p.is_finite()) {
        return malformed("polygon", "every corner must be finite");
    }
    if outline.len() < 3 || holes.iter().any(|hole| hole.len() < 3) {
        return malformed("polygon", "an outline and a hole have at least three corners each");
    }
    match Polygon::new(outline, holes) {
        Some(polygon) => Ok(Box::new(polygon)),
        None => malformed("polygon", "the corners lie on one line"),
    }
}

pub(super) fn malformed<T>(shape: &'static str, reason: &str) -> Result<T, ShapeError> {
    Err(ShapeError::Malformed { shape, reason: reason.to_owned() })
}

/// `value` when it is finite and above 0.
pub(super) fn positive(shape: &'static str, parameter: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(ShapeError::Parameter { shape, parameter, value, expected: "above 0 and finite" })
}

fn all_positive(shape: &'static str, parameter: &'static str, values: DVec3) -> Result<DVec3, ShapeError> {
    values.to_array().iter().try_for_each(|&value| positive(shape, parameter, value).map(|_| ()))?;
    Ok(values)
}

/// `value` when it is finite and not below 0.
fn not_negative(shape: &'static str, parameter: &'static str, value: f64) -> Result<f64, ShapeError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(ShapeError::Parameter { shape, parameter, value, expected: "0 or more and finite" })
}
