//! Questions and answers on the terminal, as the programs of the time led them.

use std::io::BufRead;
use std::str::FromStr;

use crate::cli::Failure;
use crate::cli::output::{print, tell};

/// Longest line that is taken, in bytes.
const LONGEST: u64 = 4096;

/// The next line of `input` without its end; `None` when there is no more.
pub(super) fn read_line(input: &mut dyn BufRead) -> Result<Option<String>, Failure> {
    let mut bytes = Vec::new();
    let read = std::io::Read::take(&mut *input, LONGEST).read_until(b'\n', &mut bytes);
    read.map_err(|e| Failure::from_io(e.kind(), format!("standard input: {e}")))?;
    if bytes.len() as u64 == LONGEST {
        return Err(Failure::input(format!("standard input: a line is longer than {LONGEST} bytes")));
    }
    let line = String::from_utf8_lossy(&bytes).trim_end().to_owned();
    Ok((!bytes.is_empty()).then_some(line))
}

/// Asks for one thing until the answer can be read; an empty line is the suggestion.
pub(super) fn ask<T: FromStr>(
    input: &mut dyn BufRead,
    question: &str,
    suggested: &str,
) -> Result<T, Failure> {
    loop {
        print(&format!("{question} [{suggested}]: "))?;
        let answer = read_line(input)?;
        let end = answer.is_none();
        let answer = answer.filter(|line| !line.trim().is_empty()).unwrap_or_else(|| suggested.to_owned());
        match answer.trim().parse() {
            Ok(value) => return Ok(value),
            Err(_) if end => return Err(Failure::input(format!("{question}: there is no answer"))),
            Err(_) => tell(&format!("\"{}\" is no answer to that", answer.trim())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lose_their_ends() {
        let mut input = &b"a b\r\n\nlast"[..];
        let mut next = || read_line(&mut input).expect("a line");
        assert_eq!(next().as_deref(), Some("a b"));
        assert_eq!(next().as_deref(), Some(""));
        assert_eq!(next().as_deref(), Some("last"));
        assert_eq!(next(), None);
        assert!(read_line(&mut &[b'x'; 5000][..]).is_err());
    }

    #[test]
    fn questions_are_asked_again() {
        let mut input = &b"many\n\n7\n"[..];
        assert_eq!(ask::<u32>(&mut input, "steps", "4"), Ok(4));
        assert_eq!(ask::<u32>(&mut input, "steps", "4"), Ok(7));
        assert_eq!(ask::<u32>(&mut input, "steps", "4"), Ok(4));
    }
}
