//! Vertices into points, lines and polygons (OpenGL 1.5, sections 2.6.1, 2.12, 2.13.6, 2.14.7, 3.5).
//!
//! Primitives that need nothing of their own are only numbered. Others - flat, lit on two sides, cut by user
//! clip planes, drawn as lines or points, selected or fed back - are gone through one by one.

use crate::raster_state::Kind;
use crate::vertex::{Plan, Processed};
use crate::{Context, Enum, gl};
use senca_math::glam::Vec4;
use smallvec::SmallVec;

/// A vertex on its own.
#[derive(Clone, Debug)]
pub(crate) struct Vertex {
    pub(crate) position: Vec4,
    pub(crate) varyings: SmallVec<[f32; 12]>,
    back: [f32; 7],
    eye: Vec4,
    /// Whether the edge to the next vertex is a boundary.
    edge: bool,
    size: f32,
}

impl Vertex {
    fn of(p: &Processed, i: usize, stride: usize) -> Self {
        Self {
            position: p.positions[i],
            varyings: SmallVec::from_slice(&p.varyings[i * stride..(i + 1) * stride]),
            back: p.back.get(i).copied().unwrap_or_default(),
            eye: p.eye.get(i).copied().unwrap_or_default(),
            edge: p.edges.get(i).copied().unwrap_or(true),
            size: p.sizes.get(i).copied().unwrap_or(1.0),
        }
    }

    /// The vertex at `t` of the way to `o`.
    fn towards(&self, o: &Self, t: f32, edge: bool) -> Self {
        let mix = |a: f32, b: f32| a * (1.0 - t) + b * t;
        Self {
            position: self.position * (1.0 - t) + o.position * t,
            varyings: self.varyings.iter().zip(&o.varyings).map(|(a, b)| mix(*a, *b)).collect(),
            back: std::array::from_fn(|k| mix(self.back[k], o.back[k])),
            eye: self.eye * (1.0 - t) + o.eye * t,
            edge,
            size: mix(self.size, o.size),
        }
    }

    /// The vertex at `t` of the way to `o`; itself at 0.
    pub(crate) fn between(&self, o: &Self, t: f32) -> Self {
        self.towards(o, t, self.edge)
    }

    /// Whether the edge to the next vertex is a boundary.
    pub(crate) fn starts_boundary(&self) -> bool {
        self.edge
    }

    /// Takes the colours of another vertex.
    fn take_colors(&mut self, o: &Self, secondary: Option<u8>) {
        self.varyings[..4].copy_from_slice(&o.varyings[..4]);
        if let Some(at) = secondary.map(usize::from) {
            self.varyings[at..at + 3].copy_from_slice(&o.varyings[at..at + 3]);
        }
        self.back = o.back;
    }

    /// Shows its back colours.
    fn turn(&mut self, secondary: Option<u8>) {
        self.varyings[..4].copy_from_slice(&self.back[..4]);
        if let Some(at) = secondary.map(usize::from) {
            self.varyings[at..at + 3].copy_from_slice(&self.back[4..]);
        }
    }
}

/// Polygons of a mode as vertex numbers, in their order around, and which vertex colours them when flat.
fn each_polygon(mode: Enum, count: usize, mut f: impl FnMut(&[usize], usize)) {
    match mode {
        gl::TRIANGLES => (0..count / 3).for_each(|k| f(&[3 * k, 3 * k + 1, 3 * k + 2], 3 * k + 2)),
        gl::TRIANGLE_STRIP => {
            for k in 0..count.saturating_sub(2) {
                if k % 2 == 0 { f(&[k, k + 1, k + 2], k + 2) } else { f(&[k + 1, k, k + 2], k + 2) }
            }
        }
        gl::TRIANGLE_FAN => (1..count.saturating_sub(1)).for_each(|k| f(&[0, k, k + 1], k + 1)),
        gl::QUADS => {
            for k in (0..count / 4).map(|k| 4 * k) {
                f(&[k, k + 1, k + 2, k + 3], k + 3);
            }
        }
        gl::QUAD_STRIP => {
            for k in (0..(count / 2).saturating_sub(1)).map(|k| 2 * k) {
                f(&[k, k + 1, k + 3, k + 2], k + 3);
            }
        }
        _ => {
            if count >= 3 {
                f(&(0..count).collect::<Vec<_>>(), 0);
            }
        }
    }
}

/// Triangles of a mode as vertex numbers from `base` on. A quadrilateral is cut from its second corner to its
/// last, one of a strip from its first to its third.
fn number_triangles(mode: Enum, count: usize, base: u32, out: &mut Vec<u32>) {
    let count = count as u32;
    match mode {
        gl::TRIANGLES => out.extend(base..base + count / 3 * 3),
        gl::TRIANGLE_STRIP => {
            for k in base..base + count.saturating_sub(2) {
                let odd = (k - base) % 2;
                out.extend([k + odd, k + 1 - odd, k + 2]);
            }
        }
        gl::QUADS => {
            for k in (0..count / 4).map(|k| base + 4 * k) {
                out.extend([k, k + 1, k + 3, k + 1, k + 2, k + 3]);
            }
        }
        gl::QUAD_STRIP => {
            for k in (0..(count / 2).saturating_sub(1)).map(|k| base + 2 * k) {
                out.extend([k + 2, k, k + 3, k, k + 1, k + 3]);
            }
        }
        _ => (1..count.saturating_sub(1)).for_each(|k| out.extend([base, base + k, base + k + 1])),
    }
}

/// Segments of a mode as vertex numbers, and whether each goes on from the one before.
fn each_segment(
    mode: Enum,
    count: usize,
    continued: bool,
    last: bool,
    mut f: impl FnMut(usize, usize, bool),
) {
    if mode == gl::LINES {
        return (0..count / 2).for_each(|k| f(2 * k, 2 * k + 1, false));
    }
    // A loop that goes on keeps its first vertex in front.
    let first = usize::from(mode == gl::LINE_LOOP && continued);
    for k in first + 1..count {
        f(k - 1, k, continued || k > 1);
    }
    if mode == gl::LINE_LOOP && last && count >= 2 {
        f(count - 1, 0, true);
    }
}

/// The vertices of primitives: so many, in their own order or another.
#[derive(Clone, Copy)]
struct Order<'a> {
    elements: Option<&'a [u32]>,
    count: usize,
}

impl Order<'_> {
    /// Number of the vertex that comes as number `k`.
    fn at(&self, k: usize) -> usize {
        self.elements.map_or(k, |e| e[k] as usize)
    }
}

impl Context {
    /// Turns the processed vertices into primitives; with `last`, they are all.
    pub(crate) fn assemble(&mut self, mode: Enum, last: bool) {
        let mut processed = std::mem::take(&mut self.immediate.processed);
        let plan = std::mem::take(&mut self.immediate.plan);
        let elements = self.immediate.elements.take();
        let order = Order {
            elements: elements.as_deref(),
            count: elements.as_ref().map_or(processed.len(), |e| e.len()),
        };
        match mode {
            gl::POINTS => self.points(&plan, &processed, order),
            gl::LINES | gl::LINE_LOOP | gl::LINE_STRIP => self.lines(mode, &plan, &processed, order, last),
            _ if plan.simple && plan.clip_planes.is_empty() => {
                self.simple_polygons(mode, &plan, &mut processed, order, last);
            }
            _ if plan.simple => self.cut_polygons(mode, &plan, &mut processed, order, last),
            _ => self.polygons(mode, &plan, &processed, order),
        }
        self.immediate.plan = plan;
        self.immediate.processed = processed;
    }

    fn points(&mut self, plan: &Plan, p: &Processed, order: Order<'_>) {
        let stride = usize::from(plan.layout.stride);
        if plan.clip_planes.is_empty() && self.render_mode.is_render() {
            let base = self.begin_batch(Kind::Points, plan.layout);
            self.batch.extend(p);
            self.batch.indices.extend((0..order.count).map(|k| base + order.at(k) as u32));
            return;
        }
        for i in (0..order.count).map(|k| order.at(k)) {
            if plan.clip_planes.iter().all(|n| n.dot(p.eye[i]) >= 0.0) {
                let vertex = Vertex::of(p, i, stride);
                if self.render_mode.is_render() {
                    self.begin_batch(Kind::Points, plan.layout);
                    let i = self.emit(&vertex);
                    self.batch.indices.push(i);
                } else {
                    self.report_point(&vertex, plan.layout);
                }
            }
        }
    }

    fn lines(&mut self, mode: Enum, plan: &Plan, p: &Processed, order: Order<'_>, last: bool) {
        let continued = self.immediate.continued;
        let flat = self.state.lighting.shade_model == gl::FLAT;
        if plan.clip_planes.is_empty() && self.render_mode.is_render() && !flat {
            let base = self.begin_batch(Kind::Lines, plan.layout);
            self.batch.extend(p);
            let batch = &mut self.batch;
            each_segment(mode, order.count, continued, last, |a, b, goes_on| {
                batch.indices.extend([a, b].map(|k| base + order.at(k) as u32));
                batch.continues.push(goes_on);
            });
            return;
        }
        let stride = usize::from(plan.layout.stride);
        each_segment(mode, order.count, continued, last, |a, b, goes_on| {
            let (mut a, mut b) = (Vertex::of(p, order.at(a), stride), Vertex::of(p, order.at(b), stride));
            if flat {
                a.take_colors(&b.clone(), plan.layout.secondary);
            }
            for n in &plan.clip_planes {
                let (da, db) = (n.dot(a.eye), n.dot(b.eye));
                match (da < 0.0, db < 0.0) {
                    (true, true) => return,
                    (true, false) => a = a.towards(&b, da / (da - db), true),
                    (false, true) => b = b.towards(&a, db / (db - da), true),
                    (false, false) => {}
                }
            }
            if self.render_mode.is_render() {
                self.begin_batch(Kind::Lines, plan.layout);
                self.emit_line(&a, &b, goes_on);
            } else {
                self.report_line(&a, &b, plan.layout, goes_on);
            }
        });
    }

    fn polygons(&mut self, mode: Enum, plan: &Plan, p: &Processed, order: Order<'_>) {
        if self.is_culled(true) && self.is_culled(false) {
            return;
        }
        if plan.simple_flat {
            return self.flat_polygons(mode, plan, p, order);
        }
        let flat = self.state.lighting.shade_model == gl::FLAT;
        let secondary = plan.layout.secondary;
        let stride = usize::from(plan.layout.stride);
        each_polygon(mode, order.count, |numbers, provoking| {
            let mut corners: Vec<Vertex> =
                numbers.iter().map(|&k| Vertex::of(p, order.at(k), stride)).collect();
            if matches!(mode, gl::TRIANGLE_STRIP | gl::TRIANGLE_FAN | gl::QUAD_STRIP) {
                // Edge flags are of separate polygons only.
                corners.iter_mut().for_each(|c| c.edge = true);
            }
            if flat {
                let from = Vertex::of(p, order.at(provoking), stride);
                corners.iter_mut().for_each(|c| c.take_colors(&from, secondary));
            }
            for n in &plan.clip_planes {
                corners = clipped(corners, |v| n.dot(v.eye));
            }
            if corners.len() >= 3 {
                self.polygon(corners, plan);
            }
        });
    }

    /// Polygons that need no look of their own. Takes the vertices away if they are the last.
    fn simple_polygons(&mut self, mode: Enum, plan: &Plan, p: &mut Processed, order: Order<'_>, last: bool) {
        if self.is_culled(true) && self.is_culled(false) {
            return;
        }
        let base = self.begin_batch(Kind::Triangles, plan.layout);
        if last {
            self.batch.take(p);
        } else {
            self.batch.extend(p);
        }
        let first = self.batch.indices.len();
        match order.elements {
            None => number_triangles(mode, order.count, base, &mut self.batch.indices),
            Some(elements) if mode == gl::TRIANGLES => {
                let whole = &elements[..order.count / 3 * 3];
                self.batch.indices.extend(whole.iter().map(|i| base + i));
            }
            Some(elements) => {
                number_triangles(mode, order.count, 0, &mut self.batch.indices);
                self.batch.indices[first..].iter_mut().for_each(|i| *i = base + elements[*i as usize]);
            }
        }
    }

    /// Polygons that need no look of their own unless a user clip plane goes through them; triangle by triangle.
    fn cut_polygons(&mut self, mode: Enum, plan: &Plan, p: &mut Processed, order: Order<'_>, last: bool) {
        // Of each vertex the planes it is beyond, bit by bit.
        let beyond: Vec<u8> = p.eye.iter().map(|eye| beyond(&plan.clip_planes, *eye)).collect();
        if beyond.iter().all(|planes| *planes == 0) {
            return self.simple_polygons(mode, plan, p, order, last);
        }
        let none_left = beyond.iter().fold(u8::MAX, |all, planes| all & planes) != 0;
        if none_left || (self.is_culled(true) && self.is_culled(false)) {
            return;
        }
        let stride = usize::from(plan.layout.stride);
        let base = self.begin_batch(Kind::Triangles, plan.layout);
        self.batch.extend(p);
        let mut numbers = Vec::new();
        number_triangles(mode, order.count, 0, &mut numbers);
        for triangle in numbers.as_chunks::<3>().0 {
            let triangle = triangle.map(|k| order.at(k as usize));
            let [a, b, c] = triangle.map(|i| beyond[i]);
            if a | b | c == 0 {
                self.batch.indices.extend(triangle.map(|i| base + i as u32));
            } else if a & b & c == 0 {
                let mut corners: Vec<Vertex> = triangle.iter().map(|&i| Vertex::of(p, i, stride)).collect();
                for n in &plan.clip_planes {
                    corners = clipped(corners, |v| n.dot(v.eye));
                }
                self.emit_fan(&corners);
            }
        }
    }

    /// Polygons of one colour each that need nothing else.
    fn flat_polygons(&mut self, mode: Enum, plan: &Plan, p: &Processed, order: Order<'_>) {
        let stride = usize::from(plan.layout.stride);
        let (secondary, sized) = (plan.layout.secondary.map(usize::from), self.immediate_sizes());
        self.begin_batch(Kind::Triangles, plan.layout);
        let batch = &mut self.batch;
        each_polygon(mode, order.count, |numbers, provoking| {
            let from = &p.varyings[order.at(provoking) * stride..][..stride];
            let base = batch.positions.len() as u32;
            for &k in numbers {
                let i = order.at(k);
                batch.positions.push(p.positions[i]);
                let at = batch.varyings.len();
                batch.varyings.extend_from_slice(&p.varyings[i * stride..][..stride]);
                batch.varyings[at..at + 4].copy_from_slice(&from[..4]);
                if let Some(second) = secondary {
                    batch.varyings[at + second..][..3].copy_from_slice(&from[second..][..3]);
                }
                if sized {
                    batch.sizes.push(p.sizes.get(i).copied().unwrap_or(1.0));
                }
            }
            number_fan(base, numbers.len(), &mut batch.indices);
        });
    }

    /// A convex polygon within the user clip planes.
    fn polygon(&mut self, mut corners: Vec<Vertex>, plan: &Plan) {
        let front = self.shows_front(&corners);
        if plan.two_sided && !front {
            corners.iter_mut().for_each(|c| c.turn(plan.layout.secondary));
        }
        let mode = self.state.polygon.mode[usize::from(!front)];
        if mode == gl::FILL && self.render_mode.is_render() {
            self.begin_batch(Kind::Triangles, plan.layout);
            return self.emit_fan(&corners);
        }
        if self.is_culled(front) {
            return;
        }
        // What is not filled is cut by the view volume here: the cut makes edges, too.
        for plane in &senca_raster::clip::VIEW_VOLUME {
            corners = clipped(corners, |v| -plane.dot(v.position));
        }
        if corners.len() < 3 {
            return;
        }
        if !self.render_mode.is_render() {
            return self.report_polygon(&corners, plan.layout, mode);
        }
        let kind = if mode == gl::LINE { Kind::PolygonLines } else { Kind::PolygonPoints };
        self.begin_batch(kind, plan.layout);
        for (k, corner) in corners.iter().enumerate().filter(|(_, c)| c.edge) {
            if mode == gl::LINE {
                self.emit_line(corner, &corners[(k + 1) % corners.len()], k > 0 && corners[k - 1].edge);
            } else {
                let i = self.emit(corner);
                self.batch.indices.push(i);
            }
        }
    }

    /// Whether a polygon shows its front, by its sense of rotation in the window.
    fn shows_front(&self, corners: &[Vertex]) -> bool {
        let row = |v: &Vertex| {
            senca_math::glam::DVec3::new(
                f64::from(v.position.x),
                f64::from(v.position.y),
                f64::from(v.position.w),
            )
        };
        let first = row(&corners[0]);
        let area: f64 = corners[1..].windows(2).map(|w| first.dot(row(&w[0]).cross(row(&w[1])))).sum();
        // The rasterizer's y points the other way, unless the clip origin is above, which does not count.
        let upper = self.state.transform.clip_origin == gl::UPPER_LEFT;
        let counter_clockwise = if upper { area > 0.0 } else { area < 0.0 };
        counter_clockwise == (self.state.polygon.front_face == gl::CCW)
    }

    fn is_culled(&self, front: bool) -> bool {
        self.state.enabled.has(crate::state::Cap::CullFace)
            && match self.state.polygon.cull_face {
                gl::FRONT => front,
                gl::BACK => !front,
                _ => true,
            }
    }

    /// Appends a vertex to the batch; returns its number.
    fn emit(&mut self, v: &Vertex) -> u32 {
        let i = self.batch.positions.len() as u32;
        self.batch.positions.push(v.position);
        self.batch.varyings.extend_from_slice(&v.varyings);
        if self.immediate_sizes() {
            self.batch.sizes.push(v.size);
        }
        i
    }

    fn immediate_sizes(&self) -> bool {
        self.state.point.attenuation != [1.0, 0.0, 0.0]
    }

    fn emit_line(&mut self, a: &Vertex, b: &Vertex, goes_on: bool) {
        let (a, b) = (self.emit(a), self.emit(b));
        self.batch.indices.extend([a, b]);
        self.batch.continues.push(goes_on);
    }

    fn emit_fan(&mut self, corners: &[Vertex]) {
        let base = self.batch.positions.len() as u32;
        for v in corners {
            self.emit(v);
        }
        number_fan(base, corners.len(), &mut self.batch.indices);
    }
}

/// The planes that a place is beyond, bit by bit.
fn beyond(planes: &[Vec4], eye: Vec4) -> u8 {
    planes.iter().enumerate().fold(0, |bits, (k, n)| {
        let within = n.dot(eye) >= 0.0;
        bits | u8::from(!within) << k
    })
}

/// The triangles of a convex polygon of `count` corners, numbered from `base` on.
fn number_fan(base: u32, count: usize, indices: &mut Vec<u32>) {
    if count == 4 {
        return indices.extend([0, 1, 3, 1, 2, 3].map(|k| base + k));
    }
    for k in 1..(count as u32).saturating_sub(1) {
        indices.extend([base, base + k, base + k + 1]);
    }
}

/// The part of a convex polygon where `side` is not negative. Edges that the cut makes are boundaries.
fn clipped(corners: Vec<Vertex>, side: impl Fn(&Vertex) -> f32) -> Vec<Vertex> {
    let sides: Vec<f32> = corners.iter().map(side).collect();
    if sides.iter().all(|s| *s >= 0.0) {
        return corners;
    }
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (k, a) in corners.iter().enumerate() {
        let next = (k + 1) % corners.len();
        let (b, sa, sb) = (&corners[next], sides[k], sides[next]);
        if sa >= 0.0 {
            kept.push(a.clone());
        }
        if sa >= 0.0 && sb < 0.0 {
            // From here the cut goes on.
            kept.push(a.towards(b, sa / (sa - sb), true));
        } else if sa < 0.0 && sb >= 0.0 {
            kept.push(b.towards(a, sb / (sb - sa), a.edge));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mode: Enum, count: usize) -> Vec<u32> {
        let mut out = Vec::new();
        number_triangles(mode, count, 0, &mut out);
        out
    }

    #[test]
    fn modes_number_their_triangles() {
        assert_eq!(triangles(gl::TRIANGLES, 5), [0, 1, 2]);
        assert_eq!(triangles(gl::TRIANGLE_STRIP, 5), [0, 1, 2, 2, 1, 3, 2, 3, 4]);
        assert_eq!(triangles(gl::TRIANGLE_FAN, 5), [0, 1, 2, 0, 2, 3, 0, 3, 4]);
        assert_eq!(triangles(gl::QUADS, 7), [0, 1, 3, 1, 2, 3]);
        assert_eq!(triangles(gl::QUAD_STRIP, 5), [2, 0, 3, 0, 1, 3]);
        assert_eq!(triangles(gl::POLYGON, 4), [0, 1, 2, 0, 2, 3]);
        assert!(
            (gl::TRIANGLES..=gl::POLYGON).all(|m| triangles(m, 2).is_empty() && triangles(m, 0).is_empty())
        );
    }

    #[test]
    fn polygons_turn_the_same_way_and_know_who_colours_them() {
        let mut all = Vec::new();
        each_polygon(gl::TRIANGLE_STRIP, 4, |v, p| all.push((v.to_vec(), p)));
        each_polygon(gl::QUAD_STRIP, 6, |v, p| all.push((v.to_vec(), p)));
        each_polygon(gl::QUADS, 4, |v, p| all.push((v.to_vec(), p)));
        each_polygon(gl::POLYGON, 5, |v, p| all.push((v.to_vec(), p)));
        let expected: [(&[usize], usize); 6] = [
            (&[0, 1, 2], 2),
            (&[2, 1, 3], 3),
            (&[0, 1, 3, 2], 3),
            (&[2, 3, 5, 4], 5),
            (&[0, 1, 2, 3], 3),
            (&[0, 1, 2, 3, 4], 0),
        ];
        assert_eq!(all.len(), expected.len());
        for ((v, p), (ev, ep)) in all.iter().zip(expected) {
            assert_eq!((v.as_slice(), *p), (ev, ep));
        }
    }

    #[test]
    fn a_loop_closes_once_also_in_pieces() {
        let mut seen = Vec::new();
        each_segment(gl::LINE_LOOP, 3, false, true, |a, b, on| seen.push((a, b, on)));
        assert_eq!(seen, [(0, 1, false), (1, 2, true), (2, 0, true)]);
        seen.clear();
        each_segment(gl::LINE_LOOP, 3, false, false, |a, b, on| seen.push((a, b, on)));
        // What is kept: the first vertex and the last, 1; then one more comes.
        each_segment(gl::LINE_LOOP, 3, true, true, |a, b, on| seen.push((a, b, on)));
        assert_eq!(seen, [(0, 1, false), (1, 2, true), (1, 2, true), (2, 0, true)]);
        seen.clear();
        each_segment(gl::LINES, 5, false, true, |a, b, on| seen.push((a, b, on)));
        assert_eq!(seen, [(0, 1, false), (2, 3, false)]);
    }
}
