//! Legacy VTK files (.vtk), versions 1.0 to 5.1, ASCII and binary (big-endian).
//!
//! Source: "VTK File Formats" (docs.vtk.org), section "Simple Legacy Formats", and for 5.x and what the text leaves open
//! vtkDataReader.cxx and its kin. Read word by word, as VTK does, so line ends carry meaning only before
//! the bytes of an array.

mod scanner;

use super::contents::{
    Dataset, Encoding, Format, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces,
    structured_counts,
};
use super::numbers::NumberType;
use super::request::Request;
use super::select::GHOST_TYPE;
use super::source::Source;
use glam::{DMat3, DVec3};
use scanner::Scanner;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// First words of every legacy file.
const MAGIC: &str = "# vtk DataFile Version";

/// The kinds of data sets with a volume.
const KINDS: [&str; 4] = ["UNSTRUCTURED_GRID", "STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"];

/// The declaration.
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
    scanner.binary = match mode.to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => {
            let found = format!("'{mode}'");
            return Err(scanner.error("the third line is wrong").got(found).expected("ASCII or BINARY"));
        }
    };
    let mut word = scanner.required("DATASET")?;
    // Fields of the whole file may stand first.
    while word.eq_ignore_ascii_case("FIELD") {
        field(&mut scanner)?;
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
    let mut contents = Contents::default();
    let mut arrays = Vec::new();
    let mut dataset = Dataset::default();
    while let Some(word) = scanner.word()? {
        let keyword = word.to_ascii_uppercase();
        match keyword.as_str() {
            "METADATA" => scanner.skip_metadata()?,
            "FIELD" => drop(field(&mut scanner)?),
            "POINT_DATA" | "CELL_DATA" => {
                // The attributes are the rest of the file.
                let counts = contents.counts(&kind, &scanner)?;
                dataset.active_scalars = read(&mut scanner, &keyword, counts, &mut arrays)?;
            }
            _ => contents.read(&keyword, &mut scanner)?,
        }
    }
    let (point_count, cell_count) = contents.counts(&kind, &scanner)?;
    if let Some(blanking) = contents.blanking.take() {
        arrays.push(PieceArray { per_cell: false, stored: ghost_flags(blanking) });
    }
    let geometry = contents.geometry(&kind)?;
    dataset.pieces.push(Piece { point_count, cell_count, geometry, arrays });
    let mode = if scanner.binary { "binary" } else { "ASCII" };
    dataset.format = format!("legacy VTK {version} {kind}, {mode}");
    Ok(dataset)
}

/// Parts of a data set's geometry, in whatever order the file has them.
#[derive(Default)]
struct Contents {
    points: Option<Stored>,
    cells: Option<CellList>,
    types: Option<Stored>,
    dimensions: Option<[u64; 3]>,
    axes: [Option<Stored>; 3],
    blanking: Option<Stored>,
    origin: DVec3,
    spacing: Option<DVec3>,
    direction: Option<DMat3>,
    first: DVec3,
}

/// The cells of an unstructured grid.
enum CellList {
    Counted { count: u64, list: Stored },
    Offsets { count: u64, offsets: Stored, connectivity: Stored },
}

impl Contents {
    /// Reads what follows a keyword.
    fn read(&mut self, keyword: &str, scanner: &mut Scanner) -> Result<()> {
        match keyword {
            "POINTS" => {
                let count = scanner.number("the number of points")?;
                let number_type = scanner.number_type()?;
                self.points = Some(scanner.numeric("POINTS", number_type, 3, count)?);
            }
            "CELLS" => self.cells = Some(cells(scanner)?),
            "CELL_TYPES" => {
                let count = scanner.number("the number of cells")?;
                let number_type = Some(NumberType::I32);
                self.types = Some(scanner.numeric("CELL_TYPES", number_type, 1, count)?);
            }
            "DIMENSIONS" => self.dimensions = Some(scanner.numbers("three numbers of points")?),
            "EXTENT" => {
                let extent: [i64; 6] = scanner.numbers("six indices")?;
                self.dimensions = Some(crate::formats::contents::extent_dimensions(extent));
                self.first = DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64);
            }
            "ORIGIN" => self.origin = DVec3::from_array(scanner.numbers("three coordinates")?),
            "SPACING" | "ASPECT_RATIO" => {
                self.spacing = Some(DVec3::from_array(scanner.numbers("three distances")?));
            }
            "DIRECTION" => {
                let rows: [f64; 9] = scanner.numbers("nine numbers")?;
                self.direction = Some(DMat3::from_cols_array(&rows).transpose());
            }
            "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => {
                let count = scanner.number("the number of coordinates")?;
                let number_type = scanner.number_type()?;
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                self.axes[axis] = Some(scanner.numeric(keyword, number_type, 1, count)?);
            }
            "BLANKING" => {
                let count = scanner.number("the number of points")?;
                let number_type = scanner.number_type()?;
                self.blanking = Some(scanner.numeric("BLANKING", number_type, 1, count)?);
            }
            _ => {
                let found = format!("'{keyword}'");
                return Err(scanner.error("an unknown keyword").got(found).expected(
                    "POINTS, CELLS, CELL_TYPES, DIMENSIONS, ORIGIN, SPACING, X_COORDINATES, FIELD, METADATA, \
                     POINT_DATA or CELL_DATA",
                ));
            }
        }
        Ok(())
    }

    /// Numbers of points and cells.
    fn counts(&self, kind: &str, scanner: &Scanner) -> Result<(u64, u64)> {
        let point_count = self.points.as_ref().and_then(|points| points.tuple_count).unwrap_or(0);
        if kind == "UNSTRUCTURED_GRID" {
            return Ok(match self.cells {
                None => (point_count, 0),
                Some(CellList::Counted { count, .. } | CellList::Offsets { count, .. }) => {
                    (point_count, count)
                }
            });
        }
        let dimensions = self.dimensions.unwrap_or([0; 3]);
        let counts = structured_counts(dimensions).ok_or_else(|| {
            scanner.error("the grid cannot be that large").got(format_args!("{dimensions:?} points"))
        })?;
        let wrong = |what: &str, found: u64, accepted: u64| {
            Err(Error::run(format!("the number of {what} does not fit DIMENSIONS"))
                .got(found)
                .expected(accepted))
        };
        if self.points.is_some() && point_count != counts.0 {
            return wrong("points", point_count, counts.0);
        }
        for (axis, count) in self.axes.iter().zip(dimensions) {
            if let Some(found) =
                axis.as_ref().and_then(|axis| axis.tuple_count).filter(|&found| found != count)
            {
                return wrong("coordinates", found, count);
            }
        }
        Ok(counts)
    }

    /// Geometry of the data set, or an error that names the missing part.
    fn geometry(self, kind: &str) -> Result<Geometry> {
        let lacks = |what: &str| Error::run(format!("the {kind} lacks {what}"));
        let dimensions = self.dimensions.ok_or_else(|| lacks("DIMENSIONS"));
        match kind {
            "UNSTRUCTURED_GRID" => {
                let points = self.points.ok_or_else(|| lacks("POINTS"))?;
                let types = self.types.ok_or_else(|| lacks("CELL_TYPES"))?;
                let check = |count: u64| match types.tuple_count {
                    Some(found) if found != count => {
                        Err(Error::run("the number of CELL_TYPES is wrong").got(found).expected(count))
                    }
                    _ => Ok(()),
                };
                let cells = match self.cells.ok_or_else(|| lacks("CELLS"))? {
                    CellList::Counted { count, list } => {
                        check(count)?;
                        StoredCells::Counted { list, types }
                    }
                    CellList::Offsets { count, offsets, connectivity } => {
                        check(count)?;
                        let faces = StoredFaces::InConnectivity;
                        StoredCells::Offsets { connectivity, offsets, types, faces }
                    }
                };
                Ok(Geometry::Unstructured { points, cells: Box::new(cells) })
            }
            "STRUCTURED_GRID" => Ok(Geometry::Curvilinear {
                dimensions: dimensions?,
                points: self.points.ok_or_else(|| lacks("POINTS"))?,
            }),
            "RECTILINEAR_GRID" => {
                let [Some(x), Some(y), Some(z)] = self.axes else {
                    return Err(lacks("X_COORDINATES, Y_COORDINATES or Z_COORDINATES"));
                };
                Ok(Geometry::Rectilinear { dimensions: dimensions?, axes: Box::new([x, y, z]) })
            }
            _ => Ok(Geometry::Uniform {
                dimensions: dimensions?,
                first: self.first,
                origin: self.origin,
                spacing: self.spacing.unwrap_or(DVec3::ONE),
                direction: self.direction.unwrap_or(DMat3::IDENTITY),
            }),
        }
    }
}

/// CELLS in the old form (counts among the point numbers) or, since 5.0, as offsets and connectivity.
fn cells(scanner: &mut Scanner) -> Result<CellList> {
    let count: u64 = scanner.number("the number of cells")?;
    let size = scanner.number("the length of the list")?;
    if scanner.word_if("OFFSETS")? {
        let number_type = scanner.number_type()?;
        let offsets = scanner.numeric("OFFSETS", number_type, 1, count)?;
        let word = scanner.required("CONNECTIVITY")?;
        if !word.eq_ignore_ascii_case("CONNECTIVITY") {
            return Err(scanner
                .error("the connectivity is missing")
                .got(format_args!("'{word}'"))
                .expected("CONNECTIVITY"));
        }
        let number_type = scanner.number_type()?;
        let connectivity = scanner.numeric("CONNECTIVITY", number_type, 1, size)?;
        return Ok(CellList::Offsets { count: count.saturating_sub(1), offsets, connectivity });
    }
    let number_type = Some(NumberType::I32);
    Ok(CellList::Counted { count, list: scanner.numeric("CELLS", number_type, 1, size)? })
}

/// BLANKING (0: the point is hidden) as flags of the points.
fn ghost_flags(blanking: Stored) -> Stored {
    let inner = blanking.clone();
    let hidden = |value: f64| if value == 0.0 { 2.0 } else { 0.0 };
    let encoding = Encoding::Computed(Arc::new(move |meter| {
        Ok(inner.load::<f64>(meter)?.into_iter().map(hidden).collect())
    }));
    Stored { name: GHOST_TYPE.to_owned(), encoding, ..blanking }
}

/// Reads attributes to the end of the file, from a POINT_DATA or CELL_DATA keyword on; returns the name of the first
/// SCALARS.
fn read(
    scanner: &mut Scanner,
    keyword: &str,
    (point_count, cell_count): (u64, u64),
    arrays: &mut Vec<PieceArray>,
) -> Result<Option<String>> {
    let mut active_scalars = None;
    let mut keyword = keyword.to_owned();
    let (mut per_cell, mut count) = (false, 0);
    loop {
        let mut add = |stored: Option<Stored>| {
            arrays.extend(stored.map(|stored| PieceArray { per_cell, stored }));
        };
        match keyword.as_str() {
            "POINT_DATA" | "CELL_DATA" => {
                per_cell = keyword == "CELL_DATA";
                count = scanner.number("the number of tuples")?;
                let accepted = if per_cell { cell_count } else { point_count };
                if count != accepted {
                    let what = format!("the number of {keyword} does not fit the grid");
                    return Err(scanner.error(what).got(count).expected(accepted));
                }
            }
            "METADATA" => scanner.skip_metadata()?,
            "FIELD" => field(scanner)?.into_iter().for_each(|stored| add(Some(stored))),
            "LOOKUP_TABLE" => {
                let name = name(scanner)?;
                let size = scanner.number("the number of colours")?;
                let number_type = if scanner.binary { NumberType::U8 } else { NumberType::F32 };
                scanner.array(&name, Some(number_type), 4, size)?;
            }
            "SCALARS" => {
                let name = name(scanner)?;
                let number_type = scanner.number_type()?;
                let rest = scanner.rest_of_line()?.unwrap_or_default();
                let component_count = match rest.as_str() {
                    "" => 1,
                    rest => rest.parse().ok().filter(|n| (1..=1 << 16).contains(n)).ok_or_else(|| {
                        scanner
                            .error(format!("the number of components of '{name}' is wrong"))
                            .got(format_args!("'{rest}'"))
                            .expected("1 to 65536")
                    })?,
                };
                if scanner.word_if("LOOKUP_TABLE")? {
                    scanner.required("the name of a look-up table")?;
                    add(scanner.array(&name, number_type, component_count, count)?);
                } else {
                    let what = format!("the scalars '{name}' do not name their look-up table");
                    return Err(scanner.error(what).expected("LOOKUP_TABLE default"));
                }
                active_scalars = active_scalars.or(Some(name));
            }
            "COLOR_SCALARS" => {
                let name = name(scanner)?;
                let component_count = scanner.number("the number of components")?;
                let number_type = if scanner.binary { NumberType::U8 } else { NumberType::F32 };
                add(scanner.array(&name, Some(number_type), component_count, count)?);
            }
            "TEXTURE_COORDINATES" => {
                let name = name(scanner)?;
                let component_count = scanner.number("the number of components")?;
                let number_type = scanner.number_type()?;
                add(scanner.array(&name, number_type, component_count, count)?);
            }
            "VECTORS" | "NORMALS" | "TENSORS" | "TENSORS6" | "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS"
            | "TANGENTS" => {
                let component_count = match keyword.as_str() {
                    "VECTORS" | "NORMALS" | "TANGENTS" => 3,
                    "TENSORS" => 9,
                    "TENSORS6" => 6,
                    _ => 1,
                };
                let name = name(scanner)?;
                let number_type = scanner.number_type()?;
                add(scanner.array(&name, number_type, component_count, count)?);
            }
            _ => {
                let found = format!("'{}'", keyword.escape_default());
                return Err(scanner.error("an unknown keyword").got(found).expected(
                    "SCALARS, VECTORS, NORMALS, TENSORS, TEXTURE_COORDINATES, COLOR_SCALARS, LOOKUP_TABLE, FIELD, \
                     GLOBAL_IDS, METADATA, POINT_DATA or CELL_DATA",
                ));
            }
        }
        match scanner.word()? {
            Some(word) => keyword = word.to_ascii_uppercase(),
            None => return Ok(active_scalars),
        }
    }
}

/// The arrays of a FIELD, without those of text.
fn field(scanner: &mut Scanner) -> Result<Vec<Stored>> {
    scanner.required("the name of the field")?;
    let array_count: u64 = scanner.number("the number of arrays")?;
    let mut arrays = Vec::new();
    let mut seen = 0;
    while seen < array_count {
        let name = name(scanner)?;
        match name.as_str() {
            "METADATA" => {
                scanner.skip_metadata()?;
                continue;
            }
            "NULL_ARRAY" => {}
            _ => {
                let component_count: usize = scanner.number("the number of components")?;
                let tuple_count = scanner.number("the number of tuples")?;
                let number_type = scanner.number_type()?;
                arrays.extend(scanner.array(&name, number_type, component_count.max(1), tuple_count)?);
            }
        }
        seen += 1;
    }
    Ok(arrays)
}

/// A name, whose special characters are written as `%20`.
fn name(scanner: &mut Scanner) -> Result<String> {
    let word = scanner.required("a name")?;
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word.as_bytes();
    while let [first, after @ ..] = rest {
        let code =
            after.get(..2).filter(|_| *first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
