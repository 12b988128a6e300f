//! Meshes of SU2 (.su2), as text: elements and points, maybe of several zones, which are blocks. Their arrays are in files of their own.
//!
//! Source: SU2 documentation, "Mesh File". Elements have VTK's type codes and order of nodes; a line may end with its own number.

mod solution;

use self::solution::Solution;
use super::contents::Dataset;
use super::cursor::Cursor;
use super::numbers::{self, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{
    PART_SHIFT, TaggedElement, TaggedMesh, VisitElement, VisitNode, VisitValues, dataset, number_in_part,
};
use super::text::{TextRange, is_space};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::{Association, CellType, code};
use voltet_core::{Error, Result};

pub(super) const FORMAT: Format = Format { files: "a mesh of SU2 (.su2)", matches, open, has_solution: true };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let is_named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("su2"));
    let mut lines = head.split(|&byte| byte == b'\n').map(|line| words(line).collect::<Vec<_>>().concat());
    let first = lines.find(|line| !line.is_empty()).unwrap_or_default().to_ascii_uppercase();
    is_named || [&b"NDIME="[..], b"NZONE="].iter().any(|key| first.starts_with(key))
}

struct Zone {
    name: String,
    elements: (TextRange, u64),
    points: (TextRange, u64),
}

struct Su2Mesh {
    zones: Vec<Zone>,
    solution: Option<Solution>,
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mut cursor = Cursor::new(&source);
    let empty = || (TextRange::new(&source, 0..0), 0);
    let mut zones: Vec<Zone> = Vec::new();
    let mut zone_name = String::new();
    let mut lines_to_skip = 0;
    while let Some(line) = cursor.line()? {
        let line = String::from_utf8_lossy(line).into_owned();
        let text = line.split('%').next().unwrap_or_default();
        let Some((key, value)) = text.split_once('=').filter(|_| lines_to_skip == 0) else {
            lines_to_skip -= u64::from(lines_to_skip > 0 && !text.trim().is_empty());
            continue;
        };
        let value = value.trim().split_ascii_whitespace().next().unwrap_or_default();
        let key = key.trim().to_ascii_uppercase();
        let wrong = |accepted: &str| {
            cursor.error(format!("{key} is damaged")).got(format_args!("'{value}'")).expected(accepted)
        };
        let count = || value.parse::<u64>().map_err(|_| wrong("a number"));
        match key.as_str() {
            "NDIME" if value != "3" => {
                return Err(cursor.error("the mesh is flat").got(value).expected("NDIME= 3"));
            }
            "IZONE" => zone_name = format!("zone {value}"),
            "NELEM" | "NPOIN" => {
                let count = count()?;
                let has_words = |line: &[u8]| words(line).next().is_some();
                let part = cursor.skip_rows(count, has_words, &format!("{count} rows of numbers"))?;
                let is_new = zones.last().is_none_or(|zone| zone.name != zone_name);
                if is_new {
                    zones.push(Zone { name: zone_name.clone(), elements: empty(), points: empty() });
                }
                if let Some(zone) = zones.last_mut() {
                    if key == "NELEM" { zone.elements = (part, count) } else { zone.points = (part, count) }
                }
            }
            "MARKER_ELEMS" => lines_to_skip = count()?,
            _ => {}
        }
    }
    let Some(path) = &request.solution else {
        return dataset(&source, "SU2".to_owned(), Su2Mesh { zones, solution: None }, Vec::new(), request);
    };
    let [Zone { points: (_, point_count), .. }] = zones[..] else {
        let error = Error::run("a solution is of one zone").got(format_args!("{} zones", zones.len()));
        return Err(error.expected("a mesh of one zone, or no solution"));
    };
    let (solution, arrays) = Solution::open(path, point_count).map_err(|error| error.in_file(path))?;
    let bytes = solution.bytes();
    let mesh = Su2Mesh { zones, solution: Some(solution) };
    let mut dataset = dataset(&source, "SU2, with a solution".to_owned(), mesh, arrays, request)?;
    dataset.file_bytes += bytes;
    Ok(dataset)
}

/// Words of a line before its comment.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = line.split(|&byte| byte == b'%').next().unwrap_or_default();
    text.split(|&byte| is_space(byte)).filter(|word| !word.is_empty())
}

fn number(word: &[u8]) -> Result<f64> {
    numbers::parse(NumberType::F64, word)
}

struct Su2Element {
    code: u8,
    nodes: [u64; 8],
    node_count: usize,
    /// Number of the elements before it in its piece.
    place: u64,
}

/// Elements of a piece: those with a volume, and the number of all.
#[derive(Default)]
struct Su2Elements {
    volumes: Vec<Su2Element>,
    count: u64,
}

impl Su2Elements {
    fn add(&mut self, line: &[u8]) -> Result<()> {
        let mut words = words(line);
        let Some(first) = words.next() else { return Ok(()) };
        let type_number = number(first)?;
        let code = type_number as u8;
        let kind = CellType::from_code(code).filter(|_| f64::from(code) == type_number);
        let mut nodes = [0; 8];
        let node_count = kind.and_then(|kind| kind.point_count).map_or(0, usize::from);
        let damaged = || {
            let error = Error::run("an element is damaged");
            let found = String::from_utf8_lossy(line);
            error.got(format_args!("'{found}'")).expected("a type (10, 12, 13 or 14) and its points")
        };
        let kind = kind.filter(|_| node_count > 0).ok_or_else(damaged)?;
        self.count += 1;
        if kind.dimension == 3
            && !matches!(code, code::TETRA | code::HEXAHEDRON | code::WEDGE | code::PYRAMID)
        {
            return Err(Error::run("an element of this type is not read").got(kind.name));
        }
        for place in 0..node_count {
            let node = number(words.next().ok_or_else(damaged)?)?;
            if !(0.0..MAX_POINT).contains(&node) || node.fract() != 0.0 {
                let error = Error::run("the number of a point is damaged").got(node);
                return Err(error.expected("a whole number from 0"));
            }
            if let Some(own) = nodes.get_mut(place) {
                *own = node as u64;
            }
        }
        if kind.dimension == 3 {
            self.volumes.push(Su2Element { code, nodes, node_count, place: self.count - 1 });
        }
        Ok(())
    }
}

/// Numbers of points are below this.
const MAX_POINT: f64 = (1_u64 << PART_SHIFT) as f64;

fn tag(zone: usize, point: u64) -> u64 {
    (zone as u64) << PART_SHIFT | point
}

impl TaggedMesh for Su2Mesh {
    fn own_number(&self, tag: u64) -> u64 {
        number_in_part(tag)
    }

    fn count_nodes(&self) -> Result<u64> {
        Ok(self.zones.iter().map(|zone| zone.points.1).fold(0, u64::saturating_add))
    }

    fn each_node(&self, visit: VisitNode) -> Result<()> {
        for (zone, (points, count)) in self.zones.iter().map(|own| &own.points).enumerate() {
            let parse = |line: &[u8], points: &mut Vec<DVec3>| {
                let mut words = words(line);
                let Some(first) = words.next() else { return Ok(()) };
                let mut point = DVec3::new(number(first)?, 0.0, 0.0);
                for axis in 1..3 {
                    let word = words.next();
                    let missing = || Error::run("a point is damaged").expected("three coordinates");
                    point[axis] = number(word.ok_or_else(missing)?)?;
                }
                points.push(point);
                Ok(())
            };
            let mut number = 0;
            points.rows(parse, |point| {
                number += 1;
                visit(tag(zone, number - 1), point)
            })?;
            all_there(number, *count, "points")?;
        }
        Ok(())
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        for (zone, own) in self.zones.iter().enumerate() {
            let mut first = 0;
            own.elements.0.lines(
                |line, elements: &mut Su2Elements| elements.add(line),
                |elements| {
                    for Su2Element { code, mut nodes, node_count, place } in elements.volumes {
                        nodes.iter_mut().for_each(|node| *node = tag(zone, *node));
                        let (tag, nodes) = (tag(zone, first + place), &nodes[..node_count]);
                        visit(&TaggedElement { tag, code, block: &own.name, nodes })?;
                    }
                    first += elements.count;
                    Ok(())
                },
            )?;
            all_there(first, own.elements.1, "elements")?;
        }
        Ok(())
    }

    fn each_row(&self, _: Association, columns: &[usize], visit: VisitValues) -> Result<()> {
        let each = |solution: &Solution| {
            solution.each_row(columns, visit).map_err(|error| error.in_file(solution.path()))
        };
        self.solution.as_ref().map_or(Ok(()), each)
    }
}

/// Errors: the file ends before all rows of a table.
fn all_there(found: u64, count: u64, what: &str) -> Result<()> {
    match found == count {
        true => Ok(()),
        false => Err(Error::run("the file ends early").got(found).expected(format_args!("{count} {what}"))),
    }
}
