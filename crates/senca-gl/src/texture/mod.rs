//! Texture objects and what is bound to the units.

use crate::Context;
use crate::state::TexTarget;

/// All texture objects.
#[derive(Debug, Default)]
pub(crate) struct Textures {}

/// What is bound to each unit.
#[derive(Debug, Default)]
pub(crate) struct Bindings {}

/// What `push_attrib(TEXTURE_BIT)` saves of bindings and of the parameters of bound textures.
#[derive(Debug)]
pub(crate) struct SavedBindings {}

/// A complete texture as it was when drawing began.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct View {}

impl Context {
    /// The texture that a unit draws with: of the most dimensions that is on and complete.
    pub(crate) fn texture_view(&self, _unit: usize) -> Option<(TexTarget, View)> {
        None
    }

    pub(crate) fn save_bindings(&self) -> SavedBindings {
        SavedBindings {}
    }

    pub(crate) fn restore_bindings(&mut self, _saved: SavedBindings) {}
}
