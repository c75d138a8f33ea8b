//! Lines of `key = values`, with their places.

use super::{Located, ViewFileErrorKind as Kind};

const KEYS: [&str; 10] = ["view", "p", "n", "f", "vrp", "vpn", "vup", "prp", "window", "b"];

/// A place in the text, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) line: usize,
    pub(super) column: usize,
}

/// A word and where it stands.
#[derive(Clone, Copy)]
struct Word<'a> {
    place: Place,
    text: &'a str,
}

struct Entry<'a> {
    key: Word<'a>,
    values: Vec<Word<'a>>,
}

/// All lines with content, and where the text ends.
pub(super) struct Entries<'a> {
    entries: Vec<Entry<'a>>,
    end: Place,
}

impl<'a> Entries<'a> {
    /// Splits the text; unknown and repeated keys are mistakes.
    pub(super) fn read(text: &'a str) -> Located<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut all = Self { entries: Vec::new(), end: Place { line: 1, column: 1 } };
        for (index, line) in text.lines().enumerate() {
            all.end = Place { line: index + 1, column: line.chars().count() + 1 };
            if let Some(entry) = read_line(index + 1, line)? {
                all.add(entry)?;
            }
        }
        Ok(all)
    }

    fn add(&mut self, entry: Entry<'a>) -> Located<()> {
        let Word { place, text: key } = entry.key;
        if !KEYS.iter().any(|known| known.eq_ignore_ascii_case(key)) {
            return Err((place, Kind::UnknownKey(key.to_owned())));
        }
        if let Some(first) = self.find(key) {
            let first_line = first.key.place.line;
            return Err((place, Kind::Duplicate { key: key.to_owned(), first_line }));
        }
        self.entries.push(entry);
        Ok(())
    }

    fn find(&self, key: &str) -> Option<&Entry<'a>> {
        self.entries.iter().find(|entry| entry.key.text.eq_ignore_ascii_case(key))
    }

    fn required(&self, key: &'static str) -> Located<&Entry<'a>> {
        self.find(key).ok_or((self.end, Kind::Missing(key)))
    }

    /// Fails on a key, other than `view`, that is not among these lower-case names.
    pub(super) fn only(&self, keys: &[&str], view: &'static str, expected: &'static str) -> Located<()> {
        let allowed =
            |key: &str| keys.iter().any(|k| k.eq_ignore_ascii_case(key)) || key.eq_ignore_ascii_case("view");
        match self.entries.iter().map(|entry| entry.key).find(|key| !allowed(key.text)) {
            Some(Word { place, text }) => {
                Err((place, Kind::KeyOfOtherView { key: text.to_owned(), view, expected }))
            }
            None => Ok(()),
        }
    }

    /// The one word that stands for this key.
    pub(super) fn word(&self, key: &'static str) -> Located<(Place, &'a str)> {
        let entry = self.required(key)?;
        match entry.values.as_slice() {
            [word] => Ok((word.place, word.text)),
            words => {
                let place = words.get(1).unwrap_or(&entry.key).place;
                Err((place, Kind::UnknownView(words.iter().map(|w| w.text).collect::<Vec<_>>().join(" "))))
            }
        }
    }

    /// The `N` numbers that stand for this key.
    pub(super) fn numbers<const N: usize>(&self, key: &'static str) -> Located<[f64; N]> {
        let entry = self.required(key)?;
        let values: Vec<f64> = entry.values.iter().map(read_number).collect::<Located<_>>()?;
        values.try_into().map_err(|values: Vec<f64>| {
            let place = entry.values.get(N).unwrap_or(&entry.key).place;
            (place, Kind::Count { key: entry.key.text.to_owned(), expected: N, found: values.len() })
        })
    }
}

fn read_number(word: &Word<'_>) -> Located<f64> {
    match word.text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err((word.place, Kind::Number(word.text.to_owned()))),
    }
}

/// The key and values of a line; `None` for a line that is blank or only a comment.
fn read_line(line_number: usize, line: &str) -> Located<Option<Entry<'_>>> {
    let content = line.split('#').next().unwrap_or_default();
    let (left, right) = content.split_once('=').unwrap_or((content, ""));
    let mut words = split_words(line_number, left, 1);
    let equals_at = left.chars().count() + 2;
    words.extend(split_words(line_number, right, equals_at));
    let mut words = words.into_iter();
    let Some(key) = words.next() else {
        return match content.trim() {
            "" => Ok(None),
            rest => Err((Place { line: line_number, column: 1 }, Kind::NoKey(rest.to_owned()))),
        };
    };
    if content.contains('=') && left.trim().is_empty() {
        return Err((key.place, Kind::NoKey(content.trim().to_owned())));
    }
    Ok(Some(Entry { key, values: words.collect() }))
}

/// Words between blanks and commas, with their columns in characters from `first_column`.
fn split_words(line: usize, text: &str, first_column: usize) -> Vec<Word<'_>> {
    let separator = |c: char| c.is_whitespace() || c == ',';
    let mut words = Vec::new();
    let mut rest = text;
    let mut column = first_column;
    while let Some(start) = rest.find(|c| !separator(c)) {
        column += rest[..start].chars().count();
        rest = &rest[start..];
        let end = rest.find(separator).unwrap_or(rest.len());
        words.push(Word { place: Place { line, column }, text: &rest[..end] });
        column += rest[..end].chars().count();
        rest = &rest[end..];
    }
    words
}
