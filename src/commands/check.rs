//! `voltet check`: parses, type-checks and plans; reads no data.

use super::outcome::{show, warn};
use super::pipelines::open_all;
use crate::arguments::Files;
use crate::core::Result;
use crate::core::graph::Registry;

pub fn check(arguments: &Files, registry: &Registry) -> Result<u8> {
    let (documents, mut code) = open_all(&arguments.files, &arguments.set.options, registry);
    for document in &documents {
        warn(document);
        if let Err(error) = crate::nodes::session().plan(&document.graph) {
            code = code.max(show(&document.locate(error), Some(&document.text)));
            continue;
        }
        println!("{}: in order, {} nodes", document.path.display(), document.graph.nodes.len());
    }
    Ok(code)
}
