//! The same in double precision and without steps: what the integers are measured against.
//!
//! Points are rotated by exact angles, cut at the plane by proportion, projected without rounding; a row begins and ends where
//! the edges cross it, and the texture is looked up by the quotient at every pixel. A pixel is the point at its whole-numbered
//! column and row, as in the library.

use super::project::Lens;
use super::texture::TexturePlane;

/// The part of a polygon with `z >= plane`. A corner is x, y, z and whatever else goes along linearly.
#[must_use]
pub fn clip_exact<const N: usize>(corners: &[[f64; N]], plane: f64) -> Vec<[f64; N]> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if a[2] >= plane {
            kept.push(a);
        }
        if (a[2] >= plane) != (b[2] >= plane) {
            let t = (plane - a[2]) / (b[2] - a[2]);
            let mut cut: [f64; N] = std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t);
            cut[2] = plane;
            kept.push(cut);
        }
    }
    kept
}

/// Corners with column and row in place of x and y.
#[must_use]
pub fn project_corners<const N: usize>(corners: &[[f64; N]], lens: Lens) -> Vec<[f64; N]> {
    let project = |corner: &[f64; N]| {
        let [column, row] = lens.project_exact([corner[0], corner[1], corner[2]]);
        let mut seen = *corner;
        (seen[0], seen[1]) = (column, row);
        seen
    };
    corners.iter().map(project).collect()
}

/// Calls `visit` with column, row and values for each pixel within a convex polygon on the screen. The values are linear
/// on the screen along edges and rows, as Gouraud's are.
pub fn for_each_pixel_within<const N: usize>(
    corners: &[[f64; N]],
    size: [usize; 2],
    mut visit: impl FnMut(i32, i32, [f64; N]),
) {
    if corners.iter().flatten().any(|v| !v.is_finite()) {
        return;
    }
    let rows = corners.iter().map(|c| c[1]);
    let (top, bottom) = rows.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    let first = top.ceil().max(0.0) as i32;
    let last = bottom.floor().min(size[1] as f64 - 1.0) as i32;
    for y in first..=last {
        let Some([start, end]) = ends_of_row(corners, f64::from(y)) else { continue };
        let columns = start[0].ceil().max(0.0) as i32..=end[0].floor().min(size[0] as f64 - 1.0) as i32;
        for x in columns {
            visit(x, y, between(start, end, (f64::from(x) - start[0]) / (end[0] - start[0])));
        }
    }
}

fn between<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    let t = if t.is_finite() { t } else { 0.0 };
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// Where the edges cross a row, leftmost and rightmost.
fn ends_of_row<const N: usize>(corners: &[[f64; N]], y: f64) -> Option<[[f64; N]; 2]> {
    let mut ends: Option<[[f64; N]; 2]> = None;
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if y < a[1].min(b[1]) || y > a[1].max(b[1]) {
            continue;
        }
        let at = between(a, b, (y - a[1]) / (b[1] - a[1]));
        let [left, right] = ends.unwrap_or([at; 2]);
        ends = Some([if at[0] < left[0] { at } else { left }, if at[0] > right[0] { at } else { right }]);
    }
    ends
}

/// Where a texture lies in the space of the viewer, exactly; places and scale are in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactPlane {
    /// A point.
    pub origin: [f64; 3],
    /// Its place in the texture.
    pub anchor: [f64; 2],
    /// The vector along which u grows by `texels`.
    pub u: [f64; 3],
    /// The vector along which v does.
    pub v: [f64; 3],
    /// Texels along each vector.
    pub texels: f64,
}

impl From<&TexturePlane> for ExactPlane {
    fn from(plane: &TexturePlane) -> Self {
        let anchor = plane.anchor.map(|a| f64::from(a) / f64::from(1 << super::texture::CORNER_BITS));
        let [origin, u, v] = [plane.origin, plane.u, plane.v].map(|v| v.map(f64::from));
        Self { origin, anchor, u, v, texels: f64::from(1 << plane.log_scale.min(15)) }
    }
}

impl ExactPlane {
    /// The place in the texture that a pixel sees, in texels; `None` where the plane is seen edge on.
    #[must_use]
    pub fn at(&self, lens: Lens, column: f64, row: f64) -> Option<[f64; 2]> {
        let focus = f64::from(lens.focus());
        let ray =
            [(column - f64::from(lens.center[0])) / focus, (f64::from(lens.center[1]) - row) / focus, 1.0];
        let divisor = triple(ray, self.v, self.u);
        let share = |a, b| triple(ray, a, b) / divisor * self.texels;
        (divisor != 0.0).then(|| {
            [share(self.origin, self.v) + self.anchor[0], share(self.u, self.origin) + self.anchor[1]]
        })
    }
}

/// `r . (a x b)`.
fn triple(r: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    r[0] * (a[1] * b[2] - a[2] * b[1])
        + r[1] * (a[2] * b[0] - a[0] * b[2])
        + r[2] * (a[0] * b[1] - a[1] * b[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::game::{TextureArithmetic, TextureMapping};
    use proptest::prelude::*;

    #[test]
    fn cut_at_the_plane() {
        let triangle = [[0.0, 0.0, -10.0, 0.0], [10.0, 0.0, 30.0, 8.0], [0.0, 10.0, 30.0, 4.0]];
        let kept = clip_exact(&triangle, 10.0);
        assert_eq!(kept, [[5.0, 0.0, 10.0, 4.0], triangle[1], triangle[2], [0.0, 5.0, 10.0, 2.0]]);
        assert!(clip_exact(&triangle, 31.0).is_empty());
        assert_eq!(clip_exact(&triangle, -20.0), triangle);
    }

    #[test]
    fn pixels_within_a_square() {
        let mut pixels = Vec::new();
        let square = [[0.5, 0.5, 0.0], [2.5, 0.5, 4.0], [2.5, 2.0, 4.0], [0.5, 2.0, 0.0]];
        for_each_pixel_within(&square, [10, 10], |x, y, v| pixels.push((x, y, v[2])));
        assert_eq!(pixels, [(1, 1, 1.0), (2, 1, 3.0), (1, 2, 1.0), (2, 2, 3.0)]);
        let endless = [[f64::INFINITY, 0.0], [0.0, 1e300], [1.0, 2.0]];
        for_each_pixel_within(&endless, [10, 10], |_, _, _| panic!("there is no such polygon"));
    }

    proptest! {
        #[test]
        fn integers_find_the_place_of_the_reference(
            origin in prop::array::uniform3(-400i32..400), u in prop::array::uniform3(-400i32..400),
            v in prop::array::uniform3(-400i32..400), x in 0i32..320, y in 0i32..200, log_scale in 0u32..8,
        ) {
            let plane = TexturePlane { origin, anchor: [77, -300], u, v, log_scale };
            let lens = Lens::new(320, 200);
            let exact = ExactPlane::from(&plane).at(lens, f64::from(x), f64::from(y));
            let place = TextureMapping::new(&plane, lens, TextureArithmetic::default()).at(x, y);
            if let (Some(exact), Some(place)) = (exact, place) {
                prop_assume!(exact.iter().all(|t| t.abs() < 1e6));
                for (e, p) in exact.iter().zip(place) {
                    prop_assert!((e - p as f64 / 65536.0).abs() < 2.0 / 65536.0 + e.abs() * 1e-9);
                }
            }
        }
    }
}
