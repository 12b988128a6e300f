//! Templates: examples of node types that fit any data, with a data file in place of their own.

use crate::jobs::reads;
use std::path::Path;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_document::panel::{Control, Row};
use voltet_document::{Document, Edit};
use voltet_graph::{AxisRef, Field, NodeEntry, ParameterType, ParameterValue, PortType, Registry};
use voltet_io::formats::{Association, inspect};
use voltet_nodes::external_formats::request_of;
use voltet_nodes::files::{folder, relative_to};

/// A pipeline that fits any data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Template {
    pub title: String,
    pub text: &'static str,
}

/// The examples that fit any data, in the order of their nodes.
pub(crate) fn templates(registry: &Registry) -> Vec<Template> {
    let mut found: Vec<Template> = Vec::new();
    for text in registry.iter().map(|node| node.example) {
        if found.iter().any(|known| known.text == text) {
            continue;
        }
        let document = Document::from_text(text.to_string(), None);
        if let Some(title) = document.pipeline().title.clone().filter(|_| fits_any_data(&document, registry))
        {
            found.push(Template { title, text });
        }
    }
    found
}

/// True if a pipeline draws a picture of one data file, and says nothing of the data but the array to draw and numbers relative to them.
fn fits_any_data(document: &Document, registry: &Registry) -> bool {
    let nodes = &document.pipeline().nodes;
    let readers = nodes.iter().filter(|node| reads(node, registry)).count();
    let fits = |node: &NodeEntry| {
        let is_reader = reads(node, registry);
        // Of what a reader states, that alone is set for other data.
        let is_set = |row: &Row| ["path", "scalar", "association"].contains(&row.parameter.name);
        let fits = |row: &Row| if is_reader { is_set(row) || !is_stated(row) } else { row_fits(row) };
        document.rows(registry, &node.name).iter().all(fits)
    };
    readers == 1 && nodes.iter().any(|node| writes_picture(node, registry)) && nodes.iter().all(fits)
}

fn writes_picture(node: &NodeEntry, registry: &Registry) -> bool {
    let known = registry.node_type(node);
    known.is_some_and(|known| {
        known.outputs.is_empty() && known.inputs.iter().any(|port| port.port_type == PortType::Image)
    })
}

/// The rows within a row.
fn within(row: &Row) -> impl Iterator<Item = &Row> {
    row.rows.iter().chain(row.entries.iter().flat_map(|entry| &entry.rows))
}

/// True if a value is stated, of the parameter or within it.
fn is_stated(row: &Row) -> bool {
    row.set_value.is_some() || within(row).any(is_stated)
}

/// True if what is stated holds for any data.
fn row_fits(row: &Row) -> bool {
    let mut within = within(row);
    let Some(stated) = &row.set_value else { return within.all(row_fits) };
    let parameter = row.parameter;
    let is_s_or_g = matches!(stated, ParameterValue::Text(text) if text == "s" || text == "g");
    match row.control {
        Control::Table | Control::Entries(_) => within.all(row_fits),
        Control::Array => is_s_or_g,
        Control::Arrays | Control::Expression | Control::Texts | Control::InputFile => {
            matches!(stated, ParameterValue::Text(word) if !parameter.parameter_type.is_input_path(word))
        }
        // A unit is that of some data.
        Control::Text => !parameter.name.ends_with("unit"),
        _ => match parameter.parameter_type {
            ParameterType::Measured(measured) => {
                let AxisRef::Places(axes) = measured.axis else { return !has_number(stated, usize::MAX) };
                !has_number(stated, axes.len())
            }
            _ => !is_of_data(parameter.unit) || !has_number(stated, usize::MAX),
        },
    }
}

/// True if a number of this unit means something else in other data.
fn is_of_data(unit: &str) -> bool {
    unit.contains("world units") || unit.contains("units of") || unit.starts_with("as in")
}

/// True if a number is stated among the first `count` of a list, or of each row, other than 0 and infinity, which are the same in any unit.
fn has_number(stated: &ParameterValue, count: usize) -> bool {
    match stated {
        ParameterValue::Integer(number) => *number != 0,
        ParameterValue::Number(number) => *number != 0.0 && number.is_finite(),
        ParameterValue::List(list) => list.iter().enumerate().any(|(place, part)| match part.datum {
            ParameterValue::List(_) => has_number(&part.datum, count),
            _ => place < count && has_number(&part.datum, count),
        }),
        _ => false,
    }
}

impl Template {
    /// A document of it for a data file; its reader draws the array that `voltet start` would, its pictures are named after the pipeline.
    /// `at`: where it would be saved. Errors: the data cannot be read, or nothing in them can be drawn.
    pub fn filled(
        &self,
        data: &Path,
        at: &Path,
        registry: &Registry,
        progress: &dyn Progress,
    ) -> Result<Document> {
        let mut document = Document::from_text(self.text.to_string(), Some(at.to_path_buf()));
        let nodes = document.pipeline().nodes.clone();
        let reader = nodes.iter().find(|node| reads(node, registry));
        let mut entry = reader.cloned().ok_or_else(|| Error::usage("the template reads no file"))?;
        let reader = &entry.name.clone();
        let path = relative_to(data, folder(at)).to_string_lossy().into_owned();
        entry.settings = vec![Field::new("path", path.as_str())];
        document.edit(&Edit::set(reader, ["path"], path.into()))?;
        let (path, request) = request_of(&entry, &document.folder(), registry)?;
        let summary = inspect(&path, &request, progress)?;
        let of_data = |what: &str, expected: &str| Error::run(what).expected(expected).in_file(data);
        if !summary.has_volume() {
            return Err(of_data(
                "no cell has a volume, so there is nothing to draw",
                "cells of three dimensions",
            ));
        }
        let none =
            || of_data("no array is a quantity that varies", "a file with an array whose values differ");
        let array = summary.first_quantity().ok_or_else(none)?;
        document.edit(&Edit::set(reader, ["scalar"], array.scalar.into()))?;
        if array.association == Some(Association::Cell) {
            document.edit(&Edit::set(reader, ["association"], "cell".into()))?;
        }
        let stem = at.file_stem().unwrap_or_default().to_string_lossy();
        let writers: Vec<&NodeEntry> = nodes.iter().filter(|node| writes_picture(node, registry)).collect();
        for writer in &writers {
            let name = if writers.len() == 1 {
                format!("{stem}.png")
            } else {
                format!("{stem}_{}.png", writer.name)
            };
            document.edit(&Edit::set(&writer.name, ["path"], name.into()))?;
        }
        Ok(Document::from_text(document.text().to_string(), Some(at.to_path_buf())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The array that the reader of the example names.
    const SCALAR: &str = "scalar = \"temperature\"";

    #[test]
    fn what_is_said_of_some_data_makes_no_template() {
        let registry = voltet_nodes::registry().unwrap();
        let text = registry.find("annotation").unwrap().example;
        let fits = |text: &str| fits_any_data(&Document::from_text(text.to_string(), None), &registry);
        assert!(fits(text));
        let widget = "kind = \"colormap\"";
        for (from, to) in [
            (widget, "kind = \"colormap\"\nrange = [25.0, 105.0]"),
            (widget, "kind = \"gaussian\"\ncentre = [\"50 %\", 2.0]\nsigma = [\"5 %\", inf]"),
            (widget, "kind = \"gaussian-nd\"\nfields = [\"p\"]\ncentre = [\"50 %\"]\nsigma = [\"5 %\"]"),
            (widget, "kind = \"colormap\"\ncolormap = \"own.json\""),
            ("[nodes.view]\ntype = \"camera\"", "[nodes.view]\ntype = \"camera\"\nheight = 20.0"),
            ("type = \"transfer-function\"", "type = \"transfer-function\"\nunit_distance = 10.0"),
            ("axes = \"box\"", "axes = \"box\"\nlength_unit = \"mm\""),
            ("type = \"image-writer\"", "type = \"grid-writer\""),
            (SCALAR, "scalar = \"temperature\"\nblocks = [\"fluid/*\"]"),
            (SCALAR, "scalar = \"temperature\"\ndisplacement = \"disp\""),
            (SCALAR, "scalar = \"temperature\"\ntime_step = 3"),
            (SCALAR, "scalar = \"temperature\"\nsolution = \"flow.q\""),
            ("[nodes.view]", "[nodes.more]\ntype = \"reader\"\npath = \"more.vtu\"\n\n[nodes.view]"),
            ("[nodes.view]", "[nodes.part]\ntype = \"surface-reader\"\npath = \"part.stl\"\n\n[nodes.view]"),
        ] {
            assert!(text.contains(from) && !fits(&text.replace(from, to)), "{to}");
        }
        assert!(fits(&text.replace(SCALAR, "scalar = \"temperature\"\nassociation = \"cell\"")));
        // 0 and infinity are the same in any unit.
        assert!(fits(
            &text.replace(widget, "kind = \"gaussian\"\ncentre = [\"50 %\", 0.0]\nsigma = [\"5 %\", inf]")
        ));
    }
}
