//! Options of `voltet run`.

use super::shared::Files;
use super::values::{bytes, one_of, size};
use crate::io::encode::film::rate;
use crate::series::selection::{Part, Ranges, Sweep};
use crate::series::steps::{StepSelection, TimeSelection};
use clap::Args;
use clap::builder::TypedValueParser;
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  voltet run scene.toml                                  the picture that the file states
  voltet run scene.toml --steps 0:365:5                  every fifth step of the time series that it reads
  voltet run scene.toml --times 0.1:0.5 -o 'a_{time}.png'  the steps within these times, named by them
  voltet run scene.toml --steps all --film run.mp4       all steps, and a film of them
  voltet run scene.toml --memory 4GiB                    a grid larger than memory, part after part
  voltet run scene.toml --for 'run_*.vtu'                a picture of each of these files
  voltet run scene.toml --sweep 'look.widgets.0.extinction=[1, 2, 4]'
                                                         a picture for each value, and a sheet of them
  voltet run *.toml --jobs 4                             the pictures of many files, 4 at a time

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
    /// Let a grid take so much memory, such as 4GiB; one that takes more is read and drawn part after part.
    ///
    /// For files in pieces (.pvtu, VTKHDF partitions, parts of Exodus, processor folders of OpenFOAM, blocks). The picture is the
    /// same but for rounding, some 1e-6. The picture itself and what is kept of the pieces' borders come on top.
    #[arg(long, value_name = "SIZE", value_parser = bytes, conflicts_with = "exhaustive")]
    pub memory: Option<u64>,
    #[command(flatten)]
    pub frames: FrameOptions,
    /// Do everything that could be done, needed or not, and say how much longer that takes.
    ///
    /// Runs each file once to warm up, then in turn twice as usual and twice reading every array, computing the gradient and
    /// its length, culling nothing, keeping widgets that nothing touches, ordering every segment, building a table, using
    /// nothing again. Compares the faster of each: how much longer the whole takes, and by how much the pictures differ.
    #[arg(long, alias = "no-leave-out")]
    pub exhaustive: bool,
    /// Draw so many pictures at a time: of several pipelines, time steps, files or values.
    ///
    /// They share the cores, and the grids that several of them need are read once. Worth it where pictures are small: a large one
    /// keeps all cores busy by itself.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=1024), default_value = "1", conflicts_with = "exhaustive")]
    pub jobs: u16,
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
    /// Draw the time steps at these times: FROM:TO, or a time or FROM:TO:STRIDE, of which the nearest steps; several with commas.
    ///
    /// With between_steps = "linear" of the reader the times themselves, with values between the steps around them.
    #[arg(long, value_name = "TIMES", allow_hyphen_values = true, conflicts_with = "steps")]
    pub times: Option<TimeSelection>,
    /// Data that numbers such as "25 %" and "p90" are relative to, and that views are fitted to; sample where steps are chosen.
    ///
    /// One transfer function then serves the whole series, whichever of its steps are drawn. Sets relative_to of the nodes whose
    /// numbers are relative; without the option only where the file does not say.
    #[arg(long, value_name = "WHICH", value_parser = ranges())]
    pub ranges: Option<Ranges>,
    /// Draw each of these files in place of the one that the reader names; * stands for any letters: 'run_*.vtu'.
    ///
    /// In the order of the numbers in their names. {stem} in the name of a picture is the file's name without ending; without it,
    /// it is added before the ending.
    #[arg(long = "for", value_name = "FILES")]
    pub data_files: Vec<String>,
    /// Draw a picture for each value: node.param=[VALUE, VALUE, …]; with several, for each combination.
    ///
    /// {sweep} in the name of a picture is the number of the combination, from 0; without it, _0000 is added. All pictures stand
    /// with their values on one sheet, the name with _sheet.png.
    #[arg(long, value_name = "node.param=[…]", verbatim_doc_comment)]
    #[allow(rustdoc::broken_intra_doc_links, reason = "help shows the brackets as they are")]
    pub sweep: Vec<Sweep>,
    /// Draw so many pictures along the camera's way (orbit or keys of the camera) of data that stand still.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..), conflicts_with_all = ["steps", "times"])]
    pub frames: Option<u32>,
    /// Draw every COUNT-th picture from the NUMBER-th on, which counts from 1: a share of the work for one of several machines.
    #[arg(long, value_name = "NUMBER/COUNT", conflicts_with = "film")]
    pub part: Option<Part>,
    /// Leave out pictures that are there already, drawn by this program from the same pipeline, step and data.
    #[arg(long)]
    pub resume: bool,
    /// Make a film of the pictures: .gif, .png (animated), or .mp4 or .webm by the program ffmpeg.
    #[arg(long, value_name = "PATH")]
    pub film: Option<PathBuf>,
    /// Frames a second of the film.
    #[arg(long, value_name = "RATE", value_parser = rate, default_value = "25", requires = "film")]
    pub fps: f64,
}

/// Data that relative numbers refer to.
fn ranges() -> impl TypedValueParser<Value = Ranges> {
    one_of([
        (Ranges::Step, "step", "each step by itself"),
        (Ranges::Sample, "sample", "up to 8 steps of the series, evenly from the first to the last"),
        (Ranges::All, "all", "all steps of the series"),
    ])
}
