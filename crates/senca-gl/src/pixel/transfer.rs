//! What happens to pixels between client memory and the framebuffer or a texture.
//!
//! Colours are scaled and biased, then looked up channel by channel. Indices are shifted and offset, then looked
//! up as colours, or as stencil values. Depths are scaled and biased.
//!
//! Source: OpenGL 1.5, section 3.6.5 and figure 3.7; the optional imaging subset is not part of it.

use super::convert::unit;
use crate::error::Error;
use crate::gl;

/// Largest size of a pixel map.
pub const MAX_PIXEL_MAP_TABLE: usize = 65_536;

/// Pixel transfer modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTransfer {
    /// Factors of red, green, blue and alpha. Default 1.
    pub scale: [f32; 4],
    /// Added to red, green, blue and alpha after scaling. Default 0.
    pub bias: [f32; 4],
    /// Factor of depths. Default 1.
    pub depth_scale: f32,
    /// Added to depths. Default 0.
    pub depth_bias: f32,
    /// Bits that indices are shifted to the left; negative: to the right. Default 0.
    pub index_shift: i32,
    /// Added to indices after the shift. Default 0.
    pub index_offset: i32,
    /// Look colours up in the maps of colours to colours. Default false.
    pub map_color: bool,
    /// Look stencil values up in the map of stencil values. Default false.
    pub map_stencil: bool,
}

impl Default for PixelTransfer {
    fn default() -> Self {
        Self::PLAIN
    }
}

impl PixelTransfer {
    /// Nothing happens to pixels.
    pub const PLAIN: Self = Self {
        scale: [1.0; 4],
        bias: [0.0; 4],
        depth_scale: 1.0,
        depth_bias: 0.0,
        index_shift: 0,
        index_offset: 0,
        map_color: false,
        map_stencil: false,
    };

    /// Sets a mode by its token. Booleans are true if not 0, integers are rounded.
    ///
    /// # Errors
    /// [`Error::InvalidEnum`] for another token.
    pub fn set(&mut self, pname: u32, value: f32) -> Result<(), Error> {
        match pname {
            gl::MAP_COLOR => self.map_color = value != 0.0,
            gl::MAP_STENCIL => self.map_stencil = value != 0.0,
            gl::INDEX_SHIFT => self.index_shift = value.round() as i32,
            gl::INDEX_OFFSET => self.index_offset = value.round() as i32,
            gl::RED_SCALE => self.scale[0] = value,
            gl::GREEN_SCALE => self.scale[1] = value,
            gl::BLUE_SCALE => self.scale[2] = value,
            gl::ALPHA_SCALE => self.scale[3] = value,
            gl::RED_BIAS => self.bias[0] = value,
            gl::GREEN_BIAS => self.bias[1] = value,
            gl::BLUE_BIAS => self.bias[2] = value,
            gl::ALPHA_BIAS => self.bias[3] = value,
            gl::DEPTH_SCALE => self.depth_scale = value,
            gl::DEPTH_BIAS => self.depth_bias = value,
            _ => return Err(Error::InvalidEnum),
        }
        Ok(())
    }

    /// Value of a mode by its token, `None` for another token.
    #[must_use]
    pub fn get(&self, pname: u32) -> Option<f64> {
        Some(match pname {
            gl::MAP_COLOR => f64::from(u8::from(self.map_color)),
            gl::MAP_STENCIL => f64::from(u8::from(self.map_stencil)),
            gl::INDEX_SHIFT => f64::from(self.index_shift),
            gl::INDEX_OFFSET => f64::from(self.index_offset),
            gl::RED_SCALE => f64::from(self.scale[0]),
            gl::GREEN_SCALE => f64::from(self.scale[1]),
            gl::BLUE_SCALE => f64::from(self.scale[2]),
            gl::ALPHA_SCALE => f64::from(self.scale[3]),
            gl::RED_BIAS => f64::from(self.bias[0]),
            gl::GREEN_BIAS => f64::from(self.bias[1]),
            gl::BLUE_BIAS => f64::from(self.bias[2]),
            gl::ALPHA_BIAS => f64::from(self.bias[3]),
            gl::DEPTH_SCALE => f64::from(self.depth_scale),
            gl::DEPTH_BIAS => f64::from(self.depth_bias),
            _ => return None,
        })
    }

    fn shifted(&self, index: u32) -> u32 {
        let shift = self.index_shift.unsigned_abs();
        let moved = if self.index_shift >= 0 { index.checked_shl(shift) } else { index.checked_shr(shift) }
            .unwrap_or(0);
        moved.wrapping_add_signed(self.index_offset)
    }
}

/// The ten pixel maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelMap {
    /// `PIXEL_MAP_I_TO_I`: colour index to colour index.
    IToI,
    /// `PIXEL_MAP_S_TO_S`: stencil value to stencil value.
    SToS,
    /// `PIXEL_MAP_I_TO_R`.
    IToR,
    /// `PIXEL_MAP_I_TO_G`.
    IToG,
    /// `PIXEL_MAP_I_TO_B`.
    IToB,
    /// `PIXEL_MAP_I_TO_A`.
    IToA,
    /// `PIXEL_MAP_R_TO_R`.
    RToR,
    /// `PIXEL_MAP_G_TO_G`.
    GToG,
    /// `PIXEL_MAP_B_TO_B`.
    BToB,
    /// `PIXEL_MAP_A_TO_A`.
    AToA,
}

impl PixelMap {
    /// All maps, in the order of their tokens.
    pub const ALL: [Self; 10] = [
        Self::IToI,
        Self::SToS,
        Self::IToR,
        Self::IToG,
        Self::IToB,
        Self::IToA,
        Self::RToR,
        Self::GToG,
        Self::BToB,
        Self::AToA,
    ];

    /// Map of a token, `None` if it names none.
    #[must_use]
    pub fn from_token(token: u32) -> Option<Self> {
        Self::ALL.get(token.checked_sub(gl::PIXEL_MAP_I_TO_I)? as usize).copied()
    }

    /// Map whose size a token (`PIXEL_MAP_I_TO_I_SIZE` ...) asks for, `None` if it asks for none.
    #[must_use]
    pub fn from_size_token(token: u32) -> Option<Self> {
        Self::ALL.get(token.checked_sub(gl::PIXEL_MAP_I_TO_I_SIZE)? as usize).copied()
    }

    /// Whether what is looked up is an index: then the size must be a power of two.
    #[must_use]
    pub fn is_by_index(self) -> bool {
        !matches!(self, Self::RToR | Self::GToG | Self::BToB | Self::AToA)
    }

    /// Whether what is found is an index and not a colour.
    #[must_use]
    pub fn gives_index(self) -> bool {
        matches!(self, Self::IToI | Self::SToS)
    }
}

/// Tables of the pixel maps. Default: one entry of 0 in each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PixelMaps {
    /// Empty for the default table of one 0.
    tables: [Vec<f32>; 10],
}

/// The table of a map that was never set.
const UNSET: &[f32] = &[0.0];

impl PixelMaps {
    /// Tables of one 0 each.
    pub const UNSET: Self = Self { tables: [const { Vec::new() }; 10] };

    /// Replaces a table. Colours are clamped to [0, 1]; indices are kept as they are.
    ///
    /// # Errors
    /// [`Error::InvalidValue`] if there are no or more than [`MAX_PIXEL_MAP_TABLE`] entries, or if their number
    /// must be a power of two and is not.
    pub fn set(&mut self, map: PixelMap, values: &[f32]) -> Result<(), Error> {
        let n = values.len();
        if n == 0 || n > MAX_PIXEL_MAP_TABLE || map.is_by_index() && !n.is_power_of_two() {
            return Err(Error::InvalidValue);
        }
        let kept = |&value: &f32| if map.gives_index() { value } else { unit(value) };
        self.tables[map as usize] = values.iter().map(kept).collect();
        Ok(())
    }

    /// Entries of a table, at least one.
    #[must_use]
    pub fn table(&self, map: PixelMap) -> &[f32] {
        let table = &self.tables[map as usize];
        if table.is_empty() { UNSET } else { table }
    }

    /// Entry an index points to, cut to the size of the table.
    fn by_index(&self, map: PixelMap, index: u32) -> f32 {
        let table = self.table(map);
        table[index as usize & (table.len() - 1)]
    }

    /// Entry nearest to a value of [0, 1].
    fn by_value(&self, map: PixelMap, value: f32) -> f32 {
        let table = self.table(map);
        table[(unit(value) * (table.len() - 1) as f32 + 0.5) as usize]
    }
}

/// Pixel transfer modes with the maps they look up.
#[derive(Clone, Copy, Debug)]
pub struct Transfer<'a> {
    /// Modes.
    pub modes: &'a PixelTransfer,
    /// Maps.
    pub maps: &'a PixelMaps,
}

static UNSET_MAPS: PixelMaps = PixelMaps::UNSET;

impl Transfer<'static> {
    /// Nothing happens to pixels.
    #[must_use]
    pub fn plain() -> Self {
        Self { modes: &PixelTransfer::PLAIN, maps: &UNSET_MAPS }
    }
}

impl Transfer<'_> {
    /// Whether colours stay as they are, but for the clamp.
    #[must_use]
    pub fn keeps_colors(&self) -> bool {
        self.modes.scale == [1.0; 4] && self.modes.bias == [0.0; 4] && !self.modes.map_color
    }

    /// Whether depths stay as they are, but for the clamp.
    #[must_use]
    pub fn keeps_depths(&self) -> bool {
        self.modes.depth_scale == 1.0 && self.modes.depth_bias == 0.0
    }

    /// Whether stencil values stay as they are.
    #[must_use]
    pub fn keeps_stencils(&self) -> bool {
        self.modes.index_shift == 0 && self.modes.index_offset == 0 && !self.modes.map_stencil
    }

    /// Colours scaled, biased and mapped, then clamped to [0, 1].
    pub fn colors(&self, colors: &mut [[f32; 4]]) {
        if !self.keeps_colors() {
            let PixelTransfer { scale, bias, .. } = self.modes;
            for color in colors.iter_mut() {
                *color = std::array::from_fn(|i| color[i] * scale[i] + bias[i]);
            }
        }
        if self.modes.map_color {
            const MAPS: [PixelMap; 4] = [PixelMap::RToR, PixelMap::GToG, PixelMap::BToB, PixelMap::AToA];
            for color in colors.iter_mut() {
                *color = std::array::from_fn(|i| self.maps.by_value(MAPS[i], color[i]));
            }
        }
        for value in colors.as_flattened_mut() {
            *value = unit(*value);
        }
    }

    /// Colours that indices stand for, after shift and offset.
    pub fn colors_from_indices(&self, indices: &[u32], colors: &mut [[f32; 4]]) {
        const MAPS: [PixelMap; 4] = [PixelMap::IToR, PixelMap::IToG, PixelMap::IToB, PixelMap::IToA];
        for (color, &index) in colors.iter_mut().zip(indices) {
            let index = self.modes.shifted(index);
            *color = MAPS.map(|map| self.maps.by_index(map, index));
        }
    }

    /// Stencil values shifted, offset and mapped.
    pub fn stencils(&self, stencils: &mut [u32]) {
        for stencil in stencils {
            *stencil = self.modes.shifted(*stencil);
            if self.modes.map_stencil {
                *stencil = (self.maps.by_index(PixelMap::SToS, *stencil) + 0.5) as u32;
            }
        }
    }

    /// Depths scaled and biased, then clamped to [0, 1].
    pub fn depths(&self, depths: &mut [f32]) {
        let PixelTransfer { depth_scale, depth_bias, .. } = *self.modes;
        for depth in depths {
            *depth = unit(*depth * depth_scale + depth_bias);
        }
    }
}
