//! Results of MFEM as it writes them (`tests/files/make_mfem.py`): fields are formulas, which come back at every point.

use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, Options, code};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{
    Association, Request, TimeStep, files_beside, files_read_beside, inspect, outline, read, steps,
};

fn folder_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/mfem").join(name)
}

fn root(name: &str) -> PathBuf {
    folder_of(name).join(format!("{name}_000003.mfem_root"))
}

fn request(scalar: &str) -> Request {
    Request { scalar: Some(scalar.to_owned()), ..Request::default() }
}

fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

fn message(path: &Path, request: &Request) -> String {
    read(path, request, &NoProgress).unwrap_err().to_string()
}

fn linear(p: DVec3) -> f64 {
    1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z
}

fn quadratic(p: DVec3) -> f64 {
    linear(p) + p.x * p.x - p.y * p.z + p.z * p.z / 2.0
}

fn bent(p: DVec3) -> DVec3 {
    p + DVec3::new(p.y * p.y, p.z * p.z, p.x * p.y) / 8.0
}

/// Compares the scalar at points with a formula.
#[track_caller]
fn same(grid: &Grid, what: &str, formula: impl Fn(DVec3) -> f64, counts: impl Fn(DVec3) -> bool) {
    let mut count = 0;
    for (&p, &value) in
        grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()).filter(|own| counts(*own.0))
    {
        // Text has 15 digits.
        assert!((value - formula(p)).abs() < 1e-12, "{what} at {p}: {value}, not {}", formula(p));
        count += 1;
    }
    assert!(count > 20, "{what}");
}

/// Positions in units of 1e-12, in which those of the samples are whole numbers.
fn places(grid: &Grid, bend: fn(DVec3) -> DVec3) -> Vec<[i64; 3]> {
    let place = |&p: &DVec3| bend(p).to_array().map(|x| (x * 1e12).round() as i64);
    let mut places: Vec<_> = grid.points.iter().map(place).collect();
    places.sort_unstable();
    places
}

type Formula = (&'static str, fn(DVec3) -> f64);

const FIELDS: [Formula; 8] = [
    ("linear", linear),
    ("quadratic", quadratic),
    ("by_nodes:0", |p| p.x * p.y),
    ("by_nodes:1", linear),
    ("by_nodes:2", quadratic),
    ("by_vdim:0", |p| p.x * p.y),
    ("by_vdim:1", linear),
    ("by_vdim:2", quadratic),
];

#[test]
fn formulas_come_back_at_nodes_of_every_kind() {
    for (name, formula) in FIELDS {
        same(&grid(&root("straight"), &request(name)), name, formula, |_| true);
    }
    // Cells are bent as their nodes are.
    let straight = grid(&root("straight"), &request("quadratic"));
    assert_eq!(places(&grid(&root("curved"), &request("quadratic")), |p| p), places(&straight, bent));
    for (name, formula) in &FIELDS[1..] {
        // The middle of a pyramid's base is no node of VTK's; what is there is a mean, exact for linear fields.
        let bases = [DVec3::new(2.0, 0.5, 0.5), DVec3::new(0.5, 0.5, 1.0)].map(bent);
        let counts = |p: DVec3| name.ends_with(":1") || bases.iter().all(|&base| (p - base).length() > 1e-6);
        same(&grid(&root("curved"), &request(name)), name, formula, counts);
    }
}

#[test]
fn higher_orders_are_read_at_nodes_of_the_second() {
    let warned = |grid: &Grid, what: &str| {
        let warnings = &grid.origin.warnings;
        assert!(warnings.iter().any(|own| own.contains(what) && own.contains("is 3")), "{warnings:?}");
    };
    let straight = grid(&root("third"), &request("third"));
    same(&straight, "third", quadratic, |_| true);
    warned(&straight, "'third'");
    let curved = grid(&root("bent"), &request("third"));
    same(&curved, "bent", linear, |_| true);
    warned(&curved, "the nodes");
    assert_eq!(places(&curved, |p| p), places(&straight, bent));
}

#[test]
fn a_mesh_of_the_first_order_has_linear_cells() {
    let folder = tempfile::tempdir().unwrap();
    let own = |name: &str| folder_of("straight/straight_000003").join(name);
    let mesh = folder.path().join("beam.mesh");
    std::fs::copy(own("mesh.000000"), &mesh).unwrap();
    std::fs::copy(own("linear.000000"), folder.path().join("beam.gf")).unwrap();
    let solution = folder.path().join("other.gf");
    std::fs::copy(own("quadratic.000000"), &solution).unwrap();
    // The grid function of the mesh's name is read with it.
    let summary = inspect(&mesh, &Request::default(), &NoProgress).unwrap();
    assert_eq!(summary.format, "MFEM mesh");
    assert_eq!(
        summary.cells_by_type,
        BTreeMap::from([(code::TETRA, 2), (code::HEXAHEDRON, 1), (code::WEDGE, 2), (code::PYRAMID, 2)])
    );
    assert_eq!(summary.point_count, 14);
    let linear_grid = grid(&mesh, &Request::default());
    assert!(
        linear_grid
            .points
            .iter()
            .zip(linear_grid.scalar.as_ref().unwrap().iter())
            .all(|(&p, &v)| v == linear(p))
    );
    assert_eq!(files_beside(&mesh), [folder.path().join("beam.gf")]);
    let other = Request { solution: Some(solution.clone()), ..request("other") };
    same(&grid(&mesh, &other), "other", quadratic, |_| true);
    assert!(files_read_beside(&mesh, &other).is_empty());
    let quadratic_cells = inspect(&mesh, &other, &NoProgress).unwrap().cells_by_type;
    assert!(quadratic_cells.contains_key(&code::TRIQUADRATIC_HEXAHEDRON));
    let alone = message(&solution, &Request::default());
    assert!(alone.contains("a grid function of MFEM") && alone.contains("as its solution"), "{alone}");
}

#[test]
fn attributes_are_blocks_and_an_array() {
    let constant = |scalar: &str, blocks: &[&str]| {
        let options = Options { cell_values: CellValues::Constant, ..Options::default() };
        let blocks = blocks.iter().map(|block| block.to_string()).collect();
        grid(&root("curved"), &Request { options, blocks, ..request(scalar) })
    };
    let summary = inspect(&root("curved"), &Request::default(), &NoProgress).unwrap();
    let blocks: Vec<(&str, u64)> =
        summary.blocks.iter().map(|block| (&*block.name, block.cell_count())).collect();
    assert_eq!(blocks, [("1", 2), ("2", 3), ("3", 2)]);
    assert_eq!((summary.time, &*summary.format), (Some(0.25), "MFEM mesh, curved"));
    let kinds: Vec<(&str, Association)> =
        summary.quantities().map(|own| (&*own.head.name, own.head.association)).collect();
    assert!(
        kinds.contains(&("constant", Association::Cell)) && kinds.contains(&("attribute", Association::Cell))
    );
    let (attribute, block) = (constant("attribute", &[]), constant("block", &[]));
    assert_eq!(attribute.points, block.points);
    let pairs = attribute.scalar.as_ref().unwrap().iter().zip(block.scalar.as_ref().unwrap().iter());
    assert!(pairs.clone().all(|(attribute, block)| *attribute == block + 1.0));
    assert!([1.0, 2.0, 3.0].iter().all(|own| pairs.clone().any(|pair| pair.0 == own)));
    // Parts have the values of the whole.
    for (scalar, blocks) in [("constant", ["1"]), ("attribute", ["3"]), ("constant", ["3"])] {
        let values = |grid: &Grid| {
            let corner = |p: &u32| {
                (
                    grid.points[*p as usize].to_array().map(f64::to_bits),
                    grid.scalar.as_ref().unwrap()[*p as usize].to_bits(),
                )
            };
            let mut all: Vec<_> = grid
                .tetrahedra
                .iter()
                .map(|own| {
                    let mut own = own.each_ref().map(corner);
                    own.sort_unstable();
                    own
                })
                .collect();
            all.sort_unstable();
            all
        };
        let (whole, part) = (values(&constant(scalar, &[])), values(&constant(scalar, &blocks)));
        assert!(!part.is_empty() && part.len() < whole.len(), "{scalar}");
        assert!(part.iter().all(|own| whole.binary_search(own).is_ok()), "{scalar}");
    }
    // The value of a prism is that at its middle.
    let straight = Request {
        options: Options { cell_values: CellValues::Constant, ..Options::default() },
        ..request("constant")
    };
    let straight = grid(&root("straight"), &straight);
    for (i, tetrahedron) in straight.tetrahedra.iter().enumerate() {
        let middle: DVec3 = straight.corners(i).iter().map(|p| *p / 4.0).sum();
        let expected = match (middle.x, middle.x + middle.y) {
            _ if middle.z > 1.0 || middle.x > 2.0 => continue,
            (..1.0, _) => DVec3::splat(0.5),
            (_, ..2.0) => DVec3::new(4.0 / 3.0, 1.0 / 3.0, 0.5),
            _ => DVec3::new(5.0 / 3.0, 2.0 / 3.0, 0.5),
        };
        assert!(
            tetrahedron
                .iter()
                .all(|&p| (straight.scalar.as_ref().unwrap()[p as usize] - linear(expected)).abs() < 1e-12)
        );
    }
}

const TWO: &str = "MFEM mesh v1.3\n# two\n\ndimension\n3\n\nelements\n2\n5 4 1 2 3 4\n7 4 2 3 4 5\n\nattribute_sets\n2\n\
    \"a \\\"b\\\"\"\n1\n7\nboth\n2\n5 7\n\nboundary\n1\n1 2 1 2 3\n\nbdr_attribute_sets\n0\n\nvertices\n6\n3\n9 9 9\n0 0 0\n1 0 0\n\
    0 1 0\n0 0 1\n1 1 1\n\nmfem_mesh_end\n";

fn field(space: &str, components: usize, values: &str) -> String {
    format!(
        "FiniteElementSpace\nFiniteElementCollection: {space}\nVDim: {components}\nOrdering: 0\n\n{values}\n"
    )
}

#[test]
fn names_of_attributes_are_names_of_blocks_and_vertices_without_elements_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.mesh"), folder.path().join("a.gf"));
    std::fs::write(&mesh, TWO).unwrap();
    std::fs::write(&solution, field("H1_3D_P1", 1, "1 3 -2 5 4")).unwrap();
    let summary = inspect(&mesh, &Request::default(), &NoProgress).unwrap();
    let names: Vec<&str> = summary.blocks.iter().map(|block| &*block.name).collect();
    assert_eq!((names, summary.point_count), (vec!["both/5", "a \"b\""], 5));
    let own = grid(&mesh, &request("a"));
    assert!(
        own.points.iter().zip(own.scalar.as_ref().unwrap().iter()).all(|(&p, &value)| value == linear(p))
    );
    // The second order by its newer head, with comments; other spaces whose functions are the same.
    for (space, values) in
        [("H1@G_3D_P1", "1 3 -2 5 4"), ("H1Pos_3D_P1", "1 3 -2 5 4"), ("Linear", "1 3 -2 5 4")]
    {
        let text = field(space, 1, values).replace("\n\n", "\nEnd: MFEM FiniteElementSpace v1.0\n# a\n");
        std::fs::write(&solution, format!("MFEM {}", text.replacen("Space\n", "Space v1.0\n", 1))).unwrap();
        assert_eq!(grid(&mesh, &request("a")).scalar, own.scalar, "{space}");
    }
}

#[test]
fn collections_of_several_cycles_are_a_series_by_a_file_that_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let series = folder.path().join("a.series");
    let entry = |name: &str, time: f64| format!("{{\"name\": {:?}, \"time\": {time}}}", root(name));
    let text = |entries: &[String]| {
        format!("{{\"file-series-version\": \"1.0\", \"files\": [{}]}}", entries.join(", "))
    };
    std::fs::write(&series, text(&[entry("third", 1.0), entry("bent", 2.0)])).unwrap();
    assert_eq!(steps(&series, &Request::default()).unwrap().0, [1.0, 2.0]);
    let at = |time| Request { time_step: Some(TimeStep::Time(time)), ..request("third") };
    assert_eq!(places(&grid(&series, &at(2.0)), |p| p), places(&grid(&series, &at(1.0)), bent));
}

#[test]
fn nodes_end_before_what_parallel_files_add() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mesh");
    let own = |name: &str| folder_of("curved/curved_000003").join(name);
    let text = std::fs::read_to_string(own("mesh.000000")).unwrap();
    let parallel = text.replacen("mesh v1.0", "mesh v1.2", 1)
        + "\nmfem_serial_mesh_end\n\ncommunication_groups\nnumber_of_groups 2\n\n# a\n1 0\n\nmfem_mesh_end\n";
    let request = Request { solution: Some(own("quadratic.000000")), ..request("quadratic") };
    let whole = grid(&own("mesh.000000"), &request);
    for text in [parallel.clone(), parallel.replace('\n', "\r\n")] {
        std::fs::write(&path, text).unwrap();
        let found = grid(&path, &request);
        assert!(found.points == whole.points && found.scalar == whole.scalar);
    }
    std::fs::write(&path, parallel.replacen("mfem_serial_mesh_end", "", 1).replacen("mfem_mesh_end", "", 1))
        .unwrap();
    let found = message(&path, &request);
    assert!(found.contains("'communication_groups'") && found.contains("a.mesh:"), "{found}");
}

#[test]
fn processes_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let part = |number: usize, text: &str, values: &str| {
        std::fs::write(folder.path().join(format!("mesh.00000{number}")), text).unwrap();
        std::fs::write(folder.path().join(format!("sol.00000{number}")), field("H1_3D_P1", 1, values))
            .unwrap();
    };
    let one = "MFEM mesh v1.2\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n\nboundary\n0\n\nvertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\n\
        mfem_serial_mesh_end\n\ncommunication_groups\n";
    part(0, one, "1 3 -2 5");
    part(1, &one.replace("0 0 0", "1 1 1").replace("1 4 0", "2 4 0"), "4 3 -2 5");
    let mesh = folder.path().join("mesh.000001");
    let request = Request { solution: Some(folder.path().join("sol.000000")), ..request("sol") };
    let own = grid(&mesh, &request);
    assert_eq!((own.points.len(), own.tetrahedra.len()), (5, 2));
    assert!(
        own.points.iter().zip(own.scalar.as_ref().unwrap().iter()).all(|(&p, &value)| value == linear(p))
    );
    assert_eq!(files_read_beside(&mesh, &request).len(), 2);
    // The same by a root file; packed, and with a field that is not read.
    let root = folder.path().join("a_000000.mfem_root");
    let text = |domains: &str| {
        format!(
            "{{\"dsets\": {{\"main\": {{\"cycle\": 0, \"domains\": {domains}, \"fields\": {{\"f\": {{\"path\": \"sol.%06d\"}}, \"E\": \
             {{\"path\": \"E.%06d\"}}}}, \"mesh\": {{\"path\": \"mesh.%06d\"}}, \"time\": 2.5}}}}}}"
        )
    };
    std::fs::write(&root, text("2")).unwrap();
    for number in 0..2 {
        std::fs::write(folder.path().join(format!("E.00000{number}")), field("ND_3D_P1", 1, "1 2 3 4 5 6"))
            .unwrap();
    }
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, one.as_bytes()).unwrap();
    std::fs::write(folder.path().join("mesh.000000"), packed.finish().unwrap()).unwrap();
    let of_root = grid(&root, &Request { scalar: Some("f".to_owned()), ..Request::default() });
    assert_eq!((of_root.points.len(), of_root.scalar), (5, own.scalar));
    let is_named = |own: &String| own.contains("'E'") && own.contains("ND_3D_P1");
    assert!(of_root.origin.warnings.iter().any(is_named), "{:?}", of_root.origin.warnings);
    assert_eq!(files_beside(&root).len(), 6);
    let blocks = outline(&root, &Request::default()).unwrap().blocks;
    assert_eq!(blocks, ["1", "2"]);
    assert_eq!(steps(&root, &Request::default()).unwrap().0, [0.0; 0]);
    for (domains, words) in [
        ("3", ["mesh.000002", "3 files"]),
        ("1e99", ["domains", "damaged"]),
        ("0", ["domains", "at least 1"]),
    ] {
        std::fs::write(&root, text(domains)).unwrap();
        let found = message(&root, &Request::default());
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
    }
}

#[test]
fn a_field_of_another_space_beside_the_mesh_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.mesh"), folder.path().join("a.gf"));
    std::fs::write(&mesh, TWO).unwrap();
    std::fs::write(&solution, field("RT_3D_P1", 1, "1 2 3")).unwrap();
    let summary = inspect(&mesh, &Request::default(), &NoProgress).unwrap();
    assert!(summary.warnings.iter().any(|own| own.contains("RT_3D_P1")), "{:?}", summary.warnings);
    assert_eq!(summary.quantities().map(|own| &*own.head.name).collect::<Vec<_>>(), ["attribute"]);
}

#[test]
fn mistakes_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.mesh"), folder.path().join("a.gf"));
    let sound = field("H1_3D_P1", 1, "1 3 -2 5 4");
    let found = |text: &str, field: &str| {
        std::fs::write(&mesh, text).unwrap();
        std::fs::write(&solution, field).unwrap();
        message(&mesh, &Request { solution: Some(solution.clone()), ..request("a") })
    };
    for (from, to, words) in [
        ("5 4 1 2 3 4", "5 9 1 2 3 4", ["type of an element", "a.mesh:9"]),
        ("5 4 1 2 3 4", "5 2 1 2 3", ["another dimension", "a.mesh:9"]),
        ("5 4 1 2 3 4", "5 4 1 2 3 -4", ["number of a vertex", "a.mesh:9"]),
        ("5 4 1 2 3 4", "5 4 1 2 3 6", ["does not exist", "below 6"]),
        ("5 4 1 2 3 4", "5 4 1 2 x 4", ["'x'", "a.mesh:9"]),
        ("elements\n2", "elements\n3", ["attribute_sets", "a.mesh:12"]),
        ("elements\n2", "elements\n99999999999", ["attribute_sets", "a.mesh:12"]),
        ("elements\n2", "elements\n1", ["'7'", "'attribute_sets'"]),
        ("vertices\n6", "vertices\n99999999", ["ends early", "99999999 vertices"]),
        ("vertices\n6\n3", "vertices\n6\n4", ["coordinates", "1 to 3"]),
        ("dimension", "dimensions", ["'dimensions'", "a.mesh:4"]),
        ("1 1 1\n\nmfem_mesh_end", "1 1", ["ends early", "a.mesh"]),
        ("MFEM mesh v1.3", "MFEM NC mesh v1.0", ["non-conforming", "ParaViewDataCollection"]),
        ("MFEM mesh v1.3", "MFEM NURBS mesh v1.0", ["NURBS", "ParaViewDataCollection"]),
    ] {
        assert!(TWO.contains(from));
        let found = found(&TWO.replacen(from, to, 1), &sound);
        assert!(words.iter().all(|word| found.contains(word)), "{to}: {found}");
    }
    for (from, to, words) in [
        ("H1_3D_P1", "RT_3D_P1", ["space of 'a'", "RT_3D_P1"]),
        ("H1_3D_P1", "H1Pos_3D_P2", ["H1Pos_3D_P2", "H1; L2 of the order 0"]),
        ("H1_3D_P1", "L2_3D_P2", ["L2_3D_P2", "in tetrahedra and prisms these of the order 1"]),
        ("H1_3D_P1", "L2_3D_P1", ["do not fit", "found 5; expected 8"]),
        ("H1_3D_P1", "H1_3D_P2", ["a.gf", "expected 14"]),
        ("H1_3D_P1", "L2_3D_P0", ["do not fit", "found 5; expected 2"]),
        ("VDim: 1", "VDim: 5", ["not a scalar", "5 components"]),
        ("VDim: 1", "VDim: 0", ["'0'", "VDim"]),
        ("Ordering: 0", "Ordering: 2", ["'2'", "0 or 1"]),
        ("Ordering", "Order", ["'Order: 0'", "a.gf:4"]),
        ("-2", "x", ["'x'", "a.gf:6"]),
        ("5 4", "5", ["do not fit", "found 4; expected 5"]),
    ] {
        let found = found(TWO, &sound.replacen(from, to, 1));
        assert!(words.iter().all(|word| found.contains(word)), "{to}: {found}");
    }
}

/// A mesh of one tetrahedron without fields, of one process of several.
const ONE: &str = "MFEM mesh v1.2\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n\nboundary\n0\n\nvertices\n4\n3\n0 0 0\n\
    1 0 0\n0 1 0\n0 0 1\n\nmfem_serial_mesh_end\n\ncommunication_groups\n";

/// A root file of so many domains.
fn root_text(domains: &str, mesh: &str, field: &str) -> String {
    format!(
        "{{\"dsets\": {{\"main\": {{\"domains\": {domains}, \"fields\": {{\"f\": {{\"path\": \"{field}\"}}}}, \"mesh\": \
         {{\"path\": \"{mesh}\"}}}}}}}}"
    )
}

#[test]
fn long_names_of_sets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("a.mesh");
    let with = |name: &str| {
        std::fs::write(&mesh, TWO.replacen("\nboth\n", &format!("\n{name}\n"), 1)).unwrap();
        inspect(&mesh, &Request::default(), &NoProgress).map(|own| own.blocks[0].name.clone())
    };
    let longest = "n".repeat(1024);
    for name in [longest.clone(), format!("\"{longest}\""), format!("\"{}\"", "\\n".repeat(1024))] {
        assert_eq!(with(&name).unwrap(), longest.clone() + "/5");
        let found = with(&name.replacen('n', "nn\\n", 1)).unwrap_err().to_string();
        assert!(found.contains("name of a set") && found.contains("a.mesh:17"), "{found}");
    }
}

#[test]
fn blocks_have_names_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("a.mesh");
    let names = |from: &str, to: &str| {
        assert!(TWO.contains(from));
        std::fs::write(&mesh, TWO.replacen(from, to, 1)).unwrap();
        let blocks = inspect(&mesh, &Request::default(), &NoProgress).unwrap().blocks;
        blocks.into_iter().map(|block| block.name).collect::<Vec<_>>()
    };
    let sets = "2\n\"a \\\"b\\\"\"\n1\n7\nboth\n2\n5 7\n";
    assert_eq!(names(sets, "2\na\n1\n5\na\n1\n7\n"), ["a", "a/7"]);
    assert_eq!(names(sets, "1\n5\n1\n7\n"), ["5", "5/7"]);
    assert_eq!(names(sets, "2\na\n2\n5 6\na/5\n1\n7\n"), ["a/5", "a/5/7"]);
    // The first set of an attribute names it.
    assert_eq!(names(sets, "2\nboth\n2\n5 7\nb\n1\n7\n"), ["both/5", "both/7"]);
}

#[test]
fn domains_are_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("a.mfem_root");
    for name in ["mesh", "mesh.000000", "mesh.000001"] {
        std::fs::write(folder.path().join(name), ONE).unwrap();
    }
    for name in ["f", "f.000000", "g.000000", "g.000001"] {
        std::fs::write(folder.path().join(name), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    }
    for (domains, mesh, field, words) in [
        ("2", "mesh", "g.%06d", ["the mesh has one path", "found mesh;", "%06d"]),
        ("4000000000", "mesh", "g.%06d", ["the mesh has one path", "found mesh;", "%06d"]),
        ("4000000000", "mesh.%06d", "g.%06d", ["the mesh", "mesh.000002", "4000000000 files"]),
        ("2", "mesh.%06d", "f", ["field 'f' has one path", "found f;", "%06d"]),
        ("2", "mesh.%06d", "f.%06d", ["field 'f'", "f.000001", "2 files"]),
        ("1", "mesh.%06d", "h", ["field 'f'", "h", "1 file"]),
    ] {
        std::fs::write(&root, root_text(domains, mesh, field)).unwrap();
        let found = message(&root, &request("f"));
        assert!(words.iter().all(|word| found.contains(word)), "{found}");
        assert!(files_beside(&root).is_empty());
    }
    std::fs::write(&root, root_text("1", "mesh", "f")).unwrap();
    assert_eq!(grid(&root, &request("f")).points.len(), 4);
    std::fs::write(&root, root_text("2", "mesh.%06d", "g.%06d")).unwrap();
    assert_eq!(files_beside(&root).len(), 4);
}

#[test]
fn a_field_that_one_process_leaves_out_is_left_out_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.mfem_root"), root_text("2", "mesh.%06d", "f.%06d")).unwrap();
    let cube = ONE.replace("1 4 0 1 2 3", "1 5 0 1 2 3 4 5 6 7").replace(
        "4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1",
        "8\n3\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n0 0 3\n1 0 3\n1 1 3\n0 1 3",
    );
    for (number, mesh, count) in [(0, cube.as_str(), 27), (1, ONE, 10)] {
        std::fs::write(path(&format!("mesh.00000{number}")), mesh).unwrap();
        let values = field("L2_T1_3D_P2", 1, &"1\n".repeat(count));
        std::fs::write(path(&format!("f.00000{number}")), values).unwrap();
    }
    let summary = inspect(&path("a.mfem_root"), &Request::default(), &NoProgress).unwrap();
    assert_eq!(summary.quantities().map(|own| &*own.head.name).collect::<Vec<_>>(), ["attribute"]);
    let warnings = &summary.warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("'f' is left out"), "{warnings:?}");
}

#[test]
fn damaged_coordinates_name_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let root = path("a.mfem_root");
    std::fs::write(&root, root_text("2", "mesh.%06d", "f.%06d")).unwrap();
    for name in ["mesh.000000", "mesh.000001"] {
        std::fs::write(path(name), ONE).unwrap();
    }
    for name in ["f.000000", "f.000001"] {
        std::fs::write(path(name), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    }
    for name in ["mesh.000001", "mesh.000000"] {
        std::fs::write(path(name), ONE.replacen("0 1 0\n", "0 x 0\n", 1)).unwrap();
        for (opened, scalar) in [(&root, "f"), (&path("mesh.000000"), "attribute")] {
            let found = message(opened, &request(scalar));
            assert!(found.contains("'x'") && found.contains(&format!("{name}:18")), "{found}");
        }
        std::fs::write(path(name), ONE).unwrap();
    }
    let alone = path("a.mesh");
    std::fs::write(&alone, ONE.replacen("0 1 0\n", "0 x 0\n", 1)).unwrap();
    let found = message(&alone, &request("attribute"));
    assert!(found.contains("'x'") && found.contains("a.mesh:18"), "{found}");
}

#[test]
fn a_file_of_the_name_of_the_mesh_that_nobody_named_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["mesh.000000", "mesh.000001"] {
        std::fs::write(path(name), ONE).unwrap();
    }
    // It is of the whole mesh, not of processes.
    std::fs::write(path("mesh.gf"), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    assert_eq!(grid(&path("mesh.000000"), &request("attribute")).tetrahedra.len(), 2);
    let summary = inspect(&path("mesh.000000"), &Request::default(), &NoProgress).unwrap();
    assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    assert_eq!(files_beside(&path("mesh.000000")), [path("mesh.000001")]);
    let (mesh, other) = (path("beam.mesh"), path("beam.gf"));
    std::fs::write(&mesh, ONE).unwrap();
    let misfit = field("H1_3D_P2", 1, "1 3 -2 5");
    for text in [
        "a file of glyphs",
        "",
        "FiniteElementSpace\nx\n",
        &misfit,
        &misfit.replace("P2", "P1").replace("5", "5 6"),
    ] {
        std::fs::write(&other, text).unwrap();
        let summary = inspect(&mesh, &Request::default(), &NoProgress).unwrap();
        let is_named = |own: &String| own.contains("beam.gf") && own.contains("left out");
        assert!(summary.warnings.iter().any(is_named), "{:?}", summary.warnings);
        let own = grid(&mesh, &Request::default());
        assert_eq!((own.points.len(), &*own.scalar_name), (4, "attribute"));
        // The file that was named is an error.
        let found = message(&mesh, &Request { solution: Some(other.clone()), ..request("beam") });
        assert!(found.contains("beam.gf"), "{found}");
    }
}

/// A cube and a prism beside it, in which x runs from 0 to 2.
const BOXES: &str = "MFEM mesh v1.0\n\ndimension\n3\n\nelements\n2\n1 5 0 1 2 3 4 5 6 7\n1 6 1 8 2 5 9 6\n\nboundary\n0\n\nvertices\n10\n3\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n2 0 0\n2 0 1\n";

#[test]
fn discontinuous_fields_are_means_in_cells() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.mesh"), folder.path().join("a.gf"));
    std::fs::write(&mesh, BOXES).unwrap();
    let numbers = |values: Vec<f64>| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    // x² + y + 2z² in the cube at points of Gauss and Legendre, and at those of Gauss and Lobatto.
    let legendre = [0.5 - 0.15_f64.sqrt(), 0.5, 0.5 + 0.15_f64.sqrt()];
    let mut request = request("a");
    request.options.cell_values = CellValues::Constant;
    let formula = |x: f64, y: f64, z: f64| x * x + y + 2.0 * z * z;
    let only_cube = BOXES.replacen("2\n1 5", "1\n1 5", 1).replacen("1 6 1 8 2 5 9 6\n", "", 1);
    for (space, line) in [("L2_3D_P2", legendre), ("L2_T1_3D_P2", [0.0, 0.5, 1.0])] {
        std::fs::write(&mesh, &only_cube).unwrap();
        let mut values = Vec::new();
        for &z in &line {
            for &y in &line {
                values.extend(line.iter().map(|&x| formula(x, y, z)));
            }
        }
        std::fs::write(&solution, field(space, 1, &numbers(values))).unwrap();
        let own = grid(&mesh, &request);
        let expected = 1.0 / 3.0 + 0.5 + 2.0 / 3.0;
        assert!(own.scalar.unwrap().iter().all(|value| (value - expected).abs() < 1e-14), "{space}");
        assert!(own.origin.warnings.iter().any(|own| own.contains("'a'") && own.contains("the mean")));
        // A prism's values of the second order have no weights here.
        std::fs::write(&mesh, BOXES).unwrap();
        let warnings = grid(&mesh, &Request::default()).origin.warnings.clone();
        assert!(warnings.iter().any(|own| own.contains(space) && own.contains("left out")), "{warnings:?}");
    }
    // Components one after the other, 8 values in the cube and 6 in the prism.
    let values = |from: f64| (0..14).map(|i| from + f64::from(i)).collect::<Vec<_>>();
    std::fs::write(&solution, field("L2_T2_3D_P1", 2, &numbers([values(0.0), values(100.0)].concat())))
        .unwrap();
    for (component, add) in [("a:0", 0.0), ("a:1", 100.0)] {
        request.scalar = Some(component.to_owned());
        let own = grid(&mesh, &request);
        let found: BTreeSet<i64> =
            own.scalar.unwrap().iter().map(|value| (value * 10.0).round() as i64).collect();
        let expected = [3.5, 10.5].map(|mean| ((mean + add) * 10.0) as i64);
        assert_eq!(found.into_iter().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn values_of_the_old_cubic_space_stand_at_even_distances() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, solution) = (folder.path().join("a.mesh"), folder.path().join("a.gf"));
    std::fs::write(&mesh, ONE.replacen("v1.2", "v1.0", 1).split("mfem_serial").next().unwrap()).unwrap();
    // x² at the vertices, in the edges 01, 02, 03, 12, 13 and 23, and in the faces.
    let ninths =
        "0 9 0 0 1 4 0 0 0 0 4 1 4 1 0 0 1 0 1 1".split(' ').map(|word| word.parse::<f64>().unwrap() / 9.0);
    let values: Vec<String> = ninths.map(|value| value.to_string()).collect();
    std::fs::write(&solution, field("Cubic", 1, &values.join(" "))).unwrap();
    let own = grid(&mesh, &request("a"));
    let is_same = |(p, value): (&DVec3, &f64)| (value - p.x * p.x).abs() < 1e-14;
    assert!(own.points.iter().zip(own.scalar.as_ref().unwrap().iter()).all(is_same), "{:?}", own.scalar);
    assert!(own.points.iter().any(|p| p.x == 0.5));
}

#[test]
fn a_root_file_takes_no_solution() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.mfem_root"), root_text("1", "mesh", "f")).unwrap();
    std::fs::write(path("mesh"), ONE).unwrap();
    std::fs::write(path("f"), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    let found = message(&path("a.mfem_root"), &Request { solution: Some(path("f")), ..request("f") });
    assert!(found.contains("solution") && found.contains("mesh of a process"), "{found}");
}
