//! The grid that a grid filter makes: what it gave, and what it shares with its input.

use crate::grids::{Head, Made};
use crate::interface::{SAME_CELLS, SAME_POINTS};
use crate::outcome::Whose;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::glam::DVec3;
use voltet_core::grid::{self, Array, Association, Cells, Grid, Options, RawGrid, Scalar};
use voltet_core::progress::Progress;
use voltet_core::{Result, SharedSlice};
use voltet_graph::Demand;

/// Arrays by name.
type Arrays = BTreeMap<String, Array>;

/// Errors: a position that is not finite; an array that somebody asks for is not there; the scalar is none.
pub(crate) fn resulting(
    input: &Grid,
    head: Head,
    made: Made,
    asked: &Demand,
    whose: Whose,
    progress: &dyn Progress,
) -> Result<Grid> {
    let [mut at_points, mut on_cells] = [Arrays::new(), Arrays::new()];
    if head.is(SAME_POINTS) {
        at_points.extend(input.point_arrays.iter().map(|(name, array)| (name.clone(), Array::clone(array))));
        let scalar = input.scalar.clone().map(|values| Array { component_count: 1, values });
        at_points.extend(scalar.map(|scalar| (input.scalar_name.clone(), scalar)));
    }
    for (array, values) in head.arrays.iter().zip(made.arrays) {
        let Some(values) = values else { continue };
        let to = if array.on_cells { &mut on_cells } else { &mut at_points };
        to.insert(
            array.name.clone(),
            Array { component_count: array.component_count, values: values.into() },
        );
    }
    let missing = |name: &str| {
        let has: Vec<&str> = at_points.keys().chain(on_cells.keys()).map(String::as_str).collect();
        let found = if has.is_empty() { "no arrays".into() } else { has.join(", ") };
        whose.error(&format!("did not give the array '{name}', which is asked for")).got(found)
    };
    let named = asked.arrays.named();
    if let Some(name) =
        named.into_iter().find(|name| !at_points.contains_key(*name) && !on_cells.contains_key(*name))
    {
        return Err(missing(name));
    }
    let keeps_cells = head.is(SAME_CELLS);
    if let Some(name) = asked.cell_arrays.named().find(|_| !keeps_cells) {
        let error = whose
            .error(&format!("gives other cells, and so not the cell array '{name}', which is asked for"));
        return Err(error.expected("no cell array of the file behind it"));
    }
    let scalar = match head.scalar.or_else(|| input.scalar.is_some().then(|| input.scalar_name.clone())) {
        Some(name) => Some(scalar(name, &at_points, &on_cells, &missing, whose)?),
        None => None,
    };
    let points = made.points.map_or_else(|| input.points.clone(), SharedSlice::from);
    refuse_not_finite(&points, made_cells(&made.cells, input), whose)?;
    let is_finite = |array: &Array| array.values.par_iter().with_min_len(1 << 14).all(|x| x.is_finite());
    if keeps_cells && on_cells.is_empty() && at_points.values().all(is_finite) {
        let same_points = points.is(&input.points);
        let scalar = scalar.map(|scalar| (scalar.name, scalar.values));
        let (scalar_name, scalar) =
            scalar.map_or_else(Default::default, |(name, values)| (name, Some(values)));
        return Ok(Grid {
            points,
            scalar,
            scalar_name,
            point_arrays: at_points.into_iter().map(|(name, array)| (name, Arc::new(array))).collect(),
            file_cells: input.file_cells.clone().filter(|_| same_points),
            ..input.clone()
        });
    }
    let cells = made.cells.unwrap_or_else(|| Cells::Tetrahedra(input.tetrahedra.to_vec()));
    let mut parts = RawGrid::new(points, cells);
    (parts.scalar, parts.point_arrays, parts.cell_arrays) = (scalar, at_points, on_cells);
    grid::build(parts, &Options::default(), progress).map_err(|error| voltet_core::Error {
        what: whose.error("gave no grid that can be drawn").what + ": " + &error.what,
        ..error
    })
}

/// The scalar of that name.
fn scalar(
    name: String,
    at_points: &Arrays,
    on_cells: &Arrays,
    missing: &dyn Fn(&str) -> voltet_core::Error,
    whose: Whose,
) -> Result<Scalar> {
    let (array, association) = match (at_points.get(&name), on_cells.get(&name)) {
        (Some(array), _) => (array, Association::Point),
        (None, Some(array)) => (array, Association::Cell),
        (None, None) => return Err(missing(&name)),
    };
    match array.component_count {
        1 => Ok(Scalar { name, association, values: array.values.clone() }),
        n => {
            let error = whose.error("names an array as the scalar that is none");
            Err(error.got(format!("'{name}' of {n} components")).expected("one of 1 component"))
        }
    }
}

/// The numbers of the points that cells use.
fn made_cells<'a>(made: &'a Option<Cells>, input: &'a Grid) -> &'a [u32] {
    match made {
        Some(Cells::Tetrahedra(own)) => own.as_flattened(),
        Some(Cells::Mixed(set)) => &set.connectivity,
        Some(Cells::Structured(_)) => &[],
        None => input.tetrahedra.as_flattened(),
    }
}

/// Errors: a point of a cell has no position.
fn refuse_not_finite(points: &[DVec3], used: &[u32], whose: Whose) -> Result<()> {
    let wrong = |&&point: &&u32| !points[point as usize].is_finite();
    let Some(&point) = used.par_iter().with_min_len(1 << 14).find_first(wrong) else { return Ok(()) };
    let at = points[point as usize];
    let found = format!("({}, {}, {}) of point {point}", at.x, at.y, at.z);
    Err(whose.error("gave a cell a position that is not finite").got(found).expected("finite numbers"))
}
