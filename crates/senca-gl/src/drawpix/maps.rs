//! Commands on pixel maps.

use crate::pixel::PixelMap;
use crate::{Context, Enum, Error, gl};

impl Context {
    /// `glPixelMap`: entries as numbers; colours of integer types must come as values of [0, 1].
    pub fn pixel_map(&mut self, map: Enum, values: &[f32]) {
        let values: Box<[f32]> = values.into();
        self.submit(move |c| {
            let map = PixelMap::from_token(map).ok_or(Error::InvalidEnum);
            let result = map.and_then(|map| c.pixels.maps.set(map, &values));
            c.check(result);
        });
    }

    /// `glGetPixelMap`: the entries, colours as values of [0, 1]; none in case of error.
    pub fn get_pixel_map(&mut self, map: Enum) -> Vec<f32> {
        self.ask(|c| match PixelMap::from_token(map) {
            Some(map) => c.pixels.maps.table(map).to_vec(),
            None => {
                c.error(gl::INVALID_ENUM);
                Vec::new()
            }
        })
    }
}
