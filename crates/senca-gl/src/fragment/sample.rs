//! Reading textures: level of detail, wrapping, filters, cube faces, comparison of depths; the plain
//! form, one fragment at a time.
//!
//! Source: OpenGL 1.5, sections 3.8.7 to 3.8.9 and 3.8.14; ARB_seamless_cube_map; EXT_texture_sRGB.

use super::ops::compares;
use crate::state::TexTarget;
use crate::texture::{BaseFormat, TexImage, TexParams, Texels};
use crate::{Enum, gl};
use senca_raster::cube::{across_edge, face_of, on_face};
use senca_raster::log2;
use std::sync::{Arc, LazyLock};

/// Most that biases may add to the level of detail, either way.
pub(crate) const MAX_LOD_BIAS: f32 = 16.0;

/// A level of a texture.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// Without border.
    pub(crate) size: [i32; 3],
    /// Texels in a row and rows in a slice, with border.
    pub(crate) stride: [i32; 2],
    pub(crate) border: i32,
    /// Of each face.
    pub(crate) texels: Vec<Arc<Texels>>,
}

impl Level {
    fn new(images: &[TexImage], dimensions: usize) -> Option<Self> {
        let first = images.first()?;
        let border = first.border as i32;
        let full = [first.width, first.height, first.depth].map(|v| v as i32);
        let size = std::array::from_fn(|k| if k < dimensions { full[k] - 2 * border } else { 1 });
        let texels = images.iter().map(|image| Arc::clone(&image.texels)).collect();
        Some(Self { size, stride: [full[0], full[1]], border, texels })
    }

    /// Number of a texel, `None` outside the image and its border.
    fn index(&self, at: [i32; 3], dimensions: usize) -> Option<usize> {
        let mut index = 0;
        for k in (0..3).rev() {
            let border = if k < dimensions { self.border } else { 0 };
            if at[k] < -border || at[k] >= self.size[k] + border {
                return None;
            }
            let below = if k == 0 { 1 } else { self.stride[k - 1] as usize };
            index = (index + (at[k] + border) as usize) * below;
        }
        Some(index)
    }
}

/// A complete texture as a draw reads it.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    pub(crate) target: TexTarget,
    pub(crate) params: TexParams,
    /// From the base level to the last one.
    pub(crate) levels: Vec<Level>,
    /// What environments take it for: of depths what `DEPTH_TEXTURE_MODE` says.
    pub(crate) base: BaseFormat,
    /// Colour outside, as texels of its format are.
    pub(crate) border_color: [f32; 4],
    /// Texels are depths.
    pub(crate) has_depth: bool,
    pub(crate) srgb: bool,
    pub(crate) seamless: bool,
    /// Bias of texture and environment.
    pub(crate) lod_bias: f32,
}

/// Linear values of sRGB bytes.
pub(crate) static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|v| {
        let v = v as f64 / 255.0;
        let linear = if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

impl Sampled {
    /// From the images of each level that is sampled, face by face; `None` without images.
    pub(crate) fn new(
        target: TexTarget,
        params: &TexParams,
        levels: &[Vec<TexImage>],
        env_lod_bias: f32,
        seamless: bool,
    ) -> Option<Self> {
        let format = levels.first()?.first()?.format;
        let dimensions = dimensions_of(target);
        let images = levels.iter().map(|images| Level::new(images, dimensions));
        let has_depth = format.base().has_depth();
        let base = match params.depth_mode {
            _ if !has_depth => format.base(),
            gl::INTENSITY => BaseFormat::Intensity,
            gl::ALPHA => BaseFormat::Alpha,
            _ => BaseFormat::Luminance,
        };
        let border = params.border_color;
        Some(Self {
            target,
            params: *params,
            levels: images.collect::<Option<Vec<_>>>()?,
            base,
            border_color: if has_depth { border } else { format.base().stored(border, 1.0) },
            has_depth,
            srgb: format.is_srgb(),
            seamless,
            lod_bias: (params.lod_bias + env_lod_bias).clamp(-MAX_LOD_BIAS, MAX_LOD_BIAS),
        })
    }

    pub(crate) fn dimensions(&self) -> usize {
        dimensions_of(self.target)
    }

    /// Whether the level of detail decides anything.
    pub(crate) fn needs_lod(&self) -> bool {
        self.params.uses_mipmaps() || self.params.min_filter != self.params.mag_filter
    }

    /// Level of detail from the changes of coordinates per pixel in x and in y, up to three of them.
    #[inline]
    pub(crate) fn lod<const N: usize>(&self, derivatives: [[f32; N]; 2]) -> f32 {
        let size = self.levels[0].size;
        let [x, y] = derivatives.map(|d| {
            let texels = |k: usize| d[k] * size[k] as f32;
            (0..N.min(self.dimensions())).map(|k| texels(k) * texels(k)).sum::<f32>()
        });
        let lod = 0.5 * log2(x.max(y)) + self.lod_bias;
        lod.max(self.params.min_lod).min(self.params.max_lod)
    }

    /// Levels of detail up to this one magnify.
    pub(crate) fn magnified_up_to(&self) -> f32 {
        let sharp = matches!(self.params.min_filter, gl::NEAREST_MIPMAP_NEAREST | gl::NEAREST_MIPMAP_LINEAR);
        if self.params.mag_filter == gl::LINEAR && sharp { 0.5 } else { 0.0 }
    }

    /// Whether texels are mixed within a level, the level (or the finer of two), and the share of the
    /// level after it.
    pub(crate) fn levels_at(&self, lod: f32) -> (bool, usize, f32) {
        let last = self.levels.len() - 1;
        if lod.is_nan() || lod <= self.magnified_up_to() {
            return (self.params.mag_filter == gl::LINEAR, 0, 0.0);
        }
        let filter = self.params.min_filter;
        let linear = matches!(filter, gl::LINEAR | gl::LINEAR_MIPMAP_NEAREST | gl::LINEAR_MIPMAP_LINEAR);
        match filter {
            gl::NEAREST | gl::LINEAR => (linear, 0, 0.0),
            gl::NEAREST_MIPMAP_NEAREST | gl::LINEAR_MIPMAP_NEAREST => {
                let level = if lod <= 0.5 { 0.0 } else { (lod + 0.5).ceil() - 1.0 };
                (linear, (level as usize).min(last), 0.0)
            }
            _ => {
                let fine = lod.floor();
                let level = fine as usize;
                if level >= last { (linear, last, 0.0) } else { (linear, level, lod - fine) }
            }
        }
    }

    /// The texture at coordinates s, t, r (already divided by q), as environments take it.
    pub(crate) fn sample(&self, coords: [f32; 3], reference: f32, lod: f32) -> [f32; 4] {
        let (linear, level, share) = self.levels_at(lod);
        let (face, coords) = match self.target {
            TexTarget::Cube => cube_face(coords),
            _ => (0, coords),
        };
        let mut value = self.read(level, face, coords, reference, linear);
        if share > 0.0 {
            let coarse = self.read(level + 1, face, coords, reference, linear);
            value = std::array::from_fn(|k| value[k] + (coarse[k] - value[k]) * share);
        }
        self.as_taken(value)
    }

    /// A value that has been read, in four components: a depth is in the first till now.
    pub(crate) fn as_taken(&self, v: [f32; 4]) -> [f32; 4] {
        match self.params.depth_mode {
            _ if !self.has_depth => v,
            gl::INTENSITY => [v[0]; 4],
            gl::ALPHA => [0.0, 0.0, 0.0, v[0]],
            _ => [v[0], v[0], v[0], 1.0],
        }
    }

    fn read(&self, level: usize, face: usize, coords: [f32; 3], reference: f32, linear: bool) -> [f32; 4] {
        let level = &self.levels[level.min(self.levels.len() - 1)];
        let places: [Place; 3] = std::array::from_fn(|k| {
            if k < self.dimensions() {
                let wrap = if self.target == TexTarget::Cube && self.seamless {
                    gl::CLAMP_TO_BORDER
                } else {
                    self.params.wrap[k]
                };
                Place::new(wrap, coords[k], level.size[k], linear)
            } else {
                Place { low: 0, high: 0, share: 0.0 }
            }
        });
        if !linear {
            return self.texel(level, face, places.map(|p| p.low), reference);
        }
        let corner = |n: usize| {
            let at = std::array::from_fn(|k| if n >> k & 1 == 1 { places[k].high } else { places[k].low });
            self.texel(level, face, at, reference)
        };
        let mix = |a: [f32; 4], b: [f32; 4], share: f32| -> [f32; 4] {
            std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
        };
        let [s, t, r] = [places[0].share, places[1].share, places[2].share];
        match self.dimensions() {
            1 => mix(corner(0), corner(1), s),
            2 => mix(mix(corner(0), corner(1), s), mix(corner(2), corner(3), s), t),
            _ => {
                let near = mix(mix(corner(0), corner(1), s), mix(corner(2), corner(3), s), t);
                let far = mix(mix(corner(4), corner(5), s), mix(corner(6), corner(7), s), t);
                mix(near, far, r)
            }
        }
    }

    /// A texel; outside, the border. A depth is compared to the reference if that is on.
    fn texel(&self, level: &Level, face: usize, at: [i32; 3], reference: f32) -> [f32; 4] {
        let value = match level.index(at, self.dimensions()) {
            Some(index) => self.stored(level, face, index),
            None if self.target == TexTarget::Cube && self.seamless => {
                let (face, [i, j]) = across_edge(face, [at[0], at[1]], level.size[0]);
                level.index([i, j, 0], 2).map_or([0.0; 4], |index| self.stored(level, face, index))
            }
            None => self.border_color,
        };
        if self.has_depth && self.params.compare_mode == gl::COMPARE_R_TO_TEXTURE {
            let passes = compares(self.params.compare_func, reference.clamp(0.0, 1.0), value[0]);
            return [f32::from(u8::from(passes)), 0.0, 0.0, 0.0];
        }
        value
    }

    fn stored(&self, level: &Level, face: usize, index: usize) -> [f32; 4] {
        let Some(texels) = level.texels.get(face).filter(|t| index < t.len()) else { return [0.0; 4] };
        match &**texels {
            Texels::Rgba8(colors) if self.srgb => {
                let [r, g, b, a] = colors[index];
                let linear = |v: u8| LINEAR[usize::from(v)];
                [linear(r), linear(g), linear(b), f32::from(a) / 255.0]
            }
            texels => texels.color(index),
        }
    }
}

fn dimensions_of(target: TexTarget) -> usize {
    match target {
        TexTarget::One => 1,
        TexTarget::Two | TexTarget::Cube => 2,
        TexTarget::Three => 3,
    }
}

/// Texels along one axis: the nearest, or two and the share of the second.
struct Place {
    low: i32,
    high: i32,
    share: f32,
}

impl Place {
    fn new(wrap: Enum, s: f32, n: i32, linear: bool) -> Self {
        let size = n as f32;
        let u = match wrap {
            gl::CLAMP => s.clamp(0.0, 1.0) * size,
            gl::CLAMP_TO_EDGE => (s * size).clamp(0.5, size - 0.5),
            gl::CLAMP_TO_BORDER => (s * size).clamp(-0.5, size + 0.5),
            gl::MIRRORED_REPEAT => (mirrored(s) * size).clamp(0.5, size - 0.5),
            _ => (s - s.floor()) * size,
        };
        let around = |i: i32| if wrap == gl::REPEAT { i.rem_euclid(n) } else { i };
        if !linear {
            let i = u.floor() as i32;
            let low = if wrap == gl::CLAMP_TO_BORDER { i } else { around(i.min(n - 1)) };
            return Self { low, high: low, share: 0.0 };
        }
        let floor = (u - 0.5).floor();
        let i = floor as i32;
        Self { low: around(i), high: around(i.saturating_add(1)), share: u - 0.5 - floor }
    }
}

fn mirrored(s: f32) -> f32 {
    let within = s - 2.0 * (s * 0.5).floor();
    if within > 1.0 { 2.0 - within } else { within }
}

fn cube_face(direction: [f32; 3]) -> (usize, [f32; 3]) {
    let face = face_of(direction);
    let [s, t] = on_face(face, direction);
    (face, [s, t, 0.0])
}
