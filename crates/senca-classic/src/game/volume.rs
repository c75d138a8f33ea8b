//! Throwing away what surely is not seen.
//!
//! Points just beyond the clipping plane may come to lie anywhere once they are divided by their depth. Rather than
//! clipping at a pyramid, the box around a polygon is compared with the pyramid of 90 degrees whose sides are
//! `x = z`, `-x = z`, `y = z` and `-y = z`. That all corners lie outside is not enough to reject a polygon: its ends may lie
//! beyond different sides, and its middle be seen.
//!
//! The test is safe where the angle of view is at most 90 degrees, for a focus of at least half the screen's width; and
//! polygons must not be very large. Source: Savchenko 1995, "Volume clipping".

/// How a polygon lies to the volume that is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeTest {
    /// Surely not seen.
    Outside,
    /// It crosses the clipping plane and has to be cut there.
    CrossesPlane,
    /// It needs no cut at the clipping plane.
    Inside,
}

impl VolumeTest {
    /// The number that the 1995 library returns: 0, -1 or 1.
    #[must_use]
    pub fn code(self) -> i32 {
        match self {
            Self::Outside => 0,
            Self::CrossesPlane => -1,
            Self::Inside => 1,
        }
    }
}

/// Tests the box around the points against the volume (`C_volume_clipping`); no points are outside.
#[must_use]
pub fn test_volume(points: &[[i32; 3]], clip_plane: i32) -> VolumeTest {
    let min = |k: usize| points.iter().map(|p| i64::from(p[k])).min();
    let max = |k: usize| points.iter().map(|p| i64::from(p[k])).max();
    let (Some(z_max), Some(z_min)) = (max(2), min(2)) else { return VolumeTest::Outside };
    let beyond_side = |k: usize| min(k).is_some_and(|v| v > z_max) || max(k).is_some_and(|v| -v > z_max);
    if beyond_side(0) || beyond_side(1) || z_max < i64::from(clip_plane) {
        VolumeTest::Outside
    } else if z_min < i64::from(clip_plane) {
        VolumeTest::CrossesPlane
    } else {
        VolumeTest::Inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_truth_table() {
        let cases = [
            ([[-300, 0, 100], [300, 0, 100], [0, 10, 120]], 1),
            ([[200, 0, 100], [300, 0, 150], [250, 10, 120]], 0),
            ([[0, 0, -5], [5, 0, 50], [0, 5, 60]], -1),
            ([[0, 0, -5], [5, 0, -1], [0, 5, -9]], 0),
            ([[0, 0, 100], [5, 0, 100], [0, 5, 100]], 1),
            ([[150, 0, 100], [140, 0, 130], [300, 0, 141]], 1),
        ];
        for (points, code) in cases {
            assert_eq!(test_volume(&points, 10).code(), code, "{points:?}");
            // The same with up for right and left for right.
            assert_eq!(test_volume(&points.map(|[x, y, z]| [y, x, z]), 10).code(), code);
            assert_eq!(test_volume(&points.map(|[x, y, z]| [-x, -y, z]), 10).code(), code);
        }
        assert_eq!(test_volume(&[], 10), VolumeTest::Outside);
        assert_eq!(test_volume(&[[i32::MIN; 3], [i32::MAX; 3]], 10), VolumeTest::CrossesPlane);
    }

    #[test]
    fn with_a_wide_angle_what_is_seen_may_be_thrown_away() {
        // With a focus of 128 the screen's edge is x = 1.25 z, with 256 it is 0.625 z.
        let points = [[110, 0, 100], [120, 0, 100], [115, 10, 105]];
        assert_eq!(test_volume(&points, 10), VolumeTest::Outside);
        let on_screen = |log_focus| {
            let lens = crate::game::Lens { log_focus, ..crate::game::Lens::new(320, 200) };
            points.iter().any(|&p| lens.project(p).is_some_and(|[x, _]| (0..320).contains(&x)))
        };
        assert_eq!([7, 8].map(on_screen), [true, false]);
    }

    proptest! {
        #[test]
        fn nothing_that_is_seen_at_90_degrees_is_thrown_away(
            points in prop::collection::vec(prop::array::uniform3(-500i32..500), 3..6)
        ) {
            let seen = |p: &[i32; 3]| p[2] >= 10 && p[0].abs() <= p[2] && p[1].abs() <= p[2];
            if points.iter().any(seen) {
                prop_assert_ne!(test_volume(&points, 10), VolumeTest::Outside);
            }
        }
    }
}
