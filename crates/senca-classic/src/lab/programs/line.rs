//! Exercise 2 as a program: click the ends of lines.

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use crate::lab::draw;
use crate::lab::line::{Pixel, bresenham};

/// How far below Bresenham's line the built-in one is drawn, in pixels.
pub(super) const SHIFT: i32 = 20;

/// Lines by Bresenham in black, and the built-in one of each 20 pixels below it in blue.
///
/// Two clicks make a line. `+` and `-` change how large pixels are shown; Backspace takes the last line
/// away.
#[derive(Clone, Debug)]
pub struct LineProgram {
    lines: Vec<[Pixel; 2]>,
    start: Option<Pixel>,
    /// Pixels of the canvas for one of the line.
    magnification: i32,
    /// The pixel in the top left corner.
    origin: Pixel,
    size: (usize, usize),
}

impl LineProgram {
    /// Nothing but a white picture.
    #[must_use]
    pub fn new() -> Self {
        Self { lines: Vec::new(), start: None, magnification: 1, origin: [0, 0], size: (400, 300) }
    }

    /// A line, and pixels as large as it allows.
    #[must_use]
    pub fn with_line(line: [Pixel; 2]) -> Self {
        let low: Pixel = std::array::from_fn(|k| line[0][k].min(line[1][k]));
        let high: Pixel = std::array::from_fn(|k| line[0][k].max(line[1][k]));
        let inside = low[0] >= 0 && low[1] >= 0 && high[0] < 400 && high[1] + SHIFT < 300;
        let extent = [high[0] - low[0] + 3, high[1] - low[1] + SHIFT + 3];
        let magnification = (400 / extent[0]).min(300 / extent[1]).clamp(1, 16);
        let origin = if inside && magnification == 1 { [0, 0] } else { [low[0] - 1, low[1] - 1] };
        Self { lines: vec![line], magnification, origin, ..Self::new() }
    }

    /// The lines so far.
    #[must_use]
    pub fn lines(&self) -> &[[Pixel; 2]] {
        &self.lines
    }

    fn click(&mut self, x: i32, y: i32) -> Flow {
        let m = self.magnification;
        let pixel = [x.div_euclid(m) + self.origin[0], y.div_euclid(m) + self.origin[1]];
        match self.start.take() {
            None => self.start = Some(pixel),
            Some(start) => self.lines.push([start, pixel]),
        }
        Flow::Redraw
    }

    fn show(&self, canvas: &mut Canvas, [x, y]: Pixel, color: u32) {
        let m = self.magnification;
        let at = |v: i32, k: usize| v.saturating_sub(self.origin[k]).saturating_mul(m);
        let (left, top) = (at(x, 0), at(y, 1));
        // With large pixels a line of the picture's ground between them.
        let side = if m > 3 { m - 1 } else { m };
        for j in 0..side {
            (0..side).for_each(|i| canvas.set(left.saturating_add(i), top.saturating_add(j), color));
        }
    }

    fn show_built_in(&self, canvas: &mut Canvas, [start, end]: [Pixel; 2]) {
        // Drawn on a canvas of its own, at the size of its pixels.
        let m = self.magnification as usize;
        let mut small = Canvas::new(self.size.0.div_ceil(m), self.size.1.div_ceil(m));
        small.fill(draw::WHITE);
        let at = |[x, y]: Pixel| [f64::from(x - self.origin[0]), f64::from(y + SHIFT - self.origin[1])];
        draw::line(&mut small, at(start), at(end), draw::BLUE);
        for y in 0..small.height() as i32 {
            for x in 0..small.width() as i32 {
                if small.get(x, y) == Some(draw::BLUE) {
                    self.show(canvas, [x + self.origin[0], y + self.origin[1]], draw::BLUE);
                }
            }
        }
    }
}

impl Default for LineProgram {
    fn default() -> Self {
        Self::new()
    }
}

impl Program for LineProgram {
    fn title(&self) -> String {
        match (self.start, self.lines.last()) {
            (Some([x, y]), _) => format!("Start ({x}, {y}); click the end"),
            (None, Some([[x1, y1], [x2, y2]])) => {
                format!("({x1}, {y1}) to ({x2}, {y2}); click the start of the next")
            }
            (None, None) => "Click the start of a line".to_owned(),
        }
    }

    fn size(&self) -> (usize, usize) {
        (400, 300)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::Press(Button::Left, x, y) => return self.click(x, y),
            Event::KeyDown(Key::Char('+')) => self.magnification = (self.magnification + 1).min(32),
            Event::KeyDown(Key::Char('-')) => self.magnification = (self.magnification - 1).max(1),
            Event::KeyDown(Key::Backspace) => drop(self.lines.pop()),
            Event::Resize(width, height) => self.size = (width, height),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        for &[start, end] in &self.lines {
            self.show_built_in(canvas, [start, end]);
            for pixel in bresenham(start, end) {
                self.show(canvas, pixel, draw::BLACK);
            }
        }
        if let Some(start) = self.start {
            self.show(canvas, start, draw::RED);
        }
    }
}
