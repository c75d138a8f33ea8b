//! Questions (OpenGL 1.5, chapter 6): `glGet*` in its four types, and of lights, materials, maps, units.

use crate::eval::{MAX_ORDER, target_of};
use crate::state::{CLIP_PLANES, LIGHTS, Light, Material, TEXTURE_UNITS};
use crate::{Context, Enum, attrib, context, debug, gl, list, raster_state, select};
use senca_math::glam::Mat4;
use smallvec::{SmallVec, smallvec};

/// Numbers of an answer.
pub type Values<T> = SmallVec<[T; 16]>;

/// What kind of numbers an answer has, which decides how they become integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Bool,
    Int,
    Float,
    /// Colours, normals, depths: 1 is the greatest integer, -1 the least.
    Normalized,
}

/// An answer before it becomes numbers of some type.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    kind: Kind,
    values: SmallVec<[f64; 16]>,
}

impl Answer {
    pub(crate) fn bools<const N: usize>(v: [bool; N]) -> Self {
        Self { kind: Kind::Bool, values: v.iter().map(|b| f64::from(u8::from(*b))).collect() }
    }

    pub(crate) fn ints<T: Into<f64>>(v: impl IntoIterator<Item = T>) -> Self {
        Self { kind: Kind::Int, values: v.into_iter().map(Into::into).collect() }
    }

    pub(crate) fn int(v: usize) -> Self {
        Self { kind: Kind::Int, values: smallvec![v as f64] }
    }

    pub(crate) fn floats<T: Into<f64>>(v: impl IntoIterator<Item = T>) -> Self {
        Self { kind: Kind::Float, values: v.into_iter().map(Into::into).collect() }
    }

    pub(crate) fn normalized<T: Into<f64>>(v: impl IntoIterator<Item = T>) -> Self {
        Self { kind: Kind::Normalized, values: v.into_iter().map(Into::into).collect() }
    }

    pub(crate) fn token(v: Enum) -> Self {
        Self::ints([v])
    }

    fn matrix(m: Mat4) -> Self {
        Self::floats(m.to_cols_array())
    }

    fn booleans(&self) -> Values<bool> {
        self.values.iter().map(|v| *v != 0.0).collect()
    }

    pub(crate) fn integers(&self) -> Values<i32> {
        let of = |v: f64| match self.kind {
            // Masks and names are unsigned; as integers they keep their bits.
            Kind::Bool | Kind::Int if v > f64::from(i32::MAX) => v as u32 as i32,
            Kind::Bool | Kind::Int => v as i32,
            Kind::Float => (v + 0.5).floor() as i32,
            Kind::Normalized => ((v * f64::from(u32::MAX) - 1.0) / 2.0).round_ties_even() as i32,
        };
        self.values.iter().map(|v| of(*v)).collect()
    }

    pub(crate) fn numbers(&self) -> Values<f64> {
        self.values.iter().copied().collect()
    }
}

/// Extensions that are there, as `glGetString(GL_EXTENSIONS)` tells.
pub const EXTENSIONS: &[&str] = &[
    "GL_ARB_clip_control",
    "GL_ARB_depth_buffer_float",
    "GL_ARB_depth_texture",
    "GL_ARB_framebuffer_object",
    "GL_ARB_half_float_pixel",
    "GL_ARB_multisample",
    "GL_ARB_multitexture",
    "GL_ARB_occlusion_query",
    "GL_ARB_point_parameters",
    "GL_ARB_seamless_cube_map",
    "GL_ARB_shadow",
    "GL_ARB_texture_border_clamp",
    "GL_ARB_texture_compression",
    "GL_ARB_texture_cube_map",
    "GL_ARB_texture_env_add",
    "GL_ARB_texture_env_combine",
    "GL_ARB_texture_env_crossbar",
    "GL_ARB_texture_env_dot3",
    "GL_ARB_texture_mirrored_repeat",
    "GL_ARB_texture_non_power_of_two",
    "GL_ARB_transpose_matrix",
    "GL_ARB_vertex_buffer_object",
    "GL_ARB_window_pos",
    "GL_EXT_abgr",
    "GL_EXT_bgra",
    "GL_EXT_blend_color",
    "GL_EXT_blend_equation_separate",
    "GL_EXT_blend_func_separate",
    "GL_EXT_blend_minmax",
    "GL_EXT_blend_subtract",
    "GL_EXT_copy_texture",
    "GL_EXT_draw_range_elements",
    "GL_EXT_fog_coord",
    "GL_EXT_framebuffer_blit",
    "GL_EXT_framebuffer_multisample",
    "GL_EXT_framebuffer_object",
    "GL_EXT_multi_draw_arrays",
    "GL_EXT_packed_depth_stencil",
    "GL_EXT_packed_pixels",
    "GL_EXT_point_parameters",
    "GL_EXT_rescale_normal",
    "GL_EXT_secondary_color",
    "GL_EXT_separate_specular_color",
    "GL_EXT_shadow_funcs",
    "GL_EXT_stencil_wrap",
    "GL_EXT_subtexture",
    "GL_EXT_texgen_reflection",
    "GL_EXT_texture",
    "GL_EXT_texture3D",
    "GL_EXT_texture_cube_map",
    "GL_EXT_texture_edge_clamp",
    "GL_EXT_texture_env_add",
    "GL_EXT_texture_env_combine",
    "GL_EXT_texture_env_dot3",
    "GL_EXT_texture_lod_bias",
    "GL_EXT_texture_object",
    "GL_EXT_texture_sRGB",
    "GL_EXT_vertex_array",
    "GL_KHR_debug",
    "GL_NV_blend_square",
    "GL_SGIS_generate_mipmap",
    "GL_SGIS_texture_border_clamp",
    "GL_SGIS_texture_edge_clamp",
    "GL_SGIS_texture_lod",
];

impl Context {
    /// `glGetBooleanv`; no values when the name is unknown, which is an `INVALID_ENUM`.
    pub fn get_boolean(&mut self, name: Enum) -> Values<bool> {
        self.answer(name).map(|a| a.booleans()).unwrap_or_default()
    }

    /// `glGetIntegerv`: floating point is rounded, colours, normals and depths fill the range of the integers.
    pub fn get_integer(&mut self, name: Enum) -> Values<i32> {
        self.answer(name).map(|a| a.integers()).unwrap_or_default()
    }

    /// `glGetFloatv`.
    pub fn get_float(&mut self, name: Enum) -> Values<f32> {
        self.answer(name).map(|a| a.values.iter().map(|v| *v as f32).collect()).unwrap_or_default()
    }

    /// `glGetDoublev`.
    pub fn get_double(&mut self, name: Enum) -> Values<f64> {
        self.answer(name).map(|a| a.numbers()).unwrap_or_default()
    }

    fn answer(&mut self, name: Enum) -> Option<Answer> {
        self.ask(|c| {
            c.settle_color_material();
            let answer = c.find_answer(name);
            if answer.is_none() {
                c.error(gl::INVALID_ENUM);
            }
            answer
        })
    }

    fn find_answer(&self, name: Enum) -> Option<Answer> {
        None.or_else(|| self.vertex_answer(name))
            .or_else(|| self.fragment_answer(name))
            .or_else(|| self.pixel_answer(name))
            .or_else(|| self.list_answer(name))
            .or_else(|| self.array_answer(name))
            .or_else(|| self.limit_answer(name))
            .or_else(|| self.image_answer(name))
            .or_else(|| self.enabled(name).map(|on| Answer::bools([on])))
    }

    /// Current values, matrices, lighting.
    fn vertex_answer(&self, name: Enum) -> Option<Answer> {
        let s = &self.state;
        let (c, l, r) = (&s.current, &s.lighting, &s.current.raster);
        let unit = s.texturing.active;
        Some(match name {
            gl::CURRENT_COLOR => Answer::normalized(c.color),
            gl::CURRENT_SECONDARY_COLOR => Answer::normalized(c.secondary),
            gl::CURRENT_INDEX => Answer::floats([c.index]),
            gl::CURRENT_NORMAL => Answer::normalized(c.normal),
            gl::CURRENT_TEXTURE_COORDS => Answer::floats(c.tex_coords[unit]),
            gl::CURRENT_FOG_COORD => Answer::floats([c.fog_coord]),
            gl::EDGE_FLAG => Answer::bools([c.edge_flag]),
            gl::CURRENT_RASTER_POSITION => Answer::floats(r.position),
            gl::CURRENT_RASTER_POSITION_VALID => Answer::bools([r.valid]),
            gl::CURRENT_RASTER_DISTANCE => Answer::floats([r.distance]),
            gl::CURRENT_RASTER_COLOR => Answer::normalized(r.color),
            gl::CURRENT_RASTER_SECONDARY_COLOR => Answer::normalized(r.secondary),
            gl::CURRENT_RASTER_INDEX => Answer::floats([r.index]),
            gl::CURRENT_RASTER_TEXTURE_COORDS => Answer::floats(r.tex_coords[unit]),
            gl::MATRIX_MODE => Answer::token(s.transform.matrix_mode),
            gl::MODELVIEW_MATRIX => Answer::matrix(self.modelview.top()),
            gl::PROJECTION_MATRIX => Answer::matrix(self.projection.top()),
            gl::TEXTURE_MATRIX => Answer::matrix(self.texture_matrices[unit].top()),
            gl::TRANSPOSE_MODELVIEW_MATRIX => Answer::matrix(self.modelview.top().transpose()),
            gl::TRANSPOSE_PROJECTION_MATRIX => Answer::matrix(self.projection.top().transpose()),
            gl::TRANSPOSE_TEXTURE_MATRIX => Answer::matrix(self.texture_matrices[unit].top().transpose()),
            gl::MODELVIEW_STACK_DEPTH => Answer::int(self.modelview.matrices.len()),
            gl::PROJECTION_STACK_DEPTH => Answer::int(self.projection.matrices.len()),
            gl::TEXTURE_STACK_DEPTH => Answer::int(self.texture_matrices[unit].matrices.len()),
            gl::VIEWPORT => Answer::ints(s.viewport.rect),
            gl::DEPTH_RANGE => Answer::normalized([s.viewport.near, s.viewport.far]),
            gl::CLIP_ORIGIN => Answer::token(s.transform.clip_origin),
            gl::CLIP_DEPTH_MODE => Answer::token(s.transform.clip_depth),
            gl::SHADE_MODEL => Answer::token(l.shade_model),
            gl::COLOR_MATERIAL_FACE => Answer::token(l.color_material_face),
            gl::COLOR_MATERIAL_PARAMETER => Answer::token(l.color_material_mode),
            gl::LIGHT_MODEL_AMBIENT => Answer::normalized(l.model_ambient),
            gl::LIGHT_MODEL_LOCAL_VIEWER => Answer::bools([l.local_viewer]),
            gl::LIGHT_MODEL_TWO_SIDE => Answer::bools([l.two_side]),
            gl::LIGHT_MODEL_COLOR_CONTROL => Answer::token(l.color_control),
            gl::ACTIVE_TEXTURE => Answer::token(gl::TEXTURE0 + unit as Enum),
            _ => return None,
        })
    }

    /// What happens to fragments.
    fn fragment_answer(&self, name: Enum) -> Option<Answer> {
        let s = &self.state;
        let (b, d, st) = (&s.color, &s.depth, &s.stencil);
        Some(match name {
            gl::FOG_COLOR => Answer::normalized(s.fog.color),
            gl::FOG_INDEX => Answer::floats([s.fog.index]),
            gl::FOG_DENSITY => Answer::floats([s.fog.density]),
            gl::FOG_START => Answer::floats([s.fog.start]),
            gl::FOG_END => Answer::floats([s.fog.end]),
            gl::FOG_MODE => Answer::token(s.fog.mode),
            gl::FOG_COORD_SRC => Answer::token(s.fog.coord_src),
            gl::POINT_SIZE => Answer::floats([s.point.size]),
            gl::POINT_SIZE_MIN => Answer::floats([s.point.min]),
            gl::POINT_SIZE_MAX => Answer::floats([s.point.max]),
            gl::POINT_FADE_THRESHOLD_SIZE => Answer::floats([s.point.fade_threshold]),
            gl::POINT_DISTANCE_ATTENUATION => Answer::floats(s.point.attenuation),
            gl::LINE_WIDTH => Answer::floats([s.line.width]),
            gl::LINE_STIPPLE_PATTERN => Answer::ints([s.line.stipple_pattern]),
            gl::LINE_STIPPLE_REPEAT => Answer::ints([s.line.stipple_factor]),
            gl::CULL_FACE_MODE => Answer::token(s.polygon.cull_face),
            gl::FRONT_FACE => Answer::token(s.polygon.front_face),
            gl::POLYGON_MODE => Answer::ints(s.polygon.mode),
            gl::POLYGON_OFFSET_FACTOR => Answer::floats([s.polygon.offset_factor]),
            gl::POLYGON_OFFSET_UNITS => Answer::floats([s.polygon.offset_units]),
            gl::SCISSOR_BOX => Answer::ints(s.scissor),
            gl::SAMPLE_COVERAGE_VALUE => Answer::floats([s.multisample.coverage]),
            gl::SAMPLE_COVERAGE_INVERT => Answer::bools([s.multisample.invert]),
            gl::ALPHA_TEST_FUNC => Answer::token(b.alpha_func),
            gl::ALPHA_TEST_REF => Answer::normalized([b.alpha_ref]),
            gl::BLEND_SRC | gl::BLEND_SRC_RGB => Answer::token(b.blend_func[0]),
            gl::BLEND_DST | gl::BLEND_DST_RGB => Answer::token(b.blend_func[1]),
            gl::BLEND_SRC_ALPHA => Answer::token(b.blend_func[2]),
            gl::BLEND_DST_ALPHA => Answer::token(b.blend_func[3]),
            gl::BLEND_EQUATION => Answer::token(b.blend_equation[0]),
            gl::BLEND_EQUATION_ALPHA => Answer::token(b.blend_equation[1]),
            gl::BLEND_COLOR => Answer::normalized(b.blend_color),
            gl::LOGIC_OP_MODE => Answer::token(b.logic_op),
            gl::COLOR_WRITEMASK => Answer::bools(b.mask),
            gl::INDEX_WRITEMASK => Answer::ints([b.index_mask]),
            gl::COLOR_CLEAR_VALUE => Answer::normalized(b.clear_color),
            gl::INDEX_CLEAR_VALUE => Answer::floats([b.clear_index]),
            gl::DEPTH_FUNC => Answer::token(d.func),
            gl::DEPTH_WRITEMASK => Answer::bools([d.mask]),
            gl::DEPTH_CLEAR_VALUE => Answer::normalized([d.clear]),
            gl::STENCIL_FUNC => Answer::token(st.func),
            gl::STENCIL_REF => Answer::ints([st.reference.clamp(0, 255)]),
            gl::STENCIL_VALUE_MASK => Answer::ints([st.value_mask]),
            gl::STENCIL_WRITEMASK => Answer::ints([st.write_mask]),
            gl::STENCIL_FAIL => Answer::token(st.fail),
            gl::STENCIL_PASS_DEPTH_FAIL => Answer::token(st.depth_fail),
            gl::STENCIL_PASS_DEPTH_PASS => Answer::token(st.depth_pass),
            gl::STENCIL_CLEAR_VALUE => Answer::ints([st.clear]),
            gl::ACCUM_CLEAR_VALUE => Answer::normalized(s.accum.clear),
            gl::PERSPECTIVE_CORRECTION_HINT => Answer::token(s.hints.perspective_correction),
            gl::POINT_SMOOTH_HINT => Answer::token(s.hints.point_smooth),
            gl::LINE_SMOOTH_HINT => Answer::token(s.hints.line_smooth),
            gl::POLYGON_SMOOTH_HINT => Answer::token(s.hints.polygon_smooth),
            gl::FOG_HINT => Answer::token(s.hints.fog),
            gl::GENERATE_MIPMAP_HINT => Answer::token(s.hints.generate_mipmap),
            gl::TEXTURE_COMPRESSION_HINT => Answer::token(s.hints.texture_compression),
            _ => return None,
        })
    }

    /// How pixels are read, written and changed on the way.
    fn pixel_answer(&self, name: Enum) -> Option<Answer> {
        let (store, transfer) = (&self.pixels.store, &self.pixels.transfer);
        let unpack = matches!(name, gl::UNPACK_SWAP_BYTES..=gl::UNPACK_ALIGNMENT)
            || matches!(name, gl::UNPACK_SKIP_IMAGES | gl::UNPACK_IMAGE_HEIGHT);
        let stored = if unpack { store.unpack.get(name) } else { store.pack.get(name) };
        if let Some(v) = stored {
            let flag = matches!(
                name,
                gl::UNPACK_SWAP_BYTES | gl::UNPACK_LSB_FIRST | gl::PACK_SWAP_BYTES | gl::PACK_LSB_FIRST
            );
            return Some(if flag { Answer::bools([v != 0]) } else { Answer::ints([v]) });
        }
        if let Some(v) = transfer.modes.get(name) {
            return Some(match name {
                gl::MAP_COLOR | gl::MAP_STENCIL => Answer::bools([v != 0.0]),
                gl::INDEX_SHIFT | gl::INDEX_OFFSET => Answer::ints([v]),
                _ => Answer::floats([v]),
            });
        }
        if let Some(map) = crate::pixel::PixelMap::from_size_token(name) {
            return Some(Answer::int(self.pixels.maps.table(map).len()));
        }
        Some(match name {
            gl::ZOOM_X => Answer::floats([transfer.zoom[0]]),
            gl::ZOOM_Y => Answer::floats([transfer.zoom[1]]),
            _ => return None,
        })
    }

    /// Lists, evaluators, stacks, modes, messages.
    fn list_answer(&self, name: Enum) -> Option<Answer> {
        let compiling = self.compiling.as_ref().map(list::Compiling::query);
        let e = &self.state.eval;
        let (select_size, feedback_size, feedback_type) = self.render_mode.buffers();
        Some(match name {
            gl::LIST_BASE => Answer::ints([self.state.list_base]),
            gl::LIST_INDEX => Answer::ints([compiling.map_or(0, |c| c.0)]),
            gl::LIST_MODE => Answer::token(compiling.map_or(0, |c| c.1)),
            gl::MAP1_GRID_DOMAIN => Answer::floats(e.grid1.1),
            gl::MAP1_GRID_SEGMENTS => Answer::ints([e.grid1.0]),
            gl::MAP2_GRID_DOMAIN => Answer::floats(e.grid2.1.into_iter().flatten()),
            gl::MAP2_GRID_SEGMENTS => Answer::ints(e.grid2.0),
            gl::RENDER_MODE => Answer::token(self.render_mode.mode),
            gl::NAME_STACK_DEPTH => Answer::int(self.render_mode.name_depth()),
            gl::SELECTION_BUFFER_SIZE => Answer::int(select_size),
            gl::FEEDBACK_BUFFER_SIZE => Answer::int(feedback_size),
            gl::FEEDBACK_BUFFER_TYPE => Answer::token(feedback_type),
            gl::ATTRIB_STACK_DEPTH => Answer::int(self.attrib_stack.len()),
            gl::CLIENT_ATTRIB_STACK_DEPTH => Answer::int(self.client_stack.len()),
            gl::DEBUG_LOGGED_MESSAGES => Answer::int(self.debug.logged()),
            gl::DEBUG_NEXT_LOGGED_MESSAGE_LENGTH => Answer::int(self.debug.next_length()),
            gl::DEBUG_GROUP_STACK_DEPTH => Answer::int(self.debug.group_depth()),
            _ => return None,
        })
    }

    /// Vertex arrays and buffers.
    fn array_answer(&self, name: Enum) -> Option<Answer> {
        let c = &self.client;
        let coords = &c.tex_coords[c.active];
        Some(match name {
            gl::CLIENT_ACTIVE_TEXTURE => Answer::token(gl::TEXTURE0 + c.active as Enum),
            gl::VERTEX_ARRAY_SIZE => Answer::ints([c.vertex.size]),
            gl::VERTEX_ARRAY_TYPE => Answer::token(c.vertex.kind),
            gl::VERTEX_ARRAY_STRIDE => Answer::ints([c.vertex.stride]),
            gl::NORMAL_ARRAY_TYPE => Answer::token(c.normal.kind),
            gl::NORMAL_ARRAY_STRIDE => Answer::ints([c.normal.stride]),
            gl::COLOR_ARRAY_SIZE => Answer::ints([c.color.size]),
            gl::COLOR_ARRAY_TYPE => Answer::token(c.color.kind),
            gl::COLOR_ARRAY_STRIDE => Answer::ints([c.color.stride]),
            gl::SECONDARY_COLOR_ARRAY_SIZE => Answer::ints([c.secondary.size]),
            gl::SECONDARY_COLOR_ARRAY_TYPE => Answer::token(c.secondary.kind),
            gl::SECONDARY_COLOR_ARRAY_STRIDE => Answer::ints([c.secondary.stride]),
            gl::FOG_COORD_ARRAY_TYPE => Answer::token(c.fog_coord.kind),
            gl::FOG_COORD_ARRAY_STRIDE => Answer::ints([c.fog_coord.stride]),
            gl::INDEX_ARRAY_TYPE => Answer::token(c.index.kind),
            gl::INDEX_ARRAY_STRIDE => Answer::ints([c.index.stride]),
            gl::EDGE_FLAG_ARRAY_STRIDE => Answer::ints([c.edge_flag.stride]),
            gl::TEXTURE_COORD_ARRAY_SIZE => Answer::ints([coords.size]),
            gl::TEXTURE_COORD_ARRAY_TYPE => Answer::token(coords.kind),
            gl::TEXTURE_COORD_ARRAY_STRIDE => Answer::ints([coords.stride]),
            gl::ARRAY_BUFFER_BINDING => Answer::ints([c.array_buffer.0]),
            gl::ELEMENT_ARRAY_BUFFER_BINDING => Answer::ints([c.element_buffer.0]),
            gl::VERTEX_ARRAY_BUFFER_BINDING => Answer::ints([c.vertex.buffer.0]),
            gl::NORMAL_ARRAY_BUFFER_BINDING => Answer::ints([c.normal.buffer.0]),
            gl::COLOR_ARRAY_BUFFER_BINDING => Answer::ints([c.color.buffer.0]),
            gl::SECONDARY_COLOR_ARRAY_BUFFER_BINDING => Answer::ints([c.secondary.buffer.0]),
            gl::FOG_COORD_ARRAY_BUFFER_BINDING => Answer::ints([c.fog_coord.buffer.0]),
            gl::INDEX_ARRAY_BUFFER_BINDING => Answer::ints([c.index.buffer.0]),
            gl::EDGE_FLAG_ARRAY_BUFFER_BINDING => Answer::ints([c.edge_flag.buffer.0]),
            gl::TEXTURE_COORD_ARRAY_BUFFER_BINDING => Answer::ints([coords.buffer.0]),
            _ => return None,
        })
    }

    /// What there is at most.
    fn limit_answer(&self, name: Enum) -> Option<Answer> {
        Some(match name {
            gl::MAX_LIGHTS => Answer::int(LIGHTS),
            gl::MAX_CLIP_PLANES => Answer::int(CLIP_PLANES),
            gl::MAX_MODELVIEW_STACK_DEPTH => Answer::int(context::MODELVIEW_DEPTH),
            gl::MAX_PROJECTION_STACK_DEPTH => Answer::int(context::PROJECTION_DEPTH),
            gl::MAX_TEXTURE_STACK_DEPTH => Answer::int(context::TEXTURE_DEPTH),
            gl::MAX_ATTRIB_STACK_DEPTH => Answer::int(attrib::MAX_ATTRIB_STACK_DEPTH),
            gl::MAX_CLIENT_ATTRIB_STACK_DEPTH => Answer::int(attrib::MAX_CLIENT_ATTRIB_STACK_DEPTH),
            gl::MAX_NAME_STACK_DEPTH => Answer::int(select::MAX_NAME_STACK_DEPTH),
            gl::MAX_LIST_NESTING => Answer::int(list::MAX_LIST_NESTING),
            gl::MAX_EVAL_ORDER => Answer::int(MAX_ORDER),
            gl::MAX_PIXEL_MAP_TABLE => Answer::int(crate::pixel::MAX_PIXEL_MAP_TABLE),
            gl::MAX_TEXTURE_UNITS => Answer::int(TEXTURE_UNITS),
            gl::MAX_TEXTURE_LOD_BIAS => Answer::floats([16.0f32]),
            gl::MAX_VIEWPORT_DIMS => Answer::ints([senca_raster::MAX_TARGET_SIDE; 2]),
            gl::MAX_ELEMENTS_VERTICES | gl::MAX_ELEMENTS_INDICES => Answer::int(1 << 20),
            gl::SUBPIXEL_BITS => Answer::int(8),
            gl::POINT_SIZE_RANGE | gl::ALIASED_POINT_SIZE_RANGE => {
                Answer::floats([1.0, raster_state::MAX_POINT_SIZE])
            }
            gl::POINT_SIZE_GRANULARITY | gl::LINE_WIDTH_GRANULARITY => Answer::floats([0.125f32]),
            gl::LINE_WIDTH_RANGE | gl::ALIASED_LINE_WIDTH_RANGE => {
                Answer::floats([1.0, raster_state::MAX_LINE_WIDTH])
            }
            gl::MAX_DEBUG_MESSAGE_LENGTH => Answer::int(debug::MAX_MESSAGE),
            gl::MAX_DEBUG_LOGGED_MESSAGES => Answer::int(debug::MAX_LOGGED),
            gl::MAX_DEBUG_GROUP_STACK_DEPTH => Answer::int(debug::MAX_GROUPS),
            gl::MAX_LABEL_LENGTH => Answer::int(debug::MAX_LABEL),
            gl::RGBA_MODE => Answer::bools([true]),
            gl::INDEX_MODE | gl::STEREO => Answer::bools([false]),
            gl::DOUBLEBUFFER => Answer::bools([self.config.double_buffered]),
            gl::AUX_BUFFERS | gl::INDEX_BITS => Answer::int(0),
            gl::CONTEXT_FLAGS => Answer::int(0),
            _ => return None,
        })
    }

    /// `glGetString`: `VENDOR`, `RENDERER`, `VERSION`, `EXTENSIONS`; `None` for another name.
    pub fn get_string(&mut self, name: Enum) -> Option<&'static str> {
        self.ask(|c| match name {
            gl::VENDOR => Some("Senca"),
            gl::RENDERER => Some("Senca software rasterizer"),
            gl::VERSION => Some(concat!("1.5 Senca ", env!("CARGO_PKG_VERSION"))),
            gl::EXTENSIONS => Some(extensions()),
            _ => {
                c.error(gl::INVALID_ENUM);
                None
            }
        })
    }

    /// `glGetLight`.
    pub fn get_light(&mut self, light: Enum, name: Enum) -> Values<f32> {
        self.found(|c| {
            let light = c.state.lighting.lights.get(light.wrapping_sub(gl::LIGHT0) as usize)?;
            light_answer(light, name)
        })
        .map(|a| a.values.iter().map(|v| *v as f32).collect())
        .unwrap_or_default()
    }

    /// `glGetLightiv`: colours fill the range of the integers.
    pub fn get_light_integer(&mut self, light: Enum, name: Enum) -> Values<i32> {
        self.found(|c| {
            let light = c.state.lighting.lights.get(light.wrapping_sub(gl::LIGHT0) as usize)?;
            light_answer(light, name)
        })
        .map(|a| a.integers())
        .unwrap_or_default()
    }

    /// `glGetMaterial` of `FRONT` or `BACK`.
    pub fn get_material(&mut self, face: Enum, name: Enum) -> Values<f32> {
        self.material_answer(face, name)
            .map(|a| a.values.iter().map(|v| *v as f32).collect())
            .unwrap_or_default()
    }

    /// `glGetMaterialiv`: colours fill the range of the integers.
    pub fn get_material_integer(&mut self, face: Enum, name: Enum) -> Values<i32> {
        self.material_answer(face, name).map(|a| a.integers()).unwrap_or_default()
    }

    fn material_answer(&mut self, face: Enum, name: Enum) -> Option<Answer> {
        self.settle_color_material();
        self.found(|c| {
            let side = [gl::FRONT, gl::BACK].iter().position(|f| *f == face)?;
            material_of(&c.state.lighting.materials[side], name)
        })
    }

    /// `glGetClipPlane`, in eye coordinates.
    pub fn get_clip_plane(&mut self, plane: Enum) -> Option<[f64; 4]> {
        self.found(|c| {
            c.state.transform.clip_planes.get(plane.wrapping_sub(gl::CLIP_PLANE0) as usize).copied()
        })
    }

    /// `glGetTexEnv`, of the active unit.
    pub fn get_tex_env(&mut self, target: Enum, name: Enum) -> Values<f32> {
        self.tex_env_answer(target, name)
            .map(|a| a.values.iter().map(|v| *v as f32).collect())
            .unwrap_or_default()
    }

    /// `glGetTexEnviv`: the colour fills the range of the integers.
    pub fn get_tex_env_integer(&mut self, target: Enum, name: Enum) -> Values<i32> {
        self.tex_env_answer(target, name).map(|a| a.integers()).unwrap_or_default()
    }

    fn tex_env_answer(&mut self, target: Enum, name: Enum) -> Option<Answer> {
        self.found(|c| {
            let env = &c.state.texturing.units[c.state.texturing.active].env;
            if target == gl::TEXTURE_FILTER_CONTROL {
                return (name == gl::TEXTURE_LOD_BIAS).then(|| Answer::floats([env.lod_bias]));
            }
            if target != gl::TEXTURE_ENV {
                return None;
            }
            Some(match name {
                gl::TEXTURE_ENV_MODE => Answer::token(env.mode),
                gl::TEXTURE_ENV_COLOR => Answer::normalized(env.color),
                gl::COMBINE_RGB => Answer::token(env.combine_rgb),
                gl::COMBINE_ALPHA => Answer::token(env.combine_alpha),
                gl::SRC0_RGB..=gl::SRC2_RGB => Answer::token(env.source_rgb[(name - gl::SRC0_RGB) as usize]),
                gl::SRC0_ALPHA..=gl::SRC2_ALPHA => {
                    Answer::token(env.source_alpha[(name - gl::SRC0_ALPHA) as usize])
                }
                gl::OPERAND0_RGB..=gl::OPERAND2_RGB => {
                    Answer::token(env.operand_rgb[(name - gl::OPERAND0_RGB) as usize])
                }
                gl::OPERAND0_ALPHA..=gl::OPERAND2_ALPHA => {
                    Answer::token(env.operand_alpha[(name - gl::OPERAND0_ALPHA) as usize])
                }
                gl::RGB_SCALE => Answer::floats([env.rgb_scale]),
                gl::ALPHA_SCALE => Answer::floats([env.alpha_scale]),
                _ => return None,
            })
        })
    }

    /// `glGetTexGen` of `S`, `T`, `R` or `Q`, of the active unit; eye planes in eye coordinates.
    pub fn get_tex_gen(&mut self, coordinate: Enum, name: Enum) -> Values<f64> {
        self.found(|c| {
            let unit = &c.state.texturing.units[c.state.texturing.active];
            let g = unit.generation.get(coordinate.wrapping_sub(gl::S) as usize)?;
            Some(match name {
                gl::TEXTURE_GEN_MODE => Answer::token(g.mode),
                gl::OBJECT_PLANE => Answer::floats(g.object_plane),
                gl::EYE_PLANE => Answer::floats(g.eye_plane),
                _ => return None,
            })
        })
        .map(|a| a.numbers())
        .unwrap_or_default()
    }

    /// `glGetMap` of `MAP1_...` or `MAP2_...`: `COEFF`, `ORDER` or `DOMAIN`.
    pub fn get_map(&mut self, target: Enum, name: Enum) -> Vec<f64> {
        self.found(|c| {
            let e = &c.state.eval;
            let (map, surface) = match target_of(target, gl::MAP1_COLOR_4) {
                Some(k) => (&e.curves[k], false),
                None => (&e.surfaces[target_of(target, gl::MAP2_COLOR_4)?], true),
            };
            let axes = if surface { 2 } else { 1 };
            Some(match name {
                gl::COEFF => map.points.iter().map(|v| f64::from(*v)).collect(),
                gl::ORDER => map.order[..axes].iter().map(|v| *v as f64).collect(),
                gl::DOMAIN => map.domain[..axes].iter().flatten().map(|v| f64::from(*v)).collect(),
                _ => return None,
            })
        })
        .unwrap_or_default()
    }

    /// `glGetPointer`: the address or offset an array was given; `None` for an unknown name.
    pub fn get_pointer(&mut self, name: Enum) -> Option<usize> {
        self.found(|c| {
            let array = match name {
                gl::VERTEX_ARRAY_POINTER => gl::VERTEX_ARRAY,
                gl::NORMAL_ARRAY_POINTER => gl::NORMAL_ARRAY,
                gl::COLOR_ARRAY_POINTER => gl::COLOR_ARRAY,
                gl::SECONDARY_COLOR_ARRAY_POINTER => gl::SECONDARY_COLOR_ARRAY,
                gl::FOG_COORD_ARRAY_POINTER => gl::FOG_COORD_ARRAY,
                gl::INDEX_ARRAY_POINTER => gl::INDEX_ARRAY,
                gl::EDGE_FLAG_ARRAY_POINTER => gl::EDGE_FLAG_ARRAY,
                gl::TEXTURE_COORD_ARRAY_POINTER => gl::TEXTURE_COORD_ARRAY,
                _ => return None,
            };
            c.client.array(array).map(crate::arrays::VertexArray::pointer)
        })
    }

    /// `glGetPolygonStipple`: the rows from the bottom, the most significant bit left; `None` in case of error.
    pub fn get_polygon_stipple(&mut self) -> Option<[u32; 32]> {
        self.found(|c| Some(c.state.polygon_stipple.0))
    }

    /// An answer, or `INVALID_ENUM`.
    fn found<R>(&mut self, find: impl FnOnce(&Self) -> Option<R>) -> Option<R> {
        self.ask(|c| {
            let answer = find(c);
            if answer.is_none() {
                c.error(gl::INVALID_ENUM);
            }
            answer
        })
    }
}

fn light_answer(light: &Light, name: Enum) -> Option<Answer> {
    Some(match name {
        gl::AMBIENT => Answer::normalized(light.ambient),
        gl::DIFFUSE => Answer::normalized(light.diffuse),
        gl::SPECULAR => Answer::normalized(light.specular),
        gl::POSITION => Answer::floats(light.position),
        gl::SPOT_DIRECTION => Answer::floats(light.spot_direction),
        gl::SPOT_EXPONENT => Answer::floats([light.spot_exponent]),
        gl::SPOT_CUTOFF => Answer::floats([light.spot_cutoff]),
        gl::CONSTANT_ATTENUATION => Answer::floats([light.attenuation[0]]),
        gl::LINEAR_ATTENUATION => Answer::floats([light.attenuation[1]]),
        gl::QUADRATIC_ATTENUATION => Answer::floats([light.attenuation[2]]),
        _ => return None,
    })
}

fn material_of(material: &Material, name: Enum) -> Option<Answer> {
    Some(match name {
        gl::AMBIENT => Answer::normalized(material.ambient),
        gl::DIFFUSE => Answer::normalized(material.diffuse),
        gl::SPECULAR => Answer::normalized(material.specular),
        gl::EMISSION => Answer::normalized(material.emission),
        gl::SHININESS => Answer::floats([material.shininess]),
        gl::COLOR_INDEXES => Answer::floats(material.indexes),
        _ => return None,
    })
}

fn extensions() -> &'static str {
    static ALL: std::sync::OnceLock<String> = std::sync::OnceLock::new();
    ALL.get_or_init(|| EXTENSIONS.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    /// The course text's queries, section 5.1.
    #[test]
    fn the_queries_of_the_text() {
        let mut c = Context::new(Config::default());
        assert_eq!(c.get_boolean(gl::DEPTH_TEST)[..], [false]);
        assert_eq!(c.get_boolean(gl::LIGHTING)[..], [false]);
        assert!(c.get_integer(gl::MAX_LIGHTS)[0] >= 8);
        assert_eq!(c.get_float(gl::LINE_WIDTH)[..], [1.0]);
        let range = c.get_float(gl::LINE_WIDTH_RANGE);
        assert!(range[0] <= 1.0 && range[1] > 1.0);
        assert_eq!(c.get_float(gl::CURRENT_COLOR)[..], [1.0; 4]);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    #[test]
    fn answers_become_any_type() {
        let mut c = Context::new(Config::default());
        c.color([1.0, 0.0, -1.0, 0.5]);
        assert_eq!(c.get_integer(gl::CURRENT_COLOR)[..3], [i32::MAX, 0, i32::MIN]);
        assert_eq!(c.get_boolean(gl::CURRENT_COLOR)[..], [true, false, true, true]);
        c.line_width(2.6);
        assert_eq!(c.get_integer(gl::LINE_WIDTH)[..], [3]);
        assert_eq!(c.get_integer(gl::STENCIL_WRITEMASK)[..], [-1]);
        assert_eq!(c.get_float(gl::BLEND)[..], [0.0]);
        assert!(c.get_integer(0xffff_ffff).is_empty());
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
    }

    #[test]
    fn defaults_are_those_of_the_text() {
        let mut c = Context::new(Config::default());
        assert_eq!(c.get_light(gl::LIGHT0, gl::DIFFUSE)[..], [1.0; 4]);
        assert_eq!(c.get_light(gl::LIGHT1, gl::DIFFUSE)[..], [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(c.get_light(gl::LIGHT0, gl::SPOT_CUTOFF)[..], [180.0]);
        assert_eq!(c.get_material(gl::FRONT, gl::AMBIENT)[..], [0.2, 0.2, 0.2, 1.0]);
        assert_eq!(c.get_material(gl::BACK, gl::DIFFUSE)[..], [0.8, 0.8, 0.8, 1.0]);
        assert_eq!(c.get_float(gl::CURRENT_RASTER_POSITION)[..], [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(c.get_integer(gl::CULL_FACE_MODE)[..], [gl::BACK as i32]);
        assert_eq!(c.get_integer(gl::RENDER_MODE)[..], [gl::RENDER as i32]);
        assert_eq!(c.get_tex_env(gl::TEXTURE_ENV, gl::TEXTURE_ENV_MODE)[..], [gl::MODULATE as f32]);
        assert_eq!(c.get_tex_gen(gl::T, gl::EYE_PLANE)[..], [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(c.get_map(gl::MAP1_COLOR_4, gl::COEFF), [1.0; 4]);
        assert!(c.get_string(gl::VERSION).is_some_and(|v| v.starts_with("1.5")));
    }
}
