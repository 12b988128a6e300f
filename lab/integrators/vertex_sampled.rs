//! The transfer function applied at the grid's points alone: what absorbs and what glows there is interpolated linearly, so
//! that anything between two points is missed (Moreland 2004, Figure 1.1a; Shirley and Tuchman 1990 draw like this).
//!
//! Symbols: ρ the extinction, κ the emission per length, each linear along the segment; a = ρ_f D, b = ρ_b D;
//! F = ∫₀¹ (1 − x) e^(−w) dx and B = ∫₀¹ x e^(−w) dx, w the depth in front of x. C = D (F κ_f + B κ_b). κ is interpolated,
//! not a colour, so that a point without matter lends none (Wittenbrink et al. 1998).
//!
//! A segment has no reference to the points of its cell. So a scene is [`classified`] first: ρ and κ become point arrays, which
//! the integrator finds at the segment's ends. Where a segment is all that there is, its ends count as points.

use super::segments::Segments;
use crate::settings::{PreparedKernel, boxed};
use std::any::Any;
use std::sync::Arc;
use voltet_core::grid::{Array, Grid};
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_cpu::integrator::{
    FallbackReason, LaneExtension, LaneIntegratorKind, LaneKernel, LaneScene, SegmentBatch, SegmentResults,
};
use voltet_optics::integrators::{
    Extent, Integrator, IntegratorKind, PreparedScene, ScenePreparation, SegmentIntegrator,
};
use voltet_optics::linear::front_back;
use voltet_optics::special::opacity;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_simd::optics::linear::{DEEPEST, front_back as lane_front_back};
use voltet_simd::{Float, Lanes, Mask, array};

/// The arrays of a classified volume: ρ, then κ by channel; in this order by name.
pub const CLASSIFIED: [&str; 4] =
    ["classified emission 0", "classified emission 1", "classified emission 2", "classified extinction"];

/// The transfer function applied at the grid's points, absorption and emission linear between them.
pub const VERTEX_SAMPLED: Integrator = Integrator::with_settings(&VertexSampledKind, []);

pub(crate) struct VertexSampledKind;

impl IntegratorKind for VertexSampledKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "vertex-sampled",
            summary: "the transfer function applied at the grid's points only, linear between them",
            parameters: &[],
        }
    }

    fn scene_preparation(&self) -> Option<&dyn ScenePreparation> {
        Some(self)
    }

    fn compile(
        &self,
        _: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(VertexSampled::new(transfer_function)?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&VertexSampledKind)]
    }
}

impl LaneIntegratorKind for VertexSampledKind {
    fn prepare(&self, _: &Integrator, scene: &LaneScene<'_>) -> Result<PreparedKernel> {
        Ok(VertexSampledKernel::new(scene).map(boxed))
    }
}

/// Linear between what the transfer function is at the points, in 64 bits.
#[derive(Debug, Clone)]
pub struct VertexSampled {
    /// Indices of the arrays among a segment's fields; `None`: the scene is not classified.
    slots: Option<[usize; 4]>,
    ends: Segments,
}

impl VertexSampled {
    pub fn new(transfer_function: &TransferFunction) -> Result<Self> {
        let fields = transfer_function.fields();
        let slot = |name: &&str| fields.iter().position(|field| field == name);
        let slots: Vec<usize> = CLASSIFIED.iter().filter_map(slot).collect();
        Ok(VertexSampled { slots: slots.try_into().ok(), ends: Segments::new(transfer_function, 1, None)? })
    }
}

impl SegmentIntegrator for VertexSampled {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let Some(slots) = self.slots else { return self.ends.integrate(segment) };
        // Interpolation in 32 bits may leave less than nothing.
        let at = |fields: &[f64]| slots.map(|slot| (fields[slot] * segment.length).max(0.0));
        let (front, back) = (at(segment.fields_front), at(segment.fields_back));
        let ([.., a], [.., b]) = (front, back);
        let values = segment.fields_front.iter().chain(segment.fields_back).chain([&a, &b]);
        if !values.copied().all(f64::is_finite) {
            return Contribution::default();
        }
        let (f, k) = front_back(a, b);
        let optical_depth = 0.5 * a + 0.5 * b;
        let color = std::array::from_fn(|i| f * front[i] + k * back[i]);
        Contribution { optical_depth, color, opacity: opacity(optical_depth) }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct ClassifiedPoints {
    /// κ by channel and ρ, in the order of [`CLASSIFIED`], per world unit.
    pub arrays: [Vec<f64>; 4],
    /// A transfer function that looks at these arrays, absorbs and glows nowhere less, and needs an order. It only says
    /// what an integrator will find; nothing is drawn by it.
    pub bound: TransferFunction,
}

/// The preparation of scenes: the transfer function at the grid's points becomes point arrays ([`CLASSIFIED`]), and the scene's is
/// replaced by one that reads them.
impl ScenePreparation for VertexSampledKind {
    fn prepare(&self, volume: &Volume, transfer_function: &TransferFunction) -> Result<PreparedScene> {
        let names = transfer_function.fields();
        let arrays = names.iter().map(|name| volume.grid.point_array(name, 1)).collect::<Result<Vec<_>>>()?;
        let count = volume.grid.points.len();
        let fields: Vec<f64> =
            (0..count).flat_map(|p| arrays.iter().map(move |array| array.values[p])).collect();
        let g = |p: usize| volume.gradient_magnitude.as_ref().map_or(0.0, |g| g[p]);
        let values =
            (0..count).map(|p| ([volume.scalar[p], g(p)], &fields[p * names.len()..(p + 1) * names.len()]));
        let points = classified(transfer_function, values)?;
        let mut grid = Grid::clone(&volume.grid);
        for (name, values) in CLASSIFIED.into_iter().zip(points.arrays) {
            let array = Array { component_count: 1, values: values.into() };
            grid.point_arrays.insert(name.into(), Arc::new(array));
        }
        let volume = Volume { grid: Arc::new(grid), ..Volume::clone(volume) };
        Ok(PreparedScene { volume, transfer_function: points.bound })
    }

    fn is_prepared(&self, transfer_function: &TransferFunction) -> bool {
        let fields = transfer_function.fields();
        CLASSIFIED.iter().all(|name| fields.contains(name))
    }
}

/// Applies the transfer function at points: `values` gives s, g and its further fields of each.
///
/// Errors: a transfer function with a number out of range; more than can be told by numbers.
pub fn classified<'a>(
    transfer_function: &TransferFunction,
    values: impl Iterator<Item = ([f64; 2], &'a [f64])>,
) -> Result<ClassifiedPoints> {
    let prepared = CompiledTransferFunction::new(transfer_function)?;
    let mut arrays = [const { Vec::new() }; 4];
    for (point, fields) in values {
        let segment =
            Segment { length: 1.0, front: point, back: point, fields_front: fields, fields_back: fields };
        let sample = prepared.sampled(&segment, |samples| samples.at(0.0));
        let [red, green, blue] = sample.glow;
        for (array, value) in arrays.iter_mut().zip([red, green, blue, sample.rate]) {
            array.push(value);
        }
    }
    let most = arrays.each_ref().map(|array| array.iter().copied().fold(0.0, f64::max));
    let [red, green, blue, extinction] = most;
    let emission = red.max(green).max(blue);
    if !(extinction.is_finite() && emission.is_finite()) {
        return Err(Error::run(
            "a transfer function that is classified at points leaves the range of numbers",
        )
        .got(format!("extinction up to {extinction:e}, emission up to {emission:e}"))
        .expected("smaller extinctions, or another integrator"));
    }
    // Nothing that absorbs does not mean nothing that glows: at a cutoff of 0 it does, so a trace is enough.
    let extinction = extinction.max(emission * 1e-12);
    let brightest = if extinction > 0.0 { (emission / extinction).max(1.0) } else { 1.0 };
    let widget = |color| Widget {
        profile: Profile::GaussianNd {
            fields: CLASSIFIED.map(String::from).to_vec(),
            centre: vec![0.0; 4],
            matrix: vec![vec![0.0; 4]; 4],
        },
        color,
        extinction: extinction * transfer_function.unit_distance,
        region: None,
    };
    Ok(ClassifiedPoints {
        arrays,
        bound: TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: transfer_function.unit_distance,
            // Of two colours: segments are taken in order.
            widgets: vec![widget([brightest; 3]), widget([0.0; 3])],
            axes: Default::default(),
        },
    })
}

/// Interpolation in lanes, of a scene that is classified: indices of κ by channel and of ρ among a batch's values.
struct VertexSampledKernel {
    places: [usize; 4],
    /// Per scene length: offset + scale × stored.
    offsets: [f32; 4],
    scales: [f32; 4],
}

impl VertexSampledKernel {
    /// Errors: a scene that is not classified, or in numbers beyond 32 bits.
    pub fn new(scene: &LaneScene<'_>) -> std::result::Result<VertexSampledKernel, FallbackReason> {
        let mut made = VertexSampledKernel { places: [0; 4], offsets: [0.0; 4], scales: [0.0; 4] };
        for (k, name) in CLASSIFIED.into_iter().enumerate() {
            let axis = scene.field(name).ok_or(FallbackReason::Integrator)?;
            made.places[k] = axis.place;
            made.offsets[k] = (axis.offset * scene.length()) as f32;
            made.scales[k] = (axis.scale * scene.length()) as f32;
        }
        let held = made.offsets.iter().chain(&made.scales).all(|x| x.is_finite());
        if held { Ok(made) } else { Err(FallbackReason::Lengths) }
    }
}

impl LaneKernel for VertexSampledKernel {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, half) = (splat(0.0), splat(0.5));
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let length = batch.segments::<L>(at).length;
            let crossing = zero.lt(length);
            let length = L::F::select(crossing, length, zero);
            // Interpolation may leave less than nothing; what is no number stays none.
            let ends: [[L::F; 2]; 4] = array!(|k| {
                let [front, back] = batch.ends::<L>(self.places[k], at);
                let (scale, offset) = (splat(self.scales[k]), splat(self.offsets[k]));
                [front, back].map(
                    #[inline(always)]
                    |stored| zero.max(stored.mul_add(scale, offset)) * length,
                )
            });
            let (front, back) = (ends.map(|[front, _]| front), ends.map(|[_, back]| back));
            let depth = half.mul_add(front[3], half * back[3]);
            results.put_depth::<L>(at, depth);
            let mut unsure = depth.le(splat(0.5 * DEEPEST)).not().bits();
            // At a cutoff of 0 glows what does not absorb.
            let mut whole = depth;
            for k in 0..3 {
                whole = whole + (front[k] + back[k]);
            }
            let there = zero.lt(whole).bits();
            if !batch.depth_only() {
                let color = if there == 0 {
                    [zero; 3]
                } else {
                    let (near, far) = lane_front_back::<L>(front[3], back[3]);
                    array!(|c| near.mul_add(front[c], far * back[c]))
                };
                let whole = depth + (color[0] + (color[1] + color[2]));
                unsure |= whole.le(splat(f32::MAX)).not().bits();
                results.put::<L>(at, color, depth);
            }
            let within = batch.within::<L>(crossing, at);
            results.fall_back(at, unsure & within);
            results.count_evaluations(u64::from((there & within & !unsure).count_ones()));
        }
    }
}
