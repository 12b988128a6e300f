//! Triangle and sine waves in lanes: phases of the segments' ends, and the mean of the profile between them.

use crate::attribute::Attribute;
use voltet_core::transfer::Wave;
use voltet_simd::limits::MAX_BANDS;
use voltet_simd::optics::smooth::DensityShape;
use voltet_simd::optics::wave::{LaneBell, LanePhase};
use voltet_simd::{Float, Lanes, inlined};

/// The profile of a wave, in scaled attributes.
pub(crate) struct LaneWave {
    bell: LaneBell,
    /// Phase per unit of s and g.
    step: [f32; 2],
    /// Phase at 0, without whole bands: in −½ … ½.
    start: f32,
}

impl LaneWave {
    /// `None` where 32 bits cannot hold the phases.
    pub fn new(wave: &Wave, sine: bool, attributes: &[Attribute<'_>]) -> Option<LaneWave> {
        let bell = if sine { LaneBell::sine(wave) } else { LaneBell::triangle(wave) };
        let per_value = wave.step();
        let axis = |a: usize| attributes.get(a).map_or([0.0, 1.0, 0.0], |x| [x.offset, x.scale, x.span()]);
        let mut start = 0.0;
        let mut step = [0f32; 2];
        let mut bands = 0.0;
        for a in 0..2 {
            if per_value[a] != 0.0 {
                let [offset, scale, span] = axis(a);
                start += per_value[a] * (offset - wave.origin[a]);
                step[a] = (per_value[a] * scale) as f32;
                bands += (per_value[a] * span).abs();
            }
        }
        let held = bands < MAX_BANDS && step.iter().all(|step| step.is_finite());
        held.then(|| LaneWave { bell, step, start: (start - start.round()) as f32 })
    }

    #[inline(always)]
    fn phase<L: Lanes>(&self, v: &[L::F; 2]) -> LanePhase<L> {
        let splat = L::F::splat;
        let phase =
            inlined!(|from: L::F| splat(self.step[0]).mul_add(v[0], splat(self.step[1]).mul_add(v[1], from)));
        let nearest = phase(splat(self.start)).round();
        // Once more with the whole bands taken away first, so that they cost no digits.
        LanePhase { nearest, offset: phase(splat(self.start) - nearest) }
    }

    /// Depth and shape between two points, with a rate of `peak` at the peaks.
    #[inline(always)]
    pub fn shape<L: Lanes>(&self, front: &[L::F; 2], back: &[L::F; 2], peak: L::F) -> DensityShape<L> {
        self.bell.shape::<L>(self.phase(front), self.phase(back), peak)
    }

    /// The profile at a point.
    #[inline(always)]
    pub fn value<L: Lanes>(&self, at: &[L::F; 2]) -> L::F {
        self.bell.value::<L>(self.phase::<L>(at).offset.abs())
    }
}
