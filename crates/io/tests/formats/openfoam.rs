//! Cases of OpenFOAM as its programs write them: text, bytes, packed, decomposed, polyhedra; its foamToVTK says what they hold.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, Options};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, Request, TimeStep, files_beside, files_read_beside, inspect, read};

pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/openfoam").join(name)
}

/// The request for cells that keep their values, at the time 10.
pub fn request(scalar: &str) -> Request {
    let options = Options { cell_values: CellValues::Constant, ..Options::default() };
    let time_step = Some(TimeStep::Time(10.0));
    Request { scalar: Some(scalar.to_owned()), options, time_step, ..Request::default() }
}

pub fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

/// Values at the corners of each tetrahedron, by the positions of its corners in units of 0.0001, in ascending order.
fn tetrahedra(grid: &Grid) -> BTreeMap<Vec<[i64; 3]>, Vec<f64>> {
    let scalar = grid.scalar.as_ref().unwrap();
    let of_corner = |&p: &u32| {
        let position = grid.points[p as usize].to_array().map(|x| (x * 1e4).round() as i64);
        (position, scalar[p as usize])
    };
    let mut all = BTreeMap::new();
    for tetrahedron in grid.tetrahedra.iter() {
        let mut corners: Vec<([i64; 3], f64)> = tetrahedron.iter().map(of_corner).collect();
        corners.sort_by_key(|corner| corner.0);
        assert!(
            all.insert(corners.iter().map(|c| c.0).collect(), corners.iter().map(|c| c.1).collect())
                .is_none()
        );
    }
    all
}

/// Compares tetrahedra and their values.
#[track_caller]
pub fn same(found: &Grid, expected: &Grid, tolerance: f64, what: &str) {
    let (found, expected) = (tetrahedra(found), tetrahedra(expected));
    assert!(found.keys().eq(expected.keys()), "{what}: {} and {} tetrahedra", found.len(), expected.len());
    for (values, others) in found.values().zip(expected.values()) {
        for (value, other) in values.iter().zip(others) {
            assert!((value - other).abs() <= tolerance, "{what}: {value}, not {other}");
        }
    }
}

#[test]
fn cases_are_what_foam_to_vtk_makes_of_them() {
    for name in ["text", "dual"] {
        let vtu = sample(&format!("{name}.vtu"));
        let expected = grid(&vtu, &Request { time_step: None, ..request("T") });
        // foamToVTK writes 32 bits, of values up to 14.
        same(&grid(&sample(name), &request("T")), &expected, 1e-6, name);
    }
    let kinds = |path: &Path| inspect(path, &Request::default(), &NoProgress).unwrap().cells_by_type;
    assert_eq!(kinds(&sample("text")), BTreeMap::from([(12, 12), (13, 4)]));
    assert_eq!(kinds(&sample("dual")), kinds(&sample("dual.vtu")));
}

#[test]
fn text_bytes_packed_and_decomposed_cases_read_the_same() {
    for scalar in ["T", "D:1", "S:4"] {
        let expected = grid(&sample("text"), &request(scalar));
        for name in ["bytes", "packed", "decomposed", "collated_ascii", "collated_binary"] {
            // Text has 16 digits.
            same(&grid(&sample(name), &request(scalar)), &expected, 1e-13, name);
        }
    }
    for name in ["decomposed", "collated_ascii", "collated_binary"] {
        let summary = inspect(&sample(name), &request("T"), &NoProgress).unwrap();
        assert_eq!((summary.piece_count, summary.cell_count), (2, 16));
        assert_eq!(summary.point_count - summary.points_joined, 39);
        assert_eq!(summary.blocks.len(), 2, "{name}");
    }
    let bytes = inspect(&sample("bytes"), &request("T"), &NoProgress).unwrap();
    assert_eq!(bytes.format, "OpenFOAM, binary");
    let arrays: Vec<(&str, Association, usize)> =
        bytes.quantities().map(|a| (&*a.head.name, a.head.association, a.head.component_count)).collect();
    let expected = [
        ("D", Association::Point, 3),
        ("C", Association::Cell, 3),
        ("S", Association::Cell, 6),
        ("T", Association::Cell, 1),
    ];
    assert_eq!(arrays, expected);
}

#[test]
fn fields_are_those_of_the_time_and_of_the_place() {
    let case = sample("text");
    let summary = inspect(&case, &Request::default(), &NoProgress).unwrap();
    assert_eq!(summary.time_steps, [0.0, 2.0, 10.0]);
    let at = |time_step| grid(&case, &Request { time_step, ..request("T") });
    let [first, second, last] = [None, Some(TimeStep::Index(1)), Some(TimeStep::Time(9.0))].map(at);
    assert_eq!([first.origin.time, second.origin.time, last.origin.time], [Some(0.0), Some(2.0), Some(10.0)]);
    for (&a, &b) in first.scalar.as_ref().unwrap().iter().zip(last.scalar.as_ref().unwrap().iter()) {
        // Rounding of sums of at most 14.
        assert!((a + 10.0 - b).abs() < 1e-13);
    }
    // Six files of the mesh; T, D and S of each time, C of the last.
    assert_eq!(
        [files_beside(&case), files_read_beside(&case, &request("T"))].map(|files| files.len()),
        [16, 10]
    );
    let height = grid(&case, &request("D:2"));
    assert!(height.points.iter().zip(height.scalar.as_ref().unwrap().iter()).all(|(p, &d)| d == 2.0 * p.z));
    let shear = grid(&case, &request("S:YZ"));
    assert!(shear.scalar.unwrap().iter().all(|&value| value == 5.0));
    let (x, t) = (grid(&case, &request("C:0")), grid(&case, &request("T")));
    let (y, z) = (grid(&case, &request("C:1")), grid(&case, &request("C:2")));
    let [x, y, z, t] = [x, y, z, t].map(|grid| grid.scalar.unwrap());
    assert!((0..t.len()).all(|i| (x[i] * x[i] - y[i] * z[i] + 10.0 - t[i]).abs() < 1e-13));
}

#[test]
fn cell_zones_are_blocks() {
    let of = |name: &str, scalar: &str, blocks: &[&str]| {
        let blocks = blocks.iter().map(|block| block.to_string()).collect();
        grid(&sample(name), &Request { blocks, ..request(scalar) })
    };
    for name in ["text", "bytes", "packed", "decomposed"] {
        let summary = inspect(&sample(name), &Request::default(), &NoProgress).unwrap();
        let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
        assert_eq!(names, ["left", "right"], "{name}");
        let (all, right) = (of(name, "block", &[]), of(name, "block", &["right"]));
        for grid in [&all, &right] {
            let scalar = grid.scalar.as_ref().unwrap();
            let is_right = |p: &u32| scalar[*p as usize] == 1.0;
            for (i, tetrahedron) in grid.tetrahedra.iter().enumerate() {
                let x: f64 = grid.corners(i).iter().map(|p| p.x / 4.0).sum();
                assert!(tetrahedron.iter().all(|p| is_right(p) == (x > 1.0)), "{name}: {x}");
            }
        }
        assert!(right.tetrahedra.len() < all.tetrahedra.len());
        // The part has the values of the whole.
        for scalar in ["T", "D:0", "S:1"] {
            let (all, right) =
                (tetrahedra(&of(name, scalar, &[])), tetrahedra(&of(name, scalar, &["right"])));
            assert!(right.iter().all(|(place, values)| all[place] == *values), "{name} {scalar}");
        }
    }
    let wrong = Request { blocks: vec!["rihgt".to_owned()], ..request("T") };
    let wrong = read(&sample("text"), &wrong, &NoProgress).unwrap_err().to_string();
    assert!(wrong.contains("no such block") && wrong.contains("'right'"), "{wrong}");
}

pub fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (entry, to) = (entry.as_ref().unwrap().path(), to.join(entry.as_ref().unwrap().file_name()));
        if entry.is_dir() { copy(&entry, &to) } else { std::fs::copy(&entry, &to).map(drop).unwrap() }
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_case_is_named_by_its_folder_a_stub_or_its_control_file_and_may_move() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    copy(&sample("text"), &case);
    std::fs::write(case.join("a.foam"), "").unwrap();
    // A packed file that is no field, and a comment beside a word.
    std::fs::write(case.join("10/log.gz"), packed(b"Time = 10")).unwrap();
    let field = std::fs::read_to_string(case.join("10/T")).unwrap();
    std::fs::write(case.join("10/T"), field.replacen("internalField", "/*a b*/internalField", 1)).unwrap();
    let expected = grid(&sample("text"), &request("T"));
    for path in ["a.foam", "system/controlDict"] {
        same(&grid(&case.join(path), &request("T")), &expected, 0.0, path);
    }
    // The points of time 2 hold until others are written.
    std::fs::create_dir_all(case.join("2/polyMesh")).unwrap();
    let points = std::fs::read_to_string(case.join("constant/polyMesh/points")).unwrap();
    assert!(points.contains("(0 0 0)"));
    std::fs::write(case.join("2/polyMesh/points"), points.replacen("(0 0 0)", "(-0.5 0 0)", 1)).unwrap();
    for (time, x) in [(0.0, 0.0), (2.0, -0.5), (10.0, -0.5)] {
        let moved = grid(&case, &Request { time_step: Some(TimeStep::Time(time)), ..request("T") });
        assert_eq!(moved.points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min), x, "{time}");
    }
}

#[test]
fn faces_may_have_comments_and_types() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    copy(&sample("text"), &case);
    let path = case.join("constant/polyMesh/faces");
    let text = std::fs::read_to_string(&path).unwrap();
    let sound = grid(&sample("text"), &request("T"));
    for (from, to) in [
        ("4(3 12 13 4)", "4(3 12 13 4) // inlet (4)"),
        ("4(3 12 13 4)", "/* 4(1 2 3 4) */ 4\n(\n3\n12 13 4 )"),
        ("4(3 12 13 4)", "List<label> 4(3 12 13 4)"),
    ] {
        assert!(text.contains(from));
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let found = grid(&case, &request("T"));
        assert!(found.points == sound.points && found.tetrahedra == sound.tetrahedra, "{to}");
    }
}

#[test]
fn mistakes_name_the_file_and_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let message = |name: &str, from: &str, to: &str, scalar: &str| {
        let case = folder.path().join("case");
        let _ = std::fs::remove_dir_all(&case);
        copy(&sample("text"), &case);
        let text = std::fs::read_to_string(case.join(name)).unwrap();
        assert!(text.contains(from), "{from}");
        std::fs::write(case.join(name), text.replacen(from, to, 1)).unwrap();
        read(&case, &request(scalar), &NoProgress).unwrap_err().to_string()
    };
    let expect = |message: String, parts: &[&str]| {
        for part in parts {
            assert!(message.contains(part), "'{part}' is not in: {message}");
        }
    };
    expect(message("10/S", "uniform (", "$inner (", "S:0"), &["'$inner'", "macros", "10/S"]);
    expect(message("10/S", "internalField", "innerField", "S:0"), &["no values within the mesh", "10/S"]);
    expect(
        message("10/T", "<scalar>\n16", "<scalar>\n15", "T"),
        &["values of the field", "found 15", "16", "10/T"],
    );
    expect(message("10/T", "<scalar>\n16\n(", "<scalar>\n16\n(x", "T"), &["'x", "10/T:"]);
    expect(
        message("constant/polyMesh/owner", "nCells:16", "nCells:17", "T"),
        &["number of cells", "found 16", "17"],
    );
    expect(
        message("constant/polyMesh/points", "\n39\n", "\n3900\n", "T"),
        &["ends early", "polyMesh/points"],
    );
    expect(message("constant/polyMesh/owner", "\n64\n", "\n63\n", "T"), &["longer than its length", "owner"]);
    for (from, to, parts) in [
        ("4(1 4 13 10)", "4(1 4 13)", ["shorter than its length", "found 3", "faces:21"]),
        ("4(1 4 13 10)", "4(1 4 13 10 9)", ["longer than its length", ")", "faces:21"]),
        ("4(1 4 13 10)", "4(1 4 x 10)", ["damaged", "'x'", "faces:21"]),
    ] {
        expect(message("constant/polyMesh/faces", from, to, "T"), &parts);
    }
    expect(
        message("constant/polyMesh/faces", "format      ascii", "format      asci", "T"),
        &["'asci'", "faces"],
    );
    copy(&sample("text"), &folder.path().join("case"));
    let neighbour = folder.path().join("case/constant/polyMesh/neighbour");
    let inner = std::fs::read_to_string(&neighbour).unwrap();
    let expected = grid(&folder.path().join("case"), &request("T"));
    let (head, list) = inner.rsplit_once("\n(\n").unwrap();
    let (head, count) = head.rsplit_once('\n').unwrap();
    let outer = |label: &str| {
        let more = format!("{label}\n").repeat(3);
        let count = count.trim().parse::<usize>().unwrap() + 3;
        let text = format!("{head}\n{count}\n(\n{}", list.replacen("\n)", &format!("\n{more})"), 1));
        std::fs::write(&neighbour, text).unwrap();
        read(&folder.path().join("case"), &request("T"), &NoProgress)
    };
    assert_eq!(outer("-1").unwrap().tetrahedra, expected.tetrahedra);
    expect(outer("-2").unwrap_err().to_string(), &["damaged", "'-2'", "neighbour:"]);
    std::fs::remove_file(neighbour).unwrap();
    let missing = read(&folder.path().join("case"), &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(missing.contains("not complete") && missing.contains("polyMesh/neighbour"), "{missing}");
    std::fs::remove_dir_all(folder.path().join("case/constant")).unwrap();
    let missing = read(&folder.path().join("case"), &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(missing.contains("no mesh") && missing.contains("processor0"), "{missing}");
}

/// Lists of bytes, of this width of labels, width of numbers, and order.
#[derive(Clone, Copy, Debug)]
struct Arch {
    label: usize,
    scalar: usize,
    big_endian: bool,
}

impl Arch {
    fn head(self, class: &str) -> Vec<u8> {
        let order = if self.big_endian { "MSB" } else { "LSB" };
        let (label, scalar) = (8 * self.label, 8 * self.scalar);
        let arch = format!("{order};label={label};scalar={scalar}");
        format!("/*---*\\\n\\*---*/\nFoamFile\n{{ version 2; format binary; arch \"{arch}\"; class {class}; }}\n// * * * //\n").into_bytes()
    }

    fn list(self, count: usize, numbers: impl IntoIterator<Item = (usize, [u8; 8], [u8; 4])>) -> Vec<u8> {
        let mut bytes = format!("\n{count}\n(").into_bytes();
        for (width, long, short) in numbers {
            let mut own = if width == 8 { long.to_vec() } else { short.to_vec() };
            if self.big_endian {
                own.reverse();
            }
            bytes.extend(own);
        }
        bytes.extend(b")\n");
        bytes
    }

    fn labels(self, labels: &[i32]) -> Vec<u8> {
        let of = |&label: &i32| (self.label, i64::from(label).to_le_bytes(), label.to_le_bytes());
        self.list(labels.len(), labels.iter().map(of))
    }

    fn scalars(self, count: usize, values: &[f64]) -> Vec<u8> {
        let of = |&value: &f64| (self.scalar, value.to_le_bytes(), (value as f32).to_le_bytes());
        self.list(count, values.iter().map(of))
    }
}

#[test]
fn labels_and_numbers_of_every_width_and_order_are_read() {
    // Two unit cubes along x.
    let mut faces = vec![[1, 4, 10, 7]];
    let mut owner = vec![0];
    for c in 0..2 {
        let end = if c == 0 { [0, 6, 9, 3] } else { [2, 5, 11, 8] };
        let sides = [[c, c + 3, c + 4, c + 1], [c + 6, c + 7, c + 10, c + 9]];
        faces.extend(sides.into_iter().chain([[c, c + 1, c + 7, c + 6], [c + 3, c + 9, c + 10, c + 4], end]));
        owner.extend([c; 5]);
    }
    let points: Vec<f64> = (0..12).flat_map(|p| [p % 3, p / 3 % 2, p / 6].map(f64::from)).collect();
    for bits in 0..8 {
        let arch = Arch {
            label: if bits & 1 == 0 { 4 } else { 8 },
            scalar: if bits & 2 == 0 { 4 } else { 8 },
            big_endian: bits & 4 != 0,
        };
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, class: &str, parts: &[&[u8]]| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, [&arch.head(class), &parts.concat()[..]].concat()).unwrap();
        };
        let ends: Vec<i32> = (0..=faces.len() as i32).map(|face| 4 * face).collect();
        let corners = faces.as_flattened();
        write("constant/polyMesh/points", "vectorField", &[&arch.scalars(12, &points)]);
        write("constant/polyMesh/faces", "faceCompactList", &[&arch.labels(&ends), &arch.labels(corners)]);
        write("constant/polyMesh/owner", "labelList", &[&arch.labels(&owner)]);
        // Older meshes have -1 for the faces of the boundary.
        let mut neighbours = vec![-1; if bits & 4 == 0 { 1 } else { owner.len() }];
        neighbours[0] = 1;
        write("constant/polyMesh/neighbour", "labelList", &[&arch.labels(&neighbours)]);
        let values = arch.scalars(2, &[0.25, 8.5]);
        let rest: &[u8] =
            b";\nboundaryField { #include \"walls\" a { value nonuniform List<scalar> 0(); } }\n";
        write(
            "10/T",
            "volScalarField",
            &[b"#include \"units\"\ninternalField nonuniform List<scalar> ", &values, rest],
        );
        write("10/p", "volScalarField", &[b"dimensions [0 2 -2 0 0 0 0];\ninternalField uniform 3;\n"]);
        let read = grid(folder.path(), &request("T"));
        assert_eq!(read.tetrahedra.len(), 12, "{arch:?}");
        for (i, tetrahedron) in read.tetrahedra.iter().enumerate() {
            let x: f64 = read.corners(i).iter().map(|p| p.x / 4.0).sum();
            let expected = if x < 1.0 { 0.25 } else { 8.5 };
            assert!(
                tetrahedron.iter().all(|&p| read.scalar.as_ref().unwrap()[p as usize] == expected),
                "{arch:?}"
            );
        }
        assert!(grid(folder.path(), &request("p")).scalar.unwrap().iter().all(|&p| p == 3.0), "{arch:?}");
    }
}

/// A request for the means of cell values at points.
fn means(scalar: &str) -> Request {
    Request { options: Options::default(), ..request(scalar) }
}

#[test]
fn points_at_the_boundary_have_what_the_patches_state() {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("text"), folder.path());
    // The walls are at x = 0, and at y = 0; T there is zeroGradient, C the centre of each face.
    let plain = grid(folder.path(), &means("T"));
    let centre = grid(folder.path(), &means("C:1"));
    let on_wall = |p: &glam::DVec3| p.x.abs() < 1e-9 || p.y.abs() < 1e-9;
    assert!(plain.points.iter().any(on_wall) && plain.points.iter().any(|p| !on_wall(p)));
    for (p, &y) in centre.points.iter().zip(centre.scalar.as_ref().unwrap().iter()) {
        // Faces at y = 0, away from the edge with x = 0, have their centres there.
        if p.y.abs() < 1e-9 && p.x > 0.1 {
            assert!(y.abs() < 1e-12, "{p} {y}");
        }
    }
    let path = folder.path().join("10/T");
    let text = std::fs::read_to_string(&path).unwrap();
    let begin = text.find("boundaryField").unwrap();
    let values: String = (0..12).map(|face| format!("{}\n", if face < 4 { 7.0 } else { 3.0 })).collect();
    let list = format!("value nonuniform List<scalar> 12\n(\n{values})\n;");
    let nested = "{ coeffs { type a; table ((0 1) (1 2)); } refValue nonuniform List<vector> 1((1 2 3)); value uniform 5; }";
    for (entry, [at_x, at_y]) in [
        ("\"(walls|other)\" { type fixedValue; value uniform 5; }", [5.0, 5.0]),
        (&*format!("wall {{ type mixed; {list} }} \".*\" {{ type a; value uniform 9; }}"), [7.0, 3.0]),
        (&*format!("#include \"a\"\nwall {{ type a; value uniform 1; }} walls {nested}"), [5.0, 5.0]),
    ] {
        let own = format!(
            "{}boundaryField {{ {entry} defaultFaces {{ type empty; value uniform 99; }} }}",
            &text[..begin]
        );
        std::fs::write(&path, own).unwrap();
        let found = grid(folder.path(), &means("T"));
        assert_eq!(found.points, plain.points);
        let rows = found.scalar.as_ref().unwrap().iter().zip(plain.scalar.as_ref().unwrap().iter());
        for (p, (&value, &mean)) in found.points.iter().zip(rows) {
            let expected = match (p.x.abs() < 1e-9, p.y.abs() < 1e-9) {
                (true, false) => at_x,
                (false, true) => at_y,
                // Points of the edge have faces of both.
                (true, true) => (at_x + at_y) / 2.0,
                _ => mean,
            };
            assert!((value - expected).abs() < 1e-12, "{entry} {p}: {value} {expected}");
        }
    }
    let nan = list.replacen("7\n", "nan\n", 1);
    std::fs::write(&path, format!("{}boundaryField {{ walls {{ {nan} }} }}", &text[..begin])).unwrap();
    let warnings = grid(folder.path(), &means("T")).origin.warnings.clone();
    let expected = "1 value of 'T' at the boundary is not finite";
    assert!(warnings.iter().any(|own| own.starts_with(expected)), "{warnings:?}");
    let damaged =
        format!("{}boundaryField {{ walls {{ {} }} }}", &text[..begin], list.replace("12\n(", "11\n("));
    std::fs::write(&path, damaged).unwrap();
    let warnings = grid(folder.path(), &means("T")).origin.warnings.clone();
    let is_named = |own: &String| own.contains("longer than its length") && own.contains("T:");
    assert!(warnings.iter().any(is_named), "{warnings:?}");
    let short = list.replace("12\n(", "11\n(").replacen("7\n", "", 1);
    std::fs::write(&path, format!("{}boundaryField {{ walls {{ {short} }} }}", &text[..begin])).unwrap();
    let found = read(folder.path(), &means("T"), &NoProgress).unwrap_err().to_string();
    assert!(
        found.contains("on the patch 'walls'") && found.contains("found 11") && found.contains("expected 12"),
        "{found}"
    );
}

#[test]
fn boundaries_read_the_same_in_bytes_packed_and_decomposed() {
    let expected = grid(&sample("text"), &means("C:0"));
    for name in ["bytes", "packed"] {
        same(&grid(&sample(name), &means("C:0")), &expected, 1e-13, name);
    }
    // What processors' patches hold is passed over.
    for name in ["decomposed", "collated_ascii", "collated_binary"] {
        same(&grid(&sample(name), &means("T")), &grid(&sample("text"), &means("T")), 1e-12, name);
    }
}

#[test]
fn patches_that_processors_share_have_the_values_of_all() {
    let own = |name: &str, fields: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        copy(&sample(name), folder.path());
        for field in fields {
            let path = folder.path().join(field);
            let text = std::fs::read_to_string(&path).unwrap();
            let begin = text.find("boundaryField").unwrap();
            let walls = text[begin..].replacen("zeroGradient;", "fixedValue; value uniform 5;", 1);
            assert!(walls.contains("uniform 5"), "{field}");
            std::fs::write(path, format!("{}{walls}", &text[..begin])).unwrap();
        }
        grid(folder.path(), &means("T"))
    };
    let whole = own("text", &["10/T"]);
    assert!(whole.scalar.as_ref().unwrap().contains(&5.0));
    same(&own("decomposed", &["processor0/10/T", "processor1/10/T"]), &whole, 1e-12, "decomposed");
}

/// Warnings of a case with this boundary field of T, which is read with means of cells at points.
fn read_with_patches(entries: &str, boundary: Option<(&str, &str)>) -> (Grid, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("text"), folder.path());
    let path = folder.path().join("10/T");
    let text = std::fs::read_to_string(&path).unwrap();
    let inner = text.split("boundaryField").next().unwrap();
    std::fs::write(&path, format!("{inner}boundaryField\n{{\n{entries}\n}}\n")).unwrap();
    if let Some((from, to)) = boundary {
        let path = folder.path().join("constant/polyMesh/boundary");
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(path, text.replacen(from, to, 1)).unwrap();
    }
    let own = grid(folder.path(), &Request { options: Options::default(), ..request("T") });
    let warnings = own.origin.warnings.clone();
    (own, warnings)
}

#[test]
fn values_on_patches_that_are_not_read_are_a_warning() {
    let means = read_with_patches("", None).0.scalar;
    for (entry, word) in [
        ("\".*\" { type fixedValue; value uniform $Tin; }", "$Tin"),
        ("\".*\" { type fixedValue; value #calc \"1 + 2\"; }", "#calc"),
        ("\".*\" { type fixedValue; value $other; }", "$other"),
        ("\".*\" { $fixed; }", "$fixed"),
        ("$walls;", "$walls"),
        ("\".*\" { value uniform 5; } \"a{2}\" { value uniform 6; }", "a{2}"),
        ("\".*\" { value nonuniform $list; }", "$list"),
    ] {
        let (own, warnings) = read_with_patches(entry, None);
        assert!(own.scalar == means, "{entry}");
        assert!(warnings.iter().any(|own| own.contains(word) && own.contains("not read")), "{warnings:?}");
    }
    let uniform = read_with_patches("\".*\" { value uniform 5; }", None);
    assert!(uniform.0.scalar != means && uniform.1.is_empty(), "{:?}", uniform.1);
    for entry in [
        "\".*\" { value nonuniform List<scalar> 4{(5)}; }",
        "$walls; \"[a-z]+.*\" { value uniform 5; }",
        "\".*\" { value uniform 4; } \"([a-z]|[0-9]|_)+\" { type a; value uniform 5; }",
    ] {
        let (own, warnings) = read_with_patches(entry, None);
        assert!(own.scalar == uniform.0.scalar && warnings.is_empty(), "{entry}: {warnings:?}");
    }
    let dictionary = ("walls\n    {\n", "walls\n    {\n surface { type triSurfaceMesh; name x; }\n");
    let own = read_with_patches("\".*\" { value uniform 5; }", Some(dictionary));
    assert!(own.0.scalar == uniform.0.scalar, "{:?}", own.1);
}

#[test]
fn patches_follow_each_other() {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("text"), folder.path());
    let path = folder.path().join("constant/polyMesh/boundary");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replacen("startFace       40", "startFace       30", 1)).unwrap();
    let field = folder.path().join("10/T");
    let text = std::fs::read_to_string(&field).unwrap();
    let inner = text.split("boundaryField").next().unwrap();
    std::fs::write(&field, format!("{inner}boundaryField {{ walls {{ value uniform 5; }} }}")).unwrap();
    let means = Request { options: Options::default(), ..request("T") };
    let found = read(folder.path(), &means, &NoProgress).unwrap_err().to_string();
    assert!(
        ["'defaultFaces'", "face 30", "faces 40 to 64"].iter().all(|word| found.contains(word)),
        "{found}"
    );
}
