//! Input of Abaqus (.inp) as a mesh: nodes and solid elements of parts and their instances; element sets are blocks. It holds no arrays.
//! Files that it includes are read as if they stood in it.
//!
//! Source: Abaqus keywords reference guide (*NODE, *ELEMENT, *ELSET, *PART, *INSTANCE, *INCLUDE); the order of nodes in "Three-dimensional solid
//! element library", which is VTK's.

use super::contents::Dataset;
use super::cursor::Cursor;
use super::named_files::{self, IncludedFiles};
use super::numbers::{self, NumberType, Target};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{
    PART_SHIFT, TaggedElement, TaggedMesh, VisitElement, VisitNode, dataset, number_in_part,
};
use super::text::{TextPiece, TextRange};
use super::xml::beside;
use glam::{DQuat, DVec3};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::code;
use voltet_core::{Error, Result};

pub(super) const FORMAT: Format =
    Format { files: "input of Abaqus (.inp)", matches, open, has_solution: false };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let text = String::from_utf8_lossy(head).to_ascii_lowercase();
    let is_named = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("inp"));
    !text.contains("*keyword")
        && (text.lines().any(is_first_keyword) || is_named && text.trim_start().starts_with('*'))
}

/// True for a line with one of the keywords that begin most files.
fn is_first_keyword(line: &str) -> bool {
    let line = line.trim_start().to_ascii_lowercase();
    ["*heading", "*node", "*part", "*element", "*preprint"].iter().any(|word| line.starts_with(word))
}

const SOLIDS: [(usize, u8); 8] = [
    (4, code::TETRA),
    (5, code::PYRAMID),
    (6, code::WEDGE),
    (8, code::HEXAHEDRON),
    (10, code::QUADRATIC_TETRA),
    (13, code::QUADRATIC_PYRAMID),
    (15, code::QUADRATIC_WEDGE),
    (20, code::QUADRATIC_HEXAHEDRON),
];

/// Beginnings of the names of solid elements: stress, heat, acoustics, convection.
const FAMILIES: [&str; 4] = ["C3D", "DC3D", "AC3D", "DCC3D"];

/// Elements in ranges of all sets for each byte of the file, of which an element takes about forty: a hundred sets of all elements.
const MAX_IN_RANGES: u64 = 4;

/// Keywords whose lines of data are read, which may stand in a file of their own.
const WITH_LINES: [&str; 3] = ["NODE", "ELEMENT", "ELSET"];

/// A line of an element has two numbers with a comma at least.
const MIN_ELEMENT_BYTES: u64 = 4;

/// Lines of data of a part, from here to the next keyword.
struct NodeLines {
    part: usize,
    lines: TextRange,
}

struct ElementLines {
    part: usize,
    lines: TextRange,
    /// Number of nodes and type code of VTK.
    solid: (usize, u8),
    set: String,
}

struct SetLines {
    part: usize,
    name: Arc<str>,
    /// True if a line has the first number, the last and the step.
    is_range: bool,
    lines: Cursor,
    path: PathBuf,
}

/// A copy of a part in the assembly.
struct Instance {
    part: usize,
    name: String,
    rotation: DQuat,
    /// A point on the axis of the rotation.
    pivot: DVec3,
    translation: DVec3,
}

/// Parts of the file; the lines outside parts are part 0.
#[derive(Default)]
struct AbaqusMesh {
    nodes: Vec<NodeLines>,
    elements: Vec<ElementLines>,
    instances: Vec<Instance>,
    /// First set of the elements of a part whose keyword names none.
    sets: HashMap<(usize, u64), Arc<str>>,
}

/// A line with a keyword: its name and parameters in capitals, with values as they stand.
#[derive(Clone)]
struct Keyword {
    name: String,
    parameters: BTreeMap<String, String>,
}

impl Keyword {
    /// `None`: a line of data or a comment.
    fn of_line(line: &str) -> Option<Keyword> {
        let text = line.trim_start().strip_prefix('*').filter(|text| !text.starts_with('*'))?;
        let mut words = text.split(',').map(str::trim);
        let name = words.next().unwrap_or_default().to_ascii_uppercase();
        let parameter = |word: &str| {
            let (key, value) = word.split_once('=').unwrap_or((word, ""));
            (key.trim().to_ascii_uppercase(), value.trim().trim_matches('"').to_owned())
        };
        Some(Keyword { name, parameters: words.map(parameter).collect() })
    }

    fn parameter(&self, key: &str) -> &str {
        self.parameters.get(key).map_or("", String::as_str)
    }
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mut scan = Scan::new(&source);
    scan.lines()?;
    for set in std::mem::take(&mut scan.set_lines) {
        let path = set.path.clone();
        scan.set(set).map_err(|error| error.in_file(path))?;
    }
    let Scan { parts, mut mesh, included: IncludedFiles { file_bytes, .. }, .. } = scan;
    let place = |part: usize, name: &str| Instance {
        part,
        name: name.to_owned(),
        rotation: DQuat::IDENTITY,
        pivot: DVec3::ZERO,
        translation: DVec3::ZERO,
    };
    // A file of parts alone shows each where it is.
    if mesh.instances.is_empty() {
        mesh.instances = parts.iter().enumerate().map(|(part, name)| place(part + 1, name)).collect();
    }
    mesh.instances.insert(0, place(0, ""));
    let dataset = dataset(&source, "Abaqus input".to_owned(), mesh, Vec::new(), request)?;
    Ok(Dataset { file_bytes, ..dataset })
}

/// The files that a file includes; none for other formats.
pub(super) fn files_named(path: &Path) -> Vec<PathBuf> {
    named_files::files_included(path, matches, |source| {
        let mut scan = Scan::new(source);
        (scan.lines(), scan.included)
    })
}

/// State of the pass that finds the keywords.
struct Scan {
    cursor: Cursor,
    /// Number of the part that the lines belong to.
    part: usize,
    /// Names of the parts from number 1 on.
    parts: Vec<String>,
    /// The file that includes the others, those that were included, and how many of these the lines are within.
    path: PathBuf,
    included: IncludedFiles,
    depth: usize,
    /// The last keyword, without its INPUT, where lines of data go on with it.
    open: Option<Keyword>,
    set_lines: Vec<SetLines>,
    /// Number of elements in all ranges so far.
    range_sum: u64,
    /// Numbers of runs of nodes and of elements whose end is known.
    ended: [usize; 2],
    mesh: AbaqusMesh,
}

impl Scan {
    fn new(source: &Arc<Source>) -> Scan {
        Scan {
            cursor: Cursor::new(source),
            part: 0,
            parts: Vec::new(),
            path: source.path().to_owned(),
            included: IncludedFiles::new(source),
            depth: 0,
            open: None,
            set_lines: Vec::new(),
            range_sum: 0,
            ended: [0; 2],
            mesh: AbaqusMesh::default(),
        }
    }

    /// Passes over the rest of the file.
    fn lines(&mut self) -> Result<()> {
        let mut begin = self.cursor.position();
        while let Some(line) = self.cursor.line()? {
            if line.trim_ascii_start().first() == Some(&b'*') {
                let line = String::from_utf8_lossy(line).into_owned();
                if let Some(keyword) = Keyword::of_line(&line) {
                    self.end_lines(begin);
                    self.keyword(keyword)?;
                }
            }
            begin = self.cursor.position();
        }
        self.end_lines(u64::MAX);
        Ok(())
    }

    /// Ends the lines of data that went on to here.
    fn end_lines(&mut self, end: u64) {
        let [nodes, elements] = self.ended;
        let of_nodes = self.mesh.nodes[nodes..].iter_mut().map(|own| &mut own.lines);
        let of_elements = self.mesh.elements[elements..].iter_mut().map(|own| &mut own.lines);
        for lines in of_nodes.chain(of_elements) {
            *lines = lines.until(end);
        }
        self.ended = [self.mesh.nodes.len(), self.mesh.elements.len()];
    }

    /// Goes on in a file, then back here. Both may go on with lines of data of the keyword before.
    fn include(&mut self, keyword: &str, file: &str) -> Result<()> {
        if file.is_empty() {
            let error = self.cursor.error("a keyword does not say which file it includes");
            return Err(error.got(format_args!("*{keyword}")).expected("INPUT= and a file"));
        }
        // As Abaqus and CalculiX do: names are relative to the first file's folder.
        let path = beside(&self.path, file);
        let counted = self.included.count(&path, self.depth + 1);
        counted.map_err(|error| self.cursor.locate(error.got(format_args!("'{file}'"))))?;
        let Some(source) = self.included.open(&self.path, &path)? else { return self.go_on() };
        let outer = std::mem::replace(&mut self.cursor, Cursor::new(&source));
        self.depth += 1;
        let read = self.go_on().and_then(|()| self.lines());
        self.depth -= 1;
        self.cursor = outer;
        read.map_err(|error| error.in_file(path))?;
        self.go_on()
    }

    /// Takes the lines from here on as those of the last keyword, if it has such.
    fn go_on(&mut self) -> Result<()> {
        self.open.clone().map_or(Ok(()), |open| self.contents(&open))
    }

    fn keyword(&mut self, mut keyword: Keyword) -> Result<()> {
        let file = keyword.parameters.remove("INPUT");
        if keyword.name == "INCLUDE" {
            return self.include(&keyword.name, &file.unwrap_or_default());
        }
        self.open = Some(keyword.clone()).filter(|own| WITH_LINES.contains(&own.name.as_str()));
        match file.filter(|_| self.open.is_some()) {
            Some(file) => self.include(&keyword.name, &file),
            None => self.contents(&keyword),
        }
    }

    fn contents(&mut self, keyword: &Keyword) -> Result<()> {
        match keyword.name.as_str() {
            "NGEN" | "ELGEN" | "NFILL" | "NCOPY" | "ELCOPY" | "SYSTEM" => {
                let error = self.cursor.error("a keyword that makes parts of the mesh is not read");
                Err(error.got(format_args!("*{}", keyword.name)).expected("nodes and elements one by one"))
            }
            "NODE" if !["", "R", "r"].contains(&keyword.parameter("SYSTEM")) => {
                let error = self.cursor.error("coordinates of this system are not read");
                Err(error.got(keyword.parameter("SYSTEM")).expected("rectangular ones"))
            }
            "NODE" => {
                self.mesh.nodes.push(NodeLines { part: self.part, lines: self.cursor.rest() });
                Ok(())
            }
            "ELEMENT" => self.elements(keyword),
            "ELSET" if keyword.parameter("INSTANCE").is_empty() => {
                self.set_lines.push(SetLines {
                    part: self.part,
                    name: keyword.parameter("ELSET").into(),
                    is_range: keyword.parameters.contains_key("GENERATE"),
                    path: self.cursor.rest().path().to_owned(),
                    lines: self.cursor.clone(),
                });
                Ok(())
            }
            "PART" => {
                self.parts.push(keyword.parameter("NAME").to_owned());
                self.part = self.parts.len();
                Ok(())
            }
            "END PART" => {
                self.part = 0;
                Ok(())
            }
            "INSTANCE" => self.instance(keyword),
            _ => Ok(()),
        }
    }

    fn elements(&mut self, keyword: &Keyword) -> Result<()> {
        let kind = keyword.parameter("TYPE").to_ascii_uppercase();
        let rest = FAMILIES.iter().find_map(|family| kind.strip_prefix(family));
        let Some(rest) = rest.filter(|rest| rest.starts_with(|letter: char| letter.is_ascii_digit())) else {
            // Shells, beams, rigid surfaces, springs.
            return Ok(());
        };
        let digits = rest.chars().take_while(char::is_ascii_digit).count();
        let count = rest[..digits].parse().ok().filter(|_| !rest.ends_with('V'));
        let solid = SOLIDS.into_iter().find(|solid| Some(solid.0) == count).ok_or_else(|| {
            let error = self.cursor.error("elements of this type are not read").got(&kind);
            error.expected("C3D4, C3D5, C3D6, C3D8, C3D10, C3D13, C3D15, C3D20 and their variants")
        })?;
        let set = keyword.parameter("ELSET").to_owned();
        self.mesh.elements.push(ElementLines { part: self.part, lines: self.cursor.rest(), solid, set });
        Ok(())
    }

    /// Keeps the elements of a set within a part. All files were passed over before: their size is the limit.
    fn set(&mut self, set: SetLines) -> Result<()> {
        let SetLines { part, name, is_range, mut lines, .. } = set;
        while let Some(line) = data_line(&mut lines)? {
            // Names of other sets stand among numbers.
            let numbers: Vec<u64> = line.split(',').filter_map(|word| word.trim().parse().ok()).collect();
            let elements = match numbers[..] {
                [first, last, ..] if is_range => {
                    let step = numbers.get(2).copied().unwrap_or(1).max(1);
                    let count = last.saturating_sub(first) / step;
                    self.range_sum = self.range_sum.saturating_add(count);
                    let is_beyond = |count: u64| count > self.included.file_bytes / MIN_ELEMENT_BYTES;
                    if is_beyond(count)
                        || is_beyond(self.mesh.sets.len() as u64)
                        || self.range_sum > self.included.file_bytes.saturating_mul(MAX_IN_RANGES)
                    {
                        let error = lines.error("a set holds more elements than the file").got(line);
                        return Err(error.expected("the first, the last, the step"));
                    }
                    (first..=last).step_by(step as usize).collect()
                }
                _ => numbers,
            };
            for element in elements {
                self.mesh.sets.entry((part, element)).or_insert_with(|| name.clone());
            }
        }
        Ok(())
    }

    /// A translation, then a rotation: two points of its axis and degrees.
    fn instance(&mut self, keyword: &Keyword) -> Result<()> {
        let part = self.parts.iter().position(|name| name.eq_ignore_ascii_case(keyword.parameter("PART")));
        let part = part.ok_or_else(|| {
            let error = self.cursor.error("an instance is of a part that does not exist");
            error
                .got(format_args!("'{}'", keyword.parameter("PART")))
                .expected("the name of a part before it")
        })?;
        let mut lines = self.cursor.clone();
        let mut rows = Vec::new();
        while let Some(line) = data_line(&mut lines)? {
            let numbers: Vec<f64> = line.split(',').map_while(|word| word.trim().parse().ok()).collect();
            rows.push((numbers, line));
        }
        let [translation, a, b, degrees] = match &rows[..] {
            [] => [DVec3::ZERO; 4],
            [(move_by, _)] if move_by.len() == 3 => {
                [DVec3::from_slice(move_by), DVec3::ZERO, DVec3::ZERO, DVec3::ZERO]
            }
            [(move_by, _), (turn, _)] if move_by.len() == 3 && turn.len() == 7 => [
                DVec3::from_slice(move_by),
                DVec3::from_slice(turn),
                DVec3::from_slice(&turn[3..]),
                DVec3::splat(turn[6]),
            ],
            [(_, line), ..] => {
                let error = lines.error("the place of an instance is damaged").got(format_args!("'{line}'"));
                return Err(error.expected("a translation, and on a second line two points and degrees"));
            }
        };
        let axis = (b - a).try_normalize();
        self.mesh.instances.push(Instance {
            part: part + 1,
            name: keyword.parameter("NAME").to_owned(),
            rotation: axis
                .map_or(DQuat::IDENTITY, |axis| DQuat::from_axis_angle(axis, degrees.x.to_radians())),
            pivot: a,
            translation,
        });
        Ok(())
    }
}

/// The next line of data; `None` before a keyword and at the end.
fn data_line(cursor: &mut Cursor) -> Result<Option<String>> {
    loop {
        let Some(line) = cursor.line()? else { return Ok(None) };
        let line = line.trim_ascii();
        if line.starts_with(b"**") || line.is_empty() {
            continue;
        }
        let is_data = !line.starts_with(b"*");
        return Ok(is_data.then(|| String::from_utf8_lossy(line).into_owned()));
    }
}

/// Number of a node or element of an instance among those of all.
fn tag(instance: usize, number: u64) -> Result<u64> {
    match number >> PART_SHIFT {
        0 => Ok((instance as u64) << PART_SHIFT | number),
        _ => Err(Error::run("a number of the mesh is too large").got(number)),
    }
}

/// Words of a line of data; none of a comment.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let line = line.trim_ascii();
    let line = if line.starts_with(b"*") { b"" } else { line };
    line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii)
}

fn number<T: Target>(number_type: NumberType, word: &[u8]) -> Result<T> {
    numbers::parse(number_type, word).map_err(|error| error.expected("a number"))
}

/// Number and position of the node of a line, if it has one.
fn node(line: &[u8], nodes: &mut Vec<(u64, DVec3)>) -> Result<()> {
    let text = line.trim_ascii();
    if text.is_empty() || text.starts_with(b"*") {
        return Ok(());
    }
    let mut words = words(text);
    let own = number(NumberType::U64, words.next().unwrap_or_default())?;
    tag(0, own)?;
    let mut position = DVec3::ZERO;
    for (axis, word) in words.take(3).enumerate().filter(|word| !word.1.is_empty()) {
        position[axis] = number(NumberType::F64, word)?;
    }
    nodes.push((own, position));
    Ok(())
}

/// Mark behind the numbers of a line; the place of the line follows.
const LINE: u64 = u64::MAX;

fn element_numbers(piece: &TextPiece) -> Result<Vec<u64>> {
    let mut all = Vec::with_capacity(piece.bytes.len() / 6);
    for line in piece.lines() {
        let count = all.len();
        for word in words(line).filter(|word| !word.is_empty()) {
            let own = number(NumberType::U64, word).and_then(|number| tag(0, number));
            all.push(own.map_err(|error| piece.locate(error, line))?);
        }
        if all.len() > count {
            all.extend([LINE, piece.place(line)]);
        }
    }
    Ok(all)
}

impl ElementLines {
    /// Calls `visit` with each element: its number, then those of its nodes.
    fn each(&self, mut visit: impl FnMut(&[u64]) -> Result<()>) -> Result<()> {
        let node_count = self.solid.0;
        let (mut numbers, mut last) = (Vec::new(), 0);
        self.lines.each_piece(
            |rest| rest[0] == b'\n',
            element_numbers,
            |found| {
                let mut rest = &found[..];
                while let Some(end) = rest.iter().position(|&number| number == LINE) {
                    numbers.extend_from_slice(&rest[..end]);
                    last = rest.get(end + 1).copied().unwrap_or(0);
                    rest = rest.get(end + 2..).unwrap_or_default();
                    // An element goes on in the next line.
                    if numbers.len() <= node_count {
                        continue;
                    }
                    if numbers.len() > node_count + 1 {
                        let error = Error::run(format!("element {} has too many nodes", numbers[0]));
                        return Err(self
                            .lines
                            .locate(error.got(numbers.len() - 1).expected(node_count), last));
                    }
                    visit(&numbers)?;
                    numbers.clear();
                }
                Ok(true)
            },
        )?;
        match numbers.first() {
            None => Ok(()),
            Some(first) => {
                let error = Error::run(format!("element {first} ends early")).got(numbers.len() - 1);
                Err(self.lines.locate(error.expected(format_args!("{node_count} nodes")), last))
            }
        }
    }
}

impl TaggedMesh for AbaqusMesh {
    fn own_number(&self, tag: u64) -> u64 {
        number_in_part(tag)
    }

    fn each_node(&self, visit: VisitNode) -> Result<()> {
        for (number, instance) in self.instances.iter().enumerate() {
            for own in self.nodes.iter().filter(|own| own.part == instance.part) {
                let read = own.lines.rows(node, |(node, position)| {
                    // Moved first, then turned.
                    let moved = position + instance.translation;
                    let placed = instance.rotation * (moved - instance.pivot) + instance.pivot;
                    visit(tag(number, node)?, placed)
                });
                read.map_err(|error| error.in_file(own.lines.path()))?;
            }
        }
        Ok(())
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        for (number, instance) in self.instances.iter().enumerate() {
            for own in self.elements.iter().filter(|own| own.part == instance.part) {
                let of_all = (!own.set.is_empty()).then(|| self.block(instance, own, 0));
                let mut nodes = Vec::new();
                let read = own.each(|numbers| {
                    nodes.clear();
                    for &node in &numbers[1..] {
                        nodes.push(tag(number, node)?);
                    }
                    let listed;
                    let block = match &of_all {
                        Some(block) => block,
                        None => {
                            listed = self.block(instance, own, numbers[0]);
                            &listed
                        }
                    };
                    visit(&TaggedElement {
                        tag: tag(number, numbers[0])?,
                        code: own.solid.1,
                        block,
                        nodes: &nodes,
                    })
                });
                read.map_err(|error| error.in_file(own.lines.path()))?;
            }
        }
        Ok(())
    }
}

impl AbaqusMesh {
    /// Name of an element's set, after that of its instance.
    fn block(&self, instance: &Instance, lines: &ElementLines, element: u64) -> String {
        let listed = || self.sets.get(&(lines.part, element)).map_or("", |set| &**set);
        let set = if lines.set.is_empty() { listed() } else { &lines.set };
        match (instance.name.as_str(), set) {
            ("", set) => set.to_owned(),
            (name, "") => name.to_owned(),
            (name, set) => format!("{name}/{set}"),
        }
    }
}
