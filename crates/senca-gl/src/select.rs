//! Selection and feedback (OpenGL 1.5, sections 5.2, 5.3).

use crate::assemble::Vertex;
use crate::vertex::Layout;
use crate::{Context, Enum, gl};

/// Names the stack may hold.
pub(crate) const MAX_NAME_STACK_DEPTH: usize = 128;

/// What becomes of primitives.
#[derive(Debug)]
pub(crate) struct RenderMode {
    pub(crate) mode: Enum,
    /// Words that selection may write.
    select_size: Option<usize>,
    selected: Vec<u32>,
    hits: i32,
    overflow: bool,
    names: Vec<u32>,
    /// Least and greatest depth since the names changed.
    hit: Option<[f32; 2]>,
    /// Numbers that feedback may write, and what it writes.
    feedback_size: Option<(usize, Enum)>,
    fed_back: Vec<f32>,
}

impl Default for RenderMode {
    fn default() -> Self {
        Self {
            mode: gl::RENDER,
            select_size: None,
            selected: Vec::new(),
            hits: 0,
            overflow: false,
            names: Vec::new(),
            hit: None,
            feedback_size: None,
            fed_back: Vec::new(),
        }
    }
}

impl RenderMode {
    #[inline]
    pub(crate) fn is_render(&self) -> bool {
        self.mode == gl::RENDER
    }

    pub(crate) fn name_depth(&self) -> usize {
        self.names.len()
    }

    /// Sizes of the two buffers, and what feedback writes.
    pub(crate) fn buffers(&self) -> (usize, usize, Enum) {
        let (size, kind) = self.feedback_size.unwrap_or((0, gl::_2D));
        (self.select_size.unwrap_or(0), size, kind)
    }

    fn select_depth(&mut self, z: f32) {
        let [low, high] = self.hit.unwrap_or([z, z]);
        self.hit = Some([low.min(z), high.max(z)]);
    }

    /// Writes the hit record that is due.
    fn write_hit(&mut self) {
        let Some(depths) = self.hit.take() else { return };
        let scaled = depths.map(|z| (f64::from(z.clamp(0.0, 1.0)) * f64::from(u32::MAX)).round() as u32);
        let room = self.select_size.unwrap_or(0);
        let record = [self.names.len() as u32, scaled[0], scaled[1]];
        for word in record.into_iter().chain(self.names.iter().copied()) {
            if self.selected.len() >= room {
                self.overflow = true;
                return;
            }
            self.selected.push(word);
        }
        self.hits += 1;
    }

    fn feed(&mut self, v: f32) {
        match self.feedback_size {
            Some((size, _)) if self.fed_back.len() < size => self.fed_back.push(v),
            _ => self.overflow = true,
        }
    }
}

impl Context {
    /// `glRenderMode`: `RENDER`, `SELECT` or `FEEDBACK`. When one of the latter two ends: the number of hits or
    /// of numbers written, -1 if they were too many; else 0. What was written is in [`Context::selected`] and
    /// [`Context::fed_back`].
    pub fn render_mode(&mut self, mode: Enum) -> i32 {
        self.ask(|c| {
            let r = &mut c.render_mode;
            match mode {
                gl::RENDER => {}
                gl::SELECT if r.select_size.is_some() => {}
                gl::FEEDBACK if r.feedback_size.is_some() => {}
                gl::SELECT | gl::FEEDBACK => {
                    c.error(gl::INVALID_OPERATION);
                    return 0;
                }
                _ => {
                    c.error(gl::INVALID_ENUM);
                    return 0;
                }
            }
            let result = match r.mode {
                gl::SELECT => {
                    r.write_hit();
                    if r.overflow { -1 } else { r.hits }
                }
                gl::FEEDBACK if r.overflow => -1,
                gl::FEEDBACK => r.fed_back.len() as i32,
                _ => 0,
            };
            (r.mode, r.overflow, r.hits, r.hit) = (mode, false, 0, None);
            r.names.clear();
            match mode {
                gl::SELECT => r.selected.clear(),
                gl::FEEDBACK => r.fed_back.clear(),
                _ => {}
            }
            c.touch_vertices();
            result
        })
    }

    /// `RENDER`, `SELECT` or `FEEDBACK`: what becomes of primitives now.
    #[must_use]
    pub fn current_render_mode(&self) -> Enum {
        self.render_mode.mode
    }

    /// `glSelectBuffer`: how many words selection may write.
    pub fn select_buffer(&mut self, size: i32) {
        self.outside(|c| match usize::try_from(size) {
            Err(_) => c.error(gl::INVALID_VALUE),
            Ok(_) if c.render_mode.mode == gl::SELECT => c.error(gl::INVALID_OPERATION),
            Ok(size) => c.render_mode.select_size = Some(size),
        });
    }

    /// The hit records of the last selection: number of names, least and greatest depth times 2^32 - 1, the names.
    #[must_use]
    pub fn selected(&self) -> &[u32] {
        &self.render_mode.selected
    }

    /// `glFeedbackBuffer`: how many numbers feedback may write, and which: `2D` to `4D_COLOR_TEXTURE`.
    pub fn feedback_buffer(&mut self, size: i32, kind: Enum) {
        self.outside(|c| {
            if !(gl::_2D..=gl::_4D_COLOR_TEXTURE).contains(&kind) {
                return c.error(gl::INVALID_ENUM);
            }
            match usize::try_from(size) {
                Err(_) => c.error(gl::INVALID_VALUE),
                Ok(_) if c.render_mode.mode == gl::FEEDBACK => c.error(gl::INVALID_OPERATION),
                Ok(size) => c.render_mode.feedback_size = Some((size, kind)),
            }
        });
    }

    /// What the last feedback wrote.
    #[must_use]
    pub fn fed_back(&self) -> &[f32] {
        &self.render_mode.fed_back
    }

    /// `glPassThrough`: marks a place in what is fed back.
    pub fn pass_through(&mut self, token: f32) {
        self.submit(move |c| {
            if c.render_mode.mode == gl::FEEDBACK {
                c.render_mode.feed(gl::PASS_THROUGH_TOKEN as f32);
                c.render_mode.feed(token);
            }
        });
    }

    /// `glInitNames`: empties the name stack.
    pub fn init_names(&mut self) {
        self.change_names(|names| {
            names.clear();
            None
        });
    }

    /// `glPushName`.
    pub fn push_name(&mut self, name: u32) {
        self.change_names(move |names| {
            if names.len() >= MAX_NAME_STACK_DEPTH {
                return Some(gl::STACK_OVERFLOW);
            }
            names.push(name);
            None
        });
    }

    /// `glPopName`.
    pub fn pop_name(&mut self) {
        self.change_names(|names| names.pop().map_or(Some(gl::STACK_UNDERFLOW), |_| None));
    }

    /// `glLoadName`: replaces the topmost name.
    pub fn load_name(&mut self, name: u32) {
        self.change_names(move |names| match names.last_mut() {
            Some(top) => {
                *top = name;
                None
            }
            None => Some(gl::INVALID_OPERATION),
        });
    }

    fn change_names(&mut self, change: impl Fn(&mut Vec<u32>) -> Option<Enum> + Send + Sync + 'static) {
        self.submit(move |c| {
            if c.render_mode.mode != gl::SELECT {
                return;
            }
            c.render_mode.write_hit();
            if let Some(error) = change(&mut c.render_mode.names) {
                c.error(error);
            }
        });
    }

    /// Window coordinates of OpenGL: x, y up, z, and w of clip space.
    pub(crate) fn window(&self, v: &Vertex) -> [f32; 4] {
        self.window_of(v.position)
    }

    /// As [`Context::window`], of a position in the rasterizer's clip space.
    pub(crate) fn window_of(&self, p: senca_math::glam::Vec4) -> [f32; 4] {
        let view = &self.state.viewport;
        let [x, y, width, height] = view.rect.map(|v| v as f32);
        // The rasterizer's rows are window rows, whichever origin clip space has.
        let ndc = [p.x / p.w, -p.y / p.w, p.z / p.w];
        let (near, far) = (view.near as f32, view.far as f32);
        [
            x + (ndc[0] + 1.0) * 0.5 * width,
            y + (ndc[1] + 1.0) * 0.5 * height,
            near + ndc[2] * (far - near),
            p.w,
        ]
    }

    /// Whether a point lies within the view volume.
    fn sees(v: &Vertex) -> bool {
        senca_raster::clip::VIEW_VOLUME.iter().all(|n| n.dot(v.position) <= 0.0)
    }

    /// A point in selection or feedback.
    pub(crate) fn report_point(&mut self, v: &Vertex, layout: Layout) {
        if !Self::sees(v) {
            return;
        }
        if self.render_mode.mode == gl::SELECT {
            let z = self.window(v)[2];
            return self.render_mode.select_depth(z);
        }
        self.render_mode.feed(gl::POINT_TOKEN as f32);
        self.feed_vertex(v, layout);
    }

    /// A line in selection or feedback.
    pub(crate) fn report_line(&mut self, a: &Vertex, b: &Vertex, layout: Layout, goes_on: bool) {
        let Some([t0, t1]) =
            senca_raster::clip::clip_line(a.position, b.position, &senca_raster::clip::VIEW_VOLUME)
        else {
            return;
        };
        let (a, b) = (a.between(b, t0), a.between(b, t1));
        if self.render_mode.mode == gl::SELECT {
            for v in [&a, &b] {
                let z = self.window(v)[2];
                self.render_mode.select_depth(z);
            }
            return;
        }
        let token = if goes_on { gl::LINE_TOKEN } else { gl::LINE_RESET_TOKEN };
        self.render_mode.feed(token as f32);
        self.feed_vertex(&a, layout);
        self.feed_vertex(&b, layout);
    }

    /// A polygon within the view volume in selection or feedback.
    pub(crate) fn report_polygon(&mut self, corners: &[Vertex], layout: Layout, mode: Enum) {
        if self.render_mode.mode == gl::SELECT {
            for v in corners {
                let z = self.window(v)[2];
                self.render_mode.select_depth(z);
            }
            return;
        }
        match mode {
            gl::POINT => {
                for v in corners.iter().filter(|v| v.starts_boundary()) {
                    self.render_mode.feed(gl::POINT_TOKEN as f32);
                    self.feed_vertex(v, layout);
                }
            }
            gl::LINE => {
                for (k, v) in corners.iter().enumerate().filter(|(_, v)| v.starts_boundary()) {
                    let token = if k == 0 { gl::LINE_RESET_TOKEN } else { gl::LINE_TOKEN };
                    self.render_mode.feed(token as f32);
                    self.feed_vertex(v, layout);
                    self.feed_vertex(&corners[(k + 1) % corners.len()], layout);
                }
            }
            _ => {
                self.render_mode.feed(gl::POLYGON_TOKEN as f32);
                self.render_mode.feed(corners.len() as f32);
                corners.iter().for_each(|v| self.feed_vertex(v, layout));
            }
        }
    }

    fn feed_vertex(&mut self, v: &Vertex, layout: Layout) {
        let coords = layout.tex_coords[0].map(usize::from).map(|at| {
            let t = &v.varyings[at..at + 4];
            [t[0], t[1], t[2], t[3]]
        });
        let color = [v.varyings[0], v.varyings[1], v.varyings[2], v.varyings[3]];
        let window = self.window(v);
        self.feed_values(window, color, coords.unwrap_or(self.state.current.tex_coords[0]));
    }

    /// Writes a vertex into feedback.
    pub(crate) fn feed_values(&mut self, window: [f32; 4], color: [f32; 4], tex_coords: [f32; 4]) {
        let r = &mut self.render_mode;
        let kind = r.feedback_size.map_or(gl::_2D, |f| f.1);
        let coordinates = match kind {
            gl::_2D => 2,
            gl::_4D_COLOR_TEXTURE => 4,
            _ => 3,
        };
        window[..coordinates].iter().for_each(|v| r.feed(*v));
        if kind >= gl::_3D_COLOR {
            color.iter().for_each(|v| r.feed(*v));
        }
        if kind >= gl::_3D_COLOR_TEXTURE {
            tex_coords.iter().for_each(|v| r.feed(*v));
        }
    }

    /// A raster position's drawing (bitmap, pixels) in feedback; nothing in selection.
    pub(crate) fn report_raster(&mut self, token: Enum) {
        if self.render_mode.mode == gl::FEEDBACK {
            let r = self.state.current.raster;
            self.render_mode.feed(token as f32);
            self.feed_values(r.position, r.color, r.tex_coords[0]);
        }
    }

    /// The raster position was set in selection: it counts as drawn.
    pub(crate) fn select_raster(&mut self) {
        let r = self.state.current.raster;
        if self.render_mode.mode == gl::SELECT && r.valid {
            self.render_mode.select_depth(r.position[2]);
        }
    }
}
