//! Clipping in homogeneous coordinates (1991 thesis, section 2.4.4.3): what is seen has x and y in
//! [-w, w] and z in [-w, 0]. The listing clips nothing; here the front plane always cuts, so that
//! nothing behind the eye is drawn, and the others do when the volume is wanted.
//!
//! The front plane comes first and lies before the eye, so w is positive wherever the other planes
//! are asked, and the reversed inequalities of the text for w < 0 never arise.

use std::ops::{Add, Mul, Sub};

use senca_math::glam::DVec4;

/// What is interpolated: an intensity or a normal.
pub(super) trait Attribute:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>> Attribute for T {}

/// A corner in normalised homogeneous coordinates, with what is interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClipVertex<A> {
    pub(super) place: DVec4,
    pub(super) attribute: A,
}

/// Distances from the planes, positive inside: front, back, left, right, bottom, top.
const PLANES: [fn(DVec4) -> f64; 6] =
    [|p| -p.z, |p| p.w + p.z, |p| p.w + p.x, |p| p.w - p.x, |p| p.w + p.y, |p| p.w - p.y];

/// The planes that cut: all six, or the front one alone.
fn planes(whole_volume: bool) -> &'static [fn(DVec4) -> f64] {
    if whole_volume { &PLANES } else { &PLANES[..1] }
}

/// The part of a polygon inside of the volume, or before the front plane; empty when none is.
pub(super) fn clip_polygon<A: Attribute>(
    mut polygon: Vec<ClipVertex<A>>,
    whole_volume: bool,
) -> Vec<ClipVertex<A>> {
    for distance in planes(whole_volume) {
        if polygon.iter().all(|vertex| distance(vertex.place) >= 0.0) {
            continue;
        }
        let mut inside = Vec::with_capacity(polygon.len() + 1);
        for (i, &to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (d0, d1) = (distance(from.place), distance(to.place));
            if (d0 >= 0.0) != (d1 >= 0.0) {
                inside.push(between(from, to, d0 / (d0 - d1)));
            }
            if d1 >= 0.0 {
                inside.push(to);
            }
        }
        polygon = inside;
    }
    polygon
}

/// The part of a line inside of the volume, or before the front plane.
pub(super) fn clip_line(from: DVec4, to: DVec4, whole_volume: bool) -> Option<(DVec4, DVec4)> {
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for distance in planes(whole_volume) {
        let (d0, d1) = (distance(from), distance(to));
        match (d0 >= 0.0, d1 >= 0.0) {
            (false, false) => return None,
            (false, true) => start = start.max(d0 / (d0 - d1)),
            (true, false) => end = end.min(d0 / (d0 - d1)),
            (true, true) => {}
        }
    }
    (start <= end).then(|| (from.lerp(to, start), from.lerp(to, end)))
}

fn between<A: Attribute>(from: ClipVertex<A>, to: ClipVertex<A>, t: f64) -> ClipVertex<A> {
    ClipVertex {
        place: from.place.lerp(to.place, t),
        attribute: from.attribute + (to.attribute - from.attribute) * t,
    }
}

#[cfg(test)]
mod tests {
    use senca_math::glam::DVec3;
    use senca_math::{Normalization1991, View1991, ViewParameters, ViewWindow};

    use super::*;

    fn vertex(x: f64, y: f64, z: f64, attribute: f64) -> ClipVertex<f64> {
        ClipVertex { place: DVec4::new(x, y, z, 1.0), attribute }
    }

    #[test]
    fn what_is_inside_stays_as_it_is() {
        let triangle =
            vec![vertex(-1.0, -1.0, -1.0, 1.0), vertex(1.0, 0.0, 0.0, 2.0), vertex(0.0, 1.0, -0.5, 3.0)];
        assert_eq!(clip_polygon(triangle.clone(), true), triangle);
        let outside = triangle.iter().map(|v| ClipVertex { place: v.place + DVec4::X * 9.0, ..*v }).collect();
        assert!(clip_polygon(outside, true).is_empty());
    }

    #[test]
    fn a_corner_cut_off_becomes_two() {
        let triangle =
            vec![vertex(0.0, 0.0, -0.5, 0.0), vertex(2.0, 0.0, -0.5, 1.0), vertex(0.0, 0.5, -0.5, 0.0)];
        let cut = clip_polygon(triangle, true);
        assert_eq!(cut.len(), 4);
        assert!(cut.contains(&vertex(1.0, 0.0, -0.5, 0.5)) && cut.contains(&vertex(1.0, 0.25, -0.5, 0.5)));
    }

    #[test]
    fn the_back_plane_cuts_the_worked_view_just_before_its_far_end() {
        let parameters = ViewParameters {
            vrp: DVec3::new(0.0, 0.0, 54.0),
            vpn: DVec3::Z,
            vup: DVec3::Y,
            prp: DVec3::new(8.0, 6.0, 30.0),
            window: ViewWindow::new(-1.0, 17.0, -1.0, 17.0),
            front: 1.0,
            back: -23.0,
        };
        let view = View1991 { parameters, normalization: Normalization1991::Perspective };
        let m = view.steps().expect("a view").product();
        let ends = [54.0, 30.0].map(|z| m * DVec4::new(8.0, 16.0, z, 1.0));
        let (near, far) = clip_line(ends[0], ends[1], true).expect("a part of it");
        assert_eq!(near, ends[0]);
        let far_world = m.inverse() * far;
        // B lies at 54 - 23 = 31.
        assert!((far_world.z / far_world.w - 31.0).abs() < 1e-9);
        assert_eq!(clip_line(ends[0], ends[1], false).map(|(_, end)| end), Some(ends[1]));
    }

    #[test]
    fn lines_from_behind_the_eye_begin_at_the_front_plane() {
        // w = -z - 0.1 here: the eye lies at z = -0.1 beyond the front plane z = 0, w = 0.
        let (behind, before) = (DVec4::new(0.0, 0.0, 1.0, -1.0), DVec4::new(0.0, 0.0, -3.0, 3.0));
        let (from, to) = clip_line(behind, before, false).expect("a part");
        assert!(from.z.abs() < 1e-12 && to == before);
        assert_eq!(clip_line(behind, behind, false), None);
    }
}
