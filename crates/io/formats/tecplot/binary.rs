//! Tecplot data in binary form (.plt) of the versions 107 to 112, in either byte order.
//!
//! Source: Tecplot 360 data format guide, "Binary data file format". A head with records of zones, texts and drawings, each behind a
//! mark; then the numbers of one zone after the other. Words are 32 bits long, a letter is a word, and texts end with 0. The
//! guide describes the newest version; before 108 zones say less about neighbours of cells, before 111 a file does not say
//! whether it holds a grid or a solution, and until 111 the variables of a node may stand side by side.

use super::zones::{ZoneHead, ZoneKind, axes, dataset, polyhedra, quantities};
use crate::formats::contents::{
    CellBlocks, Dataset, Encoding, Gather, Geometry, Meter, Piece, PieceArray, Stored, StoredCells,
};
use crate::formats::cursor::Cursor;
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::request::{Format, Request};
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format = Format {
    files: "binary Tecplot data (.plt)",
    matches: |head, _, _| head.starts_with(MAGIC),
    open,
    has_solution: false,
};

/// Beginning of a file, before the three digits of its version.
const MAGIC: &[u8] = b"#!TDV";
const VERSIONS: std::ops::RangeInclusive<u32> = 107..=112;

/// Marks of records.
const ZONE: f32 = 299.0;
const DRAWING: f32 = 399.0;
const TEXT: f32 = 499.0;
const LABELS: f32 = 599.0;
const USER_RECORD: f32 = 699.0;
const DATA_NOTE: f32 = 799.0;
const VARIABLE_NOTE: f32 = 899.0;
const END_OF_HEAD: f32 = 357.0;

/// Number of the first zone type whose cells are given by faces.
const POLYGONS: i64 = 6;
const POLYHEDRA: i64 = 7;

struct BinaryZone {
    head: ZoneHead,
    /// The place of each variable that the zone holds, with the distance of two values where others lie between.
    values: Vec<Option<(NumberType, u64, Option<u64>)>>,
    /// True if the variables of a node do not stand side by side.
    is_block: bool,
    zone_type: i64,
    /// Numbers of points along the axes of an ordered zone.
    points: Option<[u64; 3]>,
    /// Faces of polyhedra, their nodes, and 1 or more where some have neighbours in other zones.
    faces: [u64; 3],
    /// True if each face of a cell has a word about its neighbour.
    has_neighbours: bool,
    /// True if words of unknown number about neighbours follow.
    has_tail: bool,
    connectivity: u64,
}

struct BinaryFile {
    source: Arc<Source>,
    order: ByteOrder,
    variables: Vec<String>,
    axes: [usize; 3],
    zones: Vec<BinaryZone>,
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let file = Arc::new(BinaryCursor::open(&source)?.read()?);
    let heads: Vec<&ZoneHead> = file.zones.iter().map(|zone| &zone.head).collect();
    let order = if file.order == ByteOrder::Little { "little" } else { "big" };
    let format = format!("Tecplot, binary, {order}-endian");
    dataset(&source, format, &heads, file.axes, request, |zone, block| file.piece(zone, block))
}

struct BinaryCursor {
    cursor: Cursor,
    source: Arc<Source>,
    order: ByteOrder,
    version: u32,
    variable_count: usize,
}

impl BinaryCursor {
    fn open(source: &Arc<Source>) -> Result<BinaryCursor> {
        let head = source.read(0, 12)?;
        let version = std::str::from_utf8(&head[5..8]).ok().and_then(|digits| digits.trim().parse().ok());
        let version = version.filter(|version| VERSIONS.contains(version)).ok_or_else(|| {
            let found = String::from_utf8_lossy(&head[5..8]).into_owned();
            let error = Error::run("this version of Tecplot's binary form is not read").got(found);
            error.expected(format_args!(
                "{} to {}; Tecplot saves older files anew",
                VERSIONS.start(),
                VERSIONS.end()
            ))
        })?;
        let order = match head[8..12] {
            [1, 0, 0, 0] => ByteOrder::Little,
            [0, 0, 0, 1] => ByteOrder::Big,
            _ => {
                let error = Error::run("the byte order of the file is damaged")
                    .got(format_args!("{:?}", &head[8..12]));
                return Err(error.expected("the number 1"));
            }
        };
        let mut cursor = Cursor::new(source);
        cursor.binary = Some(order);
        cursor.skip(12)?;
        Ok(BinaryCursor { cursor, source: source.clone(), order, version, variable_count: 0 })
    }

    fn word(&mut self, what: &str) -> Result<i64> {
        self.cursor.number(NumberType::I32, what)
    }

    fn count(&mut self, what: &str) -> Result<u64> {
        let word = self.word(what)?;
        u64::try_from(word)
            .map_err(|_| self.cursor.error(format!("{what} is damaged")).got(word).expected("0 or more"))
    }

    /// True for a word that is not 0.
    fn flag(&mut self) -> Result<bool> {
        Ok(self.word("0 or 1")? != 0)
    }

    fn double(&mut self) -> Result<f64> {
        self.cursor.number(NumberType::F64, "a number")
    }

    fn mark(&mut self) -> Result<f32> {
        Ok(self.cursor.number::<f64>(NumberType::F32, "a record")? as f32)
    }

    fn skip_words(&mut self, count: u64) -> Result<()> {
        self.cursor.skip(count.saturating_mul(4))
    }

    fn text(&mut self) -> Result<String> {
        let mut bytes = Vec::new();
        loop {
            match self.word("a letter")? {
                0 => return Ok(String::from_utf8_lossy(&bytes).trim().to_owned()),
                letter => bytes.push(u8::try_from(letter).unwrap_or(b'?')),
            }
        }
    }

    fn read(mut self) -> Result<BinaryFile> {
        if self.version >= 111 && self.word("the kind of the file")? == 2 {
            let error = self.cursor.error("a file of solutions alone has no coordinates");
            return Err(error.got("FILETYPE=SOLUTION").expected("a file with the grid (FILETYPE=FULL)"));
        }
        self.text()?;
        let count = self.count("the number of variables")?;
        if count < 3 || count > self.source.len() / 4 {
            let error = self.cursor.error("the number of variables is wrong").got(count);
            return Err(error.expected("x, y, z and further ones, with names"));
        }
        let variables: Vec<String> = (0..count).map(|_| self.text()).collect::<Result<_>>()?;
        self.variable_count = variables.len();
        let mut zones = Vec::new();
        loop {
            match self.mark()? {
                END_OF_HEAD => break,
                ZONE => zones.push(self.zone(zones.len())?),
                DRAWING => self.skip_drawing()?,
                TEXT => self.skip_text()?,
                LABELS => {
                    for _ in 0..self.count("the number of labels")? {
                        self.text()?;
                    }
                }
                USER_RECORD => drop(self.text()?),
                DATA_NOTE => self.skip_note()?,
                VARIABLE_NOTE => {
                    self.word("the number of a variable")?;
                    self.skip_note()?;
                }
                mark => {
                    let error =
                        self.cursor.error("the head of the file has a record that is not known").got(mark);
                    return Err(error.expected("299 for a zone, or 357 for the end of the head"));
                }
            }
        }
        for zone in 0..zones.len() {
            let (before, own) = zones.split_at_mut(zone);
            self.zone_data(&mut own[0], before)?;
        }
        Ok(BinaryFile { axes: axes(&variables), source: self.source, order: self.order, variables, zones })
    }

    /// A name, the kind of a value (text), and the value.
    fn skip_note(&mut self) -> Result<()> {
        self.text()?;
        self.word("0")?;
        self.text().map(drop)
    }

    fn skip_text(&mut self) -> Result<()> {
        // System of coordinates, scope; place; font, unit of height; height; box, its margin and lines; two colours; angle, spacing of
        // lines; anchor, zone, colour.
        self.cursor.skip(2 * 4 + 3 * 8 + 2 * 4 + 8 + 4 + 2 * 8 + 2 * 4 + 2 * 8 + 3 * 4)?;
        self.text()?;
        self.word("clipping")?;
        self.text().map(drop)
    }

    fn skip_drawing(&mut self) -> Result<()> {
        let axis_count = if self.word("a system of coordinates")? == 4 { 3 } else { 2 };
        // Scope, order; place; zone, two colours, filling.
        self.cursor.skip(2 * 4 + 3 * 8 + 4 * 4)?;
        let kind = self.word("the kind of a drawing")?;
        // Pattern, its length and thickness; points of an ellipse, style and places of arrows; their size and angle.
        self.cursor.skip(4 + 2 * 8 + 3 * 4 + 2 * 8)?;
        self.text()?;
        let size = if self.word("the type of numbers")? == 2 { 8 } else { 4 };
        self.word("clipping")?;
        if kind != 0 {
            return self.cursor.skip(if matches!(kind, 1 | 4) { 2 * size } else { size });
        }
        for _ in 0..self.count("the number of lines")? {
            let count = self.count("the number of points")?;
            self.cursor.skip(count.saturating_mul(axis_count * size))?;
        }
        Ok(())
    }

    /// Head of a zone behind its mark and those of `zone_count` others.
    fn zone(&mut self, zone_count: usize) -> Result<BinaryZone> {
        let name = self.text()?;
        self.word("the zone above")?;
        let strand = self.word("a strand")?;
        let time = self.double()?;
        self.word("a colour")?;
        let zone_type = self.word("the type of a zone")?;
        let is_block = self.version >= 112 || !self.flag()?;
        let least = (zone_count + 1).saturating_mul(self.variable_count).saturating_mul(4) as u64;
        if least > self.source.len() {
            let error =
                self.cursor.error("the zones do not fit the file").got(counted(zone_count + 1, "zone"));
            return Err(error.expected("four bytes or more in the file for each variable of each zone"));
        }
        let mut at_cells = vec![false; self.variable_count];
        if self.flag()? {
            for is_at_cells in &mut at_cells {
                *is_at_cells = self.flag()?;
            }
        }
        let has_neighbours = self.version >= 108 && self.flag()?;
        let has_connections = self.flag()?;
        if has_connections {
            self.word("a mode of neighbours")?;
            if self.version >= 108 && zone_type != 0 {
                self.flag()?;
            }
        }
        let (mut faces, mut points) = ([0; 3], None);
        let (kind, node_count, cell_count) = if zone_type == 0 {
            let what = "a number of points";
            let along = [self.count(what)?, self.count(what)?, self.count(what)?];
            points = Some(along);
            ZoneKind::ordered(along)
        } else {
            let kind = self.kind(zone_type)?;
            let node_count = self.count("the number of nodes")?;
            if zone_type >= POLYGONS {
                for count in &mut faces {
                    *count = self.count("a number of faces")?;
                }
                self.word("connections")?;
            }
            let cell_count = self.count("the number of cells")?;
            self.skip_words(3)?;
            (kind, node_count, cell_count)
        };
        while self.flag()? {
            self.skip_note()?;
        }
        if node_count.max(cell_count) > self.source.len() {
            let error = self.cursor.error("the zone does not fit the file").got(node_count.max(cell_count));
            return Err(error.expected("numbers of nodes and cells that the file holds"));
        }
        if !is_block && at_cells.contains(&true) {
            let error = self.cursor.error("variables at cells stand side by side with those at nodes");
            return Err(error.expected("all values of a variable in one run"));
        }
        let mut head = ZoneHead::new(name, kind, [node_count, cell_count], self.variable_count);
        head.at_cells = at_cells;
        // A zone of no strand is of all times.
        head.time = (strand != -1 && time.is_finite()).then_some(time);
        Ok(BinaryZone {
            head,
            values: Vec::new(),
            is_block,
            zone_type,
            points,
            faces,
            has_neighbours,
            has_tail: has_connections || faces[2] > 0,
            connectivity: 0,
        })
    }

    fn kind(&self, zone_type: i64) -> Result<ZoneKind> {
        Ok(match zone_type {
            1 => ZoneKind::Flat(2),
            2 => ZoneKind::Flat(3),
            3 => ZoneKind::Flat(4),
            4 => ZoneKind::Tetrahedra,
            5 => ZoneKind::Bricks,
            POLYGONS if self.version >= 111 => ZoneKind::Flat(0),
            POLYHEDRA if self.version >= 111 => ZoneKind::Polyhedra,
            _ => {
                let error = self.cursor.error("zones of this type are not read").got(zone_type);
                let faces = if self.version >= 111 { "" } else { ", from version 111 on" };
                return Err(error.expected(format_args!(
                    "0 (ordered) to 5 (bricks), 6 and 7 (polygons, polyhedra){faces}"
                )));
            }
        })
    }

    /// Finds the numbers of a zone, and moves behind them; `before`: the zones that it may share some with.
    fn zone_data(&mut self, zone: &mut BinaryZone, before: &[BinaryZone]) -> Result<()> {
        let mark = self.mark()?;
        if mark != ZONE {
            let error = self.cursor.error("the numbers of a zone do not begin where they should").got(mark);
            return Err(error.expected("299"));
        }
        let mut types = Vec::new();
        for _ in 0..self.variable_count {
            types.push(self.number_type()?);
        }
        if self.flag()? {
            for variable in 0..self.variable_count {
                zone.head.passive[variable] = self.flag()?;
            }
        }
        if self.flag()? {
            for variable in 0..self.variable_count {
                let Some(other) = self.shared(before)? else { continue };
                zone.head
                    .share(variable, other, &before[other].head)
                    .map_err(|error| self.cursor.locate(error))?;
            }
        }
        zone.head.shared_cells = self.shared(before)?;
        let held: Vec<usize> =
            (0..self.variable_count).filter(|&variable| zone.head.holds(variable)).collect();
        // Least and greatest values.
        self.cursor.skip(16 * held.len() as u64)?;
        zone.values = vec![None; self.variable_count];
        if !zone.is_block && held.iter().any(|&variable| types[variable] == NumberType::Bit) {
            let error = self.cursor.error("a variable of bits stands side by side with others");
            return Err(error.expected("all values of a variable in one run"));
        }
        let size = |variable: usize| types[variable].size().unwrap_or(1) as u64;
        let stride: u64 = held.iter().map(|&variable| size(variable)).sum();
        let mut place = self.cursor.position();
        for &variable in &held {
            let distance = Some(stride).filter(|_| !zone.is_block);
            zone.values[variable] = Some((types[variable], place, distance));
            let run = types[variable].byte_count(zone.stored_count(variable)).unwrap_or(u64::MAX);
            place = place.saturating_add(if zone.is_block { run } else { size(variable) });
        }
        let own_bytes = match zone.is_block {
            true => place.saturating_sub(self.cursor.position()),
            false => stride.saturating_mul(zone.head.node_count),
        };
        self.cursor.skip(own_bytes)?;
        self.skip_cells(zone)
    }

    fn skip_cells(&mut self, zone: &mut BinaryZone) -> Result<()> {
        zone.connectivity = self.cursor.position();
        if zone.head.shared_cells.is_some() {
            return Ok(());
        }
        let [face_count, node_count, _] = zone.faces;
        if zone.zone_type >= POLYGONS {
            let offsets = if zone.zone_type == POLYHEDRA { face_count + 1 } else { 0 };
            self.skip_words(offsets + node_count + 2 * face_count)?;
        } else {
            let sides = [0, 2, 3, 4, 4, 6][zone.zone_type as usize];
            let neighbours = if zone.has_neighbours { sides } else { 0 };
            self.skip_words(zone.head.cell_count.saturating_mul(zone.head.kind.corners() + neighbours))?;
        }
        // The number of these words is known from themselves alone; none of them is as great as the mark of the next zone.
        let mark = match self.order {
            ByteOrder::Little => ZONE.to_le_bytes(),
            ByteOrder::Big => ZONE.to_be_bytes(),
        };
        while zone.has_tail && self.cursor.left() >= 4 && !self.cursor.starts_with(&mark)? {
            self.skip_words(1)?;
        }
        Ok(())
    }

    fn number_type(&mut self) -> Result<NumberType> {
        Ok(match self.word("the type of a variable")? {
            1 => NumberType::F32,
            2 => NumberType::F64,
            3 => NumberType::I32,
            4 => NumberType::I16,
            5 => NumberType::U8,
            6 => NumberType::Bit,
            found => {
                let error = self.cursor.error("variables of this type are not read").got(found);
                return Err(error.expected("1 (float) to 6 (bit)"));
            }
        })
    }

    /// The number of a zone with which something is shared; `None` for -1.
    fn shared(&mut self, before: &[BinaryZone]) -> Result<Option<usize>> {
        let word = self.word("the number of a zone")?;
        let number = usize::try_from(word).ok();
        match number.filter(|&number| number < before.len()) {
            None if word != -1 => {
                let error = self.cursor.error("a zone shares what no zone before it has").got(word);
                Err(error.expected(format_args!("-1, or a number below {}", before.len())))
            }
            number => Ok(number),
        }
    }
}

impl BinaryZone {
    /// Values of a variable in the file: at cells of ordered points there are as many as points along all axes but the last of
    /// several points.
    fn stored_count(&self, variable: usize) -> u64 {
        match self.points.and_then(|points| points.into_iter().rfind(|&n| n > 1)) {
            Some(n) if self.head.at_cells[variable] => self.head.node_count / n * (n - 1),
            None if self.head.at_cells[variable] && self.points.is_some() => 1,
            _ => self.head.len(variable),
        }
    }
}

impl BinaryFile {
    fn piece(self: &Arc<Self>, zone: usize, block: usize) -> Piece {
        let own = &self.zones[zone].head;
        let points = Stored::joined("coordinates", self.axes.map(|axis| self.stored(zone, axis)));
        let geometry = match own.kind {
            ZoneKind::Ordered(dimensions) => Geometry::Curvilinear { dimensions, points },
            _ => {
                let of = self.clone();
                let cells = StoredCells::Converted(Arc::new(move |meter| of.cells(zone, meter)));
                Geometry::Unstructured { points, cells: Box::new(cells) }
            }
        };
        let array = |(variable, association)| PieceArray::new(association, self.stored(zone, variable));
        let arrays = quantities(own, self.axes).map(array).collect();
        Piece::new([own.node_count, own.cell_count], geometry, arrays).with_blocks(CellBlocks::One(block))
    }

    fn stored(&self, zone: usize, variable: usize) -> Stored {
        let (own, name) = (&self.zones[zone].head, &self.variables[variable]);
        let mut holder = &self.zones[zone];
        while let Some(other) = holder.head.shared[variable] {
            holder = &self.zones[other];
        }
        let (mut number_type, place, distance) =
            holder.values[variable].unwrap_or((NumberType::F32, 0, None));
        let size = number_type.size().unwrap_or(1);
        let source = self.source.clone();
        let encoding = match (distance, holder.head.kind) {
            _ if number_type == NumberType::Bit => {
                number_type = NumberType::U8;
                let points = holder.points.filter(|_| own.at_cells[variable]);
                Encoding::Gathered(bits(source, place, holder.stored_count(variable), points))
            }
            (Some(distance), _) => {
                Encoding::Gathered(scattered(source, place, size, distance, own.node_count))
            }
            (None, ZoneKind::Ordered(points)) if own.at_cells[variable] => {
                Encoding::Gathered(Arc::new(move || {
                    let [i, j, k] = points;
                    let count = i.saturating_mul(j).saturating_mul(k - 1);
                    let bytes = source.read(place, count.saturating_mul(size as u64))?;
                    Ok(without_last(&bytes, size, points))
                }))
            }
            _ => Encoding::Bytes(place),
        };
        let stored = Stored::of_f64(&self.source, name, 1, own.len(variable), encoding);
        Stored { number_type, order: self.order, ..stored }
    }

    fn words(&self, name: &str, place: u64, component_count: u64, tuple_count: u64) -> Stored {
        let encoding = Encoding::Bytes(place);
        let stored = Stored::of_f64(&self.source, name, component_count as usize, tuple_count, encoding);
        Stored { number_type: NumberType::I32, order: self.order, ..stored }
    }

    fn cells(&self, zone: usize, meter: &Meter) -> Result<Cells> {
        let own = &self.zones[zone].head;
        let mut holder = &self.zones[zone];
        while let Some(other) = holder.head.shared_cells {
            holder = &self.zones[other];
        }
        if (holder.head.cell_count, holder.head.kind) != (own.cell_count, own.kind) {
            return Err(Error::run("a zone shares the cells of one with others").at_item(&own.name));
        }
        let corners = own.kind.corners();
        let connectivity = || self.words("connectivity", holder.connectivity, corners, own.cell_count);
        match own.kind {
            ZoneKind::Tetrahedra => {
                Ok(Cells::Tetrahedra(connectivity().load_tuples::<u32, [u32; 4]>(meter)?.into()))
            }
            ZoneKind::Polyhedra => self.polyhedra(holder, meter),
            _ => {
                let connectivity = connectivity().load(meter)?;
                Ok(Cells::Mixed(CellSet::of_type(code::HEXAHEDRON, corners as usize, connectivity)))
            }
        }
    }

    /// Polyhedra of a zone: the first node of each face, the nodes of all, the cell on the left of each, and on the right.
    fn polyhedra(&self, zone: &BinaryZone, meter: &Meter) -> Result<Cells> {
        let [face_count, node_count, _] = zone.faces;
        let place = |words: u64| zone.connectivity + 4 * words;
        let firsts: Vec<u64> = self.words("faces", place(0), 1, face_count + 1).load(meter)?;
        let nodes: Vec<u32> =
            self.words("nodes of faces", place(face_count + 1), 1, node_count).load(meter)?;
        let sides = self.words("cells of faces", place(face_count + 1 + node_count), 1, 2 * face_count);
        polyhedra(&zone.head, &firsts, &nodes, &sides.load::<i64>(meter)?)
    }
}

/// Bytes that are read at a time where values lie apart.
const WINDOW: u64 = 4 << 20;

/// Values of `size` bytes each, `distance` bytes from one to the next.
fn scattered(source: Arc<Source>, place: u64, size: usize, distance: u64, count: u64) -> Gather {
    Arc::new(move || {
        let length = count.saturating_sub(1).saturating_mul(distance).saturating_add(size as u64);
        source.check(place, length)?;
        let mut values = Vec::with_capacity(count as usize * size);
        let window = (WINDOW / distance).max(1) * distance;
        for start in (0..length).step_by(window as usize) {
            let bytes = source.read(place + start, window.min(length - start))?;
            values.extend(bytes.chunks(distance as usize).flat_map(|tuple| &tuple[..size]));
        }
        Ok(values)
    })
}

/// Values at cells of ordered points, of `size` bytes each, without those that stand for the last point of a row, and the last row of a
/// plane.
fn without_last(bytes: &[u8], size: usize, [i, j, _]: [u64; 3]) -> Vec<u8> {
    let (row, plane) = (i as usize * size, (i * j) as usize * size);
    let rows = bytes.chunks(plane).flat_map(|plane| plane.chunks(row).take(j as usize - 1));
    rows.flat_map(|values| &values[..row - size]).copied().collect()
}

/// Bits as bytes, the first in the lowest place of its byte; `points`: of cells of ordered points, their numbers along the axes.
fn bits(source: Arc<Source>, place: u64, count: u64, points: Option<[u64; 3]>) -> Gather {
    Arc::new(move || {
        let bytes = source.read(place, count.div_ceil(8))?;
        let values: Vec<u8> = (0..count as usize).map(|value| bytes[value / 8] >> (value % 8) & 1).collect();
        Ok(match points {
            Some(points) => without_last(&values, 1, points),
            None => values,
        })
    })
}
