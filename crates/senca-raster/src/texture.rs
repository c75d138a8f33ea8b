//! Textures and how they are read: the plain, one-sample-at-a-time form.
//!
//! Source: course text, section 2.11, variants a (nearest), b (bilinear), c (average over the
//! footprint), d (square footprint) and e (mipmaps); Williams 1983 for the last.
//!
//! Coordinates u, v run from 0 to 1 over the picture, v = 0 at row 0. Where texels lie between is
//! [`TexelGrid`].

use senca_math::{Image, SrgbTable};
use std::sync::Arc;

/// Longest side of a texture, in texels.
pub const MAX_TEXTURE_SIDE: u32 = 1 << 15;

/// Coordinates, in texels, are held within this of 0, so that texel numbers fit 32 bits.
pub(crate) const FARTHEST_TEXEL: f32 = 1e9;

/// Why texels do not make a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    /// A side is 0 or longer than [`MAX_TEXTURE_SIDE`].
    #[error("a texture of {width} x {height} texels: a side must have 1 to {MAX_TEXTURE_SIDE}")]
    Side {
        /// Width given.
        width: u32,
        /// Height given.
        height: u32,
    },
    /// The number of texels is not width times height.
    #[error("{found} texels given for a texture of {expected}")]
    Count {
        /// Width times height.
        expected: usize,
        /// Texels given.
        found: usize,
    },
    /// A level is not half its predecessor, rounded down, at least 1; or its format differs.
    #[error("level {level} does not follow from the level above it")]
    Level {
        /// Number of the level, 0 the largest.
        level: usize,
    },
}

/// Texels of one level.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel, 255 standing for 1. Taken as it is: decode sRGB beforehand to sample light.
    Rgba8(Vec<[u8; 4]>),
    /// Colour of 8 bits a channel in sRGB, read as light; alpha is 255 for 1. Filters mix light.
    Srgb8(Vec<[u8; 4]>),
    /// 32-bit floating point.
    Rgba32F(Vec<[f32; 4]>),
    /// As [`Texels::Rgba8`], in memory of somebody else's.
    Shared(SharedTexels),
}

/// Texels of 8 bits a channel in memory that others hold, too. What it gives must always be the same.
#[derive(Clone)]
pub struct SharedTexels(pub Arc<dyn AsRef<[[u8; 4]]> + Send + Sync>);

impl std::fmt::Debug for SharedTexels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SharedTexels({})", self.get().len())
    }
}

impl PartialEq for SharedTexels {
    fn eq(&self, other: &Self) -> bool {
        self.get() == other.get()
    }
}

impl SharedTexels {
    pub(crate) fn get(&self) -> &[[u8; 4]] {
        (*self.0).as_ref()
    }
}

impl Texels {
    /// Texels of 8 bits taken as they are.
    #[inline(always)]
    pub(crate) fn rgba8(&self) -> Option<&[[u8; 4]]> {
        match self {
            Self::Rgba8(texels) => Some(texels),
            Self::Shared(shared) => Some(shared.get()),
            Self::Srgb8(_) | Self::Rgba32F(_) => None,
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Shared(t) => t.get().len(),
            Self::Rgba8(t) | Self::Srgb8(t) => t.len(),
            Self::Rgba32F(t) => t.len(),
        }
    }

    fn get(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Rgba8(t) => t[i].map(|v| f32::from(v) * (1.0 / 255.0)),
            Self::Shared(t) => t.get()[i].map(|v| f32::from(v) * (1.0 / 255.0)),
            Self::Srgb8(t) => light_of(SrgbTable::get(), t[i]),
            Self::Rgba32F(t) => t[i],
        }
    }
}

/// A texel of [`Texels::Srgb8`].
#[inline]
pub(crate) fn light_of(table: &SrgbTable, [r, g, b, a]: [u8; 4]) -> [f32; 4] {
    [table.decode(r), table.decode(g), table.decode(b), f32::from(a) * (1.0 / 255.0)]
}

/// The nearest texel of [`Texels::Srgb8`].
fn srgb8_of(table: &SrgbTable, [r, g, b, a]: [f32; 4]) -> [u8; 4] {
    let alpha = crate::target::rgba8_from_rgba([a; 4])[3];
    [table.encode(r), table.encode(g), table.encode(b), alpha]
}

/// One level of a [`Texture`].
#[derive(Clone, Debug, PartialEq)]
pub struct TextureLevel {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) texels: Texels,
}

impl TextureLevel {
    /// A level from its texels, row 0 first.
    ///
    /// # Errors
    /// [`TextureError::Side`], [`TextureError::Count`].
    pub fn new(width: u32, height: u32, texels: Texels) -> Result<Self, TextureError> {
        if width == 0 || height == 0 || width.max(height) > MAX_TEXTURE_SIDE {
            return Err(TextureError::Side { width, height });
        }
        let (expected, found) = (width as usize * height as usize, texels.len());
        if expected != found {
            return Err(TextureError::Count { expected, found });
        }
        Ok(Self { width, height, texels })
    }

    /// Width in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Texel in column `x`, row `y`: red, green, blue, alpha.
    ///
    /// # Panics
    /// When the position is outside.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        assert!(x < self.width, "column {x} of a texture {} wide", self.width);
        self.texels.get(y as usize * self.width as usize + x as usize)
    }

    /// The next smaller level: each side halved, rounded down, at least 1; each texel the mean of the
    /// area it covers.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let (columns, rows) = (taps(self.width, width), taps(self.height, height));
        let texel = |i: usize| self.mean(&columns[i % width as usize], &rows[i / width as usize]);
        let n = width as usize * height as usize;
        let texels = match &self.texels {
            Texels::Rgba8(_) | Texels::Shared(_) => {
                Texels::Rgba8((0..n).map(|i| crate::target::rgba8_from_rgba(texel(i))).collect())
            }
            Texels::Srgb8(_) => {
                let table = SrgbTable::get();
                Texels::Srgb8((0..n).map(|i| srgb8_of(table, texel(i))).collect())
            }
            Texels::Rgba32F(_) => Texels::Rgba32F((0..n).map(texel).collect()),
        };
        Self { width, height, texels }
    }

    fn mean(&self, columns: &[(u32, f32)], rows: &[(u32, f32)]) -> [f32; 4] {
        let mut sum = [0.0; 4];
        for &(y, wy) in rows {
            for &(x, wx) in columns {
                sum = add_scaled(sum, self.texel(x, y), wx * wy);
            }
        }
        sum
    }
}

/// Per texel of the smaller side, which texels of the larger it covers, with weights of sum 1.
fn taps(large: u32, small: u32) -> Vec<Vec<(u32, f32)>> {
    let ratio = f64::from(large) / f64::from(small);
    let tap = |i: u32| {
        let (from, to) = (f64::from(i) * ratio, f64::from(i + 1) * ratio);
        let last = (to.ceil() as u32).min(large);
        let overlap = |x: u32| (to.min(f64::from(x + 1)) - from.max(f64::from(x))) / ratio;
        (from as u32..last).map(|x| (x, overlap(x) as f32)).filter(|t| t.1 > 0.0).collect()
    };
    (0..small).map(tap).collect()
}

fn add_scaled(a: [f32; 4], b: [f32; 4], s: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + b[k] * s)
}

/// A picture to be laid on surfaces, with or without smaller levels of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    pub(crate) levels: Vec<TextureLevel>,
}

impl Texture {
    /// A texture of one level.
    ///
    /// # Errors
    /// [`TextureError::Side`], [`TextureError::Count`].
    pub fn new(width: u32, height: u32, texels: Texels) -> Result<Self, TextureError> {
        Ok(Self { levels: vec![TextureLevel::new(width, height, texels)?] })
    }

    /// A texture from a picture; its top row is row 0, v = 0.
    ///
    /// # Errors
    /// [`TextureError::Side`].
    pub fn of_image(image: &Image) -> Result<Self, TextureError> {
        Self::new(image.width(), image.height(), Texels::Rgba32F(image.pixels().to_vec()))
    }

    /// A texture from levels made elsewhere, the largest first. The chain may stop early.
    ///
    /// # Errors
    /// [`TextureError::Level`]; [`TextureError::Count`] when there is none.
    pub fn from_levels(levels: Vec<TextureLevel>) -> Result<Self, TextureError> {
        if levels.is_empty() {
            return Err(TextureError::Count { expected: 1, found: 0 });
        }
        for (i, pair) in levels.windows(2).enumerate() {
            let half = |n: u32| (n / 2).max(1);
            let fits = pair[1].width == half(pair[0].width) && pair[1].height == half(pair[0].height);
            let alike = std::mem::discriminant(&pair[0].texels) == std::mem::discriminant(&pair[1].texels);
            if !fits || !alike {
                return Err(TextureError::Level { level: i + 1 });
            }
        }
        Ok(Self { levels })
    }

    /// This texture with levels down to 1 x 1, each the mean of the one above.
    #[must_use]
    pub fn with_mipmaps(mut self) -> Self {
        self.levels.truncate(1);
        while let Some(last) = self.levels.last().filter(|l| l.width.max(l.height) > 1) {
            let next = last.halved();
            self.levels.push(next);
        }
        self
    }

    /// All levels, the largest first.
    #[must_use]
    pub fn levels(&self) -> &[TextureLevel] {
        &self.levels
    }

    /// Width of level 0 in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.levels[0].width
    }

    /// Height of level 0 in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.levels[0].height
    }
}

/// What coordinates outside [0, 1] mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The picture repeats.
    #[default]
    Repeat,
    /// The picture repeats, every second time mirrored.
    Mirror,
    /// The outermost texels continue.
    Clamp,
}

impl Wrap {
    /// Texel `i` brought into `0..n`.
    #[must_use]
    pub fn apply(self, i: i64, n: u32) -> u32 {
        let n = i64::from(n);
        (match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => {
                let j = i.rem_euclid(2 * n);
                if j < n { j } else { 2 * n - 1 - j }
            }
            Self::Clamp => i.clamp(0, n - 1),
        }) as u32
    }
}

/// Where texel centres lie among the coordinates 0 to 1 of N texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelGrid {
    /// Texel `i` fills `i/N` to `(i + 1)/N`: its centre is where `u N - 0.5 = i`. The usual one.
    #[default]
    Areas,
    /// Texel 0 is at u = 0, texel N - 1 at u = 1: `u (N - 1) = i` (course text, equation 2.30).
    Points,
}

impl TexelGrid {
    /// Position among the texel centres, 0 at the first.
    #[must_use]
    pub fn position(self, u: f32, n: u32) -> f32 {
        match self {
            Self::Areas => u * n as f32 - 0.5,
            Self::Points => u * (n - 1) as f32,
        }
    }
}

/// How a value between texels is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Weighted mean of the four around.
    #[default]
    Linear,
}

/// Which levels are read when texels are smaller than pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mip {
    /// Level 0 only.
    None,
    /// The level whose texels are nearest in size to the pixel.
    Nearest,
    /// The two levels around, blended.
    #[default]
    Linear,
}

/// How a texture is read. The default is trilinear, repeating.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sampler {
    /// Outside [0, 1] in u.
    pub wrap_u: Wrap,
    /// Outside [0, 1] in v.
    pub wrap_v: Wrap,
    /// Where texels are larger than pixels. Default: linear.
    pub magnify: Filter,
    /// Where texels are smaller than pixels. Default: linear.
    pub minify: Filter,
    /// Levels used where texels are smaller. Default: linear. A texture of one level has only that.
    pub mip: Mip,
    /// Where texel centres lie. Default: [`TexelGrid::Areas`].
    pub grid: TexelGrid,
    /// Added to the level of detail, in levels; positive blurs. Default: 0.
    pub lod_bias: f32,
}

impl Sampler {
    /// The nearest texel of level 0 (variant a).
    pub const NEAREST: Self = Self::of(Filter::Nearest, Mip::None);
    /// Bilinear in level 0 (variant b).
    pub const BILINEAR: Self = Self::of(Filter::Linear, Mip::None);
    /// Bilinear in two levels, blended (variant e).
    pub const TRILINEAR: Self = Self::of(Filter::Linear, Mip::Linear);

    const fn of(filter: Filter, mip: Mip) -> Self {
        Self {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            magnify: filter,
            minify: filter,
            mip,
            grid: TexelGrid::Areas,
            lod_bias: 0.0,
        }
    }

    /// The same with both coordinates wrapped as told.
    #[must_use]
    pub const fn wrapped(self, wrap: Wrap) -> Self {
        Self { wrap_u: wrap, wrap_v: wrap, ..self }
    }
}

impl Sampler {
    /// Colour at `uv`, where `derivatives` are `[[ux, vx], [uy, vy]]`, the change per pixel to the
    /// right and downwards.
    #[must_use]
    pub fn sample(&self, texture: &Texture, uv: [f32; 2], derivatives: [[f32; 2]; 2]) -> [f32; 4] {
        self.sample_lod(texture, uv, self.lod(texture, derivatives))
    }

    /// Level of detail, with the bias: the base-2 logarithm of how many texels of level 0 a pixel
    /// spans along its longer side. At most the number of the last level.
    #[must_use]
    pub fn lod(&self, texture: &Texture, derivatives: [[f32; 2]; 2]) -> f32 {
        let (w, h) = (texture.width() as f32, texture.height() as f32);
        let square = |[du, dv]: [f32; 2]| (du * w) * (du * w) + (dv * h) * (dv * h);
        let (x, y) = (square(derivatives[0]), square(derivatives[1]));
        0.5 * log2(if x > y { x } else { y }) + self.lod_bias
    }

    /// Colour at `uv` with the level of detail given.
    #[must_use]
    pub fn sample_lod(&self, texture: &Texture, uv: [f32; 2], lod: f32) -> [f32; 4] {
        if lod <= 0.0 || lod.is_nan() {
            return self.read(&texture.levels[0], uv, self.magnify);
        }
        let last = texture.levels.len() - 1;
        let (level, share) = self.levels_at(lod, texture.levels.len());
        let fine = self.read(&texture.levels[level], uv, self.minify);
        if self.mip != Mip::Linear {
            return fine;
        }
        lerp(fine, self.read(&texture.levels[(level + 1).min(last)], uv, self.minify), share)
    }

    /// The level, or the finer of two, of `count`, and the share of the one after it.
    pub(crate) fn levels_at(&self, lod: f32, count: usize) -> (usize, f32) {
        if lod <= 0.0 || lod.is_nan() {
            return (0, 0.0);
        }
        let lod = lod.min((count - 1) as f32);
        match self.mip {
            Mip::None => (0, 0.0),
            Mip::Nearest => (((lod + 0.5) as usize).min(count - 1), 0.0),
            Mip::Linear => (lod as usize, lod - (lod as usize) as f32),
        }
    }

    /// Colour at `uv` of one level.
    #[must_use]
    pub fn read(&self, level: &TextureLevel, [u, v]: [f32; 2], filter: Filter) -> [f32; 4] {
        let (x, y) = (self.position(u, level.width), self.position(v, level.height));
        match filter {
            Filter::Nearest => self.texel(level, whole(x + 0.5), whole(y + 0.5)),
            Filter::Linear => self.bilinear(level, x, y),
        }
    }

    fn position(&self, u: f32, n: u32) -> f32 {
        let p = self.grid.position(u, n);
        if p.is_nan() { 0.0 } else { p.clamp(-FARTHEST_TEXEL, FARTHEST_TEXEL) }
    }

    fn texel(&self, level: &TextureLevel, x: i64, y: i64) -> [f32; 4] {
        level.texel(self.wrap_u.apply(x, level.width), self.wrap_v.apply(y, level.height))
    }

    fn bilinear(&self, level: &TextureLevel, x: f32, y: f32) -> [f32; 4] {
        let (i, j) = (whole(x), whole(y));
        let (s, t) = (x - x.floor(), y - y.floor());
        let upper = lerp(self.texel(level, i, j), self.texel(level, i + 1, j), s);
        let lower = lerp(self.texel(level, i, j + 1), self.texel(level, i + 1, j + 1), s);
        lerp(upper, lower, t)
    }

    /// Mean over a convex quadrilateral in texture space, the footprint of a pixel, whose corners are
    /// `uv` in order around (variant c): the texels whose centres lie inside, or the bilinear value
    /// at its middle when there is none. Level 0. At most `limit` texels are read; a larger footprint
    /// is sampled on a coarser raster.
    #[must_use]
    pub fn footprint_mean(&self, texture: &Texture, uv: [[f32; 2]; 4], limit: u32) -> [f32; 4] {
        let level = &texture.levels[0];
        let corners = uv.map(|[u, v]| [self.position(u, level.width), self.position(v, level.height)]);
        let middle = [mean4(corners.map(|c| c[0])), mean4(corners.map(|c| c[1]))];
        let range = |k: usize| {
            let of = |f: fn(f32, f32) -> f32, start| corners.iter().map(|c| c[k]).fold(start, f);
            (of(f32::min, f32::INFINITY).ceil(), of(f32::max, f32::NEG_INFINITY).floor())
        };
        let ((x0, x1), (y0, y1)) = (range(0), range(1));
        let count = (x1 - x0 + 1.0).max(0.0) * (y1 - y0 + 1.0).max(0.0);
        let step = (count / limit.max(1) as f32).sqrt().ceil().max(1.0);
        let (mut sum, mut inside) = ([0.0; 4], 0u32);
        let mut y = y0;
        while y <= y1 && step.is_finite() {
            let mut x = x0;
            while x <= x1 {
                if in_convex(&corners, [x, y]) {
                    sum = add_scaled(sum, self.texel(level, whole(x), whole(y)), 1.0);
                    inside += 1;
                }
                x += step;
            }
            y += step;
        }
        match inside {
            0 => self.bilinear(level, middle[0], middle[1]),
            n => sum.map(|v| v / n as f32),
        }
    }

    /// Mean over the square about `uv` whose side is that of a pixel in texture space (variant d):
    /// the longer of the two derivatives, in texels.
    #[must_use]
    pub fn square_mean(
        &self,
        texture: &Texture,
        [u, v]: [f32; 2],
        derivatives: [[f32; 2]; 2],
        limit: u32,
    ) -> [f32; 4] {
        let (w, h) = (texture.width() as f32, texture.height() as f32);
        let side = |[du, dv]: [f32; 2]| (du * w).hypot(dv * h);
        let half = 0.5 * side(derivatives[0]).max(side(derivatives[1]));
        let (du, dv) = (half / w, half / h);
        let corners = [[u - du, v - dv], [u + du, v - dv], [u + du, v + dv], [u - du, v + dv]];
        self.footprint_mean(texture, corners, limit)
    }
}

fn lerp(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

fn mean4(v: [f32; 4]) -> f32 {
    0.25 * (v[0] + v[1] + v[2] + v[3])
}

/// The integer at or below.
fn whole(x: f32) -> i64 {
    x.floor() as i64
}

/// Whether `p` is inside or on the rim of the convex polygon, whichever way round it runs.
fn in_convex(corners: &[[f32; 2]; 4], p: [f32; 2]) -> bool {
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let sides = [side(0), side(1), side(2), side(3)];
    sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
}

/// Base-2 logarithm of a positive number, to 2e-5; large and negative for 0. Made of exact
/// steps only, so every machine gets the same bits.
#[inline]
#[must_use]
pub fn log2(v: f32) -> f32 {
    let bits = v.to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let m = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000) - 1.0;
    exponent as f32 + log2_mantissa(m)
}

/// Base-2 logarithm of `1 + m`, 0 <= m < 1: minimax polynomial of degree 5 through both ends.
fn log2_mantissa(m: f32) -> f32 {
    let p = LOG2[4];
    let p = p * m + LOG2[3];
    let p = p * m + LOG2[2];
    let p = p * m + LOG2[1];
    let p = p * m + LOG2[0];
    p * m
}

/// Coefficients of m to m^5; they sum to 1, so that the pieces join at powers of two.
pub(crate) const LOG2: [f32; 5] = [1.441_917, -0.709_096_4, 0.415_605_8, -0.193_575_42, 0.045_148_94];
