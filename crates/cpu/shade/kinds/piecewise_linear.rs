//! A piecewise-linear widget in lanes: a segment is cut at the control points it crosses, and each piece has
//! linear extinction and colour, integrated without sampling error (Moreland & Angel 2004; Roettger & Ertl 2002
//! sample the same thing into a table).

use crate::attribute::Attribute;
use crate::shade::segment_lanes::SegmentLanes;
use voltet_core::transfer::ControlPoint;
use voltet_simd::optics::elementary::one_minus_exp;
use voltet_simd::optics::linear::{
    DEEPEST, MIDDLING, deep_piece_weights, middling_piece_weights, piece_weights,
};
use voltet_simd::optics::piecewise_linear::LanePoints;
use voltet_simd::{Float, Lanes, Mask, array, inlined};

/// Most control points a lane table holds; longer functions use the gathers.
const MAX_TABLE_SIZE: usize = 1024;

/// Interval k lies below control point k: interval 0 before the first, interval n beyond the last.
pub(crate) struct LaneLinear {
    count: usize,
    /// Control points, scaled; then +∞ up to a whole vector.
    points: Vec<f32>,
    /// Anchor of interval k's line, its value there and its slope: extinction (per scene length), r, g, b.
    anchor: Vec<f32>,
    value: [Vec<f32>; 4],
    slope: [Vec<f32>; 4],
    /// Anchors for the walk in panels: s counts from the first point.
    pub points_from_first: LanePoints,
    /// The first point, scaled.
    pub first: f32,
    /// Largest extinction.
    pub peak: f32,
}

impl LaneLinear {
    /// `None` if the widget has too many points or its numbers leave 32 bits.
    pub fn new(
        points: &[ControlPoint],
        axis: &Attribute<'_>,
        density_scale: f64,
        cutoff: Option<f64>,
    ) -> Option<LaneLinear> {
        let n = points.len();
        if n == 0 || n > MAX_TABLE_SIZE {
            return None;
        }
        let scaled = |s: f64| (s - axis.offset) / axis.scale;
        let quantities =
            |p: &ControlPoint| [p.extinction * density_scale, p.color[0], p.color[1], p.color[2]];
        let size = (n + 1).next_multiple_of(16);
        let column = || vec![0f32; size];
        let mut linear = LaneLinear {
            count: n,
            points: vec![f32::INFINITY; size],
            anchor: column(),
            value: std::array::from_fn(|_| column()),
            slope: std::array::from_fn(|_| column()),
            points_from_first: LanePoints::new(
                &points.iter().map(|p| ControlPoint { s: scaled(p.s), ..*p }).collect::<Vec<_>>(),
                cutoff,
            ),
            first: scaled(points[0].s) as f32,
            peak: points.iter().fold(0.0, |peak: f64, p| p.extinction.max(peak)) as f32,
        };
        for (k, point) in points.iter().enumerate() {
            linear.points[k] = scaled(point.s) as f32;
        }
        for k in 0..=n {
            let low = &points[k.saturating_sub(1)];
            let high = &points[k.min(n - 1)];
            let (s0, s1) = (linear.points[k.saturating_sub(1)], linear.points[k.min(n - 1)]);
            linear.anchor[k] = s0;
            for (i, (a, b)) in quantities(low).into_iter().zip(quantities(high)).enumerate() {
                linear.value[i][k] = a as f32;
                linear.slope[i][k] = if s1 > s0 { ((b - a) / f64::from(s1 - s0)) as f32 } else { 0.0 };
            }
        }
        let finite = linear.value.iter().chain(&linear.slope).flatten().all(|x| x.is_finite());
        (finite && linear.points[..n].iter().all(|s| s.is_finite())).then_some(linear)
    }

    /// Interval of each value: the number of control points at or below it.
    #[inline(always)]
    fn interval<L: Lanes>(&self, s: L::F) -> L::F {
        let mut k = L::F::splat(0.0);
        for &point in &self.points[..self.count] {
            k = L::F::select(L::F::splat(point).le(s), k + L::F::splat(1.0), k);
        }
        k
    }

    /// The tables as far as one vector holds them.
    #[inline(always)]
    pub fn tables<L: Lanes>(&self) -> Tables<'_, L> {
        Tables {
            linear: self,
            points: L::F::load(&self.points),
            anchor: L::F::load(&self.anchor),
            value: array!(|i| L::F::load(&self.value[i])),
            slope: array!(|i| L::F::load(&self.slope[i])),
        }
    }

    /// Extinction per scene length and colour at s.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, s: L::F) -> [L::F; 4] {
        let tables = self.tables::<L>();
        let k = self.interval::<L>(s).to_unsigned();
        let offset = s - tables.anchor(k);
        array!(|quantity| tables.at(quantity, k, offset).max(L::F::splat(0.0)))
    }

    #[inline(always)]
    pub fn depth<L: Lanes>(&self, segments: &SegmentLanes<L>) -> L::F {
        let tables = self.tables::<L>();
        let mut depth = L::F::splat(0.0);
        tables.walk(
            segments,
            inlined!(|k, from, to, share| {
                let anchor = tables.anchor(k);
                let middle = (from - anchor + (to - anchor)) * L::F::splat(0.5);
                depth =
                    (tables.at(0, k, middle).max(L::F::splat(0.0)) * share).mul_add(segments.length, depth);
            }),
        );
        depth
    }
}

/// Contents of a [`LaneLinear`], in registers where one vector holds each table.
pub(crate) struct Tables<'a, L: Lanes> {
    linear: &'a LaneLinear,
    points: L::F,
    anchor: L::F,
    value: [L::F; 4],
    slope: [L::F; 4],
}

impl<L: Lanes> Tables<'_, L> {
    #[inline(always)]
    fn look_up(&self, held: L::F, table: &[f32], k: L::U) -> L::F {
        if self.linear.count < L::WIDTH {
            held.permute(k)
        } else {
            // Intervals are 0 … count, and tables hold more than that.
            L::F::gather(table, k)
        }
    }

    #[inline(always)]
    fn anchor(&self, k: L::U) -> L::F {
        self.look_up(self.anchor, &self.linear.anchor, k)
    }

    #[inline(always)]
    fn at(&self, quantity: usize, k: L::U, offset: L::F) -> L::F {
        let LaneLinear { slope, value, .. } = self.linear;
        self.look_up(self.slope[quantity], &slope[quantity], k)
            .mul_add(offset, self.look_up(self.value[quantity], &value[quantity], k))
    }

    /// Walks the pieces front to back; `piece(k, s_from, s_to, share)` gets the interval, the scalar at both ends
    /// and the share of the length.
    #[inline(always)]
    fn walk(&self, segments: &SegmentLanes<L>, mut piece: impl FnMut(L::U, L::F, L::F, L::F)) {
        let splat = L::F::splat;
        let (front, back) = (segments.front[0], segments.back[0]);
        let (mut k, last) = (self.linear.interval::<L>(front), self.linear.interval::<L>(back));
        let rising = front.lt(back);
        let step = L::F::select(rising, splat(1.0), splat(-1.0));
        let within_one = inlined!(|k: L::F| k.le(last).and(last.le(k)).or(segments.crossing.not()));
        // Most vectors lie within one interval each, and shares of theirs are not asked for.
        let per_scalar = if within_one(k).not().any() {
            splat(1.0) / (back - front).abs().max(splat(f32::MIN_POSITIVE))
        } else {
            splat(0.0)
        };
        let mut from = front;
        let mut whole = splat(1.0);
        // As many rounds as there are intervals: ends that are not numbers never meet.
        for _ in 0..=self.linear.count {
            let ends = within_one(k);
            let index = k.to_unsigned();
            if ends.not().bits() == 0 {
                // A segment within one interval has share 1 exactly, also when its ends coincide.
                piece(index, from, back, whole);
                return;
            }
            // The next control point on the way: k when rising, k − 1 when falling.
            let next = L::F::select(rising, k, (k - splat(1.0)).max(splat(0.0))).to_unsigned();
            let limit = self.look_up(self.points, &self.linear.points, next);
            let to = L::F::select(ends, back, limit);
            let share = L::F::select(ends, whole, ((to - from).abs() * per_scalar).min(whole));
            piece(index, from, to, share);
            whole = L::F::select(ends, splat(0.0), (whole - share).max(splat(0.0)));
            k = L::F::select(ends, k, (k + step).max(splat(0.0)));
            from = to;
        }
    }

    /// Premultiplied colour and opacity, and the lanes whose colour stays unknown: those with a piece deeper than [`MIDDLING`] where
    /// so few of a vector are that they are better served with others of their kind (never if `DEEP`), and those with one deeper
    /// than the twins serve.
    #[inline(always)]
    pub fn integrate<const DEEP: bool>(&self, segments: &SegmentLanes<L>) -> ([L::F; 4], [u32; 2]) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let mut color = [zero; 3];
        let (mut all, mut through, mut deepest, mut unknown) = (zero, one, zero, 0);
        self.walk(
            segments,
            inlined!(|k, from, to, share| {
                let anchor = self.anchor(k);
                let (from, to) = (from - anchor, to - anchor);
                let length = segments.length * share;
                let a = self.at(0, k, from).max(zero) * length;
                let b = self.at(0, k, to).max(zero) * length;
                let max = a.max(b);
                deepest = deepest.max(max);
                let deep = one.lt(max);
                let (front, back, opacity) = if !deep.any() {
                    piece_weights::<L>(a, b)
                } else {
                    // Each lane by the form that is its own, whatever the others are.
                    let mut weights = [zero; 3];
                    if deep.not().and(zero.lt(max)).any() {
                        let (front, back, opacity) = piece_weights::<L>(a.min(one), b.min(one));
                        weights = [front, back, opacity];
                    }
                    let deeper = splat(MIDDLING).lt(max);
                    let mut take = inlined!(|lanes: L::M, (front, back, opacity): (L::F, L::F, L::F)| {
                        for (weight, own) in weights.iter_mut().zip([front, back, opacity]) {
                            *weight = L::F::select(lanes, own, *weight);
                        }
                    });
                    if deep.and(deeper.not()).any() {
                        take(deep, middling_piece_weights::<L>(a, b));
                    }
                    if !DEEP && deeper.bits().count_ones() < FEW_DEEP * L::WIDTH as u32 / 16 {
                        unknown |= deeper.bits();
                        take(deeper, (zero, zero, one_minus_exp::<L>((a + b) * splat(0.5))));
                    } else {
                        take(deeper, deep_piece_weights::<L>(a, b));
                    }
                    (weights[0], weights[1], weights[2])
                };
                let (front, back) = (front * through, back * through);
                for (i, sum) in color.iter_mut().enumerate() {
                    let near = self.at(i + 1, k, from);
                    let far = self.at(i + 1, k, to);
                    *sum = front.mul_add(near, back.mul_add(far, *sum));
                }
                all = through.mul_add(opacity, all);
                through = through * (one - opacity);
            }),
        );
        ([color[0], color[1], color[2], all], [unknown, splat(DEEPEST).lt(deepest).bits()])
    }
}

/// Lanes of 16 with deep pieces up to which these are integrated in place.
const FEW_DEEP: u32 = 4;

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_simd::{Kernel, LaneSet, dispatch};

    /// Depth, then colour and opacity, of a segment of length 1 for each pair of ends.
    struct Integrals<'a> {
        linear: &'a LaneLinear,
        ends: &'a [[f32; 2]],
        out: &'a mut Vec<[f32; 5]>,
    }

    impl Kernel for Integrals<'_> {
        #[inline(always)]
        fn run<L: Lanes>(self) {
            let splat = L::F::splat;
            for ends in self.ends.chunks_exact(L::WIDTH) {
                let end = |k: usize| L::F::load(&ends.iter().map(|ends| ends[k]).collect::<Vec<_>>());
                let segments = SegmentLanes::<L> {
                    length: splat(1.0),
                    crossing: splat(0.0).lt(splat(1.0)),
                    front: [end(0), splat(0.0)],
                    back: [end(1), splat(0.0)],
                };
                let [r, g, b, a] = self.linear.tables::<L>().integrate::<true>(&segments).0;
                let mut columns = [[0f32; 16]; 5];
                for (column, value) in columns.iter_mut().zip([self.linear.depth::<L>(&segments), r, g, b, a])
                {
                    value.store(column);
                }
                self.out.extend((0..L::WIDTH).map(|lane| columns.map(|column| column[lane])));
            }
        }
    }

    /// ∫ extinction from the first point to s, constant beyond the ends.
    fn extinction_up_to(points: &[ControlPoint], s: f64) -> f64 {
        let (first, last) = (points[0], points[points.len() - 1]);
        let within: f64 = points
            .windows(2)
            .map(|pair| {
                let to = s.clamp(pair[0].s, pair[1].s) - pair[0].s;
                let slope = (pair[1].extinction - pair[0].extinction) / (pair[1].s - pair[0].s);
                to * (pair[0].extinction + 0.5 * slope * to)
            })
            .sum();
        within + first.extinction * (s - first.s).min(0.0) + last.extinction * (s - last.s).max(0.0)
    }

    /// Tables shorter and longer than a vector are read by different instructions; ends that are no numbers spoil no other
    /// lane, and come to an end.
    #[test]
    fn depths_are_right_for_tables_of_any_length() {
        let axis = Attribute { values: &[], stride: 1, offset: 0.0, scale: 1.0, range: [0.0, 1.0] };
        let mut state = 3u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let awkward = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN];
        for count in (1..=40).chain([1023, MAX_TABLE_SIZE]) {
            let points: Vec<ControlPoint> = (0..count)
                .map(|k| ControlPoint {
                    s: (k as f64 + 0.4 * random()) / count as f64 - 0.5,
                    color: [random(), random(), random()],
                    extinction: random(),
                })
                .collect();
            let linear = LaneLinear::new(&points, &axis, 1.0, None).expect("a table that lanes hold");
            let mut ends: Vec<[f32; 2]> =
                (0..64).map(|_| [1.4 * random() - 0.7, 1.4 * random() - 0.7].map(|s| s as f32)).collect();
            ends[5] = [0.1; 2];
            for (k, end) in awkward.into_iter().enumerate() {
                ends[7 * k + 9][0] = end;
                ends[5 * k + 2][1] = end;
            }
            let steepest = points.windows(2).fold(0.0, |max: f64, pair| {
                max.max((pair[1].extinction - pair[0].extinction).abs() / (pair[1].s - pair[0].s))
            });
            // The scalars are rounded at 2⁻²⁵ of the axis, the sums at as much of their values for each piece.
            let tolerance = (steepest + count as f64) * 2f64.powi(-23);
            for lanes in LaneSet::ALL {
                if !lanes.is_supported() {
                    continue;
                }
                let mut out = Vec::new();
                dispatch(lanes, Integrals { linear: &linear, ends: &ends, out: &mut out });
                for (found, ends) in out.iter().zip(&ends) {
                    // Where a number is no number, or so large that products are none.
                    let [front, back] = ends.map(f64::from);
                    if !(front.abs() < 1.0 && back.abs() < 1.0) {
                        continue;
                    }
                    let depth = if front == back {
                        let step = 1e-9;
                        (extinction_up_to(&points, back + step) - extinction_up_to(&points, back)) / step
                    } else {
                        (extinction_up_to(&points, back) - extinction_up_to(&points, front)) / (back - front)
                    };
                    let [depth_found, .., opacity] = found.map(f64::from);
                    let case = format!("{count} points, {front} to {back} on {}", lanes.name());
                    assert!((depth_found - depth).abs() <= tolerance, "{depth_found} for {depth}: {case}");
                    let expected = -(-depth).exp_m1();
                    assert!(
                        (opacity - expected).abs() <= tolerance,
                        "opacity {opacity} for {expected}: {case}"
                    );
                }
            }
        }
    }
}
