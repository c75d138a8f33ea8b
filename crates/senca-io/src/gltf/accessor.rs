//! Accessors: typed arrays in buffers (glTF 2.0, section 3.6.2).
//!
//! An accessor is opened once, with all its bounds checked, and then gives any of its elements
//! without failing. Normalised integers become floats by the equations of section 3.6.2.2; elements
//! that a sparse part replaces are found by binary search, so that nothing is copied beforehand.

use super::document::Document;
use super::json;
use super::json::Whole;
use crate::{Location, ReadError};

/// Types of components, by their numbers in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    pub(super) const fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// Rows and columns of an element; columns begin at multiples of four bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    rows: usize,
    columns: usize,
}

impl Shape {
    fn from_name(name: &str) -> Option<Self> {
        let (rows, columns) = match name {
            "SCALAR" => (1, 1),
            "VEC2" => (2, 1),
            "VEC3" => (3, 1),
            "VEC4" => (4, 1),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            _ => return None,
        };
        Some(Self { rows, columns })
    }

    /// Bytes from one column to the next.
    fn column_stride(self, component: Component) -> usize {
        let bytes = self.rows * component.size();
        if self.columns > 1 { bytes.next_multiple_of(4) } else { bytes }
    }

    fn size(self, component: Component) -> usize {
        self.column_stride(component) * self.columns
    }
}

/// An accessor whose bounds hold.
pub(super) struct Accessor<'a> {
    /// Number of elements.
    pub(super) count: usize,
    pub(super) component: Component,
    pub(super) normalized: bool,
    shape: Shape,
    /// Bytes from the first element on; `None` for zeros.
    data: Option<&'a [u8]>,
    stride: usize,
    sparse: Option<Sparse<'a>>,
    place: String,
}

/// Elements that replace those of the base.
struct Sparse<'a> {
    /// Rising element numbers.
    indices: Vec<u32>,
    /// One element per index, tightly packed.
    values: &'a [u8],
}

impl<'a> Accessor<'a> {
    /// Opens the accessor that `place` names.
    pub(super) fn open(document: &'a Document<'_>, place: &str, index: Whole) -> Result<Self, ReadError> {
        let i = document.index(place, index, "accessor", document.root.accessors.len())?;
        let json = &document.root.accessors[i];
        let place = format!("accessors[{i}]");
        let component = Component::from_code(json.component_type.0).ok_or_else(|| {
            document.malformed(format!("{place}.componentType: {} is none of glTF's", json.component_type.0))
        })?;
        let shape = Shape::from_name(&json.r#type).ok_or_else(|| {
            document.malformed(format!("{place}.type: {:?} is none of glTF's", json.r#type))
        })?;
        let count = element_count(document, &place, json)?;
        let element = shape.size(component);
        let (data, stride) = match json.buffer_view {
            None => (None, element),
            Some(view) => {
                let (bytes, stride) = document.view(&format!("{place}.bufferView"), view)?;
                let stride = stride.unwrap_or(element as u64);
                let bytes = elements(document, &place, bytes, json.byte_offset.0, count, stride, element)?;
                (Some(bytes), stride as usize)
            }
        };
        let sparse = match &json.sparse {
            None => None,
            Some(sparse) => Some(open_sparse(document, &place, sparse, count, element)?),
        };
        Ok(Self { count, component, normalized: json.normalized, shape, data, stride, sparse, place })
    }

    /// Components of one element.
    pub(super) fn width(&self) -> usize {
        self.shape.rows * self.shape.columns
    }

    /// Bytes of element `i`; empty stands for zeros.
    fn bytes(&self, i: usize) -> &[u8] {
        let size = self.shape.size(self.component);
        if let Some(sparse) = &self.sparse
            && let Ok(at) = sparse.indices.binary_search(&(i as u32))
        {
            return &sparse.values[at * size..][..size];
        }
        self.data.map_or(&[], |data| &data[i * self.stride..][..size])
    }

    /// Elements as floats, all or those `select` names (each below the count). Accessors whose
    /// elements have fewer than `N` components leave the rest 0.
    pub(super) fn floats<const N: usize>(
        &self,
        document: &Document<'_>,
        select: Option<&[u32]>,
    ) -> Result<Vec<[f32; N]>, ReadError> {
        match self.component {
            Component::I8 => self.gather(document, select, |b: [u8; 1]| i8::from_le_bytes(b), 127.0),
            Component::U8 => self.gather(document, select, |b: [u8; 1]| b[0], 255.0),
            Component::I16 => self.gather(document, select, i16::from_le_bytes, 32767.0),
            Component::U16 => self.gather(document, select, u16::from_le_bytes, 65535.0),
            Component::U32 => self.gather(document, select, |b| u32::from_le_bytes(b) as f32, 1.0),
            Component::F32 => self.gather(document, select, f32::from_le_bytes, 1.0),
        }
    }

    fn gather<const N: usize, const S: usize, T: Into<f32>>(
        &self,
        document: &Document<'_>,
        select: Option<&[u32]>,
        decode: impl Fn([u8; S]) -> T,
        largest: f32,
    ) -> Result<Vec<[f32; N]>, ReadError> {
        let (column_stride, rows) = (self.shape.column_stride(self.component), self.shape.rows);
        let component = |bytes: &[u8], c: usize| {
            let at = (c / rows) * column_stride + (c % rows) * S;
            let Some(bytes) = bytes.get(at..at + S).and_then(|b| b.try_into().ok()) else { return 0.0 };
            let value: f32 = decode(bytes).into();
            if self.normalized { (value / largest).max(-1.0) } else { value }
        };
        let width = self.width().min(N);
        let element = |i: usize| {
            let bytes = self.bytes(i);
            std::array::from_fn(|c| if c < width { component(bytes, c) } else { 0.0 })
        };
        document.charge(&self.place, select.map_or(self.count, <[u32]>::len) as u64)?;
        Ok(match select {
            None => (0..self.count).map(element).collect(),
            Some(select) => select.iter().map(|&i| element(i as usize)).collect(),
        })
    }

    /// Elements as whole numbers, all or those `select` names (each below the count); missing
    /// components are 0. For unsigned components only; others give 0.
    pub(super) fn integers<const N: usize>(
        &self,
        document: &Document<'_>,
        select: Option<&[u32]>,
    ) -> Result<Vec<[u32; N]>, ReadError> {
        let size = self.component.size();
        let width = if self.component.is_unsigned() { self.width().min(N) } else { 0 };
        let component = |bytes: &[u8], c: usize| match bytes.get(c * size..(c + 1) * size) {
            Some(&[a]) => u32::from(a),
            Some(&[a, b]) => u32::from(u16::from_le_bytes([a, b])),
            Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        };
        let element = |i: usize| {
            let bytes = self.bytes(i);
            std::array::from_fn(|c| if c < width { component(bytes, c) } else { 0 })
        };
        document.charge(&self.place, select.map_or(self.count, <[u32]>::len) as u64)?;
        Ok(match select {
            None => (0..self.count).map(element).collect(),
            Some(select) => select.iter().map(|&i| element(i as usize)).collect(),
        })
    }
}

/// The number of elements; without a buffer view nothing but the limit bounds it.
fn element_count(document: &Document<'_>, place: &str, json: &json::Accessor) -> Result<usize, ReadError> {
    let count = json.count.0;
    if json.buffer_view.is_none() && count > document.files.limits().made_elements {
        let message = format!("{place}.count: {count} elements without a buffer view are above the limit");
        return Err(ReadError::limit(Location::file(document.name), message));
    }
    // Element numbers are 32 bits wide everywhere.
    u32::try_from(count)
        .map(|c| c as usize)
        .map_err(|_| document.malformed(format!("{place}.count: {count} elements are more than 2^32")))
}

/// Bytes of `count` elements from `offset` on, checked to be there.
fn elements<'b>(
    document: &Document<'_>,
    place: &str,
    bytes: &'b [u8],
    offset: u64,
    count: usize,
    stride: u64,
    size: usize,
) -> Result<&'b [u8], ReadError> {
    let steps = (count as u64).saturating_sub(1);
    let last = stride.checked_mul(steps).and_then(|s| s.checked_add(offset));
    let end = if count == 0 { Some(0) } else { last.and_then(|l| l.checked_add(size as u64)) };
    if end.is_some_and(|end| end <= bytes.len() as u64) {
        return Ok(bytes.get(offset as usize..).unwrap_or(&[]));
    }
    Err(document.malformed(format!(
        "{place}: {count} elements of {size} bytes, {stride} apart from byte {offset}, leave the buffer \
         view of {} bytes",
        bytes.len()
    )))
}

fn open_sparse<'a>(
    document: &'a Document<'_>,
    place: &str,
    json: &json::Sparse,
    count: usize,
    element: usize,
) -> Result<Sparse<'a>, ReadError> {
    let replaced = usize::try_from(json.count.0).ok().filter(|&n| n <= count).ok_or_else(|| {
        document.malformed(format!("{place}.sparse.count: {} is above the count {count}", json.count.0))
    })?;
    let component = Component::from_code(json.indices.component_type.0).filter(|c| c.is_unsigned());
    let Some(component) = component else {
        return Err(document.malformed(format!("{place}.sparse.indices.componentType: must be unsigned")));
    };
    let at = format!("{place}.sparse.indices");
    let size = component.size();
    let (bytes, _) = document.view(&format!("{at}.bufferView"), json.indices.buffer_view)?;
    let bytes = elements(document, &at, bytes, json.indices.byte_offset.0, replaced, size as u64, size)?;
    let indices: Vec<u32> = bytes.chunks_exact(size).take(replaced).map(unsigned).collect();
    document.charge(&at, replaced as u64)?;
    let rising = indices.windows(2).all(|w| w[0] < w[1]);
    if !rising || indices.last().is_some_and(|&last| last as usize >= count) {
        return Err(document.malformed(format!("{at}: must rise and stay below the count {count}")));
    }
    let at = format!("{place}.sparse.values");
    let (bytes, _) = document.view(&format!("{at}.bufferView"), json.values.buffer_view)?;
    let values =
        elements(document, &at, bytes, json.values.byte_offset.0, replaced, element as u64, element)?;
    Ok(Sparse { indices, values })
}

/// A little-endian number of one to four bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}
