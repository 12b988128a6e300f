//! What programs write that differ from VTK: marks and encodings of text, separators of paths, series of files, times within a file,
//! names of components, and the former order of two edges.

use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, files_beside, inspect, read};
use voltet_testing::files::samples::{file, unstructured};
use voltet_testing::files::xml::{Mode, encodings};

fn of(path: &std::path::Path, request: Request) -> Grid {
    read(path, &request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

fn named(scalar: &str) -> Request {
    Request { scalar: Some(scalar.into()), ..Request::default() }
}

#[test]
fn a_byte_order_mark_and_latin_letters_move_no_data() {
    let folder = tempfile::tempdir().unwrap();
    for encoding in encodings() {
        let plain = unstructured(encoding, 2, false);
        let expected = of(&file(&folder, "plain.vtu", &plain), named("Float64"));
        let marked = [b"\xEF\xBB\xBF", &plain[..]].concat();
        let found = of(&file(&folder, "marked.vtu", &marked), named("Float64"));
        assert_eq!((found.tetrahedra, found.scalar), (expected.tetrahedra.clone(), expected.scalar.clone()));
        // "é" is a byte before the data.
        let name = b"Name=\"Float64\"";
        let at = plain.windows(name.len()).position(|window| window == name).unwrap();
        let latin = [&plain[..at], b"Name=\"pr\xE9cis\"", &plain[at + name.len()..]].concat();
        let declared = b"<?xml version=\"1.0\"?>".len();
        let latin = [b"<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>", &latin[declared..]].concat();
        let found = of(&file(&folder, "latin.vtu", &latin), named("précis"));
        assert_eq!((found.tetrahedra, found.scalar), (expected.tetrahedra, expected.scalar), "{encoding:?}");
    }
}

#[test]
fn text_of_two_bytes_a_character_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let ascii = encodings().into_iter().find(|encoding| encoding.mode == Mode::Ascii).unwrap();
    let text = String::from_utf8(unstructured(ascii, 2, true)).unwrap().replace('\n', "\r\n");
    let expected = of(&file(&folder, "plain.vtu", text.as_bytes()), named("Float32"));
    let orders: [fn(u16) -> [u8; 2]; 2] = [u16::to_le_bytes, u16::to_be_bytes];
    for (mark, bytes) in orders.into_iter().flat_map(|order| [("\u{feff}", order), ("", order)]) {
        let wide: Vec<u8> = (mark.to_owned() + &text).encode_utf16().flat_map(bytes).collect();
        let found = of(&file(&folder, "wide.vtu", &wide), named("Float32"));
        assert_eq!((found.tetrahedra, found.scalar), (expected.tetrahedra.clone(), expected.scalar.clone()));
    }
    let broken = file(&folder, "broken.vtu", b"\xFF\xFE<\0\0\xD8");
    let error = read(&broken, &named("Float32"), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("UTF-16") && error.contains("broken.vtu"), "{error}");
}

#[test]
fn series_of_files_are_read_by_step_and_time() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("steps")).unwrap();
    for cubes in 1..=2 {
        file(&folder, &format!("steps/{cubes}.vtu"), &unstructured(encodings()[0], cubes, false));
    }
    let series = r#"{ "file-series-version" : "1.0", "files" : [
        { "name" : "steps\\2.vtu", "time" : 0.5 }, { "name" : "steps/1.vtu", "time" : 0 }] }"#;
    let marked = file(&folder, "marked.vtu.series", format!("\u{feff}{series}").as_bytes());
    assert_eq!((of(&marked, named("Int8")).tetrahedra.len(), files_beside(&marked).len()), (6, 2));
    let path = file(&folder, "a.vtu.series", series.as_bytes());
    let cells = |time_step| of(&path, Request { time_step, ..named("Int8") }).tetrahedra.len();
    assert_eq!((cells(None), cells(Some(TimeStep::Index(1))), cells(Some(TimeStep::Time(0.4)))), (6, 12, 12));
    assert_eq!(inspect(&path, &Request::default(), &NoProgress).unwrap().time_steps, [0.0, 0.5]);
    assert_eq!(files_beside(&path).len(), 2);
    let back = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"steps\\2.vtu\"/></Collection></VTKFile>";
    assert_eq!(of(&file(&folder, "a.pvd", back.as_bytes()), named("Int8")).tetrahedra.len(), 12);
    // Written by hand, without a version and times.
    let bare = file(&folder, "bare.vtu.series", br#"{"files": [{"name": "steps/1.vtu"}]}"#);
    assert_eq!(of(&bare, named("Int8")).tetrahedra.len(), 6);
    for (wrong, words) in [
        (r#"{"file-series-version":"1.0","files":[]}"#, "at least one file"),
        (r#"{"file-series-version":"1.0"}"#, "damaged"),
        (r#"{"file-series-version":"1.0","files":[{"name":"a.vtu.series","time":0}]}"#, "names another"),
        (r#"{"file-series-version":"1.0","files":[{"name":"none.vtu","time":0}]}"#, "a.vtu.series' names"),
        ("[", "damaged"),
    ] {
        let path = file(&folder, "a.vtu.series", wrong.as_bytes());
        let error = read(&path, &named("Int8"), &NoProgress).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_file_may_hold_several_times_and_say_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(unstructured(encodings()[0], 1, false)).unwrap();
    let array = |step: u32| {
        format!(
            "<DataArray type=\"Float64\" Name=\"T\" TimeStep=\"{step}\" format=\"ascii\">{}</DataArray>",
            format!("{step} ").repeat(8)
        )
    };
    let of_times = text
        .replacen("<UnstructuredGrid>", "<UnstructuredGrid TimeValues=\"0.5 1.5\">", 1)
        .replacen("<PointData>", &format!("<PointData>{}{}", array(0), array(1)), 1);
    let path = file(&folder, "times.vtu", of_times.as_bytes());
    for step in 0..2 {
        let grid = of(&path, Request { time_step: Some(TimeStep::Index(step)), ..named("T") });
        assert!(grid.scalar.unwrap().iter().all(|&value| value == step as f64));
    }
    assert_eq!(inspect(&path, &Request::default(), &NoProgress).unwrap().time_steps, [0.5, 1.5]);
    let field = "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.25</DataArray>";
    let path = file(&folder, "time.vtu", text.replacen("<FieldData>", field, 1).as_bytes());
    assert_eq!(inspect(&path, &Request::default(), &NoProgress).unwrap().time, Some(0.25));
}

#[test]
fn components_have_the_names_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(unstructured(encodings()[0], 1, false)).unwrap();
    let names = "Name=\"vec &amp; tor\" ComponentName0=\"X\" ComponentName1=\"Y\" ComponentName2=\"Z\"";
    let path = file(&folder, "names.vtu", text.replacen("Name=\"vec &amp; tor\"", names, 1).as_bytes());
    assert_eq!(of(&path, named("vec & tor:Y")).scalar, of(&path, named("vec & tor:1")).scalar);
    let error = read(&path, &named("vec & tor:W"), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("'X', 'Y', 'Z', 'magnitude' or 0 to 2"), "{error}");
}

/// A quadratic hexahedron with straight edges and the sum of the coordinates, its vertical edges 10 and 11 in either order.
fn hexahedron(version: &str, is_old: bool) -> String {
    let mut places: Vec<[usize; 3]> = Vec::new();
    let corner = |c: usize| [[0, 0], [2, 0], [2, 2], [0, 2]].map(|[i, j]| [i, j, c / 4 * 2])[c % 4];
    let middle = |a: [usize; 3], b: [usize; 3]| std::array::from_fn(|k| (a[k] + b[k]) / 2);
    places.extend((0..8).map(corner));
    for level in [0, 4] {
        let edges = [(0, 1), (1, 2), (3, 2), (0, 3)];
        places.extend(edges.map(|(a, b)| middle(corner(level + a), corner(level + b))));
    }
    places.extend((0..4).map(|c| middle(corner(c), corner(c + 4))));
    places.extend([[0, 1, 1], [2, 1, 1], [1, 0, 1], [1, 2, 1], [1, 1, 0], [1, 1, 2], [1, 1, 1]]);
    let mut order: Vec<usize> = (0..27).collect();
    if is_old {
        order.swap(18, 19);
    }
    let words =
        |numbers: &mut dyn Iterator<Item = usize>| numbers.map(|n| format!("{n} ")).collect::<String>();
    format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"{version}\"><UnstructuredGrid><Piece NumberOfPoints=\"27\" NumberOfCells=\"1\">\
         <PointData><DataArray type=\"Float64\" Name=\"s\">{}</DataArray></PointData>\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">{}</DataArray></Points>\
         <Cells><DataArray type=\"Int64\" Name=\"connectivity\">{}</DataArray>\
         <DataArray type=\"Int64\" Name=\"offsets\">27</DataArray><DataArray type=\"UInt8\" Name=\"types\">72</DataArray></Cells>\
         </Piece></UnstructuredGrid></VTKFile>",
        words(&mut places.iter().map(|place| place.iter().sum())),
        words(&mut places.iter().flatten().copied()),
        words(&mut order.into_iter()),
    )
}

#[test]
fn edges_of_higher_order_are_those_of_the_version_unless_it_folds_the_cell() {
    let folder = tempfile::tempdir().unwrap();
    let volume = |grid: &Grid| {
        (0..grid.tetrahedra.len())
            .map(|i| voltet_core::grid::tetrahedron_volume(grid.corners(i)))
            .sum::<f64>()
    };
    for (version, is_old, is_said) in [
        ("2.2", false, false),
        ("1.0", true, false),
        ("0.1", true, false),
        ("1.0", false, true),
        ("2.1", true, true),
    ] {
        let path = file(&folder, "a.vtu", hexahedron(version, is_old).as_bytes());
        let grid = of(&path, named("s"));
        // Folded, tetrahedra overlap and their volumes add up to more.
        assert!((volume(&grid) - 8.0).abs() < 1e-12, "{version} {is_old}: {}", volume(&grid));
        let sums = grid.points.iter().map(|p| p.element_sum());
        assert!(sums.zip(grid.scalar.as_ref().unwrap()).all(|(sum, &s)| sum == s));
        let said = grid.origin.warnings.iter().any(|warning| warning.contains("would be folded"));
        assert_eq!(said, is_said, "{version} {is_old}: {:?}", grid.origin.warnings);
    }
}
