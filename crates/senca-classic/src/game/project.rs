//! From the space of the viewer to the screen.
//!
//! The eye is at the origin and looks along Z; the screen stands at the distance of the focus, in pixels. The screen's
//! rows count downwards while Y is up, so the row is *centre minus* `y * focus / z`. The text adds it, which would draw
//! everything upside down.
//!
//! Source: Savchenko 1995, "perspective" and "clipping problem".

use super::fixed::saturate;

/// How far from the middle of the screen a pixel may come to lie; farther ones are set there. Half of what 32 bits hold,
/// so that differences fit.
pub const FARTHEST_PIXEL: i32 = 1 << 30;

/// How depth goes away, or does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Projection {
    /// What is farther away looks smaller.
    #[default]
    Perspective,
    /// Depth is dropped, as in programs for construction: a unit is a pixel at the distance `2^log_depth`.
    Parallel {
        /// Logarithm of the distance at which a unit is as large as by perspective, 0 to 20.
        log_depth: u32,
    },
}

/// The eye: its focus and the middle of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lens {
    /// Logarithm of the focus in pixels, 0 to 16 (`T_LOG_FOCUS`). Default 8: a focus of 256, 64 degrees on 320 pixels.
    pub log_focus: u32,
    /// Column and row of the middle (`HW_SCREEN_X_CENTRE`, `HW_SCREEN_Y_CENTRE`).
    pub center: [i32; 2],
    /// By perspective, or parallel.
    pub projection: Projection,
}

impl Lens {
    /// For a screen of this size, by perspective, with a focus of 256.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let half = |n: usize| i32::try_from(n / 2).unwrap_or(FARTHEST_PIXEL);
        Self { log_focus: 8, center: [half(width), half(height)], projection: Projection::Perspective }
    }

    /// The focus in pixels.
    #[must_use]
    pub fn focus(&self) -> i32 {
        1 << self.log_focus.min(16)
    }

    /// Column and row of a point in front of the eye, to the nearest pixel; `None` for `z <= 0`.
    #[must_use]
    pub fn project(&self, [x, y, z]: [i32; 3]) -> Option<[i32; 2]> {
        let z = match self.projection {
            _ if z <= 0 => return None,
            Projection::Perspective => i64::from(z),
            Projection::Parallel { log_depth } => 1 << log_depth.min(20),
        };
        let place = |c: i32| {
            let pixels = (2 * i64::from(c) * i64::from(self.focus()) + z).div_euclid(2 * z);
            saturate(pixels).clamp(-FARTHEST_PIXEL, FARTHEST_PIXEL)
        };
        Some([self.center[0] + place(x), self.center[1] - place(y)])
    }

    /// Exact column and row, as the reference has them; infinite or not a number where there is none.
    #[must_use]
    pub fn project_exact(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let z = match self.projection {
            Projection::Perspective => z,
            Projection::Parallel { log_depth } => f64::from(1 << log_depth.min(20)),
        };
        let focus = f64::from(self.focus());
        [f64::from(self.center[0]) + x * focus / z, f64::from(self.center[1]) - y * focus / z]
    }
}

/// The angle that a screen is seen under, in degrees: twice the arctangent of half its width by the focus.
#[must_use]
pub fn view_angle(width: f64, focus: f64) -> f64 {
    2.0 * (width / 2.0 / focus).atan().to_degrees()
}

/// What is kept of Z beside the projected point, to tell what hides what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DepthKept {
    /// 0: enough for drawing.
    Nothing,
    /// Z itself. A polygon that was in front may be behind afterwards, because straight edges no longer are.
    Same,
    /// `c1 + c2 / z`, which keeps straight what was straight.
    Reciprocal {
        /// Added.
        c1: f64,
        /// Divided by z.
        c2: f64,
    },
}

impl DepthKept {
    /// The kept depth of a point at `z`.
    #[must_use]
    pub fn of(self, z: f64) -> f64 {
        match self {
            Self::Nothing => 0.0,
            Self::Same => z,
            Self::Reciprocal { c1, c2 } => c1 + c2 / z,
        }
    }

    /// The depth that stands for a kept one.
    #[must_use]
    pub fn depth(self, kept: f64) -> f64 {
        match self {
            Self::Nothing | Self::Same => kept,
            Self::Reciprocal { c1, c2 } => c2 / (kept - c1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn angles_of_view() {
        let near = |a: f64, b: f64, by: f64| assert!((a - b).abs() < by, "{a} {b}");
        near(view_angle(320.0, 180.0), 83.27, 0.005);
        near(view_angle(320.0, 160.0), 90.0, 1e-9);
        near(view_angle(320.0, 208.5), 75.0, 0.02);
        near(view_angle(320.0, 174.6), 85.0, 0.02);
        near(view_angle(320.0, 128.0), 102.7, 0.05);
        near(view_angle(320.0, 256.0), 64.0, 0.05);
    }

    #[test]
    fn up_is_up() {
        let lens = Lens::new(320, 200);
        assert_eq!(lens.project([0, 0, 5]), Some([160, 100]));
        assert_eq!(lens.project([10, 10, 256]), Some([170, 90]));
        assert_eq!(lens.project([-10, -10, 512]), Some([155, 105]));
        assert_eq!(lens.project([0, 0, 0]), None);
        assert_eq!(lens.project([1, 1, -1]), None);
        let far = lens.project([i32::MAX, i32::MAX, 1]);
        assert_eq!(far, Some([160 + FARTHEST_PIXEL, 100 - FARTHEST_PIXEL]));
        let parallel = Lens { projection: Projection::Parallel { log_depth: 8 }, ..lens };
        assert_eq!(parallel.project([10, 20, 7]), Some([170, 80]));
    }

    #[test]
    fn a_point_just_beyond_the_plane_leaves_16_bits() {
        let lens = Lens { center: [0, 0], ..Lens::new(320, 200) };
        let [x, _] = lens.project([200, 0, 1]).expect("in front");
        assert_eq!([x, i32::from(x as i16)], [51200, -14336]);
    }

    #[test]
    fn depth_stays_straight_as_a_reciprocal() {
        let lens = Lens { center: [0, 0], ..Lens::new(320, 200) };
        let column = |x: f64, z: f64| lens.project_exact([x, 0.0, z])[0] * 100.0 / 256.0;
        let (a, b) = (column(-100.0, 100.0), column(100.0, 300.0));
        assert!((a + 100.0).abs() < 1e-9 && (b - 100.0 / 3.0).abs() < 1e-9);
        let middle = |kept: DepthKept| kept.depth((kept.of(100.0) + kept.of(300.0)) / 2.0);
        assert_eq!(middle(DepthKept::Same), 200.0);
        assert!((middle(DepthKept::Reciprocal { c1: 1.0, c2: -7.0 }) - 150.0).abs() < 1e-9);
        // The point of the segment that is seen in the middle is at depth 150.
        assert!((column(-50.0, 150.0) - (a + b) / 2.0).abs() < 1e-9);
        assert_eq!(DepthKept::Nothing.of(9.0), 0.0);
    }

    proptest! {
        #[test]
        fn pixels_are_the_nearest(x in -5000i32..5000, y in -5000i32..5000, z in 1i32..5000) {
            let lens = Lens::new(320, 200);
            let [column, row] = lens.project([x, y, z]).expect("in front");
            let [c, r] = lens.project_exact([x, y, z].map(f64::from));
            prop_assert!((f64::from(column) - c).abs() <= 0.5 && (f64::from(row) - r).abs() <= 0.5);
        }

        #[test]
        fn any_integers_project(p: [i32; 3]) {
            prop_assert_eq!(Lens::new(320, 200).project(p).is_some(), p[2] > 0);
        }
    }
}
