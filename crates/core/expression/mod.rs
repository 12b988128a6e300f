//! Expressions over arrays, such as `sqrt(u*u + v*v) - mag(V)`: parsed to a stack machine of 64 bits.
//!
//! Precedence from low to high: + −, * /, unary −, ^ (which binds to the right: −2^2 is −4, 2^3^2 is 512). Names are letters, digits,
//! `_` and `.`, then perhaps `:` and a component (`V:X`, `V:0`); any other name stands in quotes ('mass fraction').
//!
//! It is read here and not by a crate: of exmex, fasteval, meval and mathexpr no error has a place, and evalexpr's licence is the AGPL.

mod dimensions;
mod units;

pub use units::Dimension;

use crate::Error;
use crate::field::Derivative;
use std::ops::Range;

/// Result of reading, or an error with the bytes where it is.
pub type Parsed<T = ()> = Result<T, (Error, Range<usize>)>;

/// Function of one number.
type Unary = fn(f64) -> f64;

/// Function of two numbers.
type Binary = fn(f64, f64) -> f64;

/// A parsed expression.
#[derive(Debug, Clone)]
pub struct Expression {
    /// Arrays that it names, each once.
    pub arrays: Vec<NamedArray>,
    steps: Vec<Step>,
    /// Law of dimensions of each step, and its bytes of the expression.
    laws: Vec<(Law, Range<usize>)>,
}

/// An array of an expression.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedArray {
    /// Its name, as a reader takes it: `u`, `V:X`, `V:magnitude`.
    pub name: String,
    /// Quantity made of its gradients, in place of its values.
    pub derivative: Option<Derivative>,
    /// Bytes of the expression where it stands first.
    pub span: Range<usize>,
}

/// A step of the stack machine.
#[derive(Debug, Clone, Copy)]
enum Step {
    Number(f64),
    Array(usize),
    One(Unary),
    Two(Binary),
}

/// Dimension of a step's result, and those that its arguments may have.
#[derive(Debug, Clone, Copy)]
enum Law {
    /// A number or an array: its own.
    Own,
    /// That of the argument, to this power.
    Power(f64),
    /// A pure number of a pure number.
    Pure,
    /// That of two arguments of one dimension.
    Alike,
    /// A pure number of two arguments of one dimension.
    Ratio,
    /// That of the first times that of the second to this power.
    Product(f64),
    /// That of the first to the power that the second is.
    Raised,
}

const UNARY_FUNCTIONS: &[(&str, Unary, Law)] = &[
    ("abs", f64::abs, Law::Power(1.0)),
    ("sqrt", f64::sqrt, Law::Power(0.5)),
    ("cbrt", libm::cbrt, Law::Power(1.0 / 3.0)),
    ("exp", libm::exp, Law::Pure),
    ("ln", libm::log, Law::Pure),
    ("log10", libm::log10, Law::Pure),
    ("sin", libm::sin, Law::Pure),
    ("cos", libm::cos, Law::Pure),
    ("tan", libm::tan, Law::Pure),
    ("asin", libm::asin, Law::Pure),
    ("acos", libm::acos, Law::Pure),
    ("atan", libm::atan, Law::Pure),
    ("sinh", libm::sinh, Law::Pure),
    ("cosh", libm::cosh, Law::Pure),
    ("tanh", libm::tanh, Law::Pure),
    ("floor", f64::floor, Law::Power(1.0)),
    ("ceil", f64::ceil, Law::Power(1.0)),
];

const BINARY_FUNCTIONS: &[(&str, Binary, Law)] = &[
    ("min", least, Law::Alike),
    ("max", greatest, Law::Alike),
    ("atan2", libm::atan2, Law::Ratio),
    ("pow", libm::pow, Law::Raised),
];

/// Not a number where one of the two is none, other than `f64::min`.
fn least(a: f64, b: f64) -> f64 {
    if b < a || b.is_nan() { b } else { a }
}

fn greatest(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Length of a vector array.
const MAGNITUDE: &str = "mag";

/// Deepest nesting: far beyond what is written by hand, far within the stack.
const DEEPEST: usize = 200;

impl Expression {
    /// Reads an expression.
    ///
    /// # Errors
    /// - one that is not well formed, with the bytes where it is not.
    pub fn parse(text: &str) -> Parsed<Expression> {
        let expression = Expression { arrays: Vec::new(), steps: Vec::new(), laws: Vec::new() };
        let mut parser = Parser { text, at: 0, depth: 0, expression };
        parser.sum().and_then(|()| match parser.peek() {
            None => Ok(()),
            Some(_) => Err(parser.unexpected("an operator + - * / ^, or the end")),
        })?;
        Ok(parser.expression)
    }

    /// Value for one value of each array, in their order. `stack`: cleared, and kept for the next call.
    pub fn value(&self, of: impl Fn(usize) -> f64, stack: &mut Vec<f64>) -> f64 {
        stack.clear();
        for step in &self.steps {
            let mut pop = || stack.pop().unwrap_or(f64::NAN);
            let value = match *step {
                Step::Number(value) => value,
                Step::Array(array) => of(array),
                Step::One(function) => function(pop()),
                Step::Two(function) => {
                    let b = pop();
                    function(pop(), b)
                }
            };
            stack.push(value);
        }
        stack.pop().unwrap_or(f64::NAN)
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Byte that is read next.
    at: usize,
    depth: usize,
    expression: Expression,
}

impl<'a> Parser<'a> {
    /// The next character behind spaces.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Takes the character if it comes next.
    fn takes(&mut self, wanted: char) -> bool {
        let is_next = self.peek() == Some(wanted);
        self.at += if is_next { wanted.len_utf8() } else { 0 };
        is_next
    }

    /// The longest run of such characters.
    fn run(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        let run = &rest[..rest.find(|c| !belongs(c)).unwrap_or(rest.len())];
        self.at += run.len();
        run
    }

    fn unexpected(&mut self, accepted: &str) -> (Error, Range<usize>) {
        let error = Error::usage("the expression cannot be read").expected(accepted);
        match self.peek() {
            Some(found) => {
                let place = self.text[..self.at].chars().count() + 1;
                let found_there = format!("'{found}' at character {place}");
                (error.got(found_there), self.at..self.at + found.len_utf8())
            }
            None => (error.got("its end"), self.at..self.at),
        }
    }

    fn push(&mut self, step: Step, law: Law, span: Range<usize>) {
        self.expression.steps.push(step);
        self.expression.laws.push((law, span));
    }

    /// Takes the operator if it comes next; its bytes.
    fn operator(&mut self, wanted: char) -> Option<Range<usize>> {
        self.takes(wanted).then(|| self.at - wanted.len_utf8()..self.at)
    }

    fn sum(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.unexpected(&format!("an expression of {DEEPEST} levels at most")));
        }
        self.product()?;
        loop {
            if let Some(span) = self.operator('+') {
                self.product()?;
                self.push(Step::Two(|a, b| a + b), Law::Alike, span);
            } else if let Some(span) = self.operator('-') {
                self.product()?;
                self.push(Step::Two(|a, b| a - b), Law::Alike, span);
            } else {
                self.depth -= 1;
                return Ok(());
            }
        }
    }

    fn product(&mut self) -> Parsed {
        self.signed()?;
        loop {
            if let Some(span) = self.operator('*') {
                self.signed()?;
                self.push(Step::Two(|a, b| a * b), Law::Product(1.0), span);
            } else if let Some(span) = self.operator('/') {
                self.signed()?;
                self.push(Step::Two(|a, b| a / b), Law::Product(-1.0), span);
            } else {
                return Ok(());
            }
        }
    }

    /// A power behind its signs.
    fn signed(&mut self) -> Parsed {
        let mut is_negative = false;
        let start = (self.peek(), self.at).1;
        while self.peek().is_some_and(|c| c == '-' || c == '+') {
            is_negative ^= self.takes('-') || !self.takes('+');
        }
        self.atom()?;
        if let Some(span) = self.operator('^') {
            self.depth += 1;
            if self.depth > DEEPEST {
                return Err(self.unexpected(&format!("an expression of {DEEPEST} levels at most")));
            }
            self.signed()?;
            self.depth -= 1;
            self.push(Step::Two(libm::pow), Law::Raised, span);
        }
        if is_negative {
            self.push(Step::One(|a| -a), Law::Power(1.0), start..start + 1);
        }
        Ok(())
    }

    fn atom(&mut self) -> Parsed {
        const ACCEPTED: &str = "a number, an array, a function or '('";
        match self.peek() {
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.closed()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if is_quote(c) || c.is_alphabetic() || c == '_' => {
                let start = self.at;
                let name = self.name()?;
                match self.peek() {
                    Some('(') if !is_quote(c) => self.call(&name, start),
                    _ if name == "pi" && !is_quote(c) => {
                        self.push(Step::Number(std::f64::consts::PI), Law::Own, start..self.at);
                        Ok(())
                    }
                    _ => {
                        self.array(name, None, start);
                        Ok(())
                    }
                }
            }
            _ => Err(self.unexpected(ACCEPTED)),
        }
    }

    fn closed(&mut self) -> Parsed {
        if self.takes(')') { Ok(()) } else { Err(self.unexpected("')', or an operator + - * / ^")) }
    }

    fn number(&mut self) -> Parsed {
        let start = self.at;
        self.run(|c| c.is_ascii_digit() || c == '.');
        let mantissa_end = self.at;
        let rest = &self.text[self.at..];
        if rest.starts_with(['e', 'E']) {
            self.at += 1;
            if self.text[self.at..].starts_with(['+', '-']) {
                self.at += 1;
            }
            if self.run(|c| c.is_ascii_digit()).is_empty() {
                self.at = mantissa_end;
            }
        }
        let text = &self.text[start..self.at];
        let Some(number) = text.parse().ok().filter(|number: &f64| number.is_finite()) else {
            let error = Error::usage("the expression holds a number that is none");
            return Err((error.got(text).expected("a number such as 2.5 or 1e-3"), start..self.at));
        };
        self.push(Step::Number(number), Law::Own, start..self.at);
        Ok(())
    }

    /// The name of an array with its component, or of a function.
    fn name(&mut self) -> Parsed<String> {
        let plain = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let mut name = match self.peek() {
            Some(quote) if is_quote(quote) => {
                let start = self.at;
                self.at += 1;
                let name = self.run(|c| c != quote).to_string();
                if !self.text[self.at..].starts_with(quote) || name.is_empty() {
                    let error =
                        Error::usage("a name in quotes is empty or has no end").got(&self.text[start..]);
                    return Err((error.expected("a closing quote"), start..self.at));
                }
                self.at += 1;
                name
            }
            _ => self.run(plain).to_string(),
        };
        if self.text[self.at..].starts_with(':') {
            self.at += 1;
            name = format!("{name}:{}", self.run(plain));
        }
        Ok(name)
    }

    fn array(&mut self, name: String, derivative: Option<Derivative>, start: usize) {
        let is_it = |array: &NamedArray| array.name == name && array.derivative == derivative;
        let known = self.expression.arrays.iter().position(is_it);
        // Without the spaces that were passed over to look at what follows.
        let span = start..start + self.text[start..self.at].trim_end().len();
        let number = known.unwrap_or_else(|| {
            self.expression.arrays.push(NamedArray { name, derivative, span: span.clone() });
            self.expression.arrays.len() - 1
        });
        self.push(Step::Array(number), Law::Own, span);
    }

    fn call(&mut self, name: &str, start: usize) -> Parsed {
        let span = start..self.at;
        self.takes('(');
        let derivative = Derivative::ALL.into_iter().find(|of| of.0 == name).map(|of| of.1);
        if name == MAGNITUDE || derivative.is_some() {
            let start = (self.peek(), self.at).1;
            let is_name = self.peek().is_some_and(|c| is_quote(c) || c.is_alphabetic() || c == '_');
            let array = if is_name { self.name()? } else { String::new() };
            if array.is_empty() || self.peek() != Some(')') {
                return Err(self.unexpected(&format!("the name of an array alone, as in {name}(V)")));
            }
            match derivative {
                None => self.array(format!("{array}:magnitude"), None, start),
                derivative => self.array(array, derivative, start),
            }
            self.closed()?;
            if let Some((_, whole)) = self.expression.laws.last_mut() {
                *whole = span.start..self.at;
            }
            return Ok(());
        }
        let (one, two) =
            (UNARY_FUNCTIONS.iter().find(|of| of.0 == name), BINARY_FUNCTIONS.iter().find(|of| of.0 == name));
        if one.is_none() && two.is_none() {
            let of_numbers =
                UNARY_FUNCTIONS.iter().map(|of| of.0).chain(BINARY_FUNCTIONS.iter().map(|of| of.0));
            let names = of_numbers.chain([MAGNITUDE]).chain(Derivative::ALL.iter().map(|of| of.0));
            let error = Error::usage("the expression calls a function that is not known").got(name);
            return Err((error.not_among(name, names), span));
        }
        self.sum()?;
        if two.is_some() {
            if !self.takes(',') {
                return Err(self.unexpected(&format!("',' and a second argument of {name}")));
            }
            self.sum()?;
        }
        self.closed()?;
        let span = start..self.at;
        if let Some((_, function, law)) = two {
            self.push(Step::Two(*function), *law, span.clone());
        }
        if let Some((_, function, law)) = one {
            self.push(Step::One(*function), *law, span);
        }
        Ok(())
    }
}

fn is_quote(c: char) -> bool {
    c == '\'' || c == '"'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let expression = Expression::parse(text).unwrap_or_else(|(error, _)| panic!("{text}: {error}"));
        let of = |i: usize| match expression.arrays[i].name.as_str() {
            "u" => 3.0,
            "v" => -4.0,
            "V:X" => 5.0,
            "V:magnitude" => 7.0,
            "mass fraction:0" => 11.0,
            "pi" => 13.0,
            other => panic!("{other}"),
        };
        expression.value(of, &mut Vec::new())
    }

    #[test]
    fn values_are_those_of_the_usual_notation() {
        for (text, right) in [
            ("sqrt(u*u+v*v)", 5.0),
            ("1 - 2 - 3", -4.0),
            ("2 + 3 * 4", 14.0),
            ("12 / 3 / 2", 2.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("--3", 3.0),
            ("-+-u", 3.0),
            ("2*-u", -6.0),
            ("(1 + 2) * 3", 9.0),
            ("V:X + mag(V)", 12.0),
            ("'mass fraction':0 + mag( 'V' )", 18.0),
            ("1.5e1 + .5", 15.5),
            ("max(u, v) - min(u, v)", 7.0),
            ("atan2(1, 1) * 4 - pi", 0.0),
            ("pow(u, 2) + 'pi'", 22.0),
            ("ln(exp(2)) + log10(100) + abs(v)", 8.0),
            ("floor(2.5) + ceil(2.5)", 5.0),
        ] {
            assert!((value(text) - right).abs() < 1e-14, "{text}: {}", value(text));
        }
        assert!(value("max(0/0, 1)").is_nan() && value("min(1, 0/0)").is_nan());
    }

    #[test]
    fn mistakes_are_pointed_at() {
        for (text, place, accepted) in [
            ("", 0..0, "a number"),
            ("u +", 3..3, "a number"),
            ("u + * v", 4..5, "a number"),
            ("sqrt(u", 6..6, "')'"),
            ("sqrt u", 5..6, "an operator"),
            ("(u", 2..2, "')'"),
            ("u)", 1..2, "an operator"),
            ("2 u", 2..3, "an operator"),
            ("sqr(u)", 0..3, "'sqrt', the nearest name"),
            ("max(u)", 5..6, "','"),
            ("sqrt(u, v)", 6..7, "')'"),
            ("mag(u + v)", 6..7, "mag(V)"),
            ("mag()", 4..5, "mag(V)"),
            ("vorticity(2*V)", 10..11, "vorticity(V)"),
            ("vorticty(V)", 0..8, "'vorticity', the nearest name"),
            ("1.2.3", 0..5, "a number"),
            ("1e999", 0..5, "a number"),
            ("'u", 0..2, "closing quote"),
            ("u § v", 2..4, "an operator"),
        ] {
            let (error, span) = Expression::parse(text).unwrap_err();
            assert_eq!(span, place, "{text}: {error}");
            assert!(error.expected.as_deref().is_some_and(|said| said.contains(accepted)), "{text}: {error}");
        }
        Expression::parse(&"(".repeat(100_000)).unwrap_err();
        Expression::parse(&"2^".repeat(100_000)).unwrap_err();
        Expression::parse(&"-".repeat(100_000)).unwrap_err();
    }
}
