//! Legacy files: every kind of data set, attribute and number, ASCII and binary.

use crate::encodings::grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, Request, inspect, read};
use voltet_testing::files::legacy::{LEGACY_TYPES, LegacyWriter, points, structured, unstructured, value};
use voltet_testing::files::samples::file;

#[test]
fn unstructured_grids_of_all_versions_read_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for version in ["2.0", "3.0", "4.2", "5.1"] {
        for binary in [false, true] {
            let bytes = unstructured(version, binary);
            // Text files may have the line ends of another system.
            let returned = String::from_utf8_lossy(&bytes).replace('\n', "\r\n").into_bytes();
            for bytes in if binary { vec![bytes] } else { vec![bytes, returned] } {
                let path = file(&folder, "a.vtk", &bytes);
                let what = format!("{version} binary {binary}");
                for (name, number_type) in LEGACY_TYPES {
                    let grid = grid(&path, name);
                    assert_eq!(
                        grid.points.iter().map(|p| p.to_array()).collect::<Vec<_>>(),
                        points(),
                        "{what}"
                    );
                    assert_eq!(grid.tetrahedra.len(), 13, "{what}");
                    let expected: Vec<f64> = (0..12).map(|i| value(number_type, i)).collect();
                    assert_eq!(**grid.scalar.as_ref().unwrap(), expected, "{what} {name}");
                }
                let scalar = |name: &str| grid(&path, name).scalar.unwrap()[5];
                assert_eq!(scalar("vector:2"), 17.0, "{what}");
                assert_eq!(scalar("normal:0"), 15.0, "{what}");
                assert_eq!(scalar("tensor:8"), 53.0, "{what}");
                assert_eq!(scalar("texture:1"), 11.0, "{what}");
                assert_eq!(scalar("in=field:1"), 11.0, "{what}");
                assert_eq!(scalar("colour:0"), 1.0, "{what}");
                assert_eq!([scalar("bits"), grid(&path, "bits").scalar.unwrap()[4]], [0.0, 1.0], "{what}");
                let cells = Request { association: Some(Association::Cell), ..Request::default() };
                assert_eq!(read(&path, &cells, &NoProgress).unwrap().scalar_name, "per cell");
                let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
                assert_eq!((summary.active_scalars.as_deref(), summary.time), (Some("per cell"), Some(1.5)));
                assert_eq!(summary.arrays.len(), LEGACY_TYPES.len() + 8, "{what}");
            }
        }
    }
}

#[test]
fn a_title_that_begins_another_format_is_a_title() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(unstructured("3.0", false)).unwrap();
    let title = text.lines().nth(1).unwrap();
    let titled = text.replacen(&format!("\n{title}\n"), "\nMeshVersionFormatted 2\n", 1);
    assert_ne!(titled, text);
    assert_eq!(grid(&file(&folder, "a.vtk", titled.as_bytes()), "double").tetrahedra.len(), 13);
    let medit = file(&folder, "a.mesh", b"# a\r\n\r\n MeshVersionFormatted 2\nDimension 3\n");
    let error = inspect(&medit, &Request::default(), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("a mesh of Medit") && error.contains("meshio"), "{error}");
}

#[test]
fn structured_kinds_read_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"] {
        for binary in [false, true] {
            let path = file(&folder, "a.vtk", &structured(kind, binary));
            let grid =
                read(&path, &Request::default(), &NoProgress).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(
                grid.points.iter().map(|p| p.to_array()).collect::<Vec<_>>(),
                points(),
                "{kind} {binary}"
            );
            assert_eq!(**grid.scalar.as_ref().unwrap(), (0..12).map(f64::from).collect::<Vec<_>>());
            assert_eq!(grid.tetrahedra.len(), 12);
        }
    }
}

#[test]
fn a_summary_says_what_is_damaged_and_counts_flat_cells() {
    let folder = tempfile::tempdir().unwrap();
    let of = |text: &str| {
        inspect(&file(&folder, "a.vtk", text.as_bytes()), &Request::default(), &NoProgress).unwrap()
    };
    let text = String::from_utf8(unstructured("3.0", false)).unwrap();
    let list = &text[text.find("CELLS").unwrap()..text.find("CELL_DATA").unwrap()];
    assert_eq!(of(&text).damage, None);
    for (sound, damaged, words) in [
        ("4 9", "4 12", "a point that its piece does not hold: found 12"),
        ("12 10", "12 99", "type: found 99"),
    ] {
        let wrong = list.split_ascii_whitespace().collect::<Vec<_>>().join(" ");
        let (at, _) = wrong.match_indices(sound).last().unwrap();
        let wrong = format!("{}{damaged}{}\n", &wrong[..at], &wrong[at + sound.len()..]);
        let damage = of(&text.replace(list, &wrong)).damage.unwrap();
        assert!(damage.contains(words), "{damage}");
    }
    let flat = String::from_utf8(structured("STRUCTURED_POINTS", false)).unwrap();
    let flat = of(&flat.replace("DIMENSIONS 3 2 2", "DIMENSIONS 12 1 1"));
    assert_eq!((flat.cell_count, flat.cells_by_type[&3]), (11, 11));
}

#[test]
fn points_of_cells_beyond_those_of_their_type_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1 2 2 2\n\
        CELLS 2 CELLS_SIZE\nFIRST\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\nPOINT_DATA 6\nSCALARS f float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5\n";
    let of = |size: &str, first: &str| {
        let text = text.replace("CELLS_SIZE", size).replace("FIRST", first);
        read(&file(&folder, "a.vtk", text.as_bytes()), &Request::default(), &NoProgress)
    };
    let plain = of("10", "4 0 1 2 3").unwrap();
    let further = of("12", "6 0 1 2 3 4 4").unwrap();
    assert_eq!((&further.tetrahedra, &further.points), (&plain.tetrahedra, &plain.points));
    assert!(
        further.origin.warnings.iter().any(|own| own.contains("1 cell beyond")),
        "{:?}",
        further.origin.warnings
    );
    assert!(plain.origin.warnings.is_empty());
    let short = of("9", "3 0 1 2").unwrap_err().to_string();
    assert!(short.contains("wrong number of points") && short.contains("found 3"), "{short}");
    // So it is where offsets divide the points of cells that are all of one type.
    let array = |kind: &str, name: &str, numbers: &str| {
        format!("<DataArray type='{kind}' Name='{name}' format='ascii'>{numbers}</DataArray>")
    };
    let text = format!(
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='6' NumberOfCells='2'><PointData>{}</PointData><Points>{}</Points>\
         <Cells>{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        array("Float32", "f", "0 1 2 3 4 5"),
        array("Float32", "x' NumberOfComponents='3", "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1 2 2 2"),
        array("Int32", "connectivity", "0 1 2 3 4 4 1 2 3 4"),
        array("Int32", "offsets", "6 10"),
        array("UInt8", "types", "10 10"),
    );
    let divided = read(&file(&folder, "a.vtu", text.as_bytes()), &Request::default(), &NoProgress).unwrap();
    assert_eq!((&divided.tetrahedra, &divided.points), (&plain.tetrahedra, &plain.points));
    assert_eq!(divided.origin.warnings, further.origin.warnings);
}

#[test]
fn blanked_points_leave_out_their_cells() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(structured("STRUCTURED_GRID", false)).unwrap();
    let blanked =
        text.replace("POINT_DATA", "BLANKING 12 unsigned_char\n0 1 1 1 1 1 1 1 1 1 1 1\nPOINT_DATA");
    let grid = read(&file(&folder, "a.vtk", blanked.as_bytes()), &Request::default(), &NoProgress).unwrap();
    assert_eq!((grid.origin.cells_ghost, grid.tetrahedra.len()), (1, 6));
}

#[test]
fn files_of_another_writer_are_read() {
    use vtkio::model::{
        Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, Piece,
        UnstructuredGridPiece, Version, VertexNumbers, Vtk,
    };
    let scalars = DataArray {
        name: "s".to_owned(),
        elem: ElementType::Scalars { num_comp: 1, lookup_table: None },
        data: vec![1.0_f32, 2.0, 3.0, 4.0, 5.0].into(),
    };
    let piece = UnstructuredGridPiece {
        points: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0_f64].into(),
        cells: Cells {
            cell_verts: VertexNumbers::Legacy { num_cells: 2, vertices: vec![4, 0, 1, 2, 3, 4, 4, 3, 2, 1] },
            types: vec![CellType::Tetra; 2],
        },
        data: Attributes { point: vec![Attribute::DataArray(scalars)], cell: Vec::new() },
    };
    let vtk = Vtk {
        version: Version::new_legacy(4, 2),
        title: "another writer".to_owned(),
        byte_order: ByteOrder::BigEndian,
        file_path: None,
        data: DataSet::UnstructuredGrid { meta: None, pieces: vec![Piece::Inline(Box::new(piece))] },
    };
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    vtk.clone().write_legacy_ascii(&mut text).unwrap();
    let mut bytes = Vec::new();
    vtk.write_legacy(&mut bytes).unwrap();
    for bytes in [text.into_bytes(), bytes] {
        let grid = grid(&file(&folder, "a.vtk", &bytes), "s");
        assert_eq!(*grid.tetrahedra, [[0, 1, 2, 3], [1, 2, 3, 4]]);
        assert_eq!(**grid.scalar.as_ref().unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}

#[test]
fn mistakes_name_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let sound = String::from_utf8(unstructured("4.2", false)).unwrap();
    let message = |text: String| {
        let request = Request { scalar: Some("int".to_owned()), ..Request::default() };
        read(&file(&folder, "a.vtk", text.as_bytes()), &request, &NoProgress).unwrap_err().to_string()
    };
    let expect = |message: String, parts: &[&str]| {
        for part in parts {
            assert!(message.contains(part), "'{part}' is not in: {message}");
        }
    };
    expect(message(sound.replace("ASCII", "ASCI")), &["a.vtk:3", "'ASCI'", "ASCII or BINARY"]);
    expect(message(sound.replace("POINTS 12", "POYNTS 12")), &["unknown keyword", "'POYNTS'", "a.vtk:10"]);
    expect(message(sound.replace("12 float", "12 flaot")), &["'flaot'", "double", "a.vtk:10"]);
    expect(message(sound.replace("POINTS 12", "POINTS twelve")), &["'twelve'", "number of points"]);
    let end = format!("a.vtk:{}", sound.lines().count() + 1);
    expect(message(sound.replace("POINTS 12", "POINTS 999999999999999999")), &["'POINTS' ends early", &end]);
    let line = sound[..sound.find("SCALARS int").unwrap()].lines().count() + 1;
    for (wrong, what) in [
        ("SCALARS int int x\nLOOKUP_TABLE", "number of components of 'int'"),
        ("SCALARS int int 1\nLOOK", "do not name their look-up table"),
        ("SCALARS int int 1\nLOOKUP_TABLES", "do not name their look-up table"),
    ] {
        let text = sound.replace("SCALARS int int 1\nLOOKUP_TABLE", wrong);
        expect(message(text), &[what, &format!("a.vtk:{line}")]);
    }
    expect(
        message(sound.replace("POINT_DATA 12", "POINT_DATA 13")),
        &["does not fit the grid", "found 13", "12"],
    );
    expect(
        message(sound.replace("CELL_TYPES 3\n12 12 10", "CELL_TYPES 2\n12 12")),
        &["CELL_TYPES", "found 2", "3"],
    );
    expect(message(sound.replace("8 0 1 4 3", "9 0 1 4 3")), &["cell"]);
    expect(message(sound.replace("DATASET UNSTRUCTURED_GRID", "DATASET POLYDATA")), &["POLYDATA"]);
    expect(message(sound[..sound.len() / 2].to_owned()), &["ends early"]);
}

/// Words that no sound file has are refused before they fill a message.
#[test]
fn words_and_lines_without_an_end_are_too_long() {
    let folder = tempfile::tempdir().unwrap();
    let message = |bytes: &[u8]| {
        let path = file(&folder, "a.vtk", bytes);
        read(&path, &Request::default(), &NoProgress).unwrap_err().to_string()
    };
    // More values than the header counts.
    let mut bytes = structured("STRUCTURED_POINTS", true);
    bytes.resize(bytes.len() + (1 << 20), 0);
    let word = message(&bytes);
    assert!(word.contains("a word is too long") && word.len() < 300, "{} bytes", word.len());
    let title = format!("\n{}\nASCII", "x".repeat(1 << 15));
    let line = message(
        String::from_utf8_lossy(&structured("STRUCTURED_POINTS", false))
            .replacen("\na title: POINTS 3 float\nASCII", &title, 1)
            .as_bytes(),
    );
    assert!(line.contains("a line is too long") && line.len() < 300, "{} bytes", line.len());
}

/// Lengths of texts take 1, 2, 4 or 8 bytes.
#[test]
fn binary_texts_of_every_length_are_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let lengths = [
        (0_u64, 1),
        (0x3f, 1),
        (0x40, 2),
        (0x80, 2),
        (0x3fff, 2),
        (0x4000, 4),
        (0x12345, 4),
        (3, 4),
        (5, 8),
        (0x80, 8),
        (0x10203, 8),
        (7, 1),
    ];
    let mut out = LegacyWriter { binary: true, bytes: structured("STRUCTURED_POINTS", true) };
    out.line("FIELD field 2\nnames 1 12 string");
    let mut places = Vec::new();
    for (length, width) in lengths {
        let mark = [3_u64, 2, 1, 0][usize::from(width > 1) + usize::from(width > 2) + usize::from(width > 4)];
        let head = (length | mark << (8 * width - 2)).to_be_bytes();
        places.push((out.bytes.len(), width, length));
        out.bytes.extend(&head[8 - width..]);
        out.bytes.resize(out.bytes.len() + length as usize, b'\n');
    }
    out.line("after 1 12 float");
    out.values("Float32", (0..12).map(|i| f64::from(i) + 0.5));
    let after = grid(&file(&folder, "a.vtk", &out.bytes), "after").scalar.unwrap();
    assert!(after.iter().enumerate().all(|(i, &value)| value == i as f64 + 0.5), "{after:?}");
    let message = |end: usize| {
        let path = file(&folder, "a.vtk", &out.bytes[..end]);
        read(&path, &Request::default(), &NoProgress).unwrap_err().to_string()
    };
    for (begin, width, length) in places {
        let none = message(begin);
        assert!(none.contains("the file ends early") && none.contains("12 texts"), "{none}");
        for left in 1..width {
            let cut = message(begin + left);
            let found = if left == 2 { "found 1 byte;".into() } else { format!("found {} bytes;", left - 1) };
            assert!(cut.contains("the file ends early") && cut.contains(&found), "{left} of {width}: {cut}");
        }
        if length > 1 {
            let cut = message(begin + width + 1);
            assert!(cut.contains(&format!("found 1 byte; expected {length} bytes")), "{cut}");
        }
    }
}

/// Words lie across the ends of all that is read or counted at once, and the last one ends the file.
#[test]
fn long_text_arrays_are_passed_over_word_by_word() {
    let folder = tempfile::tempdir().unwrap();
    let count = 41 * 40 * 40;
    let words = |widths: usize| -> String {
        let word = |i: usize| {
            let width = if i % 5000 == 1 { 600 } else { i % widths };
            format!("{i:0width$}{}", [" ", "\n", "\r\n", " \t "][i % 7 % 4])
        };
        (0..count).map(word).collect()
    };
    for widths in [1, 8, 13] {
        let text = format!(
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 41 40 40\nORIGIN 0 0 0\nSPACING 1 1 1\n\
             POINT_DATA {count}\nSCALARS s double\nLOOKUP_TABLE default\n{}FIELD field 1\nafter 1 {count} int\n{}",
            words(widths),
            words(widths).trim_end()
        );
        assert!(!text.ends_with(char::is_whitespace) && text.len() > 2 * (1 << 18));
        let path = file(&folder, "a.vtk", text.as_bytes());
        for name in ["s", "after"] {
            let scalar = grid(&path, name).scalar.unwrap();
            assert!(scalar.iter().copied().eq((0..count).map(|i| i as f64)), "{name} {widths}");
        }
    }
}
