use super::*;
use crate::Flow;
use proptest::prelude::*;
use std::convert::Infallible;

/// Writes down what happens; shows how many events there were; ends with `q`.
#[derive(Default)]
struct Recorder {
    events: Vec<Event>,
}

impl Program for Recorder {
    fn title(&self) -> String {
        "Recorder".to_owned()
    }

    fn size(&self) -> (usize, usize) {
        (3, 2)
    }

    fn event(&mut self, event: Event) -> Flow {
        self.events.push(event);
        if event == Event::KeyDown(Key::Char('q')) { Flow::Quit } else { Flow::Redraw }
    }

    fn draw(&mut self, canvas: &mut Canvas) {
        canvas.fill(self.events.len() as u32);
    }
}

/// Events, pictures that were saved (name, width, value of a pixel), the last value.
fn replayed(text: &str) -> (Vec<Event>, Vec<(String, usize, u32)>, u32) {
    let mut program = Recorder::default();
    let mut saved = Vec::new();
    let picture = Script::parse("test", text)
        .unwrap()
        .run(&mut program, |file, canvas| {
            saved.push((file.to_owned(), canvas.width(), canvas.pixels()[0]));
            Ok::<_, Infallible>(())
        })
        .unwrap();
    (program.events, saved, picture.pixels()[0])
}

#[test]
fn every_command_makes_its_events() {
    use Event::{KeyDown, KeyUp, Move, Press, Release, Resize, Tick, Wheel};
    let text = "\u{feff}# a session\n\nkey a # pressed\r\ndown PageUp\nup pageup\nkey #\ntype x Y #z\n\
                click 5 -6\npress right 1 2\nrelease middle 3 4\nmove 7 8\nwheel -0.5\nsize 30 20\ntick 0.25 2\n\
                tick 1\n  drag 0 0 2 -4\n";
    let (a, x, y) = (Key::Char('a'), Key::Char('x'), Key::Char('Y'));
    let (blank, sign) = (Key::Char(' '), Key::Char('#'));
    let (left, middle, right) = (Button::Left, Button::Middle, Button::Right);
    let expected = [
        &[KeyDown(a), KeyUp(a), KeyDown(Key::PageUp), KeyUp(Key::PageUp)] as &[Event],
        &[
            KeyDown(sign),
            KeyUp(sign),
            KeyDown(x),
            KeyUp(x),
            KeyDown(blank),
            KeyUp(blank),
            KeyDown(y),
            KeyUp(y),
        ],
        &[Press(left, 5, -6), Release(left, 5, -6), Press(right, 1, 2), Release(middle, 3, 4), Move(7, 8)],
        &[Wheel(-0.5), Resize(30, 20), Tick(0.25), Tick(0.25), Tick(1.0)],
        &[Press(left, 0, 0), Move(0, -1), Move(1, -2), Move(1, -3), Move(2, -4), Release(left, 2, -4)],
    ];
    assert_eq!(replayed(text).0, expected.concat());
}

#[test]
fn pictures_are_saved_as_they_are_then() {
    let text =
        "save first.png\nkey a\nsave \"a \\\"b\\\" #1.png\" # quoted\nsize 8 8\nsave c d.png # plain\n";
    let (_, saved, last) = replayed(text);
    let expected = [("first.png", 3, 0), ("a \"b\" #1.png", 3, 2), ("c d.png", 8, 3)];
    assert_eq!(saved, expected.map(|(name, width, value)| (name.to_owned(), width, value)));
    assert_eq!(last, 3);
    let script = Script::parse("test", text).unwrap();
    assert!(script.files().eq(["first.png", "a \"b\" #1.png", "c d.png"]));
}

#[test]
fn the_end_is_the_end() {
    assert_eq!(replayed("key a\nquit\nkey b\nsave no.png").0.len(), 2);
    let (events, saved, _) = replayed("key q\nsave no.png\ntick 1 1000000");
    assert_eq!((events.len(), saved.len()), (1, 0));
}

#[test]
fn what_save_says_ends_the_replay() {
    let script = Script::parse("test", "save a\nkey b").unwrap();
    let mut program = Recorder::default();
    assert_eq!(script.run(&mut program, |file, _| Err(file.to_owned())), Err("a".to_owned()));
    assert!(program.events.is_empty());
}

#[test]
fn errors_tell_the_place_and_what_would_be_right() {
    for (text, expected) in [
        ("key a\n  jump 3", "s:2:3: there is no command \"jump\"; there are: key, "),
        ("key", "s:1:4: a key is missing"),
        ("key  # none", "s:1:4: "),
        ("key ab", "s:1:5: there is no key \"ab\"; keys are "),
        ("click top 1 2", "s:1:7: there is no button \"top\"; buttons are left, middle and right"),
        ("click 1", "s:1:8: a position of y in pixels is missing"),
        ("move 1.5 2", "s:1:6: \"1.5\" is not a position of x in pixels"),
        ("move 9999999 2", "s:1:6: \"9999999\" is not a position"),
        ("quit ä now", "s:1:6: the command is complete before \"ä\""),
        ("save \"ä\" b", "s:1:10: the command is complete before \"b\""),
        ("save \"a", "s:1:6: the text has no closing"),
        ("save", "s:1:5: the file to save is missing"),
        ("size 0 5", "s:1:6: 0 x 5 is no size"),
        ("size 16384 16384", "s:1:6: 16384 x 16384 is no size"),
        ("tick -1", "s:1:6: \"-1\" is not a time"),
        ("tick nan", "s:1:6: \"nan\" is not a time"),
        ("tick 1 -2", "s:1:8: \"-2\" is not a whole number of times"),
        ("tick 1 9999998\nkey a\ntick 1", "s:3:1: the script makes more than 10000000 events"),
        ("wheel inf", "s:1:7: \"inf\" is not a number of turns"),
    ] {
        let message = Script::parse("s", text).expect_err(text).to_string();
        assert!(message.starts_with(expected), "{text}: {message}");
    }
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in ".*\n?.*") {
        let _ = Script::parse("any", &text);
    }

    #[test]
    fn any_words_are_read_or_refused(
        words in proptest::collection::vec(
            prop_oneof![
                Just("key"), Just("type"), Just("drag"), Just("tick"), Just("size"), Just("save"), Just("left"),
                Just("#"), Just("\""), Just("\\"), Just("1"), Just("-1e99"), Just("\n"), Just("ä"), Just("1048576"),
            ],
            0..12,
        ),
        glue in prop_oneof![Just(" "), Just(""), Just("\t")],
    ) {
        if let Ok(script) = Script::parse("any", &words.join(glue)) {
            let mut program = Recorder::default();
            let picture = script.run(&mut program, |_, _| Ok::<_, Infallible>(()));
            prop_assert!(picture.is_ok());
        }
    }
}
