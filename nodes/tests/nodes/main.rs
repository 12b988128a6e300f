//! The list of nodes against the folder, and the declarations' examples.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod annotation;
mod axes;
mod camera;
mod clips;
mod lines;
mod outputs;
mod parts;
mod relative;
mod slice_image;
mod surfaces;
mod threshold;
mod written;

use std::path::Path;
use voltet_core::Result;
use voltet_graph::Graph;
use voltet_graph::pipeline::Pipeline;
use voltet_nodes::{NODES, registry};

/// A pipeline file's text in a folder, ready to run.
fn graph(text: &str, folder: &Path) -> Result<Graph> {
    Pipeline::parse(text)?.graph(&registry()?, folder.into())
}

#[test]
fn the_folder_and_the_list_of_nodes_are_the_same() {
    let folder = std::fs::read_dir(env!("CARGO_MANIFEST_DIR")).unwrap();
    let names = folder.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut files: Vec<String> = names
        .filter_map(|name| name.strip_suffix(".rs").map(|stem| stem.replace('_', "-")))
        .filter(|stem| stem != "lib")
        .collect();
    let mut listed: Vec<&str> = NODES.iter().map(|node| node.name).collect();
    files.sort();
    listed.sort();
    assert_eq!(files, listed);
}

#[test]
fn every_example_passes_the_checker_and_uses_its_node() {
    for node in registry().unwrap().iter() {
        let graph =
            graph(node.example, Path::new(".")).unwrap_or_else(|error| panic!("{}: {error}", node.name));
        assert!(graph.warnings.is_empty(), "{}: {:?}", node.name, graph.warnings);
        assert!(graph.nodes.iter().any(|n| n.node.name == node.name), "{}", node.name);
    }
}

#[test]
fn help_is_one_line_and_summaries_are_sentences() {
    for node in NODES {
        assert!(node.summary.ends_with('.') && !node.summary.contains('\n'), "{}", node.name);
        for parameter in node.parameters {
            assert!(parameter.help.len() <= 120, "{}.{}", node.name, parameter.name);
        }
    }
}
