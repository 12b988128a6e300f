//! Tecplot data as text: by meshio, and in the forms of its guide.

use super::packed;
use std::path::Path;
use voltet_core::grid::{Association, CellValues, Grid, Options};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, inspect, read};
use voltet_testing::files::samples::file;

fn request(scalar: &str) -> Request {
    let options = Options { cell_values: CellValues::Constant, ..Options::default() };
    Request { scalar: Some(scalar.to_owned()), options, ..Request::default() }
}

fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_file_of_meshio_has_the_field_in_every_cell() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/mesh.dat");
    let grid = grid(&path, &request("f"));
    for (p, &f) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
        // Products of coordinates of at most 13.
        assert!((f - (p.x * p.x - p.x * p.y + 2.0 * p.y * p.z + p.z - 0.5)).abs() < 1e-12, "{f} at {p}");
    }
    let of = |i: usize| voltet_core::grid::tetrahedron_volume(grid.corners(i));
    let volume: f64 = (0..grid.tetrahedra.len()).map(of).sum();
    // A tetrahedron, a brick with corners twice, and a cube, as the map of make_meshes.py makes them.
    assert!((volume - (1.0 / 6.0 + 1.0) * 0.987).abs() < 1e-12, "{volume}");
}

const TEXT: &str = "# a comment\nTITLE = \"two zones, \"\"in time\"\"\nVARIABLES = \"X [m]\" \"Y [m]\"\n\"Z [m]\", \"T\"\n\"load\"\n\
    ZONE T=\"solid\", N=5, E=2, DATAPACKING=BLOCK, ZONETYPE=FETETRAHEDRON\nVARLOCATION=([5]=CELLCENTERED), SOLUTIONTIME=1.5\n\
    STRANDID=1\n0 1 0 0 1\n0 0 1 0 1\n0 0 0 1 1\n5*7.5\n-1 2.5\n1 2 3 4\n2 3 4 5\n\
    ZONE T=\"box\" I=2 J=2 K=2 F=BLOCK SOLUTIONTIME=1.5 VARLOCATION=([5]=CELLCENTERED)\n4 5 4 5 4 5 4 5\n0 0 1 1 0 0 1 1\n0 0 0 0 1 1 1 1\n\
    1 2 3 4 5 6 7 8\n9\n\
    ZONE T=\"wall\" N=3 E=1 ET=TRIANGLE F=FEPOINT\n0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n1 2 3\n\
    ZONE T=\"solid\", N=5, E=2, DATAPACKING=BLOCK, ZONETYPE=FETETRAHEDRON VARLOCATION=([5]=CELLCENTERED)\n\
    VARSHARELIST=([1-3]=1), CONNECTIVITYSHAREZONE=1, SOLUTIONTIME=3\n2*1 3*2\n4 5\n";

#[test]
fn zones_are_blocks_and_steps() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.dat", TEXT.as_bytes());
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
    assert_eq!((names, summary.time_steps), (vec!["solid", "box"], vec![1.5, 3.0]));
    let all = grid(&path, &request("T"));
    assert_eq!(all.tetrahedra.len(), 2 + 6);
    for (p, &t) in all.points.iter().zip(all.scalar.as_ref().unwrap().iter()) {
        assert_eq!(t, if p.x < 3.0 { 7.5 } else { 1.0 + (p.x - 4.0) + 2.0 * p.y + 4.0 * p.z });
    }
    let part = grid(&path, &Request { blocks: vec!["solid".into()], ..request("load") });
    assert_eq!(**part.scalar.as_ref().unwrap(), [-1.0, -1.0, -1.0, -1.0, 2.5, 2.5, 2.5, 2.5]);
    // The later zone has points and cells of the first.
    let later = grid(&path, &Request { time_step: Some(TimeStep::Time(3.0)), ..request("T") });
    assert_eq!((later.points.len(), &later.points[4..]), (5, &all.points[4..5]));
    assert_eq!(**later.scalar.as_ref().unwrap(), [1.0, 1.0, 2.0, 2.0, 2.0]);
    let others = TEXT.replacen("([5]=CELLCENTERED)", "(NODAL NODAL,NODAL, NODAL\n,CELLCENTERED)", 1);
    let path = file(&folder, "a.dat", others.replacen("=1.5", "=1.5D+00", 1).as_bytes());
    let same = grid(&path, &Request { blocks: vec!["solid".into()], ..request("load") });
    assert_eq!(same.scalar, part.scalar);
    assert_eq!(inspect(&path, &Request::default(), &NoProgress).unwrap().time_steps, [1.5, 3.0]);
    let point = "variables = x, y, z, s zone t=one n=4, e=1, f=fepoint, et=tetrahedron\n\
        0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n1 2 3 4\n";
    let path = file(&folder, "b.dat", point.as_bytes());
    assert_eq!(**grid(&path, &request("s")).scalar.as_ref().unwrap(), [1.0, 2.0, 3.0, 4.0]);
    assert!(inspect(&path, &Request::default(), &NoProgress).unwrap().blocks.is_empty());
}

#[test]
fn mistakes_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, words) in [
        ("FETETRAHEDRON", "FEPOLYHEDRON", ["not read", "FEPOLYHEDRON", "a.dat:"]),
        ("N=5,", "N=five,", ["NODES of a zone", "'five'", "a.dat:"]),
        ("2 3 4 5", "2 3 4 6", ["does not exist", "found 6", "a.dat:15"]),
        ("0 0 1 0 1", "0 0 l 0 1", ["damaged", "'l'", "a.dat:10"]),
        ("-1 2.5", "-1 7*2.5", ["beyond its zone", "found 7", "a.dat:13"]),
        ("([1-3]=1)", "(1,2,3)", ["VARSHARELIST", "(1,2,3)", "brackets"]),
        ("[1-3]=1", "[1-3]=9", ["shares", "'9'", "at most 3"]),
        ("N=5,", "N=5000000000,", ["does not fit the file", "5000000000", "a.dat:"]),
        ("ZONE T=\"box\"", "VARIABLES=a b c ZONE", ["change between zones", "found 3", "5 variables"]),
        ("2 3 4 5\n", "2 3 4 5\n7 7\n", ["no zone", "'7'", "a.dat:16"]),
        ("ZONE T=\"box\"", "ZONE\nZONE", ["zone without numbers", "not read", "a.dat:"]),
        ("=CELLCENTERED", "=CELLCENTRED", ["VARLOCATION", "'CELLCENTRED'", "NODAL or CELLCENTERED"]),
        ("[5]=CELL", "[9]=CELL", ["VARLOCATION", "'9'", "in brackets"]),
        ("SOLUTIONTIME=1.5", "SOLUTIONTIME=l.5", ["SOLUTIONTIME", "'l.5'", "a number"]),
        ("TITLE", "FILETYPE=SOLUTION\nTITLE", ["no coordinates", "SOLUTION", "FULL"]),
        ("DATAPACKING=BLOCK", "DATAPACKING=POINT", ["at cells", "side by side", "BLOCK"]),
    ] {
        assert!(TEXT.contains(from));
        let path = file(&folder, "a.dat", TEXT.replacen(from, to, 1).as_bytes());
        let found = read(&path, &request("T"), &NoProgress);
        let found = found.map(|_| from).unwrap_err().to_string();
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
    }
}

fn whole(association: Option<Association>, scalar: &str) -> Request {
    Request { association, ..packed::request(scalar) }
}

/// The same points, values and volume; wedges and pyramids are bricks here, which are split in another way.
fn same_values(found: &Grid, expected: &Grid, what: &str) {
    let values = |grid: &Grid| grid.scalar.as_ref().unwrap().to_vec();
    assert_eq!(found.points.len(), expected.points.len(), "{what}");
    let rows = |grid: &Grid| grid.points.iter().copied().zip(values(grid)).collect::<Vec<_>>();
    for ((p, own), (q, other)) in rows(found).into_iter().zip(rows(expected)) {
        // Single precision.
        assert!(
            p.distance(q) < 1e-6 && (own - other).abs() < 1e-6 * other.abs().max(1.0),
            "{what}: {p} {own} {q} {other}"
        );
    }
    let volume = |grid: &Grid| {
        let of = |i: usize| voltet_core::grid::tetrahedron_volume(grid.corners(i));
        (0..grid.tetrahedra.len()).map(of).sum::<f64>()
    };
    assert!(
        (volume(found) - volume(expected)).abs() < 1e-5,
        "{what}: {} {}",
        volume(found),
        volume(expected)
    );
}

#[test]
fn binary_files_of_tecplots_own_library_have_every_kind_of_zone() {
    for (name, form) in [
        ("tecplot_double.plt", "Tecplot, binary, little-endian"),
        ("tecplot_single.plt", "Tecplot, binary, big-endian"),
    ] {
        for request in [whole(None, "s"), whole(Some(Association::Cell), "c")] {
            let [found, expected] = [name, "tecplot_zones.vtu"].map(|name| packed::grid(name, &request));
            same_values(&found, &expected, name);
        }
        packed::follow(&packed::grid(name, &whole(None, "s")), packed::field, name);
        let summary = inspect(&packed::path(name), &Request::default(), &NoProgress).unwrap();
        let blocks: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
        assert_eq!((&*summary.format, blocks), (form, vec!["tetrahedra", "bricks", "box", "polyhedra"]));
        let request = Request { blocks: vec!["box".to_owned()], ..whole(None, "s") };
        let part = packed::grid(name, &request);
        assert!(part.points.len() == 24 && part.points.iter().all(|point| point.x >= 10.0), "{name}");
    }
}

#[test]
fn binary_zones_share_points_and_cells_over_steps() {
    let path = packed::path("tecplot_steps.plt");
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    assert_eq!((summary.time_steps, summary.blocks.len()), (vec![0.5, 0.75, 2.0], 2));
    for step in 0..3 {
        let own = packed::grid_at("tecplot_steps.plt", "s", step);
        assert_eq!((own.points.len(), own.origin.time), (24, Some([0.5, 0.75, 2.0][step])));
        let at = |p: [f64; 3]| packed::field(p) + if p[0] < 4.0 { 100.0 * step as f64 } else { 0.0 };
        packed::follow(&own, at, "steps");
        // The part of all times has no values of c.
        let cells = packed::grid_at("tecplot_steps.plt", "c", step);
        let warnings = &cells.origin.warnings;
        assert!(
            cells.points.len() == 12 && warnings.iter().any(|own| own.contains("'fixed'")),
            "{warnings:?}"
        );
    }
}

#[test]
fn older_binary_versions_are_read() {
    for name in ["tecplot_107.plt", "tecplot_108.plt", "tecplot_111.plt"] {
        let request = whole(None, "s");
        let [found, expected] = [name, "tecplot_old.vtu"].map(|name| packed::grid(name, &request));
        packed::same(&found, &expected, name);
        if name != "tecplot_108.plt" {
            let request = whole(Some(Association::Cell), "c");
            let [found, expected] = [name, "tecplot_old.vtu"].map(|name| packed::grid(name, &request));
            packed::same(&found, &expected, name);
        }
    }
}

#[test]
fn mistakes_in_binary_files_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let sound = std::fs::read(packed::path("tecplot_111.plt")).unwrap();
    let word = |value: i32| value.to_le_bytes();
    let message = |from: &[u8], to: &[u8]| {
        let at = sound.windows(from.len()).position(|window| window == from).unwrap();
        let bytes = [&sound[..at], to, &sound[at + from.len()..]].concat();
        let path = file(&folder, "a.plt", &bytes);
        read(&path, &request("s"), &NoProgress).map(|_| from.to_vec()).unwrap_err().to_string()
    };
    let five = [word(-1), word(5), word(0)].concat();
    for (from, to, words) in [
        (&b"TDV111"[..], &b"TDV102"[..], ["not read", "found 102", "107 to 112"]),
        (&[1, 0, 0, 0, 0], &[9, 0, 0, 0, 0], ["byte order", "9, 0, 0, 0", "a.plt"]),
        (&five, &[word(-1), word(8), word(0)].concat(), ["zones of this type", "found 8", "byte "]),
        (&five, &[word(-1), word(5), word(1)].concat(), ["side by side", "one run", "byte "]),
        (&357_f32.to_le_bytes(), &358_f32.to_le_bytes(), ["not known", "358", "byte "]),
        (
            &[word(16), word(2)].concat(),
            &[word(1 << 30), word(2)].concat(),
            ["does not fit", "1073741824", "a.plt"],
        ),
        (
            &[word(2), word(1), word(2)].concat(),
            &[word(2), word(6), word(2)].concat(),
            ["this type", "found 6", "byte"],
        ),
        (
            &[word(14), word(15)].concat(),
            &[word(14), word(16)].concat(),
            ["names a point", "found 16", "below 16"],
        ),
    ] {
        let found = message(from, to);
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
    }
    let solution = [b"#!TDV111".to_vec(), word(1).to_vec(), word(2).to_vec(), vec![0; 40]].concat();
    let found = read(&file(&folder, "b.plt", &solution), &request("s"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("no coordinates") && found.contains("SOLUTION"), "{found}");
}

#[test]
fn passive_variables_of_text_have_no_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for list in ["PASSIVEVARLIST=([4])", "PASSIVEVARLIST=(4)"] {
        let text = format!(
            "variables = x, y, z, s, t\nzone t=one n=4, e=1, f=feblock, et=tetrahedron {list}\n\
             0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 4\n1 2 3 4\n"
        );
        let path = file(&folder, "a.dat", text.as_bytes());
        assert_eq!(**grid(&path, &request("t")).scalar.as_ref().unwrap(), [1.0, 2.0, 3.0, 4.0]);
        let found = read(&path, &request("s"), &NoProgress).unwrap_err().to_string();
        assert!(found.contains("no array 's'"), "{found}");
    }
}

#[test]
fn subzone_files_and_meshes_of_mfem_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, words) in [
        ("a.szplt", "#!SZPLT 105BF $Revision:", ["subzone file of Tecplot", "Write Data", "a .plt file"]),
        (
            "a.mesh",
            "MFEM mesh v1.0\n\ndimension\n3\n",
            ["mesh of MFEM", "ParaViewDataCollection", "a .vtu file"],
        ),
    ] {
        let found =
            read(&file(&folder, name, text.as_bytes()), &request("s"), &NoProgress).unwrap_err().to_string();
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
    }
}

#[test]
fn nodes_are_shared_by_zones_of_other_cells_and_tables_need_no_points() {
    let folder = tempfile::tempdir().unwrap();
    let head = "variables = x, y, z, s\nzone t=one n=5, e=2, f=feblock, et=tetrahedron\n\
        0 1 0 0 1\n0 0 1 0 1\n0 0 0 1 1\n1 2 3 4 5\n1 2 3 4\n2 3 4 5\n";
    let text = format!(
        "{head}zone t=two n=5, e=1, f=feblock, et=tetrahedron varsharelist=([1-3]=1)\n6 7 8 9 10\n2 3 4 5\n\
         zone t=history i=2 f=block passivevarlist=([1-3])\n1 2\n"
    );
    let path = file(&folder, "a.dat", text.as_bytes());
    let two = grid(&path, &Request { blocks: vec!["two".to_owned()], ..request("s") });
    assert_eq!(**two.scalar.as_ref().unwrap(), [7.0, 8.0, 9.0, 10.0]);
    let passive = text.replace("varsharelist=([1-3]=1)", "varsharelist=([1-2]=1) passivevarlist=([3])");
    let found = read(&file(&folder, "a.dat", passive.as_bytes()), &request("s"), &NoProgress)
        .unwrap_err()
        .to_string();
    assert!(found.contains("no coordinates") && found.contains("'two'"), "{found}");
    let cells = text
        .replace("e=2,", "e=2, varlocation=([4]=cellcentered)")
        .replace("1 2 3 4 5\n1 2 3 4", "1 2\n1 2 3 4");
    let cells = cells.replace(
        "varsharelist=([1-3]=1)\n6 7 8 9 10\n",
        "varlocation=([4]=cellcentered) varsharelist=([1-4]=1)\n",
    );
    let found =
        read(&file(&folder, "a.dat", cells.as_bytes()), &request("s"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("another size") && found.contains("1 cells"), "{found}");
}
