//! State, attribute stacks, errors, queries of what was drawn.

use crate::memory::{In, Out};

commands! { COMMANDS, c:
    glEnable(cap: u32) { c.enable(cap) }
    glDisable(cap: u32) { c.disable(cap) }
    glIsEnabled(cap: u32) -> u8 { c.is_enabled(cap).into() }
    glGetError() -> u32 { c.get_error() }
    glFlush() {
        c.flush_for_show();
        c.present();
    }
    glFinish() {
        c.flush_for_show();
        c.present();
    }
    glHint(target: u32, mode: u32) { c.hint(target, mode) }
    glPushAttrib(mask: u32) { c.push_attrib(mask) }
    glPopAttrib() { c.pop_attrib() }
    glPushClientAttrib(mask: u32) { c.push_client_attrib(mask) }
    glPopClientAttrib() { c.pop_client_attrib() }

    glViewport(x: i32, y: i32, width: i32, height: i32) {
        c.look_at_window();
        c.viewport(x, y, width, height);
    }
    glScissor(x: i32, y: i32, width: i32, height: i32) { c.scissor(x, y, width, height) }
    glDepthRange(near: f64, far: f64) { c.depth_range(near, far) }
    glClipPlane(plane: u32, equation: In<f64>) {
        if let Some(equation) = equation.array() { c.clip_plane(plane, equation) }
    }
    glClipControl(origin: u32, depth: u32) { c.clip_control(origin, depth) }

    glShadeModel(mode: u32) { c.shade_model(mode) }
    glColorMaterial(face: u32, mode: u32) { c.color_material(face, mode) }
    glPointSize(size: f32) { c.point_size(size) }
    glLineWidth(width: f32) { c.line_width(width) }
    glLineStipple(factor: i32, pattern: u16) { c.line_stipple(factor, pattern) }
    glCullFace(face: u32) { c.cull_face(face) }
    glFrontFace(face: u32) { c.front_face(face) }
    glPolygonMode(face: u32, mode: u32) { c.polygon_mode(face, mode) }
    glPolygonOffset(factor: f32, units: f32) { c.polygon_offset(factor, units) }

    glAlphaFunc(func: u32, reference: f32) { c.alpha_func(func, reference) }
    glBlendFunc(source: u32, destination: u32) { c.blend_func(source, destination) }
    glBlendFuncSeparate | glBlendFuncSeparateEXT(color: u32, to_color: u32, alpha: u32, to_alpha: u32) {
        c.blend_func_separate(color, to_color, alpha, to_alpha)
    }
    glBlendEquation | glBlendEquationEXT(equation: u32) { c.blend_equation(equation) }
    glBlendEquationSeparateEXT(color: u32, alpha: u32) { c.blend_equation_separate(color, alpha) }
    glBlendColor | glBlendColorEXT(red: f32, green: f32, blue: f32, alpha: f32) {
        c.blend_color([red, green, blue, alpha])
    }
    glLogicOp(op: u32) { c.logic_op(op) }
    glColorMask(red: u8, green: u8, blue: u8, alpha: u8) {
        c.color_mask([red, green, blue, alpha].map(|v| v != 0))
    }
    glIndexMask(mask: u32) { c.index_mask(mask) }
    glDepthFunc(func: u32) { c.depth_func(func) }
    glDepthMask(mask: u8) { c.depth_mask(mask != 0) }
    glStencilFunc(func: u32, reference: i32, mask: u32) { c.stencil_func(func, reference, mask) }
    glStencilOp(fail: u32, depth_fail: u32, pass: u32) { c.stencil_op(fail, depth_fail, pass) }
    glStencilMask(mask: u32) { c.stencil_mask(mask) }
    glSampleCoverage | glSampleCoverageARB(value: f32, invert: u8) { c.sample_coverage(value, invert != 0) }

    glClear(mask: u32) { c.clear(mask) }
    glClearColor(red: f32, green: f32, blue: f32, alpha: f32) { c.clear_color([red, green, blue, alpha]) }
    glClearIndex(index: f32) { c.clear_index(index) }
    glClearDepth(depth: f64) { c.clear_depth(depth) }
    glClearStencil(value: i32) { c.clear_stencil(value) }
    glClearAccum(red: f32, green: f32, blue: f32, alpha: f32) { c.clear_accum([red, green, blue, alpha]) }

    glActiveTexture | glActiveTextureARB(unit: u32) { c.active_texture(unit) }

    glGenQueries | glGenQueriesARB(n: i32, ids: Out<u32>) { ids.write(&c.gen_queries(n)) }
    glDeleteQueries | glDeleteQueriesARB(n: i32, ids: In<u32>) {
        crate::commands::names(c, n, ids, |c, ids| c.delete_queries(ids));
    }
    glIsQuery | glIsQueryARB(id: u32) -> u8 { c.is_query(id).into() }
    glBeginQuery | glBeginQueryARB(target: u32, id: u32) { c.begin_query(target, id) }
    glEndQuery | glEndQueryARB(target: u32) { c.end_query(target) }
    glGetQueryiv | glGetQueryivARB(target: u32, name: u32, out: Out<i32>) { out.put(c.get_query(target, name)) }
    glGetQueryObjectiv | glGetQueryObjectivARB(id: u32, name: u32, out: Out<i32>) {
        out.put(i32::try_from(c.get_query_object(id, name)).unwrap_or(i32::MAX))
    }
    glGetQueryObjectuiv | glGetQueryObjectuivARB(id: u32, name: u32, out: Out<u32>) {
        out.put(c.get_query_object(id, name))
    }
}
