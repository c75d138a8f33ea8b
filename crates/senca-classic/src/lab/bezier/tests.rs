use proptest::prelude::{prop_assert, proptest};

use super::*;
use crate::lab::polygon::Position;
use crate::lab::solid::tests::normalized_cube;
use crate::lab::vectors::length;

const CURVE: [Row3; 4] = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 3.0, 1.0], [4.0, 0.0, 2.0]];
const PATH: [Row3; 5] =
    [[1.0, 1.0, 3.0], [3.0, 1.0, 1.0], [1.0, 3.0, -1.0], [-3.0, 2.0, 0.0], [-1.0, 1.0, 4.0]];

#[track_caller]
fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let far = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 1e-14, "{found:?}\n{expected:?}");
}

#[test]
fn the_weights_of_degree_three() {
    let third = 1.0 / 27.0;
    let cases: [(f64, [f64; 4], [f64; 4]); 7] = [
        (0.0, [1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        (0.01, [0.970_299, 0.029_403, 0.000_297, 0.000_001], [1.0, 0.029_701, 0.000_298, 0.000_001]),
        (
            0.25,
            [27.0 / 64.0, 27.0 / 64.0, 9.0 / 64.0, 1.0 / 64.0],
            [1.0, 37.0 / 64.0, 5.0 / 32.0, 1.0 / 64.0],
        ),
        (1.0 / 3.0, [8.0 * third, 12.0 * third, 6.0 * third, third], [1.0, 19.0 * third, 7.0 * third, third]),
        (0.5, [0.125, 0.375, 0.375, 0.125], [1.0, 0.875, 0.5, 0.125]),
        (
            0.75,
            [1.0 / 64.0, 9.0 / 64.0, 27.0 / 64.0, 27.0 / 64.0],
            [1.0, 63.0 / 64.0, 27.0 / 32.0, 27.0 / 64.0],
        ),
        (1.0, [0.0, 0.0, 0.0, 1.0], [1.0; 4]),
    ];
    for (t, b, f) in cases {
        near(&bernstein_weights(3, t), &b);
        near(&std::array::from_fn::<_, 4, _>(|i| bernstein_by_factorials(i, 3, t)), &b);
        near(&bezier_weights(3, t), &f);
        near(&bezier_weights_by_recursion(3, t), &f);
        near(&std::array::from_fn::<_, 3, _>(|i| bezier_weight_by_derivative(i + 1, 3, t)), &f[1..]);
        // The polynomials.
        let p = [3.0 * t - 3.0 * t * t + t.powi(3), 3.0 * t * t - 2.0 * t.powi(3), t.powi(3)];
        near(&f[1..], &p);
    }
}

#[test]
fn weights_of_other_degrees() {
    near(&bernstein_weights(2, 0.5), &[0.25, 0.5, 0.25]);
    near(&bernstein_weights(4, 0.25), &[81.0 / 256.0, 27.0 / 64.0, 27.0 / 128.0, 3.0 / 64.0, 1.0 / 256.0]);
    near(&bernstein_weights(5, 0.5), &[1.0, 5.0, 10.0, 10.0, 5.0, 1.0].map(|v| v / 32.0));
    near(&bernstein_weights(0, 0.7), &[1.0]);
    for n in 0..=6 {
        for t in parameters() {
            near(&bezier_weights(n, t), &bezier_weights_by_recursion(n, t));
            let by_derivative: Vec<_> = (1..=n).map(|i| bezier_weight_by_derivative(i, n, t)).collect();
            near(&by_derivative, &bezier_weights(n, t)[1..]);
        }
    }
}

#[test]
fn with_zero_before_the_first_the_recursion_is_bernsteins() {
    let t = 0.3;
    let mut weights = vec![1.0];
    for _ in 0..5 {
        let at = |i: Option<usize>| i.and_then(|i| weights.get(i)).copied().unwrap_or(0.0);
        weights = (0..=weights.len()).map(|i| (1.0 - t) * at(Some(i)) + t * at(i.checked_sub(1))).collect();
    }
    near(&weights, &bernstein_weights(5, t));
}

#[test]
fn any_number_of_control_points() {
    for n in [170, 171, 2_000, 100_000] {
        for t in [1e-9, 0.3, 0.5, 0.999] {
            let weights = bernstein_weights(n, t);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let mean: f64 = weights.iter().enumerate().map(|(i, w)| i as f64 * w).sum();
            assert!((mean / n as f64 - t).abs() < 1e-10, "{n} {t} {mean}");
        }
    }
    let factorials = bernstein_by_factorials(60, 170, 0.4);
    assert!((bernstein_weights(170, 0.4)[60] / factorials - 1.0).abs() < 1e-12);
    assert!(bernstein_by_factorials(5, 171, 0.4).is_infinite(), "171! is no number any more");
    assert_eq!(curve(&[[1.0, 2.0, 3.0]]), [[1.0, 2.0, 3.0]; 101]);
}

#[test]
fn factorials_outgrow_whole_numbers() {
    let factorial = |n: u64| (1..=u128::from(n)).product::<u128>();
    assert!(factorial(12) <= 1 << 31 && factorial(13) > 1 << 31);
    assert!(factorial(20) <= 1 << 63 && factorial(21) > 1 << 63);
}

#[test]
fn points_of_curves() {
    let cases: [(&[Row3], f64, Row3); 6] = [
        (&CURVE, 0.25, [0.90625, 1.265_625, 0.171_875]),
        (&CURVE, 0.5, [2.0, 1.875, 0.625]),
        (&CURVE, 0.75, [3.09375, 1.546_875, 1.265_625]),
        (&PATH, 0.25, [1.648_437_5, 1.46875, 1.175_781_25]),
        (&PATH, 0.5, [0.375, 2.0, 0.3125]),
        (&PATH, 0.75, [-1.226_562_5, 1.843_75, 1.113_281_25]),
    ];
    for (points, t, expected) in cases {
        near(&point_by_bernstein(points, t), &expected);
        near(&point_by_bezier(points, t), &expected);
        near(&point_by_de_casteljau(points, t), &expected);
    }
}

#[test]
fn adding_up_hundredths_loses_the_end() {
    let (mut t, mut count, mut last) = (0.0_f64, 0, 0.0);
    while t <= 1.0 {
        (count, last) = (count + 1, t);
        t += 0.01;
    }
    assert_eq!((count, last, t), (100, 0.990_000_000_000_000_7, 1.000_000_000_000_000_7));
    let (mut t, mut count, mut last) = (0.0_f32, 0, 0.0);
    while t <= 1.0 {
        (count, last) = (count + 1, t);
        t += 0.01;
    }
    assert_eq!((count, last), (101, 0.999_999_34));
    let all: Vec<f64> = parameters().collect();
    assert_eq!((all.len(), all[0], all[100]), (101, 0.0, 1.0));
}

#[test]
fn what_the_eye_sees_along_its_path() {
    let cube = normalized_cube();
    let seen = |t: f64| -> Vec<usize> {
        visible_faces(&cube, point_by_bernstein(&PATH, t)).iter().map(|i| i + 1).collect()
    };
    for (t, expected) in [
        (0.0, &[11, 12][..]),
        (0.1, &[3, 4, 5, 6, 11, 12]),
        (0.25, &[3, 4, 5, 6, 11, 12]),
        (0.4, &[3, 4, 5, 6]),
        (0.5, &[5, 6]),
        (0.6, &[5, 6]),
        (0.75, &[5, 6, 7, 8, 11, 12]),
        (0.9, &[5, 6, 7, 8, 11, 12]),
        (1.0, &[11, 12]),
    ] {
        assert_eq!(seen(t), expected, "{t}");
    }
    let counts: Vec<usize> = parameters().map(|t| seen(t).len()).collect();
    let frames = |n: usize| counts.iter().filter(|&&c| c == n).count();
    assert_eq!((frames(2), frames(4), frames(6)), (32, 15, 54));
    assert_eq!(counts.iter().sum::<usize>(), 448);
    for (i, eye) in curve(&PATH).into_iter().enumerate() {
        let found = cube.position(eye);
        assert_eq!(found.position, Position::Outside);
        assert_eq!(found.values.contains(&0.0), i == 0 || i == 100, "{i}");
    }
}

#[test]
fn texts_are_read() {
    let read = |text: &str| read_control_points(&mut Input::new("c.txt", text));
    assert_eq!(read("0 0 0\n1 2 0 # and\n3 3 1, 4 0 2").expect("points"), CURVE);
    let told = |text: &str| read(text).expect_err(text).to_string();
    assert_eq!(told("1 2 3\n4 5"), "c.txt:2:4: the text ends, but z of control point 1 is to come");
    assert_eq!(told("1 2 x"), "c.txt:1:5: z of control point 0 is to be a number, but is 'x'");
    assert_eq!(told(" "), "c.txt:1:2: the text ends, but x of control point 0 is to come");
}

proptest! {
    #[test]
    fn both_forms_give_one_curve(
        points in proptest::collection::vec(proptest::array::uniform3(-9.0f64..9.0), 1..40),
        t in 0.0f64..=1.0,
    ) {
        let expected = point_by_de_casteljau(&points, t);
        prop_assert!(length(subtract(point_by_bernstein(&points, t), expected)) < 1e-12);
        prop_assert!(length(subtract(point_by_bezier(&points, t), expected)) < 1e-11);
    }
}
