//! Results of MFEM as it writes them (`tests/files/make_mfem.py`): fields are formulas, which come back at every point.

use super::refusals::says;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, Options, code};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, Request, files_beside, files_read_beside, inspect, read};

pub fn folder_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/mfem").join(name)
}

pub fn root(name: &str) -> PathBuf {
    folder_of(name).join(format!("{name}_000003.mfem_root"))
}

pub fn request(scalar: &str) -> Request {
    Request { scalar: Some(scalar.to_owned()), ..Request::default() }
}

pub fn grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

pub fn message(path: &Path, request: &Request) -> String {
    read(path, request, &NoProgress).unwrap_err().to_string()
}

pub fn linear(p: DVec3) -> f64 {
    1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z
}

fn quadratic(p: DVec3) -> f64 {
    linear(p) + p.x * p.x - p.y * p.z + p.z * p.z / 2.0
}

pub fn bent(p: DVec3) -> DVec3 {
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
pub fn places(grid: &Grid, bend: fn(DVec3) -> DVec3) -> Vec<[i64; 3]> {
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

pub const TWO: &str = "MFEM mesh v1.3\n# two\n\ndimension\n3\n\nelements\n2\n5 4 1 2 3 4\n7 4 2 3 4 5\n\nattribute_sets\n2\n\
    \"a \\\"b\\\"\"\n1\n7\nboth\n2\n5 7\n\nboundary\n1\n1 2 1 2 3\n\nbdr_attribute_sets\n0\n\nvertices\n6\n3\n9 9 9\n0 0 0\n1 0 0\n\
    0 1 0\n0 0 1\n1 1 1\n\nmfem_mesh_end\n";

pub fn field(space: &str, components: usize, values: &str) -> String {
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
        says(&found, &words);
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
        says(&found, &words);
    }
}

/// A mesh of one tetrahedron without fields, of one process of several.
pub const ONE: &str = "MFEM mesh v1.2\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n\nboundary\n0\n\nvertices\n4\n3\n0 0 0\n\
    1 0 0\n0 1 0\n0 0 1\n\nmfem_serial_mesh_end\n\ncommunication_groups\n";

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
