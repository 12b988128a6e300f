//! Values of a volume at the file's own points and cells, or at those of its tetrahedra.

use super::contents::{Column, Contents, Role, Topology, Values};
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::grid::{Array, FileCells, Grid};

/// Cells to write.
#[derive(Debug, Clone, Copy)]
pub enum CellSource<'a> {
    /// The file's own.
    File(&'a FileCells),
    /// The tetrahedra that they were split into.
    Tetrahedra,
}

/// Numbers of tetrahedra that become arrays over cells.
pub enum TetrahedraSource<'a> {
    /// A cell has the largest of its tetrahedra's.
    Largest(&'a [f32]),
    /// True for tetrahedra that are left; a cell is culled (1) where none of its own is.
    Kept(&'a [bool]),
}

/// The contents without arrays, to which the others are added.
pub fn gather(grid: &Grid, form: CellSource) -> Contents {
    match form {
        CellSource::File(file) => {
            let mut cell_arrays = Vec::new();
            if let Some(ghost) = &file.ghost {
                let flags = ghost.iter().map(|&ghost| u8::from(ghost)).collect();
                cell_arrays.push(Column::plain("vtkGhostType", 1, Values::Bytes(flags)));
            }
            if let Some(degrees) = &file.degrees {
                let degrees = degrees.as_flattened().to_vec();
                cell_arrays.push(Column::plain(super::encode::DEGREES, 3, Values::Bytes(degrees)));
            }
            let (points, cells) = (file.points.clone(), Topology::of_cells(&file.cells));
            Contents { points, cells, point_arrays: Vec::new(), cell_arrays }
        }
        CellSource::Tetrahedra => {
            let oriented: Vec<[u32; 4]> = (0..grid.tetrahedra.len()).map(|i| oriented(grid, i)).collect();
            let cells = (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) as u32).collect();
            Contents {
                points: grid.points.clone(),
                cells: Topology::of_tetrahedra(&oriented),
                point_arrays: Vec::new(),
                cell_arrays: vec![Column::plain("file_cell", 1, Values::Numbers(cells))],
            }
        }
    }
}

impl Column {
    fn plain(name: &str, component_count: usize, values: Values) -> Column {
        Column { name: name.into(), role: Role::Plain, component_count, values }
    }
}

/// A tetrahedron whose fourth corner lies on the side of the others' normal, as VTK has it.
fn oriented(grid: &Grid, i: usize) -> [u32; 4] {
    let [a, b, c, d] = grid.tetrahedra[i];
    let [p, q, r, s] = grid.corners(i);
    if (q - p).cross(r - p).dot(s - p) < 0.0 { [a, c, b, d] } else { [a, b, c, d] }
}

impl Contents {
    /// Adds values of the grid's points. Points of the file that no tetrahedron uses get NaN.
    pub fn add_point_values(
        &mut self,
        form: CellSource,
        name: &str,
        role: Role,
        values: &[f64],
        components: usize,
    ) {
        let values = match form {
            CellSource::Tetrahedra => values.to_vec(),
            CellSource::File(file) => {
                let mut own = Vec::with_capacity(file.points.len() * components);
                for point in 0..file.points.len() {
                    match file.grid_point(point) {
                        Some(at) => own.extend_from_slice(&values[at * components..(at + 1) * components]),
                        None => own.extend(std::iter::repeat_n(f64::NAN, components)),
                    }
                }
                own
            }
        };
        let (name, values) = (name.to_string(), Values::Floats(values));
        self.point_arrays.push(Column { name, role, component_count: components, values });
    }

    /// Adds arrays of the file's cells.
    pub fn add_cell_arrays(&mut self, grid: &Grid, form: CellSource, arrays: &BTreeMap<String, Arc<Array>>) {
        for (name, array) in arrays {
            let n = array.component_count;
            let values = match form {
                CellSource::File(_) => array.values.to_vec(),
                CellSource::Tetrahedra => (0..grid.tetrahedra.len())
                    .map(|i| grid.source_cell(i))
                    .flat_map(|cell| &array.values[cell * n..(cell + 1) * n])
                    .copied()
                    .collect(),
            };
            self.cell_arrays.push(Column::plain(name, n, Values::Floats(values)));
        }
    }

    /// Adds numbers of tetrahedra.
    pub fn add_of_tetrahedra(
        &mut self,
        grid: &Grid,
        form: CellSource,
        name: &str,
        numbers: TetrahedraSource,
    ) {
        // Of each cell the largest of its tetrahedra's.
        let largest = |of: &dyn Fn(usize) -> f64, least: f64| -> Vec<f64> {
            let count = grid.tetrahedra.len();
            let CellSource::File(file) = form else { return (0..count).map(of).collect() };
            let mut cells = vec![least; file.cells.count()];
            for i in 0..count {
                let cell = &mut cells[grid.source_cell(i)];
                *cell = cell.max(of(i));
            }
            cells
        };
        let values = match numbers {
            TetrahedraSource::Largest(numbers) => Values::Floats(largest(&|i| f64::from(numbers[i]), 0.0)),
            TetrahedraSource::Kept(kept) => {
                let kept = largest(&|i| f64::from(u8::from(kept[i])), 0.0);
                Values::Bytes(kept.iter().map(|&kept| u8::from(kept == 0.0)).collect())
            }
        };
        self.cell_arrays.push(Column::plain(name, 1, values));
    }

    /// Points of the file that have no values, since no tetrahedron uses them.
    pub fn points_without_values(form: CellSource) -> usize {
        match form {
            CellSource::Tetrahedra => 0,
            CellSource::File(file) => {
                (0..file.points.len()).filter(|&p| file.grid_point(p).is_none()).count()
            }
        }
    }
}
