//! A widget along one segment, as the quadrature sees it: a smooth rate of optical depth between breaks.

use super::quadrature::GAUSS_12;
use super::special::{OPAQUE_DEPTH, opacity};

/// Number of points of a panel.
pub const POINTS: usize = GAUSS_12.len();

/// Optical depth along a path t ∈ [0, 1], per unit of t.
pub trait Track {
    /// dT/dt at t.
    fn rate(&self, t: f64) -> f64;

    /// ∫ rate over [t, t + dt], in closed form. dt is exact even where t + dt rounds.
    fn depth(&self, t: f64, dt: f64) -> f64;

    /// The first t' > t before which one panel of [`POINTS`] points resolves the rate; ∞ if there is none.
    fn next_break(&self, t: f64) -> f64;

    /// Depths over [t, t + dt xᵢ] at the nodes of a panel. May be overridden to share work between them.
    fn depths(&self, t: f64, dt: f64) -> [f64; POINTS] {
        GAUSS_12.map(|(x, _)| self.depth(t, dt * x))
    }
}

/// Depth that one panel holds at most: 12 points then leave under 1e-16 of e^(−T).
pub const PANEL_DEPTH: f64 = 2.0;

/// Shortens [t, t + dt] until it holds a depth of at most [`PANEL_DEPTH`]; returns (dt, depth).
#[inline]
pub fn limit_panel(t: f64, mut dt: f64, rate: f64, mut depth: impl FnMut(f64) -> f64) -> (f64, f64) {
    let mut held = depth(dt);
    while held > PANEL_DEPTH {
        // Where the rate falls, the rate at the start is the measure; where it rises, halving is.
        let guess = 0.75 * PANEL_DEPTH / rate;
        dt = if guess < 0.5 * dt { guess } else { 0.5 * dt };
        if t + dt == t && dt * rate < 1e-300 {
            break;
        }
        held = depth(dt);
    }
    (dt, held)
}

/// ∫₀¹ e^(−T(t)) dt: the light of a constant glow along the track, relative to its length.
pub fn mean_transmittance_along(track: &impl Track) -> f64 {
    let total = track.depth(0.0, 1.0);
    if total < 1e-15 {
        return 1.0;
    }
    let (mut t, mut rest, mut front, mut sum) = (0.0, 1.0, 0.0_f64, 0.0);
    while rest > 0.0 && front < OPAQUE_DEPTH {
        let seen = (-front).exp();
        let behind = track.depth(t, rest);
        if behind < 1e-15 {
            sum += seen * rest * (1.0 - 0.5 * behind);
            break;
        }
        let next = track.next_break(t);
        let whole = if next < 1.0 { (next - t).min(rest) } else { rest };
        let (mut dt, mut depth) = limit_panel(t, whole, track.rate(t), |dt| track.depth(t, dt));
        if t + dt <= t {
            // One rounding of t holds more than a panel.
            dt = (t.next_up() - t).min(rest);
            depth = track.depth(t, dt);
            if depth > 0.0 {
                sum += seen * dt * opacity(depth) / depth;
            }
            front += depth;
            t += dt;
            rest -= dt;
            continue;
        }
        let depths = track.depths(t, dt);
        let mean: f64 =
            GAUSS_12.iter().zip(depths).map(|(&(_, weight), depth)| weight * (-depth).exp()).sum();
        sum += seen * dt * mean;
        front += depth;
        t += dt;
        rest -= dt;
    }
    sum
}
