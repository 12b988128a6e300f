//! Widgets rescaled from the data that they were made for to other data: each number of s and g is the same share of the other range; and to
//! other scales of the axes: each width reaches to the same value.

use super::axis::AxisScale;
use super::relative::{DataStatistics, length, resolved};
use crate::Result;
use crate::arithmetic::decimal;
use crate::parameters::{
    ArrayRef, LocatedValue, ParameterValue, Parameters, Relative, RelativeNumberType, StatisticKind,
};

/// Quantities of the axes.
const AXES: [&str; 2] = ["s", "g"];

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

/// The parameters of a widget where the axes of s and g get other scales. Values stay. A width reaches from the widget's middle, away from 0, to
/// the value that it reached to before, and so there and back it is the same. Numbers that are relative to data stay.
///
/// # Errors
/// - the widget's middle has no position on an axis, before or after: it is 0 or less, and the axis logarithmic
/// - a width is none there, or the range of a quantity is not known
pub fn on_other_scales(
    p: &Parameters,
    before: &dyn DataStatistics,
    after: &[AxisScale; 2],
) -> Result<Parameters> {
    let numbers = resolved(p, before)?;
    let middle = numbers.optional("centre").or(numbers.optional("origin"));
    p.with_settings(&mut |measured, name, setting, beside| {
        number_by_number(setting, 0, &|place, x| {
            let quantity = measured.quantity(place, beside);
            let Some(axis) = AXES.into_iter().position(|axis| quantity == Some(ArrayRef::Named(axis))) else {
                return Ok(x);
            };
            let width = match measured.statistic {
                StatisticKind::Width => x,
                StatisticKind::Factor => width_of_factors(setting, place, beside),
                StatisticKind::Value | StatisticKind::Place => return Ok(x),
            };
            let scales = [before.scale(&ArrayRef::Named(AXES[axis])), after[axis]];
            if scales[0] == scales[1] || !width.is_finite() {
                return Ok(x);
            }
            let middle = middle.and_then(|middle| middle.list()?.get(place)?.number());
            let has_place = |middle: &f64| scales.iter().all(|scale| scale.position(*middle).is_finite());
            let other = middle.filter(has_place).map(|middle| other_width(width, middle, scales));
            let Some(other) = other.filter(|other| *other > 0.0 && other.is_finite()) else {
                let what = format!("'{name}' has no length on the other scale of {}", AXES[axis]);
                return Err(setting.error(what, "a widget whose middle has a place on both scales"));
            };
            Ok(short(if measured.statistic == StatisticKind::Width { other } else { x * width / other }))
        })
    })
}

/// A width on another scale.
fn other_width(width: f64, middle: f64, [from, to]: [AxisScale; 2]) -> f64 {
    let end = from.value(from.position(middle) + width.copysign(middle));
    (to.position(end) - to.position(middle)).abs()
}

/// The width that factors on a quantity mean: of a matrix those of its column, of a wave's scale that of its period.
fn width_of_factors(
    setting: &LocatedValue,
    place: usize,
    beside: &dyn Fn(&str) -> Option<LocatedValue>,
) -> f64 {
    let parts = setting.list().unwrap_or_default();
    let in_row = |row: &LocatedValue| row.list()?.get(place)?.number();
    let factors = parts.iter().enumerate().map(|(own, part)| match part.list() {
        Some(_) => in_row(part).unwrap_or(0.0),
        None => part.number().filter(|_| own == place).unwrap_or(0.0),
    });
    let period = beside("period").and_then(|period| period.number()).unwrap_or(1.0);
    period / factors.fold(0.0, f64::hypot)
}

/// True of s, g and quotients of them.
fn is_of_axes(quantity: &ArrayRef) -> bool {
    match quantity {
        ArrayRef::Named(name) => AXES.contains(name),
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

fn short(x: f64) -> f64 {
    decimal(x, WRITTEN * x.abs())
}

/// One number of other data; `near`: distance of the next; `from`, `to`: lengths of the quantity's ranges.
fn one(
    [x, near]: [f64; 2],
    measured: &RelativeNumberType,
    quantity: &ArrayRef,
    [before, after]: [&dyn DataStatistics; 2],
    [from, to]: [f64; 2],
) -> Result<f64> {
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
    use crate::transfer::WIDGET_KINDS;

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

    fn parameters(kind: &str, fields: Vec<Field>) -> Parameters {
        let kind = WIDGET_KINDS.iter().find(|known| known.name == kind).unwrap();
        Parameters::survey(kind.parameters, &fields, &SourceSpan::Nowhere, &[], &mut |name, error| {
            panic!("{name}: {error}")
        })
    }

    /// Settings of a widget of a kind, after it was rescaled.
    fn after(kind: &str, fields: Vec<Field>, ranges: [&Ranges; 2]) -> impl Fn(&str) -> ParameterValue {
        let found = rescaled(&parameters(kind, fields), ranges[0], ranges[1]).unwrap();
        move |name| found.optional(name).unwrap().datum.clone()
    }

    const SYMLOG: AxisScale = AxisScale::SymLog { linear_below: 1.0 };

    /// A widget on another scale of s.
    fn on(p: &Parameters, [from, to]: [AxisScale; 2]) -> Result<Parameters> {
        on_other_scales(p, &Ranges([[0.0, 1e3], [0.0, 1.0]], from), &[to, AxisScale::Linear])
    }

    /// Numbers of a widget as they were made, on another scale of s, and back on the first.
    fn there_and_back(
        kind: &str,
        own: &[(&str, ParameterValue)],
        [from, to]: [AxisScale; 2],
    ) -> Result<[Parameters; 2]> {
        let fields = own.iter().map(|(name, value)| field(name, value.clone()));
        let before = parameters(kind, look().into_iter().chain(fields).collect());
        let there = on(&before, [from, to])?;
        let back = on(&there, [to, from])?;
        for (name, value) in own {
            let [was, is] = [value, &back.optional(name).unwrap().datum].map(flat);
            assert!(
                was.iter().zip(&is).all(|(was, is)| (was - is).abs() <= 2e-6 * was.abs()),
                "{name}: {was:?} {is:?}"
            );
        }
        Ok([there, back])
    }

    /// All numbers of a value.
    fn flat(value: &ParameterValue) -> Vec<f64> {
        match value {
            ParameterValue::List(parts) => parts.iter().flat_map(|part| flat(&part.datum)).collect(),
            other => LocatedValue::from(other.clone()).number().into_iter().collect(),
        }
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
    fn on_another_scale_a_width_reaches_to_the_same_value() {
        use AxisScale::{Linear, Log};
        let close = |is: &[f64], wanted: &[f64]| {
            let is_close = |(is, wanted): (&f64, &f64)| (is - wanted).abs() <= 2e-6 * wanted.abs();
            assert!(is.len() == wanted.len() && is.iter().zip(wanted).all(is_close), "{is:?} {wanted:?}");
        };
        let of = |p: &[Parameters; 2], name: &str| flat(&p[0].optional(name).unwrap().datum);
        // From 100 to 160.
        let decades = 1.6f64.log10();
        let own = [("centre", numbers(&[100.0, 0.5])), ("sigma", numbers(&[60.0, 0.1]))];
        let found = there_and_back("gaussian", &own, [Linear, Log]).unwrap();
        close(&of(&found, "centre"), &[100.0, 0.5]);
        close(&of(&found, "sigma"), &[decades, 0.1]);
        // From 0 to 9, and from -100 to -109.
        for (centre, end) in [(0.0, 9.0), (-100.0, -109.0)] {
            let own = [("centre", numbers(&[centre, 0.5])), ("sigma", numbers(&[9.0, 0.1]))];
            let found = there_and_back("gaussian", &own, [Linear, SYMLOG]).unwrap();
            close(&of(&found, "sigma"), &[(SYMLOG.position(end) - SYMLOG.position(centre)).abs(), 0.1]);
        }
        // A column, and a period of a wave, are as long as a width.
        let factor = 1.0 / decades;
        let rows = [numbers(&[0.6 / 60.0, 0.0]), numbers(&[-0.8 / 60.0, 2.0])];
        let rows = ParameterValue::List(rows.map(LocatedValue::from).to_vec());
        let own = [("centre", numbers(&[100.0, 0.5])), ("matrix", rows)];
        let found = there_and_back("gaussian", &own, [Linear, Log]).unwrap();
        close(&of(&found, "matrix"), &[0.6 * factor, 0.0, -0.8 * factor, 2.0]);
        let own =
            [("origin", numbers(&[100.0, 0.0])), ("scale", numbers(&[2.0, 1.0])), ("period", 120.0.into())];
        let found = there_and_back("sine-wave", &own, [Linear, Log]).unwrap();
        close(&of(&found, "scale"), &[120.0 * factor, 1.0]);
        close(&of(&found, "period"), &[120.0]);
    }

    #[test]
    fn a_widget_whose_middle_has_no_place_on_a_scale_has_no_other_widths() {
        for centre in [0.0, -3.0] {
            let own = [field("centre", numbers(&[centre, 0.5])), field("sigma", numbers(&[60.0, 0.1]))];
            let widget = parameters("gaussian", look().into_iter().chain(own).collect());
            for scales in [[AxisScale::Linear, AxisScale::Log], [AxisScale::Log, AxisScale::Linear]] {
                let error = on(&widget, scales).unwrap_err().to_string();
                assert!(error.contains("'sigma' has no length on the other scale of s"), "{error}");
            }
        }
        // What has no widths needs no middle.
        let own = [("region", ParameterValue::Table(vec![field("s", numbers(&[-1.0, 5.0]))]))];
        let [there, _] = there_and_back("uniform", &own, [AxisScale::Linear, AxisScale::Log]).unwrap();
        assert_eq!(there.optional("region").unwrap().datum, own[0].1);
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
