//! The programs of the books as their readers know them: small, literal, readable.
//!
//! They are the museum and the school of the house. Each follows its text step by step, with the
//! numbers the text prints as tests, and the fast rooms are tested against some of them.
//!
//! Everything here is display-referred, as it was then: a colour is what the screen shows.

pub mod game;
pub mod lab;
pub mod polygon;
pub mod thesis;
