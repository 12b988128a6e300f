//! Finding of the nodes that draw: bands of the transfer function that are finer than the cells.

use serde_json::json;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::SharedSlice;
use voltet_core::probing::{BandCounts, bands};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_graph::RunContext;

/// Band counts of one transfer function over one volume, kept between runs.
struct VolumeBands {
    scalar: SharedSlice<f64>,
    gradient_magnitude: Option<SharedSlice<f64>>,
    bands: Vec<BandCounts>,
}

impl VolumeBands {
    fn is_of(&self, volume: &Volume) -> bool {
        let same_g = match (&self.gradient_magnitude, &volume.gradient_magnitude) {
            (Some(a), Some(b)) => a.is(b),
            (None, None) => true,
            _ => false,
        };
        self.scalar.is(&volume.scalar) && same_g
    }
}

/// Notes how many bands of each wave widget the cells cross. The transfer function is that at the input
/// `transfer_function`.
pub fn note_bands(
    call: &mut RunContext,
    volume: &Volume,
    transfer_function: &TransferFunction,
) -> Result<()> {
    let make = || {
        let bands = bands(volume, transfer_function)?;
        let (scalar, gradient_magnitude) = (volume.scalar.clone(), volume.gradient_magnitude.clone());
        Ok(VolumeBands { scalar, gradient_magnitude, bands })
    };
    let kept = call.keep(call.revision("transfer_function")?, make)?;
    // One transfer function may draw several volumes.
    let kept = if kept.is_of(volume) { kept } else { Arc::new(make()?) };
    for bands in &kept.bands {
        call.notes.find(sentence(bands), figures(bands));
    }
    Ok(())
}

fn sentence(bands: &BandCounts) -> String {
    let BandCounts { widget, kind, cell_count, median, percent_99, max: most, share_above_one } = bands;
    let finer = match *share_above_one > 0.0 {
        true => format!(
            "{:.2} % cross more than one, where the picture is finer than the grid",
            100.0 * share_above_one
        ),
        false => "none crosses more than one".to_string(),
    };
    format!(
        "bands of widget {widget} ({kind}): of {cell_count} cells half cross at most {median:.3}, 99 % at most \
         {percent_99:.3}, the widest {most:.3}; {finer}"
    )
}

fn figures(bands: &BandCounts) -> serde_json::Value {
    json!({ "bands": {
        "widget": bands.widget,
        "kind": bands.kind,
        "cells": bands.cell_count,
        "median": bands.median,
        "percent_99": bands.percent_99,
        "most": bands.max,
        "share_above_one": bands.share_above_one,
    }})
}
