//! The midpoint rule: N samples of a segment, each a piece of constant colour and extinction. In 64 bits, which is all that an integrator
//! must have, and as a kernel for vector lanes, which makes it fast.

use std::any::Any;
use voltet::core::Result;
use voltet::core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};
use voltet::core::transfer::TransferFunction;
use voltet::engine::integrator::{
    FallbackReason, LaneExtension, LaneIntegrator, LaneIntegratorKind, LaneKernel, LaneScene, SampledSegments,
    SegmentBatch, SegmentResults, WidgetSampler,
};
use voltet::lanes::optics::elementary::{exp, mean_transparency};
use voltet::lanes::{Float, Lanes};
use voltet::optics::integrators::{Extent, Integrator, IntegratorKind, SegmentIntegrator};
use voltet::optics::special::{mean_transmittance, opacity};
use voltet::optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

const SAMPLES: &str = "samples";

const PARAMETERS: &[Parameter] = &[Parameter {
    name: SAMPLES,
    parameter_type: ParameterType::Integer(Range::within(1.0, 4096.0)),
    unit: "",
    default: DefaultValue::Integer(8),
    help: "samples of each ray segment",
}];

/// The kind of integrators.
pub struct Midpoint;

impl IntegratorKind for Midpoint {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: "midpoint", summary: "samples in the middles of equal pieces", parameters: PARAMETERS }
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        let compiled = CompiledTransferFunction::new(transfer_function)?;
        Ok(Box::new(Exact { compiled, samples: samples(integrator) }))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&Midpoint)]
    }
}

fn samples(integrator: &Integrator) -> usize {
    integrator.count(SAMPLES).unwrap_or(1)
}

/// The rule in 64 bits.
struct Exact {
    compiled: CompiledTransferFunction,
    samples: usize,
}

impl SegmentIntegrator for Exact {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let step = 1.0 / self.samples as f64;
        self.compiled.sampled(segment, |places| {
            let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
            for i in 0..self.samples {
                let sample = places.at((i as f64 + 0.5) * step);
                let piece = sample.rate * step;
                let light = (-depth).exp() * step * mean_transmittance(piece);
                for (sum, glow) in color.iter_mut().zip(sample.glow) {
                    *sum += light * glow;
                }
                depth += piece;
            }
            Contribution { optical_depth: depth, color, opacity: opacity(depth) }
        })
    }
}

impl LaneIntegratorKind for Midpoint {
    fn prepare(
        &self,
        integrator: &Integrator,
        scene: &LaneScene<'_>,
    ) -> Result<std::result::Result<Box<dyn LaneIntegrator>, FallbackReason>> {
        let sampler = WidgetSampler::new(samples(integrator), false, scene);
        Ok(sampler.map(|sampler| Box::new(Kernel(sampler)) as Box<dyn LaneIntegrator>))
    }
}

/// The rule in lanes.
struct Kernel(WidgetSampler);

impl LaneKernel for Kernel {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let samples = self.0.count();
        self.0.integrate::<L>(batch, samples, #[inline(always)] |segments| walk::<L>(samples, segments), results);
    }
}

/// Colour and optical depth of a vector of segments.
#[inline(always)]
fn walk<L: Lanes>(samples: usize, segments: &mut SampledSegments<'_, '_, L>) -> ([L::F; 3], L::F) {
    let (mut color, mut depth) = ([L::F::splat(0.0); 3], L::F::splat(0.0));
    let step = segments.length() * L::F::splat(1.0 / samples as f32);
    for i in 0..samples {
        let sample = segments.at([(i as f32 + 0.5) / samples as f32], true);
        let piece = sample.rate[0] * step;
        let light = exp::<L>(-depth) * step * mean_transparency::<L>(piece);
        for c in 0..3 {
            color[c] = light.mul_add(sample.glow[0][c], color[c]);
        }
        depth = depth + piece;
    }
    (color, depth)
}
