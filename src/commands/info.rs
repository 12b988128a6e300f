//! `voltet info`: what a data file holds, and a pipeline to start with; of a pipeline, what it finds out.

use super::findings::findings;
use super::outcome::DONE;
use crate::arguments::Info;
use crate::core::graph::{Datum, Observer, Registry};
use crate::core::progress::Progress;
use crate::core::{Error, Result};
use crate::nodes::formats::{ArraySummary, Association, Request, Summary, TimeStep, inspect};
use crate::present::{Bar, number};
use std::path::Path;

pub fn info(arguments: &Info, registry: &Registry) -> Result<u8> {
    if arguments.data.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        return findings(arguments, registry);
    }
    if let Some(option) = arguments.set.options.first() {
        let error = Error::usage("--set changes a pipeline, and this is a data file").found(option);
        return Err(error.accepted("a pipeline file (.toml), or no --set").in_file(&arguments.data));
    }
    let request = Request {
        time_step: arguments.time_step.map(TimeStep::Index),
        solution: arguments.solution.clone(),
        ..Request::default()
    };
    let bar = Bar::new(false);
    let summary = inspect(&arguments.data, &request, &Inspecting(&bar));
    bar.clear();
    print!("{}", described(&arguments.data, &summary?));
    Ok(DONE)
}

/// The bar of a run, for work without nodes.
struct Inspecting<'a>(&'a Bar);

impl Progress for Inspecting<'_> {
    fn report(&self, stage: &str, fraction: f64) {
        self.0.progress("", stage, fraction);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// The name of a VTK cell type.
fn cell_name(code: u8) -> String {
    let name = match code {
        1 => "vertex",
        2 => "poly-vertex",
        3 => "line",
        4 => "poly-line",
        5 => "triangle",
        6 => "triangle strip",
        7 => "polygon",
        8 => "pixel",
        9 => "quadrilateral",
        10 => "tetrahedron",
        11 => "voxel",
        12 => "hexahedron",
        13 => "wedge",
        14 => "pyramid",
        15 => "pentagonal prism",
        16 => "hexagonal prism",
        21 => "quadratic edge",
        22 => "quadratic triangle",
        23 => "quadratic quadrilateral",
        24 => "quadratic tetrahedron",
        25 => "quadratic hexahedron",
        26 => "quadratic wedge",
        27 => "quadratic pyramid",
        28 => "bi-quadratic quadrilateral",
        29 => "tri-quadratic hexahedron",
        32 => "bi-quadratic quadratic wedge",
        33 => "bi-quadratic quadratic hexahedron",
        37 => "tri-quadratic pyramid",
        42 => "polyhedron",
        _ => return format!("VTK cell type {code}"),
    };
    name.to_string()
}

fn described(path: &Path, summary: &Summary) -> String {
    let mut text = format!("{}\n  {}\n", path.display(), summary.format);
    let mebibytes = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
    text += &format!(
        "  {} in {} piece{}; about {} in memory as tetrahedra\n",
        mebibytes(summary.file_bytes),
        summary.piece_count,
        if summary.piece_count == 1 { "" } else { "s" },
        mebibytes(summary.memory_bytes)
    );
    text += &format!("\n{} points, {} cells\n", number(summary.point_count), number(summary.cell_count));
    for (&code, &count) in &summary.cells_by_type {
        text += &format!("  {:>12}  {}\n", number(count), cell_name(code));
    }
    if let Some([low, high]) = summary.bounds {
        text += "\nBounds (world units)\n";
        for (axis, low, high) in [("x", low.x, high.x), ("y", low.y, high.y), ("z", low.z, high.z)] {
            text += &format!("  {axis}  [{low}, {high}]\n");
        }
        text += &format!("  diagonal {}\n", (high - low).length());
    }
    text += if summary.arrays.is_empty() { "\nNo arrays\n" } else { "\nArrays\n" };
    let width = summary.arrays.iter().map(|a| a.name.chars().count()).max().unwrap_or(0);
    for array in &summary.arrays {
        text += &array_line(array, width);
    }
    if !summary.time_steps.is_empty() {
        let (first, last) = (summary.time_steps.first(), summary.time_steps.last());
        let ends = first.zip(last).map(|(a, b)| format!(", times {a} to {b}")).unwrap_or_default();
        text += &format!("\n{} time steps{ends}\n", summary.time_steps.len());
    }
    if summary.points_not_finite > 0 {
        text += &format!("warning: {} points are not finite\n", number(summary.points_not_finite));
    }
    text.extend(summary.warnings.iter().map(|warning| format!("warning: {warning}\n")));
    text + &suggestion(path, summary)
}

fn array_line(array: &ArraySummary, width: usize) -> String {
    let association = if array.association == Association::Cell { "cell" } else { "point" };
    let components = match array.component_count {
        1 => String::new(),
        n => format!(" × {n}"),
    };
    let range = match (array.range, array.component_count) {
        (Some([low, high]), 1) => format!("[{low}, {high}]"),
        (Some([low, high]), _) => format!("length [{low}, {high}]"),
        (None, _) => "no finite value".into(),
    };
    let bad = match array.not_finite_count {
        0 => String::new(),
        n => format!(", {} not finite", number(n)),
    };
    format!("  {association:5}  {:width$}  {}{components}  {range}{bad}\n", array.name, array.number_type)
}

/// A pipeline to start with: the first array with a range, bands of colour over it, and a camera that sees all.
fn suggestion(path: &Path, summary: &Summary) -> String {
    let drawn = summary.arrays.iter().find_map(|array| {
        let [low, high] = array.range.filter(|[low, high]| low < high)?;
        Some((array, low, high))
    });
    let (Some((array, low, high)), Some([from, to])) = (drawn, summary.bounds) else {
        return "\nNo array whose values differ: nothing to draw.\n".into();
    };
    let magnitude = if array.component_count > 1 { ":magnitude" } else { "" };
    let scalar = Datum::Text(format!("{}{magnitude}", array.name));
    let data = Datum::Text(path.display().to_string());
    let centre = 0.5 * (from + to);
    let eye = centre + (to - from).length() * glam::DVec3::new(-0.8, -1.4, 0.9);
    let middle = 0.5 * (low + high);
    let vector = |v: glam::DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    format!(
        "\nA pipeline to start with\n
[pipeline]
format = 1

[nodes.grid]
type = \"reader\"
path = {data}
scalar = {scalar}

[nodes.look]
type = \"transfer-function\"
unit_distance = \"auto\"

[[nodes.look.widgets]]
kind = \"piecewise-linear\"
points = [[{low:?}, 0.1, 0.2, 0.9, 0.0], [{middle:?}, 0.2, 0.8, 0.3, 0.02], [{high:?}, 0.9, 0.1, 0.1, 0.2]]

[nodes.view]
type = \"camera\"
eye = {}
target = {}

[nodes.picture]
type = \"renderer\"
inputs = {{ volume = \"grid\", transfer_function = \"look\", camera = \"view\" }}

[nodes.file]
type = \"image-writer\"
path = \"picture.png\"
inputs = {{ image = \"picture\" }}
",
        vector(eye),
        vector(centre)
    )
}
