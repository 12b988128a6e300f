//! The shader: from a fragment's length and attribute values to its colour and opacity.
//!
//! Four roads, each for what the one before leaves over: quick closed forms in lanes (density-emitter; overlaps by
//! [`voltet_lanes::optics::sums`]), quadrature in as many equal steps as a segment wants ([`super::stepped`]), a walk in panels
//! ([`super::panels`]), and the 64-bit integrator segment by segment. Integrators that sample or look up have one road of their
//! own in place of the first three ([`super::methods`]). What a scene does not use is not prepared.

use crate::attribute::{ATTRIBUTES_MOST, Attribute};
use crate::fragments::batch::{Batch, Column, meant};
use crate::shade::along::{Along, lanes_of};
use crate::shade::gathered::Gathered;
use crate::shade::kinds::{InOrder, LaneWidget, Making, Road};
use crate::shade::light::{Rays, Surface};
use crate::shade::methods::{LaneMethod, Served};
use crate::shade::panels::PanelWalk;
use crate::shade::reach::{LEFT_OUT, Spread};
use crate::shade::shaded::{DENSE_LEAST, Exact, Left, MIX_PRODUCT, Shaded};
use crate::shade::stepped::{STEPS, stepped};
use voltet_core::optics::integrators::{Extent, SegmentIntegrator};
use voltet_core::optics::{Overlap, Prepared, Segment};
use voltet_core::shading::{Integrator, Shading};
use voltet_core::transfer::{OpticalModel, TransferFunction, Widget};
use voltet_core::{Error, Result};
use voltet_lanes::optics::elementary::one_minus_exp;
use voltet_lanes::optics::sums::Sums;
use voltet_lanes::{Float, LaneSet, Lanes, Mask};

/// A transfer function made ready for lanes.
pub(crate) struct Shader {
    /// Finds overlaps in 64 bits, where there is more than one widget.
    overlaps: Option<Prepared>,
    /// What serves one segment in 64 bits; `None` where lanes serve every one.
    exact: Option<Box<dyn SegmentIntegrator>>,
    overlap: Overlap,
    /// Pairwise product of depths from which on the order of widgets counts.
    ordered_from: f32,
    widgets: Vec<LaneWidget>,
    /// What the quick forms do not serve, but lanes do; or why they do not.
    walker: std::result::Result<PanelWalk, Left>,
    /// What serves in place of the closed forms.
    method: Option<LaneMethod>,
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
                .found(length)
                .accepted("points that span a volume"));
        }
        let in_lanes = shading.integrator != Integrator::Reference;
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
        let served =
            Served::new(&shading.integrator, exact.as_deref(), transfer_function, &widgets, &making, &scene)?;
        let (method, missing) = match served {
            Served::InClosedForm => (None, None),
            // What it leaves over is a matter of its samples.
            Served::By(method) => (Some(method), Some(Left::Samples)),
            Served::Not(why) => (None, Some(why)),
        };
        let closed = missing.is_none();
        let quick = closed && density_emitter && widgets.iter().all(|widget| widget.road() == Road::Quick);
        // What mixing leaves is another integrator's choice than the closed forms'.
        let overlap =
            if shading.integrator == Integrator::Analytic { shading.overlap } else { Overlap::Exact };
        let ordered_from = ordered_from(&shading.integrator, transfer_function);
        let walker = if let Some(why) = missing {
            Err(why)
        } else if overlap == Overlap::Exact || one_color.is_some() {
            PanelWalk::new(transfer_function, &widgets, length, one_color.is_some(), !quick, ordered_from)
        } else {
            Err(Left::Mixed)
        };
        let several = transfer_function.widgets.len() > 1;
        let overlaps = several.then(|| Prepared::new(transfer_function)).transpose()?;
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
        exact + self.method.as_ref().map_or(0, LaneMethod::table_bytes)
    }

    /// Whether every segment's optical depth is kept, not only those that the quick forms leave over.
    pub fn keeps_depth(&self) -> bool {
        self.one_color.is_some() || !self.quick
    }

    /// Integrates the first `count` fragments of a batch by the quick forms.
    #[inline(always)]
    pub fn shade<L: Lanes>(&self, batch: &Batch, count: usize, out: &mut Shaded) {
        out.clear();
        if let Some(method) = &self.method {
            return method.shade::<L>(&self.widgets, self.one_color.is_some(), batch, count, out);
        }
        // Alone, its pieces give the colour in closed form.
        let points = match self.widgets.as_slice() {
            [widget] if self.one_color.is_none() => widget.points().map(
                #[inline(always)]
                |points| points.tables::<L>(),
            ),
            _ => None,
        };
        let widgets = &self.widgets;
        let mut at = 0;
        while at < count {
            let along = Along::<L>::load(batch, at);
            let unsure = if !self.quick {
                // Fragments of no length are summed, too.
                L::F::splat(0.0).store(&mut out.depth[at..]);
                u32::MAX
            } else if let Some(points) = &points {
                let (rgba, [deep, unsure]) = points.integrate::<false>(&along);
                for (column, value) in out.rgba.iter_mut().zip(rgba) {
                    value.store(&mut column[at..]);
                }
                push(&mut out.deep, deep & !unsure & meant::<L>(along.crossing, count - at), at);
                unsure
            } else if self.one_color.is_some() {
                self.of_one_color::<L>(widgets, &along, at, count, out)
            } else {
                self.several::<L>(widgets, &along, at, count, out)
            };
            let meant = meant::<L>(along.crossing, count - at);
            if !self.quick || points.is_some() {
                out.evaluation_count += u64::from(meant.count_ones());
            }
            push(&mut out.rest, unsure & meant, at);
            at += L::WIDTH;
        }
    }

    /// The fragments that [`Shader::shade`] left over for so many steps.
    #[inline(always)]
    pub fn stepped<L: Lanes>(&self, number: usize, batch: &Batch, out: &mut Shaded) {
        let which = std::mem::take(&mut out.in_order[number]);
        stepped::<L>(&self.widgets, STEPS[number], batch, &which, out);
        out.in_order[number] = which;
    }

    /// The fragments that [`Shader::shade`] left over since their pieces are deep.
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

    /// The other fragments that [`Shader::shade`] left over, in lanes: if `DENSE` those that are dense, to which the others that are
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

    /// Widgets of one colour: optical depths add up, whatever the order.
    #[inline(always)]
    fn of_one_color<L: Lanes>(
        &self,
        widgets: &[LaneWidget],
        along: &Along<L>,
        at: usize,
        count: usize,
        out: &mut Shaded,
    ) -> u32 {
        let zero = L::F::splat(0.0);
        let (mut total, mut product, mut unsure, mut asked) = (zero, zero, 0, 0);
        let spread = Spread::new(along);
        for widget in widgets {
            let meets = widget.meets::<L>(&spread);
            if !meets.any() {
                continue;
            }
            asked |= meets.bits();
            let (depth, no) = widget.depth::<L>(&along.only(meets));
            let depth = L::F::select(meets, depth, zero);
            unsure |= no & meets.bits();
            product = depth.mul_add(total, product);
            total = total + depth;
        }
        if widgets.len() > 1 {
            let overlapping = overlaps::<L>(product, along, count - at);
            out.overlap_count += u64::from(overlapping.count_ones());
        }
        total.store(&mut out.depth[at..]);
        out.evaluation_count += u64::from((asked & meant::<L>(along.crossing, count - at)).count_ones());
        unsure
    }

    /// Widgets whose colour does not vary along the segment, one or more. Segments that want steps are put in `out`.
    #[inline(always)]
    fn several<L: Lanes>(
        &self,
        widgets: &[LaneWidget],
        along: &Along<L>,
        at: usize,
        count: usize,
        out: &mut Shaded,
    ) -> u32 {
        let zero = L::F::splat(0.0);
        let (mut sums, mut unsure, mut asked) = (Sums::<L>::none(), 0, 0);
        let spread = Spread::new(along);
        for widget in widgets {
            let meets = widget.meets::<L>(&spread);
            if !meets.any() {
                continue;
            }
            asked |= meets.bits();
            let (mut shape, no) = widget.shape::<L>(&along.only(meets));
            shape.depth = L::F::select(meets, shape.depth, zero);
            unsure |= no & meets.bits();
            if widget.in_order() == InOrder::Always {
                unsure |= zero.lt(shape.depth).bits();
            }
            sums.add(&shape, widget.color);
        }
        let overlapping = overlaps::<L>(sums.product, along, count - at);
        out.overlap_count += u64::from(overlapping.count_ones());
        out.evaluation_count += u64::from((asked & meant::<L>(along.crossing, count - at)).count_ones());
        let mut rgba = sums.mixed();
        let overlapping = overlapping & !unsure & L::F::splat(self.ordered_from).lt(sums.product).bits();
        if self.overlap == Overlap::Exact && overlapping != 0 {
            let smooth = sums.is_smooth();
            let served = overlapping & smooth.bits();
            if served != 0 {
                let (keep, more) = (lanes_of::<L>(served), sums.correction());
                for (color, more) in rgba.iter_mut().zip(more) {
                    *color = L::F::select(keep, (*color + more).max(zero), *color);
                }
            }
            let mut rest = overlapping & !served;
            if rest != 0 {
                let wish = sums.steps();
                for (steps, list) in STEPS.into_iter().zip(&mut out.in_order) {
                    let served = rest & wish.le(L::F::splat(steps as f32)).bits();
                    push(list, served, at);
                    rest &= !served;
                }
                let dense = rest & L::F::splat(DENSE_LEAST).le(sums.total).bits();
                push(&mut out.dense, dense, at);
                unsure |= rest & !dense;
            }
        }
        for (column, value) in out.rgba.iter_mut().zip(rgba) {
            value.store(&mut column[at..]);
        }
        unsure
    }
}

/// Pairwise product of depths up to which a segment's widgets are mixed. Kniss's mix M of what each gives, E, differs by no more
/// than Tᵢ (T − Tᵢ) from it, whatever the order (see `optics::integrators::Adaptive`), and Σ E = Σ M; so a channel's error is under
/// the product times the brightest channel.
fn ordered_from(integrator: &Integrator, transfer_function: &TransferFunction) -> f32 {
    match *integrator {
        Integrator::Adaptive { tolerance } => {
            let brightest = transfer_function.widgets.iter().map(Widget::brightest).fold(0.0, f64::max);
            MIX_PRODUCT.max((tolerance / brightest.max(1.0)) as f32)
        }
        _ => MIX_PRODUCT,
    }
}

/// Appends the places of some lanes (bits) of the vector at `at`.
#[inline(always)]
pub(super) fn push(list: &mut Vec<usize>, mut lanes: u32, at: usize) {
    while lanes != 0 {
        list.push(at + lanes.trailing_zeros() as usize);
        lanes &= lanes - 1;
    }
}

/// Lanes (bits) of the first `count` segments on which widgets overlap.
#[inline(always)]
pub(super) fn overlaps<L: Lanes>(product: L::F, along: &Along<L>, count: usize) -> u32 {
    meant::<L>(L::F::splat(MIX_PRODUCT).lt(product).and(along.crossing), count)
}
