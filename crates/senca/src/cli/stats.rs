//! What `--stats` writes.

use std::time::Instant;

use serde::Serialize;

/// Figures of one picture, written as one JSON object.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Stats {
    /// Times per stage.
    pub(crate) seconds: Seconds,
    /// What `render` is made of.
    pub(crate) stages: Stages,
    /// Threads that drew.
    pub(crate) threads: usize,
    /// Width and height of the picture written, in pixels.
    pub(crate) size: [u32; 2],
    /// What became of the triangles.
    pub(crate) triangles: Triangles,
    /// Samples per pixel.
    pub(crate) samples: u32,
    /// What following rays took, where they were.
    #[serde(flatten)]
    pub(crate) tracing: Option<TracingStats>,
    /// What computing light took, where it was computed or read.
    #[serde(flatten)]
    pub(crate) radiosity: Option<RadiosityStats>,
    /// Most memory the process has held at once, in bytes; `null` where the system does not tell.
    pub(crate) peak_bytes: Option<u64>,
}

/// What following rays took.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct TracingStats {
    /// Rays by kind.
    pub(crate) rays: Rays,
    /// Rays tested against surfaces.
    pub(crate) tests: u64,
    /// Rays tested against bounding volumes, and nodes visited.
    pub(crate) nodes: u64,
    /// Cells of a grid or octree that rays went through.
    pub(crate) cells: u64,
    /// Samples of all pixels.
    pub(crate) samples_total: u64,
    /// The same work for a ray.
    pub(crate) per_ray: PerRay,
}

/// What computing light took, and how exact it is.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct RadiosityStats {
    /// Plane polygons of the scene that took part.
    pub(crate) polygons: u64,
    /// Elements that are not divided.
    pub(crate) patches: u64,
    /// All elements.
    pub(crate) elements: u64,
    /// Form factors, or links between elements.
    pub(crate) links: u64,
    /// Rounds of the solver, or steps of shooting.
    pub(crate) iterations: u32,
    /// The last change of a radiosity, or the largest that is not sent yet, as a share of the largest.
    pub(crate) residual: f64,
    /// Power that is not accounted for, as a share of all.
    pub(crate) energy_error: f64,
    /// Power that shooting has not sent yet, as a share of all.
    pub(crate) unsent: f64,
    /// Whether the solver met its tolerance.
    pub(crate) converged: bool,
}

impl RadiosityStats {
    /// Of a solution.
    pub(crate) fn of(report: &senca::radiosity::SolveReport) -> Self {
        Self {
            polygons: report.polygons,
            patches: report.patches,
            elements: report.elements,
            links: report.links,
            iterations: report.iterations,
            residual: report.residual,
            energy_error: report.energy_error,
            unsent: report.unsent,
            converged: report.converged,
        }
    }
}

/// Rays by kind.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Rays {
    pub(crate) primary: u64,
    pub(crate) shadow: u64,
    pub(crate) reflected: u64,
    pub(crate) transmitted: u64,
    pub(crate) bounce: u64,
    pub(crate) total: u64,
}

/// Mean work for a ray.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct PerRay {
    pub(crate) tests: f64,
    pub(crate) nodes: f64,
    pub(crate) cells: f64,
}

impl TracingStats {
    /// Of a picture.
    pub(crate) fn of(report: &senca::trace::FilmReport) -> Self {
        let (rays, work) = (report.counts.rays, report.counts.work);
        let per_ray = |count: u64| count as f64 / rays.total().max(1) as f64;
        Self {
            rays: Rays {
                primary: rays.primary,
                shadow: rays.shadow,
                reflected: rays.reflected,
                transmitted: rays.transmitted,
                bounce: rays.bounce,
                total: rays.total(),
            },
            tests: work.tests,
            nodes: work.nodes,
            cells: work.cells,
            samples_total: report.samples,
            per_ray: PerRay {
                tests: per_ray(work.tests),
                nodes: per_ray(work.nodes),
                cells: per_ray(work.cells),
            },
        }
    }
}

/// Wall-clock seconds per stage.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Seconds {
    /// Reading and parsing.
    pub(crate) load: f64,
    /// Animation, tessellation, normals, camera and light.
    pub(crate) prepare: f64,
    /// Drawing.
    pub(crate) render: f64,
    /// Encoding and writing.
    pub(crate) write: f64,
    /// From the start of the command to the end of writing.
    pub(crate) total: f64,
}

/// Seconds within the stages of drawing.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Stages {
    /// Light at vertices, or finding edges.
    pub(crate) vertices: f64,
    /// Projection, clipping, visibility.
    pub(crate) raster: f64,
    /// Colour of pixels.
    pub(crate) shade: f64,
}

/// Counts of triangles.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Triangles {
    /// Handed in.
    #[serde(rename = "in")]
    pub(crate) given: u64,
    /// Left out as turned away.
    pub(crate) culled: u64,
    /// Cut by the view volume.
    pub(crate) clipped: u64,
    /// Drawn, pieces of cut ones included.
    pub(crate) drawn: u64,
}

/// Takes the time of one stage after the other.
pub(crate) struct Stopwatch {
    start: Instant,
    lap: Instant,
}

impl Stopwatch {
    /// Starts now.
    pub(crate) fn start() -> Self {
        let start = Instant::now();
        Self { start, lap: start }
    }

    /// Seconds since the last lap, or the start.
    pub(crate) fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let before = std::mem::replace(&mut self.lap, now);
        now.duration_since(before).as_secs_f64()
    }

    /// Seconds since the start.
    pub(crate) fn total(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

/// Most memory this process has held at once, in bytes.
#[cfg(target_os = "linux")]
pub(crate) fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kb| 1024 * kb)
}

/// Most memory this process has held at once, in bytes: not told here.
#[cfg(not(target_os = "linux"))]
pub(crate) fn peak_bytes() -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keys_are_the_documented_ones() {
        let json = serde_json::to_value(Stats::default()).expect("plain data");
        let keys = |v: &serde_json::Value| {
            let mut keys: Vec<_> = v.as_object().expect("an object").keys().cloned().collect();
            keys.sort();
            keys
        };
        assert_eq!(
            keys(&json),
            ["peak_bytes", "samples", "seconds", "size", "stages", "threads", "triangles"]
        );
        assert_eq!(keys(&json["seconds"]), ["load", "prepare", "render", "total", "write"]);
        assert_eq!(keys(&json["triangles"]), ["clipped", "culled", "drawn", "in"]);
    }

    #[test]
    fn rays_are_told_where_there_are_any() {
        let stats = Stats { tracing: Some(TracingStats::default()), ..Stats::default() };
        let json = serde_json::to_value(stats).expect("plain data");
        for key in ["rays", "tests", "nodes", "cells", "per_ray", "samples_total"] {
            assert!(json.get(key).is_some(), "{key}");
        }
        for key in ["primary", "shadow", "reflected", "transmitted", "bounce"] {
            assert_eq!(json["rays"][key], 0, "{key}");
        }
    }

    #[test]
    fn light_is_told_where_it_was_computed() {
        let stats = Stats { radiosity: Some(RadiosityStats::default()), ..Stats::default() };
        let json = serde_json::to_value(stats).expect("plain data");
        for key in
            ["patches", "elements", "links", "iterations", "residual", "energy_error", "unsent", "converged"]
        {
            assert!(json.get(key).is_some(), "{key}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_holds_some_memory() {
        assert!(peak_bytes().is_some_and(|b| b > 100_000));
    }
}
