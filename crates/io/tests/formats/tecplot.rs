//! Tecplot data as text: by meshio, and in the forms of its guide.

use std::path::Path;
use voltet_core::grid::{CellValues, Grid, Options};
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
