//! Closed-form kernels, which integrate all segments of a batch first. Each is compiled by itself, since the time to compile a function
//! grows with the square of its size.

use crate::fragments::batch::{Batch, meant};
use crate::shade::kinds::{LaneLinear, LaneWidget, OrderRequirement, for_each_active_widget};
use crate::shade::region::Inside;
use crate::shade::segment_lanes::SegmentLanes;
use crate::shade::shaded_batch::{MIN_THICK_DEPTH, MIX_PRODUCT, STEPS, ShadedBatch};
use voltet_optics::WidgetBlend;
use voltet_simd::optics::gaussian::Near;
use voltet_simd::optics::smooth::{Sums, Term};
use voltet_simd::{Float, Kernel, Lanes, Mask, inlined, mask_of};

/// The first `count` segments of a batch, attribute by attribute. Lengths are in scene lengths, values as stored.
#[derive(Clone, Copy)]
pub struct SegmentBatch<'a> {
    pub(super) widgets: &'a [LaneWidget],
    /// True if only optical depths are computed.
    pub(super) one_color: bool,
    pub(super) batch: &'a Batch,
    pub(super) count: usize,
}

/// Appends the indices of some lanes (bits) of the vector at `at`.
#[inline(always)]
pub(crate) fn push(list: &mut Vec<usize>, mut lanes: u32, at: usize) {
    while lanes != 0 {
        list.push(at + lanes.trailing_zeros() as usize);
        lanes &= lanes - 1;
    }
}

/// Lanes (bits) of the first `count` segments on which widgets overlap.
#[inline(always)]
pub(crate) fn overlaps<L: Lanes>(product: L::F, segments: &SegmentLanes<L>, count: usize) -> u32 {
    meant::<L>(L::F::splat(MIX_PRODUCT).lt(product).and(segments.crossing), count)
}

/// One piecewise-linear widget: its integrals give the colour, too.
pub(crate) struct SinglePiecewise<'a> {
    pub linear: &'a LaneLinear,
    pub range: SegmentBatch<'a>,
    pub out: &'a mut ShadedBatch,
}

impl Kernel for SinglePiecewise<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let SinglePiecewise { linear, range: SegmentBatch { batch, count, .. }, out } = self;
        let tables = linear.tables::<L>();
        for at in (0..count).step_by(L::WIDTH) {
            let segments = SegmentLanes::<L>::load(batch, at);
            let (rgba, [deep, unsure]) = tables.integrate::<false>(&segments);
            for (column, value) in out.rgba.iter_mut().zip(rgba) {
                value.store(&mut column[at..]);
            }
            let meant = meant::<L>(segments.crossing, count - at);
            out.evaluation_count += u64::from(meant.count_ones());
            push(&mut out.thick_pieces, deep & !unsure & meant, at);
            push(&mut out.fallback_queue, unsure & meant, at);
        }
    }
}

/// Widgets of one colour: optical depths add up, whatever the order.
pub(crate) struct OneColor<'a> {
    pub range: SegmentBatch<'a>,
    pub out: &'a mut ShadedBatch,
}

impl Kernel for OneColor<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let OneColor { range: SegmentBatch { widgets, batch, count, .. }, out } = self;
        let zero = L::F::splat(0.0);
        for at in (0..count).step_by(L::WIDTH) {
            let segments = SegmentLanes::<L>::load(batch, at);
            let meant = meant::<L>(segments.crossing, count - at);
            let (mut total, mut product, mut unsure) = (zero, zero, 0);
            let asked = for_each_active_widget(
                widgets,
                &segments,
                inlined!(|_, widget: &LaneWidget, meets: L::M| {
                    let (depth, no) = widget.depth::<L>(&segments.only(meets));
                    let depth = L::F::select(meets, depth, zero);
                    unsure |= no & meets.bits();
                    product = depth.mul_add(total, product);
                    total = total + depth;
                }),
            );
            if widgets.len() > 1 {
                let overlapping = overlaps::<L>(product, &segments, count - at);
                out.overlap_count += u64::from(overlapping.count_ones());
            }
            total.store(&mut out.depth[at..]);
            out.evaluation_count += u64::from((asked & meant).count_ones());
            push(&mut out.fallback_queue, unsure & meant, at);
        }
    }
}

/// One widget or more whose colour does not vary along the segment. Segments for slower kernels are queued.
pub(crate) struct Several<'a> {
    pub overlap: WidgetBlend,
    /// Pairwise product of depths from which on the order of widgets counts.
    pub ordered_from: f32,
    pub range: SegmentBatch<'a>,
    pub out: &'a mut ShadedBatch,
}

/// Gaussian whose support a vector of segments meets, before its mean is evaluated.
#[derive(Clone, Copy)]
struct PendingGaussian<L: Lanes> {
    near: Near<L>,
    /// Fraction of each segment inside its region, and the segments that the region cuts.
    share: L::F,
    cut: L::M,
    meets: L::M,
    number: usize,
}

impl Kernel for Several<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Several { overlap, ordered_from, range: SegmentBatch { widgets, batch, count, .. }, out } = self;
        let zero = L::F::splat(0.0);
        let nowhere = zero.lt(zero);
        let mut pending = vec![
            PendingGaussian::<L> {
                near: Near::none(),
                share: zero,
                cut: nowhere,
                meets: nowhere,
                number: 0
            };
            widgets.len()
        ];
        let mut terms = vec![Term::<L>::none(); widgets.len()];
        for at in (0..count).step_by(L::WIDTH) {
            let segments = SegmentLanes::<L>::load(batch, at);
            let meant = meant::<L>(segments.crossing, count - at);
            let (mut sums, mut gaussians, mut met, mut unsure) = (Sums::<L>::none(), 0, 0, 0);
            let asked = for_each_active_widget(
                widgets,
                &segments,
                inlined!(|number, widget: &LaneWidget, meets: L::M| {
                    if let Some(gaussian) = widget.gaussian() {
                        unsure |= gaussian.unsure(&segments) & meets.bits();
                        let Inside { front, back, share, cut } = widget.inside(&segments.only(meets));
                        let near = gaussian.near(&front, &back);
                        pending[gaussians] = PendingGaussian { near, share, cut, meets, number };
                        gaussians += 1;
                        return;
                    }
                    let (mut shape, no) = widget.shape::<L>(&segments.only(meets));
                    shape.depth = L::F::select(meets, shape.depth, zero);
                    unsure |= no & meets.bits();
                    if widget.traits().order == OrderRequirement::Always {
                        unsure |= zero.lt(shape.depth).bits();
                    }
                    sums.add(&shape, widget.color, &mut terms[met]);
                    met += 1;
                }),
            );
            // One loop after the other: a mean is a long chain of operations, and of two loops a processor has several in hand.
            for &PendingGaussian { near, share, cut, meets, number } in &pending[..gaussians] {
                let widget = &widgets[number];
                let Some(gaussian) = widget.gaussian() else { continue };
                let mut shape = near.shape(
                    L::F::splat(widget.density()) * segments.length * share,
                    meets,
                    inlined!(|| {
                        let Inside { front, back, .. } = widget.inside(&segments.only(meets));
                        gaussian.path(&front, &back)
                    }),
                );
                shape = shape.cut(cut);
                shape.depth = L::F::select(meets, shape.depth, zero);
                sums.add(&shape, widget.color, &mut terms[met]);
                met += 1;
            }
            let terms = &terms[..met];
            let overlapping = overlaps::<L>(sums.product, &segments, count - at);
            out.overlap_count += u64::from(overlapping.count_ones());
            out.evaluation_count += u64::from((asked & meant).count_ones());
            let overlapping = overlapping & !unsure & L::F::splat(ordered_from).lt(sums.product).bits();
            let mut served = 0;
            if overlap == WidgetBlend::Exact && overlapping != 0 {
                served = overlapping & sums.is_smooth(terms).bits();
                let mut rest = overlapping & !served;
                if rest != 0 {
                    let wanted = sums.steps(terms);
                    for (steps, list) in STEPS.into_iter().zip(&mut out.quadrature_queues) {
                        let served = rest & wanted.le(L::F::splat(steps as f32)).bits();
                        push(list, served, at);
                        rest &= !served;
                    }
                    let dense = rest & L::F::splat(MIN_THICK_DEPTH).le(sums.total).bits();
                    push(&mut out.optically_thick, dense, at);
                    unsure |= rest & !dense;
                }
            }
            let rgba =
                if served == 0 { sums.mixed(terms) } else { sums.ordered(terms, mask_of::<L>(served)) };
            for (column, value) in out.rgba.iter_mut().zip(rgba) {
                value.store(&mut column[at..]);
            }
            push(&mut out.fallback_queue, unsure & meant, at);
        }
    }
}
