//! The options of `senca render`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum, ValueHint};
use senca::io::toml_scene::{MethodHint, RenderHints, ShadingHint};
use senca::math::glam::DVec3;
use senca::pipeline::Shading;
use senca::scene::Filter;
use senca::{LookAt, Method, Moment, Settings, ToneMap, Tracing, Viewpoint, pipeline};

use super::radiosity::RadiosityArguments;
use super::tracing::{AntialiasingChoice, TracingArguments, antialiasing};
use crate::cli::values::{BackgroundChoice, Crop, Size, Time, positive, stops, time, triple, view_angle};
use crate::cli::{Failure, LightFiles};

/// What is drawn and how.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Scene or model, told by its content; - is standard input
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) scene: PathBuf,

    #[command(flatten)]
    pub(crate) output: OutputArguments,
    #[command(flatten)]
    pub(crate) drawing: DrawingArguments,
    #[command(flatten)]
    pub(crate) tracing: TracingArguments,
    #[command(flatten)]
    pub(crate) radiosity: RadiosityArguments,
    #[command(flatten)]
    pub(crate) view: ViewArguments,
    #[command(flatten)]
    pub(crate) running: RunningArguments,
}

const EXAMPLES: &str = "\
Examples:
  senca render teapot.toml
  senca render bunny.obj -o bunny.png --size 1920x1080 --samples 8
  senca render house.dat --shading hidden-line -o house.svg
  senca render balls.toml --method trace --aa adaptive
  senca render balls.toml --method trace --pixel 320,240 --explain tree.svg
  senca render robot.glb --camera Front --time 1.5 -o - | display";

/// Where the picture goes.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub(crate) struct OutputArguments {
    /// Picture: .png .exr .pfm .ppm .jpg .bmp, or .svg for lines; - is standard output
    /// [default: the scene's name with .png, in this folder]
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) output: Option<PathBuf>,

    /// Format, in place of the one the extension names: png, exr, pfm, ppm, jpg, bmp or svg
    #[arg(long, value_name = "FORMAT")]
    pub(crate) format: Option<String>,

    /// Width and height in pixels [default: what the camera's proportions leave of 1024x768]
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<Size>,

    /// Draws only this part of the picture, from its top left corner
    #[arg(long, value_name = "X,Y,W,H")]
    pub(crate) crop: Option<Crop>,

    /// What pixels hold; all but color are drawn by the method raster, one sample a pixel, as numbers
    /// in exr and pfm and as false colours elsewhere
    #[arg(long, value_enum, value_name = "CHANNEL", default_value_t)]
    pub(crate) channel: ChannelChoice,

    /// Colour where nothing is: #rrggbb, linear R,G,B, white, black, or none for transparent
    /// [default: the scene's]
    #[arg(long, value_name = "COLOR")]
    pub(crate) background: Option<BackgroundChoice>,
}

/// How surfaces are drawn.
#[derive(Args, Debug)]
#[command(next_help_heading = "Drawing")]
pub(crate) struct DrawingArguments {
    /// How the scene is drawn: raster, trace, path or radiosity [default: the scene's, or raster]
    #[arg(long, value_name = "METHOD", value_parser = method)]
    pub(crate) method: Option<Method>,

    /// How surfaces look [default: material]
    #[arg(long, value_enum, value_name = "SHADING")]
    pub(crate) shading: Option<ShadingChoice>,

    /// Which rasterizer: the fast one, or the textbook's
    /// [default: tiled]
    #[arg(long, value_enum, value_name = "RASTER")]
    pub(crate) raster: Option<RasterChoice>,

    /// Samples per pixel against jagged edges, or passes of --aa adaptive [default: the scene's, or 1; of
    /// paths, 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub(crate) samples: Option<u32>,

    /// Antialiasing: none, or super for 4 samples a pixel unless --samples says how many; where rays
    /// are followed, jitter, adaptive and filter, too
    #[arg(long, value_name = "AA", value_parser = antialiasing)]
    pub(crate) aa: Option<AntialiasingChoice>,

    /// How texels become colours [default: as the scene says]
    #[arg(long, value_enum, value_name = "FILTER")]
    pub(crate) texture_filter: Option<FilterChoice>,

    /// How far curved surfaces may be from their polygons, in pixels
    #[arg(long, value_name = "PIXELS", value_parser = positive, default_value = "0.25")]
    pub(crate) tolerance: f64,

    /// Makes all light stronger or weaker: each stop up doubles it, each stop down halves it
    #[arg(long, value_name = "STOPS", value_parser = stops, default_value = "0", allow_hyphen_values = true)]
    pub(crate) exposure: f64,

    /// What becomes of light brighter than white
    #[arg(long, value_enum, value_name = "CURVE", default_value_t)]
    pub(crate) tone_map: ToneMapChoice,

    /// Which surfaces are left out for being turned away
    #[arg(long, value_enum, value_name = "WHICH", default_value_t)]
    pub(crate) cull: CullChoice,
}

/// From where, and when.
#[derive(Args, Debug)]
#[command(next_help_heading = "View")]
pub(crate) struct ViewArguments {
    /// Camera of the scene [default: its first; without one the whole scene is framed]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target", "up"])]
    pub(crate) camera: Option<String>,

    /// Place of the eye, in place of a camera of the scene
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub(crate) eye: Option<DVec3>,

    /// Point looked at [default: the centre of the scene]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub(crate) target: Option<DVec3>,

    /// Direction that is up in the picture [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,

    /// Vertical angle of view, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = view_angle)]
    pub(crate) fov: Option<f64>,

    /// Moment of the animation, in seconds [default: the pose of the file]; with a unit, as in 30s, the
    /// same as --time-limit
    #[arg(long, value_name = "SECONDS", value_parser = time)]
    pub(crate) time: Option<Time>,

    /// Animation to run, by name [default: the first]
    #[arg(long, value_name = "NAME", requires = "time")]
    pub(crate) animation: Option<String>,
}

/// How the program runs.
#[derive(Args, Debug)]
#[command(next_help_heading = "Running")]
pub(crate) struct RunningArguments {
    /// Threads to draw with; the picture is the same with any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,

    /// Seed of random numbers; the raster method draws none
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,

    /// Writes times and counts as one JSON object; - is standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) stats: Option<PathBuf>,

    /// No progress bar and no warnings
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// The method of this name.
fn method(text: &str) -> Result<Method, String> {
    match text {
        "raster" => Ok(Method::Raster),
        "trace" => Ok(Method::Trace),
        "path" => Ok(Method::Path),
        "radiosity" => Ok(Method::Radiosity),
        _ => Err("the methods are: raster, trace, path, radiosity".to_owned()),
    }
}

/// What pixels hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ChannelChoice {
    /// Light
    #[default]
    Color,
    /// Distance from the eye along the axis of the view
    Depth,
    /// Unit normals in world coordinates
    Normals,
    /// The number of the object, from 1
    Objects,
    /// The number of the triangle, from 1
    Triangles,
}

/// How surfaces look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShadingChoice {
    /// Edges only, hidden ones too
    Wire,
    /// Edges, and the normal of each vertex
    WireNormals,
    /// Edges that are not hidden
    HiddenLine,
    /// One colour per polygon
    Flat,
    /// Colours of vertices, interpolated
    Gouraud,
    /// Normals interpolated, light per pixel
    Phong,
    /// Light per pixel by the metallic-roughness model of glTF
    Material,
}

/// The rasterizers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum RasterChoice {
    /// Tiles, several pixels at once, on all cores
    #[default]
    Tiled,
    /// One scan line after the other
    Scanline,
}

/// What becomes of light brighter than white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ToneMapChoice {
    /// It is cut off; pictures of floats keep it
    #[default]
    None,
    /// Reinhard's curve: all of it fits below white
    Reinhard,
    /// A curve with a foot and a shoulder, as films have it
    Filmic,
}

impl From<ToneMapChoice> for ToneMap {
    fn from(choice: ToneMapChoice) -> Self {
        match choice {
            ToneMapChoice::None => Self::None,
            ToneMapChoice::Reinhard => Self::Reinhard,
            ToneMapChoice::Filmic => Self::Filmic,
        }
    }
}

/// Surfaces that are left out for being turned away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum CullChoice {
    /// Those whose material has one side
    #[default]
    Material,
    /// All: right for closed bodies seen from outside
    Always,
    /// None
    Never,
}

/// How texels become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FilterChoice {
    /// The nearest texel
    Nearest,
    /// The four texels around
    Bilinear,
    /// Mean over what the pixel covers
    Footprint,
    /// Bilinear in two levels of detail
    #[value(alias = "mipmap")]
    Trilinear,
}

/// Samples per pixel when antialiasing is asked for without a number.
const SUPER_SAMPLES: u32 = 4;

/// Most samples per pixel that radiosity takes because a scene says so.
const MOST_HINTED: u32 = 4;

/// Most samples per pixel.
const MOST_SAMPLES: u32 = 256;

impl Arguments {
    /// The library's settings for these options; `hints` are what the scene file says where they say
    /// nothing, `shading` is what the picture's format asks for, and `lines` whether it holds nothing but
    /// lines.
    pub(super) fn settings(
        &self,
        hints: &RenderHints,
        shading: Option<Shading>,
        lines: bool,
    ) -> Result<Settings, Failure> {
        let method = self.method(hints, lines);
        // Samples against noise are not needed where there is none.
        let most = if method == Method::Radiosity { MOST_HINTED } else { u32::MAX };
        let hints = &RenderHints { samples: hints.samples.map(|n| n.min(most)), ..hints.clone() };
        if lines && method != Method::Raster {
            return Err(Failure::usage("svg holds line drawings, which the method raster makes; write png"));
        }
        self.tracing.check(method)?;
        self.check_channel(method)?;
        let measures = self.output.channel != ChannelChoice::Color;
        self.radiosity.check(method)?;
        let hinted = self.view.viewpoint().or_else(|| hints.camera.clone().map(Viewpoint::Camera));
        Ok(Settings {
            size: self.output.size.map(|s| [s.width, s.height]).or(hints.size),
            crop: self.output.crop.map(Into::into),
            viewpoint: hinted.unwrap_or_default(),
            yfov: self.view.fov.map(f64::to_radians),
            moment: self.view.moment(hints.time),
            method,
            tracing: self.tracing(method, hints)?,
            radiosity: self.radiosity.settings(self.drawing.exposure),
            drawing: pipeline::Settings {
                shading: self.shading(method, shading)?,
                samples: if measures { 1 } else { self.drawing.samples_per_pixel(method, hints.samples)? },
                channel: self.output.channel.into(),
                background: self.output.background.map(Into::into),
                ..self.drawing.settings()
            },
        })
    }

    fn time_limit(&self) -> Option<Duration> {
        match self.view.time {
            Some(Time::Limit(limit)) => Some(limit),
            _ => self.tracing.time_limit,
        }
    }

    /// Where light is read from and kept.
    pub(super) fn light_files(&self) -> Result<LightFiles, Failure> {
        self.radiosity.light.files(self.time_limit())
    }

    /// The method: the option's, or the scene's.
    fn method(&self, hints: &RenderHints, lines: bool) -> Method {
        let hinted = match hints.method {
            Some(MethodHint::Trace) => Method::Trace,
            Some(MethodHint::Path) => Method::Path,
            Some(MethodHint::Radiosity) => Method::Radiosity,
            Some(MethodHint::Raster) | None => Method::Raster,
        };
        // Lines, one rasterizer or the other, and what only it draws ask for raster, whatever the scene says.
        let measures = self.output.channel != ChannelChoice::Color;
        let lines = lines || measures || self.drawing.shading.is_some_and(|s| Shading::from(s).is_lines());
        let implied = (lines || self.drawing.raster.is_some()).then_some(Method::Raster);
        self.drawing.method.or(implied).unwrap_or(hinted)
    }

    /// Refuses what does not go with channels that are no colours.
    fn check_channel(&self, method: Method) -> Result<(), Failure> {
        if self.output.channel == ChannelChoice::Color {
            return Ok(());
        }
        let lines = self.drawing.shading.is_some_and(|s| Shading::from(s).is_lines());
        let several = self.drawing.samples.is_some_and(|n| n > 1)
            || self.drawing.aa.is_some_and(|aa| aa != AntialiasingChoice::None);
        match () {
            () if method != Method::Raster => {
                Err(Failure::usage("--channel belongs to the method raster; leave out --method"))
            }
            () if lines => Err(Failure::usage("line drawings hold nothing but color; leave out --shading")),
            () if several => Err(Failure::usage(
                "depth, normals and numbers have no mean: they take one sample a pixel, without --samples and --aa",
            )),
            () => Ok(()),
        }
    }

    /// The shading; rays are shaded by the models of materials or all by the books', so what a scene
    /// says for the pipeline is passed over where it is neither.
    fn shading(&self, method: Method, hinted: Option<Shading>) -> Result<Shading, Failure> {
        if method != Method::Raster && self.drawing.raster.is_some() {
            return Err(Failure::usage("--raster belongs to the method raster; leave out one of them"));
        }
        let asked = self.drawing.shading.map(Shading::from);
        let fits = |shading: &Shading| {
            method == Method::Raster || matches!(shading, Shading::Phong | Shading::Material)
        };
        Ok(asked.or(hinted.filter(fits)).unwrap_or_default())
    }

    /// The settings for rays; those of the method raster are not looked at.
    fn tracing(&self, method: Method, hints: &RenderHints) -> Result<Tracing, Failure> {
        if method == Method::Raster {
            return Ok(Tracing::default());
        }
        // Of radiosity, light is limited in time, not samples.
        let limit = self.time_limit().filter(|_| method != Method::Radiosity);
        let (aa, samples, seed) = (self.drawing.aa, self.drawing.samples, self.running.seed);
        self.tracing.settings(method, aa, samples, limit, seed, hints)
    }
}

/// The pipeline's name for what a scene file says.
pub(super) fn shading_of_hint(hint: ShadingHint) -> Shading {
    match hint {
        ShadingHint::Wire => Shading::Wire,
        ShadingHint::HiddenLine => Shading::HiddenLine,
        ShadingHint::Flat => Shading::Flat,
        ShadingHint::Gouraud => Shading::Gouraud,
        ShadingHint::Phong => Shading::Phong,
        ShadingHint::Material => Shading::Material,
    }
}

impl ViewArguments {
    fn viewpoint(&self) -> Option<Viewpoint> {
        let Self { camera, eye, target, up, .. } = self;
        match camera {
            Some(name) => Some(Viewpoint::Camera(name.clone())),
            None if eye.is_none() && target.is_none() && up.is_none() => None,
            None => Some(Viewpoint::LookAt(LookAt { eye: *eye, target: *target, up: *up })),
        }
    }

    fn moment(&self, hint: Option<f64>) -> Option<Moment> {
        let asked = match self.time {
            Some(Time::Moment(seconds)) => Some(seconds),
            Some(Time::Limit(_)) | None => None,
        };
        let seconds = asked.or(hint)?;
        Some(Moment { seconds, animation: self.animation.clone() })
    }
}

impl DrawingArguments {
    /// All but shading, samples and background.
    fn settings(&self) -> pipeline::Settings {
        let standard = pipeline::Settings::default();
        pipeline::Settings {
            raster: self.raster.unwrap_or_default().into(),
            cull: self.cull.into(),
            tolerance_px: self.tolerance,
            filter: self.texture_filter.map(Into::into),
            ..standard
        }
    }

    fn samples_per_pixel(&self, method: Method, hint: Option<u32>) -> Result<u32, Failure> {
        if !matches!(method, Method::Raster | Method::Radiosity) {
            return Ok(1);
        }
        match (self.aa, self.samples) {
            // Rays have more ways; what the pipeline does with them is close enough.
            (Some(aa), samples) if method == Method::Radiosity && aa != AntialiasingChoice::None => {
                Ok(samples.unwrap_or(SUPER_SAMPLES).min(MOST_SAMPLES))
            }
            (Some(AntialiasingChoice::None), Some(n)) if n > 1 => Err(Failure::usage(format!(
                "--aa none draws one sample a pixel; leave out --samples {n} or --aa none"
            ))),
            (_, Some(n)) if n > MOST_SAMPLES => Err(Failure::usage(format!(
                "the method raster draws up to {MOST_SAMPLES} samples a pixel, not {n}"
            ))),
            (Some(AntialiasingChoice::None), _) => Ok(1),
            (Some(AntialiasingChoice::Super), None) => Ok(SUPER_SAMPLES),
            (None | Some(AntialiasingChoice::Super), samples) => {
                Ok(samples.or(hint).unwrap_or(1).min(MOST_SAMPLES))
            }
            (Some(_), _) => Err(Failure::usage(
                "the method raster has --aa none and super; the others are for --method trace and path",
            )),
        }
    }
}

impl From<ShadingChoice> for Shading {
    fn from(choice: ShadingChoice) -> Self {
        match choice {
            ShadingChoice::Wire => Self::Wire,
            ShadingChoice::WireNormals => Self::WireNormals,
            ShadingChoice::HiddenLine => Self::HiddenLine,
            ShadingChoice::Flat => Self::Flat,
            ShadingChoice::Gouraud => Self::Gouraud,
            ShadingChoice::Phong => Self::Phong,
            ShadingChoice::Material => Self::Material,
        }
    }
}

impl From<ChannelChoice> for pipeline::Channel {
    fn from(choice: ChannelChoice) -> Self {
        match choice {
            ChannelChoice::Color => Self::Color,
            ChannelChoice::Depth => Self::Depth,
            ChannelChoice::Normals => Self::Normals,
            ChannelChoice::Objects => Self::Objects,
            ChannelChoice::Triangles => Self::Triangles,
        }
    }
}

impl From<CullChoice> for pipeline::Culling {
    fn from(choice: CullChoice) -> Self {
        match choice {
            CullChoice::Material => Self::ByMaterial,
            CullChoice::Always => Self::Always,
            CullChoice::Never => Self::Never,
        }
    }
}

impl From<RasterChoice> for pipeline::Raster {
    fn from(choice: RasterChoice) -> Self {
        match choice {
            RasterChoice::Tiled => Self::Tiled,
            RasterChoice::Scanline => Self::Scanline,
        }
    }
}

impl From<FilterChoice> for Filter {
    fn from(choice: FilterChoice) -> Self {
        match choice {
            FilterChoice::Nearest => Self::Nearest,
            FilterChoice::Bilinear => Self::Bilinear,
            FilterChoice::Footprint => Self::Footprint,
            FilterChoice::Trilinear => Self::Trilinear,
        }
    }
}
