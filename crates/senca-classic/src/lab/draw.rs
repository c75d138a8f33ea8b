//! The four things that the manual wants of a display: a point, a line, a colour, and a triangle with
//! an intensity at each corner. Colours are `0x00RRGGBB`; places are pixels, y downwards.

use senca_window::Canvas;

/// Black.
pub const BLACK: u32 = 0x00_0000;
/// White.
pub const WHITE: u32 = 0xff_ffff;
/// A light grey.
pub const GREY: u32 = 0xb0_b0b0;
/// Red.
pub const RED: u32 = 0xd0_2020;
/// Green.
pub const GREEN: u32 = 0x10_8040;
/// Blue.
pub const BLUE: u32 = 0x20_50c0;
/// A light yellow, for areas.
pub const YELLOW: u32 = 0xf4_e0a0;

/// The built-in line: the pixels nearest to the line from `start` to `end`, both included, cut at the
/// edges of the picture. It steps along the longer way and rounds the shorter one.
pub fn line(canvas: &mut Canvas, start: [f64; 2], end: [f64; 2], color: u32) {
    let Some([start, end]) = clipped(canvas, start, end) else { return };
    let steps = (end[0] - start[0]).abs().max((end[1] - start[1]).abs()).round();
    for i in 0..=steps as i32 {
        let t = if steps > 0.0 { f64::from(i) / steps } else { 0.0 };
        let [x, y] = [0, 1].map(|k| (start[k] + (end[k] - start[k]) * t).round() as i32);
        canvas.set(x, y, color);
    }
}

/// The part of a line that can touch the picture, by the parametric method; `None` when there is none.
fn clipped(canvas: &Canvas, start: [f64; 2], end: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    if !start.iter().chain(&end).all(|v| v.is_finite()) {
        return None;
    }
    let far = [canvas.width() as f64, canvas.height() as f64];
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let way = end[k] - start[k];
        for (bound, sign) in [(-1.0, 1.0), (far[k], -1.0)] {
            let inside = sign * (start[k] - bound);
            let speed = sign * way;
            if speed == 0.0 {
                if inside < 0.0 {
                    return None;
                }
            } else if speed > 0.0 {
                enters = enters.max(-inside / speed);
            } else {
                leaves = leaves.min(-inside / speed);
            }
        }
    }
    if enters > leaves {
        return None;
    }
    let at = |t: f64| std::array::from_fn(|k| start[k] + (end[k] - start[k]) * t);
    let cut_start = if enters > 0.0 { at(enters) } else { start };
    Some([cut_start, if leaves < 1.0 { at(leaves) } else { end }])
}

/// A square dot of `2 radius + 1` pixels.
pub fn dot(canvas: &mut Canvas, [x, y]: [f64; 2], radius: i32, color: u32) {
    let (x, y) = (x.round() as i32, y.round() as i32);
    for j in -radius..=radius {
        for i in -radius..=radius {
            canvas.set(x.saturating_add(i), y.saturating_add(j), color);
        }
    }
}

/// A closed polygon's edges.
pub fn outline(canvas: &mut Canvas, corners: &[[f64; 2]], color: u32) {
    for (i, &corner) in corners.iter().enumerate() {
        line(canvas, corner, corners[(i + 1) % corners.len()], color);
    }
}

/// A triangle whose colour is interpolated between its corners, each red, green and blue from 0 to
/// 255. A pixel belongs to it when its centre does; centres on an edge belong to one side of it, so
/// that neighbours neither overlap nor leave gaps.
pub fn triangle(canvas: &mut Canvas, corners: [[f64; 2]; 3], colors: [[f64; 3]; 3]) {
    each_pixel(canvas, corners, |canvas, x, y, shares| {
        let mixed = |k: usize| (0..3).map(|i| shares[i] * colors[i][k]).sum::<f64>();
        canvas.set(x, y, rgb([mixed(0), mixed(1), mixed(2)]));
    });
}

/// Calls `paint` with each pixel of a triangle, and the shares of its corners there, which sum to 1.
fn each_pixel(
    canvas: &mut Canvas,
    [a, mut b, mut c]: [[f64; 2]; 3],
    mut paint: impl FnMut(&mut Canvas, i32, i32, [f64; 3]),
) {
    let edge =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let turned = edge(a, b, c) < 0.0;
    if turned {
        (b, c) = (c, b);
    }
    let area = edge(a, b, c);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let owns = |p: [f64; 2], q: [f64; 2]| q[1] < p[1] || (q[1] == p[1] && q[0] > p[0]);
    let own = [owns(b, c), owns(c, a), owns(a, b)];
    let bounds = |k: usize, size: usize| {
        let low = [a, b, c].iter().map(|p| p[k]).fold(f64::INFINITY, f64::min).floor().max(0.0);
        let high = [a, b, c].iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max).ceil().min(size as f64);
        low as i32..high as i32
    };
    let (columns, rows) = (bounds(0, canvas.width()), bounds(1, canvas.height()));
    for y in rows {
        for x in columns.clone() {
            let p = [f64::from(x) + 0.5, f64::from(y) + 0.5];
            let weights = [edge(b, c, p), edge(c, a, p), edge(a, b, p)];
            if (0..3).all(|k| weights[k] > 0.0 || (weights[k] == 0.0 && own[k])) {
                let [of_a, of_b, of_c] = weights.map(|w| w / area);
                paint(canvas, x, y, if turned { [of_a, of_c, of_b] } else { [of_a, of_b, of_c] });
            }
        }
    }
}

/// A convex polygon of one colour, through which a `share` of what was there before is seen.
pub fn glass(canvas: &mut Canvas, corners: &[[f64; 2]], color: u32, share: f64) {
    let color = channels(color);
    for i in 2..corners.len() {
        each_pixel(canvas, [corners[0], corners[i - 1], corners[i]], |canvas, x, y, _| {
            let behind = channels(canvas.get(x, y).unwrap_or(BLACK));
            let mixed = std::array::from_fn(|k| color[k] + (behind[k] - color[k]) * share);
            canvas.set(x, y, rgb(mixed));
        });
    }
}

/// A convex polygon of one colour.
pub fn polygon(canvas: &mut Canvas, corners: &[[f64; 2]], color: u32) {
    let color = channels(color);
    for i in 2..corners.len() {
        triangle(canvas, [corners[0], corners[i - 1], corners[i]], [color; 3]);
    }
}

/// The colour with these shares of 255, rounded and held within range.
#[must_use]
pub fn rgb(channels: [f64; 3]) -> u32 {
    channels.iter().fold(0, |color, v| (color << 8) | v.round().clamp(0.0, 255.0) as u32)
}

/// Red, green and blue, 0 to 255.
#[must_use]
pub fn channels(color: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| f64::from((color >> shift) & 255))
}

/// Where points of a plane with y upwards lie in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Pixels for one unit.
    pub scale: f64,
    center: [f64; 2],
    middle: [f64; 2],
}

impl Sheet {
    /// Shows the rectangle from `low` to `high` as large as the picture of `size` allows, with a
    /// margin of 8 %.
    #[must_use]
    pub fn fitting(low: [f64; 2], high: [f64; 2], size: (usize, usize)) -> Self {
        let size = [size.0 as f64, size.1 as f64];
        let extent: [f64; 2] = std::array::from_fn(|k| (high[k] - low[k]).abs());
        let largest = extent[0].max(extent[1]);
        let fit =
            |k: usize| if extent[k] > 1e-9 * largest { 0.84 * size[k] / extent[k] } else { f64::INFINITY };
        let scale = Some(fit(0).min(fit(1))).filter(|s| s.is_finite() && *s > 0.0).unwrap_or(1.0);
        let center = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
        Self { scale, center, middle: size.map(|s| 0.5 * s) }
    }

    /// Shows all `points`; see [`Sheet::fitting`].
    #[must_use]
    pub fn around(points: &[[f64; 2]], size: (usize, usize)) -> Self {
        let bound =
            |k: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick).unwrap_or(0.0);
        let low = std::array::from_fn(|k| bound(k, f64::min));
        Self::fitting(low, std::array::from_fn(|k| bound(k, f64::max)), size)
    }

    /// The same, moved by so many pixels.
    #[must_use]
    pub fn moved(self, x: f64, y: f64) -> Self {
        Self { middle: [self.middle[0] + x, self.middle[1] + y], ..self }
    }

    /// The pixel of a point.
    #[must_use]
    pub fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.middle[0] + self.scale * (x - self.center[0]),
            self.middle[1] - self.scale * (y - self.center[1]),
        ]
    }

    /// The point of a pixel.
    #[must_use]
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.center[0] + (x - self.middle[0]) / self.scale,
            self.center[1] - (y - self.middle[1]) / self.scale,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lit(canvas: &Canvas) -> usize {
        canvas.pixels().iter().filter(|&&p| p != 0).count()
    }

    #[test]
    fn lines_have_both_ends_and_are_cut() {
        let mut canvas = Canvas::new(10, 10);
        line(&mut canvas, [1.0, 2.0], [8.0, 5.0], WHITE);
        assert_eq!((canvas.get(1, 2), canvas.get(8, 5), lit(&canvas)), (Some(WHITE), Some(WHITE), 8));
        let mut canvas = Canvas::new(10, 10);
        line(&mut canvas, [-1e9, 4.0], [1e9, 4.0], WHITE);
        assert_eq!(lit(&canvas), 10);
        for (a, b) in
            [([-5.0, -9.0], [-2.0, 40.0]), ([f64::NAN, 0.0], [1.0, 1.0]), ([20.0, 0.0], [20.0, 9.0])]
        {
            let mut canvas = Canvas::new(10, 10);
            line(&mut canvas, a, b, WHITE);
            assert_eq!(lit(&canvas), 0, "{a:?} {b:?}");
        }
    }

    #[test]
    fn triangles_of_a_square_share_no_pixel_and_leave_none() {
        let corners = [[2.5, 1.5], [9.5, 3.5], [7.5, 9.5], [1.5, 8.5]];
        let mut seen = vec![0; 144];
        for split in [[0, 1, 2], [0, 2, 3]] {
            let mut canvas = Canvas::new(12, 12);
            triangle(&mut canvas, split.map(|i| corners[i]), [[255.0; 3]; 3]);
            for (count, pixel) in seen.iter_mut().zip(canvas.pixels()) {
                *count += u32::from(*pixel != 0);
            }
        }
        assert!(seen.iter().all(|&n| n <= 1));
        let mut whole = vec![0; 144];
        for split in [[1, 2, 3], [1, 3, 0]] {
            let mut canvas = Canvas::new(12, 12);
            triangle(&mut canvas, split.map(|i| corners[i]), [[255.0; 3]; 3]);
            for (count, pixel) in whole.iter_mut().zip(canvas.pixels()) {
                *count += u32::from(*pixel != 0);
            }
        }
        assert_eq!(seen, whole);
    }

    #[test]
    fn what_is_behind_shows_through() {
        let mut canvas = Canvas::new(10, 10);
        let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        polygon(&mut canvas, &square, 0x64_c8_00);
        glass(&mut canvas, &square, 0x00_00_c8, 0.25);
        assert!(canvas.pixels().iter().all(|&p| p == 0x19_32_96));
    }

    #[test]
    fn colours_are_interpolated() {
        let mut canvas = Canvas::new(100, 100);
        let colors = [[255.0, 0.0, 0.0], [0.0, 255.0, 0.0], [0.0, 0.0, 255.0]];
        triangle(&mut canvas, [[0.0, 0.0], [99.0, 0.0], [0.0, 99.0]], colors);
        let middle = channels(canvas.get(32, 32).unwrap_or(0));
        assert!(middle.iter().all(|c| (c - 85.0).abs() <= 4.0), "{middle:?}");
        assert!(canvas.get(0, 0).is_some_and(|c| c >> 16 > 0xf8));
        assert_eq!(canvas.get(90, 90), Some(0));
    }

    #[test]
    fn a_sheet_goes_both_ways() {
        let sheet = Sheet::around(&[[-1.0, 0.0], [3.0, 1.0]], (200, 100));
        assert_eq!(sheet.pixel([1.0, 0.5]), [100.0, 50.0]);
        assert!(sheet.pixel([1.0, 1.0])[1] < 50.0, "y points up");
        let point = sheet.point(sheet.pixel([2.5, -7.0]));
        assert!((point[0] - 2.5).abs() < 1e-12 && (point[1] + 7.0).abs() < 1e-12);
        let alone = Sheet::around(&[[4.0, 4.0]], (10, 10));
        assert_eq!(alone.pixel([4.0, 4.0]), [5.0, 5.0]);
    }
}
