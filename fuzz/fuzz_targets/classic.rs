#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, classic};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = classic::read_object("fuzz.dat", bytes, &NoFiles) {
        check::check(&scene);
    }
    let _ = classic::read_patches("fuzz.bez", bytes, &NoFiles);
    let _ = classic::ClassicScene::parse("fuzz.dat", bytes);
    let _ = classic::IndexBitmap::read("fuzz.btm", bytes);
});
