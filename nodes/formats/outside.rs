//! Files of formats that come from outside: the table of contents of what their reader says.

use super::added::Added;
use super::chosen::Chosen;
use super::numbers::{ByteOrder, NumberType};
use super::piece::{Dataset, Geometry, Piece, PieceArray};
use super::request::{Request, TimeStep};
use super::source::Source;
use super::stored::{Compute, Encoding, Stored};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::reading::ArrayOfFile;
use voltet_core::{Error, Result};

/// Reads the table of contents.
pub(super) fn open(source: &Arc<Source>, request: &Request, chosen: &Chosen) -> Result<Dataset> {
    let Chosen { reader, parameters } = chosen;
    let at = |step: usize| reader.open(source.path(), step, parameters, &voltet_core::progress::Silent);
    let step = match request.time_step {
        None => 0,
        Some(TimeStep::Index(step)) => step,
        Some(TimeStep::Time(time)) => nearest(&at(0)?.head().times, time)?,
    };
    let mut open = at(0)?;
    let step_count = open.head().times.len();
    if step >= step_count.max(1) && step_count > 0 {
        return Err(Error::run("the series has no such time step")
            .found(step)
            .accepted(format!("0 to {}", step_count - 1)));
    }
    if step > 0 && step_count > 0 {
        open = at(step)?;
    }
    let head = open.head().clone();
    let added = Arc::new(Added::new(open));
    let array = |(place, array): (usize, &ArrayOfFile)| {
        let (per_cell, of) = (array.association == Association::Cell, added.clone());
        let compute: Compute = Arc::new(move |meter| of.array(place, meter.progress()));
        let stored = Stored {
            source: source.clone(),
            name: array.name.clone(),
            number_type: NumberType::F64,
            order: ByteOrder::Little,
            component_count: array.component_count,
            tuple_count: Some(if per_cell { head.cell_count } else { head.point_count }),
            encoding: Encoding::Computed(compute),
        };
        PieceArray { per_cell, stored }
    };
    let piece = Piece {
        point_count: head.point_count,
        cell_count: head.cell_count,
        arrays: head.arrays.iter().enumerate().map(array).collect(),
        geometry: Geometry::Added(added, source.clone()),
    };
    Ok(Dataset {
        format: head.format,
        pieces: vec![piece],
        time_steps: head.times,
        active_scalars: head.scalar,
        warnings: Vec::new(),
    })
}

/// The step whose time is nearest.
fn nearest(times: &[f64], time: f64) -> Result<usize> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Ok(0) };
    if !(*first..=*last).contains(&time) {
        let error = Error::run("the time lies outside the series").found(time);
        return Err(error.accepted(format!("{first} to {last}")));
    }
    let distance = |step: &usize| (times[*step] - time).abs();
    let steps = 0..times.len();
    Ok(steps.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0))
}
