//! The recorder of stretches against compositing in 64 bits, on every lane set.

use crate::composite::accumulators::{Fragment, TileAccumulator};
use crate::composite::stretches::{RowSegments, Run, StretchRecorder, WAS_CUT};
use crate::tile::TILE;
use voltet_optics::depth_image::{Supersegment, sort_and_join};
use voltet_simd::LaneSet;

/// Row of the segments.
const ROW: usize = 3;

/// Segments of a row, each with its slice, lane, depths and colour; other slots have none.
#[derive(Clone)]
struct Slices {
    lengths: Vec<f32>,
    columns: [Vec<f32>; 4],
    depths: [Vec<f32>; 2],
}

impl Slices {
    fn none(count: usize) -> Slices {
        let column = |value: f32| vec![value; count * TILE];
        Slices {
            lengths: column(0.0),
            columns: [(); 4].map(|()| column(0.9)),
            depths: [column(f32::INFINITY), column(f32::INFINITY)],
        }
    }

    fn put(&mut self, slice: usize, lane: usize, [entry, exit]: [f32; 2], rgba: [f32; 4]) {
        let at = slice * TILE + lane;
        self.lengths[at] = 1.0;
        (self.depths[0][at], self.depths[1][at]) = (entry, exit);
        self.columns.iter_mut().zip(rgba).for_each(|(column, value)| column[at] = value);
    }

    /// Runs of the row's pixels that a recorder finds. `with_lengths`: segments are those with a length, otherwise those with an entry, as
    /// deferred ones are, whose other slots are clear. `batch`: slices that it takes at a time.
    fn recorded(&self, lanes: LaneSet, with_lengths: bool, batch: usize) -> Vec<Vec<Run>> {
        let (mut recorder, mut pixels) = (StretchRecorder::new(false, false), TileAccumulator::new());
        let mut columns = self.columns.clone();
        if !with_lengths {
            let none = |at: &usize| self.lengths[*at] == 0.0;
            let slots = 0..self.lengths.len();
            slots.filter(none).for_each(|at| columns.iter_mut().for_each(|column| column[at] = 0.0));
        }
        for first in (0..self.lengths.len()).step_by(batch * TILE) {
            let slots = first..self.lengths.len().min(first + batch * TILE);
            let segments = RowSegments {
                lengths: with_lengths.then_some(&self.lengths[slots.clone()]),
                columns: columns.each_ref().map(|column| &column[slots.clone()]),
                depths: self.depths.each_ref().map(|column| &column[slots.clone()]),
            };
            recorder.blend(lanes, ROW, segments, &mut pixels);
        }
        recorder.close_all(&mut pixels);
        recorder.runs()[ROW * TILE..][..TILE].to_vec()
    }
}

/// Findings of each lane set, by both signs of a segment, in batches of several sizes.
fn each_way(slices: &Slices, check: impl Fn(&[Vec<Run>])) {
    for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
        for with_lengths in [true, false] {
            for batch in [1, 5, 16] {
                check(&slices.recorded(lanes, with_lengths, batch));
            }
        }
    }
}

fn ends(runs: &[Run]) -> Vec<[f32; 2]> {
    runs.iter().map(|run| [run.entry, run.exit]).collect()
}

#[test]
fn segments_that_follow_each_other_are_one_run_and_a_gap_ends_it() {
    let mut slices = Slices::none(4);
    let half = [0.25, 0.0, 0.0, 0.5];
    for (slice, depths) in [[1.0, 2.0], [2.0, 3.0], [3.5, 4.0], [4.0, 5.0]].into_iter().enumerate() {
        slices.put(slice, 0, depths, half);
    }
    // A slot without a segment is no gap.
    slices.put(0, 9, [1.0, 2.0], half);
    slices.put(3, 9, [2.0, 3.0], half);
    each_way(&slices, |pixels| {
        let both = [0.375, 0.0, 0.0, 0.75];
        assert_eq!(ends(&pixels[0]), [[1.0, 3.0], [3.5, 5.0]]);
        assert_eq!(ends(&pixels[9]), [[1.0, 3.0]]);
        assert!(pixels[0].iter().chain(&pixels[9]).all(|run| run.rgba == both));
        assert!(pixels.iter().enumerate().all(|(lane, own)| [0, 9].contains(&lane) || own.is_empty()));
    });
}

/// A | B | C, of which B was cut and is thinner than the rounding of depths: A and C are no one run, behind which B would come.
#[test]
fn a_segment_that_was_cut_ends_the_run_before_it() {
    let thin = [2.0, 2.0 + f32::EPSILON * 2.0];
    let layers = [[0.5, 0.0, 0.0, 0.5], [0.0, 0.5, 0.0, 0.5], [0.0, 0.0, 0.5, 0.5]];
    let mut slices = Slices::none(3);
    for lane in [0, 7, 15] {
        slices.put(0, lane, [1.0, 2.0], layers[0]);
        slices.put(2, lane, [thin[1], 3.0], layers[2]);
        slices.depths[1][TILE + lane] = WAS_CUT;
    }
    each_way(&slices, |pixels| {
        for lane in [0, 7, 15] {
            assert_eq!(ends(&pixels[lane]), [[1.0, 2.0], [thin[1], 3.0]]);
            let cut = Run { entry: thin[0], exit: thin[1], rgba: layers[1] };
            let stretch = |run: &Run| {
                let [entry, exit] = [run.entry, run.exit].map(f64::from);
                Supersegment { entry, exit, rgba: run.rgba }
            };
            let mut all: Vec<_> = pixels[lane].iter().chain([&cut]).map(stretch).collect();
            sort_and_join(&mut all, &[], 8.0 * f64::from(f32::EPSILON) * 3.0);
            assert_eq!(all.iter().map(|own| own.rgba).collect::<Vec<_>>(), [[0.5, 0.25, 0.125, 0.875]]);
        }
    });
}

/// Some of the pixels, or none, leave the part at each segment, the others are within it all the way. Each of the layers behind the first is
/// less than half a unit of its last place, and is lost beside it. Sums of 16 of them are off by 16·2⁻²⁵ of themselves.
#[test]
fn runs_of_many_segments_are_exact_beside_pixels_that_leave_the_part() {
    const COUNT: usize = 4000;
    let (first, further) = ([0.6, 0.0, 0.0, 0.0], [2.9e-8, 0.0, 0.0, 0.0]);
    for leaving in [0, TILE / 2] {
        let mut slices = Slices::none(COUNT);
        for slice in 0..COUNT {
            let (entry, rgba) = (1.0 + slice as f32, if slice == 0 { first } else { further });
            for lane in 0..TILE {
                slices.put(slice, lane, [entry, entry + if lane < leaving { 0.5 } else { 1.0 }], rgba);
            }
        }
        let exact = f64::from(first[0]) + (COUNT - 1) as f64 * f64::from(further[0]);
        for batch in [1, 16, COUNT] {
            let lane_sets = LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported());
            for (lanes, with_lengths) in lane_sets.flat_map(|lanes| [(lanes, true), (lanes, false)]) {
                for (lane, runs) in slices.recorded(lanes, with_lengths, batch).iter().enumerate() {
                    let error = runs.iter().map(|run| f64::from(run.rgba[0])).sum::<f64>() - exact;
                    // The first 16 are summed beside the first layer.
                    let bound = 16.0 * 2f64.powi(-25) + 2f64.powi(-24);
                    assert!(error.abs() <= bound, "pixel {lane} of batches of {batch}: {error:e}");
                    assert_eq!(runs.len(), if lane < leaving { COUNT } else { 1 }, "pixel {lane}");
                }
            }
        }
    }
}

/// A segment by itself is a run, whatever is open.
#[test]
fn what_is_pushed_is_by_itself() {
    let mut recorder = StretchRecorder::new(false, false);
    recorder.push(5, Fragment::new(1.0, 1.0, [0.1, 0.2, 0.3, 0.4]));
    recorder.close_all(&mut TileAccumulator::new());
    assert_eq!(recorder.runs()[5], [Run { entry: 1.0, exit: 1.0, rgba: [0.1, 0.2, 0.3, 0.4] }]);
    recorder.clear();
    assert!(recorder.runs().iter().all(Vec::is_empty));
}
