//! A grid of borrowed arrays.

use crate::error::{guarded, refuse_forked};
use crate::memory::{Lent, Piece, Watched, any_changed};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, OnceLock};
use voltet::{CellArrays, PointNumbers, add_array, borrowed_piece, build_grid};
use voltet_core::grid::{Array, CellValues, Options, RawGrid, extent};
use voltet_core::progress::NoProgress;
use voltet_core::{Error, SharedSlice, grid};
use voltet_graph::Arrays;
use voltet_nodes::in_memory_grid::HostGrid;

/// A grid, and the arrays that it was built from.
#[pyclass(frozen, module = "voltet._native")]
pub struct Grid {
    pub grid: Arc<HostGrid>,
    watched: Vec<Watched>,
    /// Summary (JSON), made at the first request.
    about: OnceLock<String>,
}

impl Grid {
    /// Pieces of the watched arrays.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> {
        self.watched.iter().flat_map(Watched::pieces)
    }
}

#[pymethods]
impl Grid {
    /// From pieces that `voltet.Grid` has brought into form: C-contiguous arrays, points of 64-bit floats, connectivity of 32-bit or
    /// 64-bit whole numbers. `watch` lists the bytes of the arrays whose changes [`Grid::changed`] finds, `warnings` what Python
    /// left out.
    #[new]
    #[pyo3(signature = (pieces, *, scalar, subdivision, constant_cells, keep_cells, watch, warnings))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        pieces: Vec<Bound<'_, PyDict>>,
        scalar: Option<String>,
        subdivision: u32,
        constant_cells: bool,
        keep_cells: bool,
        watch: Vec<Bound<'_, PyAny>>,
        warnings: Vec<String>,
    ) -> PyResult<Grid> {
        guarded(py, refuse_forked)?;
        // Before the grid is built from them: a change in between is found later.
        let watched: Vec<Lent<u8>> =
            watch.iter().map(|array| Lent::borrow("an array", array)).collect::<PyResult<_>>()?;
        let watched = py.detach(|| watched.into_iter().map(Watched::new).collect());
        let pieces = pieces.iter().map(piece_of).collect::<PyResult<_>>()?;
        let cell_values = if constant_cells { CellValues::Constant } else { CellValues::Average };
        let options = Options { subdivision, cell_values, keep_cells, ..Options::default() };
        let mut grid = guarded(py, || py.detach(|| build_grid(pieces, scalar.as_deref(), &options)))?;
        grid.add_warnings(&warnings);
        Ok(Grid { grid: Arc::new(grid), watched, about: OnceLock::new() })
    }

    /// True if a watched array has changed.
    fn changed(&self, py: Python<'_>) -> PyResult<bool> {
        guarded(py, refuse_forked)?;
        Ok(py.detach(|| any_changed(&self.pieces().collect::<Vec<Piece<'_>>>())))
    }

    /// Summary (JSON), made once: ranges read all of the arrays. `scalar`: of the grid that is drawn of it alone.
    #[pyo3(signature = (scalar = None))]
    fn about(&self, py: Python<'_>, scalar: Option<&str>) -> PyResult<String> {
        guarded(py, refuse_forked)?;
        let whole = self.grid.whole();
        let drawn = match scalar {
            Some(_) => {
                let of_scalar = || self.grid.with_requested(&Arrays::default(), scalar, &NoProgress);
                guarded(py, || py.detach(of_scalar))?.unwrap_or(whole.clone())
            }
            None => whole.clone(),
        };
        Ok(match Arc::ptr_eq(&drawn, whole) {
            true => self.about.get_or_init(|| about(whole)).clone(),
            false => about(&drawn),
        })
    }
}

/// Summary of a grid (JSON).
fn about(grid: &grid::Grid) -> String {
    let bytes = |lent: bool| {
        let of = |is_lent: bool, bytes: usize| if is_lent == lent { bytes } else { 0 };
        let arrays = grid.point_arrays.values().map(|a| of(a.values.is_lent(), size_of_val(&*a.values)));
        arrays.sum::<usize>()
            + of(grid.points.is_lent(), size_of_val(&*grid.points))
            + of(grid.tetrahedra.is_lent(), size_of_val(&*grid.tetrahedra))
    };
    let arrays: serde_json::Map<String, serde_json::Value> = grid
        .point_arrays
        .iter()
        .map(|(name, array)| {
            let range = extent::range(&array.values).filter(|_| array.component_count == 1);
            let about = serde_json::json!({ "components": array.component_count, "range": range });
            (name.clone(), about)
        })
        .collect();
    let bounds = grid.bounds().map(|corners| corners.map(|corner| corner.to_array()));
    let about = serde_json::json!({
        "points": grid.points.len(),
        "tetrahedra": grid.tetrahedra.len(),
        "bounds": bounds,
        "arrays": arrays,
        "scalar": grid.scalar.is_some().then_some(&grid.scalar_name),
        "bytes_lent": bytes(true),
        "bytes_copied": bytes(false),
        "points_lent": grid.points.is_lent(),
        "tetrahedra_lent": grid.tetrahedra.is_lent(),
        "warnings": grid.origin.warnings,
    });
    about.to_string()
}

/// Owner of the memory of borrowed slices.
struct Keep(Vec<Arc<dyn Send + Sync>>);

impl Keep {
    fn hold<T: pyo3::buffer::Element + Sync + Send>(&mut self, lent: Lent<T>) -> &'static [T] {
        self.0.push(lent.keep());
        lent.values()
    }
}

/// A piece: `points`, `cells`, `arrays` as (name, values, components of a tuple, on cells), `block`; `ghost`, `degrees`, `global_ids`.
pub fn piece_of(piece: &Bound<'_, PyDict>) -> PyResult<RawGrid> {
    let py = piece.py();
    let get = |name: &str| -> PyResult<Bound<'_, PyAny>> {
        piece.get_item(name)?.ok_or_else(|| PyKeyError::new_err(name.to_string()))
    };
    let mut keep = Keep(Vec::new());
    let points = keep.hold(Lent::borrow("points", &get("points")?)?);
    let cells = cells_of(get("cells")?.cast::<PyDict>()?, &mut keep)?;
    let keep: Arc<dyn Send + Sync> = Arc::new(keep);
    let mut raw = guarded(py, || py.detach(|| borrowed_piece(points, cells, &keep)))?;
    let arrays: Vec<(String, Bound<'_, PyAny>, usize, bool)> = get("arrays")?.extract()?;
    for (name, values, component_count, on_cells) in arrays {
        let lent: Lent<f64> = Lent::borrow(&format!("array '{name}'"), &values)?;
        let values = SharedSlice::from_borrowed(lent.values(), lent.keep());
        guarded(py, || add_array(&mut raw, &name, Array { component_count, values }, on_cells))?;
    }
    raw.block = get("block")?.extract()?;
    raw.ghost = copied("ghost", &get("ghost")?)?;
    raw.global_ids = copied("global_ids", &get("global_ids")?)?;
    raw.degrees = copied::<u8>("degrees", &get("degrees")?)?.map(|all| all.as_chunks::<3>().0.to_vec());
    Ok(raw)
}

fn copied<T: pyo3::buffer::Element + Sync + 'static>(
    name: &str,
    object: &Bound<'_, PyAny>,
) -> PyResult<Option<Vec<T>>> {
    let lent = || Lent::borrow(name, object).map(|lent| lent.values().to_vec());
    (!object.is_none()).then(lent).transpose()
}

/// The cells: `tetrahedra`, or `types`, `offsets`, `connectivity`, and for polyhedra `faces` and `face_locations`.
fn cells_of(cells: &Bound<'_, PyDict>, keep: &mut Keep) -> PyResult<CellArrays<'static>> {
    let get = |name: &str| cells.get_item(name).map(|found| found.filter(|object| !object.is_none()));
    if let Some(tetrahedra) = get("tetrahedra")? {
        return Ok(CellArrays::Tetrahedra(keep.hold(Lent::borrow("tetrahedra", &tetrahedra)?)));
    }
    let must = |name: &str| {
        let none = || Error::usage(format!("{name} is missing")).expected("types, offsets and connectivity");
        get(name)?.ok_or_else(|| crate::error::exception(cells.py(), &none()))
    };
    let mut wide = |name: &str| -> PyResult<&'static [i64]> {
        let lent = get(name)?.map(|object| Lent::borrow(name, &object)).transpose()?;
        Ok(lent.map_or(&[][..], |lent| keep.hold(lent)))
    };
    let (faces, face_locations) = (wide("faces")?, wide("face_locations")?);
    let connectivity = must("connectivity")?;
    let narrow = connectivity.getattr("dtype")?.getattr("itemsize")?.extract::<usize>()? == 4;
    let connectivity = match narrow {
        true => PointNumbers::U32(keep.hold(Lent::borrow("connectivity", &connectivity)?)),
        false => PointNumbers::I64(keep.hold(Lent::borrow("connectivity", &connectivity)?)),
    };
    Ok(CellArrays::Mixed {
        types: keep.hold(Lent::borrow("types", &must("types")?)?),
        offsets: keep.hold(Lent::borrow("offsets", &must("offsets")?)?),
        connectivity,
        faces,
        face_locations,
    })
}
