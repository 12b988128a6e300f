//! Papers, and options of the page.

use crate::work_precision::{Frames, Subject};
use std::path::PathBuf;
use voltet_core::Result;

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

/// Options of the page.
#[derive(Debug, Clone)]
pub struct PapersOptions {
    /// The papers.
    pub papers: Vec<Paper>,
    /// Pixels of the figures.
    pub size: [u32; 2],
    /// Number of times each picture is timed.
    pub frames: Frames,
    /// The largest grid of Song's Table 1 that is generated.
    pub max_cells: u64,
    /// A folder that may hold `bluntfin.vtu`.
    pub data: Option<PathBuf>,
    /// Folder of the reference pictures.
    pub cache: PathBuf,
}

/// Opens one of the pipelines, by the path from the folder of the papers', with options as `--set` takes them.
pub type OpenPipeline<'a> = dyn Fn(&str, &[String]) -> Result<Subject> + 'a;
