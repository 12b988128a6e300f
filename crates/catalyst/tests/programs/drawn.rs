//! Meshes that are drawn: each as the same grid is that a program gives.

use crate::library::{PIPELINE, assert_same, drawn, truth};
use crate::tree::Tree;
use voltet::Grid;
use voltet_core::grid::{Array, CellSet, Cells, Polyhedron};

/// Points of two unit cubes side by side along x.
pub fn points() -> Vec<[f64; 3]> {
    let all = (0..2).flat_map(|k| (0..2).flat_map(move |j| (0..3).map(move |i| (i, j, k))));
    all.map(|(i, j, k)| [f64::from(i), f64::from(j), f64::from(k)]).collect()
}

/// A temperature at a point, which two digits behind the point tell exactly in 32 bits, too.
pub fn temperature([x, y, z]: [f64; 3]) -> f64 {
    (32.0 + 16.0 * x + 8.0 * y * z - 4.0 * z) / 64.0
}

pub fn temperatures() -> Vec<f64> {
    points().into_iter().map(temperature).collect()
}

/// The two cubes, in VTK's order.
pub const HEXAHEDRA: [u32; 16] = [0, 1, 4, 3, 6, 7, 10, 9, 1, 2, 5, 4, 7, 8, 11, 10];

fn hexahedra() -> Grid {
    Grid::from_vtk_arrays(points(), &[12, 12], &[0, 8, 16], &HEXAHEDRA).unwrap()
}

fn explicit(tree: Tree) -> Tree {
    let tree = tree.text("coordsets/coords/type", "explicit");
    let paths = ["x", "y", "z"].map(|axis| format!("coordsets/coords/values/{axis}"));
    tree.tuples(&paths.each_ref().map(String::as_str), points().concat())
}

pub fn unstructured(tree: Tree, shape: &str) -> Tree {
    let tree = tree.text("topologies/mesh/type", "unstructured").text("topologies/mesh/coordset", "coords");
    tree.text("topologies/mesh/elements/shape", shape)
}

fn field(tree: Tree, name: &str, association: &str) -> Tree {
    let tree = tree.text(&format!("fields/{name}/association"), association);
    tree.text(&format!("fields/{name}/topology"), "mesh")
}

pub fn with_temperature(tree: Tree) -> Tree {
    field(tree, "T", "vertex").array("fields/T/values", temperatures())
}

/// The two cubes as a mesh of the Blueprint.
pub fn cubes(tree: Tree) -> Tree {
    let tree = unstructured(explicit(tree), "hex");
    with_temperature(tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.map(i64::from).to_vec()))
}

#[test]
fn hexahedra_are_drawn_as_a_grid_that_a_program_gives() {
    let expected = truth(PIPELINE, hexahedra().point_data("T", temperatures()).unwrap());
    assert_same(&drawn(PIPELINE, cubes).unwrap(), &expected);
}

#[test]
fn numbers_of_any_type_and_stride_give_the_same_picture() {
    let expected = truth(PIPELINE, hexahedra().point_data("T", temperatures()).unwrap());
    let columns = |tree: Tree| {
        let column = |axis: usize| points().iter().map(|point| point[axis]).collect::<Vec<f64>>();
        let tree = tree.text("coordsets/coords/type", "explicit");
        let tree = tree.array("coordsets/coords/values/x", column(0));
        // One axis in 32 bits, and one with bytes between.
        let y = column(1).iter().map(|y| *y as f32).collect();
        let z = column(2).iter().flat_map(|z| [*z, f64::NAN, f64::NAN]).collect();
        let tree = tree.array("coordsets/coords/values/y", y);
        tree.strided(&["coordsets/coords/values/z"], z, 12, 24, 0)
    };
    let connectivity = "topologies/mesh/elements/connectivity";
    let trees: [fn(Tree) -> Tree; 4] = [
        |tree| tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.map(|n| n as i32).to_vec()),
        |tree| tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.to_vec()),
        |tree| tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.map(|n| n as u8).to_vec()),
        |tree| tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.map(u64::from).to_vec()),
    ];
    for numbers in trees {
        let describe = |tree: Tree| {
            let tree = numbers(unstructured(columns(tree), "hex"));
            let values = temperatures().iter().map(|value| *value as f32).collect();
            field(tree, "T", "vertex").array("fields/T/values", values)
        };
        assert_same(&drawn(PIPELINE, describe).unwrap(), &expected);
    }
    // Whole numbers as values.
    let scaled = |value: &f64| (value * 64.0) as i32;
    let whole = temperatures().iter().map(scaled).collect::<Vec<i32>>();
    let pipeline = PIPELINE.replace("[0.5, 1.0]", "[40.0, 20.0]").replace("[0.3, 1.5]", "[20.0, 30.0]");
    let given = whole.iter().map(|value| f64::from(*value)).collect::<Vec<f64>>();
    let expected = truth(&pipeline, hexahedra().point_data("T", given).unwrap());
    let describe = |tree: Tree| {
        let tree = unstructured(explicit(tree), "hex").array(connectivity, HEXAHEDRA.to_vec());
        field(tree, "T", "vertex").array("fields/T/values", whole.clone())
    };
    assert_same(&drawn(&pipeline, describe).unwrap(), &expected);
}

#[test]
fn tetrahedra_are_borrowed_in_32_bits_and_copied_in_64() {
    let tetrahedra: [u32; 8] = [0, 1, 3, 6, 1, 4, 5, 10];
    let grid = Grid::from_vtk_arrays(points(), &[10, 10], &[0, 4, 8], &tetrahedra).unwrap();
    let expected = truth(PIPELINE, grid.point_data("T", temperatures()).unwrap());
    for is_wide in [false, true] {
        let describe = |tree: Tree| {
            let tree = unstructured(explicit(tree), "tet");
            let path = "topologies/mesh/elements/connectivity";
            with_temperature(match is_wide {
                true => tree.array(path, tetrahedra.map(i64::from).to_vec()),
                false => tree.array(path, tetrahedra.map(|number| number as i32).to_vec()),
            })
        };
        assert_same(&drawn(PIPELINE, describe).unwrap(), &expected);
    }
}

#[test]
fn mixed_shapes_are_drawn_with_offsets_in_any_order() {
    // A cube, a pyramid on its side, a quadrilateral and a wedge.
    let connectivity = vec![1, 2, 5, 4, 7, 8, 11, 10, 0, 3, 9, 6, 10, 0, 1, 4, 3, 0, 1, 3, 6, 7, 9_i32];
    let cells: [(u8, &[u32]); 3] =
        [(14, &[0, 3, 9, 6, 10]), (12, &[1, 2, 5, 4, 7, 8, 11, 10]), (13, &[0, 1, 3, 6, 7, 9])];
    let types: Vec<u8> = cells.iter().map(|cell| cell.0).collect();
    let all: Vec<u32> = cells.iter().flat_map(|cell| cell.1).copied().collect();
    let grid = Grid::from_vtk_arrays(points(), &types, &[0, 5, 13, 19], &all).unwrap();
    let expected = truth(PIPELINE, grid.point_data("T", temperatures()).unwrap());
    let describe = |tree: Tree| {
        let tree = unstructured(explicit(tree), "mixed");
        let tree =
            [("hex", 12), ("pyramid", 3), ("quad", 9), ("wedge", 77)].into_iter().fold(tree, |tree, own| {
                tree.int64(&format!("topologies/mesh/elements/shape_map/{}", own.0), own.1)
            });
        let tree = tree.array("topologies/mesh/elements/shapes", vec![3, 12, 9, 77_i32]);
        let tree = tree.array("topologies/mesh/elements/sizes", vec![5, 8, 4, 6_i32]);
        let tree = tree.array("topologies/mesh/elements/offsets", vec![8, 0, 13, 17_i64]);
        with_temperature(tree.array("topologies/mesh/elements/connectivity", connectivity.clone()))
    };
    assert_same(&drawn(PIPELINE, describe).unwrap(), &expected);
}

/// Faces of the two cubes as polyhedra; that between them is of both.
const FACES: [[u32; 4]; 11] = [
    [0, 3, 9, 6],
    [1, 4, 10, 7],
    [0, 1, 7, 6],
    [3, 4, 10, 9],
    [0, 1, 4, 3],
    [6, 7, 10, 9],
    [2, 5, 11, 8],
    [1, 2, 8, 7],
    [4, 5, 11, 10],
    [1, 2, 5, 4],
    [7, 8, 11, 10],
];

#[test]
fn polyhedra_are_drawn() {
    let of_cells = [[0, 1, 2, 3, 4, 5], [6, 1, 7, 8, 9, 10]];
    let polyhedra = of_cells.iter().zip(0..).map(|(faces, cell)| Polyhedron {
        cell,
        faces: faces.iter().map(|&face: &usize| FACES[face].to_vec()).collect(),
    });
    let sorted = |cell: [u32; 8]| {
        let mut cell = cell.to_vec();
        cell.sort_unstable();
        cell
    };
    let [first, second] = [0, 8].map(|start| sorted(*HEXAHEDRA[start..].first_chunk::<8>().unwrap()));
    let cells = CellSet {
        types: vec![42, 42],
        offsets: vec![0, 8, 16],
        connectivity: [first, second].concat(),
        polyhedra: polyhedra.collect(),
    };
    let grid = Grid::from_cells(points(), Cells::Mixed(cells)).unwrap();
    let expected = truth(PIPELINE, grid.point_data("T", temperatures()).unwrap());
    let describe = |tree: Tree| {
        let tree = unstructured(explicit(tree), "polyhedral");
        let numbers = of_cells.concat().iter().map(|face| *face as i32).collect();
        let tree = tree.array("topologies/mesh/elements/connectivity", numbers);
        let tree = tree.array("topologies/mesh/elements/sizes", vec![6, 6_i32]);
        let tree = tree.array("topologies/mesh/elements/offsets", vec![0, 6_i32]);
        let tree = tree.text("topologies/mesh/subelements/shape", "polygonal");
        let tree = tree.array("topologies/mesh/subelements/connectivity", FACES.concat());
        with_temperature(tree.array("topologies/mesh/subelements/sizes", vec![4_i32; 11]))
    };
    assert_same(&drawn(PIPELINE, describe).unwrap(), &expected);
}

#[test]
fn implicit_meshes_are_drawn_as_explicit_ones() {
    let expected = truth(
        PIPELINE,
        Grid::from_cells(points(), Cells::Structured([3, 2, 2]))
            .unwrap()
            .point_data("T", temperatures())
            .unwrap(),
    );
    let uniform = |tree: Tree| {
        let tree = tree.text("coordsets/coords/type", "uniform");
        let tree = tree.int64("coordsets/coords/dims/i", 3).int64("coordsets/coords/dims/j", 2);
        let tree = tree.int64("coordsets/coords/dims/k", 2).float64("coordsets/coords/origin/x", 0.0);
        let tree = tree.float64("coordsets/coords/spacing/dx", 1.0);
        with_temperature(
            tree.text("topologies/mesh/type", "uniform").text("topologies/mesh/coordset", "coords"),
        )
    };
    let rectilinear = |tree: Tree| {
        let tree = tree.text("coordsets/coords/type", "rectilinear");
        let tree = tree.array("coordsets/coords/values/x", vec![0.0, 1.0, 2.0_f32]);
        let tree = tree.array("coordsets/coords/values/y", vec![0.0, 1.0_f64]);
        let tree = tree.array("coordsets/coords/values/z", vec![0, 1_i32]);
        with_temperature(
            tree.text("topologies/mesh/type", "rectilinear").text("topologies/mesh/coordset", "coords"),
        )
    };
    let structured = |tree: Tree| {
        let tree = explicit(tree).text("topologies/mesh/type", "structured");
        let tree = tree.text("topologies/mesh/coordset", "coords");
        let dims = [("i", 2), ("j", 1), ("k", 1)];
        with_temperature(dims.into_iter().fold(tree, |tree, (axis, count)| {
            tree.int64(&format!("topologies/mesh/elements/dims/{axis}"), count)
        }))
    };
    assert_same(&drawn(PIPELINE, uniform).unwrap(), &expected);
    assert_same(&drawn(PIPELINE, rectilinear).unwrap(), &expected);
    assert_same(&drawn(PIPELINE, structured).unwrap(), &expected);
}

#[test]
fn values_of_elements_are_averaged_or_kept_as_the_pipeline_says() {
    let describe = |tree: Tree| {
        let tree = unstructured(explicit(tree), "hex");
        let tree = tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.to_vec());
        field(tree, "T", "element").array("fields/T/values", vec![0.25_f32, 0.75])
    };
    let given = || hexahedra().cell_data("T", vec![0.25, 0.75]).unwrap();
    assert_same(&drawn(PIPELINE, describe).unwrap(), &truth(PIPELINE, given()));
    let constant = PIPELINE.replace("scalar = \"T\"", "scalar = \"T\"\ncell_values = \"constant\"");
    let constant = constant.replace("[0.5, 1.0]", "[0.5, 0.0]");
    assert_same(&drawn(&constant, describe).unwrap(), &truth(&constant, given().constant_cell_data()));
}

#[test]
fn a_part_of_a_vector_is_drawn_side_by_side_or_apart() {
    let vectors: Vec<[f64; 3]> =
        temperatures().iter().map(|value| [value * 0.5, value * 0.25, 0.125]).collect();
    for scalar in ["v:magnitude", "v:1"] {
        let pipeline =
            PIPELINE.replace("\"T\"", &format!("\"{scalar}\"")).replace("[0.5, 1.0]", "[0.25, 0.5]");
        let array = Array { component_count: 3, values: vectors.concat().into() };
        let expected = truth(&pipeline, hexahedra().point_data("v", array).unwrap());
        for is_interleaved in [true, false] {
            let describe = |tree: Tree| {
                let tree = field(cubes(tree), "v", "vertex");
                let paths = ["u", "v", "w"].map(|name| format!("fields/v/values/{name}"));
                match is_interleaved {
                    true => tree.tuples(&paths.each_ref().map(String::as_str), vectors.concat()),
                    false => paths.iter().enumerate().fold(tree, |tree, (axis, path)| {
                        tree.array(path, vectors.iter().map(|vector| vector[axis]).collect::<Vec<f64>>())
                    }),
                }
            };
            assert_same(&drawn(&pipeline, describe).unwrap(), &expected);
        }
    }
}

/// One of the two cubes as a domain of its own, with those of its points alone.
pub fn cube(tree: Tree, number: usize) -> Tree {
    let own: Vec<[f64; 3]> = (0..8).map(|place| points()[HEXAHEDRA[8 * number + place] as usize]).collect();
    let tree = tree.text("coordsets/coords/type", "explicit");
    let paths = ["x", "y", "z"].map(|axis| format!("coordsets/coords/values/{axis}"));
    let tree = tree.tuples(&paths.each_ref().map(String::as_str), own.concat());
    let tree = unstructured(tree, "hex")
        .array("topologies/mesh/elements/connectivity", vec![0, 1, 2, 3, 4, 5, 6, 7_i32]);
    field(tree, "T", "vertex")
        .array("fields/T/values", own.into_iter().map(temperature).collect::<Vec<f64>>())
}

#[test]
fn domains_are_one_grid_and_meshes_are_blocks() {
    let piece = |number: usize| {
        let own: Vec<[f64; 3]> =
            (0..8).map(|place| points()[HEXAHEDRA[8 * number + place] as usize]).collect();
        let values: Vec<f64> = own.iter().copied().map(temperature).collect();
        let grid = Grid::from_vtk_arrays(own, &[12], &[0, 8], &[0, 1, 2, 3, 4, 5, 6, 7]).unwrap();
        grid.point_data("T", values).unwrap()
    };
    let expected = truth(PIPELINE, Grid::from_pieces([piece(0), piece(1)]).unwrap());
    let data = "catalyst/channels/grid/data";
    let domains = |tree: Tree| {
        let tree = cube(tree.within(&format!("{data}/domain_0")), 0);
        cube(tree.within(&format!("{data}/domain_1")), 1)
    };
    assert_same(&drawn(PIPELINE, domains).unwrap(), &expected);
    // A block without the field is left out.
    let meshes = |tree: Tree| {
        let tree = tree.within("").text("catalyst/channels/grid/type", "multimesh");
        let tree = unstructured(explicit(tree.within(&format!("{data}/solid"))), "hex");
        let tree = tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.to_vec());
        cube(tree.within(&format!("{data}/fluid")), 1)
    };
    assert_same(&drawn(PIPELINE, meshes).unwrap(), &truth(PIPELINE, piece(1)));
}

#[test]
fn ghost_cells_are_left_out() {
    let expected = truth(
        PIPELINE,
        hexahedra().ghost_cells(vec![0, 1]).unwrap().point_data("T", temperatures()).unwrap(),
    );
    let ghosts = |tree: Tree, name: &str| field(cubes(tree), name, "element");
    let vtk = |tree: Tree| ghosts(tree, "vtkGhostType").array("fields/vtkGhostType/values", vec![0, 1_u8]);
    let ascent =
        |tree: Tree| ghosts(tree, "ascent_ghosts").array("fields/ascent_ghosts/values", vec![0, 1_i32]);
    let named = |tree: Tree| {
        let tree = ghosts(tree, "mine").array("fields/mine/values", vec![5, 9_i32]);
        let tree = tree.text("metadata/vtk_fields/mine/attribute_type", "Ghosts");
        let tree = tree.array("metadata/vtk_fields/mine/values_to_replace", vec![5, 9_i32]);
        tree.array("metadata/vtk_fields/mine/replacement_values", vec![0, 1_i32])
    };
    assert_same(&drawn(PIPELINE, vtk).unwrap(), &expected);
    assert_same(&drawn(PIPELINE, ascent).unwrap(), &expected);
    assert_same(&drawn(PIPELINE, named).unwrap(), &expected);
    // A cell without a meaning serves no mean, whatever its value; its flag may be a float.
    let wild = vec![0.5, 1e9_f64];
    let grid = hexahedra().ghost_cells(vec![0, 32]).unwrap().cell_data("T", wild.clone()).unwrap();
    let pipeline = PIPELINE.replace("[0.5, 1.0]", "[0.5, 0.0]");
    let garbage = |tree: Tree| {
        let tree = field(unstructured(explicit(tree), "hex"), "T", "element");
        let tree = tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.to_vec());
        let tree = field(tree.array("fields/T/values", wild.clone()), "ascent_ghosts", "element");
        tree.array("fields/ascent_ghosts/values", vec![0.0, 2.0_f64])
    };
    assert_same(&drawn(&pipeline, garbage).unwrap(), &truth(&pipeline, grid));
}

#[test]
fn surfaces_and_fields_that_nothing_uses_are_not_looked_at() {
    let expected = truth(PIPELINE, hexahedra().point_data("T", temperatures()).unwrap());
    let describe = |tree: Tree| {
        let tree = field(cubes(tree), "unused", "vertex").array("fields/unused/values", vec![1.0_f64; 5]);
        let tree =
            tree.text("topologies/skin/type", "unstructured").text("topologies/skin/coordset", "coords");
        let tree = tree.text("topologies/skin/elements/shape", "quad");
        let tree = tree.array("topologies/skin/elements/connectivity", vec![0, 1, 4, 3_i32]);
        let tree =
            tree.text("topologies/sheet/type", "structured").text("topologies/sheet/coordset", "coords");
        let tree = ["i", "j"]
            .iter()
            .fold(tree, |tree, axis| tree.int64(&format!("topologies/sheet/elements/dims/{axis}"), 1));
        let tree = tree.text("fields/load/association", "element").text("fields/load/topology", "skin");
        tree.array("fields/load/values", vec![1.0_f64])
    };
    assert_same(&drawn(PIPELINE, describe).unwrap(), &expected);
}
