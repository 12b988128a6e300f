//! Traversal of ray packets through cells.

use super::edge_functions::{FacePoint, Offset, edge_function, edges_inside, moved_by_depth};
use super::half_faces::{EXIT_FLAG, ROTATION_BITS};
use super::packet::{MAX_TRAVERSAL_STEPS, PACKETS_IN_FLIGHT, PacketState, RayPacket, SLICES};
use super::points::Points;
use super::ray_caster::MAX_RAYCAST_ATTRIBUTES;
use crate::fragments::batch::{Batch, MAX_LANES};
use crate::tile::TILE;
use voltet_simd::{
    Float, Kernel, LaneSet, Lanes, Mask, PrefetchedGather, Unsigned, array, dispatch, inlined, mask_of,
};

#[derive(Debug, Clone, Copy)]
pub(crate) struct PacketConfig {
    pub lanes: LaneSet,
    pub attribute_count: usize,
    /// True if pixels, entries and exits are needed.
    pub depths: bool,
}

/// Fills batches with the next segments of packets, slice by slice; returns their fragments, none at the end.
pub(crate) fn next_segments(
    config: PacketConfig,
    packets: &mut [RayPacket<'_>; PACKETS_IN_FLIGHT],
    batches: [&mut Batch; PACKETS_IN_FLIGHT],
) -> [usize; PACKETS_IN_FLIGHT] {
    let mut any_active = false;
    for packet in packets.iter_mut().filter(|packet| packet.is_active()) {
        packet.slices += SLICES;
        packet.is_mistracked |= MAX_TRAVERSAL_STEPS < packet.slices;
        any_active = true;
    }
    if !any_active || packets.iter().any(|packet| packet.is_mistracked) {
        return [0; PACKETS_IN_FLIGHT];
    }
    let PacketConfig { lanes, attribute_count, depths } = config;
    let is_cut = packets[0].caster.points.near.is_some();
    match attribute_count {
        // One serves all numbers of attributes where rays spread or the near plane cuts: a kernel takes long to compile.
        _ if is_cut => dispatch(lanes, Advance::<true, MAX_RAYCAST_ATTRIBUTES> { packets, depths, batches }),
        1 => dispatch(lanes, Advance::<false, 1> { packets, depths, batches }),
        2 => dispatch(lanes, Advance::<false, 2> { packets, depths, batches }),
        _ => dispatch(lanes, Advance::<false, MAX_RAYCAST_ATTRIBUTES> { packets, depths, batches }),
    }
}

/// Kernel that advances rays; with `CUT`, where the near plane may cut cells ([`Points::near`]).
struct Advance<'a, 'b, const CUT: bool, const N: usize> {
    packets: &'a mut [RayPacket<'b>; PACKETS_IN_FLIGHT],
    depths: bool,
    batches: [&'a mut Batch; PACKETS_IN_FLIGHT],
}

impl<const CUT: bool, const N: usize> Kernel<[usize; PACKETS_IN_FLIGHT]> for Advance<'_, '_, CUT, N> {
    #[inline(always)]
    fn run<L: Lanes>(self) -> [usize; PACKETS_IN_FLIGHT] {
        let Advance { packets, depths, mut batches } = self;
        let mut max = [0; PACKETS_IN_FLIGHT];
        let mut ends = [[0; 4]; PACKETS_IN_FLIGHT];
        for (number, half) in (0..TILE).step_by(L::WIDTH).enumerate() {
            let [packet_0, packet_1, packet_2, packet_3] = &mut *packets;
            let mut traversals = [
                PacketTraversal::<L, CUT, N>::begin(packet_0, half, depths),
                PacketTraversal::<L, CUT, N>::begin(packet_1, half, depths),
                PacketTraversal::<L, CUT, N>::begin(packet_2, half, depths),
                PacketTraversal::<L, CUT, N>::begin(packet_3, half, depths),
            ];
            // In turns, so that the gathers of one are hidden by the work of the others.
            let mut is_active = true;
            while is_active {
                is_active = false;
                let mut k = 0;
                while k < PACKETS_IN_FLIGHT {
                    let traversal = &mut traversals[k];
                    if traversal.is_active() {
                        is_active = true;
                        let record = traversal.read();
                        let opposite = traversal.opposite_vertex(record[0]);
                        let exit = traversal.choose_exit(record, &opposite);
                        traversal.advance(opposite, exit, batches[k]);
                        traversal.reenter();
                    }
                    k += 1;
                }
            }
            let mut k = 0;
            while k < PACKETS_IN_FLIGHT {
                traversals[k].end();
                ends[k][number] = traversals[k].slice;
                max[k] = max[k].max(traversals[k].slice);
                k += 1;
            }
        }
        // Where some lanes end sooner.
        for (number, half) in (0..TILE).step_by(L::WIDTH).enumerate() {
            for (k, batch) in batches.iter_mut().enumerate() {
                for slice in ends[k][number]..max[k] {
                    L::F::splat(0.0).store(&mut batch.length[slice * TILE + half..]);
                }
            }
        }
        array!(|k| max[k] * TILE)
    }
}

/// Traversal of one SIMD half of a ray packet, until the batch is full.
pub(super) struct PacketTraversal<'a, 'b, L: Lanes, const CUT: bool, const N: usize> {
    packet: &'a mut RayPacket<'b>,
    half: usize,
    depths: bool,
    /// Records of the half-faces that rays entered by.
    records: PrefetchedGather<'b>,
    points: &'b Points,
    first: &'b [[f32; 4]],
    further: &'b [[f32; 4]],
    of_ray: [L::U; 2],
    near: L::U,
    state: PacketState<L, N>,
    active: L::M,
    any_active: bool,
    /// Next half-face of each ray, as [`super::half_faces::HalfFaces::records`] have it.
    next: L::U,
    pub slice: usize,
    /// Segments of each ray so far.
    segments: L::U,
}

/// Vertex opposite the entry face.
pub(super) struct OppositeVertex<L: Lanes, const N: usize> {
    at: Offset<L>,
    depth: L::U,
    values: [L::F; N],
}

/// Exit face: the corner of the entry face that it lacks, and the edge functions of these corners with the opposite vertex.
pub(super) struct ExitFace<L: Lanes> {
    without_0: L::M,
    without_1: L::M,
    without_2: L::M,
    functions: [L::F; 3],
}

impl<'a, 'b, L: Lanes, const CUT: bool, const N: usize> PacketTraversal<'a, 'b, L, CUT, N> {
    #[inline(always)]
    pub fn begin(packet: &'a mut RayPacket<'b>, half: usize, depths: bool) -> Self {
        let mine = u32::MAX >> (32 - L::WIDTH);
        let points = &packet.caster.points;
        let mut traversal = PacketTraversal {
            records: PrefetchedGather::first(&packet.caster.half_faces.records),
            points,
            first: &points.quads[0],
            // Without further attributes what is gathered is not used.
            further: points.quads.get(1).unwrap_or(&points.quads[0]),
            of_ray: array!(|axis| L::U::load(&packet.position[axis][half..])),
            near: L::U::splat(points.near.unwrap_or(0)),
            state: PacketState::load(&packet.state, half),
            active: mask_of::<L>(packet.active >> half),
            any_active: packet.active >> half & mine != 0,
            next: L::U::splat(0),
            slice: 0,
            segments: L::U::splat(0),
            packet,
            half,
            depths,
        };
        traversal.records.ask::<L>(L::U::load(&traversal.packet.state.half_face[half..]));
        let entering = traversal.packet.entering >> half & mine;
        if entering != 0 {
            traversal.packet.entering &= !(mine << half);
            traversal.ask_pending(entering);
            traversal.enter(entering);
        }
        traversal
    }

    #[inline(always)]
    pub fn is_active(&self) -> bool {
        self.any_active && self.slice < SLICES
    }

    #[inline(always)]
    pub fn end(&mut self) {
        self.state.store(&mut self.packet.state, self.half);
        self.records.index::<L>().store(&mut self.packet.state.half_face[self.half..]);
        let mut segments = [0; MAX_LANES];
        self.segments.store(&mut segments);
        self.packet.segments += segments.iter().copied().map(u64::from).sum::<u64>();
    }

    /// Records of the half-faces that rays entered by: the opposite vertex, and the next half-faces.
    #[inline(always)]
    pub fn read(&self) -> [L::U; 4] {
        let words = L::F::gather_awaited(&self.records);
        array!(|k| words[k].to_bits())
    }

    #[inline(always)]
    pub fn opposite_vertex(&self, number: L::U) -> OppositeVertex<L, N> {
        let pixel = L::F::splat(self.points.pixel);
        let [x, y, depth, value] = L::F::gather_parts(self.first, number);
        let relative = inlined!(|position: L::F, axis: usize| {
            let mut position = position.to_bits() - self.of_ray[axis];
            if CUT {
                let spread = L::U::load(&self.packet.spread[axis][self.half..]);
                position = position - moved_by_depth::<L>(depth.to_bits(), spread);
            }
            position.to_float() * pixel
        });
        let mut values = [value; N];
        if N > 1 {
            let further = L::F::gather_parts(self.further, number);
            let mut a = 1;
            while a < N {
                values[a] = further[a - 1];
                a += 1;
            }
        }
        OppositeVertex { at: [relative(x, 0), relative(y, 1)], depth: depth.to_bits(), values }
    }

    /// Selects the face by which each ray exits, and the half-face behind it.
    #[inline(always)]
    pub fn choose_exit(
        &mut self,
        [_, next_0, next_1, next_2]: [L::U; 4],
        opposite: &OppositeVertex<L, N>,
    ) -> ExitFace<L> {
        let PacketTraversal { state, records, active, .. } = self;
        // The face whose edges to the fourth corner the ray passes on the two sides.
        let ([a, b, c], d) = (state.corners, opposite.at);
        let functions = [edge_function::<L>(a, d), edge_function::<L>(b, d), edge_function::<L>(c, d)];
        let (side_a, side_b, side_c) = edges_inside::<L>(functions, [[a, d], [b, d], [c, d]], *active);
        let without_0 = side_c.and(side_b.not());
        let without_1 = side_a.and(side_c.not());
        let without_2 = without_0.or(without_1).not();

        // By the half-face's own order of corners.
        let three = L::U::splat(3);
        let modulo = inlined!(|n: L::U| n.min(n - three));
        let slot = modulo(L::U::select(
            without_0,
            state.rotation,
            L::U::select(without_1, state.rotation + L::U::splat(1), state.rotation + L::U::splat(2)),
        ));
        let next = L::U::select(
            slot.equal(L::U::splat(0)),
            next_0,
            L::U::select(slot.equal(L::U::splat(1)), next_1, next_2),
        );
        state.rotation = modulo(state.rotation + next.and(L::U::splat((1 << ROTATION_BITS) - 1)));
        records.ask::<L>(next.shr::<ROTATION_BITS>());
        self.next = next;
        ExitFace { without_0, without_1, without_2, functions }
    }

    /// Advances rays to their exits, and puts the segments into a batch.
    #[inline(always)]
    pub fn advance(&mut self, opposite: OppositeVertex<L, N>, exit: ExitFace<L>, batch: &mut Batch) {
        let PacketTraversal { packet, half, state, active, points, near, .. } = self;
        let (half, active) = (*half, *active);
        let zero = L::F::splat(0.0);
        let ExitFace { without_0, without_1, without_2, functions: [fa, fb, fc] } = exit;
        let OppositeVertex { at: d, depth, values } = opposite;
        let mut replace = inlined!(|k: usize, without: L::M| {
            let corner = array!(|axis| L::F::select(without, d[axis], state.corners[k][axis]));
            let corner_depth = L::U::select(without, depth, state.depth[k]);
            let corner_values: [L::F; N] = array!(|a| L::F::select(without, values[a], state.values[a][k]));
            // Else the compiler makes one masked store of a selection and the store to where it was loaded from, which takes
            // a dozen cycles on some processors.
            std::hint::black_box(());
            (state.corners[k], state.depth[k]) = (corner, corner_depth);
            let mut a = 0;
            while a < N {
                state.values[a][k] = corner_values[a];
                a += 1;
            }
        });
        replace(0, without_0);
        replace(1, without_1);
        replace(2, without_2);
        // The edge functions of an exit face are clockwise.
        state.functions = [
            L::F::select(without_0, fb, L::F::select(without_1, fa, state.functions[0])).abs(),
            L::F::select(without_1, fc, L::F::select(without_2, fb, state.functions[1])).abs(),
            L::F::select(without_2, fa, L::F::select(without_0, fc, state.functions[2])).abs(),
        ];

        let point = FacePoint::<L>::new(points, state.functions, state.depth);
        let FacePoint { depth: at, distance, .. } = point;
        let out: [L::F; N] = array!(|a| point.interpolate(state.values[a]));
        // Of a cell that the ray passes at an edge the second face may lie before the first by rounding.
        let mut steps = (at - state.at).to_float().max(zero);
        let (mut begin, mut end) = (state.at, at);
        if CUT {
            let later = inlined!(|depth: L::U| depth + *near - depth.min(*near));
            (begin, end) = (later(begin), later(end));
            let is_cut = begin.equal(state.at).not();
            if is_cut.any() {
                let left = (at - begin).to_float().max(zero);
                let fraction = left / steps.max(L::F::splat(1.0));
                steps = L::F::select(is_cut, left, steps);
                let mut a = 0;
                while a < N {
                    let value = fraction.mul_add(state.value[a] - out[a], out[a]);
                    state.value[a] = L::F::select(is_cut, value, state.value[a]);
                    a += 1;
                }
            }
        }
        let length = steps * (L::F::load(&packet.length_per_depth[half..]) * L::F::splat(points.step));
        let length = if points.perspective { length * (state.distance * distance) } else { length };

        let slot = self.slice * TILE + half;
        L::F::select(active, length, zero).store(&mut batch.length[slot..]);
        let mut a = 0;
        while a < N.min(batch.front.len()) {
            state.value[a].store(&mut batch.front[a][slot..]);
            out[a].store(&mut batch.back[a][slot..]);
            a += 1;
        }
        if self.depths {
            L::U::load(&packet.pixels[half..]).store(&mut batch.pixel[slot..]);
            // From the distance origin: far from the eye, a depth has no digits left in 32 bits.
            let offset = L::F::splat((points.first_depth - packet.distance_origin) as f32);
            let depth_of = inlined!(|at: L::U, distance: L::F| {
                // 1 / z₀ − 1 / z is in steps, and z − z₀ = z z₀ (1 / z₀ − 1 / z).
                let scale = distance * L::F::splat(points.first_depth as f32);
                let scale = if points.perspective { scale } else { L::F::splat(1.0) };
                at.to_float().mul_add(L::F::splat(points.step) * scale, offset)
            });
            depth_of(begin, state.distance).store(&mut batch.entry[slot..]);
            depth_of(end, distance).store(&mut batch.exit[slot..]);
        }
        let is_one = zero.lt(length).and(active);
        self.segments = self.segments + L::U::select(is_one, L::U::splat(1), L::U::splat(0));
        (state.at, state.distance, state.value) = (at, distance, out);
        self.slice += 1;
    }

    /// Rays that have exited the cells enter again, or end.
    #[inline(always)]
    pub fn reenter(&mut self) {
        let out = self.next.test(L::U::splat(EXIT_FLAG)).and(self.active).bits();
        if out == 0 {
            return;
        }
        let PacketTraversal { packet, half, state, active, next, .. } = self;
        let half = *half;
        let mut by = [0; MAX_LANES];
        next.store(&mut by);
        state.at.store(&mut packet.pending.at[half..]);
        let mut remaining = out;
        while remaining != 0 {
            let lane = remaining.trailing_zeros() as usize;
            let checksum = &mut packet.exit_checksum[half + lane];
            *checksum = checksum.wrapping_sub(by[lane]);
            packet.enter_grid(half + lane);
            remaining &= remaining - 1;
        }
        let mine = u32::MAX >> (32 - L::WIDTH);
        self.any_active = !packet.is_mistracked && packet.active >> half & mine != 0;
        *active = mask_of::<L>(packet.active >> half);
        let entering = out & packet.active >> half;
        // Of rays that end the next half-face is the sentinel.
        self.ask_pending(out);
        if entering != 0 {
            self.enter(entering);
        }
    }

    /// Asks for the records of the half-faces that some rays (bits) enter by next.
    #[inline(always)]
    fn ask_pending(&mut self, rays: u32) {
        let pending = L::U::load(&self.packet.pending.half_face[self.half..]);
        self.records.ask::<L>(L::U::select(mask_of::<L>(rays), pending, self.records.index::<L>()));
    }

    /// Puts some rays (bits) at their entries, whose records were [asked for](Self::ask_pending).
    #[inline(always)]
    fn enter(&mut self, rays: u32) {
        let pending = &self.packet.pending;
        let half = self.half;
        let corner = inlined!(|k: usize| self.opposite_vertex(L::U::load(&pending.corners[k][half..])));
        let corners = [corner(0), corner(1), corner(2)];
        let at = L::U::load(&pending.at[half..]);
        let [a, b, c] = [corners[0].at, corners[1].at, corners[2].at];
        let functions =
            [edge_function::<L>(a, b).abs(), edge_function::<L>(b, c).abs(), edge_function::<L>(c, a).abs()];
        let point = FacePoint::<L>::new(self.points, functions, array!(|k| corners[k].depth));
        let entered = mask_of::<L>(rays);
        let state = &mut self.state;
        let mut k = 0;
        while k < 3 {
            state.corners[k] =
                array!(|axis| L::F::select(entered, corners[k].at[axis], state.corners[k][axis]));
            state.depth[k] = L::U::select(entered, corners[k].depth, state.depth[k]);
            state.functions[k] = L::F::select(entered, functions[k], state.functions[k]);
            let mut a = 0;
            while a < N {
                state.values[a][k] = L::F::select(entered, corners[k].values[a], state.values[a][k]);
                a += 1;
            }
            k += 1;
        }
        let mut a = 0;
        while a < N {
            let values = [corners[0].values[a], corners[1].values[a], corners[2].values[a]];
            state.value[a] = L::F::select(entered, point.interpolate(values), state.value[a]);
            a += 1;
        }
        state.rotation = L::U::select(entered, L::U::splat(0), state.rotation);
        state.at = L::U::select(entered, at, state.at);
        state.distance = L::F::select(entered, point.distance, state.distance);
    }
}
