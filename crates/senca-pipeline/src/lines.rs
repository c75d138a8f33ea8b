//! Line drawings: edges of polygons, normals at vertices, and both as lists of segments.
//!
//! A drawing is a list of [`Segment`]s in pixels, from [`wire_segments`] or
//! [`hidden_line_segments`]; pictures are made by drawing the list, and a writer of vector graphics
//! takes it as it is.

mod edges;
mod hidden;
mod picture;
mod projector;

use senca_math::Control;
use senca_math::glam::DVec3;
use senca_math::{LinearRgb, View};
use senca_scene::{Mesh, Scene};

use crate::RenderError;
use crate::geometry::{Placed, World};
use crate::settings::{Culling, Settings, Shading};
use edges::{Edge, edges_of};
use projector::Projector;

pub(crate) use picture::draw;

/// Normals are drawn this part of the window's width long.
/// Source: 1991 thesis, section 3.
const NORMALS_PER_WIDTH: f64 = 30.0;

/// A straight line on the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Start and end in pixels from the picture's upper left corner; pixel centres are at .5.
    pub ends: [[f64; 2]; 2],
    /// Window depth of start and end, 0 near to 1 far.
    pub depths: [f64; 2],
    /// Linear colour of start and end; they differ in fog only.
    pub colors: [LinearRgb; 2],
    /// What the line stands for.
    pub kind: SegmentKind,
}

/// What a line stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SegmentKind {
    /// An edge of a polygon, or a line of a mesh.
    Edge,
    /// The normal at a vertex.
    Normal,
}

/// All edges of the scene's polygons as seen in a picture of `width` by `height` pixels, each once,
/// cut at its sides; with [`Shading::WireNormals`] also the normals at the vertices. With
/// [`Culling::Always`] edges that no front has are left out; normals are not.
///
/// # Errors
/// See [`RenderError`].
pub fn wire_segments(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    width: u32,
    height: u32,
) -> Result<Vec<Segment>, RenderError> {
    segments(&scene.at_time(None, 0.0), view, settings, [width, height], false, &Control::default())
}

/// The parts of all edges that no face hides, exact to about a ten thousandth of a pixel. Edges
/// between faces in one plane are left out as [`crate::WireSettings::skip_flat_edges`] says.
///
/// # Errors
/// See [`RenderError`].
pub fn hidden_line_segments(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    width: u32,
    height: u32,
) -> Result<Vec<Segment>, RenderError> {
    segments(&scene.at_time(None, 0.0), view, settings, [width, height], true, &Control::default())
}

pub(crate) fn segments(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    size: [u32; 2],
    hidden: bool,
    control: &Control<'_>,
) -> Result<Vec<Segment>, RenderError> {
    if size.contains(&0) {
        return Err(RenderError::EmptyImage { width: size[0], height: size[1] });
    }
    settings.check()?;
    let world = World::new(scene, view, size, settings.tolerance_px, true)?;
    let projector = Projector::new(scene, view, settings, size);
    if hidden {
        return hidden::visible_segments(&world, &projector, settings, control);
    }
    let mut segments = Vec::new();
    for placed in &world.placed {
        control.check()?;
        let mesh = &world.meshes[placed.mesh];
        let edges = edges_of(mesh, placed, false);
        let seen =
            edges.iter().filter(|e| settings.cull != Culling::Always || has_front(view, placed, mesh, e));
        segments.extend(seen.filter_map(|e| projector.segment(e.ends, SegmentKind::Edge)));
        if settings.shading == Shading::WireNormals {
            let length = settings.wire.normal_length.unwrap_or_else(|| default_length(&world, view));
            segments.extend(
                normals(mesh, placed, length).filter_map(|e| projector.segment(e, SegmentKind::Normal)),
            );
        }
    }
    Ok(segments)
}

/// Whether any face at `edge` shows its front, or there is none.
fn has_front(view: &View, placed: &Placed<'_>, mesh: &Mesh, edge: &Edge) -> bool {
    let front = |face: u32| {
        let corners = mesh.faces.corners_of(face as usize);
        let object = senca_scene::newell_vector(corners.iter().map(|&c| mesh.position(c)));
        let normal = (placed.world_from_object_normals * object).as_dvec3();
        !view.kind.sees_back_of(edge.ends[0], normal)
    };
    edge.faces.iter().flatten().count() == 0 || edge.faces.iter().flatten().any(|&f| front(f))
}

/// From each vertex along its normal, in the world.
fn normals<'m>(mesh: &'m Mesh, placed: &'m Placed<'_>, length: f64) -> impl Iterator<Item = [DVec3; 2]> + 'm {
    mesh.vertices.normal.iter().enumerate().map(move |(vertex, &normal)| {
        let foot = placed.world_from_object.transform_point3(mesh.position(vertex as u32).as_dvec3());
        let direction = (placed.world_from_object_normals * normal).as_dvec3().normalize_or_zero();
        [foot, foot + direction * length]
    })
}

/// 1/30 of the width of what is seen at the distance of the scene's middle; in a parallel view that
/// is the window's width everywhere.
fn default_length(world: &World<'_>, view: &View) -> f64 {
    let bounds = world.placed.iter().fold(senca_math::Aabb::EMPTY, |bounds, placed| {
        bounds.union(world.meshes[placed.mesh].bounds().transformed(&placed.world_from_object))
    });
    let w = (view.clip_from_world * bounds.center().extend(1.0)).w;
    2.0 * w.abs().max(f64::MIN_POSITIVE) / view.clip_from_view.x_axis.x.abs() / NORMALS_PER_WIDTH
}

#[cfg(test)]
mod tests;
