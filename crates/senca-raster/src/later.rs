//! Depths that are drawn tile by tile when somebody looks at them.
//!
//! A shadow map is large: of most of its tiles no more is asked than whether something is nearer to the light than all
//! that they hold. Bounds of a tile's depths answer that, and are found from the corners of its triangles alone.

use crate::api::{Ids, Primitives, Shading, State};
use crate::bin::TILE;
use crate::block_depths::TileForms;
use crate::cover::FragmentCounts;
use crate::setup::{ScreenMap, SetupState};
use crate::target::Clear;
use crate::tile::{Band, Planes};
use crate::tiled::{Frame, Part, Scratch, Sorted, lock, pass, share_touches};
use fearless_simd::Level;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// In place of bounds that have not been found yet: no numbers.
const UNKNOWN: u64 = u64::MAX;

/// Memory of threads that draw a tile: boxes, as it is taken and put back for each.
type Scratches = Vec<Box<Scratch>>;

/// Draws that have been sorted into tiles and wait, and the depth that all tiles are cleared to first.
#[derive(Debug)]
pub(crate) struct Later {
    level: Level,
    clear: f32,
    /// Of the picture, in pixels.
    size: [usize; 2],
    draws: Vec<Waiting>,
    /// Least and greatest depth of each tile, or a wider range; [`UNKNOWN`] until asked for. Without draws none are
    /// kept.
    bounds: Vec<AtomicU64>,
    scratch: Mutex<Scratches>,
}

/// A draw.
#[derive(Debug)]
struct Waiting {
    state: State,
    map: ScreenMap,
    sorted: Sorted,
}

impl Later {
    /// No draws: one depth everywhere.
    pub(crate) fn level(clear: f32) -> Self {
        Self {
            level: Level::baseline(),
            clear,
            size: [0; 2],
            draws: Vec::new(),
            bounds: Vec::new(),
            scratch: Mutex::default(),
        }
    }

    /// Takes the memory of the draws, and ends them.
    pub(crate) fn take_sorted(&mut self) -> impl Iterator<Item = Sorted> {
        self.draws.drain(..).map(|draw| draw.sorted)
    }

    /// Begins anew: a picture of a size, cleared to a depth, and draws.
    pub(crate) fn begin(
        &mut self,
        level: Level,
        clear: f32,
        size: [u32; 2],
        draws: impl Iterator<Item = (State, ScreenMap, Sorted)>,
    ) {
        (self.level, self.clear, self.size) = (level, clear, size.map(|n| n as usize));
        self.draws.clear();
        self.draws.extend(draws.map(|(state, map, sorted)| Waiting { state, map, sorted }));
        let [columns, rows] = self.tiles();
        self.bounds.clear();
        self.bounds.resize_with(columns * rows, || AtomicU64::new(UNKNOWN));
    }

    /// Tiles in a row, and rows of tiles.
    fn tiles(&self) -> [usize; 2] {
        self.size.map(|n| n.div_ceil(TILE))
    }

    /// Least and greatest depth of a tile, or a wider range.
    #[inline(always)]
    pub(crate) fn bounds(&self, tile: usize) -> [f32; 2] {
        let Some(kept) = self.bounds.get(tile) else { return [self.clear; 2] };
        let bits = match kept.load(Ordering::Relaxed) {
            UNKNOWN => self.find_bounds(tile),
            known => known,
        };
        [bits as u32, (bits >> 32) as u32].map(f32::from_bits)
    }

    #[cold]
    #[inline(never)]
    fn find_bounds(&self, tile: usize) -> u64 {
        let [mut low, mut high] = [self.clear; 2];
        for draw in &self.draws {
            let setup = SetupState::new(&draw.state);
            // What slopes add is not known here, but for its sign. Rounding keeps order.
            let add = |z: f32| (z + setup.bias_constant).clamp(0.0, 1.0);
            for run in draw.sorted.runs() {
                let Some([least, greatest]) = run.depths_of_tile(tile) else { continue };
                low = low.min(if setup.bias_slope >= 0.0 { add(least) } else { 0.0 });
                high = high.max(if setup.bias_slope <= 0.0 { add(greatest) } else { 1.0 });
            }
        }
        let bits = u64::from(low.to_bits()) | u64::from(high.to_bits()) << 32;
        // Whoever else has found them has found the same.
        self.bounds[tile].store(bits, Ordering::Relaxed);
        bits
    }

    /// Draws a tile into memory that may hold anything.
    pub(crate) fn draw_tile(&self, tile: usize, mut memory: Box<TileForms>) -> Box<TileForms> {
        if self.draws.is_empty() {
            memory.clear(self.clear);
            return memory;
        }
        let (tiles, none) = (
            self.tiles(),
            Primitives { positions: &[], varyings: &[], stride: 0, indices: &[], ids: Ids::Same(0) },
        );
        let clear = Clear { color: None, depth: Some(self.clear), id: None, stencil: None };
        let mut parts: Vec<Part<'_>> = Vec::with_capacity(self.draws.len());
        for Waiting { state, map, sorted } in &self.draws {
            let pass = pass(Planes::DEPTHS, &none, state, &Shading::None, map, Some(clear));
            parts.push(sorted.part(&none, map, tiles, pass));
        }
        share_touches(&mut parts, true);
        let (column, row) = (tile % tiles[0], tile / tiles[0]);
        let mut band = Band {
            row,
            width: self.size[0],
            height: TILE.min(self.size[1] - row * TILE),
            color: None,
            depth: None,
            in_blocks: true,
            blocks: None,
            stencil: None,
            ids: None,
        };
        let mut scratch = lock(&self.scratch).pop().unwrap_or_default();
        std::mem::swap(&mut scratch.tile.forms, &mut memory);
        let frame = Frame { tiles, clears: true, parts: &parts };
        frame.draw_tile(self.level, &mut band, column, &mut scratch, FragmentCounts::default());
        std::mem::swap(&mut scratch.tile.forms, &mut memory);
        lock(&self.scratch).push(scratch);
        memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::{Compare, Cull, DepthBias};
    use crate::block_depths::BlockDepths;
    use crate::tiled::TiledRasterizer;
    use senca_math::glam::Vec4;

    const SIZE: [u32; 2] = [150, 90];

    /// Triangles here and there, some cut by the near plane.
    fn triangles() -> Vec<Vec4> {
        let mut seed = 1u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        let mut corners = Vec::new();
        for _ in 0..40 {
            let (x, y) = (2.0 * next() - 1.0, 2.0 * next() - 1.0);
            for _ in 0..3 {
                corners.push(Vec4::new(x + 0.4 * next(), y + 0.4 * next(), 1.1 * next() - 0.1, 1.0));
            }
        }
        corners
    }

    #[test]
    fn no_depth_of_a_tile_is_out_of_its_bounds_and_some_bounds_tell_something() {
        let positions = triangles();
        let indices: Vec<u32> = (0..positions.len() as u32).collect();
        let things = Primitives {
            positions: &positions,
            varyings: &[],
            stride: 0,
            indices: &indices,
            ids: Ids::Same(0),
        };
        for (clear, depth_test) in [(1.0, Compare::Less), (0.0, Compare::GreaterEqual)] {
            for bias in [[0.0, 0.0], [0.01, 2.0], [-0.01, -2.0], [0.1, -1.0]] {
                let state = State {
                    depth_test,
                    clear: Some(Clear { depth: Some(clear), ..Clear::default() }),
                    cull: Cull::None,
                    depth_bias: DepthBias { constant: bias[0], slope: bias[1] },
                    ..State::default()
                };
                let mut depths = BlockDepths::new(SIZE[0], SIZE[1], 0.5).unwrap();
                assert_eq!(depths.bound([0, 149], [0, 89], true), Some(0.5));
                TiledRasterizer::default().draw_depths_when_read(&mut depths, &[(things, state)]);
                let mut told = 0;
                for y in (0..SIZE[1]).step_by(7) {
                    for x in (0..SIZE[0]).step_by(7) {
                        let ends = |v: u32, size: u32| [v as i32, (v + 5).min(size - 1) as i32];
                        let (columns, rows) = (ends(x, SIZE[0]), ends(y, SIZE[1]));
                        let [low, high] =
                            [false, true].map(|greatest| depths.bound(columns, rows, greatest).unwrap());
                        told += usize::from(low > 0.0 || high < 1.0);
                        for (x, y) in (rows[0]..=rows[1]).flat_map(|y| [(columns[0], y), (columns[1], y)]) {
                            let depth = depths.get(x as u32, y as u32);
                            assert!((low..=high).contains(&depth), "{depth} in {low} to {high}, {bias:?}");
                        }
                    }
                }
                assert!(told > 0 || bias[1] != 0.0);
                assert_eq!(depths.bound([9, 8], [0, 0], true), None);
                // Drawn to at once, bounds are not known any more.
                TiledRasterizer::default()
                    .draw_depths(&mut depths, &[(things, State { clear: None, ..state })]);
                assert_eq!(depths.bound([0, 9], [0, 9], true), None);
            }
        }
    }
}
