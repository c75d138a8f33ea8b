//! Everything that is round: profiles turned around the y axis.
//!
//! A [`Lathe`] holds *rings* (circles, or points on the axis) and *runs* of samples over rings. Runs
//! are smooth surfaces; two runs that meet name the same ring and so share its points.

use std::f64::consts::TAU;

use senca_math::glam::{DVec2, DVec3};

use super::build::Builder;

/// One sample of a run: a ring with what the run knows about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Index into [`Lathe::rings`].
    pub ring: usize,
    /// Normal in the profile's plane, `(radial, y)`, unit length.
    pub normal: DVec2,
    /// Texture coordinate along the run, 0 top to 1 bottom.
    pub v: f64,
}

/// How texture coordinates are laid over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wrapping {
    /// u once around, v along the profile.
    Around,
    /// The picture is seen upright on a disc of this radius, from its front.
    Disc(f64),
}

/// A smooth surface of revolution.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// Name of the surface.
    pub name: &'static str,
    /// Samples in an order for which the outside is to the right of the path in the `(radius, y)`
    /// plane: from bottom to top for an outside that faces away from the axis.
    pub samples: Vec<Sample>,
    /// Texture coordinates.
    pub wrapping: Wrapping,
}

/// Profiles to be turned.
#[derive(Clone, Debug)]
pub(super) struct Lathe {
    /// `(radius, y)` per ring; radius 0 is a single point.
    pub rings: Vec<DVec2>,
    /// Surfaces over the rings.
    pub runs: Vec<Run>,
    /// Angle of the first column, from +x towards -z.
    pub start: f64,
    /// Angle swept, in (0, tau].
    pub sweep: f64,
    /// Number of steps over the swept angle, at least 1.
    pub steps: u32,
}

impl Lathe {
    /// Whether the last column is the first again.
    pub(super) fn is_closed(&self) -> bool {
        self.sweep >= TAU * (1.0 - 1e-12)
    }

    /// Direction away from the axis at fraction `t` of the sweep.
    fn radial(&self, t: f64) -> DVec3 {
        let (sin, cos) = (self.start + t * self.sweep).sin_cos();
        DVec3::new(cos, 0.0, -sin)
    }

    /// Turns all runs and appends them. Returns the first point of each ring; of less than a full turn, a
    /// ring away from the axis has `steps + 1`.
    pub(super) fn build(&self, b: &mut Builder) -> Vec<u32> {
        let radials = self.radials();
        let first_points: Vec<u32> = self.rings.iter().map(|&ring| add_ring(ring, &radials, b)).collect();
        for run in &self.runs {
            let surface = b.surface(run.name);
            let rows: Vec<u32> = run
                .samples
                .iter()
                .map(|&sample| self.add_row(run, sample, first_points[sample.ring], &radials, b))
                .collect();
            for (samples, rows) in run.samples.windows(2).zip(rows.windows(2)) {
                self.add_band([samples[0], samples[1]], [rows[0], rows[1]], surface, b);
            }
        }
        first_points
    }

    /// Directions of all columns; a full turn does not repeat the first.
    fn radials(&self) -> Vec<DVec3> {
        let columns = if self.is_closed() { self.steps } else { self.steps + 1 };
        (0..columns).map(|i| self.radial(f64::from(i) / f64::from(self.steps))).collect()
    }

    fn is_pole(&self, sample: Sample) -> bool {
        self.rings[sample.ring].x == 0.0
    }

    /// Adds the faces between two rows of vertices.
    fn add_band(
        &self,
        [low, high]: [Sample; 2],
        [low_row, high_row]: [u32; 2],
        surface: u32,
        b: &mut Builder,
    ) {
        for i in 0..self.steps {
            match (self.is_pole(low), self.is_pole(high)) {
                (true, true) => {}
                (true, false) => b.triangle([low_row + i, high_row + i + 1, high_row + i], surface),
                (false, true) => b.triangle([low_row + i, low_row + i + 1, high_row + i], surface),
                (false, false) => {
                    b.quad([low_row + i, low_row + i + 1, high_row + i + 1, high_row + i], surface);
                }
            }
        }
    }

    /// Adds the vertices of a sample and returns the first. A pole has one per step, each with the
    /// normal of the step's middle.
    fn add_row(
        &self,
        run: &Run,
        sample: Sample,
        first_point: u32,
        radials: &[DVec3],
        b: &mut Builder,
    ) -> u32 {
        let row = b.mesh.vertices.point.len() as u32;
        let pole = self.is_pole(sample);
        let (count, offset) = if pole { (self.steps, 0.5) } else { (self.steps + 1, 0.0) };
        for i in 0..count {
            let t = (f64::from(i) + offset) / f64::from(self.steps);
            let column = i as usize % radials.len();
            let (radial, point) = if pole {
                (self.radial(t), first_point)
            } else {
                (radials[column], first_point + column as u32)
            };
            let normal = radial * sample.normal.x + DVec3::Y * sample.normal.y;
            b.vertex(point, normal.normalize_or(DVec3::Y), self.texcoord(run, sample, t, radial));
        }
        row
    }

    fn texcoord(&self, run: &Run, sample: Sample, t: f64, radial: DVec3) -> DVec2 {
        match run.wrapping {
            Wrapping::Around => DVec2::new(t, sample.v),
            Wrapping::Disc(radius) => {
                let place = radial * (0.5 * self.rings[sample.ring].x / radius);
                let upright = if sample.normal.y < 0.0 { -place.z } else { place.z };
                DVec2::new(0.5 + place.x, 0.5 + upright)
            }
        }
    }
}

/// Adds the points of a ring and returns the first one's index.
fn add_ring(ring: DVec2, radials: &[DVec3], b: &mut Builder) -> u32 {
    let on_axis = DVec3::Y * ring.y;
    let first = b.mesh.points.len() as u32;
    if ring.x == 0.0 {
        return b.point(on_axis);
    }
    for &radial in radials {
        b.point(on_axis + radial * ring.x);
    }
    first
}
