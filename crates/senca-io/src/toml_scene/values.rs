//! Single values: numbers with their ranges, vectors, colours, choices.

use senca_math::glam::{DVec2, DVec3};
use senca_math::{LinearRgb, Srgb8};
use toml::Spanned;
use toml::de::DeValue;

use super::names::{nearest, quoted_list};
use super::source::{Result, Source, Span, Table, kind_of};
use crate::ReadError;

/// Largest magnitude of a number. Everything that a scene is made of fits `f32` with room for
/// products.
const LARGEST: f64 = 1e30;

/// A value with its place and the key it stands under.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    pub(super) source: Source<'a>,
    key: &'a str,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Value<'a> {
    pub(super) fn new(source: Source<'a>, key: &'a str, value: &'a Spanned<DeValue<'a>>) -> Self {
        Self { source, key, value }
    }

    pub(super) fn span(&self) -> Span {
        self.value.span()
    }

    /// An error at this value.
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        self.source.error(&self.span(), message)
    }

    /// An error about the character at `column` (from 1) of this string: at its place in the text
    /// where the string stands there as it is, else at the string.
    pub(super) fn error_within(&self, column: usize, error: &dyn std::fmt::Display) -> ReadError {
        let span = self.span();
        let content = self.as_str().unwrap_or_default();
        let raw = self.source.text.get(span.clone()).unwrap_or_default();
        let before = content.char_indices().nth(column - 1).map_or(content.len(), |(at, _)| at);
        let at = raw.find(content).map_or(span.start, |start| span.start + start + before);
        self.source.error(&(at..at), format!("\"{}\": {error}", self.key))
    }

    /// An error at this value that begins with its key: `"radius" must be ...`.
    pub(super) fn refuse(&self, predicate: impl std::fmt::Display) -> ReadError {
        self.error(format!("\"{}\" {predicate}", self.key))
    }

    fn wrong_kind(&self, wanted: &str) -> ReadError {
        self.refuse(format_args!("should be {wanted}, but is {}", kind_of(self.value.get_ref())))
    }

    pub(super) fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    pub(super) fn is_list(&self) -> bool {
        self.value.get_ref().is_array()
    }

    pub(super) fn is_number(&self) -> bool {
        matches!(self.value.get_ref(), DeValue::Integer(_) | DeValue::Float(_))
    }

    /// The string, if it is one.
    pub(super) fn as_str(&self) -> Option<&'a str> {
        match self.value.get_ref() {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    pub(super) fn as_table(&self) -> Option<&'a toml::de::DeTable<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        }
    }

    pub(super) fn string(self) -> Result<&'a str> {
        self.as_str().ok_or_else(|| self.wrong_kind("a string"))
    }

    pub(super) fn boolean(self) -> Result<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.wrong_kind("true or false")),
        }
    }

    /// The value as a table called `what` in messages.
    pub(super) fn table(self, what: impl Into<String>) -> Result<Table<'a>> {
        match self.as_table() {
            Some(table) => Ok(Table::new(self.source, table, self.span(), what)),
            None => Err(self.wrong_kind("a table")),
        }
    }

    /// A finite number.
    pub(super) fn number(self) -> Result<f64> {
        let number = match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse().unwrap_or(f64::NAN),
            DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(integer) => integer as f64,
                Err(_) => f64::INFINITY,
            },
            _ => return Err(self.wrong_kind("a number")),
        };
        if !number.is_finite() {
            return Err(self.refuse("must be a finite number"));
        }
        if number.abs() > LARGEST {
            return Err(
                self.refuse(format_args!("must be between -{LARGEST:e} and {LARGEST:e}, but is {number:e}"))
            );
        }
        Ok(number)
    }

    /// A number above 0.
    pub(super) fn positive(self) -> Result<f64> {
        let number = self.number()?;
        // Also as f32, which meshes and materials are made of.
        if number as f32 > 0.0 {
            Ok(number)
        } else {
            Err(self.refuse(format_args!("must be greater than 0, but is {number}")))
        }
    }

    /// A number of at least 0.
    pub(super) fn not_negative(self) -> Result<f64> {
        let number = self.number()?;
        if number >= 0.0 {
            Ok(number)
        } else {
            Err(self.refuse(format_args!("must not be negative, but is {number}")))
        }
    }

    /// A number in [0, 1].
    pub(super) fn share(self) -> Result<f64> {
        self.within(0.0, 1.0)
    }

    /// A number in [low, high].
    pub(super) fn within(self, low: f64, high: f64) -> Result<f64> {
        let number = self.number()?;
        if (low..=high).contains(&number) {
            Ok(number)
        } else {
            Err(self.refuse(format_args!("must be between {low} and {high}, but is {number}")))
        }
    }

    /// An angle in degrees above `low` and at most `high`, returned in radians.
    pub(super) fn angle(self, low: f64, high: f64) -> Result<f64> {
        let degrees = self.number()?;
        if degrees > low && degrees <= high {
            Ok(degrees.to_radians())
        } else {
            let range = format!("must be an angle above {low} and at most {high} degrees");
            Err(self.refuse(format_args!("{range}, but is {degrees}")))
        }
    }

    /// A whole number in [low, high].
    pub(super) fn whole(self, low: u32, high: u32) -> Result<u32> {
        let DeValue::Integer(integer) = self.value.get_ref() else {
            return Err(self.wrong_kind("a whole number"));
        };
        let number = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
        number.and_then(|n| u32::try_from(n).ok()).filter(|n| (low..=high).contains(n)).ok_or_else(|| {
            self.refuse(format_args!("must be a whole number from {low} to {high}, but is {integer}"))
        })
    }

    /// Index of one of `count` things called `what`.
    pub(super) fn index(self, count: usize, what: &str) -> Result<u32> {
        let index = self.whole(0, u32::MAX)?;
        if (index as usize) < count {
            Ok(index)
        } else {
            let message = format!("names {what} {index}, but there are only {count}, counted from 0");
            Err(self.refuse(message))
        }
    }

    /// The entries of a list; `wanted` tells in a message what should be here.
    pub(super) fn items(self, wanted: &str) -> Result<impl ExactSizeIterator<Item = Value<'a>> + use<'a>> {
        match self.value.get_ref() {
            DeValue::Array(list) => Ok(list.iter().map(move |item| Value::new(self.source, self.key, item))),
            _ => Err(self.wrong_kind(wanted)),
        }
    }

    /// A list, each entry through `read`.
    pub(super) fn list<T>(self, wanted: &str, read: impl FnMut(Value<'a>) -> Result<T>) -> Result<Vec<T>> {
        self.items(wanted)?.map(read).collect()
    }

    /// A list of exactly `N` entries, each through `read`.
    pub(super) fn array<T: Copy + Default, const N: usize>(
        self,
        wanted: &str,
        mut read: impl FnMut(Value<'a>) -> Result<T>,
    ) -> Result<[T; N]> {
        let items = self.items(wanted)?;
        if items.len() != N {
            return Err(self.refuse(format_args!("should be {wanted}, but has {} entries", items.len())));
        }
        let mut array = [T::default(); N];
        for (slot, item) in array.iter_mut().zip(items) {
            *slot = read(item)?;
        }
        Ok(array)
    }

    /// `[x, y]`.
    pub(super) fn vec2(self) -> Result<DVec2> {
        Ok(DVec2::from_array(self.array("a list of two numbers", Self::number)?))
    }

    /// `[x, y, z]`.
    pub(super) fn vec3(self) -> Result<DVec3> {
        Ok(DVec3::from_array(self.array("a list of three numbers", Self::number)?))
    }

    /// `[x, y, z]`, not all 0; returned with unit length.
    pub(super) fn direction(self) -> Result<DVec3> {
        let v = self.vec3()?;
        // Scaled first, so that neither tiny nor huge components are lost in the square.
        let largest = v.abs().max_element();
        if largest > 0.0 {
            Ok((v / largest).normalize())
        } else {
            Err(self.refuse("is a direction and must not be zero"))
        }
    }

    /// One number for all axes or one for each, all above 0.
    pub(super) fn sizes(self) -> Result<DVec3> {
        if self.is_number() {
            return Ok(DVec3::splat(self.positive()?));
        }
        let wanted = "a number or a list of three numbers";
        Ok(DVec3::from_array(self.array(wanted, Self::positive)?))
    }

    /// One of several words.
    pub(super) fn choice<T: Copy>(self, choices: &[(&'static str, T)]) -> Result<T> {
        let word = self.string()?;
        if let Some((_, choice)) = choices.iter().find(|(name, _)| *name == word) {
            return Ok(*choice);
        }
        let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
        let hint = nearest(word, names.iter().copied());
        let hint = hint.map(|name| format!(" - did you mean \"{name}\"?")).unwrap_or_default();
        Err(self.refuse(format_args!("cannot be \"{word}\"{hint} It can be {}", quoted_list(&names))))
    }

    /// Light: a number (grey), `[r, g, b]` (linear), `"#rrggbb"` or a name (both sRGB); at least 0.
    pub(super) fn color(self) -> Result<LinearRgb> {
        if self.is_number() {
            return Ok(LinearRgb::splat(self.not_negative()? as f32));
        }
        if let Some(text) = self.as_str() {
            return match srgb_of(text) {
                Some(srgb) => Ok(srgb.to_linear()),
                None => Err(self.unknown_color(text)),
            };
        }
        let wanted = "a colour: [r, g, b], a number for grey, \"#rrggbb\" or a name";
        Ok(LinearRgb::from_array(self.array(wanted, |v| Ok(v.not_negative()? as f32))?))
    }

    /// A colour with all components in [0, 1].
    pub(super) fn reflectance(self) -> Result<LinearRgb> {
        let color = self.color()?;
        if color.max_component() <= 1.0 {
            Ok(color)
        } else {
            let largest = color.max_component();
            Err(self.refuse(format_args!(
                "is a share of light, so each part must be in [0, 1], but one is {largest}"
            )))
        }
    }

    fn unknown_color(&self, text: &str) -> ReadError {
        if text.starts_with('#') {
            return self.refuse(format_args!(
                "cannot be \"{text}\"; a colour with # has three or six hexadecimal digits"
            ));
        }
        let names: Vec<&str> = NAMED_COLORS.iter().map(|(name, _)| *name).collect();
        let hint = nearest(text, names.iter().copied());
        let hint = hint.map(|name| format!("; did you mean \"{name}\"?")).unwrap_or_else(|| ".".to_owned());
        self.refuse(format_args!(
            "names the unknown colour \"{text}\"{hint} Known are {}",
            quoted_list(&names)
        ))
    }
}

/// The colours with names, as in CSS, except that "green" is the full one.
const NAMED_COLORS: [(&str, u32); 16] = [
    ("black", 0x00_0000),
    ("white", 0xff_ffff),
    ("gray", 0x80_8080),
    ("grey", 0x80_8080),
    ("silver", 0xc0_c0c0),
    ("red", 0xff_0000),
    ("green", 0x00_ff00),
    ("blue", 0x00_00ff),
    ("yellow", 0xff_ff00),
    ("cyan", 0x00_ffff),
    ("magenta", 0xff_00ff),
    ("orange", 0xff_a500),
    ("purple", 0x80_0080),
    ("brown", 0xa5_2a2a),
    ("pink", 0xff_c0cb),
    ("skyblue", 0x87_ceeb),
];

/// The colour of `#rgb`, `#rrggbb` or a name.
fn srgb_of(text: &str) -> Option<Srgb8> {
    let Some(digits) = text.strip_prefix('#') else {
        return NAMED_COLORS.iter().find(|(name, _)| *name == text).map(|&(_, code)| srgb_of_code(code));
    };
    if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let code = u32::from_str_radix(digits, 16).ok()?;
    match digits.len() {
        6 => Some(srgb_of_code(code)),
        3 => {
            let nibble = |shift: u32| ((code >> shift & 15) * 17) as u8;
            Some(Srgb8 { r: nibble(8), g: nibble(4), b: nibble(0) })
        }
        _ => None,
    }
}

fn srgb_of_code(code: u32) -> Srgb8 {
    Srgb8 { r: (code >> 16) as u8, g: (code >> 8) as u8, b: code as u8 }
}
