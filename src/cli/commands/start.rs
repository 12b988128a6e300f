//! `voltet start`: a pipeline file for a data file, with a transfer function over (s, g) found from the data.

use super::shared::{ArrayChoice, DONE, Outcome, differs, scalar, with_bar};
use crate::cli::arguments::{DataOptions, Start};
use crate::cli::present::{name, say};
use crate::core::field::{LeastSquares, Method, magnitude};
use crate::core::grid::Grid;
use crate::core::grid::extent::{bounds, range, scene_length};
use crate::core::probing::{Axis, Histogram, ProposedWidget, histogram, proposal, quiet};
use crate::core::progress::Progress;
use crate::core::{Error, Result};
use crate::graph::{ParameterValue, Registry};
use crate::io::formats::{ArraySummary, Association, FileArray, Request, Summary, arrays, inspect, read};
use crate::nodes::files::{
    folder, is_standard_output, refuse_unwritable, relative_to, standard_output, write_whole,
};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bins along s and g: what 64 colours of a curve would tell apart, four times over.
const BINS: usize = 256;

/// Linear RGB of the boundaries, in rising s.
const COLORS: [[f64; 3]; 4] = [[0.08, 0.25, 0.9], [0.05, 0.65, 0.45], [0.95, 0.6, 0.08], [0.9, 0.1, 0.06]];

/// Opacity along the diagonal of a haze over everything, which shows the grid's shape.
const HAZE: f64 = 0.1;

/// Vertical angle of view, degrees.
const FOV_Y: f64 = 30.0;

pub fn start(arguments: &Start, registry: &Registry) -> Outcome {
    let output = arguments.output.clone().unwrap_or_else(|| {
        PathBuf::from(arguments.data.file_stem().unwrap_or_default()).with_extension("toml")
    });
    let to_output = is_standard_output(&output);
    if !to_output {
        refuse_unwritable(&output)?;
        if output.exists() && !arguments.force {
            return Err(Error::usage("the pipeline file is there already")
                .got(name(&output.to_string_lossy()))
                .expected("--force to write over it, or another name after -o")
                .into());
        }
    }
    let (text, said) = with_bar(false, |_, progress| pipeline(arguments, registry, &output, progress))?;
    if to_output {
        standard_output(text.as_bytes())?;
        return Ok(DONE);
    }
    write_whole(&output, text.as_bytes())?;
    let file = name(&output.to_string_lossy());
    say(&format!("{said}\n{file} is written; draw it: voltet run {file}"));
    Ok(DONE)
}

/// The text of the pipeline file, and what was chosen in a sentence.
pub fn pipeline(
    arguments: &Start,
    registry: &Registry,
    output: &Path,
    progress: &dyn Progress,
) -> Result<(String, String)> {
    let asked = arguments.options.request(&arguments.data, registry)?;
    let choice = match &arguments.scalar {
        Some(name) => ArrayChoice::by_name(name, &arrays(&arguments.data, &asked)?),
        None => first_quantity(arguments, &inspect(&arguments.data, &asked, progress)?)?,
    };
    let ArrayChoice { scalar: named, association } = choice.clone();
    let wanted = Request { scalar: Some(named.clone()), association, ..asked.clone() };
    let grid = read(&arguments.data, &wanted, progress)?;
    let scalar = grid.scalar.clone().unwrap_or_default();
    // Gradients of what is the same everywhere are roundings.
    if !range(&scalar).is_some_and(|[low, high]| low < high) {
        return Err(without_boundary(arguments, &asked, &named, progress));
    }
    let gradient = Method::with_defaults(Arc::new(LeastSquares))?.gradient(&grid, &scalar, progress)?;
    let g = magnitude(&gradient.vectors);
    let found = histogram_of(&grid, &scalar, &g, progress)?;
    let look = proposal(&found, COLORS.len());
    let [s_axis, g_axis] = found.axes;
    if look.is_empty() {
        return Err(without_boundary(arguments, &asked, &named, progress));
    }
    let view = view(&grid, &scalar, &g, &look);
    let diagonal = scene_length(bounds(&grid.points))?;
    let unit = rounded(diagonal / 10.0);
    let text = |text: &str| ParameterValue::Text(text.into()).to_string();
    let own = if is_standard_output(output) { Path::new(".") } else { folder(output) };
    let solution = arguments.options.solution.as_ref().map(|solution| relative_to(solution, own));
    let node_type = asked.node_type();
    let options = DataOptions { solution, ..arguments.options };
    let keys = choice.keys(&relative_to(&arguments.data, own), &options);
    let steepest = g.iter().copied().filter(|g| g.is_finite()).fold(g_axis.high, f64::max);
    let region = format!(
        "region = {{ s = [{}, {}], g = [{}, {}] }}\n",
        digits(s_axis.low - (s_axis.high - s_axis.low)),
        digits(s_axis.high + (s_axis.high - s_axis.low)),
        digits(g_axis.low),
        digits(2.0 * steepest)
    );
    let widgets: String =
        look.iter().zip(COLORS).map(|(one, color)| widget(one, color, unit) + &region).collect();
    let haze = ProposedWidget {
        centre: [0.5 * s_axis.low + 0.5 * s_axis.high, 0.0],
        sigma: [s_axis.high - s_axis.low, f64::INFINITY],
        extinction: -(1.0 - HAZE).ln() / diagonal,
    };
    let stem = if is_standard_output(output) { arguments.data.file_stem() } else { output.file_stem() };
    let picture = PathBuf::from(stem.unwrap_or_default()).with_extension("png");
    let text = format!(
        "# Boundaries of {named}, told apart by its value s and its gradient magnitude g: the widgets are Gaussians at equal
# shares of the level surfaces' area, found from the data. What is
# quieter than g = {} is left out. Ranges: s {} to {}, g to {} in 99.9 % of the volume.

[pipeline]
format = 1

[nodes.grid]
type = \"{node_type}\"
{keys}
[nodes.gradient]
type = \"gradient-magnitude\"
method = \"least-squares\"
inputs = {{ grid = \"grid\" }}

[nodes.look]
type = \"transfer-function\"
unit_distance = {}
{widgets}
# A haze over everything, so that the grid's shape is seen.
{}
[nodes.view]
type = \"camera\"
{view}size = [1024, 768]

[nodes.picture]
type = \"renderer\"
inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}

[nodes.file]
type = \"image-writer\"
path = {}
background = [0.0, 0.0, 0.0]
inputs = {{ image = \"picture\" }}
",
        digits(g_axis.low),
        digits(s_axis.low),
        digits(s_axis.high),
        digits(g_axis.high),
        digits(unit),
        widget(&haze, [0.5, 0.55, 0.6], unit).trim_start(),
        text(&picture.to_string_lossy()),
    );
    let said = format!("{} boundaries of '{}' found", look.len(), name(&named));
    Ok((text, said))
}

/// The error for an array that is the same everywhere; names those that are not.
fn without_boundary(arguments: &Start, asked: &Request, named: &str, progress: &dyn Progress) -> Error {
    let error = Error::run(format!("'{named}' has no boundary: it is the same everywhere"));
    let found = inspect(&arguments.data, asked, progress).map(|summary| summary.arrays).unwrap_or_default();
    let others: Vec<String> = found.iter().filter(|a| differs(a)).map(|a| scalar(&a.head)).collect();
    error.expected(format!("another array after --scalar: {}", others.join(", "))).in_file(&arguments.data)
}

/// The file's own scalar, or the first that is a quantity (not a flag, a number of something, or the same everywhere).
fn first_quantity(arguments: &Start, summary: &Summary) -> Result<ArrayChoice> {
    if !summary.has_volume() {
        return Err(Error::run("no cell has a volume, so there is nothing to draw").in_file(&arguments.data));
    }
    let heads: Vec<FileArray> = summary.arrays.iter().map(|array| array.head.clone()).collect();
    let quantity = |array: &&ArraySummary| differs(array) && !is_label(array);
    let mut arrays: Vec<&ArraySummary> = summary.arrays.iter().filter(quantity).collect();
    // The file's own first, then scalars of the points, scalars of the cells, vectors.
    arrays.sort_by_key(|array| {
        let own = summary.active_scalars.as_deref() == Some(array.head.name.as_str());
        (!own, array.head.component_count > 1, array.head.association == Association::Cell)
    });
    arrays.first().map(|array| ArrayChoice::from_head(&array.head, &heads)).ok_or_else(|| {
        let names: Vec<&str> = heads.iter().map(|array| array.name.as_str()).collect();
        let found = if names.is_empty() { "no arrays".into() } else { name(&names.join(", ")) };
        Error::run("no array is a quantity that varies")
            .got(found)
            .expected("--scalar NAME")
            .in_file(&arguments.data)
    })
}

/// True if it holds numbers or marks of things, and no quantity.
fn is_label(array: &ArraySummary) -> bool {
    const LABELS: &str =
        "id ids flag flags mask ghost ghosttype rank part partition material index block region";
    let lower = array.head.name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let mut words = words.map(|word| word.trim_start_matches("vtk"));
    !array.number_type.starts_with("Float")
        || words.any(|word| LABELS.split(' ').any(|label| label == word) || word.ends_with("ids"))
}

/// Over all of s, and g from where the data are not quiet to where nearly all of the volume is.
fn histogram_of(grid: &Grid, s: &[f64], g: &[f64], progress: &dyn Progress) -> Result<Histogram> {
    let s_axis = Axis::over(s, BINS);
    let whole = Axis::over(g, 16 * BINS);
    let coarse = histogram(
        grid,
        [s, g],
        [Axis { bins: 1, ..s_axis }, Axis { low: whole.low.min(0.0), ..whole }],
        progress,
    )?;
    let high = coarse.nearly_all();
    let low = quiet(&coarse).min(0.5 * high);
    histogram(grid, [s, g], [s_axis, Axis { low, high, bins: BINS }], progress)
}

fn widget(one: &ProposedWidget, [red, green, blue]: [f64; 3], unit: f64) -> String {
    let ProposedWidget { centre: [s, g], sigma: [along_s, along_g], extinction } = one;
    format!(
        "
[[nodes.look.widgets]]
kind = \"gaussian\"
color = [{red}, {green}, {blue}]
extinction = {}
centre = [{}, {}]
sigma = [{}, {}]
",
        digits(extinction * unit),
        digits(*s),
        digits(*g),
        digits(*along_s),
        digits(*along_g)
    )
}

/// Keys of a camera that looks at the middle of what the widgets show, mostly along its shortest side, from where 1024 × 768 pixels
/// hold it.
fn view(grid: &Grid, s: &[f64], g: &[f64], look: &[ProposedWidget]) -> String {
    let drawn = |i: usize| {
        let profile = |one: &ProposedWidget| {
            let q = [(s[i] - one.centre[0]) / one.sigma[0], (g[i] - one.centre[1]) / one.sigma[1]];
            (-0.5 * (q[0] * q[0] + q[1] * q[1])).exp()
        };
        look.iter().map(profile).fold(0.0, f64::max) > 0.1
    };
    let used = |i: &usize| grid.points[*i].is_finite();
    let mut shown: Vec<usize> = (0..s.len()).filter(used).filter(|i| drawn(*i)).collect();
    if shown.len() < 8 {
        shown = (0..s.len()).filter(used).collect();
    }
    // A few points far off must not make the rest small.
    let extent = |axis: usize| -> [f64; 2] {
        let mut places: Vec<f64> = shown.iter().map(|i| grid.points[*i][axis]).collect();
        places.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| places[(share * (places.len() - 1) as f64) as usize];
        [at(0.01), at(0.99)]
    };
    let [x, y, z] = [extent(0), extent(1), extent(2)];
    let (low, high) = (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]));
    let size = (high - low).max(DVec3::splat(1e-6 * (high - low).max_element().max(f64::MIN_POSITIVE)));
    let shortest = size.min_element();
    let towards = DVec3::new(-0.8, -1.4, 0.9) * (0.3 + 0.7 * shortest / size);
    let towards = towards.normalize();
    let up = if towards.z.abs() > 0.8 { DVec3::Y } else { DVec3::Z };
    // The ball about it fits into the height of the picture.
    let distance = 0.5 * size.length() / (0.5 * FOV_Y).to_radians().sin();
    let target = 0.5 * low + 0.5 * high;
    let vector = |v: DVec3| format!("[{}, {}, {}]", digits(v.x), digits(v.y), digits(v.z));
    let (eye, target, up) = (vector(target + 0.85 * distance * towards), vector(target), vector(up));
    format!("eye = {eye}\ntarget = {target}\nup = {up}\nfov_y = {FOV_Y:?}\n")
}

/// One digit.
fn rounded(x: f64) -> f64 {
    format!("{x:.0e}").parse().unwrap_or(x)
}

/// Six digits, as TOML writes a number.
fn digits(x: f64) -> String {
    if x.is_infinite() {
        return if x > 0.0 { "inf".into() } else { "-inf".into() };
    }
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    format!("{rounded:?}")
}
