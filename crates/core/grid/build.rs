//! Construction of a grid of tetrahedra from the parts of a file.

use super::cell_types::{CellType, describe_counts};
use super::file_cells::FileCells;
use super::overlap::faces;
use super::parts::{Association, CellValues, Cells, Options, RawGrid};
use super::source::Source;
use super::tally::{CellCounts, split_all, tally, tally_plain};
use super::within::within;
use super::{Grid, cell_values, clean};
use crate::SharedSlice;
use crate::progress::Progress;
use crate::{Error, Result};
use rayon::prelude::*;
use std::sync::Arc;

/// Builds a grid of tetrahedra from what a reader hands over.
///
/// Cells of fewer dimensions, ghosts, and cells that touch a position or value that is not finite are left out and
/// counted in [`Grid::origin`]. Points that no tetrahedron uses are dropped, so the grid's point numbers are not
/// the file's where there are such; their order is kept.
pub fn build(mut parts: RawGrid, options: &Options, progress: &dyn Progress) -> Result<Grid> {
    check(&parts, options)?;
    progress.report("tetrahedra", 0.0);
    let point_not_finite = clean::points_not_finite(&parts);
    let cell_not_finite = clean::cells_not_finite(&parts);
    let cells = std::mem::replace(&mut parts.cells, Cells::Tetrahedra(Vec::new()));
    let (ghost, degrees) = (parts.ghost.take(), parts.degrees.take());
    let mut source = Source {
        cells: &cells,
        point_count: parts.points.len(),
        ghost: ghost.as_deref(),
        point_not_finite,
        cell_not_finite,
        degrees: degrees.as_deref(),
        curved: Default::default(),
        polyhedra: Default::default(),
    };
    source.prepare(&parts.points, options.subdivision as usize)?;
    let plain = matches!(source.cells, Cells::Tetrahedra(_))
        && source.ghost.is_none()
        && source.point_not_finite.is_none()
        && source.cell_not_finite.is_none();
    let tally = if plain { tally_plain(&source)? } else { tally(&source, progress)? };

    let mut origin = tally.origin();
    origin.arrays_unread = std::mem::take(&mut parts.arrays_unread);
    (origin.values_unread, origin.arrays_decoded) = (parts.values_unread, parts.arrays_decoded);
    origin.warnings = std::mem::take(&mut parts.warnings);
    tally.warn(&mut origin.warnings);
    if source.polyhedra.choices.overlapping > 0 {
        origin.warnings.push(format!(
            "{} polyhedra are so far from convex that their pieces overlap.",
            source.polyhedra.choices.overlapping
        ));
    }
    if tally.tetrahedra() == 0 {
        return Err(nothing_to_draw(&tally));
    }
    if u32::try_from(tally.tetrahedra()).is_err() {
        return Err(Error::run("the grid has too many tetrahedra")
            .got(tally.tetrahedra())
            .expected(format!("at most {}", u32::MAX)));
    }
    let split = if plain { None } else { Some(split_all(&source, &tally, progress)?) };
    // Before points are added, and cells taken apart.
    let file_points = options.keep_cells.then(|| parts.points.clone());
    if source.added_count() > 0 {
        add_points(&mut parts, &source)?;
    }
    drop(source);
    let file_cells = options.keep_cells.then(|| cells.clone());
    let (mut tetrahedra, source_cells) = match (split, cells) {
        (Some((tetrahedra, source_cells)), _) => (tetrahedra, Some(source_cells)),
        // Nothing is left out and nothing is split: the file's cells are the tetrahedra.
        (None, Cells::Tetrahedra(own)) => (own, None),
        (None, _) => return Err(nothing_to_draw(&tally)),
    };
    tetrahedra.par_iter_mut().with_min_len(1 << 13).for_each(|t| t.sort_unstable());
    progress.report("tetrahedra", 0.8);

    let cell_values = cell_values::take(&mut parts);
    let numbers = clean::drop_unused_points(&mut parts, &mut tetrahedra)?;
    origin.warnings.extend(overlaps(&parts.points, &tetrahedra, source_cells.as_deref()));
    let mut grid = Grid {
        points: parts.points,
        tetrahedra: SharedSlice::from(tetrahedra),
        source_cells: source_cells.map(Arc::new),
        scalar: None,
        scalar_name: String::new(),
        point_arrays: parts.point_arrays.into_iter().map(|(name, a)| (name, Arc::new(a))).collect(),
        cell_arrays: parts.kept_cell_arrays.into_iter().map(|(name, a)| (name, Arc::new(a))).collect(),
        file_cells: None,
        origin: Arc::new(origin),
    };
    if let Some((cells, points)) = file_cells.zip(file_points) {
        let same = numbers.is_none() && points.len() == grid.points.len();
        let points = if same { grid.points.clone() } else { points };
        grid.file_cells = Some(Arc::new(FileCells { cells, points, numbers, ghost, degrees }));
    }
    if let Some(scalar) = parts.scalar {
        grid.scalar_name = scalar.name;
        grid.scalar = Some(scalar.values);
    }
    match options.cell_values {
        CellValues::Average => cell_values::average(&mut grid, cell_values),
        CellValues::Constant => cell_values::keep_constant(&mut grid, cell_values)?,
    }
    progress.report("tetrahedra", 1.0);
    Ok(grid)
}

/// Says which cells overlap others, where there are such.
fn overlaps(points: &[glam::DVec3], tetrahedra: &[[u32; 4]], source_cells: Option<&[u32]>) -> Option<String> {
    let found = faces(points, tetrahedra);
    let cell = |tetrahedron: u32| source_cells.map_or(tetrahedron, |cells| cells[tetrahedron as usize]);
    let remedy = "and are drawn twice as dense there";
    if let Some(&first) = found.overlapping.first() {
        let mut cells: Vec<u32> = found.overlapping.iter().map(|&tetrahedron| cell(tetrahedron)).collect();
        cells.sort_unstable();
        cells.dedup();
        let middle: glam::DVec3 = tetrahedra[first as usize].map(|p| points[p as usize] * 0.25).iter().sum();
        return Some(format!(
            "{} cells overlap others (the same side of a shared face is theirs too) {remedy}; the first is cell {}, about \
             [{}, {}, {}]. Leave out what is there twice, such as ghost cells of pieces",
            cells.len(),
            cell(first),
            middle.x,
            middle.y,
            middle.z
        ));
    }
    let within = within(points, tetrahedra, &found.boundary);
    let (place, [own, other]) = within.first?;
    Some(format!(
        "cells overlap others that they share no face with {remedy}: of {} places on the grid's boundary {} lie in another cell; \
         the first is [{}, {}, {}], of cell {} and within cell {}. Leave out what is there twice, such as parts of overset grids",
        within.tried,
        within.inside,
        place.x,
        place.y,
        place.z,
        cell(own),
        cell(other)
    ))
}

/// Appends the points that curved cells and polyhedra add, with all values that sit on points.
fn add_points(parts: &mut RawGrid, source: &Source) -> Result<()> {
    let count = source.added_count();
    let points: Vec<glam::DVec3> = (0..count)
        .into_par_iter()
        .map(|i| {
            source.weights_of_added(i, |weights| weights.map(|(p, w)| parts.points[p as usize] * w).sum())
        })
        .collect::<Result<_>>()?;
    parts.points.make_mut().extend_from_slice(&points);
    let interpolate = |values: &mut SharedSlice<f64>, component_count: usize| -> Result<()> {
        let n = component_count.max(1);
        let mut added = vec![0.0; count * n];
        added.par_chunks_exact_mut(n).enumerate().try_for_each(|(i, tuple)| {
            source.weights_of_added(i, |weights| {
                for (p, w) in weights {
                    tuple.iter_mut().zip(&values[p as usize * n..]).for_each(|(sum, v)| *sum += w * v);
                }
            })
        })?;
        values.make_mut().extend_from_slice(&added);
        Ok(())
    };
    if let Some(scalar) = parts.scalar.as_mut().filter(|s| s.association == Association::Point) {
        interpolate(&mut scalar.values, 1)?;
    }
    for array in parts.point_arrays.values_mut() {
        interpolate(&mut array.values, array.component_count)?;
    }
    Ok(())
}

/// Lengths and limits that everything after relies on.
fn check(parts: &RawGrid, options: &Options) -> Result<()> {
    if !(1..=64).contains(&options.subdivision) {
        return Err(Error::usage("the subdivision of curved cells is out of range")
            .got(options.subdivision)
            .expected("a whole number from 1 to 64")
            .at_item("subdivision"));
    }
    let point_count = parts.points.len();
    if u32::try_from(point_count).is_err() {
        return Err(Error::run("the grid has too many points")
            .got(point_count)
            .expected(format!("at most {}", u32::MAX)));
    }
    let cell_count = parts.cells.count();
    if u32::try_from(cell_count).is_err() {
        return Err(Error::run("the grid has too many cells")
            .got(cell_count)
            .expected(format!("at most {}", u32::MAX)));
    }
    match &parts.cells {
        Cells::Structured(n) => {
            let product = n.iter().fold(1usize, |product, &n| product.saturating_mul(n));
            if product != point_count {
                return Err(Error::run("a structured grid has the wrong number of points")
                    .got(point_count)
                    .expected(format!("{} × {} × {}", n[0], n[1], n[2])));
            }
        }
        Cells::Mixed(cells) if cells.offsets.len() != cell_count + 1 => {
            return Err(Error::run("the cells have the wrong number of offsets")
                .got(cells.offsets.len())
                .expected(cell_count + 1));
        }
        _ => {}
    }
    let expect = |name: &str, found: usize, accepted: usize| {
        if found == accepted {
            return Ok(());
        }
        Err(Error::run("an array has the wrong number of values").got(found).expected(accepted).at_item(name))
    };
    let count_of = |association| if association == Association::Point { point_count } else { cell_count };
    if let Some(scalar) = &parts.scalar {
        expect(&scalar.name, scalar.values.len(), count_of(scalar.association))?;
    }
    for (arrays, association) in [
        (&parts.point_arrays, Association::Point),
        (&parts.cell_arrays, Association::Cell),
        (&parts.kept_cell_arrays, Association::Cell),
    ] {
        for (name, array) in arrays {
            let tuples = count_of(association);
            expect(name, array.values.len(), tuples.saturating_mul(array.component_count.max(1)))?;
        }
    }
    if let Some(ghost) = &parts.ghost {
        expect("ghost flags", ghost.len(), cell_count)?;
    }
    if let Some(degrees) = &parts.degrees {
        expect("degrees", degrees.len(), cell_count)?;
    }
    Ok(())
}

/// The error where no tetrahedron is left.
fn nothing_to_draw(tally: &CellCounts) -> Error {
    let mut found = describe_counts(&tally.by_type);
    for (count, why) in [(tally.ghost, "ghosts"), (tally.not_finite, "not finite")] {
        if count > 0 {
            found.push_str(&format!(" ({count} {why})"));
        }
    }
    if let Some((&first, _)) = tally.unsupported.iter().next()
        && let Some(cell_type) = CellType::from_code(first)
    {
        found.push_str(&format!(" (a {} cannot be split)", cell_type.name));
    }
    Error::run("there is nothing to draw").got(found).expected("at least one three-dimensional cell")
}
