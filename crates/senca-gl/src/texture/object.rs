//! Texture objects: parameters, levels, and when they are complete.

use std::ops::RangeInclusive;

use super::{TexImage, View, next_level};
use crate::error::Error;
use crate::gl;
use crate::state::TexTarget;

/// Largest width and height of textures of one and two dimensions and of cube faces, without border.
pub(crate) const MAX_TEXTURE_SIZE: u32 = 8192;

/// Largest side of textures of three dimensions, without border.
pub(crate) const MAX_3D_TEXTURE_SIZE: u32 = 512;

/// Levels of a texture whose longest side has `size` texels.
pub(crate) fn levels_of(size: u32) -> u32 {
    u32::BITS - size.leading_zeros()
}

impl TexTarget {
    /// Target and face of a token that names an image: one of a cube is its face 0 to 5.
    pub(crate) fn from_image_token(token: u32) -> Option<(Self, usize)> {
        match token {
            gl::TEXTURE_CUBE_MAP_POSITIVE_X..=gl::TEXTURE_CUBE_MAP_NEGATIVE_Z => {
                Some((Self::Cube, (token - gl::TEXTURE_CUBE_MAP_POSITIVE_X) as usize))
            }
            gl::TEXTURE_CUBE_MAP => None,
            _ => Some((Self::of(token)?, 0)),
        }
    }

    /// Target of a token of a proxy.
    pub(crate) fn from_proxy_token(token: u32) -> Option<Self> {
        Some(match token {
            gl::PROXY_TEXTURE_1D => Self::One,
            gl::PROXY_TEXTURE_2D => Self::Two,
            gl::PROXY_TEXTURE_3D => Self::Three,
            gl::PROXY_TEXTURE_CUBE_MAP => Self::Cube,
            _ => return None,
        })
    }

    /// Dimensions of an image: 1 to 3.
    pub(crate) fn dimensions(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two | Self::Cube => 2,
            Self::Three => 3,
        }
    }

    /// Images of a level: 6 of a cube, else 1.
    pub(crate) fn faces(self) -> usize {
        if self == Self::Cube { 6 } else { 1 }
    }

    /// Largest side of the finest level, without border.
    pub(crate) fn max_size(self) -> u32 {
        if self == Self::Three { MAX_3D_TEXTURE_SIZE } else { MAX_TEXTURE_SIZE }
    }
}

/// Parameters of a texture. Values that are tokens are kept as tokens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TexParams {
    /// `TEXTURE_MIN_FILTER`. Default `NEAREST_MIPMAP_LINEAR`.
    pub(crate) min_filter: u32,
    /// `TEXTURE_MAG_FILTER`. Default `LINEAR`.
    pub(crate) mag_filter: u32,
    /// `TEXTURE_WRAP_S`, `_T`, `_R`. Default `REPEAT`.
    pub(crate) wrap: [u32; 3],
    /// `TEXTURE_BORDER_COLOR`, in [0, 1]. Default transparent black.
    pub(crate) border_color: [f32; 4],
    /// `TEXTURE_PRIORITY`, in [0, 1]. Default 1. Textures are always resident.
    pub(crate) priority: f32,
    /// `TEXTURE_MIN_LOD`. Default -1000.
    pub(crate) min_lod: f32,
    /// `TEXTURE_MAX_LOD`. Default 1000.
    pub(crate) max_lod: f32,
    /// `TEXTURE_LOD_BIAS`. Default 0.
    pub(crate) lod_bias: f32,
    /// `TEXTURE_BASE_LEVEL`. Default 0.
    pub(crate) base_level: u32,
    /// `TEXTURE_MAX_LEVEL`. Default 1000.
    pub(crate) max_level: u32,
    /// `TEXTURE_COMPARE_MODE`. Default `NONE`.
    pub(crate) compare_mode: u32,
    /// `TEXTURE_COMPARE_FUNC`. Default `LEQUAL`.
    pub(crate) compare_func: u32,
    /// `DEPTH_TEXTURE_MODE`. Default `LUMINANCE`.
    pub(crate) depth_mode: u32,
    /// `GENERATE_MIPMAP`. Default false.
    pub(crate) generate_mipmap: bool,
}

impl Default for TexParams {
    fn default() -> Self {
        Self {
            min_filter: gl::NEAREST_MIPMAP_LINEAR,
            mag_filter: gl::LINEAR,
            wrap: [gl::REPEAT; 3],
            border_color: [0.0; 4],
            priority: 1.0,
            min_lod: -1000.0,
            max_lod: 1000.0,
            lod_bias: 0.0,
            base_level: 0,
            max_level: 1000,
            compare_mode: gl::NONE,
            compare_func: gl::LEQUAL,
            depth_mode: gl::LUMINANCE,
            generate_mipmap: false,
        }
    }
}

const MIN_FILTERS: [u32; 6] = [
    gl::NEAREST,
    gl::LINEAR,
    gl::NEAREST_MIPMAP_NEAREST,
    gl::LINEAR_MIPMAP_NEAREST,
    gl::NEAREST_MIPMAP_LINEAR,
    gl::LINEAR_MIPMAP_LINEAR,
];
const WRAPS: [u32; 5] = [gl::CLAMP, gl::REPEAT, gl::CLAMP_TO_EDGE, gl::CLAMP_TO_BORDER, gl::MIRRORED_REPEAT];
const DEPTH_MODES: [u32; 3] = [gl::LUMINANCE, gl::INTENSITY, gl::ALPHA];

/// A value that must be one of some tokens.
fn token(value: f64, allowed: &[u32]) -> Result<u32, Error> {
    allowed.iter().copied().find(|&token| f64::from(token) == value).ok_or(Error::InvalidEnum)
}

/// A value that must be the number of a level.
fn level(value: f64) -> Result<u32, Error> {
    let rounded = value.round();
    if rounded >= 0.0 && rounded <= f64::from(i32::MAX) {
        Ok(rounded as u32)
    } else {
        Err(Error::InvalidValue)
    }
}

impl TexParams {
    /// Sets a parameter. `TEXTURE_BORDER_COLOR` takes four values, already as colours; others take the first.
    ///
    /// # Errors
    /// [`Error::InvalidEnum`] for another token, or a value that is not one of its tokens;
    /// [`Error::InvalidValue`] for a negative level.
    pub(crate) fn set(&mut self, pname: u32, values: &[f64]) -> Result<(), Error> {
        let &[value, ..] = values else { return Err(Error::InvalidValue) };
        match pname {
            gl::TEXTURE_MIN_FILTER => self.min_filter = token(value, &MIN_FILTERS)?,
            gl::TEXTURE_MAG_FILTER => self.mag_filter = token(value, &[gl::NEAREST, gl::LINEAR])?,
            gl::TEXTURE_WRAP_S => self.wrap[0] = token(value, &WRAPS)?,
            gl::TEXTURE_WRAP_T => self.wrap[1] = token(value, &WRAPS)?,
            gl::TEXTURE_WRAP_R => self.wrap[2] = token(value, &WRAPS)?,
            gl::TEXTURE_BORDER_COLOR => {
                let &[r, g, b, a] = values else { return Err(Error::InvalidEnum) };
                self.border_color = [r, g, b, a].map(|c| c.clamp(0.0, 1.0) as f32);
            }
            gl::TEXTURE_PRIORITY => self.priority = value.clamp(0.0, 1.0) as f32,
            gl::TEXTURE_MIN_LOD => self.min_lod = value as f32,
            gl::TEXTURE_MAX_LOD => self.max_lod = value as f32,
            gl::TEXTURE_LOD_BIAS => self.lod_bias = value as f32,
            gl::TEXTURE_BASE_LEVEL => self.base_level = level(value)?,
            gl::TEXTURE_MAX_LEVEL => self.max_level = level(value)?,
            gl::TEXTURE_COMPARE_MODE => {
                self.compare_mode = token(value, &[gl::NONE, gl::COMPARE_R_TO_TEXTURE])?;
            }
            gl::TEXTURE_COMPARE_FUNC => {
                let functions: Vec<u32> = (gl::NEVER..=gl::ALWAYS).collect();
                self.compare_func = token(value, &functions)?;
            }
            gl::DEPTH_TEXTURE_MODE => self.depth_mode = token(value, &DEPTH_MODES)?,
            gl::GENERATE_MIPMAP => self.generate_mipmap = value != 0.0,
            _ => return Err(Error::InvalidEnum),
        }
        Ok(())
    }

    /// Value of a parameter: four numbers of `TEXTURE_BORDER_COLOR`, else one in front; `None` for another token.
    pub(crate) fn get(&self, pname: u32) -> Option<[f64; 4]> {
        let one = |value: f64| [value, 0.0, 0.0, 0.0];
        Some(match pname {
            gl::TEXTURE_MIN_FILTER => one(f64::from(self.min_filter)),
            gl::TEXTURE_MAG_FILTER => one(f64::from(self.mag_filter)),
            gl::TEXTURE_WRAP_S => one(f64::from(self.wrap[0])),
            gl::TEXTURE_WRAP_T => one(f64::from(self.wrap[1])),
            gl::TEXTURE_WRAP_R => one(f64::from(self.wrap[2])),
            gl::TEXTURE_BORDER_COLOR => self.border_color.map(f64::from),
            gl::TEXTURE_PRIORITY => one(f64::from(self.priority)),
            gl::TEXTURE_RESIDENT => one(1.0),
            gl::TEXTURE_MIN_LOD => one(f64::from(self.min_lod)),
            gl::TEXTURE_MAX_LOD => one(f64::from(self.max_lod)),
            gl::TEXTURE_LOD_BIAS => one(f64::from(self.lod_bias)),
            gl::TEXTURE_BASE_LEVEL => one(f64::from(self.base_level)),
            gl::TEXTURE_MAX_LEVEL => one(f64::from(self.max_level)),
            gl::TEXTURE_COMPARE_MODE => one(f64::from(self.compare_mode)),
            gl::TEXTURE_COMPARE_FUNC => one(f64::from(self.compare_func)),
            gl::DEPTH_TEXTURE_MODE => one(f64::from(self.depth_mode)),
            gl::GENERATE_MIPMAP => one(f64::from(u8::from(self.generate_mipmap))),
            _ => return None,
        })
    }

    /// Whether the filter of minification looks at more than one level.
    pub(crate) fn uses_mipmaps(&self) -> bool {
        !matches!(self.min_filter, gl::NEAREST | gl::LINEAR)
    }
}

/// A texture object.
#[derive(Clone, Debug)]
pub(crate) struct Texture {
    /// Its name; 0 for the textures that are there from the start.
    pub(crate) name: u32,
    /// What it was first bound to.
    pub(crate) target: TexTarget,
    /// Its parameters.
    pub(crate) params: TexParams,
    /// The texture as drawing sees it, until something changes.
    view: Option<View>,
    /// Levels of each face, from the finest; missing ones at the end are left out.
    faces: Vec<Vec<Option<TexImage>>>,
}

impl Texture {
    /// A texture without images.
    pub(crate) fn new(name: u32, target: TexTarget) -> Self {
        let faces = vec![Vec::new(); target.faces()];
        Self { name, target, params: TexParams::default(), view: None, faces }
    }

    /// An image, if there is one.
    pub(crate) fn image(&self, face: usize, level: u32) -> Option<&TexImage> {
        self.faces.get(face)?.get(level as usize)?.as_ref()
    }

    /// An image to be changed.
    pub(crate) fn image_mut(&mut self, face: usize, level: u32) -> Option<&mut TexImage> {
        self.view = None;
        self.faces.get_mut(face)?.get_mut(level as usize)?.as_mut()
    }

    /// Takes an image out of its place.
    pub(crate) fn take_image(&mut self, face: usize, level: u32) -> Option<TexImage> {
        self.view = None;
        self.faces.get_mut(face)?.get_mut(level as usize)?.take()
    }

    /// Gives all parameters back.
    pub(crate) fn set_params(&mut self, params: TexParams) {
        if self.params != params {
            self.view = None;
            self.params = params;
        }
    }

    /// After a change of an image: makes mipmaps anew, if they follow the base level by themselves.
    ///
    /// # Errors
    /// As [`generate_mipmaps_of`](Self::generate_mipmaps_of).
    pub(crate) fn follow(&mut self, face: usize, level: u32) -> Result<(), Error> {
        if self.params.generate_mipmap && level == self.params.base_level {
            self.generate_mipmaps_of(face)?;
        }
        Ok(())
    }

    /// Puts an image in place; one without texels removes what was there.
    pub(crate) fn set_image(&mut self, face: usize, level: u32, image: Option<TexImage>) {
        self.view = None;
        let Some(levels) = self.faces.get_mut(face) else { return };
        let level = level as usize;
        if levels.len() <= level {
            levels.resize(level + 1, None);
        }
        levels[level] = image.filter(|image| image.size().iter().all(|&side| side > 0));
    }

    /// Sets a parameter, as [`TexParams::set`].
    ///
    /// # Errors
    /// As [`TexParams::set`].
    pub(crate) fn set_parameter(&mut self, pname: u32, values: &[f64]) -> Result<(), Error> {
        self.params.set(pname, values)?;
        self.view = None;
        Ok(())
    }

    /// Finest and coarsest level that sampling looks at, `None` if the texture is incomplete: sampling is then
    /// as if texturing were off.
    ///
    /// Source: OpenGL 1.5, section 3.8.10.
    pub(crate) fn sampled_levels(&self) -> Option<RangeInclusive<u32>> {
        let base = self.params.base_level;
        if !self.faces_agree() {
            return None;
        }
        if !self.params.uses_mipmaps() {
            return Some(base..=base);
        }
        if base > self.params.max_level {
            return None;
        }
        let last = self.last_level()?;
        let fine = self.image(0, base)?;
        let fits = |face: usize, level: u32| {
            let wanted = level_size(fine, level - base);
            self.image(face, level).is_some_and(|image| {
                image.size() == wanted
                    && image.format == fine.format
                    && image.border == fine.border
                    && image.is_present()
            })
        };
        let complete = (0..self.faces.len()).all(|face| (base..=last).all(|level| fits(face, level)));
        complete.then_some(base..=last)
    }

    /// The texture as drawing sees it; `None` if it is incomplete.
    pub(crate) fn view(&mut self) -> Option<View> {
        if self.view.is_none() {
            self.view = View::new(self);
        }
        self.view.clone()
    }

    /// Whether the images of the base level are there, and for a cube all square and alike.
    pub(crate) fn faces_agree(&self) -> bool {
        let base = self.params.base_level;
        let Some(first) = self.image(0, base).filter(|image| image.is_present()) else { return false };
        let square = self.target != TexTarget::Cube || first.width == first.height;
        square
            && (1..self.faces.len()).all(|face| {
                self.image(face, base).is_some_and(|image| {
                    image.size() == first.size()
                        && image.format == first.format
                        && image.border == first.border
                        && image.is_present()
                })
            })
    }

    /// Coarsest level of a whole set of mipmaps, bounded by the maximum level.
    fn last_level(&self) -> Option<u32> {
        let base = self.params.base_level;
        let fine = self.image(0, base)?;
        let longest = (0..self.target.dimensions()).map(|i| fine.size()[i] - 2 * fine.border).max()?;
        Some((base + levels_of(longest).saturating_sub(1)).min(self.params.max_level))
    }

    /// Makes the levels behind the base level by reduction, up to the maximum level.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`]; the levels made so far stay.
    pub(crate) fn generate_mipmaps(&mut self) -> Result<(), Error> {
        (0..self.faces.len()).try_for_each(|face| self.generate_mipmaps_of(face))
    }

    /// Makes the levels behind the base level of one face.
    ///
    /// # Errors
    /// As [`generate_mipmaps`](Self::generate_mipmaps).
    pub(crate) fn generate_mipmaps_of(&mut self, face: usize) -> Result<(), Error> {
        let TexParams { base_level, max_level, .. } = self.params;
        for level in base_level..max_level {
            let Some(smaller) = self.image(face, level).and_then(next_level) else { break };
            self.set_image(face, level + 1, Some(smaller?));
        }
        Ok(())
    }
}

/// Size with border that an image `steps` levels behind `fine` must have.
fn level_size(fine: &TexImage, steps: u32) -> [u32; 3] {
    let border = 2 * fine.border;
    fine.size().map(|side| {
        let inner = if side == 1 { return 1 } else { side - border };
        (inner.checked_shr(steps).unwrap_or(0)).max(1) + border
    })
}
