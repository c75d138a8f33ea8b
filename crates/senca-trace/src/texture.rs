//! Pictures on surfaces, read at one place (course text, section 2.11).
//!
//! Coordinates u, v run from 0 to 1 over the picture, v = 0 at row 0; texel `i` of N has its centre
//! where `u N - 0.5 = i`. Texels are read where the scene keeps them and decoded on the way, so that
//! filtering happens in linear light.

use std::sync::Arc;

use crate::lanes::{F, LANES, eight};
use fearless_simd::{Simd, prelude::*};
use senca_math::color::linear_from_srgb;
use senca_math::glam::{DMat3, DVec2, Mat3};
use senca_scene::{ColorSpace, Filter, ImageData, Scene, TextureRef, Wrap};

/// Coordinates, in texels, are held within this of 0, so that texel numbers fit 32 bits.
const FARTHEST_TEXEL: f64 = 1e9;

/// What the bytes of 8-bit pictures mean.
#[derive(Debug)]
pub(crate) struct Decoding {
    srgb: Arc<[f32; 256]>,
    linear: Arc<[f32; 256]>,
}

impl Default for Decoding {
    fn default() -> Self {
        let table = |decode: fn(f32) -> f32| Arc::new(std::array::from_fn(|v| decode(v as f32 / 255.0)));
        Self { srgb: table(linear_from_srgb), linear: table(|v| v) }
    }
}

/// A texture as one material uses it.
#[derive(Clone, Debug)]
pub(crate) struct BoundTexture<'s> {
    image: &'s ImageData,
    size: [u32; 2],
    /// Meaning of the colour bytes, and of alpha.
    color: Arc<[f32; 256]>,
    alpha: Arc<[f32; 256]>,
    wrap: [Wrap; 2],
    nearest: bool,
    texcoord: usize,
    /// `None` where it does nothing.
    uv_transform: Option<DMat3>,
    /// The use's own factor: scale of a normal map, strength of an occlusion map.
    pub(crate) strength: f32,
}

impl<'s> BoundTexture<'s> {
    /// The texture that `used` names, with `filter` in place of its own where one is given. `None`
    /// where the scene does not have it.
    pub(crate) fn new(
        scene: &'s Scene,
        used: &TextureRef,
        space: ColorSpace,
        filter: Option<Filter>,
        decoding: &Decoding,
    ) -> Option<Self> {
        let texture = scene.textures.get(used.texture.index())?;
        let image = &scene.images.get(texture.image.index())?.data;
        let color = if space == ColorSpace::Srgb { &decoding.srgb } else { &decoding.linear };
        Some(Self {
            image,
            size: image.size().into(),
            color: Arc::clone(color),
            alpha: Arc::clone(&decoding.linear),
            wrap: [texture.wrap_u, texture.wrap_v],
            nearest: filter.unwrap_or(texture.filter) == Filter::Nearest,
            texcoord: usize::from(used.texcoord == 1),
            uv_transform: (used.uv_transform != Mat3::IDENTITY).then(|| used.uv_transform.as_dmat3()),
            strength: used.strength,
        })
    }

    /// The texture where the surface has these coordinates of sets 0 and 1.
    #[inline]
    pub(crate) fn sample(&self, texcoords: &[DVec2; 2]) -> [f32; 4] {
        let uv = texcoords[self.texcoord];
        let uv = self.uv_transform.map_or(uv, |transform| transform.transform_point2(uv));
        let [width, height] = self.size;
        let (x, y) = (position(uv.x, width), position(uv.y, height));
        if self.nearest { self.texel(whole(x + 0.5), whole(y + 0.5)) } else { self.bilinear(x, y) }
    }

    /// [`BoundTexture::sample`] at eight coordinates of set 0; `None` where it does more than to take the
    /// nearest texel there.
    #[inline(always)]
    pub(crate) fn sample_eight<S: Simd>(&self, simd: S, [u, v]: [F<S>; 2]) -> Option<[[f32; 4]; LANES]> {
        if !self.nearest || self.texcoord != 0 || self.uv_transform.is_some() {
            return None;
        }
        let [width, height] = self.size;
        let x = nearest_eight(simd, u, width).to_array();
        let y = nearest_eight(simd, v, height).to_array();
        Some(eight!(lane => self.texel(x[lane] as i64, y[lane] as i64)))
    }

    fn bilinear(&self, x: f64, y: f64) -> [f32; 4] {
        let (i, j) = (whole(x), whole(y));
        let (s, t) = ((x - i as f64) as f32, (y - j as f64) as f32);
        let upper = lerp(self.texel(i, j), self.texel(i + 1, j), s);
        let lower = lerp(self.texel(i, j + 1), self.texel(i + 1, j + 1), s);
        lerp(upper, lower, t)
    }

    /// The texel in column `x`, row `y`, which may lie outside the picture.
    #[inline(always)]
    fn texel(&self, x: i64, y: i64) -> [f32; 4] {
        let [width, height] = self.size;
        let (x, y) = (wrapped(self.wrap[0], x, width), wrapped(self.wrap[1], y, height));
        let index = y * width as usize + x;
        match self.image {
            ImageData::Rgba8 { texels, .. } => {
                let [r, g, b, a] = texels.get(index).copied().unwrap_or_default();
                let of = |table: &[f32; 256], byte: u8| table[usize::from(byte)];
                [of(&self.color, r), of(&self.color, g), of(&self.color, b), of(&self.alpha, a)]
            }
            ImageData::RgbaF32 { texels, .. } => texels.get(index).copied().unwrap_or_default(),
        }
    }
}

/// Position among the texel centres, 0 at the first; NaN counts as 0.
#[inline]
fn position(u: f64, n: u32) -> f64 {
    let p = u * f64::from(n) - 0.5;
    if p.is_nan() { 0.0 } else { p.clamp(-FARTHEST_TEXEL, FARTHEST_TEXEL) }
}

/// The texels that eight coordinates are in; see [`position`].
#[inline(always)]
fn nearest_eight<S: Simd>(simd: S, u: F<S>, n: u32) -> F<S> {
    let half = F::splat(simd, 0.5);
    let p = u * F::splat(simd, f64::from(n)) - half;
    let farthest = F::splat(simd, FARTHEST_TEXEL);
    let p = p.simd_gt(farthest).select(farthest, p);
    let p = p.simd_lt(-farthest).select(-farthest, p);
    let p = p.simd_eq(p).select(p, F::splat(simd, 0.0));
    (p + half).floor()
}

/// The largest whole number that is not above `v`, which is within [`FARTHEST_TEXEL`] of 0.
#[inline]
fn whole(v: f64) -> i64 {
    let towards_zero = v as i64;
    towards_zero - i64::from(towards_zero as f64 > v)
}

/// Texel `i` brought into `0..n`.
#[inline(always)]
fn wrapped(wrap: Wrap, i: i64, n: u32) -> usize {
    let n = i64::from(n.max(1));
    (match wrap {
        Wrap::Repeat if n & (n - 1) == 0 => i & (n - 1),
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * n);
            j.min(2 * n - 1 - j)
        }
        Wrap::Clamp => i.clamp(0, n - 1),
    }) as usize
}

fn lerp(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use senca_scene::{ImageId, Texture, TextureId, TextureImage};

    fn scene(wrap: Wrap, filter: Filter) -> Scene {
        let texels = vec![[0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 0], [128, 128, 128, 128]];
        let data = ImageData::Rgba8 { width: 2, height: 2, texels };
        let texture = Texture { name: String::new(), image: ImageId(0), wrap_u: wrap, wrap_v: wrap, filter };
        Scene {
            images: vec![TextureImage { name: String::new(), data }],
            textures: vec![texture],
            ..Scene::default()
        }
    }

    fn sampled(scene: &Scene, u: f64, v: f64) -> [f32; 4] {
        let used = TextureRef::new(TextureId(0));
        let bound = BoundTexture::new(scene, &used, ColorSpace::Srgb, None, &Decoding::default());
        bound.expect("is there").sample(&[DVec2::new(u, v), DVec2::ZERO])
    }

    #[test]
    fn centres_of_texels_are_their_colour_in_linear_light() {
        let scene = scene(Wrap::Repeat, Filter::Bilinear);
        assert_eq!(sampled(&scene, 0.75, 0.25), [1.0, 0.0, 0.0, 1.0]);
        let grey = sampled(&scene, 0.75, 0.75);
        assert!((grey[0] - 0.2158605).abs() < 1e-6, "sRGB is decoded: {grey:?}");
        assert!((grey[3] - 128.0 / 255.0).abs() < 1e-6, "alpha is not: {grey:?}");
    }

    #[test]
    fn between_centres_is_the_weighted_mean_or_the_nearest() {
        let smooth = scene(Wrap::Clamp, Filter::Bilinear);
        assert!((sampled(&smooth, 0.5, 0.25)[0] - 0.5).abs() < 1e-6);
        let sharp = scene(Wrap::Clamp, Filter::Nearest);
        assert_eq!(sampled(&sharp, 0.51, 0.25)[0], 1.0);
        assert_eq!(sampled(&sharp, 0.49, 0.25)[0], 0.0);
    }

    #[test]
    fn outside_the_picture_wrapping_decides() {
        let at = |wrap| sampled(&scene(wrap, Filter::Nearest), 1.25, 0.25)[0];
        assert_eq!((at(Wrap::Repeat), at(Wrap::Mirror), at(Wrap::Clamp)), (0.0, 1.0, 1.0));
        let bilinear = scene(Wrap::Repeat, Filter::Bilinear);
        let scene = &bilinear;
        for v in [f64::NAN, f64::INFINITY, 1e300, -1e300] {
            assert!(sampled(scene, v, v).iter().all(|c| c.is_finite()));
        }
    }

    #[test]
    fn eight_texels_at_once_are_the_same() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let scene = scene(wrap, Filter::Nearest);
            let used = TextureRef::new(TextureId(0));
            let bound = BoundTexture::new(&scene, &used, ColorSpace::Srgb, None, &Decoding::default());
            let bound = bound.expect("is there");
            let u = [0.0, 0.49, 0.5, 1.0, -0.25, f64::NAN, 1e300, f64::NEG_INFINITY];
            let v = [0.75, 0.5, 0.1, -7.3, 1e-17, 0.25, f64::NAN, -0.0];
            let found = fearless_simd::dispatch!(fearless_simd::Level::new(), simd => {
                bound.sample_eight(simd, [F::load_array(simd, u), F::load_array(simd, v)])
            });
            let alone: [_; LANES] =
                std::array::from_fn(|k| bound.sample(&[DVec2::new(u[k], v[k]), DVec2::ZERO]));
            assert_eq!(found, Some(alone));
        }
    }
}
