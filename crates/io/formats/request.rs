//! Request to a reader: arrays, time step, conversion of cell values, the reader of a format that comes from outside; and the arrays
//! of a file that it selects.

use super::contents::{BLOCK, Dataset, GHOST_LEVELS, GHOST_TYPE, PieceArray};
use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::error::Remedy;
use voltet_core::grid::{Association, Options};
use voltet_core::parameters::{ArrayOrigin, Parameters, nearest_first};
use voltet_core::reading::GridReader;
use voltet_core::{Error, Result, counted};

/// A step of a time series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeStep {
    /// The step's number in the series, from 0.
    Index(usize),
    /// The step whose time is nearest; must lie within the series.
    Time(f64),
}

/// Request to a reader. [`Request::default`] reads the only array (or the one the file marks as its scalars).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Request {
    /// The scalar: an array's name (`density`), or for arrays of several components `NAME:magnitude` or `NAME:0`.
    /// `None`: the only array of the file, or the one that the file marks as its scalars.
    pub scalar: Option<String>,
    /// True if there is to be no scalar.
    pub without_scalar: bool,
    /// Location of the scalar; `None`: the point array of that name, or, if there is none, the cell array.
    pub association: Option<Association>,
    /// Further arrays, per point (cell arrays are averaged); all components, or one as in `scalar`.
    pub point_arrays: Vec<String>,
    /// Cell arrays that are wanted as they are; all components, or one as in `scalar`.
    pub cell_arrays: Vec<String>,
    /// Nodes that name those of `point_arrays` and of `cell_arrays`, for errors about them.
    pub origins: [BTreeMap<String, ArrayOrigin>; 2],
    /// The blocks that are read, by their names or groups; `*` stands for any letters. None: all.
    pub blocks: Vec<String>,
    /// A vector at points by which they are moved, and a factor: the deformed shape. `None`: they stay.
    pub displacement: Option<(String, f64)>,
    /// The step of a time series (.pvd); `None`: the first.
    pub time_step: Option<TimeStep>,
    /// Options of the import.
    pub options: Options,
    /// The solution of PLOT3D (q) or MFEM (gf) that belongs to the grid file; `None`: the grid's name with the ending `.q` or `.gf`, if
    /// there is such a file.
    pub solution: Option<PathBuf>,
    /// The reader of a format that comes from outside, if the file is of one.
    pub chosen: Option<SelectedArrays>,
    /// Every other array is decoded too, though nobody looks at it: to show what not doing so saves.
    pub every_array: bool,
}

impl Request {
    /// The type of the node that reads such a file.
    pub fn node_type(&self) -> &'static str {
        self.chosen.as_ref().map_or("reader", |chosen| chosen.reader.declaration().name)
    }

    /// Index of the requested step in a series of these times, ascending and at least one.
    ///
    /// Errors: the series has none such.
    pub(super) fn step_index(&self, times: &[f64]) -> Result<usize> {
        let [first, last] = [times[0], times[times.len() - 1]];
        match self.time_step {
            None => Ok(0),
            Some(TimeStep::Index(index)) if index < times.len() => Ok(index),
            Some(TimeStep::Index(index)) => Err(Error::run("the time series has no such step")
                .got(format_args!("step {index}"))
                .expected(up_to(times.len() - 1))),
            Some(TimeStep::Time(time)) => {
                // The span of the series with a margin for times that were rounded when they were written.
                let margin = 1e-6 * (last - first).abs().max(last.abs());
                if !(first - margin..=last + margin).contains(&time) {
                    let error =
                        Error::run("the file has no such time: the time lies outside the series").got(time);
                    return Err(error.expected(format_args!("{first} to {last}")));
                }
                let distance = |step: &usize| (times[*step] - time).abs();
                Ok((0..times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0))
            }
        }
    }
}

/// The reader of a format that comes from outside, with what its parameters are set to.
#[derive(Clone)]
pub struct SelectedArrays {
    /// The reader.
    pub reader: &'static dyn GridReader,
    /// Its parameters, and maybe others.
    pub parameters: Parameters,
}

impl SelectedArrays {
    /// With its standard values, for a file of its format; the first of several. `None` where it is of none of theirs.
    ///
    /// Errors: the file cannot be read; a parameter that must be given.
    pub fn for_file(
        path: &Path,
        mut readers: impl Iterator<Item = &'static dyn GridReader>,
    ) -> Result<Option<SelectedArrays>> {
        let mut head = None;
        let meant = readers.find_map(|reader| {
            // Not opened for nobody.
            let head = head.get_or_insert_with(|| Source::open(path).and_then(|source| source.head(256)));
            match head {
                Ok(head) => reader.matches(head, path).then_some(Ok(reader)),
                Err(error) => Some(Err(error.clone())),
            }
        });
        let Some(reader) = meant.transpose()? else { return Ok(None) };
        let parameters = Parameters::from_values(reader.declaration().parameters, [])?;
        Ok(Some(SelectedArrays { reader, parameters }))
    }
}

impl PartialEq for SelectedArrays {
    fn eq(&self, other: &SelectedArrays) -> bool {
        std::ptr::addr_eq(self.reader, other.reader) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for SelectedArrays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chosen").field("reader", &self.reader.declaration().name).finish_non_exhaustive()
    }
}

pub(super) struct Format {
    /// Name of the format's files in messages.
    pub files: &'static str,
    /// True if a file is one, by its name and how it begins (a byte order mark and white space left out).
    pub matches: fn(head: &[u8], path: &Path, request: &Request) -> bool,
    /// Reads the table of contents.
    pub open: fn(Arc<Source>, &Request) -> Result<Dataset>,
    /// True if a file may come with a second one, [`Request::solution`].
    pub has_solution: bool,
}

/// "0", or "0 to 7".
fn up_to(last: usize) -> String {
    if last == 0 { "0".into() } else { format!("0 to {last}") }
}

/// Component of a tuple.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// All of them.
    All,
    /// One.
    Index(usize),
    /// The length of the tuple as a vector.
    Magnitude,
}

impl Component {
    /// Parses the suffix of `NAME:suffix` for an array of so many components, which may have names. These may be written in other
    /// capitals where only one fits and it has no other meaning.
    pub fn parse(name: &str, suffix: &str, component_count: usize, names: &[String]) -> Result<Component> {
        if let Some(index) = names.iter().position(|name| name == suffix) {
            return Ok(Component::Index(index));
        }
        let mut alike = (0..names.len()).filter(|&index| names[index].eq_ignore_ascii_case(suffix));
        match suffix.parse::<usize>() {
            _ if suffix == "magnitude" => Ok(Component::Magnitude),
            Ok(index) if index < component_count => Ok(Component::Index(index)),
            _ if alike.clone().count() == 1 => Ok(Component::Index(alike.next().unwrap_or_default())),
            _ => {
                let names: String = names.iter().map(|name| format!("'{name}', ")).collect();
                Err(Error::run(format!("the array '{name}' has no such component"))
                    .got(format_args!("'{suffix}'"))
                    .expected(format_args!("{names}'magnitude' or {}", up_to(component_count - 1))))
            }
        }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ArraySelection {
    pub name: String,
    pub association: Association,
    pub component_count: usize,
    pub component: Component,
}

impl ArraySelection {
    /// True if all values of the array are chosen.
    pub fn is_whole(&self) -> bool {
        self.component == Component::All
            || self.component_count == 1 && self.component != Component::Magnitude
    }
}

/// The arrays that stand for all pieces': those of the first that holds cells; where pieces are blocks, of each those that none
/// before it has.
pub(super) fn model(dataset: &Dataset) -> Result<Vec<&PieceArray>> {
    let mut pieces = dataset.pieces.iter().filter(|piece| piece.cell_count > 0 && piece.point_count > 0);
    let first = pieces.next().ok_or_else(|| {
        Error::run("the file holds no cells").expected("a grid with at least one three-dimensional cell")
    })?;
    let key = |array: &PieceArray| (array.stored.name.clone(), array.association == Association::Cell);
    let mut arrays: Vec<&PieceArray> = first.arrays.iter().collect();
    let mut known: BTreeSet<_> = arrays.iter().map(|array| key(array)).collect();
    for piece in pieces.filter(|_| dataset.has_blocks) {
        let further: Vec<&PieceArray> =
            piece.arrays.iter().filter(|array| !known.contains(&key(array))).collect();
        known.extend(further.iter().map(|array| key(array)));
        arrays.extend(further);
    }
    Ok(arrays)
}

/// The arrays of points or of cells among some.
fn arrays_of<'a>(
    arrays: &[&'a PieceArray],
    association: Association,
) -> impl Iterator<Item = &'a PieceArray> {
    arrays.iter().copied().filter(move |array| array.association == association)
}

/// Names of the arrays that are quantities, points' first.
fn names<'a>(model: &[&'a PieceArray], association: Option<Association>) -> Vec<(&'a str, Association)> {
    [Association::Point, Association::Cell]
        .into_iter()
        .filter(|&own| association.is_none_or(|association| own == association))
        .flat_map(|own| arrays_of(model, own))
        .map(|array| (array.stored.name.as_str(), array.association))
        .filter(|(name, _)| ![GHOST_TYPE, GHOST_LEVELS].contains(name))
        .collect()
}

/// The scalar of a request: what `wanted` names, or the array that is the obvious one.
pub(super) fn scalar(
    dataset: &Dataset,
    wanted: Option<&str>,
    association: Option<Association>,
) -> Result<ArraySelection> {
    let model = model(dataset)?;
    let mut all = names(&model, association);
    // The numbers of blocks are no quantity, but can be drawn.
    if wanted.is_none() && !dataset.blocks.is_empty() {
        all.retain(|&entry| entry != (BLOCK, Association::Cell));
    }
    if all.is_empty() {
        let (found, accepted) = match association {
            None => (
                "no arrays",
                "an array with one value a point or cell; a calculator with the expression \"1\" and a boundary show the mesh alone",
            ),
            Some(Association::Point) => ("no point arrays", "an array with one value a point"),
            Some(Association::Cell) => ("no cell arrays", "an array with one value a cell"),
        };
        return Err(Error::run("the file holds no quantity to draw").got(found).expected(accepted));
    }
    let name = match (wanted, &all[..]) {
        (Some(name), _) => name,
        (None, [(only, _)]) => only,
        (None, _) => match dataset.active_scalars.as_deref() {
            Some(active) if all.iter().any(|&(name, _)| name == active) => active,
            _ => {
                return Err(Error::run("the file holds several arrays and the scalar is not named")
                    .expected(format_args!("one of {}", list(all.iter().map(|entry| entry.0)))));
            }
        },
    };
    scalar_of(&model, name, association)
}

/// The array of one component that a name means.
pub(super) fn scalar_of(
    model: &[&PieceArray],
    name: &str,
    association: Option<Association>,
) -> Result<ArraySelection> {
    let choice = array(model, name, association)?;
    if choice.component == Component::All && choice.component_count > 1 {
        return Err(Error::run(format!("the array '{}' is not a scalar", choice.name))
            .got(counted(choice.component_count, "component"))
            .expected(format_args!(
                "'{0}:magnitude', or '{0}:0' to '{0}:{1}' for a component",
                choice.name,
                choice.component_count - 1
            )));
    }
    Ok(choice)
}

/// The vector at points that a name means.
pub(super) fn vector(model: &[&PieceArray], name: &str) -> Result<ArraySelection> {
    let choice = array(model, name, Some(Association::Point))?;
    if (choice.component, choice.component_count) == (Component::All, 3) {
        return Ok(choice);
    }
    let vectors = arrays_of(model, Association::Point).filter(|array| array.stored.component_count == 3);
    let vectors: Vec<&str> = vectors.map(|array| array.stored.name.as_str()).collect();
    let error = Error::run(format!("'{name}' is no vector, by which points could be moved"));
    Err(error.expected(if vectors.is_empty() { "an array of 3 components".into() } else { list(vectors) }))
}

/// The array that `wanted` (`NAME`, `NAME:magnitude` or `NAME:0`) means.
pub(super) fn array(
    model: &[&PieceArray],
    wanted: &str,
    association: Option<Association>,
) -> Result<ArraySelection> {
    let all = names(model, association);
    let find = |name: &str| all.iter().find(|entry| entry.0 == name).copied();
    let whole = find(wanted).map(|(name, own)| (name, own, None));
    let part = || {
        let (stem, suffix) = wanted.rsplit_once(':')?;
        find(stem).map(|(name, own)| (name, own, Some(suffix)))
    };
    let found = whole.or_else(part);
    let (name, own, suffix) = found.ok_or_else(|| unknown(model, wanted, association, &all))?;
    let mut same = arrays_of(model, own).filter(|array| array.stored.name == name);
    let chosen = same.next();
    let component_count = chosen.map_or(1, |array| array.stored.component_count);
    if same.next().is_some() {
        return Err(Error::run(format!("the file holds several arrays of the name '{name}'"))
            .expected("one array of each name"));
    }
    let component = match suffix {
        None => Component::All,
        Some(suffix) => Component::parse(
            name,
            suffix,
            component_count,
            chosen.map_or(&[], |array| &array.component_names),
        )?,
    };
    Ok(ArraySelection { name: name.to_owned(), association: own, component_count, component })
}

/// The error about a name that is not in the file.
fn unknown(
    model: &[&PieceArray],
    wanted: &str,
    association: Option<Association>,
    all: &[(&str, Association)],
) -> Error {
    let stem = wanted.rsplit_once(':').map_or(wanted, |(stem, _)| stem);
    let is_elsewhere = names(model, None).iter().any(|&(name, _)| name == wanted || name == stem);
    let error = Error::run(match association.filter(|_| is_elsewhere) {
        Some(Association::Point) => format!("'{stem}' is an array of the cells, not of the points"),
        Some(Association::Cell) => format!("'{stem}' is an array of the points, not of the cells"),
        None if wanted == BLOCK => "the file has no blocks and no array 'block'".into(),
        None => format!("the file holds no array '{wanted}'"),
    });
    if all.is_empty() {
        return error.got("no arrays");
    }
    let near = nearest_first(stem, all.iter().map(|entry| entry.0));
    error.expected(list(near.iter().copied())).with_remedy(Remedy::names(near))
}

/// Names in quotes, each once, shortened where there are many.
pub fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut seen = BTreeSet::new();
    let each_once = names.into_iter().filter(|name| seen.insert(*name));
    shortened(&each_once.map(|name| format!("'{name}'")).collect::<Vec<_>>())
}

/// Texts in a row, shortened where there are many.
pub fn shortened(texts: &[String]) -> String {
    const SHOWN: usize = 12;
    let shown = texts[..texts.len().min(SHOWN)].join(", ");
    match texts.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_components_may_be_written_in_other_capitals() {
        let names = |all: &str| all.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let of = |suffix: &str, all: &str| Component::parse("Y", suffix, 3, &names(all));
        for (suffix, all, expected) in [
            ("CO", "Co CO N2", Component::Index(1)),
            ("y", "X Y Z", Component::Index(1)),
            ("magnitude", "Magnitude O2 N2", Component::Magnitude),
            ("magnitude", "O2 magnitude N2", Component::Index(1)),
            ("Magnitude", "MAGNITUDE O2 N2", Component::Index(0)),
            ("2", "O2 N2 CO", Component::Index(2)),
        ] {
            assert_eq!(of(suffix, all).unwrap(), expected, "{suffix} of {all}");
        }
        for (suffix, all) in [("co", "Co CO N2"), ("3", "O2 N2 CO"), ("o", "O2 N2 CO")] {
            let error = of(suffix, all).unwrap_err().to_string();
            assert!(error.contains("has no such component"), "{error}");
        }
    }
}
