#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, ply};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = ply::read("fuzz.ply", bytes, &NoFiles) {
        check::check(&scene);
    }
});
