//! Bulk data of Nastran (.bdf, .nas, .dat) as a mesh: grid points and solid elements, by property (PID) as blocks. They hold no arrays.
//!
//! Source: MSC Nastran quick reference guide, "Bulk data entries": GRID, CTETRA, CPYRAM, CPENTA, CHEXA in the free, small (eight columns)
//! and large (sixteen) field format. Nodes on the vertical edges of prisms and hexahedra stand before those of the upper
//! face, and in VTK after them.

use super::contents::Dataset;
use super::numbers::{self, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset};
use super::text::{TextPiece, TextRange};
use glam::DVec3;
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::code;
use voltet_core::{Error, Result};

/// The declaration.
pub(super) const FORMAT: Format =
    Format { files: "bulk data of Nastran (.bdf, .nas)", matches, open, has_solution: false };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let text = String::from_utf8_lossy(head).to_ascii_uppercase();
    let has = |words: &[&str]| {
        text.lines().any(|line| words.iter().any(|word| line.trim_start().starts_with(word)))
    };
    ["bdf", "nas", "fem"].iter().any(|name| ending == *name)
        || has(&["BEGIN BULK", "GRID  ", "GRID,", "GRID*"])
}

/// Elements: corners, their code and that with nodes on edges, and the order of these.
const ELEMENTS: [(&str, usize, [u8; 2], &[usize]); 4] = [
    ("CTETRA", 4, [code::TETRA, code::QUADRATIC_TETRA], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]),
    ("CPYRAM", 5, [code::PYRAMID, code::QUADRATIC_PYRAMID], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]),
    ("CPENTA", 6, [code::WEDGE, code::QUADRATIC_WEDGE], &[0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11]),
    (
        "CHEXA",
        8,
        [code::HEXAHEDRON, code::QUADRATIC_HEXAHEDRON],
        &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 19, 12, 13, 14, 15],
    ),
];

struct NastranMesh(Arc<Source>);

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mesh = NastranMesh(source.clone());
    dataset(&source, "Nastran bulk data".to_owned(), mesh, Vec::new(), request)
}

/// An entry: its name, and its fields after the name.
struct BulkEntry {
    name: String,
    fields: Fields,
}

/// Texts of fields, one after the other, and their ends.
struct Fields {
    text: String,
    ends: Vec<usize>,
}

impl Fields {
    fn push(&mut self, field: &str) {
        self.text.push_str(field.trim());
        self.ends.push(self.text.len());
    }

    fn get(&self, place: usize) -> &str {
        let begin = place.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        self.ends.get(place).and_then(|&end| self.text.get(begin..end)).unwrap_or_default()
    }
}

/// Characters of a line in which a tab reaches the next column of eight.
fn with_tab_stops(line: &str) -> Vec<char> {
    let mut columns = Vec::new();
    for letter in line.chars() {
        match letter {
            '\t' => columns.resize((columns.len() / 8 + 1) * 8, ' '),
            letter => columns.push(letter),
        }
    }
    columns
}

/// Width of the fields of an entry, and their number in a line.
fn field_width(name: &str) -> (usize, usize) {
    if name.contains('*') { (16, 4) } else { (8, 8) }
}

/// Name of a line; an empty one continues the entry before.
fn name_of(line: &str) -> Cow<'_, str> {
    if let Some((name, _)) = line.split_once(',') {
        return Cow::Borrowed(name.trim());
    }
    match line.is_ascii() && !line.contains('\t') {
        true => Cow::Borrowed(line[..line.len().min(8)].trim()),
        false => with_tab_stops(line).iter().take(8).collect::<String>().trim().to_owned().into(),
    }
}

/// Adds the fields of a line of this name.
fn add_fields(line: &str, name: &str, fields: &mut Fields) {
    let (width, count) = field_width(name);
    if let Some((_, rest)) = line.split_once(',') {
        let mut words = rest.split(',');
        (0..count).for_each(|_| fields.push(words.next().unwrap_or_default()));
    } else if line.is_ascii() && !line.contains('\t') {
        for begin in (0..count).map(|field| 8 + field * width) {
            fields.push(&line[begin.min(line.len())..(begin + width).min(line.len())]);
        }
    } else {
        let columns = with_tab_stops(line);
        for begin in (0..count).map(|field| 8 + field * width) {
            fields.push(&columns.iter().skip(begin).take(width).collect::<String>());
        }
    }
}

/// True where a line ends and the next begins an entry: one that goes on has a sign, a comma, or blanks as its first eight letters.
fn is_end_of_entry(rest: &[u8]) -> bool {
    let next = || rest[1..rest.len().min(9)].iter().find(|byte| !b" \t".contains(byte));
    rest[0] == b'\n' && next().is_some_and(u8::is_ascii_alphabetic)
}

/// Results of a piece, and true if its data end in it.
type EntryResults<R> = (Vec<R>, bool);

/// Parses the entries of these names side by side; `take` gets what they give, in order.
fn each_entry<R: Send>(
    source: &Arc<Source>,
    names: &[&str],
    parse: impl Fn(&BulkEntry) -> Result<R> + Sync,
    mut take: impl FnMut(R) -> Result<()>,
) -> Result<()> {
    let of_piece = |piece: &TextPiece| entries(piece, names, &parse);
    TextRange::new(source, 0..source.len()).each_piece(is_end_of_entry, of_piece, |(results, is_end)| {
        results.into_iter().try_for_each(&mut take).map(|()| !is_end)
    })
}

fn entries<R>(
    piece: &TextPiece,
    names: &[&str],
    parse: &impl Fn(&BulkEntry) -> Result<R>,
) -> Result<EntryResults<R>> {
    let mut results = Vec::new();
    // The entry with its first line.
    let mut open: Option<(BulkEntry, &[u8])> = None;
    for line in piece.lines() {
        let text = String::from_utf8_lossy(line);
        let data = text.split('$').next().unwrap_or_default();
        if data.trim().is_empty() {
            continue;
        }
        if data.trim_start().get(..7).is_some_and(|word| word.eq_ignore_ascii_case("INCLUDE")) {
            let error = Error::run("files that a file includes are not read").got(format_args!("'{text}'"));
            return Err(piece.locate(error.expected("all entries in this file"), line));
        }
        let own = name_of(data);
        if own.is_empty() || own.starts_with(['+', '*']) {
            if let Some((entry, _)) = &mut open {
                add_fields(data, &own, &mut entry.fields);
            }
            continue;
        }
        if let Some((complete, first)) = open.take() {
            results.push(parse(&complete).map_err(|error| piece.locate(error, first))?);
        }
        let mut name = own.trim_end_matches(['*', '_']).to_ascii_uppercase();
        // OptiStruct's.
        if name == "CPYRA" {
            name.push('M');
        }
        if name == "ENDDATA" {
            return Ok((results, true));
        }
        if names.contains(&name.as_str()) {
            let mut fields = Fields { text: String::with_capacity(64), ends: Vec::with_capacity(16) };
            add_fields(data, &own, &mut fields);
            open = Some((BulkEntry { name, fields }, line));
        }
    }
    if let Some((complete, first)) = open {
        results.push(parse(&complete).map_err(|error| piece.locate(error, first))?);
    }
    Ok((results, false))
}

impl BulkEntry {
    fn error(&self, what: &str, field: &str) -> Error {
        let error =
            Error::run(format!("{} of a {} is damaged", what, self.name)).got(format_args!("'{field}'"));
        error.expected("a number")
    }

    fn field(&self, place: usize) -> &str {
        self.fields.get(place)
    }

    fn integer(&self, place: usize, what: &str) -> Result<u64> {
        self.field(place).parse().map_err(|_| self.error(what, self.field(place)))
    }

    /// A real number, whose exponent may lack its letter: 1.5-3.
    fn real(&self, place: usize, what: &str) -> Result<f64> {
        let field = self.field(place);
        if field.is_empty() {
            return Ok(0.0);
        }
        if let Ok(number) = numbers::parse(NumberType::F64, field.as_bytes()) {
            return Ok(number);
        }
        let plain = field.to_ascii_lowercase().replace('d', "e");
        let sign = plain
            .char_indices()
            .skip(1)
            .find(|&(at, sign)| "+-".contains(sign) && !plain[..at].ends_with('e'));
        let text = match sign {
            Some((at, _)) => format!("{}e{}", &plain[..at], &plain[at..]),
            None => plain,
        };
        text.parse().map_err(|_| self.error(what, field))
    }
}

/// An element of the file.
struct BulkElement {
    tag: u64,
    code: u8,
    block: String,
    nodes: Vec<u64>,
}

impl TaggedMesh for NastranMesh {
    fn count_nodes(&self) -> Result<u64> {
        let mut count = 0;
        each_entry(
            &self.0,
            &["GRID"],
            |_| Ok(()),
            |()| {
                count += 1;
                Ok(())
            },
        )?;
        Ok(count)
    }

    fn each_node(&self, visit: VisitNode) -> Result<()> {
        let parse = |entry: &BulkEntry| {
            let system = entry.field(1);
            if !["", "0"].contains(&system) {
                let error = Error::run("coordinates of a system of their own are not read");
                return Err(error
                    .got(format_args!("GRID in the system {system}"))
                    .expected("the basic system, 0"));
            }
            let mut position = DVec3::ZERO;
            for axis in 0..3 {
                position[axis] = entry.real(2 + axis, "a coordinate")?;
            }
            Ok((entry.integer(0, "the number")?, position))
        };
        each_entry(&self.0, &["GRID"], parse, |(tag, position)| visit(tag, position))
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        let names = ELEMENTS.map(|element| element.0);
        each_entry(&self.0, &names, element, |BulkElement { tag, code, block, nodes }| {
            visit(&TaggedElement { tag, code, block: &block, nodes: &nodes })
        })
    }
}

/// The element of an entry.
fn element(entry: &BulkEntry) -> Result<BulkElement> {
    let Some((_, corners, codes, order)) = ELEMENTS.iter().find(|element| element.0 == entry.name) else {
        return Err(Error::run("an entry is no element").got(&entry.name));
    };
    let on_edges = order[*corners..].iter().filter(|&&place| !entry.field(2 + place).is_empty()).count();
    let is_quadratic = on_edges == order.len() - corners;
    if on_edges > 0 && !is_quadratic {
        let error = Error::run(format!("a {} has nodes on some of its edges alone", entry.name));
        return Err(error.got(on_edges).expected(order.len() - corners));
    }
    let places = if is_quadratic { order } else { &order[..*corners] };
    let nodes = places.iter().map(|&place| entry.integer(2 + place, "a node")).collect::<Result<_>>()?;
    Ok(BulkElement {
        tag: entry.integer(0, "the number")?,
        code: codes[usize::from(is_quadratic)],
        block: entry.field(1).to_owned(),
        nodes,
    })
}
