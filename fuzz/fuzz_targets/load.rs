#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, load_bytes};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = load_bytes("fuzz", bytes, &NoFiles) {
        check::check(&scene);
    }
});
