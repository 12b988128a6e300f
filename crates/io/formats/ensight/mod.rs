//! Cases of EnSight Gold (.case): geometry and variables in text and in C binary, with their steps, in files of one or
//! of several. Parts are blocks.
//!
//! Source: EnSight user manual, "EnSight Gold Case File Format". Parts without volume elements are left out.

mod case;
mod parts;

use self::case::{CaseFile, StepFile};
use self::parts::{BlockForm, GoldBlock, GoldGeometry, GoldPart};
use super::blocks::{left_out, selected};
use super::contents::{CellBlocks, Compute, Dataset, Encoding, Geometry, Piece, PieceArray, Stored};
use super::lazy::geometry;
use super::request::{Format, Request};
use super::source::Source;
use glam::{DMat3, DVec3};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format = Format {
    files: "a case of EnSight Gold (.case)",
    matches: |head, _, _| is_case(head),
    open,
    has_solution: false,
};

fn is_case(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head).to_lowercase();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next() == Some("format")
        && lines.next().is_some_and(|line| line.replace([' ', '\t'], "").starts_with("type:ensight"))
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let case = CaseFile::read(&source)?;
    let times = case.times();
    let time = if times.is_empty() { None } else { Some(times[request.step_index(&times)?]) };
    let file = case.file(&case.geometry, time)?;
    let grid = Arc::new(GoldGeometry::open(&file)?);
    let volumes: Vec<usize> =
        (0..grid.parts.len()).filter(|&part| grid.parts[part].cell_count() > 0).collect();
    let is_unique = |name: &str| grid.parts.iter().filter(|part| part.name == name).count() == 1;
    let name = |part: &GoldPart| match is_unique(&part.name) {
        true if part.name.is_empty() => format!("part {}", part.number),
        true => part.name.clone(),
        false => format!("{} ({})", part.name, part.number),
    };
    let blocks: Vec<String> = volumes.iter().map(|&part| name(&grid.parts[part])).collect();
    let is_selected = selected(&blocks, request)?;
    let mut dataset = Dataset {
        format: "EnSight Gold".to_owned(),
        has_blocks: true,
        blocks,
        time_steps: times,
        file_bytes: std::fs::metadata(&file.path).map_or(0, |metadata| metadata.len()),
        ..Dataset::default()
    };
    let flat: Vec<String> = grid.parts.iter().filter(|part| part.is_flat()).map(name).collect();
    let mut warn = |what: &str, names: &[String]| {
        dataset.warnings.extend(left_out(what, names.iter().map(String::as_str)));
    };
    warn("Parts without cells of three dimensions", &flat);
    warn("Variables of complex numbers or of particles", &case.left_out);
    // Each file is looked through for the step once.
    let files = case.variables.iter().map(|variable| case.file(&variable.pattern, time).map(Arc::new));
    let files: Vec<Arc<StepFile>> = files.collect::<Result<_>>()?;
    let len = |file: &StepFile| std::fs::metadata(&file.path).map_or(0, |metadata| metadata.len());
    let all_bytes = files.iter().map(|file| len(file)).fold(dataset.file_bytes, u64::saturating_add);
    for (block, &place) in volumes.iter().enumerate().filter(|(block, _)| is_selected[*block]) {
        let part = &grid.parts[place];
        // A block of boxes takes a few numbers whatever its size, which is believed where there may be values for its cells.
        if part.node_count > all_bytes.saturating_mul(8) {
            let error = Error::run("a block is larger than the files of the case can hold values for");
            return Err(error.got(counted(part.node_count, "point")).at_item(&dataset.blocks[block]));
        }
        let counts = [part.node_count, part.cell_count()];
        let mut arrays = Vec::new();
        for (variable, file) in case.variables.iter().zip(&files) {
            let (association, n) = (variable.association, variable.component_count);
            let (file, of) = (file.clone(), grid.clone());
            let compute: Compute = Arc::new(move |_| of.values(&file, place, association, n));
            let tuple_count = if association == Association::Point { counts[0] } else { counts[1] };
            let stored = Stored::of_f64(&source, &variable.name, n, tuple_count, Encoding::Computed(compute));
            let names: &[&str] = if n == 6 { &["XX", "YY", "ZZ", "XY", "XZ", "YZ"] } else { &[] };
            let component_names = names.iter().map(|name| (*name).to_owned()).collect();
            arrays.push(PieceArray { component_names, ..PieceArray::new(association, stored) });
        }
        let geometry = part_geometry(&grid, place, &source)?;
        dataset.pieces.push(Piece::new(counts, geometry, arrays).with_blocks(CellBlocks::One(block)));
    }
    Ok(dataset)
}

fn part_geometry(grid: &Arc<GoldGeometry>, place: usize, source: &Arc<Source>) -> Result<Geometry> {
    let (part, of) = (&grid.parts[place], grid.clone());
    match part.block {
        Some(GoldBlock { dimensions, form: BlockForm::Uniform }) => {
            let axes = grid.axes(place)?;
            let [origin, spacing] = [0, 1].map(|k| DVec3::new(axes[0][k], axes[1][k], axes[2][k]));
            let (first, direction) = (DVec3::ZERO, DMat3::IDENTITY);
            Ok(Geometry::Uniform { dimensions, first, origin, spacing, direction })
        }
        Some(GoldBlock { dimensions, form: BlockForm::Rectilinear }) => {
            let axis = |axis: usize| {
                let of = grid.clone();
                let compute: Compute = Arc::new(move |_| Ok(of.axes(place)?[axis].clone()));
                Stored::of_f64(source, "coordinates", 1, dimensions[axis], Encoding::Computed(compute))
            };
            Ok(Geometry::Rectilinear { dimensions, axes: Box::new([axis(0), axis(1), axis(2)]) })
        }
        _ => {
            let counts = [part.node_count, part.cell_count(), part.corner_count()];
            Ok(geometry(counts, move |_| of.read(place)))
        }
    }
}

/// The files that a case names, of every step or of that asked for; none for other files.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, is_case) else { return Vec::new() };
    let Ok(case) = &CaseFile::read(&source) else { return Vec::new() };
    let times = case.times();
    let asked = request.filter(|_| !times.is_empty()).and_then(|request| request.step_index(&times).ok());
    let times: Vec<Option<f64>> = match asked {
        Some(step) => vec![Some(times[step])],
        None if times.is_empty() => vec![None],
        None => times.into_iter().map(Some).collect(),
    };
    let patterns = || std::iter::once(&case.geometry).chain(case.variables.iter().map(|own| &own.pattern));
    let of_time = |time: Option<f64>| {
        patterns().filter_map(move |pattern| Some(case.file(pattern, time).ok()?.path)).collect::<Vec<_>>()
    };
    let mut files: Vec<PathBuf> = times.into_iter().flat_map(of_time).collect();
    files.sort();
    files.dedup();
    files
}
