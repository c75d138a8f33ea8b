//! A running program with its picture.

use crate::{Canvas, Event, Flow, Program};

/// Longest side of a canvas, in pixels.
pub const MAX_SIDE: usize = 16_384;

/// Most pixels of a canvas.
pub const MAX_PIXELS: usize = 1 << 26;

/// Whether a canvas of that size is had: sides of 1 to [`MAX_SIDE`], at most [`MAX_PIXELS`] in all.
pub(crate) fn is_possible(width: usize, height: usize) -> bool {
    let side = 1..=MAX_SIDE;
    side.contains(&width) && side.contains(&height) && width * height <= MAX_PIXELS
}

/// The nearest size that is had.
fn possible((width, height): (usize, usize)) -> (usize, usize) {
    let width = width.clamp(1, MAX_SIDE);
    (width, height.clamp(1, MAX_SIDE.min(MAX_PIXELS / width)))
}

/// A running program with its picture, which is drawn when it is asked for and something has changed.
pub struct Session<'a> {
    program: &'a mut dyn Program,
    canvas: Canvas,
    stale: bool,
    ended: bool,
}

impl<'a> Session<'a> {
    /// Begins, with a canvas of the size that the program wants; sides are brought into 1 to [`MAX_SIDE`], and
    /// the height so far down that there are at most [`MAX_PIXELS`].
    pub fn new(program: &'a mut dyn Program) -> Self {
        let wanted = program.size();
        let (width, height) = possible(wanted);
        let canvas = Canvas::new(width, height);
        let mut session = Self { program, canvas, stale: true, ended: false };
        if (width, height) != wanted {
            session.tell(Event::Resize(width, height));
        }
        session
    }

    /// Something happens to the program. After its end nothing happens any more. A size that is not had is
    /// brought to the nearest one.
    pub fn event(&mut self, event: Event) {
        match event {
            Event::Resize(width, height) => {
                let (width, height) = possible((width, height));
                if (width, height) != (self.canvas.width(), self.canvas.height()) {
                    self.canvas = Canvas::new(width, height);
                    self.stale = true;
                    self.tell(Event::Resize(width, height));
                }
            }
            other => self.tell(other),
        }
    }

    /// The program is shown in a window from now on.
    #[cfg_attr(not(feature = "desktop"), expect(dead_code, reason = "only desktops have windows"))]
    pub(crate) fn enter_window(&mut self) {
        self.program.enter_window();
    }

    fn tell(&mut self, event: Event) {
        if self.ended {
            return;
        }
        match self.program.event(event) {
            Flow::Wait => {}
            Flow::Redraw => self.stale = true,
            Flow::Quit => self.ended = true,
        }
    }

    /// Whether the program wanted to end.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Whether the picture is not the one drawn last.
    #[must_use]
    pub fn is_stale(&self) -> bool {
        self.stale
    }

    /// What the window is called now.
    #[must_use]
    pub fn title(&self) -> String {
        self.program.title()
    }

    /// Whether the program wants [`Event::Tick`] now.
    #[must_use]
    pub fn is_animated(&self) -> bool {
        self.program.animated()
    }

    /// Width and height of the picture, in pixels.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.canvas.width(), self.canvas.height())
    }

    /// The picture as it is now.
    pub fn picture(&mut self) -> &Canvas {
        if self.stale {
            self.program.draw(&mut self.canvas);
            self.stale = false;
        }
        &self.canvas
    }

    /// Ends, with the last picture.
    #[must_use]
    pub fn finish(mut self) -> Canvas {
        self.picture();
        self.canvas
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Recorder {
        wanted: (usize, usize),
        events: Vec<Event>,
        drawn: usize,
    }

    impl Program for Recorder {
        fn title(&self) -> String {
            format!("{} events", self.events.len())
        }

        fn size(&self) -> (usize, usize) {
            self.wanted
        }

        fn event(&mut self, event: Event) -> Flow {
            self.events.push(event);
            match event {
                Event::Wheel(v) if v > 0.0 => Flow::Redraw,
                Event::Wheel(_) => Flow::Quit,
                _ => Flow::Wait,
            }
        }

        fn draw(&mut self, canvas: &mut Canvas) {
            self.drawn += 1;
            canvas.fill(self.drawn as u32);
        }
    }

    #[test]
    fn it_is_drawn_when_wanted_and_changed() {
        let mut program = Recorder { wanted: (2, 2), ..Recorder::default() };
        let mut session = Session::new(&mut program);
        assert_eq!(session.picture().get(0, 0), Some(1));
        session.event(Event::Tick(1.0));
        assert!(!session.is_stale());
        assert_eq!(session.picture().get(0, 0), Some(1));
        session.event(Event::Wheel(1.0));
        session.event(Event::Wheel(1.0));
        assert_eq!(session.picture().get(0, 0), Some(2));
        session.event(Event::Resize(5, 4));
        assert_eq!(session.picture().get(4, 3), Some(3));
        session.event(Event::Wheel(-1.0));
        session.event(Event::Wheel(1.0));
        assert!(session.has_ended());
        assert_eq!(session.title(), "5 events");
    }

    #[test]
    fn sizes_are_bounded() {
        let mut program = Recorder { wanted: (0, usize::MAX), ..Recorder::default() };
        assert_eq!(Session::new(&mut program).finish().height(), MAX_SIDE);
        assert_eq!(program.events, [Event::Resize(1, MAX_SIDE)]);
        let mut session = Session::new(&mut program);
        session.event(Event::Resize(usize::MAX, usize::MAX));
        assert_eq!(session.size(), (MAX_SIDE, MAX_PIXELS / MAX_SIDE));
    }
}
