//! Cases of EnSight Gold: those of VTK's writer, and text and bytes written here after the manual.

use super::refusals::{refused, says};
use glam::DVec3;
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, Options};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, files_beside, files_read_beside, inspect, read};
use voltet_testing::files::samples::file;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/ensight").join(name)
}

/// The request for cells that keep their values.
fn request(scalar: &str) -> Request {
    let options = Options { cell_values: CellValues::Constant, ..Options::default() };
    Request { scalar: Some(scalar.to_owned()), options, ..Request::default() }
}

fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

/// Positions and values at the corners of the tetrahedra, in ascending order.
fn corners(grid: &Grid) -> Vec<Vec<[f64; 4]>> {
    let scalar = grid.scalar.as_ref().unwrap();
    let of = |tetrahedron: &[u32; 4]| {
        let mut corners = tetrahedron.map(|p| {
            let position = grid.points[p as usize];
            [position.x, position.y, position.z, scalar[p as usize]]
        });
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        corners.to_vec()
    };
    let mut all: Vec<Vec<[f64; 4]>> = grid.tetrahedra.iter().map(of).collect();
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

#[test]
fn vtks_writer_writes_the_same_as_vtu() {
    let case = sample("parts.0.case");
    for (found, expected) in [("f_n", "f"), ("p_n:2", "p:2"), ("g_c", "g")] {
        let (found, expected) =
            (grid(&case, &request(found)), grid(&sample("parts.vtu"), &request(expected)));
        assert_eq!(corners(&found), corners(&expected));
    }
    let summary = inspect(&case, &Request::default(), &NoProgress).unwrap();
    assert_eq!((summary.cell_count, summary.piece_count), (8, 2));
    assert_eq!(summary.blocks[1].name, "VTK Part (2)");
    let second = Request { blocks: vec![summary.blocks[1].name.clone()], ..request("g_c") };
    assert!(grid(&case, &second).scalar.unwrap().iter().all(|&g| g >= 4.0));
    assert_eq!([files_beside(&case), files_read_beside(&case, &second)].map(|files| files.len()), [4, 4]);
}

/// Lines and numbers of a file: text, or bytes of an order.
#[derive(Clone)]
struct Gold {
    bytes: Vec<u8>,
    big_endian: Option<bool>,
}

impl Gold {
    fn new(big_endian: Option<bool>) -> Gold {
        Gold { bytes: Vec::new(), big_endian }
    }

    fn line(mut self, text: &str) -> Gold {
        match self.big_endian {
            None => self.bytes.extend(format!("{text}\n").bytes()),
            Some(_) => self.bytes.extend(format!("{text:\0<80}").bytes()),
        }
        self
    }

    fn word(&mut self, text: String, mut little: [u8; 4]) {
        match self.big_endian {
            None => self.bytes.extend(text.bytes()),
            Some(big) => {
                if big {
                    little.reverse();
                }
                self.bytes.extend(little);
            }
        }
    }

    /// Numbers in a line.
    fn ints(mut self, values: &[i32]) -> Gold {
        values.iter().for_each(|&value| self.word(format!("{value:10}"), value.to_le_bytes()));
        if self.big_endian.is_none() {
            self.bytes.push(b'\n');
        }
        self
    }

    /// A number in each line.
    fn floats(mut self, values: &[f32]) -> Gold {
        values.iter().for_each(|&value| self.word(format!("{value:12.5e}\n"), value.to_le_bytes()));
        self
    }
}

/// A part of tetrahedra and triangles with ids, a surface, a polyhedron, and a structured block.
fn geometry(big_endian: Option<bool>, x: f32) -> Gold {
    let mut file = Gold::new(big_endian);
    if big_endian.is_some() {
        file = file.line("C Binary");
    }
    file.line("a geometry")
        .line("of four parts")
        .line("node id given")
        .line("element id ignore")
        .line("extents")
        .floats(&[0.0, 9.0, 0.0, 9.0, 0.0, 9.0])
        .line("part")
        .ints(&[3])
        .line("fluid")
        .line("coordinates")
        .ints(&[5])
        .ints(&[100, 200, 300, 400, 500])
        .floats(&[x, 1.0, 0.0, 0.0, 1.0])
        .floats(&[0.0, 0.0, 1.0, 0.0, 1.0])
        .floats(&[0.0, 0.0, 0.0, 1.0, 1.0])
        .line("tria3")
        .ints(&[1])
        .ints(&[7])
        .ints(&[1, 2, 3])
        .line("tetra4")
        .ints(&[2])
        .ints(&[8])
        .ints(&[9])
        .ints(&[1, 2, 3, 4])
        .ints(&[2, 3, 4, 5])
        .line("part")
        .ints(&[4])
        .line("wall")
        .line("coordinates")
        .ints(&[3])
        .ints(&[1, 2, 3])
        .floats(&[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        .line("nsided")
        .ints(&[1])
        .ints(&[1])
        .ints(&[3])
        .ints(&[1, 2, 3])
        .line("part")
        .ints(&[7])
        .line("solid")
        .line("coordinates")
        .ints(&[4])
        .ints(&[1, 2, 3, 4])
        .floats(&[5.0, 6.0, 5.0, 5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0])
        .line("nfaced")
        .ints(&[1])
        .ints(&[1])
        .ints(&[4])
        .ints(&[3, 3, 3, 3])
        .ints(&[1, 2, 3])
        .ints(&[1, 2, 4])
        .ints(&[2, 3, 4])
        .ints(&[1, 3, 4])
        .line("part")
        .ints(&[8])
        .line("box")
        .line("block")
        .ints(&[2, 2, 2])
        .floats(&[8.0, 9.0, 8.0, 9.0, 8.0, 9.0, 8.0, 9.0])
        .floats(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0])
        .floats(&[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
}

#[test]
fn blocks_of_every_form_have_the_same_points() {
    for big_endian in [None, Some(false), Some(true)] {
        let folder = tempfile::tempdir().unwrap();
        let start = || {
            let file =
                if big_endian.is_some() { Gold::new(big_endian).line("C Binary") } else { Gold::new(None) };
            let file = file.line("a box").line("in three forms").line("node id off").line("element id off");
            file.line("part").ints(&[5]).line("box")
        };
        let (x, y, z) = ([1.0, 1.5, 2.0], [-1.0, 0.0], [4.0, 4.25]);
        let mut points = Vec::new();
        for &z in &z {
            for &y in &y {
                points.extend(x.iter().map(|&x| [x, y, z]));
            }
        }
        let axis = |axis: usize| points.iter().map(|point| point[axis]).collect::<Vec<f32>>();
        let forms = [
            ("block curvilinear", [axis(0), axis(1), axis(2)].concat()),
            ("block rectilinear", [&x[..], &y, &z].concat()),
            ("block uniform", vec![1.0, -1.0, 4.0, 0.5, 1.0, 0.25]),
        ];
        let values: Vec<f32> = (0..12).map(|i| i as f32).collect();
        let scalar =
            Gold::new(big_endian).line("a scalar").line("part").ints(&[5]).line("block").floats(&values);
        file(&folder, "a.f", &scalar.bytes);
        let case = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: a.geo\nVARIABLE\nscalar per node: f a.f\n";
        let case = file(&folder, "a.case", case.as_bytes());
        let read_form = |form: &str, numbers: &[f32]| {
            file(&folder, "a.geo", &start().line(form).ints(&[3, 2, 2]).floats(numbers).bytes);
            read(&case, &request("f"), &NoProgress)
        };
        let expected: Vec<DVec3> = points.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        for (form, numbers) in &forms {
            let own = read_form(form, numbers).unwrap_or_else(|error| panic!("{form}: {error}"));
            assert_eq!(own.points.to_vec(), expected, "{form} {big_endian:?}");
            assert_eq!(own.scalar.unwrap().to_vec(), (0..12).map(f64::from).collect::<Vec<_>>(), "{form}");
        }
        let found = read_form("block uniform iblanked", &forms[2].1).unwrap_err().to_string();
        assert!(found.contains("'block uniform iblanked'") && found.contains("without blanking"), "{found}");
        // A head of a few bytes promises many points.
        for (n, words) in
            [(1 << 30, "cannot be that large"), (1 << 10, "than the files of the case can hold")]
        {
            let large = start().line("block uniform").ints(&[n]).ints(&[n]).ints(&[n]).floats(&forms[2].1);
            file(&folder, "a.geo", &large.bytes);
            let found = read(&case, &request("f"), &NoProgress).unwrap_err().to_string();
            assert!(found.contains(words), "{found}");
        }
        if big_endian.is_none() {
            let large = start().line("block rectilinear").line("18446744073709551615 1 1").floats(&x);
            file(&folder, "a.geo", &large.bytes);
            let found = read(&case, &request("f"), &NoProgress).unwrap_err().to_string();
            assert!(found.contains("a.geo"), "{found}");
        }
    }
}

/// A vector by node, the number of the part in its first component and that of the node in the last.
fn vector(big_endian: Option<bool>) -> Gold {
    let mut file = Gold::new(big_endian).line("a vector");
    for (part, count) in [(3, 5), (4, 3), (7, 4), (8, 8)] {
        file = file.line("part").ints(&[part]).line(if part == 8 { "block" } else { "coordinates" });
        let nodes: Vec<f32> = (0..count).map(|node| node as f32).collect();
        file = file.floats(&vec![part as f32; count]).floats(&vec![0.5; count]).floats(&nodes);
    }
    file
}

/// A scalar by element of two parts; that of the second tetrahedron is not defined.
fn scalar(big_endian: Option<bool>, factor: f32) -> Gold {
    Gold::new(big_endian)
        .line("a scalar")
        .line("part")
        .ints(&[3])
        .line("tria3")
        .floats(&[-1.0])
        .line("tetra4 undef")
        .floats(&[-99.0])
        .floats(&[factor, -99.0])
        .line("part")
        .ints(&[7])
        .line("nfaced")
        .floats(&[3.0 * factor])
}

const CASE: &str = "# a comment\nFORMAT\ntype:\tensight gold\n\nGEOMETRY\nmodel: 1 a.****.geo\nVARIABLE\nvector per node: U a.vec\n\
    scalar per element: 1 T \"a b.****\"\nconstant per case: c 4.0\nTIME\ntime set: 1\nnumber of steps: 2\n\
    filename start number: 5\nfilename increment: 10\ntime values: 0.5\n 2.5\n";

fn write_case(folder: &Path, big_endian: Option<bool>) -> PathBuf {
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    for (step, x, factor) in [("0005", 0.0, 1.0), ("0015", -1.0, 2.0)] {
        write(&format!("a.{step}.geo"), &geometry(big_endian, x).bytes);
        write(&format!("a b.{step}"), &scalar(big_endian, factor).bytes);
    }
    write("a.vec", &vector(big_endian).bytes);
    write("a.case", CASE.as_bytes());
    folder.join("a.case")
}

#[test]
fn text_and_bytes_of_either_order_read_the_same() {
    for big_endian in [None, Some(false), Some(true)] {
        let folder = tempfile::tempdir().unwrap();
        let path = write_case(folder.path(), big_endian);
        let what = format!("{big_endian:?}");
        let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
        let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
        assert_eq!((names, summary.time_steps), (vec!["fluid", "solid", "box"], vec![0.5, 2.5]), "{what}");
        assert_eq!(summary.warnings, ["Parts without cells of three dimensions are left out: 'wall'."]);
        let part = grid(&path, &request("U:0"));
        assert_eq!(part.tetrahedra.len(), 2 + 1 + 6, "{what}");
        for (p, &part) in part.points.iter().zip(part.scalar.as_ref().unwrap().iter()) {
            assert_eq!(
                part,
                if p.x < 4.0 {
                    3.0
                } else if p.x < 7.0 {
                    7.0
                } else {
                    8.0
                },
                "{what} {p}"
            );
        }
        let node = grid(&path, &Request { blocks: vec!["box".into()], ..request("U:2") });
        let number = |p: &DVec3| p.x - 8.0 + 2.0 * p.y + 4.0 * p.z;
        assert!(
            node.points.iter().zip(node.scalar.as_ref().unwrap().iter()).all(|(p, &node)| node == number(p))
        );
        // The box has no T, nor has the second tetrahedron.
        for (time_step, x, factor) in [(None, 0.0, 1.0), (Some(TimeStep::Time(2.5)), -1.0, 2.0)] {
            let load = grid(&path, &Request { time_step, ..request("T") });
            assert_eq!(load.tetrahedra.len(), 2, "{what}");
            assert_eq!(load.points.iter().map(|p| p.x).fold(9.0, f64::min), x, "{what}");
            let values = load.scalar.as_ref().unwrap();
            assert_eq!([values[0], values[4]], [factor, 3.0 * factor], "{what}");
            assert_eq!(load.origin.cells_not_finite, 2, "{what}");
        }
        assert_eq!(
            [files_beside(&path), files_read_beside(&path, &request("T"))].map(|files| files.len()),
            [5, 3]
        );
    }
}

/// Steps in one file, with the table of their places, of so many bytes each, at its end; 0: without.
fn steps_in_one(big_endian: Option<bool>, table: usize, head: &str, steps: &[Vec<u8>]) -> Vec<u8> {
    let line = |bytes: &mut Vec<u8>, text: &str| bytes.extend(Gold::new(big_endian).line(text).bytes);
    let (mut bytes, mut places) = (Vec::new(), Vec::new());
    if !head.is_empty() {
        line(&mut bytes, head);
    }
    for step in steps {
        places.push(bytes.len() as u64);
        line(&mut bytes, "BEGIN TIME STEP");
        bytes.extend(step);
        line(&mut bytes, "END TIME STEP");
    }
    if table > 0 {
        let number = |number: u64, len: usize| match big_endian {
            Some(true) => number.to_be_bytes()[8 - len..].to_vec(),
            _ => number.to_le_bytes()[..len].to_vec(),
        };
        let place = bytes.len() as u64;
        bytes.extend(number(steps.len() as u64, 4));
        places.into_iter().for_each(|place| bytes.extend(number(place, table)));
        bytes.extend(number(0, 4));
        bytes.extend(number(place, table));
        line(&mut bytes, "FILE_INDEX");
    }
    bytes
}

const CASE_OF_FILE_SETS: &str = "FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 1 one.geo\nVARIABLE\nvector per node: U a.vec\n\
    scalar per element: 1 2 T two**.T\nTIME\ntime set: 1\nnumber of steps: 3\ntime values: 0.5 1 2.5\n\
    FILE\nfile set: 1\nnumber of steps: 3\nfile set: 2\nfilename index: 4\nnumber of steps: 1\nfilename index: 5\nnumber of steps: 2\n";

fn write_file_sets(folder: &Path, big_endian: Option<bool>, table: usize) -> PathBuf {
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).unwrap();
    let first = if big_endian.is_some() { 80 } else { 0 };
    let geometries: Vec<Vec<u8>> =
        [0.0, -1.0, -2.0].map(|x| geometry(big_endian, x).bytes[first..].to_vec()).to_vec();
    let head = if big_endian.is_some() { "C Binary" } else { "" };
    write("one.geo", &steps_in_one(big_endian, table, head, &geometries));
    let values: Vec<Vec<u8>> = [1.0, 2.0, 3.0].map(|factor| scalar(big_endian, factor).bytes).to_vec();
    write("two04.T", &steps_in_one(big_endian, table, "", &values[..1]));
    write("two05.T", &steps_in_one(big_endian, table, "", &values[1..]));
    write("a.vec", &vector(big_endian).bytes);
    write("a.case", CASE_OF_FILE_SETS.as_bytes());
    folder.join("a.case")
}

#[test]
fn steps_may_stand_in_one_file() {
    // A table of places of four bytes is not read: the steps are looked for.
    let [little, big] = [Some(false), Some(true)];
    for (big_endian, table) in
        [(None, 0), (little, 8), (little, 4), (little, 0), (big, 8), (big, 4), (big, 0)]
    {
        let folder = tempfile::tempdir().unwrap();
        let path = write_file_sets(folder.path(), big_endian, table);
        let what = format!("{big_endian:?} {table}");
        assert_eq!(
            inspect(&path, &Request::default(), &NoProgress).unwrap().time_steps,
            [0.5, 1.0, 2.5],
            "{what}"
        );
        for (step, x) in [0.0, -1.0, -2.0].into_iter().enumerate() {
            let own = grid(&path, &Request { time_step: Some(TimeStep::Index(step)), ..request("T") });
            assert_eq!(own.points.iter().map(|p| p.x).fold(9.0, f64::min), x, "{what} {step}");
            let (values, factor) = (own.scalar.as_ref().unwrap(), step as f64 + 1.0);
            assert_eq!([values[0], values[4]], [factor, 3.0 * factor], "{what} {step}");
        }
        assert_eq!(files_beside(&path).len(), 4);
        // The table leads to a step elsewhere: it is not believed, and the steps are looked for.
        if table == 8 {
            let file = folder.path().join("one.geo");
            let mut bytes = std::fs::read(&file).unwrap();
            let first_entry = bytes.len() - 80 - 8 - 4 - 3 * 8;
            bytes[first_entry..first_entry + 8].fill(if big_endian == Some(true) { 0 } else { 255 });
            std::fs::write(&file, bytes).unwrap();
            let own = grid(&path, &request("T"));
            assert_eq!(own.points.iter().map(|p| p.x).fold(9.0, f64::min), 0.0, "{what}");
        }
    }
}

#[test]
fn mistakes_of_files_of_several_steps_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_file_sets(folder.path(), Some(false), 0);
    for (from, to, words) in [
        ("model: 1 1 one", "model: 1 7 one", ["file set that does not exist", "found 7", "section FILE"]),
        (
            "number of steps: 3\nfile",
            "number of steps: 2\nfile",
            ["too few steps", "found 2", "3, as of 'time values'"],
        ),
        ("index: 5", "index: l", ["'filename index'", "'l'", "a.case:18"]),
        ("time values: 0.5 1", "time values: 0.5 1 2", ["too few steps", "found 3", "4, as of"]),
        ("model: 1 1 one.geo", "model: 1 1 two05.T", ["too few steps", "found 2", "3 or more"]),
    ] {
        let text = CASE_OF_FILE_SETS;
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let last = Request { time_step: Some(TimeStep::Time(2.5)), ..request("T") };
        refused(&path, &last, &words);
    }
}

#[test]
fn descriptions_and_names_may_be_blank() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_case(folder.path(), None);
    let geometry = String::from_utf8(geometry(None, 0.0).bytes).unwrap();
    let blank = geometry.replacen("of four parts", "", 1).replacen("solid", " ", 1);
    std::fs::write(folder.path().join("a.0005.geo"), blank).unwrap();
    let vector = String::from_utf8(vector(None).bytes).unwrap();
    std::fs::write(folder.path().join("a.vec"), vector.replacen("a vector", "", 1)).unwrap();
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
    assert_eq!(names, ["fluid", "part 7", "box"]);
    let part = grid(&path, &Request { blocks: vec!["part 7".into()], ..request("U:0") });
    assert!(part.scalar.unwrap().iter().all(|&part| part == 7.0));
}

#[test]
fn complex_variables_are_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_case(folder.path(), None);
    let more = "VARIABLE\ncomplex scalar per node: 1 wave a.re a.im 50.\nscalar per measured node: 1 dust a.d\n\
        material id per element: 1 stuff a.m\nconstant per case: mass 2.\n";
    std::fs::write(&path, CASE.replacen("VARIABLE\n", more, 1)).unwrap();
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let expected = "Variables of complex numbers or of particles are left out: 'wave', 'dust'.";
    assert!(summary.warnings.iter().any(|warning| warning == expected), "{:?}", summary.warnings);
}

#[test]
fn mistakes_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_case(folder.path(), None);
    let message = |name: &str, from: &str, to: &str, scalar: &str| {
        let file = folder.path().join(name);
        let sound = std::fs::read_to_string(&file).unwrap();
        assert!(sound.contains(from), "{from}");
        std::fs::write(&file, sound.replacen(from, to, 1)).unwrap();
        let found = read(&path, &request(scalar), &NoProgress).unwrap_err().to_string();
        std::fs::write(&file, sound).unwrap();
        found
    };
    for (name, from, to, words) in [
        ("a.case", "ensight gold", "ensight", ["type", "'ensight'", "a.case:3"]),
        ("a.case", "model: 1 a.****.geo", "model: 1 1 a.geo", ["file set", "found 1", "section FILE"]),
        (
            "a.case",
            "model: 1 a.****.geo",
            "model: 1 a.****.geo change_coords_only",
            ["parts alone change", "'change_coords_only'", "a.case:6"],
        ),
        ("a.case", "model: 1 ", "model: 2 ", ["time set that does not exist", "a.****.geo", "a.case"]),
        ("a.case", "time values:", "time values file:", ["file of their own", "time values", "a.case:16"]),
        ("a.case", "a.****.geo", "a.*.*.geo", ["several places", "a.*.*.geo", "one place"]),
        ("a.case", "2.5", "2,5", ["time values", "'2,5'", "a.case:17"]),
        ("a.case", "a.****.geo", "b.****.geo", ["no such file", "b.0005.geo", "a.0005.geo"]),
        ("a.0005.geo", "tetra4", "tetra5", ["not read", "'tetra5'", "a.0005.geo:"]),
        (
            "a.0005.geo",
            "         2         3         4         5",
            "         2         3         4         6",
            ["does not exist", "found 6", "1 to 5"],
        ),
        ("a.0005.geo", "coordinates", "coords", ["kind of part", "'coords'", "a.0005.geo:"]),
        ("a.vec", "         7", "         9", ["part that does not exist", "found 9", "a.vec:"]),
        ("a.vec", "coordinates", "tetra4", ["variable is damaged", "'tetra4'", "coordinates or block"]),
        (
            "a.0005.geo",
            "part\n         4",
            "tria3\npart\n         4",
            ["of a type twice", "tria3", "a.0005.geo:"],
        ),
        ("a.vec", "coordinates", "coordinates partial", ["some elements alone", "partial", "a.vec:"]),
    ] {
        let found = message(name, from, to, "U:0").replace("'ensight gold'", "");
        let found = found.replace("found ensight;", "found 'ensight';");
        says(&found, &words);
    }
    for to in ["tria5", "hexa8", "coordinates", "block"] {
        let found = message("a b.0005", "tria3", to, "T");
        assert!(found.contains("variable is damaged") && found.contains(&format!("'{to}'")), "{found}");
    }
    let stars = message("a.case", "****", &"*".repeat(70_000), "U:0");
    assert!(stars.contains("a.0000"), "{}", &stars[..200]);
    let case = CASE.replace("filename increment: 10", "filename numbers: 5");
    std::fs::write(&path, case).unwrap();
    let second = Request { time_step: Some(TimeStep::Time(2.5)), ..request("T") };
    let found = read(&path, &second, &NoProgress).unwrap_err().to_string();
    assert!(found.contains("too few 'filename numbers'") && found.contains("found 1"), "{found}");
    let cut = std::fs::read(folder.path().join("a.vec")).unwrap();
    std::fs::write(folder.path().join("a.vec"), &cut[..cut.len() - 20]).unwrap();
    let found = read(&path, &request("U:0"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("ends early") && found.contains("a.vec"), "{found}");
}
