//! What flat accelerators sort: the parts of all objects, in the world.

use senca_math::Aabb;

use crate::world::Object;

/// A part of an object with a box around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Element {
    pub(super) object: u32,
    pub(super) part: u32,
}

/// The parts of all objects that have bounds, and beside them the objects that have none.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub(super) list: Vec<Element>,
    /// Box around every element, in the world.
    pub(super) boxes: Vec<Aabb>,
    /// Objects without bounds.
    pub(super) endless: Vec<u32>,
}

impl Elements {
    /// All parts. What is empty is left out: no ray meets it.
    pub(super) fn of_parts(objects: &[Object<'_>]) -> Self {
        let mut elements = Self::default();
        for (index, object) in objects.iter().enumerate() {
            if object.is_endless() {
                elements.endless.push(index as u32);
                continue;
            }
            for part in 0..object.surface.part_count() {
                elements.add(Element { object: index as u32, part }, object.part_bounds_world(part));
            }
        }
        elements
    }

    fn add(&mut self, element: Element, bounds: Aabb) {
        if !bounds.is_empty() {
            self.list.push(element);
            self.boxes.push(bounds);
        }
    }
}
