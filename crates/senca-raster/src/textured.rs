//! Textured fragments, many vectors at a time and in stages.
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
//! This holds for linear filters on texels of 8 bits, and, with fewer stages, for the nearest texel of a
//! single level; other textures are read vector by vector ([`crate::sample`]).

use crate::api::{LANES, MAX_VARYINGS, TextureUnit};
use crate::blend::{Rgba, unpack};
use crate::cover::{At, ColorPath, Place, TileDraw, colors, lanes_from, splat4, varying};
use crate::sample::{
    FARTHEST_TAME, Quads, footprint, gather_words, lerp, load4, lod_of, mixed, nearest_index, pair_texels,
    quads, sample, taps,
};
use crate::texture::{Filter, Mip, Texture, TextureLevel};
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*, u32x16};

/// Vectors kept at most.
const WAITING: usize = 16;
/// Vectors staged together.
const STAGED: usize = 4;

/// Two rows of 8 fragments whose depth has been tested.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Waiting {
    pub(crate) place: Place,
    /// Pixels from the reference of the triangle to lane 0.
    pub(crate) offset: [f32; 2],
    /// Lanes to draw.
    pub(crate) bits: u16,
}

/// Vectors of the current batch that have no colour yet, in the order they are to be written.
#[derive(Debug, Default)]
pub(crate) struct TextureQueue {
    waiting: [Waiting; WAITING],
    len: usize,
    lookups: Box<[Lookup; WAITING]>,
    staged: Box<[Job; STAGED]>,
}

impl TextureQueue {
    /// Memory of its boxes.
    pub(crate) const BOXED_BYTES: usize = WAITING * size_of::<Lookup>() + STAGED * size_of::<Job>();
}

/// What a vector wants of its texture.
#[derive(Clone, Copy, Debug, Default)]
struct Lookup {
    uv: [[f32; LANES]; 2],
    /// Whether all coordinates are within [`FARTHEST_TAME`] of 0.
    tame: bool,
    /// Square of the longer side of a pixel, in texels of level 0; then the number of the finer level.
    level: [f32; LANES],
    /// Share of the coarser level.
    share: [f32; LANES],
    /// What the texture is multiplied by, unless it is the same everywhere.
    color: [[f32; LANES]; 4],
    /// Numbers of the nearest texels, and those.
    number: [i32; LANES],
    texel: [u32; LANES],
}

/// Fragments between stages: lanes of one vector that read the same levels.
#[derive(Clone, Copy, Debug, Default)]
struct Job {
    place: Place,
    bits: u16,
    /// Number of the lookup.
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
        self.queue.waiting[self.queue.len % WAITING] = vector;
        self.queue.len += 1;
    }

    /// Colours and writes the vectors that wait.
    ///
    /// A function of its own in the compiled kernel: inlined, it makes code of many megabytes.
    #[inline(always)]
    pub(crate) fn shade_waiting<S: Simd>(&mut self, simd: S) {
        let Some((unit, slot)) = self.pass.texture else { return };
        if self.queue.len > 0 {
            simd.vectorize(
                #[inline(always)]
                || self.shade_waiting_inline(simd, unit, slot),
            );
        }
    }

    #[inline(always)]
    fn shade_waiting_inline<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize) {
        let count = std::mem::take(&mut self.queue.len).min(WAITING);
        if let Some(texels) = sharp_texels(unit) {
            return self.shade_sharp(simd, unit, texels, slot, count);
        }
        if !is_staged(unit) {
            for k in 0..count {
                self.shade_one(simd, unit, slot, self.queue.waiting[k]);
            }
            return;
        }
        for k in 0..count {
            self.look(simd, unit, slot, k);
        }
        for k in 0..count {
            self.queue.lookups[k].find_levels(simd, unit, self.queue.waiting[k].bits);
        }
        let mut staged = 0;
        for k in 0..count {
            let vector = self.queue.waiting[k];
            let mut left = u32::from(vector.bits);
            // Level by level: a vector seldom meets more than two.
            while left != 0 {
                let lookup = &self.queue.lookups[k];
                let number = lookup.level[left.trailing_zeros() as usize % LANES];
                let levels = f32x16::load_array_ref(simd, &lookup.level);
                let here = levels.simd_eq(f32x16::splat(simd, number)).to_bitmask() as u32 & left;
                left &= !here;
                let job = &mut self.queue.staged[staged % STAGED];
                (job.place, job.bits, job.lookup) = (vector.place, here as u16, k);
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
        let constant = matches!(self.pass.color, ColorPath::Constant(_));
        for k in 0..count {
            let vector = self.queue.waiting[k];
            let lane = vector.place.lane;
            let at = self.at_vector(simd, &vector);
            let [u, v] =
                [&self.batch.varyings[slot % MAX_VARYINGS], &self.batch.varyings[(slot + 1) % MAX_VARYINGS]];
            let uv = [varying(simd, u, lane, &at), varying(simd, v, lane, &at)];
            let color = self.base_color(simd, lane, &at);
            let lookup = &mut self.queue.lookups[k];
            nearest_index(simd, &unit.sampler, level, uv).store_array(&mut lookup.number);
            if !constant {
                store4(color, &mut lookup.color);
            }
        }
        for lookup in &mut self.queue.lookups[..count] {
            gather_words(texels, &lookup.number, &mut lookup.texel);
        }
        for k in 0..count {
            let (vector, lookup) = (self.queue.waiting[k], &self.queue.lookups[k]);
            let color = match self.pass.color {
                ColorPath::Constant(rgba) => splat4(simd, rgba),
                _ => load4(simd, &lookup.color),
            };
            let texel = unpack(simd, u32x16::load_array_ref(simd, &lookup.texel));
            let mask = mask32x16::from_bitmask(simd, u64::from(vector.bits));
            self.write(simd, vector.place, mask, times(color, texel));
        }
    }

    /// Coordinates and footprint of a vector that waits.
    #[inline(always)]
    fn look<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize, k: usize) {
        let vector = self.queue.waiting[k];
        let lane = vector.place.lane;
        let at = self.at_vector(simd, &vector);
        let color = self.base_color(simd, lane, &at);
        let [u, v] =
            [&self.batch.varyings[slot % MAX_VARYINGS], &self.batch.varyings[(slot + 1) % MAX_VARYINGS]];
        let uv = [varying(simd, u, lane, &at), varying(simd, v, lane, &at)];
        let lookup = &mut self.queue.lookups[k];
        if has_levels(unit) {
            footprint(simd, unit.texture, self.batch, lane, slot, &at, uv).store_array(&mut lookup.level);
        }
        let farthest = f32x16::splat(simd, FARTHEST_TAME);
        lookup.tame = (uv[0].abs().simd_le(farthest) & uv[1].abs().simd_le(farthest)).all_true();
        uv[0].store_array(&mut lookup.uv[0]);
        uv[1].store_array(&mut lookup.uv[1]);
        if !matches!(self.pass.color, ColorPath::Constant(_)) {
            store4(color, &mut lookup.color);
        }
    }

    /// A vector whose texture is read at once.
    #[inline(always)]
    fn shade_one<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, slot: usize, vector: Waiting) {
        let mask = mask32x16::from_bitmask(simd, u64::from(vector.bits));
        let at = self.at_vector(simd, &vector);
        let rgba = self.base_color(simd, vector.place.lane, &at);
        let texel = sample(simd, unit, self.batch, vector.place.lane, slot, &at, mask);
        self.write(simd, vector.place, mask, times(rgba, texel));
    }

    #[inline(always)]
    fn at_vector<S: Simd>(&self, simd: S, vector: &Waiting) -> At<S> {
        let [fx, fy] = lanes_from(simd, vector.offset);
        self.at(simd, vector.place.lane, fx, fy)
    }

    /// What the texture is multiplied by.
    #[inline(always)]
    fn base_color<S: Simd>(&self, simd: S, lane: usize, at: &At<S>) -> Rgba<S> {
        match self.pass.color {
            ColorPath::Constant(rgba) => splat4(simd, rgba),
            ColorPath::Varying { alpha } => colors(simd, self.batch, lane, 0, alpha, at),
            ColorPath::None | ColorPath::Plain => splat4(simd, [1.0; 4]),
        }
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
            let mut texel = job.taps[0].mixed(simd);
            if job.two_levels {
                let share = f32x16::load_array_ref(simd, &self.queue.lookups[job.lookup % WAITING].share);
                texel = lerp(texel, job.taps[1].mixed(simd), share);
            }
            let color = match self.pass.color {
                ColorPath::Constant(rgba) => splat4(simd, rgba),
                _ => load4(simd, &self.queue.lookups[job.lookup % WAITING].color),
            };
            let mask = mask32x16::from_bitmask(simd, u64::from(job.bits));
            self.write(simd, job.place, mask, times(color, texel));
        }
    }
}

impl Lookup {
    /// Number of the finer level, and share of the one after it; see [`crate::Sampler::sample_lod`].
    #[inline(always)]
    fn find_levels<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, bits: u16) {
        let (sampler, texture) = (&unit.sampler, unit.texture);
        let zero = f32x16::splat(simd, 0.0);
        let (mut level, mut share) = (zero, zero);
        if has_levels(unit) {
            let lod = lod_of(simd, sampler, f32x16::load_array_ref(simd, &self.level));
            let minified = lod.simd_gt(zero) & mask32x16::from_bitmask(simd, u64::from(bits));
            let last = f32x16::splat(simd, (texture.levels.len() - 1) as f32);
            let lod = minified.select(lod.min(last), zero);
            if sampler.mip == Mip::Nearest {
                level = (lod + f32x16::splat(simd, 0.5)).floor().min(last);
            } else {
                level = lod.floor();
                share = lod - level;
            }
        }
        level.store_array(&mut self.level);
        share.store_array(&mut self.share);
    }
}

impl Job {
    /// Fills in where the texels are.
    #[inline(always)]
    fn address<S: Simd>(&mut self, simd: S, unit: &TextureUnit<'_>, lookup: &Lookup) {
        let bits = mask32x16::from_bitmask(simd, u64::from(self.bits));
        let share = f32x16::load_array_ref(simd, &lookup.share);
        self.two_levels = (share.simd_gt(f32x16::splat(simd, 0.0)) & bits).any_true();
        let [u, v] = &lookup.uv;
        let uv = [f32x16::load_array_ref(simd, u), f32x16::load_array_ref(simd, v)];
        let [fine, coarse] = levels_from(unit.texture, self.level);
        self.taps[0].address(simd, unit, fine, uv, lookup.tame);
        if self.two_levels {
            self.taps[1].address(simd, unit, coarse, uv, lookup.tame);
        }
    }
}

/// Level `number` and the one after it.
#[inline(always)]
fn levels_from(texture: &Texture, number: usize) -> [&TextureLevel; 2] {
    let last = texture.levels.len() - 1;
    [&texture.levels[number.min(last)], &texture.levels[(number + 1).min(last)]]
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
        for row in 0..2 {
            for (lane, to) in self.texels[row].as_flattened_mut().iter_mut().enumerate() {
                if self.apart >> lane & 1 == 1 {
                    *to = [word(self.left[row][lane]), word(self.right[row][lane])];
                }
            }
        }
    }

    #[inline(always)]
    fn mixed<S: Simd>(&self, simd: S) -> Rgba<S> {
        let [s, t] = &self.between;
        let between = [i32x16::load_array_ref(simd, s), i32x16::load_array_ref(simd, t)];
        mixed(simd, quads(simd, &self.texels), between)
    }
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
