//! Homogeneous points and projective maps.
//!
//! A homogeneous point is a direction in space of one dimension more: `(x, y, z, w)` and any multiple
//! of it are the same point, `(x/w, y/w, z/w)` when `w` is not zero, else a point at infinity.
//! Source: course text, sections 1.4 and 1.10.

use glam::{DMat4, DVec3, DVec4};

/// What a homogeneous point is in affine space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HomogeneousPoint {
    /// A point with affine coordinates.
    Finite(DVec3),
    /// The point at infinity in this direction, of any length.
    AtInfinity(DVec3),
    /// `(0, 0, 0, 0)`, or a coordinate that is not finite: no point at all.
    Undefined,
}

impl HomogeneousPoint {
    /// The affine coordinates, if there are any.
    #[must_use]
    pub fn finite(self) -> Option<DVec3> {
        match self {
            Self::Finite(point) => Some(point),
            _ => None,
        }
    }
}

/// Divides by the last coordinate. A quotient too large for `f64` counts as a point at infinity.
#[must_use]
pub fn normalized(h: DVec4) -> HomogeneousPoint {
    if !h.is_finite() || h == DVec4::ZERO {
        return HomogeneousPoint::Undefined;
    }
    let point = h.truncate() / h.w;
    if h.w != 0.0 && point.is_finite() {
        HomogeneousPoint::Finite(point)
    } else {
        HomogeneousPoint::AtInfinity(h.truncate())
    }
}

/// Whether two homogeneous points are the same point, up to `tolerance` as the sine of the angle
/// between them. Neither is the same as `(0, 0, 0, 0)`.
#[must_use]
pub fn same_point(a: DVec4, b: DVec4, tolerance: f64) -> bool {
    let (Some(a), Some(b)) = (a.try_normalize(), b.try_normalize()) else { return false };
    (a - b * a.dot(b)).length() <= tolerance
}

/// Whether two matrices are the same projective map, that is equal up to a factor, with `tolerance`
/// relative to their largest entries. A zero matrix is no map.
#[must_use]
pub fn same_map(a: &DMat4, b: &DMat4, tolerance: f64) -> bool {
    let (a, b) = (a.to_cols_array(), b.to_cols_array());
    let Some(pivot) = (0..16).max_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())) else { return false };
    if a[pivot] == 0.0 || b[pivot] == 0.0 {
        return false;
    }
    (0..16).all(|i| (a[i] / a[pivot] - b[i] / b[pivot]).abs() <= tolerance)
}

/// Whether the matrix is a collineation: finite and regular, so that it has an inverse.
///
/// "Regular" is judged by the determinant against the product of the column lengths, with a relative
/// bound of 1e-14, so that the answer does not depend on the unit of length.
#[must_use]
pub fn is_collineation(m: &DMat4) -> bool {
    let columns: f64 = (0..4).map(|i| m.col(i).length()).product();
    m.is_finite() && columns > 0.0 && m.determinant().abs() > 1e-14 * columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::vec3;
    use crate::transform::{central_projection_from_origin, central_projection_to_xy};

    #[test]
    fn division_knows_infinity() {
        assert_eq!(normalized(DVec4::new(2.0, 4.0, 6.0, 2.0)), HomogeneousPoint::Finite(vec3(1, 2, 3)));
        assert_eq!(normalized(DVec4::X), HomogeneousPoint::AtInfinity(DVec3::X));
        assert_eq!(normalized(DVec4::ZERO), HomogeneousPoint::Undefined);
        assert_eq!(normalized(DVec4::splat(f64::NAN)), HomogeneousPoint::Undefined);
        assert_eq!(
            normalized(DVec4::new(1e300, 0.0, 0.0, 1e-300)),
            HomogeneousPoint::AtInfinity(vec3(1, 0, 0) * 1e300)
        );
    }

    #[test]
    fn points_and_maps_are_equal_up_to_a_factor() {
        let p = DVec4::new(1.0, -2.0, 3.0, 0.5);
        assert!(same_point(p, p * -7.0, 1e-12));
        assert!(!same_point(p, p + DVec4::X, 1e-3) && !same_point(p, DVec4::ZERO, 1.0));
        let m = central_projection_to_xy(3.0);
        assert!(same_map(&m, &(m * -0.1), 1e-12));
        assert!(!same_map(&m, &DMat4::IDENTITY, 1e-3) && !same_map(&DMat4::ZERO, &m, 1.0));
    }

    #[test]
    fn a_collineation_is_regular() {
        assert!(is_collineation(&central_projection_to_xy(2.0)));
        assert!(is_collineation(&(DMat4::IDENTITY * 1e-6)));
        assert!(!is_collineation(&central_projection_from_origin(2.0)));
        assert!(!is_collineation(&(DMat4::IDENTITY * f64::NAN)));
    }
}
