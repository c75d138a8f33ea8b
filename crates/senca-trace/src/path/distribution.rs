//! Choosing one of many by weight.

/// Weights, summed up so that a number in [0, 1) chooses one.
#[derive(Clone, Debug, Default)]
pub(super) struct Distribution {
    /// Sum of the weights up to and with each.
    sums: Vec<f64>,
}

impl Distribution {
    /// Of weights; those that are negative or not finite count as 0.
    pub(super) fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut total = 0.0;
        let add = |weight: f64| {
            total += if weight.is_finite() { weight.max(0.0) } else { 0.0 };
            total
        };
        Self { sums: weights.into_iter().map(add).collect() }
    }

    /// Sum of the weights.
    pub(super) fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.sums.len()
    }

    /// Chance of number `index`.
    pub(super) fn chance(&self, index: usize) -> f64 {
        let total = self.total();
        let before = if index == 0 { 0.0 } else { self.sums[index - 1] };
        if total > 0.0 { (self.sums[index] - before) / total } else { 0.0 }
    }

    /// The one that `u` in [0, 1) falls to, its chance, and where `u` is within its share, in [0, 1).
    /// Never one of weight 0; `None` when there is nothing else.
    pub(super) fn choose(&self, u: f64) -> Option<(usize, f64, f64)> {
        let total = self.total();
        if total <= 0.0 {
            return None;
        }
        let at = u * total;
        // The first whose sum exceeds `at`; rounding may find none, then the last with a weight.
        let index = self.sums.partition_point(|&sum| sum <= at);
        let index = if index < self.sums.len() { index } else { self.sums.partition_point(|&s| s < total) };
        let before = if index == 0 { 0.0 } else { self.sums[index - 1] };
        let weight = self.sums[index] - before;
        let rest = ((at - before) / weight).clamp(0.0, 1.0 - f64::EPSILON);
        Some((index, weight / total, rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nothing_to_choose() {
        assert_eq!(Distribution::new([]).choose(0.5), None);
        assert_eq!(Distribution::new([0.0, f64::NAN, -1.0]).choose(0.5), None);
    }

    proptest! {
        #[test]
        fn shares_are_proportional(weights in prop::collection::vec(prop_oneof![Just(0.0), 0.01f64..5.0], 1..20)) {
            let total: f64 = weights.iter().sum();
            prop_assume!(total > 0.0);
            let distribution = Distribution::new(weights.iter().copied());
            let n = 4096;
            let mut counts = vec![0u32; weights.len()];
            for i in 0..n {
                let (index, chance, rest) = distribution.choose((f64::from(i) + 0.5) / f64::from(n)).expect("some");
                prop_assert!((chance - weights[index] / total).abs() < 1e-12 && (0.0..1.0).contains(&rest));
                prop_assert_eq!(chance, distribution.chance(index));
                counts[index] += 1;
            }
            for (count, weight) in counts.iter().zip(&weights) {
                prop_assert!((f64::from(*count) - weight / total * f64::from(n)).abs() < 2.0);
            }
            prop_assert!(weights[distribution.choose(1.0).expect("some").0] > 0.0);
        }
    }
}
