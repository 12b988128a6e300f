//! The mesh of a file: version and encoding, nodes, and the elements that are volumes.

use super::elements::{ElementRows, ElementRun, GmshElement, count, each, each_batch, entity_head};
use crate::formats::cursor::Cursor;
use crate::formats::lazy::{MeshTags, Tags, missing_node, tetrahedra};
use crate::formats::numbers::{ByteOrder, NumberType, convert};
use crate::formats::source::Source;
use crate::formats::text::is_space;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::parallel::all_or_first;
use voltet_core::{Error, Result};

#[derive(Clone, Default)]
pub(super) struct MeshSection {
    pub start: u64,
    pub end: u64,
    pub line: usize,
}

pub(super) struct MeshFile {
    pub source: Arc<Source>,
    pub version: f64,
    pub binary: Option<ByteOrder>,
    pub nodes: MeshSection,
    pub elements: MeshSection,
    /// Physical groups of the volumes of version 4.
    pub group_of_volume: HashMap<i64, i64>,
    /// Physical groups of the volume elements, in the order of blocks; 0: none.
    pub groups: Vec<i64>,
    group_places: HashMap<i64, usize>,
    /// Flags of the groups that are read.
    pub is_selected: Vec<bool>,
    /// Numbers of selected volume elements and of their corners, which the file holds.
    pub selected_counts: [usize; 2],
    /// True if each cell has points of its own.
    pub is_split: bool,
    /// Tags of the nodes and of the selected elements, once they were read.
    tags: MeshTags,
}

/// Numbers of the volume elements of a group, or of all that are read.
#[derive(Default)]
pub(super) struct GroupCounts {
    pub cells: u64,
    pub corners: u64,
    /// Pyramids of 14 nodes.
    pub reduced: u64,
}

/// Selected volume elements.
pub(super) struct Volumes {
    /// Numbers of the nodes of all elements, in VTK's order.
    pub connectivity: Vec<u32>,
    tags: Vec<u64>,
    /// Types, each with the ends of the elements of it and of their corners.
    kinds: Vec<(&'static GmshElement, usize, usize)>,
    /// Places in [`MeshFile::groups`], each with the end of the elements there.
    blocks: Vec<(usize, usize)>,
}

impl Volumes {
    /// Places for so many elements and corners, which the file holds.
    fn new([cell_count, corner_count]: [usize; 2]) -> Volumes {
        let (connectivity, tags) = (vec![0; corner_count], vec![0; cell_count]);
        Volumes { connectivity, tags, kinds: Vec::new(), blocks: Vec::new() }
    }

    fn add(&mut self, run: &ElementRun, block: usize, nodes: &Tags) -> Result<()> {
        let (first, corner) = self.kinds.last().map_or((0, 0), |&(_, end, corner_end)| (end, corner_end));
        let end = first + run.count();
        let corner_end = corner + run.count() * run.volume.order.len();
        let corners = self.connectivity.get_mut(corner..corner_end);
        let (Some(corners), Some(tags)) = (corners, self.tags.get_mut(first..end)) else {
            return Err(Error::run("the file has changed while it was read"));
        };
        number_corners(run, nodes, corners, tags)?;
        match self.kinds.last_mut().filter(|kind| kind.0.number == run.volume.number) {
            Some(kind) => (kind.1, kind.2) = (end, corner_end),
            None => self.kinds.push((run.volume, end, corner_end)),
        }
        match self.blocks.last_mut().filter(|last| last.0 == block) {
            Some(last) => last.1 = end,
            None => self.blocks.push((block, end)),
        }
        Ok(())
    }

    /// Places of the cells in [`MeshFile::groups`].
    pub fn block_numbers(&self) -> Vec<f64> {
        let mut numbers = Vec::new();
        self.blocks.iter().for_each(|&(block, end)| numbers.resize(end, block as f64));
        numbers
    }

    /// Order of a cell's nodes, and the place of the first in the connectivity.
    pub fn corners(&self, cell: usize) -> (&'static [u8], usize) {
        let kind = self.kinds.partition_point(|kind| kind.1 <= cell);
        let before = kind.checked_sub(1).map(|before| self.kinds[before]);
        let (first, corner) = before.map_or((0, 0), |(_, end, corner_end)| (end, corner_end));
        let order = self.kinds.get(kind).map_or(&[][..], |kind| kind.0.order);
        (order, corner + (cell - first) * order.len())
    }

    /// All cells; as tetrahedra where they are nothing else.
    fn into_cells(self) -> Cells {
        match self.kinds[..] {
            [(kind, ..)] if kind.code == code::TETRA => tetrahedra(self.connectivity),
            _ => Cells::Mixed(self.into_set()),
        }
    }

    fn into_set(self) -> CellSet {
        let (mut types, mut offsets, mut corner) = (Vec::new(), vec![0], 0);
        for (kind, end, corner_end) in self.kinds {
            types.resize(end, kind.code);
            let ends = (corner as u64..=corner_end as u64).step_by(kind.order.len());
            offsets.extend(ends.skip(1));
            corner = corner_end;
        }
        CellSet { types, offsets, connectivity: self.connectivity, polyhedra: Vec::new() }
    }
}

impl MeshFile {
    /// At the beginning of a section; `is_binary`: if its numbers are bytes in a file of bytes.
    pub fn cursor(&self, section: &MeshSection, is_binary: bool) -> Cursor {
        let mut cursor = Cursor::within(&self.source, section.start, section.end, section.line);
        cursor.binary = self.binary.filter(|_| is_binary);
        cursor
    }

    /// True for the version whose entities and nodes stand in another order.
    pub fn is_4_0(&self) -> bool {
        (4.0..4.1).contains(&self.version)
    }

    fn element_rows(&self) -> ElementRows<'_> {
        match self.version {
            ..2.0 => ElementRows::First,
            2.0..4.0 => ElementRows::Second,
            _ => ElementRows::Fourth { groups: &self.group_of_volume, is_4_0: self.is_4_0() },
        }
    }

    /// End of the rows of bytes of a section that begins at the cursor, by the heads of entities; `None` where these do not tell it.
    pub fn end_of_rows(&self, cursor: &Cursor, name: &str) -> Option<u64> {
        let mut ahead = cursor.clone();
        ahead.binary = self.binary;
        let is_passed = match name {
            _ if self.version < 4.0 => false,
            "Nodes" => skip_nodes_of_4(&mut ahead).is_ok(),
            _ => count(&mut ahead, self.element_rows(), |_, _, _, _| {}).is_ok(),
        };
        is_passed.then(|| ahead.position())
    }

    pub fn format(&self) -> String {
        let encoding = match self.binary {
            None => "ASCII",
            Some(ByteOrder::Little) => "binary, little-endian",
            Some(ByteOrder::Big) => "binary, big-endian",
        };
        format!("Gmsh {}, {encoding}", self.version)
    }

    pub fn node_count(&self) -> Result<u64> {
        let mut cursor = self.cursor(&self.nodes, self.version >= 4.0);
        if self.version >= 4.0 {
            cursor.number::<u64>(NumberType::U64, "the number of entities")?;
        }
        let nodes: u64 = cursor.number(NumberType::U64, "the number of nodes")?;
        // A node takes its tag and three coordinates with spaces.
        if nodes > cursor.left() / 8 + 1 {
            return Err(cursor.error("the nodes do not fit the file").got(nodes));
        }
        Ok(nodes)
    }

    /// Finds the physical groups of the volume elements, and counts these and their nodes by group. Groups with a name stand first.
    pub fn find_groups(&mut self, names: &[(i64, String)]) -> Result<Vec<GroupCounts>> {
        let mut groups: Vec<i64> = names.iter().map(|name| name.0).collect();
        let mut counts: Vec<GroupCounts> = groups.iter().map(|_| GroupCounts::default()).collect();
        let mut places = HashMap::new();
        for (place, &group) in groups.iter().enumerate() {
            places.entry(group).or_insert(place);
        }
        let mut place = 0;
        count(
            &mut self.cursor(&self.elements, true),
            self.element_rows(),
            |volume, group, count, node_count| {
                if groups.get(place) != Some(&group) {
                    place = *places.entry(group).or_insert(groups.len());
                }
                if place == groups.len() {
                    groups.push(group);
                    counts.push(GroupCounts::default());
                }
                let corner_count = volume.order.len();
                let own = &mut counts[place];
                own.cells = own.cells.saturating_add(count);
                own.corners = own.corners.saturating_add(count.saturating_mul(corner_count as u64));
                own.reduced = own.reduced.saturating_add(if node_count == corner_count { 0 } else { count });
            },
        )?;
        self.groups = groups;
        self.group_places = places;
        Ok(counts)
    }

    /// Positions of the nodes; their tags are kept.
    fn read_nodes(&self) -> Result<Vec<DVec3>> {
        let mut nodes = Nodes::default();
        let mut cursor = self.cursor(&self.nodes, self.version >= 4.0);
        match self.version < 4.0 {
            true => nodes.read_2(&mut cursor, self.binary)?,
            false => nodes.read_4(&mut cursor, self.is_4_0())?,
        }
        let Nodes { tags, points } = nodes;
        self.tags.keep(0, Tags::new(tags, "node", |tag| tag)?);
        Ok(points)
    }

    /// Tags of the nodes (0) or of the selected elements (1), read if they were not yet.
    pub fn tags(&self, kind: usize) -> Result<Arc<Tags>> {
        self.tags.get(kind, || match kind {
            0 => self.read_nodes().map(drop),
            _ => self.read_volumes().map(drop),
        })
    }

    /// Calls `visit` with the selected volume elements and their place among the groups.
    fn each_run(&self, mut visit: impl FnMut(&ElementRun, usize) -> Result<()>) -> Result<()> {
        let mut block = 0;
        each(&mut self.cursor(&self.elements, true), self.element_rows(), |run| {
            if self.groups.get(block) != Some(&run.group) {
                block = self.group_places.get(&run.group).copied().unwrap_or(0);
            }
            match self.is_selected.get(block) {
                Some(true) => visit(run, block),
                _ => Ok(()),
            }
        })
    }

    /// Selected volume elements with numbers of nodes; their tags are kept.
    pub fn read_volumes(&self) -> Result<Volumes> {
        let nodes = self.tags(0)?;
        let mut volumes = Volumes::new(self.selected_counts);
        self.each_run(|run, block| volumes.add(run, block, &nodes))?;
        self.tags.keep(1, Tags::new(std::mem::take(&mut volumes.tags), "element", |tag| tag)?);
        Ok(volumes)
    }

    pub fn read_geometry(&self) -> Result<(Vec<DVec3>, Cells)> {
        let points = self.read_nodes()?;
        let cells = self.read_volumes()?;
        if !self.is_split {
            return Ok((points, cells.into_cells()));
        }
        let mut set = cells.into_set();
        let own = set.connectivity.iter().map(|&node| points[node as usize]).collect::<Vec<_>>();
        set.connectivity = (0..own.len() as u32).collect();
        Ok((own, Cells::Mixed(set)))
    }
}

/// Elements that are numbered by one task.
const PART: usize = 1 << 12;

/// Numbers of the nodes of elements, in VTK's order, and the tags of the elements. Errors: the first node that is not there.
fn number_corners(run: &ElementRun, nodes: &Tags, corners: &mut [u32], tags: &mut [u64]) -> Result<()> {
    let (width, order) = (1 + run.node_count, run.volume.order);
    let all_of = |((corners, tags), rows): ((&mut [u32], &mut [u64]), &[u64])| {
        let places = corners.chunks_exact_mut(order.len()).zip(tags);
        for ((to, tag), row) in places.zip(rows.chunks_exact(width)) {
            *tag = row[0];
            for (to, &place) in to.iter_mut().zip(order) {
                let node = row[1 + usize::from(place)];
                *to = nodes.find(node).ok_or_else(|| missing_node(row[0], node))? as u32;
            }
        }
        Ok(())
    };
    if run.count() <= PART {
        return all_of(((corners, tags), run.rows));
    }
    let places = corners.par_chunks_mut(PART * order.len()).zip(tags.par_chunks_mut(PART));
    let parts = places.zip(run.rows.par_chunks(PART * width)).map(all_of);
    all_or_first(parts).map(drop)
}

#[derive(Default)]
struct Nodes {
    tags: Vec<u64>,
    points: Vec<DVec3>,
}

/// Calls `visit` with the number of nodes of each entity of version 4 and the numbers of a position, behind which it has to move.
fn each_nodes_of_4(
    cursor: &mut Cursor,
    is_4_0: bool,
    mut visit: impl FnMut(&mut Cursor, u64, u64) -> Result<()>,
) -> Result<()> {
    let (int, size) = (NumberType::I32, NumberType::U64);
    let entity_count: u64 = cursor.number(size, "the number of entities")?;
    for _ in 0..if is_4_0 { 1 } else { 3 } {
        cursor.number::<u64>(size, "numbers of nodes")?;
    }
    for _ in 0..entity_count {
        let dimension = entity_head(cursor, is_4_0)?.0;
        let is_parametric = cursor.number::<u64>(int, "0 or 1")? == 1;
        let count: u64 = cursor.number(size, "a number of nodes")?;
        visit(cursor, count, 3 + if is_parametric { dimension.clamp(0, 3) as u64 } else { 0 })?;
    }
    Ok(())
}

/// Passes over the nodes of version 4.1.
fn skip_nodes_of_4(cursor: &mut Cursor) -> Result<()> {
    let skip =
        |cursor: &mut Cursor, count: u64, width| cursor.skip_numbers(count.saturating_mul(1 + width), 8);
    each_nodes_of_4(cursor, false, skip)
}

impl Nodes {
    /// Version 4: entities, each with the tags of its nodes, then positions with parameters; in 4.0 rows of both.
    fn read_4(&mut self, cursor: &mut Cursor, is_4_0: bool) -> Result<()> {
        each_nodes_of_4(cursor, is_4_0, |cursor, count, width| {
            if is_4_0 {
                return each_batch(count, 1 + width, |count| {
                    let start = cursor.clone();
                    let rows: Vec<f64> =
                        cursor.numbers(NumberType::F64, count * (1 + width), "a tag or a coordinate")?;
                    for (place, row) in rows.chunks_exact(1 + width as usize).enumerate() {
                        let tag = node_tag(row[0]);
                        self.tags.push(tag.map_err(|error| {
                            let mut row = start.clone();
                            let found = row.skip_numbers(place as u64 * (1 + width), 8);
                            found
                                .and_then(|()| row.word().map(drop))
                                .map_or(error.clone(), |()| row.locate(error))
                        })?);
                        self.points.push(DVec3::from_slice(&row[1..]));
                    }
                    Ok(())
                });
            }
            self.tags.extend(cursor.numbers::<u64>(NumberType::U64, count, "the tag of a node")?);
            each_batch(count, width, |count| {
                let rows: Vec<f64> = cursor.numbers(NumberType::F64, count * width, "a coordinate")?;
                self.points.extend(rows.chunks_exact(width as usize).map(DVec3::from_slice));
                Ok(())
            })
        })
    }

    /// Version 2: rows of a number and a position.
    fn read_2(&mut self, cursor: &mut Cursor, binary: Option<ByteOrder>) -> Result<()> {
        let count: u64 = cursor.number(NumberType::U64, "the number of nodes")?;
        if binary.is_some() {
            cursor.line()?;
            cursor.binary = binary;
        }
        each_row(cursor, count, 3, |tag, position| {
            self.tags.push(tag);
            self.points.push(DVec3::from_slice(position));
            Ok(())
        })
    }
}

/// The number of a node or element in a row of floats, which hold whole numbers below 2^53.
fn node_tag(number: f64) -> Result<u64> {
    match number.fract() == 0.0 && (0.0..9e15).contains(&number) {
        true => Ok(number as u64),
        false => {
            let error = Error::run("a number is damaged").got(number);
            Err(error.expected("the number of a node or element"))
        }
    }
}

/// Calls `visit` with the rows of a table: a number, and so many values.
pub(super) fn each_row(
    cursor: &mut Cursor,
    count: u64,
    width: usize,
    mut visit: impl FnMut(u64, &[f64]) -> Result<()>,
) -> Result<()> {
    if let Some(order) = cursor.binary {
        let (mut values, mut tag) = (vec![0.0; width], [0_u64]);
        for _ in 0..count {
            let row = cursor.bytes(4 + 8 * width)?;
            let is_good = convert(NumberType::I32, order, row, &mut tag).is_ok();
            // Every number is a float.
            let _ = convert(NumberType::F64, order, &row[4..], &mut values);
            if !is_good {
                return Err(cursor.error("a number is damaged").expected("the number of a node or element"));
            }
            visit(tag[0], &values)?;
        }
        return Ok(());
    }
    let mut passed = 0;
    let range = cursor.rest();
    let read = range.stream(NumberType::F64, is_space, |shown: &[f64]| {
        for (place, row) in shown.chunks_exact(1 + width).enumerate() {
            if passed == count {
                return Ok(None);
            }
            let at = |error: Error| (place * (1 + width), error);
            node_tag(row[0]).and_then(|tag| visit(tag, &row[1..])).map_err(at)?;
            passed += 1;
        }
        Ok((passed < count).then_some(shown.len() / (1 + width) * (1 + width)))
    });
    let what = |error: Error| match error.expected.as_deref() {
        Some("a number") => error.expected("the number of a node or element, or a value"),
        _ => error,
    };
    read.map_err(what)?;
    match passed == count {
        true => Ok(()),
        false => {
            let error = Error::run("the file ends early").got(passed);
            Err(range.locate_end(error.expected(format_args!("{count} rows of numbers"))))
        }
    }
}

/// Version, encoding and byte order; those of the first version are not in the file.
pub(super) fn header(cursor: &mut Cursor, source: &Arc<Source>, is_first: bool) -> Result<MeshFile> {
    let line = if is_first { "1 0 8".to_owned() } else { cursor.text_line("the version of the format")? };
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let version = words.first().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
    let is_text = words.get(1) == Some(&"0");
    let is_old_text = is_text && [1.0, 4.0].contains(&version);
    if !(is_old_text || (2.0..3.0).contains(&version) || (4.1..5.0).contains(&version)) {
        let error = cursor.error("this version of Gmsh's format is not read").got(format_args!("'{line}'"));
        return Err(error.expected(
            "1, 2 or 4, of 1 and 4.0 text: `gmsh FILE -save -o out.msh -format msh41` writes 4.1",
        ));
    }
    if !is_text && words.get(2) != Some(&"8") {
        let error = cursor.error("numbers of this size are not read").got(format_args!("'{line}'"));
        return Err(error.expected("a size of 8 bytes"));
    }
    let binary = match words.get(1) {
        Some(&"0") => None,
        Some(&"1") => match cursor.bytes(4)? {
            [1, 0, 0, 0] => Some(ByteOrder::Little),
            [0, 0, 0, 1] => Some(ByteOrder::Big),
            other => {
                let found = format!("{other:?}");
                return Err(cursor.error("the byte order is damaged").got(found).expected("the number 1"));
            }
        },
        _ => {
            let error = cursor.error("the file says neither text nor bytes").got(format_args!("'{line}'"));
            return Err(error.expected("0 or 1 as the second number"));
        }
    };
    Ok(MeshFile {
        source: source.clone(),
        version,
        binary,
        nodes: MeshSection::default(),
        elements: MeshSection::default(),
        group_of_volume: HashMap::new(),
        groups: Vec::new(),
        group_places: HashMap::new(),
        is_selected: Vec::new(),
        selected_counts: [0; 2],
        is_split: false,
        tags: MeshTags::default(),
    })
}
