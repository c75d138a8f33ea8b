//! What a cluster sends, by direction.
//!
//! A matt polygon of area A, radiosity B and normal n sends `B A max(0, n.w)` in the direction w. The
//! clamped cosine is developed in Legendre polynomials up to the second, 1/4 + c/2 + 5 (3 c^2 - 1)/32,
//! which is within 0.1 of it (Ramamoorthi and Hanrahan 2001), so that sums over polygons of B A, B A n
//! and B A n n^T tell what all of them send together.

use senca_math::glam::{DVec3, Vec3, Vec4};

/// Sums over the polygons of a cluster. Four channels: red, green, blue and area alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    /// Of B A.
    pub(super) power: Vec4,
    /// Of B A n, an axis each.
    first: [Vec4; 3],
    /// Of B A n n^T: xx, yy, zz, xy, xz, yz.
    second: [Vec4; 6],
}

impl Moments {
    /// Adds a polygon that sends `power`, B A.
    pub(super) fn add_polygon(&mut self, power: Vec4, normal: DVec3) {
        let n = normal.as_vec3();
        self.power += power;
        for axis in 0..3 {
            self.first[axis] += power * n[axis];
        }
        for (sum, product) in self.second.iter_mut().zip(products(n)) {
            *sum += power * product;
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.power += other.power;
        for axis in 0..3 {
            self.first[axis] += other.first[axis];
        }
        for (sum, &more) in self.second.iter_mut().zip(&other.second) {
            *sum += more;
        }
    }

    /// What is sent in the direction of a unit vector, not negative.
    pub(super) fn towards(&self, direction: Vec3) -> Vec4 {
        let [x, y, z] = self.first;
        let first = x * direction.x + y * direction.y + z * direction.z;
        let [xx, yy, zz, xy, xz, yz] = products(direction);
        let [sxx, syy, szz, sxy, sxz, syz] = self.second;
        let second = sxx * xx + syy * yy + szz * zz + 2.0 * (sxy * xy + sxz * xz + syz * yz);
        let sum = 0.25 * self.power + 0.5 * first + (5.0 / 32.0) * (3.0 * second - self.power);
        sum.max(Vec4::ZERO)
    }
}

fn products(v: Vec3) -> [f32; 6] {
    [v.x * v.x, v.y * v.y, v.z * v.z, v.x * v.y, v.x * v.z, v.y * v.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_polygon_sends_about_a_clamped_cosine() {
        let mut moments = Moments::default();
        moments.add_polygon(Vec4::new(2.0, 1.0, 0.5, 1.0), DVec3::Z);
        for step in 0..=20 {
            let angle = std::f32::consts::PI * step as f32 / 20.0;
            let sent = moments.towards(Vec3::new(angle.sin(), 0.0, angle.cos()));
            assert!((sent.w - angle.cos().max(0.0)).abs() < 0.1, "{angle}: {sent}");
            assert!((sent.x - 2.0 * sent.w).abs() < 1e-6);
        }
    }

    #[test]
    fn a_ball_sends_evenly() {
        let mut moments = Moments::default();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            moments.add_polygon(Vec4::ONE, axis);
            moments.add_polygon(Vec4::ONE, -axis);
        }
        let [along, across] = [Vec3::X, Vec3::ONE.normalize()].map(|w| moments.towards(w).x);
        assert!((along - 1.5).abs() < 1e-6 && (across - 1.5).abs() < 1e-6, "{along} {across}");
    }
}
