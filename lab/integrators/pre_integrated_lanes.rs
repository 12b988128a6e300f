//! Pre-integrated tables. Twin of `{PreIntegrated, PreIntegratedCylindrical}`: C/(D E₁) from a table over
//! (s_f, s_b, D), or from tiles, and the mean extinction, filled in lanes and read by gathers. They serve every segment.

use crate::ramp::{Material, Ramp, single};
use crate::square::LaneSquare;
use rayon::prelude::*;
use voltet_core::Result;
use voltet_cpu::integrator::{LaneKernel, LaneScene, NEGLIGIBLE_DEPTH, SegmentBatch, SegmentResults};
use voltet_simd::optics::elementary::mean_transparency;
use voltet_simd::{Float, Kernel, Lanes, Mask, Unsigned, array, dispatch, inlined};

/// Depths of a segment or a step beyond which it is opaque whatever they are; their products stay numbers.
const MAX_DEPTH: f32 = 1e30;

/// Nodes about a place that tiles read: the next in s and in t, four for the next plane, and the next of the table that filled
/// them; one over.
const TILES_REACH: f32 = 8.0;

pub(crate) struct LaneTable {
    side: usize,
    /// Stored position of the first node, and nodes a stored unit.
    start: f32,
    per_value: f32,
    per_length: f32,
    /// For each step from node to node the first at or behind it in which something is.
    filled: Vec<f32>,
    kind: Kind,
}

enum Kind {
    /// Over (s_f, s_b, D); the fourth number is ρ̄.
    Slices(LaneVolume),
    /// Over (α, s, t), and ρ̄ of (s_f, s_b).
    Tiles { tiles: LaneVolume, last: f32, means: LaneSquare },
}

impl LaneTable {
    /// `size` entries a side, `oversampling` pieces from one to the next; `last_tile`: tiles less 1, `None` for no tiles. Errors:
    /// data without a domain for a table.
    pub fn new(
        size: usize,
        oversampling: usize,
        last_tile: Option<usize>,
        scene: &LaneScene<'_>,
    ) -> Result<LaneTable> {
        let (extent, lanes) = (scene.extent(), scene.lanes());
        let ramp = Ramp::new(scene.transfer_function, size, oversampling, extent)?;
        let [low, high] = ramp.range;
        let axis = scene.scalar_axis();
        let narrow = LaneRamp::new(&ramp);
        let mut slices = LaneVolume::new(size, size);
        let (entries, length) = slices.groups();
        entries.par_chunks_mut(length).enumerate().for_each(|(group, out)| {
            dispatch(lanes, FillSlices { ramp: &narrow, group, planes: size, out });
        });
        let kind = if let Some(last) = last_tile {
            let mut tiles = LaneVolume::new(size, last + 1);
            let (entries, length) = tiles.groups();
            entries.par_chunks_mut(length).enumerate().for_each(|(group, out)| {
                dispatch(lanes, FillTiles { table: &slices, group, planes: last + 1, out });
            });
            Kind::Tiles { tiles, last: last as f32, means: LaneSquare::new(narrow.means(), size) }
        } else {
            Kind::Slices(slices)
        };
        Ok(LaneTable {
            side: size,
            start: ((low - axis.offset) / axis.scale) as f32,
            per_value: ((size - 1) as f64 * axis.scale / (high - low)) as f32,
            per_length: (scene.length() / extent.longest) as f32,
            filled: filled(&ramp, scene.length() / extent.longest, scene.may_skip()),
            kind,
        })
    }
}

impl LaneKernel for LaneTable {
    fn table_bytes(&self) -> usize {
        match &self.kind {
            Kind::Slices(slices) => slices.bytes(),
            Kind::Tiles { tiles, means, .. } => tiles.bytes() + means.bytes(),
        }
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let last = splat((self.side - 1) as f32);
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
            let reach = match self.kind {
                Kind::Slices(_) => zero,
                Kind::Tiles { .. } => splat(TILES_REACH),
            };
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
            let [r, g, b, mean] = match &self.kind {
                Kind::Slices(slices) => slices.read::<L>(front, back, share.sqrt() * last),
                Kind::Tiles { tiles, last: last_tile, means } => {
                    let [angle, s] = to_cylinder::<L>(front / last, back / last, share);
                    let [r, g, b, _] = tiles.read::<L>(s.min(one) * last, back, angle * splat(*last_tile));
                    [r, g, b, means.read(&means.place::<L>(front, back))]
                }
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

struct FillSlices<'a> {
    ramp: &'a LaneRamp,
    group: usize,
    planes: usize,
    out: &'a mut [[f32; 4]],
}

impl Kernel for FillSlices<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.ramp.fill::<L>(self.group, self.planes, self.out);
    }
}

struct FillTiles<'a> {
    table: &'a LaneVolume,
    group: usize,
    planes: usize,
    out: &'a mut [[f32; 4]],
}

impl Kernel for FillTiles<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        fill_tiles::<L>(self.table, self.group, self.planes, self.out);
    }
}

/// Planes of a group: as many as the widest vector has lanes.
const GROUP: usize = 16;

/// A table of three dimensions.
#[derive(Debug, Clone)]
struct LaneVolume {
    side: usize,
    planes: usize,
    entries: Vec<[f32; 4]>,
}

impl LaneVolume {
    /// Zeros: `side` rows and columns, `planes` ≥ 2.
    pub fn new(side: usize, planes: usize) -> LaneVolume {
        let entries = vec![[0.0; 4]; side * side * planes.next_multiple_of(GROUP)];
        LaneVolume { side, planes, entries }
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }

    /// The groups of planes, one after the other, and how long each is.
    pub fn groups(&mut self) -> (&mut [[f32; 4]], usize) {
        let length = self.side * self.side * GROUP;
        (&mut self.entries, length)
    }

    /// Trilinear, at a place in entries, which must lie within.
    #[inline(always)]
    pub fn read<L: Lanes>(&self, row: L::F, column: L::F, plane: L::F) -> [L::F; 4] {
        let splat = L::F::splat;
        let split = inlined(
            #[inline(always)]
            |x: L::F, count: usize| {
                let low = x.floor().min(splat((count - 2) as f32));
                (low.to_unsigned(), x - low)
            },
        );
        let ((i, u), (j, v), (k, w)) =
            (split(row, self.side), split(column, self.side), split(plane, self.planes));
        let side = L::U::splat(self.side as u32);
        let group = L::U::splat((self.side * self.side * GROUP) as u32);
        let of_plane = inlined(
            #[inline(always)]
            |k: L::U| k.shr::<4>() * group + k.and(L::U::splat(GROUP as u32 - 1)),
        );
        let (one, first) = (L::U::splat(1), (i * side + j).shl::<4>());
        let (near, far) = (first + of_plane(k), first + of_plane(k + one));
        let next_row = side.shl::<4>();
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
            |more: L::U| {
                let near = L::F::gather_parts(&self.entries, near + more);
                mix(near, L::F::gather_parts(&self.entries, far + more), w)
            },
        );
        let next_column = one.shl::<4>();
        let low = mix(corner(L::U::splat(0)), corner(next_column), v);
        mix(low, mix(corner(next_row), corner(next_row + next_column), v), u)
    }
}

/// Emission (divided by D) and transmittance of a slice.
#[derive(Clone, Copy)]
struct Light<L: Lanes> {
    emission: [L::F; 3],
    through: L::F,
}

impl<L: Lanes> Light<L> {
    #[inline(always)]
    fn clear() -> Self {
        Light { emission: [L::F::splat(0.0); 3], through: L::F::splat(1.0) }
    }

    /// A homogeneous stretch: the share `share` of a path of length D.
    #[inline(always)]
    fn new(matter: &Narrow, length: L::F, share: f32) -> Self {
        let splat = L::F::splat;
        let depth = (splat(matter.extinction) * (length * splat(share))).min(splat(MAX_DEPTH));
        let mean = mean_transparency::<L>(depth);
        let emission = array(
            #[inline(always)]
            |c| splat(matter.glow[c] * share) * mean,
        );
        Light { emission, through: (splat(1.0) - depth * mean).max(splat(0.0)) }
    }

    #[inline(always)]
    fn over(&self, behind: &Self) -> Self {
        Light {
            emission: array(
                #[inline(always)]
                |c| self.through.mul_add(behind.emission[c], self.emission[c]),
            ),
            through: self.through * behind.through,
        }
    }
}

/// Matter in 32 bits.
struct Narrow {
    extinction: f32,
    glow: [f32; 3],
}

impl Narrow {
    fn new(matter: &Material) -> Narrow {
        Narrow { extinction: single(matter.extinction), glow: matter.glow.map(single) }
    }
}

/// A transfer function of the scalar alone, in 32 bits.
struct LaneRamp {
    nodes: Vec<Narrow>,
    /// The pieces of all steps, from the lowest node on.
    pieces: Vec<Narrow>,
    parts: usize,
    /// ρ̄ of each path, row by row.
    means: Vec<f32>,
}

impl LaneRamp {
    pub fn new(ramp: &Ramp) -> LaneRamp {
        LaneRamp {
            nodes: ramp.nodes().iter().map(Narrow::new).collect(),
            pieces: ramp.pieces().iter().map(Narrow::new).collect(),
            parts: ramp.parts(),
            means: ramp.mean_extinctions(),
        }
    }

    /// ρ̄ of each path (i, j), row by row.
    pub fn means(&self) -> &[f32] {
        &self.means
    }

    /// Fills planes of the table over (s_f, s_b, D): those of group `group` of a volume of as many `planes`, at D = (k/(planes −
    /// 1))². The paths of equal span share their work, as in the twin.
    #[inline(always)]
    pub fn fill<L: Lanes>(&self, group: usize, planes: usize, out: &mut [[f32; 4]]) {
        let n = self.nodes.len();
        let mut scratch: [Vec<Light<L>>; 6] = std::array::from_fn(|_| vec![Light::clear(); n - 1]);
        for lane in (0..GROUP).step_by(L::WIDTH) {
            let k = L::U::iota() + L::U::splat((group * GROUP + lane) as u32);
            let share = (k.to_float() * L::F::splat(1.0 / (planes - 1) as f32)).min(L::F::splat(1.0));
            self.fill_lanes::<L>(share * share, lane, &mut scratch, out);
        }
    }

    #[inline(always)]
    fn fill_lanes<L: Lanes>(
        &self,
        length: L::F,
        lane: usize,
        [there, begun, left, back, back_begun, back_left]: &mut [Vec<Light<L>>; 6],
        out: &mut [[f32; 4]],
    ) {
        let n = self.nodes.len();
        let mut store = inlined(
            #[inline(always)]
            |i: usize, j: usize, glow: [L::F; 3]| {
                let most = L::F::splat(f32::MAX);
                let [r, g, b] = glow;
                let parts = [r.min(most), g.min(most), b.min(most), L::F::splat(self.means[i * n + j])];
                let first = (i * n + j) * GROUP + lane;
                L::F::scatter_parts([parts], out[first..first + L::WIDTH].as_chunks_mut().0, L::U::iota());
            },
        );
        for (i, node) in self.nodes.iter().enumerate() {
            store(i, i, node.glow.map(L::F::splat));
        }
        for span in 1..n {
            let share = 1.0 / (span * self.parts) as f32;
            for i in 0..n - 1 {
                let mut forth = Light::<L>::clear();
                let mut against = Light::<L>::clear();
                for piece in &self.pieces[i * self.parts..(i + 1) * self.parts] {
                    let light = Light::new(piece, length, share);
                    forth = forth.over(&light);
                    against = light.over(&against);
                }
                there[i] = forth;
                back[i] = against;
            }
            // Of each step: its block up to it, and from it on.
            for i in 0..n - 1 {
                let starts = i.is_multiple_of(span);
                begun[i] = if starts { there[i] } else { begun[i - 1].over(&there[i]) };
                back_begun[i] = if starts { back[i] } else { back[i].over(&back_begun[i - 1]) };
            }
            for i in (0..n - 1).rev() {
                let ends = (i + 1).is_multiple_of(span) || i + 2 == n;
                left[i] = if ends { there[i] } else { there[i].over(&left[i + 1]) };
                back_left[i] = if ends { back[i] } else { back_left[i + 1].over(&back[i]) };
            }
            for i in 0..n - span {
                let (mut forth, mut against) = (left[i], back_left[i]);
                if !i.is_multiple_of(span) {
                    forth = forth.over(&begun[i + span - 1]);
                    against = back_begun[i + span - 1].over(&against);
                }
                // The depth both ways.
                let depth = L::F::splat(self.means[i * n + i + span]) * length;
                let mean = mean_transparency::<L>(depth.min(L::F::splat(MAX_DEPTH)));
                let inverse = L::F::splat(1.0) / mean;
                let glow = inlined(
                    #[inline(always)]
                    |light: &Light<L>| -> [L::F; 3] {
                        array(
                            #[inline(always)]
                            |c| light.emission[c] * inverse,
                        )
                    },
                );
                let (forth, against) = (glow(&forth), glow(&against));
                store(i, i + span, forth);
                store(i + span, i, against);
            }
        }
    }
}

/// f, Eq. 9 of Roettger & Ertl 2002: (α, s, t) to s_f and l; s_b is t.
#[inline(always)]
fn from_cylinder<L: Lanes>(angle: L::F, s: f32, t: f32) -> [L::F; 2] {
    let splat = L::F::splat;
    let (one, four) = (splat(1.0), splat(4.0));
    // At creases both branches give the same.
    let rise = four.mul_add(-angle, splat(2.0)).max(-one).min(one);
    let length = (four * angle).min(four * (one - angle)).min(one);
    [rise.mul_add(splat(s), splat(t)), length * splat(s)]
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

/// Fills tiles over (α, s, t) from the table over (s_f, s_b, D): those of group `group` of a volume of as many `planes`. Where s_f
/// lies outside [0, 1] the nearest inside is taken, so that the linear filter does not read nothing.
#[inline(always)]
fn fill_tiles<L: Lanes>(table: &LaneVolume, group: usize, planes: usize, out: &mut [[f32; 4]]) {
    let n = table.side;
    let splat = L::F::splat;
    let (zero, one, last) = (splat(0.0), splat(1.0), (n - 1) as f32);
    for lane in (0..GROUP).step_by(L::WIDTH) {
        let plane = L::U::iota() + L::U::splat((group * GROUP + lane) as u32);
        let angle = (plane.to_float() * splat(1.0 / (planes - 1) as f32)).min(one);
        for k in 0..n * n {
            let (s, t) = ((k / n) as f32 / last, (k % n) as f32 / last);
            let [front, length] = from_cylinder::<L>(angle, s, t);
            let slice = length.max(zero).min(one).sqrt() * splat((table.planes - 1) as f32);
            let texel = table.read::<L>(front.max(zero).min(one) * splat(last), splat((k % n) as f32), slice);
            L::F::scatter_parts([texel], out[k * GROUP + lane..][..L::WIDTH].as_chunks_mut().0, L::U::iota());
        }
    }
}
