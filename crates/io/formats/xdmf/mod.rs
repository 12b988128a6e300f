//! XDMF (.xdmf, .xmf): grids described in XML, whose numbers lie in HDF5, in files of bytes or in the XML itself.
//!
//! Source: XDMF Model and Format, versions 2 and 3 (xdmf.org). Axes of structured grids stand slowest first, and so do origin and
//! spacing. Grids of a spatial collection or a tree are blocks. Grids of the same points and cells are one, with the arrays of
//! all: writers of several functions on one mesh (DOLFIN) repeat it.

mod cells;
mod items;
mod paths;

use super::blocks;
use super::contents::{
    CellBlocks, Dataset, Geometry, Piece, PieceArray, Stored, StoredCells, structured_counts,
};
use super::request::{Format, Request};
use super::source::{Source, text_of};
use super::text::has_mark;
use super::xml::header::{self, Element};
use cells::Topology;
use glam::{DMat3, DVec3};
use items::{Item, Items, whole};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

pub(super) const FORMAT: Format = Format {
    files: "an XDMF file (.xdmf, .xmf)",
    matches: |head, path, _| matches(head, path),
    open,
    has_solution: false,
};

/// Deepest tree of grids, and most of them: each may be included in many places.
const MAX_DEPTH: usize = 16;
const MAX_GRIDS: usize = 500_000;

fn matches(head: &[u8], path: &Path) -> bool {
    let is_named = path.extension().is_some_and(|ending| {
        ["xdmf", "xmf", "xdmf2", "xdmf3"].iter().any(|own| ending.eq_ignore_ascii_case(own))
    });
    head.starts_with(b"<")
        && !has_mark(head, "<VTKFile")
        && (is_named || has_mark(head, "<Xdmf") || has_mark(head, "<!DOCTYPE Xdmf"))
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (root, _) = header::read_as(&source, "Xdmf")?;
    Reader::new(&source, &root).read(request)
}

/// The files that the data items of a file lie in, for the step of a request, or of all steps; none for other files.
pub(super) fn files_named(path: &Path, request: Option<&Request>) -> Vec<PathBuf> {
    let Some(source) = Source::open_if(path, |head| matches(text_of(head), path)) else { return Vec::new() };
    let Ok((root, _)) = header::read_as(&source, "Xdmf") else { return Vec::new() };
    let mut reader = Reader::new(&source, &root);
    // What cannot be read is an error of the reading itself.
    let _ = reader.read(request.unwrap_or(&Request::default()));
    let mut files = reader.items.files();
    if request.is_none() {
        let known: HashSet<PathBuf> = files.iter().cloned().collect();
        files.extend(reader.items.files_below(&root).into_iter().filter(|file| !known.contains(file)));
    }
    files
}

struct Reader<'a> {
    items: Items<'a>,
    dataset: Dataset,
    /// Grids that were met so far.
    grid_count: usize,
    /// Names of the grids that lie in a plane.
    flat: Vec<String>,
}

/// A grid without others in it.
struct UniformGrid<'a> {
    /// Names of the grids above it and its own, with `/` between.
    name: String,
    /// Its elements, those included among them.
    elements: Vec<&'a Element>,
}

impl<'a> UniformGrid<'a> {
    fn element(&self, tag: &str) -> Result<&'a Element> {
        let missing = || Error::run(format!("the grid '{}' has no <{tag}>", self.name));
        self.elements.iter().copied().find(|element| element.tag == tag).ok_or_else(missing)
    }
}

impl<'a> Reader<'a> {
    fn new(source: &'a Arc<Source>, root: &'a Element) -> Reader<'a> {
        let dataset = Dataset { format: "XDMF".to_owned(), ..Dataset::default() };
        Reader { items: Items::new(source, root), dataset, grid_count: 0, flat: Vec::new() }
    }

    fn read(&mut self, request: &Request) -> Result<Dataset> {
        let document = &self.items.document;
        let domain = document.children_of(document.root, "Domain")?;
        let domain = domain
            .first()
            .ok_or_else(|| Error::run("the file holds no <Domain>").expected("<Xdmf> with <Domain>"))?;
        let mut leaves = Vec::new();
        for (number, grid) in document.children_of(domain, "Grid")?.into_iter().enumerate() {
            self.add(grid, name(grid, number), request, 0, &mut leaves)?;
        }
        let meshes = self.meshes(leaves)?;
        let names: Vec<String> = meshes.iter().map(|mesh| mesh[0].name.clone()).collect();
        self.dataset.has_blocks = names.len() > 1;
        let selected = blocks::selected(if names.len() > 1 { &names } else { &[] }, request)?;
        for (block, leaves) in meshes.iter().enumerate() {
            if selected.get(block) != Some(&false) {
                let piece =
                    self.piece(leaves).map_err(|error| error.at_item(format!("grid '{}'", names[block])))?;
                let piece = piece.map(|piece| piece.with_blocks(CellBlocks::One(block)));
                self.dataset.pieces.extend(piece);
            }
        }
        let flat = self.flat.iter().map(String::as_str);
        self.dataset.warnings.extend(blocks::left_out("Grids that lie in a plane", flat));
        if names.len() > 1 {
            self.dataset.blocks = names;
        }
        self.dataset.file_bytes = self.items.file_bytes();
        Ok(std::mem::take(&mut self.dataset))
    }

    /// Adds the leaves of a grid; of a series those of the step.
    fn add(
        &mut self,
        grid: &'a Element,
        path: String,
        request: &Request,
        depth: usize,
        leaves: &mut Vec<UniformGrid<'a>>,
    ) -> Result<()> {
        if depth > MAX_DEPTH {
            return Err(Error::run("the grids of the file stand too deep in others"));
        }
        self.grid_count += 1;
        if self.grid_count > MAX_GRIDS {
            let error = Error::run("the file holds, or includes, too many grids");
            return Err(error.expected(format_args!("at most {MAX_GRIDS}")));
        }
        let kind = grid.attribute("GridType").unwrap_or("Uniform").to_lowercase();
        let collection = grid.attribute("CollectionType").unwrap_or("Spatial").to_lowercase();
        let elements = self.items.document.children(grid)?;
        let grids: Vec<&Element> = elements.iter().copied().filter(|element| element.tag == "Grid").collect();
        match (kind.as_str(), collection.as_str()) {
            ("uniform", _) => {
                if self.dataset.time.is_none()
                    && let Some(time) = self.time_of(&elements)?
                {
                    self.dataset.time = Some(time);
                }
                leaves.push(UniformGrid { name: path, elements });
                Ok(())
            }
            ("collection", "temporal") => {
                let Some(grid) = self.step(&elements, &grids, request)? else { return Ok(()) };
                self.add(grid, path, request, depth + 1, leaves)
            }
            ("collection" | "tree", _) => {
                for (number, grid) in grids.into_iter().enumerate() {
                    self.add(grid, format!("{path}/{}", name(grid, number)), request, depth + 1, leaves)?;
                }
                Ok(())
            }
            _ => Err(grid.wrong("GridType", "Uniform, Collection or Tree")),
        }
    }

    /// The grid of the step of a series. Notes the times of the first series as those of the data set.
    fn step(
        &mut self,
        elements: &[&'a Element],
        grids: &[&'a Element],
        request: &Request,
    ) -> Result<Option<&'a Element>> {
        let mut times = Vec::new();
        for grid in grids {
            // Not by way of includes, which give no times.
            times.push(self.time_of(&grid.children.iter().collect::<Vec<_>>())?);
        }
        let times: Vec<f64> = match times.iter().copied().collect::<Option<Vec<f64>>>() {
            Some(times) => times,
            None => self.times(elements, grids.len())?,
        };
        let mut order: Vec<usize> = (0..grids.len()).collect();
        order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        let times: Vec<f64> = order.iter().map(|&place| times[place]).collect();
        if times.is_empty() {
            return Ok(None);
        }
        if self.dataset.time_steps.is_empty() {
            self.dataset.time_steps.clone_from(&times);
        } else if self.dataset.time_steps != times {
            return Err(Error::run("the series of the file differ in their times"));
        }
        Ok(Some(grids[order[request.step_index(&times)?]]))
    }

    /// The time of a grid by its own element.
    fn time_of(&self, elements: &[&'a Element]) -> Result<Option<f64>> {
        let Some(time) = elements.iter().copied().find(|element| element.tag == "Time") else {
            return Ok(None);
        };
        let value = match time.number::<f64>("Value")? {
            None => self.items.only(time)?.numbers()?.first().copied(),
            value => value,
        };
        match value {
            Some(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(time.wrong("Value", "a finite number")),
        }
    }

    /// Times that a series lists itself; the numbers of its steps, where it does not.
    fn times(&self, elements: &[&'a Element], count: usize) -> Result<Vec<f64>> {
        let Some(time) = elements.iter().copied().find(|element| element.tag == "Time") else {
            return Ok((0..count).map(|step| step as f64).collect());
        };
        let numbers = self.items.only(time)?.numbers()?;
        let times = match (time.attribute("TimeType").unwrap_or("List"), &numbers[..]) {
            ("HyperSlab", [start, stride, _]) => {
                (0..count).map(|step| start + stride * step as f64).collect()
            }
            _ => numbers,
        };
        if times.len() != count || times.iter().any(|time| !time.is_finite()) {
            let error = Error::run("the times of a series are damaged").got(times.len());
            return Err(error.expected(format_args!("{count} finite times")));
        }
        Ok(times)
    }

    /// Grids by their points and cells: those of the same stand together.
    fn meshes(&self, leaves: Vec<UniformGrid<'a>>) -> Result<Vec<Vec<UniformGrid<'a>>>> {
        let mut meshes: Vec<Vec<UniformGrid>> = Vec::new();
        let mut numbers: HashMap<Vec<String>, usize> = HashMap::new();
        for leaf in leaves {
            let number = *numbers.entry(self.key(&leaf)?).or_insert(meshes.len());
            match meshes.get_mut(number) {
                Some(mesh) => mesh.push(leaf),
                None => meshes.push(vec![leaf]),
            }
        }
        Ok(meshes)
    }

    /// Types and places of a leaf's points and cells.
    fn key(&self, leaf: &UniformGrid<'a>) -> Result<Vec<String>> {
        let mut key = Vec::new();
        for tag in ["Topology", "Geometry"] {
            let element = leaf.element(tag)?;
            key.push(format!("{:?}", element.attributes));
            for item in self.items.of_element(element)? {
                let is_file = item.attribute("Format").is_some_and(|format| format != "XML")
                    && item.children.is_empty();
                // Of numbers in the XML itself, and of parts of others, the same element.
                key.push(if is_file {
                    // The attributes say at which byte of the file it begins.
                    format!("{:?} {}", item.attributes, self.items.document.text(item)?)
                } else {
                    format!("{:p}", std::ptr::from_ref(item))
                });
            }
        }
        Ok(key)
    }

    /// The grid of leaves with the same points and cells; `None` where it has no volume.
    fn piece(&mut self, leaves: &[UniformGrid<'a>]) -> Result<Option<Piece>> {
        let [topology, geometry] = [leaves[0].element("Topology")?, leaves[0].element("Geometry")?];
        let kind = topology.attribute("TopologyType").or(topology.attribute("Type")).unwrap_or("");
        let form =
            geometry.attribute("GeometryType").or(geometry.attribute("Type")).unwrap_or("XYZ").to_uppercase();
        let (point_count, cell_count, geometry) = match kind.to_lowercase().as_str() {
            plain if plain.starts_with("2d") || form == "XY" || form == "X_Y" => {
                self.flat.push(leaves[0].name.clone());
                return Ok(None);
            }
            "3dsmesh" | "3drectmesh" | "3dcorectmesh" => self.structured(topology, geometry, &form)?,
            _ => self.unstructured(kind, topology, geometry, &form)?,
        };
        let mut arrays: Vec<PieceArray> = Vec::new();
        for element in
            leaves.iter().flat_map(|leaf| &leaf.elements).filter(|element| element.tag == "Attribute")
        {
            if let Some(array) = self.array(element, point_count, cell_count)?
                && !arrays
                    .iter()
                    .any(|own| own.association == array.association && own.stored.name == array.stored.name)
            {
                arrays.push(array);
            }
        }
        Ok(Some(Piece::new([point_count, cell_count], geometry, arrays)))
    }

    fn array(
        &mut self,
        element: &'a Element,
        point_count: u64,
        cell_count: u64,
    ) -> Result<Option<PieceArray>> {
        let name = element.attribute("Name").unwrap_or("");
        let (association, count) = match element.attribute("Center").unwrap_or("Node").to_lowercase().as_str()
        {
            "node" => (Association::Point, point_count),
            "cell" => (Association::Cell, cell_count),
            other => {
                let sentence = format!(
                    "The attribute '{name}' is left out: its values lie at '{other}', not at Node or Cell."
                );
                self.dataset.warnings.push(sentence);
                return Ok(None);
            }
        };
        let item = self.items.only(element).map_err(|error| error.at_item(name))?;
        if (count, item.count()) == (0, 0) {
            return Ok(None);
        }
        let components = item.count().checked_div(count).unwrap_or(0);
        if components == 0 || components.checked_mul(count) != Some(item.count()) {
            let error = Error::run("an attribute has the wrong number of values").got(item.count());
            return Err(error.expected(format_args!("a multiple of {count}")).at_item(name));
        }
        Ok(Some(PieceArray::new(association, item.tuples(name, components as usize))))
    }

    fn unstructured(
        &self,
        kind: &str,
        topology: &'a Element,
        geometry: &'a Element,
        form: &str,
    ) -> Result<CountedGeometry> {
        let known = Topology::named(kind).ok_or_else(|| {
            topology.wrong(
                "TopologyType",
                "Tetrahedron, Hexahedron, Wedge, Pyramid, these of second order, Polyhedron, Mixed, 3DSMesh, 3DRectMesh or 3DCoRectMesh",
            )
        })?;
        if topology.attribute("Order").is_some() {
            return Err(topology.wrong("Order", "no order of nodes but that of VTK"));
        }
        let connectivity = self.items.only(topology)?;
        let named = ["NumberOfElements", "Dimensions"].iter().find_map(|name| topology.attribute(name));
        let declared =
            named.map(|text| whole(text).ok_or_else(|| topology.wrong("NumberOfElements", "whole numbers")));
        let declared = declared
            .transpose()?
            .map(|counts| counts.iter().fold(1_u64, |product, &n| product.saturating_mul(n)));
        let mut node_count = known.node_count(topology.number("NodesPerElement")?.filter(|&nodes| nodes > 0));
        if known.is_vertex() && declared == Some(connectivity.count()) {
            node_count = node_count.or(Some(1));
        }
        let found = node_count.map(|nodes| (connectivity.count() / nodes, connectivity.count() % nodes));
        let cell_count = match (found, declared) {
            (Some((count, 0)), None) => count,
            (Some((count, 0)), Some(declared)) if count == declared => count,
            // Each cell takes one number at least.
            (None, Some(declared)) if declared <= connectivity.count() => declared,
            _ => {
                let error = Error::run("the connectivity has the wrong length").got(connectivity.count());
                return Err(error.expected(match (declared, node_count) {
                    (None, _) => "the attribute NumberOfElements of <Topology>".to_owned(),
                    (Some(cells), Some(nodes)) => format!("{nodes} for each of {cells} cells"),
                    (Some(cells), None) => format!("at least {cells}"),
                }));
            }
        };
        let points = self.points(geometry, form)?;
        let base = topology.number("BaseOffset")?.unwrap_or(0);
        let convert = known.convert(node_count, connectivity.tuples("Topology", 1), cell_count, base);
        let cells = Box::new(StoredCells::Converted(convert));
        Ok((points.tuple_count.unwrap_or(0), cell_count, Geometry::Unstructured { points, cells }))
    }

    fn points(&self, geometry: &'a Element, form: &str) -> Result<Stored> {
        match form {
            "XYZ" => {
                let item = self.items.only(geometry)?;
                if !item.count().is_multiple_of(3) {
                    return Err(Error::run("the points have the wrong number of coordinates")
                        .got(item.count())
                        .expected("a multiple of 3"));
                }
                Ok(item.tuples("Geometry", 3))
            }
            "X_Y_Z" => {
                let [x, y, z] = self.items.all(geometry)?;
                if [y.count(), z.count()] != [x.count(); 2] {
                    let error = Error::run("the coordinates of the points differ in number");
                    return Err(error.got(format_args!("{}, {} and {}", x.count(), y.count(), z.count())));
                }
                Ok(Stored::joined("Geometry", [x.stored, y.stored, z.stored]))
            }
            _ => {
                Err(geometry
                    .wrong("GeometryType", "XYZ or X_Y_Z; of structured grids VXVYVZ or ORIGIN_DXDYDZ"))
            }
        }
    }

    fn structured(
        &self,
        topology: &'a Element,
        geometry: &'a Element,
        form: &str,
    ) -> Result<CountedGeometry> {
        let axes =
            topology.attribute("Dimensions").or(topology.attribute("NumberOfElements")).and_then(whole);
        let axes = axes.and_then(|axes| <[u64; 3]>::try_from(axes).ok());
        let [nz, ny, nx] =
            axes.ok_or_else(|| topology.wrong("Dimensions", "three numbers of points, z first"))?;
        let dimensions = [nx, ny, nz];
        let (point_count, cell_count) = structured_counts(dimensions)?;
        let geometry = match form {
            "VXVYVZ" => {
                let items: [Item; 3] = self.items.all(geometry)?;
                for (item, n) in items.iter().zip(dimensions) {
                    if item.count() != n {
                        return Err(wrong_count(item.count(), n));
                    }
                }
                Geometry::Rectilinear {
                    dimensions,
                    axes: Box::new(items.map(|item| item.tuples("Geometry", 1))),
                }
            }
            "ORIGIN_DXDYDZ" => {
                let [origin, spacing]: [Item; 2] = self.items.all(geometry)?;
                let vector = |item: Item| -> Result<DVec3> {
                    let [z, y, x] = item.numbers()?[..] else { return Err(wrong_count(item.count(), 3)) };
                    Ok(DVec3::new(x, y, z))
                };
                let (origin, spacing) = (vector(origin)?, vector(spacing)?);
                Geometry::Uniform {
                    dimensions,
                    first: DVec3::ZERO,
                    origin,
                    spacing,
                    direction: DMat3::IDENTITY,
                }
            }
            _ => {
                let points = self.points(geometry, form)?;
                match points.tuple_count {
                    Some(count) if count == point_count => Geometry::Curvilinear { dimensions, points },
                    found => return Err(wrong_count(found.unwrap_or(0), point_count)),
                }
            }
        };
        Ok((point_count, cell_count, geometry))
    }
}

fn wrong_count(found: u64, accepted: u64) -> Error {
    Error::run("the grid has the wrong number of coordinates").got(found).expected(accepted)
}

/// Numbers of points and cells, and where they are stored.
type CountedGeometry = (u64, u64, Geometry);

fn name(grid: &Element, number: usize) -> String {
    grid.attribute("Name").map_or_else(|| format!("grid {number}"), str::to_owned)
}
