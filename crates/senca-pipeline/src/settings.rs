//! What the caller chooses.

use senca_math::LinearRgb;
use senca_scene::{Background, Filter};

use crate::RenderError;

/// How a picture is drawn. Small, to be copied and changed field by field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// What is drawn and how it is lit. Default [`Shading::Material`].
    pub shading: Shading,
    /// Which rasterizer fills triangles. Default [`Raster::Tiled`].
    pub raster: Raster,
    /// Samples per pixel at fixed places inside it, 1 to 256; their mean in linear light is the
    /// pixel. Default 1, at the pixel's centre. Time grows in proportion.
    pub samples: u32,
    /// Threads; 0 takes one per processor. The picture does not depend on it. Default 0.
    pub threads: usize,
    /// Which faces are left out for showing their back. Default [`Culling::ByMaterial`].
    pub cull: Culling,
    /// How far the silhouette of a round shape may be off, in pixels, > 0. Default 0.25. Halving it
    /// doubles the number of triangles.
    pub tolerance_px: f64,
    /// Interpolation of colours in [`Shading::Gouraud`]. Default [`ColorInterpolation::Screen`].
    pub gouraud: ColorInterpolation,
    /// How texture coordinates reach a pixel. Default [`TextureMethod::Interpolated`].
    pub texture_method: TextureMethod,
    /// Filter of all textures in place of their own. Default `None`.
    pub filter: Option<Filter>,
    /// Whether visibility is found first and each visible pixel shaded once after that, instead of
    /// shading whatever is nearest so far (course text, section 2.10). Same picture. Default true.
    pub two_pass: bool,
    /// Part of the picture to draw; the rest of the image is left as it is. Default all.
    pub crop: Option<Crop>,
    /// What is seen where nothing is, in place of what the scene says; it gives no light. Default: the
    /// scene's, and where it says nothing transparent black, or white in the line modes.
    pub background: Option<Background>,
    /// Lines of the line modes, and of meshes made of lines and points.
    pub wire: WireSettings,
    /// What pixels hold. All but colour take one sample a pixel, and faces whatever the shading says.
    /// Default [`Channel::Color`].
    pub channel: Channel,
}

/// What is drawn and how it is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shading {
    /// The edges of all polygons (1991 thesis, section 3).
    Wire,
    /// The edges, and the normal at every vertex, 1/30 of the window's width long.
    WireNormals,
    /// The edges as far as no face hides them.
    HiddenLine,
    /// One colour a triangle, lit at its middle with the triangle's own normal.
    Flat,
    /// Lit at the vertices, colours interpolated (Gouraud 1971; course text, section 2.9).
    Gouraud,
    /// Normals interpolated, lit at every pixel with the model of the books (Phong 1975; course text,
    /// section 2.10). Metallic-roughness materials are translated.
    Phong,
    /// Every pixel lit with its material's own model, all its textures included.
    #[default]
    Material,
}

/// What the pixels of a picture hold. All components but alpha, which is 1, are one number, except of
/// normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Light.
    #[default]
    Color,
    /// Distance from the eye along the axis of the view, in world units: planes across the axis have one
    /// depth. Infinity where nothing is.
    Depth,
    /// Unit normal that the surface is shaded with, in world coordinates, on the side that is seen: x is
    /// red, y green, z blue. Zero where nothing is, and on lines and points.
    Normals,
    /// Number of the object, from 1: its place in `Scene::instances`. 0 where nothing is.
    Objects,
    /// Number of the triangle among those of the whole picture, from 1, exact to 2^24; lines and points
    /// follow. 0 where nothing is.
    Triangles,
}

/// The rasterizers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Raster {
    /// Tiles in parallel.
    #[default]
    Tiled,
    /// Row by row, the plain form.
    Scanline,
}

/// Which faces are left out for showing their back (course text, section 2.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Culling {
    /// Those whose material is not double-sided; surfaces without a material show both sides. In the
    /// line modes none.
    #[default]
    ByMaterial,
    /// All. Right for closed opaque solids seen from outside.
    Always,
    /// None; backs are lit as if they were fronts.
    Never,
}

/// How vertex colours reach a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorInterpolation {
    /// Linear in the picture, as in the books: not strictly right under perspective.
    #[default]
    Screen,
    /// Linear in space.
    Perspective,
}

/// How texture coordinates reach a pixel (course text, section 2.11).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TextureMethod {
    /// Interpolated between the vertices, right under perspective.
    #[default]
    Interpolated,
    /// The pixel and its depth go back through the view to the scene, and from there through the
    /// triangle's own frame into the picture. Slower; depends on the precision of the depth.
    Transformed,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row from the top.
    pub y: u32,
    /// Columns, > 0.
    pub width: u32,
    /// Rows, > 0.
    pub height: u32,
}

/// Looks of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireSettings {
    /// Colour of edges. Default black.
    pub color: LinearRgb,
    /// Colour of normals. Default blue.
    pub normal_color: LinearRgb,
    /// Width in pixels, >= 1. Default 1.
    pub width: f32,
    /// Side of points in pixels, >= 1. Default 2.
    pub point_size: f32,
    /// Length of drawn normals in world units; `None`, the default, takes 1/30 of the width of what is
    /// seen at the distance of the scene's middle.
    pub normal_length: Option<f64>,
    /// Whether hidden-line drawings leave out edges between faces that lie in one plane, such as the
    /// diagonals of a box that came as triangles. Default true.
    pub skip_flat_edges: bool,
}

impl Default for WireSettings {
    fn default() -> Self {
        Self {
            color: LinearRgb::BLACK,
            normal_color: LinearRgb::new(0.0, 0.1, 0.8),
            width: 1.0,
            point_size: 2.0,
            normal_length: None,
            skip_flat_edges: true,
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            shading: Shading::default(),
            raster: Raster::default(),
            samples: 1,
            threads: 0,
            cull: Culling::default(),
            tolerance_px: 0.25,
            gouraud: ColorInterpolation::default(),
            texture_method: TextureMethod::default(),
            filter: None,
            two_pass: true,
            crop: None,
            background: None,
            wire: WireSettings::default(),
            channel: Channel::default(),
        }
    }
}

impl Settings {
    /// Whether faces that show their back are drawn on a material that is double-sided or not.
    #[must_use]
    pub const fn draws_backs_of(&self, double_sided: bool) -> bool {
        match self.cull {
            Culling::ByMaterial => double_sided,
            Culling::Always => false,
            Culling::Never => true,
        }
    }

    /// Most samples per pixel.
    pub const MAX_SAMPLES: u32 = 256;

    /// `Ok` when every number is in its range.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let wrong = |name, value, expected| Err(RenderError::Setting { name, value, expected });
        let least_one = |v: f32| (1.0..=64.0).contains(&v);
        match () {
            () if self.samples == 0 || self.samples > Self::MAX_SAMPLES => {
                wrong("samples", f64::from(self.samples), "1 to 256")
            }
            () if !(self.tolerance_px > 0.0 && self.tolerance_px.is_finite()) => {
                wrong("tolerance_px", self.tolerance_px, "above 0 and finite")
            }
            () if self.samples > 1 && self.channel != Channel::Color => {
                wrong("samples", f64::from(self.samples), "1 for all channels but colour")
            }
            () if !least_one(self.wire.width) => wrong("wire.width", f64::from(self.wire.width), "1 to 64"),
            () if !least_one(self.wire.point_size) => {
                wrong("wire.point_size", f64::from(self.wire.point_size), "1 to 64")
            }
            () => Ok(()),
        }
    }

    /// The part of a picture of `width` by `height` pixels that is drawn.
    pub(crate) fn area(&self, width: u32, height: u32) -> Result<Crop, RenderError> {
        let Some(crop) = self.crop else { return Ok(Crop { x: 0, y: 0, width, height }) };
        let fits = |start: u32, length: u32, whole: u32| {
            length > 0 && start.checked_add(length).is_some_and(|end| end <= whole)
        };
        if fits(crop.x, crop.width, width) && fits(crop.y, crop.height, height) {
            return Ok(crop);
        }
        let Crop { x, y, width: w, height: h } = crop;
        Err(RenderError::Crop { x, y, width: w, height: h, image_width: width, image_height: height })
    }
}

impl Shading {
    /// Whether lines are drawn instead of faces.
    #[must_use]
    pub const fn is_lines(self) -> bool {
        matches!(self, Self::Wire | Self::WireNormals | Self::HiddenLine)
    }
}
