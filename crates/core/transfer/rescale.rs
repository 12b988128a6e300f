//! Widgets rescaled from the data that they were made for to other data: each number of s and g is the same share of the other range.

use super::relative::{DataStatistics, length};
use crate::Result;
use crate::arithmetic::decimal;
use crate::parameters::{
    ArrayRef, LocatedValue, ParameterValue, Parameters, Relative, RelativeNumberType, StatisticKind,
};

/// Share of a range, and of a width, that rescaled numbers are written to.
const WRITTEN: f64 = 1e-6;

/// The parameters of a widget with its numbers of s and g at the same shares of the ranges of other data, counted along the axes' scales.
/// Numbers that are relative to data follow by themselves and stay, and so do infinite ones, those of other quantities, and those of a
/// quantity that is the same everywhere, before or after.
///
/// # Errors
/// - the range of a quantity is not known
pub fn rescaled(
    p: &Parameters,
    before: &dyn DataStatistics,
    after: &dyn DataStatistics,
) -> Result<Parameters> {
    p.with_settings(&mut |measured, _, setting, beside| {
        let near = nearest(setting);
        number_by_number(setting, 0, &|place, x| {
            let quantity = measured.quantity(place, beside).filter(is_of_axes).filter(|_| x.is_finite());
            let Some(quantity) = quantity else { return Ok(x) };
            if is_same(&quantity, before, after) {
                return Ok(x);
            }
            // A range without a length has no shares.
            let (Ok(from), Ok(to)) = (length(&quantity, before), length(&quantity, after)) else {
                return Ok(x);
            };
            let found = one([x, near], measured, &quantity, [before, after], [from, to])?;
            Ok(if found.is_finite() { found } else { x })
        })
    })
}

/// True of s, g and quotients of them.
fn is_of_axes(quantity: &ArrayRef) -> bool {
    match quantity {
        ArrayRef::Named(name) => ["s", "g"].contains(name),
        ArrayRef::Per(one, other) => is_of_axes(one) && is_of_axes(other),
        ArrayRef::Array(_) => false,
    }
}

/// True if the range of a quantity and its scale are those before.
fn is_same(quantity: &ArrayRef, before: &dyn DataStatistics, after: &dyn DataStatistics) -> bool {
    if let ArrayRef::Per(one, other) = quantity {
        return is_same(one, before, after) && is_same(other, before, after);
    }
    let of = |data: &dyn DataStatistics| Some((data.range(quantity).ok()?, data.scale(quantity)));
    of(before) == of(after)
}

/// The least distance of different numbers of a setting.
fn nearest(setting: &LocatedValue) -> f64 {
    fn collect(setting: &LocatedValue, numbers: &mut Vec<f64>) {
        match &setting.datum {
            ParameterValue::List(list) => list.iter().for_each(|part| collect(part, numbers)),
            _ => numbers.extend(setting.number().filter(|x| x.is_finite())),
        }
    }
    let mut numbers = Vec::new();
    collect(setting, &mut numbers);
    numbers.sort_by(f64::total_cmp);
    let steps = numbers.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min)
}

/// One number of other data; `near`: distance of the next; `from`, `to`: lengths of the quantity's ranges.
fn one(
    [x, near]: [f64; 2],
    measured: &RelativeNumberType,
    quantity: &ArrayRef,
    [before, after]: [&dyn DataStatistics; 2],
    [from, to]: [f64; 2],
) -> Result<f64> {
    let short = |x: f64| decimal(x, WRITTEN * x.abs());
    Ok(match measured.statistic {
        StatisticKind::Width => short(x * to / from),
        StatisticKind::Factor => short(x * from / to),
        StatisticKind::Value | StatisticKind::Place => {
            let ends = |of: &dyn DataStatistics| -> Result<[f64; 2]> {
                Ok(of.scale(quantity).positions(of.range(quantity)?))
            };
            let [low, high] = ends(before)?;
            let [place, next] = [x, x + near].map(|x| before.scale(quantity).position(x));
            let share = (place - low) / (high - low);
            let position = Relative::at_share(share, ends(after)?);
            // Numbers that differ stay different.
            let step = (WRITTEN * to).min(1e-3 * (next - place) * to / from);
            let [value, next] =
                [position, position + step].map(|position| after.scale(quantity).value(position));
            decimal(value, (next - value).abs())
        }
    })
}

/// The setting with others in place of its numbers; `place`: that of the setting in the list that it is part of.
fn number_by_number(
    setting: &LocatedValue,
    place: usize,
    replace: &dyn Fn(usize, f64) -> Result<f64>,
) -> Result<LocatedValue> {
    let datum = match &setting.datum {
        ParameterValue::List(list) => {
            let parts = list.iter().enumerate();
            let parts = parts.map(|(place, part)| number_by_number(part, place, replace));
            ParameterValue::List(parts.collect::<Result<_>>()?)
        }
        // One that stays is written as it was.
        other => {
            match setting.number().map(|x| Ok::<_, crate::Error>((x, replace(place, x)?))).transpose()? {
                Some((x, new)) if new != x => ParameterValue::Number(new),
                _ => other.clone(),
            }
        }
    };
    Ok(LocatedValue { datum, origin: setting.origin.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Field, SourceSpan};
    use crate::transfer::{AxisScale, WIDGET_KINDS};

    struct Ranges([[f64; 2]; 2], AxisScale);

    impl DataStatistics for Ranges {
        fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
            Ok(self.0[usize::from(*quantity == ArrayRef::Named("g"))])
        }

        fn percentile(&self, _: &ArrayRef, percent: f64) -> Result<f64> {
            Ok(percent)
        }

        fn scale(&self, quantity: &ArrayRef) -> AxisScale {
            if *quantity == ArrayRef::Named("s") { self.1 } else { AxisScale::Linear }
        }
    }

    const BEFORE: Ranges = Ranges([[0.0, 10.0], [0.0, 2.0]], AxisScale::Linear);
    const AFTER: Ranges = Ranges([[-100.0, 100.0], [0.0, 8.0]], AxisScale::Linear);

    /// Settings of a widget of a kind, after it was rescaled.
    fn after(kind: &str, fields: Vec<Field>, ranges: [&Ranges; 2]) -> impl Fn(&str) -> ParameterValue {
        let kind = WIDGET_KINDS.iter().find(|known| known.name == kind).unwrap();
        let found =
            Parameters::survey(kind.parameters, &fields, &SourceSpan::Nowhere, &[], &mut |name, error| {
                panic!("{name}: {error}")
            });
        let found = rescaled(&found, ranges[0], ranges[1]).unwrap();
        move |name| found.optional(name).unwrap().datum.clone()
    }

    fn field(name: &str, value: impl Into<ParameterValue>) -> Field {
        let value: ParameterValue = value.into();
        Field::new(name, value)
    }

    fn numbers(all: &[f64]) -> ParameterValue {
        all.iter().copied().collect()
    }

    fn look() -> [Field; 2] {
        [field("color", numbers(&[1.0, 0.5, 0.0])), field("extinction", 2.0)]
    }

    #[test]
    fn values_keep_their_shares_and_widths_their_lengths() {
        let region = ParameterValue::Table(vec![
            field("s", numbers(&[0.0, f64::INFINITY])),
            field("g", ParameterValue::from_iter(["10 %", "p90"])),
        ]);
        let own = [
            field("centre", numbers(&[2.5, 1.0])),
            field("sigma", numbers(&[0.5, f64::INFINITY])),
            field("region", region),
        ];
        let found = after("gaussian", look().into_iter().chain(own).collect(), [&BEFORE, &AFTER]);
        assert_eq!(found("centre"), numbers(&[-50.0, 4.0]));
        assert_eq!(found("sigma"), numbers(&[10.0, f64::INFINITY]));
        assert_eq!((found("color"), found("extinction")), (numbers(&[1.0, 0.5, 0.0]), 2.0.into()));
        let ParameterValue::Table(region) = found("region") else { panic!("no table") };
        assert_eq!(region[0].setting.datum, numbers(&[-100.0, f64::INFINITY]));
        assert_eq!(
            region[1].setting.datum,
            ParameterValue::from_iter(["10 %", "p90"]),
            "it follows by itself"
        );
    }

    #[test]
    fn factors_and_quotients_go_the_other_way() {
        let rows = ParameterValue::List(vec![numbers(&[2.0, 0.5]).into(), numbers(&[0.0, 1.0]).into()]);
        let own = [field("centre", numbers(&[10.0, 0.0])), field("matrix", rows)];
        let found = after("gaussian", look().into_iter().chain(own).collect(), [&BEFORE, &AFTER]);
        let rows = ParameterValue::List(vec![numbers(&[0.1, 0.125]).into(), numbers(&[0.0, 0.25]).into()]);
        assert_eq!(found("matrix"), rows);
        let own = [field("centre", 5.0), field("sigma", 0.1)];
        let found = after("triangular-gaussian", look().into_iter().chain(own).collect(), [&BEFORE, &AFTER]);
        // 20 times the s, 4 times the g.
        assert_eq!((found("centre"), found("sigma")), (0.0.into(), 0.5.into()));
    }

    #[test]
    fn on_a_logarithmic_axis_shares_are_of_its_decades() {
        let ranges = [[1.0, 1e4], [1e-3, 1e5]].map(|s| Ranges([s, [0.0, 1.0]], AxisScale::Log));
        let own = [field("centre", numbers(&[100.0, 0.5])), field("sigma", numbers(&[0.25, 0.1]))];
        let found = after("gaussian", look().into_iter().chain(own).collect(), [&ranges[0], &ranges[1]]);
        assert_eq!((found("centre"), found("sigma")), (numbers(&[10.0, 0.5]), numbers(&[0.5, 0.1])));
    }

    #[test]
    fn what_has_the_same_range_is_written_as_it_was() {
        let own =
            || [field("centre", numbers(&[1.0 / 3.0, 1.0])), field("sigma", numbers(&[0.123456789, 0.1]))];
        let found = after("gaussian", look().into_iter().chain(own()).collect(), [&BEFORE, &BEFORE]);
        assert_eq!(
            (found("centre"), found("sigma")),
            (numbers(&[1.0 / 3.0, 1.0]), numbers(&[0.123456789, 0.1]))
        );
    }

    #[test]
    fn numbers_that_are_close_stay_apart() {
        let region = ParameterValue::Table(vec![field("s", numbers(&[5.0, 5.000_000_1]))]);
        let own = [
            field("centre", numbers(&[5.0, 1.0])),
            field("sigma", numbers(&[0.1, 0.1])),
            field("region", region),
        ];
        let found = after("gaussian", look().into_iter().chain(own).collect(), [&BEFORE, &AFTER]);
        let ParameterValue::Table(region) = found("region") else { panic!("no table") };
        let ends: Vec<f64> =
            region[0].setting.list().unwrap().iter().filter_map(LocatedValue::number).collect();
        assert!((ends[1] - ends[0] - 2e-6).abs() < 1e-8, "{ends:?}");
    }

    #[test]
    fn what_is_the_same_everywhere_has_no_shares() {
        let flat = Ranges([[3.0, 3.0], [0.0, 0.0]], AxisScale::Linear);
        let own = || [field("centre", numbers(&[2.5, 1.0])), field("sigma", numbers(&[0.5, 0.1]))];
        for ranges in [[&flat, &AFTER], [&BEFORE, &flat]] {
            let found = after("gaussian", look().into_iter().chain(own()).collect(), ranges);
            assert_eq!((found("centre"), found("sigma")), (numbers(&[2.5, 1.0]), numbers(&[0.5, 0.1])));
        }
    }
}
