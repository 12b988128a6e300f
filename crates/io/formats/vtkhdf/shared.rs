//! Step that is read, and arrays of points and cells: shared by all kinds of grids of VTKHDF.

use crate::formats::contents::{DEGREES, Dataset};
use crate::formats::hdf5::{Array, Group};
use crate::formats::request::Request;
use voltet_core::grid::Association;
use voltet_core::{Error, Result};

pub(super) struct GridStep {
    /// `Steps`; `None` where the grid has none.
    pub group: Option<Group>,
    pub index: usize,
}

impl GridStep {
    /// Notes the times of the first grid that has some as those of the data set.
    pub fn of_grid(group: &Group, request: &Request, dataset: &mut Dataset) -> Result<GridStep> {
        let Some(steps) = group.group("Steps")? else { return Ok(GridStep { group: None, index: 0 }) };
        let times: Vec<f64> = steps.required_array("Values")?.numbers()?;
        dataset.note_times(&times, "blocks").map_err(|error| error.at_item(steps.path()))?;
        Ok(GridStep { index: request.step_index(&times)?, group: Some(steps) })
    }

    /// The number of this step in an array of one a step, or `otherwise`; `path`: of the array.
    pub fn number(&self, path: &[&str], otherwise: u64) -> Result<u64> {
        let (Some(mut group), Some((name, above))) = (self.group.clone(), path.split_last()) else {
            return Ok(otherwise);
        };
        for name in above {
            match group.group(name)? {
                Some(below) => group = below,
                None => return Ok(otherwise),
            }
        }
        let Some(array) = group.array(name)? else { return Ok(otherwise) };
        let numbers: Vec<u64> = array.numbers()?;
        // Of several numbers a step the first is that of the grid's own cells.
        let width = array.shape().get(1).map_or(1, |&width| width as usize);
        let missing =
            || Error::run("the array has no number for the step").got(numbers.len()).at_item(array.path());
        self.index.checked_mul(width).and_then(|place| numbers.get(place)).copied().ok_or_else(missing)
    }
}

/// An array of points or cells, and the name that the assembly of grids knows it by.
pub(super) type GridArray = (Association, Array, String);

/// The arrays of points and cells. Notes which are marked as scalars and as global ids.
pub(super) fn attributes(group: &Group, dataset: &mut Dataset) -> Result<Vec<GridArray>> {
    let mut attributes = Vec::new();
    for (section, association) in [("PointData", Association::Point), ("CellData", Association::Cell)] {
        let Some(section) = group.group(section)? else { continue };
        let marked = |mark: &str| section.text(mark);
        let (scalars, ids) = (marked("Scalars")?, marked("GlobalIds")?);
        for array in section.arrays()? {
            if !array.has_numbers() {
                if !array.is_text() {
                    dataset
                        .warnings
                        .push(format!("The array '{}' is left out: its type is not read.", array.name()));
                }
                continue;
            }
            // Since version 2.6 arrays bear the mark themselves.
            let mark = array.text_attribute("Attribute")?;
            let is_marked = |name: &str, of_section: &Option<String>| {
                mark.as_deref() == Some(name) || of_section.as_deref() == Some(array.name())
            };
            if dataset.active_scalars.is_none() && is_marked("Scalars", &scalars) {
                dataset.active_scalars = Some(array.name().to_owned());
            }
            if association == Association::Point
                && dataset.global_ids.is_none()
                && is_marked("GlobalIds", &ids)
            {
                dataset.global_ids = Some(array.name().to_owned());
            }
            let name = if mark.as_deref() == Some(DEGREES) { DEGREES } else { array.name() }.to_owned();
            attributes.push((association, array, name));
        }
    }
    Ok(attributes)
}

/// Numbers of an array beyond its first axes.
pub(super) fn components(array: &Array, axes: usize) -> Result<usize> {
    let count = array
        .shape()
        .get(axes..)
        .unwrap_or(&[])
        .iter()
        .try_fold(1_usize, |product, &n| product.checked_mul(usize::try_from(n).ok()?));
    count.filter(|&count| count > 0).ok_or_else(|| {
        Error::run("the dataset has the wrong shape")
            .got(format_args!("{:?}", array.shape()))
            .at_item(array.path())
    })
}

/// Numbers from `from` on, `count` of them.
pub(super) fn span(from: u64, count: u64) -> std::ops::Range<u64> {
    from..from.saturating_add(count)
}
