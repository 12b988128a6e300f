//! Construction of a grid of tetrahedra from the parts of a file.
//!
//! Two passes go over all cells, in parallel: one checks and counts, one writes the tetrahedra.

use super::adjacency::split_lengths;
use super::cell_types::{CellType, code, describe_counts};
use super::overlap::{faces, within};
use super::parts::{
    Association, CellValues, Cells, FileCells, HangingPoint, Options, RawGrid, UNUSED, as_given, is_ghost,
    is_left_out, is_neighbour, number,
};
use super::source::{CellStatus, Source};
use super::unsplit::unsplit;
use super::{Array, GhostCells, Grid, cell_values};
use crate::parallel::all_or_first;
use crate::progress::Progress;
use crate::{Error, Result, SharedSlice, agreeing, counted, noun_of};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Builds a grid of tetrahedra from what a reader hands over.
///
/// Cells of fewer dimensions, hidden ones, and cells that touch a position or value that is not finite are left out and
/// counted in [`Grid::origin`]. Ghost cells serve means of cell values and, as [`Grid::ghosts`], gradients. Points that no tetrahedron uses are dropped, so the grid's point numbers are not
/// the file's where there are such; their order is kept. Where [`Options::without_tetrahedra`] allows it, the grid is the file's
/// cells alone.
pub fn build(parts: RawGrid, options: &Options, progress: &dyn Progress) -> Result<Grid> {
    try_build(parts, options, progress)?
}

/// Builds the grid of a part of a file, as [`build`] that of all: `None` where it has nothing to draw.
pub fn build_part(parts: RawGrid, options: &Options, progress: &dyn Progress) -> Result<Option<Grid>> {
    try_build(parts, options, progress).map(Result::ok)
}

/// The grid; the error within: there is nothing to draw.
fn try_build(mut parts: RawGrid, options: &Options, progress: &dyn Progress) -> Result<Result<Grid>> {
    check(&parts, options)?;
    if options.without_tetrahedra && parts.scalar.is_none() && parts.cell_arrays.is_empty() {
        return unsplit(parts).map(Ok);
    }
    progress.report("tetrahedra", 0.0);
    let point_not_finite = not_finite(&parts, Association::Point);
    let cell_not_finite = not_finite(&parts, Association::Cell);
    let cells = std::mem::take(&mut parts.cells);
    let (ghost, degrees) = (parts.ghost.take(), parts.degrees.take());
    let (joined_points, hanging) = (parts.joined_points.take(), parts.hanging.take());
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
        && source.ghost.is_none_or(|flags| !flags.iter().any(|&flags| is_left_out(flags)))
        && source.point_not_finite.is_none()
        && source.cell_not_finite.is_none();
    let tally = if plain { tally_plain(&source)? } else { tally(&source, progress)? };

    let mut origin = std::mem::take(&mut parts.origin);
    origin.cells_by_type = tally.by_type.clone();
    (origin.cells_not_finite, origin.cells_ghost) = (tally.not_finite, tally.ghost + tally.without_owner);
    origin.ghosts_without_owner = tally.without_owner;
    origin.cells_not_volume = tally.not_volume;
    if tally.not_finite > 0 {
        origin.warnings.push(format!(
            "{} {} left out because a position or value is not finite.",
            counted(tally.not_finite, "three-dimensional cell"),
            agreeing(&tally.not_finite, "was", "were")
        ));
    }
    if tally.without_owner > 0 {
        origin.warnings.push(format!(
            "{} {} no owner in any piece that was read, and {} not drawn: is a piece missing?",
            counted(tally.without_owner, "ghost cell"),
            agreeing(&tally.without_owner, "has", "have"),
            agreeing(&tally.without_owner, "is", "are")
        ));
    }
    if !tally.unsupported.is_empty() {
        origin.warnings.push(format!(
            "{} {} left out: cells of this type cannot be split into tetrahedra.",
            describe_counts(&tally.unsupported),
            agreeing(&tally.unsupported.values().sum::<u64>(), "was", "were")
        ));
    }
    let left_out: Vec<String> = source.polyhedra.warnings(|cell| origin.whole_cell(cell)).collect();
    if tally.drawn == 0 {
        return Ok(Err(nothing_to_draw(&tally, &left_out)));
    }
    origin.warnings.extend(left_out);
    number(tally.tetrahedra(), "the grid has too many tetrahedra", "")?;
    let split = if plain { None } else { Some(split_all(&source, &tally, progress)?) };
    // Before points are added, and cells taken apart.
    let file_points = options.keep_cells.then(|| parts.points.clone());
    if source.added_count() > 0 {
        add_points(&mut parts, &source)?;
    }
    drop(source);
    let file_cells = options.keep_cells.then(|| cells.clone());
    let (mut tetrahedra, source_cells) = match (split, cells) {
        (Some((tetrahedra, source_cells)), _) => (tetrahedra.into(), Some(source_cells)),
        // Nothing is left out and nothing is split: the file's cells are the tetrahedra.
        (None, Cells::Tetrahedra(own)) => (own, None),
        (None, _) => return Ok(Err(nothing_to_draw(&tally, &[]))),
    };
    // Tetrahedra that somebody lends are used in place where they can be.
    if !tetrahedra.par_iter().with_min_len(1 << 13).all(|t| t.is_sorted()) {
        tetrahedra.make_mut().par_iter_mut().with_min_len(1 << 13).for_each(|t| t.sort_unstable());
    }
    progress.report("tetrahedra", 0.8);

    let of_cells = parts.cell_arrays.keys().filter(|name| !parts.point_arrays.contains_key(*name));
    origin.arrays_of_cells = of_cells.cloned().collect();
    let mut cell_values = cell_values::take(&mut parts);
    for (name, count) in cell_values.not_finite_at_boundary() {
        origin.warnings.push(format!(
            "{} of '{name}' at the boundary {} not finite: the points there have means of cells.",
            counted(count, "value"),
            agreeing(&count, "is", "are")
        ));
    }
    let mut numbers = drop_unused_points(&mut parts, &mut tetrahedra)?;
    if let Some(numbers) = &numbers {
        cell_values = cell_values.renumbered(numbers);
    }
    let mut grid = Grid {
        points: parts.points,
        tetrahedra,
        source_cells: source_cells.map(Arc::new),
        point_arrays: parts.point_arrays.into_iter().map(|(name, a)| (name, Arc::new(a))).collect(),
        cell_arrays: parts.kept_cell_arrays.into_iter().map(|(name, a)| (name, Arc::new(a))).collect(),
        hanging: hanging.map(|hanging| Arc::new(renumbered(hanging, numbers.as_deref()))),
        ..Grid::default()
    };
    if let Some(scalar) = parts.scalar {
        grid.scalar_name = scalar.name;
        grid.scalar = Some(scalar.values);
    }
    let constant = match options.cell_values {
        CellValues::Average => {
            cell_values::average(&mut grid, cell_values);
            None
        }
        CellValues::Constant => Some(cell_values),
    };
    if tally.without_owner + tally.neighbours > 0 {
        let order = set_ghosts_apart(&mut grid, ghost.as_deref().unwrap_or_default());
        let hanging = grid.hanging.take();
        grid.hanging = hanging.map(|own| Arc::new(renumbered(Arc::unwrap_or_clone(own), Some(&order))));
        numbers = match numbers {
            None => Some(order),
            Some(mut numbers) => {
                numbers.iter_mut().filter(|p| **p != UNUSED).for_each(|p| *p = order[*p as usize]);
                Some(numbers)
            }
        };
    }
    if let Some((cells, points)) = file_cells.zip(file_points) {
        let same = numbers.is_none() && points.len() == grid.points.len();
        let points = if same { grid.points.clone() } else { points };
        let ghost = ghost.map(|flags| flags.into_iter().map(as_given).collect());
        grid.file_cells = Some(Arc::new(FileCells { cells, points, numbers, joined_points, ghost, degrees }));
    }
    let cell = |tetrahedron: u32| origin.whole_cell(grid.source_cell(tetrahedron as usize) as u32);
    let overlaps = overlaps(&grid.points, &grid.tetrahedra, cell);
    origin.warnings.extend(overlaps);
    if let Some(values) = constant {
        cell_values::keep_constant(&mut grid, values)?;
    }
    grid.origin = Arc::new(origin);
    progress.report("tetrahedra", 1.0);
    Ok(Ok(grid))
}

/// Hanging points by the new numbers of points, without those that lie in cells left out.
fn renumbered(hanging: Vec<HangingPoint>, numbers: Option<&[u32]>) -> Vec<HangingPoint> {
    let Some(numbers) = numbers else { return hanging };
    let hanging = hanging.iter().map(|own| own.renumbered(|point| numbers[point as usize]));
    hanging.filter(|own| !own.numbers().contains(&UNUSED)).collect()
}

/// Takes the ghost cells from among those that are drawn, and gives each point its new number: those that ghosts alone use come last.
fn set_ghosts_apart(grid: &mut Grid, flags: &[u8]) -> Vec<u32> {
    let cells = (0..grid.tetrahedra.len() as u32).into_par_iter().with_min_len(VALUE_CHUNK);
    let (ghosts, drawn): (Vec<u32>, Vec<u32>) =
        cells.partition(|&cell| is_ghost(flags[grid.source_cell(cell as usize)]));
    let corners = |&cell: &u32| grid.tetrahedra[cell as usize];
    let is_drawn = used_points(grid.points.len(), drawn.par_iter().map(corners));
    let points = (0..grid.points.len() as u32).into_par_iter().with_min_len(VALUE_CHUNK);
    let (mut old, last): (Vec<u32>, Vec<u32>) = points.partition(|&point| is_drawn[point as usize]);
    let drawn_points = old.len();
    old.extend(last);
    let mut order = vec![0; old.len()];
    old.iter().zip(0..).for_each(|(&old, new)| order[old as usize] = new);

    let renumbered = |cell: &u32| corners(cell).map(|p| order[p as usize]);
    let sorted = |cell: &u32| {
        let mut corners = renumbered(cell);
        corners.sort_unstable();
        corners
    };
    // Points of drawn cells keep their order.
    let tetrahedra: Vec<[u32; 4]> = drawn.par_iter().with_min_len(VALUE_CHUNK).map(renumbered).collect();
    grid.ghosts =
        Some(Arc::new(GhostCells { tetrahedra: ghosts.iter().map(sorted).collect(), drawn_points }));
    let source_cells = drawn.par_iter().map(|&cell| grid.source_cell(cell as usize) as u32).collect();
    grid.source_cells = Some(Arc::new(source_cells));
    grid.tetrahedra = tetrahedra.into();
    grid.points = old.iter().map(|&p| grid.points[p as usize]).collect();
    let values = |values: &SharedSlice<f64>, n| SharedSlice::from(cell_values::gather(values, n, &old));
    grid.scalar = grid.scalar.as_ref().map(|scalar| values(scalar, 1));
    for array in grid.point_arrays.values_mut() {
        let Array { component_count, values: own } = &**array;
        *array = Arc::new(Array { component_count: *component_count, values: values(own, *component_count) });
    }
    order
}

/// Says which cells overlap others, where there are such. `cell`: number of a tetrahedron's cell, for people.
fn overlaps(points: &[glam::DVec3], tetrahedra: &[[u32; 4]], cell: impl Fn(u32) -> u64) -> Option<String> {
    let found = faces(points, tetrahedra);
    if let Some(&first) = found.overlapping.first() {
        let mut cells: Vec<u64> = found.overlapping.iter().map(|&tetrahedron| cell(tetrahedron)).collect();
        cells.sort_unstable();
        cells.dedup();
        let middle: glam::DVec3 = tetrahedra[first as usize].map(|p| points[p as usize] * 0.25).iter().sum();
        return Some(format!(
            "{} {} others (two cells on one side of a shared face) and {} drawn twice as dense there; the first is cell {}, \
             about [{}, {}, {}]. Leave out what is there twice, such as ghost cells of pieces",
            counted(cells.len(), "cell"),
            agreeing(&cells.len(), "overlaps", "overlap"),
            agreeing(&cells.len(), "is", "are"),
            cell(first),
            middle.x,
            middle.y,
            middle.z
        ));
    }
    let within = within(points, tetrahedra, &found.boundary);
    let (place, [own, other]) = within.first?;
    Some(format!(
        "cells overlap others that they share no face with and are drawn twice as dense there: of {} places on the grid's \
         boundary {} lie in another cell; the first is [{}, {}, {}], of cell {} and within cell {}. Leave out what is there twice, such as parts of overset grids",
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
    let points = (0..count).into_par_iter().map(|i| {
        source.weights_of_added(i, |weights| weights.map(|(p, w)| parts.points[p as usize] * w).sum())
    });
    let points: Vec<glam::DVec3> = all_or_first(points)?;
    parts.points.make_mut().extend_from_slice(&points);
    let interpolate = |values: &mut SharedSlice<f64>, component_count: usize| -> Result<()> {
        let n = component_count.max(1);
        let mut added = vec![0.0; count * n];
        all_or_first(added.par_chunks_exact_mut(n).enumerate().map(|(i, tuple)| {
            source.weights_of_added(i, |weights| {
                for (p, w) in weights {
                    tuple.iter_mut().zip(&values[p as usize * n..]).for_each(|(sum, v)| *sum += w * v);
                }
            })
        }))?;
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

/// Limits that everything after relies on.
fn check(parts: &RawGrid, options: &Options) -> Result<()> {
    if !(1..=64).contains(&options.subdivision) {
        return Err(Error::usage("the subdivision of curved cells is out of range")
            .got(options.subdivision)
            .expected("a whole number from 1 to 64")
            .at_item("subdivision"));
    }
    parts.check_lengths()
}

/// The error where no tetrahedron is left.
fn nothing_to_draw(tally: &CellCounts, left_out: &[String]) -> Error {
    let mut found = describe_counts(&tally.by_type);
    let ghosts = tally.ghost + tally.without_owner;
    for (count, why) in
        [(ghosts, &*format!("{} or hidden", noun_of(&ghosts, "ghost"))), (tally.not_finite, "not finite")]
    {
        if count > 0 {
            found.push_str(&format!(" ({count} {why})"));
        }
    }
    for warning in left_out {
        found.push_str(&format!(" ({})", warning.trim_end_matches('.')));
    }
    if let Some((&first, _)) = tally.unsupported.iter().next()
        && let Some(cell_type) = CellType::from_code(first)
    {
        found.push_str(&format!(" (a {} cannot be split)", cell_type.name));
    }
    Error::run("there is nothing to draw").got(found).expected("at least one three-dimensional cell")
}

/// Cells that one task handles: large enough to hide a task's cost, small enough to share out evenly.
const CELL_CHUNK: usize = 8192;

/// Counts of the cells' types and fates, and the tetrahedra of every chunk.
#[derive(Default)]
struct CellCounts {
    pub by_type: BTreeMap<u8, u64>,
    pub unsupported: BTreeMap<u8, u64>,
    pub ghost: u64,
    /// Ghosts that no piece draws.
    without_owner: u64,
    /// Ghosts that another part of the grid draws.
    neighbours: u64,
    drawn: u64,
    not_volume: u64,
    pub not_finite: u64,
    chunk_tetrahedra: Vec<usize>,
}

impl CellCounts {
    pub fn tetrahedra(&self) -> usize {
        self.chunk_tetrahedra.iter().sum()
    }

    fn add(&mut self, other: CellCounts) {
        for (mine, theirs) in [(&mut self.by_type, other.by_type), (&mut self.unsupported, other.unsupported)]
        {
            for (code, count) in theirs {
                *mine.entry(code).or_default() += count;
            }
        }
        self.ghost += other.ghost;
        self.without_owner += other.without_owner;
        self.neighbours += other.neighbours;
        self.drawn += other.drawn;
        self.not_volume += other.not_volume;
        self.not_finite += other.not_finite;
        self.chunk_tetrahedra.extend(other.chunk_tetrahedra);
    }
}

/// Ranges of cells, one a task.
fn chunks(count: usize) -> impl IndexedParallelIterator<Item = std::ops::Range<usize>> {
    (0..count.div_ceil(CELL_CHUNK))
        .into_par_iter()
        .map(move |c| c * CELL_CHUNK..((c + 1) * CELL_CHUNK).min(count))
}

/// Goes over all cells once: checks them, counts fates and tetrahedra.
fn tally(source: &Source, progress: &dyn Progress) -> Result<CellCounts> {
    let count = source.cells.count();
    let parts = chunks(count).map(|range| {
        progress.check_cancelled()?;
        let mut tally = CellCounts::default();
        let mut by_type = [0_u64; 256];
        let mut tetrahedra = 0;
        let mut buffer = [0; 8];
        for number in range {
            let cell = source.cell(number, &mut buffer)?;
            let fate = source.fate(&cell)?;
            if source.is_neighbour(number) {
                if fate == CellStatus::Drawn {
                    tally.neighbours += 1;
                    source.tetrahedra(&cell, &mut |_| tetrahedra += 1);
                }
                continue;
            }
            by_type[usize::from(cell.code)] += 1;
            match fate {
                CellStatus::Drawn => {
                    let is_ghost = source.ghost.is_some_and(|flags| is_ghost(flags[number]));
                    *(if is_ghost { &mut tally.without_owner } else { &mut tally.drawn }) += 1;
                    source.tetrahedra(&cell, &mut |_| tetrahedra += 1);
                }
                CellStatus::Ghost => tally.ghost += 1,
                CellStatus::NotVolume => tally.not_volume += 1,
                CellStatus::NotFinite => tally.not_finite += 1,
                // The warnings count them.
                CellStatus::NotSplit => {}
                CellStatus::Unsupported => *tally.unsupported.entry(cell.code).or_default() += 1,
            }
        }
        tally.by_type = (0..=255).zip(by_type).filter(|&(_, count)| count > 0).collect();
        tally.chunk_tetrahedra.push(tetrahedra);
        Ok(tally)
    });
    let mut sum = CellCounts::default();
    all_or_first(parts)?.into_iter().for_each(|part| sum.add(part));
    Ok(sum)
}

/// Counts tetrahedra none of which is left out: only the point numbers are checked.
fn tally_plain(source: &Source) -> Result<CellCounts> {
    let Cells::Tetrahedra(tetrahedra) = source.cells else { return Ok(CellCounts::default()) };
    let point_count = source.point_count;
    let wrong =
        tetrahedra.par_iter().with_min_len(CELL_CHUNK).any(|t| t.iter().any(|&p| p as usize >= point_count));
    if wrong {
        // The first of them, in a slow pass that makes the message.
        return tally(source, &crate::progress::NoProgress);
    }
    let with =
        |is: fn(u8) -> bool| source.ghost.map_or(0, |all| all.iter().filter(|&&own| is(own)).count() as u64);
    let (ghosts, neighbours) = (with(is_ghost), with(is_neighbour));
    let own = tetrahedra.len() as u64 - neighbours;
    Ok(CellCounts {
        by_type: [(code::TETRA, own)].into_iter().filter(|(_, count)| *count > 0).collect(),
        chunk_tetrahedra: vec![tetrahedra.len()],
        without_owner: ghosts - neighbours,
        neighbours,
        drawn: tetrahedra.len() as u64 - ghosts,
        ..CellCounts::default()
    })
}

/// Goes over all cells again and writes the tetrahedra where the counts have made room for them.
fn split_all(
    source: &Source,
    tally: &CellCounts,
    progress: &dyn Progress,
) -> Result<(Vec<[u32; 4]>, Vec<u32>)> {
    let total = tally.tetrahedra();
    let mut tetrahedra = vec![[0_u32; 4]; total];
    let mut source_cells = vec![0_u32; total];
    let lengths = || tally.chunk_tetrahedra.iter().copied();
    let slots = split_lengths(&mut tetrahedra, lengths()).into_iter();
    let slots: Vec<_> = slots.zip(split_lengths(&mut source_cells, lengths())).collect();
    all_or_first(chunks(source.cells.count()).zip(slots).map(|(range, (tetrahedra, cells))| {
        progress.check_cancelled()?;
        let mut buffer = [0; 8];
        let mut at = 0;
        for number in range {
            let cell = source.cell(number, &mut buffer)?;
            if source.fate(&cell)? == CellStatus::Drawn {
                source.tetrahedra(&cell, &mut |t| {
                    tetrahedra[at] = t;
                    cells[at] = number as u32;
                    at += 1;
                });
            }
        }
        Ok(())
    }))?;
    Ok((tetrahedra, source_cells))
}

/// Values that one task looks at.
const VALUE_CHUNK: usize = 1 << 15;

/// Marks the points (with their positions) or cells with values that are not finite; `None` where all are finite.
fn not_finite(parts: &RawGrid, association: Association) -> Option<Vec<bool>> {
    let (count, arrays) = match association {
        Association::Point => (parts.points.len(), &parts.point_arrays),
        Association::Cell => (parts.cells.count(), &parts.cell_arrays),
    };
    // Marks are only allocated once there is something to mark.
    let mut marks: Option<Vec<bool>> = None;
    let mut mark = |is_bad: &(dyn Fn(usize) -> bool + Sync)| {
        let marks = marks.get_or_insert_with(|| vec![false; count]);
        marks.par_iter_mut().with_min_len(VALUE_CHUNK).enumerate().for_each(|(i, mark)| *mark |= is_bad(i));
    };
    let points = &parts.points;
    if association == Association::Point
        && !points.par_iter().with_min_len(VALUE_CHUNK).all(|p| p.is_finite())
    {
        mark(&|i| !points[i].is_finite());
    }
    let scalar = parts.scalar.iter().filter(|scalar| scalar.association == association);
    let arrays = arrays.values().map(|array| (&array.values, array.component_count.max(1)));
    for (values, n) in scalar.map(|scalar| (&scalar.values, 1)).chain(arrays) {
        if !values.par_iter().with_min_len(VALUE_CHUNK).all(|v| v.is_finite()) {
            mark(&|i| !values[i * n..(i + 1) * n].iter().all(|v| v.is_finite()));
        }
    }
    marks
}

/// For each point true if a tetrahedron uses it.
fn used_points(point_count: usize, tetrahedra: impl ParallelIterator<Item = [u32; 4]>) -> Vec<bool> {
    let used: Vec<AtomicBool> = (0..point_count).map(|_| AtomicBool::new(false)).collect();
    tetrahedra.for_each(|t| {
        for p in t {
            // Looking first keeps cache lines shared between cores that meet at the same points.
            if !used[p as usize].load(Ordering::Relaxed) {
                used[p as usize].store(true, Ordering::Relaxed);
            }
        }
    });
    used.into_iter().map(AtomicBool::into_inner).collect()
}

/// Drops the points that no tetrahedron uses, with their values; keeps the order of the others, so that ascending
/// point numbers stay ascending. Gives each point's new number, [`UNUSED`] for those that are dropped; `None` where all stay.
fn drop_unused_points(
    parts: &mut RawGrid,
    tetrahedra: &mut SharedSlice<[u32; 4]>,
) -> Result<Option<Vec<u32>>> {
    let point_count = parts.points.len();
    let used = used_points(point_count, tetrahedra.par_iter().with_min_len(VALUE_CHUNK).copied());
    let used_count = used.iter().filter(|&&u| u).count();
    if used_count == point_count {
        return Ok(None);
    }
    let mut new_number = vec![0_u32; point_count];
    let mut next = 0_u32;
    for (slot, &used) in new_number.iter_mut().zip(&used) {
        *slot = if used { next } else { UNUSED };
        next += u32::from(used);
    }
    // Points that are dropped behind all others change no number.
    if !used[..used_count].iter().all(|&used| used) {
        let renumber = |t: &mut [u32; 4]| t.iter_mut().for_each(|p| *p = new_number[*p as usize]);
        tetrahedra.make_mut().par_iter_mut().with_min_len(VALUE_CHUNK).for_each(renumber);
    }
    keep(&mut parts.points, 1, &used);
    if let Some(scalar) = &mut parts.scalar {
        if scalar.association != Association::Point || scalar.values.len() != point_count {
            return Err(Error::run("a scalar does not sit on the points").at_item(&scalar.name));
        }
        keep(&mut scalar.values, 1, &used);
    }
    for Array { component_count, values } in parts.point_arrays.values_mut() {
        keep(values, *component_count, &used);
    }
    Ok(Some(new_number))
}

/// Keeps the tuples that are used, in place.
fn keep<T: Copy>(values: &mut SharedSlice<T>, component_count: usize, used: &[bool]) {
    let values = values.make_mut();
    let n = component_count.max(1);
    let mut at = 0;
    for (i, _) in used.iter().enumerate().filter(|&(_, &used)| used) {
        values.copy_within(i * n..(i + 1) * n, at);
        at += n;
    }
    values.truncate(at);
    values.shrink_to_fit();
}
