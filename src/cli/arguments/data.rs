//! Commands about data files: `voltet info`, `start` and `convert`.

use super::shared::{Plugins, Set};
use crate::graph::Registry;
use crate::io::formats::{Request, TimeStep};
use crate::nodes::external_formats;
use crate::series::steps::StepSelection;
use clap::Args;
use std::path::{Path, PathBuf};

impl Info {
    /// True if the data are a pipeline file.
    pub fn of_pipeline(&self) -> bool {
        self.data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
    }
}

#[derive(Debug, Default, Args)]
pub struct DataOptions {
    /// Number of the step of a time series, from 0.
    #[arg(long, value_name = "N")]
    pub time_step: Option<usize>,
    /// PLOT3D, MFEM, SU2: the solution (.q, .gf, .csv, .dat) that belongs to the grid.
    #[arg(long, value_name = "Q")]
    pub solution: Option<PathBuf>,
}

impl DataOptions {
    /// Request to a data file, with the reader of its format where that comes from outside.
    pub fn request(&self, data: &Path, registry: &Registry) -> crate::core::Result<Request> {
        let (time_step, solution) = (self.time_step.map(TimeStep::Index), self.solution.clone());
        external_formats::request(Request { time_step, solution, ..Request::default() }, data, registry)
    }
}

#[derive(Debug, Args)]
pub struct Info {
    /// A data file, a pipeline file (.toml), or a picture.
    #[arg(value_name = "DATA")]
    pub data: PathBuf,
    #[command(flatten)]
    pub set: Set,
    #[command(flatten)]
    pub plugins: Plugins,
    #[command(flatten)]
    pub options: DataOptions,
    /// Write what the data file holds, or the picture carries, as JSON to the standard output.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Default, Args)]
pub struct Start {
    /// A data file.
    #[arg(value_name = "DATA")]
    pub data: PathBuf,
    /// The pipeline file to write, "-" for the standard output; the data file's name with the ending .toml without it.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The array to draw; "NAME:magnitude" or "NAME:0" for vectors.
    #[arg(long, value_name = "NAME")]
    pub scalar: Option<String>,
    #[command(flatten)]
    pub options: DataOptions,
    /// Look at what the boundaries show alone, not at the whole grid.
    #[arg(long)]
    pub fit: bool,
    /// Leave out colours' scale, axes and title: the picture alone.
    #[arg(long)]
    pub plain: bool,
    /// Write over a pipeline file that is there.
    #[arg(long)]
    pub force: bool,
    #[command(flatten)]
    pub plugins: Plugins,
}

pub(super) const CONVERT_EXAMPLES: &str = "\
Examples:
  voltet convert case.foam last.vtkhdf --step 10             one time step of an OpenFOAM case
  voltet convert mesh.e mesh.vtu --arrays p,T                two of the arrays
  voltet convert parts.vtm fluid.vtu --blocks 'fluid/*'      some of the blocks
  voltet convert run.pvd run.vtu --steps all                 run_0000.vtu, run_0001.vtu, ...";

#[derive(Debug, Args)]
pub struct Convert {
    /// The data file to read.
    #[arg(value_name = "IN")]
    pub data: PathBuf,
    /// The file to write, .vtu or .vtkhdf; {step} or {step:04} in it stands for the number of the time step, {time} for its time.
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// Arrays to write, separated by commas; all without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub arrays: Option<Vec<String>>,
    /// Blocks to write, separated by commas, by their names or groups; * stands for any letters. All without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub blocks: Vec<String>,
    /// Number of the time step to write, from 0; the first without it.
    #[arg(long, value_name = "N", alias = "time-step")]
    pub step: Option<usize>,
    /// Time to write: the nearest step.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true, conflicts_with = "step")]
    pub time: Option<f64>,
    /// Time steps to write, each to a file of its own: all, 3,5,9, or FIRST:LAST or FIRST:LAST:STRIDE, both ends included.
    ///
    /// A number below 0 counts from the end: -1 is the last. Where the name has no {step}, _0007 is added before its ending.
    #[arg(long, value_name = "STEPS", allow_hyphen_values = true, conflicts_with_all = ["step", "time"])]
    pub steps: Option<StepSelection>,
    /// PLOT3D, MFEM, SU2: the solution (.q, .gf, .csv, .dat) that belongs to the grid.
    #[arg(long, value_name = "Q")]
    pub solution: Option<PathBuf>,
    /// Write over files that are there.
    #[arg(long)]
    pub force: bool,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
    #[command(flatten)]
    pub plugins: Plugins,
}
