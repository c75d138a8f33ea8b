//! What the shortcuts cost, in numbers: texture error in texels, wobble of points in pixels.

use super::exact_frame::{ExactRotation, exact_plane};
use super::flight::Moment;
use super::frame::{Arithmetic, Counters, Stages, Surface, ViewerRotation, seen_face};
use super::project::{Lens, Projection};
use super::reference::ExactPlane;
use super::scene::{Body, World};
use super::texture::{
    Mapping, TEXEL_BITS, TextureArithmetic, TextureMapping, TexturePlane, TexturedPolygon,
    for_each_textured_pixel,
};
use super::{SCREEN, Search};

/// Mappings that are measured: linear, and exact every so many pixels.
pub const MEASURED_MAPPINGS: [Mapping; 5] = [
    Mapping::Affine,
    Mapping::Subdivided(32),
    Mapping::Subdivided(16),
    Mapping::Subdivided(8),
    Mapping::Subdivided(1),
];

/// Most moments of a flight that are measured; of longer ones that many, evenly.
pub const MEASURED_MOMENTS: usize = 100;

/// Largest and mean of many distances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorStatistics {
    /// How many were measured.
    pub count: u64,
    /// The largest.
    pub max: f64,
    /// How many were above 1.
    pub above_one: u64,
    sum_of_squares: f64,
}

impl ErrorStatistics {
    /// Takes in a distance; one that is not finite is left out.
    pub fn add(&mut self, distance: f64) {
        if distance.is_finite() {
            self.count += 1;
            self.max = self.max.max(distance);
            self.above_one += u64::from(distance > 1.0);
            self.sum_of_squares += distance * distance;
        }
    }

    /// The root of the mean square; 0 of none.
    #[must_use]
    pub fn rms(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.sum_of_squares / self.count as f64).sqrt() }
    }

    /// Share of those above 1.
    #[must_use]
    pub fn share_above_one(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.above_one as f64 / self.count as f64 }
    }
}

/// How much points and textures move because of whole numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wobble {
    /// The numbers of the rotation.
    pub arithmetic: Arithmetic,
    /// Distances of points on the screen from where they are exactly, in pixels, before they are set to whole ones.
    pub points: ErrorStatistics,
    /// The same after that.
    pub whole_points: ErrorStatistics,
    /// Distances of places in textures, in texels, where the mapping is exact but for its corners.
    pub texels: ErrorStatistics,
}

/// What was measured on a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Moments that were measured.
    pub moments: usize,
    /// Texture error of each mapping in the flight, in texels, against the exact quotient for the same corners. Only
    /// pixels that see the face itself count, hidden ones too.
    pub texture: Vec<(Mapping, ErrorStatistics)>,
    /// Texture error of each mapping on the wall of [`wall_errors`].
    pub wall: Vec<(Mapping, ErrorStatistics)>,
    /// Wobble for each arithmetic.
    pub wobble: Vec<Wobble>,
    /// What became of the faces, in all moments together.
    pub counters: Counters,
}

/// Measures the moments of a flight.
#[must_use]
pub fn measure(world: &World, moments: &[Moment]) -> Measures {
    let every = moments.len().div_ceil(MEASURED_MOMENTS).max(1);
    let mut measures = Measures {
        moments: 0,
        texture: MEASURED_MAPPINGS.map(|mapping| (mapping, ErrorStatistics::default())).to_vec(),
        wall: MEASURED_MAPPINGS.map(|mapping| (mapping, wall_errors(mapping))).to_vec(),
        wobble: Arithmetic::ALL.map(Wobble::new).to_vec(),
        counters: Counters::default(),
    };
    for moment in moments.iter().step_by(every) {
        // Textures, by perspective: without it all mappings are the same.
        let stages =
            Stages { surface: Surface::Textured, projection: Projection::Perspective, ..moment.stages };
        let moment = Moment { stages, ..*moment };
        measures.moments += 1;
        measure_textures(world, &moment, &mut measures);
        measures.wobble.iter_mut().for_each(|wobble| wobble.measure(world, &moment));
    }
    measures
}

/// The place of a pixel in texels, where it sees the face itself: from 0 to its side along both.
fn on_face(exact: Option<[f64; 2]>, side: f64) -> Option<[f64; 2]> {
    exact.filter(|place| place.iter().all(|t| (0.0..=side).contains(t)))
}

fn distance(exact: [f64; 2], place: [i64; 2]) -> f64 {
    let off = |k: usize| exact[k] - place[k] as f64 / f64::from(1 << TEXEL_BITS);
    off(0).hypot(off(1))
}

/// Calls `visit` with the plane and the corners on the screen of each textured face of a body that is seen.
fn for_each_texture(
    body: &Body,
    moment: &Moment,
    rotation: &ViewerRotation,
    counters: &mut Counters,
    mut visit: impl FnMut(&super::Face, &TexturePlane, &[[i32; 4]]),
) {
    let points = rotation.view(&body.points, &moment.viewer);
    for face in &body.faces {
        counters.faces += 1;
        if !face.faces(body.points[face.corners[0]], moment.viewer.eye) {
            counters.turned_away += 1;
            continue;
        }
        let Some(seen) = seen_face(face, &points, &moment.stages, counters) else { continue };
        counters.drawn += 1;
        if let Some(plane) = face.texture.and_then(|t| seen.plane(t.log_scale)) {
            visit(face, &plane, &seen.on_screen(moment.stages.lens(SCREEN)));
        }
    }
}

fn measure_textures(world: &World, moment: &Moment, measures: &mut Measures) {
    let lens = moment.stages.lens(SCREEN);
    let rotation = ViewerRotation::new(moment.stages.arithmetic, &moment.viewer);
    let Measures { texture, counters, .. } = measures;
    for body in &world.bodies {
        for_each_texture(body, moment, &rotation, counters, |_, plane, corners| {
            let polygon = TexturedPolygon {
                corners,
                plane: TextureMapping::new(plane, lens, moment.stages.texture_arithmetic),
            };
            for (mapping, errors) in texture.iter_mut() {
                add_errors(&polygon, &plane.into(), lens, *mapping, errors);
            }
        });
    }
}

fn add_errors(
    polygon: &TexturedPolygon<'_>,
    exact: &ExactPlane,
    lens: Lens,
    mapping: Mapping,
    errors: &mut ErrorStatistics,
) {
    for_each_textured_pixel(polygon, SCREEN, mapping, Search::Precise, |x, y, place| {
        if let Some(exact) = on_face(exact.at(lens, f64::from(x), f64::from(y)), exact.texels) {
            errors.add(distance(exact, place));
        }
    });
}

impl Wobble {
    fn new(arithmetic: Arithmetic) -> Self {
        let none = ErrorStatistics::default();
        Self { arithmetic, points: none, whole_points: none, texels: none }
    }

    fn measure(&mut self, world: &World, moment: &Moment) {
        let rotation = ViewerRotation::new(self.arithmetic, &moment.viewer);
        let exact = ExactRotation::new(&moment.viewer);
        for body in &world.bodies {
            let exact_points = exact.view(&body.points);
            self.measure_points(&rotation.view(&body.points, &moment.viewer), &exact_points, &moment.stages);
            self.measure_texels(body, moment, &rotation, &exact_points);
        }
    }

    /// Points that are in front of the clipping plane and on the screen.
    fn measure_points(&mut self, points: &[[i32; 3]], exact_points: &[[f64; 3]], stages: &Stages) {
        let lens = stages.lens(SCREEN);
        for (&point, &exact) in points.iter().zip(exact_points) {
            let [column, row] = lens.project_exact(exact);
            let is_seen = exact[2] >= f64::from(stages.plane())
                && (0.0..SCREEN[0] as f64).contains(&column)
                && (0.0..SCREEN[1] as f64).contains(&row);
            let Some(whole) = lens.project(point).filter(|_| is_seen) else { continue };
            let apart = |[x, y]: [f64; 2]| (x - column).hypot(y - row);
            self.points.add(apart(lens.project_exact(point.map(f64::from))));
            self.whole_points.add(apart(whole.map(f64::from)));
        }
    }

    fn measure_texels(
        &mut self,
        body: &Body,
        moment: &Moment,
        rotation: &ViewerRotation,
        exact_points: &[[f64; 3]],
    ) {
        let lens = moment.stages.lens(SCREEN);
        for_each_texture(body, moment, rotation, &mut Counters::default(), |face, plane, corners| {
            let Some(exact) = exact_plane(face, exact_points) else { return };
            let plane = TextureMapping::new(plane, lens, TextureArithmetic::default());
            let polygon = TexturedPolygon { corners, plane };
            add_errors(&polygon, &exact, lens, Mapping::Subdivided(1), &mut self.texels);
        });
    }
}

/// A wall whose depth grows fourfold from left to right over 160 pixels, under 64 texels.
const WALL: TexturePlane = TexturePlane {
    origin: [-8000, -3000, 25_600],
    anchor: [0; 2],
    u: [40_000, 0, 76_800],
    v: [0, 6000, 0],
    log_scale: 6,
};

/// A strip of the wall along the horizon, on a screen of 320 x 200 with a focus of 256: x, y, u and v of its corners.
const WALL_CORNERS: [[i32; 4]; 4] =
    [[80, 96, 0, 32 << 8], [240, 96, 64 << 8, 32 << 8], [240, 104, 64 << 8, 32 << 8], [80, 104, 0, 32 << 8]];

/// Texture error along u of a mapping on a wall whose depth goes from 100 to 400 over 160 pixels and 64 texels.
///
/// Linear it is at most 64 / 3 texels, at two thirds of the way.
#[must_use]
pub fn wall_errors(mapping: Mapping) -> ErrorStatistics {
    let lens = Lens::new(SCREEN[0], SCREEN[1]);
    let exact = ExactPlane::from(&WALL);
    let plane = TextureMapping::new(&WALL, lens, TextureArithmetic::default());
    let polygon = TexturedPolygon { corners: &WALL_CORNERS, plane };
    let mut errors = ErrorStatistics::default();
    for_each_textured_pixel(&polygon, SCREEN, mapping, Search::Precise, |x, y, [u, _]| {
        if let Some([exact, _]) = exact.at(lens, f64::from(x), f64::from(y)) {
            errors.add(distance([exact, 0.0], [u, 0]));
        }
    });
    errors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::game::{Angle, Flight, Show, Viewer, street};

    #[test]
    fn the_wall_has_known_errors() {
        let known = [
            (Mapping::Affine, 21.33),
            (Mapping::Subdivided(160), 21.33),
            (Mapping::Subdivided(32), 3.74),
            (Mapping::Subdivided(16), 1.29),
            (Mapping::Subdivided(8), 0.39),
            (Mapping::Subdivided(4), 0.11),
            (Mapping::Subdivided(1), 0.0),
        ];
        for (mapping, max) in known {
            let errors = wall_errors(mapping);
            assert!((errors.max - max).abs() < 0.015, "{mapping:?}: {}", errors.max);
            assert!(errors.rms() <= errors.max && errors.count == 161 * 9);
        }
    }

    #[test]
    fn a_flight_is_measured() {
        let world = street();
        let viewer = Viewer { eye: [-60, 34, 300], heading: Angle(21), ..Viewer::default() };
        let moment = Moment { viewer, ..Flight::new(Stages::default(), Show::Library).now() };
        let measures = measure(&world, &[moment]);
        let errors: Vec<_> = measures.texture.iter().map(|(_, errors)| *errors).collect();
        assert!(errors.windows(2).all(|w| w[0].rms() > w[1].rms()), "finer is better: {errors:?}");
        assert!(errors[0].max > 5.0 && errors[4].max < 0.01, "{errors:?}");
        let wobble = |k: usize| measures.wobble[k].points.rms();
        assert!(wobble(0) < wobble(2) && wobble(2) < wobble(3), "float, then 10 bits, then 8");
        assert!(measures.wobble.iter().all(|w| w.points.count > 100 && w.texels.rms() > 0.05));
        let Counters { faces, turned_away, outside, drawn, .. } = measures.counters;
        assert_eq!(faces, turned_away + outside + drawn);
    }

    #[test]
    fn long_flights_are_measured_evenly() {
        let world = street();
        let nothing = World { bodies: vec![], ..world };
        let moment = Flight::new(Stages::default(), Show::Library).now();
        assert_eq!(measure(&nothing, &vec![moment; 1000]).moments, 100);
        assert_eq!(measure(&nothing, &vec![moment; 101]).moments, 51);
        let empty = measure(&nothing, &[]);
        assert_eq!((empty.moments, empty.texture[0].1.rms()), (0, 0.0));
        assert_eq!(empty.wobble[0].points.share_above_one(), 0.0);
    }

    #[test]
    fn statistics_are_what_they_say() {
        let mut errors = ErrorStatistics::default();
        [3.0, 0.0, f64::NAN, 1.0, f64::INFINITY, 0.0].iter().for_each(|&d| errors.add(d));
        assert_eq!((errors.count, errors.max, errors.above_one), (4, 3.0, 1));
        assert!((errors.rms() - 2.5f64.sqrt()).abs() < 1e-15);
        assert_eq!(errors.share_above_one(), 0.25);
    }
}
