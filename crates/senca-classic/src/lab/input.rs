//! Numbers and words of a text, each with its place.

use senca_io::Location;

use super::LabError;

/// A word of the text.
#[derive(Clone, Copy, Debug)]
struct Word<'a> {
    text: &'a str,
    line: u32,
    column: u32,
}

/// The words of a text, read one after the other. Words are parted by blanks, line ends, commas and
/// semicolons; what follows a `#` to the end of its line is a remark.
#[derive(Clone, Debug)]
pub struct Input<'a> {
    name: &'a str,
    words: Vec<Word<'a>>,
    next: usize,
    end: (u32, u32),
}

impl<'a> Input<'a> {
    /// The words of `text`, which is called `name` in messages.
    #[must_use]
    pub fn new(name: &'a str, text: &'a str) -> Self {
        let mut words = Vec::new();
        let mut end = (1, 1);
        for (i, line) in text.lines().enumerate() {
            let number = u32::try_from(i + 1).unwrap_or(u32::MAX);
            words_of(line, number, &mut words);
            end = (number, column_of(line, line.len()));
        }
        Self { name, words, next: 0, end }
    }

    /// Words that are not read yet.
    #[must_use]
    pub fn left(&self) -> usize {
        self.words.len() - self.next
    }

    /// The next word as it stands, which is to be `what`.
    ///
    /// # Errors
    /// The text is at its end.
    pub fn word(&mut self, what: &str) -> Result<&'a str, LabError> {
        let word = self.words.get(self.next);
        let word =
            word.ok_or_else(|| self.error_at(self.end, format!("the text ends, but {what} is to come")))?;
        self.next += 1;
        Ok(word.text)
    }

    /// The next word as a finite number, which is to be `what`.
    ///
    /// # Errors
    /// The text is at its end, or the word is not a number.
    pub fn number(&mut self, what: &str) -> Result<f64, LabError> {
        let word = self.word(what)?;
        match word.parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(v),
            _ => Err(self.wrong(format!("{what} is to be a number, but is '{word}'"))),
        }
    }

    /// The next word as a whole number of `range`, which is to be `what`.
    ///
    /// # Errors
    /// The text is at its end, or the word is not such a number.
    pub fn whole(&mut self, what: &str, range: std::ops::RangeInclusive<i64>) -> Result<i64, LabError> {
        let word = self.word(what)?;
        match word.parse::<i64>() {
            Ok(v) if range.contains(&v) => Ok(v),
            _ => Err(self.wrong(format!(
                "{what} is to be a whole number from {} to {}, but is '{word}'",
                range.start(),
                range.end()
            ))),
        }
    }

    /// The next `N` words as numbers, such as the coordinates of a point.
    ///
    /// # Errors
    /// As [`Input::number`].
    pub fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], LabError> {
        const NAMES: [&str; 3] = ["x", "y", "z"];
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            let coordinate = NAMES.get(i).map_or_else(|| format!("number {}", i + 1), |n| (*n).to_owned());
            *number = self.number(&format!("{coordinate} of {what}"))?;
        }
        Ok(numbers)
    }

    /// Demands that all words are read.
    ///
    /// # Errors
    /// A word is left.
    pub fn finish(&mut self) -> Result<(), LabError> {
        match self.words.get(self.next) {
            None => Ok(()),
            Some(word) => {
                self.next += 1;
                Err(self.wrong(format!("'{}' is one too many; the input is complete before it", word.text)))
            }
        }
    }

    /// An error about the word that was read last.
    #[must_use]
    pub fn wrong(&self, message: impl Into<String>) -> LabError {
        let last = self.next.checked_sub(1).and_then(|i| self.words.get(i));
        self.error_at(last.map_or(self.end, |w| (w.line, w.column)), message.into())
    }

    fn error_at(&self, (line, column): (u32, u32), message: String) -> LabError {
        LabError::Text { at: Location::text(self.name, line, column), message }
    }
}

fn words_of<'a>(line: &'a str, number: u32, words: &mut Vec<Word<'a>>) {
    let text = line.split('#').next().unwrap_or_default();
    let is_gap = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let mut from = 0;
    for part in text.split(is_gap) {
        if !part.is_empty() {
            words.push(Word { text: part, line: number, column: column_of(line, from) });
        }
        from += part.len();
        from += text[from..].chars().next().map_or(0, char::len_utf8);
    }
}

/// Column of a byte, in characters from 1.
fn column_of(line: &str, byte: usize) -> u32 {
    u32::try_from(line[..byte].chars().count() + 1).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_in_order() {
        let mut input = Input::new("a.txt", "# three\n 1, 2.5;\t-3e1 # and\nname");
        assert_eq!(input.left(), 4);
        assert_eq!(input.numbers::<3>("the point").expect("three numbers"), [1.0, 2.5, -30.0]);
        assert_eq!(input.word("a name").expect("a word"), "name");
        input.finish().expect("nothing is left");
    }

    #[test]
    fn errors_name_line_and_column() {
        let told = |text: &str| {
            let mut input = Input::new("a.txt", text);
            let read = input.numbers::<2>("the start").and_then(|_| input.finish());
            read.expect_err(text).to_string()
        };
        assert_eq!(told("1 zwei"), "a.txt:1:3: y of the start is to be a number, but is 'zwei'");
        assert_eq!(told("ä inf"), "a.txt:1:1: x of the start is to be a number, but is 'ä'");
        assert_eq!(told("\n  inf"), "a.txt:2:3: x of the start is to be a number, but is 'inf'");
        assert_eq!(told("1\n"), "a.txt:1:2: the text ends, but y of the start is to come");
        assert_eq!(told(""), "a.txt:1:1: the text ends, but x of the start is to come");
        assert_eq!(told("1 2\n 3"), "a.txt:2:2: '3' is one too many; the input is complete before it");
        let mut input = Input::new("a.txt", "1.5");
        let told = input.whole("n", 3..=9).expect_err("no whole number").to_string();
        assert_eq!(told, "a.txt:1:1: n is to be a whole number from 3 to 9, but is '1.5'");
    }
}
