//! `voltet start`: a pipeline file for a data file, with a transfer function over (s, g) found from the data.

use super::shared::{ArrayChoice, DONE, Outcome, differ, differs, scalar, with_bar};
use crate::cli::arguments::{DataOptions, Start};
use crate::cli::present::{name, say};
use crate::core::arithmetic::decimal;
use crate::core::camera::{Camera, Projection};
use crate::core::clip::ClipShape;
use crate::core::field::{LeastSquares, Method, magnitude};
use crate::core::grid::Grid;
use crate::core::grid::extent::{bounds, corners, range, scene_length};
use crate::core::parameters::nearest_first;
use crate::core::probing::{Axis, Histogram, ProposedWidget, histogram, proposal, quiet};
use crate::core::progress::Progress;
use crate::core::{Error, Result, agreeing};
use crate::graph::{ParameterValue, Registry};
use crate::io::encode::format_by_ending;
use crate::io::formats::{
    ArraySummary, Association, FileArray, Request, Summary, arrays, files_beside, inspect, read,
};
use crate::nodes::files::{
    Use, argument, collision, folder, is_standard_output, refuse_unwritable, relative_to, standard_output,
    write_whole,
};
use glam::{DMat3, DVec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bins along s and g: what 64 colours of a curve would tell apart, four times over.
const BINS: usize = 256;

/// Linear RGB of the boundaries, in rising s.
const COLORS: [[f64; 3]; 4] = [[0.08, 0.25, 0.9], [0.05, 0.65, 0.45], [0.95, 0.6, 0.08], [0.9, 0.1, 0.06]];

/// Opacity of a haze over everything, along a ray of mean length: it shows the grid's shape.
const HAZE: f64 = 0.1;

/// Vertical angle of view, degrees.
const FOV_Y: f64 = 30.0;

/// Smallest range of values: a thousandth of it has an inverse in 64 bits.
const MIN_RANGE: f64 = 1e-300;

/// Zoom that leaves labels room beside the box of the data.
const ZOOM: f64 = 0.8;

/// Width and height of the picture, pixels.
const PICTURE: [u32; 2] = [1024, 768];

/// Direction to the eye: from the front, the side and above.
const OBLIQUE: DVec3 = DVec3::new(-0.8, -1.4, 0.9);

/// Share of the picture under which other directions are tried.
const FILLED: f64 = 0.3;

/// Share of the upright box's volume under which a box that leans holds the points better.
const MUCH_SMALLER: f64 = 0.5;

/// Steps to a principal component; a box needs no exact one.
const STEPS: usize = 8;

/// Shares of the components of the oblique direction in those that are tried.
const TILTS: [f64; 5] = [0.01, 0.05, 0.2, 0.5, 1.0];

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
    let gradient = Method::with_defaults(Arc::new(LeastSquares))?.gradient(&grid, &scalar, progress)?;
    let g = magnitude(&gradient.vectors);
    let found = histogram_of(&grid, &scalar, &g, progress)?;
    let look = proposal(&found, COLORS.len());
    let [s_axis, g_axis] = found.axes;
    let points = match arguments.fit {
        true => shown_points(&grid, &scalar, &g, &look),
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
    let keys = choice.keys(&relative_to(&arguments.data, own), &options);
    let steepest = g.iter().copied().filter(|g| g.is_finite()).fold(g_axis.high, f64::max);
    // Finer than what can be told apart along either axis.
    let steps = [1e-6 * (high - low), 1e-6 * steepest];
    let [at_s, at_g] = [0, 1].map(|axis| move |x: f64| format!("{:?}", decimal(x, steps[axis])));
    let region = format!(
        "region = {{ s = [{}, {}], g = [{}, {}] }}\n",
        at_s(s_axis.low - (s_axis.high - s_axis.low)),
        at_s(s_axis.high + (s_axis.high - s_axis.low)),
        at_g(g_axis.low),
        at_g(2.0 * steepest)
    );
    let depth = |extinction: f64| (extinction * unit).max(unit / chord);
    let mut widgets = String::new();
    for (one, color) in look.iter().zip(COLORS) {
        // No ray is longer within a boundary than within the grid.
        widgets += &widget(one, color, depth(one.extinction), steps);
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
    let linearly = if low > 0.0 && high / low >= 1e3 {
        let decades = (high / low).log10();
        format!(
            "# s spans {decades:.0} decades and is looked at linearly: what is far below {high:?} looks alike. s_scale = \"log\" at the node
# look, with a widget of the kind colormap, shows all of them.\n"
        )
    } else {
        String::new()
    };
    let (zoom, figure, shown) = match arguments.plain {
        true => (String::new(), String::new(), "picture"),
        false => (format!("zoom = {ZOOM:?}\n"), annotation(boxed && !view.leans), "figure"),
    };
    let stem = if is_standard_output(output) { arguments.data.file_stem() } else { output.file_stem() };
    let picture = PathBuf::from(stem.unwrap_or_default()).with_extension("png");
    let text = format!(
        "# Boundaries of {}, told apart by its value s and its gradient magnitude g: the widgets are Gaussians at equal
# shares of the level surfaces' area, found from the data. What is
# quieter than g = {} is left out. Ranges: s {} to {}, g to {} in 99.9 % of the volume.
{linearly}
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
        at_g(g_axis.low),
        at_s(s_axis.low),
        at_s(s_axis.high),
        at_g(g_axis.high),
        format_args!("{unit:?}"),
        widget(&haze, [0.5, 0.55, 0.6], haze.extinction * unit, steps).trim_start(),
        view.keys(),
        text(&picture.to_string_lossy()),
    );
    let mut said = format!(
        "{} {} of '{}' found",
        look.len(),
        agreeing(&look.len(), "boundary", "boundaries"),
        name(&named)
    );
    if let Some(note) = linearly.strip_prefix("# ") {
        said += &format!("; {}", note.trim_end().trim_end_matches('.'));
    }
    Ok((text, said))
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

/// The error for an array that is the same everywhere; names those that are not.
fn without_boundary(arguments: &Start, asked: &Request, named: &str, progress: &dyn Progress) -> Error {
    let error = Error::run(format!("'{named}' has no boundary: it is the same everywhere"));
    let found = inspect(&arguments.data, asked, progress).map(|summary| summary.arrays).unwrap_or_default();
    let others: Vec<String> = found.iter().filter(|a| differs(a)).map(|a| scalar(&a.head)).collect();
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

/// The file's own scalar, or the first that is a quantity; a flag or a number of something where nothing else differs.
fn first_quantity(arguments: &Start, summary: &Summary) -> Result<ArrayChoice> {
    if !summary.has_volume() {
        return Err(without_volume(arguments));
    }
    let heads: Vec<FileArray> = summary.arrays.iter().map(|array| array.head.clone()).collect();
    let mut arrays: Vec<&ArraySummary> = summary.quantities().filter(|array| differs(array)).collect();
    // Labels last; the file's own first, then scalars of the points, scalars of the cells, vectors, whole numbers.
    arrays.sort_by_key(|array| {
        let own = summary.active_scalars.as_deref() == Some(array.head.name.as_str());
        let is_whole = !array.number_type.starts_with("Float");
        let is_cell = array.head.association == Association::Cell;
        (is_label(&array.head.name), !own, is_whole, array.head.component_count > 1, is_cell)
    });
    arrays.first().map(|array| ArrayChoice::from_head(&array.head, &heads)).ok_or_else(|| {
        let names: Vec<&str> = heads.iter().map(|array| array.name.as_str()).collect();
        let found = if names.is_empty() { "no arrays".into() } else { name(&names.join(", ")) };
        Error::run("no array is a quantity that varies")
            .got(found)
            .expected("a file with an array whose values differ")
            .in_file(&arguments.data)
    })
}

/// True if an array of this name holds numbers or marks of things, and no quantity.
fn is_label(name: &str) -> bool {
    const LABELS: &str =
        "id ids flag flags mask ghost ghosttype rank part partition material index block region";
    // As in GlobalNodeId; fluids end in "id", too.
    let stem =
        |word: &str| Some(word.strip_suffix("Id").or(word.strip_suffix("ID"))?.ends_with(char::is_lowercase));
    if name.split(|c: char| !c.is_alphanumeric()).any(|word| stem(word) == Some(true)) {
        return true;
    }
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let mut words = words.map(|word| word.trim_start_matches("vtk"));
    words.any(|word| LABELS.split(' ').any(|label| label == word) || word.ends_with("ids"))
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

/// A Gaussian of this extinction; `steps`: finer than what is told apart along s and g.
fn widget(one: &ProposedWidget, [red, green, blue]: [f64; 3], extinction: f64, steps: [f64; 2]) -> String {
    let [s, g] = [0, 1].map(|axis| decimal(one.centre[axis], steps[axis]));
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

/// A camera, and what its rays meet.
struct FirstView {
    camera: Camera,
    /// Mean length of rays through the box of what is seen.
    chord: f64,
    /// Share of the picture that the box fills.
    filled: f64,
    /// True if it is along the axes of a box that leans.
    leans: bool,
    /// Distance of the nearest point along the view.
    nearest: f64,
}

/// A view of all points: along the axes, or along those of a box that leans where what it holds would fill too little of the picture.
fn view(points: &[DVec3], boxed: bool) -> Option<FirstView> {
    let [low, high] = bounds(points)?;
    let upright = upright_view(points, boxed)?;
    let middle = 0.5 * low + 0.5 * high;
    let Some(axes) = leaning_axes(points, middle, high - low) else {
        return Some(upright);
    };
    let turned: Vec<DVec3> = points.iter().map(|point| axes.transpose() * (*point - middle)).collect();
    let Camera { eye, target, up, .. } = upright.camera;
    let [eye, target] = [eye, target].map(|place| axes.transpose() * (place - middle));
    let camera = Camera { eye, target, up: axes.transpose() * up, ..upright.camera };
    let (chord, filled) = rays(&camera, bounds(&turned)?)?;
    if filled >= FILLED {
        return Some(FirstView { chord, filled, ..upright });
    }
    let leaning = upright_view(&turned, false)?;
    let Camera { eye, target, up, .. } = leaning.camera;
    let [eye, target] = [eye, target].map(|place| middle + axes * place);
    Some(FirstView {
        camera: Camera { eye, target, up: axes * up, ..leaning.camera },
        leans: true,
        ..leaning
    })
}

/// Axes of a box that is much smaller than the upright one, as of a rod along a diagonal: the principal components of the points in the
/// L1 norm, by the fixed point of Kwak (IEEE Trans. Pattern Analysis and Machine Intelligence 30(9), 2008).
fn leaning_axes(points: &[DVec3], middle: DVec3, size: DVec3) -> Option<DMat3> {
    let largest = size.max_element().max(f64::MIN_POSITIVE);
    let places = || points.iter().filter(|point| point.is_finite()).map(|point| (*point - middle) / largest);
    let (sum, count) = places().fold((DVec3::ZERO, 0.0), |(sum, count), place| (sum + place, count + 1.0));
    let principal = |part: &dyn Fn(DVec3) -> DVec3| {
        let parts = || places().map(|place| part(place - sum / count));
        let farthest = parts().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let step = |axis: DVec3| parts().map(|part| part * axis.dot(part).signum()).sum::<DVec3>();
        (0..STEPS).try_fold(farthest?.try_normalize()?, |axis, _| step(axis).try_normalize())
    };
    let along = principal(&|place| place)?;
    let across = principal(&|place| place - along * along.dot(place))?;
    let across = (across - along * along.dot(across)).try_normalize()?;
    let above = along.cross(across);
    let side = if above.z < 0.0 { -1.0 } else { 1.0 };
    let axes = DMat3::from_cols(along, side * across, side * above);
    let turned: Vec<DVec3> = places().map(|place| axes.transpose() * place).collect();
    let [low, high] = bounds(&turned)?;
    let content = |sides: DVec3| sides.max(DVec3::splat(1e-9)).element_product();
    (content(high - low) < MUCH_SMALLER * content(size / largest)).then_some(axes)
}

/// A view of all points, mostly along the shortest side of their box; along another where that leaves the picture empty, as of a rod.
/// `boxed`: holds their box, too.
fn upright_view(points: &[DVec3], boxed: bool) -> Option<FirstView> {
    let [low, high] = bounds(points)?;
    let largest = (high - low).max_element().max(f64::MIN_POSITIVE);
    let size = (high - low).max(DVec3::splat(1e-9 * largest));
    let ends = [low, low + size];
    let seen =
        |towards: DVec3, points: &[DVec3]| FirstView::from_direction(towards.normalize(), points, ends);
    let mut best = OBLIQUE * (0.3 + 0.7 * size.min_element() / size);
    let mut filled = seen(best, &corners(ends))?.filled;
    if filled < FILLED {
        let shares = || TILTS.into_iter();
        let tilted = shares()
            .flat_map(|x| shares().flat_map(move |y| shares().map(move |z| OBLIQUE * DVec3::new(x, y, z))));
        for towards in tilted {
            let other = seen(towards, &corners(ends))?.filled;
            (best, filled) = if other > filled { (towards, other) } else { (best, filled) };
        }
    }
    if boxed { seen(best, &corners(ends)) } else { seen(best, points) }
}

impl FirstView {
    /// From where the picture holds all points. `ends`: of their box.
    fn from_direction(towards: DVec3, points: &[DVec3], ends: [DVec3; 2]) -> Option<FirstView> {
        let up = if towards.z.abs() > 0.8 { DVec3::Y } else { DVec3::Z };
        let (target, projection) = (DVec3::ZERO, Projection::Perspective { fov_y: FOV_Y });
        let camera = Camera { eye: towards, target, up, projection, near: 0.0, size: PICTURE, samples: 1 };
        let camera = camera.fitted(points).ok()?;
        let (chord, filled) = rays(&camera, ends)?;
        let forward = camera.frame().ok()?.forward;
        let depths = points.iter().map(|point| (*point - camera.eye).dot(forward));
        let nearest = depths.filter(|depth| depth.is_finite()).fold(f64::INFINITY, f64::min);
        Some(FirstView { camera, chord, filled, nearest, leans: false })
    }

    /// Its keys in a pipeline file.
    fn keys(&self) -> String {
        let Camera { eye, target, up, .. } = self.camera;
        // A thousandth of a pixel at what is nearest.
        let step = 1e-6 * self.nearest;
        let vector = |v: DVec3| {
            let [x, y, z] = v.to_array().map(|x| decimal(x, step));
            format!("[{x:?}, {y:?}, {z:?}]")
        };
        let (eye, target, up) = (vector(eye), vector(target), up.to_array());
        format!("eye = {eye}\ntarget = {target}\nup = {up:?}\nfov_y = {FOV_Y:?}\n")
    }
}

/// Mean length of the rays of a picture through a box, and the share of them that meet it.
fn rays(camera: &Camera, [low, high]: [DVec3; 2]) -> Option<(f64, f64)> {
    const RAYS: [usize; 2] = [64, 48];
    let frame = camera.frame().ok()?;
    let seen = ClipShape::Box { low, high };
    let half = PICTURE.map(|side| 0.5 * f64::from(side) * frame.pixel);
    let (mut sum, mut met) = (0.0, 0_u32);
    for ray in 0..RAYS[0] * RAYS[1] {
        let [x, y] = [ray % RAYS[0], ray / RAYS[0]].map(|i| i as f64 + 0.5);
        let x = (2.0 * x / RAYS[0] as f64 - 1.0) * half[0];
        let y = (2.0 * y / RAYS[1] as f64 - 1.0) * half[1];
        let direction = (x * frame.right + y * frame.up + frame.forward).normalize();
        if let Some([enter, leave]) = seen.inside(camera.eye, direction)
            && leave > enter.max(0.0)
        {
            (sum, met) = (sum + (leave - enter.max(0.0)), met + 1);
        }
    }
    Some((sum / f64::from(met.max(1)), f64::from(met) / (RAYS[0] * RAYS[1]) as f64))
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

/// One digit.
fn one_digit(x: f64) -> f64 {
    format!("{x:.0e}").parse().unwrap_or(x)
}
