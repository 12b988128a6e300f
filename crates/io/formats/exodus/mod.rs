//! Exodus II (.e .exo .ex2 .exii .g): element blocks, results at nodes and in elements, time steps, and parallel results of one file a
//! process (`mesh.e.4.0` to `mesh.e.4.3`), which are read together.
//!
//! Source: Exodus II manual (Schoof, Yarberry, SAND92-2137, revision of 2006) and the names of its variables in netCDF. Node
//! `i` of a file is the node `node_num_map[i]` of the whole mesh, element block `i` has the number `eb_prop1[i]` in all files.

mod cells;
mod variables;

use super::blocks;
use super::contents::{CellBlocks, Dataset, Meter, Piece, PieceArray, Stored};
use super::hdf5;
use super::lazy::{geometry, mesh_head};
use super::netcdf;
use super::request::{Format, Request, list};
use super::source::Source;
use super::units;
use super::vectors::{Joined, joined, joined_if};
use cells::{BlockElements, BlockKind, FaceBlock, Mesh};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use variables::Variables;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

/// The declaration of files in netCDF's own form; those in HDF5 are told by [`ROOT`].
pub(super) const FORMAT: Format = Format {
    files: "an Exodus II file (.e, .exo, .g)",
    matches: |head, _, _| netcdf::is_netcdf(head),
    open: |source, request| open(&source, Variables::open(source.clone())?, request),
    has_solution: false,
};

/// Name in the root group of a file in HDF5: a dimension, the number of element blocks.
pub(super) const ROOT: &str = "num_el_blk";

/// Name of the array that numbers the nodes of the whole mesh.
const GLOBAL_IDS: &str = "GlobalNodeId";

/// Reads the table of contents of a file in HDF5.
pub(super) fn open_hdf5(root: &hdf5::Group, request: &Request) -> Result<Dataset> {
    open(root.source(), Variables::of_root(root.clone())?, request)
}

/// Files of the other processes, where a file is that of one, up to the first that is not there: none for others.
pub(super) fn parts_beside(path: &Path) -> Vec<PathBuf> {
    let mut is_there = true;
    let others = parts(path).filter(|part| part != path);
    others.take_while(|part| std::mem::replace(&mut is_there, part.exists())).collect()
}

/// The files of all processes by the name of one, `stem.COUNT.NUMBER`; none for other names.
fn parts(path: &Path) -> impl Iterator<Item = PathBuf> {
    let named = process_file(path);
    let count = named.as_ref().map_or(0, |named| named.count);
    let name = move |part| named.as_ref().map(|named| path.with_file_name(named.of_part(part)));
    (0..count).filter_map(name)
}

/// Parts of the name that a file of one of several processes has.
struct ProcessName {
    /// Name before the number of the process.
    stem: String,
    count: usize,
    /// Digits of the number.
    width: usize,
}

impl ProcessName {
    fn of_part(&self, part: usize) -> String {
        format!("{}.{part:0width$}", self.stem, width = self.width)
    }
}

fn process_file(path: &Path) -> Option<ProcessName> {
    let name = path.file_name()?.to_string_lossy();
    let mut words = name.rsplitn(3, '.');
    let (number, count, stem) = (words.next()?, words.next()?, words.next()?);
    let is_exodus = ["e", "exo", "ex2", "exii", "g", "gen", "nem", "e-s", "par"]
        .into_iter()
        .any(|ending| stem.rsplit('.').next().is_some_and(|own| own.eq_ignore_ascii_case(ending)));
    let parsed =
        |word: &str| word.bytes().all(|byte| byte.is_ascii_digit()).then(|| word.parse::<usize>().ok());
    match (parsed(number).flatten(), parsed(count).flatten()) {
        (Some(own), Some(all)) if is_exodus && own < all && (2..=MAX_PARTS).contains(&all) => {
            Some(ProcessName { stem: format!("{stem}.{count}"), count: all, width: number.len() })
        }
        _ => None,
    }
}

/// More files of processes than any folder has.
const MAX_PARTS: usize = 1 << 20;

/// Reads the table of contents of a file, or of those of all processes.
fn open(source: &Arc<Source>, variables: Variables, request: &Request) -> Result<Dataset> {
    let mut first = Some(variables);
    let mut files = Vec::new();
    for (number, path) in parts(source.path()).enumerate() {
        let own = if path == source.path() { first.take() } else { None };
        files.push(match own {
            Some(own) => own,
            None => super::xml::open_named(source.path(), &path, number)
                .and_then(Variables::open)
                .map_err(|error| error.in_file(&path))?,
        });
    }
    files.extend(first);
    let read = |variables: Variables| {
        let path = variables.source().path().to_owned();
        ProcessFile::read(variables).map_err(|error| error.in_file(&path))
    };
    dataset(files.into_iter().map(read).collect::<Result<_>>()?, request)
}

struct ElementBlock {
    /// Its number in all files of a mesh.
    id: i64,
    name: String,
    element_type: String,
    element_count: u64,
    node_count: u64,
}

struct ProcessFile {
    variables: Arc<Variables>,
    node_count: u64,
    blocks: Vec<ElementBlock>,
    times: Vec<f64>,
    /// Names of the results at nodes and in elements.
    of_nodes: Vec<String>,
    of_elements: Vec<String>,
}

impl ProcessFile {
    fn read(variables: Variables) -> Result<ProcessFile> {
        let node_count = match (variables.shape("coordx")?, variables.shape("coord")?) {
            (Some(shape), _) => shape.first().copied(),
            (None, Some(shape)) => shape.get(1).copied(),
            (None, None) => None,
        };
        let node_count = node_count.ok_or_else(|| {
            let error = Error::run("the netCDF file is no Exodus file: it holds no nodes");
            error.expected("the variables coordx, coordy, coordz; ParaView reads other netCDF files and saves them as .vtu")
        })?;
        Ok(ProcessFile {
            node_count,
            blocks: element_blocks(&variables)?,
            times: variables.numbers("time_whole")?,
            of_nodes: variables.texts("name_nod_var")?,
            of_elements: variables.texts("name_elem_var")?,
            variables: Arc::new(variables),
        })
    }
}

fn element_blocks(variables: &Variables) -> Result<Vec<ElementBlock>> {
    let ids: Vec<i64> = variables.numbers("eb_prop1")?;
    let names = variables.texts("eb_names")?;
    let greatest = variables.greatest_of("connect");
    if greatest > ids.len().max(MAX_BLOCKS) {
        let error = Error::run("the file numbers a block beyond those that it lists in eb_prop1");
        return Err(error
            .got(format_args!("connect{greatest}"))
            .expected(format_args!("at most {MAX_BLOCKS}")));
    }
    let count = ids.len().max(greatest);
    let block = |index: usize| {
        let connectivity = format!("connect{}", index + 1);
        // Polyhedra list faces in the place of nodes; these and polygons have a list of counts beside.
        let listed =
            if variables.has(&connectivity) { connectivity } else { format!("facconn{}", index + 1) };
        let shape = variables.shape(&listed)?.unwrap_or_default();
        let counts = variables.shape(&format!("ebepecnt{}", index + 1))?;
        let id = ids.get(index).copied().unwrap_or(index as i64 + 1);
        let name = names.get(index).filter(|name| !name.is_empty());
        Ok(ElementBlock {
            id,
            name: name.cloned().unwrap_or_else(|| format!("block {id}")),
            // A block without elements has no connectivity.
            element_type: match shape.is_empty() {
                true => String::new(),
                false => variables.attribute(&listed, "elem_type")?.unwrap_or_default(),
            },
            element_count: counts.as_ref().unwrap_or(&shape).first().copied().unwrap_or(0),
            node_count: shape.get(1).copied().unwrap_or(1),
        })
    };
    (0..count).map(block).collect()
}

fn face_blocks(variables: &Variables) -> Result<Vec<FaceBlock>> {
    let blocks = 1..=variables.greatest_of("fbconn").min(MAX_BLOCKS);
    let block = |number: usize| {
        let [nodes, counts] = ["fbconn", "fbepecnt"].map(|stem| format!("{stem}{number}"));
        let Some(shape) = variables.shape(&nodes)? else { return Ok(None) };
        let count = shape.get(1).map_or(1, |&count| usize::try_from(count).unwrap_or(usize::MAX));
        Ok(Some(FaceBlock {
            counts: if variables.has(&counts) {
                Some(variables.part(&counts, &[], &counts, 1)?)
            } else {
                None
            },
            nodes: variables.part(&nodes, &[], &nodes, count)?,
        }))
    };
    // A block without faces has no nodes.
    blocks.filter_map(|number| block(number).transpose()).collect()
}

/// Most blocks that a name of a variable may mean by itself.
const MAX_BLOCKS: usize = 1 << 16;

/// Puts the contents of the files of all processes together.
fn dataset(parts: Vec<ProcessFile>, request: &Request) -> Result<Dataset> {
    let mut numbers: HashMap<i64, usize> = HashMap::new();
    let mut dataset = Dataset::default();
    for block in parts.iter().flat_map(|part| &part.blocks) {
        numbers.entry(block.id).or_insert_with(|| {
            dataset.blocks.push(block.name.clone());
            dataset.blocks.len() - 1
        });
    }
    let Some(first) = parts.first() else { return Ok(dataset) };
    if let Some(other) = parts.iter().find(|part| part.times.len() != first.times.len()) {
        let error =
            Error::run("the files of the processes differ in their time steps").got(other.times.len());
        return Err(error.expected(first.times.len()).in_file(other.variables.source().path()));
    }
    dataset.format = format!("Exodus II, {}", first.variables.form());
    if parts.len() > 1 {
        dataset.format += &format!(", {}", counted(parts.len(), "process file"));
        dataset.global_ids = Some(GLOBAL_IDS.to_owned());
    }
    dataset.time_steps = first.times.clone();
    dataset.notes = sets(&first.variables)?;
    let step = match first.times.as_slice() {
        [] => None,
        times => Some(request.step_index(times)? as u64),
    };
    let selected = blocks::selected(&dataset.blocks, request)?;
    let mut incomplete = IncompleteBlocks::default();
    for part in &parts {
        let own = Selection { part, step, is_part: parts.len() > 1, numbers: &numbers, selected: &selected };
        let piece =
            own.piece(&mut incomplete).map_err(|error| error.in_file(part.variables.source().path()))?;
        dataset.pieces.push(piece);
        dataset.file_bytes += part.variables.source().len();
    }
    let IncompleteBlocks { unread, with_more_nodes } = incomplete;
    let unread = unread.iter().map(String::as_str);
    dataset.warnings.extend(blocks::blocks_left_out("of elements that are not read", unread));
    if !with_more_nodes.is_empty() {
        let names = list(with_more_nodes.iter().map(String::as_str));
        let what = "Nodes in faces and in the middle of elements, which VTK's cells lack, are left out";
        dataset.warnings.push(format!("{what} in the blocks {names}."));
    }
    Ok(dataset)
}

/// Sentences about the sets of a file.
fn sets(variables: &Variables) -> Result<Vec<String>> {
    let mut sentences = Vec::new();
    for (kind, names, ids) in [("node set", "ns_names", "ns_prop1"), ("side set", "ss_names", "ss_prop1")] {
        let (names, ids) = (variables.texts(names)?, variables.numbers::<i64>(ids)?);
        let name = |(index, id): (usize, &i64)| match names.get(index).filter(|name| !name.is_empty()) {
            Some(name) => name.clone(),
            None => id.to_string(),
        };
        let named: Vec<String> = ids.iter().enumerate().map(name).collect();
        if !named.is_empty() {
            let names = list(named.iter().map(String::as_str));
            sentences.push(format!("{}: {names}", counted(named.len(), kind)));
        }
    }
    Ok(sentences)
}

/// The blocks of a file that are read, at a step.
struct Selection<'a> {
    part: &'a ProcessFile,
    step: Option<u64>,
    /// True if the file is that of one of several processes.
    is_part: bool,
    /// Number of each block by its number in all files.
    numbers: &'a HashMap<i64, usize>,
    selected: &'a [bool],
}

/// Names of blocks that are not read as they are.
#[derive(Default)]
struct IncompleteBlocks {
    /// Elements of types that are not read.
    unread: BTreeSet<String>,
    /// Volume elements with more nodes than their cells have.
    with_more_nodes: BTreeSet<String>,
}

/// A block that is read: its place in the file, and its elements as cells.
struct ReadBlock<'a> {
    place: usize,
    block: &'a ElementBlock,
    kind: BlockKind,
}

impl Selection<'_> {
    fn number(&self, block: &ElementBlock) -> usize {
        self.numbers.get(&block.id).copied().unwrap_or(0)
    }

    /// The piece of a file; adds the blocks that are not read as they are.
    fn piece(&self, incomplete: &mut IncompleteBlocks) -> Result<Piece> {
        let mut read = Vec::new();
        for (place, block) in self.part.blocks.iter().enumerate() {
            if block.element_count == 0 || self.selected.get(self.number(block)) != Some(&true) {
                continue;
            }
            match BlockKind::of_elements(&block.element_type, block.node_count) {
                Some(kind) => {
                    if kind.lacks_nodes(block.node_count) {
                        incomplete.with_more_nodes.insert(block.name.clone());
                    }
                    read.push(ReadBlock { place, block, kind });
                }
                None => {
                    let kind = format!("{} of {} nodes", block.element_type, block.node_count);
                    incomplete.unread.insert(format!("{} ({kind})", block.name));
                }
            }
        }
        let runs: Vec<(usize, u64)> =
            read.iter().map(|own| (self.number(own.block), own.block.element_count)).collect();
        let cell_count = runs.iter().try_fold(0_u64, |sum, run| sum.checked_add(run.1));
        let cell_count = cell_count.ok_or_else(|| Error::run("the file cannot hold that many elements"))?;
        let mut arrays = self.node_arrays()?;
        arrays.extend(self.element_arrays(&read, cell_count));
        let mesh = self.mesh(&read)?;
        let corners = |own: &ReadBlock| own.block.element_count.saturating_mul(own.kind.node_count());
        let corner_count = read.iter().map(corners).fold(0, u64::saturating_add);
        let counts = [self.part.node_count, cell_count];
        let all = [counts[0], cell_count, corner_count];
        let byte_count = counts[0].saturating_mul(24).saturating_add(mesh_head(all).cell_bytes);
        let geometry = geometry(all, move |progress| mesh.read(byte_count, progress));
        Ok(Piece::new(counts, geometry, arrays).with_blocks(CellBlocks::Runs(runs)))
    }

    fn mesh(&self, read: &[ReadBlock]) -> Result<Mesh> {
        let variables = &self.part.variables;
        let axis = |axis: &'static str| variables.has(axis).then(|| variables.part(axis, &[], axis, 1));
        let coordinates: Result<Vec<Stored>> = match variables.has("coordx") {
            true => ["coordx", "coordy", "coordz"].into_iter().filter_map(axis).collect(),
            false => {
                let axes = variables.shape("coord")?.and_then(|shape| shape.first().copied()).unwrap_or(0);
                (0..axes.min(3)).map(|place| variables.part("coord", &[place], "coord", 1)).collect()
            }
        };
        let coordinates = coordinates?;
        if let Some(wrong) = coordinates.iter().find(|axis| axis.tuple_count != Some(self.part.node_count)) {
            let error =
                Error::run("the axes of the nodes differ in length").got(wrong.tuple_count.unwrap_or(0));
            return Err(error.expected(self.part.node_count).at_item(&wrong.name));
        }
        let elements = |own: &ReadBlock| {
            let part = |stem: &str, components: u64| {
                let name = format!("{stem}{}", own.place + 1);
                variables.part(&name, &[], &name, components as usize)
            };
            Ok(match &own.kind {
                BlockKind::Shape(shape) => BlockElements::Alike {
                    shape: *shape,
                    connectivity: part("connect", own.block.node_count)?,
                },
                BlockKind::Polygons => BlockElements::Polygons {
                    counts: part("ebepecnt", 1)?,
                    connectivity: part("connect", 1)?,
                },
                BlockKind::Polyhedra => {
                    BlockElements::Polyhedra { counts: part("ebepecnt", 1)?, faces: part("facconn", 1)? }
                }
            })
        };
        let has_polyhedra = read.iter().any(|own| matches!(own.kind, BlockKind::Polyhedra));
        let faces = if has_polyhedra { face_blocks(variables)? } else { Vec::new() };
        Ok(Mesh { coordinates, blocks: read.iter().map(elements).collect::<Result<_>>()?, faces })
    }

    /// Results at nodes; of a file of one process also the numbers of the nodes.
    fn node_arrays(&self) -> Result<Vec<PieceArray>> {
        let variables = &self.part.variables;
        let mut arrays = Vec::new();
        if self.is_part && variables.has("node_num_map") {
            let ids = variables.part("node_num_map", &[], GLOBAL_IDS, 1)?;
            arrays.push(PieceArray::new(Association::Point, ids));
        }
        let Some(step) = self.step else { return Ok(arrays) };
        // Older files hold all results at nodes in one variable.
        let is_one = variables.has("vals_nod_var");
        let of_node = |place: usize| {
            let own = format!("vals_nod_var{}", place + 1);
            let name = &self.part.of_nodes[place];
            let stored = match is_one {
                true => variables.part("vals_nod_var", &[step, place as u64], name, 1),
                false => variables.part(&own, &[step], name, 1),
            }?;
            match stored.tuple_count == Some(self.part.node_count) {
                true => Ok(stored),
                false => Err(Error::run("a result has the wrong number of values")
                    .got(stored.tuple_count.unwrap_or(0))
                    .expected(self.part.node_count)
                    .at_item(name)),
            }
        };
        for array in joined(&self.part.of_nodes) {
            let stated = match array.places.first().filter(|_| !is_one) {
                Some(place) => variables.attribute(&format!("vals_nod_var{}", place + 1), "units")?,
                None => None,
            };
            let unit = stated.and_then(|text| units::stated(&text));
            let own = PieceArray::new(Association::Point, array.stored(of_node)?);
            arrays.push(PieceArray { component_names: array.components, unit, ..own });
        }
        Ok(arrays)
    }

    /// Results in elements: those of all blocks one after the other, NaN where a block has none.
    fn element_arrays(&self, read: &[ReadBlock], cell_count: u64) -> Vec<PieceArray> {
        let variables = &self.part.variables;
        let Some(step) = self.step else { return Vec::new() };
        let mut arrays = Vec::new();
        let variable = |block: usize, place: usize| format!("vals_elem_var{}eb{}", place + 1, block + 1);
        let has = |block: usize, place: usize| variables.has(&variable(block, place));
        // A block that has some components alone would lose them in a vector.
        let all_or_none = |places: &[usize; 3]| {
            (0..self.part.blocks.len())
                .all(|block| places.iter().all(|&place| has(block, place) == has(block, places[0])))
        };
        for Joined { name, places, components } in joined_if(&self.part.of_elements, all_or_none) {
            let is_there = |own: &ReadBlock| places.iter().all(|&place| has(own.place, place));
            let blocks: Vec<(u64, Option<Vec<String>>)> = read
                .iter()
                .map(|own| {
                    let names = is_there(own)
                        .then(|| places.iter().map(|&place| variable(own.place, place)).collect());
                    (own.block.element_count, names)
                })
                .collect();
            if blocks.iter().all(|block| block.1.is_none()) && !blocks.is_empty() {
                continue;
            }
            let without =
                read.iter().filter(|own| !is_there(own)).map(|own| self.number(own.block)).collect();
            let (source, count) = (variables.clone(), places.len());
            let compute = move |meter: &Meter| of_blocks(&source, &blocks, step, count, meter);
            let stored = Stored::computed(variables.source(), &name, count, cell_count, compute);
            arrays.push(PieceArray {
                component_names: components,
                blocks_without: without,
                ..PieceArray::new(Association::Cell, stored)
            });
        }
        arrays
    }
}

/// Values of the elements of all blocks, by the counts of elements and the variables of their components.
fn of_blocks(
    variables: &Variables,
    blocks: &[(u64, Option<Vec<String>>)],
    step: u64,
    component_count: usize,
    meter: &Meter,
) -> Result<Vec<f64>> {
    let mut all = Vec::new();
    for (count, names) in blocks {
        let Some(names) = names else {
            all.resize(all.len() + *count as usize * component_count, f64::NAN);
            continue;
        };
        let part = |name: &String| -> Result<Vec<f64>> {
            let stored = variables.part(name, &[step], name, 1)?;
            match stored.tuple_count == Some(*count) {
                true => stored.load(meter),
                false => Err(Error::run("a result has the wrong number of values")
                    .got(stored.tuple_count.unwrap_or(0))
                    .expected(count)
                    .at_item(name)),
            }
        };
        all.extend(interleaved(names.iter().map(part).collect::<Result<_>>()?)?);
    }
    Ok(all)
}

/// Components as tuples.
fn interleaved(mut components: Vec<Vec<f64>>) -> Result<Vec<f64>> {
    if components.len() == 1 {
        return Ok(components.pop().unwrap_or_default());
    }
    let count = components.iter().map(Vec::len).min().unwrap_or(0);
    Ok((0..count).into_par_iter().flat_map_iter(|i| components.iter().map(move |own| own[i])).collect())
}
