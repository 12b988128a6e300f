//! Meshes as text of UCD, SU2, Abaqus and Nastran: by meshio, and as manuals write them.

use super::refusals::{refused, says};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, files_beside, files_read_beside, foreign_head, inspect, read};
use voltet_testing::files::samples::file;

pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name)
}

pub fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

pub fn mesh() -> Request {
    Request { without_scalar: true, ..Request::default() }
}

pub fn scalar(name: &str) -> Request {
    Request { scalar: Some(name.to_owned()), ..Request::default() }
}

/// Corners of the tetrahedra in units of 1e-6, in ascending order.
fn tetrahedra(grid: &Grid) -> BTreeSet<Vec<[i64; 3]>> {
    let corners = |tetrahedron: &[u32; 4]| {
        let mut corners: Vec<[i64; 3]> = tetrahedron
            .iter()
            .map(|&p| grid.points[p as usize].to_array().map(|x| (x * 1e6).round() as i64))
            .collect();
        corners.sort_unstable();
        corners
    };
    grid.tetrahedra.iter().map(corners).collect()
}

#[test]
fn meshes_of_meshio_are_the_same_as_vtu() {
    let [linear, quadratic] =
        ["linear.vtu", "quadratic.vtu"].map(|name| tetrahedra(&grid(&sample(name), &mesh())));
    for name in ["mesh.ucd", "mesh.su2"] {
        assert_eq!(tetrahedra(&grid(&sample(name), &mesh())), linear, "{name}");
    }
    assert_eq!(tetrahedra(&grid(&sample("mesh.bdf"), &mesh())), quadratic);
    // The file for Abaqus lacks the pyramid, which lies from x = 9 to 12.
    let is_pyramid =
        |corners: &Vec<[i64; 3]>| corners.iter().all(|p| (9_000_000..12_000_000).contains(&p[0]));
    let without = quadratic.iter().filter(|corners| !is_pyramid(corners)).cloned().collect::<BTreeSet<_>>();
    assert_eq!(without.len() + 2, quadratic.len());
    assert_eq!(tetrahedra(&grid(&sample("mesh.inp"), &mesh())), without);
    for name in ["f", "g"] {
        let (found, expected) =
            (grid(&sample("mesh.ucd"), &scalar(name)), grid(&sample("linear.vtu"), &scalar(name)));
        assert_eq!(found.points, expected.points, "{name}");
        let values = found.scalar.as_ref().unwrap().iter().zip(expected.scalar.as_ref().unwrap().iter());
        // meshio writes values of at most 100 with 14 digits.
        assert!(values.into_iter().all(|(found, expected)| (found - expected).abs() < 1e-11), "{name}");
    }
}

#[test]
fn ucd_has_vectors_materials_and_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let text = "# a comment\n# another\n5 3 4 1 0\n10 0 0 0\n20 1 0 0\n5 0 1 0\n7 0 0 1\n9 1 1 1\n\
        1 4 tet 10 20 5 7\n3 2 tri 10 20 5\n2 6 tet 20 5 7 9\n2 3 1\nU, m/s\np, Pa\n\
        10 1 2 3 100\n20 4 5 6 200\n5 7 8 9 300\n7 10 11 12 400\n9 13 14 15 500\n1 1\nload, N\n1 0.5\n3 9\n2 0.25\n";
    let path = file(&folder, "a.inp", text.as_bytes());
    assert_eq!(**grid(&path, &scalar("U:1")).scalar.as_ref().unwrap(), [2.0, 5.0, 8.0, 11.0, 14.0]);
    assert_eq!(**grid(&path, &scalar("p")).scalar.as_ref().unwrap(), [100.0, 200.0, 300.0, 400.0, 500.0]);
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let blocks: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
    assert_eq!((blocks, summary.cell_count, summary.point_count), (vec!["4", "6"], 2, 5));
    let part = grid(&path, &Request { blocks: vec!["6".into()], ..scalar("load") });
    assert_eq!(**part.scalar.as_ref().unwrap(), [0.25; 4]);
    let blank = ["9 1 1 1\n", "2 6 tet 20 5 7 9\n", "10 1 2 3 100\n"];
    let blank =
        blank.iter().fold(text.to_owned(), |text, row| text.replacen(row, &format!("{row} \n\r\n"), 1));
    let names = ["U:2", "load", "U"].map(String::from).to_vec();
    let several = grid(&path, &Request { point_arrays: names, ..scalar("p") });
    assert_eq!(several.scalar, grid(&path, &scalar("p")).scalar);
    assert_eq!(*several.point_arrays["U:2"].values, [3.0, 6.0, 9.0, 12.0, 15.0]);
    assert_eq!(several.point_arrays["U"].values[..6], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(Some(&several.point_arrays["load"].values), grid(&path, &scalar("load")).scalar.as_ref());
    let gaps = grid(&file(&folder, "b.inp", blank.as_bytes()), &scalar("load"));
    assert_eq!(gaps.scalar, grid(&path, &scalar("load")).scalar);
    let message = |from: &str, to: &str| {
        assert!(text.contains(from));
        let path = file(&folder, "a.inp", text.replacen(from, to, 1).as_bytes());
        read(&path, &scalar("p"), &NoProgress).unwrap_err().to_string()
    };
    for (from, to, words) in [
        ("6 tet", "6 tat", ["'tat'", "tet, hex", "a.inp:11"]),
        ("20 5 7 9", "20 5 7 99", ["element 2", "does not exist", "found 99"]),
        ("2 3 1\n", "2 3 2\n", ["numbers of components", "'2 3 2'", "sum 4"]),
        ("7 10 11 12 400", "7 10 11 12 4OO", ["damaged", "'4OO'", "a.inp:18:1, 'p')"]),
    ] {
        let found = message(from, to);
        says(&found, &words);
    }
    let cut = |from: &str| message(&text[text.find(from).unwrap()..], "");
    for (from, words) in [
        ("5 0 1 0\n7", "the file ends early: found 2; expected 5 rows of nodes (PATH:5:1)"),
        ("3 2 tri", "the file ends early: found 1; expected 3 rows of cells (PATH:9:1)"),
        ("3 9\n", "the file ends early: found 1; expected 3 rows of values (PATH:22:1)"),
    ] {
        assert_eq!(cut(from), words.replace("PATH", path.to_str().unwrap()));
    }
}

#[test]
fn ucd_heads_may_lie_or_stand_behind_long_comments() {
    let folder = tempfile::tempdir().unwrap();
    let text = "4 1 WIDTH 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n1 4 tet 1 2 3 4\n1 WIDTH\np, Pa\n1 1\n2 2\n3 3\n4 4\n";
    let lie = file(&folder, "a.inp", text.replace("WIDTH", "3000000000000").as_bytes());
    let found = read(&lie, &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("do not fit the file") && found.contains("4 rows of 3000000000000"), "{found}");
    for length in 245..260 {
        let text = format!("#{}\n{}", "-".repeat(length), text.replace("WIDTH", "1"));
        let path = file(&folder, "b.inp", text.as_bytes());
        assert_eq!(**grid(&path, &scalar("p")).scalar.as_ref().unwrap(), [1.0, 2.0, 3.0, 4.0], "{length}");
    }
}

#[test]
fn nastran_has_three_forms_of_fields() {
    let folder = tempfile::tempdir().unwrap();
    let text = "SOL 101\nCEND\nBEGIN BULK\n$ a comment\nPSOLID,1,1\nGRID    1               0.      0.      0.\n\
        GRID,2,,1.0,0.0,0.0\ngrid*,3,,0.,10.0-1,\n*,0.D+0\nGRID*                  4                              0.              0.\n\
        *                   1.+0\nGRID    5               1.      1.      1.      123\n\
        CTETRA  1       1       1       2       3       4\nCTETRA,2,7,2,3\n+,\nCTRIA3  3       1       1       2       3\nENDDATA\nGRID,9,,x\n";
    let text = text.replace("CTETRA,2,7,2,3\n+,\n", "CTETRA,2,7,2,3,4,5\n");
    let path = file(&folder, "a.bdf", text.as_bytes());
    let all = grid(&path, &mesh());
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    assert_eq!(all.points.iter().map(|p| p.to_array()).collect::<Vec<_>>(), points);
    assert_eq!(*all.tetrahedra, [[0, 1, 2, 3], [1, 2, 3, 4]]);
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    assert_eq!(summary.blocks.iter().map(|block| &*block.name).collect::<Vec<_>>(), ["1", "7"]);
    let tabs = text.replacen(
        "GRID    5               1.      1.      1.      123",
        "GRID\t5\t\t1.\t 1.\t1.      123",
        1,
    );
    assert_eq!(grid(&file(&folder, "b.bdf", tabs.as_bytes()), &mesh()).points, all.points);
    assert_ne!(tabs, text);
    for (from, to, words) in [
        ("PSOLID,1,1", "include 'more.bdf'", ["a.bdf' names", "no such file", "more.bdf"]),
        ("PSOLID,1,1", "include \"./a.bdf\"", ["includes itself", "'./a.bdf'", "a.bdf:5"]),
        ("PSOLID,1,1", "include 'more.bdf", ["which file it includes", "in quotes", "a.bdf:5"]),
        ("GRID,2,,1.0", "GRID,2,4,1.0", ["not defined", "found 4", "a.bdf:7"]),
        ("GRID,2,,1.0", "GRID,2,,l.0", ["coordinate of a GRID", "'l.0'", "a.bdf:7"]),
        ("2,7,2,3,4,5", "2,7,2,3,4,6", ["element 2", "does not exist", "found 6"]),
    ] {
        let path = file(&folder, "a.bdf", text.replacen(from, to, 1).as_bytes());
        refused(&path, &mesh(), &words);
    }
}

#[test]
fn nastran_is_told_by_its_content_and_may_lack_nodes_on_edges() {
    let folder = tempfile::tempdir().unwrap();
    // The title is one of Tecplot, too, and the bulk data begin far behind.
    let text = format!(
        "TITLE = a deck\n{}BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nGRID,5,,.5,0.,0.\n\
         GRID,6,,1.,1.,1.\nCTETRA,1,1,1,2,3,4\nCTETRA,2,1,2,3,4,6,,0\n,,,5\nENDDATA\n",
        "$ a comment of a case\n".repeat(150)
    );
    let path = file(&folder, "a.dat", text.as_bytes());
    let all = grid(&path, &mesh());
    assert_eq!((&all.tetrahedra[..], all.points[4].y), (&[[0, 1, 2, 3], [1, 2, 3, 4]][..], 1.0));
    let words = "The points of 1 cell beyond those that their type of cell has are left out.";
    assert!(all.origin.warnings.iter().any(|warning| warning == words), "{:?}", all.origin.warnings);
}

#[test]
fn formats_of_text_are_told_by_whole_words() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nCTETRA,1,1,1,2,3,4\n";
    // The ending of the name comes before a title; words that only resemble those of Nastran mean nothing.
    let path = file(&folder, "a.bdf", format!("TITLE = a deck\n{deck}").as_bytes());
    assert_eq!(grid(&path, &mesh()).tetrahedra.len(), 1);
    let path = file(&folder, "b.bdf", format!("$NODES\n{deck}").as_bytes());
    assert_eq!(grid(&path, &mesh()).tetrahedra.len(), 1);
    let nodes = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
    let path = file(&folder, "a.inp", format!("*HEADING\nGrid, 20 x 20 x 20\ncenter\n{nodes}").as_bytes());
    assert_eq!(grid(&path, &mesh()).tetrahedra.len(), 1);
    // Readers from outside come first where words of Abaqus stand further behind.
    for (comment, is_foreign) in [("** of a mesh\n", false), (&*"** of a mesh\n".repeat(30), true)] {
        let path = file(&folder, "a.cells", format!("{comment}{nodes}").as_bytes());
        assert_eq!(grid(&path, &mesh()).tetrahedra.len(), 1);
        assert_eq!(foreign_head(&path).is_some(), is_foreign, "{comment}");
    }
    // Files that are included are seen wherever the words that tell the format stand.
    let begin = format!("{}INCLUDE 'a.bdf'\nBEGIN BULK\n", "$ of a mesh\n".repeat(30));
    let path = file(&folder, "c.txt", begin.as_bytes());
    assert_eq!(files_beside(&path), [folder.path().join("a.bdf")]);
    let path = file(&folder, "b.dat", b"Grids of a city\ncenter, begin bulky\nGrid  of all\n");
    let found = read(&path, &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("the format of the file is not known"), "{found}");
}

#[test]
fn nastran_includes_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("parts/deep")).unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    let grids = ["GRID,1\n", "GRID,2,,1.\n", "GRID,3,,,1.\n", "GRID,4,9,,,1.\n", "GRID,5,,1.,1.,1.\n"];
    let elements = "CTETRA,1,1,1,2,3,4\nCTETRA,2,7,2,3,4,5\n";
    let system = "CORD2R,9,,,,,,,1.\n+,1.\n";
    let whole = grid(&write("whole.bdf", &format!("{}{system}{elements}", grids.concat())), &mesh());
    // Names go on over lines, and are relative to the folder of their file or of the first one; the data end anywhere.
    write("parts/nodes.bdf", &format!("{}\tInclude deep/more.bdf $ 'x'\n{}", grids[0], grids[1]));
    write("parts/deep/more.bdf", &format!("{}INCLUDE\n  \"systems.bdf\"\n{}", grids[2], grids[4]));
    let systems = write("systems.bdf", system);
    write("end.bdf", &format!("{}{elements}ENDDATA\nINCLUDE 'none.bdf'\n", grids[3]));
    let text = "BEGIN BULK\nINCLUDE 'parts\\\n   nodes.\nbdf' $ nodes\r\nINCLUDE 'end.bdf'\nGRID,6\nINCLUDE none.bdf\n";
    let path = write("a.bdf", text);
    let found = grid(&path, &mesh());
    assert_eq!((tetrahedra(&found), found.points.len()), (tetrahedra(&whole), 5));
    assert_eq!([files_beside(&path).len(), files_read_beside(&path, &mesh()).len()], [4; 2]);
    assert_eq!(inspect(&path, &mesh(), &NoProgress).unwrap().blocks.len(), 2);
    let message = |path: &Path| read(path, &mesh(), &NoProgress).unwrap_err().to_string();
    for (from, to, words) in [
        (",,1.\n+", ",,x\n+", ["CORD2R is damaged", "'x'", "systems.bdf:1"]),
        ("+,1.", "+,,,1.", ["lie on a line", "of a plane", "systems.bdf:1"]),
        ("CORD2R,9", "CORD2R,8", ["is not defined", "found 9", "end.bdf:1"]),
        ("CORD2R,9", "\nINCLUDE 'a.bdf'\nCORD2R,9", ["includes itself", "'a.bdf'", "systems.bdf:2"]),
    ] {
        assert!(system.contains(from), "{from}");
        write("systems.bdf", &system.replacen(from, to, 1));
        assert!(words.iter().all(|word| message(&path).contains(word)), "{}", message(&path));
    }
    std::fs::remove_file(systems).unwrap();
    assert!(["more.bdf' names", "systems.bdf"].iter().all(|word| message(&path).contains(word)));
    // Files within one another, and one that is included again and again.
    for depth in 0..20 {
        write(&format!("{depth}.bdf"), &format!("INCLUDE '{}.bdf'\n", depth + 1));
    }
    write("16.bdf", &format!("{}{system}{elements}", grids.concat()));
    assert_eq!(grid(&folder.path().join("0.bdf"), &mesh()).points.len(), 5);
    write("16.bdf", "INCLUDE '17.bdf'\n");
    let found = message(&folder.path().join("0.bdf"));
    assert!(
        ["too many others", "'17.bdf'", "16 within", "16.bdf:1"].iter().all(|word| found.contains(word)),
        "{found}"
    );
    write("empty.bdf", "$\n");
    let found = message(&write("many.bdf", &"INCLUDE 'empty.bdf'\n".repeat(1025)));
    assert!(found.contains("at most 1024") && found.contains("many.bdf:1025"), "{found}");
}

#[test]
fn nastran_names_the_files_that_it_includes_in_many_ways() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    let (grids, rest) = ("GRID,1\nGRID,2,,1.\nGRID,3,,,1.\n", "GRID,4,,,,1.\nCTETRA,1,1,1,2,3,4\n");
    write("b.bdf", grids);
    write("b$1.bdf", grids);
    write("empty.bdf", "");
    for include in [
        "INCLUDE $ nodes\n 'b.bdf'",
        "INCLUDE\n$ 'nodes'\n\n  'b.bdf'",
        "INCLUDE b.bdf$ 'x'",
        "INCLUDE'b.bdf'",
        "INCLUDE 'b.bdf' $ it's",
        "INCLUDE \"b\n$1.bdf\"",
        "INCLUDE b.bdf\nINCLUDE 'empty.bdf'",
    ] {
        let path = write("a.bdf", &format!("{include}\n{rest}"));
        assert_eq!(tetrahedra(&grid(&path, &mesh())).len(), 1, "{include}");
        let count = 1 + usize::from(include.contains("empty"));
        assert_eq!([files_beside(&path).len(), files_read_beside(&path, &mesh()).len()], [count; 2]);
    }
    for include in ["INCLUDE\nGRID,1,,0.", "INCLUDE $ 'b.bdf'", "INCLUDE\nb.bdf"] {
        let path = write("a.bdf", &format!("$\n{include}\n{grids}{rest}"));
        let found = read(&path, &mesh(), &NoProgress).unwrap_err().to_string();
        assert!(found.contains("which file it includes") && found.contains("a.bdf:2"), "{include}: {found}");
    }
}

#[test]
fn an_entry_of_nastran_does_not_go_on_behind_an_include() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    let rest = "GRID,2,,1.\nGRID,3,,,1.\nGRID,4\nCTETRA,1,1,1,2,3,4\n";
    write("shell.bdf", "PSHELL,1,1,0.1\n");
    write("goes_on.bdf", "$ the rest\n\n*,9.\n");
    for (text, place) in [
        ("GRID*,1,,0.,0.\nINCLUDE 'shell.bdf'\n*,9.\n", "a.bdf:3"),
        ("GRID*,1,,0.,0.\nINCLUDE 'goes_on.bdf'\n", "goes_on.bdf:3"),
    ] {
        let path = write("a.bdf", &format!("{text}{rest}"));
        for found in [
            read(&path, &mesh(), &NoProgress).unwrap_err().to_string(),
            inspect(&path, &mesh(), &NoProgress).unwrap_err().to_string(),
        ] {
            assert!(
                ["goes on behind an INCLUDE", "'*,9.'", place].iter().all(|word| found.contains(word)),
                "{found}"
            );
        }
    }
    // Before all entries the same letters are of something else.
    let text = format!(
        "SUBCASE 1\nINCLUDE 'shell.bdf'\n          LOAD = 1\nBEGIN BULK\nGRID*,1,,0.,0.\n*,9.\n{rest}"
    );
    assert_eq!(grid(&write("a.bdf", &text), &mesh()).points[0], DVec3::new(0.0, 0.0, 9.0));
}

#[test]
fn files_that_are_included_again_and_again_are_limited_by_their_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    // Once and seven times again are below four times the files and a MiB, one more is not.
    let comment = |sign: &str| format!("{sign} {}\n", "x".repeat(97)).repeat(3500);
    write("b.bdf", &comment("$"));
    write("b.inp", &comment("**"));
    for (name, include, mesh_of) in [
        ("a.bdf", "INCLUDE 'b.bdf'\n", "GRID,1\nGRID,2,,1.\nGRID,3,,,1.\nGRID,4,,,,1.\nCTETRA,1,1,1,2,3,4\n"),
        (
            "a.inp",
            "*INCLUDE, INPUT=b.inp\n",
            "*NODE\n1\n2,1\n3,0,1\n4,0,0,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n",
        ),
    ] {
        let text = |count: usize| format!("{mesh_of}{}", include.repeat(count));
        assert_eq!(grid(&write(name, &text(7)), &mesh()).tetrahedra.len(), 1);
        let path = write(name, &text(9));
        let found = read(&path, &mesh(), &NoProgress).unwrap_err().to_string();
        let place = format!("{name}:{}", mesh_of.lines().count() + 8);
        let words = ["too many others", &name.replacen('a', "'b", 1), "bytes of files", &place];
        says(&found, &words);
    }
}

#[test]
fn abaqus_has_parts_instances_and_sets() {
    let folder = tempfile::tempdir().unwrap();
    let text = "*Heading\n** a comment\n*Part, name=Block\n*Node\n 1, 0., 0., 0.\n 2, 1., 0.\n 3, 0., 1., 0.\n 4, 0., 0., 1.\n\
        5, 1., 1., 1.\n*Element, type=C3D4\n 1, 1, 2,\n 3, 4\n 2, 2, 3, 4, 5\n*Element, type=S3\n 3, 1, 2, 3\n\
        *Elset, elset=low, generate\n 1, 1, 1\n*Elset, elset=all\n 1, 2\n*End Part\n*Assembly, name=A\n\
        *Instance, name=first, part=Block\n*End Instance\n*Instance, name=second, part=block\n 5., 0., 0.\n\
        5., 0., 0., 5., 0., 1., 90.\n*End Instance\n*Node\n 1, 9., 9., 9.\n*End Assembly\n*Element Output\n";
    let path = file(&folder, "a.inp", text.as_bytes());
    let all = grid(&path, &mesh());
    assert_eq!((all.tetrahedra.len(), all.points.len()), (4, 10));
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
    assert_eq!(names, ["first/low", "first/all", "second/low", "second/all"]);
    let turned = grid(&path, &Request { blocks: vec!["second/low".into()], ..mesh() });
    let expected = [[5.0, 0.0, 0.0], [5.0, 1.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 1.0]];
    // Rounding of a rotation.
    let is_near = |(p, q): (&DVec3, &[f64; 3])| p.distance(DVec3::from_array(*q)) < 1e-15;
    assert!(turned.points.iter().zip(&expected).all(is_near), "{:?}", turned.points);
    let flat = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=DC3D4, ELSET=steel\n1,1,2,3,4\n";
    assert_eq!(grid(&file(&folder, "b.inp", flat.as_bytes()), &mesh()).tetrahedra.len(), 1);
    let blanks = flat.replace('*', "  *");
    assert_eq!(grid(&file(&folder, "b.inp", blanks.as_bytes()), &mesh()).tetrahedra.len(), 1);
    let ranges = format!("{flat}*ELSET, ELSET=all, GENERATE\n{}", "1, 200\n".repeat(300));
    let ranges = file(&folder, "b.inp", ranges.as_bytes());
    let found = read(&ranges, &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("more elements than the file"), "{found}");
    let twice = text.replacen("*Part, name=Block\n", "*Part, name=Block\n*Node\n 5, 1., 1., 1.\n", 1);
    let found =
        read(&file(&folder, "b.inp", twice.as_bytes()), &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("holds a node twice") && found.contains("found node 5;"), "{found}");
    for (from, to, words) in [
        ("*Node\n", "*Node, input=nodes.inp\n", ["no such file", "a.inp' names", "nodes.inp"]),
        ("type=C3D4", "type=C3D4, input=", ["which file it includes", "*ELEMENT", "a.inp:10"]),
        ("C3D4", "C3D15V", ["not read", "C3D15V", "a.inp:10"]),
        ("part=block", "part=blok", ["does not exist", "'blok'", "a.inp:24"]),
        (" 3, 4\n 2, 2, 3", " 3\n 2, 2, 3", ["too many nodes", "element 1", "a.inp:13"]),
        ("2, 3, 4, 5\n", "2, 3, 4\n", ["element 2 ends early", "found 3", "a.inp:13"]),
        ("*Heading", "*Include", ["*INCLUDE", "which file it includes", "a.inp:1"]),
        ("*Heading", "*Include, input=a.inp", ["too many others", "'a.inp'", "none within itself"]),
        ("*Heading", "*Ngen", ["*NGEN", "is not read", "a.inp:1"]),
        (" 1, 0., 0.", " 1, O., 0.", ["damaged", "'O.'", "a.inp:5"]),
        ("1, 1, 1\n", "1, 1000000000000, 1\n", ["more elements than the file", "step", "a.inp:17"]),
    ] {
        let path = file(&folder, "a.inp", text.replacen(from, to, 1).as_bytes());
        refused(&path, &mesh(), &words);
    }
}

#[test]
fn abaqus_includes_files_of_keywords_and_of_data() {
    let folder = tempfile::tempdir().unwrap();
    let (nodes, more) = ("1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n", "5,1,1,1\n");
    let elements = "1,1,2,3,4\n2,2,3,4,5\n";
    let keyword = "*ELEMENT, TYPE=C3D4, ELSET=steel\n";
    let whole = format!("*NODE\n{nodes}{more}{keyword}{elements}*MATERIAL, NAME=steel\n");
    let whole = grid(&file(&folder, "whole.inp", whole.as_bytes()), &mesh());
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    // Names are relative to the folder of the first file; a file of data goes on with the keyword before it.
    write("parts/mesh.inp", &format!("** all\n*INCLUDE, INPUT=parts/nodes.inp\n{keyword}{elements}"));
    write("parts/nodes.inp", &format!("*NODE\n{nodes}*INCLUDE, INPUT=parts/more.inp\n"));
    write("parts/more.inp", more);
    write("elements.txt", elements);
    let first = write("a.inp", "*INCLUDE, INPUT=\"parts\\mesh.inp\"\n*MATERIAL, NAME=steel\n");
    let second = format!(
        "*NODE, INPUT=parts/more.inp\n*NODE\n{nodes}*ELEMENT, TYPE=C3D4, ELSET=steel, INPUT=elements.txt\n*STEP\n"
    );
    let second = write("b.inp", &second);
    for (path, count) in [(&first, 3), (&second, 2)] {
        let found = grid(path, &mesh());
        assert_eq!((tetrahedra(&found), found.points.len()), (tetrahedra(&whole), 5), "{}", path.display());
        assert_eq!([files_beside(path).len(), files_read_beside(path, &mesh()).len()], [count; 2]);
    }
    // What is remembered of them ends with a change of any, and of a missing one nothing is.
    let nested = write("parts/nodes.inp", &format!("*NODE\n{nodes}{more}"));
    assert_eq!(files_beside(&first).len(), 2);
    std::fs::remove_file(&nested).unwrap();
    assert!(files_beside(&first).len() < 2);
    write("parts/nodes.inp", &format!("*NODE\n{nodes}*INCLUDE, INPUT=parts/more.inp\n"));
    assert_eq!(files_beside(&first).len(), 3);
    let message = |path: &Path| read(path, &mesh(), &NoProgress).unwrap_err().to_string();
    write("parts/more.inp", "5,1,x,1\n");
    assert!([&first, &second].iter().all(|path| message(path).contains("more.inp:1")), "{}", message(&first));
    write("elements.txt", "1,1,2,3,4\n2,2,3,4\n");
    write("parts/more.inp", more);
    assert!(message(&second).contains("elements.txt:2"), "{}", message(&second));
}

#[test]
fn abaqus_goes_on_after_an_included_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| file(&folder, name, text.as_bytes());
    let (nodes, keyword) = ("1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n", "*ELEMENT, TYPE=C3D4");
    let (element, other) = ("1,1,2,3,4\n", "2,2,3,4,5\n");
    let whole = format!("*NODE\n{nodes}{keyword}\n{element}{other}");
    let whole = tetrahedra(&grid(&write("whole.inp", &whole), &mesh()));
    write("element.txt", element);
    write("other.txt", other);
    write("empty.txt", "");
    write("nested.txt", &format!("{element}*INCLUDE, INPUT=other.txt\n"));
    write("before.txt", &format!("*INCLUDE, INPUT=element.txt\n{other}"));
    let include = |name: &str| format!("*INCLUDE, INPUT={name}\n");
    for lines in [
        format!("\n{}{other}", include("element.txt")),
        format!("\n{}{}", include("element.txt"), include("other.txt")),
        format!("\n{}", include("nested.txt")),
        format!("\n{}", include("before.txt")),
        format!(", INPUT=element.txt\n{other}"),
        format!(", INPUT=element.txt\n{}", include("other.txt")),
        format!("\n{}{element}{other}", include("empty.txt")),
        format!(", INPUT=empty.txt\n{element}{other}"),
    ] {
        let found = grid(&write("a.inp", &format!("*NODE\n{nodes}{keyword}{lines}")), &mesh());
        assert_eq!(tetrahedra(&found), whole, "{lines}");
    }
    // The limit on sets is by all files, each once.
    let elements: String = (1..200).map(|number| format!("{number},1,2,3,4\n")).collect();
    write("mesh.inp", &format!("*NODE\n{nodes}{keyword}\n{elements}"));
    let set = |last: u32| format!("*ELSET, ELSET=all, GENERATE\n1,{last},1\n");
    let path = write("b.inp", &format!("{}*INCLUDE, INPUT=mesh.inp\n", set(199)));
    assert_eq!(inspect(&path, &mesh(), &NoProgress).unwrap().blocks[0].name, "all");
    write("c.txt", &format!("** {}\n", "x".repeat(4000)));
    let path = write("c.inp", &format!("*NODE\n{nodes}{}{}", set(3000), include("c.txt").repeat(20)));
    let found = read(&path, &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("more elements than the file") && found.contains("c.inp:8"), "{found}");
}

/// Systems of every kind, defined by nodes and points of others.
const SYSTEMS: &str = include_str!("../files/systems.bdf");

#[test]
fn nastran_has_systems_of_coordinates_as_pynastran_has() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.bdf", SYSTEMS.as_bytes());
    // Positions of all points by pyNastran (get_position).
    let expected = [
        [0.0, 0.0, 0.0],
        [2.0, 3.732050807568877, 4.5],
        [3.183342471764592, 5.253386924904077, 5.928362829059618],
        [-0.7665917435607419, 2.4588351567716877, 3.0431307365688847],
        [-0.15864496712741705, 2.7184639187870054, 3.031359322559836],
        [0.9271867858065084, 0.8765249983145786, 3.971952063297299],
        [1.2334765021752807, 5.914167640631258, 5.221678539733476],
        [0.8844527101660029, 1.9788169776800195, 4.39041443779381],
        [1.0, 0.5, 0.25],
        [2.4095389311788624, 2.513030214988503, 5.0],
        [2.3547181702573576, 3.8606057764034714, 4.342020143325668],
        [1.0337832159689206, 3.9591923000307583, 4.626664268822006],
    ];
    let found = grid(&path, &mesh());
    assert_eq!(found.points.len(), expected.len());
    for own in expected.map(DVec3::from_array) {
        assert!(found.points.iter().any(|point| point.distance(own) < 1e-12), "{own}");
    }
    for (from, to, words) in [
        ("GRID,8,7,", "GRID,8,9,", ["not defined", "found 9", "a.bdf:18"]),
        ("CORD2C,1,0,", "CORD2C,1,3,", ["by each other", "found ", "basic one"]),
        ("CORD1S,7,13,", "CORD1S,7,99,", ["node that does not exist", "found 99", "a.bdf:10"]),
        ("CORD1S,7,", "CORD1S,6,", ["is taken", "found 6", "a.bdf:10"]),
        (",2.0,2.0,3.0\n", ",1.0,2.0,9.0\n", ["on a line", "[1, 2, 3]", "a.bdf:2"]),
        ("GRID,1,", "GRDSET,,2\nGRID,1,", ["for all points", "GRDSET", "a.bdf:11"]),
    ] {
        assert!(SYSTEMS.contains(from), "{from}");
        let path = file(&folder, "a.bdf", SYSTEMS.replacen(from, to, 1).as_bytes());
        refused(&path, &mesh(), &words);
    }
}
