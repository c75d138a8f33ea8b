//! Matrices.

use crate::memory::In;

commands! { COMMANDS, c:
    glMatrixMode(mode: u32) { c.matrix_mode(mode) }
    glLoadIdentity() { c.load_identity() }
    glPushMatrix() { c.push_matrix() }
    glPopMatrix() { c.pop_matrix() }
    glLoadMatrixf(m: In<f32>) { if let Some(m) = m.array() { c.load_matrix(m) } }
    glLoadMatrixd(m: In<f64>) { if let Some(m) = m.array() { c.load_matrix(m) } }
    glMultMatrixf(m: In<f32>) { if let Some(m) = m.array() { c.mult_matrix(m) } }
    glMultMatrixd(m: In<f64>) { if let Some(m) = m.array() { c.mult_matrix(m) } }
    glLoadTransposeMatrixf | glLoadTransposeMatrixfARB(m: In<f32>) {
        if let Some(m) = m.array() { c.load_transpose_matrix(m) }
    }
    glLoadTransposeMatrixd | glLoadTransposeMatrixdARB(m: In<f64>) {
        if let Some(m) = m.array() { c.load_transpose_matrix(m) }
    }
    glMultTransposeMatrixf | glMultTransposeMatrixfARB(m: In<f32>) {
        if let Some(m) = m.array() { c.mult_transpose_matrix(m) }
    }
    glMultTransposeMatrixd | glMultTransposeMatrixdARB(m: In<f64>) {
        if let Some(m) = m.array() { c.mult_transpose_matrix(m) }
    }
    glTranslatef(x: f32, y: f32, z: f32) { c.translate([x, y, z].map(f64::from)) }
    glTranslated(x: f64, y: f64, z: f64) { c.translate([x, y, z]) }
    glScalef(x: f32, y: f32, z: f32) { c.scale([x, y, z].map(f64::from)) }
    glScaled(x: f64, y: f64, z: f64) { c.scale([x, y, z]) }
    glRotatef(angle: f32, x: f32, y: f32, z: f32) { c.rotate(angle.into(), [x, y, z].map(f64::from)) }
    glRotated(angle: f64, x: f64, y: f64, z: f64) { c.rotate(angle, [x, y, z]) }
    glFrustum(left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        c.frustum(left, right, bottom, top, near, far)
    }
    glOrtho(left: f64, right: f64, bottom: f64, top: f64, near: f64, far: f64) {
        c.ortho(left, right, bottom, top, near, far)
    }
}
