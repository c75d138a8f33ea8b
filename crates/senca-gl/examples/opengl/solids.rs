//! Bodies of strips, with normals and texture coordinates.

use senca_gl::{Context, gl};
use std::f64::consts::TAU;

/// A surface over [0, 1] x [0, 1]: strips along v, from a point and a normal for each pair of parameters.
fn strips(c: &mut Context, steps: [u32; 2], at: impl Fn(f64, f64) -> ([f64; 3], [f64; 3])) {
    let step = |k: u32, n: u32| f64::from(k) / f64::from(n);
    for i in 0..steps[0] {
        c.begin(gl::QUAD_STRIP);
        for j in 0..=steps[1] {
            for k in [i + 1, i] {
                let (u, v) = (step(k, steps[0]), step(j, steps[1]));
                let (point, normal) = at(u, v);
                c.normal(normal);
                c.tex_coord([u, v]);
                c.vertex(point);
            }
        }
        c.end();
    }
}

/// A sphere about the origin.
pub(crate) fn sphere(c: &mut Context, radius: f64) {
    strips(c, [48, 24], |u, v| {
        let ((sin, cos), (low, high)) = ((u * TAU).sin_cos(), ((v - 0.5) * TAU / 2.0).sin_cos());
        let n = [cos * high, sin * high, low];
        (n.map(|x| x * radius), n)
    });
}

/// A torus about the z axis.
pub(crate) fn torus(c: &mut Context, radius: f64, thickness: f64) {
    strips(c, [64, 32], |u, v| {
        let ((sin, cos), (up, out)) = ((u * TAU).sin_cos(), (v * TAU).sin_cos());
        let n = [cos * out, sin * out, up];
        let ring = radius + thickness * out;
        ([cos * ring, sin * ring, thickness * up], n)
    });
}

/// A cone on the plane z = 0, without its base.
pub(crate) fn cone(c: &mut Context, radius: f64, height: f64) {
    let slant = radius.hypot(height);
    strips(c, [48, 8], |u, v| {
        let (sin, cos) = (u * TAU).sin_cos();
        let r = radius * (1.0 - v);
        ([cos * r, sin * r, v * height], [cos * height / slant, sin * height / slant, radius / slant])
    });
}

/// A square in the plane z = 0 about the origin, of `n` x `n` pieces; its texture repeats `n` times.
pub(crate) fn square(c: &mut Context, half: f64, n: u32) {
    c.normal([0.0, 0.0, 1.0]);
    let at = |k: u32| half * (2.0 * f64::from(k) / f64::from(n) - 1.0);
    for i in 0..n {
        c.begin(gl::QUAD_STRIP);
        for j in 0..=n {
            for k in [i + 1, i] {
                c.tex_coord([f64::from(k), f64::from(j)]);
                c.vertex([at(k), at(j), 0.0]);
            }
        }
        c.end();
    }
}
