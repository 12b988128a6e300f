//! Options of the command line carried out in the text of a pipeline file: comments and all else stay.

use voltet_core::Result;
use voltet_document::{Document, Edit, Path};
use voltet_graph::pipeline::{Pipeline, value};
use voltet_graph::{ParameterValue, Registry, ResolvedPipeline};

/// The text that states `pipeline`, which `options` (`node.param=value`) made of `text`. Where they cannot be written into it,
/// a plain text that states the same.
pub fn stated(
    text: &str,
    options: &[String],
    pipeline: &Pipeline,
    registry: &Registry,
) -> Result<ResolvedPipeline> {
    let written = match options.is_empty() {
        true => Some(text.to_string()),
        false => {
            written(text, options).filter(|text| Pipeline::parse(text).is_ok_and(|read| read == *pipeline))
        }
    };
    Pipeline::stated(written.unwrap_or_else(|| pipeline.to_string()), registry)
}

fn written(text: &str, options: &[String]) -> Option<String> {
    let mut document = Document::from_text(text.to_string(), None);
    for option in options {
        let (path, given) = option.split_once('=')?;
        let (node, path) = path.trim().split_once('.')?;
        let value = value(given.trim())
            .map_or_else(|| ParameterValue::Text(given.trim().into()), |setting| setting.datum);
        document.edit(&Edit::Set { node: node.to_string(), path: Path::from(path), value }).ok()?;
    }
    Some(document.text().to_string())
}
