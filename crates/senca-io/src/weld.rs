//! Finding equal things: exact welding of points and of vertices.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

use senca_scene::math::glam::Vec3;

/// Numbers distinct keys in the order of their first coming.
pub(crate) struct Welder<K> {
    numbers: HashMap<K, u32, Keys>,
}

impl<K: std::hash::Hash + Eq> Welder<K> {
    /// Expects about `capacity` distinct keys.
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        Self { numbers: HashMap::with_capacity_and_hasher(capacity, Keys::new()) }
    }

    /// The number of `key`, and whether it came for the first time.
    #[inline]
    pub(crate) fn number(&mut self, key: K) -> (u32, bool) {
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        (number, number == next)
    }
}

/// The bits of a point; both zeros are one.
#[inline]
pub(crate) fn point_key(point: Vec3) -> [u32; 3] {
    (point + Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Secret start of the hash, so that nobody can write a file whose keys all collide. Only the speed
/// depends on it, never the numbers given.
#[derive(Clone, Copy)]
struct Keys {
    start: u64,
    factor: u64,
}

impl Keys {
    fn new() -> Self {
        let random = RandomState::new();
        Self { start: random.hash_one(1), factor: random.hash_one(2) | 1 }
    }
}

impl BuildHasher for Keys {
    type Hasher = Folded;

    fn build_hasher(&self) -> Folded {
        Folded { state: self.start, factor: self.factor }
    }
}

/// Hash of whole words: each is mixed in by a full multiplication whose halves are folded together.
struct Folded {
    state: u64,
    factor: u64,
}

impl Folded {
    #[inline]
    fn mix(&mut self, word: u64) {
        let product = u128::from(self.state ^ word) * u128::from(self.factor);
        self.state = (product as u64) ^ ((product >> 64) as u64).rotate_left(23) ^ word;
    }
}

impl Hasher for Folded {
    fn finish(&self) -> u64 {
        let product = u128::from(self.state) * u128::from(self.factor);
        product as u64 ^ (product >> 64) as u64
    }

    #[inline]
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.mix(u64::from_le_bytes(word));
        }
    }

    #[inline]
    fn write_u32(&mut self, n: u32) {
        self.mix(u64::from(n));
    }

    #[inline]
    fn write_u64(&mut self, n: u64) {
        self.mix(n);
    }

    #[inline]
    fn write_usize(&mut self, n: usize) {
        self.mix(n as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_points_share_a_number_and_both_zeros_are_equal() {
        let mut welder = Welder::with_capacity(4);
        assert_eq!(welder.number(point_key(Vec3::new(0.0, 1.0, 2.0))), (0, true));
        assert_eq!(welder.number(point_key(Vec3::new(0.0, 1.0, 2.5))), (1, true));
        assert_eq!(welder.number(point_key(Vec3::new(-0.0, 1.0, 2.0))), (0, false));
    }
}
