//! What was drawn, as the server takes it.

use crate::server::{Connection, Server, VisualKind};
use rayon::prelude::*;
use std::ffi::{c_char, c_uint};
use x11_dl::xlib::{GC, Visual, XImage, ZPixmap};
use x11_dl::xshm::XShmSegmentInfo;

/// From this many pixels on, rows are converted by all threads.
const PARALLEL_PIXELS: usize = 1 << 18;

/// How colours are written into pixels of the server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Format {
    masks: [u32; 3],
    /// Bits beside the colours, which hold alpha where there are 32.
    alpha: bool,
    /// Bytes of a pixel: 2, 3 or 4.
    bytes: usize,
}

impl Format {
    /// The pixel of a colour.
    #[inline]
    fn pixel(self, [r, g, b, a]: [u8; 4]) -> u32 {
        let part = |value: u8, mask: u32| {
            let bits = mask.count_ones();
            let scaled = (u32::from(value) * ((1 << bits) - 1) + 127) / 255;
            scaled.checked_shl(mask.trailing_zeros()).unwrap_or(0) & mask
        };
        let color = part(r, self.masks[0]) | part(g, self.masks[1]) | part(b, self.masks[2]);
        if self.alpha { color | u32::from(a) << 24 } else { color }
    }

    /// Writes a row.
    fn write(self, from: &[[u8; 4]], to: &mut [u8]) {
        match (self.bytes, self.masks, self.alpha) {
            (4, [0xff_0000, 0xff00, 0xff], false) => each(from, to, |[r, g, b, _]| {
                (u32::from(r) << 16 | u32::from(g) << 8 | u32::from(b)).to_ne_bytes()
            }),
            (4, ..) => each(from, to, |c| self.pixel(c).to_ne_bytes()),
            (2, ..) => each(from, to, |c| (self.pixel(c) as u16).to_ne_bytes()),
            _ => each(from, to, |c| {
                let [a, b, c, _] = self.pixel(c).to_le_bytes();
                [a, b, c]
            }),
        }
    }
}

/// Writes `N` bytes for each pixel.
fn each<const N: usize>(from: &[[u8; 4]], to: &mut [u8], write: impl Fn([u8; 4]) -> [u8; N]) {
    for (from, to) in from.iter().zip(to.as_chunks_mut::<N>().0) {
        *to = write(*from);
    }
}

/// A picture in memory that the server reads, or that is sent to it.
pub(crate) struct Image {
    image: *mut XImage,
    memory: Memory,
    format: Format,
    width: usize,
    height: usize,
}

// SAFETY: the image is used by whoever has it, one at a time.
unsafe impl Send for Image {}

enum Memory {
    Own(Vec<u8>),
    /// Shared with the server. The record is where Xlib can find it again.
    Shared(Box<XShmSegmentInfo>, usize),
}

impl Memory {
    fn bytes(&mut self) -> &mut [u8] {
        match self {
            Self::Own(bytes) => bytes,
            // SAFETY: a piece of memory of that many bytes, attached until this is dropped; the server only
            // reads it, and only while it is waited for.
            Self::Shared(segment, len) => unsafe {
                std::slice::from_raw_parts_mut(segment.shmaddr.cast(), *len)
            },
        }
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        if let Self::Shared(segment, _) = self {
            // SAFETY: attached by `shared`, and not used any more. The server lets go of its side when it is told
            // to, or the program ends.
            unsafe { libc::shmdt(segment.shmaddr.cast_const().cast()) };
        }
    }
}

impl Image {
    /// A picture for a drawable of a depth; `None` when there is no memory, or pixels are of no kind that is
    /// known.
    pub(crate) fn new(
        x: &Server,
        connection: Connection,
        visual: &VisualKind,
        depth: u32,
        [width, height]: [u32; 2],
    ) -> Option<Self> {
        Self::shared(x, connection, visual, depth, [width, height])
            .or_else(|| Self::own(x, connection, visual, depth, [width, height]))
    }

    /// One whose memory the server shares; `None` where it does not, as when it runs on another machine.
    fn shared(
        x: &Server,
        connection: Connection,
        visual: &VisualKind,
        depth: u32,
        [width, height]: [u32; 2],
    ) -> Option<Self> {
        let ext = x.ext.as_ref()?;
        let mut segment =
            Box::new(XShmSegmentInfo { shmseg: 0, shmid: -1, shmaddr: std::ptr::null_mut(), readOnly: 1 });
        // SAFETY: a connection of the program's, one of its visuals, and a record that stays where it is.
        let image = unsafe {
            if (ext.XShmQueryExtension)(connection.display()) == 0 {
                return None;
            }
            (ext.XShmCreateImage)(
                connection.display(),
                visual_of(visual),
                depth,
                ZPixmap,
                std::ptr::null_mut(),
                &mut *segment,
                width,
                height,
            )
        };
        let destroy = || {
            // SAFETY: made above and not used any more; its memory is not Xlib's.
            unsafe { free(x, image) };
        };
        // SAFETY: an image that was made, or NULL.
        let shape = unsafe { image.as_ref() }.map(|i| (i.bytes_per_line, i.height));
        let len = shape.map_or(0, |(line, rows)| line as usize * rows as usize);
        // SAFETY: new memory that only the user may use; it is attached here and at the server, and goes when
        // both have let go of it.
        unsafe {
            let id =
                if len == 0 { -1 } else { libc::shmget(libc::IPC_PRIVATE, len, libc::IPC_CREAT | 0o600) };
            if id < 0 {
                destroy();
                return None;
            }
            segment.shmid = id;
            segment.shmaddr = libc::shmat(id, std::ptr::null(), 0).cast();
            let mapped = segment.shmaddr.addr() != usize::MAX;
            let attached = mapped
                && connection
                    .trapped(x, || (ext.XShmAttach)(connection.display(), &mut *segment))
                    .is_some_and(|done| done != 0);
            libc::shmctl(id, libc::IPC_RMID, std::ptr::null_mut());
            if !attached {
                if mapped {
                    libc::shmdt(segment.shmaddr.cast_const().cast());
                }
                destroy();
                return None;
            }
            (*image).data = segment.shmaddr;
        }
        Self::with(x, image, Memory::Shared(segment, len), visual, depth, [width, height])
    }

    /// One that is sent to the server.
    fn own(
        x: &Server,
        connection: Connection,
        visual: &VisualKind,
        depth: u32,
        [width, height]: [u32; 2],
    ) -> Option<Self> {
        // SAFETY: a connection of the program's and one of its visuals; the memory comes later.
        let image = unsafe {
            (x.xlib.XCreateImage)(
                connection.display(),
                visual_of(visual),
                depth,
                ZPixmap,
                0,
                std::ptr::null_mut(),
                width,
                height,
                32,
                0,
            )
        };
        // SAFETY: an image that was made, or NULL.
        let image_record = unsafe { image.as_mut() }?;
        let mut bytes = vec![0; image_record.bytes_per_line as usize * image_record.height as usize];
        image_record.data = bytes.as_mut_ptr().cast::<c_char>();
        // Xlib turns the bytes of a word around for servers that want it so.
        image_record.byte_order = i32::from(cfg!(target_endian = "big"));
        Self::with(x, image, Memory::Own(bytes), visual, depth, [width, height])
    }

    fn with(
        x: &Server,
        image: *mut XImage,
        memory: Memory,
        visual: &VisualKind,
        depth: u32,
        [width, height]: [u32; 2],
    ) -> Option<Self> {
        // SAFETY: an image that was made.
        let bits = unsafe { (*image).bits_per_pixel };
        let format = Format { masks: visual.masks, alpha: depth == 32, bytes: bits as usize / 8 };
        if !matches!(bits, 16 | 24 | 32) {
            // SAFETY: made before and not used any more.
            unsafe { free(x, image) };
            return None;
        }
        Some(Self { image, memory, format, width: width as usize, height: height as usize })
    }

    /// Whether it has the size of a drawable.
    pub(crate) fn is(&self, [width, height]: [u32; 2]) -> bool {
        (self.width, self.height) == (width as usize, height as usize)
    }

    /// Fills it with colours, the lowest row first, as many as it has pixels.
    pub(crate) fn fill(&mut self, colors: &[[u8; 4]]) {
        // SAFETY: the image lives as long as this.
        let stride = unsafe { (*self.image).bytes_per_line } as usize;
        let (format, width, height) = (self.format, self.width, self.height);
        if colors.len() < width * height || width == 0 {
            return;
        }
        let write = |(row, to): (usize, &mut [u8])| {
            let at = (height - 1 - row) * width;
            format.write(&colors[at..at + width], to);
        };
        let bytes = self.memory.bytes();
        if width * height < PARALLEL_PIXELS {
            bytes.chunks_mut(stride).take(height).enumerate().for_each(write);
        } else {
            let rows = height.div_ceil(8);
            bytes.par_chunks_mut(stride).take(height).with_min_len(rows).enumerate().for_each(write);
        }
    }

    /// Asks the server to show it in a drawable, within a trap.
    pub(crate) fn put(&self, x: &Server, connection: Connection, drawable: u64, gc: GC) {
        let (display, width, height) = (connection.display(), self.width as c_uint, self.height as c_uint);
        // SAFETY: a connection of the program's, and an image whose memory is there until the trap has ended.
        unsafe {
            match (&self.memory, &x.ext) {
                (Memory::Shared(..), Some(ext)) => {
                    (ext.XShmPutImage)(display, drawable, gc, self.image, 0, 0, 0, 0, width, height, 0)
                }
                _ => (x.xlib.XPutImage)(display, drawable, gc, self.image, 0, 0, 0, 0, width, height),
            };
        }
    }

    /// Tells the server to let go of the memory, too.
    pub(crate) fn detach(mut self, x: &Server, connection: Connection) {
        if let (Memory::Shared(segment, _), Some(ext)) = (&mut self.memory, &x.ext) {
            // SAFETY: attached with the same record.
            connection.trapped(x, || unsafe { (ext.XShmDetach)(connection.display(), &mut **segment) });
        }
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        if let Some(x) = crate::server::server() {
            // SAFETY: made by Xlib and not used any more; its memory is not Xlib's.
            unsafe { free(x, self.image) };
        }
    }
}

/// Frees an image, but not its memory.
///
/// # Safety
/// An image made by Xlib, or NULL, that nobody uses any more.
unsafe fn free(x: &Server, image: *mut XImage) {
    if !image.is_null() {
        // SAFETY: as asked for.
        unsafe {
            (*image).data = std::ptr::null_mut();
            (x.xlib.XFree)(image.cast());
        }
    }
}

fn visual_of(visual: &VisualKind) -> *mut Visual {
    std::ptr::with_exposed_provenance_mut(visual.visual)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLOR: [u8; 4] = [255, 128, 0, 51];

    #[test]
    fn pixels_of_all_kinds() {
        let wide = [0xff_0000, 0xff00, 0xff];
        let row = |masks, alpha, bytes| {
            let mut row = vec![0; bytes];
            Format { masks, alpha, bytes }.write(&[COLOR], &mut row);
            row
        };
        assert_eq!(row(wide, false, 4), 0xff_8000u32.to_ne_bytes());
        assert_eq!(row(wide, true, 4), 0x33ff_8000u32.to_ne_bytes());
        assert_eq!(row([0xff, 0xff00, 0xff_0000], false, 4), 0x80ffu32.to_ne_bytes());
        assert_eq!(row(wide, false, 3), [0, 0x80, 0xff]);
        assert_eq!(row([0xf800, 0x7e0, 0x1f], false, 2), (0xf800u16 | 32 << 5).to_ne_bytes());
    }
}
