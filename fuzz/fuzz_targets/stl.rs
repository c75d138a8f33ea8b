#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, stl};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = stl::read("fuzz.stl", bytes, &NoFiles) {
        check::check(&scene);
    }
});
