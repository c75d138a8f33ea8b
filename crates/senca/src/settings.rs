//! What a caller of [`render`](crate::render) chooses.

use senca_math::glam::DVec3;

use senca_pipeline::Crop;
use senca_trace::antialias::Antialiasing;
use senca_trace::path::PathSettings;
use senca_trace::{RecursiveSettings, WorldSettings};
use std::time::Duration;

use crate::RadiositySettings;

/// What is drawn, from where, when and how. The default draws the scene as it is: 1024 x 768 pixels
/// or what of them the camera's proportions leave, from its first camera, in the pose of its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Width and height in pixels, each 1 to 65 404. Default: the largest of the camera's own
    /// proportions within 1024 x 768.
    pub size: Option<[u32; 2]>,
    /// Part of the picture that is drawn and returned. Default: all.
    pub crop: Option<Crop>,
    /// From where. Default: the first camera, or one that frames the scene.
    pub viewpoint: Viewpoint,
    /// Full vertical angle of view in radians, in (0, pi), in place of the one of a perspective camera.
    /// Default: the camera's own, or 30 degrees.
    pub yfov: Option<f64>,
    /// When. Default: the pose of the file.
    pub moment: Option<Moment>,
    /// By which method. Default [`Method::Raster`].
    pub method: Method,
    /// How. The picture's crop goes into [`Settings::crop`]; the one in here is not looked at. The
    /// tracer looks at shading, threads, culling, filter and background.
    pub drawing: senca_pipeline::Settings,
    /// How rays are traced, where they are.
    pub tracing: Tracing,
    /// How light is computed and shown by [`Method::Radiosity`].
    pub radiosity: RadiositySettings,
}

/// The ways to make a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    /// The standard pipeline.
    #[default]
    Raster,
    /// Recursive ray tracing.
    Trace,
    /// Path tracing: light from everywhere, at the price of noise that falls with samples.
    Path,
    /// Radiosity: light exchanged between matt surfaces, computed once for all cameras.
    Radiosity,
}

/// How rays are traced.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tracing {
    /// How they are followed. Light model, backs and filter are taken from [`Settings::drawing`].
    pub recursive: RecursiveSettings,
    /// How paths are followed. Backs and filter are taken from [`Settings::drawing`].
    pub path: PathSettings,
    /// Whether the picture is saved in part or resumed, so that a fingerprint of the scene is needed.
    pub keeps_partial: bool,
    /// How pixels are sampled. Default: one ray through the middle.
    pub antialiasing: Antialiasing,
    /// How rays find what they meet.
    pub world: WorldSettings,
    /// Time after which no further sample is begun; every pixel gets one. Default: none.
    pub time_limit: Option<Duration>,
}

/// From where a scene is seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Viewpoint {
    /// The scene's first camera; without one, a camera that frames the whole scene.
    #[default]
    First,
    /// The scene's camera of this name, or at the node of this name.
    Camera(String),
    /// A camera of the caller's.
    LookAt(LookAt),
}

/// A camera of the caller's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LookAt {
    /// Place of the eye, in world coordinates. Default: in front of the scene, so that all of it is
    /// seen.
    pub eye: Option<DVec3>,
    /// The point looked at. Default: the centre of the scene.
    pub target: Option<DVec3>,
    /// What is up in the picture. Default: +y; -z for an eye that looks straight down, +z straight up.
    pub up: Option<DVec3>,
}

/// A moment of a scene's animations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// Seconds from the start.
    pub seconds: f64,
    /// Name of the animation that runs. Default: the first.
    pub animation: Option<String>,
}
