//! Small grids as XML files.

use super::xml::{Encoding, Values, XmlWriter};
use std::path::PathBuf;

/// Writes a file into a folder of its own.
pub fn file(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The number types, each the name of an array of [`unstructured`].
pub const TYPES: [&str; 10] =
    ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float32", "Float64"];

/// A row of unit cubes along x: one of six tetrahedra (or, mixed, one hexahedron every second cube).
pub fn unstructured(encoding: Encoding, cube_count: usize, mixed: bool) -> Vec<u8> {
    let mut points = Vec::new();
    for i in 0..=cube_count {
        for corner in 0..4 {
            points.extend([i as f64, f64::from(corner & 1), f64::from(corner >> 1)]);
        }
    }
    let (mut connectivity, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for cube in 0..cube_count {
        // Corner numbers by bits of (x, y, z).
        let corner = |bits: usize| (4 * (cube + (bits & 1)) + (bits >> 1)) as f64;
        if mixed && cube % 2 == 1 {
            connectivity.extend([0, 1, 3, 2, 4, 5, 7, 6].map(corner));
            types.push(12.0);
            offsets.push(connectivity.len() as f64);
            continue;
        }
        for path in [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]] {
            connectivity.extend([0, path[0], path[1], 7].map(corner));
            types.push(10.0);
            offsets.push(connectivity.len() as f64);
        }
    }
    let (point_count, cell_count) = (points.len() / 3, types.len());
    let mut writer = XmlWriter::new("UnstructuredGrid", encoding);
    writer.raw(&format!(
        "<UnstructuredGrid><FieldData><DataArray type=\"String\" Name=\"who\" format=\"ascii\">52 0</DataArray></FieldData>\
         <Piece NumberOfPoints=\"{point_count}\" NumberOfCells=\"{cell_count}\">\n<PointData>\n"
    ));
    for number_type in TYPES {
        let sign = if number_type.starts_with('U') { 1.0 } else { -1.0 };
        let values = Values::new(number_type, (0..point_count).map(|i| sign * (i % 120) as f64));
        writer.array(number_type, 1, &values);
    }
    let vector = Values::new("Float32", (0..3 * point_count).map(|i| i as f64 * 0.5));
    writer.array("vec &amp; tor", 3, &vector);
    writer.raw("</PointData>\n<CellData>\n");
    writer.array("cell", 1, &Values::new("Float64", (0..cell_count).map(|i| i as f64)));
    writer.raw("</CellData>\n<Points>\n");
    writer.array("Points", 3, &Values::new("Float32", points));
    writer.raw("</Points>\n<Cells>\n");
    let ids = if encoding.wide_headers { "Int64" } else { "Int32" };
    writer.array("connectivity", 1, &Values::new(ids, connectivity));
    writer.array("offsets", 1, &Values::new(ids, offsets));
    writer.array("types", 1, &Values::new("UInt8", types));
    writer.finish("</Cells></Piece></UnstructuredGrid>\n")
}

/// One of the structured formats, 5 × 4 × 3 points; `(i, j, k)` lies at `(2 + i/2, j/4 − 1, 2 k)`.
pub fn structured(kind: &str, encoding: Encoding) -> Vec<u8> {
    let at = |i: usize, j: usize, k: usize| [2.0 + i as f64 / 2.0, j as f64 / 4.0 - 1.0, 2.0 * k as f64];
    let all = || (0..60).map(move |n| at(n % 5, n / 5 % 4, n / 20));
    let mut writer = XmlWriter::new(kind, encoding);
    // The extent does not begin at 0.
    let extent = "2 6 -1 2 0 2";
    let geometry = "Origin=\"1 -0.75 0\" Spacing=\"0.5 0.25 2\"";
    let geometry = if kind == "ImageData" { geometry } else { "" };
    writer.raw(&format!(
        "<{kind} WholeExtent=\"{extent}\" {geometry}><Piece Extent=\"{extent}\"><PointData Scalars=\"s\">\n"
    ));
    writer.array("s", 1, &Values::new("Float64", all().map(|p| p[0] + 2.0 * p[1] + 3.0 * p[2])));
    writer.array("t", 1, &Values::new("Float32", all().map(|p| p[0])));
    writer.raw("</PointData>\n");
    match kind {
        "StructuredGrid" => {
            writer.raw("<Points>\n");
            writer.array("Points", 3, &Values::new("Float64", all().flatten()));
            writer.raw("</Points>\n");
        }
        "RectilinearGrid" => {
            writer.raw("<Coordinates>\n");
            writer.array("x", 1, &Values::new("Float32", (0..5).map(|i| at(i, 0, 0)[0])));
            writer.array("y", 1, &Values::new("Float64", (0..4).map(|j| at(0, j, 0)[1])));
            writer.array("z", 1, &Values::new("Int32", (0..3).map(|k| at(0, 0, k)[2])));
            writer.raw("</Coordinates>\n");
        }
        _ => {}
    }
    writer.finish(&format!("</Piece></{kind}>\n"))
}
