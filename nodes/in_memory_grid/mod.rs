//! A grid that a program holds in memory, in place of one that a node reads.

mod host_grid;

use crate::reader::SCALAR;
pub use host_grid::HostGrid;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::grid::{Array, Grid};
use voltet_core::{Error, Result, counted};
use voltet_graph::{
    Node, NodeEntry, NodeOverride, Outputs, ParameterValue, PartWork, Port, PortType, Registry, RunContext,
    Value,
};
use voltet_io::formats::{Component, length};

/// The node that stands where a program gives a grid; such a program adds it to its registry. As a reader it takes the name of
/// the scalar.
pub static NODE: Node = Node {
    name: "given-grid",
    summary: "Gives a grid that the program holds in memory.",
    outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "points, tetrahedra, arrays" }],
    parameters: &[SCALAR],
    // A source has no inputs to ask.
    demand: &|_| Ok(()),
    part_work: PartWork::Each,
    run: &|_| Err(Error::usage("the program has given no grid to this node").expected("a grid to draw")),
    ..Node::BLANK
};

/// The grid of a program, for [`voltet_graph::Graph::give`]. Its scalar is drawn where the node names none, else the point
/// array of that name. Values that are not finite count in the arrays that are requested alone.
pub fn grid(grid: Arc<HostGrid>) -> NodeOverride {
    NodeOverride::new(move |call: &mut RunContext| give(call, &grid))
}

/// The piece of one process of a grid that several hold together; `None`: it holds nothing of it.
pub fn piece(grid: Option<Arc<HostGrid>>) -> NodeOverride {
    let work = move |call: &mut RunContext| grid.as_ref().map_or(Ok(Vec::new()), |grid| give(call, grid));
    NodeOverride::new(work).in_pieces()
}

/// Makes of an entry that reads or makes a grid one that is given it; what it says of the scalar stays.
pub fn stand_in(entry: &mut NodeEntry, registry: &Registry) -> Result<()> {
    let node_type = entry.node_type.text().unwrap_or_default();
    let node = registry.find(node_type)?;
    let gives_grid = matches!(node.outputs, [Port { port_type: PortType::Grid, .. }]);
    if !gives_grid || node.all_inputs().next().is_some() {
        let error = Error::usage(format!("a grid cannot stand in for the node '{}'", entry.name));
        return Err(error.got(format!("type '{node_type}'")).expected("a node that reads or makes a grid"));
    }
    entry.settings.retain(|field| field.name == SCALAR.name);
    entry.node_type.datum = ParameterValue::Text(NODE.name.into());
    Ok(())
}

fn give(call: &mut RunContext, grid: &HostGrid) -> Result<Outputs> {
    let scalar = call.parameters.optional(SCALAR.name).and_then(|setting| setting.text());
    let Some(given) = grid.with_requested(&call.demand.arrays, scalar, call.progress())? else {
        return Ok(Vec::new());
    };
    let mut grid = Grid::clone(&given);
    if let Some(name) = scalar {
        set_scalar(&mut grid, name).map_err(|error| call.parameters.locate(SCALAR.name, error))?;
    }
    let asked = &call.demand.arrays;
    grid.point_arrays.retain(|name, _| asked.contains(name));
    for name in &asked.named {
        let array = point_array(&given, name).map_err(|error| asked.locate(name, error))?;
        grid.point_arrays.insert(name.to_string(), array);
    }
    if let Some(name) =
        call.demand.cell_arrays.named.iter().find(|name| !given.cell_arrays.contains_key(*name))
    {
        let error = missing(name, given.cell_arrays.keys());
        return Err(call.demand.cell_arrays.locate(name, error));
    }
    call.notes.warnings.extend(given.origin.warnings.iter().cloned());
    Ok(vec![Value::Grid(Arc::new(grid))])
}

/// Makes a point array, or a part of one, the scalar of its grid.
///
/// # Errors
/// - those of [`point_array`];
/// - an array of several components.
pub fn set_scalar(grid: &mut Grid, name: &str) -> Result<()> {
    let array = point_array(grid, name)?;
    if array.component_count != 1 {
        let found = format!("'{name}' of {}", counted(array.component_count, "component"));
        let error = Error::usage("the array is not a scalar").got(found);
        return Err(error.expected(format!("'{name}:magnitude', or '{name}:0' for a component")));
    }
    (grid.scalar, grid.scalar_name) = (Some(array.values.clone()), name.to_string());
    Ok(())
}

/// Point array by its name, or a part of one: `NAME`, `NAME:magnitude` or `NAME:0`.
///
/// # Errors
/// - no such array, or no such component.
pub fn point_array(grid: &Grid, name: &str) -> Result<Arc<Array>> {
    if let Some(array) = grid.point_arrays.get(name) {
        return Ok(array.clone());
    }
    let part =
        name.rsplit_once(':').and_then(|(stem, suffix)| Some((stem, suffix, grid.point_arrays.get(stem)?)));
    let Some((stem, suffix, array)) = part else { return Err(missing(name, grid.point_arrays.keys())) };
    let count = array.component_count;
    let tuples = array.values.par_chunks_exact(count);
    let values: Vec<f64> = match Component::parse(stem, suffix, count, &[])? {
        Component::All => return Ok(array.clone()),
        Component::Index(index) => tuples.map(|tuple| tuple[index]).collect(),
        Component::Magnitude => tuples.map(length).collect(),
    };
    Ok(Arc::new(Array { component_count: 1, values: values.into() }))
}

fn missing<'a>(wanted: &str, names: impl Iterator<Item = &'a String>) -> Error {
    let names: Vec<&str> = names.map(String::as_str).collect();
    let error = Error::run(format!("the grid holds no array '{wanted}'"));
    match names.is_empty() {
        true => error.got("no arrays"),
        false => error.not_among(wanted, names),
    }
}
