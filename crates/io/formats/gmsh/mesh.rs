//! The mesh of a file: version and encoding, nodes, and the elements that are volumes.

use super::elements::{MeshElement, count, each};
use crate::formats::cursor::Cursor;
use crate::formats::lazy::{GatheredCells, MeshTags, Tags, missing_node};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Cells;

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
    /// For each cell the order of its nodes.
    pub orders: Vec<&'static [u8]>,
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
        let (int, size) = (NumberType::I32, NumberType::U64);
        let mut cursor = self.cursor(&self.nodes, self.version >= 4.0);
        let (mut points, mut tags) = (Vec::new(), Vec::new());
        let mut point = |cursor: &mut Cursor| -> Result<()> {
            let mut position = DVec3::ZERO;
            for axis in 0..3 {
                position[axis] = cursor.number(NumberType::F64, "a coordinate")?;
            }
            points.push(position);
            Ok(())
        };
        if self.version < 4.0 {
            let count: u64 = cursor.number(size, "the number of nodes")?;
            if self.binary.is_some() {
                cursor.line()?;
                cursor.binary = self.binary;
            }
            for _ in 0..count {
                tags.push(cursor.number(int, "the number of a node")?);
                point(&mut cursor)?;
            }
        } else {
            let entity_count: u64 = cursor.number(size, "the number of entities")?;
            for _ in 0..3 {
                cursor.number::<u64>(size, "numbers of nodes")?;
            }
            for _ in 0..entity_count {
                let dimension: u64 = cursor.number(int, "the dimension of an entity")?;
                cursor.number::<i64>(int, "the tag of an entity")?;
                let is_parametric = cursor.number::<u64>(int, "0 or 1")? == 1;
                let count: u64 = cursor.number(size, "a number of nodes")?;
                for _ in 0..count {
                    tags.push(cursor.number(size, "the tag of a node")?);
                }
                for _ in 0..count {
                    point(&mut cursor)?;
                    for _ in 0..if is_parametric { dimension.min(3) } else { 0 } {
                        cursor.number::<f64>(NumberType::F64, "a parameter")?;
                    }
                }
            }
        }
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
            orders: Vec::new(),
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
            volumes.orders.push(volume.order);
            Ok(())
        })?;
        self.tags.keep(1, Tags::new(std::mem::take(&mut volumes.tags), "element", |tag| tag)?);
        Ok(volumes)
    }

    /// Points and cells.
    pub fn read_geometry(&self) -> Result<(Vec<DVec3>, Cells)> {
        let points = self.read_nodes()?;
        let mut set = self.read_volumes()?.cells.into_set();
        if !self.is_split {
            return Ok((points, Cells::Mixed(set)));
        }
        let own = set.connectivity.iter().map(|&node| points[node as usize]).collect::<Vec<_>>();
        set.connectivity = (0..own.len() as u32).collect();
        Ok((own, Cells::Mixed(set)))
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
