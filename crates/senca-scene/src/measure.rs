//! Volume and area of meshes, and turning them inside out.

use senca_math::glam::DVec3;

use crate::Mesh;

impl Mesh {
    /// Volume that the faces enclose, positive when they face outwards. Meaningful for closed meshes.
    /// Each face counts as the fan from its first corner; sums are kept relative to the first point.
    ///
    /// # Panics
    /// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let origin = self.points.first().map_or(DVec3::ZERO, |p| p.as_dvec3());
        self.fan_triangles().map(|[a, b, c]| (a - origin).dot((b - origin).cross(c - origin))).sum::<f64>()
            / 6.0
    }

    /// Area of all faces, each counted as the fan from its first corner.
    ///
    /// # Panics
    /// When the mesh names vertices or points that it does not have (see [`Mesh::check`]).
    #[must_use]
    pub fn area(&self) -> f64 {
        0.5 * self.fan_triangles().map(|[a, b, c]| (b - a).cross(c - a).length()).sum::<f64>()
    }

    fn fan_triangles(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.faces.iter().flat_map(move |corners| {
            let place = |i: usize| self.position(corners[i]).as_dvec3();
            (2..corners.len()).map(move |i| [place(0), place(i - 1), place(i)])
        })
    }

    /// Turns the mesh inside out: faces run the other way, normals are negated.
    pub fn flip(&mut self) {
        if self.faces.starts.is_empty() {
            self.faces.corners.chunks_exact_mut(3).for_each(|face| face.swap(1, 2));
        } else {
            for range in self.faces.starts.windows(2) {
                // The first corner stays first.
                if let Some(rest) = self.faces.corners.get_mut(range[0] as usize + 1..range[1] as usize) {
                    rest.reverse();
                }
            }
        }
        self.vertices.normal.iter_mut().for_each(|normal| *normal = -*normal);
        self.vertices.tangent.iter_mut().for_each(|tangent| tangent.w = -tangent.w);
        for target in &mut self.morph_targets {
            target.normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::test_support::{house, octagonal_cylinder};

    #[test]
    fn volume_of_the_octagonal_cylinder_and_its_inside() {
        let mut mesh = octagonal_cylinder();
        // A square of 40 without four corners of legs 10, times 50.
        assert_eq!(mesh.signed_volume(), (1600.0 - 4.0 * 50.0) * 50.0);
        mesh.flip();
        assert_eq!(mesh.signed_volume(), -70_000.0);
        assert_eq!(mesh.faces.corners_of(0), [0, 8, 9, 1]);
    }

    #[test]
    fn area_of_the_house() {
        // Two gables of 16 x 10 + 16 x 6 / 2, floor, two walls, two slopes of 10, and the block.
        let gabled = 2.0 * 208.0 + 16.0 * 24.0 + 2.0 * 240.0 + 2.0 * 240.0;
        let block = 2.0 * 56.0 + 2.0 * 56.0 + 2.0 * 16.0;
        assert!((house().area() - (gabled + block)).abs() < 1e-3);
    }
}
