//! Meshes of SU2 (.su2), as text: elements and points, maybe of several zones, which are blocks. They hold no arrays.
//!
//! Source: SU2 documentation, "Mesh File". Elements have VTK's type codes and order of nodes; a line may end with its own number.

use super::contents::Dataset;
use super::cursor::Cursor;
use super::numbers::{self, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{
    PART_SHIFT, TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset, number_in_part,
};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::{CellType, code};

/// The declaration.
pub(super) const FORMAT: Format =
    Format { files: "a mesh of SU2 (.su2)", matches, open, has_solution: false };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("su2")) || head.starts_with(b"NDIME=")
}

/// Points and elements of one zone.
struct Zone {
    name: String,
    elements: (Cursor, u64),
    points: (Cursor, u64),
}

struct Su2Mesh(Vec<Zone>);

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mut cursor = Cursor::new(&source);
    let empty = || (Cursor::within(&source, 0, 0, 1), 0);
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
                let (count, part) = (count()?, cursor.clone());
                let is_new = zones.last().is_none_or(|zone| zone.name != zone_name);
                if is_new {
                    zones.push(Zone { name: zone_name.clone(), elements: empty(), points: empty() });
                }
                if let Some(zone) = zones.last_mut() {
                    if key == "NELEM" { zone.elements = (part, count) } else { zone.points = (part, count) }
                }
                lines_to_skip = count;
            }
            "MARKER_ELEMS" => lines_to_skip = count()?,
            _ => {}
        }
    }
    dataset(&source, "SU2".to_owned(), Su2Mesh(zones), Vec::new(), request)
}

/// The numbers of the next line that has some.
fn row(cursor: &mut Cursor, what: &str) -> Result<Vec<f64>> {
    loop {
        let line = cursor.text_line(what)?;
        let text = line.split('%').next().unwrap_or_default();
        if !text.trim().is_empty() {
            let numbers = numbers::numbers(NumberType::F64, text.as_bytes());
            return numbers.map_err(|error| error.at_line(cursor.last_line()));
        }
    }
}

/// Numbers of points are below this.
const MAX_POINT: f64 = (1_u64 << PART_SHIFT) as f64;

/// Number of a point among those of all zones.
fn tag(zone: usize, point: u64) -> u64 {
    (zone as u64) << PART_SHIFT | point
}

impl TaggedMesh for Su2Mesh {
    fn own_number(&self, tag: u64) -> u64 {
        number_in_part(tag)
    }

    fn each_node(&self, visit: VisitNode) -> Result<()> {
        for (zone, own) in self.0.iter().enumerate() {
            let (mut cursor, count) = own.points.clone();
            for point in 0..count {
                let numbers = row(&mut cursor, "a point")?;
                let Some(&[x, y, z]) = numbers.first_chunk() else {
                    return Err(cursor.error("a point is damaged").expected("three coordinates"));
                };
                visit(tag(zone, point), DVec3::new(x, y, z))?;
            }
        }
        Ok(())
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        for (zone, own) in self.0.iter().enumerate() {
            let (mut cursor, count) = own.elements.clone();
            for element in 0..count {
                let numbers = row(&mut cursor, "an element")?;
                let code = numbers[0] as u8;
                let kind = CellType::from_code(code).filter(|_| f64::from(code) == numbers[0]);
                let point_count = kind.and_then(|kind| kind.point_count).map(usize::from);
                let nodes = point_count.and_then(|count| numbers.get(1..=count));
                let Some((kind, nodes)) = kind.zip(nodes) else {
                    let error = cursor.error("an element is damaged").got(format_args!("{numbers:?}"));
                    return Err(error.expected("a type (10, 12, 13 or 14) and its points"));
                };
                if kind.dimension < 3 {
                    continue;
                }
                if !matches!(code, code::TETRA | code::HEXAHEDRON | code::WEDGE | code::PYRAMID) {
                    return Err(cursor.error("an element of this type is not read").got(kind.name));
                }
                if let Some(node) =
                    nodes.iter().find(|node| !(0.0..MAX_POINT).contains(*node) || node.fract() != 0.0)
                {
                    let error = cursor.error("the number of a point is damaged").got(node);
                    return Err(error.expected("a whole number from 0"));
                }
                let nodes: Vec<u64> = nodes.iter().map(|&node| tag(zone, node as u64)).collect();
                let tag = tag(zone, element);
                visit(&TaggedElement { tag, code, block: &own.name, nodes: &nodes })?;
            }
        }
        Ok(())
    }
}
