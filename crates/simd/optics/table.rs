//! Images over the (s, g) plane along a segment, bilinear between texel centres, which lie at the integers (Song et al. 2009,
//! section 3.3.2). Twin of `optics::kinds::table`. Between the lines through texel centres alpha is a quadratic in t.

use super::quadrature::{PANEL, POINTS};
use super::track::{LaneTrack, PASSED};
use crate::{Float, Lanes, Mask, Unsigned};
use voltet_core::transfer::Table;

/// The texels of an image.
#[derive(Debug, Clone)]
pub struct LaneTexels {
    texels: Vec<[f32; 4]>,
    /// Columns and rows, less 1.
    last: [f32; 2],
}

impl LaneTexels {
    /// Converts a table.
    pub fn new(table: &Table) -> LaneTexels {
        let last = [(table.width - 1) as f32, (table.height - 1) as f32];
        LaneTexels { texels: table.texels.clone(), last }
    }

    /// Red, green, blue and alpha at a column and row; beyond the image those of its edge.
    #[inline(always)]
    pub fn at<L: Lanes>(&self, place: &[L::F; 2]) -> [L::F; 4] {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let at: [L::F; 2] = array!(|a| place[a].max(zero).min(splat(self.last[a])));
        let low: [L::F; 2] = array!(|a| at[a].floor().min(splat((self.last[a] - 1.0).max(0.0))));
        let high: [L::F; 2] = array!(|a| (low[a] + one).min(splat(self.last[a])));
        let columns = L::U::splat(self.last[0] as u32 + 1);
        let mix = inlined!(|a: [L::F; 4], b: [L::F; 4], share: L::F| -> [L::F; 4] {
            array!(|c| share.mul_add(b[c] - a[c], a[c]))
        });
        let texel = inlined!(|j: L::F, i: L::F| L::F::gather_parts(
            &self.texels,
            j.to_unsigned() * columns + i.to_unsigned()
        ));
        let [x, y] = [at[0] - low[0], at[1] - low[1]];
        let above = mix(texel(low[1], low[0]), texel(low[1], high[0]), x);
        let below = mix(texel(high[1], low[0]), texel(high[1], high[0]), x);
        mix(above, below, y)
    }
}

/// An image along a segment, as a [`LaneTrack`].
#[derive(Clone, Copy)]
pub struct LaneTableTrack<'a, L: Lanes> {
    /// Its texels.
    pub texels: &'a LaneTexels,
    /// Column and row at the front.
    pub front: [L::F; 2],
    /// Value at the back.
    pub back: [L::F; 2],
    /// ρ₀ D.
    pub peak: L::F,
    /// Alpha above which it glows, where that is told apart.
    pub cutoff: Option<f32>,
}

impl<L: Lanes> LaneTableTrack<'_, L> {
    /// Red, green, blue and alpha at a share of the segment, from its nearer end.
    #[inline(always)]
    pub fn texel(&self, t: L::F) -> [L::F; 4] {
        let near_back = L::F::splat(0.5).lt(t);
        let step = L::F::select(near_back, t - L::F::splat(1.0), t);
        self.texels.at::<L>(&array!(|a| {
            let from = L::F::select(near_back, self.back[a], self.front[a]);
            (self.back[a] - self.front[a]).mul_add(step, from)
        }))
    }

    /// Mean of alpha over the segment: Simpson's rule between the lines through texel centres, which is exact there.
    #[inline(always)]
    pub fn mean(&self, wanted: L::M) -> L::F {
        let splat = L::F::splat;
        let (zero, one, half) = (splat(0.0), splat(1.0), splat(0.5));
        let (mut t, mut sum) = (L::F::select(wanted, zero, one), zero);
        let mut alpha = self.texel(t)[3];
        let most = (self.texels.last[0] + self.texels.last[1]) as usize + 4;
        for _ in 0..most {
            let open = t.lt(one);
            if !open.any() {
                break;
            }
            let next = L::F::select(open, self.next_line(t).max(t + splat(PASSED)).min(one), t);
            let length = next - t;
            let middle = self.texel(half.mul_add(length, t))[3];
            let end = self.texel(next)[3];
            sum = length.mul_add(splat(4.0).mul_add(middle, alpha + end), sum);
            (t, alpha) = (next, end);
        }
        sum * splat(1.0 / 6.0)
    }

    /// The next t on a line through texel centres; ≥ 1 if there is none.
    #[inline(always)]
    fn next_line(&self, t: L::F) -> L::F {
        let splat = L::F::splat;
        let mut next = splat(2.0);
        for a in 0..2 {
            let (front, back, last) = (self.front[a], self.back[a], splat(self.texels.last[a]));
            let span = back - front;
            let near_back = splat(0.5).lt(t);
            let from = L::F::select(near_back, back, front);
            let place = span.mul_add(L::F::select(near_back, t - splat(1.0), t), from);
            // What the rounding of t and of the place stands for.
            let margin = splat(4.0 * f32::EPSILON) * (splat(1.0) + place.abs() + span.abs());
            let rising = ((place + margin).floor() + splat(1.0)).max(splat(0.0));
            let falling = (-((margin - place).floor()) - splat(1.0)).min(last);
            let line = L::F::select(splat(0.0).lt(span), rising, falling);
            let moves = splat(1e-30).le(span.abs());
            let crossed = moves.and(splat(0.0).le(line)).and(line.le(last));
            let at = (line - front) / L::F::select(moves, span, splat(1.0));
            next = L::F::select(crossed, at.min(next), next);
        }
        next
    }

    /// Position between t and `end` where alpha crosses the cutoff; ≥ 1 where it does not.
    #[inline(always)]
    fn next_crossing(&self, t: L::F, end: L::F, cutoff: f32) -> L::F {
        let splat = L::F::splat;
        let (zero, one, two) = (splat(0.0), splat(1.0), splat(2.0));
        let length = end.min(one) - t;
        let over = inlined!(|u: f32| self.texel(splat(u).mul_add(length, t))[3] - splat(cutoff));
        // α(t + length u) − cutoff = a u² + b u + c through three values.
        let (start, middle, back) = (over(0.0), over(0.5), over(1.0));
        let a = two * ((start - two * middle) + back);
        let b = splat(4.0) * middle - splat(3.0) * start - back;
        let square = b * b - splat(4.0) * a * start;
        let root = square.max(zero).sqrt();
        let q = splat(-0.5) * (b + L::F::select(b.lt(zero), -root, root));
        let tiny = splat(1e-37);
        let unless_tiny = inlined!(|x: L::F| L::F::select(x.abs().lt(tiny), tiny, x));
        let past = splat(2.0 * PASSED) / length.max(splat(PASSED));
        let mut next = two;
        for at in [q / unless_tiny(a), start / unless_tiny(q)] {
            let counts = zero.le(square).and(past.lt(at)).and(at.lt(one)).and(at.lt(next));
            next = L::F::select(counts, at, next);
        }
        L::F::select(next.lt(one), length.mul_add(next, t), two)
    }
}

impl<L: Lanes> LaneTrack<L> for LaneTableTrack<'_, L> {
    #[inline(always)]
    fn rates(&self, t: L::F, dt: L::F) -> [L::F; POINTS] {
        array!(|i| self.peak * self.texel(dt.mul_add(L::F::splat(PANEL[i].0), t))[3])
    }

    #[inline(always)]
    fn next_break(&self, t: L::F) -> L::F {
        let line = self.next_line(t);
        let next = match self.cutoff {
            None => line,
            Some(cutoff) => line.min(self.next_crossing(t, line, cutoff)),
        };
        next.max(t + L::F::splat(PASSED))
    }
}
