//! Sessions written as a text, and replayed without a display.

mod parse;
#[cfg(test)]
mod tests;

use crate::{Button, Canvas, Event, Key, Program, Session};
use std::fmt;

/// Most events of a script.
const MAX_EVENTS: u64 = 10_000_000;

/// Most moves of a drag.
const DRAG_STEPS: i32 = 16;

/// A session, to be replayed without a display.
///
/// One command a line; words are parted by blanks; what follows a word that begins with `#` is a comment.
/// Positions are pixels from the upper left corner, `x` to the right, `y` down.
///
/// | command | what happens |
/// |---|---|
/// | `key NAME` | a key goes down and up again, see [`Key::from_name`] |
/// | `down NAME`, `up NAME` | one of the two |
/// | `type TEXT` | the keys of all characters, one after the other |
/// | `press [BUTTON] X Y`, `release [BUTTON] X Y` | a button of the mouse, `left` if none is named |
/// | `click [BUTTON] X Y` | both |
/// | `drag [BUTTON] X Y X Y` | press, moves in up to 16 equal steps, release |
/// | `move X Y` | the mouse moves |
/// | `wheel N` | the wheel turns, away from the user above 0 |
/// | `size W H` | the canvas gets another size |
/// | `tick SECONDS [TIMES]` | time goes on, so often by so much |
/// | `save FILE` | the picture as it is now is saved |
/// | `quit` | the session ends |
///
/// `TEXT` and `FILE` may hold blanks, and stand in `"` where they begin or end with one or hold ` #`; inside of
/// them `\"` is a quotation mark and `\\` a backslash. A script makes at most 10 000 000 events.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    steps: Vec<Step>,
}

/// A command of a script.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Event(Event),
    Key(Key),
    Type(String),
    Click(Button, [i32; 2]),
    Drag(Button, [i32; 2], [i32; 2]),
    Ticks(f64, u32),
    Save(String),
    Quit,
}

/// What is wrong with a script, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: {kind}")]
pub struct ScriptError {
    /// Name of the script as it was given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Character of the line, from 1.
    pub column: usize,
    /// What is wrong.
    pub kind: ScriptErrorKind,
}

/// What is wrong with a script.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ScriptErrorKind {
    /// There is no such command.
    UnknownCommand(String),
    /// There is no key of that name.
    UnknownKey(String),
    /// There is no such button.
    UnknownButton(String),
    /// Something else should be there: what, and what is there if anything is.
    Expected(&'static str, Option<String>),
    /// Words after the end of a command.
    TooMuch(String),
    /// A text without its closing quotation mark.
    OpenText,
    /// A size of a canvas that is not had.
    Size(usize, usize),
    /// More events than a script may have.
    TooLong,
}

impl fmt::Display for ScriptErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownCommand(name) => write!(
                f,
                "there is no command \"{name}\"; there are: key, down, up, type, press, release, click, drag, \
                 move, wheel, size, tick, save, quit"
            ),
            Self::UnknownKey(name) => write!(
                f,
                "there is no key \"{name}\"; keys are single characters, left, right, up, down, pageup, \
                 pagedown, home, end, enter, escape, backspace, delete, tab, space, plus, minus, comma, period, \
                 hash, f1 to f12"
            ),
            Self::UnknownButton(name) => {
                write!(f, "there is no button \"{name}\"; buttons are left, middle and right")
            }
            Self::Expected(what, Some(found)) => write!(f, "\"{found}\" is not {what}"),
            Self::Expected(what, None) => write!(f, "{what} is missing"),
            Self::TooMuch(word) => write!(f, "the command is complete before \"{word}\""),
            Self::OpenText => write!(f, "the text has no closing quotation mark"),
            Self::Size(width, height) => write!(
                f,
                "{width} x {height} is no size of a picture; sides are 1 to {} pixels, and there are at most {}",
                crate::MAX_SIDE,
                crate::MAX_PIXELS
            ),
            Self::TooLong => write!(f, "the script makes more than {MAX_EVENTS} events by this line"),
        }
    }
}

impl Script {
    /// Reads a script; `name` is what messages call it.
    ///
    /// # Errors
    /// For the first thing that is wrong.
    pub fn parse(name: &str, text: &str) -> Result<Self, ScriptError> {
        parse::parse(name, text).map(|steps| Self { steps })
    }

    /// The files of all `save`, in their order.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.steps.iter().filter_map(|step| match step {
            Step::Save(file) => Some(file.as_str()),
            _ => None,
        })
    }

    /// Replays the session; returns the last picture. `save` gets the file of each `save` and the picture at
    /// that moment.
    ///
    /// The program is drawn for each `save` and at the end, if it wanted to be since. Nothing depends on the
    /// time of day. The session ends with the script, with `quit`, or when the program wants to.
    ///
    /// # Errors
    /// The first one of `save`.
    pub fn run<E>(
        &self,
        program: &mut dyn Program,
        save: impl FnMut(&str, &Canvas) -> Result<(), E>,
    ) -> Result<Canvas, E> {
        let mut session = Session::new(program);
        self.replay(&mut session, save)?;
        Ok(session.finish())
    }

    /// Replays the script in a session that has begun, as [`Script::run`] does.
    ///
    /// # Errors
    /// The first one of `save`.
    pub fn replay<E>(
        &self,
        session: &mut Session<'_>,
        mut save: impl FnMut(&str, &Canvas) -> Result<(), E>,
    ) -> Result<(), E> {
        for step in &self.steps {
            if session.has_ended() {
                break;
            }
            match step {
                Step::Save(file) => save(file, session.picture())?,
                Step::Quit => break,
                step => step.play(session),
            }
        }
        Ok(())
    }
}

impl Step {
    /// Lets it happen.
    fn play(&self, session: &mut Session<'_>) {
        match self {
            Self::Event(event) => session.event(*event),
            Self::Key(key) => stroke(session, *key),
            Self::Type(text) => text.chars().for_each(|c| stroke(session, Key::Char(c))),
            Self::Click(button, [x, y]) => {
                session.event(Event::Press(*button, *x, *y));
                session.event(Event::Release(*button, *x, *y));
            }
            Self::Drag(button, from, to) => drag(session, *button, *from, *to),
            Self::Ticks(seconds, times) => {
                for _ in 0..*times {
                    if session.has_ended() {
                        break;
                    }
                    session.event(Event::Tick(*seconds));
                }
            }
            Self::Save(_) | Self::Quit => {}
        }
    }

    /// How many events it makes at most.
    fn events(&self) -> u64 {
        match self {
            Self::Event(_) => 1,
            Self::Key(_) | Self::Click(..) => 2,
            Self::Type(text) => 2 * text.len() as u64,
            Self::Drag(..) => 2 + u64::from(DRAG_STEPS.unsigned_abs()),
            Self::Ticks(_, times) => u64::from(*times),
            Self::Save(_) | Self::Quit => 0,
        }
    }
}

fn stroke(session: &mut Session<'_>, key: Key) {
    session.event(Event::KeyDown(key));
    session.event(Event::KeyUp(key));
}

fn drag(session: &mut Session<'_>, button: Button, from: [i32; 2], to: [i32; 2]) {
    session.event(Event::Press(button, from[0], from[1]));
    let way = [to[0] - from[0], to[1] - from[1]];
    let steps = way[0].abs().max(way[1].abs()).clamp(1, DRAG_STEPS);
    for k in 1..=steps {
        session.event(Event::Move(from[0] + way[0] * k / steps, from[1] + way[1] * k / steps));
    }
    session.event(Event::Release(button, to[0], to[1]));
}
