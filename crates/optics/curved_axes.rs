//! Segments along curved axes: cut into pieces on which positions are as good as linear.
//!
//! On a ray's way through a cell s and g are linear in t, so that their positions on a logarithmic axis are u(t) = log₁₀(s_f + t (s_b − s_f)),
//! which the closed forms along straight paths do not hold for. A piece of ratio r = s₁/s₀ is replaced by two straight ones of half its
//! length, with their common end so that the mean of u over both is that of u(t) by Simpson's rule. What is left is within h²/24 of u,
//! h = ln r, and of mean 0: a profile that is linear over the piece is integrated exactly, and one of width w to a share of some
//! (h²/50 w)² of its peak. So h is a share of √w. Where a profile jumps on an axis, a piece ends.

use crate::special::opacity;
use crate::{Contribution, Segment};
use voltet_core::transfer::{
    AxisScale, ColorSource, ControlPoint, DECADES, Region, TransferFunction, Widget,
};

/// h/√w: errors of a segment stay below 1e-4 of its light, and mostly below 1e-5.
const STEP: f64 = 0.25;

/// Steps by which edges of what glows evenly, which lie anywhere, are met more sharply.
const STEP_AT_CUTOFFS: f64 = 0.025;

/// Share of a step over which one straight piece is as good.
pub const STRAIGHT: f64 = 0.03;

/// Change of slope, in shares of the peak a decade, that needs no end of a piece.
const SLIGHT_BEND: f64 = 0.2;

/// Share of a widget's peak that is not drawn: less than what optical depths of 1e12 show.
const FAINT: f64 = 1e-20;

/// Share of a segment's largest value below which none has a position on a logarithmic axis: 10^−[`DECADES`].
const MIN_SHARE: f64 = 1e-30;

/// The widest that counts as a width, and the narrowest, in decades.
const WIDTHS: [f64; 2] = [1e-6, 3.0];

/// A straight piece of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightPiece {
    /// Shares of the segment's length at which it begins and ends.
    pub shares: [f64; 2],
    /// Positions of s and g at its front and its back.
    pub ends: [[f64; 2]; 2],
}

/// Curved axes of a transfer function.
#[derive(Debug, Clone)]
pub struct CurvedAxes {
    axes: [CurvedAxis; 2],
}

#[derive(Debug, Clone)]
struct CurvedAxis {
    scale: AxisScale,
    /// The narrowest width of a profile, in positions.
    width: f64,
    /// Least and greatest value of which anything is drawn.
    drawn: [f64; 2],
    /// Positions between which profiles change, so that steps are needed.
    changing: [f64; 2],
    /// Longest step of a pair of pieces, in positions.
    step: f64,
    /// Values at which profiles jump, and their positions, ascending.
    jumps: Vec<[f64; 2]>,
}

impl CurvedAxes {
    /// Axes of a transfer function; none where they are straight.
    pub fn new(transfer_function: &TransferFunction) -> Option<CurvedAxes> {
        let axis = |number: usize| {
            let scale = transfer_function.axes_read()[number];
            let widgets = &transfer_function.widgets;
            let least = |of: fn(&Widget, usize) -> f64| {
                widgets.iter().map(|widget| of(widget, number)).fold(WIDTHS[1], f64::min).max(WIDTHS[0])
            };
            let width = least(profile_width);
            let resolved = width.min(least(edge_width));
            let mut positions: Vec<f64> = widgets.iter().flat_map(|widget| jumps(widget, number)).collect();
            positions.sort_by(f64::total_cmp);
            positions.dedup();
            // The step is a share of √(w ln 10) in natural logarithms.
            let ten = std::f64::consts::LN_10;
            let jumps = positions.into_iter().map(|u| [scale.value(u), u]).collect();
            let share = if transfer_function.model.cutoff().is_some() { STEP_AT_CUTOFFS } else { STEP };
            let drawn = transfer_function.positions_drawn(number, FAINT, |_| true).map(|u| scale.value(u));
            let changes =
                |widget: &Widget| profile_width(widget, number).min(edge_width(widget, number)).is_finite();
            let changing = transfer_function.positions_drawn(number, FAINT, changes);
            CurvedAxis { scale, width, drawn, changing, step: share * (resolved * ten).sqrt() / ten, jumps }
        };
        transfer_function.has_curved_axes().then(|| CurvedAxes { axes: [axis(0), axis(1)] })
    }

    /// Scale of an axis.
    pub fn scale(&self, axis: usize) -> AxisScale {
        self.axes[axis].scale
    }

    /// The narrowest width of a profile along an axis, in positions.
    pub fn width(&self, axis: usize) -> f64 {
        self.axes[axis].width
    }

    /// Least and greatest value on an axis of which anything is drawn.
    pub fn drawn(&self, axis: usize) -> [f64; 2] {
        self.axes[axis].drawn
    }

    /// Positions on an axis between which profiles change; elsewhere there are no steps.
    pub fn changing(&self, axis: usize) -> [f64; 2] {
        self.axes[axis].changing
    }

    /// Longest step of a pair of pieces along an axis, in positions.
    pub fn step(&self, axis: usize) -> f64 {
        self.axes[axis].step
    }

    /// Values at which profiles jump on an axis, and their positions, ascending.
    pub fn jumps(&self, axis: usize) -> &[[f64; 2]] {
        &self.axes[axis].jumps
    }

    /// Calls `put` with the pieces of a segment, front to back; parts without a position are left out. `front`, `back`: s and g. `cuts`:
    /// scratch memory.
    pub fn cut(
        &self,
        front: [f64; 2],
        back: [f64; 2],
        cuts: &mut Vec<AxisCut>,
        mut put: impl FnMut(StraightPiece),
    ) {
        let mut range = [0.0, 1.0];
        for (axis, ends) in self.axes.iter().zip([[front[0], back[0]], [front[1], back[1]]]) {
            axis.limit(ends, &mut range);
        }
        let [from, to] = range;
        if from >= to {
            return;
        }
        cuts.clear();
        let line = |share: f64, axis: usize| front[axis] + share * (back[axis] - front[axis]);
        // Where a range begins or ends at the least position, its value may have been rounded below.
        let least = [0, 1].map(|axis| self.axes[axis].least_position([front[axis], back[axis]]));
        let end_at = |share: f64| {
            [0, 1].map(|axis| self.axes[axis].scale.position(line(share, axis)).max(least[axis]))
        };
        let (mut first, end) = (end_at(from), end_at(to));
        for (number, axis) in self.axes.iter().enumerate() {
            let positions = [first[number], end[number]];
            axis.add_cuts(number, [front[number], back[number]], range, positions, cuts);
        }
        cuts.sort_by(|a, b| a.share.total_cmp(&b.share));
        let mut begin = from;
        for &cut in cuts.iter() {
            let mut last = end_at(cut.share);
            last[cut.axis] = cut.position;
            if begin < cut.share {
                self.pair([begin, cut.share], [first, last], line, &mut put);
            }
            (begin, first) = (cut.share, last);
        }
        self.pair([begin, to], [first, end], line, &mut put);
    }

    /// One straight piece, or two.
    fn pair(
        &self,
        [from, to]: [f64; 2],
        [first, last]: [[f64; 2]; 2],
        line: impl Fn(f64, usize) -> f64,
        put: &mut impl FnMut(StraightPiece),
    ) {
        let is_short = |axis: usize| {
            let CurvedAxis { scale, step, .. } = &self.axes[axis];
            *scale == AxisScale::Linear || (last[axis] - first[axis]).abs() <= STRAIGHT * step
        };
        if is_short(0) && is_short(1) {
            return put(StraightPiece { shares: [from, to], ends: [first, last] });
        }
        let middle = 0.5 * (from + to);
        let between = [0, 1].map(|axis| match self.axes[axis].scale {
            AxisScale::Linear => 0.5 * (first[axis] + last[axis]),
            scale => {
                let (u, [a, b]) = (scale.position(line(middle, axis)), [first[axis], last[axis]]);
                // Over many decades, where nothing changes, not beyond the ends.
                (u + (2.0 * u - a - b) / 6.0).clamp(a.min(b), a.max(b))
            }
        });
        put(StraightPiece { shares: [from, middle], ends: [first, between] });
        put(StraightPiece { shares: [middle, to], ends: [between, last] });
    }
}

/// The contribution of a cell's crossing, whose values vary linearly from front to back, by an integral of segments between positions.
/// `axes`: none where these are the values.
pub fn integrate_values(
    axes: Option<&CurvedAxes>,
    crossing: &Segment,
    mut integrate: impl FnMut(&Segment) -> Contribution,
) -> Contribution {
    if axes.is_none() {
        return integrate(crossing);
    }
    let mut sum = Contribution::default();
    each_segment(axes, crossing, |segment| {
        let part = integrate(segment);
        let light = (-sum.optical_depth).exp();
        sum.color.iter_mut().zip(part.color).for_each(|(sum, color)| *sum += light * color);
        sum.optical_depth += part.optical_depth;
    });
    Contribution { opacity: opacity(sum.optical_depth), ..sum }
}

/// Calls `each` with the segments of a crossing: itself, or pieces along curved axes, front to back.
pub(super) fn each_segment(axes: Option<&CurvedAxes>, crossing: &Segment, mut each: impl FnMut(&Segment)) {
    let Some(axes) = axes else { return each(crossing) };
    axes.cut(crossing.front, crossing.back, &mut Vec::new(), |StraightPiece { shares, ends }| {
        let fields = shares.map(|share| {
            let ends = crossing.fields_front.iter().zip(crossing.fields_back);
            ends.map(|(front, back)| front + share * (back - front)).collect::<Vec<f64>>()
        });
        each(&Segment {
            length: crossing.length * (shares[1] - shares[0]),
            front: ends[0],
            back: ends[1],
            fields_front: &fields[0],
            fields_back: &fields[1],
        });
    });
}

/// Cut of a segment at which a position is known.
#[derive(Debug, Clone, Copy)]
pub struct AxisCut {
    share: f64,
    /// The axis of the position.
    axis: usize,
    position: f64,
}

impl CurvedAxis {
    /// The least position that counts between two values.
    fn least_position(&self, [front, back]: [f64; 2]) -> f64 {
        let largest = front.max(back);
        match self.scale {
            // Only values so small reach it.
            AxisScale::Log if front.min(back) < 10.0 * MIN_SHARE * largest => {
                self.scale.position(largest) - DECADES
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// Narrows the shares of a segment to those at which the axis has positions and anything is drawn. `ends`: values at its front and back.
    fn limit(&self, [front, back]: [f64; 2], range: &mut [f64; 2]) {
        let [mut low, high] = self.drawn;
        match self.scale {
            AxisScale::Linear => return,
            AxisScale::Log => low = low.max(MIN_SHARE * front.max(back)).max(f64::MIN_POSITIVE),
            AxisScale::SymLog { .. } => {}
        }
        if !(front.max(back) >= low && front.min(back) <= high) {
            *range = [1.0, 0.0];
            return;
        }
        let mut cut = |bound: f64, [front_is_beyond, back_is_beyond]: [bool; 2]| {
            if front_is_beyond {
                range[0] = range[0].max((bound - front) / (back - front));
            } else if back_is_beyond {
                range[1] = range[1].min((front - bound) / (front - back));
            }
        };
        cut(low, [front, back].map(|value| value < low));
        cut(high, [front, back].map(|value| value > high));
    }

    /// Adds the cuts within a range of shares: at jumps, and so that no step is longer than allowed. `ends`: values at the segment's front
    /// and back; `positions`: those at the range's.
    fn add_cuts(
        &self,
        axis: usize,
        [front, back]: [f64; 2],
        [from, to]: [f64; 2],
        positions: [f64; 2],
        cuts: &mut Vec<AxisCut>,
    ) {
        if self.scale == AxisScale::Linear {
            return;
        }
        let mut add = |value: f64, position: f64| {
            let share = (value - front) / (back - front);
            if from < share && share < to {
                cuts.push(AxisCut { share, axis, position });
            }
        };
        let (low, high) = (front.min(back), front.max(back));
        let first = self.jumps.partition_point(|jump| jump[0] <= low);
        for [value, position] in self.jumps[first..].iter().take_while(|jump| jump[0] < high) {
            add(*value, *position);
        }
        let [first, last] = self.changing;
        if first > last {
            return;
        }
        let [begin, end] = positions.map(|position| position.clamp(first, last));
        let count = ((end - begin).abs() / self.step).ceil().max(1.0);
        // The range ends where it does.
        let inner = [begin == positions[0], end == positions[1]].map(usize::from);
        for k in inner[0]..=count as usize - inner[1] {
            let position = begin + (end - begin) * (k as f64 / count);
            add(self.scale.value(position), position);
        }
    }
}

/// Width of a widget's profile along an axis, in positions: over which it changes by about its peak.
fn profile_width(widget: &Widget, axis: usize) -> f64 {
    let properties = widget.profile.properties();
    widget.profile.width(axis).min(match properties.color {
        ColorSource::Points(points) if axis == 0 => {
            let slopes = slopes(points).into_iter().flatten().filter(|slope| slope.is_finite());
            0.4 / slopes.map(f64::abs).fold(0.0, f64::max)
        }
        ColorSource::Widget | ColorSource::Texels(_) | ColorSource::Points(_) => f64::INFINITY,
    })
}

/// Width that edges aslant count as. Paths that cross one at a small angle do so elsewhere by the pieces' distance from them over that angle: the
/// widest difference that was found in pictures is 6e-5 of a segment's light, ten times less than with tenfold widths.
fn edge_width(widget: &Widget, axis: usize) -> f64 {
    match &widget.region {
        Some(region) if !region.is_rectangle() => 0.0005 * spread(region, axis),
        _ => f64::INFINITY,
    }
}

fn spread(region: &Region, axis: usize) -> f64 {
    let [low, high] = region.limits(axis);
    high - low
}

/// Rise of a piecewise-linear function per unit of s: of extinction, and of colours, by their largest.
fn slopes(points: &[ControlPoint]) -> Vec<[f64; 4]> {
    let most = |of: &dyn Fn(&ControlPoint) -> f64| points.iter().map(of).fold(f64::MIN_POSITIVE, f64::max);
    let densest = most(&|point| point.extinction);
    let brightest = most(&|point| point.color.into_iter().fold(0.0, f64::max));
    let slope = |pair: &[ControlPoint]| {
        let along = pair[1].s - pair[0].s;
        let color = |k: usize| (pair[1].color[k] - pair[0].color[k]) / brightest / along;
        [(pair[1].extinction - pair[0].extinction) / densest / along, color(0), color(1), color(2)]
    };
    points.windows(2).map(slope).collect()
}

/// Control points at which the function jumps or bends so much that a straight piece must end there.
fn bends(points: &[ControlPoint]) -> Vec<f64> {
    let mut slopes = slopes(points);
    slopes.insert(0, [0.0; 4]);
    slopes.push([0.0; 4]);
    let bend = |pair: &[[f64; 4]]| (0..4).map(|k| (pair[1][k] - pair[0][k]).abs()).fold(0.0, f64::max);
    let found = points.iter().zip(slopes.windows(2));
    // Infinite where two points have one place.
    found.filter(|(_, pair)| bend(pair) >= SLIGHT_BEND).map(|(point, _)| point.s).collect()
}

/// Positions on an axis at which a widget jumps, or bends sharply.
fn jumps(widget: &Widget, axis: usize) -> Vec<f64> {
    let properties = widget.profile.properties();
    let limits = |region: &Region| region.limits(axis);
    let mut found: Vec<f64> =
        widget.region.iter().chain(&properties.range).flat_map(limits).filter(|u| u.is_finite()).collect();
    if let (ColorSource::Points(points), 0) = (properties.color, axis) {
        found.extend(bends(points));
    }
    found
}
