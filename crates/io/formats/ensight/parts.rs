//! Geometry and variables of EnSight Gold: parts with nodes and elements of several types, in text and in C binary of either order.

use super::case::StepFile;
use crate::formats::contents::structured_counts;
use crate::formats::cursor::{Cursor, Place};
use crate::formats::lazy::{into_cells, tetrahedra};
use crate::formats::numbers::{ByteOrder, NumberType, Target};
use crate::formats::source::Source;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::grid::{Association, CellSet, Cells, code};
use voltet_core::{Error, Result};

/// Element types: name, number of nodes, type code of VTK or 0 where it is no volume. The order of nodes is VTK's.
const TYPES: [(&str, usize, u8); 15] = [
    ("tetra4", 4, code::TETRA),
    ("tetra10", 10, code::QUADRATIC_TETRA),
    ("pyramid5", 5, code::PYRAMID),
    ("pyramid13", 13, code::QUADRATIC_PYRAMID),
    ("penta6", 6, code::WEDGE),
    ("penta15", 15, code::QUADRATIC_WEDGE),
    ("hexa8", 8, code::HEXAHEDRON),
    ("hexa20", 20, code::QUADRATIC_HEXAHEDRON),
    ("point", 1, 0),
    ("bar2", 2, 0),
    ("bar3", 3, 0),
    ("tria3", 3, 0),
    ("tria6", 6, 0),
    ("quad4", 4, 0),
    ("quad8", 8, 0),
];

/// Elements whose nodes are in memory at a time beside the cells.
const BATCH: u64 = 1 << 18;

/// Elements of one type within a part.
pub(super) struct GoldElements {
    name: String,
    pub count: u64,
    /// Number of nodes, 0 for polyhedra and polygons, and type code of VTK, 0 for what is no volume.
    kind: (usize, u8),
    place: Place,
}

pub(super) struct GoldPart {
    pub number: u64,
    pub name: String,
    pub node_count: u64,
    coordinates: Place,
    pub elements: Vec<GoldElements>,
    /// Points of a structured part.
    pub block: Option<GoldBlock>,
}

/// Points of a structured part: their numbers along the axes, and where they are.
#[derive(Clone, Copy)]
pub(super) struct GoldBlock {
    pub dimensions: [u64; 3],
    pub form: BlockForm,
}

/// Positions of the points of a structured part.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BlockForm {
    /// A position for each point.
    Curvilinear,
    /// Coordinates along each axis.
    Rectilinear,
    /// An origin, and distances along the axes.
    Uniform,
}

impl GoldPart {
    /// Number of volume elements.
    pub fn cell_count(&self) -> u64 {
        match self.block {
            Some(GoldBlock { dimensions, .. }) => {
                dimensions.iter().fold(1, |count: u64, n| count.saturating_mul(n.saturating_sub(1)))
            }
            None => self.volumes().map(|elements| elements.count).sum(),
        }
    }

    /// True if it has elements or points of a block, and none with a volume.
    pub fn is_flat(&self) -> bool {
        let has_elements = self.elements.iter().any(|elements| elements.count > 0);
        self.cell_count() == 0 && (has_elements || self.block.is_some())
    }

    /// Number of their nodes; those of polyhedra are taken for hexahedra.
    pub fn corner_count(&self) -> u64 {
        self.volumes().map(|own| own.count.saturating_mul(own.kind.0.max(8) as u64)).sum()
    }

    fn volumes(&self) -> impl Iterator<Item = &GoldElements> {
        self.elements.iter().filter(|elements| elements.kind.1 > 0)
    }
}

struct GoldFile {
    cursor: Cursor,
    source: Arc<Source>,
}

/// Marks of a step in a file of several, and of the table of their places at its end.
const STEP: &str = "BEGIN TIME STEP";
const END_OF_STEP: &str = "END TIME STEP";
const INDEX: &str = "FILE_INDEX";
/// Bytes of a line in a binary file.
const LINE: u64 = 80;

impl GoldFile {
    fn open(file: &StepFile) -> Result<GoldFile> {
        let source = Source::open(&file.path)?;
        Ok(GoldFile { cursor: Cursor::new(&source), source })
    }

    /// Moves behind the mark of the file's step.
    fn go_to_step(&mut self, file: &StepFile) -> Result<()> {
        let Some(step) = file.step else { return Ok(()) };
        if let Some(&start) = file.start.get() {
            self.go_to(start);
            return Ok(());
        }
        self.find_step(step)?;
        // Another thread may have found it as well.
        let _ = file.start.set(self.cursor.place());
        Ok(())
    }

    /// Moves behind the mark of a step by the table of the file, or from one mark to the next.
    fn find_step(&mut self, step: u64) -> Result<()> {
        let is_binary = self.cursor.binary.is_some();
        if let Some(place) = self.indexed(step).filter(|_| is_binary) {
            return self.cursor.skip((place + LINE).saturating_sub(self.cursor.position()));
        }
        for before in 0..=step {
            if self.cursor.skip_past(STEP.as_bytes())?.is_none() {
                let error = self.cursor.error("the file has too few steps").got(before);
                return Err(error.expected(format_args!("{} or more, as the case says", step + 1)));
            }
        }
        match is_binary {
            true => self.cursor.skip(LINE - STEP.len() as u64),
            false => self.cursor.line().map(drop),
        }
    }

    /// Place of a step by the table at the end of the file, in either byte order: the number of steps, the place of each, a flag, the
    /// place of the table, and its name. `None` where it does not lead to the step, or places take four bytes, as of old writers.
    fn indexed(&self, step: u64) -> Option<u64> {
        let len = self.source.len();
        let at = |place: u64, count: u64| self.source.read(place, count).ok();
        let wide = |place: u64| at(place, 8).and_then(|bytes| bytes.first_chunk().copied());
        let name = len.checked_sub(LINE)?;
        let table = wide(name.checked_sub(8)?)
            .filter(|_| at(name, LINE).is_some_and(|line| line.starts_with(INDEX.as_bytes())))?;
        let is_step = |place: &u64| at(*place, LINE).is_some_and(|line| line.starts_with(STEP.as_bytes()));
        [u64::from_le_bytes as fn([u8; 8]) -> u64, u64::from_be_bytes].into_iter().find_map(|number| {
            let table = number(table);
            let places = name.checked_sub(table)?.checked_sub(16)?;
            let count = at(table, 4)?.first_chunk().copied()?;
            let counts = [u32::from_le_bytes(count), u32::from_be_bytes(count)];
            counts.iter().find(|&&count| u64::from(count) * 8 == places)?;
            let entry = (table + 4).checked_add(step.checked_mul(8)?)?;
            wide(entry).map(number).filter(is_step)
        })
    }

    /// A line of text, or 80 bytes; `None` at the end.
    fn line(&mut self) -> Result<Option<String>> {
        let line = match self.cursor.binary {
            None => loop {
                match self.cursor.line()? {
                    Some(line) if line.trim_ascii().is_empty() => continue,
                    line => break line,
                }
            },
            Some(_) if self.cursor.left() == 0 => None,
            Some(_) => Some(self.cursor.bytes(LINE as usize)?),
        };
        let text = |line: &[u8]| {
            let end = line.iter().position(|&byte| byte == 0).unwrap_or(line.len());
            String::from_utf8_lossy(&line[..end]).trim().to_owned()
        };
        Ok(line.map(text))
    }

    fn required(&mut self, what: &str) -> Result<String> {
        self.line()?.ok_or_else(|| self.cursor.error("the file ends early").expected(what))
    }

    /// A line of description or the name of a part, which may be blank.
    fn description(&mut self, what: &str) -> Result<String> {
        match self.cursor.binary {
            None => self.cursor.text_line(what),
            Some(_) => self.required(what),
        }
    }

    fn count(&mut self, what: &str) -> Result<u64> {
        let count = self.cursor.number(NumberType::I32, what)?;
        self.end_line()?;
        Ok(count)
    }

    /// Moves to the next line of text after numbers.
    fn end_line(&mut self) -> Result<()> {
        if self.cursor.binary.is_none() {
            self.cursor.line()?;
        }
        Ok(())
    }

    fn go_to(&mut self, place: Place) {
        let binary = self.cursor.binary;
        self.cursor = Cursor::at(&self.source, place);
        self.cursor.binary = binary;
    }

    /// Passes over numbers, which take a place of four bytes or a word each.
    fn skip(&mut self, count: u64) -> Result<()> {
        self.cursor.skip_numbers(count, 4)?;
        if count > 0 { self.end_line() } else { Ok(()) }
    }

    fn numbers<T: Target>(&mut self, number_type: NumberType, count: u64) -> Result<Vec<T>> {
        let numbers = self.cursor.numbers(number_type, count, "a number")?;
        if count > 0 {
            self.end_line()?;
        }
        Ok(numbers)
    }

    /// Sets the byte order by the number of a part, which is small.
    fn find_order(&mut self) -> Result<()> {
        let bytes = self.cursor.clone().bytes(4)?.first_chunk().copied().unwrap_or_default();
        let is_little = u32::from_le_bytes(bytes) <= u32::from_be_bytes(bytes);
        self.cursor.binary = Some(if is_little { ByteOrder::Little } else { ByteOrder::Big });
        Ok(())
    }
}

pub(super) struct GoldGeometry {
    source: Arc<Source>,
    binary: Option<ByteOrder>,
    pub parts: Vec<GoldPart>,
}

impl GoldGeometry {
    pub fn open(file: &StepFile) -> Result<GoldGeometry> {
        GoldGeometry::of_file(file).map_err(|error| error.in_file(&file.path))
    }

    fn of_file(of: &StepFile) -> Result<GoldGeometry> {
        let mut file = GoldFile::open(of)?;
        let head = file.source.head(LINE)?;
        if head.starts_with(b"Fortran Binary") {
            return Err(Error::run("records of Fortran are not read").expected("C binary or text"));
        }
        if head.starts_with(b"C Binary") {
            file.cursor.binary = Some(ByteOrder::Little);
            file.line()?;
        }
        file.go_to_step(of)?;
        file.description("a description")?;
        file.description("a description")?;
        let has_ids = |line: &str| ["given", "ignore"].iter().any(|word| line.ends_with(word));
        let node_ids = has_ids(&file.required("node id")?);
        let element_ids = has_ids(&file.required("element id")?);
        let mut parts: Vec<GoldPart> = Vec::new();
        let mut line = file.line()?;
        while let Some(word) = line {
            match word.as_str() {
                END_OF_STEP if of.step.is_some() => break,
                "extents" => file.skip(6)?,
                "part" => {
                    if parts.is_empty() && file.cursor.binary.is_some() {
                        file.find_order()?;
                    }
                    let number = file.count("the number of a part")?;
                    let name = file.description("the name of a part")?;
                    parts.push(part_head(&mut file, number, name, node_ids)?);
                }
                kind => {
                    let Some(part) = parts.last_mut() else {
                        let error = file.cursor.error("this is no geometry of EnSight Gold");
                        return Err(error.got(format_args!("'{kind}'")).expected("part"));
                    };
                    if part.elements.iter().any(|own| own.name == kind) {
                        let error = file.cursor.error("a part has elements of a type twice").got(kind);
                        return Err(error.expected("elements of each type in one run"));
                    }
                    part.elements.push(elements(&mut file, kind, element_ids)?);
                }
            }
            line = file.line()?;
        }
        Ok(GoldGeometry { binary: file.cursor.binary, source: file.source.clone(), parts })
    }

    fn at(&self, place: Place) -> GoldFile {
        let mut file = GoldFile { cursor: Cursor::new(&self.source), source: self.source.clone() };
        file.cursor.binary = self.binary;
        file.go_to(place);
        file
    }

    /// Points and volume elements of a part.
    pub fn read(&self, part: usize) -> Result<(Vec<DVec3>, Cells)> {
        self.read_part(&self.parts[part]).map_err(|error| error.in_file(self.source.path()))
    }

    fn read_part(&self, part: &GoldPart) -> Result<(Vec<DVec3>, Cells)> {
        let mut file = self.at(part.coordinates);
        let n = part.node_count;
        let coordinates = file.cursor.tuples(NumberType::F32, n, 3, "a coordinate")?;
        let copied = |(_, numbers): (_, Vec<f64>)| bytemuck::cast_slice(&numbers).to_vec();
        let points = bytemuck::try_cast_vec(coordinates).unwrap_or_else(copied);
        if let Some(block) = part.block {
            return Ok((points, Cells::Structured(block.dimensions.map(|n| n as usize))));
        }
        let mut volumes = part.volumes();
        if let (Some(GoldElements { kind: (4, code::TETRA), count, place, .. }), None) =
            (volumes.next(), volumes.next())
        {
            let corners = count.saturating_mul(4);
            return Ok((points, tetrahedra(self.at(*place).cursor.node_numbers(corners, n, "an element")?)));
        }
        let mut cells = CellSet::default();
        for own in part.volumes() {
            let mut file = self.at(own.place);
            if own.kind.0 == 0 {
                polyhedra(&mut file, own.count, n, &mut cells)?;
                continue;
            }
            let mut left = own.count;
            while left > 0 {
                let count = left.min(BATCH);
                let corners =
                    file.cursor.node_numbers(count.saturating_mul(own.kind.0 as u64), n, "an element")?;
                cells.push_all(own.kind.1, own.kind.0, &corners);
                left -= count;
            }
        }
        Ok((points, into_cells(cells)))
    }

    /// Coordinates along each axis of a rectilinear block; of a uniform one the first, and the distance to the next.
    pub fn axes(&self, part: usize) -> Result<[Vec<f64>; 3]> {
        let part = &self.parts[part];
        let mut file = self.at(part.coordinates);
        let mut numbers = |count| {
            let numbers = file.numbers::<f64>(NumberType::F32, count);
            numbers.map_err(|error| error.in_file(self.source.path()))
        };
        match part.block {
            Some(GoldBlock { form: BlockForm::Rectilinear, dimensions: [x, y, z] }) => {
                Ok([numbers(x)?, numbers(y)?, numbers(z)?])
            }
            _ => {
                let pairs = numbers(6)?;
                Ok([0, 1, 2].map(|axis| vec![pairs[axis], pairs[axis + 3]]))
            }
        }
    }

    /// Values of a variable at the points or volume elements of a part; not a number where it has none.
    pub fn values(
        &self,
        file: &StepFile,
        part: usize,
        association: Association,
        component_count: usize,
    ) -> Result<Vec<f64>> {
        self.values_of(file, part, association, component_count).map_err(|error| error.in_file(&file.path))
    }

    fn values_of(
        &self,
        of: &StepFile,
        part: usize,
        association: Association,
        component_count: usize,
    ) -> Result<Vec<f64>> {
        let (own, n) = (&self.parts[part], component_count as u64);
        let mut file = GoldFile::open(of)?;
        file.cursor.binary = self.binary;
        file.go_to_step(of)?;
        file.description("a description")?;
        let count = if association == Association::Point { own.node_count } else { own.cell_count() };
        let mut found: HashMap<String, Vec<f64>> = HashMap::new();
        let mut current = None;
        while let Some(line) = file.line()? {
            if line == END_OF_STEP && of.step.is_some() {
                break;
            }
            if line == "part" {
                let number = file.count("the number of a part")?;
                current = self.parts.iter().find(|part| part.number == number);
                if current.is_none() {
                    let error = file.cursor.error("a variable has values of a part that does not exist");
                    return Err(error.got(number).expected("the number of a part of the geometry"));
                }
                continue;
            }
            let mut words = line.split_ascii_whitespace();
            let (kind, mode) = (words.next().unwrap_or_default(), words.next());
            let of_kind = |part: &&GoldPart| match (kind, association) {
                ("coordinates" | "block", Association::Point) => Some(part.node_count),
                ("block", Association::Cell) => part.block.map(|_| part.cell_count()),
                (kind, Association::Cell) => {
                    part.elements.iter().find(|own| own.name == kind).map(|own| own.count)
                }
                _ => None,
            };
            let Some((part, len)) = current.zip(current.as_ref().and_then(of_kind)) else {
                let error = file.cursor.error("a variable is damaged").got(format_args!("'{line}'"));
                return Err(error.expected(match association {
                    Association::Point => "part, coordinates or block",
                    Association::Cell => "part, block, or a type of the part's elements",
                }));
            };
            let undefined = match mode {
                None => None,
                Some("undef") => Some(file.numbers::<f64>(NumberType::F32, 1)?[0]),
                Some(_) => {
                    let error = file.cursor.error("values of some elements alone are not read");
                    return Err(error.got(format_args!("'{line}'")).expected("values of all"));
                }
            };
            if part.number != own.number {
                file.skip(len.saturating_mul(n))?;
                continue;
            }
            let mut values = file.cursor.tuples(NumberType::F32, len, component_count, "a number")?;
            if len > 0 {
                file.end_line()?;
            }
            if undefined.is_some() {
                values
                    .iter_mut()
                    .filter(|value| Some(**value) == undefined)
                    .for_each(|value| *value = f64::NAN);
            }
            found.insert(kind.to_owned(), values);
        }
        let mut all = Vec::new();
        let whole = ["coordinates", "block"].into_iter().find_map(|kind| found.remove(kind));
        match whole {
            Some(values) => all = values,
            None if association == Association::Cell => {
                for elements in own.volumes() {
                    match found.get(&elements.name) {
                        Some(values) => all.extend_from_slice(values),
                        None => all.resize(all.len() + elements.count as usize * component_count, f64::NAN),
                    }
                }
            }
            None => {}
        }
        // The geometry was read before: there are so many points and elements.
        all.resize(count as usize * component_count, f64::NAN);
        Ok(all)
    }
}

fn part_head(file: &mut GoldFile, number: u64, name: String, has_ids: bool) -> Result<GoldPart> {
    let line = file.required("coordinates or block")?;
    let mut words = line.split_ascii_whitespace();
    let (kind, options): (_, Vec<&str>) = (words.next().unwrap_or_default(), words.collect());
    let form = match options[..] {
        [] | ["curvilinear"] => Some(BlockForm::Curvilinear),
        ["rectilinear"] => Some(BlockForm::Rectilinear),
        ["uniform"] => Some(BlockForm::Uniform),
        _ => None,
    };
    let (node_count, number_count, block) = match (kind, form) {
        ("coordinates", _) => {
            let count = file.count("the number of nodes")?;
            if has_ids {
                file.skip(count)?;
            }
            (count, count.saturating_mul(3), None)
        }
        ("block", Some(form)) => {
            let numbers: Vec<u64> = file.numbers(NumberType::I32, 3)?;
            let dimensions = [numbers[0], numbers[1], numbers[2]];
            let count = structured_counts(dimensions)?.0;
            let number_count = match form {
                BlockForm::Curvilinear => count.saturating_mul(3),
                BlockForm::Rectilinear => dimensions.into_iter().fold(0, u64::saturating_add),
                BlockForm::Uniform => 6,
            };
            (count, number_count, Some(GoldBlock { dimensions, form }))
        }
        _ => {
            let error = file.cursor.error("this kind of part is not read").got(format_args!("'{line}'"));
            return Err(
                error.expected("coordinates, or a curvilinear, rectilinear or uniform block without blanking, ghosts and ranges")
            );
        }
    };
    let coordinates = file.cursor.place();
    file.skip(number_count)?;
    Ok(GoldPart { number, name, node_count, coordinates, elements: Vec::new(), block })
}

/// Elements of a type behind its name.
fn elements(file: &mut GoldFile, name: &str, has_ids: bool) -> Result<GoldElements> {
    let kind = match (name, TYPES.iter().find(|known| known.0 == name)) {
        (_, Some(&(_, nodes, code))) => (nodes, code),
        ("nfaced", _) => (0, code::POLYHEDRON),
        ("nsided", _) => (0, 0),
        _ => {
            let error = file.cursor.error("elements of this type are not read").got(format_args!("'{name}'"));
            return Err(error.expected("tetra4 to hexa20, nfaced, nsided, quad8 to point"));
        }
    };
    let count = file.count("the number of elements")?;
    if has_ids {
        file.skip(count)?;
    }
    let place = file.cursor.place();
    if kind.0 > 0 {
        file.skip(count.saturating_mul(kind.0 as u64))?;
    } else {
        // Numbers of faces of each, then of nodes of each face; of polygons the numbers of nodes.
        let mut counts: Vec<u32> = file.numbers(NumberType::I32, count)?;
        if kind.1 > 0 {
            counts = file.numbers(NumberType::I32, counts.iter().map(|&count| u64::from(count)).sum())?;
        }
        file.skip(counts.iter().map(|&count| u64::from(count)).sum())?;
    }
    Ok(GoldElements { name: name.to_owned(), count, kind, place })
}

fn polyhedra(file: &mut GoldFile, count: u64, node_count: u64, cells: &mut CellSet) -> Result<()> {
    let face_counts: Vec<u32> = file.numbers(NumberType::I32, count)?;
    let face_count = face_counts.iter().map(|&count| u64::from(count)).sum();
    let sizes: Vec<u32> = file.numbers(NumberType::I32, face_count)?;
    let mut sizes = sizes.into_iter();
    for face_count in face_counts {
        let mut faces = Vec::new();
        for size in sizes.by_ref().take(face_count as usize) {
            faces.push(file.cursor.node_numbers(size.into(), node_count, "an element")?);
        }
        cells.push_polyhedron(faces);
    }
    Ok(())
}
