use fearless_simd::Simd;
use proptest::prelude::{ProptestConfig, prop_assert_eq, proptest};

use super::*;

fn literal(parameters: &Parameters) -> Counts {
    literal_counts(parameters, &Control::default()).expect("nobody stops it")
}

fn fast(parameters: &Parameters, level: Level) -> Counts {
    counts(parameters, true, level, &Control::default()).expect("nobody stops it")
}

fn levels() -> Vec<Level> {
    let best = Level::new();
    let mut all = vec![best, Level::baseline()];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    all.extend(
        [
            best.as_sse2().map(|s| s.level()),
            best.as_sse4_2().map(|s| s.level()),
            best.as_avx2().map(|s| s.level()),
            best.as_avx512().map(|s| s.level()),
        ]
        .into_iter()
        .flatten(),
    );
    all
}

#[track_caller]
fn check(counts: &Counts, expected: &str) {
    for word in expected.split_whitespace() {
        let numbers: Vec<usize> = word.split(',').map(|n| n.parse().expect("a number")).collect();
        assert_eq!(counts.at(numbers[0], numbers[1]) as usize, numbers[2], "{word}");
    }
}

#[test]
fn the_mandelbrot_set_of_the_manual() {
    let counts = literal(&Parameters::MANDELBROT);
    check(
        &counts,
        "0,0,4 10,10,4 27,6,4 199,199,4 6,44,5 197,15,5 96,191,6 10,146,6 25,147,7 50,50,7 199,100,7 121,9,8 3,85,8
         76,147,9 150,1,9 100,30,10 74,63,10 147,193,10 88,36,11 194,69,11 153,170,12 76,66,12 137,5,13 154,168,13
         142,7,14 28,121,14 29,79,15 124,17,15 100,100,16 150,100,16 150,150,16 0,100,16 112,167,16 136,0,16",
    );
    let last = leave(&Parameters::MANDELBROT, 136, 0);
    assert!(last.k == 16 && (last.modulus - 411.07).abs() < 5e-3, "{last:?}");
    // Row y is row 200 - y.
    for y in 1..200 {
        assert!((0..200).all(|x| counts.at(x, y) == counts.at(x, 200 - y)), "{y}");
    }
}

#[test]
fn the_julia_set_of_the_manual() {
    let counts = literal(&Parameters::JULIA);
    check(
        &counts,
        "0,0,3 2,3,3 0,186,3 15,180,4 199,100,4 10,100,5 18,40,5 110,10,6 29,95,6 19,127,7 40,26,7 40,110,8 43,104,8
         75,9,9 36,168,9 19,151,10 105,176,10 58,117,11 145,81,11 103,171,12 153,78,12 130,80,13 102,28,13 52,134,14
         155,76,14 112,164,15 43,131,15 100,100,16 50,50,16 109,76,16",
    );
    let turned = |x: usize, y: usize| counts.at(x, y) == counts.at(200 - x, 200 - y);
    assert!((1..200).all(|y| (1..200).all(|x| turned(x, y))));
    let pixels = (0..200).flat_map(|y| (0..200).map(move |x| (x, y)));
    let unlike = |&(x, y): &(usize, usize)| x > 0 && y > 0 && counts.at(x, y) != counts.at(x, 200 - y);
    assert_eq!(pixels.filter(unlike).count(), 13_100);
}

#[test]
fn how_many_pixels_have_each_count() {
    let cases: [(Parameters, bool, [u64; 14], u64, usize); 4] = [
        (
            Parameters::MANDELBROT,
            false,
            [0, 1523, 5259, 4184, 3064, 2083, 1472, 1085, 809, 648, 470, 449, 332, 18622],
            451_704,
            295,
        ),
        (
            Parameters::MANDELBROT,
            true,
            [0, 1578, 5326, 4222, 3134, 2080, 1442, 1068, 814, 642, 466, 446, 332, 18450],
            449_650,
            284,
        ),
        (
            Parameters::JULIA,
            false,
            [1271, 4947, 4857, 2542, 1424, 942, 668, 552, 564, 620, 646, 670, 546, 19751],
            447_802,
            438,
        ),
        (
            Parameters::JULIA,
            true,
            [1372, 5100, 4896, 2522, 1428, 902, 646, 576, 568, 602, 664, 626, 536, 19562],
            444_814,
            420,
        ),
    ];
    for (parameters, reach_ends, histogram, sum, left_at_last) in cases {
        let counts = literal(&Parameters { reach_ends, ..parameters });
        assert_eq!(counts.histogram()[..3], [0; 3]);
        assert_eq!(counts.histogram()[3..], histogram);
        assert_eq!((counts.sum(), counts.left_at_last), (sum, left_at_last));
    }
}

#[test]
fn traces() {
    let near = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() <= 5.1e-7_f64.max(5.1e-4 * f64::from(u8::from(*b > 1000.0))), "{a} {b}");
        }
    };
    let (mandelbrot, julia) = (Parameters::MANDELBROT, Parameters::JULIA);
    let corner = mandelbrot.point(0, 0);
    assert_eq!(corner, [-1.5, -1.0]);
    near(trace(&mandelbrot, [0.0; 2], corner), &[1.802_776, 2.015_564, 5.793_652, 31.776_633, 1008.545]);
    let half = [0.5, 0.75, 1.0625, 1.628_906, 3.153_336, 10.443_525, 109.567_219];
    near(trace(&mandelbrot, [0.0; 2], [0.5, 0.0]), &half);
    let ends = Parameters { reach_ends: true, ..mandelbrot };
    assert_eq!((leave(&mandelbrot, 199, 100).k, leave(&ends, 199, 100).k), (7, 6));
    assert_eq!((mandelbrot.point(199, 0)[0], ends.point(199, 0)[0]), (0.49, 0.5));
    let (z, c) = julia.start(0, 0);
    assert_eq!((z, c), ([-1.0, -1.2], [0.32, 0.043]));
    near(trace(&julia, z, c), &[2.445_945, 5.659_987, 32.357_777, 1047.339]);
}

#[test]
fn nothing_comes_so_near_to_the_bound_that_the_comparison_matters() {
    let closest = |parameters: Parameters| {
        let pixels = (0..200).flat_map(|y| (0..200).map(move |x| (x, y)));
        let moduli = pixels.flat_map(|(x, y)| {
            let (z, c) = parameters.start(x, y);
            trace(&parameters, z, c)
        });
        moduli.map(|r| (r - 100.0).abs()).fold(f64::INFINITY, f64::min)
    };
    assert!((closest(Parameters::MANDELBROT) - 0.0035).abs() < 5e-5);
    assert!((closest(Parameters::JULIA) - 0.012).abs() < 5e-4);
}

#[test]
fn the_constant_of_the_julia_set_lies_in_the_mandelbrot_set() {
    let c = [0.32, 0.043];
    let mut z = [0.0; 2];
    for _ in 0..100_000 {
        z = next(z, c);
    }
    let start = z;
    for n in 1..=11 {
        z = next(z, c);
        let back = modulus([z[0] - start[0], z[1] - start[1]]) < 1e-12;
        assert_eq!(back, n == 11, "{n}");
    }
}

#[test]
fn many_at_once_are_the_same_at_every_level() {
    let cases = [
        Parameters::MANDELBROT,
        Parameters::JULIA,
        Parameters { iterations: 0, ..Parameters::MANDELBROT },
        Parameters { iterations: 1, bound: 0.7, ..Parameters::MANDELBROT },
        Parameters { iterations: 1003, bound: 2.0, size: [61, 47], ..Parameters::MANDELBROT },
        // Orbits that leave may come back below so small a bound.
        Parameters { iterations: 50, bound: 0.6, size: [33, 29], ..Parameters::JULIA },
        Parameters { iterations: 5_000, bound: 1e200, size: [37, 5], ..Parameters::MANDELBROT },
        Parameters {
            u: [-1.77, -1.74],
            v: [-0.02, 0.02],
            iterations: 777,
            size: [17, 80],
            ..Parameters::MANDELBROT
        },
    ];
    for parameters in cases {
        let expected = literal(&parameters);
        for level in levels() {
            assert!(fast(&parameters, level) == expected, "{parameters:?} {level:?}");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        assert!(pool.install(|| fast(&parameters, Level::new())) == expected);
    }
}

#[test]
fn long_loops_end_when_orbits_return() {
    // Without that this would take 4 * 10^12 iterations.
    let parameters =
        Parameters { iterations: 100_000_000, u: [-0.1, 0.1], v: [-0.1, 0.1], ..Parameters::MANDELBROT };
    let counts = counts(&parameters, false, Level::new(), &Control::default()).expect("nobody stops it");
    assert!(counts.k.iter().all(|&k| k == 100_000_000) && counts.left_at_last == 0);
}

#[test]
fn texts_are_read() {
    let read = |text: &str| Parameters::read(&mut Input::new("f.txt", text));
    let text = "100 16 # eps and m\n-1.5 0.5\n-1 1\n200 200\n";
    assert_eq!(read(text).expect("parameters"), Parameters::MANDELBROT);
    let julia = read("100 16  -1 1  -1.2 1.2  200 200  0.32 0.043").expect("parameters");
    assert_eq!(julia, Parameters::JULIA);
    let told = |text: &str| read(text).expect_err(text).to_string();
    assert_eq!(told("100 16\n1 1"), "f.txt:2:3: umax is 1, but must be greater than umin, 1");
    assert_eq!(told("0"), "f.txt:1:1: the bound eps is 0, but must be greater than 0");
    assert!(told("100 -1").contains("f.txt:1:5: the number of iterations m"));
    assert!(told("100 16 -1 1 -1 1 0 5").contains("the width is to be a whole number from 1 to 32768"));
    assert!(told("100 16 -1 1 -1 1 5 5 1").contains("the imaginary part of c is to come"));
    assert!(told("100 16 -1 1 -1 1 5 5 1 1 1").contains("one too many"));
}

#[test]
fn the_caller_can_stop_it() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let control = Control { cancel: Some(&stop), ..Control::default() };
    assert_eq!(literal_counts(&Parameters::JULIA, &control), Err(Cancelled));
    assert_eq!(counts(&Parameters::JULIA, false, Level::new(), &control), Err(Cancelled));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_area_is_the_same_both_ways(
        u in -2.0f64..1.0, v in -1.5f64..1.5, log in -40.0f64..1.0, bound in 0.1f64..200.0,
        m in 0u32..400, w in 1usize..40, h in 1usize..6, julia: bool,
    ) {
        let side = log.exp2();
        let family = if julia { Family::Julia { c: [v, u] } } else { Family::Mandelbrot };
        let parameters = Parameters {
            family, bound, iterations: m, u: [u, u + side], v: [v, v + side], size: [w, h], reach_ends: julia,
        };
        prop_assert_eq!(fast(&parameters, Level::new()), literal(&parameters));
    }
}
