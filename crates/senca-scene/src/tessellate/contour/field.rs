//! Bodies as functions: negative inside, positive outside, zero on the surface.
//!
//! A leaf is the intersection of smooth parts, so that its edges are known as places where two parts
//! are zero. What has no formula is a [`MeshSolid`].

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_math::{Aabb, Expression, Interval};

use super::mesh_solid::MeshSolid;
use crate::tessellate::{ShapeError, not_negative, positive};
use crate::{Csg, CsgNode, ImplicitSurface, MaterialId, Shape};

/// Value of a mesh's inside; outside it is the negative. Small, so that any other body whose surface
/// is not here decides over it.
const MESH_INSIDE: f64 = -1e-100;

/// Part of a leaf that gave a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Tag {
    pub(super) leaf: u32,
    pub(super) part: u32,
    /// Whether the leaf is taken away, so that its inside is the outside.
    pub(super) inverted: bool,
}

/// A smooth function whose zero is a part of a leaf's surface.
pub(super) enum Part {
    /// `normal . p - offset`, the normal of unit length.
    HalfSpace { normal: DVec3, offset: f64 },
    /// A formula.
    Formula(Expression),
}

impl Part {
    fn value(&self, p: DVec3) -> f64 {
        match self {
            Self::HalfSpace { normal, offset } => normal.dot(p) - offset,
            Self::Formula(f) => f.value(p),
        }
    }

    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        match self {
            Self::HalfSpace { normal, .. } => (self.value(p), *normal),
            Self::Formula(f) => f.value_and_gradient(p),
        }
    }

    fn interval(&self, bounds: &Aabb) -> Interval {
        match self {
            Self::HalfSpace { normal, offset } => {
                let sum =
                    (0..3).map(|i| Interval::new(bounds.min[i], bounds.max[i]) * Interval::point(normal[i]));
                sum.fold(-Interval::point(*offset), |sum, term| sum + term)
            }
            Self::Formula(f) => f.interval_over(bounds),
        }
    }
}

/// The form of a leaf in its own space.
pub(super) enum Solid {
    /// The intersection of smooth parts.
    Parts(Vec<Part>),
    /// A closed mesh.
    Mesh(MeshSolid),
}

/// A leaf with its place.
pub(super) struct Leaf {
    pub(super) solid: Solid,
    pub(super) material: Option<MaterialId>,
    pub(super) name: String,
    leaf_from_object: DMat4,
    gradient_from_leaf: DMat3,
}

/// How leaves are combined; the indices are those of leaves.
enum Tree {
    Leaf(u32),
    Union(Vec<Tree>),
    Intersection(Vec<Tree>),
    Difference(Vec<Tree>),
}

/// A whole body.
pub(super) struct Body {
    pub(super) leaves: Vec<Leaf>,
    tree: Tree,
}

impl Leaf {
    fn new(solid: Solid, name: &str, material: Option<MaterialId>, object_from_leaf: DMat4) -> Self {
        let leaf_from_object = object_from_leaf.inverse();
        let gradient_from_leaf = DMat3::from_mat4(leaf_from_object).transpose();
        Self { solid, material, name: name.to_owned(), leaf_from_object, gradient_from_leaf }
    }

    /// Value, and the part that gives it. What is not defined is outside.
    fn value(&self, point: DVec3) -> (f64, u32) {
        let p = self.leaf_from_object.transform_point3(point);
        match &self.solid {
            Solid::Mesh(mesh) => (if mesh.contains(p) { MESH_INSIDE } else { -MESH_INSIDE }, 0),
            Solid::Parts(parts) => {
                let mut most = (f64::NEG_INFINITY, 0);
                for (i, part) in parts.iter().enumerate() {
                    let value = part.value(p);
                    if value > most.0 || value.is_nan() {
                        most = (if value.is_nan() { f64::INFINITY } else { value }, i as u32);
                    }
                }
                most
            }
        }
    }

    /// Whether all of a box is inside or outside; `None` where both may be.
    fn classify(&self, bounds: &Aabb) -> Option<bool> {
        let bounds = bounds.transformed(&self.leaf_from_object);
        let slack = 1e-12 * (bounds.min.abs().max_element() + bounds.max.abs().max_element());
        let bounds = Aabb { min: bounds.min - slack, max: bounds.max + slack };
        match &self.solid {
            Solid::Mesh(mesh) => mesh.classify(&bounds),
            Solid::Parts(parts) => {
                let values: Vec<Interval> = parts.iter().map(|part| part.interval(&bounds)).collect();
                // The empty interval says that the formula is defined nowhere in the box.
                if values.iter().any(|v| v.is_empty() || v.min > 0.0) {
                    return Some(false);
                }
                values.iter().all(|v| v.max < 0.0).then_some(true)
            }
        }
    }

    /// Distance from the surface of a part, to first order, and the outward unit normal there, both in
    /// object space. `None` where the part has no gradient, and for meshes.
    pub(super) fn distance(&self, part: u32, point: DVec3) -> Option<(f64, DVec3)> {
        let Solid::Parts(parts) = &self.solid else { return None };
        let p = self.leaf_from_object.transform_point3(point);
        let (value, gradient) = parts.get(part as usize)?.value_and_gradient(p);
        let gradient = self.gradient_from_leaf * gradient;
        let length = gradient.length();
        let usable = length > 1e-200 && length.is_finite() && value.is_finite();
        usable.then(|| (value / length, gradient / length))
    }

    /// Outward unit normal of a mesh near `point`; of several surfaces one that faces about as
    /// `towards` does.
    pub(super) fn mesh_normal(&self, point: DVec3, towards: DVec3) -> Option<DVec3> {
        let Solid::Mesh(mesh) = &self.solid else { return None };
        let p = self.leaf_from_object.transform_point3(point);
        let leaf_towards = self.gradient_from_leaf.inverse() * towards;
        let normal = mesh.normal(p, leaf_towards)?;
        (self.gradient_from_leaf * normal).try_normalize()
    }
}

impl Body {
    /// The body of a tree that [`Csg::check`] accepts.
    pub(super) fn of_csg(csg: &Csg) -> Result<Self, ShapeError> {
        let mut leaves = Vec::new();
        for leaf in csg.leaves() {
            let solid = solid_of(&leaf.shape)?;
            leaves.push(Leaf::new(solid, &leaf.name, leaf.material, leaf.transform.matrix()));
        }
        Ok(Self { leaves, tree: tree_of(&csg.root, &mut 0) })
    }

    /// The body f < 0 within its box.
    pub(super) fn of_implicit(surface: &ImplicitSurface) -> Result<Self, ShapeError> {
        let solid = implicit_solid(surface)?;
        Ok(Self { leaves: vec![Leaf::new(solid, "", None, DMat4::IDENTITY)], tree: Tree::Leaf(0) })
    }

    /// Value at a point and what gives it.
    pub(super) fn value(&self, point: DVec3) -> (f64, Tag) {
        self.tree.value(self, point)
    }

    /// Whether all of a box is inside or outside; `None` where both may be.
    pub(super) fn classify(&self, bounds: &Aabb) -> Option<bool> {
        self.tree.classify(self, bounds)
    }
}

impl Tree {
    fn value(&self, body: &Body, p: DVec3) -> (f64, Tag) {
        let least = |a: (f64, Tag), b: (f64, Tag)| if b.0 < a.0 { b } else { a };
        let most = |a: (f64, Tag), b: (f64, Tag)| if b.0 > a.0 { b } else { a };
        let nothing = Tag { leaf: 0, part: 0, inverted: false };
        match self {
            Self::Leaf(leaf) => {
                let (value, part) = body.leaves[*leaf as usize].value(p);
                (value, Tag { leaf: *leaf, part, inverted: false })
            }
            Self::Union(trees) => {
                trees.iter().map(|t| t.value(body, p)).fold((f64::INFINITY, nothing), least)
            }
            Self::Intersection(trees) => {
                trees.iter().map(|t| t.value(body, p)).fold((f64::NEG_INFINITY, nothing), most)
            }
            Self::Difference(trees) => {
                let signed = trees.iter().enumerate().map(|(i, t)| {
                    let (value, tag) = t.value(body, p);
                    if i == 0 { (value, tag) } else { (-value, Tag { inverted: !tag.inverted, ..tag }) }
                });
                signed.fold((f64::NEG_INFINITY, nothing), most)
            }
        }
    }

    fn classify(&self, body: &Body, bounds: &Aabb) -> Option<bool> {
        let (trees, decides) = match self {
            Self::Leaf(leaf) => return body.leaves[*leaf as usize].classify(bounds),
            Self::Union(trees) => (trees, true),
            Self::Intersection(trees) | Self::Difference(trees) => (trees, false),
        };
        let difference = matches!(self, Self::Difference(_));
        let mut open = false;
        for (i, tree) in trees.iter().enumerate() {
            let inside = tree.classify(body, bounds).map(|inside| inside != (difference && i > 0));
            match inside {
                Some(inside) if inside == decides => return Some(decides),
                Some(_) => {}
                None => open = true,
            }
        }
        (!open).then_some(!decides)
    }
}

fn tree_of(node: &CsgNode, next: &mut u32) -> Tree {
    let mut all = |nodes: &[CsgNode]| nodes.iter().map(|node| tree_of(node, next)).collect();
    match node {
        CsgNode::Union(nodes) => Tree::Union(all(nodes)),
        CsgNode::Intersection(nodes) => Tree::Intersection(all(nodes)),
        CsgNode::Difference(nodes) => Tree::Difference(all(nodes)),
        CsgNode::Leaf(_) => {
            *next += 1;
            Tree::Leaf(*next - 1)
        }
    }
}

fn half_space(normal: DVec3, offset: f64) -> Part {
    Part::HalfSpace { normal, offset }
}

/// The six sides of a box.
fn sides(bounds: &Aabb) -> Vec<Part> {
    let side = |axis: usize| {
        let normal = DVec3::AXES[axis];
        [half_space(normal, bounds.max[axis]), half_space(-normal, -bounds.min[axis])]
    };
    (0..3).flat_map(side).collect()
}

fn implicit_solid(surface: &ImplicitSurface) -> Result<Solid, ShapeError> {
    let Aabb { min, max } = surface.bounds;
    if !(min.is_finite() && max.is_finite() && min.cmplt(max).all()) {
        let reason = "its box needs finite corners, the first below the second".to_owned();
        return Err(ShapeError::Malformed { shape: "implicit", reason });
    }
    let mut parts = vec![Part::Formula(surface.expression.clone())];
    parts.extend(sides(&surface.bounds));
    Ok(Solid::Parts(parts))
}

/// The form of a leaf's shape.
fn solid_of(shape: &Shape) -> Result<Solid, ShapeError> {
    Ok(match shape {
        Shape::Sphere { radius } => {
            positive("sphere", "radius", *radius)?;
            formula(format!("x^2 + y^2 + z^2 - ({radius:e})^2"), Vec::new())?
        }
        Shape::Ellipsoid { radii } => {
            radii.to_array().iter().try_for_each(|&r| positive("ellipsoid", "half axis", r))?;
            let [a, b, c] = radii.to_array();
            formula(format!("(x/{a:e})^2 + (y/{b:e})^2 + (z/{c:e})^2 - 1"), Vec::new())?
        }
        Shape::Box { size } => {
            size.to_array().iter().try_for_each(|&s| positive("box", "edge length", s))?;
            Solid::Parts(sides(&Aabb { min: -0.5 * *size, max: 0.5 * *size }))
        }
        Shape::Cylinder { radius, height, .. } => {
            positive("cylinder", "radius", *radius)?;
            positive("cylinder", "height", *height)?;
            formula(format!("x^2 + z^2 - ({radius:e})^2"), ends(*height))?
        }
        Shape::Cone { radius, top_radius, height, .. } => {
            not_negative("cone", "radius", *radius)?;
            not_negative("cone", "top_radius", *top_radius)?;
            positive("cone", "the larger radius", radius.max(*top_radius))?;
            positive("cone", "height", *height)?;
            let slope = (top_radius - radius) / height;
            formula(format!("sqrt(x^2 + z^2) - ({radius:e}) - ({slope:e}) * y"), ends(*height))?
        }
        Shape::Torus { major_radius, minor_radius } => {
            positive("torus", "major_radius", *major_radius)?;
            positive("torus", "minor_radius", *minor_radius)?;
            let text = format!("(sqrt(x^2 + z^2) - {major_radius:e})^2 + y^2 - ({minor_radius:e})^2");
            formula(text, Vec::new())?
        }
        Shape::Plane { .. } => Solid::Parts(vec![half_space(DVec3::Y, 0.0)]),
        Shape::Implicit(surface) => implicit_solid(surface)?,
        other => Solid::Mesh(MeshSolid::of_shape(other)?),
    })
}

/// Bottom and top of a body that stands on y = 0.
fn ends(height: f64) -> Vec<Part> {
    vec![half_space(DVec3::NEG_Y, 0.0), half_space(DVec3::Y, height)]
}

fn formula(text: String, mut more: Vec<Part>) -> Result<Solid, ShapeError> {
    let malformed =
        |e: senca_math::ExpressionError| ShapeError::Malformed { shape: "csg", reason: e.to_string() };
    more.insert(0, Part::Formula(Expression::parse(&text).map_err(malformed)?));
    Ok(Solid::Parts(more))
}
