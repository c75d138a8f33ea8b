//! Values of options, read from their text.

use std::str::FromStr;
use std::time::Duration;

use senca::math::glam::DVec3;
use senca::math::{LinearRgb, Srgb8};
use senca::scene::Background;

/// Longest side of a picture, in pixels.
const MAX_SIDE: u32 = 65_404;

/// Most pixels of a picture: a square of 16384.
const MAX_PIXELS: u64 = 1 << 28;

/// Width and height of a picture in pixels, written `WxH`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once(['x', 'X']).ok_or("a size is written WxH, such as 1024x768")?;
        let size = Self { width: side(width, "width")?, height: side(height, "height")? };
        let pixels = u64::from(size.width) * u64::from(size.height);
        if pixels > MAX_PIXELS {
            return Err(format!(
                "that is {pixels} pixels; at most {MAX_PIXELS} are drawn, such as 16384x16384"
            ));
        }
        Ok(size)
    }
}

fn side(text: &str, what: &str) -> Result<u32, String> {
    let n: u64 =
        text.parse().map_err(|_| format!("the {what} \"{text}\" is not a whole number of pixels"))?;
    match u32::try_from(n) {
        Ok(0) => Err(format!("the {what} is 0; a picture has at least one pixel")),
        Ok(n) if n <= MAX_SIDE => Ok(n),
        _ => Err(format!("the {what} is {n}; at most {MAX_SIDE} pixels are drawn")),
    }
}

/// A rectangle of pixels, written `X,Y,W,H`, from the top left corner of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crop {
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[_, _, 0, _] | &[_, _, _, 0]) => Err("the cut-out is empty; W and H are at least 1".into()),
            Ok(&[x, y, width, height]) => Ok(Self { x, y, width, height }),
            _ => Err("a cut-out is four whole numbers X,Y,W,H, such as 100,50,320,240".into()),
        }
    }
}

impl Crop {
    /// Whether the rectangle lies within a picture of `size`.
    pub(crate) fn is_within(&self, size: Size) -> bool {
        let reaches =
            |from: u32, length: u32, all: u32| u64::from(from) + u64::from(length) <= u64::from(all);
        reaches(self.x, self.width, size.width) && reaches(self.y, self.height, size.height)
    }
}

/// Three numbers `X,Y,Z`.
pub(crate) fn triple(text: &str) -> Result<DVec3, String> {
    match numbers(text).as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("three numbers X,Y,Z are needed, such as 0,1.5,4".into()),
    }
}

/// Two counts `U,V`, each 1 to 1024; one count stands for both.
pub(crate) fn steps(text: &str) -> Result<[u32; 2], String> {
    let counts: Result<Vec<u32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
    let (u, v) = match counts.as_deref() {
        Ok(&[both]) => (both, both),
        Ok(&[u, v]) => (u, v),
        _ => return Err("steps are one or two whole numbers U,V, such as 8,8".into()),
    };
    let fits = |n: u32| (1..=1024).contains(&n);
    if fits(u) && fits(v) { Ok([u, v]) } else { Err("each step count lies between 1 and 1024".into()) }
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v.is_finite() && v > 0.0 => Ok(v),
        _ => Err("a number above 0 is needed".into()),
    }
}

/// A number from 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if (0.0..=1.0).contains(&v) => Ok(v),
        _ => Err("a number from 0 to 1 is needed".into()),
    }
}

/// A time with its unit: 30s, 1.5m, 2h.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || "a time is written with its unit, such as 30s, 5m or 1h".to_owned();
    let (number, unit) = text.split_at_checked(text.len().wrapping_sub(1)).ok_or_else(wrong)?;
    let seconds = match unit {
        "s" => 1.0,
        "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(wrong()),
    };
    let number: f64 = number.parse().map_err(|_| wrong())?;
    Duration::try_from_secs_f64(number * seconds).map_err(|_| wrong())
}

/// What `--time` says: a moment of the animation, or with a unit how long to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Time {
    /// Seconds of the animation.
    Moment(f64),
    /// How long to draw.
    Limit(Duration),
}

/// A number of seconds of the animation, or a time with its unit.
pub(crate) fn time(text: &str) -> Result<Time, String> {
    if text.ends_with(['s', 'm', 'h']) {
        return duration(text).map(Time::Limit);
    }
    let wrong = |_| "a moment is a number of seconds, at least 0; a limit has a unit, such as 30s".to_owned();
    not_negative(text).map(Time::Moment).map_err(wrong)
}

/// Column and row of a pixel, written `X,Y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pixel {
    pub(crate) x: u32,
    pub(crate) y: u32,
}

impl FromStr for Pixel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y]) => Ok(Self { x, y }),
            _ => Err("a pixel is two whole numbers X,Y, such as 320,240".into()),
        }
    }
}

/// Stops of exposure, within +-64.
pub(crate) fn stops(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v.abs() <= 64.0 => Ok(v),
        _ => Err("a number from -64 to 64 is needed".into()),
    }
}

/// A number that is not negative.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v.is_finite() && v >= 0.0 => Ok(v),
        _ => Err("a number of at least 0 is needed".into()),
    }
}

/// An angle of view in degrees, between 0 and 180.
pub(crate) fn view_angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if v > 0.0 && v < 180.0 => Ok(v),
        _ => Err("an angle between 0 and 180 degrees is needed".into()),
    }
}

impl From<Crop> for senca::pipeline::Crop {
    fn from(Crop { x, y, width, height }: Crop) -> Self {
        Self { x, y, width, height }
    }
}

/// What is seen where nothing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BackgroundChoice {
    /// Alpha 0.
    Transparent,
    /// One colour.
    Color(LinearRgb),
}

impl FromStr for BackgroundChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "none" | "transparent" => Ok(Self::Transparent),
            "white" => Ok(Self::Color(LinearRgb::WHITE)),
            "black" => Ok(Self::Color(LinearRgb::BLACK)),
            _ => color(text).map(Self::Color),
        }
    }
}

impl From<BackgroundChoice> for Background {
    fn from(choice: BackgroundChoice) -> Self {
        match choice {
            BackgroundChoice::Transparent => Self::None,
            BackgroundChoice::Color(color) => Self::Color(color),
        }
    }
}

/// A colour: `#rrggbb` as on displays, or three linear numbers `R,G,B`.
fn color(text: &str) -> Result<LinearRgb, String> {
    let wrong = || "a colour is #rrggbb, three linear numbers R,G,B, white, black or none".to_owned();
    if let Some(hex) = text.strip_prefix('#') {
        let is_hex = hex.len() == 6 && hex.bytes().all(|b| b.is_ascii_hexdigit());
        let value = is_hex.then(|| u32::from_str_radix(hex, 16).ok()).flatten().ok_or_else(wrong)?;
        let [_, r, g, b] = value.to_be_bytes();
        return Ok(Srgb8 { r, g, b }.to_linear());
    }
    match numbers(text).as_deref() {
        Some(&[r, g, b]) if r.min(g).min(b) >= 0.0 => Ok(LinearRgb::new(r as f32, g as f32, b as f32)),
        _ => Err(wrong()),
    }
}

/// Finite numbers separated by commas; `None` when one is not.
fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(',').map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_moments_or_limits_by_their_unit() {
        assert_eq!(time("1.5"), Ok(Time::Moment(1.5)));
        assert_eq!(time("30s"), Ok(Time::Limit(Duration::from_secs(30))));
        assert_eq!(duration("1.5m"), Ok(Duration::from_secs(90)));
        for wrong in ["", "s", "30", "-1s", "nans", "1e99h", "5d", "ä"] {
            assert!(duration(wrong).is_err(), "{wrong}");
        }
        assert!(time("-1").is_err());
        assert_eq!("3, 4".parse(), Ok(Pixel { x: 3, y: 4 }));
        assert!("3".parse::<Pixel>().is_err() && share("1.5").is_err());
    }

    #[test]
    fn sizes_are_read_and_refused_with_a_reason() {
        assert_eq!("1024x768".parse(), Ok(Size { width: 1024, height: 768 }));
        assert_eq!("1X65404".parse(), Ok(Size { width: 1, height: 65404 }));
        for (text, part) in [
            ("0x5", "the width is 0"),
            ("5x0", "the height is 0"),
            ("5", "written WxH"),
            ("5x", "not a whole number"),
            ("-5x5", "not a whole number"),
            ("65405x1", "at most 65404"),
            ("99999999999x1", "at most 65404"),
            ("16385x16384", "at most 268435456"),
        ] {
            let message = text.parse::<Size>().expect_err(text);
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    #[test]
    fn cut_outs_must_lie_inside() {
        let size = Size { width: 100, height: 50 };
        let crop: Crop = "10, 20,90,30".parse().expect("a cut-out");
        assert!(crop.is_within(size));
        assert!(!Crop { width: 91, ..crop }.is_within(size));
        assert!(!Crop { y: u32::MAX, ..crop }.is_within(size));
        assert!("1,2,3".parse::<Crop>().is_err() && "1,2,0,4".parse::<Crop>().is_err());
    }

    #[test]
    fn colours_are_hexadecimal_or_linear() {
        assert_eq!("#ff0000".parse(), Ok(BackgroundChoice::Color(LinearRgb::new(1.0, 0.0, 0.0))));
        assert_eq!("0,0.5,2".parse(), Ok(BackgroundChoice::Color(LinearRgb::new(0.0, 0.5, 2.0))));
        assert_eq!("none".parse(), Ok(BackgroundChoice::Transparent));
        for text in ["#ff00", "#gg0000", "#+f0000", "1,2", "a,b,c", "nan,0,0", "-1,0,0", ""] {
            assert!(text.parse::<BackgroundChoice>().is_err(), "{text}");
        }
    }

    #[test]
    fn steps_are_one_or_two_counts() {
        assert_eq!(steps("8"), Ok([8, 8]));
        assert_eq!(steps("4,6"), Ok([4, 6]));
        assert!(steps("0,4").is_err() && steps("1,2,3").is_err() && steps("2000").is_err());
    }
}
