//! The flight: the street, flown through by keys.

use senca_window::{Canvas, Event, Flow, Key, Program};

use super::angle::Angle;
use super::color_map::ColorMap;
use super::exact_frame::draw_frame_exactly;
use super::frame::{Arithmetic, Counters, Stages, Surface, Viewer, draw_frame};
use super::project::Projection;
use super::scene::World;
use super::texture::{Mapping, TEXEL_BITS, TextureArithmetic};
use super::{Search, street};

/// Width and height of the screen, in pixels (`HW_SCREEN_X_SIZE`, `HW_SCREEN_Y_SIZE`).
pub const SCREEN: [usize; 2] = [320, 200];

/// Fraction bits of where the eye is.
const EYE_BITS: u32 = 8;

/// What a step moves, in 1/256 of a unit.
const STRIDE: i32 = 5 << EYE_BITS;

/// Steps in a second while a key is held.
const STEPS_PER_SECOND: f64 = 25.0;

/// Most steps after one tick.
const MOST_STEPS: u32 = 50;

/// Most moments that are kept.
const MOST_MOMENTS: usize = 1 << 16;

/// What the screen shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Show {
    /// What the library draws.
    #[default]
    Library,
    /// The reference, in double precision.
    Exact,
    /// How far the two are apart: black where they agree.
    Difference,
}

/// A moment of a flight: enough to draw it again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Where the viewer is.
    pub viewer: Viewer,
    /// What the stages do.
    pub stages: Stages,
    /// What is shown.
    pub show: Show,
}

impl Moment {
    /// The picture, as colours `0x00RRGGBB` row by row, and what became of the faces.
    #[must_use]
    pub fn picture(&self, world: &World, [width, height]: [usize; 2]) -> (Vec<u32>, Counters) {
        let mut map = ColorMap::new(width, height);
        let counters = draw_frame(world, &self.viewer, &self.stages, &mut map);
        let drawn = colors(&map, world);
        if self.show == Show::Library {
            return (drawn, counters);
        }
        draw_frame_exactly(world, &self.viewer, &self.stages, &mut map);
        let exact = colors(&map, world);
        let picture = if self.show == Show::Exact { exact } else { difference(&drawn, &exact) };
        (picture, counters)
    }
}

fn colors(map: &ColorMap, world: &World) -> Vec<u32> {
    map.pixels().iter().map(|&c| world.palette[usize::from(c)]).collect()
}

/// The distance of the colours in each of red, green and blue, doubled.
fn difference(a: &[u32], b: &[u32]) -> Vec<u32> {
    let apart = |&a: &u32, &b: &u32| {
        let [_, r, g, b] =
            std::array::from_fn(|k| a.to_be_bytes()[k].abs_diff(b.to_be_bytes()[k]).saturating_mul(2));
        u32::from_be_bytes([0, r, g, b])
    };
    a.iter().zip(b).map(|(a, b)| apart(a, b)).collect()
}

/// What a held key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Ahead(i32),
    Aside(i32),
    Up(i32),
    Heading(i32),
    Pitch(i32),
    Roll(i32),
}

/// The program.
#[derive(Debug)]
pub struct Flight {
    world: World,
    now: Moment,
    /// In 1/256 of a unit; the library sees whole ones.
    eye: [i32; 3],
    held: Vec<Motion>,
    /// Of a step, from the ticks so far.
    elapsed: f64,
    counters: Counters,
    moments: Vec<Moment>,
    size: Option<(usize, usize)>,
}

impl Flight {
    /// Where the flight begins.
    pub const START: [i32; 3] = [-40, 34, -150];

    /// At the beginning of the street, with these stages.
    #[must_use]
    pub fn new(stages: Stages, show: Show) -> Self {
        let viewer = Viewer { eye: Self::START, ..Viewer::default() };
        Self {
            world: street::street(),
            now: Moment { viewer, stages, show },
            eye: Self::START.map(|c| c << EYE_BITS),
            held: Vec::new(),
            elapsed: 0.0,
            counters: Counters::default(),
            moments: Vec::new(),
            size: None,
        }
    }

    /// The world it flies through.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// This moment.
    #[must_use]
    pub fn now(&self) -> Moment {
        self.now
    }

    /// The moment after each tick so far, up to 65536.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    fn step(&mut self, motion: Motion) {
        let viewer = &mut self.now.viewer;
        let turn = |angle: &mut Angle, by| *angle = angle.turned(by);
        let mut go = |by: [i32; 3]| {
            // The world ends somewhere far out.
            let end = 30_000 << EYE_BITS;
            self.eye = std::array::from_fn(|k| (self.eye[k] + by[k]).clamp(-end, end));
        };
        let [x, z] = viewer.ahead(STRIDE);
        match motion {
            Motion::Ahead(sign) => go([x * sign, 0, z * sign]),
            Motion::Aside(sign) => go([z * sign, 0, -x * sign]),
            Motion::Up(sign) => go([0, STRIDE / 2 * sign, 0]),
            Motion::Heading(by) => turn(&mut viewer.heading, by),
            Motion::Pitch(by) => turn(&mut viewer.pitch, by),
            Motion::Roll(by) => turn(&mut viewer.roll, by),
        }
        viewer.eye = self.eye.map(|c| c >> EYE_BITS);
    }

    /// Time goes on: so many steps of each held key.
    fn tick(&mut self, seconds: f64) {
        self.elapsed += (seconds.max(0.0) * STEPS_PER_SECOND).min(f64::from(MOST_STEPS));
        let steps = self.elapsed.floor().min(f64::from(MOST_STEPS));
        self.elapsed -= steps;
        for motion in self.held.clone() {
            (0..steps as u32).for_each(|_| self.step(motion));
        }
        if self.moments.len() < MOST_MOMENTS {
            self.moments.push(self.now);
        }
    }

    /// A key that changes a stage; whether it is one.
    fn change(&mut self, key: char) -> bool {
        let stages = &mut self.now.stages;
        match key {
            't' => stages.surface = next(stages.surface, &SURFACES),
            'm' => stages.mapping = next(stages.mapping, &MAPPINGS),
            'f' => stages.arithmetic = next(stages.arithmetic, &Arithmetic::ALL),
            'b' => stages.texture_arithmetic = next(stages.texture_arithmetic, &TEXTURE_ARITHMETICS),
            'c' => stages.search = next(stages.search, &SEARCHES),
            'v' => stages.rejects_volume = !stages.rejects_volume,
            'n' => stages.cuts_at_plane = !stages.cuts_at_plane,
            'p' => stages.projection = next(stages.projection, &PROJECTIONS),
            'l' => stages.log_focus = next(stages.log_focus, &[8, 9, 7]),
            'd' => self.now.show = next(self.now.show, &[Show::Library, Show::Exact, Show::Difference]),
            'r' => {
                let viewer = Viewer { eye: Self::START, ..Viewer::default() };
                (self.now.viewer, self.eye) = (viewer, Self::START.map(|c| c << EYE_BITS));
            }
            _ => return false,
        }
        true
    }

    fn key_down(&mut self, key: Key) -> Flow {
        if key == Key::Escape {
            return Flow::Quit;
        }
        if let Some(motion) = motion(key) {
            // A key that is held repeats by itself; it moves by time.
            if !self.held.contains(&motion) {
                self.held.push(motion);
                self.step(motion);
            }
            return Flow::Redraw;
        }
        match key {
            Key::Char(c) if self.change(c) => Flow::Redraw,
            _ => Flow::Wait,
        }
    }
}

const SURFACES: [Surface; 5] =
    [Surface::Textured, Surface::Lit, Surface::Shaded, Surface::Flat, Surface::Wire];
const MAPPINGS: [Mapping; 7] = [
    Mapping::Subdivided(16),
    Mapping::Subdivided(8),
    Mapping::Subdivided(1),
    Mapping::Affine,
    Mapping::Subdivided(64),
    Mapping::Subdivided(32),
    Mapping::SubdividedAsPrinted(16),
];
const SEARCHES: [Search; 3] = [Search::Precise, Search::SimilarTriangles, Search::AsPrinted];
const PROJECTIONS: [Projection; 2] = [Projection::Perspective, Projection::Parallel { log_depth: 9 }];
const TEXTURE_ARITHMETICS: [TextureArithmetic; 3] = [
    TextureArithmetic { fraction_bits: TEXEL_BITS, is_32_bit: false },
    TextureArithmetic { fraction_bits: 8, is_32_bit: true },
    TextureArithmetic { fraction_bits: 16, is_32_bit: true },
];

/// What comes after `now`, round and round; the first where `now` is none of them.
fn next<T: Copy + PartialEq>(now: T, all: &[T]) -> T {
    let at = all.iter().position(|&one| one == now).map_or(0, |i| i + 1);
    all[at % all.len()]
}

fn motion(key: Key) -> Option<Motion> {
    Some(match key {
        Key::Up => Motion::Ahead(1),
        Key::Down => Motion::Ahead(-1),
        Key::Left => Motion::Heading(-1),
        Key::Right => Motion::Heading(1),
        Key::Char(',') => Motion::Aside(-1),
        Key::Char('.') => Motion::Aside(1),
        Key::PageUp => Motion::Up(1),
        Key::PageDown => Motion::Up(-1),
        Key::Char('a') => Motion::Pitch(1),
        Key::Char('z') => Motion::Pitch(-1),
        Key::Char('q') => Motion::Roll(-1),
        Key::Char('e') => Motion::Roll(1),
        _ => return None,
    })
}

/// What the mapping is called.
fn mapping_name(mapping: Mapping) -> String {
    match mapping {
        Mapping::Affine => "affine".to_owned(),
        Mapping::Subdivided(1) => "every pixel".to_owned(),
        Mapping::Subdivided(n) => format!("every {n} pixels"),
        Mapping::SubdividedAsPrinted(n) => format!("every {n} pixels as printed"),
    }
}

impl Program for Flight {
    fn title(&self) -> String {
        let Stages { arithmetic, surface, mapping, texture_arithmetic, search, .. } = self.now.stages;
        let [x, y, z] = self.now.viewer.eye;
        let surface = match surface {
            Surface::Wire => "wire".to_owned(),
            Surface::Flat => "flat".to_owned(),
            Surface::Shaded => "shaded".to_owned(),
            Surface::Textured | Surface::Lit => {
                let lit = if surface == Surface::Lit { "lit, " } else { "" };
                let narrow = match texture_arithmetic {
                    TextureArithmetic { is_32_bit: true, fraction_bits } => {
                        format!(" in 32 bits, {fraction_bits} of them fraction")
                    }
                    _ => String::new(),
                };
                format!("{lit}{}{narrow}", mapping_name(mapping))
            }
        };
        let search = match search {
            Search::Precise => "",
            Search::SimilarTriangles => ", cut by similar triangles",
            Search::AsPrinted => ", cut as printed",
        };
        let show = match self.now.show {
            Show::Library => "",
            Show::Exact => "exact: ",
            Show::Difference => "difference: ",
        };
        let Counters { faces, turned_away, outside, drawn, .. } = self.counters;
        format!(
            "{show}{surface}, {}{search} | {x} {y} {z} | {drawn} of {faces} faces, {turned_away} turned away, {outside} outside",
            arithmetic.name()
        )
    }

    fn size(&self) -> (usize, usize) {
        self.size.unwrap_or((2 * SCREEN[0], 2 * SCREEN[1]))
    }

    fn animated(&self) -> bool {
        true
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::KeyDown(key) => self.key_down(key),
            Event::KeyUp(key) => {
                let motion = motion(key);
                self.held.retain(|&held| Some(held) != motion);
                Flow::Wait
            }
            Event::Tick(seconds) => {
                let before = self.now;
                self.tick(seconds);
                if self.now == before { Flow::Wait } else { Flow::Redraw }
            }
            Event::Resize(width, height) => {
                self.size = Some((width, height));
                Flow::Redraw
            }
            Event::Press(..) | Event::Release(..) | Event::Move(..) | Event::Wheel(_) => Flow::Wait,
        }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        let (picture, counters) = self.now.picture(&self.world, SCREEN);
        self.counters = counters;
        enlarge(&picture, SCREEN, canvas);
    }
}

/// Shows a picture in the middle of the canvas, each pixel as a square as large as fits; what has no place is left out.
pub(crate) fn enlarge(picture: &[u32], [width, height]: [usize; 2], canvas: &mut Canvas) {
    let scale = (canvas.width() / width).min(canvas.height() / height).max(1);
    let left = canvas.width().saturating_sub(scale * width) / 2;
    let top = canvas.height().saturating_sub(scale * height) / 2;
    canvas.fill(0);
    let (columns, rows) = (canvas.width(), canvas.height());
    let pixels = canvas.pixels_mut();
    for y in top..rows.min(top + scale * height) {
        for x in left..columns.min(left + scale * width) {
            pixels[y * columns + x] = picture[(y - top) / scale * width + (x - left) / scale];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight() -> Flight {
        Flight::new(Stages::default(), Show::Library)
    }

    #[test]
    fn held_keys_move_by_time() {
        let mut flight = flight();
        assert_eq!(flight.event(Event::KeyDown(Key::Up)), Flow::Redraw);
        assert_eq!(flight.now().viewer.eye, [-40, 34, -145]);
        flight.event(Event::KeyDown(Key::Up));
        assert_eq!(flight.now().viewer.eye[2], -145, "a repeated key is held already");
        assert_eq!(flight.event(Event::Tick(0.4)), Flow::Redraw);
        assert_eq!(flight.now().viewer.eye[2], -95);
        flight.event(Event::KeyUp(Key::Up));
        assert_eq!(flight.event(Event::Tick(1.0)), Flow::Wait);
        flight.event(Event::KeyDown(Key::Right));
        flight.event(Event::Tick(63.0 / 25.0 - 0.5));
        assert_eq!(flight.now().viewer.heading.0, 51, "at most 50 steps a tick");
        assert_eq!(flight.moments().len(), 3);
    }

    #[test]
    fn time_in_small_parts_is_the_same_time() {
        let [mut one, mut other] = [flight(), flight()];
        for flight in [&mut one, &mut other] {
            flight.event(Event::KeyDown(Key::Char('a')));
        }
        one.event(Event::Tick(1.0));
        for _ in 0..64 {
            other.event(Event::Tick(1.0 / 64.0));
        }
        assert_eq!(one.now(), other.now());
        one.event(Event::Tick(f64::NAN));
        one.event(Event::Tick(f64::INFINITY));
        one.event(Event::Tick(-1.0));
        assert_eq!(one.moments().len(), 4);
    }

    #[test]
    fn keys_change_the_stages_and_come_round() {
        for (key, times) in [
            ('t', 5),
            ('m', 7),
            ('f', 4),
            ('b', 3),
            ('c', 3),
            ('v', 2),
            ('n', 2),
            ('p', 2),
            ('l', 3),
            ('d', 3),
        ] {
            let mut flight = flight();
            let (before, title) = (flight.now(), flight.title());
            flight.event(Event::KeyDown(Key::Char(key)));
            assert_ne!(flight.now(), before, "{key}");
            assert!("vnpl".contains(key) || flight.title() != title, "{key}");
            for _ in 1..times {
                flight.event(Event::KeyDown(Key::Char(key)));
            }
            assert_eq!(flight.now(), before, "{key}");
        }
        let mut flight = flight();
        flight.event(Event::KeyDown(Key::PageUp));
        flight.event(Event::KeyDown(Key::Char('r')));
        assert_eq!(flight.now().viewer.eye, Flight::START);
        assert_eq!(flight.event(Event::KeyDown(Key::Char('x'))), Flow::Wait);
        assert_eq!(flight.event(Event::KeyDown(Key::Escape)), Flow::Quit);
    }

    #[test]
    fn the_recorded_flight_stays_over_the_street() {
        let text = include_str!("../../../../samples/classic/game-flight.keys");
        let script = senca_window::Script::parse("game-flight.keys", text).expect("a script");
        let mut flight = flight();
        let last = script.run(&mut flight, |_, _| Ok::<_, ()>(())).expect("nothing is saved");
        assert_eq!((last.width(), last.height()), (640, 400));
        assert!(flight.moments().len() > 300 && flight.held.is_empty());
        for Moment { viewer, .. } in flight.moments() {
            assert!(viewer.eye[0].abs() < 150 && viewer.eye[1] > 10, "{viewer:?}");
        }
        let viewer = flight.now().viewer;
        assert!(viewer.eye[2] > 1000 && viewer.roll == Angle(0) && viewer.pitch == Angle(0), "{viewer:?}");
    }

    #[test]
    fn the_picture_fits_any_canvas() {
        let mut flight = flight();
        for (width, height) in [(640, 400), (1, 1), (0, 0), (100, 1000), (700, 410)] {
            flight.event(Event::Resize(width, height));
            assert_eq!(flight.size(), (width, height));
            flight.draw(&mut Canvas::new(width, height));
        }
        let mut canvas = Canvas::new(700, 410);
        flight.draw(&mut canvas);
        assert_eq!(canvas.get(0, 0), Some(0));
        assert_eq!(canvas.get(30, 5), canvas.get(31, 6));
        assert!(flight.title().contains("every 16 pixels, fixed10"));
    }

    #[test]
    fn the_difference_is_black_where_both_agree() {
        let mut flight = flight();
        flight.event(Event::KeyDown(Key::Char('d')));
        flight.event(Event::KeyDown(Key::Char('d')));
        let (picture, _) = flight.now().picture(flight.world(), SCREEN);
        let sky = picture[..SCREEN[0]].iter().filter(|&&c| c == 0).count();
        assert!(sky > 200 && picture.iter().any(|&c| c != 0));
        assert_eq!(difference(&[0x10_20_f0], &[0x14_10_10]), [0x08_20_ff]);
    }
}
