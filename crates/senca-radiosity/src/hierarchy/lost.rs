//! Light that leaves the scene, or ends on backs.

use rayon::prelude::*;
use senca_math::glam::{DVec2, DVec3};

use super::sight::mix;
use super::state::State;
use crate::gather::Frame;
use crate::open_parts::OpenParts;
use crate::{ElementMesh, Occluders};

/// Rays of the smallest element, and how many all of the scene has in addition.
const RAYS: [f64; 2] = [16.0, 32_768.0];

/// Inverse powers of the root of x^3 = x + 1: their multiples spread evenly over a square (Roberts 2018).
const EVEN: DVec2 = DVec2::new(0.754_877_666_246_693, 0.569_840_290_998_053_3);

/// Estimates for all leaves that have none what share of their light meets no front. Parts of elements
/// that lose nothing lose nothing.
pub(super) fn estimate_lost(state: &mut State, mesh: &ElementMesh, occluders: &Occluders, open: &OpenParts) {
    let total = mesh.area();
    for element in 0..mesh.elements().len() {
        let parent = mesh.elements()[element].parent as usize;
        if state.lost[element].is_nan() && parent < element {
            let above = state.lost[parent];
            if above == 0.0 {
                state.lost[element] = above;
            }
        }
    }
    let polygons = mesh.polygons().len();
    let wanted = |&number: &usize| {
        state.lost[number].is_nan() && (number < polygons || mesh.elements()[number].is_leaf())
    };
    let wanted: Vec<usize> = (0..mesh.elements().len()).filter(wanted).collect();
    let estimate = |&number: &usize| {
        let share = mesh.elements()[number].area / total;
        let rays = (RAYS[0] + RAYS[1] * share).ceil() as u32;
        let place = |on: DVec2| open.place(mesh, number as u32, on.x, on.y);
        lost_share(mesh, occluders, number as u32, rays, &place)
    };
    let found: Vec<f32> = wanted.par_iter().with_min_len(16).map(estimate).collect();
    for (&number, &share) in wanted.iter().zip(&found) {
        state.lost[number] = share;
    }
}

fn lost_share(
    mesh: &ElementMesh,
    occluders: &Occluders,
    element: u32,
    rays: u32,
    place: &impl Fn(DVec2) -> DVec3,
) -> f32 {
    let normal = mesh.normal(element);
    let frame = Frame::of(normal);
    let (first, second) = (mix(u64::from(element) + 1), mix(u64::from(element) ^ 0x9e37_79b9_7f4a_7c15));
    let unit = |bits: u64| f64::from(bits as u32) / 4_294_967_296.0;
    let shifts = [first, second].map(|bits| DVec2::new(unit(bits), unit(bits >> 32)));
    let is_lost = |ray: &u32| {
        let on = (shifts[0] + EVEN * f64::from(*ray)).fract_gl();
        // The radical inverse would be as good; the golden ratio keeps places and directions apart.
        let round = (shifts[1] + DVec2::new(0.618_033_988_749_895, 0.414_213_562_373_095) * f64::from(*ray))
            .fract_gl();
        let direction = frame.cosine_weighted(round.x, round.y);
        !occluders.closest(place(on), direction).is_some_and(|hit| hit.front)
    };
    (1..=rays).filter(is_lost).count() as f32 / rays as f32
}
