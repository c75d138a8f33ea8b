#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_math::view_file::ViewFile;

fuzz_target!(|text: &str| {
    if let Ok(file) = ViewFile::parse("fuzz.view", text) {
        for (name, matrix) in file.matrices().expect("a file that was read gives a view") {
            assert!(matrix.is_finite(), "{name} is {matrix}");
        }
    }
});
