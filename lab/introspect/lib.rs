//! voltet-introspect: measurements of the engines beyond pictures, which their own traits do not have; segment formulas for the judge.

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]

#[cfg(feature = "gpu")]
mod wgsl;

#[cfg(feature = "gpu")]
pub use wgsl::WgslEvaluator;

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_cpu::introspect::{
    IntegratedSegment, composite_chain, engine_on, integrate_segments, lane_sets, lanes_of, transmittance,
};
#[cfg(feature = "gpu")]
use voltet_gpu::introspect::device_of;
use voltet_judge::{Chain, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator};
use voltet_optics::engine::{AdapterRequest, Engine, EngineInfo};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_simd::LaneSet;

/// Variants of an engine that are judged one by one: the CPU engine on each lane set, others as they are.
///
/// # Errors
///
/// - Those of [`EngineInfo::open`].
pub fn open_variants(engine: &EngineInfo, request: &AdapterRequest) -> Result<Vec<Arc<dyn Engine>>> {
    if *engine == voltet_cpu::ENGINE {
        return Ok(lane_sets().map(engine_on).collect());
    }
    Ok(vec![engine.open(request)?])
}

/// Formulas that the engine integrates segments with; `None` where only its pictures can be judged.
pub fn evaluator(engine: &dyn Engine) -> Option<Box<dyn SegmentEvaluator>> {
    if let Some(lanes) = lanes_of(engine) {
        return Some(Box::new(LaneEvaluator::new(lanes)));
    }
    #[cfg(feature = "gpu")]
    if let Some(device) = device_of(engine) {
        return Some(Box::new(WgslEvaluator::new(device.clone())));
    }
    None
}

/// Drops what a device caches for further scenes, so that the next set-up starts from nothing.
pub fn clear_caches(#[cfg_attr(not(feature = "gpu"), expect(unused))] engine: &dyn Engine) {
    #[cfg(feature = "gpu")]
    if let Some(device) = device_of(engine) {
        device.forget_pipelines();
    }
}

/// CPU engine on one lane set; each segment is a scene of its own.
#[derive(Debug, Clone)]
pub struct LaneEvaluator {
    pub name: String,
    pub lanes: LaneSet,
    /// True if segments are put in order also where one colour needs no order.
    pub ordered: bool,
}

impl LaneEvaluator {
    pub fn new(lanes: LaneSet) -> LaneEvaluator {
        LaneEvaluator { name: format!("32-bit {}", lanes.name()), lanes, ordered: false }
    }

    pub fn all() -> impl Iterator<Item = LaneEvaluator> {
        lane_sets().map(LaneEvaluator::new)
    }

    fn integrate(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<IntegratedSegment> {
        let shading = Shading { integrator: Integrator::ANALYTIC, overlap, silhouette: None, light: None };
        let list = std::slice::from_ref(segment);
        Ok(integrate_segments(self.lanes, transfer_function, &shading, self.ordered, list)?.remove(0))
    }
}

impl SegmentEvaluator for LaneEvaluator {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        Precision::F32
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome> {
        let IntegratedSegment { contribution, fallback } =
            self.integrate(transfer_function, segment, overlap)?;
        Ok(fallback.map_or(EvalOutcome::Served(contribution), |why| EvalOutcome::Wider(contribution, why)))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let row = |c: &Contribution| [c.color[0], c.color[1], c.color[2], c.opacity].map(|x| x as f32);
        let rgba: Vec<[f32; 4]> = segments.iter().map(row).collect();
        let (color, transparency) = composite_chain(self.lanes, &rgba);
        let [r, g, b, opacity] = color.map(f64::from);
        Chain { color: [r, g, b], opacity, transparency }
    }

    /// A constant-emitter whose colour goes from one channel to another along the segment draws F, B and ψ.
    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
        if a.max(b) < f64::from(f32::MIN_POSITIVE) {
            return Ok(EvalOutcome::Skipped("what does not absorb does not glow"));
        }
        let point = |s, extinction, color| ControlPoint { s, color, extinction };
        let points = vec![point(0.0, a, [1.0, 0.0, 1.0]), point(1.0, b, [0.0, 1.0, 1.0])];
        let profile = Profile::PiecewiseLinear { points };
        let widgets = vec![Widget { profile, color: [0.0; 3], extinction: 0.0, region: None }];
        let model = OpticalModel::ConstantEmitter { cutoff: 0.0 };
        let transfer_function =
            TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
        let (front, back) = ([0.0; 2], [1.0, 0.0]);
        let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
        let IntegratedSegment { contribution, fallback } =
            self.integrate(&transfer_function, &segment, WidgetBlend::Exact)?;
        let [front, back, psi] = contribution.color;
        let integrals = PartialIntegrals { psi, front, back, zeta: transmittance(self.lanes, 0.5 * (a + b)) };
        Ok(fallback.map_or(EvalOutcome::Served(integrals), |why| EvalOutcome::Wider(integrals, why)))
    }
}
