//! Trees that are wrong: one error each, which names the channel and the path.

use crate::drawn::{HEXAHEDRA, cubes, temperatures, unstructured};
use crate::library::{PIPELINE, drawn, folder, start, step};
use crate::tree::Tree;
use std::sync::Arc;
use voltet_graph::ranks::OneRank;

/// Fails unless a mesh is refused with these words.
#[track_caller]
fn refused(words: &[&str], describe: impl FnOnce(Tree) -> Tree) {
    let error = drawn(PIPELINE, describe).unwrap_err().to_string();
    for word in words {
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn what_is_missing_is_named_with_its_path() {
    let at = "catalyst/channels/grid/data";
    refused(&[at, "topologies is missing", "coordsets"], |tree| {
        tree.text("coordsets/coords/type", "explicit")
    });
    refused(&["topologies/mesh/type is missing", "found coordset"], |tree| {
        tree.text("coordsets/coords/type", "explicit").text("topologies/mesh/coordset", "coords")
    });
    refused(&["coordsets/others is missing"], |tree| cubes(tree).text("topologies/mesh/coordset", "others"));
    refused(&["/mesh has no field 'T'", "expected S"], |tree| {
        let tree = unstructured(cubes(tree), "hex");
        tree.text("fields/T/topology", "skin")
            .text("fields/S/topology", "mesh")
            .text("fields/S/association", "vertex")
            .array("fields/S/values", temperatures())
    });
    refused(&["fields/S/topology is missing"], |tree| {
        cubes(tree).text("fields/S/association", "vertex").array("fields/S/values", temperatures())
    });
}

#[test]
fn lengths_that_disagree_are_named() {
    refused(
        &["fields/T/values has the wrong number of values", "found 5", "12, one for each vertex"],
        |tree| cubes(tree).array("fields/T/values", vec![0.0_f64; 5]),
    );
    refused(&["coordsets/coords/values/y has another length", "found 3; expected 12"], |tree| {
        cubes(tree).array("coordsets/coords/values/y", vec![0.0_f64; 3])
    });
    refused(&["elements/connectivity has the wrong length", "found 15", "a multiple of 8"], |tree| {
        cubes(tree).array("topologies/mesh/elements/connectivity", HEXAHEDRA[..15].to_vec())
    });
    refused(&["elements/connectivity ends before cell 1 does", "found 16 numbers; expected 17"], |tree| {
        cubes(tree).array("topologies/mesh/elements/offsets", vec![0, 9_i32])
    });
    refused(&["elements/offsets has the wrong length", "found 3; expected 2"], |tree| {
        cubes(tree).array("topologies/mesh/elements/offsets", vec![0, 8, 16_i32])
    });
    refused(&["elements/dims has another number of points", "4 × 2 × 2"], |tree| {
        let tree = cubes(tree).text("topologies/mesh/type", "structured");
        let tree = tree.int64("topologies/mesh/elements/dims/i", 3);
        tree.int64("topologies/mesh/elements/dims/j", 1).int64("topologies/mesh/elements/dims/k", 1)
    });
    refused(&["states a wrong size of cell 1, \"hex\"", "found 6; expected 8"], |tree| {
        cubes(tree).array("topologies/mesh/elements/sizes", vec![8, 6_i32])
    });
}

#[test]
fn counts_that_no_memory_holds_are_refused_before_points_are_made() {
    let uniform = |tree: Tree, count: i64| {
        let tree = tree.text("coordsets/coords/type", "uniform");
        let tree = ["i", "j", "k"]
            .iter()
            .fold(tree, |tree, axis| tree.int64(&format!("coordsets/coords/dims/{axis}"), count));
        let tree = tree.text("topologies/mesh/type", "uniform").text("topologies/mesh/coordset", "coords");
        let tree = tree.text("fields/T/association", "vertex").text("fields/T/topology", "mesh");
        tree.array("fields/T/values", temperatures())
    };
    refused(&["coordsets/coords has too many points", "expected at most 4294967295"], |tree| {
        uniform(tree, 8_000_000_000_000_000)
    });
    // 100 GB of points.
    refused(&["fields/T/values has the wrong number of values", "found 12; expected 4251528000"], |tree| {
        uniform(tree, 1620)
    });
}

#[test]
fn numbers_out_of_range_are_named() {
    let with = |number: i32| {
        let mut connectivity = HEXAHEDRA.map(|point| point as i32);
        connectivity[9] = number;
        connectivity.to_vec()
    };
    for number in [12, -1, i32::MAX] {
        let found = format!("connectivity[9] is out of range: found {number}; expected 0 to 11");
        refused(&[&found], |tree| cubes(tree).array("topologies/mesh/elements/connectivity", with(number)));
    }
    refused(&["connectivity[3] is out of range: found 4000000000"], |tree| {
        unstructured(cubes(tree), "tet")
            .array("topologies/mesh/elements/connectivity", vec![0, 1, 2, 4_000_000_000_u32])
    });
    refused(&["connectivity has the wrong type", "Float64"], |tree| {
        cubes(tree).array("topologies/mesh/elements/connectivity", vec![0.0_f64; 16])
    });
    refused(&["names a subelement that does not exist", "found 7"], |tree| {
        let tree = unstructured(cubes(tree), "polyhedral");
        let tree = tree.array("topologies/mesh/elements/connectivity", vec![0, 1, 2, 7_i32]);
        let tree = tree.array("topologies/mesh/elements/sizes", vec![4_i32]);
        let tree = tree.text("topologies/mesh/subelements/shape", "tri");
        tree.array("topologies/mesh/subelements/connectivity", vec![0, 1, 3, 0, 1, 6, 0, 3, 6, 1, 3, 6_i32])
    });
    refused(&["shapes[1] is out of range: found 9; expected 12 (hex)"], |tree| {
        let tree = unstructured(cubes(tree), "mixed").int64("topologies/mesh/elements/shape_map/hex", 12);
        let tree = tree.array("topologies/mesh/elements/shapes", vec![12, 9_i32]);
        tree.array("topologies/mesh/elements/sizes", vec![8, 8_i32])
    });
}

#[test]
fn words_that_mean_nothing_are_named() {
    refused(&["elements/shape is no shape that is drawn", "\"hexa\"", "hex, wedge, pyramid"], |tree| {
        unstructured(cubes(tree), "hexa")
    });
    refused(&["coords/type is unknown", "\"curved\""], |tree| {
        cubes(tree).text("coordsets/coords/type", "curved")
    });
    refused(&["fields/T/association is unknown", "\"vertices\""], |tree| {
        cubes(tree).text("fields/T/association", "vertices")
    });
    refused(&["grid/type is not read", "\"amrmesh\""], |tree| {
        cubes(tree).within("").text("catalyst/channels/grid/type", "amrmesh")
    });
    refused(&["values has an axis that is not Cartesian", "'theta'"], |tree| {
        cubes(tree)
            .text("topologies/mesh/type", "structured")
            .array("topologies/mesh/elements/dims/k", vec![1_i32])
            .array("coordsets/coords/values/theta", vec![0.0_f64])
    });
    refused(&["topologies has no cells with volume"], |tree| unstructured(cubes(tree), "quad"));
    refused(&["grid_function makes a curved mesh"], |tree| {
        cubes(tree).text("topologies/mesh/grid_function", "gf")
    });
    refused(&["fields/T/values is of another machine"], |tree| {
        cubes(tree).strided(&["fields/T/values"], temperatures(), 12, 8, 1)
    });
    refused(&["timestep is out of range: found -3"], |tree| {
        cubes(tree).within("").int64("catalyst/state/timestep", -3)
    });
}

#[test]
fn pipelines_that_are_wrong_are_refused_at_once() {
    let refusal = |tree: Tree| match tree.simulation(Arc::new(OneRank)) {
        Ok(_) => panic!("it is not refused"),
        Err(error) => error.to_string(),
    };
    assert!(refusal(Tree::new()).contains("catalyst/scripts is missing"));
    let one = folder(PIPELINE);
    let argument = |text: &str| {
        let path = one.path().join("scene.toml");
        let tree = Tree::new().text("catalyst/scripts/a/filename", path.to_str().unwrap());
        refusal(tree.append("catalyst/scripts/a/args", text))
    };
    assert!(argument("every=0").contains("every=N with N from 1"));
    // One argument is a list of one.
    let path = one.path().join("scene.toml");
    let named = || Tree::new().text("catalyst/scripts/a/filename", path.to_str().unwrap());
    let alone = refusal(named().text("catalyst/scripts/a/args", "look.unit=3"));
    assert!(alone.contains("unit_distance"), "{alone}");
    let numbers = refusal(named().int64("catalyst/scripts/a/args", 3));
    assert!(numbers.contains("scripts/a/args is no list of texts: found numbers"), "{numbers}");
    let object = refusal(Tree::new().text("catalyst/scripts/a/file", path.to_str().unwrap()));
    assert!(object.contains("scripts/a is no text: found an object; expected a text"), "{object}");
    let twice = refusal(named().text("catalyst/scripts/b", path.to_str().unwrap()));
    assert!(twice.contains("two pipelines write one file: found '{step:03}.exr' of a and of b"), "{twice}");
    let unknown = argument("look.unit=3");
    assert!(unknown.contains("unit_distance") && unknown.contains("catalyst/scripts/a/args"), "{unknown}");
    let blocks = folder(&PIPELINE.replace("scalar =", "blocks = [\"a\"]\nscalar ="));
    assert!(refusal(start(blocks.path())).contains("the parameter is for files"));
}

#[test]
fn a_channel_that_goes_away_is_named_and_the_simulation_goes_on() {
    let folder = folder(PIPELINE);
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank)).unwrap();
    step(0, cubes).execute(&mut simulation).unwrap();
    let none = Tree::new().int64("catalyst/state/timestep", 1).text("catalyst/channels/other/type", "mesh");
    let error = none.execute(&mut simulation).unwrap_err().to_string();
    assert!(error.contains("catalyst/channels/grid is missing in this step: found other"), "{error}");
    let wrong = |tree: Tree| cubes(tree).array("fields/T/values", vec![0.0_f64; 5]);
    step(2, wrong).execute(&mut simulation).unwrap_err();
    step(3, cubes).execute(&mut simulation).unwrap();
    let names: Vec<bool> =
        ["000.exr", "001.exr", "002.exr", "003.exr"].map(|name| folder.path().join(name).exists()).into();
    assert_eq!(names, [true, false, false, true]);
}

#[test]
fn names_of_pipelines_that_there_are_not_are_refused() {
    let folder = folder(PIPELINE);
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank)).unwrap();
    // One name is a list of one.
    let other = step(0, cubes).text("catalyst/state/pipelines", "pictures");
    let error = other.execute(&mut simulation).unwrap_err().to_string();
    assert!(error.contains("names no script: found 'pictures'; expected picture"), "{error}");
    assert!(!folder.path().join("000.exr").exists());
}

#[test]
fn a_step_does_not_overwrite_the_picture_of_another() {
    let folder = folder(&PIPELINE.replace("{step:03}", "at_{time:.1}"));
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank)).unwrap();
    step(0, cubes).execute(&mut simulation).unwrap();
    step(0, cubes).execute(&mut simulation).unwrap();
    let close = step(1, cubes).float64("catalyst/state/time", 0.001);
    let error = close.execute(&mut simulation).unwrap_err().to_string();
    assert!(error.contains("'at_0.0.exr' of step 0, time 0 and of step 1, time 0.001"), "{error}");
    step(2, cubes).execute(&mut simulation).unwrap();
}
