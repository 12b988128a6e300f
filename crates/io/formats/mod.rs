//! File formats: what the `reader` node and `voltet info` read.
//!
//! | format | module |
//! | --- | --- |
//! | .vtu .vts .vtr .vti, .pvtu .pvts .pvtr .pvti, .vtm .vtpc .vtpd .vthb, .htg, .pvd | [`xml`] |
//! | .vtk (legacy 2.0 to 5.1, ASCII and binary) | [`legacy`] |
//! | .vtu.series, .vtk.series | [`series`] |
//! | .vtkhdf, .hdf | [`vtkhdf`], by [`hdf5`] |
//! | .cgns | [`cgns`], by [`hdf5`] |
//! | .xdmf, .xmf | [`xdmf`] |
//! | .e .exo .ex2 .g | [`exodus`], by [`netcdf`] or [`hdf5`] |
//! | meshes of Gmsh (.msh) | [`gmsh`] |
//! | meshes and collections of MFEM (.mesh, .mfem_root) | [`mfem`] |
//! | cases of OpenFOAM | [`foam`] |
//! | cases of EnSight Gold (.case) | [`ensight`] |
//! | Tecplot, text and binary (.dat, .plt) | [`tecplot`] |
//! | AVS UCD (.inp, .ucd) | [`ucd`] |
//! | meshes of Abaqus (.inp), SU2 (.su2), Nastran (.bdf) | [`abaqus`], [`su2`], [`nastran`] |
//! | PLOT3D grid and solution | [`plot3d`] |
//!
//! Every format is turned into the same table of contents first ([`contents`]: counts, geometry, and for each array its
//! type and where its bytes lie), without decoding anything. What a [`Request`] asks for is then decoded in
//! parallel straight into its destination ([`codec`], [`decode`]) and put together ([`assemble`]).
//! The format is told by the content of the file, not by its name; PLOT3D, which has no magic, by its name or by a
//! solution file being given. A further format is a module that gives a [`Dataset`] and declares a
//! [`Format`], and a line in `FORMATS`.
//!
//! Nothing is allocated because a header says so: a size is believed only after the bytes that back it were found
//! in the file (with compression, after the greatest ratio that the codec can reach was applied).
//!
//! Legacy files are read here and not through vtkio, because guarding it (it panics and allocates on damaged
//! files, decodes every array, drops the line numbers) would take more code than reading the format; vtkio serves
//! the tests as an independent writer.

mod abaqus;
mod adaptive;
mod amr;
mod assemble;
mod blocks;
mod cells;
mod cgns;
mod codec;
mod contents;
mod cursor;
mod decode;
mod elements;
mod ensight;
mod exodus;
mod foam;
mod gmsh;
mod hdf5;
mod hdf5_chunks;
mod hdf5_files;
mod hdf5_heaps;
mod hdf5_views;
mod hdf5_virtual;
mod header_sizes;
#[cfg(test)]
mod heads_tests;
mod hexahedra;
mod hyper_tree;
mod inspect;
mod large_pages;
mod lattice;
mod lazy;
mod legacy;
mod mfem;
mod named_files;
mod nastran;
mod netcdf;
mod node_orders;
mod numbers;
mod outline;
mod parts;
mod piece_share;
mod plot3d;
mod quantities;
mod request;
mod series;
mod source;
mod su2;
mod surfaces;
mod tagged;
mod tecplot;
mod text;
mod ucd;
mod units;
mod unsupported;
mod vectors;
mod vtkhdf;
mod xdmf;
mod xml;
mod xz;

pub use assemble::SkippedArray;
pub use blocks::blocks_named;
pub use cells::face_stream;
pub use contents::BLOCK;
pub use elements::{SurfaceColors, SurfaceFile};
pub use inspect::{ArraySummary, BlockSummary, Summary};
pub use outline::Outline;
pub use parts::PieceBorders;
pub use quantities::{ArrayChoice, differ};
pub use request::{Component, Request, SelectedArrays, TimeStep, list as quoted_names, shortened};
pub use surfaces::{SURFACE_FILES, read_surface};
pub use vectors::length;
pub use voltet_core::grid::{Association, CellValues, Options};
pub use voltet_core::reading::FileArray;

use crate::memory::GridSize;
use contents::{Dataset, Piece};
use piece_share::Share;
use request::Format;
use source::{HEAD, Source, file_beside, has_same_ending, printable, text_of};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Grid;
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::{Error, Result, counted};
use voltet_graph::ranks::Ranks;

/// Reads a grid and the arrays that `request` names.
///
/// # Errors
/// One error that names the file, the array or element, what was found and what would be right.
pub fn read(path: &Path, request: &Request, progress: &dyn Progress) -> Result<Grid> {
    let dataset = open(path, request)?;
    assemble::assemble(&dataset, request, progress).map_err(|error| error.in_file(path))
}

/// Sizes of the grids that a file's pieces become, about, by headers alone; in order, pieces without cells included.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn piece_sizes(path: &Path, request: &Request) -> Result<Vec<GridSize>> {
    Ok(header_sizes::sizes(&open(path, request)?))
}

/// Borders between a file's pieces, for [`read_part`] with the same request. `layers` of cells around a part serve it as ghosts: for
/// gradients as many as the filter looks at rings of neighbours; where values on cells become means at points, there is one more. `first`: the
/// pieces that are read first, together, which are kept until then; where they are all of this process, it reads them in no other
/// way. Of the others, read one after the other, what is near the borders is kept. `share`: the pieces that this process reads, of
/// the several that call this together, and the others, which it exchanges the borders with; `None`: it reads all pieces.
///
/// # Errors
/// As [`read`], but for what shows only when the grid is built.
pub fn piece_borders(
    path: &Path,
    request: &Request,
    layers: usize,
    first: &[usize],
    share: Option<(&[usize], &dyn Ranks)>,
    progress: &dyn Progress,
) -> Result<PieceBorders> {
    let dataset = open(path, request)?;
    parts::borders(&dataset, request, (layers, first), &Share::new(share), progress)
        .map_err(|error| error.in_file(path))
}

/// Reads some of a file's pieces as a grid that has at its cells what the grid of all has there: the same tetrahedra, values and
/// gradients. Cells of other pieces around them are [`Grid::ghosts`]. `None` where no cell of these pieces is drawn.
///
/// Numbers of cells count in the part; [`Grid::origin`] is of its own cells, but for sentences about the file.
///
/// # Errors
/// As [`read`]; a piece that the file does not have.
pub fn read_part(
    path: &Path,
    request: &Request,
    pieces: &[usize],
    borders: &PieceBorders,
    progress: &dyn Progress,
) -> Result<Option<Grid>> {
    let dataset = open(path, request)?;
    parts::read(&dataset, request, pieces, borders, progress).map_err(|error| error.in_file(path))
}

/// Arrays that [`read`] would not decode for this request, and how many numbers they hold. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn unread(path: &Path, request: &Request) -> Result<SkippedArray> {
    TableOfContents::open(path, request)?.unread(request)
}

/// The arrays of a file, each once, the points' first. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn arrays(path: &Path, request: &Request) -> Result<Vec<FileArray>> {
    Ok(inspect::array_heads(&open(path, request)?))
}

/// Arrays, blocks and time steps of a file. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn outline(path: &Path, request: &Request) -> Result<Outline> {
    Ok(outline::outline(&open(path, request)?))
}

/// Reads everything that a file holds, one array at a time, and says what it is.
///
/// # Errors
/// As [`read`]; a file without three-dimensional cells or without arrays is no error here.
pub fn inspect(path: &Path, request: &Request, progress: &dyn Progress) -> Result<Summary> {
    TableOfContents::open(path, request)?.inspect(request.association, progress)
}

/// Table of contents of a file that is opened once for several of the functions here.
pub struct TableOfContents {
    path: PathBuf,
    dataset: Dataset,
}

impl TableOfContents {
    /// Reads headers alone.
    pub fn open(path: &Path, request: &Request) -> Result<TableOfContents> {
        Ok(TableOfContents { path: path.to_owned(), dataset: open(path, request)? })
    }

    /// As [`inspect()`].
    pub fn inspect(&self, association: Option<Association>, progress: &dyn Progress) -> Result<Summary> {
        // A thread of the pool need not wait for another one at each of a hundred thousand small arrays.
        let summarize = || inspect::summarize(&self.dataset, association, progress);
        rayon::scope(|_| summarize()).map_err(|error| error.in_file(&self.path))
    }

    /// As [`unread`], for other arrays than those of the request that the file was opened with.
    pub fn unread(&self, request: &Request) -> Result<SkippedArray> {
        let choices = assemble::choices(&self.dataset, request)?;
        assemble::unread(&self.dataset, &choices).map_err(|error| error.in_file(&self.path))
    }
}

/// The times of a file's steps, none where it is no series, and the number of the step that `request` means; 0 where it
/// means none that is there. Reads headers alone.
///
/// # Errors
/// As [`read`], as far as headers show them.
pub fn steps(path: &Path, request: &Request) -> Result<(Vec<f64>, usize)> {
    let times = open(path, &Request { time_step: None, ..request.clone() })?.time_steps;
    let own = if times.is_empty() { 0 } else { request.step_index(&times).unwrap_or(0) };
    Ok((times, own))
}

/// The files that reading a data file may open beside it: those that a series or a parallel file names, the solution beside
/// a PLOT3D grid, those of a case. What cannot be read names none.
pub fn files_beside(path: &Path) -> Vec<PathBuf> {
    let solution = Some(path.with_extension("q")).filter(|solution| solution != path && solution.is_file());
    files_named(path, None).into_iter().chain(solution).collect()
}

/// Further files that reading for this request opens: of a series the files of one step.
pub fn files_read_beside(path: &Path, request: &Request) -> Vec<PathBuf> {
    files_named(path, Some(request)).into_iter().chain(plot3d::solution_beside(path, request)).collect()
}

/// Files that a data file names, of all steps or of those that a request asks for.
fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let own = request.cloned().unwrap_or_default();
    [xml::files_named, series::files_named, xdmf::files_named, foam::files_named, ensight::files_named]
        .into_iter()
        .flat_map(|named| named(path, request))
        .chain(files_linked(path, &own))
        .chain(exodus::parts_beside(path))
        .chain(mfem::files_named(path, &own))
        .chain(abaqus::files_named(path))
        .chain(nastran::files_named(path))
        .collect()
}

/// Files that external links of a file in HDF5 lead to; none for other files.
fn files_linked(path: &Path, request: &Request) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, |head| (HDF5.matches)(head, path, request)) else {
        return Vec::new();
    };
    let Ok(root) = hdf5::Group::root(source.clone()) else { return Vec::new() };
    // Links are followed by reading; one that is damaged is an error of the reading itself.
    let _ = read_hdf5(&root, request);
    root.linked_files()
}

/// The formats, in the order in which a file is tried as one of them.
const FORMATS: &[Format] = &[
    xdmf::FORMAT,
    xml::FORMAT,
    legacy::FORMAT,
    SERIES,
    HDF5,
    exodus::FORMAT,
    gmsh::FORMAT,
    mfem::FORMAT,
    ensight::FORMAT,
    tecplot::BINARY,
    tecplot::TEXT,
    ucd::FORMAT,
    abaqus::FORMAT,
    su2::FORMAT,
    nastran::FORMAT,
    plot3d::FORMAT,
];

/// A clause for an error's `expected` where there is no data file at `path`: the one beside it that was meant, if any.
pub fn existing_file(path: &Path) -> String {
    let request = Request::default();
    let is_data = |file: &Path| {
        let matches = |head: &[u8]| FORMATS.iter().any(|format| (format.matches)(head, file, &request));
        file.is_file() && Source::open_if(file, matches).is_some()
    };
    file_beside(path, |file| has_same_ending(path, file) || is_data(file))
}

/// The declaration of series of files, each of any format.
const SERIES: Format = Format {
    files: "a series of files (.vtu.series, .vtk.series)",
    matches: |head, path, _| series::is_series(head, path),
    open: |source, request| {
        let series::SeriesStep { path, times } = series::step(&source, request)?;
        let (dataset, _) = open_contents(&path, &Request { time_step: None, ..request.clone() })?;
        let format = format!("series of {}; {}", counted(times.len(), "file"), dataset.format);
        Ok(Dataset { format, time_steps: times, ..dataset })
    },
    has_solution: false,
};

/// The declaration of the formats in HDF5.
const HDF5: Format = Format {
    files: "a VTKHDF (.vtkhdf, .hdf), CGNS or Exodus II file in HDF5",
    matches: |head, _, _| head.starts_with(unsupported::HDF5_MAGIC),
    open: open_hdf5,
    has_solution: false,
};

/// Reader of a format in HDF5.
type Hdf5Reader = fn(&hdf5::Group, &Request) -> Result<Dataset>;

/// The formats in HDF5, each told by a name in the root group.
const IN_HDF5: &[(&str, Hdf5Reader)] =
    &[(vtkhdf::ROOT, vtkhdf::open), (cgns::ROOT, cgns::open), (exodus::ROOT, exodus::open_hdf5)];

/// Reads the table of contents by the format that the names in the root group show.
fn open_hdf5(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    match hdf5::Group::root(source.clone()) {
        Ok(root) => read_hdf5(&root, request),
        Err(error) => unsupported::refuse_damaged_hdf5(&source).and(Err(error)),
    }
}

/// Reads the table of contents from the root group.
fn read_hdf5(root: &hdf5::Group, request: &Request) -> Result<Dataset> {
    let names = root.names()?;
    let is_there = |name: &str| names.iter().any(|own| own == name);
    if let Some((_, open)) = IN_HDF5.iter().find(|(name, _)| is_there(name)) {
        return open(root, request);
    }
    unsupported::refuse_hdf5(is_there)?;
    let first: Vec<&str> = names.iter().take(8).map(String::as_str).collect();
    let found = if first.is_empty() { "nothing".to_owned() } else { first.join(", ") };
    Err(Error::run("the file is HDF5, but of no format that is read")
        .got(format_args!("{found} in the root group"))
        .expected(unsupported::HDF5))
}

/// File types of the reader, for its help.
pub const FILES: &str = "VTK, VTKHDF, Exodus II, OpenFOAM (folder), CGNS, XDMF, Gmsh, MFEM, EnSight, Tecplot, UCD, Abaqus, SU2, Nastran, PLOT3D";

/// File types of several formats, in one phrase.
fn files(mut formats: impl Iterator<Item = &'static Format>) -> String {
    let first = formats.next().map_or(String::new(), |format| format.files.to_string());
    formats.fold(first, |phrase, format| phrase + " or " + format.files)
}

/// Reads the table of contents of a file by the format that it shows; what is asked for but cannot be of such a file is an
/// error.
fn open(path: &Path, request: &Request) -> Result<Dataset> {
    let (mut dataset, source) = open_contents(path, request)?;
    blocks::number_cells(&mut dataset, request, &source).map_err(|error| error.in_file(path))?;
    // What holds for many blocks is said once.
    let mut said = HashSet::new();
    dataset.warnings.retain(|sentence| said.insert(sentence.clone()));
    Ok(dataset)
}

/// The table of contents before blocks are numbered, and the file.
fn open_contents(path: &Path, request: &Request) -> Result<(Dataset, Arc<Source>)> {
    if let Some(folder) = foam::case_folder(path).filter(|_| request.chosen.is_none()) {
        return foam::open(&folder, request).map_err(|error| error.in_file(path));
    }
    let in_file = |error: Error| error.in_file(path);
    unsupported::refuse_folder(path).map_err(in_file)?;
    let source = Source::open(path)?;
    if let Some(chosen) = &request.chosen {
        let dataset = open_external(&source, request, chosen).map_err(in_file)?;
        let dataset = refuse_no_series(dataset, request, "a file that is a series, or no time step");
        return dataset.map(|dataset| (dataset, source.clone())).map_err(in_file);
    }
    unsupported::refuse(&source, unsupported::BY_MAGIC).map_err(in_file)?;
    let head = source.head(HEAD).map_err(in_file)?;
    let Some(format) = format_of(&head, path, request) else {
        unsupported::refuse(&source, unsupported::BY_WORDS).map_err(in_file)?;
        let error = Error::run("the format of the file is not known").got(printable(&head));
        let formats = files(FORMATS.iter());
        return Err(in_file(error.expected(format!("{formats}; or the format of a plug-in (--plugin)"))));
    };
    let dataset = (format.open)(source.clone(), request).map_err(in_file)?;
    let dataset = refuse_no_series(
        dataset,
        request,
        "a series (.pvd, .vtu.series, .vtk.series, or a file with TimeValues), or no time step",
    )
    .map_err(in_file)?;
    if request.solution.is_some() && !format.has_solution {
        let with = files(FORMATS.iter().filter(|format| format.has_solution));
        return Err(in_file(
            Error::run("a solution is named, but the grid is of a format without")
                .got(&dataset.format)
                .expected(format!("{with}, or no solution")),
        ));
    }
    Ok((dataset, source))
}

/// True if a file shows that it is of a format that ships.
pub fn is_data(path: &Path) -> bool {
    let is_of_format = |head: &[u8]| format_of(head, path, &Request::default()).is_some();
    foam::case_folder(path).is_some() || path.is_file() && Source::open_if(path, is_of_format).is_some()
}

/// First bytes of a file whose first few are of no format that ships; `None` for one that is, or that cannot be read. Words further behind
/// are read as a format that ships only where no reader from outside takes the file.
pub fn foreign_head(path: &Path) -> Option<Vec<u8>> {
    // A pipe can be read once.
    let head = path.is_file().then(|| Source::open(path).and_then(|source| source.head(HEAD)))?.ok()?;
    let few = &head[..head.len().min(FEW)];
    format_of(few, path, &Request::default()).is_none().then_some(head)
}

/// Bytes within which a format that ships has to show itself to come before readers from outside.
const FEW: usize = 256;

/// The format that a file shows, by how it begins and its name.
fn format_of(head: &[u8], path: &Path, request: &Request) -> Option<&'static Format> {
    FORMATS.iter().find(|format| (format.matches)(text_of(head), path, request))
}

/// Errors: a step that is none is asked for.
fn refuse_no_series(dataset: Dataset, request: &Request, accepted: &str) -> Result<Dataset> {
    let step = request.time_step.filter(|step| *step != TimeStep::Index(0));
    let Some(step) = step.filter(|_| dataset.time_steps.is_empty()) else { return Ok(dataset) };
    let found = match step {
        TimeStep::Index(index) => format!("step {index}"),
        TimeStep::Time(time) => format!("time {time}"),
    };
    let error = Error::run("a time step is asked for, but the file is no time series");
    Err(error.got(found).expected(accepted))
}

/// Reads the table of contents.
fn open_external(source: &Arc<Source>, request: &Request, chosen: &SelectedArrays) -> Result<Dataset> {
    let SelectedArrays { reader, parameters } = chosen;
    let at = |step: usize| reader.open(source.path(), step, parameters, &NoProgress);
    let mut opened = at(0)?;
    let step = match opened.head().times.as_slice() {
        [] => 0,
        times => request.step_index(times)?,
    };
    if step > 0 {
        opened = at(step)?;
    }
    let head = opened.head().clone();
    Ok(Dataset {
        format: head.format,
        pieces: vec![Piece::of_open(source, opened.into())],
        time_steps: head.times,
        active_scalars: head.scalar,
        file_bytes: source.len(),
        ..Dataset::default()
    })
}
