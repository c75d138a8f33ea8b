//! Incremental shading behind an integer z-buffer (1991 thesis, sections 7.2 to 7.5).
//!
//! The picture holds the cosine between normal and light as a colour index: 0 background, 1 turned
//! away from the light, the last one turned straight towards it. Everything else that a reflection
//! model has is a matter of the look-up table.

use senca_io::classic::{ClassicOperation, IndexBitmap, IntegerWidth};
use senca_math::glam::DVec3;

use super::clip::{Attribute, ClipVertex, clip_polygon};
use super::database::{Database, Object, Polygon};
use super::device::{SetPixel, empty_bitmap};
use super::edges::{EdgeTable, pixels};
use super::highlight::may_have_highlight;
use super::view::{DeviceView, depth_range};

/// How faces are shaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadeStyle {
    /// Width and height of the raster.
    pub(super) raster: [u32; 2],
    /// Indices from the background to the last one of a range, at least 2.
    pub(super) colors: u32,
    /// What has a range of indices of its own.
    pub(super) ranges: Ranges,
    /// After Phong, the cosine from which polygons are; those that cannot have it are shaded after Gouraud.
    pub(super) highlight: Option<f64>,
    /// Unit vector towards the light.
    pub(super) light: DVec3,
    /// Whether faces that turn their back are drawn.
    pub(super) culled: bool,
    /// Whether faces end at all planes of the volume.
    pub(super) clip: bool,
    /// Width of the depth's integers.
    pub(super) width: IntegerWidth,
    /// Whether the listing's roundings apply.
    pub(super) as_printed: bool,
}

/// What has a range of colour indices of its own, so that a look-up table can give it colours of its own: "a
/// part of the table must be reserved for every surface type" (1991 thesis, section 8.3). Range k of n, from 0,
/// has the indices 1 + k r to (k + 1) r, r being the colours but the background, divided by n. The program has
/// one range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ranges {
    /// One range for the whole scene.
    #[default]
    Scene,
    /// One for each object.
    Objects,
    /// One for each surface of each object.
    Surfaces,
}

impl Ranges {
    /// How many a scene has, at least 1.
    pub(super) fn count(self, database: &Database) -> u32 {
        let count = match self {
            Self::Scene => 1,
            Self::Objects => database.objects.len(),
            Self::Surfaces => database.objects.iter().map(|object| object.surfaces.len()).sum(),
        };
        count.max(1) as u32
    }

    /// The range of each object's first surface, and whether its surfaces have further ones.
    fn starts(self, database: &Database) -> Vec<(u32, bool)> {
        let mut next = 0;
        let start = |object: &Object| {
            let start = next;
            next += match self {
                Self::Scene => 0,
                Self::Objects => 1,
                Self::Surfaces => object.surfaces.len() as u32,
            };
            (start, self == Self::Surfaces)
        };
        database.objects.iter().map(start).collect()
    }
}

/// Draws all faces into a bitmap, after Phong or Gouraud; returns it and how many were drawn after Phong.
pub(super) fn shade(
    database: &Database,
    view: &DeviceView,
    operation: ClassicOperation,
    style: &ShadeStyle,
) -> (IndexBitmap, usize) {
    let last = f64::from(style.colors - 2);
    let light = style.light;
    let mut buffers = Buffers::new(style);
    let mut intensities = EdgeTable::new(style.raster[1]);
    let mut normals = EdgeTable::new(style.raster[1]);
    let mut after_phong = 0;
    for (object, (start, by_surface)) in database.objects.iter().zip(style.ranges.starts(database)) {
        for polygon in object.polygons.iter().filter(|polygon| style.culled || !polygon.culled) {
            let range = if by_surface { start + polygon.surface as u32 } else { start };
            let first = 1 + range * (style.colors - 1);
            let is_phong = operation != ClassicOperation::Gouraud && wants_phong(object, polygon, style);
            if is_phong {
                after_phong += 1;
                normals.enter(&on_device(object, polygon, view, style, &|normal| normal));
                let cosine = |normal: DVec3| normal.normalize_or_zero().dot(light);
                fill(&mut buffers, &mut normals, style, |normal| {
                    first + (cosine(normal) * last).max(0.0) as u32
                });
            } else {
                intensities
                    .enter(&on_device(object, polygon, view, style, &|normal: DVec3| normal.dot(light)));
                fill(&mut buffers, &mut intensities, style, |intensity: f64| {
                    first - 1 + (intensity.max(0.0) * last + 1.0) as u32
                });
            }
        }
    }
    (buffers.indices, after_phong)
}

/// Whether a polygon is shaded after Phong, where that is asked for.
fn wants_phong(object: &Object, polygon: &Polygon, style: &ShadeStyle) -> bool {
    let normals = || polygon.corners.iter().map(|corner| object.normals[corner.normal].normal);
    let test = |least| may_have_highlight(&normals().collect::<Vec<_>>(), style.light, least);
    style.highlight.is_none_or(test)
}

/// Fills the polygon that was entered last; `index` gives a pixel's colour.
fn fill<A: Attribute + Resettable>(
    buffers: &mut Buffers,
    table: &mut EdgeTable<A>,
    style: &ShadeStyle,
    index: impl Fn(A) -> u32,
) {
    for (row, left, right) in table.runs(style.as_printed) {
        let mut lowered = A::NONE;
        for (x, z, attribute) in pixels(left, right, style.raster[0], style.as_printed) {
            let attribute = if style.as_printed { attribute.reset(&mut lowered) } else { attribute };
            buffers.pixel(x, row as u32, z, || index(attribute));
        }
    }
}

/// The polygon's corners in device coordinates, clipped unless the listing is followed.
fn on_device<A: Attribute>(
    object: &Object,
    polygon: &Polygon,
    view: &DeviceView,
    style: &ShadeStyle,
    of_normal: &impl Fn(DVec3) -> A,
) -> Vec<(DVec3, A)> {
    let corner = |corner: &super::Corner| ClipVertex {
        place: view.normalized(object.vertices[corner.vertex].world),
        attribute: of_normal(object.normals[corner.normal].normal),
    };
    let mut corners = polygon.corners.iter().map(corner).collect();
    if !style.as_printed {
        corners = clip_polygon(corners, style.clip);
    }
    corners.iter().map(|vertex| (view.screen(vertex.place).truncate(), vertex.attribute)).collect()
}

/// The listing's way with intensities below 0: the running value itself becomes 0, and grows from
/// there. Normals are not touched.
trait Resettable: Sized {
    /// Nothing added yet.
    const NONE: f64 = 0.0;

    /// The value with what resets have added so far; they may add more.
    fn reset(self, added: &mut f64) -> Self;
}

impl Resettable for f64 {
    fn reset(self, added: &mut f64) -> Self {
        if self + *added < 0.0 {
            *added = -self;
        }
        self + *added
    }
}

impl Resettable for DVec3 {
    fn reset(self, _added: &mut f64) -> Self {
        self
    }
}

/// Depth and colour of each pixel.
struct Buffers {
    depth: Vec<i32>,
    indices: IndexBitmap,
    least: i32,
    greatest: i32,
    as_printed: bool,
}

impl Buffers {
    fn new(style: &ShadeStyle) -> Self {
        let indices = empty_bitmap(style.raster[0], style.raster[1]);
        let (least, greatest) = depth_range(style.width);
        let depth = vec![least; indices.indices.len()];
        Self { depth, indices, least, greatest, as_printed: style.as_printed }
    }

    /// Sets a pixel when it is nearer than what is there; of two as near the first stays.
    fn pixel(&mut self, x: u32, y: u32, z: f64, index: impl FnOnce() -> u32) {
        let place = x as usize * self.indices.height as usize + y as usize;
        let key = self.key(z);
        if key > self.depth[place] {
            self.depth[place] = key;
            self.indices.set_pixel(x as i32, y as i32, index());
        }
    }

    /// Depth as it is compared, larger in front. The listing adds the greatest integer to it, which
    /// its own depth range makes up for.
    fn key(&self, z: f64) -> i32 {
        if self.as_printed {
            let z = (z as i32).clamp(self.least, self.greatest);
            return self.wrapped(z.wrapping_add(self.greatest));
        }
        (z.floor() as i32).clamp(self.least + 1, self.greatest)
    }

    /// What an integer of the machine's width holds after an overflow.
    fn wrapped(&self, value: i32) -> i32 {
        if self.greatest == i32::from(i16::MAX) { i32::from(value as i16) } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn style(width: IntegerWidth, as_printed: bool) -> ShadeStyle {
        let (raster, colors, light) = ([2, 2], 16, DVec3::Z);
        let (ranges, highlight) = (Ranges::Scene, None);
        ShadeStyle { raster, colors, ranges, highlight, light, culled: false, clip: false, width, as_printed }
    }

    #[test]
    fn nearer_pixels_win_and_the_first_of_two_as_near() {
        for width in [IntegerWidth::Bits16, IntegerWidth::Bits32] {
            let mut buffers = Buffers::new(&style(width, false));
            for (z, index) in [(5.2, 1), (5.9, 2), (4.0, 3), (6.0, 4), (-1e30, 5)] {
                buffers.pixel(1, 0, z, || index);
            }
            buffers.pixel(0, 1, f64::NEG_INFINITY, || 6);
            buffers.pixel(0, 0, f64::NAN, || 7);
            assert_eq!(buffers.indices.indices, [7, 6, 4, 0]);
        }
    }

    #[test]
    fn the_listings_depth_saturates_and_wraps() {
        for (width, least, greatest) in [
            (IntegerWidth::Bits32, i32::MIN, i32::MAX),
            (IntegerWidth::Bits16, i32::from(i16::MIN), i32::from(i16::MAX)),
        ] {
            let buffers = Buffers::new(&style(width, true));
            assert_eq!(buffers.key(f64::from(least)), -1);
            assert_eq!(buffers.key(2.0 * f64::from(least)), -1);
            assert_eq!(buffers.key(0.0), greatest);
            assert_eq!(buffers.key(1.0), least);
        }
    }

    #[test]
    fn the_listing_resets_the_running_intensity() {
        let mut added = 0.0;
        let values = [0.5, -0.5, -1.0, -0.25, 0.0].map(|v: f64| v.reset(&mut added));
        assert_eq!(values, [0.5, 0.0, 0.0, 0.75, 1.0]);
    }
}
