//! All form factors of a set of patches.

use rayon::prelude::*;
use senca_math::Control;
use senca_math::glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::cells::cells;
use super::ray_cast::visible_share_of_pair;
use super::{
    FirstHit, Hemicube, HemicubeView, Method, MethodSettings, PatchScene, double_area, exchange, monte_carlo,
    nusselt_directions, polygon_to_polygon_by_contours,
};
use crate::{PatchPolygon, RadiosityError};

/// Form factors of n patches to each other, and the patches' areas.
#[derive(Clone, Debug, PartialEq)]
pub struct FormFactors {
    areas: Vec<f64>,
    /// Row after row.
    factors: Vec<f64>,
}

/// What the rows of a matrix add up to: 1 where a scene is closed on all sides, less where light
/// escapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowSums {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// The mean.
    pub mean: f64,
    /// Number of the row that is farthest from 1.
    pub worst: usize,
}

impl FormFactors {
    /// Most patches of a matrix: half a gigabyte.
    pub const MAX_PATCHES: usize = 8192;

    /// By one of the methods. The work is shared by the threads of the current pool, and the result
    /// does not depend on their number. Patches without area neither give nor take.
    ///
    /// # Errors
    /// [`RadiosityError::MatrixTooLarge`], [`RadiosityError::Setting`] for a resolution out of range,
    /// [`RadiosityError::Cancelled`].
    pub fn compute(
        patches: &[PatchPolygon],
        method: Method,
        settings: &MethodSettings,
        control: &Control<'_>,
    ) -> Result<Self, RadiosityError> {
        let n = patches.len();
        if n > Self::MAX_PATCHES {
            return Err(RadiosityError::MatrixTooLarge { patches: n, limit: Self::MAX_PATCHES });
        }
        let scene = PatchScene::new(patches)?;
        let areas: Vec<f64> = patches.iter().map(area).collect();
        let work =
            Work { patches, areas: &areas, scene: &scene, settings, control, done: AtomicUsize::new(0) };
        let factors = match method {
            Method::Exact => work.pairs(|i, j| exchange(patches[i].corners(), patches[j].corners())),
            Method::Contours => work.pairs(|i, j| {
                polygon_to_polygon_by_contours(patches[i].corners(), patches[j].corners()) * areas[i]
            }),
            Method::RayCast => work.pairs(|i, j| work.ray_cast(i, j)),
            Method::DoubleArea => work.pairs(|i, j| {
                let (from, to) = (patches[i].corners(), patches[j].corners());
                double_area(from, to, settings.double_area_parts, &scene) * areas[i]
            }),
            Method::Nusselt => work.rows(|| (), |(), i| work.nusselt(i)),
            Method::MonteCarlo => {
                work.rows(|| (), |(), i| monte_carlo(i, patches, &scene, &settings.monte_carlo).factors)
            }
            Method::Hemicube => {
                let hemicube = Hemicube::new(settings.resolution, settings.cell_factor)?;
                let row = |view: &mut HemicubeView<'_>, i: usize| {
                    view.factors(patches[i].corners(), settings.parts, patches)
                };
                work.rows(|| HemicubeView::new(&hemicube), row)
            }
        }?;
        Ok(Self { areas, factors })
    }

    /// From known numbers: `factors` row after row, as many rows as areas.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`] if the numbers are not as many as the square of the areas.
    pub fn from_rows(areas: Vec<f64>, factors: Vec<f64>) -> Result<Self, RadiosityError> {
        if factors.len() != areas.len() * areas.len() {
            let expected = "the square of the number of areas";
            return Err(RadiosityError::Setting {
                name: "number of factors",
                value: factors.len() as f64,
                expected,
            });
        }
        Ok(Self { areas, factors })
    }

    /// Number of patches.
    #[must_use]
    pub fn size(&self) -> usize {
        self.areas.len()
    }

    /// Areas of the patches.
    #[must_use]
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// F_i->j.
    #[must_use]
    pub fn factor(&self, i: usize, j: usize) -> f64 {
        self.row(i)[j]
    }

    /// Factors from patch i to each.
    #[must_use]
    pub fn row(&self, i: usize) -> &[f64] {
        let n = self.size();
        &self.factors[i * n..(i + 1) * n]
    }

    /// What the rows add up to; `None` without patches.
    #[must_use]
    pub fn row_sums(&self) -> Option<RowSums> {
        let sums: Vec<f64> = (0..self.size()).map(|i| self.row(i).iter().sum()).collect();
        let off = |i: &usize| (sums[*i] - 1.0).abs();
        let worst = (0..sums.len()).max_by(|a, b| off(a).total_cmp(&off(b)))?;
        let least = sums.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = sums.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some(RowSums { least, greatest, mean: sums.iter().sum::<f64>() / sums.len() as f64, worst })
    }

    /// Makes every row add up to 1, but those of zeros: right for scenes that are closed on all sides,
    /// where a method leaves a little too much or too little.
    pub fn normalize_rows(&mut self) {
        let n = self.size();
        for row in self.factors.chunks_exact_mut(n.max(1)) {
            let sum: f64 = row.iter().sum();
            if sum > 0.0 {
                row.iter_mut().for_each(|f| *f /= sum);
            }
        }
    }

    /// Largest |A_i F_ij - A_j F_ji| (equation 4.2 of the course text) as a share of the larger area of the
    /// pair.
    #[must_use]
    pub fn reciprocity_error(&self) -> f64 {
        let of = |i: usize, j: usize| {
            let (a, b) = (self.areas[i], self.areas[j]);
            let larger = a.max(b);
            let difference = (a * self.factor(i, j) - b * self.factor(j, i)).abs();
            if larger > 0.0 { difference / larger } else { 0.0 }
        };
        let n = self.size();
        (0..n).flat_map(|i| (0..i).map(move |j| of(i, j))).fold(0.0, f64::max)
    }
}

fn area(patch: &PatchPolygon) -> f64 {
    let (_, area) = patch.normal_and_area();
    if area.is_finite() { area } else { 0.0 }
}

/// What all rows are worked out from.
struct Work<'a> {
    patches: &'a [PatchPolygon],
    areas: &'a [f64],
    scene: &'a PatchScene,
    settings: &'a MethodSettings,
    control: &'a Control<'a>,
    done: AtomicUsize,
}

impl Work<'_> {
    /// Row by row, with something each thread keeps.
    fn rows<T: Send>(
        &self,
        keep: impl Fn() -> T + Sync + Send,
        row: impl Fn(&mut T, usize) -> Vec<f64> + Sync,
    ) -> Result<Vec<f64>, RadiosityError> {
        let n = self.patches.len();
        let mut factors = vec![0.0; n * n];
        factors.par_chunks_mut(n.max(1)).enumerate().try_for_each_init(keep, |kept, (i, out)| {
            self.control.check()?;
            if self.areas[i] > 0.0 {
                out.copy_from_slice(&row(kept, i));
            }
            self.finished(n);
            Ok::<(), RadiosityError>(())
        })?;
        Ok(factors)
    }

    /// From what each pair exchanges, `exchange(i, j)` with i < j, which goes both ways.
    fn pairs(&self, exchange: impl Fn(usize, usize) -> f64 + Sync) -> Result<Vec<f64>, RadiosityError> {
        let upper =
            |i: usize| (0..self.patches.len()).map(|j| if j > i { exchange(i, j) } else { 0.0 }).collect();
        let mut factors = self.rows(|| (), |(), i| upper(i))?;
        let n = self.patches.len();
        for i in 0..n {
            for j in i + 1..n {
                let both = factors[i * n + j];
                if both > 0.0 {
                    factors[i * n + j] = both / self.areas[i];
                    factors[j * n + i] = both / self.areas[j];
                }
            }
        }
        Ok(factors)
    }

    fn finished(&self, all: usize) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.control.report(done as f32 / all as f32);
    }

    fn ray_cast(&self, i: usize, j: usize) -> f64 {
        let (from, to) = (&self.patches[i], &self.patches[j]);
        let open = exchange(from.corners(), to.corners());
        if open == 0.0 {
            return 0.0;
        }
        open * visible_share_of_pair(from, to, self.scene, &self.settings.ray_cast, [i as u32, j as u32])
    }

    fn nusselt(&self, i: usize) -> Vec<f64> {
        let patch = &self.patches[i];
        let (normal, _) = patch.normal_and_area();
        let directions: Vec<DVec3> = nusselt_directions(normal, self.settings.directions.max(1)).collect();
        let mut row = vec![0.0; self.patches.len()];
        let (cells, all) = (cells(patch.corners(), self.settings.parts), self.areas[i]);
        for cell in cells {
            let share = cell.area / all / directions.len().max(1) as f64;
            for &direction in &directions {
                if let FirstHit::Front(to) = self.scene.first_hit(cell.point, direction) {
                    row[to] += share;
                }
            }
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::closed_form::{cube_adjacent, cube_opposite};
    use crate::form_factor::{MonteCarloSettings, RayCastSettings};

    fn cube(inside: bool) -> Vec<PatchPolygon> {
        let turn = if inside { 1.0 } else { -1.0 };
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]
            .iter()
            .map(|&n| {
                let (u, v) = n.any_orthonormal_pair();
                let at = |a: f64, b: f64| (n + u * a - v * b * turn) * 0.5;
                PatchPolygon::quad([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)])
            })
            .collect()
    }

    fn settings() -> MethodSettings {
        MethodSettings {
            double_area_parts: 10,
            resolution: 50,
            monte_carlo: MonteCarloSettings { rays: 1 << 13, ..Default::default() },
            ray_cast: RayCastSettings { rays: 4, ..Default::default() },
            ..Default::default()
        }
    }

    fn compute(patches: &[PatchPolygon], method: Method) -> FormFactors {
        FormFactors::compute(patches, method, &settings(), &Control::default()).expect("a matrix")
    }

    #[test]
    fn every_method_knows_the_inside_of_a_cube() {
        let cube = cube(true);
        for method in Method::ALL {
            let factors = compute(&cube, method);
            let limit = match method {
                Method::Exact | Method::Contours | Method::RayCast => 1e-11,
                Method::Hemicube | Method::Nusselt => 5e-3,
                Method::MonteCarlo => 1.2e-2,
                Method::DoubleArea => 3e-2,
            };
            for i in 0..6 {
                for j in 0..6 {
                    let known = if i == j {
                        0.0
                    } else if i / 2 == j / 2 {
                        cube_opposite()
                    } else {
                        cube_adjacent()
                    };
                    let off = (factors.factor(i, j) - known).abs();
                    assert!(off < limit, "{method:?} {i} {j}: {off}");
                }
            }
            let sums = factors.row_sums().expect("rows");
            let closed = if method == Method::DoubleArea { 0.1 } else { 1e-10 };
            assert!(
                (sums.mean - 1.0).abs() < closed && sums.greatest - sums.least < closed,
                "{method:?}: {sums:?}"
            );
        }
    }

    #[test]
    fn a_convex_body_does_not_see_itself() {
        for method in Method::ALL {
            let factors = compute(&cube(false), method);
            assert!((0..6).all(|i| factors.row(i).iter().all(|&f| f == 0.0)), "{method:?}");
        }
    }

    #[test]
    fn methods_with_obstacles_agree_on_a_shade() {
        let mut patches = cube(true);
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.05) * 0.6;
        let shade = [at(-0.5, -0.5), at(0.5, -0.5), at(0.5, 0.5), at(-0.5, 0.5)];
        patches.push(PatchPolygon::quad(shade));
        patches.push(PatchPolygon::quad([shade[3], shade[2], shade[1], shade[0]]));
        let fine = MethodSettings {
            parts: 6,
            ray_cast: RayCastSettings { rays: 256, ..Default::default() },
            ..settings()
        };
        let of =
            |method| FormFactors::compute(&patches, method, &fine, &Control::default()).expect("a matrix");
        let known = of(Method::RayCast);
        assert!((known.factor(4, 5) - cube_opposite()).abs() > 0.04, "the shade hides a part");
        assert!((known.row_sums().expect("rows").mean - 1.0).abs() < 5e-3);
        for method in [Method::Hemicube, Method::Nusselt, Method::MonteCarlo] {
            let factors = of(method);
            for i in 0..8 {
                for j in 0..8 {
                    let (a, b) = (factors.factor(i, j), known.factor(i, j));
                    assert!((a - b).abs() < 0.012, "{method:?} {i} {j}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn numbers_do_not_depend_on_threads() {
        let patches = cube(true);
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        for method in Method::ALL {
            let [one, three] = [1, 3].map(|n| pool(n).install(|| compute(&patches, method)));
            assert_eq!(one, three, "{method:?}");
        }
    }

    #[test]
    fn reciprocity_and_normalised_rows() {
        let mut patches = cube(true);
        patches.push(PatchPolygon::triangle([DVec3::ZERO; 3]));
        patches.push(PatchPolygon::triangle([DVec3::NAN; 3]));
        for method in Method::ALL {
            let mut factors = compute(&patches, method);
            let limit = if matches!(method, Method::Hemicube | Method::Nusselt | Method::MonteCarlo) {
                0.02
            } else {
                1e-12
            };
            assert!(factors.reciprocity_error() < limit, "{method:?}: {}", factors.reciprocity_error());
            factors.normalize_rows();
            assert!((0..6).all(|i| (factors.row(i).iter().sum::<f64>() - 1.0).abs() < 1e-14));
            assert!((6..8).all(|i| factors.row(i).iter().all(|&f| f == 0.0)), "{method:?}");
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let go = |patches: &[PatchPolygon], settings: &MethodSettings| {
            FormFactors::compute(patches, Method::Hemicube, settings, &Control::default())
        };
        let odd = MethodSettings { resolution: 33, ..MethodSettings::default() };
        assert!(matches!(go(&cube(true), &odd), Err(RadiosityError::Setting { value: 33.0, .. })));
        let many = vec![cube(true)[0]; FormFactors::MAX_PATCHES + 1];
        assert!(matches!(go(&many, &MethodSettings::default()), Err(RadiosityError::MatrixTooLarge { .. })));
        let stop = std::sync::atomic::AtomicBool::new(true);
        let control = Control { cancel: Some(&stop), ..Control::default() };
        let stopped = FormFactors::compute(&cube(true), Method::Exact, &MethodSettings::default(), &control);
        assert_eq!(stopped, Err(RadiosityError::Cancelled));
        assert!(FormFactors::from_rows(vec![1.0], vec![]).is_err());
        let none = go(&[], &MethodSettings::default()).expect("an empty matrix");
        assert_eq!((none.size(), none.row_sums()), (0, None));
    }
}
