//! The catalogue of elementary transforms, and how they compose.
//!
//! Every function returns a matrix for column vectors: `point_new = m * point_old`. The books print
//! the same maps for row vectors, that is transposed, and multiply them in the order of application;
//! [`compose`] takes that order and [`crate::row_matrix`] prints that layout.
//!
//! Source: course text, section 1.4; 1991 thesis, sections 2.1 to 2.4.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// One of the three coordinate axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// First axis.
    X,
    /// Second axis.
    Y,
    /// Third axis.
    Z,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Unit vector along the axis.
    #[must_use]
    pub fn unit(self) -> DVec3 {
        DVec3::AXES[self.index()]
    }
}

/// Transforms in the order of application, as one matrix: the first of them acts first.
///
/// The books' `T = T1 T2 ... Tn` for row vectors is `compose([t1, t2, ..., tn])`. None at all gives
/// the identity. Source: course text, section 1.4; 1991 thesis, section 2.3.
#[must_use]
pub fn compose(in_order_of_application: impl IntoIterator<Item = DMat4>) -> DMat4 {
    in_order_of_application.into_iter().fold(DMat4::IDENTITY, |product, next| next * product)
}

/// Moves every point by `offset`.
#[must_use]
pub fn translation(offset: DVec3) -> DMat4 {
    DMat4::from_translation(offset)
}

/// Stretches along one axis by `factor`, with the origin fixed.
#[must_use]
pub fn scale_along(axis: Axis, factor: f64) -> DMat4 {
    let mut factors = DVec3::ONE;
    factors[axis.index()] = factor;
    DMat4::from_scale(factors)
}

/// Stretches along the three axes, with the origin fixed.
#[must_use]
pub fn scale(factors: DVec3) -> DMat4 {
    DMat4::from_scale(factors)
}

/// Scales evenly by `factor`, not zero, through the last coordinate: `(x, y, z, w)` becomes
/// `(x, y, z, w / factor)`, which is the same point as `(factor x, ...)` after division.
///
/// Source: course text, section 1.4; 1991 thesis, section 2.1.2.
#[must_use]
pub fn uniform_scale_by_w(factor: f64) -> DMat4 {
    DMat4::from_diagonal(DVec4::new(1.0, 1.0, 1.0, 1.0 / factor))
}

/// Adds `slope` times the coordinate along `by` to the coordinate along `moved`.
///
/// `shear(Axis::Y, Axis::X, a)` is `(x, y + a x, z)`: the planes `y = const` tilt by the tangent `a`,
/// the planes of constant x and z keep their place. All six pairs of different axes are shears; with
/// equal axes it is a scale by `1 + slope`. Source: course text, section 1.4.
#[must_use]
pub fn shear(moved: Axis, by: Axis, slope: f64) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.col_mut(by.index())[moved.index()] += slope;
    m
}

/// Shear of x and y along z: `(x + shx z, y + shy z, z)`. Source: 1991 thesis, section 2.2.6.
#[must_use]
pub fn shear_xy(slopes: DVec2) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.z_axis = DVec4::new(slopes.x, slopes.y, 1.0, 0.0);
    m
}

/// Turns points about an axis by an angle in radians, counter-clockwise seen from the axis' tip.
#[must_use]
pub fn rotation(axis: Axis, angle: f64) -> DMat4 {
    match axis {
        Axis::X => DMat4::from_rotation_x(angle),
        Axis::Y => DMat4::from_rotation_y(angle),
        Axis::Z => DMat4::from_rotation_z(angle),
    }
}

/// Central projection onto the plane xy from the centre `(0, 0, focal)`, `focal` not zero.
///
/// x and y are the true projection; z becomes `focal z / (focal - z)`, which keeps the order of depth
/// and makes the map regular. Points of the plane `z = focal` go to infinity.
/// Source: course text, section 1.4.
#[must_use]
pub fn central_projection_to_xy(focal: f64) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.z_axis.w = -1.0 / focal;
    m
}

/// Central projection onto the plane `z = focal`, not zero, from the origin.
///
/// Exact, but every depth collapses to `focal`: the map is singular, no collineation.
/// Source: course text, section 1.4, example 1.6.
#[must_use]
pub fn central_projection_from_origin(focal: f64) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.z_axis.w = 1.0 / focal;
    m.w_axis.w = 0.0;
    m
}

/// Central projection onto the plane yz from the centre `(focal, 0, 0)`, `focal` not zero; the
/// counterpart of [`central_projection_to_xy`]. Source: course text, section 1.4, example 1.8.
#[must_use]
pub fn central_projection_to_yz(focal: f64) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.x_axis.w = -1.0 / focal;
    m
}

/// Parallel projection onto the plane xy along `direction`, keeping z for visibility.
///
/// `None` when the direction lies in the plane (`direction.z == 0`) or is not finite.
/// Source: course text, section 1.4.
#[must_use]
pub fn parallel_projection_to_xy(direction: DVec3) -> Option<DMat4> {
    let slopes = -direction.truncate() / direction.z;
    (direction.z != 0.0 && slopes.is_finite()).then(|| shear_xy(slopes))
}

/// Parallel projection along z that flattens everything onto the plane `z = plane_z`. Singular.
/// Source: 1991 thesis, section 2.4.1.
#[must_use]
pub fn flatten_to_plane_z(plane_z: f64) -> DMat4 {
    let mut m = DMat4::IDENTITY;
    m.z_axis.z = 0.0;
    m.w_axis.z = plane_z;
    m
}

/// Perspective for an eye at `distance`, not zero, in front of the plane `z = 0`, with z growing away
/// from the eye: x and y are divided by `1 + z / distance`. Source: 1991 thesis, section 2.4.2.
#[must_use]
pub fn simple_perspective(distance: f64) -> DMat4 {
    central_projection_to_xy(-distance)
}

/// Object to world in the order of the 1991 scene file: turn about x, then y, then z (radians), then
/// scale along the *world* axes, then move. An uneven scale therefore shears a turned object.
/// Source: 1991 thesis, section 2.3 and program.
#[must_use]
pub fn world_from_object_1991(scale: DVec3, turns: DVec3, offset: DVec3) -> DMat4 {
    compose([
        rotation(Axis::X, turns.x),
        rotation(Axis::Y, turns.y),
        rotation(Axis::Z, turns.z),
        DMat4::from_scale(scale),
        translation(offset),
    ])
}

/// The affine map `x -> linear x + offset` as a projective map. For the books' row form
/// `y = x A + t` give the transpose of A. Source: course text, section 1.4.
#[must_use]
pub fn projective_from_affine(linear: DMat3, offset: DVec3) -> DMat4 {
    let mut m = DMat4::from_mat3(linear);
    m.w_axis = offset.extend(1.0);
    m
}

/// The linear part and the offset of an affine map; `None` when the map is truly projective, that is
/// when its last row is not `(0, 0, 0, k)` with `k` not zero.
#[must_use]
pub fn affine_from_projective(m: &DMat4) -> Option<(DMat3, DVec3)> {
    let k = m.w_axis.w;
    if m.row(3).truncate() != DVec3::ZERO || k == 0.0 {
        return None;
    }
    Some((DMat3::from_mat4(*m) * (1.0 / k), m.w_axis.truncate() / k))
}

/// The matrix that takes normals along when points are taken by `linear`: its inverse transpose up to
/// a positive factor, which is the matrix of cofactors times the sign of the determinant.
///
/// It needs no inverse, so a map that flattens space (a zero scale) still gives the right normal
/// where there is one. A mirroring map keeps outward normals outward. Results are not unit vectors.
#[must_use]
pub fn normal_matrix(linear: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(cofactors.x_axis) < 0.0 { cofactors * -1.0 } else { cofactors }
}

#[cfg(test)]
mod tests;
