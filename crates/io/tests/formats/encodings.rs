//! A grid in every encoding of the XML formats reads as one grid.

use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, Request, inspect, piece_sizes, read};
use voltet_testing::files::legacy::LegacyWriter;
use voltet_testing::files::samples::{TYPES, file, structured, unstructured};
use voltet_testing::files::xml::{Encoding, Mode, Values, XmlWriter, encodings};

/// Reads a scalar of a file.
pub fn grid(path: &std::path::Path, scalar: &str) -> Grid {
    let request = Request { scalar: Some(scalar.to_owned()), ..Request::default() };
    read(path, &request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_encoding_of_an_unstructured_grid_reads_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for mixed in [false, true] {
        let mut first: Option<Grid> = None;
        for encoding in encodings() {
            let path = file(&folder, "grid.vtu", &unstructured(encoding, 40, mixed));
            for (index, number_type) in TYPES.into_iter().enumerate() {
                // Every type in one encoding in three; all encodings with one type.
                if index != 9 && encoding.block == 13 {
                    continue;
                }
                let grid = grid(&path, number_type);
                let sign = if number_type.starts_with('U') { 1.0 } else { -1.0 };
                let expected: Vec<f64> = (0..164).map(|i| sign * f64::from(i % 120)).collect();
                assert_eq!(**grid.scalar.as_ref().unwrap(), expected, "{number_type} {encoding:?}");
                if index == 9 {
                    let first = first.get_or_insert_with(|| grid.clone());
                    assert_eq!(grid.points, first.points, "{encoding:?}");
                    assert_eq!(grid.tetrahedra, first.tetrahedra, "{encoding:?}");
                    assert_eq!(grid.source_cells, first.source_cells, "{encoding:?}");
                }
            }
            let grid = grid(&path, "vec & tor:1");
            assert!(
                (0..164).all(|i| grid.scalar.as_ref().unwrap()[i] == (3 * i + 1) as f64 * 0.5),
                "{encoding:?}"
            );
            assert!(grid.origin.arrays_unread.contains(&"cell".to_owned()));
        }
        let first = first.unwrap();
        assert_eq!(first.points.len(), 164);
        assert_eq!(first.tetrahedra.len(), 240);
        assert!(first.tetrahedra.iter().all(|t| t.is_sorted()));
    }
}

/// Text alone does not tell beforehand how many corners there are: cells are then taken for hexahedra as far as the points allow.
#[test]
fn the_size_of_a_grid_follows_from_headers() {
    let folder = tempfile::tempdir().unwrap();
    for encoding in encodings() {
        for mixed in [false, true] {
            let path = file(&folder, "grid.vtu", &unstructured(encoding, 40, mixed));
            let [size] = piece_sizes(&path, &Request::default()).unwrap()[..] else { panic!("one piece") };
            let whole = inspect(&path, &Request::default(), &NoProgress).unwrap().size;
            assert_eq!((size.points, whole.tetrahedra), (whole.points, 240), "{encoding:?}");
            let is_told = encoding.mode != Mode::Ascii;
            match mixed {
                _ if !is_told => assert_eq!(size.tetrahedra, if mixed { 840 } else { 984 }, "{encoding:?}"),
                false => assert_eq!(size, whole, "{encoding:?}"),
                // The mean cell is one with 640 / 140 corners, so between a tetrahedron and a pyramid.
                true => {
                    assert!((219..=220).contains(&size.tetrahedra) && size.split.is_some(), "{encoding:?}")
                }
            }
        }
    }
}

/// Numbers of the cells of a row of prisms over a polygon of so many corners: points, connectivity, and of each cell the stream of its faces.
fn prisms(corners: usize, count: usize) -> (Vec<f64>, Vec<f64>, Vec<Vec<f64>>) {
    let (mut points, mut streams) = (Vec::new(), Vec::new());
    for prism in 0..count {
        for i in 0..2 * corners {
            let angle = (i % corners) as f64 / corners as f64 * std::f64::consts::TAU;
            points.extend([3.0 * prism as f64 + angle.cos(), angle.sin(), (i / corners) as f64]);
        }
        let first = 2 * prism * corners;
        let ends = [0, corners].map(|from| (from..from + corners).collect::<Vec<_>>());
        let side = |i: usize| vec![i, (i + 1) % corners, (i + 1) % corners + corners, i + corners];
        let faces: Vec<Vec<usize>> = ends.into_iter().chain((0..corners).map(side)).collect();
        let mut stream = vec![faces.len() as f64];
        for face in faces {
            stream.push(face.len() as f64);
            stream.extend(face.iter().map(|point| (first + point) as f64));
        }
        streams.push(stream);
    }
    let connectivity = (0..2 * corners * count).map(|point| point as f64).collect();
    (points, connectivity, streams)
}

fn ends(lens: impl Iterator<Item = usize>) -> Vec<f64> {
    let mut end = 0.0;
    lens.map(|len| {
        end += len as f64;
        end
    })
    .collect()
}

fn polyhedra_of_xml(encoding: Encoding, corners: usize, count: usize) -> Vec<u8> {
    let (points, connectivity, streams) = prisms(corners, count);
    let mut writer = XmlWriter::new("UnstructuredGrid", encoding);
    let point_count = points.len() / 3;
    writer.raw(&format!(
        "<UnstructuredGrid><Piece NumberOfPoints=\"{point_count}\" NumberOfCells=\"{count}\"><PointData>\n"
    ));
    writer.array("s", 1, &Values::new("Float64", (0..point_count).map(|i| i as f64)));
    writer.raw("</PointData><Points>\n");
    writer.array("Points", 3, &Values::new("Float64", points));
    writer.raw("</Points><Cells>\n");
    writer.array("connectivity", 1, &Values::new("Int64", connectivity));
    writer.array("offsets", 1, &Values::new("Int64", ends((0..count).map(|_| 2 * corners))));
    writer.array("types", 1, &Values::new("UInt8", vec![42.0; count]));
    writer.array("faces", 1, &Values::new("Int64", streams.concat()));
    writer.array("faceoffsets", 1, &Values::new("Int64", ends(streams.iter().map(Vec::len))));
    writer.finish("</Cells></Piece></UnstructuredGrid>\n")
}

/// `counted`: each cell's count before its numbers, as files before 5.0 have it.
fn polyhedra_of_legacy(counted: bool, corners: usize, count: usize) -> Vec<u8> {
    let (points, _, streams) = prisms(corners, count);
    let mut writer = LegacyWriter::new(if counted { "4.2" } else { "5.1" }, true, "UNSTRUCTURED_GRID");
    let point_count = points.len() / 3;
    writer.line(&format!("POINTS {point_count} double"));
    writer.values("Float64", points);
    let lens = streams.iter().map(Vec::len);
    if counted {
        writer.line(&format!("CELLS {count} {}", lens.map(|len| len + 1).sum::<usize>()));
        let numbers = streams.iter().flat_map(|own| std::iter::once(own.len() as f64).chain(own.clone()));
        writer.values("Int32", numbers);
    } else {
        writer.line(&format!("CELLS {} {}", count + 1, streams.concat().len()));
        writer.line("OFFSETS vtktypeint64");
        writer.values("Int64", std::iter::once(0.0).chain(ends(lens)));
        writer.line("CONNECTIVITY vtktypeint64");
        writer.values("Int64", streams.concat());
    }
    writer.line(&format!("CELL_TYPES {count}"));
    writer.values("Int32", vec![42.0; count]);
    writer.line(&format!("POINT_DATA {point_count}\nSCALARS s double 1\nLOOKUP_TABLE default"));
    writer.values("Float64", (0..point_count).map(|i| i as f64));
    writer.bytes
}

#[test]
fn polyhedra_become_about_as_many_tetrahedra_as_headers_and_types_tell() {
    let folder = tempfile::tempdir().unwrap();
    let binary =
        encodings().into_iter().filter(|encoding| encoding.mode != Mode::Ascii && encoding.block == 64);
    let binary: Vec<Encoding> = binary.collect();
    for corners in [4, 6, 10] {
        let of_xml = binary.iter().map(|&encoding| ("grid.vtu", polyhedra_of_xml(encoding, corners, 20)));
        let of_legacy = [false, true].map(|counted| ("grid.vtk", polyhedra_of_legacy(counted, corners, 20)));
        for (index, (name, bytes)) in of_xml.chain(of_legacy).enumerate() {
            let path = file(&folder, name, &bytes);
            let [size] = piece_sizes(&path, &Request::default()).unwrap()[..] else { panic!("one piece") };
            let found = inspect(&path, &Request::default(), &NoProgress).unwrap().size;
            let truth = grid(&path, "s").tetrahedra.len() as f64;
            for (by, told) in [("headers", size), ("types", found)] {
                let ratio = told.tetrahedra as f64 / truth;
                assert!((1.0 / 1.5..1.5).contains(&ratio), "{corners} {index} {by}: {ratio} of {truth}");
            }
            let [told, found] = [size, found].map(|size| size.split.unwrap() as f64);
            assert!((told / found - 1.0).abs() < 0.2, "{corners} {index}: {told} and {found} bytes");
        }
    }
}

#[test]
fn structured_grids_become_the_tetrahedra_that_headers_tell() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["StructuredGrid", "RectilinearGrid", "ImageData"] {
        let path = file(&folder, "grid", &structured(kind, encodings()[0]));
        let [size] = piece_sizes(&path, &Request::default()).unwrap()[..] else { panic!("one piece") };
        assert_eq!(size, inspect(&path, &Request::default(), &NoProgress).unwrap().size, "{kind}");
        assert_eq!(size.tetrahedra, grid(&path, "s").tetrahedra.len() as u64, "{kind}");
    }
}

#[test]
fn vectors_are_read_by_component_or_by_length_and_further_arrays_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "grid.vtu", &unstructured(encodings()[20], 3, false));
    let request = Request {
        scalar: Some("vec & tor:magnitude".to_owned()),
        point_arrays: vec![
            "vec & tor".to_owned(),
            "Int16".to_owned(),
            "vec & tor:2".to_owned(),
            "cell".to_owned(),
        ],
        ..Request::default()
    };
    let grid = read(&path, &request, &NoProgress).unwrap();
    let vector = &grid.point_arrays["vec & tor"];
    assert_eq!((vector.component_count, vector.values.len()), (3, 48));
    let expected: Vec<f64> =
        (0..16).map(|i| (0..3).map(|c| (f64::from(3 * i + c) * 0.5).powi(2)).sum::<f64>().sqrt()).collect();
    let scalar = grid.scalar.as_ref().unwrap();
    // The length is scaled against overflow, which costs a rounding or two.
    assert!(scalar.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 4.0 * f64::EPSILON * b), "{scalar:?}");
    assert_eq!(grid.point_arrays["Int16"].values[7], -7.0);
    assert_eq!(
        grid.point_arrays["vec & tor:2"].values,
        (0..16).map(|i| f64::from(3 * i + 2) * 0.5).collect::<Vec<_>>()
    );
    assert_eq!(grid.point_arrays["cell"].values.len(), 16);
    assert_eq!(grid.origin.arrays_unread.len(), 9);
}

#[test]
fn cell_arrays_are_found_by_association_and_kept_constant_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "grid.vtu", &unstructured(encodings()[4], 3, false));
    let request =
        |association| Request { scalar: Some("cell".to_owned()), association, ..Request::default() };
    assert!(read(&path, &request(None), &NoProgress).is_ok());
    let error = read(&path, &request(Some(Association::Point)), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("an array of the cells, not of the points"), "{error}");
    let mut constant = request(Some(Association::Cell));
    constant.options.cell_values = voltet_io::formats::CellValues::Constant;
    let grid = read(&path, &constant, &NoProgress).unwrap();
    for (cell, corners) in grid.tetrahedra.iter().enumerate() {
        assert!(corners.iter().all(|&c| grid.scalar.as_ref().unwrap()[c as usize] == cell as f64));
    }
}

#[test]
fn structured_formats_read_the_same_in_every_encoding() {
    let folder = tempfile::tempdir().unwrap();
    let mut first: Option<Grid> = None;
    for kind in ["StructuredGrid", "RectilinearGrid", "ImageData"] {
        for encoding in encodings() {
            let path = file(&folder, "grid", &structured(kind, encoding));
            let request = Request::default();
            let grid = read(&path, &request, &NoProgress)
                .unwrap_or_else(|error| panic!("{error} {kind} {encoding:?}"));
            let first = first.get_or_insert_with(|| grid.clone());
            assert_eq!(grid.points, first.points, "{kind} {encoding:?}");
            assert_eq!(grid.tetrahedra, first.tetrahedra, "{kind} {encoding:?}");
            for (point, scalar) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
                assert_eq!(*scalar, point.x + 2.0 * point.y + 3.0 * point.z);
            }
        }
        let path = file(&folder, "grid", &structured(kind, encodings()[0]));
        let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
        let code = if kind == "StructuredGrid" { 12 } else { 11 };
        assert_eq!(summary.cells_by_type.into_iter().collect::<Vec<_>>(), [(code, 24)]);
    }
}
