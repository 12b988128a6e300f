//! The quick forms: what serves a scene's segments first.
//!
//! Each is a kernel of its own: what a compiler takes for a function grows with the square of its size, so that all of them in
//! one took ten times as long.

use crate::fragments::batch::{Batch, meant};
use crate::shade::along::{Along, lanes_of};
use crate::shade::kinds::{InOrder, LaneLinear};
use crate::shade::reach::Spread;
use crate::shade::shaded::{DENSE_LEAST, Shaded};
use crate::shade::shader::{Shader, overlaps, push};
use crate::shade::stepped::STEPS;
use voltet_core::optics::Overlap;
use voltet_lanes::optics::sums::Sums;
use voltet_lanes::{Float, Kernel, Lanes, Mask};

/// One widget of pieces: its integrals give the colour, too.
pub(super) struct Alone<'a> {
    pub points: &'a LaneLinear,
    pub batch: &'a Batch,
    pub count: usize,
    pub out: &'a mut Shaded,
}

impl Kernel for Alone<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Alone { points, batch, count, out } = self;
        let tables = points.tables::<L>();
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
pub(super) struct OneColor<'a> {
    pub shader: &'a Shader,
    pub batch: &'a Batch,
    pub count: usize,
    pub out: &'a mut Shaded,
}

impl Kernel for OneColor<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let OneColor { shader, batch, count, out } = self;
        let (zero, widgets) = (L::F::splat(0.0), &shader.widgets);
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            let meant = meant::<L>(along.crossing, count - at);
            let (mut total, mut product, mut unsure, mut asked) = (zero, zero, 0, 0);
            let spread = Spread::new(&along);
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
pub(super) struct Several<'a> {
    pub shader: &'a Shader,
    pub batch: &'a Batch,
    pub count: usize,
    pub out: &'a mut Shaded,
}

impl Kernel for Several<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Several { shader, batch, count, out } = self;
        let (zero, widgets) = (L::F::splat(0.0), &shader.widgets);
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            let meant = meant::<L>(along.crossing, count - at);
            let (mut sums, mut unsure, mut asked) = (Sums::<L>::none(), 0, 0);
            let spread = Spread::new(&along);
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
            let overlapping = overlaps::<L>(sums.product, &along, count - at);
            out.overlap_count += u64::from(overlapping.count_ones());
            out.evaluation_count += u64::from((asked & meant).count_ones());
            let mut rgba = sums.mixed();
            let overlapping =
                overlapping & !unsure & L::F::splat(shader.ordered_from).lt(sums.product).bits();
            if shader.overlap == Overlap::Exact && overlapping != 0 {
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
            push(&mut out.rest, unsure & meant, at);
        }
    }
}
