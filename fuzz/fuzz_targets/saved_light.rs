#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_radiosity::Solution;

/// The bytes with their last eight made the checksum of the rest, or all that is behind it would be
/// refused for that.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let body = &bytes[..bytes.len().saturating_sub(8)];
    let (words, rest) = body.as_chunks::<8>();
    let words = words.iter().map(|word| u64::from_le_bytes(*word));
    let mix = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    let sum = words.chain(rest.iter().map(|&byte| byte.into())).fold(0xcbf2_9ce4_8422_2325, mix);
    [body, &sum.to_le_bytes()].concat()
}

fn check(bytes: &[u8]) {
    if let Ok(solution) = Solution::load(bytes, None) {
        assert_eq!(solution.incident.len(), solution.mesh.elements().len());
        assert_eq!(Solution::load(&solution.save(7), Some(7)), Ok(solution));
    }
}

fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    check(&sealed(bytes));
});
