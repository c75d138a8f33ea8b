//! Reading textures sixteen fragments at a time, for the kinds that programs use: two dimensions or a
//! face of a cube, colours of 8 bits or depths, without borders. The twin of [`super::sample`].

use super::ops::Stencil;
use super::real::{Color, Real, constant, mixed};
use super::sample::{LINEAR, Level, Sampled};
use super::shade::{FogPlan, Unit};
use crate::gl;
use crate::state::TexTarget;
use crate::texture::Texels;
use senca_raster::cube::{FACES, face_of};
use senca_raster::simd::{Simd, f32x16, i32x16, mask8x16, mask32x16, prelude::*, u8x16, u32x16};
use senca_raster::{BlockDepths, Fragments, LANES};

/// How coordinates outside [0, 1] are brought in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FastWrap {
    Repeat,
    Mirror,
    Edge,
}

/// A texture that can be read sixteen times at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FastTexture {
    wrap: [FastWrap; 2],
    /// Faces meet at edges, where this way of reading must not be used.
    guarded: bool,
}

impl FastTexture {
    /// `None` if the texture is not of these kinds.
    pub(crate) fn new(t: &Sampled) -> Option<Self> {
        if !matches!(t.target, TexTarget::Two | TexTarget::Cube) {
            return None;
        }
        let fits = |level: &Level| {
            let count = level.size[0] as usize * level.size[1] as usize;
            let stored = |texels: &Texels| match texels {
                Texels::Rgba8(colors) => colors.len() >= count,
                Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. } => depths.len() >= count,
                _ => false,
            };
            level.border == 0 && count > 0 && level.texels.iter().all(|texels| stored(texels))
        };
        if !t.levels.iter().all(fits) {
            return None;
        }
        let cube = t.target == TexTarget::Cube;
        let mixes = t.params.mag_filter == gl::LINEAR
            || !matches!(
                t.params.min_filter,
                gl::NEAREST | gl::NEAREST_MIPMAP_NEAREST | gl::NEAREST_MIPMAP_LINEAR
            );
        let wrap = |k: usize| match t.params.wrap[k] {
            _ if cube && (t.seamless || t.params.wrap[k] == gl::CLAMP_TO_EDGE) => Some(FastWrap::Edge),
            gl::REPEAT => Some(FastWrap::Repeat),
            gl::MIRRORED_REPEAT => Some(FastWrap::Mirror),
            gl::CLAMP_TO_EDGE => Some(FastWrap::Edge),
            gl::CLAMP if !mixes => Some(FastWrap::Edge),
            _ => None,
        };
        Some(Self { wrap: [wrap(0)?, wrap(1)?], guarded: cube && t.seamless && mixes })
    }

    /// The texel of a unit at the fragments of the mask, as environments take it; `None` where it must be
    /// read one fragment at a time.
    #[inline(always)]
    pub(crate) fn sample<S: Simd>(
        &self,
        simd: S,
        unit: &Unit,
        f: &Fragments<'_>,
    ) -> Option<Color<f32x16<S>>> {
        let t = &unit.texture;
        let [s, v, r, q] = [
            plane(simd, f, unit.coords),
            plane(simd, f, unit.coords + 1),
            plane(simd, f, unit.coords + 2),
            plane(simd, f, unit.coords + 3),
        ];
        let (face, st, reference) = if t.target == TexTarget::Cube {
            let (face, st) = on_cube(simd, f.mask, [s, v, r])?;
            (face, st, r)
        } else {
            (0, [s / q, v / q], r / q)
        };
        let lods = quad_lods(t, f, st);
        if self.guarded && !self.is_within(simd, t, f.mask, st, &lods) {
            return None;
        }
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let reference = reference.max(zero).min(one);
        let place = At { mask: f.mask, face, st, reference };
        let mut result = [zero; 4];
        let mut left = (0..4).filter(|k| f.mask & lanes_of(f.columns, *k) != 0).fold(0u32, |l, k| l | 1 << k);
        while left != 0 {
            // All squares of 2 x 2 fragments that read the same levels in the same way.
            let chosen = t.levels_at(lods[left.trailing_zeros() as usize % 4]);
            let (linear, level, _) = chosen;
            let (mut lanes, mut shares, mut two_levels) = (0, zero, false);
            let waiting = left;
            for k in (0..4).filter(|k| waiting >> k & 1 == 1) {
                let (l, n, share) = t.levels_at(lods[k]);
                if (l, n) == (linear, level) {
                    left &= !(1 << k);
                    let here = lanes_of(f.columns, k);
                    lanes |= here;
                    two_levels |= share > 0.0;
                    if share > 0.0 {
                        let here = mask32x16::from_bitmask(simd, u64::from(here));
                        shares = here.select(f32x16::splat(simd, share), shares);
                    }
                }
            }
            let mut value = self.read(simd, t, level, &place, linear);
            if two_levels {
                let coarse = self.read(simd, t, level + 1, &place, linear);
                value = mixed(value, coarse, shares);
            }
            if f.mask & !lanes == 0 {
                result = value;
                continue;
            }
            let here = mask32x16::from_bitmask(simd, u64::from(lanes));
            for k in 0..4 {
                result[k] = here.select(value[k], result[k]);
            }
        }
        Some(as_taken(t, result))
    }

    /// Whether all fragments of the mask are so far from the edges of a cube's face that texels of two
    /// faces do not mix.
    #[inline(always)]
    fn is_within<S: Simd>(
        &self,
        simd: S,
        t: &Sampled,
        mask: u16,
        st: [f32x16<S>; 2],
        lods: &[f32; 4],
    ) -> bool {
        // Half a texel of the coarsest level read.
        let lod = lods.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let coarsest = (t.levels_at(lod).1 + 1).min(t.levels.len() - 1);
        let rim = 0.5 / t.levels[coarsest].size[0] as f32;
        let (low, high) = (f32x16::splat(simd, rim), f32x16::splat(simd, 1.0 - rim));
        let within = st[0].simd_ge(low) & st[0].simd_le(high) & st[1].simd_ge(low) & st[1].simd_le(high);
        mask & !(within.to_bitmask() as u16) == 0
    }

    /// A function of its own in the compiled kernel, which is large enough.
    #[inline(always)]
    fn read<S: Simd>(
        &self,
        simd: S,
        t: &Sampled,
        level: usize,
        at: &At<S>,
        linear: bool,
    ) -> Color<f32x16<S>> {
        simd.vectorize(
            #[inline(always)]
            || self.read_inline(simd, t, level, at, linear),
        )
    }

    #[inline(always)]
    fn read_inline<S: Simd>(
        &self,
        simd: S,
        t: &Sampled,
        level: usize,
        at: &At<S>,
        linear: bool,
    ) -> Color<f32x16<S>> {
        let level = &t.levels[level.min(t.levels.len() - 1)];
        let width = i32x16::splat(simd, level.size[0]);
        let across = self.axis(simd, 0, at.st[0], level.size[0], linear);
        let along = self.axis(simd, 1, at.st[1], level.size[1], linear);
        let nothing = constant(at.reference, [0.0; 4]);
        let Some(texels) = level.texels.get(at.face) else { return nothing };
        let (low, high) = (along.low * width, along.high * width);
        // The numbers of the texels, the lower row first.
        let mut numbers = [[0i32; LANES]; 4];
        (low + across.low).store_array(&mut numbers[0]);
        if linear {
            (low + across.high).store_array(&mut numbers[1]);
            (high + across.low).store_array(&mut numbers[2]);
            (high + across.high).store_array(&mut numbers[3]);
        }
        let numbers = if linear { &numbers[..] } else { &numbers[..1] };
        match &**texels {
            Texels::Rgba8(colors) => {
                let mut words = [[0u32; LANES]; 4];
                gather_colors(colors, numbers, &mut words);
                if !linear {
                    return color_of(simd, t, &words[0]);
                }
                let below = mixed(color_of(simd, t, &words[0]), color_of(simd, t, &words[1]), across.share);
                let above = mixed(color_of(simd, t, &words[2]), color_of(simd, t, &words[3]), across.share);
                mixed(below, above, along.share)
            }
            Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. } => {
                let mut values = [[0f32; LANES]; 4];
                if let Some(blocks) = depths.blocks() {
                    gather_squares(simd, blocks, at.mask, [&across, &along], linear, &mut values);
                } else {
                    gather_depths(depths, numbers, &mut values);
                }
                let first = depth_of(simd, t, at.reference, &values[0]);
                if !linear {
                    return [first; 4];
                }
                let below = first.towards(depth_of(simd, t, at.reference, &values[1]), across.share);
                let last = depth_of(simd, t, at.reference, &values[3]);
                let above = depth_of(simd, t, at.reference, &values[2]).towards(last, across.share);
                [below.towards(above, along.share); 4]
            }
            _ => nothing,
        }
    }

    #[inline(always)]
    fn axis<S: Simd>(&self, simd: S, k: usize, s: f32x16<S>, n: i32, linear: bool) -> Axis<S> {
        let size = f32x16::splat(simd, n as f32);
        let half = f32x16::splat(simd, 0.5);
        let (zero, last) = (i32x16::splat(simd, 0), i32x16::splat(simd, n - 1));
        let wrap = self.wrap[k];
        let u = match wrap {
            FastWrap::Repeat => (s - s.floor()) * size,
            FastWrap::Mirror => {
                let within = s - (s * half).floor() * f32x16::splat(simd, 2.0);
                (within.min(f32x16::splat(simd, 2.0) - within) * size).max(half).min(size - half)
            }
            FastWrap::Edge => (s * size).max(half).min(size - half),
        };
        if !linear {
            let low = u.floor().to_int::<i32x16<S>>().max(zero).min(last);
            return Axis { low, high: low, share: u };
        }
        let place = u - half;
        let floor = place.floor();
        let low = floor.to_int::<i32x16<S>>();
        let high = low + i32x16::splat(simd, 1);
        let share = place - floor;
        if wrap == FastWrap::Repeat {
            let low = low.simd_lt(zero).select(last, low).min(last);
            let high = high.simd_gt(last).select(zero, high).max(zero);
            return Axis { low, high, share };
        }
        Axis { low: low.max(zero).min(last), high: high.max(zero).min(last), share }
    }
}

/// Texels along one axis.
struct Axis<S: Simd> {
    low: i32x16<S>,
    high: i32x16<S>,
    share: f32x16<S>,
}

/// Where fragments read a texture: which of them, face, s and t, and what depths are compared to.
struct At<S: Simd> {
    mask: u16,
    face: usize,
    st: [f32x16<S>; 2],
    reference: f32x16<S>,
}

/// Varying `k` of the fragments; 0 if there is none.
#[inline(always)]
pub(crate) fn plane<S: Simd>(simd: S, f: &Fragments<'_>, k: usize) -> f32x16<S> {
    match f.varyings.get(k) {
        Some(plane) => f32x16::load_array_ref(simd, plane),
        None => f32x16::splat(simd, 0.0),
    }
}

/// The lanes of square `k` of 2 x 2 fragments; see [`Fragments::quads`].
#[inline(always)]
fn lanes_of(columns: u32, k: usize) -> u16 {
    if columns == 8 { 0x0303 << (2 * k) } else { 0x33 << (8 * (k / 2) + 2 * (k % 2)) }
}

/// Levels of detail of the squares of 2 x 2 fragments that are in the mask; see [`Unit::lods`].
#[inline(always)]
fn quad_lods<S: Simd>(t: &Sampled, f: &Fragments<'_>, st: [f32x16<S>; 2]) -> [f32; 4] {
    let mut lods = [0.0; 4];
    if !t.needs_lod() {
        return lods;
    }
    let [s, v] = [st[0].to_array(), st[1].to_array()];
    for (k, lod) in lods.iter_mut().enumerate() {
        let lanes = lanes_of(f.columns, k);
        let first = lanes.trailing_zeros() as usize % LANES;
        let [right, below] = [(first + 1) % LANES, (first + f.columns as usize) % LANES];
        if f.mask & lanes != 0 {
            let x = [s[right] - s[first], v[right] - v[first]];
            let y = [s[below] - s[first], v[below] - v[first]];
            *lod = t.lod([x, y]);
        }
    }
    lods
}

/// The face of a cube that all lanes of the mask meet, and where; `None` if that is not one face.
#[inline(always)]
fn on_cube<S: Simd>(simd: S, mask: u16, direction: [f32x16<S>; 3]) -> Option<(usize, [f32x16<S>; 2])> {
    let first = mask.trailing_zeros() as usize % LANES;
    let face = face_of([direction[0][first], direction[1][first], direction[2][first]]);
    let size = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
    let x = (size[0].simd_ge(size[1]) & size[0].simd_ge(size[2])).to_bitmask() as u16;
    let y = size[1].simd_ge(size[2]).to_bitmask() as u16 & !x;
    let major = [x, y, !(x | y)][face / 2];
    let negative = direction[face / 2].simd_lt(f32x16::splat(simd, 0.0)).to_bitmask() as u16;
    let same = major & if face % 2 == 1 { negative } else { !negative };
    if mask & !same != 0 {
        return None;
    }
    let [(i, major), (j, across), (k, along)] = FACES[face];
    let scale = f32x16::splat(simd, 0.5) / (f32x16::splat(simd, major) * direction[i]);
    let half = f32x16::splat(simd, 0.5);
    Some((
        face,
        [
            f32x16::splat(simd, across) * direction[j] * scale + half,
            f32x16::splat(simd, along) * direction[k] * scale + half,
        ],
    ))
}

// Through memory on purpose: inlined into vector code, every number would be taken out of its register and
// every texel put into one, lane by lane.

#[inline(never)]
fn gather_colors(colors: &[[u8; 4]], numbers: &[[i32; LANES]], out: &mut [[u32; LANES]; 4]) {
    for (to, &i) in out.as_flattened_mut().iter_mut().zip(numbers.as_flattened()) {
        *to = u32::from_le_bytes(colors.get(i as u32 as usize).copied().unwrap_or_default());
    }
}

#[inline(never)]
fn gather_depths(depths: &[f32], numbers: &[[i32; LANES]], out: &mut [[f32; LANES]; 4]) {
    for (to, &i) in out.as_flattened_mut().iter_mut().zip(numbers.as_flattened()) {
        *to = depths.get(i as u32 as usize).copied().unwrap_or_default();
    }
}

/// The depths of squares of two texels along each axis, of an image that keeps them in blocks.
#[inline(always)]
fn gather_squares<S: Simd>(
    simd: S,
    blocks: &BlockDepths,
    mask: u16,
    axes: [&Axis<S>; 2],
    linear: bool,
    out: &mut [[f32; LANES]; 4],
) {
    let out = if linear { &mut out[..] } else { &mut out[..1] };
    let [[x0, x1], [y0, y1]] = axes.map(|axis| {
        let high = if linear { axis.high } else { axis.low };
        [axis.low.to_array(), high.to_array()]
    });
    blocks.gather(simd, mask, [&x0, &x1], [&y0, &y1], out);
}

#[inline(always)]
fn color_of<S: Simd>(simd: S, t: &Sampled, words: &[u32; LANES]) -> Color<f32x16<S>> {
    if t.srgb { linear(simd, words) } else { unpacked(u32x16::load_array_ref(simd, words)) }
}

/// Depths, or the results of comparing them.
#[inline(always)]
fn depth_of<S: Simd>(simd: S, t: &Sampled, reference: f32x16<S>, depths: &[f32; LANES]) -> f32x16<S> {
    compared(simd, t, reference, f32x16::load_array_ref(simd, depths))
}

#[inline(always)]
fn linear<S: Simd>(simd: S, words: &[u32; LANES]) -> Color<f32x16<S>> {
    let table = &*LINEAR;
    let mut planes = [[0f32; LANES]; 3];
    for (i, word) in words.iter().enumerate() {
        for (k, plane) in planes.iter_mut().enumerate() {
            plane[i] = table[(word >> (8 * k) & 255) as usize];
        }
    }
    let [r, g, b] = &planes;
    let alpha = unpacked(u32x16::load_array_ref(simd, words))[3];
    [f32x16::load_array_ref(simd, r), f32x16::load_array_ref(simd, g), f32x16::load_array_ref(simd, b), alpha]
}

#[inline(always)]
fn compared<S: Simd>(simd: S, t: &Sampled, reference: f32x16<S>, depth: f32x16<S>) -> f32x16<S> {
    if t.params.compare_mode != gl::COMPARE_R_TO_TEXTURE {
        return depth;
    }
    let passes = compares_lanes(simd, t.params.compare_func, reference, depth);
    passes.select(f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0))
}

/// Which lanes compare as told; see [`super::ops::compares`].
#[inline(always)]
pub(crate) fn compares_lanes<S: Simd>(simd: S, func: u32, a: f32x16<S>, b: f32x16<S>) -> mask32x16<S> {
    match func {
        gl::NEVER => mask32x16::splat(simd, false),
        gl::LESS => a.simd_lt(b),
        gl::EQUAL => a.simd_eq(b),
        gl::LEQUAL => a.simd_le(b),
        gl::GREATER => a.simd_gt(b),
        gl::NOTEQUAL => a.simd_ne(b),
        gl::GEQUAL => a.simd_ge(b),
        _ => mask32x16::splat(simd, true),
    }
}

/// See [`Sampled::as_taken`].
#[inline(always)]
fn as_taken<S: Simd>(t: &Sampled, v: Color<f32x16<S>>) -> Color<f32x16<S>> {
    if !t.has_depth {
        return v;
    }
    let [zero, _, _, one] = constant(v[0], [0.0, 0.0, 0.0, 1.0]);
    match t.params.depth_mode {
        gl::INTENSITY => [v[0]; 4],
        gl::ALPHA => [zero, zero, zero, v[0]],
        _ => [v[0], v[0], v[0], one],
    }
}

/// The stencil test where fragments that fail change nothing, and what those that pass do. Returns them.
#[inline(always)]
pub(crate) fn stencil<S: Simd>(simd: S, s: &Stencil, plane: &mut [u8; LANES], mask: u16) -> u16 {
    let splat = |v: u8| u8x16::splat(simd, v);
    let stored = u8x16::load_array_ref(simd, plane);
    let (a, b) = (splat(s.reference & s.value_mask), stored & splat(s.value_mask));
    let passes = match s.func {
        gl::NEVER => return 0,
        gl::LESS => a.simd_lt(b),
        gl::EQUAL => a.simd_eq(b),
        gl::LEQUAL => a.simd_le(b),
        gl::GREATER => a.simd_gt(b),
        gl::NOTEQUAL => a.simd_ne(b),
        gl::GEQUAL => a.simd_ge(b),
        _ => mask8x16::splat(simd, true),
    };
    let passed = passes.to_bitmask() as u16 & mask;
    if s.depth_pass == gl::KEEP || passed == 0 {
        return passed;
    }
    let after = match s.depth_pass {
        gl::ZERO => splat(0),
        gl::REPLACE => splat(s.reference),
        gl::INCR => simd.saturating_add_u8x16(stored, splat(1)),
        gl::DECR => simd.saturating_sub_u8x16(stored, splat(1)),
        gl::INCR_WRAP => stored + splat(1),
        gl::DECR_WRAP => stored - splat(1),
        _ => stored ^ splat(255),
    };
    let written = (stored & splat(!s.write_mask)) | (after & splat(s.write_mask));
    let lanes = mask8x16::from_bitmask(simd, u64::from(passed));
    lanes.select(written, stored).store_array(plane);
    passed
}

/// See [`FogPlan::factor`].
#[inline(always)]
pub(crate) fn fog_factor<S: Simd>(simd: S, fog: &FogPlan, distance: f32x16<S>, mask: u16) -> f32x16<S> {
    let f = &fog.state;
    if f.mode == gl::LINEAR && f.end != f.start {
        let factor = (f32x16::splat(simd, f.end) - distance.abs()) / f32x16::splat(simd, f.end - f.start);
        return factor.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, 1.0));
    }
    let (distances, mut factors) = (distance.to_array(), [0.0; LANES]);
    for i in (0..LANES).filter(|i| mask >> i & 1 == 1) {
        factors[i] = fog.factor(distances[i]);
    }
    f32x16::load_array_ref(simd, &factors)
}

/// 8-bit colours as numbers 0 to 1, red in the low byte.
#[inline(always)]
pub(crate) fn unpacked<S: Simd>(packed: u32x16<S>) -> Color<f32x16<S>> {
    [channel(packed), channel(packed >> 8), channel(packed >> 16), channel(packed >> 24)]
}

#[inline(always)]
fn channel<S: Simd>(packed: u32x16<S>) -> f32x16<S> {
    let byte = packed & u32x16::splat(packed.token(), 255);
    let float: f32x16<S> = byte.bitcast::<i32x16<S>>().to_float();
    float * f32x16::splat(packed.token(), 1.0 / 255.0)
}

/// Colours within [0, 1] as 8-bit ones, rounded.
#[inline(always)]
pub(crate) fn packed<S: Simd>([r, g, b, a]: Color<f32x16<S>>) -> u32x16<S> {
    byte(r) | (byte(g) << 8) | (byte(b) << 16) | (byte(a) << 24)
}

#[inline(always)]
fn byte<S: Simd>(v: f32x16<S>) -> u32x16<S> {
    let (simd, v) = (v.token(), v);
    let scaled = v * f32x16::splat(simd, 255.0) + f32x16::splat(simd, 0.5);
    scaled.to_int::<i32x16<S>>().bitcast::<u32x16<S>>()
}
