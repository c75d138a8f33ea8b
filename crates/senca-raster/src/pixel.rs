//! Single pixels of a target: the depth test, the blending and the writing, the plain form.

use crate::api::{Blend, Factor, State};
use crate::setup::{Bounds, scissor_bounds};
use crate::target::{Clear, ColorPlane, Target, rgba8_from_rgba};

fn index(target: &Target<'_>, x: i32, y: i32) -> usize {
    y as usize * target.width as usize + x as usize
}

/// Whether a fragment passes the depth test at a pixel.
pub(crate) fn depth_passes(target: &Target<'_>, state: &State, x: i32, y: i32, depth: f32) -> bool {
    target.depth.as_ref().is_none_or(|plane| state.depth_test.passes(depth, plane[index(target, x, y)]))
}

/// Whether a fragment passes the stencil and the depth test at a pixel. Does what the stencil test does.
pub(crate) fn passes(target: &mut Target<'_>, state: &State, x: i32, y: i32, depth: f32) -> bool {
    let nearer = depth_passes(target, state, x, y, depth);
    let at = index(target, x, y);
    let (Some(test), Some(plane)) = (&state.stencil, &mut target.stencil) else { return nearer };
    let (stored, passes) = (plane[at], test.passes(plane[at]));
    let op = match (passes, nearer) {
        (false, _) => test.fail,
        (true, false) => test.depth_fail,
        (true, true) => test.pass,
    };
    plane[at] = test.after(op, stored);
    passes && nearer
}

/// Writes a fragment that has passed.
pub(crate) fn write(
    target: &mut Target<'_>,
    state: &State,
    x: i32,
    y: i32,
    depth: f32,
    id: u32,
    rgba: Option<[f32; 4]>,
) {
    let i = index(target, x, y);
    if let Some(plane) = target.depth.as_mut().filter(|_| state.depth_write) {
        plane[i] = depth;
    }
    if let Some(plane) = &mut target.ids {
        plane[i] = id;
    }
    if let (Some(plane), Some(rgba)) = (&mut target.color, rgba) {
        write_color(plane, i, rgba, state.blend);
    }
}

fn write_color(plane: &mut ColorPlane<'_>, i: usize, rgba: [f32; 4], blend: Option<Blend>) {
    let mix = |old: [f32; 4]| blend.map_or(rgba, |b| blended(b, rgba, old));
    match plane {
        ColorPlane::Rgba32F(p) => p[i] = mix(p[i]),
        ColorPlane::Rgba8(p) if blend == Some(Blend::ADD) => {
            let bytes = rgba8_from_rgba(rgba);
            p[i] = std::array::from_fn(|k| p[i][k].saturating_add(bytes[k]));
        }
        ColorPlane::Rgba8(p) => p[i] = rgba8_from_rgba(mix(p[i].map(|v| f32::from(v) * (1.0 / 255.0)))),
    }
}

/// New and old colour, mixed.
pub(crate) fn blended(blend: Blend, new: [f32; 4], old: [f32; 4]) -> [f32; 4] {
    let (s, d) = (factor(blend.source, new, old), factor(blend.destination, new, old));
    std::array::from_fn(|k| new[k] * s[k] + old[k] * d[k])
}

fn factor(factor: Factor, new: [f32; 4], old: [f32; 4]) -> [f32; 4] {
    match factor {
        Factor::Zero => [0.0; 4],
        Factor::One => [1.0; 4],
        Factor::SourceColor => new,
        Factor::OneMinusSourceColor => new.map(|v| 1.0 - v),
        Factor::DestinationColor => old,
        Factor::OneMinusDestinationColor => old.map(|v| 1.0 - v),
        Factor::SourceAlpha => [new[3]; 4],
        Factor::OneMinusSourceAlpha => [1.0 - new[3]; 4],
        Factor::DestinationAlpha => [old[3]; 4],
        Factor::OneMinusDestinationAlpha => [1.0 - old[3]; 4],
        Factor::SourceAlphaSaturate => {
            let rest = 1.0 - old[3];
            let least = if new[3] < rest { new[3] } else { rest };
            [least, least, least, 1.0]
        }
    }
}

/// The pixels that [`State::clear`] clears.
pub(crate) fn clear_bounds(target: &Target<'_>, state: &State) -> Bounds {
    let bounds = scissor_bounds(target.width, target.height, state);
    state.clear_area.map_or(bounds, |area| bounds.intersect(Bounds::of_rect(area)))
}

/// Does [`State::clear`].
pub(crate) fn clear_in_scissor(target: &mut Target<'_>, state: &State) {
    let Some(clear) = state.clear else { return };
    let bounds = clear_bounds(target, state);
    if bounds == target.bounds() {
        target.clear(&clear);
        return;
    }
    for y in bounds.y0..bounds.y1 {
        if bounds.x0 < bounds.x1 {
            let row = index(target, bounds.x0, y)..index(target, bounds.x1 - 1, y) + 1;
            clear_range(target, row, &clear);
        }
    }
}

pub(crate) fn clear_range(target: &mut Target<'_>, range: std::ops::Range<usize>, clear: &Clear) {
    if let (Some(plane), Some(rgba)) = (&mut target.color, clear.color) {
        match plane {
            ColorPlane::Rgba32F(p) => p[range.clone()].fill(rgba),
            ColorPlane::Rgba8(p) => p[range.clone()].fill(rgba8_from_rgba(rgba)),
        }
    }
    if let (Some(plane), Some(depth)) = (&mut target.depth, clear.depth) {
        plane[range.clone()].fill(depth);
    }
    if let (Some(plane), Some(stencil)) = (&mut target.stencil, clear.stencil) {
        plane[range.clone()].fill(stencil);
    }
    if let (Some(plane), Some(id)) = (&mut target.ids, clear.id) {
        plane[range].fill(id);
    }
}
