//! Changes of coordinate system, and the test for orthonormality.
//!
//! A change of frame leaves every point in place and gives it new coordinates, so it is the inverse
//! of the motion that takes the old frame to the new one. Source: course text, sections 1.2 and 1.3.

use glam::{DMat3, DMat4, DVec3};

use crate::transform::{Axis, rotation};

/// New coordinates after the origin moved to `origin` and the axes stayed.
#[must_use]
pub fn new_from_old_by_origin(origin: DVec3) -> DMat4 {
    DMat4::from_translation(-origin)
}

/// New coordinates when the axes change and the origin stays, from the old basis written in the new
/// one: column i of `old_axes_in_new` is old basis vector i.
///
/// (The book's matrix A, which multiplies rows from the right, has these vectors as rows.)
#[must_use]
pub fn new_from_old_by_old_axes(old_axes_in_new: DMat3) -> DMat3 {
    old_axes_in_new
}

/// New coordinates when the axes change and the origin stays, from the new basis written in the old
/// frame, which is how a frame is usually given; `None` when the vectors span no space.
///
/// An orthonormal basis is inverted by transposing.
#[must_use]
pub fn new_from_old_by_new_axes(new_axes_in_old: DMat3) -> Option<DMat3> {
    if orthonormality(&new_axes_in_old, 1e-14).is_orthonormal() {
        return Some(new_axes_in_old.transpose());
    }
    let inverse = new_axes_in_old.inverse();
    (new_axes_in_old.determinant() != 0.0 && inverse.is_finite()).then_some(inverse)
}

/// New coordinates in the frame with this origin and these axes, all given in the old frame; `None`
/// when the axes span no space.
#[must_use]
pub fn new_from_old(origin: DVec3, new_axes_in_old: DMat3) -> Option<DMat4> {
    let turn = new_from_old_by_new_axes(new_axes_in_old)?;
    Some(DMat4::from_mat3(turn) * new_from_old_by_origin(origin))
}

/// New coordinates after the frame itself turned by `angle` radians about one of its axes,
/// counter-clockwise: points seem to turn the other way.
#[must_use]
pub fn new_from_old_by_turn(axis: Axis, angle: f64) -> DMat4 {
    rotation(axis, -angle)
}

/// New coordinates after the frame turned about its x, then about its new y, then about its new z
/// axis, by the three angles in radians. Source: course text, section 1.3, example 1.2.
#[must_use]
pub fn new_from_old_by_turns(angles: DVec3) -> DMat4 {
    new_from_old_by_turn(Axis::Z, angles.z)
        * new_from_old_by_turn(Axis::Y, angles.y)
        * new_from_old_by_turn(Axis::X, angles.x)
}

/// Right-handed orthonormal axes with z along `z` and x at right angles to `up` and z; they are
/// returned as columns. `None` when either vector is zero or not finite, or when the two are parallel.
///
/// Source: course text, section 1.6; 1991 thesis, section 2.4.4.1.
#[must_use]
pub fn axes_from_z_and_up(z: DVec3, up: DVec3) -> Option<DMat3> {
    let z_axis = unit(z)?;
    let x = unit(up)?.cross(z_axis);
    // Below this sine the direction of x is mostly rounding error.
    if x.length() < 1e-10 {
        return None;
    }
    let x_axis = x.normalize();
    Some(DMat3::from_cols(x_axis, z_axis.cross(x_axis).normalize(), z_axis))
}

/// The vector at length 1, also where the squares of its coordinates would overflow or vanish;
/// `None` for a zero or not finite vector.
#[must_use]
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (v.is_finite() && largest > 0.0).then(|| (v / largest).normalize())
}

/// What the test for orthonormality found. See [`orthonormality`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orthonormality {
    /// Lengths and angles are kept, handedness too: a rotation. The inverse is the transpose.
    Rotation,
    /// Lengths and angles are kept, handedness changes. The inverse is the transpose.
    Reflection,
    /// Lengths or angles change; the largest entry of `A^T A - I` in absolute value.
    No {
        /// How far off, 0 for an orthonormal matrix.
        error: f64,
    },
}

impl Orthonormality {
    /// Whether lengths and angles are kept.
    #[must_use]
    pub fn is_orthonormal(self) -> bool {
        !matches!(self, Self::No { .. })
    }
}

/// Tests `A^T A = I`, which is necessary and sufficient for lengths and angles to be kept, entry by
/// entry up to `tolerance`. Source: course text, section 1.3.
#[must_use]
pub fn orthonormality(m: &DMat3, tolerance: f64) -> Orthonormality {
    let difference = m.transpose() * *m - DMat3::IDENTITY;
    let error = difference
        .to_cols_array()
        .into_iter()
        .fold(0.0, |worst, d: f64| if d.is_nan() { f64::INFINITY } else { d.abs().max(worst) });
    match error <= tolerance {
        false => Orthonormality::No { error },
        true if m.determinant() > 0.0 => Orthonormality::Rotation,
        true => Orthonormality::Reflection,
    }
}

/// Cosine of the angle between two vectors; 0 when one of them is zero.
#[must_use]
pub fn cosine_between(a: DVec3, b: DVec3) -> f64 {
    match (unit(a), unit(b)) {
        (Some(a), Some(b)) => a.dot(b).clamp(-1.0, 1.0),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_SQRT_2;

    use proptest::prelude::*;

    use super::*;
    use crate::test_support::{assert_close3, assert_matrix, vec3};

    #[test]
    fn a_turned_frame_turns_points_back() {
        let m = new_from_old_by_turn(Axis::Z, 30f64.to_radians());
        assert_close3(m.transform_point3(DVec3::X), DVec3::new(0.866025, -0.5, 0.0), 5e-7);
        assert_close3(m.transform_point3(vec3(2, 1, 5)), DVec3::new(2.232051, -0.133975, 5.0), 5e-7);
        let (s, c) = 30f64.to_radians().sin_cos();
        let axes = DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z);
        assert!(DMat4::from_mat3(new_from_old_by_new_axes(axes).unwrap()).abs_diff_eq(m, 1e-15));
    }

    #[test]
    fn three_frame_turns_give_the_worked_matrix() {
        let m = new_from_old_by_turns(DVec3::new(30.0, 45.0, 60.0).map(f64::to_radians));
        let rows = [
            [0.353553, -0.612372, FRAC_1_SQRT_2, 0.0],
            [0.926777, 0.126826, -0.353553, 0.0],
            [0.126826, 0.780330, 0.612372, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_matrix(&m, rows, 5e-7);
        let turned = m.transform_point3(vec3(1, 2, 3));
        assert_close3(turned, DVec3::new(2.587586, 1.982271, 1.837117), 5e-7);
        assert!((turned.length() - 3.741657).abs() < 5e-7);
    }

    #[test]
    fn three_frame_turns_give_the_product_of_the_printed_matrices() {
        let angles = DVec3::new(0.3, -1.2, 2.5);
        let ((sa, ca), (sb, cb), (sg, cg)) = (angles.x.sin_cos(), angles.y.sin_cos(), angles.z.sin_cos());
        let rows = [
            [cb * cg, -cb * sg, sb, 0.0],
            [sa * sb * cg + ca * sg, -sa * sb * sg + ca * cg, -sa * cb, 0.0],
            [sa * sg - ca * sb * cg, sa * cg + ca * sb * sg, ca * cb, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        assert_matrix(&new_from_old_by_turns(angles), rows, 1e-15);
    }

    #[test]
    fn a_skew_frame_gives_coordinates_in_its_basis() {
        let axes = DMat3::from_cols(vec3(2, 0, 0), vec3(1, 1, 0), vec3(0, 1, 4));
        let m = new_from_old(vec3(1, 1, 1), axes).unwrap();
        let p = vec3(1, 1, 1) + 3.0 * axes.x_axis - 2.0 * axes.y_axis + 5.0 * axes.z_axis;
        assert_close3(m.transform_point3(p), vec3(3, -2, 5), 1e-14);
        assert!(new_from_old(DVec3::ZERO, DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z)).is_none());
        let old_in_new = axes.inverse();
        assert!(new_from_old_by_old_axes(old_in_new).abs_diff_eq(DMat3::from_mat4(m), 1e-15));
    }

    #[test]
    fn orthonormality_names_its_consequences() {
        assert_eq!(orthonormality(&DMat3::IDENTITY, 0.0), Orthonormality::Rotation);
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        assert_eq!(orthonormality(&mirror, 0.0), Orthonormality::Reflection);
        assert_eq!(orthonormality(&(DMat3::IDENTITY * 2.0), 1e-9), Orthonormality::No { error: 3.0 });
        assert!(!orthonormality(&(DMat3::IDENTITY * f64::NAN), 1e9).is_orthonormal());
    }

    #[test]
    fn axes_need_two_directions() {
        assert_eq!(axes_from_z_and_up(DVec3::Z, DVec3::Y), Some(DMat3::IDENTITY));
        assert!(axes_from_z_and_up(DVec3::Z, DVec3::Z * -2.0).is_none());
        assert!(axes_from_z_and_up(DVec3::ZERO, DVec3::Z).is_none());
        assert!(axes_from_z_and_up(DVec3::NAN, DVec3::Z).is_none());
        assert_eq!(axes_from_z_and_up(DVec3::Z * 1e300, DVec3::Y * 1e-300), Some(DMat3::IDENTITY));
        assert!((cosine_between(vec3(1, 1, 0), vec3(0, 3, 0)) - 0.5f64.sqrt()).abs() < 1e-15);
        assert_eq!(cosine_between(DVec3::ZERO, DVec3::X), 0.0);
    }

    proptest! {
        #[test]
        fn frame_axes_are_orthonormal(
            z in prop::array::uniform3(-9.0..9.0f64),
            up in prop::array::uniform3(-9.0..9.0f64),
        ) {
            if let Some(axes) = axes_from_z_and_up(z.into(), up.into()) {
                prop_assert_eq!(orthonormality(&axes, 1e-12), Orthonormality::Rotation);
                prop_assert!(axes.x_axis.dot(up.into()).abs() < 1e-12);
            }
        }
    }
}
