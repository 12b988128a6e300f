//! The file's own cells, by name.

use voltet_core::grid::{CellType, Grid};
use voltet_optics::trace::CellCrossing;

/// For each step the number of the file's cell, and what it is.
pub(super) fn source_cells(grid: &Grid, steps: &[CellCrossing]) -> Vec<(usize, String)> {
    steps.iter().map(|step| (grid.source_cell(step.cell as usize), kind(grid, step.cell as usize))).collect()
}

/// Type of the cell that a tetrahedron is a part of. A grid keeps its file's cells by number only: where these are of several
/// types, the number of points tells which this is, or leaves some to choose from.
fn kind(grid: &Grid, tetrahedron: usize) -> String {
    let types = grid.origin.cells_by_type.keys().filter_map(|&code| CellType::from_code(code));
    let solid: Vec<&CellType> = types.filter(|kind| kind.dimension == 3).collect();
    let fitting: Vec<&str> = match solid.as_slice() {
        [one] => vec![one.name],
        several => {
            let count = point_count(grid, tetrahedron);
            let fits = |kind: &&&CellType| kind.point_count.is_none_or(|n| usize::from(n) == count);
            several.iter().filter(fits).map(|kind| kind.name).collect()
        }
    };
    if fitting.is_empty() { "tetrahedron".into() } else { fitting.join(" or ") }
}

/// Points of the cell that a tetrahedron is a part of. Tetrahedra of one cell stand together.
fn point_count(grid: &Grid, tetrahedron: usize) -> usize {
    let cell = grid.source_cell(tetrahedron);
    let same = |&k: &usize| grid.source_cell(k) == cell;
    let before = (0..tetrahedron).rev().take_while(same);
    let parts = before.chain((tetrahedron..grid.tetrahedra.len()).take_while(same));
    let mut points: Vec<u32> = parts.flat_map(|k| grid.tetrahedra[k]).collect();
    points.sort_unstable();
    points.dedup();
    points.len()
}
