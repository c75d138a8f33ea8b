//! Step 3: exchange between elements and patches.
//!
//! An exchange is the form factor times the area it starts from, which is the same in both directions.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use senca_math::Control;
use senca_math::glam::DVec3;

use super::{Book, FactorMethod};
use crate::form_factor::{CellFactor, Hemicube, HemicubeView, differential, exchange, point_to_polygon};
use crate::{ElementMesh, Occluders, PatchPolygon, RadiosityError};

/// Farther than this many radii of the smaller polygon, Lambert's formula at a few of its places does.
const FAR: f64 = 3.0;

/// Digits that those places have to give, as a natural logarithm: 1e-4.
const DIGITS: f64 = 9.2;

/// Exchange from elements to patches, by element; empty for those that are divided.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows(pub(super) Vec<Row>);

/// Patches with the exchange, ascending.
pub(super) type Row = Vec<(u32, f32)>;

impl Rows {
    pub(super) fn clear(&mut self, elements: usize) {
        self.0 = vec![Vec::new(); elements];
    }

    /// Patches that an element exchanges light with, ascending.
    pub(super) fn of(&self, element: u32) -> &[(u32, f32)] {
        &self.0[element as usize]
    }

    pub(super) fn count(&self) -> u64 {
        self.0.iter().map(|row| row.len() as u64).sum()
    }

    pub(super) fn forget(&mut self, element: u32) {
        self.0[element as usize] = Vec::new();
    }
}

impl Book<'_> {
    /// Factors between patches. Patches for which one is too large are divided, and all are computed
    /// again.
    pub(super) fn patch_factors(&mut self, control: &Control<'_>) -> Result<(), RadiosityError> {
        for round in 0..=self.settings.depth {
            self.check_size(self.patches.len())?;
            let rows = self.patch_rows(control)?;
            let too_big = self.too_big(&rows);
            let last = round == self.settings.depth;
            if last || !self.divide_patches(&too_big) {
                for (&patch, row) in self.patches.iter().zip(rows) {
                    self.rows.0[patch as usize] = row;
                }
                return Ok(());
            }
            self.illuminate(control)?;
        }
        Ok(())
    }

    /// Exchange of each patch with all others.
    fn patch_rows(&self, control: &Control<'_>) -> Result<Vec<Row>, RadiosityError> {
        match self.settings.factors {
            FactorMethod::RayCast { rays } => Ok(both_halves(self.upper_rows(rays, control)?)),
            FactorMethod::Hemicube { .. } => self.rows_of(&self.patches, control),
        }
    }

    /// Exchange of each patch with those of higher number.
    fn upper_rows(&self, rays: u32, control: &Control<'_>) -> Result<Vec<Row>, RadiosityError> {
        let n = self.patches.len();
        let done = AtomicUsize::new(0);
        let row = |i: usize| {
            control.check()?;
            let from = Side::of(&self.mesh, self.patches[i]);
            let row: Row = (i as u32 + 1..n as u32).filter_map(|j| self.pair(&from, j, rays)).collect();
            let pairs = done.fetch_add(n - i, Ordering::Relaxed) + n - i;
            control.report(0.5 * (2.0 * pairs as f32 / (n as f32 * n as f32)).min(1.0));
            Ok(row)
        };
        (0..n).into_par_iter().with_max_len(1).map(row).collect()
    }

    /// Exchange of some elements with all patches but their own.
    pub(super) fn rows_of(
        &self,
        elements: &[u32],
        control: &Control<'_>,
    ) -> Result<Vec<Row>, RadiosityError> {
        match self.settings.factors {
            FactorMethod::RayCast { rays } => {
                let row = |&element: &u32| {
                    control.check()?;
                    let from = Side::of(&self.mesh, element);
                    let own = self.patch_of[element as usize];
                    let others = (0..self.patches.len() as u32).filter(|&patch| patch != own);
                    Ok(others.filter_map(|patch| self.pair(&from, patch, rays)).collect())
                };
                elements.par_iter().with_max_len(1).map(row).collect()
            }
            FactorMethod::Hemicube { resolution, parts } => {
                let hemicube = Hemicube::new(resolution, CellFactor::Exact)?;
                let shapes: Vec<PatchPolygon> = self.patches.iter().map(|&p| self.mesh.shape(p)).collect();
                let row = |view: &mut HemicubeView<'_>, &element: &u32| {
                    control.check()?;
                    let area = self.mesh.elements()[element as usize].area;
                    let factors = view.factors(self.mesh.shape(element).corners(), parts as usize, &shapes);
                    let seen = (0..).zip(factors).filter(|(_, factor)| *factor > 0.0);
                    Ok(seen.map(|(patch, factor)| (patch, (factor * area) as f32)).collect())
                };
                elements.par_iter().map_init(|| HemicubeView::new(&hemicube), row).collect()
            }
        }
    }

    /// Factors of new leaves to all patches.
    pub(super) fn element_factors(&mut self, control: &Control<'_>) -> Result<(), RadiosityError> {
        let known = self.rows.0.len() as u32;
        let new: Vec<u32> = self.mesh.leaves().filter(|&leaf| leaf >= known).collect();
        self.rows.0.resize(self.mesh.elements().len(), Vec::new());
        for (&leaf, row) in new.iter().zip(self.rows_of(&new, control)?) {
            self.rows.0[leaf as usize] = row;
        }
        Ok(())
    }

    /// Whether so many leaves keep within the limit of factors.
    pub(super) fn check_size(&self, leaves: usize) -> Result<(), RadiosityError> {
        let limit = self.settings.max_factors;
        // Of two flat polygons about half the pairs face each other.
        let needed = leaves as u64 * self.patches.len() as u64 / 2;
        if needed > limit { Err(RadiosityError::TooManyFactors { limit }) } else { Ok(()) }
    }

    /// Patches that fill too much of what another sees.
    fn too_big(&self, rows: &[Row]) -> Vec<u32> {
        let mut big = vec![false; self.patches.len()];
        for (row, &patch) in rows.iter().zip(&self.patches) {
            let area = self.mesh.elements()[patch as usize].area;
            for &(j, exchange) in row {
                big[j as usize] |= f64::from(exchange) > self.settings.largest_factor * area;
            }
        }
        self.patches.iter().zip(big).filter(|(_, big)| *big).map(|(&patch, _)| patch).collect()
    }

    /// Whether anything was divided; the patches are then numbered anew.
    fn divide_patches(&mut self, patches: &[u32]) -> bool {
        let mut any = false;
        for &patch in patches {
            let large = self.mesh.longest_edge(patch) > self.settings.smallest;
            any |= large && self.mesh.divide(patch);
        }
        if any {
            self.number_patches();
        }
        any
    }

    /// Exchange of an element with a patch, if there is any.
    fn pair(&self, from: &Side, patch: u32, rays: u32) -> Option<(u32, f32)> {
        let to = Side::of(&self.mesh, self.patches[patch as usize]);
        if from.hides(&to) || to.hides(from) {
            return None;
        }
        let open = open_exchange(from, &to);
        if open <= 0.0 {
            return None;
        }
        let seen = open * visible_share(from, &to, &self.occluders, rays);
        (seen > 0.0).then_some((patch, seen as f32))
    }
}

/// Rows of all from rows of those with higher numbers.
fn both_halves(upper: Vec<Row>) -> Vec<Row> {
    let mut rows: Vec<Row> = vec![Row::new(); upper.len()];
    for (i, row) in (0..).zip(&upper) {
        for &(j, exchange) in row {
            rows[j as usize].push((i, exchange));
        }
    }
    for (row, higher) in rows.iter_mut().zip(upper) {
        row.extend(higher);
    }
    rows
}

/// One of two that exchange light.
#[derive(Clone, Copy, Debug)]
struct Side {
    shape: PatchPolygon,
    normal: DVec3,
    center: DVec3,
    radius: f64,
    area: f64,
}

impl Side {
    fn of(mesh: &ElementMesh, element: u32) -> Self {
        let (shape, whole) = (mesh.shape(element), &mesh.elements()[element as usize]);
        let distance = |corner: &DVec3| corner.distance(whole.center);
        let radius = shape.corners().iter().map(distance).fold(0.0, f64::max);
        Self { shape, normal: mesh.normal(element), center: whole.center, radius, area: whole.area }
    }

    /// Whether all of `other` is in this one's plane or behind it.
    fn hides(&self, other: &Self) -> bool {
        // The two sides of one sheet see nothing of each other, though quadrilaterals are bent a little.
        let bend = if self.normal.dot(other.normal) < BACK_TO_BACK { BEND } else { 1e-9 };
        let rounding = bend * (self.radius + other.radius);
        let height = |p: &DVec3| self.normal.dot(*p - self.center);
        other.shape.corners().iter().all(|p| height(p) <= rounding)
    }

    /// Whether all of `other` is in front.
    fn faces(&self, other: &Self) -> bool {
        other.shape.corners().iter().all(|&p| self.normal.dot(p - self.center) >= 0.0)
    }
}

/// Exchange without obstacles.
fn open_exchange(a: &Side, b: &Side) -> f64 {
    let (small, large) = if a.radius <= b.radius { (a, b) } else { (b, a) };
    let reach = (small.center.distance(large.center) - large.radius) / small.radius;
    if !(reach > FAR && a.faces(b) && b.faces(a)) {
        return exchange(a.shape.corners(), b.shape.corners());
    }
    let gain = reach + (reach * reach - 1.0).sqrt();
    let places = GAUSS[((DIGITS / (2.0 * gain.ln())).ceil() as usize).clamp(1, 3) - 1];
    let mut sum = 0.0;
    for &[u, weight_u] in places {
        for &[v, weight_v] in places {
            let (place, stretch) = smooth_place(small, [u, v]);
            let factor = point_to_polygon(place, small.normal, large.shape.corners());
            sum += weight_u * weight_v * factor * stretch;
        }
    }
    sum * small.area
}

/// A place by a smooth map of the unit square, and how much larger than on the mean a piece of the
/// square becomes there.
fn smooth_place(side: &Side, [u, v]: [f64; 2]) -> (DVec3, f64) {
    match side.shape.corners() {
        &[a, b, c] => (a * (1.0 - u) + (b * (1.0 - v) + c * v) * u, 2.0 * u),
        _ => (side.shape.place(u, v), stretch(side, [u, v])),
    }
}

/// How much larger than on the mean a piece of the unit square becomes at (u, v).
#[inline]
fn stretch(side: &Side, [u, v]: [f64; 2]) -> f64 {
    let &[a, b, c, d] = side.shape.corners() else { return 1.0 };
    let along = (b - a).lerp(c - d, v);
    let across = (d - a).lerp(c - b, u);
    along.cross(across).length() / side.area
}

/// Cosine between normals of polygons that are as good as parallel and face apart.
const BACK_TO_BACK: f64 = -0.999_999;

/// How far from its plane a quadrilateral may be, as a share of its size.
const BEND: f64 = 1e-5;

/// Places and weights of Gauss for 1 to 3 places in [0, 1].
const GAUSS: [&[[f64; 2]]; 3] = [
    &[[0.5, 1.0]],
    &[[0.211_324_865_405_187_1, 0.5], [0.788_675_134_594_812_9, 0.5]],
    &[[0.112_701_665_379_258_3, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]],
];

/// Share of the exchange that obstacles let through, each line of sight counted by what it carries. The
/// first quarter of the lines decides where all of them are open, or none.
fn visible_share(a: &Side, b: &Side, occluders: &Occluders, rays: u32) -> f64 {
    let closest = a.area.min(b.area) / (std::f64::consts::PI * f64::from(rays));
    let (mut all, mut open, mut closed) = (0.0, 0.0, 0.0);
    for ray in 0..rays {
        let [u, v, s, t] = spread(ray);
        let (p, q) = (a.shape.place(u, v), b.shape.place(s, t));
        let near = (p.distance_squared(q) / closest).min(1.0);
        let weight =
            differential(p, a.normal, q, b.normal, 1.0) * near * stretch(a, [u, v]) * stretch(b, [s, t]);
        if weight <= 0.0 {
            continue;
        }
        let passed = f64::from(occluders.transmittance(p, q).luminance());
        all += weight;
        open += weight * passed;
        closed += weight * (1.0 - passed);
        if 4 * (ray + 1) >= rays && ray >= 3 && (open == 0.0 || closed == 0.0) {
            break;
        }
    }
    if all > 0.0 { open / all } else { 1.0 }
}

/// The `i`th of an even sequence in four dimensions: multiples of powers of the root of x^5 = x + 1.
fn spread(i: u32) -> [f64; 4] {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let mut power = 1.0;
    std::array::from_fn(|_| {
        power /= ROOT;
        (0.5 + power * f64::from(i + 1)).fract()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshSettings;
    use senca_scene::{Scene, Shape};

    #[test]
    fn places_do_for_far_polygons() {
        let scene = Scene::of_shape("ball", Shape::Sphere { radius: 1.0 });
        let settings = MeshSettings { tolerance: Some(0.1), ..MeshSettings::default() };
        let mesh = ElementMesh::of_scene(&scene, &settings).expect("a mesh");
        let n = mesh.polygons().len() as u32;
        for i in (0..n).step_by(5) {
            let a = Side::of(&mesh, i);
            for j in 0..n {
                let b = Side::of(&mesh, j);
                let exact = exchange(a.shape.corners(), b.shape.corners());
                if a.hides(&b) || b.hides(&a) {
                    let back_to_back = a.normal.dot(b.normal) < BACK_TO_BACK;
                    assert!(exact < 1e-9 || back_to_back, "{i} {j}: {exact}");
                    continue;
                }
                let found = open_exchange(&a, &b);
                assert!((found - exact).abs() <= 2e-4 * exact + 1e-12, "{i} {j}: {found}, not {exact}");
            }
        }
    }
}
