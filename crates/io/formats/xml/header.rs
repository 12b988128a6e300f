//! The XML part of a file as a tree of elements, up to the appended data.
//!
//! What follows `<AppendedData encoding="raw">_` is not XML, so the parser stops at that tag and the rest of the file
//! is only ever read at the positions that the arrays name. Of the text inside elements only the place is kept.

use crate::formats::source::Source;
use crate::formats::text::TextRange;
use quick_xml::events::{BytesStart, Event};
use std::cell::RefCell;
use std::collections::HashMap;
use std::io::{BufReader, Read};
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// More elements than any writer makes; bounds the memory that a file of empty elements can take.
const GREATEST_ELEMENT_COUNT: usize = 500_000;
/// Deeper than any VTK file.
const GREATEST_DEPTH: usize = 32;
/// Text that entities stand for, for each byte of the file: they name a file in some items.
const MAX_REFERRED_PER_BYTE: u64 = 4;

#[derive(Debug, Default)]
pub(in crate::formats) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    /// Places of the text directly inside this element, white space alone left out.
    pub text: Vec<Range<u64>>,
}

impl Element {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The value of an attribute that must be there.
    pub fn required(&self, name: &str) -> Result<&str> {
        self.attribute(name).ok_or_else(|| {
            let what = format!("the element <{}> lacks its attribute {name}", self.tag);
            Error::run(what).expected(format_args!("<{} {name}=\"…\">", self.tag))
        })
    }

    /// An attribute as a number; an error where it is there and is none.
    pub fn number<T: std::str::FromStr>(&self, name: &str) -> Result<Option<T>> {
        let Some(value) = self.attribute(name) else { return Ok(None) };
        value.trim().parse().map(Some).map_err(|_| self.wrong(name, "a number"))
    }

    /// An attribute as a list of `N` numbers.
    pub fn numbers<T: std::str::FromStr, const N: usize>(&self, name: &str) -> Result<Option<[T; N]>> {
        let Some(value) = self.attribute(name) else { return Ok(None) };
        let numbers: Option<Vec<T>> = value.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        let wrong = || self.wrong(name, &format!("{N} numbers"));
        numbers.and_then(|numbers| numbers.try_into().ok()).map(Some).ok_or_else(wrong)
    }

    /// Values of these attributes, of this element and all below it.
    pub fn attributes_below(&self, names: &[&str]) -> Vec<&str> {
        let own = names.iter().filter_map(|name| self.attribute(name));
        own.chain(self.children.iter().flat_map(|child| child.attributes_below(names))).collect()
    }

    /// An error about an attribute.
    pub fn wrong(&self, name: &str, accepted: &str) -> Error {
        Error::run(format!("the attribute {name} of <{}> is wrong", self.tag))
            .got(format_args!("'{}'", self.attribute(name).unwrap_or("")))
            .expected(accepted)
    }

    /// True for an item of XDMF whose text names a file; that of others holds numbers.
    fn names_file(&self) -> bool {
        self.tag == "DataItem" && self.attribute("Format").is_some_and(|format| format != "XML")
    }

    pub fn child(&self, tag: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.tag == tag)
    }

    pub fn children_of<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.tag == tag)
    }
}

/// The appended data of a file.
#[derive(Debug, Clone, Copy)]
pub(in crate::formats) struct Appended {
    /// The byte after the underscore, from which offsets count.
    pub offset: u64,
    pub base64: bool,
}

/// Reads the header: its root, and where the appended data begins.
pub(super) fn read(source: &Arc<Source>) -> Result<(Element, Option<Appended>)> {
    read_as(source, "VTKFile")
}

/// Reads a header whose root has this tag.
pub(in crate::formats) fn read_as(
    source: &Arc<Source>,
    root_tag: &str,
) -> Result<(Element, Option<Appended>)> {
    let mark = if source.head(3)? == *BYTE_ORDER_MARK { BYTE_ORDER_MARK.len() as u64 } else { 0 };
    let widened = Rc::new(RefCell::new(Vec::new()));
    let latin = is_latin(&source.head(256)?).then(|| Latin { widened: widened.clone(), given: 0 });
    let stream = BufReader::with_capacity(
        (1 << 16).min(source.len() as usize + 1),
        Stream { source, at: mark, latin },
    );
    let mut reader = quick_xml::Reader::from_reader(stream);
    // The byte of the file from a byte of what is parsed.
    let place = |position: u64| {
        let more = widened.borrow().partition_point(|&widened| widened < position);
        mark + position - more as u64
    };
    let text = TextRange::new(source, 0..source.len());
    let mut open: Vec<Element> = vec![Element::default()];
    let mut entities = HashMap::new();
    let mut referred_bytes = 0_u64;
    let mut buffer = Vec::new();
    let mut count = 0;
    loop {
        buffer.clear();
        let start = place(reader.buffer_position());
        let event = reader.read_event_into(&mut buffer);
        let end = place(reader.buffer_position());
        let event = match event {
            Ok(event) => event,
            Err(error) => {
                let error = Error::run("the XML is damaged").got(error).expected(
                    "XML in the encoding that the first line declares; UTF-8, where it declares none",
                );
                return Err(text.locate(error, place(reader.error_position()).max(start)));
            }
        };
        let failed = |error: Error| text.locate(error, start);
        match event {
            Event::Start(tag) if tag.name().as_ref() == "AppendedData" => {
                let element = element(&tag).map_err(failed)?;
                let appended = appended(source, &element, end).map_err(failed)?;
                while open.len() > 1 {
                    close(&mut open);
                }
                return root(open, root_tag).map(|root| (root, Some(appended)));
            }
            Event::Start(tag) => {
                open.push(element(&tag).map_err(failed)?);
                count += 1;
            }
            Event::Empty(tag) => {
                open.push(element(&tag).map_err(failed)?);
                close(&mut open);
                count += 1;
            }
            Event::End(_) => close(&mut open),
            Event::Text(words) => {
                // White space stands between entities.
                let is_text = |inner: &&mut Element| {
                    !words.trim_ascii().is_empty() || inner.names_file() && !inner.text.is_empty()
                };
                if let Some(inner) = open.last_mut().filter(is_text) {
                    inner.text.push(start..end);
                }
            }
            Event::DocType(_) => entities = declared_entities(source, start..end)?,
            Event::GeneralRef(name)
                if entities.contains_key(name.as_ref()) && open.last().is_some_and(Element::names_file) =>
            {
                let value: Range<u64> = entities[name.as_ref()].clone();
                referred_bytes = referred_bytes.saturating_add(value.end - value.start);
                if referred_bytes > source.len().saturating_mul(MAX_REFERRED_PER_BYTE) {
                    return Err(failed(
                        Error::run("the entities of the XML stand for too much text").expected(format!(
                            "at most {MAX_REFERRED_PER_BYTE} times the length of the file"
                        )),
                    ));
                }
                if let Some(inner) = open.last_mut().filter(|_| !value.is_empty()) {
                    inner.text.push(value);
                }
            }
            Event::CData(_) | Event::GeneralRef(_)
                if open
                    .last()
                    .is_some_and(|inner| ["DataArray", "DataItem"].contains(&inner.tag.as_str())) =>
            {
                return Err(failed(
                    Error::run("the values of an array are not plain text")
                        .expected("numbers or base64 text"),
                ));
            }
            Event::Eof => break,
            _ => {}
        }
        if open.len() > GREATEST_DEPTH || count > GREATEST_ELEMENT_COUNT {
            return Err(failed(Error::run("the XML holds more elements than a data file can need")));
        }
    }
    if open.len() > 1 {
        let tag = open.pop().map(|element| element.tag).unwrap_or_default();
        let error = Error::run("the file ends early").got(format_args!("no end of <{tag}>"));
        return Err(error.expected("a file that was written to its end"));
    }
    root(open, root_tag).map(|root| (root, None))
}

/// Places of the values of the entities that a DOCTYPE declares in its first 64 KiB: `<!ENTITY NAME "VALUE">`. Of several of a name
/// the first holds (XML 1.0, 4.2). Those of values with entities within are not among them.
fn declared_entities(
    source: &Source,
    Range { start, end }: Range<u64>,
) -> Result<HashMap<String, Range<u64>>> {
    const LONGEST: u64 = 1 << 16;
    const MARK: &str = "<!ENTITY";
    let bytes = source.read(start, (end - start).min(LONGEST))?;
    // A byte a character.
    let text: String =
        bytes.iter().map(|&byte| if byte.is_ascii() { char::from(byte) } else { '?' }).collect();
    let (mut entities, mut at) = (HashMap::new(), 0);
    while let Some(place) = text[at..].find('<') {
        at += place;
        if text[at..].starts_with("<!--") {
            let Some(length) = text[at..].find("-->") else { break };
            at += length;
            continue;
        }
        let Some(rest) = text[at..].strip_prefix(MARK) else {
            at += 1;
            continue;
        };
        let Some(quote) = rest.find(['"', '\'']) else { break };
        let Some(length) = rest[quote + 1..].find(&rest[quote..=quote]) else { break };
        let (name, value) = (rest[..quote].trim(), &rest[quote + 1..][..length]);
        let first = at + MARK.len() + quote + 1;
        at = first + length;
        if !name.is_empty() && !name.contains(|own: char| own.is_whitespace() || "<>&%".contains(own)) {
            entities.entry(name.to_owned()).or_insert((value, start + first as u64));
        }
    }
    let is_plain = |value: &str| !value.contains(['&', '%']);
    let known = entities.into_iter().filter(|(_, (value, _))| is_plain(value));
    Ok(known.map(|(name, (value, first))| (name, first..first + value.len() as u64)).collect())
}

/// Ends the innermost open element.
fn close(open: &mut Vec<Element>) {
    if open.len() > 1
        && let Some(inner) = open.pop()
        && let Some(outer) = open.last_mut()
    {
        outer.children.push(inner);
    }
}

fn root(open: Vec<Element>, tag: &str) -> Result<Element> {
    let document = open.into_iter().next().unwrap_or_default();
    let found = document.children.first().map_or("no element".to_owned(), |root| format!("<{}>", root.tag));
    document.children.into_iter().find(|child| child.tag == tag).ok_or_else(|| match tag {
        "VTKFile" => Error::run("this is not a VTK file").got(found).expected("<VTKFile type=\"…\">"),
        _ => Error::run("the XML is of another kind").got(found).expected(format!("<{tag}>")),
    })
}

fn element(tag: &BytesStart) -> Result<Element> {
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let wrong = |reason: String| {
            let error = Error::run(format!("an attribute of <{}> is damaged", tag.name().as_ref()));
            error.got(reason).expected("NAME=\"VALUE\", in which & is written as &amp;")
        };
        let attribute = attribute.map_err(|error| wrong(error.to_string()))?;
        let value = attribute
            .normalized_value(quick_xml::XmlVersion::Implicit1_0)
            .map_err(|error| wrong(error.to_string()))?;
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    Ok(Element { tag: tag.name().as_ref().to_owned(), attributes, ..Element::default() })
}

/// Finds the underscore after the opening tag.
fn appended(source: &Source, element: &Element, at: u64) -> Result<Appended> {
    let base64 = match element.attribute("encoding").unwrap_or("base64") {
        "raw" => false,
        "base64" => true,
        _ => return Err(element.wrong("encoding", "raw or base64")),
    };
    let head = source.read(at, (source.len() - at).min(4096))?;
    match head.iter().position(|b| !b.is_ascii_whitespace()) {
        Some(index) if head[index] == b'_' => Ok(Appended { offset: at + index as u64 + 1, base64 }),
        _ => Err(Error::run("the appended data does not begin with an underscore")
            .expected("'_' after <AppendedData>")),
    }
}

/// The mark of UTF-8 at the head of a file.
const BYTE_ORDER_MARK: &[u8; 3] = b"\xEF\xBB\xBF";

/// True if the head of a file declares that each byte is a character.
fn is_latin(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head).to_ascii_lowercase();
    let declaration = text.split("?>").next().unwrap_or_default();
    let encoding = declaration.split_once("encoding=").map(|(_, rest)| rest.trim_start_matches(['"', '\'']));
    let names = ["iso-8859-1", "iso8859-1", "latin-1", "latin1", "windows-1252", "cp1252"];
    encoding.is_some_and(|encoding| names.iter().any(|name| encoding.starts_with(name)))
}

/// A file read in order, as UTF-8.
struct Stream<'a> {
    source: &'a Source,
    at: u64,
    /// For files each byte of which is a character.
    latin: Option<Latin>,
}

/// Characters that take two bytes as UTF-8.
struct Latin {
    /// Their second bytes, by their places in what was given.
    widened: Rc<RefCell<Vec<u64>>>,
    /// Bytes given so far.
    given: u64,
}

impl Read for Stream<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        // Each byte may become two.
        let room = if self.latin.is_some() { bytes.len() / 2 } else { bytes.len() };
        let count = (room as u64).min(self.source.len().saturating_sub(self.at)) as usize;
        self.source.read_at(self.at, &mut bytes[..count]).map_err(std::io::Error::other)?;
        self.at += count as u64;
        let Some(latin) = &mut self.latin else { return Ok(count) };
        let text: String = bytes[..count].iter().map(|&byte| char::from(byte)).collect();
        let second = |(place, byte): (usize, u8)| (byte & 0xc0 == 0x80).then_some(latin.given + place as u64);
        latin.widened.borrow_mut().extend(text.bytes().enumerate().filter_map(second));
        latin.given += text.len() as u64;
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Ok(text.len())
    }
}
