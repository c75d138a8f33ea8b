#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_io::{Limits, images};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { image_texels: 1 << 20, ..Limits::default() };
    let _ = images::decode("fuzz", bytes, &limits);
    let _ = images::decode_picture("fuzz", bytes, &limits);
});
