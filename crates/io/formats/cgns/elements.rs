//! Cells of an unstructured CGNS zone: sections of one element type, mixed sections, and polyhedra by their faces.
//!
//! Source: CGNS/SIDS 4.4, "Unstructured Grid ElementType Numbering Conventions" (element types, nodes on edges, faces and within) and
//! "Elements_t"; the order of VTK by the file formats of VTK, figures of quadratic cells. Elements are numbered through all
//! sections, from 1; values of cells are those of the three-dimensional ones, in that order. Nodes are numbered from 1.

use crate::formats::contents::{Meter, Stored};
use crate::formats::lazy;
use crate::formats::node_orders::{HEXAHEDRON, IN_ORDER, WEDGE};
use std::sync::atomic::AtomicBool;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result, counted};

/// An element type: number, name, dimension, number of nodes, VTK's cell type and for each of its points the place of the node.
struct ElementType {
    number: i64,
    name: &'static str,
    dimension: u8,
    node_count: usize,
    vtk: u8,
    order: &'static [u8],
}

const fn element(number: i64, name: &'static str, dimension: u8, node_count: usize) -> ElementType {
    ElementType { number, name, dimension, node_count, vtk: 0, order: &[] }
}

const fn volume(
    number: i64,
    name: &'static str,
    node_count: usize,
    vtk: u8,
    order: &'static [u8],
) -> ElementType {
    ElementType { number, name, dimension: 3, node_count, vtk, order }
}

const TETRA_4: i64 = 10;
const MIXED: i64 = 20;
const NGON: i64 = 22;
const NFACE: i64 = 23;
/// Pyramids with a node in the middle of the base, which is left out.
pub(super) const PYRA_14: i64 = 13;

const ELEMENTS: &[ElementType] = &[
    element(2, "NODE", 0, 1),
    element(3, "BAR_2", 1, 2),
    element(4, "BAR_3", 1, 3),
    element(5, "TRI_3", 2, 3),
    element(6, "TRI_6", 2, 6),
    element(7, "QUAD_4", 2, 4),
    element(8, "QUAD_8", 2, 8),
    element(9, "QUAD_9", 2, 9),
    volume(TETRA_4, "TETRA_4", 4, code::TETRA, IN_ORDER.split_at(4).0),
    volume(11, "TETRA_10", 10, code::QUADRATIC_TETRA, IN_ORDER.split_at(10).0),
    volume(12, "PYRA_5", 5, code::PYRAMID, IN_ORDER.split_at(5).0),
    // VTK has no pyramid with a node in its base alone.
    volume(PYRA_14, "PYRA_14", 14, code::QUADRATIC_PYRAMID, IN_ORDER.split_at(13).0),
    volume(14, "PENTA_6", 6, code::WEDGE, IN_ORDER.split_at(6).0),
    volume(15, "PENTA_15", 15, code::QUADRATIC_WEDGE, WEDGE.split_at(15).0),
    volume(16, "PENTA_18", 18, code::BIQUADRATIC_QUADRATIC_WEDGE, WEDGE),
    volume(17, "HEXA_8", 8, code::HEXAHEDRON, IN_ORDER.split_at(8).0),
    volume(18, "HEXA_20", 20, code::QUADRATIC_HEXAHEDRON, HEXAHEDRON.split_at(20).0),
    volume(19, "HEXA_27", 27, code::TRIQUADRATIC_HEXAHEDRON, HEXAHEDRON),
    volume(21, "PYRA_13", 13, code::QUADRATIC_PYRAMID, IN_ORDER.split_at(13).0),
    element(24, "BAR_4", 1, 4),
    element(25, "TRI_9", 2, 9),
    element(26, "TRI_10", 2, 10),
    element(27, "QUAD_12", 2, 12),
    element(28, "QUAD_16", 2, 16),
];

/// The number of an element type in a file of the library 3.0, which numbered PYRA_13 behind PYRA_5.
pub(super) fn of_version_3_0(kind: i64) -> i64 {
    match kind {
        13 => 21,
        14..NGON => kind - 1,
        _ => kind,
    }
}

pub(super) struct Section {
    /// Number of the element type.
    pub kind: i64,
    /// True if types within are numbered as the library 3.0 did.
    pub is_3_0: bool,
    /// Numbers of the first and last element.
    pub range: [u64; 2],
    pub connectivity: Stored,
    /// Beginning of each element's part of the connectivity, and the end of the last one.
    pub offsets: Option<Stored>,
}

impl Section {
    fn count(&self) -> Result<usize> {
        let [first, last] = self.range;
        let count = last.checked_sub(first).and_then(|span| usize::try_from(span).ok()?.checked_add(1));
        count.ok_or_else(|| {
            self.wrong("the range of elements is damaged").got(format_args!("{first} to {last}"))
        })
    }

    fn wrong(&self, what: &str) -> Error {
        Error::run(what).at_item(&self.connectivity.name)
    }
}

/// True if sections of a type can hold cells with a volume.
pub(super) fn may_have_volume(kind: i64) -> bool {
    [MIXED, NGON, NFACE].contains(&kind)
        || ELEMENTS.iter().find(|element| element.number == kind).is_none_or(|element| element.dimension == 3)
}

/// Number of cells with a volume: of the ranges of the sections, or of the zone where a section is mixed.
pub(super) fn count(sections: &[Section], of_zone: u64) -> u64 {
    let own = sections.iter().filter(|section| section.kind != NGON);
    let count = |section: &Section| (section.range[1].saturating_sub(section.range[0])).saturating_add(1);
    match sections.iter().any(|section| section.kind == MIXED) {
        true => of_zone,
        false => own.fold(0, |sum, section| sum.saturating_add(count(section))),
    }
}

/// The cells of a zone of so many; `sections` ascend.
pub(super) fn cells(sections: &[Section], cell_count: u64, meter: &Meter) -> Result<Cells> {
    if let [only] = sections
        && only.kind == TETRA_4
    {
        return tetrahedra(only, cell_count, meter);
    }
    let mut cells = CellSet::default();
    let faces = sections.iter().filter(|section| section.kind == NGON);
    let faces: Vec<Polygons> =
        faces.map(|section| Polygons::of_section(section, meter)).collect::<Result<_>>()?;
    for section in sections {
        match section.kind {
            MIXED => mixed(section, &mut cells, meter)?,
            NGON => {}
            NFACE => polyhedra(section, &faces, &mut cells, meter)?,
            kind => uniform(section, known(section, kind)?, &mut cells, meter)?,
        }
    }
    match cells.types.len() as u64 == cell_count {
        true => Ok(Cells::Mixed(cells)),
        false => Err(wrong_count(cells.types.len() as u64, cell_count)),
    }
}

fn wrong_count(found: u64, accepted: u64) -> Error {
    let error = Error::run("the zone's sections have the wrong number of three-dimensional cells");
    error.got(found).expected(format_args!("{accepted}, as the zone says"))
}

fn known(section: &Section, kind: i64) -> Result<&'static ElementType> {
    ELEMENTS.iter().find(|element| element.number == kind).ok_or_else(|| {
        section
            .wrong("an element type is not read")
            .got(format_args!("type {kind} of CGNS"))
            .expected("elements of first and second order, MIXED, NGON_n and NFACE_n")
    })
}

fn point(section: &Section, node: u32) -> Result<u32> {
    node.checked_sub(1).ok_or_else(|| section.wrong("a node number is wrong").got(0).expected("at least 1"))
}

/// The nodes of a section of elements with so many each, changed part by part.
fn nodes(
    section: &Section,
    element: &ElementType,
    meter: &Meter,
    change: impl Fn(&mut [u32]) + Sync,
) -> Result<Vec<u32>> {
    let nodes: Vec<u32> = section.connectivity.load_changed(meter, change)?;
    let count = section.count()?;
    match count.checked_mul(element.node_count) {
        Some(expected) if expected == nodes.len() => Ok(nodes),
        _ => {
            let error = section.wrong("the connectivity of a section has the wrong length").got(nodes.len());
            Err(error.expected(format_args!(
                "{} for each of {} {}",
                element.node_count,
                counted(count, "element"),
                element.name
            )))
        }
    }
}

fn tetrahedra(section: &Section, cell_count: u64, meter: &Meter) -> Result<Cells> {
    // Numbers beyond the points are found when the grid is built.
    let has_zero = AtomicBool::new(false);
    let nodes = nodes(section, known(section, TETRA_4)?, meter, |part| {
        lazy::count_from_zero(part, u32::MAX.into(), &has_zero);
    })?;
    if has_zero.into_inner() {
        point(section, 0)?;
    }
    let cells = lazy::tetrahedra(nodes);
    match cells.count() as u64 == cell_count {
        true => Ok(cells),
        false => Err(wrong_count(cells.count() as u64, cell_count)),
    }
}

fn uniform(section: &Section, element: &ElementType, cells: &mut CellSet, meter: &Meter) -> Result<()> {
    if element.dimension < 3 {
        return Ok(());
    }
    for nodes in nodes(section, element, meter, |_| ())?.chunks_exact(element.node_count) {
        push(section, element, nodes, &[], cells)?;
    }
    Ok(())
}

/// Adds an element with a volume.
///
/// `further`: nodes that VTK's cell lacks; once the grid is built they are left out with a warning.
fn push(
    section: &Section,
    element: &ElementType,
    nodes: &[u32],
    further: &[u32],
    cells: &mut CellSet,
) -> Result<()> {
    let nodes = element.order.iter().map(|&place| nodes[place as usize]).chain(further.iter().copied());
    for node in nodes.clone() {
        point(section, node)?;
    }
    cells.push(element.vtk, nodes.map(|node| node - 1));
    Ok(())
}

/// A section in which each element's type stands before its nodes.
fn mixed(section: &Section, cells: &mut CellSet, meter: &Meter) -> Result<()> {
    let numbers: Vec<u32> = section.connectivity.load(meter)?;
    let mut rest = &numbers[..];
    for number in 0..section.count()? {
        let ends = || section.wrong(&format!("the connectivity ends within element {number} of the section"));
        let (&kind, after) = rest.split_first().ok_or_else(ends)?;
        let kind = if section.is_3_0 { of_version_3_0(kind.into()) } else { kind.into() };
        let element = known(section, kind)?;
        let (nodes, after) = after.split_at_checked(element.node_count).ok_or_else(ends)?;
        if element.dimension == 3 {
            // The types of a mixed section are known only here.
            let further = nodes.get(element.order.len()..).filter(|_| element.number == PYRA_14);
            push(section, element, nodes, further.unwrap_or(&[]), cells)?;
        }
        rest = after;
    }
    match rest {
        [] => Ok(()),
        _ => Err(section
            .wrong("the connectivity holds more numbers than the elements take")
            .got(numbers.len())),
    }
}

/// Lists of numbers within one: by offsets, or with its length before each in files before version 4.
struct NumberLists<T> {
    numbers: Vec<T>,
    ranges: Vec<std::ops::Range<usize>>,
}

impl<T: crate::formats::numbers::Target + TryInto<u64>> NumberLists<T> {
    fn of_section(section: &Section, meter: &Meter) -> Result<NumberLists<T>> {
        let numbers: Vec<T> = section.connectivity.load(meter)?;
        let count = section.count()?;
        let wrong = || section.wrong("the parts of the connectivity do not fit it").got(numbers.len());
        let mut ranges = Vec::new();
        if let Some(offsets) = &section.offsets {
            let offsets: Vec<u64> = offsets.load(meter)?;
            if offsets.len() != count.saturating_add(1) {
                return Err(wrong().expected(format_args!("{} and an end", counted(count, "offset"))));
            }
            for pair in offsets.windows(2) {
                let range = usize::try_from(pair[0]).ok().zip(usize::try_from(pair[1]).ok());
                let range = range.filter(|(begin, end)| begin <= end && *end <= numbers.len());
                ranges.push(range.map(|(begin, end)| begin..end).ok_or_else(wrong)?);
            }
        } else {
            let mut at = 0;
            for _ in 0..count {
                let len = numbers.get(at).copied().and_then(|len| usize::try_from(len.try_into().ok()?).ok());
                let end = len.and_then(|len| len.checked_add(at + 1)).filter(|end| *end <= numbers.len());
                let end = end.ok_or_else(wrong)?;
                ranges.push(at + 1..end);
                at = end;
            }
        }
        Ok(NumberLists { numbers, ranges })
    }
}

/// Polygons of a section, by the numbers of its elements.
struct Polygons {
    first: u64,
    parts: NumberLists<u32>,
}

impl Polygons {
    fn of_section(section: &Section, meter: &Meter) -> Result<Polygons> {
        Ok(Polygons { first: section.range[0], parts: NumberLists::of_section(section, meter)? })
    }

    fn nodes(&self, number: u64) -> Option<&[u32]> {
        let range = self.parts.ranges.get(usize::try_from(number.checked_sub(self.first)?).ok()?)?;
        self.parts.numbers.get(range.clone())
    }
}

/// Polyhedra by the numbers of their faces, negative where the face's nodes turn the other way.
fn polyhedra(section: &Section, faces: &[Polygons], cells: &mut CellSet, meter: &Meter) -> Result<()> {
    let parts: NumberLists<i64> = NumberLists::of_section(section, meter)?;
    for range in &parts.ranges {
        let mut own = Vec::new();
        for number in &parts.numbers[range.clone()] {
            let before = faces.partition_point(|faces| faces.first <= number.unsigned_abs());
            let nodes = faces[..before].last().and_then(|faces| faces.nodes(number.unsigned_abs()));
            let nodes = nodes.ok_or_else(|| {
                section
                    .wrong("a polyhedron has a face that the zone lacks")
                    .got(format_args!("face {number}"))
            })?;
            own.push(nodes.iter().map(|&node| point(section, node)).collect::<Result<Vec<u32>>>()?);
        }
        cells.push_polyhedron(own);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::contents::Encoding;
    use std::sync::Arc;
    use voltet_core::grid::CellType;
    use voltet_core::progress::NoProgress;

    #[test]
    fn a_pyramid_of_14_nodes_in_a_mixed_section_keeps_13_with_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "a").unwrap();
        let source = crate::formats::source::Source::open(&path).unwrap();
        let numbers: Vec<f64> = [13.0].into_iter().chain((1..=14).map(f64::from)).collect();
        let compute = Arc::new(move |_: &Meter| Ok(numbers.clone()));
        let connectivity = Stored::of_f64(&source, "a", 1, 15, Encoding::Computed(compute));
        let section = Section { kind: MIXED, is_3_0: false, range: [1, 1], connectivity, offsets: None };
        let mut own = cells(&[section], 1, &Meter::new(&NoProgress, 1)).unwrap();
        let warning = crate::formats::cells::leave_out_further_points(&mut own);
        assert_eq!(
            warning.unwrap(),
            "The points of 1 cell beyond those that their type of cell has are left out."
        );
        let Cells::Mixed(own) = own else { panic!("of one type") };
        assert_eq!((own.types, own.offsets), (vec![code::QUADRATIC_PYRAMID], vec![0, 13]));
        assert_eq!(own.connectivity, (0..13).collect::<Vec<_>>());
    }

    #[test]
    fn each_order_names_nodes_once_and_as_many_as_the_cell_has_points() {
        for element in ELEMENTS.iter().filter(|element| element.dimension == 3) {
            let cell = CellType::from_code(element.vtk).unwrap();
            assert_eq!(
                (cell.dimension, usize::from(cell.point_count.unwrap())),
                (3, element.order.len()),
                "{}",
                element.name
            );
            let mut places = element.order.to_vec();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), element.order.len(), "{}", element.name);
            assert!(places.iter().all(|&place| usize::from(place) < element.node_count), "{}", element.name);
        }
    }
}
