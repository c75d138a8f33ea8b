//! Light at any place of the surfaces.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::Interpolation;
use crate::mesh::{Outline, Places};
use crate::{ElementMesh, Extrapolation, NONE, NodeTransfer, PatchPolygon};

/// Light on the leaves of a mesh, interpolated.
#[derive(Clone, Debug)]
pub struct LightField<'m> {
    mesh: &'m ElementMesh,
    of_elements: Vec<LinearRgb>,
    /// By vertex.
    nodes: Vec<LinearRgb>,
    places: Places,
    interpolation: Interpolation,
}

impl<'m> LightField<'m> {
    /// Interpolates `of_elements`, a value for each element of the mesh.
    #[must_use]
    pub fn new(mesh: &'m ElementMesh, of_elements: Vec<LinearRgb>, interpolation: Interpolation) -> Self {
        let nodes = NodeTransfer::new(mesh).apply(&of_elements, Extrapolation::Clamped);
        Self { mesh, of_elements, nodes, places: Places::of(mesh), interpolation }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &'m ElementMesh {
        self.mesh
    }

    /// What is taken for the light between nodes.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Light at a place of a leaf.
    ///
    /// Between the nodes of a quadrilateral it is bilinear, in a triangle linear. Where neighbours have
    /// nodes on an edge, these count, too: the element is then taken as triangles around its middle, so
    /// that light has no step at the edge.
    #[must_use]
    pub fn at(&self, leaf: u32, place: DVec3) -> LinearRgb {
        if self.interpolation == Interpolation::Flat {
            return self.of_elements[leaf as usize];
        }
        let outline = self.places.outline(self.mesh, leaf);
        let corners = self.mesh.elements()[leaf as usize].corners();
        if outline.iter().filter(|corner| corner.vertex != NONE).count() == corners.len() {
            let weights = self.mesh.shape(leaf).weights_at(place);
            return weighted(corners.iter().map(|&v| self.nodes[v as usize]).zip(weights));
        }
        self.in_fan(leaf, &outline, place)
    }

    /// Light in the triangle around the middle that holds the place.
    fn in_fan(&self, leaf: u32, outline: &Outline, place: DVec3) -> LinearRgb {
        let normal = self.mesh.normal(leaf);
        let middle = self.mesh.elements()[leaf as usize].center;
        let known: Vec<_> = outline.iter().filter(|corner| corner.vertex != NONE).collect();
        let pairs = || known.iter().zip(known.iter().cycle().skip(1));
        let inside = |a: DVec3, b: DVec3| {
            let share = |p: DVec3, q: DVec3| (p - place).cross(q - place).dot(normal);
            share(middle, a).min(share(b, middle))
        };
        let best = pairs().max_by(|(a, b), (c, d)| {
            inside(a.position, b.position).total_cmp(&inside(c.position, d.position))
        });
        let Some((a, b)) = best else { return self.of_elements[leaf as usize] };
        let triangle = PatchPolygon::triangle([middle, a.position, b.position]);
        let values = [self.middle(leaf), self.nodes[a.vertex as usize], self.nodes[b.vertex as usize]];
        weighted(values.into_iter().zip(triangle.weights_at(place)))
    }

    /// Light in the middle of a leaf.
    pub(crate) fn middle(&self, leaf: u32) -> LinearRgb {
        if self.interpolation == Interpolation::Flat {
            return self.of_elements[leaf as usize];
        }
        let corners = self.mesh.elements()[leaf as usize].corners();
        let weight = (corners.len() as f64).recip();
        weighted(corners.iter().map(|&v| (self.nodes[v as usize], weight)))
    }

    /// Light at a corner of the outline of a leaf.
    pub(crate) fn at_corner(&self, leaf: u32, corner: &crate::mesh::Corner) -> LinearRgb {
        if self.interpolation == Interpolation::Flat {
            return self.of_elements[leaf as usize];
        }
        if corner.vertex != NONE {
            return self.nodes[corner.vertex as usize];
        }
        let [a, b] = corner.between.map(|vertex| self.nodes[vertex as usize]);
        a.lerp(b, corner.along as f32)
    }

    /// The outline of a leaf, with the corners of its neighbours.
    pub(crate) fn outline(&self, leaf: u32) -> Outline {
        self.places.outline(self.mesh, leaf)
    }
}

fn weighted(values: impl Iterator<Item = (LinearRgb, f64)>) -> LinearRgb {
    values.fold(LinearRgb::BLACK, |sum, (value, weight)| sum + value * weight as f32)
}
