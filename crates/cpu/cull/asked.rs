//! Cells and blocks held against the widgets' bounds.

use super::blocks::{BLOCK, Block};
use crate::attribute::Attribute;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::transfer::{Support, TransferFunction};

/// One cell of so many tells: a prime, so that rows of 2ⁿ cells are met at all their places.
pub(super) const SAMPLED: usize = 61;

/// What cells are held against.
pub(super) struct Asked<'a> {
    /// The widgets' bounds.
    pub support: &'a Support,
    /// What a cell adds at least, per world unit, to be kept.
    pub least: f64,
    pub tetrahedra: &'a [[u32; 4]],
    pub values: CornerValues<'a>,
    /// The blocks, made when they are first asked for.
    pub blocks: &'a (dyn Fn() -> Arc<Vec<Block>> + Sync),
    /// Ranges of s and g over the grid.
    pub ranges: [[f64; 2]; 2],
}

/// How a block's cells stand to the widgets.
pub(super) enum Verdict {
    /// None is touched.
    Nowhere,
    /// A widget touches all of them.
    Everywhere(usize),
    /// They have to be asked.
    Somewhere,
}

impl Asked<'_> {
    /// A widget that touches a cell; `first` is asked before the others.
    #[inline]
    pub fn toucher(&self, id: usize, first: usize) -> Option<usize> {
        let values = self.values.of(&self.tetrahedra[id]);
        self.support.toucher(first, &values.s, &values.g, values.fields(), self.least)
    }

    /// Whether one widget touches a cell.
    pub fn touches(&self, widget: usize, id: u32) -> bool {
        let values = self.values.of(&self.tetrahedra[id as usize]);
        self.support.widget_touches(widget, &values.s, &values.g, values.fields(), self.least)
    }

    /// What can be said of all cells of a block.
    pub fn verdict(&self, block: &Block) -> Verdict {
        let [s, g] = self.looked_at(block.ranges);
        let (corners_s, corners_g) = corners(s, g);
        if self.support.toucher(0, &corners_s, &corners_g, &[], self.least).is_none() {
            return Verdict::Nowhere;
        }
        self.support.cover(&[s, g], self.least).map_or(Verdict::Somewhere, Verdict::Everywhere)
    }

    /// One of the cells that a widget touches, if any.
    pub fn example(&self, widget: usize, ids: &[u32]) -> Option<u32> {
        if !self.may_touch(widget, self.ranges) {
            return None;
        }
        // Most often there are many: a sample tells, without the blocks.
        if let Some(&id) =
            ids.par_iter().step_by(SAMPLED).with_min_len(256).find_any(|&&id| self.touches(widget, id))
        {
            return Some(id);
        }
        let blocks = (self.blocks)();
        ids.par_chunks(1 << 14).find_map_any(|ids| {
            let (mut block, mut may_be) = (usize::MAX, false);
            let touched = |&id: &u32| {
                if block != id as usize / BLOCK {
                    block = id as usize / BLOCK;
                    may_be = self.may_touch(widget, blocks[block].ranges);
                }
                may_be && self.touches(widget, id)
            };
            ids.iter().copied().find(touched)
        })
    }

    /// Whether a widget may touch cells of values in a box.
    fn may_touch(&self, widget: usize, ranges: [[f64; 2]; 2]) -> bool {
        let [s, g] = self.looked_at(ranges);
        let (corners_s, corners_g) = corners(s, g);
        self.support.widget_touches(widget, &corners_s, &corners_g, &[], self.least)
    }

    /// Where no widget looks at g it counts as 0, as it does of cells.
    fn looked_at(&self, [s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        [s, if self.values.g.is_some() { g } else { [0.0; 2] }]
    }
}

/// The corners of a box of s and g.
fn corners(s: [f64; 2], g: [f64; 2]) -> ([f64; 4], [f64; 4]) {
    ([s[0], s[1], s[0], s[1]], [g[0], g[0], g[1], g[1]])
}

/// The point arrays that cells are held against.
pub(super) struct CornerValues<'a> {
    s: &'a [f64],
    /// Where a widget looks at it.
    pub g: Option<&'a [f64]>,
    fields: Vec<&'a [f64]>,
}

/// Most further fields that the culling test looks at; a scene with more keeps the cells that only those would cull.
const FIELDS_MOST: usize = 8;

/// Values at the corners of one cell.
struct CellValues {
    s: [f64; 4],
    g: [f64; 4],
    fields: [[f64; 4]; FIELDS_MOST],
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
        let mut fields = [[0.0; 4]; FIELDS_MOST];
        let field_count = if self.fields.len() <= FIELDS_MOST { self.fields.len() } else { 0 };
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
