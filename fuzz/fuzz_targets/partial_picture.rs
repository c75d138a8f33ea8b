#![no_main]

use libfuzzer_sys::fuzz_target;
use senca_trace::antialias::Antialiasing;
use senca_trace::{Area, Film, FilmSettings};

fuzz_target!(|bytes: &[u8]| {
    let settings = FilmSettings {
        size: [3, 2],
        area: Area { x: 0, y: 0, width: 3, height: 2 },
        antialiasing: Antialiasing::None,
        seed: 0,
    };
    if let Ok(film) = Film::resume(bytes, 7, &settings) {
        assert_eq!(film.save(7), bytes);
    }
});
