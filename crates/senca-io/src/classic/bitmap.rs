//! Bitmaps of colour indices.

use crate::{Location, ReadError};

/// A picture of colour indices as the 1991 program writes it: width, height, then the indices column
/// by column, all machine integers with the lowest byte first. The file has no mark of its own and
/// does not say how wide its integers are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexBitmap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Index of pixel `(x, y)` at `x * height + y`; y counts from the top.
    pub indices: Vec<u32>,
}

/// Width of the integers in a bitmap file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntegerWidth {
    /// 16 bits, as on a PC of the time.
    Bits16,
    /// 32 bits, as on a VAX.
    Bits32,
}

impl IntegerWidth {
    fn bytes(self) -> usize {
        match self {
            Self::Bits16 => 2,
            Self::Bits32 => 4,
        }
    }
}

impl IndexBitmap {
    /// Reads a bitmap file. The width of its integers is the one with which its length is right; the
    /// width found is given too.
    ///
    /// # Errors
    /// When the length fits neither width.
    pub fn read(name: &str, bytes: &[u8]) -> Result<(Self, IntegerWidth), ReadError> {
        for width in [IntegerWidth::Bits32, IntegerWidth::Bits16] {
            if let Some(bitmap) = Self::read_as(bytes, width) {
                return Ok((bitmap, width));
            }
        }
        let message = format!(
            "is no bitmap of colour indices: its {} bytes fit neither its size in 16-bit integers nor in 32-bit ones",
            bytes.len()
        );
        Err(ReadError::malformed(Location::byte(name, 0), message))
    }

    fn read_as(bytes: &[u8], width: IntegerWidth) -> Option<Self> {
        let size = width.bytes();
        let number = |raw: &[u8]| raw.iter().rev().fold(0u32, |n, &byte| n << 8 | u32::from(byte));
        let mut numbers = bytes.chunks_exact(size).map(number);
        let (w, h) = (numbers.next()?, numbers.next()?);
        let expected = u64::from(w).checked_mul(u64::from(h))?.checked_add(2)?.checked_mul(size as u64)?;
        if w == 0 || h == 0 || expected != bytes.len() as u64 {
            return None;
        }
        Some(Self { width: w, height: h, indices: numbers.collect() })
    }

    /// Writes a bitmap file with integers of `width`; indices that do not fit lose their high bits.
    #[must_use]
    pub fn write(&self, width: IntegerWidth) -> Vec<u8> {
        let size = width.bytes();
        let mut bytes = Vec::with_capacity(size * (2 + self.indices.len()));
        for number in [self.width, self.height].iter().chain(&self.indices) {
            bytes.extend(&number.to_le_bytes()[..size]);
        }
        bytes
    }

    /// Index of pixel `(x, y)`, y from the top; `None` outside.
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> Option<u32> {
        let inside = x < self.width && y < self.height;
        let place = x as usize * self.height as usize + y as usize;
        self.indices.get(place).copied().filter(|_| inside)
    }
}
