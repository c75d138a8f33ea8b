//! Two levels without more equations (course text, section 4.3, equations 4.14 to 4.16).
//!
//! Patches are divided into parts. The system of the patches has factors that are the means of the
//! parts' ([`condensed`]); once it is solved, the equations of the parts are solved with all patches
//! known ([`parts`]). That is exact where the parts of a patch are as bright as each other, or seen
//! alike; else it is near. What it saves: [`crate::form_factor::Cost`].

use super::{FactorMatrix, Rgb64, System};
use crate::RadiosityError;

/// Sweeps over the parts of one patch at most. Parts of flat patches do not see each other and are
/// right after one.
const SWEEPS: u32 = 100;

/// The system of the patches from that of all parts: `patch_of` is the patch of each part, numbered
/// from 0 without gaps. Areas are sums, emissions and factors means weighted by area (4.15); the parts
/// of one patch have one reflectance.
///
/// # Errors
/// As [`System::new`].
///
/// # Panics
/// When `patch_of` has not one entry per part.
pub fn condensed(parts: &System, patch_of: &[usize]) -> Result<System, RadiosityError> {
    assert_eq!(patch_of.len(), parts.len(), "one patch per part");
    let n = patch_of.iter().max().map_or(0, |most| most + 1);
    let mut areas = vec![0.0; n];
    patch_of.iter().zip(parts.areas()).for_each(|(&patch, area)| areas[patch] += area);
    let (mut reflectance, mut emission) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
    let mut rows = vec![vec![0.0; n]; n];
    for (part, &patch) in patch_of.iter().enumerate() {
        let share = parts.areas()[part] / areas[patch];
        let own = parts.emission()[part];
        emission[patch].iter_mut().zip(own).for_each(|(sum, e)| *sum += share * e);
        reflectance[patch] = parts.reflectance()[part];
        for (other, factor) in parts.factors().row(part) {
            rows[patch][patch_of[other]] += share * factor;
        }
    }
    System::new(FactorMatrix::from_dense(&rows), areas, reflectance, emission)
}

/// Radiosities of the parts from those of the patches: the equations of the parts of each patch, with
/// what comes from other patches known.
///
/// # Panics
/// When `patch_of` has not one entry per part, or names a patch that has no radiosity.
#[must_use]
pub fn parts(parts: &System, patch_of: &[usize], patches: &[Rgb64]) -> Vec<Rgb64> {
    assert_eq!(patch_of.len(), parts.len(), "one patch per part");
    let mut found: Vec<Rgb64> = patch_of.iter().map(|&patch| patches[patch]).collect();
    for _ in 0..SWEEPS {
        let before = found.clone();
        for part in 0..parts.len() {
            let mut incident = [0.0; 3];
            for (other, factor) in parts.factors().row(part) {
                let near = patch_of[other] == patch_of[part];
                let light = if near { found[other] } else { patches[patch_of[other]] };
                (0..3).for_each(|c| incident[c] += factor * light[c]);
            }
            let (rho, own) = (parts.reflectance()[part], parts.emission()[part]);
            found[part] = std::array::from_fn(|c| own[c] + rho[c] * incident[c]);
        }
        if found == before {
            break;
        }
    }
    found
}
