//! The tables and figures of the papers that this program follows, made anew: what is printed beside what is found here.
//!
//! | file | what |
//! | --- | --- |
//! | `options` | papers, and options of the page |
//! | `page` | the page: sections, tables, figures |
//! | `bench` | a scene drawn in one way: time, error, picture; two ways in equal time |
//! | `song`, `moreland`, `roettger_ertl`, `kniss` | a paper each |
//! | `frame_buffer` | pre-integration as graphics hardware of 2002 did it, in few bits |
//! | `cylinder` | Roettger and Ertl's tables as planes |
//! | `plane` | transfer functions drawn over their own plane |
//!
//! Most of the papers' data cannot be had. What stands in for them is said beside each figure; then ratios can be compared, and
//! which of two ways is the better, but no absolute time or picture.

mod bench;
mod cylinder;
mod frame_buffer;
mod kniss;
mod moreland;
mod options;
mod page;
mod plane;
mod roettger_ertl;
mod song;

pub use options::{OpenPipeline, Paper, PapersOptions};
pub use page::{FOLDER, Figure, Section, page};

use bench::Bench;
use voltet_core::Result;
use voltet_core::progress::Progress;

/// Makes the sections, paper by paper. Errors: a pipeline that is not there or cannot be drawn, a stopped run.
pub fn papers(wish: &PapersOptions, open: &OpenPipeline, progress: &dyn Progress) -> Result<Vec<Section>> {
    let mut sections = Vec::new();
    for (k, paper) in wish.papers.iter().enumerate() {
        progress.report(paper.name(), k as f64 / wish.papers.len() as f64);
        let mut bench = Bench::new(wish, open, progress);
        sections.push(match paper {
            Paper::Song => song::section(&mut bench)?,
            Paper::Moreland => moreland::section(&mut bench)?,
            Paper::RoettgerErtl => roettger_ertl::section(&mut bench)?,
            Paper::Kniss => kniss::section(&mut bench)?,
        });
    }
    Ok(sections)
}
