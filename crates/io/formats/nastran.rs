//! Bulk data of Nastran (.bdf, .nas, .dat) as a mesh: grid points and solid elements, by property (PID) as blocks. They hold no arrays.
//!
//! Source: MSC Nastran quick reference guide, "Bulk data entries": GRID, CTETRA, CPYRAM, CPENTA, CHEXA in the free, small (eight columns)
//! and large (sixteen) field format. Nodes on the vertical edges of prisms and hexahedra stand before those of the upper
//! face, and in VTK after them.

use super::contents::Dataset;
use super::cursor::Cursor;
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset};
use glam::DVec3;
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

/// An entry: its name, its fields after the name, and its first line.
struct BulkEntry {
    name: String,
    fields: Vec<String>,
    line: usize,
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

/// Name and fields of a line; a name that is empty continues the entry before.
fn fields(line: &str) -> (String, Vec<String>) {
    let line = line.split('$').next().unwrap_or_default();
    let is_large = |name: &str| name.contains('*');
    let clean = |field: &str| field.trim().to_owned();
    if line.contains(',') {
        let mut words = line.split(',').map(clean);
        let name = words.next().unwrap_or_default();
        let count = if is_large(&name) { 4 } else { 8 };
        let mut fields: Vec<String> = words.take(count).collect();
        fields.resize(count, String::new());
        return (name, fields);
    }
    let line = with_tab_stops(line);
    let part = |from: usize, to: usize| {
        clean(&line.get(from.min(line.len())..to.min(line.len())).unwrap_or(&[]).iter().collect::<String>())
    };
    let name = part(0, 8);
    let width = if is_large(&name) { 16 } else { 8 };
    let fields = (0..64 / width).map(|field| part(8 + field * width, 8 + (field + 1) * width)).collect();
    (name, fields)
}

/// Hands out the entries of these names.
fn each_entry(
    source: &Arc<Source>,
    names: &[&str],
    visit: &mut dyn FnMut(&BulkEntry) -> Result<()>,
) -> Result<()> {
    let mut cursor = Cursor::new(source);
    let mut entry: Option<BulkEntry> = None;
    while let Some(line) = cursor.line()? {
        let line = String::from_utf8_lossy(line).into_owned();
        if line.starts_with('$') || line.trim().is_empty() {
            continue;
        }
        if line.trim_start().get(..7).is_some_and(|word| word.eq_ignore_ascii_case("INCLUDE")) {
            let error = cursor.error("files that a file includes are not read").got(format_args!("'{line}'"));
            return Err(error.expected("all entries in this file"));
        }
        let (name, fields) = fields(&line);
        if name.is_empty() || name.starts_with(['+', '*']) {
            if let Some(entry) = &mut entry {
                entry.fields.extend(fields);
            }
            continue;
        }
        if let Some(complete) = entry.take() {
            visit(&complete)?;
        }
        let mut name = name.trim_end_matches(['*', '_']).to_ascii_uppercase();
        // OptiStruct's.
        if name == "CPYRA" {
            name.push('M');
        }
        if name == "ENDDATA" {
            return Ok(());
        }
        if names.contains(&name.as_str()) {
            entry = Some(BulkEntry { name, fields, line: cursor.last_line() });
        }
    }
    entry.map_or(Ok(()), |complete| visit(&complete))
}

impl BulkEntry {
    fn error(&self, what: &str, field: &str) -> Error {
        let error =
            Error::run(format!("{} of a {} is damaged", what, self.name)).got(format_args!("'{field}'"));
        error.expected("a number").at_line(self.line)
    }

    fn field(&self, place: usize) -> &str {
        self.fields.get(place).map_or("", String::as_str)
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

impl TaggedMesh for NastranMesh {
    fn each_node(&self, visit: VisitNode) -> Result<()> {
        each_entry(&self.0, &["GRID"], &mut |entry| {
            let system = entry.field(1);
            if !["", "0"].contains(&system) {
                let error =
                    Error::run("coordinates of a system of their own are not read").at_line(entry.line);
                return Err(error
                    .got(format_args!("GRID in the system {system}"))
                    .expected("the basic system, 0"));
            }
            let mut position = DVec3::ZERO;
            for axis in 0..3 {
                position[axis] = entry.real(2 + axis, "a coordinate")?;
            }
            visit(entry.integer(0, "the number")?, position)
        })
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        let mut nodes = Vec::new();
        each_entry(&self.0, &ELEMENTS.map(|element| element.0), &mut |entry| {
            let Some((_, corners, codes, order)) = ELEMENTS.iter().find(|element| element.0 == entry.name)
            else {
                return Ok(());
            };
            let on_edges =
                order[*corners..].iter().filter(|&&place| !entry.field(2 + place).is_empty()).count();
            let is_quadratic = on_edges == order.len() - corners;
            if on_edges > 0 && !is_quadratic {
                let error = Error::run(format!("a {} has nodes on some of its edges alone", entry.name));
                return Err(error.got(on_edges).expected(order.len() - corners).at_line(entry.line));
            }
            nodes.clear();
            for &place in if is_quadratic { order } else { &order[..*corners] } {
                nodes.push(entry.integer(2 + place, "a node")?);
            }
            let tag = entry.integer(0, "the number")?;
            visit(&TaggedElement {
                tag,
                code: codes[usize::from(is_quadratic)],
                block: entry.field(1),
                nodes: &nodes,
            })
        })
    }
}
