//! Post-processing views: `$NodeData`, `$ElementData` and `$ElementNodeData`, one section a step.

use super::mesh::{MeshFile, each_row};
use crate::formats::cursor::Cursor;
use crate::formats::numbers::NumberType;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

/// Location of the values of a view.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ViewKind {
    Node,
    Element,
    ElementNode,
}

/// The section of one step, and maybe of one partition.
#[derive(Clone)]
pub(super) struct View {
    kind: ViewKind,
    name: String,
    time: f64,
    step: i64,
    component_count: usize,
    count: u64,
    /// The part of the file behind the head.
    start: u64,
    end: u64,
    line: usize,
}

impl View {
    /// The head of a section; `None` where it is none of a view.
    pub fn of_section(section: &str, cursor: &Cursor) -> Result<Option<View>> {
        let kind = match section {
            "NodeData" => ViewKind::Node,
            "ElementData" => ViewKind::Element,
            "ElementNodeData" => ViewKind::ElementNode,
            _ => return Ok(None),
        };
        let mut cursor = cursor.clone();
        let end = cursor.position() + cursor.left();
        let texts = head(&mut cursor)?;
        let reals = numbers::<f64>(&mut cursor)?;
        let integers = numbers::<i64>(&mut cursor)?;
        let wrong = |cursor: &Cursor, found: &[i64]| {
            let error = cursor.error("the head of a view is damaged").got(format_args!("integers {found:?}"));
            error.expected("the step, the number of components (1 to 9) and the number of entities")
        };
        let [step, components, count, ..] = integers[..] else { return Err(wrong(&cursor, &integers)) };
        let component_count = usize::try_from(components).ok().filter(|count| (1..=9).contains(count));
        let component_count = component_count.ok_or_else(|| wrong(&cursor, &integers))?;
        let count = u64::try_from(count).map_err(|_| wrong(&cursor, &integers))?;
        Ok(Some(View {
            kind,
            name: texts.into_iter().next().unwrap_or_else(|| section.to_owned()),
            time: reals.first().copied().unwrap_or(0.0),
            step,
            component_count,
            count,
            start: cursor.position(),
            end,
            line: cursor.line_number(),
        }))
    }

    /// End of the rows of bytes; `None` where they are of different lengths.
    pub fn end_of_rows(&self) -> Option<u64> {
        let width = 4 + 8 * self.component_count as u64;
        let rows = self.count.checked_mul(width).filter(|_| self.kind != ViewKind::ElementNode);
        rows.and_then(|rows| self.start.checked_add(rows))
    }
}

/// Lines of a head after their number, without quotes.
fn head(cursor: &mut Cursor) -> Result<Vec<String>> {
    let line = cursor.text_line("a number of tags")?;
    let wrong = || cursor.error("the head of a view is damaged").got(format_args!("'{line}'"));
    let count: usize = line.parse().map_err(|_| wrong().expected("a number of tags"))?;
    let mut lines = Vec::new();
    for _ in 0..count {
        lines.push(cursor.text_line("a tag of a view")?.trim_matches('"').to_owned());
    }
    Ok(lines)
}

fn numbers<T: std::str::FromStr>(cursor: &mut Cursor) -> Result<Vec<T>> {
    let lines = head(cursor)?;
    let number = |line: &String| {
        let wrong = || cursor.error("the head of a view is damaged").got(format_args!("'{line}'"));
        line.parse().map_err(|_| wrong().expected("a number"))
    };
    lines.iter().map(number).collect()
}

/// Times of the steps of all views, ascending; empty where there is at most one. Views whose steps are all of one time have the numbers
/// of their steps as times.
pub(super) fn times(views: &[View]) -> Vec<f64> {
    let of_steps = has_step_numbers(views);
    let mut times: Vec<f64> = views.iter().map(|view| view.time_of(of_steps)).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    if times.len() > 1 { times } else { Vec::new() }
}

fn has_step_numbers(views: &[View]) -> bool {
    views.iter().all(|view| view.time == views[0].time)
}

impl View {
    fn time_of(&self, step_number: bool) -> f64 {
        if step_number { self.step as f64 } else { self.time }
    }
}

/// The sections of a view at one time.
pub(super) struct ViewArray {
    pub name: String,
    parts: Vec<View>,
}

/// The arrays at a time. A view of one step is there at every time.
pub(super) fn arrays(views: Vec<View>, time: Option<f64>) -> Vec<ViewArray> {
    let of_steps = has_step_numbers(&views);
    let mut groups: Vec<ViewArray> = Vec::new();
    for view in views {
        let is_same = |group: &&mut ViewArray| group.name == view.name && group.parts[0].kind == view.kind;
        match groups.iter_mut().find(is_same) {
            Some(group) => group.parts.push(view),
            None => groups.push(ViewArray { name: view.name.clone(), parts: vec![view] }),
        }
    }
    for group in &mut groups {
        let first = group.parts[0].time_of(of_steps);
        if group.parts.iter().any(|part| part.time_of(of_steps) != first) {
            group.parts.retain(|part| Some(part.time_of(of_steps)) == time);
        }
    }
    groups.retain(|group| !group.parts.is_empty());
    groups
}

impl ViewArray {
    /// True if each cell has values of its own at its nodes.
    pub fn is_by_corner(&self) -> bool {
        self.parts[0].kind == ViewKind::ElementNode
    }

    /// Location of the array that it becomes.
    pub fn association(&self) -> Association {
        if self.parts[0].kind == ViewKind::Element { Association::Cell } else { Association::Point }
    }

    pub fn component_count(&self) -> usize {
        self.parts[0].component_count
    }

    /// Values of all points or selected cells; not a number where the view has none.
    pub fn load(&self, file: &MeshFile) -> Result<Vec<f64>> {
        match self.parts[0].kind {
            ViewKind::Element => self.by_tags(file, 1),
            ViewKind::Node => {
                let values = self.by_tags(file, 0)?;
                if !file.is_split {
                    return Ok(values);
                }
                let n = self.component_count();
                let nodes = file.read_volumes()?.connectivity;
                Ok(nodes.iter().flat_map(|&node| values[node as usize * n..][..n].iter().copied()).collect())
            }
            ViewKind::ElementNode => self.by_corners(file),
        }
    }

    /// Calls `visit` with the tag and the values of each entity.
    fn each(&self, file: &MeshFile, mut visit: impl FnMut(u64, &[f64]) -> Result<()>) -> Result<()> {
        let n = self.component_count();
        for part in &self.parts {
            let mut cursor = Cursor::within(&file.source, part.start, part.end, part.line);
            cursor.binary = file.binary;
            if part.component_count != n {
                let error = cursor.error(format!("the view '{}' changes its components", self.name));
                return Err(error.got(part.component_count).expected(n));
            }
            if !self.is_by_corner() {
                each_row(&mut cursor, part.count, n, &mut visit)?;
                continue;
            }
            for _ in 0..part.count {
                let tag = cursor.number(NumberType::I32, "the tag of an element")?;
                let corners: u64 = cursor.number(NumberType::I32, "a number of nodes")?;
                let values: Vec<f64> =
                    cursor.numbers(NumberType::F64, corners.saturating_mul(n as u64), "a value")?;
                visit(tag, &values)?;
            }
        }
        Ok(())
    }

    /// Values of nodes (0) or selected elements (1).
    fn by_tags(&self, file: &MeshFile, kind: usize) -> Result<Vec<f64>> {
        let (n, tags) = (self.component_count(), file.tags(kind)?);
        let mut all = vec![f64::NAN; tags.len() * n];
        self.each(file, |tag, values| {
            match tags.find(tag) {
                Some(number) => all[number * n..][..n].copy_from_slice(values),
                None if kind == 0 => {
                    let error = Error::run("a view has a value at a node that does not exist");
                    return Err(error.got(tag).expected("the tag of a node"));
                }
                // A surface, or an element of another block.
                None => {}
            }
            Ok(())
        })?;
        Ok(all)
    }

    /// Values of the nodes of each cell: for points of each its own, or their means at the nodes.
    fn by_corners(&self, file: &MeshFile) -> Result<Vec<f64>> {
        let n = self.component_count();
        let volumes = file.read_volumes()?;
        let tags: Arc<_> = file.tags(1)?;
        let mut corners = vec![f64::NAN; volumes.connectivity.len() * n];
        let mut has_values = vec![false; volumes.connectivity.len()];
        self.each(file, |tag, values| {
            let Some(cell) = tags.find(tag) else { return Ok(()) };
            let (order, first) = volumes.corners(cell);
            for (i, &place) in order.iter().enumerate() {
                let Some(own) = values.get(usize::from(place) * n..).and_then(|rest| rest.get(..n)) else {
                    let error = Error::run(format!("a view has too few values in element {tag}"));
                    return Err(error.got(values.len() / n).expected(order.len()));
                };
                corners[(first + i) * n..][..n].copy_from_slice(own);
                has_values[first + i] = true;
            }
            Ok(())
        })?;
        if file.is_split {
            return Ok(corners);
        }
        let node_count = file.tags(0)?.len();
        let (mut sums, mut counts) = (vec![0.0; node_count * n], vec![0.0; node_count]);
        // Cells without values have no part in the means.
        let given = volumes.connectivity.iter().zip(corners.chunks(n)).zip(has_values);
        for ((&node, values), _) in given.filter(|corner| corner.1) {
            let node = node as usize;
            counts[node] += 1.0;
            sums[node * n..][..n].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        sums.chunks_mut(n).zip(counts).for_each(|(sum, count)| sum.iter_mut().for_each(|sum| *sum /= count));
        Ok(sums)
    }
}
