//! A grid in every encoding of the XML formats reads as one grid.

use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, Request, inspect, piece_sizes, read};
use voltet_testing::files::samples::{TYPES, file, structured, unstructured};
use voltet_testing::files::xml::{Mode, encodings};

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
