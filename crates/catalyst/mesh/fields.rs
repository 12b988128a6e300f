//! Fields to arrays of points and cells. Values of 64 bits side by side are borrowed, scalars and interleaved vectors alike; others are
//! copied.

use crate::conduit::{Loan, Node, Numbers};
use std::collections::BTreeSet;
use voltet_core::grid::{Array, RawGrid};
use voltet_core::{Error, Result, SharedSlice, counted};

/// Fields of cells that tell ghosts: VTK's flags, and Ascent's numbers: 0 of real cells, 1 of ghosts, others of cells without a meaning.
const VTK_GHOSTS: &str = "vtkGhostType";
const ASCENT_GHOSTS: &str = "ascent_ghosts";

/// Bit of `vtkGhostType` at a cell of which another domain has the original.
const DUPLICATE: u8 = 1;
/// Bit of `vtkGhostType` at a cell that serves nothing.
const HIDDEN: u8 = 32;

/// Fields that pipelines use. Others are not looked at.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FieldSelection {
    /// Fields that must be there; of `NAME:0` and `NAME:magnitude` the field `NAME`.
    pub named: BTreeSet<String>,
    /// Fields that are taken where they are there.
    pub optional: BTreeSet<String>,
    /// Fields of elements that stay on the cells, beside their means at the points.
    pub cells: BTreeSet<String>,
    /// True if all fields are taken.
    pub is_all: bool,
}

impl FieldSelection {
    /// Adds the fields of another selection.
    pub fn join(&mut self, other: &FieldSelection) {
        self.named.extend(other.named.iter().cloned());
        self.optional.extend(other.optional.iter().cloned());
        self.cells.extend(other.cells.iter().cloned());
        self.is_all |= other.is_all;
    }

    fn contains(&self, field: &str) -> bool {
        let mut names = self.named.iter().chain(&self.optional).chain(&self.cells);
        self.is_all || names.any(|name| is_of(name, field))
    }

    /// A name of which a topology has no field.
    pub(super) fn missing(&self, domain: &Node, topology: &str) -> Result<Option<String>> {
        let names = names(domain, topology)?;
        Ok(self
            .named
            .iter()
            .chain(&self.cells)
            .find(|name| !names.iter().any(|field| is_of(name, field)))
            .cloned())
    }
}

/// True if a name is that of a field, or of a part of it.
fn is_of(name: &str, field: &str) -> bool {
    name == field || name.rsplit_once(':').is_some_and(|(stem, _)| stem == field)
}

/// The fields of a topology, but those that say something of its cells and points.
fn fields<'a>(domain: &Node<'a>, topology: &str) -> Result<Vec<Node<'a>>> {
    let mut own = Vec::new();
    for field in domain.get("fields").map(|fields| fields.children()).unwrap_or_default() {
        // Values of materials are fields, too, without values of their own.
        if field.get("values").is_some() && field.text_at("topology")? == topology {
            own.push(field);
        }
    }
    Ok(own)
}

pub(super) fn names(domain: &Node, topology: &str) -> Result<Vec<String>> {
    Ok(fields(domain, topology)?.iter().map(|field| field.name().to_string()).collect())
}

/// Refuses selected fields of other lengths than a topology's, before its points are made. `counts`: its points and cells.
pub(super) fn check_lengths(
    domain: &Node,
    topology: &str,
    selection: &FieldSelection,
    [points, cells]: [usize; 2],
) -> Result<()> {
    for field in fields(domain, topology)?.iter().filter(|field| selection.contains(field.name())) {
        match field.get("association").map(|node| node.text()).transpose()?.as_deref() {
            Some("vertex") => check_counts(&components(field)?, points, "vertex")?,
            Some("element") => check_counts(&components(field)?, cells, "element")?,
            _ => {}
        }
    }
    Ok(())
}

/// Adds the selected fields of a topology, ghost cells and global numbers of points to a piece.
/// Errors: values that are missing, or of another number than points or cells; a field of an order above the mesh's.
pub(super) fn add(
    piece: &mut RawGrid,
    domain: &Node,
    topology: &str,
    selection: &FieldSelection,
    loan: &Loan,
) -> Result<()> {
    for field in fields(domain, topology)? {
        let attribute = attribute(domain, field.name())?;
        let on_cells = match field.get("association") {
            Some(association) => match association.text()?.as_str() {
                "vertex" => false,
                "element" => true,
                other => {
                    let accepted = "\"vertex\" or \"element\"";
                    return Err(association.wrong("is unknown", format!("\"{other}\""), accepted));
                }
            },
            None if !selection.contains(field.name()) => continue,
            None => {
                let found = if field.get("basis").is_some() { "a basis" } else { "no association" };
                return Err(field.wrong("is no field of vertices or elements", found, "an association"));
            }
        };
        let is_ghosts =
            [VTK_GHOSTS, ASCENT_GHOSTS].contains(&field.name()) || attribute.as_deref() == Some("Ghosts");
        if is_ghosts {
            if on_cells {
                piece.ghost = Some(ghosts(domain, &field, piece.cells.count())?);
            }
            continue;
        }
        if attribute.as_deref() == Some("GlobalIds") && !on_cells {
            let ids = values(&field, 1, piece.points.len(), "vertex")?;
            piece.global_ids = Some(ids[0].to_whole("whole numbers", Some)?);
        }
        if selection.contains(field.name()) {
            let (count, each) = match on_cells {
                true => (piece.cells.count(), "element"),
                false => (piece.points.len(), "vertex"),
            };
            let array = array(&field, count, each, loan)?;
            if on_cells && selection.cells.contains(field.name()) {
                piece.kept_cell_arrays.insert(field.name().into(), array.clone());
            }
            voltet::add_array(piece, field.name(), array, on_cells)?;
        }
    }
    Ok(())
}

/// Meaning of a field for VTK, where the domain states one: `Ghosts`, `GlobalIds`, …
fn attribute(domain: &Node, field: &str) -> Result<Option<String>> {
    metadata(domain, field, "attribute_type").map(|node| node.text()).transpose()
}

/// Note of the domain on a field for VTK, at the place of ParaView 5.13 or at that before.
fn metadata<'a>(domain: &Node<'a>, field: &str, key: &str) -> Option<Node<'a>> {
    ["metadata", "state/metadata"]
        .into_iter()
        .find_map(|place| domain.get(&format!("{place}/vtk_fields/{field}/{key}")))
}

/// Flags of VTK for ghost cells.
fn ghosts(domain: &Node, field: &Node, count: usize) -> Result<Vec<u8>> {
    let numbers = values(field, 1, count, "element")?.remove(0);
    if field.name() == ASCENT_GHOSTS {
        let flag = |number: i64| match number {
            0 => 0,
            1 => DUPLICATE,
            _ => HIDDEN,
        };
        return Ok(whole_values(&numbers)?.into_iter().map(flag).collect());
    }
    let whole = whole_values(&numbers)?;
    let replaced = |key: &str| match metadata(domain, field.name(), key) {
        Some(node) => whole_values(&node.numbers()?),
        None => Ok(Vec::new()),
    };
    let (from, to) = (replaced("values_to_replace")?, replaced("replacement_values")?);
    if from.len() != to.len() {
        let found = format!("{} values and {} replacements", from.len(), to.len());
        return Err(field.wrong("has replacements of another number", found, "one for each value"));
    }
    let flag = |number: i64| from.iter().position(|own| *own == number).map_or(number, |place| to[place]);
    let as_flags = |(place, number): (usize, &i64)| {
        u8::try_from(flag(*number)).map_err(|_| {
            let what = format!("{}/values[{place}] is no vtkGhostType", field.path());
            Error::usage(what).got(number).expected("0 to 255")
        })
    };
    whole.iter().enumerate().map(as_flags).collect()
}

/// Whole numbers, which may be stored as floats.
fn whole_values(numbers: &Numbers) -> Result<Vec<i64>> {
    if numbers.kind.is_whole() {
        return numbers.to_whole("a whole number", Some);
    }
    let each = |(place, value): (usize, f64)| match value.fract() == 0.0 {
        true => Ok(value as i64),
        false => {
            let error = Error::usage(format!("{}[{place}] is no whole number", numbers.path));
            Err(error.got(value).expected("a whole number"))
        }
    };
    numbers.to_f64().into_iter().enumerate().map(each).collect()
}

fn components<'a>(field: &Node<'a>) -> Result<Vec<Numbers<'a>>> {
    let node = field.require("values")?;
    let children = node.children();
    match children.is_empty() {
        true => Ok(vec![node.numbers()?]),
        false => children.iter().map(Node::numbers).collect(),
    }
}

/// Components, of which there must be so many of so many values.
fn values<'a>(field: &Node<'a>, width: usize, count: usize, each: &str) -> Result<Vec<Numbers<'a>>> {
    let components = components(field)?;
    if components.len() != width {
        let found = counted(components.len(), "component");
        return Err(field.wrong("has the wrong number of components", found, width));
    }
    check_counts(&components, count, each)?;
    Ok(components)
}

fn check_counts(components: &[Numbers], count: usize, each: &str) -> Result<()> {
    match components.iter().find(|own| own.count != count) {
        Some(own) => {
            let error = Error::usage(format!("{} has the wrong number of values", own.path));
            Err(error.got(own.count).expected(format!("{count}, one for each {each}")))
        }
        None => Ok(()),
    }
}

pub(super) fn same_lengths(arrays: &[Numbers]) -> Result<()> {
    match arrays.iter().find(|own| own.count != arrays[0].count) {
        Some(own) => {
            let error = Error::usage(format!("{} has another length than {}", own.path, arrays[0].path));
            Err(error.got(own.count).expected(arrays[0].count))
        }
        None => Ok(()),
    }
}

fn array(field: &Node, count: usize, each: &str, loan: &Loan) -> Result<Array> {
    let components = components(field)?;
    check_counts(&components, count, each)?;
    // SAFETY: the loan is held as long as the slice, and ends before the simulation goes on.
    let values = match unsafe { Numbers::lent_tuples(&components) } {
        Some(values) => SharedSlice::from_borrowed(values, loan.clone()),
        None => Numbers::to_tuples(&components).into(),
    };
    Ok(Array { component_count: components.len(), values })
}
