//! Building a body from operations and leaves.

use senca_math::glam::{DMat3, DMat4, DVec3};
use senca_math::{Aabb, normal_matrix};

use super::{CsgBody, Leaf, Node, Operation, Place};
use crate::Intersect;

/// Most leaves of one body.
const MAX_LEAVES: usize = 1 << 16;

/// Why operations and leaves make no body.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CsgError {
    /// An operation was closed that was not open, or not all were closed.
    #[error("operations and their ends do not match")]
    Unbalanced,
    /// An operation has no body to work on.
    #[error("an operation needs at least one body")]
    Empty,
    /// A body has no inside.
    #[error("body {leaf} is open")]
    Open {
        /// Number of the leaf.
        leaf: usize,
    },
    /// A placement is not finite or flattens its body.
    #[error("the placement of body {leaf} is not finite or flattens it")]
    Placement {
        /// Number of the leaf.
        leaf: usize,
    },
    /// There are too many leaves, or a leaf has too many parts beside so many leaves.
    #[error("body {leaf} is one too many, or has too many parts")]
    TooLarge {
        /// Number of the leaf.
        leaf: usize,
    },
}

/// Takes operations and leaves from left to right, as a formula is read: open an operation, give its
/// bodies, close it. What stands side by side outside of any operation is united.
#[derive(Debug, Default)]
pub struct CsgBuilder<'s> {
    leaves: Vec<Leaf<'s>>,
    nodes: Vec<Node>,
    /// Boxes around what each operation gives, up to now.
    boxes: Vec<Aabb>,
    /// Operations not yet closed.
    open: Vec<u32>,
}

impl<'s> CsgBuilder<'s> {
    /// A builder without bodies.
    #[must_use]
    pub fn new() -> Self {
        let mut builder = Self::default();
        builder.add_node(Operation::Union, None);
        builder
    }

    fn add_node(&mut self, operation: Operation, place: Option<Place>) {
        self.open.push(self.nodes.len() as u32);
        self.nodes.push(Node { operation, bodies: 0, place });
        self.boxes.push(Aabb::EMPTY);
    }

    /// The place of the next body in the innermost open operation.
    fn next_place(&mut self) -> Result<Place, CsgError> {
        let node = *self.open.last().ok_or(CsgError::Unbalanced)?;
        let bodies = &mut self.nodes[node as usize].bodies;
        *bodies += 1;
        Ok(Place { node, first: *bodies == 1 })
    }

    /// Begins an operation; what follows are its bodies.
    ///
    /// # Errors
    /// [`CsgError::Unbalanced`] when everything is closed already.
    pub fn open(&mut self, operation: Operation) -> Result<(), CsgError> {
        let place = self.next_place()?;
        self.add_node(operation, Some(place));
        Ok(())
    }

    /// Ends the operation begun last.
    ///
    /// # Errors
    /// [`CsgError::Empty`] when it has no bodies, [`CsgError::Unbalanced`] when none is open.
    pub fn close(&mut self) -> Result<(), CsgError> {
        let node = self.open.pop().ok_or(CsgError::Unbalanced)?;
        let Node { bodies, place, .. } = self.nodes[node as usize];
        if bodies == 0 {
            return Err(CsgError::Empty);
        }
        if let Some(place) = place {
            self.enclose(place, self.boxes[node as usize]);
        }
        Ok(())
    }

    /// The box of an operation with one more body in it.
    fn enclose(&mut self, place: Place, body: Aabb) {
        let bounds = &mut self.boxes[place.node as usize];
        *bounds = match self.nodes[place.node as usize].operation {
            _ if place.first => body,
            Operation::Union => bounds.union(body),
            Operation::Intersection => both(*bounds, body),
            Operation::Difference => *bounds,
        };
    }

    /// Adds a closed body, placed by an affine map.
    ///
    /// # Errors
    /// [`CsgError`] when the body is open, the placement flattens it, or there are too many.
    pub fn leaf(
        &mut self,
        surface: Box<dyn Intersect + 's>,
        object_from_leaf: DMat4,
    ) -> Result<(), CsgError> {
        if !surface.is_closed() {
            return Err(CsgError::Open { leaf: self.leaves.len() });
        }
        let bounds = surface.bounds().transformed(&object_from_leaf);
        self.add_leaf(surface, object_from_leaf, bounds, false)
    }

    /// Adds the half-space y < 0, placed by an affine map; `plane` is its border, the endless plane y = 0.
    ///
    /// # Errors
    /// As for [`CsgBuilder::leaf`].
    pub fn half_space(
        &mut self,
        plane: Box<dyn Intersect + 's>,
        object_from_leaf: DMat4,
    ) -> Result<(), CsgError> {
        let bounds = half_space_bounds(&object_from_leaf);
        self.add_leaf(plane, object_from_leaf, bounds, true)
    }

    fn add_leaf(
        &mut self,
        surface: Box<dyn Intersect + 's>,
        object_from_leaf: DMat4,
        bounds: Aabb,
        half_space: bool,
    ) -> Result<(), CsgError> {
        let leaf = self.leaves.len();
        if leaf >= MAX_LEAVES {
            return Err(CsgError::TooLarge { leaf });
        }
        let leaf_from_object = object_from_leaf.inverse();
        if !object_from_leaf.is_finite() || !leaf_from_object.is_finite() {
            return Err(CsgError::Placement { leaf });
        }
        let place = self.next_place()?;
        self.enclose(place, bounds);
        let subtracted = self.is_subtracted(place);
        self.leaves.push(Leaf {
            surface,
            object_from_leaf,
            leaf_from_object,
            normals: normal_matrix(DMat3::from_mat4(object_from_leaf)),
            bounds,
            place,
            subtracted,
            half_space,
            orientation: object_from_leaf.determinant().signum(),
        });
        Ok(())
    }

    fn is_subtracted(&self, place: Place) -> bool {
        let mut subtracted = false;
        let mut place = Some(place);
        while let Some(Place { node, first }) = place {
            let node = &self.nodes[node as usize];
            subtracted ^= node.operation == Operation::Difference && !first;
            place = node.place;
        }
        subtracted
    }

    /// The body.
    ///
    /// # Errors
    /// [`CsgError::Unbalanced`] while operations are open, [`CsgError::Empty`] without a body,
    /// [`CsgError::TooLarge`] when a leaf has more parts than can be numbered.
    pub fn finish(mut self) -> Result<CsgBody<'s>, CsgError> {
        self.close()?;
        if !self.open.is_empty() {
            return Err(CsgError::Unbalanced);
        }
        let leaf_bits = usize::BITS - (self.leaves.len() - 1).leading_zeros();
        let part_bits = u32::BITS - leaf_bits;
        let too_many = |leaf: &Leaf<'_>| u64::from(leaf.surface.part_count()) > 1 << part_bits;
        if let Some(leaf) = self.leaves.iter().position(too_many) {
            return Err(CsgError::TooLarge { leaf });
        }
        Ok(CsgBody { leaves: self.leaves, nodes: self.nodes, bounds: self.boxes[0], part_bits })
    }
}

fn both(a: Aabb, b: Aabb) -> Aabb {
    let both = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
    if both.is_empty() { Aabb::EMPTY } else { both }
}

/// A box around the half-space y < 0 after an affine map: bounded on one side where its border is
/// perpendicular to an axis.
fn half_space_bounds(object_from_leaf: &DMat4) -> Aabb {
    let normal = (normal_matrix(DMat3::from_mat4(*object_from_leaf)) * DVec3::Y).normalize_or_zero();
    let border = object_from_leaf.w_axis.truncate();
    let mut bounds = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
    for axis in 0..3 {
        if normal[axis] >= 1.0 - 1e-12 {
            bounds.max[axis] = border[axis];
        } else if normal[axis] <= -1.0 + 1e-12 {
            bounds.min[axis] = border[axis];
        }
    }
    bounds
}
