//! Textured polygons: linear in texture space, exact at every pixel, or exact every N pixels and linear between.
//!
//! A polygon in space is `P = O + u U + v V`, and a pixel sees it along `(i, j, 1)`. Solved for `u` and `v` each is a
//! quotient of two expressions that are linear in the pixel, with nine coefficients for a polygon. `i` and `j` are pixels from
//! the middle of the screen divided by the focus, a power of two. (The text's intermediate `y = i z` must be `y = j z`.)
//!
//! Source: Savchenko 1995, "Textured polygons".

use super::borders::{BORDER_BITS, Borders};
use super::clip::Search;
use super::color_map::ColorMap;
use super::fixed::saturate;
use super::project::Lens;
use super::scene::LightTable;

/// Fraction bits of places in a texture that corners and anchors carry: 1/256 of a texel. (In the text, whole texels.)
pub const CORNER_BITS: u32 = 8;

/// Fraction bits of the place in the texture that a pixel gets.
pub const TEXEL_BITS: u32 = 16;

/// Pixels are taken to lie within this of the middle of the screen.
const FARTHEST: i32 = 1 << 20;

/// A square picture of colours whose side is a power of two, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    log_size: u32,
    texels: Vec<u8>,
}

impl Texture {
    /// A texture of `2^log_size` texels a side, at most 4096, from the colour at each column and row.
    #[must_use]
    pub fn from_fn(log_size: u32, color: impl Fn(usize, usize) -> u8) -> Self {
        let log_size = log_size.min(12);
        let size = 1usize << log_size;
        let texels = (0..size * size).map(|i| color(i % size, i / size)).collect();
        Self { log_size, texels }
    }

    /// The logarithm of its side.
    #[must_use]
    pub fn log_size(&self) -> u32 {
        self.log_size
    }

    /// The colour at a place with [`TEXEL_BITS`] fraction bits. Outside it repeats, by keeping the low bits, which is
    /// right for negative places as well.
    #[must_use]
    pub fn color(&self, [u, v]: [i64; 2]) -> u8 {
        let mask = (1 << self.log_size) - 1;
        let [u, v] = [u, v].map(|t| ((t >> TEXEL_BITS) & mask) as usize);
        self.texels[(v << self.log_size) + u]
    }

    /// This texture with each colour replaced.
    #[must_use]
    pub fn map(&self, color: impl Fn(u8) -> u8) -> Self {
        Self { log_size: self.log_size, texels: self.texels.iter().map(|&t| color(t)).collect() }
    }
}

/// Where a texture lies in the space of the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexturePlane {
    /// A point whose place in the texture is known; any corner that is left will do.
    pub origin: [i32; 3],
    /// Its place in the texture, with [`CORNER_BITS`] fraction bits.
    pub anchor: [i32; 2],
    /// The vector along which u grows by `2^log_scale` texels.
    pub u: [i32; 3],
    /// The vector along which v does. It need not be at a right angle to the other one.
    pub v: [i32; 3],
    /// Logarithm of the texels along each vector: that of the texture's side shows it once, one more twice. At most 15.
    pub log_scale: u32,
}

/// Numbers that the mapping calculates with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureArithmetic {
    /// Fraction bits of the quotient, at most 16 (`G_P`).
    pub fraction_bits: u32,
    /// Plain C in 32 bits, which wraps around; otherwise wide enough for all.
    pub is_32_bit: bool,
}

impl Default for TextureArithmetic {
    /// 16 fraction bits and no overflow.
    fn default() -> Self {
        Self { fraction_bits: TEXEL_BITS, is_32_bit: false }
    }
}

/// The nine coefficients of a polygon, for pixels from the middle of the screen and the focus.
#[derive(Clone, Copy, Debug)]
pub struct TextureMapping {
    u: [i128; 3],
    v: [i128; 3],
    divisor: [i128; 3],
    anchor: [i32; 2],
    log_scale: u32,
    lens: Lens,
    arithmetic: TextureArithmetic,
}

fn cross(a: [i32; 3], b: [i32; 3]) -> [i128; 3] {
    let [a, b] = [a, b].map(|v| v.map(i128::from));
    let element = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [element(1, 2), element(2, 0), element(0, 1)]
}

impl TextureMapping {
    /// The coefficients for a plane seen through a lens.
    #[must_use]
    pub fn new(plane: &TexturePlane, lens: Lens, arithmetic: TextureArithmetic) -> Self {
        let fraction_bits = arithmetic.fraction_bits.min(TEXEL_BITS);
        Self {
            u: cross(plane.origin, plane.v),
            v: cross(plane.u, plane.origin),
            divisor: cross(plane.v, plane.u),
            anchor: plane.anchor,
            log_scale: plane.log_scale.min(15),
            lens,
            arithmetic: TextureArithmetic { fraction_bits, ..arithmetic },
        }
    }

    /// The place in the texture that a pixel sees, with [`TEXEL_BITS`] fraction bits; `None` where the divisor is 0.
    #[must_use]
    pub fn at(&self, column: i32, row: i32) -> Option<[i64; 2]> {
        let near = |from: i32, to: i32| to.saturating_sub(from).clamp(-FARTHEST, FARTHEST);
        let (x, y) = (near(self.lens.center[0], column), near(row, self.lens.center[1]));
        let shift = self.log_scale + self.arithmetic.fraction_bits;
        let quotients = if self.arithmetic.is_32_bit {
            self.in_32_bits(x, y, shift)
        } else {
            self.without_overflow(x, y, shift)
        };
        let finer = TEXEL_BITS - self.arithmetic.fraction_bits;
        let anchor = self.anchor.map(|a| i64::from(a) << (TEXEL_BITS - CORNER_BITS));
        quotients.map(|[u, v]| [(u << finer) + anchor[0], (v << finer) + anchor[1]])
    }

    fn without_overflow(&self, x: i32, y: i32, shift: u32) -> Option<[i64; 2]> {
        let (x, y, focus) = (i128::from(x), i128::from(y), i128::from(self.lens.focus()));
        let sum = |c: [i128; 3]| x * c[0] + y * c[1] + focus * c[2];
        let divisor = sum(self.divisor);
        // Places so far off say nothing any more; cut, differences of them fit.
        let cut = |q: i128| q.clamp(-(1 << 44), 1 << 44) as i64;
        (divisor != 0).then(|| [self.u, self.v].map(|c| cut((sum(c) << shift) / divisor)))
    }

    /// As plain C has it: the terms of the pixel are divided by the focus, by a shift, before they are added.
    fn in_32_bits(&self, x: i32, y: i32, shift: u32) -> Option<[i64; 2]> {
        let log_focus = self.lens.log_focus.min(16);
        let sum = |c: [i128; 3]| {
            let [i, j, one] = c.map(|c| c as i32);
            let of_row = (y.wrapping_mul(j) >> log_focus).wrapping_add(one);
            (x.wrapping_mul(i) >> log_focus).wrapping_add(of_row)
        };
        let divisor = sum(self.divisor);
        let quotient = |c| i64::from(sum(c).wrapping_shl(shift).wrapping_div(divisor));
        (divisor != 0).then(|| [quotient(self.u), quotient(self.v)])
    }
}

/// How a texture is laid on the pixels of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// Linear along the edges and along each row: wrong wherever depth differs.
    Affine,
    /// Exact every so many pixels of a row, linear between (`G_LINEAR`); at least 1, which is exact at every pixel.
    Subdivided(u32),
    /// [`Mapping::Subdivided`] as it is printed: the last column of each row is left out.
    SubdividedAsPrinted(u32),
}

/// A textured polygon: its corners on the screen, each x, y, u, v with [`CORNER_BITS`] fraction bits in the last two, and
/// where the texture lies.
#[derive(Clone, Copy, Debug)]
pub struct TexturedPolygon<'a> {
    /// Corners; the last is joined to the first.
    pub corners: &'a [[i32; 4]],
    /// For all but [`Mapping::Affine`].
    pub plane: TextureMapping,
}

/// Calls `visit` with column, row and place in the texture of each pixel of a polygon. Places have [`TEXEL_BITS`]
/// fraction bits.
pub fn for_each_textured_pixel(
    polygon: &TexturedPolygon<'_>,
    size: [usize; 2],
    mapping: Mapping,
    search: Search,
    mut visit: impl FnMut(i32, i32, [i64; 2]),
) {
    let (extras, every) = match mapping {
        Mapping::Affine => (2, 1),
        Mapping::Subdivided(n) | Mapping::SubdividedAsPrinted(n) => (0, saturate(i64::from(n.max(1)))),
    };
    let is_printed = matches!(mapping, Mapping::SubdividedAsPrinted(_));
    let borders = Borders::of_polygon(polygon.corners, size, extras, search);
    for span in borders.spans() {
        let y = span.y;
        if mapping == Mapping::Affine {
            let ends =
                [span.rest_start, span.rest_end].map(|rest| [rest[0] >> CORNER_BITS, rest[1] >> CORNER_BITS]);
            let run = Run { from: span.start, to: span.end, places: ends };
            run.visit(|x, place| visit(x, y, place));
            visit(span.end, y, ends[1]);
        } else {
            // Where nothing is known yet: the anchor's place. The text uses what was there by chance.
            let mut place = polygon.plane.at(span.start, y).unwrap_or([0; 2]);
            let mut from = span.start;
            while from < span.end {
                let to = span.end.min(from.saturating_add(every));
                let next = polygon.plane.at(to, y).unwrap_or(place);
                Run { from, to, places: [place, next] }.visit(|x, place| visit(x, y, place));
                (from, place) = (to, next);
            }
            if !is_printed {
                visit(span.end, y, place);
            }
        }
    }
}

/// Pixels from `from` to just before `to`.
struct Run {
    from: i32,
    to: i32,
    places: [[i64; 2]; 2],
}

impl Run {
    fn visit(&self, mut visit: impl FnMut(i32, [i64; 2])) {
        let [mut place, end] = self.places;
        let length = i64::from(self.to - self.from).max(1);
        let increment = [0, 1].map(|k| (end[k] - place[k]) / length);
        for x in self.from..self.to {
            visit(x, place);
            place = [place[0] + increment[0], place[1] + increment[1]];
        }
    }
}

/// Fills a polygon with a texture (`G_textured_polygon`).
pub fn fill_textured(
    map: &mut ColorMap,
    polygon: &TexturedPolygon<'_>,
    texture: &Texture,
    mapping: Mapping,
    search: Search,
) {
    let size = map.size();
    for_each_textured_pixel(polygon, size, mapping, search, |x, y, place| {
        map.dot(x, y, texture.color(place))
    });
}

/// Fills a polygon with a texture under light, which is interpolated from corner to corner as intensities are: the
/// text's extension to both at once. `lights` has the light of each corner of the polygon; missing ones are darkness.
pub fn fill_lit(
    map: &mut ColorMap,
    polygon: &TexturedPolygon<'_>,
    lights: &[i32],
    (texture, table): (&Texture, &LightTable),
    mapping: Mapping,
    search: Search,
) {
    let size = map.size();
    let light_of = |k: usize| lights.get(k).copied().unwrap_or(0);
    let corners: Vec<_> =
        polygon.corners.iter().enumerate().map(|(k, c)| [c[0], c[1], light_of(k)]).collect();
    let borders = Borders::of_polygon(&corners, size, 1, search);
    // Light at the start of each row, and by how much it grows from pixel to pixel.
    let mut rows = vec![(0, 0, 0); size[1]];
    for span in borders.spans() {
        let pixels = i64::from(span.end) - i64::from(span.start) + 1;
        let increment = (span.rest_end[0] - span.rest_start[0]) / pixels.max(1);
        rows[span.y as usize] = (span.start, span.rest_start[0], increment);
    }
    for_each_textured_pixel(polygon, size, mapping, search, |x, y, place| {
        let (start, first, increment) = rows[y as usize];
        let light = first + increment * i64::from(x - start);
        map.dot(x, y, table.color(texture.color(place), light >> BORDER_BITS));
    });
}

#[cfg(test)]
#[path = "texture_tests.rs"]
mod tests;
