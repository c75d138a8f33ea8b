//! Space as exercise 1 draws it: in parallel projection, from a direction that is turned by the mouse,
//! z upwards. Nothing is hidden by depth; what is drawn first is covered by what comes later.

use senca_window::{Button, Canvas, Event, Flow, Key};

use super::draw::{self, Sheet};
use super::vectors::{Row3, Row4, add, dot, scale, subtract};

/// Radians that an arrow key turns by.
const KEY_TURN: f64 = 0.1;

/// Radians for a pixel of dragging.
const DRAG_TURN: f64 = 0.01;

/// The direction that space is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    /// Angle about z, from x.
    turn: f64,
    /// Angle above the plane of x and y.
    tilt: f64,
    grip: Option<[i32; 2]>,
}

impl Orbit {
    /// From the front right, a little from above: x runs to the right, y to the back.
    pub(super) const START: Self = Self { turn: -0.65, tilt: 0.45, grip: None };

    /// The direction towards the viewer, of length 1.
    pub(super) fn to_eye(self) -> Row3 {
        let ((sin, cos), (up, flat)) = (self.turn.sin_cos(), self.tilt.sin_cos());
        [flat * cos, flat * sin, up]
    }

    /// A point's place on a sheet of paper, y upwards.
    pub(super) fn flat(self, point: Row3) -> [f64; 2] {
        let ((sin, cos), (up, flat)) = (self.turn.sin_cos(), self.tilt.sin_cos());
        [dot([-sin, cos, 0.0], point), dot([-up * cos, -up * sin, flat], point)]
    }

    /// Turns by dragging and by arrow keys.
    pub(super) fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::Press(Button::Left, x, y) => self.grip = Some([x, y]),
            Event::Release(Button::Left, ..) => self.grip = None,
            Event::Move(x, y) => {
                let Some([old_x, old_y]) = self.grip.replace([x, y]) else {
                    self.grip = None;
                    return Flow::Wait;
                };
                let moved = [f64::from(x) - f64::from(old_x), f64::from(y) - f64::from(old_y)];
                return self.turned(-DRAG_TURN * moved[0], DRAG_TURN * moved[1]);
            }
            Event::KeyDown(Key::Left) => return self.turned(-KEY_TURN, 0.0),
            Event::KeyDown(Key::Right) => return self.turned(KEY_TURN, 0.0),
            Event::KeyDown(Key::Up) => return self.turned(0.0, KEY_TURN),
            Event::KeyDown(Key::Down) => return self.turned(0.0, -KEY_TURN),
            _ => {}
        }
        Flow::Wait
    }

    fn turned(&mut self, turn: f64, tilt: f64) -> Flow {
        self.turn = (self.turn + turn).rem_euclid(std::f64::consts::TAU);
        self.tilt = (self.tilt + tilt).clamp(-1.5, 1.5);
        Flow::Redraw
    }
}

/// A part of a picture that shows space.
pub(super) struct Stage<'a> {
    pub(super) canvas: &'a mut Canvas,
    pub(super) orbit: Orbit,
    pub(super) sheet: Sheet,
}

impl Stage<'_> {
    /// The pixel of a point.
    pub(super) fn pixel(&self, point: Row3) -> [f64; 2] {
        self.sheet.pixel(self.orbit.flat(point))
    }

    pub(super) fn line(&mut self, start: Row3, end: Row3, color: u32) {
        let ends = [self.pixel(start), self.pixel(end)];
        draw::line(self.canvas, ends[0], ends[1], color);
    }

    /// A line three pixels wide.
    pub(super) fn thick_line(&mut self, start: Row3, end: Row3, color: u32) {
        let [[a, b], [c, d]] = [self.pixel(start), self.pixel(end)];
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
            draw::line(self.canvas, [a + x, b + y], [c + x, d + y], color);
        }
    }

    /// A line with a head of nine pixels, or less for a short one.
    pub(super) fn arrow(&mut self, start: Row3, end: Row3, color: u32) {
        let (from, to) = (self.pixel(start), self.pixel(end));
        draw::line(self.canvas, from, to, color);
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        if length < 1.0 {
            return;
        }
        let [x, y] = way.map(|v| v / length * f64::min(9.0, 0.6 * length));
        let corner = |side: f64| [to[0] - x - 0.4 * side * y, to[1] - y + 0.4 * side * x];
        draw::triangle(self.canvas, [to, corner(1.0), corner(-1.0)], [draw::channels(color); 3]);
    }

    /// A convex area through which a `share` of what is behind is seen.
    pub(super) fn area(&mut self, corners: &[Row3], color: u32, share: f64) {
        let corners: Vec<_> = corners.iter().map(|&c| self.pixel(c)).collect();
        draw::glass(self.canvas, &corners, color, share);
    }

    pub(super) fn outline(&mut self, corners: &[Row3], color: u32) {
        let corners: Vec<_> = corners.iter().map(|&c| self.pixel(c)).collect();
        draw::outline(self.canvas, &corners, color);
    }

    /// The twelve edges of the box between two corners.
    pub(super) fn block(&mut self, low: Row3, high: Row3, color: u32) {
        for (start, end) in block_edges(low, high) {
            self.line(start, end, color);
        }
    }
}

/// The eight corners of a box; bit k of a corner's number tells its end of axis k.
pub(super) fn block_corners(low: Row3, high: Row3) -> [Row3; 8] {
    std::array::from_fn(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { low[k] } else { high[k] }))
}

fn block_edges(low: Row3, high: Row3) -> Vec<(Row3, Row3)> {
    let corners = block_corners(low, high);
    let from = |k: usize| (0..8).filter(move |i| i >> k & 1 == 0).map(move |i| (i, i | 1 << k));
    (0..3).flat_map(from).map(|(i, j)| (corners[i], corners[j])).collect()
}

/// A piece of a plane: a convex polygon, and the plane's normal and its distance from the origin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) corners: Vec<Row3>,
    pub(super) plane: Row4,
    /// Number of the plane.
    pub(super) which: usize,
}

/// The part of a polygon where the plane's value is not negative.
pub(super) fn cut(corners: &[Row3], plane: Row4) -> Vec<Row3> {
    let [a, b, c, d] = plane;
    let value = |p: Row3| dot([a, b, c], p) - d;
    let mut kept = Vec::new();
    for (i, &from) in corners.iter().enumerate() {
        let to = corners[(i + 1) % corners.len()];
        let (start, end) = (value(from), value(to));
        if start >= 0.0 {
            kept.push(from);
        }
        if (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0) {
            kept.push(add(from, scale(subtract(to, from), start / (start - end))));
        }
    }
    kept
}

/// Pieces from far to near, cut where they go through each other: each plane in turn parts the others
/// into those behind it and those before it.
pub(super) fn far_to_near(mut pieces: Vec<Piece>, to_eye: Row3, size: f64) -> Vec<Piece> {
    let Some(first) = pieces.pop() else { return Vec::new() };
    let [a, b, c, d] = first.plane;
    let sides = [first.plane, [-a, -b, -c, -d]];
    let mut parts = [Vec::new(), Vec::new()];
    let mut sorted_with = Vec::new();
    for piece in pieces {
        let far = piece.corners.iter().map(|&p| (dot([a, b, c], p) - d).abs()).fold(0.0, f64::max);
        if far <= 1e-9 * size {
            sorted_with.push(piece);
            continue;
        }
        for (part, side) in parts.iter_mut().zip(sides) {
            let corners = cut(&piece.corners, side);
            if corners.len() > 2 {
                part.push(Piece { corners, ..piece.clone() });
            }
        }
    }
    sorted_with.push(first);
    let [front, back] = parts;
    let faces_eye = dot([a, b, c], to_eye) >= 0.0;
    let (far, near) = if faces_eye { (back, front) } else { (front, back) };
    let mut sorted = far_to_near(far, to_eye, size);
    sorted.extend(sorted_with);
    sorted.extend(far_to_near(near, to_eye, size));
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn x_runs_to_the_right_y_to_the_back_z_up() {
        let flat = |p| Orbit::START.flat(p);
        assert!(flat([1.0, 0.0, 0.0])[0] > 0.6 && flat([0.0, 1.0, 0.0])[1] > 0.2);
        assert!(flat([0.0, 0.0, 1.0])[0].abs() < 1e-15 && flat([0.0, 0.0, 1.0])[1] > 0.9);
        let eye = Orbit::START.to_eye();
        assert!((dot(eye, eye) - 1.0).abs() < 1e-15);
        assert!(flat(eye).iter().all(|v| v.abs() < 1e-15), "the direction of view is a point");
    }

    #[test]
    fn dragging_and_arrows_turn() {
        let mut orbit = Orbit::START;
        assert_eq!(orbit.event(Event::Move(5, 5)), Flow::Wait);
        orbit.event(Event::Press(Button::Left, 5, 5));
        assert_eq!(orbit.event(Event::Move(25, 5)), Flow::Redraw);
        orbit.event(Event::Release(Button::Left, 25, 5));
        assert_eq!(orbit.event(Event::Move(99, 99)), Flow::Wait);
        let turned = orbit.turn;
        orbit.event(Event::KeyDown(Key::Right));
        assert!((orbit.turn - turned - KEY_TURN).abs() < 1e-12);
        for _ in 0..100 {
            orbit.event(Event::KeyDown(Key::Up));
        }
        assert_eq!(orbit.tilt, 1.5);
    }

    #[test]
    fn planes_that_go_through_each_other_are_cut_and_sorted() {
        let square = |axis: usize| -> Piece {
            let [u, v] = [[1, 2], [0, 2], [0, 1]][axis];
            let corner = |a: f64, b: f64| {
                let mut p = [0.0; 3];
                (p[u], p[v]) = (a, b);
                p
            };
            let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            let mut plane = [0.0; 4];
            plane[axis] = 1.0;
            Piece { corners, plane, which: axis }
        };
        let to_eye = [0.5, 0.6, 0.7];
        let sorted = far_to_near((0..3).map(square).collect(), to_eye, 1.0);
        // One is whole, one in two, one in four pieces: the three coordinate planes.
        assert_eq!(sorted.len(), 7);
        let area = |p: &Piece| {
            let side = |i: usize| subtract(p.corners[i], p.corners[0]);
            let n = crate::lab::vectors::cross(side(1), side(2));
            dot(n, n).sqrt()
        };
        assert!((sorted.iter().map(area).sum::<f64>() - 12.0).abs() < 1e-12);
        // No piece is drawn before one that lies behind it: what is drawn earlier hides no point.
        for (i, near) in sorted.iter().enumerate() {
            let sum = near.corners.iter().fold([0.0; 3], |sum, &p| add(sum, p));
            let middle = scale(sum, 1.0 / near.corners.len() as f64);
            for corner in &near.corners {
                let point = add(scale(middle, 0.4), scale(*corner, 0.6));
                assert!(sorted[..i].iter().all(|far| !hides(far, point, to_eye)), "{point:?}");
            }
        }
    }

    /// Whether a piece lies between a point and the eye.
    fn hides(piece: &Piece, point: Row3, to_eye: Row3) -> bool {
        let [a, b, c, d] = piece.plane;
        let way = (d - dot([a, b, c], point)) / dot([a, b, c], to_eye);
        let there = add(point, scale(to_eye, way));
        let corners = &piece.corners;
        let side = |i: usize| {
            let edge = subtract(corners[(i + 1) % corners.len()], corners[i]);
            let out = crate::lab::vectors::cross(edge, subtract(there, corners[i]));
            dot(out, [a, b, c])
        };
        let sides: Vec<f64> = (0..corners.len()).map(side).collect();
        let is_in = sides.iter().all(|&s| s > 1e-9) || sides.iter().all(|&s| s < -1e-9);
        way > 1e-9 && is_in
    }
}
