#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, load_bytes, toml_scene};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = toml_scene::read("fuzz.toml", bytes, &NoFiles, &load_bytes) {
        check::check(&file.scene);
    }
});
