//! Outline of a file, from its headers alone: arrays, blocks, time steps.

use super::contents::{DEGREES, Dataset, GHOST_LEVELS, GHOST_TYPE};
use super::inspect::array_heads;
use std::collections::BTreeSet;
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;

/// Contents of a file as its headers show them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// Arrays that can be asked for, each once, the points' first. Marks of ghosts and degrees of cells, which belong to the cells, are
    /// not among them.
    pub arrays: Vec<FileArray>,
    /// Names of those arrays whose numbers are whole in the file.
    pub whole_arrays: BTreeSet<String>,
    /// Names of all blocks.
    pub blocks: Vec<String>,
    /// Times of the steps of a series; empty where the file is none.
    pub time_steps: Vec<f64>,
    /// Further contents of the file: "2 node sets: 'inlet', 'outlet'".
    pub notes: Vec<String>,
}

pub(super) fn outline(dataset: &Dataset) -> Outline {
    let belongs_to_cells = |array: &FileArray| {
        [GHOST_TYPE, GHOST_LEVELS].contains(&array.name.as_str())
            || array.name == DEGREES && array.association == Association::Cell
    };
    let stored = dataset.pieces.iter().flat_map(|piece| &piece.arrays).map(|array| &array.stored);
    let whole = stored.filter(|stored| stored.number_type.is_integer());
    // Pieces of one grid are read with what all of them hold.
    let pieces = || dataset.pieces.iter().filter(|piece| piece.cell_count > 0 && piece.point_count > 0);
    let is_in_all = |head: &FileArray| {
        dataset.has_blocks
            || pieces().all(|piece| {
                piece
                    .arrays
                    .iter()
                    .any(|array| array.association == head.association && array.stored.name == head.name)
            })
    };
    let (arrays, partial): (Vec<FileArray>, Vec<FileArray>) =
        array_heads(dataset).into_iter().filter(|array| !belongs_to_cells(array)).partition(is_in_all);
    let partial = partial.iter().map(|array| format!("an array that not all pieces hold: '{}'", array.name));
    Outline {
        arrays,
        whole_arrays: whole.map(|stored| stored.name.clone()).collect(),
        blocks: dataset.blocks.clone(),
        time_steps: dataset.time_steps.clone(),
        notes: dataset.notes.iter().cloned().chain(partial).collect(),
    }
}
