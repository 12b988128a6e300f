//! Values at a time between two steps of a series whose meshes are equal: on a straight line from one to the other.

use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::grid::{Array, Grid};
use voltet_core::{Error, Result, SharedSlice};

/// Two steps around a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepPair {
    pub steps: [usize; 2],
    /// Share of the second, above 0 and below 1.
    pub share: f64,
}

/// The steps around a time; `None` where a step is at that time, or none around it.
pub(crate) fn around(times: &[f64], time: f64) -> Option<StepPair> {
    let between = |pair: &[f64]| pair[0] < time && time < pair[1];
    let first = times.windows(2).position(between)?;
    let [before, after] = [times[first], times[first + 1]];
    Some(StepPair { steps: [first, first + 1], share: (time - before) / (after - before) })
}

/// A grid with values between those of two, of which the second counts `share`. Errors: meshes that differ, arrays that one of them lacks.
pub(crate) fn interpolated(first: Grid, second: &Grid, share: f64) -> Result<Grid> {
    if !is_same_mesh(&first, second) {
        let error =
            Error::usage("the meshes of the steps around the time differ, so that no values lie between");
        return Err(error.expected("between_steps = \"nearest\", or a time_step"));
    }
    let mixed = |a: &[f64], b: &[f64]| -> SharedSlice<f64> {
        // What does not change stays what it is, numbers of materials among it.
        let between = |(a, b): (&f64, &f64)| if a == b { *a } else { a * (1.0 - share) + b * share };
        a.iter().zip(b).map(between).collect::<Vec<f64>>().into()
    };
    let arrays = |of_first: &BTreeMap<String, Arc<Array>>, of_second: &BTreeMap<String, Arc<Array>>| {
        let array = |(name, array): (&String, &Arc<Array>)| {
            let alike = |other: &&Arc<Array>| {
                other.component_count == array.component_count && other.values.len() == array.values.len()
            };
            let Some(other) = of_second.get(name).filter(alike) else {
                let error = Error::run(format!("one of the steps around the time lacks the array '{name}'"));
                return Err(error.expected("an array of the same form in both"));
            };
            let values = mixed(&array.values, &other.values);
            Ok((name.clone(), Arc::new(Array { component_count: array.component_count, values })))
        };
        of_first.iter().map(array).collect::<Result<BTreeMap<_, _>>>()
    };
    if first.scalar.is_some() != second.scalar.is_some() {
        let error = Error::run("one of the steps around the time has no scalar");
        return Err(error.expected("the same scalar in both"));
    }
    let scalar = first.scalar.as_ref().zip(second.scalar.as_ref()).map(|(a, b)| mixed(a, b));
    let point_arrays = arrays(&first.point_arrays, &second.point_arrays)?;
    let cell_arrays = arrays(&first.cell_arrays, &second.cell_arrays)?;
    let mut origin = Arc::unwrap_or_clone(first.origin);
    let new = second.origin.warnings.iter().filter(|warning| !origin.warnings.contains(warning));
    let new: Vec<String> = new.cloned().collect();
    origin.warnings.extend(new);
    Ok(Grid { scalar, point_arrays, cell_arrays, origin: Arc::new(origin), ..first })
}

/// True if both have the same points and cells, the file's own where they keep these.
fn is_same_mesh(one: &Grid, other: &Grid) -> bool {
    one.points == other.points
        && one.tetrahedra == other.tetrahedra
        && one.source_cells == other.source_cells
        && one.hanging == other.hanging
        && one.file_cells == other.file_cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_lies_between_two_steps_or_at_one() {
        let times = [0.0, 1.0, 3.0];
        assert_eq!(around(&times, 2.5), Some(StepPair { steps: [1, 2], share: 0.75 }));
        for time in [0.0, 1.0, 3.0, -1.0, 4.0, f64::NAN] {
            assert_eq!(around(&times, time), None, "{time}");
        }
    }

    #[test]
    fn values_that_do_not_change_keep_their_bits() {
        let grid = |value: f64| Grid {
            cell_arrays: [("material".to_string(), Arc::new(vec![3.0, value].into()))].into(),
            ..Grid::default()
        };
        // 3 × 0.8 + 3 × 0.2 is not 3.
        let between = interpolated(grid(1.0), &grid(2.0), 0.2).unwrap();
        let values = &between.cell_arrays["material"].values;
        assert_eq!((values[0], (values[1] - 1.2).abs() < 1e-15), (3.0, true));
    }

    #[test]
    fn other_meshes_and_missing_arrays_are_refused() {
        let grid = |corner: f64, name: &str| Grid {
            points: vec![glam::DVec3::splat(corner)].into(),
            point_arrays: [(name.to_string(), Arc::new(vec![corner].into()))].into(),
            ..Grid::default()
        };
        let refused = |second: Grid| interpolated(grid(1.0, "p"), &second, 0.5).unwrap_err().to_string();
        assert!(refused(grid(2.0, "p")).contains("meshes"));
        assert!(refused(grid(1.0, "q")).contains("lacks the array 'p'"));
        let cells = Grid { source_cells: Some(Arc::new(vec![1])), ..grid(1.0, "p") };
        assert!(refused(cells).contains("meshes"));
        let scalar = Grid { scalar: Some(vec![1.0].into()), ..grid(1.0, "p") };
        assert!(refused(scalar).contains("no scalar"));
    }
}
