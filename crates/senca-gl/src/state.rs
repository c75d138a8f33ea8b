//! The state of OpenGL, in the groups that `push_attrib` saves (OpenGL 1.5, chapter 6.2).
//!
//! Defaults are those of the specification's tables 6.5 to 6.35.

use crate::gl;
use crate::{Enum, eval, raster_state};
use senca_math::glam::Mat4;

/// Number of texture units.
pub(crate) const TEXTURE_UNITS: usize = 8;
/// Number of lights.
pub(crate) const LIGHTS: usize = 8;
/// Number of user clip planes.
pub(crate) const CLIP_PLANES: usize = 6;

/// What `enable` and `disable` switch, except for what belongs to a texture unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Cap {
    AlphaTest,
    AutoNormal,
    Blend,
    ClipPlane0,
    ColorLogicOp = Self::ClipPlane0 as u8 + CLIP_PLANES as u8,
    ColorMaterial,
    ColorSum,
    CullFace,
    DebugOutput,
    DebugOutputSynchronous,
    DepthTest,
    Dither,
    Fog,
    FramebufferSrgb,
    IndexLogicOp,
    Light0,
    Lighting = Self::Light0 as u8 + LIGHTS as u8,
    LineSmooth,
    LineStipple,
    Map1Color4,
    Map2Color4 = Self::Map1Color4 as u8 + eval::TARGETS as u8,
    Multisample = Self::Map2Color4 as u8 + eval::TARGETS as u8,
    Normalize,
    PointSmooth,
    PolygonOffsetFill,
    PolygonOffsetLine,
    PolygonOffsetPoint,
    PolygonSmooth,
    PolygonStipple,
    RescaleNormal,
    SampleAlphaToCoverage,
    SampleAlphaToOne,
    SampleCoverage,
    ScissorTest,
    StencilTest,
    TextureCubeMapSeamless,
}

/// Capabilities that are on, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Enabled(pub(crate) u128);

impl Default for Enabled {
    fn default() -> Self {
        Self(1 << Cap::Dither as u8 | 1 << Cap::Multisample as u8)
    }
}

impl Enabled {
    pub(crate) fn has(self, cap: Cap) -> bool {
        self.has_nth(cap, 0)
    }

    /// The `n`-th of a row of capabilities that starts with `cap`.
    pub(crate) fn has_nth(self, cap: Cap, n: usize) -> bool {
        self.0 >> (cap as usize + n) & 1 == 1
    }

    pub(crate) fn set(&mut self, cap: Cap, n: usize, on: bool) {
        let bit = 1u128 << (cap as usize + n);
        self.0 = if on { self.0 | bit } else { self.0 & !bit };
    }
}

/// The bit number of a capability, `None` for those of texture units and for unknown names.
pub(crate) fn cap_of(name: Enum) -> Option<(Cap, usize)> {
    let one = |cap| Some((cap, 0));
    let row = |cap, first: Enum| Some((cap, (name - first) as usize));
    match name {
        gl::ALPHA_TEST => one(Cap::AlphaTest),
        gl::AUTO_NORMAL => one(Cap::AutoNormal),
        gl::BLEND => one(Cap::Blend),
        gl::CLIP_PLANE0..=gl::CLIP_PLANE5 => row(Cap::ClipPlane0, gl::CLIP_PLANE0),
        gl::COLOR_LOGIC_OP => one(Cap::ColorLogicOp),
        gl::COLOR_MATERIAL => one(Cap::ColorMaterial),
        gl::COLOR_SUM => one(Cap::ColorSum),
        gl::CULL_FACE => one(Cap::CullFace),
        gl::DEBUG_OUTPUT => one(Cap::DebugOutput),
        gl::DEBUG_OUTPUT_SYNCHRONOUS => one(Cap::DebugOutputSynchronous),
        gl::DEPTH_TEST => one(Cap::DepthTest),
        gl::DITHER => one(Cap::Dither),
        gl::FOG => one(Cap::Fog),
        gl::FRAMEBUFFER_SRGB => one(Cap::FramebufferSrgb),
        gl::INDEX_LOGIC_OP => one(Cap::IndexLogicOp),
        gl::LIGHT0..=gl::LIGHT7 => row(Cap::Light0, gl::LIGHT0),
        gl::LIGHTING => one(Cap::Lighting),
        gl::LINE_SMOOTH => one(Cap::LineSmooth),
        gl::LINE_STIPPLE => one(Cap::LineStipple),
        gl::MAP1_COLOR_4..=gl::MAP1_VERTEX_4 => row(Cap::Map1Color4, gl::MAP1_COLOR_4),
        gl::MAP2_COLOR_4..=gl::MAP2_VERTEX_4 => row(Cap::Map2Color4, gl::MAP2_COLOR_4),
        gl::MULTISAMPLE => one(Cap::Multisample),
        gl::NORMALIZE => one(Cap::Normalize),
        gl::POINT_SMOOTH => one(Cap::PointSmooth),
        gl::POLYGON_OFFSET_FILL => one(Cap::PolygonOffsetFill),
        gl::POLYGON_OFFSET_LINE => one(Cap::PolygonOffsetLine),
        gl::POLYGON_OFFSET_POINT => one(Cap::PolygonOffsetPoint),
        gl::POLYGON_SMOOTH => one(Cap::PolygonSmooth),
        gl::POLYGON_STIPPLE => one(Cap::PolygonStipple),
        gl::RESCALE_NORMAL => one(Cap::RescaleNormal),
        gl::SAMPLE_ALPHA_TO_COVERAGE => one(Cap::SampleAlphaToCoverage),
        gl::SAMPLE_ALPHA_TO_ONE => one(Cap::SampleAlphaToOne),
        gl::SAMPLE_COVERAGE => one(Cap::SampleCoverage),
        gl::SCISSOR_TEST => one(Cap::ScissorTest),
        gl::STENCIL_TEST => one(Cap::StencilTest),
        gl::TEXTURE_CUBE_MAP_SEAMLESS => one(Cap::TextureCubeMapSeamless),
        _ => None,
    }
}

/// Attributes that the next vertex takes (table 6.5), and the raster position.
#[derive(Clone, Debug)]
pub(crate) struct Current {
    pub(crate) color: [f32; 4],
    pub(crate) secondary: [f32; 4],
    pub(crate) index: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) tex_coords: [[f32; 4]; TEXTURE_UNITS],
    pub(crate) fog_coord: f32,
    pub(crate) edge_flag: bool,
    pub(crate) raster: RasterPosition,
}

impl Default for Current {
    fn default() -> Self {
        Self {
            color: [1.0; 4],
            secondary: [0.0, 0.0, 0.0, 1.0],
            index: 1.0,
            normal: [0.0, 0.0, 1.0],
            tex_coords: [[0.0, 0.0, 0.0, 1.0]; TEXTURE_UNITS],
            fog_coord: 0.0,
            edge_flag: true,
            raster: RasterPosition::default(),
        }
    }
}

/// Where `bitmap`, `draw_pixels` and `copy_pixels` draw, with what belongs to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterPosition {
    /// Window x, y (up), z, and w of clip space.
    pub(crate) position: [f32; 4],
    pub(crate) valid: bool,
    /// From the eye, or the fog coordinate.
    pub(crate) distance: f32,
    pub(crate) color: [f32; 4],
    pub(crate) secondary: [f32; 4],
    pub(crate) index: f32,
    pub(crate) tex_coords: [[f32; 4]; TEXTURE_UNITS],
}

impl Default for RasterPosition {
    fn default() -> Self {
        Self {
            position: [0.0, 0.0, 0.0, 1.0],
            valid: true,
            distance: 0.0,
            color: [1.0; 4],
            secondary: [0.0, 0.0, 0.0, 1.0],
            index: 1.0,
            tex_coords: [[0.0, 0.0, 0.0, 1.0]; TEXTURE_UNITS],
        }
    }
}

/// Points (table 6.12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) size: f32,
    pub(crate) min: f32,
    pub(crate) max: f32,
    pub(crate) fade_threshold: f32,
    /// Constant, linear, quadratic.
    pub(crate) attenuation: [f32; 3],
}

impl Default for Point {
    fn default() -> Self {
        Self {
            size: 1.0,
            min: 0.0,
            max: raster_state::MAX_POINT_SIZE,
            fade_threshold: 1.0,
            attenuation: [1.0, 0.0, 0.0],
        }
    }
}

/// Lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) width: f32,
    pub(crate) stipple_factor: u32,
    pub(crate) stipple_pattern: u16,
}

impl Default for Line {
    fn default() -> Self {
        Self { width: 1.0, stipple_factor: 1, stipple_pattern: 0xffff }
    }
}

/// Polygons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Polygon {
    pub(crate) cull_face: Enum,
    pub(crate) front_face: Enum,
    /// Of front and of back faces: POINT, LINE, FILL.
    pub(crate) mode: [Enum; 2],
    pub(crate) offset_factor: f32,
    pub(crate) offset_units: f32,
}

impl Default for Polygon {
    fn default() -> Self {
        Self {
            cull_face: gl::BACK,
            front_face: gl::CCW,
            mode: [gl::FILL; 2],
            offset_factor: 0.0,
            offset_units: 0.0,
        }
    }
}

/// One light (table 6.11); positions are in eye space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light {
    pub(crate) ambient: [f32; 4],
    pub(crate) diffuse: [f32; 4],
    pub(crate) specular: [f32; 4],
    pub(crate) position: [f32; 4],
    pub(crate) spot_direction: [f32; 3],
    pub(crate) spot_exponent: f32,
    /// Degrees: 0 to 90, or 180.
    pub(crate) spot_cutoff: f32,
    /// Constant, linear, quadratic.
    pub(crate) attenuation: [f32; 3],
}

impl Light {
    fn numbered(n: usize) -> Self {
        let shine = if n == 0 { [1.0; 4] } else { [0.0, 0.0, 0.0, 1.0] };
        Self {
            ambient: [0.0, 0.0, 0.0, 1.0],
            diffuse: shine,
            specular: shine,
            position: [0.0, 0.0, 1.0, 0.0],
            spot_direction: [0.0, 0.0, -1.0],
            spot_exponent: 0.0,
            spot_cutoff: 180.0,
            attenuation: [1.0, 0.0, 0.0],
        }
    }
}

/// One side's material (table 6.10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Material {
    pub(crate) ambient: [f32; 4],
    pub(crate) diffuse: [f32; 4],
    pub(crate) specular: [f32; 4],
    pub(crate) emission: [f32; 4],
    pub(crate) shininess: f32,
    /// Ambient, diffuse, specular colour indices.
    pub(crate) indexes: [f32; 3],
}

impl Default for Material {
    fn default() -> Self {
        Self {
            ambient: [0.2, 0.2, 0.2, 1.0],
            diffuse: [0.8, 0.8, 0.8, 1.0],
            specular: [0.0, 0.0, 0.0, 1.0],
            emission: [0.0, 0.0, 0.0, 1.0],
            shininess: 0.0,
            indexes: [0.0, 1.0, 1.0],
        }
    }
}

/// Lighting (tables 6.9 to 6.11).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lighting {
    pub(crate) shade_model: Enum,
    pub(crate) color_material_face: Enum,
    pub(crate) color_material_mode: Enum,
    pub(crate) model_ambient: [f32; 4],
    pub(crate) local_viewer: bool,
    pub(crate) two_side: bool,
    pub(crate) color_control: Enum,
    pub(crate) lights: [Light; LIGHTS],
    /// Front, back.
    pub(crate) materials: [Material; 2],
}

impl Default for Lighting {
    fn default() -> Self {
        Self {
            shade_model: gl::SMOOTH,
            color_material_face: gl::FRONT_AND_BACK,
            color_material_mode: gl::AMBIENT_AND_DIFFUSE,
            model_ambient: [0.2, 0.2, 0.2, 1.0],
            local_viewer: false,
            two_side: false,
            color_control: gl::SINGLE_COLOR,
            lights: std::array::from_fn(Light::numbered),
            materials: [Material::default(); 2],
        }
    }
}

/// Fog (table 6.8).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fog {
    pub(crate) color: [f32; 4],
    pub(crate) index: f32,
    pub(crate) density: f32,
    pub(crate) start: f32,
    pub(crate) end: f32,
    pub(crate) mode: Enum,
    pub(crate) coord_src: Enum,
}

impl Default for Fog {
    fn default() -> Self {
        Self {
            color: [0.0; 4],
            index: 0.0,
            density: 1.0,
            start: 0.0,
            end: 1.0,
            mode: gl::EXP,
            coord_src: gl::FRAGMENT_DEPTH,
        }
    }
}

/// The depth buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DepthBuffer {
    pub(crate) func: Enum,
    pub(crate) mask: bool,
    pub(crate) clear: f64,
}

impl Default for DepthBuffer {
    fn default() -> Self {
        Self { func: gl::LESS, mask: true, clear: 1.0 }
    }
}

/// The stencil buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StencilBuffer {
    pub(crate) func: Enum,
    pub(crate) reference: i32,
    pub(crate) value_mask: u32,
    pub(crate) write_mask: u32,
    pub(crate) fail: Enum,
    pub(crate) depth_fail: Enum,
    pub(crate) depth_pass: Enum,
    pub(crate) clear: i32,
}

impl Default for StencilBuffer {
    fn default() -> Self {
        Self {
            func: gl::ALWAYS,
            reference: 0,
            value_mask: !0,
            write_mask: !0,
            fail: gl::KEEP,
            depth_fail: gl::KEEP,
            depth_pass: gl::KEEP,
            clear: 0,
        }
    }
}

/// The accumulation buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AccumBuffer {
    pub(crate) clear: [f32; 4],
}

/// The viewport.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Viewport {
    /// x, y (of the lower left corner), width, height, in pixels.
    pub(crate) rect: [i32; 4],
    pub(crate) near: f64,
    pub(crate) far: f64,
}

impl Default for Viewport {
    fn default() -> Self {
        Self { rect: [0; 4], near: 0.0, far: 1.0 }
    }
}

/// Matrix mode, clip planes (in eye space), clip control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform {
    pub(crate) matrix_mode: Enum,
    pub(crate) clip_planes: [[f64; 4]; CLIP_PLANES],
    pub(crate) clip_origin: Enum,
    pub(crate) clip_depth: Enum,
}

impl Default for Transform {
    fn default() -> Self {
        Self {
            matrix_mode: gl::MODELVIEW,
            clip_planes: [[0.0; 4]; CLIP_PLANES],
            clip_origin: gl::LOWER_LEFT,
            clip_depth: gl::NEGATIVE_ONE_TO_ONE,
        }
    }
}

/// The colour buffer (tables 6.21, 6.22). The draw buffer belongs to the framebuffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColorBuffer {
    pub(crate) alpha_func: Enum,
    pub(crate) alpha_ref: f32,
    /// Source and destination factor of colour, then of alpha.
    pub(crate) blend_func: [Enum; 4],
    /// Of colour, of alpha.
    pub(crate) blend_equation: [Enum; 2],
    pub(crate) blend_color: [f32; 4],
    pub(crate) logic_op: Enum,
    pub(crate) mask: [bool; 4],
    pub(crate) index_mask: u32,
    pub(crate) clear_color: [f32; 4],
    pub(crate) clear_index: f32,
}

impl Default for ColorBuffer {
    fn default() -> Self {
        Self {
            alpha_func: gl::ALWAYS,
            alpha_ref: 0.0,
            blend_func: [gl::ONE, gl::ZERO, gl::ONE, gl::ZERO],
            blend_equation: [gl::FUNC_ADD; 2],
            blend_color: [0.0; 4],
            logic_op: gl::COPY,
            mask: [true; 4],
            index_mask: !0,
            clear_color: [0.0; 4],
            clear_index: 0.0,
        }
    }
}

/// Hints, which are remembered and change nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Hints {
    pub(crate) perspective_correction: Enum,
    pub(crate) point_smooth: Enum,
    pub(crate) line_smooth: Enum,
    pub(crate) polygon_smooth: Enum,
    pub(crate) fog: Enum,
    pub(crate) generate_mipmap: Enum,
    pub(crate) texture_compression: Enum,
}

impl Default for Hints {
    fn default() -> Self {
        let h = gl::DONT_CARE;
        Self {
            perspective_correction: h,
            point_smooth: h,
            line_smooth: h,
            polygon_smooth: h,
            fog: h,
            generate_mipmap: h,
            texture_compression: h,
        }
    }
}

/// Sample coverage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Multisample {
    pub(crate) coverage: f32,
    pub(crate) invert: bool,
}

impl Default for Multisample {
    fn default() -> Self {
        Self { coverage: 1.0, invert: false }
    }
}

/// How texture coordinates are generated, one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TexGen {
    pub(crate) enabled: bool,
    pub(crate) mode: Enum,
    pub(crate) object_plane: [f32; 4],
    pub(crate) eye_plane: [f32; 4],
}

impl TexGen {
    fn of_coordinate(k: usize) -> Self {
        let mut plane = [0.0; 4];
        if k < 2 {
            plane[k] = 1.0;
        }
        Self { enabled: false, mode: gl::EYE_LINEAR, object_plane: plane, eye_plane: plane }
    }
}

/// A texture environment (tables 6.19, 6.20).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TexEnv {
    pub(crate) mode: Enum,
    pub(crate) color: [f32; 4],
    pub(crate) combine_rgb: Enum,
    pub(crate) combine_alpha: Enum,
    pub(crate) source_rgb: [Enum; 3],
    pub(crate) source_alpha: [Enum; 3],
    pub(crate) operand_rgb: [Enum; 3],
    pub(crate) operand_alpha: [Enum; 3],
    pub(crate) rgb_scale: f32,
    pub(crate) alpha_scale: f32,
    pub(crate) lod_bias: f32,
}

impl Default for TexEnv {
    fn default() -> Self {
        let sources = [gl::TEXTURE, gl::PREVIOUS, gl::CONSTANT];
        Self {
            mode: gl::MODULATE,
            color: [0.0; 4],
            combine_rgb: gl::MODULATE,
            combine_alpha: gl::MODULATE,
            source_rgb: sources,
            source_alpha: sources,
            operand_rgb: [gl::SRC_COLOR, gl::SRC_COLOR, gl::SRC_ALPHA],
            operand_alpha: [gl::SRC_ALPHA; 3],
            rgb_scale: 1.0,
            alpha_scale: 1.0,
            lod_bias: 0.0,
        }
    }
}

/// Kinds of textures, in the order in which a unit prefers them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum TexTarget {
    /// One-dimensional.
    One,
    /// Two-dimensional.
    Two,
    /// Three-dimensional.
    Three,
    /// Six faces of a cube.
    Cube,
}

impl TexTarget {
    pub(crate) const ALL: [Self; 4] = [Self::One, Self::Two, Self::Three, Self::Cube];

    /// From TEXTURE_1D, TEXTURE_2D, TEXTURE_3D, TEXTURE_CUBE_MAP.
    pub(crate) fn of(name: Enum) -> Option<Self> {
        match name {
            gl::TEXTURE_1D => Some(Self::One),
            gl::TEXTURE_2D => Some(Self::Two),
            gl::TEXTURE_3D => Some(Self::Three),
            gl::TEXTURE_CUBE_MAP => Some(Self::Cube),
            _ => None,
        }
    }
}

/// A texture unit's own state. What is bound is kept beside it, see [`crate::texture`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureUnit {
    /// By [`TexTarget`].
    pub(crate) enabled: [bool; 4],
    pub(crate) env: TexEnv,
    /// Of s, t, r, q.
    pub(crate) generation: [TexGen; 4],
}

impl Default for TextureUnit {
    fn default() -> Self {
        Self {
            enabled: [false; 4],
            env: TexEnv::default(),
            generation: std::array::from_fn(TexGen::of_coordinate),
        }
    }
}

/// Texturing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Texturing {
    /// Number of the active unit.
    pub(crate) active: usize,
    pub(crate) units: [TextureUnit; TEXTURE_UNITS],
}

/// All that `push_attrib` can save, group by group.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub(crate) enabled: Enabled,
    pub(crate) current: Current,
    pub(crate) point: Point,
    pub(crate) line: Line,
    pub(crate) polygon: Polygon,
    pub(crate) polygon_stipple: PolygonStipple,
    pub(crate) lighting: Lighting,
    pub(crate) fog: Fog,
    pub(crate) depth: DepthBuffer,
    pub(crate) accum: AccumBuffer,
    pub(crate) stencil: StencilBuffer,
    pub(crate) viewport: Viewport,
    pub(crate) transform: Transform,
    pub(crate) color: ColorBuffer,
    pub(crate) hints: Hints,
    pub(crate) eval: eval::Evaluators,
    pub(crate) list_base: u32,
    pub(crate) texturing: Texturing,
    /// x, y (of the lower left corner), width, height.
    pub(crate) scissor: [i32; 4],
    pub(crate) multisample: Multisample,
}

/// 32 rows from the bottom, the most significant bit left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PolygonStipple(pub(crate) [u32; 32]);

impl Default for PolygonStipple {
    fn default() -> Self {
        Self([!0; 32])
    }
}

/// A stack of matrices; the last is current.
#[derive(Clone, Debug)]
pub(crate) struct MatrixStack {
    pub(crate) matrices: Vec<Mat4>,
    pub(crate) limit: usize,
}

impl MatrixStack {
    pub(crate) fn new(limit: usize) -> Self {
        Self { matrices: vec![Mat4::IDENTITY], limit }
    }

    pub(crate) fn top(&self) -> Mat4 {
        self.matrices.last().copied().unwrap_or(Mat4::IDENTITY)
    }

    pub(crate) fn set_top(&mut self, m: Mat4) {
        if let Some(top) = self.matrices.last_mut() {
            *top = m;
        }
    }
}
