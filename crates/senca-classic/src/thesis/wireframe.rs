//! Edges of polygons, and normals of vertices, as lines of pixels (1991 thesis, section 3).
//!
//! Both ends of an edge are cut off to whole pixels and joined by Bresenham's line, ends included, as
//! the line primitive of a PC of the time does it.

use senca_math::glam::{DVec2, DVec4};

use super::clip::clip_line;
use super::database::{Database, Object, Polygon};
use super::device::SetPixel;
use super::view::DeviceView;

/// Length of a drawn normal as a share of the window's width.
const NORMAL_LENGTH: f64 = 1.0 / 30.0;

/// Lines are cut off this many pixels outside of the raster, before they become pixels.
const GUARD: f64 = 64.0;

/// Which normals a wireframe with normals shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalsDrawn {
    /// All normals of the vertices around visible polygons: method 1.
    OfVisibleVertices,
    /// The normals that belong to polygons' corners, of culled polygons too: method 2, the program's.
    #[default]
    OfPolygons,
}

/// How edges are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct WireStyle {
    /// Colour index of lines.
    pub(super) index: u32,
    /// Width and height of the raster.
    pub(super) raster: [u32; 2],
    /// Whether edges of polygons that turn their back are drawn.
    pub(super) culled: bool,
    /// Whether lines end at all planes of the volume.
    pub(super) clip: bool,
}

/// Draws the edges of all polygons that are seen.
pub(super) fn draw_wireframe(
    device: &mut dyn SetPixel,
    database: &Database,
    view: &DeviceView,
    style: &WireStyle,
) {
    for (object, polygon) in polygons(database).filter(|(_, p)| style.culled || !p.culled) {
        let corners = &polygon.corners;
        for (i, corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let ends = [corner.vertex, next.vertex].map(|v| view.normalized(object.vertices[v].world));
            draw_line(device, ends, view, style);
        }
    }
}

/// Draws vertex normals, a thirtieth of the window's width long in the world.
pub(super) fn draw_normals(
    device: &mut dyn SetPixel,
    database: &Database,
    view: &DeviceView,
    style: &WireStyle,
    window_width: f64,
    which: NormalsDrawn,
) {
    let mut draw = |object: &Object, normal: usize| {
        let record = &object.normals[normal];
        let foot = object.vertices[record.vertex].world;
        let tip = foot + record.normal * (window_width * NORMAL_LENGTH);
        draw_line(device, [view.normalized(foot), view.normalized(tip)], view, style);
    };
    for (object, polygon) in polygons(database) {
        for corner in &polygon.corners {
            match which {
                NormalsDrawn::OfPolygons => draw(object, corner.normal),
                NormalsDrawn::OfVisibleVertices if !polygon.culled || style.culled => {
                    object.vertices[corner.vertex].normals.iter().for_each(|&n| draw(object, n));
                }
                NormalsDrawn::OfVisibleVertices => {}
            }
        }
    }
}

fn polygons(database: &Database) -> impl Iterator<Item = (&Object, &Polygon)> {
    database.objects.iter().flat_map(|object| object.polygons.iter().map(move |polygon| (object, polygon)))
}

fn draw_line(device: &mut dyn SetPixel, ends: [DVec4; 2], view: &DeviceView, style: &WireStyle) {
    let Some((from, to)) = clip_line(ends[0], ends[1], style.clip) else { return };
    let ends = [from, to].map(|end| view.screen(end).truncate().truncate());
    let Some(ends) = near_raster(ends, style.raster) else { return };
    let [from, to] = ends.map(|end| [end.x as i32, end.y as i32]);
    line(device, from, to, style.index);
}

/// The part of a line within the raster and a margin around it (Liang and Barsky 1984); `None` when
/// there is none, or it is not finite.
fn near_raster([from, to]: [DVec2; 2], raster: [u32; 2]) -> Option<[DVec2; 2]> {
    let highest = DVec2::new(f64::from(raster[0]), f64::from(raster[1])) + GUARD;
    let (mut start, mut end) = (0.0f64, 1.0f64);
    let along = to - from;
    for axis in 0..2 {
        for (toward, room) in [(-along[axis], from[axis] + GUARD), (along[axis], highest[axis] - from[axis])]
        {
            if toward < 0.0 {
                start = start.max(room / toward);
            } else if toward > 0.0 {
                end = end.min(room / toward);
            } else if room.is_nan() || room < 0.0 {
                return None;
            }
        }
    }
    let whole = start == 0.0 && end == 1.0;
    let part = if whole { [from, to] } else { [from + along * start, from + along * end] };
    (start <= end && part.iter().all(|p| p.is_finite())).then_some(part)
}

/// Bresenham's line with both ends.
fn line(device: &mut dyn SetPixel, [mut x, mut y]: [i32; 2], to: [i32; 2], index: u32) {
    let (dx, dy) = ((to[0] - x).abs(), -(to[1] - y).abs());
    let step = [(to[0] - x).signum(), (to[1] - y).signum()];
    let mut error = dx + dy;
    loop {
        device.set_pixel(x, y, index);
        if [x, y] == to {
            return;
        }
        let twice = 2 * error;
        if twice >= dy {
            error += dy;
            x += step[0];
        }
        if twice <= dx {
            error += dx;
            y += step[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use senca_io::classic::IndexBitmap;

    use super::super::device::empty_bitmap;
    use super::*;

    fn count(bitmap: &IndexBitmap) -> usize {
        bitmap.indices.iter().filter(|&&i| i != 0).count()
    }

    #[test]
    fn lines_have_both_ends_and_a_pixel_per_step() {
        for (to, pixels) in [([9, 4], 8), ([3, 9], 8), ([2, 2], 1), ([2, 9], 8), ([0, 0], 3), ([9, 0], 8)] {
            let mut bitmap = empty_bitmap(10, 10);
            line(&mut bitmap, [2, 2], to, 7);
            assert_eq!(count(&bitmap), pixels, "{to:?}");
            assert_eq!(bitmap.get(2, 2), Some(7));
            assert_eq!(bitmap.get(to[0] as u32, to[1] as u32), Some(7));
        }
    }

    #[test]
    fn endless_lines_are_cut_off_beside_the_raster() {
        let far = near_raster([DVec2::new(-1e30, 5.0), DVec2::new(1e30, 5.0)], [10, 10]).expect("a part");
        assert!(far.iter().all(|p| p.x.abs() < 80.0 && (p.y - 5.0).abs() < 1e-9));
        assert_eq!(near_raster([DVec2::new(-1e30, 1e9), DVec2::new(1e30, 1e9)], [10, 10]), None);
        assert_eq!(near_raster([DVec2::NAN, DVec2::ONE], [10, 10]), None);
        let inside = [DVec2::new(0.3, 0.7), DVec2::new(9.1, 9.9)];
        assert_eq!(near_raster(inside, [10, 10]), Some(inside));
    }
}
