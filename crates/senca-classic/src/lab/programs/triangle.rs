//! Exercise 1 as a program: barycentric coordinates under the mouse.

use senca_window::{Button, Canvas, Event, Flow, Program};

use crate::lab::LabError;
use crate::lab::draw::{self, Sheet};
use crate::lab::vectors::{Barycentric, Row3, barycentric, cross, subtract};

/// A triangle in space, seen along the axis that its plane faces most, and a point.
///
/// A click, or dragging, moves the point within the plane of the triangle. Its lines to the corners
/// part the triangle into areas that are as large as the coordinates.
#[derive(Clone, Debug)]
pub struct TriangleProgram {
    corners: [Row3; 3],
    point: Row3,
    found: Barycentric,
    size: (usize, usize),
    dragging: bool,
}

impl TriangleProgram {
    /// A triangle and a point.
    ///
    /// # Errors
    /// The corners lie on a line.
    pub fn new(corners: [Row3; 3], point: Row3) -> Result<Self, LabError> {
        let found = barycentric(corners, point)?;
        Ok(Self { corners, point, found, size: (400, 400), dragging: false })
    }

    /// The coordinates of the point.
    #[must_use]
    pub fn found(&self) -> &Barycentric {
        &self.found
    }

    /// The axis that is looked along, and the two others.
    fn axes(&self) -> (usize, [usize; 2]) {
        let [a, b, c] = self.corners;
        let normal = cross(subtract(b, a), subtract(c, a));
        let along = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(2);
        (along, [[1, 2], [0, 2], [0, 1]][along])
    }

    fn flat(&self, point: Row3) -> [f64; 2] {
        self.axes().1.map(|axis| point[axis])
    }

    fn sheet(&self) -> Sheet {
        Sheet::around(&self.corners.map(|c| self.flat(c)), self.size)
    }

    /// The point of the triangle's plane under a pixel.
    fn point_under(&self, pixel: [f64; 2]) -> Row3 {
        let [a, b, c] = self.corners;
        let normal = cross(subtract(b, a), subtract(c, a));
        let (along, others) = self.axes();
        let flat = self.sheet().point(pixel);
        let mut point = [0.0; 3];
        let mut rise = 0.0;
        for (axis, v) in others.into_iter().zip(flat) {
            point[axis] = v;
            rise += normal[axis] * (v - a[axis]);
        }
        point[along] = a[along] - rise / normal[along];
        point
    }

    fn place(&mut self, x: i32, y: i32) -> Flow {
        let point = self.point_under([f64::from(x), f64::from(y)]);
        match barycentric(self.corners, point) {
            Ok(found) => {
                (self.point, self.found) = (point, found);
                Flow::Redraw
            }
            Err(_) => Flow::Wait,
        }
    }
}

impl Program for TriangleProgram {
    fn title(&self) -> String {
        let [t1, t2, t3] = self.found.coordinates;
        let place = match (self.found.inside, self.found.in_plane) {
            (true, _) => "in the triangle",
            (_, true) => "outside",
            _ => "off the plane",
        };
        format!("t = {t1:.3}, {t2:.3}, {t3:.3}: {place}")
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::Press(Button::Left, x, y) => {
                self.dragging = true;
                self.place(x, y)
            }
            Event::Move(x, y) if self.dragging => self.place(x, y),
            Event::Release(Button::Left, ..) => {
                self.dragging = false;
                Flow::Wait
            }
            Event::Resize(width, height) => {
                self.size = (width, height);
                Flow::Redraw
            }
            _ => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        let sheet = self.sheet();
        let corners = self.corners.map(|c| sheet.pixel(self.flat(c)));
        let point = sheet.pixel(self.flat(self.point));
        if self.found.inside {
            let areas = [0xf0_b0b0, 0xb0_e0b8, 0xb0_c4f0];
            for (i, color) in areas.into_iter().enumerate() {
                let area = [point, corners[(i + 1) % 3], corners[(i + 2) % 3]];
                draw::triangle(canvas, area, [draw::channels(color); 3]);
            }
        } else {
            draw::triangle(canvas, corners, [draw::channels(0xec_ecec); 3]);
        }
        corners.into_iter().for_each(|c| draw::line(canvas, point, c, draw::GREY));
        draw::outline(canvas, &corners, draw::BLACK);
        for (corner, color) in corners.into_iter().zip([draw::RED, draw::GREEN, draw::BLUE]) {
            draw::dot(canvas, corner, 4, color);
        }
        draw::dot(canvas, point, 4, draw::BLACK);
    }
}
