use std::cell::Cell;

use super::*;
use proptest::prelude::*;

fn float(alp: u8, bet: u8, gam: u8) -> Rotation<f32> {
    Rotation::new(&Tables::float(), Angles::alp_bet_gam(alp, bet, gam))
}

fn fixed(alp: u8, bet: u8, gam: u8) -> Rotation<Fixed<10>> {
    Rotation::new(&Tables::fixed(), Angles::alp_bet_gam(alp, bet, gam))
}

#[test]
fn points_move_and_scale() {
    let mut points = [[1, 2, 3], [i32::MAX, 0, i32::MIN]];
    translate(&mut points, [10, -20, -30]);
    assert_eq!(points, [[11, -18, -27], [i32::MAX, -20, i32::MIN]]);
    // An object of 2000 x 2000 in a window of 200 x 200.
    let mut object = [[0, 2000, -1999], [1005, -5, 19]];
    scale(&mut object, [0.1; 3]);
    assert_eq!(object, [[0, 200, -199], [100, 0, 1]]);
    scale(&mut object, [f64::NAN, f64::INFINITY, -1e30]);
    assert_eq!(object, [[0, i32::MAX, i32::MAX], [0, 0, i32::MIN]]);
}

#[test]
fn planes_turn_in_their_order() {
    let tables = Tables::exact();
    let turn = |angles, p: [f64; 3]| SinCos::new(&tables, angles).rotate_by_planes(p);
    let [heading, pitch] = [Angles::alp_bet_gam(0, 0, 64), Angles::alp_bet_gam(0, 64, 0)];
    let orders = |p| (turn(pitch, turn(heading, p)), turn(heading, turn(pitch, p)));
    assert_eq!(orders([0.0, 0.0, 100.0]), ([100.0, 0.0, 0.0], [0.0, -100.0, 0.0]));
    assert_eq!(orders([100.0, 0.0, 0.0]), ([0.0, 100.0, 0.0], [0.0, 0.0, -100.0]));
    assert_eq!(orders([0.0, 100.0, 0.0]), ([0.0, 0.0, 100.0], [100.0, 0.0, 0.0]));
    assert_eq!(turn(Angles::alp_bet_gam(0, 64, 64), [0.0, 0.0, 100.0]), [100.0, 0.0, 0.0]);
}

#[test]
fn right_angles_by_floating_point_tables() {
    let cases = [
        ((0, 0, 64), [100, 0, 0], [0, 0, -100]),
        ((0, 0, 64), [0, 0, 100], [100, 0, 0]),
        ((0, 0, 64), [0, 100, 0], [0, 100, 0]),
        ((0, 64, 0), [0, 100, 0], [0, 0, 100]),
        ((0, 64, 0), [0, 0, 100], [0, -100, 0]),
        ((64, 0, 0), [100, 0, 0], [0, -100, 0]),
        ((64, 0, 0), [0, 100, 0], [100, 0, 0]),
        ((0, 0, 32), [100, 0, 0], [70, 0, -70]),
        ((0, 0, 32), [0, 0, 100], [70, 0, 70]),
        ((0, 0, 128), [100, 0, 0], [-100, 0, 0]),
        ((16, 32, 48), [100, 0, 0], [60, 45, -65]),
        ((16, 32, 48), [0, 100, 0], [27, 65, 70]),
        ((16, 32, 48), [0, 0, 100], [75, -60, 27]),
        ((16, 32, 48), [1000, -1000, 500], [707, -497, -1225]),
        // Cutting towards zero, and a constant that is slightly off.
        ((0, 0, 64), [100, 100, 100], [99, 100, -100]),
    ];
    for ((alp, bet, gam), from, to) in cases {
        assert_eq!(float(alp, bet, gam).rotate_point(from), to, "{alp} {bet} {gam}");
    }
    let exact = Rotation::<f64>::new(&Tables::exact(), Angles::alp_bet_gam(0, 0, 64));
    assert_eq!(exact.rotate_point([100, 100, 100]), [100, 100, -100]);
}

#[test]
fn the_coefficients_of_16_32_48() {
    let expected = [[6036, 2706, 7500], [4571, 6533, -6036], [-6533, 7071, 2706]];
    let rows = float(16, 32, 48).rows;
    assert_eq!(rows.map(|row| row.map(|m| (m * 1e4).round() as i32)), expected);
    let steps = fixed(16, 32, 48).rows.map(|row| row.map(Fixed::steps));
    assert_eq!(steps, [[615, 276, 768], [468, 668, -616], [-668, 724, 276]]);
    assert_eq!(fixed(16, 32, 48).rotate_point([1000, -1000, 500]), [705, -497, -1227]);
}

#[test]
fn fixed_point_shrinks_and_rounds_down() {
    let still = fixed(0, 0, 0);
    assert_eq!([0, 1, 2].map(|k| still.rows[k][k].steps()), [1022; 3]);
    let at = |x| still.rotate_point([x, 0, 0])[0];
    assert_eq!([100, -100, 1000, 1].map(at), [99, -100, 998, 0]);
    assert_eq!(still.rotate_point([1000, -1000, 500]), [998, -999, 499]);
    let steep = fixed(0, 64, 0).rows;
    assert_eq!([steep[2][1].steps(), steep[1][2].steps()], [1023, -1021]);
    assert_eq!(fixed(0, 0, 32).rotate_point([100, 0, 0]), [70, 0, -71]);
    assert_eq!(float(0, 0, 32).rotate_point([100, 0, 0]), [70, 0, -70]);
}

/// Numbers that count how often they are multiplied.
#[derive(Clone, Copy)]
struct Counted<'a>(&'a Cell<usize>);

impl Counted<'_> {
    fn count(self) {
        self.0.set(self.0.get() + 1);
    }
}

impl Add for Counted<'_> {
    type Output = Self;
    fn add(self, _: Self) -> Self {
        self
    }
}
impl Sub for Counted<'_> {
    type Output = Self;
    fn sub(self, _: Self) -> Self {
        self
    }
}
impl Neg for Counted<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self
    }
}
impl Mul for Counted<'_> {
    type Output = Self;
    fn mul(self, _: Self) -> Self {
        self.count();
        self
    }
}

#[test]
fn multiplications_are_12_or_9_and_16() {
    let count = Cell::new(0);
    let number = Counted(&count);
    let sin_cos = SinCos { heading: [number; 2], pitch: [number; 2], roll: [number; 2] };
    let _ = sin_cos.rotate_by_planes([number; 3]);
    assert_eq!(count.replace(0), 12);
    let _ = sin_cos.coefficients();
    assert_eq!(count.replace(0), 16);
    assert_eq!([12 * 100, 9 * 100 + 16], [1200, 916]);
}

#[test]
fn fixed_and_floating_point_in_20_000_trials() {
    let mut state = 1u64;
    let mut chance = |count: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % count
    };
    let mut most = 0;
    for _ in 0..20_000 {
        let [alp, bet, gam] = std::array::from_fn(|_| chance(256) as u8);
        let point = std::array::from_fn(|_| chance(2001) as i32 - 1000);
        let (a, b) = (float(alp, bet, gam).rotate_point(point), fixed(alp, bet, gam).rotate_point(point));
        most = (0..3).fold(most, |most, k| most.max(a[k].abs_diff(b[k])));
    }
    assert_eq!(most, 7);
}

#[test]
fn points_that_are_rotated_over_and_over_drift() {
    let step = float(0, 0, 1);
    let mut point = [1000, 0, 0];
    (0..256).for_each(|_| point = step.rotate_point(point));
    assert!(point[0] < 960, "a full turn in single steps arrives at {point:?}");
}

proptest! {
    #[test]
    fn coefficients_are_the_three_planes(alp: u8, bet: u8, gam: u8, p in prop::array::uniform3(-1e3f64..1e3)) {
        let angles = Angles::alp_bet_gam(alp, bet, gam);
        let by_planes = SinCos::new(&Tables::exact(), angles).rotate_by_planes(p);
        let at_once = Rotation::<f64>::new(&Tables::exact(), angles).rotate_exact(p);
        for k in 0..3 {
            prop_assert!((by_planes[k] - at_once[k]).abs() < 1e-9);
        }
    }

    #[test]
    fn fixed_point_stays_near_floating_point(
        alp: u8, bet: u8, gam: u8, p in prop::array::uniform3(-1000i32..=1000)
    ) {
        let (a, b) = (float(alp, bet, gam).rotate_point(p), fixed(alp, bet, gam).rotate_point(p));
        prop_assert!((0..3).all(|k| a[k].abs_diff(b[k]) <= 7), "{a:?} {b:?}");
    }

    #[test]
    fn no_integer_breaks_a_rotation(alp: u8, bet: u8, gam: u8, p: [i32; 3], by: [i32; 3]) {
        let mut points = [p];
        float(alp, bet, gam).rotate(&mut points);
        fixed(alp, bet, gam).rotate(&mut points);
        translate(&mut points, by);
    }
}
