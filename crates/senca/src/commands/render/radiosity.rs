//! `senca render --method radiosity`.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use senca::pipeline::Control;
use senca::radiosity::Solution;
use senca::{Display, Image, Method, RadiositySettings, Report, Scene, Settings, Show, show_light};

use super::Arguments;
use crate::cli::values::{duration, positive};
use crate::cli::{Failure, Interrupt, Light, LightArguments, LightFiles};

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

    /// Writes the picture this often while light is computed, as far as it has come: 5s, 1m
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    pub(crate) preview: Option<Duration>,

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
            ("--preview", self.preview.is_some()),
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

/// Draws a scene by radiosity. `write_early` gets pictures of light that is still being computed.
pub(super) fn draw(
    arguments: &Arguments,
    files: &LightFiles,
    scene: Scene,
    settings: &Settings,
    control: &Control<'_>,
    interrupt: &Interrupt,
    write_early: &(dyn Fn(Image, Report) + Sync),
) -> Result<(Image, Report, Light), Failure> {
    let first = |share: f32| control.report(COMPUTING * share);
    let second = |share: f32| control.report(COMPUTING + (1.0 - COMPUTING) * share);
    let computing = Control { progress: Some(&first), cancel: control.cancel };
    let quiet = Control { progress: None, cancel: control.cancel };
    let mut last: Option<Instant> = None;
    let mut early = |solution: &Solution| {
        let Some(every) = arguments.radiosity.preview else { return };
        if last.is_some_and(|last| last.elapsed() < every) {
            return;
        }
        if let Ok((image, report)) = show_light(Cow::Borrowed(&scene), solution, settings, &quiet) {
            write_early(image, report);
        }
        last = Some(Instant::now());
    };
    let light = files.light(&arguments.scene, &scene, settings, &computing, interrupt, &mut early)?;
    let showing = Control { progress: Some(&second), cancel: control.cancel };
    let (image, report) = show_light(Cow::Owned(scene), &light.solution, settings, &showing)
        .map_err(|error| Failure::of_scene(&arguments.scene, &error))?;
    Ok((image, report, light))
}
