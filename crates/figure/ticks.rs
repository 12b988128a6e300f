//! Round numbers along an axis, and their labels.

use voltet_core::transfer::AxisScale;

/// Ticks of an axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ticks {
    /// Positions with their labels, ascending.
    pub ticks: Vec<(f64, String)>,
    /// Way from a label to its value, where they differ: "×10⁻³ + 101325".
    pub note: Option<String>,
}

/// Labels of digits up to here are written without a power of ten.
const PLAIN: std::ops::Range<i32> = -3..5;

/// The middle by the range from which on labels count from a round number below it.
const OFFSET: f64 = 1e4;

/// Round values within a range, at most so many: multiples of 1, 2 or 5 times a power of ten. None where the range is empty or not finite.
pub fn values(range: [f64; 2], most: usize) -> Vec<f64> {
    values_within(range, most, rounding(range))
}

/// Distance at which two values of a range are the same: a few of their roundings.
fn rounding([low, high]: [f64; 2]) -> f64 {
    4.0 * f64::EPSILON * low.abs().max(high.abs())
}

/// Round values; multiples that the range's ends are but for rounding belong to it. `rounding`: that of the ends.
fn values_within([low, high]: [f64; 2], most: usize, rounding: f64) -> Vec<f64> {
    let span = high - low;
    if !(span > 16.0 * rounding && span.is_finite()) || most == 0 {
        return Vec::new();
    }
    let power = 10_f64.powf((span / most as f64).log10().floor());
    let ends = |step: f64| {
        let slack = 1e-9 + rounding / step;
        [(low / step - slack).ceil(), (high / step + slack).floor()]
    };
    let is_few = |step: &f64| *step > 0.0 && ends(*step)[1] - ends(*step)[0] < most as f64;
    let step = [1.0, 2.0, 5.0, 10.0, 20.0].map(|digit| digit * power).into_iter().find(is_few);
    let Some(step) = step else { return Vec::new() };
    let [first, last] = ends(step);
    (0..most).map(|k| first + k as f64).take_while(|k| *k <= last).map(|k| multiple(k, step)).collect()
}

/// k steps, not −0. Division by a whole number gives 0.3 where a product gives 0.30000000000000004.
fn multiple(k: f64, step: f64) -> f64 {
    let inverse = (1.0 / step).round();
    0.0 + if step < 1.0 && inverse.is_finite() { k / inverse } else { k * step }
}

/// Ticks of an axis between two positions, at most so many: on a logarithmic one at powers of ten; at 1, 2 and 5 times these where there
/// are few; and as on a linear one where the range is a part of a decade.
pub fn ticks(scale: AxisScale, range: [f64; 2], most: usize) -> Ticks {
    let within = |position: &f64| (range[0] - SAME_POSITION..=range[1] + SAME_POSITION).contains(position);
    let ends = range.map(|position| scale.value(position));
    let largest = ends[0].abs().max(ends[1].abs());
    let has_decades = scale.is_curved() && largest > 0.0 && largest.is_finite() && most > 0;
    if !has_decades {
        return linear_ticks(range, most);
    }
    let highest = largest.log10().ceil() as i32;
    let lowest = match scale {
        AxisScale::SymLog { linear_below } => linear_below.log10().ceil() as i32,
        _ => ends[0].log10().floor() as i32,
    };
    let powers = |digits: &[f64], step: i32| -> Vec<f64> {
        let exponents = (lowest..=highest).filter(|exponent| exponent.rem_euclid(step) == 0);
        let positive =
            exponents.flat_map(|exponent| digits.iter().map(move |digit| digit * power_of_ten(exponent)));
        let positive: Vec<f64> = positive.collect();
        let negative = positive.iter().rev().map(|value| -value).filter(|_| scale != AxisScale::Log);
        let zero = (scale != AxisScale::Log).then_some(0.0);
        let all = negative.chain(zero).chain(positive.iter().copied());
        all.filter(|value| within(&scale.position(*value))).collect()
    };
    let few = [
        (&[1.0, 2.0, 5.0][..], 1),
        (&[1.0], 1),
        (&[1.0], 2),
        (&[1.0], 3),
        (&[1.0], 5),
        (&[1.0], 10),
        (&[1.0], 20),
    ];
    let found = few.into_iter().map(|(digits, step)| powers(digits, step)).find(|all| all.len() <= most);
    match found {
        Some(all) if all.len() >= MIN_POWERS.min(most) => {
            let position = |value: f64| scale.position(value).clamp(range[0], range[1]);
            Ticks {
                ticks: all.into_iter().map(|value| (position(value), power_label(value))).collect(),
                note: None,
            }
        }
        _ => {
            let Ticks { ticks, note } = linear_ticks(ends, most);
            let ticks = ticks.into_iter().map(|(value, label)| (scale.position(value), label));
            Ticks { ticks: ticks.collect(), note }
        }
    }
}

/// Distance of positions that are the same but for rounding.
const SAME_POSITION: f64 = 1e-9;

/// Ticks at powers of ten, or 2 and 5 times these, that tell a scale.
const MIN_POWERS: usize = 2;

/// 10ⁿ, as it is written.
fn power_of_ten(exponent: i32) -> f64 {
    if exponent < 0 { 1.0 / 10_f64.powi(-exponent) } else { 10_f64.powi(exponent) }
}

/// "0.01", "500", "2·10⁻⁶".
fn power_label(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = (value.abs().log10() + SAME_POSITION).floor() as i32;
    let digit = (value.abs() / power_of_ten(exponent)).round();
    let sign = if value < 0.0 { "−" } else { "" };
    if PLAIN.contains(&exponent) {
        let decimals = (-exponent).max(0) as usize;
        return format!("{sign}{:.decimals$}", value.abs());
    }
    let factor = if digit == 1.0 { String::new() } else { format!("{digit}·") };
    format!("{sign}{factor}10{}", superscript(exponent))
}

/// Ticks at round values, at most so many, with labels as short as tell them apart.
fn linear_ticks(range: [f64; 2], most: usize) -> Ticks {
    let span = range[1] - range[0];
    let middle = 0.5 * range[0] + 0.5 * range[1];
    let offset = if middle.abs() > OFFSET * span && span > 0.0 {
        let round = 10_f64.powf(span.log10().ceil());
        multiple((range[0] / round).floor(), round)
    } else {
        0.0
    };
    let offsets = values_within([range[0] - offset, range[1] - offset], most, rounding(range));
    let largest = offsets.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let power = if largest > 0.0 { largest.log10().floor().max(-300.0) as i32 } else { 0 };
    let power = if PLAIN.contains(&power) { 0 } else { power };
    let scale = 10_f64.powi(-power);
    let gap = offsets.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let gap = if gap.is_finite() { gap } else { largest };
    let decimals =
        if gap > 0.0 { (-(gap * scale).log10() - 1e-9).ceil().clamp(0.0, 17.0) as usize } else { 0 };
    let at = |x: f64| (x + offset).max(range[0]).min(range[1]);
    let label = |&x: &f64| (at(x), format!("{:.decimals$}", x * scale + 0.0).replace('-', "−"));
    let mut notes = Vec::new();
    if power != 0 {
        notes.push(format!("×10{}", superscript(power)));
    }
    if offset != 0.0 {
        notes.push(format!("{} {}", if offset < 0.0 { '−' } else { '+' }, offset.abs()));
    }
    Ticks { ticks: offsets.iter().map(label).collect(), note: (!notes.is_empty()).then(|| notes.join(" ")) }
}

fn superscript(number: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32('⁰' as u32 + c as u32 - '0' as u32).unwrap_or(c),
    };
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f64; 2], most: usize) -> (Vec<String>, Option<String>) {
        let Ticks { ticks, note } = ticks(AxisScale::Linear, range, most);
        (ticks.into_iter().map(|(_, label)| label).collect(), note)
    }

    #[test]
    fn values_are_round_within_the_range_and_few() {
        assert_eq!(values([0.0, 1.0], 6), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(values([-0.31, 0.29], 4), [-0.2, 0.0, 0.2]);
        assert_eq!(values([23.0, 118.0], 5), [40.0, 60.0, 80.0, 100.0]);
        assert_eq!(values([1e-20, 3e-20], 3), [1e-20, 2e-20, 3e-20]);
        assert!(values([2.0, 2.0], 5).is_empty());
        assert!(values([f64::NAN, 2.0], 5).is_empty());
        for exponent in -300..300 {
            let range = [-3.3 * 10_f64.powi(exponent), 7.9 * 10_f64.powi(exponent)];
            let all = values(range, 7);
            assert!((3..=7).contains(&all.len()), "{range:?} {all:?}");
            assert!(all.iter().all(|x| (range[0]..=range[1]).contains(x)), "{range:?} {all:?}");
        }
    }

    #[test]
    fn labels_are_short_and_tell_ticks_apart() {
        let plain = |range, all: &[&str]| {
            assert_eq!(labels(range, 5), (all.iter().map(|x| x.to_string()).collect(), None))
        };
        plain([0.0, 1.0], &["0.0", "0.5", "1.0"]);
        plain([20.0, 100.0], &["20", "40", "60", "80", "100"]);
        plain([-1.0, 1.0], &["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(
            labels([0.0, 3e7], 4),
            (vec!["0".into(), "1".into(), "2".into(), "3".into()], Some("×10⁷".into()))
        );
        let (found, note) = labels([101325.0, 101325.01], 3);
        assert_eq!(
            (found, note.as_deref()),
            (vec!["0.000".into(), "0.005".into(), "0.010".into()], Some("+ 101325"))
        );
        assert_eq!(labels([1e8, 1e8 + 1e-2], 3).1.as_deref(), Some("+ 100000000"));
        assert_eq!(labels([0.0, 4e-6], 3).1.as_deref(), Some("×10⁻⁶"));
    }

    #[test]
    fn decades_have_their_powers() {
        let labels = |scale, range, most| -> Vec<String> {
            ticks(scale, range, most).ticks.into_iter().map(|(_, label)| label).collect()
        };
        let log = AxisScale::Log;
        assert_eq!(labels(log, [-6.0, 6.0], 4), ["10⁻⁵", "1", "10⁵"]);
        assert_eq!(labels(log, [-6.0, 6.0], 5), ["10⁻⁶", "0.001", "1", "1000", "10⁶"]);
        assert_eq!(labels(log, [-6.0, 6.0], 7), ["10⁻⁶", "10⁻⁴", "0.01", "1", "100", "10000", "10⁶"]);
        assert_eq!(labels(log, [0.0, 2.0], 9), ["1", "2", "5", "10", "20", "50", "100"]);
        assert_eq!(labels(log, [-7.0, -5.9], 9), ["10⁻⁷", "2·10⁻⁷", "5·10⁻⁷", "10⁻⁶"]);
        // Less than a decade: round values, where they lie.
        let part = ticks(log, [1.01, 1.2], 4);
        assert_eq!(part.ticks[0].1, "12");
        assert!((part.ticks[0].0 - 12_f64.log10()).abs() < 1e-12);
        let symlog = AxisScale::SymLog { linear_below: 1.0 };
        let ends = [-1000.0, 1000.0].map(|x| symlog.position(x));
        assert_eq!(labels(symlog, ends, 9), ["−1000", "−100", "−10", "−1", "0", "1", "10", "100", "1000"]);
        for most in 1..9 {
            let found = ticks(log, [-11.7, 8.3], most).ticks;
            assert!(!found.is_empty() && found.len() <= most, "{found:?}");
            assert!(found.windows(2).all(|pair| pair[0].0 < pair[1].0));
        }
    }
}
