#![expect(clippy::approx_constant, reason = "numbers as they are printed")]

use super::*;
use crate::lab::bezier::visible_faces;
use crate::lab::solid::tests::normalized_cube;
use crate::lab::view::{ViewMethod, ViewTransform};

const EYE: Row3 = [3.0, 2.0, 4.0];

#[track_caller]
fn near(found: &[f64], expected: &[f64], room: f64) {
    assert_eq!(found.len(), expected.len());
    let far = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far <= room, "{found:?}\n{expected:?}");
}

fn from_one(faces: &[usize]) -> Vec<usize> {
    faces.iter().map(|i| i + 1).collect()
}

#[test]
fn which_faces_are_seen() {
    let cube = normalized_cube();
    let proposed = [-8.0, -8.0, 0.0, 0.0, 0.0, 0.0, -8.0, -8.0, -16.0, -16.0, 8.0, 8.0];
    assert_eq!(view_values(&cube, [1.0, 1.0, 3.0]), proposed);
    let other = [-12.0, -12.0, 8.0, 8.0, 4.0, 4.0, -16.0, -16.0, -20.0, -20.0, 12.0, 12.0];
    assert_eq!(view_values(&cube, EYE), other);
    let seen = |eye| from_one(&visible_faces(&cube, eye));
    assert_eq!(seen([1.0, 1.0, 3.0]), [11, 12]);
    assert_eq!(seen(EYE), [3, 4, 5, 6, 11, 12]);
    assert_eq!(seen([1.01, 1.01, 3.0]), [3, 4, 5, 6, 11, 12]);
    assert_eq!(seen([0.0, 0.0, 5.0]), [11, 12]);
    near(&view_values(&cube, [1.01, 1.01, 3.0])[2..6], &[0.04; 4], 1e-14);
    assert_eq!(view_values(&cube, [0.0, 0.0, 5.0])[..8], [-4.0; 8]);
    let angles = [
        118.755, 123.492, 67.885, 63.593, 78.881, 78.591, 130.747, 132.625, 144.676, 143.301, 49.747, 51.166,
    ];
    near(&view_angles(&cube, EYE), &angles, 5.1e-4);
}

#[test]
fn the_test_in_the_picture_agrees_with_the_test_in_the_scene() {
    let cube = normalized_cube();
    let expected = visible_faces(&cube, EYE);
    for method in [ViewMethod::Axes, ViewMethod::AxesWithFlip, ViewMethod::Rotations] {
        let view = ViewTransform::new(method, EYE, [0.0; 3], [0.0, 1.0, 0.0]).expect("a view");
        let flat: Vec<[f64; 2]> = cube
            .vertices
            .iter()
            .map(|&v| view.project(v).map(|p| [p.x, p.y]).expect("before the eye"))
            .collect();
        let seen = |sign: f64| -> Vec<usize> {
            let corners =
                |face: &[usize]| face.iter().map(|&i| [flat[i][0], sign * flat[i][1]]).collect::<Vec<_>>();
            (0..12).filter(|&i| !is_back_in_picture(&corners(&cube.faces[i]))).collect()
        };
        assert_eq!(seen(1.0), expected, "{method:?}");
        let others: Vec<usize> = (0..12).filter(|i| !expected.contains(i)).collect();
        assert_eq!(seen(-1.0), others, "with y downwards it is the other faces");
    }
}

#[test]
fn the_test_in_the_picture_misses_a_star() {
    let star = [
        [0.0, 8.0],
        [2.0, 2.0],
        [8.0, 0.0],
        [2.0, -2.0],
        [0.0, -8.0],
        [-2.0, -2.0],
        [-8.0, 0.0],
        [-2.0, 2.0],
    ];
    assert!(!is_back_in_picture(&star), "clockwise, but no side lies on its hull");
    assert!(is_back_in_picture(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]));
    assert!(is_back_in_picture(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), "edge-on");
    assert!(!is_back_in_picture(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
}

#[test]
fn normals_of_vertices() {
    let cube = normalized_cube();
    let averages = [
        [-0.4, -0.2, -0.4],
        [-0.2, -0.4, 0.4],
        [0.25, -0.5, -0.25],
        [0.5, -0.25, 0.25],
        [0.4, 0.2, -0.4],
        [0.2, 0.4, 0.4],
        [-0.25, 0.5, -0.25],
        [-0.5, 0.25, 0.25],
    ];
    near(average_normals(&cube).as_flattened(), averages.as_flattened(), 1e-15);
    let (two, one) = (0.666_667, 0.333_333);
    let (a, b) = (0.408_248, 0.816_497);
    let units = [
        [-two, -one, -two],
        [-one, -two, two],
        [a, -b, -a],
        [b, -a, a],
        [two, one, -two],
        [one, two, two],
        [-a, b, -a],
        [-b, a, a],
    ];
    near(vertex_normals(&cube).as_flattened(), units.as_flattened(), 5.1e-7);
}

#[test]
fn intensities_of_the_cube() {
    let (cube, light) = (normalized_cube(), Light::default());
    let mut expected = [50.0; 12];
    let lit = [(3, 70.6751), (4, 73.4495), (5, 116.6353), (6, 120.3486), (11, 167.2477), (12, 170.7571)];
    lit.iter().for_each(|&(face, v)| expected[face - 1] = v);
    near(&light.face_intensities(&cube), &expected, 5.1e-5);
    let cosines: Vec<f64> =
        cube.faces.iter().zip(cube.normals()).map(|(f, n)| light.cosine(cube.center_of(f), n)).collect();
    let expected = [
        -0.595_257, -0.646_096, 0.129_219, 0.146_560, 0.416_470, 0.439_679, -0.379_305, -0.387_657,
        -0.833_360, -0.849_569, 0.732_798, 0.754_732,
    ];
    near(&cosines, &expected, 5.1e-7);
    let mut expected = [50.0; 8];
    [(3, 68.2932), (5, 203.2546), (7, 69.9223)].iter().for_each(|&(v, i)| expected[v] = i);
    near(&light.vertex_intensities(&cube), &expected, 5.1e-5);
    let cosines: Vec<f64> =
        cube.vertices.iter().zip(vertex_normals(&cube)).map(|(&v, n)| light.cosine(v, n)).collect();
    let expected =
        [-0.914_702, -0.130_189, -0.754_247, 0.114_332, -0.390_567, 0.957_841, -0.199_502, 0.124_515];
    near(&cosines, &expected, 5.1e-7);
    let greatest = light.ambient * light.ambient_share + light.intensity * light.diffuse_share;
    assert_eq!(greatest, 210.0);
}

#[test]
fn the_whole_model() {
    let root = 0.5_f64.sqrt();
    let (n, l, v) = ([0.0, 0.0, 1.0], [root, 0.0, root], [0.0, 0.0, 1.0]);
    let r = mirrored(n, l);
    near(&r, &[-0.707_107, 0.0, 0.707_107], 5e-7);
    for (exponent, expected) in [(1.0, 0.707_107), (4.0, 0.25), (10.0, 0.03125)] {
        near(&[dot(r, v).powf(exponent)], &[expected], 5e-7);
    }
    let model = PhongModel {
        ambient: 100.0,
        ambient_share: 0.5,
        intensity: 200.0,
        diffuse_share: 0.5,
        specular_share: 0.3,
        exponent: 10.0,
    };
    near(&[model.reflected(n, l, v)], &[122.585_678], 5e-7);
    near(&[model.reflected_at(n, l, v, 4.0, 1.0)], &[64.517_136], 5e-7);
    let aside = [1.0, 0.0, 0.0];
    near(&[dot(r, aside), dot(r, aside).powi(10)], &[-0.707_107, 0.03125], 5e-7);
    let matt = PhongModel { specular_share: 0.0, ..model };
    assert_eq!(model.reflected(n, l, aside), matt.reflected(n, l, aside), "no highlight behind");
}

#[test]
fn too_bright() {
    let values = [120.0, 260.0, 310.0];
    assert_eq!(displayed(&values, Overflow::Clamp), [120.0, 255.0, 255.0]);
    near(&displayed(&values, Overflow::ScaleToMaximum), &[98.71, 213.87, 255.0], 5e-3);
    near(&displayed(&values, Overflow::Stretch), &[0.0, 187.89, 255.0], 5e-3);
    assert_eq!(displayed(&[10.0, 20.0], Overflow::ScaleToMaximum), [10.0, 20.0]);
    assert_eq!(displayed(&[10.0, 10.0], Overflow::Stretch), [10.0, 10.0]);
}

#[test]
fn minimax() {
    let extent = |points: &[[f64; 2]]| Extent::of(points).expect("points");
    let a = extent(&[[0.0, 0.0], [2.0, 1.0], [1.0, 3.0]]);
    assert_eq!(a, Extent { low: [0.0, 0.0], high: [2.0, 3.0] });
    assert!(a.overlaps(&extent(&[[1.0, 1.0], [5.0, 5.0]])));
    assert!(!a.overlaps(&extent(&[[2.0, 0.0], [5.0, 5.0]])), "touching");
    assert!(!a.overlaps(&extent(&[[0.0, 4.0], [5.0, 5.0]])));
    assert_eq!(Extent::of(&[]), None);
}

#[test]
fn shaded_pictures_show_the_intensities() {
    let solid = normalized_cube();
    let camera = Camera::default();
    let mut counts = Vec::new();
    for mode in [Mode::Wire, Mode::WireFront, Mode::Constant, Mode::Gouraud] {
        let mut canvas = senca_window::Canvas::new(200, 200);
        let picture = SolidPicture { solid: &solid, light: Light::default(), mode, half_height: 2.0 };
        picture.draw(&mut canvas, &camera).expect("drawn");
        let mut reds: Vec<u32> = canvas.pixels().iter().map(|p| p >> 16).filter(|&r| r > 0).collect();
        counts.push(reds.len());
        reds.sort_unstable();
        reds.dedup();
        match mode {
            Mode::Constant => assert_eq!(reds, [71, 73, 117, 120, 167, 171]),
            Mode::Gouraud => assert!(reds.len() > 100 && reds[0] >= 50 && reds[reds.len() - 1] <= 203),
            _ => assert_eq!(reds, [255]),
        }
    }
    assert!(counts[0] > counts[1], "edges behind are left out");
    assert_eq!(counts[2], counts[3]);
}
