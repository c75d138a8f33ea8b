//! From operations back to text.

use std::fmt;

use super::parse::name_of;
use super::{Expression, Op};

/// How tightly the outermost operation of a text binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Sign,
    Power,
    Operand,
}

struct Text {
    text: String,
    binding: Binding,
}

impl Text {
    /// The text, in parentheses where it binds less tightly than `least`.
    fn at_least(self, least: Binding) -> String {
        if self.binding >= least { self.text } else { format!("({})", self.text) }
    }
}

fn number(x: f64) -> Text {
    let magnitude = x.abs();
    let plain = magnitude == 0.0 || (1e-5..1e15).contains(&magnitude);
    let text = if plain { format!("{x}") } else { format!("{x:e}") };
    Text { text, binding: if x.is_sign_negative() { Binding::Sign } else { Binding::Operand } }
}

/// A left-associative operation: the left side grows in place.
fn joined(a: Text, sign: &str, b: Text, binding: Binding, right: Binding) -> Text {
    let mut text = a.at_least(binding);
    text.push_str(sign);
    text.push_str(&b.at_least(right));
    Text { text, binding }
}

fn call(name: &str, arguments: &[&str]) -> Text {
    Text { text: format!("{name}({})", arguments.join(", ")), binding: Binding::Operand }
}

fn of_two(op: Op, a: Text, b: Text) -> Text {
    match op {
        Op::Add => joined(a, " + ", b, Binding::Sum, Binding::Product),
        Op::Sub => joined(a, " - ", b, Binding::Sum, Binding::Product),
        Op::Mul => joined(a, " * ", b, Binding::Product, Binding::Sign),
        Op::Div => joined(a, " / ", b, Binding::Product, Binding::Sign),
        Op::Pow => power(a, b),
        Op::Atan2 => call("atan2", &[&a.text, &b.text]),
        Op::Min => call("min", &[&a.text, &b.text]),
        _ => call("max", &[&a.text, &b.text]),
    }
}

fn power(base: Text, exponent: Text) -> Text {
    let text = format!("{}^{}", base.at_least(Binding::Operand), exponent.at_least(Binding::Sign));
    Text { text, binding: Binding::Power }
}

fn of_one(op: Op, a: Text) -> Text {
    match op {
        Op::Neg => Text { text: format!("-{}", a.at_least(Binding::Power)), binding: Binding::Sign },
        Op::PowInteger(n) => power(a, number(f64::from(n))),
        Op::Call(function) => call(name_of(function), &[&a.text]),
        _ => a,
    }
}

impl fmt::Display for Expression {
    /// A text that reads as the same formula, with constant parts worked out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut stack: Vec<Text> = Vec::new();
        for &op in &self.ops {
            let text = match op {
                Op::Number(x) => number(x),
                Op::Variable(i) => Text { text: ["x", "y", "z"][i].to_owned(), binding: Binding::Operand },
                _ => {
                    let second = if op.arguments() == 2 { stack.pop() } else { None };
                    match (stack.pop(), second) {
                        (Some(a), Some(b)) => of_two(op, a, b),
                        (Some(a), None) => of_one(op, a),
                        (None, _) => continue,
                    }
                }
            };
            stack.push(text);
        }
        stack.first().map_or(Ok(()), |text| f.write_str(&text.text))
    }
}
