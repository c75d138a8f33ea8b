//! What happened while a picture was drawn, and the caller's hold on it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::RenderError;

/// Counters and times of one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Triangles of all instances, each once.
    pub triangles_in: u64,
    /// Left out for showing their back or having no area on screen. With several samples or bands of
    /// rows, the mean over them, as for the next two.
    pub triangles_culled: u64,
    /// Cut by a plane of the view volume.
    pub triangles_clipped: u64,
    /// Sent on to be filled.
    pub triangles_drawn: u64,
    /// Line segments drawn, edges and normals; with faces, the lines and points of meshes.
    pub lines_drawn: u64,
    /// Pixels given a colour by a surface, over all samples and transparent layers.
    pub pixels_shaded: u64,
    /// Bands of rows that the picture was drawn in.
    pub bands: u32,
    /// Times.
    pub seconds: StageSeconds,
}

/// Seconds spent in each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageSeconds {
    /// Tessellation, normals, textures, lights.
    pub prepare: f64,
    /// Lighting at vertices (Gouraud), or finding edges (line modes).
    pub vertices: f64,
    /// Projection, clipping, visibility.
    pub raster: f64,
    /// Colour of pixels.
    pub shade: f64,
    /// All together.
    pub total: f64,
}

/// The caller's hold on a running render. The default neither watches nor stops it.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Called now and then with the share done, 0 to 1, never falling.
    pub progress: Option<&'a (dyn Fn(f32) + Sync)>,
    /// Set to true from anywhere to stop within milliseconds with [`RenderError::Cancelled`].
    pub cancel: Option<&'a AtomicBool>,
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}

impl Control<'_> {
    /// Whether the caller asked to stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|c| c.load(Ordering::Relaxed))
    }

    /// An error when the caller asked to stop.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        if self.is_cancelled() { Err(RenderError::Cancelled) } else { Ok(()) }
    }

    /// Tells the caller that `share` of the work is done.
    pub(crate) fn report(&self, share: f32) {
        if let Some(progress) = self.progress {
            progress(share.clamp(0.0, 1.0));
        }
    }
}

/// Runs `work` and adds the seconds it took to `seconds`.
pub(crate) fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}
