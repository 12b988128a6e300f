//! Points and cells of legacy files: their sections, in whatever order a file has them.

use super::scanner::Scanner;
use crate::formats::contents::{
    Geometry, Stored, StoredCells, StoredFaces, extent_dimensions, structured_counts,
};
use crate::formats::numbers::NumberType;
use glam::{DMat3, DVec3};
use voltet_core::{Error, Result};

/// Parts of a data set's geometry, in whatever order the file has them.
#[derive(Default)]
pub(super) struct LegacyGeometry {
    points: Option<Stored>,
    cells: Option<CellList>,
    types: Option<Stored>,
    dimensions: Option<[u64; 3]>,
    axes: [Option<Stored>; 3],
    pub blanking: Option<Stored>,
    origin: DVec3,
    spacing: Option<DVec3>,
    direction: Option<DMat3>,
    first: DVec3,
}

/// The cells of an unstructured grid: in the old form a list of counts and points, else the connectivity with offsets.
struct CellList {
    count: u64,
    list: Stored,
    offsets: Option<Stored>,
}

impl LegacyGeometry {
    pub fn read(&mut self, keyword: &str, scanner: &mut Scanner) -> Result<()> {
        match keyword {
            "POINTS" => {
                self.points = Some(scanner.counted(keyword, "the number of points", 3)?);
            }
            "CELLS" => self.cells = Some(cells(scanner)?),
            "CELL_TYPES" => {
                let count = scanner.number("the number of cells")?;
                self.types = Some(scanner.numeric("CELL_TYPES", Some(NumberType::I32), 1, count)?);
            }
            "DIMENSIONS" => self.dimensions = Some(scanner.numbers("three numbers of points")?),
            "EXTENT" => {
                let extent: [i64; 6] = scanner.numbers("six indices")?;
                self.dimensions = Some(extent_dimensions(extent));
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
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                self.axes[axis] = Some(scanner.counted(keyword, "the number of coordinates", 1)?);
            }
            "BLANKING" => {
                self.blanking = Some(scanner.counted(keyword, "the number of points", 1)?);
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

    pub fn counts(&self, kind: &str, scanner: &Scanner) -> Result<(u64, u64)> {
        let point_count = self.points.as_ref().and_then(|points| points.tuple_count).unwrap_or(0);
        if kind == "UNSTRUCTURED_GRID" {
            return Ok((point_count, self.cells.as_ref().map_or(0, |cells| cells.count)));
        }
        let dimensions = self.dimensions.unwrap_or([0; 3]);
        let counts = structured_counts(dimensions).map_err(|error| scanner.cursor.locate(error))?;
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
    pub fn geometry(self, kind: &str) -> Result<Geometry> {
        let lacks = |what: &str| Error::run(format!("the {kind} lacks {what}"));
        let dimensions = self.dimensions.ok_or_else(|| lacks("DIMENSIONS"));
        match kind {
            "UNSTRUCTURED_GRID" => {
                let points = self.points.ok_or_else(|| lacks("POINTS"))?;
                let types = self.types.ok_or_else(|| lacks("CELL_TYPES"))?;
                let CellList { count, list, offsets } = self.cells.ok_or_else(|| lacks("CELLS"))?;
                if let Some(found) = types.tuple_count.filter(|&found| found != count) {
                    return Err(Error::run("the number of CELL_TYPES is wrong").got(found).expected(count));
                }
                let cells = match offsets {
                    None => StoredCells::Counted { list, types },
                    Some(offsets) => {
                        let faces = StoredFaces::InConnectivity;
                        StoredCells::Offsets { connectivity: list, offsets, types, faces }
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
    if scanner.cursor.word_if("OFFSETS")? {
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
        let list = scanner.numeric("CONNECTIVITY", number_type, 1, size)?;
        return Ok(CellList { count: count.saturating_sub(1), list, offsets: Some(offsets) });
    }
    let list = scanner.numeric("CELLS", Some(NumberType::I32), 1, size)?;
    Ok(CellList { count, list, offsets: None })
}
