//! Provenance as elements of XML, in drawings.

use crate::provenance::{MAX_TEXT, PIPELINE, PROVENANCE};
use quick_xml::escape::{escape, resolve_xml_entity};
use quick_xml::events::Event;
use std::io::BufRead;
use voltet_core::{Error, Result};

/// Name of the namespace `voltet`, in which the elements are.
pub(super) const NAMESPACE: &str = "https://github.com/voltet/voltet";

/// Most bytes that provenance takes at the begin of a file: two texts, for each character of which an entity may stand.
pub(super) const MAX_BEGIN: u64 = 16 * MAX_TEXT as u64;

/// Elements of named texts, in a line each.
pub(super) fn elements(texts: &[(&'static str, String)]) -> String {
    // A parser would make a line feed of a carriage return.
    let element = |(name, value): &(&str, String)| {
        format!("<{name}>{}</{name}>\n", escape(value.as_str()).replace('\r', "&#13;"))
    };
    texts.iter().map(element).collect()
}

/// The named texts up to the end of the element `last`. `format`: name of the file's format, for errors.
pub(super) fn texts(format: &str, file: impl BufRead, last: &str) -> Result<Vec<(String, String)>> {
    let what = format!("the drawing cannot be read as {format}");
    let damaged = |error: &dyn std::fmt::Display| Error::usage(what.clone()).got(error);
    let mut reader = quick_xml::Reader::from_reader(file);
    let (mut found, mut buffer) = (Vec::new(), Vec::new());
    let mut open: Option<(String, String)> = None;
    loop {
        buffer.clear();
        match reader.read_event_into(&mut buffer).map_err(|error| damaged(&error))? {
            Event::Start(tag) => {
                let name = [PIPELINE, PROVENANCE].into_iter().find(|name| tag.name().as_ref() == *name);
                open = name.map(|name| (name.to_string(), String::new()));
            }
            Event::Text(part) => {
                if let Some((_, text)) = &mut open {
                    *text += &part.xml10_content();
                }
            }
            Event::GeneralRef(entity) => {
                if let Some((_, text)) = &mut open {
                    match entity.resolve_char_ref().map_err(|error| damaged(&error))? {
                        Some(letter) => text.push(letter),
                        None => *text += resolve_xml_entity(&entity).ok_or_else(|| damaged(&&*entity))?,
                    }
                }
            }
            Event::End(tag) if tag.name().as_ref() == last => return Ok(found),
            Event::End(_) => found.extend(open.take().filter(|(_, text)| text.len() <= MAX_TEXT)),
            // The picture comes behind what it was made from.
            Event::Empty(_) | Event::Eof => return Ok(found),
            _ => {}
        }
    }
}
