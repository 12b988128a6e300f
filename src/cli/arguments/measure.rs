//! Commands that measure, judge and compare: `voltet diff`, `pixel`, `stability`, `study`, `time`, `papers` and `gradient-test`.

use super::shared::{File, Files, Plugins};
use super::values::{color, fraction, one_of, size};
use crate::nodes::drawing::ENGINES;
use crate::optics::engine::Compositor;
use clap::Args;
use clap::builder::TypedValueParser;
use std::path::PathBuf;
use voltet_study::gradient_test::RequirementKind;
#[cfg(feature = "papers")]
use voltet_study::papers::Paper;
use voltet_study::work_precision::{Engines, Measure};

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
    /// The least order of convergence on the boundary: a requirement with --hold-to boundary, a warning without.
    #[arg(long, value_name = "ORDER", default_value_t = 0.5, allow_negative_numbers = true)]
    pub boundary_order: f64,
    /// The largest error on linear fields, by the largest gradient.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-9, allow_negative_numbers = true)]
    pub linear_error: f64,
    /// A data file on whose grid the filters must be finite and exact on linear fields, too.
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
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

/// Requirements on a gradient filter by name; `None`: nothing.
fn requirements() -> impl TypedValueParser<Value = Option<RequirementKind>> {
    use RequirementKind::{Boundary, Finite, Invariance, Linear, Order};
    let invariance = "Invariance of the gradient, but for rounding, under translation, rotation, scaling and numbering of the grid";
    one_of([
        (Some(Finite), "finite", "A finite vector at every point, on every grid"),
        (Some(Linear), "linear", "Exact on linear fields: --linear-error"),
        (Some(Order), "order", "Converges inside on every family of grids: --order"),
        (Some(Boundary), "boundary", "Converges on the boundary of every family of grids: --boundary-order"),
        (Some(Invariance), "invariance", invariance),
        (None, "nothing", "Nothing: the exit code is 0 whatever is found"),
    ])
}

/// The engines by name, or all of them.
fn engines() -> impl TypedValueParser<Value = Engines> {
    let all = (Engines::All, "all", "the CPU, and the graphics device where there is one");
    one_of(ENGINES.iter().map(|engine| (Engines::One(engine), engine.name, engine.summary)).chain([all]))
}
