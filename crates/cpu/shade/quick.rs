//! The quick forms: what serves the segments of closed forms first.

use crate::fragments::batch::meant;
use crate::shade::along::Along;
use crate::shade::kinds::{InOrder, LaneLinear, each_met};
use crate::shade::roads::{Form, Part};
use crate::shade::shaded::{DENSE_LEAST, STEPS, Shaded};
use crate::shade::shader::{overlaps, push};
use voltet_optics::WidgetBlend;
use voltet_simd::optics::gaussian::Near;
use voltet_simd::optics::sums::{Sums, Term};
use voltet_simd::{Float, Lanes, Mask, mask_of};

/// One widget of pieces: its integrals give the colour, too.
impl Form for LaneLinear {
    #[inline(always)]
    fn shade<L: Lanes>(&self, Part { batch, count, .. }: Part<'_>, out: &mut Shaded) {
        let tables = self.tables::<L>();
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            let (rgba, [deep, unsure]) = tables.integrate::<false>(&along);
            for (column, value) in out.rgba.iter_mut().zip(rgba) {
                value.store(&mut column[at..]);
            }
            let meant = meant::<L>(along.crossing, count - at);
            out.evaluation_count += u64::from(meant.count_ones());
            push(&mut out.deep, deep & !unsure & meant, at);
            push(&mut out.rest, unsure & meant, at);
        }
    }
}

/// Widgets of one colour: optical depths add up, whatever the order.
pub(crate) struct OneColor;

impl Form for OneColor {
    #[inline(always)]
    fn shade<L: Lanes>(&self, Part { widgets, batch, count, .. }: Part<'_>, out: &mut Shaded) {
        let zero = L::F::splat(0.0);
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            let meant = meant::<L>(along.crossing, count - at);
            let (mut total, mut product, mut unsure) = (zero, zero, 0);
            let asked = each_met(
                widgets,
                &along,
                #[inline(always)]
                |_, widget, meets| {
                    let (depth, no) = widget.depth::<L>(&along.only(meets));
                    let depth = L::F::select(meets, depth, zero);
                    unsure |= no & meets.bits();
                    product = depth.mul_add(total, product);
                    total = total + depth;
                },
            );
            if widgets.len() > 1 {
                let overlapping = overlaps::<L>(product, &along, count - at);
                out.overlap_count += u64::from(overlapping.count_ones());
            }
            total.store(&mut out.depth[at..]);
            out.evaluation_count += u64::from((asked & meant).count_ones());
            push(&mut out.rest, unsure & meant, at);
        }
    }
}

/// Widgets whose colour does not vary along the segment, one or more. Segments that want steps are put where those are.
pub(crate) struct Several {
    pub overlap: WidgetBlend,
    /// See [`super::shader::Shader`].
    pub ordered_from: f32,
}

/// A Gaussian that a vector of segments meets, before its mean is taken.
#[derive(Clone, Copy)]
struct Begun<L: Lanes> {
    near: Near<L>,
    meets: L::M,
    /// Number of the widget.
    number: usize,
}

impl Form for Several {
    #[inline(always)]
    fn shade<L: Lanes>(&self, Part { widgets, batch, count, .. }: Part<'_>, out: &mut Shaded) {
        let zero = L::F::splat(0.0);
        let nowhere = zero.lt(zero);
        let mut begun = vec![Begun::<L> { near: Near::none(), meets: nowhere, number: 0 }; widgets.len()];
        let mut terms = vec![Term::<L>::none(); widgets.len()];
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            let meant = meant::<L>(along.crossing, count - at);
            let (mut sums, mut gaussians, mut met, mut unsure) = (Sums::<L>::none(), 0, 0, 0);
            let asked = each_met(
                widgets,
                &along,
                #[inline(always)]
                |number, widget, meets| {
                    if let Some(gaussian) = widget.whole_gaussian() {
                        unsure |= gaussian.unsure(&along) & meets.bits();
                        begun[gaussians] = Begun { near: gaussian.near(&along), meets, number };
                        gaussians += 1;
                        return;
                    }
                    let (mut shape, no) = widget.shape::<L>(&along.only(meets));
                    shape.depth = L::F::select(meets, shape.depth, zero);
                    unsure |= no & meets.bits();
                    if widget.in_order() == InOrder::Always {
                        unsure |= zero.lt(shape.depth).bits();
                    }
                    sums.add(&shape, widget.color, &mut terms[met]);
                    met += 1;
                },
            );
            // One loop after the other: a mean is a long chain of operations, and of two loops a processor has several in hand.
            for &Begun { near, meets, number } in &begun[..gaussians] {
                let widget = &widgets[number];
                let Some(gaussian) = widget.whole_gaussian() else { continue };
                let mut shape = near.shape(
                    L::F::splat(widget.density()) * along.length,
                    meets,
                    #[inline(always)]
                    || gaussian.path(&along.front, &along.back),
                );
                shape.depth = L::F::select(meets, shape.depth, zero);
                sums.add(&shape, widget.color, &mut terms[met]);
                met += 1;
            }
            let terms = &terms[..met];
            let overlapping = overlaps::<L>(sums.product, &along, count - at);
            out.overlap_count += u64::from(overlapping.count_ones());
            out.evaluation_count += u64::from((asked & meant).count_ones());
            let overlapping = overlapping & !unsure & L::F::splat(self.ordered_from).lt(sums.product).bits();
            let mut served = 0;
            if self.overlap == WidgetBlend::Exact && overlapping != 0 {
                served = overlapping & sums.is_smooth(terms).bits();
                let mut rest = overlapping & !served;
                if rest != 0 {
                    let wish = sums.steps(terms);
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
            let rgba =
                if served == 0 { sums.mixed(terms) } else { sums.ordered(terms, mask_of::<L>(served)) };
            for (column, value) in out.rgba.iter_mut().zip(rgba) {
                value.store(&mut column[at..]);
            }
            push(&mut out.rest, unsure & meant, at);
        }
    }
}
