//! Dividing elements.

use super::{Element, ElementMesh, NONE};
use crate::RadiosityError;

/// Quadrilaterals whose sides differ by more than this factor are halved along the longer ones instead
/// of quartered.
const LONG_QUAD: f64 = 1.5;

/// Triangles whose longest edge squared exceeds this many times twice their area are halved at that
/// edge instead of quartered. A right triangle with equal legs has 2.
const LONG_TRIANGLE: f64 = 4.0;

/// Divisions of one polygon at most; beyond it the middle of an edge soon is one of its ends.
pub(crate) const MAX_LEVEL: u8 = 24;

impl ElementMesh {
    /// Divides a leaf at the middle of its edges, in 4 parts, or in 2 where it is long and narrow. The
    /// parts come to the end of the elements; whoever is divided already or too small to be divided
    /// stays as it is. Tells whether there are new parts.
    pub fn divide(&mut self, element: u32) -> bool {
        let whole = self.elements[element as usize];
        if !whole.is_leaf() || whole.level >= MAX_LEVEL || whole.area <= 0.0 {
            return false;
        }
        let first_part = self.elements.len() as u32;
        let parts = match whole.vertices {
            [a, b, c, NONE] => self.parts_of_triangle([a, b, c], whole.area),
            quad => self.parts_of_quad(quad),
        };
        for &vertices in &parts {
            let part = Element { vertices, parent: element, level: whole.level + 1, ..whole };
            self.push_element(part);
        }
        let divided = &mut self.elements[element as usize];
        (divided.first_part, divided.parts) = (first_part, parts.len() as u8);
        true
    }

    /// Divides leaves until no edge is longer than `size`.
    ///
    /// # Errors
    /// [`RadiosityError::TooManyElements`].
    pub fn divide_to_size(&mut self, size: f64, max_elements: usize) -> Result<(), RadiosityError> {
        let mut element = 0;
        while let Some(&candidate) = self.elements.get(element) {
            if candidate.is_leaf() && self.longest_edge(element as u32) > size {
                if self.elements.len() >= max_elements {
                    return Err(RadiosityError::TooManyElements { limit: max_elements });
                }
                self.divide(element as u32);
            }
            element += 1;
        }
        Ok(())
    }

    /// Length of the longest edge of an element, in world units.
    #[must_use]
    pub fn longest_edge(&self, element: u32) -> f64 {
        let corners = self.elements[element as usize].corners();
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(&a, &b)| self.length(a, b)).fold(0.0, f64::max)
    }

    /// The vertices on an edge from `a` to `b`, with both ends, as the elements on either side have
    /// divided it.
    pub fn vertices_on_edge(&self, a: u32, b: u32, out: &mut Vec<u32>) {
        out.push(a);
        self.vertices_between(a, b, out);
        out.push(b);
    }

    fn vertices_between(&self, a: u32, b: u32, out: &mut Vec<u32>) {
        if let Some(&middle) = self.midpoints.get(&edge(a, b)) {
            self.vertices_between(a, middle, out);
            out.push(middle);
            self.vertices_between(middle, b, out);
        }
    }

    /// Adds an element with its area and center.
    pub(super) fn push_element(&mut self, mut element: Element) -> u32 {
        let number = self.elements.len() as u32;
        (element.first_part, element.parts) = (NONE, 0);
        self.elements.push(element);
        let shape = self.shape(number);
        let stored = &mut self.elements[number as usize];
        (stored.area, stored.center) = (shape.normal_and_area().1, shape.center());
        number
    }

    fn parts_of_quad(&mut self, [a, b, c, d]: [u32; 4]) -> Vec<[u32; 4]> {
        let along = self.length(a, b) + self.length(d, c);
        let across = self.length(b, c) + self.length(a, d);
        if along > LONG_QUAD * across {
            let (ab, cd) = (self.middle(a, b), self.middle(c, d));
            return vec![[a, ab, cd, d], [ab, b, c, cd]];
        }
        if across > LONG_QUAD * along {
            let (bc, da) = (self.middle(b, c), self.middle(d, a));
            return vec![[a, b, bc, da], [da, bc, c, d]];
        }
        let [ab, bc, cd, da] = [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| self.middle(p, q));
        let center = self.middle(ab, cd);
        vec![[a, ab, center, da], [ab, b, bc, center], [center, bc, c, cd], [da, center, cd, d]]
    }

    fn parts_of_triangle(&mut self, [a, b, c]: [u32; 3], area: f64) -> Vec<[u32; 4]> {
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        let length = |turn: &[u32; 3]| self.length(turn[0], turn[1]);
        let longest = turns.into_iter().max_by(|p, q| length(p).total_cmp(&length(q)));
        let [p, q, apex] = longest.unwrap_or([a, b, c]);
        if self.length(p, q).powi(2) > LONG_TRIANGLE * 2.0 * area {
            let middle = self.middle(p, q);
            return vec![[p, middle, apex, NONE], [middle, q, apex, NONE]];
        }
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| self.middle(p, q));
        vec![[a, ab, ca, NONE], [ab, b, bc, NONE], [ca, bc, c, NONE], [ab, bc, ca, NONE]]
    }

    /// The vertex in the middle of an edge.
    fn middle(&mut self, a: u32, b: u32) -> u32 {
        if let Some(&middle) = self.midpoints.get(&edge(a, b)) {
            return middle;
        }
        let [p, q] = [a, b].map(|vertex| self.positions[vertex as usize]);
        let [m, n] = [a, b].map(|vertex| self.vertex_normals[vertex as usize]);
        let middle = self.push_vertex(0.5 * (p + q), (m + n).normalize_or(m));
        self.midpoints.insert(edge(a, b), middle);
        middle
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        self.positions[a as usize].distance(self.positions[b as usize])
    }
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
