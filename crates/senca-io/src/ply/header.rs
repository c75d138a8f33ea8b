//! The header: which elements follow, with which properties.

use crate::ReadError;
use crate::text::Cursor;

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of full intensity where the type holds a colour.
    pub(super) fn color_scale(self) -> Option<f64> {
        match self {
            Self::F32 | Self::F64 => None,
            Self::I8 | Self::U8 => Some(255.0),
            Self::I16 | Self::U16 => Some(65_535.0),
            Self::I32 | Self::U32 => Some(4_294_967_295.0),
        }
    }

    fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}

/// A column of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Type of the length, if this is a list.
    pub(super) list: Option<Kind>,
}

/// A table of the file.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// Place of the first property with one of these names.
    pub(super) fn find(&self, names: &[&str], list: bool) -> Option<usize> {
        self.properties.iter().position(|p| p.list.is_some() == list && names.contains(&p.name.as_str()))
    }

    /// Bytes that a row takes at least in a binary file.
    pub(super) fn smallest_row(&self) -> usize {
        self.properties.iter().map(|p| p.list.unwrap_or(p.kind).size()).sum()
    }
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the first row begins.
    pub(super) end: usize,
}

/// Reads up to `end_header`.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Header, ReadError> {
    let mut cursor = Cursor::new(name, bytes);
    if cursor.word() != b"ply" {
        return Err(cursor.malformed(0, "a PLY file begins with \"ply\""));
    }
    cursor.next_line();
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while cursor.start_line() {
        let start = cursor.pos;
        match cursor.word() {
            b"format" => encoding = Some(format(&mut cursor)?),
            b"element" => elements.push(element(&mut cursor)?),
            b"property" => {
                let property = property(&mut cursor)?;
                let Some(element) = elements.last_mut() else {
                    return Err(cursor.malformed(start, "a property needs an element before it"));
                };
                element.properties.push(property);
            }
            b"end_header" => {
                cursor.next_line();
                let Some(encoding) = encoding else {
                    return Err(cursor.malformed(start, "the header has no line \"format\""));
                };
                return Ok(Header { encoding, elements, end: cursor.pos });
            }
            b"comment" | b"obj_info" => {}
            _ => {
                cursor.pos = start;
                return Err(cursor.expected("\"element\", \"property\" or \"end_header\""));
            }
        }
        cursor.next_line();
    }
    Err(cursor.expected("\"end_header\""))
}

fn format(cursor: &mut Cursor<'_>) -> Result<Encoding, ReadError> {
    cursor.skip_blanks();
    let start = cursor.pos;
    let encoding = match cursor.word() {
        b"ascii" => Encoding::Text,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        _ => {
            cursor.pos = start;
            return Err(cursor.expected("\"ascii\", \"binary_little_endian\" or \"binary_big_endian\""));
        }
    };
    cursor.skip_blanks();
    let start = cursor.pos;
    if cursor.word() != b"1.0" {
        cursor.pos = start;
        return Err(cursor.expected("the version \"1.0\""));
    }
    Ok(encoding)
}

fn element(cursor: &mut Cursor<'_>) -> Result<Element, ReadError> {
    let name = name(cursor, "the element's name")?;
    cursor.skip_blanks();
    let count = cursor.count("the number of rows")? as u64;
    Ok(Element { name, count, properties: Vec::new() })
}

fn property(cursor: &mut Cursor<'_>) -> Result<Property, ReadError> {
    cursor.skip_blanks();
    let mut list = None;
    if cursor.rest().starts_with(b"list ") || cursor.rest().starts_with(b"list\t") {
        cursor.pos += 5;
        list = Some(kind(cursor)?);
    }
    let kind = kind(cursor)?;
    let name = name(cursor, "the property's name")?;
    Ok(Property { name, kind, list })
}

fn kind(cursor: &mut Cursor<'_>) -> Result<Kind, ReadError> {
    cursor.skip_blanks();
    let start = cursor.pos;
    if let Some(kind) = Kind::named(cursor.word()) {
        return Ok(kind);
    }
    cursor.pos = start;
    Err(cursor.expected("a type such as \"float\" or \"uchar\""))
}

fn name(cursor: &mut Cursor<'_>, what: &str) -> Result<String, ReadError> {
    cursor.skip_blanks();
    if cursor.at_line_end() {
        return Err(cursor.expected(what));
    }
    Ok(String::from_utf8_lossy(cursor.word()).into_owned())
}
