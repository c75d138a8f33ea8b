//! What happens to a fragment after it has its colour: alpha test, stencil test, depth test, blending,
//! logic operations, masks (OpenGL 1.5, section 4.1).
//!
//! All formulas are here once, for one fragment or sixteen ([`Real`]); tests of bits and bytes are
//! written for one pixel, too, as the form to read.

use super::real::{Color, Real, clamped, constant};
use crate::state::{ColorBuffer, StencilBuffer};
use crate::{Enum, gl};

/// Whether `a` compares to `b` as told.
#[inline(always)]
pub(crate) fn compares<T: PartialOrd>(func: Enum, a: T, b: T) -> bool {
    match func {
        gl::NEVER => false,
        gl::LESS => a < b,
        gl::EQUAL => a == b,
        gl::LEQUAL => a <= b,
        gl::GREATER => a > b,
        gl::NOTEQUAL => a != b,
        gl::GEQUAL => a >= b,
        _ => true,
    }
}

/// The stencil value after an operation, all bits; the write mask is not heeded.
#[inline(always)]
pub(crate) fn stencil_after(op: Enum, value: u8, reference: u8) -> u8 {
    match op {
        gl::ZERO => 0,
        gl::REPLACE => reference,
        gl::INCR => value.saturating_add(1),
        gl::DECR => value.saturating_sub(1),
        gl::INCR_WRAP => value.wrapping_add(1),
        gl::DECR_WRAP => value.wrapping_sub(1),
        gl::INVERT => !value,
        _ => value,
    }
}

/// The stencil test of a draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stencil {
    pub(crate) func: Enum,
    /// Clamped to what 8 bits hold.
    pub(crate) reference: u8,
    pub(crate) value_mask: u8,
    pub(crate) write_mask: u8,
    pub(crate) fail: Enum,
    pub(crate) depth_fail: Enum,
    pub(crate) depth_pass: Enum,
}

impl Stencil {
    pub(crate) fn new(s: &StencilBuffer) -> Self {
        Self {
            func: s.func,
            reference: s.reference.clamp(0, 255) as u8,
            value_mask: s.value_mask as u8,
            write_mask: s.write_mask as u8,
            fail: s.fail,
            depth_fail: s.depth_fail,
            depth_pass: s.depth_pass,
        }
    }

    /// Whether depth must not be tested before: something happens to fragments that fail.
    pub(crate) fn needs_failures(&self) -> bool {
        self.write_mask != 0 && (self.fail != gl::KEEP || self.depth_fail != gl::KEEP)
    }

    pub(crate) fn passes(&self, stored: u8) -> bool {
        compares(self.func, self.reference & self.value_mask, stored & self.value_mask)
    }

    pub(crate) fn write(&self, op: Enum, stored: &mut u8) {
        let after = stencil_after(op, *stored, self.reference);
        *stored = *stored & !self.write_mask | after & self.write_mask;
    }
}

/// Blending of a draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blending {
    /// Source and destination factor of colour, then of alpha.
    pub(crate) factors: [Enum; 4],
    /// Of colour, of alpha.
    pub(crate) equations: [Enum; 2],
    pub(crate) color: [f32; 4],
}

impl Blending {
    pub(crate) fn new(c: &ColorBuffer) -> Self {
        Self { factors: c.blend_func, equations: c.blend_equation, color: c.blend_color }
    }

    /// The colour of a fragment, within [0, 1], mixed with the one stored.
    #[inline(always)]
    pub(crate) fn blended<R: Real>(&self, new: Color<R>, old: Color<R>) -> Color<R> {
        let [s, d, s_alpha, d_alpha] = self.factors;
        let (fs, fd) = (self.factor(s, new, old), self.factor(d, new, old));
        let (fs_alpha, fd_alpha) = if [s, d] == [s_alpha, d_alpha] {
            (fs[3], fd[3])
        } else {
            (self.factor(s_alpha, new, old)[3], self.factor(d_alpha, new, old)[3])
        };
        let [rgb, alpha] = self.equations;
        [
            equation(rgb, new[0], fs[0], old[0], fd[0]),
            equation(rgb, new[1], fs[1], old[1], fd[1]),
            equation(rgb, new[2], fs[2], old[2], fd[2]),
            equation(alpha, new[3], fs_alpha, old[3], fd_alpha),
        ]
    }

    #[inline(always)]
    fn factor<R: Real>(&self, factor: Enum, new: Color<R>, old: Color<R>) -> Color<R> {
        match factor {
            gl::ZERO => [new[0].like(0.0); 4],
            gl::SRC_COLOR => new,
            gl::ONE_MINUS_SRC_COLOR => inverse(new),
            gl::DST_COLOR => old,
            gl::ONE_MINUS_DST_COLOR => inverse(old),
            gl::SRC_ALPHA => [new[3]; 4],
            gl::ONE_MINUS_SRC_ALPHA => [new[3].one_minus(); 4],
            gl::DST_ALPHA => [old[3]; 4],
            gl::ONE_MINUS_DST_ALPHA => [old[3].one_minus(); 4],
            gl::CONSTANT_COLOR => constant(new[0], self.color),
            gl::ONE_MINUS_CONSTANT_COLOR => inverse(constant(new[0], self.color)),
            gl::CONSTANT_ALPHA => [new[0].like(self.color[3]); 4],
            gl::ONE_MINUS_CONSTANT_ALPHA => [new[0].like(1.0 - self.color[3]); 4],
            gl::SRC_ALPHA_SATURATE => {
                let least = new[3].least(old[3].one_minus());
                [least, least, least, new[3].like(1.0)]
            }
            _ => [new[0].like(1.0); 4],
        }
    }
}

/// 1 minus each component.
#[inline(always)]
pub(crate) fn inverse<R: Real>(c: Color<R>) -> Color<R> {
    [c[0].one_minus(), c[1].one_minus(), c[2].one_minus(), c[3].one_minus()]
}

#[inline(always)]
fn equation<R: Real>(equation: Enum, new: R, by_new: R, old: R, by_old: R) -> R {
    match equation {
        gl::FUNC_SUBTRACT => new * by_new - old * by_old,
        gl::FUNC_REVERSE_SUBTRACT => old * by_old - new * by_new,
        gl::MIN => new.least(old),
        gl::MAX => new.greatest(old),
        _ => new * by_new + old * by_old,
    }
}

/// A logic operation on bits.
#[inline(always)]
pub(crate) fn logic(op: Enum, s: u32, d: u32) -> u32 {
    match op {
        gl::CLEAR => 0,
        gl::AND => s & d,
        gl::AND_REVERSE => s & !d,
        gl::AND_INVERTED => !s & d,
        gl::NOOP => d,
        gl::XOR => s ^ d,
        gl::OR => s | d,
        gl::NOR => !(s | d),
        gl::EQUIV => !(s ^ d),
        gl::INVERT => !d,
        gl::OR_REVERSE => s | !d,
        gl::COPY_INVERTED => !s,
        gl::OR_INVERTED => !s | d,
        gl::NAND => !(s & d),
        gl::SET => !0,
        _ => s,
    }
}

/// How colours reach the buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColorWrite {
    pub(crate) blending: Option<Blending>,
    /// Instead of blending.
    pub(crate) logic_op: Option<Enum>,
    /// Red, green, blue, alpha.
    pub(crate) mask: [bool; 4],
}

impl ColorWrite {
    /// Bits of a packed colour that are written.
    pub(crate) fn bits(&self) -> u32 {
        (0..4).filter(|&k| self.mask[k]).fold(0, |bits, k| bits | 0xff << (8 * k))
    }

    /// The colour to be stored, as yet unmasked and within [0, 1].
    #[inline(always)]
    pub(crate) fn mixed<R: Real>(&self, new: Color<R>, old: Color<R>) -> Color<R> {
        let new = clamped(new);
        match &self.blending {
            Some(blending) => clamped(blending.blended(new, old)),
            None => new,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons() {
        let table = [
            (gl::NEVER, [false, false, false]),
            (gl::LESS, [true, false, false]),
            (gl::EQUAL, [false, true, false]),
            (gl::LEQUAL, [true, true, false]),
            (gl::GREATER, [false, false, true]),
            (gl::NOTEQUAL, [true, false, true]),
            (gl::GEQUAL, [false, true, true]),
            (gl::ALWAYS, [true, true, true]),
        ];
        for (func, expected) in table {
            assert_eq!([1, 2, 3].map(|a| compares(func, a, 2)), expected);
        }
    }

    #[test]
    fn stencil_operations_saturate_or_wrap() {
        let after = |op, v| stencil_after(op, v, 77);
        assert_eq!([gl::KEEP, gl::ZERO, gl::REPLACE].map(|op| after(op, 5)), [5, 0, 77]);
        assert_eq!(
            [after(gl::INCR, 255), after(gl::DECR, 0), after(gl::INCR, 7), after(gl::DECR, 7)],
            [255, 0, 8, 6]
        );
        assert_eq!(
            [after(gl::INCR_WRAP, 255), after(gl::DECR_WRAP, 0), after(gl::INVERT, 0x0f)],
            [0, 255, 0xf0]
        );
        let s = Stencil {
            func: gl::LESS,
            reference: 0x13,
            value_mask: 0x0f,
            write_mask: 0x3c,
            fail: gl::KEEP,
            depth_fail: gl::KEEP,
            depth_pass: gl::INVERT,
        };
        assert!(s.passes(0x04) && !s.passes(0x33) && !s.needs_failures());
        let mut stored = 0b1010_1010;
        s.write(gl::INVERT, &mut stored);
        assert_eq!(stored, 0b1001_0110);
    }

    #[test]
    fn blending_by_its_formulas() {
        let (new, old) = ([0.8, 0.4, 0.2, 0.5], [0.1, 0.6, 0.5, 0.25]);
        let blend = |factors, equations| {
            Blending { factors, equations, color: [0.3, 0.6, 0.9, 0.7] }.blended(new, old)
        };
        let close = |a: [f32; 4], b: [f32; 4]| {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} is not {b:?}");
        };
        let add = [gl::FUNC_ADD; 2];
        let over = [gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA, gl::SRC_ALPHA, gl::ONE_MINUS_SRC_ALPHA];
        close(blend(over, add), [0.45, 0.5, 0.35, 0.375]);
        let split = [gl::DST_COLOR, gl::ZERO, gl::ONE, gl::ONE];
        close(blend(split, add), [0.08, 0.24, 0.1, 0.75]);
        let ones = [gl::ONE; 4];
        close(blend(ones, [gl::FUNC_SUBTRACT, gl::FUNC_REVERSE_SUBTRACT]), [0.7, -0.2, -0.3, -0.25]);
        close(blend(over, [gl::MIN, gl::MAX]), [0.1, 0.4, 0.2, 0.5]);
        let by_constant = [
            gl::CONSTANT_COLOR,
            gl::ONE_MINUS_CONSTANT_ALPHA,
            gl::CONSTANT_COLOR,
            gl::ONE_MINUS_CONSTANT_ALPHA,
        ];
        close(blend(by_constant, add), [0.27, 0.42, 0.33, 0.425]);
        let saturate = [gl::SRC_ALPHA_SATURATE, gl::ZERO, gl::SRC_ALPHA_SATURATE, gl::ZERO];
        close(blend(saturate, add), [0.4, 0.2, 0.1, 0.5]);
    }

    #[test]
    fn sixteen_logic_operations() {
        let ops = [
            (gl::CLEAR, 0b0000),
            (gl::AND, 0b1000),
            (gl::AND_REVERSE, 0b0100),
            (gl::COPY, 0b1100),
            (gl::AND_INVERTED, 0b0010),
            (gl::NOOP, 0b1010),
            (gl::XOR, 0b0110),
            (gl::OR, 0b1110),
            (gl::NOR, 0b0001),
            (gl::EQUIV, 0b1001),
            (gl::INVERT, 0b0101),
            (gl::OR_REVERSE, 0b1101),
            (gl::COPY_INVERTED, 0b0011),
            (gl::OR_INVERTED, 0b1011),
            (gl::NAND, 0b0111),
            (gl::SET, 0b1111),
        ];
        for (op, expected) in ops {
            assert_eq!(logic(op, 0b1100, 0b1010) & 0b1111, expected, "{op:#x}");
        }
    }
}
