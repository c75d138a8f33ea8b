//! Triangles of a flat polygon with holes, by bridging holes and clipping ears.

use senca_math::glam::DVec2;

/// Twice the signed area of a triangle.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Twice the signed area of a polygon, positive when counter-clockwise.
pub(super) fn doubled_area(points: &[DVec2]) -> f64 {
    let Some(&first) = points.first() else { return 0.0 };
    points.windows(2).map(|p| (p[0] - first).perp_dot(p[1] - first)).sum()
}

/// Triangles, counter-clockwise, of the region inside `rings[0]` and outside the others; corners are
/// numbered ring after ring. Rings may run in either direction. Outlines that cross themselves give
/// some covering, never a failure.
pub(super) fn triangulate(rings: &[Vec<DVec2>]) -> Vec<[u32; 3]> {
    let points: Vec<DVec2> = rings.iter().flatten().copied().collect();
    let mut first = 0;
    let mut loops: Vec<Vec<u32>> = Vec::new();
    for (i, ring) in rings.iter().enumerate() {
        let mut indices: Vec<u32> = (first..first + ring.len() as u32).collect();
        if (doubled_area(ring) > 0.0) != (i == 0) {
            indices.reverse();
        }
        first += ring.len() as u32;
        loops.push(indices);
    }
    let Some((outline, holes)) = loops.split_first_mut() else { return Vec::new() };
    let mut outline = std::mem::take(outline);
    let rightmost = |hole: &[u32]| hole.iter().map(|&i| points[i as usize].x).fold(f64::MIN, f64::max);
    holes.sort_by(|a, b| rightmost(b).total_cmp(&rightmost(a)));
    holes.iter().filter(|hole| hole.len() >= 3).for_each(|hole| bridge(&mut outline, hole, &points));
    clip(outline, &points)
}

/// Splices a hole into the outline through the nearest outline corner that its rightmost corner sees.
fn bridge(outline: &mut Vec<u32>, hole: &[u32], points: &[DVec2]) {
    let at = |i: u32| points[i as usize];
    let (start, _) = hole
        .iter()
        .enumerate()
        .fold((0, f64::MIN), |best, (k, &i)| if at(i).x > best.1 { (k, at(i).x) } else { best });
    let eye = at(hole[start]);
    let n = outline.len();
    let crosses = |q: DVec2| {
        (0..n).any(|k| {
            let (a, b) = (at(outline[k]), at(outline[(k + 1) % n]));
            a != q
                && b != q
                && turn(eye, q, a) * turn(eye, q, b) < 0.0
                && turn(a, b, eye) * turn(a, b, q) < 0.0
        })
    };
    let into = |k: usize| {
        let (p, c, s) = (at(outline[(k + n - 1) % n]), at(outline[k]), at(outline[(k + 1) % n]));
        if turn(p, c, s) >= 0.0 {
            turn(c, s, eye) > 0.0 && turn(p, c, eye) > 0.0
        } else {
            turn(c, s, eye) > 0.0 || turn(p, c, eye) > 0.0
        }
    };
    let mut by_distance: Vec<usize> = (0..n).collect();
    by_distance.sort_by(|&a, &b| {
        at(outline[a]).distance_squared(eye).total_cmp(&at(outline[b]).distance_squared(eye))
    });
    let seen = by_distance.iter().copied().find(|&k| into(k) && !crosses(at(outline[k])));
    let Some(k) = seen.or(by_distance.first().copied()) else { return };
    let around = (0..=hole.len()).map(|i| hole[(start + i) % hole.len()]);
    let spliced: Vec<u32> = around.chain(std::iter::once(outline[k])).collect();
    outline.splice(k + 1..k + 1, spliced);
}

/// Cuts ears off until nothing is left; when no ear is found the flattest corner goes.
fn clip(mut loop_: Vec<u32>, points: &[DVec2]) -> Vec<[u32; 3]> {
    let at = |i: u32| points[i as usize];
    let mut triangles = Vec::with_capacity(loop_.len());
    let mut k = 0;
    let mut tried = 0;
    while loop_.len() > 3 {
        let n = loop_.len();
        k %= n;
        let t = [loop_[(k + n - 1) % n], loop_[k], loop_[(k + 1) % n]];
        let [a, b, c] = t.map(at);
        let blocks = |&i: &u32| {
            let p = at(i);
            p != a && p != b && p != c && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
        };
        let is_ear = turn(a, b, c) > 0.0 && !loop_.iter().any(blocks);
        if is_ear || tried >= n {
            if turn(a, b, c) > 0.0 || !is_ear {
                triangles.push(t);
            }
            loop_.remove(k);
            tried = 0;
        } else {
            k += 1;
            tried += 1;
        }
    }
    if let [a, b, c] = loop_[..] {
        triangles.push([a, b, c]);
    }
    triangles
}
