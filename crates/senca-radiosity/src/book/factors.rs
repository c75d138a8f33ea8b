//! From the exchange of elements to the factors of patches, and back.

use rayon::prelude::*;
use senca_math::LinearRgb;
use senca_math::glam::DVec3;

use super::rows::Rows;
use crate::direct::cosine_direction;
use crate::system::{FactorMatrix, Rgb64};
use crate::{ElementMesh, Occluders};

/// Rays that have to meet fronts for a patch to count as surrounded.
const RAYS: u32 = 64;

/// Rounds of bringing row sums to 1.
const ROUNDS: u32 = 32;

/// The scale of a patch stays within this and its inverse.
const LARGEST_SCALE: f64 = 1.25;

/// Factors between patches.
#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    pub(super) matrix: FactorMatrix,
    pub(super) largest_row_sum: f64,
    /// What the exchange of elements of row i with patch j is to be multiplied by, by row, for the
    /// entries that elements have. Empty where it is 1 for all.
    scales: Vec<Vec<(u32, f64)>>,
}

impl Factors {
    /// Means over the leaves of each patch (equation 4.15), with reciprocity, and rows that sum to 1
    /// where they have to.
    pub(super) fn new(
        mesh: &ElementMesh,
        occluders: &Occluders,
        patches: &[u32],
        patch_of: &[u32],
        rows: &Rows,
    ) -> Self {
        let leaves = leaves_of(mesh, patches.len(), patch_of);
        let sums: Vec<Vec<(u32, f64)>> =
            leaves.par_iter().with_min_len(4).map(|leaves| summed(leaves, patches.len(), rows)).collect();
        let area = |i: usize| mesh.elements()[patches[i] as usize].area;
        let row_sum = |(i, row): (usize, &Vec<(u32, f64)>)| row.iter().map(|e| e.1).sum::<f64>() / area(i);
        let largest_row_sum = sums.iter().enumerate().map(row_sum).fold(0.0, f64::max);
        let weights: Vec<f64> = leaves.iter().map(|leaves| leaves.len() as f64).collect();
        let even = symmetric(&sums, &weights);
        let surrounded: Vec<bool> =
            patches.par_iter().map(|&patch| is_surrounded(mesh, occluders, patch)).collect();
        let areas: Vec<f64> = (0..patches.len()).map(area).collect();
        let scale = balanced(&even, &areas, &surrounded);
        let scaled = |(i, row): (usize, &Vec<(u32, f64)>)| -> Vec<(u32, f64)> {
            row.iter().map(|&(j, e)| (j, e * scale[i] * scale[j as usize])).collect()
        };
        let exchange: Vec<Vec<(u32, f64)>> = even.iter().enumerate().map(scaled).collect();
        let scales = sums.iter().zip(&exchange).map(|(old, new)| ratios(old, new)).collect();
        let factors = |(i, row): (usize, Vec<(u32, f64)>)| -> Vec<(u32, f64)> {
            row.into_iter().map(|(j, e)| (j, e / areas[i])).collect()
        };
        let matrix = FactorMatrix::from_rows(exchange.into_iter().enumerate().map(factors));
        Self { matrix, largest_row_sum, scales }
    }

    /// What arrives at each leaf from patches of these radiosities (section 4.3: the rows of the
    /// elements, all else known), with `incident`, which is what arrives at the patches, as the mean over
    /// each. Black for elements that are divided.
    pub(super) fn on_leaves(
        &self,
        mesh: &ElementMesh,
        patch_of: &[u32],
        rows: &Rows,
        radiosity: &[Rgb64],
        incident: &[Rgb64],
    ) -> Vec<LinearRgb> {
        let leaves = leaves_of(mesh, radiosity.len(), patch_of);
        let mut values = vec![LinearRgb::BLACK; mesh.elements().len()];
        let of_patch = |(i, leaves): (usize, &Vec<u32>)| -> Vec<(u32, Rgb64)> {
            let own = |&leaf: &u32| (leaf, self.gathered(i, rows.of(leaf), radiosity));
            let mut found: Vec<(u32, Rgb64)> = leaves.iter().map(own).collect();
            let area = |leaf: u32| mesh.elements()[leaf as usize].area;
            let whole: f64 = leaves.iter().map(|&leaf| area(leaf)).sum();
            for c in 0..3 {
                let mean = found.iter().map(|(_, power)| power[c]).sum::<f64>() / whole;
                let missing = incident[i][c] - mean;
                for (leaf, power) in &mut found {
                    power[c] = (power[c] / area(*leaf) + missing).max(0.0);
                }
            }
            found
        };
        let found: Vec<_> = leaves.par_iter().enumerate().with_min_len(4).flat_map_iter(of_patch).collect();
        for (leaf, value) in found {
            values[leaf as usize] = LinearRgb::from_array(value.map(|v| v as f32));
        }
        values
    }

    /// Power that arrives at an element of patch `i` with this row.
    fn gathered(&self, i: usize, row: &[(u32, f32)], radiosity: &[Rgb64]) -> Rgb64 {
        let mut scales = self.scales.get(i).map(|scales| scales.iter());
        let mut power = [0.0; 3];
        for &(j, exchange) in row {
            // Both ascend, and each column of an element is one of its patch's.
            let scale = match &mut scales {
                None => 1.0,
                Some(scales) => match scales.find(|(column, _)| *column == j) {
                    Some(&(_, scale)) => scale,
                    None => break,
                },
            };
            let received = f64::from(exchange) * scale;
            (0..3).for_each(|c| power[c] += received * radiosity[j as usize][c]);
        }
        power
    }
}

/// Leaves of each patch, ascending.
fn leaves_of(mesh: &ElementMesh, patches: usize, patch_of: &[u32]) -> Vec<Vec<u32>> {
    let mut leaves = vec![Vec::new(); patches];
    for leaf in mesh.leaves() {
        leaves[patch_of[leaf as usize] as usize].push(leaf);
    }
    leaves
}

/// Sum of the rows of some leaves.
fn summed(leaves: &[u32], patches: usize, rows: &Rows) -> Vec<(u32, f64)> {
    let mut sums = vec![0.0; patches];
    for &leaf in leaves {
        for &(patch, exchange) in rows.of(leaf) {
            sums[patch as usize] += f64::from(exchange);
        }
    }
    (0..).zip(sums).filter(|(_, sum)| *sum > 0.0).collect()
}

/// The mean of both directions, weighted by the elements that looked.
fn symmetric(sums: &[Vec<(u32, f64)>], weights: &[f64]) -> Vec<Vec<(u32, f64)>> {
    let find = |i: usize, j: u32| {
        let row = &sums[i];
        row.binary_search_by_key(&j, |entry| entry.0).map_or(0.0, |at| row[at].1)
    };
    let mut even: Vec<Vec<(u32, f64)>> = vec![Vec::new(); sums.len()];
    for (i, row) in sums.iter().enumerate() {
        for &(j, there) in row {
            let k = j as usize;
            let back = find(k, i as u32);
            let mean = (weights[i] * there + weights[k] * back) / (weights[i] + weights[k]);
            even[i].push((j, mean));
            if back == 0.0 {
                even[k].push((i as u32, mean));
            }
        }
    }
    for row in &mut even {
        row.sort_unstable_by_key(|entry| entry.0);
    }
    even
}

/// Whether rays from all over a patch meet the fronts of opaque polygons in every direction.
pub(super) fn is_surrounded(mesh: &ElementMesh, occluders: &Occluders, patch: u32) -> bool {
    let (shape, normal) = (mesh.shape(patch), mesh.normal(patch));
    let (x, y) = normal.any_orthonormal_pair();
    (0..RAYS).all(|ray| {
        let d = cosine_direction(ray, RAYS);
        let direction: DVec3 = x * d.x + y * d.y + normal * d.z;
        let place = |k: f64| (k * f64::from(ray + 1)).fract();
        let from = shape.place(place(0.754_877_666_246_693), place(0.569_840_290_998_053));
        occluders
            .closest(from, direction)
            .is_some_and(|hit| hit.front && mesh.surface(hit.polygon).transmittance == LinearRgb::BLACK)
    })
}

/// A scale for each patch that brings the row sums of the exchange to the areas, where patches are
/// surrounded, and down to the areas elsewhere.
fn balanced(exchange: &[Vec<(u32, f64)>], areas: &[f64], surrounded: &[bool]) -> Vec<f64> {
    let mut scale = vec![1.0f64; areas.len()];
    for _ in 0..ROUNDS {
        let step = |i: usize| {
            let row = exchange[i].iter();
            let sum: f64 = scale[i] * row.map(|&(j, e)| e * scale[j as usize]).sum::<f64>();
            let adjust = sum > 0.0 && (surrounded[i] || sum > areas[i]);
            if adjust { scale[i] * (areas[i] / sum).sqrt() } else { scale[i] }
        };
        let next: Vec<f64> = (0..areas.len()).into_par_iter().with_min_len(16).map(step).collect();
        scale = next.into_iter().map(|s| s.clamp(1.0 / LARGEST_SCALE, LARGEST_SCALE)).collect();
    }
    scale
}

/// New over old of the entries that are in both; both ascend.
fn ratios(old: &[(u32, f64)], new: &[(u32, f64)]) -> Vec<(u32, f64)> {
    let mut new = new.iter();
    let ratio = |&(j, before): &(u32, f64)| {
        let after = new.find(|entry| entry.0 == j).map_or(0.0, |entry| entry.1);
        (j, after / before)
    };
    old.iter().map(ratio).collect()
}
