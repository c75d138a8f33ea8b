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
    /// Most memory the process has held at once, in bytes; `null` where the system does not tell.
    pub(crate) peak_bytes: Option<u64>,
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

    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_holds_some_memory() {
        assert!(peak_bytes().is_some_and(|b| b > 100_000));
    }
}
