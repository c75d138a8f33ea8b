//! The accumulation buffer: sums of pictures.
//!
//! Source: OpenGL 1.5, section 4.2.4.

use super::plane::{Area, Plane};
use crate::gl;
use crate::texture::{Texels, each_row, filled};

/// Sums of colours, one per pixel of the window. Kept as floats, which hold more than the range of -1 to 1.
#[derive(Debug)]
pub(crate) struct Accumulation {
    width: u32,
    sums: Vec<[f32; 4]>,
}

impl Accumulation {
    /// Sums of zero, `None` if memory does not suffice.
    pub(crate) fn new(width: u32, height: u32) -> Option<Self> {
        Some(Self { width, sums: filled([0.0; 4], width as usize * height as usize)? })
    }

    /// Calls `change` with each row of `area`: number of the row, its sums.
    fn rows(&mut self, area: Area, change: impl Fn(usize, &mut [[f32; 4]]) + Sync) {
        if area.is_empty() {
            return;
        }
        let stride = self.width as usize;
        let rows = &mut self.sums[area.y0 as usize * stride..area.y1 as usize * stride];
        each_row(rows, stride, |y, row| change(y + area.y0 as usize, &mut row[area.columns(1)]));
    }

    /// Sets all sums.
    pub(crate) fn clear(&mut self, area: Area, value: [f32; 4]) {
        self.rows(area, |_, row| row.fill(value));
    }

    /// `ADD` and `MULT`: adds to all sums, or multiplies them.
    pub(crate) fn adjust(&mut self, area: Area, op: u32, value: f32) {
        self.rows(area, |_, row| {
            for sum in row.as_flattened_mut() {
                *sum = if op == gl::ADD { *sum + value } else { *sum * value };
            }
        });
    }

    /// `ACCUM` and `LOAD`: adds the colours of a plane times `value` to the sums, or puts them in their place.
    pub(crate) fn take(&mut self, area: Area, op: u32, value: f32, plane: &Plane) {
        let kept = if op == gl::ACCUM { 1.0 } else { 0.0 };
        let area = area.intersect(plane.area());
        if !plane.is_present() {
            return;
        }
        self.rows(area, |y, row| {
            let first = plane.at(area.x0 as usize, y);
            for (i, sum) in row.iter_mut().enumerate() {
                let color = plane.texels.color(first + i);
                *sum = std::array::from_fn(|k| sum[k] * kept + color[k] * value);
            }
        });
    }

    /// `RETURN`: writes the sums times `value`, clamped to [0, 1], to those channels of a plane that `mask` lets
    /// through.
    pub(crate) fn give(&self, area: Area, value: f32, plane: &mut Plane, mask: [bool; 4]) {
        let area = area.intersect(plane.area());
        if area.is_empty() || !plane.is_present() {
            return;
        }
        let (stride, width) = (plane.stride(), self.width as usize);
        let range = plane.at(0, area.y0 as usize)..plane.at(0, area.y1 as usize);
        let returned = |y: usize, x: usize| {
            self.sums[(y + area.y0 as usize) * width + x].map(|sum| (sum * value).clamp(0.0, 1.0))
        };
        let columns = area.columns(1);
        match plane.texels_mut() {
            Texels::Rgba8(colors) => each_row(&mut colors[range], stride, |y, row| {
                for x in columns.clone() {
                    let new = returned(y, x).map(crate::pixel::unorm8_from_f32);
                    row[x] = std::array::from_fn(|i| if mask[i] { new[i] } else { row[x][i] });
                }
            }),
            Texels::Rgba32F(colors) => each_row(&mut colors[range], stride, |y, row| {
                for x in columns.clone() {
                    let new = returned(y, x);
                    row[x] = std::array::from_fn(|i| if mask[i] { new[i] } else { row[x][i] });
                }
            }),
            _ => {}
        }
    }
}
