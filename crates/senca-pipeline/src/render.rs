//! The way of a picture through the pipeline.
//!
//! Faces are drawn in bands of rows, each band once per sample, in these steps:
//!
//! 1. Opaque triangles leave their depth and identifier at every pixel where they are nearest
//!    (course text, section 2.10: the first pass of the two-pass z-buffer).
//! 2. Pixels take their colour from the triangle seen there, each once, rows in parallel.
//! 3. Transparent triangles are peeled off layer by layer from the front (Everitt 2001), so their
//!    order in the scene does not matter; layers nearer than the opaque surface lie over it.
//!
//! The memory beyond the scene and the picture is that of one band: 8 bytes a pixel, 48 with
//! transparency. A band has 4 Mi pixels, or 8 for each triangle if that is more.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;
use senca_math::Control;
use senca_math::conventions::NO_ID;
use senca_math::{DeviceMap, Image, LinearRgb, View};
use senca_raster::{Counters, Rasterizer, ScanlineRasterizer, Shading as RasterShading, TiledRasterizer};
use senca_scene::{Background, Environment, Scene};
use senca_shading::LightRig;

use crate::canvas::Canvas;
use crate::geometry::World;
use crate::gouraud::light_vertices;
use crate::material::resolve_materials;
use crate::report::{Report, timed};
use crate::settings::{Channel, Crop, Raster, Settings, Shading};
use crate::shade::Shader;
use crate::single_pass::SinglePass;
use crate::strokes::Strokes;
use crate::surface::{PixelGrid, TriangleSetup};
use crate::visibility::{Drawer, EMPTY, Group, Layer, MaskCutter, Pass, Peeler, Planes, Window, groups};
use crate::{RenderError, lines};

/// Pixels of a band at least, unless the picture has fewer.
const BAND_PIXELS: usize = 1 << 22;

/// Rows that one task shades.
const STRIP_ROWS: usize = 16;

/// Most transparent layers of one pixel; more are left out from behind.
const MAX_LAYERS: u32 = 256;

/// Draws `scene` as `view` sees it into `image`, all of it or the part that `settings.crop` names.
///
/// Skins and morph targets bend their meshes as the nodes stand; take `Scene::at_time` for a moment of
/// an animation. Colours are linear; where nothing is seen and no background is set, alpha is 0. The scene's own
/// lights are used as they are: a scene without light is black but for its emission.
///
/// # Errors
/// See [`RenderError`]. The image may be drawn in part then.
pub fn render(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    image: &mut Image,
) -> Result<Report, RenderError> {
    render_with(scene, view, settings, image, &Control::default())
}

/// [`render`] with progress and cancellation.
///
/// # Errors
/// As [`render`], and [`RenderError::Cancelled`].
pub fn render_with(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    image: &mut Image,
    control: &Control<'_>,
) -> Result<Report, RenderError> {
    let area = area_of(settings, [image.width(), image.height()])?;
    draw(scene, view, settings, Canvas::whole(image), &area, control)
}

/// Draws the part that `settings.crop` names, or all, of a picture of `size` pixels, and returns it as
/// an image of its own: of a large picture only the part takes memory.
///
/// # Errors
/// As [`render_with`].
pub fn render_part(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    size: [u32; 2],
    control: &Control<'_>,
) -> Result<(Image, Report), RenderError> {
    let area = area_of(settings, size)?;
    let mut image = Image::new(area.width, area.height, [0.0; 4]);
    let report = draw(scene, view, settings, Canvas::part(&mut image, size, &area), &area, control)?;
    Ok((image, report))
}

/// What is to be drawn of a picture of `size`, the settings found sound.
fn area_of(settings: &Settings, size: [u32; 2]) -> Result<Crop, RenderError> {
    RenderError::check_size(size)?;
    settings.check()?;
    settings.area(size[0], size[1])
}

fn draw(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    mut canvas: Canvas<'_>,
    area: &Crop,
    control: &Control<'_>,
) -> Result<Report, RenderError> {
    let mut total = 0.0;
    let result = timed(&mut total, || {
        on_threads(settings.threads, || {
            let scene = &*scene.at_time(None, 0.0);
            match settings.shading {
                shading if shading.is_lines() && settings.channel == Channel::Color => {
                    lines::draw(scene, view, settings, &mut canvas, area, control)
                }
                _ => draw_faces(scene, view, settings, &mut canvas, area, control),
            }
        })
    });
    let mut report = result??;
    report.seconds.total = total;
    control.report(1.0);
    Ok(report)
}

/// Runs `work` on `threads` threads, 0 for those that are there anyway.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> Result<T, RenderError> {
    if threads == 0 {
        return Ok(work());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| RenderError::Threads { count: threads, reason: e.to_string() })?;
    Ok(pool.install(work))
}

/// The rasterizer that `settings` name.
pub(crate) fn rasterizer(settings: &Settings) -> Box<dyn Rasterizer> {
    match settings.raster {
        Raster::Tiled => Box::new(TiledRasterizer::default()),
        Raster::Scanline => Box::new(ScanlineRasterizer),
    }
}

fn draw_faces(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    canvas: &mut Canvas<'_>,
    area: &Crop,
    control: &Control<'_>,
) -> Result<Report, RenderError> {
    let mut report = Report::default();
    let size = canvas.size;
    let (world, materials) = timed(&mut report.seconds.prepare, || {
        let world = World::new(scene, view, size, settings.tolerance_px, false)?;
        Ok::<_, RenderError>((world, resolve_materials(scene, settings.filter, true)?))
    })?;
    control.check()?;
    let mut shader = Shader {
        world: &world,
        materials: &materials,
        rig: LightRig::of_scene(scene),
        fog: scene.fog,
        view: *view,
        grid: PixelGrid::new(size[0], size[1]),
        settings: *settings,
        clip_from_object: world.placed.iter().map(|p| view.clip_from_world * p.world_from_object).collect(),
        vertex_colors: Vec::new(),
    };
    if settings.shading == Shading::Gouraud && settings.channel == Channel::Color {
        shader.vertex_colors = timed(&mut report.seconds.vertices, || light_vertices(&shader));
    }
    control.check()?;
    report.triangles_in = u64::from(world.triangles);
    let strokes = Strokes::new(&world, scene);
    report.lines_drawn = strokes.len() as u64;
    let count = report.triangles_in + report.lines_drawn;
    if count >= u64::from(NO_ID) {
        return Err(RenderError::TooManyTriangles { count });
    }
    let mut frame = Frame {
        shader: &shader,
        groups: groups(&shader),
        strokes,
        paper: Paper::new(scene, settings, view, size),
        control,
        rasterizer: rasterizer(settings),
        drawer: Drawer::default(),
        planes: Planes::default(),
        report,
        counters: Counters::default(),
        size,
    };
    frame.draw(canvas, area)?;
    Ok(frame.finish())
}

/// A picture being drawn.
struct Frame<'a, 'w> {
    shader: &'a Shader<'w>,
    groups: Vec<Group>,
    strokes: Strokes,
    paper: Paper<'a>,
    control: &'a Control<'a>,
    rasterizer: Box<dyn Rasterizer>,
    drawer: Drawer,
    planes: Planes,
    report: Report,
    counters: Counters,
    size: [u32; 2],
}

impl Frame<'_, '_> {
    fn draw(&mut self, canvas: &mut Canvas<'_>, area: &Crop) -> Result<(), RenderError> {
        let bands = bands(area, self.shader.world.triangles);
        let samples = self.shader.settings.samples;
        self.report.bands = bands.len() as u32;
        let steps = (bands.len() as u32 * samples) as f32;
        for (b, band) in bands.iter().enumerate() {
            for s in 0..samples {
                let sample = sample_position(s, samples);
                self.draw_sample(canvas, &Window { size: self.size, area: *band, sample }, s)?;
                self.control.report((b as u32 * samples + s + 1) as f32 / steps);
            }
            self.paper.finish(canvas, band);
        }
        Ok(())
    }

    fn draw_sample(
        &mut self,
        canvas: &mut Canvas<'_>,
        window: &Window,
        sample: u32,
    ) -> Result<(), RenderError> {
        self.planes.resize(window.pixels());
        let mut seconds = 0.0;
        let in_one_pass = !self.shader.settings.two_pass && !self.measures();
        let mut single = in_one_pass.then(|| vec![[0.0; 4]; window.pixels()]);
        timed(&mut seconds, || self.find_visible(window, single.as_deref_mut()))?;
        let layers = timed(&mut seconds, || self.peel(window))?;
        self.report.seconds.raster += seconds;
        let mut seconds = 0.0;
        let shaded = timed(&mut seconds, || {
            let resolve = Resolve {
                shader: self.shader,
                window,
                paper: &self.paper,
                planes: &self.planes,
                strokes: &self.strokes,
                ready: single.as_deref(),
                layers: layers.as_deref(),
                weight: 1.0 / self.shader.settings.samples as f32,
                first: sample == 0,
                control: self.control,
            };
            resolve.run(canvas)
        })?;
        self.report.seconds.shade += seconds;
        self.report.pixels_shaded += shaded;
        Ok(())
    }

    /// Whether pixels hold something else than colour.
    fn measures(&self) -> bool {
        self.shader.settings.channel != Channel::Color
    }

    /// Step 1: depth and identifier of what is opaque; with `color`, its colour too.
    fn find_visible(&mut self, window: &Window, color: Option<&mut [[f32; 4]]>) -> Result<(), RenderError> {
        let cutter = MaskCutter { shader: self.shader, window };
        let single = SinglePass { shader: self.shader, window };
        let (in_one_pass, measures) = (color.is_some(), self.measures());
        let mut target = self.planes.target(&window.area)?;
        if let Some(color) = color {
            let color = senca_raster::ColorPlane::Rgba32F(color);
            target = target.with_color(color).map_err(|_| RenderError::area_too_large(&window.area))?;
        }
        target.clear(&EMPTY);
        let mut pass = Pass::new(self.shader, window, self.rasterizer.as_mut(), self.control);
        for group in self.groups.iter().filter(|g| g.layer != Layer::Blended || measures) {
            let shading = match (in_one_pass, group.layer) {
                (true, _) => RasterShading::Custom(&single),
                (false, Layer::Masked) => RasterShading::Custom(&cutter),
                (false, _) => RasterShading::None,
            };
            self.drawer.draw(&mut pass, &mut target, group, &shading)?;
        }
        self.counters += pass.counters;
        self.strokes.draw(self.shader, window, self.rasterizer.as_mut(), &mut target);
        Ok(())
    }

    /// Step 3, before step 2 so that its colours are ready: the transparent layers of every pixel
    /// over one another, colours times alpha.
    fn peel(&mut self, window: &Window) -> Result<Option<Vec<[f32; 4]>>, RenderError> {
        if self.measures() || !self.groups.iter().any(|g| g.layer == Layer::Blended) {
            return Ok(None);
        }
        let pixels = window.pixels();
        let mut sum = vec![[0.0; 4]; pixels];
        let mut last = Planes { depth: vec![-1.0; pixels], ids: vec![0; pixels] };
        for _ in 0..MAX_LAYERS {
            let layer = self.next_layer(window, &last)?;
            let shaded = add_layer(self.shader, window, &layer, &mut sum, self.control)?;
            self.report.pixels_shaded += shaded;
            if shaded == 0 {
                break;
            }
            last = layer;
        }
        Ok(Some(sum))
    }

    /// What is seen behind `last` and before the opaque surface.
    fn next_layer(&mut self, window: &Window, last: &Planes) -> Result<Planes, RenderError> {
        let mut layer = Planes { depth: self.planes.depth.clone(), ids: vec![NO_ID; window.pixels()] };
        let peeler = Peeler { width: window.area.width as usize, last };
        let mut target = layer.target(&window.area)?;
        let mut pass = Pass::new(self.shader, window, self.rasterizer.as_mut(), self.control);
        for group in self.groups.iter().filter(|g| g.layer == Layer::Blended) {
            self.drawer.draw(&mut pass, &mut target, group, &RasterShading::Custom(&peeler))?;
        }
        self.counters += pass.counters;
        Ok(layer)
    }

    fn finish(self) -> Report {
        let rounds = u64::from(self.report.bands * self.shader.settings.samples).max(1);
        Report {
            triangles_culled: self.counters.culled / rounds,
            triangles_clipped: self.counters.clipped / rounds,
            triangles_drawn: self.counters.drawn / rounds,
            ..self.report
        }
    }
}

/// Rows of `area` in bands of bounded memory.
pub(crate) fn bands(area: &Crop, triangles: u32) -> Vec<Crop> {
    let pixels = BAND_PIXELS.max(8 * triangles as usize);
    let rows = ((pixels / area.width as usize).max(1)).min(area.height as usize) as u32;
    (0..area.height.div_ceil(rows))
        .map(|i| Crop { y: area.y + i * rows, height: rows.min(area.height - i * rows), ..*area })
        .collect()
}

/// Place of sample `index` of `count` in the pixel: the centre for one, else the Hammersley set, which
/// no row and no column of the sub-pixel grid holds twice.
pub(crate) fn sample_position(index: u32, count: u32) -> [f32; 2] {
    if count <= 1 {
        return [0.5; 2];
    }
    let radical_inverse = index.reverse_bits() as f64 / 2f64.powi(32);
    let half_step = 0.5 / f64::from(count);
    [(f64::from(index) / f64::from(count) + half_step) as f32, (radical_inverse + half_step).min(1.0) as f32]
}

/// Puts a transparent layer under those in `sum`. Returns how many pixels it has.
fn add_layer(
    shader: &Shader<'_>,
    window: &Window,
    layer: &Planes,
    sum: &mut [[f32; 4]],
    control: &Control<'_>,
) -> Result<u64, RenderError> {
    let width = window.area.width as usize;
    let shaded = AtomicU64::new(0);
    sum.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        if control.is_cancelled() {
            return;
        }
        let mut cache = SetupCache::new(shader);
        let mut count = 0;
        for (x, sum) in row.iter_mut().enumerate() {
            let pixel = y * width + x;
            let id = layer.ids[pixel];
            if id == NO_ID {
                continue;
            }
            let [px, py] = window.place(x, y);
            let [r, g, b, a] = shader.shade(cache.get(id), px, py, layer.depth[pixel]);
            let share = (1.0 - sum[3]) * a;
            *sum = [sum[0] + r * share, sum[1] + g * share, sum[2] + b * share, sum[3] + share];
            count += 1;
        }
        shaded.fetch_add(count, Ordering::Relaxed);
    });
    control.check()?;
    Ok(shaded.into_inner())
}

/// The triangles seen lately, ready to be shaded.
struct SetupCache<'a, 'w> {
    shader: &'a Shader<'w>,
    slots: [Option<TriangleSetup<'w>>; 64],
}

impl<'a, 'w> SetupCache<'a, 'w> {
    fn new(shader: &'a Shader<'w>) -> Self {
        Self { shader, slots: [const { None }; 64] }
    }

    /// Triangle `id`, which must be one.
    fn get(&mut self, id: u32) -> &TriangleSetup<'w> {
        let slot = &mut self.slots[(id % 64) as usize];
        match slot {
            Some(triangle) if triangle.id == id => {}
            _ => *slot = Some(self.shader.setup(id)),
        }
        slot.get_or_insert_with(|| self.shader.setup(id))
    }
}

/// Step 2: from what is seen to the picture.
struct Resolve<'a, 'w> {
    shader: &'a Shader<'w>,
    window: &'a Window,
    paper: &'a Paper<'a>,
    planes: &'a Planes,
    strokes: &'a Strokes,
    /// Colours of the opaque surface, if they are known already.
    ready: Option<&'a [[f32; 4]]>,
    /// What lies over it, colours times alpha.
    layers: Option<&'a [[f32; 4]]>,
    /// Share of this sample in the pixel.
    weight: f32,
    /// Whether this is the first sample, which replaces what is in the image.
    first: bool,
    control: &'a Control<'a>,
}

impl Resolve<'_, '_> {
    /// Fills the window's area of the picture, with colours times alpha. Returns the pixels shaded.
    fn run(&self, canvas: &mut Canvas<'_>) -> Result<u64, RenderError> {
        let (rows, stride, columns) = canvas.rows(&self.window.area);
        let shaded = AtomicU64::new(0);
        let cancelled = AtomicBool::new(false);
        let strips = rows.par_chunks_mut(STRIP_ROWS * stride);
        strips.enumerate().for_each(|(i, strip)| {
            if self.control.is_cancelled() {
                cancelled.store(true, Ordering::Relaxed);
                return;
            }
            shaded.fetch_add(self.strip(i * STRIP_ROWS, strip, stride, columns.start), Ordering::Relaxed);
        });
        if cancelled.into_inner() { Err(RenderError::Cancelled) } else { Ok(shaded.into_inner()) }
    }

    /// Rows from `first_row` of the area on, in blocks, so that a triangle's pixels come together.
    fn strip(&self, first_row: usize, strip: &mut [[f32; 4]], stride: usize, left: usize) -> u64 {
        let width = self.window.area.width as usize;
        let mut cache = SetupCache::new(self.shader);
        let mut shaded = 0;
        for start in (0..width).step_by(STRIP_ROWS) {
            let end = (start + STRIP_ROWS).min(width);
            for (j, row) in strip.chunks_mut(stride).enumerate() {
                let y = first_row + j;
                for x in start..end {
                    let (rgba, surface) = match self.shader.settings.channel {
                        Channel::Color => self.pixel(x, y, &mut cache),
                        channel => self.measure(channel, x, y, &mut cache),
                    };
                    put_sample(&mut row[left + x], rgba, self.weight, self.first);
                    shaded += u64::from(surface);
                }
            }
        }
        shaded
    }

    /// Value of a channel, and whether there is a surface.
    fn measure(
        &self,
        channel: Channel,
        x: usize,
        y: usize,
        cache: &mut SetupCache<'_, '_>,
    ) -> ([f32; 4], bool) {
        let pixel = y * self.window.area.width as usize + x;
        let id = self.planes.ids[pixel];
        if id == NO_ID {
            return (channel.of_nothing(), false);
        }
        let [px, py] = self.window.place(x, y);
        let seen = match id.checked_sub(self.shader.world.triangles) {
            Some(stroke) => self.strokes.seen(self.shader, stroke as usize, px, py),
            None => self.shader.seen(cache.get(id), px, py, self.planes.depth[pixel]),
        };
        (channel.of(self.shader, &seen), true)
    }

    /// Colour times alpha, and whether a surface was shaded for it.
    fn pixel(&self, x: usize, y: usize, cache: &mut SetupCache<'_, '_>) -> ([f32; 4], bool) {
        let pixel = y * self.window.area.width as usize + x;
        let id = self.planes.ids[pixel];
        let [px, py] = self.window.place(x, y);
        let surface = id != NO_ID;
        let behind = if !surface {
            self.paper.at((self.window.area.y as usize + y) as u32, || [px, py].map(f64::from))
        } else if let Some(stroke) = id.checked_sub(self.shader.world.triangles) {
            self.strokes.shade(self.shader, stroke as usize, px, py)
        } else if let Some(ready) = self.ready {
            ready[pixel]
        } else {
            self.shader.shade(cache.get(id), px, py, self.planes.depth[pixel])
        };
        let Some(layers) = self.layers else { return (behind, surface) };
        let over = layers[pixel];
        let through = 1.0 - over[3];
        (std::array::from_fn(|k| over[k] + through * behind[k]), surface)
    }
}

/// Adds a sample of weight `weight` to a pixel, or starts it with the first.
pub(crate) fn put_sample(pixel: &mut [f32; 4], rgba: [f32; 4], weight: f32, first: bool) {
    *pixel = match first {
        true if weight == 1.0 => rgba,
        true => rgba.map(|v| weight * v),
        false => std::array::from_fn(|k| pixel[k] + weight * rgba[k]),
    };
}

/// What is seen where nothing is.
pub(crate) struct Paper<'s> {
    background: Background,
    environment: Option<Environment<'s>>,
    view: View,
    size: [u32; 2],
}

impl<'s> Paper<'s> {
    /// The paper of a picture of `size` pixels.
    pub(crate) fn new(scene: &'s Scene, settings: &Settings, view: &View, size: [u32; 2]) -> Self {
        let blank =
            if settings.shading.is_lines() { Background::Color(LinearRgb::WHITE) } else { Background::None };
        let background = match (settings.background, scene.background) {
            (Some(wish), _) => wish,
            (None, Background::None) => blank,
            (None, of_scene) => of_scene,
        };
        let environment = Environment::of_background(scene, background);
        Self { background, environment, view: *view, size }
    }

    /// Colour times alpha in row `y` of the picture, seen through the place `[px, py]` in it.
    pub(crate) fn at(&self, y: u32, place: impl FnOnce() -> [f64; 2]) -> [f32; 4] {
        let color = match self.background {
            Background::None => return [0.0; 4],
            Background::Color(color) => color,
            Background::Gradient { bottom, top } => {
                let last = self.size[1].saturating_sub(1).max(1);
                top.lerp(bottom, y as f32 / last as f32)
            }
            Background::Environment { .. } => self.surroundings(place()),
        };
        [color.r, color.g, color.b, 1.0]
    }

    /// Light of the surroundings along the projector through a place of the picture.
    fn surroundings(&self, place: [f64; 2]) -> LinearRgb {
        let seen = self.environment.as_ref().zip(DeviceMap::to_pixels(self.size[0], self.size[1]).ok());
        let color = seen.and_then(|(environment, device)| {
            let ray = self.view.ray_through(&device, place.into())?;
            Some(environment.color(ray.direction.as_vec3()))
        });
        color.unwrap_or(LinearRgb::BLACK)
    }

    /// Divides colours by alpha where the paper shows through.
    pub(crate) fn finish(&self, canvas: &mut Canvas<'_>, area: &Crop) {
        if self.background != Background::None {
            return;
        }
        let (rows, stride, columns) = canvas.rows(area);
        rows.par_chunks_mut(stride).for_each(|row| {
            for pixel in &mut row[columns.clone()] {
                let a = pixel[3];
                if a > 0.0 && a < 1.0 {
                    *pixel = [pixel[0] / a, pixel[1] / a, pixel[2] / a, a];
                }
            }
        });
    }
}
