//! What goes into a rasterizer and what comes out: primitives, state, shading, counters.

use crate::cube::CubeUnit;
use crate::shadow::ShadowUnit;
use crate::stage::FragmentStage;
use crate::target::{Clear, Target};
use crate::texture::{Sampler, Texture};
use fearless_simd::Level;
use senca_math::glam::Vec4;

/// Largest number of varyings a vertex may carry: two colours, a fog coordinate and eight places in textures.
pub const MAX_VARYINGS: usize = 40;

/// Fragments handed to a [`FragmentShader`] at once: 2 rows of 8 pixels.
pub const LANES: usize = 16;

/// Vertices and how they join into triangles, lines or points.
///
/// A primitive with an index beyond the vertices, or beyond the varyings given, is left out and
/// counted in [`Counters::invalid`].
#[derive(Clone, Copy, Debug)]
pub struct Primitives<'a> {
    /// Clip-space positions: x and y in [-w, w] (y up), z in [0, w] with 0 near. Of any size: what
    /// leaves the volume is clipped. Primitives with a NaN or infinite corner are left out.
    pub positions: &'a [Vec4],
    /// Values to interpolate, vertex after vertex, `stride` of each.
    pub varyings: &'a [f32],
    /// Varyings per vertex, 0 to [`MAX_VARYINGS`].
    pub stride: usize,
    /// Three vertex numbers per triangle, two per line, one per point.
    pub indices: &'a [u32],
    /// Identifiers written to an identifier target and given to shaders.
    pub ids: Ids<'a>,
}

/// Identifiers of primitives.
#[derive(Clone, Copy, Debug)]
pub enum Ids<'a> {
    /// Primitive `n` has identifier `first + n`, wrapping.
    From(u32),
    /// Primitive `n` has identifier `ids[n]`, and [`senca_math::conventions::NO_ID`] beyond the end.
    Each(&'a [u32]),
    /// All primitives share one.
    Same(u32),
}

impl Ids<'_> {
    /// Identifier of primitive `n`.
    #[must_use]
    pub fn of(&self, n: usize) -> u32 {
        match *self {
            Self::From(first) => first.wrapping_add(n as u32),
            Self::Each(ids) => ids.get(n).copied().unwrap_or(senca_math::conventions::NO_ID),
            Self::Same(id) => id,
        }
    }
}

/// Everything about a draw that is not geometry or shading. The default draws the whole target,
/// both faces, nearer wins, opaque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Where the view volume lands in the target. Default: the whole target.
    pub viewport: Option<Viewport>,
    /// Pixels outside are left alone (a [`State::clear`] heeds it too). Default: none.
    pub scissor: Option<Rect>,
    /// Faces left out. A face is front when its corners run counter-clockwise on screen.
    /// Default: [`Cull::None`].
    pub cull: Cull,
    /// Which fragments pass against the depth target. Default: [`Compare::Less`], so of equal depths
    /// the first drawn stays. Without a depth target all pass.
    pub depth_test: Compare,
    /// Whether passing fragments write depth. Default: yes.
    pub depth_write: bool,
    /// Window depth of the near and of the far plane, each in [0, 1]. Default: 0 and 1.
    pub depth_range: [f32; 2],
    /// Added to the depth of triangles. Default: nothing.
    pub depth_bias: DepthBias,
    /// The stencil test, before that of depth and before anything is coloured. Stages do not heed it, they do
    /// their own. Without a stencil target all pass. Default: none.
    pub stencil: Option<StencilTest>,
    /// How varyings run between the corners. Default: [`Interpolation::Perspective`].
    pub interpolation: Interpolation,
    /// How colours meet those already there. Default: `None`, they replace them.
    pub blend: Option<Blend>,
    /// Clears the target (inside the scissor) before the first primitive; cheaper than a separate
    /// [`Target::clear`]. Default: no clearing.
    pub clear: Option<Clear>,
    /// Pixels that [`Self::clear`] clears, of those inside the scissor. Default: all.
    pub clear_area: Option<Rect>,
    /// Width of lines in pixels, at least 1. Default: 1.
    pub line_width: f32,
    /// Side of points in pixels, at least 1. Default: 1.
    pub point_size: f32,
    /// Number of the varying that is the size of points instead. Default: none.
    pub point_sizes: Option<usize>,
    /// Which pixels belong to lines and points. Default: [`StrokeRule::Centres`].
    pub strokes: StrokeRule,
    /// Pattern lines are broken up by. Default: none.
    pub stipple: Option<LineStipple>,
    /// Whether squares of 2 x 2 pixels of the target are the samples of one pixel: a [`Shading::Stage`],
    /// and a [`Shading::Fixed`] that is more than one colour on triangles, then colour once
    /// per such pixel, at its centre, and merge sample by sample. Viewport, scissor and sizes are those of the
    /// target all the same, and so are footprints in textures. The target's sides must be even. Other
    /// shadings colour every sample. Default: no.
    pub multisample: bool,
    /// Whether alpha is multiplied by the share of the pixel that a primitive covers, and all pixels it
    /// touches are drawn: lines as rectangles, points as discs, of any size. Stages find the share in
    /// [`Fragments::coverage`] and multiply by it themselves. Default: no.
    pub antialias: bool,
}

/// Which pixels belong to lines and points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StrokeRule {
    /// Those whose centres are passed: lines from the centre at or after the start up to the one at the
    /// end; points as the squares about them.
    #[default]
    Centres,
    /// The rules of the OpenGL specification, sections 3.3 and 3.4: lines own the pixels whose diamonds
    /// they leave.
    OpenGl,
}

/// A pattern of drawn and left out fragments along lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineStipple {
    /// How often each bit is used before the next one; 0 counts as 1.
    pub factor: u32,
    /// Bits of drawn fragments, the lowest first.
    pub pattern: u16,
    /// When the pattern runs on from the line before, instead of beginning anew.
    pub joins: StippleJoins,
}

/// Which lines go on with the pattern of the line before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StippleJoins {
    /// Those that begin with the index that one ended with.
    #[default]
    ByIndex,
    /// Those whose identifier is odd.
    ByOddId,
}

impl Default for State {
    fn default() -> Self {
        Self {
            viewport: None,
            scissor: None,
            cull: Cull::None,
            depth_test: Compare::Less,
            depth_write: true,
            depth_range: [senca_math::conventions::DEPTH_NEAR, senca_math::conventions::DEPTH_FAR],
            depth_bias: DepthBias::default(),
            stencil: None,
            interpolation: Interpolation::Perspective,
            blend: None,
            clear: None,
            clear_area: None,
            line_width: 1.0,
            point_size: 1.0,
            point_sizes: None,
            strokes: StrokeRule::Centres,
            stipple: None,
            multisample: false,
            antialias: false,
        }
    }
}

/// The rectangle of the target, in pixels, on which x and y in [-w, w] are mapped. y = w lands on
/// `y`, the upper side. Pixels whose centre lies outside are not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// Left side.
    pub x: f32,
    /// Upper side.
    pub y: f32,
    /// Width, positive.
    pub width: f32,
    /// Height, positive.
    pub height: f32,
}

/// A rectangle of pixels; it may reach beyond the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub x: i32,
    /// First row.
    pub y: i32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Faces to leave out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cull {
    /// None.
    #[default]
    None,
    /// Faces seen with clockwise corners.
    Back,
    /// Faces seen with counter-clockwise corners.
    Front,
}

/// When a new depth passes against the stored one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compare {
    /// Never.
    Never,
    /// Nearer.
    #[default]
    Less,
    /// The same.
    Equal,
    /// Nearer or the same.
    LessEqual,
    /// Farther.
    Greater,
    /// Different.
    NotEqual,
    /// Farther or the same.
    GreaterEqual,
    /// Always.
    Always,
}

impl Compare {
    /// Whether `new` passes against `stored`.
    #[must_use]
    pub fn passes(self, new: f32, stored: f32) -> bool {
        match self {
            Self::Never => false,
            Self::Less => new < stored,
            Self::Equal => new == stored,
            Self::LessEqual => new <= stored,
            Self::Greater => new > stored,
            Self::NotEqual => new != stored,
            Self::GreaterEqual => new >= stored,
            Self::Always => true,
        }
    }
}

/// A test of stencil values, and what it does to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StencilTest {
    /// How the reference must compare to the stored value, both masked.
    pub compare: Compare,
    /// What is compared, and what [`StencilOp::Replace`] writes.
    pub reference: u8,
    /// Bits that are compared.
    pub value_mask: u8,
    /// Bits that are written.
    pub write_mask: u8,
    /// For fragments that fail.
    pub fail: StencilOp,
    /// For those that pass, but then fail the depth test.
    pub depth_fail: StencilOp,
    /// For those that pass both.
    pub pass: StencilOp,
}

/// What becomes of a stencil value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StencilOp {
    /// It stays.
    #[default]
    Keep,
    /// 0.
    Zero,
    /// The reference.
    Replace,
    /// One more, up to 255.
    Increment,
    /// One less, down to 0.
    Decrement,
    /// One more, and 0 after 255.
    IncrementWrap,
    /// One less, and 255 after 0.
    DecrementWrap,
    /// All bits the other way round.
    Invert,
}

impl StencilTest {
    /// Whether a stored value passes.
    #[must_use]
    pub fn passes(&self, stored: u8) -> bool {
        let (a, b) = (self.reference & self.value_mask, stored & self.value_mask);
        self.compare.passes(f32::from(a), f32::from(b))
    }

    /// The value after an operation.
    #[must_use]
    pub fn after(&self, op: StencilOp, stored: u8) -> u8 {
        let value = match op {
            StencilOp::Keep => stored,
            StencilOp::Zero => 0,
            StencilOp::Replace => self.reference,
            StencilOp::Increment => stored.saturating_add(1),
            StencilOp::Decrement => stored.saturating_sub(1),
            StencilOp::IncrementWrap => stored.wrapping_add(1),
            StencilOp::DecrementWrap => stored.wrapping_sub(1),
            StencilOp::Invert => !stored,
        };
        stored & !self.write_mask | value & self.write_mask
    }

    /// Whether something becomes of fragments that fail.
    pub(crate) fn needs_failures(&self) -> bool {
        self.write_mask != 0 && (self.fail != StencilOp::Keep || self.depth_fail != StencilOp::Keep)
    }
}

/// An offset of the depth: `constant + slope * m`, where `m` is the larger of the depth's change
/// per pixel in x and in y. The result is clamped to [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthBias {
    /// In units of depth.
    pub constant: f32,
    /// Factor of the slope.
    pub slope: f32,
}

/// How varyings run between the corners of a primitive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Linear in space: right under perspective.
    #[default]
    Perspective,
    /// Linear in the image: the incremental shading of the books (course text, sections 2.9, 2.10).
    Screen,
    /// Those of the first corner.
    FlatFirst,
    /// Those of the last corner.
    FlatLast,
}

/// `source * source_factor + destination * destination_factor`, each component for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blend {
    /// Factor of the new colour.
    pub source: Factor,
    /// Factor of the colour already there.
    pub destination: Factor,
}

impl Blend {
    /// Source over destination, alpha not multiplied in.
    pub const OVER: Self = Self { source: Factor::SourceAlpha, destination: Factor::OneMinusSourceAlpha };
    /// Sum. In targets of 8 bits that of the bytes: the new colour is rounded first.
    pub const ADD: Self = Self { source: Factor::One, destination: Factor::One };
    /// Product.
    pub const MULTIPLY: Self = Self { source: Factor::DestinationColor, destination: Factor::Zero };
}

/// A factor of [`Blend`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factor {
    /// 0.
    Zero,
    /// 1.
    One,
    /// The new colour.
    SourceColor,
    /// 1 minus the new colour.
    OneMinusSourceColor,
    /// The colour already there.
    DestinationColor,
    /// 1 minus the colour already there.
    OneMinusDestinationColor,
    /// Alpha of the new colour.
    SourceAlpha,
    /// 1 minus alpha of the new colour.
    OneMinusSourceAlpha,
    /// Alpha already there.
    DestinationAlpha,
    /// 1 minus alpha already there.
    OneMinusDestinationAlpha,
    /// The smaller of source alpha and 1 minus destination alpha; 1 for the alpha component.
    SourceAlphaSaturate,
}

/// Where the colour of a fragment comes from.
#[derive(Clone, Copy)]
pub enum Shading<'a> {
    /// Nowhere: depth and identifiers only; a colour target keeps what it has.
    None,
    /// The usual kinds. Stay in vector registers from end to end.
    Fixed(FixedShading<'a>),
    /// Code of the caller's, once per batch of up to [`LANES`] fragments.
    Custom(&'a dyn FragmentShader),
    /// Code of the caller's that does all that happens to fragments and pixels. [`State::blend`] is not
    /// heeded, and [`State::depth_test`] only if the stage does not test depth.
    Stage(&'a dyn FragmentStage),
}

/// A colour, optionally times the light that a shadow map lets through and times a texture.
#[derive(Clone, Copy, Debug, Default)]
pub struct FixedShading<'a> {
    /// The colour. Default: opaque white.
    pub color: ColorSource,
    /// The texture it is multiplied by. Default: none.
    pub texture: Option<TextureUnit<'a>>,
    /// The cube of textures it is multiplied by, if there is no texture. Default: none.
    pub cube: Option<CubeUnit<'a>>,
    /// The shadow map whose light it is seen in. Default: none.
    pub shadow: Option<ShadowUnit<'a>>,
    /// The test that decides by alpha what is drawn at all. Default: none.
    pub alpha_test: Option<AlphaTest>,
}

impl<'a> FixedShading<'a> {
    /// A colour.
    #[must_use]
    pub const fn new(color: ColorSource) -> Self {
        Self { color, texture: None, cube: None, shadow: None, alpha_test: None }
    }

    /// A colour times a texture.
    #[must_use]
    pub const fn textured(color: ColorSource, texture: TextureUnit<'a>) -> Self {
        Self { texture: Some(texture), ..Self::new(color) }
    }

    /// Whether there is more than a colour.
    pub(crate) fn has_more(&self) -> bool {
        self.texture.is_some() || self.cube.is_some() || self.shadow.is_some() || self.alpha_test.is_some()
    }
}

impl Shading<'_> {
    /// One colour, opaque or not.
    #[must_use]
    pub const fn constant(rgba: [f32; 4]) -> Self {
        Self::Fixed(FixedShading::new(ColorSource::Constant(rgba)))
    }

    /// Colour from varyings 0, 1, 2; alpha 1.
    #[must_use]
    pub const fn vertex_rgb() -> Self {
        Self::Fixed(FixedShading::new(ColorSource::Rgb { first: 0 }))
    }

    /// The colour, if there is nothing else.
    pub(crate) fn plain_color(&self) -> Option<ColorSource> {
        match self {
            Self::Fixed(fixed) if !fixed.has_more() => Some(fixed.color),
            _ => None,
        }
    }

    /// The alpha test.
    pub(crate) fn alpha_test(&self) -> Option<AlphaTest> {
        match self {
            Self::Fixed(fixed) => fixed.alpha_test,
            _ => None,
        }
    }

    /// Whether pixels of several samples are coloured once; see [`State::multisample`].
    pub(crate) fn colors_pixels(&self) -> bool {
        match self {
            Self::Fixed(fixed) => fixed.has_more() || !matches!(fixed.color, ColorSource::Constant(_)),
            Self::Stage(_) => true,
            Self::None | Self::Custom(_) => false,
        }
    }
}

/// A colour per fragment. Default: opaque white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// The same everywhere: red, green, blue, alpha.
    Constant([f32; 4]),
    /// Varyings `first` to `first + 2`; alpha 1.
    Rgb {
        /// Number of the varying that is red.
        first: usize,
    },
    /// Varyings `first` to `first + 3`.
    Rgba {
        /// Number of the varying that is red.
        first: usize,
    },
}

impl Default for ColorSource {
    fn default() -> Self {
        Self::Constant([1.0; 4])
    }
}

/// A test of alpha, held to [0, 1]. What fails it changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaTest {
    /// How alpha must compare to the reference.
    pub compare: Compare,
    /// What it is compared to.
    pub reference: f32,
}

impl AlphaTest {
    /// Whether an alpha passes.
    #[must_use]
    pub fn passes(&self, alpha: f32) -> bool {
        self.compare.passes(alpha.clamp(0.0, 1.0), self.reference)
    }

    /// Whether nothing without alpha passes, whatever it is multiplied by.
    pub(crate) fn drops_zero(&self) -> bool {
        matches!(self.compare, Compare::Greater | Compare::GreaterEqual) && !self.passes(0.0)
    }
}

/// A texture, how it is read, and where its coordinates are.
#[derive(Clone, Copy, Debug)]
pub struct TextureUnit<'a> {
    /// What is read.
    pub texture: &'a Texture,
    /// How it is read.
    pub sampler: Sampler,
    /// Number of the varying that is u; the next one is v.
    pub coords: usize,
}

/// Gives fragments their colour. Called from several threads at once.
pub trait FragmentShader: Sync {
    /// Fills `out.rgba` for the lanes in `fragments.mask`; other lanes may hold anything. Clearing a
    /// bit of `out.keep` discards the fragment (depth and identifier are not written either).
    ///
    /// The result must depend on nothing but the fragment.
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded);
}

/// A batch of fragments of one primitive: lane `i` is pixel `(x + i % columns, y + i / columns)`.
///
/// Lanes outside `mask` are not drawn, but have varyings all the same (continued beyond the
/// primitive), so that differences of neighbours are screen derivatives; see [`Fragments::quads`].
#[derive(Clone, Copy, Debug)]
pub struct Fragments<'a> {
    /// Column of lane 0, a multiple of `columns`.
    pub x: u32,
    /// Row of lane 0, a multiple of the rows.
    pub y: u32,
    /// Lanes in a row: 8, or 4 where pixels have several samples.
    pub columns: u32,
    /// Number of the sample that is merged, where pixels have several; else 0.
    pub sample: usize,
    /// Bit `i` set: lane `i` is covered, and nearer than what is there.
    pub mask: u16,
    /// Window depth, 0 near to 1 far.
    pub depth: [f32; LANES],
    /// Interpolated varyings, in the order of [`Primitives::varyings`].
    pub varyings: &'a [[f32; LANES]],
    /// Identifier of the primitive.
    pub id: u32,
    /// Whether the primitive shows its front. True of lines and points.
    pub front: bool,
    /// Share of each pixel the primitive covers, where primitives are antialiased.
    pub coverage: Option<&'a [f32; LANES]>,
}

impl Fragments<'_> {
    /// Column of lane `i`.
    #[must_use]
    pub fn column(&self, i: usize) -> u32 {
        self.x + i as u32 % self.columns
    }

    /// Row of lane `i`.
    #[must_use]
    pub fn row(&self, i: usize) -> u32 {
        self.y + i as u32 / self.columns
    }

    /// Squares of 2 x 2 pixels: the lanes of each, first row first.
    pub fn quads(&self) -> impl Iterator<Item = [usize; 4]> + use<> {
        let columns = self.columns as usize;
        (0..4).map(move |k| {
            let corner = if columns == 8 { 2 * k } else { 8 * (k / 2) + 2 * (k % 2) };
            [corner, corner + 1, corner + columns, corner + columns + 1]
        })
    }

    /// Lanes to shade, in rising order.
    pub fn lanes(&self) -> impl Iterator<Item = usize> + use<> {
        let mask = self.mask;
        (0..LANES).filter(move |i| mask >> i & 1 == 1)
    }

    /// Change of `value` per pixel in x and in y at lane `i`, from its square of 2 x 2 pixels.
    #[must_use]
    pub fn derivatives(&self, value: &[f32; LANES], i: usize) -> [f32; 2] {
        let below = self.columns as usize;
        let (row, column) = (i & below, i & 1);
        let corner = i & !(below | 1);
        [
            value[corner + row + 1] - value[corner + row],
            value[corner + column + below] - value[corner + column],
        ]
    }
}

/// What a [`FragmentShader`] makes of a batch.
#[derive(Clone, Copy, Debug)]
pub struct Shaded {
    /// Red, green, blue, alpha, by lane. Starts as opaque black.
    pub rgba: [[f32; LANES]; 4],
    /// Lanes to draw. Starts with all bits set.
    pub keep: u16,
}

impl Default for Shaded {
    fn default() -> Self {
        let mut rgba = [[0.0; LANES]; 4];
        rgba[3] = [1.0; LANES];
        Self { rgba, keep: u16::MAX }
    }
}

impl Shaded {
    /// Sets lane `i`.
    pub fn set(&mut self, i: usize, rgba: [f32; 4]) {
        for (plane, v) in self.rgba.iter_mut().zip(rgba) {
            plane[i] = v;
        }
    }

    /// Discards lane `i`.
    pub fn discard(&mut self, i: usize) {
        self.keep &= !(1 << i);
    }
}

/// Draws primitives. [`crate::ScanlineRasterizer`] is the plain form, [`crate::TiledRasterizer`] the
/// fast one; both cover the same pixels with the same depths.
pub trait Rasterizer {
    /// Draws triangles, in order.
    fn draw(
        &mut self,
        target: &mut Target<'_>,
        triangles: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters;

    /// Draws lines, in order. The end of a line is not drawn, so that joined lines share no pixel.
    fn draw_lines(
        &mut self,
        target: &mut Target<'_>,
        lines: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        crate::lines::draw_lines(target, lines, state, shading, (self.threads(), self.level()))
    }

    /// Draws points as squares, in order.
    fn draw_points(
        &mut self,
        target: &mut Target<'_>,
        points: &Primitives<'_>,
        state: &State,
        shading: &Shading<'_>,
    ) -> Counters {
        crate::lines::draw_points(target, points, state, shading, (self.threads(), self.level()))
    }

    /// Threads that lines and points are drawn on. Default 1: one fragment after another.
    #[must_use]
    fn threads(&self) -> usize {
        1
    }

    /// Vector instructions that lines are drawn with. Default: those that every machine has.
    #[must_use]
    fn level(&self) -> Level {
        Level::baseline()
    }
}

/// What happened in a draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Primitives given.
    pub primitives: u64,
    /// With an index out of range, or a position that is not finite.
    pub invalid: u64,
    /// Left out for their facing, or for having no area on screen.
    pub culled: u64,
    /// Wholly outside the view volume.
    pub outside: u64,
    /// Cut by the near, the far, or a guard plane.
    pub clipped: u64,
    /// Sent on to be drawn (pieces of a cut primitive count one by one).
    pub drawn: u64,
    /// Covered fragments that met the depth test. Blocks of pixels rejected as a whole by
    /// hierarchical depth are not among them.
    pub tested: u64,
    /// Fragments that passed it.
    pub passed: u64,
    /// Fragments given a colour.
    pub shaded: u64,
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, o: Self) {
        self.primitives += o.primitives;
        self.invalid += o.invalid;
        self.culled += o.culled;
        self.outside += o.outside;
        self.clipped += o.clipped;
        self.drawn += o.drawn;
        self.tested += o.tested;
        self.passed += o.passed;
        self.shaded += o.shaded;
    }
}
