//! Textures and how they are read: the plain, one-sample-at-a-time form.
//!
//! Source: course text, section 2.11, variants a (nearest), b (bilinear), c (average over the
//! footprint), d (square footprint) and e (mipmaps); Williams 1983 for the last.
//!
//! Coordinates u, v run from 0 to 1 over the picture, v = 0 at row 0. Where texels lie between is
//! [`TexelGrid`].

use senca_math::Image;

/// Longest side of a texture, in texels.
pub const MAX_TEXTURE_SIDE: u32 = 1 << 15;

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
    /// 32-bit floating point.
    Rgba32F(Vec<[f32; 4]>),
}

impl Texels {
    fn len(&self) -> usize {
        match self {
            Self::Rgba8(t) => t.len(),
            Self::Rgba32F(t) => t.len(),
        }
    }

    fn get(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Rgba8(t) => t[i].map(|v| f32::from(v) * (1.0 / 255.0)),
            Self::Rgba32F(t) => t[i],
        }
    }
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
            Texels::Rgba8(_) => {
                Texels::Rgba8((0..n).map(|i| crate::target::rgba8_from_rgba(texel(i))).collect())
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
