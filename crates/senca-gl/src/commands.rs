//! Commands that set state and do nothing else, except those of matrices, pixels and textures.

use crate::state::{CLIP_PLANES, Cap, LIGHTS, TEXTURE_UNITS, TexTarget, cap_of};
use crate::{Context, Enum, gl};
use senca_math::glam::{Mat3, Mat4, Vec3, Vec4};

/// Whether a name is one of a comparison.
pub(crate) fn is_comparison(func: Enum) -> bool {
    (gl::NEVER..=gl::ALWAYS).contains(&func)
}

fn is_face(face: Enum) -> bool {
    matches!(face, gl::FRONT | gl::BACK | gl::FRONT_AND_BACK)
}

fn is_blend_factor(factor: Enum, source: bool) -> bool {
    match factor {
        gl::ZERO | gl::ONE => true,
        gl::SRC_COLOR..=gl::ONE_MINUS_DST_COLOR => true,
        gl::CONSTANT_COLOR..=gl::ONE_MINUS_CONSTANT_ALPHA => true,
        gl::SRC_ALPHA_SATURATE => source,
        _ => false,
    }
}

fn is_blend_equation(equation: Enum) -> bool {
    matches!(equation, gl::FUNC_ADD | gl::FUNC_SUBTRACT | gl::FUNC_REVERSE_SUBTRACT | gl::MIN | gl::MAX)
}

/// Whether a light's or material's value is within its range.
fn in_range(value: f32, low: f32, high: f32) -> bool {
    (low..=high).contains(&value)
}

impl Context {
    /// `glEnable`.
    pub fn enable(&mut self, cap: Enum) {
        self.submit(move |c| c.set_enabled(cap, true));
    }

    /// `glDisable`.
    pub fn disable(&mut self, cap: Enum) {
        self.submit(move |c| c.set_enabled(cap, false));
    }

    pub(crate) fn set_enabled(&mut self, cap: Enum, on: bool) {
        if let Some((bit, n)) = cap_of(cap) {
            if self.state.enabled.has_nth(bit, n) == on {
                return;
            }
            if bit == Cap::ColorMaterial {
                self.settle_color_material();
            }
            self.state.enabled.set(bit, n, on);
            return self.touch();
        }
        let unit = &mut self.state.texturing.units[self.state.texturing.active];
        if let Some(target) = TexTarget::of(cap) {
            unit.enabled[target as usize] = on;
        } else if (gl::TEXTURE_GEN_S..=gl::TEXTURE_GEN_Q).contains(&cap) {
            unit.generation[(cap - gl::TEXTURE_GEN_S) as usize].enabled = on;
        } else if let Some(array) = self.client.array_mut(cap) {
            // Meant for `enable_client_state`; programs rely on it here too.
            array.enabled = on;
        } else {
            return self.error(gl::INVALID_ENUM);
        }
        self.touch();
    }

    /// `glIsEnabled`.
    pub fn is_enabled(&mut self, cap: Enum) -> bool {
        self.ask(|c| match c.enabled(cap) {
            Some(on) => on,
            None => {
                c.error(gl::INVALID_ENUM);
                false
            }
        })
    }

    pub(crate) fn enabled(&self, cap: Enum) -> Option<bool> {
        if let Some((bit, n)) = cap_of(cap) {
            return Some(self.state.enabled.has_nth(bit, n));
        }
        let unit = &self.state.texturing.units[self.state.texturing.active];
        match cap {
            gl::TEXTURE_GEN_S..=gl::TEXTURE_GEN_Q => {
                Some(unit.generation[(cap - gl::TEXTURE_GEN_S) as usize].enabled)
            }
            gl::VERTEX_ARRAY..=gl::EDGE_FLAG_ARRAY | gl::FOG_COORD_ARRAY | gl::SECONDARY_COLOR_ARRAY => {
                self.client.enabled(cap)
            }
            _ => TexTarget::of(cap).map(|t| unit.enabled[t as usize]),
        }
    }

    /// Sets what drawing depends on: `valid` or the error, then `set`.
    fn raster(
        &mut self,
        error: Option<Enum>,
        set: impl Fn(&mut crate::state::State) + Send + Sync + 'static,
    ) {
        self.submit(move |c| match error {
            Some(error) => c.error(error),
            None => {
                set(&mut c.state);
                c.touch();
            }
        });
    }

    /// `glShadeModel`: `FLAT` or `SMOOTH`.
    pub fn shade_model(&mut self, mode: Enum) {
        let valid = matches!(mode, gl::FLAT | gl::SMOOTH);
        self.raster(invalid_enum(valid), move |s| s.lighting.shade_model = mode);
    }

    /// `glPointSize`.
    pub fn point_size(&mut self, size: f32) {
        self.raster(invalid_value(size > 0.0), move |s| s.point.size = size);
    }

    /// `glPointParameter`, one value or, for `POINT_DISTANCE_ATTENUATION`, three.
    pub fn point_parameter(&mut self, name: Enum, values: &[f32]) {
        let v: [f32; 3] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let error = match name {
            gl::POINT_DISTANCE_ATTENUATION if values.len() >= 3 => None,
            gl::POINT_SIZE_MIN | gl::POINT_SIZE_MAX | gl::POINT_FADE_THRESHOLD_SIZE => {
                invalid_value(v[0] >= 0.0)
            }
            _ => Some(gl::INVALID_ENUM),
        };
        self.raster(error, move |s| match name {
            gl::POINT_DISTANCE_ATTENUATION => s.point.attenuation = v,
            gl::POINT_SIZE_MIN => s.point.min = v[0],
            gl::POINT_SIZE_MAX => s.point.max = v[0],
            _ => s.point.fade_threshold = v[0],
        });
    }

    /// `glLineWidth`.
    pub fn line_width(&mut self, width: f32) {
        self.raster(invalid_value(width > 0.0), move |s| s.line.width = width);
    }

    /// `glLineStipple`: 16 bits, the lowest first, each for `factor` fragments (1 to 256).
    pub fn line_stipple(&mut self, factor: i32, pattern: u16) {
        self.raster(None, move |s| {
            s.line.stipple_factor = factor.clamp(1, 256) as u32;
            s.line.stipple_pattern = pattern;
        });
    }

    /// `glCullFace`.
    pub fn cull_face(&mut self, face: Enum) {
        self.raster(invalid_enum(is_face(face)), move |s| s.polygon.cull_face = face);
    }

    /// `glFrontFace`: `CCW` or `CW`.
    pub fn front_face(&mut self, face: Enum) {
        let valid = matches!(face, gl::CW | gl::CCW);
        self.raster(invalid_enum(valid), move |s| s.polygon.front_face = face);
    }

    /// `glPolygonMode`: `POINT`, `LINE` or `FILL` for a side or both.
    pub fn polygon_mode(&mut self, face: Enum, mode: Enum) {
        let valid = is_face(face) && matches!(mode, gl::POINT | gl::LINE | gl::FILL);
        self.raster(invalid_enum(valid), move |s| {
            for (side, name) in [gl::FRONT, gl::BACK].into_iter().enumerate() {
                if face == name || face == gl::FRONT_AND_BACK {
                    s.polygon.mode[side] = mode;
                }
            }
        });
    }

    /// `glPolygonOffset`.
    pub fn polygon_offset(&mut self, factor: f32, units: f32) {
        self.raster(None, move |s| {
            s.polygon.offset_factor = factor;
            s.polygon.offset_units = units;
        });
    }

    /// The stipple of polygons: 32 rows from the bottom, the most significant bit left.
    pub(crate) fn set_polygon_stipple(&mut self, rows: [u32; 32]) {
        self.raster(None, move |s| s.polygon_stipple.0 = rows);
    }

    /// `glColorMaterial`.
    pub fn color_material(&mut self, face: Enum, mode: Enum) {
        self.submit(move |c| {
            let valid = is_face(face)
                && matches!(
                    mode,
                    gl::EMISSION | gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR | gl::AMBIENT_AND_DIFFUSE
                );
            if !valid {
                return c.error(gl::INVALID_ENUM);
            }
            c.settle_color_material();
            let l = &mut c.state.lighting;
            (l.color_material_face, l.color_material_mode) = (face, mode);
            c.touch_vertices();
        });
    }

    /// `glMaterial`: a property of a side or both, one value to four. May stand between `begin` and `end`.
    pub fn material(&mut self, face: Enum, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let count = values.len();
        self.submit_anywhere(move |c| c.set_material(face, name, v, count));
    }

    fn set_material(&mut self, face: Enum, name: Enum, v: [f32; 4], count: usize) {
        let wanted = match name {
            gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR | gl::EMISSION | gl::AMBIENT_AND_DIFFUSE => 4,
            gl::COLOR_INDEXES => 3,
            gl::SHININESS => 1,
            _ => return self.error(gl::INVALID_ENUM),
        };
        if !is_face(face) || count < wanted {
            return self.error(gl::INVALID_ENUM);
        }
        if name == gl::SHININESS && !in_range(v[0], 0.0, 128.0) {
            return self.error(gl::INVALID_VALUE);
        }
        self.before_material();
        for (side, of) in [gl::FRONT, gl::BACK].into_iter().enumerate() {
            if face != of && face != gl::FRONT_AND_BACK {
                continue;
            }
            let material = &mut self.state.lighting.materials[side];
            match name {
                gl::SHININESS => material.shininess = v[0],
                gl::COLOR_INDEXES => material.indexes = [v[0], v[1], v[2]],
                _ => material.track(name, v),
            }
        }
        // What follows the current colour goes on to follow it.
        self.settle_color_material();
        self.after_material();
    }

    /// `glLight`: a property of light `LIGHT0` to `LIGHT7`, one value to four. Positions and directions are taken
    /// through the modelview matrix as it is now.
    pub fn light(&mut self, light: Enum, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let count = values.len();
        self.submit(move |c| c.set_light(light, name, v, count));
    }

    fn set_light(&mut self, light: Enum, name: Enum, v: [f32; 4], count: usize) {
        let number = light.wrapping_sub(gl::LIGHT0) as usize;
        let wanted = match name {
            gl::AMBIENT | gl::DIFFUSE | gl::SPECULAR | gl::POSITION => 4,
            gl::SPOT_DIRECTION => 3,
            gl::SPOT_EXPONENT
            | gl::SPOT_CUTOFF
            | gl::CONSTANT_ATTENUATION
            | gl::LINEAR_ATTENUATION
            | gl::QUADRATIC_ATTENUATION => 1,
            _ => return self.error(gl::INVALID_ENUM),
        };
        if number >= LIGHTS || count < wanted {
            return self.error(gl::INVALID_ENUM);
        }
        let valid = match name {
            gl::SPOT_EXPONENT => in_range(v[0], 0.0, 128.0),
            gl::SPOT_CUTOFF => in_range(v[0], 0.0, 90.0) || v[0] == 180.0,
            gl::CONSTANT_ATTENUATION | gl::LINEAR_ATTENUATION | gl::QUADRATIC_ATTENUATION => v[0] >= 0.0,
            _ => true,
        };
        if !valid {
            return self.error(gl::INVALID_VALUE);
        }
        let modelview = self.modelview.top();
        let light = &mut self.state.lighting.lights[number];
        match name {
            gl::AMBIENT => light.ambient = v,
            gl::DIFFUSE => light.diffuse = v,
            gl::SPECULAR => light.specular = v,
            gl::POSITION => light.position = (modelview * Vec4::from(v)).to_array(),
            gl::SPOT_DIRECTION => {
                light.spot_direction = (Mat3::from_mat4(modelview) * Vec3::new(v[0], v[1], v[2])).to_array();
            }
            gl::SPOT_EXPONENT => light.spot_exponent = v[0],
            gl::SPOT_CUTOFF => light.spot_cutoff = v[0],
            gl::CONSTANT_ATTENUATION => light.attenuation[0] = v[0],
            gl::LINEAR_ATTENUATION => light.attenuation[1] = v[0],
            _ => light.attenuation[2] = v[0],
        }
        self.touch_vertices();
    }

    /// `glLightModel`: one value, or four for `LIGHT_MODEL_AMBIENT`.
    pub fn light_model(&mut self, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let error = match name {
            gl::LIGHT_MODEL_AMBIENT => invalid_enum(values.len() >= 4),
            gl::LIGHT_MODEL_LOCAL_VIEWER | gl::LIGHT_MODEL_TWO_SIDE => invalid_enum(!values.is_empty()),
            gl::LIGHT_MODEL_COLOR_CONTROL => {
                invalid_enum(matches!(v[0] as Enum, gl::SINGLE_COLOR | gl::SEPARATE_SPECULAR_COLOR))
            }
            _ => Some(gl::INVALID_ENUM),
        };
        self.raster(error, move |s| match name {
            gl::LIGHT_MODEL_AMBIENT => s.lighting.model_ambient = v,
            gl::LIGHT_MODEL_LOCAL_VIEWER => s.lighting.local_viewer = v[0] != 0.0,
            gl::LIGHT_MODEL_TWO_SIDE => s.lighting.two_side = v[0] != 0.0,
            _ => s.lighting.color_control = v[0] as Enum,
        });
    }

    /// `glFog`: one value, or four for `FOG_COLOR`.
    pub fn fog(&mut self, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let token = v[0] as Enum;
        let error = match name {
            gl::FOG_MODE => invalid_enum(matches!(token, gl::LINEAR | gl::EXP | gl::EXP2)),
            gl::FOG_DENSITY => invalid_value(v[0] >= 0.0),
            gl::FOG_COORD_SRC => invalid_enum(matches!(token, gl::FOG_COORD | gl::FRAGMENT_DEPTH)),
            gl::FOG_COLOR => invalid_enum(values.len() >= 4),
            gl::FOG_START | gl::FOG_END | gl::FOG_INDEX => None,
            _ => Some(gl::INVALID_ENUM),
        };
        self.raster(error, move |s| match name {
            gl::FOG_MODE => s.fog.mode = token,
            gl::FOG_DENSITY => s.fog.density = v[0],
            gl::FOG_START => s.fog.start = v[0],
            gl::FOG_END => s.fog.end = v[0],
            gl::FOG_INDEX => s.fog.index = v[0],
            gl::FOG_COORD_SRC => s.fog.coord_src = token,
            _ => s.fog.color = v.map(crate::vertex::clamp01),
        });
    }

    /// `glAlphaFunc`.
    pub fn alpha_func(&mut self, func: Enum, reference: f32) {
        self.raster(invalid_enum(is_comparison(func)), move |s| {
            (s.color.alpha_func, s.color.alpha_ref) = (func, crate::vertex::clamp01(reference));
        });
    }

    /// `glBlendFunc`.
    pub fn blend_func(&mut self, source: Enum, destination: Enum) {
        self.blend_func_separate(source, destination, source, destination);
    }

    /// `glBlendFuncSeparate`.
    pub fn blend_func_separate(
        &mut self,
        source: Enum,
        destination: Enum,
        source_alpha: Enum,
        destination_alpha: Enum,
    ) {
        let factors = [source, destination, source_alpha, destination_alpha];
        let valid = factors.iter().enumerate().all(|(k, f)| is_blend_factor(*f, k % 2 == 0));
        self.raster(invalid_enum(valid), move |s| s.color.blend_func = factors);
    }

    /// `glBlendEquation`.
    pub fn blend_equation(&mut self, equation: Enum) {
        self.blend_equation_separate(equation, equation);
    }

    /// `glBlendEquationSeparate`.
    pub fn blend_equation_separate(&mut self, color: Enum, alpha: Enum) {
        let valid = is_blend_equation(color) && is_blend_equation(alpha);
        self.raster(invalid_enum(valid), move |s| s.color.blend_equation = [color, alpha]);
    }

    /// `glBlendColor`.
    pub fn blend_color(&mut self, color: [f32; 4]) {
        self.raster(None, move |s| s.color.blend_color = color.map(crate::vertex::clamp01));
    }

    /// `glLogicOp`.
    pub fn logic_op(&mut self, op: Enum) {
        let valid = (gl::CLEAR..=gl::SET).contains(&op);
        self.raster(invalid_enum(valid), move |s| s.color.logic_op = op);
    }

    /// `glColorMask`.
    pub fn color_mask(&mut self, mask: [bool; 4]) {
        self.raster(None, move |s| s.color.mask = mask);
    }

    /// `glIndexMask`, which is remembered only.
    pub fn index_mask(&mut self, mask: u32) {
        self.raster(None, move |s| s.color.index_mask = mask);
    }

    /// `glDepthFunc`.
    pub fn depth_func(&mut self, func: Enum) {
        self.raster(invalid_enum(is_comparison(func)), move |s| s.depth.func = func);
    }

    /// `glDepthMask`.
    pub fn depth_mask(&mut self, mask: bool) {
        self.raster(None, move |s| s.depth.mask = mask);
    }

    /// `glDepthRange`, within 0 to 1.
    pub fn depth_range(&mut self, near: f64, far: f64) {
        self.raster(None, move |s| {
            (s.viewport.near, s.viewport.far) = (near.clamp(0.0, 1.0), far.clamp(0.0, 1.0));
        });
    }

    /// `glStencilFunc`.
    pub fn stencil_func(&mut self, func: Enum, reference: i32, mask: u32) {
        self.raster(invalid_enum(is_comparison(func)), move |s| {
            (s.stencil.func, s.stencil.reference, s.stencil.value_mask) = (func, reference, mask);
        });
    }

    /// `glStencilOp`: when the stencil test fails, when the depth test fails, when both pass.
    pub fn stencil_op(&mut self, fail: Enum, depth_fail: Enum, depth_pass: Enum) {
        let valid = [fail, depth_fail, depth_pass].iter().all(|op| {
            matches!(
                *op,
                gl::KEEP
                    | gl::ZERO
                    | gl::REPLACE
                    | gl::INCR
                    | gl::DECR
                    | gl::INVERT
                    | gl::INCR_WRAP
                    | gl::DECR_WRAP
            )
        });
        self.raster(invalid_enum(valid), move |s| {
            (s.stencil.fail, s.stencil.depth_fail, s.stencil.depth_pass) = (fail, depth_fail, depth_pass);
        });
    }

    /// `glStencilMask`.
    pub fn stencil_mask(&mut self, mask: u32) {
        self.raster(None, move |s| s.stencil.write_mask = mask);
    }

    /// `glClearColor`.
    pub fn clear_color(&mut self, color: [f32; 4]) {
        self.submit(move |c| c.state.color.clear_color = color.map(crate::vertex::clamp01));
    }

    /// `glClearIndex`, which is remembered only.
    pub fn clear_index(&mut self, index: f32) {
        self.submit(move |c| c.state.color.clear_index = index);
    }

    /// `glClearDepth`.
    pub fn clear_depth(&mut self, depth: f64) {
        self.submit(move |c| c.state.depth.clear = depth.clamp(0.0, 1.0));
    }

    /// `glClearStencil`.
    pub fn clear_stencil(&mut self, value: i32) {
        self.submit(move |c| c.state.stencil.clear = value);
    }

    /// `glClearAccum`.
    pub fn clear_accum(&mut self, value: [f32; 4]) {
        self.submit(move |c| c.state.accum.clear = value.map(|v| v.clamp(-1.0, 1.0)));
    }

    /// `glViewport`.
    pub fn viewport(&mut self, x: i32, y: i32, width: i32, height: i32) {
        let largest = senca_raster::MAX_TARGET_SIDE as i32;
        self.raster(invalid_value(width >= 0 && height >= 0), move |s| {
            s.viewport.rect = [x, y, width.min(largest), height.min(largest)];
        });
    }

    /// `glScissor`.
    pub fn scissor(&mut self, x: i32, y: i32, width: i32, height: i32) {
        self.raster(invalid_value(width >= 0 && height >= 0), move |s| s.scissor = [x, y, width, height]);
    }

    /// `glClipPlane`: the half-space that stays, in object coordinates.
    pub fn clip_plane(&mut self, plane: Enum, equation: [f64; 4]) {
        self.submit(move |c| {
            let number = plane.wrapping_sub(gl::CLIP_PLANE0) as usize;
            if number >= CLIP_PLANES {
                return c.error(gl::INVALID_ENUM);
            }
            let inverse = c.modelview.top().as_dmat4().inverse();
            let eye = inverse.transpose() * senca_math::glam::DVec4::from(equation);
            c.state.transform.clip_planes[number] = eye.to_array();
            c.touch_vertices();
        });
    }

    /// `glClipControl`: where the origin of the window and the depths of clip space are.
    pub fn clip_control(&mut self, origin: Enum, depth: Enum) {
        let valid = matches!(origin, gl::LOWER_LEFT | gl::UPPER_LEFT)
            && matches!(depth, gl::NEGATIVE_ONE_TO_ONE | gl::ZERO_TO_ONE);
        self.raster(invalid_enum(valid), move |s| {
            (s.transform.clip_origin, s.transform.clip_depth) = (origin, depth);
        });
    }

    /// `glSampleCoverage`.
    pub fn sample_coverage(&mut self, value: f32, invert: bool) {
        self.raster(None, move |s| {
            (s.multisample.coverage, s.multisample.invert) = (crate::vertex::clamp01(value), invert);
        });
    }

    /// `glHint`, which is remembered only.
    pub fn hint(&mut self, target: Enum, mode: Enum) {
        self.submit(move |c| {
            if !matches!(mode, gl::FASTEST | gl::NICEST | gl::DONT_CARE) {
                return c.error(gl::INVALID_ENUM);
            }
            let h = &mut c.state.hints;
            let hint = match target {
                gl::PERSPECTIVE_CORRECTION_HINT => &mut h.perspective_correction,
                gl::POINT_SMOOTH_HINT => &mut h.point_smooth,
                gl::LINE_SMOOTH_HINT => &mut h.line_smooth,
                gl::POLYGON_SMOOTH_HINT => &mut h.polygon_smooth,
                gl::FOG_HINT => &mut h.fog,
                gl::GENERATE_MIPMAP_HINT => &mut h.generate_mipmap,
                gl::TEXTURE_COMPRESSION_HINT => &mut h.texture_compression,
                _ => return c.error(gl::INVALID_ENUM),
            };
            *hint = mode;
        });
    }

    /// `glActiveTexture`: the unit that texture commands mean.
    pub fn active_texture(&mut self, unit: Enum) {
        self.submit(move |c| match unit.checked_sub(gl::TEXTURE0) {
            Some(k) if (k as usize) < TEXTURE_UNITS => c.state.texturing.active = k as usize,
            _ => c.error(gl::INVALID_ENUM),
        });
    }

    /// `glTexGen` of coordinate `S`, `T`, `R` or `Q`: one value for the mode, four for a plane.
    pub fn tex_gen(&mut self, coordinate: Enum, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let count = values.len();
        self.submit(move |c| {
            let k = coordinate.wrapping_sub(gl::S) as usize;
            if k >= 4 || (name != gl::TEXTURE_GEN_MODE && count < 4) {
                return c.error(gl::INVALID_ENUM);
            }
            let mode = v[0] as Enum;
            let valid = match (name, mode) {
                (gl::TEXTURE_GEN_MODE, gl::OBJECT_LINEAR | gl::EYE_LINEAR) => true,
                (gl::TEXTURE_GEN_MODE, gl::SPHERE_MAP) => k < 2,
                (gl::TEXTURE_GEN_MODE, gl::NORMAL_MAP | gl::REFLECTION_MAP) => k < 3,
                (gl::OBJECT_PLANE | gl::EYE_PLANE, _) => true,
                _ => false,
            };
            if !valid {
                return c.error(gl::INVALID_ENUM);
            }
            let inverse: Mat4 = c.modelview.top().inverse();
            let unit = c.state.texturing.active;
            let generation = &mut c.state.texturing.units[unit].generation[k];
            match name {
                gl::TEXTURE_GEN_MODE => generation.mode = mode,
                gl::OBJECT_PLANE => generation.object_plane = v,
                _ => generation.eye_plane = (inverse.transpose() * Vec4::from(v)).to_array(),
            }
            c.touch_vertices();
        });
    }

    /// `glTexEnv` of target `TEXTURE_ENV` or `TEXTURE_FILTER_CONTROL`: one value, four for `TEXTURE_ENV_COLOR`.
    pub fn tex_env(&mut self, target: Enum, name: Enum, values: &[f32]) {
        let v: [f32; 4] = std::array::from_fn(|k| values.get(k).copied().unwrap_or(0.0));
        let count = values.len();
        self.submit(move |c| {
            if let Err(error) = c.set_tex_env(target, name, v, count) {
                return c.error(error);
            }
            c.touch();
        });
    }

    fn set_tex_env(&mut self, target: Enum, name: Enum, v: [f32; 4], count: usize) -> Result<(), Enum> {
        let unit = self.state.texturing.active;
        let env = &mut self.state.texturing.units[unit].env;
        let token = v[0] as Enum;
        if target == gl::TEXTURE_FILTER_CONTROL && name == gl::TEXTURE_LOD_BIAS {
            env.lod_bias = v[0];
            return Ok(());
        }
        if target != gl::TEXTURE_ENV || count == 0 {
            return Err(gl::INVALID_ENUM);
        }
        let check = |valid: bool| if valid { Ok(token) } else { Err(gl::INVALID_ENUM) };
        let source = || {
            let units = gl::TEXTURE0..gl::TEXTURE0 + TEXTURE_UNITS as Enum;
            let named = matches!(token, gl::TEXTURE | gl::CONSTANT | gl::PRIMARY_COLOR | gl::PREVIOUS);
            check(named || units.contains(&token))
        };
        let scale = || if [1.0, 2.0, 4.0].contains(&v[0]) { Ok(v[0]) } else { Err(gl::INVALID_VALUE) };
        match name {
            gl::TEXTURE_ENV_MODE => {
                env.mode = check(matches!(
                    token,
                    gl::MODULATE | gl::REPLACE | gl::DECAL | gl::BLEND | gl::ADD | gl::COMBINE
                ))?;
            }
            gl::TEXTURE_ENV_COLOR if count >= 4 => env.color = v.map(crate::vertex::clamp01),
            gl::COMBINE_RGB => {
                let more =
                    matches!(token, gl::DOT3_RGB | gl::DOT3_RGBA | gl::DOT3_RGB_EXT | gl::DOT3_RGBA_EXT);
                env.combine_rgb = check(more || is_combination(token))?;
            }
            gl::COMBINE_ALPHA => env.combine_alpha = check(is_combination(token))?,
            gl::SRC0_RGB..=gl::SRC2_RGB => env.source_rgb[(name - gl::SRC0_RGB) as usize] = source()?,
            gl::SRC0_ALPHA..=gl::SRC2_ALPHA => {
                env.source_alpha[(name - gl::SRC0_ALPHA) as usize] = source()?;
            }
            gl::OPERAND0_RGB..=gl::OPERAND2_RGB => {
                let valid = (gl::SRC_COLOR..=gl::ONE_MINUS_SRC_ALPHA).contains(&token);
                env.operand_rgb[(name - gl::OPERAND0_RGB) as usize] = check(valid)?;
            }
            gl::OPERAND0_ALPHA..=gl::OPERAND2_ALPHA => {
                let valid = matches!(token, gl::SRC_ALPHA | gl::ONE_MINUS_SRC_ALPHA);
                env.operand_alpha[(name - gl::OPERAND0_ALPHA) as usize] = check(valid)?;
            }
            gl::RGB_SCALE => env.rgb_scale = scale()?,
            gl::ALPHA_SCALE => env.alpha_scale = scale()?,
            _ => return Err(gl::INVALID_ENUM),
        }
        Ok(())
    }
}

fn is_combination(token: Enum) -> bool {
    matches!(token, gl::REPLACE | gl::MODULATE | gl::ADD | gl::ADD_SIGNED | gl::INTERPOLATE | gl::SUBTRACT)
}

fn invalid_enum(valid: bool) -> Option<Enum> {
    (!valid).then_some(gl::INVALID_ENUM)
}

fn invalid_value(valid: bool) -> Option<Enum> {
    (!valid).then_some(gl::INVALID_VALUE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn an_error_leaves_the_state_and_is_told_once() {
        let mut c = Context::new(Config::default());
        c.depth_func(gl::GREATER);
        c.depth_func(gl::FRONT);
        c.line_width(-1.0);
        assert_eq!(c.state.depth.func, gl::GREATER);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        assert_eq!(c.get_error(), gl::NO_ERROR);
    }

    #[test]
    fn state_commands_are_errors_between_begin_and_end() {
        let mut c = Context::new(Config::default());
        assert!(c.resize(4, 4));
        c.begin(gl::TRIANGLES);
        c.enable(gl::BLEND);
        c.end();
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        assert!(!c.is_enabled(gl::BLEND));
    }

    #[test]
    fn lights_are_placed_by_the_modelview_matrix() {
        let mut c = Context::new(Config::default());
        c.translate([1.0, 2.0, 3.0]);
        c.light(gl::LIGHT1, gl::POSITION, &[1.0, 0.0, 0.0, 1.0]);
        c.light(gl::LIGHT2, gl::POSITION, &[1.0, 0.0, 0.0, 0.0]);
        assert_eq!(c.state.lighting.lights[1].position, [2.0, 2.0, 3.0, 1.0]);
        assert_eq!(c.state.lighting.lights[2].position, [1.0, 0.0, 0.0, 0.0]);
        c.light(gl::LIGHT0, gl::SPOT_CUTOFF, &[91.0]);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
    }

    #[test]
    fn materials_follow_the_colour_while_told_so() {
        let mut c = Context::new(Config::default());
        c.color_material(gl::FRONT, gl::DIFFUSE);
        c.enable(gl::COLOR_MATERIAL);
        c.color([0.25f32, 0.5, 0.75]);
        c.disable(gl::COLOR_MATERIAL);
        c.color([1.0f32, 1.0, 1.0]);
        assert_eq!(c.state.lighting.materials[0].diffuse, [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(c.state.lighting.materials[1].diffuse, [0.8, 0.8, 0.8, 1.0]);
    }
}
