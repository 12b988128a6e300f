//! Selections of time steps: by their numbers, or by their times.

use std::collections::HashSet;
use std::str::FromStr;
use voltet_core::{Error, Result};

/// Forms of a selection by numbers, for errors.
const FORMS: &str = "all, or numbers and ranges FIRST:LAST or FIRST:LAST:STRIDE with commas between them, such as 3,5,9 or 0:10:2; \
                     -1 is the last";

/// Selection of steps by their numbers, in the order in which it names them: `all`, `7`, `3,5,9`, `0:365:5`, `-10:`. Both ends of a
/// range are included; a number below 0 counts from the end, -1 being the last.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StepSelection(Vec<StepRange>);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct StepRange {
    first: i64,
    last: i64,
    /// From one to the next, at least 1.
    stride: usize,
}

impl StepSelection {
    /// Every step.
    pub fn all() -> StepSelection {
        StepSelection(vec![StepRange { first: 0, last: -1, stride: 1 }])
    }

    /// The numbers of the steps in a series of so many, each once.
    ///
    /// # Errors
    /// - a number that the series does not have, a range that runs backwards.
    pub fn numbers(&self, count: usize) -> Result<Vec<usize>> {
        let mut numbers = Vec::new();
        for StepRange { first, last, stride } in &self.0 {
            let [from, to] = [number(*first, count)?, number(*last, count)?];
            if from > to {
                let error = Error::usage("the range of steps runs backwards").got(format!("{first}:{last}"));
                return Err(error
                    .expected(format!("the earlier step first: {from} and {to} of {count} are these two")));
            }
            numbers.extend((from..=to).step_by(*stride));
        }
        Ok(each_once(numbers, count))
    }
}

/// The numbers, all below a count, without those that came before.
fn each_once(mut numbers: Vec<usize>, count: usize) -> Vec<usize> {
    let mut is_chosen = vec![false; count];
    numbers.retain(|&step| !std::mem::replace(&mut is_chosen[step], true));
    numbers
}

/// The number from the start, of one that may be counted from the end.
fn number(given: i64, count: usize) -> Result<usize> {
    let number = if given < 0 { given + count as i64 } else { given };
    let found = usize::try_from(number).ok().filter(|number| *number < count);
    found.ok_or_else(|| {
        let error = Error::usage("the series has no such time step").got(given);
        error.expected(match count {
            0 => "data with time steps".into(),
            1 => "0: there is one step".into(),
            _ => format!("0 to {}, or -{count} to -1 from the end", count - 1),
        })
    })
}

impl FromStr for StepSelection {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if text.trim() == "all" {
            return Ok(StepSelection::all());
        }
        let ranges: Option<Vec<StepRange>> = text.split(',').map(step_range).collect();
        ranges.map(StepSelection).ok_or_else(|| format!("steps are {FORMS}"))
    }
}

/// "3", "0:10" or "0:10:2"; an end that is left out is that of the series.
fn step_range(text: &str) -> Option<StepRange> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let number = |at: usize, otherwise: i64| match parts.get(at).filter(|part| !part.is_empty()) {
        None => Some(otherwise),
        Some(part) => part.parse().ok(),
    };
    let first = number(0, 0)?;
    let last = number(1, if parts.len() == 1 { first } else { -1 })?;
    let stride = usize::try_from(number(2, 1)?).ok().filter(|stride| *stride > 0)?;
    let is_backwards = (first < 0) == (last < 0) && first > last;
    (!text.trim().is_empty() && parts.len() <= 3 && !is_backwards).then_some(StepRange {
        first,
        last,
        stride,
    })
}

/// Selection of steps by their times: `0.1:0.5` are those from one time to another, `0.3` is the step nearest to it, and `0:1:0.1` are those
/// nearest to 0, 0.1, … and 1.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeSelection(Vec<TimeRange>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum TimeRange {
    Nearest(f64),
    Within(f64, f64),
    /// From one time to another, by a stride above 0.
    Every(f64, f64, f64),
}

/// Most times of a selection: more are a mistake.
const MAX_TIMES: f64 = 1e6;

impl TimeSelection {
    /// The numbers of the steps in a series of these times, each once.
    ///
    /// # Errors
    /// - a time outside the series, a range without a step.
    pub fn numbers(&self, times: &[f64]) -> Result<Vec<usize>> {
        Ok(each_once(self.all(times)?.into_iter().map(|(step, _)| step).collect(), times.len()))
    }

    /// The times themselves, each once and with the number of the step nearest to it; of a range the times of its steps.
    ///
    /// # Errors
    /// - a time outside the series, a range without a step.
    pub fn times(&self, times: &[f64]) -> Result<Vec<(usize, f64)>> {
        let mut all = self.all(times)?;
        let mut known = HashSet::new();
        all.retain(|(_, time)| known.insert(time.to_bits()));
        Ok(all)
    }

    fn all(&self, times: &[f64]) -> Result<Vec<(usize, f64)>> {
        let [low, high] = ends(times);
        // Times were rounded when they were written, by both who wrote the file and who typed them.
        let margin = 1e-6 * (high - low).abs().max(high.abs());
        let nearest = |time: f64| {
            let distance = |step: &usize| (times[*step] - time).abs();
            let is_inside = (low - margin..=high + margin).contains(&time);
            let nearest = (0..times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let at = |step: usize| {
                let own = times[step];
                (step, if (own - time).abs() <= margin { own } else { time })
            };
            nearest.filter(|_| is_inside).map(at)
        };
        let mut all = Vec::new();
        for range in &self.0 {
            let own: Vec<(usize, f64)> = match *range {
                TimeRange::Nearest(time) => nearest(time).into_iter().collect(),
                TimeRange::Within(from, to) => {
                    let range = from - margin..=to + margin;
                    let within = (0..times.len()).filter(|step| range.contains(&times[*step]));
                    within.map(|step| (step, times[step])).collect()
                }
                TimeRange::Every(from, to, stride) => {
                    let (from, to) = (from.max(low), to.min(high) + margin);
                    let count = ((to - from) / stride).floor();
                    if count > MAX_TIMES {
                        let error = Error::usage("these are too many times").got(count);
                        return Err(error.expected(format!("a stride with up to {MAX_TIMES} times")));
                    }
                    // Below 0 there is none.
                    let count = if count >= 0.0 { count as usize + 1 } else { 0 };
                    (0..count).filter_map(|k| nearest(rounded(from + k as f64 * stride))).collect()
                }
            };
            if own.is_empty() {
                let found = match range {
                    TimeRange::Nearest(time) => time.to_string(),
                    TimeRange::Within(from, to) => format!("{from}:{to}"),
                    TimeRange::Every(from, to, stride) => format!("{from}:{to}:{stride}"),
                };
                let error = Error::usage("the series has no step at these times").got(found);
                return Err(error.expected(match times {
                    [] => "data with times".into(),
                    _ => format!("times from {low} to {high}"),
                }));
            }
            all.extend(own);
        }
        Ok(all)
    }
}

/// A sum without the last digits, which rounding makes: 0.15 for 0.1 + 0.05.
fn rounded(time: f64) -> f64 {
    format!("{time:.14e}").parse().unwrap_or(time)
}

/// The least and the largest time.
fn ends(times: &[f64]) -> [f64; 2] {
    let wider = |[low, high]: [f64; 2], time: &f64| [low.min(*time), high.max(*time)];
    times.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider)
}

impl FromStr for TimeSelection {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let number = |text: &str, otherwise: f64| match text.trim() {
            "" => Some(otherwise),
            text => text.parse::<f64>().ok().filter(|time| time.is_finite()),
        };
        let range = |part: &str| {
            let parts: Vec<&str> = part.split(':').collect();
            let ends = |from: &str, to: &str| {
                let (from, to) = (number(from, f64::NEG_INFINITY)?, number(to, f64::INFINITY)?);
                (from <= to).then_some((from, to))
            };
            match parts[..] {
                [time] => number(time, f64::NAN).filter(|time| !time.is_nan()).map(TimeRange::Nearest),
                [from, to] => ends(from, to).map(|(from, to)| TimeRange::Within(from, to)),
                [from, to, stride] => {
                    let stride = number(stride, f64::NAN).filter(|stride| *stride > 0.0)?;
                    ends(from, to).map(|(from, to)| TimeRange::Every(from, to, stride))
                }
                _ => None,
            }
        };
        let ranges: Option<Vec<TimeRange>> = text.split(',').map(range).collect();
        ranges.map(TimeSelection).ok_or_else(|| {
            "times are numbers and ranges FROM:TO or FROM:TO:STRIDE with commas between them, such as 0.1:0.5".to_string()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(text: &str) -> Vec<usize> {
        text.parse::<StepSelection>().unwrap().numbers(11).unwrap()
    }

    #[test]
    fn steps_are_named_by_numbers_and_ranges_from_both_ends() {
        assert_eq!(steps("all").len(), 11);
        assert_eq!(steps("7"), [7]);
        assert_eq!(steps("9,3,5,3"), [9, 3, 5]);
        assert_eq!(steps("0::4"), [0, 4, 8]);
        assert_eq!(steps("2:6:2"), [2, 4, 6]);
        assert_eq!(steps("-3:"), [8, 9, 10]);
        assert_eq!(steps(":-9"), [0, 1, 2]);
        assert_eq!(steps("-1"), [10]);
    }

    #[test]
    fn what_is_no_selection_is_refused() {
        for text in ["", "a", "3:1", "-1:-3", "1:2:0", "1:2:-1", "1:2:3:4", "1,,2", "1.5"] {
            assert!(text.parse::<StepSelection>().is_err(), "{text}");
        }
        let error = |text: &str| text.parse::<StepSelection>().unwrap().numbers(11).unwrap_err().to_string();
        assert!(error("0:11").contains("0 to 10"));
        assert!(error("-12").contains("found -12"));
        assert!(error("8:-5").contains("backwards"));
        let of_none = "0".parse::<StepSelection>().unwrap().numbers(0).unwrap_err();
        assert!(of_none.to_string().contains("data with time steps"));
    }

    #[test]
    fn times_name_the_steps_within_them_and_the_nearest() {
        let times = [0.0, 0.1, 0.2, 0.30000000000000004, 0.4];
        let numbers = |text: &str| text.parse::<TimeSelection>().unwrap().numbers(&times);
        assert_eq!(numbers("0.1:0.3").unwrap(), [1, 2, 3]);
        assert_eq!(numbers("0.26").unwrap(), [3]);
        assert_eq!(numbers(":0.1,0.4").unwrap(), [0, 1, 4]);
        assert_eq!(numbers("0:0.4:0.2").unwrap(), [0, 2, 4]);
        assert_eq!(numbers("::0.04").unwrap(), [0, 1, 2, 3, 4], "each step once");
        let own = |text: &str| text.parse::<TimeSelection>().unwrap().times(&times).unwrap();
        assert_eq!(
            own("0.375:0.4:0.0125,0.3875,0.1:0.2"),
            [(4, 0.375), (4, 0.3875), (4, 0.4), (1, 0.1), (2, 0.2)]
        );
        assert!(numbers("0:0.4:1e-9").unwrap_err().to_string().contains("too many"));
        assert!(numbers("0.5").unwrap_err().to_string().contains("times from 0 to 0.4"));
        assert!(numbers("0.11:0.19").is_err());
        for text in ["", "a", "2:1", "nan", "inf:", "0:1:0", "0:1:-1", "0:1:a", "0:1:1:1"] {
            assert!(text.parse::<TimeSelection>().is_err(), "{text}");
        }
    }
}
