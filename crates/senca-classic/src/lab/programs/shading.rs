//! Exercise 7 as a program: a solid, shaded in each way, with eye and light moved by keys.

use senca_window::{Canvas, Event, Flow, Key, Program};

use super::{move_by_key, told};
use crate::lab::LabError;
use crate::lab::shading::{Camera, Light, Mode, SolidPicture};
use crate::lab::solid::Solid;

/// A solid, scaled to [-1, 1], in perspective.
///
/// 1 shows all edges, 2 those of front faces, 3 constant and 4 Gouraud shading. x, y, z and X, Y, Z
/// move the eye, after Tab the light, and after Tab again the eye.
#[derive(Clone, Debug)]
pub struct ShadingProgram {
    solid: Solid,
    camera: Camera,
    light: Light,
    mode: Mode,
    moves_light: bool,
}

impl ShadingProgram {
    /// A solid with its eye, its light and the way it is drawn at first.
    ///
    /// # Errors
    /// The solid has no size.
    pub fn new(solid: &Solid, camera: Camera, light: Light, mode: Mode) -> Result<Self, LabError> {
        Ok(Self { solid: solid.normalized()?, camera, light, mode, moves_light: false })
    }

    /// How it is drawn.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.mode
    }
}

impl Program for ShadingProgram {
    fn title(&self) -> String {
        let mode = match self.mode {
            Mode::Wire => "all edges",
            Mode::WireFront => "edges of front faces",
            Mode::Constant => "constant shading",
            Mode::Gouraud => "Gouraud shading",
        };
        let moved = if self.moves_light { "the light" } else { "the eye" };
        let (eye, light) = (told(self.camera.eye), told(self.light.position));
        match self.camera.transform() {
            Ok(_) => format!("{mode}; eye {eye}, light {light}; keys move {moved}"),
            Err(error) => format!("eye {eye}: {error}"),
        }
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::KeyDown(Key::Char('1')) => self.mode = Mode::Wire,
            Event::KeyDown(Key::Char('2')) => self.mode = Mode::WireFront,
            Event::KeyDown(Key::Char('3')) => self.mode = Mode::Constant,
            Event::KeyDown(Key::Char('4')) => self.mode = Mode::Gouraud,
            Event::KeyDown(Key::Tab) => self.moves_light = !self.moves_light,
            Event::KeyDown(Key::Char(key)) => {
                let point = if self.moves_light { &mut self.light.position } else { &mut self.camera.eye };
                if !move_by_key(point, key) {
                    return Flow::Wait;
                }
            }
            Event::Resize(..) => {}
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(0x10_1418);
        let picture =
            SolidPicture { solid: &self.solid, light: self.light, mode: self.mode, half_height: 1.8 };
        // Where there is no view, the title says why.
        drop(picture.draw(canvas, &self.camera));
    }
}
