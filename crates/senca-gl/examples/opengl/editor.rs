//! Exercise 5.10: a line editor. The left button gives the ends of segments, the right one deletes the segment
//! under it, which selection finds.

use senca_gl::{Context, gl};
use senca_window::{Button, Event};

/// A picture of segments. Positions are window coordinates of OpenGL: the origin is the lower left corner.
#[derive(Default)]
pub(crate) struct Editor {
    segments: Vec<[[f64; 2]; 2]>,
    /// First end of the segment that is being drawn, and where the mouse is.
    begun: Option<[[f64; 2]; 2]>,
    /// Whether the first end was given by a click, so that the next press gives the other.
    clicked: bool,
}

impl Editor {
    /// Adds a segment.
    pub(crate) fn add(&mut self, ends: [[f64; 2]; 2]) {
        self.segments.push(ends);
    }

    /// Deletes the segment within two pixels of a place, the one drawn last of several.
    pub(crate) fn delete(&mut self, c: &mut Context, [x, y]: [f64; 2]) {
        let size = c.window_size();
        c.select_buffer(512);
        c.render_mode(gl::SELECT);
        c.init_names();
        c.push_name(0);
        c.matrix_mode(gl::PROJECTION);
        c.load_identity();
        c.pick_matrix([x, y], [5.0, 5.0], [0, 0, size[0] as i32, size[1] as i32]);
        project(c, size);
        self.send(c);
        // A record is 1, least depth, greatest depth, name; the last one drawn lies on top.
        if c.render_mode(gl::RENDER) > 0
            && let Some(record) = c.selected().as_chunks::<4>().0.last()
        {
            self.segments.remove(record[3] as usize);
        }
    }

    /// What the mouse does; whether something is to be seen of it.
    pub(crate) fn event(&mut self, c: &mut Context, event: Event) -> bool {
        let height = f64::from(c.window_size()[1]);
        let place = |x: i32, y: i32| [f64::from(x) + 0.5, height - 0.5 - f64::from(y)];
        match event {
            Event::Press(Button::Left, x, y) if !self.clicked => self.begun = Some([place(x, y); 2]),
            Event::Press(Button::Left, x, y) => self.end(place(x, y)),
            Event::Move(x, y) => match &mut self.begun {
                Some(ends) => ends[1] = place(x, y),
                None => return false,
            },
            Event::Release(Button::Left, x, y) => match self.begun {
                Some([from, _]) if from == place(x, y) => self.clicked = true,
                Some(_) if !self.clicked => self.end(place(x, y)),
                _ => return false,
            },
            Event::Press(Button::Right, x, y) => self.delete(c, place(x, y)),
            _ => return false,
        }
        true
    }

    /// The segment that is being drawn ends.
    fn end(&mut self, at: [f64; 2]) {
        self.clicked = false;
        if let Some([from, _]) = self.begun.take() {
            self.add([from, at]);
        }
    }

    /// Draws everything.
    pub(crate) fn draw(&self, c: &mut Context) {
        let size = c.window_size();
        c.matrix_mode(gl::PROJECTION);
        c.load_identity();
        project(c, size);
        c.color([1.0, 0.9, 0.4]);
        self.send(c);
        if let Some([from, to]) = self.begun {
            c.color([0.5, 0.7, 1.0]);
            c.begin(gl::LINES);
            c.vertex(from);
            c.vertex(to);
            c.end();
        }
    }

    /// The segments with their numbers as names.
    fn send(&self, c: &mut Context) {
        for (k, [from, to]) in self.segments.iter().enumerate() {
            c.load_name(k as u32);
            c.begin(gl::LINES);
            c.vertex(*from);
            c.vertex(*to);
            c.end();
        }
    }
}

/// Scene units are pixels.
fn project(c: &mut Context, [width, height]: [u32; 2]) {
    c.ortho_2d(0.0, width.into(), 0.0, height.into());
    c.matrix_mode(gl::MODELVIEW);
    c.load_identity();
}
