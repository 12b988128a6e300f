//! Fields of a time: `vol…Field` of cells, `point…Field` of points.

use super::cells::{CellSelection, MeshPaths};
use super::file::{CollatedPart, FieldValues, FoamFile, has_head, misfit, names};
use super::patches::MeshBoundary;
use crate::formats::contents::{Compute, ComputeBoundary, Encoding, Meter, PieceArray, Stored};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use crate::formats::units;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::{Result, counted};

/// Kinds of fields: the name within a class, the number of components, and their names.
const KINDS: [(&str, usize, &[&str]); 5] = [
    ("Scalar", 1, &[]),
    ("Vector", 3, &[]),
    ("SphericalTensor", 1, &[]),
    ("SymmTensor", 6, &["XX", "XY", "XZ", "YY", "YZ", "ZZ"]),
    ("Tensor", 9, &[]),
];

/// A field of a time, whose head was read.
pub(super) struct Field {
    path: PathBuf,
    part: Option<CollatedPart>,
    pub source: Arc<Source>,
    pub association: Association,
    kind: &'static (&'static str, usize, &'static [&'static str]),
    unit: Option<String>,
    /// Number of tuples of an unpacked file that lie side by side, type and order of their numbers, and their place.
    bytes_of_tuples: Option<(u64, NumberType, ByteOrder, u64)>,
}

impl Field {
    /// The fields of a folder, in the order of their names.
    pub fn in_folder(folder: &Path, part: Option<&CollatedPart>) -> impl Iterator<Item = Result<Field>> {
        let mut files: Vec<String> =
            names(folder).into_iter().filter(|name| folder.join(name).is_file()).collect();
        files.dedup_by(|packed, plain| packed.strip_suffix(".gz") == Some(plain));
        files.into_iter().filter_map(move |file| Field::of_file(&folder.join(file), part).transpose())
    }

    /// The field of a file; `None` for other files, and for fields on faces.
    fn of_file(path: &Path, part: Option<&CollatedPart>) -> Result<Option<Field>> {
        if !has_head(path)? {
            return Ok(None);
        }
        let mut file = FoamFile::open(path, part, true)?;
        let class = file.class.strip_suffix("::Internal").unwrap_or(&file.class);
        let Some(class) = class.strip_suffix("Field") else { return Ok(None) };
        let is_cell = class.strip_prefix("vol").map(|kind| (Association::Cell, kind));
        let is_point = || class.strip_prefix("point").map(|kind| (Association::Point, kind));
        let Some((association, name)) = is_cell.or_else(is_point) else { return Ok(None) };
        let Some(kind) = KINDS.iter().find(|kind| kind.0 == name) else { return Ok(None) };
        let mut bytes_of_tuples = None;
        // A field with other values, or without any, is an error once it is read.
        let values = file.field_values(kind.1);
        if let (Some(order), false, Ok(FieldValues::List(count))) = (file.binary, file.is_packed, values) {
            bytes_of_tuples = Some((count, file.scalar, order, file.cursor.position()));
        }
        let unit = file.dimensions.as_deref().and_then(unit);
        Ok(Some(Field {
            path: path.to_owned(),
            part: part.cloned(),
            source: file.source.closed(),
            association,
            kind,
            bytes_of_tuples,
            unit,
        }))
    }

    /// Its values on patches.
    pub fn at_boundary(
        &self,
        boundary: Arc<MeshBoundary>,
        mesh: &MeshPaths,
        selection: &Arc<CellSelection>,
    ) -> ComputeBoundary {
        let (path, n, mesh, selection) = (self.path.clone(), self.kind.1, mesh.clone(), selection.clone());
        Arc::new(move |_| boundary.values(&mesh, &path, n, |cell| selection.contains(cell)))
    }

    /// Its array, of all tuples or of the selected cells; bytes that lie side by side are read from the file as they are.
    pub fn array(self, tuple_count: u64, selection: Option<(Arc<CellSelection>, u64)>) -> PieceArray {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.strip_suffix(".gz").unwrap_or(&name).to_owned();
        let (n, path, part) = (self.kind.1, self.path, self.part);
        let selected_count = selection.as_ref().map_or(tuple_count, |selection| selection.1);
        let is_whole = selection.is_none();
        let load: Compute = Arc::new(move |meter| {
            let values = load_field(&path, part.as_ref(), n, tuple_count, meter)?;
            let Some((selection, _)) = &selection else { return Ok(values) };
            let tuples = values.chunks(n).enumerate().filter(|&(cell, _)| selection.contains(cell));
            Ok(tuples.flat_map(|(_, tuple)| tuple.iter().copied()).collect())
        });
        let mut stored = Stored::of_f64(&self.source, &name, n, selected_count, Encoding::Computed(load));
        if let Some((_, number_type, order, place)) =
            self.bytes_of_tuples.filter(|own| own.0 == tuple_count && is_whole)
        {
            stored = Stored { number_type, order, encoding: Encoding::Bytes(place), ..stored };
        }
        let component_names = self.kind.2.iter().map(|name| (*name).to_owned()).collect();
        PieceArray { component_names, unit: self.unit, ..PieceArray::new(self.association, stored) }
    }
}

/// A unit by its exponents of kilogram, metre, second, kelvin, mole, ampere and candela, of which the last may be left out.
fn unit(exponents: &[f64]) -> Option<String> {
    let factors: Vec<(&str, f64)> =
        ["kg", "m", "s", "K", "mol", "A", "cd"].into_iter().zip(exponents.iter().copied()).collect();
    units::product(&factors)
}

/// Values of a field within the mesh.
fn load_field(
    path: &Path,
    part: Option<&CollatedPart>,
    component_count: usize,
    tuple_count: u64,
    meter: &Meter,
) -> Result<Vec<f64>> {
    FoamFile::read(path, part, |file| match file.field_values(component_count)? {
        FieldValues::List(count) if count == tuple_count => {
            file.numbers(file.scalar, count * component_count as u64)
        }
        FieldValues::List(count) => Err(misfit("values of the field", count as usize, tuple_count, path)),
        FieldValues::Uniform(tuple) => {
            let number_count = tuple_count.saturating_mul(component_count as u64);
            let what = || counted(tuple_count, "uniform value");
            refuse_beyond_memory(meter.progress(), what, number_count.saturating_mul(8))?;
            Ok(tuple.iter().copied().cycle().take(number_count as usize).collect())
        }
    })
}
