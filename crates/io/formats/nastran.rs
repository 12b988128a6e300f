//! Bulk data of Nastran (.bdf, .nas, .dat) as a mesh: grid points and solid elements, by property (PID) as blocks. They hold no arrays.
//!
//! Source: MSC Nastran quick reference guide, "Bulk data entries": GRID, CTETRA, CPYRAM, CPENTA, CHEXA in the free, small (eight columns)
//! and large (sixteen) field format; CORD1R, CORD1C, CORD1S, CORD2R, CORD2C, CORD2S. Nodes on the vertical edges of prisms and hexahedra stand before those of the upper
//! face, and in VTK after them.

use super::contents::Dataset;
use super::cursor::Cursor;
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset};
use glam::{DMat3, DVec3};
use std::collections::{HashMap, HashSet};
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

    /// The point of a GRID.
    fn point(&self) -> Result<SystemPoint> {
        let system = if self.field(1).is_empty() { 0 } else { self.integer(1, "the system")? };
        Ok(SystemPoint { system, position: self.vector(2)?, line: self.line })
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

/// Entries that define systems of coordinates: by three nodes, or by three points; rectangular, cylindrical, spherical.
const SYSTEMS: [&str; 6] = ["CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S"];

/// A point in the coordinates of a system.
struct SystemPoint {
    system: u64,
    position: DVec3,
    line: usize,
}

/// A system of coordinates that an entry defines by its origin, a point on its z axis, and one in its xz plane.
struct SystemEntry {
    /// Last letter of the entry's name.
    kind: char,
    line: usize,
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

/// The systems of a file by their numbers.
#[derive(Default)]
struct SystemEntries(HashMap<u64, SystemEntry>);

impl SystemEntries {
    fn add(&mut self, entry: &BulkEntry) -> Result<()> {
        let kind = entry.name.chars().last().unwrap_or('R');
        let mut define = |first: usize, points: DefiningPoints| {
            let number = entry.integer(first, "the number")?;
            let own = SystemEntry { kind, line: entry.line, points };
            if number == 0 || self.0.insert(number, own).is_some() {
                let error = Error::run("the number of a system of coordinates is taken").got(number);
                return Err(error.expected("each number once, and none 0").at_line(entry.line));
            }
            Ok(())
        };
        if entry.name.starts_with("CORD2") {
            let system = if entry.field(1).is_empty() { 0 } else { entry.integer(1, "the system")? };
            let points = [entry.vector(2)?, entry.vector(5)?, entry.vector(8)?];
            return define(0, DefiningPoints::Placed { system, points });
        }
        // Two systems stand in one entry.
        for first in [0, 4].into_iter().filter(|&first| first == 0 || !entry.field(first).is_empty()) {
            let node = |place: usize| entry.integer(first + place, "a node");
            define(first, DefiningPoints::Nodes([node(1)?, node(2)?, node(3)?]))?;
        }
        Ok(())
    }

    /// Nodes that define systems.
    fn nodes(&self) -> HashSet<u64> {
        let of_entry = |entry: &SystemEntry| match entry.points {
            DefiningPoints::Nodes(nodes) => nodes.to_vec(),
            DefiningPoints::Placed { .. } => Vec::new(),
        };
        self.0.values().flat_map(of_entry).collect()
    }

    /// Adds the system of a point, and those by which it is defined, to those that are resolved.
    fn resolve(
        &self,
        point: &SystemPoint,
        nodes: &HashMap<u64, SystemPoint>,
        resolved: &mut HashMap<u64, CoordinateSystem>,
    ) -> Result<()> {
        let mut open = vec![(point.system, point.line)];
        let mut begun = HashSet::new();
        while let Some(&(number, line)) = open.last() {
            if resolved.contains_key(&number) {
                open.pop();
                continue;
            }
            let entry = self.0.get(&number).ok_or_else(|| {
                let error = Error::run("a system of coordinates is not defined").got(number).at_line(line);
                error.expected("CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S with this number")
            })?;
            let points = entry.points(nodes)?;
            let missing: Vec<u64> =
                points.iter().map(|own| own.0).filter(|system| !resolved.contains_key(system)).collect();
            if missing.is_empty() {
                let points = points.map(|(system, position)| resolved[&system].basic(position.to_array()));
                resolved.insert(number, entry.system(points)?);
            } else if begun.insert(number) {
                open.extend(missing.into_iter().map(|system| (system, entry.line)));
            } else {
                let error = Error::run("systems of coordinates are defined by each other").got(number);
                return Err(error.expected("a system that leads to the basic one").at_line(entry.line));
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
                        error.got(own[place]).expected("the number of a GRID").at_line(self.line)
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
            let error = Error::run("the points of a system of coordinates lie on a line").at_line(self.line);
            return Err(error
                .got(format_args!("{origin}, {on_z}, {in_xz}"))
                .expected("three points of a plane"));
        }
        let y = y.normalize();
        Ok(CoordinateSystem { kind: self.kind, origin, axes: DMat3::from_cols(y.cross(z), y, z) })
    }
}

impl TaggedMesh for NastranMesh {
    /// Points of the basic system first.
    fn each_node(&self, visit: VisitNode) -> Result<()> {
        let mut systems = SystemEntries::default();
        let mut others = Vec::new();
        let names: Vec<&str> = ["GRID", "GRDSET"].into_iter().chain(SYSTEMS).collect();
        each_entry(&self.0, &names, &mut |entry| match entry.name.as_str() {
            "GRID" => {
                let point = entry.point()?;
                match point.system {
                    0 => visit(entry.integer(0, "the number")?, point.position),
                    _ => {
                        others.push((entry.integer(0, "the number")?, point));
                        Ok(())
                    }
                }
            }
            "GRDSET" if !["", "0"].contains(&entry.field(1)) => {
                let error =
                    Error::run("a system of coordinates for all points is not read").at_line(entry.line);
                Err(error
                    .got(format_args!("GRDSET with the system {}", entry.field(1)))
                    .expected("GRID with the system"))
            }
            "GRDSET" => Ok(()),
            _ => systems.add(entry),
        })?;
        if others.is_empty() {
            return Ok(());
        }
        let nodes = systems.nodes();
        let mut known = HashMap::new();
        if !nodes.is_empty() {
            each_entry(&self.0, &["GRID"], &mut |entry| {
                let tag = entry.integer(0, "the number")?;
                if nodes.contains(&tag) {
                    known.insert(tag, entry.point()?);
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
