//! Exercise 2: the line by Bresenham's procedure.
//!
//! A line is straight, ends where it should, has dots of constant density and is quick to draw: these
//! are the manual's four criteria. Bresenham's line meets the third only within an octant: a diagonal
//! has 1/sqrt 2 of the dots of a horizontal line of its length.

use super::vectors::{Row3, cross};

/// A pixel, column and row.
pub type Pixel = [i32; 2];

/// Largest coordinate of a line's ends that the exercise accepts, either way from 0.
pub const MAX_COORDINATE: i64 = 1 << 20;

/// The homogeneous line through two homogeneous points, a x + b y + c h = 0 (2.5).
#[must_use]
pub fn line_through(start: Row3, end: Row3) -> Row3 {
    cross(start, end)
}

/// Value of a x + b y + c h: 0 on the line; for a line that runs towards greater x with y upwards,
/// positive above and negative below it.
#[must_use]
pub fn side(line: Row3, point: Row3) -> f64 {
    super::vectors::dot(line, point)
}

/// The point at `t` of the parametric line (2.7): `start` at 0, `end` at 1.
#[must_use]
pub fn point_at(start: Row3, end: Row3, t: f64) -> Row3 {
    std::array::from_fn(|i| (end[i] - start[i]) * t + start[i])
}

/// The procedure as the manual gives it, with its floating point numbers.
///
/// It is right for lines that climb at 0 to 45 degrees towards greater x. The last pixel is left out.
/// Other lines come out as the procedure makes them: nothing for those that run backwards, a diagonal
/// for steep ones, a horizontal for those that fall. Sums of rounded numbers break ties by chance.
#[must_use]
pub fn literal_line([x1, y1]: Pixel, [x2, y2]: Pixel) -> Vec<Pixel> {
    let (x0, y0) = (x2 - x1, y2 - y1);
    let slope = f64::from(y0) / f64::from(x0);
    let mut pixels = Vec::new();
    let (mut x, mut y) = (x1, y1);
    let mut d = slope - 0.5;
    for _ in 0..x0 {
        pixels.push([x, y]);
        if d > 0.0 {
            y += 1;
            d -= 1.0;
        }
        x += 1;
        d += slope;
    }
    pixels
}

/// The same procedure in whole numbers: everything times 2 `x0`. Ties stay on the lower row.
#[must_use]
pub fn integer_line([x1, y1]: Pixel, [x2, y2]: Pixel) -> Vec<Pixel> {
    let (x0, y0) = (i64::from(x2) - i64::from(x1), i64::from(y2) - i64::from(y1));
    let mut pixels = Vec::new();
    let (mut x, mut y) = (x1, y1);
    let mut e = 2 * y0 - x0;
    for _ in 0..x0 {
        pixels.push([x, y]);
        if e > 0 {
            y += 1;
            e -= 2 * x0;
        }
        x += 1;
        e += 2 * y0;
    }
    pixels
}

/// Bresenham's line at any angle, in whole numbers, with both ends.
///
/// The longer way is walked pixel by pixel; a tie stays on the row it comes from, so a line that has
/// ties looks different when it is drawn from its other end.
#[must_use]
pub fn bresenham([x1, y1]: Pixel, [x2, y2]: Pixel) -> Vec<Pixel> {
    let (dx, dy) = (i64::from(x2) - i64::from(x1), i64::from(y2) - i64::from(y1));
    let steep = dy.abs() > dx.abs();
    let (long, short) = if steep { (dy, dx) } else { (dx, dy) };
    let (long_step, short_step) = (long.signum() as i32, short.signum() as i32);
    let (long, short) = (long.abs(), short.abs());
    let mut pixels = Vec::with_capacity(long as usize + 1);
    let (mut x, mut y) = (x1, y1);
    let mut e = 2 * short - long;
    for i in 0..=long {
        pixels.push([x, y]);
        if i == long {
            break;
        }
        let across = e > 0;
        if across {
            e -= 2 * long;
        }
        e += 2 * short;
        let across = if across { short_step } else { 0 };
        let (step_x, step_y) = if steep { (across, long_step) } else { (long_step, across) };
        x += step_x;
        y += step_y;
    }
    pixels
}

#[cfg(test)]
mod tests;
