use super::*;

/// The edges to the letter, rows as they must be meant: what the worked numbers were found with.
const FAITHFUL: Slips = Slips { one_orientation: true, ..Slips::EDGES_AS_PRINTED };

fn vertex([x, y, z, b]: [i32; 4]) -> ScreenVertex {
    ScreenVertex::new(x, y, z, b)
}

fn polygon(vertices: &[[i32; 4]]) -> Vec<ScreenVertex> {
    vertices.iter().copied().map(vertex).collect()
}

/// The polygon begun with its vertex `first`.
fn begun_at(vertices: &[ScreenVertex], first: usize) -> Vec<ScreenVertex> {
    let mut vertices = vertices.to_vec();
    vertices.rotate_left(first);
    vertices
}

fn triangle() -> Vec<ScreenVertex> {
    polygon(&[[5, 0, 10, 250], [10, 8, 90, 50], [0, 5, 40, 150]])
}

fn rectangle() -> Vec<ScreenVertex> {
    polygon(&[[2, 2, 50, 100], [12, 2, 50, 100], [12, 8, 50, 200], [2, 8, 50, 200]])
}

fn quadrilateral() -> Vec<ScreenVertex> {
    polygon(&[[20, 5, 10, 0], [60, 35, 200, 255], [35, 70, 120, 128], [5, 40, 60, 64]])
}

fn drawn(polygons: &[Vec<ScreenVertex>], slips: &Slips) -> (PolygonPicture, Vec<WriteCounts>) {
    let mut picture = PolygonPicture::new(80, 80);
    let counts = polygons.iter().map(|polygon| picture.draw(polygon, slips)).collect();
    (picture, counts)
}

/// Pixels, sum of intensities, sum of depths; ten columns further right, so that none is lost on the left.
fn sums(vertices: &[ScreenVertex], slips: &Slips) -> (u64, i64, i64) {
    let moved = vertices.iter().map(|v| ScreenVertex { x: v.x + 10, ..*v }).collect();
    let (pixels, z, b) = drawn(&[moved], slips).0.sums();
    (pixels, b, z)
}

/// The points of one edge, seen alone over more rows than it has.
fn edge(from: [i32; 4], to: [i32; 4], slips: &Slips) -> Vec<[i32; 4]> {
    edges::points_of_edge(vertex(from), vertex(to), slips)
}

#[test]
fn single_edges() {
    for (from, to, points) in [
        (
            [2, 1, 10, 100],
            [11, 4, 40, 200],
            vec![[2, 1, 10, 100], [5, 2, 20, 133], [7, 3, 27, 156], [10, 4, 37, 190], [12, 5, 44, 213]],
        ),
        (
            [11, 4, 40, 200],
            [2, 1, 10, 100],
            vec![[11, 4, 40, 200], [8, 3, 30, 166], [6, 2, 22, 143], [3, 1, 12, 109], [1, 0, 5, 86]],
        ),
        (
            [0, 0, 0, 0],
            [3, 7, 70, 210],
            vec![
                [0, 0, 0, 0],
                [0, 1, 9, 27],
                [1, 2, 20, 61],
                [1, 3, 29, 87],
                [2, 4, 41, 123],
                [2, 5, 49, 148],
                [3, 6, 61, 184],
                [3, 7, 70, 210],
            ],
        ),
        (
            [3, 7, 70, 210],
            [0, 0, 0, 0],
            vec![
                [3, 7, 70, 210],
                [3, 6, 60, 182],
                [2, 5, 49, 148],
                [2, 4, 40, 122],
                [1, 3, 28, 86],
                [1, 2, 20, 61],
                [0, 1, 8, 25],
                [0, 0, 0, 0],
            ],
        ),
        (
            [0, 0, 0, 0],
            [4, 4, 100, 200],
            vec![[0, 0, 0, 0], [1, 1, 25, 50], [2, 2, 50, 100], [3, 3, 74, 149], [4, 4, 100, 200]],
        ),
        ([2, 5, 10, 50], [8, 5, 70, 250], vec![[2, 5, 10, 50], [9, 4, 80, 285]]),
        (
            [3, 0, 10, 10],
            [3, 4, 50, 90],
            vec![[3, 0, 10, 10], [3, 1, 20, 30], [3, 2, 30, 50], [3, 3, 40, 70], [3, 4, 50, 90]],
        ),
    ] {
        assert_eq!(edge(from, to, &FAITHFUL), points, "{from:?} to {to:?}");
    }
}

#[test]
fn the_triangle_row_by_row() {
    let rows = [
        [[5, 10, 250], [5, 10, 250]],
        [[4, 15, 230], [5, 18, 228]],
        [[3, 22, 210], [6, 28, 202]],
        [[2, 28, 190], [7, 40, 173]],
        [[1, 34, 170], [7, 47, 155]],
        [[0, 40, 150], [8, 59, 126]],
        [[4, 59, 110], [9, 71, 97]],
        [[7, 74, 80], [9, 78, 79]],
        [[10, 90, 50], [10, 90, 50]],
    ];
    let sets = EdgeSets::of(&triangle(), &FAITHFUL);
    let got: Vec<_> =
        sets.rows().map(|row| [row.left, row.right].map(|point| [point.x, point.z, point.b])).collect();
    assert_eq!(got, rows);
    assert_eq!(sums(&triangle(), &FAITHFUL), (39, 5903, 1774));
    assert_eq!(sums(&begun_at(&triangle(), 1), &FAITHFUL), (39, 5903, 1774));
    let (picture, _) = drawn(&[triangle()], &FAITHFUL);
    let row = |y: i32, from: i32, to: i32| (from..=to).filter_map(|x| picture.get(x, y)).collect::<Vec<_>>();
    let row_5 =
        [(40, 150), (42, 147), (44, 144), (47, 141), (49, 138), (51, 135), (54, 132), (56, 129), (59, 126)];
    assert_eq!(row(5, 0, 8), row_5);
    assert_eq!(row(3, 2, 7), [(28, 190), (30, 186), (32, 183), (35, 179), (37, 176), (40, 173)]);
}

#[test]
fn the_triangles_slips() {
    let last_begun = begun_at(&triangle(), 2);
    let row = |slips: &Slips, y: i32| {
        let sets = EdgeSets::of(&last_begun, slips);
        let left = sets.rows().find(|row| row.y == y).map(|row| row.left);
        left.map(|point| [point.x, point.z, point.b])
    };
    assert_eq!(row(&FAITHFUL, 4), Some([-1, 33, 162]));
    assert_eq!(row(&FAITHFUL, 5), Some([2, 49, 131]));
    assert_eq!(sums(&last_begun, &FAITHFUL), (39, 5845, 1784));
    let no_extra = Slips { extra_pass: false, ..FAITHFUL };
    assert_eq!(row(&no_extra, 4), Some([1, 34, 170]));
    assert_eq!(row(&no_extra, 5), Some([2, 49, 131]));
    assert_eq!(sums(&last_begun, &no_extra), (37, 5558, 1708));
    let reversed: Vec<_> = triangle().into_iter().rev().collect();
    let (picture, _) = drawn(&[reversed], &FAITHFUL);
    assert_eq!((picture.sums().0, picture.get(5, 0)), (1, Some((10, 250))));
    assert_eq!(sums(&triangle(), &Slips::AS_PRINTED), (39, 0, 0));
    let (picture, _) = drawn(&[triangle()], &Slips { single_pixels: true, ..FAITHFUL });
    assert_eq!((picture.get(5, 0), picture.get(10, 8)), (Some((0, 0)), Some((0, 0))));
}

#[test]
fn the_rectangle_and_its_slips() {
    assert_eq!(sums(&rectangle(), &FAITHFUL).0, 77);
    assert_eq!(sums(&rectangle(), &FAITHFUL).1, 11_527);
    let (picture, _) = drawn(&[rectangle()], &FAITHFUL);
    let by_row: Vec<_> = (2..=8).map(|y| picture.get(7, y)).collect();
    assert_eq!(by_row, [100, 116, 133, 150, 166, 183, 200].map(|b| Some((50, b))));
    let begun = begun_at(&rectangle(), 3);
    let (picture, _) = drawn(std::slice::from_ref(&begun), &FAITHFUL);
    assert_eq!((picture.get(11, 8), picture.get(12, 8).map(|p| p.1)), (None, Some(200)));
    assert_eq!((picture.get(0, 7), picture.get(1, 7).map(|p| p.1)), (None, Some(200)));
    assert_eq!((sums(&begun, &FAITHFUL).0, sums(&begun, &FAITHFUL).1), (68, 9807));
    let no_extra = Slips { extra_pass: false, ..FAITHFUL };
    assert_eq!((sums(&begun, &no_extra).0, sums(&begun, &no_extra).1), (67, 9527));
    for first in 0..4 {
        let begun = begun_at(&rectangle(), first);
        let sound = sums(&begun, &Slips { lost_units: true, ..Slips::MENDED });
        assert_eq!((sound.0, sound.1), (77, 11_527), "from any vertex");
        assert_eq!(sums(&begun, &Slips::MENDED).1, 11_528, "with the unit that one pixel loses");
    }
}

#[test]
fn the_nearer_polygon_hides_the_other() {
    let front = polygon(&[[4, 0, 20, 255], [15, 5, 80, 60], [4, 10, 20, 255]]);
    let right: Vec<i32> = EdgeSets::of(&front, &FAITHFUL).rows().map(|row| row.right.x).collect();
    assert_eq!(right, [4, 6, 8, 10, 12, 15, 13, 11, 9, 7, 5]);
    assert_eq!(sums(&front, &FAITHFUL).0, 67);
    for slips in [FAITHFUL, Slips { lost_units: true, ..Slips::MENDED }] {
        let (one, counts) = drawn(&[rectangle(), front.clone()], &slips);
        assert_eq!(counts.iter().map(|c| c.written).collect::<Vec<_>>(), [77, 55]);
        let (other, counts) = drawn(&[front.clone(), rectangle()], &slips);
        assert_eq!(counts.iter().map(|c| c.written).collect::<Vec<_>>(), [67, 36]);
        assert_eq!(one, other);
        assert_eq!(one.sums(), (91, 3687, 16_702));
        let row = |y: i32| (0..17).filter_map(|x| one.get(x, y).map(|(z, b)| (x, z, b))).collect::<Vec<_>>();
        assert_eq!(
            row(5),
            [
                (2, 50, 150),
                (3, 50, 150),
                (4, 20, 255),
                (5, 25, 237),
                (6, 30, 219),
                (7, 36, 201),
                (8, 41, 184),
                (9, 47, 166),
                (10, 50, 150),
                (11, 50, 150),
                (12, 50, 150),
                (13, 69, 95),
                (14, 74, 77),
                (15, 80, 60)
            ]
        );
        let back = |xs: &[i32], b: i32| xs.iter().map(|&x| (x, 50, b)).collect::<Vec<_>>();
        let triangle_2 = vec![(4, 20, 255), (5, 25, 236), (6, 31, 218), (7, 36, 200), (8, 42, 182)];
        assert_eq!(row(2), [back(&[2, 3], 100), triangle_2, back(&[9, 10, 11, 12], 100)].concat());
        let triangle_8 =
            vec![(4, 20, 255), (5, 25, 237), (6, 30, 220), (7, 35, 202), (8, 40, 185), (9, 46, 168)];
        assert_eq!(row(8), [back(&[2, 3], 200), triangle_8, back(&[10, 11, 12], 200)].concat());
    }
}

#[test]
fn the_quadrilateral_and_its_slip() {
    for first in [0, 2, 3] {
        assert_eq!(sums(&begun_at(&quadrilateral(), first), &FAITHFUL), (1904, 239_604, 203_492));
    }
    let corrupted = sums(&begun_at(&quadrilateral(), 1), &FAITHFUL);
    assert_eq!((corrupted.0, corrupted.1), (1905, 240_039));
    let sets = EdgeSets::of(&quadrilateral(), &FAITHFUL);
    let row = |y: i32| {
        let row = sets.rows().find(|row| row.y == y).expect("a row");
        [row.left, row.right].map(|point| [point.x, point.z, point.b])
    };
    assert_eq!(row(20), [[13, 31, 27], [40, 105, 127]]);
    assert_eq!(row(35), [[7, 52, 54], [60, 200, 255]]);
    assert_eq!(row(41), [[6, 62, 66], [56, 186, 233]]);
    assert_eq!(row(55), [[20, 90, 96], [46, 154, 182]]);
    let (picture, _) = drawn(&[quadrilateral()], &FAITHFUL);
    for (x, y, expected) in [
        (20, 20, (50, 52)),
        (30, 35, (116, 141)),
        (40, 40, (146, 180)),
        (10, 45, (70, 74)),
        (35, 60, (124, 140)),
    ] {
        assert_eq!(picture.get(x, y), Some(expected), "({x}, {y})");
    }
}

#[test]
fn mended_polygons_do_not_depend_on_their_list() {
    for vertices in [triangle(), rectangle(), quadrilateral()] {
        let (picture, _) = drawn(std::slice::from_ref(&vertices), &Slips::MENDED);
        for first in 0..vertices.len() {
            let begun = begun_at(&vertices, first);
            assert_eq!(drawn(std::slice::from_ref(&begun), &Slips::MENDED).0, picture);
            let reversed = begun.into_iter().rev().collect::<Vec<_>>();
            assert_eq!(drawn(&[reversed], &Slips::MENDED).0, picture);
        }
        // Nothing but the lost units changes against the letter, begun with the first vertex.
        let faithful = drawn(std::slice::from_ref(&vertices), &FAITHFUL).0;
        for (x, y) in (0..80).flat_map(|y| (0..80).map(move |x| (x, y))) {
            let (a, b) = (picture.get(x, y), faithful.get(x, y));
            assert_eq!(a.is_some(), b.is_some(), "({x}, {y})");
            let near = |(a, b): ((i32, i32), (i32, i32))| a.0.abs_diff(b.0) <= 1 && a.1.abs_diff(b.1) <= 1;
            assert!(a.zip(b).is_none_or(near), "({x}, {y}) {a:?} {b:?}");
        }
    }
}
