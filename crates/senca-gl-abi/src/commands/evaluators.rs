//! Evaluators.

use crate::memory::{Few, In, Plain};
use senca_gl::{Component, Context, map_components};

/// How many numbers a map's control points reach over; 0 where the numbers make no map.
fn reach(components: Option<usize>, strides: &[i32], orders: &[i32]) -> i32 {
    let Some(components) = components.and_then(|k| i32::try_from(k).ok()) else { return 0 };
    let along = |(stride, order): (&i32, &i32)| {
        let valid = *stride >= components && (1..=senca_gl::MAX_EVAL_ORDER as i32).contains(order);
        if valid { stride.checked_mul(order - 1) } else { None }
    };
    let axes: Option<Vec<i32>> = strides.iter().zip(orders).map(along).collect();
    axes.and_then(|axes| axes.into_iter().try_fold(components, i32::checked_add)).unwrap_or(0)
}

fn points<T: Component + Plain>(target: u32, strides: &[i32], orders: &[i32], points: In<T>) -> Few<f32> {
    let n = reach(map_components(target), strides, orders);
    points.values(n).unwrap_or_default().into_iter().map(T::value).collect()
}

fn map1<T: Component + Plain>(c: &mut Context, target: u32, u: [T; 2], stride: i32, order: i32, p: In<T>) {
    c.map1(target, u.map(T::value), stride, order, &points(target, &[stride], &[order], p));
}

fn map2<T: Component + Plain>(
    c: &mut Context,
    target: u32,
    u: [T; 2],
    v: [T; 2],
    stride: [i32; 2],
    order: [i32; 2],
    p: In<T>,
) {
    let points = points(target, &stride, &order, p);
    c.map2(target, u.map(T::value), v.map(T::value), stride, order, &points);
}

commands! { COMMANDS, c:
    glMap1f(target: u32, u1: f32, u2: f32, stride: i32, order: i32, points: In<f32>) {
        map1(c, target, [u1, u2], stride, order, points)
    }
    glMap1d(target: u32, u1: f64, u2: f64, stride: i32, order: i32, points: In<f64>) {
        map1(c, target, [u1, u2], stride, order, points)
    }
    glMap2f(
        target: u32, u1: f32, u2: f32, stride: i32, order: i32,
        v1: f32, v2: f32, v_stride: i32, v_order: i32, points: In<f32>
    ) {
        map2(c, target, [u1, u2], [v1, v2], [stride, v_stride], [order, v_order], points)
    }
    glMap2d(
        target: u32, u1: f64, u2: f64, stride: i32, order: i32,
        v1: f64, v2: f64, v_stride: i32, v_order: i32, points: In<f64>
    ) {
        map2(c, target, [u1, u2], [v1, v2], [stride, v_stride], [order, v_order], points)
    }
    glMapGrid1f(n: i32, u1: f32, u2: f32) { c.map_grid1(n, [u1, u2]) }
    glMapGrid1d(n: i32, u1: f64, u2: f64) { c.map_grid1(n, [u1, u2].map(|v| v as f32)) }
    glMapGrid2f(n: i32, u1: f32, u2: f32, m: i32, v1: f32, v2: f32) {
        c.map_grid2([n, m], [u1, u2], [v1, v2])
    }
    glMapGrid2d(n: i32, u1: f64, u2: f64, m: i32, v1: f64, v2: f64) {
        c.map_grid2([n, m], [u1, u2].map(|v| v as f32), [v1, v2].map(|v| v as f32))
    }
    glEvalCoord1f(u: f32) { c.eval_coord1(u) }
    glEvalCoord1d(u: f64) { c.eval_coord1(u as f32) }
    glEvalCoord1fv(u: In<f32>) { if let Some([u]) = u.array() { c.eval_coord1(u) } }
    glEvalCoord1dv(u: In<f64>) { if let Some([u]) = u.array() { c.eval_coord1(u as f32) } }
    glEvalCoord2f(u: f32, v: f32) { c.eval_coord2([u, v]) }
    glEvalCoord2d(u: f64, v: f64) { c.eval_coord2([u as f32, v as f32]) }
    glEvalCoord2fv(u: In<f32>) { if let Some(u) = u.array() { c.eval_coord2(u) } }
    glEvalCoord2dv(u: In<f64>) { if let Some(u) = u.array::<2>() { c.eval_coord2(u.map(|v| v as f32)) } }
    glEvalPoint1(i: i32) { c.eval_point1(i) }
    glEvalPoint2(i: i32, j: i32) { c.eval_point2([i, j]) }
    glEvalMesh1(mode: u32, i1: i32, i2: i32) { c.eval_mesh1(mode, i1, i2) }
    glEvalMesh2(mode: u32, i1: i32, i2: i32, j1: i32, j2: i32) { c.eval_mesh2(mode, [i1, i2], [j1, j2]) }
}
