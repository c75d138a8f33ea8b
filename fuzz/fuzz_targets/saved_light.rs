#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_radiosity::Solution;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(solution) = Solution::load(bytes, None) {
        assert_eq!(solution.incident.len(), solution.mesh.elements().len());
        assert_eq!(Solution::load(&solution.save(7), Some(7)), Ok(solution));
    }
});
