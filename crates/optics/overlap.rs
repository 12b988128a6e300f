//! Several widgets on one segment: the ordered integral ∫ Σ cᵢ ρᵢ e^(−T) dl with T in closed form.
//!
//! Kniss et al. 2003, Eq. 15, averages colours by optical depth and so ignores which widget stands in front.
//! Here the segment is divided at every break of every widget and until a panel holds a depth of at most 2;
//! on a panel 12-point Gauss–Legendre quadrature takes the glow times e^(−T), T as a sum of closed forms.
//! The error of that is under 1e-12 of the colour; a panel on which one widget of constant colour is alone is
//! exact.

use crate::kinds::{AnyTrack, TrackColor};
use crate::quadrature::GAUSS_12;
use crate::special::{OPAQUE_DEPTH, opacity};
use crate::track::{POINTS, Track, limit_panel};

/// A widget that takes part in the ordered integral.
#[derive(Debug, Clone, Copy)]
pub struct Member<'a> {
    /// Its rate, defined over the whole segment.
    pub track: AnyTrack<'a>,
    /// The part of the segment inside its region.
    pub range: [f64; 2],
    /// The part of the segment where it glows (constant-emitter); a wave breaks at its windows by itself.
    pub window: [f64; 2],
    /// Its colour, where that is constant.
    pub color: [f64; 3],
    /// Profile or extinction above which it glows.
    pub threshold: f64,
    /// Rate at which the profile is 1 (or the extinction is 1): `threshold` × this is the rate at the cutoff.
    pub unit_rate: f64,
}

impl Member<'_> {
    /// The first t' > t before which one panel resolves the widget; ∞ if there is none.
    pub fn next_break(&self, t: f64) -> f64 {
        if t < self.range[0] {
            return self.range[0];
        }
        if t >= self.range[1] {
            return f64::INFINITY;
        }
        let mut next = self.range[1].min(self.track.next_break(t));
        for end in self.window {
            if end > t && end < next {
                next = end;
            }
        }
        next
    }

    /// Colour at t.
    pub fn color_at(&self, t: f64) -> [f64; 3] {
        self.track.color_at(t).unwrap_or(self.color)
    }

    /// True if its colour is constant.
    pub fn has_one_color(&self) -> bool {
        self.track.color() == TrackColor::OfWidget
    }
}

/// Emission: in proportion to absorption (density-emitter), or c D/U wherever a widget is above its cutoff.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Glow {
    /// Σ cᵢ ρᵢ.
    Density,
    /// Σ cᵢ D/U where lit; holds D/U.
    Constant(f64),
}

/// Quadrature of C where there is no closed form.
pub trait Quadrature {
    /// True if it also integrates single widgets.
    const ALONE: bool;

    /// C of the whole segment.
    fn color(&self, members: &[Member], glow: Glow) -> [f64; 3];
}

/// The ordered integral to working precision.
#[derive(Debug, Clone, Copy)]
pub struct Ordered;

impl Quadrature for Ordered {
    const ALONE: bool = false;

    fn color(&self, members: &[Member], glow: Glow) -> [f64; 3] {
        ordered(members, glow)
    }
}

/// C of the whole segment.
pub fn ordered(members: &[Member], glow: Glow) -> [f64; 3] {
    let mut color = [0.0; 3];
    let (mut t, mut rest, mut front) = (0.0_f64, 1.0_f64, 0.0_f64);
    while rest > 0.0 && front < OPAQUE_DEPTH {
        let next = members.iter().map(|m| m.next_break(t)).fold(f64::INFINITY, f64::min);
        let whole = if next < 1.0 { (next - t).min(rest) } else { rest };
        let middle = t + 0.5 * whole;
        let present = present_at(middle);
        let mut alone = members.iter().filter(&present);
        let (first, second) = (alone.next(), alone.next());
        let seen = (-front).exp();
        let (dt, depth) = match (first, second) {
            (None, _) => (whole, 0.0),
            (Some(member), None) if glow == Glow::Density && member.has_one_color() => {
                let depth = member.track.depth(t, whole);
                add(&mut color, seen * opacity(depth), member.color);
                (whole, depth)
            }
            _ => {
                let total = |f: &dyn Fn(&Member) -> f64| members.iter().filter(&present).map(f).sum::<f64>();
                let rate = total(&|m| m.track.rate(t));
                let (dt, depth) = limit_panel(t, whole, rate, |dt| total(&|m| m.track.depth(t, dt)));
                match blurred(t, dt) {
                    None => {
                        panel(&mut color, members, glow, &Panel { t, dt, seen, middle: t + 0.5 * dt });
                        (dt, depth)
                    }
                    Some(dt) => (dt, blur(&mut color, members, glow, &Panel { t, dt, seen, middle })),
                }
            }
        };
        front += depth;
        t += dt;
        rest -= dt;
        if dt <= 0.0 {
            // The next break is within rounding of t: step over it.
            t = next.max(t.next_up());
            rest = 1.0 - t;
        }
    }
    color
}

/// True if a widget's region holds the place t.
pub(crate) fn present_at(t: f64) -> impl Fn(&&Member) -> bool {
    move |m| m.range[0] <= t && t <= m.range[1]
}

/// A stretch that 12 points resolve.
pub struct Panel {
    /// Its start.
    pub t: f64,
    /// Its length.
    pub dt: f64,
    /// e^(−T) at its start.
    pub seen: f64,
    /// Its middle.
    pub middle: f64,
}

/// Adds the light of one panel.
pub fn panel(color: &mut [f64; 3], members: &[Member], glow: Glow, panel: &Panel) {
    let &Panel { t, dt, seen, middle } = panel;
    let present = present_at(middle);
    let mut depth = [0.0; POINTS];
    for member in members.iter().filter(&present) {
        for (sum, part) in depth.iter_mut().zip(member.track.depths(t, dt)) {
            *sum += part;
        }
    }
    let mut weight = [0.0; POINTS];
    for ((w, &(_, node_weight)), depth) in weight.iter_mut().zip(&GAUSS_12).zip(depth) {
        *w = seen * dt * node_weight * (-depth).exp();
    }
    for member in members.iter().filter(&present) {
        if let Glow::Constant(scale) = glow {
            if member.track.rate(middle) <= member.threshold * member.unit_rate {
                continue;
            }
            if member.has_one_color() {
                add(color, scale * weight.iter().sum::<f64>(), member.color);
                continue;
            }
        }
        let mut shared = 0.0;
        for (&w, &(x, _)) in weight.iter().zip(&GAUSS_12) {
            let at = t + dt * x;
            let strength = match glow {
                Glow::Density => w * member.track.rate(at),
                Glow::Constant(scale) => w * scale,
            };
            if member.has_one_color() {
                shared += strength;
            } else {
                add(color, strength, member.color_at(at));
            }
        }
        add(color, shared, member.color);
    }
}

/// Roundings of t under which the places in a panel are not told apart well enough for rates that grow from nothing.
const BLURRED: f64 = 64.0;

/// The length that a panel from t on gets if it is too short for its places to be told apart: at least a rounding of t.
pub fn blurred(t: f64, dt: f64) -> Option<f64> {
    let rounding = t.next_up() - t;
    (dt < BLURRED * rounding).then_some(dt.max(rounding))
}

/// Adds the light of a panel whose places are not told apart: what is in it has no order, so its colours are mixed by their
/// depths. Returns its depth.
pub fn blur(color: &mut [f64; 3], members: &[Member], glow: Glow, panel: &Panel) -> f64 {
    let &Panel { t, dt, seen, middle } = panel;
    let present = present_at(middle);
    let depth: f64 = members.iter().filter(&present).map(|m| m.track.depth(t, dt)).sum();
    if depth > 0.0 {
        for member in members.iter().filter(&present) {
            let share = match glow {
                Glow::Density => member.track.depth(t, dt) / depth,
                Glow::Constant(_) if member.track.rate(middle) <= member.threshold * member.unit_rate => 0.0,
                Glow::Constant(scale) => scale * dt / depth,
            };
            add(color, seen * opacity(depth) * share, member.color_at(t));
        }
    }
    depth
}

#[inline]
pub(crate) fn add(sum: &mut [f64; 3], weight: f64, color: [f64; 3]) {
    for (s, c) in sum.iter_mut().zip(color) {
        *s += weight * c;
    }
}

/// Absorption and emission at a point of the segment, per t ∈ [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// ρ D.
    pub rate: f64,
    /// Σ cᵢ ρᵢ D or Σ cᵢ D/U.
    pub glow: [f64; 3],
}

impl Sample {
    /// Glow by rate: the colour of the stuff here, or where there is none that of `other`.
    pub fn color(&self, other: &Sample) -> [f64; 3] {
        let from = if self.rate > 0.0 { self } else { other };
        if from.rate > 0.0 { from.glow.map(|g| g / from.rate) } else { [0.0; 3] }
    }
}

/// The widgets that a segment crosses.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    members: &'a [Member<'a>],
    glow: Glow,
}

impl<'a> Samples<'a> {
    pub(super) fn new(members: &'a [Member<'a>], glow: Glow) -> Self {
        Samples { members, glow }
    }

    /// The sample at t; the ends of a region belong to it.
    pub fn at(&self, t: f64) -> Sample {
        let mut sample = Sample::default();
        for member in self.members {
            if t < member.range[0] || t > member.range[1] {
                continue;
            }
            let rate = member.track.rate(t);
            sample.rate += rate;
            let strength = match self.glow {
                Glow::Density => rate,
                Glow::Constant(scale) if rate > member.threshold * member.unit_rate => scale,
                Glow::Constant(_) => continue,
            };
            for (sum, c) in sample.glow.iter_mut().zip(member.color_at(t)) {
                *sum += strength * c;
            }
        }
        sample
    }
}
