//! Tecplot data as text: by meshio, and in the forms of its guide.

use super::packed;
use super::refusals::{refused, says};
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
    assert_eq!(summary.warnings, ["Zones without cells of three dimensions are left out: 'wall'."]);
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
    // As VTK's reader has it.
    let path =
        file(&folder, "a.dat", TEXT.replacen("DATAPACKING=BLOCK", "DATAPACKING=FEBLOCK", 1).as_bytes());
    assert_eq!(grid(&path, &request("T")).scalar, all.scalar);
    let point = "variables = x, y, z, s zone t=one n=4, e=1, f=fepoint, et=tetrahedron\n\
        0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n1 2 3 4\n";
    let path = file(&folder, "b.dat", point.as_bytes());
    assert_eq!(**grid(&path, &request("s")).scalar.as_ref().unwrap(), [1.0, 2.0, 3.0, 4.0]);
    assert!(inspect(&path, &Request::default(), &NoProgress).unwrap().blocks.is_empty());
}

/// A variable that a reader passes over may end within the repeats that the next one begins with.
#[test]
fn a_repeated_number_may_be_of_two_variables() {
    let folder = tempfile::tempdir().unwrap();
    let text = "VARIABLES = x y z f g h\nZONE N=4 E=1 ET=TETRAHEDRON F=FEBLOCK\n0 1 0 0\n0 0 1 0\n3*0 1\n5 6*7 8\n4*9\n1 2 3 4\n";
    let path = file(&folder, "a.dat", text.as_bytes());
    for (name, values) in [("f", [5.0, 7.0, 7.0, 7.0]), ("g", [7.0, 7.0, 7.0, 8.0]), ("h", [9.0; 4])] {
        assert_eq!(**grid(&path, &request(name)).scalar.as_ref().unwrap(), values, "{name}");
    }
    let all = Request { point_arrays: vec!["f".into(), "h".into()], ..request("g") };
    let all = grid(&path, &all);
    assert_eq!(*all.point_arrays["f"].values, [5.0, 7.0, 7.0, 7.0]);
    assert_eq!(*all.point_arrays["h"].values, [9.0; 4]);
}

#[test]
fn mistakes_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, words) in [
        ("FETETRAHEDRON", "FEMIXED", ["not read", "FEMIXED", "FEPOLYHEDRON"]),
        ("N=5,", "N=five,", ["NODES of a zone", "'five'", "a.dat:"]),
        ("2 3 4 5", "2 3 4 6", ["does not exist", "found 6", "a.dat:15"]),
        ("0 0 1 0 1", "0 0 l 0 1", ["damaged", "'l'", "a.dat:10:1, 'Y [m]')"]),
        ("5*7.5", "5*7.S", ["damaged", "'7.S'", "a.dat:12:1, 'T')"]),
        ("-1 2.5", "-1 7*2.5", ["beyond its zone", "found 7", "a.dat:13"]),
        ("([1-3]=1)", "(1,2,3)", ["VARSHARELIST", "found '(1,2,3)'", "brackets"]),
        ("[1-3]=1", "[1-3]=9", ["shares", "'9'", "at most 3"]),
        ("N=5,", "N=5000000000,", ["does not fit the file", "5000000000", "a.dat:"]),
        ("ZONE T=\"box\"", "VARIABLES=a b c ZONE", ["change between zones", "found 3", "5 variables"]),
        ("2 3 4 5\n", "2 3 4 5\n7 7\n", ["no zone: found '7'", "geometries", "a.dat:16"]),
        ("ZONE T=\"box\"", "ZONE\nZONE", ["zone without numbers", "not read", "a.dat:"]),
        ("=CELLCENTERED", "=CELLCENTRED", ["VARLOCATION", "'CELLCENTRED'", "NODAL or CELLCENTERED"]),
        ("[5]=CELL", "[9]=CELL", ["VARLOCATION", "'9'", "in brackets"]),
        ("SOLUTIONTIME=1.5", "SOLUTIONTIME=l.5", ["SOLUTIONTIME", "'l.5'", "a number"]),
        ("TITLE", "FILETYPE=SOLUTION\nTITLE", ["no coordinates", "SOLUTION", "FULL"]),
        ("ET=TRIANGLE", "C=RED", ["finite elements", "ZONETYPE", "a.dat:"]),
        ("DATAPACKING=BLOCK", "DATAPACKING=POINT", ["at cells", "side by side", "BLOCK"]),
    ] {
        assert!(TEXT.contains(from));
        let path = file(&folder, "a.dat", TEXT.replacen(from, to, 1).as_bytes());
        refused(&path, &request("T"), &words);
    }
}

/// Two cubes side by side, by their eleven faces; then a polygon with a neighbour in another zone, and a tetrahedron.
const FACES: &str = "VARIABLES = x y z f c\nZONE T=\"cubes\" NODES=12 FACES=11 ELEMENTS=2 ZONETYPE=FEPolyhedron DATAPACKING=BLOCK\n\
    TOTALNUMFACENODES=44 NUMCONNECTEDBOUNDARYFACES=1 TOTALNUMBOUNDARYCONNECTIONS=1 VARLOCATION=([5]=CELLCENTERED)\n\
    0 1 2 0 1 2 0 1 2 0 1 2\n3*0 3*1 3*0 3*1\n6*0 6*1\n1 2 3 3 4 5 5 6 7 7 8 9\n-1 2.5\n# nodes of each face\n4 4 4 4 4 4 4 4 4 4 4\n\
    #their numbers\n1 2 5 4 2 3 6 5 7 8 11 10 8 9 12 11\n1 2 8 7 2 3 9 8 4 5 11 10 5 6 12 11\n1 4 10 7 2 5 11 8 3 6 12 9\n\
    # on the left\n1 2 1 2 1 2 1 2 1 1 2\n# on the right\n0 0 0 0 0 0 0 0 0 2 -1\n# others\n1\n1\n2\n\
    ZONE T=\"wall\" NODES=3 FACES=3 ELEMENTS=1 ZONETYPE=FEPOLYGON TOTALNUMFACENODES=6 VARLOCATION=([5]=CELLCENTERED)\n\
    0 1 0\n0 0 1\n3*0\n1 2 3\n4\n1 2 2 3 3 1\n1 1 1\n0 0 0\n\
    ZONE T=\"one\" NODES=4 ELEMENTS=1 ZONETYPE=FETETRAHEDRON DATAPACKING=POINT\n9 0 0 1 2\n8 0 0 1 2\n8 1 0 1 2\n8 0 1 1 2\n1 2 3 4\n";

#[test]
fn polyhedra_of_text_are_read_by_their_faces() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.dat", FACES.as_bytes());
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let blocks: Vec<(&str, u64)> =
        summary.blocks.iter().map(|block| (&*block.name, block.cell_count())).collect();
    assert_eq!(blocks, [("cubes", 2), ("one", 1)]);
    let cubes = |scalar: &str| grid(&path, &Request { blocks: vec!["cubes".into()], ..request(scalar) });
    let own = cubes("f");
    let volume = |i: usize| voltet_core::grid::tetrahedron_volume(own.corners(i));
    // Thirds and sixths.
    assert!(((0..own.tetrahedra.len()).map(volume).sum::<f64>() - 2.0).abs() < 1e-14);
    for (p, &f) in own.points.iter().zip(own.scalar.as_ref().unwrap().iter()) {
        assert!((f - (1.0 + p.x + 2.0 * p.y + 4.0 * p.z)).abs() < 1e-14, "{f} at {p}");
    }
    let of_cells = cubes("c");
    for (i, tetrahedron) in of_cells.tetrahedra.iter().enumerate() {
        let x: f64 = of_cells.corners(i).iter().map(|p| p.x / 4.0).sum();
        let expected = if x < 1.0 { -1.0 } else { 2.5 };
        assert!(tetrahedron.iter().all(|&p| of_cells.scalar.as_ref().unwrap()[p as usize] == expected));
    }
    for (from, to, words) in [
        ("TOTALNUMFACENODES=44", "TOTALNUMFACENODES=43", ["no zone", "b.dat:18"]),
        ("face\n4 4 4", "face\n5 4 4", ["TOTALNUMFACENODES", "45, as its faces say"]),
        ("1 2 5 4 2", "1 2 5 13 2", ["does not exist", "1 to 12"]),
        ("0 2 -1\n", "0 3 -1\n", ["cell that is not there", "below 2"]),
        ("0 2 -1\n", "0 x -1\n", ["'x'", "b.dat:18"]),
        ("FACES=11", "FACES=99999999999", ["ends early", "b.dat"]),
    ] {
        assert!(FACES.contains(from));
        let path = file(&folder, "b.dat", FACES.replacen(from, to, 1).as_bytes());
        refused(&path, &request("f"), &words);
    }
    // Each face has two sides.
    let many = FACES.replacen("ELEMENTS=2 ", "ELEMENTS=23 ", 1).replacen("-1 2.5", "-1 22*2.5", 1);
    let found = read(&file(&folder, "c.dat", many.as_bytes()), &request("f"), &NoProgress);
    let found = found.map(|_| ()).unwrap_err().to_string();
    assert!(["found 23", "at most 22", "cubes"].iter().all(|word| found.contains(word)), "{found}");
}

#[test]
fn faces_of_polygons_have_two_nodes_whether_their_zone_counts_them_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let without = FACES.replacen(" TOTALNUMFACENODES=6", "", 1);
    assert_ne!(without, FACES);
    let [own, other] = [("a.dat", FACES), ("b.dat", &without)].map(|(name, text)| {
        let path = file(&folder, name, text.as_bytes());
        grid(&path, &request("f"))
    });
    assert!(own.points == other.points && own.scalar == other.scalar);
}

/// A binary file of ordered points, 2 by 2 by 3, with bits at the points and in the cells.
fn bits_of(version: &str, is_big: bool) -> Vec<u8> {
    let word = |value: i32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
    let single = |value: f32| word(value.to_bits() as i32);
    let text =
        |text: &str| text.bytes().chain([0]).flat_map(|letter| word(letter.into())).collect::<Vec<_>>();
    let words = |values: &[i32]| values.iter().flat_map(|&value| word(value)).collect::<Vec<_>>();
    let mut bytes = [format!("#!TDV{version}").into_bytes(), words(&[1, 0])].concat();
    bytes.extend([text("bits"), words(&[5])].concat());
    bytes.extend(["x", "y", "z", "b", "c"].iter().flat_map(|name| text(name)));
    bytes.extend(
        [single(299.0).to_vec(), text("zone"), words(&[-1, -1]), vec![0; 8], words(&[-1, 0])].concat(),
    );
    bytes.extend(words(&[1, 0, 0, 0, 0, 1, 0, 0, 2, 2, 3, 0]));
    bytes.extend([single(357.0), single(299.0)].concat());
    bytes.extend(words(&[1, 1, 1, 6, 6, 0, 0, -1]));
    bytes.extend([0; 5 * 16]);
    for axis in [|n| n % 2, |n| n / 2 % 2, |n| n / 4] as [fn(u16) -> u16; 3] {
        bytes.extend((0..12).flat_map(|n| single(axis(n).into())));
    }
    // The first is in the lowest place: points 0, 3, 6 and 9; cells 4 and, beyond the rows, 1.
    bytes.extend([0b0100_1001, 0b0000_0010, 0b0001_0010]);
    bytes
}

#[test]
fn bits_are_read_from_the_lowest_place_on() {
    let folder = tempfile::tempdir().unwrap();
    for is_big in [false, true] {
        let path = file(&folder, "a.plt", &bits_of("112", is_big));
        let own = grid(&path, &request("b"));
        for (p, &b) in own.points.iter().zip(own.scalar.as_ref().unwrap().iter()) {
            let number = p.x + 2.0 * p.y + 4.0 * p.z;
            assert_eq!(b, f64::from(number % 3.0 == 0.0), "{p}");
        }
        let own = grid(&path, &request("c"));
        for (i, tetrahedron) in own.tetrahedra.iter().enumerate() {
            let z: f64 = own.corners(i).iter().map(|p| p.z / 4.0).sum();
            let expected = f64::from(z > 1.0);
            assert!(tetrahedron.iter().all(|&p| own.scalar.as_ref().unwrap()[p as usize] == expected));
        }
    }
    let short = &bits_of("112", false);
    let path = file(&folder, "b.plt", &short[..short.len() - 1]);
    let found = read(&path, &request("b"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("ends early"), "{found}");
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
            &[word(2), word(7), word(2)].concat(),
            ["this type", "found 7", "byte"],
        ),
        (
            &[word(14), word(15)].concat(),
            &[word(14), word(16)].concat(),
            ["names a point", "found 16", "below 16"],
        ),
    ] {
        let found = message(from, to);
        says(&found, &words);
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
fn subzone_files_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "a.szplt", b"#!SZPLT 105BF $Revision:");
    let found = read(&path, &request("s"), &NoProgress).unwrap_err().to_string();
    for word in ["subzone file of Tecplot", "Write Data", "a .plt file"] {
        assert!(found.contains(word), "{found}");
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
