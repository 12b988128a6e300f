//! Reports, which are made when they are read.

use pyo3::prelude::*;
use voltet::RunRecord;
use voltet_io::provenance::whole_report;

/// Report of a run.
#[pyclass(frozen, module = "voltet._native")]
pub struct Report(Option<RunRecord>);

impl Report {
    pub fn new(record: Option<RunRecord>) -> Report {
        Report(record)
    }
}

#[pymethods]
impl Report {
    /// The report of `voltet run --report` (JSON); the peak of memory is that until now.
    fn json(&self) -> String {
        whole_report(self.0.iter().map(RunRecord::to_json).collect()).to_string()
    }
}
