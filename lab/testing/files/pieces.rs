//! A cube of hexahedra whose faces are not flat, cut into pieces by any rule.

use std::fmt::Write;
use std::path::Path;

/// Cells along a side.
pub const SIDE: usize = 8;

/// A cube of hexahedra with moved points as a .pvtu in pieces; `piece` is that of a cell, by its place.
pub fn write_pieces(folder: &Path, name: &str, count: usize, piece: impl Fn([usize; 3]) -> usize) {
    let mut cells: Vec<Vec<[usize; 3]>> = vec![Vec::new(); count];
    for number in 0..SIDE.pow(3) {
        let place = [number % SIDE, number / SIDE % SIDE, number / SIDE / SIDE];
        cells[piece(place)].push(place);
    }
    let mut sources = String::new();
    for (number, own) in cells.iter().enumerate() {
        std::fs::write(folder.join(format!("{name}_{number}.vtu")), piece_text(own)).unwrap();
        write!(sources, "<Piece Source=\"{name}_{number}.vtu\"/>").unwrap();
    }
    let text = format!(
        "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>{sources}</PUnstructuredGrid></VTKFile>"
    );
    std::fs::write(folder.join(format!("{name}.pvtu")), text).unwrap();
}

/// A piece of these cells, with the scalar `t` at the points and `c` in the cells.
fn piece_text(cells: &[[usize; 3]]) -> String {
    const CORNERS: [[usize; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let n = SIDE + 1;
    let number = |[i, j, k]: [usize; 3]| i + n * (j + n * k);
    let corners =
        |cell: &[usize; 3]| CORNERS.map(|c| number([0, 1, 2].map(|axis: usize| cell[axis] + c[axis])));
    let mut used: Vec<usize> = cells.iter().flat_map(corners).collect();
    used.sort_unstable();
    used.dedup();
    let [mut points, mut t, mut c, mut connectivity, mut offsets, mut types] =
        [(); 6].map(|()| String::new());
    for &point in &used {
        let place = [point % n, point / n % n, point / n / n].map(|x| x as f64);
        // Faces are not flat.
        let wave = |axis: usize| 0.2 * (3.0 * place[(axis + 1) % 3] + 5.0 * place[(axis + 2) % 3]).sin();
        let [x, y, z] = [0, 1, 2].map(|axis| (place[axis] + wave(axis)) / SIDE as f64);
        write!(points, "{x} {y} {z} ").unwrap();
        write!(t, "{} ", (5.0 * x).sin() + y * y + (4.0 * z).cos()).unwrap();
    }
    for (k, cell) in cells.iter().enumerate() {
        let [i, j, l] = cell.map(|x| x as f64);
        write!(c, "{} ", (i * 0.7).sin() + (j * 0.4).cos() + 0.1 * l).unwrap();
        for corner in corners(cell) {
            write!(connectivity, "{} ", used.binary_search(&corner).unwrap()).unwrap();
        }
        write!(offsets, "{} ", 8 * (k + 1)).unwrap();
        types += "12 ";
    }
    let array = |kind: &str, name: &str, components: usize, values: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
        )
    };
    format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"><PointData>{}</PointData><CellData>{}</CellData><Points>{}</Points>\
         <Cells>{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        used.len(),
        cells.len(),
        array("Float64", "t", 1, &t),
        array("Float64", "c", 1, &c),
        array("Float64", "Points", 3, &points),
        array("Int64", "connectivity", 1, &connectivity),
        array("Int64", "offsets", 1, &offsets),
        array("UInt8", "types", 1, &types),
    )
}
