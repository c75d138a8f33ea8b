//! The `[render]` table: how the author meant the picture to be made.

use super::source::Result;
use super::values::Value;

/// What a scene file says about its picture. Everything is a default that the command line overrides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderHints {
    /// Width and height in pixels, each from 1 to 65536.
    pub size: Option<[u32; 2]>,
    /// How the picture is made.
    pub method: Option<MethodHint>,
    /// How surfaces are shown by the pipeline.
    pub shading: Option<ShadingHint>,
    /// Name of the camera; it is one of the scene's.
    pub camera: Option<String>,
    /// Samples per pixel, from 1 to 65536.
    pub samples: Option<u32>,
    /// Time of the animations in seconds.
    pub time: Option<f64>,
    /// Deepest nesting of reflected and transmitted rays, MaxNest of the recursive tracer, from 0 to
    /// 10^6.
    pub max_depth: Option<u32>,
    /// How a tracer smooths edges.
    pub aa: Option<AntialiasingHint>,
    /// How a tracer finds what a ray meets.
    pub accel: Option<AccelerationHint>,
}

/// Ways of a tracer to smooth edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AntialiasingHint {
    /// One ray through the middle of each pixel.
    None,
    /// One ray at a random place in each pixel.
    Jitter,
    /// A regular grid of rays in each pixel.
    Super,
    /// More rays where neighbouring ones differ.
    Adaptive,
    /// Evenly spread places and a reconstruction filter.
    Filter,
}

/// Ways of a tracer to find what a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccelerationHint {
    /// Every object is tried.
    None,
    /// A sphere around each object.
    Spheres,
    /// A box around each object.
    Bounds,
    /// The hierarchy of the scene's nodes.
    Hierarchy,
    /// A uniform grid.
    Grid,
    /// An octree.
    Octree,
    /// A hierarchy of bounding boxes.
    Bvh,
}

/// Ways to make a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodHint {
    /// The standard pipeline.
    Raster,
    /// Recursive ray tracing.
    Trace,
    /// Radiosity.
    Radiosity,
    /// Path tracing.
    Path,
}

/// Ways to show surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadingHint {
    /// All edges.
    Wire,
    /// Visible edges.
    HiddenLine,
    /// One colour a face.
    Flat,
    /// Colours interpolated between the corners.
    Gouraud,
    /// Normals interpolated between the corners.
    Phong,
    /// The material's own model at every pixel.
    Material,
}

const METHODS: [(&str, MethodHint); 4] = [
    ("raster", MethodHint::Raster),
    ("trace", MethodHint::Trace),
    ("radiosity", MethodHint::Radiosity),
    ("path", MethodHint::Path),
];

const ANTIALIASINGS: [(&str, AntialiasingHint); 5] = [
    ("none", AntialiasingHint::None),
    ("jitter", AntialiasingHint::Jitter),
    ("super", AntialiasingHint::Super),
    ("adaptive", AntialiasingHint::Adaptive),
    ("filter", AntialiasingHint::Filter),
];

const ACCELERATIONS: [(&str, AccelerationHint); 7] = [
    ("none", AccelerationHint::None),
    ("spheres", AccelerationHint::Spheres),
    ("bounds", AccelerationHint::Bounds),
    ("hierarchy", AccelerationHint::Hierarchy),
    ("grid", AccelerationHint::Grid),
    ("octree", AccelerationHint::Octree),
    ("bvh", AccelerationHint::Bvh),
];

const SHADINGS: [(&str, ShadingHint); 6] = [
    ("wire", ShadingHint::Wire),
    ("hidden-line", ShadingHint::HiddenLine),
    ("flat", ShadingHint::Flat),
    ("gouraud", ShadingHint::Gouraud),
    ("phong", ShadingHint::Phong),
    ("material", ShadingHint::Material),
];

/// Reads `[render]`; `cameras` are the names of the scene's cameras.
pub(super) fn read(value: Value<'_>, cameras: &[&str]) -> Result<RenderHints> {
    let mut table = value.table("the render table")?;
    let most = senca_math::Image::MAX_SIDE;
    let camera = table.read("camera", |value| {
        let name = value.string()?;
        if cameras.contains(&name) {
            return Ok(name.to_owned());
        }
        Err(value.error(format!("camera \"{name}\" is not defined{}", super::names::hint(name, cameras))))
    })?;
    let hints = RenderHints {
        size: table
            .read("size", |value| value.array("two whole numbers: width and height", |v| v.whole(1, most)))?,
        method: table.read("method", |value| value.choice(&METHODS))?,
        shading: table.read("shading", |value| value.choice(&SHADINGS))?,
        camera,
        samples: table.read("samples", |value| value.whole(1, 1 << 16))?,
        time: table.read("time", Value::number)?,
        max_depth: table.read("max_depth", |value| value.whole(0, 1_000_000))?,
        aa: table.read("aa", |value| value.choice(&ANTIALIASINGS))?,
        accel: table.read("accel", |value| value.choice(&ACCELERATIONS))?,
    };
    table.finish()?;
    Ok(hints)
}
