//! What happened while a picture was drawn.

use std::time::Instant;

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

/// Runs `work` and adds the seconds it took to `seconds`.
pub(crate) fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}
