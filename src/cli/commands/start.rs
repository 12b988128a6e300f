//! `voltet start`: a pipeline file for a data file, with a transfer function over (s, g) found from the data.

use super::first_view::view;
use super::shared::{DONE, Outcome, reader_keys, with_bar};
use crate::cli::arguments::{DataOptions, Start};
use crate::cli::present::{name, say};
use crate::core::arithmetic::decimal;
use crate::core::error::ErrorKind;
use crate::core::field::{LeastSquares, Method, magnitude};
use crate::core::grid::Grid;
use crate::core::grid::extent::{range, scene_length};
use crate::core::parameters::nearest_first;
use crate::core::probing::{Axis, Histogram, ProposedWidget, Volumes, histogram, proposal, quiet};
use crate::core::progress::{PartProgress, Progress};
use crate::core::transfer::AxisScale;
use crate::core::{Error, Result, agreeing};
use crate::graph::{ParameterValue, Registry};
use crate::io::encode::format_by_ending;
use crate::io::formats::{
    ArrayChoice, FileArray, Request, Summary, arrays, differ, files_beside, inspect, read,
};
use crate::nodes::files::{
    Use, argument, collision, folder, is_standard_output, refuse_unwritable, relative_to, standard_output,
    write_whole,
};
use glam::DVec3;
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bins along s and g: what 64 colours of a curve would tell apart, four times over.
const BINS: usize = 256;

/// Linear RGB of the boundaries, in rising s.
const COLORS: [[f64; 3]; 4] = [[0.08, 0.25, 0.9], [0.05, 0.65, 0.45], [0.95, 0.6, 0.08], [0.9, 0.1, 0.06]];

/// Opacity of a haze over everything, along a ray of mean length: it shows the grid's shape.
const HAZE: f64 = 0.1;

/// Smallest range of values: a thousandth of it has an inverse in 64 bits.
const MIN_RANGE: f64 = 1e-300;

/// Zoom that leaves labels room beside the box of the data.
const ZOOM: f64 = 0.8;

pub fn start(arguments: &Start, registry: &Registry) -> Outcome {
    let output = arguments.output.clone().unwrap_or_else(|| {
        PathBuf::from(arguments.data.file_stem().unwrap_or_default()).with_extension("toml")
    });
    let to_output = is_standard_output(&output);
    if !to_output {
        refuse_losses(arguments, &output)?;
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
    say(&format!("{said}\n{file} is written; draw it: voltet run {}", name(&argument(&output))));
    Ok(DONE)
}

/// Refuses a pipeline file in the place of its data or of its picture.
fn refuse_losses(arguments: &Start, output: &Path) -> Result<()> {
    let (data, solution) = (&arguments.data, arguments.options.solution.clone());
    let is_written = Use { path: output.to_path_buf(), written: true };
    let read = std::iter::once(data.clone()).chain(solution).chain(files_beside(data));
    let uses: Vec<Use> =
        std::iter::once(is_written).chain(read.map(|path| Use { path, written: false })).collect();
    let what = match collision(&uses) {
        Some(_) => "the pipeline file would overwrite data that it draws",
        None if format_by_ending(output).is_ok() => "a pipeline file is written, not its picture",
        None => return Ok(()),
    };
    let other = name(&output.with_extension("toml").to_string_lossy());
    Err(Error::usage(what)
        .got(name(&output.to_string_lossy()))
        .expected(format!("another path after -o, such as {other}")))
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
        Some(name) => named_array(arguments, name, &arrays(&arguments.data, &asked)?)?,
        None => first_quantity(arguments, &inspect(&arguments.data, &asked, progress)?)?,
    };
    let ArrayChoice { scalar: named, association } = choice.clone();
    let wanted = Request { scalar: Some(named.clone()), association, ..asked.clone() };
    let grid = read(&arguments.data, &wanted, progress)?;
    let scalar = grid.scalar.clone().unwrap_or_default();
    // Gradients of what is the same everywhere are roundings.
    let Some([low, high]) = range(&scalar).filter(|&[low, high]| differ(low, high, f64::EPSILON)) else {
        return Err(without_boundary(arguments, &asked, &named, progress));
    };
    if high - low < MIN_RANGE {
        return Err(Error::run(format!(
            "the values of '{named}' differ by less than widgets can tell apart"
        ))
        .got(format_args!("{low:?} to {high:?}"))
        .expected(format_args!("a range of at least {MIN_RANGE:?}"))
        .in_file(&arguments.data));
    }
    if !has_volume(&grid) {
        return Err(without_volume(arguments));
    }
    let length = scene_length(grid.bounds()).map_err(|error| error.in_file(&arguments.data))?;
    // On a logarithmic scale the look is found as that of the logarithm, of which g is the gradient magnitude.
    let is_log = spans_decades(&grid, &scalar, progress)?;
    let scale = if is_log { AxisScale::Log } else { AxisScale::Linear };
    let field = match is_log {
        true => Cow::Owned(scalar.iter().map(|value| scale.position(*value)).collect()),
        false => Cow::Borrowed(&scalar[..]),
    };
    let [low, high] = [low, high].map(|value| scale.position(value));
    let gradient = Method::with_defaults(Arc::new(LeastSquares))?.gradient(&grid, &field, progress)?;
    let g = magnitude(&gradient.vectors);
    let found = histogram_of(&grid, &field, &g, progress)?;
    progress.report("widgets", 0.0);
    let mut look = proposal(&found, COLORS.len());
    if is_log {
        // The gradient magnitude of the logarithm is no array that a widget reads.
        look.iter_mut().for_each(|one| (one.centre[1], one.sigma[1]) = (0.0, f64::INFINITY));
    }
    progress.check_cancelled()?;
    let [s_axis, g_axis] = found.axes;
    let points = match arguments.fit {
        true => shown_points(&grid, &field, &g, &look),
        false => grid.points[..grid.drawn_points()].to_vec(),
    };
    let none =
        || Error::run("no cell has an extent, so there is nothing to look at").in_file(&arguments.data);
    let boxed = !(arguments.plain || arguments.fit);
    let view = view(&points, boxed).ok_or_else(none)?;
    let chord = if view.chord > 0.0 { view.chord } else { length };
    let unit = one_digit(chord / 5.0);
    let text = |text: &str| ParameterValue::Text(text.into()).to_string();
    let own = if is_standard_output(output) { Path::new(".") } else { folder(output) };
    let solution = arguments.options.solution.as_ref().map(|solution| relative_to(solution, own));
    let node_type = asked.node_type();
    let options = DataOptions { solution, ..arguments.options };
    let keys = reader_keys(&choice, &relative_to(&arguments.data, own), &options);
    let steepest = g.iter().copied().filter(|g| g.is_finite()).fold(g_axis.high, f64::max);
    // Finer than what can be told apart along either axis.
    let steps = [1e-6 * (high - low), 1e-6 * steepest];
    let at_s = |s: f64| format!("{:?}", value_at(scale, s, steps[0]));
    let at_g = |g: f64| format!("{:?}", decimal(g, steps[1]));
    let region = if is_log {
        String::new()
    } else {
        format!(
            "region = {{ s = [{}, {}], g = [{}, {}] }}\n",
            at_s(s_axis.low - (s_axis.high - s_axis.low)),
            at_s(s_axis.high + (s_axis.high - s_axis.low)),
            at_g(g_axis.low),
            at_g(2.0 * steepest)
        )
    };
    let depth = |extinction: f64| (extinction * unit).max(unit / chord);
    let mut widgets = String::new();
    for (one, color) in look.iter().zip(COLORS) {
        // No ray is longer within a boundary than within the grid.
        widgets += &widget(one, color, depth(one.extinction), steps, scale);
        widgets += &region;
    }
    if look.is_empty() {
        // Values that differ in no direction have no boundaries.
        let ends = [at_s(low), at_s(high)];
        widgets = format!(
            "\n[[nodes.look.widgets]]\nkind = \"piecewise-linear\"\npoints = [[{}, 0.08, 0.25, 0.9, 0.0], [{}, 0.9, 0.1, 0.06, {:?}]]\n",
            ends[0],
            ends[1],
            decimal(unit / chord, 1e-6)
        );
    }
    let haze = ProposedWidget {
        centre: [0.5 * low + 0.5 * high, 0.0],
        sigma: [high - low, f64::INFINITY],
        extinction: -(1.0 - HAZE).ln() / chord,
    };
    let [from, to] = [at_s(s_axis.low), at_s(s_axis.high)];
    let (told, on_scale) = match is_log {
        true => (
            format!(
                "told apart by its value s on a logarithmic scale: the widgets are Gaussians, as many decades wide as
# sigma says, at equal shares of the area of the logarithm's level surfaces, found from the data. Range: s {from} to {to}."
            ),
            "s_scale = \"log\"\n",
        ),
        false => (
            format!(
                "told apart by its value s and its gradient magnitude g: the widgets are Gaussians at equal
# shares of the level surfaces' area, found from the data. What is
# quieter than g = {} is left out. Ranges: s {from} to {to}, g to {} in 99.9 % of the volume.",
                at_g(g_axis.low),
                at_g(g_axis.high)
            ),
            "",
        ),
    };
    let (zoom, figure, shown) = match arguments.plain {
        true => (String::new(), String::new(), "picture"),
        false => (format!("zoom = {ZOOM:?}\n"), annotation(boxed && !view.leans), "figure"),
    };
    let stem = if is_standard_output(output) { arguments.data.file_stem() } else { output.file_stem() };
    let picture = PathBuf::from(stem.unwrap_or_default()).with_extension("png");
    let text = format!(
        "# Boundaries of {}, {told}

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
{on_scale}unit_distance = {}
{widgets}
# A haze over everything, so that the grid's shape is seen.
{}
[nodes.view]
type = \"camera\"
{}{zoom}size = [1024, 768]

[nodes.picture]
type = \"renderer\"
inputs = {{ volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}
{figure}
[nodes.file]
type = \"image-writer\"
path = {}
background = [0.0, 0.0, 0.0]
inputs = {{ image = \"{shown}\" }}
",
        name(&named),
        format_args!("{unit:?}"),
        widget(&haze, [0.5, 0.55, 0.6], haze.extinction * unit, steps, scale).trim_start(),
        view.keys(),
        text(&picture.to_string_lossy()),
    );
    let said = format!(
        "{} {} of '{}' found{}",
        look.len(),
        agreeing(&look.len(), "boundary", "boundaries"),
        name(&named),
        if is_log { ", on a logarithmic scale" } else { "" }
    );
    Ok((text, said))
}

/// Ratio of values, with a twentieth of the volume below and above them, from which on their logarithm is looked at.
const MANY_DECADES: f64 = 1e3;

/// True if a positive scalar spans decades in most of the volume.
fn spans_decades(grid: &Grid, scalar: &[f64], progress: &dyn Progress) -> Result<bool> {
    if !range(scalar).is_some_and(|[low, high]| low > 0.0 && high / low >= MANY_DECADES) {
        return Ok(false);
    }
    let volumes = Volumes::new(grid, scalar, progress)?;
    Ok(volumes.percentile(95.0, progress)? / volumes.percentile(5.0, progress)? >= MANY_DECADES)
}

/// A value as it is written, at a position on an axis; `step`: finer than positions that are told apart.
fn value_at(scale: AxisScale, position: f64, step: f64) -> f64 {
    let value = scale.value(position);
    // On a logarithmic axis a step is a share of the value.
    decimal(value, if scale.is_curved() { step * value } else { step })
}

/// False if all cells are flat, to roundings of their longest edge.
fn has_volume(grid: &Grid) -> bool {
    grid.tetrahedra.iter().any(|corners| {
        let [a, b, c, d] = corners.map(|corner| grid.points[corner as usize]);
        let edges = [b - a, c - a, d - a];
        let longest = edges.iter().map(|edge| edge.abs().max_element()).fold(f64::MIN_POSITIVE, f64::max);
        let [u, v, w] = edges.map(|edge| edge / longest);
        u.cross(v).dot(w) != 0.0
    })
}

/// The error for a file without a cell that can be drawn.
fn without_volume(arguments: &Start) -> Error {
    Error::run("no cell has a volume, so there is nothing to draw")
        .expected("cells of three dimensions, such as tetrahedra or hexahedra, that are not flat")
        .in_file(&arguments.data)
}

/// The node that writes the scale of the colours, axes and the file's name over the picture.
///
/// `boxed`: true where the picture holds the box of the data along the axes.
fn annotation(boxed: bool) -> String {
    let axes = if boxed { "box" } else { "directions" };
    format!(
        "
[nodes.figure]
type = \"annotation\"
title = \"{{file}}\"
axes = \"{axes}\"
inputs = {{ image = \"picture\", volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }}
"
    )
}

/// The error for an array that is the same everywhere, which names those that are not; that of the user's stop meanwhile.
fn without_boundary(arguments: &Start, asked: &Request, named: &str, progress: &dyn Progress) -> Error {
    let error = Error::run(format!("'{named}' has no boundary: it is the same everywhere"));
    let found = match inspect(&arguments.data, asked, progress) {
        Ok(summary) => summary.arrays,
        Err(stopped) if stopped.kind == ErrorKind::Cancelled => return stopped,
        // An array that is damaged does not hide what is wrong with this one.
        Err(_) => Vec::new(),
    };
    let others: Vec<String> =
        found.iter().filter(|a| a.varies()).map(|a| ArrayChoice::from_head(&a.head, &[]).scalar).collect();
    let expected = match others.is_empty() {
        true => "a file with an array whose values differ: this one has none".into(),
        false => format!("another array after --scalar: {}", others.join(", ")),
    };
    error.expected(expected).in_file(&arguments.data)
}

/// The array of the option `--scalar`.
///
/// Errors: the file has none of this name.
fn named_array(arguments: &Start, named: &str, all: &[FileArray]) -> Result<ArrayChoice> {
    let stem = named.rsplit_once(':').map_or(named, |(stem, _)| stem);
    if all.iter().any(|array| array.name == named || array.name == stem) {
        return Ok(ArrayChoice::by_name(named, all));
    }
    let names = nearest_first(stem, all.iter().map(|array| array.name.as_str()));
    let expected = match names.is_empty() {
        true => "a file with an array".into(),
        false => format!("--scalar NAME: {}", names.join(", ")),
    };
    Err(Error::usage(format!("the file holds no array '{named}'"))
        .expected(expected)
        .in_file(&arguments.data))
}

/// The array that is drawn where none is named.
fn first_quantity(arguments: &Start, summary: &Summary) -> Result<ArrayChoice> {
    if !summary.has_volume() {
        return Err(without_volume(arguments));
    }
    summary.first_quantity().ok_or_else(|| {
        let names: Vec<&str> = summary.arrays.iter().map(|array| array.head.name.as_str()).collect();
        let found = if names.is_empty() { "no arrays".into() } else { name(&names.join(", ")) };
        Error::run("no array is a quantity that varies")
            .got(found)
            .expected("a file with an array whose values differ")
            .in_file(&arguments.data)
    })
}

/// Over all of s, and g from where the data are not quiet to where nearly all of the volume is.
fn histogram_of(grid: &Grid, s: &[f64], g: &[f64], progress: &dyn Progress) -> Result<Histogram> {
    let s_axis = Axis::over(s, BINS);
    let whole = Axis::over(g, 16 * BINS);
    let half = |range| PartProgress { whole: progress, stage: "histogram", range };
    let coarse_axes = [Axis { bins: 1, ..s_axis }, Axis { low: whole.low.min(0.0), ..whole }];
    let coarse = histogram(grid, [s, g], coarse_axes, &half([0.0, 0.5]))?;
    let high = coarse.nearly_all();
    let low = quiet(&coarse).min(0.5 * high);
    histogram(grid, [s, g], [s_axis, Axis { low, high, bins: BINS }], &half([0.5, 1.0]))
}

/// A Gaussian of this extinction; `steps`: finer than what is told apart along s and g; `scale`: of s.
fn widget(
    one: &ProposedWidget,
    [red, green, blue]: [f64; 3],
    extinction: f64,
    steps: [f64; 2],
    scale: AxisScale,
) -> String {
    let [s, g] = [value_at(scale, one.centre[0], steps[0]), decimal(one.centre[1], steps[1])];
    let [along_s, along_g] = [0, 1].map(|axis| decimal(one.sigma[axis], 1e-5 * one.sigma[axis]));
    let along_g = if along_g.is_infinite() { "inf".to_string() } else { format!("{along_g:?}") };
    let extinction = decimal(extinction, 1e-5 * extinction);
    format!(
        "
[[nodes.look.widgets]]
kind = \"gaussian\"
color = [{red}, {green}, {blue}]
extinction = {extinction:?}
centre = [{s:?}, {g:?}]
sigma = [{along_s:?}, {along_g}]
"
    )
}

/// Points of what the widgets show; a few far off, which would make the rest small, are no part of it.
fn shown_points(grid: &Grid, s: &[f64], g: &[f64], look: &[ProposedWidget]) -> Vec<DVec3> {
    let drawn = |i: usize| {
        let profile = |one: &ProposedWidget| {
            let q = [(s[i] - one.centre[0]) / one.sigma[0], (g[i] - one.centre[1]) / one.sigma[1]];
            (-0.5 * (q[0] * q[0] + q[1] * q[1])).exp()
        };
        look.iter().map(profile).fold(0.0, f64::max) > 0.1
    };
    let places = 0..grid.drawn_points();
    let mut shown: Vec<DVec3> = places.filter(|i| drawn(*i)).map(|i| grid.points[i]).collect();
    for axis in 0..3 {
        let count = shown.len();
        if count < 8 {
            return grid.points[..grid.drawn_points()].to_vec();
        }
        shown.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
        shown = shown[count / 100..count - count / 100].to_vec();
    }
    shown
}

fn one_digit(x: f64) -> f64 {
    format!("{x:.0e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    /// The stages so far, and the one in which the user stops.
    struct StoppedIn {
        stage: &'static str,
        seen: Mutex<Vec<String>>,
    }

    impl Progress for StoppedIn {
        fn report(&self, stage: &str, _fraction: f64) {
            let mut seen = self.seen.lock().unwrap();
            if seen.last().is_none_or(|last| last != stage) {
                seen.push(stage.into());
            }
        }

        fn cancelled(&self) -> bool {
            self.seen.lock().unwrap().iter().any(|seen| seen == self.stage)
        }
    }

    #[test]
    fn it_is_stopped_in_each_stage_and_begins_no_other() {
        let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/heat_sink.vtu");
        let arguments = Start { data, scalar: Some("Temperature".into()), ..Start::default() };
        let registry = crate::nodes::registry().unwrap();
        let run = |stage| {
            let progress = StoppedIn { stage, seen: Mutex::default() };
            let made = pipeline(&arguments, &registry, Path::new("scene.toml"), &progress);
            (made, progress.seen.into_inner().unwrap())
        };
        let (made, stages) = run("none");
        assert!(made.unwrap().0.contains("[nodes.picture]"));
        assert_eq!(stages, ["reading", "tetrahedra", "gradient", "histogram", "widgets"]);
        for stage in ["reading", "tetrahedra", "gradient", "histogram", "widgets"] {
            let (made, seen) = run(stage);
            assert_eq!(made.unwrap_err().kind, ErrorKind::Cancelled, "{stage}");
            assert_eq!(seen.last().map(String::as_str), Some(stage), "{seen:?}");
        }
        // Over decades, where the values lie is looked at first.
        let folder = tempfile::tempdir().unwrap();
        let decades = folder.path().join("decades.vti");
        let values: Vec<String> = (0..10 * 4 * 4).map(|i| format!("1e{}", i % 10)).collect();
        let text = format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 9 0 3 0 3\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
             <Piece Extent=\"0 9 0 3 0 3\"><PointData><DataArray type=\"Float64\" Name=\"s\" format=\"ascii\">{}\
             </DataArray></PointData></Piece></ImageData></VTKFile>",
            values.join(" ")
        );
        std::fs::write(&decades, text).unwrap();
        let of_decades = Start { data: decades, scalar: Some("s".into()), ..Start::default() };
        let run = |stage| {
            let progress = StoppedIn { stage, seen: Mutex::default() };
            let made = pipeline(&of_decades, &registry, Path::new("scene.toml"), &progress);
            (made, progress.seen.into_inner().unwrap())
        };
        let (made, stages) = run("none");
        assert!(made.unwrap().0.contains("s_scale = \"log\""));
        assert!(stages.iter().any(|stage| stage == "distribution"), "{stages:?}");
        let (made, seen) = run("distribution");
        assert_eq!(made.unwrap_err().kind, ErrorKind::Cancelled);
        assert_eq!(seen.last().map(String::as_str), Some("distribution"), "{seen:?}");
        // Where the array is to be found, everything is read once more before it.
        let unnamed = Start { scalar: None, ..arguments };
        let progress = StoppedIn { stage: "reading", seen: Mutex::default() };
        let made = pipeline(&unnamed, &registry, Path::new("scene.toml"), &progress);
        assert_eq!(made.unwrap_err().kind, ErrorKind::Cancelled);
    }
}
