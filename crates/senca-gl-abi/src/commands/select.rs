//! Selection and feedback.

use crate::current::Current;
use crate::memory::Out;
use senca_gl::gl;

/// Ends a mode: what it wrote goes to the program's buffer.
fn render_mode(c: &mut Current, mode: u32) -> i32 {
    let before = c.current_render_mode();
    let result = c.render_mode(mode);
    match before {
        gl::SELECT => Out::at(c.select_buffer).write(c.gl.selected()),
        gl::FEEDBACK => Out::at(c.feedback_buffer).write(c.gl.fed_back()),
        _ => {}
    }
    result
}

commands! { COMMANDS, c:
    glRenderMode(mode: u32) -> i32 { render_mode(c, mode) }
    glSelectBuffer(size: i32, buffer: Out<u32>) {
        if c.current_render_mode() != gl::SELECT {
            c.select_buffer = buffer.address();
        }
        c.gl.select_buffer(size)
    }
    glFeedbackBuffer(size: i32, kind: u32, buffer: Out<f32>) {
        if c.current_render_mode() != gl::FEEDBACK {
            c.feedback_buffer = buffer.address();
        }
        c.gl.feedback_buffer(size, kind)
    }
    glPassThrough(token: f32) { c.pass_through(token) }
    glInitNames() { c.init_names() }
    glPushName(name: u32) { c.push_name(name) }
    glPopName() { c.pop_name() }
    glLoadName(name: u32) { c.load_name(name) }
}
