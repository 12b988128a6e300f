//! The shader: from a fragment's length and attribute values to its colour and opacity.
//!
//! Four kernel tiers, each for the segments that the one before does not integrate: closed forms in lanes (density-emitter; overlaps by
//! [`voltet_simd::optics::sums`]), quadrature in equal steps ([`super::fixed_quadrature`]), panels ([`super::panels`]), and the 64-bit
//! integrator segment by segment. An integrator from outside has one kernel in place of the first three ([`super::integrator`]).
//! Tiers that a scene does not use are not prepared.

use crate::attribute::MAX_ATTRIBUTES;
use crate::fragments::batch::{Batch, Column};
use crate::shade::context::{ShaderContext, WidgetContext};
use crate::shade::fixed_quadrature::integrate_fixed;
use crate::shade::integrator::{LaneExtension, LaneIntegrator, LaneScene};
use crate::shade::kernel::{OneColor, Several};
use crate::shade::kinds::{KernelTier, LaneLinear, LaneWidget};
use crate::shade::light::{Rays, Surface};
use crate::shade::panels::PanelQuadrature;
use crate::shade::segment_lanes::SegmentGather;
use crate::shade::shaded_batch::{Exact, FallbackReason, MIX_PRODUCT, STEPS, ShadedBatch};
use crate::tolerances::NEGLIGIBLE_DEPTH;
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::integrators::SegmentIntegrator;
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::{Float, Lanes};

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

/// Kernel that integrates every segment of a scene first; segments that it does not integrate are queued.
pub(crate) enum FirstKernel<'a> {
    /// An integrator from outside.
    Integrator(&'a dyn LaneIntegrator),
    /// One piecewise-linear widget.
    SinglePiecewise(&'a LaneLinear),
    OneColor(OneColor),
    Several(Several),
    /// All segments are queued.
    None,
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
        let closed_forms =
            closed && density_emitter && widgets.iter().all(|widget| widget.tier() == KernelTier::ClosedForm);
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

    /// Bytes of the integrator's tables.
    pub fn table_bytes(&self) -> usize {
        let exact = self.exact.as_ref().map_or(0, |exact| exact.table_bytes());
        exact + self.integrator.as_ref().map_or(0, |kernel| kernel.table_bytes())
    }

    /// True if the optical depth of every segment is stored, not only of those that the closed forms do not integrate.
    pub fn keeps_depth(&self) -> bool {
        self.one_color.is_some() || !self.has_closed_forms
    }

    /// Kernel that integrates every segment first.
    pub fn first(&self) -> FirstKernel<'_> {
        let several = Several { overlap: self.overlap, ordered_from: self.ordered_from };
        match (&self.integrator, self.widgets.as_slice()) {
            (Some(integrator), _) => FirstKernel::Integrator(integrator.as_ref()),
            _ if !self.has_closed_forms => FirstKernel::None,
            _ if self.one_color.is_some() => FirstKernel::OneColor(OneColor),
            // Alone, its pieces give the colour in closed form.
            (None, [widget]) => {
                widget.points().map_or(FirstKernel::Several(several), FirstKernel::SinglePiecewise)
            }
            (None, _) => FirstKernel::Several(several),
        }
    }

    /// Integrates the segments that are queued for fixed quadrature with one number of steps.
    #[inline(always)]
    pub fn integrate_fixed<L: Lanes>(&self, number: usize, batch: &Batch, out: &mut ShadedBatch) {
        let which = std::mem::take(&mut out.quadrature_queues[number]);
        integrate_fixed::<L>(&self.widgets, STEPS[number], batch, &which, out);
        out.quadrature_queues[number] = which;
    }

    /// Integrates the queued segments with optically thick pieces.
    #[inline(always)]
    pub fn integrate_thick_pieces<L: Lanes>(&self, batch: &Batch, out: &mut ShadedBatch) {
        let Some(points) = self.widgets.first().and_then(LaneWidget::points) else { return };
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

    /// Integrates the other queued segments in panels: with `THICK` those that are optically thick. Segments that fall back join the queue
    /// for 64 bits.
    #[inline(always)]
    pub fn integrate_panels<L: Lanes, const THICK: bool>(&self, batch: &Batch, out: &mut ShadedBatch) {
        let before = std::mem::take(&mut out.scratch);
        let mut which =
            std::mem::replace(if THICK { &mut out.optically_thick } else { &mut out.fallback_queue }, before);
        match &self.panels {
            Ok(panels) => panels.integrate_all::<L, THICK>(&self.widgets, batch, &which, out),
            Err(why) => {
                out.fallback_queue.extend(&which);
                out.reasons.resize(out.fallback_queue.len(), *why);
            }
        }
        which.clear();
        out.scratch = which;
    }

    /// Integrates the remaining segments one by one in 64 bits.
    pub fn finish(&self, batch: &Batch, out: &mut ShadedBatch) {
        for i in 0..out.fallback_queue.len() {
            let k = out.fallback_queue[i];
            let at = |columns: &[Column]| -> [f32; MAX_ATTRIBUTES] {
                std::array::from_fn(|a| columns.get(a).map_or(0.0, |column| column[k]))
            };
            // The closed forms counted overlaps.
            let contribution = self.integrate_stored(
                batch.length[k],
                &at(&batch.front),
                &at(&batch.back),
                !self.has_closed_forms,
            );
            out.depth[k] = contribution.depth;
            for (column, value) in out.rgba.iter_mut().zip(contribution.rgba) {
                column[k] = value;
            }
            out.overlap_count += u64::from(contribution.overlaps);
        }
        out.exact_count += out.fallback_queue.len() as u64;
        out.evaluation_count += out.fallback_queue.len() as u64;
    }

    /// Silhouettes and light.
    #[inline(always)]
    pub fn light<L: Lanes>(&self, batch: &Batch, count: usize, rays: &Rays, out: &mut ShadedBatch) {
        let Some(surface) = &self.surface else { return };
        let mut at = 0;
        while at < count {
            let (opacity, color) = surface.factors::<L>(batch, at, rays);
            if self.one_color.is_some() {
                let value = one_minus_exp::<L>(L::F::load(&out.depth[at..])) * opacity;
                value.store(&mut out.depth[at..]);
            } else {
                for (column, factor) in out.rgba.iter_mut().zip([color, color, color, opacity]) {
                    (L::F::load(&column[at..]) * factor).store(&mut column[at..]);
                }
            }
            at += L::WIDTH;
        }
    }

    /// [`Shader::integrate`] of stored attributes.
    pub fn integrate_stored(&self, length: f32, front: &[f32], back: &[f32], counted: bool) -> Exact {
        let value = |stored: &[f32], a: usize| {
            let [offset, scale] = self.scaling[a];
            offset + scale * f64::from(stored[a])
        };
        self.integrate(f64::from(length), |a| value(front, a), |a| value(back, a), counted)
    }

    /// True if there are panels for optically thick segments: those of the density-emitter.
    pub fn has_thick_panels(&self) -> bool {
        self.has_closed_forms
    }

    /// True if only some segments take more than the closed forms, and their depth is not used.
    pub fn pools(&self) -> bool {
        self.has_closed_forms && self.one_color.is_none()
    }

    /// The 64-bit integral of one segment: `length` in scene lengths, attributes in their own units;
    /// `counted`: true to report if widgets overlap.
    pub fn integrate(
        &self,
        length: f64,
        front: impl Fn(usize) -> f64,
        back: impl Fn(usize) -> f64,
        counted: bool,
    ) -> Exact {
        let n = self.scaling.len().min(MAX_ATTRIBUTES);
        let mut ends = [[0f64; MAX_ATTRIBUTES]; 2];
        let [fronts, backs] = &mut ends;
        for (a, (at_front, at_back)) in fronts.iter_mut().zip(backs).enumerate().take(n) {
            (*at_front, *at_back) = (front(a), back(a));
        }
        let g = |values: &[f64; MAX_ATTRIBUTES]| if n > 1 { values[1] } else { 0.0 };
        let fields = if n > 2 { 2..n } else { 0..0 };
        let segment = Segment {
            length: length * self.length,
            front: [ends[0][0], g(&ends[0])],
            back: [ends[1][0], g(&ends[1])],
            fields_front: &ends[0][fields.clone()],
            fields_back: &ends[1][fields],
        };
        let exact = self.exact.as_ref().expect("lanes integrate every segment of a table");
        let c = exact.integrate(&segment);
        let color = c.color.map(|x| x as f32);
        Exact {
            depth: c.optical_depth.min(f64::from(f32::MAX)) as f32,
            rgba: [color[0], color[1], color[2], c.opacity as f32],
            overlaps: counted
                && self.overlaps.as_ref().is_some_and(|o| o.overlap(&segment) > f64::from(MIX_PRODUCT)),
        }
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
