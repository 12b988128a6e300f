//! Cases of OpenFOAM: the mesh in `constant/polyMesh`, fields in a folder for each time; also decomposed ones, `processor0`, …, and
//! collated ones, `processors4`, where each file holds those of all processors.
//!
//! A case is named by its folder, by a file `*.foam` in it, or by its `system/controlDict`. Steps are the folders whose
//! names are numbers. The mesh of a time is the last that was written until then (`TIME/polyMesh`). Fields of cells
//! and of points are arrays; values on patches serve means of cell values at points. Cell zones are blocks, and so are
//! regions, each with a mesh of its own in `constant/REGION/polyMesh`.

mod cells;
mod entries;
mod faces;
mod field;
mod file;
mod patches;
mod patterns;

use self::cells::{CellSelection, CellZones, FaceCells, FaceOwners, MeshPaths};
use self::field::Field;
use self::file::{CollatedPart, FoamFile, existing, misfit, names};
use self::patches::MeshBoundary;
use super::blocks::selected;
use super::contents::{CellBlocks, Compute, Dataset, Piece, PieceArray};
use super::lazy::geometry;
use super::request::{Request, list};
use super::source::Source;
use glam::DVec3;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError};
use voltet_core::grid::{Association, Cells};
use voltet_core::{Error, Result, counted};

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
    !regions(folder).is_empty()
}

/// Names of the regions with a mesh, that of the case itself, without a name, first.
fn regions(folder: &Path) -> Vec<String> {
    let constant = folder.join("constant");
    let own = std::iter::once(String::new()).chain(names(&constant));
    own.filter(|region| existing(&constant.join(region).join("polyMesh/faces")).is_some()).collect()
}

/// A folder with a mesh and times: of the case, or of one of its processors.
struct CaseFolder {
    folder: PathBuf,
    /// Times in ascending order and the names of their folders.
    times: Arc<Vec<(f64, String)>>,
    /// The processor, where the folder is that of several.
    part: Option<CollatedPart>,
}

impl CaseFolder {
    fn of_folder(folder: PathBuf) -> CaseFolder {
        let mut times: Vec<(f64, String)> = names(&folder)
            .into_iter()
            .filter(|name| folder.join(name).is_dir())
            .filter_map(|name| Some((name.parse().ok().filter(|time: &f64| time.is_finite())?, name)))
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        CaseFolder { folder, times: Arc::new(times), part: None }
    }

    /// The file of a region's mesh that was written last until a time.
    fn mesh_file(&self, region: &str, name: &str, time: f64) -> Option<PathBuf> {
        let until = self.times.iter().rev().filter(|step| step.0 <= time).map(|step| step.1.as_str());
        let mut folders = until.chain(["constant"]);
        let path = |folder: &str| self.folder.join(folder).join(region).join("polyMesh").join(name);
        folders.find_map(|folder| existing(&path(folder)))
    }

    fn mesh(&self, region: &str, time: f64) -> Result<MeshPaths> {
        let file = |name: &str| {
            self.mesh_file(region, name, time).ok_or_else(|| {
                let wanted = self.folder.join("constant").join(region).join("polyMesh").join(name);
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
            zones: self.mesh_file(region, "cellZones", time),
            boundary: self.mesh_file(region, "boundary", time),
            part: self.part.clone(),
        })
    }
}

/// A folder `processors4`, or `processors4_2-3` for some of them, whose files are of all these processors.
struct CollatedFolder {
    name: String,
    /// Number of the case's processors.
    count: usize,
    own: Range<usize>,
}

impl CollatedFolder {
    /// `None` for other names.
    fn of_name(name: String) -> Option<CollatedFolder> {
        let number = |text: &str| {
            let is_number = text.bytes().all(|byte| byte.is_ascii_digit());
            text.parse::<usize>().ok().filter(|_| is_number)
        };
        let numbers = name.strip_prefix("processors")?;
        let (count, own) = match numbers.split_once('_') {
            None => (number(numbers)?, 0..number(numbers)?),
            Some((count, range)) => {
                let (first, last) = range.split_once('-')?;
                (number(count)?, number(first)?..number(last)?.checked_add(1)?)
            }
        };
        Some(CollatedFolder { name, count, own })
    }
}

/// The processors of such folders. Errors: they are not each in one of them, or their files have others.
fn collated(folder: &Path, folders: &[CollatedFolder]) -> Result<Vec<CaseFolder>> {
    let ends = std::iter::once(0).chain(folders.iter().map(|own| own.own.end));
    let count = folders.first().map_or(0, |first| first.count);
    let follows = |(own, end): (&CollatedFolder, usize)| {
        own.own.start == end && own.own.end > end && own.count == count
    };
    if !folders.iter().zip(ends).all(follows) || folders.last().is_none_or(|last| last.own.end != count) {
        let names: Vec<&str> = folders.iter().map(|own| own.name.as_str()).collect();
        return Err(Error::run("the folders of the processors do not hold each of them once")
            .got(names.join(", "))
            .expected("folders of one number of processors, each from 0 on in one of them")
            .in_file(folder));
    }
    let mut parts = Vec::new();
    for CollatedFolder { name, own, .. } in folders {
        let (whole, known) = (CaseFolder::of_folder(folder.join(name)), Arc::default());
        let own_count = own.len();
        let part = |place: usize| {
            let part = Some(CollatedPart { place, known: Arc::clone(&known) });
            CaseFolder { folder: whole.folder.clone(), times: whole.times.clone(), part }
        };
        // The name alone does not say how many there are.
        let region = regions(&whole.folder).into_iter().next().unwrap_or_default();
        let points = part(own_count - 1).mesh(&region, f64::INFINITY)?;
        FoamFile::open(&points.points, points.part.as_ref(), true)?;
        let lock = known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock.get(&points.points).map_or(1, |file| file.parts.len());
        drop(lock);
        if found != own_count {
            return Err(misfit("parts", found, format!("{own_count}, as '{name}' says"), &points.points));
        }
        parts.extend((0..own_count).map(part));
    }
    Ok(parts)
}

/// The folders that are read: of the case, or those of its processors where it has no mesh or later times there.
fn parts(folder: &Path) -> Result<(Vec<CaseFolder>, bool)> {
    let whole = CaseFolder::of_folder(folder.to_owned());
    let number = |name: &String| name.strip_prefix("processor").and_then(|number| number.parse::<u32>().ok());
    let mut processors: Vec<String> =
        names(folder).into_iter().filter(|name| number(name).is_some()).collect();
    processors.sort_by_key(number);
    let mut processors: Vec<CaseFolder> =
        processors.iter().map(|name| CaseFolder::of_folder(folder.join(name))).collect();
    let mut of_several = Vec::new();
    if processors.is_empty() {
        of_several = names(folder).into_iter().filter_map(CollatedFolder::of_name).collect();
        of_several.sort_by_key(|own: &CollatedFolder| own.own.start);
        processors = of_several.iter().map(|own| CaseFolder::of_folder(folder.join(&own.name))).collect();
    }
    let last = |part: &CaseFolder| part.times.last().map(|step| step.0);
    let has_later = processors.first().is_some_and(|first| last(first) > last(&whole));
    match (has_mesh(folder), processors.is_empty()) {
        (true, true) => Ok((vec![whole], false)),
        (true, false) if !has_later => Ok((vec![whole], false)),
        (has_mesh, false) if of_several.is_empty() => Ok((processors, has_mesh)),
        (has_mesh, false) => Ok((collated(folder, &of_several)?, has_mesh)),
        (false, true) => Err(Error::run("the case of OpenFOAM has no mesh").in_file(folder).expected(
            "constant/polyMesh, constant/REGION/polyMesh, or processor0, … or processorsN with such",
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
    let regions = regions(&parts[0].folder);
    let CaseMeshes { meshes, blocks, is_selected, warning } =
        CaseMeshes::open(&parts, &regions, time, request)?;
    dataset.has_blocks = has_blocks(&regions);
    dataset.blocks = blocks;
    dataset.warnings.extend(warning);
    for (part, region, mesh, blocks) in meshes {
        let (part, region) = (&parts[part].folder, &regions[region]);
        let place = |zone: &String| {
            let mut names = dataset.blocks[blocks.clone()].iter();
            names.position(|block| *block == in_region(region, zone)).map_or(0, |place| blocks.start + place)
        };
        let selection = CellSelection {
            blocks: mesh.zones.names.iter().map(place).collect(),
            rest: blocks.end.saturating_sub(1),
            is_selected: is_selected.clone(),
            zones: mesh.zones,
        };
        if dataset.has_blocks && !is_selected[blocks.clone()].contains(&true) {
            continue;
        }
        let folder = name.map(|name| part.join(name).join(region));
        let counts = [mesh.point_count, mesh.cell_count];
        let mut own = piece(mesh.paths, counts, folder, selection, &mut dataset.file_bytes)?;
        if let CellBlocks::Each { grid, .. } = &mut own.blocks {
            *grid = dataset.has_blocks.then_some(blocks.start);
        }
        dataset.pieces.push(own);
    }
    let region = regions.first().map_or("", String::as_str);
    let head = FoamFile::open(&parts[0].mesh(region, f64::INFINITY)?.points, parts[0].part.as_ref(), true)?;
    let encoding = if head.binary.is_some() { "binary" } else { "ASCII" };
    dataset.format = match parts.len() {
        1 => format!("OpenFOAM, {encoding}"),
        count => format!("OpenFOAM, {encoding}, {}", counted(count, "processor")),
    };
    Ok((dataset, head.source))
}

/// True if the cells of a case have blocks: a mesh without a name among others has one, too.
fn has_blocks(regions: &[String]) -> bool {
    regions.len() > 1 || regions.iter().any(|region| !region.is_empty())
}

/// Meshes of a case at a time, and the blocks that are read.
struct CaseMeshes {
    /// Numbers of part and region, the mesh, and its blocks.
    meshes: Vec<(usize, usize, FolderMesh, Range<usize>)>,
    blocks: Vec<String>,
    is_selected: Vec<bool>,
    warning: Option<String>,
}

impl CaseMeshes {
    fn open(parts: &[CaseFolder], regions: &[String], time: f64, request: &Request) -> Result<CaseMeshes> {
        let (mut meshes, mut blocks, mut cell_counts) = (Vec::new(), Vec::new(), Vec::new());
        for (number, region) in regions.iter().enumerate() {
            let of_parts = parts.iter().map(|part| FolderMesh::open(part, region, time));
            let of_region: Vec<FolderMesh> = of_parts.collect::<Result<_>>()?;
            cell_counts.push(of_region.iter().map(|mesh| mesh.cell_count).fold(0, u64::saturating_add));
            let first = blocks.len();
            blocks.extend(block_names(&of_region, region, has_blocks(regions)));
            let of_parts = of_region.into_iter().enumerate();
            meshes.extend(of_parts.map(|(part, mesh)| (part, number, mesh, first..blocks.len())));
        }
        let mut is_selected = selected(&blocks, request)?;
        let reason =
            request.blocks.is_empty().then(|| reason_of_split(&parts[0], regions, &cell_counts)).flatten();
        let warning = reason.map(|reason| {
            let own = meshes.first().map_or(0..0, |own| own.3.clone());
            is_selected[own.clone()].fill(false);
            let names = list(blocks[own].iter().map(String::as_str));
            format!(
                "The mesh in constant/polyMesh is left out as that of the case before it was split into regions: {reason}. \
                 The parameter blocks reads it by name: {names}."
            )
        });
        Ok(CaseMeshes { meshes, blocks, is_selected, warning })
    }

    fn reads(&self, region: usize) -> bool {
        let mut own = self.meshes.iter().filter(|mesh| mesh.1 == region);
        own.any(|mesh| mesh.3.is_empty() || self.is_selected[mesh.3.clone()].contains(&true))
    }
}

/// The reason why the mesh without a name beside those of regions is that of all of them, before the case was split; `None`: it is a
/// mesh of its own. Splitting leaves it where it was, and no solver goes on with it.
fn reason_of_split(part: &CaseFolder, regions: &[String], cell_counts: &[u64]) -> Option<String> {
    let ((own, others), (count, counts)) = (regions.split_first()?, cell_counts.split_first()?);
    if !own.is_empty() || others.is_empty() {
        return None;
    }
    // The first time has the fields from before the split; where it is the only one, those that there are.
    let has_later = part.times.len() > 1;
    let later = part.times.iter().skip(usize::from(has_later)).map(|step| part.folder.join(&step.1));
    let later: Vec<PathBuf> = later.collect();
    let has_fields = |region: &String| {
        let mut folders = later.iter().rev().map(|folder| folder.join(region));
        folders.any(|folder| Field::in_folder(&folder, part.part.as_ref()).next().is_some())
    };
    let is_sum = counts.iter().copied().fold(0, u64::saturating_add) == *count;
    // One other region may have as many cells by chance.
    let has_own = !(is_sum && others.len() > 1) && has_fields(own);
    match is_sum {
        _ if has_own => None,
        true => Some(format!("it has as many cells as they together, {count}")),
        false => (has_later && others.iter().any(has_fields))
            .then(|| "no time but the first has fields of it".to_owned()),
    }
}

/// Number of cells that the file of owners notes, or else that its numbers show.
fn cell_count(mesh: &MeshPaths) -> Result<u64> {
    let head = FoamFile::open(&mesh.owner, mesh.part.as_ref(), true)?;
    let noted = head.note.split("nCells:").nth(1).and_then(|rest| rest.split_whitespace().next());
    match noted.and_then(|word| word.parse().ok()) {
        Some(count) => Ok(count),
        None => FaceOwners::read(mesh).map(|own| own.cell_count as u64),
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
    fn open(part: &CaseFolder, region: &str, time: f64) -> Result<FolderMesh> {
        let paths = part.mesh(region, time)?;
        let head = FoamFile::open(&paths.points, paths.part.as_ref(), true)?.list_head();
        let (point_count, _) = head.map_err(|error| error.in_file(&paths.points))?;
        let cell_count = cell_count(&paths)?;
        let zones = CellZones::read(&paths, cell_count)?;
        Ok(FolderMesh { paths, point_count, cell_count, zones })
    }
}

/// Name of the block of cells in no zone, where there are zones.
const NO_ZONE: &str = "no zone";

/// Name of the block of a case's own mesh beside those of regions.
const OWN_REGION: &str = "region0";

fn in_region(region: &str, zone: &str) -> String {
    if region.is_empty() { zone.to_owned() } else { format!("{region}/{zone}") }
}

/// Names of the zones of all parts of a region; that of the region, or none where it is the only one, if it has no zones.
fn block_names(meshes: &[FolderMesh], region: &str, is_among_others: bool) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    for name in meshes.iter().flat_map(|mesh| &mesh.zones.names).map(|zone| in_region(region, zone)) {
        if !blocks.contains(&name) {
            blocks.push(name);
        }
    }
    if !blocks.is_empty() && meshes.iter().any(|mesh| mesh.zones.rest(mesh.cell_count) > 0) {
        blocks.push(in_region(region, NO_ZONE));
    }
    if blocks.is_empty() && is_among_others {
        blocks.push(if region.is_empty() { OWN_REGION } else { region }.to_owned());
    }
    blocks
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
    let boundary = MeshBoundary::of_mesh(&mesh);
    let mut arrays = Vec::new();
    if let Some(folder) = folder {
        for field in Field::in_folder(&folder, mesh.part.as_ref()) {
            let field = field?;
            *file_bytes += field.source.len();
            arrays.push(match field.association {
                Association::Point => field.array(point_count, None),
                Association::Cell => {
                    let at_boundary = boundary.clone().map(|own| field.at_boundary(own, &mesh, &selection));
                    let selection = (!selection.is_all()).then(|| (selection.clone(), selected_count));
                    PieceArray { boundary: at_boundary, ..field.array(cell_count, selection) }
                }
            });
        }
    }
    for path in [&mesh.points, &mesh.faces, &mesh.owner, &mesh.neighbour]
        .into_iter()
        .chain(&mesh.zones)
        .chain(&mesh.boundary)
    {
        *file_bytes += std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    }
    // Hexahedra, which are most cells of most meshes, have eight corners.
    let counts = [point_count, selected_count, selected_count.saturating_mul(8)];
    let of = selection.clone();
    let numbers: Compute = Arc::new(move |_| {
        let cells = (0..cell_count as usize).filter(|&cell| selection.contains(cell));
        Ok(cells.map(|cell| selection.block(cell) as f64).collect())
    });
    let geometry = geometry(counts, move |_| read_mesh(&mesh, cell_count, &of, boundary.as_deref()));
    let piece = Piece::new([point_count, selected_count], geometry, arrays);
    Ok(piece.with_blocks(CellBlocks::Each { numbers, grid: None }))
}

fn read_mesh(
    mesh: &MeshPaths,
    cell_count: u64,
    selection: &CellSelection,
    boundary: Option<&MeshBoundary>,
) -> Result<(Vec<DVec3>, Cells)> {
    let read_points = || FoamFile::read(&mesh.points, mesh.part.as_ref(), FoamFile::points);
    let read_cells = || {
        let faces = FaceCells::read(mesh)?;
        if faces.cell_count as u64 != cell_count {
            let noted = format!("{cell_count}, as it notes");
            return Err(misfit("cells", faces.cell_count, noted, &mesh.owner));
        }
        if let Some(boundary) = boundary {
            boundary.keep(&faces);
        }
        Ok(faces.cells(selection))
    };
    // Few tasks sort the faces by cells; points are read beside them.
    let (coordinates, cells) = rayon::join(read_points, read_cells);
    let copied = |(_, numbers): (_, Vec<f64>)| bytemuck::cast_slice(&numbers).to_vec();
    Ok((bytemuck::try_cast_vec(coordinates?).unwrap_or_else(copied), cells?))
}

/// The files of a case that reading it opens, of every time or of that asked for; none for other paths.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let Some(folder) = case_folder(path) else { return Vec::new() };
    let parts = parts(&folder).map_or(Vec::new(), |found| found.0);
    let mut files = Vec::new();
    let regions = parts.first().map_or(Vec::new(), |first| regions(&first.folder));
    let time_of = |request: &Request| {
        let times: Vec<f64> = parts.first()?.times.iter().map(|step| step.0).collect();
        if times.is_empty() { Some(f64::INFINITY) } else { Some(times[request.step_index(&times).ok()?]) }
    };
    // All of a case whose selection is an error are those of the reading that tells it.
    let meshes = request
        .filter(|_| regions.len() > 1)
        .and_then(|request| CaseMeshes::open(&parts, &regions, time_of(request)?, request).ok());
    let is_read = |number| meshes.as_ref().is_none_or(|meshes| meshes.reads(number));
    let is_read: Vec<bool> = (0..regions.len()).map(is_read).collect();
    let of_part = |part| regions.iter().zip(&is_read).map(move |(region, &is_read)| (part, region, is_read));
    for (part, region, is_read) in parts.iter().flat_map(of_part) {
        let times: Vec<f64> = part.times.iter().map(|step| step.0).collect();
        let index = request.filter(|_| !times.is_empty()).and_then(|request| request.step_index(&times).ok());
        let time = index.map(|index| times[index]);
        let of_time = part.times.iter().filter(|step| is_read && time.is_none_or(|time| time == step.0));
        let folders = of_time.map(|step| part.folder.join(&step.1).join(region));
        for folder in folders {
            files.extend(
                names(&folder).into_iter().map(|name| folder.join(name)).filter(|file| file.is_file()),
            );
        }
        let times: Vec<f64> = match time {
            Some(time) => vec![time],
            None => times.into_iter().chain([f64::INFINITY]).collect(),
        };
        for mesh in times.into_iter().filter_map(|time| part.mesh(region, time).ok()) {
            // The size of every mesh and its zones are read.
            files.extend([mesh.points, mesh.owner].into_iter().chain(mesh.zones));
            if is_read {
                files.extend([mesh.faces, mesh.neighbour].into_iter().chain(mesh.boundary));
            }
        }
    }
    files.sort();
    files.dedup();
    files
}
