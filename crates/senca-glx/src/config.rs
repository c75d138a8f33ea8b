//! Kinds of buffers, and the choice among them (GLX 1.4, section 3.3.3).

use crate::server::VisualKind;
use senca_gl::Config;
use x11_dl::glx::*;

/// Most pairs of a list of attributes that are read.
pub(crate) const MAX_ATTRIBUTES: usize = 64;

/// Bits of a component of the accumulation buffer, where there is one.
const ACCUM_BITS: u32 = 16;

/// The smallest value that a pair of an attribute with any value has.
const DONT_CARE: i32 = GLX_DONT_CARE;

/// A kind of buffers for windows of a visual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FbConfig {
    pub(crate) screen: i32,
    /// Number on its screen, from 0.
    pub(crate) index: usize,
    pub(crate) visual: VisualKind,
    pub(crate) double_buffered: bool,
    pub(crate) accumulates: bool,
}

/// All kinds of a screen, those first that are taken when a program does not care.
pub(crate) fn all(screen: i32, visuals: &[VisualKind]) -> Vec<FbConfig> {
    let mut kinds: Vec<VisualKind> = Vec::new();
    for visual in visuals {
        // Servers list a visual for each kind of buffers that they could have themselves; one is enough here.
        if !kinds.iter().any(|k| (k.depth, k.masks) == (visual.depth, visual.masks)) {
            kinds.push(*visual);
        }
    }
    let mut configs = Vec::new();
    for visual in kinds {
        for (double_buffered, accumulates) in [(false, false), (false, true), (true, false), (true, true)] {
            configs.push(FbConfig { screen, index: configs.len(), visual, double_buffered, accumulates });
        }
    }
    configs
}

impl FbConfig {
    /// What a context and its drawables are made with.
    pub(crate) fn gl(&self) -> Config {
        Config {
            float_color: false,
            double_buffered: self.double_buffered,
            depth_bits: 24,
            stencil_bits: 8,
            accum_bits: if self.accumulates { ACCUM_BITS } else { 0 },
        }
    }

    /// The pointer that C knows it by.
    pub(crate) fn handle(&self) -> usize {
        ((self.screen as usize) << 16 | (self.index + 1)) << 4
    }

    /// Screen and number of a pointer.
    pub(crate) fn place_of(handle: usize) -> Option<(i32, usize)> {
        let (screen, number) = (handle >> 20, handle >> 4 & 0xffff);
        Some((i32::try_from(screen).ok()?, number.checked_sub(1)?))
    }

    /// Its number for X.
    fn id(&self) -> i32 {
        0x1000 + (self.screen << 8) + self.index as i32
    }

    /// The value of an attribute; `None` for one that there is not.
    pub(crate) fn attribute(&self, name: i32) -> Option<i32> {
        let accum = self.gl().accum_bits as i32;
        let color = |k: usize| self.visual.masks[k].count_ones() as i32;
        let side = senca_gl::max_window_side() as i32;
        Some(match name {
            GLX_USE_GL | GLX_RGBA | GLX_X_RENDERABLE => 1,
            GLX_BUFFER_SIZE => color(0) + color(1) + color(2) + 8,
            GLX_DOUBLEBUFFER => self.double_buffered.into(),
            GLX_LEVEL | GLX_STEREO | GLX_AUX_BUFFERS | GLX_SAMPLE_BUFFERS | GLX_SAMPLES => 0,
            GLX_RED_SIZE => color(0),
            GLX_GREEN_SIZE => color(1),
            GLX_BLUE_SIZE => color(2),
            GLX_ALPHA_SIZE | GLX_STENCIL_SIZE => 8,
            GLX_DEPTH_SIZE => 24,
            GLX_ACCUM_RED_SIZE | GLX_ACCUM_GREEN_SIZE | GLX_ACCUM_BLUE_SIZE | GLX_ACCUM_ALPHA_SIZE => accum,
            GLX_CONFIG_CAVEAT | GLX_TRANSPARENT_TYPE => GLX_NONE,
            GLX_X_VISUAL_TYPE => GLX_TRUE_COLOR,
            GLX_TRANSPARENT_INDEX_VALUE
            | GLX_TRANSPARENT_RED_VALUE
            | GLX_TRANSPARENT_GREEN_VALUE
            | GLX_TRANSPARENT_BLUE_VALUE
            | GLX_TRANSPARENT_ALPHA_VALUE => 0,
            GLX_VISUAL_ID => self.visual.id as i32,
            GLX_SCREEN => self.screen,
            GLX_DRAWABLE_TYPE => GLX_WINDOW_BIT | GLX_PIXMAP_BIT | GLX_PBUFFER_BIT,
            GLX_RENDER_TYPE => GLX_RGBA_BIT,
            GLX_FBCONFIG_ID => self.id(),
            GLX_MAX_PBUFFER_WIDTH | GLX_MAX_PBUFFER_HEIGHT => side,
            GLX_MAX_PBUFFER_PIXELS => side * side,
            _ => return None,
        })
    }

    /// Whether it has what a pair of `glXChooseFBConfig` asks for.
    fn has(&self, name: i32, wanted: i32) -> bool {
        let Some(value) = self.attribute(name) else { return false };
        match name {
            _ if wanted == DONT_CARE => true,
            GLX_DRAWABLE_TYPE | GLX_RENDER_TYPE => value & wanted == wanted,
            GLX_DOUBLEBUFFER | GLX_STEREO | GLX_X_RENDERABLE => (value != 0) == (wanted != 0),
            GLX_LEVEL | GLX_CONFIG_CAVEAT | GLX_X_VISUAL_TYPE | GLX_TRANSPARENT_TYPE | GLX_VISUAL_ID
            | GLX_FBCONFIG_ID => value == wanted,
            // Compared only with kinds that are transparent, and not to be asked for.
            GLX_TRANSPARENT_INDEX_VALUE..=GLX_TRANSPARENT_ALPHA_VALUE
            | GLX_MAX_PBUFFER_WIDTH..=GLX_MAX_PBUFFER_PIXELS => true,
            _ => value >= wanted,
        }
    }
}

/// The kinds that fit a list of pairs, the best first.
pub(crate) fn choose(configs: &[FbConfig], wanted: &[(i32, i32)]) -> Vec<FbConfig> {
    // A number leaves everything else aside.
    let number = wanted.iter().find(|(name, _)| *name == GLX_FBCONFIG_ID);
    let wanted = number.map_or(wanted, std::slice::from_ref);
    configs.iter().filter(|c| wanted.iter().all(|(name, value)| c.has(*name, *value))).copied().collect()
}

/// What a list of `glXChooseVisual` asks for, whose true values stand alone; `None` for an unknown attribute
/// or when no colours are asked for, but indices.
pub(crate) fn visual_pairs(list: &[i32]) -> Option<Vec<(i32, i32)>> {
    let (mut pairs, mut colors) = (vec![], false);
    let (mut double, mut stereo) = (0, 0);
    let mut list = list.iter().copied();
    while let Some(name) = list.next() {
        match name {
            GLX_USE_GL => {}
            GLX_RGBA => colors = true,
            GLX_DOUBLEBUFFER => double = 1,
            GLX_STEREO => stereo = 1,
            GLX_BUFFER_SIZE
            | GLX_LEVEL
            | GLX_AUX_BUFFERS
            | GLX_RED_SIZE..=GLX_ACCUM_ALPHA_SIZE
            | GLX_CONFIG_CAVEAT..=GLX_TRANSPARENT_ALPHA_VALUE
            | GLX_SAMPLE_BUFFERS
            | GLX_SAMPLES => {
                let value = list.next()?;
                // Indices only: nothing for colours.
                if name != GLX_BUFFER_SIZE {
                    pairs.push((name, value));
                }
            }
            _ => return None,
        }
    }
    pairs.extend([(GLX_DOUBLEBUFFER, double), (GLX_STEREO, stereo)]);
    colors.then_some(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASKS: [u32; 3] = [0xff_0000, 0xff00, 0xff];

    fn configs() -> Vec<FbConfig> {
        let visual = |id, depth| VisualKind { id, depth, masks: MASKS, visual: 0 };
        all(0, &[visual(33, 24), visual(34, 24), visual(99, 32)])
    }

    #[test]
    fn one_visual_of_a_kind_with_four_kinds_of_buffers() {
        let configs = configs();
        assert_eq!(configs.len(), 8);
        for (k, config) in configs.iter().enumerate() {
            assert_eq!(FbConfig::place_of(config.handle()), Some((0, k)));
            assert_eq!(config.visual.id, if k < 4 { 33 } else { 99 });
        }
        assert_eq!(FbConfig::place_of(0), None);
    }

    #[test]
    fn choices() {
        let configs = configs();
        let first = |wanted: &[(i32, i32)]| choose(&configs, wanted).first().map(|c| c.index);
        assert_eq!(first(&[]), Some(0));
        assert_eq!(first(&[(GLX_DOUBLEBUFFER, 1), (GLX_DEPTH_SIZE, 1)]), Some(2));
        assert_eq!(first(&[(GLX_DOUBLEBUFFER, DONT_CARE), (GLX_ACCUM_RED_SIZE, 8)]), Some(1));
        assert_eq!(first(&[(GLX_VISUAL_ID, 99)]), Some(4));
        assert_eq!(first(&[(GLX_FBCONFIG_ID, configs[6].id()), (GLX_SAMPLES, 4)]), Some(6));
        for none in
            [(GLX_SAMPLES, 4), (GLX_STEREO, 1), (GLX_DEPTH_SIZE, 32), (GLX_RENDER_TYPE, 2), (12345, 0)]
        {
            assert_eq!(first(&[none]), None, "{none:?}");
        }
    }

    #[test]
    fn lists_for_visuals() {
        let list = [GLX_RGBA, GLX_DEPTH_SIZE, 16, GLX_DOUBLEBUFFER];
        let expected = vec![(GLX_DEPTH_SIZE, 16), (GLX_DOUBLEBUFFER, 1), (GLX_STEREO, 0)];
        assert_eq!(visual_pairs(&list), Some(expected));
        assert_eq!(visual_pairs(&[GLX_DOUBLEBUFFER]), None);
        assert_eq!(visual_pairs(&[GLX_RGBA, 4711, 1]), None);
        assert_eq!(visual_pairs(&[GLX_RGBA, GLX_RED_SIZE]), None);
    }
}
