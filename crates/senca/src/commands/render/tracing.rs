//! The options of `senca render` for the methods that follow rays.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueHint};
use senca::io::toml_scene::{AccelerationHint, AntialiasingHint, RenderHints};
use senca::trace::antialias::{AdaptiveSettings, Antialiasing, PixelFilter};
use senca::trace::path::PathSettings;
use senca::trace::{Accel, RecursiveSettings, WorldSettings};
use senca::{Method, Tracing};

use crate::cli::Failure;
use crate::cli::values::{Pixel, duration, not_negative, positive, share};

/// How rays are followed.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Ray tracing (methods trace and path)")]
pub(crate) struct TracingArguments {
    /// How rays find what they meet: none, spheres, bounds, hierarchy, grid, octree, sah or bvh
    /// [default: the scene's, or bvh]
    #[arg(long, value_name = "ACCEL", value_parser = accel)]
    pub(crate) accel: Option<Accel>,

    /// How often a ray may be reflected or transmitted [default: the scene's, or 8; of paths, 128]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    pub(crate) max_depth: Option<u32>,

    /// Leaves out rays whose share in the pixel is below this; 0 follows all to the full depth
    /// [default: 1/255]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) adaptive_depth: Option<f64>,

    /// Distance below which a ray does not meet the surface it starts on, in world units [default:
    /// by rounding]
    #[arg(long, value_name = "LENGTH", value_parser = not_negative)]
    pub(crate) epsilon: Option<f64>,

    /// Side of the square that --aa jitter moves rays in, in pixels [default: 1]
    #[arg(long, value_name = "PIXELS", value_parser = share)]
    pub(crate) jitter: Option<f64>,

    /// Difference in brightness, 0 to 1, from which on --aa adaptive looks closer [default: 0.1]
    #[arg(long, value_name = "DIFFERENCE", value_parser = share)]
    pub(crate) aa_threshold: Option<f64>,

    /// How many times --aa adaptive halves a pixel at most [default: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=8))]
    pub(crate) aa_level: Option<u32>,

    /// Filter of --aa filter: box, tent, gaussian, mitchell or blackman-harris [default: mitchell]
    #[arg(long, value_name = "FILTER")]
    pub(crate) filter: Option<String>,

    /// Radius of the filter in pixels, up to 8 [default: its usual one]
    #[arg(long, value_name = "PIXELS", value_parser = positive, requires = "filter")]
    pub(crate) filter_radius: Option<f64>,

    /// Shadow rays along each side of an area light, up to 64; 0 for its middle alone [default: 4 with
    /// one sample a pixel, fewer with more]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=64))]
    pub(crate) soft_shadows: Option<u32>,

    /// Transparent bodies cast shadows, in their colour
    #[arg(long)]
    pub(crate) transparent_shadows: bool,

    /// Nothing casts a shadow
    #[arg(long, conflicts_with = "transparent_shadows")]
    pub(crate) no_shadows: bool,

    /// Takes samples until this time is up: 30s, 5m, 1h; every pixel gets one at least
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    pub(crate) time_limit: Option<Duration>,

    /// Partial picture: is gone on with where it exists, and kept up to date
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) resume: Option<PathBuf>,

    /// Writes a picture of how many samples each pixel took, white for the most
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) samples_map: Option<PathBuf>,

    /// Column and row of a pixel to explain, from the top left corner
    #[arg(long, value_name = "X,Y", requires = "explain")]
    pub(crate) pixel: Option<Pixel>,

    /// Explains the pixel instead of drawing: all its rays as text, or as .svg, .dot or .json
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", requires = "pixel",
          value_hint = ValueHint::FilePath)]
    pub(crate) explain: Option<PathBuf>,
}

fn accel(text: &str) -> Result<Accel, String> {
    text.parse::<Accel>().map_err(|error| error.to_string())
}

/// The ways against jagged edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AntialiasingChoice {
    /// One sample in the middle of each pixel.
    None,
    /// One sample at a random place in each pixel.
    Jitter,
    /// Several samples a pixel, in a grid where rays are followed.
    Super,
    /// More samples where neighbouring ones differ.
    Adaptive,
    /// Evenly spread samples and a filter.
    Filter,
}

/// The way against jagged edges of this name.
pub(super) fn antialiasing(text: &str) -> Result<AntialiasingChoice, String> {
    Ok(match text {
        "none" => AntialiasingChoice::None,
        "jitter" => AntialiasingChoice::Jitter,
        "super" => AntialiasingChoice::Super,
        "adaptive" => AntialiasingChoice::Adaptive,
        "filter" => AntialiasingChoice::Filter,
        _ => return Err("antialiasing is none, super, jitter, adaptive or filter".to_owned()),
    })
}

impl From<AntialiasingHint> for AntialiasingChoice {
    fn from(hint: AntialiasingHint) -> Self {
        match hint {
            AntialiasingHint::None => Self::None,
            AntialiasingHint::Jitter => Self::Jitter,
            AntialiasingHint::Super => Self::Super,
            AntialiasingHint::Adaptive => Self::Adaptive,
            AntialiasingHint::Filter => Self::Filter,
        }
    }
}

/// Samples of the regular grid, and of filters, without a number.
const SUPER_PER_SIDE: u32 = 2;
const FILTER_SAMPLES: u32 = 16;
const PATH_SAMPLES: u32 = 64;

/// Samples with which a picture is never finished before its time.
const ENDLESS_SAMPLES: u32 = 1 << 16;

impl TracingArguments {
    /// An option that the method raster knows nothing of, if one is given.
    fn any(&self) -> Option<&'static str> {
        let given = [
            ("--accel", self.accel.is_some()),
            ("--max-depth", self.max_depth.is_some()),
            ("--adaptive-depth", self.adaptive_depth.is_some()),
            ("--epsilon", self.epsilon.is_some()),
            ("--jitter", self.jitter.is_some()),
            ("--aa-threshold", self.aa_threshold.is_some()),
            ("--aa-level", self.aa_level.is_some()),
            ("--filter", self.filter.is_some()),
            ("--soft-shadows", self.soft_shadows.is_some()),
            ("--transparent-shadows", self.transparent_shadows),
            ("--no-shadows", self.no_shadows),
            ("--time-limit", self.time_limit.is_some()),
            ("--resume", self.resume.is_some()),
            ("--samples-map", self.samples_map.is_some()),
            ("--pixel", self.pixel.is_some()),
        ];
        given.iter().find(|(_, given)| *given).map(|(name, _)| *name)
    }

    /// An option that only the recursive tracer knows, if one is given.
    fn any_recursive(&self) -> Option<&'static str> {
        let given = [
            ("--adaptive-depth", self.adaptive_depth.is_some()),
            ("--soft-shadows", self.soft_shadows.is_some()),
            ("--transparent-shadows", self.transparent_shadows),
            ("--no-shadows", self.no_shadows),
            ("--pixel", self.pixel.is_some()),
        ];
        given.iter().find(|(_, given)| *given).map(|(name, _)| *name)
    }

    /// Refuses options that do not go with the method.
    pub(super) fn check(&self, method: Method) -> Result<(), Failure> {
        let refuse = |option: &str, methods: &str| {
            Err(Failure::usage(format!("{option} belongs to {methods}; add --method trace")))
        };
        match method {
            Method::Raster => match self.any() {
                Some(option) => refuse(option, "the methods trace and path"),
                None => Ok(()),
            },
            Method::Path => match self.any_recursive() {
                Some(option) => refuse(option, "the method trace"),
                None => Ok(()),
            },
            Method::Radiosity => match (&self.resume, &self.samples_map, &self.explain) {
                (None, None, None) => Ok(()),
                _ => refuse("--resume, --samples-map and --explain", "the method trace"),
            },
            Method::Trace => Ok(()),
        }
    }

    /// The library's settings. `aa` and `samples` are the options of these names, `seed` starts random
    /// numbers.
    pub(super) fn settings(
        &self,
        method: Method,
        aa: Option<AntialiasingChoice>,
        samples: Option<u32>,
        time_limit: Option<Duration>,
        seed: u64,
        hints: &RenderHints,
    ) -> Result<Tracing, Failure> {
        let antialiasing = self.antialiasing(method, aa, samples, time_limit, hints)?;
        let standard = RecursiveSettings::default();
        let path = PathSettings::default();
        let depth = self.max_depth.or(hints.max_depth);
        let recursive = RecursiveSettings {
            max_depth: depth.unwrap_or(standard.max_depth),
            adaptive_depth: self.adaptive_depth.map_or(standard.adaptive_depth, |v| v as f32),
            shadows: !self.no_shadows,
            // A picture that is gone on with has to stay the same with more samples.
            soft_shadows: self.soft_shadows.unwrap_or_else(|| match self.resume {
                Some(_) => 1,
                None => soft_shadows_for(antialiasing),
            }),
            transparent_shadows: self.transparent_shadows,
            seed,
            ..standard
        };
        let kind = self.accel.or(hints.accel.map(accel_of_hint)).unwrap_or_default();
        Ok(Tracing {
            recursive,
            path: PathSettings { max_bounces: depth.unwrap_or(path.max_bounces), ..path },
            antialiasing,
            world: WorldSettings { accel: kind.into(), epsilon: self.epsilon, ..WorldSettings::default() },
            time_limit,
            keeps_partial: self.resume.is_some(),
        })
    }

    fn antialiasing(
        &self,
        method: Method,
        aa: Option<AntialiasingChoice>,
        samples: Option<u32>,
        time_limit: Option<Duration>,
        hints: &RenderHints,
    ) -> Result<Antialiasing, Failure> {
        let named = aa.or(hints.aa.map(Into::into).filter(|_| samples.is_none()));
        let hinted = samples.or(hints.samples.filter(|_| aa.is_none()));
        let random = |samples| Ok(Antialiasing::Filtered { samples, filter: PixelFilter::Box });
        let endless = time_limit.map(|_| ENDLESS_SAMPLES);
        self.check_filter(named)?;
        match named {
            _ if self.filter.is_some() => self.filtered(hinted.or(endless)),
            None if method == Method::Path => random(hinted.or(endless).unwrap_or(PATH_SAMPLES)),
            None => match hinted.or(endless) {
                Some(n) if n > 1 => random(n),
                _ => Ok(Antialiasing::None),
            },
            Some(AntialiasingChoice::None) => one_sample("none", samples, Antialiasing::None),
            Some(AntialiasingChoice::Jitter) => {
                let amplitude = self.jitter.unwrap_or(1.0);
                one_sample("jitter", samples, Antialiasing::Jitter { amplitude })
            }
            Some(AntialiasingChoice::Super) => regular(hinted),
            Some(AntialiasingChoice::Adaptive) => Ok(self.adaptive(hinted.or(endless))),
            Some(AntialiasingChoice::Filter) => self.filtered(hinted.or(endless)),
        }
    }

    /// Refuses options of one way against jagged edges where another one is chosen.
    fn check_filter(&self, named: Option<AntialiasingChoice>) -> Result<(), Failure> {
        let belongs = |option: &str, aa: &str| {
            Err(Failure::usage(format!(
                "{option} belongs to --aa {aa}; leave one of them out or add the other"
            )))
        };
        let is = |choice| named == Some(choice);
        if self.filter.is_some() && named.is_some() && !is(AntialiasingChoice::Filter) {
            return belongs("--filter", "filter");
        }
        if self.jitter.is_some() && !is(AntialiasingChoice::Jitter) {
            return belongs("--jitter", "jitter");
        }
        if self.aa_threshold.is_some() && !is(AntialiasingChoice::Adaptive) {
            return belongs("--aa-threshold", "adaptive");
        }
        if self.aa_level.is_some() && !is(AntialiasingChoice::Adaptive) {
            return belongs("--aa-level", "adaptive");
        }
        Ok(())
    }

    fn filtered(&self, samples: Option<u32>) -> Result<Antialiasing, Failure> {
        let name = self.filter.as_deref().unwrap_or("mitchell");
        let filter = PixelFilter::named(name, self.filter_radius).ok_or_else(|| {
            let known = "box, tent, gaussian, mitchell, blackman-harris";
            Failure::usage(format!("there is no filter \"{name}\"; there are: {known}"))
        })?;
        Ok(Antialiasing::Filtered { samples: samples.unwrap_or(FILTER_SAMPLES), filter })
    }

    fn adaptive(&self, passes: Option<u32>) -> Antialiasing {
        let standard = AdaptiveSettings::default();
        Antialiasing::Adaptive(AdaptiveSettings {
            threshold: self.aa_threshold.map_or(standard.threshold, |v| v as f32),
            max_level: self.aa_level.unwrap_or(standard.max_level),
            passes: passes.unwrap_or(standard.passes),
        })
    }
}

fn one_sample(name: &str, samples: Option<u32>, antialiasing: Antialiasing) -> Result<Antialiasing, Failure> {
    match samples {
        Some(n) if n > 1 => Err(Failure::usage(format!(
            "--aa {name} draws one sample a pixel; leave out --samples {n} or --aa {name}"
        ))),
        _ => Ok(antialiasing),
    }
}

fn regular(samples: Option<u32>) -> Result<Antialiasing, Failure> {
    let Some(samples) = samples else { return Ok(Antialiasing::Regular { per_side: SUPER_PER_SIDE }) };
    let per_side = samples.isqrt();
    if per_side * per_side == samples && (1..=64).contains(&per_side) {
        return Ok(Antialiasing::Regular { per_side });
    }
    Err(Failure::usage(format!(
        "--aa super draws n x n samples a pixel when rays are followed: 4, 9, 16 and so on up to 4096, not {samples}"
    )))
}

/// Shadow rays along a side of an area light: about 16 for a pixel, all its samples together.
fn soft_shadows_for(antialiasing: Antialiasing) -> u32 {
    (4.0 / f64::from(antialiasing.passes()).sqrt()).ceil().max(1.0) as u32
}

fn accel_of_hint(hint: AccelerationHint) -> Accel {
    match hint {
        AccelerationHint::None => Accel::None,
        AccelerationHint::Spheres => Accel::Spheres,
        AccelerationHint::Bounds => Accel::Bounds,
        AccelerationHint::Hierarchy => Accel::Hierarchy,
        AccelerationHint::Grid => Accel::Grid,
        AccelerationHint::Octree => Accel::Octree,
        AccelerationHint::Bvh => Accel::Bvh,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(
        arguments: &TracingArguments,
        aa: Option<AntialiasingChoice>,
        samples: Option<u32>,
    ) -> Result<Tracing, Failure> {
        arguments.settings(Method::Trace, aa, samples, None, 0, &RenderHints::default())
    }

    #[test]
    fn samples_choose_a_pattern() {
        let plain = TracingArguments::default();
        let of = |aa, samples| settings(&plain, aa, samples).map(|tracing| tracing.antialiasing);
        assert_eq!(of(None, None), Ok(Antialiasing::None));
        let random = Antialiasing::Filtered { samples: 12, filter: PixelFilter::Box };
        assert_eq!(of(None, Some(12)), Ok(random));
        assert_eq!(of(Some(AntialiasingChoice::Super), Some(9)), Ok(Antialiasing::Regular { per_side: 3 }));
        assert!(of(Some(AntialiasingChoice::Super), Some(8)).is_err());
        assert!(of(Some(AntialiasingChoice::None), Some(4)).is_err());
        let passes = Antialiasing::Adaptive(AdaptiveSettings { passes: 4, ..AdaptiveSettings::default() });
        assert_eq!(of(Some(AntialiasingChoice::Adaptive), Some(4)), Ok(passes));
    }

    #[test]
    fn soft_shadows_share_the_samples_of_a_pixel() {
        let plain = TracingArguments::default();
        let of = |samples| settings(&plain, None, samples).expect("settings").recursive.soft_shadows;
        assert_eq!((of(None), of(Some(4)), of(Some(16)), of(Some(256))), (4, 2, 1, 1));
    }

    #[test]
    fn options_go_with_their_method() {
        let shallow = TracingArguments { max_depth: Some(2), ..TracingArguments::default() };
        assert!(shallow.check(Method::Raster).is_err() && shallow.check(Method::Path).is_ok());
        let dark = TracingArguments { no_shadows: true, ..TracingArguments::default() };
        assert!(dark.check(Method::Path).is_err() && dark.check(Method::Trace).is_ok());
        let level = TracingArguments { aa_level: Some(2), ..TracingArguments::default() };
        assert!(settings(&level, None, None).is_err());
        assert!(settings(&level, Some(AntialiasingChoice::Adaptive), None).is_ok());
    }
}
