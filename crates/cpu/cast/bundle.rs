//! Rays of 4 × 4 pixels, side by side, from cell to cell: neighbours, so that they pass the same cells at about the same time.
//!
//! Where a ray goes next waits for what it has just read; so some bundles go in turns, and others compute while one waits.

use super::entered::Entered;
use super::here::Rays;
use super::way::Way;
use super::{CARRIED_MOST, Cast};
use crate::composite::scratch::Bounds;
use crate::fragments::batch::{BATCH, Batch, LANES_MOST};
use crate::project::record::TILE;
use crate::sample::Frame;
use voltet_simd::{Float, Kernel, Lanes, array, dispatch};

/// Steps of depth by which what comes next may begin before the end of what a ray has left: cells that meet at a boundary do, by
/// rounding.
const OVERLAP: u32 = 1 << 11;

/// Cells that a ray may pass: more are a circle.
const PASSED_MOST: usize = 1 << 17;

/// Bundles that go in turns.
pub(crate) const WAYS: usize = 4;

/// Side of a bundle in pixels.
const SIDE: usize = 4;

/// Segments of a ray that are found at a time.
pub(super) const SLICES: usize = BATCH / TILE;

/// The pixel of a tile (row << 4 | column) that a ray of a bundle is of. Bundles are as many as rows.
pub(crate) fn pixel_of(bundle: usize, ray: usize) -> usize {
    let across = TILE / SIDE;
    let (row, column) = (bundle / across * SIDE + ray / SIDE, bundle % across * SIDE + ray % SIDE);
    row * TILE + column
}

/// Rays side by side.
pub(crate) struct Bundle<'a> {
    pub(super) cast: &'a Cast,
    entered: &'a Entered,
    pub(super) pixels: [u32; TILE],
    /// Places of the pixels, in steps.
    pub(super) x: [u32; TILE],
    pub(super) y: [u32; TILE],
    /// Distance by depth.
    pub(super) stretch: [f32; TILE],
    pub(super) distance_origin: f64,
    pub(super) rays: Rays,
    pub(super) coming: Coming,
    /// Entries of each ray that are behind it, the one that it came in by among them.
    taken: [u32; TILE],
    /// What is left of [`Entered::leaving`].
    pub(super) leaving: [u32; TILE],
    /// Rays on their way, a bit each, and those of them that are about to come in.
    pub(super) live: u32,
    pub(super) waiting: u32,
    slices: usize,
    /// Segments that were found.
    pub segments: u64,
    /// Whether a ray went elsewhere than it should.
    pub is_lost: bool,
}

/// By which faces rays come in: corners, half-faces, depths in steps.
pub(super) struct Coming {
    pub corners: [[u32; LANES_MOST]; 3],
    pub half_face: [u32; LANES_MOST],
    pub at: [u32; LANES_MOST],
}

impl<'a> Bundle<'a> {
    /// Of a tile; no rays yet.
    pub fn new(frame: &Frame<'_>, cast: &'a Cast, entered: &'a Entered) -> Bundle<'a> {
        Bundle {
            cast,
            entered,
            pixels: [0; TILE],
            x: [0; TILE],
            y: [0; TILE],
            stretch: [1.0; TILE],
            distance_origin: frame.distance_origin,
            rays: Rays::none(cast.half_faces.sink()),
            coming: Coming { corners: [[0; LANES_MOST]; 3], half_face: [0; LANES_MOST], at: [0; LANES_MOST] },
            taken: [0; TILE],
            leaving: [0; TILE],
            live: 0,
            waiting: 0,
            slices: 0,
            segments: 0,
            is_lost: false,
        }
    }

    /// The rays of a bundle of the tile, where they come in; those before it have ended.
    pub fn begin(&mut self, number: usize, bounds: Bounds, stretch: &[f32; TILE * TILE]) {
        (self.waiting, self.slices) = (u32::MAX >> (32 - TILE), 0);
        (self.taken, self.coming.at) = ([0; TILE], [0; LANES_MOST]);
        let steps = |n: usize| (n << self.cast.points.pixel_bits) as u32;
        for ray in 0..TILE {
            let pixel = pixel_of(number, ray);
            self.pixels[ray] = pixel as u32;
            self.x[ray] = steps(bounds.left + pixel % TILE);
            self.y[ray] = steps(bounds.top + pixel / TILE);
            self.stretch[ray] = stretch[pixel];
            self.leaving[ray] = self.entered.leaving(pixel);
        }
        for ray in 0..TILE {
            self.come_in(ray);
        }
    }

    /// Whether any ray is on its way.
    pub fn goes_on(&self) -> bool {
        self.live != 0
    }

    /// Goes no further.
    pub fn stop(&mut self) {
        self.live = 0;
    }

    /// The ray comes in by its next entry; if there is none it ends, and is lost where it has not gone out by all faces that it
    /// should have, or comes in before it went out.
    pub(super) fn come_in(&mut self, ray: usize) {
        let bit = 1 << ray;
        let Some(entry) = self.entered.of(self.pixels[ray] as usize).get(self.taken[ray] as usize) else {
            self.is_lost |= self.leaving[ray] != 0;
            self.live &= !bit;
            self.coming.half_face[ray] = self.cast.half_faces.sink();
            return;
        };
        self.is_lost |= entry.depth.saturating_add(OVERLAP) < self.coming.at[ray];
        self.taken[ray] += 1;
        self.live |= bit;
        let outer = self.cast.half_faces.boundary[entry.outer as usize];
        for (corners, corner) in self.coming.corners.iter_mut().zip(outer.corners) {
            corners[ray] = corner;
        }
        self.coming.half_face[ray] = outer.half_face;
        self.coming.at[ray] = entry.depth;
    }
}

/// Fills batches with the next segments of bundles, slice by slice, with places if the frame wants them; their fragments, none at
/// the end.
pub(crate) fn next(
    frame: &Frame<'_>,
    bundles: &mut [Bundle<'_>; WAYS],
    batches: [&mut Batch; WAYS],
) -> [usize; WAYS] {
    let mut live = false;
    for bundle in bundles.iter_mut().filter(|bundle| bundle.live != 0) {
        bundle.slices += SLICES;
        bundle.is_lost |= PASSED_MOST < bundle.slices;
        live = true;
    }
    if !live || bundles.iter().any(|bundle| bundle.is_lost) {
        return [0; WAYS];
    }
    let places = frame.ends.is_some() || frame.shader.surface.is_some();
    match (frame.view.perspective, frame.attribute_count) {
        (false, 1) => dispatch(frame.lanes, Go::<false, 1> { bundles, places, batches }),
        (false, 2) => dispatch(frame.lanes, Go::<false, 2> { bundles, places, batches }),
        (false, _) => dispatch(frame.lanes, Go::<false, CARRIED_MOST> { bundles, places, batches }),
        (true, 1) => dispatch(frame.lanes, Go::<true, 1> { bundles, places, batches }),
        (true, 2) => dispatch(frame.lanes, Go::<true, 2> { bundles, places, batches }),
        (true, _) => dispatch(frame.lanes, Go::<true, CARRIED_MOST> { bundles, places, batches }),
    }
}

struct Go<'a, 'b, const PERSPECTIVE: bool, const N: usize> {
    bundles: &'a mut [Bundle<'b>; WAYS],
    places: bool,
    batches: [&'a mut Batch; WAYS],
}

impl<const PERSPECTIVE: bool, const N: usize> Kernel for Go<'_, '_, PERSPECTIVE, N> {
    type Output = [usize; WAYS];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [usize; WAYS] {
        let Go { bundles, places, mut batches } = self;
        let mut most = [0; WAYS];
        let mut ends = [[0; 4]; WAYS];
        for (number, half) in (0..TILE).step_by(L::WIDTH).enumerate() {
            let [bundle_0, bundle_1, bundle_2, bundle_3] = &mut *bundles;
            let mut ways = [
                Way::<L, PERSPECTIVE, N>::begin(bundle_0, half, places),
                Way::<L, PERSPECTIVE, N>::begin(bundle_1, half, places),
                Way::<L, PERSPECTIVE, N>::begin(bundle_2, half, places),
                Way::<L, PERSPECTIVE, N>::begin(bundle_3, half, places),
            ];
            // In turns, so that what one waits for is covered by what the others do.
            let mut goes_on = true;
            while goes_on {
                goes_on = false;
                let mut k = 0;
                while k < WAYS {
                    let way = &mut ways[k];
                    if way.goes_on() {
                        goes_on = true;
                        let record = way.read();
                        let fourth = way.fourth(record[0]);
                        let choice = way.choose(record, &fourth);
                        way.go(fourth, choice, batches[k]);
                        way.turn();
                    }
                    k += 1;
                }
            }
            let mut k = 0;
            while k < WAYS {
                ways[k].end();
                ends[k][number] = ways[k].slice;
                most[k] = most[k].max(ways[k].slice);
                k += 1;
            }
        }
        // Where some lanes end sooner.
        for (number, half) in (0..TILE).step_by(L::WIDTH).enumerate() {
            for (k, batch) in batches.iter_mut().enumerate() {
                for slice in ends[k][number]..most[k] {
                    L::F::splat(0.0).store(&mut batch.length[slice * TILE + half..]);
                }
            }
        }
        array(
            #[inline(always)]
            |k| most[k] * TILE,
        )
    }
}
