//! From a file's parts to a grid of tetrahedra.

use super::cell_types::{CellType, code, describe_counts};
use super::parts::{Association, CellValues, Cells, Options, Parts};
use super::source::{Fate, Source};
use super::{Grid, Origin, cell_values, clean};
use crate::progress::Progress;
use crate::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Cells that one task handles: large enough to hide a task's cost, small enough to share out evenly.
const CHUNK: usize = 8192;

/// Builds a grid of tetrahedra from what a reader hands over.
///
/// Cells of fewer dimensions, ghosts, and cells that touch a position or value that is not finite are left out and
/// counted in [`Grid::origin`]. Points that no tetrahedron uses are dropped, so the grid's point numbers are not
/// the file's where there are such; their order is kept.
pub fn build(mut parts: Parts, options: &Options, progress: &dyn Progress) -> Result<Grid> {
    check(&parts, options)?;
    progress.report("tetrahedra", 0.0);
    let point_not_finite = clean::points_not_finite(&parts);
    let cell_not_finite = clean::cells_not_finite(&parts);
    let mut cells = std::mem::replace(&mut parts.cells, Cells::Tetrahedra(Vec::new()));
    let ghost = parts.ghost.take();
    let source = Source {
        cells: &cells,
        point_count: parts.points.len(),
        ghost: ghost.as_deref(),
        point_not_finite,
        cell_not_finite,
    };
    let plain = matches!(source.cells, Cells::Tetrahedra(_))
        && source.ghost.is_none()
        && source.point_not_finite.is_none()
        && source.cell_not_finite.is_none();
    let tally = if plain { tally_plain(&source)? } else { tally(&source, progress)? };

    let mut origin = tally.origin();
    origin.arrays_unread = std::mem::take(&mut parts.arrays_unread);
    origin.warnings = std::mem::take(&mut parts.warnings);
    tally.warn(&mut origin.warnings);
    if tally.tetrahedra() == 0 {
        return Err(nothing_to_draw(&tally));
    }
    if u32::try_from(tally.tetrahedra()).is_err() {
        return Err(Error::run("the grid has too many tetrahedra")
            .found(tally.tetrahedra())
            .accepted(format!("at most {}", u32::MAX)));
    }
    let (mut tetrahedra, source_cells) = if plain {
        let Cells::Tetrahedra(own) = &mut cells else { unreachable!("a plain grid holds tetrahedra") };
        (std::mem::take(own), None)
    } else {
        let (t, s) = split_all(&source, &tally, progress)?;
        (t, Some(s))
    };
    drop(cells);
    tetrahedra.par_iter_mut().with_min_len(CHUNK).for_each(|t| t.sort_unstable());
    progress.report("tetrahedra", 0.8);

    let cell_values = cell_values::take(&mut parts);
    clean::drop_unused_points(&mut parts, &mut tetrahedra)?;
    let mut grid = Grid {
        points: Arc::new(parts.points),
        tetrahedra: Arc::new(tetrahedra),
        source_cells: source_cells.map(Arc::new),
        scalar: None,
        scalar_name: String::new(),
        point_arrays: parts.point_arrays.into_iter().map(|(name, a)| (name, Arc::new(a))).collect(),
        origin: Arc::new(origin),
    };
    if let Some(scalar) = parts.scalar {
        grid.scalar_name = scalar.name;
        grid.scalar = Some(Arc::new(scalar.values));
    }
    match options.cell_values {
        CellValues::Average => cell_values::average(&mut grid, cell_values),
        CellValues::Constant => cell_values::keep_constant(&mut grid, cell_values)?,
    }
    progress.report("tetrahedra", 1.0);
    Ok(grid)
}

/// Lengths and limits that everything after relies on.
fn check(parts: &Parts, options: &Options) -> Result<()> {
    if !(1..=64).contains(&options.subdivision) {
        return Err(Error::usage("the subdivision of curved cells is out of range")
            .found(options.subdivision)
            .accepted("a whole number from 1 to 64")
            .at_item("subdivision"));
    }
    let point_count = parts.points.len();
    if u32::try_from(point_count).is_err() {
        return Err(Error::run("the grid has too many points")
            .found(point_count)
            .accepted(format!("at most {}", u32::MAX)));
    }
    let cell_count = parts.cells.count();
    if u32::try_from(cell_count).is_err() {
        return Err(Error::run("the grid has too many cells")
            .found(cell_count)
            .accepted(format!("at most {}", u32::MAX)));
    }
    match &parts.cells {
        Cells::Structured(n) => {
            let product = n.iter().fold(1usize, |product, &n| product.saturating_mul(n));
            if product != point_count {
                return Err(Error::run("a structured grid has the wrong number of points")
                    .found(point_count)
                    .accepted(format!("{} × {} × {}", n[0], n[1], n[2])));
            }
        }
        Cells::Mixed(cells) if cells.offsets.len() != cell_count + 1 => {
            return Err(Error::run("the cells have the wrong number of offsets")
                .found(cells.offsets.len())
                .accepted(cell_count + 1));
        }
        _ => {}
    }
    let expect = |name: &str, found: usize, accepted: usize| {
        if found == accepted {
            return Ok(());
        }
        Err(Error::run("an array has the wrong number of values")
            .found(found)
            .accepted(accepted)
            .at_item(name))
    };
    let count_of = |association| if association == Association::Point { point_count } else { cell_count };
    if let Some(scalar) = &parts.scalar {
        expect(&scalar.name, scalar.values.len(), count_of(scalar.association))?;
    }
    for (arrays, association) in
        [(&parts.point_arrays, Association::Point), (&parts.cell_arrays, Association::Cell)]
    {
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

/// Counts of the cells' types and fates, and the tetrahedra of every chunk.
#[derive(Default)]
struct Tally {
    by_type: BTreeMap<u8, u64>,
    unsupported: BTreeMap<u8, u64>,
    ghost: u64,
    not_volume: u64,
    not_finite: u64,
    chunk_tetrahedra: Vec<usize>,
}

impl Tally {
    fn tetrahedra(&self) -> usize {
        self.chunk_tetrahedra.iter().sum()
    }

    fn origin(&self) -> Origin {
        Origin {
            cells_by_type: self.by_type.clone(),
            cells_not_finite: self.not_finite,
            cells_ghost: self.ghost,
            cells_not_volume: self.not_volume,
            ..Origin::default()
        }
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        if self.not_finite > 0 {
            warnings.push(format!(
                "{} three-dimensional cells were left out because a position or value is not finite.",
                self.not_finite
            ));
        }
        if !self.unsupported.is_empty() {
            warnings.push(format!(
                "{} were left out: cells of this type cannot be split into tetrahedra.",
                describe_counts(&self.unsupported)
            ));
        }
    }

    fn add(&mut self, other: Tally) {
        for (mine, theirs) in [(&mut self.by_type, other.by_type), (&mut self.unsupported, other.unsupported)]
        {
            for (code, count) in theirs {
                *mine.entry(code).or_default() += count;
            }
        }
        self.ghost += other.ghost;
        self.not_volume += other.not_volume;
        self.not_finite += other.not_finite;
        self.chunk_tetrahedra.extend(other.chunk_tetrahedra);
    }
}

/// Ranges of cells, one a task.
fn chunks(count: usize) -> impl IndexedParallelIterator<Item = std::ops::Range<usize>> {
    (0..count.div_ceil(CHUNK)).into_par_iter().map(move |c| c * CHUNK..((c + 1) * CHUNK).min(count))
}

/// Goes over all cells once: checks them, counts fates and tetrahedra.
fn tally(source: &Source, progress: &dyn Progress) -> Result<Tally> {
    let count = source.cells.count();
    let parts: Vec<Result<Tally>> = chunks(count)
        .map(|range| {
            if progress.cancelled() {
                return Err(Error::cancelled());
            }
            let mut tally = Tally::default();
            let mut by_type = [0_u64; 256];
            let mut tetrahedra = 0;
            let mut buffer = [0; 8];
            for number in range {
                let cell = source.cell(number, &mut buffer)?;
                by_type[usize::from(cell.code)] += 1;
                match source.fate(&cell)? {
                    Fate::Drawn => source.tetrahedra(&cell, &mut |_| tetrahedra += 1),
                    Fate::Ghost => tally.ghost += 1,
                    Fate::NotVolume => tally.not_volume += 1,
                    Fate::NotFinite => tally.not_finite += 1,
                    Fate::Unsupported => *tally.unsupported.entry(cell.code).or_default() += 1,
                }
            }
            tally.by_type = (0..=255).zip(by_type).filter(|&(_, count)| count > 0).collect();
            tally.chunk_tetrahedra.push(tetrahedra);
            Ok(tally)
        })
        .collect();
    let mut sum = Tally::default();
    for part in parts {
        sum.add(part?);
    }
    Ok(sum)
}

/// The same for tetrahedra all of which are drawn: only the point numbers are checked.
fn tally_plain(source: &Source) -> Result<Tally> {
    let Cells::Tetrahedra(tetrahedra) = source.cells else { return Ok(Tally::default()) };
    let point_count = source.point_count;
    let wrong =
        tetrahedra.par_iter().with_min_len(CHUNK).any(|t| t.iter().any(|&p| p as usize >= point_count));
    if wrong {
        // The first of them, in a slow pass that makes the message.
        return tally(source, &crate::progress::Silent);
    }
    let mut by_type = BTreeMap::new();
    if !tetrahedra.is_empty() {
        by_type.insert(code::TETRA, tetrahedra.len() as u64);
    }
    Ok(Tally { by_type, chunk_tetrahedra: vec![tetrahedra.len()], ..Tally::default() })
}

/// Goes over all cells again and writes the tetrahedra where the counts have made room for them.
fn split_all(source: &Source, tally: &Tally, progress: &dyn Progress) -> Result<(Vec<[u32; 4]>, Vec<u32>)> {
    let total = tally.tetrahedra();
    let mut tetrahedra = vec![[0_u32; 4]; total];
    let mut source_cells = vec![0_u32; total];
    let mut slots = Vec::with_capacity(tally.chunk_tetrahedra.len());
    let (mut rest, mut rest_cells) = (&mut tetrahedra[..], &mut source_cells[..]);
    for &n in &tally.chunk_tetrahedra {
        let (head, tail) = rest.split_at_mut(n);
        let (head_cells, tail_cells) = rest_cells.split_at_mut(n);
        slots.push((head, head_cells));
        (rest, rest_cells) = (tail, tail_cells);
    }
    chunks(source.cells.count()).zip(slots).try_for_each(|(range, (tetrahedra, cells))| {
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        let mut buffer = [0; 8];
        let mut at = 0;
        for number in range {
            let cell = source.cell(number, &mut buffer)?;
            if source.fate(&cell)? == Fate::Drawn {
                source.tetrahedra(&cell, &mut |t| {
                    tetrahedra[at] = t;
                    cells[at] = number as u32;
                    at += 1;
                });
            }
        }
        Ok(())
    })?;
    Ok((tetrahedra, source_cells))
}

/// The error where no tetrahedron is left.
fn nothing_to_draw(tally: &Tally) -> Error {
    let mut found = describe_counts(&tally.by_type);
    for (count, why) in [(tally.ghost, "ghosts"), (tally.not_finite, "not finite")] {
        if count > 0 {
            found.push_str(&format!(" ({count} {why})"));
        }
    }
    if let Some((&first, _)) = tally.unsupported.iter().next()
        && let Some(cell_type) = CellType::of(first)
    {
        found.push_str(&format!(" (a {} cannot be split)", cell_type.name));
    }
    Error::run("there is nothing to draw").found(found).accepted("at least one three-dimensional cell")
}
