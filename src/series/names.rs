//! Names of the files of frames: marks such as `{step:04}` in a path, and what is added where a path has none.

use std::path::Path;
use voltet_core::{Error, Result};
use voltet_nodes::files::{is_standard_output, is_stream};

/// Digits of a number that is added to a name.
const DIGITS: usize = 4;

/// Values of the marks of one frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MarkValues {
    /// `{frame}`: number of the frame, from 0.
    pub frame: usize,
    /// `{step}`: number of its time step; 0 where the data are no series.
    pub step: usize,
    /// `{time}`: its time, where the data have times.
    pub time: Option<f64>,
    /// `{stem}`: name of its data file without ending.
    pub stem: Option<String>,
    /// Number of its place on the camera's way, where frames differ in that alone.
    pub turn: usize,
    /// `{sweep}`: number of its combination of values, from 0.
    pub sweep: usize,
}

/// Quantities in which frames differ, each with the marks that tell them apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Varying {
    /// The data file.
    File,
    /// The time step.
    Step,
    /// The values of parameters.
    Sweep,
    /// The camera.
    Turn,
}

/// True if a path has one of these marks.
pub fn names(path: &str, marks: &[&str]) -> bool {
    marks_of(path).any(|(_, mark)| marks.contains(&mark.name))
}

/// The path of a frame: each mark replaced, and for each quantity that varies without a mark its value added before the ending.
///
/// # Errors
/// - the time of data without times, the name of a data file that there is not, the standard output for several frames.
pub fn path_of(pattern: &str, marks: &MarkValues, varying: &[Varying]) -> Result<String> {
    let mut path = String::new();
    let mut end = 0;
    for (range, mark) in marks_of(pattern) {
        path += &pattern[end..range.start];
        path += &mark.text(marks)?;
        end = range.end;
    }
    path += &pattern[end..];
    let missing: Vec<String> =
        varying.iter().filter(|kind| !kind.is_named(pattern)).map(|kind| kind.suffix(marks)).collect();
    if missing.is_empty() {
        return Ok(path);
    }
    if is_stream(&path) && !is_standard_output(Path::new(&path)) {
        return Ok(path);
    }
    if is_standard_output(Path::new(&path)) {
        let error = Error::usage("several files would be written to the standard output").got(pattern);
        return Err(error.expected("the path of a file, or one frame alone"));
    }
    let ending = Path::new(&path).extension().map_or(0, |ending| ending.len() + 1);
    path.insert_str(path.len() - ending, &missing.concat());
    Ok(path)
}

impl Varying {
    /// All, in the order in which they stand in names.
    pub const ALL: [Varying; 4] = [Varying::File, Varying::Step, Varying::Sweep, Varying::Turn];

    /// True if two frames differ in it.
    pub fn differs(self, a: &MarkValues, b: &MarkValues) -> bool {
        match self {
            Varying::File => a.stem != b.stem,
            Varying::Step => a.step != b.step || a.time != b.time,
            Varying::Sweep => a.sweep != b.sweep,
            Varying::Turn => a.turn != b.turn,
        }
    }

    fn is_named(self, pattern: &str) -> bool {
        names(
            pattern,
            match self {
                Varying::File => &["stem", "frame"],
                Varying::Step => &["step", "time", "frame"],
                Varying::Sweep => &["sweep", "frame"],
                Varying::Turn => &["frame"],
            },
        )
    }

    /// Value of the quantity, for a name without its mark.
    fn suffix(self, marks: &MarkValues) -> String {
        match self {
            Varying::File => format!("_{}", marks.stem.as_deref().unwrap_or_default()),
            Varying::Step => format!("_{:0DIGITS$}", marks.step),
            Varying::Sweep => format!("_{:0DIGITS$}", marks.sweep),
            Varying::Turn => format!("_{:0DIGITS$}", marks.frame),
        }
    }
}

/// A mark in a path: "{name}" or "{name:form}".
struct Mark<'a> {
    name: &'a str,
    form: NumberFormat,
}

#[derive(Clone, Copy)]
enum NumberFormat {
    Plain,
    /// Digits of a whole number, filled with zeros: ":04".
    Digits(usize),
    /// Decimals: ":.3".
    Decimals(usize),
}

impl Mark<'_> {
    /// The mark between two braces; `None` for other text, which stands in a path as it is.
    fn read(text: &str) -> Option<Mark<'_>> {
        let (name, form) = text.split_once(':').map_or((text, None), |(name, form)| (name, Some(form)));
        let number = |text: &str| text.parse::<usize>().ok().filter(|number| *number < 20);
        let form = match (name, form) {
            ("step" | "frame" | "sweep" | "time" | "stem", None) => NumberFormat::Plain,
            ("step" | "frame" | "sweep", Some(form)) => {
                NumberFormat::Digits(number(form.strip_prefix('0')?)?)
            }
            ("time", Some(form)) => NumberFormat::Decimals(number(form.strip_prefix('.')?)?),
            _ => return None,
        };
        Some(Mark { name, form })
    }

    fn text(&self, marks: &MarkValues) -> Result<String> {
        let missing = |what: &str, expected: &str| {
            Error::usage(format!("the name of a file has the mark {{{}}}, and {what}", self.name))
                .expected(expected)
        };
        let number = match self.name {
            "time" => {
                let time = marks
                    .time
                    .ok_or_else(|| missing("the data have no times", "{step}, or data with times"))?;
                return Ok(match self.form {
                    NumberFormat::Decimals(decimals) => format!("{time:.decimals$}"),
                    _ => format!("{time}"),
                });
            }
            "stem" => {
                let none = || missing("no node reads a file", "a node that reads a file, or another mark");
                return marks.stem.clone().ok_or_else(none);
            }
            "step" => marks.step,
            "sweep" => marks.sweep,
            _ => marks.frame,
        };
        Ok(match self.form {
            NumberFormat::Digits(digits) => format!("{number:0digits$}"),
            _ => number.to_string(),
        })
    }
}

fn marks_of(path: &str) -> impl Iterator<Item = (std::ops::Range<usize>, Mark<'_>)> {
    path.match_indices('{').filter_map(|(start, _)| {
        let length = path[start..].find('}')?;
        let mark = Mark::read(&path[start + 1..start + length])?;
        Some((start..start + length + 1, mark))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks() -> MarkValues {
        MarkValues { frame: 12, step: 7, time: Some(0.25), stem: Some("run".into()), turn: 0, sweep: 3 }
    }

    #[test]
    fn marks_are_replaced_and_other_braces_stay() {
        let path = |pattern: &str| path_of(pattern, &marks(), &[]).unwrap();
        assert_eq!(path("{stem}_{step:04}.png"), "run_0007.png");
        assert_eq!(path("{step}/{time}_{time:.3}_{sweep:02}_{frame}.exr"), "7/0.25_0.250_03_12.exr");
        for plain in ["a.png", "{a}.png", "{step", "{step:4}.png", "{time:03}.png", "{stem:01}.png", "{}"] {
            assert_eq!(path(plain), plain);
        }
    }

    #[test]
    fn quantities_without_a_mark_are_added_before_the_ending() {
        let path = |pattern: &str, varying: &[Varying]| path_of(pattern, &marks(), varying).unwrap();
        assert_eq!(path("a.b.png", &[Varying::Step]), "a.b_0007.png");
        assert_eq!(path("a", &[Varying::Step]), "a_0007");
        assert_eq!(path("a_{time}.png", &[Varying::Step]), "a_0.25.png");
        assert_eq!(path("a.png", &[Varying::File, Varying::Step]), "a_run_0007.png");
        assert_eq!(path("{step}.png", &[Varying::Step, Varying::Sweep]), "7_0003.png");
        assert_eq!(path("{frame}.png", &[Varying::File, Varying::Step, Varying::Sweep]), "12.png");
        let error = path_of("-", &marks(), &[Varying::Step]).unwrap_err().to_string();
        assert!(error.contains("the standard output"), "{error}");
    }

    #[test]
    fn a_time_that_is_not_there_is_refused() {
        let error = path_of("{time}.png", &MarkValues::default(), &[]).unwrap_err().to_string();
        assert!(error.contains("no times"), "{error}");
    }
}
