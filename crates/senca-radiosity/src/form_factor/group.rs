//! The form factor between two groups of patches, by each method.

use rayon::prelude::*;

use super::cells::cells;
use super::ray_cast::ray_cast_exchange;
use super::{
    FirstHit, Hemicube, HemicubeView, Method, MethodSettings, PatchScene, Unoccluded, double_area, exchange,
    monte_carlo, nusselt_directions, polygon_to_polygon_by_contours,
};
use crate::{PatchPolygon, RadiosityError};

/// What a method says of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupFactor {
    /// The form factor.
    pub value: f64,
    /// Its standard error, from a method of chance.
    pub standard_error: Option<f64>,
}

/// Form factor from all of `from` to all of `to`, which may be one patch each, or the parts of a shape: the
/// mean over the one, weighted by area, of the sum over the other (course text, equation 4.15). All of
/// both are obstacles to the methods that see any.
///
/// # Errors
/// [`RadiosityError::Setting`] for a resolution out of range.
pub fn group_factor(
    from: &[PatchPolygon],
    to: &[PatchPolygon],
    method: Method,
    settings: &MethodSettings,
) -> Result<GroupFactor, RadiosityError> {
    let area: f64 = from.iter().map(|p| p.normal_and_area().1).sum();
    let exchanged = |pair: &(dyn Fn(&PatchPolygon, &PatchPolygon) -> f64 + Sync)| {
        let row = |i: &PatchPolygon| to.iter().map(|j| pair(i, j)).sum::<f64>();
        sum_in_order(from.par_iter().map(row).collect()) / area
    };
    let own_area = |i: &PatchPolygon| i.normal_and_area().1;
    let value = match method {
        Method::Exact => exchanged(&|i, j| exchange(i.corners(), j.corners())),
        Method::Contours => {
            exchanged(&|i, j| polygon_to_polygon_by_contours(i.corners(), j.corners()) * own_area(i))
        }
        Method::DoubleArea => {
            let n = settings.double_area_parts;
            exchanged(&|i, j| double_area(i.corners(), j.corners(), n, &Unoccluded) * own_area(i))
        }
        Method::RayCast => {
            let scene = both(from, to)?;
            exchanged(&|i, j| ray_cast_exchange(i, j, &scene, &settings.ray_cast))
        }
        Method::Hemicube => hemicube(from, to, settings)? / area,
        Method::Nusselt => nusselt(from, to, settings)? / area,
        Method::MonteCarlo => return by_chance(from, to, settings, area),
    };
    Ok(GroupFactor { value: if value.is_finite() { value } else { 0.0 }, standard_error: None })
}

fn sum_in_order(parts: Vec<f64>) -> f64 {
    parts.iter().sum()
}

fn both(from: &[PatchPolygon], to: &[PatchPolygon]) -> Result<PatchScene, RadiosityError> {
    PatchScene::new(&[from, to].concat())
}

fn hemicube(
    from: &[PatchPolygon],
    to: &[PatchPolygon],
    settings: &MethodSettings,
) -> Result<f64, RadiosityError> {
    let hemicube = Hemicube::new(settings.resolution, settings.cell_factor)?;
    let all = [to, from].concat();
    let row = |view: &mut HemicubeView<'_>, i: &PatchPolygon| {
        let factors = view.factors(i.corners(), settings.parts, &all);
        factors[..to.len()].iter().sum::<f64>() * i.normal_and_area().1
    };
    Ok(sum_in_order(from.par_iter().map_init(|| HemicubeView::new(&hemicube), row).collect()))
}

fn nusselt(
    from: &[PatchPolygon],
    to: &[PatchPolygon],
    settings: &MethodSettings,
) -> Result<f64, RadiosityError> {
    let scene = both(from, to)?;
    let first = from.len();
    let row = |i: &PatchPolygon| {
        let (normal, _) = i.normal_and_area();
        let directions: Vec<_> = nusselt_directions(normal, settings.directions.max(1)).collect();
        let seen = |place| {
            let hits = directions.iter().map(|&d| scene.first_hit(place, d));
            hits.filter(|h| matches!(h, FirstHit::Front(k) if *k >= first)).count() as f64
        };
        let parts = cells(i.corners(), settings.parts);
        parts.iter().map(|c| c.area * seen(c.point)).sum::<f64>() / directions.len().max(1) as f64
    };
    Ok(sum_in_order(from.par_iter().map(row).collect()))
}

/// Rays are shared out among the patches.
fn by_chance(
    from: &[PatchPolygon],
    to: &[PatchPolygon],
    settings: &MethodSettings,
    area: f64,
) -> Result<GroupFactor, RadiosityError> {
    let scene = both(from, to)?;
    let all = [from, to].concat();
    let mut each = settings.monte_carlo;
    each.rays = each.rays.div_ceil(from.len().max(1) as u32);
    let row = |i: usize| {
        let row = monte_carlo(i, &all, &scene, &each);
        let weight = all[i].normal_and_area().1 / area;
        let factor: f64 = row.factors[from.len()..].iter().sum();
        let square: f64 = row.errors[from.len()..].iter().map(|e| e * e).sum();
        [factor * weight, square * weight * weight]
    };
    let rows: Vec<[f64; 2]> = (0..from.len()).into_par_iter().map(row).collect();
    let sum = |k: usize| rows.iter().map(|r| r[k]).sum::<f64>();
    Ok(GroupFactor { value: sum(0), standard_error: Some(sum(1).sqrt()) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form_factor::closed_form::{cube_adjacent, parallel_rectangles};
    use senca_math::glam::DVec3;

    fn strips(n: usize, map: impl Fn(f64, f64) -> DVec3) -> Vec<PatchPolygon> {
        let at = |k: usize| k as f64 / n as f64;
        let strip = |k: usize| [map(at(k), 0.0), map(at(k + 1), 0.0), map(at(k + 1), 1.0), map(at(k), 1.0)];
        (0..n).map(|k| PatchPolygon::quad(strip(k))).collect()
    }

    #[test]
    fn groups_have_the_factor_of_the_whole() {
        let floor = strips(3, |x, y| DVec3::new(x, y, 0.0));
        let ceiling = strips(2, |x, y| DVec3::new(y, x, 1.0));
        let wall = strips(2, |z, y| DVec3::new(0.0, y, 1.0 - z));
        for method in Method::ALL {
            let of =
                |to| group_factor(&floor, to, method, &MethodSettings::default()).expect("good settings");
            let limit = match method {
                Method::Exact | Method::Contours | Method::RayCast => 1e-12,
                Method::DoubleArea => 2e-2,
                Method::MonteCarlo => 5.0 * of(&ceiling).standard_error.expect("an error"),
                Method::Hemicube | Method::Nusselt => 2e-3,
            };
            let off = (of(&ceiling).value - parallel_rectangles(1.0, 1.0, 1.0)).abs();
            assert!(off < limit, "{method:?}: {off}");
            let off = (of(&wall).value - cube_adjacent()).abs();
            assert!(off < 2.0 * limit, "{method:?}: {off}");
        }
    }

    #[test]
    fn no_patches_have_no_factor() {
        let some = strips(1, |x, y| DVec3::new(x, y, 0.0));
        for method in Method::ALL {
            for (from, to) in [(&some[..], &[][..]), (&[], &some[..])] {
                let factor =
                    group_factor(from, to, method, &MethodSettings::default()).expect("good settings");
                assert_eq!(factor.value, 0.0, "{method:?}");
            }
        }
    }
}
