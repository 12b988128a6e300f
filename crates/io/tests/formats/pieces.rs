//! Files of several pieces, ghost cells, time series, and the forms in which writers differ.

use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, inspect, read};
use voltet_testing::files::samples::{file, unstructured};
use voltet_testing::files::xml::{Encoding, encodings};

fn request(scalar: &str) -> Request {
    Request { scalar: Some(scalar.to_owned()), ..Request::default() }
}

fn ascii() -> Encoding {
    encodings()[0]
}

/// A row of three cubes with flags on its eighteen tetrahedra.
fn with_ghosts(flags: &str) -> Vec<u8> {
    let text = String::from_utf8(unstructured(ascii(), 3, false)).unwrap();
    text.replace("<CellData>", &format!("<CellData>{flags}")).into_bytes()
}

const GHOST_TYPE: &str = "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">\
    1 1 1 1 1 1 0 0 0 0 0 0 0 0 0 0 0 32</DataArray>";
const GHOST_LEVELS: &str = "<DataArray type=\"UInt8\" Name=\"vtkGhostLevels\" format=\"ascii\">\
    1 1 1 1 1 1 0 0 0 0 0 0 0 0 0 0 0 2</DataArray>";

#[test]
fn pieces_are_put_together_without_their_ghosts() {
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "a.vtu", &with_ghosts(GHOST_TYPE));
    file(&folder, "b.vtu", &with_ghosts(GHOST_LEVELS));
    file(&folder, "c.vtu", &unstructured(ascii(), 3, true));
    let parallel = |names: &[&str]| {
        let pieces: String = names.iter().map(|name| format!("<Piece Source=\"{name}\"/>")).collect();
        format!(
            "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\">{pieces}</PUnstructuredGrid></VTKFile>"
        )
    };
    let path = file(&folder, "ab.pvtu", parallel(&["a.vtu", "b.vtu"]).as_bytes());
    let grid = read(&path, &request("Int32"), &NoProgress).unwrap();
    assert_eq!((grid.tetrahedra.len(), grid.origin.cells_ghost), (22, 14));
    assert_eq!(grid.source_cells.as_ref().unwrap()[11], 18 + 6);
    let path = file(&folder, "abc.pvtu", parallel(&["a.vtu", "b.vtu", "c.vtu"]).as_bytes());
    let grid = read(&path, &request("cell"), &NoProgress).unwrap();
    assert_eq!((grid.tetrahedra.len(), grid.origin.cells_ghost), (22 + 18, 14));
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    assert_eq!((summary.piece_count, summary.point_count, summary.cell_count), (3, 48, 18 + 18 + 13));
    let path = file(&folder, "none.pvtu", parallel(&["a.vtu", "no.vtu"]).as_bytes());
    let error = read(&path, &request("cell"), &NoProgress).unwrap_err().to_string();
    for words in ["none.pvtu' names", "no such file", "no.vtu"] {
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn each_bit_of_ghost_types_leaves_out_what_it_does_in_vtk() {
    let folder = tempfile::tempdir().unwrap();
    // Eight cells; flags of the first cell, of the first point, and of that in the middle, which all cells have.
    let files = |cell: u8, point: u8, middle: u8| {
        let row = |count: usize, flags: &[(usize, u8)]| {
            let flag = |place: usize| flags.iter().find(|own| own.0 == place).map_or(0, |own| own.1);
            (0..count).map(|place| format!("{} ", flag(place))).collect::<String>()
        };
        let (cells, points) = (row(8, &[(0, cell)]), row(27, &[(0, point), (13, middle)]));
        let array = |flags: &str| {
            format!("<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">{flags}</DataArray>")
        };
        let values = (0..27).map(|value| format!("{value} ")).collect::<String>();
        let xml = format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 2 0 2\" Spacing=\"1 1 1\"><Piece Extent=\"0 2 0 2 0 2\">\
             <PointData><DataArray type=\"Float32\" Name=\"f\" format=\"ascii\">{values}</DataArray>{}</PointData>\
             <CellData>{}</CellData></Piece></ImageData></VTKFile>",
            array(&points),
            array(&cells)
        );
        let scalars = "SCALARS vtkGhostType unsigned_char\nLOOKUP_TABLE default\n";
        let legacy = format!(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\nORIGIN 0 0 0\nSPACING 1 1 1\n\
             CELL_DATA 8\n{scalars}{cells}\nPOINT_DATA 27\nSCALARS f float\nLOOKUP_TABLE default\n{values}\n{scalars}{points}\n"
        );
        [file(&folder, "a.vti", xml.as_bytes()), file(&folder, "a.vtk", legacy.as_bytes())]
    };
    for bit in (0..8).map(|bit| 1_u8 << bit) {
        // DUPLICATECELL, REFINEDCELL, HIDDENCELL; HIDDENPOINT.
        let by_cell = 8 - usize::from([1, 8, 32].contains(&bit));
        for (cell, point, drawn) in [(bit, 0, by_cell), (0, bit, 8 - usize::from(bit == 2))] {
            for path in files(cell, point, 0) {
                let grid = read(&path, &request("f"), &NoProgress).unwrap();
                assert_eq!(grid.tetrahedra.len(), 6 * drawn, "{bit}, {}", path.display());
            }
        }
    }
    // Bit 2 of a cell says nothing of it, but all of them are at a hidden point.
    for path in files(2, 0, 2) {
        let error = read(&path, &request("f"), &NoProgress).unwrap_err().to_string();
        assert!(error.contains("nothing to draw") && error.contains("8 ghosts or hidden"), "{error}");
        let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
        assert_eq!(summary.cell_count, 8);
        assert!(
            summary.damage.is_none()
                && summary.not_drawn.is_some_and(|why| why.contains("hidden (vtkGhostType)"))
        );
    }
}

#[test]
fn pieces_of_one_file_are_put_together() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(unstructured(ascii(), 3, false)).unwrap();
    let (begin, end) = (text.find("<Piece").unwrap(), text.find("</Piece>").unwrap() + "</Piece>".len());
    let empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\"/>\
        </Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\"/><DataArray type=\"Int32\" Name=\"offsets\"/>\
        <DataArray type=\"UInt8\" Name=\"types\"/></Cells></Piece>";
    let piece = &text[begin..end];
    // A process without cells may leave out all sections.
    let bare = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>";
    let all = format!("{}{empty}{bare}{piece}{bare}{piece}{}", &text[..begin], &text[end..]);
    let grid = read(&file(&folder, "a.vtu", all.as_bytes()), &request("Float64"), &NoProgress).unwrap();
    // The same points twice are one.
    assert_eq!((grid.points.len(), grid.tetrahedra.len()), (16, 36));
    assert_eq!(grid.origin.points_joined, 16);
    let none = format!("{}{bare}{}", &text[..begin], &text[end..]);
    let none = file(&folder, "none.vtu", none.as_bytes());
    let error = read(&none, &request("Float64"), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("no three-dimensional cells"), "{error}");
    assert_eq!(inspect(&none, &Request::default(), &NoProgress).unwrap().cell_count, 0);
    let other = piece.replace("Name=\"Float64\"", "Name=\"other\"");
    let all = format!("{}{piece}{other}{}", &text[..begin], &text[end..]);
    let error = read(&file(&folder, "a.vtu", all.as_bytes()), &request("Float64"), &NoProgress)
        .unwrap_err()
        .to_string();
    assert!(error.contains("lacks the array 'Float64'"), "{error}");
}

#[test]
fn steps_of_a_series_are_chosen_by_number_or_time() {
    let folder = tempfile::tempdir().unwrap();
    for cubes in 1..=3 {
        file(&folder, &format!("{cubes}.vtu"), &unstructured(ascii(), cubes, false));
    }
    let series = "<VTKFile type=\"Collection\"><Collection>\
        <DataSet timestep=\"0.5\" part=\"0\" file=\"2.vtu\"/><DataSet timestep=\"0\" file=\"1.vtu\"/>\
        <DataSet timestep=\"2\" part=\"0\" file=\"3.vtu\"/><DataSet timestep=\"2\" part=\"1\" file=\"1.vtu\"/>\
        </Collection></VTKFile>";
    let path = file(&folder, "a.pvd", series.as_bytes());
    let cells = |time_step| {
        read(&path, &Request { time_step, ..request("Int8") }, &NoProgress).map(|grid| grid.tetrahedra.len())
    };
    assert_eq!(cells(None).unwrap(), 6);
    assert_eq!(cells(Some(TimeStep::Index(1))).unwrap(), 12);
    assert_eq!(cells(Some(TimeStep::Index(2))).unwrap(), 24);
    assert_eq!(cells(Some(TimeStep::Time(0.6))).unwrap(), 12);
    assert_eq!(cells(Some(TimeStep::Time(2.0))).unwrap(), 24);
    let error = cells(Some(TimeStep::Index(3))).unwrap_err().to_string();
    assert!(error.contains("no such step") && error.contains("0 to 2") && error.contains("a.pvd"), "{error}");
    let error = cells(Some(TimeStep::Time(7.0))).unwrap_err().to_string();
    assert!(error.contains("no such time") && error.contains("0 to 2"), "{error}");
    assert_eq!(inspect(&path, &Request::default(), &NoProgress).unwrap().time_steps, [0.0, 0.5, 2.0]);
}

#[test]
fn base64_headers_may_stand_alone_and_lines_may_be_broken() {
    let folder = tempfile::tempdir().unwrap();
    for encoding in encodings().into_iter().filter(|e| e.mode == voltet_testing::files::xml::Mode::Inline) {
        if encoding.compressor != voltet_testing::files::xml::Compressor::None {
            continue;
        }
        let text = String::from_utf8(unstructured(encoding, 3, false)).unwrap();
        let mut out = String::new();
        for line in text.lines() {
            let trimmed = line.trim();
            let is_data = !trimmed.is_empty() && !trimmed.contains('<');
            if !is_data {
                out += &format!("{line}\n");
                continue;
            }
            let bytes = base64_simd::STANDARD.decode_to_vec(trimmed).unwrap();
            let (header, data) = bytes.split_at(if encoding.wide_headers { 8 } else { 4 });
            let text = base64_simd::STANDARD.encode_to_string(header)
                + &base64_simd::STANDARD.encode_to_string(data);
            for part in text.as_bytes().chunks(76) {
                out += &format!("   {}\n", std::str::from_utf8(part).unwrap());
            }
        }
        let path = file(&folder, "a.vtu", out.as_bytes());
        let grid = read(&path, &request("Float64"), &NoProgress).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((grid.tetrahedra.len(), grid.scalar.as_ref().unwrap()[7]), (18, -7.0));
    }
}

#[test]
fn offsets_may_begin_with_zero_and_text_may_hold_nan() {
    let folder = tempfile::tempdir().unwrap();
    for mixed in [false, true] {
        let text = String::from_utf8(unstructured(ascii(), 2, mixed)).unwrap();
        let text = text
            .replace("\n4 8 12", "\n0 4 8 12")
            .replace("-0 -1 -2", "-nan(ind) -1 -2")
            .replace("-9 -10 -11", "1D1 +2.5 -11");
        let path = file(&folder, "a.vtu", text.as_bytes());
        let grid = read(&path, &request("Float64"), &NoProgress).unwrap_or_else(|error| panic!("{error}"));
        let scalar = grid.scalar.as_ref().unwrap();
        assert!(
            grid.origin.cells_not_finite > 0 && scalar.contains(&10.0) && scalar.contains(&2.5),
            "{scalar:?}"
        );
    }
}

#[test]
fn what_a_file_cannot_have_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.vtu", &unstructured(ascii(), 2, false));
    let error = |request: Request| read(&path, &request, &NoProgress).unwrap_err().to_string();
    let step = error(Request { time_step: Some(TimeStep::Index(2)), ..request("Int8") });
    assert!(step.contains("no time series") && step.contains("step 2"), "{step}");
    let solution = error(Request { solution: Some("a.q".into()), ..request("Int8") });
    assert!(solution.contains("a PLOT3D grid, or no solution") && solution.contains("a.vtu"), "{solution}");
    let first = Request { time_step: Some(TimeStep::Index(0)), ..request("Int8") };
    assert!(read(&path, &first, &NoProgress).is_ok());
}
