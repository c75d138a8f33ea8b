//! Exercise 6 as a program: a curve, and the eye that moves along it.

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use crate::lab::LabError;
use crate::lab::bezier::{STEPS, curve, point_by_bernstein, visible_faces};
use crate::lab::draw::{self, Sheet};
use crate::lab::shading::{Camera, Light, Mode, SolidPicture};
use crate::lab::solid::Solid;
use crate::lab::vectors::{Row3, add, length, scale};
use crate::lab::view::ViewTransform;

/// Seconds for the whole curve.
const DURATION: f64 = 10.0;

/// Pixels from a control point within which it is taken hold of.
const REACH: f64 = 7.0;

/// On the left the curve with its control polygon and the solid, on the right what the eye on the curve
/// sees, with back faces left out.
///
/// Space starts and stops the eye, the arrows left and right move it by a hundredth, Home and End to
/// the ends. Control points can be dragged.
#[derive(Clone, Debug)]
pub struct CurveProgram {
    points: Vec<Row3>,
    curve: Vec<Row3>,
    solid: Solid,
    up: Row3,
    overview: Camera,
    reach: f64,
    t: f64,
    running: bool,
    held: Option<usize>,
    size: (usize, usize),
}

impl CurveProgram {
    /// A curve, and a solid that the eye looks at, which is scaled to [-1, 1].
    ///
    /// # Errors
    /// The solid has no size.
    pub fn new(points: Vec<Row3>, solid: &Solid, up: Row3, t: f64) -> Result<Self, LabError> {
        let solid = solid.normalized()?;
        let reach = points.iter().chain(&solid.vertices).map(|&p| length(p)).fold(1.0, f64::max);
        let overview = Camera { eye: scale([0.9, 0.75, 1.6], 2.5 * reach), ..Camera::default() };
        let curve = curve(&points);
        let size = (640, 320);
        Ok(Self { points, curve, solid, up, overview, reach, t, running: false, held: None, size })
    }

    /// The parameter of the eye.
    #[must_use]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// The control points as they are now.
    #[must_use]
    pub fn points(&self) -> &[Row3] {
        &self.points
    }

    fn eye(&self) -> Row3 {
        point_by_bernstein(&self.points, self.t)
    }

    /// Where the two pictures are: halves of the canvas side by side.
    fn sheets(&self) -> [Sheet; 2] {
        let (width, height) = self.size;
        let half = width as f64 / 4.0;
        let sheet = |reach: f64, x: f64| {
            let sheet = Sheet::fitting([-reach, -reach], [reach, reach], (width / 2, height));
            sheet.moved(x, 0.0)
        };
        [sheet(self.reach, 0.0), sheet(1.9, 2.0 * half)]
    }

    fn control_pixels(&self, view: &ViewTransform) -> Vec<[f64; 2]> {
        let sheet = self.sheets()[0];
        let pixel = |&p: &Row3| view.project(p).map_or([f64::NAN; 2], |p| sheet.pixel([p.x, p.y]));
        self.points.iter().map(pixel).collect()
    }

    fn hold(&mut self, x: i32, y: i32) {
        let Ok(view) = self.overview.transform() else { return };
        let near = |p: &[f64; 2]| (p[0] - f64::from(x)).hypot(p[1] - f64::from(y)) <= REACH;
        self.held = self.control_pixels(&view).iter().position(near);
    }

    /// Moves the point that is held, parallel to the picture.
    fn drag(&mut self, x: i32, y: i32) -> Option<()> {
        let view = self.overview.transform().ok()?;
        let held = self.held?;
        let [flat_x, flat_y] = self.sheets()[0].point([f64::from(x), f64::from(y)]);
        let before = view.eye_from_scene(self.points[held]);
        let share = before[2] / view.distance;
        let way = [flat_x * share - before[0], flat_y * share - before[1]];
        // The columns of the rotation are the axes of the eye.
        let axis = |k: usize| std::array::from_fn(|i| view.matrix.0[i][k]);
        let moved = add(scale(axis(0), way[0]), scale(axis(1), way[1]));
        self.points[held] = add(self.points[held], moved);
        self.curve = curve(&self.points);
        Some(())
    }

    fn draw_overview(&self, canvas: &mut Canvas) {
        let Ok(view) = self.overview.transform() else { return };
        let sheet = self.sheets()[0];
        let mut edge = |a: Row3, b: Row3, color: u32| {
            if let Some([p, q]) = view.project_line(a, b) {
                draw::line(canvas, sheet.pixel(p), sheet.pixel(q), color);
            }
        };
        for [a, b] in self.solid.edges() {
            edge(self.solid.vertices[a], self.solid.vertices[b], 0x60_6060);
        }
        self.points.windows(2).for_each(|pair| edge(pair[0], pair[1], 0x30_60c0));
        self.curve.windows(2).for_each(|pair| edge(pair[0], pair[1], 0xf0_d060));
        edge(self.eye(), [0.0; 3], 0x80_3030);
        for pixel in self.control_pixels(&view) {
            draw::dot(canvas, pixel, 2, 0x60_a0ff);
        }
        if let Some(eye) = view.project(self.eye()) {
            draw::dot(canvas, sheet.pixel([eye.x, eye.y]), 3, 0xff_6060);
        }
    }
}

impl Program for CurveProgram {
    fn title(&self) -> String {
        let seen = visible_faces(&self.solid, self.eye()).len();
        let keys = if self.running { "space stops" } else { "space starts" };
        format!("t = {:.2}, eye {}, {seen} faces seen; {keys}", self.t, super::told(self.eye()))
    }

    fn size(&self) -> (usize, usize) {
        (640, 320)
    }

    fn animated(&self) -> bool {
        self.running
    }

    fn event(&mut self, event: Event) -> Flow {
        let stepped =
            |t: f64, by: f64| ((t * STEPS as f64).round() + by).clamp(0.0, STEPS as f64) / STEPS as f64;
        match event {
            Event::KeyDown(Key::Char(' ')) => {
                self.running = !self.running;
                if self.running && self.t >= 1.0 {
                    self.t = 0.0;
                }
            }
            Event::KeyDown(Key::Left) => self.t = stepped(self.t, -1.0),
            Event::KeyDown(Key::Right) => self.t = stepped(self.t, 1.0),
            Event::KeyDown(Key::Home) => self.t = 0.0,
            Event::KeyDown(Key::End) => self.t = 1.0,
            Event::Tick(seconds) if self.running => {
                self.t = (self.t + seconds / DURATION).clamp(0.0, 1.0);
                self.running = self.t < 1.0;
            }
            Event::Press(Button::Left, x, y) => {
                self.hold(x, y);
                return Flow::Wait;
            }
            Event::Move(x, y) if self.held.is_some() => {
                if self.drag(x, y).is_none() {
                    return Flow::Wait;
                }
            }
            Event::Release(Button::Left, ..) => self.held = None,
            Event::Resize(width, height) => self.size = (width, height),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(0x10_1418);
        self.draw_overview(canvas);
        // What the eye sees may reach beyond its half, so it is drawn on a canvas of its own.
        let mut right = Canvas::new(canvas.width() / 2, canvas.height());
        let camera = Camera { eye: self.eye(), up: self.up, ..self.overview };
        let picture = SolidPicture {
            solid: &self.solid,
            light: Light::default(),
            mode: Mode::WireFront,
            half_height: 1.9,
        };
        let sheet = self.sheets()[1].moved(-(self.size.0 as f64) / 2.0, 0.0);
        // An eye that looks along "up" sees nothing for a moment.
        drop(picture.draw_on(&mut right, &camera, &sheet));
        let offset = (canvas.width() - right.width()) as i32;
        for y in 0..right.height() as i32 {
            for x in 0..right.width() as i32 {
                canvas.set(x + offset, y, right.get(x, y).unwrap_or(0));
            }
            canvas.set(offset, y, 0x60_6060);
        }
    }
}
