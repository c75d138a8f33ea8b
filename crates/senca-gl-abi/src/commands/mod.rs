//! The tables of commands.

mod arrays;
mod debug;
mod evaluators;
mod framebuffers;
mod get;
mod lists;
mod matrix;
mod parameters;
mod pixels;
mod select;
mod state;
mod textures;
mod vertex;

use crate::current::Current;
use crate::memory::In;
use crate::table::Entry;
use senca_gl::gl;
use std::collections::HashMap;
use std::sync::OnceLock;

/// All tables.
pub(crate) fn tables() -> impl Iterator<Item = &'static Entry> {
    [
        arrays::COMMANDS,
        debug::COMMANDS,
        evaluators::COMMANDS,
        framebuffers::COMMANDS,
        get::COMMANDS,
        lists::COMMANDS,
        matrix::COMMANDS,
        parameters::COMMANDS,
        pixels::COMMANDS,
        select::COMMANDS,
        state::COMMANDS,
        textures::COMMANDS,
        vertex::COMPONENTS,
        vertex::SINGLE,
    ]
    .into_iter()
    .flatten()
}

/// The `gl*` function of a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Entry> {
    static NAMES: OnceLock<HashMap<&str, &Entry>> = OnceLock::new();
    NAMES.get_or_init(|| tables().map(|e| (e.name, e)).collect()).get(name).copied()
}

/// Hands over the `n` names that a command reads.
fn names(c: &mut Current, n: i32, names: In<u32>, command: impl FnOnce(&mut Current, &[u32])) {
    match names.values(n) {
        Some(names) => command(c, &names),
        None if n < 0 => c.raise(gl::INVALID_VALUE),
        None => {}
    }
}
