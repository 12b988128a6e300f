//! Files of formats that come from outside: the table of contents of what their reader says.

use super::added::ExternalFormat;
use super::chosen::SelectedArrays;
use super::numbers::{ByteOrder, NumberType};
use super::piece::{Dataset, Geometry, Piece, PieceArray};
use super::request::{Request, TimeStep};
use super::source::Source;
use super::stored::{Compute, Encoding, Stored};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result};

/// Reads the table of contents.
pub(super) fn open(source: &Arc<Source>, request: &Request, chosen: &SelectedArrays) -> Result<Dataset> {
    let SelectedArrays { reader, parameters } = chosen;
    let at = |step: usize| reader.open(source.path(), step, parameters, &voltet_core::progress::NoProgress);
    let mut open = at(0)?;
    let step = chosen_step(&open.head().times, request.time_step)?;
    if step > 0 {
        open = at(step)?;
    }
    let head = open.head().clone();
    let added = Arc::new(ExternalFormat::new(open));
    let array = |(place, array): (usize, &FileArray)| {
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

/// The step that is asked for, by its number or the nearest to its time; 0 of a file that is no series.
///
/// Errors: the series has none such.
fn chosen_step(times: &[f64], wanted: Option<TimeStep>) -> Result<usize> {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return Ok(0) };
    match wanted {
        None => Ok(0),
        Some(TimeStep::Index(step)) if step < times.len() => Ok(step),
        Some(TimeStep::Index(step)) => Err(Error::run("the series has no such time step")
            .got(step)
            .expected(format!("0 to {}", times.len() - 1))),
        Some(TimeStep::Time(time)) if (*first..=*last).contains(&time) => {
            let distance = |step: &usize| (times[*step] - time).abs();
            let nearest = (0..times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            Ok(nearest.unwrap_or(0))
        }
        Some(TimeStep::Time(time)) => Err(Error::run("the time lies outside the series")
            .got(time)
            .expected(format!("{first} to {last}"))),
    }
}
