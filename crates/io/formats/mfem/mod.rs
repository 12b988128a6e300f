//! Results of MFEM: meshes (`MFEM mesh v1.0`, 1.2 and 1.3) with a grid function, of one process or of several (`mesh.000000` …), and data
//! collections for VisIt (`.mfem_root`).
//!
//! Source: MFEM's documentation, "Mesh Formats" and "General MFEM Mesh Format". A mesh has its nodes, and a field of the second order its
//! values, at the middles of edges, faces and elements, which the file only numbers ([`numbering`]). Where nothing is of the second order,
//! cells are linear. Of higher orders the values at nodes of the second are read ([`orders`]).

mod elements;
mod files;
mod mesh;
mod numbering;
mod orders;
mod shapes;
mod space;

use self::files::{FieldReason, MfemFiles, is_root};
use self::mesh::{Coordinates, MfemMesh, NODES};
use self::numbering::MfemNodes;
use self::orders::ContinuousLayout;
use self::shapes::SHAPES;
use self::space::{FieldSpace, GridFunction};
use super::blocks::selected;
use super::contents::{CellBlocks, Compute, Dataset, Piece, PieceArray, Stored};
use super::cursor::Cursor;
use super::lazy::{geometry, into_cells};
use super::numbers::NumberType;
use super::request::{Format, Request};
use super::source::Source;
use super::unsupported;
use super::xml::open_named;
use glam::DVec3;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::{Association, CellSet, Cells};
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format =
    Format { files: "a mesh of MFEM (.mesh, .mfem_root)", matches, open, has_solution: true };

/// First lines of meshes that are read.
const VERSIONS: [&[u8]; 3] = [b"MFEM mesh v1.0", b"MFEM mesh v1.2", b"MFEM mesh v1.3"];
/// Name of the array of the elements' attributes.
const ATTRIBUTE: &str = "attribute";

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    is_root(path) || VERSIONS.iter().any(|version| head.starts_with(version))
}

/// The mesh of a process and its fields.
struct MfemPart {
    mesh: MfemMesh,
    /// Nodes of an order, once they were numbered.
    nodes: Option<(u32, MfemNodes)>,
    fields: Vec<GridFunction>,
    source: Arc<Source>,
}

impl MfemPart {
    fn spaces(&self) -> Vec<(String, FieldSpace)> {
        let nodes = match &self.mesh.coordinates {
            Coordinates::OfNodes(nodes) => Some((nodes.name.clone(), nodes.space)),
            Coordinates::OfVertices { .. } => None,
        };
        let fields = self.fields.iter().map(|field| (format!("'{}'", field.name), field.space));
        nodes.into_iter().chain(fields).collect()
    }

    /// Leaves out fields with the values of another mesh; sentences about them.
    fn leave_out_misfits(&mut self) -> Result<Vec<String>> {
        let order = self.spaces().iter().map(|own| own.1.order()).max().unwrap_or(1);
        let nodes = self.mesh.nodes(order)?;
        let mut sentences = Vec::new();
        let elements = &self.mesh.elements;
        self.fields.retain(|field| {
            let error = field.check_count(&nodes, elements).err();
            sentences.extend(error.as_ref().map(left_out));
            error.is_none()
        });
        self.nodes = Some((order, nodes));
        Ok(sentences)
    }
}

/// The sentence about a field beside a mesh that is not read.
fn left_out(error: &Error) -> String {
    format!("The file of the mesh's name that ends in .gf is left out: {error}")
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let files = MfemFiles::of_source(&source, request)?;
    let mut dataset = Dataset { time: files.time, ..Dataset::default() };
    let (mut parts, mut opened) = (Vec::new(), 0);
    let mut open_file = |path: &Path| {
        opened += 1;
        unpacked(source.path(), path, opened)
    };
    for (process, path) in files.meshes.iter().enumerate() {
        let own = if path == source.path() { source.clone() } else { open_file(path)? };
        dataset.file_bytes += own.len();
        let open_mesh = || {
            unsupported::refuse(&own, unsupported::BY_MAGIC)?;
            MfemMesh::open(&own)
        };
        let mesh = open_mesh().map_err(|error| error.in_file(path))?;
        let mut part = MfemPart { mesh, nodes: None, fields: Vec::new(), source: own };
        for (name, paths) in &files.fields {
            let Some(path) = paths.get(process) else {
                let error = Error::run("the processes have no files of a field each").got(paths.len());
                return Err(error.expected(counted(files.meshes.len(), "file")).at_item(name));
            };
            let mut open_field = || {
                let own = open_file(path)?;
                dataset.file_bytes += own.len();
                GridFunction::open(&mut Cursor::new(&own), name, path)
            };
            let opened = open_field().map_err(|error| error.in_file(path));
            let served = opened.map(|opened| match opened {
                Ok(field) if !field.space.serves(&part.mesh.elements) => Err(field.collection),
                opened => opened,
            });
            match served {
                Ok(Ok(field)) => part.fields.push(field),
                Ok(Err(space)) if files.reason == FieldReason::Requested => {
                    return Err(space::refusal(&format!("'{name}'"), &space).in_file(path));
                }
                Ok(Err(space)) => dataset.warnings.push(format!(
                    "The field '{name}' is left out: it is of the space {space}, which is not read."
                )),
                Err(error) if files.reason == FieldReason::BesideMesh => {
                    dataset.warnings.push(left_out(&error));
                }
                Err(error) => return Err(error),
            }
        }
        if files.reason == FieldReason::BesideMesh {
            dataset.warnings.extend(part.leave_out_misfits()?);
        }
        parts.push(part);
    }
    // A field that is not read in the cells of one process is left out in all.
    let is_in_all =
        |name: &&String| parts.iter().all(|part| part.fields.iter().any(|field| field.name == **name));
    let kept: Vec<String> = files.fields.iter().map(|field| &field.0).filter(is_in_all).cloned().collect();
    for part in &mut parts {
        part.fields.retain(|field| kept.contains(&field.name));
    }
    let spaces: Vec<(String, FieldSpace)> = parts.iter().flat_map(MfemPart::spaces).collect();
    for (name, space) in &spaces {
        match space {
            FieldSpace::Continuous { order: order @ 3.., .. } => dataset.warnings.push(format!(
                "The order of {name} is {order}, of which the values at the nodes of the second order are read."
            )),
            FieldSpace::Discontinuous { order, .. } => dataset.warnings.push(format!(
                "{name} is of the order {order} within each cell and jumps between them: the mean in each cell is read."
            )),
            _ => {}
        }
    }
    let order = spaces.iter().map(|own| own.1.order()).max().unwrap_or(1);
    let attributes: BTreeSet<i32> =
        parts.iter().flat_map(|part| &part.mesh.elements.attributes).copied().collect();
    let attributes: Vec<i32> = attributes.into_iter().collect();
    let sets = parts.first().map_or(&[][..], |part| &part.mesh.sets[..]);
    dataset.blocks = block_names(&attributes, sets);
    let is_selected = selected(&dataset.blocks, request)?;
    if let Some([field]) = parts.first().map(|part| &part.fields[..]) {
        dataset.active_scalars = Some(field.name.clone());
    }
    let is_curved = spaces.iter().any(|own| own.0 == NODES);
    let (curved, processes) = (if is_curved { ", curved" } else { "" }, parts.len());
    dataset.format = match processes {
        1 => format!("MFEM mesh{curved}"),
        _ => format!("MFEM mesh{curved}, {}", counted(processes, "process")),
    };
    for part in parts {
        dataset.pieces.push(piece(part, &attributes, &is_selected, order)?);
    }
    Ok(dataset)
}

/// A file that another names, unpacked where it is packed.
fn unpacked(by: &Path, path: &Path, number: usize) -> Result<Arc<Source>> {
    let source = open_named(by, path, number)?;
    if source.is_packed()? { source.unpacked(None) } else { Ok(source) }
}

/// Names of the blocks of elements by their attributes; none where there is one attribute without a name. An attribute has the name of the
/// first set that it is in, with its number behind it where the set has others or another block has the name.
fn block_names(attributes: &[i32], sets: &[(String, Vec<i32>)]) -> Vec<String> {
    let mut first_sets: HashMap<i32, &(String, Vec<i32>)> = HashMap::new();
    for set in sets {
        for &attribute in &set.1 {
            first_sets.entry(attribute).or_insert(set);
        }
    }
    if attributes.len() < 2 && !attributes.iter().any(|own| first_sets.contains_key(own)) {
        return Vec::new();
    }
    let mut taken = HashSet::new();
    let name = |attribute: &i32| {
        let mut name = match first_sets.get(attribute) {
            Some((name, own)) if own.len() == 1 => name.clone(),
            Some((name, _)) => format!("{name}/{attribute}"),
            None => attribute.to_string(),
        };
        while !taken.insert(name.clone()) {
            name = format!("{name}/{attribute}");
        }
        name
    };
    attributes.iter().map(name).collect()
}

/// Elements of a part, and those that are read.
struct MfemCells {
    mesh: MfemMesh,
    nodes: MfemNodes,
    is_second_order: bool,
    /// Number of each element's block.
    blocks: Vec<u32>,
    /// Elements that are read; `None`: all.
    chosen: Option<Vec<u32>>,
}

impl MfemCells {
    /// Values of the elements that are read, of `component_count` numbers each, from those of all.
    fn of_chosen(&self, values: Vec<f64>, component_count: usize) -> Vec<f64> {
        let Some(chosen) = &self.chosen else { return values };
        let tuple =
            |&cell: &u32| values[cell as usize * component_count..].iter().take(component_count).copied();
        chosen.iter().flat_map(tuple).collect()
    }

    fn read(&self) -> Result<(Vec<DVec3>, Cells)> {
        let elements = &self.mesh.elements;
        let points = match &self.mesh.coordinates {
            Coordinates::OfVertices { component_count, numbers } => {
                let positions = self.mesh.positions(*component_count, numbers)?;
                let linear = ContinuousLayout::new(&self.nodes, elements, 1, false);
                let axis = |node, axis: usize| linear.at(node, |vertex| positions[vertex][axis]);
                let point = |node| DVec3::new(axis(node, 0), axis(node, 1), axis(node, 2));
                (0..self.nodes.len()).map(point).collect()
            }
            Coordinates::OfNodes(nodes) => {
                let values = nodes.load(&self.nodes, elements)?;
                values.chunks(nodes.component_count).map(mesh::position).collect()
            }
        };
        let mut gathered = CellSet::default();
        let mut add = |cell: usize| {
            let shape = &SHAPES[usize::from(self.mesh.elements.types[cell])];
            let nodes = self.nodes.of_element(cell);
            gathered.push(shape.codes[usize::from(self.is_second_order)], nodes.iter().copied());
        };
        match &self.chosen {
            None => (0..self.blocks.len()).for_each(add),
            Some(chosen) => chosen.iter().for_each(|&cell| add(cell as usize)),
        }
        Ok((points, into_cells(gathered)))
    }
}

fn piece(part: MfemPart, attributes: &[i32], is_selected: &[bool], order: u32) -> Result<Piece> {
    let MfemPart { mesh, nodes, fields, source } = part;
    let nodes = match nodes.filter(|own| own.0 == order) {
        Some((_, nodes)) => nodes,
        None => mesh.nodes(order)?,
    };
    let block = |own: &i32| attributes.binary_search(own).unwrap_or(0) as u32;
    let blocks: Vec<u32> = mesh.elements.attributes.iter().map(block).collect();
    let is_chosen = |&cell: &u32| is_selected.get(blocks[cell as usize] as usize) != Some(&false);
    let chosen = is_selected.contains(&false).then(|| (0..blocks.len() as u32).filter(is_chosen).collect());
    let cells = Arc::new(MfemCells { mesh, nodes, is_second_order: order > 1, blocks, chosen });
    let point_count = cells.nodes.len() as u64;
    let cell_count = cells.chosen.as_ref().map_or(cells.blocks.len(), Vec::len) as u64;
    let corner_count = cells.nodes.connectivity.len() as u64;
    let mut arrays: Vec<PieceArray> = fields
        .into_iter()
        .map(|field| {
            let (component_count, association) = (field.component_count, field.space.association());
            let head = FileArray { name: field.name.clone(), association, component_count };
            let of = cells.clone();
            PieceArray::computed(&source, &head, [point_count, cell_count], move |_| {
                let values = field.load(&of.nodes, &of.mesh.elements)?;
                Ok(match association {
                    Association::Cell => of.of_chosen(values, component_count),
                    Association::Point => values,
                })
            })
        })
        .collect();
    let of = cells.clone();
    let stored = Stored::computed(&source, ATTRIBUTE, 1, cell_count, move |_| {
        let all = of.mesh.elements.attributes.iter().map(|&own| f64::from(own)).collect();
        Ok(of.of_chosen(all, 1))
    });
    arrays.push(PieceArray::new(Association::Cell, Stored { number_type: NumberType::I32, ..stored }));
    let of = cells.clone();
    let numbers: Compute =
        Arc::new(move |_| Ok(of.of_chosen(of.blocks.iter().map(|&block| f64::from(block)).collect(), 1)));
    let geometry = geometry([point_count, cell_count, corner_count], move |_| cells.read());
    let piece = Piece::new([point_count, cell_count], geometry, arrays);
    Ok(piece.with_blocks(CellBlocks::Each { numbers, grid: None }))
}

/// The files that reading a path opens besides; none for other formats.
pub(super) fn files_named(path: &Path, request: &Request) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, |head| matches(head, path, request)) else { return Vec::new() };
    let Ok(files) = MfemFiles::of_source(&source, request) else { return Vec::new() };
    let fields = files.fields.into_iter().flat_map(|field| field.1);
    let named = files.meshes.into_iter().chain(fields);
    named.filter(|file| file != path && Some(file) != request.solution.as_ref()).collect()
}
