//! Exercise 5 as a program: the eye and what it looks at are moved by keys.

use senca_window::{Canvas, Event, Flow, Key, Program};

use super::{move_by_key, told};
use crate::lab::draw::{self, Sheet};
use crate::lab::shading::Camera;
use crate::lab::solid::Solid;
use crate::lab::vectors::Row3;
use crate::lab::view::{ViewMethod, ViewTransform};

/// A polygon, a solid, or both, as wires in perspective.
///
/// x, y, z move the eye towards smaller coordinates, X, Y, Z towards greater ones; Tab changes between
/// the eye and the point it looks at; m takes the next method, r goes back to the beginning.
#[derive(Clone, Debug)]
pub struct ViewProgram {
    polygon: Vec<Row3>,
    solid: Option<Solid>,
    first: Camera,
    camera: Camera,
    moves_target: bool,
    half_height: f64,
}

impl ViewProgram {
    /// A polygon (empty: none) and a solid, as `camera` sees them.
    #[must_use]
    pub fn new(polygon: Vec<Row3>, solid: Option<Solid>, camera: Camera) -> Self {
        let mut program =
            Self { polygon, solid, first: camera, camera, moves_target: false, half_height: 1.0 };
        program.half_height = program.reach();
        program
    }

    /// The camera as it is now.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    fn points(&self) -> impl Iterator<Item = Row3> {
        self.polygon.iter().chain(self.solid.iter().flat_map(|s| &s.vertices)).copied()
    }

    /// How far from the middle of the picture the points are, at the beginning.
    fn reach(&self) -> f64 {
        let Ok(view) = self.camera.transform() else { return 1.0 };
        let reach = |p: Row3| {
            let eye = view.eye_from_scene(p);
            let flat = (view.depth(eye) > 0.0).then(|| view.project_eye(eye)).flatten();
            flat.map_or(0.0, |p| p.x.abs().max(p.y.abs()))
        };
        let reach = self.points().map(reach).fold(0.0, f64::max);
        if reach > 0.0 && reach.is_finite() { reach.min(1e3 * view.distance) } else { 1.0 }
    }

    fn draw_view(&self, canvas: &mut Canvas, view: &ViewTransform) {
        let half = self.half_height;
        let sheet = Sheet::fitting([-half, -half], [half, half], (canvas.width(), canvas.height()));
        let mut edge = |a: Row3, b: Row3, color: u32| {
            if let Some([p, q]) = view.project_line(a, b) {
                draw::line(canvas, sheet.pixel(p), sheet.pixel(q), color);
            }
        };
        if let Some(solid) = &self.solid {
            for [a, b] in solid.edges() {
                edge(solid.vertices[a], solid.vertices[b], draw::BLACK);
            }
        }
        for (i, &a) in self.polygon.iter().enumerate() {
            edge(a, self.polygon[(i + 1) % self.polygon.len()], draw::RED);
        }
    }
}

impl Program for ViewProgram {
    fn title(&self) -> String {
        let method = match self.camera.method {
            ViewMethod::Axes => "axes",
            ViewMethod::AxesWithFlip => "axes and TZ",
            ViewMethod::Rotations => "rotations",
        };
        let moved = if self.moves_target { "G" } else { "O" };
        let (eye, target) = (told(self.camera.eye), told(self.camera.target));
        match self.camera.transform() {
            Ok(_) => format!("O {eye}, G {target}, by {method}; keys move {moved}"),
            Err(error) => format!("O {eye}, G {target}: {error}"),
        }
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::KeyDown(Key::Tab) => self.moves_target = !self.moves_target,
            Event::KeyDown(Key::Char('m')) => {
                self.camera.method = match self.camera.method {
                    ViewMethod::Axes => ViewMethod::Rotations,
                    ViewMethod::Rotations => ViewMethod::AxesWithFlip,
                    ViewMethod::AxesWithFlip => ViewMethod::Axes,
                };
            }
            Event::KeyDown(Key::Char('r')) => self.camera = self.first,
            Event::KeyDown(Key::Char(key)) => {
                let point = if self.moves_target { &mut self.camera.target } else { &mut self.camera.eye };
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
        canvas.fill(draw::WHITE);
        // Where there is no view, the title says why.
        if let Ok(view) = self.camera.transform() {
            self.draw_view(canvas, &view);
        }
    }
}
