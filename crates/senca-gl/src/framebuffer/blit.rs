//! Copying rectangles between framebuffers: scaled, mirrored, resolved.
//!
//! A pixel of the destination takes what lies at its centre in the source; what falls outside the source leaves it
//! as it is. Of several samples colours are averaged, of depth and stencil the first is taken.
//!
//! Source: ARB_framebuffer_object, section 4.3.3.

use super::plane::{Area, Plane};
use crate::texture::{BaseFormat, Texels};
use rayon::prelude::*;

/// Rows that a thread takes at once.
const ROWS: usize = 32;

/// Corners of the rectangles, of which each may be turned round.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlitRects {
    /// x0, y0, x1, y1 in the source.
    pub(crate) source: [i32; 4],
    /// x0, y0, x1, y1 in the destination.
    pub(crate) destination: [i32; 4],
}

/// What is copied of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Aspect {
    Color,
    Depth,
    Stencil,
}

/// One axis of a blit.
#[derive(Clone, Copy, Debug)]
struct Axis {
    from: [f64; 2],
    to: [f64; 2],
}

impl Axis {
    fn new(from: [i32; 2], to: [i32; 2]) -> Self {
        Self { from: from.map(f64::from), to: to.map(f64::from) }
    }

    /// Place in the source of the centre of a destination pixel.
    fn place(&self, pixel: i32) -> f64 {
        let share = (f64::from(pixel) + 0.5 - self.to[0]) / (self.to[1] - self.to[0]);
        self.from[0] + share * (self.from[1] - self.from[0])
    }

    /// Destination pixels, in rising order.
    fn pixels(&self) -> [i32; 2] {
        [self.to[0].min(self.to[1]) as i32, self.to[0].max(self.to[1]) as i32]
    }
}

impl BlitRects {
    fn axes(&self) -> [Axis; 2] {
        let [a, b, c, d] = self.source;
        let [e, f, g, h] = self.destination;
        [Axis::new([a, c], [e, g]), Axis::new([b, d], [f, h])]
    }

    fn destination_area(&self) -> Area {
        let [x, y] = self.axes();
        let ([x0, x1], [y0, y1]) = (x.pixels(), y.pixels());
        Area { x0, y0, x1, y1 }
    }

    /// Whether pixels are copied one to one without turning, as a resolve demands of sizes.
    pub(crate) fn keeps_size(&self) -> bool {
        let extent = |[a, b, c, d]: [i32; 4]| (c.abs_diff(a), d.abs_diff(b));
        extent(self.source) == extent(self.destination)
    }
}

/// Copies one aspect of a rectangle. `clip` bounds what is written; `linear` averages colours of the four nearest
/// pixels by distance. With several samples on either side, sizes of the rectangles must be equal; with several on
/// both, samples are copied as they are.
pub(crate) fn blit(
    source: &Plane,
    destination: &mut Plane,
    rects: &BlitRects,
    clip: Area,
    aspect: Aspect,
    linear: bool,
) {
    let area = rects.destination_area().intersect(clip).intersect(destination.area());
    if area.is_empty() || !source.is_present() || !destination.is_present() {
        return;
    }
    let nearest = Nearest::new(source, rects, area);
    if copies_runs(source, destination, rects, aspect) {
        return copy_rows(source, destination, &nearest, area);
    }
    if let (Aspect::Color, Texels::Rgba8(from), 2, 1) =
        (aspect, &*source.texels, source.side(), destination.side())
    {
        return resolve8(source, from, destination, &nearest, area);
    }
    blit_plain(source, destination, rects, area, aspect, linear);
}

/// The blit pixel by pixel, for all kinds of planes and rectangles; `area` lies within the destination.
fn blit_plain(
    source: &Plane,
    destination: &mut Plane,
    rects: &BlitRects,
    area: Area,
    aspect: Aspect,
    linear: bool,
) {
    let nearest = Nearest::new(source, rects, area);
    match aspect {
        Aspect::Color if linear && source.samples == 0 => {
            let axes = rects.axes();
            each_pixel(destination, area, |x, y| {
                nearest.at(x, y, area)?;
                Some(bilinear(source, axes[0].place(x), axes[1].place(y)))
            });
        }
        Aspect::Color => blit_samples(source, destination, &nearest, area),
        Aspect::Depth => blit_values(source, destination, &nearest, area, Texels::depths, Texels::depths_mut),
        Aspect::Stencil => {
            blit_values(source, destination, &nearest, area, Texels::stencils, Texels::stencils_mut);
        }
    }
}

/// Whether whole rows can be copied texel by texel.
fn copies_runs(source: &Plane, destination: &Plane, rects: &BlitRects, aspect: Aspect) -> bool {
    let forward = |[a, b, c, d]: [i32; 4]| a <= c && b <= d;
    let single = matches!(
        (aspect, &*source.texels, &*destination.texels),
        (Aspect::Color, Texels::Rgba8(_), Texels::Rgba8(_))
            | (Aspect::Color, Texels::Rgba32F(_), Texels::Rgba32F(_))
            | (Aspect::Depth, Texels::Depth(_), Texels::Depth(_))
            | (Aspect::Stencil, Texels::Stencil(_), Texels::Stencil(_))
    );
    single
        && source.samples == destination.samples
        && (aspect != Aspect::Color || source.format.base() == destination.format.base())
        && rects.keeps_size()
        && forward(rects.source) == forward(rects.destination)
        && forward(rects.source)
}

/// Source column of each destination column of an area, and the same for rows; `None` outside the source.
struct Nearest {
    columns: Vec<Option<usize>>,
    rows: Vec<Option<usize>>,
}

impl Nearest {
    fn new(source: &Plane, rects: &BlitRects, area: Area) -> Self {
        let [x, y] = rects.axes();
        let inside = |place: f64, size: u32| {
            let cell = place.floor();
            (cell >= 0.0 && cell < f64::from(size)).then_some(cell as usize)
        };
        Self {
            columns: (area.x0..area.x1).map(|i| inside(x.place(i), source.width)).collect(),
            rows: (area.y0..area.y1).map(|i| inside(y.place(i), source.height)).collect(),
        }
    }

    /// If the columns from one on come from columns side by side: that one, and the first of those.
    fn run(&self) -> Option<(usize, usize)> {
        let skip = self.columns.iter().position(Option::is_some)?;
        let first = self.columns[skip]?;
        let beside = (first..).zip(&self.columns[skip..]).all(|(x, column)| *column == Some(x));
        beside.then_some((skip, first))
    }

    fn at(&self, x: i32, y: i32, area: Area) -> Option<(usize, usize)> {
        Some((self.columns[(x - area.x0) as usize]?, self.rows[(y - area.y0) as usize]?))
    }
}

fn copy_rows(source: &Plane, destination: &mut Plane, nearest: &Nearest, area: Area) {
    let Some(begin) = nearest.columns.iter().position(Option::is_some) else { return };
    let count = nearest.columns.iter().flatten().count();
    let Some(from_x) = nearest.columns[begin] else { return };
    let side = source.side();
    let to_x = (area.x0 as usize + begin) * side;
    for (i, row) in nearest.rows.iter().enumerate() {
        let Some(row) = row else { continue };
        for sub in 0..side {
            let from = source.at(from_x * side, row * side + sub);
            let to = destination.at(to_x, (area.y0 as usize + i) * side + sub);
            destination.texels_mut().copy_run(to, &source.texels, from, count * side);
        }
    }
}

/// Writes colours of the pixels of an area that have one, to all their samples.
fn each_pixel(destination: &mut Plane, area: Area, color: impl Fn(i32, i32) -> Option<[f32; 4]>) {
    let side = destination.side();
    for y in area.y0..area.y1 {
        for x in area.x0..area.x1 {
            let Some(color) = color(x, y) else { continue };
            for sample in 0..side * side {
                put(destination, x as usize * side + sample % side, y as usize * side + sample / side, color);
            }
        }
    }
}

fn put(plane: &mut Plane, x: usize, y: usize, color: [f32; 4]) {
    let (at, base) = (plane.at(x, y), plane.format.base());
    let color = base.stored(color, 1.0);
    match plane.texels_mut() {
        Texels::Rgba8(colors) => colors[at] = color.map(crate::pixel::unorm8_from_f32),
        Texels::Rgba32F(colors) => colors[at] = color,
        _ => {}
    }
}

/// Colour at a place of the source, between the centres of its pixels; beyond the outermost, theirs.
fn bilinear(source: &Plane, x: f64, y: f64) -> [f32; 4] {
    let cell = |place: f64, size: u32| {
        let low = (place - 0.5).floor();
        let weight = (place - 0.5 - low) as f32;
        let clamp = |i: f64| i.clamp(0.0, f64::from(size) - 1.0) as usize;
        (clamp(low), clamp(low + 1.0), weight)
    };
    let (x0, x1, u) = cell(x, source.width);
    let (y0, y1, v) = cell(y, source.height);
    let texel = |x, y| source.texels.color(source.at(x, y));
    let [a, b, c, d] = [texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1)];
    std::array::from_fn(|i| {
        let low = a[i] + (b[i] - a[i]) * u;
        low + (c[i] + (d[i] - c[i]) * u - low) * v
    })
}

/// Colours, sample by sample if there are several on both sides, else the mean of those of the source.
fn blit_samples(source: &Plane, destination: &mut Plane, nearest: &Nearest, area: Area) {
    let side = source.side();
    if source.samples == destination.samples && side > 1 {
        for y in area.y0..area.y1 {
            for x in area.x0..area.x1 {
                let Some((from_x, from_y)) = nearest.at(x, y, area) else { continue };
                for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let color = source.texels.color(source.at(from_x * 2 + i, from_y * 2 + j));
                    put(destination, x as usize * 2 + i, y as usize * 2 + j, color);
                }
            }
        }
        return;
    }
    each_pixel(destination, area, |x, y| {
        let (from_x, from_y) = nearest.at(x, y, area)?;
        let mut sum = [0.0; 4];
        for sample in 0..side * side {
            let at = source.at(from_x * side + sample % side, from_y * side + sample / side);
            let color = source.texels.color(at);
            sum = std::array::from_fn(|i| sum[i] + color[i]);
        }
        Some(sum.map(|channel| channel / (side * side) as f32))
    });
}

/// Means of four samples of 8 bits: the fast form of the resolve.
fn resolve8(source: &Plane, from: &[[u8; 4]], destination: &mut Plane, nearest: &Nearest, area: Area) {
    let base = destination.format.base();
    let (first, stride) = (destination.at(0, area.y0 as usize), destination.stride());
    let lines = area.lines(1).len();
    let (run, to_x) = (nearest.run(), area.x0 as usize);
    let Texels::Rgba8(colors) = destination.texels_mut() else { return };
    let rows = colors[first..first + lines * stride].par_chunks_mut(stride).zip(&nearest.rows);
    rows.with_min_len(ROWS).for_each(|(to, from_y)| {
        let Some(from_y) = from_y else { return };
        let low = &from[source.at(0, 2 * from_y)..][..source.stride()];
        let high = &from[source.at(0, 2 * from_y + 1)..][..source.stride()];
        let to = &mut to[to_x..];
        if let Some((skip, x)) = run {
            let pairs = low[2 * x..].as_chunks::<2>().0.iter().zip(high[2 * x..].as_chunks::<2>().0);
            let to = &mut to[skip..nearest.columns.len()];
            // Two loops: the first one becomes vector instructions.
            for (texel, (low, high)) in to.iter_mut().zip(pairs) {
                *texel = mean([low[0], low[1], high[0], high[1]]);
            }
            if base != BaseFormat::Rgba {
                to.iter_mut().for_each(|texel| *texel = base.stored(*texel, 255));
            }
            return;
        }
        for (texel, column) in to.iter_mut().zip(&nearest.columns) {
            let Some(x) = column.map(|x| 2 * x) else { continue };
            *texel = base.stored(mean([low[x], low[x + 1], high[x], high[x + 1]]), 255);
        }
    });
}

/// The mean of four colours, rounded, two components at a time.
#[inline]
fn mean(colors: [[u8; 4]; 4]) -> [u8; 4] {
    const HALF: u32 = 0x00ff_00ff;
    let words = colors.map(u32::from_le_bytes);
    let sum = |shift: u32| words.iter().fold(0x0002_0002, |sum, word| sum + (word >> shift & HALF));
    (sum(0) >> 2 & HALF | (sum(8) >> 2 & HALF) << 8).to_le_bytes()
}

/// Depths or stencil values: sample by sample, or the first of the source to all of the destination.
fn blit_values<T: Copy + Send + Sync>(
    source: &Plane,
    destination: &mut Plane,
    nearest: &Nearest,
    area: Area,
    read: impl Fn(&Texels) -> Option<&[T]>,
    write: impl Fn(&mut Texels) -> Option<&mut [T]>,
) {
    let (from_side, to_side) = (source.side(), destination.side());
    let (first, stride) = (destination.at(0, area.y0 as usize * to_side), destination.stride());
    let lines = area.lines(1).len();
    let Some(from) = read(&source.texels) else { return };
    let Some(to) = write(destination.texels_mut()) else { return };
    let to = &mut to[first..first + lines * to_side * stride];
    let rows = to.par_chunks_mut(to_side * stride).zip(&nearest.rows);
    rows.with_min_len(ROWS).for_each(|(to, from_y)| {
        let Some(from_y) = from_y else { return };
        for (j, to) in to.chunks_exact_mut(stride).enumerate() {
            let from = &from[source.at(0, from_y * from_side + j % from_side)..][..source.stride()];
            let to = to[area.x0 as usize * to_side..].chunks_exact_mut(to_side);
            for (to, from_x) in to.zip(&nearest.columns) {
                let Some(from_x) = from_x else { continue };
                for (i, to) in to.iter_mut().enumerate() {
                    *to = from[from_x * from_side + i % from_side];
                }
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::gl;
    use crate::texture::InternalFormat;

    fn plane(token: u32, samples: u32, seed: u32) -> Plane {
        let format = InternalFormat::for_renderbuffer(token).expect("a format");
        let mut plane = Plane::new(format, 7, 5, samples).expect("small");
        let mut state = seed | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state.to_le_bytes()
        };
        match plane.texels_mut() {
            Texels::Rgba8(colors) => colors.iter_mut().for_each(|color| *color = next()),
            texels => {
                let depths = texels.depths_mut().into_iter().flatten();
                depths.for_each(|depth| *depth = f32::from(next()[0]) / 255.0);
            }
        }
        plane
    }

    proptest! {
        /// Copies of runs and fast resolves give what the blit pixel by pixel gives.
        #[test]
        fn fast_blits_equal_plain_ones(
            corner in prop::array::uniform4(-4_i32..10),
            size in prop::array::uniform2(-8_i32..9),
            kind in 0..3,
            seed: u32,
        ) {
            let [a, b, c, d] = corner;
            let [w, h] = size;
            let rects = BlitRects { source: [a, b, a + w, b + h], destination: [c, d, c + w, d + h] };
            let (token, samples, aspect) = match kind {
                0 => (gl::RGBA8, 0, Aspect::Color),
                1 => (gl::RGBA8, 4, Aspect::Color),
                _ => (gl::DEPTH_COMPONENT24, 0, Aspect::Depth),
            };
            let source = plane(token, samples, seed);
            let mut fast = plane(token, 0, !seed);
            let mut plain = fast.clone();
            let clip = Area { x0: 1, y0: 0, x1: 6, y1: 5 };
            blit(&source, &mut fast, &rects, clip, aspect, false);
            let area = rects.destination_area().intersect(clip).intersect(plain.area());
            if !area.is_empty() {
                blit_plain(&source, &mut plain, &rects, area, aspect, false);
            }
            prop_assert_eq!(fast.texels, plain.texels);
        }
    }
}
