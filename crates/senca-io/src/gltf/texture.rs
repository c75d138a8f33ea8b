//! Textures, samplers and pictures (glTF 2.0, section 3.8).
//!
//! Pictures are decoded when the first material uses them. One that cannot be had - a missing file,
//! a format that is not read - leaves the material without it, with a warning: a model that lost one
//! of its pictures is still worth seeing.

use std::collections::BTreeMap;

use senca_scene::{ColorSpace, Filter, ImageData, ImageId, Texture, TextureImage, Wrap};

use super::document::Document;
use super::json;
use super::json::Whole;
use super::specular_glossiness::ConvertedTextures;
use crate::{Limits, ReadError, images};

/// All pictures of a file together may have this many times the texels that one may have.
const TOTAL_TEXELS: u64 = 4;

/// Textures and pictures found so far.
pub(super) struct Textures<'d> {
    pub(super) textures: Vec<Texture>,
    pub(super) images: Vec<TextureImage>,
    /// What became of each of the file's textures.
    known: BTreeMap<usize, Option<u32>>,
    /// What became of each picture, by where its bytes are.
    pictures: BTreeMap<Source<'d>, Option<u32>>,
    /// Pictures made of others.
    pub(super) converted: Vec<ConvertedTextures>,
    /// Texels that may still be decoded.
    texels_left: u64,
}

/// Where the bytes of a picture are.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Source<'d> {
    View(Whole),
    Uri(&'d str),
}

impl<'d> Textures<'d> {
    pub(super) fn new(limits: Limits) -> Self {
        Self {
            textures: Vec::new(),
            images: Vec::new(),
            known: BTreeMap::new(),
            pictures: BTreeMap::new(),
            converted: Vec::new(),
            texels_left: limits.image_texels.saturating_mul(TOTAL_TEXELS),
        }
    }

    /// The texture made of the file's texture `index`, whose texels mean `space`.
    pub(super) fn get(&mut self, document: &'d Document<'_>, index: usize, space: ColorSpace) -> Option<u32> {
        if let Some(&known) = self.known.get(&index) {
            return known;
        }
        let texture = self.read(document, index, space);
        self.known.insert(index, texture);
        texture
    }

    fn read(&mut self, document: &'d Document<'_>, index: usize, space: ColorSpace) -> Option<u32> {
        let json = &document.root.textures[index];
        let place = format!("textures[{index}]");
        let Some(source) = json.source else {
            document.warn(format!("{place}: has no picture in a format that is read; left out"));
            return None;
        };
        let at = format!("{place}.source");
        let image = document.index_or_warn(&at, source, "image", document.root.images.len())?;
        let image = ImageId(self.image(document, image as usize, space)?);
        let samplers = &document.root.samplers;
        let sampler = json.sampler.and_then(|s| {
            document.index_or_warn(format_args!("{place}.sampler"), s, "sampler", samplers.len())
        });
        let default = json::Sampler::default();
        let sampler = sampler.and_then(|s| samplers.get(s as usize)).unwrap_or(&default);
        Some(self.add(Texture {
            name: json.name.clone(),
            image,
            wrap_u: wrap(document, &place, sampler.wrap_s),
            wrap_v: wrap(document, &place, sampler.wrap_t),
            filter: filter(sampler),
        }))
    }

    /// Appends `texture` and returns its number.
    pub(super) fn add(&mut self, texture: Texture) -> u32 {
        self.textures.push(texture);
        self.textures.len() as u32 - 1
    }

    fn image(&mut self, document: &'d Document<'_>, index: usize, space: ColorSpace) -> Option<u32> {
        let json = &document.root.images[index];
        let source = match (json.buffer_view, json.uri.as_deref()) {
            (Some(view), _) => Source::View(view),
            (None, Some(uri)) => Source::Uri(uri),
            (None, None) => {
                document.warn(format!("images[{index}]: has neither a uri nor a buffer view; left out"));
                return None;
            }
        };
        if let Some(&known) = self.pictures.get(&source) {
            return known;
        }
        let image = match self.decode(document, index, source, space) {
            Ok(data) => self.add_image(TextureImage { name: image_name(json), data }),
            Err(error) => {
                document.warn(format!("images[{index}]: {error}; left out"));
                None
            }
        };
        self.pictures.insert(source, image);
        image
    }

    /// Whether pictures of `texels` texels together may still be added.
    pub(super) fn has_room_for(&self, texels: u64) -> bool {
        texels <= self.texels_left
    }

    /// Appends a picture unless it has more texels than are left.
    pub(super) fn add_image(&mut self, image: TextureImage) -> Option<u32> {
        let (width, height) = image.data.size();
        self.texels_left = self.texels_left.checked_sub(u64::from(width) * u64::from(height))?;
        self.images.push(image);
        Some(self.images.len() as u32 - 1)
    }

    fn decode(
        &self,
        document: &'d Document<'_>,
        index: usize,
        source: Source<'d>,
        space: ColorSpace,
    ) -> Result<ImageData, ReadError> {
        let limits = document.files.limits();
        let limits = Limits { image_texels: limits.image_texels.min(self.texels_left), ..limits };
        let place = format!("images[{index}]");
        match source {
            Source::View(view) => {
                let (bytes, _) = document.view(&format!("{place}.bufferView"), view)?;
                images::decode_as(document.name, bytes, &limits, space)
            }
            Source::Uri(uri) => {
                let bytes = document.fetch(&format!("{place}.uri"), uri)?;
                let name = if uri.starts_with("data:") { document.name } else { uri };
                images::decode_as(name, &bytes, &limits, space)
            }
        }
    }
}

/// The picture's name, or its file's.
fn image_name(json: &json::Image) -> String {
    let file = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    if json.name.is_empty() { file.unwrap_or_default().to_owned() } else { json.name.clone() }
}

fn wrap(document: &Document<'_>, place: &str, code: Option<Whole>) -> Wrap {
    match code.map(|c| c.0) {
        None | Some(10497) => Wrap::Repeat,
        Some(33648) => Wrap::Mirror,
        Some(33071) => Wrap::Clamp,
        Some(other) => {
            document.warn(format!("{place}: wrap mode {other} is not known; REPEAT is used"));
            Wrap::Repeat
        }
    }
}

/// NEAREST when enlarged is NEAREST throughout; else LINEAR without mipmaps is bilinear, and all
/// that has mipmaps or is not said is trilinear.
fn filter(sampler: &json::Sampler) -> Filter {
    match (sampler.mag_filter.map(|f| f.0), sampler.min_filter.map(|f| f.0)) {
        (Some(9728), _) | (None, Some(9728)) => Filter::Nearest,
        (_, Some(9728 | 9729)) => Filter::Bilinear,
        _ => Filter::Trilinear,
    }
}
