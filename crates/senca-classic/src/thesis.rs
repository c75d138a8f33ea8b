//! The programs of the 1991 thesis "Shading a 3-D object with rendering": renderer, look-up table
//! editor, and what they share.
//!
//! 1. [`Database::load`] builds objects, surfaces, polygons, vertices and vertex normals with links
//!    both ways from the object files that a scene file names (section 9).
//! 2. [`render`] places them in the world, makes normals, marks the polygons that turn their back,
//!    and draws: edges, edges with normals, or faces after Phong or Gouraud into a bitmap of colour
//!    indices behind an integer z-buffer (sections 2, 3, 4, 7; program in section 12.2).
//! 3. A pixel's index is nothing but the cosine between normal and light. What colour that is, a
//!    [`Lut`] says; a [`Profile`] over the cosine makes one. The [`LutEditor`] changes it, and the
//!    picture gets other colours, other light and other highlights without being computed again
//!    (sections 8.3 and 12.3).
//!
//! The patch converter of section 12.4 is [`senca_scene::patch_to_polygons`]; the file formats are
//! [`senca_io::classic`]'s.
//!
//! Slips of the listing are corrected as its text wants it. [`RenderSettings::as_printed`] gives the
//! listing's behaviour where it differs: the clip matrix that weakens the perspective, depth that
//! overflows, columns cut off and not rounded, all faces drawn, viewport sides exchanged.

mod build;
mod clip;
mod database;
mod device;
mod dump;
mod edges;
mod editor;
mod editor_window;
mod highlight;
mod lut;
mod profile;
mod render;
mod save;
mod shade;
#[cfg(test)]
mod test_support;
mod transfer;
mod view;
mod wireframe;

pub use build::{BuildAlgorithm, ObjectRecords, PolygonRecord};
pub use database::{Corner, Database, Object, Polygon, Surface, Vertex, VertexNormal};
pub use device::SetPixel;
pub use editor::{EditorFiles, EditorReply, LutEditor};
pub use editor_window::LutWindow;
pub use lut::{ColorModel, EGA_CODES, Lut, PaletteError, paint};
pub use profile::{Node, Profile, ProfileError};
pub use render::{RenderReport, RenderSettings, Rendering, ThesisError, render};
pub use save::{object_text, scene_text};
pub use shade::Ranges;
pub use transfer::{packed_size, transfer_seconds};
pub use view::DeviceView;
pub use wireframe::NormalsDrawn;
