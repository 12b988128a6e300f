//! Legacy VTK files (.vtk), versions 1.0 to 5.1, ASCII and binary (big-endian).
//!
//! Source: "VTK File Formats" (docs.vtk.org), section "Simple Legacy Formats", and for 5.x and what the text leaves open
//! vtkDataReader.cxx and its kin. Read word by word, as VTK does, so line ends carry meaning only before
//! the bytes of an array.

mod attributes;
mod geometry;
mod scanner;

use self::attributes::{attribute, field};
use self::geometry::LegacyGeometry;
use self::scanner::Scanner;
use super::contents::{CellBlocks, Dataset, Piece, PieceArray, TIME};
use super::numbers::ByteOrder;
use super::request::{Format, Request};
use super::source::Source;
use super::xml::is_before;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Association;

/// First words of every legacy file.
const MAGIC: &str = "# vtk DataFile Version";

/// The kinds of data sets with a volume.
const KINDS: [&str; 4] = ["UNSTRUCTURED_GRID", "STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"];

pub(super) const FORMAT: Format = Format {
    files: "a legacy VTK file (.vtk)",
    matches: |head, _, _| head.starts_with(MAGIC.as_bytes()),
    open,
    has_solution: false,
};

/// Reads the table of contents.
fn open(source: Arc<Source>, _: &Request) -> Result<Dataset> {
    let mut scanner = Scanner::new(source);
    let first = scanner.rest_of_line()?.unwrap_or_default();
    let version = first.get(MAGIC.len()..).unwrap_or("").trim().to_owned();
    scanner.rest_of_line()?;
    let mode = scanner.required("ASCII or BINARY")?;
    scanner.cursor.binary = match mode.to_ascii_uppercase().as_str() {
        "ASCII" => None,
        "BINARY" => Some(ByteOrder::Big),
        _ => {
            let found = format!("'{mode}'");
            return Err(scanner.error("the third line is wrong").got(found).expected("ASCII or BINARY"));
        }
    };
    let mut word = scanner.required("DATASET")?;
    let mut fields = Vec::new();
    // Fields of the whole file may stand first.
    while word.eq_ignore_ascii_case("FIELD") {
        fields.extend(field(&mut scanner)?);
        word = scanner.required("DATASET")?;
    }
    if !word.eq_ignore_ascii_case("DATASET") {
        return Err(scanner
            .error("the file does not say what it holds")
            .got(format_args!("'{word}'"))
            .expected("DATASET"));
    }
    let kind = scanner.required("a kind of data set")?.to_ascii_uppercase();
    if !KINDS.contains(&kind.as_str()) {
        let error = scanner.error("this kind of VTK file holds no volume grid");
        return Err(error.got(format_args!("'{kind}'")).expected(KINDS.join(", ")));
    }
    let mut contents = LegacyGeometry::default();
    let mut arrays = Vec::new();
    let mut dataset = Dataset { file_bytes: scanner.source.len(), ..Dataset::default() };
    // Location and number of the tuples of attributes, which are the rest of the file.
    let mut section = None;
    while let Some(word) = scanner.word()? {
        let keyword = word.to_ascii_uppercase();
        let found = match (keyword.as_str(), section) {
            ("METADATA", _) => {
                scanner.skip_metadata()?;
                Vec::new()
            }
            ("FIELD", _) => field(&mut scanner)?,
            ("POINT_DATA" | "CELL_DATA", _) => {
                let (point_count, cell_count) = contents.counts(&kind, &scanner)?;
                let (association, accepted) = match keyword.as_str() {
                    "POINT_DATA" => (Association::Point, point_count),
                    _ => (Association::Cell, cell_count),
                };
                let count = scanner.number("the number of tuples")?;
                if count != accepted {
                    let what = format!("the number of {keyword} does not fit the grid");
                    return Err(scanner.error(what).got(count).expected(accepted));
                }
                section = Some((association, count));
                Vec::new()
            }
            (_, None) => {
                contents.read(&keyword, &mut scanner)?;
                Vec::new()
            }
            (_, Some((_, count))) => {
                let found = attribute(&mut scanner, &keyword, count)?;
                if keyword == "SCALARS" && dataset.active_scalars.is_none() {
                    dataset.active_scalars = found.as_ref().map(|array| array.name.clone());
                }
                found.into_iter().collect()
            }
        };
        match section {
            Some((association, _)) => {
                arrays.extend(found.into_iter().map(|stored| PieceArray::new(association, stored)));
            }
            None => fields.extend(found),
        }
    }
    let of_time = |name: &&str| fields.iter().find(|field| field.name == **name)?.first();
    dataset.time = TIME.iter().find_map(of_time);
    let (point_count, cell_count) = contents.counts(&kind, &scanner)?;
    if let Some(blanking) = contents.blanking.take() {
        let stored = blanking.hidden_where_zero();
        arrays.push(PieceArray::new(Association::Point, stored));
    }
    let geometry = contents.geometry(&kind)?;
    // "Version 4.2".
    let is_old_order = version.split(' ').next_back().is_some_and(|version| is_before(version, [5, 0]));
    let blocks = CellBlocks::default();
    dataset.pieces.push(Piece { point_count, cell_count, geometry, arrays, blocks, is_old_order });
    let mode = if scanner.is_binary() { "binary" } else { "ASCII" };
    dataset.format = format!("legacy VTK {version} {kind}, {mode}");
    Ok(dataset)
}
