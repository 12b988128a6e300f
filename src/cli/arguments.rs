//! The command line: every command with its arguments.

use crate::graph::Registry;
use crate::io::formats::{Request, TimeStep};
use crate::nodes::drawing::ENGINES;
use crate::nodes::external_formats;
use crate::optics::engine::Compositor;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::slice::from_ref;
use voltet_study::gradient_test::RequirementKind;
#[cfg(feature = "papers")]
use voltet_study::papers::Paper;
use voltet_study::work_precision::{Engines, Measure};

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
    #[command(after_help = CONVERT_EXAMPLES)]
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
    /// boundaries, and two materials that meet. Orders of convergence, exactness on linear and quadratic fields, invariance
    /// under translation, rotation, scaling, numbering and the scalar's units, amplification of noise, time, memory, and the
    /// error of a picture, beside the other filters.
    GradientTest(GradientTest),
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
            Command::Diff(_) | Command::Stability(_) | Command::PluginProcess { .. } => return None,
            #[cfg(feature = "papers")]
            Command::Papers(_) => return None,
        })
    }
}

impl Info {
    /// True if the data are a pipeline file.
    pub fn of_pipeline(&self) -> bool {
        self.data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
    }
}

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
    #[arg(long, short, value_name = "PATH")]
    pub output: Option<PathBuf>,
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

#[derive(Debug, Args)]
pub struct Diff {
    /// A picture.
    pub a: PathBuf,
    /// The picture that it is compared with, of the same size.
    pub b: PathBuf,
    /// Write the difference of each pixel as a picture, on a logarithmic scale from 1e-6 (dark violet) to 1 (yellow).
    #[arg(long, short, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// Largest difference for which the exit code is 0: a number, or a fraction such as 1/255.
    #[arg(long, value_name = "LIMIT", value_parser = fraction)]
    pub limit: Option<f64>,
    /// Background of pictures with opacity, where it is seen: linear red, green and blue, 0 to 1.
    #[arg(long, value_name = "R,G,B", value_parser = color, default_value = "0,0,0")]
    pub background: [f64; 3],
}

#[derive(Debug, Default, Args)]
pub struct Plugins {
    /// Load gradient filters, readers and filters of grids and images from this shared library; may be given several times.
    ///
    /// Pipelines name them as what ships: gradient filters by `method`, the others by `type`; `voltet nodes --plugin PATH` lists
    /// them. The libraries that
    /// the user's own file plugins.toml names are loaded as well. No pipeline file can load any. See docs/src/how-to/plugins.md.
    #[arg(long = "plugin", value_name = "PATH")]
    pub plugin_files: Vec<PathBuf>,
    /// Load and run plug-ins in a process of their own, so that one that crashes does not end this program.
    ///
    /// Costs some hundredths of a second a gradient, and stops at once where a filter does not stop by itself.
    #[arg(long)]
    pub plugin_process: bool,
}

#[derive(Debug, Args)]
pub struct Set {
    /// Set a parameter in place of the file's value; may be given several times.
    ///
    /// The value is read as TOML, or taken as text where it is none; parts of lists and tables are reached by
    /// further points. Paths are relative to the pipeline file, as those within it.
    /// Examples: view.size=[512,512]  file.path=small.png  look.widgets.0.extinction=2
    #[allow(rustdoc::broken_intra_doc_links, reason = "help shows the brackets as they are")]
    #[arg(long = "set", value_name = "node.param=value", verbatim_doc_comment)]
    pub options: Vec<String>,
}

#[derive(Debug, Args)]
pub struct Files {
    /// Pipeline files.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub set: Set,
    #[command(flatten)]
    pub plugins: Plugins,
}

#[derive(Debug, Args)]
pub struct File {
    /// A pipeline file, or a picture that carries one.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    #[command(flatten)]
    pub set: Set,
    #[command(flatten)]
    pub plugins: Plugins,
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

#[derive(Debug, Default, Args)]
pub struct DataOptions {
    /// Number of the step of a time series, from 0.
    #[arg(long, value_name = "N")]
    pub time_step: Option<usize>,
    /// PLOT3D: the solution (q) file that belongs to the grid.
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

const CONVERT_EXAMPLES: &str = "\
Examples:
  voltet convert case.foam last.vtkhdf --step 10             one time step of an OpenFOAM case
  voltet convert mesh.e mesh.vtu --arrays p,T                two of the arrays
  voltet convert parts.vtm fluid.vtu --blocks 'fluid/*'      some of the blocks
  voltet convert run.pvd 'run_{step:04}.vtu' --steps all     run_0000.vtu, run_0001.vtu, ...";

#[derive(Debug, Args)]
pub struct Convert {
    /// The data file to read.
    #[arg(value_name = "IN")]
    pub data: PathBuf,
    /// The file to write, .vtu or .vtkhdf; {step} or {step:04} in it stands for the number of the time step.
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
    /// Time steps to write, each to a file of its own: all, or FIRST:LAST or FIRST:LAST:STRIDE, both ends included.
    #[arg(long, value_name = "STEPS", value_parser = step_range, conflicts_with_all = ["step", "time"])]
    pub steps: Option<StepRange>,
    /// PLOT3D: the solution (q) file that belongs to the grid.
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

/// Steps of a time series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StepRange {
    /// Number of the first.
    pub first: usize,
    /// Number of the last; `None`: the last of the series.
    pub last: Option<usize>,
    /// From one to the next, at least 1.
    pub stride: usize,
}

#[derive(Debug, Args)]
pub struct Edit {
    /// A pipeline file, a picture that carries one, or a data file; an empty pipeline without it.
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub plugins: Plugins,
}

#[derive(Debug, Args)]
pub struct Pixel {
    #[command(flatten)]
    pub file: File,
    /// Column of the pixel, from the left, from 0.
    #[arg(value_name = "X", allow_negative_numbers = true)]
    pub x: i64,
    /// Row of the pixel, from the top, from 0.
    #[arg(value_name = "Y", allow_negative_numbers = true)]
    pub y: i64,
    /// The node that draws, of type renderer, gpu-renderer or composite, where the pipeline has several.
    #[arg(long, value_name = "NODE")]
    pub node: Option<String>,
    /// Number of the pixel's ray, from 0, where the camera has several samples.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub sample: u32,
    /// Show every cell of the ray; without it the 24 that add most where there are more.
    #[arg(long)]
    pub all: bool,
    /// Write all cells to this file, as CSV.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write everything to this file, as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Plot s and g along the ray, and what each cell adds, as SVG.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit codes: 0 every bound is kept, 1 one is broken, 2 the file is wrong.")]
pub struct Stability {
    /// Judge these cases instead of those that the program carries: one JSON object a line.
    ///
    /// Each value passes when its error is at most bound × exact value + floor; the bound follows from the working
    /// precision and the condition number that the case states. Counted are the values of the forms themselves
    /// (judged), those only asked to be finite and physical (finite), those that the 32-bit engine leaves to the
    /// 64-bit forms, and those of cases that are not served (skipped).
    #[arg(long, value_name = "FILE.jsonl")]
    pub cases: Option<PathBuf>,
    /// The graphics device whose shaders are judged: a part of its name, or discrete, integrated, virtual, software.
    ///
    /// Without it the fastest that is hardware; where there is none, the output says so. A driver that is a program on the
    /// CPU (software) is judged only when it is named. Cases that a device refuses beforehand are counted as skipped.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Draw this many scenes by lot instead (grids, fields, transfer functions, cameras), each in general and once in special
    /// position, and name those on which an engine is beyond its bound.
    ///
    /// In special position rays lie in faces and along edges, the eye is a vertex, layers are thin, near planes far away, values near
    /// 1e8. Each is a picture of up to 32 × 32 pixels, held against the 64-bit referee. A pixel beyond the bound is explained where
    /// the referee changes by as much when rays move by a thousandth of a pixel, the data are rounded to 32 bits, or cells of the
    /// outer surface move, each for itself, by 1/32768 of a pixel. Some 40 scenes a second on two cores. A device draws each by
    /// tiles, and those of one colour in every way of compositing, a software driver in seconds; its triangles may be off by what
    /// their cells, one by one, change when corners move by 1/256 of a pixel.
    #[arg(long, value_name = "COUNT", conflicts_with = "cases")]
    pub scenes: Option<u64>,
    /// The number of the first of them.
    #[arg(long, value_name = "NUMBER", default_value_t = 0, requires = "scenes")]
    pub first: u64,
    /// Seed that all of them follow from.
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "scenes")]
    pub seed: u64,
    /// Write everything that was found as JSON to the standard output.
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 done, 1 the study failed, was stopped, or nothing keeps --max-error; 2 the command or \
the pipeline file is wrong."
)]
pub struct Study {
    #[command(flatten)]
    pub file: File,
    /// The node to study, of type renderer, gpu-renderer or composite, where the pipeline has several.
    #[arg(long, value_name = "NODE")]
    pub node: Option<String>,
    /// Integrators to look at, separated by commas; all that can serve the scene without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Engine: the CPU, a graphics device, or all.
    ///
    /// A device is measured where this machine has a graphics device, or the one that --adapter names; else the output says
    /// what is missing.
    #[arg(long, value_name = "WHICH", value_parser = engines(), default_value = "all")]
    pub engine: Engines,
    /// The graphics device to measure: a part of its name, or discrete, integrated, virtual, software.
    ///
    /// Without it the one that the file names, or else the fastest that is hardware. A driver that is a program on the CPU
    /// (software) is measured only when it is named; its times say nothing of graphics hardware.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Recommend the cheapest setting with an error of at most this, 1 being full scale.
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// The error that decides about the recommendation and the Pareto front.
    #[arg(long, value_name = "WHICH", value_parser = one_of(Measure::NAMES), default_value = "max")]
    pub measure: Measure,
    /// Refine the grid this often (2 without a number), to tell the error of integration from that of taking the data as
    /// linear in each cell.
    ///
    /// Each time every tetrahedron is cut in eight. With values linear between the points the field is the same and
    /// integrators converge to it, at a rate that is printed; with values as the gradients at the points suggest them the
    /// picture changes by what the linear model leaves out.
    #[arg(long, value_name = "LEVELS", num_args = 0..=1, default_missing_value = "2", default_value_t = 0,
          hide_default_value = true)]
    pub refine: u32,
    /// Write the recommended setting into the pipeline file; everything else in it stays as it is.
    #[arg(long, requires = "max_error")]
    pub apply: bool,
    /// Frames that are timed for each setting, after one that warms up.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub frames: usize,
    /// Seconds after which no further frame of a setting begins.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, allow_negative_numbers = true)]
    pub patience: f64,
    /// The folder to write into; FILE with the ending .study without it.
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// The folder that keeps reference pictures; in the user's cache folder without it.
    #[arg(long, value_name = "FOLDER")]
    pub cache: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
pub struct Time {
    #[command(flatten)]
    pub files: Files,
    /// Sizes of the picture in pixels, separated by commas; those of the files without it.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_delimiter = ',', value_parser = size)]
    pub size: Vec<[u32; 2]>,
    /// Engine: the CPU, a graphics device, or all.
    #[arg(long, value_name = "WHICH", value_parser = engines(), default_value = "all")]
    pub engine: Engines,
    /// Compositors of a graphics device, separated by commas: tiles, raster; all without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',',
          value_parser = one_of(Compositor::NAMES.iter().filter_map(|(name, help)| Some((Compositor::named(name)?, *name, *help)))))]
    pub compositor: Vec<Compositor>,
    /// The graphics device to measure: a part of its name, or discrete, integrated, virtual, software.
    ///
    /// Without it the one that the file names, or else the fastest that is hardware.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Frames that are timed, after one that sets up; the median counts.
    #[arg(long, value_name = "N", default_value_t = 31)]
    pub frames: usize,
    /// Seconds after which no further frame of a row begins.
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, allow_negative_numbers = true)]
    pub patience: f64,
    /// Degrees that the camera turns about its target before each frame.
    #[arg(long, value_name = "DEGREES", default_value_t = 1.0, allow_negative_numbers = true)]
    pub turn: f64,
    /// Frames of a device that are in flight at a time, in the column that says how fast they follow each other; 1 leaves it out.
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub in_flight: usize,
}

#[cfg(feature = "papers")]
#[derive(Debug, Args)]
pub struct Papers {
    /// Papers, separated by commas; all without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = one_of(Paper::ALL.map(|paper| (paper, paper.name(), ""))))]
    pub only: Vec<Paper>,
    /// The folder of the papers' pipelines.
    #[arg(long, value_name = "FOLDER", default_value = "lab/pipelines/papers")]
    pub pipelines: PathBuf,
    /// The folder to write into, which is made: papers.md, and the figures in papers/.
    #[arg(long, value_name = "FOLDER")]
    pub output: PathBuf,
    /// Size of the figures.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, default_value = "400x300")]
    pub size: [u32; 2],
    /// Frames that are timed of each picture, after one that warms up; the median counts.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub frames: usize,
    /// Tetrahedra of the largest grid that is generated for Song's Table 1; 1,000,000 leaves out its two largest.
    #[arg(long, value_name = "N", default_value_t = 4_000_000)]
    pub max_cells: u64,
    /// A folder with data that do not ship: bluntfin.vtu.
    #[arg(long, value_name = "FOLDER")]
    pub data: Option<PathBuf>,
    /// The folder that keeps reference pictures; in the user's cache folder without it.
    #[arg(long, value_name = "FOLDER")]
    pub cache: Option<PathBuf>,
    /// Show nothing while it runs.
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 the filter keeps what it is held to, 1 it does not, or the test was stopped; 2 the command \
is wrong."
)]
pub struct GradientTest {
    /// A gradient filter; `voltet nodes` lists them.
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Set a parameter of the filter; may be given several times.
    ///
    /// The value is read as TOML, or taken as text where it is none.
    #[arg(long = "set", value_name = "name=value")]
    pub options: Vec<String>,
    /// Filters to measure beside it, separated by commas, with their standard values; all others without it.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub beside: Option<Vec<String>>,
    /// Requirements on the filter, separated by commas.
    #[arg(
        long,
        value_name = "WHAT",
        value_delimiter = ',',
        value_parser = requirements(),
        default_value = "finite,linear,order,invariance"
    )]
    pub hold_to: Vec<Option<RequirementKind>>,
    /// The least order of convergence inside, on every family of grids.
    #[arg(long, value_name = "ORDER", default_value_t = 0.8, allow_negative_numbers = true)]
    pub order: f64,
    /// The largest error on linear fields, by the largest gradient.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-9, allow_negative_numbers = true)]
    pub linear_error: f64,
    /// Boxes along a side of each grid, coarse to fine; orders are those between the two finest.
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', default_value = "4,8,16,24")]
    pub levels: Vec<usize>,
    /// Boxes along a side of the grid that is timed: 40 are 68,921 points.
    #[arg(long, value_name = "COUNT", default_value_t = 40)]
    pub timed: usize,
    /// Timed runs of each filter, after one that warms up; filters take turns.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub rounds: usize,
    /// Write everything to this file, as a page that needs no other file.
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
    /// Write everything to this file, as JSON.
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Plot the error against fineness, as SVG.
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
    #[command(flatten)]
    pub plugins: Plugins,
}

/// One of several values, each with its name and help.
fn one_of<T: Clone + Send + Sync + 'static>(
    words: impl IntoIterator<Item = (T, &'static str, &'static str)>,
) -> impl TypedValueParser<Value = T> {
    let words: Vec<(T, &str, &str)> = words.into_iter().collect();
    let possible = |(_, name, help): &(T, &'static str, &'static str)| {
        let value = PossibleValue::new(*name);
        if help.is_empty() { value } else { value.help(*help) }
    };
    PossibleValuesParser::new(words.iter().map(possible).collect::<Vec<_>>()).map(move |name: String| {
        let found = words.iter().find(|word| word.1 == name);
        found.expect("the parser accepts no other name").0.clone()
    })
}

/// Requirements on a gradient filter by name; `None`: nothing.
fn requirements() -> impl TypedValueParser<Value = Option<RequirementKind>> {
    use RequirementKind::{Finite, Invariance, Linear, Order};
    let invariance = "Invariance of the gradient, but for rounding, under translation, rotation, scaling and numbering of the grid";
    one_of([
        (Some(Finite), "finite", "A finite vector at every point, on every grid"),
        (Some(Linear), "linear", "Exact on linear fields: --linear-error"),
        (Some(Order), "order", "Converges inside on every family of grids: --order"),
        (Some(Invariance), "invariance", invariance),
        (None, "nothing", "Nothing: the exit code is 0 whatever is found"),
    ])
}

/// A number from 0 on, as one or as a fraction of two.
fn fraction(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match text.split_once('/') {
        Some((over, under)) => number(over).zip(number(under)).map(|(over, under)| over / under),
        None => number(text),
    };
    let value = value.filter(|value| *value >= 0.0 && value.is_finite());
    value.ok_or_else(|| "a number of 0 or more, or a fraction such as 1/255".into())
}

/// Steps of a series, "all", "3", "0:10" or "0:10:2"; an end that is left out is that of the series.
fn step_range(text: &str) -> Result<StepRange, String> {
    let parts: Vec<&str> =
        if text == "all" { vec!["", ""] } else { text.split(':').map(str::trim).collect() };
    let number = |at: usize| match parts.get(at).filter(|part| !part.is_empty()) {
        None => Some(None),
        Some(part) => part.parse::<usize>().ok().map(Some),
    };
    let range = || {
        let (first, last, stride) = (number(0)?.unwrap_or(0), number(1)?, number(2)?.unwrap_or(1));
        let last = if parts.len() == 1 { Some(first) } else { last };
        let is_range =
            !text.is_empty() && parts.len() <= 3 && stride > 0 && last.is_none_or(|last| first <= last);
        is_range.then_some(StepRange { first, last, stride })
    };
    range().ok_or_else(|| "steps are all, or FIRST:LAST or FIRST:LAST:STRIDE such as 0:10:2".into())
}

/// A linear colour, "0.1,0.2,0.3".
fn color(text: &str) -> Result<[f64; 3], String> {
    let channels: Vec<f64> = text.split(',').map(fraction).collect::<Result<_, _>>()?;
    channels.try_into().map_err(|_| "a colour is three numbers with commas, such as 1,1,1".into())
}

/// A picture's size, "1024x768".
fn size(text: &str) -> Result<[u32; 2], String> {
    let number = |part: &str| part.trim().parse::<u32>().ok().filter(|n| *n > 0);
    let parts = text.split_once(['x', '×']);
    let both = parts.and_then(|(width, height)| Some([number(width)?, number(height)?]));
    both.ok_or_else(|| "a size is WIDTHxHEIGHT in pixels, such as 1024x768".into())
}

/// The engines by name, or all of them.
fn engines() -> impl TypedValueParser<Value = Engines> {
    let all = (Engines::All, "all", "the CPU, and the graphics device where there is one");
    one_of(ENGINES.iter().map(|engine| (Engines::One(engine), engine.name, engine.summary)).chain([all]))
}
