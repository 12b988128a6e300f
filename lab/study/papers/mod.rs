//! The tables and figures of the papers that this program follows, made anew: what is printed beside what is found here.
//!
//! Most of the papers' data cannot be had. What stands in for them is said beside each figure; then ratios can be compared, and
//! which of two ways is the better, but no absolute time or picture.

mod bench;
mod kniss;
mod moreland;
mod roettger_ertl;
mod song;

pub use bench::{FOLDER, Figure, OpenPipeline, Paper, PapersOptions, Section, page};

use bench::Bench;
use voltet_core::Result;
use voltet_core::progress::Progress;

/// Makes the sections, paper by paper. Errors: a pipeline that is not there or cannot be drawn, a stopped run.
pub fn papers(wish: &PapersOptions, open: &OpenPipeline, progress: &dyn Progress) -> Result<Vec<Section>> {
    let mut sections = Vec::new();
    for (k, paper) in wish.papers.iter().enumerate() {
        progress.report(paper.name(), k as f64 / wish.papers.len() as f64);
        let bench = Bench { wish, open, progress };
        sections.push(match paper {
            Paper::Song => song::section(&bench)?,
            Paper::Moreland => moreland::section(&bench)?,
            Paper::RoettgerErtl => roettger_ertl::section(&bench)?,
            Paper::Kniss => kniss::section(&bench)?,
        });
    }
    Ok(sections)
}
