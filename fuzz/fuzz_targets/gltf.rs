#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{NoFiles, gltf};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(scene) = gltf::read("fuzz.gltf", bytes, &NoFiles) {
        check::check(&scene);
        scene.validate().expect("the scene holds together");
    }
});
