//! Bulk data of Nastran (.bdf, .nas, .dat) as a mesh: grid points and solid elements, by property (PID) as blocks. They hold no arrays.
//! Files that it includes are read as if they stood in it.
//!
//! Source: MSC Nastran quick reference guide, "Bulk data entries": GRID, CTETRA, CPYRAM, CPENTA, CHEXA in the free, small (eight columns)
//! and large (sixteen) field format; CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S. Nodes on the vertical edges of prisms and hexahedra stand before those of the upper
//! face, and in VTK after them.

mod deck;

use self::deck::Deck;
use super::contents::Dataset;
use super::named_files;
use super::node_orders::{HEXAHEDRON, IN_ORDER, WEDGE};
use super::numbers::{self, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset};
use super::text::{TextPiece, TextRange};
use glam::{DMat3, DVec3};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::code;
use voltet_core::{Error, Result};

pub(super) const FORMAT: Format =
    Format { files: "bulk data of Nastran (.bdf, .nas, .dat)", matches, open, has_solution: false };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let is_named = path.extension().is_some_and(is_ending);
    is_named || String::from_utf8_lossy(head).lines().any(|line| begins_bulk(line) || is_entry(line))
}

/// True for the endings of names of such files alone.
pub(super) fn is_ending(ending: &OsStr) -> bool {
    ["bdf", "nas", "fem"].iter().any(|own| ending.eq_ignore_ascii_case(own))
}

/// True for a line that ends the sections before the bulk data.
pub(super) fn begins_bulk(line: &str) -> bool {
    let statement = line.split('$').next().unwrap_or_default();
    let words: Vec<&str> = statement.split_ascii_whitespace().take(3).collect();
    match words[..] {
        [first] => first.eq_ignore_ascii_case("CEND"),
        [first, second, ..] => first.eq_ignore_ascii_case("BEGIN") && second.eq_ignore_ascii_case("BULK"),
        [] => false,
    }
}

/// True for a GRID or an element with its number.
fn is_entry(line: &str) -> bool {
    let line = line.trim_start();
    let place = line.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(line.len());
    let (name, fields) = line.split_at(place);
    let number = fields.trim_start_matches([',', '*', ' ', '\t']);
    let is_separated = [",", "*", "  ", "\t"].iter().any(|own| fields.starts_with(own));
    let mut names = ELEMENTS.iter().map(|element| element.0).chain(["GRID"]);
    names.any(|own| own.eq_ignore_ascii_case(name))
        && is_separated
        && number.starts_with(|first: char| first.is_ascii_digit())
}

/// Elements: corners, their code and that with nodes on edges, and the order of these.
const ELEMENTS: [(&str, usize, [u8; 2], &[u8]); 4] = [
    ("CTETRA", 4, [code::TETRA, code::QUADRATIC_TETRA], IN_ORDER.split_at(10).0),
    ("CPYRAM", 5, [code::PYRAMID, code::QUADRATIC_PYRAMID], IN_ORDER.split_at(13).0),
    ("CPENTA", 6, [code::WEDGE, code::QUADRATIC_WEDGE], WEDGE.split_at(15).0),
    ("CHEXA", 8, [code::HEXAHEDRON, code::QUADRATIC_HEXAHEDRON], HEXAHEDRON.split_at(20).0),
];

/// Parts of the files, in the order of their entries.
struct NastranMesh(Vec<TextRange>);

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mut deck = Deck::new(&source);
    deck.add(&source)?;
    let mesh = NastranMesh(deck.parts);
    let dataset = dataset(&source, "Nastran bulk data".to_owned(), mesh, Vec::new(), request)?;
    Ok(Dataset { file_bytes: deck.included.file_bytes, ..dataset })
}

/// The files that a file includes; none for other formats.
pub(super) fn files_named(path: &Path) -> Vec<PathBuf> {
    named_files::files_included(path, matches, |source| {
        let mut deck = Deck::new(source);
        (deck.add(source), deck.included)
    })
}

/// Number of a part of the files, and a place in its file.
type EntryPlace = (usize, u64);

/// An entry: its name, its fields after the name, and its place.
struct BulkEntry {
    name: String,
    fields: Fields,
    place: EntryPlace,
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

/// Parses the entries of these names side by side; `take` gets what they give, in order. Errors: a line behind an INCLUDE, or the first of
/// an included file, goes on with an entry, where some of these names came before: it may be one of those.
fn each_entry<R: Send>(
    parts: &[TextRange],
    names: &[&str],
    parse: impl Fn(&BulkEntry) -> Result<R> + Sync,
    mut take: impl FnMut(R) -> Result<()>,
) -> Result<()> {
    let mut has_entries = false;
    parts.iter().enumerate().try_for_each(|(part, range)| {
        let of_piece = |piece: &TextPiece| entries(piece, part, names, &parse);
        let read = range.each_piece(is_end_of_entry, of_piece, |Entries { continued, results }| {
            if let Some((place, line)) = continued.filter(|_| has_entries) {
                let error = Error::run("an entry goes on behind an INCLUDE").got(format_args!("'{line}'"));
                return Err(range.locate(error.expected("all lines of an entry side by side"), place));
            }
            has_entries |= !results.is_empty();
            results.into_iter().try_for_each(&mut take).map(|()| true)
        });
        read.map_err(|error| error.in_file(range.path()))
    })
}

struct Entries<R> {
    /// Place and text of a line that goes on with an entry before the piece.
    continued: Option<(u64, String)>,
    results: Vec<R>,
}

fn entries<R>(
    piece: &TextPiece,
    part: usize,
    names: &[&str],
    parse: &impl Fn(&BulkEntry) -> Result<R>,
) -> Result<Entries<R>> {
    let (mut results, mut continued, mut is_first) = (Vec::new(), None, true);
    // The entry with its first line.
    let mut open: Option<(BulkEntry, &[u8])> = None;
    for line in piece.lines() {
        let text = String::from_utf8_lossy(line);
        let data = text.split('$').next().unwrap_or_default();
        if data.trim().is_empty() {
            continue;
        }
        let own = name_of(data);
        if own.is_empty() || own.starts_with(['+', '*']) {
            if let Some((entry, _)) = &mut open {
                add_fields(data, &own, &mut entry.fields);
            } else if is_first {
                continued = Some((piece.place(line), data.trim().to_owned()));
            }
            is_first = false;
            continue;
        }
        is_first = false;
        if let Some((complete, first)) = open.take() {
            results.push(parse(&complete).map_err(|error| piece.locate(error, first))?);
        }
        let mut name = own.trim_end_matches(['*', '_']).to_ascii_uppercase();
        // OptiStruct's.
        if name == "CPYRA" {
            name.push('M');
        }
        if names.contains(&name.as_str()) {
            let mut fields = Fields { text: String::with_capacity(64), ends: Vec::with_capacity(16) };
            add_fields(data, &own, &mut fields);
            open = Some((BulkEntry { name, fields, place: (part, piece.place(line)) }, line));
        }
    }
    if let Some((complete, first)) = open {
        results.push(parse(&complete).map_err(|error| piece.locate(error, first))?);
    }
    Ok(Entries { continued, results })
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

    fn point(&self) -> Result<SystemPoint> {
        let system = if self.field(1).is_empty() { 0 } else { self.integer(1, "the system")? };
        Ok(SystemPoint { system, position: self.vector(2)?, place: self.place })
    }

    fn vector(&self, first: usize) -> Result<DVec3> {
        let axis = |axis: usize| self.real(first + axis, "a coordinate");
        Ok(DVec3::new(axis(0)?, axis(1)?, axis(2)?))
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

struct BulkElement {
    tag: u64,
    code: u8,
    block: String,
    nodes: Vec<u64>,
}

enum PlacingEntry {
    Node(u64, SystemPoint),
    Systems(Vec<(u64, SystemEntry)>),
    Nothing,
}

fn systems(entry: &BulkEntry) -> Result<Vec<(u64, SystemEntry)>> {
    let kind = entry.name.chars().last().unwrap_or('R');
    let define = |first: usize, points: DefiningPoints| {
        Ok((entry.integer(first, "the number")?, SystemEntry { kind, place: entry.place, points }))
    };
    if entry.name.starts_with("CORD2") {
        let system = if entry.field(1).is_empty() { 0 } else { entry.integer(1, "the system")? };
        let points = [entry.vector(2)?, entry.vector(5)?, entry.vector(8)?];
        return Ok(vec![define(0, DefiningPoints::Placed { system, points })?]);
    }
    // Two systems stand in one entry.
    let firsts = [0, 4].into_iter().filter(|&first| first == 0 || !entry.field(first).is_empty());
    let by_nodes = |first: usize| {
        let node = |place: usize| entry.integer(first + place, "a node");
        define(first, DefiningPoints::Nodes([node(1)?, node(2)?, node(3)?]))
    };
    firsts.map(by_nodes).collect()
}

fn placing(entry: &BulkEntry) -> Result<PlacingEntry> {
    match entry.name.as_str() {
        "GRID" => Ok(PlacingEntry::Node(entry.integer(0, "the number")?, entry.point()?)),
        "GRDSET" if !["", "0"].contains(&entry.field(1)) => {
            let error = Error::run("a system of coordinates for all points is not read");
            Err(error
                .got(format_args!("GRDSET with the system {}", entry.field(1)))
                .expected("GRID with the system"))
        }
        "GRDSET" => Ok(PlacingEntry::Nothing),
        _ => systems(entry).map(PlacingEntry::Systems),
    }
}

/// Entries that define systems of coordinates: by three nodes, or by three points; rectangular, cylindrical, spherical.
const SYSTEMS: [&str; 6] = ["CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S"];

struct SystemPoint {
    system: u64,
    position: DVec3,
    place: EntryPlace,
}

/// A system of coordinates that an entry defines by its origin, a point on its z axis, and one in its xz plane.
struct SystemEntry {
    /// Last letter of the entry's name.
    kind: char,
    place: EntryPlace,
    points: DefiningPoints,
}

enum DefiningPoints {
    Nodes([u64; 3]),
    Placed { system: u64, points: [DVec3; 3] },
}

/// A system of coordinates by its origin and axes in the basic one.
#[derive(Clone, Copy)]
struct CoordinateSystem {
    kind: char,
    origin: DVec3,
    axes: DMat3,
}

impl Default for CoordinateSystem {
    fn default() -> Self {
        CoordinateSystem { kind: 'R', origin: DVec3::ZERO, axes: DMat3::IDENTITY }
    }
}

impl CoordinateSystem {
    /// Position in the basic system of coordinates of this one; angles are in degrees.
    fn basic(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        let (second, third) = (b.to_radians(), c.to_radians());
        let own = match self.kind {
            'C' => DVec3::new(a * second.cos(), a * second.sin(), c),
            // The angle from the z axis, then that round it.
            'S' => a * DVec3::new(second.sin() * third.cos(), second.sin() * third.sin(), second.cos()),
            _ => DVec3::new(a, b, c),
        };
        self.origin + self.axes * own
    }
}

struct SystemEntries<'a> {
    parts: &'a [TextRange],
    entries: HashMap<u64, SystemEntry>,
}

impl SystemEntries<'_> {
    fn locate(&self, error: Error, (part, place): EntryPlace) -> Error {
        let file = &self.parts[part];
        file.locate(error, place).in_file(file.path())
    }

    fn add(&mut self, number: u64, entry: SystemEntry) -> Result<()> {
        let place = entry.place;
        if number == 0 || self.entries.insert(number, entry).is_some() {
            let error = Error::run("the number of a system of coordinates is taken").got(number);
            return Err(self.locate(error.expected("each number once, and none 0"), place));
        }
        Ok(())
    }

    fn nodes(&self) -> HashSet<u64> {
        let of_entry = |entry: &SystemEntry| match entry.points {
            DefiningPoints::Nodes(nodes) => nodes.to_vec(),
            DefiningPoints::Placed { .. } => Vec::new(),
        };
        self.entries.values().flat_map(of_entry).collect()
    }

    /// Adds the system of a point, and those by which it is defined, to those that are resolved.
    fn resolve(
        &self,
        point: &SystemPoint,
        nodes: &HashMap<u64, SystemPoint>,
        resolved: &mut HashMap<u64, CoordinateSystem>,
    ) -> Result<()> {
        let mut open = vec![(point.system, point.place)];
        let mut begun = HashSet::new();
        while let Some(&(number, place)) = open.last() {
            if resolved.contains_key(&number) {
                open.pop();
                continue;
            }
            let entry = self.entries.get(&number).ok_or_else(|| {
                let error = Error::run("a system of coordinates is not defined").got(number);
                let expected = "CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S with this number";
                self.locate(error.expected(expected), place)
            })?;
            let located = |error| self.locate(error, entry.place);
            let points = entry.points(nodes).map_err(located)?;
            let missing: Vec<u64> =
                points.iter().map(|own| own.0).filter(|system| !resolved.contains_key(system)).collect();
            if missing.is_empty() {
                let points = points.map(|(system, position)| resolved[&system].basic(position.to_array()));
                resolved.insert(number, entry.system(points).map_err(located)?);
            } else if begun.insert(number) {
                open.extend(missing.into_iter().map(|system| (system, entry.place)));
            } else {
                let error = Error::run("systems of coordinates are defined by each other").got(number);
                return Err(located(error.expected("a system that leads to the basic one")));
            }
        }
        Ok(())
    }
}

impl SystemEntry {
    /// The points that define it, each with the number of the system of its coordinates.
    fn points(&self, nodes: &HashMap<u64, SystemPoint>) -> Result<[(u64, DVec3); 3]> {
        let mut all = [(0, DVec3::ZERO); 3];
        for place in 0..3 {
            all[place] = match &self.points {
                DefiningPoints::Placed { system, points } => (*system, points[place]),
                DefiningPoints::Nodes(own) => {
                    let node = nodes.get(&own[place]).ok_or_else(|| {
                        let error = Error::run("a system of coordinates names a node that does not exist");
                        error.got(own[place]).expected("the number of a GRID")
                    })?;
                    (node.system, node.position)
                }
            };
        }
        Ok(all)
    }

    /// The system by its points in the basic one.
    fn system(&self, [origin, on_z, in_xz]: [DVec3; 3]) -> Result<CoordinateSystem> {
        let z = (on_z - origin).normalize_or_zero();
        let y = z.cross((in_xz - origin).normalize_or_zero());
        // Directions of unit length: rounding of a right angle's sine.
        if y.length() < 1e-12 {
            let error = Error::run("the points of a system of coordinates lie on a line");
            return Err(error
                .got(format_args!("{origin}, {on_z}, {in_xz}"))
                .expected("three points of a plane"));
        }
        let y = y.normalize();
        Ok(CoordinateSystem { kind: self.kind, origin, axes: DMat3::from_cols(y.cross(z), y, z) })
    }
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

    /// Points of the basic system first.
    fn each_node(&self, visit: VisitNode) -> Result<()> {
        let mut systems = SystemEntries { parts: &self.0, entries: HashMap::new() };
        let mut others = Vec::new();
        let names: Vec<&str> = ["GRID", "GRDSET"].into_iter().chain(SYSTEMS).collect();
        each_entry(&self.0, &names, placing, |entry| match entry {
            PlacingEntry::Node(tag, point) if point.system == 0 => visit(tag, point.position),
            PlacingEntry::Node(tag, point) => {
                others.push((tag, point));
                Ok(())
            }
            PlacingEntry::Systems(all) => {
                all.into_iter().try_for_each(|(number, entry)| systems.add(number, entry))
            }
            PlacingEntry::Nothing => Ok(()),
        })?;
        if others.is_empty() {
            return Ok(());
        }
        let nodes = systems.nodes();
        let mut known = HashMap::new();
        if !nodes.is_empty() {
            let parse = |entry: &BulkEntry| Ok((entry.integer(0, "the number")?, entry.point()?));
            each_entry(&self.0, &["GRID"], parse, |(tag, point)| {
                if nodes.contains(&tag) {
                    known.insert(tag, point);
                }
                Ok(())
            })?;
        }
        let mut resolved = HashMap::from([(0, CoordinateSystem::default())]);
        for (tag, point) in others {
            systems.resolve(&point, &known, &mut resolved)?;
            visit(tag, resolved[&point.system].basic(point.position.to_array()))?;
        }
        Ok(())
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        let names = ELEMENTS.map(|element| element.0);
        each_entry(&self.0, &names, element, |BulkElement { tag, code, block, nodes }| {
            visit(&TaggedElement { tag, code, block: &block, nodes: &nodes })
        })
    }
}

fn element(entry: &BulkEntry) -> Result<BulkElement> {
    let Some((_, corners, codes, order)) = ELEMENTS.iter().find(|element| element.0 == entry.name) else {
        return Err(Error::run("an entry is no element").got(&entry.name));
    };
    // The nodes of some edges alone are further ones of the linear cell.
    let is_there = |place: &usize| place < corners || !["", "0"].contains(&entry.field(2 + place));
    let places = order.iter().map(|&place| usize::from(place)).filter(is_there);
    let nodes = places.map(|place| entry.integer(2 + place, "a node")).collect::<Result<Vec<_>>>()?;
    let is_quadratic = nodes.len() == order.len();
    Ok(BulkElement {
        tag: entry.integer(0, "the number")?,
        code: codes[usize::from(is_quadratic)],
        block: entry.field(1).to_owned(),
        nodes,
    })
}
