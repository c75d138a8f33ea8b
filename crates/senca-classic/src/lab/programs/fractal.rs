//! Exercise 8 as a program: zoom by clicking.

use senca_math::Control;
use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use crate::lab::fractal::{Coloring, Fixed, MAX_ITERATIONS, Picture, View, colored};

/// A Mandelbrot or Julia set.
///
/// The left button zooms in by 2 at the mouse, the right one out; the wheel does the same. `+` and `-`
/// double and halve m, s changes between steps and smooth colours, j goes to the Julia set of the point
/// under the mouse and back, r back to the beginning.
#[derive(Clone, Debug)]
pub struct FractalProgram {
    picture: Picture,
    first: Picture,
    coloring: Coloring,
    mouse: [f64; 2],
}

impl FractalProgram {
    /// Begins with a picture; its size is that of the window.
    #[must_use]
    pub fn new(picture: Picture, coloring: Coloring) -> Self {
        let mouse = picture.size.map(|n| 0.5 * n as f64);
        Self { first: picture.clone(), picture, coloring, mouse }
    }

    /// The picture as it is now.
    #[must_use]
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    fn zoom(&mut self, factor: f64) -> Flow {
        let view = self.picture.view.zoomed(self.mouse, self.picture.size, factor);
        // From far away it is a dot; and there is an end to the digits.
        if view.width.to_f64() > 1e3 || view.width.log2() < -33_000.0 {
            return Flow::Wait;
        }
        self.picture.view = view;
        Flow::Redraw
    }

    fn toggle_julia(&mut self) {
        if self.picture.julia.take().is_some() {
            self.picture.view = self.first.view.clone();
            return;
        }
        // A view of no size at the mouse has its middle there.
        let here = self.picture.view.zoomed(self.mouse, self.picture.size, 1e15);
        let limbs = self.picture.view.center[0].fraction();
        self.picture.julia = Some(here.center.map(|part| part.with_fraction(limbs)));
        self.picture.view = View::of_area([-1.6, 1.6], [-1.2, 1.2], self.picture.size);
    }

    fn key(&mut self, key: char) -> Flow {
        let m = self.picture.iterations;
        match key {
            '+' => self.picture.iterations = m.saturating_mul(2).min(MAX_ITERATIONS as u32),
            '-' => self.picture.iterations = (m / 2).max(1),
            's' => self.coloring.smooth = !self.coloring.smooth,
            'j' => self.toggle_julia(),
            'r' => self.picture = Picture { size: self.picture.size, ..self.first.clone() },
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }
}

impl Program for FractalProgram {
    fn title(&self) -> String {
        let Picture { view, julia, iterations, .. } = &self.picture;
        let digits = view.digits();
        let [re, im] = view.center.each_ref().map(|part| part.to_decimal(digits));
        let set = match julia {
            None => "Mandelbrot set".to_owned(),
            Some(c) => {
                let [a, b] = c.each_ref().map(|part: &Fixed| part.to_decimal(6));
                format!("Julia set of {a} {b}")
            }
        };
        format!("{set} at {re} {im}, width {}, m = {iterations}", view.width.to_decimal(4))
    }

    fn size(&self) -> (usize, usize) {
        (self.first.size[0], self.first.size[1])
    }

    fn event(&mut self, event: Event) -> Flow {
        if let Event::Move(x, y) | Event::Press(_, x, y) | Event::Release(_, x, y) = event {
            self.mouse = [f64::from(x), f64::from(y)];
        }
        match event {
            Event::Press(Button::Left, ..) => self.zoom(2.0),
            Event::Press(Button::Right, ..) => self.zoom(0.5),
            Event::Wheel(turn) if turn.is_finite() => {
                self.zoom(2.0_f64.powf(0.5 * f64::from(turn).clamp(-8.0, 8.0)))
            }
            Event::KeyDown(Key::Char(key)) => self.key(key),
            Event::Resize(width, height) => {
                self.picture.size = [width.max(1), height.max(1)];
                Flow::Redraw
            }
            _ => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        self.picture.size = [canvas.width().max(1), canvas.height().max(1)];
        // Nobody stops it, so it comes to its end.
        if let Ok(counts) = self.picture.counts(self.coloring.smooth, &Control::default()) {
            let colors = colored(&counts, &self.coloring);
            canvas.pixels_mut().iter_mut().zip(colors).for_each(|(to, color)| *to = color);
        }
    }
}
