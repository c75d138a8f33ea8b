//! Drawing and copying rectangles of pixels.
//!
//! Pixels become fragments and go through all that fragments go through: they are drawn as points. If nothing can
//! happen to them on the way, rows of colours are written at once.

use senca_math::glam::Vec4;

use super::place::Placement;
use super::rows::{Image, ImagePixels};
use crate::framebuffer::{Area, Aspect, Plane};
use crate::pixel::{PixelFormat, PixelLayout};
use crate::state::{Cap, TEXTURE_UNITS};
use crate::texture::{BaseFormat, Texels, each_row};
use crate::{Context, Enum, Error, gl};

/// What of the framebuffer an image is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Color,
    Depth,
    Stencil,
    DepthStencil,
}

impl Content {
    fn of(format: PixelFormat) -> Self {
        match format {
            PixelFormat::DepthComponent => Self::Depth,
            PixelFormat::StencilIndex => Self::Stencil,
            PixelFormat::DepthStencil => Self::DepthStencil,
            _ => Self::Color,
        }
    }
}

impl Context {
    /// `glDrawPixels`: draws an image with its lower left corner, or another if it is zoomed by negative factors,
    /// at the raster position. Bytes lie as the unpack state says.
    pub fn draw_pixels(&mut self, [width, height]: [i32; 2], format: Enum, ty: Enum, data: &[u8]) {
        let layout = PixelLayout::new(format, ty);
        let pixels = self.source([width, height, 1], false, format, ty, Some(data));
        self.submit_pixels(pixels, move |c, pixels| {
            let checked = if width < 0 || height < 0 { Err(Error::InvalidValue) } else { Ok(()) };
            let result = checked.and_then(|()| {
                let content = Content::of(layout?.format());
                c.check_content(content)?;
                let Some(source) = pixels? else { return Ok(()) };
                if c.may_draw_raster(gl::DRAW_PIXEL_TOKEN) {
                    let state = c.pixels.clone();
                    c.draw_image(&Image { pixels: ImagePixels::Client(source), state }, content, [0; 2]);
                }
                Ok(())
            });
            c.check(result);
        });
    }

    /// `glCopyPixels`: draws a rectangle of the framebuffer at the raster position; `COLOR`, `DEPTH`, `STENCIL` or
    /// `DEPTH_STENCIL` says what of it.
    pub fn copy_pixels(&mut self, from: [i32; 2], size: [i32; 2], content: Enum) {
        self.submit(move |c| {
            let result = c.copy_within(from, size, content);
            c.check(result);
        });
    }

    fn copy_within(
        &mut self,
        [x, y]: [i32; 2],
        [width, height]: [i32; 2],
        content: Enum,
    ) -> Result<(), Error> {
        let content = match content {
            gl::COLOR => Content::Color,
            gl::DEPTH => Content::Depth,
            gl::STENCIL => Content::Stencil,
            gl::DEPTH_STENCIL => Content::DepthStencil,
            _ => return Err(Error::InvalidEnum),
        };
        if width < 0 || height < 0 {
            return Err(Error::InvalidValue);
        }
        self.check_content(content)?;
        let (first, stencil) = match content {
            Content::Color => (Aspect::Color, None),
            Content::Depth => (Aspect::Depth, None),
            Content::Stencil => (Aspect::Stencil, None),
            Content::DepthStencil => (Aspect::Depth, Some(Aspect::Stencil)),
        };
        let wanted = Area::of([x, y, width, height]);
        let (first, skipped) = self.copy_of(first, wanted)?;
        let stencil = match stencil {
            Some(aspect) => self.copy_of(aspect, wanted)?.0,
            None => None,
        };
        if let Some(first) = first
            && self.may_draw_raster(gl::COPY_PIXEL_TOKEN)
        {
            let state = self.pixels.clone();
            self.draw_image(
                &Image { pixels: ImagePixels::Copied { first, stencil }, state },
                content,
                skipped,
            );
        }
        Ok(())
    }

    /// A copy of those pixels of an area that the framebuffer has, and how many columns and rows of the area are
    /// before them.
    fn copy_of(&mut self, aspect: Aspect, wanted: Area) -> Result<(Option<Plane>, [i32; 2]), Error> {
        let plane = self.read_plane(aspect)?;
        let area = wanted.intersect(plane.area());
        if area.is_empty() || !plane.is_present() {
            return Ok((None, [0; 2]));
        }
        let (width, height) = ((area.x1 - area.x0) as u32, (area.y1 - area.y0) as u32);
        let mut copy = Plane::new(plane.format, width, height, 0).ok_or(Error::OutOfMemory)?;
        for row in 0..height as usize {
            let (from, to) = (plane.at(area.x0 as usize, area.y0 as usize + row), copy.at(0, row));
            copy.texels_mut().copy_run(to, &plane.texels, from, width as usize);
        }
        let skipped = [area.x0.saturating_sub(wanted.x0), area.y0.saturating_sub(wanted.y0)];
        Ok((Some(copy), skipped))
    }

    /// Depths and stencil values need buffers for them.
    fn check_content(&self, content: Content) -> Result<(), Error> {
        let f = &self.framebuffers;
        let base = |plane: Option<Plane>| plane.map(|plane| plane.format.base());
        let (depth, stencil) = match f.draw_object() {
            Some(object) => (base(object.depth.plane()), base(object.stencil.plane())),
            None => (base(f.window.depth_stencil.clone()), base(f.window.depth_stencil.clone())),
        };
        let has_depth = depth.is_some_and(BaseFormat::has_depth);
        let has_stencil = stencil.is_some_and(BaseFormat::has_stencil);
        // Without a window there is nothing to miss.
        let fits = f.draw == 0 && !f.has_window()
            || match content {
                Content::Color => true,
                Content::Depth => has_depth,
                Content::Stencil => has_stencil,
                Content::DepthStencil => has_depth && has_stencil,
            };
        if fits { Ok(()) } else { Err(Error::InvalidOperation) }
    }

    /// Whether pixels at the raster position are to be drawn; in feedback they are reported instead.
    pub(super) fn may_draw_raster(&mut self, token: Enum) -> bool {
        if !self.may_draw() || !self.state.current.raster.valid {
            return false;
        }
        if !self.render_mode.is_render() {
            self.report_raster(token);
            return false;
        }
        true
    }

    /// Draws an image. `skipped` columns and rows before its first are not there.
    fn draw_image(&mut self, image: &Image<'_>, content: Content, skipped: [i32; 2]) {
        let [x, y, ..] = self.state.current.raster.position;
        let zoom = self.pixels.transfer.zoom;
        let origin = [x + zoom[0] * skipped[0] as f32, y + zoom[1] * skipped[1] as f32];
        let clip = self.scissored(self.draw_area());
        let Some(place) = Placement::new(origin, zoom, image.size(), clip) else { return };
        match content {
            Content::Color if self.draws_plainly() => self.write_colors(image, &place),
            Content::Color => self.draw_fragments(image, &place, false),
            Content::Depth => self.draw_fragments(image, &place, true),
            Content::Stencil => self.write_stencils(image, &place),
            Content::DepthStencil => {
                self.write_depths(image, &place);
                self.write_stencils(image, &place);
            }
        }
    }

    /// All pixels of the framebuffer that is drawn to.
    pub(super) fn draw_area(&self) -> Area {
        let f = &self.framebuffers;
        let window = Area::of([0, 0, f.window.width as i32, f.window.height as i32]);
        let Some(object) = f.draw_object() else { return window };
        let planes = object.points().filter_map(|(_, attachment)| attachment.plane());
        planes.map(|plane| plane.area()).reduce(Area::intersect).unwrap_or(Area::of([0; 4]))
    }

    /// Whether nothing happens to fragments of the raster position on their way into the framebuffer.
    pub(super) fn draws_plainly(&self) -> bool {
        const CAPS: [Cap; 10] = [
            Cap::AlphaTest,
            Cap::Blend,
            Cap::ColorLogicOp,
            Cap::DepthTest,
            Cap::Fog,
            Cap::StencilTest,
            Cap::FramebufferSrgb,
            Cap::SampleAlphaToCoverage,
            Cap::SampleAlphaToOne,
            Cap::SampleCoverage,
        ];
        let s = &self.state;
        let separate =
            s.enabled.has(Cap::Lighting) && s.lighting.color_control == gl::SEPARATE_SPECULAR_COLOR;
        let sums = s.enabled.has(Cap::ColorSum) || separate;
        let adds = sums && s.current.raster.secondary[..3] != [0.0; 3];
        !adds
            && CAPS.iter().all(|cap| !s.enabled.has(*cap))
            && s.color.mask == [true; 4]
            && self.framebuffers.draw_samples() == 0
            && (0..TEXTURE_UNITS).all(|unit| self.texture_view(unit).is_none())
    }

    /// Writes colours where nothing can happen to them.
    fn write_colors(&mut self, image: &Image<'_>, place: &Placement) {
        self.settle_planes();
        let mut planes = self.framebuffers.take_planes();
        planes.colors_mut().for_each(|plane| write_plane(image, place, plane));
        self.framebuffers.put_back(planes);
        self.queries.add((place.columns.len() * place.rows.len()) as u64);
    }

    /// Draws a row of fragments of the raster position from (`x`, `y`) on: colours and depths of each, else those
    /// of the raster position; `keep` leaves out others.
    pub(super) fn draw_row(
        &mut self,
        [x, y]: [i32; 2],
        count: usize,
        colors: Option<&[[f32; 4]]>,
        depths: Option<&[f32]>,
        keep: impl Fn(usize) -> bool,
    ) {
        let area = self.draw_area();
        self.make_plan();
        let layout = self.immediate.plan.layout;
        let first = self.begin_pixel_batch(layout, [area.x1, area.y1]);
        let raster = self.state.current.raster;
        let window = [area.x1, area.y1].map(|side| f64::from(side) / 2.0);
        let varyings = usize::from(layout.stride);
        for (next, i) in (first..).zip((0..count).filter(|i| keep(*i))) {
            // The rasterizer's clip space has y down.
            let clip_x = (f64::from(x) + i as f64 + 0.5) / window[0] - 1.0;
            let clip_y = 1.0 - (f64::from(y) + 0.5) / window[1];
            let depth = depths.map_or(raster.position[2], |depths| depths[i]);
            let batch = &mut self.batch;
            batch.positions.push(Vec4::new(clip_x as f32, clip_y as f32, depth, 1.0));
            let at = batch.varyings.len();
            batch.varyings.resize(at + varyings, 0.0);
            let to = &mut batch.varyings[at..];
            to[..4].copy_from_slice(&colors.map_or(raster.color, |colors| colors[i]));
            if let Some(first) = layout.secondary.map(usize::from) {
                to[first..first + 3].copy_from_slice(&raster.secondary[..3]);
            }
            if let Some(first) = layout.fog.map(usize::from) {
                to[first] = raster.distance;
            }
            for (first, coords) in layout.tex_coords.iter().zip(&raster.tex_coords) {
                if let Some(first) = first.map(usize::from) {
                    to[first..first + 4].copy_from_slice(coords);
                }
            }
            batch.indices.push(next);
        }
    }

    /// Draws an image fragment by fragment: its colours, or its depths in the colour of the raster position.
    fn draw_fragments(&mut self, image: &Image<'_>, place: &Placement, is_depth: bool) {
        let width = image.size()[0] as usize;
        let mut colors = vec![[0.0; 4]; if is_depth { 0 } else { width }];
        let mut depths = vec![0.0; if is_depth { width } else { 0 }];
        let mut row_read = None;
        for (i, &row) in place.rows.iter().enumerate() {
            if row_read.replace(row) != Some(row) {
                if is_depth {
                    image.depths(row, &mut depths);
                } else {
                    image.colors(row, 0, &mut colors);
                }
            }
            let at = [place.area.x0, place.area.y0 + i as i32];
            let count = place.columns.len();
            if is_depth {
                let depths: Vec<f32> = place.columns.iter().map(|&column| depths[column]).collect();
                self.draw_row(at, count, None, Some(&depths), |_| true);
            } else {
                let colors: Vec<[f32; 4]> = place.columns.iter().map(|&column| colors[column]).collect();
                self.draw_row(at, count, Some(&colors), None, |_| true);
            }
        }
        // Later commands may change what belongs to the raster position's fragments alone.
        self.flush_batch();
    }

    /// Writes stencil values through the mask.
    fn write_stencils(&mut self, image: &Image<'_>, place: &Placement) {
        self.settle_planes();
        let mask = self.state.stencil.write_mask as u8;
        let mut planes = self.framebuffers.take_planes();
        if let Some(plane) = planes.stencil().filter(|plane| plane.is_present()) {
            let mut values = vec![0; image.size()[0] as usize];
            let texels = texel_numbers(plane);
            for i in 0..place.rows.len() {
                image.stencils(place.rows[i], &mut values);
                let Some(stencils) = plane.texels_mut().stencils_mut() else { break };
                texels(place, i, &mut |at, column| {
                    stencils[at] = stencils[at] & !mask | values[column] & mask;
                });
            }
        }
        self.framebuffers.put_back(planes);
    }

    /// Writes depths as they are, if depths may be written.
    fn write_depths(&mut self, image: &Image<'_>, place: &Placement) {
        self.settle_planes();
        let mut planes = self.framebuffers.take_planes();
        if let Some(plane) = planes.depth().filter(|plane| self.state.depth.mask && plane.is_present()) {
            let mut values = vec![0.0; image.size()[0] as usize];
            let texels = texel_numbers(plane);
            for i in 0..place.rows.len() {
                image.depths(place.rows[i], &mut values);
                let Some(depths) = plane.texels_mut().depths_mut() else { break };
                texels(place, i, &mut |at, column| depths[at] = values[column]);
            }
        }
        self.framebuffers.put_back(planes);
    }
}

/// Writes rows of colours into a plane.
fn write_plane(image: &Image<'_>, place: &Placement, plane: &mut Plane) {
    if !plane.is_present() {
        return;
    }
    let (base, stride) = (plane.format.base(), plane.stride());
    let range = plane.at(0, place.area.y0 as usize)..plane.at(0, place.area.y1 as usize);
    let columns = place.area.columns(1);
    let (straight, width) = (place.keeps_columns(), image.size()[0] as usize);
    match plane.texels_mut() {
        Texels::Rgba8(colors) => each_row(&mut colors[range], stride, |y, row| {
            let (row, y) = (&mut row[columns.clone()], place.rows[y]);
            if straight {
                image.colors8(y, place.columns[0], row);
            } else {
                let mut whole = vec![[0; 4]; width];
                image.colors8(y, 0, &mut whole);
                row.iter_mut().zip(&place.columns).for_each(|(out, column)| *out = whole[*column]);
            }
            if base != BaseFormat::Rgba {
                row.iter_mut().for_each(|color| *color = base.stored(*color, 255));
            }
        }),
        Texels::Rgba32F(colors) => each_row(&mut colors[range], stride, |y, row| {
            let mut whole = vec![[0.0; 4]; width];
            image.colors(place.rows[y], 0, &mut whole);
            let row = &mut row[columns.clone()];
            row.iter_mut()
                .zip(&place.columns)
                .for_each(|(out, column)| *out = base.stored(whole[*column], 1.0));
        }),
        _ => {}
    }
}

/// What calls back with the texels of row `i` of a placement in a plane, all samples of each pixel, and the columns of
/// the image that they show.
fn texel_numbers(plane: &Plane) -> impl Fn(&Placement, usize, &mut dyn FnMut(usize, usize)) + use<> {
    let (first, stride, side) = (plane.first, plane.stride(), plane.side());
    move |place, i, each| {
        for (k, &column) in place.columns.iter().enumerate() {
            let (x, y) = (place.area.x0 as usize + k, place.area.y0 as usize + i);
            for sample in 0..side * side {
                each(first + (y * side + sample / side) * stride + x * side + sample % side, column);
            }
        }
    }
}
