//! The mix of one piece and the bound of its error (see the head of module `adaptive`).

use crate::overlap::{Glow, Member};
use crate::special::{mean_transmittance, opacity};
use crate::track::Track;

/// Largest number of widgets that are subdivided together; more of them take the ordered integral to working precision.
pub(super) const MAX_MEMBERS: usize = 16;

/// Contribution of a piece, and a bound of the error of its channels.
pub struct Estimate {
    pub color: [f64; 3],
    pub error: f64,
    pub depth: f64,
}

/// The mix of the piece [t, t + length].
pub fn mix(members: &[Member], glow: Glow, t: f64, length: f64) -> Estimate {
    let end = t + length;
    let mut depths = [0.0; MAX_MEMBERS];
    let mut depth = 0.0;
    for (slot, member) in depths.iter_mut().zip(members) {
        *slot = depth_within(member, t, length);
        depth += *slot;
    }
    let mut sum = MixBounds::default();
    match glow {
        Glow::Density => {
            let dimmed = mean_transmittance(depth);
            for (member, &own) in members.iter().zip(&depths) {
                let most = opacity(own);
                let share = dimmed * own;
                let least = (own - depth).exp() * most;
                sum.add(&ends(member, t, end), share, (most - share).max(0.0), (share - least).max(0.0));
            }
        }
        Glow::Constant(scale) => {
            let through = (-depth).exp();
            for member in members {
                let lit = scale * lit_length(member, t, end);
                if lit > 0.0 {
                    let slack = 0.5 * lit * opacity(depth);
                    sum.add(&ends(member, t, end), 0.5 * lit * (1.0 + through), slack, slack);
                }
            }
        }
    }
    Estimate { color: sum.color(), error: sum.error(glow == Glow::Density), depth }
}

/// Depth of a widget over a piece, as far as it lies in the widget's region.
pub fn depth_within(member: &Member, t: f64, length: f64) -> f64 {
    let end = t + length;
    if member.range[0] <= t && end <= member.range[1] {
        return member.track.depth_over(t, length);
    }
    let (start, end) = (t.max(member.range[0]), end.min(member.range[1]));
    if start < end { member.track.depth_over(start, end - start) } else { 0.0 }
}

/// The length over which a widget glows between t and `end`.
fn lit_length(member: &Member, t: f64, end: f64) -> f64 {
    let start = t.max(member.range[0]).max(member.window[0]);
    let end = end.min(member.range[1]).min(member.window[1]);
    let lit = start < end && member.track.rate(0.5 * (start + end)) > member.threshold * member.unit_rate;
    if lit { end - start } else { 0.0 }
}

/// Colours at both ends of a piece, between which a widget's colour is linear.
fn ends(member: &Member, t: f64, end: f64) -> [[f64; 3]; 2] {
    if member.has_one_color() { [member.color; 2] } else { [member.color_at(t), member.color_at(end)] }
}

/// Sums of a mix: per channel the light, and what it takes to bound the error.
#[derive(Default)]
struct MixBounds {
    parts: [MixedWidget; MAX_MEMBERS],
    count: usize,
}

/// A widget of a mix: its colour, its light, and by how much that can be too small and too large.
#[derive(Default, Clone, Copy)]
struct MixedWidget {
    middle: [f64; 3],
    /// Half the range of each channel.
    half: [f64; 3],
    light: f64,
    above: f64,
    below: f64,
}

impl MixBounds {
    /// A widget with its light, and by how much that can be too small and too large.
    fn add(&mut self, ends: &[[f64; 3]; 2], light: f64, above: f64, below: f64) {
        let middle = std::array::from_fn(|i| 0.5 * (ends[0][i] + ends[1][i]));
        let half = std::array::from_fn(|i| 0.5 * (ends[0][i] - ends[1][i]).abs());
        self.parts[self.count] = MixedWidget { middle, half, light, above, below };
        self.count += 1;
    }

    fn parts(&self) -> &[MixedWidget] {
        &self.parts[..self.count]
    }

    fn color(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.parts().iter().map(|p| p.light * p.middle[i]).sum())
    }

    /// The largest channel's error; `kept`: the sum of all light is known.
    fn error(&self, kept: bool) -> f64 {
        let whole: f64 = self.parts().iter().map(|p| p.light).sum();
        let color = self.color();
        let channel = |i: usize| {
            let mean = if kept && whole > 0.0 { color[i] / whole } else { 0.0 };
            let (mut up, mut down, mut varies) = (0.0, 0.0, 0.0);
            for p in self.parts() {
                let (more, less) = ((p.middle[i] - mean).max(0.0), (mean - p.middle[i]).max(0.0));
                up += more * p.above + less * p.below;
                down += more * p.below + less * p.above;
                varies += p.half[i] * (p.light + p.above);
            }
            f64::max(up, down) + varies
        };
        (0..3).map(channel).fold(0.0, f64::max)
    }
}
