//! The parsed text with its places, and tables that know which keys they were asked for.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::names::{nearest, quoted_list};
use super::values::Value;
use crate::{Location, ReadError};

/// Result of reading a piece of the file.
pub(super) type Result<T> = std::result::Result<T, ReadError>;

/// Place of something in the text, in bytes.
pub(super) type Span = Range<usize>;

/// The text that is read.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// File name for messages.
    pub(super) name: &'a str,
    /// The whole text.
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// Line and column of a byte.
    pub(super) fn location(&self, at: usize) -> Location {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        let before = &self.text[..at];
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        Location::text(self.name, line as u32, column as u32)
    }

    /// A breach of the rules at `span`.
    pub(super) fn error(&self, span: &Span, message: impl Into<String>) -> ReadError {
        ReadError::malformed(self.location(span.start), message)
    }

    /// A demand above the limits at `span`.
    pub(super) fn limit(&self, span: &Span, message: impl Into<String>) -> ReadError {
        ReadError::limit(self.location(span.start), message)
    }
}

/// Keys of the whole scene, which are easily written below a header by mistake.
const TOP_KEYS: [&str; 3] = ["ambient", "background", "attenuation"];

/// A table being read. Every key that it is asked for counts as known; [`Table::finish`] refuses the
/// others.
pub(super) struct Table<'a> {
    pub(super) source: Source<'a>,
    table: &'a DeTable<'a>,
    span: Span,
    /// What the table is, for messages: `material "gold"`.
    what: String,
    known: Vec<&'static str>,
}

impl<'a> Table<'a> {
    pub(super) fn new(
        source: Source<'a>,
        table: &'a DeTable<'a>,
        span: Span,
        what: impl Into<String>,
    ) -> Self {
        Self { source, table, span, what: what.into(), known: Vec::new() }
    }

    /// What the table is.
    pub(super) fn what(&self) -> &str {
        &self.what
    }

    /// Names the table better once its own keys have told more.
    pub(super) fn set_what(&mut self, what: impl Into<String>) {
        self.what = what.into();
    }

    /// The value of `key`, if it is there.
    pub(super) fn get(&mut self, key: &'static str) -> Option<Value<'a>> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        let (name, value) = self.table.get_key_value(key)?;
        Some(Value::new(self.source, name.get_ref(), value))
    }

    /// Counts `keys` as known without asking for them.
    pub(super) fn know(&mut self, keys: &[&'static str]) {
        self.known.extend(keys);
    }

    /// Whether `key` is there, without making it known.
    pub(super) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// The first of `keys` that is there, without making it known.
    pub(super) fn first_of(&self, keys: &[&'static str]) -> Option<&'static str> {
        keys.iter().copied().find(|key| self.has(key))
    }

    /// The value of `key` through `read`, if it is there.
    pub(super) fn read<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(Value<'a>) -> Result<T>,
    ) -> Result<Option<T>> {
        self.get(key).map(read).transpose()
    }

    /// The value of `key` through `read`, or `default`.
    pub(super) fn read_or<T>(
        &mut self,
        key: &'static str,
        default: T,
        read: impl FnOnce(Value<'a>) -> Result<T>,
    ) -> Result<T> {
        Ok(self.read(key, read)?.unwrap_or(default))
    }

    /// The value of `key`, which must be there.
    pub(super) fn require(&mut self, key: &'static str) -> Result<Value<'a>> {
        if let Some(value) = self.get(key) {
            return Ok(value);
        }
        // A misspelt key is the likelier mistake than a missing one.
        let misspelt = self.unknown().take(1000).find(|(name, _)| nearest(name, [key]).is_some());
        Err(match misspelt {
            Some((name, span)) => self
                .source
                .error(&span, format!("unknown key \"{name}\" in {}; did you mean \"{key}\"?", self.what)),
            None => self.error(format!("{} needs the key \"{key}\"", self.what)),
        })
    }

    /// An error about the table as a whole.
    pub(super) fn error(&self, message: impl Into<String>) -> ReadError {
        self.source.error(&self.span, message)
    }

    /// The tables under `key`: one table, or an array of tables.
    pub(super) fn tables(&mut self, key: &'static str) -> Result<Vec<Table<'a>>> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let what = format!("the {key}");
        if value.is_table() {
            return Ok(vec![value.table(what)?]);
        }
        value.items("a table or a list of tables")?.map(|item| item.table(what.clone())).collect()
    }

    /// The named tables under `key`, as in `[material.gold]`, in the order of the file.
    pub(super) fn named(&mut self, key: &'static str) -> Result<Vec<(&'a str, Table<'a>)>> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let table = value.as_table().ok_or_else(|| {
            value.error(format!("\"{key}\" needs names: write [{key}.NAME] above the keys of each"))
        })?;
        let mut named: Vec<_> = table.iter().collect();
        named.sort_by_key(|(name, _)| name.span().start);
        named
            .into_iter()
            .map(|(name, value)| {
                let value = Value::new(self.source, name.get_ref(), value);
                let mut table = value.table(format!("{key} \"{}\"", name.get_ref()))?;
                table.span = name.span();
                Ok((name.get_ref().as_ref(), table))
            })
            .collect()
    }

    /// Refuses keys that the table was not asked for.
    pub(super) fn finish(self) -> Result<()> {
        let Some((name, span)) = self.unknown().min_by_key(|(_, span)| span.start) else { return Ok(()) };
        let mut known = self.known.clone();
        known.sort_unstable();
        known.dedup();
        let hint = nearest(name, known.iter().copied());
        let hint = hint.map(|key| format!("; did you mean \"{key}\"?")).unwrap_or_default();
        let message = format!(
            "unknown key \"{name}\" in {}{hint}{} Known here: {}",
            self.what,
            if hint.is_empty() { "." } else { "" },
            quoted_list(&known)
        );
        let message = if TOP_KEYS.contains(&name) && !known.contains(&name) {
            format!("\"{name}\" belongs to the top of the file, above the first header in brackets")
        } else {
            message
        };
        Err(self.source.error(&span, message))
    }

    /// Keys that the table was not asked for so far.
    fn unknown(&self) -> impl Iterator<Item = (&'a str, Span)> {
        let known = |name: &str| self.known.contains(&name);
        let keys: Vec<_> = self.table.keys().filter(|key| !known(key.get_ref())).collect();
        keys.into_iter().map(|key| (key.get_ref().as_ref(), key.span()))
    }
}

/// Parses the text; syntax errors get their place.
pub(super) fn parse<'a>(source: Source<'a>) -> Result<Spanned<DeTable<'a>>> {
    DeTable::parse(source.text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        source.error(&span, format!("not valid TOML: {}", error.message()))
    })
}

/// What kind of value this is, in the words of a message.
pub(super) fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
