//! Evaluators: Bézier curves and surfaces (OpenGL 1.5, section 5.1).

use crate::immediate::VertexArrays;
use crate::list::Attribute;
use crate::{Context, Enum, gl};
use std::sync::Arc;

/// Targets of maps: `COLOR_4`, `INDEX`, `NORMAL`, `TEXTURE_COORD_1` to `4`, `VERTEX_3`, `VERTEX_4`.
pub(crate) const TARGETS: usize = 9;
/// Greatest order of a map.
pub const MAX_ORDER: usize = 32;
/// Most points of a mesh drawn at once.
const MAX_GRID_POINTS: usize = 1 << 24;
/// Components of the targets.
const COMPONENTS: [usize; TARGETS] = [4, 1, 3, 1, 2, 3, 4, 3, 4];
const COLOR: usize = 0;
const INDEX: usize = 1;
const NORMAL: usize = 2;
const TEXTURE: usize = 3;
const VERTEX_3: usize = 7;
const VERTEX_4: usize = 8;

/// One map: control points, the last axis fastest, without gaps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Map {
    /// Control points along u and v; 1 along v for a curve.
    pub(crate) order: [usize; 2],
    /// Parameters at both ends, of u and v.
    pub(crate) domain: [[f32; 2]; 2],
    pub(crate) points: Vec<f32>,
}

/// All maps and grids.
#[derive(Clone, Debug)]
pub(crate) struct Evaluators {
    pub(crate) curves: [Arc<Map>; TARGETS],
    pub(crate) surfaces: [Arc<Map>; TARGETS],
    pub(crate) grid1: (i32, [f32; 2]),
    pub(crate) grid2: ([i32; 2], [[f32; 2]; 2]),
}

impl Default for Evaluators {
    fn default() -> Self {
        let first = |target: usize| -> Vec<f32> {
            match target {
                COLOR => vec![1.0; 4],
                INDEX => vec![1.0],
                NORMAL => vec![0.0, 0.0, 1.0],
                _ => [0.0, 0.0, 0.0, 1.0][..COMPONENTS[target]].to_vec(),
            }
        };
        let map = |target| Arc::new(Map { order: [1, 1], domain: [[0.0, 1.0]; 2], points: first(target) });
        Self {
            curves: std::array::from_fn(map),
            surfaces: std::array::from_fn(map),
            grid1: (1, [0.0, 1.0]),
            grid2: ([1, 1], [[0.0, 1.0]; 2]),
        }
    }
}

/// Bernstein polynomials of degree `order - 1` at `t`.
fn bernstein(order: usize, t: f32) -> [f32; MAX_ORDER] {
    let mut b = [0.0; MAX_ORDER];
    b[0] = 1.0;
    for degree in 1..order.min(MAX_ORDER) {
        for k in (1..=degree).rev() {
            b[k] = b[k] * (1.0 - t) + b[k - 1] * t;
        }
        b[0] *= 1.0 - t;
    }
    b
}

/// Derivatives of the Bernstein polynomials.
fn slopes(order: usize, t: f32) -> [f32; MAX_ORDER] {
    let lower = bernstein(order - 1, t);
    let degree = (order - 1) as f32;
    std::array::from_fn(|k| {
        let before = if k > 0 && order > 1 { lower[k - 1] } else { 0.0 };
        let here = if k + 1 < order { lower[k] } else { 0.0 };
        degree * (before - here)
    })
}

impl Map {
    /// Weights of the control points along an axis, and those of the derivative by the parameter.
    fn weights(&self, axis: usize, value: f32) -> ([f32; MAX_ORDER], [f32; MAX_ORDER]) {
        let [from, to] = self.domain[axis];
        let t = (value - from) / (to - from);
        let order = self.order[axis];
        let slope = if order > 1 { slopes(order, t) } else { [0.0; MAX_ORDER] };
        (bernstein(order, t), slope.map(|s| s / (to - from)))
    }

    /// The curve along v at weights along u: its control points.
    fn curve(&self, components: usize, u: &[f32; MAX_ORDER]) -> Vec<[f32; 4]> {
        let mut curve = vec![[0.0; 4]; self.order[1]];
        for (row, u) in self.points.chunks_exact(self.order[1] * components).zip(u) {
            for (to, point) in curve.iter_mut().zip(row.chunks_exact(components)) {
                to.iter_mut().zip(point).for_each(|(to, p)| *to += u * p);
            }
        }
        curve
    }

    fn sum(&self, components: usize, u: &[f32; MAX_ORDER], v: &[f32; MAX_ORDER]) -> [f32; 4] {
        weighted(&self.curve(components, u), v)
    }

    fn at(&self, components: usize, u: f32, v: f32) -> [f32; 4] {
        self.sum(components, &self.weights(0, u).0, &self.weights(1, v).0)
    }

    /// Point and derivatives along u and v.
    fn with_slopes(&self, components: usize, u: f32, v: f32) -> [[f32; 4]; 3] {
        let ((bu, du), (bv, dv)) = (self.weights(0, u), self.weights(1, v));
        [self.sum(components, &bu, &bv), self.sum(components, &du, &bv), self.sum(components, &bu, &dv)]
    }
}

/// The sum of control points by their weights.
#[inline]
fn weighted(points: &[[f32; 4]], weights: &[f32; MAX_ORDER]) -> [f32; 4] {
    let mut out = [0.0; 4];
    for (point, w) in points.iter().zip(weights) {
        for k in 0..4 {
            out[k] += w * point[k];
        }
    }
    out
}

/// A target's number, from `MAP1_COLOR_4` or `MAP2_COLOR_4` on.
pub(crate) fn target_of(name: Enum, first: Enum) -> Option<usize> {
    name.checked_sub(first).map(|k| k as usize).filter(|k| *k < TARGETS)
}

/// Components of a target `MAP1_...` or `MAP2_...`.
#[must_use]
pub fn map_components(target: Enum) -> Option<usize> {
    target_of(target, gl::MAP1_COLOR_4).or(target_of(target, gl::MAP2_COLOR_4)).map(|k| COMPONENTS[k])
}

/// Copies control points out of `points`; `None` when there are not enough.
fn gathered(points: &[f32], stride: [usize; 2], order: [usize; 2], components: usize) -> Option<Vec<f32>> {
    let mut out = Vec::with_capacity(order[0] * order[1] * components);
    for i in 0..order[0] {
        for j in 0..order[1] {
            let from = i * stride[0] + j * stride[1];
            out.extend_from_slice(points.get(from..from + components)?);
        }
    }
    Some(out)
}

impl Context {
    /// `glMap1`: a curve of `order` control points, every `stride` numbers.
    pub fn map1(&mut self, target: Enum, [u1, u2]: [f32; 2], stride: i32, order: i32, points: &[f32]) {
        let domain = [[u1, u2], [0.0, 1.0]];
        let map = target_of(target, gl::MAP1_COLOR_4)
            .ok_or(gl::INVALID_ENUM)
            .and_then(|k| Ok((k, checked_map(k, domain, [stride, i32::MAX], [order, 1], points)?)));
        self.set_map(map, false);
    }

    /// `glMap2`: a surface.
    pub fn map2(
        &mut self,
        target: Enum,
        u: [f32; 2],
        v: [f32; 2],
        stride: [i32; 2],
        order: [i32; 2],
        points: &[f32],
    ) {
        let map = target_of(target, gl::MAP2_COLOR_4)
            .ok_or(gl::INVALID_ENUM)
            .and_then(|k| Ok((k, checked_map(k, [u, v], stride, order, points)?)));
        self.set_map(map, true);
    }

    fn set_map(&mut self, map: Result<(usize, Map), Enum>, surface: bool) {
        let map = map.map(|(k, m)| (k, Arc::new(m)));
        self.submit(move |c| match &map {
            // Maps belong to the first unit.
            Ok(_) if c.state.texturing.active != 0 => c.error(gl::INVALID_OPERATION),
            Ok((k, map)) if surface => c.state.eval.surfaces[*k] = Arc::clone(map),
            Ok((k, map)) => c.state.eval.curves[*k] = Arc::clone(map),
            Err(error) => c.error(*error),
        });
    }

    /// `glMapGrid1`.
    pub fn map_grid1(&mut self, n: i32, range: [f32; 2]) {
        self.submit(move |c| {
            if n < 1 {
                return c.error(gl::INVALID_VALUE);
            }
            c.state.eval.grid1 = (n, range);
        });
    }

    /// `glMapGrid2`.
    pub fn map_grid2(&mut self, n: [i32; 2], u: [f32; 2], v: [f32; 2]) {
        self.submit(move |c| {
            if n[0] < 1 || n[1] < 1 {
                return c.error(gl::INVALID_VALUE);
            }
            c.state.eval.grid2 = (n, [u, v]);
        });
    }

    /// `glEvalCoord1`.
    pub fn eval_coord1(&mut self, u: f32) {
        self.submit_anywhere(move |c| c.evaluate_curve(u));
    }

    /// `glEvalCoord2`.
    pub fn eval_coord2(&mut self, [u, v]: [f32; 2]) {
        self.submit_anywhere(move |c| c.evaluate_surface(u, v));
    }

    /// `glEvalPoint1`: a point of the grid.
    pub fn eval_point1(&mut self, i: i32) {
        self.submit_anywhere(move |c| {
            let u = c.grid1(i);
            c.evaluate_curve(u);
        });
    }

    /// `glEvalPoint2`: a point of the grid.
    pub fn eval_point2(&mut self, [i, j]: [i32; 2]) {
        self.submit_anywhere(move |c| {
            let [u, v] = c.grid2(i, j);
            c.evaluate_surface(u, v);
        });
    }

    /// `glEvalMesh1`: the curve from grid point `i1` to `i2`, as `POINT`s or `LINE`s.
    pub fn eval_mesh1(&mut self, mode: Enum, i1: i32, i2: i32) {
        self.submit(move |c| {
            let primitive = match mode {
                gl::POINT => gl::POINTS,
                gl::LINE => gl::LINE_STRIP,
                _ => return c.error(gl::INVALID_ENUM),
            };
            c.keeping_current(|c| {
                c.do_begin(primitive);
                for i in i1..=i2 {
                    let u = c.grid1(i);
                    c.evaluate_curve(u);
                }
                c.do_end_if_active();
            });
        });
    }

    /// `glEvalMesh2`: the surface between grid points, as `POINT`s, `LINE`s or `FILL`ed quadrilaterals.
    pub fn eval_mesh2(&mut self, mode: Enum, i: [i32; 2], j: [i32; 2]) {
        self.submit(move |c| match mode {
            gl::POINT => c.draw_grid(gl::POINTS, i, j, |_, _| Vec::new()),
            gl::LINE => c.keeping_current(|c| {
                for b in j[0]..=j[1] {
                    c.do_begin(gl::LINE_STRIP);
                    (i[0]..=i[1]).for_each(|a| c.evaluate_grid(a, b));
                    c.do_end_if_active();
                }
                for a in i[0]..=i[1] {
                    c.do_begin(gl::LINE_STRIP);
                    (j[0]..=j[1]).for_each(|b| c.evaluate_grid(a, b));
                    c.do_end_if_active();
                }
            }),
            gl::FILL => c.draw_grid(gl::QUADS, i, j, grid_quads),
            _ => c.error(gl::INVALID_ENUM),
        });
    }

    /// Draws all points of a part of the grid, in the order that `elements` gives for so many columns and rows.
    fn draw_grid(&mut self, mode: Enum, i: [i32; 2], j: [i32; 2], elements: impl Fn(u32, u32) -> Vec<u32>) {
        let size = |k: [i32; 2]| usize::try_from(i64::from(k[1]) - i64::from(k[0]) + 1).unwrap_or(0);
        let (columns, rows) = (size(i), size(j));
        if columns == 0 || rows == 0 {
            return;
        }
        if columns.checked_mul(rows).is_none_or(|n| n > MAX_GRID_POINTS) {
            return self.error(gl::OUT_OF_MEMORY);
        }
        let us: Vec<f32> = (i[0]..=i[1]).map(|a| self.grid2(a, 0)[0]).collect();
        let vs: Vec<f32> = (j[0]..=j[1]).map(|b| self.grid2(0, b)[1]).collect();
        let Some(arrays) = self.evaluated(&us, &vs) else { return };
        let elements = elements(columns as u32, rows as u32);
        self.draw_indexed(mode, &arrays, (!elements.is_empty()).then(|| elements.into()));
    }

    /// The attributes that maps give at all pairs of parameters, u fastest; `None` when no map gives vertices.
    fn evaluated(&self, us: &[f32], vs: &[f32]) -> Option<VertexArrays> {
        let maps = &self.state.eval.surfaces;
        let vertex = [VERTEX_4, VERTEX_3].into_iter().find(|k| self.surface_on(*k))?;
        let grid = |k: usize| Grid::new(&maps[k], COMPONENTS[k], us, vs);
        let mut out = VertexArrays { edge_flags: vec![true; us.len() * vs.len()], ..VertexArrays::default() };
        let points = grid(vertex);
        out.positions = points.each(|g, i, j| {
            let [x, y, z, w] = g.at(i, j);
            if vertex == VERTEX_4 { [x, y, z, w] } else { [x, y, z, 1.0] }
        });
        if self.state.enabled.has(crate::state::Cap::AutoNormal) {
            out.normals = points.each(|g, i, j| {
                let [p, du, dv] = g.with_slopes(i, j);
                normal_of(p, du, dv, vertex == VERTEX_4)
            });
        } else if self.surface_on(NORMAL) {
            out.normals = grid(NORMAL).each(|g, i, j| {
                let [x, y, z, _] = g.at(i, j);
                [x, y, z]
            });
        }
        if self.surface_on(COLOR) {
            out.colors = grid(COLOR).each(Grid::at);
        }
        if let Some(n) = (1..=4).rev().find(|n| self.surface_on(TEXTURE + n - 1)) {
            out.tex_coords[0] = grid(TEXTURE + n - 1).each(|g, i, j| tex_coords(g.at(i, j), n));
        }
        Some(out)
    }

    fn evaluate_grid(&mut self, i: i32, j: i32) {
        let [u, v] = self.grid2(i, j);
        self.evaluate_surface(u, v);
    }

    fn grid1(&self, i: i32) -> f32 {
        let (n, [from, to]) = self.state.eval.grid1;
        on_grid(i, n, from, to)
    }

    fn grid2(&self, i: i32, j: i32) -> [f32; 2] {
        let (n, [u, v]) = self.state.eval.grid2;
        [on_grid(i, n[0], u[0], u[1]), on_grid(j, n[1], v[0], v[1])]
    }

    /// Evaluation leaves the current attributes as they are.
    fn keeping_current(&mut self, f: impl FnOnce(&mut Self)) {
        let current = self.state.current.clone();
        f(self);
        self.state.current = current;
    }

    fn do_end_if_active(&mut self) {
        if self.immediate.active() {
            self.do_end();
        }
    }

    fn curve_on(&self, target: usize) -> bool {
        self.state.enabled.has_nth(crate::state::Cap::Map1Color4, target)
    }

    fn surface_on(&self, target: usize) -> bool {
        self.state.enabled.has_nth(crate::state::Cap::Map2Color4, target)
    }

    fn evaluate_curve(&mut self, u: f32) {
        let curves = self.state.eval.curves.clone();
        let value = |k: usize| curves[k].at(COMPONENTS[k], u, 0.0);
        let on: [bool; TARGETS] = std::array::from_fn(|k| self.curve_on(k));
        self.say_evaluated(on, None, value);
    }

    fn evaluate_surface(&mut self, u: f32, v: f32) {
        let surfaces = self.state.eval.surfaces.clone();
        let on: [bool; TARGETS] = std::array::from_fn(|k| self.surface_on(k));
        let automatic = self.state.enabled.has(crate::state::Cap::AutoNormal);
        let vertex = if on[VERTEX_4] { VERTEX_4 } else { VERTEX_3 };
        let normal = (automatic && on[vertex]).then(|| {
            let [p, du, dv] = surfaces[vertex].with_slopes(COMPONENTS[vertex], u, v);
            normal_of(p, du, dv, vertex == VERTEX_4)
        });
        self.say_evaluated(on, normal, |k| surfaces[k].at(COMPONENTS[k], u, v));
    }

    /// Says the attributes that maps give, then the vertex. The current values are not changed.
    fn say_evaluated(
        &mut self,
        on: [bool; TARGETS],
        normal: Option<[f32; 3]>,
        value: impl Fn(usize) -> [f32; 4],
    ) {
        let kept = self.state.current.clone();
        if on[COLOR] {
            self.do_attribute(Attribute::Color(value(COLOR)));
        }
        if on[INDEX] {
            self.do_attribute(Attribute::Index(value(INDEX)[0]));
        }
        if let Some(n) = normal {
            self.do_attribute(Attribute::Normal(n));
        } else if on[NORMAL] {
            let [x, y, z, _] = value(NORMAL);
            self.do_attribute(Attribute::Normal([x, y, z]));
        }
        // The target of most coordinates counts.
        if let Some(n) = (1..=4).rev().find(|n| on[TEXTURE + n - 1]) {
            let v = value(TEXTURE + n - 1);
            self.do_attribute(Attribute::TexCoord(0, tex_coords(v, n)));
        }
        if on[VERTEX_4] {
            self.do_attribute(Attribute::Vertex(value(VERTEX_4)));
        } else if on[VERTEX_3] {
            let [x, y, z, _] = value(VERTEX_3);
            self.do_attribute(Attribute::Vertex([x, y, z, 1.0]));
        }
        self.state.current = kept;
    }
}

/// Quadrilaterals between the points of a grid, cut and coloured as the strips that the specification says.
fn grid_quads(columns: u32, rows: u32) -> Vec<u32> {
    let quad = |k: u32| [k + 1, k, k + columns, k + columns + 1];
    (0..rows - 1).flat_map(|b| (0..columns - 1).flat_map(move |a| quad(b * columns + a))).collect()
}

/// The first `n` texture coordinates of a map.
fn tex_coords(v: [f32; 4], n: usize) -> [f32; 4] {
    std::array::from_fn(|k| if k < n { v[k] } else { [0.0, 0.0, 0.0, 1.0][k] })
}

/// A map at the parameters of a grid: along u the curves it has there and their changes, along v the weights.
struct Grid {
    u: Vec<[Vec<[f32; 4]>; 2]>,
    v: Vec<([f32; MAX_ORDER], [f32; MAX_ORDER])>,
}

impl Grid {
    fn new(map: &Map, components: usize, us: &[f32], vs: &[f32]) -> Self {
        let curves = |t: &f32| {
            let (value, slope) = map.weights(0, *t);
            [map.curve(components, &value), map.curve(components, &slope)]
        };
        Self { u: us.iter().map(curves).collect(), v: vs.iter().map(|t| map.weights(1, *t)).collect() }
    }

    fn at(&self, i: usize, j: usize) -> [f32; 4] {
        weighted(&self.u[i][0], &self.v[j].0)
    }

    fn with_slopes(&self, i: usize, j: usize) -> [[f32; 4]; 3] {
        let ([curve, change], (value, slope)) = (&self.u[i], &self.v[j]);
        [weighted(curve, value), weighted(change, value), weighted(curve, slope)]
    }

    fn each<T>(&self, f: impl Fn(&Self, usize, usize) -> T) -> Vec<T> {
        (0..self.v.len())
            .flat_map(|j| (0..self.u.len()).map(move |i| (i, j)))
            .map(|(i, j)| f(self, i, j))
            .collect()
    }
}

/// A grid's parameter; exact at both ends.
fn on_grid(i: i32, n: i32, from: f32, to: f32) -> f32 {
    if i == n { to } else { from + i as f32 * ((to - from) / n as f32) }
}

/// The normal of a surface from its derivatives, of length 1.
fn normal_of(p: [f32; 4], du: [f32; 4], dv: [f32; 4], homogeneous: bool) -> [f32; 3] {
    use senca_math::glam::Vec3;
    // Of x / w the derivative is (x' w - x w') / w^2; the square changes only the length.
    let slope = |d: [f32; 4]| {
        let of = |k: usize| if homogeneous { d[k] * p[3] - p[k] * d[3] } else { d[k] };
        Vec3::new(of(0), of(1), of(2))
    };
    slope(du).cross(slope(dv)).normalize_or_zero().to_array()
}

fn checked_map(
    target: usize,
    domain: [[f32; 2]; 2],
    stride: [i32; 2],
    order: [i32; 2],
    points: &[f32],
) -> Result<Map, Enum> {
    let components = COMPONENTS[target];
    let valid = domain.iter().all(|[a, b]| a != b)
        && stride.iter().all(|s| *s >= components as i32)
        && order.iter().all(|o| (1..=MAX_ORDER as i32).contains(o));
    if !valid {
        return Err(gl::INVALID_VALUE);
    }
    let (stride, order) = (stride.map(|s| s as usize), order.map(|o| o as usize));
    let points = gathered(points, stride, order, components).ok_or(gl::INVALID_VALUE)?;
    Ok(Map { order, domain, points })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_slopes_to_nothing() {
        for order in 1..=MAX_ORDER {
            for t in [0.0, 0.3, 0.5, 1.0] {
                let sum: f32 = bernstein(order, t).iter().sum();
                assert!((sum - 1.0).abs() < 1e-4, "{order} {t} {sum}");
            }
        }
        assert_eq!(bernstein(4, 0.5)[..4], [0.125, 0.375, 0.375, 0.125]);
        assert_eq!(slopes(4, 0.0)[..4], [-3.0, 3.0, 0.0, 0.0]);
        assert!(slopes(5, 0.4).iter().sum::<f32>().abs() < 1e-5);
    }

    /// The course text's Bézier curve sample, section 5.9: y(u) = 4 (2u - 1)^3.
    #[test]
    fn the_sample_curve_goes_where_it_should() {
        let points = [-4.0, -4.0, 0.0, -2.0, 4.0, 0.0, 2.0, -4.0, 0.0, 4.0, 4.0, 0.0];
        let map = checked_map(VERTEX_3, [[0.0, 1.0]; 2], [3, i32::MAX], [4, 1], &points).unwrap();
        for k in 0..=30 {
            let u = k as f32 / 30.0;
            let [_, y, z, _] = map.at(3, u, 0.0);
            assert!((y - 4.0 * (2.0 * u - 1.0).powi(3)).abs() < 1e-5 && z == 0.0, "{u} {y}");
        }
    }

    #[test]
    fn maps_are_checked() {
        let wrong =
            |stride, order, domain| checked_map(VERTEX_3, [domain; 2], [stride, 9], [order, 1], &[0.0; 99]);
        assert_eq!(wrong(2, 4, [0.0, 1.0]), Err(gl::INVALID_VALUE));
        assert_eq!(wrong(3, 33, [0.0, 1.0]), Err(gl::INVALID_VALUE));
        assert_eq!(wrong(3, 4, [1.0, 1.0]), Err(gl::INVALID_VALUE));
        assert!(wrong(3, 4, [0.0, 1.0]).is_ok());
    }
}
