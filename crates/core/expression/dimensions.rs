//! Dimension of an expression's result, by the units of its arrays: sums are of like units, exponents and the arguments of `exp`, `ln`
//! and the angles are pure numbers. A number takes the unit of what it is added to or compared with, and is pure elsewhere.

use super::{Dimension, Expression, Law, Parsed, Step};
use crate::Error;
use crate::field::Derivative;
use std::ops::Range;

/// Dimension of a part of an expression.
#[derive(Debug, Clone, Copy)]
enum PartUnit {
    /// An array without a unit is in it: it agrees with anything.
    Open,
    /// It is made of numbers alone, and has this value.
    Constant(f64),
    /// It has this dimension.
    Fixed(Dimension),
}

/// A part of an expression, with its bytes.
#[derive(Debug, Clone)]
struct Part {
    unit: PartUnit,
    span: Range<usize>,
}

impl PartUnit {
    /// The dimension where it stands in a product or as an argument; none where it is not known.
    fn dimension(self) -> Option<Dimension> {
        match self {
            PartUnit::Open => None,
            PartUnit::Constant(_) => Some(Dimension::default()),
            PartUnit::Fixed(unit) => Some(unit),
        }
    }

    fn known(unit: Option<Dimension>) -> PartUnit {
        unit.map_or(PartUnit::Open, PartUnit::Fixed)
    }
}

impl Expression {
    /// Dimension of the result; none where arrays without a unit leave it open, or there is no array. `text`: the expression's.
    /// `unit_of`: unit of the values of an array of this name. `length`: unit of the coordinates, for gradients.
    ///
    /// # Errors
    /// - units that do not agree, with the bytes of the operator or of the argument.
    pub fn dimension(
        &self,
        text: &str,
        unit_of: impl Fn(&str) -> Option<Dimension>,
        length: Option<Dimension>,
    ) -> Parsed<Option<Dimension>> {
        let mut stack: Vec<Part> = Vec::new();
        for (step, (law, span)) in self.steps.iter().zip(&self.laws) {
            let part = match *step {
                Step::Number(value) => Part { unit: PartUnit::Constant(value), span: span.clone() },
                Step::Array(array) => {
                    let array = &self.arrays[array];
                    let unit = unit_of(&array.name);
                    let known = match array.derivative {
                        None => unit,
                        Some(derivative) => unit.zip(length).map(|of| dimension_of(derivative, of)),
                    };
                    Part { unit: PartUnit::known(known), span: span.clone() }
                }
                Step::One(function) => {
                    let a = popped(&mut stack);
                    let unit = match a.unit {
                        PartUnit::Constant(value) => PartUnit::Constant(function(value)),
                        _ => law.of_one(text, span, &a)?,
                    };
                    Part { unit, span: hull(span, &a.span) }
                }
                Step::Two(function) => {
                    let (b, a) = (popped(&mut stack), popped(&mut stack));
                    let unit = match (a.unit, b.unit) {
                        (PartUnit::Constant(a), PartUnit::Constant(b)) => PartUnit::Constant(function(a, b)),
                        _ => law.of_two(text, span, &a, &b)?,
                    };
                    Part { unit, span: hull(&hull(&a.span, span), &b.span) }
                }
            };
            stack.push(part);
        }
        Ok(match popped(&mut stack).unit {
            PartUnit::Fixed(unit) => Some(unit),
            PartUnit::Open | PartUnit::Constant(_) => None,
        })
    }
}

/// The last part; a parsed expression has one for each argument.
fn popped(stack: &mut Vec<Part>) -> Part {
    stack.pop().unwrap_or(Part { unit: PartUnit::Open, span: 0..0 })
}

fn hull(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    a.start.min(b.start)..a.end.max(b.end)
}

fn dimension_of(derivative: Derivative, (unit, length): (Dimension, Dimension)) -> Dimension {
    let gradient = unit.times(length, -1.0);
    match derivative {
        Derivative::GradientMagnitude | Derivative::Vorticity | Derivative::Divergence => gradient,
        Derivative::QCriterion => gradient.raised(2.0),
    }
}

/// A part in words: "'p*2' in kg/(m s^2)".
fn words(text: &str, part: &Part) -> String {
    let own = text[part.span.clone()].trim();
    match part.unit {
        PartUnit::Fixed(unit) if unit.is_none() => format!("'{own}', a pure number"),
        PartUnit::Fixed(unit) => format!("'{own}' in {unit}"),
        PartUnit::Open | PartUnit::Constant(_) => format!("'{own}'"),
    }
}

/// Name of an operator or of a function that is called.
fn name<'a>(text: &'a str, span: &Range<usize>) -> &'a str {
    text[span.clone()].split('(').next().unwrap_or_default().trim()
}

fn refuse_unit(text: &str, what: impl Into<String>, argument: &Part) -> Parsed {
    if argument.unit.dimension().is_none_or(Dimension::is_none) {
        return Ok(());
    }
    let error = Error::usage(what).got(words(text, argument));
    Err((error.expected("a pure number, such as a quotient of two of one unit"), argument.span.clone()))
}

impl Law {
    fn of_one(self, text: &str, span: &Range<usize>, a: &Part) -> Parsed<PartUnit> {
        match self {
            Law::Power(power) => Ok(PartUnit::known(a.unit.dimension().map(|unit| unit.raised(power)))),
            _ => {
                refuse_unit(text, format!("'{}' takes a pure number", name(text, span)), a)?;
                Ok(PartUnit::Fixed(Dimension::default()))
            }
        }
    }

    fn of_two(self, text: &str, span: &Range<usize>, a: &Part, b: &Part) -> Parsed<PartUnit> {
        match self {
            Law::Product(power) => {
                let units = a.unit.dimension().zip(b.unit.dimension());
                Ok(PartUnit::known(units.map(|(a, b)| a.times(b, power))))
            }
            Law::Raised => raised(text, a, b),
            _ => {
                let alike = alike(text, span, a, b)?;
                Ok(if matches!(self, Law::Ratio) { PartUnit::Fixed(Dimension::default()) } else { alike })
            }
        }
    }
}

/// The unit that two parts of one dimension share.
fn alike(text: &str, span: &Range<usize>, a: &Part, b: &Part) -> Parsed<PartUnit> {
    match (a.unit, b.unit) {
        (PartUnit::Fixed(one), PartUnit::Fixed(other)) if !one.is_like(other) => {
            let error = Error::usage(format!("'{}' is of unlike units", name(text, span)));
            let found = format!("{} and {}", words(text, a), words(text, b));
            Err((error.got(found).expected("both of one dimension"), span.clone()))
        }
        (PartUnit::Fixed(unit), _) | (_, PartUnit::Fixed(unit)) => Ok(PartUnit::Fixed(unit)),
        _ => Ok(PartUnit::Open),
    }
}

fn raised(text: &str, base: &Part, exponent: &Part) -> Parsed<PartUnit> {
    refuse_unit(text, "an exponent has a unit", exponent)?;
    match (base.unit, exponent.unit) {
        (PartUnit::Open, _) => Ok(PartUnit::Open),
        (PartUnit::Fixed(unit), PartUnit::Constant(power)) => Ok(PartUnit::Fixed(unit.raised(power))),
        (PartUnit::Fixed(unit), _) if !unit.is_none() => {
            let error = Error::usage("the power of a quantity with a unit varies");
            let error = error.got(format!("{} to the power {}", words(text, base), words(text, exponent)));
            Err((
                error.expected("an exponent of numbers alone, or a base without a unit"),
                exponent.span.clone(),
            ))
        }
        _ => Ok(PartUnit::Fixed(Dimension::default())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dimension(text: &str) -> Parsed<Option<Dimension>> {
        let unit = |text: &str| Dimension::parse(text).unwrap();
        let unit_of = |name: &str| match name {
            "p" | "q" => Some(unit("Pa")),
            "rho" => Some(unit("kg/m^3")),
            "T" => Some(unit("K")),
            "n" => Some(unit("1")),
            "U" | "U:magnitude" | "U:X" => Some(unit("m/s")),
            _ => None,
        };
        Expression::parse(text).unwrap_or_else(|(error, _)| panic!("{text}: {error}")).dimension(
            text,
            unit_of,
            Some(unit("mm")),
        )
    }

    #[test]
    fn units_combine() {
        for (text, right) in [
            ("p + q", "kg/(m s^2)"),
            ("2*p - 101325", "kg/(m s^2)"),
            ("p + rho*mag(U)^2/2", "kg/(m s^2)"),
            ("sqrt(1.4*p/rho)", "m/s"),
            ("mag(U)/sqrt(1.4*p/rho)", "1"),
            ("exp(-p/q) * T", "K"),
            ("max(p, 1e-30)", "kg/(m s^2)"),
            ("x + p", "kg/(m s^2)"),
            ("min(-p, q) ^ (1 - 3/2)", "m^0.5 s/kg^0.5"),
            ("cbrt(p)*cbrt(p)*cbrt(p)", "kg/(m s^2)"),
            ("pow(U:X, 2)", "m^2/s^2"),
            ("atan2(p, q)", "1"),
            ("2^n", "1"),
            ("n^n", "1"),
            ("1/T", "1/K"),
            ("gradient_magnitude(T)", "K/m"),
            ("vorticity(U) + divergence(U)", "1/s"),
            ("q_criterion(U)", "1/s^2"),
            ("ln(x)", "1"),
        ] {
            let found = dimension(text).unwrap_or_else(|(error, _)| panic!("{text}: {error}"));
            assert_eq!(found.map(|unit| unit.to_string()).as_deref(), Some(right), "{text}");
        }
        for open in ["x", "x*p", "x^2", "2 + pi", "x + 1", "x/n"] {
            assert!(
                dimension(open).unwrap_or_else(|(error, _)| panic!("{open}: {error}")).is_none(),
                "{open}"
            );
        }
    }

    #[test]
    fn units_that_do_not_agree_are_pointed_at() {
        for (text, pointed, what) in [
            ("p + T", "+", "'p' in kg/(m s^2) and 'T' in K"),
            ("2 * p - rho * mag(U)", "-", "'2 * p' in kg/(m s^2) and 'rho * mag(U)' in kg/(m^2 s)"),
            ("n + p", "+", "'n', a pure number"),
            ("max(p, T) + q", "max(p, T)", "'max' is of unlike units"),
            ("atan2(p, T)", "atan2(p, T)", "'atan2'"),
            ("p*exp(-T)", "-T", "'exp' takes a pure number: found '-T' in K"),
            ("sin(p/T)", "p/T", "'sin'"),
            ("2^T", "T", "an exponent has a unit"),
            ("x^T", "T", "an exponent has a unit"),
            ("p^n", "n", "varies"),
            ("p^x", "x", "varies"),
            ("gradient_magnitude(T) + T", "+", "K/m"),
        ] {
            let Err((error, span)) = dimension(text) else { panic!("{text} is no error") };
            assert_eq!(&text[span], pointed, "{text}: {error}");
            assert!(error.to_string().contains(what), "{text}: {error}");
        }
    }
}
