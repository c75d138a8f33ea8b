//! What tracing costs, counted.

/// Counts of the work done. Each thread has its own; sums do not depend on their number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays tested against a surface: a triangle, a sphere, a patch ...
    pub tests: u64,
    /// Rays tested against a bounding volume, and nodes of hierarchies visited.
    pub nodes: u64,
    /// Elements of a grid or octree that rays went through.
    pub cells: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.tests += other.tests;
        self.nodes += other.nodes;
        self.cells += other.cells;
    }
}
