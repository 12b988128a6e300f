//! Query of cells and blocks against the widgets' supports.

use super::blocks::{BLOCK, Block};
use crate::attribute::Attribute;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::transfer::{Support, TransferFunction};

/// Cells for each sampled cell: a prime, so that rows of 2ⁿ cells are sampled at all their positions.
pub(super) const SAMPLE_STRIDE: usize = 61;

/// Query of cells and blocks against the widgets' supports.
pub(super) struct CullQuery<'a> {
    /// The widgets' supports.
    pub support: &'a Support,
    /// Optical depth of a cell at least, per world unit, to be selected.
    pub min_density: f64,
    pub tetrahedra: &'a [[u32; 4]],
    pub values: CornerValues<'a>,
    /// The blocks, computed when they are first read.
    pub blocks: &'a (dyn Fn() -> Arc<Vec<Block>> + Sync),
    /// Ranges of s and g over the grid.
    pub ranges: [[f64; 2]; 2],
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
        let values = self.values.of(&self.tetrahedra[id]);
        self.support.first_overlapping_widget(first, &values.s, &values.g, values.fields(), self.min_density)
    }

    /// True if a widget's support meets a cell.
    pub fn meets(&self, widget: usize, id: u32) -> bool {
        let values = self.values.of(&self.tetrahedra[id as usize]);
        self.support.widget_touches(widget, &values.s, &values.g, values.fields(), self.min_density)
    }

    /// Class of a block.
    pub fn classify(&self, block: &Block) -> BlockClass {
        let [s, g] = self.ranges_read(block.ranges);
        let (corners_s, corners_g) = corners(s, g);
        if self.support.first_overlapping_widget(0, &corners_s, &corners_g, &[], self.min_density).is_none() {
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
        let (corners_s, corners_g) = corners(s, g);
        self.support.widget_touches(widget, &corners_s, &corners_g, &[], self.min_density)
    }

    /// Ranges of values: where no widget reads g it counts as 0, as it does of cells.
    fn ranges_read(&self, [s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        [s, if self.values.g.is_some() { g } else { [0.0; 2] }]
    }
}

/// Corners of a box of s and g.
fn corners(s: [f64; 2], g: [f64; 2]) -> ([f64; 4], [f64; 4]) {
    ([s[0], s[1], s[0], s[1]], [g[0], g[0], g[1], g[1]])
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

/// Values at the corners of one cell.
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
    fn fields(&self) -> &[[f64; 4]] {
        &self.fields[..self.field_count]
    }
}
