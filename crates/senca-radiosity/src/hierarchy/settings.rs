//! What a solution is asked for.

use crate::RadiosityError;

/// How exact a hierarchical solution is to be, and what it may use up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HierarchySettings {
    /// Power that one link may be wrong by, as a share of all power that is emitted, in (0, 1].
    /// Default 3e-5. Half of it makes about one and a half times the links.
    pub threshold: f64,
    /// How many times finer light is taken that comes straight from emitters, >= 1, so that shadows are
    /// sharp. Default 4.
    pub direct_detail: f64,
    /// Elements with less area than a square of this edge are not divided, world units, > 0. Default
    /// `None`: 1/400 of the diagonal of the scene.
    pub smallest_edge: Option<f64>,
    /// Rounds of refinement, 1 to 16; each halves the threshold, the last has it as given. Default 4.
    pub rounds: u32,
    /// Change of the brightest radiosity at which an exchange ends, as a share of it, > 0. Default 1e-4.
    pub tolerance: f64,
    /// Exchanges of light per round at most. Default 200.
    pub max_iterations: u32,
    /// Exchanges that the next one learns from, 0 to 16; with 0 each is a plain bounce of light, of which
    /// bright closed rooms take hundreds. Default 4.
    pub remembered: usize,
    /// Elements at most. Default 2^22.
    pub max_elements: usize,
    /// Links at most. Default 2^24.
    pub max_links: usize,
}

impl Default for HierarchySettings {
    fn default() -> Self {
        Self {
            threshold: 3e-5,
            direct_detail: 4.0,
            smallest_edge: None,
            rounds: 4,
            tolerance: 1e-4,
            max_iterations: 200,
            remembered: 4,
            max_elements: 1 << 22,
            max_links: 1 << 24,
        }
    }
}

impl HierarchySettings {
    /// Refuses what is out of range.
    pub(super) fn check(&self) -> Result<(), RadiosityError> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        let refuse = |name, value, expected| Err(RadiosityError::Setting { name, value, expected });
        if !(positive(self.threshold) && self.threshold <= 1.0) {
            return refuse("threshold", self.threshold, "above 0 and at most 1");
        }
        if !(self.direct_detail >= 1.0 && self.direct_detail.is_finite()) {
            return refuse("detail of direct light", self.direct_detail, "at least 1");
        }
        if let Some(edge) = self.smallest_edge.filter(|&edge| !positive(edge)) {
            return refuse("smallest edge", edge, "above 0 and finite");
        }
        if !(1..=16).contains(&self.rounds) {
            return refuse("rounds", self.rounds.into(), "1 to 16");
        }
        if !positive(self.tolerance) {
            return refuse("tolerance", self.tolerance, "above 0 and finite");
        }
        if self.remembered > 16 {
            return refuse("remembered exchanges", self.remembered as f64, "0 to 16");
        }
        if self.max_iterations == 0 {
            return refuse("iterations", 0.0, "at least 1");
        }
        Ok(())
    }
}
