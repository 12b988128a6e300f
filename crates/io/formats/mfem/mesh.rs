//! The text of a mesh of MFEM: elements and boundary elements with their attributes, named sets of attributes, and the coordinates of the vertices or,
//! of curved meshes, the grid function of the nodes.

use super::elements::MfemElements;
use super::numbering::MfemNodes;
use super::shapes::SHAPES;
use super::space::GridFunction;
use crate::formats::cursor::Cursor;
use crate::formats::numbers::NumberType;
use crate::formats::source::Source;
use crate::formats::text::{TextRange, is_space};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

/// Name of the grid function of the nodes.
pub(super) const NODES: &str = "the nodes";

/// Bytes that the name of a set may have: each block of the set has it.
const MAX_NAME: usize = 1 << 10;

/// Positions in a mesh.
pub(super) enum Coordinates {
    /// Numbers of each vertex of the file.
    OfVertices { component_count: usize, numbers: TextRange },
    /// Values of a grid function.
    OfNodes(GridFunction),
}

/// A mesh whose elements were read.
pub(super) struct MfemMesh {
    path: PathBuf,
    pub elements: MfemElements,
    pub vertex_count: usize,
    /// Vertices that elements name, ascending, where there are others, which do not count.
    named: Option<Vec<u32>>,
    pub coordinates: Coordinates,
    pub sets: Vec<(String, Vec<i32>)>,
}

impl MfemMesh {
    /// Reads all but the coordinates.
    pub fn open(source: &Arc<Source>) -> Result<MfemMesh> {
        let mut cursor = Cursor::new(source);
        let version = cursor.text_line("MFEM mesh v1.0")?;
        let has_sets = version.ends_with("v1.3");
        keyword(&mut cursor, "dimension")?;
        let dimension: u64 = cursor.number(NumberType::U64, "the dimension of the elements")?;
        keyword(&mut cursor, "elements")?;
        let mut elements = MfemElements::default();
        let element_count = rows(&mut cursor, "elements", |attribute, number, vertices| {
            if SHAPES[number].dimension != dimension {
                let error = Error::run("an element has another dimension than the mesh");
                return Err(error.got(SHAPES[number].dimension).expected(dimension));
            }
            elements.attributes.push(
                i32::try_from(attribute)
                    .map_err(|_| Error::run("the attribute of an element is out of range").got(attribute))?,
            );
            elements.types.push(number as u8);
            elements.vertices.extend_from_slice(vertices);
            Ok(())
        })?;
        if u32::try_from(element_count).is_err() {
            return Err(Error::run("the mesh has too many elements").got(element_count).expected(u32::MAX));
        }
        let mut sets = if has_sets { attribute_sets(&mut cursor, "attribute_sets")? } else { Vec::new() };
        sets.retain(|set| !set.1.is_empty());
        keyword(&mut cursor, "boundary")?;
        let mut of_boundary = Vec::new();
        rows(&mut cursor, "boundary elements", |_, _, vertices| {
            of_boundary.extend_from_slice(vertices);
            Ok(())
        })?;
        if has_sets {
            attribute_sets(&mut cursor, "bdr_attribute_sets")?;
        }
        keyword(&mut cursor, "vertices")?;
        let vertex_count: u64 = cursor.number(NumberType::U64, "the number of vertices")?;
        // Each has a coordinate at least, or a value of the nodes: a digit and a space.
        if vertex_count > cursor.left() / 2 {
            let error = cursor.error("the file ends early").got(counted(cursor.left(), "byte"));
            return Err(error.expected(counted(vertex_count, "vertex")));
        }
        let mut mesh = MfemMesh {
            path: source.path().to_owned(),
            elements,
            vertex_count: vertex_count as usize,
            named: None,
            coordinates: coordinates(&mut cursor, vertex_count, source.path())?,
            sets,
        };
        mesh.leave_out_unnamed(&of_boundary)?;
        Ok(mesh)
    }

    /// Numbers the vertices without those that no element names, of the boundary neither, as MFEM does.
    fn leave_out_unnamed(&mut self, of_boundary: &[u32]) -> Result<()> {
        let mut is_named = vec![false; self.vertex_count];
        for &vertex in self.elements.vertices.iter().chain(of_boundary) {
            *is_named.get_mut(vertex as usize).ok_or_else(|| {
                let error = Error::run("an element names a vertex that does not exist").got(vertex);
                error.expected(format_args!("a number below {}", self.vertex_count))
            })? = true;
        }
        if is_named.iter().all(|&own| own) {
            return Ok(());
        }
        let named: Vec<u32> = (0..self.vertex_count as u32).filter(|&own| is_named[own as usize]).collect();
        let mut numbers = vec![0; self.vertex_count];
        named.iter().zip(0..).for_each(|(&vertex, number)| numbers[vertex as usize] = number);
        self.elements.vertices.iter_mut().for_each(|vertex| *vertex = numbers[*vertex as usize]);
        self.vertex_count = named.len();
        self.named = Some(named);
        Ok(())
    }

    pub fn nodes(&self, order: u32) -> Result<MfemNodes> {
        MfemNodes::new(&self.elements, self.vertex_count, order).map_err(|error| error.in_file(&self.path))
    }

    /// Positions of the vertices by their coordinates in the file.
    pub fn positions(&self, component_count: usize, numbers: &TextRange) -> Result<Vec<DVec3>> {
        let mut values: Vec<f64> = Vec::new();
        let parsed = numbers.numbers(NumberType::F64, is_space, &mut values, |_| Ok(()));
        parsed.map_err(|error| error.in_file(&self.path))?;
        let tuples = values.chunks(component_count);
        Ok(match &self.named {
            None => tuples.map(position).collect(),
            Some(named) => {
                let tuples: Vec<&[f64]> = tuples.collect();
                named.iter().map(|&vertex| position(tuples[vertex as usize])).collect()
            }
        })
    }
}

/// A position by its coordinates, of which those that are not there are 0.
pub(super) fn position(tuple: &[f64]) -> DVec3 {
    let axis = |axis: usize| tuple.get(axis).copied().unwrap_or(0.0);
    DVec3::new(axis(0), axis(1), axis(2))
}

/// Passes over a word that must follow.
fn keyword(cursor: &mut Cursor, word: &str) -> Result<()> {
    cursor.skip_comments()?;
    let found = cursor.word()?.map_or(String::new(), |found| String::from_utf8_lossy(found).into_owned());
    if found == word {
        return Ok(());
    }
    Err(cursor.error("the mesh is damaged").got(format_args!("'{found}'")).expected(format_args!("'{word}'")))
}

/// Hands out the attribute, the number of the type and the vertices of each row that follows; gives their number.
fn rows(
    cursor: &mut Cursor,
    what: &str,
    mut visit: impl FnMut(i64, usize, &[u32]) -> Result<()>,
) -> Result<u64> {
    let count: u64 = cursor.number(NumberType::U64, &format!("the number of {what}"))?;
    let range = cursor.rest();
    let (mut found, mut passed, mut vertices) = (0, 0, Vec::new());
    let mut has_all = count == 0;
    if !has_all {
        has_all =
            range.stream(NumberType::I64, is_space, |shown: &[i64]| {
                let mut at = 0;
                while found < count
                    && let Some(&[attribute, number]) = shown.get(at..at + 2)
                {
                    let number = usize::try_from(number).unwrap_or(usize::MAX);
                    let shape = SHAPES.get(number).ok_or_else(|| {
                        let error = Error::run("the type of an element is not known").got(shown[at + 1]);
                        (at + 1, error.expected(format_args!("0 to {}", SHAPES.len() - 1)))
                    })?;
                    let Some(own) = shown.get(at + 2..at + 2 + shape.vertex_count) else { break };
                    vertices.clear();
                    for (place, &vertex) in (at + 2..).zip(own) {
                        vertices.push(u32::try_from(vertex).map_err(|_| {
                            (place, Error::run("the number of a vertex is damaged").got(vertex))
                        })?);
                    }
                    visit(attribute, number, &vertices).map_err(|error| (at, error))?;
                    found += 1;
                    at += 2 + shape.vertex_count;
                }
                passed += at as u64;
                Ok((found < count).then_some(at))
            })?;
    }
    if !has_all {
        let error = Error::run("the file ends early").got(counted(found, "row"));
        return Err(range.locate_end(error.expected(format_args!("{count} {what}"))));
    }
    cursor.skip_numbers(passed, 1)?;
    Ok(count)
}

fn attribute_sets(cursor: &mut Cursor, word: &str) -> Result<Vec<(String, Vec<i32>)>> {
    keyword(cursor, word)?;
    let count: u64 = cursor.number(NumberType::U64, "the number of sets")?;
    let mut sets = Vec::new();
    for _ in 0..count {
        let name = match cursor.peek()? {
            Some(b'"') => quoted(cursor)?,
            _ => String::from_utf8_lossy(cursor.word()?.unwrap_or_default()).into_owned(),
        };
        if name.len() > MAX_NAME {
            let error = cursor.error("the name of a set is too long");
            return Err(error.expected(format_args!("at most {}", counted(MAX_NAME, "byte"))));
        }
        let length: u64 = cursor.number(NumberType::U64, "the number of attributes of a set")?;
        let mut attributes = Vec::new();
        for _ in 0..length {
            let attribute: i64 = cursor.number(NumberType::I32, "an attribute")?;
            attributes.push(attribute as i32);
        }
        sets.push((name, attributes));
    }
    Ok(sets)
}

/// A text in quotes, in which a backslash stands before quotes and backslashes; the beginning of one that is too long for a name.
fn quoted(cursor: &mut Cursor) -> Result<String> {
    cursor.bytes(1)?;
    let mut text = Vec::new();
    while text.len() <= MAX_NAME {
        text.extend_from_slice(cursor.until(|byte| byte == b'"' || byte == b'\\')?);
        if cursor.bytes(1)? == b"\"" {
            break;
        }
        text.extend_from_slice(cursor.bytes(1)?);
    }
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The coordinates of so many vertices, or the nodes, which are not read yet.
fn coordinates(cursor: &mut Cursor, vertex_count: u64, path: &Path) -> Result<Coordinates> {
    if cursor.peek()? == Some(b'n') {
        keyword(cursor, "nodes")?;
        let nodes = GridFunction::open(cursor, NODES, path)?;
        return match nodes {
            Ok(nodes) if nodes.space.association() == Association::Point => Ok(Coordinates::OfNodes(nodes)),
            Ok(GridFunction { collection: space, .. }) | Err(space) => {
                let error = cursor.locate(Error::run("the finite element space of the nodes is not read"));
                Err(error.got(space).expected("H1 (or the mesh as .vtu by MFEM's ParaViewDataCollection)"))
            }
        };
    }
    let component_count: u64 = cursor.number(NumberType::U64, "the dimension of the space, or nodes")?;
    if !(1..=3).contains(&component_count) {
        let error = cursor.error("the vertices have too many coordinates").got(component_count);
        return Err(error.expected("1 to 3"));
    }
    let start = cursor.clone();
    cursor.skip_numbers(vertex_count * component_count, 1)?;
    let numbers = start.range_to(cursor);
    Ok(Coordinates::OfVertices { component_count: component_count as usize, numbers })
}
