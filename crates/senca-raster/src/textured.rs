//! Textured fragments, and those in the light of a shadow map, many vectors at a time and in stages.
//!
//! A texel is read long after its address is known, and vectors of texels can only be loaded once all
//! their lanes have been written. So vectors of fragments are kept until there are several of one batch
//! of triangles, and go together through
//!
//! 1. coordinates and the square of the footprint;
//! 2. levels of detail;
//! 3. addresses and weights of texels;
//! 4. fetching, one texel pair after another through memory;
//! 5. mixing, and writing the colours.
//!
//! Each stage is a loop of its own: within a vector nearly every step waits for the one before, and a
//! processor finds the work of the next vectors to fill that time only when it is not far ahead.
//!
//! Two levels are mixed in integers, with a share in 1/256.
//!
//! Shadow maps are looked up before, vector by vector, and dim what the texture is multiplied by. Where pixels have
//! several samples a vector is the pixels of a block ([`crate::pixels`]).
//!
//! This holds for linear filters on texels of 8 bits, and, with fewer stages, for the nearest texel of a
//! single level; other textures are read vector by vector ([`crate::sample`]).

use crate::api::{LANES, MAX_VARYINGS, TextureUnit};
use crate::blend::{Rgba, byte, channel};
use crate::cover::{At, ColorPath, Place, TileDraw, colors, compare, lanes_from, splat4, varying};
use crate::cube::{CubeTaps, CubeUnit, on_cube};
use crate::pixels;
use crate::sample::{
    FARTHEST_TAME, Quads, change, footprint, gather_words, load4, lod_of, low, nearest_index, pair_texels,
    quads, sample, sums, taps,
};
use crate::texture::{Filter, Mip, Sampler, TextureLevel};
use crate::tile::BLOCKS;
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};

/// Vectors kept at most.
const WAITING: usize = 16;
/// Vectors staged together.
const STAGED: usize = 4;

/// Two rows of 8 fragments whose depth has been tested, or the sixteen pixels of a block some of whose samples have
/// passed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Waiting {
    pub(crate) place: Place,
    /// Pixels from the reference of the triangle to lane 0.
    pub(crate) offset: [f32; 2],
    /// Lanes to draw.
    pub(crate) bits: u16,
    /// Of pixels of several samples those to draw, by row of pixels.
    pub(crate) samples: [u16; 4],
    /// Whether some of the depths are not those that are stored already.
    pub(crate) moves_depths: bool,
}

/// Vectors of the current batch that have no colour yet, in the order they are to be written.
#[derive(Debug)]
pub(crate) struct TextureQueue {
    waiting: [Waiting; WAITING],
    len: usize,
    /// Where there is an alpha test: lanes of each vector of a tile that wait.
    of_tile: Box<[[u16; 4]; BLOCKS * BLOCKS]>,
    lookups: Box<[Lookup; WAITING]>,
    staged: Box<[Job; STAGED]>,
}

impl Default for TextureQueue {
    fn default() -> Self {
        Self {
            waiting: Default::default(),
            len: 0,
            of_tile: Box::new([[0; 4]; BLOCKS * BLOCKS]),
            lookups: Box::default(),
            staged: Box::default(),
        }
    }
}

impl TextureQueue {
    /// Memory of its boxes.
    pub(crate) const BOXED_BYTES: usize =
        WAITING * size_of::<Lookup>() + STAGED * size_of::<Job>() + size_of::<[[u16; 4]; BLOCKS * BLOCKS]>();

    /// Whether some of these lanes wait.
    #[inline(always)]
    pub(crate) fn has_some_of(&self, block: usize, pair: usize, lanes: u16) -> bool {
        self.of_tile[block % (BLOCKS * BLOCKS)][pair % 4] & lanes != 0
    }

    /// Notes that the lanes of a vector wait, or do no longer.
    #[inline(always)]
    fn note(&mut self, vector: &Waiting, per_pixel: bool, wait: bool) {
        let of_block = &mut self.of_tile[vector.place.block % (BLOCKS * BLOCKS)];
        let lanes = if wait { u16::MAX } else { 0 };
        if per_pixel {
            for (of_pair, samples) in of_block.iter_mut().zip(vector.samples) {
                *of_pair = (*of_pair & !samples) | (samples & lanes);
            }
        } else {
            let of_pair = &mut of_block[vector.place.pair % 4];
            *of_pair = (*of_pair & !vector.bits) | (vector.bits & lanes);
        }
    }
}

/// What texels are read of, through the stages.
#[derive(Clone, Copy)]
enum Unit<'a> {
    Flat(&'a TextureUnit<'a>),
    Cube(&'a CubeUnit<'a>),
}

impl Unit<'_> {
    #[inline(always)]
    fn sampler(&self) -> &Sampler {
        match self {
            Self::Flat(unit) => &unit.sampler,
            Self::Cube(unit) => &unit.sampler,
        }
    }

    #[inline(always)]
    fn level_count(&self) -> usize {
        match self {
            Self::Flat(unit) => unit.texture.levels.len(),
            Self::Cube(unit) => unit.texture.level_count(),
        }
    }
}

/// What a vector wants of its texture.
#[derive(Clone, Copy, Debug, Default)]
struct Lookup {
    uv: [[f32; LANES]; 2],
    /// Of a cube.
    face: [i32; LANES],
    /// Whether all coordinates are within [`FARTHEST_TAME`] of 0.
    tame: bool,
    /// Square of the longer side of a pixel, in texels of level 0.
    footprint: [f32; LANES],
    /// Number of the finer level.
    level: [i32; LANES],
    /// Share of the coarser level, in 1/256.
    share: [i32; LANES],
    /// What the texture is multiplied by, unless it is the same everywhere.
    color: [[f32; LANES]; 4],
    /// Numbers of the nearest texels, and those.
    number: [i32; LANES],
    texel: [u32; LANES],
}

/// Fragments between stages: lanes of one vector that read the same levels.
#[derive(Clone, Copy, Debug, Default)]
struct Job {
    bits: u16,
    /// Number of the vector and its lookup.
    lookup: usize,
    /// Number of the finer level.
    level: usize,
    /// Whether the coarser level counts.
    two_levels: bool,
    /// In the finer level and in the coarser one.
    taps: [TapLanes; 2],
}

/// Texels wanted of a level, by lane.
#[derive(Clone, Copy, Debug, Default)]
struct TapLanes {
    /// Numbers of the left ones: upper row, lower row.
    left: [[i32; LANES]; 2],
    /// Numbers of the right ones, where some are not beside the left ones.
    right: [[i32; LANES]; 2],
    /// Lanes whose right texels do not follow the left ones in memory.
    apart: u16,
    /// Position between the texels, in 1/256.
    between: [[i32; LANES]; 2],
    texels: Quads,
}

/// Whether fragments of this texture go through the stages.
fn is_staged(unit: &TextureUnit<'_>) -> bool {
    let sampler = &unit.sampler;
    let linear = sampler.magnify == Filter::Linear && sampler.minify == Filter::Linear;
    linear && unit.texture.levels[0].texels.rgba8().is_some()
}

/// The texels, if it is always the nearest of the only level that counts.
#[inline(always)]
fn sharp_texels<'a>(unit: &TextureUnit<'a>) -> Option<&'a [[u8; 4]]> {
    let sharp = unit.sampler.magnify == Filter::Nearest && unit.sampler.minify == Filter::Nearest;
    unit.texture.levels[0].texels.rgba8().filter(|_| sharp && !has_levels(unit))
}

/// Whether the level of detail matters.
#[inline(always)]
fn has_levels(unit: &TextureUnit<'_>) -> bool {
    unit.sampler.mip != Mip::None && unit.texture.levels.len() > 1
}

impl<const FAST: bool> TileDraw<'_, '_, FAST> {
    /// Keeps a vector until [`Self::shade_waiting`].
    #[inline(always)]
    pub(crate) fn wait<S: Simd>(&mut self, simd: S, vector: Waiting) {
        if self.queue.len == WAITING {
            self.shade_waiting(simd);
        }
        if self.pass.alpha_test.is_some() {
            self.queue.note(&vector, self.pass.per_pixel, true);
        }
        self.queue.waiting[self.queue.len % WAITING] = vector;
        self.queue.len += 1;
    }

    /// Keeps the whole blocks of row `by` whose bits are set, where nothing but the texture counts.
    #[inline(always)]
    pub(crate) fn wait_blocks<S: Simd>(&mut self, simd: S, lane: usize, by: i32, blocks: u32) {
        let mut left = blocks & 255;
        while left != 0 {
            let bx = left.trailing_zeros() as i32;
            left &= left - 1;
            if self.queue.len + 4 > WAITING {
                self.shade_waiting(simd);
            }
            let b = &self.batch.offset;
            let (x, y) = ((b[0][lane] + 8 * bx) as f32, b[1][lane] + 8 * by);
            let block = (8 * by + bx) as usize % (BLOCKS * BLOCKS);
            self.buffer.written |= 1 << block;
            for pair in 0..4 {
                let (place, offset) = (Place { lane, block, pair }, [x, (y + 2 * pair as i32) as f32]);
                self.queue.waiting[(self.queue.len + pair) % WAITING] =
                    Waiting { place, offset, bits: u16::MAX, samples: [0; 4], moves_depths: true };
            }
            self.queue.len += 4;
        }
        let count = 64 * u64::from((blocks & 255).count_ones());
        self.counts.tested += count;
        self.counts.passed += count;
        self.counts.shaded += count;
    }

    /// Colours and writes the vectors that wait.
    ///
    /// A function of its own in the compiled kernel: inlined, it makes code of many megabytes.
    #[inline(always)]
    pub(crate) fn shade_waiting<S: Simd>(&mut self, simd: S) {
        if self.queue.len > 0 {
            simd.vectorize(
                #[inline(always)]
                || self.shade_waiting_inline(simd),
            );
        }
    }

    #[inline(always)]
    fn shade_waiting_inline<S: Simd>(&mut self, simd: S) {
        let count = std::mem::take(&mut self.queue.len).min(WAITING);
        if self.pass.alpha_test.is_some() {
            for k in 0..count {
                let vector = self.queue.waiting[k];
                self.queue.note(&vector, self.pass.per_pixel, false);
            }
        }
        if let Some((unit, slot)) = self.pass.cube {
            return self.shade_levels(simd, Unit::Cube(unit), slot, count);
        }
        let Some((unit, slot)) = self.pass.texture else {
            for k in 0..count {
                let vector = self.queue.waiting[k];
                let color = self.base_color(simd, &vector, &self.at_vector(simd, &vector));
                self.write_waiting(simd, &vector, vector.bits, color);
            }
            return;
        };
        if let Some(texels) = sharp_texels(unit) {
            return self.shade_sharp(simd, unit, texels, slot, count);
        }
        if !is_staged(unit) {
            for k in 0..count {
                self.shade_one(simd, unit, slot, self.queue.waiting[k]);
            }
            return;
        }
        if !has_levels(unit) {
            return self.shade_one_level(simd, unit, slot, count);
        }
        self.shade_levels(simd, Unit::Flat(unit), slot, count);
    }

    /// Vectors that read levels by their level of detail.
    #[inline(always)]
    fn shade_levels<S: Simd>(&mut self, simd: S, unit: Unit<'_>, slot: usize, count: usize) {
        for k in 0..count {
            match unit {
                Unit::Flat(unit) => self.look(simd, unit, slot, k),
                Unit::Cube(unit) => self.look_around(simd, unit, slot, k),
            }
        }
        let last = if unit.sampler().mip == Mip::None { 0 } else { unit.level_count() - 1 };
        for k in 0..count {
            self.queue.lookups[k].find_levels(simd, unit.sampler(), last, self.queue.waiting[k].bits);
        }
        let mut staged = 0;
        for k in 0..count {
            let vector = self.queue.waiting[k];
            let mut left = u32::from(vector.bits);
            // Level by level: a vector seldom meets more than two.
            while left != 0 {
                let lookup = &self.queue.lookups[k];
                let number = lookup.level[left.trailing_zeros() as usize % LANES];
                let levels = i32x16::load_array_ref(simd, &lookup.level);
                let here = levels.simd_eq(i32x16::splat(simd, number)).to_bitmask() as u32 & left;
                left &= !here;
                let job = &mut self.queue.staged[staged % STAGED];
                (job.bits, job.lookup) = (here as u16, k);
                job.level = number as usize;
                job.address(simd, unit, lookup);
                staged += 1;
                if staged == STAGED {
                    self.finish(simd, staged);
                    staged = 0;
                }
            }
        }
        self.finish(simd, staged);
    }

    /// Vectors that read the only level.
    #[inline(always)]
    fn shade_one_level<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize, count: usize) {
        let level = &unit.texture.levels[0];
        for first in (0..count).step_by(STAGED) {
            let staged = (count - first).min(STAGED);
            for k in 0..staged {
                let vector = self.queue.waiting[(first + k) % WAITING];
                let (uv, at) = self.coordinates(simd, &vector, slot);
                self.keep_color(simd, &at, first + k);
                let job = &mut self.queue.staged[k];
                (job.bits, job.lookup) = (self.queue.waiting[(first + k) % WAITING].bits, first + k);
                (job.level, job.two_levels) = (0, false);
                job.taps[0].address(simd, unit, level, uv, are_tame(simd, uv));
            }
            self.finish(simd, staged);
        }
    }

    /// Vectors that read the nearest texel of the only level.
    #[inline(always)]
    fn shade_sharp<S: Simd>(
        &mut self,
        simd: S,
        unit: &TextureUnit<'_>,
        texels: &[[u8; 4]],
        slot: usize,
        count: usize,
    ) {
        let level = &unit.texture.levels[0];
        for k in 0..count {
            let vector = self.queue.waiting[k];
            let (uv, at) = self.coordinates(simd, &vector, slot);
            self.keep_color(simd, &at, k);
            let index = if are_tame(simd, uv) {
                nearest_index::<S, true>(simd, &unit.sampler, level, uv)
            } else {
                nearest_index::<S, false>(simd, &unit.sampler, level, uv)
            };
            index.store_array(&mut self.queue.lookups[k].number);
        }
        for lookup in &mut self.queue.lookups[..count] {
            gather_words(texels, &lookup.number, &mut lookup.texel);
        }
        for k in 0..count {
            let vector = self.queue.waiting[k];
            let texel = u32x16::load_array_ref(simd, &self.queue.lookups[k].texel);
            self.put(simd, vector.bits, k, Single(texel));
        }
    }

    /// Writes texels times colour, to the lanes in `bits` of the vector of number `k`, with whose lookup the colour is.
    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, bits: u16, k: usize, texels: impl ReadTexels<S>) {
        let vector = self.queue.waiting[k % WAITING];
        let color = match self.same_color() {
            Some(rgba) if FAST && self.pass.alpha_test.is_none() => {
                // Where the colour is 1, the bytes are what they are.
                let packed = tinted(simd, texels.bytes(simd), 0, rgba[0], &texels);
                let packed = tinted(simd, packed, 1, rgba[1], &texels);
                let packed = tinted(simd, packed, 2, rgba[2], &texels);
                let packed = tinted(simd, packed, 3, rgba[3], &texels);
                return self.write_packed_waiting(simd, &vector, bits, packed);
            }
            Some(rgba) => splat4(simd, rgba),
            None => load4(simd, &self.queue.lookups[k % WAITING].color),
        };
        let texel =
            [texels.number(simd, 0), texels.number(simd, 1), texels.number(simd, 2), texels.number(simd, 3)];
        self.write_waiting(simd, &vector, bits, times(color, texel));
    }

    /// Writes the lanes in `bits` of a vector.
    #[inline(always)]
    fn write_waiting<S: Simd>(&mut self, simd: S, vector: &Waiting, bits: u16, rgba: Rgba<S>) {
        let mut bits = bits;
        if let Some(test) = self.pass.alpha_test {
            let alpha = rgba[3].max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, 1.0));
            let passes = compare(simd, test.compare, alpha, f32x16::splat(simd, test.reference));
            bits &= passes.to_bitmask() as u16;
            self.keep_waiting(simd, vector, bits);
        }
        if self.pass.per_pixel {
            self.write_pixels(simd, vector.place.block, &vector.samples, bits, rgba);
        } else {
            self.write(simd, vector.place, mask32x16::from_bitmask(simd, u64::from(bits)), rgba);
        }
    }

    /// Keeps depths and identifiers of the lanes in `bits`, which have passed the alpha test, of a vector.
    #[inline(always)]
    fn keep_waiting<S: Simd>(&mut self, simd: S, vector: &Waiting, bits: u16) {
        let place = vector.place;
        for (pair, samples) in vector.samples.iter().enumerate() {
            let (pair, mask) = match self.pass.per_pixel {
                true => (pair, pixels::samples_in(*samples, bits, pair)),
                false if pair == 0 => (place.pair, bits),
                false => return,
            };
            if mask == 0 {
                continue;
            }
            self.counts.passed += u64::from(mask.count_ones());
            if self.pass.writes_depth && vector.moves_depths || self.pass.has_ids {
                let place = Place { pair, ..place };
                let keep = mask32x16::from_bitmask(simd, u64::from(mask));
                self.keep_depth(simd, place, keep, self.depth_at(simd, place));
            }
        }
    }

    /// The same of packed colours that replace what is there.
    #[inline(always)]
    fn write_packed_waiting<S: Simd>(&mut self, simd: S, vector: &Waiting, bits: u16, packed: u32x16<S>) {
        let place = vector.place;
        if self.pass.per_pixel {
            return self.write_packed_pixels(simd, place.block, &vector.samples, bits, packed);
        }
        let mask = mask32x16::from_bitmask(simd, u64::from(bits));
        let plane = &mut self.buffer.rgba8[place.block % (BLOCKS * BLOCKS)][place.pair % 4];
        let stored = u32x16::load_array_ref(simd, plane);
        mask.select(packed, stored).store_array(plane);
    }

    /// What the texture is multiplied by, if that is the same everywhere.
    #[inline(always)]
    fn same_color(&self) -> Option<[f32; 4]> {
        match self.pass.color {
            ColorPath::Constant(rgba) if self.pass.shadow.is_none() => Some(rgba),
            _ => None,
        }
    }

    /// Texture coordinates of a vector that waits.
    #[inline(always)]
    fn coordinates<S: Simd>(&self, simd: S, vector: &Waiting, slot: usize) -> ([f32x16<S>; 2], At<S>) {
        let lane = vector.place.lane;
        let at = self.at_vector(simd, vector);
        let [u, v] =
            [&self.batch.varyings[slot % MAX_VARYINGS], &self.batch.varyings[(slot + 1) % MAX_VARYINGS]];
        ([varying(simd, u, lane, &at), varying(simd, v, lane, &at)], at)
    }

    /// Puts the colour of the vector of number `k` by its lookup, unless it is the same everywhere. Lanes that cannot
    /// pass the alpha test any more are taken out.
    #[inline(always)]
    fn keep_color<S: Simd>(&mut self, simd: S, at: &At<S>, k: usize) {
        if self.same_color().is_none() {
            let color = self.base_color(simd, &self.queue.waiting[k % WAITING], at);
            store4(color, &mut self.queue.lookups[k % WAITING].color);
            if self.pass.alpha_test.is_some_and(|test| test.drops_zero()) {
                // No texel makes more of it.
                let some = color[3].simd_gt(f32x16::splat(simd, 0.0));
                self.queue.waiting[k % WAITING].bits &= some.to_bitmask() as u16;
            }
        }
    }

    /// Coordinates and footprint of a vector that waits.
    #[inline(always)]
    fn look<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize, k: usize) {
        let vector = self.queue.waiting[k];
        let lane = vector.place.lane;
        let (uv, at) = self.coordinates(simd, &vector, slot);
        self.keep_color(simd, &at, k);
        if self.queue.waiting[k % WAITING].bits == 0 {
            return;
        }
        let lookup = &mut self.queue.lookups[k];
        footprint(simd, unit.texture, self.batch, lane, slot, &at, uv).store_array(&mut lookup.footprint);
        lookup.tame = are_tame(simd, uv);
        uv[0].store_array(&mut lookup.uv[0]);
        uv[1].store_array(&mut lookup.uv[1]);
    }

    /// The same of a cube.
    #[inline(always)]
    fn look_around<S: Simd>(&mut self, simd: S, unit: &CubeUnit<'_>, slot: usize, k: usize) {
        let vector = self.queue.waiting[k];
        let lane = vector.place.lane;
        let at = self.at_vector(simd, &vector);
        self.keep_color(simd, &at, k);
        if self.queue.waiting[k % WAITING].bits == 0 {
            return;
        }
        let batch = &*self.batch;
        let [x, y, z] = [
            &batch.varyings[slot % MAX_VARYINGS],
            &batch.varyings[(slot + 1) % MAX_VARYINGS],
            &batch.varyings[(slot + 2) % MAX_VARYINGS],
        ];
        let direction =
            [varying(simd, x, lane, &at), varying(simd, y, lane, &at), varying(simd, z, lane, &at)];
        let [dx, dy, dz] = direction;
        let changes = [
            [
                change(simd, batch, lane, &at, x, dx, 1),
                change(simd, batch, lane, &at, y, dy, 1),
                change(simd, batch, lane, &at, z, dz, 1),
            ],
            [
                change(simd, batch, lane, &at, x, dx, 2),
                change(simd, batch, lane, &at, y, dy, 2),
                change(simd, batch, lane, &at, z, dz, 2),
            ],
        ];
        let on = on_cube(simd, unit.texture.size(), direction, changes);
        let lookup = &mut self.queue.lookups[k];
        on.footprint.store_array(&mut lookup.footprint);
        on.face.store_array(&mut lookup.face);
        on.st[0].store_array(&mut lookup.uv[0]);
        on.st[1].store_array(&mut lookup.uv[1]);
    }

    /// A vector whose texture is read at once.
    #[inline(always)]
    fn shade_one<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize, vector: Waiting) {
        let mask = mask32x16::from_bitmask(simd, u64::from(vector.bits));
        let at = self.at_vector(simd, &vector);
        let rgba = self.base_color(simd, &vector, &at);
        let texel = sample(simd, unit, self.batch, vector.place.lane, slot, &at, mask);
        self.write_waiting(simd, &vector, vector.bits, times(rgba, texel));
    }

    #[inline(always)]
    fn at_vector<S: Simd>(&self, simd: S, vector: &Waiting) -> At<S> {
        let [fx, fy] = match self.pass.per_pixel {
            true => {
                let [x, y] = vector.offset;
                [
                    f32x16::load_array(simd, pixels::LANE_FX) + f32x16::splat(simd, x),
                    f32x16::load_array(simd, pixels::LANE_FY) + f32x16::splat(simd, y),
                ]
            }
            false => lanes_from(simd, vector.offset),
        };
        self.at(simd, vector.place.lane, fx, fy)
    }

    /// What the texture is multiplied by.
    #[inline(always)]
    fn base_color<S: Simd>(&self, simd: S, vector: &Waiting, at: &At<S>) -> Rgba<S> {
        let lane = vector.place.lane;
        let color = match self.pass.color {
            ColorPath::Constant(rgba) => splat4(simd, rgba),
            ColorPath::Varying { alpha } => colors(simd, self.batch, lane, 0, alpha, at),
            ColorPath::None | ColorPath::Plain => splat4(simd, [1.0; 4]),
        };
        let Some((unit, slot)) = self.pass.shadow else { return color };
        let [s, t, r, q] = [
            &self.batch.varyings[slot % MAX_VARYINGS],
            &self.batch.varyings[(slot + 1) % MAX_VARYINGS],
            &self.batch.varyings[(slot + 2) % MAX_VARYINGS],
            &self.batch.varyings[(slot + 3) % MAX_VARYINGS],
        ];
        let coords = [
            varying(simd, s, lane, at),
            varying(simd, t, lane, at),
            varying(simd, r, lane, at),
            varying(simd, q, lane, at),
        ];
        let light = unit.light_lanes(simd, coords, vector.bits);
        let [r, g, b, a] = color;
        let [r, g, b] = if unit.dims_colors { [r * light, g * light, b * light] } else { [r, g, b] };
        [r, g, b, if unit.dims_alpha { a * light } else { a }]
    }

    /// Fetches the texels of the first `count` jobs, then mixes them.
    #[inline(always)]
    fn finish<S: Simd>(&mut self, simd: S, count: usize) {
        let count = count.min(STAGED);
        let levels = &self.pass.texels;
        for job in &mut self.queue.staged[..count] {
            if let Some(fine) = levels.get(job.level).or(levels.last()) {
                job.taps[0].fetch(fine);
            }
            if job.two_levels
                && let Some(coarse) = levels.get(job.level + 1).or(levels.last())
            {
                job.taps[1].fetch(coarse);
            }
        }
        for k in 0..count {
            let job = &self.queue.staged[k];
            let (bits, lookup) = (job.bits, job.lookup);
            let fine = job.taps[0].mean(simd);
            if job.two_levels {
                let share = i32x16::load_array_ref(simd, &self.queue.lookups[lookup % WAITING].share);
                let mixed = OfLevels::new(simd, fine, job.taps[1].mean(simd), share.bitcast());
                self.put(simd, bits, lookup, mixed);
            } else {
                self.put(simd, bits, lookup, fine);
            }
        }
    }
}

impl Lookup {
    /// Number of the finer level, and share of the one after it; see [`crate::Sampler::sample_lod`].
    #[inline(always)]
    fn find_levels<S: Simd>(&mut self, simd: S, sampler: &Sampler, last: usize, bits: u16) {
        let (zero, half) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 0.5));
        let lod = lod_of(simd, sampler, f32x16::load_array_ref(simd, &self.footprint));
        let minified = lod.simd_gt(zero) & mask32x16::from_bitmask(simd, u64::from(bits));
        let last = f32x16::splat(simd, last as f32);
        let lod = minified.select(lod.min(last), zero);
        let (mut level, mut share) = (lod.floor(), zero);
        if sampler.mip == Mip::Nearest {
            level = (lod + half).floor().min(last);
        } else {
            share = (lod - level) * f32x16::splat(simd, 256.0) + half;
        }
        level.to_int::<i32x16<S>>().store_array(&mut self.level);
        share.to_int::<i32x16<S>>().store_array(&mut self.share);
    }
}

impl Job {
    /// Fills in where the texels are.
    #[inline(always)]
    fn address<S: Simd>(&mut self, simd: S, unit: Unit<'_>, lookup: &Lookup) {
        let bits = mask32x16::from_bitmask(simd, u64::from(self.bits));
        let share = i32x16::load_array_ref(simd, &lookup.share);
        self.two_levels = (share.simd_gt(i32x16::splat(simd, 0)) & bits).any_true();
        let [u, v] = &lookup.uv;
        let uv = [f32x16::load_array_ref(simd, u), f32x16::load_array_ref(simd, v)];
        let count = if self.two_levels { 2 } else { 1 };
        for (k, taps) in self.taps.iter_mut().enumerate().take(count) {
            match unit {
                Unit::Flat(unit) => {
                    let levels = &unit.texture.levels;
                    let level = &levels[(self.level + k).min(levels.len() - 1)];
                    taps.address(simd, unit, level, uv, lookup.tame);
                }
                Unit::Cube(unit) => {
                    let face = i32x16::load_array_ref(simd, &lookup.face);
                    taps.address_on_cube(&unit.texture.taps(simd, self.level + k, face, uv));
                }
            }
        }
    }
}

/// `packed` with the bytes of channel `k` replaced by those of `texels` times `by`, unless that is 1.
#[inline(always)]
fn tinted<S: Simd>(simd: S, packed: u32x16<S>, k: usize, by: f32, texels: &impl ReadTexels<S>) -> u32x16<S> {
    if by == 1.0 {
        return packed;
    }
    let shift = 8 * k as u32;
    let tinted = byte(simd, f32x16::splat(simd, by) * texels.number(simd, k)) << shift;
    (packed & u32x16::splat(simd, !(255 << shift))) | tinted
}

impl TapLanes {
    #[inline(always)]
    fn address<S: Simd>(
        &mut self,
        simd: S,
        unit: &TextureUnit<'_>,
        level: &TextureLevel,
        uv: [f32x16<S>; 2],
        tame: bool,
    ) {
        let taps = if tame {
            taps::<S, true>(simd, &unit.sampler, level, uv)
        } else {
            taps::<S, false>(simd, &unit.sampler, level, uv)
        };
        let ([i0, i1], [row0, row1]) = (taps.columns, taps.rows);
        (row0 + i0).store_array(&mut self.left[0]);
        (row1 + i0).store_array(&mut self.left[1]);
        self.apart = !taps.beside.to_bitmask() as u16;
        if self.apart != 0 {
            (row0 + i1).store_array(&mut self.right[0]);
            (row1 + i1).store_array(&mut self.right[1]);
        }
        let [s, t] = taps.between(simd);
        s.store_array(&mut self.between[0]);
        t.store_array(&mut self.between[1]);
    }

    #[inline(always)]
    fn address_on_cube<S: Simd>(&mut self, taps: &CubeTaps<S>) {
        taps.left[0].store_array(&mut self.left[0]);
        taps.left[1].store_array(&mut self.left[1]);
        taps.between[0].store_array(&mut self.between[0]);
        taps.between[1].store_array(&mut self.between[1]);
        self.apart = 0;
    }

    #[inline(always)]
    fn fetch(&mut self, texels: &[[u8; 4]]) {
        pair_texels(texels, &self.left, &mut self.texels);
        if self.apart != 0 {
            self.fetch_apart(texels);
        }
    }

    /// Fetches again where the right texels are somewhere else.
    #[cold]
    #[inline(never)]
    fn fetch_apart(&mut self, texels: &[[u8; 4]]) {
        let word = |i: i32| u32::from_le_bytes(texels.get(i as u32 as usize).copied().unwrap_or_default());
        let mut left = self.apart;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            for row in 0..2 {
                let pair = [word(self.left[row][lane]), word(self.right[row][lane])];
                self.texels[row].as_flattened_mut()[lane] = pair;
            }
        }
    }

    #[inline(always)]
    fn mean<S: Simd>(&self, simd: S) -> OfLevel<S> {
        let [s, t] = &self.between;
        let between = [i32x16::load_array_ref(simd, s), i32x16::load_array_ref(simd, t)];
        OfLevel(sums(simd, quads(simd, &self.texels), between))
    }
}

/// What was read of a texture: texels, or means of some.
trait ReadTexels<S: Simd> {
    /// Rounded to 8 bits a channel, to the bits of [`Self::number`] rounded; red in the low byte.
    fn bytes(&self, simd: S) -> u32x16<S>;

    /// A channel as numbers 0 to 1.
    fn number(&self, simd: S, channel: usize) -> f32x16<S>;
}

/// Texels as they are.
struct Single<S: Simd>(u32x16<S>);

impl<S: Simd> ReadTexels<S> for Single<S> {
    #[inline(always)]
    fn bytes(&self, _: S) -> u32x16<S> {
        self.0
    }

    #[inline(always)]
    fn number(&self, simd: S, k: usize) -> f32x16<S> {
        channel(simd, self.0 >> (8 * k as u32))
    }
}

/// See [`sums`].
#[derive(Clone, Copy)]
struct OfLevel<S: Simd>([u32x16<S>; 2]);

impl<S: Simd> ReadTexels<S> for OfLevel<S> {
    #[inline(always)]
    fn bytes(&self, simd: S) -> u32x16<S> {
        let round = u32x16::splat(simd, 0x0080_0080);
        (((self.0[0] + round) >> 8) & u32x16::splat(simd, 0x00ff_00ff))
            | ((self.0[1] + round) & u32x16::splat(simd, 0xff00_ff00))
    }

    #[inline(always)]
    fn number(&self, simd: S, k: usize) -> f32x16<S> {
        low(simd, self.0[k % 2] >> (k as u32 / 2 * 16))
    }
}

/// 2^16 times the mean of two levels, by channel.
struct OfLevels<S: Simd>([u32x16<S>; 4]);

impl<S: Simd> OfLevels<S> {
    /// From two levels and the share of the coarser one in 1/256.
    #[inline(always)]
    fn new(simd: S, OfLevel(fine): OfLevel<S>, OfLevel(coarse): OfLevel<S>, share: u32x16<S>) -> Self {
        let rest = u32x16::splat(simd, 256) - share;
        let half = u32x16::splat(simd, 0xffff);
        Self([
            (fine[0] & half) * rest + (coarse[0] & half) * share,
            (fine[1] & half) * rest + (coarse[1] & half) * share,
            (fine[0] >> 16) * rest + (coarse[0] >> 16) * share,
            (fine[1] >> 16) * rest + (coarse[1] >> 16) * share,
        ])
    }
}

impl<S: Simd> ReadTexels<S> for OfLevels<S> {
    #[inline(always)]
    fn bytes(&self, simd: S) -> u32x16<S> {
        let [r, g, b, a] = self.0;
        let round = u32x16::splat(simd, 1 << 15);
        ((r + round) >> 16)
            | (((g + round) >> 8) & u32x16::splat(simd, 0xff00))
            | ((b + round) & u32x16::splat(simd, 0x00ff_0000))
            | (((a + round) << 8) & u32x16::splat(simd, 0xff00_0000))
    }

    #[inline(always)]
    fn number(&self, simd: S, k: usize) -> f32x16<S> {
        let whole: i32x16<S> = self.0[k].bitcast();
        whole.to_float::<f32x16<S>>() * f32x16::splat(simd, 1.0 / (255.0 * 65536.0))
    }
}

/// Whether all coordinates are within [`FARTHEST_TAME`] of 0.
#[inline(always)]
fn are_tame<S: Simd>(simd: S, [u, v]: [f32x16<S>; 2]) -> bool {
    let farthest = f32x16::splat(simd, FARTHEST_TAME);
    (u.abs().simd_le(farthest) & v.abs().simd_le(farthest)).all_true()
}

#[inline(always)]
fn store4<S: Simd>(rgba: Rgba<S>, to: &mut [[f32; LANES]; 4]) {
    rgba[0].store_array(&mut to[0]);
    rgba[1].store_array(&mut to[1]);
    rgba[2].store_array(&mut to[2]);
    rgba[3].store_array(&mut to[3]);
}

#[inline(always)]
fn times<S: Simd>(a: Rgba<S>, b: Rgba<S>) -> Rgba<S> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
}
