//! Shading in the same pass as visibility: the plain z-buffer of the books.

use senca_raster::{FragmentShader, Fragments, Shaded};

use crate::shade::Shader;
use crate::visibility::Window;

/// Shades whatever is nearest so far.
/// Source: course text, section 2.9.
pub(crate) struct SinglePass<'a, 'w> {
    pub(crate) shader: &'a Shader<'w>,
    pub(crate) window: &'a Window,
}

impl FragmentShader for SinglePass<'_, '_> {
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        let triangle = self.shader.setup(fragments.id);
        for lane in fragments.lanes() {
            let [x, y] = self.window.place(fragments.column(lane) as usize, fragments.row(lane) as usize);
            let depth = fragments.depth[lane];
            if self.shader.passes_mask(&triangle, x, y, depth) {
                out.set(lane, self.shader.shade(&triangle, x, y, depth));
            } else {
                out.discard(lane);
            }
        }
    }
}
