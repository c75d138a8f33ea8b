//! The eight number types of OpenGL's commands and what their values mean (OpenGL 1.5, table 2.4 and
//! section 2.13.1).

/// A number as OpenGL's commands take it: signed and unsigned integers of 8, 16 and 32 bits, and
/// floating point of 32 and 64.
pub trait Component: Copy {
    /// The number itself.
    fn value(self) -> f32;

    /// The number as a colour or a normal: integers are spread over [0, 1] if unsigned and over
    /// [-1, 1], as (2c + 1) / (2^b - 1), if signed; floating point is taken as it is.
    fn normalized(self) -> f32;
}

macro_rules! integers {
    ($($t:ty: $signed:expr),*) => {$(
        impl Component for $t {
            #[inline]
            fn value(self) -> f32 {
                self as f32
            }

            #[inline]
            fn normalized(self) -> f32 {
                if $signed {
                    let range = (1u64 << <$t>::BITS) - 1;
                    ((2.0 * f64::from(self) + 1.0) / range as f64) as f32
                } else {
                    (f64::from(self) / f64::from(<$t>::MAX)) as f32
                }
            }
        }
    )*};
}

integers!(i8: true, i16: true, i32: true, u8: false, u16: false, u32: false);

impl Component for f32 {
    #[inline]
    fn value(self) -> f32 {
        self
    }

    #[inline]
    fn normalized(self) -> f32 {
        self
    }
}

impl Component for f64 {
    #[inline]
    fn value(self) -> f32 {
        self as f32
    }

    #[inline]
    fn normalized(self) -> f32 {
        self as f32
    }
}

/// One to four coordinates, with 0, 0, 1 for y, z, w where they are not given.
#[inline]
pub(crate) fn coordinates<T: Component, const N: usize>(v: [T; N]) -> [f32; 4] {
    const { assert!(N >= 1 && N <= 4, "OpenGL has one to four coordinates") }
    let mut all = [0.0, 0.0, 0.0, 1.0];
    for (to, from) in all.iter_mut().zip(v) {
        *to = from.value();
    }
    all
}

/// Three or four colour components, with alpha 1 where it is not given.
#[inline]
pub(crate) fn color<T: Component, const N: usize>(v: [T; N]) -> [f32; 4] {
    const { assert!(N == 3 || N == 4, "a colour has three or four components") }
    let mut all = [0.0, 0.0, 0.0, 1.0];
    for (to, from) in all.iter_mut().zip(v) {
        *to = from.normalized();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_spread_over_their_range() {
        assert_eq!([u8::MAX.normalized(), 0u8.normalized()], [1.0, 0.0]);
        assert_eq!([i8::MAX.normalized(), i8::MIN.normalized()], [1.0, -1.0]);
        assert_eq!(0i8.normalized(), 1.0 / 255.0);
        assert_eq!([i32::MAX.normalized(), i32::MIN.normalized()], [1.0, -1.0]);
        assert_eq!(u32::MAX.normalized(), 1.0);
        assert_eq!([(-7i16).value(), 2.5f64.value()], [-7.0, 2.5]);
    }

    #[test]
    fn what_is_not_given_has_its_default() {
        assert_eq!(coordinates([2i16, 3]), [2.0, 3.0, 0.0, 1.0]);
        assert_eq!(coordinates([2.3, 1.0, -2.2, 2.0]), [2.3, 1.0, -2.2, 2.0]);
        assert_eq!(color([255u8, 0, 0]), [1.0, 0.0, 0.0, 1.0]);
    }
}
