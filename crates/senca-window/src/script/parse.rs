//! Reading scripts.

use super::{MAX_EVENTS, ScriptError, ScriptErrorKind, Step};
use crate::session::is_possible;
use crate::{Button, Event, Key};
use std::str::FromStr;

/// Furthest position on both axes, in pixels.
const FURTHEST: i32 = 1 << 20;

/// Longest time of a tick, in seconds: a year of 365 days.
const LONGEST: f64 = 365.0 * 86_400.0;

/// What is wrong, and at which byte of the line.
type Wrong = (usize, ScriptErrorKind);

/// All commands of a script.
pub(super) fn parse(name: &str, text: &str) -> Result<Vec<Step>, ScriptError> {
    let mut steps = Vec::new();
    let mut events = 0;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (number, line) in text.lines().enumerate() {
        let step = command(&mut Line { text: line, at: 0 }).and_then(|step| {
            events += step.as_ref().map_or(0, Step::events);
            if events > MAX_EVENTS { Err((0, ScriptErrorKind::TooLong)) } else { Ok(step) }
        });
        let step = step.map_err(|(at, kind)| ScriptError {
            file: name.to_owned(),
            line: number + 1,
            column: line.get(..at).map_or(at, |before| before.chars().count()) + 1,
            kind,
        })?;
        steps.extend(step);
    }
    Ok(steps)
}

/// The command of a line; `None` when there is none.
fn command(line: &mut Line<'_>) -> Result<Option<Step>, Wrong> {
    let Some((at, name)) = line.word() else { return Ok(None) };
    let step = match name {
        "key" => Step::Key(line.key()?),
        "down" => Step::Event(Event::KeyDown(line.key()?)),
        "up" => Step::Event(Event::KeyUp(line.key()?)),
        "type" => Step::Type(line.rest("the text to type")?),
        "press" | "release" | "click" | "drag" => mouse(name, line)?,
        "move" => {
            let [x, y] = line.position()?;
            Step::Event(Event::Move(x, y))
        }
        "wheel" => Step::Event(Event::Wheel(line.number("a number of turns", |v: &f32| v.abs() <= 1e6)?)),
        "size" => Step::Event(size(line)?),
        "tick" => {
            let seconds =
                line.number("a time of 0 seconds to a year", |v: &f64| (0.0..=LONGEST).contains(v))?;
            let times = if line.has_more() { line.number("a whole number of times", |_| true)? } else { 1 };
            Step::Ticks(seconds, times)
        }
        "save" => Step::Save(line.rest("the file to save")?),
        "quit" => Step::Quit,
        other => return Err((at, ScriptErrorKind::UnknownCommand(other.to_owned()))),
    };
    match line.word() {
        Some((at, word)) => Err((at, ScriptErrorKind::TooMuch(word.to_owned()))),
        None => Ok(Some(step)),
    }
}

fn mouse(name: &str, line: &mut Line<'_>) -> Result<Step, Wrong> {
    let button = line.button()?;
    let [x, y] = line.position()?;
    Ok(match name {
        "press" => Step::Event(Event::Press(button, x, y)),
        "release" => Step::Event(Event::Release(button, x, y)),
        "click" => Step::Click(button, [x, y]),
        _ => Step::Drag(button, [x, y], line.position()?),
    })
}

fn size(line: &mut Line<'_>) -> Result<Event, Wrong> {
    line.skip_blanks();
    let at = line.at;
    let mut side = || line.number("a whole number of pixels", |_: &usize| true);
    let (width, height) = (side()?, side()?);
    if !is_possible(width, height) {
        return Err((at, ScriptErrorKind::Size(width, height)));
    }
    Ok(Event::Resize(width, height))
}

/// A line and how far it is read, in bytes.
struct Line<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Line<'a> {
    fn skip_blanks(&mut self) {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
    }

    /// What follows the blanks, comment included.
    fn ahead(&mut self) -> &'a str {
        self.skip_blanks();
        &self.text[self.at..]
    }

    /// Whether there is something before the end or the comment.
    fn has_more(&mut self) -> bool {
        let ahead = self.ahead();
        !ahead.is_empty() && !ahead.starts_with('#')
    }

    /// The next word with its place; `None` at the end of the line or a comment.
    fn word(&mut self) -> Option<(usize, &'a str)> {
        self.has_more().then(|| self.any_word())
    }

    /// What is up to the next blank, be it a comment.
    fn any_word(&mut self) -> (usize, &'a str) {
        let ahead = self.ahead();
        let word = ahead.split(char::is_whitespace).next().unwrap_or_default();
        let at = self.at;
        self.at += word.len();
        (at, word)
    }

    /// A word that has to be there.
    fn needed(&mut self, what: &'static str) -> Result<(usize, &'a str), Wrong> {
        self.word().ok_or_else(|| self.missing(what))
    }

    /// Something is missing after what is read.
    fn missing(&self, what: &'static str) -> Wrong {
        (self.text[..self.at].trim_end().len(), ScriptErrorKind::Expected(what, None))
    }

    fn key(&mut self) -> Result<Key, Wrong> {
        // A single number sign looks like an empty comment, but a key has to follow.
        let is_sign = self.ahead().trim_end() == "#";
        let (at, name) = if is_sign { self.any_word() } else { self.needed("a key")? };
        Key::from_name(name).ok_or_else(|| (at, ScriptErrorKind::UnknownKey(name.to_owned())))
    }

    /// The button that is named; the left one if none is.
    fn button(&mut self) -> Result<Button, Wrong> {
        let is_name = self.ahead().starts_with(char::is_alphabetic);
        if !is_name {
            return Ok(Button::Left);
        }
        let (at, name) = self.any_word();
        Button::from_name(name).ok_or_else(|| (at, ScriptErrorKind::UnknownButton(name.to_owned())))
    }

    fn number<T: FromStr>(&mut self, what: &'static str, fits: impl Fn(&T) -> bool) -> Result<T, Wrong> {
        let (at, word) = self.needed(what)?;
        let number = word.parse().ok().filter(fits);
        number.ok_or_else(|| (at, ScriptErrorKind::Expected(what, Some(word.to_owned()))))
    }

    fn position(&mut self) -> Result<[i32; 2], Wrong> {
        let fits = |v: &i32| (-FURTHEST..=FURTHEST).contains(v);
        Ok([self.number("a position of x in pixels", fits)?, self.number("a position of y in pixels", fits)?])
    }

    /// A text: in quotation marks, or what is before the end of the line or a comment.
    fn rest(&mut self, what: &'static str) -> Result<String, Wrong> {
        if !self.has_more() {
            return Err(self.missing(what));
        }
        let ahead = self.ahead();
        if let Some(inside) = ahead.strip_prefix('"') {
            return self.quoted(inside);
        }
        let mut signs = ahead.match_indices('#').map(|(k, _)| k);
        let comment = signs.find(|k| ahead[..*k].ends_with(char::is_whitespace));
        let end = comment.unwrap_or(ahead.len());
        self.at += end;
        Ok(ahead[..end].trim_end().to_owned())
    }

    /// A text from behind its opening quotation mark on.
    fn quoted(&mut self, inside: &str) -> Result<String, Wrong> {
        let mut text = String::new();
        let mut characters = inside.char_indices();
        while let Some((k, c)) = characters.next() {
            match c {
                '"' => {
                    self.at += 1 + k + 1;
                    return Ok(text);
                }
                '\\' => match characters.next() {
                    Some((_, c @ ('"' | '\\'))) => text.push(c),
                    Some((_, c)) => text.extend(['\\', c]),
                    None => break,
                },
                c => text.push(c),
            }
        }
        Err((self.at, ScriptErrorKind::OpenText))
    }
}
