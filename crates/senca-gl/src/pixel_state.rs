//! State of pixel commands: how images lie in client memory, what happens to pixels on the way.

use crate::error::Error;
use crate::pixel::{PixelMaps, PixelStore, PixelTransfer};
use crate::{Context, Enum, gl};

/// How images lie in client memory, coming and going.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StoreState {
    pub(crate) unpack: PixelStore,
    pub(crate) pack: PixelStore,
}

/// What `PIXEL_MODE_BIT` saves.
#[derive(Clone, Debug)]
pub(crate) struct TransferState {
    pub(crate) modes: PixelTransfer,
    pub(crate) zoom: [f32; 2],
}

impl Default for TransferState {
    fn default() -> Self {
        Self { modes: PixelTransfer::default(), zoom: [1.0; 2] }
    }
}

/// All of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelState {
    pub(crate) store: StoreState,
    pub(crate) transfer: TransferState,
    pub(crate) maps: PixelMaps,
}

impl PixelState {
    /// What happens to pixels on the way.
    pub(crate) fn transfer(&self) -> crate::pixel::Transfer<'_> {
        crate::pixel::Transfer { modes: &self.transfer.modes, maps: &self.maps }
    }
}

impl Context {
    /// `glPixelStore`. Not recorded in lists.
    pub fn pixel_store(&mut self, name: Enum, value: i32) {
        self.outside(|c| {
            let store = &mut c.pixels.store;
            let unpack = matches!(name, gl::UNPACK_SWAP_BYTES..=gl::UNPACK_ALIGNMENT)
                || matches!(name, gl::UNPACK_SKIP_IMAGES | gl::UNPACK_IMAGE_HEIGHT);
            let result = if unpack { store.unpack.set(name, value) } else { store.pack.set(name, value) };
            c.check(result);
        });
    }

    /// `glPixelTransfer`.
    pub fn pixel_transfer(&mut self, name: Enum, value: f32) {
        self.submit(move |c| {
            let result = c.pixels.transfer.modes.set(name, value);
            c.check(result);
        });
    }

    /// `glPixelZoom`.
    pub fn pixel_zoom(&mut self, zoom: [f32; 2]) {
        self.submit(move |c| c.pixels.transfer.zoom = zoom);
    }

    /// How images lie in client memory that commands read, for those who find their end.
    #[must_use]
    pub fn unpack_store(&self) -> PixelStore {
        self.pixels.store.unpack
    }

    /// How images lie in client memory that commands write.
    #[must_use]
    pub fn pack_store(&self) -> PixelStore {
        self.pixels.store.pack
    }

    /// `glPolygonStipple`: 32 x 32 bits, as the unpack state says.
    pub fn polygon_stipple(&mut self, bytes: &[u8]) {
        let store = self.pixels.store.unpack;
        let source = crate::pixel::PixelSource::new(
            bytes,
            &store,
            crate::pixel::PixelLayout::BITMAP,
            [32, 32, 1],
            false,
        );
        match source {
            Some(source) => {
                let mut rows = [0u32; 32];
                for (y, row) in rows.iter_mut().enumerate() {
                    let mut bits = [0u32; 32];
                    source.indices(0, y, 0, &mut bits);
                    *row = bits.iter().fold(0, |word, bit| word << 1 | (bit & 1));
                }
                self.set_polygon_stipple(rows);
            }
            None => self.submit(|c| c.error(Error::InvalidOperation.code())),
        }
    }
}
