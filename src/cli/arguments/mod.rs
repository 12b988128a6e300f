//! The command line: every command with its arguments.
//!
//! | module | what |
//! | --- | --- |
//! | `run` | options of `voltet run` |
//! | `data` | commands about data files |
//! | `measure` | commands that measure, judge and compare |
//! | `shared` | arguments that several commands share |
//! | `values` | values of options |

mod data;
mod measure;
mod run;
mod shared;
mod values;

pub use data::{Convert, DataOptions, Info, Start};
#[cfg(feature = "papers")]
pub use measure::Papers;
pub use measure::{Diff, GradientTest, Pixel, Stability, Study, Time};
pub use run::Run;
pub use shared::{File, Files, Plugins, Set};

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::slice::from_ref;

/// Volume pictures of results on unstructured grids, straight from the cells.
///
/// A picture is stated by a pipeline file (TOML): a reader, a transfer function, a camera, the stages that draw, and
/// a writer, wired to each other. `voltet info DATA` shows what a data file holds and suggests a pipeline to start
/// with; `voltet run FILE` draws it.
#[derive(Debug, Parser)]
#[command(name = "voltet", version, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 done, 1 the run failed, 2 the command or a pipeline file is wrong.")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run pipeline files and write their pictures.
    ///
    /// A picture that voltet wrote serves as a pipeline file here and for every other command: it carries the
    /// pipeline that drew it.
    #[command(after_help = run::EXAMPLES)]
    Run(Run),
    /// Check pipeline files: names, types, ranges and wires. Runs nothing, reads no data.
    Check(Files),
    /// Say what a pipeline file will run, on which engine, and what it leaves out and why.
    Explain(Explain),
    /// List the node types and gradient filters, or show one with its ports and parameters.
    Nodes(Nodes),
    /// Show what a data file holds, what a pipeline finds out about its data without drawing, or what a picture carries.
    ///
    /// For a data file: cells, arrays with ranges, bounds, and a pipeline to start with. For a pipeline file (.toml): findings of its
    /// probes, and for each transfer function with waves the number of bands that the cells cross. For a picture: the
    /// data, the camera and the pipeline that drew it.
    Info(Info),
    /// Write a pipeline file for a data file, with a transfer function found from the data.
    ///
    /// The scalar is the file's own, or the first array that is a quantity. Where it changes, over its values and gradient
    /// magnitudes, are the boundaries that the widgets show; the camera sees them. The file runs as it is.
    Start(Start),
    /// Write the grid of a data file in another format: .vtu (VTK) or .vtkhdf (VTKHDF).
    ///
    /// Reads every format that `voltet info` shows. Points, cells of every type and all arrays are written as they are in the file;
    /// what the new file does not hold is listed. The cells of structured grids become hexahedra, and pieces one grid.
    #[command(after_help = data::CONVERT_EXAMPLES)]
    Convert(Convert),
    /// Open the node editor: the pipeline as a graph, its picture live beside it.
    ///
    /// A pipeline file, a picture that carries one, or a data file, for which a pipeline is made as by `voltet start`. What is
    /// changed is saved into the same file, everything else in it stays as it is. Nothing is written but by saving.
    Edit(Edit),
    /// Say what one pixel is made of: the cells along its ray, and what each of them adds.
    ///
    /// From the eye on, for each cell: where the ray enters and leaves it, s and g there, the widgets met with their shares of
    /// the optical depth, opacity and colour, the share of its light that reaches the eye, and what it adds to the pixel. Then
    /// the pixel by the 64-bit referee, as the pipeline draws it, and by every integrator that can serve the scene. Serves any
    /// pipeline that draws a volume, and any picture that carries one.
    Pixel(Pixel),
    /// Compare two pictures: the largest and mean difference, and the one that a person sees.
    ///
    /// Differences are of premultiplied linear RGBA, from files of sRGB as from EXR, 1 being full scale; a pixel's is the largest of its
    /// channels. Where a picture has no alpha both are compared over the background. FLIP (Andersson et al. 2020) is the mean
    /// over all pixels, 0 to 1, of what is seen over the background where the pictures alternate.
    #[command(
        after_help = "Exit codes: 0 within the limit, 1 beyond it, 2 the command or a picture is wrong."
    )]
    Diff(Diff),
    /// Judge every formula and engine against exact values, and draw cells that are hard to draw.
    ///
    /// For each set of forms (64-bit, 32-bit by lane set, the shaders of a graphics device): the worst error and its inputs in every category (stiff, narrow,
    /// flat, tails, many bands, offset, tiny and huge lengths, region edges, overlaps, long compositing chains), as a share
    /// of the bound stated for it. Then small pictures of degenerate cells and extreme coordinates by each engine against the
    /// 64-bit referee, and the formulas as papers print them, beside what stands in their place.
    Stability(Stability),
    /// Draw a pipeline's scene with every integrator and setting on every engine, and say what each costs and how wrong it is.
    ///
    /// Each picture is compared with a 64-bit reference, which is drawn once and kept. Writes an HTML page that holds
    /// everything, the figures as CSV and JSON, a plot of error against time as SVG, and difference pictures.
    /// Ctrl-C ends the study and keeps what is done; a stopped reference picture goes on where it was.
    Study(Study),
    /// Draw pipelines' scenes again and again with a camera that turns, and print how long a frame takes on each engine.
    ///
    /// The integrator, light and overlaps are those of the file; where the scene needs an order, the exact and the centroid
    /// order are measured. Nothing is written but the table (Markdown) on the standard output.
    Time(Time),
    /// Make the tables and figures of the papers anew that the program follows: what is printed beside what is found here.
    ///
    /// Song et al. 2009, Moreland 2004, Roettger and Ertl 2002, Kniss et al. 2003, with the pipelines in lab/pipelines/papers of the
    /// program's repository. Most of their data cannot be had; the page says what stands in for them. Takes some minutes.
    #[cfg(feature = "papers")]
    Papers(Papers),
    /// Measure a gradient filter: how right it is, how it scales, what it costs and what it does to a picture.
    ///
    /// Truth is formulas alone: manufactured fields on regular, distorted, stretched and anisotropic grids, inside and at
    /// boundaries, points at the same position, and two materials that meet. Orders of convergence, exactness on linear and
    /// quadratic fields, invariance under translation, rotation, scaling, numbering and the scalar's units, amplification of
    /// noise, time, memory, and the error of a picture, beside the other filters.
    GradientTest(GradientTest),
    /// Print a script that lets a shell complete commands, options and paths.
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions(Completions),
    /// Write manual pages: voltet.1, and one of each command.
    Man(Manual),
    /// Child process of --plugin-process: loads the library and answers on the standard output.
    #[command(hide = true)]
    PluginProcess {
        /// The library.
        #[arg(value_name = "PATH")]
        path: PathBuf,
    },
}

/// Plug-ins that a command requests, and the files that it opens.
pub struct Inputs<'a> {
    /// The plug-ins.
    pub plugins: &'a Plugins,
    /// Pipeline files, with options that change them.
    pub pipelines: &'a [PathBuf],
    /// Options `node.param=value`.
    pub options: &'a [String],
    /// Data files and pictures.
    pub data: &'a [PathBuf],
}

impl Command {
    /// Inputs of the command; `None` for one that takes no plug-ins.
    pub fn inputs(&self) -> Option<Inputs<'_>> {
        fn pipelines<'a>(plugins: &'a Plugins, pipelines: &'a [PathBuf], set: &'a Set) -> Inputs<'a> {
            Inputs { plugins, pipelines, options: &set.options, data: &[] }
        }
        let data = |plugins, data| Inputs { plugins, pipelines: &[], options: &[], data };
        fn file(File { file, set, plugins }: &File) -> Inputs<'_> {
            pipelines(plugins, from_ref(file), set)
        }
        fn files(Files { files, set, plugins }: &Files) -> Inputs<'_> {
            pipelines(plugins, files, set)
        }
        Some(match self {
            Command::Run(run) => files(&run.files),
            Command::Check(check) => files(check),
            Command::Time(time) => files(&time.files),
            Command::Explain(explain) => file(&explain.file),
            Command::Pixel(pixel) => file(&pixel.file),
            Command::Study(study) => file(&study.file),
            Command::Info(info) if info.of_pipeline() => {
                pipelines(&info.plugins, from_ref(&info.data), &info.set)
            }
            Command::Info(info) => data(&info.plugins, from_ref(&info.data)),
            Command::Start(start) => data(&start.plugins, from_ref(&start.data)),
            Command::Convert(convert) => data(&convert.plugins, from_ref(&convert.data)),
            Command::Nodes(nodes) => data(&nodes.plugins, &[]),
            Command::Edit(edit) => data(&edit.plugins, &[]),
            Command::GradientTest(test) => data(&test.plugins, &[]),
            Command::Completions(_)
            | Command::Man(_)
            | Command::Diff(_)
            | Command::Stability(_)
            | Command::PluginProcess { .. } => return None,
            #[cfg(feature = "papers")]
            Command::Papers(_) => return None,
        })
    }
}

#[derive(Debug, Args)]
pub struct Explain {
    #[command(flatten)]
    pub file: File,
    /// Explain the run of `voltet run --exhaustive`, which does everything.
    #[arg(long, alias = "no-leave-out")]
    pub exhaustive: bool,
}

#[derive(Debug, Args)]
pub struct Nodes {
    /// The node type or gradient filter to show; all of them where none is named.
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
    /// Write the reference as Markdown.
    #[arg(long)]
    pub markdown: bool,
    #[command(flatten)]
    pub plugins: Plugins,
}

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  voltet completions bash > ~/.local/share/bash-completion/completions/voltet
  voltet completions zsh > ~/.zfunc/_voltet             with ~/.zfunc in fpath
  voltet completions fish > ~/.config/fish/completions/voltet.fish
  voltet completions powershell >> $PROFILE";

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell.
    #[arg(value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct Manual {
    /// The folder, made where it is not there; `man -l FOLDER/voltet.1` shows a page.
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
}

#[derive(Debug, Args)]
pub struct Edit {
    /// A pipeline file, a picture that carries one, or a data file; an empty pipeline without it.
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub plugins: Plugins,
}
