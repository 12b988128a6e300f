//! Pre-integrated tables, filled as in 64 bits and read by gathers. They serve every segment.

use crate::PreIntegrated;
use crate::ramp::{Material, Ramp};
use crate::square::LaneSquare;
use voltet_cpu::integrator::{LaneKernel, LaneScene, NEGLIGIBLE_DEPTH, SegmentBatch, SegmentResults};
use voltet_simd::optics::elementary::mean_transparency;
use voltet_simd::{Float, Lanes, Mask, Unsigned, array, inlined};

/// Depths of a segment or a step beyond which it is opaque whatever they are; their products stay numbers.
const MAX_DEPTH: f32 = 1e30;

/// Nodes about a place that tiles read: the next in s and in t, four for the next plane, and the next of the table that filled
/// them; one over.
const TILES_REACH: f32 = 8.0;

pub(crate) struct LaneTable {
    table: PreIntegrated,
    /// Stored position of the first node, and nodes a stored unit.
    start: f32,
    per_value: f32,
    per_length: f32,
    /// For each step from node to node the first at or behind it in which something is.
    filled: Vec<f32>,
    /// ρ̄ of (s_f, s_b), where tiles do not hold it.
    means: Option<LaneSquare>,
}

impl LaneTable {
    pub fn new(table: PreIntegrated, scene: &LaneScene<'_>) -> LaneTable {
        let longest = scene.length() / scene.extent().longest;
        let [low, high] = table.ramp.range;
        let (axis, size) = (scene.scalar_axis(), table.ramp.size());
        LaneTable {
            start: ((low - axis.offset) / axis.scale) as f32,
            per_value: ((size - 1) as f64 * axis.scale / (high - low)) as f32,
            per_length: longest as f32,
            filled: filled(&table.ramp, longest, scene.may_skip()),
            means: table.last_tile.map(|_| LaneSquare::new(&table.extinction, size)),
            table,
        }
    }

    /// Trilinear, at a place in entries, which must lie within.
    #[inline(always)]
    fn read<L: Lanes>(&self, row: L::F, column: L::F, plane: L::F) -> [L::F; 4] {
        let splat = L::F::splat;
        let split = inlined(
            #[inline(always)]
            |x: L::F, last: usize| {
                let low = x.floor().min(splat((last - 1) as f32));
                (low.to_unsigned(), x - low)
            },
        );
        let size = self.table.ramp.size();
        let last_plane = self.table.last_tile.unwrap_or(size - 1);
        let ((i, u), (j, v), (k, w)) =
            (split(row, size - 1), split(column, size - 1), split(plane, last_plane));
        let [next_row, next_plane] = [size, size * size].map(|n| L::U::splat(n as u32));
        let first = k * next_plane + i * next_row + j;
        let mix = inlined(
            #[inline(always)]
            |a: [L::F; 4], b: [L::F; 4], share: L::F| -> [L::F; 4] {
                array(
                    #[inline(always)]
                    |c| share.mul_add(b[c] - a[c], a[c]),
                )
            },
        );
        let corner = inlined(
            #[inline(always)]
            |at: L::U| {
                let near = L::F::gather_parts(&self.table.glow, at);
                mix(near, L::F::gather_parts(&self.table.glow, at + next_plane), w)
            },
        );
        let next_column = L::U::splat(1);
        let low = mix(corner(first), corner(first + next_column), v);
        let second = first + next_row;
        mix(low, mix(corner(second), corner(second + next_column), v), u)
    }
}

impl LaneKernel for LaneTable {
    fn table_bytes(&self) -> usize {
        size_of_val(self.table.glow.as_slice()) + self.means.as_ref().map_or(0, LaneSquare::bytes)
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let last = splat((self.table.ramp.size() - 1) as f32);
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let segments = batch.segments::<L>(at);
            let (front_values, back_values) = (segments.front(), segments.back());
            let [front, back]: [L::F; 2] = array(
                #[inline(always)]
                |end| {
                    let s = if end == 0 { front_values[0] } else { back_values[0] };
                    ((s - splat(self.start)) * splat(self.per_value)).max(zero).min(last)
                },
            );
            // Values that are not numbers contribute nothing.
            let numbers = front_values[0].le(front_values[0]).and(back_values[0].le(back_values[0]));
            let reach = splat(if self.means.is_some() { TILES_REACH } else { 0.0 });
            let first = (front.min(back) - reach).floor().max(zero).min(last - one);
            let next = L::F::gather(&self.filled, first.to_unsigned());
            let behind = (front.max(back) + reach).floor() + one;
            let there = segments.crossing().and(numbers).and(next.lt(behind));
            if !there.any() {
                results.put_nothing::<L>(at);
                continue;
            }
            results.count_evaluations(u64::from(batch.within::<L>(there, at).count_ones()));
            let length = segments.length() * splat(self.per_length);
            let share = length.max(zero).min(one);
            let [r, g, b, mean] = match (&self.means, self.table.last_tile) {
                (Some(means), Some(last_tile)) => {
                    let [angle, s] = to_cylinder::<L>(front / last, back / last, share);
                    let [r, g, b, _] =
                        self.read::<L>(s.min(one) * last, back, angle * splat(last_tile as f32));
                    [r, g, b, means.read(&means.place::<L>(front, back))]
                }
                _ => self.read::<L>(front, back, share.sqrt() * last),
            };
            let depth = L::F::select(there, mean * length, zero);
            let through = mean_transparency::<L>(depth.min(splat(MAX_DEPTH)));
            let reach = L::F::select(there, length * through, zero);
            let opacity = (depth.min(splat(MAX_DEPTH)) * through).min(one);
            results.put_depth::<L>(at, depth.min(splat(f32::MAX)));
            results.put_color::<L>(at, [r * reach, g * reach, b * reach], opacity);
        }
    }
}

/// For each step between nodes the first at or behind it in which something is, or beyond all. What a ray of a scene's length may
/// lose by the others is what it may lose by the widgets that segments hardly meet; without leave to leave out, nothing.
/// `longest`: longest segments a scene length.
fn filled(ramp: &Ramp, longest: f64, leave_out: bool) -> Vec<f32> {
    let least = if leave_out { NEGLIGIBLE_DEPTH } else { 0.0 };
    let most = |matter: &Material| matter.glow.into_iter().fold(matter.extinction, f64::max) * longest;
    let (nodes, parts) = (ramp.nodes(), ramp.parts());
    let pieces = |k: usize| &ramp.pieces()[k * parts..(k + 1) * parts];
    let holds = |k: usize| nodes[k..=k + 1].iter().chain(pieces(k)).any(|matter| most(matter) > least);
    let mut next = nodes.len() as f32 + 1.0 + TILES_REACH;
    let mut filled = vec![next; nodes.len() - 1];
    for k in (0..filled.len()).rev() {
        if holds(k) {
            next = k as f32;
        }
        filled[k] = next;
    }
    filled
}

/// f⁻¹, Eq. 10: α and s of (s_f, s_b, l); t is s_b. At s_f = s_b, l = 0 every α serves.
#[inline(always)]
fn to_cylinder<L: Lanes>(front: L::F, back: L::F, length: L::F) -> [L::F; 2] {
    let splat = L::F::splat;
    let fall = front - back;
    let (steep, size) = (fall.abs(), fall.abs().max(length));
    // Which of the two is the smaller decides the branch; the quotient is then at most 1.
    let long = steep.le(length);
    let quotient = splat(0.25) * steep.min(length) / size.max(splat(f32::MIN_POSITIVE));
    let from_start = L::F::select(long, splat(0.5) - quotient, quotient);
    let angle = L::F::select(fall.lt(splat(0.0)), splat(1.0) - from_start, from_start);
    [L::F::select(splat(0.0).lt(size), angle, splat(0.5)), size]
}
