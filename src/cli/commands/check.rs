//! `voltet check`: parses, type-checks and plans; reads no data.

use super::exit_status::{show, warn};
use super::pipelines::open_all;
use crate::cli::arguments::Files;
use crate::cli::present::{name, print};
use crate::core::Result;
use crate::document;
use crate::graph::Registry;

pub fn check(arguments: &Files, registry: &Registry) -> Result<u8> {
    let (documents, mut code) = open_all(&arguments.files, &arguments.set.options, registry);
    for document in &documents {
        warn(document);
        if let Err((error, text)) = document::refuse_conflicts([document], true, &[]) {
            code = code.max(show(&error, text));
            continue;
        }
        if let Err(error) = crate::nodes::session().plan(&document.graph) {
            code = code.max(show(&document.locate(error), Some(&document.text)));
            continue;
        }
        let path = name(&document.path.to_string_lossy());
        print(&format!("{path}: in order, {} nodes\n", document.graph.nodes.len()))?;
    }
    Ok(code)
}
