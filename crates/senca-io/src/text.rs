//! Scanning of text formats: lines, words and numbers straight from the bytes.
//!
//! 1. Nothing is copied and no line is counted on the way; the line and column of an error are
//!    found when there is one, by counting from the start.
//! 2. A number of at most 19 digits becomes an integer mantissa and a power of ten. Where both are
//!    exact in `f64` (mantissa up to 2^53, power up to 10^22) one multiplication or division rounds
//!    correctly (Clinger 1990, fast path); everything else goes to the standard library.
//! 3. An `f32` is rounded from that `f64`. Rounding twice goes wrong only when the `f64` lies exactly
//!    between two `f32`, which its low 29 bits show; those go to the standard library too.

use memchr::memchr2;

use crate::{Location, ReadError};

/// Powers of ten that `f64` holds exactly.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// A place in the bytes of a text file, with the file's name for messages.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    name: &'a str,
    bytes: &'a [u8],
    /// Offset of the next byte to read.
    pub(crate) pos: usize,
    /// Whether a backslash at the end of a line joins it with the next.
    continuation: bool,
}

/// A decimal number as written: sign, digits without the point, power of ten.
struct Decimal {
    negative: bool,
    mantissa: u64,
    exponent: i32,
    /// Whether `mantissa` holds all digits.
    whole: bool,
    end: usize,
}

impl<'a> Cursor<'a> {
    /// The beginning of `bytes`.
    pub(crate) fn new(name: &'a str, bytes: &'a [u8]) -> Self {
        let pos = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { name, bytes, pos, continuation: false }
    }

    /// The beginning of `bytes`, where a backslash before the line's end joins two lines.
    pub(crate) fn with_continuation(name: &'a str, bytes: &'a [u8]) -> Self {
        Self { continuation: true, ..Self::new(name, bytes) }
    }

    /// The next byte.
    #[inline]
    pub(crate) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.pos).copied()
    }

    /// The bytes still to read.
    #[inline]
    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.pos.min(self.bytes.len())..]
    }

    /// Skips blanks, and line ends behind a backslash where those join lines.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) {
        loop {
            match self.peek() {
                Some(b' ' | b'\t') => self.pos += 1,
                Some(b'\\') if self.continuation && self.skip_joint() => {}
                _ => return,
            }
        }
    }

    /// Skips a backslash and the line end behind it, if that is what comes.
    #[cold]
    fn skip_joint(&mut self) -> bool {
        let rest = &self.rest()[1..];
        let blanks = rest.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
        let length = match &rest[blanks..] {
            [b'\r', b'\n', ..] => 3,
            [b'\n' | b'\r', ..] => 2,
            [] => 1,
            _ => return false,
        };
        self.pos += blanks + length;
        true
    }

    /// Whether the line ends here, but for blanks that were skipped before.
    #[inline]
    pub(crate) fn at_line_end(&self) -> bool {
        matches!(self.peek(), None | Some(b'\n' | b'\r'))
    }

    /// Whether nothing is left.
    pub(crate) fn at_end(&self) -> bool {
        self.pos >= self.bytes.len()
    }

    /// Goes to the first byte that is neither blank nor line end; false at the end of the file.
    #[inline]
    pub(crate) fn start_line(&mut self) -> bool {
        loop {
            self.skip_blanks();
            match self.peek() {
                Some(b'\n' | b'\r') => self.pos += 1,
                next => return next.is_some(),
            }
        }
    }

    /// Goes behind the end of this line.
    #[inline]
    pub(crate) fn next_line(&mut self) {
        while !self.at_line_end() {
            self.skip_to_line_end();
        }
        let pair = self.rest().starts_with(b"\r\n");
        self.pos = (self.pos + 1 + usize::from(pair)).min(self.bytes.len());
    }

    /// Goes to the end of this line, over joints.
    fn skip_to_line_end(&mut self) {
        self.pos = memchr2(b'\n', b'\r', self.rest()).map_or(self.bytes.len(), |n| self.pos + n);
        let joined = self.continuation && self.pos > 0 && self.bytes[self.pos - 1] == b'\\';
        if joined && !self.at_end() {
            self.pos += 1 + usize::from(self.rest().starts_with(b"\r\n"));
        }
    }

    /// The word that begins here: everything up to a blank or the line's end.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        let start = self.pos;
        while !matches!(self.peek(), None | Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.pos += 1;
        }
        &self.bytes[start..self.pos]
    }

    /// The rest of the line without blanks around it, joints replaced by one blank.
    pub(crate) fn rest_of_line(&mut self) -> String {
        self.skip_blanks();
        let start = self.pos;
        while !self.at_line_end() {
            self.skip_to_line_end();
        }
        let text = String::from_utf8_lossy(&self.bytes[start..self.pos]);
        if self.continuation && text.contains('\\') {
            return text.replace("\\\r\n", " ").replace("\\\n", " ").trim().to_owned();
        }
        text.trim().to_owned()
    }

    /// A number that `f64` can hold; blanks before it are skipped. `what` names it in messages.
    pub(crate) fn f64(&mut self, what: &str) -> Result<f64, ReadError> {
        let (start, decimal) = self.decimal(what)?;
        let value = match fast_f64(&decimal) {
            Some(value) => value,
            None => self.parse_slowly(start, decimal.end),
        };
        self.accept(start, &decimal, value, value.is_finite())
    }

    /// A number that `f32` can hold; blanks before it are skipped. `what` names it in messages.
    #[inline]
    pub(crate) fn f32(&mut self, what: &str) -> Result<f32, ReadError> {
        let (start, decimal) = self.decimal(what)?;
        let value = match fast_f32(&decimal) {
            Some(value) => value,
            None => self.parse_slowly(start, decimal.end),
        };
        self.accept(start, &decimal, value, value.is_finite())
    }

    #[inline]
    fn accept<T>(&mut self, start: usize, decimal: &Decimal, value: T, finite: bool) -> Result<T, ReadError> {
        if !finite {
            let message = format!("the number {} is too large", self.shown(start));
            return Err(self.malformed(start, message));
        }
        self.pos = decimal.end;
        Ok(value)
    }

    #[inline]
    fn decimal(&mut self, what: &str) -> Result<(usize, Decimal), ReadError> {
        self.skip_blanks();
        let start = self.pos;
        match scan_decimal(self.bytes, start) {
            Some(decimal) if self.separates(decimal.end) => Ok((start, decimal)),
            _ => Err(self.expected(what)),
        }
    }

    #[cold]
    fn parse_slowly<T: std::str::FromStr + Default>(&self, start: usize, end: usize) -> T {
        let text = std::str::from_utf8(&self.bytes[start..end]).unwrap_or_default();
        text.parse().unwrap_or_default()
    }

    /// A whole number, with sign if it likes; blanks before it are skipped.
    #[inline]
    pub(crate) fn integer(&mut self, what: &str) -> Result<i64, ReadError> {
        self.skip_blanks();
        let start = self.pos;
        let Some(value) = self.index() else { return Err(self.expected(what)) };
        if !self.separates(self.pos) {
            self.pos = start;
            return Err(self.expected(what));
        }
        Ok(value)
    }

    /// A whole number of 0 or more that `usize` holds.
    pub(crate) fn count(&mut self, what: &str) -> Result<usize, ReadError> {
        self.skip_blanks();
        let start = self.pos;
        let value = self.integer(what)?;
        usize::try_from(value).map_err(|_| self.malformed(start, format!("{what} must not be negative")))
    }

    /// A whole number right here, whatever follows; `None` leaves the place. Values beyond 18 digits
    /// are cut off at 10^18.
    #[inline]
    pub(crate) fn index(&mut self) -> Option<i64> {
        let sign = self.peek();
        let mut pos = self.pos + usize::from(matches!(sign, Some(b'-' | b'+')));
        let first = pos;
        let mut value = 0u64;
        while let Some(digit) = self.bytes.get(pos).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
            value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
            pos += 1;
        }
        if pos == first {
            return None;
        }
        if pos - first > 18 {
            value = 1_000_000_000_000_000_000;
        }
        self.pos = pos;
        Some(if sign == Some(b'-') { -(value as i64) } else { value as i64 })
    }

    /// Whether a number may end before the byte at `pos`.
    #[inline]
    fn separates(&self, pos: usize) -> bool {
        match self.bytes.get(pos) {
            None | Some(b' ' | b'\n' | b'\r' | b'\t') => true,
            Some(b'#' | b',' | b'{') => true,
            Some(b'\\') => self.continuation,
            _ => false,
        }
    }

    /// Whether a number comes next on this line, after blanks that are skipped.
    #[inline]
    pub(crate) fn number_follows(&mut self) -> bool {
        self.skip_blanks();
        matches!(self.peek(), Some(b'0'..=b'9' | b'+' | b'-' | b'.'))
    }

    /// Line and column of the byte at `pos`.
    #[cold]
    pub(crate) fn location(&self, pos: usize) -> Location {
        let before = &self.bytes[..pos.min(self.bytes.len())];
        let is_end = |i: usize| match before[i] {
            b'\n' => true,
            b'\r' => self.bytes.get(i + 1) != Some(&b'\n'),
            _ => false,
        };
        let lines = (0..before.len()).filter(|&i| is_end(i)).count();
        let start = (0..before.len()).rev().find(|&i| is_end(i)).map_or(0, |i| i + 1);
        let start = if start == 0 && before.starts_with(b"\xef\xbb\xbf") { 3 } else { start };
        let column = before[start..].iter().filter(|&&b| b & 0xc0 != 0x80).count();
        Location::text(self.name, saturating_u32(lines + 1), saturating_u32(column + 1))
    }

    /// A breach of the format at the byte `pos`.
    #[cold]
    pub(crate) fn malformed(&self, pos: usize, message: impl Into<String>) -> ReadError {
        ReadError::malformed(self.location(pos), message)
    }

    /// The error that `what` should be here and is not.
    #[cold]
    pub(crate) fn expected(&self, what: &str) -> ReadError {
        self.malformed(self.pos, format!("expected {what}, found {}", self.shown(self.pos)))
    }

    /// What stands at `pos`, for messages.
    #[cold]
    pub(crate) fn shown(&self, pos: usize) -> String {
        let rest = &self.bytes[pos.min(self.bytes.len())..];
        if rest.is_empty() {
            return "the end of the file".to_owned();
        }
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        if length == 0 {
            return "the end of the line".to_owned();
        }
        let word: String = String::from_utf8_lossy(&rest[..length.min(120)]).chars().take(30).collect();
        format!("\"{}\"", word.escape_debug())
    }
}

fn saturating_u32(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// The number at `start`, if there is one.
#[inline]
fn scan_decimal(bytes: &[u8], start: usize) -> Option<Decimal> {
    let mut pos = start;
    let negative = bytes.get(pos) == Some(&b'-');
    pos += usize::from(negative || bytes.get(pos) == Some(&b'+'));
    let mut mantissa = 0u64;
    let digits_before = scan_digits(bytes, &mut pos, &mut mantissa);
    let mut digits_after = 0;
    if bytes.get(pos) == Some(&b'.') {
        pos += 1;
        digits_after = scan_digits(bytes, &mut pos, &mut mantissa);
    }
    let digits = digits_before + digits_after;
    if digits == 0 {
        return None;
    }
    let mut exponent = -i32::try_from(digits_after).unwrap_or(i32::MAX);
    if let Some(b'e' | b'E') = bytes.get(pos) {
        exponent = exponent.saturating_add(scan_exponent(bytes, &mut pos)?);
    }
    Some(Decimal { negative, mantissa, exponent, whole: digits <= 19, end: pos })
}

/// Reads digits into `mantissa` and returns how many there were.
#[inline]
fn scan_digits(bytes: &[u8], pos: &mut usize, mantissa: &mut u64) -> usize {
    let first = *pos;
    while let Some(digit) = bytes.get(*pos).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        *pos += 1;
    }
    *pos - first
}

/// Reads the `e` at `pos` and what follows; `None` if no digit does.
#[inline]
fn scan_exponent(bytes: &[u8], pos: &mut usize) -> Option<i32> {
    *pos += 1;
    let negative = bytes.get(*pos) == Some(&b'-');
    *pos += usize::from(negative || bytes.get(*pos) == Some(&b'+'));
    let mut value = 0u64;
    let digits = scan_digits(bytes, pos, &mut value);
    let value = if digits > 9 { 999_999_999 } else { value as i32 };
    (digits > 0).then_some(if negative { -value } else { value })
}

/// The number, if `f64` arithmetic rounds it correctly.
#[inline]
fn fast_f64(decimal: &Decimal) -> Option<f64> {
    let power = *POWERS_OF_TEN.get(decimal.exponent.unsigned_abs() as usize)?;
    if !decimal.whole || decimal.mantissa > 1 << 53 {
        return None;
    }
    let mantissa = decimal.mantissa as f64;
    let value = if decimal.exponent < 0 { mantissa / power } else { mantissa * power };
    Some(if decimal.negative { -value } else { value })
}

/// The number, if rounding twice cannot go wrong.
#[inline]
fn fast_f32(decimal: &Decimal) -> Option<f32> {
    let value = fast_f64(decimal)?;
    let halfway = value.to_bits() & 0x1fff_ffff == 0x1000_0000;
    let normal = value.abs() >= f64::from(f32::MIN_POSITIVE) || value == 0.0;
    (normal && !halfway).then_some(value as f32)
}

#[cfg(test)]
mod tests;
