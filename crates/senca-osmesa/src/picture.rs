//! The program's picture: a piece of its memory that what is drawn is copied to.

use rayon::prelude::*;
use senca_gl::{Colors, Context, gl};
use senca_gl_abi::current::Window;
use senca_gl_abi::memory::Out;
use std::ops::Range;

/// Names of OSMesa that are not OpenGL's.
pub(crate) mod osmesa {
    pub(crate) const BGRA: u32 = 0x1;
    pub(crate) const ARGB: u32 = 0x2;
    pub(crate) const BGR: u32 = 0x4;
    pub(crate) const RGB_565: u32 = 0x5;
}

/// From this many bytes on, rows are copied by all threads.
const PARALLEL_BYTES: usize = 1 << 20;

/// In which order the components of a pixel lie, and how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Rgba,
    Bgra,
    Argb,
    Rgb,
    Bgr,
    /// One 16-bit word: 5 bits of red on top, 6 of green, 5 of blue.
    Rgb565,
}

impl Order {
    /// The order of an OSMesa format.
    pub(crate) fn of(format: u32) -> Option<Self> {
        Some(match format {
            gl::RGBA => Self::Rgba,
            osmesa::BGRA => Self::Bgra,
            osmesa::ARGB => Self::Argb,
            gl::RGB => Self::Rgb,
            osmesa::BGR => Self::Bgr,
            osmesa::RGB_565 => Self::Rgb565,
            _ => return None,
        })
    }
}

/// How the components of a pixel are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Byte,
    Short,
    Float,
    Packed565,
}

impl Kind {
    /// The kind of an OpenGL type that goes with an order.
    pub(crate) fn of(kind: u32, order: Order) -> Option<Self> {
        Some(match (kind, order) {
            (gl::UNSIGNED_SHORT_5_6_5 | gl::UNSIGNED_SHORT | gl::UNSIGNED_BYTE, Order::Rgb565) => {
                Self::Packed565
            }
            (_, Order::Rgb565) => return None,
            (gl::UNSIGNED_BYTE, _) => Self::Byte,
            (gl::UNSIGNED_SHORT, _) => Self::Short,
            (gl::FLOAT, _) => Self::Float,
            _ => return None,
        })
    }
}

/// How a pixel is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) order: Order,
    pub(crate) kind: Kind,
}

impl Layout {
    pub(crate) fn bytes(self) -> usize {
        let components = if matches!(self.order, Order::Rgb | Order::Bgr) { 3 } else { 4 };
        match self.kind {
            Kind::Byte => components,
            Kind::Short => 2 * components,
            Kind::Float => 4 * components,
            Kind::Packed565 => 2,
        }
    }

    /// Writes a row of 8-bit colours.
    fn write_bytes(self, from: &[[u8; 4]], to: &mut [u8]) {
        match (self.kind, self.order) {
            (Kind::Byte, Order::Rgba) => to.copy_from_slice(bytemuck::cast_slice(from)),
            (Kind::Byte, Order::Bgra) => each(from, to, |[r, g, b, a]| [b, g, r, a]),
            (Kind::Byte, Order::Argb) => each(from, to, |[r, g, b, a]| [a, r, g, b]),
            (Kind::Byte, Order::Rgb | Order::Rgb565) => each(from, to, |[r, g, b, _]| [r, g, b]),
            (Kind::Byte, Order::Bgr) => each(from, to, |[r, g, b, _]| [b, g, r]),
            (Kind::Packed565, _) => each(from, to, |c| packed565(c.map(|v| f32::from(v) / 255.0))),
            (Kind::Short, _) => self.write_words(from, to, |v| (u16::from(v) * 257).to_ne_bytes()),
            (Kind::Float, _) => self.write_words(from, to, |v| (f32::from(v) / 255.0).to_ne_bytes()),
        }
    }

    /// Writes a row of floating-point colours.
    fn write_floats(self, from: &[[f32; 4]], clamp: bool, to: &mut [u8]) {
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round_ties_even() as u8;
        let short = |v: f32| ((v.clamp(0.0, 1.0) * 65535.0).round_ties_even() as u16).to_ne_bytes();
        match self.kind {
            Kind::Byte => {
                for (from, to) in from.chunks(64).zip(to.chunks_mut(64 * self.bytes())) {
                    let mut bytes = [[0; 4]; 64];
                    bytes.iter_mut().zip(from).for_each(|(b, f)| *b = f.map(byte));
                    self.write_bytes(&bytes[..from.len()], to);
                }
            }
            Kind::Packed565 => each(from, to, packed565),
            Kind::Short => self.write_words(from, to, short),
            Kind::Float if clamp => self.write_words(from, to, |v| v.clamp(0.0, 1.0).to_ne_bytes()),
            Kind::Float => self.write_words(from, to, f32::to_ne_bytes),
        }
    }

    /// Writes words of `N` bytes. Other orders than RGBA and RGB exist for bytes only: as with Mesa, which
    /// programs know, words are in the order RGBA.
    fn write_words<T: Copy, const N: usize>(
        self,
        from: &[[T; 4]],
        to: &mut [u8],
        word: impl Fn(T) -> [u8; N],
    ) {
        let components = self.bytes() / N;
        for (from, to) in from.iter().zip(to.chunks_exact_mut(self.bytes())) {
            let order = if self.order == Order::Bgr { [2, 1, 0, 3] } else { [0, 1, 2, 3] };
            for (k, to) in to.chunks_exact_mut(N).take(components).enumerate() {
                to.copy_from_slice(&word(from[order[k]]));
            }
        }
    }
}

/// Writes `N` bytes for each pixel.
fn each<T: Copy, const N: usize>(from: &[[T; 4]], to: &mut [u8], write: impl Fn([T; 4]) -> [u8; N]) {
    for (from, to) in from.iter().zip(to.as_chunks_mut::<N>().0) {
        *to = write(*from);
    }
}

fn packed565([r, g, b, _]: [f32; 4]) -> [u8; 2] {
    let level = |v: f32, top: f32| (v.clamp(0.0, 1.0) * top).round_ties_even() as u16;
    (level(r, 31.0) << 11 | level(g, 63.0) << 5 | level(b, 31.0)).to_ne_bytes()
}

/// Where the program wants its picture, and how.
#[derive(Debug)]
pub(crate) struct Picture {
    /// Format and type as the program said them.
    pub(crate) format: u32,
    pub(crate) kind: u32,
    pub(crate) layout: Layout,
    /// Address of the first byte; 0 for none yet.
    pub(crate) buffer: usize,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Pixels from one row to the next; 0 for the width.
    pub(crate) row_length: u32,
    /// Whether the first row is the lowest.
    pub(crate) y_up: bool,
    /// Whether floating-point colours are written within 0 to 1.
    pub(crate) clamp: bool,
    /// Bits of the depth buffer that were asked for.
    pub(crate) depth_bits: u32,
    /// The depth buffer as it was last asked for.
    pub(crate) depths: Vec<u32>,
    /// How the picture was last written; `None` when nothing of it is in the program's memory.
    shown: Option<Shown>,
}

/// Everything that a picture in the program's memory depends on but for the pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shown {
    layout: Layout,
    buffer: usize,
    size: [u32; 2],
    row_length: u32,
    y_up: bool,
    clamp: bool,
}

impl Picture {
    /// None yet.
    pub(crate) fn new(format: u32, order: Order, depth_bits: u32) -> Self {
        let kind = if order == Order::Rgb565 { Kind::Packed565 } else { Kind::Byte };
        Self {
            format,
            kind: gl::UNSIGNED_BYTE,
            layout: Layout { order, kind },
            buffer: 0,
            width: 0,
            height: 0,
            row_length: 0,
            y_up: true,
            clamp: false,
            depth_bits,
            depths: Vec::new(),
            shown: None,
        }
    }

    /// Says that the program's memory holds nothing of the picture yet.
    pub(crate) fn forget_shown(&mut self) {
        self.shown = None;
    }

    /// Notes that the picture is about to be written; returns the rows that must be, those that have changed
    /// unless it was written otherwise before.
    fn rows_to_show(&mut self, changed: Range<usize>) -> Range<usize> {
        let shown = Shown {
            layout: self.layout,
            buffer: self.buffer,
            size: [self.width, self.height],
            row_length: self.row_length,
            y_up: self.y_up,
            clamp: self.clamp,
        };
        let same = self.shown.replace(shown) == Some(shown);
        if same { changed } else { 0..self.height as usize }
    }

    /// Bytes from one row to the next, and bytes of a row that are written.
    fn row_bytes(&self) -> (usize, usize) {
        let pixel = self.layout.bytes();
        let stride = if self.row_length == 0 { self.width } else { self.row_length };
        (stride as usize * pixel, stride.min(self.width) as usize * pixel)
    }

    /// The depth buffer in words as programs expect it of OSMesa: 16 bits in 2 bytes when that was asked for,
    /// else 24 bits in the lower part of 4. Returns bytes of a word and the address.
    pub(crate) fn read_depths(&mut self, context: &mut Context) -> (usize, usize) {
        context.finish_window();
        let depths = context.window_depths();
        let quantized = |z: f32, top: f64| (f64::from(z.clamp(0.0, 1.0)) * top).round_ties_even() as u32;
        let bytes = if self.depth_bits <= 16 {
            let halves: Vec<u16> = depths.iter().map(|z| quantized(*z, 65535.0) as u16).collect();
            self.depths = vec![0; halves.len().div_ceil(2)];
            bytemuck::cast_slice_mut(&mut self.depths)[..halves.len()].copy_from_slice(&halves);
            2
        } else {
            self.depths = depths.iter().map(|z| quantized(*z, 16_777_215.0)).collect();
            4
        };
        (bytes, self.depths.as_mut_ptr().expose_provenance())
    }
}

impl Window for Picture {
    /// Draws what is waiting and copies what has changed of the picture to the program's memory.
    fn present(&mut self, context: &mut Context) {
        context.finish_for_show();
        if self.buffer == 0 {
            return;
        }
        let changed = self.rows_to_show(context.take_changed_rows());
        if changed.is_empty() {
            return;
        }
        let (stride, row) = self.row_bytes();
        let height = self.height as usize;
        let mut out = Out::<u8>::at(self.buffer);
        let Some(bytes) = out.bytes((height - 1) * stride + row) else { return };
        let width = self.width as usize;
        let (layout, clamp, up) = (self.layout, self.clamp, self.y_up);
        let lines = if up { changed } else { height - changed.end..height - changed.start };
        let bytes = &mut bytes[lines.start * stride..(lines.end - 1) * stride + row];
        let first = lines.start;
        let from = |k: usize| if up { k } else { height - 1 - k };
        let (mut same, pixels) = (vec![0; row], row / layout.bytes());
        match context.window_colors() {
            Colors::SameBytes(color) => layout.write_bytes(&vec![color; pixels], &mut same),
            Colors::SameFloats(color) => layout.write_floats(&vec![color; pixels], clamp, &mut same),
            Colors::Bytes(_) | Colors::Floats(_) => {}
        }
        let write = |(k, to): (usize, &mut [u8])| {
            let at = from(first + k) * width;
            let to = &mut to[..row];
            match context.window_colors() {
                Colors::Bytes(all) => layout.write_bytes(&all[at..at + pixels], to),
                Colors::Floats(all) => layout.write_floats(&all[at..at + pixels], clamp, to),
                Colors::SameBytes(_) | Colors::SameFloats(_) => to.copy_from_slice(&same),
            }
        };
        if bytes.len() < PARALLEL_BYTES {
            bytes.chunks_mut(stride).enumerate().for_each(write);
        } else {
            bytes.par_chunks_mut(stride).with_min_len(lines.len().div_ceil(8)).enumerate().for_each(write);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLOR: [u8; 4] = [255, 128, 64, 191];

    fn written(format: u32, kind: u32) -> Vec<u8> {
        let order = Order::of(format).unwrap();
        let layout = Layout { order, kind: Kind::of(kind, order).unwrap() };
        let mut bytes = vec![0; layout.bytes()];
        layout.write_bytes(&[COLOR], &mut bytes);
        let mut same = vec![0; layout.bytes()];
        layout.write_floats(&[COLOR.map(|v| f32::from(v) / 255.0)], false, &mut same);
        assert_eq!(bytes, same);
        bytes
    }

    #[test]
    fn bytes_in_all_orders() {
        assert_eq!(written(gl::RGBA, gl::UNSIGNED_BYTE), [255, 128, 64, 191]);
        assert_eq!(written(osmesa::BGRA, gl::UNSIGNED_BYTE), [64, 128, 255, 191]);
        assert_eq!(written(osmesa::ARGB, gl::UNSIGNED_BYTE), [191, 255, 128, 64]);
        assert_eq!(written(gl::RGB, gl::UNSIGNED_BYTE), [255, 128, 64]);
        assert_eq!(written(osmesa::BGR, gl::UNSIGNED_BYTE), [64, 128, 255]);
    }

    #[test]
    fn words_are_wider_bytes() {
        let shorts = [255u16 * 257, 128 * 257, 64 * 257, 191 * 257];
        assert_eq!(written(gl::RGBA, gl::UNSIGNED_SHORT), bytemuck::cast_slice::<u16, u8>(&shorts));
        assert_eq!(written(osmesa::BGRA, gl::UNSIGNED_SHORT).len(), 8);
        assert_eq!(written(gl::RGB, gl::FLOAT)[..4], 1.0f32.to_ne_bytes());
        assert_eq!(
            written(osmesa::RGB_565, gl::UNSIGNED_SHORT_5_6_5),
            (31u16 << 11 | 32 << 5 | 8).to_ne_bytes()
        );
    }
}
