//! Where the pixels of an image lie in client memory.

use super::PixelLayout;
use crate::error::Error;
use crate::gl;

/// How images lie in client memory: one set for reading it (unpack), one for writing it (pack).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelStore {
    /// Turn the bytes of words of 2 and 4 bytes round. Default false.
    pub swap_bytes: bool,
    /// The first pixel of a bitmap is the lowest bit of a byte, not the highest. Default false.
    pub lsb_first: bool,
    /// Pixels from one row to the next; 0 for the width of the image. Default 0.
    pub row_length: u32,
    /// Rows from one image of a volume to the next; 0 for its height. Default 0.
    pub image_height: u32,
    /// Pixels left out at the begin of each row. Default 0.
    pub skip_pixels: u32,
    /// Rows left out at the begin. Default 0.
    pub skip_rows: u32,
    /// Images left out at the begin of a volume. Default 0.
    pub skip_images: u32,
    /// Rows begin at multiples of this many bytes: 1, 2, 4 or 8. Default 4.
    pub alignment: u32,
}

impl Default for PixelStore {
    fn default() -> Self {
        Self { alignment: 4, ..Self::TIGHT }
    }
}

/// Bytes of a run of `bits`, `None` if there are too many.
fn bytes_of(pixels: usize, bits: usize) -> Option<usize> {
    Some(pixels.checked_mul(bits)?.div_ceil(8))
}

impl PixelStore {
    /// Rows one right after the other: what display lists and the tests of this crate use.
    pub const TIGHT: Self = Self {
        swap_bytes: false,
        lsb_first: false,
        row_length: 0,
        image_height: 0,
        skip_pixels: 0,
        skip_rows: 0,
        skip_images: 0,
        alignment: 1,
    };

    /// Sets a parameter by its token, either of the `UNPACK_` or of the `PACK_` family.
    ///
    /// # Errors
    /// [`Error::InvalidEnum`] for a token of neither family; [`Error::InvalidValue`] for a negative value or an
    /// alignment other than 1, 2, 4 and 8.
    pub fn set(&mut self, pname: u32, value: i32) -> Result<(), Error> {
        let number = || u32::try_from(value).map_err(|_| Error::InvalidValue);
        match pname {
            gl::UNPACK_SWAP_BYTES | gl::PACK_SWAP_BYTES => self.swap_bytes = value != 0,
            gl::UNPACK_LSB_FIRST | gl::PACK_LSB_FIRST => self.lsb_first = value != 0,
            gl::UNPACK_ROW_LENGTH | gl::PACK_ROW_LENGTH => self.row_length = number()?,
            gl::UNPACK_IMAGE_HEIGHT | gl::PACK_IMAGE_HEIGHT => self.image_height = number()?,
            gl::UNPACK_SKIP_PIXELS | gl::PACK_SKIP_PIXELS => self.skip_pixels = number()?,
            gl::UNPACK_SKIP_ROWS | gl::PACK_SKIP_ROWS => self.skip_rows = number()?,
            gl::UNPACK_SKIP_IMAGES | gl::PACK_SKIP_IMAGES => self.skip_images = number()?,
            gl::UNPACK_ALIGNMENT | gl::PACK_ALIGNMENT => match value {
                1 | 2 | 4 | 8 => self.alignment = number()?,
                _ => return Err(Error::InvalidValue),
            },
            _ => return Err(Error::InvalidEnum),
        }
        Ok(())
    }

    /// Value of a parameter by its token, of either family; `None` for another token.
    #[must_use]
    pub fn get(&self, pname: u32) -> Option<u32> {
        Some(match pname {
            gl::UNPACK_SWAP_BYTES | gl::PACK_SWAP_BYTES => u32::from(self.swap_bytes),
            gl::UNPACK_LSB_FIRST | gl::PACK_LSB_FIRST => u32::from(self.lsb_first),
            gl::UNPACK_ROW_LENGTH | gl::PACK_ROW_LENGTH => self.row_length,
            gl::UNPACK_IMAGE_HEIGHT | gl::PACK_IMAGE_HEIGHT => self.image_height,
            gl::UNPACK_SKIP_PIXELS | gl::PACK_SKIP_PIXELS => self.skip_pixels,
            gl::UNPACK_SKIP_ROWS | gl::PACK_SKIP_ROWS => self.skip_rows,
            gl::UNPACK_SKIP_IMAGES | gl::PACK_SKIP_IMAGES => self.skip_images,
            gl::UNPACK_ALIGNMENT | gl::PACK_ALIGNMENT => self.alignment,
            _ => return None,
        })
    }

    /// Where the rows of an image of `size` (width, height, depth) lie. `volume` says that the command is one for
    /// three dimensions: only then images are skipped and the image height counts.
    ///
    /// Returns `None` if the address of a byte would not fit a `usize`.
    #[must_use]
    pub fn span(&self, layout: PixelLayout, size: [u32; 3], volume: bool) -> Option<ImageSpan> {
        let [width, height, depth] = size.map(|side| side as usize);
        let bits = layout.pixel_bits();
        let pick = |chosen: u32, own: usize| if chosen == 0 { own } else { chosen as usize };

        // Rows are padded to the alignment; elements of that size or more fill it anyway.
        let row_pixels = pick(self.row_length, width);
        let row_stride = bytes_of(row_pixels, bits)?.checked_next_multiple_of(self.alignment as usize)?;
        let image_rows = if volume { pick(self.image_height, height) } else { height };
        let image_stride = image_rows.checked_mul(row_stride)?;

        // A bitmap may begin inside a byte.
        let skip_bits = (self.skip_pixels as usize).checked_mul(bits)?;
        let first_bit = skip_bits % 8;
        let row_bytes = width.checked_mul(bits)?.checked_add(first_bit)?.div_ceil(8);
        let skip_images = if volume { self.skip_images as usize } else { 0 };
        let offset = (skip_bits / 8)
            .checked_add((self.skip_rows as usize).checked_mul(row_stride)?)?
            .checked_add(skip_images.checked_mul(image_stride)?)?;

        let mut span = ImageSpan { offset, row_stride, image_stride, row_bytes, first_bit, bytes: 0 };
        if width > 0 && height > 0 && depth > 0 {
            let last_row = (height - 1).checked_mul(row_stride)?;
            let last_image = (depth - 1).checked_mul(image_stride)?;
            let end = offset.checked_add(last_image)?.checked_add(last_row)?.checked_add(row_bytes)?;
            span.bytes = isize::try_from(end).ok()? as usize;
        }
        Some(span)
    }
}

/// Where the rows of an image lie in client memory; all in bytes from the pointer the client gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSpan {
    /// First byte that belongs to the image.
    pub offset: usize,
    /// From one row to the next.
    pub row_stride: usize,
    /// From one image of a volume to the next.
    pub image_stride: usize,
    /// Bytes of a row that belong to the image.
    pub row_bytes: usize,
    /// Bit of the first byte where the first pixel of a bitmap lies, counted from the end its pixels begin at.
    pub first_bit: usize,
    /// One behind the last byte of the image; 0 for an image without pixels.
    pub bytes: usize,
}

impl ImageSpan {
    /// First byte of a row.
    #[must_use]
    pub fn row_offset(&self, z: usize, y: usize) -> usize {
        self.offset + z * self.image_stride + y * self.row_stride
    }
}

/// Bytes of client memory that a command on an image of `size` (width, height, depth) reads or writes, counted
/// from the pointer it is given. `volume` as for [`PixelStore::span`].
///
/// Returns `None` if that many bytes do not exist.
///
/// # Errors
/// As [`PixelLayout::new`]: no memory is touched then.
pub fn image_bytes(
    store: &PixelStore,
    size: [u32; 3],
    volume: bool,
    format: u32,
    ty: u32,
) -> Result<Option<usize>, Error> {
    let layout = PixelLayout::new(format, ty)?;
    Ok(store.span(layout, size, volume).map(|span| span.bytes))
}
