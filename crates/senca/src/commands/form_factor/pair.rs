//! Pairs whose form factor is known: their shapes and the number.

use std::f64::consts::{PI, TAU};

use senca::math::glam::DVec3;
use senca::radiosity::PatchPolygon;
use senca::radiosity::form_factor::closed_form;

use crate::cli::Failure;

/// A pair by its name, with what its numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Parallel,
    Perpendicular,
    Tilted,
    Disc,
    PatchSphere,
    DiscSphere,
    Spheres,
}

/// Two shapes, as patches.
#[derive(Debug)]
pub(super) struct Pair {
    /// In words.
    pub(super) title: String,
    pub(super) from: Vec<PatchPolygon>,
    pub(super) to: Vec<PatchPolygon>,
    /// The factor by its formula.
    pub(super) exact: f64,
}

/// Rows of patches from pole to pole of a sphere, and patches in each.
const ROWS: usize = 12;
const COLUMNS: usize = 24;

/// Edge of the square that stands for a point, as a share of the distance of what it sees.
const SMALL: f64 = 1e-3;

/// Rings and sectors that a disc is divided in.
const RINGS: usize = 3;
const SECTORS: usize = 32;

impl Kind {
    pub(super) const ALL: [Self; 7] = [
        Self::Parallel,
        Self::Perpendicular,
        Self::Tilted,
        Self::Disc,
        Self::PatchSphere,
        Self::DiscSphere,
        Self::Spheres,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Parallel => "parallel",
            Self::Perpendicular => "perpendicular",
            Self::Tilted => "tilted",
            Self::Disc => "disc",
            Self::PatchSphere => "patch-sphere",
            Self::DiscSphere => "disc-sphere",
            Self::Spheres => "spheres",
        }
    }

    /// Names of its numbers, as in the help.
    pub(super) fn numbers(self) -> &'static [&'static str] {
        match self {
            Self::Parallel => &["W", "H", "D"],
            Self::Perpendicular => &["W", "H1", "H2"],
            Self::Tilted => &["W", "H1", "H2", "DEGREES"],
            Self::PatchSphere => &["R", "D", "DEGREES"],
            Self::Disc | Self::DiscSphere | Self::Spheres => &["R1", "R2", "D"],
        }
    }

    /// The pair with the numbers of the command line.
    pub(super) fn pair(self, texts: &[String]) -> Result<Pair, Failure> {
        let numbers = self.parse(texts)?;
        Ok(match (self, &numbers[..]) {
            (Self::Parallel, &[w, h, d]) => parallel(w, h, d),
            (Self::Perpendicular, &[w, h1, h2]) => perpendicular(w, h1, h2),
            (Self::Tilted, &[w, h1, h2, degrees]) => tilted(w, h1, h2, degrees),
            (Self::PatchSphere, &[r, d, degrees]) => {
                apart(r, d)?;
                patch_sphere(r, d, degrees)
            }
            (Self::DiscSphere, &[r1, r2, d]) => {
                apart(r2, d)?;
                disc_sphere(r1, r2, d)
            }
            (Self::Spheres, &[r1, r2, d]) => {
                apart(r1 + r2, d)?;
                spheres(r1, r2, d)
            }
            (_, numbers) => disc(numbers[0], numbers[1], numbers[2]),
        })
    }

    fn parse(self, texts: &[String]) -> Result<Vec<f64>, Failure> {
        let names = self.numbers();
        if texts.len() != names.len() {
            let (name, wanted, given) = (self.name(), names.join(" "), texts.len());
            return Err(Failure::usage(format!(
                "'{name}' needs {} numbers, {wanted}, but got {given}",
                names.len()
            )));
        }
        let number = |(text, name): (&String, &&str)| match text.parse::<f64>() {
            Ok(v) if *name == "DEGREES" && v > 0.0 && v < 180.0 => Ok(v),
            Ok(v) if *name != "DEGREES" && v > 0.0 && v.is_finite() => Ok(v),
            Ok(_) if *name == "DEGREES" => {
                Err(Failure::usage(format!("DEGREES is {text}, but must be between 0 and 180")))
            }
            Ok(_) => Err(Failure::usage(format!("{name} is {text}, but must be greater than 0 and finite"))),
            Err(_) => Err(Failure::usage(format!("{name} is '{text}', which is not a number"))),
        };
        texts.iter().zip(names).map(number).collect()
    }
}

/// Refuses what lies in a sphere.
fn apart(least: f64, distance: f64) -> Result<(), Failure> {
    match distance >= least {
        true => Ok(()),
        false => {
            Err(Failure::usage(format!("D is {distance}, but must be at least {least}: one is in the other")))
        }
    }
}

/// The rectangle `corner`, `corner + u`, `corner + u + v`, `corner + v`; its front is where u x v points.
fn rectangle(corner: DVec3, u: DVec3, v: DVec3) -> Vec<PatchPolygon> {
    vec![PatchPolygon::quad([corner, corner + u, corner + u + v, corner + v])]
}

fn parallel(w: f64, h: f64, d: f64) -> Pair {
    Pair {
        title: format!("two rectangles of {w} x {h}, facing each other at distance {d}"),
        from: rectangle(DVec3::ZERO, DVec3::X * w, DVec3::Y * h),
        to: rectangle(DVec3::Z * d, DVec3::Y * h, DVec3::X * w),
        exact: closed_form::parallel_rectangles(w, h, d),
    }
}

fn perpendicular(w: f64, h1: f64, h2: f64) -> Pair {
    let mut pair = tilted(w, h1, h2, 90.0);
    pair.title =
        format!("a rectangle of {w} x {h1} and one of {w} x {h2} that share the edge {w} at a right angle");
    pair.to = rectangle(DVec3::ZERO, DVec3::Z * h2, DVec3::X * w);
    pair.exact = closed_form::perpendicular_rectangles(w, h1, h2);
    pair
}

fn tilted(w: f64, h1: f64, h2: f64, degrees: f64) -> Pair {
    let (sin, cos) = degrees.to_radians().sin_cos();
    Pair {
        title: format!(
            "a rectangle of {w} x {h1} and one of {w} x {h2} that share the edge {w} at {degrees} degrees"
        ),
        from: rectangle(DVec3::ZERO, DVec3::X * w, DVec3::Y * h1),
        to: rectangle(DVec3::ZERO, DVec3::new(0.0, cos, sin) * h2, DVec3::X * w),
        exact: closed_form::tilted_rectangles(w, h1, h2, degrees.to_radians()),
    }
}

fn disc(r1: f64, r2: f64, d: f64) -> Pair {
    Pair {
        title: format!(
            "discs of radius {r1} and {r2}, facing each other on one axis at distance {d}; as polygons of {SECTORS} corners and the discs' areas"
        ),
        from: disc_patches(r1, |x, y| DVec3::new(x, y, 0.0)),
        to: disc_patches(r2, |x, y| DVec3::new(y, x, d)),
        exact: closed_form::coaxial_discs(r1, r2, d),
    }
}

/// Rings of equal width, of quadrilaterals and in the middle triangles.
fn disc_patches(radius: f64, place: impl Fn(f64, f64) -> DVec3) -> Vec<PatchPolygon> {
    let angle = TAU / SECTORS as f64;
    // A little larger, so that the polygon has the area of the disc.
    let outer = radius * (2.0 * PI / (SECTORS as f64 * angle.sin())).sqrt();
    let at = |ring: usize, sector: usize| {
        let (sin, cos) = (angle * (sector % SECTORS) as f64).sin_cos();
        let r = outer * ring as f64 / RINGS as f64;
        place(r * cos, r * sin)
    };
    let patch = |ring: usize, k: usize| {
        if ring == 0 {
            return PatchPolygon::triangle([at(0, 0), at(1, k), at(1, k + 1)]);
        }
        PatchPolygon::quad([at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)])
    };
    (0..RINGS).flat_map(|ring| (0..SECTORS).map(move |k| (ring, k))).map(|(ring, k)| patch(ring, k)).collect()
}

fn patch_sphere(r: f64, d: f64, degrees: f64) -> Pair {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let half = 0.5 * SMALL * d;
    Pair {
        title: format!(
            "a small patch and a sphere of radius {r}, its centre at distance {d} and {degrees} degrees from the \
             patch's normal; as a square of edge {} and {} patches with the sphere's area",
            2.0 * half,
            ROWS * COLUMNS
        ),
        from: rectangle(DVec3::new(-half, -half, 0.0), DVec3::X * 2.0 * half, DVec3::Y * 2.0 * half),
        to: sphere_patches(r, DVec3::new(sin, 0.0, cos) * d),
        exact: closed_form::point_to_sphere(r, d, degrees.to_radians()),
    }
}

fn disc_sphere(r1: f64, r2: f64, d: f64) -> Pair {
    Pair {
        title: format!(
            "a disc of radius {r1} and a sphere of radius {r2} on its axis, its centre at distance {d}; as \
             polygons with their areas, of {SECTORS} corners and in {} patches",
            ROWS * COLUMNS
        ),
        from: disc_patches(r1, |x, y| DVec3::new(x, y, 0.0)),
        to: sphere_patches(r2, DVec3::Z * d),
        exact: closed_form::disc_to_sphere(r1, r2, d),
    }
}

fn spheres(r1: f64, r2: f64, d: f64) -> Pair {
    Pair {
        title: format!(
            "spheres of radius {r1} and {r2}, centres at distance {d}; each as {} patches with its area",
            ROWS * COLUMNS
        ),
        from: sphere_patches(r1, DVec3::ZERO),
        to: sphere_patches(r2, DVec3::X * d),
        exact: closed_form::sphere_to_sphere(r1, r2, d),
    }
}

/// Rows of quadrilaterals around z, and triangles at the poles; they have the area of the sphere, so they
/// hide as much as it does, on average over all directions.
fn sphere_patches(radius: f64, center: DVec3) -> Vec<PatchPolygon> {
    let patches = |radius: f64| -> Vec<PatchPolygon> {
        let at = |row: usize, column: usize| {
            let (sin, cos) = (PI * row as f64 / ROWS as f64).sin_cos();
            let (y, x) = (TAU * (column % COLUMNS) as f64 / COLUMNS as f64).sin_cos();
            let ring = if row == 0 || row == ROWS { 0.0 } else { sin };
            center + radius * DVec3::new(ring * x, ring * y, cos)
        };
        let patch = |row: usize, k: usize| match row {
            0 => PatchPolygon::triangle([at(0, 0), at(1, k), at(1, k + 1)]),
            last if last == ROWS - 1 => PatchPolygon::triangle([at(row, k), at(ROWS, 0), at(row, k + 1)]),
            _ => PatchPolygon::quad([at(row, k), at(row + 1, k), at(row + 1, k + 1), at(row, k + 1)]),
        };
        (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |k| (row, k))).map(|(row, k)| patch(row, k)).collect()
    };
    let area: f64 = patches(1.0).iter().map(|patch| patch.normal_and_area().1).sum();
    patches(radius * (4.0 * PI / area).sqrt())
}
