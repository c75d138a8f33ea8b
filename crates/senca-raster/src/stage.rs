//! Per-fragment operations by code of the caller's, with its hands on the pixels.
//!
//! A [`crate::FragmentShader`] gives colours, and the rasterizer does the rest. A [`FragmentStage`] does
//! the rest, too: it tests and changes depth, stencil and colour of sixteen pixels at a time, in
//! whatever order its rules want. What an OpenGL state machine needs between rasterization and the
//! framebuffer goes here.

use crate::api::{Fragments, LANES, Shaded, Shading, State};
use crate::multisample::{SAMPLES, place_of};
use crate::target::{ColorPlane, Target};

/// Colours fragments and merges them into the pixels. Called from several threads at once; what it
/// does must depend on nothing but the fragments and the pixels given.
///
/// For each batch the rasterizer
///
/// 1. tests depth, unless [`FragmentStage::tests_depth`];
/// 2. calls [`FragmentStage::shade`], unless there is nothing to shade;
/// 3. calls [`FragmentStage::merge`] with the lanes that are left;
/// 4. writes depth and identifiers of the lanes that returns; depth only if it has tested it.
pub trait FragmentStage: Sync {
    /// Whether the stage tests and writes depth itself, and so wants all covered fragments: when what
    /// becomes of those that fail matters. Default: no, the rasterizer does it by
    /// [`State::depth_test`] before anything is shaded.
    fn tests_depth(&self) -> bool {
        false
    }

    /// Whether fragments may come to nothing, in [`FragmentStage::shade`] or in
    /// [`FragmentStage::merge`]. Default: yes. A stage that never drops any lets the rasterizer hide
    /// more behind what it draws.
    fn discards(&self) -> bool {
        true
    }

    /// Whether [`FragmentStage::shade`] is to be called. Default: yes.
    fn shades(&self) -> bool {
        true
    }

    /// Whether colours are read or written. Default: yes.
    fn touches_color(&self) -> bool {
        true
    }

    /// Whether stencil values are read or written. Default: yes.
    fn touches_stencil(&self) -> bool {
        true
    }

    /// As [`crate::FragmentShader::shade`].
    fn shade(&self, fragments: &Fragments<'_>, out: &mut Shaded);

    /// Merges the lanes in `fragments.mask`, coloured as in `shaded`, into their pixels, and returns
    /// those of them that have passed all tests. Pixels of other lanes must be left as they are.
    fn merge(&self, fragments: &Fragments<'_>, shaded: &Shaded, pixels: &mut Pixels<'_>) -> u16;

    /// [`FragmentStage::shade`] and then [`FragmentStage::merge`], which a stage may do in one go where pixels
    /// have one sample.
    fn shade_and_merge(&self, fragments: &Fragments<'_>, pixels: &mut Pixels<'_>) -> u16 {
        let mut shaded = Shaded::default();
        self.shade(fragments, &mut shaded);
        let kept = Fragments { mask: fragments.mask & shaded.keep, ..*fragments };
        if kept.mask == 0 { 0 } else { self.merge(&kept, &shaded, pixels) & kept.mask }
    }

    /// The same where pixels have several samples: colours `fragments` once and merges `samples`, each into its
    /// own of `pixels`. Returns the lanes that have passed all tests, for each sample.
    fn shade_and_merge_samples(
        &self,
        fragments: &Fragments<'_>,
        samples: &Samples<'_>,
        pixels: &mut [Pixels<'_>; SAMPLES],
    ) -> [u16; SAMPLES] {
        let mut shaded = Shaded::default();
        if self.shades() {
            self.shade(fragments, &mut shaded);
        }
        let mut passed = [0; SAMPLES];
        for (s, pixels) in pixels.iter_mut().enumerate() {
            let mask = samples.masks[s] & shaded.keep;
            if mask != 0 {
                let sample = Fragments { mask, sample: s, depth: samples.depths[s], ..*fragments };
                passed[s] = self.merge(&sample, &shaded, pixels) & mask;
            }
        }
        passed
    }
}

/// The samples of sixteen pixels that a primitive covers.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Lanes, for each sample.
    pub masks: [u16; SAMPLES],
    /// Depths of the samples.
    pub depths: &'a [[f32; LANES]; SAMPLES],
}

/// Sixteen pixels of a target, in the lanes of [`Fragments`].
#[derive(Debug)]
pub struct Pixels<'a> {
    /// Colours.
    pub color: PixelColors<'a>,
    /// Depths, if the target has them.
    pub depth: Option<&'a mut [f32; LANES]>,
    /// Stencil values, if the target has them.
    pub stencil: Option<&'a mut [u8; LANES]>,
}

/// Colours of sixteen pixels.
#[derive(Debug)]
pub enum PixelColors<'a> {
    /// The target has none, or the stage does not touch them.
    None,
    /// Of [`ColorPlane::Rgba8`]: red in the lowest byte, alpha in the highest.
    Rgba8(&'a mut [u32; LANES]),
    /// Of [`ColorPlane::Rgba32F`]: red, green, blue, alpha.
    Rgba32F([&'a mut [f32; LANES]; 4]),
}

/// What a stage asks of a draw.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StageNeeds {
    pub(crate) tests_depth: bool,
    pub(crate) discards: bool,
    pub(crate) shades: bool,
    pub(crate) color: bool,
    pub(crate) stencil: bool,
}

impl StageNeeds {
    pub(crate) fn of(stage: &dyn FragmentStage) -> Self {
        Self {
            tests_depth: stage.tests_depth(),
            discards: stage.discards(),
            shades: stage.shades(),
            color: stage.touches_color(),
            stencil: stage.touches_stencil(),
        }
    }
}

/// The stage of a shading, if it is one.
pub(crate) fn stage_of<'a>(shading: &Shading<'a>) -> Option<&'a dyn FragmentStage> {
    match shading {
        Shading::Stage(stage) => Some(*stage),
        _ => None,
    }
}

/// Pixels copied out of a target, two rows of 8.
struct Copied {
    rgba8: [u32; LANES],
    rgba: [[f32; LANES]; 4],
    depth: [f32; LANES],
    stencil: [u8; LANES],
    /// Where lane `i` is in the planes; none outside the target.
    at: [Option<usize>; LANES],
}

impl Copied {
    /// The pixels at (`x`, `y`) of a target whose first row is `first_row`.
    fn new(target: &Target<'_>, x: u32, y: u32, first_row: i32) -> Self {
        Self::of(target, first_row, |i| (x as usize + i % 8, y as usize + i / 8))
    }

    /// The pixels of a target whose first row is `first_row`; `place` gives column and row of a lane.
    fn of(target: &Target<'_>, first_row: i32, place: impl Fn(usize) -> (usize, usize)) -> Self {
        let (width, height) = (i64::from(target.width), i64::from(target.height));
        let at = std::array::from_fn(|i| {
            let (column, row) = place(i);
            let (column, row) = (column as i64, row as i64 - i64::from(first_row));
            let inside = column < width && (0..height).contains(&row);
            inside.then(|| (row * width + column) as usize)
        });
        let mut copied =
            Self { rgba8: [0; LANES], rgba: [[0.0; LANES]; 4], depth: [0.0; LANES], stencil: [0; LANES], at };
        for (i, at) in at.into_iter().enumerate() {
            let Some(at) = at else { continue };
            match &target.color {
                Some(ColorPlane::Rgba8(p)) => copied.rgba8[i] = u32::from_le_bytes(p[at]),
                Some(ColorPlane::Rgba32F(p)) => (0..4).for_each(|k| copied.rgba[k][i] = p[at][k]),
                None => {}
            }
            copied.depth[i] = target.depth.as_ref().map_or(0.0, |p| p[at]);
            copied.stencil[i] = target.stencil.as_ref().map_or(0, |p| p[at]);
        }
        copied
    }

    fn pixels(&mut self, target: &Target<'_>, needs: &StageNeeds) -> Pixels<'_> {
        let [r, g, b, a] = &mut self.rgba;
        Pixels {
            color: match target.color.as_ref().filter(|_| needs.color) {
                None => PixelColors::None,
                Some(ColorPlane::Rgba8(_)) => PixelColors::Rgba8(&mut self.rgba8),
                Some(ColorPlane::Rgba32F(_)) => PixelColors::Rgba32F([r, g, b, a]),
            },
            depth: target.depth.is_some().then_some(&mut self.depth),
            stencil: (target.stencil.is_some() && needs.stencil).then_some(&mut self.stencil),
        }
    }

    /// Writes what a stage has made of the pixels, and depth and identifiers of those that passed.
    fn finish(
        &mut self,
        target: &mut Target<'_>,
        state: &State,
        needs: &StageNeeds,
        fragments: &Fragments<'_>,
        passed: u16,
    ) {
        let written = || (0..LANES).filter(|i| passed >> i & 1 == 1);
        if state.depth_write && !needs.tests_depth {
            written().for_each(|i| self.depth[i] = fragments.depth[i]);
        }
        self.put_back(target, fragments.mask);
        if let Some(ids) = &mut target.ids {
            written().filter_map(|i| self.at[i]).for_each(|at| ids[at] = fragments.id);
        }
    }

    fn put_back(&self, target: &mut Target<'_>, lanes: u16) {
        for i in (0..LANES).filter(|i| lanes >> i & 1 == 1) {
            let Some(at) = self.at[i] else { continue };
            match &mut target.color {
                Some(ColorPlane::Rgba8(p)) => p[at] = self.rgba8[i].to_le_bytes(),
                Some(ColorPlane::Rgba32F(p)) => p[at] = std::array::from_fn(|k| self.rgba[k][i]),
                None => {}
            }
            if let Some(p) = &mut target.depth {
                p[at] = self.depth[i];
            }
            if let Some(p) = &mut target.stencil {
                p[at] = self.stencil[i];
            }
        }
    }
}

/// Runs a stage on 4 x 4 pixels of several samples: the plain form. `fragments` says which pixels are to
/// be coloured, `masks` and `depths` which samples are covered, and have passed the depth test if that
/// is not the stage's business. Returns how many samples passed.
pub(crate) fn run_stage_on_samples(
    stage: &dyn FragmentStage,
    target: &mut Target<'_>,
    first_row: i32,
    state: &State,
    fragments: &Fragments<'_>,
    masks: &[u16; SAMPLES],
    depths: &[[f32; LANES]; SAMPLES],
) -> u64 {
    let needs = StageNeeds::of(stage);
    let mut shaded = Shaded::default();
    if needs.shades {
        stage.shade(fragments, &mut shaded);
    }
    let corner = [2 * fragments.x as usize, 2 * fragments.y as usize];
    let mut count = 0;
    for s in (0..SAMPLES).filter(|&s| masks[s] & shaded.keep != 0) {
        let sample = Fragments { mask: masks[s] & shaded.keep, sample: s, depth: depths[s], ..*fragments };
        let mut copied = Copied::of(target, first_row, |i| {
            let (x, y) = place_of(s, i);
            (corner[0] + x, corner[1] + y)
        });
        let passed = stage.merge(&sample, &shaded, &mut copied.pixels(target, &needs)) & sample.mask;
        copied.finish(target, state, &needs, &sample, passed);
        count += u64::from(passed.count_ones());
    }
    count
}

/// Runs a stage on a batch whose depth has been tested if that is not the stage's business: the plain
/// form. `first_row` is the row at which the target begins. Returns the lanes that passed.
pub(crate) fn run_stage(
    stage: &dyn FragmentStage,
    target: &mut Target<'_>,
    first_row: i32,
    state: &State,
    fragments: &Fragments<'_>,
) -> u16 {
    let needs = StageNeeds::of(stage);
    let mut shaded = Shaded::default();
    if needs.shades {
        stage.shade(fragments, &mut shaded);
    }
    let kept = Fragments { mask: fragments.mask & shaded.keep, ..*fragments };
    if kept.mask == 0 {
        return 0;
    }
    let mut copied = Copied::new(target, fragments.x, fragments.y, first_row);
    let passed = stage.merge(&kept, &shaded, &mut copied.pixels(target, &needs)) & kept.mask;
    copied.finish(target, state, &needs, &kept, passed);
    passed
}
