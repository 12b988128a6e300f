//! A gradient filter of a plug-in: its call, and its adapter to the program's [`GradientFilter`].

use crate::declaration::{Declaration, EntryPoint, Family, LibraryItem};
use crate::ffi::{Overrun, Sentinel, guarded_vec, remove_guard};
use crate::host::State;
use crate::interface::{GradientCall, NEEDS_CELLS_OF_POINTS, NEEDS_NEIGHBOURS};
use crate::runner::PluginItem;
use crate::status::{CallLabel, CallStatus};
use crate::task::{Outcome, Task, TaskKind};
use crate::values::{NamedArrays, ParameterValues, array_names, array_pointers, named_arrays};
use crate::wire::wire;
use rayon::prelude::*;
use std::mem::size_of;
use voltet_core::Result;
use voltet_core::field::{Gradient, GradientFilter, Plugin, check_scalar};
use voltet_core::glam::DVec3;
use voltet_core::grid::{Csr, Grid, cells_of_points, points_of_points};
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::Progress;

/// Computation of the gradient at every point.
pub(crate) struct GradientTask {
    /// Points and tetrahedra.
    pub grid: Grid,
    pub scalar: Vec<f64>,
    pub values: ParameterValues,
    pub arrays: NamedArrays,
}

wire!(fields of GradientTask { grid, scalar, values, arrays });

/// Rows of a compressed table with starts of 64 bits.
pub(crate) struct Rows64 {
    pub starts: Vec<u64>,
    pub items: Vec<u32>,
}

impl From<Csr> for Rows64 {
    fn from(Csr { starts, items }: Csr) -> Rows64 {
        // The same memory where both are of 64 bits.
        let widened = |(_, starts): (_, Vec<usize>)| starts.into_iter().map(|start| start as u64).collect();
        Rows64 { starts: bytemuck::try_cast_vec(starts).unwrap_or_else(widened), items }
    }
}

impl GradientTask {
    pub const KIND: TaskKind = TaskKind::new::<GradientTask>(1, "gradient");

    /// Errors: an array that is not there.
    fn new(
        declaration: &Declaration,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
    ) -> Result<GradientTask> {
        Ok(GradientTask {
            grid: grid.clone(),
            scalar: scalar.to_vec(),
            values: ParameterValues::new(declaration, parameters)?,
            arrays: named_arrays(declaration, parameters, grid)?,
        })
    }

    /// Neighbours of points, and cells of points, where the flags `needs` have them.
    pub fn tables(&self, needs: u32) -> [Option<Rows64>; 2] {
        let [needs_neighbours, needs_cells] =
            [NEEDS_NEIGHBOURS, NEEDS_CELLS_OF_POINTS].map(|flag| needs & flag != 0);
        let cells = (needs_neighbours || needs_cells).then(|| cells_of_points(&self.grid));
        let neighbours = cells.as_ref().filter(|_| needs_neighbours);
        let neighbours = neighbours.map(|cells| Rows64::from(points_of_points(&self.grid, cells)));
        [neighbours, cells.filter(|_| needs_cells).map(Rows64::from)]
    }
}

impl Task for GradientTask {
    fn kind(&self) -> &'static TaskKind {
        &GradientTask::KIND
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        use std::ptr::null;
        let (EntryPoint::Gradient(function), Family::GradientFilter { needs }) =
            (item.function, item.declaration.family)
        else {
            return Default::default();
        };
        let point_count = self.grid.points.len();
        // The first touch of fresh memory takes its time, too.
        let (tables, vectors) = rayon::join(|| self.tables(needs), || guarded_vec::<DVec3, f64>(point_count));
        let [neighbours, cells] = tables;
        let starts = |rows: &Option<Rows64>| rows.as_ref().map_or(null(), |rows| rows.starts.as_ptr());
        let items = |rows: &Option<Rows64>| rows.as_ref().map_or(null(), |rows| rows.items.as_ptr());
        let arrays = array_pointers(&self.arrays);
        let pointers = self.values.pointers();
        let values = self.values.header_values(&pointers);
        let mut vectors = match vectors {
            Ok(vectors) => vectors,
            Err(wrong) => return (CallStatus::not_called(wrong, state), Outcome::Vectors(Vec::new())),
        };
        let call = GradientCall {
            size: size_of::<GradientCall>() as u32,
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
        let overrun =
            remove_guard::<_, f64>(&mut vectors, point_count).then(|| Overrun::gradient(point_count));
        (CallStatus { overrun, ..CallStatus::new(code, state) }, Outcome::Vectors(vectors))
    }
}

impl GradientFilter for PluginItem {
    fn declaration(&self) -> VariantSchema {
        self.declaration.schema
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(self.runner.plugin())
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        self.check_parameters(parameters)
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(array_names(&self.declaration, parameters))
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        check_scalar(grid, scalar)?;
        let task = GradientTask::new(&self.declaration, grid, scalar, parameters)?;
        let (status, vectors) = self.run(Box::new(task), progress, Outcome::vectors)?;
        let vectors = refuse_missing(grid, vectors, self.label())?;
        Ok(Gradient { vectors, fallbacks: status.reports.fallbacks })
    }
}

/// The vectors, zero at points of no cell.
///
/// Errors: a point of a cell without a vector.
fn refuse_missing(grid: &Grid, mut vectors: Vec<DVec3>, label: CallLabel) -> Result<Vec<DVec3>> {
    let is_unset = |v: &DVec3| v.to_array().iter().any(Sentinel::is_unset);
    if !vectors.par_iter().with_min_len(1 << 14).any(is_unset) {
        return Ok(vectors);
    }
    let mut used = vec![false; vectors.len()];
    grid.tetrahedra.iter().flatten().for_each(|&p| used[p as usize] = true);
    let mut unset = (0..vectors.len()).filter(|&p| used[p] && is_unset(&vectors[p]));
    if let Some(first) = unset.next() {
        let found = format!("{} without, the first of them point {first}", 1 + unset.count());
        let expected = format!("one for each of the {} points", vectors.len());
        return Err(label.error("did not give every point a vector").got(found).expected(expected));
    }
    vectors.iter_mut().filter(|v| is_unset(v)).for_each(|v| *v = DVec3::ZERO);
    Ok(vectors)
}
