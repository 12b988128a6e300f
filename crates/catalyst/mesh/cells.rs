//! Topologies to cells. Tetrahedra in whole numbers of 32 bits are borrowed; others are copied, and so are implicit ones made.

use super::coordinates::Coordinates;
use crate::conduit::{Loan, Node, NumberKind, Numbers};
use glam::DVec3;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result, SharedSlice, counted};

pub(super) struct Topology {
    pub points: SharedSlice<DVec3>,
    pub cells: Cells,
}

/// A shape of the Blueprint, with its dimension and VTK's code; the order of points is VTK's.
struct Shape {
    name: &'static str,
    dimension: usize,
    code: u8,
    /// Points of a cell, or 0 where it differs.
    point_count: usize,
}

const SHAPES: [Shape; 11] = {
    const fn shape(name: &'static str, dimension: usize, code: u8, point_count: usize) -> Shape {
        Shape { name, dimension, code, point_count }
    }
    [
        shape("point", 0, 1, 1),
        shape("line", 1, 3, 2),
        shape("tri", 2, 5, 3),
        shape("quad", 2, 9, 4),
        shape("polygonal", 2, 7, 0),
        shape("tet", 3, code::TETRA, 4),
        shape("hex", 3, code::HEXAHEDRON, 8),
        shape("wedge", 3, code::WEDGE, 6),
        shape("pyramid", 3, code::PYRAMID, 5),
        shape("polyhedral", 3, code::POLYHEDRON, 0),
        // So the Blueprint's page names it in maps of shapes.
        shape("polyhedron", 3, code::POLYHEDRON, 0),
    ]
};

/// The word for a topology of several shapes.
const MIXED: &str = "mixed";

fn shape_named(node: &Node, name: &str) -> Result<&'static Shape> {
    SHAPES.iter().find(|shape| shape.name == name).ok_or_else(|| {
        let names: Vec<&str> = SHAPES[..10].iter().map(|shape| shape.name).chain([MIXED]).collect();
        node.wrong("is no shape that is drawn", format!("\"{name}\""), names.join(", "))
    })
}

/// True if a topology may have cells with volume. Errors: an unknown type or shape.
pub(super) fn has_volume(domain: &Node, topology: &Node) -> Result<bool> {
    let kind = topology.require("type")?;
    match kind.text()?.as_str() {
        "points" => Ok(false),
        // A surface in space has two counts.
        "structured" if topology.get("elements/dims/k").is_none() => Ok(false),
        "uniform" | "rectilinear" | "structured" => {
            Ok(Coordinates::find(domain, topology)?.dimension()? == 3)
        }
        "unstructured" => {
            let shape = topology.require("elements/shape")?;
            let name = shape.text()?;
            Ok(name == MIXED || shape_named(&shape, &name)?.dimension == 3)
        }
        other => {
            let accepted = "points, uniform, rectilinear, structured or unstructured";
            Err(kind.wrong("is unknown", format!("\"{other}\""), accepted))
        }
    }
}

/// Numbers of points and cells of a topology that states its counts alone; `None` of others.
/// Errors: a count that is missing, wrong or too large.
pub(super) fn stated_counts(domain: &Node, topology: &Node) -> Result<Option<[usize; 2]>> {
    if !["uniform", "rectilinear"].contains(&topology.text_at("type")?.as_str()) {
        return Ok(None);
    }
    let counts = Coordinates::find(domain, topology)?.counts()?;
    let product = |counts: [usize; 3]| counts.iter().product();
    Ok(counts.map(|counts| [product(counts), product(counts.map(|count| count.saturating_sub(1)))]))
}

/// Points and cells of a topology. Errors: what is missing, of the wrong length or out of range, with its path.
pub(super) fn topology(domain: &Node, node: &Node, loan: &Loan) -> Result<Topology> {
    if let Some(function) = node.get("grid_function") {
        return Err(function.wrong(
            "makes a curved mesh, which is not read",
            "a grid function",
            "straight cells",
        ));
    }
    let coordinates = Coordinates::find(domain, node)?;
    let points = coordinates.points(loan)?;
    let kind = node.require("type")?;
    let cells = match kind.text()?.as_str() {
        "unstructured" => unstructured(node, points.len(), loan)?,
        "structured" => Cells::Structured(structured(node, points.len())?),
        _ => match coordinates.counts()? {
            Some(counts) => Cells::Structured(counts),
            None => {
                return Err(kind.wrong(
                    "has explicit points",
                    "explicit",
                    "a coordinate set of its own type",
                ));
            }
        },
    };
    Ok(Topology { points, cells })
}

/// Points along the axes of a structured topology.
fn structured(node: &Node, point_count: usize) -> Result<[usize; 3]> {
    for name in ["offsets", "strides"] {
        if let Some(part) = node.get(&format!("elements/dims/{name}")) {
            return Err(part.wrong(
                "chooses some of the points, which is not read",
                name,
                "dims of all points",
            ));
        }
    }
    let mut counts = [0; 3];
    for (count, name) in counts.iter_mut().zip(["i", "j", "k"]) {
        *count = node.require(&format!("elements/dims/{name}"))?.count()?.saturating_add(1);
    }
    let product = counts.iter().fold(1_usize, |product, count| product.saturating_mul(*count));
    if product != point_count {
        let dims = node.require("elements/dims")?;
        let found = format!("{} × {} × {} points", counts[0], counts[1], counts[2]);
        return Err(dims.wrong("has another number of points than its coordinate set", found, point_count));
    }
    Ok(counts)
}

fn unstructured(node: &Node, point_count: usize, loan: &Loan) -> Result<Cells> {
    let elements = node.require("elements")?;
    let shape = elements.require("shape")?;
    let name = shape.text()?;
    let connectivity = elements.require("connectivity")?;
    if name == "tet" && elements.get("offsets").is_none() {
        let numbers = connectivity.numbers()?;
        cell_count(&connectivity, &numbers, 4)?;
        let kinds = [NumberKind::Uint32, NumberKind::Int32];
        // SAFETY: the loan is held as long as the slice, and ends before the simulation goes on.
        let lent = unsafe { numbers.lent::<[u32; 4]>(&kinds) };
        return Ok(Cells::Tetrahedra(match lent {
            Some(tetrahedra) => {
                check_numbers(&numbers, point_count)?;
                SharedSlice::from_borrowed(tetrahedra, loan.clone())
            }
            None => point_numbers(&numbers, point_count)?.as_chunks::<4>().0.to_vec().into(),
        }));
    }
    let shapes = match name.as_str() {
        MIXED => Shapes::Each(each_shape(&elements)?),
        _ => Shapes::One(shape_named(&shape, &name)?),
    };
    let ranges = ranges(&elements, &shapes)?;
    let faces = match shapes.has_polyhedra() {
        true => faces(&node.require("subelements")?, point_count)?,
        false => Vec::new(),
    };
    let numbers = connectivity.numbers()?;
    let has_polyhedra = shapes.has_polyhedra();
    // Numbers of faces stand beside those of points.
    let limit = if has_polyhedra { point_count.max(faces.len()) } else { point_count };
    let numbers = point_numbers(&numbers, limit)?;
    let mut set = CellSet::default();
    for (cell, [start, count]) in ranges.into_iter().enumerate() {
        let shape = shapes.of_cell(cell);
        let own = &numbers[start..start + count];
        if shape.code == code::POLYHEDRON {
            let own: Vec<Vec<u32>> = own
                .iter()
                .map(|&face| faces.get(face as usize).cloned().ok_or(face))
                .collect::<std::result::Result<_, u32>>()
                .map_err(|face| out_of_range(&connectivity, cell, face, faces.len(), "subelement"))?;
            set.push_polyhedron(own);
        } else {
            if let Some(&point) = own.iter().find(|&&point| has_polyhedra && point as usize >= point_count) {
                return Err(out_of_range(&connectivity, cell, point, point_count, "point"));
            }
            set.push(shape.code, own.iter().copied());
        }
    }
    Ok(Cells::Mixed(set))
}

fn out_of_range(node: &Node, cell: usize, number: u32, count: usize, what: &str) -> Error {
    let error = Error::usage(format!("{}: cell {cell} names a {what} that does not exist", node.path()));
    error.got(number).expected(format!("a number below {count}"))
}

enum Shapes {
    One(&'static Shape),
    Each(Vec<&'static Shape>),
}

impl Shapes {
    fn of_cell(&self, cell: usize) -> &'static Shape {
        match self {
            Shapes::One(shape) => shape,
            Shapes::Each(shapes) => shapes[cell],
        }
    }

    fn has_polyhedra(&self) -> bool {
        let is_polyhedron = |shape: &Shape| shape.code == code::POLYHEDRON;
        match self {
            Shapes::One(shape) => is_polyhedron(shape),
            Shapes::Each(shapes) => shapes.iter().any(|shape| is_polyhedron(shape)),
        }
    }
}

/// The shape of each cell of a mixed topology.
fn each_shape(elements: &Node) -> Result<Vec<&'static Shape>> {
    let map = elements.require("shape_map")?;
    let mut known = Vec::new();
    for entry in map.children() {
        known.push((entry.count()? as i64, shape_named(&entry, entry.name())?));
    }
    let accepted = known.iter().map(|(number, shape)| format!("{number} ({})", shape.name));
    let accepted = accepted.collect::<Vec<_>>().join(", ");
    let find = |number: i64| known.iter().find(|entry| entry.0 == number).map(|entry| entry.1);
    elements.require("shapes")?.numbers()?.to_whole(accepted, find)
}

/// Start and length in the connectivity of each cell, or of each face.
fn ranges(elements: &Node, shapes: &Shapes) -> Result<Vec<[usize; 2]>> {
    let connectivity = elements.require("connectivity")?;
    let total = connectivity.numbers()?.count;
    let natural = |node: &Node| node.numbers()?.to_whole("0 or more", |number| usize::try_from(number).ok());
    let sizes = match (shapes, elements.get("sizes")) {
        (Shapes::One(shape), None) if shape.point_count > 0 => {
            let count = cell_count(&connectivity, &connectivity.numbers()?, shape.point_count)?;
            vec![shape.point_count; count]
        }
        (_, None) => natural(&elements.require("sizes")?)?,
        (_, Some(sizes)) => natural(&sizes)?,
    };
    if let Shapes::Each(shapes) = shapes
        && shapes.len() != sizes.len()
    {
        let node = elements.require("sizes")?;
        return Err(node.wrong(
            "has the wrong length",
            sizes.len(),
            format!("{}, one for each shape", shapes.len()),
        ));
    }
    let offsets = match elements.get("offsets") {
        Some(offsets) => natural(&offsets)?,
        None => {
            let start =
                |sum: &mut usize, size: &usize| Some(std::mem::replace(sum, sum.saturating_add(*size)));
            sizes.iter().scan(0_usize, start).collect()
        }
    };
    if offsets.len() != sizes.len() {
        let node = elements.require("offsets")?;
        return Err(node.wrong(
            "has the wrong length",
            offsets.len(),
            format!("{}, one for each cell", sizes.len()),
        ));
    }
    for (cell, (&start, &size)) in offsets.iter().zip(&sizes).enumerate() {
        if start.checked_add(size).is_none_or(|end| end > total) {
            let what = format!("ends before cell {cell} does");
            return Err(connectivity.wrong(&what, counted(total, "number"), start.saturating_add(size)));
        }
        let shape = shapes.of_cell(cell);
        if shape.point_count > 0 && size != shape.point_count {
            let what = format!("states a wrong size of cell {cell}, \"{}\"", shape.name);
            return Err(elements.wrong(&what, size, shape.point_count));
        }
    }
    Ok(offsets.into_iter().zip(sizes).map(|(start, size)| [start, size]).collect())
}

fn faces(subelements: &Node, point_count: usize) -> Result<Vec<Vec<u32>>> {
    let shape = subelements.require("shape")?;
    let name = shape.text()?;
    let shapes = match name.as_str() {
        MIXED => Shapes::Each(each_shape(subelements)?),
        _ => Shapes::One(shape_named(&shape, &name)?),
    };
    let numbers = point_numbers(&subelements.require("connectivity")?.numbers()?, point_count)?;
    let ranges = ranges(subelements, &shapes)?;
    Ok(ranges.into_iter().map(|[start, count]| numbers[start..start + count].to_vec()).collect())
}

/// Number of cells of so many points.
fn cell_count(node: &Node, numbers: &Numbers, point_count: usize) -> Result<usize> {
    match numbers.count.is_multiple_of(point_count) {
        true => Ok(numbers.count / point_count),
        false => {
            let accepted = format!("a multiple of {point_count}, the points of a cell");
            Err(node.wrong("has the wrong length", numbers.count, accepted))
        }
    }
}

fn check_numbers(numbers: &Numbers, count: usize) -> Result<()> {
    point_number(numbers, count, |_| ()).map(drop)
}

/// Numbers of points, or of others of which there are so many.
fn point_numbers(numbers: &Numbers, count: usize) -> Result<Vec<u32>> {
    point_number(numbers, count, |number| number)
}

fn point_number<T: Send>(numbers: &Numbers, count: usize, each: impl Fn(u32) -> T + Sync) -> Result<Vec<T>> {
    let accepted = format!("0 to {}", count.saturating_sub(1));
    numbers.to_whole(accepted, |number| {
        u32::try_from(number).ok().filter(|number| (*number as usize) < count).map(&each)
    })
}
