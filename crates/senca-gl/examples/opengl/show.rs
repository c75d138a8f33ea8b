//! A program of the chapter as an interactive one: what its window layer does.

use crate::Name;
use crate::editor::Editor;
use crate::exercises::{self, Texture, Turn};
use crate::samples;
use senca_gl::{Config, Context, gl};
use senca_window::{Button, Canvas, Event, Flow, Key, Program};

/// Seconds that the approach of exercise 5.7 takes.
const APPROACH: f64 = 6.0;

/// Radians that a key turns the eye by, and a pixel of dragging.
const KEY_TURN: f64 = 0.1;
const PIXEL_TURN: f64 = 0.01;

/// All filters for minification.
const MINIFIERS: [u32; 6] = [
    gl::NEAREST,
    gl::LINEAR,
    gl::NEAREST_MIPMAP_NEAREST,
    gl::LINEAR_MIPMAP_NEAREST,
    gl::NEAREST_MIPMAP_LINEAR,
    gl::LINEAR_MIPMAP_LINEAR,
];

/// All ways to apply a texture.
const MODES: [u32; 4] = [gl::MODULATE, gl::DECAL, gl::BLEND, gl::REPLACE];

/// A program with its window.
pub(crate) struct Show {
    program: Name,
    context: Context,
    /// Moment of the approach, 0 to 1, and whether it goes on.
    pub(crate) time: f64,
    pub(crate) running: bool,
    turn: Turn,
    minifier: usize,
    mode: usize,
    polygons: u32,
    dragged: Option<[i32; 2]>,
    pub(crate) editor: Editor,
}

impl Show {
    /// A program in a window of its own size, or another; `None` when there is no memory for it.
    pub(crate) fn new(program: Name, size: Option<[u32; 2]>) -> Option<Self> {
        let own = if program == Name::First { 300 } else { 400 };
        let mut show = Self {
            program,
            context: Context::new(Config { double_buffered: true, ..Config::default() }),
            time: 0.0,
            running: program == Name::Approach,
            turn: Turn::NONE,
            minifier: if program == Name::Mipmaps { 5 } else { 1 },
            mode: 0,
            polygons: gl::FILL,
            dragged: None,
            editor: Editor::default(),
        };
        show.reshape(size.unwrap_or([own; 2])).then_some(show)
    }

    /// The window has another size: the viewport is all of it.
    fn reshape(&mut self, [width, height]: [u32; 2]) -> bool {
        let resized = self.context.resize(width, height);
        self.context.viewport(0, 0, width as i32, height as i32);
        resized
    }

    /// Deletes the segment at a place of the line editor, which is in pixels from the lower left corner.
    pub(crate) fn delete(&mut self, place: [f64; 2]) {
        self.editor.delete(&mut self.context, place);
    }

    /// Draws into the back buffer and shows it; an error of OpenGL, or 0.
    pub(crate) fn display(&mut self) -> u32 {
        let (time, turn) = (self.time, self.turn);
        let texture = Texture { minifier: MINIFIERS[self.minifier], mode: MODES[self.mode] };
        let c = &mut self.context;
        let [width, height] = c.window_size();
        let aspect = f64::from(width) / f64::from(height);
        c.clear_color([0.0, 0.0, 0.0, 1.0]);
        c.clear(gl::COLOR_BUFFER_BIT | gl::DEPTH_BUFFER_BIT);
        c.polygon_mode(gl::FRONT_AND_BACK, self.polygons);
        match self.program {
            Name::First => samples::first(c, aspect),
            Name::Texture => samples::texture(c, aspect),
            Name::Curve => samples::curve(c, aspect),
            Name::Surface => samples::surface(c, aspect),
            Name::Primitives => exercises::primitives(c, aspect),
            Name::Waves => exercises::waves(c, aspect, turn),
            Name::Ellipses => exercises::ellipses(c, aspect),
            Name::Bodies => exercises::bodies(c, aspect, 1.0, None, turn),
            Name::Approach => exercises::bodies(c, aspect, time, None, turn),
            Name::Textures | Name::Mipmaps => exercises::bodies(c, aspect, 1.0, Some(texture), turn),
            Name::Patches => exercises::patches(c, aspect, turn),
            Name::Editor => self.editor.draw(c),
        }
        c.swap_buffers();
        c.get_error()
    }

    /// A key goes down; whether something is to be seen of it.
    fn key(&mut self, key: Key) -> bool {
        let textured = matches!(self.program, Name::Textures | Name::Mipmaps);
        match key {
            Key::Left => self.turn.around -= KEY_TURN,
            Key::Right => self.turn.around += KEY_TURN,
            Key::Up => self.turn.up += KEY_TURN,
            Key::Down => self.turn.up -= KEY_TURN,
            Key::Char('+') => self.nearer(1.0),
            Key::Char('-') => self.nearer(-1.0),
            Key::Home => self.turn = Turn::NONE,
            Key::Char('f') => {
                self.polygons = match self.polygons {
                    gl::FILL => gl::LINE,
                    gl::LINE => gl::POINT,
                    _ => gl::FILL,
                }
            }
            Key::Char('m') if textured => self.minifier = (self.minifier + 1) % MINIFIERS.len(),
            Key::Char('e') if textured => self.mode = (self.mode + 1) % MODES.len(),
            Key::Char(' ') if self.program == Name::Approach => {
                if self.time >= 1.0 {
                    self.time = 0.0;
                }
                self.running = !self.running;
            }
            _ => return false,
        }
        true
    }

    /// The eye comes nearer by so many steps.
    fn nearer(&mut self, steps: f64) {
        self.turn.distance = (self.turn.distance * 0.9f64.powf(steps)).clamp(0.3, 3.0);
    }

    /// Time goes on for the approach.
    fn idle(&mut self, seconds: f64) -> bool {
        if self.running {
            self.time = (self.time + seconds / APPROACH).min(1.0);
            self.running = self.time < 1.0;
            return true;
        }
        false
    }

    /// Dragging turns the eye.
    fn drag(&mut self, event: Event) -> bool {
        match (event, self.dragged) {
            (Event::Press(Button::Left, x, y), _) => self.dragged = Some([x, y]),
            (Event::Release(Button::Left, ..), _) => self.dragged = None,
            (Event::Move(x, y), Some([from_x, from_y])) => {
                self.turn.around -= PIXEL_TURN * f64::from(x - from_x);
                self.turn.up += PIXEL_TURN * f64::from(y - from_y);
                self.dragged = Some([x, y]);
                return true;
            }
            _ => {}
        }
        false
    }
}

impl Program for Show {
    fn title(&self) -> String {
        self.program.title().to_owned()
    }

    fn size(&self) -> (usize, usize) {
        let [width, height] = self.context.window_size();
        (width as usize, height as usize)
    }

    fn animated(&self) -> bool {
        self.running
    }

    fn event(&mut self, event: Event) -> Flow {
        let changed = match event {
            Event::KeyDown(Key::Escape | Key::Char('q')) => return Flow::Quit,
            Event::KeyDown(key) => self.key(key),
            Event::Wheel(notches) => {
                self.nearer(notches.into());
                true
            }
            Event::Resize(width, height) => {
                self.reshape([width as u32, height as u32]);
                true
            }
            Event::Tick(seconds) => self.idle(seconds),
            event if self.program == Name::Editor => self.editor.event(&mut self.context, event),
            event => self.drag(event),
        };
        if changed { Flow::Redraw } else { Flow::Wait }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        self.display();
        let width = canvas.width();
        // The lowest row of OpenGL's window comes first.
        let rows = self.context.window_pixels().chunks(width).rev();
        for (to, from) in canvas.pixels_mut().chunks_mut(width).zip(rows) {
            for (to, [r, g, b, _]) in to.iter_mut().zip(from) {
                *to = u32::from_be_bytes([0, *r, *g, *b]);
            }
        }
    }
}
