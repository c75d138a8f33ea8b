//! Step 6: dividing elements.

use senca_math::LinearRgb;

use super::Book;
use crate::{NONE, NodeTransfer, RadiosityError};

impl Book<'_> {
    /// Divides elements that differ too much from their neighbours, and those that are much coarser
    /// than a neighbour. Tells whether there were any.
    pub(super) fn divide_elements(&mut self) -> Result<bool, RadiosityError> {
        let marked = self.marked();
        if marked.is_empty() {
            return Ok(false);
        }
        let leaves = self.mesh.leaves().count() + 3 * marked.len();
        if self.check_size(leaves).is_err() || leaves > self.settings.mesh.max_elements {
            let text = "elements are not divided further: there would be too many form factors";
            self.warnings.push(senca_scene::Warning(text.to_owned()));
            return Ok(false);
        }
        let mut any = false;
        for element in marked {
            any |= self.divide_leaf(element);
        }
        self.even_out();
        Ok(any)
    }

    fn divide_leaf(&mut self, element: u32) -> bool {
        let patch = self.patch_of[element as usize];
        if !self.may_divide(element) || !self.mesh.divide(element) {
            return false;
        }
        self.patch_of.resize(self.mesh.elements().len(), patch);
        self.rows.forget(element);
        true
    }

    fn may_divide(&self, element: u32) -> bool {
        let patch = self.patch_of[element as usize];
        if patch == NONE {
            return false;
        }
        let level = |element: u32| self.mesh.elements()[element as usize].level;
        let deep = level(element) - level(self.patches[patch as usize]) >= self.settings.depth;
        !deep && self.mesh.longest_edge(element) > self.settings.smallest
    }

    /// Leaves with too large a step to a neighbour, or within.
    fn marked(&self) -> Vec<u32> {
        let shown = |leaf: u32| self.mesh.surface(leaf).reflectance * self.solution.incident[leaf as usize];
        let mean = self.mean_shown(shown);
        let mut marks = vec![false; self.mesh.elements().len()];
        let transfer = NodeTransfer::new(&self.mesh);
        for vertex in 0..self.mesh.positions().len() as u32 {
            let around = transfer.adjoining(vertex);
            for (k, &a) in around.iter().enumerate() {
                for &b in &around[k + 1..] {
                    if self.is_step(shown(a), shown(b), mean) {
                        (marks[a as usize], marks[b as usize]) = (true, true);
                    }
                }
            }
        }
        let within = |leaf: u32| {
            let reflectance = self.mesh.surface(leaf).reflectance.max_component();
            let spread = f64::from(reflectance * self.spread[leaf as usize]);
            let here = f64::from(shown(leaf).max_component()).max(mean);
            // From corner to corner an even slope has twice the step between neighbours.
            spread > 2.0 * self.settings.largest_step * here
        };
        let leaves = self.mesh.leaves();
        leaves.filter(|&l| (marks[l as usize] || within(l)) && self.may_divide(l)).collect()
    }

    fn is_step(&self, a: LinearRgb, b: LinearRgb, mean: f64) -> bool {
        let [a, b] = [a, b].map(|c| c.to_array().map(f64::from));
        (0..3).any(|c| (a[c] - b[c]).abs() > self.settings.largest_step * mean.max(0.5 * (a[c] + b[c])))
    }

    /// Mean over the area of the largest channel of what leaves show by reflection.
    fn mean_shown(&self, shown: impl Fn(u32) -> LinearRgb) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for leaf in self.mesh.leaves() {
            let size = self.mesh.elements()[leaf as usize].area;
            sum += size * f64::from(shown(leaf).max_component());
            area += size;
        }
        if area > 0.0 { sum / area } else { 0.0 }
    }

    /// Divides leaves on whose side a neighbour is divided more than once.
    fn even_out(&mut self) {
        let mut side = Vec::new();
        for _ in 0..self.settings.depth {
            let mut coarse = Vec::new();
            for leaf in self.mesh.leaves() {
                let corners = self.mesh.elements()[leaf as usize].corners();
                let much_finer = (0..corners.len()).any(|i| {
                    side.clear();
                    self.mesh.vertices_on_edge(corners[i], corners[(i + 1) % corners.len()], &mut side);
                    side.len() > 3
                });
                if much_finer {
                    coarse.push(leaf);
                }
            }
            let divided = coarse.into_iter().filter(|&leaf| self.divide_leaf(leaf)).count();
            if divided == 0 {
                return;
            }
        }
    }
}
