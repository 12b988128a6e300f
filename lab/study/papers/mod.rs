//! The tables and figures of the papers that this program follows, made anew: what is printed beside what is found here.
//!
//! | file | what |
//! | --- | --- |
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
mod page;
mod plane;
mod roettger_ertl;
mod song;

pub use page::{FOLDER, Figure, Section, page};

use crate::work_precision::{Frames, Subject};
use bench::Bench;
use std::path::PathBuf;
use voltet_core::Result;
use voltet_core::progress::Progress;

/// A paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Song et al. 2009.
    Song,
    /// Moreland 2004.
    Moreland,
    /// Roettger and Ertl 2002.
    RoettgerErtl,
    /// Kniss et al. 2003.
    Kniss,
}

impl Paper {
    /// All of them.
    pub const ALL: [Paper; 4] = [Paper::Song, Paper::Moreland, Paper::RoettgerErtl, Paper::Kniss];

    /// Its name on the command line, and of its files.
    pub fn name(self) -> &'static str {
        match self {
            Paper::Song => "song",
            Paper::Moreland => "moreland",
            Paper::RoettgerErtl => "roettger-ertl",
            Paper::Kniss => "kniss",
        }
    }
}

/// What is asked for.
#[derive(Debug, Clone)]
pub struct PapersOptions {
    /// The papers.
    pub papers: Vec<Paper>,
    /// Pixels of the figures.
    pub size: [u32; 2],
    /// How often each picture is timed.
    pub frames: Frames,
    /// The largest grid of Song's Table 1 that is generated.
    pub most_cells: u64,
    /// A folder that may hold `bluntfin.vtu`.
    pub data: Option<PathBuf>,
    /// Where reference pictures are kept.
    pub cache: PathBuf,
}

/// Opens one of the pipelines, by the path from the folder of the papers', with options as `--set` takes them.
pub type OpenPipeline<'a> = dyn Fn(&str, &[String]) -> Result<Subject> + 'a;

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
