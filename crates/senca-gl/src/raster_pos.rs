//! The raster position (OpenGL 1.5, section 2.12).

use crate::component::{Component, coordinates};
use crate::immediate::VertexArrays;
use crate::state::RasterPosition;
use crate::vertex::clamp01;
use crate::{Context, gl};
use senca_math::glam::{Mat4, Vec4, Vec4Swizzles};

impl Context {
    /// `glRasterPos`, with 2 to 4 coordinates: goes the way of a vertex.
    pub fn raster_pos<T: Component, const N: usize>(&mut self, v: [T; N]) {
        const { assert!(N >= 2, "a raster position has two to four coordinates") }
        let v = coordinates(v);
        self.submit(move |c| c.set_raster_pos(v));
    }

    /// `glWindowPos`, with 2 or 3 coordinates: window x and y, and z from 0 to 1 within the depth range.
    pub fn window_pos<T: Component, const N: usize>(&mut self, v: [T; N]) {
        const { assert!(N == 2 || N == 3, "a window position has two or three coordinates") }
        let [x, y, z, _] = coordinates(v);
        self.submit(move |c| {
            let (s, view) = (&c.state.current, &c.state.viewport);
            let depth = view.near as f32 + clamp01(z) * (view.far - view.near) as f32;
            let fog = c.state.fog.coord_src == gl::FOG_COORD;
            c.state.current.raster = RasterPosition {
                position: [x, y, depth, 1.0],
                valid: true,
                distance: if fog { s.fog_coord } else { 0.0 },
                color: s.color.map(clamp01),
                secondary: s.secondary.map(clamp01),
                index: s.index,
                tex_coords: s.tex_coords,
            };
            c.select_raster();
        });
    }

    fn set_raster_pos(&mut self, v: [f32; 4]) {
        self.make_plan();
        let arrays = VertexArrays { positions: vec![v], ..VertexArrays::default() };
        let current = self.state.current.clone();
        let vertex = self.immediate.plan.raster_vertex(&arrays.input(&current));
        let clip = self.projection.top() * vertex.eye;
        let clip = self.within_raster_clip(clip);
        let planes = &self.immediate.plan.clip_planes;
        let seen = planes.iter().all(|n| n.dot(vertex.eye) >= 0.0)
            && senca_raster::clip::VIEW_VOLUME.iter().all(|n| n.dot(clip) <= 0.0)
            && clip.w > 0.0;
        let raster = &mut self.state.current.raster;
        raster.valid = seen;
        if !seen {
            return;
        }
        let window = self.window_of(clip);
        let [r, g, b] = vertex.secondary;
        let fog = self.state.fog.coord_src == gl::FOG_COORD;
        self.state.current.raster = RasterPosition {
            position: window,
            valid: true,
            distance: if fog { current.fog_coord } else { vertex.eye.xyz().length() },
            color: vertex.color.map(clamp01),
            secondary: [r, g, b, 1.0].map(clamp01),
            index: current.index,
            tex_coords: vertex.tex_coords,
        };
        self.select_raster();
    }

    /// A position of OpenGL's clip space in the rasterizer's.
    fn within_raster_clip(&self, clip: Vec4) -> Vec4 {
        let map: Mat4 = crate::vertex::raster_from_clip(self);
        map * clip
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn a_raster_position_is_a_vertex_in_the_window() {
        let mut c = Context::new(Config::default());
        assert!(c.resize(200, 100));
        c.color([0.5f32, 0.25, 2.0]);
        c.raster_pos([0.5f32, -0.5]);
        let r = c.state.current.raster;
        assert_eq!((r.position, r.valid), ([150.0, 25.0, 0.5, 1.0], true));
        assert_eq!(r.color, [0.5, 0.25, 1.0, 1.0]);
        c.raster_pos([1.5f32, 0.0]);
        assert!(!c.state.current.raster.valid);
        c.window_pos([-7i32, 3]);
        let r = c.state.current.raster;
        assert_eq!((r.position, r.valid), ([-7.0, 3.0, 0.0, 1.0], true));
    }
}
