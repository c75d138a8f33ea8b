//! The planes that are drawn to, in the hands of who draws.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use senca_raster::{BlockDepths, ColorPlane, Target};

use super::attach::Attachment;
use super::object::{Framebuffers, window_colors};
use super::plane::{Area, Plane, side};
use crate::texture::Texels;

/// Where a plane goes back to.
#[derive(Clone, Debug)]
enum Home {
    WindowColor(usize),
    WindowDepthStencil,
    Attachment(Attachment),
}

/// A plane away from home.
#[derive(Debug)]
struct Taken {
    plane: Plane,
    home: Home,
}

/// The planes of the framebuffer that is drawn to. Must go back with [`Framebuffers::put_back`].
#[derive(Debug)]
pub(crate) struct DrawPlanes {
    colors: Vec<Taken>,
    /// Depths, with the stencil values if both are one image.
    depth: Option<Taken>,
    /// Stencil values, if apart.
    stencil: Option<Taken>,
    /// Depth values count.
    uses_depth: bool,
    /// The stencil values of `depth` count.
    stencil_with_depth: bool,
    /// Pixels that all planes have.
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// 0 without multisampling.
    pub(crate) samples: u32,
    /// Planes of earlier copies, with anything in them.
    spares: Vec<Plane>,
}

impl Framebuffers {
    /// Takes the planes that are drawn to. The framebuffer should be complete; what is not there is left out.
    pub(crate) fn take_planes(&mut self) -> DrawPlanes {
        self.take_planes_for(0..u32::MAX)
    }

    /// As [`take_planes`](Self::take_planes), for who changes pixels in some rows only.
    pub(crate) fn take_planes_for(&mut self, rows: Range<u32>) -> DrawPlanes {
        if self.draw_object().is_none() {
            self.window.note_changed(rows);
        }
        let (colors, depth, stencil) = match self.draw_object() {
            Some(object) => {
                let home = |attachment: &Attachment| {
                    Some(Home::Attachment(attachment.clone())).filter(|_| !attachment.is_none())
                };
                let colors: Vec<Home> =
                    object.color_of(object.draw_buffer).and_then(home).into_iter().collect();
                let stencil = home(&object.stencil).filter(|_| !object.stencil.is(&object.depth));
                (colors, home(&object.depth), stencil)
            }
            None => {
                let colors = window_colors(self.window_draw, self.config.double_buffered).unwrap_or_default();
                (colors.into_iter().map(Home::WindowColor).collect(), Some(Home::WindowDepthStencil), None)
            }
        };
        let same = self.draw_object().is_none_or(|object| object.stencil.is(&object.depth));
        let colors: Vec<Taken> = colors.into_iter().filter_map(|home| self.take(home)).collect();
        let depth = depth.and_then(|home| self.take(home));
        let stencil = stencil.and_then(|home| self.take(home));
        let spares = std::mem::take(&mut self.spares);
        DrawPlanes { spares, ..DrawPlanes::new(colors, depth, stencil, same) }
    }

    fn take(&mut self, home: Home) -> Option<Taken> {
        let lend = |plane: &mut Plane| {
            let empty = Plane { texels: Arc::new(Texels::EMPTY), ..plane.clone() };
            std::mem::replace(plane, empty)
        };
        let plane = match &home {
            Home::WindowColor(i) => self.window.colors.get_mut(*i).map(lend),
            Home::WindowDepthStencil => self.window.depth_stencil.as_mut().map(lend),
            Home::Attachment(attachment) => attachment.take(),
        };
        Some(Taken { plane: plane?, home })
    }

    /// Brings planes home.
    pub(crate) fn put_back(&mut self, planes: DrawPlanes) {
        self.spares = planes.spares;
        for Taken { plane, home } in planes.colors.into_iter().chain(planes.depth).chain(planes.stencil) {
            match home {
                Home::WindowColor(i) => self.window.colors[i] = plane,
                Home::WindowDepthStencil => self.window.depth_stencil = Some(plane),
                Home::Attachment(attachment) => attachment.put_back(plane),
            }
        }
    }
}

impl DrawPlanes {
    fn new(colors: Vec<Taken>, depth: Option<Taken>, stencil: Option<Taken>, same: bool) -> Self {
        let has_depth = |taken: &Taken| taken.plane.format.base().has_depth();
        let uses_depth = depth.as_ref().is_some_and(has_depth);
        let stencil_with_depth =
            same && depth.as_ref().is_some_and(|taken| taken.plane.format.base().has_stencil());
        let mut planes = Self {
            colors,
            depth,
            stencil,
            uses_depth,
            stencil_with_depth,
            width: 0,
            height: 0,
            samples: 0,
            spares: Vec::new(),
        };
        let area = planes.all().map(|plane| plane.area()).reduce(Area::intersect);
        planes.samples = planes.all().map(|plane| plane.samples).max().unwrap_or(0);
        if let Some(area) = area {
            (planes.width, planes.height) = (area.x1 as u32, area.y1 as u32);
        }
        planes
    }

    fn all(&self) -> impl Iterator<Item = &Plane> {
        self.colors.iter().chain(&self.depth).chain(&self.stencil).map(|taken| &taken.plane)
    }

    /// Number of colour planes: 0, 1, or 2 for front and back of the window.
    pub(crate) fn color_count(&self) -> usize {
        self.colors.len()
    }

    /// All pixels.
    pub(crate) fn area(&self) -> Area {
        Area::of([0, 0, self.width as i32, self.height as i32])
    }

    #[cfg(test)]
    pub(crate) fn color(&mut self, i: usize) -> &mut Plane {
        &mut self.colors[i].plane
    }

    /// Whether all planes are of one size and one number of samples.
    pub(crate) fn are_alike(&self) -> bool {
        let size = (self.width, self.height, self.samples);
        self.all().all(|plane| plane.is_present() && (plane.width, plane.height, plane.samples) == size)
    }

    /// All colour planes.
    pub(crate) fn colors_mut(&mut self) -> impl Iterator<Item = &mut Plane> {
        self.colors.iter_mut().map(|taken| &mut taken.plane)
    }

    pub(crate) fn depth(&mut self) -> Option<&mut Plane> {
        self.depth.as_mut().filter(|_| self.uses_depth).map(|taken| &mut taken.plane)
    }

    /// The depths as blocks, where draws touch nothing else: those that are there, or, `cleared` to one depth
    /// first, new ones. `None` if the planes do not allow it.
    pub(crate) fn depth_blocks(&mut self, cleared: bool) -> Option<&mut BlockDepths> {
        if self.samples > 0 || !self.uses_depth || !self.are_alike() {
            return None;
        }
        let plane = &mut self.depth.as_mut()?.plane;
        let whole = plane.range() == (0..plane.texels.len());
        let (width, height) = (plane.width, plane.height);
        // A copy of what others hold on to is not worth it.
        let texels = Arc::get_mut(&mut plane.texels).filter(|_| whole)?;
        let (Texels::Depth(depths) | Texels::DepthStencil { depth: depths, .. }) = texels else {
            return None;
        };
        if cleared { depths.fresh_blocks(width, height) } else { depths.blocks_mut() }
    }

    pub(crate) fn stencil(&mut self) -> Option<&mut Plane> {
        let taken = if self.stencil_with_depth { self.depth.as_mut() } else { self.stencil.as_mut() };
        taken.map(|taken| &mut taken.plane)
    }

    /// Draws: calls `draw` with the planes as a target, once for each colour plane, or once if there is none. If
    /// there are several, depth and stencil before the first are those before each. A target of several samples
    /// has twice the width and height; `draw` is told the number of samples along each side of a pixel. Without
    /// `multisample` it gets pixels in any case, and all samples take what it draws; it may change those of `area` only.
    ///
    /// Returns what the last call did, the default if there is nothing to draw to.
    pub(crate) fn draw<R: Default>(
        &mut self,
        multisample: bool,
        uses: &Uses,
        area: Area,
        mut draw: impl FnMut(Target<'_>, u32) -> R,
    ) -> R {
        let area = area.intersect(self.area());
        let count = self.colors.len().max(1);
        let mut result = R::default();
        for i in 0..count {
            let kept = (i + 1 < count).then(|| [&self.depth, &self.stencil].map(texels_of));
            let drawn = if self.samples > 0 && !multisample {
                self.draw_single(i, uses, area, &mut draw)
            } else {
                self.draw_one(i, &mut draw)
            };
            result = drawn.unwrap_or_default();
            if let Some([depth, stencil]) = kept {
                restore(&mut self.depth, depth);
                restore(&mut self.stencil, stencil);
            }
        }
        result
    }

    fn draw_one<R>(&mut self, i: usize, draw: &mut impl FnMut(Target<'_>, u32) -> R) -> Option<R> {
        let side = side(self.samples) as u32;
        let (width, height) = (self.width * side, self.height * side);
        if width == 0 || height == 0 {
            return None;
        }
        let fits =
            |plane: &Plane| plane.is_present() && (plane.width, plane.height) == (self.width, self.height);
        if !self.all().all(fits) {
            return self.draw_cut(i, draw);
        }
        let Self { colors, depth, stencil, uses_depth, stencil_with_depth, .. } = self;
        let mut target = Target::new(width, height).ok()?;
        if let Some(taken) = colors.get_mut(i) {
            let range = taken.plane.range();
            target = match taken.plane.texels_mut() {
                Texels::Rgba8(colors) => target.with_color(ColorPlane::Rgba8(&mut colors[range])).ok()?,
                Texels::Rgba32F(colors) => target.with_color(ColorPlane::Rgba32F(&mut colors[range])).ok()?,
                _ => target,
            };
        }
        if let Some(taken) = depth {
            let range = taken.plane.range();
            let (depths, stencils) = match taken.plane.texels_mut() {
                Texels::DepthStencil { depth, stencil } => (Some(depth), Some(stencil)),
                Texels::Depth(depth) => (Some(depth), None),
                Texels::Stencil(stencil) => (None, Some(stencil)),
                _ => (None, None),
            };
            if let Some(depths) = depths.filter(|_| *uses_depth) {
                target = target.with_depth(&mut depths[range.clone()]).ok()?;
            }
            if let Some(stencils) = stencils.filter(|_| *stencil_with_depth) {
                target = target.with_stencil(&mut stencils[range]).ok()?;
            }
        }
        if let Some(taken) = stencil {
            let range = taken.plane.range();
            if let Some(stencils) = taken.plane.texels_mut().stencils_mut() {
                target = target.with_stencil(&mut stencils[range]).ok()?;
            }
        }
        Some(draw(target, side))
    }

    /// As [`draw_one`](Self::draw_one) for planes of different sizes: draws to copies of what they have in common.
    fn draw_cut<R>(&mut self, i: usize, draw: &mut impl FnMut(Target<'_>, u32) -> R) -> Option<R> {
        let mut copies = self.copies(i, self.samples)?;
        copies.each_pair(self, i, |copy, plane| copy_common(plane, copy));
        let result = copies.draw_one(0, draw)?;
        copies.each_pair(self, i, |copy, plane| copy_common(copy, plane));
        Some(result)
    }

    /// As [`draw_one`](Self::draw_one) for planes of several samples: draws to one sample of each pixel, and gives
    /// all samples of the pixels that changed what it has become.
    fn draw_single<R>(
        &mut self,
        i: usize,
        uses: &Uses,
        area: Area,
        draw: &mut impl FnMut(Target<'_>, u32) -> R,
    ) -> Option<R> {
        if area.is_empty() {
            return None;
        }
        let mut copies = self.copies(i, 0)?;
        copies.each_pair(self, i, |copy, plane| first_samples(plane, copy, uses, area));
        let result = copies.draw_one(0, draw)?;
        let mut changed = Vec::new();
        if uses.0.contains(&Use::Changed) {
            changed.resize(area.columns(1).len() * area.lines(1).len(), false);
            copies.each_pair(self, i, |copy, plane| mark_changes(copy, plane, uses, area, &mut changed));
        }
        copies.each_pair(self, i, |copy, plane| spread(copy, plane, uses, area, &changed));
        self.spares.clear();
        let used = copies.colors.into_iter().chain(copies.depth).chain(copies.stencil);
        self.spares.extend(used.map(|taken| taken.plane));
        Some(result)
    }

    /// Planes of the size that all have in common, with colour plane `i` as the only one. What is in them is
    /// not said.
    fn copies(&mut self, i: usize, samples: u32) -> Option<Self> {
        let (width, height) = (self.width, self.height);
        let mut spares = std::mem::take(&mut self.spares);
        let mut copy = |taken: &Taken| {
            let size = (taken.plane.format, width, height, samples);
            let fits = |spare: &Plane| (spare.format, spare.width, spare.height, spare.samples) == size;
            let plane = match spares.iter().position(fits) {
                Some(spare) => spares.swap_remove(spare),
                None => Plane::new(taken.plane.format, width, height, samples)?,
            };
            taken.plane.is_present().then(|| Taken { plane, home: taken.home.clone() })
        };
        let mut one =
            |taken: &Option<Taken>| taken.as_ref().map(&mut copy).map_or(Some(None), |copy| copy.map(Some));
        let (depth, stencil) = (one(&self.depth)?, one(&self.stencil)?);
        let colors = self.colors.get(i).map(copy).into_iter().collect::<Option<Vec<_>>>()?;
        Some(Self { colors, depth, stencil, samples, spares: Vec::new(), ..*self })
    }

    /// Calls `act` with each plane of copies and the one it is a copy of.
    fn each_pair(&mut self, others: &mut Self, i: usize, mut act: impl FnMut(&mut Plane, &mut Plane)) {
        let colors = self.colors.first_mut().zip(others.colors.get_mut(i));
        let depths = self.depth.as_mut().zip(others.depth.as_mut());
        let stencils = self.stencil.as_mut().zip(others.stencil.as_mut());
        for (copy, other) in [colors, depths, stencils].into_iter().flatten() {
            act(&mut copy.plane, &mut other.plane);
        }
    }
}

/// What a draw does to the values of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// It leaves them alone.
    Kept,
    /// It may change some.
    Changed,
    /// It sets all of them.
    Cleared,
}

/// What a draw does to colours, depths and stencil values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Uses(pub(crate) [Use; 3]);

/// Calls a function with the values of two planes of the same kind and their place in [`Uses`], and of what they
/// have two kinds, twice.
macro_rules! for_values {
    ($a:expr, $b:expr, |$x:ident, $y:ident, $of:ident| $act:expr) => {
        match ($a, $b) {
            (Texels::Rgba8($x), Texels::Rgba8($y)) => {
                let $of = 0;
                $act
            }
            (Texels::Rgba32F($x), Texels::Rgba32F($y)) => {
                let $of = 0;
                $act
            }
            (Texels::Depth($x), Texels::Depth($y)) => {
                let $of = 1;
                $act
            }
            (Texels::Stencil($x), Texels::Stencil($y)) => {
                let $of = 2;
                $act
            }
            (
                Texels::DepthStencil { depth: d1, stencil: s1 },
                Texels::DepthStencil { depth: d2, stencil: s2 },
            ) => {
                let ($x, $y, $of) = (d1, d2, 1);
                $act;
                let ($x, $y, $of) = (s1, s2, 2);
                $act;
            }
            _ => {}
        }
    };
}

/// Rows of pixels that a thread takes at once.
const ROWS: usize = 32;

/// Texels of the rows of pixels that an area has.
fn span(plane: &Plane, area: Area) -> Range<usize> {
    let lines = area.lines(plane.side());
    plane.at(0, lines.start)..plane.at(0, lines.end)
}

/// Copies the first sample of each pixel of an area.
fn first_samples(from: &Plane, to: &mut Plane, uses: &Uses, area: Area) {
    let (width, stride) = (to.stride(), 2 * from.stride());
    let (one, four) = (span(to, area), span(from, area));
    let (ones, fours) = (area.columns(1), area.columns(2));
    for_values!(&*from.texels, to.texels_mut(), |a, b, of| {
        if uses.0[of] == Use::Changed {
            let rows = b[one.clone()].par_chunks_mut(width).zip(a[four.clone()].par_chunks(stride));
            rows.with_min_len(ROWS).for_each(|(to, from)| {
                let pixels = from[fours.clone()].as_chunks::<2>().0;
                to[ones.clone()].iter_mut().zip(pixels).for_each(|(to, from)| *to = from[0]);
            });
        }
    });
}

/// Marks the pixels of an area that are not what the first sample of `four` is.
fn mark_changes(one: &Plane, four: &Plane, uses: &Uses, area: Area, changed: &mut [bool]) {
    let (width, stride) = (one.stride(), 2 * four.stride());
    let (ones, fours) = (area.columns(1), area.columns(2));
    for_values!(&*one.texels, &*four.texels, |a, b, of| {
        if uses.0[of] == Use::Changed {
            let rows = a[span(one, area)].par_chunks(width).zip(b[span(four, area)].par_chunks(stride));
            let rows = rows.zip(changed.par_chunks_mut(ones.len()));
            rows.with_min_len(ROWS).for_each(|((new, old), changed)| {
                let pixels = new[ones.clone()].iter().zip(old[fours.clone()].as_chunks::<2>().0);
                changed.iter_mut().zip(pixels).for_each(|(changed, (new, old))| *changed |= *new != old[0]);
            });
        }
    });
}

/// Copies pixels of an area to all their samples: those that have changed, or all where all are set.
fn spread(from: &Plane, to: &mut Plane, uses: &Uses, area: Area, changed: &[bool]) {
    let (width, stride) = (from.stride(), to.stride());
    let (one, four) = (span(from, area), span(to, area));
    let (ones, fours) = (area.columns(1), area.columns(2));
    for_values!(&*from.texels, to.texels_mut(), |a, b, of| {
        let rows = b[four.clone()].par_chunks_mut(2 * stride).zip(a[one.clone()].par_chunks(width));
        let rows = rows.with_min_len(ROWS);
        match uses.0[of] {
            Use::Kept => {}
            Use::Cleared => rows.for_each(|(to, from)| {
                let (upper, lower) = to.split_at_mut(stride);
                let (upper, lower) = (&mut upper[fours.clone()], &mut lower[fours.clone()]);
                let pixels = upper.as_chunks_mut::<2>().0.iter_mut().zip(&from[ones.clone()]);
                pixels.for_each(|(to, from)| *to = [*from; 2]);
                lower.copy_from_slice(upper);
            }),
            Use::Changed => {
                let rows = rows.zip(changed.par_chunks(ones.len()));
                rows.filter(|(_, changed)| changed.contains(&true)).for_each(|((to, from), changed)| {
                    for to in to.chunks_exact_mut(stride) {
                        let to = to[fours.clone()].as_chunks_mut::<2>().0;
                        let pixels = to.iter_mut().zip(&from[ones.clone()]).zip(changed);
                        pixels.filter(|(_, changed)| **changed).for_each(|((to, from), _)| *to = [*from; 2]);
                    }
                });
            }
        }
    });
}

fn texels_of(taken: &Option<Taken>) -> Option<Texels> {
    taken.as_ref().map(|taken| (*taken.plane.texels).clone())
}

fn restore(taken: &mut Option<Taken>, texels: Option<Texels>) {
    if let (Some(taken), Some(texels)) = (taken, texels) {
        taken.plane.texels = Arc::new(texels);
    }
}

/// Copies what two planes have in common from one to the other.
fn copy_common(from: &Plane, to: &mut Plane) {
    let (width, rows) = (from.stride().min(to.stride()), from.rows().min(to.rows()));
    for y in 0..rows {
        let (a, b) = (from.at(0, y), to.at(0, y));
        to.texels_mut().copy_run(b, &from.texels, a, width);
    }
}
