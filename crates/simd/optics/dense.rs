//! Several widgets on one segment that is dense: the ordered integral of [`super::overlap`] where what is seen lies within a small
//! part of the segment.
//!
//! There a t between 0 and 1 tells places apart to 6e-8, so that panels of a millionth would have lengths of few digits. Here each
//! panel begins at 0: a Gaussian keeps its own x at the panel's front, and what is behind is forgotten. The rounding of x shifts
//! all that is seen by as much, whatever the density.

use super::elementary::exp;
use super::overlap::{AnyLaneTrack, LaneMember};
use super::quadrature::{PANEL, POINTS, over_panel, to_nodes};
use crate::{Float, Lanes, Mask};

/// Optical depth beyond which nothing behind is visible (e^(−18) = 1.5e-8).
const OPAQUE_DEPTH: f32 = 18.0;

/// Depth that a panel holds at most: 8 points then leave 1e-7 of e^(−T).
const PANEL_DEPTH: f32 = 2.5;

/// Panels before a walk is given up.
const MAX_PANELS: usize = 256;

/// Distance in t within which the end of a range counts as passed.
const PASSED: f32 = 1e-7;

/// Most rate beside an end of a range: t finds it to 6e-8, so to 6e-5 of depth.
const MAX_RATE_AT_END: f32 = 1e3;

/// Widest panel on which 8 points resolve e^(−x²), as in [`super::gaussian`].
const STEP: f32 = 1.2;
/// e^(−32.5) = 8e-15: what is further out is left out, under 1e-7 of depth.
const FAR: f32 = 5.7;

/// ∫ Σ cᵢ ρᵢ e^(−T) dl and ∫ Σ ρᵢ e^(−T) dl of uniform widgets and Gaussians under the density-emitter, and the lanes that it does
/// not serve. Relative error some 1e-5.
#[inline(always)]
pub fn dense<L: Lanes>(members: &[LaneMember<L>]) -> ([L::F; 3], L::F, L::M) {
    let splat = L::F::splat;
    let (zero, half, one) = (splat(0.0), splat(0.5), splat(1.0));
    let (mut color, mut light) = ([zero; 3], zero);
    let mut unsure = zero.lt(zero);
    let mut tracks: Vec<(Track<L>, [L::F; POINTS])> = Vec::with_capacity(members.len());
    for member in members {
        let [start, end] = member.range;
        let inside = start.lt(end);
        let ends = zero.lt(start).and(start.lt(one)).or(zero.lt(end).and(end.lt(one)));
        let (track, rate) = match member.track {
            AnyLaneTrack::Uniform(rate) => (Track { x: zero, slope: zero, peak: rate }, rate),
            AnyLaneTrack::Gaussian(track) => {
                (Track { x: track.front, slope: track.length, peak: track.peak }, track.peak)
            }
            AnyLaneTrack::Piecewise(_) | AnyLaneTrack::Table(_) => {
                unsure = unsure.or(inside);
                (Track { x: zero, slope: zero, peak: zero }, zero)
            }
        };
        unsure = unsure.or(splat(MAX_RATE_AT_END).lt(rate).and(inside).and(ends));
        tracks.push((track, [zero; POINTS]));
    }
    let (mut done, mut rest, mut front, mut limit) = (zero, one, zero, one);
    for panel in 0..=MAX_PANELS {
        let open = zero.lt(rest).and(front.lt(splat(OPAQUE_DEPTH))).and(unsure.not());
        if !open.any() {
            break;
        }
        if panel == MAX_PANELS {
            unsure = unsure.or(open);
            break;
        }
        let mut next = rest;
        for (member, (track, _)) in members.iter().zip(&tracks) {
            let [start, end] = array!(|i| member.range[i] - done);
            let to = L::F::select(splat(PASSED).lt(start), start, track.step().min(end));
            let nothing = end.le(splat(PASSED)).or(end.le(start));
            next = next.min(L::F::select(nothing, splat(2.0), to));
        }
        let dt = next.min(limit);
        let middle = done + half * dt;
        let mut total = [zero; POINTS];
        for (member, (track, rates)) in members.iter().zip(&mut tracks) {
            let [start, end] = member.range;
            let present = start.le(middle).and(middle.le(end)).and(start.lt(end));
            *rates = track.rates(dt);
            for (rate, sum) in rates.iter_mut().zip(&mut total) {
                *rate = L::F::select(present, *rate, zero);
                *sum = *sum + *rate;
            }
        }
        let held = over_panel::<L>(&total) * dt;
        let deep = splat(PANEL_DEPTH + 0.5).lt(held);
        let taken = open.and(deep.not());
        let within = to_nodes::<L>(&total);
        let seen: [L::F; POINTS] = array!(|i| {
            let weight = exp::<L>(-(dt.mul_add(within[i], front))) * (dt * splat(PANEL[i].1));
            L::F::select(taken, weight, zero)
        });
        let moved = L::F::select(taken, dt, zero);
        for (member, (track, rates)) in members.iter().zip(&mut tracks) {
            let mut all = zero;
            for (rate, seen) in rates.iter().zip(&seen) {
                all = rate.mul_add(*seen, all);
            }
            light = light + all;
            for (sum, c) in color.iter_mut().zip(member.color) {
                *sum = all.mul_add(splat(c), *sum);
            }
            track.x = track.slope.mul_add(moved, track.x);
        }
        front = L::F::select(taken, front + held, front);
        done = done + moved;
        rest = rest - moved;
        let share = (splat(PANEL_DEPTH) / held.max(splat(1e-30))).min(half).max(splat(0.01));
        let ahead = splat(PANEL_DEPTH) / total[POINTS - 1].max(splat(PANEL_DEPTH));
        limit = L::F::select(deep, dt * share, ahead);
    }
    (color, light, unsure)
}

/// A rate from here on: peak × e^(−x²).
struct Track<L: Lanes> {
    x: L::F,
    /// By which x grows over the whole segment, ≥ 0.
    slope: L::F,
    peak: L::F,
}

impl<L: Lanes> Track<L> {
    /// Panel length that resolves it; more than 1 where it contributes nothing.
    #[inline(always)]
    fn step(&self) -> L::F {
        let splat = L::F::splat;
        let step = (splat(1.5) / self.x.abs().max(splat(0.1))).min(splat(STEP));
        let step = L::F::select(self.x.lt(splat(-FAR)), splat(-FAR) - self.x, step);
        let to = step / self.slope.max(splat(1e-30));
        L::F::select(self.x.lt(splat(FAR)), to, splat(2.0))
    }

    #[inline(always)]
    fn rates(&self, dt: L::F) -> [L::F; POINTS] {
        let grows = self.slope * dt;
        array!(|i| {
            let x = grows.mul_add(L::F::splat(PANEL[i].0), self.x);
            self.peak * exp::<L>(-(x * x))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::gaussian::{LaneGaussianPath, LaneGaussianTrack};
    use crate::{Kernel, LaneSet, dispatch};
    use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Widget};
    use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};

    /// A segment, from s to s, and the rate that all widgets take.
    #[derive(Debug, Clone, Copy)]
    struct Case {
        ends: [f32; 2],
        rate: f32,
    }

    const CENTRES: [f32; 3] = [0.3, 0.5, 0.75];
    const WIDTHS: [f32; 3] = [0.3, 0.07, 0.02];
    /// Share of the uniform widget, which is there up to s = 0.6.
    const HAZE: f32 = 1e-3;

    struct Run<'a>(&'a [Case; 16]);

    impl Kernel<([[f32; 16]; 3], u32, usize)> for Run<'_> {
        /// Returns the colours of `WIDTH` cases, and the lanes that are not served.
        #[inline(always)]
        fn run<L: Lanes>(self) -> ([[f32; 16]; 3], u32, usize) {
            let splat = L::F::splat;
            let row = |f: &dyn Fn(&Case) -> f32| L::F::load(&self.0.map(|case| f(&case)));
            let [front, back] = [row(&|case| case.ends[0]), row(&|case| case.ends[1])];
            let rate = row(&|case| case.rate);
            let member = |track, range, color| LaneMember::<L> {
                track,
                range,
                window: [splat(-1.0), splat(2.0)],
                color,
                threshold: 0.0,
                unit_rate: rate,
            };
            let all = [splat(0.0), splat(1.0)];
            let mut members: Vec<LaneMember<'_, L>> = (0..3)
                .map(|i| {
                    let x = [front, back].map(|s| (s - splat(CENTRES[i])) * splat(1.0 / WIDTHS[i]));
                    let path = LaneGaussianPath::<L>::new::<1>([x[0]], [x[1]]);
                    let mut color = [0.0; 3];
                    color[i] = 1.0;
                    member(AnyLaneTrack::Gaussian(LaneGaussianTrack::new(&path, rate)), all, color)
                })
                .collect();
            let at = ((splat(0.6) - front) / (back - front)).max(splat(0.0)).min(splat(1.0));
            let rises = front.lt(back);
            let range = [L::F::select(rises, splat(0.0), at), L::F::select(rises, at, splat(1.0))];
            members.push(member(AnyLaneTrack::Uniform(rate * splat(HAZE)), range, [0.5; 3]));
            let (color, light, unsure) = dense::<L>(&members);
            let mut rows = [[0.0; 16]; 3];
            for (row, value) in rows.iter_mut().zip(color) {
                (value / light).store(row);
            }
            (rows, unsure.bits(), L::WIDTH)
        }
    }

    /// The shares of colours in the light of a segment, in 64 bits.
    fn exact(case: &Case) -> [f64; 3] {
        let widgets = (0..4).map(|i| Widget {
            profile: match i {
                3 => Profile::Uniform,
                _ => Profile::Gaussian {
                    centre: [f64::from(CENTRES[i]), 0.0],
                    matrix: [[1.0 / f64::from(WIDTHS[i]), 0.0], [0.0, 0.0]],
                },
            },
            color: std::array::from_fn(|c| if i == 3 { 0.5 } else { f64::from(u8::from(c == i)) }),
            extinction: f64::from(case.rate) * if i == 3 { f64::from(HAZE) } else { 1.0 },
            region: (i == 3).then(|| Region::rectangle([-9.0, 0.6], [-1.0, 1.0])),
        });
        let model = OpticalModel::DensityEmitter;
        let look = TransferFunction {
            model,
            unit_distance: 1.0,
            widgets: widgets.collect(),
            axes: Default::default(),
        };
        let [front, back] = case.ends.map(|s| [f64::from(s), 0.0]);
        let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
        let found = CompiledTransferFunction::new(&look)
            .expect("a valid transfer function")
            .integrate(&segment, WidgetBlend::Exact);
        found.color.map(|c| c / found.opacity)
    }

    /// Visible parts of four widgets as dense as can be, from the thin side and from the thick one, equal those of 64 bits.
    #[test]
    fn colours_of_dense_segments_are_those_of_64_bits() {
        let mut random = 1u64;
        let mut next = || {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (random >> 40) as f32 / (1 << 24) as f32
        };
        let (mut served, mut worst) = (0, 0.0);
        for _ in 0..200 {
            let cases: [Case; 16] =
                std::array::from_fn(|_| Case { ends: [next(), next()], rate: 10f32.powf(7.0 * next()) });
            for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
                let (rows, unsure, width) = dispatch(lanes, Run(&cases));
                for (lane, case) in cases.iter().enumerate().take(width) {
                    if unsure >> lane & 1 != 0 {
                        // The end of the haze may lie in what is seen.
                        assert!(case.rate * HAZE > MAX_RATE_AT_END, "{case:?} is not served");
                        continue;
                    }
                    served += 1;
                    for (row, exact) in rows.iter().zip(exact(case)) {
                        worst = f64::max(worst, (f64::from(row[lane]) - exact).abs());
                        assert!(worst < 1e-4, "{case:?} on {}: {} for {exact}", lanes.name(), row[lane]);
                    }
                }
            }
        }
        println!("{served} segments, largest error {worst:.1e}");
        assert!(served > 1000, "{served}");
    }
}
