//! Arrays of a file that are quantities: which vary, which merely number things, and the one that is drawn where none is named.

use super::inspect::{ArraySummary, Summary};
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;

/// An array, as parameters of a reader name it.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayChoice {
    /// `scalar`: of several components the length.
    pub scalar: String,
    /// `association`: said only where an array of the other one has the name too.
    pub association: Option<Association>,
}

impl ArrayChoice {
    /// The choice of one of a file's arrays.
    pub fn from_head(array: &FileArray, all: &[FileArray]) -> ArrayChoice {
        let shadowed = |other: &FileArray| other.name == array.name && other.association != array.association;
        let is_shadowed = array.association == Association::Cell && all.iter().any(shadowed);
        let magnitude = if array.component_count > 1 { ":magnitude" } else { "" };
        let scalar = format!("{}{magnitude}", array.name);
        ArrayChoice { scalar, association: is_shadowed.then_some(Association::Cell) }
    }

    /// The choice of an array by the name in an option; an array of several components is chosen by its length.
    pub fn by_name(name: &str, all: &[FileArray]) -> ArrayChoice {
        let bare = all.iter().find(|array| array.name == name && array.component_count > 1);
        let as_it_is = || ArrayChoice { scalar: name.into(), association: None };
        bare.map_or_else(as_it_is, |array| ArrayChoice::from_head(array, all))
    }
}

/// Roundings of the largest value within which values are the same: what sums in a solver leave of a constant.
const ROUNDINGS: f64 = 64.0;

/// True if two values differ by more than the rounding of numbers of this relative precision.
pub fn differ(low: f64, high: f64, epsilon: f64) -> bool {
    high - low > ROUNDINGS * epsilon * low.abs().max(high.abs())
}

impl ArraySummary {
    /// True if its values differ by more than rounding.
    pub fn varies(&self) -> bool {
        let epsilon = match self.number_type {
            // Sums are of 64 bits, as a rule, and their result is rounded once.
            "Float32" => f64::from(f32::EPSILON) / 32.0,
            _ => f64::EPSILON,
        };
        self.range.is_some_and(|[low, high]| differ(low, high, epsilon))
    }
}

impl Summary {
    /// The arrays that vary, the one to draw first: quantities before labels; among each the file's own scalar, then scalars of the points,
    /// scalars of the cells, vectors, whole numbers.
    pub fn by_rank(&self) -> Vec<&ArraySummary> {
        let rank = |array: &&ArraySummary| {
            let own = self.active_scalars.as_deref() == Some(array.head.name.as_str());
            let is_whole = !array.number_type.starts_with("Float");
            let is_cell = array.head.association == Association::Cell;
            (is_label(&array.head.name), !own, is_whole, array.head.component_count > 1, is_cell)
        };
        let mut all: Vec<&ArraySummary> = self.quantities().filter(|array| array.varies()).collect();
        all.sort_by_key(rank);
        all
    }

    /// The words by which a reader names one of the arrays.
    pub fn choice_of(&self, array: &ArraySummary) -> ArrayChoice {
        let heads: Vec<FileArray> = self.arrays.iter().map(|array| array.head.clone()).collect();
        ArrayChoice::from_head(&array.head, &heads)
    }

    /// The array that is drawn where none is named: the first [by rank](Self::by_rank). `None` where all values are the same.
    pub fn first_quantity(&self) -> Option<ArrayChoice> {
        self.by_rank().first().map(|first| self.choice_of(first))
    }

    /// The array that a reader of this association, or of either, must name to read the first of them by rank; `None` where it reads
    /// that one unnamed, or all values are the same.
    pub fn to_be_named(&self, association: Option<Association>) -> Option<ArrayChoice> {
        let is_asked = |head: &FileArray| association.is_none_or(|asked| asked == head.association);
        let first = self.by_rank().into_iter().find(|array| is_asked(&array.head))?;
        let read = self.unnamed.as_ref().map(|(name, of)| (name.as_str(), *of));
        (read != Some((&first.head.name, first.head.association))).then(|| self.choice_of(first))
    }
}

/// True if an array of this name holds numbers or marks of things, and no quantity.
fn is_label(name: &str) -> bool {
    const LABELS: &str =
        "id ids flag flags mask ghost ghosttype rank part partition material index block region";
    // As in GlobalNodeId; fluids end in "id", too.
    let stem =
        |word: &str| Some(word.strip_suffix("Id").or(word.strip_suffix("ID"))?.ends_with(char::is_lowercase));
    if name.split(|c: char| !c.is_alphanumeric()).any(|word| stem(word) == Some(true)) {
        return true;
    }
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let mut words = words.map(|word| word.trim_start_matches("vtk"));
    words.any(|word| LABELS.split(' ').any(|label| label == word) || word.ends_with("ids"))
}
