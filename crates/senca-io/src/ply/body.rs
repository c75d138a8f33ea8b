//! The numbers behind the header, text or binary.

use super::header::{Element, Encoding, Header, Kind};
use crate::text::Cursor;
use crate::{Location, ReadError};

/// The rows still to read.
pub(super) enum Body<'a> {
    Text(Cursor<'a>),
    Binary { name: &'a str, bytes: &'a [u8], pos: usize, big: bool },
}

impl<'a> Body<'a> {
    pub(super) fn new(name: &'a str, bytes: &'a [u8], header: &Header) -> Self {
        let mut cursor = Cursor::new(name, bytes);
        cursor.pos = header.end;
        match header.encoding {
            Encoding::Text => Self::Text(cursor),
            encoding => Self::Binary { name, bytes, pos: header.end, big: encoding == Encoding::BigEndian },
        }
    }

    /// How many rows of `element` the bytes left may hold at most.
    pub(super) fn rows_at_most(&self, element: &Element) -> u64 {
        let columns = element.properties.len().max(1);
        match self {
            Self::Text(cursor) => (cursor.rest().len() / (2 * columns) + 1) as u64,
            Self::Binary { bytes, pos, .. } => ((bytes.len() - pos) / element.smallest_row().max(1)) as u64,
        }
    }

    /// Refuses `element` at once if a binary file is too short for it.
    pub(super) fn check_promise(&self, element: &Element) -> Result<(), ReadError> {
        let most = self.rows_at_most(element);
        if let Self::Binary { name, bytes, .. } = self
            && most < element.count
        {
            let message = format!(
                "the header says {} rows of \"{}\", but the file has bytes for {most} at most",
                element.count, element.name
            );
            return Err(ReadError::malformed(Location::byte(name, bytes.len() as u64), message));
        }
        Ok(())
    }

    /// Goes to the beginning of a row and says where that is.
    pub(super) fn start_row(&mut self, element: &Element) -> Result<usize, ReadError> {
        if let Self::Text(cursor) = self
            && !cursor.start_line()
        {
            return Err(cursor.expected(&format!("a row of \"{}\"", element.name)));
        }
        Ok(self.pos())
    }

    /// Makes sure that the row ends here.
    pub(super) fn end_row(&mut self) -> Result<(), ReadError> {
        if let Self::Text(cursor) = self {
            cursor.skip_blanks();
            if !cursor.at_line_end() {
                return Err(cursor.expected("the end of the line"));
            }
        }
        Ok(())
    }

    /// Where the next number is.
    pub(super) fn pos(&mut self) -> usize {
        match self {
            Self::Text(cursor) => {
                cursor.skip_blanks();
                cursor.pos
            }
            Self::Binary { pos, .. } => *pos,
        }
    }

    /// An error at `pos`.
    #[cold]
    pub(super) fn malformed(&self, pos: usize, message: impl Into<String>) -> ReadError {
        match self {
            Self::Text(cursor) => cursor.malformed(pos, message),
            Self::Binary { name, .. } => ReadError::malformed(Location::byte(name, pos as u64), message),
        }
    }

    /// The next number, finite.
    #[inline]
    pub(super) fn number(&mut self, kind: Kind, what: &str) -> Result<f64, ReadError> {
        match self {
            Self::Text(cursor) => {
                // Text is rounded once, to the type that the header names.
                if kind == Kind::F32 { cursor.f32(what).map(f64::from) } else { cursor.f64(what) }
            }
            Self::Binary { bytes, pos, big, .. } => {
                let start = *pos;
                let Some(raw) = bytes.get(start..start + kind.size()) else {
                    return Err(self.too_short(what));
                };
                let value = decode(raw, kind, *big);
                *pos += kind.size();
                if value.is_finite() {
                    return Ok(value);
                }
                Err(self.malformed(start, format!("{what} is {value}, which is no finite number")))
            }
        }
    }

    #[cold]
    fn too_short(&self, what: &str) -> ReadError {
        let end = match self {
            Self::Text(cursor) => cursor.pos,
            Self::Binary { bytes, .. } => bytes.len(),
        };
        self.malformed(end, format!("the file ends where {what} should be"))
    }

    /// The length of a list.
    #[inline]
    pub(super) fn length(&mut self, kind: Kind, what: &str) -> Result<usize, ReadError> {
        let start = self.pos();
        let value = self.number(kind, what)?;
        if value < 0.0 || value.fract() != 0.0 || value > f64::from(u32::MAX) {
            return Err(
                self.malformed(start, format!("{what} must be a whole number of 0 or more, not {value}"))
            );
        }
        Ok(value as usize)
    }

    /// Passes over one property of a row.
    pub(super) fn skip(&mut self, kind: Kind, list: Option<Kind>, what: &str) -> Result<(), ReadError> {
        let count = match list {
            Some(list) => self.length(list, what)?,
            None => 1,
        };
        match self {
            Self::Text(cursor) => (0..count).try_for_each(|_| skip_word(cursor, what)),
            Self::Binary { bytes, pos, .. } => {
                let end = pos.saturating_add(count.saturating_mul(kind.size()));
                if end > bytes.len() {
                    return Err(self.too_short(what));
                }
                *pos = end;
                Ok(())
            }
        }
    }
}

fn skip_word(cursor: &mut Cursor<'_>, what: &str) -> Result<(), ReadError> {
    cursor.skip_blanks();
    if cursor.at_line_end() {
        return Err(cursor.expected(what));
    }
    cursor.word();
    Ok(())
}

/// A number of `kind` from its bytes.
#[inline]
fn decode(raw: &[u8], kind: Kind, big: bool) -> f64 {
    let mut bytes = [0u8; 8];
    let size = kind.size();
    bytes[..size].copy_from_slice(raw);
    if big {
        bytes[..size].reverse();
    }
    let word = u64::from_le_bytes(bytes);
    match kind {
        Kind::I8 => f64::from(word as u8 as i8),
        Kind::U8 => f64::from(word as u8),
        Kind::I16 => f64::from(word as u16 as i16),
        Kind::U16 => f64::from(word as u16),
        Kind::I32 => f64::from(word as u32 as i32),
        Kind::U32 => f64::from(word as u32),
        Kind::F32 => f64::from(f32::from_bits(word as u32)),
        Kind::F64 => f64::from_bits(word),
    }
}
