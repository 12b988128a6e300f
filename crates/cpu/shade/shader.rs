//! The shader: from a fragment's length and attribute values to its colour and opacity.
//!
//! Four kernel tiers, each for the segments that the one before does not integrate: closed forms in lanes (density-emitter; overlaps by
//! [`voltet_simd::optics::smooth`]), quadrature in equal steps ([`super::fixed_quadrature`]), panels ([`super::panels`]), and the 64-bit
//! integrator segment by segment. An integrator from outside has one kernel in place of the first three ([`super::integrator`]).
//! Tiers that a scene does not use are not prepared.

use crate::attribute::MAX_ATTRIBUTES;
use crate::fragments::batch::{Batch, MAX_LANES};
use crate::shade::context::{ShaderContext, WidgetContext};
use crate::shade::fixed_quadrature::integrate_fixed;
use crate::shade::integrator::{LaneExtension, LaneIntegrator, LaneScene, SegmentResults};
use crate::shade::kernel::{OneColor, SegmentBatch, Several, SinglePiecewise};
use crate::shade::kinds::{KernelTier, LaneWidget};
use crate::shade::light::Surface;
use crate::shade::panels::PanelQuadrature;
use crate::shade::segment_lanes::SegmentGather;
use crate::shade::shaded_batch::{FallbackReason, MIX_PRODUCT, STEPS, ShadedBatch};
use crate::tolerances::NEGLIGIBLE_DEPTH;
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::integrators::SegmentIntegrator;
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};
use voltet_simd::{Kernel, LaneSet, Lanes, dispatch};

/// Transfer function and shading, compiled for lanes.
pub(crate) struct Shader {
    /// Finds overlaps in 64 bits, where there is more than one widget.
    overlaps: Option<CompiledTransferFunction>,
    /// 64-bit integrator; `None` where lanes integrate every segment.
    exact: Option<Box<dyn SegmentIntegrator>>,
    overlap: WidgetBlend,
    /// Pairwise product of depths from which on the order of widgets counts.
    ordered_from: f32,
    pub(super) widgets: Vec<LaneWidget>,
    /// Panels for segments without closed form; or the reason why those fall back to 64 bits.
    panels: std::result::Result<PanelQuadrature, FallbackReason>,
    /// Kernel of an integrator from outside, in place of the closed forms.
    integrator: Option<Box<dyn LaneIntegrator>>,
    /// True if the closed forms come first.
    has_closed_forms: bool,
    /// Offset and scale of each attribute: value = offset + scale × stored.
    scaling: Vec<[f64; 2]>,
    /// World units in a scene length.
    length: f64,
    /// Silhouettes and light.
    pub surface: Option<Surface>,
    /// The one colour of all widgets, under the density-emitter: C = c · A, so no order is needed.
    pub one_color: Option<[f32; 3]>,
}

impl Shader {
    /// Errors: a grid without extent.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        exact: Option<Box<dyn SegmentIntegrator>>,
        scene: ShaderContext<'_>,
        surface: Option<Surface>,
    ) -> Result<Shader> {
        let ShaderContext { attributes, length, ordered, leave_out, .. } = scene;
        if length <= 0.0 || !length.is_finite() {
            return Err(Error::run("the grid has no extent")
                .got(length)
                .expected("points that span a volume"));
        }
        let in_lanes = has_closed_forms(&shading.integrator)
            || shading.integrator.extension::<LaneExtension>().is_some();
        let density_emitter = transfer_function.model == OpticalModel::DensityEmitter;
        let fields = transfer_function.fields();
        let context = WidgetContext {
            attributes,
            fields: &fields,
            density_scale: length / transfer_function.unit_distance,
            model: transfer_function.model,
            left_out: leave_out.then(|| NEGLIGIBLE_DEPTH / transfer_function.widgets.len().max(1) as f64),
        };
        let widgets: Vec<LaneWidget> = transfer_function
            .widgets
            .iter()
            .map(|widget| if in_lanes { LaneWidget::new(widget, &context) } else { LaneWidget::none() })
            .collect();
        let one_color = shading.one_color(transfer_function).filter(|_| !ordered);
        let one_color = one_color.map(|color| color.map(|c| c as f32));
        let scaling = attributes.iter().map(|a| [a.offset, a.scale]).collect();
        let (integrator, exact_forms) = (&shading.integrator, exact.as_deref());
        let prepared = match integrator.extension::<LaneExtension>() {
            _ if has_closed_forms(integrator) => None,
            None => Some(Err(FallbackReason::Integrator)),
            Some(LaneExtension(kind)) => {
                let (widgets, context, scene) = (&widgets, &context, &scene);
                let scene = LaneScene { widgets, context, scene, transfer_function, exact: exact_forms };
                Some(kind.prepare(integrator, &scene)?)
            }
        };
        let (kernel, missing) = match prepared {
            None => (None, None),
            // Its samples are the reason of each fallback.
            Some(Ok(kernel)) => (Some(kernel), Some(FallbackReason::Samples)),
            Some(Err(why)) => (None, Some(why)),
        };
        let closed = missing.is_none();
        let closed_forms = closed
            && density_emitter
            && widgets.iter().all(|widget| widget.traits().tier == KernelTier::ClosedForm);
        // Only the closed forms mix widgets.
        let overlap =
            if shading.integrator == Integrator::ANALYTIC { shading.overlap } else { WidgetBlend::Exact };
        let ordered_from = ordered_from(&shading.integrator, transfer_function);
        let panels = if let Some(why) = missing {
            Err(why)
        } else if overlap == WidgetBlend::Exact || one_color.is_some() {
            PanelQuadrature::new(
                transfer_function,
                &widgets,
                length,
                one_color.is_some(),
                !closed_forms,
                ordered_from,
            )
        } else {
            Err(FallbackReason::Mixed)
        };
        let several = transfer_function.widgets.len() > 1;
        let overlaps = several.then(|| CompiledTransferFunction::new(transfer_function)).transpose()?;
        Ok(Shader {
            overlaps,
            exact,
            overlap,
            ordered_from,
            widgets,
            panels,
            integrator: kernel,
            has_closed_forms: closed_forms,
            scaling,
            length,
            surface,
            one_color,
        })
    }

    /// Reason why a segment could not be integrated, if there was one.
    pub fn failure(&self) -> Option<&Error> {
        self.exact.as_ref().and_then(|exact| exact.failure())
    }

    pub fn table_bytes(&self) -> usize {
        let exact = self.exact.as_ref().map_or(0, |exact| exact.table_bytes());
        exact + self.integrator.as_ref().map_or(0, |kernel| kernel.table_bytes())
    }

    /// True if the optical depth of every segment is stored, not only of those that the closed forms do not integrate.
    pub fn keeps_depth(&self) -> bool {
        self.one_color.is_some() || !self.has_closed_forms
    }

    /// True if only some segments take more than the closed forms, and their depth is not used.
    pub fn pools(&self) -> bool {
        self.has_closed_forms && self.one_color.is_none()
    }

    /// Integrates the queued segments of a batch one by one in 64 bits, attributes in their own units.
    fn integrate_in_64_bits(&self, batch: &Batch, out: &mut ShadedBatch) {
        let n = self.scaling.len().min(MAX_ATTRIBUTES);
        let fields = if n > 2 { 2..n } else { 0..0 };
        let exact = self.exact.as_ref().expect("lanes integrate every segment of a table");
        // The closed forms counted overlaps.
        let overlaps = self.overlaps.as_ref().filter(|_| !self.has_closed_forms);
        for &k in &out.fallback_queue {
            let ends = [&batch.front, &batch.back].map(|columns| {
                let mut values = [0f64; MAX_ATTRIBUTES];
                for ((value, column), [offset, scale]) in values.iter_mut().zip(columns).zip(&self.scaling) {
                    *value = offset + scale * f64::from(column[k]);
                }
                values
            });
            let g = |values: &[f64; MAX_ATTRIBUTES]| if n > 1 { values[1] } else { 0.0 };
            let segment = Segment {
                length: f64::from(batch.length[k]) * self.length,
                front: [ends[0][0], g(&ends[0])],
                back: [ends[1][0], g(&ends[1])],
                fields_front: &ends[0][fields.clone()],
                fields_back: &ends[1][fields.clone()],
            };
            let contribution = exact.integrate(&segment);
            out.depth[k] = contribution.optical_depth.min(f64::from(f32::MAX)) as f32;
            let [r, g, b] = contribution.color;
            for (column, value) in out.rgba.iter_mut().zip([r, g, b, contribution.opacity]) {
                column[k] = value as f32;
            }
            let overlap = overlaps.map_or(0.0, |function| function.overlap(&segment));
            out.overlap_count += u64::from(overlap > f64::from(MIX_PRODUCT));
        }
        out.exact_count += out.fallback_queue.len() as u64;
        out.evaluation_count += out.fallback_queue.len() as u64;
    }
}

/// Integrates the first `count` segments of a batch: in lanes, and in 64 bits those that lanes do not integrate.
pub(crate) fn integrate(shader: &Shader, lanes: LaneSet, batch: &Batch, count: usize, out: &mut ShadedBatch) {
    integrate_first(shader, lanes, batch, count, out);
    finish(shader, lanes, batch, out);
}

/// Integrates the first `count` segments of a batch by the kernel that comes first; others are queued.
pub(crate) fn integrate_first(
    shader: &Shader,
    lanes: LaneSet,
    batch: &Batch,
    count: usize,
    out: &mut ShadedBatch,
) {
    out.clear();
    let range =
        SegmentBatch { widgets: &shader.widgets, one_color: shader.one_color.is_some(), batch, count };
    if let Some(integrator) = &shader.integrator {
        return integrator.run(lanes, range, &mut SegmentResults(out));
    }
    if !shader.has_closed_forms {
        return queue_all(range, out);
    }
    if shader.one_color.is_some() {
        return dispatch(lanes, OneColor { range, out });
    }
    // Alone, the pieces of a piecewise-linear widget give the colour in closed form.
    if let [widget] = shader.widgets.as_slice()
        && let Some(linear) = widget.points()
    {
        return dispatch(lanes, SinglePiecewise { linear, range, out });
    }
    let Shader { overlap, ordered_from, .. } = *shader;
    dispatch(lanes, Several { overlap, ordered_from, range, out });
}

/// Queues all segments of a range for slower kernels.
fn queue_all(SegmentBatch { batch, count, .. }: SegmentBatch<'_>, out: &mut ShadedBatch) {
    // Fragments of no length are summed, too.
    out.depth[..count.next_multiple_of(MAX_LANES)].fill(0.0);
    out.fallback_queue.extend((0..count).filter(|&k| 0.0 < batch.length[k]));
    out.evaluation_count += out.fallback_queue.len() as u64;
}

/// Integrates queued segments: by fixed quadrature and panels, by panels for optically thick segments, and in 64 bits.
pub(crate) fn finish(shader: &Shader, lanes: LaneSet, batch: &Batch, out: &mut ShadedBatch) {
    out.reasons.clear();
    for number in 0..out.quadrature_queues.len() {
        if !out.quadrature_queues[number].is_empty() {
            dispatch(lanes, FixedQuadrature { shader, number, batch, out });
        }
    }
    if !out.thick_pieces.is_empty() {
        dispatch(lanes, ThickPieces { shader, batch, out });
    }
    if !out.fallback_queue.is_empty() {
        dispatch(lanes, PanelKernel { thick: false, shader, batch, out });
        // Those of the density-emitter alone.
        if shader.has_closed_forms {
            out.move_optically_thick();
        }
    }
    if !out.optically_thick.is_empty() {
        dispatch(lanes, PanelKernel { thick: true, shader, batch, out });
    }
    if !out.fallback_queue.is_empty() {
        shader.integrate_in_64_bits(batch, out);
    }
}

/// Integrates the segments that are queued for fixed quadrature with one number of steps.
struct FixedQuadrature<'a> {
    shader: &'a Shader,
    number: usize,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl Kernel for FixedQuadrature<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let FixedQuadrature { shader, number, batch, out } = self;
        let which = std::mem::take(&mut out.quadrature_queues[number]);
        integrate_fixed::<L>(&shader.widgets, STEPS[number], batch, &which, out);
        out.quadrature_queues[number] = which;
    }
}

/// Integrates the queued segments with optically thick pieces.
struct ThickPieces<'a> {
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl Kernel for ThickPieces<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let ThickPieces { shader, batch, out } = self;
        let Some(points) = shader.widgets.first().and_then(LaneWidget::points) else { return };
        let tables = points.tables::<L>();
        let which = std::mem::take(&mut out.thick_pieces);
        let mut gather = SegmentGather::new(1);
        for group in which.chunks(L::WIDTH) {
            gather.take(batch, group);
            let (rgba, _) = tables.integrate::<true>(&gather.segments::<L>());
            out.put::<L, 4>(group, rgba);
        }
        out.thick_pieces = which;
        out.thick_pieces.clear();
    }
}

/// Integrates the other queued segments in panels: with `thick` those that are optically thick. Segments that fall back join the queue
/// for 64 bits.
struct PanelKernel<'a> {
    thick: bool,
    shader: &'a Shader,
    batch: &'a Batch,
    out: &'a mut ShadedBatch,
}

impl Kernel for PanelKernel<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let PanelKernel { thick, shader, batch, out } = self;
        let before = std::mem::take(&mut out.scratch);
        let mut which =
            std::mem::replace(if thick { &mut out.optically_thick } else { &mut out.fallback_queue }, before);
        match &shader.panels {
            Ok(panels) => panels.integrate_all::<L>(thick, &shader.widgets, batch, &which, out),
            Err(why) => {
                out.fallback_queue.extend(&which);
                out.reasons.resize(out.fallback_queue.len(), *why);
            }
        }
        which.clear();
        out.scratch = which;
    }
}

/// Pairwise product of depths up to which a segment's widgets are mixed. Kniss's mix M of what each gives, E, differs by no more
/// than Tᵢ (T − Tᵢ) from it, whatever the order (see `optics::integrators::Adaptive`), and Σ E = Σ M; so a channel's error is under
/// the product times the brightest channel.
fn ordered_from(integrator: &Integrator, transfer_function: &TransferFunction) -> f32 {
    match integrator.tolerance() {
        Some(tolerance) => {
            let brightest = transfer_function.widgets.iter().map(Widget::max_emission).fold(0.0, f64::max);
            MIX_PRODUCT.max((tolerance / brightest.max(1.0)) as f32)
        }
        None => MIX_PRODUCT,
    }
}

/// True for the integrators whose closed forms the engine has in lanes.
fn has_closed_forms(integrator: &Integrator) -> bool {
    *integrator == Integrator::ANALYTIC || integrator.tolerance().is_some()
}
