//! The exercise as a program: polygons are clicked, dragged and given their intensities.
//!
//! | input | what it does |
//! |---|---|
//! | click beside all vertices | adds a vertex to the open polygon, with the brush's depth and intensity |
//! | drag a vertex | moves it |
//! | right click on a vertex, Delete | removes it |
//! | wheel, Up and Down | intensity of the chosen vertex, or of the brush |
//! | Page up and Page down | its depth: up is farther |
//! | digits | intensity as nine parts of white |
//! | Enter, N | closes the polygon, the next click begins another |
//! | Tab | chooses the next vertex |
//! | P | the text's slips, or none |
//! | Z | depths in place of intensities |
//! | O | outlines and vertices, or not |
//! | C | removes everything |
//! | X, Escape | ends |

use senca_window::{Button, Canvas, Event, Flow, Key, Program};

use super::fill::PolygonPicture;
use super::{ScreenVertex, Slips};

/// What is behind the polygons.
const BACKGROUND: u32 = 0x20_3050;
const OUTLINE: u32 = 0xff_d040;
const CHOSEN: u32 = 0xff_3030;
/// Reach of the mouse around a vertex, in pixels.
const REACH: u32 = 6;
/// Most vertices; more are not taken.
const MAX_VERTICES: usize = 10_000;
/// Bounds of places either way, of intensity and of depth.
const FARTHEST: i32 = 1 << 15;
const LARGEST: i32 = 255;
const DEEPEST: i32 = 1_000_000;

/// A vertex by its polygon and its place in it.
type VertexName = (usize, usize);

/// The exercise with its polygons.
#[derive(Clone, Debug)]
pub struct PolygonApplet {
    polygons: Vec<Vec<ScreenVertex>>,
    /// Whether the last polygon takes more vertices.
    open: bool,
    brush: ScreenVertex,
    chosen: Option<VertexName>,
    held: bool,
    /// What P brings and takes away.
    slips: Slips,
    mended: bool,
    depths: bool,
    outlines: bool,
    size: (usize, usize),
}

impl PolygonApplet {
    /// The exercise over some polygons, in a window of this size, with these slips; where there are
    /// none, P brings all of them.
    #[must_use]
    pub fn new(polygons: Vec<Vec<ScreenVertex>>, size: (usize, usize), slips: Slips) -> Self {
        let mended = slips == Slips::MENDED;
        let slips = if mended { Slips::AS_PRINTED } else { slips };
        let brush = ScreenVertex::new(0, 0, 100, 255);
        let (open, chosen, held, depths, outlines) = (false, None, false, false, true);
        Self { polygons, open, brush, chosen, held, slips, mended, depths, outlines, size }
    }

    /// Beginning with depths in place of intensities, or not.
    #[must_use]
    pub fn showing_depths(mut self, depths: bool) -> Self {
        self.depths = depths;
        self
    }

    /// Beginning with outlines and vertices, or not.
    #[must_use]
    pub fn showing_outlines(mut self, outlines: bool) -> Self {
        self.outlines = outlines;
        self
    }

    /// The polygons as they are now.
    #[must_use]
    pub fn polygons(&self) -> &[Vec<ScreenVertex>] {
        &self.polygons
    }

    /// The picture of all polygons of three or more vertices.
    #[must_use]
    pub fn picture(&self, width: u32, height: u32) -> PolygonPicture {
        let slips = if self.mended { Slips::MENDED } else { self.slips };
        let mut picture = PolygonPicture::new(width, height);
        for polygon in self.polygons.iter().filter(|polygon| polygon.len() > 2) {
            picture.draw(polygon, &slips);
        }
        picture
    }

    /// All vertices by name.
    fn names(&self) -> impl Iterator<Item = (VertexName, ScreenVertex)> + '_ {
        let polygons = self.polygons.iter().enumerate();
        polygons
            .flat_map(|(p, vertices)| vertices.iter().enumerate().map(move |(v, &vertex)| ((p, v), vertex)))
    }

    /// The nearest vertex within reach.
    fn at(&self, x: i32, y: i32) -> Option<VertexName> {
        let distance = |vertex: &ScreenVertex| vertex.x.abs_diff(x).max(vertex.y.abs_diff(y));
        let (name, vertex) = self.names().min_by_key(|(_, vertex)| distance(vertex))?;
        (distance(&vertex) <= REACH).then_some(name)
    }

    /// The chosen vertex, or the brush for new ones.
    fn subject(&mut self) -> &mut ScreenVertex {
        match self.chosen {
            Some((p, v)) => &mut self.polygons[p][v],
            None => &mut self.brush,
        }
    }

    fn add(&mut self, x: i32, y: i32) {
        if self.names().count() >= MAX_VERTICES {
            return;
        }
        if !self.open {
            self.polygons.push(Vec::new());
            self.open = true;
        }
        let polygon = self.polygons.len() - 1;
        let bound = |n: i32| n.clamp(-FARTHEST, FARTHEST);
        self.polygons[polygon].push(ScreenVertex { x: bound(x), y: bound(y), ..self.brush });
        self.chosen = Some((polygon, self.polygons[polygon].len() - 1));
    }

    fn remove(&mut self, (p, v): VertexName) {
        self.polygons[p].remove(v);
        if self.polygons[p].is_empty() {
            self.open &= p + 1 < self.polygons.len();
            self.polygons.remove(p);
        }
        self.chosen = None;
    }

    fn brighten(&mut self, by: i32) {
        let subject = self.subject();
        subject.b = (subject.b + by).clamp(0, LARGEST);
        self.brush.b = self.subject().b;
    }

    fn deepen(&mut self, by: i32) {
        let subject = self.subject();
        subject.z = (subject.z + by).clamp(-DEEPEST, DEEPEST);
        self.brush.z = self.subject().z;
    }

    fn press(&mut self, button: Button, x: i32, y: i32) -> Flow {
        let found = self.at(x, y);
        match (button, found) {
            (Button::Left, Some(_)) => self.chosen = found,
            (Button::Left, None) => self.add(x, y),
            (Button::Right, Some(name)) => self.remove(name),
            _ => return Flow::Wait,
        }
        self.held = button == Button::Left;
        Flow::Redraw
    }

    fn drag(&mut self, x: i32, y: i32) -> Flow {
        let Some((p, v)) = self.chosen.filter(|_| self.held) else { return Flow::Wait };
        let bound = |n: i32| n.clamp(-FARTHEST, FARTHEST);
        let vertex = &mut self.polygons[p][v];
        (vertex.x, vertex.y) = (bound(x), bound(y));
        Flow::Redraw
    }

    fn key(&mut self, key: Key) -> Flow {
        match key {
            Key::Up => self.brighten(5),
            Key::Down => self.brighten(-5),
            Key::PageUp => self.deepen(5),
            Key::PageDown => self.deepen(-5),
            Key::Enter => self.close(),
            Key::Tab => self.choose_next(),
            Key::Delete | Key::Backspace => match self.chosen {
                Some(name) => self.remove(name),
                None => return Flow::Wait,
            },
            Key::Escape => return Flow::Quit,
            Key::Char(letter) => return self.letter(letter),
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn letter(&mut self, letter: char) -> Flow {
        match letter.to_ascii_lowercase() {
            digit @ '0'..='9' => {
                let level = digit.to_digit(10).unwrap_or(0) as i32 * LARGEST / 9;
                self.subject().b = level;
                self.brush.b = level;
            }
            'n' => self.close(),
            'p' => self.mended = !self.mended,
            'z' => self.depths = !self.depths,
            'o' => self.outlines = !self.outlines,
            'c' => {
                self.polygons.clear();
                (self.open, self.chosen) = (false, None);
            }
            'x' => return Flow::Quit,
            _ => return Flow::Wait,
        }
        Flow::Redraw
    }

    fn close(&mut self) {
        (self.open, self.chosen) = (false, None);
    }

    fn choose_next(&mut self) {
        let names: Vec<VertexName> = self.names().map(|(name, _)| name).collect();
        let place = self.chosen.and_then(|chosen| names.iter().position(|&name| name == chosen));
        self.chosen = names.get(place.map_or(0, |place| place + 1)).or(names.first()).copied();
    }

    fn draw_outlines(&self, canvas: &mut Canvas) {
        for (p, polygon) in self.polygons.iter().enumerate() {
            let open = self.open && p + 1 == self.polygons.len();
            let sides = if open { polygon.len().saturating_sub(1) } else { polygon.len() };
            for side in 0..sides {
                draw_side(canvas, polygon[side], polygon[(side + 1) % polygon.len()]);
            }
        }
        for (name, vertex) in self.names() {
            let color = if self.chosen == Some(name) { CHOSEN } else { OUTLINE };
            for (d, e) in (-2..=2).flat_map(|d| (-2..=2).map(move |e| (d, e))) {
                canvas.set(vertex.x.saturating_add(d), vertex.y.saturating_add(e), color);
            }
        }
    }
}

/// A line of dots, as many as the longer way has pixels, at most some thousands.
fn draw_side(canvas: &mut Canvas, a: ScreenVertex, b: ScreenVertex) {
    let steps = a.x.abs_diff(b.x).max(a.y.abs_diff(b.y)).clamp(1, 20_000);
    let at = |from: i32, to: i32, step: u32| {
        (f64::from(from) + (f64::from(to) - f64::from(from)) * f64::from(step) / f64::from(steps)).round()
            as i32
    };
    for step in (0..=steps).step_by(2) {
        canvas.set(at(a.x, b.x, step), at(a.y, b.y, step), OUTLINE);
    }
}

impl Program for PolygonApplet {
    fn title(&self) -> String {
        let subject = match self.chosen {
            Some((p, v)) => {
                let vertex = self.polygons[p][v];
                format!("vertex {v} of polygon {p}: {} {} z {} b {}", vertex.x, vertex.y, vertex.z, vertex.b)
            }
            None => format!("next vertex: z {} b {}", self.brush.z, self.brush.b),
        };
        let slips = if self.mended { "" } else { ", with slips of the text" };
        format!("Polygon shading{slips} - {subject}")
    }

    fn size(&self) -> (usize, usize) {
        self.size
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::KeyDown(key) => self.key(key),
            Event::Press(button, x, y) => self.press(button, x, y),
            Event::Move(x, y) => self.drag(x, y),
            Event::Release(..) => {
                self.held = false;
                Flow::Wait
            }
            Event::Wheel(turns) if turns.is_finite() => {
                self.brighten((turns * 5.0).clamp(-255.0, 255.0) as i32);
                Flow::Redraw
            }
            Event::Resize(width, height) => {
                self.size = (width, height);
                Flow::Redraw
            }
            _ => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        let picture = self.picture(canvas.width() as u32, canvas.height() as u32);
        *canvas = if self.depths { picture.depths(BACKGROUND) } else { picture.greys(BACKGROUND) };
        if self.outlines {
            self.draw_outlines(canvas);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applet() -> PolygonApplet {
        PolygonApplet::new(Vec::new(), (100, 80), Slips::MENDED)
    }

    fn click(applet: &mut PolygonApplet, x: i32, y: i32) {
        applet.event(Event::Press(Button::Left, x, y));
        applet.event(Event::Release(Button::Left, x, y));
    }

    fn press(applet: &mut PolygonApplet, key: Key) -> Flow {
        applet.event(Event::KeyDown(key))
    }

    fn drawn(applet: &mut PolygonApplet) -> Canvas {
        let mut canvas = Canvas::new(100, 80);
        applet.draw(&mut canvas);
        canvas
    }

    #[test]
    fn points_are_clicked_dragged_and_shaded() {
        let mut applet = applet();
        for (x, y) in [(10, 10), (60, 10), (30, 60)] {
            click(&mut applet, x, y);
        }
        assert_eq!(
            applet.polygons(),
            [vec![
                ScreenVertex::new(10, 10, 100, 255),
                ScreenVertex::new(60, 10, 100, 255),
                ScreenVertex::new(30, 60, 100, 255)
            ]]
        );
        press(&mut applet, Key::Char('0'));
        assert_eq!(applet.polygons()[0][2].b, 0);
        assert!(applet.title().ends_with("vertex 2 of polygon 0: 30 60 z 100 b 0"), "{}", applet.title());
        press(&mut applet, Key::Char('o'));
        let canvas = drawn(&mut applet);
        assert_eq!(canvas.get(35, 10), Some(0xff_ffff));
        assert!(canvas.get(30, 58).is_some_and(|c| c & 0xff < 20));
        assert_eq!(canvas.get(90, 70), Some(BACKGROUND));
        applet.event(Event::Press(Button::Left, 32, 58));
        applet.event(Event::Move(80, 70));
        applet.event(Event::Release(Button::Left, 80, 70));
        applet.event(Event::Move(5, 5));
        assert_eq!((applet.polygons()[0][2].x, applet.polygons()[0][2].y), (80, 70));
    }

    #[test]
    fn polygons_are_closed_and_vertices_removed() {
        let mut applet = applet();
        for (x, y) in [(10, 10), (60, 10), (30, 60)] {
            click(&mut applet, x, y);
        }
        press(&mut applet, Key::Enter);
        press(&mut applet, Key::PageDown);
        press(&mut applet, Key::Down);
        assert!(applet.title().ends_with("next vertex: z 95 b 250"), "{}", applet.title());
        click(&mut applet, 90, 40);
        assert_eq!(applet.polygons()[1], [ScreenVertex::new(90, 40, 95, 250)]);
        press(&mut applet, Key::Delete);
        assert_eq!(applet.polygons().len(), 1);
        press(&mut applet, Key::Tab);
        press(&mut applet, Key::Tab);
        applet.event(Event::Wheel(-10.0));
        assert_eq!(applet.polygons()[0][1].b, 205, "the first was 255");
        applet.event(Event::Press(Button::Right, 10, 10));
        assert_eq!(applet.polygons()[0].len(), 2);
        press(&mut applet, Key::Char('c'));
        assert!(applet.polygons().is_empty());
        click(&mut applet, 10, 10);
        assert_eq!(press(&mut applet, Key::Char('x')), Flow::Quit);
    }

    #[test]
    fn depth_hides_and_can_be_shown() {
        let square = |x: i32, z: i32, b: i32| {
            [[x, 10], [x + 40, 10], [x + 40, 60], [x, 60]]
                .map(|[x, y]| ScreenVertex::new(x, y, z, b))
                .to_vec()
        };
        let mut applet =
            PolygonApplet::new(vec![square(10, 5, 200), square(30, 9, 100)], (100, 80), Slips::MENDED);
        press(&mut applet, Key::Char('o'));
        let at = |canvas: &Canvas| [20, 40, 60].map(|x| canvas.get(x, 30).unwrap_or(0) & 0xff);
        assert_eq!(at(&drawn(&mut applet)), [200, 200, 100]);
        press(&mut applet, Key::Char('z'));
        assert_eq!(at(&drawn(&mut applet)), [255, 255, 64]);
        press(&mut applet, Key::Char('z'));
        press(&mut applet, Key::Char('p'));
        assert!(applet.title().contains("slips"));
        assert_eq!(at(&drawn(&mut applet)), [0, 0, 0], "every division is by 0");
    }

    #[test]
    fn anything_may_happen() {
        let mut applet = applet();
        for (x, y) in [(i32::MIN, i32::MAX), (i32::MAX, 0), (0, i32::MIN), (5, 5)] {
            click(&mut applet, x, y);
            applet.event(Event::Press(Button::Left, x, y));
            applet.event(Event::Move(y, x));
            applet.event(Event::Release(Button::Left, x, y));
        }
        applet.event(Event::Wheel(f32::NAN));
        applet.event(Event::Wheel(f32::MAX));
        for key in [Key::Tab, Key::Delete, Key::Backspace, Key::Up, Key::PageUp, Key::Home, Key::Char('é')] {
            press(&mut applet, key);
        }
        drawn(&mut applet);
        applet.event(Event::Resize(1, 1));
        applet.draw(&mut Canvas::new(1, 1));
        applet.draw(&mut Canvas::new(0, 0));
    }
}
