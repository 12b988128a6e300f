//! N point samples: the baseline of Kniss et al. 2003, Figure 1.
//!
//! Samples lie at the middles (i + ½)/N, and each stands for a homogeneous piece with its own absorption,
//! κ h E₁(ρ h): emission without it is wrong by ρl/2N (Roettger & Ertl 2002, Eq. 6).

use super::riemann;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_optics::integrators::{SegmentIntegrator, can_serve};
use voltet_optics::special::{OPAQUE_DEPTH, mean_transmittance, opacity};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment};

/// N point samples.
#[derive(Debug, Clone)]
pub struct Riemann {
    prepared: CompiledTransferFunction,
    count: usize,
}

impl Riemann {
    /// Serves every transfer function; `count` ≥ 1.
    pub fn new(transfer_function: &TransferFunction, count: usize) -> Result<Self> {
        can_serve(&riemann(count), transfer_function)?;
        Ok(Riemann { prepared: CompiledTransferFunction::new(transfer_function)?, count })
    }
}

impl SegmentIntegrator for Riemann {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let step = 1.0 / self.count as f64;
        self.prepared.sampled(segment, |samples| {
            let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
            for i in 0..self.count {
                let sample = samples.at((i as f64 + 0.5) * step);
                let piece = sample.rate * step;
                if depth < OPAQUE_DEPTH {
                    let light = (-depth).exp() * step * mean_transmittance(piece);
                    for (sum, glow) in color.iter_mut().zip(sample.glow) {
                        *sum += light * glow;
                    }
                }
                depth += piece;
            }
            Contribution { optical_depth: depth, color, opacity: opacity(depth) }
        })
    }
}
