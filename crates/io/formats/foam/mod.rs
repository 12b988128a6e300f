//! Cases of OpenFOAM: the mesh in `constant/polyMesh`, fields in a folder for each time; also decomposed ones, `processor0`, ….
//!
//! A case is named by its folder, by a file `*.foam` in it, or by its `system/controlDict`. Steps are the folders whose
//! names are numbers. The mesh of a time is the last that was written until then (`TIME/polyMesh`). Fields of cells
//! and of points are arrays; values at boundaries are not read. Cell zones are blocks.

mod cells;
mod file;

use self::cells::{CellZones, FaceCells, MeshPaths};
use self::file::{FieldValues, FoamFile, existing, has_head, misfit};
use super::blocks::selected;
use super::contents::{CellBlocks, Compute, Dataset, Encoding, Meter, Piece, PieceArray, Stored};
use super::lazy::geometry;
use super::numbers::{ByteOrder, NumberType};
use super::request::Request;
use super::source::Source;
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::{Association, Cells};
use voltet_core::progress::refuse_beyond_memory;
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
struct CaseFolder {
    folder: PathBuf,
    /// Times in ascending order and the names of their folders.
    times: Vec<(f64, String)>,
}

impl CaseFolder {
    fn of_folder(folder: PathBuf) -> CaseFolder {
        let mut times: Vec<(f64, String)> = names(&folder)
            .into_iter()
            .filter(|name| folder.join(name).is_dir())
            .filter_map(|name| Some((name.parse().ok().filter(|time: &f64| time.is_finite())?, name)))
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        CaseFolder { folder, times }
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
            zones: self.mesh_file("cellZones", time),
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
fn parts(folder: &Path) -> Result<(Vec<CaseFolder>, bool)> {
    let whole = CaseFolder::of_folder(folder.to_owned());
    let number = |name: &String| name.strip_prefix("processor").and_then(|number| number.parse::<u32>().ok());
    let mut processors: Vec<String> =
        names(folder).into_iter().filter(|name| number(name).is_some()).collect();
    processors.sort_by_key(number);
    let processors: Vec<CaseFolder> =
        processors.iter().map(|name| CaseFolder::of_folder(folder.join(name))).collect();
    let last = |part: &CaseFolder| part.times.last().map(|step| step.0);
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
    let (name, time) = match step.map(|step| &parts[0].times[step]) {
        None => (None, f64::INFINITY),
        Some((time, name)) => (Some(name.as_str()), *time),
    };
    let meshes =
        parts.iter().map(|part| FolderMesh::open(part, time)).collect::<Result<Vec<FolderMesh>>>()?;
    dataset.blocks = block_names(&meshes);
    let is_selected = selected(&dataset.blocks, request)?;
    for (part, mesh) in parts.iter().zip(meshes) {
        let numbers =
            mesh.zones.names.iter().map(|name| dataset.blocks.iter().position(|block| block == name));
        let selection = CellSelection {
            blocks: numbers.map(|block| block.unwrap_or(0)).collect(),
            is_selected: is_selected.clone(),
            zones: mesh.zones,
        };
        let folder = name.map(|name| part.folder.join(name));
        let counts = [mesh.point_count, mesh.cell_count];
        dataset.pieces.push(piece(mesh.paths, counts, folder, selection, &mut dataset.file_bytes)?);
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
        None => FaceCells::read(mesh).map(|faces| faces.cell_count as u64),
    }
}

/// The mesh of a part, of which the cells are not yet read.
struct FolderMesh {
    paths: MeshPaths,
    point_count: u64,
    cell_count: u64,
    zones: CellZones,
}

impl FolderMesh {
    fn open(part: &CaseFolder, time: f64) -> Result<FolderMesh> {
        let paths = part.mesh(time)?;
        let point_count = FoamFile::open(&paths.points, true)?.point_count()?;
        let cell_count = cell_count(&paths)?;
        let zones = CellZones::read(&paths, cell_count)?;
        Ok(FolderMesh { paths, point_count, cell_count, zones })
    }
}

/// Name of the block of cells in no zone, where there are zones.
const NO_ZONE: &str = "no zone";

/// Names of the zones of all parts; of none where there are no zones.
fn block_names(meshes: &[FolderMesh]) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    for name in meshes.iter().flat_map(|mesh| &mesh.zones.names) {
        if !blocks.contains(name) {
            blocks.push(name.clone());
        }
    }
    if !blocks.is_empty() && meshes.iter().any(|mesh| mesh.zones.rest(mesh.cell_count) > 0) {
        blocks.push(NO_ZONE.to_owned());
    }
    blocks
}

/// Blocks of a part's cells, and those that are read.
struct CellSelection {
    zones: CellZones,
    /// Numbers of the zones' blocks.
    blocks: Vec<usize>,
    is_selected: Vec<bool>,
}

impl CellSelection {
    /// Number of a cell's block; of cells in no zone the last.
    fn block(&self, cell: usize) -> usize {
        match self.zones.zone(cell) {
            Some(zone) => self.blocks[zone],
            None => self.is_selected.len().saturating_sub(1),
        }
    }

    fn contains(&self, cell: usize) -> bool {
        self.is_selected.get(self.block(cell)).copied().unwrap_or(true)
    }

    fn is_all(&self) -> bool {
        !self.is_selected.contains(&false)
    }

    /// Number of selected cells.
    fn count(&self, cell_count: u64) -> u64 {
        if self.is_all() {
            return cell_count;
        }
        let zones = self.blocks.iter().enumerate().filter(|&(_, &block)| self.is_selected[block]);
        let rest = if self.is_selected.last() == Some(&true) { self.zones.rest(cell_count) } else { 0 };
        zones.fold(rest, |sum, (zone, _)| sum + self.zones.count(zone))
    }
}

fn piece(
    mesh: MeshPaths,
    [point_count, cell_count]: [u64; 2],
    folder: Option<PathBuf>,
    selection: CellSelection,
    file_bytes: &mut u64,
) -> Result<Piece> {
    let selected_count = selection.count(cell_count);
    let selection = Arc::new(selection);
    let mut arrays = Vec::new();
    if let Some(folder) = folder {
        let mut files: Vec<String> =
            names(&folder).into_iter().filter(|name| folder.join(name).is_file()).collect();
        files.dedup_by(|packed, plain| packed.strip_suffix(".gz") == Some(plain));
        for file in files {
            if let Some(field) = Field::of_file(&folder.join(file))? {
                *file_bytes += field.source.len();
                arrays.push(match field.association {
                    Association::Point => field.array(point_count, None),
                    Association::Cell => {
                        let selection = (!selection.is_all()).then(|| (selection.clone(), selected_count));
                        field.array(cell_count, selection)
                    }
                });
            }
        }
    }
    for path in [&mesh.points, &mesh.faces, &mesh.owner, &mesh.neighbour].into_iter().chain(&mesh.zones) {
        *file_bytes += std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    }
    // Hexahedra, which are most cells of most meshes, have eight corners.
    let counts = [point_count, selected_count, selected_count.saturating_mul(8)];
    let of = selection.clone();
    let numbers: Compute = Arc::new(move |_| {
        let cells = (0..cell_count as usize).filter(|&cell| selection.contains(cell));
        Ok(cells.map(|cell| selection.block(cell) as f64).collect())
    });
    Ok(Piece {
        point_count,
        cell_count: selected_count,
        arrays,
        geometry: geometry(counts, move |_| read_mesh(&mesh, cell_count, &of)),
        blocks: CellBlocks::Each(numbers),
        is_old_order: false,
    })
}

fn read_mesh(mesh: &MeshPaths, cell_count: u64, selection: &CellSelection) -> Result<(Vec<DVec3>, Cells)> {
    let coordinates = FoamFile::open(&mesh.points, false)?.points()?;
    let copied = |(_, numbers): (_, Vec<f64>)| bytemuck::cast_slice(&numbers).to_vec();
    let points = bytemuck::try_cast_vec(coordinates).unwrap_or_else(copied);
    let faces = FaceCells::read(mesh)?;
    if faces.cell_count as u64 != cell_count {
        return Err(misfit("cells", faces.cell_count, format!("{cell_count}, as it notes"), &mesh.owner));
    }
    Ok((points, faces.cells(|cell| selection.contains(cell))))
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
        if !has_head(path)? {
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
        Ok(Some(Field {
            path: path.to_owned(),
            source: file.source.closed(),
            association,
            kind,
            bytes_of_tuples,
        }))
    }

    /// Its array, of all tuples or of the selected cells; bytes that lie side by side are read from the file as they are.
    fn array(self, tuple_count: u64, selection: Option<(Arc<CellSelection>, u64)>) -> PieceArray {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.strip_suffix(".gz").unwrap_or(&name).to_owned();
        let (n, path) = (self.kind.1, self.path);
        let selected_count = selection.as_ref().map_or(tuple_count, |selection| selection.1);
        let is_whole = selection.is_none();
        let load: Compute = Arc::new(move |meter| {
            let values = load_field(&path, n, tuple_count, meter)?;
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
        PieceArray { component_names, ..PieceArray::new(self.association, stored) }
    }
}

/// Values of a field within the mesh.
fn load_field(path: &Path, component_count: usize, tuple_count: u64, meter: &Meter) -> Result<Vec<f64>> {
    let mut file = FoamFile::open(path, false)?;
    match file.field_values(component_count)? {
        FieldValues::List(count) if count == tuple_count => file.scalars(count * component_count as u64),
        FieldValues::List(count) => Err(misfit("values of the field", count as usize, tuple_count, path)),
        FieldValues::Uniform(tuple) => {
            let number_count = tuple_count.saturating_mul(component_count as u64);
            let what = || counted(tuple_count, "uniform value");
            refuse_beyond_memory(meter.progress(), what, number_count.saturating_mul(8))?;
            Ok(tuple.iter().copied().cycle().take(number_count as usize).collect())
        }
    }
}

/// The files of a case that reading it opens, of every time or of that asked for; none for other paths.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let Some(folder) = case_folder(path) else { return Vec::new() };
    let parts = parts(&folder).map_or(Vec::new(), |found| found.0);
    let mut files = Vec::new();
    for part in &parts {
        let times: Vec<f64> = part.times.iter().map(|step| step.0).collect();
        let index = request.filter(|_| !times.is_empty()).and_then(|request| request.step_index(&times).ok());
        let time = index.map(|index| times[index]);
        let of_time = part.times.iter().filter(|step| time.is_none_or(|time| time == step.0));
        let folders = of_time.map(|step| part.folder.join(&step.1));
        for folder in folders {
            files.extend(
                names(&folder).into_iter().map(|name| folder.join(name)).filter(|file| file.is_file()),
            );
        }
        let times: Vec<f64> = match time {
            Some(time) => vec![time],
            None => times.into_iter().chain([f64::INFINITY]).collect(),
        };
        for mesh in times.into_iter().filter_map(|time| part.mesh(time).ok()) {
            files.extend([mesh.points, mesh.faces, mesh.owner, mesh.neighbour].into_iter().chain(mesh.zones));
        }
    }
    files.sort();
    files.dedup();
    files
}
