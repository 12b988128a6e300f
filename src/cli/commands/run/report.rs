//! The report of a call, which is written as its runs end: what was said of them does not stay in memory.

use crate::core::{Error, Result};
use crate::io::{memory, provenance::whole_report};
use crate::nodes::files;
use serde_json::{Value, json};
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

/// Indentation of the runs, and of the steps of one, in the report.
const RUN: usize = 4;
const STEP: usize = 8;

/// Reports of the runs so far, in a file that has no name.
pub(super) struct ReportSpool {
    file: BufWriter<File>,
    pub run_count: usize,
    /// Steps of the run that is open.
    step_count: usize,
}

impl ReportSpool {
    /// A report without runs. Errors: no file can be made in the folder for temporary files.
    pub fn new() -> Result<ReportSpool> {
        let file = files::nameless().map_err(|error| unwritable(&error))?;
        Ok(ReportSpool { file: BufWriter::new(file), run_count: 0, step_count: 0 })
    }

    pub fn add_run(&mut self, run: &Value) -> Result<()> {
        let text = self.next_run(run);
        self.write(&text)
    }

    pub fn begin_series(&mut self, file: &str, title: Option<&str>) -> Result<()> {
        self.step_count = 0;
        let text = self.next_run(&json!({ "file": file, "title": title, "steps": [] }));
        // The list stays open.
        let open = text.rfind(']').map_or(text.len(), |end| end);
        self.write(&text[..open])
    }

    pub fn add_step(&mut self, step: &Value) -> Result<()> {
        let comma = if self.step_count > 0 { "," } else { "" };
        self.step_count += 1;
        self.write(&format!("{comma}\n{}", indented(step, STEP)))
    }

    pub fn end_series(&mut self) -> Result<()> {
        self.write(&format!("\n{0:1$}]\n{0:2$}}}", "", STEP - 2, RUN))
    }

    /// Writes the whole report.
    pub fn finish(self, path: &Path) -> Result<()> {
        let whole = format!("{:#}\n", whole_report(Vec::new(), memory::peak()));
        let (head, tail) = whole.split_once("[]").unwrap_or((&whole, ""));
        let mut runs = self.file.into_inner().map_err(|error| unwritable(error.error()))?;
        runs.rewind().map_err(|error| unwritable(&error))?;
        files::write_whole_in_parts(path, &mut |out| {
            write!(out, "{head}[")?;
            io::copy(&mut runs, out)?;
            write!(out, "\n  ]{tail}")
        })
    }

    fn next_run(&mut self, run: &Value) -> String {
        let comma = if self.run_count > 0 { "," } else { "" };
        self.run_count += 1;
        format!("{comma}\n{}", indented(run, RUN))
    }

    fn write(&mut self, text: &str) -> Result<()> {
        self.file.write_all(text.as_bytes()).map_err(|error| unwritable(&error))
    }
}

/// A value as text of lines that are indented. Texts within have no line breaks.
fn indented(value: &Value, depth: usize) -> String {
    let text = format!("{value:#}");
    let lines: Vec<String> = text.lines().map(|line| format!("{:depth$}{line}", "")).collect();
    lines.join("\n")
}

fn unwritable(error: &io::Error) -> Error {
    let error = Error::run("what the report says cannot be written beside it").got(error);
    error.expected("room in the folder for temporary files")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_in_parts_is_that_of_all_at_once_and_none_of_it_stays_in_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.json");
        let step =
            |number: usize| json!({ "step": number, "text": "a\n{\"[]\"}", "list": [], "all": [1, 2] });
        let mut spool = ReportSpool::new().unwrap();
        spool.add_run(&step(7)).unwrap();
        spool.begin_series("a]b.toml", Some("[]")).unwrap();
        let count = 1000;
        let capacity = spool.file.capacity();
        for number in 0..count {
            spool.add_step(&step(number)).unwrap();
            assert!(spool.file.buffer().len() <= capacity && spool.file.capacity() == capacity);
        }
        spool.end_series().unwrap();
        assert_eq!(spool.run_count, 2);
        spool.finish(&path).unwrap();
        let steps: Vec<Value> = (0..count).map(step).collect();
        let series = json!({ "file": "a]b.toml", "title": "[]", "steps": steps });
        let found: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(found["runs"], json!([step(7), series]));
        let whole = whole_report(vec![step(7), series], found["peak_memory_bytes"].as_u64());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), format!("{whole:#}\n"));
    }
}
