//! Contributing cells: those in the widgets' supports, whatever the view.

use super::blocks::{BLOCK, BLOCKS_AT_ONCE};
use super::query::{BlockClass, CullQuery};
use crate::selection::CullSample;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use voltet_core::transfer::Support;

/// Cells from which on a grid is sampled first; smaller ones are tested as a whole.
pub(super) const MIN_CELLS_TO_SAMPLE: usize = 1 << 15;

/// Consecutive cells that are tested in each interval of [`INTERVAL`]: 1 cell in 64.
const RUN: usize = 16;

/// See [`RUN`].
const INTERVAL: usize = 64 * RUN;

/// Fraction of the sample that must be dropped: testing a cell takes about a twentieth of the time that drawing one does.
pub(super) const MIN_CULLED_FRACTION: f64 = 0.05;

/// Cells in the widgets' supports.
#[derive(Debug)]
pub(super) struct ContributingCells {
    /// Key: the supports, the fields that they number, and true if they read g.
    support: Support,
    fields: Vec<String>,
    with_g: bool,
    /// The cells, ascending.
    pub cells: Arc<Vec<u32>>,
    /// A cell that meets each widget's support, if any.
    pub examples: Vec<Option<u32>>,
    /// Sample for which every cell is selected untested, since it drops too few.
    pub culling_skipped: Option<CullSample>,
}

/// No cell.
const NO_CELL: u32 = u32::MAX;

impl ContributingCells {
    /// True if the query would find the same.
    pub fn matches(&self, query: &CullQuery, fields: &[&str]) -> bool {
        self.with_g == query.values.g.is_some() && self.fields == fields && self.support == *query.support
    }

    /// Tests the cells, unless a sample shows that this would not pay; `exact`: always.
    pub fn find(query: &CullQuery, fields: &[&str], exact: bool) -> ContributingCells {
        let examples: Vec<AtomicU32> =
            (0..query.support.widget_count()).map(|_| AtomicU32::new(NO_CELL)).collect();
        let total = query.tetrahedra.len();
        let sample = (total >= MIN_CELLS_TO_SAMPLE && !exact).then(|| sample(query, &examples));
        let culling_skipped =
            sample.filter(|sample| (sample.dropped as f64) < MIN_CULLED_FRACTION * sample.tested as f64);
        let cells = match culling_skipped {
            Some(_) => (0..total as u32).collect(),
            None => test_all(query, &examples),
        };
        let example = |(widget, example): (usize, AtomicU32)| match example.into_inner() {
            NO_CELL => query.example(widget, &cells),
            id => Some(id),
        };
        let examples = examples.into_iter().enumerate().map(example).collect();
        ContributingCells {
            support: query.support.clone(),
            fields: fields.iter().map(|field| field.to_string()).collect(),
            with_g: query.values.g.is_some(),
            cells: Arc::new(cells),
            examples,
            culling_skipped,
        }
    }
}

/// Tests one cell in 64.
fn sample(query: &CullQuery, examples: &[AtomicU32]) -> CullSample {
    let intervals = query.tetrahedra.len() / INTERVAL;
    let of = |interval: usize| {
        // At another position in each interval (multiples of the golden ratio), lest rows of a grid are always sampled at the same.
        let position = (interval as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let first = interval * INTERVAL + (position as usize) % (INTERVAL - RUN);
        let mut widget = 0;
        let dropped = (first..first + RUN).filter(|&id| {
            let overlapping = query.first_overlapping_widget(id, widget);
            overlapping.inspect(|&overlapping| {
                widget = overlapping;
                examples[widget].store(id as u32, Ordering::Relaxed);
            });
            overlapping.is_none()
        });
        dropped.count() as u64
    };
    let dropped = (0..intervals).into_par_iter().with_min_len(16).map(of).sum();
    CullSample { tested: (intervals * RUN) as u64, dropped }
}

/// Cells that meet any support, ascending.
fn test_all(query: &CullQuery, examples: &[AtomicU32]) -> Vec<u32> {
    let total = query.tetrahedra.len();
    let blocks = (query.blocks)();
    let parts = blocks.par_chunks(BLOCKS_AT_ONCE).enumerate().map(|(part, blocks)| {
        let (mut contributing, mut widget) = (Vec::new(), 0);
        for (k, block) in blocks.iter().enumerate() {
            let first = (part * BLOCKS_AT_ONCE + k) * BLOCK;
            let cells = first..(first + BLOCK).min(total);
            match query.classify(block) {
                BlockClass::Outside => {}
                BlockClass::Inside(widget) => {
                    examples[widget].store(first as u32, Ordering::Relaxed);
                    contributing.extend(cells.map(|id| id as u32));
                }
                BlockClass::Straddling => contributing.extend(cells.filter_map(|id| {
                    widget = query.first_overlapping_widget(id, widget)?;
                    examples[widget].store(id as u32, Ordering::Relaxed);
                    Some(id as u32)
                })),
            }
        }
        contributing
    });
    parts.collect::<Vec<_>>().concat()
}
