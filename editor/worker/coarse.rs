//! How many pixels a coarse picture has: as many as are drawn in the time that a hand does not notice.

use std::time::Duration;

/// What a coarse picture may take, seconds: twenty-five of them a second, of which the wires take some.
const COARSE_SECONDS: f64 = 0.035;

/// A full picture that takes no longer needs no coarse one before it, seconds.
const FULL_SECONDS: f64 = 0.045;

/// Along each side a coarse picture has at least an eighth of the pixels, or a person sees nothing in it.
const DIVISOR_MOST: u32 = 8;

/// Before anything was drawn.
const FIRST: u32 = 4;

/// How long the first picture of a wish may go on that a hand has moved past, seconds: at least this, so that twenty a second are shown.
const PATIENCE: f64 = 0.05;

/// The same before any was drawn.
const FIRST_PATIENCE: f64 = 0.2;

/// What drawing takes, learnt from the pictures drawn: so much a picture, and so much a pixel.
#[derive(Debug, Default)]
pub(super) struct Pace {
    full: Option<(f64, f64)>,
    coarse: Option<(f64, f64)>,
}

impl Pace {
    /// By how much the sides of a coarse picture of so many pixels in full are divided; 1 where the full one is quick enough.
    pub fn divisor(&self, pixels: f64) -> u32 {
        let Some([fixed, each]) = self.law() else { return FIRST };
        // The full picture itself is the better witness.
        let as_measured = self.full.map_or(f64::INFINITY, |(count, seconds)| seconds * pixels / count);
        if as_measured.min(fixed + each * pixels) <= FULL_SECONDS {
            return 1;
        }
        let fits = |divisor: &u32| fixed + each * pixels / f64::from(divisor * divisor) <= COARSE_SECONDS;
        (2..DIVISOR_MOST).find(fits).unwrap_or(DIVISOR_MOST)
    }

    /// How long the first picture of a wish may go on that a hand has moved past: twice what the last such one took.
    pub fn patience(&self, divisor: u32) -> Duration {
        let last = if divisor == 1 { self.full } else { self.coarse };
        let usual = last.map_or(FIRST_PATIENCE, |(_, seconds)| 2.0 * seconds);
        Duration::from_secs_f64(usual.max(PATIENCE))
    }

    /// Seconds of a picture and of a pixel, through what was measured last.
    fn law(&self) -> Option<[f64; 2]> {
        match (self.full, self.coarse) {
            (Some((many, long)), Some((few, short))) if many > few => {
                let each = ((long - short) / (many - few)).max(0.0);
                Some([(short - each * few).max(0.0), each])
            }
            (Some((pixels, seconds)), _) | (None, Some((pixels, seconds))) => Some([0.0, seconds / pixels]),
            (None, None) => None,
        }
    }

    /// A picture of so many pixels took so long.
    pub fn learn(&mut self, divisor: u32, pixels: f64, seconds: f64) {
        let measured = Some((pixels.max(1.0), seconds));
        if divisor == 1 { self.full = measured } else { self.coarse = measured }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_pictures_are_made_coarser_and_quick_ones_are_not() {
        let mut pace = Pace::default();
        assert_eq!(pace.divisor(786_432.0), FIRST, "nothing is known yet");
        pace.learn(1, 786_432.0, 0.4);
        // 0.4 s / 16 = 0.025 s, / 9 = 0.044 s.
        assert_eq!(pace.divisor(786_432.0), 4);
        pace.learn(4, 49_152.0, 0.1);
        // 0.08 s of each picture do not follow the pixels: nothing is quick enough.
        assert_eq!(pace.divisor(786_432.0), DIVISOR_MOST);
        pace.learn(1, 786_432.0, 0.04);
        assert_eq!(pace.divisor(786_432.0), 1);
    }
}
