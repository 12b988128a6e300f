//! Pre-integrated tables in lanes: filled and read. Twin of `{slice, pre_integrated,
//! pre_integrated_cylindrical}`.
//!
//! Entries are C/(D E₁) and a fourth number, by row, column and plane. Planes stand in groups of [`GROUP`], so that a vector
//! fills as many at a time as it has lanes, a group is a stretch of memory of its own, and the two planes that a place lies
//! between stand side by side, but for one pair in [`GROUP`].

use crate::{Material, Ramp};
use voltet_simd::optics::elementary::mean_transparency;
use voltet_simd::{Float, Lanes, Unsigned, array, inlined};

/// Planes of a group: as many as the widest vector has lanes.
pub const GROUP: usize = 16;

/// Depths beyond which a step is opaque whatever they are; their products stay numbers.
const MAX_DEPTH: f32 = 1e30;

/// A table of three dimensions.
#[derive(Debug, Clone)]
pub struct LaneVolume {
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

    /// Bytes that it takes.
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

fn narrow(x: f64) -> f32 {
    x.min(f64::from(f32::MAX)) as f32
}

impl Narrow {
    fn new(matter: &Material) -> Narrow {
        Narrow { extinction: narrow(matter.extinction), glow: matter.glow.map(narrow) }
    }
}

/// A transfer function of the scalar alone, in 32 bits.
pub struct LaneRamp {
    nodes: Vec<Narrow>,
    /// The pieces of all steps, from the lowest node on.
    pieces: Vec<Narrow>,
    parts: usize,
    /// ρ̄ of each path, row by row.
    means: Vec<f32>,
}

impl LaneRamp {
    /// Converts a ramp.
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
pub fn from_cylinder<L: Lanes>(angle: L::F, s: f32, t: f32) -> [L::F; 2] {
    let splat = L::F::splat;
    let (one, four) = (splat(1.0), splat(4.0));
    // At creases both branches give the same.
    let rise = four.mul_add(-angle, splat(2.0)).max(-one).min(one);
    let length = (four * angle).min(four * (one - angle)).min(one);
    [rise.mul_add(splat(s), splat(t)), length * splat(s)]
}

/// f⁻¹, Eq. 10: α and s of (s_f, s_b, l); t is s_b. At s_f = s_b, l = 0 every α serves.
#[inline(always)]
pub fn to_cylinder<L: Lanes>(front: L::F, back: L::F, length: L::F) -> [L::F; 2] {
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
pub fn fill_tiles<L: Lanes>(table: &LaneVolume, group: usize, planes: usize, out: &mut [[f32; 4]]) {
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
