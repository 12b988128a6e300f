//! Options of `voltet run`.

use super::Files;
use super::values::size;
use crate::series::steps::{StepSelection, TimeSelection};
use clap::Args;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  voltet run scene.toml                                  the picture that the file states
  voltet run scene.toml --steps 0:365:5                  every fifth step of the time series that it reads
  voltet run scene.toml --times 0.1:0.5 -o 'a_{time}.png'  the steps within these times, named by them

Exit codes: 0 done, 1 a picture failed, 2 the command or a pipeline file is wrong.";

#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    pub files: Files,
    /// Size of the picture in pixels: short for --set of the camera's size.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// File of the picture, relative to the working folder: short for --set of the image-writer's path.
    ///
    /// As all paths on the command line but those of --set. Those in a pipeline file, and of --set, are relative to that file.
    /// {step}, {step:04}, {time}, {time:.3} and {stem} stand for the time step, its time and the data file's name without ending.
    #[arg(long, short, value_name = "PATH")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub frames: FrameOptions,
    /// Do everything that could be done, needed or not, and say how much longer that takes.
    ///
    /// Runs each file once to warm up, then in turn twice as usual and twice reading every array, computing the gradient and
    /// its length, culling nothing, keeping widgets that nothing touches, ordering every segment, building a table, using
    /// nothing again. Compares the faster of each: how much longer the whole takes, and by how much the pictures differ.
    #[arg(long, alias = "no-leave-out")]
    pub exhaustive: bool,
    /// Write times, counts and what was left out to this file, as JSON.
    #[arg(long, value_name = "R.json")]
    pub report: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Options that make several pictures of one pipeline.
#[derive(Debug, Args)]
#[command(next_help_heading = "Several pictures")]
pub struct FrameOptions {
    /// Draw these time steps: all, 7, 3,5,9, or FIRST:LAST or FIRST:LAST:STRIDE, both ends included; -1 is the last.
    ///
    /// In place of time_step and time of the readers. Several readers of series step together. Where the name of a picture has
    /// none of {step}, {time} and {frame}, _0007 is added before its ending.
    #[arg(long, value_name = "STEPS", allow_hyphen_values = true)]
    pub steps: Option<StepSelection>,
    /// Draw the time steps at these times: FROM:TO, or a time, of which the nearest step; several with commas.
    #[arg(long, value_name = "TIMES", allow_hyphen_values = true, conflicts_with = "steps")]
    pub times: Option<TimeSelection>,
}
