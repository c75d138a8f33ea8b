//! The profile of a look-up table: colour as a function of the cosine between normal and light
//! (1991 thesis, sections 8.3 and 12.3).
//!
//! As a file, one thing a line, remarks in braces or behind `#`:
//!
//! ```text
//! background 1 1 1       {R G B; default white}
//! model hls              {rgb, the default, or hls: how colours between nodes are found}
//! node 0 0.1 0   0       {R G B, then X: the cosine}
//! node 0 1 0     1
//! ```

use std::fmt::Write;

use senca_io::{Location, ReadError};

use super::lut::{ColorModel, between};

/// Most nodes, as many as the editor has room for.
pub(super) const MAX_NODES: usize = 20;

/// A colour at a cosine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Red, green and blue, 0 to 1 as the screen shows them.
    pub rgb: [f64; 3],
    /// Cosine between normal and light, 0 to 1.
    pub x: f64,
}

/// Colours over the cosine. Nodes near x = 1 are the highlight, those near 0 the ambient light.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// At least two, with x in ascending order. Default dark green at 0 and green at 1.
    pub nodes: Vec<Node>,
    /// Colour of index 0. Default white.
    pub background: [f64; 3],
    /// How colours between nodes are found. Default red, green and blue.
    pub model: ColorModel,
}

/// What is wrong with a profile's nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// Fewer than two nodes, or more than twenty.
    #[error("{0} nodes: there must be 2 to 20")]
    Count(usize),
    /// A node stands before its predecessor.
    #[error("node {0} must not come before node {before}", before = .0 - 1)]
    Order(usize),
}

impl Default for Profile {
    fn default() -> Self {
        let nodes = vec![Node { rgb: [0.0, 0.1, 0.0], x: 0.0 }, Node { rgb: [0.0, 1.0, 0.0], x: 1.0 }];
        Self { nodes, background: [1.0; 3], model: ColorModel::Rgb }
    }
}

impl Profile {
    /// The colour at a cosine; before the first and behind the last node it is theirs.
    #[must_use]
    pub fn color(&self, x: f64) -> [f64; 3] {
        let (Some(first), Some(last)) = (self.nodes.first(), self.nodes.last()) else { return [0.0; 3] };
        let behind = self.nodes.iter().position(|node| node.x > x);
        match behind {
            Some(0) => first.rgb,
            None => last.rgb,
            Some(to) => {
                let (from, to) = (self.nodes[to - 1], self.nodes[to]);
                between(self.model, from.rgb, to.rgb, (x - from.x) / (to.x - from.x))
            }
        }
    }

    /// Whether the nodes make a profile.
    ///
    /// # Errors
    /// For a wrong number of nodes, and for nodes out of order.
    pub fn check(&self) -> Result<(), ProfileError> {
        if !(2..=MAX_NODES).contains(&self.nodes.len()) {
            return Err(ProfileError::Count(self.nodes.len()));
        }
        let wrong = self.nodes.windows(2).position(|pair| pair[1].x < pair[0].x);
        wrong.map_or(Ok(()), |before| Err(ProfileError::Order(before + 1)))
    }

    /// Reads a profile file.
    ///
    /// # Errors
    /// With line and column for words that are not known and numbers that are missing or not within
    /// 0 and 1; with the last node's line when there are too few or too many, or one is out of order.
    pub fn parse(name: &str, text: &str) -> Result<Self, ReadError> {
        let mut profile = Self { nodes: Vec::new(), ..Self::default() };
        let mut last_line = 1;
        for (line, number) in text.lines().zip(1u32..) {
            let mut words = Words { name, number, words: words(line).collect(), next: 0 };
            match words.keyword() {
                None => continue,
                Some("background") => profile.background = words.numbers(["R", "G", "B"])?,
                Some("model") => profile.model = words.model()?,
                Some("node") => {
                    let [r, g, b, x] = words.numbers(["R", "G", "B", "X"])?;
                    profile.nodes.push(Node { rgb: [r, g, b], x });
                    last_line = number;
                    let order = profile.nodes.len() > MAX_NODES
                        || profile.nodes.len() > 1 && profile.check().is_err();
                    if order {
                        return Err(profile.refused(name, number));
                    }
                }
                Some(other) => {
                    let message = format!("expected node, background or model, found \"{other}\"");
                    return Err(words.malformed(0, message));
                }
            }
            words.end()?;
        }
        match profile.check() {
            Ok(()) => Ok(profile),
            Err(_) => Err(profile.refused(name, last_line)),
        }
    }

    fn refused(&self, name: &str, line: u32) -> ReadError {
        let message = self.check().err().map(|error| error.to_string()).unwrap_or_default();
        ReadError::malformed(Location::text(name, line, 1), message)
    }

    /// The profile as a file.
    #[must_use]
    pub fn text(&self) -> String {
        let [r, g, b] = self.background;
        let mut text = format!("background {r} {g} {b}\n");
        if self.model == ColorModel::Hls {
            text += "model hls\n";
        }
        for Node { rgb: [r, g, b], x } in &self.nodes {
            let _ = writeln!(text, "node {r} {g} {b} {x}");
        }
        text
    }
}

/// Words of a line before its remark, with their columns from 1.
fn words(line: &str) -> impl Iterator<Item = (u32, &str)> {
    let text = line.split(['{', '#']).next().unwrap_or_default();
    let column = move |word: &str| {
        let before = word.as_ptr() as usize - line.as_ptr() as usize;
        line[..before].chars().count() as u32 + 1
    };
    text.split_whitespace().map(move |word| (column(word), word))
}

/// The words of a line, one by one.
struct Words<'a> {
    name: &'a str,
    number: u32,
    words: Vec<(u32, &'a str)>,
    next: usize,
}

impl<'a> Words<'a> {
    fn keyword(&mut self) -> Option<&'a str> {
        self.next = 1;
        self.words.first().map(|word| word.1)
    }

    fn malformed(&self, word: usize, message: String) -> ReadError {
        let behind = self.words.last().map_or(1, |(column, word)| column + word.chars().count() as u32);
        let column = self.words.get(word).map_or(behind, |word| word.0);
        ReadError::malformed(Location::text(self.name, self.number, column), message)
    }

    fn expected(&self, word: usize, what: &str) -> ReadError {
        let found = self.words.get(word).map_or("the end of the line".to_owned(), |w| format!("\"{}\"", w.1));
        self.malformed(word, format!("expected {what}, found {found}"))
    }

    fn numbers<const N: usize>(&mut self, names: [&str; N]) -> Result<[f64; N], ReadError> {
        let mut numbers = [0.0; N];
        for (number, name) in numbers.iter_mut().zip(names) {
            let word = self.words.get(self.next).and_then(|word| word.1.parse::<f64>().ok());
            match word.filter(|value| (0.0..=1.0).contains(value)) {
                Some(value) => *number = value,
                None => return Err(self.expected(self.next, &format!("{name}, a number from 0 to 1"))),
            }
            self.next += 1;
        }
        Ok(numbers)
    }

    fn model(&mut self) -> Result<ColorModel, ReadError> {
        let word = self.words.get(self.next).map(|word| word.1);
        self.next += 1;
        match word {
            Some("rgb") => Ok(ColorModel::Rgb),
            Some("hls") => Ok(ColorModel::Hls),
            _ => Err(self.expected(self.next - 1, "rgb or hls")),
        }
    }

    fn end(&self) -> Result<(), ReadError> {
        if self.next < self.words.len() {
            Err(self.expected(self.next, "the end of the line"))
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_survive_writing() {
        let text = "# clay\nbackground 0 0 0.2 {night}\nmodel hls\n\nnode 0.1 0.05 0 0\nnode 0.8 0.4 0.2 0.9 # x\nnode 1 1 1 1\n";
        let profile = Profile::parse("p", text).expect("reads");
        assert_eq!((profile.nodes.len(), profile.model), (3, ColorModel::Hls));
        assert_eq!(profile.nodes[1], Node { rgb: [0.8, 0.4, 0.2], x: 0.9 });
        assert_eq!(Profile::parse("p", &profile.text()).expect("reads"), profile);
        assert_eq!(Profile::parse("p", &Profile::default().text()).expect("reads"), Profile::default());
    }

    #[test]
    fn the_ends_go_on_and_steps_are_allowed() {
        let profile = Profile::parse("p", "node 0 0 0 0.2\nnode 1 0 0 0.6\nnode 0 1 0 0.6\nnode 0 1 1 0.8")
            .expect("reads");
        assert_eq!(profile.color(0.0), [0.0; 3]);
        assert!((profile.color(0.4)[0] - 0.5).abs() < 1e-12);
        assert_eq!(profile.color(0.6), [0.0, 1.0, 0.0]);
        assert_eq!(profile.color(1.0), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn errors_say_where() {
        for (text, expected) in [
            ("node 0 0 0 0\nnod 1 1 1 1", "p:2:1: expected node, background or model, found \"nod\""),
            ("node 0 0 0", "p:1:11: expected X, a number from 0 to 1, found the end of the line"),
            (" node 0 0 2 0", "p:1:11: expected B, a number from 0 to 1, found \"2\""),
            ("node 0 nan 0 0", "p:1:8: expected G, a number from 0 to 1, found \"nan\""),
            ("node 0 0 0 0 7", "p:1:14: expected the end of the line, found \"7\""),
            ("model cmy", "p:1:7: expected rgb or hls, found \"cmy\""),
            ("model", "p:1:6: expected rgb or hls, found the end of the line"),
            ("", "p:1:1: 0 nodes: there must be 2 to 20"),
            ("background 1 1 1\n\nnode 0 0 0 0", "p:3:1: 1 nodes: there must be 2 to 20"),
            ("node 0 0 0 1\nnode 0 0 0 0.5\nnode 0 0 0 1", "p:2:1: node 1 must not come before node 0"),
        ] {
            assert_eq!(Profile::parse("p", text).expect_err(text).to_string(), expected);
        }
        let many = "node 0 0 0 1\n".repeat(21);
        let error = Profile::parse("p", &many).expect_err("many").to_string();
        assert_eq!(error, "p:21:1: 21 nodes: there must be 2 to 20");
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(node|model|background|[ \\n{}#é]|[0-9.e-]{1,4}|rgb|hls|nan){0,60}") {
            match Profile::parse("p", &text) {
                Ok(profile) => {
                    proptest::prop_assert!(profile.check().is_ok());
                    proptest::prop_assert_eq!(Profile::parse("p", &profile.text()).expect("reads"), profile);
                }
                Err(error) => proptest::prop_assert!(error.to_string().starts_with("p:")),
            }
        }
    }
}
