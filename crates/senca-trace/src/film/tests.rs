//! The film with integrators whose pictures are known.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::*;
use crate::RayCounts;
use crate::antialias::{AdaptiveSettings, PixelFilter};

/// A picture of stripes and a slope, that counts its samples.
struct Stripes;

impl Integrator for Stripes {
    type Work = u64;

    fn sample(&self, place: &SamplePlace, work: &mut u64) -> [f32; 4] {
        *work += 1;
        let mut sampler = place.sampler;
        let stripe = if (place.x + 0.3 * place.y) % 5.0 < 2.5 { 1.0 } else { 0.0 };
        [stripe, place.y as f32 / 40.0, sampler.next_1d() as f32, 1.0]
    }

    fn counts(work: &u64) -> TraceCounts {
        let rays = RayCounts { primary: *work, ..RayCounts::default() };
        TraceCounts { rays, ..TraceCounts::default() }
    }
}

/// The same three times as large.
struct Enlarged;

impl Integrator for Enlarged {
    type Work = u64;

    fn sample(&self, place: &SamplePlace, work: &mut u64) -> [f32; 4] {
        Stripes.sample(&SamplePlace { x: place.x / 3.0, y: place.y / 3.0, ..*place }, work)
    }

    fn counts(work: &u64) -> TraceCounts {
        Stripes::counts(work)
    }
}

/// One colour everywhere.
struct Even(f32, AtomicU64);

impl Integrator for Even {
    type Work = ();

    fn sample(&self, _: &SamplePlace, (): &mut ()) -> [f32; 4] {
        self.1.fetch_add(1, Ordering::Relaxed);
        [self.0, self.0, self.0, 1.0]
    }

    fn counts((): &()) -> TraceCounts {
        TraceCounts::default()
    }
}

fn settings(antialiasing: Antialiasing) -> FilmSettings {
    let area = Area { x: 0, y: 0, width: 37, height: 21 };
    FilmSettings { size: [37, 21], area, antialiasing, seed: 1 }
}

fn all_kinds() -> [Antialiasing; 7] {
    [
        Antialiasing::None,
        Antialiasing::Jitter { amplitude: 0.8 },
        Antialiasing::Regular { per_side: 3 },
        Antialiasing::Adaptive(AdaptiveSettings::default()),
        Antialiasing::Adaptive(AdaptiveSettings { passes: 3, ..AdaptiveSettings::default() }),
        Antialiasing::Filtered { samples: 8, filter: PixelFilter::Box },
        Antialiasing::Filtered { samples: 8, filter: PixelFilter::Mitchell { radius: 2.0 } },
    ]
}

fn exposed(settings: &FilmSettings) -> (Film, FilmReport) {
    let mut film = Film::new(settings).expect("a film");
    let report = film.expose(&Stripes, &mut Watch::default(), &Control::default()).expect("a picture");
    (film, report)
}

#[test]
fn threads_make_no_difference() {
    for antialiasing in all_kinds() {
        let settings = settings(antialiasing);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| exposed(&settings))
        };
        let ((one, report_one), (three, report_three)) = (on(1), on(3));
        assert_eq!(one, three, "{antialiasing:?}");
        assert_eq!(report_one.counts, report_three.counts);
        assert_eq!(report_one.counts.rays.primary, report_one.samples);
    }
}

#[test]
fn a_part_equals_that_part_of_the_whole() {
    for antialiasing in all_kinds() {
        let whole = exposed(&settings(antialiasing)).0.develop(false);
        let area = Area { x: 9, y: 4, width: 20, height: 17 };
        let part = exposed(&FilmSettings { area, ..settings(antialiasing) }).0.develop(false);
        for y in 0..17 {
            assert_eq!(part.row(y), &whole.row(4 + y)[9..29], "row {y} of {antialiasing:?}");
        }
    }
}

#[test]
fn regular_supersampling_is_enlarging_and_reducing() {
    let size = [111, 63];
    let area = Area { x: 0, y: 0, width: 111, height: 63 };
    let settings_large = FilmSettings { size, area, ..settings(Antialiasing::None) };
    let mut large = Film::new(&settings_large).expect("a film");
    large.expose(&Enlarged, &mut Watch::default(), &Control::default()).expect("a picture");
    let large = large.develop(false);
    let small = exposed(&settings(Antialiasing::Regular { per_side: 3 })).0.develop(false);
    for (x, y) in [(0, 0), (11, 7), (36, 20), (20, 3)] {
        let cells = (0..9).map(|i| large.pixel(3 * x + i % 3, 3 * y + i / 3));
        let mean = cells.fold([0.0; 2], |sum, p| [sum[0] + p[0] / 9.0, sum[1] + p[1] / 9.0]);
        let [r, g, ..] = small.pixel(x, y);
        assert!((mean[0] - r).abs() < 1e-6 && (mean[1] - g).abs() < 1e-6, "{x},{y}");
    }
    let even = Even(0.25, AtomicU64::new(0));
    let mut film = Film::new(&settings(Antialiasing::Regular { per_side: 4 })).expect("a film");
    film.expose(&even, &mut Watch::default(), &Control::default()).expect("a picture");
    assert_eq!(even.1.into_inner(), 37 * 21 * 16, "n times n rays a pixel");
    assert!(film.develop(false).pixels().iter().all(|p| *p == [0.25, 0.25, 0.25, 1.0]));
}

#[test]
fn an_even_picture_takes_the_corners_only() {
    let even = Even(0.5, AtomicU64::new(0));
    let mut film = Film::new(&settings(Antialiasing::Adaptive(AdaptiveSettings::default()))).expect("a film");
    let report = film.expose(&even, &mut Watch::default(), &Control::default()).expect("a picture");
    assert_eq!(even.1.into_inner(), (37 + 1) * (21 + 1));
    assert_eq!((report.samples, report.samples_per_pixel), (38 * 22, 4));
    assert!(film.develop(false).pixels().iter().all(|p| *p == [0.5, 0.5, 0.5, 1.0]));
}

#[test]
fn the_map_shows_where_adaptive_samples_went() {
    let (film, _) = exposed(&settings(Antialiasing::Adaptive(AdaptiveSettings::default())));
    let map = film.samples_map();
    let values: Vec<f32> = map.pixels().iter().map(|p| p[0]).collect();
    assert!(values.contains(&1.0), "edges");
    assert!(values.iter().any(|v| *v < 0.2), "and the middle of stripes");
}

#[test]
fn filters_keep_an_even_picture_even() {
    for name in ["box", "tent", "gaussian", "mitchell", "blackman-harris"] {
        let filter = PixelFilter::named(name, None).expect("a filter");
        let mut film = Film::new(&settings(Antialiasing::Filtered { samples: 16, filter })).expect("a film");
        let even = Even(0.5, AtomicU64::new(0));
        film.expose(&even, &mut Watch::default(), &Control::default()).expect("a picture");
        let image = film.develop(false);
        assert!(image.pixels().iter().all(|p| (p[0] - 0.5).abs() < 1e-6), "{name}");
    }
}

#[test]
fn goes_add_up_to_one_and_resuming_is_going_on() {
    for antialiasing in all_kinds() {
        let settings = settings(antialiasing);
        let whole = exposed(&settings).0;
        let mut film = Film::new(&settings).expect("a film");
        let mut goes = 0;
        while film.samples() < whole.samples() {
            let mut watch = Watch { time_limit: Some(Duration::ZERO), save: None };
            film.expose(&Stripes, &mut watch, &Control::default()).expect("a pass");
            let bytes = film.save(77);
            film = Film::resume(&bytes, 77, &settings).expect("reads back");
            goes += 1;
        }
        assert_eq!(film, whole, "{antialiasing:?} after {goes} goes");
    }
}

#[test]
fn more_samples_may_be_asked_of_a_saved_film() {
    let with = |samples| settings(Antialiasing::Filtered { samples, filter: PixelFilter::Box });
    let few = exposed(&with(2)).0;
    let mut film = Film::resume(&few.save(5), 5, &with(8)).expect("reads back");
    film.expose(&Stripes, &mut Watch::default(), &Control::default()).expect("a picture");
    assert_eq!(film, exposed(&with(8)).0);
}

#[test]
fn adaptive_passes_are_a_mean_of_other_moments() {
    let with =
        |passes| settings(Antialiasing::Adaptive(AdaptiveSettings { passes, ..AdaptiveSettings::default() }));
    let mut film = Film::new(&with(4)).expect("a film");
    for (until, light) in [(1, 0.0), (3, 0.5), (9, 1.0)] {
        let even = Even(light, AtomicU64::new(0));
        film.expose_up_to(until, &even, &mut Watch::default(), &Control::default()).expect("a pass");
    }
    assert_eq!(film.samples(), 4);
    assert!(film.develop(false).pixels().iter().all(|p| *p == [0.5, 0.5, 0.5, 1.0]));
    let few = exposed(&with(2)).0;
    let mut film = Film::resume(&few.save(5), 5, &with(5)).expect("reads back");
    film.expose(&Stripes, &mut Watch::default(), &Control::default()).expect("a picture");
    assert_eq!(film, exposed(&with(5)).0);
}

#[test]
fn what_is_not_the_same_picture_is_told() {
    let settings = settings(Antialiasing::Regular { per_side: 2 });
    let bytes = exposed(&settings).0.save(5);
    let resumed = |bytes: &[u8], fingerprint, settings: &FilmSettings| {
        Film::resume(bytes, fingerprint, settings).expect_err("refused").to_string()
    };
    assert!(resumed(&bytes, 6, &settings).contains("scene"));
    assert!(resumed(&bytes, 5, &FilmSettings { seed: 2, ..settings }).contains("seed"));
    let area = Area { x: 1, width: 36, ..settings.area };
    assert!(resumed(&bytes, 5, &FilmSettings { area, ..settings }).contains("0,0,37,21"));
    let size = [40, 21];
    assert!(resumed(&bytes, 5, &FilmSettings { size, ..settings }).contains("37x21"));
    let other = Antialiasing::Regular { per_side: 3 };
    assert!(resumed(&bytes, 5, &FilmSettings { antialiasing: other, ..settings }).contains("antialiasing"));
}

#[test]
fn damaged_and_foreign_bytes_are_refused() {
    let settings = settings(Antialiasing::None);
    let bytes = exposed(&settings).0.save(5);
    for length in [0, 4, 8, 11, 40, bytes.len() - 1] {
        assert!(Film::resume(&bytes[..length], 5, &settings).is_err(), "{length} bytes");
    }
    let flipped = |i: usize| {
        let mut bytes = bytes.clone();
        bytes[i] ^= 1;
        Film::resume(&bytes, 5, &settings).expect_err("refused")
    };
    assert_eq!(flipped(0), SavedFilmError::NotAFilm);
    assert_eq!(flipped(8), SavedFilmError::Version(0));
    assert_eq!(flipped(500), SavedFilmError::Damaged("its checksum is wrong"));
    let long = [&bytes[..], &[0]].concat();
    assert_eq!(Film::resume(&long, 5, &settings), Err(SavedFilmError::Damaged("its length is wrong")));
}

#[test]
fn cancelling_keeps_finished_passes_and_progress_never_falls() {
    let settings = settings(Antialiasing::Regular { per_side: 2 });
    let cancel = AtomicBool::new(true);
    let mut film = Film::new(&settings).expect("a film");
    let control = Control { progress: None, cancel: Some(&cancel) };
    let stopped = film.expose(&Stripes, &mut Watch::default(), &control);
    assert_eq!((stopped, film.samples()), (Err(TraceError::Cancelled), 0));

    let shares = Mutex::new(Vec::new());
    let progress = |share| shares.lock().expect("one at a time").push(share);
    let control = Control { progress: Some(&progress), cancel: None };
    for antialiasing in all_kinds() {
        let settings = FilmSettings { antialiasing, ..settings };
        let mut film = Film::new(&settings).expect("a film");
        let mut watch = Watch { time_limit: Some(Duration::from_secs(999)), save: None };
        film.expose(&Stripes, &mut watch, &control).expect("a picture");
        let shares: Vec<f32> = std::mem::take(&mut *shares.lock().expect("done"));
        assert!(shares.is_sorted() && shares.len() > 1, "{antialiasing:?} {shares:?}");
        assert_eq!(shares.last(), Some(&1.0));
    }
}

#[test]
fn the_film_is_handed_over_for_saving() {
    let settings = settings(Antialiasing::Regular { per_side: 2 });
    let mut film = Film::new(&settings).expect("a film");
    let mut saved = Vec::new();
    let mut save = |film: &Film| saved.push(film.samples());
    let mut watch = Watch { time_limit: None, save: Some(&mut save) };
    film.expose(&Stripes, &mut watch, &Control::default()).expect("a picture");
    assert_eq!(saved.last(), Some(&4));
}

/// Asks to stop at its first sample of the second pass.
struct Stopping<'a>(&'a AtomicBool);

impl Integrator for Stopping<'_> {
    type Work = u64;

    fn sample(&self, place: &SamplePlace, work: &mut u64) -> [f32; 4] {
        let stops = place.x > 36.0 && place.y > 20.0 && place.x % 1.0 > 0.5;
        self.0.fetch_or(stops, Ordering::Relaxed);
        Stripes.sample(place, work)
    }

    fn counts(work: &u64) -> TraceCounts {
        Stripes::counts(work)
    }
}

#[test]
fn a_pass_that_was_stopped_leaves_no_trace() {
    let cancel = AtomicBool::new(false);
    let control = Control { progress: None, cancel: Some(&cancel) };
    let area = Area { x: 0, y: 0, width: 67, height: 41 };
    let settings = FilmSettings { size: [67, 41], area, ..settings(Antialiasing::Regular { per_side: 2 }) };
    let mut film = Film::new(&settings).expect("a film");
    let mut watch = Watch { time_limit: Some(Duration::from_secs(999)), save: None };
    let stopped = film.expose(&Stopping(&cancel), &mut watch, &control);
    assert_eq!((stopped, film.samples()), (Err(TraceError::Cancelled), 1));
    let mut first = Film::new(&settings).expect("a film");
    let mut watch = Watch { time_limit: Some(Duration::ZERO), save: None };
    first.expose(&Stripes, &mut watch, &Control::default()).expect("a pass");
    assert_eq!(film, first);
    first.expose(&Stripes, &mut Watch::default(), &Control::default()).expect("the others");
    film.expose(&Stripes, &mut Watch::default(), &Control::default()).expect("the others");
    assert_eq!(film, first);
}
