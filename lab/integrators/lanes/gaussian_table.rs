//! Integrals of Gaussians from tables in lanes. Twin of `Tabulated`, whose tables these are (Kniss et al. 2003,
//! Eq. 11 and 16; Song et al. 2009, section 4.2).

use super::square::LaneSquare;
use crate::{GaussianTables, LIT_REACH, MAX_P, REACH};
use voltet_simd::optics::elementary::{HALF_SQRT_PI, exp, mean_transparency};
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::{Float, Lanes, Mask, array};

/// The tables.
#[derive(Debug, Clone)]
pub struct LaneGaussianTables {
    /// IGauss.
    means: LaneSquare,
    /// J, where there is a constant-emitter.
    light: Option<LaneSquare>,
}

impl LaneGaussianTables {
    /// Converts tables in 64 bits.
    pub fn new(tables: &GaussianTables) -> LaneGaussianTables {
        let size = tables.size();
        let means: Vec<f32> = tables.means().iter().map(|x| f32::from(*x) / f32::from(u16::MAX)).collect();
        LaneGaussianTables {
            means: LaneSquare::new(&means, size),
            light: (!tables.light().is_empty()).then(|| LaneSquare::new(tables.light(), size)),
        }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.means.bytes() + self.light.as_ref().map_or(0, LaneSquare::bytes)
    }

    /// IGauss: the mean of e^(−x²) between two places.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, front: L::F, back: L::F) -> L::F {
        let row = place::<L>(&self.means, front, REACH);
        let column = place::<L>(&self.means, back, REACH);
        self.means.read(&self.means.place::<L>(row, column))
    }

    /// J(P, x) of two x.
    #[inline(always)]
    fn lit<L: Lanes>(light: &LaneSquare, p: L::F, x: [L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        let row = p * splat(light.last() / MAX_P as f32);
        let row = row.max(splat(0.0)).min(splat(light.last()));
        array(
            #[inline(always)]
            |end| light.read(&light.place::<L>(row, place::<L>(light, x[end], LIT_REACH))),
        )
    }

    /// ∫ e^(−T) dt over the part of a path of such a `length` (t) where the profile exceeds e^(−`level`), T from the path's start;
    /// `depth`: that of all of it, `rate`: at the centre, over it.
    #[inline(always)]
    pub fn glow<L: Lanes>(
        &self,
        path: &LaneGaussianPath<L>,
        level: f32,
        [length, depth, rate]: [L::F; 3],
    ) -> L::F {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let Some(light) = &self.light else { return zero };
        let room = splat(level) - path.offset_squared;
        let half = room.max(zero).sqrt();
        let (front, back) = (path.front, path.back);
        let span = back - front;
        let (start, end) = (front.max(-half), back.min(half));
        let flat = span.le(zero);
        let inverse = splat(1.0) / L::F::select(flat, splat(1.0), span);
        let scale = rate * exp::<L>(-path.offset_squared) * inverse;
        let before = scale * (start - front) * self.mean::<L>(front, start);
        let within = scale * (end - start) * self.mean::<L>(start, end);
        let [from, to] = Self::lit::<L>(light, scale * splat(HALF_SQRT_PI), [start, end]);
        let (lit, through) = (end - start, exp::<L>(-within));
        let found = (from - through * to).max(lit * through).min(lit);
        let along = length * exp::<L>(-before) * found * inverse;
        let along = L::F::select(start.lt(end), along, zero);
        if !flat.any() {
            return L::F::select(zero.lt(room), along, zero);
        }
        let shines = front.abs().lt(half);
        let whole = L::F::select(shines, length * mean_transparency::<L>(depth), zero);
        L::F::select(zero.lt(room), L::F::select(flat, whole, along), zero)
    }
}

/// A place from −`reach` to `reach` in entries; the ends hold on beyond.
#[inline(always)]
fn place<L: Lanes>(table: &LaneSquare, x: L::F, reach: f64) -> L::F {
    let splat = L::F::splat;
    let half = splat(0.5 * table.last());
    x.mul_add(half * splat(1.0 / reach as f32), half).max(splat(0.0)).min(splat(table.last()))
}
