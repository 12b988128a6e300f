//! A widget along one segment, as the quadrature sees it. Twin of `optics::track`.
//!
//! Every lane walks its own segment: it takes panels of at most [`PANEL_DEPTH`] that end at its own breaks, until it
//! is through or opaque. The depth within a panel comes from the rates at its 8 points, so that it fits them however
//! t rounds.

use super::elementary::exp;
use super::quadrature::{PANEL, POINTS, over_panel, to_nodes};
use crate::{Float, Lanes, Mask};

/// Optical depth beyond which nothing behind is visible (e^(−25) = 1e-11).
pub const OPAQUE_DEPTH: f32 = 25.0;

/// Depth that a panel holds at most: 8 points then leave 1e-7 of e^(−T).
const PANEL_DEPTH: f32 = 2.5;

/// Distance in t within which a break counts as passed.
pub const PASSED: f32 = 5e-7;

/// Optical depth along a path t ∈ [0, 1], per unit of t.
pub trait LaneTrack<L: Lanes> {
    /// dT/dt at the points of the panel [t, t + dt].
    fn rates(&self, t: L::F, dt: L::F) -> [L::F; POINTS];

    /// The first t' > t + [`PASSED`] before which one panel resolves the rate; ≥ 1 if there is none.
    fn next_break(&self, t: L::F) -> L::F;
}

/// Progress of each lane along its track.
#[derive(Clone, Copy)]
pub struct Walk<L: Lanes> {
    /// t.
    pub t: L::F,
    /// T up to t.
    pub depth: L::F,
    limit: L::F,
}

impl<L: Lanes> Walk<L> {
    /// At the front.
    #[inline(always)]
    pub fn start() -> Self {
        let zero = L::F::splat(0.0);
        Walk { t: zero, depth: zero, limit: L::F::splat(1.0) }
    }

    /// Lanes that are neither through nor opaque.
    #[inline(always)]
    pub fn open(&self) -> L::M {
        self.t.lt(L::F::splat(1.0)).and(self.depth.lt(L::F::splat(OPAQUE_DEPTH)))
    }

    /// Length of the next panel, which ends at `next` or before.
    #[inline(always)]
    pub fn panel(&self, next: L::F) -> L::F {
        (next.min(L::F::splat(1.0)) - self.t).max(L::F::splat(0.0)).min(self.limit)
    }

    /// Takes the panel whose rates are these in the lanes where its depth is small enough, shortens it in the
    /// others. Returns e^(−T) × weight × dt at the points, 0 in lanes that did not take it.
    #[inline(always)]
    pub fn take(&mut self, next: L::F, dt: L::F, rates: &[L::F; POINTS]) -> [L::F; POINTS] {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let held = over_panel::<L>(rates) * dt;
        // Not shorter than t can resolve.
        let deep = splat(PANEL_DEPTH + 0.5).lt(held).and(splat(2.0 * PASSED).lt(dt));
        let taken = self.open().and(deep.not());
        let within = to_nodes::<L>(rates);
        let front = self.depth;
        let seen = array!(|i| {
            let weight = exp::<L>(-(dt.mul_add(within[i], front))) * (dt * splat(PANEL[i].1));
            L::F::select(taken, weight, zero)
        });
        self.depth = L::F::select(taken, front + held, front);
        let end = next.min(one);
        let whole = (end - self.t).le(dt);
        self.t = L::F::select(taken, L::F::select(whole, end, self.t + dt), self.t);
        let share = (splat(PANEL_DEPTH) / held.max(splat(1e-30))).min(splat(0.5)).max(splat(0.01));
        let ahead = splat(PANEL_DEPTH) / rates[POINTS - 1].max(splat(PANEL_DEPTH));
        self.limit = L::F::select(deep, dt * share, ahead);
        seen
    }
}

/// Linear along t: the value at each point of the panel.
#[inline(always)]
pub fn at_nodes<L: Lanes>(front: L::F, back: L::F, t: L::F, dt: L::F) -> [L::F; POINTS] {
    let rise = back - front;
    array!(|i| {
        let at = dt.mul_add(L::F::splat(PANEL[i].0), t);
        // Taken from the nearer end.
        let near_back = L::F::splat(0.5).lt(at);
        let from = L::F::select(near_back, back, front);
        let step = L::F::select(near_back, at - L::F::splat(1.0), at);
        rise.mul_add(step, from)
    })
}
