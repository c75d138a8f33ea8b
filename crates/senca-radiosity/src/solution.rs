//! Light on the elements of a mesh.

use senca_math::LinearRgb;

use crate::ElementMesh;

/// How well a solution was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Polygons of the scene that took part.
    pub polygons: u64,
    /// Leaves of the mesh.
    pub patches: u64,
    /// All elements, leaves and those that are divided.
    pub elements: u64,
    /// Form factors or links between elements that the solution rests on.
    pub links: u64,
    /// Rounds of the solver, or steps of shooting.
    pub iterations: u32,
    /// The largest change of a radiosity in the last round, as a share of the largest radiosity.
    pub residual: f64,
    /// Power that is neither absorbed nor lost nor accounted for otherwise, as a share of the power
    /// emitted and cast by lamps.
    pub energy_error: f64,
    /// Whether the solver met its tolerance.
    pub converged: bool,
    /// Power that was reflected or given off and not sent on yet, as a share of all that is given off
    /// and reflected from lamps; 0 for solvers that do not shoot.
    pub unsent: f64,
}

/// Light on the elements of a mesh: the result of every solver, seen from nowhere in particular.
///
/// The arrays have an entry for each element; that of a divided element is the mean over its parts,
/// weighted by open area. All values are in the unit of pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// The elements.
    pub mesh: ElementMesh,
    /// Light that arrives, H: a white matt surface without light of its own would show it.
    pub incident: Vec<LinearRgb>,
    /// The part of `incident` that comes straight from lamps and emitters.
    pub direct: Vec<LinearRgb>,
    /// How it was reached.
    pub report: SolveReport,
}

impl Solution {
    /// Radiosity of an element, as shown: its emission, and its reflectance times what arrives.
    #[must_use]
    pub fn radiosity(&self, element: u32) -> LinearRgb {
        let surface = self.mesh.surface(element);
        surface.emission + surface.reflectance * self.incident[element as usize]
    }

    /// The same with all light, that of emitters included, multiplied by a factor.
    #[must_use]
    pub fn exposed(&self, factor: f32) -> Self {
        let mut exposed = self.clone();
        if factor != 1.0 {
            exposed.mesh.scale_emission(factor);
            let values = exposed.incident.iter_mut().chain(&mut exposed.direct);
            values.for_each(|value| *value *= factor);
        }
        exposed
    }

    /// Sets the values of divided elements to the means over their parts, weighted by open area.
    pub fn pull(&mut self) {
        for values in [&mut self.incident, &mut self.direct] {
            // Parts have higher numbers than what they are part of.
            for element in (0..self.mesh.elements().len()).rev() {
                let whole = &self.mesh.elements()[element];
                if whole.is_leaf() {
                    continue;
                }
                let parts = whole.part_numbers().map(|part| part as usize);
                let area = |part: usize| self.mesh.elements()[part].open_area() as f32;
                let sum = parts.clone().fold(LinearRgb::BLACK, |sum, part| sum + values[part] * area(part));
                let total: f32 = parts.map(area).sum();
                values[element] = if total > 0.0 { sum * total.recip() } else { LinearRgb::BLACK };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_math::glam::DVec3;

    #[test]
    fn the_value_of_a_whole_is_the_mean_of_its_parts() {
        let corners = [[0.0, 0.0], [8.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let grey = LinearRgb::splat(0.5);
        let mut mesh = ElementMesh::of_polygons(&[(&corners, grey, LinearRgb::WHITE)]);
        mesh.divide(0);
        mesh.divide(1);
        let n = mesh.elements().len();
        let incident: Vec<LinearRgb> = (0..n).map(|i| LinearRgb::splat(i as f32)).collect();
        let mut solution = Solution { mesh, direct: incident.clone(), incident, ..Solution::default() };
        solution.pull();
        let leaves: Vec<u32> = solution.mesh.leaves().collect();
        let area = |leaf: u32| solution.mesh.elements()[leaf as usize].area;
        let sum: f64 = leaves.iter().map(|&leaf| f64::from(leaf) * area(leaf)).sum();
        let mean = (sum / solution.mesh.area()) as f32;
        assert!((solution.incident[0].r - mean).abs() < 1e-5);
        assert!((solution.radiosity(0).g - (1.0 + 0.5 * mean)).abs() < 1e-5);
    }
}
