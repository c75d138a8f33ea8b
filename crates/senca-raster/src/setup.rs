//! From clip space to the fixed-point screen, and the set-up of a triangle. Shared by both
//! rasterizers, so that they cover the same pixels with the same depths.
//!
//! Screen coordinates are integers of 1/256 pixel about a pixel near the middle of the target. With
//! +-2^15 pixels that is +-2^23 units, every one of which `f32` holds exactly; differences stay within
//! 2^24 and products of two differences within 2^48.

use crate::api::{Cull, Interpolation, Rect, State, Viewport};
use crate::clip::{Polygon, VIEW_VOLUME, clip_triangle, wholly_outside};
use senca_math::glam::Vec4;

/// Fixed-point units per pixel, as a power of two.
pub(crate) const SUB_BITS: u32 = 8;
/// Fixed-point units per pixel.
pub(crate) const SUB: i32 = 1 << SUB_BITS;
/// Offset of a pixel's centre.
pub(crate) const HALF: i32 = SUB / 2;
/// Screen coordinates beyond this are clipped, in fixed-point units: 2^23 less a rim for rounding.
pub(crate) const GUARD: f32 = (1 << 23) as f32 - 4096.0;
/// Smallest w that is projected.
const W_MIN: f32 = 1e-30;
/// In [`ScreenVertex::x`]: to be clipped before projection.
pub(crate) const UNPROJECTED: i32 = i32::MIN;

/// Pixels `x0 <= x < x1`, `y0 <= y < y1` of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bounds {
    pub(crate) x0: i32,
    pub(crate) y0: i32,
    pub(crate) x1: i32,
    pub(crate) y1: i32,
}

impl Bounds {
    pub(crate) fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    pub(crate) fn intersect(self, o: Self) -> Self {
        Self { x0: self.x0.max(o.x0), y0: self.y0.max(o.y0), x1: self.x1.min(o.x1), y1: self.y1.min(o.y1) }
    }

    pub(crate) fn of_rect(r: Rect) -> Self {
        let end = |start: i32, len: u32| (i64::from(start) + i64::from(len)).min(i64::from(i32::MAX)) as i32;
        Self { x0: r.x, y0: r.y, x1: end(r.x, r.width), y1: end(r.y, r.height) }
    }

    /// Pixels whose centres lie in the viewport.
    fn of_viewport(v: Viewport) -> Self {
        let first = |edge: f32| (edge - 0.5).ceil() as i32;
        Self { x0: first(v.x), y0: first(v.y), x1: first(v.x + v.width), y1: first(v.y + v.height) }
    }
}

/// Pixels a draw may write, by target and scissor alone.
pub(crate) fn scissor_bounds(width: u32, height: u32, state: &State) -> Bounds {
    let whole = Bounds { x0: 0, y0: 0, x1: width as i32, y1: height as i32 };
    state.scissor.map_or(whole, |r| whole.intersect(Bounds::of_rect(r)))
}

/// A corner on the fixed-point screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ScreenVertex {
    /// Column, or [`UNPROJECTED`].
    pub(crate) x: i32,
    /// Row, downwards.
    pub(crate) y: i32,
    /// Window depth, 0 near to 1 far.
    pub(crate) z: f32,
    /// 1 / w of clip space.
    pub(crate) inv_w: f32,
}

/// The map from clip space to the screen, of one draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenMap {
    pub(crate) scale: [f32; 2],
    pub(crate) offset: [f32; 2],
    pub(crate) z_scale: f32,
    pub(crate) z_offset: f32,
    /// Pixel whose upper left corner is the origin of fixed-point coordinates.
    pub(crate) origin: [i32; 2],
    /// Pixels that may be written.
    pub(crate) bounds: Bounds,
}

impl ScreenMap {
    pub(crate) fn new(width: u32, height: u32, state: &State) -> Self {
        let (w, h) = (width as f32, height as f32);
        let view = state.viewport.unwrap_or(Viewport { x: 0.0, y: 0.0, width: w, height: h });
        let origin = [(width / 2) as i32, (height / 2) as i32];
        let sub = SUB as f32;
        let near = state.depth_range[0].clamp(0.0, 1.0);
        let far = state.depth_range[1].clamp(0.0, 1.0);
        Self {
            scale: [0.5 * view.width * sub, -0.5 * view.height * sub],
            offset: [
                (view.x + 0.5 * view.width - origin[0] as f32) * sub,
                (view.y + 0.5 * view.height - origin[1] as f32) * sub,
            ],
            z_scale: far - near,
            z_offset: near,
            origin,
            bounds: scissor_bounds(width, height, state).intersect(Bounds::of_viewport(view)),
        }
    }

    /// The screen position of a clip-space point, or one marked [`UNPROJECTED`] when it is not in
    /// front of the near and before the far plane, or beyond the guard band, or not finite.
    pub(crate) fn project(&self, p: Vec4) -> ScreenVertex {
        let inv_w = 1.0 / p.w;
        let x = p.x * inv_w * self.scale[0] + self.offset[0];
        let y = p.y * inv_w * self.scale[1] + self.offset[1];
        let inside = p.z >= 0.0 && p.z <= p.w && p.w >= W_MIN && x.abs() <= GUARD && y.abs() <= GUARD;
        if !inside {
            return ScreenVertex { x: UNPROJECTED, ..ScreenVertex::default() };
        }
        self.rounded(x, y, p.z * inv_w, inv_w)
    }

    /// The screen position of a point that clipping has made, brought inside where rounding has
    /// pushed it out.
    pub(crate) fn project_clipped(&self, p: Vec4) -> ScreenVertex {
        let inv_w = 1.0 / p.w.max(W_MIN);
        let bring_in = |v: f32| if v.is_nan() { 0.0 } else { v.clamp(-GUARD, GUARD) };
        let x = bring_in(p.x * inv_w * self.scale[0] + self.offset[0]);
        let y = bring_in(p.y * inv_w * self.scale[1] + self.offset[1]);
        self.rounded(x, y, (p.z * inv_w).max(0.0), inv_w)
    }

    fn rounded(&self, x: f32, y: f32, z: f32, inv_w: f32) -> ScreenVertex {
        // Rounded down by hand: without SSE 4.1 `floor` is a call.
        let fixed = |v: f32| {
            let whole = (v + 0.5) as i32;
            whole - i32::from(v + 0.5 < whole as f32)
        };
        ScreenVertex { x: fixed(x), y: fixed(y), z: z.min(1.0) * self.z_scale + self.z_offset, inv_w }
    }

    /// Planes a triangle must be cut by before all its corners project: w, near, far, and the guard
    /// band on four sides.
    pub(crate) fn guard_planes(&self) -> [Vec4; 7] {
        let [sx, sy] = self.scale;
        let [ox, oy] = self.offset;
        // Normalised so that the numbers stay near 1 whatever the viewport.
        let side = |n: Vec4| n / GUARD;
        [
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            VIEW_VOLUME[4],
            VIEW_VOLUME[5],
            side(Vec4::new(sx, 0.0, 0.0, ox - GUARD)),
            side(Vec4::new(-sx, 0.0, 0.0, -ox - GUARD)),
            side(Vec4::new(0.0, sy, 0.0, oy - GUARD)),
            side(Vec4::new(0.0, -sy, 0.0, -oy - GUARD)),
        ]
    }

    /// The part of a triangle that projects. `None` when it is wholly outside the view volume.
    pub(crate) fn clip(&self, corners: [Vec4; 3]) -> Option<Polygon> {
        if wholly_outside(&corners, &VIEW_VOLUME) {
            return None;
        }
        let polygon = clip_triangle(corners, &self.guard_planes());
        (polygon.vertices().len() >= 3).then_some(polygon)
    }
}

/// A quantity linear on the screen: `(c + dy * fy) + dx * fx`, where `fx`, `fy` count pixels from the
/// triangle's reference pixel. Always evaluated in this order, without fused operations, so that
/// every rasterizer and every vector width gets the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Plane {
    pub(crate) c: f32,
    pub(crate) dx: f32,
    pub(crate) dy: f32,
}

impl Plane {
    pub(crate) fn at(&self, fx: f32, fy: f32) -> f32 {
        (self.c + self.dy * fy) + self.dx * fx
    }

    /// `base + a * pa + b * pb`.
    #[inline(always)]
    pub(crate) fn combine(base: f32, a: f32, pa: &Self, b: f32, pb: &Self) -> Self {
        Self { c: base + (a * pa.c + b * pb.c), dx: a * pa.dx + b * pb.dx, dy: a * pa.dy + b * pb.dy }
    }

    #[inline(always)]
    fn scaled(&self, s: f32) -> Self {
        Self { c: self.c * s, dx: self.dx * s, dy: self.dy * s }
    }
}

/// What does not change over a draw but decides about each triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetupState {
    pub(crate) cull: Cull,
    pub(crate) screen_space: bool,
    pub(crate) bias_constant: f32,
    pub(crate) bias_slope: f32,
}

impl SetupState {
    pub(crate) fn new(state: &State) -> Self {
        Self {
            cull: state.cull,
            screen_space: state.interpolation != Interpolation::Perspective,
            bias_constant: state.depth_bias.constant,
            bias_slope: state.depth_bias.slope,
        }
    }
}

/// Twice the signed area, in squared units; negative when the corners run counter-clockwise on
/// screen, where y points down.
#[inline(always)]
pub(crate) fn double_area(v: &[ScreenVertex; 3]) -> i64 {
    let d = |a: i32, b: i32| i64::from(a - b);
    d(v[1].x, v[0].x) * d(v[2].y, v[0].y) - d(v[2].x, v[0].x) * d(v[1].y, v[0].y)
}

/// Whether a triangle of that area is left out: degenerate, or of the culled facing.
#[inline(always)]
pub(crate) fn is_culled(area: i64, cull: Cull) -> bool {
    match cull {
        Cull::None => area == 0,
        Cull::Back => area >= 0,
        Cull::Front => area <= 0,
    }
}

/// A triangle ready for its pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    /// Corners, ordered so that the interior is where all edge functions are positive.
    pub(crate) v: [ScreenVertex; 3],
    /// Whether corners 1 and 2 have been exchanged; also whether the triangle shows its front.
    pub(crate) swapped: bool,
    /// Pixel, counted from the origin, at which planes have their constant.
    pub(crate) reference: [i32; 2],
    /// Depth, to be clamped to `z_min ..= z_max`.
    pub(crate) z: Plane,
    pub(crate) z_min: f32,
    pub(crate) z_max: f32,
    /// Weights of corners 1 and 2, divided by w unless `affine`.
    pub(crate) b1: Plane,
    pub(crate) b2: Plane,
    /// 1 / w; unused if `affine`.
    pub(crate) q: Plane,
    /// Weights are linear on the screen.
    pub(crate) affine: bool,
}

impl Setup {
    /// Sets up a triangle with area; `area` is its [`double_area`].
    #[inline(always)]
    pub(crate) fn new(corners: [ScreenVertex; 3], area: i64, state: &SetupState) -> Self {
        let swapped = area < 0;
        let v = if swapped { [corners[0], corners[2], corners[1]] } else { corners };
        let [v0, v1, v2] = v;
        // Weights: the edge functions of the opposite edges over the area, about the pixel of corner 0.
        let inv_area = 1.0 / area.unsigned_abs() as f32;
        let reference = [v0.x >> SUB_BITS, v0.y >> SUB_BITS];
        let sx = (reference[0] * SUB + HALF - v0.x) as f32;
        let sy = (reference[1] * SUB + HALF - v0.y) as f32;
        let weight = |ex: i32, ey: i32| {
            let (ex, ey) = (ex as f32 * inv_area, ey as f32 * inv_area);
            Plane { c: ex * sx + ey * sy, dx: ex * SUB as f32, dy: ey * SUB as f32 }
        };
        let b1 = weight(v2.y - v0.y, v0.x - v2.x);
        let b2 = weight(v0.y - v1.y, v1.x - v0.x);
        let mut z = Plane::combine(v0.z, v1.z - v0.z, &b1, v2.z - v0.z, &b2);
        let bias = bias_of(&z, state);
        z.c += bias;
        let affine = state.screen_space || (v0.inv_w == v1.inv_w && v0.inv_w == v2.inv_w);
        let q = Plane::combine(v0.inv_w, v1.inv_w - v0.inv_w, &b1, v2.inv_w - v0.inv_w, &b2);
        Self {
            v,
            swapped,
            reference,
            z,
            z_min: (v0.z.min(v1.z).min(v2.z) + bias).clamp(0.0, 1.0),
            z_max: (v0.z.max(v1.z).max(v2.z) + bias).clamp(0.0, 1.0),
            b1: if affine { b1 } else { b1.scaled(v1.inv_w) },
            b2: if affine { b2 } else { b2.scaled(v2.inv_w) },
            q,
            affine,
        }
    }

    /// Depth at a pixel, `fx`, `fy` from the reference.
    pub(crate) fn depth(&self, fx: f32, fy: f32) -> f32 {
        let z = self.z.at(fx, fy);
        let low = if z > self.z_min { z } else { self.z_min };
        if low < self.z_max { low } else { self.z_max }
    }

    /// Weights of corners 1 and 2, and w, at a pixel.
    pub(crate) fn weights(&self, fx: f32, fy: f32) -> [f32; 3] {
        let (b1, b2) = (self.b1.at(fx, fy), self.b2.at(fx, fy));
        if self.affine {
            return [b1, b2, 1.0];
        }
        let w = 1.0 / self.q.at(fx, fy);
        [b1 * w, b2 * w, w]
    }
}

#[inline(always)]
fn bias_of(z: &Plane, state: &SetupState) -> f32 {
    state.bias_constant + state.bias_slope * z.dx.abs().max(z.dy.abs())
}

/// `a / b` rounded up, for positive `b`.
pub(crate) fn ceil_div(a: i64, b: i64) -> i64 {
    -(-a).div_euclid(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clip space of the course text's simple camera, section 8.6 of its examples worked out: eye at
    /// z = 5, front plane z = 1, back plane z = -5; depth 0 in front.
    fn clip_from_world([x, y, z]: [f32; 3]) -> Vec4 {
        Vec4::new(x / 2.0, y / 2.0, (1.0 - z) / 6.0, (5.0 - z) / 10.0)
    }

    fn at_scene_point(state: &State) -> (f32, [f32; 3]) {
        let map = ScreenMap::new(4000, 4000, state);
        let corners = [[-0.5, -0.5, 0.0], [1.0, -0.3, -4.0], [0.0, 0.8, -2.0]].map(clip_from_world);
        let screen = corners.map(|c| map.project(c));
        let setup = Setup::new(screen, double_area(&screen), &SetupState::new(state));
        let point = corners[0] * 0.2 + corners[1] * 0.5 + corners[2] * 0.3;
        let pixel = |ndc: f32, k: usize| {
            let fixed = ndc * map.scale[k] + map.offset[k];
            (fixed - (setup.reference[k] * SUB + HALF) as f32) / SUB as f32
        };
        let (fx, fy) = (pixel(point.x / point.w, 0), pixel(point.y / point.w, 1));
        let [b1, b2, _] = setup.weights(fx, fy);
        let weights = [1.0 - b1 - b2, b1, b2];
        (setup.depth(fx, fy), if setup.swapped { [weights[0], weights[2], weights[1]] } else { weights })
    }

    #[test]
    fn depth_is_exact_in_the_image_and_colour_is_not() {
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        let (depth, weights) =
            at_scene_point(&State { interpolation: Interpolation::Screen, ..State::default() });
        assert!((depth - 0.789_474).abs() < 1e-5, "{depth}");
        assert!(near(weights, [0.131_579, 0.592_105, 0.276_316]), "{weights:?}");
        let (depth, weights) = at_scene_point(&State::default());
        assert!((depth - 0.789_474).abs() < 1e-5, "{depth}");
        assert!(near(weights, [0.2, 0.5, 0.3]), "{weights:?}");
    }

    #[test]
    fn corners_of_the_volume_land_on_corners_of_the_viewport() {
        let view = Viewport { x: 10.0, y: 20.0, width: 100.0, height: 40.0 };
        let map = ScreenMap::new(640, 480, &State { viewport: Some(view), ..State::default() });
        let pixel = |p: Vec4| {
            let v = map.project(p);
            [v.x / SUB + map.origin[0], v.y / SUB + map.origin[1]]
        };
        assert_eq!(pixel(Vec4::new(-1.0, 1.0, 0.0, 1.0)), [10, 20]);
        assert_eq!(pixel(Vec4::new(2.0, -2.0, 1.0, 2.0)), [110, 60]);
        assert_eq!(map.bounds, Bounds { x0: 10, y0: 20, x1: 110, y1: 60 });
    }

    #[test]
    fn what_does_not_project_is_marked() {
        let map = ScreenMap::new(64, 64, &State::default());
        for p in [
            Vec4::new(0.0, 0.0, -0.1, 1.0),
            Vec4::new(0.0, 0.0, 1.1, 1.0),
            Vec4::new(0.0, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 0.0, -1.0, -1.0),
            Vec4::new(1e9, 0.0, 0.5, 1.0),
            Vec4::new(f32::NAN, 0.0, 0.5, 1.0),
            Vec4::new(0.0, f32::INFINITY, 0.5, 1.0),
        ] {
            assert_eq!(map.project(p).x, UNPROJECTED, "{p}");
        }
    }

    #[test]
    fn division_rounds_up() {
        let found = [(7, 2), (-7, 2), (8, 2), (-8, 2), (0, 5), (1, 5), (-1, 5)].map(|(a, b)| ceil_div(a, b));
        assert_eq!(found, [4, -3, 4, -4, 0, 1, 0]);
    }
}
