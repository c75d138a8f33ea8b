//! Angles in one byte, and tables of their sines.
//!
//! The circle has 256 parts, so that an angle in a byte comes round by itself and no test is needed.
//! Source: Savchenko 1995, "Transformation order" and the listing of `T_init_math`.

use std::f64::consts::TAU;

use super::fixed::Fixed;

/// Parts of the circle in a radian as the text prints it (`T_RADS`).
///
/// `256 / 2 pi` is 40.743665432: the constant is 1.2e-6 too small, which makes the cosine of a right angle -4.7e-8.
pub const PARTS_PER_RADIAN: f64 = 40.743_664_2;

/// An angle in parts of 256 of the circle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Angle(pub u8);

impl Angle {
    /// A quarter of the circle.
    pub const QUARTER: Self = Self(64);

    /// This angle turned further by `parts`, any number of times round.
    #[must_use]
    pub const fn turned(self, parts: i32) -> Self {
        Self(self.0.wrapping_add(parts as u8))
    }

    /// The exact angle in radians, 0 to 2 pi.
    #[must_use]
    pub fn radians(self) -> f64 {
        f64::from(self.0) * TAU / 256.0
    }
}

/// The three angles of a rotation: the heading first, then the pitch, then the roll, each of what the one before it made.
///
/// So one first chooses a direction, then lifts the head, then tilts it; a head that is lifted first would
/// no longer turn parallel to the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Angles {
    /// `gam`: about Y, in the plane of Z and X.
    pub heading: Angle,
    /// `bet`: about X, in the plane of Z and Y.
    pub pitch: Angle,
    /// `alp`: about Z, in the plane of X and Y.
    pub roll: Angle,
}

impl Angles {
    /// Angles in parts of 256, in the order of the parameters of `T_set_rotation_gam_bet_alp`, which is not that of its
    /// name.
    #[must_use]
    pub const fn alp_bet_gam(alp: u8, bet: u8, gam: u8) -> Self {
        Self { heading: Angle(gam), pitch: Angle(bet), roll: Angle(alp) }
    }
}

/// Sine and cosine of each of the 256 angles (`T_sin`, `T_cos`).
#[derive(Clone, Debug)]
pub struct Tables<T> {
    sin: [T; 256],
    cos: [T; 256],
}

impl<T: Copy> Tables<T> {
    fn of(radians: impl Fn(f64) -> f64, number: impl Fn(f64) -> T) -> Self {
        let angle = |i: usize| radians(i as f64);
        Self {
            sin: std::array::from_fn(|i| number(angle(i).sin())),
            cos: std::array::from_fn(|i| number(angle(i).cos())),
        }
    }

    /// The sine.
    #[must_use]
    pub fn sin(&self, angle: Angle) -> T {
        self.sin[usize::from(angle.0)]
    }

    /// The cosine.
    #[must_use]
    pub fn cos(&self, angle: Angle) -> T {
        self.cos[usize::from(angle.0)]
    }
}

impl Tables<f32> {
    /// The tables of the floating-point library, with the constant of the text (`T_init_math`).
    #[must_use]
    pub fn float() -> Self {
        Self::of(|i| i / PARTS_PER_RADIAN, |v| v as f32)
    }
}

impl<const P: u32> Tables<Fixed<P>> {
    /// The tables of the fixed-point library, with the constant of the text (`T_init_math`).
    #[must_use]
    pub fn fixed() -> Self {
        Self::of(|i| i / PARTS_PER_RADIAN, |v| Fixed::from_unit(f64::from(v as f32)))
    }
}

impl Tables<f64> {
    /// Tables of exact angles in double precision, for the reference.
    #[must_use]
    pub fn exact() -> Self {
        let mut tables = Self::of(|i| i * TAU / 256.0, |v| v);
        // At right angles the numbers are known.
        for (i, sine) in [(0, 0.0), (64, 1.0), (128, 0.0), (192, -1.0)] {
            tables.sin[i] = sine;
            tables.cos[(i + 192) % 256] = sine;
        }
        tables
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circle_closes_by_itself() {
        assert_eq!(Angle(255).turned(1), Angle(0));
        assert_eq!(Angle(0).turned(-1), Angle(255));
        assert_eq!(Angle(7).turned(256 * 1000), Angle(7));
        assert_eq!(Angle(0).turned(i32::MIN), Angle(0));
    }

    #[test]
    fn the_constant_of_the_text_is_slightly_off() {
        assert!((256.0 / TAU - 40.743_665_432).abs() < 1e-9);
        assert!((256.0 / TAU - PARTS_PER_RADIAN - 1.2e-6).abs() < 5e-8);
        let cos = Tables::float().cos(Angle::QUARTER);
        assert!((f64::from(cos) + 4.7e-8).abs() < 1e-9, "{cos}");
        assert_eq!(Tables::exact().cos(Angle::QUARTER), 0.0);
        assert_eq!(Tables::exact().cos(Angle(0)), 1.0);
        assert_eq!(Tables::exact().cos(Angle(128)), -1.0);
    }

    #[test]
    fn the_tables_agree() {
        let (float, fixed, exact) = (Tables::float(), Tables::<Fixed<10>>::fixed(), Tables::exact());
        for i in 0..=255 {
            let a = Angle(i);
            assert!((f64::from(float.sin(a)) - exact.sin(a)).abs() < 2.5e-7);
            assert!((fixed.cos(a).to_f64() - exact.cos(a)).abs() <= 1.0 / 1024.0);
            assert!((exact.sin(a) - a.radians().sin()).abs() < 1e-15);
        }
    }
}
