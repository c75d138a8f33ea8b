//! From vertices as the program gives them to vertices as the rasterizer takes them: transformation,
//! lighting, texture coordinates, fog coordinates (OpenGL 1.5, sections 2.11 to 2.14).

use crate::light_lanes::normalized_or_zero;
use crate::lighting::LightPlan;
use crate::state::{CLIP_PLANES, Cap, TEXTURE_UNITS, TexGen};
use crate::{Context, gl};
use rayon::prelude::*;
use senca_math::glam::{Mat3, Mat4, Vec3, Vec4, Vec4Swizzles};
use senca_raster::LANES;
use senca_raster::simd::{Simd, dispatch, f32x16, prelude::*};

/// Vertices for which a second thread is worth its while.
const WORTH_SHARING: usize = 4096;
/// Vertices a thread takes at once.
const CHUNK: usize = 1024;

/// An attribute of a row of vertices: the same for all, or one for each.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Attr<'a, T> {
    Same(T),
    Each(&'a [T]),
}

impl<T: Copy> Attr<'_, T> {
    #[inline]
    pub(crate) fn get(&self, i: usize) -> T {
        match self {
            Self::Same(v) => *v,
            Self::Each(v) => v[i],
        }
    }
}

/// A row of vertices as the program gives them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VertexInput<'a> {
    pub(crate) positions: &'a [[f32; 4]],
    pub(crate) normals: Attr<'a, [f32; 3]>,
    pub(crate) colors: Attr<'a, [f32; 4]>,
    pub(crate) secondary: Attr<'a, [f32; 3]>,
    pub(crate) fog_coords: Attr<'a, f32>,
    pub(crate) edge_flags: Attr<'a, bool>,
    pub(crate) tex_coords: [Attr<'a, [f32; 4]>; TEXTURE_UNITS],
}

/// Where the varyings of a vertex are. Colour is always there, in 0 to 3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Red, green, blue of the secondary colour.
    pub(crate) secondary: Option<u8>,
    /// Fog coordinate: distance from the eye, or what the program said.
    pub(crate) fog: Option<u8>,
    /// s, t, r, q of each unit.
    pub(crate) tex_coords: [Option<u8>; TEXTURE_UNITS],
    /// Varyings per vertex.
    pub(crate) stride: u8,
}

impl Layout {
    fn new(secondary: bool, fog: bool, units: u8) -> Self {
        let mut next = 4;
        let mut take = |wanted: bool, count: u8| {
            let first = next;
            next += if wanted { count } else { 0 };
            wanted.then_some(first)
        };
        let (secondary, fog) = (take(secondary, 3), take(fog, 1));
        let tex_coords = std::array::from_fn(|k| take(units >> k & 1 == 1, 4));
        Self { secondary, fog, tex_coords, stride: next }
    }
}

/// A row of vertices ready to be assembled.
#[derive(Debug, Default)]
pub(crate) struct Processed {
    /// Clip space of the rasterizer: y down, z in [0, w].
    pub(crate) positions: Vec<Vec4>,
    /// [`Layout::stride`] of each.
    pub(crate) varyings: Vec<f32>,
    /// Colour and secondary colour of the back, when both sides are lit.
    pub(crate) back: Vec<[f32; 7]>,
    /// Eye space, when user clip planes need it.
    pub(crate) eye: Vec<Vec4>,
    /// Whether the edge that starts here is a boundary, when polygons are drawn as lines or points.
    pub(crate) edges: Vec<bool>,
    /// Sizes of points, when they depend on the distance.
    pub(crate) sizes: Vec<f32>,
}

impl Processed {
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    pub(crate) fn clear(&mut self) {
        self.truncate(0, 0);
    }

    pub(crate) fn truncate(&mut self, count: usize, stride: usize) {
        self.positions.truncate(count);
        self.varyings.truncate(count * stride);
        self.back.truncate(count);
        self.eye.truncate(count);
        self.edges.truncate(count);
        self.sizes.truncate(count);
    }

    /// Copies vertex `from` over vertex `to`.
    pub(crate) fn copy(&mut self, from: usize, to: usize, stride: usize) {
        self.positions[to] = self.positions[from];
        self.varyings.copy_within(from * stride..(from + 1) * stride, to * stride);
        if !self.back.is_empty() {
            self.back[to] = self.back[from];
        }
        if !self.eye.is_empty() {
            self.eye[to] = self.eye[from];
        }
        if !self.edges.is_empty() {
            self.edges[to] = self.edges[from];
        }
        if !self.sizes.is_empty() {
            self.sizes[to] = self.sizes[from];
        }
    }
}

/// Where the fog coordinate comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FogSource {
    None,
    Distance,
    Coordinate,
}

/// Texture coordinates of one unit.
#[derive(Clone, Copy, Debug)]
struct UnitPlan {
    unit: usize,
    generation: [TexGen; 4],
    /// Any coordinate is generated.
    generates: bool,
    /// `None` for the identity.
    matrix: Option<Mat4>,
}

/// What to do with each vertex, worked out of the state once.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    clip_from_object: Mat4,
    pub(crate) eye_from_object: Mat4,
    eye_from_object_normal: Mat3,
    /// Normals are brought to length 1 by this factor, or by division when `normalize`.
    rescale: f32,
    normalize: bool,
    lighting: Option<Box<LightPlan>>,
    fog: FogSource,
    units: Vec<UnitPlan>,
    pub(crate) layout: Layout,
    /// Clip planes in eye space, those that are on.
    pub(crate) clip_planes: Vec<Vec4>,
    pub(crate) two_sided: bool,
    pub(crate) needs_normals: bool,
    needs_eye: bool,
    pub(crate) needs_edges: bool,
    needs_sizes: bool,
    point: crate::state::Point,
    /// Whether primitives need no look of their own where no user clip plane cuts them: filled, smooth, one colour for
    /// both sides.
    pub(crate) simple: bool,
    /// The same but for being flat, and without user clip planes.
    pub(crate) simple_flat: bool,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            clip_from_object: Mat4::IDENTITY,
            eye_from_object: Mat4::IDENTITY,
            eye_from_object_normal: Mat3::IDENTITY,
            rescale: 1.0,
            normalize: false,
            lighting: None,
            fog: FogSource::None,
            units: Vec::new(),
            layout: Layout::default(),
            clip_planes: Vec::new(),
            two_sided: false,
            needs_normals: false,
            needs_eye: false,
            needs_edges: false,
            needs_sizes: false,
            point: crate::state::Point::default(),
            simple: true,
            simple_flat: false,
        }
    }
}

/// The map from OpenGL's clip space to the rasterizer's: y down, z from 0 to w.
pub(crate) fn raster_from_clip(context: &Context) -> Mat4 {
    let t = &context.state.transform;
    // Row 0 of a buffer is the lowest; the rasterizer's is the one of greatest y.
    let y = if t.clip_origin == gl::UPPER_LEFT { 1.0 } else { -1.0 };
    let (z, w) = if t.clip_depth == gl::ZERO_TO_ONE { (1.0, 0.0) } else { (0.5, 0.5) };
    Mat4::from_cols(
        Vec4::X,
        Vec4::new(0.0, y, 0.0, 0.0),
        Vec4::new(0.0, 0.0, z, 0.0),
        Vec4::new(0.0, 0.0, w, 1.0),
    )
}

/// The matrix for normals: the inverse, transposed. Of a singular matrix, its cofactors.
pub(crate) fn normal_matrix(m: Mat4) -> Mat3 {
    let m = Mat3::from_mat4(m);
    let cofactors =
        Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let determinant = m.x_axis.dot(cofactors.x_axis);
    if determinant == 0.0 || !determinant.is_normal() { cofactors } else { cofactors * (1.0 / determinant) }
}

impl Plan {
    pub(crate) fn new(context: &Context) -> Self {
        let s = &context.state;
        let on = |cap| s.enabled.has(cap);
        let eye_from_object = context.modelview.top();
        let lighting = on(Cap::Lighting);
        let secondary = (lighting && s.lighting.color_control == gl::SEPARATE_SPECULAR_COLOR)
            || (!lighting && on(Cap::ColorSum));
        let fog = match (on(Cap::Fog), s.fog.coord_src) {
            (false, _) => FogSource::None,
            (true, gl::FOG_COORD) => FogSource::Coordinate,
            _ => FogSource::Distance,
        };
        // What is fed back has coordinates of the first unit even when it has no texture.
        let feedback = context.render_mode.mode == gl::FEEDBACK;
        let textured = (0..TEXTURE_UNITS)
            .filter(|&k| feedback && k == 0 || s.texturing.units[k].enabled.contains(&true));
        let units: Vec<UnitPlan> = textured.map(|k| unit_plan(context, k)).collect();
        let mask = units.iter().fold(0, |mask, u| mask | 1 << u.unit);
        let clip_planes: Vec<Vec4> = (0..CLIP_PLANES)
            .filter(|&k| s.enabled.has_nth(Cap::ClipPlane0, k))
            .map(|k| Vec4::from(s.transform.clip_planes[k].map(|v| v as f32)))
            .collect();
        let generates = |modes: &[_]| {
            units.iter().flat_map(|u| &u.generation).any(|g| g.enabled && modes.contains(&g.mode))
        };
        let by_normal = generates(&[gl::SPHERE_MAP, gl::NORMAL_MAP, gl::REFLECTION_MAP]);
        let needs_sizes = s.point.attenuation != [1.0, 0.0, 0.0];
        let two_sided = lighting && s.lighting.two_side;
        let filled = s.polygon.mode == [gl::FILL; 2];
        let flat = s.lighting.shade_model == gl::FLAT;
        let plain = filled && !two_sided && context.render_mode.is_render();
        let eye_from_object_normal = normal_matrix(eye_from_object);
        let third = eye_from_object_normal.transpose().col(2).length();
        Self {
            clip_from_object: raster_from_clip(context) * context.projection.top() * eye_from_object,
            eye_from_object,
            eye_from_object_normal,
            rescale: if on(Cap::RescaleNormal) && third > 0.0 { 1.0 / third } else { 1.0 },
            normalize: on(Cap::Normalize),
            lighting: lighting.then(|| Box::new(LightPlan::new(context))),
            fog,
            needs_eye: lighting
                || fog == FogSource::Distance
                || !clip_planes.is_empty()
                || needs_sizes
                || by_normal
                || generates(&[gl::EYE_LINEAR]),
            needs_normals: lighting || by_normal,
            layout: Layout::new(secondary, fog != FogSource::None, mask),
            units,
            two_sided,
            needs_edges: !filled,
            needs_sizes,
            point: s.point,
            simple: plain && !flat,
            simple_flat: plain && flat && clip_planes.is_empty(),
            clip_planes,
        }
    }

    /// Whether colours matter: not when lighting does without them.
    pub(crate) fn needs_colors(&self) -> bool {
        self.lighting.as_ref().is_none_or(|l| l.color_material())
    }

    pub(crate) fn needs_secondary(&self) -> bool {
        self.lighting.is_none() && self.layout.secondary.is_some()
    }

    pub(crate) fn needs_fog_coords(&self) -> bool {
        self.fog == FogSource::Coordinate
    }

    /// Whether the coordinates that the program gives a unit matter.
    pub(crate) fn needs_tex_coords(&self, unit: usize) -> bool {
        self.layout.tex_coords[unit].is_some()
    }

    /// Processes vertices and appends them.
    pub(crate) fn process(&self, input: &VertexInput<'_>, out: &mut Processed) {
        let (count, stride) = (input.positions.len(), usize::from(self.layout.stride));
        let first = out.positions.len();
        out.positions.resize(first + count, Vec4::ZERO);
        out.varyings.resize((first + count) * stride, 0.0);
        let mut grow = |wanted: bool, len: fn(&mut Processed, usize)| {
            if wanted {
                len(out, first + count);
            }
        };
        grow(self.two_sided, |o, n| o.back.resize(n, [0.0; 7]));
        grow(!self.clip_planes.is_empty(), |o, n| o.eye.resize(n, Vec4::ZERO));
        grow(self.needs_edges, |o, n| o.edges.resize(n, true));
        grow(self.needs_sizes, |o, n| o.sizes.resize(n, 1.0));
        let chunk = |from: usize| Chunk { plan: self, input, first: from };
        let positions = out.positions[first..].chunks_mut(CHUNK);
        let varyings = out.varyings[first * stride..].chunks_mut(CHUNK * stride);
        if count >= WORTH_SHARING {
            let jobs: Vec<_> = positions.zip(varyings).enumerate().collect();
            jobs.into_par_iter().for_each(|(n, (p, v))| chunk(n * CHUNK).main(p, v));
        } else {
            positions.zip(varyings).enumerate().for_each(|(n, (p, v))| chunk(n * CHUNK).main(p, v));
        }
        self.rarities(input, out, first);
    }

    /// What few programs need: back colours, eye positions, edge flags, sizes of points.
    fn rarities(&self, input: &VertexInput<'_>, out: &mut Processed, first: usize) {
        let chunk = Chunk { plan: self, input, first: 0 };
        for i in 0..input.positions.len() {
            let eye = if self.needs_eye { chunk.eye(i) } else { Vec4::ZERO };
            if let Some(back) = out.back.get_mut(first + i)
                && let Some(lighting) = &self.lighting
            {
                let lit = lighting.light(eye, -chunk.normal(i), input.colors.get(i), 1);
                back[..4].copy_from_slice(&lit.color);
                back[4..].copy_from_slice(&lit.secondary);
            }
            if let Some(to) = out.eye.get_mut(first + i) {
                *to = eye;
            }
            if let Some(to) = out.edges.get_mut(first + i) {
                *to = input.edge_flags.get(i);
            }
            if let Some(to) = out.sizes.get_mut(first + i) {
                *to = self.point_size(eye);
            }
            if out.back.is_empty() && out.eye.is_empty() && out.edges.is_empty() && out.sizes.is_empty() {
                return;
            }
        }
    }

    /// The size of a point at `eye`, before it is clamped for drawing (OpenGL 1.5, section 3.3).
    fn point_size(&self, eye: Vec4) -> f32 {
        // The distance along the axis of view, as drivers take it.
        let d = (eye.z / eye.w).abs();
        let [a, b, c] = self.point.attenuation;
        let size = self.point.size / (a + b * d + c * d * d).sqrt();
        if size.is_finite() { size.clamp(self.point.min, self.point.max) } else { self.point.max }
    }

    /// The raster position, window depth excepted: clip position of OpenGL, colours and texture coordinates.
    pub(crate) fn raster_vertex(&self, input: &VertexInput<'_>) -> RasterVertex {
        let chunk = Chunk { plan: self, input, first: 0 };
        let eye = self.eye_from_object * Vec4::from(input.positions[0]);
        let (color, secondary) = match &self.lighting {
            Some(lighting) => {
                let lit = lighting.light(eye, chunk.normal(0), input.colors.get(0), 0);
                (lit.color, lit.secondary)
            }
            None => (input.colors.get(0), input.secondary.get(0)),
        };
        let tex_coords = std::array::from_fn(|k| match self.units.iter().find(|u| u.unit == k) {
            Some(unit) => chunk.tex_coords(unit, 0, eye),
            None => input.tex_coords[k].get(0),
        });
        RasterVertex { eye, color, secondary, tex_coords }
    }
}

/// What a raster position takes from a vertex.
pub(crate) struct RasterVertex {
    pub(crate) eye: Vec4,
    pub(crate) color: [f32; 4],
    pub(crate) secondary: [f32; 3],
    pub(crate) tex_coords: [[f32; 4]; TEXTURE_UNITS],
}

fn unit_plan(context: &Context, unit: usize) -> UnitPlan {
    let generation = context.state.texturing.units[unit].generation;
    let matrix = context.texture_matrices[unit].top();
    UnitPlan {
        unit,
        generation,
        generates: generation.iter().any(|g| g.enabled),
        matrix: (matrix != Mat4::IDENTITY).then_some(matrix),
    }
}

/// Some of the vertices, from number `first` of the input on.
struct Chunk<'a> {
    plan: &'a Plan,
    input: &'a VertexInput<'a>,
    first: usize,
}

impl Chunk<'_> {
    /// Positions and varyings.
    fn main(&self, positions: &mut [Vec4], varyings: &mut [f32]) {
        let (plan, input) = (self.plan, self.input);
        let stride = usize::from(plan.layout.stride);
        let from = &input.positions[self.first..][..positions.len()];
        for (to, from) in positions.iter_mut().zip(from) {
            *to = plan.clip_from_object * Vec4::from(*from);
        }
        if let Some(lighting) = &plan.lighting {
            dispatch!(lighting.level, simd => self.light(simd, lighting, varyings));
            if stride == 4 {
                return;
            }
        }
        for (k, to) in varyings.chunks_exact_mut(stride).enumerate() {
            let i = self.first + k;
            let eye = if plan.needs_eye { self.eye(i) } else { Vec4::ZERO };
            if plan.lighting.is_none() {
                to[..4].copy_from_slice(&input.colors.get(i).map(clamp01));
                if let Some(at) = plan.layout.secondary {
                    to[usize::from(at)..][..3].copy_from_slice(&input.secondary.get(i).map(clamp01));
                }
            }
            if let Some(at) = plan.layout.fog {
                to[usize::from(at)] = match plan.fog {
                    FogSource::Coordinate => input.fog_coords.get(i),
                    // The specification allows |z| for the distance, which is what everyone takes.
                    _ => (eye.z / eye.w).abs(),
                };
            }
            for unit in &plan.units {
                if let Some(at) = plan.layout.tex_coords[unit.unit] {
                    let coords = self.tex_coords(unit, i, eye);
                    to[usize::from(at)..][..4].copy_from_slice(&coords);
                }
            }
        }
    }

    /// Colours of lit vertices, sixteen at a time.
    #[inline(always)]
    fn light<S: Simd>(&self, simd: S, lighting: &LightPlan, varyings: &mut [f32]) {
        let stride = usize::from(self.plan.layout.stride);
        for (n, some) in varyings.chunks_mut(LANES * stride).enumerate() {
            let (first, count) = (self.first + n * LANES, some.len() / stride);
            let eye = self.eyes(simd, first, count);
            let normal = self.normals(simd, first, count);
            let color = match lighting.color_material() {
                true => loaded(simd, &self.input.colors, first, count),
                false => [f32x16::splat(simd, 1.0); 4],
            };
            let lit = lighting.light_lanes(simd, eye, normal, color, 0);
            put(some, stride, 0, &lit.color);
            if let Some(at) = self.plan.layout.secondary {
                put(some, stride, usize::from(at), &lit.secondary);
            }
        }
    }

    /// As [`Self::eye`], of `count` vertices from number `first` on.
    #[inline(always)]
    fn eyes<S: Simd>(&self, simd: S, first: usize, count: usize) -> [f32x16<S>; 4] {
        let [x, y, z, w] = loaded(simd, &Attr::Each(self.input.positions), first, count);
        let m = self.plan.eye_from_object.to_cols_array_2d();
        let mut eye = [x; 4];
        for (k, eye) in eye.iter_mut().enumerate() {
            let [mx, my, mz, mw] = [
                f32x16::splat(simd, m[0][k]),
                f32x16::splat(simd, m[1][k]),
                f32x16::splat(simd, m[2][k]),
                f32x16::splat(simd, m[3][k]),
            ];
            *eye = mx * x + my * y + mz * z + mw * w;
        }
        eye
    }

    /// As [`Self::normal`], of `count` vertices from number `first` on.
    #[inline(always)]
    fn normals<S: Simd>(&self, simd: S, first: usize, count: usize) -> [f32x16<S>; 3] {
        let plan = self.plan;
        let [x, y, z] = loaded(simd, &self.input.normals, first, count);
        let m = plan.eye_from_object_normal.to_cols_array_2d();
        let rescale = f32x16::splat(simd, plan.rescale);
        let mut normal = [x; 3];
        for (k, normal) in normal.iter_mut().enumerate() {
            let [mx, my, mz] =
                [f32x16::splat(simd, m[0][k]), f32x16::splat(simd, m[1][k]), f32x16::splat(simd, m[2][k])];
            *normal = (mx * x + my * y + mz * z) * rescale;
        }
        if plan.normalize { normalized_or_zero(simd, normal) } else { normal }
    }

    #[inline]
    fn eye(&self, i: usize) -> Vec4 {
        self.plan.eye_from_object * Vec4::from(self.input.positions[i])
    }

    #[inline]
    fn normal(&self, i: usize) -> Vec3 {
        let n = self.plan.eye_from_object_normal * Vec3::from(self.input.normals.get(i)) * self.plan.rescale;
        if self.plan.normalize { n.normalize_or_zero() } else { n }
    }

    fn tex_coords(&self, unit: &UnitPlan, i: usize, eye: Vec4) -> [f32; 4] {
        let mut coords = self.input.tex_coords[unit.unit].get(i);
        if unit.generates {
            self.generate(unit, i, eye, &mut coords);
        }
        match unit.matrix {
            Some(m) => (m * Vec4::from(coords)).to_array(),
            None => coords,
        }
    }

    /// Generated texture coordinates (OpenGL 1.5, section 2.11.4).
    fn generate(&self, unit: &UnitPlan, i: usize, eye: Vec4, coords: &mut [f32; 4]) {
        let object = Vec4::from(self.input.positions[i]);
        let normal = || self.normal(i);
        let reflection = || {
            let u = (eye.xyz() / eye.w).normalize_or_zero();
            let n = normal();
            u - 2.0 * n * n.dot(u)
        };
        for (k, g) in unit.generation.iter().enumerate().filter(|(_, g)| g.enabled) {
            coords[k] = match g.mode {
                gl::OBJECT_LINEAR => Vec4::from(g.object_plane).dot(object),
                gl::EYE_LINEAR => Vec4::from(g.eye_plane).dot(eye),
                gl::SPHERE_MAP if k < 2 => {
                    let r = reflection();
                    let m = 2.0 * (r + Vec3::Z).length();
                    if m == 0.0 { 0.5 } else { r[k] / m + 0.5 }
                }
                gl::NORMAL_MAP if k < 3 => normal()[k],
                gl::REFLECTION_MAP if k < 3 => reflection()[k],
                _ => coords[k],
            };
        }
    }
}

/// An attribute of `count` vertices, at least one and at most sixteen, from number `first` on; of the last one from
/// there on.
#[inline(always)]
fn loaded<S: Simd, const N: usize>(
    simd: S,
    from: &Attr<'_, [f32; N]>,
    first: usize,
    count: usize,
) -> [f32x16<S>; N] {
    let mut lanes = [[0.0; LANES]; N];
    for lane in 0..LANES {
        let value = from.get(first + lane.min(count - 1));
        for (lanes, v) in lanes.iter_mut().zip(value) {
            lanes[lane] = v;
        }
    }
    let mut loaded = [f32x16::splat(simd, 0.0); N];
    for (to, lanes) in loaded.iter_mut().zip(&lanes) {
        *to = f32x16::load_array_ref(simd, lanes);
    }
    loaded
}

/// Puts numbers of as many vertices as there are into their varyings, from number `at` on.
#[inline(always)]
fn put<S: Simd, const N: usize>(varyings: &mut [f32], stride: usize, at: usize, from: &[f32x16<S>; N]) {
    let mut lanes = [[0.0; LANES]; N];
    for (to, from) in lanes.iter_mut().zip(from) {
        from.store_array(to);
    }
    for (lane, to) in varyings.chunks_exact_mut(stride).enumerate() {
        let Some(to) = to.get_mut(at..).and_then(|to| to.first_chunk_mut::<N>()) else { return };
        for (to, lanes) in to.iter_mut().zip(&lanes) {
            *to = lanes[lane % LANES];
        }
    }
}

/// Within [0, 1]; NaN becomes 0.
#[inline]
pub(crate) fn clamp01(v: f32) -> f32 {
    let low = if v > 0.0 { v } else { 0.0 };
    if low < 1.0 { low } else { 1.0 }
}
