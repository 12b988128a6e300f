//! The VTK XML formats: .vtu .vts .vtr .vti .htg, and the files that name others: their parallel forms, trees of blocks and of
//! patches, and .pvd, a series of time steps.

pub(super) mod header;
mod hyper_tree;
mod named;
mod parallel;
pub(super) mod poly_data;
mod serial;
mod trees;

pub(super) use named::{beside, open_named};
pub(super) use serial::is_before;

use super::contents::Dataset;
use super::request::{Format, Request};
use super::source::{Source, text_of};
use super::text::has_mark;
use header::Element;
use named::HEAD;
use parallel::{SERIES, TREES, open_step};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use trees::Tree;
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format = Format {
    files: "a VTK XML file (.vtu, .vts, .vtr, .vti, their parallel forms, .vtm, .vthb, .htg, .pvd)",
    matches: |head, _, _| head.starts_with(b"<"),
    open,
    has_solution: false,
};

/// Reads the table of contents of a file of any of these formats.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, appended) = header::read(&source)?;
    match root.required("type")? {
        SERIES => open_series(&source, &root, request),
        kind if TREES.contains(&kind) => {
            let dataset = Tree::read(source.path(), &root)?.open(request, true)?;
            let format =
                format!("VTK {kind} of {}; {}", counted(dataset.blocks.len(), "block"), dataset.format);
            Ok(Dataset { format, ..dataset })
        }
        _ => open_step(source, &root, appended, request, true),
    }
}

/// Reads the tables of contents of the files of one step.
fn open_series(source: &Source, root: &Element, request: &Request) -> Result<Dataset> {
    let Step { time_steps, parts } = step(root, request)?;
    let (tree, has_blocks) = tree(source.path(), &parts)?;
    let mut dataset = tree.open(request, has_blocks)?;
    dataset.format = format!("VTK time series of {}; {}", counted(time_steps.len(), "step"), dataset.format);
    dataset.time_steps = time_steps;
    Ok(dataset)
}

/// A step of a series: times of all steps, and the parts of that asked for.
struct Step<'a> {
    time_steps: Vec<f64>,
    parts: Vec<&'a Element>,
}

/// The parts of a step as blocks, and true where some have names or are trees. A single part is none by itself; parts without names
/// are pieces of one grid.
fn tree(by: &Path, parts: &[&Element]) -> Result<(Tree, bool)> {
    let mut tree = Tree::default();
    let mut has_blocks = false;
    for (place, part) in parts.iter().enumerate() {
        let named = ["group", "name"].iter().filter_map(|key| part.attribute(key)).map(str::trim);
        let named = named.filter(|word| !word.is_empty()).collect::<Vec<_>>().join("/");
        has_blocks |= !named.is_empty();
        let name = match named.is_empty() {
            _ if parts.len() == 1 => String::new(),
            true => format!("part {}", part.attribute("part").map_or(place.to_string(), str::to_owned)),
            false => named,
        };
        has_blocks |= tree.add_part(by, part.required("file")?, &name)?;
    }
    Ok((tree, has_blocks))
}

fn step<'a>(root: &'a Element, request: &Request) -> Result<Step<'a>> {
    let collection = root.child(SERIES).ok_or_else(|| {
        Error::run("the file holds no <Collection>").expected("<Collection> of <DataSet file=\"…\">")
    })?;
    let mut entries = Vec::new();
    for element in collection.children_of("DataSet") {
        let time = element.number::<f64>("timestep")?.unwrap_or(0.0);
        if !time.is_finite() {
            return Err(element.wrong("timestep", "a finite number"));
        }
        element.required("file")?;
        entries.push((time, element));
    }
    let mut time_steps: Vec<f64> = entries.iter().map(|entry| entry.0).collect();
    time_steps.sort_by(f64::total_cmp);
    time_steps.dedup();
    if time_steps.is_empty() {
        return Err(Error::run("the time series is empty").expected("at least one <DataSet file=\"…\">"));
    }
    let time = time_steps[request.step_index(&time_steps)?];
    let parts = entries.into_iter().filter(|entry| entry.0 == time).map(|entry| entry.1).collect();
    Ok(Step { time_steps, parts })
}

/// The types that name others, as every writer spells them: series, trees, parallel files. Each may name those after it.
const MARKS: [&str; 7] = [
    "type=\"Collection\"",
    "type=\"vtkMultiBlock",
    "type=\"vtkPartitioned",
    "type=\"vtkOverlappingAMR",
    "type=\"vtkNonOverlappingAMR",
    "type=\"vtkHierarchicalBox",
    "type=\"P",
];

/// Number of those that stand before parallel files.
const ABOVE_PARALLEL: usize = MARKS.len() - 1;

/// The files that a series (of every step, or of that asked for), a tree or a parallel file names, and those that these name; none
/// for files of other kinds, of which no more than the head is read.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    files_marked(path, &MARKS, request)
}

/// Files that a file of one of these types names.
fn files_marked(path: &Path, marks: &[&str], request: Option<&Request>) -> Vec<PathBuf> {
    let Ok(source) = Source::open(path) else { return Vec::new() };
    let head = source.head(HEAD).unwrap_or_default();
    if !text_of(&head).starts_with(b"<") || !marks.iter().any(|mark| has_mark(&head, mark)) {
        return Vec::new();
    }
    let Ok((root, _)) = header::read(&source) else { return Vec::new() };
    let kind = root.attribute("type").unwrap_or("");
    let named = |names: Vec<&str>| names.into_iter().map(|name| beside(path, name)).collect();
    let (mut paths, further): (Vec<PathBuf>, &[&str]) = match request {
        Some(request) if kind == SERIES => {
            let tree = step(&root, request).and_then(|step| tree(path, &step.parts));
            (tree.map(|(tree, _)| tree.files(Some(request))).unwrap_or_default(), &MARKS[ABOVE_PARALLEL..])
        }
        None if kind == SERIES => (named(root.attributes_below(&["file"])), &MARKS[1..]),
        _ if TREES.contains(&kind) => {
            let tree = Tree::read(path, &root).map(|tree| tree.files(request));
            (tree.unwrap_or_default(), &MARKS[ABOVE_PARALLEL..])
        }
        _ => (named(root.attributes_below(&["Source"])), &[]),
    };
    let within: Vec<PathBuf> = paths.iter().flat_map(|path| files_marked(path, further, None)).collect();
    paths.extend(within);
    paths
}
