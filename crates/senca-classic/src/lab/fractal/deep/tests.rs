use super::super::{Family, Level, Parameters, View};
use super::*;

fn view(re: &str, im: &str, width: &str, iterations: u32, size: [usize; 2]) -> DeepView {
    let View { center, width } = View::parse(re, im, width).expect("a view");
    DeepView { center, width, julia: None, bound: 100.0, iterations, size }
}

#[track_caller]
fn agrees(view: &DeepView) -> Counts {
    let control = Control::default();
    let deep = deep_counts(view, Level::new(), &control).expect("nobody stops it");
    assert!(deep == deep_counts_one_by_one(view, &control).expect("nobody stops it"), "the same bits");
    let brute = brute_counts(view, &control).expect("nobody stops it");
    let different = deep.k.iter().zip(&brute.k).filter(|(a, b)| a != b).count();
    assert_eq!(different, 0, "{:?}\n{:?}", deep.k, brute.k);
    for (a, b) in deep.moduli.iter().zip(&brute.moduli) {
        assert!((a - b).abs() <= 1e-3 * b, "{a} {b}");
    }
    deep
}

/// At least this many different counts, so that there is something to get wrong.
#[track_caller]
fn has_detail(counts: &Counts, least: usize) {
    let different = counts.histogram().iter().filter(|&&n| n > 0).count();
    assert!(different >= least, "only {different} counts: {:?}", counts.k);
}

/// The preperiodic point -1.5436890126..., where c^3 + 2 c^2 + 2 c + 2 = 0.
const PREPERIODIC: &str = "-1.54368901269207636157085597180174798652520329765098393524080403";

#[test]
fn shallow_views_agree_with_the_plain_loop() {
    let parameters = Parameters { size: [48, 48], iterations: 200, ..Parameters::MANDELBROT };
    let plain = super::super::counts(&parameters, false, Level::new(), &Control::default()).expect("counted");
    let deep = agrees(&view("-0.5", "0", "2", 200, [48, 48]));
    let different = plain.k.iter().zip(&deep.k).filter(|(a, b)| a != b).count();
    assert!(different <= 2, "{different}");
    has_detail(&deep, 30);
}

#[test]
fn deep_views_agree_with_many_digits() {
    has_detail(&agrees(&view(PREPERIODIC, "0", "1e-20", 400, [13, 9])), 3);
    has_detail(&agrees(&view(PREPERIODIC, "3e-42", "1e-40", 600, [9, 7])), 3);
    // The tip of an antenna, and a dendrite.
    has_detail(&agrees(&view("-2", "0", "1e-30", 300, [11, 7])), 3);
    has_detail(&agrees(&view("0", "1", "1e-100", 2_000, [9, 7])), 3);
}

#[test]
fn a_small_copy_of_the_whole_set() {
    // A nucleus of period 460, 1.8e-29 in size.
    let (re, im) = (
        "-0.7746801319835207707515791989543337898602796034199812713724925884",
        "-0.1374164012961857927162591905894840107238690621541539991172377345",
    );
    let counts = agrees(&view(re, im, "4e-28", 8_000, [8, 6]));
    has_detail(&counts, 20);
    let copy = deep_counts(&view(re, im, "2e-29", 8_000, [4, 4]), Level::new(), &Control::default())
        .expect("counted");
    assert!(copy.at(2, 2) == 8_000, "the middle belongs to the set");
}

#[test]
fn views_deeper_than_the_exponents_of_the_processor() {
    has_detail(&agrees(&view("0", "1", "1e-320", 5_000, [5, 4])), 3);
    has_detail(&agrees(&view("-2", "1e-401", "3e-400", 2_000, [6, 4])), 3);
}

#[test]
fn where_a_reference_alone_would_glitch() {
    // Next to a nucleus of period 3, whose orbit comes back to 0 again and again; and off its middle,
    // so that the reference leaves early.
    let nucleus = "-1.7548776662466927600495088963585286918946066177727931439892839706";
    agrees(&view(nucleus, "0", "1e-2", 500, [21, 15]));
    agrees(&view(nucleus, "0", "1e-25", 300, [7, 5]));
    has_detail(&agrees(&view("-1.7590", "0.0125", "5e-3", 700, [21, 15])), 20);
    // The middle leaves at once, the set does not.
    has_detail(&agrees(&view("0.9", "0.9", "4", 100, [24, 24])), 12);
}

#[test]
fn julia_sets() {
    let parse = |text: &str| Fixed::parse(text, 8).expect(text);
    let mut dendrite = view("0", "0", "3", 300, [24, 24]);
    dendrite.julia = Some([parse("-0.12"), parse("0.75")]);
    has_detail(&agrees(&dendrite), 10);
    let mut shallow = Parameters { size: [24, 24], iterations: 300, ..Parameters::JULIA };
    (shallow.u, shallow.v) = ([-1.5, 1.5], [-1.5, 1.5]);
    shallow.family = Family::Julia { c: [-0.12, 0.75] };
    let plain = super::super::counts(&shallow, false, Level::new(), &Control::default()).expect("counted");
    assert!(plain.k.iter().zip(&agrees(&dendrite).k).filter(|(a, b)| a != b).count() <= 2);
    // At the point of the Julia set of i that is i itself.
    let mut deep = view("0", "1", "1e-50", 900, [9, 7]);
    deep.julia = Some([parse("0"), parse("1")]);
    has_detail(&agrees(&deep), 3);
    let mut wide = view("0", "1", "1e-310", 4_000, [5, 3]);
    wide.julia = Some([parse("0"), parse("1")]);
    has_detail(&agrees(&wide), 3);
}

#[test]
fn threads_do_not_matter() {
    let view = view(PREPERIODIC, "0", "1e-25", 400, [31, 17]);
    let counts = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| deep_counts(&view, Level::new(), &Control::default())).expect("nobody stops it")
    };
    assert!(counts(1) == counts(3));
}

#[test]
fn vector_instructions_do_not_matter() {
    for (re, im, width, size) in [
        (PREPERIODIC, "1e-26", "1e-25", [37, 5]),
        ("0", "1", "1e-320", [19, 3]),
        ("-0.75", "0.1", "0.05", [50, 7]),
    ] {
        let view = view(re, im, width, 700, size);
        let control = Control::default();
        let one_by_one = deep_counts_one_by_one(&view, &control).expect("nobody stops it");
        for level in [Level::new(), Level::baseline()] {
            assert!(deep_counts(&view, level, &control).expect("nobody stops it") == one_by_one, "{re}");
        }
    }
}

#[test]
fn the_caller_can_stop_it() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let control = Control { cancel: Some(&stop), ..Control::default() };
    let view = view("0", "0", "1", 9, [2, 2]);
    assert_eq!(deep_counts(&view, Level::new(), &control), Err(Cancelled));
    assert_eq!(deep_counts_one_by_one(&view, &control), Err(Cancelled));
}
