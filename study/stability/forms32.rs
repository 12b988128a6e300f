//! The 32-bit twins as a set of forms: differences from a widget's own origin are formed in 64 bits, rounded,
//! and everything after that runs in 32-bit lanes. As in the engine, the 64-bit forms take over where 32 bits cannot
//! hold what matters; those cases are answered as [`Answer::Wider`].

use super::crossing32::{Crossing, in_order, lane, splat};
use voltet_core::Result;
use voltet_core::optics::{Contribution, Overlap, Prepared, Segment};
use voltet_core::transfer::{Profile, TransferFunction};
use voltet_judge::Precision;
use voltet_judge::{Answer, Chain, Forms, PartialIntegrals};
use voltet_lanes::optics::elementary::{exp, one_minus_exp};
use voltet_lanes::optics::linear;
use voltet_lanes::optics::overlap::{LaneMember, MEMBERS_MOST};
use voltet_lanes::optics::wave::BANDS_MOST;
use voltet_lanes::{Float, Kernel, LaneSet, Lanes, dispatch};

/// Widths that a segment may span. Beyond it the rounding of the ends (6e-8 of the span) moves the path by a
/// share of a width, which enters h² squared: 1e-5 at this limit.
const WIDTHS_MOST: f64 = 1e5;

/// The 32-bit twins on one lane set.
#[derive(Debug, Clone, Copy)]
pub struct Native32(pub LaneSet);

impl Native32 {
    /// One for each lane set that this processor has.
    pub fn each() -> impl Iterator<Item = Native32> {
        let sets = [LaneSet::Portable, LaneSet::Avx2, LaneSet::Avx512];
        sets.into_iter().filter(|set| set.is_supported()).map(Native32)
    }
}

impl Forms for Native32 {
    fn name(&self) -> &str {
        match self.0 {
            LaneSet::Portable => "32-bit portable",
            LaneSet::Avx2 => "32-bit avx2",
            LaneSet::Avx512 => "32-bit avx512",
        }
    }

    fn precision(&self) -> Precision {
        Precision::F32
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: Overlap,
    ) -> Result<Answer> {
        dispatch(self.0, OneSegment { transfer_function, segment, overlap })
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        dispatch(self.0, OneChain(segments))
    }

    fn partial(&self, a: f64, b: f64) -> PartialIntegrals {
        dispatch(self.0, Partial([a, b]))
    }
}

struct OneSegment<'a> {
    transfer_function: &'a TransferFunction,
    segment: &'a Segment<'a>,
    overlap: Overlap,
}

impl Kernel for OneSegment<'_> {
    type Output = Result<Answer>;

    fn run<L: Lanes>(self) -> Result<Answer> {
        let OneSegment { transfer_function, segment, overlap } = self;
        let prepared = Prepared::new(transfer_function)?;
        let scale = segment.length / transfer_function.unit_distance;
        let cutoff = transfer_function.model.cutoff();
        let mut crossings: Vec<Crossing<L>> = Vec::new();
        for widget in &transfer_function.widgets {
            if out_of_range(scale * widget.extinction.max(1.0)) || out_of_range(scale) {
                return Ok(Answer::Skipped("lengths or extinctions leave the range of 32 bits"));
            }
            crossings.extend(Crossing::new(widget, segment, scale, cutoff)?);
        }
        let wider = |reason| Ok(Answer::Wider(rounded(&prepared.integrate(segment, overlap)), reason));
        if crossings.iter().any(|c| matches!(c.widget.profile, Profile::Table(_))) {
            return wider("a table has no 32-bit form");
        }
        if crossings.iter().any(|c| c.widths() > WIDTHS_MOST) {
            return wider("the segment spans over 100,000 widths of a Gaussian");
        }
        let depths: Vec<L::F> = crossings.iter().map(Crossing::depth).collect();
        let mut optical_depth: L::F = splat(0.0);
        for depth in &depths {
            optical_depth = optical_depth + *depth;
        }
        let opacity = one_minus_exp::<L>(optical_depth);
        let seen = |depth: &L::F| cutoff.is_some() || lane(*depth) > 0.0;
        let active: Vec<(&Crossing<L>, L::F)> =
            crossings.iter().zip(depths.iter().copied()).filter(|(_, depth)| seen(depth)).collect();
        let color = match active.as_slice() {
            [] => [splat(0.0); 3],
            [(alone, depth)] => alone.color(*depth, opacity),
            several => {
                if several.len() > MEMBERS_MOST {
                    return wider("more widgets than one ordered integral of lanes takes");
                }
                if several.iter().any(|(crossing, _)| crossing.bands() > BANDS_MOST) {
                    return wider("several widgets, and a wave of over 1,000 bands by band width");
                }
                if several.iter().any(|(crossing, depth)| crossing.sudden(lane(*depth))) {
                    return wider(
                        "several widgets, and a wave that is opaque within the rounding of its band",
                    );
                }
                let members: Vec<LaneMember<L>> = several.iter().map(|(c, _)| c.member()).collect();
                in_order::<L>(&members, cutoff.map(|_| splat(scale)))
            }
        };
        Ok(Answer::Served(Contribution {
            optical_depth: lane(optical_depth),
            color: color.map(lane),
            opacity: lane(opacity),
        }))
    }
}

struct OneChain<'a>(&'a [Contribution]);

impl Kernel for OneChain<'_> {
    type Output = Chain;

    fn run<L: Lanes>(self) -> Chain {
        let (mut color, mut opacity, mut transparency): ([L::F; 3], L::F, L::F) =
            ([splat(0.0); 3], splat(0.0), splat(1.0));
        for segment in self.0 {
            for (sum, c) in color.iter_mut().zip(segment.color) {
                *sum = transparency.mul_add(splat(c), *sum);
            }
            opacity = transparency.mul_add(splat(segment.opacity), opacity);
            transparency = transparency * (splat::<L::F>(1.0) - splat(segment.opacity));
        }
        let transparency = lane(transparency);
        let opacity = lane(opacity);
        let opacity = if opacity < 0.5 { opacity } else { 1.0 - transparency };
        Chain { color: color.map(lane), opacity, transparency }
    }
}

struct Partial([f64; 2]);

impl Kernel for Partial {
    type Output = PartialIntegrals;

    fn run<L: Lanes>(self) -> PartialIntegrals {
        let [a, b] = self.0;
        let (fa, fb) = (splat(a), splat(b));
        let (front, back) = linear::front_back::<L>(fa, fb);
        let zeta = exp::<L>(splat(-0.5 * (a + b)));
        PartialIntegrals {
            psi: lane(linear::psi::<L>(fa, fb)),
            front: lane(front),
            back: lane(back),
            zeta: lane(zeta),
        }
    }
}

fn out_of_range(x: f64) -> bool {
    !(f64::from(f32::MIN_POSITIVE)..f64::from(f32::MAX) / 4.0).contains(&x)
}

fn rounded(found: &Contribution) -> Contribution {
    let round = |x: f64| f64::from(x as f32);
    Contribution {
        optical_depth: round(found.optical_depth),
        color: found.color.map(round),
        opacity: round(found.opacity),
    }
}

#[cfg(test)]
#[path = "forms32_tests.rs"]
mod tests;
