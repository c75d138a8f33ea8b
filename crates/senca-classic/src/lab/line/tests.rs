use super::*;

fn pixels(text: &str) -> Vec<Pixel> {
    let pair = |word: &str| {
        let (x, y) = word.split_once(',').expect("x,y");
        [x.parse().expect("x"), y.parse().expect("y")]
    };
    text.split_whitespace().map(pair).collect()
}

#[test]
fn the_procedure_of_the_manual() {
    let cases = [
        ([0, 0], [8, 3], "0,0 1,0 2,1 3,1 4,1 5,2 6,2 7,3"),
        ([0, 0], [8, 4], "0,0 1,0 2,1 3,1 4,2 5,2 6,3 7,3"),
        ([2, 1], [9, 6], "2,1 3,2 4,2 5,3 6,4 7,5 8,5"),
        ([1, 1], [11, 5], "1,1 2,1 3,2 4,2 5,3 6,3 7,3 8,4 9,4 10,5"),
        ([0, 0], [5, 5], "0,0 1,1 2,2 3,3 4,4"),
        ([0, 0], [6, 0], "0,0 1,0 2,0 3,0 4,0 5,0"),
    ];
    for (start, end, expected) in cases {
        assert_eq!(literal_line(start, end), pixels(expected), "{start:?} {end:?}");
        assert_eq!(integer_line(start, end), pixels(expected), "{start:?} {end:?}");
    }
}

#[test]
fn outside_of_its_octant_the_procedure_is_not_meant_to_work() {
    assert_eq!(literal_line([0, 0], [3, 8]), pixels("0,0 1,1 2,2"));
    assert_eq!(literal_line([0, 0], [4, -3]), pixels("0,0 1,0 2,0 3,0"));
    assert!(literal_line([0, 0], [-5, 2]).is_empty());
    assert!(literal_line([0, 0], [0, 5]).is_empty());
}

#[test]
fn every_octant_with_its_end() {
    let cases = [
        ([8, 3], "0,0 1,0 2,1 3,1 4,1 5,2 6,2 7,3 8,3"),
        ([3, 8], "0,0 0,1 1,2 1,3 1,4 2,5 2,6 3,7 3,8"),
        ([-3, 8], "0,0 0,1 -1,2 -1,3 -1,4 -2,5 -2,6 -3,7 -3,8"),
        ([-8, 3], "0,0 -1,0 -2,1 -3,1 -4,1 -5,2 -6,2 -7,3 -8,3"),
        ([-8, -3], "0,0 -1,0 -2,-1 -3,-1 -4,-1 -5,-2 -6,-2 -7,-3 -8,-3"),
        ([-3, -8], "0,0 0,-1 -1,-2 -1,-3 -1,-4 -2,-5 -2,-6 -3,-7 -3,-8"),
        ([3, -8], "0,0 0,-1 1,-2 1,-3 1,-4 2,-5 2,-6 3,-7 3,-8"),
        ([8, -3], "0,0 1,0 2,-1 3,-1 4,-1 5,-2 6,-2 7,-3 8,-3"),
        ([8, 4], "0,0 1,0 2,1 3,1 4,2 5,2 6,3 7,3 8,4"),
        ([4, 8], "0,0 0,1 1,2 1,3 2,4 2,5 3,6 3,7 4,8"),
        ([5, 5], "0,0 1,1 2,2 3,3 4,4 5,5"),
        ([-5, 5], "0,0 -1,1 -2,2 -3,3 -4,4 -5,5"),
        ([0, 0], "0,0"),
    ];
    for (end, expected) in cases {
        assert_eq!(bresenham([0, 0], end), pixels(expected), "{end:?}");
    }
    for end in [[7, 0], [0, 7], [-7, 0], [0, -7]] {
        let line = bresenham([0, 0], end);
        assert_eq!((line.len(), line[0], line[7]), (8, [0, 0], end));
        assert!(line.iter().all(|p| p[0] == 0 || p[1] == 0));
    }
}

/// The row of the exact procedure at column `i`: ceil(i y0 / x0 - 1/2).
fn exact_row(i: i32, x0: i32, y0: i32) -> i32 {
    (2 * i * y0 - x0).div_euclid(2 * x0) + i32::from((2 * i * y0 - x0).rem_euclid(2 * x0) > 0)
}

#[test]
fn whole_numbers_are_exact_and_floating_ones_break_ties() {
    let (mut lines, mut different, mut most) = (0, 0, 0);
    for x0 in 1..=200 {
        for y0 in 0..=x0 {
            let whole = integer_line([0, 0], [x0, y0]);
            assert!(whole.iter().all(|&[x, y]| y == exact_row(x, x0, y0)), "{x0} {y0}");
            assert_eq!(whole, bresenham([0, 0], [x0, y0])[..x0 as usize]);
            let floating = literal_line([0, 0], [x0, y0]);
            let wrong = floating.iter().zip(&whole).filter(|(a, b)| a != b).count();
            lines += 1;
            different += usize::from(wrong > 0);
            most = most.max(wrong);
        }
    }
    assert_eq!((lines, different, most), (20_300, 3_078, 33));
    assert_eq!(literal_line([0, 0], [6, 5])[3], [3, 3]);
    assert_eq!(integer_line([0, 0], [6, 5])[3], [3, 2]);
}

#[test]
fn single_precision_breaks_other_ties() {
    let single = |x0: i32, y0: i32| {
        let slope = y0 as f32 / x0 as f32;
        let (mut d, mut y, mut rows) = (slope - 0.5, 0, Vec::new());
        for _ in 0..x0 {
            rows.push(y);
            if d > 0.0 {
                y += 1;
                d -= 1.0;
            }
            d += slope;
        }
        rows
    };
    let differs = |x0: i32, y0: i32| (0..x0).zip(single(x0, y0)).any(|(i, y)| y != exact_row(i, x0, y0));
    let count = (1..=200).flat_map(|x0| (0..=x0).map(move |y0| (x0, y0))).filter(|&(x, y)| differs(x, y));
    assert_eq!(count.count(), 3_003);
}

#[test]
fn ties_depend_on_the_direction() {
    assert_eq!(bresenham([8, 4], [0, 0]), pixels("8,4 7,4 6,3 5,3 4,2 3,2 2,1 1,1 0,0"));
    let mut different = 0;
    for dx in 0..=40 {
        for dy in 0..=dx {
            let mut back = bresenham([dx, dy], [0, 0]);
            back.reverse();
            different += i32::from(back != bresenham([0, 0], [dx, dy]));
        }
    }
    assert_eq!(different, 284);
}

#[test]
fn homogeneous_lines() {
    let line = line_through([1.0, 1.0, 1.0], [5.0, 3.0, 1.0]);
    assert_eq!(line, [-2.0, 4.0, -2.0]);
    for (point, value) in [([3.0, 2.0], 0.0), ([3.0, 5.0], 12.0), ([3.0, 0.0], -8.0), ([0.0, 0.0], -2.0)] {
        assert_eq!(side(line, [point[0], point[1], 1.0]), value);
    }
    assert_eq!(line_through([5.0, 3.0, 1.0], [1.0, 1.0, 1.0]), [2.0, -4.0, 2.0]);
    assert_eq!(point_at([1.0, 1.0, 1.0], [5.0, 3.0, 1.0], 0.5), [3.0, 2.0, 1.0]);
    assert_eq!(point_at([1.0, 1.0, 1.0], [5.0, 3.0, 1.0], 1.0), [5.0, 3.0, 1.0]);
}

proptest::proptest! {
    #[test]
    fn lines_are_connected_and_as_near_as_can_be(x in -300i32..300, y in -300i32..300) {
        let line = bresenham([0, 0], [x, y]);
        let long = x.abs().max(y.abs());
        proptest::prop_assert_eq!(line.len() as i32, long + 1);
        proptest::prop_assert_eq!(line.last(), Some(&[x, y]));
        for (i, p) in line.iter().enumerate() {
            // Distance along the shorter way, times 2 `long`: at most half a pixel.
            let (along, across) = if y.abs() > x.abs() { (x, p[0]) } else { (y, p[1]) };
            proptest::prop_assert!((2 * (along * i as i32 - across * long)).abs() <= long);
        }
    }
}
