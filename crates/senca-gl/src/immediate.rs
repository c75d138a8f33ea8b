//! Vertices one by one: `begin`, attributes, `end` (OpenGL 1.5, sections 2.6, 2.7).

use crate::component::{self, Component, coordinates};
use crate::list::{Attribute, Step};
use crate::state::TEXTURE_UNITS;
use crate::vertex::{Attr, Plan, Processed, VertexInput};
use crate::{Context, Enum, gl};
use senca_math::glam::Vec4;
use std::collections::HashMap;
use std::sync::Arc;

/// Vertices after which a run is drawn before it ends. Divides by 2, 3 and 4.
const RUN: usize = 65_520;
/// Vertices of a list's block from which on it is looked for some that are the same.
const WORTH_NUMBERING: usize = 64;
/// Most vertices of a polygon, which is drawn as a whole.
const MAX_POLYGON: usize = 1 << 24;

/// Vertices of the program, attribute by attribute. Attributes that do not matter are empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct VertexArrays {
    pub(crate) positions: Vec<[f32; 4]>,
    pub(crate) normals: Vec<[f32; 3]>,
    pub(crate) colors: Vec<[f32; 4]>,
    pub(crate) secondary: Vec<[f32; 3]>,
    pub(crate) fog_coords: Vec<f32>,
    pub(crate) edge_flags: Vec<bool>,
    pub(crate) tex_coords: [Vec<[f32; 4]>; TEXTURE_UNITS],
}

impl VertexArrays {
    pub(crate) fn clear(&mut self) {
        self.positions.clear();
        self.normals.clear();
        self.colors.clear();
        self.secondary.clear();
        self.fog_coords.clear();
        self.edge_flags.clear();
        self.tex_coords.iter_mut().for_each(Vec::clear);
    }

    /// Keeps one of the vertices that are the same to the last bit, if that is worth while; returns the vertices
    /// in their order by number.
    fn share_alike(&mut self) -> Option<Arc<[u32]>> {
        let count = self.positions.len();
        if count < WORTH_NUMBERING {
            return None;
        }
        let mut seen: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut kept = Vec::new();
        let elements: Vec<u32> = (0..count)
            .map(|i| {
                *seen.entry(self.bits(i)).or_insert_with(|| {
                    kept.push(i);
                    kept.len() as u32 - 1
                })
            })
            .collect();
        if kept.len() > count - count / 4 {
            return None;
        }
        self.keep(&kept);
        Some(elements.into())
    }

    /// All of a vertex.
    fn bits(&self, i: usize) -> Vec<u32> {
        let mut bits = Vec::with_capacity(16);
        let mut add = |v: Option<&[f32]>| bits.extend(v.unwrap_or_default().iter().map(|f| f.to_bits()));
        add(self.positions.get(i).map(|v| &v[..]));
        add(self.normals.get(i).map(|v| &v[..]));
        add(self.colors.get(i).map(|v| &v[..]));
        add(self.secondary.get(i).map(|v| &v[..]));
        self.tex_coords.iter().for_each(|t| add(t.get(i).map(|v| &v[..])));
        add(self.fog_coords.get(i).map(std::slice::from_ref));
        bits.extend(self.edge_flags.get(i).map(|e| u32::from(*e)));
        bits
    }

    /// Keeps the vertices of some numbers only.
    fn keep(&mut self, kept: &[usize]) {
        fn of<T: Copy>(v: &mut Vec<T>, kept: &[usize]) {
            if !v.is_empty() {
                *v = kept.iter().map(|i| v[*i]).collect();
            }
        }
        of(&mut self.positions, kept);
        of(&mut self.normals, kept);
        of(&mut self.colors, kept);
        of(&mut self.secondary, kept);
        of(&mut self.fog_coords, kept);
        of(&mut self.edge_flags, kept);
        self.tex_coords.iter_mut().for_each(|t| of(t, kept));
    }

    /// A view, with the current values where an attribute is empty.
    pub(crate) fn input<'a>(&'a self, current: &crate::state::Current) -> VertexInput<'a> {
        fn attr<T: Copy>(each: &[T], same: T) -> Attr<'_, T> {
            if each.is_empty() { Attr::Same(same) } else { Attr::Each(each) }
        }
        let [r, g, b, _] = current.secondary;
        VertexInput {
            positions: &self.positions,
            normals: attr(&self.normals, current.normal),
            colors: attr(&self.colors, current.color),
            secondary: attr(&self.secondary, [r, g, b]),
            fog_coords: attr(&self.fog_coords, current.fog_coord),
            edge_flags: attr(&self.edge_flags, current.edge_flag),
            tex_coords: std::array::from_fn(|k| attr(&self.tex_coords[k], current.tex_coords[k])),
        }
    }
}

/// A `begin`, its vertices and its `end`, of a display list.
#[derive(Debug)]
pub(crate) struct VertexBlock {
    mode: Enum,
    arrays: VertexArrays,
    /// The vertices in their order, where some are the same.
    elements: Option<Arc<[u32]>>,
    /// Attributes as they are at the end.
    last: Vec<Attribute>,
}

impl VertexBlock {
    /// `None` when some attribute is said for the first time after the first vertex: its value before that
    /// is known only when the list is called.
    pub(crate) fn new(mode: Enum, attributes: &[Attribute]) -> Option<Self> {
        let mut now: Vec<Attribute> = Vec::new();
        let mut arrays = VertexArrays::default();
        for a in attributes {
            let Attribute::Vertex(position) = *a else {
                match now.iter_mut().find(|n| n.same_kind(a)) {
                    Some(n) => *n = *a,
                    None if arrays.positions.is_empty() => now.push(*a),
                    None => return None,
                }
                continue;
            };
            arrays.positions.push(position);
            for n in &now {
                match *n {
                    Attribute::Vertex(_) | Attribute::Index(_) => {}
                    Attribute::Color(v) => arrays.colors.push(v),
                    Attribute::Secondary(v) => arrays.secondary.push(v),
                    Attribute::Normal(v) => arrays.normals.push(v),
                    Attribute::TexCoord(unit, v) => arrays.tex_coords[usize::from(unit)].push(v),
                    Attribute::FogCoord(v) => arrays.fog_coords.push(v),
                    Attribute::EdgeFlag(v) => arrays.edge_flags.push(v),
                }
            }
        }
        let elements = arrays.share_alike();
        Some(Self { mode, arrays, elements, last: now })
    }

    pub(crate) fn len(&self) -> usize {
        self.elements.as_ref().map_or(self.arrays.positions.len(), |e| e.len())
    }
}

impl Attribute {
    fn same_kind(&self, o: &Self) -> bool {
        match (self, o) {
            (Self::TexCoord(a, _), Self::TexCoord(b, _)) => a == b,
            _ => std::mem::discriminant(self) == std::mem::discriminant(o),
        }
    }
}

/// What is between `begin` and `end`.
#[derive(Debug, Default)]
pub(crate) struct Immediate {
    mode: Option<Enum>,
    input: VertexArrays,
    /// Vertices that are done with, but not yet assembled.
    pub(crate) processed: Processed,
    pub(crate) plan: Plan,
    /// Numbers of the vertices in their order, when it is not that of the arrays.
    pub(crate) elements: Option<Arc<[u32]>>,
    /// Some of the primitive has been drawn already.
    pub(crate) continued: bool,
}

impl Immediate {
    /// Whether `begin` has been said and `end` has not.
    #[inline]
    pub(crate) fn active(&self) -> bool {
        self.mode.is_some()
    }
}

impl Context {
    /// `glBegin`: what follows are the vertices of primitives, `POINTS` to `POLYGON`.
    pub fn begin(&mut self, mode: Enum) {
        if let Some(list) = &mut self.compiling {
            list.push(Step::Begin(mode));
            if !list.executes() {
                return;
            }
        }
        self.do_begin(mode);
    }

    /// `glEnd`.
    pub fn end(&mut self) {
        if let Some(list) = &mut self.compiling {
            list.push(Step::End);
            if !list.executes() {
                return;
            }
        }
        self.do_end();
    }

    /// `glVertex`, with 2 to 4 coordinates.
    #[inline]
    pub fn vertex<T: Component, const N: usize>(&mut self, v: [T; N]) {
        const { assert!(N >= 2, "a vertex has two to four coordinates") }
        let v = coordinates(v);
        if self.compiling.is_some() {
            return self.attribute(Attribute::Vertex(v));
        }
        let [x, y, z, w] = v;
        self.push_vertex(x, y, z, w);
    }

    /// `glColor`, with 3 or 4 components; without alpha it is 1.
    #[inline]
    pub fn color<T: Component, const N: usize>(&mut self, v: [T; N]) {
        let v = component::color(v);
        if self.compiling.is_some() {
            return self.attribute(Attribute::Color(v));
        }
        self.set_color(v);
    }

    /// `glSecondaryColor`.
    #[inline]
    pub fn secondary_color<T: Component>(&mut self, v: [T; 3]) {
        self.attribute(Attribute::Secondary(v.map(T::normalized)));
    }

    /// `glNormal`.
    #[inline]
    pub fn normal<T: Component>(&mut self, v: [T; 3]) {
        self.attribute(Attribute::Normal(v.map(T::normalized)));
    }

    /// `glTexCoord`, with 1 to 4 coordinates, of unit 0.
    #[inline]
    pub fn tex_coord<T: Component, const N: usize>(&mut self, v: [T; N]) {
        self.attribute(Attribute::TexCoord(0, coordinates(v)));
    }

    /// `glMultiTexCoord`: of unit `TEXTURE0`, `TEXTURE1`, ...
    #[inline]
    pub fn multi_tex_coord<T: Component, const N: usize>(&mut self, unit: Enum, v: [T; N]) {
        match unit.checked_sub(gl::TEXTURE0) {
            Some(k) if (k as usize) < TEXTURE_UNITS => {
                self.attribute(Attribute::TexCoord(k as u8, coordinates(v)));
            }
            _ => self.submit_anywhere(|c| c.error(gl::INVALID_ENUM)),
        }
    }

    /// `glFogCoord`.
    #[inline]
    pub fn fog_coord<T: Component>(&mut self, v: T) {
        self.attribute(Attribute::FogCoord(v.value()));
    }

    /// `glEdgeFlag`: whether edges that start at the vertices that follow are boundaries.
    #[inline]
    pub fn edge_flag(&mut self, flag: bool) {
        self.attribute(Attribute::EdgeFlag(flag));
    }

    /// `glIndex`: the current colour index. It is remembered; there is no colour index mode.
    #[inline]
    pub fn index<T: Component>(&mut self, v: T) {
        self.attribute(Attribute::Index(v.value()));
    }

    /// `glRect`: a rectangle in the plane z = 0, counter-clockwise when the second corner is above and right of the first.
    pub fn rect<T: Component>(&mut self, [x1, y1]: [T; 2], [x2, y2]: [T; 2]) {
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(T::value);
        self.submit(move |c| {
            c.do_begin(gl::POLYGON);
            for v in [[x1, y1], [x2, y1], [x2, y2], [x1, y2]] {
                c.do_attribute(Attribute::Vertex(coordinates(v)));
            }
            c.do_end();
        });
    }

    #[inline]
    pub(crate) fn attribute(&mut self, a: Attribute) {
        if let Some(list) = &mut self.compiling {
            list.push(Step::Attribute(a));
            if !list.executes() {
                return;
            }
        }
        self.do_attribute(a);
    }

    #[inline]
    pub(crate) fn do_attribute(&mut self, a: Attribute) {
        let current = &mut self.state.current;
        match a {
            Attribute::Vertex([x, y, z, w]) => self.push_vertex(x, y, z, w),
            Attribute::Color(v) => self.set_color(v),
            Attribute::Secondary([r, g, b]) => current.secondary = [r, g, b, 1.0],
            Attribute::Normal(v) => current.normal = v,
            Attribute::TexCoord(unit, v) => current.tex_coords[usize::from(unit)] = v,
            Attribute::FogCoord(v) => current.fog_coord = v,
            Attribute::EdgeFlag(v) => current.edge_flag = v,
            Attribute::Index(v) => current.index = v,
        }
    }

    /// Stored as one vector: the next vertex reads it as one, and would wait for four numbers to be written.
    #[inline]
    fn set_color(&mut self, [r, g, b, a]: [f32; 4]) {
        Vec4::new(r, g, b, a).write_to_slice(&mut self.state.current.color);
    }

    /// The coordinates come one by one, so that they stay in registers.
    fn push_vertex(&mut self, x: f32, y: f32, z: f32, w: f32) {
        let Immediate { mode: Some(mode), input, plan, .. } = &mut self.immediate else {
            // A vertex outside of begin and end means nothing.
            return;
        };
        let (current, mode) = (&self.state.current, *mode);
        input.positions.push([x, y, z, w]);
        if plan.needs_colors() {
            input.colors.push(current.color);
        }
        if plan.needs_normals {
            input.normals.push(current.normal);
        }
        if plan.needs_edges {
            input.edge_flags.push(current.edge_flag);
        }
        if plan.layout.stride > 4 {
            let [r, g, b, _] = current.secondary;
            if plan.needs_secondary() {
                input.secondary.push([r, g, b]);
            }
            if plan.needs_fog_coords() {
                input.fog_coords.push(current.fog_coord);
            }
            for unit in 0..TEXTURE_UNITS {
                if plan.needs_tex_coords(unit) {
                    input.tex_coords[unit].push(current.tex_coords[unit]);
                }
            }
        }
        if input.positions.len() >= RUN {
            self.process_input();
            if mode != gl::POLYGON {
                self.draw_run(mode);
            } else if self.immediate.processed.len() > MAX_POLYGON {
                self.immediate.processed.clear();
                self.error(gl::OUT_OF_MEMORY);
            }
        }
    }

    pub(crate) fn do_begin(&mut self, mode: Enum) {
        if self.immediate.active() {
            return self.error(gl::INVALID_OPERATION);
        }
        if mode > gl::POLYGON {
            return self.error(gl::INVALID_ENUM);
        }
        if !self.may_draw() {
            return;
        }
        self.make_plan();
        self.immediate.mode = Some(mode);
        self.immediate.continued = false;
    }

    pub(crate) fn do_end(&mut self) {
        let Some(mode) = self.immediate.mode else { return self.error(gl::INVALID_OPERATION) };
        self.process_input();
        self.assemble(mode, true);
        self.immediate.processed.clear();
        self.immediate.mode = None;
    }

    pub(crate) fn do_block(&mut self, block: &VertexBlock) {
        self.draw_indexed(block.mode, &block.arrays, block.elements.clone());
        block.last.iter().for_each(|a| self.do_attribute(*a));
    }

    /// Draws primitives from arrays, in the order of `elements` if there are any.
    pub(crate) fn draw_indexed(&mut self, mode: Enum, arrays: &VertexArrays, elements: Option<Arc<[u32]>>) {
        self.do_begin(mode);
        if !self.immediate.active() {
            return;
        }
        self.immediate.plan.process(&arrays.input(&self.state.current), &mut self.immediate.processed);
        self.immediate.elements = elements;
        self.do_end();
        self.immediate.elements = None;
    }

    /// Works the plan out again where something may have changed.
    pub(crate) fn make_plan(&mut self) {
        if self.vertex_changed {
            self.vertex_changed = false;
            self.immediate.plan = Plan::new(self);
        }
    }

    /// Processes the vertices given so far. Between `begin` and `end` materials may change: what was before
    /// is lit as it was before.
    pub(crate) fn process_input(&mut self) {
        let i = &mut self.immediate;
        if !i.input.positions.is_empty() {
            i.plan.process(&i.input.input(&self.state.current), &mut i.processed);
            i.input.clear();
        }
    }

    /// Says that a material is about to change.
    pub(crate) fn before_material(&mut self) {
        if self.immediate.active() {
            self.process_input();
        }
    }

    /// Says that a material has changed.
    pub(crate) fn after_material(&mut self) {
        if self.immediate.active() {
            self.immediate.plan = Plan::new(self);
        } else {
            self.touch_vertices();
        }
    }

    /// Draws what is complete and keeps what goes on.
    fn draw_run(&mut self, mode: Enum) {
        self.assemble(mode, false);
        let stride = usize::from(self.immediate.plan.layout.stride);
        let p = &mut self.immediate.processed;
        let count = p.len();
        let kept: &[usize] = match mode {
            gl::POINTS | gl::LINES | gl::TRIANGLES | gl::QUADS => &[],
            gl::LINE_STRIP => &[count - 1],
            gl::TRIANGLE_STRIP | gl::QUAD_STRIP => &[count - 2, count - 1],
            // The first and the last.
            _ => &[0, count - 1],
        };
        for (to, &from) in kept.iter().enumerate() {
            p.copy(from, to, stride);
        }
        p.truncate(kept.len(), stride);
        self.immediate.continued = true;
    }
}
