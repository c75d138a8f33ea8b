//! Exercise 8 as a program: zoom by clicking.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use senca_math::Control;
use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use crate::lab::fractal::{Coloring, Counts, Fixed, MAX_ITERATIONS, Picture, View, colored};

/// A Mandelbrot or Julia set.
///
/// The left button zooms in by 2 at the mouse, the right one out; the wheel does the same. `+` and `-`
/// double and halve m, s changes between steps and smooth colours, j goes to the Julia set of the point
/// under the mouse and back, r back to the beginning.
///
/// In a window the picture comes coarsely at first, then finer and finer, and whatever is pressed
/// meanwhile ends the computation and begins the next one. Without a window each picture is computed to
/// its end.
#[derive(Debug)]
pub struct FractalProgram {
    picture: Picture,
    first: Picture,
    coloring: Coloring,
    mouse: [f64; 2],
    /// Whether it is in a window.
    in_window: bool,
    work: Option<Work>,
    /// The finest counts so far, in a window.
    found: Option<Counts>,
}

/// Pixels that are computed as one, from the first pass to the last.
const PASSES: [usize; 4] = [8, 4, 2, 1];

/// A computation on a thread of its own, pass by pass. It ends when this is dropped.
#[derive(Debug)]
struct Work {
    stop: Arc<AtomicBool>,
    passes: Receiver<Counts>,
}

impl Work {
    fn begin(picture: Picture, smooth: bool) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let (give, passes) = channel();
        let stopped = stop.clone();
        std::thread::spawn(move || {
            for pass in PASSES {
                let control = Control { cancel: Some(&stopped), ..Control::default() };
                let Ok(counts) = coarser(&picture, pass).counts(smooth, &control) else { return };
                if give.send(counts).is_err() {
                    return;
                }
            }
        });
        Self { stop, passes }
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// The same view with `pass` times fewer pixels a side; the last column and row may reach beyond it.
fn coarser(picture: &Picture, pass: usize) -> Picture {
    let size = picture.size.map(|side| side.div_ceil(pass));
    let wider = (size[0] * pass) as f64 / picture.size[0] as f64;
    let width = picture.view.width.times_f64(wider);
    Picture { view: View { width, ..picture.view.clone() }, size, ..picture.clone() }
}

/// Fills the canvas with pixels of a coarser picture that has the same middle.
fn enlarge(pixels: &[u32], size: [usize; 2], canvas: &mut Canvas) {
    let full = [canvas.width(), canvas.height()];
    let pass = full[0].div_ceil(size[0].max(1)).max(1) as f64;
    let place = |axis: usize, i: usize| {
        let from_middle = (i as f64 + 0.5 - 0.5 * full[axis] as f64) / pass;
        ((from_middle + 0.5 * size[axis] as f64) as usize).min(size[axis] - 1)
    };
    let columns: Vec<usize> = (0..full[0]).map(|x| place(0, x)).collect();
    for (y, row) in canvas.pixels_mut().chunks_exact_mut(full[0]).enumerate() {
        let from = &pixels[place(1, y) * size[0]..][..size[0]];
        row.iter_mut().zip(&columns).for_each(|(to, &x)| *to = from[x]);
    }
}

impl FractalProgram {
    /// Begins with a picture; its size is that of the window.
    #[must_use]
    pub fn new(picture: Picture, coloring: Coloring) -> Self {
        let mouse = picture.size.map(|n| 0.5 * n as f64);
        Self { first: picture.clone(), picture, coloring, mouse, in_window: false, work: None, found: None }
    }

    /// The picture as it is now.
    #[must_use]
    pub fn picture(&self) -> &Picture {
        &self.picture
    }

    /// In a window the computation begins anew.
    fn changed(&mut self) -> Flow {
        if !self.in_window {
            return Flow::Redraw;
        }
        // The old one ends first, so that it leaves its threads to the new one.
        self.work = None;
        self.work = Some(Work::begin(self.picture.clone(), self.coloring.smooth));
        Flow::Wait
    }

    /// Takes what has been computed meanwhile.
    fn take_passes(&mut self) -> Flow {
        let mut flow = Flow::Wait;
        while let Some(work) = &self.work {
            match work.passes.try_recv() {
                Ok(counts) => {
                    self.found = Some(counts);
                    flow = Flow::Redraw;
                }
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => self.work = None,
            }
        }
        flow
    }

    fn zoom(&mut self, factor: f64) -> Flow {
        let view = self.picture.view.zoomed(self.mouse, self.picture.size, factor);
        // From far away it is a dot; and there is an end to the digits.
        if view.width.to_f64() > 1e3 || view.width.log2() < -33_000.0 {
            return Flow::Wait;
        }
        self.picture.view = view;
        self.changed()
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
        self.changed()
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
        let more = if self.work.is_some() { " ..." } else { "" };
        format!("{set} at {re} {im}, width {}, m = {iterations}{more}", view.width.to_decimal(4))
    }

    fn size(&self) -> (usize, usize) {
        (self.first.size[0], self.first.size[1])
    }

    fn animated(&self) -> bool {
        self.work.is_some()
    }

    fn enter_window(&mut self) {
        self.in_window = true;
        self.changed();
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
                self.changed()
            }
            Event::Tick(_) => self.take_passes(),
            _ => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        if self.in_window {
            // Until there is something new, the canvas keeps what it shows.
            if let Some(found) = &self.found {
                enlarge(&colored(found, &self.coloring), found.size, canvas);
            }
            return;
        }
        self.picture.size = [canvas.width().max(1), canvas.height().max(1)];
        // Nobody stops it, so it comes to its end.
        if let Ok(counts) = self.picture.counts(self.coloring.smooth, &Control::default()) {
            let colors = colored(&counts, &self.coloring);
            canvas.pixels_mut().iter_mut().zip(colors).for_each(|(to, color)| *to = color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program() -> FractalProgram {
        let view = View::parse("-0.5", "0", "3").expect("a view");
        let picture = Picture { view, julia: None, bound: 100.0, iterations: 60, size: [83, 61] };
        FractalProgram::new(picture, Coloring::default())
    }

    fn drawn(program: &mut FractalProgram) -> Canvas {
        let mut canvas = Canvas::new(83, 61);
        program.draw(&mut canvas);
        canvas
    }

    /// Lets time go on until the picture is complete; how often there was something new.
    fn wait(program: &mut FractalProgram) -> usize {
        let mut redrawn = 0;
        while program.animated() {
            redrawn += usize::from(program.event(Event::Tick(0.001)) == Flow::Redraw);
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        redrawn
    }

    #[test]
    fn in_a_window_the_picture_becomes_complete() {
        let mut program = program();
        let whole = drawn(&mut program);
        program.enter_window();
        assert!(program.animated() && program.title().ends_with("..."));
        assert!(wait(&mut program) > 0);
        assert!(!program.title().ends_with("..."));
        assert!(drawn(&mut program).pixels() == whole.pixels());
    }

    #[test]
    fn what_is_pressed_ends_the_computation() {
        let mut program = program();
        // This takes hours.
        let view = View::parse("-0.5", "1e-310", "1e-300").expect("a view");
        program.picture = Picture { view, iterations: 100_000_000, ..program.picture };
        program.enter_window();
        let stop = program.work.as_ref().expect("works").stop.clone();
        assert_eq!(program.event(Event::KeyDown(Key::Char('r'))), Flow::Wait);
        assert!(stop.load(Ordering::Relaxed));
        wait(&mut program);
        let mut plain = self::program();
        assert!(drawn(&mut program).pixels() == drawn(&mut plain).pixels());
        assert_eq!(program.event(Event::KeyDown(Key::Char('?'))), Flow::Wait);
        assert!(!program.animated());
    }

    #[test]
    fn coarse_pictures_show_the_same_view() {
        let program = program();
        for pass in PASSES {
            let coarse = coarser(&program.picture, pass);
            let counts = coarse.counts(false, &Control::default()).expect("nobody stops it");
            let mut canvas = Canvas::new(83, 61);
            enlarge(&colored(&counts, &program.coloring), counts.size, &mut canvas);
            let plain = drawn(&mut self::program());
            let same = canvas.pixels().iter().zip(plain.pixels()).filter(|(a, b)| a == b).count();
            assert!(same * (7 + pass) > canvas.pixels().len() * 7, "{pass}: {same}");
        }
    }
}
