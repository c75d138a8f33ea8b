//! From text to operations, by recursive descent of bounded depth.

use std::f64::consts;

use super::arithmetic::{Arithmetic, Function};
use super::{MAX_LENGTH, MAX_NESTING, Op};

/// Why a text is no formula. Columns count characters from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionError {
    /// Something else was expected.
    #[error("column {column}: expected {expected}, but found {found}")]
    Syntax {
        /// Where.
        column: usize,
        /// What would have been right.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A name that means nothing.
    #[error(
        "column {column}: unknown name \"{name}\". Known are x, y, z, pi, e, and the functions sin, cos, \
         tan, asin, acos, atan, atan2, sinh, cosh, tanh, exp, log, sqrt, abs, pow, min, max"
    )]
    UnknownName {
        /// Where.
        column: usize,
        /// The name.
        name: String,
    },
    /// A function has the wrong number of arguments.
    #[error("column {column}: {function} takes {expected}, but has {given}")]
    Arguments {
        /// Where.
        column: usize,
        /// The function.
        function: &'static str,
        /// How many it takes.
        expected: &'static str,
        /// How many it was given.
        given: usize,
    },
    /// A number that `f64` cannot hold.
    #[error("column {column}: the number {text} is too large")]
    Number {
        /// Where.
        column: usize,
        /// The number as it was written.
        text: String,
    },
    /// Parentheses or exponents nest too deeply.
    #[error("column {column}: nested deeper than {MAX_NESTING} levels")]
    TooDeep {
        /// Where.
        column: usize,
    },
    /// The text is too long.
    #[error("the formula has {length} bytes, more than the limit of {MAX_LENGTH}")]
    TooLong {
        /// Its length in bytes.
        length: usize,
    },
}

impl ExpressionError {
    /// Column of the mistake in characters from 1; 1 when it is about the whole formula.
    #[must_use]
    pub fn column(&self) -> usize {
        match self {
            Self::Syntax { column, .. }
            | Self::UnknownName { column, .. }
            | Self::Arguments { column, .. }
            | Self::Number { column, .. }
            | Self::TooDeep { column } => *column,
            Self::TooLong { .. } => 1,
        }
    }
}

type Parsed = Result<(), ExpressionError>;

/// What a function's name stands for.
#[derive(Clone, Copy)]
enum Callee {
    One(Function),
    Two(Op),
    Many(Op),
}

const FUNCTIONS: [(&str, Callee); 17] = [
    ("sin", Callee::One(Function::Sin)),
    ("cos", Callee::One(Function::Cos)),
    ("tan", Callee::One(Function::Tan)),
    ("asin", Callee::One(Function::Asin)),
    ("acos", Callee::One(Function::Acos)),
    ("atan", Callee::One(Function::Atan)),
    ("sinh", Callee::One(Function::Sinh)),
    ("cosh", Callee::One(Function::Cosh)),
    ("tanh", Callee::One(Function::Tanh)),
    ("exp", Callee::One(Function::Exp)),
    ("log", Callee::One(Function::Log)),
    ("sqrt", Callee::One(Function::Sqrt)),
    ("abs", Callee::One(Function::Abs)),
    ("atan2", Callee::Two(Op::Atan2)),
    ("pow", Callee::Two(Op::Pow)),
    ("min", Callee::Many(Op::Min)),
    ("max", Callee::Many(Op::Max)),
];

/// Name of a function of one argument.
pub(super) fn name_of(function: Function) -> &'static str {
    let named = FUNCTIONS.iter().find(|(_, callee)| matches!(callee, Callee::One(f) if *f == function));
    named.map_or("", |(name, _)| name)
}

/// The operations of a formula.
pub(super) fn parse(text: &str) -> Result<Vec<Op>, ExpressionError> {
    if text.len() > MAX_LENGTH {
        return Err(ExpressionError::TooLong { length: text.len() });
    }
    let mut parser = Parser { text, at: 0, nesting: 0, ops: Vec::new() };
    parser.sum()?;
    if parser.peek().is_some() {
        return Err(parser.unexpected("an operator or the end"));
    }
    Ok(parser.ops)
}

struct Parser<'t> {
    text: &'t str,
    /// Byte that comes next.
    at: usize,
    nesting: usize,
    ops: Vec<Op>,
}

impl<'t> Parser<'t> {
    /// The next character that is not white space.
    fn peek(&mut self) -> Option<char> {
        let rest = self.text[self.at..].trim_start();
        self.at = self.text.len() - rest.len();
        rest.chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    fn column_at(&self, at: usize) -> usize {
        self.text[..at].chars().count() + 1
    }

    fn column(&self) -> usize {
        self.column_at(self.at)
    }

    fn unexpected(&mut self, expected: &str) -> ExpressionError {
        let found = self.peek().map_or_else(|| "the end".to_owned(), |c| format!("\"{c}\""));
        ExpressionError::Syntax { column: self.column(), expected: expected.to_owned(), found }
    }

    fn expect(&mut self, wanted: char, expected: &str) -> Parsed {
        if self.take(wanted) { Ok(()) } else { Err(self.unexpected(expected)) }
    }

    /// Runs `inner` one level deeper.
    fn nested(&mut self, inner: impl FnOnce(&mut Self) -> Parsed) -> Parsed {
        if self.nesting == MAX_NESTING {
            return Err(ExpressionError::TooDeep { column: self.column() });
        }
        self.nesting += 1;
        inner(self)?;
        self.nesting -= 1;
        Ok(())
    }

    fn sum(&mut self) -> Parsed {
        self.product()?;
        loop {
            let op = match self.peek() {
                Some('+') => Op::Add,
                Some('-') => Op::Sub,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.emit(op);
        }
    }

    fn product(&mut self) -> Parsed {
        self.sign()?;
        loop {
            let op = match self.peek() {
                Some('*') => Op::Mul,
                Some('/') => Op::Div,
                _ => return Ok(()),
            };
            self.at += 1;
            self.sign()?;
            self.emit(op);
        }
    }

    fn sign(&mut self) -> Parsed {
        let mut negative = false;
        while let Some(c @ ('+' | '-')) = self.peek() {
            self.at += 1;
            negative ^= c == '-';
        }
        self.power()?;
        if negative {
            self.emit(Op::Neg);
        }
        Ok(())
    }

    fn power(&mut self) -> Parsed {
        self.operand()?;
        if self.take('^') {
            self.nested(Self::sign)?;
            self.emit(Op::Pow);
        }
        Ok(())
    }

    fn operand(&mut self) -> Parsed {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.nested(Self::sum)?;
                self.expect(')', "an operator or \")\"")
            }
            Some('0'..='9' | '.') => self.number(),
            Some(c) if c.is_ascii_alphabetic() || c == '_' => self.name(),
            _ => Err(self.unexpected("a number, x, y, z, a function or \"(\"")),
        }
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(u8::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let mut end = digits(start);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            // Only with digits behind: "2e" is 2 and a name.
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            end = if exponent > end + 1 + sign { exponent } else { end };
        }
        let text = &self.text[start..end];
        let number: f64 = text.parse().map_err(|_| self.unexpected("a number"))?;
        if number.is_infinite() {
            return Err(ExpressionError::Number { column: self.column_at(start), text: text.to_owned() });
        }
        self.at = end;
        self.ops.push(Op::Number(number));
        Ok(())
    }

    fn name(&mut self) -> Parsed {
        let rest = &self.text[self.at..];
        let length = rest.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count();
        let (name, column) = (&rest[..length], self.column());
        let op = match name {
            "x" => Op::Variable(0),
            "y" => Op::Variable(1),
            "z" => Op::Variable(2),
            "pi" => Op::Number(consts::PI),
            "e" => Op::Number(consts::E),
            _ => return self.call(name, column),
        };
        self.at += length;
        self.ops.push(op);
        Ok(())
    }

    fn call(&mut self, name: &'t str, column: usize) -> Parsed {
        let Some(&(function, callee)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            return Err(ExpressionError::UnknownName { column, name: name.to_owned() });
        };
        self.at += name.len();
        self.expect('(', &format!("\"(\" after {function}"))?;
        let mut given = 0;
        self.nested(|parser| {
            loop {
                parser.sum()?;
                given += 1;
                if let (Callee::Many(op), 2..) = (callee, given) {
                    parser.emit(op);
                }
                if !parser.take(',') {
                    return Ok(());
                }
            }
        })?;
        self.expect(')', "an operator, \",\" or \")\"")?;
        let wrong = |expected| Err(ExpressionError::Arguments { column, function, expected, given });
        match (callee, given) {
            (Callee::One(f), 1) => self.emit(Op::Call(f)),
            (Callee::Two(op), 2) => self.emit(op),
            (Callee::Many(_), 2..) => {}
            (Callee::One(_), _) => return wrong("one argument"),
            (Callee::Two(_), _) => return wrong("two arguments"),
            (Callee::Many(_), _) => return wrong("two arguments or more"),
        }
        Ok(())
    }

    /// Appends an operation, or works it out at once when all of its arguments are numbers.
    fn emit(&mut self, op: Op) {
        let op = self.with_whole_exponent(op);
        let arguments = op.arguments();
        let first = self.ops.len() - arguments;
        let result = match self.ops[first..] {
            [Op::Number(a)] => of_one(op, a),
            [Op::Number(a), Op::Number(b)] => Some(op.of_two(a, b)),
            _ => None,
        };
        match result.filter(|x| x.is_finite()) {
            Some(x) => {
                self.ops.truncate(first);
                self.ops.push(Op::Number(x));
            }
            None => self.ops.push(op),
        }
    }

    /// Turns a power with a whole constant exponent into one that holds for all bases.
    fn with_whole_exponent(&mut self, op: Op) -> Op {
        match (op, self.ops.last()) {
            (Op::Pow, Some(&Op::Number(n))) if n.fract() == 0.0 && n.abs() <= 1e4 => {
                self.ops.pop();
                Op::PowInteger(n as i32)
            }
            _ => op,
        }
    }
}

/// The result of an operation with one argument.
fn of_one(op: Op, a: f64) -> Option<f64> {
    match op {
        Op::Neg => Some(-a),
        Op::PowInteger(n) => Some(Arithmetic::powi(a, n)),
        Op::Call(function) => Some(a.call(function)),
        _ => None,
    }
}
