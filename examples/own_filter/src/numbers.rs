//! `numbers`: a reader of a format of its own, a box of values: "numbers 3 4 5", then 3 × 4 × 5 of them, x running fastest.

use std::fs;
use std::path::Path;
use voltet::core::glam::DVec3;
use voltet::core::grid::{Association, Cells};
use voltet::core::progress::Progress;
use voltet::core::reading::{FileArray, GridHead, GridRead, GridReader, OpenGrid};
use voltet::core::{Error, Result};
use voltet::graph::{DefaultValue, Parameter, ParameterType, Parameters, Range, VariantSchema};

/// A reader has no state: all that it goes by is given to it.
pub struct Numbers;

const DECLARATION: VariantSchema = VariantSchema {
    name: "numbers",
    summary: "Reads a box of values: their counts along x, y and z, then the values.",
    // Beside what every reader has: path, scalar, time_step, ...
    parameters: &[Parameter {
        name: "spacing",
        parameter_type: ParameterType::Number(Range::above(0.0)),
        unit: "world units",
        default: DefaultValue::Number(1.0),
        help: "the distance of neighbouring values",
    }],
};

/// First bytes of a file.
const MAGIC: &str = "numbers ";

/// A file whose first line was read.
struct Open {
    text: String,
    counts: [usize; 3],
    spacing: f64,
    head: GridHead,
}

impl GridReader for Numbers {
    fn declaration(&self) -> VariantSchema {
        DECLARATION
    }

    fn matches(&self, head: &[u8], _path: &Path) -> bool {
        head.starts_with(MAGIC.as_bytes())
    }

    fn files(&self) -> String {
        "a text that begins with \"numbers\"".into()
    }

    fn open(
        &self,
        path: &Path,
        _step: usize,
        parameters: &Parameters,
        _progress: &dyn Progress,
    ) -> Result<Box<dyn OpenGrid>> {
        let text =
            fs::read_to_string(path).map_err(|error| Error::run("the file cannot be read").got(error))?;
        let line = text.lines().next().unwrap_or_default();
        let counts: Vec<usize> =
            line.split_whitespace().skip(1).filter_map(|word| word.parse().ok()).collect();
        let [x, y, z] = counts[..] else {
            return Err(Error::run("the counts are missing").got(line).expected("\"numbers 3 4 5\""));
        };
        let product = |counts: [usize; 3]| counts.iter().try_fold(1usize, |all, &n| all.checked_mul(n));
        let fits = product([x, y, z]).filter(|&points| x.min(y).min(z) > 1 && points <= text.len());
        let Some(point_count) = fits else {
            let wrong = Error::run("the counts do not fit the file").got(line);
            return Err(wrong.expected("2 or more along each axis, and as many values"));
        };
        let head = GridHead {
            format: "box of numbers, text".into(),
            point_count: point_count as u64,
            cell_count: ((x - 1) * (y - 1) * (z - 1)) as u64,
            // A box needs no list of its cells.
            cell_bytes: 0,
            arrays: vec![FileArray {
                name: "value".into(),
                association: Association::Point,
                component_count: 1,
            }],
            scalar: None,
            times: Vec::new(),
        };
        let spacing = parameters.number("spacing")?;
        Ok(Box::new(Open { text, counts: [x, y, z], spacing, head }))
    }
}

impl OpenGrid for Open {
    fn head(&self) -> &GridHead {
        &self.head
    }

    /// Only what somebody looks at is asked for.
    fn read(&self, geometry: bool, arrays: &[usize], _progress: &dyn Progress) -> Result<GridRead> {
        let [x, y, z] = self.counts;
        let point = |i: usize| DVec3::new((i % x) as f64, (i / x % y) as f64, (i / (x * y)) as f64);
        let points = || (0..x * y * z).map(|i| point(i) * self.spacing).collect();
        let values = |_: &usize| {
            let words = self.text.lines().skip(1).flat_map(str::split_whitespace);
            let number =
                |word: &str| word.parse::<f64>().map_err(|_| Error::run("this is no number").got(word));
            let values: Vec<f64> = words.map(number).collect::<Result<_>>()?;
            match values.len() == x * y * z {
                true => Ok(values),
                false => Err(Error::run("the values are not as many").got(values.len()).expected(x * y * z)),
            }
        };
        Ok(GridRead {
            points: geometry.then(points),
            cells: geometry.then_some(Cells::Structured([x, y, z])),
            arrays: arrays.iter().map(values).collect::<Result<_>>()?,
            warnings: Vec::new(),
        })
    }
}
