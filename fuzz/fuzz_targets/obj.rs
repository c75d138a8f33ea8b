#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, obj};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = obj::read("fuzz.obj", bytes, &NoFiles) {
        check::check(&scene);
    }
});
