//! Light from beyond the scene.

use std::f64::consts::{PI, TAU};

use senca_math::LinearRgb;
use senca_math::glam::{DVec3, Vec3};
use senca_scene::{Background, Environment, Scene};

use crate::Occluders;

/// Rows of the picture of surroundings that regions are cut from; finer pictures are averaged.
const MOST_ROWS: u32 = 256;

/// What is around the scene, as seen by surfaces.
#[derive(Clone, Debug)]
pub(super) enum Sky {
    /// From `bottom` straight down to `top` straight up, looked at in directions spread as the cosine
    /// weighs them about +z.
    Gradient { bottom: LinearRgb, top: LinearRgb, directions: Vec<DVec3> },
    /// Regions of surroundings: a unit direction, and what a white surface that faces it shows.
    Regions(Vec<(DVec3, LinearRgb)>),
}

impl Sky {
    /// `None` where the background is black, or nothing was said of it.
    pub(super) fn new(scene: &Scene, directions: u32) -> Option<Self> {
        let spread = || (0..directions).map(|i| cosine_direction(i, directions)).collect();
        let (bottom, top) = match scene.background {
            Background::None => return None,
            Background::Color(color) => (color, color),
            Background::Gradient { bottom, top } => (bottom, top),
            Background::Environment { .. } => {
                let environment = Environment::of_background(scene, scene.background)?;
                let regions = regions(&environment, directions as usize);
                return (!regions.is_empty()).then_some(Self::Regions(regions));
            }
        };
        let dark = bottom.max_component() <= 0.0 && top.max_component() <= 0.0;
        (!dark).then(|| Self::Gradient { bottom, top, directions: spread() })
    }

    pub(super) fn at(&self, occluders: &Occluders, place: DVec3, normal: DVec3) -> LinearRgb {
        let passed =
            |direction: DVec3| occluders.transmittance(place, place + direction * occluders.beyond(place));
        let mut sum = LinearRgb::BLACK;
        match self {
            Self::Gradient { bottom, top, directions } => {
                let (x, y) = normal.any_orthonormal_pair();
                for d in directions {
                    let direction = x * d.x + y * d.y + normal * d.z;
                    let seen = bottom.lerp(*top, 0.5 + 0.5 * direction.y as f32);
                    sum += seen * passed(direction);
                }
                sum * (directions.len() as f32).recip()
            }
            Self::Regions(regions) => {
                for &(direction, light) in regions {
                    let cos = direction.dot(normal);
                    if cos > 0.0 {
                        sum += light * passed(direction) * cos as f32;
                    }
                }
                sum
            }
        }
    }
}

/// The `i`th of `n` directions about +z, spread evenly by the cosine: Hammersley's points on the disc,
/// raised to the hemisphere (Malley).
pub(crate) fn cosine_direction(i: u32, n: u32) -> DVec3 {
    let u = (f64::from(i) + 0.5) / f64::from(n);
    // Half a step off, so that no direction lies on an axis.
    let v = f64::from(i.reverse_bits()) / f64::from(u32::MAX) + 0.5 / f64::from(n);
    let (sin, cos) = (TAU * v).sin_cos();
    let radius = u.sqrt();
    DVec3::new(radius * cos, radius * sin, (1.0 - u).sqrt())
}

/// A cell of the surroundings: its direction, and radiance times solid angle over pi.
#[derive(Clone, Copy, Debug)]
struct Cell {
    direction: DVec3,
    light: LinearRgb,
}

/// A part of the picture that is a rectangle of cells: columns and rows from, to.
type Region = [[usize; 2]; 2];

/// About `count` regions of equal light: the brightest of all regions is halved across its longer
/// side where both halves are as bright, until there are enough.
fn regions(environment: &Environment<'_>, count: usize) -> Vec<(DVec3, LinearRgb)> {
    let grid = Grid::new(environment);
    let mut regions: Vec<(Region, f64)> = Vec::new();
    let whole = [[0, grid.columns], [0, grid.rows]];
    regions.push((whole, grid.brightness(&whole)));
    while regions.len() < count {
        let divisible = regions.iter().enumerate().filter(|(_, (region, _))| grid.halves(region).is_some());
        let Some(brightest) = divisible.max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(i, _)| i) else { break };
        let Some(halves) = grid.halves(&regions[brightest].0) else { break };
        let [first, second] = halves.map(|half| (half, grid.brightness(&half)));
        regions[brightest] = first;
        regions.push(second);
    }
    regions.iter().filter_map(|(region, _)| grid.lamp(region)).collect()
}

/// The surroundings as cells.
struct Grid {
    columns: usize,
    rows: usize,
    cells: Vec<Cell>,
}

impl Grid {
    fn new(environment: &Environment<'_>) -> Self {
        let (width, height) = environment.size();
        let step = height.div_ceil(MOST_ROWS).max(1);
        let (columns, rows) = (width.div_ceil(step) as usize, height.div_ceil(step) as usize);
        let mut cells = Vec::with_capacity(columns * rows);
        for row in 0..rows as u32 {
            for column in 0..columns as u32 {
                cells.push(cell(environment, [column * step, row * step], step));
            }
        }
        Self { columns, rows, cells }
    }

    fn of<'g>(&'g self, [across, down]: &Region) -> impl Iterator<Item = &'g Cell> {
        let [from, to] = *across;
        (down[0]..down[1])
            .flat_map(move |row| &self.cells[row * self.columns + from..row * self.columns + to])
    }

    fn brightness(&self, region: &Region) -> f64 {
        let sum: f64 = self.of(region).map(|cell| f64::from(cell.light.luminance())).sum();
        if sum.is_finite() { sum.max(0.0) } else { 0.0 }
    }

    /// The region in two of about equal brightness, across its longer side on the sphere.
    fn halves(&self, region: &Region) -> Option<[Region; 2]> {
        let [across, down] = *region;
        let middle = (down[0] + down[1]) as f64 / (2 * self.rows) as f64;
        let width = (across[1] - across[0]) as f64 * TAU / self.columns as f64 * (PI * middle).sin();
        let height = (down[1] - down[0]) as f64 * PI / self.rows as f64;
        let longer = usize::from(height > width);
        let axis = if region[longer][1] - region[longer][0] > 1 { longer } else { 1 - longer };
        let [from, to] = region[axis];
        if to - from < 2 {
            return None;
        }
        let slice = |k: usize| {
            let mut slice = *region;
            slice[axis] = [k, k + 1];
            self.brightness(&slice)
        };
        let half = 0.5 * self.brightness(region);
        let mut sum = 0.0;
        let cut = (from..to).find(|&k| {
            sum += slice(k);
            sum >= half
        });
        let cut = (cut.unwrap_or(from) + 1).clamp(from + 1, to - 1);
        let (mut first, mut second) = (*region, *region);
        (first[axis], second[axis]) = ([from, cut], [cut, to]);
        Some([first, second])
    }

    /// All light of a region from its middle by brightness.
    fn lamp(&self, region: &Region) -> Option<(DVec3, LinearRgb)> {
        let light = self.of(region).fold(LinearRgb::BLACK, |sum, cell| sum + cell.light);
        let toward: DVec3 =
            self.of(region).map(|cell| cell.direction * f64::from(cell.light.luminance())).sum();
        let usable = light.is_finite() && light.max_component() > 0.0;
        usable.then(|| Some((toward.try_normalize()?, light)))?
    }
}

/// The mean over `step` x `step` texels.
fn cell(environment: &Environment<'_>, [left, top]: [u32; 2], step: u32) -> Cell {
    let (width, height) = environment.size();
    let (right, bottom) = ((left + step).min(width), (top + step).min(height));
    let edge = |row: u32| (PI * f64::from(row) / f64::from(height)).cos();
    let mut light = LinearRgb::BLACK;
    for row in top..bottom {
        let solid_angle = (edge(row) - edge(row + 1)) * TAU / f64::from(width);
        for column in left..right {
            light += environment.texel_color(column, row) * (solid_angle / PI) as f32;
        }
    }
    let middle = |a: u32, b: u32, n: u32| (a + b) as f32 / (2 * n) as f32;
    let direction: Vec3 = environment.direction([middle(left, right, width), middle(top, bottom, height)]);
    Cell { direction: direction.as_dvec3().normalize_or(DVec3::Y), light }
}
