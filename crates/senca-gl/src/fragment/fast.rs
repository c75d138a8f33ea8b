//! Reading textures sixteen fragments at a time, for the kinds that programs use: two dimensions or a
//! face of a cube, colours of 8 bits or depths, without borders. The twin of [`super::sample`].

use super::ops::Stencil;
use super::real::{Color, constant, mixed};
use super::sample::{LINEAR, Level, Sampled, face_of, on_face};
use super::shade::{Coords, FogPlan};
use crate::gl;
use crate::state::TexTarget;
use crate::texture::Texels;
use senca_raster::LANES;
use senca_raster::simd::{Simd, f32x16, i32x16, mask8x16, mask32x16, prelude::*, u8x16, u32x16};

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

    /// The texture at the lanes in `mask`, as environments take it; `None` where it must be read one
    /// fragment at a time.
    #[inline(always)]
    pub(crate) fn sample<S: Simd>(
        &self,
        simd: S,
        t: &Sampled,
        coords: &Coords,
        lods: &[f32; LANES],
        mask: u16,
    ) -> Option<Color<f32x16<S>>> {
        let (face, st) = self.place(t, coords, lods, mask)?;
        let st = [f32x16::load_array_ref(simd, &st[0]), f32x16::load_array_ref(simd, &st[1])];
        let reference = f32x16::load_array_ref(simd, &coords.reference);
        let reference = reference.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, 1.0));
        let mut result = constant(reference, [0.0; 4]);
        let mut left = mask;
        while left != 0 {
            let first = left.trailing_zeros() as usize % LANES;
            let chosen = t.levels_at(lods[first]);
            let (linear, level, _) = chosen;
            // All lanes that read the same levels in the same way.
            let (mut lanes, mut shares) = (0, [0.0; LANES]);
            for i in (0..LANES).filter(|i| left >> i & 1 == 1) {
                let (l, n, share) = if lods[i] == lods[first] { chosen } else { t.levels_at(lods[i]) };
                if (l, n) == (linear, level) {
                    lanes |= 1 << i;
                    shares[i] = share;
                }
            }
            left &= !lanes;
            let read = |level: usize| self.read(simd, t, level, face, st, reference, linear);
            let mut value = read(level);
            if shares.iter().any(|share| *share > 0.0) {
                value = mixed(value, read(level + 1), f32x16::load_array_ref(simd, &shares));
            }
            let here = mask32x16::from_bitmask(simd, u64::from(lanes));
            for k in 0..4 {
                result[k] = here.select(value[k], result[k]);
            }
        }
        Some(as_taken(t, result))
    }

    /// The face that all lanes read, and where; `None` if that is not one face.
    fn place(
        &self,
        t: &Sampled,
        coords: &Coords,
        lods: &[f32; LANES],
        mask: u16,
    ) -> Option<(usize, [[f32; LANES]; 2])> {
        if t.target != TexTarget::Cube {
            return Some((0, [coords.at[0], coords.at[1]]));
        }
        let direction = |i: usize| [coords.at[0][i], coords.at[1][i], coords.at[2][i]];
        let face = face_of(direction(mask.trailing_zeros() as usize % LANES));
        let mut st = [[0.5; LANES]; 2];
        let lanes = || (0..LANES).filter(|i| mask >> i & 1 == 1);
        let mut rim = 0.0;
        if self.guarded {
            // Half a texel of the coarsest level read: beyond it texels of two faces mix.
            let lod = lanes().map(|i| lods[i]).fold(f32::NEG_INFINITY, f32::max);
            let coarsest = (t.levels_at(lod).1 + 1).min(t.levels.len() - 1);
            rim = 0.5 / t.levels[coarsest].size[0] as f32;
        }
        for i in lanes() {
            if face_of(direction(i)) != face {
                return None;
            }
            let [s, v, _] = on_face(face, direction(i));
            let within = |c: f32| c >= rim && c <= 1.0 - rim;
            if self.guarded && !(within(s) && within(v)) {
                return None;
            }
            (st[0][i], st[1][i]) = (s, v);
        }
        Some((face, st))
    }

    #[inline(always)]
    fn read<S: Simd>(
        &self,
        simd: S,
        t: &Sampled,
        level: usize,
        face: usize,
        st: [f32x16<S>; 2],
        reference: f32x16<S>,
        linear: bool,
    ) -> Color<f32x16<S>> {
        let level = &t.levels[level.min(t.levels.len() - 1)];
        let width = i32x16::splat(simd, level.size[0]);
        let across = self.axis(simd, 0, st[0], level.size[0], linear);
        let along = self.axis(simd, 1, st[1], level.size[1], linear);
        let Some(texels) = level.texels.get(face) else { return constant(reference, [0.0; 4]) };
        let rows = [along.low * width, along.high * width];
        let at = |row: i32x16<S>, column: i32x16<S>| (row + column).to_array();
        if !linear {
            return texels_at(simd, t, texels, &at(rows[0], across.low), reference);
        }
        let corner =
            |row: usize, column: i32x16<S>| texels_at(simd, t, texels, &at(rows[row], column), reference);
        let low = mixed(corner(0, across.low), corner(0, across.high), across.share);
        let high = mixed(corner(1, across.low), corner(1, across.high), across.share);
        mixed(low, high, along.share)
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

/// Texels by number: colours, or in the first component depths, or the results of comparing them.
#[inline(always)]
fn texels_at<S: Simd>(
    simd: S,
    t: &Sampled,
    texels: &Texels,
    at: &[i32; LANES],
    reference: f32x16<S>,
) -> Color<f32x16<S>> {
    match texels {
        Texels::Rgba8(colors) => {
            let mut words = [0u32; LANES];
            for (word, &i) in words.iter_mut().zip(at) {
                *word = u32::from_le_bytes(colors.get(i as u32 as usize).copied().unwrap_or_default());
            }
            if t.srgb { linear(simd, &words) } else { unpacked(u32x16::load_array_ref(simd, &words)) }
        }
        Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. } => {
            let mut values = [0f32; LANES];
            for (value, &i) in values.iter_mut().zip(at) {
                *value = depths.get(i as u32 as usize).copied().unwrap_or_default();
            }
            let depth = f32x16::load_array_ref(simd, &values);
            [compared(simd, t, reference, depth), depth, depth, depth]
        }
        _ => constant(reference, [0.0; 4]),
    }
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
