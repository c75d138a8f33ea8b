//! Bodies put together from bodies: constructive solid geometry.

use senca_math::Aabb;
use senca_math::glam::{DMat4, DVec3};

use crate::half_spaces::{self, HalfSpace};
use crate::{MaterialId, Shape, ShapeError, Topology, Transform};
use crate::{TessellationSettings, Tolerance, tessellate};

/// A body made of other bodies by union, intersection and difference (Requicha 1980).
///
/// The tree is finite and small: [`Csg::check`] holds it against [`Csg::MAX_DEPTH`] and
/// [`Csg::MAX_LEAVES`], and what walks the tree may rely on that.
#[derive(Clone, Debug, PartialEq)]
pub struct Csg {
    /// The whole tree.
    pub root: CsgNode,
}

/// A part of a [`Csg`] tree.
#[derive(Clone, Debug, PartialEq)]
pub enum CsgNode {
    /// What is in any of the bodies; two or more.
    Union(Vec<CsgNode>),
    /// What is in all of the bodies; two or more.
    Intersection(Vec<CsgNode>),
    /// What is in the first body and in none of the others; two or more.
    Difference(Vec<CsgNode>),
    /// One closed body.
    Leaf(CsgLeaf),
}

/// One closed body of a [`Csg`] tree.
#[derive(Clone, Debug, PartialEq)]
pub struct CsgLeaf {
    /// Name for messages, or empty.
    pub name: String,
    /// Its form, not [`Shape::Csg`]. It must enclose a volume; the endless plane stands for all that
    /// lies below it, y < 0.
    pub shape: Box<Shape>,
    /// Its place in the frame of the whole body. It must not flatten the shape.
    pub transform: Transform,
    /// Material of the surface that this body gives to the whole; `None` takes that of the geometry.
    pub material: Option<MaterialId>,
}

impl Csg {
    /// Deepest nesting of operations.
    pub const MAX_DEPTH: usize = 32;

    /// Most leaves of one tree.
    pub const MAX_LEAVES: usize = 4096;

    /// The leaves from left to right, which is how they are numbered in [`Csg::contains`].
    #[must_use]
    pub fn leaves(&self) -> Vec<&CsgLeaf> {
        let (mut open, mut leaves) = (vec![&self.root], Vec::new());
        while let Some(node) = open.pop() {
            match node {
                CsgNode::Leaf(leaf) => leaves.push(leaf),
                CsgNode::Union(nodes) | CsgNode::Intersection(nodes) | CsgNode::Difference(nodes) => {
                    open.extend(nodes.iter().rev());
                }
            }
        }
        leaves
    }

    /// The leaves from left to right, to be changed.
    pub fn leaves_mut(&mut self) -> Vec<&mut CsgLeaf> {
        let (mut open, mut leaves) = (vec![&mut self.root], Vec::new());
        while let Some(node) = open.pop() {
            match node {
                CsgNode::Leaf(leaf) => leaves.push(leaf),
                CsgNode::Union(nodes) | CsgNode::Intersection(nodes) | CsgNode::Difference(nodes) => {
                    open.extend(nodes.iter_mut().rev());
                }
            }
        }
        leaves
    }

    /// Whether a place is in the whole body, `inside` saying for each leaf, by number, whether it is
    /// in that. Not all leaves need be asked. For trees that [`Csg::check`] accepts.
    #[must_use]
    pub fn contains(&self, mut inside: impl FnMut(usize) -> bool) -> bool {
        self.root.contains(&mut 0, true, &mut inside)
    }

    /// Checks that the tree is one that renderers can draw: not too deep or large, two bodies or more
    /// to each operation, places that do not flatten, every leaf a closed body, and the whole not
    /// endless.
    ///
    /// # Errors
    /// [`ShapeError::Malformed`], which names the leaf that is at fault.
    pub fn check(&self) -> Result<(), ShapeError> {
        let malformed = |reason: String| ShapeError::Malformed { shape: "csg", reason };
        self.root.check_form(0).map_err(malformed)?;
        let leaves = self.leaves();
        if leaves.len() > Self::MAX_LEAVES {
            let reason = format!("it has {} leaves, more than {}", leaves.len(), Self::MAX_LEAVES);
            return Err(malformed(reason));
        }
        for (i, leaf) in leaves.iter().enumerate() {
            leaf.check().map_err(|reason| malformed(format!("{}: {reason}", leaf.label(i))))?;
        }
        if !is_finite(&self.bounds_in(&DMat4::IDENTITY)) {
            let reason = "it has no end; intersect its endless planes with something that has";
            return Err(malformed(reason.to_owned()));
        }
        Ok(())
    }

    /// A box around the body after the affine map `world_from_object`. Its sides are infinite where an
    /// endless plane is not bounded by the other bodies.
    #[must_use]
    pub fn bounds_in(&self, world_from_object: &DMat4) -> Aabb {
        self.root.bounds_in(world_from_object)
    }
}

/// Whether a box is empty or has finite sides.
fn is_finite(bounds: &Aabb) -> bool {
    bounds.is_empty() || bounds.min.is_finite() && bounds.max.is_finite()
}

impl CsgNode {
    /// A leaf with an unnamed shape where it stands.
    #[must_use]
    pub fn leaf(shape: Shape, transform: Transform, material: Option<MaterialId>) -> Self {
        Self::Leaf(CsgLeaf { name: String::new(), shape: Box::new(shape), transform, material })
    }

    /// Whether a place is in this part; `next` is the number of its first leaf, and of the first leaf
    /// behind it afterwards. With `ask` false leaves are only counted.
    fn contains(&self, next: &mut usize, ask: bool, inside: &mut impl FnMut(usize) -> bool) -> bool {
        let (nodes, wanted) = match self {
            Self::Leaf(_) => {
                *next += 1;
                return ask && inside(*next - 1);
            }
            Self::Union(nodes) => (nodes, false),
            Self::Intersection(nodes) | Self::Difference(nodes) => (nodes, true),
        };
        let difference = matches!(self, Self::Difference(_));
        let mut result = wanted;
        for (i, node) in nodes.iter().enumerate() {
            // Once one body has decided, the others are passed over.
            let open = ask && result == wanted;
            let found = node.contains(next, open, inside) != (difference && i > 0);
            if open {
                result = found;
            }
        }
        result
    }

    fn check_form(&self, depth: usize) -> Result<(), String> {
        if depth > Csg::MAX_DEPTH {
            return Err(format!("its operations nest deeper than {}", Csg::MAX_DEPTH));
        }
        let (name, nodes) = match self {
            Self::Leaf(_) => return Ok(()),
            Self::Union(nodes) => ("union", nodes),
            Self::Intersection(nodes) => ("intersection", nodes),
            Self::Difference(nodes) => ("difference", nodes),
        };
        if nodes.len() < 2 {
            return Err(format!("a {name} needs two bodies or more, but has {}", nodes.len()));
        }
        nodes.iter().try_for_each(|node| node.check_form(depth + 1))
    }

    fn bounds_in(&self, world_from_object: &DMat4) -> Aabb {
        let of = |node: &Self| node.bounds_in(world_from_object);
        let bounds = match self {
            Self::Leaf(leaf) => return leaf.bounds_in(world_from_object),
            Self::Union(nodes) => return nodes.iter().map(of).fold(Aabb::EMPTY, Aabb::union),
            Self::Intersection(nodes) => nodes.iter().map(of).fold(everything(), intersection),
            Self::Difference(nodes) => nodes.first().map_or(Aabb::EMPTY, of),
        };
        let mut half_spaces = Vec::new();
        self.collect_half_spaces(world_from_object, 1.0, &mut half_spaces);
        half_spaces::cut(bounds, &half_spaces)
    }

    /// Half-spaces that all of this part lies in: those of its planes that are intersected, and the
    /// other sides of those that are taken away.
    fn collect_half_spaces(&self, world_from_object: &DMat4, sign: f64, found: &mut Vec<HalfSpace>) {
        match self {
            Self::Leaf(leaf) if matches!(*leaf.shape, Shape::Plane { size: None }) => {
                let (normal, point) = half_space(&(*world_from_object * leaf.transform.matrix()));
                found.push(HalfSpace { normal: sign * normal, offset: sign * normal.dot(point) });
            }
            Self::Intersection(nodes) if sign > 0.0 => {
                nodes.iter().for_each(|node| node.collect_half_spaces(world_from_object, sign, found));
            }
            Self::Difference(nodes) if sign > 0.0 => {
                for (i, node) in nodes.iter().enumerate() {
                    node.collect_half_spaces(world_from_object, if i == 0 { 1.0 } else { -1.0 }, found);
                }
            }
            _ => {}
        }
    }
}

/// The box of all space.
fn everything() -> Aabb {
    Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }
}

fn intersection(a: Aabb, b: Aabb) -> Aabb {
    let both = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
    if both.is_empty() { Aabb::EMPTY } else { both }
}

impl CsgLeaf {
    /// How messages call the leaf with the number `index`.
    #[must_use]
    pub fn label(&self, index: usize) -> String {
        if self.name.is_empty() {
            format!("body {index}, a {}", self.shape.kind())
        } else {
            format!("body \"{}\", a {}", self.name, self.shape.kind())
        }
    }

    fn check(&self) -> Result<(), String> {
        let matrix = self.transform.matrix();
        if !matrix.is_finite() || matrix.determinant().abs() < 1e-200 {
            return Err("its place flattens it".to_owned());
        }
        self.shape.check_closed()
    }

    /// A box around the leaf; of a half-space the side that it bounds when that is along an axis.
    fn bounds_in(&self, world_from_object: &DMat4) -> Aabb {
        let world_from_leaf = *world_from_object * self.transform.matrix();
        if !matches!(*self.shape, Shape::Plane { size: None }) {
            return self.shape.bounds_in(&world_from_leaf);
        }
        let (normal, point) = half_space(&world_from_leaf);
        let mut bounds = everything();
        for axis in 0..3 {
            if normal[axis] >= 1.0 - 1e-12 {
                bounds.max[axis] = point[axis];
            } else if normal[axis] <= -1.0 + 1e-12 {
                bounds.min[axis] = point[axis];
            }
        }
        bounds
    }
}

/// The outward unit normal and a point of the plane y = 0 after an affine map.
fn half_space(world_from_plane: &DMat4) -> (DVec3, DVec3) {
    let linear = senca_math::glam::DMat3::from_mat4(*world_from_plane);
    let normal = senca_math::normal_matrix(linear) * DVec3::Y;
    (normal.normalize_or(DVec3::Y), world_from_plane.w_axis.truncate())
}

impl Shape {
    /// What kind of shape this is, in the words of a scene file.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Mesh(_) => "mesh",
            Self::Sphere { .. } => "sphere",
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Torus { .. } => "torus",
            Self::Disc { .. } => "disc",
            Self::Plane { .. } => "plane",
            Self::Polygon { .. } => "polygon",
            Self::Prism { .. } => "prism",
            Self::Revolution { .. } => "revolution",
            Self::BezierPatches { .. } => "bezier",
            Self::Nurbs(_) => "nurbs",
            Self::Implicit(_) => "implicit",
            Self::Csg(_) => "csg",
        }
    }

    /// Whether the shape encloses a volume, so that it can be a leaf of a [`Csg`]. The endless plane
    /// does: it bounds what lies below it. Patches and NURBS surfaces are judged by a coarse mesh.
    ///
    /// # Errors
    /// What keeps it from doing so, and how to mend it.
    pub fn check_closed(&self) -> Result<(), String> {
        let wrong = |reason: &str| Err(reason.to_owned());
        match self {
            Self::Sphere { .. } | Self::Ellipsoid { .. } | Self::Box { .. } | Self::Torus { .. } => Ok(()),
            Self::Cylinder { capped: true, .. } | Self::Cone { capped: true, .. } => Ok(()),
            Self::Prism { capped: true, .. } | Self::Plane { size: None } => Ok(()),
            Self::Implicit(surface) if surface.capped => Ok(()),
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Prism { .. } | Self::Implicit(_) => {
                wrong("it is open; only with capped = true it has an inside")
            }
            Self::Plane { .. } => wrong("it is a square without an inside; leave out its size"),
            Self::Disc { .. } | Self::Polygon { .. } => wrong("it is flat and has no inside"),
            Self::Csg(_) => wrong("it is a tree of its own; put its operation in place of the leaf"),
            Self::Mesh(_) | Self::Revolution { .. } | Self::BezierPatches { .. } | Self::Nurbs(_) => {
                self.check_closed_mesh()
            }
        }
    }

    /// [`Shape::check_closed`] for what is judged by its mesh.
    fn check_closed_mesh(&self) -> Result<(), String> {
        let settings = TessellationSettings { tolerance: Tolerance::Steps(8, 4), ..Default::default() };
        let mesh = tessellate(self, &settings).map_err(|error| error.to_string())?;
        let topology = Topology::new(&mesh);
        let counts = topology.edge_counts();
        if counts.crowded > 0 {
            return Err(format!("{} of its edges have more than two faces", counts.crowded));
        }
        if !topology.is_closed() {
            return Err(format!("it is open: {} of its edges have one face only", counts.border));
        }
        if !topology.is_oriented() {
            return Err("its faces do not agree which side is outside".to_owned());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::Expression;

    fn ball(x: f64) -> CsgNode {
        let place = Transform::Matrix(DMat4::from_translation(DVec3::X * x));
        CsgNode::leaf(Shape::Sphere { radius: 1.0 }, place, None)
    }

    fn of(shape: Shape) -> Result<(), String> {
        let root = CsgNode::Union(vec![ball(0.0), CsgNode::leaf(shape, Transform::default(), None)]);
        Csg { root }.check().map_err(|error| error.to_string())
    }

    #[test]
    fn membership_follows_the_operations() {
        let root = CsgNode::Difference(vec![
            CsgNode::Union(vec![ball(0.0), ball(1.0)]),
            CsgNode::Intersection(vec![ball(2.0), ball(3.0)]),
            ball(4.0),
        ]);
        let csg = Csg { root };
        assert_eq!(csg.leaves().len(), 5);
        for bits in 0u32..32 {
            let inside = |i: usize| bits >> i & 1 == 1;
            let expected = (inside(0) || inside(1)) && !(inside(2) && inside(3)) && !inside(4);
            assert_eq!(csg.contains(inside), expected, "{bits:05b}");
        }
    }

    #[test]
    fn open_leaves_are_named() {
        assert_eq!(of(Shape::Box { size: DVec3::ONE }), Ok(()));
        let open = of(Shape::Cylinder { radius: 1.0, height: 1.0, capped: false });
        let message = "csg: body 1, a cylinder: it is open; only with capped = true it has an inside";
        assert_eq!(open, Err(message.to_owned()));
        assert!(of(Shape::Plane { size: Some(1.0) }).is_err_and(|m| m.contains("leave out its size")));
        assert!(of(Shape::Plane { size: None }).is_err_and(|m| m.contains("no end")));
        assert!(of(Shape::Disc { radius: 1.0, inner_radius: 0.0 }).is_err());
        assert!(of(Shape::Mesh(crate::test_support::octagonal_cylinder())).is_ok());
        let mut open = crate::test_support::octagonal_cylinder();
        open.faces.starts.truncate(open.faces.starts.len() - 1);
        let corners = open.faces.starts.last().copied().unwrap_or(0) as usize;
        open.faces.corners.truncate(corners);
        open.faces.surface.truncate(open.faces.starts.len() - 1);
        assert!(of(Shape::Mesh(open)).is_err_and(|m| m.contains("it is open")));
        let ball = crate::ImplicitSurface::new(Expression::parse("x^2+y^2+z^2-1").expect("a formula"));
        assert_eq!(of(Shape::Implicit(ball.clone())), Ok(()));
        assert!(of(Shape::Implicit(crate::ImplicitSurface { capped: false, ..ball })).is_err());
    }

    #[test]
    fn trees_have_bounds_of_their_own() {
        let single = Csg { root: CsgNode::Union(vec![ball(0.0)]) };
        assert!(single.check().is_err_and(|e| e.to_string().contains("two bodies or more")));
        let mut root = ball(0.0);
        for _ in 0..40 {
            root = CsgNode::Union(vec![root, ball(0.0)]);
        }
        assert!(Csg { root }.check().is_err_and(|e| e.to_string().contains("deeper than 32")));
        let many = Csg { root: CsgNode::Union(vec![ball(0.0); 5000]) };
        assert!(many.check().is_err_and(|e| e.to_string().contains("5000 leaves")));
        let flat = CsgNode::leaf(
            Shape::Sphere { radius: 1.0 },
            Transform::Matrix(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))),
            None,
        );
        let flat = Csg { root: CsgNode::Union(vec![ball(0.0), flat]) };
        assert!(flat.check().is_err_and(|e| e.to_string().contains("flattens")));
    }

    #[test]
    fn boxes_around_bodies() {
        let half_space = CsgNode::leaf(Shape::Plane { size: None }, Transform::default(), None);
        let half_ball = Csg { root: CsgNode::Intersection(vec![ball(0.0), half_space.clone()]) };
        assert_eq!(half_ball.check(), Ok(()));
        let bounds = half_ball.bounds_in(&DMat4::IDENTITY);
        assert_eq!((bounds.min, bounds.max), (-DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)));
        let lens = Csg { root: CsgNode::Intersection(vec![ball(0.0), ball(1.5)]) };
        assert_eq!(lens.bounds_in(&DMat4::IDENTITY).min.x, 0.5);
        let cut = Csg { root: CsgNode::Difference(vec![ball(0.0), half_space]) };
        assert_eq!(cut.bounds_in(&DMat4::IDENTITY).max, DVec3::ONE);
        assert_eq!(Shape::Csg(lens).bounds().max.x, 1.0);
    }

    #[test]
    fn planes_alone_can_make_a_body() {
        use senca_math::glam::DQuat;
        // A regular tetrahedron around the origin, its faces at distance 1: corners at distance 3.
        let up = DVec3::new(1.0, 1.0, 1.0).normalize();
        let normals =
            [up, DVec3::new(-1.0, -1.0, 1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, -1.0, -1.0)];
        let plane = |n: DVec3| {
            let turn = DQuat::from_rotation_arc(DVec3::Y, n.normalize());
            let place = DMat4::from_rotation_translation(turn, n.normalize());
            CsgNode::leaf(Shape::Plane { size: None }, Transform::Matrix(place), None)
        };
        let all = Csg { root: CsgNode::Intersection(normals.map(plane).to_vec()) };
        assert_eq!(all.check(), Ok(()));
        let bounds = all.bounds_in(&DMat4::IDENTITY);
        let side = 3f64.sqrt();
        assert!((bounds.max - side).length() < 1e-6 && (bounds.min + side).length() < 1e-6, "{bounds:?}");
        let three = Csg { root: CsgNode::Intersection(normals[..3].iter().map(|&n| plane(n)).collect()) };
        assert!(three.check().is_err_and(|e| e.to_string().contains("no end")));
    }
}
