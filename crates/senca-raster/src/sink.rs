//! Where the fragments of lines, points and antialiased triangles go: a strip of the target, one
//! fragment after another.

use crate::api::{ColorSource, Compare, Counters, Fragments, LANES, MAX_VARYINGS, Shaded, Shading, State};
use crate::multisample::{SAMPLES, place_of, sample_of};
use crate::setup::{Bounds, ScreenMap};
use crate::shade::color_of_values;
use crate::stage::{run_stage, run_stage_on_samples, stage_of};
use crate::target::{ColorPlane, Target};

/// A strip of the target, and what is drawn into it.
pub(crate) struct Sink<'a, 't> {
    target: &'a mut Target<'t>,
    /// Row of the whole target at which the strip begins.
    first_row: i32,
    /// Pixels of the whole target that may be written.
    pub(crate) bounds: Bounds,
    pub(crate) state: &'a State,
    shading: &'a Shading<'a>,
    /// Fragments go together to the caller's code.
    batched: bool,
    tests_depth: bool,
    /// Pixels have several samples.
    samples: bool,
    id: u32,
    front: bool,
    stride: usize,
    batch: Batch,
    values: [f32; MAX_VARYINGS],
    pub(crate) counters: Counters,
}

/// Planes of a strip, for fragments in plain colours.
pub(crate) struct Plain<'a> {
    pub(crate) pixels: &'a mut [[u8; 4]],
    pub(crate) depth: Option<&'a mut [f32]>,
    pub(crate) width: usize,
    pub(crate) first_row: usize,
    pub(crate) color: ColorSource,
    pub(crate) counters: &'a mut Counters,
}

impl Plain<'_> {
    /// Whether a fragment passes the depth test at a pixel, which then has its depth.
    #[inline(always)]
    pub(crate) fn passes(&mut self, at: usize, depth: f32, state: &State) -> bool {
        self.counters.tested += 1;
        if let Some(stored) = self.depth.as_mut().and_then(|plane| plane.get_mut(at)) {
            if !state.depth_test.passes(depth, *stored) {
                return false;
            }
            if state.depth_write {
                *stored = depth;
            }
        }
        self.counters.passed += 1;
        self.counters.shaded += 1;
        true
    }

    /// A fragment of a colour.
    #[inline(always)]
    pub(crate) fn put(&mut self, at: usize, depth: f32, state: &State, color: [u8; 4]) {
        if self.passes(at, depth, state)
            && let Some(pixel) = self.pixels.get_mut(at)
        {
            *pixel = color;
        }
    }
}

/// Fragments of one primitive, of two rows of 8 pixels.
struct Batch {
    x: i32,
    y: i32,
    /// Pixels with a fragment.
    mask: u16,
    /// Of each sample, where there are several; else the first is that of the pixel.
    masks: [u16; SAMPLES],
    depths: [[f32; LANES]; SAMPLES],
    /// Of each pixel with several samples: that of its last one.
    depth: [f32; LANES],
    coverage: [f32; LANES],
}

impl<'a, 't> Sink<'a, 't> {
    pub(crate) fn new(
        target: &'a mut Target<'t>,
        first_row: i32,
        state: &'a State,
        shading: &'a Shading<'a>,
        map: &ScreenMap,
    ) -> Self {
        let strip =
            Bounds { x0: 0, y0: first_row, x1: target.width as i32, y1: first_row + target.height as i32 };
        Self {
            bounds: strip.intersect(map.bounds),
            target,
            first_row,
            state,
            shading,
            batched: matches!(shading, Shading::Custom(_) | Shading::Stage(_)),
            tests_depth: stage_of(shading).is_none_or(|stage| !stage.tests_depth()),
            samples: state.multisample && stage_of(shading).is_some(),
            id: 0,
            front: true,
            stride: 0,
            batch: Batch {
                x: 0,
                y: 0,
                mask: 0,
                masks: [0; SAMPLES],
                depths: [[0.0; LANES]; SAMPLES],
                depth: [0.0; LANES],
                coverage: [1.0; LANES],
            },
            values: [0.0; MAX_VARYINGS],
            counters: Counters::default(),
        }
    }

    /// Begins a primitive of `stride` varyings.
    pub(crate) fn begin(&mut self, id: u32, front: bool, stride: usize) {
        (self.id, self.front, self.stride) = (id, front, stride.min(MAX_VARYINGS));
    }

    /// The planes, where fragments go in plain colours, unblended, to 8 bits.
    pub(crate) fn plain(&mut self) -> Option<Plain<'_>> {
        let color = self.shading.plain_color()?;
        let stencil = self.state.stencil.is_some() && self.target.stencil.is_some();
        let simple = self.state.blend.is_none() && self.target.ids.is_none() && !stencil;
        let width = self.target.width as usize;
        let Some(ColorPlane::Rgba8(pixels)) = self.target.color.as_mut().filter(|_| simple) else {
            return None;
        };
        // A test that all pass and that leaves no trace needs no look at the depths.
        let looks = self.state.depth_write || self.state.depth_test != Compare::Always;
        Some(Plain {
            pixels,
            depth: self.target.depth.as_deref_mut().filter(|_| looks),
            width,
            first_row: self.first_row as usize,
            color,
            counters: &mut self.counters,
        })
    }

    /// A fragment; `values` gives the varyings at a pixel. No pixel may come twice in a primitive.
    #[inline(always)]
    pub(crate) fn fragment(
        &mut self,
        [x, y]: [i64; 2],
        depth: f32,
        coverage: f32,
        values: &impl Fn(i32, i32, &mut [f32]),
    ) {
        let b = self.bounds;
        let inside =
            x >= i64::from(b.x0) && x < i64::from(b.x1) && y >= i64::from(b.y0) && y < i64::from(b.y1);
        if !inside {
            return;
        }
        let (x, y) = (x as i32, y as i32);
        let row = y - self.first_row;
        self.counters.tested += 1;
        let passes = match self.shading {
            Shading::Stage(_) => {
                !self.tests_depth || crate::pixel::depth_passes(self.target, self.state, x, row, depth)
            }
            _ => crate::pixel::passes(self.target, self.state, x, row, depth),
        };
        if !passes {
            return;
        }
        if self.batched {
            self.gather(x, y, depth, coverage, values);
            return;
        }
        let mut rgba = None;
        if !matches!(self.shading, Shading::None) {
            let out = &mut self.values[..self.stride];
            values(x, y, out);
            let mut color = color_of_values(self.shading, out);
            color[3] *= coverage;
            rgba = Some(color);
            self.counters.shaded += 1;
            if self.shading.alpha_test().is_some_and(|test| !test.passes(color[3])) {
                return;
            }
        }
        self.counters.passed += 1;
        crate::pixel::write(self.target, self.state, x, row, depth, self.id, rgba);
    }

    fn gather(&mut self, x: i32, y: i32, depth: f32, coverage: f32, values: &impl Fn(i32, i32, &mut [f32])) {
        let (block_x, block_y) = (x & !7, if self.samples { y & !7 } else { y & !1 });
        if self.batch.mask != 0 && (block_x, block_y) != (self.batch.x, self.batch.y) {
            self.end(values);
        }
        (self.batch.x, self.batch.y) = (block_x, block_y);
        if self.samples {
            let (sample, lane) = sample_of((x & 7) as usize, (y & 7) as usize);
            self.batch.mask |= 1 << lane;
            self.batch.masks[sample] |= 1 << lane;
            self.batch.depths[sample][lane] = depth;
            self.batch.depth[lane] = depth;
            self.batch.coverage[lane] = coverage;
            return;
        }
        let lane = ((y & 1) * 8 + (x & 7)) as usize;
        self.batch.mask |= 1 << lane;
        self.batch.depths[0][lane] = depth;
        self.batch.coverage[lane] = coverage;
    }

    /// Ends a primitive.
    #[inline(always)]
    pub(crate) fn end(&mut self, values: &impl Fn(i32, i32, &mut [f32])) {
        if self.batch.mask != 0 {
            self.flush(values);
        }
    }

    fn flush(&mut self, values: &impl Fn(i32, i32, &mut [f32])) {
        let mut planes = [[0.0; LANES]; MAX_VARYINGS];
        let mut at_lane = [0.0; MAX_VARYINGS];
        for lane in 0..LANES {
            let (x, y) = if self.samples { place_of(0, lane) } else { (lane % 8, lane / 8) };
            let (x, y) = (self.batch.x + x as i32, self.batch.y + y as i32);
            values(x, y, &mut at_lane[..self.stride]);
            for (plane, value) in planes.iter_mut().zip(&at_lane[..self.stride]) {
                plane[lane] = *value;
            }
        }
        let (coverage, smooth) = (self.batch.coverage, self.state.antialias);
        let side = if self.samples { 2 } else { 1 };
        let fragments = Fragments {
            x: self.batch.x as u32 / side,
            y: self.batch.y as u32 / side,
            columns: 8 / side,
            sample: 0,
            mask: std::mem::take(&mut self.batch.mask),
            depth: if self.samples { self.batch.depth } else { self.batch.depths[0] },
            varyings: &planes[..self.stride],
            id: self.id,
            front: self.front,
            coverage: smooth.then_some(&coverage),
        };
        self.counters.shaded += u64::from(fragments.mask.count_ones());
        match self.shading {
            Shading::Stage(stage) if self.samples => {
                let masks = std::mem::take(&mut self.batch.masks);
                let depths = &self.batch.depths;
                let (target, row) = (&mut *self.target, self.first_row);
                self.counters.passed +=
                    run_stage_on_samples(*stage, target, row, self.state, &fragments, &masks, depths);
            }
            Shading::Stage(stage) => {
                let passed = run_stage(*stage, self.target, self.first_row, self.state, &fragments);
                self.counters.passed += u64::from(passed.count_ones());
            }
            Shading::Custom(shader) => {
                let mut shaded = Shaded::default();
                shader.shade(&fragments, &mut shaded);
                self.write(&fragments, &shaded);
            }
            Shading::None | Shading::Fixed(_) => {}
        }
    }

    fn write(&mut self, fragments: &Fragments<'_>, shaded: &Shaded) {
        self.counters.passed += u64::from(fragments.mask.count_ones());
        for lane in fragments.lanes().filter(|lane| shaded.keep >> lane & 1 == 1) {
            let (x, y) = (fragments.column(lane) as i32, fragments.row(lane) as i32 - self.first_row);
            let mut rgba = shaded.rgba.map(|plane| plane[lane]);
            rgba[3] *= fragments.coverage.map_or(1.0, |c| c[lane]);
            crate::pixel::write(self.target, self.state, x, y, fragments.depth[lane], self.id, Some(rgba));
        }
    }
}
