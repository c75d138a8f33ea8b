use proptest::prelude::*;
use senca_math::Control;

use super::*;

/// Three patches of areas 1, 1, 2; the first shines.
fn three() -> System {
    let factors = FactorMatrix::from_dense(&[[0.0, 0.3, 0.7], [0.3, 0.0, 0.7], [0.35, 0.35, 0.3]]);
    let rho = [0.8, 0.5, 0.2].map(|r| [r; 3]).to_vec();
    System::new(factors, vec![1.0, 1.0, 2.0], rho, vec![[1.0; 3], [0.0; 3], [0.0; 3]]).expect("in range")
}

const OPPOSITE: f64 = 0.199_824_895_7;
const ADJACENT: f64 = 0.200_043_776_1;

/// The inside of a cube; faces 2k and 2k + 1 are opposite.
fn cube(rho: f64, emission: [f64; 6]) -> System {
    let factor = |i: usize, j: usize| match (i, j) {
        _ if i == j => 0.0,
        _ if i / 2 == j / 2 => OPPOSITE,
        _ => ADJACENT,
    };
    let rows: Vec<Vec<f64>> = (0..6).map(|i| (0..6).map(|j| factor(i, j)).collect()).collect();
    let emission = emission.map(|e| [e; 3]).to_vec();
    System::new(FactorMatrix::from_dense(&rows), vec![1.0; 6], vec![[rho; 3]; 6], emission).expect("in range")
}

fn first_face() -> [f64; 6] {
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
}

fn solved(system: &System) -> Vec<Rgb64> {
    let mut solver = GaussSeidel::new(system);
    let rule = StopRule { tolerance: 1e-14, ..StopRule::default() };
    let outcome = solver.run(&rule, &Control::default(), |_, _| ()).expect("not cancelled");
    assert!(outcome.converged);
    solver.into_radiosity()
}

fn assert_close(found: &[Rgb64], expected: &[f64], tolerance: f64) {
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.iter().all(|f| (f - expected).abs() < tolerance), "{found:?} is not {expected}");
    }
}

#[test]
fn rows_of_the_matrix() {
    let system = three();
    for (i, expected) in [[1.0, -0.24, -0.56], [-0.15, 1.0, -0.35], [-0.07, -0.07, 0.94]].iter().enumerate() {
        for (found, expected) in system.matrix_row(i, 1).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-15);
        }
    }
    assert_eq!(system.factors().reciprocity_error(system.areas()), 0.0);
    assert!((system.factors().largest_row_sum() - 1.0).abs() < 1e-15);
}

#[test]
fn three_patches() {
    let system = three();
    let radiosity = solved(&system);
    assert_close(&radiosity, &[1.102_082_581_0, 0.199_229_565_4, 0.096_906_223_7], 6e-11);
    assert!(system.residual(&radiosity) < 1e-13);
    assert!(system.balance(&radiosity).error() < 1e-13);
}

#[test]
fn iterates_from_emission() {
    let system = three();
    let mut solver = GaussSeidel::new(&system);
    let expected = [
        (1, [1.0, 0.15, 0.085_638_297_9]),
        (2, [1.083_957_446_8, 0.192_567_021_3, 0.095_060_332_7]),
        (3, [1.099_449_871_4, 0.198_188_597_2, 0.096_632_651_9]),
        (4, [1.101_679_548_4, 0.199_073_360_4, 0.096_864_578_3]),
        (6, [1.102_073_369_4, 0.199_225_981_1, 0.096_905_270_8]),
    ];
    let mut sweeps = 0;
    for (k, values) in expected {
        while sweeps < k {
            solver.sweep();
            sweeps += 1;
        }
        assert_close(solver.radiosity(), &values, 6e-11);
    }
}

#[test]
fn the_inside_of_a_cube() {
    let system = cube(0.5, first_face());
    let radiosity = solved(&system);
    let other = 0.181_836_268_9;
    assert_close(&radiosity, &[1.090_909_098_1, 0.181_745_826_1, other, other, other, other], 2e-10);
    // Rows sum to 1, so that the light given off is kept: 1 = 1.
    let balance = system.balance(&radiosity);
    assert!((balance.absorbed[0] - 1.0).abs() < 1e-9 && balance.lost[0].abs() < 1e-9);
}

#[test]
fn errors_of_sweeps_in_the_cube() {
    let system = cube(0.5, first_face());
    let exact = solved(&system);
    let mut solver = GaussSeidel::new(&system);
    let mut sweeps = 0;
    for (k, expected) in [(1, 0.0909), (2, 0.0299), (3, 0.00833), (5, 6.2e-4), (10, 9.6e-7), (20, 2.3e-12)] {
        while sweeps < k {
            solver.sweep();
            sweeps += 1;
        }
        let pairs = solver.radiosity().iter().zip(&exact);
        let error = pairs.map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
        assert!((error / expected - 1.0).abs() < 0.03, "{k} sweeps: {error}, not {expected}");
    }
}

#[test]
fn a_furnace_glows_alike_everywhere() {
    for rho in [0.0, 0.5, 0.9, 0.98] {
        let radiosity = solved(&cube(rho, [1.0; 6]));
        assert_close(&radiosity, &[1.0 / (1.0 - rho); 6], 1e-7 / (1.0 - rho).powi(2));
    }
}

#[test]
fn jacobi_follows_the_bounces() {
    let system = three();
    let mut jacobi = Jacobi::new(&system);
    jacobi.sweep();
    // One bounce; the third patch sees itself, which its diagonal holds.
    assert_close(jacobi.radiosity(), &[1.0, 0.15, 0.07 / 0.94], 1e-15);
    let rule = StopRule { tolerance: 1e-14, ..StopRule::default() };
    let outcome = jacobi.run(&rule, &Control::default()).expect("not cancelled");
    assert!(outcome.converged && outcome.sweeps > 10);
    let exact: Vec<f64> = solved(&system).iter().map(|b| b[0]).collect();
    assert_close(jacobi.radiosity(), &exact, 1e-12);
}

#[test]
fn shooting_ends_at_the_same_light() {
    for system in [three(), cube(0.7, [1.0, 0.0, 0.5, 0.0, 0.0, 0.0])] {
        let exact: Vec<f64> = solved(&system).iter().map(|b| b[0]).collect();
        let mut shooting = Shooting::new(&system);
        assert_eq!(shooting.shoot(), Some(0), "the lamp first");
        while shooting.unsent_share() > 1e-13 {
            shooting.shoot();
        }
        assert_close(shooting.radiosity(), &exact, 1e-11);
    }
}

#[test]
fn the_ambient_estimate_is_near_before_shooting_is() {
    let system = cube(0.7, first_face());
    let exact = solved(&system);
    let mut shooting = Shooting::new(&system);
    let total = |values: &[Rgb64]| values.iter().map(|v| v[0]).sum::<f64>();
    // In an even cube the estimate of all light together is right from the start.
    for _ in 0..4 {
        assert!((total(&shooting.with_ambient()) / total(&exact) - 1.0).abs() < 1e-9);
        assert!(total(shooting.radiosity()) < 0.9 * total(&exact));
        shooting.shoot();
    }
}

#[test]
fn dominance_is_lost_with_rows_above_1() {
    assert!((cube(0.5, first_face()).dominance() - 0.5).abs() < 1e-9);
    // Factors of a coarse hemicube sum to 1.0054603503.
    let rows = vec![[0.0, 1.005_460_350_3], [1.005_460_350_3, 0.0]];
    let build = |factors: FactorMatrix| {
        System::new(factors, vec![1.0; 2], vec![[0.999; 3]; 2], vec![[1.0; 3]; 2]).expect("in range")
    };
    let mut factors = FactorMatrix::from_dense(&rows);
    let system = build(factors.clone());
    assert!(system.dominance() < 0.0);
    let mut solver = GaussSeidel::new(&system);
    let rule = StopRule { tolerance: 1e-9, max_sweeps: 100 };
    let outcome = solver.run(&rule, &Control::default(), |_, _| ()).expect("not cancelled");
    assert!(!outcome.converged && outcome.change > 1e-9 && outcome.sweeps == 100);
    assert_eq!(factors.limit_row_sums(1.0), 2);
    assert!(build(factors).dominance() > 0.0);
}

#[test]
fn impossible_numbers_are_refused() {
    let with = |rho: f64, emission: f64, area: f64, factor: f64| {
        let factors = FactorMatrix::from_dense(&[[0.0, factor], [0.5, 0.0]]);
        System::new(factors, vec![1.0, area], vec![[0.5; 3], [0.5, rho, 0.5]], vec![[emission, 0.0, 0.0]; 2])
    };
    assert!(with(0.5, 1.0, 1.0, 0.5).is_ok());
    let error = with(1.0, 1.0, 1.0, 0.5).expect_err("refused").to_string();
    assert_eq!(error, "reflectance is 1, but must be 0 or more and below 1");
    for (rho, emission, area, factor) in [
        (f64::NAN, 1.0, 1.0, 0.5),
        (0.5, f64::NAN, 1.0, 0.5),
        (0.5, -1.0, 1.0, 0.5),
        (0.5, 1.0, 0.0, 0.5),
        (0.5, 1.0, 1.0, f64::INFINITY),
    ] {
        assert!(with(rho, emission, area, factor).is_err(), "{rho} {emission} {area} {factor}");
    }
}

#[test]
fn every_sweep_can_be_watched_and_stopped() {
    let system = three();
    let mut seen = Vec::new();
    let mut solver = GaussSeidel::new(&system);
    let rule = StopRule::default();
    let outcome = solver.run(&rule, &Control::default(), |b, _| seen.push(b[0][0])).expect("not cancelled");
    assert_eq!(seen.len(), outcome.sweeps as usize);
    assert!((seen[1] - 1.083_957_446_8).abs() < 1e-9);
    let flag = std::sync::atomic::AtomicBool::new(true);
    let control = Control { cancel: Some(&flag), ..Control::default() };
    let mut solver = GaussSeidel::new(&system);
    assert_eq!(solver.run(&rule, &control, |_, _| ()), Err(RadiosityError::Cancelled));
    assert_eq!(solver.radiosity(), system.emission());
}

/// A patch in two parts, and two others.
fn divided() -> System {
    let rows = [[0.0, 0.0, 0.8, 0.2], [0.0, 0.0, 0.4, 0.6], [0.1, 0.15, 0.5, 0.25], [0.05, 0.45, 0.5, 0.0]];
    let rho = [0.5, 0.5, 0.8, 0.6].map(|r| [r; 3]).to_vec();
    let emission = [1.0, 1.0, 0.0, 0.0].map(|e| [e; 3]).to_vec();
    let areas = vec![0.25, 0.75, 2.0, 1.0];
    System::new(FactorMatrix::from_dense(&rows), areas, rho, emission).expect("in range")
}

#[test]
fn two_levels_without_more_equations() {
    let (all, patch_of) = (divided(), [0, 0, 1, 2]);
    assert!(all.factors().reciprocity_error(all.areas()) < 1e-15);
    let full = solved(&all);
    assert_close(&full, &[1.308_557_457_2, 1.298_777_506_1, 0.626_894_865_5, 0.577_995_11], 6e-11);
    let patches = condensed(&all, &patch_of).expect("in range");
    for (i, expected) in [[0.0, 0.5, 0.5], [0.25, 0.5, 0.25], [0.5, 0.5, 0.0]].iter().enumerate() {
        for (j, expected) in expected.iter().enumerate() {
            assert!((patches.factors().get(i, j) - expected).abs() < 1e-15);
        }
    }
    let big = solved(&patches);
    assert_close(&big, &[1.301_204_819_3, 0.626_506_024_1, 0.578_313_253], 6e-11);
    let small = parts(&all, &patch_of, &big);
    assert_close(&small, &[1.308_433_734_9, 1.298_795_180_7], 6e-11);
    // The mean of the parts is the patch; that of the full system differs a little.
    let mean = |b: &[Rgb64]| 0.25 * b[0][0] + 0.75 * b[1][0];
    assert!((mean(&small) - big[0][0]).abs() < 1e-12);
    assert!((mean(&full) - 1.301_222_493_9).abs() < 6e-11);
}

proptest! {
    /// Open scenes: factors that obey reciprocity and sum to less than 1 lose nothing but what they say.
    #[test]
    fn power_is_accounted_for(
        exchange in proptest::collection::vec(0.0f64..1.0, 15),
        areas in proptest::collection::vec(0.5f64..3.0, 5),
        rho in proptest::collection::vec(0.0f64..0.95, 5),
        emission in proptest::collection::vec(0.0f64..2.0, 5),
    ) {
        let total: f64 = exchange.iter().sum::<f64>().max(1e-3);
        let mut rows = vec![vec![0.0; 5]; 5];
        let mut k = 0;
        for i in 0..5 {
            for j in i..5 {
                // A_i F_ij, small enough for every row.
                let shared = 0.5 * exchange[k] / total;
                (rows[i][j], rows[j][i]) = (shared / areas[i], shared / areas[j]);
                k += 1;
            }
        }
        let three = |v: &[f64]| v.iter().map(|&v| [v, 0.5 * v, v]).collect::<Vec<_>>();
        let system = System::new(FactorMatrix::from_dense(&rows), areas, three(&rho), three(&emission)).expect("in range");
        prop_assert!(system.dominance() > 0.0);
        let radiosity = solved(&system);
        prop_assert!(system.balance(&radiosity).error() < 1e-9);
        prop_assert!(system.residual(&radiosity) < 1e-12);
    }
}
