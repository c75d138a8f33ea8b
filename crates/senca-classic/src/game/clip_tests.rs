use super::*;
use proptest::prelude::*;

const SCREEN: [usize; 2] = [320, 200];

fn printed(a: [i32; 2], b: [i32; 2]) -> Option<([i32; 2], [i32; 2], bool)> {
    clip_line([a, b], Bounds::columns(320), Search::AsPrinted).map(|l| (l.start, l.end, l.first_clipped))
}

#[test]
fn the_example_of_the_text() {
    let bounds = Bounds { axis: 0, min: 0, max: 100 };
    for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
        let line = clip_line([[-3, 1], [1, 5]], bounds, search).expect("crosses");
        assert_eq!((line.start, line.end, line.first_clipped), ([0, 4], [1, 5], true));
    }
}

#[test]
fn lines_as_printed() {
    assert_eq!(printed([-10, 0], [10, 20]), Some(([0, 10], [10, 20], true)));
    assert_eq!(printed([-100, 0], [419, 199]), Some(([0, 37], [319, 159], true)));
    assert_eq!(printed([400, 0], [-80, 199]), Some(([319, 31], [0, 164], true)));
    assert_eq!(printed([5, 5], [330, 9]), Some(([5, 5], [319, 8], false)));
    assert_eq!(printed([-10, 3], [-1, 4]), None);
}

#[test]
fn the_slips_of_the_listing_are_there_as_printed() {
    let ends = |a, b| printed(a, b).map(|(start, end, _)| (start, end));
    assert_eq!(ends([0, 0], [1, 100]), Some(([0, 50], [1, 100])));
    assert_eq!(ends([319, 0], [320, 100]), Some(([319, 0], [319, 50])));
    assert_eq!(ends([0, 10], [0, 50]), Some(([0, 10], [0, 10])));
    assert_eq!(ends([319, 10], [319, 50]), Some(([319, 10], [319, 50])));
    assert_eq!(ends([-1, 0], [2, 99]), Some(([0, 49], [2, 99])));
    let screen = |a, b| clip_line_to_screen([a, b], SCREEN, Search::AsPrinted);
    assert_eq!(screen([10, 0], [50, 0]), Some([[10, 0], [10, 0]]));
    assert_eq!(screen([0, 0], [319, 199]), Some([[1, 0], [319, 199]]));
}

#[test]
fn the_slips_are_mended() {
    for search in [Search::Precise, Search::SimilarTriangles] {
        let screen = |a, b| clip_line_to_screen([a, b], SCREEN, search);
        for [a, b] in [
            [[0, 0], [1, 100]],
            [[0, 10], [0, 50]],
            [[10, 0], [50, 0]],
            [[319, 10], [319, 50]],
            [[10, 199], [50, 199]],
            [[0, 0], [319, 199]],
        ] {
            assert_eq!(screen(a, b), Some([a, b]), "within the screen nothing moves");
        }
        assert_eq!(screen([-1, 0], [2, 99]), Some([[0, 33], [2, 99]]));
        assert_eq!(screen([319, 0], [320, 100]), Some([[319, 0], [319, 0]]));
    }
}

#[test]
fn the_search_ends() {
    // Halving -1 by a shift gives -1 again; the candidate that is tested first is the other end.
    assert_eq!(printed([-1, 7], [0, 9]), Some(([0, 9], [0, 9], true)));
    let bounds = Bounds { axis: 0, min: 0, max: 19 };
    for a in -25..=44 {
        for b in -25..=44 {
            for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
                let line = clip_line([[a, 0], [b, 100]], bounds, search);
                let outside = a.max(b) < 0 || a.min(b) > 19;
                assert_eq!(line.is_none(), outside);
                let within = |v: [i32; 2]| (0..=19).contains(&v[0]) && (0..=100).contains(&v[1]);
                assert!(line.is_none_or(|l| within(l.start) && within(l.end)));
            }
        }
    }
}

#[test]
fn the_search_ends_after_six_midpoints_a_side() {
    let mut most = 0;
    for low in -25..=44 {
        for high in low..=44 {
            for (side, edge) in [(Side::Low, 0), (Side::High, 19)] {
                if low <= edge && high >= edge {
                    most = most.max(halve_as_printed([low, 0], [high, 100], side, 0, edge).1);
                }
            }
        }
    }
    assert_eq!(most, 6, "so a line that is cut at both sides takes 12");
}

/// Chance that is the same every time (Knuth's linear congruence).
struct Chance(u64);

impl Chance {
    fn between(&mut self, low: i32, high: i32) -> i32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + ((self.0 >> 33) % (high - low + 1) as u64) as i32
    }
}

#[test]
fn errors_as_printed_grow_with_the_slope() {
    let mut chance = Chance(1);
    // Below and above the exact row, for slopes up to 1, from 2 to 10 and from 10 to 50.
    let mut errors = [[0.0_f64; 2]; 3];
    for _ in 0..100_000 {
        let [x1, x2] = [chance.between(-200, -1), chance.between(0, 319)];
        let [y1, y2] = [chance.between(-3000, 3000), chance.between(-3000, 3000)];
        let slope = f64::from(y2 - y1) / f64::from(x2 - x1);
        let band = match slope.abs() {
            0.0..1.0 => 0,
            2.0..10.0 => 1,
            10.0..50.0 => 2,
            _ => continue,
        };
        let cut = clip_line([[x1, y1], [x2, y2]], Bounds::columns(320), Search::AsPrinted).expect("crosses");
        let error = f64::from(cut.start[1]) - (f64::from(y1) - slope * f64::from(x1));
        errors[band] = [errors[band][0].min(error), errors[band][1].max(error)];
    }
    let rounded = errors.map(|band| band.map(|error| (error * 10.0).round() / 10.0));
    assert_eq!(rounded, [[-4.2, 1.4], [-26.5, 24.1], [-99.0, 92.2]]);
}

/// Largest distance in y between a line cut at `x = 0` and the exact place, for lines of slopes from `from` to `to`.
fn largest_error(from: f64, to: f64, search: Search) -> f64 {
    let mut largest = 0f64;
    for left in 1..40 {
        for right in 1..40 {
            for step in 0..=20 {
                let slope = from + (to - from) * f64::from(step) / 20.0;
                let [y1, y2] = [-left, right].map(|x| (f64::from(x) * slope).round() as i32);
                let line = clip_line([[-left, y1], [right, y2]], Bounds::columns(320), search);
                let y = f64::from(line.expect("crosses").start[1]);
                let exact = f64::from(y1) + f64::from(y2 - y1) * f64::from(left) / f64::from(left + right);
                largest = largest.max((y - exact).abs());
            }
        }
    }
    largest
}

#[test]
fn steep_lines_are_cut_wrongly_as_printed_only() {
    let errors = [(0.0, 1.0), (2.0, 10.0), (10.0, 50.0)].map(|(a, b)| largest_error(a, b, Search::AsPrinted));
    assert!(errors[0] > 1.0 && errors[0] < 3.0, "{errors:?}");
    assert!(errors[1] > 8.0 && errors[1] < 21.0, "{errors:?}");
    assert!(errors[2] > 40.0 && errors[2] < 114.0, "{errors:?}");
    for search in [Search::Precise, Search::SimilarTriangles] {
        assert!(largest_error(0.0, 50.0, search) <= 0.5, "{search:?}");
    }
}

#[test]
fn the_pentagon_of_figure_4_10() {
    let pentagon = [[200, 10], [400, 110], [-80, 110], [-80, 60], [100, 10]];
    let cut = |search| clip_polygon(&pentagon, Bounds::columns(320), search);
    let expected = [[319, 69], [319, 110], [0, 110], [0, 37], [100, 10], [200, 10]];
    assert_eq!(cut(Search::AsPrinted), expected);
    // Exactly the corners lie at rows 69.5 and 37.8.
    let expected = [[319, 70], [319, 110], [0, 110], [0, 38], [100, 10], [200, 10]];
    assert_eq!(cut(Search::Precise), expected);
}

#[test]
fn corners_come_and_go() {
    let corners = |polygon: &[[i32; 2]]| clip_polygon(polygon, Bounds::columns(320), Search::Precise).len();
    // A hexagon with two corners and the edge between them outside, of which one is left: figure 4.8.
    assert_eq!(corners(&[[-20, 50], [-10, 20], [50, 10], [90, 50], [50, 90], [-10, 80]]), 5);
    // A triangle with one corner outside: figure 4.9.
    assert_eq!(corners(&[[-20, 50], [100, 10], [100, 90]]), 4);
    assert_eq!(corners(&[[-20, 50], [-10, 10], [-5, 90]]), 0);
    assert_eq!(corners(&[]), 0);
    let square = [[0, 50], [50, 50], [50, 100], [0, 100]];
    assert_eq!(clip_polygon(&square, Bounds::columns(320), Search::AsPrinted).len(), 5);
    assert_eq!(corners(&square), 4);
}

#[test]
fn all_dimensions_are_cut() {
    let line = [[0, 0, -100, 0, 64], [400, 800, 100, 256, 0]];
    let cut = clip_line(line, Bounds::beyond(50), Search::Precise).expect("crosses");
    assert_eq!(cut.start, [300, 600, 50, 192, 16]);
    assert_eq!((cut.end, cut.first_clipped), (line[1], true));
}

proptest! {
    #[test]
    fn any_line_is_cut_within_its_box(a: [i32; 3], b: [i32; 3], axis in 0usize..3, edges: [i32; 2]) {
        for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
            let bounds = Bounds { axis, min: edges[0], max: edges[1] };
            let Some(line) = clip_line([a, b], bounds, search) else { continue };
            for v in [line.start, line.end] {
                prop_assert!(v[axis] >= edges[0] && v[axis] <= edges[1]);
                prop_assert!((0..3).all(|k| v[k] >= a[k].min(b[k]) && v[k] <= a[k].max(b[k])));
            }
        }
    }

    #[test]
    fn a_polygon_gets_at_most_two_corners_an_edge(
        corners in prop::collection::vec(prop::array::uniform3(-500i32..500), 0..8), axis in 0usize..3, min in -99..99
    ) {
        let bounds = Bounds { axis, min, max: min + 200 };
        for search in [Search::AsPrinted, Search::Precise, Search::SimilarTriangles] {
            let clipped = clip_polygon(&corners, bounds, search);
            prop_assert!(clipped.len() <= 2 * corners.len());
            prop_assert!(clipped.iter().all(|c| (min..=min + 200).contains(&c[axis])));
        }
    }

    #[test]
    fn halving_precisely_is_similar_triangles(
        a in prop::array::uniform2(-50_000i32..50_000), b in prop::array::uniform2(-50_000i32..50_000)
    ) {
        let cut = |line: [[i32; 2]; 2], search| clip_line_to_screen(line, SCREEN, search);
        let (one, other) = (cut([a, b], Search::Precise), cut([a, b], Search::SimilarTriangles));
        // A row of rounding may decide whether a corner is met at all.
        if let (Some(one), Some(other)) = (one, other) {
            for (p, q) in one.iter().flatten().zip(other.iter().flatten()) {
                prop_assert!(p.abs_diff(*q) <= 1, "{one:?} {other:?}");
            }
        }
        let back = cut([b, a], Search::Precise);
        prop_assert_eq!(back, one.map(|[p, q]| [q, p]));
    }
}
