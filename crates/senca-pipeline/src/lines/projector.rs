//! From the world to the lines of a picture.

use senca_math::glam::{DVec3, DVec4};
use senca_math::{LinearRgb, View, ViewKind};
use senca_scene::{Fog, Scene};
use senca_shading::apply_fog;

use super::{Segment, SegmentKind};
use crate::settings::{Settings, WireSettings};

/// Pixels by which lines may leave the picture, so that wide ones are not cut visibly.
const MARGIN: f64 = 64.0;

/// Projects segments and cuts them by the view volume.
pub(crate) struct Projector {
    pub(crate) view: View,
    pub(crate) size: [f64; 2],
    fog: Option<Fog>,
    wire: WireSettings,
}

impl Projector {
    pub(crate) fn new(scene: &Scene, view: &View, settings: &Settings, size: [u32; 2]) -> Self {
        Self { view: *view, size: size.map(f64::from), fog: scene.fog, wire: settings.wire }
    }

    /// The visible part of the line between two places of the world; `None` when it is outside.
    pub(crate) fn segment(&self, ends_world: [DVec3; 2], kind: SegmentKind) -> Option<Segment> {
        let clip = ends_world.map(|p| self.view.clip_from_world * p.extend(1.0));
        let [t0, t1] = self.inside(clip)?;
        let at = |t: f64| clip[0] + (clip[1] - clip[0]) * t;
        let ends = [self.pixel(at(t0)), self.pixel(at(t1))];
        let worlds = [t0, t1].map(|t| ends_world[0].lerp(ends_world[1], t));
        Some(Segment {
            ends: ends.map(|p| [p.x, p.y]),
            depths: ends.map(|p| p.z),
            colors: worlds.map(|p| self.color(p, kind)),
            kind,
        })
    }

    /// Pixel coordinates and depth of a clip-space point.
    pub(crate) fn pixel(&self, clip: DVec4) -> DVec3 {
        let x = (0.5 + 0.5 * clip.x / clip.w) * self.size[0];
        let y = (0.5 - 0.5 * clip.y / clip.w) * self.size[1];
        DVec3::new(x, y, clip.z / clip.w)
    }

    fn color(&self, world: DVec3, kind: SegmentKind) -> LinearRgb {
        let color = match kind {
            SegmentKind::Edge => self.wire.color,
            SegmentKind::Normal => self.wire.normal_color,
        };
        let distance = match self.view.kind {
            ViewKind::Central { eye_world } => eye_world.distance(world),
            ViewKind::Parallel { .. } => -self.view.view_from_world.transform_point3(world).z,
        };
        self.fog.as_ref().map_or(color, |fog| apply_fog(fog, color, distance as f32))
    }

    /// Part `t0..t1` of a line that is inside the view volume, widened by the margin at the sides.
    /// Source: course text, section 2.7, with intervals of the line instead of polygons.
    fn inside(&self, [a, b]: [DVec4; 2]) -> Option<[f64; 2]> {
        let wide = self.size.map(|s| 1.0 + 2.0 * MARGIN / s);
        let planes = [
            DVec4::new(1.0, 0.0, 0.0, -wide[0]),
            DVec4::new(-1.0, 0.0, 0.0, -wide[0]),
            DVec4::new(0.0, 1.0, 0.0, -wide[1]),
            DVec4::new(0.0, -1.0, 0.0, -wide[1]),
            DVec4::new(0.0, 0.0, -1.0, 0.0),
            DVec4::new(0.0, 0.0, 1.0, -1.0),
        ];
        let mut range = [0.0f64, 1.0];
        for plane in planes {
            let (from, to) = (plane.dot(a), plane.dot(b));
            if !(from.is_finite() && to.is_finite()) || (from > 0.0 && to > 0.0) {
                return None;
            }
            if from > 0.0 {
                range[0] = range[0].max(from / (from - to));
            } else if to > 0.0 {
                range[1] = range[1].min(from / (from - to));
            }
        }
        (range[0] < range[1]).then_some(range)
    }
}
