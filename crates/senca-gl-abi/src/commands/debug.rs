//! Messages for whoever debugs a program.

use crate::current::Current;
use crate::memory::{In, Out, Pointer};
use senca_gl::{DebugMessage, gl};
use std::ffi::{CString, c_void};
use std::sync::Arc;

/// The program's function for messages.
type Callback = unsafe extern "C" fn(u32, u32, u32, u32, i32, *const std::ffi::c_char, *const c_void);

/// Calls the program's function with each message from now on.
fn set_callback(c: &mut Current, callback: Option<Callback>, parameter: Pointer) {
    let parameter = parameter.address();
    c.debug_callback = [callback.map_or(0, |f| (f as *const c_void).expose_provenance()), parameter];
    c.debug_message_callback(callback.map(|f| {
        let call: senca_gl::DebugCallback = Arc::new(move |m: &DebugMessage| {
            let text = CString::new(m.text.replace('\0', " ")).unwrap_or_default();
            let length = i32::try_from(text.as_bytes().len()).unwrap_or(i32::MAX);
            let parameter = std::ptr::with_exposed_provenance(parameter);
            // SAFETY: the program answers for its function until it gives another one; the text has a closing
            // zero and lives until the function returns.
            unsafe { f(m.source, m.kind, m.id, m.severity, length, text.as_ptr(), parameter) }
        });
        call
    }));
}

/// Takes messages out of the log, as many as there are and fit; returns how many.
fn log(
    c: &mut Current,
    count: u32,
    size: i32,
    [sources, kinds, ids, severities]: [Out<u32>; 4],
    lengths: Out<i32>,
    text: Out<u8>,
) -> u32 {
    if size < 0 && !text.is_null() {
        c.raise(gl::INVALID_VALUE);
        return 0;
    }
    let mut used = 0;
    for k in 0..count as usize {
        let room = if text.is_null() { usize::MAX } else { size as usize - used };
        let Some(m) = c.take_debug_message(room) else { return k as u32 };
        for (out, value) in [(sources, m.source), (kinds, m.kind), (ids, m.id), (severities, m.severity)] {
            out.skip(k).put(value);
        }
        let length = m.text.len() + 1;
        lengths.skip(k).put(length as i32);
        text.skip(used).write_text(&m.text, length as i32);
        used += length;
    }
    count
}

fn label(c: &mut Current, kind: u32, name: u32, size: i32, length: Out<i32>, out: Out<u8>) {
    if size < 0 {
        return c.raise(gl::INVALID_VALUE);
    }
    let Some(label) = c.get_object_label(kind, name) else { return };
    let written = if out.is_null() { label.len() } else { out.write_text(label, size) };
    length.put(written as i32);
}

commands! { COMMANDS, c:
    glDebugMessageCallback(callback: Option<Callback>, parameter: Pointer) { set_callback(c, callback, parameter) }
    glDebugMessageControl(source: u32, kind: u32, severity: u32, count: i32, ids: In<u32>, on: u8) {
        if count < 0 {
            return c.raise(gl::INVALID_VALUE);
        }
        let ids = ids.values(count).unwrap_or_default();
        c.debug_message_control(source, kind, severity, &ids, on != 0)
    }
    glDebugMessageInsert(source: u32, kind: u32, id: u32, severity: u32, length: i32, text: In<u8>) {
        if let Some(text) = text.text(length) {
            c.debug_message_insert(source, kind, id, severity, &text)
        }
    }
    glGetDebugMessageLog(
        count: u32, size: i32, sources: Out<u32>, kinds: Out<u32>, ids: Out<u32>, severities: Out<u32>,
        lengths: Out<i32>, text: Out<u8>
    ) -> u32 {
        log(c, count, size, [sources, kinds, ids, severities], lengths, text)
    }
    glPushDebugGroup(source: u32, id: u32, length: i32, text: In<u8>) {
        if let Some(text) = text.text(length) {
            c.push_debug_group(source, id, &text)
        }
    }
    glPopDebugGroup() { c.pop_debug_group() }
    glObjectLabel(kind: u32, name: u32, length: i32, text: In<u8>) {
        c.object_label(kind, name, &text.text(length).unwrap_or_default())
    }
    // Pointers name sync objects, of which there are none.
    glObjectPtrLabel(_pointer: Pointer, _length: i32, _text: In<u8>) { c.raise(gl::INVALID_VALUE) }
    glGetObjectLabel(kind: u32, name: u32, size: i32, length: Out<i32>, text: Out<u8>) {
        label(c, kind, name, size, length, text)
    }
    glGetObjectPtrLabel(_pointer: Pointer, _size: i32, _length: Out<i32>, _text: Out<u8>) {
        c.raise(gl::INVALID_VALUE)
    }
}
