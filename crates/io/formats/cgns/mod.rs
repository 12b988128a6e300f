//! CGNS in HDF5 (.cgns): bases of zones, structured and unstructured, with their solutions, in time steps.
//!
//! Source: CGNS/SIDS 4.4 (Standard Interface Data Structures) and its HDF5 mapping: a node is a group with the attributes `name`,
//! `label` (its type) and `type`, whose numbers lie in the array ` data`; a link leads by the group ` link`. Axes stand in the
//! order of C, so the first of CGNS runs fastest. A zone is a block, `Base/Zone`.

mod elements;

use super::blocks;
use super::contents::{
    CellBlocks, Dataset, Geometry, Piece, PieceArray, Stored, StoredCells, structured_counts,
};
use super::hdf5::{Array, Extent, Group};
use super::request::Request;
use super::units;
use super::vectors::joined;
use elements::Section;
use std::rc::Rc;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Name of the node that tells a file.
pub(super) const ROOT: &str = "CGNSLibraryVersion";

/// Characters of a name in an array of names.
const NAME_LEN: usize = 32;

struct Node {
    name: String,
    label: String,
    group: Group,
}

impl Node {
    fn new(group: Group) -> Result<Node> {
        let name = group.name().to_owned();
        let is_link = group.text("type")?.as_deref() == Some("LK");
        let group = if is_link { group.required_group(" link")? } else { group };
        Ok(Node { name, label: group.text("label")?.unwrap_or_default(), group })
    }

    fn children(&self) -> Result<Vec<Node>> {
        self.group.groups()?.into_iter().filter(|group| group.name() != " link").map(Node::new).collect()
    }

    fn data(&self) -> Result<Array> {
        self.group.required_array(" data")
    }

    fn numbers(&self) -> Result<Vec<i64>> {
        self.data()?.numbers()
    }

    fn text(&self) -> Result<String> {
        self.data()?.text()
    }

    fn wrong(&self, what: &str) -> Error {
        Error::run(what).at_item(self.group.path())
    }
}

/// The first child of a type.
fn labelled<'a>(nodes: &'a [Node], label: &str) -> Option<&'a Node> {
    nodes.iter().find(|node| node.label == label)
}

fn named<'a>(nodes: &'a [Node], name: &str) -> Option<&'a Node> {
    nodes.iter().find(|node| node.name == name)
}

/// Context of the zones of a base.
struct Base {
    /// The step that is read, where the base has some.
    step: Option<usize>,
    has_volume: bool,
    units: Units,
    /// True in a file of the library 3.0, which numbered element types in another way.
    is_3_0: bool,
}

/// Reads the table of contents.
pub(super) fn open(root: &Group, request: &Request) -> Result<Dataset> {
    let mut dataset = Dataset { format: "CGNS in HDF5".to_owned(), has_blocks: true, ..Dataset::default() };
    let nodes = root.groups()?.into_iter().map(Node::new).collect::<Result<Vec<_>>>()?;
    // A number of 32 bits. What states no version is of none that has other numbers of types.
    let version = named(&nodes, ROOT).and_then(|node| node.data().ok()?.numbers::<f64>().ok());
    let is_3_0 = version.is_some_and(|version| version.iter().any(|own| (2.99..3.09).contains(own)));
    let mut zones = Vec::new();
    for base in nodes.into_iter().filter(|node| node.label == "CGNSBase_t") {
        let children = base.children()?;
        let step = step(&children, request, &mut dataset)?;
        let has_volume = base.numbers()?.first() == Some(&3);
        let context = Rc::new(Base { step, has_volume, units: own_units(&children)?, is_3_0 });
        for zone in children.into_iter().filter(|node| node.label == "Zone_t") {
            dataset.blocks.push(format!("{}/{}", base.name, zone.name));
            zones.push((zone, context.clone()));
        }
    }
    let selected = blocks::selected(&dataset.blocks, request)?;
    let mut flat = Vec::new();
    let own = zones.iter().enumerate().filter(|(block, _)| selected[*block]);
    for (block, (zone, base)) in own {
        if base.has_volume {
            let piece = piece(zone, base, &mut dataset.warnings)?;
            dataset.pieces.push(piece.with_blocks(CellBlocks::One(block)));
        } else {
            flat.push(dataset.blocks[block].as_str());
        }
    }
    dataset.warnings.extend(blocks::left_out("Zones without cells of three dimensions", flat));
    dataset.file_bytes = root.file_bytes();
    Ok(dataset)
}

/// The step that is read, where a base has some. Notes the times of the first such base as those of the data set.
fn step(base: &[Node], request: &Request, dataset: &mut Dataset) -> Result<Option<usize>> {
    let Some(iterative) = labelled(base, "BaseIterativeData_t") else { return Ok(None) };
    let children = iterative.children()?;
    let values = named(&children, "TimeValues").or_else(|| named(&children, "IterationValues"));
    let Some(values) = values else { return Ok(None) };
    let times: Vec<f64> = values.data()?.numbers()?;
    dataset.note_times(&times, "bases").map_err(|error| error.at_item(values.group.path()))?;
    request.step_index(&times).map(Some)
}

/// Symbols of mass, length, time, temperature and angle; none where nothing is stated.
type Units = Vec<&'static str>;

/// Symbols of the units that SIDS names.
const UNIT_NAMES: [(&str, &str); 16] = [
    ("Kilogram", "kg"),
    ("Gram", "g"),
    ("Slug", "slug"),
    ("PoundMass", "lbm"),
    ("Meter", "m"),
    ("Centimeter", "cm"),
    ("Millimeter", "mm"),
    ("Foot", "ft"),
    ("Inch", "in"),
    ("Second", "s"),
    ("Kelvin", "K"),
    ("Celsius", "°C"),
    ("Rankine", "°R"),
    ("Fahrenheit", "°F"),
    ("Degree", "°"),
    ("Radian", "rad"),
];

/// The units that one of these nodes states; none where there is no such.
fn own_units(nodes: &[Node]) -> Result<Units> {
    let Some(node) = labelled(nodes, "DimensionalUnits_t") else { return Ok(Units::new()) };
    let bytes = node.data()?.letters()?;
    let symbol = |bytes: &[u8]| {
        let name = String::from_utf8_lossy(bytes).trim_matches(['\0', ' ']).to_owned();
        UNIT_NAMES.iter().find(|known| known.0 == name).map_or("", |known| known.1)
    };
    Ok(bytes.chunks(NAME_LEN).map(symbol).collect())
}

/// The units that hold below: those of one of these nodes, or else those from above.
fn units_there(nodes: &[Node], above: &Units) -> Result<Units> {
    let own = own_units(nodes)?;
    Ok(if own.is_empty() { above.clone() } else { own })
}

/// The unit of an array that states its exponents; `None` for others, and where a unit is not known.
fn unit(array: &Node, above: &Units) -> Result<Option<String>> {
    let children = array.children()?;
    let Some(node) = labelled(&children, "DimensionalExponents_t") else { return Ok(None) };
    let exponents: Vec<f64> = node.data()?.numbers()?;
    let symbols = units_there(&children, above)?;
    let factors: Vec<(&str, f64)> = symbols.into_iter().zip(exponents).collect();
    let is_known = factors.iter().all(|factor| factor.1 == 0.0 || !factor.0.is_empty());
    Ok(if is_known { units::product(&factors) } else { None })
}

/// Names of nodes, one for each step; none where the zone does not change them.
fn pointers(iterative: &[Node], names: &[&str]) -> Result<Vec<String>> {
    let Some(node) = names.iter().find_map(|name| named(iterative, name)) else { return Ok(Vec::new()) };
    let bytes = node.data()?.letters()?;
    let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_matches(['\0', ' ']).to_owned();
    Ok(bytes.chunks(NAME_LEN).map(name).collect())
}

/// Nodes of a type that hold for the step: of those that some step points to the step's, and those that none does.
fn of_step<'a>(nodes: &'a [Node], label: &str, pointers: &[String], step: Option<usize>) -> Vec<&'a Node> {
    let own = step.and_then(|step| pointers.get(step));
    let holds =
        |node: &&Node| node.label == label && (own == Some(&node.name) || !pointers.contains(&node.name));
    nodes.iter().filter(holds).collect()
}

/// Numbers of points and of cells along the axes of a zone: one axis where it is unstructured.
struct Sizes {
    points: Vec<u64>,
    cells: Vec<u64>,
}

impl Sizes {
    fn of_zone(zone: &Node, is_structured: bool) -> Result<Sizes> {
        let numbers = zone.numbers()?;
        let axes = if is_structured { 3 } else { 1 };
        let wrong = || zone.wrong("the sizes of the zone are damaged").got(format_args!("{numbers:?}"));
        let sizes: Option<Vec<u64>> = numbers.iter().map(|&n| u64::try_from(n).ok()).collect();
        let sizes = sizes.filter(|sizes| sizes.len() >= 2 * axes).ok_or_else(wrong)?;
        Ok(Sizes { points: sizes[..axes].to_vec(), cells: sizes[axes..2 * axes].to_vec() })
    }
}

fn piece(zone: &Node, base: &Base, warnings: &mut Vec<String>) -> Result<Piece> {
    let children = zone.children()?;
    let (step, units) = (base.step, units_there(&children, &base.units)?);
    let kind = labelled(&children, "ZoneType_t").map(Node::text).transpose()?;
    let is_structured = match kind.as_deref() {
        Some("Structured") => true,
        Some("Unstructured") | None => false,
        Some(other) => {
            let error = zone.wrong("the type of the zone is not known").got(format_args!("'{other}'"));
            return Err(error.expected("Structured or Unstructured"));
        }
    };
    let mut sizes = Sizes::of_zone(zone, is_structured)?;
    let iterative = labelled(&children, "ZoneIterativeData_t").map_or(Ok(Vec::new()), Node::children)?;
    let grids = pointers(&iterative, &["GridCoordinatesPointers"])?;
    let coordinates = of_step(&children, "GridCoordinates_t", &grids, step);
    // Where some step has coordinates of its own, the first node is that of the first step.
    let own = coordinates.iter().find(|node| grids.contains(&node.name)).or(coordinates.first());
    let own = own.ok_or_else(|| zone.wrong("the zone has no coordinates").expected("GridCoordinates_t"))?;
    let points = points(own, &sizes.points)?;
    let (point_count, cell_count, geometry) = if is_structured {
        let dimensions = [sizes.points[0], sizes.points[1], sizes.points[2]];
        let (point_count, cell_count) = structured_counts(dimensions)?;
        (point_count, cell_count, Geometry::Curvilinear { dimensions, points })
    } else {
        let sections = sections(&children, base.is_3_0)?;
        let warning = "The node in the middle of the base of pyramids of 14 nodes (PYRA_14) is left out.";
        let has_larger = sections.iter().any(|section| section.kind == elements::PYRA_14);
        if has_larger && !warnings.iter().any(|known| known == warning) {
            warnings.push(warning.to_owned());
        }
        // Some writers count the elements of the boundary, too.
        sizes.cells = vec![elements::count(&sections, sizes.cells[0])];
        let (point_count, cell_count) = (sizes.points[0], sizes.cells[0]);
        let convert = move |meter: &super::contents::Meter| elements::cells(&sections, cell_count, meter);
        let cells = Box::new(StoredCells::Converted(Arc::new(convert)));
        (point_count, cell_count, Geometry::Unstructured { points, cells })
    };
    let pointers = pointers(&iterative, &["FlowSolutionPointers", "FlowSolutionVertexPointers"])?;
    let mut arrays = Vec::new();
    for solution in of_step(&children, "FlowSolution_t", &pointers, step) {
        add_solution(solution, &sizes, &units, &mut arrays, warnings)?;
    }
    Ok(Piece::new([point_count, cell_count], geometry, arrays))
}

/// Layers of values beyond each end of each axis.
fn rind(nodes: &[Node], axes: usize) -> Result<Vec<[u64; 2]>> {
    let Some(node) = labelled(nodes, "Rind_t") else { return Ok(vec![[0; 2]; axes]) };
    let numbers = node.numbers()?;
    let layers: Option<Vec<u64>> = numbers.iter().map(|&n| u64::try_from(n).ok()).collect();
    match layers.filter(|layers| layers.len() == 2 * axes) {
        Some(layers) => Ok(layers.as_chunks().0.to_vec()),
        None => Err(node
            .wrong("the rind is damaged")
            .got(format_args!("{numbers:?}"))
            .expected(format_args!("{} counts", 2 * axes))),
    }
}

/// The numbers of an array within the rind.
fn stored(node: &Node, sizes: &[u64], rind: &[[u64; 2]]) -> Result<Stored> {
    let array = node.data()?;
    let with_rind = |(&n, layers): (&u64, &[u64; 2])| n.saturating_add(layers[0]).saturating_add(layers[1]);
    let expected: Vec<u64> = sizes.iter().zip(rind).map(with_rind).rev().collect();
    // One axis stands for all in files of some writers; there is no rind in these.
    let is_one = array.shape().len() == 1 && rind.iter().all(|layers| *layers == [0; 2]);
    let count = expected.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
    if array.shape() != expected && !(is_one && count == array.shape().first().copied()) {
        let error = node.wrong("the array has the wrong size").got(format_args!("{:?}", array.shape()));
        return Err(error.expected(format_args!("{expected:?}")));
    }
    if is_one {
        return array.stored(&node.name, 1);
    }
    let part: Vec<Extent> = sizes.iter().zip(rind).map(|(&n, layers)| (layers[0], n, 1)).rev().collect();
    array.part(&node.name, &part, 1)
}

fn points(coordinates: &Node, sizes: &[u64]) -> Result<Stored> {
    let children = coordinates.children()?;
    let rind = rind(&children, sizes.len())?;
    let axis = |name: &str| -> Result<Stored> {
        let node = named(&children, name).ok_or_else(|| {
            let names: Vec<&str> = children.iter().map(|node| node.name.as_str()).collect();
            let error = coordinates.wrong("the coordinates are not those of space").got(names.join(", "));
            error.expected("CoordinateX, CoordinateY and CoordinateZ")
        })?;
        stored(node, sizes, &rind)
    };
    Ok(Stored::joined("GridCoordinates", [axis("CoordinateX")?, axis("CoordinateY")?, axis("CoordinateZ")?]))
}

/// The sections of a zone that can hold cells with a volume, in the order of their elements.
fn sections(zone: &[Node], is_3_0: bool) -> Result<Vec<Section>> {
    let mut sections = Vec::new();
    for node in zone.iter().filter(|node| node.label == "Elements_t") {
        let [kind, ..] = node.numbers()?[..] else {
            return Err(node.wrong("the section does not say its element type"));
        };
        let kind = if is_3_0 { elements::of_version_3_0(kind) } else { kind };
        if !elements::may_have_volume(kind) {
            continue;
        }
        let children = node.children()?;
        let lacks = |what: &str| node.wrong(&format!("the section lacks its {what}"));
        let range = named(&children, "ElementRange").ok_or_else(|| lacks("ElementRange"))?.numbers()?;
        let range = match range[..] {
            [first, last] => u64::try_from(first).ok().zip(u64::try_from(last).ok()),
            _ => None,
        };
        let (first, last) = range.ok_or_else(|| lacks("ElementRange of two element numbers"))?;
        let connectivity =
            named(&children, "ElementConnectivity").ok_or_else(|| lacks("ElementConnectivity"))?;
        let connectivity = connectivity.data()?;
        let offsets =
            named(&children, "ElementStartOffset").map(|node| node.data()?.stored("ElementStartOffset", 1));
        sections.push(Section {
            kind,
            is_3_0,
            range: [first, last],
            connectivity: connectivity.stored(connectivity.path(), 1)?,
            offsets: offsets.transpose()?,
        });
    }
    sections.sort_by_key(|section| section.range);
    Ok(sections)
}

fn add_solution(
    solution: &Node,
    sizes: &Sizes,
    units: &Units,
    arrays: &mut Vec<PieceArray>,
    warnings: &mut Vec<String>,
) -> Result<()> {
    let children = solution.children()?;
    let location = labelled(&children, "GridLocation_t").map(Node::text).transpose()?;
    let (association, sizes) = match location.as_deref() {
        None | Some("Vertex") => (Association::Point, &sizes.points),
        Some("CellCenter") => (Association::Cell, &sizes.cells),
        Some(other) => {
            let name = &solution.name;
            warnings.push(format!(
                "The solution '{name}' is left out: its values lie at '{other}', not at Vertex or CellCenter."
            ));
            return Ok(());
        }
    };
    let units = units_there(&children, units)?;
    let rind = rind(&children, sizes.len())?;
    let fields: Vec<&Node> = children.iter().filter(|node| node.label == "DataArray_t").collect();
    let names: Vec<String> = fields.iter().map(|node| node.name.clone()).collect();
    for array in joined(&names) {
        let mut own = array.stored(|place| stored(fields[place], sizes, &rind))?;
        let is_taken = |array: &PieceArray| array.association == association && array.stored.name == own.name;
        if arrays.iter().any(is_taken) {
            own.name = format!("{}/{}", solution.name, own.name);
        }
        let unit = unit(fields[array.places[0]], &units)?;
        let component_names = array.components;
        arrays.push(PieceArray { component_names, unit, ..PieceArray::new(association, own) });
    }
    Ok(())
}
