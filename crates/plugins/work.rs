//! A call of a filter: all that it is given, and the call itself.

use crate::describe::Declared;
use crate::grids::{fresh, overran};
use crate::host::State;
use crate::interface::{self, Call, Check, Gradient as Function, Values};
use crate::outcome::{Beyond, Said};
use crate::values::{Owned, array_pointers, arrays};
use std::mem::size_of;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Csr, Grid, cells_of_points, points_of_points};
use voltet_core::parameters::Parameters;

/// Vectors behind the last, which nobody may write: those who miscount by a few are found.
pub(crate) const BEYOND: usize = 64;

/// What a filter is given: owned, or shared, so that a call that never ends harms nobody.
pub(crate) struct Given {
    /// Points and tetrahedra.
    pub grid: Grid,
    pub scalar: Vec<f64>,
    pub values: Owned,
    /// For each parameter the array that it names.
    pub arrays: Vec<Option<Arc<Array>>>,
}

/// Rows with starts of 64 bits.
pub(crate) struct Compressed {
    pub starts: Vec<u64>,
    pub items: Vec<u32>,
}

impl From<Csr> for Compressed {
    fn from(Csr { starts, items }: Csr) -> Compressed {
        // The same memory where both are of 64 bits.
        let widened = |(_, starts): (_, Vec<usize>)| starts.into_iter().map(|start| start as u64).collect();
        Compressed { starts: bytemuck::try_cast_vec(starts).unwrap_or_else(widened), items }
    }
}

impl Given {
    /// Errors: an array that is not there.
    pub fn new(declared: &Declared, grid: &Grid, scalar: &[f64], parameters: &Parameters) -> Result<Given> {
        Ok(Given {
            grid: grid.clone(),
            scalar: scalar.to_vec(),
            values: Owned::new(declared, parameters)?,
            arrays: arrays(declared, parameters, grid)?,
        })
    }

    /// The neighbours of points, and the cells of points, where they are needed.
    pub fn tables(&self, needs: u32) -> [Option<Compressed>; 2] {
        let (wants_neighbours, wants_cells) =
            (needs & interface::NEEDS_NEIGHBOURS != 0, needs & interface::NEEDS_CELLS_OF_POINTS != 0);
        let cells = (wants_neighbours || wants_cells).then(|| cells_of_points(&self.grid));
        let neighbours = cells.as_ref().filter(|_| wants_neighbours);
        let neighbours = neighbours.map(|cells| Compressed::from(points_of_points(&self.grid, cells)));
        [neighbours, cells.filter(|_| wants_cells).map(Compressed::from)]
    }

    /// Calls the function that computes; gives what it said, and the vectors. `needs`: what is computed for it.
    pub fn compute(&self, function: Function, needs: u32, state: &State) -> (Said, Vec<DVec3>) {
        use std::ptr::null;
        let point_count = self.grid.points.len();
        // Memory that nobody has touched yet takes its time, too.
        let (tables, vectors) = rayon::join(|| self.tables(needs), || fresh::<DVec3, f64>(point_count));
        let [neighbours, cells] = tables;
        let starts = |rows: &Option<Compressed>| rows.as_ref().map_or(null(), |rows| rows.starts.as_ptr());
        let items = |rows: &Option<Compressed>| rows.as_ref().map_or(null(), |rows| rows.items.as_ptr());
        let arrays = array_pointers(&self.arrays);
        let pointers = self.values.pointers();
        let values: Values = self.values.by(&pointers);
        let mut vectors = match vectors {
            Ok(vectors) => vectors,
            Err(wrong) => return (Said::not_called(wrong, state), Vec::new()),
        };
        let call = Call {
            size: size_of::<Call>() as u32,
            reserved: 0,
            point_count: point_count as u64,
            cell_count: self.grid.tetrahedra.len() as u64,
            // Three doubles a point and four numbers a cell, side by side.
            points: self.grid.points.as_ptr().cast(),
            cells: self.grid.tetrahedra.as_ptr().cast(),
            neighbour_starts: starts(&neighbours),
            neighbours: items(&neighbours),
            cell_starts: starts(&cells),
            cells_of_points: items(&cells),
            scalar: self.scalar.as_ptr(),
            arrays: arrays.as_ptr(),
            values: &values,
            gradient: vectors.as_mut_ptr().cast(),
        };
        // SAFETY: the plug-in's own function; what it is given lives through the call and has the sizes stated.
        let code = unsafe { function(&call, &state.host()) };
        let beyond = overran::<_, f64>(&mut vectors, point_count).then(|| Beyond::gradient(point_count));
        (Said { beyond, ..Said::new(code, state) }, vectors)
    }
}

/// Calls the function that checks parameters.
pub(crate) fn check(function: Check, values: &Owned, state: &State) -> Said {
    let pointers = values.pointers();
    // SAFETY: the plug-in's own function; all that it is given lives through the call.
    let code = unsafe { function(&values.by(&pointers), &state.host()) };
    Said::new(code, state)
}
