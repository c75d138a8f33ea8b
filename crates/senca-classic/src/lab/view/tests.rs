#![expect(clippy::approx_constant, reason = "numbers as they are printed")]

use super::*;
use crate::lab::solid::tests::{cube, normalized_cube};
use crate::lab::vectors::{add, dot};

const EYE: Row3 = [1.0, 1.0, 3.0];
const ORIGIN: Row3 = [0.0; 3];
const UP_Y: Row3 = [0.0, 1.0, 0.0];
const UP_Z: Row3 = [0.0, 0.0, 1.0];

fn axes_view(eye: Row3, target: Row3, up: Row3) -> ViewTransform {
    ViewTransform::new(ViewMethod::Axes, eye, target, up).expect("a view")
}

fn rotations_view(eye: Row3, target: Row3) -> ViewTransform {
    ViewTransform::new(ViewMethod::Rotations, eye, target, UP_Y).expect("a view")
}

#[track_caller]
fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let far = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 6e-7, "{found:?}\n{expected:?}");
}

fn flat(matrix: &Matrix<4>) -> &[f64] {
    matrix.0.as_flattened()
}

#[test]
fn the_steps_of_the_second_method() {
    let view = rotations_view(EYE, ORIGIN);
    assert_eq!(view.distance, 11.0_f64.sqrt());
    let step = |name: &str| view.steps.iter().find(|s| s.0 == name).expect("a step").1;
    assert_eq!(step("T1").0[3], [-1.0, -1.0, -3.0, 1.0]);
    let (s, b, c) = (0.707_107, 0.426_401, -0.904_534);
    near(flat(&step("T2")), &[-s, s, 0., 0., -s, -s, 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
    near(flat(&step("T3")), &[c, 0., b, 0., 0., 1., 0., 0., -b, 0., c, 0., 0., 0., 0., 1.]);
    let t45 = step("T4").multiply(&step("T5"));
    near(flat(&t45), &[0., -1., 0., 0., -1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
    let g2 = step("T2").transform([-1.0, -1.0, -3.0, 1.0]);
    near(&g2, &[1.414_214, 0.0, -3.0, 1.0]);
    near(&step("T3").transform(g2), &[0.0, 0.0, 3.316_625, 1.0]);
    assert!((b.atan2(c).to_degrees() - 154.760_598).abs() < 1e-4);
    let (x, y, z) = (0.707_107, 0.639_602, 0.301_511);
    let rotation = [-x, -y, -z, 0.0, x, -y, -z, 0.0, 0.0, 0.426_401, -0.904_534, 0.0];
    near(&flat(&view.matrix)[..12], &rotation);
    near(&view.matrix.0[3], &[0.0, 0.0, 3.316_625, 1.0]);
}

#[test]
fn printed_in_each_others_place_sine_and_cosine_miss_the_axis() {
    let g2 = [2.0_f64.sqrt(), 0.0, -3.0];
    let h = 11.0_f64.sqrt();
    let (sb, cb) = (g2[2] / h, g2[0] / h);
    let literal = Matrix([[cb, 0.0, sb], [0.0, 1.0, 0.0], [-sb, 0.0, cb]]);
    near(&literal.transform(g2), &[-2.110_579, 0.0, -2.558_409]);
}

#[test]
fn the_axes_of_the_first_method() {
    let z = [-0.301_511, -0.301_511, -0.904_534];
    let [x, y, found_z] = axes(EYE, ORIGIN, UP_Y).expect("axes");
    near(&x, &[0.948_683, 0.0, -0.316_228]);
    near(&y, &[-0.095_346, 0.953_463, -0.286_039]);
    near(&found_z, &z);
    let raw = cross(found_z, UP_Y);
    near(&raw, &[0.904_534, 0.0, -0.301_511]);
    near(&[length(raw)], &[0.953_463]);
    let view = axes_view(EYE, ORIGIN, UP_Y);
    let expected = [
        [0.948_683, -0.095_346, -0.301_511, 0.0],
        [0.0, 0.953_463, -0.301_511, 0.0],
        [-0.316_228, -0.286_039, -0.904_534, 0.0],
        [0.0, 0.0, 3.316_625, 1.0],
    ];
    near(flat(&view.matrix), expected.as_flattened());
    let rotation = view.steps[1].1;
    assert!((rotation.determinant() + 1.0).abs() < 1e-15, "left-handed already");
    let [x, y, _] = axes(EYE, ORIGIN, UP_Z).expect("axes");
    near(&x, &[-0.707_107, 0.707_107, 0.0]);
    near(&y, &[-0.639_602, -0.639_602, 0.426_401]);
    let [x, y, _] = axes(EYE, ORIGIN, [0.0, 1.0, 1.0]).expect("axes");
    near(&x, &[0.816_497, 0.408_248, -0.408_248]);
    near(&y, &[-0.492_366, 0.861_640, -0.123_091]);
}

#[test]
fn both_methods_agree_when_up_is_z() {
    for (eye, target) in [(EYE, ORIGIN), ([3.0, 2.0, 4.0], ORIGIN), ([4.0, 5.0, 6.0], [1.0; 3])] {
        let (a, b) = (axes_view(eye, target, UP_Z), rotations_view(eye, target));
        let far = flat(&a.matrix).iter().zip(flat(&b.matrix)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-14, "{far}");
    }
}

#[test]
fn with_the_flip_depth_is_negative_and_the_picture_turned() {
    let flipped = ViewTransform::new(ViewMethod::AxesWithFlip, EYE, ORIGIN, UP_Y).expect("a view");
    near(&flipped.eye_from_scene(ORIGIN), &[0.0, 0.0, -3.316_625]);
    let plain = axes_view(EYE, ORIGIN, UP_Y);
    for v in normalized_cube().vertices {
        let (a, b) = (plain.project(v).expect("before the eye"), flipped.project(v).expect("before the eye"));
        near(&[a.x, a.y, a.z], &[-b.x, -b.y, -b.z]);
        assert_eq!(flipped.depth(flipped.eye_from_scene(v)), a.z);
    }
}

#[test]
fn an_example_of_a_rotated_system() {
    let (sin, cos) = 45.0_f64.to_radians().sin_cos();
    let rotation = Matrix([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]);
    near(&rotation.transform([2.0, 1.0, 3.0]), &[0.707_107, 2.121_320, 3.0]);
    near(&rotation.transpose().transform([0.707_107, 2.121_320, 3.0]), &[2.0, 1.0, 3.0]);
}

/// Checks the pictures of all vertices, `[xp, yp]`.
#[track_caller]
fn check(view: &ViewTransform, vertices: &[Row3], expected: &[[f64; 2]]) {
    assert_eq!(vertices.len(), expected.len());
    for (v, e) in vertices.iter().zip(expected) {
        let p = view.project(*v).expect("before the eye");
        near(&[p.x, p.y], e);
    }
}

#[test]
fn the_normalized_cube_from_the_proposed_eye() {
    let vertices = normalized_cube().vertices;
    let depths = [4.824_182, 3.015_113, 4.221_159, 2.412_091, 3.618_136, 1.809_068, 4.221_159, 2.412_091];
    let (rotations, axes) = (rotations_view(EYE, ORIGIN), axes_view(EYE, ORIGIN, UP_Y));
    for (v, depth) in vertices.iter().zip(depths) {
        near(&[rotations.eye_from_scene(*v)[2], axes.eye_from_scene(*v)[2]], &[depth, depth]);
    }
    check(
        &rotations,
        &vertices,
        &[
            [0.0, 0.586_302],
            [0.0, 1.876_166],
            [-1.111_168, -0.335_030],
            [-1.944_544, 0.586_302],
            [0.0, -1.563_472],
            [0.0, -1.563_472],
            [1.111_168, -0.335_030],
            [1.944_544, 0.586_302],
        ],
    );
    check(
        &axes,
        &vertices,
        &[
            [-0.434_813, -0.393_303],
            [-1.391_402, -1.258_571],
            [0.993_859, -0.599_319],
            [0.869_626, -1.835_415],
            [1.159_502, 1.048_809],
            [1.159_502, 1.048_809],
            [-0.496_929, 1.048_809],
            [-1.739_253, 1.048_809],
        ],
    );
}

#[test]
fn the_unit_cube_from_the_proposed_eye() {
    let vertices = cube().vertices;
    check(
        &axes_view(EYE, ORIGIN, UP_Y),
        &vertices,
        &[
            [0.0, 0.0],
            [-0.434_813, -0.393_303],
            [1.043_552, -0.104_881],
            [0.993_859, -0.599_319],
            [1.159_502, 1.048_809],
            [1.159_502, 1.048_809],
            [0.0, 1.048_809],
            [-0.496_929, 1.048_809],
        ],
    );
    check(
        &rotations_view(EYE, ORIGIN),
        &vertices,
        &[
            [0.0, 0.0],
            [0.0, 0.586_302],
            [-0.777_817, -0.703_562],
            [-1.111_168, -0.335_030],
            [0.0, -1.563_472],
            [0.0, -1.563_472],
            [0.777_817, -0.703_562],
            [1.111_168, -0.335_030],
        ],
    );
}

#[test]
fn the_cube_from_an_eye_off_its_planes() {
    let (eye, vertices) = ([3.0, 2.0, 4.0], normalized_cube().vertices);
    let [x, y, z] = axes(eye, ORIGIN, UP_Y).expect("axes");
    near(&x, &[0.8, 0.0, -0.6]);
    near(&y, &[-0.222_834, 0.928_477, -0.297_113]);
    near(&z, &[-0.557_086, -0.371_391, -0.742_781]);
    let (rotations, axes) = (rotations_view(eye, ORIGIN), axes_view(eye, ORIGIN, UP_Y));
    near(&[axes.distance], &[5.385_165]);
    let depths = [7.056_423, 5.570_860, 5.942_251, 4.456_688, 5.199_469, 3.713_907, 6.313_641, 4.828_079];
    for (v, depth) in vertices.iter().zip(depths) {
        near(&[rotations.eye_from_scene(*v)[2], axes.eye_from_scene(*v)[2]], &[depth, depth]);
    }
    check(
        &axes,
        &vertices,
        &[
            [-0.152_632, -0.311_773],
            [-1.353_333, -0.969_330],
            [1.268_750, -0.774_117],
            [0.241_667, -1.750_179],
            [1.450_000, 1.038_567],
            [0.290_000, 0.592_368],
            [-0.170_588, 1.235_420],
            [-1.561_538, 0.952_760],
        ],
    );
    check(
        &rotations,
        &vertices,
        &[
            [-0.211_662, 0.275_132],
            [-0.268_105, 1.642_934],
            [-1.256_743, -0.793_462],
            [-1.675_657, 0.560_091],
            [0.287_255, -1.760_286],
            [0.402_158, -0.522_752],
            [1.182_817, -0.395_358],
            [1.546_760, 0.976_569],
        ],
    );
    let t2 = rotations.steps[1].1.0;
    let t3 = rotations.steps[2].1.0;
    near(&[t2[1][0], t2[0][0], t3[0][2], t3[0][0]], &[-0.554_700, -0.832_050, 0.669_534, -0.742_781]);
}

#[test]
fn an_eye_on_the_z_axis() {
    let eye = [0.0, 0.0, 5.0];
    let view = axes_view(eye, ORIGIN, UP_Y);
    assert_eq!(axes(eye, ORIGIN, UP_Y).expect("axes"), [[1.0, 0.0, 0.0], UP_Y, [0.0, 0.0, -1.0]]);
    near(&view.project([1.0, 2.0, 0.0]).map(|p| [p.x, p.y]).expect("before the eye"), &[1.0, 2.0]);
    near(&view.project([1.0, 2.0, 2.5]).map(|p| [p.x, p.y]).expect("before the eye"), &[2.0, 4.0]);
    assert_eq!(view.project([1.0, 1.0, 5.0]), None, "in the plane of the eye");
    assert!(ViewTransform::new(ViewMethod::Rotations, eye, ORIGIN, UP_Y).is_err());
    for (eye, up) in [(eye, UP_Z), (eye, ORIGIN), (ORIGIN, UP_Y), ([f64::INFINITY, 0.0, 0.0], UP_Y)] {
        assert!(ViewTransform::new(ViewMethod::Axes, eye, ORIGIN, up).is_err(), "{eye:?} {up:?}");
    }
}

#[test]
fn the_perspective_matrix_is_singular() {
    let view = axes_view(EYE, ORIGIN, UP_Y);
    assert_eq!(view.perspective().inverse(), None);
    assert_eq!(view.perspective().transform([2.0, 3.0, view.distance, 1.0]), [2.0, 3.0, 0.0, 1.0]);
}

#[test]
fn lines_through_the_eye_are_cut() {
    let view = axes_view([0.0, 0.0, 5.0], ORIGIN, UP_Y);
    let line = view.project_line([1.0, 0.0, 0.0], [1.0, 0.0, 50.0]).expect("a part is seen");
    assert!(line[0] == [1.0, 0.0] || line[1] == [1.0, 0.0]);
    assert!(line.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
    assert_eq!(view.project_line([1.0, 0.0, 6.0], [0.0, 1.0, 7.0]), None);
}

#[test]
fn texts_are_read() {
    let read = |text: &str| ViewScene::read(&mut Input::new("v.txt", text));
    let scene = read("O 1 1 3\nG 0 0 1 # there\nup 0 0 1\nv 1 2 3\nv 4 5 6").expect("a scene");
    assert_eq!((scene.eye, scene.target, scene.up), (EYE, UP_Z, UP_Z));
    assert_eq!(scene.polygon, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    let told = |text: &str| read(text).expect_err(text).to_string();
    assert_eq!(told("O 1 1 3\nw 1"), "v.txt:2:1: a line begins with O, G, up or v, but not with 'w'");
    assert_eq!(told("O 1 1\nG 0"), "v.txt:2:1: z of the eye O is to be a number, but is 'G'");
    assert_eq!(told("v 1 2 3"), "v.txt:1:7: there is no line 'O x y z' with the eye");
}

proptest::proptest! {
    #[test]
    fn a_view_keeps_distances_and_its_two_points(
        eye in proptest::array::uniform3(-9.0f64..9.0),
        target in proptest::array::uniform3(-9.0f64..9.0),
        p in proptest::array::uniform3(-9.0f64..9.0),
    ) {
        for method in [ViewMethod::Axes, ViewMethod::Rotations] {
            let Ok(view) = ViewTransform::new(method, eye, target, UP_Y) else { continue };
            let h = view.distance;
            proptest::prop_assert!(length(view.eye_from_scene(eye)) < 1e-12);
            proptest::prop_assert!(length(subtract(view.eye_from_scene(target), [0.0, 0.0, h])) < 1e-11);
            let moved = subtract(view.eye_from_scene(p), view.eye_from_scene(target));
            proptest::prop_assert!((length(moved) - length(subtract(p, target))).abs() < 1e-11);
            // What lies in the picture plane keeps its size.
            let gaze = subtract(target, eye);
            let across = cross(gaze, subtract(p, eye));
            let in_plane = add(target, across);
            let flat = view.project(in_plane).expect("before the eye");
            proptest::prop_assert!((flat.x.hypot(flat.y) - length(across)).abs() < 1e-6 * (1.0 + dot(across, across)));
        }
    }
}

#[test]
fn a_distance_of_the_text() {
    near(&[axes_view([4.0, 5.0, 6.0], [1.0; 3], UP_Y).distance], &[7.071_068]);
}
