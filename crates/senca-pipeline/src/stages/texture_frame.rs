//! The transformation from a triangle in the scene to its picture.

use senca_math::glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

/// The unique affine map that takes the plane of a triangle to the plane of its texture, corner by
/// corner, as the product of three steps.
/// Source: course text, section 2.11, equations 2.22 to 2.29.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureFrame {
    /// T1: the first corner goes to the origin.
    pub t1: DMat4,
    /// T2: the frame of the triangle, x along its first edge, z along its normal.
    pub t2: DMat4,
    /// T3: within the plane to the texture; z is dropped.
    pub t3: DMat4,
    /// The three steps together.
    pub texture_from_world: DMat4,
}

impl TextureFrame {
    /// The map that takes `corners` (world) to `alignment` (texture coordinates). `None` when the
    /// corners have no area.
    #[must_use]
    pub fn new(corners: [DVec3; 3], alignment: [DVec2; 3]) -> Option<Self> {
        let (v2, v3) = (corners[1] - corners[0], corners[2] - corners[0]);
        let x = v2.try_normalize()?;
        let z = v2.cross(v3).try_normalize()?;
        let y = z.cross(x);
        let t1 = DMat4::from_translation(-corners[0]);
        let t2 = DMat4::from_mat3(DMat3::from_cols(x, y, z).transpose());
        // Corners in the frame: (0, 0), (d, 0), (e, h).
        let (d, e, h) = (v2.length(), v3.dot(x), v3.dot(y));
        let along_x = (alignment[1] - alignment[0]) / d;
        let along_y = (alignment[2] - alignment[0] - e * along_x) / h;
        let t3 = DMat4::from_cols(
            DVec4::new(along_x.x, along_x.y, 0.0, 0.0),
            DVec4::new(along_y.x, along_y.y, 0.0, 0.0),
            DVec4::ZERO,
            DVec4::new(alignment[0].x, alignment[0].y, 0.0, 1.0),
        );
        let texture_from_world = t3 * t2 * t1;
        texture_from_world.is_finite().then_some(Self { t1, t2, t3, texture_from_world })
    }

    /// Texture coordinates of a point of the triangle's plane.
    #[must_use]
    pub fn coordinates(&self, point_world: DVec3) -> DVec2 {
        self.texture_from_world.transform_point3(point_world).truncate()
    }
}

/// Position among `n` texels of coordinate `u`, 0 at the first texel and n - 1 at the last.
/// Source: course text, section 2.11, equation 2.30.
#[must_use]
pub fn texel_position(u: f64, n: u32) -> f64 {
    u * (f64::from(n) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> TextureFrame {
        let corners = [[1.0, 1.0, 1.0], [4.0, 5.0, 1.0], [1.0, 1.0, 3.0]].map(DVec3::from_array);
        let alignment = [[0.1, 0.2], [0.9, 0.2], [0.1, 0.8]].map(DVec2::from_array);
        TextureFrame::new(corners, alignment).expect("has area")
    }

    #[test]
    fn corners_in_the_frame_of_the_triangle() {
        let f = frame();
        for (world, expected) in
            [([1.0, 1.0, 1.0], [0.0, 0.0]), ([4.0, 5.0, 1.0], [5.0, 0.0]), ([1.0, 1.0, 3.0], [0.0, 2.0])]
        {
            let p = (f.t2 * f.t1).transform_point3(DVec3::from_array(world));
            assert!(p.abs_diff_eq(DVec3::new(expected[0], expected[1], 0.0), 1e-12), "{p}");
        }
    }

    #[test]
    fn matrices_in_the_rows_of_the_book() {
        let f = frame();
        assert!((f.t3.col(0).x - 0.16).abs() < 1e-12 && f.t3.col(0).y.abs() < 1e-12);
        assert!(f.t3.col(1).x.abs() < 1e-12 && (f.t3.col(1).y - 0.3).abs() < 1e-12);
        assert!(f.t3.col(3).abs_diff_eq(DVec4::new(0.1, 0.2, 0.0, 1.0), 1e-12));
        // The book's rows are the columns here.
        let rows =
            [[0.096, 0.0, 0.0, 0.0], [0.128, 0.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0], [-0.124, -0.1, 0.0, 1.0]];
        for (i, row) in rows.into_iter().enumerate() {
            let column = f.texture_from_world.col(i);
            assert!(column.abs_diff_eq(DVec4::from_array(row), 1e-12), "row {i}: {column}");
        }
    }

    #[test]
    fn points_of_the_triangle() {
        let f = frame();
        let centroid = DVec3::new(2.0, 7.0 / 3.0, 5.0 / 3.0);
        assert!(f.coordinates(centroid).abs_diff_eq(DVec2::new(11.0 / 30.0, 0.4), 1e-12));
        let middle = DVec3::new(2.5, 3.0, 2.0);
        assert!(f.coordinates(middle).abs_diff_eq(DVec2::new(0.5, 0.5), 1e-12));
    }

    #[test]
    fn texels_run_from_the_first_to_the_last() {
        for (u, n, expected) in [(0.0, 256, 0.0), (0.5, 256, 127.5), (1.0, 256, 255.0), (0.25, 64, 15.75)] {
            assert_eq!(texel_position(u, n), expected);
        }
    }

    #[test]
    fn a_triangle_without_area_has_no_frame() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert!(TextureFrame::new(line, [DVec2::ZERO, DVec2::X, DVec2::Y]).is_none());
    }
}
