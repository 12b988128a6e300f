//! The mesh of a file: version and encoding, nodes, and the elements that are volumes.

use super::elements::{MeshElement, count, each, each_batch};
use crate::formats::cursor::Cursor;
use crate::formats::lazy::{GatheredCells, MeshTags, Tags, missing_node};
use crate::formats::numbers::{ByteOrder, NumberType, convert};
use crate::formats::source::Source;
use crate::formats::text::is_space;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::grid::Cells;
use voltet_core::{Error, Result};

/// A part of the file.
#[derive(Clone, Default)]
pub(super) struct MeshSection {
    pub start: u64,
    pub end: u64,
    pub line: usize,
}

/// Table of contents of a file.
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
    pub cells: GatheredCells,
    tags: Vec<u64>,
    /// Places in [`MeshFile::groups`].
    pub blocks: Vec<f64>,
    pub orders: NodeOrders,
}

/// Orders of the nodes of cells, each with the first of the cells that have it.
#[derive(Default)]
pub(super) struct NodeOrders(Vec<(usize, &'static [u8])>);

impl NodeOrders {
    /// Adds the order of a cell behind those that were added.
    fn add(&mut self, cell: usize, order: &'static [u8]) {
        if self.0.last().is_none_or(|run| !std::ptr::eq(run.1, order)) {
            self.0.push((cell, order));
        }
    }

    /// Order of a cell's nodes.
    pub fn order(&self, cell: usize) -> &'static [u8] {
        let run = self.0.partition_point(|run| run.0 <= cell);
        self.0.get(run.wrapping_sub(1)).map_or(&[], |run| run.1)
    }
}

impl MeshFile {
    /// At the beginning of a section; `is_binary`: if its numbers are bytes in a file of bytes.
    pub fn cursor(&self, section: &MeshSection, is_binary: bool) -> Cursor {
        let mut cursor = Cursor::within(&self.source, section.start, section.end, section.line);
        cursor.binary = self.binary.filter(|_| is_binary);
        cursor
    }

    /// Physical groups of the volumes of version 4.
    fn groups_of_4(&self) -> Option<&HashMap<i64, i64>> {
        (self.version >= 4.0).then_some(&self.group_of_volume)
    }

    pub fn format(&self) -> String {
        let encoding = match self.binary {
            None => "ASCII",
            Some(ByteOrder::Little) => "binary, little-endian",
            Some(ByteOrder::Big) => "binary, big-endian",
        };
        format!("Gmsh {}, {encoding}", self.version)
    }

    /// Number of nodes.
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
            self.groups_of_4(),
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
            false => nodes.read_4(&mut cursor)?,
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

    /// Calls `visit` with each selected volume element and its place among the groups.
    fn each_volume(&self, mut visit: impl FnMut(&MeshElement, usize) -> Result<()>) -> Result<()> {
        let mut block = 0;
        each(&mut self.cursor(&self.elements, true), self.groups_of_4(), |element| {
            if self.groups.get(block) != Some(&element.group) {
                block = self.group_places.get(&element.group).copied().unwrap_or(0);
            }
            match element.volume.is_some() && self.is_selected.get(block) == Some(&true) {
                true => visit(element, block),
                false => Ok(()),
            }
        })
    }

    /// Selected volume elements with numbers of nodes; their tags are kept.
    pub fn read_volumes(&self) -> Result<Volumes> {
        let nodes = self.tags(0)?;
        let mut volumes = Volumes {
            cells: GatheredCells::default(),
            tags: Vec::new(),
            blocks: Vec::new(),
            orders: NodeOrders::default(),
        };
        let mut corners = Vec::new();
        self.each_volume(|element, block| {
            let Some(volume) = element.volume else { return Ok(()) };
            corners.clear();
            for &place in volume.order {
                let node = element.nodes[usize::from(place)];
                let number = nodes.find(node).ok_or_else(|| missing_node(element.tag, node))?;
                corners.push(number as u32);
            }
            volumes.cells.add(volume.code, corners.iter().copied());
            volumes.tags.push(element.tag);
            volumes.blocks.push(block as f64);
            volumes.orders.add(volumes.tags.len() - 1, volume.order);
            Ok(())
        })?;
        self.tags.keep(1, Tags::new(std::mem::take(&mut volumes.tags), "element", |tag| tag)?);
        Ok(volumes)
    }

    /// Points and cells.
    pub fn read_geometry(&self) -> Result<(Vec<DVec3>, Cells)> {
        let points = self.read_nodes()?;
        let cells = self.read_volumes()?.cells;
        if !self.is_split {
            return Ok((points, cells.into_cells()));
        }
        let mut set = cells.into_set();
        let own = set.connectivity.iter().map(|&node| points[node as usize]).collect::<Vec<_>>();
        set.connectivity = (0..own.len() as u32).collect();
        Ok((own, Cells::Mixed(set)))
    }
}

/// Tags and positions of nodes.
#[derive(Default)]
struct Nodes {
    tags: Vec<u64>,
    points: Vec<DVec3>,
}

impl Nodes {
    /// Version 4.1: entities, each with the tags of its nodes, then positions with parameters.
    fn read_4(&mut self, cursor: &mut Cursor) -> Result<()> {
        let (int, size) = (NumberType::I32, NumberType::U64);
        let entity_count: u64 = cursor.number(size, "the number of entities")?;
        for _ in 0..3 {
            cursor.number::<u64>(size, "numbers of nodes")?;
        }
        for _ in 0..entity_count {
            let dimension: u64 = cursor.number(int, "the dimension of an entity")?;
            cursor.number::<i64>(int, "the tag of an entity")?;
            let is_parametric = cursor.number::<u64>(int, "0 or 1")? == 1;
            let count: u64 = cursor.number(size, "a number of nodes")?;
            self.tags.extend(cursor.numbers::<u64>(size, count, "the tag of a node")?);
            let width = 3 + if is_parametric { dimension.min(3) } else { 0 };
            each_batch(count, width, |count| {
                let rows: Vec<f64> = cursor.numbers(NumberType::F64, count * width, "a coordinate")?;
                self.points.extend(rows.chunks_exact(width as usize).map(DVec3::from_slice));
                Ok(())
            })?;
        }
        Ok(())
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
            // Floats hold whole numbers below 2^53.
            if row[0].fract() != 0.0 || !(0.0..9e15).contains(&row[0]) {
                let error = Error::run("a number is damaged").got(row[0]);
                return Err(at(error.expected("the number of a node or element")));
            }
            visit(row[0] as u64, &row[1..]).map_err(at)?;
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

/// Version, encoding and byte order.
pub(super) fn header(cursor: &mut Cursor, source: &Arc<Source>) -> Result<MeshFile> {
    let line = cursor.text_line("the version of the format")?;
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let version = words.first().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
    if !(2.0..3.0).contains(&version) && !(4.1..5.0).contains(&version) {
        let error = cursor.error("this version of Gmsh's format is not read").got(format_args!("'{line}'"));
        return Err(error.expected("2 or 4.1: Gmsh saves them by Mesh.MshFileVersion = 4.1"));
    }
    if words.get(2) != Some(&"8") {
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
        is_split: false,
        tags: MeshTags::default(),
    })
}
