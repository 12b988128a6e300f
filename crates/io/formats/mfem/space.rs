//! Grid functions of MFEM: the finite element space that their head names, and values at its degrees of freedom.
//!
//! Names of spaces as `FiniteElementCollection::New` of MFEM (`fem/fe_coll.cpp`) takes them: `H1_3D_P2` are continuous functions of the
//! second order by their values at nodes, `L2_3D_P0` one value in each element.

use super::elements::MfemElements;
use super::numbering::MfemNodes;
use super::orders::{ContinuousLayout, MAX_ORDER};
use crate::formats::cursor::Cursor;
use crate::formats::numbers::NumberType;
use crate::formats::text::{TextRange, is_space};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use voltet_core::{Error, Result};

/// Spaces that are read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldSpace {
    /// Continuous functions, by their values at points.
    Continuous { order: u32 },
    /// A value in each element.
    Constant,
}

impl FieldSpace {
    /// Order of the nodes at which values are.
    pub fn order(self) -> u32 {
        if let FieldSpace::Continuous { order } = self { order } else { 1 }
    }

    /// The space of a name; `None` for others.
    fn of_name(name: &str) -> Option<FieldSpace> {
        let continuous = |order| Some(FieldSpace::Continuous { order });
        match name {
            "Linear" => return continuous(1),
            "Quadratic" => return continuous(2),
            "Const2D" | "Const3D" => return Some(FieldSpace::Constant),
            _ => {}
        }
        let mut parts = name.split('_');
        let family = parts.next()?;
        let order: u32 = parts.find_map(|part| part.strip_prefix('P'))?.parse().ok()?;
        if order > MAX_ORDER {
            return None;
        }
        // Other bases have other values at nodes, but of the first order at vertices, and none where they are constant.
        match (family, order) {
            _ if name.contains("Trace") => None,
            ("H1", 1..) | ("H1Pos" | "H1Ser", 1) => continuous(order),
            ("H1@G", 1..) => continuous(order),
            (_, 1 | 2) if family.starts_with("H1@") => continuous(order),
            ("L2", 0) => Some(FieldSpace::Constant),
            _ => None,
        }
    }
}

/// A grid function whose head was read.
pub(super) struct GridFunction {
    pub name: String,
    path: PathBuf,
    pub space: FieldSpace,
    pub component_count: usize,
    /// True if the components of a node stand side by side.
    is_interleaved: bool,
    values: TextRange,
}

/// The words before the entries of a head.
const ENTRIES: [&str; 3] = ["FiniteElementCollection:", "VDim:", "Ordering:"];

impl GridFunction {
    /// Reads the head at the cursor; the name of the space where it is not read.
    pub fn open(
        cursor: &mut Cursor,
        name: &str,
        path: &Path,
    ) -> Result<std::result::Result<GridFunction, String>> {
        skip_comments(cursor)?;
        let head = cursor.text_line("FiniteElementSpace")?;
        if head == "QuadratureSpace" {
            return Ok(Err(head));
        }
        let is_newer = head == "MFEM FiniteElementSpace v1.0";
        if !is_newer && head != "FiniteElementSpace" {
            let error = cursor.error("this is no grid function").got(format_args!("'{head}'"));
            return Err(error.expected("FiniteElementSpace"));
        }
        let mut entries = [const { String::new() }; 3];
        for (entry, word) in entries.iter_mut().zip(ENTRIES) {
            let line = cursor.text_line(word)?;
            let value = line.strip_prefix(word).ok_or_else(|| {
                let error = cursor.error("the head of a grid function is damaged");
                error.got(format_args!("'{line}'")).expected(word)
            })?;
            *entry = value.trim().to_owned();
        }
        let [collection, components, ordering] = entries;
        let Some(space) = FieldSpace::of_name(&collection) else { return Ok(Err(collection)) };
        let damaged = |found: &str, accepted: &str| {
            cursor
                .error("the head of a grid function is damaged")
                .got(format_args!("'{found}'"))
                .expected(accepted)
        };
        let component_count = components.parse().ok().filter(|count| (1..=MAX_COMPONENTS).contains(count));
        let component_count =
            component_count.ok_or_else(|| damaged(&components, &format!("VDim: 1 to {MAX_COMPONENTS}")))?;
        let is_interleaved = match ordering.as_str() {
            "0" => false,
            "1" => true,
            _ => return Err(damaged(&ordering, "Ordering: 0 or 1")),
        };
        if is_newer {
            skip_comments(cursor)?;
            let line = cursor.text_line("End: MFEM FiniteElementSpace v1.0")?;
            if !line.starts_with("End:") {
                return Ok(Err(format!("{collection} with {line}")));
            }
        }
        skip_comments(cursor)?;
        // Meshes of the versions 1.2 and 1.3 go on after their nodes.
        let values = cursor.rest();
        let values = match cursor.skip_past(b"mfem_")? {
            Some(end) => values.until(end),
            None => values,
        };
        Ok(Ok(GridFunction {
            name: name.to_owned(),
            path: path.to_owned(),
            space,
            component_count,
            is_interleaved,
            values,
        }))
    }

    /// Tuples at the nodes of a mesh, or in its elements.
    pub fn load(&self, nodes: &MfemNodes, elements: &MfemElements) -> Result<Vec<f64>> {
        self.tuples(nodes, elements).map_err(|error| error.in_file(&self.path))
    }

    fn tuples(&self, nodes: &MfemNodes, elements: &MfemElements) -> Result<Vec<f64>> {
        let mut values: Vec<f64> = Vec::new();
        self.values.numbers(NumberType::F64, is_space, &mut values, |_| Ok(()))?;
        let n = self.component_count;
        let count = values.len() / n;
        let misfit = |accepted: usize| {
            let error =
                Error::run(format!("the values of '{}' do not fit the mesh", self.name)).got(values.len());
            self.values.locate_end(error.expected(accepted.saturating_mul(n)))
        };
        let value = |place: usize, component: usize| match self.is_interleaved {
            true => values[place * n + component],
            false => values[component * count + place],
        };
        let is_in_order = n == 1 || self.is_interleaved;
        let FieldSpace::Continuous { order } = self.space else {
            let element_count = elements.types.len();
            if values.len() != n * element_count {
                return Err(misfit(element_count));
            }
            let tuple = |cell: usize| (0..n).map(move |component| (cell, component));
            return Ok(match is_in_order {
                true => values,
                false => (0..count).flat_map(tuple).map(|(cell, component)| value(cell, component)).collect(),
            });
        };
        let layouts = [false, true].map(|is_bergot| ContinuousLayout::new(nodes, elements, order, is_bergot));
        let layout = layouts.iter().find(|layout| layout.count * n == values.len());
        let layout = layout.ok_or_else(|| misfit(layouts[0].count))?;
        if is_in_order && layout.is_of_nodes() {
            return Ok(values);
        }
        let tuple = |node: usize| (0..n).map(move |component| (node, component));
        let at = |(node, component)| layout.at(node, |place| value(place, component));
        Ok((0..nodes.len()).into_par_iter().flat_map_iter(tuple).map(at).collect())
    }
}

/// Passes over empty lines and comments.
pub(super) fn skip_comments(cursor: &mut Cursor) -> Result<()> {
    while cursor.peek()? == Some(b'#') {
        cursor.line()?;
    }
    Ok(())
}

/// The error about a space that is not read.
pub(super) fn refusal(name: &str, space: &str) -> Error {
    let error = Error::run(format!("the finite element space of {name} is not read")).got(space);
    error.expected(
        "H1, or L2 of the order 0 (by MFEM's ProjectGridFunction, or as .vtu by its ParaViewDataCollection)",
    )
}

/// Components of a field that a file may have.
const MAX_COMPONENTS: usize = 1 << 10;
