//! Any tessellation of a rectangle covers each of its pixels exactly once.

use proptest::prelude::*;
use senca_math::glam::Vec4;
use senca_raster::{
    Blend, Buffers, Compare, Ids, Primitives, Rasterizer, ScanlineRasterizer, Shading, State, TiledRasterizer,
};

/// Triangles of a grid of jittered points over the whole volume, the rim kept straight.
fn grid(columns: u32, rows: u32, jitter: &[f32], perspective: bool) -> (Vec<Vec4>, Vec<u32>) {
    let mut positions = Vec::new();
    for y in 0..=rows {
        for x in 0..=columns {
            let shift = |i: u32, n: u32, k: usize| match i {
                0 => -1.0,
                i if i == n => 1.0,
                i => {
                    (i as f32 + 0.2 * jitter[(k + positions.len() * 2) % jitter.len()]) / n as f32 * 2.0 - 1.0
                }
            };
            let (px, py) = (shift(x, columns, 0), shift(y, rows, 1));
            let w = if perspective { 1.0 + 0.7 * jitter[positions.len() % jitter.len()].abs() } else { 1.0 };
            positions.push(Vec4::new(px * w, py * w, 0.5 * w, w));
        }
    }
    let mut indices = Vec::new();
    for y in 0..rows {
        for x in 0..columns {
            let a = y * (columns + 1) + x;
            let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
            // Either diagonal, either winding.
            let pair = if (x + y) % 2 == 0 { [a, b, d, a, d, c] } else { [a, b, c, d, b, c] };
            indices.extend(pair);
        }
    }
    (positions, indices)
}

/// How often each pixel is drawn.
fn counts(rasterizer: &mut dyn Rasterizer, size: [u32; 2], positions: &[Vec4], indices: &[u32]) -> Vec<f32> {
    let mut buffers = Buffers::new(size[0], size[1]);
    let state = State { blend: Some(Blend::ADD), depth_test: Compare::Always, ..State::default() };
    let primitives = Primitives { positions, varyings: &[], stride: 0, indices, ids: Ids::From(0) };
    let shading = Shading::constant([1.0; 4]);
    rasterizer.draw(&mut buffers.target().unwrap(), &primitives, &state, &shading);
    buffers.color.pixels().iter().map(|p| p[0]).collect()
}

fn covers_once(size: [u32; 2], positions: &[Vec4], indices: &[u32]) {
    for rasterizer in [&mut ScanlineRasterizer as &mut dyn Rasterizer, &mut TiledRasterizer::default()] {
        let counts = counts(rasterizer, size, positions, indices);
        assert!(counts.iter().all(|&c| c == 1.0), "{size:?}: {:?}", counts.iter().position(|&c| c != 1.0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]
    #[test]
    fn a_tessellated_rectangle_is_covered_once(
        columns in 1u32..9, rows in 1u32..9, width in 1u32..180, height in 1u32..180,
        jitter in prop::collection::vec(-1f32..1.0, 37), perspective: bool,
    ) {
        let (positions, indices) = grid(columns, rows, &jitter, perspective);
        covers_once([width, height], &positions, &indices);
    }
}

#[test]
fn odd_sizes_are_covered_once() {
    let jitter: Vec<f32> = (0..37).map(|i| ((i * 29 % 37) as f32 / 18.0) - 1.0).collect();
    for size in [[1, 1], [1, 2], [3, 1], [1, 4097], [4099, 1], [2001, 33], [31, 2003]] {
        for cells in [1, 2, 7] {
            let (positions, indices) = grid(cells, cells, &jitter, false);
            covers_once(size, &positions, &indices);
        }
    }
}

#[test]
fn a_target_16384_wide_is_covered_once() {
    let jitter: Vec<f32> = (0..37).map(|i| ((i * 23 % 37) as f32 / 18.0) - 1.0).collect();
    let (positions, indices) = grid(5, 3, &jitter, true);
    covers_once([16_384, 40], &positions, &indices);
    covers_once([65_408, 3], &positions, &indices);
    covers_once([3, 65_408], &positions, &indices);
}

#[test]
fn triangles_far_larger_than_the_target_are_covered_once() {
    // A fan about a point, its rim thousands of targets away: all are cut by the guard band.
    for center in [[0.1f32, -0.2], [0.0, 0.0], [-0.93, 0.71]] {
        let mut positions = vec![Vec4::new(center[0], center[1], 0.5, 1.0)];
        let corners = [[-1.0f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        positions.extend(corners.map(|[x, y]| Vec4::new(x * 3e6, y * 3e6, 0.5, 1.0)));
        let indices = [0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1];
        for size in [[33, 57], [640, 3]] {
            covers_once(size, &positions, &indices);
        }
    }
}
