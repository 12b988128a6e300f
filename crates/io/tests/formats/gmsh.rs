//! Meshes of Gmsh of both versions, in text and bytes, by its own library, by meshio, and written here.

use super::refusals::{refused, says};
use glam::DVec3;
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, Options};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, inspect, read};
use voltet_testing::files::samples::file;

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name)
}

fn request(scalar: &str) -> Request {
    Request { scalar: Some(scalar.to_owned()), ..Request::default() }
}

fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

/// The field of make_gmsh.py.
fn field(p: DVec3) -> f64 {
    p.x * p.x - p.x * p.y + 2.0 * p.y * p.z + p.z - 0.5
}

fn volume(grid: &Grid) -> f64 {
    let of = |i: usize| voltet_core::grid::tetrahedron_volume(grid.corners(i));
    (0..grid.tetrahedra.len()).map(of).sum()
}

/// Sum over Gmsh's reference tetrahedron, hexahedron, prism and pyramid, times the determinant of the affine map.
const VOLUME: f64 = (1.0 / 6.0 + 8.0 + 1.0 + 4.0 / 3.0) * 0.987;

#[test]
fn a_quadratic_field_is_exact_in_every_element_of_gmshs_own_library() {
    for (name, sets) in [
        ("every_element_4.msh", 3.0),
        ("every_element_2.msh", 3.0),
        ("linear_4.msh", 1.0),
        ("linear_2.msh", 1.0),
    ] {
        for subdivision in [1, 2] {
            let options = Options { subdivision, ..Options::default() };
            let grid = grid(&sample(name), &Request { options, ..request("f") });
            // Sixteen digits of coordinates of at most 20, and sums of hundreds of volumes.
            assert!((volume(&grid) - sets * VOLUME).abs() < 1e-10, "{name}: {}", volume(&grid));
            for (&p, &value) in grid.points.iter().zip(&**grid.scalar.as_ref().unwrap()) {
                // Products of such coordinates.
                assert!(
                    (value - field(p)).abs() < 1e-10,
                    "{name}, subdivision {subdivision}: {value} at {p}"
                );
            }
        }
    }
}

#[test]
fn arrays_are_those_of_the_views() {
    for name in ["linear_4.msh", "linear_2.msh"] {
        let path = sample(name);
        let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
        assert_eq!((summary.point_count, summary.cell_count), (23, 4));
        assert_eq!(summary.time_steps, [0.0, 1.5, 4.0]);
        let names: Vec<&str> = summary.quantities().map(|array| array.head.name.as_str()).collect();
        assert_eq!(names, ["f", "position", "jumps", "transient", "mean f"], "{name}");
        let y = grid(&path, &request("position:1"));
        assert!(y.points.iter().zip(&**y.scalar.as_ref().unwrap()).all(|(p, &y)| p.y == y));
        for (time_step, factor) in
            [(None, 1.0), (Some(TimeStep::Time(1.5)), 2.5), (Some(TimeStep::Index(2)), 5.0)]
        {
            let grid = grid(&path, &Request { time_step, ..request("transient") });
            for (&p, &value) in grid.points.iter().zip(&**grid.scalar.as_ref().unwrap()) {
                assert!((value - factor * field(p)).abs() < 1e-10, "{name} {factor}: {value} at {p}");
            }
        }
        let constant = Options { cell_values: CellValues::Constant, ..Options::default() };
        let jumps = grid(&path, &Request { options: constant, ..request("jumps") });
        assert!(jumps.origin.warnings.is_empty(), "{:?}", jumps.origin.warnings);
        let mean = grid(&path, &Request { options: constant, ..request("mean f") });
        for (i, tetrahedron) in jumps.tetrahedra.iter().enumerate() {
            for &p in tetrahedron {
                let value = jumps.scalar.as_ref().unwrap()[p as usize];
                let cell = jumps.source_cell(i) as f64;
                assert!((value - field(jumps.points[p as usize]) - cell).abs() < 1e-10, "{name}: {value}");
            }
        }
        let means: std::collections::BTreeSet<u64> =
            mean.scalar.as_ref().unwrap().iter().map(|value| value.to_bits()).collect();
        assert_eq!(means.len(), 4, "{name}");
        let averaged = grid(&path, &request("jumps"));
        assert!(averaged.origin.warnings.iter().any(|warning| warning.contains("averaged at the points")));
    }
}

#[test]
fn meshio_writes_the_same_as_vtu() {
    for scalar in ["f", "g"] {
        let expected = grid(&sample("meshio.vtu"), &request(scalar));
        let found = grid(&sample("meshio_2.msh"), &request(scalar));
        assert_eq!(found.points, expected.points);
        // A wedge may begin with either of its triangles.
        let sorted = |grid: &Grid| {
            let mut tetrahedra = grid.tetrahedra.to_vec();
            tetrahedra.sort_unstable();
            tetrahedra
        };
        assert_eq!(sorted(&found), sorted(&expected));
        assert_eq!(found.scalar, expected.scalar);
    }
}

#[test]
fn physical_groups_of_volumes_are_blocks() {
    for (name, fluid, solid) in [
        ("linear_4.msh", "fluid", "solid part"),
        ("linear_2.msh", "fluid", "solid part"),
        ("every_element_4.msh", "fluid", "solid"),
        ("every_element_2.msh", "fluid", "solid"),
    ] {
        let summary = inspect(&sample(name), &Request::default(), &NoProgress).unwrap();
        let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
        assert_eq!(names, [solid, fluid], "{name}");
        let constant = Options { cell_values: CellValues::Constant, ..Options::default() };
        let of = |scalar: &str, blocks: &[&str]| {
            let blocks = blocks.iter().map(|block| block.to_string()).collect();
            grid(&sample(name), &Request { options: constant, blocks, ..request(scalar) })
        };
        let (all, part) = (of("block", &[]), of("block", &[fluid]));
        let cell_count = summary.blocks[1].cell_count();
        assert!(part.scalar.as_ref().unwrap().iter().all(|&block| block == 1.0), "{name}");
        let is_fluid = |i: &usize| all.scalar.as_ref().unwrap()[all.tetrahedra[*i][0] as usize] == 1.0;
        assert_eq!((0..all.tetrahedra.len()).filter(is_fluid).count(), part.tetrahedra.len(), "{name}");
        // Elements keep their numbers among all in the values of a part.
        for (scalar, first) in [("jumps", if cell_count == 2 { 1.0 } else { 0.0 }), ("f", 0.0)] {
            let part = of(scalar, &[fluid]);
            let p = part.tetrahedra[0][0] as usize;
            let value = part.scalar.as_ref().unwrap()[p] - field(part.points[p]);
            assert!((value - first).abs() < 1e-10, "{name} {scalar}: {value}");
        }
    }
}

/// Numbers of a file: text, or bytes of an order.
struct Writer {
    bytes: Vec<u8>,
    big_endian: Option<bool>,
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn number<const N: usize>(&mut self, text: String, mut little: [u8; N]) {
        match self.big_endian {
            None => self.text(&(text + " ")),
            Some(big) => {
                if big {
                    little.reverse();
                }
                self.bytes.extend(little);
            }
        }
    }

    fn ints(&mut self, values: &[i32]) {
        values.iter().for_each(|&value| self.number(value.to_string(), value.to_le_bytes()));
    }

    fn sizes(&mut self, values: &[u64]) {
        values.iter().for_each(|&value| self.number(value.to_string(), value.to_le_bytes()));
    }

    fn doubles(&mut self, values: &[f64]) {
        values.iter().for_each(|&value| self.number(value.to_string(), value.to_le_bytes()));
    }
}

const POINTS: [[f64; 3]; 5] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
const TAGS: [u64; 5] = [90, 12, 2_000_000_000, 7, 13];

#[test]
fn names_of_groups_may_have_no_dimension_and_no_space() {
    let folder = tempfile::tempdir().unwrap();
    let names = |text: &str| {
        let mesh = format!(
            "$MeshFormat\n2.0 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n{text}\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n\
             3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n$Elements\n2\n1 4 2 9 9 1 2 3 4\n2 4 2 7 7 2 3 4 5\n$EndElements\n",
            text.lines().count()
        );
        let path = file(&folder, "a.msh", mesh.as_bytes());
        inspect(&path, &Request::default(), &NoProgress)
            .map(|own| own.blocks.into_iter().map(|block| block.name).collect::<Vec<_>>())
    };
    let both = ["the body", "air"];
    for (text, expected) in [
        ("9\"the body\"\n 7 \"air\"", both),
        ("3 9\"the body\"\n3 7 \"air\"", both),
        ("2 9 \"no\"\n3 9 \"the body\"\n3 7 \"air\"", both),
        ("3 9 the body\n3 7 air", both),
        // Groups of something else: no volume has the number, or it is not known which name is theirs.
        ("5 \"skin\"\n9 \"the body\"\n7 \"air\"", both),
        ("7 \"skin\"\n9 \"the body\"\n7 \"air\"", ["the body", "7"]),
    ] {
        assert_eq!(names(text).unwrap(), expected, "{text}");
    }
    assert!(names("3 9\n3 7 air").unwrap_err().to_string().contains("physical name"));
    let found = names("3 9 4 \"the body\"\n3 7 \"air\"").unwrap_err().to_string();
    assert!(found.contains("physical name") && found.contains("a.msh:6"), "{found}");
}

/// Two tetrahedra in two partitions with a triangle between them, nodes with parameters, a view in two partitions.
fn partitioned(version: f64, big_endian: Option<bool>) -> Vec<u8> {
    let mut w = Writer { bytes: Vec::new(), big_endian };
    w.text(&format!("$MeshFormat\n{version} {} 8\n", u8::from(big_endian.is_some())));
    if big_endian.is_some() {
        w.ints(&[1]);
        w.text("\n");
    }
    w.text("$EndMeshFormat\n$Comments\n$ made by hand\n$EndComments\n");
    w.text("$PhysicalNames\n2\n2 1 \"cut\"\n3 9 \"the body\"\n$EndPhysicalNames\n");
    let int = |tag: u64| tag as i32;
    if version > 4.0 {
        w.text("$PartitionedEntities\n");
        w.sizes(&[2, 1]);
        w.ints(&[5, 2]);
        w.sizes(&[1, 0, 0, 2]);
        // A point, then two volumes of the parent 1; one has two groups.
        w.ints(&[1, 0, 1]);
        w.sizes(&[1]);
        w.ints(&[1]);
        w.doubles(&[0.0; 3]);
        w.sizes(&[0]);
        for (volume, groups) in [(2, &[9][..]), (3, &[-9, 4][..])] {
            w.ints(&[volume, 3, 1]);
            w.sizes(&[1]);
            w.ints(&[volume - 1]);
            w.doubles(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
            w.sizes(&[groups.len() as u64]);
            w.ints(groups);
            w.sizes(&[1]);
            w.ints(&[-6]);
        }
        w.text("\n$EndPartitionedEntities\n$Nodes\n");
        w.sizes(&[2, 5, 7, TAGS[2]]);
        for (dimension, own) in [(2, 0..3), (3, 3..5)] {
            w.ints(&[dimension, 1, i32::from(dimension == 2)]);
            w.sizes(&[own.len() as u64]);
            w.sizes(&TAGS[own.clone()]);
            for point in &POINTS[own] {
                w.doubles(point);
                w.doubles(if dimension == 2 { &[0.5, 0.25] } else { &[] });
            }
        }
        w.text("\n$EndNodes\n$Elements\n");
        w.sizes(&[3, 3, 3, 800]);
        w.ints(&[3, 3, 4]);
        w.sizes(&[1, 800, TAGS[4], TAGS[1], TAGS[2], TAGS[3]]);
        w.ints(&[2, 6, 2]);
        w.sizes(&[1, 20, TAGS[1], TAGS[2], TAGS[3]]);
        w.ints(&[3, 2, 4]);
        w.sizes(&[1, 3, TAGS[0], TAGS[1], TAGS[2], TAGS[3]]);
    } else {
        w.text("$Nodes\n5\n");
        for (&tag, point) in TAGS.iter().zip(&POINTS) {
            w.ints(&[int(tag)]);
            w.doubles(point);
        }
        w.text("\n$EndNodes\n$Elements\n3\n");
        let [a, b, c, d, e] = TAGS.map(int);
        if big_endian.is_some() {
            w.ints(&[4, 1, 4, 800, 9, 3, 1, 2, e, b, c, d]);
            w.ints(&[2, 1, 2, 20, 1, 6, b, c, d]);
            w.ints(&[4, 1, 4, 3, -9, 2, 1, 1, a, b, c, d]);
        } else {
            w.ints(&[800, 4, 4, 9, 3, 1, 2, e, b, c, d]);
            w.ints(&[20, 2, 2, 1, 6, b, c, d]);
            w.ints(&[3, 4, 4, -9, 2, 1, 1, a, b, c, d]);
        }
    }
    w.text("\n$EndElements\n$Periodic\n0\n$EndPeriodic\n");
    for (partition, own) in [(1, [0, 1, 2]), (2, [3, 4, 3])] {
        w.text(&format!(
            "$NodeData\n1\n\"T\"\n1\n0.5\n4\n0\n1\n{}\n{partition}\n",
            3 - usize::from(partition == 2)
        ));
        for &node in if partition == 2 { &own[..2] } else { &own[..] } {
            w.ints(&[int(TAGS[node])]);
            w.doubles(&[10.0 + node as f64]);
        }
        w.text("\n$EndNodeData\n");
    }
    w.text("$ElementData\n1\n\"rank\"\n1\n0.5\n3\n0\n1\n3\n");
    for (element, value) in [(3, 1.0), (20, 99.0), (800, 2.0)] {
        w.ints(&[element]);
        w.doubles(&[value]);
    }
    w.text("\n$EndElementData\n");
    w.bytes
}

#[test]
fn both_versions_in_text_and_in_bytes_of_either_order_read_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for version in [2.2, 4.1] {
        for big_endian in [None, Some(false), Some(true)] {
            let what = format!("{version} {big_endian:?}");
            let path = file(&folder, "a.msh", &partitioned(version, big_endian));
            let blocks = inspect(&path, &Request::default(), &NoProgress).unwrap().blocks;
            assert_eq!((blocks.len(), &*blocks[0].name), (1, "the body"), "{what}");
            let temperature = grid(&path, &request("T"));
            let points: Vec<[f64; 3]> = temperature.points.iter().map(|p| p.to_array()).collect();
            assert_eq!(points, POINTS, "{what}");
            assert_eq!(**temperature.scalar.as_ref().unwrap(), [10.0, 11.0, 12.0, 13.0, 14.0], "{what}");
            assert_eq!(*temperature.tetrahedra, [[1, 2, 3, 4], [0, 1, 2, 3]], "{what}");
            let constant = Options { cell_values: CellValues::Constant, ..Options::default() };
            let rank = grid(&path, &Request { options: constant, ..request("rank") });
            assert_eq!(**rank.scalar.as_ref().unwrap(), [2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0], "{what}");
        }
    }
}

#[test]
fn older_versions_and_those_behind_comments_read_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = "5\n1 0 0 0\n2 1 0 0\n5 0 1 0\n9 0 0 1\n7 1 1 1\n";
    let second = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}$EndNodes\n$Elements\n3\n1 2 2 4 1 1 2 5\n3 4 2 6 1 1 2 5 9\n\
         4 4 2 8 1 2 5 9 7\n$EndElements\n"
    );
    let first = format!(
        "$NOD\n{nodes}$ENDNOD\n$ELM\n3\n1 2 4 1 3 1 2 5\n3 4 6 1 4 1 2 5 9\n4 4 8 1 4 2 5 9 7\n$ENDELM\n"
    );
    let elements = &first[first.find("$ELM").unwrap()..];
    // Points have boxes, entities their tag first, nodes their tags in their rows; one has parameters.
    let fourth = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n1 0 0 2\n1 0 0 0 0 0 0 0\n1 0 0 0 1 1 1 1 6 0\n2 0 0 0 1 1 1 1 8 0\n\
        $EndEntities\n$Nodes\n3 5\n1 0 0 1\n1 0 0 0\n1 3 0 3\n2 1 0 0\n5 0 1 0\n9 0 0 1\n1 2 1 1\n7 1 1 1 0.5 0.25\n$EndNodes\n\
        $Elements\n3 3\n1 2 2 1\n1 1 2 5\n1 3 4 1\n3 1 2 5 9\n2 3 4 1\n4 2 5 9 7\n$EndElements\n";
    let marked = |text: &str| format!("\u{feff}{text}");
    let (first_marked, second_marked) = (marked(&first), marked(&second));
    let first_commented = format!("$Comments\n$NOD\n$MeshFormat\n$EndComments\n{first}");
    let commented = format!("$Comments\n{}\n$EndComments\n{second}", "a line\n".repeat(900));
    // Sizes of four bytes are of no account in text.
    let of_four = fourth.replacen("4 0 8", "4 0 4", 1);
    let mesh = Request { without_scalar: true, ..Request::default() };
    let of = |text: &str| {
        let path = file(&folder, "a.msh", text.as_bytes());
        let blocks = inspect(&path, &Request::default(), &NoProgress).unwrap().blocks;
        let own = grid(&path, &mesh);
        let names: Vec<String> = blocks.into_iter().map(|block| block.name).collect();
        (names, own.points.to_vec(), own.tetrahedra.to_vec())
    };
    let expected = of(&second);
    assert_eq!(
        (&*expected.0, expected.1.len(), expected.2.len()),
        (&["6".to_owned(), "8".to_owned()][..], 5, 2)
    );
    for text in [&first, fourth, &commented, &of_four, &first_marked, &second_marked, &first_commented] {
        assert_eq!(of(text), expected, "{text:.60}");
    }
    for (text, from, to, words) in [
        (&*first, "3 4 6 1 4 1 2 5 9", "3 4 6 1 4 1 2 5 8", ["element 3", "found 8"]),
        (&*first, "$ENDELM", "", ["ends early", "$ELM without its end"]),
        (&*commented, "$EndComments", "", ["$Comments without its end", "a.msh:2"]),
        (&*first, "1 4 1 2 5 9", "1 5 1 2 5 9", ["than its type: found 5; expected 4", "a.msh:12"]),
        (&*first, "$NOD\n", "$XOD\n", ["format of the file is not known", "'$XOD"]),
        (&*first, elements, "", ["not complete", "a section $ELM"]),
        (fourth, "5 0 1 0\n", "5.5 0 1 0\n", ["number of a node", "a.msh:16"]),
    ] {
        let path = file(&folder, "a.msh", text.replacen(from, to, 1).as_bytes());
        refused(&path, &mesh, &words);
    }
}

#[test]
fn cells_without_values_have_no_part_in_means() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from_utf8(partitioned(4.1, None)).unwrap();
    text.push_str(
        "$ElementNodeData\n1\n\"corner\"\n1\n0.5\n3\n0\n1\n1\n800 4 1 2 3 4\n$EndElementNodeData\n",
    );
    let corner = grid(&file(&folder, "a.msh", text.as_bytes()), &request("corner"));
    // The other tetrahedron has a node without a value.
    assert_eq!(corner.origin.cells_not_finite, 1);
    let values: Vec<f64> =
        corner.tetrahedra[0].iter().map(|&p| corner.scalar.as_ref().unwrap()[p as usize]).collect();
    assert_eq!((corner.tetrahedra.len(), values), (1, vec![2.0, 3.0, 4.0, 1.0]));
}

#[test]
fn mistakes_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let sound = String::from_utf8(partitioned(4.1, None)).unwrap();
    let message = |from: &str, to: &str| {
        assert!(sound.contains(from), "{from}");
        let path = file(&folder, "a.msh", sound.replacen(from, to, 1).as_bytes());
        read(&path, &request("T"), &NoProgress).unwrap_err().to_string()
    };
    let expect = |message: String, parts: &[&str]| {
        for part in parts {
            assert!(message.contains(part), "'{part}' is not in: {message}");
        }
    };
    expect(message("4.1 0 8", "3 0 8"), &["version", "'3 0 8'", "msh41", "a.msh:2"]);
    expect(message("4.1 0 8", "4 1 8"), &["version", "'4 1 8'", "text", "a.msh:2"]);
    expect(message("4.1 0 8", "4.1 1 4"), &["size", "8 bytes"]);
    expect(message("$EndElements", "$EndElement"), &["ends early", "$Elements without its end"]);
    expect(message("800 13 12", "800 14 12"), &["element 800", "node that does not exist", "found 14"]);
    expect(message("3 3 4 1 800", "3 3 30 1 800"), &["not read", "found 30", "orders 1 to 3"]);
    expect(message("90 12 ", "12 12 "), &["holds a node twice", "node 12"]);
    expect(message("90 10 ", "91 10 "), &["value at a node that does not exist", "found 91"]);
    expect(message("90 10 ", "90 1o0 "), &["'1o0'", "a value", "a.msh:"]);
    expect(message("\n0\n1\n3\n1\n", "\n0\n1\n-3\n1\n"), &["head of a view", "[0, 1, -3, 1]"]);
    expect(message("$Nodes\n2 5 ", "$Nodes\n2 5000000000 "), &["do not fit the file"]);
    let row = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 9000000 0\n$EndElements\n";
    let found =
        read(&file(&folder, "b.msh", row.as_bytes()), &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(["tags of an element", "9000000", "b.msh:10"].iter().all(|word| found.contains(word)), "{found}");
    expect(message("$Nodes", "$Noodles"), &["ends early", "$Noodles"]);
}

#[test]
fn the_mark_of_an_end_among_bytes_ends_no_section() {
    let ints = |values: &[i32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let sizes = |values: &[u64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let floats = |values: &[f64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let nodes = [sizes(&[1, 4, 1, 4]), ints(&[3, 1, 0]), sizes(&[4, 1, 2, 3, 4]), floats(&corners)].concat();
    let elements = [sizes(&[1, 1, 1, 1]), ints(&[3, 1, 4]), sizes(&[1, 1, 1, 2, 3, 4])].concat();
    let mark = [f64::from_le_bytes(*b"$EndNode"), f64::from_le_bytes(*b"Data\n\0\0\0")];
    let row = |node: i32| [ints(&[node]), floats(&[mark[0], mark[1], f64::from(node)])].concat();
    let values = (1..=4).map(row).collect::<Vec<_>>().concat();
    let section = |name: &str, head: &str, bytes: &[u8]| {
        [format!("${name}\n{head}").as_bytes(), bytes, format!("\n$End{name}\n").as_bytes()].concat()
    };
    let content = [
        section("MeshFormat", "4.1 1 8\n", &ints(&[1])),
        section("Nodes", "", &nodes),
        section("Elements", "", &elements),
        section("NodeData", "1\n\"v\"\n1\n0.0\n3\n0\n3\n4\n", &values),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.msh", &content.concat());
    let grid = grid(&path, &request("v:2"));
    assert_eq!(grid.scalar.as_ref().unwrap()[..], [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn negative_numbers_of_surfaces_are_errors_in_text_and_in_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(partitioned(2.2, None)).unwrap();
    let row = format!("20 2 2 1 6 {} ", TAGS[1]);
    assert!(text.contains(&row));
    let ints = |values: &[i32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let (sound, damaged) = (ints(&[20, 1, 6, TAGS[1] as i32]), ints(&[20, 1, 6, -5]));
    let mut bytes = partitioned(2.2, Some(false));
    let place = bytes.windows(sound.len()).position(|part| part == sound).unwrap();
    bytes.splice(place..place + sound.len(), damaged);
    for bytes in [text.replacen(&row, "20 2 2 1 6 -5 ", 1).into_bytes(), bytes] {
        let path = file(&folder, "a.msh", &bytes);
        let found = read(&path, &request("T"), &NoProgress).unwrap_err().to_string();
        assert!(found.contains("negative, -5"), "{found}");
    }
}

/// So many tetrahedra side by side, and as many cubes beside them; `is_missing`: three of the cubes name nodes that are not there.
fn rows(version: f64, count: usize, is_missing: bool) -> Vec<u8> {
    // Four nodes each at so many places, whose tags have gaps, and descend in the file of version 4.
    let tag = |node: usize| if version > 4.0 { 20 * count - 2 * node } else { 2 * node + 1 } as u64;
    let position = |node: usize| {
        let (place, corner) = (node / 4 % (count + 1), node % 4);
        let row = if node < 4 * (count + 1) { 0.0 } else { 9.0 };
        [place as f64, f64::from(u8::from(corner % 3 > 0)), row + f64::from(u8::from(corner > 1))]
    };
    let node_count = 8 * (count + 1);
    let tetrahedron = |cell: usize| [0, 1, 2, 4].map(|corner| tag(4 * cell + corner)).to_vec();
    let cube = |cell: usize| {
        let first = 4 * (count + 1 + cell);
        let mut nodes = [0, 1, 2, 3, 4, 5, 6, 7].map(|corner| tag(first + corner)).to_vec();
        if is_missing && [count - 1, count * 3 / 4, count * 5 / 8].contains(&cell) {
            nodes[7] = 99_000_000 + cell as u64;
        }
        nodes
    };
    let mut w = Writer { bytes: Vec::new(), big_endian: Some(false) };
    w.text(&format!("$MeshFormat\n{version} 1 8\n"));
    w.ints(&[1]);
    w.text("\n$EndMeshFormat\n$Nodes\n");
    if version > 4.0 {
        w.sizes(&[1, node_count as u64, 1, 20 * count as u64]);
        w.ints(&[3, 1, 0]);
        w.sizes(&[node_count as u64]);
        (0..node_count).for_each(|node| w.sizes(&[tag(node)]));
        (0..node_count).for_each(|node| w.doubles(&position(node)));
        w.text("\n$EndNodes\n$Elements\n");
        w.sizes(&[2, 2 * count as u64, 1, 2 * count as u64]);
        for (kind, first) in [(4, 1), (5, 1 + count)] {
            w.ints(&[3, 1, kind]);
            w.sizes(&[count as u64]);
            for cell in 0..count {
                w.sizes(&[(first + cell) as u64]);
                w.sizes(&if kind == 4 { tetrahedron(cell) } else { cube(cell) });
            }
        }
    } else {
        w.text(&format!("{node_count}\n"));
        for node in 0..node_count {
            w.ints(&[tag(node) as i32]);
            w.doubles(&position(node));
        }
        w.text(&format!("\n$EndNodes\n$Elements\n{}\n", 2 * count));
        for (kind, first) in [(4, 1), (5, 1 + count)] {
            w.ints(&[kind, count as i32, 2]);
            for cell in 0..count {
                let group = 1 + i32::from(cell * 9 > count);
                w.ints(&[(first + cell) as i32, group, 1]);
                let nodes = if kind == 4 { tetrahedron(cell) } else { cube(cell) };
                nodes.iter().for_each(|&node| w.ints(&[node as i32]));
            }
        }
    }
    w.text("\n$EndElements\n");
    w.bytes
}

#[test]
fn many_elements_are_numbered_alike_by_one_thread_and_by_several() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = Request { without_scalar: true, ..Request::default() };
    let count = 10_000;
    for version in [2.2, 4.1] {
        let sound = file(&folder, "a.msh", &rows(version, count, false));
        let damaged = file(&folder, "b.msh", &rows(version, count, true));
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let found = read(&damaged, &mesh, &NoProgress).unwrap_err().to_string();
                (grid(&sound, &mesh), inspect(&sound, &Request::default(), &NoProgress).unwrap(), found)
            })
        };
        let (one, summary, found) = of(1);
        let (four, of_four, found_by_four) = of(4);
        assert_eq!((&one.tetrahedra, &one.points), (&four.tetrahedra, &four.points), "{version}");
        assert_eq!(summary, of_four, "{version}");
        assert_eq!(summary.cell_count, 2 * count as u64, "{version}");
        // Tetrahedra of a sixth and cubes of 1, in sums of ten thousands.
        let expected = count as f64 * 7.0 / 6.0;
        assert!((volume(&one) - expected).abs() < 1e-7, "{version}: {}", volume(&one));
        for found in [found, found_by_four] {
            let (element, node) = (count + 1 + count * 5 / 8, 99_000_000 + count * 5 / 8);
            let words = [format!("element {element}"), node.to_string()];
            says(&found, &words);
        }
    }
}
