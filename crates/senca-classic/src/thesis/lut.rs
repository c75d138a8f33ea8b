//! Look-up tables: which colour a colour index shows (1991 thesis, section 8.3).

use senca_io::classic::IndexBitmap;
use senca_math::Hls;
use senca_window::Canvas;

use super::profile::Profile;

/// Colours of the EGA and VGA palette in the order in which the program loads them. Bits 5 to 0 are
/// the weak red, green and blue, worth 1, and the strong ones, worth 2: a ramp from black by blue and
/// cyan to near white, then yellow and red like a highlight.
pub const EGA_CODES: [u8; 16] = [0, 8, 1, 17, 41, 57, 9, 25, 11, 43, 59, 27, 31, 23, 54, 36];

/// A colour for each index, red, green and blue from 0 to 1 as the screen shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct Lut {
    /// By colour index.
    pub colors: Vec<[f64; 3]>,
}

/// In what the colours between two nodes of a profile are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorModel {
    /// Red, green and blue; the program's.
    #[default]
    Rgb,
    /// Hue, the shorter way around, lightness and saturation.
    Hls,
}

/// Why a palette does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PaletteError {
    /// The palette of EGA and VGA has 16 colours.
    #[error("{0} colours: this is not EGA or VGA, which has 16")]
    NotEga(u32),
    /// Greys need more than one bit plane.
    #[error("a monochrome device has no greys: {0} colours")]
    Monochrome(u32),
}

impl Lut {
    /// Greys from 0 in steps of 1/n, as on a VAX: the last is not quite white.
    ///
    /// # Errors
    /// [`PaletteError::Monochrome`] for two colours or less.
    pub fn greys(colors: u32) -> Result<Self, PaletteError> {
        if colors <= 2 {
            return Err(PaletteError::Monochrome(colors));
        }
        let grey = |index| [f64::from(index) / f64::from(colors); 3];
        Ok(Self { colors: (0..colors).map(grey).collect() })
    }

    /// The palette of a PC: [`EGA_CODES`].
    ///
    /// # Errors
    /// [`PaletteError::NotEga`] unless there are 16 colours.
    pub fn ega(colors: u32) -> Result<Self, PaletteError> {
        if colors != 16 {
            return Err(PaletteError::NotEga(colors));
        }
        Ok(Self {
            colors: EGA_CODES.map(|code| ega_levels(code).map(|level| f64::from(level) / 3.0)).to_vec(),
        })
    }

    /// Greys where there are any; black and white on a monochrome device.
    #[must_use]
    pub fn mono(colors: u32) -> Self {
        Self::greys(colors).unwrap_or_else(|_| Self { colors: vec![[0.0; 3], [1.0; 3]] })
    }

    /// The table of a profile.
    #[must_use]
    pub fn of_profile(profile: &Profile, colors: u32) -> Self {
        let mut lut = Self::mono(colors);
        lut.set_profile(profile);
        lut
    }

    /// The table of several profiles for a picture with so many ranges of indices (see
    /// [`Ranges`](super::Ranges)): range k has the colours of profile k, beginning again with the first when
    /// there are fewer. The background is the first one's. Indices behind the last range keep their greys.
    #[must_use]
    pub fn of_profiles(profiles: &[Profile], ranges: u32, colors: u32) -> Self {
        let mut lut = Self::mono(colors);
        let range = (colors.saturating_sub(1) / ranges.max(1)) as usize;
        let (Some(first), Some((background, indices))) = (profiles.first(), lut.colors.split_first_mut())
        else {
            return lut;
        };
        *background = first.background;
        let ranges = indices.chunks_exact_mut(range.max(1)).take(ranges as usize);
        for (colors, profile) in ranges.zip(profiles.iter().cycle()) {
            let last = colors.len() - 1;
            for (i, color) in colors.iter_mut().enumerate() {
                *color = profile.color(if last == 0 { 1.0 } else { i as f64 / last as f64 });
            }
        }
        lut
    }

    /// Sets all colours from a profile: index 0 is the background, index i shows the cosine
    /// `(i - 1) / (n - 2)`.
    pub fn set_profile(&mut self, profile: &Profile) {
        let last = self.colors.len().saturating_sub(2);
        for (index, color) in self.colors.iter_mut().enumerate() {
            *color = match index {
                0 => profile.background,
                _ if last == 0 => profile.color(1.0),
                _ => profile.color((index - 1) as f64 / last as f64),
            };
        }
    }

    /// Sets the colours as the listing does: for each pair of nodes from the index of the first, cut
    /// off, with that node's own colour, in steps of `1 / (n - 2)`. Indices that no pair reaches keep
    /// their colours.
    pub fn set_profile_as_printed(&mut self, profile: &Profile) {
        let last = self.colors.len().saturating_sub(2) as f64;
        if last < 1.0 {
            return;
        }
        if let Some(color) = self.colors.first_mut() {
            *color = profile.background;
        }
        for pair in profile.nodes.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let first = (from.x * last) as usize + 1;
            for (step, color) in self.colors.iter_mut().skip(first).enumerate() {
                let x = from.x + step as f64 / last;
                if x > to.x + 1e-5 {
                    break;
                }
                let t = (x - from.x) / (to.x - from.x);
                *color = std::array::from_fn(|i| from.rgb[i] + (to.rgb[i] - from.rgb[i]) * t);
            }
        }
    }

    /// The colour of an index as `0x00RRGGBB`; the last one's for indices beyond the table.
    #[must_use]
    pub fn pixel(&self, index: u32) -> u32 {
        let color = self.colors.get(index as usize).or(self.colors.last());
        color.map_or(0, |color| color.iter().fold(0, |pixel, &part| pixel << 8 | byte(part)))
    }
}

/// Levels 0 to 3 of red, green and blue.
fn ega_levels(code: u8) -> [u8; 3] {
    [2u8, 1, 0].map(|bit| 2 * (code >> bit & 1) + (code >> (bit + 3) & 1))
}

fn byte(part: f64) -> u32 {
    (part.clamp(0.0, 1.0) * 255.0).round() as u32
}

/// The colour between two, `t` from 0 to 1 of the way.
pub(super) fn between(model: ColorModel, from: [f64; 3], to: [f64; 3], t: f64) -> [f64; 3] {
    let mix = |a: f64, b: f64| a + (b - a) * t;
    if model == ColorModel::Rgb {
        return std::array::from_fn(|i| mix(from[i], to[i]));
    }
    let (mut a, mut b) = (Hls::from_rgb(from), Hls::from_rgb(to));
    // A grey has no hue of its own.
    if a.saturation == 0.0 {
        a.hue = b.hue;
    }
    if b.saturation == 0.0 {
        b.hue = a.hue;
    }
    let turn = (b.hue - a.hue + 180.0).rem_euclid(360.0) - 180.0;
    Hls::new(a.hue + turn * t, mix(a.lightness, b.lightness), mix(a.saturation, b.saturation)).to_rgb()
}

/// The picture of a bitmap in the colours of a table: nothing is rendered again.
#[must_use]
pub fn paint(bitmap: &IndexBitmap, lut: &Lut) -> Canvas {
    let (width, height) = (bitmap.width as usize, bitmap.height as usize);
    let mut canvas = Canvas::new(width, height);
    let colors: Vec<u32> = (0..lut.colors.len() as u32).map(|index| lut.pixel(index)).collect();
    let beyond = colors.last().copied().unwrap_or(0);
    let columns = bitmap.indices.chunks_exact(height.max(1)).take(width);
    for (x, column) in columns.enumerate() {
        for (y, &index) in column.iter().enumerate() {
            canvas.pixels_mut()[y * width + x] = colors.get(index as usize).copied().unwrap_or(beyond);
        }
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::super::profile::Node;
    use super::*;

    #[test]
    fn the_default_profile_gives_the_worked_table() {
        let greens = [
            0.1, 0.1643, 0.2286, 0.2929, 0.3571, 0.4214, 0.4857, 0.55, 0.6143, 0.6786, 0.7429, 0.8071,
            0.8714, 0.9357, 1.0,
        ];
        let mut printed = Lut::mono(16);
        printed.set_profile_as_printed(&Profile::default());
        for lut in [Lut::of_profile(&Profile::default(), 16), printed] {
            assert_eq!(lut.colors[0], [1.0; 3]);
            for (color, green) in lut.colors[1..].iter().zip(greens) {
                assert!(color[0] == 0.0 && color[2] == 0.0 && (color[1] - green).abs() < 5e-5, "{color:?}");
            }
        }
    }

    #[test]
    fn ranges_have_profiles_of_their_own() {
        let red = |x, red| Node { rgb: [red, 0.0, 0.0], x };
        let red = Profile {
            nodes: vec![red(0.0, 0.25), red(1.0, 0.75)],
            background: [0.5; 3],
            ..Profile::default()
        };
        let lut = Lut::of_profiles(&[Profile::default(), red.clone()], 3, 16);
        assert_eq!(lut.colors[0], [1.0; 3]);
        assert_eq!([1, 5, 6, 10, 11, 15].map(|i| lut.colors[i][0]), [0.0, 0.0, 0.25, 0.75, 0.0, 0.0]);
        assert_eq!([1, 5, 6, 10, 11, 15].map(|i| lut.colors[i][1]), [0.1, 1.0, 0.0, 0.0, 0.1, 1.0]);
        assert_eq!(lut.colors[8], [0.5, 0.0, 0.0]);
        assert_eq!(Lut::of_profiles(std::slice::from_ref(&red), 1, 16), Lut::of_profile(&red, 16));
        let beyond = Lut::of_profiles(&[red], 4, 16);
        assert_eq!(beyond.colors[13..], Lut::mono(16).colors[13..]);
        assert_eq!(Lut::of_profiles(&[], 2, 16), Lut::mono(16));
    }

    #[test]
    fn greys_stop_short_of_white() {
        let greys = Lut::greys(16).expect("greys");
        assert_eq!((greys.colors[0], greys.colors[15]), ([0.0; 3], [15.0 / 16.0; 3]));
        assert_eq!(Lut::greys(2), Err(PaletteError::Monochrome(2)));
        assert_eq!(Lut::mono(2).colors, [[0.0; 3], [1.0; 3]]);
    }

    #[test]
    fn the_ega_palette_is_a_ramp_with_a_highlight() {
        let levels = EGA_CODES.map(|code| ega_levels(code).iter().map(u8::to_string).collect::<String>());
        let expected = "000 001 002 012 103 113 003 013 023 123 133 033 233 232 330 300";
        assert_eq!(levels.join(" "), expected);
        assert_eq!(Lut::ega(16).expect("a palette").pixel(15), 0xff_0000);
        assert_eq!(Lut::ega(8), Err(PaletteError::NotEga(8)));
    }

    #[test]
    fn a_node_between_indices_is_met_exactly_by_the_text_only() {
        let node = |x, red| Node { rgb: [red, 0.0, 0.0], x };
        let profile =
            Profile { nodes: vec![node(0.0, 0.0), node(0.5, 1.0), node(1.0, 0.0)], ..Profile::default() };
        let text = Lut::of_profile(&profile, 5);
        let reds = |lut: &Lut| lut.colors[1..].iter().map(|c| (c[0] * 1e6).round() / 1e6).collect::<Vec<_>>();
        assert_eq!(reds(&text), [0.0, 0.666_667, 0.666_667, 0.0]);
        let mut printed = Lut::mono(5);
        printed.set_profile_as_printed(&profile);
        assert_eq!(reds(&printed), [0.0, 1.0, 0.333_333, 0.8], "the last keeps the grey it had");
    }

    #[test]
    fn hues_go_the_shorter_way() {
        let orange = between(ColorModel::Hls, [1.0, 0.0, 0.5], [1.0, 0.5, 0.0], 0.5);
        assert!((orange[0] - 1.0).abs() < 1e-12 && orange[1] < 1e-9 && orange[2] < 1e-9, "{orange:?}");
        assert_eq!(between(ColorModel::Rgb, [0.0; 3], [1.0, 0.5, 0.25], 0.5), [0.5, 0.25, 0.125]);
        let pale = between(ColorModel::Hls, [1.0; 3], [0.0, 0.0, 1.0], 0.5);
        assert!(pale[2] > pale[0] && (pale[0] - pale[1]).abs() < 1e-12, "{pale:?}");
    }

    #[test]
    fn pictures_are_painted_row_by_row() {
        let bitmap = IndexBitmap { width: 2, height: 3, indices: vec![0, 1, 2, 3, 2, 99] };
        let lut = Lut { colors: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]] };
        let canvas = paint(&bitmap, &lut);
        assert_eq!(canvas.pixels(), [0, 0xff, 0xff_0000, 0xff00, 0xff00, 0xff]);
    }
}
