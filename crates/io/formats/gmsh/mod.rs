//! Meshes of Gmsh (.msh) of the versions 1, 2 and 4, in text and, but for 1 and 4.0, in bytes of either order, with their post-processing
//! views.
//!
//! Source: Gmsh reference manual, "MSH file format", "MSH file format version 2 (Legacy)" and "version 1 (Legacy)"; of 4.0 the manual of Gmsh
//! 4.0. A file is a row of sections,
//! `$Name` to `$EndName`. On opening, sections are found, heads of views read, and volume elements counted; nodes,
//! elements and values are read when they are asked for. Physical groups of volumes are blocks. Sections of other names are passed
//! over.

mod elements;
mod mesh;
mod views;

use self::mesh::{GroupCounts, MeshFile, MeshSection, header};
use self::views::View;
use super::blocks::selected;
use super::contents::{CellBlocks, Compute, Dataset, Piece, PieceArray};
use super::cursor::Cursor;
use super::lazy::geometry;
use super::numbers::NumberType;
use super::request::{Format, Request};
use super::source::Source;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::grid::CellValues;
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result, counted};

/// First lines of files: comments may stand before the format, which version 1 does not say.
const MAGIC: [&str; 3] = ["$MeshFormat", "$Comments", FIRST_NODES];
/// The section of the nodes in version 1.
const FIRST_NODES: &str = "$NOD";
/// The mark of UTF-8 at the head of a file.
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

pub(super) const FORMAT: Format = Format {
    files: "a mesh of Gmsh (.msh)",
    matches: |head, _, _| {
        let first = head.split(|&byte| byte == b'\n').next().unwrap_or_default().trim_ascii();
        MAGIC.iter().any(|word| first == word.as_bytes())
    },
    open,
    has_solution: false,
};

/// Reads the table of contents.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    // The mark of UTF-8 is no part of the first line.
    let begin = source.head(BYTE_ORDER_MARK.len() as u64)?;
    let begin = if begin == BYTE_ORDER_MARK { begin.len() as u64 } else { 0 };
    let start = Cursor::within(&source, begin, source.len(), 1);
    let mut cursor = start.clone();
    let is_first = loop {
        match &*cursor.text_line("$MeshFormat")? {
            "$MeshFormat" => break false,
            FIRST_NODES => break true,
            "$Comments" => {
                let line = cursor.line_number();
                end_of_section(&mut cursor, "Comments", "End").map_err(|error| error.at_line(line))?;
            }
            _ => {}
        }
    };
    let mut file = header(&mut cursor, &source, is_first)?;
    if is_first {
        cursor = start;
    }
    let (mut names, mut without_dimension) = Default::default();
    let mut views = Vec::new();
    while let Some((name, section)) = next_section(&mut cursor, &file)? {
        match name.as_str() {
            "PhysicalNames" => {
                (names, without_dimension) = physical_names(&mut file.cursor(&section, false))?;
            }
            "Entities" | "PartitionedEntities" if file.version >= 4.0 => {
                let is_partitioned = name == "PartitionedEntities";
                let (mut cursor, is_4_0) = (file.cursor(&section, true), file.is_4_0());
                entities(&mut cursor, [is_partitioned, is_4_0], &mut file.group_of_volume)?;
            }
            "Nodes" | "NOD" => file.nodes = section,
            "Elements" | "ELM" => file.elements = section,
            _ => views.extend(View::of_section(&name, &file.cursor(&section, false))?),
        }
    }
    let required = if is_first { [FIRST_NODES, "$ELM"] } else { ["$Nodes", "$Elements"] };
    for (section, name) in [&file.nodes, &file.elements].into_iter().zip(required) {
        if section.end == 0 {
            return Err(Error::run("the mesh is not complete").expected(format_args!("a section {name}")));
        }
    }
    let node_count = file.node_count()?;
    let mut of_groups = file.find_groups(&names)?;
    let named = names.len();
    let mut counts_of_names = of_groups.iter();
    names.retain(|name| {
        let is_empty = counts_of_names.next().is_none_or(|own| own.cells == 0);
        !(is_empty && without_dimension.contains_key(&name.0))
    });
    if names.len() < named {
        of_groups = file.find_groups(&names)?;
    }
    let blocks = block_names(&file.groups, &names);
    file.is_selected = selected(&blocks, request)?;
    file.is_selected.resize(file.groups.len(), true);
    let mut counts = GroupCounts::default();
    for (own, _) in of_groups.iter().zip(&file.is_selected).filter(|group| *group.1) {
        counts.cells += own.cells;
        counts.corners += own.corners;
        counts.reduced += own.reduced;
    }
    file.selected_counts = [counts.cells, counts.corners].map(|count| count as usize);
    let mut dataset = Dataset {
        blocks,
        format: file.format(),
        file_bytes: source.len(),
        time_steps: views::times(&views),
        ..Dataset::default()
    };
    if counts.reduced > 0 {
        let count = counted(counts.reduced, "pyramid");
        dataset
            .warnings
            .push(format!("The node in the middle of the base of {count} of 14 nodes is left out."));
    }
    let step = match dataset.time_steps.as_slice() {
        [] => None,
        times => Some(times[request.step_index(times)?]),
    };
    let arrays = views::arrays(views, step);
    let requested = |name: &str| {
        let names = request.scalar.iter().chain(&request.point_arrays);
        names
            .clone()
            .any(|wanted| wanted == name || wanted.rsplit_once(':').is_some_and(|(stem, _)| stem == name))
    };
    if let Some(split) = arrays.iter().find(|array| array.is_by_corner() && requested(&array.name)) {
        file.is_split = request.options.cell_values == CellValues::Constant;
        if !file.is_split {
            dataset.warnings.push(format!(
                "The array '{}' has values of its own in each cell, which are averaged at the points; cell_values = \
                 \"constant\" keeps them.",
                split.name
            ));
        }
    }
    dataset.pieces.push(piece(Arc::new(file), node_count, &counts, arrays));
    Ok(dataset)
}

/// The next section and its name; `None` at the end of the file.
fn next_section(cursor: &mut Cursor, file: &MeshFile) -> Result<Option<(String, MeshSection)>> {
    while let Some(line) = cursor.line()? {
        let line = String::from_utf8_lossy(line.trim_ascii()).into_owned();
        let Some(name) = line.strip_prefix('$').filter(|name| *name != "EndMeshFormat") else { continue };
        let (start, line) = (cursor.position(), cursor.line_number());
        // Those of version 1 alone are in capitals.
        let is_old = file.version < 2.0 && ["NOD", "ELM"].contains(&name);
        let end_word = if is_old { "END" } else { "End" };
        skip_rows(cursor, file, name, format!("${end_word}{name}").as_bytes())?;
        let end = end_of_section(cursor, name, end_word).map_err(|error| error.at_line(line))?;
        return Ok(Some((name.to_owned(), MeshSection { start, end, line })));
    }
    Ok(None)
}

/// Moves behind the end of a section, and returns the place where its mark begins.
fn end_of_section(cursor: &mut Cursor, name: &str, end_word: &str) -> Result<u64> {
    let end = cursor.skip_past(format!("${end_word}{name}").as_bytes())?;
    end.ok_or_else(|| {
        Error::run("the file ends early").got(format_args!("a section ${name} without its end"))
    })
}

/// Moves from the beginning of a section of bytes to the mark of its end by the numbers of its rows, which are not read. Stays where they
/// do not lead to it: the mark is searched then.
fn skip_rows(cursor: &mut Cursor, file: &MeshFile, name: &str, mark: &[u8]) -> Result<()> {
    let end = match name {
        _ if file.binary.is_none() => None,
        "Nodes" | "Elements" => file.end_of_rows(cursor, name),
        _ => View::of_section(name, cursor).ok().flatten().and_then(|view| view.end_of_rows()),
    };
    let length = end.and_then(|end| end.checked_sub(cursor.position()));
    if let Some(length) = length.filter(|length| *length < cursor.left()) {
        let mut ahead = cursor.clone();
        ahead.skip(length)?;
        if ahead.peek()? == Some(b'$') && ahead.starts_with(mark)? {
            cursor.skip(ahead.position() - cursor.position())?;
        }
    }
    Ok(())
}

type GroupNames = Vec<(i64, String)>;

/// Physical groups of volumes and their names; how often a number stands without a dimension: the group may be of something else.
fn physical_names(cursor: &mut Cursor) -> Result<(GroupNames, HashMap<i64, usize>)> {
    let (mut names, mut without_dimension) = (Vec::new(), HashMap::new());
    let count: u64 = cursor.number(NumberType::U64, "the number of names")?;
    cursor.line()?;
    for _ in 0..count {
        let line = cursor.text_line("a dimension, a number and a name")?;
        // Some writers leave the quotes out.
        let second = || {
            let after = |text: &str| text.split_once(char::is_whitespace).map(|words| words.1.len());
            let rest = after(&line)?;
            after(&line[line.len() - rest..]).map(|name| line.len() - name)
        };
        let (numbers, name) = line.split_at(line.find('"').or_else(second).unwrap_or(0));
        let name = || name.trim().trim_matches('"').to_owned();
        let numbers: Option<Vec<i64>> = numbers.split_whitespace().map(|word| word.parse().ok()).collect();
        match numbers.as_deref() {
            Some([3, group]) => names.push((*group, name())),
            // Before version 2.1 no dimension stood before the number.
            Some([group]) => {
                *without_dimension.entry(*group).or_insert(0) += 1;
                names.push((*group, name()));
            }
            Some([0..3, _]) => {}
            _ => {
                let error = cursor.error("a physical name is damaged").got(format_args!("'{line}'"));
                return Err(error.expected("a dimension, a number and a name in quotes"));
            }
        }
    }
    names.retain(|own| without_dimension.get(&own.0).is_none_or(|&count| count == 1));
    Ok((names, without_dimension))
}

/// Physical groups of the volumes, the first of each. Points have a box, too, in version 4.0.
fn entities(
    cursor: &mut Cursor,
    [is_partitioned, is_4_0]: [bool; 2],
    groups: &mut HashMap<i64, i64>,
) -> Result<()> {
    let (int, size) = (NumberType::I32, NumberType::U64);
    let ints = |cursor: &mut Cursor| -> Result<Option<i64>> {
        let count: u64 = cursor.number(size, "a number of tags")?;
        let mut first = None;
        for _ in 0..count {
            let tag = cursor.number(int, "a tag")?;
            first = first.or(Some(tag));
        }
        Ok(first)
    };
    if is_partitioned {
        cursor.number::<u64>(size, "the number of partitions")?;
        let ghost_count: u64 = cursor.number(size, "the number of ghost entities")?;
        for _ in 0..ghost_count.saturating_mul(2) {
            cursor.number::<i64>(int, "a ghost entity")?;
        }
    }
    let mut counts = [0_u64; 4];
    for count in &mut counts {
        *count = cursor.number(size, "a number of entities")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag: i64 = cursor.number(int, "the tag of an entity")?;
            if is_partitioned {
                for _ in 0..2 {
                    cursor.number::<i64>(int, "the parent of an entity")?;
                }
                ints(cursor)?;
            }
            for _ in 0..if dimension == 0 && !is_4_0 { 3 } else { 6 } {
                cursor.number::<f64>(NumberType::F64, "a coordinate")?;
            }
            let group = ints(cursor)?;
            if dimension > 0 {
                ints(cursor)?;
            }
            if dimension == 3 {
                // A negative one turns the elements round.
                groups.extend(group.map(|group| (tag, group.saturating_abs())));
            }
        }
    }
    Ok(())
}

/// Names of the physical groups of volumes; none where there are no groups.
fn block_names(groups: &[i64], names: &[(i64, String)]) -> Vec<String> {
    if groups == [0] {
        return Vec::new();
    }
    let name = |group: &i64| match names.iter().find(|name| name.0 == *group) {
        Some((_, name)) => name.clone(),
        None if *group == 0 => "no group".to_owned(),
        None => group.to_string(),
    };
    groups.iter().map(name).collect()
}

fn piece(file: Arc<MeshFile>, node_count: u64, counts: &GroupCounts, arrays: Vec<views::ViewArray>) -> Piece {
    let point_count = if file.is_split { counts.corners } else { node_count };
    let arrays = arrays.into_iter().map(|array| {
        let (association, component_count) = (array.association(), array.component_count());
        let head = FileArray { name: array.name.clone(), association, component_count };
        let of = file.clone();
        PieceArray::computed(&file.source, &head, [point_count, counts.cells], move |_| array.load(&of))
    });
    let of = file.clone();
    let geometry = geometry([point_count, counts.cells, counts.corners], move |_| of.read_geometry());
    let piece = Piece::new([point_count, counts.cells], geometry, arrays.collect());
    let numbers: Compute = Arc::new(move |_| Ok(file.read_volumes()?.block_numbers()));
    piece.with_blocks(CellBlocks::Each { numbers, grid: None })
}
