//! Where polygons lie in a picture.
//!
//! Polygons that follow each other smoothly make a chart: they are laid flat onto the plane of the first
//! one, and none leans away from it by more than [`LEAN`]. Charts are boxes in shelves, the highest first,
//! all at the same scale, which is as large as the picture allows. Between charts there are texels that
//! belong to none; they are filled from the nearest that do, so that nothing bleeds over a border when a
//! viewer takes the mean of neighbouring texels.

use std::collections::HashMap;

use rayon::prelude::*;
use senca_math::LinearRgb;
use senca_math::glam::{DVec2, DVec3};

use crate::ElementMesh;

/// Cosine of how far a polygon may lean away from the plane of its chart.
const LEAN: f64 = 0.9;

/// Texels around each chart that belong to it.
const MARGIN: f64 = 2.0;

/// Tries to find the scale of charts.
const SCALE_STEPS: u32 = 40;

/// Polygons laid flat together.
#[derive(Clone, Debug)]
struct Chart {
    polygons: Vec<u32>,
    /// Axes of the plane.
    axes: [DVec3; 2],
    /// Lower corner and size in the plane, world units.
    lower: DVec2,
    size: DVec2,
    /// Texel of the lower corner.
    at: DVec2,
}

/// All charts of a mesh in a picture.
#[derive(Clone, Debug)]
pub(super) struct Atlas {
    side: u32,
    /// Texels for a world unit.
    scale: f64,
    charts: Vec<Chart>,
    chart_of: Vec<u32>,
}

impl Atlas {
    /// The polygons of `mesh` in a square of `side` texels; `None` where there is not enough room.
    pub(super) fn of(mesh: &ElementMesh, side: u32) -> Option<Self> {
        let (mut charts, chart_of) = charts(mesh);
        charts.iter_mut().for_each(|chart| chart.lay_out(mesh));
        let mut order: Vec<usize> = (0..charts.len()).collect();
        order.sort_by(|&a, &b| charts[b].size.y.total_cmp(&charts[a].size.y).then(a.cmp(&b)));
        let area: f64 = charts.iter().map(|chart| chart.size.x * chart.size.y).sum();
        let mut scale = 2.0 * f64::from(side) / area.sqrt().max(f64::MIN_POSITIVE);
        for _ in 0..SCALE_STEPS {
            if let Some(places) = shelves(&charts, &order, scale, f64::from(side)) {
                charts.iter_mut().zip(places).for_each(|(chart, at)| chart.at = at);
                return Some(Self { side, scale, charts, chart_of });
            }
            scale *= 0.9;
        }
        None
    }

    /// Coordinates in the picture of a place of a polygon, (0, 0) at its top left corner.
    pub(super) fn uv(&self, polygon: u32, place: DVec3) -> DVec2 {
        let chart = &self.charts[self.chart_of[polygon as usize] as usize];
        self.texel(chart, place) / f64::from(self.side)
    }

    fn texel(&self, chart: &Chart, place: DVec3) -> DVec2 {
        chart.at + (chart.flat(place) - chart.lower) * self.scale
    }

    /// The picture, with the colour of each place of a polygon.
    pub(super) fn paint(
        &self,
        mesh: &ElementMesh,
        color: &(dyn Fn(u32, DVec3) -> LinearRgb + Sync),
    ) -> Vec<LinearRgb> {
        let painted: Vec<Vec<(usize, LinearRgb)>> =
            self.charts.par_iter().map(|chart| self.paint_chart(chart, mesh, color)).collect();
        let mut texels = vec![None; self.side as usize * self.side as usize];
        for (texel, light) in painted.into_iter().flatten() {
            texels[texel].get_or_insert(light);
        }
        self.spread(texels)
    }

    /// Texels whose middle is in a polygon, or so near that a viewer may look at them for it.
    fn paint_chart(
        &self,
        chart: &Chart,
        mesh: &ElementMesh,
        color: &(dyn Fn(u32, DVec3) -> LinearRgb + Sync),
    ) -> Vec<(usize, LinearRgb)> {
        let mut seen = Vec::new();
        for &polygon in &chart.polygons {
            let shape = mesh.shape(polygon);
            let flat: Vec<DVec2> = shape.corners().iter().map(|&p| self.texel(chart, p)).collect();
            let low = flat.iter().copied().fold(DVec2::INFINITY, DVec2::min) - MARGIN;
            let high = flat.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) + MARGIN;
            let last = f64::from(self.side) - 1.0;
            let [from, to] = [low, high].map(|v| v.floor().clamp(DVec2::ZERO, DVec2::splat(last)));
            for y in from.y as u32..=to.y as u32 {
                for x in from.x as u32..=to.x as u32 {
                    let middle = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let outside = outside(&flat, middle);
                    if outside > MARGIN {
                        continue;
                    }
                    // Of places outside the nearest one within counts.
                    let place = shape.weights_at(self.place(chart, mesh, polygon, middle));
                    let point = shape.corners().iter().zip(place).map(|(&p, w)| p * w).sum();
                    let texel = (y * self.side + x) as usize;
                    seen.push((outside.max(0.0), texel, color(polygon, point)));
                }
            }
        }
        // The nearest polygon counts, and of several that hold the place the first.
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        seen.into_iter().map(|(_, texel, light)| (texel, light)).collect()
    }

    /// The place of a polygon that lies at a texel.
    fn place(&self, chart: &Chart, mesh: &ElementMesh, polygon: u32, texel: DVec2) -> DVec3 {
        let flat = (texel - chart.at) / self.scale + chart.lower;
        let [s, t] = chart.axes;
        let up = s.cross(t);
        let in_plane = s * flat.x + t * flat.y;
        let (corner, normal) = (mesh.shape(polygon).corners()[0], mesh.normal(polygon));
        in_plane + up * ((corner - in_plane).dot(normal) / up.dot(normal))
    }

    /// Fills what no chart has, from neighbours that have something.
    fn spread(&self, mut texels: Vec<Option<LinearRgb>>) -> Vec<LinearRgb> {
        let side = self.side as i64;
        for _ in 0..MARGIN as u32 {
            let before = texels.clone();
            let at = |x: i64, y: i64| {
                let there = (0..side).contains(&x) && (0..side).contains(&y);
                if there { before[(y * side + x) as usize] } else { None }
            };
            for (i, texel) in texels.iter_mut().enumerate().filter(|(_, texel)| texel.is_none()) {
                let (x, y) = (i as i64 % side, i as i64 / side);
                let ways = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
                let around: Vec<LinearRgb> = ways.iter().filter_map(|(dx, dy)| at(x + dx, y + dy)).collect();
                if !around.is_empty() {
                    let sum = around.iter().fold(LinearRgb::BLACK, |sum, &light| sum + light);
                    *texel = Some(sum * (around.len() as f32).recip());
                }
            }
        }
        texels.into_iter().map(Option::unwrap_or_default).collect()
    }
}

impl Chart {
    fn flat(&self, place: DVec3) -> DVec2 {
        DVec2::new(place.dot(self.axes[0]), place.dot(self.axes[1]))
    }

    /// Finds the box of the chart, turned so that it is no higher than wide.
    fn lay_out(&mut self, mesh: &ElementMesh) {
        let corners = || self.polygons.iter().flat_map(|&p| mesh.shape(p).corners().to_vec());
        let flat: Vec<DVec2> = corners().map(|p| self.flat(p)).collect();
        let low = flat.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = flat.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        (self.lower, self.size) = (low, high - low);
        if self.size.y > self.size.x {
            let [s, t] = self.axes;
            self.axes = [t, -s];
            self.lower = DVec2::new(low.y, -high.x);
            self.size = DVec2::new(self.size.y, self.size.x);
        }
    }
}

/// How far a place is outside of a convex polygon, in its units; at most 0 within. Either way round.
fn outside(corners: &[DVec2], place: DVec2) -> f64 {
    let next = || corners.iter().cycle().skip(1);
    let area: f64 = corners.iter().zip(next()).map(|(a, b)| a.perp_dot(*b)).sum();
    let beside = |(a, b): (&DVec2, &DVec2)| {
        let edge = *b - *a;
        -area.signum() * edge.perp_dot(place - *a) / edge.length().max(f64::MIN_POSITIVE)
    };
    corners.iter().zip(next()).map(beside).fold(f64::NEG_INFINITY, f64::max)
}

/// Polygons by chart, and the chart of each polygon.
fn charts(mesh: &ElementMesh) -> (Vec<Chart>, Vec<u32>) {
    let count = mesh.polygons().len();
    let mut at_edge: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    let edges = |polygon: u32| {
        let corners = mesh.elements()[polygon as usize].corners().to_vec();
        (0..corners.len()).map(move |i| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            [a.min(b), a.max(b)]
        })
    };
    for polygon in 0..count as u32 {
        edges(polygon).for_each(|edge| at_edge.entry(edge).or_default().push(polygon));
    }
    let mut chart_of = vec![u32::MAX; count];
    let mut charts: Vec<Chart> = Vec::new();
    for seed in 0..count as u32 {
        if chart_of[seed as usize] != u32::MAX {
            continue;
        }
        let number = charts.len() as u32;
        let (normal, surface) = (mesh.normal(seed), mesh.polygons()[seed as usize].surface);
        let mut polygons = vec![seed];
        chart_of[seed as usize] = number;
        let mut next = 0;
        while let Some(&polygon) = polygons.get(next) {
            next += 1;
            for neighbour in edges(polygon).flat_map(|edge| at_edge[&edge].clone()) {
                let fits = chart_of[neighbour as usize] == u32::MAX
                    && mesh.polygons()[neighbour as usize].surface == surface
                    && mesh.normal(neighbour).dot(normal) > LEAN;
                if fits {
                    chart_of[neighbour as usize] = number;
                    polygons.push(neighbour);
                }
            }
        }
        charts.push(Chart::of(mesh, polygons));
    }
    (charts, chart_of)
}

impl Chart {
    /// With its first axis along the first edge.
    fn of(mesh: &ElementMesh, polygons: Vec<u32>) -> Self {
        let (shape, normal) = (mesh.shape(polygons[0]), mesh.normal(polygons[0]));
        let edge = shape.corners()[1] - shape.corners()[0];
        let s = edge.reject_from(normal).normalize_or(normal.any_orthonormal_vector());
        let axes = [s, normal.cross(s)];
        Self { polygons, axes, lower: DVec2::ZERO, size: DVec2::ZERO, at: DVec2::ZERO }
    }
}

/// Texel of the lower corner of each chart at this scale; `None` where they do not fit.
fn shelves(charts: &[Chart], order: &[usize], scale: f64, side: f64) -> Option<Vec<DVec2>> {
    let mut places = vec![DVec2::ZERO; charts.len()];
    let (mut x, mut y, mut height) = (0.0, 0.0, 0.0_f64);
    for &number in order {
        let size = (charts[number].size * scale).ceil() + 2.0 * MARGIN;
        if x + size.x > side {
            (x, y, height) = (0.0, y + height, 0.0);
        }
        if size.x > side || y + size.y > side {
            return None;
        }
        places[number] = DVec2::new(x, y) + MARGIN;
        x += size.x;
        height = height.max(size.y);
    }
    Some(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshSettings;
    use senca_scene::{Scene, Shape};

    fn meshes() -> [ElementMesh; 2] {
        let of = |shape| {
            let mut scene = Scene::of_shape("shape", shape);
            let material = scene.add_material(senca_scene::Material::default());
            scene.geometries[0].material = Some(material);
            ElementMesh::of_scene(&scene, &MeshSettings::default()).expect("a mesh")
        };
        [of(Shape::Box { size: DVec3::new(1.0, 2.0, 3.0) }), of(Shape::Sphere { radius: 1.0 })]
    }

    #[test]
    fn charts_do_not_overlap_and_stay_inside() {
        for mesh in meshes() {
            let atlas = Atlas::of(&mesh, 256).expect("room");
            let boxes: Vec<[DVec2; 2]> =
                atlas.charts.iter().map(|c| [c.at, c.at + c.size * atlas.scale]).collect();
            for (i, [low, high]) in boxes.iter().enumerate() {
                assert!(low.min_element() >= MARGIN && high.max_element() <= 256.0 - MARGIN);
                let apart = |[l, h]: &[DVec2; 2]| {
                    let gap = (*l - *high).max(*low - *h);
                    gap.max_element() >= 2.0 * MARGIN - 1e-9
                };
                assert!(boxes[..i].iter().all(apart), "chart {i}");
            }
        }
    }

    #[test]
    fn texels_show_the_places_they_stand_for() {
        for mesh in meshes() {
            let atlas = Atlas::of(&mesh, 128).expect("room");
            let color =
                |_: u32, p: DVec3| LinearRgb::new(p.x as f32 + 4.0, p.y as f32 + 4.0, p.z as f32 + 4.0);
            let texels = atlas.paint(&mesh, &color);
            for polygon in 0..mesh.polygons().len() as u32 {
                let center = mesh.elements()[polygon as usize].center;
                let uv = atlas.uv(polygon, center) * 128.0;
                let seen = texels[uv.y as usize * 128 + uv.x as usize];
                let expected = color(polygon, center);
                let near = 1.5 / atlas.scale;
                assert!(f64::from((seen.r - expected.r).abs()) < near, "polygon {polygon}");
                assert!(f64::from((seen.b - expected.b).abs()) < near, "polygon {polygon}");
            }
        }
    }

    #[test]
    fn too_many_charts_for_the_picture_are_refused() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let white = LinearRgb::WHITE;
        let polygons: Vec<_> = (0..2000).map(|_| (&triangle[..], white, white)).collect();
        let mesh = ElementMesh::of_polygons(&polygons);
        assert!(Atlas::of(&mesh, 64).is_none());
        assert!(Atlas::of(&mesh, 1024).is_some());
    }
}
