//! VTKHDF files of unstructured grids (.vtkhdf): one partition, one time.
//!
//! Source: VTKHDF format specification, version 2.7 (docs.vtk.org, VTK File Formats), and vtkHDFWriter of VTK 9.7. Polyhedra are of
//! version 2.5, marks of arrays of version 2.6.

use super::contents::{Column, Contents};
use super::hdf5::{self, OutputArray, OutputGroup};
use super::numbers::{Numbers, Precision};
use std::io::{self, Write};
use voltet_core::Result;
use voltet_core::grid::Polyhedron;

const VERSION: [i64; 2] = [2, 6];

/// Writes the file.
///
/// Errors: those of `out`; an array whose name HDF5 does not allow.
pub(super) fn write(contents: &Contents, out: &mut dyn Write) -> io::Result<()> {
    let cells = &contents.cells;
    let mut arrays = vec![
        ("NumberOfPoints", one(contents.point_count())),
        ("NumberOfCells", one(contents.cell_count())),
        ("NumberOfConnectivityIds", one(cells.connectivity.len())),
        ("Connectivity", Numbers::indices(&cells.connectivity[..], false)),
        ("Offsets", Numbers::offsets(&cells.offsets[..], false)),
        ("Types", Numbers::flags(&cells.types[..])),
    ];
    if !cells.polyhedra.is_empty() {
        arrays.extend(faces(&cells.polyhedra, contents.cell_count()));
    }
    let time = contents.time().map(|time| Numbers::quantities(vec![time], Precision::Double));
    let root = root(contents, &arrays, time.as_ref()).map_err(io::Error::other)?;
    hdf5::write(&root, out)
}

/// The root group of the file. `arrays`: of the cells; `time`: one number.
fn root<'a>(
    contents: &'a Contents,
    arrays: &'a [(&str, Numbers)],
    time: Option<&'a Numbers>,
) -> Result<OutputGroup<'a>> {
    let mut grid = OutputGroup::default();
    grid.integers("Version", &VERSION);
    grid.text("Type", "UnstructuredGrid");
    for (name, numbers) in arrays {
        grid.array(name, OutputArray::new(numbers, 1))?;
    }
    grid.array("Points", OutputArray::new(&contents.points, 3))?;
    grid.group("PointData", section(&contents.point_arrays)?);
    grid.group("CellData", section(&contents.cell_arrays)?);
    if let Some(time) = time {
        let mut fields = OutputGroup::default();
        fields.array("TimeValue", OutputArray::new(time, 1))?;
        grid.group("FieldData", fields);
    }
    let mut root = OutputGroup::default();
    root.group("VTKHDF", grid);
    Ok(root)
}

/// Name of an array in the file. A slash parts the names of groups; VTK's writer does the same.
pub(super) fn array_name(name: &str) -> String {
    name.replace('/', "_")
}

fn one(count: usize) -> Numbers<'static> {
    Numbers::signed(vec![count as i64])
}

fn section<'a>(arrays: &'a [Column]) -> Result<OutputGroup<'a>> {
    let mut group = OutputGroup::default();
    for Column { name, role, component_count, numbers } in arrays {
        let array = OutputArray::new(numbers, *component_count);
        let array = match role.name() {
            Some(role) => array.with_text("Attribute", role),
            None => array,
        };
        group.array(&array_name(name), array)?;
    }
    Ok(group)
}

/// The points of each face, and the faces of each cell; their offsets begin with 0.
fn faces(polyhedra: &[Polyhedron], cell_count: usize) -> Vec<(&'static str, Numbers<'static>)> {
    let (mut points, mut point_offsets) = (Vec::new(), vec![0]);
    let mut counts = vec![0; cell_count];
    // Faces lie in the order of the cells.
    let mut in_order: Vec<&Polyhedron> = polyhedra.iter().collect();
    in_order.sort_by_key(|polyhedron| polyhedron.cell);
    for polyhedron in in_order {
        counts[polyhedron.cell as usize] = polyhedron.faces.len() as u64;
        for face in &polyhedron.faces {
            points.extend_from_slice(face);
            point_offsets.push(points.len() as u64);
        }
    }
    let face_count = point_offsets.len() - 1;
    let mut cell_offsets = vec![0];
    let mut end = 0;
    cell_offsets.extend(counts.iter().map(|count| {
        end += count;
        end
    }));
    vec![
        ("NumberOfFaces", one(face_count)),
        ("NumberOfFaceConnectivityIds", one(points.len())),
        ("NumberOfPolyhedronToFaceIds", one(face_count)),
        ("FaceConnectivity", Numbers::indices(points, false)),
        ("FaceOffsets", Numbers::offsets(point_offsets, false)),
        ("PolyhedronToFaces", Numbers::indices((0..face_count as u32).collect::<Vec<_>>(), false)),
        ("PolyhedronOffsets", Numbers::offsets(cell_offsets, false)),
    ]
}
