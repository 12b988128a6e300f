//! Two passes over all cells, in parallel: one that checks and counts, one that writes the tetrahedra.

use super::ImportStats;
use super::cell_types::{code, describe_counts};
use super::parts::Cells;
use super::source::{CellStatus, Source};
use crate::progress::Progress;
use crate::{Error, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Cells that one task handles: large enough to hide a task's cost, small enough to share out evenly.
const CHUNK: usize = 8192;

/// Counts of the cells' types and fates, and the tetrahedra of every chunk.
#[derive(Default)]
pub(super) struct CellCounts {
    pub by_type: BTreeMap<u8, u64>,
    pub unsupported: BTreeMap<u8, u64>,
    pub ghost: u64,
    not_volume: u64,
    pub not_finite: u64,
    chunk_tetrahedra: Vec<usize>,
}

impl CellCounts {
    pub fn tetrahedra(&self) -> usize {
        self.chunk_tetrahedra.iter().sum()
    }

    pub fn origin(&self) -> ImportStats {
        ImportStats {
            cells_by_type: self.by_type.clone(),
            cells_not_finite: self.not_finite,
            cells_ghost: self.ghost,
            cells_not_volume: self.not_volume,
            ..ImportStats::default()
        }
    }

    pub fn warn(&self, warnings: &mut Vec<String>) {
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

    fn add(&mut self, other: CellCounts) {
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
pub(super) fn tally(source: &Source, progress: &dyn Progress) -> Result<CellCounts> {
    let count = source.cells.count();
    let parts: Vec<Result<CellCounts>> = chunks(count)
        .map(|range| {
            if progress.cancelled() {
                return Err(Error::cancelled());
            }
            let mut tally = CellCounts::default();
            let mut by_type = [0_u64; 256];
            let mut tetrahedra = 0;
            let mut buffer = [0; 8];
            for number in range {
                let cell = source.cell(number, &mut buffer)?;
                by_type[usize::from(cell.code)] += 1;
                match source.fate(&cell)? {
                    CellStatus::Drawn => source.tetrahedra(&cell, &mut |_| tetrahedra += 1),
                    CellStatus::Ghost => tally.ghost += 1,
                    CellStatus::NotVolume => tally.not_volume += 1,
                    CellStatus::NotFinite => tally.not_finite += 1,
                    CellStatus::Unsupported => *tally.unsupported.entry(cell.code).or_default() += 1,
                }
            }
            tally.by_type = (0..=255).zip(by_type).filter(|&(_, count)| count > 0).collect();
            tally.chunk_tetrahedra.push(tetrahedra);
            Ok(tally)
        })
        .collect();
    let mut sum = CellCounts::default();
    for part in parts {
        sum.add(part?);
    }
    Ok(sum)
}

/// Counts tetrahedra all of which are drawn: only the point numbers are checked.
pub(super) fn tally_plain(source: &Source) -> Result<CellCounts> {
    let Cells::Tetrahedra(tetrahedra) = source.cells else { return Ok(CellCounts::default()) };
    let point_count = source.point_count;
    let wrong =
        tetrahedra.par_iter().with_min_len(CHUNK).any(|t| t.iter().any(|&p| p as usize >= point_count));
    if wrong {
        // The first of them, in a slow pass that makes the message.
        return tally(source, &crate::progress::NoProgress);
    }
    let mut by_type = BTreeMap::new();
    if !tetrahedra.is_empty() {
        by_type.insert(code::TETRA, tetrahedra.len() as u64);
    }
    Ok(CellCounts { by_type, chunk_tetrahedra: vec![tetrahedra.len()], ..CellCounts::default() })
}

/// Goes over all cells again and writes the tetrahedra where the counts have made room for them.
pub(super) fn split_all(
    source: &Source,
    tally: &CellCounts,
    progress: &dyn Progress,
) -> Result<(Vec<[u32; 4]>, Vec<u32>)> {
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
            if source.fate(&cell)? == CellStatus::Drawn {
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
