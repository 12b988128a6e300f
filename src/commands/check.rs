//! `voltet check`: parses and type-checks, runs nothing.

use super::{open_all, registry, warn};
use crate::arguments::Files;
use voltet::core::Result;

pub fn check(arguments: &Files) -> Result<u8> {
    let (documents, code) = open_all(&arguments.files, &arguments.set.options, &registry()?);
    for document in &documents {
        warn(document);
        println!("{}: in order, {} nodes", document.path.display(), document.graph.nodes.len());
    }
    Ok(code)
}
