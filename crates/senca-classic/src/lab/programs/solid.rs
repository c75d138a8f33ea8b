//! Exercise 4 as a program: a point is moved through a solid.

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use super::{move_by_key, told};
use crate::lab::LabError;
use crate::lab::draw::{self, Sheet};
use crate::lab::polygon::Position;
use crate::lab::solid::{Normalization, Solid, SolidPosition};
use crate::lab::vectors::Row3;

/// The wireframe of a solid, scaled to [-1, 1] and seen along z, with a point in the coordinates of its
/// file.
///
/// A click sets x and y of the point; x, y, z and X, Y, Z, or arrows and page keys, move it by a share
/// of the solid's size. Green is inside, red outside, blue on the surface.
#[derive(Clone, Debug)]
pub struct SolidProgram {
    solid: Solid,
    normalized: Solid,
    map: Normalization,
    point: Row3,
    found: SolidPosition,
    size: (usize, usize),
}

impl SolidProgram {
    /// A solid and a point.
    ///
    /// # Errors
    /// The solid has no size.
    pub fn new(solid: Solid, point: Row3) -> Result<Self, LabError> {
        let map = solid.normalization()?;
        let (normalized, found) = (solid.normalized()?, solid.position(point));
        Ok(Self { solid, normalized, map, point, found, size: (400, 400) })
    }

    /// Where the point is.
    #[must_use]
    pub fn found(&self) -> &SolidPosition {
        &self.found
    }

    fn sheet(&self) -> Sheet {
        Sheet::fitting([-1.3, -1.3], [1.3, 1.3], self.size)
    }

    fn moved(&mut self) -> Flow {
        self.found = self.solid.position(self.point);
        Flow::Redraw
    }
}

impl Program for SolidProgram {
    fn title(&self) -> String {
        let place = match self.found.position {
            Position::Inside => "inside the solid",
            Position::Boundary => "on the surface of the solid",
            Position::Outside => "outside the solid",
        };
        format!("V {} is {place}", told(self.point))
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        // In units of the picture, so that it fits solids of any size.
        let step = |axis: usize, steps: f64| (axis, steps * 0.1 / self.map.scale);
        let (axis, way) = match event {
            Event::Press(Button::Left, x, y) => {
                let flat = self.sheet().point([f64::from(x), f64::from(y)]);
                (0..2).for_each(|k| self.point[k] = flat[k] / self.map.scale + self.map.center[k]);
                return self.moved();
            }
            Event::KeyDown(Key::Left) => step(0, -1.0),
            Event::KeyDown(Key::Right) => step(0, 1.0),
            Event::KeyDown(Key::Down) => step(1, -1.0),
            Event::KeyDown(Key::Up) => step(1, 1.0),
            Event::KeyDown(Key::PageDown) => step(2, -1.0),
            Event::KeyDown(Key::PageUp) => step(2, 1.0),
            Event::KeyDown(Key::Char(key)) => {
                let mut way = [0.0; 3];
                if !move_by_key(&mut way, key) {
                    return Flow::Wait;
                }
                (0..3).for_each(|k| self.point[k] += way[k] / self.map.scale);
                return self.moved();
            }
            Event::Resize(width, height) => {
                self.size = (width, height);
                return Flow::Redraw;
            }
            _ => return Flow::Wait,
        };
        self.point[axis] += way;
        self.moved()
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        let sheet = self.sheet();
        let flat = |[x, y, _]: Row3| sheet.pixel([x, y]);
        for [a, b] in self.normalized.edges() {
            let [a, b] = [a, b].map(|i| flat(self.normalized.vertices[i]));
            draw::line(canvas, a, b, draw::BLACK);
        }
        let color = match self.found.position {
            Position::Inside => draw::GREEN,
            Position::Boundary => draw::BLUE,
            Position::Outside => draw::RED,
        };
        draw::dot(canvas, flat(self.map.apply(self.point)), 4, color);
    }
}
