//! Reducing an image to half its size.
//!
//! A texel of the smaller image is the mean of what it covers of the larger one, by area: of 2 texels along an even
//! side, of parts of 3 along an odd one. Red, green and blue of sRGB are averaged as light. A border is reduced
//! along its length only.
//!
//! Source: OpenGL 1.5, section 3.8.8, which leaves the filter open and recommends a box.

use std::sync::{Arc, LazyLock};

use super::image::each_row;
use super::{TexImage, Texels};
use crate::error::Error;

/// Texels of the larger image along one axis, with their shares of a texel of the smaller one.
type Taps = Vec<Vec<(usize, f32)>>;

/// The image of half the size, down to 1 texel along each axis. `None` if there is nothing to halve.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub(crate) fn next_level(image: &TexImage) -> Option<Result<TexImage, Error>> {
    let size = half_size(image)?;
    Some(TexImage::new(image.format, size, image.border).map(|mut smaller| {
        reduce(image, &mut smaller);
        smaller
    }))
}

/// Size with border of the image of half the size.
fn half_size(image: &TexImage) -> Option<[u32; 3]> {
    if !image.is_present() {
        return None;
    }
    let border = 2 * image.border;
    // Axes a texture does not have are 1 texel without border.
    let inner = |side: u32| if side == 1 { None } else { Some(side - border) };
    let sides = image.size().map(inner);
    if sides.iter().flatten().all(|&side| side <= 1) {
        return None;
    }
    Some(sides.map(|side| side.map_or(1, |side| (side / 2).max(1) + border)))
}

fn reduce(image: &TexImage, smaller: &mut TexImage) {
    let even = |side: u32| side.is_multiple_of(2);
    let simple = image.depth == 1 && image.border == 0 && even(image.width) && even(image.height);
    match (&*image.texels, Arc::get_mut(&mut smaller.texels)) {
        (Texels::Rgba8(from), Some(Texels::Rgba8(to))) if simple && !image.format.is_srgb() => {
            let width = image.width as usize;
            each_row(to, width / 2, |y, row| {
                let (low, high) = from[2 * y * width..2 * (y + 1) * width].split_at(width);
                halve_row(low, high, row);
            });
        }
        _ => reduce_plain(image, smaller),
    }
}

/// Means of squares of 2 x 2 texels.
fn halve_row(low: &[[u8; 4]], high: &[[u8; 4]], row: &mut [[u8; 4]]) {
    let pairs = low.as_chunks::<2>().0.iter().zip(high.as_chunks::<2>().0);
    for (texel, ([a, b], [c, d])) in row.iter_mut().zip(pairs) {
        let mean = |i: usize| {
            let sum = u16::from(a[i]) + u16::from(b[i]) + u16::from(c[i]) + u16::from(d[i]);
            ((sum + 2) >> 2) as u8
        };
        *texel = [mean(0), mean(1), mean(2), mean(3)];
    }
}

/// The reduction for any size, border and kind of texels.
pub(super) fn reduce_plain(image: &TexImage, smaller: &mut TexImage) {
    let [xs, ys, zs] = image.size().map(|side| taps(side as usize, image.border as usize));
    let (width, height) = (xs.len(), ys.len());
    let weigh = |index: usize| {
        let (x, y, z) = (index % width, index / width % height, index / (width * height));
        let (xs, ys, zs) = (&xs[x], &ys[y], &zs[z]);
        zs.iter().flat_map(move |&(z, c)| {
            ys.iter().flat_map(move |&(y, b)| xs.iter().map(move |&(x, a)| (image.index(x, y, z), a * b * c)))
        })
    };
    let depth_mean = |from: &[f32], i: usize| weigh(i).map(|(at, weight)| from[at] * weight).sum::<f32>();
    let Some(texels) = Arc::get_mut(&mut smaller.texels) else { return };
    match (&*image.texels, texels) {
        (Texels::Rgba8(from), Texels::Rgba8(to)) => each_row(to, width, |y, row| {
            let srgb = image.format.is_srgb();
            for (i, texel) in (y * width..).zip(row) {
                *texel = mean8(weigh(i).map(|(at, weight)| (from[at], weight)), srgb);
            }
        }),
        (Texels::Rgba32F(from), Texels::Rgba32F(to)) => each_row(to, width, |y, row| {
            for (i, texel) in (y * width..).zip(row) {
                *texel = weigh(i).fold([0.0; 4], |sum, (at, weight)| {
                    std::array::from_fn(|channel| sum[channel] + from[at][channel] * weight)
                });
            }
        }),
        (Texels::Depth(from), Texels::Depth(to)) => {
            to.iter_mut().enumerate().for_each(|(i, texel)| *texel = depth_mean(from, i));
        }
        (Texels::DepthStencil { depth: from, stencil: old }, Texels::DepthStencil { depth, stencil }) => {
            depth.iter_mut().enumerate().for_each(|(i, texel)| *texel = depth_mean(from, i));
            // Stencil values have no mean.
            let first = |i: usize| weigh(i).next().map_or(0, |(at, _)| old[at]);
            stencil.iter_mut().enumerate().for_each(|(i, texel)| *texel = first(i));
        }
        _ => {}
    }
}

/// Weighted mean of texels of 8 bits.
fn mean8(texels: impl Iterator<Item = ([u8; 4], f32)>, srgb: bool) -> [u8; 4] {
    let mut sum = [0.0_f32; 4];
    for (texel, weight) in texels {
        for (channel, &value) in texel.iter().enumerate() {
            let value = if srgb && channel < 3 { light(value) } else { f32::from(value) };
            sum[channel] += value * weight;
        }
    }
    let rounded = |channel: usize| {
        if srgb && channel < 3 { code(sum[channel]) } else { (sum[channel] + 0.5) as u8 }
    };
    [rounded(0), rounded(1), rounded(2), rounded(3)]
}

/// What each texel of the smaller image covers along an axis of `side` texels, borders included.
fn taps(side: usize, border: usize) -> Taps {
    if side == 1 {
        return vec![vec![(0, 1.0)]];
    }
    let inner = side - 2 * border;
    let count = (inner / 2).max(1);
    let length = inner as f64 / count as f64;
    let covered = |i: usize| {
        let (begin, end) = (i as f64 * length, (i + 1) as f64 * length);
        let cells = begin as usize..((end - 1e-9).ceil() as usize).min(inner);
        let share = |cell: usize| (end.min((cell + 1) as f64) - begin.max(cell as f64)) / length;
        cells.map(|cell| (cell + border, share(cell) as f32)).collect()
    };
    let edge = |cell: usize| (border > 0).then(|| vec![(cell, 1.0)]);
    edge(0).into_iter().chain((0..count).map(covered)).chain(edge(side - 1)).collect()
}

/// Light of each code of sRGB, and below it where the codes change.
///
/// Source: IEC 61966-2-1.
static SRGB: LazyLock<([f32; 256], [f32; 255])> = LazyLock::new(|| {
    let decode = |code: f64| {
        let c = code / 255.0;
        (if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }) as f32
    };
    let middles = std::array::from_fn(|i| decode(i as f64 + 0.5));
    (std::array::from_fn(|i| decode(i as f64)), middles)
});

/// Light of a code of sRGB, 0 to 1.
fn light(code: u8) -> f32 {
    SRGB.0[code as usize]
}

/// Nearest code of sRGB of a light.
fn code(light: f32) -> u8 {
    SRGB.1.partition_point(|&middle| middle <= light) as u8
}
