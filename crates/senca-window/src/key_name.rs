//! Names of keys and buttons, as scripts write them.

use crate::{Button, Key};

/// Names of keys that write no character, and of those whose character is hard to see.
const KEYS: [(&str, Key); 21] = [
    ("left", Key::Left),
    ("right", Key::Right),
    ("up", Key::Up),
    ("down", Key::Down),
    ("pageup", Key::PageUp),
    ("pagedown", Key::PageDown),
    ("home", Key::Home),
    ("end", Key::End),
    ("enter", Key::Enter),
    ("return", Key::Enter),
    ("escape", Key::Escape),
    ("esc", Key::Escape),
    ("backspace", Key::Backspace),
    ("delete", Key::Delete),
    ("tab", Key::Tab),
    ("space", Key::Char(' ')),
    ("plus", Key::Char('+')),
    ("minus", Key::Char('-')),
    ("comma", Key::Char(',')),
    ("period", Key::Char('.')),
    ("hash", Key::Char('#')),
];

impl Key {
    /// The key of a name: a character stands for itself; else `left`, `right`, `up`, `down`, `pageup`,
    /// `pagedown`, `home`, `end`, `enter`, `escape`, `backspace`, `delete`, `tab`, `space`, `plus`, `minus`,
    /// `comma`, `period`, `hash`, `f1` to `f12`, in small or capital letters.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let mut characters = name.chars();
        if let (Some(one), None) = (characters.next(), characters.next()) {
            return (!one.is_control()).then_some(Self::Char(one));
        }
        let name = name.to_ascii_lowercase();
        let function = name.strip_prefix('f').and_then(|n| n.parse().ok()).filter(|n| (1..=12).contains(n));
        let named = || KEYS.iter().find(|(known, _)| *known == name).map(|(_, key)| *key);
        function.map(Self::Function).or_else(named)
    }
}

impl Button {
    /// The button of a name: `left`, `middle` or `right`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "left" => Some(Self::Left),
            "middle" => Some(Self::Middle),
            "right" => Some(Self::Right),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_keys() {
        assert_eq!(Key::from_name("a"), Some(Key::Char('a')));
        assert_eq!(Key::from_name("A"), Some(Key::Char('A')));
        assert_eq!(Key::from_name("ß"), Some(Key::Char('ß')));
        assert_eq!(Key::from_name("PageUp"), Some(Key::PageUp));
        assert_eq!(Key::from_name("F12"), Some(Key::Function(12)));
        for wrong in ["", "f0", "f13", "ab", "\u{7}", "pageup "] {
            assert_eq!(Key::from_name(wrong), None, "{wrong:?}");
        }
    }
}
