//! The shader: from a fragment's length and attribute values to its colour and opacity.
//!
//! Four roads, each for what the one before leaves over: quick closed forms in lanes (density-emitter; overlaps by
//! [`voltet_simd::optics::sums`]), quadrature in as many equal steps as a segment wants ([`super::stepped`]), a walk in panels
//! ([`super::panels`]), and the 64-bit integrator segment by segment. Integrators that sample or look up have one road of their
//! own in place of the first three ([`crate::integrator`]). What a scene does not use is not prepared.

use crate::attribute::{ATTRIBUTES_MOST, Attribute};
use crate::fragments::batch::{Batch, Column, meant};
use crate::integrator::{LaneExtension, LaneIntegrator, LaneScene};
use crate::shade::along::Along;
use crate::shade::gathered::Gathered;
use crate::shade::kinds::{LaneLinear, LaneWidget, Making, Road};
use crate::shade::light::{Rays, Surface};
use crate::shade::panels::PanelWalk;
use crate::shade::quick::{OneColor, Several};
use crate::shade::reach::LEFT_OUT;
use crate::shade::shaded::{Exact, Left, MIX_PRODUCT, STEPS, Shaded};
use crate::shade::stepped::stepped;
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_optics::integrators::{Extent, SegmentIntegrator};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::{Float, LaneSet, Lanes, Mask};

/// A transfer function made ready for lanes.
pub(crate) struct Shader {
    /// Finds overlaps in 64 bits, where there is more than one widget.
    overlaps: Option<CompiledTransferFunction>,
    /// What serves one segment in 64 bits; `None` where lanes serve every one.
    exact: Option<Box<dyn SegmentIntegrator>>,
    overlap: WidgetBlend,
    /// Pairwise product of depths from which on the order of widgets counts.
    ordered_from: f32,
    pub(super) widgets: Vec<LaneWidget>,
    /// What the quick forms do not serve, but lanes do; or why they do not.
    walker: std::result::Result<PanelWalk, Left>,
    /// What serves in place of the closed forms.
    method: Option<Box<dyn LaneIntegrator>>,
    /// Whether the quick forms serve anything.
    quick: bool,
    /// Offset and scale of each attribute: value = offset + scale × stored.
    scaling: Vec<[f64; 2]>,
    /// World units in a scene length.
    length: f64,
    /// Silhouettes and light.
    pub surface: Option<Surface>,
    /// The one colour of all widgets, under the density-emitter: C = c · A, so no order is needed.
    pub one_color: Option<[f32; 3]>,
}

/// What serves every segment of a scene first.
pub(crate) enum First<'a> {
    /// An integrator that samples or looks up.
    Method(&'a dyn LaneIntegrator),
    /// The pieces of one widget.
    Alone(&'a LaneLinear),
    OneColor(OneColor),
    Several(Several),
    /// What takes the others' place for segments that they leave over.
    Nothing,
}

/// What a shader is made for.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub attributes: &'a [Attribute<'a>],
    /// World units in a scene length.
    pub length: f64,
    /// Segments are ordered also where one colour needs no order.
    pub ordered: bool,
    /// Segments that a widget hardly meets are not asked of it.
    pub leave_out: bool,
    /// What the segments span, for tables.
    pub extent: Extent,
    /// What fills them.
    pub lanes: LaneSet,
}

impl Shader {
    /// Errors: a grid without extent.
    pub fn new(
        transfer_function: &TransferFunction,
        shading: &Shading,
        exact: Option<Box<dyn SegmentIntegrator>>,
        scene: Scene<'_>,
        surface: Option<Surface>,
    ) -> Result<Shader> {
        let Scene { attributes, length, ordered, leave_out, .. } = scene;
        if length <= 0.0 || !length.is_finite() {
            return Err(Error::run("the grid has no extent")
                .got(length)
                .expected("points that span a volume"));
        }
        let in_lanes = has_closed_forms(&shading.integrator)
            || shading.integrator.extension::<LaneExtension>().is_some();
        let density_emitter = transfer_function.model == OpticalModel::DensityEmitter;
        let fields = transfer_function.fields();
        let making = Making {
            attributes,
            fields: &fields,
            density_scale: length / transfer_function.unit_distance,
            model: transfer_function.model,
            left_out: leave_out.then(|| LEFT_OUT / transfer_function.widgets.len().max(1) as f64),
        };
        let widgets: Vec<LaneWidget> = transfer_function
            .widgets
            .iter()
            .map(|widget| if in_lanes { LaneWidget::new(widget, &making) } else { LaneWidget::none() })
            .collect();
        let one_color = shading.one_color(transfer_function).filter(|_| !ordered);
        let one_color = one_color.map(|color| color.map(|c| c as f32));
        let scaling = attributes.iter().map(|a| [a.offset, a.scale]).collect();
        let (integrator, exact_forms) = (&shading.integrator, exact.as_deref());
        let prepared = match integrator.extension::<LaneExtension>() {
            _ if has_closed_forms(integrator) => None,
            None => Some(Err(Left::Integrator)),
            Some(LaneExtension(kind)) => {
                let (widgets, making, scene) = (&widgets, &making, &scene);
                let scene = LaneScene { widgets, making, scene, transfer_function, exact: exact_forms };
                Some(kind.prepare(integrator, &scene)?)
            }
        };
        let (method, missing) = match prepared {
            None => (None, None),
            // What it leaves over is a matter of its samples.
            Some(Ok(method)) => (Some(method), Some(Left::Samples)),
            Some(Err(why)) => (None, Some(why)),
        };
        let closed = missing.is_none();
        let quick = closed && density_emitter && widgets.iter().all(|widget| widget.road() == Road::Quick);
        // What mixing leaves is another integrator's choice than the closed forms'.
        let overlap =
            if shading.integrator == Integrator::ANALYTIC { shading.overlap } else { WidgetBlend::Exact };
        let ordered_from = ordered_from(&shading.integrator, transfer_function);
        let walker = if let Some(why) = missing {
            Err(why)
        } else if overlap == WidgetBlend::Exact || one_color.is_some() {
            PanelWalk::new(transfer_function, &widgets, length, one_color.is_some(), !quick, ordered_from)
        } else {
            Err(Left::Mixed)
        };
        let several = transfer_function.widgets.len() > 1;
        let overlaps = several.then(|| CompiledTransferFunction::new(transfer_function)).transpose()?;
        Ok(Shader {
            overlaps,
            exact,
            overlap,
            ordered_from,
            widgets,
            walker,
            method,
            quick,
            scaling,
            length,
            surface,
            one_color,
        })
    }

    /// Why a segment could not be integrated, if there was one.
    pub fn failure(&self) -> Option<&Error> {
        self.exact.as_ref().and_then(|exact| exact.failure())
    }

    /// Bytes of the integrator's tables.
    pub fn table_bytes(&self) -> usize {
        let exact = self.exact.as_ref().map_or(0, |exact| exact.table_bytes());
        exact + self.method.as_ref().map_or(0, |method| method.table_bytes())
    }

    /// Whether every segment's optical depth is kept, not only those that the quick forms leave over.
    pub fn keeps_depth(&self) -> bool {
        self.one_color.is_some() || !self.quick
    }

    /// What serves every segment first.
    pub fn first(&self) -> First<'_> {
        let several = Several { overlap: self.overlap, ordered_from: self.ordered_from };
        match (&self.method, self.widgets.as_slice()) {
            (Some(method), _) => First::Method(method.as_ref()),
            _ if !self.quick => First::Nothing,
            _ if self.one_color.is_some() => First::OneColor(OneColor),
            // Alone, its pieces give the colour in closed form.
            (None, [widget]) => widget.points().map_or(First::Several(several), First::Alone),
            (None, _) => First::Several(several),
        }
    }

    /// The fragments that what is [first](Shader::first) left over for so many steps.
    #[inline(always)]
    pub fn stepped<L: Lanes>(&self, number: usize, batch: &Batch, out: &mut Shaded) {
        let which = std::mem::take(&mut out.in_order[number]);
        stepped::<L>(&self.widgets, STEPS[number], batch, &which, out);
        out.in_order[number] = which;
    }

    /// The fragments that what is [first](Shader::first) left over since their pieces are deep.
    #[inline(always)]
    pub fn deep<L: Lanes>(&self, batch: &Batch, out: &mut Shaded) {
        let Some(points) = self.widgets.first().and_then(LaneWidget::points) else { return };
        let tables = points.tables::<L>();
        let which = std::mem::take(&mut out.deep);
        let mut gathered = Gathered::new(1);
        for group in which.chunks(L::WIDTH) {
            gathered.take(batch, group);
            let (rgba, _) = tables.integrate::<true>(&gathered.along::<L>());
            out.put::<L, 4>(group, rgba);
        }
        out.deep = which;
        out.deep.clear();
    }

    /// The other fragments that what is [first](Shader::first) left over, in lanes: if `DENSE` those that are dense, to which the others that are
    /// left then join.
    #[inline(always)]
    pub fn walk<L: Lanes, const DENSE: bool>(&self, batch: &Batch, out: &mut Shaded) {
        let before = std::mem::take(&mut out.spare);
        let mut which = std::mem::replace(if DENSE { &mut out.dense } else { &mut out.rest }, before);
        match &self.walker {
            Ok(walker) => walker.walk::<L, DENSE>(&self.widgets, batch, &which, out),
            Err(why) => {
                out.rest.extend(&which);
                out.why.resize(out.rest.len(), *why);
            }
        }
        which.clear();
        out.spare = which;
    }

    /// What is still left over, one by one in 64 bits.
    pub fn finish(&self, batch: &Batch, out: &mut Shaded) {
        for i in 0..out.rest.len() {
            let k = out.rest[i];
            let at = |columns: &[Column]| -> [f32; ATTRIBUTES_MOST] {
                std::array::from_fn(|a| columns.get(a).map_or(0.0, |column| column[k]))
            };
            // The quick forms have counted theirs.
            let contribution =
                self.integrate_stored(batch.length[k], &at(&batch.front), &at(&batch.back), !self.quick);
            out.depth[k] = contribution.depth;
            for (column, value) in out.rgba.iter_mut().zip(contribution.rgba) {
                column[k] = value;
            }
            out.overlap_count += u64::from(contribution.overlaps);
        }
        out.exact_count += out.rest.len() as u64;
        out.evaluation_count += out.rest.len() as u64;
    }

    /// Silhouettes and light.
    #[inline(always)]
    pub fn light<L: Lanes>(&self, batch: &Batch, count: usize, rays: &Rays, out: &mut Shaded) {
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

    /// Whether there are steps for dense segments: those of the density-emitter.
    pub fn has_dense_steps(&self) -> bool {
        self.quick
    }

    /// Whether a part of the segments only takes more than the quick forms, and nobody asks for their depth.
    pub fn pools(&self) -> bool {
        self.quick && self.one_color.is_none()
    }

    /// The 64-bit integral of one segment: `length` in scene lengths, attributes in their own units;
    /// `counted`: whether to say if widgets overlap.
    pub fn integrate(
        &self,
        length: f64,
        front: impl Fn(usize) -> f64,
        back: impl Fn(usize) -> f64,
        counted: bool,
    ) -> Exact {
        let n = self.scaling.len().min(ATTRIBUTES_MOST);
        let mut ends = [[0f64; ATTRIBUTES_MOST]; 2];
        let [fronts, backs] = &mut ends;
        for (a, (at_front, at_back)) in fronts.iter_mut().zip(backs).enumerate().take(n) {
            (*at_front, *at_back) = (front(a), back(a));
        }
        let g = |values: &[f64; ATTRIBUTES_MOST]| if n > 1 { values[1] } else { 0.0 };
        let fields = if n > 2 { 2..n } else { 0..0 };
        let segment = Segment {
            length: length * self.length,
            front: [ends[0][0], g(&ends[0])],
            back: [ends[1][0], g(&ends[1])],
            fields_front: &ends[0][fields.clone()],
            fields_back: &ends[1][fields],
        };
        let exact = self.exact.as_ref().expect("lanes leave over no segment of a table");
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

/// Appends the places of some lanes (bits) of the vector at `at`.
#[inline(always)]
pub(crate) fn push(list: &mut Vec<usize>, mut lanes: u32, at: usize) {
    while lanes != 0 {
        list.push(at + lanes.trailing_zeros() as usize);
        lanes &= lanes - 1;
    }
}

/// Lanes (bits) of the first `count` segments on which widgets overlap.
#[inline(always)]
pub(crate) fn overlaps<L: Lanes>(product: L::F, along: &Along<L>, count: usize) -> u32 {
    meant::<L>(L::F::splat(MIX_PRODUCT).lt(product).and(along.crossing), count)
}
