//! Numbers as bytes and back.

use senca_math::LinearRgb;
use senca_math::glam::DVec3;

/// FNV-1a (Fowler, Noll and Vo) by eight bytes at a time. Not made against forgery.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    pub(super) fn add(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|word| self.mix(u64::from_le_bytes(*word)));
        for &byte in rest {
            self.mix(u64::from(byte));
        }
    }

    /// The rotation brings the high half, which multiplication alone never moves down, into play.
    fn mix(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    }

    pub(super) fn value(self) -> u64 {
        self.0
    }
}

impl std::fmt::Write for Hash {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        text.bytes().for_each(|byte| self.mix(u64::from(byte)));
        Ok(())
    }
}

pub(super) fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Hash::default();
    hash.add(bytes);
    hash.value()
}

/// Appends numbers to bytes.
pub(super) struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    pub(super) fn with_capacity(capacity: usize) -> Self {
        Self { bytes: Vec::with_capacity(capacity) }
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub(super) fn u32(&mut self, number: u32) {
        self.bytes(&number.to_le_bytes());
    }

    pub(super) fn u64(&mut self, number: u64) {
        self.bytes(&number.to_le_bytes());
    }

    pub(super) fn f64(&mut self, number: f64) {
        self.bytes(&number.to_le_bytes());
    }

    pub(super) fn vector(&mut self, vector: DVec3) {
        vector.to_array().iter().for_each(|&number| self.f64(number));
    }

    pub(super) fn color(&mut self, color: LinearRgb) {
        color.to_array().iter().for_each(|number| self.bytes(&number.to_le_bytes()));
    }

    /// All that was written, and its checksum.
    pub(super) fn finished(mut self) -> Vec<u8> {
        let sum = checksum(&self.bytes);
        self.u64(sum);
        self.bytes
    }
}

/// Takes numbers from the front of bytes; `None` where there are no more, or the number is none.
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    /// Number of bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len()
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*first)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u32x4(&mut self) -> Option<[u32; 4]> {
        Some([self.u32()?, self.u32()?, self.u32()?, self.u32()?])
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn flag(&mut self) -> Option<bool> {
        match self.array::<1>()? {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }

    pub(super) fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// Finite.
    pub(super) fn f32(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes).filter(|v| v.is_finite())
    }

    /// In [0, 1].
    pub(super) fn share(&mut self) -> Option<f32> {
        self.f32().filter(|v| (0.0..=1.0).contains(v))
    }

    /// Finite.
    pub(super) fn vector(&mut self) -> Option<DVec3> {
        Some(DVec3::new(self.f64()?, self.f64()?, self.f64()?)).filter(|v| v.is_finite())
    }

    /// Finite and not negative.
    pub(super) fn light(&mut self) -> Option<LinearRgb> {
        let mut channels = [0.0; 3];
        for channel in &mut channels {
            *channel = self.f32().filter(|v| *v >= 0.0)?;
        }
        Some(LinearRgb::from_array(channels))
    }
}
