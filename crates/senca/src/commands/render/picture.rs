//! The picture that `senca render` makes: where it goes, and in which format.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use senca::io::images::{PictureFormat, PictureOptions, encode};
use senca::pipeline::{Control, Shading};
use senca::{Error, Image, Method, Report, Scene, Settings, ToneMap, false_color, render_with};

use super::Arguments;
use super::arguments::ChannelChoice;
use super::partial::Partial;
use crate::cli::output::{check_writable, default_name, is_standard};
use crate::cli::{Failure, Interrupt};

/// Formats of pictures and drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// Pixels.
    Pixels(PictureFormat),
    /// Lines, as SVG.
    Svg,
}

/// Where the picture goes, and in which format.
#[derive(Clone, Debug)]
pub(super) struct Target {
    path: PathBuf,
    format: Format,
}

/// A finished picture with what its drawing told.
pub(super) struct Drawn {
    content: Content,
    pub(super) samples_map: Option<Image>,
    pub(super) report: Report,
    pub(super) size: [u32; 2],
}

enum Content {
    Pixels(Image, PictureFormat),
    Svg(String),
}

impl Target {
    /// From the options, when they fit each other and the place can be written.
    pub(super) fn of(arguments: &Arguments) -> Result<Self, Failure> {
        let wish = &arguments.output;
        let format = match (&wish.format, &wish.output) {
            (Some(name), _) => format_named(name)?,
            (None, Some(path)) if !is_standard(path) => format_of(path)?,
            (None, _) => Format::Pixels(PictureFormat::Png),
        };
        let shows_faces = arguments.drawing.shading.is_some_and(|s| !Shading::from(s).is_lines());
        let measures = wish.channel != ChannelChoice::Color;
        if format == Format::Svg && measures {
            return Err(Failure::usage("svg holds line drawings only; write --channel to exr, pfm or png"));
        }
        if format == Format::Svg && shows_faces {
            return Err(Failure::usage(
                "svg holds line drawings only; take --shading wire, wire-normals or hidden-line, or write png",
            ));
        }
        let path = wish.output.clone().unwrap_or_else(|| default_name(&arguments.scene, extension(format)));
        check_writable(&path)?;
        Ok(Self { path, format })
    }

    /// No picture at all.
    pub(super) fn nowhere() -> Self {
        Self { path: PathBuf::new(), format: Format::Pixels(PictureFormat::Png) }
    }

    /// Whether the picture is made of lines.
    pub(super) fn is_drawing(&self) -> bool {
        self.format == Format::Svg
    }

    /// The shading where the options say nothing: the scene's, unless the format cannot hold it.
    pub(super) fn shading(&self, hint: Option<Shading>) -> Option<Shading> {
        match self.format {
            Format::Svg => hint.filter(|s| s.is_lines()).or(Some(Shading::HiddenLine)),
            Format::Pixels(_) => hint,
        }
    }

    /// Where the picture goes.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// A picture that was drawn.
    pub(super) fn drawn(&self, image: Image, report: Report) -> Drawn {
        let format = match self.format {
            Format::Pixels(format) => format,
            Format::Svg => PictureFormat::Png,
        };
        let size = [image.width(), image.height()];
        Drawn { content: Content::Pixels(image, format), samples_map: None, report, size }
    }

    /// Draws the scene for this target.
    pub(super) fn draw(
        &self,
        scene: Cow<'_, Scene>,
        settings: &Settings,
        control: &Control<'_>,
        partial: &Partial,
        interrupt: &Interrupt,
    ) -> Result<Drawn, Error> {
        let mut samples_map = None;
        let (content, size, report) = match self.format {
            Format::Pixels(format) if settings.method != Method::Raster => {
                let traced = partial.trace(scene, settings, control, interrupt)?;
                samples_map = traced.samples_map;
                let size = [traced.image.width(), traced.image.height()];
                (Content::Pixels(traced.image, format), size, traced.report)
            }
            Format::Pixels(format) => {
                let (mut image, report) = render_with(scene, settings, control)?;
                // Formats of floats hold the numbers themselves.
                if !matches!(format, PictureFormat::Exr | PictureFormat::Pfm) {
                    false_color(&mut image, settings.drawing.channel);
                }
                let size = [image.width(), image.height()];
                (Content::Pixels(image, format), size, report)
            }
            Format::Svg => {
                let (svg, size, report) = senca::render_svg(scene, settings, control)?;
                (Content::Svg(svg), size, report)
            }
        };
        Ok(Drawn { content, samples_map, report, size })
    }
}

impl Drawn {
    /// The pixels, where it has any.
    pub(super) fn image(&self) -> Option<&Image> {
        match &self.content {
            Content::Pixels(image, _) => Some(image),
            Content::Svg(_) => None,
        }
    }

    /// Maps the tones of pixels.
    pub(super) fn map_tones(&mut self, tone_map: ToneMap) {
        if let Content::Pixels(image, _) = &mut self.content {
            tone_map.apply(image);
        }
    }

    /// The bytes of the file.
    pub(super) fn encode(&self) -> Result<Cow<'_, [u8]>, Failure> {
        match &self.content {
            Content::Pixels(image, format) => Ok(encode(image, *format, &PictureOptions::default())?.into()),
            Content::Svg(text) => Ok(text.as_bytes().into()),
        }
    }
}

/// Finds out before the work whether `path` names a picture of pixels that can be written.
pub(super) fn check_pixels(path: &Path) -> Result<(), Failure> {
    if is_standard(path) || format_of(path)? != Format::Svg {
        return check_writable(path);
    }
    Err(Failure::usage(format!("{}: a map of samples has pixels; take png", path.display())))
}

/// A picture as the bytes of the file at `path`.
pub(super) fn encoded(path: &Path, image: &Image) -> Result<Vec<u8>, Failure> {
    let format = match format_of(path) {
        Ok(Format::Pixels(format)) => format,
        _ => PictureFormat::Png,
    };
    Ok(encode(image, format, &PictureOptions::default())?)
}

fn extension(format: Format) -> &'static str {
    match format {
        Format::Pixels(format) => format.extension(),
        Format::Svg => "svg",
    }
}

fn format_named(name: &str) -> Result<Format, Failure> {
    if name.eq_ignore_ascii_case("svg") {
        return Ok(Format::Svg);
    }
    PictureFormat::from_extension(name).map(Format::Pixels).ok_or_else(|| unknown(&format!("\"{name}\"")))
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let Some(extension) = path.extension() else {
        return Err(unknown(&format!("{} has no extension, which", path.display())));
    };
    format_named(&extension.to_string_lossy())
}

fn unknown(what: &str) -> Failure {
    let known: Vec<_> = PictureFormat::ALL.iter().map(|f| f.extension()).collect();
    Failure::usage(format!("{what} names no picture format; there are: {}, svg", known.join(", ")))
}
