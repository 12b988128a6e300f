//! The way of some rays of a bundle through cells.

use super::bundle::{Bundle, SLICES};
use super::half_faces::{OUT, TURN_BITS};
use super::here::Here;
use super::mean::Mean;
use super::points::Points;
use super::sides::{At, clockwise, turn};
use crate::fragments::batch::{Batch, LANES_MOST};
use crate::project::record::TILE;
use crate::shade::along::lanes_of;
use voltet_simd::{Awaited, Float, Lanes, Mask, Unsigned, array, inlined};

/// The way of some rays of a bundle, as far as a batch goes.
pub(super) struct Way<'a, 'b, L: Lanes, const PERSPECTIVE: bool, const N: usize> {
    bundle: &'a mut Bundle<'b>,
    half: usize,
    places: bool,
    /// What is known of the half-faces that rays came in by.
    records: Awaited<'b>,
    points: &'b Points,
    first: &'b [[f32; 4]],
    further: &'b [[f32; 4]],
    of_ray: [L::U; 2],
    here: Here<L, N>,
    live: L::M,
    any_live: bool,
    /// What each comes to next, as [`super::half_faces::HalfFaces::records`] have it.
    next: L::U,
    pub slice: usize,
    /// Segments of each ray that were found.
    segments: L::U,
}

/// The corner of each cell that is not one of the face that the ray came in by.
pub(super) struct Fourth<L: Lanes, const N: usize> {
    at: At<L>,
    depth: L::U,
    values: [L::F; N],
}

/// Without which of the corners at hand rays go out, and the turns of each of these with the fourth.
pub(super) struct Choice<L: Lanes> {
    without_0: L::M,
    without_1: L::M,
    without_2: L::M,
    turns: [L::F; 3],
}

impl<'a, 'b, L: Lanes, const PERSPECTIVE: bool, const N: usize> Way<'a, 'b, L, PERSPECTIVE, N> {
    #[inline(always)]
    pub fn begin(bundle: &'a mut Bundle<'b>, half: usize, places: bool) -> Self {
        let mine = u32::MAX >> (32 - L::WIDTH);
        let points = &bundle.cast.points;
        let mut way = Way {
            records: Awaited::first(&bundle.cast.half_faces.records),
            points,
            first: &points.fours[0],
            further: points.fours.get(1).map_or(&[], Vec::as_slice),
            of_ray: [L::U::load(&bundle.x[half..]), L::U::load(&bundle.y[half..])],
            here: Here::load(&bundle.rays, half),
            live: lanes_of::<L>(bundle.live >> half),
            any_live: bundle.live >> half & mine != 0,
            next: L::U::splat(0),
            slice: 0,
            segments: L::U::splat(0),
            bundle,
            half,
            places,
        };
        way.records.ask::<L>(L::U::load(&way.bundle.rays.half_face[half..]));
        let waiting = way.bundle.waiting >> half & mine;
        if waiting != 0 {
            way.bundle.waiting &= !(mine << half);
            way.enter(waiting);
        }
        way
    }

    #[inline(always)]
    pub fn goes_on(&self) -> bool {
        self.any_live && self.slice < SLICES
    }

    #[inline(always)]
    pub fn end(&mut self) {
        self.here.store(&mut self.bundle.rays, self.half);
        self.records.index::<L>().store(&mut self.bundle.rays.half_face[self.half..]);
        let mut segments = [0; LANES_MOST];
        self.segments.store(&mut segments);
        self.bundle.segments += segments.iter().copied().map(u64::from).sum::<u64>();
    }

    /// What is known of the half-faces that rays came in by: the corner opposite, and what may come next.
    #[inline(always)]
    pub fn read(&self) -> [L::U; 4] {
        let words = L::F::gather_awaited(&self.records);
        array(
            #[inline(always)]
            |k| words[k].to_bits(),
        )
    }

    /// The corner opposite.
    #[inline(always)]
    pub fn fourth(&self, number: L::U) -> Fourth<L, N> {
        let pixel = L::F::splat(self.points.pixel);
        let [x, y, depth, value] = L::F::gather_parts(self.first, number);
        let relative = inlined(
            #[inline(always)]
            |place: L::F, axis: usize| (place.to_bits() - self.of_ray[axis]).to_float() * pixel,
        );
        let mut values = [value; N];
        if N > 1 {
            let further = L::F::gather_parts(self.further, number);
            let mut a = 1;
            while a < N {
                values[a] = further[a - 1];
                a += 1;
            }
        }
        Fourth { at: [relative(x, 0), relative(y, 1)], depth: depth.to_bits(), values }
    }

    /// Finds the face by which each ray goes out, and what comes behind it.
    #[inline(always)]
    pub fn choose(&mut self, [_, next_0, next_1, next_2]: [L::U; 4], fourth: &Fourth<L, N>) -> Choice<L> {
        let Way { here, records, .. } = self;
        // The face whose edges to the fourth corner the ray passes on the two sides.
        let ([a, b, c], d) = (here.corners, fourth.at);
        let turns = [turn::<L>(a, d), turn::<L>(b, d), turn::<L>(c, d)];
        let (side_a, side_b, side_c) = clockwise::<L>(turns, [[a, d], [b, d], [c, d]]);
        let without_0 = side_c.and(side_b.not());
        let without_1 = side_a.and(side_c.not());
        let without_2 = without_0.or(without_1).not();

        // By the half-face's own order of corners.
        let three = L::U::splat(3);
        let modulo = inlined(
            #[inline(always)]
            |n: L::U| n.min(n - three),
        );
        let slot = modulo(L::U::select(
            without_0,
            here.turned,
            L::U::select(without_1, here.turned + L::U::splat(1), here.turned + L::U::splat(2)),
        ));
        let next = L::U::select(
            slot.equal(L::U::splat(0)),
            next_0,
            L::U::select(slot.equal(L::U::splat(1)), next_1, next_2),
        );
        here.turned = modulo(here.turned + next.and(L::U::splat((1 << TURN_BITS) - 1)));
        records.ask::<L>(next.shr::<TURN_BITS>());
        self.next = next;
        Choice { without_0, without_1, without_2, turns }
    }

    /// Puts the segments to the place where rays go out into a batch.
    #[inline(always)]
    pub fn go(&mut self, fourth: Fourth<L, N>, choice: Choice<L>, batch: &mut Batch) {
        let Way { bundle, half, here, live, points, .. } = self;
        let (half, live) = (*half, *live);
        let zero = L::F::splat(0.0);
        let Choice { without_0, without_1, without_2, turns: [ta, tb, tc] } = choice;
        let Fourth { at: d, depth, values } = fourth;
        let mut replace = inlined(
            #[inline(always)]
            |k: usize, without: L::M| {
                here.corners[k] = [
                    L::F::select(without, d[0], here.corners[k][0]),
                    L::F::select(without, d[1], here.corners[k][1]),
                ];
                here.depth[k] = L::U::select(without, depth, here.depth[k]);
                let mut a = 0;
                while a < N {
                    here.values[a][k] = L::F::select(without, values[a], here.values[a][k]);
                    a += 1;
                }
            },
        );
        replace(0, without_0);
        replace(1, without_1);
        replace(2, without_2);
        // Those of a face by which a ray goes out are clockwise.
        here.turns = [
            L::F::select(without_0, tb, L::F::select(without_1, ta, here.turns[0])).abs(),
            L::F::select(without_1, tc, L::F::select(without_2, tb, here.turns[1])).abs(),
            L::F::select(without_2, ta, L::F::select(without_0, tc, here.turns[2])).abs(),
        ];

        let mean = Mean::<L>::new::<PERSPECTIVE>(points, here.turns, here.depth, depth);
        let steps = mean.above.mul_add(mean.by_total, (depth - here.at).to_float()).max(zero);
        let at = here.at + (steps + L::F::splat(0.5)).to_unsigned();
        let distance = mean.distance;
        let length = steps * (L::F::load(&bundle.stretch[half..]) * L::F::splat(points.step));
        let length = if PERSPECTIVE { length * (here.distance * distance) } else { length };
        let mut out = [zero; N];
        let mut a = 0;
        while a < N {
            out[a] = mean.of(here.values[a], values[a]);
            a += 1;
        }

        let place = self.slice * TILE + half;
        L::F::select(live, length, zero).store(&mut batch.length[place..]);
        let mut a = 0;
        while a < N.min(batch.front.len()) {
            here.value[a].store(&mut batch.front[a][place..]);
            out[a].store(&mut batch.back[a][place..]);
            a += 1;
        }
        if self.places {
            L::U::load(&bundle.pixels[half..]).store(&mut batch.pixel[place..]);
            let depth_of = inlined(
                #[inline(always)]
                |at: L::U, distance: L::F| {
                    let parallel =
                        at.to_float().mul_add(L::F::splat(points.step), L::F::splat(points.nearest));
                    let depth = if PERSPECTIVE { distance } else { parallel };
                    depth - L::F::splat(bundle.distance_origin as f32)
                },
            );
            depth_of(here.at, here.distance).store(&mut batch.entry[place..]);
            depth_of(at, distance).store(&mut batch.exit[place..]);
        }
        let is_one = zero.lt(length).and(live);
        self.segments = L::U::select(is_one, self.segments + L::U::splat(1), self.segments);
        (here.at, here.distance, here.value) = (at, distance, out);
        self.slice += 1;
    }

    /// Those that have left the cells come in again, or end.
    #[inline(always)]
    pub fn turn(&mut self) {
        let out = self.next.test(L::U::splat(OUT)).and(self.live).bits();
        if out == 0 {
            return;
        }
        let Way { bundle, half, here, live, next, .. } = self;
        let half = *half;
        let mut by = [0; LANES_MOST];
        next.store(&mut by);
        here.at.store(&mut bundle.coming.at[half..]);
        let mut left = out;
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            let leaving = &mut bundle.leaving[half + lane];
            *leaving = leaving.wrapping_sub(by[lane]);
            bundle.come_in(half + lane);
            left &= left - 1;
        }
        let mine = u32::MAX >> (32 - L::WIDTH);
        self.any_live = !bundle.is_lost && bundle.live >> half & mine != 0;
        *live = lanes_of::<L>(bundle.live >> half);
        self.enter(out);
    }

    /// Puts some rays (bits) where they come in.
    #[inline(always)]
    fn enter(&mut self, rays: u32) {
        let coming = &self.bundle.coming;
        let half = self.half;
        let corner = inlined(
            #[inline(always)]
            |k: usize| self.fourth(L::U::load(&coming.corners[k][half..])),
        );
        let corners = [corner(0), corner(1), corner(2)];
        let at = L::U::load(&coming.at[half..]);
        let half_face = L::U::load(&coming.half_face[half..]);
        let [a, b, c] = [corners[0].at, corners[1].at, corners[2].at];
        let turns = [turn::<L>(a, b).abs(), turn::<L>(b, c).abs(), turn::<L>(c, a).abs()];
        let mean = Mean::<L>::new::<PERSPECTIVE>(
            self.points,
            turns,
            array(
                #[inline(always)]
                |k| corners[k].depth,
            ),
            corners[2].depth,
        );
        let entered = lanes_of::<L>(rays);
        let here = &mut self.here;
        let mut k = 0;
        while k < 3 {
            here.corners[k] = array(
                #[inline(always)]
                |axis| L::F::select(entered, corners[k].at[axis], here.corners[k][axis]),
            );
            here.depth[k] = L::U::select(entered, corners[k].depth, here.depth[k]);
            here.turns[k] = L::F::select(entered, turns[k], here.turns[k]);
            let mut a = 0;
            while a < N {
                here.values[a][k] = L::F::select(entered, corners[k].values[a], here.values[a][k]);
                a += 1;
            }
            k += 1;
        }
        let mut a = 0;
        while a < N {
            let values = [corners[0].values[a], corners[1].values[a], corners[2].values[a]];
            here.value[a] = L::F::select(entered, mean.of(values, values[2]), here.value[a]);
            a += 1;
        }
        self.records.ask::<L>(L::U::select(entered, half_face, self.records.index::<L>()));
        here.turned = L::U::select(entered, L::U::splat(0), here.turned);
        here.at = L::U::select(entered, at, here.at);
        here.distance = L::F::select(entered, mean.distance, here.distance);
    }
}
