//! The node of a grid filter.

use crate::call::{GridTask, Outcome, Task};
use crate::declaration::Family;
use crate::grids::{GridContents, Head};
use crate::host::CallLabel;
use crate::interface::{SAME_CELLS, SAME_POINTS};
use crate::item::{self, PluginItem};
use crate::values::{ParameterValues, array_names, named_arrays};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::sync::Arc;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Association, Cells, Grid, Options, RawGrid, Scalar};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, SharedSlice, counted, grid};
use voltet_graph::{Demand, DemandContext, Node, Outputs, Port, PortType, RunContext, Value};

pub(crate) fn grid_node(item: PluginItem) -> &'static Node {
    let grid = |summary| Port { name: "grid", port_type: PortType::Grid, summary };
    let [inputs, outputs] =
        [grid("points, cells, arrays"), grid("what it makes of them")].map(|port| [port].to_vec().leak());
    let example = item::example_text(
        item.declaration.schema,
        "grid",
        "grid",
        "grid = \"filtered\", volume = \"filtered\"",
    );
    let (run_item, demand_item) = (item.clone(), item.clone());
    item::leaked_node(&item, |node| Node {
        inputs,
        outputs,
        example,
        demand: item::leak(move |context: &mut DemandContext| demand(&demand_item, context)),
        run: item::leak(move |call: &mut RunContext| run(&run_item, call)),
        ..node
    })
}

/// Demands of the input: that of the output without the arrays that the filter makes, and the arrays that its parameters name.
fn demand(item: &PluginItem, context: &mut DemandContext) -> Result<()> {
    let mut demand = Demand { without_scalar: false, ..context.asked.clone() };
    if let Family::GridFilter { made } = item.declaration.family {
        demand.arrays.named.retain(|name| !made.contains(&name.as_str()));
    }
    demand.arrays.named.extend(array_names(&item.declaration, context.parameters));
    context.ask("grid", &demand)
}

fn run(item: &PluginItem, call: &mut RunContext) -> Result<Outputs> {
    let input = call.grid("grid")?;
    let task = Task::Grid(task(item, &input, call)?);
    let (status, Outcome::Grid(head, buffers)) = item.run(task, call.progress())? else {
        return Err(item.unexpected_output());
    };
    let contents = buffers.validate(&head, head.point_count, item.label())?;
    let grid = output_grid(&input, head, contents, call.demand, item.label(), call.progress())?;
    if !Arc::ptr_eq(&grid.origin, &input.origin) {
        call.notes.warnings.extend(grid.origin.warnings.iter().cloned());
    }
    call.notes.warnings.extend(item.label().warnings(&status));
    Ok(vec![Value::Grid(Arc::new(grid))])
}

/// The call of the filter.
///
/// Errors: an array that is not there.
fn task(item: &PluginItem, grid: &Grid, call: &RunContext) -> Result<GridTask> {
    let text = |name: &str| {
        CString::new(name).map_err(|_| Error::run("the name of an array has a character 0").got(name))
    };
    let mut carried = Vec::new();
    if let Some(scalar) = &grid.scalar {
        carried.push((text(&grid.scalar_name)?, Array { component_count: 1, values: scalar.clone() }));
    }
    let has_scalar = !carried.is_empty();
    for (name, array) in
        grid.point_arrays.iter().filter(|(name, _)| !has_scalar || **name != grid.scalar_name)
    {
        carried.push((text(name)?, Array::clone(array)));
    }
    let (points, tetrahedra) = (grid.points.clone(), grid.tetrahedra.clone());
    Ok(GridTask {
        grid: Grid { points, tetrahedra, ..Grid::default() },
        carried,
        has_scalar,
        arrays: named_arrays(&item.declaration, call.parameters, grid)?,
        values: ParameterValues::new(&item.declaration, call.parameters)?,
        memory_left: call.progress().memory_left(),
    })
}

type Arrays = BTreeMap<String, Array>;

/// The grid that the filter gave, with the parts that it shares with its input.
///
/// Errors: a position that is not finite; a demanded array that is not there; a scalar of several components.
fn output_grid(
    input: &Grid,
    head: Head,
    contents: GridContents,
    demand: &Demand,
    label: CallLabel,
    progress: &dyn Progress,
) -> Result<Grid> {
    let [mut at_points, mut on_cells] = [Arrays::new(), Arrays::new()];
    if head.has(SAME_POINTS) {
        at_points.extend(input.point_arrays.iter().map(|(name, array)| (name.clone(), Array::clone(array))));
        let scalar = input.scalar.clone().map(|values| Array { component_count: 1, values });
        at_points.extend(scalar.map(|scalar| (input.scalar_name.clone(), scalar)));
    }
    for (array, values) in head.arrays.iter().zip(contents.arrays) {
        let Some(values) = values else { continue };
        let to = if array.association == Association::Cell { &mut on_cells } else { &mut at_points };
        to.insert(
            array.name.clone(),
            Array { component_count: array.component_count, values: values.into() },
        );
    }
    let missing = |name: &str| {
        let has: Vec<&str> = at_points.keys().chain(on_cells.keys()).map(String::as_str).collect();
        let found = if has.is_empty() { "no arrays".into() } else { has.join(", ") };
        label.error(&format!("did not give the array '{name}', which is asked for")).got(found)
    };
    let named = demand.arrays.named.iter();
    if let Some(name) =
        named.into_iter().find(|name| !at_points.contains_key(*name) && !on_cells.contains_key(*name))
    {
        return Err(missing(name));
    }
    let keeps_cells = head.has(SAME_CELLS);
    if let Some(name) = demand.cell_arrays.named.iter().find(|_| !keeps_cells) {
        let error = label
            .error(&format!("gives other cells, and so not the cell array '{name}', which is asked for"));
        return Err(error.expected("no cell array of the file behind it"));
    }
    let scalar = match head.scalar.or_else(|| input.scalar.is_some().then(|| input.scalar_name.clone())) {
        Some(name) => Some(scalar(name, &at_points, &on_cells, &missing, label)?),
        None => None,
    };
    let points = contents.points.map_or_else(|| input.points.clone(), SharedSlice::from);
    refuse_not_finite(&points, used_points(&contents.cells, input), label)?;
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
    let cells = contents.cells.unwrap_or_else(|| Cells::Tetrahedra(input.tetrahedra.clone()));
    let mut parts = RawGrid::new(points, cells);
    (parts.scalar, parts.point_arrays, parts.cell_arrays) = (scalar, at_points, on_cells);
    grid::build(parts, &Options::default(), progress).map_err(|error| Error {
        what: label.error("gave no grid that can be drawn").what + ": " + &error.what,
        ..error
    })
}

/// The array of that name as the scalar that is drawn.
fn scalar(
    name: String,
    at_points: &Arrays,
    on_cells: &Arrays,
    missing: &dyn Fn(&str) -> Error,
    label: CallLabel,
) -> Result<Scalar> {
    let (array, association) = match (at_points.get(&name), on_cells.get(&name)) {
        (Some(array), _) => (array, Association::Point),
        (None, Some(array)) => (array, Association::Cell),
        (None, None) => return Err(missing(&name)),
    };
    match array.component_count {
        1 => Ok(Scalar { name, association, values: array.values.clone() }),
        n => {
            let error = label.error("names an array as the scalar that is none");
            Err(error.got(format!("'{name}' of {}", counted(n, "component"))).expected("one of 1 component"))
        }
    }
}

fn used_points<'a>(cells: &'a Option<Cells>, input: &'a Grid) -> &'a [u32] {
    match cells {
        Some(Cells::Tetrahedra(cells)) => cells.as_flattened(),
        Some(Cells::Mixed(set)) => &set.connectivity,
        Some(Cells::Structured(_)) => &[],
        None => input.tetrahedra.as_flattened(),
    }
}

/// Errors: a point of a cell without a finite position.
fn refuse_not_finite(points: &[DVec3], used: &[u32], label: CallLabel) -> Result<()> {
    let wrong = |&&point: &&u32| !points[point as usize].is_finite();
    let Some(&point) = used.par_iter().with_min_len(1 << 14).find_first(wrong) else { return Ok(()) };
    let at = points[point as usize];
    let found = format!("({}, {}, {}) of point {point}", at.x, at.y, at.z);
    Err(label.error("gave a cell a position that is not finite").got(found).expected("finite numbers"))
}
