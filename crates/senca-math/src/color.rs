//! Colour: linear light, its sRGB encoding, and their conversions.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

/// Linear light in the primaries of sRGB (IEC 61966-2-1). Components may exceed 1; 1 is the
/// brightest white a display shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LinearRgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

/// Display-referred colour, 8 bits a channel, sRGB encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Srgb8 {
    /// Red, 0 to 255.
    pub r: u8,
    /// Green, 0 to 255.
    pub g: u8,
    /// Blue, 0 to 255.
    pub b: u8,
}

impl LinearRgb {
    /// No light.
    pub const BLACK: Self = Self::splat(0.0);
    /// Display white.
    pub const WHITE: Self = Self::splat(1.0);

    /// A colour from its three components.
    #[must_use]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// A grey.
    #[must_use]
    pub const fn splat(v: f32) -> Self {
        Self { r: v, g: v, b: v }
    }

    /// From an array in the order red, green, blue.
    #[must_use]
    pub const fn from_array([r, g, b]: [f32; 3]) -> Self {
        Self { r, g, b }
    }

    /// To an array in the order red, green, blue.
    #[must_use]
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// Each component through `f`.
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// Relative luminance, with the weights of ITU-R BT.709.
    #[must_use]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// The largest component.
    #[must_use]
    pub fn max_component(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// `self` at `t = 0`, `other` at `t = 1`.
    #[must_use]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        self * (1.0 - t) + other * t
    }

    /// Whether no component is NaN or infinite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Encoded for an 8-bit display; components outside [0, 1] are clamped, NaN becomes 0.
    #[must_use]
    pub fn to_srgb8(self) -> Srgb8 {
        let encode = |v: f32| (srgb_from_linear(v.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
        Srgb8 { r: encode(self.r), g: encode(self.g), b: encode(self.b) }
    }
}

impl Srgb8 {
    /// Decoded to linear light.
    #[must_use]
    pub fn to_linear(self) -> LinearRgb {
        let decode = |v: u8| linear_from_srgb(f32::from(v) / 255.0);
        LinearRgb::new(decode(self.r), decode(self.g), decode(self.b))
    }
}

/// Encodes linear light in [0, 1] (IEC 61966-2-1). Continued outside by the same formula.
#[must_use]
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Decodes an sRGB value in [0, 1] to linear light (IEC 61966-2-1).
#[must_use]
pub fn linear_from_srgb(v: f32) -> f32 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

impl Add for LinearRgb {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl AddAssign for LinearRgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for LinearRgb {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::new(self.r - o.r, self.g - o.g, self.b - o.b)
    }
}

/// Component by component: light times reflectance.
impl Mul for LinearRgb {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl Mul<f32> for LinearRgb {
    type Output = Self;
    #[inline]
    fn mul(self, s: f32) -> Self {
        Self::new(self.r * s, self.g * s, self.b * s)
    }
}

impl MulAssign<f32> for LinearRgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_8_bit_colour_survives_decoding_and_encoding() {
        for v in 0..=255 {
            let c = Srgb8 { r: v, g: 255 - v, b: 7 };
            assert_eq!(c.to_linear().to_srgb8(), c);
        }
    }

    #[test]
    fn out_of_range_light_clamps_and_nan_is_black() {
        assert_eq!(LinearRgb::new(9.0, -1.0, f32::NAN).to_srgb8(), Srgb8 { r: 255, g: 0, b: 0 });
    }
}
