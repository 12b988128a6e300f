//! Numbers of a widget as a file states them, relative to data and along logarithmic axes: their places in the plane, and how places that a
//! hand gave them are written.

use crate::worker::{DataScales, without_zeros};
use voltet_core::parameters::{DefaultValue, Parameter, Parameters, Relative, RelativeNumber, StatisticKind};
use voltet_core::transfer::{self, AxisScale, DataStatistics, WIDGET_KINDS};
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Field, LocatedValue, ParameterValue, SourceSpan, find_setting};

/// Digits after the point of a percentage of a range: of a value, and at least of a width.
const SHARE_DIGITS: usize = 3;

/// Digits of the percentage that a width is.
const WIDTH_DIGITS: i32 = 5;

/// Two keys that say the same in two ways: deviations, and a matrix whose columns belong to the same quantities.
const IN_PLACE_OF_EACH_OTHER: [[&str; 2]; 2] = [["sigma", "matrix"], ["matrix", "sigma"]];

/// Digits after the point of a percentage or a percentile, at most: more are none of 64 bits.
const MAX_DIGITS: usize = 14;

/// Share of the range that a percentile may be off by, where the pointer does not resolve less.
const NEAR: f64 = 2e-4;

pub(super) struct PlaneAxes<'a> {
    /// Scales of s and g.
    pub scales: [AxisScale; 2],
    /// Length along the axis of a quantity that the pointer resolves.
    pub step: &'a dyn Fn(&ArrayRef) -> f64,
}

fn parameters(fields: &[Field]) -> Option<Parameters> {
    let kind = find_setting(fields, "kind")?.text()?;
    let kind = WIDGET_KINDS.iter().find(|known| known.name == kind)?;
    // What is wrong is said elsewhere; what is not set has no numbers.
    Some(Parameters::survey(kind.parameters, fields, &SourceSpan::Nowhere, &["kind"], &mut |_, _| {}))
}

pub(super) fn is_relative(fields: &[Field]) -> bool {
    parameters(fields).is_some_and(|parameters| !parameters.relative_numbers().is_empty())
}

/// The table with numbers in place of those relative to data. Error: they are not known yet.
pub(super) fn resolved(fields: &[Field], known: Option<&DataScales>) -> Result<Vec<Field>> {
    let Some(parameters) = parameters(fields) else { return Ok(fields.to_vec()) };
    if parameters.relative_numbers().is_empty() {
        return Ok(fields.to_vec());
    }
    let unknown = || Error::run("its numbers are relative to data that are not known here yet");
    let found = transfer::resolved(&parameters, known.ok_or_else(unknown)?)?;
    // What is not stated may be relative to the data, too.
    let is_default = |parameter: &Parameter| {
        matches!(parameter.default, DefaultValue::Texts(_)) && find_setting(fields, parameter.name).is_none()
    };
    let defaults = found.iter().filter(|(parameter, ..)| is_default(parameter));
    let defaults =
        defaults.filter_map(|(parameter, setting, _)| Some(Field::new(parameter.name, setting?.clone())));
    Ok(replaced(fields, &found).into_iter().chain(defaults).collect())
}

/// The table with the settings of parameters.
fn replaced(fields: &[Field], found: &Parameters) -> Vec<Field> {
    let replaced = |field: &Field| {
        let new = found.iter().find(|(parameter, ..)| parameter.name == field.name);
        let setting = new.and_then(|(_, setting, _)| setting.cloned());
        Field { setting: setting.unwrap_or_else(|| field.setting.clone()), ..field.clone() }
    };
    fields.iter().map(replaced).collect()
}

/// The table with the places in the plane of its numbers. Errors: those that are relative to data are not known yet; a value has no place on
/// a logarithmic axis.
pub(super) fn in_plane(
    fields: &[Field],
    known: Option<&DataScales>,
    scales: &[AxisScale; 2],
) -> Result<Vec<Field>> {
    let resolved = resolved(fields, known)?;
    match parameters(&resolved) {
        Some(parameters) => Ok(replaced(&resolved, &transfer::on_axes(parameters, scales)?)),
        None => Ok(resolved),
    }
}

/// The table whose numbers are places in the plane as a file states them.
pub(super) fn off_plane(fields: &[Field], axes: &PlaneAxes) -> Vec<Field> {
    let steps = ["s", "g"].map(|name| (axes.step)(&ArrayRef::Named(name)));
    let found = parameters(fields).and_then(|numbers| transfer::off_axes(numbers, &axes.scales, steps).ok());
    found.map_or_else(|| fields.to_vec(), |found| replaced(fields, &found))
}

/// Widgets with numbers in place of those relative to data: what is drawn while one is dragged, as nothing is to be found anew of
/// the data for each step. None where all are numbers, or some are not known.
pub(crate) fn in_numbers(list: &[LocatedValue], known: &DataScales) -> Option<Vec<LocatedValue>> {
    let widget = |entry: &LocatedValue| {
        let fields = resolved(entry.table()?, Some(known)).ok()?;
        Some(LocatedValue { datum: ParameterValue::Table(fields), ..entry.clone() })
    };
    let found: Vec<LocatedValue> = list.iter().map(widget).collect::<Option<_>>()?;
    (found != list).then_some(found)
}

/// Value to write at a key of the table ("centre", "region.s") after an edit by the pointer, of places in the plane: relative numbers stay
/// relative, and unchanged ones stay as they are written.
pub(super) fn as_written(
    fields: &[Field],
    known: Option<&DataScales>,
    axes: &PlaneAxes,
    key: &str,
    new: ParameterValue,
) -> ParameterValue {
    let values = off_plane(&with(fields, key, &new), axes);
    let values = at(&values, key).map_or_else(|| new.clone(), |values| values.datum.clone());
    let other = IN_PLACE_OF_EACH_OTHER.iter().find(|[to, _]| *to == key).map(|[_, from]| *from);
    let carried =
        other.filter(|_| at(fields, key).is_none()).and_then(|from| carried(fields, from, key, &new));
    let fields = carried.as_deref().unwrap_or(fields);
    let now = in_plane(fields, known, &axes.scales).unwrap_or_else(|_| fields.to_vec());
    let (Some(old), Some(now)) = (at(fields, key), at(&now, key)) else { return values };
    let mut numbers = Vec::new();
    // Each relative number is marked by its place among them.
    let marked = parameters(fields).and_then(|parameters| {
        let marked = parameters.with_numbers(&mut |number| {
            numbers.push(number.clone());
            Ok((numbers.len() - 1) as f64)
        });
        let marked = marked.ok()?;
        let set = marked.iter().filter_map(|(parameter, setting, _)| Some((parameter.name, setting?)));
        let fields: Vec<Field> = set.map(|(name, setting)| Field::new(name, setting.clone())).collect();
        at(&fields, key).cloned()
    });
    // What is computed of lengths and angles comes back rounded; a place comes back as it was.
    let is_place = ["centre", "origin", "points", "s", "g"].contains(&key) || key.starts_with("region.");
    let is_same = |was: f64, is: f64| {
        let is_near = || (is - was).abs() <= 1e-9 * was.abs() || is == super::plane::rounded(was);
        is == was || (!is_place && is_near())
    };
    let relative = |number: &RelativeNumber, was: f64, is: f64| {
        relative(number, was, is, known?, (axes.step)(&number.quantity))
    };
    written(old, now, marked.as_ref(), &numbers, &relative, &is_same, [new, values])
}

/// The table with a value at a key.
fn with(fields: &[Field], key: &str, value: &ParameterValue) -> Vec<Field> {
    let (first, rest) = key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let old = fields.iter().find(|field| field.name == first);
    let inner = |rest: &str| {
        let table = old.and_then(|field| field.setting.table()).unwrap_or_default();
        ParameterValue::Table(with(table, rest, value))
    };
    let new = Field::new(first, rest.map_or_else(|| value.clone(), inner));
    fields.iter().filter(|field| field.name != first).cloned().chain([new]).collect()
}

/// The table with a key in place of the other that says the same: 100 % for each number of a quantity that has relative ones there,
/// 0 for the others. `None` where there are none.
fn carried(fields: &[Field], from: &str, to: &str, new: &ParameterValue) -> Option<Vec<Field>> {
    let stated = at(fields, from)?.list()?;
    let is_text = |place: usize| {
        let of = |part: &LocatedValue| match part.list() {
            Some(row) => row.get(place).is_some_and(|entry| entry.text().is_some()),
            None => false,
        };
        stated.get(place).is_some_and(|part| part.text().is_some()) || stated.iter().any(of)
    };
    let one =
        |place: usize| if is_text(place) { ParameterValue::from("100 %") } else { ParameterValue::from(0.0) };
    let ParameterValue::List(parts) = new else { return None };
    let list = |count: usize| (0..count).map(one).collect::<ParameterValue>();
    let setting = match parts.first()?.list() {
        Some(_) => parts.iter().map(|row| list(row.list().map_or(0, <[_]>::len))).collect(),
        None => list(parts.len()),
    };
    if !(0..parts.len()).any(is_text) {
        return None;
    }
    let others = fields.iter().filter(|field| field.name != from).cloned();
    Some(others.chain([Field::new(to, setting)]).collect())
}

fn at<'a>(fields: &'a [Field], key: &str) -> Option<&'a LocatedValue> {
    let (first, rest) = key.split_once('.').map_or((key, None), |(first, rest)| (first, Some(rest)));
    let setting = find_setting(fields, first)?;
    rest.map_or(Some(setting), |rest| at(setting.table()?, rest))
}

fn written(
    old: &LocatedValue,
    now: &LocatedValue,
    marked: Option<&LocatedValue>,
    numbers: &[RelativeNumber],
    relative: &dyn Fn(&RelativeNumber, f64, f64) -> Option<String>,
    is_same: &dyn Fn(f64, f64) -> bool,
    [new, value]: [ParameterValue; 2],
) -> ParameterValue {
    if let (ParameterValue::List(olds), ParameterValue::List(nows)) = (&old.datum, &now.datum)
        && let (ParameterValue::List(news), ParameterValue::List(values)) = (&new, &value)
        && [olds, nows, values].into_iter().all(|list| list.len() == news.len())
    {
        let marks = marked.and_then(LocatedValue::list);
        let parts = (0..news.len()).map(|i| {
            let mark = marks.and_then(|marks| marks.get(i));
            let new = [&news[i], &values[i]].map(|part| part.datum.clone());
            LocatedValue::from(written(&olds[i], &nows[i], mark, numbers, relative, is_same, new))
        });
        return ParameterValue::List(parts.collect());
    }
    let (Some(was), Some(is)) = (now.number(), LocatedValue::from(new).number()) else { return value };
    if is_same(was, is) {
        return old.datum.clone();
    }
    let mark = marked.and_then(LocatedValue::number).map(|mark| mark as usize);
    match (&old.datum, mark.and_then(|mark| numbers.get(mark))) {
        (ParameterValue::Text(_), Some(number)) => {
            relative(number, was, is).map_or(value, ParameterValue::Text)
        }
        _ => value,
    }
}

/// The number relative to data that says so; `None` where there is none. `was`, `is`: places in the
/// plane.
fn relative(number: &RelativeNumber, was: f64, is: f64, known: &DataScales, step: f64) -> Option<String> {
    let with_digits =
        |share: f64, digits: usize| format!("{} %", without_zeros(&format!("{:.digits$}", 100.0 * share)));
    // Of a width as many digits count, however narrow it is.
    let width = |share: f64| {
        let before = (100.0 * share.abs()).log10().floor() as i32 + 1;
        with_digits(share, (WIDTH_DIGITS - before).max(SHARE_DIGITS as i32) as usize)
    };
    let scale = known.scale(&number.quantity);
    let range = || Some(scale.positions(known.range(&number.quantity).ok()?));
    match (number.relative, number.is) {
        (Relative::Share(_), StatisticKind::Value | StatisticKind::Place) => {
            let [low, high] = range()?;
            let resolved = (-(100.0 * step / (high - low)).log10()).ceil();
            let digits = resolved.clamp(SHARE_DIGITS as f64, MAX_DIGITS as f64) as usize;
            (high > low).then(|| with_digits((is - low) / (high - low), digits))
        }
        // Widths are in proportion to their shares, factors the other way round.
        (Relative::Share(share), StatisticKind::Width) => {
            let share = share * is / was;
            (share > 0.0 && share.is_finite()).then(|| width(share))
        }
        (Relative::Share(share), StatisticKind::Factor) => {
            let share = share * was / is;
            (share != 0.0 && share.is_finite()).then(|| width(share))
        }
        (Relative::Percentile(_), _) => {
            let [low, high] = range()?;
            let share = known.spreads.get(&number.quantity)?.below(scale.value(is));
            let is = is.clamp(low, high);
            let text = |digits: usize| format!("{:.digits$}", 100.0 * share);
            // So many digits as it takes to come down where the hand is.
            let is_near = |digits: &usize| {
                let percent: f64 = text(*digits).parse().unwrap_or(0.0);
                let found = known.percentile(&number.quantity, percent);
                found.is_ok_and(|found| (scale.position(found) - is).abs() <= (NEAR * (high - low)).min(step))
            };
            let digits = (1..MAX_DIGITS).find(is_near).unwrap_or(MAX_DIGITS);
            Some(format!("p{}", text(digits)))
        }
    }
}
