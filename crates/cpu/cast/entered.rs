//! Where the rays of a tile come in, and by which faces they have to go out.

use super::Cast;
use super::half_faces::OUT;
use super::sides::{At, clockwise, turn};
use crate::fragments::batch::LANES_MOST;
use crate::project::record::TILE;
use crate::shade::along::lanes_of;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, Unsigned, array, dispatch, inlined};

const PIXELS: usize = TILE * TILE;

/// Where a ray comes in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    /// In steps.
    pub depth: u32,
    /// Number of the face at the boundary.
    pub outer: u32,
}

/// Of the rays of a tile.
#[derive(Debug)]
pub(crate) struct Entered {
    /// As they were found, with the pixels.
    found: Vec<(u8, Entry)>,
    /// Where each pixel's begin; then the end of the last.
    starts: [u32; PIXELS + 1],
    /// Pixel by pixel, by depth.
    entries: Vec<Entry>,
    /// The sum of the numbers of the half-faces by which each pixel's ray goes out, each with [`OUT`].
    leaving: [u32; PIXELS],
}

impl Default for Entered {
    fn default() -> Entered {
        Entered { found: Vec::new(), starts: [0; PIXELS + 1], entries: Vec::new(), leaving: [0; PIXELS] }
    }
}

impl Entered {
    /// Finds them of a tile whose corner and pixels these are.
    pub fn find(&mut self, cast: &Cast, lanes: LaneSet, tile: usize, corner: [usize; 2], size: [usize; 2]) {
        self.found.clear();
        self.leaving = [0; PIXELS];
        let Entered { found, leaving, .. } = self;
        dispatch(lanes, Find { cast, tile, corner, size, found, leaving });
        let mut next = [0u32; PIXELS + 1];
        for (pixel, _) in &self.found {
            next[usize::from(*pixel) + 1] += 1;
        }
        for pixel in 0..PIXELS {
            next[pixel + 1] += next[pixel];
        }
        self.starts = next;
        self.entries.resize(self.found.len(), Entry::default());
        for &(pixel, entry) in &self.found {
            let place = &mut next[usize::from(pixel)];
            self.entries[*place as usize] = entry;
            *place += 1;
        }
        for pixel in 0..PIXELS {
            self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize].sort_unstable();
        }
    }

    /// Of a pixel, the nearest first.
    pub(super) fn of(&self, pixel: usize) -> &[Entry] {
        &self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }

    /// See `leaving`.
    pub fn leaving(&self, pixel: usize) -> u32 {
        self.leaving[pixel]
    }
}

struct Find<'a> {
    cast: &'a Cast,
    tile: usize,
    corner: [usize; 2],
    size: [usize; 2],
    found: &'a mut Vec<(u8, Entry)>,
    leaving: &'a mut [u32; PIXELS],
}

impl Kernel for Find<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Find { cast, tile, corner: [left, top], size, found, leaving } = self;
        let points = &cast.points;
        let bits = points.pixel_bits;
        let pixel = points.pixel;
        for &number in cast.boundary.of(tile) {
            let outer = cast.half_faces.boundary[number as usize];
            let corner = |k: usize| {
                let [x, y, depth, _] = points.fours[0][outer.corners[k] as usize];
                [x.to_bits(), y.to_bits(), depth.to_bits()]
            };
            let corners = [corner(0), corner(1), corner(2)];
            // From the tile's first row, in whole rows.
            let top_place = (top << bits) as u32;
            let row_of = |k: usize| i64::from(corners[k][1].wrapping_sub(top_place) as i32) >> bits;
            let (a, b, c) = (row_of(0), row_of(1), row_of(2));
            let [first, last] = [a.min(b).min(c), a.max(b).max(c) + 1].map(
                #[inline(always)]
                |row| row.clamp(0, size[1] as i64) as usize,
            );
            for row in first..last {
                for half in (0..size[0]).step_by(L::WIDTH) {
                    let column = L::U::iota() + L::U::splat((left + half) as u32);
                    let x = column * L::U::splat(1 << bits);
                    let y = L::U::splat(((top + row) << bits) as u32);
                    let at: [At<L>; 3] = array(
                        #[inline(always)]
                        |k| {
                            let scaled = inlined(
                                #[inline(always)]
                                |place: u32, of_ray: L::U| {
                                    (L::U::splat(place) - of_ray).to_float() * L::F::splat(pixel)
                                },
                            );
                            [scaled(corners[k][0], x), scaled(corners[k][1], y)]
                        },
                    );
                    let edges = [[at[0], at[1]], [at[1], at[2]], [at[2], at[0]]];
                    let turns = [turn::<L>(at[0], at[1]), turn::<L>(at[1], at[2]), turn::<L>(at[2], at[0])];
                    let (side_0, side_1, side_2) = clockwise::<L>(turns, edges);
                    let meant = u32::MAX >> (32 - L::WIDTH.min(size[0] - half));
                    let mut in_by = side_0.and(side_1).and(side_2).bits() & meant;
                    let out_by = side_0.or(side_1).or(side_2).not();
                    let first = row * TILE + half;
                    if out_by.bits() & meant != 0 {
                        let of_half = &mut leaving[first..];
                        let (sum, more) = (L::U::load(of_half), L::U::splat(OUT | outer.half_face));
                        let out_by = lanes_of::<L>(out_by.bits() & meant);
                        L::U::select(out_by, sum + more, sum).store(of_half);
                    }
                    if in_by == 0 {
                        continue;
                    }
                    // Each corner's weight is the turn of the other two. From the nearest corner, so that nothing is less than 0.
                    let total = (turns[0] + turns[1] + turns[2]).max(L::F::splat(f32::MIN_POSITIVE));
                    let nearest = corners[0][2].min(corners[1][2]).min(corners[2][2]);
                    let farther = inlined(
                        #[inline(always)]
                        |k: usize| L::F::splat((corners[k][2] - nearest) as f32),
                    );
                    let above =
                        turns[1].mul_add(farther(0), turns[2].mul_add(farther(1), turns[0] * farther(2)));
                    let mut depths = [0; LANES_MOST];
                    (L::U::splat(nearest) + (above / total).to_unsigned()).store(&mut depths);
                    while in_by != 0 {
                        let lane = in_by.trailing_zeros() as usize;
                        found.push(((first + lane) as u8, Entry { depth: depths[lane], outer: number }));
                        in_by &= in_by - 1;
                    }
                }
            }
        }
    }
}
