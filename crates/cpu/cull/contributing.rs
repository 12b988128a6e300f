//! Contributing cells: those in the widgets' supports, whatever the view, found by blocks of consecutive cells, which are most often
//! neighbours in space, of values close together.

use crate::attribute::Attribute;
use crate::selection::CullSample;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use voltet_core::transfer::{AxisScale, Corners, Support, TransferFunction, box_corners};
use voltet_core::volume::Volume;

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
    axes: [AxisScale; 2],
    /// The cells, ascending.
    pub cells: Arc<Vec<u32>>,
    /// A cell that meets each widget's support, if any.
    pub examples: Vec<Option<u32>>,
    /// Sample for which every cell is selected untested, since it drops too few.
    pub culling_skipped: Option<CullSample>,
}

const NO_CELL: u32 = u32::MAX;

impl ContributingCells {
    /// True if the query would find the same.
    pub fn matches(&self, query: &CullQuery, fields: &[&str]) -> bool {
        self.axes == query.axes
            && self.with_g == query.values.g.is_some()
            && self.fields == fields
            && self.support == *query.support
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
            axes: query.axes,
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

/// Cells of a block.
pub(super) const BLOCK: usize = 32;

/// Blocks that one thread takes at a time: enough that handing them out costs nothing.
pub(super) const BLOCKS_AT_ONCE: usize = 256;

#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Minimum and maximum of s, and of g (0 where the volume has none).
    pub ranges: [[f64; 2]; 2],
}

impl Block {
    /// Blocks of a volume: block b has the cells from b times [`BLOCK`] on.
    pub fn every(volume: &Volume) -> Vec<Block> {
        let (s, g) = (volume.scalar.as_ref(), volume.gradient_magnitude.as_deref());
        let of =
            |cells: &[[u32; 4]]| Block { ranges: [range(s, cells), g.map_or([0.0; 2], |g| range(g, cells))] };
        let mut blocks = Vec::new();
        let tetrahedra = volume.grid.tetrahedra.par_chunks(BLOCK).with_min_len(BLOCKS_AT_ONCE);
        tetrahedra.map(of).collect_into_vec(&mut blocks);
        blocks
    }
}

fn range(values: &[f64], cells: &[[u32; 4]]) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for corners in cells {
        for &corner in corners {
            let value = values[corner as usize];
            (low, high) = (low.min(value), high.max(value));
        }
    }
    [low, high]
}

/// Cells for each sampled cell: a prime, so that rows of 2ⁿ cells are sampled at all their positions.
pub(super) const SAMPLE_STRIDE: usize = 61;

/// Query of cells and blocks against the widgets' supports.
pub(super) struct CullQuery<'a> {
    pub support: &'a Support,
    /// Optical depth of a cell at least, per world unit, to be selected.
    pub min_density: f64,
    pub tetrahedra: &'a [[u32; 4]],
    pub values: CornerValues<'a>,
    /// The blocks, computed when they are first read.
    pub blocks: &'a (dyn Fn() -> Arc<Vec<Block>> + Sync),
    /// Ranges of s and g over the grid.
    pub ranges: [[f64; 2]; 2],
    /// Scales of s and g.
    pub axes: [AxisScale; 2],
}

/// Class of a block's cells against the widgets' supports.
pub(super) enum BlockClass {
    /// No cell meets any.
    Outside,
    /// All cells meet that of a widget.
    Inside(usize),
    /// Cells have to be tested one by one.
    Straddling,
}

impl CullQuery<'_> {
    /// A widget whose support meets a cell; `first` is tested before the others.
    #[inline]
    pub fn first_overlapping_widget(&self, id: usize, first: usize) -> Option<usize> {
        let values = self.corner_values(id);
        self.support.first_overlapping_widget(first, &values.corners(), self.min_density)
    }

    /// True if a widget's support meets a cell.
    pub fn meets(&self, widget: usize, id: u32) -> bool {
        let values = self.corner_values(id as usize);
        self.support.widget_touches(widget, &values.corners(), self.min_density)
    }

    /// Values at the corners of a cell; along curved axes the corners of the box that holds its positions, whose hull is not that of its
    /// corners' positions.
    #[inline]
    fn corner_values(&self, id: usize) -> CellValues {
        let mut values = self.values.of(&self.tetrahedra[id]);
        if self.axes.iter().any(|axis| axis.is_curved()) {
            let read = values.corners();
            let [s, g] = self.positions([read.s_range().into(), read.g_range().into()]);
            (values.s, values.g) = box_corners(s, g);
        }
        values
    }

    fn positions(&self, ranges: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| self.axes[axis].positions(ranges[axis]))
    }

    pub fn classify(&self, block: &Block) -> BlockClass {
        let [s, g] = self.ranges_read(block.ranges);
        let (corners_s, corners_g) = box_corners(s, g);
        let corners = Corners { s: &corners_s, g: &corners_g, fields: &[] };
        if self.support.first_overlapping_widget(0, &corners, self.min_density).is_none() {
            return BlockClass::Outside;
        }
        self.support.cover(&[s, g], self.min_density).map_or(BlockClass::Straddling, BlockClass::Inside)
    }

    /// One of the cells that meet a widget's support, if any.
    pub fn example(&self, widget: usize, ids: &[u32]) -> Option<u32> {
        if !self.may_meet(widget, self.ranges) {
            return None;
        }
        // Most often there are many: a sample finds one, without the blocks.
        if let Some(&id) =
            ids.par_iter().step_by(SAMPLE_STRIDE).with_min_len(256).find_any(|&&id| self.meets(widget, id))
        {
            return Some(id);
        }
        let blocks = (self.blocks)();
        ids.par_chunks(1 << 14).find_map_any(|ids| {
            let (mut block, mut may_meet) = (usize::MAX, false);
            let meets = |&id: &u32| {
                if block != id as usize / BLOCK {
                    block = id as usize / BLOCK;
                    may_meet = self.may_meet(widget, blocks[block].ranges);
                }
                may_meet && self.meets(widget, id)
            };
            ids.iter().copied().find(meets)
        })
    }

    /// True if a widget's support may meet cells of values in a box.
    fn may_meet(&self, widget: usize, ranges: [[f64; 2]; 2]) -> bool {
        let [s, g] = self.ranges_read(ranges);
        let (corners_s, corners_g) = box_corners(s, g);
        let corners = Corners { s: &corners_s, g: &corners_g, fields: &[] };
        self.support.widget_touches(widget, &corners, self.min_density)
    }

    /// Ranges of values: where no widget reads g it counts as 0, as it does of cells.
    fn ranges_read(&self, [s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        self.positions([s, if self.values.g.is_some() { g } else { [0.0; 2] }])
    }
}

/// Point arrays that supports are tested on.
pub(super) struct CornerValues<'a> {
    s: &'a [f64],
    /// `None` where no widget reads it.
    pub g: Option<&'a [f64]>,
    fields: Vec<&'a [f64]>,
}

/// Further fields that the culling test reads at most; a scene with more selects the cells that only those would cull.
const MAX_FIELDS: usize = 8;

struct CellValues {
    s: [f64; 4],
    g: [f64; 4],
    fields: [[f64; 4]; MAX_FIELDS],
    field_count: usize,
}

impl<'a> CornerValues<'a> {
    /// `attributes`: those of the transfer function.
    pub fn new(attributes: &[Attribute<'a>], transfer_function: &TransferFunction) -> CornerValues<'a> {
        let g = attributes.get(1).filter(|_| transfer_function.uses_gradient_magnitude());
        CornerValues {
            s: attributes[0].values,
            g: g.map(|attribute| attribute.values),
            fields: attributes.iter().skip(2).map(|attribute| attribute.values).collect(),
        }
    }

    #[inline]
    fn of(&self, corners: &[u32; 4]) -> CellValues {
        let at = corners.map(|p| p as usize);
        let mut fields = [[0.0; 4]; MAX_FIELDS];
        let field_count = if self.fields.len() <= MAX_FIELDS { self.fields.len() } else { 0 };
        for (field, values) in fields.iter_mut().zip(&self.fields).take(field_count) {
            *field = at.map(|p| values[p]);
        }
        CellValues {
            s: at.map(|p| self.s[p]),
            g: self.g.map_or([0.0; 4], |g| at.map(|p| g[p])),
            fields,
            field_count,
        }
    }
}

impl CellValues {
    #[inline]
    fn corners(&self) -> Corners<'_> {
        Corners { s: &self.s, g: &self.g, fields: &self.fields[..self.field_count] }
    }
}
