//! Tecplot data as text (.dat, .tec).
//!
//! Source: Tecplot 360 data format guide, "ASCII data".

use super::zones::{ZoneHead, ZoneKind, axes, dataset, polyhedra, quantities};
use crate::formats::contents::{CellBlocks, Dataset, Piece};
use crate::formats::cursor::{Cursor, Place};
use crate::formats::lazy::{into_cells, mesh_head};
use crate::formats::nastran;
use crate::formats::numbers::{self, NumberType};
use crate::formats::request::{Format, Request};
use crate::formats::source::{Source, quoted};
use glam::DVec3;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::{CellSet, Cells, code};
use voltet_core::progress::Progress;
use voltet_core::reading::{FileArray, GridHead, GridRead, OpenGrid};
use voltet_core::{Error, Result};

pub(super) const FORMAT: Format =
    Format { files: "Tecplot data as text (.dat, .tec)", matches, open, has_solution: false };

fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let text = String::from_utf8_lossy(head).to_lowercase();
    // Decks of Nastran may begin with a title, too.
    if path.extension().is_some_and(nastran::is_ending) || text.lines().any(nastran::begins_bulk) {
        return false;
    }
    let is_first = |line: &str| {
        let key = line.split('=').next().unwrap_or_default().trim();
        let is_zone = line.split([' ', '\t', ',']).next() == Some("zone");
        line.contains('=') && ["title", "variables", "filetype"].contains(&key) || is_zone
    };
    text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#')).is_some_and(is_first)
}

/// Rows of a table that are in memory at a time.
const BATCH: u64 = 1 << 18;

/// One zone, whose numbers are not yet read.
struct TextZone {
    head: ZoneHead,
    /// True if each variable is a run of numbers; else each node has all variables side by side.
    is_block: bool,
    data: Place,
    /// True if some number of the data stands for several.
    has_repeats: bool,
    connectivity: Place,
    /// Faces of polyhedra or polygons, and their nodes.
    faces: [u64; 2],
}

struct TecplotFile {
    source: Arc<Source>,
    variables: Vec<String>,
    axes: [usize; 3],
    zones: Vec<TextZone>,
}

type Entries = Vec<(String, Vec<String>)>;

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let file = Arc::new(TecplotFile::read(&source)?);
    let heads: Vec<&ZoneHead> = file.zones.iter().map(|zone| &zone.head).collect();
    dataset(&source, "Tecplot, ASCII".to_owned(), &heads, file.axes, request, |zone, block| {
        piece(&file, zone, block)
    })
}

fn piece(file: &Arc<TecplotFile>, zone: usize, block: usize) -> Piece {
    let open = OpenZone::new(file, zone);
    Piece::of_open(&file.source, Arc::new(open)).with_blocks(CellBlocks::One(block))
}

/// A zone as a grid of its own.
struct OpenZone {
    file: Arc<TecplotFile>,
    zone: usize,
    head: GridHead,
    /// The variable of each array of the head.
    variables: Vec<usize>,
}

impl OpenZone {
    fn new(file: &Arc<TecplotFile>, zone: usize) -> OpenZone {
        let own = &file.zones[zone].head;
        let corner_count = own.cell_count.saturating_mul(own.kind.corners().max(4));
        let (mut arrays, mut variables) = (Vec::new(), Vec::new());
        for (variable, association) in quantities(own, file.axes) {
            let name = file.variables[variable].clone();
            arrays.push(FileArray { name, association, component_count: 1 });
            variables.push(variable);
        }
        let head = GridHead { arrays, ..mesh_head([own.node_count, own.cell_count, corner_count]) };
        OpenZone { file: file.clone(), zone, head, variables }
    }
}

impl OpenGrid for OpenZone {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], _: &dyn Progress) -> Result<GridRead> {
        let axes = self.file.axes.into_iter().filter(|_| geometry);
        let variables: Vec<usize> = axes.chain(arrays.iter().map(|&array| self.variables[array])).collect();
        let mut arrays = self.file.values(self.zone, &variables)?;
        let mut read = GridRead::default();
        if geometry {
            let axes: Vec<Vec<f64>> = arrays.drain(..3).collect();
            let point = |i: usize| DVec3::new(axes[0][i], axes[1][i], axes[2][i]);
            read.points = Some((0..axes[0].len()).map(point).collect());
            read.cells = Some(self.file.cells(self.zone)?);
        }
        Ok(GridRead { arrays, ..read })
    }
}

impl TecplotFile {
    /// Reads the heads, and passes over the numbers.
    fn read(source: &Arc<Source>) -> Result<TecplotFile> {
        let mut cursor = Cursor::new(source);
        let mut file =
            TecplotFile { source: source.clone(), variables: Vec::new(), axes: [0, 1, 2], zones: Vec::new() };
        loop {
            let entries = head(&mut cursor)?;
            if let Some((_, kind)) = entries.iter().find(|entry| entry.0 == "FILETYPE")
                && kind.first().is_some_and(|kind| kind.eq_ignore_ascii_case("SOLUTION"))
            {
                let error = cursor.error("a file of solutions alone has no coordinates");
                return Err(error.got("FILETYPE=SOLUTION").expected("FILETYPE=FULL"));
            }
            if let Some((_, names)) = entries.iter().find(|entry| entry.0 == "VARIABLES") {
                if !file.zones.is_empty() && names.len() != file.variables.len() {
                    let error = cursor.error("the variables change between zones").got(names.len());
                    return Err(error.expected(format_args!("{} variables", file.variables.len())));
                }
                file.variables = names.clone();
            }
            match entries.iter().filter(|entry| entry.0 == "ZONE").count() {
                1 => {}
                0 => {
                    let Some(word) = cursor.word()?.map(quoted) else { break };
                    let error = cursor.error("numbers belong to no zone").got(word);
                    return Err(error.expected("ZONE before them; geometries are not read"));
                }
                _ => return Err(cursor.error("a zone without numbers of its own is not read")),
            }
            if file.variables.len() < 3 {
                let error = cursor.error("the file names too few variables").got(file.variables.len());
                return Err(error.expected("VARIABLES with x, y and z first"));
            }
            let zone = file.zone(&entries, &mut cursor)?;
            file.zones.push(zone);
        }
        file.axes = axes(&file.variables);
        Ok(file)
    }

    /// A zone by its head; moves behind its numbers.
    fn zone(&self, entries: &Entries, cursor: &mut Cursor) -> Result<TextZone> {
        let value = |keys: &[&str]| {
            let found = entries.iter().rev().find(|entry| keys.contains(&entry.0.as_str()));
            found.and_then(|entry| entry.1.first()).map_or("", String::as_str)
        };
        let count = |keys: &[&str], without: u64| match value(keys) {
            "" => Ok(without),
            word => word.parse::<u64>().map_err(|_| {
                cursor
                    .error(format!("{} of a zone is damaged", keys[0]))
                    .got(format_args!("'{word}'"))
                    .expected("a number")
            }),
        };
        let form = value(&["F", "FORMAT"]).to_ascii_uppercase();
        let shape = format!("{}{}", value(&["ZONETYPE"]), value(&["ET"])).to_ascii_uppercase();
        let is_ordered = shape.is_empty() && !form.starts_with("FE") || shape == "ORDERED";
        let points = [count(&["I"], 1)?, count(&["J"], 1)?, count(&["K"], 1)?];
        let ordered = ZoneKind::ordered(points);
        let kind = match shape.trim_start_matches("FE") {
            _ if is_ordered => ordered.0,
            "TETRAHEDRON" => ZoneKind::Tetrahedra,
            "BRICK" => ZoneKind::Bricks,
            "TRIANGLE" => ZoneKind::Flat(3),
            "QUADRILATERAL" => ZoneKind::Flat(4),
            "LINESEG" => ZoneKind::Flat(2),
            "POLYHEDRON" => ZoneKind::Polyhedra,
            "POLYGON" => ZoneKind::Flat(0),
            "" => {
                let error = cursor.error("a zone of finite elements does not say of which type they are");
                return Err(error.expected("ZONETYPE, or ET beside F=FEPOINT or F=FEBLOCK"));
            }
            _ => {
                let error = cursor.error("zones of this type are not read").got(format_args!("'{shape}'"));
                return Err(error.expected(
                    "FETETRAHEDRON, FEBRICK, FEPOLYHEDRON, ORDERED, or surfaces and lines beside these",
                ));
            }
        };
        let (node_count, cell_count) = if is_ordered {
            (ordered.1, ordered.2)
        } else {
            (count(&["NODES", "N"], 0)?, count(&["ELEMENTS", "E"], 0)?)
        };
        // Coordinates and nodes of cells take two bytes each at least.
        if node_count.max(cell_count) > self.source.len() {
            let error = cursor.error("the zone does not fit the file").got(node_count.max(cell_count));
            return Err(error.expected("numbers of nodes and cells that the file holds"));
        }
        let counts = [node_count, cell_count];
        let mut zone = ZoneHead::new(value(&["T"]).to_owned(), kind, counts, self.variables.len());
        zone.time = match value(&["SOLUTIONTIME"]) {
            "" => None,
            word => Some(numbers::parse(NumberType::F64, word.as_bytes()).map_err(|_| {
                let error = cursor.error("SOLUTIONTIME of a zone is damaged");
                error.got(format_args!("'{word}'")).expected("a number")
            })?),
        };
        // Of a zone that says neither, VTK and VisIt take each node's variables to stand side by side.
        // Those of faces are always blocks.
        let is_of_faces = shape.contains("POLY");
        let is_block = value(&["DATAPACKING"]).to_ascii_uppercase().ends_with("BLOCK")
            || form.ends_with("BLOCK")
            || is_of_faces;
        let face_count = count(&["FACES"], 0)?;
        // Faces of polygons are edges, of two nodes each.
        let of_edges = if shape.ends_with("POLYGON") { face_count.saturating_mul(2) } else { 0 };
        let faces = [face_count, count(&["TOTALNUMFACENODES"], of_edges)?];
        let with_others = count(&["NUMCONNECTEDBOUNDARYFACES"], 0)?;
        let connections = count(&["TOTALNUMBOUNDARYCONNECTIONS"], 0)?;
        let lists = |key: &str| {
            lists(value(&[key]), self.variables.len()).map_err(|found| {
                let error = cursor.error(format!("{key} of a zone is damaged"));
                error.got(format_args!("'{found}'")).expected("numbers of variables in brackets, and a word")
            })
        };
        for (variables, word) in lists("VARLOCATION")? {
            let is_cell = word.eq_ignore_ascii_case("CELLCENTERED");
            if !is_cell && !word.eq_ignore_ascii_case("NODAL") {
                let error = cursor.error("VARLOCATION of a zone is damaged").got(format_args!("'{word}'"));
                return Err(error.expected("NODAL or CELLCENTERED"));
            }
            variables.into_iter().for_each(|variable| zone.at_cells[variable] = is_cell);
        }
        let earlier = |word: &str| {
            let number = word.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
            let number = number.filter(|&number| number < self.zones.len());
            number.ok_or_else(|| {
                let error =
                    cursor.error("a zone shares what no zone before it has").got(format_args!("'{word}'"));
                error.expected(format_args!("the number of a zone, at most {}", self.zones.len()))
            })
        };
        let word = value(&["VARSHARELIST"]);
        if !word.is_empty() && !word.contains('[') {
            let error = cursor.error("VARSHARELIST of a zone is damaged").got(quoted(word.as_bytes()));
            return Err(error.expected("numbers of variables in brackets, and a zone"));
        }
        for (variables, word) in lists("VARSHARELIST")? {
            let other = if word.is_empty() { self.zones.len().wrapping_sub(1) } else { earlier(&word)? };
            let Some(other_zone) = self.zones.get(other) else {
                return Err(cursor.error("the first zone shares variables with none before it"));
            };
            for variable in variables {
                zone.share(variable, other, &other_zone.head)
                    .map_err(|error| error.at_line(cursor.last_line()))?;
            }
        }
        for (variables, word) in lists("PASSIVEVARLIST")? {
            // Without brackets the words themselves are numbers of variables.
            let word: Option<usize> =
                word.parse().ok().filter(|number| (1..=zone.passive.len()).contains(number));
            let variables = word.map_or(variables, |number| vec![number - 1]);
            variables.into_iter().for_each(|variable| zone.passive[variable] = true);
        }
        match value(&["CONNECTIVITYSHAREZONE"]) {
            "" => {}
            word => zone.shared_cells = Some(earlier(word)?),
        }
        if !is_block && zone.at_cells.contains(&true) {
            let error = cursor.error("variables at cells stand side by side with those at nodes");
            return Err(error.expected("DATAPACKING=BLOCK"));
        }
        let data = cursor.place();
        let number_count = (0..self.variables.len()).filter(|&variable| zone.holds(variable));
        let number_count = number_count.fold(0_u64, |sum, variable| sum.saturating_add(zone.len(variable)));
        let has_repeats = skip_numbers(cursor, number_count)?;
        let connectivity = cursor.place();
        if is_of_faces && zone.shared_cells.is_none() {
            let node_counts = if kind == ZoneKind::Polyhedra { faces[0] } else { 0 };
            let others = if with_others > 0 { [with_others, connections, connections] } else { [0; 3] };
            for count in [node_counts, faces[1], faces[0], faces[0]].into_iter().chain(others) {
                cursor.skip_comments()?;
                cursor.skip_numbers(count, 0)?;
            }
        } else if zone.shared_cells.is_none() {
            cursor.skip_numbers(zone.cell_count.saturating_mul(zone.kind.corners()), 0)?;
        }
        Ok(TextZone { head: zone, is_block, data, has_repeats, connectivity, faces })
    }

    /// Values of variables of a zone, in one pass over the numbers of each zone that holds some.
    fn values(&self, zone: usize, variables: &[usize]) -> Result<Vec<Vec<f64>>> {
        let holder = |&variable: &usize| {
            std::iter::successors(Some(zone), |&own| self.zones[own].head.shared[variable])
                .last()
                .unwrap_or(zone)
        };
        let holders: Vec<usize> = variables.iter().map(holder).collect();
        let mut all = vec![Vec::new(); variables.len()];
        for holder in BTreeSet::from_iter(&holders) {
            let own = |place: &usize| holders[*place] == *holder;
            let places: Vec<usize> = (0..variables.len()).filter(own).collect();
            let held: Vec<usize> = places.iter().map(|&place| variables[place]).collect();
            let found = self.held_values(&self.zones[*holder], &held)?;
            places.into_iter().zip(found).for_each(|(place, values)| all[place] = values);
        }
        Ok(all)
    }

    /// Values of variables whose numbers a zone holds itself.
    fn held_values(&self, zone: &TextZone, variables: &[usize]) -> Result<Vec<Vec<f64>>> {
        let stored: Vec<usize> = (0..self.variables.len()).filter(|&other| zone.head.holds(other)).collect();
        let places: Vec<Option<usize>> =
            variables.iter().map(|variable| stored.iter().position(|own| own == variable)).collect();
        let mut cursor = Cursor::at(&self.source, zone.data);
        let mut run = Run { has_repeats: zone.has_repeats, ..Run::new(&mut cursor) };
        let mut all = vec![Vec::new(); variables.len()];
        if zone.is_block {
            let behind_last = places.iter().flatten().max().map_or(0, |last| last + 1);
            for (place, &variable) in stored[..behind_last].iter().enumerate() {
                let count = zone.head.len(variable);
                let read = match places.iter().position(|own| *own == Some(place)) {
                    Some(wanted) => run.numbers(count).map(|values| all[wanted] = values),
                    None => run.skip(count),
                };
                read.map_err(|error| error.at_item(&self.variables[variable]))?;
            }
            return Ok(all);
        }
        let mut left = zone.head.node_count;
        let batch = (8 * BATCH / stored.len().max(1) as u64).max(1);
        while left > 0 {
            let count = left.min(batch);
            let rows = run.numbers(count.saturating_mul(stored.len() as u64))?;
            for (values, place) in all.iter_mut().zip(&places) {
                values.extend(place.iter().flat_map(|&place| rows.iter().skip(place).step_by(stored.len())));
            }
            left -= count;
        }
        Ok(all)
    }

    fn cells(&self, zone: usize) -> Result<Cells> {
        let own = &self.zones[zone].head;
        if let ZoneKind::Ordered(points_along) = own.kind {
            return Ok(Cells::Structured(points_along.map(|n| n as usize)));
        }
        let mut holder = &self.zones[zone];
        while let Some(other) = holder.head.shared_cells {
            holder = &self.zones[other];
        }
        let size = |head: &ZoneHead| (head.cell_count, head.kind.corners());
        if size(&holder.head) != size(own) {
            return Err(Error::run("a zone shares the cells of one with others").at_item(&own.name));
        }
        let code = if own.kind == ZoneKind::Tetrahedra { code::TETRA } else { code::HEXAHEDRON };
        let (mut cursor, mut cells) = (Cursor::at(&self.source, holder.connectivity), CellSet::default());
        if own.kind == ZoneKind::Polyhedra {
            return read_polyhedra(&mut cursor, holder.faces, own);
        }
        let mut left = own.cell_count;
        let corner_count = own.kind.corners();
        while left > 0 {
            let count = left.min(BATCH);
            let corners =
                cursor.node_numbers(count.saturating_mul(corner_count), own.node_count, "a cell")?;
            cells.push_all(code, corner_count as usize, &corners);
            left -= count;
        }
        Ok(into_cells(cells))
    }
}

/// Polyhedra by the numbers of nodes of their faces, these nodes, the cells on the left of the faces, and those on the right.
fn read_polyhedra(cursor: &mut Cursor, [face_count, node_count]: [u64; 2], zone: &ZoneHead) -> Result<Cells> {
    cursor.skip_comments()?;
    let sizes: Vec<u64> = cursor.numbers(NumberType::U64, face_count, "the number of nodes of a face")?;
    let mut bounds = vec![0];
    bounds.extend(sizes.iter().scan(0_u64, |end, size| {
        *end = end.saturating_add(*size);
        Some(*end)
    }));
    if bounds.last() != Some(&node_count) {
        let error = cursor.error("TOTALNUMFACENODES of a zone is wrong").got(node_count);
        return Err(error.expected(format_args!("{}, as its faces say", bounds[bounds.len() - 1])));
    }
    cursor.skip_comments()?;
    let nodes = cursor.node_numbers(node_count, zone.node_count, "a face")?;
    let mut sides: Vec<i64> = Vec::new();
    for _ in 0..2 {
        cursor.skip_comments()?;
        // 0 stands for no cell, numbers below for those of other zones.
        let own: Vec<i64> = cursor.numbers(NumberType::I64, face_count, "the number of a cell")?;
        sides.extend(own.iter().map(|&cell| cell.saturating_sub(1)));
    }
    polyhedra(zone, &bounds, &nodes, &sides)
}

/// Numbers of text, of which 3*0.5 stands for three.
struct Run<'a> {
    cursor: &'a mut Cursor,
    /// False if each number is known to stand for one.
    has_repeats: bool,
    value: f64,
    /// Times that it still comes.
    repeats: u64,
    /// Times that it comes in all, where it was passed over in part.
    all_repeats: u64,
}

impl Run<'_> {
    fn new(cursor: &mut Cursor) -> Run<'_> {
        Run { cursor, has_repeats: true, value: 0.0, repeats: 0, all_repeats: 0 }
    }

    fn numbers(&mut self, count: u64) -> Result<Vec<f64>> {
        match self.has_repeats {
            true => (0..count).map(|_| self.next()).collect(),
            false => self.cursor.numbers(NumberType::F64, count, "a number"),
        }
    }

    fn next(&mut self) -> Result<f64> {
        if self.repeats == 0 {
            let Some(word) = self.cursor.word()? else {
                return Err(self.cursor.error("the file ends early").expected("a number"));
            };
            let star = word.iter().position(|&byte| byte == b'*');
            let (count, value) = star.map_or((&b"1"[..], word), |star| (&word[..star], &word[star + 1..]));
            let parsed = numbers::parse(NumberType::I64, count)
                .and_then(|count: u64| Ok((count, numbers::parse(NumberType::F64, value)?)));
            (self.repeats, self.value) = parsed.map_err(|error| self.damaged(error))?;
            if self.repeats == 0 {
                return Err(self.cursor.error("a number is repeated no times").expected("at least once"));
            }
        }
        self.repeats -= 1;
        Ok(self.value)
    }

    /// Passes over numbers, which are not parsed but for one that goes on behind them.
    fn skip(&mut self, mut count: u64) -> Result<()> {
        if !self.has_repeats {
            return self.cursor.skip_numbers(count, 0);
        }
        let begun = count.min(self.repeats);
        (self.repeats, count) = (self.repeats - begun, count - begun);
        while count > 0 {
            let Some(word) = self.cursor.word()? else {
                let error = self.cursor.error("the file ends early");
                return Err(error.expected(format_args!("{count} numbers more")));
            };
            let Some(star) = word.iter().position(|&byte| byte == b'*') else {
                count -= 1;
                continue;
            };
            let repeats: u64 = numbers::parse(NumberType::I64, &word[..star]).unwrap_or(1).max(1);
            if repeats > count {
                let value = numbers::parse(NumberType::F64, &word[star + 1..]);
                self.value = value.map_err(|error| self.damaged(error))?;
                (self.repeats, self.all_repeats) = (repeats - count, repeats);
            }
            count = count.saturating_sub(repeats);
        }
        Ok(())
    }

    fn damaged(&self, error: Error) -> Error {
        self.cursor.error("a number is damaged").got(error.got.unwrap_or_default()).expected("a number")
    }
}

/// Passes over numbers; true if some stand for several.
fn skip_numbers(cursor: &mut Cursor, count: u64) -> Result<bool> {
    let start = cursor.clone();
    // Fewer words than numbers may end before the file does.
    if cursor.skip_numbers(count, 0).is_ok() && !start.range_to(cursor).contains(b'*')? {
        return Ok(false);
    }
    *cursor = start;
    let mut run = Run::new(cursor);
    run.skip(count)?;
    let Run { repeats: beyond, all_repeats, .. } = run;
    if beyond == 0 {
        return Ok(true);
    }
    let error = cursor.error("a repeated number goes beyond its zone");
    Err(error.got(all_repeats).expected(all_repeats - beyond))
}

/// Keys and values up to the first line of numbers, or to the end of the file.
fn head(cursor: &mut Cursor) -> Result<Entries> {
    let mut text = String::new();
    while let Some(first) = cursor.peek()? {
        if first.is_ascii_digit() || b"+-.".contains(&first) {
            break;
        }
        let line = cursor.text_line("a head")?;
        if !line.starts_with('#') {
            text.push_str(&line);
            text.push('\n');
        }
    }
    let words = words(&text);
    let mut entries = Entries::new();
    for (place, (word, is_plain)) in words.iter().enumerate() {
        let is_key = *is_plain && words.get(place + 1).is_some_and(|next| next.0 == "=" && next.1);
        let is_value = place > 0 && words[place - 1].0 == "=";
        let is_zone = *is_plain && !is_value && word.eq_ignore_ascii_case("zone");
        if is_key || is_zone {
            entries.push((word.to_ascii_uppercase(), Vec::new()));
        } else if let Some(entry) = entries.last_mut().filter(|_| !(*is_plain && word == "=")) {
            entry.1.push(word.clone());
        }
    }
    Ok(entries)
}

/// Words, texts in quotes, parentheses with what they hold, and signs of equality; true: a word or sign.
fn words(text: &str) -> Vec<(String, bool)> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| !letter.is_whitespace() && letter != ',') {
        rest = &rest[start..];
        let first = rest.chars().next().unwrap_or(' ');
        let (length, is_plain) = match first {
            '=' => (1, true),
            '"' => (rest[1..].find(['"', '\n']).map_or(rest.len(), |end| end + 2), false),
            '(' => (rest.find(')').map_or(rest.len(), |end| end + 1), false),
            _ => {
                let end = rest.find(|letter: char| letter.is_whitespace() || ",=\"(".contains(letter));
                (end.unwrap_or(rest.len()), true)
            }
        };
        let word = &rest[..length];
        words.push((if is_plain { word } else { word.trim_matches(['"', '\n']) }.to_owned(), is_plain));
        rest = &rest[length..];
    }
    words
}

/// Places of variables from 0, and a word about them.
type VariableLists = Vec<(Vec<usize>, String)>;

/// Entries of a list such as ([4-6,8]=CELLCENTERED). Without brackets the list has a word for each variable. Errors: the part that is
/// damaged.
fn lists(text: &str, variable_count: usize) -> std::result::Result<VariableLists, String> {
    let text = text.trim().trim_start_matches('(').trim_end_matches(')');
    let separators = [' ', ',', '\n', '\t'];
    if !text.contains('[') {
        let words: Vec<&str> = text.split(separators).filter(|word| !word.is_empty()).collect();
        if words.len() > variable_count {
            return Err(text.to_owned());
        }
        return Ok(words.iter().enumerate().map(|(place, word)| (vec![place], (*word).to_owned())).collect());
    }
    let place = |word: &str| {
        let place = word.trim().parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        place.filter(|&place| place < variable_count).ok_or_else(|| word.to_owned())
    };
    let mut lists = Vec::new();
    for part in text.split('[').skip(1) {
        let (numbers, after) = part.split_once(']').ok_or_else(|| part.to_owned())?;
        let mut variables = Vec::new();
        for range in numbers.split(',') {
            let (first, last) = range.split_once('-').unwrap_or((range, range));
            variables.extend(place(first)?..=place(last)?);
        }
        let word = after.trim_matches(|letter| letter == '=' || separators.contains(&letter));
        lists.push((variables, word.to_owned()));
    }
    Ok(lists)
}

#[cfg(test)]
#[path = "text_tests.rs"]
mod tests;
