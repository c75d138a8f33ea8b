//! What a two-level division saves (course text, section 4.3, task 4.8).

/// Sizes of a radiosity problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Equations of the system.
    pub equations: u64,
    /// Form factors of the system.
    pub factors: u64,
    /// Form factors computed, of which those of the system are means.
    pub computed: u64,
    /// Products summed up for the parts after solving.
    pub back_substitution: u64,
}

impl Cost {
    /// `patches` divided in `parts` each, all parts in one system.
    #[must_use]
    pub const fn flat(patches: u64, parts: u64) -> Self {
        let all = patches * parts;
        Self { equations: all, factors: all * all, computed: all * all, back_substitution: 0 }
    }

    /// The undivided patches in the system, with factors that are means over the parts of the one that
    /// sees; then each part from the solution of all others (equations 4.14 to 4.16).
    #[must_use]
    pub const fn two_level(patches: u64, parts: u64) -> Self {
        let partial = parts * patches * patches;
        Self { equations: patches, factors: patches * patches, computed: partial, back_substitution: partial }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_patches_of_sixteen_parts() {
        let flat = Cost::flat(100, 16);
        assert_eq!((flat.equations, flat.factors), (1600, 2_560_000));
        let two = Cost::two_level(100, 16);
        assert_eq!((two.equations, two.factors), (100, 10_000));
        assert_eq!((two.computed, two.back_substitution), (160_000, 160_000));
    }
}
