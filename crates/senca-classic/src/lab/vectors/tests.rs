use super::*;

fn near(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() < 5e-10), "{a:?} {b:?}");
}

#[test]
fn the_first_task() {
    let task = FirstTask::compute();
    assert_eq!(task.v1, [1.0, 7.0, -5.0]);
    assert_eq!(task.s, 32.0);
    assert_eq!(task.v2, [38.0, -14.0, -12.0]);
    assert_eq!(task.v2_length, 1784.0_f64.sqrt());
    near(&[task.v2_length], &[42.237_424_164]);
    near(&task.v3, &[0.899_676_075, -0.331_459_607, -0.284_108_234]);
    assert_eq!(task.v4, [-38.0, 14.0, 12.0]);
    assert_eq!(task.m1, Matrix([[0.0, 4.0, 0.0], [7.0, -1.0, 10.0], [0.0, 4.0, 4.0]]));
    assert_eq!(task.m2, Matrix([[-6.0, 22.0, 3.0], [-9.0, 29.0, 0.0], [3.0, 17.0, -18.0]]));
    let m3 = [[31.0 / 12.0, 1.25, 2.0 / 3.0], [5.0 / 3.0, 1.0, 1.0 / 3.0], [14.0 / 3.0, 2.0, 1.0 / 3.0]];
    near(task.m3.0.as_flattened(), m3.as_flattened());
    near(task.m3.multiply(&FirstTask::B).0.as_flattened(), FirstTask::A.0.as_flattened());
    assert_eq!(task.v, [3.0, 7.0, 6.0, 1.0]);
}

#[test]
fn determinants_and_inverses_of_the_constants() {
    let (a, b) = (FirstTask::A, FirstTask::B);
    assert_eq!((a.determinant(), b.determinant()), (24.0, -48.0));
    assert_eq!(a.multiply(&b).0, [[-3.0, -5.0, 20.0], [-9.0, -1.0, 10.0], [17.0, -3.0, 26.0]]);
    let of_a = [
        [-7.0 / 12.0, 13.0 / 24.0, 1.0 / 8.0],
        [5.0 / 12.0, -11.0 / 24.0, 1.0 / 8.0],
        [0.25, 1.0 / 8.0, -1.0 / 8.0],
    ];
    assert_eq!(a.inverse().map(|m| m.0), Some(of_a));
    let of_b = [
        [-1.0 / 48.0, 1.0 / 16.0, -1.0 / 6.0],
        [43.0 / 48.0, 5.0 / 16.0, 1.0 / 6.0],
        [13.0 / 48.0, 3.0 / 16.0, 1.0 / 6.0],
    ];
    assert_eq!(b.inverse().map(|m| m.0), Some(of_b));
    let of_move = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-2.0, -1.5, -3.0, 1.0]];
    assert_eq!(FirstTask::MOVE.inverse().map(|m| m.0), Some(of_move));
}

#[test]
fn angles_and_projections() {
    let (a, b) = ([2.0, 3.0, -4.0], [-1.0, 4.0, -1.0]);
    assert_eq!(dot(a, b), 14.0);
    let cosine = cosine(a, b).expect("both have a length");
    near(&[cosine], &[0.612_763_353]);
    assert!((cosine.acos().to_degrees() - 52.210_419).abs() < 5e-7);
    near(&[scalar_projection(a, b).expect("b has a length")], &[3.299_831_646]);
    near(&vector_projection(a, b).expect("b has a length"), &[-7.0 / 9.0, 28.0 / 9.0, -7.0 / 9.0]);
    assert!(scalar_projection(a, [1.0, -2.0, 0.0]).is_some_and(|s| s < 0.0));
}

#[test]
fn nothing_has_no_direction() {
    let zero = [0.0; 3];
    assert_eq!(normalized(zero), None);
    assert_eq!(normalized([f64::INFINITY, 0.0, 0.0]), None);
    assert_eq!(super::cosine(zero, [1.0; 3]), None);
    assert_eq!(scalar_projection([1.0; 3], zero), None);
    assert_eq!(vector_projection([1.0; 3], zero), None);
    assert_eq!(Matrix([[1.0, 2.0], [2.0, 4.0]]).inverse(), None);
    assert_eq!(Matrix([[0.0; 4]; 4]).inverse(), None);
    assert_eq!(Matrix([[f64::NAN; 3]; 3]).inverse(), None);
}

#[test]
fn the_vector_product_changes_its_sign_with_the_order() {
    let (a, b) = ([1.5, -2.0, 3.0], [0.25, 4.0, -1.0]);
    assert_eq!(cross(a, b), scale(cross(b, a), -1.0));
    assert_eq!(cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
}

proptest::proptest! {
    #[test]
    fn a_matrix_times_its_inverse_is_one(rows in proptest::array::uniform4(proptest::array::uniform4(-9.0f64..9.0))) {
        let matrix = Matrix(rows);
        if matrix.determinant().abs() > 1.0 {
            let one = matrix.multiply(&matrix.inverse().expect("not singular"));
            let far = one.0.as_flattened().iter().zip(Matrix::<4>::IDENTITY.0.as_flattened());
            proptest::prop_assert!(far.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-9);
        }
    }
}
