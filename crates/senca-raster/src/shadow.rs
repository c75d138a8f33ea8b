//! Shadow maps, read along with the colour: of what the light's depths have farther away something nearer to the
//! light keeps the light off (Williams 1978).

use crate::api::{Compare, LANES};
use crate::block_depths::BlockDepths;
use crate::texture::Filter;
use fearless_simd::{Simd, f32x16, i32x16, mask32x16, prelude::*};

/// A shadow map, and where its coordinates are. Outside the map its rim counts.
#[derive(Clone, Copy, Debug)]
pub struct ShadowUnit<'a> {
    /// Depths seen from the light; row 0 is at t = 0.
    pub depths: &'a BlockDepths,
    /// Number of the varying that is s; t, r and q follow.
    pub coords: usize,
    /// How `r / q`, held to [0, 1], must compare to the depth at (`s / q`, `t / q`) where there is light.
    pub compare: Compare,
    /// Whether the nearest depth is compared, or the four nearest, of whose results the weighted mean is taken
    /// (percentage-closer filtering: Reeves, Salesin and Cook 1987).
    pub filter: Filter,
    /// Whether red, green and blue are multiplied by the share of light.
    pub dims_colors: bool,
    /// Whether alpha is.
    pub dims_alpha: bool,
}

/// Where a coordinate lies along a side of the map: between texels `low` and `high`.
struct Place {
    low: u32,
    high: u32,
    share: f32,
}

impl Place {
    fn new(s: f32, size: u32, filter: Filter) -> Self {
        let size = size as f32;
        let at = held(s * size, 0.5, size - 0.5);
        if filter == Filter::Nearest {
            let low = at.floor() as u32;
            return Self { low, high: low, share: 0.0 };
        }
        let low = (at - 0.5).floor();
        let high = held(low + 1.0, 0.0, size - 1.0);
        Self { low: low as u32, high: high as u32, share: (at - 0.5) - low }
    }
}

/// `v` within `low` and `high`; `low` if it is not a number.
fn held(v: f32, low: f32, high: f32) -> f32 {
    if v > low { v.min(high) } else { low }
}

impl ShadowUnit<'_> {
    /// Share of light at s, t, r, q: the plain form.
    pub(crate) fn light(&self, [s, t, r, q]: [f32; 4]) -> f32 {
        let per_q = 1.0 / q;
        let reference = held(r * per_q, 0.0, 1.0);
        let x = Place::new(s * per_q, self.depths.width(), self.filter);
        let y = Place::new(t * per_q, self.depths.height(), self.filter);
        let lit = |x: u32, y: u32| -> f32 {
            let passes = self.compare.passes(reference, self.depths.get(x, y));
            if passes { 1.0 } else { 0.0 }
        };
        if self.filter == Filter::Nearest {
            return lit(x.low, y.low);
        }
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        let first = mix(lit(x.low, y.low), lit(x.high, y.low), x.share);
        let second = mix(lit(x.low, y.high), lit(x.high, y.high), x.share);
        mix(first, second, y.share)
    }

    /// `rgba` in this light.
    pub(crate) fn dimmed(&self, rgba: [f32; 4], light: f32) -> [f32; 4] {
        let [r, g, b, a] = rgba;
        let [r, g, b] = if self.dims_colors { [r * light, g * light, b * light] } else { [r, g, b] };
        [r, g, b, if self.dims_alpha { a * light } else { a }]
    }

    /// Share of light at the lanes of `mask`.
    #[inline(always)]
    pub(crate) fn light_lanes<S: Simd>(&self, simd: S, [s, t, r, q]: [f32x16<S>; 4], mask: u16) -> f32x16<S> {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let per_q = one / q;
        let reference = held_lanes(r * per_q, zero, one);
        let x = PlaceLanes::new(simd, s * per_q, self.depths.width(), self.filter);
        let y = PlaceLanes::new(simd, t * per_q, self.depths.height(), self.filter);
        if self.is_lit(simd, reference, &x, &y, mask) {
            return one;
        }
        let (columns, rows) = ([x.low.to_array(), x.high.to_array()], [y.low.to_array(), y.high.to_array()]);
        let (columns, rows) = (columns.each_ref(), rows.each_ref());
        let mask = self.in_doubt(&reference.to_array(), columns, rows, mask);
        let mut depths = [[0.0; LANES]; 4];
        let light = if self.filter == Filter::Nearest {
            self.depths.gather(simd, mask, columns, rows, &mut depths[..1]);
            self.lit(simd, reference, &depths[0])
        } else {
            self.depths.gather(simd, mask, columns, rows, &mut depths);
            let first =
                mixed(self.lit(simd, reference, &depths[0]), self.lit(simd, reference, &depths[1]), x.share);
            let second =
                mixed(self.lit(simd, reference, &depths[2]), self.lit(simd, reference, &depths[3]), x.share);
            mixed(first, second, y.share)
        };
        mask32x16::from_bitmask(simd, u64::from(mask)).select(light, one)
    }

    /// Those lanes of `mask` of which it is not known without looking at depths that they are in full light. Places of
    /// one vector may be far apart.
    // Not to be inlined into vector code, which would take each number out of its register.
    #[inline(never)]
    fn in_doubt(
        &self,
        reference: &[f32; LANES],
        [x0, x1]: [&[i32; LANES]; 2],
        [y0, y1]: [&[i32; LANES]; 2],
        mask: u16,
    ) -> u16 {
        let Some(greatest) = self.wants_greatest() else { return mask };
        let (mut doubt, mut left) = (mask, mask);
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let bound = self.depths.bound([x0[lane], x1[lane]], [y0[lane], y1[lane]], greatest);
            let is_lit = bound.is_some_and(|bound| self.compare.passes(reference[lane], bound));
            doubt &= !(u16::from(is_lit) << lane);
        }
        doubt
    }

    /// Whether what passes against the greatest of some depths passes against all of them, or what passes against the
    /// least; `None` if neither is so.
    fn wants_greatest(&self) -> Option<bool> {
        match self.compare {
            Compare::Less | Compare::LessEqual => Some(false),
            Compare::Greater | Compare::GreaterEqual => Some(true),
            _ => None,
        }
    }

    /// Whether the lanes of `mask` are in full light by what is known without looking at any depth.
    #[inline(always)]
    fn is_lit<S: Simd>(
        &self,
        simd: S,
        reference: f32x16<S>,
        x: &PlaceLanes<S>,
        y: &PlaceLanes<S>,
        mask: u16,
    ) -> bool {
        let Some(greatest) = self.wants_greatest() else { return false };
        let keep = mask32x16::from_bitmask(simd, u64::from(mask));
        let (columns, rows) = (x.ends(simd, keep), y.ends(simd, keep));
        let Some(bound) = self.depths.bound(columns, rows, greatest) else { return false };
        let passes = crate::cover::compare(simd, self.compare, reference, f32x16::splat(simd, bound));
        passes.to_bitmask() as u16 & mask == mask
    }

    #[inline(always)]
    fn lit<S: Simd>(&self, simd: S, reference: f32x16<S>, depths: &[f32; LANES]) -> f32x16<S> {
        let stored = f32x16::load_array_ref(simd, depths);
        let passes = crate::cover::compare(simd, self.compare, reference, stored);
        passes.select(f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0))
    }
}

#[inline(always)]
fn mixed<S: Simd>(a: f32x16<S>, b: f32x16<S>, share: f32x16<S>) -> f32x16<S> {
    a + (b - a) * share
}

/// See [`held`].
#[inline(always)]
fn held_lanes<S: Simd>(v: f32x16<S>, low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    v.simd_gt(low).select(v.min(high), low)
}

/// See [`Place`].
struct PlaceLanes<S: Simd> {
    low: i32x16<S>,
    high: i32x16<S>,
    share: f32x16<S>,
}

impl<S: Simd> PlaceLanes<S> {
    #[inline(always)]
    fn new(simd: S, s: f32x16<S>, size: u32, filter: Filter) -> Self {
        let splat = |v: f32| f32x16::splat(simd, v);
        let half = splat(0.5);
        let at = held_lanes(s * splat(size as f32), half, splat(size as f32 - 0.5));
        if filter == Filter::Nearest {
            let low = at.to_int();
            return Self { low, high: low, share: splat(0.0) };
        }
        let low = (at - half).floor();
        let high = held_lanes(low + splat(1.0), splat(0.0), splat(size as f32 - 1.0));
        Self { low: low.to_int(), high: high.to_int(), share: (at - half) - low }
    }

    /// The first and the last texel of the lanes in `keep`; the last before the first if there are none.
    #[inline(always)]
    fn ends(&self, simd: S, keep: mask32x16<S>) -> [i32; 2] {
        let low = keep.select(self.low, i32x16::splat(simd, i32::MAX));
        let high = keep.select(self.high, i32x16::splat(simd, -1));
        [low.reduce_min(), high.reduce_max()]
    }
}
