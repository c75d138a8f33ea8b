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

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored.
    pub reflected: u64,
    /// Through bodies.
    pub transmitted: u64,
    /// In a random direction, of the path tracer.
    pub bounce: u64,
}

impl RayCounts {
    /// All of them.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflected + self.transmitted + self.bounce
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.reflected += other.reflected;
        self.transmitted += other.transmitted;
        self.bounce += other.bounce;
    }
}

/// Counts of one thread's work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceCounts {
    /// Rays by kind.
    pub rays: RayCounts,
    /// What it took to find what they meet.
    pub work: Counters,
}

impl std::ops::AddAssign for TraceCounts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.work += other.work;
    }
}

impl TraceCounts {
    /// What was done since `before`.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        let (a, b) = (&self.rays, &before.rays);
        let rays = RayCounts {
            primary: a.primary - b.primary,
            shadow: a.shadow - b.shadow,
            reflected: a.reflected - b.reflected,
            transmitted: a.transmitted - b.transmitted,
            bounce: a.bounce - b.bounce,
        };
        let (a, b) = (&self.work, &before.work);
        let work = Counters { tests: a.tests - b.tests, nodes: a.nodes - b.nodes, cells: a.cells - b.cells };
        Self { rays, work }
    }
}
