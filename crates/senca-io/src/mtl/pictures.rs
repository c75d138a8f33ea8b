//! Pictures of materials: fetched once, and combined where the scene wants one for two.

use std::collections::HashMap;

use senca_scene::math::color::srgb_from_linear;
use senca_scene::math::glam::{Mat3, Vec3};
use senca_scene::{
    ColorSpace, Filter, ImageData, ImageId, Scene, Texture, TextureId, TextureImage, TextureRef, Warning,
    Wrap,
};

use super::Map;
use crate::{Files, images};

/// Fetches and keeps pictures by name.
pub(super) struct Pictures<'a> {
    files: &'a dyn Files,
    /// `None` for files that could not be read.
    images: HashMap<(String, bool), Option<ImageId>>,
    textures: HashMap<(ImageId, bool), TextureId>,
}

impl<'a> Pictures<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        Self { files, images: HashMap::new(), textures: HashMap::new() }
    }

    /// A picture of colours.
    pub(super) fn color(&mut self, map: Option<&Map>, scene: &mut Scene) -> Option<TextureRef> {
        let map = map?;
        let image = self.image(&map.file, ColorSpace::Srgb, scene)?;
        Some(self.reference(image, map, scene))
    }

    /// A picture of numbers.
    pub(super) fn data(&mut self, map: Option<&Map>, scene: &mut Scene) -> Option<TextureRef> {
        let map = map?;
        let image = self.image(&map.file, ColorSpace::Linear, scene)?;
        Some(self.reference(image, map, scene))
    }

    /// The diffuse picture with the alpha picture in its alpha.
    pub(super) fn base(
        &mut self,
        diffuse: Option<&Map>,
        alpha: Option<&Map>,
        scene: &mut Scene,
    ) -> Option<TextureRef> {
        let Some(alpha) = alpha else { return self.color(diffuse, scene) };
        if diffuse.is_some_and(|diffuse| diffuse.file == alpha.file) {
            return self.color(diffuse, scene);
        }
        let Some(alpha_image) = self.image(&alpha.file, ColorSpace::Linear, scene) else {
            return self.color(diffuse, scene);
        };
        let color_image = diffuse.and_then(|map| self.image(&map.file, ColorSpace::Srgb, scene));
        let key = format!("{}\0alpha {}", diffuse.map_or("", |map| &map.file), alpha.file);
        let image = self.made(key, scene, |scene| {
            let colors = color_image.map(|id| &scene.images[id.index()].data);
            with_alpha(colors, &scene.images[alpha_image.index()].data)
        });
        Some(self.reference(image, diffuse.unwrap_or(alpha), scene))
    }

    /// Roughness in green and metalness in blue of one picture.
    pub(super) fn metallic_roughness(
        &mut self,
        rough: Option<&Map>,
        metal: Option<&Map>,
        scene: &mut Scene,
    ) -> Option<TextureRef> {
        let rough_image = rough.and_then(|map| self.image(&map.file, ColorSpace::Linear, scene));
        let metal_image = metal.and_then(|map| self.image(&map.file, ColorSpace::Linear, scene));
        rough_image.or(metal_image)?;
        let name = |map: Option<&Map>| map.map_or("", |map| &map.file).to_owned();
        let key = format!("{}\0metallic-roughness {}", name(rough), name(metal));
        let image = self.made(key, scene, |scene| {
            let data = |id: Option<ImageId>| id.map(|id| &scene.images[id.index()].data);
            roughness_and_metalness(data(rough_image), data(metal_image))
        });
        Some(self.reference(image, rough.or(metal)?, scene))
    }

    /// A normal map, as such or made of heights.
    pub(super) fn normals(
        &mut self,
        normal: Option<&Map>,
        bump: Option<&Map>,
        scene: &mut Scene,
    ) -> Option<TextureRef> {
        if let Some(reference) = self.data(normal, scene) {
            return Some(TextureRef { strength: normal.map_or(1.0, |map| map.strength), ..reference });
        }
        let bump = bump?;
        let image = self.image(&bump.file, ColorSpace::Linear, scene)?;
        if looks_like_normals(&scene.images[image.index()].data) {
            return Some(TextureRef { strength: bump.strength, ..self.reference(image, bump, scene) });
        }
        let key = format!("{}\0normals", bump.file);
        let image = self.made(key, scene, |scene| normals_of_heights(&scene.images[image.index()].data));
        Some(TextureRef { strength: bump.strength, ..self.reference(image, bump, scene) })
    }

    /// The picture in `file`; a warning and `None` if it cannot be read.
    fn image(&mut self, file: &str, space: ColorSpace, scene: &mut Scene) -> Option<ImageId> {
        let key = (file.to_owned(), space == ColorSpace::Linear);
        if let Some(&known) = self.images.get(&key) {
            return known;
        }
        let limits = self.files.limits();
        let read = self.files.read(file).and_then(|bytes| images::decode_as(file, &bytes, &limits, space));
        let image = match read {
            Ok(data) => Some(add_image(file, data, scene)),
            Err(error) => {
                scene.warnings.push(Warning(format!("texture left out: {error}")));
                None
            }
        };
        self.images.insert(key, image);
        image
    }

    /// A picture made of others, once.
    fn made(&mut self, key: String, scene: &mut Scene, make: impl FnOnce(&Scene) -> ImageData) -> ImageId {
        if let Some(&Some(image)) = self.images.get(&(key.clone(), true)) {
            return image;
        }
        let data = make(scene);
        let image = add_image(&key.replace('\0', " + "), data, scene);
        self.images.insert((key, true), Some(image));
        image
    }

    fn reference(&mut self, image: ImageId, map: &Map, scene: &mut Scene) -> TextureRef {
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let texture = *self.textures.entry((image, map.clamp)).or_insert_with(|| {
            let name = scene.images[image.index()].name.clone();
            scene.textures.push(Texture {
                name,
                image,
                wrap_u: wrap,
                wrap_v: wrap,
                filter: Filter::default(),
            });
            TextureId(scene.textures.len() as u32 - 1)
        });
        TextureRef { uv_transform: uv_transform(map), ..TextureRef::new(texture) }
    }
}

fn add_image(name: &str, data: ImageData, scene: &mut Scene) -> ImageId {
    scene.images.push(TextureImage { name: name.to_owned(), data });
    ImageId(scene.images.len() as u32 - 1)
}

/// Scale and offset count v from the bottom, texture coordinates of the scene from the top.
fn uv_transform(map: &Map) -> Mat3 {
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    Mat3::from_cols(Vec3::new(su, 0.0, 0.0), Vec3::new(0.0, sv, 0.0), Vec3::new(ou, 1.0 - sv - ov, 1.0))
}

/// Texel `(x, y)` of a grid of `size`, as numbers in [0, 1] (or light, for float pictures).
fn texel(data: &ImageData, size: (u32, u32), x: u32, y: u32) -> [f32; 4] {
    let (width, height) = data.size();
    let place = |i: u32, n: u32, of: u32| (u64::from(i) * u64::from(of) / u64::from(n.max(1))) as usize;
    let index = place(y, size.1, height) * width as usize + place(x, size.0, width);
    match data {
        ImageData::Rgba8 { texels, .. } => texels[index].map(|v| f32::from(v) / 255.0),
        ImageData::RgbaF32 { texels, .. } => texels[index],
    }
}

/// The size of the larger of two pictures.
fn larger(a: Option<&ImageData>, b: Option<&ImageData>) -> (u32, u32) {
    let area = |size: &(u32, u32)| u64::from(size.0) * u64::from(size.1);
    let sizes = a.iter().chain(b.iter()).map(|data| data.size());
    sizes.max_by_key(area).unwrap_or((1, 1))
}

/// An 8-bit picture of `size` from a function of its texels.
fn make(size: (u32, u32), texel: impl Fn(u32, u32) -> [f32; 4]) -> ImageData {
    let row = |y: u32| (0..size.0).map(move |x| (x, y));
    let bytes = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let texels = (0..size.1).flat_map(row).map(|(x, y)| texel(x, y).map(bytes)).collect();
    ImageData::Rgba8 { width: size.0, height: size.1, texels }
}

/// `colors`, white if missing, with the alpha of `alpha`: its alpha channel if it uses that, else its
/// red.
fn with_alpha(colors: Option<&ImageData>, alpha: &ImageData) -> ImageData {
    let size = larger(colors, Some(alpha));
    let uses_alpha = match alpha {
        ImageData::Rgba8 { texels, .. } => texels.iter().any(|t| t[3] != 255),
        ImageData::RgbaF32 { texels, .. } => texels.iter().any(|t| t[3] < 1.0),
    };
    let channel = if uses_alpha { 3 } else { 0 };
    make(size, |x, y| {
        let opacity = texel(alpha, size, x, y)[channel];
        let [r, g, b, _] = match colors {
            Some(data @ ImageData::Rgba8 { .. }) => texel(data, size, x, y),
            // Light is encoded for the 8-bit picture.
            Some(data) => texel(data, size, x, y).map(srgb_from_linear),
            None => [1.0; 4],
        };
        [r, g, b, opacity]
    })
}

fn roughness_and_metalness(rough: Option<&ImageData>, metal: Option<&ImageData>) -> ImageData {
    let size = larger(rough, metal);
    let value = |data: Option<&ImageData>, x, y| data.map_or(1.0, |data| texel(data, size, x, y)[0]);
    make(size, |x, y| [1.0, value(rough, x, y), value(metal, x, y), 1.0])
}

/// Whether the picture is bluish throughout, as normal maps are and height maps never.
fn looks_like_normals(data: &ImageData) -> bool {
    let ImageData::Rgba8 { texels, .. } = data else { return false };
    let mean = |channel: usize| {
        texels.iter().map(|t| u64::from(t[channel])).sum::<u64>() as f64 / texels.len().max(1) as f64
    };
    let (r, g, b) = (mean(0), mean(1), mean(2));
    b > 180.0 && (90.0..165.0).contains(&r) && (90.0..165.0).contains(&g)
}

/// Normals of a relief whose heights are the reds of `data`, white one texel above black: slopes by
/// central differences (Blinn 1978), the picture repeated at its sides.
fn normals_of_heights(data: &ImageData) -> ImageData {
    let size = data.size();
    let (width, height) = size;
    let at = |x: u32, y: u32| texel(data, size, x % width, y % height)[0];
    make(size, |x, y| {
        let slope_u = at(x + 1, y) - at(x + width - 1, y);
        let slope_down = at(x, y + 1) - at(x, y + height - 1);
        let n = Vec3::new(-slope_u, slope_down, 1.0).normalize() * 0.5 + 0.5;
        [n.x, n.y, n.z, 1.0]
    })
}
