//! Case files of EnSight: the file of the geometry, those of the variables, and the times of their steps.

use crate::formats::cursor::{Cursor, Place};
use crate::formats::source::Source;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
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

/// Files that hold several steps each.
struct FileSet {
    number: u64,
    /// For each file the number in its name, 0 where there is but one, and its steps.
    files: Vec<(u64, u64)>,
}

/// A file, or one for each step of a time set where its name has asterisks; with a file set, files of several steps.
#[derive(Default)]
pub(super) struct FilePattern {
    time_set: Option<u64>,
    file_set: Option<u64>,
    name: String,
}

impl FilePattern {
    fn new(numbers: &[u64], name: &str) -> FilePattern {
        FilePattern {
            time_set: numbers.first().copied(),
            file_set: numbers.get(1).copied(),
            name: name.to_owned(),
        }
    }
}

/// A file, and the number from 0 of a step in it where it holds several.
pub(super) struct StepFile {
    pub path: PathBuf,
    pub step: Option<u64>,
    /// Place behind the mark of the step, once it was found.
    pub start: OnceLock<Place>,
}

pub(super) struct CaseVariable {
    pub name: String,
    pub association: Association,
    pub component_count: usize,
    pub pattern: FilePattern,
}

#[derive(Default)]
pub(super) struct CaseFile {
    folder: PathBuf,
    pub geometry: FilePattern,
    pub variables: Vec<CaseVariable>,
    /// Variables of kinds that are not read: complex ones, those of measured particles.
    pub left_out: Vec<String>,
    time_sets: Vec<TimeSet>,
    file_sets: Vec<FileSet>,
    /// True in the section about file sets.
    is_of_files: bool,
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
    pub fn read(source: &Arc<Source>) -> Result<CaseFile> {
        let folder = source.path().parent().unwrap_or(Path::new("")).to_owned();
        let mut case = CaseFile { folder, ..CaseFile::default() };
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
            let (numbers, words) = numbers_first(value, 2);
            let [name, file] = &words[..] else {
                let error = Error::run("a variable of the case is damaged").got(format_args!("'{value}'"));
                return Err(
                    error.expected("the numbers of a time set and a file set, or none, a name and a file")
                );
            };
            let pattern = FilePattern::new(&numbers, file);
            self.variables.push(CaseVariable { name: name.clone(), association, component_count, pattern });
            return Ok(());
        }
        match key {
            _ if key.starts_with("complex ") || key.contains(" per measured node") => {
                self.left_out.extend(numbers_first(value, 2).1.into_iter().next());
            }
            "" => self.is_of_files = value.eq_ignore_ascii_case("file"),
            "file set" => {
                let number = first_word(value).parse().map_err(|_| damaged(key, value))?;
                self.file_sets.push(FileSet { number, files: Vec::new() });
            }
            _ => {}
        }
        if let Some(set) = self.file_sets.last_mut().filter(|_| self.is_of_files) {
            match key {
                "filename index" => set.files.push((value.parse().map_err(|_| damaged(key, value))?, 0)),
                "number of steps" => {
                    let count = value.parse().map_err(|_| damaged(key, value))?;
                    match set.files.last_mut().filter(|file| file.1 == 0) {
                        Some(file) => file.1 = count,
                        None => set.files.push((0, count)),
                    }
                }
                _ => {}
            }
            return Ok(());
        }
        let set = self.time_sets.last_mut();
        match (key, set) {
            ("type", _) if !value.to_lowercase().contains("gold") => {
                let error =
                    Error::run("this type of EnSight case is not read").got(format_args!("'{value}'"));
                Err(error.expected(
                    "ensight gold, or a .vtu file: ParaView reads EnSight 6 and saves its data as .vtu",
                ))
            }
            ("model", _) => {
                let (numbers, words) = numbers_first(value, 1);
                if let Some(word) = words.get(1) {
                    let error = Error::run("a model of which parts alone change is not read");
                    return Err(error
                        .got(format_args!("'{word}'"))
                        .expected("a file for each step, with all of the geometry"));
                }
                self.geometry = FilePattern::new(&numbers, words.first().map_or("", String::as_str));
                Ok(())
            }
            ("time set", _) => {
                let number = first_word(value);
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

    /// The file of a pattern at a time, and the step in it: the last until then.
    pub fn file(&self, pattern: &FilePattern, time: Option<f64>) -> Result<StepFile> {
        let in_folder = |name: &str, step: Option<u64>| StepFile {
            path: self.folder.join(name),
            step,
            start: OnceLock::new(),
        };
        let has_stars = pattern.name.contains('*');
        if !has_stars && pattern.file_set.is_none() {
            return Ok(in_folder(&pattern.name, None));
        }
        let found =
            self.time_sets.iter().find(|set| pattern.time_set.is_none_or(|number| set.number == number));
        let set = found.ok_or_else(|| {
            let error = Error::run("a file of the case changes with a time set that does not exist");
            error.got(format_args!("'{}'", pattern.name)).expected("a section TIME")
        })?;
        let step = set.times.iter().rposition(|&own| time.is_none_or(|time| own <= time)).unwrap_or(0);
        let Some(number) = pattern.file_set else {
            return Ok(in_folder(&numbered(&pattern.name, set.file_number(step)?)?, None));
        };
        let files = self.file_sets.iter().find(|set| set.number == number).ok_or_else(|| {
            let error = Error::run("a file of the case is of a file set that does not exist").got(number);
            error.expected("a section FILE with it")
        })?;
        let mut left = step as u64;
        for &(index, count) in &files.files {
            if left < count {
                let name = if has_stars { numbered(&pattern.name, index)? } else { pattern.name.clone() };
                return Ok(in_folder(&name, Some(left)));
            }
            left -= count;
        }
        let error = Error::run("the file set has too few steps").got(step as u64 - left);
        Err(error.expected(format_args!("{}, as of 'time values'", set.times.len())))
    }
}

impl TimeSet {
    fn file_number(&self, step: usize) -> Result<u64> {
        let counted =
            (step as u64).checked_mul(self.increment).and_then(|steps| self.start.checked_add(steps));
        match self.file_numbers.get(step) {
            Some(&number) => Ok(number),
            None if self.file_numbers.is_empty() => {
                counted.ok_or_else(|| damaged("filename increment", &self.increment.to_string()))
            }
            None => {
                let error =
                    Error::run("the case has too few 'filename numbers'").got(self.file_numbers.len());
                Err(error.expected(format_args!("{}, as of 'time values'", self.times.len())))
            }
        }
    }
}

/// A name with a number in the place of its asterisks.
fn numbered(name: &str, number: u64) -> Result<String> {
    let first = name.find('*').unwrap_or(name.len());
    let rest = name[first..].trim_start_matches('*');
    if rest.contains('*') {
        let error = Error::run("the name of a file has asterisks in several places");
        return Err(error.got(format_args!("'{name}'")).expected("asterisks in one place"));
    }
    let number = number.to_string();
    let zeros = "0".repeat((name.len() - first - rest.len()).saturating_sub(number.len()));
    Ok(format!("{}{zeros}{number}{rest}", &name[..first]))
}

fn first_word(value: &str) -> &str {
    value.split_ascii_whitespace().next().unwrap_or_default()
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

/// The numbers of a time set and of a file set, if such stand before the last `count` words, and the words after them; words may stand
/// in quotes.
fn numbers_first(value: &str, count: usize) -> (Vec<u64>, Vec<String>) {
    let mut words: Vec<String> = Vec::new();
    for (place, part) in value.split('"').enumerate() {
        match place % 2 {
            1 => words.push(part.to_owned()),
            _ => words.extend(part.split_ascii_whitespace().map(str::to_owned)),
        }
    }
    let before = words.iter().take(words.len().saturating_sub(count).min(2));
    let numbers: Vec<u64> = before.map_while(|word| word.parse().ok()).collect();
    let rest = words.split_off(numbers.len());
    (numbers, rest)
}
