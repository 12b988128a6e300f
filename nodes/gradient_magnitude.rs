//! `gradient-magnitude`: the gradient of the scalar at the points, where somebody looks at it.

use crate::drawing::gradient_mask;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{Gradient, magnitude};
use voltet_core::grid::Grid;
use voltet_core::volume::Volume;
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Diagnostics, Node, Outputs, Parameter, ParameterType, Port,
    PortType, RunContext, SavedWork, Value,
};

/// The declaration.
pub const NODE: Node = Node {
    name: "gradient-magnitude",
    summary: "Computes the gradient of the scalar and its length, by a filter of your choice.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with its scalar" }],
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the grid with its gradient" }],
    parameters: &[Parameter {
        name: "method",
        parameter_type: ParameterType::GradientFilter,
        unit: "",
        default: DefaultValue::Text("least-squares"),
        help: "the filter; its own parameters stand beside this one",
    }],
    example: include_str!("examples/stages.toml"),
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let asked = asking.asked;
    let (arrays, cell_arrays) = (asked.arrays.clone(), asked.cell_arrays.clone());
    let file_cells = asked.file_cells;
    let mut demand = Demand { arrays, cell_arrays, file_cells, ..Demand::default() };
    record_unneeded(asking.notes, asked, None);
    if asked.gradient_magnitude || asked.gradient {
        demand.arrays.extend(asking.method()?.arrays()?);
    }
    asking.ask("grid", &demand)
}

/// Records the part of the gradient that nothing needs; with its memory, where the number of points is known.
fn record_unneeded(notes: &mut Diagnostics, asked: &Demand, point_count: Option<usize>) {
    let (what, why, numbers) = match (asked.gradient_magnitude, asked.gradient) {
        (false, false) => ("gradient", "no widget looks at the gradient magnitude and nothing is lit", 4),
        (true, false) => ("gradient vectors", "nothing is lit and there is no silhouette", 3),
        (false, true) => ("gradient magnitude", "no widget looks at it", 1),
        (true, true) => return,
    };
    notes.record_skipped(what, why, point_count.map(|points| SavedWork::Bytes(8 * numbers * points as u64)));
}

/// Gradient at the points that are needed; elsewhere that of one of these points.
fn gradient(call: &mut RunContext, grid: &Grid, s: &[f64]) -> Result<Gradient> {
    let points = match &call.demand.gradient_for {
        Some(looks) if !call.exhaustive() => gradient_mask::points(grid, s, looks)?,
        _ => None,
    };
    if let Some(points) = points
        && let Some(found) = call.method()?.gradient_at(grid, s, &points, call.progress())
    {
        let Gradient { vectors, fallbacks } = found?;
        let left_out = (grid.points.len() - points.len()) as u64;
        let why = "the values of their cells are none that a widget looks for";
        call.notes.record_skipped("gradient at points", why, Some(SavedWork::Points(left_out)));
        let mut all = vec![vectors.first().copied().unwrap_or_default(); grid.points.len()];
        for (&p, vector) in points.iter().zip(vectors) {
            all[p as usize] = vector;
        }
        return Ok(Gradient { vectors: all, fallbacks });
    }
    call.method()?.gradient(grid, s, call.progress())
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let grid = call.grid("grid")?;
    let mut volume = Volume::clone(&*call.volume("grid")?);
    let (wants_magnitude, wants_vectors) = (call.demand.gradient_magnitude, call.demand.gradient);
    record_unneeded(&mut call.notes, call.demand, Some(grid.points.len()));
    call.notes.counts.insert("gradients_computed", u64::from(wants_magnitude || wants_vectors));
    if wants_magnitude || wants_vectors {
        let gradient = gradient(call, &grid, &volume.scalar)?;
        for fallback in &gradient.fallbacks {
            let what = format!("{} at {} points", fallback.what, fallback.point_count);
            call.notes.warnings.push(what);
        }
        let fallbacks = gradient.fallbacks.iter().map(|fallback| fallback.point_count).sum();
        if fallbacks > 0 {
            call.notes.counts.insert("gradient_fallbacks", fallbacks);
        }
        volume.gradient_magnitude = wants_magnitude.then(|| magnitude(&gradient.vectors).into());
        volume.gradient = wants_vectors.then(|| gradient.vectors.into());
    }
    Ok(vec![Value::Volume(Arc::new(volume))])
}
