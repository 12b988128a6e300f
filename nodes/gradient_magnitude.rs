//! `gradient-magnitude`: the gradient of the scalar at the points, where a node downstream uses it.

use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::Result;
use voltet_core::field::{Gradient, magnitude};
use voltet_core::grid::{Grid, extent};
use voltet_core::volume::Volume;
use voltet_cpu::NEGLIGIBLE_DEPTH;
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Diagnostics, Node, Outputs, Parameter, ParameterType, PartWork,
    Port, PortType, RunContext, SavedWork, TransferFunctionSpec, Value,
};

pub const NODE: Node = Node {
    name: "gradient-magnitude",
    summary: "Computes the gradient of the scalar and its length, by a filter of your choice.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with its scalar" }],
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the grid with its gradient" }],
    parameters: &[METHOD],
    example: include_str!("examples/stages.toml"),
    demand: &demand,
    part_work: PartWork::Each,
    run: &run,
    ..Node::BLANK
};

/// The gradient filter.
pub const METHOD: Parameter = Parameter {
    name: "method",
    parameter_type: ParameterType::GradientFilter,
    unit: "",
    default: DefaultValue::Text("least-squares"),
    help: "the filter; its own parameters stand beside this one",
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let asked = asking.asked;
    let (arrays, cell_arrays) = (asked.arrays.clone(), asked.cell_arrays.clone());
    let file_cells = asked.file_cells;
    let mut demand = Demand { arrays, cell_arrays, file_cells, ..Demand::default() };
    record_unneeded(asking.notes, asked, None);
    if asked.gradient_magnitude || asked.gradient {
        demand.arrays.named.extend(asking.method()?.arrays()?);
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
        Some(looks) if !call.exhaustive() => needed_points(grid, s, looks)?,
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
            call.notes.warnings.push(fallback.to_string());
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

/// Smallest grid for which a selection pays: all gradients of smaller ones take less than a millisecond or two.
const MIN_CELLS: usize = 1 << 15;

/// One cell of so many tells: a prime, so that rows of 2ⁿ cells are met at all their places.
const SAMPLED: usize = 61;

/// Share of those cells that may be touched at most: a cell has points that others have too.
const MAX_TOUCHED: f64 = 0.6;

/// Cells of a chunk of work.
const CHUNK: usize = 1 << 13;

/// The points, ascending; `None` where looking for them does not pay: of small grids, and where a sample of cells says that they are
/// most.
///
/// Errors: an extent beyond 64-bit floats.
fn needed_points(grid: &Grid, s: &[f64], looks: &[Arc<TransferFunctionSpec>]) -> Result<Option<Vec<u32>>> {
    if grid.tetrahedra.len() < MIN_CELLS {
        return Ok(None);
    }
    let length = extent::scene_length(extent::bounds(&grid.points))?;
    let of =
        |look: &Arc<TransferFunctionSpec>| look.for_diagonal(length).intervals_of_s(length, NEGLIGIBLE_DEPTH);
    let intervals: Vec<[f64; 2]> = looks.iter().flat_map(of).collect();
    let is_touched = |corners: &[u32; 4]| {
        let values = corners.map(|p| s[p as usize]);
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        intervals.iter().any(|interval| interval[0] <= high && low <= interval[1])
    };
    let sample = grid.tetrahedra.par_iter().step_by(SAMPLED).with_min_len(CHUNK);
    let (asked, touched) = (sample.len(), sample.filter(|corners| is_touched(corners)).count());
    if MAX_TOUCHED * (asked as f64) < touched as f64 {
        return Ok(None);
    }
    let wanted: Vec<AtomicBool> = grid.points.iter().map(|_| AtomicBool::new(false)).collect();
    grid.tetrahedra.par_iter().with_min_len(CHUNK).filter(|corners| is_touched(corners)).for_each(
        |corners| {
            for &p in corners {
                wanted[p as usize].store(true, Ordering::Relaxed);
            }
        },
    );
    let number = |(p, wanted): (usize, AtomicBool)| wanted.into_inner().then_some(p as u32);
    Ok(Some(wanted.into_iter().enumerate().filter_map(number).collect()))
}
