//! Depths of an image: row by row, or in blocks as a shadow map is drawn.

use senca_raster::BlockDepths;
use std::ops::{Deref, DerefMut};
use std::sync::OnceLock;

/// Depths of an image. Seen as a slice, they are there row by row; who looks at them so where they are kept in
/// blocks has them unfolded once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Depths {
    rows: OnceLock<Vec<f32>>,
    blocks: Option<Box<BlockDepths>>,
}

impl Depths {
    /// Number of depths.
    pub(crate) fn len(&self) -> usize {
        match &self.blocks {
            Some(blocks) => blocks.width() as usize * blocks.height() as usize,
            None => self.rows.get().map_or(0, Vec::len),
        }
    }

    /// The depth of a texel; 0 if there is none.
    pub(crate) fn get(&self, index: usize) -> f32 {
        match (self.rows.get(), &self.blocks) {
            (Some(rows), _) => rows.get(index).copied().unwrap_or_default(),
            (None, Some(blocks)) if index < self.len() => {
                let width = blocks.width() as usize;
                blocks.get((index % width) as u32, (index / width) as u32)
            }
            _ => 0.0,
        }
    }

    /// The blocks, if depths are kept so and have not been unfolded since.
    pub(crate) fn blocks(&self) -> Option<&BlockDepths> {
        self.blocks.as_deref().filter(|_| self.rows.get().is_none())
    }

    /// The blocks, whether or not they have been unfolded.
    pub(crate) fn kept_blocks(&self) -> Option<&BlockDepths> {
        self.blocks.as_deref()
    }

    /// The blocks to draw to, if depths are kept so.
    pub(crate) fn blocks_mut(&mut self) -> Option<&mut BlockDepths> {
        let blocks = self.blocks.as_deref_mut()?;
        self.rows = OnceLock::new();
        Some(blocks)
    }

    /// Blocks of an image of this size, whose depths are about to be cleared: what they are now is lost. `None` if
    /// it is too large.
    pub(crate) fn fresh_blocks(&mut self, width: u32, height: u32) -> Option<&mut BlockDepths> {
        let fits = |blocks: &BlockDepths| (blocks.width(), blocks.height()) == (width, height);
        if !self.blocks.as_deref().is_some_and(fits) {
            self.blocks = Some(Box::new(BlockDepths::new(width, height, 0.0).ok()?));
        }
        self.blocks_mut()
    }
}

impl From<Vec<f32>> for Depths {
    fn from(rows: Vec<f32>) -> Self {
        Self { rows: OnceLock::from(rows), blocks: None }
    }
}

impl Deref for Depths {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        self.rows.get_or_init(|| self.blocks.as_ref().map(|blocks| blocks.to_rows()).unwrap_or_default())
    }
}

impl DerefMut for Depths {
    fn deref_mut(&mut self) -> &mut [f32] {
        let rows = self.rows.take();
        let blocks = self.blocks.take();
        let rows = rows.or_else(|| blocks.map(|blocks| blocks.to_rows())).unwrap_or_default();
        self.rows = OnceLock::from(rows);
        self.rows.get_mut().map(Vec::as_mut_slice).unwrap_or_default()
    }
}

impl PartialEq for Depths {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_seen_as_rows_and_left_when_written_to() {
        let mut depths = Depths::from(vec![0.5; 70 * 3]);
        assert!(depths.blocks().is_none() && depths.blocks_mut().is_none());
        assert_eq!(depths.fresh_blocks(70, 3).map(|blocks| blocks.width()), Some(70));
        assert_eq!((depths.len(), depths.get(209), depths.get(210)), (210, 0.0, 0.0));
        assert!(depths.blocks().is_some());
        assert_eq!(depths[..], [0.0; 210]);
        // Unfolded: read as rows, drawn to as blocks.
        assert!(depths.blocks().is_none() && depths.blocks_mut().is_some() && depths.blocks().is_some());
        depths[7] = 0.25;
        assert!(depths.blocks_mut().is_none());
        assert_eq!((depths.get(7), depths.len(), depths.clone() == depths), (0.25, 210, true));
    }
}
