//! Setting all pixels of a rectangle to one value.

use super::plane::{Area, Plane};
use crate::pixel::unorm8_from_f32;
use crate::texture::{Texels, each_row};

/// Sets the pixels of `area` to a colour in those channels that `mask` lets through. Planes without alpha keep
/// theirs at 1.
pub(crate) fn fill_color(plane: &mut Plane, area: Area, color: [f32; 4], mask: [bool; 4]) {
    let base = plane.format.base();
    let color = base.stored(color.map(|c| c.clamp(0.0, 1.0)), 1.0);
    let all = mask == [true; 4];
    match_rows(plane, area, |texels, range, stride, columns, lines| match texels {
        Texels::Rgba8(colors) => {
            let color = color.map(unorm8_from_f32);
            let mut keep = mask.map(|on| if on { 0 } else { 255 });
            if !base.has_alpha() {
                keep[3] = 0;
            }
            each_row(&mut colors[range], stride, |y, row| {
                if !lines.contains(&y) {
                } else if all {
                    row[columns.clone()].fill(color);
                } else {
                    row[columns.clone()].iter_mut().for_each(|old| {
                        *old = std::array::from_fn(|i| old[i] & keep[i] | color[i] & !keep[i]);
                    });
                }
            });
        }
        Texels::Rgba32F(colors) => each_row(&mut colors[range], stride, |y, row| {
            if lines.contains(&y) {
                row[columns.clone()].iter_mut().for_each(|old| {
                    *old = std::array::from_fn(|i| if mask[i] { color[i] } else { old[i] });
                });
            }
        }),
        _ => {}
    });
}

/// Sets the depths of `area`.
pub(crate) fn fill_depth(plane: &mut Plane, area: Area, depth: f32) {
    match_rows(plane, area, |texels, range, stride, columns, lines| {
        if let Some(depths) = texels.depths_mut() {
            each_row(&mut depths[range], stride, |y, row| {
                if lines.contains(&y) {
                    row[columns.clone()].fill(depth);
                }
            });
        }
    });
}

/// Sets those bits of the stencil values of `area` that `mask` has.
pub(crate) fn fill_stencil(plane: &mut Plane, area: Area, stencil: u8, mask: u8) {
    match_rows(plane, area, |texels, range, stride, columns, lines| {
        if let Some(stencils) = texels.stencils_mut() {
            each_row(&mut stencils[range], stride, |y, row| {
                if !lines.contains(&y) {
                } else if mask == 0xff {
                    row[columns.clone()].fill(stencil);
                } else {
                    row[columns.clone()].iter_mut().for_each(|old| *old = *old & !mask | stencil & mask);
                }
            });
        }
    });
}

type Span = std::ops::Range<usize>;

/// Calls `fill` with the texels, those of the rows that `area` touches, their stride, and columns and rows to be
/// filled, counted within.
fn match_rows(plane: &mut Plane, area: Area, fill: impl FnOnce(&mut Texels, Span, usize, Span, Span)) {
    let area = area.intersect(plane.area());
    if area.is_empty() || !plane.is_present() {
        return;
    }
    let side = plane.side();
    let lines = area.lines(side);
    let range = plane.at(0, lines.start)..plane.at(0, lines.end);
    let stride = plane.stride();
    let count = lines.len();
    fill(plane.texels_mut(), range, stride, area.columns(side), 0..count);
}
