//! What all parts of the reader share: the parsed file, its buffers, warnings and bounds.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt::Display;

use super::json::{Root, Whole};
use super::uri;
use crate::{Files, Location, ReadError};

/// Warnings beyond this many are not kept.
const MAX_WARNINGS: usize = 100;

/// An open glTF file.
pub(super) struct Document<'a> {
    pub(super) name: &'a str,
    pub(super) root: Root,
    pub(super) files: &'a dyn Files,
    buffers: Vec<Option<BufferData<'a>>>,
    warnings: RefCell<Vec<String>>,
    /// Elements that may still be made; see [`Document::charge`].
    budget: Cell<u64>,
}

/// Bytes of one buffer; buffers of the same file share them.
#[derive(Clone)]
enum BufferData<'a> {
    Bin(&'a [u8]),
    Loaded(std::rc::Rc<[u8]>),
}

impl<'a> Document<'a> {
    /// Opens the buffers that `root` names; `bin` is the binary chunk of a GLB.
    pub(super) fn new(
        name: &'a str,
        mut root: Root,
        bin: Option<&'a [u8]>,
        files: &'a dyn Files,
    ) -> Result<Self, ReadError> {
        let uris: Vec<Option<String>> = root.buffers.iter_mut().map(|b| b.uri.take()).collect();
        let mut document = Self {
            name,
            root,
            files,
            buffers: Vec::new(),
            warnings: RefCell::default(),
            budget: Cell::new(0),
        };
        document.load_buffers(uris, bin)?;
        Ok(document)
    }

    fn load_buffers(&mut self, uris: Vec<Option<String>>, bin: Option<&'a [u8]>) -> Result<(), ReadError> {
        let mut known: BTreeMap<String, std::rc::Rc<[u8]>> = BTreeMap::new();
        let mut total = bin.map_or(0, |b| b.len() as u64);
        for (i, uri) in uris.into_iter().enumerate() {
            let data = match uri {
                None if i == 0 => bin.map(BufferData::Bin),
                None => None,
                Some(uri) if known.contains_key(&uri) => Some(BufferData::Loaded(known[&uri].clone())),
                Some(uri) => {
                    let bytes = self.fetch(&format!("buffers[{i}].uri"), &uri)?;
                    total += bytes.len() as u64;
                    self.keep_to("bytes of buffers", total, self.files.limits().file_bytes)?;
                    let bytes: std::rc::Rc<[u8]> = bytes.into();
                    known.insert(uri, bytes.clone());
                    Some(BufferData::Loaded(bytes))
                }
            };
            self.check_length(i, data.as_ref())?;
            self.buffers.push(data);
        }
        self.budget.set(self.files.limits().made_elements.saturating_add(total));
        Ok(())
    }

    fn check_length(&self, index: usize, data: Option<&BufferData<'_>>) -> Result<(), ReadError> {
        let Some(data) = data else { return Ok(()) };
        let (has, needs) = (data.bytes().len() as u64, self.root.buffers[index].byte_length.0);
        if has >= needs {
            return Ok(());
        }
        Err(self
            .malformed(format!("buffers[{index}].byteLength: is {needs}, but there are only {has} bytes")))
    }

    fn keep_to(&self, what: &str, asked: u64, limit: u64) -> Result<(), ReadError> {
        if asked <= limit {
            return Ok(());
        }
        let message = format!("asks for {asked} {what}; the limit is {limit}");
        Err(ReadError::limit(Location::file(self.name), message))
    }

    /// Bytes that `uri` names: in itself (`data:`) or in a file.
    pub(super) fn fetch(&self, place: &str, uri: &str) -> Result<Vec<u8>, ReadError> {
        if let Some(data) = uri.strip_prefix("data:") {
            return uri::decode_data(data).map_err(|why| self.malformed(format!("{place}: {why}")));
        }
        let path = uri::decode_percent(uri);
        let first = self.files.read(&path);
        match first {
            // Some exporters write names as they are, with a % that stands for itself.
            Err(ReadError::Io { .. }) if path != uri => self.files.read(uri).or(first),
            other => other,
        }
    }

    /// Bytes of buffer `index` from its `byteLength`.
    fn buffer(&self, place: &str, index: Whole) -> Result<&[u8], ReadError> {
        let i = self.index(place, index, "buffer", self.buffers.len())?;
        let Some(data) = &self.buffers[i] else {
            return Err(self.malformed(format!("{place}: buffers[{i}] has neither a uri nor a binary chunk")));
        };
        Ok(&data.bytes()[..self.root.buffers[i].byte_length.0 as usize])
    }

    /// Bytes and stride of the buffer view that `place` names.
    pub(super) fn view(&self, place: &str, index: Whole) -> Result<(&[u8], Option<u64>), ReadError> {
        let i = self.index(place, index, "buffer view", self.root.buffer_views.len())?;
        let view = &self.root.buffer_views[i];
        let buffer = self.buffer(&format!("bufferViews[{i}].buffer"), view.buffer)?;
        let range =
            view.byte_offset.0.checked_add(view.byte_length.0).filter(|&end| end <= buffer.len() as u64);
        let Some(end) = range else {
            return Err(self.malformed(format!(
                "bufferViews[{i}]: {} bytes from byte {} leave the buffer of {} bytes",
                view.byte_length.0,
                view.byte_offset.0,
                buffer.len()
            )));
        };
        let stride = view.byte_stride.map(|s| s.0).filter(|&s| s > 0);
        Ok((&buffer[view.byte_offset.0 as usize..end as usize], stride))
    }

    /// `index` as `usize`, when it is below `count`.
    pub(super) fn index(
        &self,
        place: &str,
        index: Whole,
        kind: &str,
        count: usize,
    ) -> Result<usize, ReadError> {
        if index.0 < count as u64 {
            return Ok(index.0 as usize);
        }
        Err(self.malformed(format!("{place}: names {kind} {}, but there are only {count}", index.0)))
    }

    /// `index` when it is below `count`; otherwise a warning.
    pub(super) fn index_or_warn(
        &self,
        place: impl Display,
        index: Whole,
        kind: &str,
        count: usize,
    ) -> Option<u32> {
        if index.0 < count as u64 {
            return Some(index.0 as u32);
        }
        self.warn(format!("{place}: names {kind} {}, but there are only {count}; left out", index.0));
        None
    }

    /// Takes `elements` from what the file may make. The same bytes may be used many times over, so
    /// the bound is on what is made: the bytes of the file plus the limit of made elements.
    pub(super) fn charge(&self, place: &dyn Display, elements: u64) -> Result<(), ReadError> {
        let Some(left) = self.budget.get().checked_sub(elements) else {
            let message =
                format!("{place}: {elements} elements are above what the limit leaves for this file");
            return Err(ReadError::limit(Location::file(self.name), message));
        };
        self.budget.set(left);
        Ok(())
    }

    /// A breach of the format.
    pub(super) fn malformed(&self, message: String) -> ReadError {
        ReadError::malformed(Location::file(self.name), message)
    }

    /// Notes something odd; the same text is noted once.
    pub(super) fn warn(&self, message: String) {
        let mut warnings = self.warnings.borrow_mut();
        if warnings.len() < MAX_WARNINGS && !warnings.contains(&message) {
            warnings.push(message);
        } else if warnings.len() == MAX_WARNINGS {
            warnings.push("more warnings are not shown".to_owned());
        }
    }

    /// The warnings in the order they came.
    pub(super) fn take_warnings(&self) -> Vec<String> {
        std::mem::take(&mut *self.warnings.borrow_mut())
    }

    /// `values` as `f32`, when all are finite; otherwise a warning and `default`.
    pub(super) fn floats<const N: usize>(
        &self,
        place: &str,
        values: [f64; N],
        default: [f32; N],
    ) -> [f32; N] {
        let floats = values.map(|v| v as f32);
        if floats.iter().all(|v| v.is_finite()) {
            return floats;
        }
        self.warn(format!("{place}: a number is too large; the default is used"));
        default
    }
}

impl BufferData<'_> {
    fn bytes(&self) -> &[u8] {
        match self {
            Self::Bin(bytes) => bytes,
            Self::Loaded(bytes) => bytes,
        }
    }
}

/// `text` when it is not empty, else a name from `kind` and `index`.
pub(super) fn name_or<'t>(text: &'t str, kind: &str, index: usize) -> Cow<'t, str> {
    if text.is_empty() { Cow::Owned(format!("{kind} {index}")) } else { Cow::Borrowed(text) }
}
