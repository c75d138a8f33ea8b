//! Flat regions: what rings of straight sides enclose.

use senca_math::glam::DVec2;

/// Sides up to which no bands are made.
const FEW: usize = 16;

/// The places inside an odd number of rings, looked up in about the same time for any number of sides.
///
/// The crossing count of [`crate::textbook::in_polygon`], with the sides sorted into horizontal bands:
/// only those in the band of a point can be crossed by its half-line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Region {
    low: DVec2,
    high: DVec2,
    /// Lower and upper end of each side that is not horizontal.
    sides: Vec<[DVec2; 2]>,
    /// Where each band begins in `members`, with one more for the end.
    starts: Vec<u32>,
    /// Indices of sides, band by band.
    members: Vec<u32>,
}

impl Region {
    /// The region of `rings`, all corners finite.
    pub(super) fn new(rings: &[Vec<DVec2>]) -> Self {
        let all = || rings.iter().flatten().copied();
        let edges =
            rings.iter().flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]));
        let upwards = edges.filter(|[a, b]| a.y != b.y).map(|[a, b]| if a.y < b.y { [a, b] } else { [b, a] });
        let mut region = Self {
            low: all().fold(DVec2::INFINITY, DVec2::min),
            high: all().fold(DVec2::NEG_INFINITY, DVec2::max),
            sides: upwards.collect(),
            starts: Vec::new(),
            members: Vec::new(),
        };
        if region.sides.len() > FEW {
            region.sort_into_bands();
        }
        region
    }

    /// Bands in such a number that no more than eight entries per side are needed.
    fn sort_into_bands(&mut self) {
        let mut count = self.sides.len();
        let entries = |count: usize, region: &Self| -> usize {
            region.sides.iter().map(|side| region.bands_of(side, count).count()).sum()
        };
        while count > 1 && entries(count, self) > 8 * self.sides.len() {
            count /= 2;
        }
        let mut starts = vec![0u32; count + 1];
        for side in &self.sides {
            self.bands_of(side, count).for_each(|band| starts[band + 1] += 1);
        }
        for band in 0..count {
            starts[band + 1] += starts[band];
        }
        let mut next = starts.clone();
        let mut members = vec![0; starts[count] as usize];
        for (i, side) in self.sides.iter().enumerate() {
            for band in self.bands_of(side, count) {
                members[next[band] as usize] = i as u32;
                next[band] += 1;
            }
        }
        (self.starts, self.members) = (starts, members);
    }

    /// The band of a height, of `count`. Growing with the height, whatever the rounding.
    fn band(&self, y: f64, count: usize) -> usize {
        let share = (y - self.low.y) / (self.high.y - self.low.y);
        ((share * count as f64) as usize).min(count - 1)
    }

    fn bands_of(&self, side: &[DVec2; 2], count: usize) -> std::ops::RangeInclusive<usize> {
        self.band(side[0].y, count)..=self.band(side[1].y, count)
    }

    /// Whether a place lies inside; on the left and lower border it does.
    pub(super) fn contains(&self, p: DVec2) -> bool {
        if !(p.cmpge(self.low).all() && p.cmple(self.high).all()) {
            return false;
        }
        let crossed = |[low, high]: &[DVec2; 2]| {
            low.y <= p.y && p.y < high.y && (*high - *low).perp_dot(p - *low) > 0.0
        };
        if self.starts.is_empty() {
            return self.sides.iter().filter(|side| crossed(side)).count() % 2 == 1;
        }
        let band = self.band(p.y, self.starts.len() - 1);
        let members = &self.members[self.starts[band] as usize..self.starts[band + 1] as usize];
        members.iter().filter(|&&i| crossed(&self.sides[i as usize])).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::textbook::in_polygon;

    proptest! {
        #[test]
        fn the_same_as_by_counting(
            corners in prop::collection::vec((0..24i32, 0..24i32), 3..80),
            points in prop::collection::vec((0..48i32, 0..48i32), 40),
        ) {
            let corners: Vec<DVec2> = corners.iter().map(|(x, y)| DVec2::new(f64::from(*x), f64::from(*y))).collect();
            let region = Region::new(std::slice::from_ref(&corners));
            for (x, y) in points {
                let p = DVec2::new(0.5 * f64::from(x), 0.5 * f64::from(y));
                prop_assert_eq!(region.contains(p), in_polygon(&corners, p));
            }
        }
    }

    #[test]
    fn tall_combs_do_not_take_memory_without_bounds() {
        let comb: Vec<DVec2> =
            (0..4000).map(|i| DVec2::new(f64::from(i), f64::from(i % 2) * 100.0)).collect();
        let region = Region::new(&[comb]);
        assert!(region.members.len() <= 8 * region.sides.len());
        assert!(region.contains(DVec2::new(1.0, 50.0)) != region.contains(DVec2::new(2.0, 50.0)));
    }
}
