//! Parts of the grids of files: what is drawn of all parts is what is drawn of the file, with its values and gradients.

use super::packed::{self, MemoryLeft};
use std::path::{Path, PathBuf};
use voltet_core::field::{GradientFilter, LeastSquares, QuadraticFit};
use voltet_core::grid::Grid;
use voltet_core::parameters::Parameters;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{
    Association, CellValues, Options, Request, TimeStep, arrays, piece_borders, piece_sizes, read, read_part,
};
use voltet_testing::files::samples::file;

/// Positions of the corners of a tetrahedron, ascending, and all values there.
type Tetrahedron = (Vec<[u64; 3]>, Vec<Vec<f64>>);

/// What is drawn of a grid, with gradients by filters.
fn drawn(grid: &Grid, filters: &[&dyn GradientFilter]) -> Vec<Tetrahedron> {
    let scalar = grid.scalar.as_ref().unwrap();
    let with_ghosts = grid.with_ghosts();
    let mut columns: Vec<Vec<f64>> = vec![scalar.to_vec()];
    for filter in filters {
        let found = filter.gradient(&with_ghosts, scalar, &Parameters::default(), &NoProgress).unwrap();
        (0..3).for_each(|axis| columns.push(found.vectors.iter().map(|vector| vector[axis]).collect()));
    }
    let of = |corners: &[u32; 4]| {
        let corner = |&p: &u32| {
            let place = grid.points[p as usize].to_array().map(f64::to_bits);
            (place, columns.iter().map(|column| column[p as usize]).collect::<Vec<f64>>())
        };
        let mut corners: Vec<_> = corners.iter().map(corner).collect();
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        corners.into_iter().unzip()
    };
    let mut all: Vec<Tetrahedron> = grid.tetrahedra.iter().map(of).collect();
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

/// The grids of groups of pieces.
fn parts(path: &Path, request: &Request, layers: usize, groups: usize) -> Vec<Grid> {
    let count = piece_sizes(path, request).unwrap().len();
    // The first part is made of pieces that are kept, the others are read.
    let first: Vec<usize> = (0..count).step_by(groups).collect();
    let borders = piece_borders(path, request, layers, &first, None, &NoProgress).unwrap();
    let part = |group: usize| {
        let own: Vec<usize> = (group..count).step_by(groups).collect();
        read_part(path, request, &own, &borders, &NoProgress).unwrap()
    };
    (0..groups).filter_map(part).collect()
}

/// Compares the parts of a file with all of it; gives the number of parts with something to draw.
fn assert_parts_are_the_file(path: &Path, request: &Request) -> usize {
    let whole = read(path, request, &NoProgress).unwrap();
    let count = piece_sizes(path, request).unwrap().len();
    let mut most = 0;
    for groups in [count, 2] {
        let filters: [&[&dyn GradientFilter]; 3] = [&[], &[&LeastSquares], &[&QuadraticFit]];
        for (rings, filters) in filters.into_iter().enumerate() {
            let parts = parts(path, request, rings, groups);
            let what = format!("{}, {:?}, {groups} groups, {rings} rings", path.display(), request.scalar);
            let expected = drawn(&whole, filters);
            let mut found: Vec<Tetrahedron> = parts.iter().flat_map(|part| drawn(part, filters)).collect();
            found.sort_by(|a, b| a.partial_cmp(b).unwrap());
            assert_eq!(found.len(), expected.len(), "{what}");
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found.0, expected.0, "{what}: another tetrahedron");
                let scale = expected.1.iter().flatten().fold(0.0_f64, |scale, value| scale.max(value.abs()));
                for (found, expected) in found.1.iter().flatten().zip(expected.1.iter().flatten()) {
                    // Sums over neighbours in another order.
                    assert!((found - expected).abs() <= 1e-12 * scale, "{what}: {found} for {expected}");
                }
            }
            let sentences: Vec<&String> = parts.iter().flat_map(|part| &part.origin.warnings).collect();
            for sentence in sentences.iter().filter(|sentence| !sentence.contains("overlap")) {
                assert!(whole.origin.warnings.contains(sentence), "{what}: {sentence}");
            }
            most = most.max(parts.len());
        }
    }
    most
}

#[test]
fn parts_of_files_of_several_formats_are_the_file() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    let ten = Some(TimeStep::Time(10.0));
    let files: [(PathBuf, Option<TimeStep>); 11] = [
        (packed::path("vtkhdf_partitions.vtkhdf"), None),
        (packed::path("vtkhdf_collection.vtkhdf"), None),
        (packed::path("vtkhdf_blocks.vtkhdf"), None),
        (packed::path("exodus_row.e.2.0"), None),
        (packed::path("cgns_zones.cgns"), None),
        (packed::path("cgns_mixed.cgns"), None),
        (packed::path("xdmf_blocks.xdmf"), None),
        (folder.join("openfoam/decomposed"), ten),
        (folder.join("openfoam/collated_binary"), ten),
        (folder.join("ensight/parts.0.case"), None),
        (folder.join("tecplot_zones.vtu"), None),
    ];
    let mut compared = Vec::new();
    for (path, time_step) in files {
        let all = Request { time_step, ..Request::default() };
        let mut most = 0;
        for array in arrays(&path, &all).unwrap() {
            let scalar = match array.component_count {
                1 => array.name,
                _ => format!("{}:0", array.name),
            };
            let association = Some(array.association);
            let request = Request { scalar: Some(scalar), association, ..all.clone() };
            if read(&path, &request, &NoProgress).is_ok() {
                most = most.max(assert_parts_are_the_file(&path, &request));
            }
        }
        compared.push((path.file_name().unwrap().to_owned(), most));
    }
    assert!(compared.iter().filter(|file| file.1 > 1).count() > 5, "{compared:?}");
}

/// A box of jittered hexahedra in pieces, as a .vtu file; the first piece is a triangle of its surface.
fn box_in_pieces(owners: impl Fn([usize; 3]) -> usize, with_ids: bool, with_ghosts: bool) -> String {
    const N: usize = 5;
    let number = |[i, j, k]: [usize; 3]| i + (N + 1) * (j + (N + 1) * k);
    let all = |n: usize| (0..n * n * n).map(move |i| [i % n, i / n % n, i / n / n]);
    let corners = |[i, j, k]: [usize; 3]| {
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|[a, b, c]| number([i + a, j + b, k + c]))
    };
    let shift = |point: usize, axis: usize| ((point * 7919 + axis * 104_729) % 1009) as f64 / 1009.0 * 0.3;
    let mut text = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>".to_owned();
    // The first piece is a triangle on the surface.
    for piece in -1.. {
        let is_own = |cell: [usize; 3]| owners(cell) as i32 == piece;
        let own = if piece < 0 { vec![[0; 3]] } else { all(N).filter(|&cell| is_own(cell)).collect() };
        if own.is_empty() {
            break;
        }
        let corners = |cell: [usize; 3]| match piece {
            ..0 => corners(cell)[..3].to_vec(),
            _ => corners(cell).to_vec(),
        };
        let mut used: Vec<usize> = own.iter().flat_map(|&cell| corners(cell)).collect();
        used.sort_unstable();
        used.dedup();
        let is_near = |&cell: &[usize; 3]| corners(cell).iter().any(|p| used.binary_search(p).is_ok());
        let ghosts: Vec<[usize; 3]> =
            all(N).filter(|cell| with_ghosts && piece >= 0 && !is_own(*cell) && is_near(cell)).collect();
        let cells: Vec<[usize; 3]> = own.iter().chain(&ghosts).copied().collect();
        let mut used: Vec<usize> = cells.iter().flat_map(|&cell| corners(cell)).collect();
        used.sort_unstable();
        used.dedup();
        let array = |name: &str, kind: &str, components: usize, values: Vec<String>| {
            let values = values.join(" ");
            format!(
                "<DataArray Name=\"{name}\" type=\"{kind}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
            )
        };
        let position = |&p: &usize| {
            let at = [p % (N + 1), p / (N + 1) % (N + 1), p / (N + 1) / (N + 1)];
            [0, 1, 2].map(|axis| (at[axis] as f64 + shift(p, axis)).to_string()).join(" ")
        };
        let ids = used.iter().map(|p| (p * 3).to_string()).collect();
        let ids = if with_ids { array("GlobalPointIds", "Int64", 1, ids) } else { String::new() };
        let flags = (0..cells.len()).map(|cell| u8::from(cell >= own.len()).to_string()).collect();
        let flags = if with_ghosts { array("vtkGhostType", "UInt8", 1, flags) } else { String::new() };
        let (size, code) = if piece < 0 { (3, "5") } else { (8, "12") };
        let connectivity = cells.iter().flat_map(|&cell| corners(cell));
        let connectivity = connectivity.map(|p| used.binary_search(&p).unwrap().to_string()).collect();
        let at_points = used.iter().map(|&p| (p as f64 * 0.37).sin().to_string()).collect();
        let at_cells = cells.iter().map(|&[i, j, k]| ((i * i + 2 * j + 3 * k) as f64).sin().to_string());
        text += &format!(
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"><PointData>{}{ids}</PointData><CellData>{}{flags}</CellData>\
             <Points>{}</Points><Cells>{}{}{}</Cells></Piece>",
            used.len(),
            cells.len(),
            array("p", "Float64", 1, at_points),
            array("c", "Float64", 1, at_cells.collect()),
            array("points", "Float64", 3, used.iter().map(position).collect()),
            array("connectivity", "Int64", 1, connectivity),
            array("offsets", "Int64", 1, (1..=cells.len()).map(|end| (end * size).to_string()).collect()),
            array("types", "UInt8", 1, vec![code.to_owned(); cells.len()]),
        );
    }
    text + "</UnstructuredGrid></VTKFile>"
}

#[test]
fn parts_of_a_box_are_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let slabs = |[i, _, _]: [usize; 3]| i / 2;
    let scattered = |[i, j, k]: [usize; 3]| (7 * i + 5 * j * j + 3 * k) % 4;
    for case in 0..8 {
        let (with_ids, with_ghosts) = (case & 1 > 0, case & 2 > 0);
        let text = match case & 4 {
            0 => box_in_pieces(slabs, with_ids, with_ghosts),
            _ => box_in_pieces(scattered, with_ids, with_ghosts),
        };
        let path = file(&folder, "box.vtu", text.as_bytes());
        let sizes = piece_sizes(&path, &Request::default()).unwrap();
        // Text does not tell the corners of a cell before it is read: one of an unknown kind counts as a hexahedron.
        assert_eq!((sizes[0].points, sizes[0].tetrahedra), (3, 6));
        for (scalar, association) in [("p", Association::Point), ("c", Association::Cell)] {
            let request =
                Request { scalar: Some(scalar.into()), association: Some(association), ..Request::default() };
            assert_eq!(assert_parts_are_the_file(&path, &request), sizes.len() - 1);
        }
        // Cells that keep their values have no neighbours.
        let options = Options { cell_values: CellValues::Constant, ..Options::default() };
        let request = Request { scalar: Some("c".into()), options, ..Request::default() };
        let whole = read(&path, &request, &NoProgress).unwrap();
        let found: usize = parts(&path, &request, 0, 3).iter().map(|part| part.tetrahedra.len()).sum();
        assert_eq!(found, whole.tetrahedra.len());
    }
}

#[test]
fn pieces_that_are_not_there_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "box.vtu", box_in_pieces(|[i, _, _]| i / 2, false, false).as_bytes());
    let request = Request { scalar: Some("p".into()), ..Request::default() };
    let borders = piece_borders(&path, &request, 1, &[], None, &NoProgress).unwrap();
    assert!(borders.byte_count() > 0);
    assert!(read_part(&path, &request, &[0], &borders, &NoProgress).unwrap().is_none());
    assert!(read_part(&path, &request, &[], &borders, &NoProgress).unwrap().is_none());
    let error = read_part(&path, &request, &[1, 4], &borders, &NoProgress).unwrap_err().to_string();
    for words in ["no such piece", "4", "a number below 4", "box.vtu"] {
        assert!(error.contains(words), "{error}");
    }
    let other = file(&folder, "other.vtu", box_in_pieces(|_| 0, false, false).as_bytes());
    let error = read_part(&other, &request, &[1], &borders, &NoProgress).unwrap_err().to_string();
    assert!(error.contains("borders are those of another file") && error.contains("2 pieces"), "{error}");
}

/// Values at points need no cells of other pieces; gradients and means of cell values do.
#[test]
fn cells_near_the_borders_are_kept_where_values_look_at_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "box.vtu", box_in_pieces(|[i, _, _]| i / 2, false, false).as_bytes());
    let bytes = |scalar: &str, layers: usize| {
        let request = Request { scalar: Some(scalar.into()), ..Request::default() };
        let borders = piece_borders(&path, &request, layers, &[], None, &NoProgress).unwrap();
        let part = read_part(&path, &request, &[1], &borders, &NoProgress).unwrap().unwrap();
        (borders.byte_count(), part.ghosts.is_some())
    };
    let (plain, has_ghosts) = bytes("p", 0);
    assert!(!has_ghosts);
    for (scalar, layers) in [("p", 1), ("c", 0)] {
        let (with_cells, has_ghosts) = bytes(scalar, layers);
        assert!(has_ghosts && with_cells > plain, "{scalar}, {layers} layers: {with_cells} bytes");
    }
}

#[test]
fn ids_that_are_not_one_a_point_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let request = Request { scalar: Some("p".into()), ..Request::default() };
    let head = "Name=\"GlobalPointIds\" type=\"Int64\" NumberOfComponents=\"1\" format=\"ascii\">";
    for with_ghosts in [false, true] {
        let sound = box_in_pieces(|[i, _, _]| i / 2, true, with_ghosts);
        // More ids; a point's id that stands twice is shared, too.
        let damaged = sound.replace(head, &format!("{head}0 3 6 "));
        assert_ne!(sound, damaged);
        let path = file(&folder, "box.vtu", damaged.as_bytes());
        for first in [&[][..], &[0, 1, 2, 3]] {
            let parts = piece_borders(&path, &request, 1, first, None, &NoProgress)
                .and_then(|borders| read_part(&path, &request, &[1], &borders, &NoProgress));
            let error = parts.map(drop).unwrap_err().to_string();
            assert!(error.contains("box.vtu"), "{error}");
        }
    }
}

#[test]
fn memory_is_checked_before_keys_of_points_are_compared_and_sent() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "box.vtu", box_in_pieces(|[i, _, _]| i / 2, true, false).as_bytes());
    let request = Request { scalar: Some("p".into()), ..Request::default() };
    let refused = |bytes: u64| {
        let borders = piece_borders(&path, &request, 1, &[], None, &MemoryLeft(bytes));
        let error = borders.err().map(|error| error.to_string());
        error.filter(|error| error.contains("memory ends") && error.contains("291 points are at borders"))
    };
    // Three of the triangle, 6 × 6 in each of the planes of the slabs; 40 bytes each.
    let all = (3 + 36 * (3 + 3 + 2)) * 40;
    assert!(refused(all - 1).is_some());
    assert_eq!(refused(all), None);
}

#[test]
fn damage_is_an_error_or_another_grid() {
    let folder = tempfile::tempdir().unwrap();
    let request = Request { scalar: Some("p".into()), ..Request::default() };
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut errors, mut grids) = (0, 0);
    for case in 0..120 {
        let mut bytes = box_in_pieces(|[i, _, _]| i / 2, case & 1 > 0, case & 2 > 0).into_bytes();
        for _ in 0..1 + case % 3 {
            // Half of it in the connectivity and other numbers, the rest anywhere.
            let digits: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
            let place = if case & 4 > 0 { digits[random(digits.len())] } else { random(bytes.len()) };
            bytes[place] = b"0123456789 -n<"[random(14)];
        }
        let path = file(&folder, "box.vtu", &bytes);
        let of_parts =
            piece_borders(&path, &request, 2, &[case % 4], None, &NoProgress).and_then(|borders| {
                let count = piece_sizes(&path, &request)?.len();
                let part = |piece| read_part(&path, &request, &[piece], &borders, &NoProgress);
                (0..count).map(part).collect::<Result<Vec<_>, _>>()
            });
        match (read(&path, &request, &NoProgress), of_parts) {
            (Ok(whole), Ok(parts)) => {
                grids += 1;
                let found: usize = parts.iter().flatten().map(|part| part.tetrahedra.len()).sum();
                assert_eq!(found, whole.tetrahedra.len(), "case {case}");
            }
            (Err(_), parts) => errors += usize::from(parts.is_err()),
            (Ok(_), Err(error)) => panic!("case {case}: {error}"),
        }
    }
    assert!(errors > 5 && grids > 5, "{errors} errors and {grids} grids");
}
