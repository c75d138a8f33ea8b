//! Exercise 3 as a program: click a polygon, then points to be tested.

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use crate::lab::LabError;
use crate::lab::draw::{self, Sheet};
use crate::lab::polygon::{Point2, Polygon, Position, Rounding};

/// Pixels from a vertex within which it is taken hold of.
const REACH: f64 = 7.0;

/// A convex polygon and points that are tested against it, with y upwards.
///
/// Clicks set vertices, either way round; Enter or the right button closes the polygon. Then clicks are
/// test points, and vertices can be dragged. Space fills the polygon or leaves it empty, `n` begins
/// anew.
#[derive(Clone, Debug)]
pub struct PolygonProgram {
    vertices: Vec<Point2>,
    closed: Option<Polygon>,
    points: Vec<Point2>,
    filled: bool,
    message: String,
    held: Option<usize>,
    sheet: Option<Sheet>,
    size: (usize, usize),
}

impl PolygonProgram {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            vertices: Vec::new(),
            closed: None,
            points: Vec::new(),
            filled: true,
            message: "Click the vertices, then press Enter".to_owned(),
            held: None,
            sheet: None,
            size: (400, 400),
        }
    }

    /// A polygon and test points.
    ///
    /// # Errors
    /// The polygon is not convex.
    pub fn with_polygon(vertices: Vec<Point2>, points: Vec<Point2>) -> Result<Self, LabError> {
        let mut program = Self { points, ..Self::new() };
        let polygon = Polygon::clockwise(vertices)?;
        let (low, high) = polygon.bounds();
        if low.iter().chain(&high).any(|v| !(0.0..400.0).contains(v)) {
            let all: Vec<_> = polygon.vertices().iter().chain(&program.points).copied().collect();
            program.sheet = Some(Sheet::around(&all, program.size));
        }
        program.vertices = polygon.vertices().to_vec();
        program.closed = Some(polygon);
        program.tell();
        Ok(program)
    }

    /// The polygon, once it is closed and convex.
    #[must_use]
    pub fn polygon(&self) -> Option<&Polygon> {
        self.closed.as_ref()
    }

    /// A point of the plane at a pixel, and back.
    fn point(&self, x: i32, y: i32) -> Point2 {
        let pixel = [f64::from(x), f64::from(y)];
        self.sheet.map_or([pixel[0], self.size.1 as f64 - 1.0 - pixel[1]], |s| s.point(pixel))
    }

    fn pixel(&self, point: Point2) -> [f64; 2] {
        self.sheet.map_or([point[0], self.size.1 as f64 - 1.0 - point[1]], |s| s.pixel(point))
    }

    fn tell(&mut self) {
        let Some(polygon) = &self.closed else { return };
        self.message = match self.points.last() {
            None => "Click points to be tested".to_owned(),
            Some(&[x, y]) => {
                let place = match polygon.position([x, y]) {
                    Position::Inside => "inside the polygon",
                    Position::Boundary => "on an edge of the polygon, which counts as inside",
                    Position::Outside => "outside the polygon",
                };
                format!("V ({x:.0}, {y:.0}) is {place}")
            }
        };
    }

    fn close(&mut self) {
        match Polygon::clockwise(self.vertices.clone()) {
            Ok(polygon) => {
                self.closed = Some(polygon);
                self.tell();
            }
            Err(error) => {
                self.closed = None;
                self.message = format!("{error}; n begins anew");
            }
        }
    }

    fn press(&mut self, x: i32, y: i32) {
        let pixel = [f64::from(x), f64::from(y)];
        if self.closed.is_none() {
            self.vertices.push(self.point(x, y));
            self.message = format!("{} vertices; Enter closes the polygon", self.vertices.len());
            return;
        }
        let near = |v: &Point2| {
            let p = self.pixel(*v);
            (p[0] - pixel[0]).hypot(p[1] - pixel[1]) <= REACH
        };
        self.held = self.vertices.iter().position(near);
        if self.held.is_none() {
            self.points.push(self.point(x, y));
            self.tell();
        }
    }

    fn fill(&self, canvas: &mut Canvas) {
        // In pixels with y upwards, as the procedure wants them.
        let height = canvas.height() as f64;
        let up = |v: &Point2| {
            let [x, y] = self.pixel(*v);
            [x, height - 1.0 - y]
        };
        let Ok(polygon) = Polygon::clockwise(self.vertices.iter().map(up).collect()) else { return };
        for span in polygon.spans() {
            let y = canvas.height() as i32 - 1 - span.y;
            let pixels = span.pixels(Rounding::Within);
            let (left, right) = ((*pixels.start()).max(0), (*pixels.end()).min(canvas.width() as i32 - 1));
            (left..=right).for_each(|x| canvas.set(x, y, draw::YELLOW));
        }
    }
}

impl Default for PolygonProgram {
    fn default() -> Self {
        Self::new()
    }
}

impl Program for PolygonProgram {
    fn title(&self) -> String {
        self.message.clone()
    }

    fn size(&self) -> (usize, usize) {
        (400, 400)
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::Press(Button::Left, x, y) => self.press(x, y),
            Event::KeyDown(Key::Enter) | Event::Press(Button::Right, ..) if self.closed.is_none() => {
                self.close();
            }
            Event::Move(x, y) => {
                let Some(held) = self.held else { return Flow::Wait };
                self.vertices[held] = self.point(x, y);
                self.close();
                if self.closed.is_none() {
                    self.held = None;
                }
            }
            Event::Release(Button::Left, ..) => self.held = None,
            Event::KeyDown(Key::Char(' ')) => self.filled = !self.filled,
            Event::KeyDown(Key::Char('n')) => *self = Self { size: self.size, ..Self::new() },
            Event::Resize(width, height) => self.size = (width, height),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(draw::WHITE);
        let corners: Vec<_> = self.vertices.iter().map(|&v| self.pixel(v)).collect();
        if self.closed.is_some() {
            if self.filled {
                self.fill(canvas);
            }
            draw::outline(canvas, &corners, draw::BLACK);
        } else {
            for pair in corners.windows(2) {
                draw::line(canvas, pair[0], pair[1], draw::BLACK);
            }
        }
        corners.iter().for_each(|&c| draw::dot(canvas, c, 2, draw::BLUE));
        for &point in &self.points {
            let inside = self.closed.as_ref().is_some_and(|p| p.position(point).is_inside());
            draw::dot(canvas, self.pixel(point), 3, if inside { draw::GREEN } else { draw::RED });
        }
    }
}
