//! The cells that the widgets of a transfer function touch, wherever they are seen from.

use super::asked::{Asked, Verdict};
use super::blocks::{BLOCK, BLOCKS_AT_ONCE};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use voltet_core::transfer::Support;

/// Grids of fewer cells are asked as a whole.
pub(super) const CELLS_TO_SAMPLE: usize = 1 << 15;

/// One run of so many consecutive cells is asked of each stretch of [`STRETCH`]: 1 cell in 64.
const RUN: usize = 16;

/// See [`RUN`].
const STRETCH: usize = 64 * RUN;

/// The share of the sample that must be dropped: asking a cell takes about a twentieth of the time that drawing one does.
pub(super) const WORTH: f64 = 0.05;

/// A sample of a grid's cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sample {
    /// Cells that were asked.
    pub asked: u64,
    /// Those of them that no widget touches.
    pub dropped: u64,
}

/// What is touched.
#[derive(Debug)]
pub(super) struct Touched {
    /// What decided: the bounds, the fields that they number, and whether they look at g.
    support: Support,
    fields: Vec<String>,
    with_g: bool,
    /// The cells, ascending.
    pub cells: Arc<Vec<u32>>,
    /// A cell that each widget touches, if any.
    pub examples: Vec<Option<u32>>,
    /// The sample for which every cell is kept unasked, since it drops too few.
    pub not_worth_asking: Option<Sample>,
}

/// No cell.
const NONE: u32 = u32::MAX;

impl Touched {
    /// Whether it is what would be found now.
    pub fn is_of(&self, asked: &Asked, fields: &[&str]) -> bool {
        self.with_g == asked.values.g.is_some() && self.fields == fields && self.support == *asked.support
    }

    /// Asks the cells, unless a sample says that this would not pay; `each`: always.
    pub fn find(asked: &Asked, fields: &[&str], each: bool) -> Touched {
        let examples: Vec<AtomicU32> =
            (0..asked.support.widget_count()).map(|_| AtomicU32::new(NONE)).collect();
        let total = asked.tetrahedra.len();
        let sample = (total >= CELLS_TO_SAMPLE && !each).then(|| sample(asked, &examples));
        let not_worth_asking = sample.filter(|sample| (sample.dropped as f64) < WORTH * sample.asked as f64);
        let cells = match not_worth_asking {
            Some(_) => (0..total as u32).collect(),
            None => ask(asked, &examples),
        };
        let example = |(widget, example): (usize, AtomicU32)| match example.into_inner() {
            NONE => asked.example(widget, &cells),
            id => Some(id),
        };
        let examples = examples.into_iter().enumerate().map(example).collect();
        Touched {
            support: asked.support.clone(),
            fields: fields.iter().map(|field| field.to_string()).collect(),
            with_g: asked.values.g.is_some(),
            cells: Arc::new(cells),
            examples,
            not_worth_asking,
        }
    }
}

/// Asks one cell in 64.
fn sample(asked: &Asked, examples: &[AtomicU32]) -> Sample {
    let stretches = asked.tetrahedra.len() / STRETCH;
    let of = |stretch: usize| {
        // At a place of its own in each stretch (the golden ratio's multiples), lest rows of a grid are always met at the same.
        let place = (stretch as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        let first = stretch * STRETCH + (place as usize) % (STRETCH - RUN);
        let mut toucher = 0;
        let dropped = (first..first + RUN).filter(|&id| {
            let found = asked.toucher(id, toucher);
            found.inspect(|&widget| {
                toucher = widget;
                examples[widget].store(id as u32, Ordering::Relaxed);
            });
            found.is_none()
        });
        dropped.count() as u64
    };
    let dropped = (0..stretches).into_par_iter().with_min_len(16).map(of).sum();
    Sample { asked: (stretches * RUN) as u64, dropped }
}

/// The cells that are touched, ascending.
fn ask(asked: &Asked, examples: &[AtomicU32]) -> Vec<u32> {
    let total = asked.tetrahedra.len();
    let blocks = (asked.blocks)();
    let parts = blocks.par_chunks(BLOCKS_AT_ONCE).enumerate().map(|(part, blocks)| {
        let (mut touched, mut toucher) = (Vec::new(), 0);
        for (k, block) in blocks.iter().enumerate() {
            let first = (part * BLOCKS_AT_ONCE + k) * BLOCK;
            let cells = first..(first + BLOCK).min(total);
            match asked.verdict(block) {
                Verdict::Nowhere => {}
                Verdict::Everywhere(widget) => {
                    examples[widget].store(first as u32, Ordering::Relaxed);
                    touched.extend(cells.map(|id| id as u32));
                }
                Verdict::Somewhere => touched.extend(cells.filter_map(|id| {
                    toucher = asked.toucher(id, toucher)?;
                    examples[toucher].store(id as u32, Ordering::Relaxed);
                    Some(id as u32)
                })),
            }
        }
        touched
    });
    parts.collect::<Vec<_>>().concat()
}
