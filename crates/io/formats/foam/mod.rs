//! Cases of OpenFOAM: the mesh in `constant/polyMesh`, fields in a folder for each time; also decomposed ones, `processor0`, ….
//!
//! A case is named by its folder, by a file `*.foam` in it, or by its `system/controlDict`. Steps are the folders whose
//! names are numbers. The mesh of a time is the last that was written until then (`TIME/polyMesh`). Fields of cells
//! and of points are arrays; values at boundaries are not read.

mod cells;
mod file;

use self::cells::{Faces, MeshPaths};
use self::file::{FieldValues, FoamFile, existing, misfit};
use super::contents::{CellBlocks, Compute, Dataset, Encoding, Piece, PieceArray, Stored};
use super::lazy::geometry;
use super::numbers::{ByteOrder, NumberType};
use super::request::Request;
use super::source::Source;
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::{Association, Cells};
use voltet_core::{Error, Result, counted};

/// Kinds of fields: the name within a class, the number of components, and their names.
const KINDS: [(&str, usize, &[&str]); 5] = [
    ("Scalar", 1, &[]),
    ("Vector", 3, &[]),
    ("SphericalTensor", 1, &[]),
    ("SymmTensor", 6, &["XX", "XY", "XZ", "YY", "YZ", "ZZ"]),
    ("Tensor", 9, &[]),
];

/// The folder of the case that a path names; `None` where it names none.
pub(super) fn case_folder(path: &Path) -> Option<PathBuf> {
    let is_stub = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("foam"));
    let is_control = path.ends_with("system/controlDict");
    let folder = match () {
        () if is_control => path.parent()?.parent()?,
        () if is_stub => path.parent()?,
        () => path,
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let is_case = folder.is_dir() && (folder.join("system/controlDict").is_file() || has_mesh(folder));
    (is_stub || is_control && path.is_file() || is_case).then(|| folder.to_owned())
}

fn has_mesh(folder: &Path) -> bool {
    existing(&folder.join("constant/polyMesh/faces")).is_some()
}

/// A folder with a mesh and times: of the case, or of one of its processors.
struct Part {
    folder: PathBuf,
    /// Times in ascending order and the names of their folders.
    times: Vec<(f64, String)>,
}

impl Part {
    fn of_folder(folder: PathBuf) -> Part {
        let mut times: Vec<(f64, String)> = names(&folder)
            .into_iter()
            .filter(|name| folder.join(name).is_dir())
            .filter_map(|name| Some((name.parse().ok().filter(|time: &f64| time.is_finite())?, name)))
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        Part { folder, times }
    }

    /// The file of the mesh that was written last until a time.
    fn mesh_file(&self, name: &str, time: f64) -> Option<PathBuf> {
        let until = self.times.iter().rev().filter(|step| step.0 <= time).map(|step| step.1.as_str());
        let mut folders = until.chain(["constant"]);
        folders.find_map(|folder| existing(&self.folder.join(folder).join("polyMesh").join(name)))
    }

    fn mesh(&self, time: f64) -> Result<MeshPaths> {
        let file = |name: &str| {
            self.mesh_file(name, time).ok_or_else(|| {
                let wanted = self.folder.join("constant/polyMesh").join(name);
                Error::run("the mesh of the case is not complete")
                    .expected("this file, or one with .gz")
                    .in_file(wanted)
            })
        };
        Ok(MeshPaths {
            points: file("points")?,
            faces: file("faces")?,
            owner: file("owner")?,
            neighbour: file("neighbour")?,
        })
    }
}

/// Names in a folder, in ascending order.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

/// The folders that are read: of the case, or those of its processors where it has no mesh or later times there.
fn parts(folder: &Path) -> Result<(Vec<Part>, bool)> {
    let whole = Part::of_folder(folder.to_owned());
    let number = |name: &String| name.strip_prefix("processor").and_then(|number| number.parse::<u32>().ok());
    let mut processors: Vec<String> =
        names(folder).into_iter().filter(|name| number(name).is_some()).collect();
    processors.sort_by_key(number);
    let processors: Vec<Part> = processors.iter().map(|name| Part::of_folder(folder.join(name))).collect();
    let last = |part: &Part| part.times.last().map(|step| step.0);
    let has_later = processors.first().is_some_and(|first| last(first) > last(&whole));
    match (has_mesh(folder), processors.is_empty()) {
        (true, true) => Ok((vec![whole], false)),
        (true, false) if !has_later => Ok((vec![whole], false)),
        (has_mesh, false) => Ok((processors, has_mesh)),
        (false, true) => Err(Error::run("the case of OpenFOAM has no mesh").in_file(folder).expected(
            "constant/polyMesh, or processor0, … with one each; of several regions or collated processors: reconstructPar, and \
             foamToVTK",
        )),
    }
}

/// Reads the table of contents of a case, with the file of its points.
pub(super) fn open(folder: &Path, request: &Request) -> Result<(Dataset, Arc<Source>)> {
    let (parts, has_both) = parts(folder)?;
    let times: Vec<f64> =
        parts.first().map_or(Vec::new(), |part| part.times.iter().map(|step| step.0).collect());
    let step = if times.is_empty() { None } else { Some(request.step_index(&times)?) };
    let mut dataset = Dataset { time_steps: times, ..Dataset::default() };
    if has_both {
        dataset.warnings.push(
            "The case is read from the folders of its processors, which have later times than the case."
                .to_owned(),
        );
    }
    for part in &parts {
        let (name, time) = match step.map(|step| &parts[0].times[step]) {
            None => (None, f64::INFINITY),
            Some((time, name)) => (Some(name.as_str()), *time),
        };
        dataset.pieces.push(piece(part, name, time, &mut dataset.file_bytes)?);
    }
    let head = FoamFile::open(&parts[0].mesh(f64::INFINITY)?.points, true)?;
    let encoding = if head.binary.is_some() { "binary" } else { "ASCII" };
    dataset.format = match parts.len() {
        1 => format!("OpenFOAM, {encoding}"),
        count => format!("OpenFOAM, {encoding}, {}", counted(count, "processor")),
    };
    Ok((dataset, head.source))
}

/// Number of cells that the file of owners notes, or else that its numbers show.
fn cell_count(mesh: &MeshPaths) -> Result<u64> {
    let head = FoamFile::open(&mesh.owner, true)?;
    let noted = head.note.split("nCells:").nth(1).and_then(|rest| rest.split_whitespace().next());
    match noted.and_then(|word| word.parse().ok()) {
        Some(count) => Ok(count),
        None => Faces::read(mesh).map(|faces| faces.cell_count as u64),
    }
}

fn piece(part: &Part, time_folder: Option<&str>, time: f64, file_bytes: &mut u64) -> Result<Piece> {
    let mesh = part.mesh(time)?;
    let counts = [FoamFile::open(&mesh.points, true)?.point_count()?, cell_count(&mesh)?];
    let [point_count, cell_count] = counts;
    let mut arrays = Vec::new();
    if let Some(name) = time_folder {
        let folder = part.folder.join(name);
        let mut files: Vec<String> =
            names(&folder).into_iter().filter(|name| folder.join(name).is_file()).collect();
        files.dedup_by(|packed, plain| packed.strip_suffix(".gz") == Some(plain));
        for file in files {
            if let Some(field) = Field::of_file(&folder.join(file))? {
                *file_bytes += field.source.len();
                arrays.push(field.array(counts));
            }
        }
    }
    for path in [&mesh.points, &mesh.faces, &mesh.owner, &mesh.neighbour] {
        *file_bytes += std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    }
    // Hexahedra, which are most cells of most meshes, have eight corners.
    let counts = [point_count, cell_count, cell_count.saturating_mul(8)];
    Ok(Piece {
        point_count,
        cell_count,
        arrays,
        geometry: geometry(counts, move |_| read_mesh(&mesh)),
        blocks: CellBlocks::One(0),
        is_old_order: false,
    })
}

fn read_mesh(mesh: &MeshPaths) -> Result<(Vec<DVec3>, Cells)> {
    let coordinates = FoamFile::open(&mesh.points, false)?.points()?;
    let points = coordinates.as_chunks().0.iter().map(|&point| DVec3::from_array(point)).collect();
    let faces = Faces::read(mesh)?;
    Ok((points, Cells::Mixed(faces.cells(|_| true))))
}

/// A field of a time, whose head was read.
struct Field {
    path: PathBuf,
    source: Arc<Source>,
    association: Association,
    kind: &'static (&'static str, usize, &'static [&'static str]),
    /// Number of tuples of an unpacked file that lie side by side, type and order of their numbers, and their place.
    bytes_of_tuples: Option<(u64, NumberType, ByteOrder, u64)>,
}

impl Field {
    /// The field of a file; `None` for other files, and for fields on faces.
    fn of_file(path: &Path) -> Result<Option<Field>> {
        let starts_with_head = Source::open(path).and_then(|source| source.head(4096)).is_ok_and(|head| {
            head.starts_with(&[0x1f, 0x8b]) || head.windows(8).any(|window| window == b"FoamFile")
        });
        if !starts_with_head {
            return Ok(None);
        }
        let mut file = FoamFile::open(path, true)?;
        let class = file.class.strip_suffix("::Internal").unwrap_or(&file.class);
        let Some(class) = class.strip_suffix("Field") else { return Ok(None) };
        let is_cell = class.strip_prefix("vol").map(|kind| (Association::Cell, kind));
        let is_point = || class.strip_prefix("point").map(|kind| (Association::Point, kind));
        let Some((association, name)) = is_cell.or_else(is_point) else { return Ok(None) };
        let Some(kind) = KINDS.iter().find(|kind| kind.0 == name) else { return Ok(None) };
        let mut bytes_of_tuples = None;
        // A field with other values, or without any, is an error once it is read.
        if let (Some(order), false) = (file.binary, file.is_packed)
            && let Ok(FieldValues::List(count)) = file.field_values(kind.1)
        {
            bytes_of_tuples = Some((count, file.scalar, order, file.position()));
        }
        Ok(Some(Field { path: path.to_owned(), source: file.source, association, kind, bytes_of_tuples }))
    }

    /// Its array; bytes that lie side by side are read from the file as they are.
    fn array(self, [point_count, cell_count]: [u64; 2]) -> PieceArray {
        let tuple_count = if self.association == Association::Cell { cell_count } else { point_count };
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.strip_suffix(".gz").unwrap_or(&name).to_owned();
        let (component_count, path) = (self.kind.1, self.path);
        let load: Compute = Arc::new(move |_| load_field(&path, component_count, tuple_count));
        let mut stored =
            Stored::of_f64(&self.source, &name, component_count, tuple_count, Encoding::Computed(load));
        if let Some((_, number_type, order, place)) = self.bytes_of_tuples.filter(|own| own.0 == tuple_count)
        {
            stored = Stored { number_type, order, encoding: Encoding::Bytes(place), ..stored };
        }
        let component_names = self.kind.2.iter().map(|name| (*name).to_owned()).collect();
        PieceArray { component_names, ..PieceArray::new(self.association, stored) }
    }
}

/// Values of a field within the mesh.
fn load_field(path: &Path, component_count: usize, tuple_count: u64) -> Result<Vec<f64>> {
    let mut file = FoamFile::open(path, false)?;
    match file.field_values(component_count)? {
        FieldValues::List(count) if count == tuple_count => file.scalars(count * component_count as u64),
        FieldValues::List(count) => Err(misfit("values of the field", count as usize, tuple_count, path)),
        FieldValues::Uniform(tuple) => {
            // The mesh was read before, so there are so many cells and points.
            Ok(tuple.iter().copied().cycle().take(tuple_count as usize * component_count).collect())
        }
    }
}
