use super::*;

const EXAMPLE: [Point2; 4] = [[50.0, 200.0], [150.0, 350.0], [300.0, 150.0], [100.0, 50.0]];

fn example() -> Polygon {
    Polygon::clockwise(EXAMPLE.to_vec()).expect("convex")
}

fn span(polygon: &Polygon, y: i32) -> Span {
    *polygon.rows().iter().find(|s| s.y == y).expect("a row of the polygon")
}

#[test]
fn the_example_of_the_manual() {
    let polygon = example();
    let edges =
        [[-150.0, 100.0, -12500.0], [200.0, 150.0, -82500.0], [100.0, -200.0, 0.0], [-150.0, -50.0, 17500.0]];
    assert_eq!(polygon.edges(), edges);
    assert_eq!(polygon.orientation_values(), [-42500.0, -55000.0, -35000.0, -22500.0]);
    let cases: [(Point2, [f64; 4], Position); 8] = [
        ([150.0, 200.0], [-15000.0, -22500.0, -25000.0, -15000.0], Position::Inside),
        ([100.0, 100.0], [-17500.0, -47500.0, -10000.0, -2500.0], Position::Inside),
        ([50.0, 200.0], [0.0, -42500.0, -35000.0, 0.0], Position::Boundary),
        ([100.0, 275.0], [0.0, -21250.0, -45000.0, -11250.0], Position::Boundary),
        ([40.0, 200.0], [1500.0, -44500.0, -36000.0, 1500.0], Position::Outside),
        ([250.0, 300.0], [-20000.0, 12500.0, -35000.0, -35000.0], Position::Outside),
        ([74.0, 125.0], [-11100.0, -48950.0, -17600.0, 150.0], Position::Outside),
        ([76.0, 125.0], [-11400.0, -48550.0, -17400.0, -150.0], Position::Inside),
    ];
    for (point, values, position) in cases {
        assert_eq!((polygon.values(point), polygon.position(point)), (values.to_vec(), position));
    }
    assert_eq!(polygon.position([75.0, 125.0]), Position::Boundary);
    assert!(Position::Boundary.is_inside(), "by step 7 of the procedure");
}

#[test]
fn the_rows_of_the_example() {
    let polygon = example();
    let rows = [
        (50, 100.0, 100.0),
        (51, 99.6667, 102.0),
        (60, 96.6667, 120.0),
        (100, 83.3333, 200.0),
        (125, 75.0, 250.0),
        (150, 66.6667, 300.0),
        (151, 66.3333, 299.25),
        (200, 50.0, 262.5),
        (201, 50.6667, 261.75),
        (250, 83.3333, 225.0),
        (300, 116.6667, 187.5),
        (349, 149.3333, 150.75),
        (350, 150.0, 150.0),
    ];
    for (y, left, right) in rows {
        let span = span(&polygon, y);
        assert!((span.left - left).abs() < 5e-5 && (span.right - right).abs() < 5e-5, "{span:?}");
    }
    let spans = polygon.spans();
    assert_eq!((spans.len(), spans[0].y, spans[298].y), (299, 51, 349));
    let area: f64 = spans.iter().map(|s| s.right - s.left).sum();
    assert!((area - 38_750.0).abs() < 1e-7);
    let n = EXAMPLE.len();
    let twice = |i: usize| EXAMPLE[i][0] * EXAMPLE[(i + 1) % n][1] - EXAMPLE[(i + 1) % n][0] * EXAMPLE[i][1];
    assert_eq!((0..n).map(twice).sum::<f64>(), -77_500.0);
    let pixels = |rounding| spans.iter().map(|s| s.pixels(rounding).count()).sum::<usize>();
    assert_eq!(pixels(Rounding::Within), 38_874);
    assert_eq!(pixels(Rounding::Nearest), 39_074);
    assert_eq!(pixels(Rounding::Truncate), 39_074);
}

#[test]
fn the_other_way_round_nothing_is_inside() {
    let reversed = example().reversed();
    assert_eq!(reversed.orientation(), Orientation::CounterClockwise);
    let mut values = reversed.orientation_values();
    values.sort_by(f64::total_cmp);
    assert_eq!(values, [22500.0, 35000.0, 42500.0, 55000.0]);
    assert!(reversed.values([150.0, 200.0]).iter().all(|&v| v > 0.0));
    assert!(reversed.spans().is_empty());
    let mended = Polygon::clockwise(reversed.vertices().to_vec()).expect("convex");
    assert_eq!(mended.orientation(), Orientation::Clockwise);
    let flipped = Polygon::new(EXAMPLE.map(|[x, y]| [x, 400.0 - y]).to_vec());
    assert!(flipped.orientation_values().iter().all(|&v| v > 0.0));
}

#[test]
fn rectangle_and_triangle() {
    let rectangle =
        Polygon::clockwise(vec![[10.0, 10.0], [10.0, 20.0], [30.0, 20.0], [30.0, 10.0]]).expect("convex");
    let edges = [[-10.0, 0.0, 100.0], [0.0, 20.0, -400.0], [10.0, 0.0, -300.0], [0.0, -20.0, 200.0]];
    assert_eq!(rectangle.edges(), edges);
    let spans = rectangle.spans();
    assert_eq!((spans[0].y, spans.len()), (10, 11));
    assert!(spans.iter().all(|s| (s.left, s.right) == (10.0, 30.0)));
    let triangle = Polygon::clockwise(vec![[0.0, 0.0], [4.0, 8.0], [8.0, 0.0]]).expect("convex");
    for (span, y) in triangle.rows().iter().zip(0..) {
        let half = 0.5 * f64::from(y);
        assert_eq!(*span, Span { y, left: half, right: 8.0 - half });
    }
    assert_eq!(triangle.spans().len(), 8, "the apex is not drawn");
}

#[test]
fn what_is_not_convex_is_refused() {
    let concave = vec![[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0], [5.0, 5.0]];
    let polygon = Polygon::new(concave.clone());
    assert_eq!(polygon.orientation_values(), [-100.0, -100.0, -50.0, 50.0, -50.0]);
    assert_eq!(polygon.orientation(), Orientation::Neither);
    let rows: Vec<_> = polygon.spans().iter().map(|s| (s.y, s.left, s.right)).collect();
    assert_eq!(rows, [(6, 4.0, 6.0), (7, 3.0, 7.0), (8, 2.0, 8.0), (9, 1.0, 9.0), (10, 0.0, 10.0)]);
    let star: Vec<Point2> =
        (0..5).map(|i| f64::from(i) * -144.0_f64.to_radians()).map(|a| [a.cos(), a.sin()]).collect();
    assert!(Polygon::new(star.clone()).orientation_values().iter().all(|&v| v < 0.0));
    for wrong in [
        concave,
        star,
        vec![[0.0, 0.0], [1.0, 1.0]],
        vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        vec![[0.0, 0.0], [0.0, 0.0], [1.0, 5.0]],
        vec![],
    ] {
        assert!(Polygon::clockwise(wrong.clone()).is_err(), "{wrong:?}");
    }
}

proptest::proptest! {
    #[test]
    fn filled_pixels_are_those_inside(angles in proptest::collection::vec(0.0f64..6.2, 3..9)) {
        let mut angles = angles;
        angles.sort_by(|a, b| b.total_cmp(a));
        let vertices = angles.iter().map(|a| [(40.0 * a.cos()).round(), (40.0 * a.sin()).round()]).collect();
        if let Ok(polygon) = Polygon::clockwise(vertices) {
            for span in polygon.spans() {
                for x in span.pixels(Rounding::Within) {
                    let values = polygon.values([f64::from(x), f64::from(span.y)]);
                    proptest::prop_assert!(values.iter().all(|&v| v < 1e-9));
                }
            }
        }
    }
}
