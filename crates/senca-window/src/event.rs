//! What happens to a program, and what a program is.

use crate::Canvas;

/// A key of the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// A key that writes a character, as it was written: `'a'`, `'A'`, `'+'`, `' '`.
    Char(char),
    /// Arrow to the left.
    Left,
    /// Arrow to the right.
    Right,
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
    /// Page up.
    PageUp,
    /// Page down.
    PageDown,
    /// Home.
    Home,
    /// End.
    End,
    /// Enter, or Return.
    Enter,
    /// Escape.
    Escape,
    /// Backspace.
    Backspace,
    /// Delete.
    Delete,
    /// Tabulator.
    Tab,
    /// F1 to F12.
    Function(u8),
}

/// A button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Button {
    /// The left one.
    Left,
    /// The middle one.
    Middle,
    /// The right one.
    Right,
}

/// Something that happens to a program. Positions are pixels of the canvas, row 0 on top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A key goes down, or repeats.
    KeyDown(Key),
    /// A key comes up again.
    KeyUp(Key),
    /// A button of the mouse goes down.
    Press(Button, i32, i32),
    /// A button of the mouse comes up again.
    Release(Button, i32, i32),
    /// The mouse moves.
    Move(i32, i32),
    /// The wheel turns; positive away from the user.
    Wheel(f32),
    /// The canvas gets another size, in pixels.
    Resize(usize, usize),
    /// Time goes on, by so many seconds.
    Tick(f64),
}

/// What a program wants after an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Nothing: the picture stays as it is.
    Wait,
    /// To be drawn again.
    Redraw,
    /// To end.
    Quit,
}

/// An interactive program.
pub trait Program {
    /// What the window is called; asked again after each event, so that it may tell what happens.
    fn title(&self) -> String;

    /// Width and height the window opens with, in pixels.
    fn size(&self) -> (usize, usize);

    /// Whether the program wants [`Event::Tick`] all the time.
    fn animated(&self) -> bool {
        false
    }

    /// The program is shown in a window from now on, where drawing should not take long: while it is
    /// [`Program::animated`] it may draw what it has so far. Without a window, pictures are complete.
    fn enter_window(&mut self) {}

    /// Something happens.
    fn event(&mut self, event: Event) -> Flow;

    /// Draws the whole picture. The canvas has the size of the last [`Event::Resize`], or
    /// [`Program::size`] before the first one, and holds the picture drawn before.
    fn draw(&mut self, canvas: &mut Canvas);
}
