//! Scales of the axes s and g of the plane of transfer functions: linear, logarithmic, or logarithmic on both sides of 0.
//!
//! Widgets stand at *positions* on an axis: values where it is linear, decades where it is logarithmic.

use crate::arithmetic::decimal;
use crate::parameters::{
    ArrayRef, LocatedValue, ParameterType, ParameterValue, Parameters, RelativeNumberType, StatisticKind,
};
use crate::{Error, Result};

/// Scale of an axis: a position for every value that has one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AxisScale {
    /// The value itself.
    #[default]
    Linear,
    /// log₁₀ of the value; values of 0 and less have no position, and are not drawn.
    Log,
    /// sign(x) log₁₀(1 + |x|/c): about linear up to c, logarithmic beyond (Webber 2013).
    SymLog {
        /// c, in units of the value, > 0.
        linear_below: f64,
    },
}

/// Largest ratio of two values that a logarithmic axis tells: what is smaller than the largest by more is not drawn.
pub const DECADES: f64 = 30.0;

impl AxisScale {
    /// True unless it is linear.
    pub fn is_curved(self) -> bool {
        self != AxisScale::Linear
    }

    /// Position of a value; −∞ where it has none.
    #[inline]
    pub fn position(self, value: f64) -> f64 {
        match self {
            AxisScale::Linear => value,
            AxisScale::Log if value > 0.0 => value.log10(),
            AxisScale::Log => f64::NEG_INFINITY,
            AxisScale::SymLog { linear_below } => {
                ((value.abs() / linear_below).ln_1p() * std::f64::consts::LOG10_E).copysign(value)
            }
        }
    }

    /// Value at a position.
    #[inline]
    pub fn value(self, position: f64) -> f64 {
        match self {
            AxisScale::Linear => position,
            AxisScale::Log => 10f64.powf(position),
            AxisScale::SymLog { linear_below } => {
                (linear_below * (position.abs() * std::f64::consts::LN_10).exp_m1()).copysign(position)
            }
        }
    }

    /// Positions of a range of values. On a logarithmic axis the lower end is [`DECADES`] below the upper one at least.
    pub fn positions(self, [low, high]: [f64; 2]) -> [f64; 2] {
        let [from, to] = [low, high].map(|value| self.position(value));
        if self == AxisScale::Log { [from.max(to - DECADES), to] } else { [from, to] }
    }

    /// Checks its number. `axis`: its name.
    pub(super) fn check(self, axis: &str) -> Result<()> {
        match self {
            AxisScale::SymLog { linear_below } if !(linear_below > 0.0 && linear_below.is_finite()) => {
                Err(Error::usage(format!("the symmetric logarithm of {axis} has no linear part"))
                    .got(linear_below)
                    .expected("a number > 0"))
            }
            _ => Ok(()),
        }
    }
}

/// The parameters of a widget with its numbers at their positions on curved axes of s and g; those that are relative to data are left.
///
/// Errors, at the number's place: a value without a position.
pub fn on_axes(p: Parameters, axes: &[AxisScale; 2]) -> Result<Parameters> {
    with_places(p, axes, &|measured, name, setting, axis| {
        let position = axes[axis].position(setting.number().unwrap_or(f64::NAN));
        let may_be_open = matches!(measured.plain, ParameterType::Numbers(_, range) if range.infinite);
        if position.is_finite() || may_be_open {
            return Ok(position);
        }
        let what = format!("'{name}' has no place on a logarithmic axis");
        Err(setting.error(what, "a number > 0; \"symlog\" has a place for every number"))
    })
}

/// The parameters of a widget with the values of its positions on curved axes of s and g: undoes [`on_axes`]. `steps`: the lengths along
/// the axes that positions are told apart by; values have as many digits as that takes.
pub fn off_axes(p: Parameters, axes: &[AxisScale; 2], steps: [f64; 2]) -> Result<Parameters> {
    with_places(p, axes, &|_, _, setting, axis| {
        let position = setting.number().unwrap_or(f64::NAN);
        let [value, next] = [position, position + steps[axis]].map(|position| axes[axis].value(position));
        let step = (next - value).abs();
        Ok(if step.is_finite() { decimal(value, step) } else { value })
    })
}

/// Gives a number in place of a setting that is a place on an axis, 0 or 1: from its type, its parameter's name, and itself.
type ReplacePlace<'a> = &'a dyn Fn(&RelativeNumberType, &str, &LocatedValue, usize) -> Result<f64>;

/// The parameters of a widget with others in place of the numbers that are places on curved axes.
fn with_places(p: Parameters, axes: &[AxisScale; 2], replace: ReplacePlace) -> Result<Parameters> {
    if !axes.iter().any(|axis| axis.is_curved()) {
        return Ok(p);
    }
    p.with_settings(&mut |measured, name, setting, beside| match measured.statistic {
        StatisticKind::Value | StatisticKind::Place => {
            let axis_of = |place: usize| match measured.quantity(place, beside) {
                Some(ArrayRef::Named("s")) => Some(0),
                Some(ArrayRef::Named("g")) => Some(1),
                _ => None,
            };
            let curved = |place: usize| axis_of(place).filter(|axis| axes[*axis].is_curved());
            placed(setting, 0, &curved, &|setting, axis| replace(measured, name, setting, axis))
        }
        StatisticKind::Width | StatisticKind::Factor => Ok(setting.clone()),
    })
}

/// A setting with others in place of its numbers; `place`: its place in the list that it is part of; `curved`: the curved axis, if any, of
/// what stands at a place.
fn placed(
    setting: &LocatedValue,
    place: usize,
    curved: &dyn Fn(usize) -> Option<usize>,
    replace: &dyn Fn(&LocatedValue, usize) -> Result<f64>,
) -> Result<LocatedValue> {
    let datum = match (&setting.datum, curved(place)) {
        (ParameterValue::List(list), _) => {
            let part = |(place, part)| placed(part, place, curved, replace);
            ParameterValue::List(list.iter().enumerate().map(part).collect::<Result<_>>()?)
        }
        (ParameterValue::Number(_) | ParameterValue::Integer(_), Some(axis)) => {
            ParameterValue::Number(replace(setting, axis)?)
        }
        (other, _) => other.clone(),
    };
    Ok(LocatedValue { datum, origin: setting.origin.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_values_are_inverse() {
        for scale in [AxisScale::Linear, AxisScale::Log, AxisScale::SymLog { linear_below: 1e-3 }] {
            for value in [1e-12, 3e-4, 1.0, 7e9] {
                for value in [value, -value] {
                    let position = scale.position(value);
                    if position.is_finite() {
                        let back = scale.value(position);
                        assert!((back / value - 1.0).abs() < 1e-14, "{scale:?} {value} {back}");
                    } else {
                        assert!(scale == AxisScale::Log && value < 0.0);
                    }
                }
            }
        }
        assert_eq!(AxisScale::Log.position(1000.0), 3.0);
        assert_eq!(AxisScale::SymLog { linear_below: 1.0 }.position(-99.0), -2.0);
        assert_eq!(AxisScale::SymLog { linear_below: 1.0 }.position(0.0), 0.0);
        assert_eq!(AxisScale::Log.positions([0.0, 1e6]), [6.0 - DECADES, 6.0]);
    }
}
