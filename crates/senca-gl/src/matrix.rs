//! Matrices and their stacks (OpenGL 1.5, section 2.11), and the utility layer's ways to make them.
//!
//! Points are columns; matrices come and go column by column. Every command multiplies the current matrix
//! from the right: what is said last acts first.

use crate::component::Component;
use crate::state::MatrixStack;
use crate::{Context, Enum, gl};
use senca_math::glam::{DMat4, DVec3, DVec4, Mat4};

impl Context {
    /// `glMatrixMode`: `MODELVIEW`, `PROJECTION` or `TEXTURE` (that of the active unit) is the current matrix.
    pub fn matrix_mode(&mut self, mode: Enum) {
        self.submit(move |c| match mode {
            gl::MODELVIEW | gl::PROJECTION | gl::TEXTURE => c.state.transform.matrix_mode = mode,
            _ => c.error(gl::INVALID_ENUM),
        });
    }

    pub(crate) fn current_stack(&mut self) -> &mut MatrixStack {
        self.touch_vertices();
        match self.state.transform.matrix_mode {
            gl::PROJECTION => &mut self.projection,
            gl::TEXTURE => &mut self.texture_matrices[self.state.texturing.active],
            _ => &mut self.modelview,
        }
    }

    fn load(&mut self, m: Mat4) {
        self.submit(move |c| c.current_stack().set_top(m));
    }

    fn multiply(&mut self, m: Mat4) {
        self.submit(move |c| {
            let stack = c.current_stack();
            let product = stack.top() * m;
            stack.set_top(product);
        });
    }

    /// `glLoadIdentity`.
    pub fn load_identity(&mut self) {
        self.load(Mat4::IDENTITY);
    }

    /// `glLoadMatrix`: 16 numbers, column by column.
    pub fn load_matrix<T: Component>(&mut self, m: [T; 16]) {
        self.load(Mat4::from_cols_array(&m.map(T::value)));
    }

    /// `glMultMatrix`: 16 numbers, column by column.
    pub fn mult_matrix<T: Component>(&mut self, m: [T; 16]) {
        self.multiply(Mat4::from_cols_array(&m.map(T::value)));
    }

    /// `glLoadTransposeMatrix`: 16 numbers, row by row.
    pub fn load_transpose_matrix<T: Component>(&mut self, m: [T; 16]) {
        self.load(Mat4::from_cols_array(&m.map(T::value)).transpose());
    }

    /// `glMultTransposeMatrix`: 16 numbers, row by row.
    pub fn mult_transpose_matrix<T: Component>(&mut self, m: [T; 16]) {
        self.multiply(Mat4::from_cols_array(&m.map(T::value)).transpose());
    }

    /// `glTranslate`.
    pub fn translate(&mut self, by: [f64; 3]) {
        self.multiply(Mat4::from_translation(DVec3::from(by).as_vec3()));
    }

    /// `glScale`.
    pub fn scale(&mut self, by: [f64; 3]) {
        self.multiply(Mat4::from_scale(DVec3::from(by).as_vec3()));
    }

    /// `glRotate`: by `angle` degrees, counter-clockwise about `axis`, of any length.
    pub fn rotate(&mut self, angle: f64, axis: [f64; 3]) {
        self.multiply(rotation(angle, axis).as_mat4());
    }

    /// `glFrustum`: near and far are positive distances.
    pub fn frustum(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        self.submit(move |c| {
            let wrong = near <= 0.0 || far <= 0.0 || near == far || left == right || bottom == top;
            if wrong {
                return c.error(gl::INVALID_VALUE);
            }
            let stack = c.current_stack();
            let product = stack.top() * frustum(left, right, bottom, top, near, far).as_mat4();
            stack.set_top(product);
        });
    }

    /// `glOrtho`: near and far may be negative.
    pub fn ortho(&mut self, left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        self.submit(move |c| {
            if left == right || bottom == top || near == far {
                return c.error(gl::INVALID_VALUE);
            }
            let stack = c.current_stack();
            let product = stack.top() * ortho(left, right, bottom, top, near, far).as_mat4();
            stack.set_top(product);
        });
    }

    /// `glPushMatrix`.
    pub fn push_matrix(&mut self) {
        self.submit(|c| {
            let stack = c.current_stack();
            if stack.matrices.len() >= stack.limit {
                return c.error(gl::STACK_OVERFLOW);
            }
            let top = stack.top();
            stack.matrices.push(top);
        });
    }

    /// `glPopMatrix`.
    pub fn pop_matrix(&mut self) {
        self.submit(|c| {
            let stack = c.current_stack();
            if stack.matrices.len() < 2 {
                return c.error(gl::STACK_UNDERFLOW);
            }
            stack.matrices.pop();
        });
    }

    /// `gluLookAt`: the camera at `eye` looks towards `center`; `up` is up in the picture. Nothing happens
    /// when the three do not say where.
    pub fn look_at(&mut self, eye: [f64; 3], center: [f64; 3], up: [f64; 3]) {
        if let Some(m) = look_at(eye, center, up) {
            self.multiply(m.as_mat4());
        }
    }

    /// `gluPerspective`: `fovy`, the height of the view, in degrees; `aspect`, width to height; distances near
    /// and far. Nothing happens when they make no view.
    pub fn perspective(&mut self, fovy: f64, aspect: f64, near: f64, far: f64) {
        let top = near * (fovy.to_radians() / 2.0).tan();
        if near != far && aspect != 0.0 && top != 0.0 && top.is_finite() {
            let right = top * aspect;
            self.multiply(frustum(-right, right, -top, top, near, far).as_mat4());
        }
    }

    /// `gluOrtho2D`: `glOrtho` with near -1 and far 1.
    pub fn ortho_2d(&mut self, left: f64, right: f64, bottom: f64, top: f64) {
        self.ortho(left, right, bottom, top, -1.0, 1.0);
    }

    /// `gluPickMatrix`: keeps of the view what lies within a window of `size` pixels about (`x`, `y`), y from
    /// below. Nothing happens when the size is not positive.
    pub fn pick_matrix(&mut self, [x, y]: [f64; 2], size: [f64; 2], viewport: [i32; 4]) {
        if size[0] <= 0.0 || size[1] <= 0.0 {
            return;
        }
        let [vx, vy, vw, vh] = viewport.map(f64::from);
        let shift = [(vw + 2.0 * (vx - x)) / size[0], (vh + 2.0 * (vy - y)) / size[1], 0.0];
        self.translate(shift);
        self.scale([vw / size[0], vh / size[1], 1.0]);
    }
}

/// Rotation by degrees about an axis; the identity when the axis has no length.
fn rotation(angle: f64, axis: [f64; 3]) -> DMat4 {
    match DVec3::from(axis).try_normalize() {
        Some(axis) => DMat4::from_axis_angle(axis, angle.to_radians()),
        None => DMat4::IDENTITY,
    }
}

fn frustum(left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) -> DMat4 {
    let (w, h, d) = (right - left, top - bottom, far - near);
    DMat4::from_cols(
        DVec4::new(2.0 * near / w, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0 * near / h, 0.0, 0.0),
        DVec4::new((right + left) / w, (top + bottom) / h, -(far + near) / d, -1.0),
        DVec4::new(0.0, 0.0, -2.0 * far * near / d, 0.0),
    )
}

fn ortho(left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) -> DMat4 {
    let (w, h, d) = (right - left, top - bottom, far - near);
    DMat4::from_cols(
        DVec4::new(2.0 / w, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0 / h, 0.0, 0.0),
        DVec4::new(0.0, 0.0, -2.0 / d, 0.0),
        DVec4::new(-(right + left) / w, -(top + bottom) / h, -(far + near) / d, 1.0),
    )
}

fn look_at(eye: [f64; 3], center: [f64; 3], up: [f64; 3]) -> Option<DMat4> {
    let (eye, center) = (DVec3::from(eye), DVec3::from(center));
    let forward = (center - eye).try_normalize()?;
    let side = forward.cross(DVec3::from(up)).try_normalize()?;
    let up = side.cross(forward);
    let turn = DMat4::from_cols(
        DVec4::new(side.x, up.x, -forward.x, 0.0),
        DVec4::new(side.y, up.y, -forward.y, 0.0),
        DVec4::new(side.z, up.z, -forward.z, 0.0),
        DVec4::W,
    );
    Some(turn * DMat4::from_translation(-eye))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;
    use senca_math::glam::Vec4;

    fn context() -> Context {
        Context::new(Config::default())
    }

    fn near(a: Vec4, b: [f32; 4]) -> bool {
        (a - Vec4::from(b)).abs().max_element() < 1e-5
    }

    #[test]
    fn the_matrix_said_last_acts_first() {
        let mut c = context();
        c.load_identity();
        c.translate([1.0, 0.0, 0.0]);
        c.scale([2.0, 2.0, 2.0]);
        assert!(near(c.modelview.top() * Vec4::new(1.0, 1.0, 0.0, 1.0), [3.0, 2.0, 0.0, 1.0]));
    }

    #[test]
    fn three_stacks_are_independent() {
        let mut c = context();
        c.push_matrix();
        c.matrix_mode(gl::PROJECTION);
        c.pop_matrix();
        assert_eq!(c.get_error(), gl::STACK_UNDERFLOW);
        c.matrix_mode(gl::TEXTURE);
        (0..9).for_each(|_| c.push_matrix());
        assert_eq!(c.get_error(), gl::NO_ERROR);
        c.push_matrix();
        assert_eq!(c.get_error(), gl::STACK_OVERFLOW);
        assert_eq!(c.modelview.matrices.len(), 2);
    }

    #[test]
    fn perspective_is_a_symmetric_frustum() {
        let (mut a, mut b) = (context(), context());
        a.perspective(60.0, 1.5, 2.0, 9.0);
        let top = 2.0 * 30f64.to_radians().tan();
        b.frustum(-1.5 * top, 1.5 * top, -top, top, 2.0, 9.0);
        assert_eq!(a.modelview.top(), b.modelview.top());
    }

    #[test]
    fn volumes_without_extent_are_errors() {
        let mut c = context();
        c.frustum(-1.0, 1.0, -1.0, 1.0, 0.0, 2.0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.ortho(1.0, 1.0, -1.0, 1.0, 0.0, 2.0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        assert_eq!(c.modelview.top(), Mat4::IDENTITY);
    }

    #[test]
    fn a_transposed_matrix_is_read_by_rows() {
        let mut c = context();
        let by_rows: [f32; 16] = std::array::from_fn(|i| i as f32);
        c.load_transpose_matrix(by_rows);
        assert_eq!(c.modelview.top().col(1).to_array(), [1.0, 5.0, 9.0, 13.0]);
        c.load_matrix(by_rows);
        assert_eq!(c.modelview.top().col(1).to_array(), [4.0, 5.0, 6.0, 7.0]);
    }
}
