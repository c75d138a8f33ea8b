//! `senca render --method radiosity`.

use std::borrow::Cow;

use clap::{Args, ValueEnum};
use senca::pipeline::Control;
use senca::{Display, Image, Method, RadiositySettings, Report, Scene, Settings, Show, show_light};

use super::Arguments;
use crate::cli::values::positive;
use crate::cli::{Failure, Interrupt, LightArguments, LightFiles};

/// How light is computed and shown.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Radiosity (method radiosity)")]
pub(crate) struct RadiosityArguments {
    #[command(flatten)]
    pub(crate) light: LightArguments,

    /// How light gets into the picture [default: bilinear]
    #[arg(long, value_enum, value_name = "DISPLAY")]
    pub(crate) display: Option<DisplayChoice>,

    /// What is shown [default: light]
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(crate) show: Option<ShowChoice>,

    /// Upper end of the scale of false colours, in lux [default: what there is, rounded up]
    #[arg(long, value_name = "LUX", value_parser = positive)]
    pub(crate) scale_max: Option<f64>,

    /// Equal steps of false colours are equal factors
    #[arg(long)]
    pub(crate) log_scale: bool,

    /// Luminance that a shown 1 stands for, in candela per square metre
    #[arg(long, value_name = "CD/M2", value_parser = positive, default_value = "1")]
    pub(crate) luminance_of_one: f64,
}

/// The ways from patches to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DisplayChoice {
    /// One colour a patch
    Flat,
    /// Colours of nodes, interpolated in the picture
    Gouraud,
    /// Light of nodes, interpolated in the scene
    Bilinear,
    /// By the recursive tracer, with the light in place of the ambient light
    Trace,
    /// Gathered once more at every place that is seen: slow, and sharp
    Gather,
}

/// What is shown of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShowChoice {
    /// The scene in its light
    Light,
    /// The scene in its light, with the edges of patches
    Mesh,
    /// Illuminance in lux, by a scale of colours
    FalseColor,
    /// The same, with the edges of patches
    FalseColorMesh,
}

impl RadiosityArguments {
    /// Refuses options that belong to another method.
    pub(super) fn check(&self, method: Method) -> Result<(), Failure> {
        let given = [
            ("--display", self.display.is_some()),
            ("--show", self.show.is_some()),
            ("--scale-max", self.scale_max.is_some()),
            ("--log-scale", self.log_scale),
        ];
        let given = given.iter().find(|(_, given)| *given).map(|(name, _)| *name);
        match given.or_else(|| self.light.any()) {
            Some(option) if method != Method::Radiosity => Err(Failure::usage(format!(
                "{option} belongs to the method radiosity; add --method radiosity"
            ))),
            _ => self.light.check(),
        }
    }

    /// The library's settings; `exposure` in stops.
    pub(super) fn settings(&self, exposure: f64) -> RadiositySettings {
        RadiositySettings {
            display: self.display.map(Display::from).unwrap_or_default(),
            show: self.show(),
            ..self.light.settings(exposure)
        }
    }

    fn show(&self) -> Show {
        let false_colors = |mesh| Show::FalseColors {
            most: self.scale_max,
            luminance_of_one: self.luminance_of_one,
            logarithmic: self.log_scale,
            mesh,
        };
        match self.show {
            None | Some(ShowChoice::Light) => Show::Light,
            Some(ShowChoice::Mesh) => Show::Mesh,
            Some(ShowChoice::FalseColor) => false_colors(false),
            Some(ShowChoice::FalseColorMesh) => false_colors(true),
        }
    }
}

impl From<DisplayChoice> for Display {
    fn from(choice: DisplayChoice) -> Self {
        match choice {
            DisplayChoice::Flat => Self::Flat,
            DisplayChoice::Gouraud => Self::Gouraud,
            DisplayChoice::Bilinear => Self::Bilinear,
            DisplayChoice::Trace => Self::Trace,
            DisplayChoice::Gather => Self::Gather,
        }
    }
}

/// Share of the progress bar that computing takes.
const COMPUTING: f32 = 0.8;

/// Draws a scene by radiosity.
pub(super) fn draw(
    arguments: &Arguments,
    files: &LightFiles,
    scene: Scene,
    settings: &Settings,
    control: &Control<'_>,
    interrupt: &Interrupt,
) -> Result<(Image, Report), Failure> {
    let first = |share: f32| control.report(COMPUTING * share);
    let second = |share: f32| control.report(COMPUTING + (1.0 - COMPUTING) * share);
    let computing = Control { progress: Some(&first), cancel: control.cancel };
    let light = files.light(&arguments.scene, &scene, settings, &computing, interrupt)?;
    let showing = Control { progress: Some(&second), cancel: control.cancel };
    show_light(Cow::Owned(scene), &light, settings, &showing)
        .map_err(|error| Failure::of_scene(&arguments.scene, &error))
}

/// Says that light is not as exact as it was asked to be, where it is not.
pub(super) fn warning(report: &Report) -> Option<String> {
    let light = report.radiosity.filter(|light| !light.converged)?;
    Some(format!(
        "the light is not as exact as asked for: after {} rounds it changed by {:.1e} of the brightest, and {:.1e} of the \
         power is not accounted for",
        light.iterations, light.residual, light.energy_error
    ))
}
