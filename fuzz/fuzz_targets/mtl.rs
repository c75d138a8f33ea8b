#![no_main]

mod check;

use libfuzzer_sys::fuzz_target;
use senca_io::{Files, Location, ReadError, obj};

/// The fuzzed bytes as the library "a.mtl", and nothing else.
struct Library<'a>(&'a [u8]);

impl Files for Library<'_> {
    fn read(&self, uri: &str) -> Result<Vec<u8>, ReadError> {
        match uri {
            "a.mtl" => Ok(self.0.to_vec()),
            _ => Err(ReadError::malformed(Location::file(uri), "is not there")),
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    let text = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    if let Ok(scene) = obj::read("fuzz.obj", text, &Library(bytes)) {
        check::check(&scene);
    }
});
