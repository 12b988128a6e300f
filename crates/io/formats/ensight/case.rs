//! Case files of EnSight: the file of the geometry, those of the variables, and the times of their steps.

use crate::formats::cursor::Cursor;
use crate::formats::source::Source;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Steps of a time set.
#[derive(Default)]
struct TimeSet {
    number: u64,
    times: Vec<f64>,
    /// Numbers in the names of files.
    file_numbers: Vec<u64>,
    start: u64,
    increment: u64,
}

/// A file, or one for each step of a time set where its name has asterisks.
pub(super) struct FilePattern {
    time_set: Option<u64>,
    name: String,
}

/// A variable of a case.
pub(super) struct CaseVariable {
    pub name: String,
    pub association: Association,
    pub component_count: usize,
    pub pattern: FilePattern,
}

/// Contents of a case file.
pub(super) struct CaseFile {
    folder: PathBuf,
    pub geometry: FilePattern,
    pub variables: Vec<CaseVariable>,
    time_sets: Vec<TimeSet>,
}

/// Kinds of variables: first words of their lines, location, number of components.
const KINDS: [(&str, Association, usize); 10] = [
    ("scalar per node", Association::Point, 1),
    ("vector per node", Association::Point, 3),
    ("tensor symm per node", Association::Point, 6),
    ("tensor asym per node", Association::Point, 9),
    ("tensor per node", Association::Point, 6),
    ("scalar per element", Association::Cell, 1),
    ("vector per element", Association::Cell, 3),
    ("tensor symm per element", Association::Cell, 6),
    ("tensor asym per element", Association::Cell, 9),
    ("tensor per element", Association::Cell, 6),
];

impl CaseFile {
    /// Reads it.
    pub fn read(source: &Arc<Source>) -> Result<CaseFile> {
        let mut case = CaseFile {
            folder: source.path().parent().unwrap_or(Path::new("")).to_owned(),
            geometry: FilePattern { time_set: None, name: String::new() },
            variables: Vec::new(),
            time_sets: Vec::new(),
        };
        let mut cursor = Cursor::new(source);
        // Key of the line before, which a line of numbers alone goes on with.
        let mut last = String::new();
        while let Some(line) = cursor.line()? {
            let line = String::from_utf8_lossy(line).trim().to_owned();
            if line.starts_with('#') || line.is_empty() {
                continue;
            }
            let is_number =
                line.starts_with(|letter: char| letter.is_ascii_digit() || "+-.".contains(letter));
            let (key, value) = match line.split_once(':') {
                Some(entry) => entry,
                None if is_number => (last.as_str(), line.as_str()),
                None => ("", line.as_str()),
            };
            let key = key.trim().to_lowercase();
            case.line(&key, value.trim()).map_err(|error| error.at_line(cursor.last_line()))?;
            last = key;
        }
        if case.geometry.name.is_empty() {
            return Err(Error::run("the case has no geometry").expected("a line 'model:' with a file"));
        }
        Ok(case)
    }

    fn line(&mut self, key: &str, value: &str) -> Result<()> {
        if let Some(&(_, association, component_count)) = KINDS.iter().find(|kind| kind.0 == key) {
            let (time_set, words) = numbers_first(value)?;
            let [name, file] = &words[..] else {
                let error = Error::run("a variable of the case is damaged").got(format_args!("'{value}'"));
                return Err(error.expected("the number of a time set, or none, a name and a file"));
            };
            let pattern = FilePattern { time_set, name: file.clone() };
            self.variables.push(CaseVariable { name: name.clone(), association, component_count, pattern });
            return Ok(());
        }
        let set = self.time_sets.last_mut();
        match (key, set) {
            ("type", _) if !value.to_lowercase().contains("gold") => {
                Err(Error::run("this type of EnSight case is not read").got(value).expected("ensight gold"))
            }
            ("model", _) => {
                let (time_set, words) = numbers_first(value)?;
                let name = words.into_iter().next().unwrap_or_default();
                self.geometry = FilePattern { time_set, name };
                Ok(())
            }
            ("time set", _) => {
                let number = value.split_ascii_whitespace().next().unwrap_or_default();
                self.time_sets.push(TimeSet {
                    number: number.parse().map_err(|_| damaged(key, number))?,
                    increment: 1,
                    ..TimeSet::default()
                });
                Ok(())
            }
            ("filename start number", Some(set)) => {
                set.start = value.parse().map_err(|_| damaged(key, value))?;
                Ok(())
            }
            ("filename increment", Some(set)) => {
                set.increment = value.parse().map_err(|_| damaged(key, value))?;
                Ok(())
            }
            ("filename numbers file" | "time values file", _) => {
                let error = Error::run("numbers in a file of their own are not read");
                Err(error
                    .got(format_args!("{key}: {value}"))
                    .expected("'filename numbers' and 'time values'"))
            }
            ("filename numbers", Some(set)) => push_numbers(&mut set.file_numbers, key, value),
            ("time values", Some(set)) => push_numbers(&mut set.times, key, value),
            _ => Ok(()),
        }
    }

    /// Times of all steps, ascending; none where nothing changes.
    pub fn times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.time_sets.iter().flat_map(|set| set.times.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// The file of a pattern at a time: that of the last step until then.
    pub fn file(&self, pattern: &FilePattern, time: Option<f64>) -> Result<PathBuf> {
        let Some(first) = pattern.name.find('*') else { return Ok(self.folder.join(&pattern.name)) };
        let rest = pattern.name[first..].trim_start_matches('*');
        if rest.contains('*') {
            let error = Error::run("the name of a file has asterisks in several places");
            return Err(error.got(format_args!("'{}'", pattern.name)).expected("asterisks in one place"));
        }
        let found =
            self.time_sets.iter().find(|set| pattern.time_set.is_none_or(|number| set.number == number));
        let set = found.ok_or_else(|| {
            let error = Error::run("a file of the case changes with a time set that does not exist");
            error.got(format_args!("'{}'", pattern.name)).expected("a section TIME")
        })?;
        let step = set.times.iter().rposition(|&own| time.is_none_or(|time| own <= time)).unwrap_or(0);
        let counted = (step as u64).checked_mul(set.increment).and_then(|steps| set.start.checked_add(steps));
        let number = match set.file_numbers.get(step) {
            Some(&number) => number,
            None if set.file_numbers.is_empty() => {
                counted.ok_or_else(|| damaged("filename increment", &set.increment.to_string()))?
            }
            None => {
                let error = Error::run("the case has too few 'filename numbers'").got(set.file_numbers.len());
                return Err(error.expected(format_args!("{}, as of 'time values'", set.times.len())));
            }
        };
        let number = number.to_string();
        let star_count = pattern.name.len() - first - rest.len();
        let zeros = "0".repeat(star_count.saturating_sub(number.len()));
        Ok(self.folder.join(format!("{}{zeros}{number}{rest}", &pattern.name[..first])))
    }
}

fn damaged(key: &str, value: &str) -> Error {
    Error::run(format!("'{key}' of the case is damaged")).got(format_args!("'{value}'")).expected("a number")
}

fn push_numbers<T: std::str::FromStr>(numbers: &mut Vec<T>, key: &str, value: &str) -> Result<()> {
    for word in value.split_ascii_whitespace() {
        numbers.push(word.parse().map_err(|_| damaged(key, word))?);
    }
    Ok(())
}

/// The number of a time set, if one stands first, and the words after it; words may stand in quotes.
fn numbers_first(value: &str) -> Result<(Option<u64>, Vec<String>)> {
    let mut words: Vec<String> = Vec::new();
    for (place, part) in value.split('"').enumerate() {
        match place % 2 {
            1 => words.push(part.to_owned()),
            _ => words.extend(part.split_ascii_whitespace().map(str::to_owned)),
        }
    }
    let is_number = |word: &String| word.bytes().all(|byte| byte.is_ascii_digit());
    let count = words.iter().take(words.len().saturating_sub(1)).take_while(|word| is_number(word)).count();
    if count > 1 {
        let error = Error::run("files that hold several steps are not read").got(format_args!("'{value}'"));
        return Err(error.expected("a file for each step, with asterisks in its name"));
    }
    let time_set = words.first().filter(|_| count == 1).and_then(|word| word.parse().ok());
    Ok((time_set, words.split_off(count)))
}
