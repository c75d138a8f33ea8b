//! What happens between rasterization and the buffers: texturing, colour sum, fog, and the operations
//! per fragment (OpenGL 1.5, sections 3.8 to 3.10 and chapter 4.1).
//!
//! A [`Program`] is made of the state once per draw and is the rasterizer's stage. There are two of
//! everything: the plain form goes through the fragments one by one by the specification's formulas;
//! the fast one does sixteen at a time, falls back to the plain one for rare kinds of textures, and is
//! tested against it.

mod env;
mod fast;
mod ops;
mod real;
mod sample;
mod shade;
#[cfg(test)]
mod tests;
mod view;

pub(crate) use ops::Blending;
pub(crate) use sample::{MAX_LOD_BIAS, Sampled};
pub(crate) use shade::{FogPlan, Shader, Unit};
pub(crate) use view::View;

use crate::raster_state::{Kind, RasterState};
use crate::state::Cap;
use crate::vertex::Layout;
use crate::{Enum, gl};
use env::Sources;
use fast::{FastTexture, compares_lanes, packed, plane, unpacked};
use ops::{ColorWrite, Stencil, compares, logic};
use real::{Color, clamped, constant};
use senca_raster::simd::{Simd, dispatch, f32x16, mask32x16, prelude::*, u32x16};
use senca_raster::{
    FragmentStage, Fragments, LANES, PixelColors, Pixels, SAMPLES, Samples, Shaded, SimdLevel,
};

/// The depth test, where the rasterizer must not do it.
#[derive(Clone, Copy, Debug)]
struct DepthTest {
    func: Enum,
    write: bool,
}

/// Everything that happens to fragments in a draw.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    level: SimdLevel,
    shader: Shader,
    /// Of each unit of the shader.
    fast: Vec<Option<FastTexture>>,
    alpha: Option<(Enum, f32)>,
    /// 32 rows from the bottom, the most significant bit left.
    polygon_stipple: Option<Box<[u32; 32]>>,
    stencil: Option<Stencil>,
    /// Where the stencil test wants to know of fragments that fail.
    depth: Option<DepthTest>,
    color: ColorWrite,
    writes_color: bool,
    needs_color: bool,
    /// Where pixels have several samples.
    samples: Option<SampleMasks>,
    /// One fragment at a time.
    plain: bool,
}

/// What lessens the samples a fragment covers (OpenGL 1.5, section 4.1.3).
#[derive(Clone, Copy, Debug)]
struct SampleMasks {
    alpha_to_coverage: bool,
    alpha_to_one: bool,
    coverage: Option<(f32, bool)>,
}

impl SampleMasks {
    fn new(s: &RasterState) -> Option<Self> {
        let masks = Self {
            alpha_to_coverage: s.has(Cap::SampleAlphaToCoverage),
            alpha_to_one: s.has(Cap::SampleAlphaToOne),
            coverage: s.has(Cap::SampleCoverage).then_some((s.multisample.coverage, s.multisample.invert)),
        };
        (masks.alpha_to_coverage || masks.alpha_to_one || masks.coverage.is_some()).then_some(masks)
    }

    /// Lanes of `mask` whose sample number `sample` is covered. Samples come in one after another as
    /// the coverage grows.
    fn covered(&self, sample: usize, alpha: &[f32; LANES], mask: u16) -> u16 {
        let threshold = (sample as f32 + 0.5) * 0.25;
        if self.coverage.is_some_and(|(coverage, invert)| (coverage > threshold) == invert) {
            return 0;
        }
        if !self.alpha_to_coverage {
            return mask;
        }
        (0..LANES).filter(|&i| alpha[i] > threshold).fold(0, |covered, i| covered | 1 << i) & mask
    }
}

impl Program {
    /// For primitives of a kind whose vertices have a layout. `has_stencil` and `has_depth` tell which
    /// buffers there are.
    pub(crate) fn new(
        s: &RasterState,
        kind: Kind,
        layout: &Layout,
        level: SimdLevel,
        [has_depth, has_stencil]: [bool; 2],
    ) -> Self {
        let shader = shader_of(s, layout);
        let stencil = (s.has(Cap::StencilTest) && has_stencil).then(|| Stencil::new(&s.stencil));
        let depth_on = s.has(Cap::DepthTest) && has_depth;
        let late = stencil.is_some_and(|stencil| stencil.needs_failures());
        let alpha = s.has(Cap::AlphaTest).then_some((s.color.alpha_func, s.color.alpha_ref));
        let alpha = alpha.filter(|(func, _)| *func != gl::ALWAYS);
        let logic_op = s.has(Cap::ColorLogicOp).then_some(s.color.logic_op);
        let blending = (s.has(Cap::Blend) && logic_op.is_none()).then(|| Blending::new(&s.color));
        let color = ColorWrite { blending, logic_op, mask: s.color.mask };
        let writes_color = color.mask != [false; 4];
        Self {
            level,
            fast: shader.units.iter().map(|unit| FastTexture::new(&unit.texture)).collect(),
            shader,
            alpha,
            polygon_stipple: (kind == Kind::Triangles && s.has(Cap::PolygonStipple))
                .then(|| Box::new(s.polygon_stipple.0)),
            stencil,
            depth: late.then_some(DepthTest {
                func: if depth_on { s.depth.func } else { gl::ALWAYS },
                write: depth_on && s.depth.mask,
            }),
            color,
            writes_color,
            needs_color: writes_color || alpha.is_some(),
            samples: SampleMasks::new(s),
            plain: false,
        }
    }

    /// Whether pixels have several samples.
    pub(crate) fn with_samples(self, several: bool) -> Self {
        let samples = self.samples.filter(|_| several);
        let lessens = samples.is_some_and(|s| s.alpha_to_coverage);
        Self { needs_color: self.needs_color || lessens, samples, ..self }
    }

    /// The same, one fragment at a time.
    #[cfg(test)]
    pub(crate) fn plain(self) -> Self {
        Self { plain: true, ..self }
    }

    /// Lanes that the polygon stipple leaves.
    fn stippled(&self, f: &Fragments<'_>) -> u16 {
        let Some(pattern) = &self.polygon_stipple else { return u16::MAX };
        let kept = f.lanes().filter(|&i| {
            let (x, y) = (f.column(i) % 32, f.row(i) % 32);
            pattern[y as usize] >> (31 - x) & 1 == 1
        });
        kept.fold(0, |mask, i| mask | 1 << i)
    }

    fn shade_plain(&self, f: &Fragments<'_>, out: &mut Shaded) {
        if self.needs_color {
            self.shader.shade_plain(f, &mut out.rgba);
        }
        for i in f.lanes() {
            if let Some(coverage) = f.coverage {
                out.rgba[3][i] *= coverage[i];
            }
            if self.alpha.is_some_and(|(func, reference)| !compares(func, out.rgba[3][i], reference)) {
                out.discard(i);
            }
        }
    }

    fn merge_plain(&self, f: &Fragments<'_>, shaded: &Shaded, pixels: &mut Pixels<'_>) -> u16 {
        let mut passed = 0;
        for i in f.lanes() {
            if !self.passes(f, pixels, i) {
                continue;
            }
            passed |= 1 << i;
            let new = shaded.rgba.map(|plane| plane[i]);
            match &mut pixels.color {
                PixelColors::None => {}
                PixelColors::Rgba8(p) => p[i] = self.packed_pixel(new, p[i]),
                PixelColors::Rgba32F(p) => {
                    let old = [p[0][i], p[1][i], p[2][i], p[3][i]];
                    let color = self.color.mixed(new, old);
                    (0..4).filter(|&k| self.color.mask[k]).for_each(|k| p[k][i] = color[k]);
                }
            }
        }
        passed
    }

    /// Stencil and depth test of one fragment, with what they do.
    fn passes(&self, f: &Fragments<'_>, pixels: &mut Pixels<'_>, i: usize) -> bool {
        let (Some(stencil), Some(plane)) = (&self.stencil, &mut pixels.stencil) else { return true };
        let stored = &mut plane[i];
        if !stencil.passes(*stored) {
            stencil.write(stencil.fail, stored);
            return false;
        }
        if let (Some(test), Some(depth)) = (&self.depth, &mut pixels.depth) {
            if !compares(test.func, f.depth[i], depth[i]) {
                stencil.write(stencil.depth_fail, stored);
                return false;
            }
            if test.write {
                depth[i] = f.depth[i];
            }
        }
        stencil.write(stencil.depth_pass, stored);
        true
    }

    fn packed_pixel(&self, new: [f32; 4], stored: u32) -> u32 {
        let old = stored.to_le_bytes().map(|v| f32::from(v) * (1.0 / 255.0));
        let bytes = self.color.mixed(new, old).map(|v| (v * 255.0 + 0.5) as u8);
        let mut word = u32::from_le_bytes(bytes);
        if let Some(op) = self.color.logic_op {
            word = logic(op, word, stored);
        }
        let bits = self.color.bits();
        stored & !bits | word & bits
    }

    #[inline(always)]
    fn shade_fast<S: Simd>(&self, simd: S, f: &Fragments<'_>, out: &mut Shaded) {
        let (color, kept) = self.shaded(simd, f);
        out.keep &= kept;
        for (plane, value) in out.rgba.iter_mut().zip(color) {
            value.store_array(plane);
        }
    }

    /// Colours of fragments, and the lanes that the alpha test leaves.
    #[inline(always)]
    fn shaded<S: Simd>(&self, simd: S, f: &Fragments<'_>) -> (Color<f32x16<S>>, u16) {
        let mut color = if self.needs_color {
            self.colored(simd, f)
        } else {
            constant(f32x16::splat(simd, 0.0), [0.0; 4])
        };
        if let Some(coverage) = f.coverage {
            color[3] *= f32x16::load_array_ref(simd, coverage);
        }
        let Some((func, reference)) = self.alpha else { return (color, u16::MAX) };
        let kept = compares_lanes(simd, func, color[3], f32x16::splat(simd, reference));
        (color, kept.to_bitmask() as u16)
    }

    /// Shades and merges at once.
    #[inline(always)]
    fn run_fast<S: Simd>(&self, simd: S, f: &Fragments<'_>, pixels: &mut Pixels<'_>) -> u16 {
        let (color, kept) = self.shaded(simd, f);
        let f = Fragments { mask: f.mask & kept, ..*f };
        if f.mask == 0 { 0 } else { self.merge_fast(simd, &f, color, pixels) }
    }

    #[inline(always)]
    fn colored<S: Simd>(&self, simd: S, f: &Fragments<'_>) -> Color<f32x16<S>> {
        let varying = [plane(simd, f, 0), plane(simd, f, 1), plane(simd, f, 2), plane(simd, f, 3)];
        let primary = clamped(varying);
        let mut color = primary;
        if let ([unit], [fast]) = (&self.shader.units[..], &self.fast[..]) {
            let texel = texel_lanes(simd, unit, fast.as_ref(), f);
            let texels = [(unit.number, texel)];
            let s = Sources { primary, previous: primary, texel, texels: &texels };
            color = env::apply(&unit.env, unit.texture.base, &s);
        } else if !self.shader.units.is_empty() {
            color = simd.vectorize(
                #[inline(always)]
                || self.textured(simd, f, primary),
            );
        }
        if let Some(first) = self.shader.secondary {
            let (r, g, b) = (plane(simd, f, first), plane(simd, f, first + 1), plane(simd, f, first + 2));
            let second = clamped([r, g, b, primary[3]]);
            let [r, g, b, _] =
                clamped([color[0] + second[0], color[1] + second[1], color[2] + second[2], color[3]]);
            color = [r, g, b, color[3]];
        }
        if let Some(fog) = &self.shader.fog {
            color = fog.mixed(color, fast::fog_factor(simd, fog, plane(simd, f, fog.coord), f.mask));
        }
        color
    }

    /// The colour after several units.
    #[inline(always)]
    fn textured<S: Simd>(&self, simd: S, f: &Fragments<'_>, primary: Color<f32x16<S>>) -> Color<f32x16<S>> {
        let mut color = primary;
        let units = &self.shader.units;
        let mut texels = [(0, primary); crate::state::TEXTURE_UNITS];
        let count = units.len().min(texels.len());
        for ((unit, fast), to) in units.iter().zip(&self.fast).zip(&mut texels) {
            *to = (unit.number, texel_lanes(simd, unit, fast.as_ref(), f));
        }
        for (unit, (_, texel)) in units.iter().zip(&texels) {
            let s = Sources { primary, previous: color, texel: *texel, texels: &texels[..count] };
            color = env::apply(&unit.env, unit.texture.base, &s);
        }
        color
    }

    #[inline(always)]
    fn merge_fast<S: Simd>(
        &self,
        simd: S,
        f: &Fragments<'_>,
        new: Color<f32x16<S>>,
        pixels: &mut Pixels<'_>,
    ) -> u16 {
        let passed = self.tested(simd, f, pixels);
        if passed == 0 || !self.writes_color {
            return passed;
        }
        let keep = mask32x16::from_bitmask(simd, u64::from(passed));
        match &mut pixels.color {
            PixelColors::None => {}
            PixelColors::Rgba8(plane) => {
                let stored = u32x16::load_array_ref(simd, plane);
                let mut word = packed(self.color.mixed(new, unpacked(stored)));
                if let Some(op) = self.color.logic_op {
                    let (s, d) = (word.to_array(), stored.to_array());
                    let mixed: [u32; LANES] = std::array::from_fn(|i| logic(op, s[i], d[i]));
                    word = u32x16::load_array(simd, mixed);
                }
                let bits = self.color.bits();
                if bits != u32::MAX {
                    word = (stored & u32x16::splat(simd, !bits)) | (word & u32x16::splat(simd, bits));
                }
                keep.select(word, stored).store_array(plane);
            }
            PixelColors::Rgba32F(planes) => {
                let [r, g, b, a] = &*planes;
                let old = [
                    f32x16::load_array_ref(simd, r),
                    f32x16::load_array_ref(simd, g),
                    f32x16::load_array_ref(simd, b),
                    f32x16::load_array_ref(simd, a),
                ];
                let color = self.color.mixed(new, old);
                for k in (0..4).filter(|&k| self.color.mask[k]) {
                    keep.select(color[k], old[k]).store_array(planes[k]);
                }
            }
        }
        passed
    }
}

/// The texels of a unit.
#[inline(always)]
fn texel_lanes<S: Simd>(
    simd: S,
    unit: &Unit,
    fast: Option<&FastTexture>,
    f: &Fragments<'_>,
) -> Color<f32x16<S>> {
    if let Some(fast) = fast
        && let Some(texel) = fast.sample(simd, unit, f)
    {
        return texel;
    }
    let [r, g, b, a] = &texel_planes(unit, f);
    [
        f32x16::load_array_ref(simd, r),
        f32x16::load_array_ref(simd, g),
        f32x16::load_array_ref(simd, b),
        f32x16::load_array_ref(simd, a),
    ]
}

/// Colours out of memory.
#[inline(always)]
fn loaded<S: Simd>(simd: S, shaded: &Shaded) -> Color<f32x16<S>> {
    let [r, g, b, a] = &shaded.rgba;
    [
        f32x16::load_array_ref(simd, r),
        f32x16::load_array_ref(simd, g),
        f32x16::load_array_ref(simd, b),
        f32x16::load_array_ref(simd, a),
    ]
}

/// The texels of a unit, one fragment at a time.
#[inline(never)]
fn texel_planes(unit: &Unit, f: &Fragments<'_>) -> [[f32; LANES]; 4] {
    let coords = unit.coords(f);
    let lods = unit.lods(f, &coords);
    let mut planes = [[0.0; LANES]; 4];
    for i in f.lanes() {
        let at = [coords.at[0][i], coords.at[1][i], coords.at[2][i]];
        let texel = unit.texture.sample(at, coords.reference[i], lods[i]);
        (0..4).for_each(|k| planes[k][i] = texel[k]);
    }
    planes
}

impl FragmentStage for Program {
    fn tests_depth(&self) -> bool {
        self.depth.is_some()
    }

    fn discards(&self) -> bool {
        self.alpha.is_some()
            || self.polygon_stipple.is_some()
            || self.stencil.is_some()
            || self.samples.is_some()
    }

    fn shades(&self) -> bool {
        self.needs_color || self.polygon_stipple.is_some()
    }

    fn touches_color(&self) -> bool {
        self.writes_color
    }

    fn touches_stencil(&self) -> bool {
        self.stencil.is_some()
    }

    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        out.keep &= self.stippled(fragments);
        let f = Fragments { mask: fragments.mask & out.keep, ..*fragments };
        if f.mask == 0 {
            return;
        }
        if self.plain {
            return self.shade_plain(&f, out);
        }
        dispatch!(self.level, simd => self.shade_fast(simd, &f, out));
    }

    fn merge(&self, fragments: &Fragments<'_>, shaded: &Shaded, pixels: &mut Pixels<'_>) -> u16 {
        if let Some(samples) = &self.samples {
            let mask = samples.covered(fragments.sample, &shaded.rgba[3], fragments.mask);
            let (f, mut shaded) = (Fragments { mask, ..*fragments }, *shaded);
            if samples.alpha_to_one {
                shaded.rgba[3] = [1.0; LANES];
            }
            return if mask == 0 { 0 } else { self.merge_plain(&f, &shaded, pixels) };
        }
        if self.plain {
            return self.merge_plain(fragments, shaded, pixels);
        }
        dispatch!(self.level, simd => self.merge_fast(simd, fragments, loaded(simd, shaded), pixels))
    }

    fn shade_and_merge(&self, fragments: &Fragments<'_>, pixels: &mut Pixels<'_>) -> u16 {
        if self.plain || self.samples.is_some() {
            let mut shaded = Shaded::default();
            self.shade(fragments, &mut shaded);
            let f = Fragments { mask: fragments.mask & shaded.keep, ..*fragments };
            return if f.mask == 0 { 0 } else { self.merge(&f, &shaded, pixels) };
        }
        let f = Fragments { mask: fragments.mask & self.stippled(fragments), ..*fragments };
        if f.mask == 0 {
            return 0;
        }
        dispatch!(self.level, simd => self.run_fast(simd, &f, pixels))
    }

    fn shade_and_merge_samples(
        &self,
        fragments: &Fragments<'_>,
        samples: &Samples<'_>,
        pixels: &mut [Pixels<'_>; SAMPLES],
    ) -> [u16; SAMPLES] {
        if self.plain || self.samples.is_some() {
            return Each(self).shade_and_merge_samples(fragments, samples, pixels);
        }
        let f = Fragments { mask: fragments.mask & self.stippled(fragments), ..*fragments };
        if f.mask == 0 {
            return [0; SAMPLES];
        }
        dispatch!(self.level, simd => self.run_samples(simd, &f, samples, pixels))
    }
}

/// A program that merges samples one after another.
struct Each<'a>(&'a Program);

impl FragmentStage for Each<'_> {
    fn shades(&self) -> bool {
        self.0.shades()
    }

    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        self.0.shade(fragments, out);
    }

    fn merge(&self, fragments: &Fragments<'_>, shaded: &Shaded, pixels: &mut Pixels<'_>) -> u16 {
        self.0.merge(fragments, shaded, pixels)
    }
}

impl Program {
    /// Shades pixels and merges their samples.
    #[inline(always)]
    fn run_samples<S: Simd>(
        &self,
        simd: S,
        f: &Fragments<'_>,
        samples: &Samples<'_>,
        pixels: &mut [Pixels<'_>; SAMPLES],
    ) -> [u16; SAMPLES] {
        let (color, kept) = self.shaded(simd, f);
        let kept = kept & f.mask;
        let opaque = self.color.blending.is_none() && self.color.logic_op.is_none();
        let word = packed(clamped(color));
        let mut passed = [0; SAMPLES];
        for (s, pixels) in pixels.iter_mut().enumerate() {
            let mask = samples.masks[s] & kept;
            if mask == 0 {
                continue;
            }
            let f = Fragments { mask, sample: s, depth: samples.depths[s], ..*f };
            passed[s] = if opaque && let PixelColors::Rgba8(_) = pixels.color {
                self.merge_word(simd, &f, word, pixels)
            } else {
                self.merge_fast(simd, &f, color, pixels)
            };
        }
        passed
    }

    /// Merges colours that are neither blended nor combined with what is there, ready to be stored.
    #[inline(always)]
    fn merge_word<S: Simd>(
        &self,
        simd: S,
        f: &Fragments<'_>,
        word: u32x16<S>,
        pixels: &mut Pixels<'_>,
    ) -> u16 {
        let passed = self.tested(simd, f, pixels);
        if let PixelColors::Rgba8(plane) = &mut pixels.color
            && self.writes_color
            && passed != 0
        {
            let stored = u32x16::load_array_ref(simd, plane);
            let bits = self.color.bits();
            let word = (stored & u32x16::splat(simd, !bits)) | (word & u32x16::splat(simd, bits));
            mask32x16::from_bitmask(simd, u64::from(passed)).select(word, stored).store_array(plane);
        }
        passed
    }

    /// Lanes that pass the stencil test, and that of depth if it is done here, with what the tests do.
    #[inline(always)]
    fn tested<S: Simd>(&self, simd: S, f: &Fragments<'_>, pixels: &mut Pixels<'_>) -> u16 {
        if let (Some(stencil), None, Some(plane)) = (&self.stencil, &self.depth, &mut pixels.stencil) {
            return fast::stencil(simd, stencil, plane, f.mask);
        }
        if self.stencil.is_none() {
            return f.mask;
        }
        f.lanes().filter(|&i| self.passes(f, pixels, i)).fold(0, |mask, i| mask | 1 << i)
    }
}

fn shader_of(s: &RasterState, layout: &Layout) -> Shader {
    let units = s.units.iter().filter_map(|unit| {
        let seamless = s.has(Cap::TextureCubeMapSeamless);
        let coords = usize::from(layout.tex_coords[unit.unit]?);
        let texture =
            Sampled::new(unit.target, &unit.view.params, &unit.view.levels, unit.env.lod_bias, seamless)?;
        Some(Unit { number: unit.unit, env: unit.env, texture, coords })
    });
    Shader {
        units: units.collect(),
        secondary: layout.secondary.map(usize::from).filter(|_| s.color_sum),
        fog: layout
            .fog
            .filter(|_| s.has(Cap::Fog))
            .map(|coord| FogPlan { state: s.fog, coord: usize::from(coord) }),
    }
}
