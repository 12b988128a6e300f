//! Model of the time that pictures take, and the number of pixels that a coarse one has.

use std::time::Duration;
use voltet_graph::NodeEntry;

/// Time of a coarse picture (seconds): thirty a second, of which the window and the wires take a third.
const COARSE_SECONDS: f64 = 2.0 / 3.0 / 30.0;

/// A full picture that takes no longer needs no coarse one before it, seconds.
const FULL_SECONDS: f64 = 0.028;

/// Along each side a coarse picture has at least an eighth of the pixels, or a person sees nothing in it.
const MAX_DIVISOR: u32 = 8;

/// Before anything was drawn.
const FIRST_DIVISOR: u32 = 4;

/// Time limit before any picture was drawn (seconds).
const FIRST_TIME_LIMIT: f64 = 0.2;

/// Model of drawing times, fitted to the pictures drawn: a constant a picture, and a constant a pixel. It gives the resolution of coarse
/// pictures: as many pixels as are drawn in a time that the user does not notice.
///
/// While widgets change and the view does not, the engine draws from its cache of the view
/// ([`voltet_optics::engine::RenderOptions::preview`]). It caches pictures of one size alone, so that another size costs some slow
/// pictures first.
#[derive(Debug, Default)]
pub(super) struct FrameTimeModel {
    full: Option<(f64, f64)>,
    coarse: Option<(f64, f64)>,
    /// Drawing from the engine's cache of the view.
    kept: Option<CachedDrawing>,
    cameras: Vec<NodeEntry>,
}

#[derive(Debug, Clone, Copy)]
struct CachedDrawing {
    seconds_a_pixel: f64,
    /// Pictures since then that were not.
    others: u32,
}

/// Pictures of a new size after which the engine has kept it, or will not.
const UNTIL_KEPT: u32 = 3;

impl FrameTimeModel {
    /// By how much the sides of a coarse picture of so many pixels in full are divided; 1 where the full one is quick enough.
    pub fn divisor(&self, pixels: f64) -> u32 {
        let coarsest = |[fixed, each]: [f64; 2], full: f64| {
            let fits = |divisor: &u32| fixed + each * pixels / f64::from(divisor * divisor) <= COARSE_SECONDS;
            let coarser = || (2..MAX_DIVISOR).find(fits).unwrap_or(MAX_DIVISOR);
            if full.min(fixed + each * pixels) <= FULL_SECONDS { 1 } else { coarser() }
        };
        let of_kept = self.kept.map(|kept| coarsest([0.0, kept.seconds_a_pixel], f64::INFINITY));
        // The full picture itself is the better witness.
        let as_measured = self.full.map_or(f64::INFINITY, |(count, seconds)| seconds * pixels / count);
        let of_cells = self.law().map_or(FIRST_DIVISOR, |law| coarsest(law, as_measured));
        of_kept.unwrap_or(MAX_DIVISOR).min(of_cells)
    }

    /// Time limit of the first picture of a request that the user has moved on from: twice that of the last such picture, in proportion where
    /// this one has more pixels, and at least twice that of a coarse one. `pixels`: of the full picture.
    pub fn patience(&self, divisor: u32, pixels: f64) -> Duration {
        let last = if divisor == 1 { self.full.or(self.coarse) } else { self.coarse };
        let more = |count: f64| (pixels / f64::from(divisor * divisor) / count).max(1.0);
        let usual = last.map_or(FIRST_TIME_LIMIT, |(count, seconds)| 2.0 * seconds * more(count));
        Duration::from_secs_f64(usual.max(2.0 * COARSE_SECONDS))
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
        let known = if divisor == 1 { &mut self.full } else { &mut self.coarse };
        *known = Some((pixels.max(1.0), seconds));
        self.kept = self.kept.map(|kept| CachedDrawing { others: kept.others + 1, ..kept });
        self.kept = self.kept.filter(|kept| kept.others <= UNTIL_KEPT);
    }

    /// Records the time of a picture that was drawn from the cache of the view.
    pub fn learn_of_kept(&mut self, pixels: f64, seconds: f64) {
        let seconds_a_pixel = match self.kept {
            // The first of its size: what is kept was found, too.
            Some(CachedDrawing { seconds_a_pixel, others: 1.. }) => seconds_a_pixel,
            _ => seconds / pixels.max(1.0),
        };
        self.kept = Some(CachedDrawing { seconds_a_pixel, others: 0 });
    }

    /// The next picture is seen from here: nothing is kept of another view.
    pub fn look_from(&mut self, cameras: Vec<NodeEntry>) {
        if self.cameras != cameras {
            (self.cameras, self.kept) = (cameras, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_graph::pipeline::Pipeline;

    #[test]
    fn slow_pictures_are_made_coarser_and_quick_ones_are_not() {
        let mut pace = FrameTimeModel::default();
        assert_eq!(pace.divisor(786_432.0), FIRST_DIVISOR, "nothing is known yet");
        pace.learn(1, 786_432.0, 0.4);
        // 0.4 s / 25 = 0.016 s, / 16 = 0.025 s.
        assert_eq!(pace.divisor(786_432.0), 5);
        pace.learn(4, 49_152.0, 0.1);
        // 0.08 s of each picture do not follow the pixels: nothing is quick enough.
        assert_eq!(pace.divisor(786_432.0), MAX_DIVISOR);
        pace.learn(1, 786_432.0, 0.025);
        assert_eq!(pace.divisor(786_432.0), 1);
    }

    #[test]
    fn a_picture_has_twice_the_time_that_one_of_as_many_pixels_took() {
        let mut pace = FrameTimeModel::default();
        let seconds = |pace: &FrameTimeModel, divisor| pace.patience(divisor, 786_432.0).as_secs_f64();
        assert_eq!([1, 8].map(|divisor| seconds(&pace, divisor)), [FIRST_TIME_LIMIT; 2]);
        pace.learn(8, 12_288.0, 0.025);
        assert_eq!([8, 4, 2, 1].map(|divisor| seconds(&pace, divisor)), [0.05, 0.2, 0.8, 3.2]);
        // The full picture itself is the better witness; a coarser one than the last has no less time.
        pace.learn(1, 786_432.0, 0.4);
        pace.learn(2, 196_608.0, 0.1);
        assert_eq!([1, 2, 8].map(|divisor| seconds(&pace, divisor)), [0.8, 0.2, 0.2]);
    }

    #[test]
    fn while_a_view_is_kept_pictures_are_finer() {
        let view = |angle: u32| {
            let text = format!("[pipeline]\nformat = 1\n[nodes.view]\ntype = \"camera\"\nfov_y = {angle}");
            Pipeline::parse(&text).unwrap().nodes
        };
        let mut pace = FrameTimeModel::default();
        pace.look_from(view(30));
        pace.learn(1, 786_432.0, 0.4);
        assert_eq!(pace.divisor(786_432.0), 5);
        // 0.16 s for the full one, of which a ninth is quick.
        pace.learn_of_kept(49_152.0, 0.01);
        assert_eq!(pace.divisor(786_432.0), 3);
        // The first ones of the new size are drawn from the cells, one keeps.
        pace.learn(3, 87_381.0, 0.06);
        pace.learn(3, 87_381.0, 0.06);
        assert_eq!(pace.divisor(786_432.0), 3);
        pace.learn_of_kept(87_381.0, 0.1);
        assert_eq!(pace.divisor(786_432.0), 3);
        pace.learn_of_kept(87_381.0, 0.003);
        assert_eq!(pace.divisor(786_432.0), 1);
        // The engine does not keep so much.
        for _ in 0..=UNTIL_KEPT {
            assert_eq!(pace.divisor(786_432.0), 1);
            pace.learn(1, 786_432.0, 0.4);
        }
        assert_ne!(pace.divisor(786_432.0), 1);
        pace.learn_of_kept(786_432.0, 0.02);
        pace.look_from(view(30));
        assert_eq!(pace.divisor(786_432.0), 1);
        pace.look_from(view(31));
        assert_ne!(pace.divisor(786_432.0), 1, "nothing is kept of another view");
    }
}
