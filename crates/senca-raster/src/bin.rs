//! Sorting triangles into tiles, in the order they were submitted.
//!
//! Triangles are taken in runs of [`RUN`]; each run is binned by itself, on any thread, into one array
//! of references ordered by tile. Drawing a tile goes through the runs in order, so the order of
//! submission survives whatever the number of threads.

use crate::api::{Counters, Interpolation, LANES, MAX_VARYINGS, Primitives};
use crate::assemble::{Assembled, assemble, clipped_varyings, varyings_of};
use crate::setup::{Bounds, HALF, SUB_BITS, ScreenMap, ScreenVertex, double_area, is_culled};

/// Side of a tile in pixels, as a power of two.
pub(crate) const TILE_BITS: u32 = 6;
/// Side of a tile in pixels.
pub(crate) const TILE: usize = 1 << TILE_BITS;
/// Vertices projected together, and fewest triangles binned together.
pub(crate) const RUN: usize = 4096;

/// Triangles binned together: more on large targets, so that the starts a run keeps, one per tile,
/// stay below 16 bytes per triangle.
pub(crate) fn run_length([columns, rows]: [usize; 2]) -> usize {
    RUN.max(columns * rows / 4)
}

/// In a reference: the number is that of a piece made by clipping.
const CUT: u32 = 1 << 31;

/// A piece of a clipped triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) v: [ScreenVertex; 3],
    /// Number of the triangle in the draw.
    pub(crate) triangle: u32,
    /// Where its varyings begin, three vertices of them.
    pub(crate) varyings: u32,
}

/// A triangle in a tile's list. Its corners are repeated here so that drawing, which meets triangles
/// in another order than they were submitted in, reads one stream instead of two.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reference {
    /// Numbers of the corners.
    pub(crate) corners: [u32; 3],
    /// Number of the triangle, or, with [`CUT`], of the piece within the run.
    number: u32,
}

impl Reference {
    /// Number of the piece this stands for, if it is one.
    #[inline(always)]
    pub(crate) fn piece(&self) -> Option<usize> {
        (self.number & CUT != 0).then_some((self.number & !CUT) as usize)
    }

    /// Number of the triangle, if it is not a piece.
    #[inline(always)]
    pub(crate) fn triangle(&self) -> usize {
        self.number as usize
    }
}

/// One run of triangles, binned.
#[derive(Debug, Default)]
pub(crate) struct Run {
    /// References, grouped by tile.
    references: Vec<Reference>,
    /// Where the group of each tile begins; one more at the end.
    starts: Vec<u32>,
    /// Least and greatest depth of the corners in each tile, if they are wanted; without any the least is greater.
    depths: Vec<[f32; 2]>,
    /// Reference and the tiles its bounding box meets: first and last column and row.
    boxes: Vec<(Reference, [u16; 4])>,
    pub(crate) pieces: Vec<Piece>,
    pub(crate) piece_varyings: Vec<f32>,
    pub(crate) counters: Counters,
}

/// What binning reads.
pub(crate) struct BinInput<'a> {
    pub(crate) primitives: &'a Primitives<'a>,
    /// Corners that have been projected.
    pub(crate) vertices: &'a [ScreenVertex],
    /// Number of the first of them.
    pub(crate) first_vertex: usize,
    pub(crate) map: &'a ScreenMap,
    pub(crate) cull: crate::api::Cull,
    pub(crate) interpolation: Interpolation,
    /// Tiles in a row, and rows of tiles.
    pub(crate) tiles: [usize; 2],
    /// Whether [`Run::depths_of_tile`] will be asked.
    pub(crate) wants_depths: bool,
}

impl BinInput<'_> {
    /// Projected corner `i`, if there is one.
    #[inline(always)]
    pub(crate) fn vertex(&self, i: u32) -> Option<ScreenVertex> {
        self.vertices.get((i as usize).wrapping_sub(self.first_vertex)).copied()
    }

    /// Projected corner `i`, which is there.
    #[inline(always)]
    pub(crate) fn projected(&self, i: u32) -> ScreenVertex {
        self.vertex(i).unwrap_or_default()
    }
}

impl Run {
    /// References of a tile, in order of submission.
    pub(crate) fn of_tile(&self, tile: usize) -> &[Reference] {
        match (self.starts.get(tile), self.starts.get(tile + 1)) {
            (Some(&from), Some(&to)) => &self.references[from as usize..to as usize],
            _ => &[],
        }
    }

    /// Least and greatest depth of the corners of a tile's triangles, without bias; `None` without triangles.
    pub(crate) fn depths_of_tile(&self, tile: usize) -> Option<[f32; 2]> {
        self.depths.get(tile).copied().filter(|[least, greatest]| least <= greatest)
    }

    /// How many references a row of tiles has.
    pub(crate) fn work(&self, tiles: std::ops::Range<usize>) -> u64 {
        match (self.starts.get(tiles.start), self.starts.get(tiles.end)) {
            (Some(from), Some(to)) => u64::from(to - from),
            _ => 0,
        }
    }

    /// References in all.
    pub(crate) fn references(&self) -> usize {
        self.references.len()
    }

    /// Bytes of memory held.
    pub(crate) fn bytes(&self) -> usize {
        self.references.capacity() * size_of::<Reference>()
            + self.starts.capacity() * size_of::<u32>()
            + self.depths.capacity() * size_of::<[f32; 2]>()
            + self.boxes.capacity() * size_of::<(Reference, [u16; 4])>()
            + self.pieces.capacity() * size_of::<Piece>()
            + self.piece_varyings.capacity() * size_of::<f32>()
    }

    /// Bins the triangles of `range`.
    pub(crate) fn fill(&mut self, input: &BinInput<'_>, range: std::ops::Range<usize>) {
        self.boxes.clear();
        self.boxes.reserve_exact(range.len());
        self.pieces.clear();
        self.piece_varyings.clear();
        self.counters = Counters::default();
        self.starts.clear();
        let tiles = input.tiles[0] * input.tiles[1];
        self.starts.resize(tiles + 1, 0);
        self.depths.clear();
        if input.wants_depths {
            self.depths.resize(tiles, [f32::INFINITY, f32::NEG_INFINITY]);
        }
        for first in range.clone().step_by(LANES) {
            let some = first..(first + LANES).min(range.end);
            touch(input, some.clone());
            for n in some {
                self.add(input, n);
            }
        }
        self.group(input.tiles[0]);
    }

    fn add(&mut self, input: &BinInput<'_>, n: usize) {
        self.counters.primitives += 1;
        let index = &input.primitives.indices[3 * n..3 * n + 3];
        let corners = (input.vertex(index[0]), input.vertex(index[1]), input.vertex(index[2]));
        let (Some(a), Some(b), Some(c)) = corners else {
            self.counters.invalid += 1;
            return;
        };
        if a.x != i32::MIN && b.x != i32::MIN && c.x != i32::MIN {
            let corners = [index[0], index[1], index[2]];
            self.add_screen(input, Reference { corners, number: n as u32 }, [a, b, c]);
        } else {
            self.add_clipped(input, n, [a, b, c]);
        }
    }

    #[inline(always)]
    fn add_screen(&mut self, input: &BinInput<'_>, reference: Reference, v: [ScreenVertex; 3]) -> bool {
        if is_culled(double_area(&v), input.cull) {
            self.counters.culled += 1;
            return false;
        }
        self.counters.drawn += 1;
        let b = pixel_box(&v, input.map);
        if b.is_empty() {
            return false;
        }
        let tile = |p: i32| (p >> TILE_BITS) as u16;
        let tiles = [tile(b.x0), tile(b.y0), tile(b.x1 - 1), tile(b.y1 - 1)];
        for y in tiles[1]..=tiles[3] {
            let row = y as usize * input.tiles[0];
            for x in tiles[0]..=tiles[2] {
                self.starts[row + x as usize + 1] += 1;
            }
        }
        if input.wants_depths {
            self.add_depths(input.tiles[0], tiles, v.map(|v| v.z));
        }
        self.boxes.push((reference, tiles));
        true
    }

    /// Notes the depths of a triangle's corners in the tiles from first to last column and row.
    #[inline(always)]
    fn add_depths(&mut self, columns: usize, [x0, y0, x1, y1]: [u16; 4], [a, b, c]: [f32; 3]) {
        let (least, greatest) = (a.min(b).min(c), a.max(b).max(c));
        for y in y0..=y1 {
            let row = y as usize * columns;
            for [low, high] in &mut self.depths[row + x0 as usize..=row + x1 as usize] {
                (*low, *high) = (low.min(least), high.max(greatest));
            }
        }
    }

    #[cold]
    fn add_clipped(&mut self, input: &BinInput<'_>, n: usize, screen: [ScreenVertex; 3]) {
        let p = input.primitives;
        let index = [p.indices[3 * n], p.indices[3 * n + 1], p.indices[3 * n + 2]];
        let clip = index.map(|i| p.positions[i as usize]);
        let Assembled::Cut(polygon) = assemble(clip, screen, input.map, &mut self.counters) else {
            return;
        };
        let values = index.map(|i| varyings_of(p, i));
        for fan in polygon.triangles() {
            let corners = fan.map(|k| polygon.vertices()[k]);
            let v = corners.map(|c| input.map.project_clipped(c.position));
            let piece = self.pieces.len() as u32;
            if !self.add_screen(input, Reference { corners: index, number: piece | CUT }, v) {
                continue;
            }
            let varyings = self.piece_varyings.len() as u32;
            self.pieces.push(Piece { v, triangle: n as u32, varyings });
            for c in corners {
                let value = |k| clipped_varyings(values, c.weights, input.interpolation, k);
                self.piece_varyings.extend((0..p.stride.min(MAX_VARYINGS)).map(value));
            }
        }
    }

    /// Counting sort of the references by tile; keeps their order within each.
    fn group(&mut self, columns: usize) {
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        // What is there is overwritten.
        self.references.resize(sum as usize, Reference::default());
        // Backwards, so that each group's start ends where it belongs.
        for &(reference, [x0, y0, x1, y1]) in self.boxes.iter().rev() {
            for y in y0..=y1 {
                for x in x0..=x1 {
                    let slot = &mut self.starts[y as usize * columns + x as usize + 1];
                    *slot -= 1;
                    self.references[*slot as usize] = reference;
                }
            }
        }
        // starts[t + 1] is now where group t begins: shift down by one.
        self.starts.remove(0);
        self.starts.push(sum);
    }
}

/// Reads something of each corner of some triangles, in a loop so short that the processor waits for all at once
/// where vertices lie all over the memory.
#[inline(always)]
fn touch(input: &BinInput<'_>, triangles: std::ops::Range<usize>) {
    let corners = input.primitives.indices.get(3 * triangles.start..3 * triangles.end).unwrap_or_default();
    let x = |i: &u32| input.vertex(*i).map_or(0, |v| v.x);
    std::hint::black_box(corners.iter().map(x).fold(0, |a, b| a ^ b));
}

/// Pixels whose centres lie in the bounding box of the corners and may be written.
#[inline(always)]
pub(crate) fn pixel_box(v: &[ScreenVertex; 3], map: &ScreenMap) -> Bounds {
    let first = |a: i32, o: i32| ((a + HALF - 1) >> SUB_BITS) + o;
    let [ox, oy] = map.origin;
    Bounds {
        x0: first(v[0].x.min(v[1].x).min(v[2].x), ox),
        y0: first(v[0].y.min(v[1].y).min(v[2].y), oy),
        x1: first(v[0].x.max(v[1].x).max(v[2].x), ox),
        y1: first(v[0].y.max(v[1].y).max(v[2].y), oy),
    }
    .intersect(map.bounds)
}
