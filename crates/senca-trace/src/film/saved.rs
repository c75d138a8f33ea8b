//! A film on disk, so that exposing can go on later.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `SENCAPAR` |
//! | 4 | version, 1 |
//! | 8 | fingerprint of scene, view and settings, by the caller |
//! | 8 | fingerprint of the film's settings but for the number of samples |
//! | 4 x 6 | width and height of the picture; x, y, width, height of the part |
//! | 4 | samples that every pixel has, or passes |
//! | 24 per pixel | four sums, the sum of weights, the number of samples |
//! | 8 | checksum of all before |
//!
//! Numbers are little-endian.

use super::{Area, Exposure, Film, FilmSettings, Tally};
use crate::TraceError;
use crate::antialias::{AdaptiveSettings, Antialiasing};

const MAGIC: &[u8; 8] = b"SENCAPAR";
const VERSION: u32 = 1;
const HEADER: usize = 8 + 4 + 8 + 8 + 24 + 4;
const PIXEL: usize = 24;
const CHECKSUM: usize = 8;

/// Why a saved film cannot be gone on with. Variants come in the order input, parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SavedFilmError {
    /// The bytes are something else.
    #[error("is not a partial picture of this program")]
    NotAFilm,
    /// A later version of the program wrote them.
    #[error("is a partial picture of version {0}; this program reads version {VERSION}")]
    Version(u32),
    /// Bytes are missing or changed.
    #[error("is damaged: {0}")]
    Damaged(&'static str),
    /// It is of another picture.
    #[error("belongs to another picture: {0}")]
    Mismatch(String),
    /// The settings asked for are wrong.
    #[error(transparent)]
    Settings(#[from] TraceError),
}

/// A fingerprint of bytes: FNV-1a (Fowler, Noll and Vo), which is the same everywhere. Not made
/// against forgery.
#[derive(Clone, Copy, Debug)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// That of the text that `{:?}` prints of a value. The text is not kept, so the value may be large.
    #[must_use]
    pub fn of(value: &impl std::fmt::Debug) -> u64 {
        let mut fingerprint = Self::default();
        // Writing to it cannot fail.
        let _ = std::fmt::Write::write_fmt(&mut fingerprint, format_args!("{value:?}"));
        fingerprint.0
    }

    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl std::fmt::Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.add(text.as_bytes());
        Ok(())
    }
}

fn checksum(bytes: &[u8]) -> u64 {
    let mut fingerprint = Fingerprint::default();
    fingerprint.add(bytes);
    fingerprint.0
}

/// Fingerprint of what has to be the same when a film is gone on with: not how many samples are
/// wanted, where the first ones do not depend on it.
fn settings_fingerprint(settings: &FilmSettings) -> u64 {
    let antialiasing = match settings.antialiasing {
        Antialiasing::Filtered { filter, .. } => Antialiasing::Filtered { samples: 0, filter },
        Antialiasing::Adaptive(adaptive) => {
            Antialiasing::Adaptive(AdaptiveSettings { passes: 0, ..adaptive })
        }
        other => other,
    };
    Fingerprint::of(&FilmSettings { antialiasing, ..*settings })
}

impl Film {
    /// The film as bytes. `fingerprint` stands for all else that the picture depends on: scene, view and
    /// how light is found.
    #[must_use]
    pub fn save(&self, fingerprint: u64) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + PIXEL * self.sums.len() + CHECKSUM);
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&fingerprint.to_le_bytes());
        bytes.extend_from_slice(&settings_fingerprint(&self.settings).to_le_bytes());
        let Area { x, y, width, height } = self.settings.area;
        for number in [self.settings.size[0], self.settings.size[1], x, y, width, height, self.samples] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for (pixel, sum) in self.sums.iter().enumerate() {
            for value in sum {
                bytes.extend_from_slice(&value.to_le_bytes());
            }
            let tally = self.tally(pixel);
            bytes.extend_from_slice(&tally.weight.to_le_bytes());
            bytes.extend_from_slice(&tally.count.to_le_bytes());
        }
        let sum = checksum(&bytes);
        bytes.extend_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// A film that was saved, to be exposed further by `settings`. These may ask for more samples of a
    /// filtered picture, or more passes of an adaptive one, than before; all else has to be the same.
    ///
    /// # Errors
    /// [`SavedFilmError`].
    pub fn resume(bytes: &[u8], fingerprint: u64, settings: &FilmSettings) -> Result<Self, SavedFilmError> {
        let mut film = Self::new(settings)?;
        let mut reader = Reader { bytes };
        if reader.array::<8>().as_ref() != Ok(MAGIC) {
            return Err(SavedFilmError::NotAFilm);
        }
        let version = reader.u32()?;
        if version != VERSION {
            return Err(SavedFilmError::Version(version));
        }
        let (scene, own) = (reader.u64()?, reader.u64()?);
        let mut numbers = [0; 6];
        for number in &mut numbers {
            *number = reader.u32()?;
        }
        film.compare_size(numbers)?;
        let body_end = HEADER + PIXEL * film.sums.len();
        if bytes.len() != body_end + CHECKSUM {
            return Err(SavedFilmError::Damaged("its length is wrong"));
        }
        let (body, sum) = bytes.split_at(body_end);
        if sum != checksum(body).to_le_bytes() {
            return Err(SavedFilmError::Damaged("its checksum is wrong"));
        }
        if own != settings_fingerprint(settings) {
            return Err(SavedFilmError::Mismatch("antialiasing or seed are others".into()));
        }
        if scene != fingerprint {
            let text = "the scene, the view or how it is drawn have changed";
            return Err(SavedFilmError::Mismatch(text.into()));
        }
        film.samples = reader.u32()?;
        for pixel in 0..film.sums.len() {
            let exposure = reader.exposure()?;
            film.sums[pixel] = exposure.sum;
            if let Some(tally) = film.tallies.get_mut(pixel) {
                *tally = exposure.tally;
            }
        }
        Ok(film)
    }

    fn compare_size(&self, [w, h, x, y, width, height]: [u32; 6]) -> Result<(), SavedFilmError> {
        let (size, area) = (self.settings.size, self.settings.area);
        if size != [w, h] {
            let text = format!("it has {w}x{h} pixels, not {}x{}", size[0], size[1]);
            return Err(SavedFilmError::Mismatch(text));
        }
        if area != (Area { x, y, width, height }) {
            let text = format!("it holds the part {x},{y},{width},{height} of it");
            return Err(SavedFilmError::Mismatch(text));
        }
        Ok(())
    }
}

/// Takes numbers from the front of bytes.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], SavedFilmError> {
        let (first, rest) =
            self.bytes.split_first_chunk::<N>().ok_or(SavedFilmError::Damaged("it ends too early"))?;
        self.bytes = rest;
        Ok(*first)
    }

    fn u32(&mut self) -> Result<u32, SavedFilmError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn u64(&mut self) -> Result<u64, SavedFilmError> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    fn f32(&mut self) -> Result<f32, SavedFilmError> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    fn exposure(&mut self) -> Result<Exposure, SavedFilmError> {
        let sum = [self.f32()?, self.f32()?, self.f32()?, self.f32()?];
        Ok(Exposure { sum, tally: Tally { weight: self.f32()?, count: self.u32()? } })
    }
}
