//! How long a picture takes to a terminal, and how much packing would save (1991 thesis, section 1).

use senca_io::classic::IndexBitmap;

/// Seconds for a picture over a serial line of `bits_per_second`: each byte has a start bit, eight
/// bits of data, a parity bit and a stop bit. `planes` is the number of bits per pixel.
#[must_use]
pub fn transfer_seconds(width: u32, height: u32, planes: u32, bits_per_second: f64) -> f64 {
    const BITS_PER_BYTE: f64 = 1.0 + 8.0 + 1.0 + 1.0;
    let bytes = f64::from(width) * f64::from(height) * f64::from(planes) / 8.0;
    bytes * BITS_PER_BYTE / bits_per_second
}

/// Bytes of the picture's indices after the run-length packing of TIFF (`PackBits`), column by column
/// with a byte per index; indices above 255 lose their high bits.
#[must_use]
pub fn packed_size(bitmap: &IndexBitmap) -> usize {
    let column = (bitmap.height as usize).max(1);
    bitmap.indices.chunks(column).map(packed_column).sum()
}

/// Runs of two or more become two bytes for up to 128 pixels; what stands between them is copied with
/// one byte in front of up to 128.
fn packed_column(column: &[u32]) -> usize {
    const LONGEST: usize = 128;
    let (mut bytes, mut copied) = (0, 0);
    let flush = |copied: &mut usize| {
        let size = *copied + copied.div_ceil(LONGEST);
        *copied = 0;
        size
    };
    for run in column.chunk_by(|a, b| a & 0xff == b & 0xff) {
        if run.len() == 1 {
            copied += 1;
        } else {
            bytes += flush(&mut copied) + 2 * run.len().div_ceil(LONGEST);
        }
    }
    bytes + flush(&mut copied)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_screen_takes_thirteen_minutes() {
        let seconds = transfer_seconds(1280, 1024, 8, 19_200.0);
        assert!((seconds - 1280.0 * 1024.0 * 11.0 / 19_200.0).abs() < 1e-9);
        assert!((seconds - 750.93).abs() < 0.005 && seconds.ceil() as u32 == 751);
        assert!((seconds / 60.0 - 12.5).abs() < 0.02);
        assert_eq!(1280 * 1024 * 11, 14_417_920);
    }

    #[test]
    fn packing_counts_runs_and_copies() {
        let bitmap = |height: u32, indices: Vec<u32>| IndexBitmap {
            width: indices.len() as u32 / height,
            height,
            indices,
        };
        assert_eq!(packed_size(&bitmap(150, vec![7; 22_500])), 150 * 4);
        assert_eq!(packed_size(&bitmap(4, vec![1, 2, 3, 4])), 5);
        assert_eq!(packed_size(&bitmap(6, vec![1, 2, 2, 2, 3, 4])), 2 + 2 + 3);
        assert_eq!(packed_size(&bitmap(129, vec![5; 129])), 4);
        assert_eq!(packed_size(&bitmap(1, Vec::new())), 0);
    }
}
