//! Elements of Gmsh: their types, the order of their nodes, and the sections that hold them.
//!
//! Source: Gmsh reference manual, "Node ordering" and "MSH file format"; numbers of nodes as `getElementProperties` of Gmsh 4.15
//! gives them.

use crate::formats::cursor::Cursor;
use crate::formats::numbers::NumberType;
use crate::formats::text::is_space;
use std::collections::HashMap;
use voltet_core::grid::code;
use voltet_core::{Error, Result};

pub(super) struct GmshElement {
    /// Number of the type.
    pub number: u64,
    /// Type code of VTK.
    pub code: u8,
    /// For each node in VTK's order its place in Gmsh's.
    pub order: &'static [u8],
}

const fn element(number: u64, code: u8, order: &'static [u8]) -> GmshElement {
    GmshElement { number, code, order }
}

/// The volume elements that are read. Gmsh's pyramid of 14 nodes has one in the middle of its base, which VTK's has not.
const VOLUMES: [GmshElement; 12] = [
    element(4, code::TETRA, &[0, 1, 2, 3]),
    element(5, code::HEXAHEDRON, &[0, 1, 2, 3, 4, 5, 6, 7]),
    element(6, code::WEDGE, &[0, 1, 2, 3, 4, 5]),
    element(7, code::PYRAMID, &[0, 1, 2, 3, 4]),
    element(11, code::QUADRATIC_TETRA, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
    element(12, code::TRIQUADRATIC_HEXAHEDRON, &HEXAHEDRON),
    element(13, code::BIQUADRATIC_QUADRATIC_WEDGE, &WEDGE),
    element(14, code::QUADRATIC_PYRAMID, &PYRAMID),
    element(17, code::QUADRATIC_HEXAHEDRON, HEXAHEDRON.split_at(20).0),
    element(18, code::QUADRATIC_WEDGE, WEDGE.split_at(15).0),
    element(19, code::QUADRATIC_PYRAMID, &PYRAMID),
    element(29, code::LAGRANGE_TETRAHEDRON, &CUBIC_TETRAHEDRON),
];

/// Corners, edges, faces, middle.
const HEXAHEDRON: [u8; 27] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26];
/// Corners, edges, quadrilaterals.
const WEDGE: [u8; 18] = [0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16];
/// Corners, edges.
const PYRAMID: [u8; 13] = [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12];
/// Corners, two nodes on each edge, one on each face.
const CUBIC_TETRAHEDRON: [u8; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 10, 15, 14, 13, 12, 17, 19, 18, 16];

/// Number of nodes of an element of each type that is no volume, or that is passed over; 0: a type of volumes, or none.
const PASSED_OVER: [u8; 66] = [
    0, 2, 3, 4, 0, 0, 0, 0, 3, 6, 9, 0, 0, 0, 0, 1, 8, 0, 0, 0, 9, 10, 12, 15, 15, 21, 4, 5, 6, 0, 0, 0, 0,
    0, 0, 0, 16, 25, 36, 12, 16, 20, 28, 36, 45, 55, 66, 49, 64, 81, 100, 121, 18, 21, 24, 27, 30, 24, 28,
    32, 36, 40, 7, 8, 9, 10,
];

/// Elements of one type and physical group that follow one another.
pub(super) struct ElementRun<'a> {
    pub volume: &'static GmshElement,
    /// Number of the physical group; 0: none.
    pub group: i64,
    /// Nodes of an element in the file.
    pub node_count: usize,
    /// For each element its tag and those of its nodes, in Gmsh's order.
    pub rows: &'a [u64],
}

impl ElementRun<'_> {
    pub fn count(&self) -> usize {
        self.rows.len() / (1 + self.node_count)
    }
}

/// Ways in which elements stand in a section, by the version of the format.
#[derive(Clone, Copy)]
pub(super) enum ElementRows<'a> {
    First,
    Second,
    /// With the physical groups of the volumes; version 4.0 has entities in another order than 4.1.
    Fourth {
        groups: &'a HashMap<i64, i64>,
        is_4_0: bool,
    },
}

/// Calls `visit` with all volume elements of the section at the cursor.
pub(super) fn each(
    cursor: &mut Cursor,
    rows: ElementRows,
    mut visit: impl FnMut(&ElementRun) -> Result<()>,
) -> Result<()> {
    match rows {
        ElementRows::Fourth { groups, is_4_0 } => each_of_4(cursor, groups, is_4_0, &mut visit),
        ElementRows::Second => each_of_2(cursor, &mut visit),
        ElementRows::First => {
            let count: u64 = cursor.number(NumberType::U64, "the number of elements")?;
            each_row(cursor, count, true, &mut visit)
        }
    }
}

/// Dimension and tag of an entity.
pub(super) fn entity_head(cursor: &mut Cursor, is_4_0: bool) -> Result<(i64, i64)> {
    let first = cursor.number(NumberType::I32, "the dimension or tag of an entity")?;
    let second = cursor.number(NumberType::I32, "the dimension or tag of an entity")?;
    Ok(if is_4_0 { (second, first) } else { (first, second) })
}

/// The type with this number, `None` for one without volume, and its number of nodes.
fn element_type(number: u64) -> Result<(Option<&'static GmshElement>, usize)> {
    if let Some(volume) = VOLUMES.iter().find(|volume| volume.number == number) {
        let count = if number == 14 { 14 } else { volume.order.len() };
        return Ok((Some(volume), count));
    }
    let passed_over = usize::try_from(number).ok().and_then(|number| PASSED_OVER.get(number));
    match passed_over {
        Some(&node_count @ 1..) => Ok((None, node_count.into())),
        _ => Err(Error::run("elements of this type of Gmsh are not read").got(number).expected(
            "tetrahedra of the orders 1 to 3; hexahedra, prisms and pyramids of the orders 1 and 2",
        )),
    }
}

/// Version 4: entities, each with elements of one type.
fn each_of_4(
    cursor: &mut Cursor,
    groups: &HashMap<i64, i64>,
    is_4_0: bool,
    visit: &mut dyn FnMut(&ElementRun) -> Result<()>,
) -> Result<()> {
    each_entity(cursor, groups, is_4_0, &mut |cursor, entity| {
        let &EntityElements { volume, group, count, node_count } = entity;
        each_batch(count, 1 + node_count as u64, |count| {
            let numbers = count * (1 + node_count as u64);
            let rows: Vec<u64> = cursor.numbers(NumberType::U64, numbers, "the tag of an element or node")?;
            visit(&ElementRun { volume, group, node_count, rows: &rows })
        })
    })
}

/// Numbers of a table that are in memory at a time: few enough to stay in the cache of several cores, and enough for all of them.
const BATCH: u64 = 1 << 20;

/// Calls `read` with the number of rows of each part of a table of `count` rows of so many numbers.
pub(super) fn each_batch(count: u64, width: u64, mut read: impl FnMut(u64) -> Result<()>) -> Result<()> {
    let mut left = count;
    while left > 0 {
        let rows = left.min((BATCH / width.max(1)).max(1));
        read(rows)?;
        left -= rows;
    }
    Ok(())
}

/// Volume elements of an entity of version 4.1.
struct EntityElements {
    volume: &'static GmshElement,
    group: i64,
    count: u64,
    node_count: usize,
}

/// Calls `visit` with the head of each entity of volume elements, which has to move behind these.
fn each_entity(
    cursor: &mut Cursor,
    groups: &HashMap<i64, i64>,
    is_4_0: bool,
    visit: &mut dyn FnMut(&mut Cursor, &EntityElements) -> Result<()>,
) -> Result<()> {
    let size = NumberType::U64;
    let entity_count: u64 = cursor.number(size, "the number of entities")?;
    for _ in 0..if is_4_0 { 1 } else { 3 } {
        cursor.number::<u64>(size, "numbers of elements")?;
    }
    for _ in 0..entity_count {
        let (dimension, entity) = entity_head(cursor, is_4_0)?;
        let number: u64 = cursor.number(NumberType::I32, "a type of elements")?;
        let count: u64 = cursor.number(size, "a number of elements")?;
        let (volume, node_count) = element_type(number).map_err(|error| cursor.locate(error))?;
        let group = if dimension == 3 { groups.get(&entity).copied().unwrap_or(0) } else { 0 };
        match volume {
            Some(volume) => visit(cursor, &EntityElements { volume, group, count, node_count })?,
            None => skip_elements(cursor, count, node_count)?,
        }
    }
    Ok(())
}

/// Passes over elements of version 4.1, whose numbers are not parsed.
fn skip_elements(cursor: &mut Cursor, count: u64, node_count: usize) -> Result<()> {
    cursor.skip_numbers(count.saturating_mul(node_count as u64 + 1), 8)
}

/// Calls `visit` with the type, the physical group, the number and the numbers of nodes of volume elements; parameters as of [`each`].
pub(super) fn count(
    cursor: &mut Cursor,
    rows: ElementRows,
    mut visit: impl FnMut(&'static GmshElement, i64, u64, usize),
) -> Result<()> {
    match rows {
        ElementRows::Fourth { groups, is_4_0 } => {
            each_entity(cursor, groups, is_4_0, &mut |cursor, entity| {
                visit(entity.volume, entity.group, entity.count, entity.node_count);
                skip_elements(cursor, entity.count, entity.node_count)
            })
        }
        _ => each(cursor, rows, |run| {
            visit(run.volume, run.group, run.count() as u64, run.node_count);
            Ok(())
        }),
    }
}

/// Version 2: elements with tags, in bytes after a head for several of one type.
fn each_of_2(cursor: &mut Cursor, visit: &mut dyn FnMut(&ElementRun) -> Result<()>) -> Result<()> {
    let binary = cursor.binary.take();
    let count: u64 = cursor.number(NumberType::U64, "the number of elements")?;
    if binary.is_none() {
        return each_row(cursor, count, false, visit);
    }
    cursor.line()?;
    cursor.binary = binary;
    let int = NumberType::I32;
    let (mut passed, mut own) = (0, Vec::new());
    while passed < count {
        let number: u64 = cursor.number(int, "a type of elements")?;
        let group_count: u64 = cursor.number(int, "a number of elements")?;
        let tag_count: u64 = cursor.number(int, "the number of tags")?;
        let (volume, node_count) = element_type(number).map_err(|error| cursor.locate(error))?;
        if group_count == 0 || group_count > count - passed {
            return Err(cursor
                .error("a group of elements does not fit their number")
                .got(group_count)
                .expected(format_args!("1 to {}", count - passed)));
        }
        let width = tag_count.saturating_add(1 + node_count as u64);
        each_batch(group_count, width, |count| {
            let start = cursor.position();
            let rows: Vec<i64> = cursor.numbers(
                int,
                count.saturating_mul(width),
                "a number, a tag or a node of an element",
            )?;
            let (mut place, tag_count) = (0, tag_count as usize);
            let group = |row: &[i64]| group_of(&row[1..1 + tag_count]);
            let rows: Vec<&[i64]> = rows.chunks_exact(width as usize).collect();
            for same in rows.chunk_by(|a, b| group(a) == group(b)) {
                own.clear();
                let added = same.iter().try_for_each(|row| {
                    let byte = start + 4 * width * place;
                    place += 1;
                    let added = add_row(row[0], &row[1 + tag_count..], &mut own);
                    added.map_err(|error| Error::run(error).at_item(format!("byte {byte}")))
                });
                // Errors of rows come in their order.
                own.truncate(own.len() / (1 + node_count) * (1 + node_count));
                if let Some(volume) = volume {
                    visit(&ElementRun { volume, group: group(same[0]), node_count, rows: &own })?;
                }
                added?;
            }
            Ok(())
        })?;
        passed += group_count;
    }
    Ok(())
}

/// Rows of text: the number of an element, its type, the number of tags, tags, nodes. In version 1 the two tags stand before the number of
/// the nodes.
fn each_row(
    cursor: &mut Cursor,
    count: u64,
    is_first: bool,
    visit: &mut dyn FnMut(&ElementRun) -> Result<()>,
) -> Result<()> {
    let (mut passed, mut own) = (0, Vec::new());
    let range = cursor.rest();
    // A number takes a digit and a space.
    let most = range.len() / 2;
    let is_whole = range.stream(NumberType::I64, is_space, |shown: &[i64]| {
        let mut used = 0;
        while passed < count {
            let row = &shown[used..];
            let &[tag, number, third, ref rest @ ..] = row else { return Ok(Some(used)) };
            let (tag_count, rest) = if is_first { (3, &row[2..]) } else { (third, rest) };
            let begin = row.len() - rest.len();
            let at = |place: usize| move |error: String| (used + place, Error::run(error));
            whole(tag).map_err(at(0))?;
            let tag_count = whole(tag_count).map_err(at(2))?;
            if tag_count > most {
                let error = Error::run("the tags of an element do not fit the file").got(tag_count);
                return Err((used + 2, error.expected(format_args!("at most {most}"))));
            }
            let of_type = whole(number).map_err(at(1))?;
            let (volume, node_count) = element_type(of_type).map_err(|error| (used + 1, error))?;
            let Some((tags, rest)) =
                usize::try_from(tag_count).ok().and_then(|count| rest.split_at_checked(count))
            else {
                return Ok(Some(used));
            };
            // Version 1 states the number of nodes, too.
            if let Some(&stated) = tags.get(2).filter(|&&own| is_first && own != node_count as i64) {
                let error = Error::run("an element has another number of nodes than its type").got(stated);
                return Err((used + 4, error.expected(node_count)));
            }
            let Some(nodes) = rest.get(..node_count) else { return Ok(Some(used)) };
            own.clear();
            add_row(tag, nodes, &mut own).map_err(at(begin + tags.len()))?;
            if let Some(volume) = volume {
                visit(&ElementRun { volume, group: group_of(tags), node_count, rows: &own })
                    .map_err(|error| (used, error))?;
            }
            used += begin + tags.len() + node_count;
            passed += 1;
        }
        Ok(None)
    })?;
    match is_whole || passed == count {
        true => Ok(()),
        false => {
            let error = Error::run("the file ends early").got(passed);
            Err(range.locate_end(error.expected(format_args!("{count} elements"))))
        }
    }
}

/// The first tag, the physical group. A negative one turns the element round.
fn group_of(tags: &[i64]) -> i64 {
    tags.first().map_or(0, |group| group.saturating_abs())
}

/// A number that is not negative. Errors: a sentence.
fn whole(number: i64) -> std::result::Result<u64, String> {
    u64::try_from(number).map_err(|_| format!("a number of an element is negative, {number}"))
}

fn add_row(tag: i64, nodes: &[i64], to: &mut Vec<u64>) -> std::result::Result<(), String> {
    to.push(whole(tag)?);
    nodes.iter().try_for_each(|&node| whole(node).map(|node| to.push(node)))
}
