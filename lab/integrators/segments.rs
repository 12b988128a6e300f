//! N equal pieces: their ends classified, colour and extinction linear in each piece, combined by ψ, F and B.
//!
//! Song et al. 2009, sections 3.3.2 and 5; Moreland & Angel 2004. The integrals come from the two-dimensional
//! [`PartialTable`], or, to judge the table, from the closed forms of module `linear`.

use super::{PartialTable, segments};
use std::any::Any;
use voltet_core::Result;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_optics::integrators::{SegmentIntegrator, can_serve};
use voltet_optics::linear::{emission_weights, front_back};
use voltet_optics::sample::Sample;
use voltet_optics::special::{OPAQUE_DEPTH, opacity};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment};

/// N pieces of linear colour and extinction.
#[derive(Debug, Clone)]
pub struct Segments {
    prepared: CompiledTransferFunction,
    count: usize,
    density: bool,
    /// `None`: closed forms.
    table: Option<PartialTable>,
}

impl Segments {
    /// Serves every transfer function; `count` ≥ 1, `table_size` ≥ 2 entries a side.
    pub fn new(transfer_function: &TransferFunction, count: usize, table_size: usize) -> Result<Self> {
        can_serve(&segments(count, table_size), transfer_function)?;
        let plain = Segments::with_closed_forms(transfer_function, count)?;
        Ok(Segments { table: Some(PartialTable::new(plain.density, table_size)), ..plain })
    }

    /// Integrator without a table: several times slower, and without the table's error.
    pub fn with_closed_forms(transfer_function: &TransferFunction, count: usize) -> Result<Self> {
        can_serve(&segments(count, 2), transfer_function)?;
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        Ok(Segments {
            prepared: CompiledTransferFunction::new(transfer_function)?,
            count,
            density,
            table: None,
        })
    }

    /// Light of a piece of length `step`.
    fn colors(&self, front: &Sample, back: &Sample, step: f64) -> [f64; 3] {
        let (a, b) = (front.rate * step, back.rate * step);
        let (f, k) = match &self.table {
            Some(table) => table.weights(a, b),
            None if self.density => emission_weights(a, b),
            None => front_back(a, b),
        };
        if !self.density {
            return std::array::from_fn(|i| step * (f * front.glow[i] + k * back.glow[i]));
        }
        // The colour of an end is its glow by its rate; an end without stuff takes the other's colour.
        let (c0, c1) = (front.color(back), back.color(front));
        std::array::from_fn(|i| f * c0[i] + k * c1[i])
    }
}

impl SegmentIntegrator for Segments {
    fn table_bytes(&self) -> usize {
        self.table.as_ref().map_or(0, PartialTable::bytes)
    }

    fn table(&self) -> Option<&dyn Any> {
        self.table.as_ref().map(|table| table as &dyn Any)
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let step = 1.0 / self.count as f64;
        self.prepared.sampled(segment, |samples| {
            let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
            let mut front = samples.at(0.0);
            for i in 1..=self.count {
                let back = samples.at(i as f64 * step);
                if depth < OPAQUE_DEPTH {
                    let seen = (-depth).exp();
                    for (sum, c) in color.iter_mut().zip(self.colors(&front, &back, step)) {
                        *sum += seen * c;
                    }
                }
                depth += 0.5 * step * (front.rate + back.rate);
                front = back;
            }
            Contribution { optical_depth: depth, color, opacity: opacity(depth) }
        })
    }
}
