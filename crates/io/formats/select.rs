//! Arrays that a request selects.

use super::contents::{Dataset, Piece};
use super::request::Association;
use std::collections::BTreeSet;
use voltet_core::parameters::edit_distance;
use voltet_core::{Error, Result};

/// Arrays with these names flag ghosts and are not offered as quantities.
pub(super) const GHOST_TYPE: &str = "vtkGhostType";
/// The flag's older form: the number of layers from the piece's own cells.
pub(super) const GHOST_LEVELS: &str = "vtkGhostLevels";

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
    /// Parses the suffix of `NAME:suffix` for an array of so many components.
    pub fn parse(name: &str, suffix: &str, component_count: usize) -> Result<Component> {
        match suffix.parse::<usize>() {
            _ if suffix == "magnitude" => Ok(Component::Magnitude),
            Ok(index) if index < component_count => Ok(Component::Index(index)),
            _ => Err(Error::run(format!("the array '{name}' has no such component"))
                .got(format_args!("'{suffix}'"))
                .expected(format_args!("'magnitude' or 0 to {}", component_count - 1))),
        }
    }
}

/// An array that a request means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ArraySelection {
    pub name: String,
    pub per_cell: bool,
    pub component_count: usize,
    pub component: Component,
}

/// The piece whose arrays stand for all pieces': the first that holds cells.
pub(super) fn model(dataset: &Dataset) -> Result<&Piece> {
    dataset.pieces.iter().find(|piece| piece.cell_count > 0 && piece.point_count > 0).ok_or_else(|| {
        Error::run("the file holds no cells").expected("a grid with at least one three-dimensional cell")
    })
}

/// Names of the arrays that are quantities, points' first.
fn names(piece: &Piece, association: Association) -> Vec<(&str, bool)> {
    [false, true]
        .into_iter()
        .filter(|&per_cell| match association {
            Association::Auto => true,
            Association::Point => !per_cell,
            Association::Cell => per_cell,
        })
        .flat_map(|per_cell| piece.arrays_of(per_cell))
        .map(|array| (array.stored.name.as_str(), array.per_cell))
        .filter(|(name, _)| ![GHOST_TYPE, GHOST_LEVELS].contains(name))
        .collect()
}

/// The scalar of a request: what `wanted` names, or the array that is the obvious one.
pub(super) fn scalar(
    dataset: &Dataset,
    wanted: Option<&str>,
    association: Association,
) -> Result<ArraySelection> {
    let piece = model(dataset)?;
    let all = names(piece, association);
    if all.is_empty() {
        let (found, accepted) = match association {
            Association::Auto => ("no arrays", "an array with one value a point or cell"),
            Association::Point => ("no point arrays", "an array with one value a point"),
            Association::Cell => ("no cell arrays", "an array with one value a cell"),
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
    let choice = array(piece, name, association)?;
    if choice.component == Component::All && choice.component_count > 1 {
        return Err(Error::run(format!("the array '{}' is not a scalar", choice.name))
            .got(format_args!("{} components", choice.component_count))
            .expected(format_args!(
                "'{0}:magnitude', or '{0}:0' to '{0}:{1}' for a component",
                choice.name,
                choice.component_count - 1
            )));
    }
    Ok(choice)
}

/// The array that `wanted` (`NAME`, `NAME:magnitude` or `NAME:0`) means.
pub(super) fn array(piece: &Piece, wanted: &str, association: Association) -> Result<ArraySelection> {
    let all = names(piece, association);
    let find = |name: &str| all.iter().find(|entry| entry.0 == name).copied();
    let (name, per_cell, suffix) = match (find(wanted), wanted.rsplit_once(':')) {
        (Some((name, per_cell)), _) => (name, per_cell, None),
        (None, Some((stem, suffix))) if let Some((name, per_cell)) = find(stem) => {
            (name, per_cell, Some(suffix))
        }
        _ => return Err(unknown(piece, wanted, association, &all)),
    };
    let mut same = piece.arrays_of(per_cell).filter(|array| array.stored.name == name);
    let component_count = same.next().map_or(1, |array| array.stored.component_count);
    if same.next().is_some() {
        return Err(Error::run(format!("the file holds several arrays of the name '{name}'"))
            .expected("one array of each name"));
    }
    let component = match suffix {
        None => Component::All,
        Some(suffix) => Component::parse(name, suffix, component_count)?,
    };
    Ok(ArraySelection { name: name.to_owned(), per_cell, component_count, component })
}

/// The error about a name that is not in the file.
fn unknown(piece: &Piece, wanted: &str, association: Association, all: &[(&str, bool)]) -> Error {
    let stem = wanted.rsplit_once(':').map_or(wanted, |(stem, _)| stem);
    let elsewhere =
        names(piece, Association::Auto).into_iter().find(|&(name, _)| name == wanted || name == stem);
    let error = match (association, elsewhere) {
        (Association::Point, Some(_)) => {
            Error::run(format!("'{stem}' is an array of the cells, not of the points"))
        }
        (Association::Cell, Some(_)) => {
            Error::run(format!("'{stem}' is an array of the points, not of the cells"))
        }
        _ => Error::run(format!("the file holds no array '{wanted}'")),
    };
    if all.is_empty() {
        return error.got("no arrays");
    }
    let mut names: Vec<&str> = all.iter().map(|entry| entry.0).collect();
    names.sort_by_cached_key(|name| edit_distance(name, stem));
    error.expected(list(names))
}

/// Names in quotes, each once, shortened where there are many.
fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const SHOWN: usize = 12;
    let mut seen = BTreeSet::new();
    let names: Vec<&str> = names.into_iter().filter(|name| seen.insert(*name)).collect();
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("'{name}'")).collect();
    match names.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}
