//! Curved axes of s and g, between what segments hold and what widgets read; and straight pieces of many segments at a time, of those
//! that need two at most.

use crate::attribute::Attribute;
use crate::fragments::batch::Batch;
use voltet_core::transfer::AxisScale;
use voltet_core::transfer::TransferFunction;
use voltet_optics::curved_axes::{CurvedAxes, STRAIGHT};
use voltet_simd::optics::elementary::ln;
use voltet_simd::{Float, Lanes, Mask};

/// Curved axes of s and g, with the scales of what batches hold.
pub(crate) struct LaneAxes {
    pub curved: CurvedAxes,
    /// Value = scale × what is projected, since values of curved axes are counted from 0; of straight ones values and positions are stored
    /// alike.
    values: [f64; 2],
    /// Offset and scale of positions.
    positions: [[f64; 2]; 2],
    /// True if g is among the attributes.
    has_g: bool,
    /// The curved axes in 32 bits; none where that does not resolve the widgets.
    lanes: Option<Vec<LaneAxis>>,
}

/// A curved axis in 32 bits: values and positions as they are stored.
struct LaneAxis {
    /// Number of its attribute.
    axis: usize,
    /// True if it is a symmetric logarithm, which has a position for every value.
    is_symmetric: bool,
    /// Position = unit × ln(factor × value) − offset, or ± unit × ln(1 + factor × |value|) − offset.
    factor: f32,
    unit: f32,
    offset: f32,
    /// Least and greatest value of which anything is drawn.
    drawn: [f32; 2],
    /// Positions between which profiles change.
    changing: [f32; 2],
    /// Longest step of a pair of pieces, in positions.
    step: f32,
    /// Values at which profiles jump.
    jumps: Vec<f32>,
}

/// Positions along a curved axis at the front, the middle and the back of segments; such that one or two straight pieces have their means.
pub(crate) struct LaneEnds<L: Lanes>(pub [L::F; 3]);

/// Segments as straight pieces.
pub(crate) struct LanePieces<L: Lanes> {
    /// True if anything of the segment can be drawn.
    pub is_drawn: L::M,
    /// True if two pieces are enough, and one.
    pub is_pair: L::M,
    pub is_straight: L::M,
    /// Positions on the axes of s and g; none where the axis is straight.
    pub ends: [Option<LaneEnds<L>>; 2],
}

/// Share of the narrowest profile by which positions in 32 bits may be off.
const RESOLVED: f64 = 2e-5;

impl LaneAxis {
    /// An axis; none where 32 bits do not resolve its profiles.
    fn new(curved: &CurvedAxes, axis: usize, value: f64, [offset, scale]: [f64; 2]) -> Option<LaneAxis> {
        let of_scale = curved.scale(axis);
        let unit = std::f64::consts::LOG10_E / scale;
        // Positions of logarithms are counted from the value at the offset, which keeps their digits.
        let (is_symmetric, factor, offset, counted_from) = match of_scale {
            AxisScale::Linear => return None,
            AxisScale::Log => (false, value / of_scale.value(offset), 0.0, offset),
            AxisScale::SymLog { linear_below } => (true, value / linear_below, offset / scale, 0.0),
        };
        let [first, last] = curved.changing(axis);
        let farthest = (first - counted_from).abs().max((last - counted_from).abs()).max(1.0);
        // Roundings of the value, and of its logarithm.
        let rounding = f64::from(f32::EPSILON) * (1.0 + farthest);
        let is_resolved = first > last || rounding <= RESOLVED * curved.width(axis);
        let is_normal = |x: f64| (x as f32).is_normal();
        if !(is_resolved && is_normal(factor) && is_normal(unit)) {
            return None;
        }
        let stored = |position: f64| ((position - counted_from) / scale - offset) as f32;
        Some(LaneAxis {
            axis,
            is_symmetric,
            factor: factor as f32,
            unit: unit as f32,
            offset: offset as f32,
            drawn: curved.drawn(axis).map(|drawn| (drawn / value) as f32),
            changing: [first, last].map(stored),
            step: (curved.step(axis) / scale) as f32,
            jumps: curved.jumps(axis).iter().map(|[jump, _]| (jump / value) as f32).collect(),
        })
    }

    /// Positions of values; undefined for those that have none.
    #[inline(always)]
    fn positions<L: Lanes>(&self, values: L::F) -> L::F {
        let splat = L::F::splat;
        let (factor, unit, offset) = (splat(self.factor), splat(self.unit), splat(self.offset));
        if !self.is_symmetric {
            return ln::<L>(values * factor) * unit;
        }
        let above = ln::<L>(values.abs().mul_add(factor, splat(1.0))) * unit;
        L::F::select(values.lt(splat(0.0)), -above, above) - offset
    }
}

impl LaneAxes {
    /// Axes of a transfer function; none where they are straight. `projected`, `shaded`: attributes as segments and as widgets have them.
    pub fn new(
        transfer_function: &TransferFunction,
        projected: &[Attribute<'_>],
        shaded: &[Attribute<'_>],
    ) -> Option<LaneAxes> {
        let curved = CurvedAxes::new(transfer_function)?;
        let (mut values, mut positions) = ([1.0; 2], [[0.0, 1.0]; 2]);
        for (axis, (from, to)) in projected.iter().zip(shaded).take(2).enumerate() {
            if curved.scale(axis).is_curved() {
                (values[axis], positions[axis]) = (from.scale, [to.offset, to.scale]);
            }
        }
        let curved_axes = (0..projected.len().min(2)).filter(|axis| curved.scale(*axis).is_curved());
        let lanes =
            curved_axes.map(|axis| LaneAxis::new(&curved, axis, values[axis], positions[axis])).collect();
        Some(LaneAxes { curved, values, positions, has_g: projected.len() > 1, lanes })
    }

    /// Straight pieces of the segments of a batch from slot `at` on: as [`CurvedAxes::cut`] has them, of those that need two at most.
    #[inline(always)]
    pub fn pieces<L: Lanes>(&self, batch: &Batch, at: usize) -> LanePieces<L> {
        let splat = L::F::splat;
        let all = splat(0.0).le(splat(0.0));
        let mut pieces =
            LanePieces { is_drawn: all, is_pair: all, is_straight: all, ends: [const { None }; 2] };
        let Some(axes) = &self.lanes else {
            pieces.is_pair = all.not();
            return pieces;
        };
        for axis in axes {
            let front = L::F::load(&batch.front[axis.axis][at..]);
            let back = L::F::load(&batch.back[axis.axis][at..]);
            let (low, high) = (front.min(back), front.max(back));
            let (least, most) = (splat(axis.drawn[0]), splat(axis.drawn[1]));
            pieces.is_drawn = pieces.is_drawn.and(least.le(high)).and(low.le(most));
            let mut is_pair = least.le(low).and(high.le(most));
            if !axis.is_symmetric {
                is_pair = is_pair.and(splat(f32::MIN_POSITIVE).le(low * splat(axis.factor)));
            }
            for jump in &axis.jumps {
                is_pair = is_pair.and(low.lt(splat(*jump)).and(splat(*jump).lt(high)).not());
            }
            let (first, last) = (axis.positions::<L>(front), axis.positions::<L>(back));
            let (from, to) = (first.min(last), first.max(last));
            let (begin, end) = (splat(axis.changing[0]), splat(axis.changing[1]));
            let is_within = begin.le(from).and(to.le(end)).and((to - from).le(splat(axis.step)));
            is_pair = is_pair.and(is_within.or(to.le(begin)).or(end.le(from)));
            let middle = axis.positions::<L>((front + back) * splat(0.5));
            let bent = middle + (middle + middle - first - last) * splat(1.0 / 6.0);
            pieces.is_pair = pieces.is_pair.and(is_pair);
            pieces.is_straight = pieces.is_straight.and((to - from).le(splat(STRAIGHT as f32 * axis.step)));
            pieces.ends[axis.axis] = Some(LaneEnds([first, bent.max(from).min(to), last]));
        }
        pieces
    }

    /// Values at a share of a segment of a batch.
    pub fn at(&self, batch: &Batch, k: usize, share: f64) -> [f64; 2] {
        let value = |axis: usize| {
            let [front, back] = [&batch.front, &batch.back].map(|columns| f64::from(columns[axis][k]));
            self.values[axis] * (front + share * (back - front))
        };
        [value(0), if self.has_g { value(1) } else { 0.0 }]
    }

    /// Positions as widgets read them.
    pub fn stored(&self, position: [f64; 2]) -> [f32; 2] {
        [0, 1].map(|axis| ((position[axis] - self.positions[axis][0]) / self.positions[axis][1]) as f32)
    }
}
