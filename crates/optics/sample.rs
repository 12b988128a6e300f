//! Point samples of a transfer function along a segment, for the integrators that sample.

use super::overlap::{Glow, Member};
use super::track::Track;

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
