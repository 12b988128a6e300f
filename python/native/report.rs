//! Reports, put into words when they are asked for.

use pyo3::prelude::*;
use voltet_embed::Account;
use voltet_io::provenance::whole_report;

/// What was done by a run.
#[pyclass(frozen, module = "voltet._native")]
pub struct Report(Option<Account>);

impl Report {
    pub fn new(account: Option<Account>) -> Report {
        Report(account)
    }
}

#[pymethods]
impl Report {
    /// What `voltet run --report` says, as JSON; the peak of memory is that until now.
    fn json(&self) -> String {
        whole_report(self.0.iter().map(Account::words).collect()).to_string()
    }
}
