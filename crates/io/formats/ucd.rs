//! AVS UCD (.inp, .ucd) as text: nodes, cells with a material, arrays of nodes and of cells. Materials are blocks.
//!
//! Source: AVS developer's guide, "UCD format"; the order of nodes as in vtkAVSucdReader: a pyramid begins with its apex, prisms and
//! hexahedra with their upper face, which makes no difference to their tetrahedra.

use super::contents::Dataset;
use super::cursor::Cursor;
use super::numbers::{self, NumberType, Target};
use super::request::{Format, Request};
use super::source::Source;
use super::tagged::{TaggedElement, TaggedMesh, VisitElement, VisitNode, VisitValues, dataset};
use super::text::{TextRange, is_space, next_word};
use super::units;
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::{Association, code};
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format =
    Format { files: "AVS UCD (.inp, .ucd) as text", matches, open, has_solution: false };

/// True for names of the format whose first line that is no comment holds five numbers.
fn matches(head: &[u8], path: &Path, _: &Request) -> bool {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let text = String::from_utf8_lossy(head);
    let first = text.lines().find(|line| !line.starts_with('#') && !line.trim().is_empty());
    let is_head = |line: &str| {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        // Long comments hide what follows them, or cut it.
        let is_cut = words.len() < 5 && text.ends_with(line);
        (words.len() == 5 || is_cut) && words.iter().all(|word| word.parse::<u64>().is_ok())
    };
    ["inp", "ucd", "avs"].iter().any(|name| ending == *name) && first.is_none_or(is_head)
}

/// Names of cells, their types, the nodes in VTK's order; no type: no volume.
const CELLS: [(&str, u8, &[usize]); 8] = [
    ("tet", code::TETRA, &[0, 1, 2, 3]),
    ("hex", code::HEXAHEDRON, &[4, 5, 6, 7, 0, 1, 2, 3]),
    ("prism", code::WEDGE, &[3, 4, 5, 0, 1, 2]),
    ("pyr", code::PYRAMID, &[1, 2, 3, 4, 0]),
    ("tri", 0, &[0, 1, 2]),
    ("quad", 0, &[0, 1, 2, 3]),
    ("line", 0, &[0, 1]),
    ("pt", 0, &[0]),
];

/// Rows of values, and the names and numbers of components of the arrays of a row.
type ValueTable = (TextRange, Vec<(String, usize)>);

/// Lines of a file's parts.
struct UcdMesh {
    nodes: TextRange,
    node_count: u64,
    cells: TextRange,
    /// Values at nodes and at cells.
    tables: [Option<ValueTable>; 2],
}

fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let mut cursor = Cursor::new(&source);
    let mut first;
    loop {
        let before = cursor.clone();
        first = cursor.text_line("five counts")?;
        if !first.starts_with('#') && !first.is_empty() {
            cursor = before;
            break;
        }
    }
    let mut counts = [0_u64; 5];
    for count in &mut counts {
        *count = cursor.number(NumberType::U64, "numbers of nodes, cells, and values at them")?;
    }
    let [node_count, cell_count, of_nodes, of_cells, _] = counts;
    cursor.line()?;
    let is_row = |line: &[u8]| !is_blank(line);
    let rows_of = |count: u64, what: &str| format!("{} of {what}", counted(count, "row"));
    let nodes = cursor.skip_rows(node_count, is_row, &rows_of(node_count, "nodes"))?;
    let cells = cursor.skip_rows(cell_count, is_row, &rows_of(cell_count, "cells"))?;
    let (mut tables, mut arrays, mut units) = ([None, None], Vec::new(), Vec::new());
    for (table, (association, width, row_count)) in tables
        .iter_mut()
        .zip([(Association::Point, of_nodes, node_count), (Association::Cell, of_cells, cell_count)])
    {
        if width > 0 {
            let found = array_heads(&mut cursor, association, width)?;
            // A value takes a digit and a space at least.
            if row_count.max(1).saturating_mul(width) > cursor.left() / 2 {
                let error = cursor.error("the rows of values do not fit the file");
                return Err(error.got(format_args!("{row_count} rows of {width} values")));
            }
            let rows = cursor.skip_rows(row_count, is_row, &rows_of(row_count, "values"))?;
            let heads = found.iter().map(|(head, _)| (head.name.clone(), head.component_count));
            *table = Some((rows, heads.collect()));
            let mut columns = 0..width as usize;
            for (head, unit) in found {
                units.push(unit);
                let own = columns.by_ref().take(head.component_count).collect();
                arrays.push((head, own));
            }
        }
    }
    let mesh = UcdMesh { nodes, node_count, cells, tables };
    let mut dataset = dataset(&source, "AVS UCD, ASCII".to_owned(), mesh, arrays, request)?;
    for (array, unit) in dataset.pieces.iter_mut().flat_map(|piece| piece.arrays.iter_mut().zip(&units)) {
        array.unit.clone_from(unit);
    }
    Ok(dataset)
}

/// True for a line without words, which counts for nothing.
fn is_blank(line: &[u8]) -> bool {
    line.iter().all(|&byte| is_space(byte))
}

struct UcdCell {
    tag: u64,
    material: i64,
    code: u8,
    nodes: [u64; 8],
    node_count: usize,
}

struct LineWords<'a>(&'a [u8]);

impl LineWords<'_> {
    fn word(&mut self) -> &[u8] {
        let (word, rest) = next_word(self.0, is_space);
        self.0 = rest;
        word
    }

    fn number<T: Target>(&mut self, number_type: NumberType, what: &str) -> Result<T> {
        numbers::parse(number_type, self.word()).map_err(|error| error.expected(what))
    }

    fn cell(&mut self) -> Result<UcdCell> {
        let tag = self.number(NumberType::U64, "the number of a cell")?;
        let material = self.number(NumberType::I64, "the material of a cell")?;
        let word = self.word();
        let Some((_, code, order)) = CELLS.iter().find(|cell| cell.0.as_bytes() == word) else {
            let found = String::from_utf8_lossy(word);
            let error = Error::run("the type of a cell is not read").got(format_args!("'{found}'"));
            return Err(error.expected("tet, hex, prism, pyr, tri, quad, line or pt"));
        };
        let mut given = [0; 8];
        for node in &mut given[..order.len()] {
            *node = self.number(NumberType::U64, "the number of a node")?;
        }
        let nodes = std::array::from_fn(|place| order.get(place).map_or(0, |&place| given[place]));
        Ok(UcdCell { tag, material, code: *code, nodes, node_count: order.len() })
    }
}

/// Arrays whose components make up rows of this width, with their units.
fn array_heads(
    cursor: &mut Cursor,
    association: Association,
    width: u64,
) -> Result<Vec<(FileArray, Option<String>)>> {
    let mut line = cursor.text_line("numbers of components")?;
    while line.is_empty() {
        line = cursor.text_line("numbers of components")?;
    }
    let words: Vec<u64> = line.split_ascii_whitespace().map_while(|word| word.parse().ok()).collect();
    let sizes = words.get(1..).unwrap_or(&[]);
    let sum = sizes.iter().fold(0_u64, |sum, &size| sum.saturating_add(size));
    if words.first() != Some(&(sizes.len() as u64)) || sum != width || sizes.contains(&0) {
        let error = cursor.error("the numbers of components are damaged").got(format_args!("'{line}'"));
        return Err(error.expected(format_args!("their count, and numbers with the sum {width}")));
    }
    let mut heads = Vec::new();
    for &size in sizes {
        let label = cursor.text_line("the name of an array")?;
        let (name, unit) = label.split_once(',').unwrap_or((&label, ""));
        let name = name.trim().to_owned();
        heads.push((FileArray { name, association, component_count: size as usize }, units::stated(unit)));
    }
    Ok(heads)
}

impl TaggedMesh for UcdMesh {
    fn count_nodes(&self) -> Result<u64> {
        Ok(self.node_count)
    }

    fn each_node(&self, visit: VisitNode) -> Result<()> {
        let parse = |line: &[u8], nodes: &mut Vec<(u64, DVec3)>| {
            if is_blank(line) {
                return Ok(());
            }
            let mut row = LineWords(line);
            let tag = row.number(NumberType::U64, "the number of a node")?;
            let mut position = DVec3::ZERO;
            for axis in 0..3 {
                position[axis] = row.number(NumberType::F64, "a coordinate")?;
            }
            nodes.push((tag, position));
            Ok(())
        };
        self.nodes.rows(parse, |(tag, position)| visit(tag, position))
    }

    fn each_element(&self, visit: VisitElement) -> Result<()> {
        let parse = |line: &[u8], cells: &mut Vec<UcdCell>| {
            if !is_blank(line) {
                cells.push(LineWords(line).cell()?);
            }
            Ok(())
        };
        let (mut material, mut block) = (0, "0".to_owned());
        self.cells.rows(parse, |cell| {
            if cell.material != material {
                (material, block) = (cell.material, cell.material.to_string());
            }
            let (tag, code) = (cell.tag, cell.code);
            match code > 0 {
                true => {
                    visit(&TaggedElement { tag, code, block: &block, nodes: &cell.nodes[..cell.node_count] })
                }
                false => Ok(()),
            }
        })
    }

    fn each_row(&self, of: Association, columns: &[usize], visit: VisitValues) -> Result<()> {
        let Some((rows, arrays)) = &self.tables[usize::from(of == Association::Cell)] else { return Ok(()) };
        // Numbers, values in these columns, and all of a row.
        let parse = |line: &[u8], (tags, values, row): &mut (Vec<u64>, Vec<f64>, Vec<f64>)| {
            if is_blank(line) {
                return Ok(());
            }
            let mut words = LineWords(line);
            tags.push(words.number(NumberType::U64, "the number of a node or cell")?);
            row.clear();
            for (name, component_count) in arrays {
                for _ in 0..*component_count {
                    let value = words.number(NumberType::F64, "a value");
                    row.push(value.map_err(|error| error.at_item(name))?);
                }
            }
            values.extend(columns.iter().map(|&column| row[column]));
            Ok(())
        };
        rows.lines(parse, |(tags, values, _)| {
            tags.iter().zip(values.chunks(columns.len())).try_for_each(|(&tag, row)| visit(tag, row))
        })
    }
}
