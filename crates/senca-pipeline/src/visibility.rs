//! What is seen where: depth and triangle identifiers of a band of rows.

use std::ops::Range;

use rayon::prelude::*;
use senca_math::Control;
use senca_math::conventions::{DEPTH_FAR, NO_ID};
use senca_math::glam::{DMat4, DVec3, Mat4, Vec4};
use senca_raster::{
    Clear, Counters, Cull, FragmentShader, Fragments, Ids, Primitives, Rasterizer, Shaded, State, Target,
    Viewport,
};
use senca_scene::AlphaMode;

use crate::RenderError;
use crate::geometry::Part;
use crate::settings::Crop;
use crate::shade::Shader;
use crate::surface::TriangleSetup;

/// Pixels of margin around the picture inside the clipped volume, so that sample positions and wide
/// lines at the rim of the picture are not cut.
const MARGIN: u32 = 2;

/// Meshes of up to this many vertices are drawn together with their neighbours.
const SMALL_MESH: usize = 1 << 15;

/// Corners handed to the rasterizer at once; it cannot be stopped in between.
const CORNERS_AT_ONCE: usize = 3 << 17;

/// A sample of the pixels of a band: what the rasterizer needs to know about places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Size of the whole picture.
    pub(crate) size: [u32; 2],
    /// The rectangle of it that is drawn now.
    pub(crate) area: Crop,
    /// Where pixels are sampled, from their upper left corner, in [0, 1).
    pub(crate) sample: [f32; 2],
}

impl Window {
    /// Clip space with room for the margin, from clip space.
    pub(crate) fn padded_from_clip(&self) -> DMat4 {
        let shrink = |n: u32| f64::from(n) / f64::from(n + 2 * MARGIN);
        DMat4::from_scale(DVec3::new(shrink(self.size[0]), shrink(self.size[1]), 1.0))
    }

    /// Where the padded volume lands in the area's own pixels.
    pub(crate) fn viewport(&self) -> Viewport {
        let start = |first: u32, sample: f32| 0.5 - sample - (first + MARGIN) as f32;
        Viewport {
            x: start(self.area.x, self.sample[0]),
            y: start(self.area.y, self.sample[1]),
            width: (self.size[0] + 2 * MARGIN) as f32,
            height: (self.size[1] + 2 * MARGIN) as f32,
        }
    }

    /// Place of the sample of the area's pixel (x, y), in pixels of the whole picture.
    pub(crate) fn place(&self, x: usize, y: usize) -> [f64; 2] {
        [
            self.area.x as f64 + x as f64 + f64::from(self.sample[0]),
            self.area.y as f64 + y as f64 + f64::from(self.sample[1]),
        ]
    }

    /// Pixels of the area.
    pub(crate) fn pixels(&self) -> usize {
        self.area.width as usize * self.area.height as usize
    }
}

/// Depths and identifiers of a band, row by row.
#[derive(Clone, Debug, Default)]
pub(crate) struct Planes {
    pub(crate) depth: Vec<f32>,
    pub(crate) ids: Vec<u32>,
}

impl Planes {
    /// Room for `pixels`; what is there stays as it is.
    pub(crate) fn resize(&mut self, pixels: usize) {
        self.depth.resize(pixels, DEPTH_FAR);
        self.ids.resize(pixels, NO_ID);
    }

    pub(crate) fn target(&mut self, area: &Crop) -> Result<Target<'_>, RenderError> {
        let too_large = |_| RenderError::area_too_large(area);
        let target = Target::new(area.width, area.height).map_err(too_large)?;
        target.with_depth(&mut self.depth).and_then(|t| t.with_ids(&mut self.ids)).map_err(too_large)
    }
}

/// Parts that are drawn alike, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// Indices into `World::parts`.
    pub(crate) parts: Range<usize>,
    cull: Cull,
    pub(crate) layer: Layer,
}

/// How a part meets what is behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layer {
    Opaque,
    Masked,
    Blended,
}

/// Groups the parts of the world, in their order.
pub(crate) fn groups(shader: &Shader<'_>) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (i, part) in shader.world.parts.iter().enumerate() {
        let (cull, layer) = (cull_of(shader, part), layer_of(shader, part));
        match groups.last_mut() {
            Some(last) if last.cull == cull && last.layer == layer => last.parts.end = i + 1,
            _ => groups.push(Group { parts: i..i + 1, cull, layer }),
        }
    }
    groups
}

fn cull_of(shader: &Shader<'_>, part: &Part) -> Cull {
    let double_sided = shader.materials[part.material].double_sided;
    match (shader.settings.draws_backs_of(double_sided), shader.world.placed[part.placed].mirrored) {
        (true, _) => Cull::None,
        (false, false) => Cull::Back,
        (false, true) => Cull::Front,
    }
}

fn layer_of(shader: &Shader<'_>, part: &Part) -> Layer {
    match shader.materials[part.material].alpha_mode {
        AlphaMode::Opaque => Layer::Opaque,
        AlphaMode::Mask { .. } => Layer::Masked,
        AlphaMode::Blend => Layer::Blended,
    }
}

/// Draws groups of parts; keeps its scratch memory.
#[derive(Default)]
pub(crate) struct Drawer {
    positions: Vec<Vec4>,
    indices: Vec<u32>,
    /// The placed mesh whose vertices end `positions`, and where they begin.
    last: Option<(usize, u32)>,
    first_id: u32,
}

/// Where and how a [`Drawer`] draws.
pub(crate) struct Pass<'a, 'w> {
    pub(crate) shader: &'a Shader<'w>,
    pub(crate) window: &'a Window,
    pub(crate) rasterizer: &'a mut dyn Rasterizer,
    pub(crate) control: &'a Control<'a>,
    pub(crate) counters: Counters,
}

impl<'a, 'w> Pass<'a, 'w> {
    /// Nothing drawn yet.
    pub(crate) fn new(
        shader: &'a Shader<'w>,
        window: &'a Window,
        rasterizer: &'a mut dyn Rasterizer,
        control: &'a Control<'a>,
    ) -> Self {
        Self { shader, window, rasterizer, control, counters: Counters::default() }
    }

    /// State for `group`.
    fn state(&self, group: &Group) -> State {
        State { viewport: Some(self.window.viewport()), cull: group.cull, ..State::default() }
    }
}

/// An empty band: nothing anywhere, infinitely far.
pub(crate) const EMPTY: Clear = Clear { color: None, depth: Some(DEPTH_FAR), id: Some(NO_ID), stencil: None };

impl Drawer {
    /// Draws `group` into `target` with `shading`.
    pub(crate) fn draw(
        &mut self,
        pass: &mut Pass<'_, '_>,
        target: &mut Target<'_>,
        group: &Group,
        shading: &senca_raster::Shading<'_>,
    ) -> Result<(), RenderError> {
        let state = pass.state(group);
        let padded_from_clip = pass.window.padded_from_clip();
        self.reset();
        for part in &pass.shader.world.parts[group.parts.clone()] {
            let mesh = pass.shader.world.mesh(part);
            let padded_from_object = (padded_from_clip * pass.shader.clip_from_object[part.placed]).as_mat4();
            let vertices = mesh.vertices.point.len();
            if vertices > SMALL_MESH {
                self.flush(pass, target, &state, shading)?;
                if self.last.is_none_or(|(placed, _)| placed != part.placed) {
                    project(mesh, &padded_from_object, &mut self.positions);
                    self.last = Some((part.placed, 0));
                }
                let corners = pass.shader.world.corners(part);
                draw_in_runs(pass, target, &state, shading, (&self.positions, corners, part.first_id))?;
                continue;
            }
            if self.positions.len() + vertices > 2 * SMALL_MESH {
                self.flush(pass, target, &state, shading)?;
                self.reset();
            }
            self.append(pass.shader, part, &padded_from_object);
        }
        self.flush(pass, target, &state, shading)
    }

    fn reset(&mut self) {
        self.positions.clear();
        self.indices.clear();
        self.last = None;
    }

    /// Adds a small part to what is drawn next.
    fn append(&mut self, shader: &Shader<'_>, part: &Part, padded_from_object: &Mat4) {
        if self.indices.is_empty() {
            self.first_id = part.first_id;
        }
        let base = match self.last {
            Some((placed, base)) if placed == part.placed => base,
            _ => {
                let base = self.positions.len() as u32;
                let mesh = shader.world.mesh(part);
                let place = |&p: &u32| *padded_from_object * mesh.points[p as usize].extend(1.0);
                self.positions.extend(mesh.vertices.point.iter().map(place));
                self.last = Some((part.placed, base));
                base
            }
        };
        self.indices.extend(shader.world.corners(part).iter().map(|c| c + base));
    }

    fn flush(
        &mut self,
        pass: &mut Pass<'_, '_>,
        target: &mut Target<'_>,
        state: &State,
        shading: &senca_raster::Shading<'_>,
    ) -> Result<(), RenderError> {
        if !self.indices.is_empty() {
            draw_in_runs(pass, target, state, shading, (&self.positions, &self.indices, self.first_id))?;
            self.reset();
        }
        Ok(())
    }
}

/// Vertices of `mesh` in padded clip space.
fn project(mesh: &senca_scene::Mesh, padded_from_object: &Mat4, positions: &mut Vec<Vec4>) {
    let place = |&p: &u32| *padded_from_object * mesh.points[p as usize].extend(1.0);
    mesh.vertices.point.par_iter().with_min_len(1 << 13).map(place).collect_into_vec(positions);
}

/// Draws triangles run by run, asking in between whether to stop.
fn draw_in_runs(
    pass: &mut Pass<'_, '_>,
    target: &mut Target<'_>,
    state: &State,
    shading: &senca_raster::Shading<'_>,
    (positions, corners, first_id): (&[Vec4], &[u32], u32),
) -> Result<(), RenderError> {
    for (run, indices) in corners.chunks(CORNERS_AT_ONCE).enumerate() {
        pass.control.check()?;
        let ids = Ids::From(first_id + (run * CORNERS_AT_ONCE / 3) as u32);
        let triangles = Primitives { positions, varyings: &[], stride: 0, indices, ids };
        pass.counters += pass.rasterizer.draw(target, &triangles, state, shading);
    }
    Ok(())
}

/// Cuts away what a mask says is not there.
pub(crate) struct MaskCutter<'a, 'w> {
    pub(crate) shader: &'a Shader<'w>,
    pub(crate) window: &'a Window,
}

impl FragmentShader for MaskCutter<'_, '_> {
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        let triangle = self.shader.setup(fragments.id);
        for lane in fragments.lanes() {
            if !passes_mask(self.shader, self.window, &triangle, fragments, lane) {
                out.discard(lane);
            }
        }
    }
}

fn passes_mask(
    shader: &Shader<'_>,
    window: &Window,
    triangle: &TriangleSetup<'_>,
    fragments: &Fragments<'_>,
    lane: usize,
) -> bool {
    let [x, y] = window.place(fragments.column(lane) as usize, fragments.row(lane) as usize);
    shader.passes_mask(triangle, x, y, fragments.depth[lane])
}

/// Lets only fragments pass that lie behind those of the last layer, by depth and then by identifier.
pub(crate) struct Peeler<'a> {
    /// Columns of the planes.
    pub(crate) width: usize,
    /// The last layer.
    pub(crate) last: &'a Planes,
}

impl FragmentShader for Peeler<'_> {
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded) {
        for lane in fragments.lanes() {
            let pixel = fragments.row(lane) as usize * self.width + fragments.column(lane) as usize;
            let (depth, id) = (self.last.depth[pixel], self.last.ids[pixel]);
            let behind =
                fragments.depth[lane] > depth || (fragments.depth[lane] == depth && fragments.id > id);
            if !behind {
                out.discard(lane);
            }
        }
    }
}
