//! A grid of borrowed arrays.

use crate::error::guarded;
use crate::memory::{Lent, Piece, Watched, any_changed};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, OnceLock};
use voltet::{BorrowedGrid, CellArrays, NamedArray, PointNumbers, build_grid};
use voltet_core::grid::{CellValues, Options, extent};
use voltet_core::progress::NoProgress;
use voltet_core::{Error, SharedSlice, grid};

/// A grid, and the arrays that it was built from.
#[pyclass(frozen, module = "voltet._native")]
pub struct Grid {
    pub grid: Arc<grid::Grid>,
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
    /// From arrays that `voltet.Grid` has brought into form: C-contiguous, points of 64-bit floats, connectivity of 32-bit or
    /// 64-bit whole numbers. `watch` lists the bytes of the arrays whose changes [`Grid::changed`] finds.
    #[new]
    #[pyo3(signature = (points, cells, arrays, *, scalar, ghost, degrees, subdivision, constant_cells, keep_cells, watch))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        cells: &Bound<'_, PyDict>,
        arrays: Vec<(String, Bound<'_, PyAny>, usize, bool)>,
        scalar: Option<String>,
        ghost: Option<Bound<'_, PyAny>>,
        degrees: Option<Bound<'_, PyAny>>,
        subdivision: u32,
        constant_cells: bool,
        keep_cells: bool,
        watch: Vec<Bound<'_, PyAny>>,
    ) -> PyResult<Grid> {
        // Before the grid is built from them: a change in between is found later.
        let watched: Vec<Lent<u8>> =
            watch.iter().map(|array| Lent::borrow("an array", array)).collect::<PyResult<_>>()?;
        let watched = py.detach(|| watched.into_iter().map(Watched::new).collect());
        let points: Lent<f64> = Lent::borrow("points", points)?;
        let mut keep = Keep(vec![points.keep()]);
        let arrays = arrays.into_iter().map(|(name, values, component_count, on_cells)| {
            let lent: Lent<f64> = Lent::borrow(&format!("array '{name}'"), &values)?;
            let values = SharedSlice::from_borrowed(lent.values(), lent.keep());
            Ok(NamedArray { name, values, component_count, on_cells })
        });
        let arrays = arrays.collect::<PyResult<Vec<NamedArray>>>()?;
        let cells = cells_of(cells, &mut keep)?;
        let mut bytes = |name: &str, object: Option<Bound<'_, PyAny>>| -> PyResult<Option<&'static [u8]>> {
            let lent: Option<Lent<u8>> = object.map(|object| Lent::borrow(name, &object)).transpose()?;
            Ok(lent.map(|lent| keep.hold(lent)))
        };
        let (ghost, degrees) = (bytes("ghost", ghost)?, bytes("degrees", degrees)?);
        let cell_values = if constant_cells { CellValues::Constant } else { CellValues::Average };
        let options = Options { subdivision, cell_values, keep_cells };
        let source = BorrowedGrid {
            points: points.values(),
            cells,
            arrays,
            scalar,
            ghost,
            degrees,
            options,
            keep: Arc::new(keep),
        };
        let grid = guarded(py, || py.detach(|| build_grid(source, &NoProgress)))?;
        Ok(Grid { grid: Arc::new(grid), watched, about: OnceLock::new() })
    }

    /// True if a watched array has changed.
    fn changed(&self, py: Python<'_>) -> bool {
        py.detach(|| any_changed(&self.pieces().collect::<Vec<Piece<'_>>>()))
    }

    /// Summary (JSON), made once: ranges read all of the arrays.
    fn about(&self) -> &str {
        self.about.get_or_init(|| about(&self.grid))
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
