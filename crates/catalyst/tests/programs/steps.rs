//! Steps of a simulation: names of files, steps that are left out, several pipelines, memory.

use crate::drawn::{HEXAHEDRA, cubes, points, temperatures};
use crate::library::{PIPELINE, folder, library, picture, start, step};
use crate::tree::Tree;
use catalyst_voltet::interface::{self, DONE, WRONG};
use std::sync::Arc;
use voltet_graph::ranks::OneRank;

fn names(folder: &std::path::Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn pictures_are_named_by_step_and_time() {
    let folder = folder(&PIPELINE.replace("{step:03}.exr", "at_{time:.2}.exr"));
    std::fs::write(folder.path().join("second.toml"), PIPELINE.replace("{step:03}", "plain")).unwrap();
    let tree = start(folder.path())
        .text("catalyst/scripts/second/filename", folder.path().join("second.toml").to_str().unwrap())
        .append("catalyst/scripts/second/args", "every=2")
        .append("catalyst/scripts/second/args", "view.size=[8, 8]");
    let mut simulation = tree.simulation(Arc::new(OneRank)).unwrap();
    for number in [0, 3, 4] {
        step(number, cubes).execute(&mut simulation).unwrap();
    }
    // A step for some of the pipelines.
    let only = step(6, cubes).append("catalyst/state/pipelines", "picture");
    only.execute(&mut simulation).unwrap();
    let expected =
        ["at_0.00.exr", "at_0.75.exr", "at_1.00.exr", "at_1.50.exr", "plain_0000.exr", "plain_0004.exr"];
    assert_eq!(names(folder.path()), [&expected[..], &["scene.toml", "second.toml"]].concat());
    assert_eq!(picture(&folder.path().join("plain_0004.exr")).width, 8);
}

/// A pipeline that draws two grids, those of the nodes `grid` and `rest`.
pub fn two_grids() -> String {
    let further = PIPELINE.split_once("[nodes.look]").unwrap().0.split_once("[nodes.grid]").unwrap().1;
    let further = further.replace("[nodes.gradient]", "[nodes.slope]").replace("\"grid\"", "\"rest\"");
    let other = "[nodes.other]\ntype = \"renderer\"\nengine = \"cpu\"\n\
                 inputs = { volume = \"slope\", transfer_function = \"look\", camera = \"view\" }\n\n\
                 [nodes.other_file]\ntype = \"image-writer\"\npath = \"other_{step}.exr\"\ninputs = { image = \"other\" }\n";
    format!("{PIPELINE}\n[nodes.rest]{further}{other}")
}

#[test]
fn channels_feed_the_nodes_of_their_names() {
    let folder = folder(&two_grids());
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank)).unwrap();
    let unnamed = Tree::new().text("catalyst/channels/mesh/type", "mesh");
    let error = unnamed.execute(&mut simulation).unwrap_err().to_string();
    assert!(error.contains("channels mesh; nodes grid, rest"), "{error}");
    // A channel that comes later feeds its node, too; before, the node's file is missed.
    let error = step(0, cubes).execute(&mut simulation).unwrap_err().to_string();
    assert!(error.contains("mesh.vtu"), "{error}");
    let tree = step(1, cubes).text("catalyst/channels/rest/type", "mesh");
    cubes(tree.within("catalyst/channels/rest/data")).execute(&mut simulation).unwrap();
    assert_eq!(names(folder.path()), ["001.exr", "other_1.exr", "scene.toml"]);
}

/// The resident memory of this process (bytes).
fn resident() -> usize {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    pages.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 4096
}

#[test]
fn memory_stays_level_over_steps() {
    // A small picture, so that the steps cost little.
    let folder = folder(&PIPELINE.replace("size = [48, 40]", "size = [4, 4]"));
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank)).unwrap();
    // 40,000 points, so that a grid that is kept would take a megabyte a step.
    let side = 34;
    let large = |tree: Tree| {
        let tree = tree.text("coordsets/coords/type", "uniform");
        let tree = ["i", "j", "k"]
            .into_iter()
            .fold(tree, |tree, axis| tree.int64(&format!("coordsets/coords/dims/{axis}"), side));
        let tree = tree.text("topologies/mesh/type", "uniform").text("topologies/mesh/coordset", "coords");
        let tree = tree.text("fields/T/association", "vertex").text("fields/T/topology", "mesh");
        tree.array("fields/T/values", (0..side.pow(3)).map(|n| (n % 7) as f64 / 7.0).collect::<Vec<f64>>())
    };
    let run = |simulation: &mut _, steps: std::ops::Range<i64>| {
        steps.for_each(|number| step(number, large).execute(simulation).unwrap());
    };
    run(&mut simulation, 0..8);
    let before = resident();
    run(&mut simulation, 8..48);
    let grown = resident().saturating_sub(before);
    // 40 grids would take 200 MB; other tests beside this one take some.
    assert!(grown < 100 << 20, "{grown} bytes more after 40 steps");
}

#[test]
fn calls_in_a_wrong_order_are_refused() {
    library();
    let folder = folder(PIPELINE);
    let (begin, now) = (start(folder.path()), step(0, cubes));
    // SAFETY: trees that live, or null.
    unsafe {
        assert_eq!(interface::catalyst_execute_voltet(now.root()), WRONG);
        assert_eq!(interface::catalyst_finalize_voltet(now.root()), WRONG);
        assert_eq!(interface::catalyst_initialize_voltet(std::ptr::null()), WRONG);
        assert_eq!(interface::catalyst_initialize_voltet(begin.root()), DONE);
        assert_eq!(interface::catalyst_initialize_voltet(begin.root()), WRONG);
        assert_eq!(interface::catalyst_execute_voltet(now.root()), DONE);
        assert_eq!(interface::catalyst_results_voltet(now.root()), DONE);
        let about = Tree::new();
        assert_eq!(interface::catalyst_about_voltet(about.root()), DONE);
        assert_eq!(about.node().text_at("catalyst/implementation").unwrap(), "voltet");
        assert_eq!(interface::catalyst_finalize_voltet(now.root()), DONE);
        assert_eq!(interface::catalyst_initialize_voltet(begin.root()), DONE);
        assert_eq!(interface::catalyst_finalize_voltet(begin.root()), DONE);
    }
    assert!(folder.path().join("000.exr").exists());
}

#[test]
fn what_lies_side_by_side_in_64_bits_is_borrowed() {
    let tree = step(0, |tree| {
        let tree = cubes(tree).text("topologies/mesh/elements/shape", "tet");
        tree.array("topologies/mesh/elements/connectivity", HEXAHEDRA.to_vec())
    });
    let selection =
        catalyst_voltet::mesh::FieldSelection { named: [String::from("T")].into(), ..Default::default() };
    let loan: catalyst_voltet::conduit::Loan = Arc::new(());
    let channel = tree.node();
    let channel = channel.require("catalyst/channels/grid").unwrap();
    let pieces = catalyst_voltet::mesh::read(&channel, &selection, &loan).unwrap().pieces;
    let [piece] = &pieces[..] else { panic!("{} pieces", pieces.len()) };
    assert!(piece.points.is_lent() && piece.point_arrays["T"].values.is_lent());
    let voltet_core::grid::Cells::Tetrahedra(tetrahedra) = &piece.cells else { panic!("no tetrahedra") };
    assert!(tetrahedra.is_lent() && tetrahedra.len() == 4);
    assert_eq!(piece.points.len(), points().len());
    assert_eq!(piece.point_arrays["T"].values, temperatures());
    assert_eq!(Arc::strong_count(&loan), 4);
}
