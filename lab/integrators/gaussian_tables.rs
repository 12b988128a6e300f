//! Integrals of Gaussians in tables, for [`Tabulated`](super::Tabulated).
//!
//! IGauss(x₁, x₂) (Kniss et al. 2003, Eq. 16), the mean of e^(−x²) between two places: 16-bit numbers over [−10, 10]² whose ends
//! hold on beyond.
//!
//! Light (Song et al. 2009, section 4.2): the paper's ∫ e^(−P erf x) dx and its prefactor leave the range of numbers at
//! P > 709, so kept is J(P, x) = ∫ from x to the table's end of e^(−P (erf u − erf x)) du, which is the same product.
//! Its P ends at 40, where the entry holds on.

use crate::square::{Bilinear, LaneSquare};
use voltet_optics::special::gaussian_mean;
use voltet_simd::optics::elementary::{HALF_SQRT_PI, exp, mean_transparency};
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::{Float, Lanes, Mask, array};

/// Half the side of IGauss's domain, by Kniss et al.
pub const REACH: f64 = 10.0;

pub const MAX_P: f64 = 40.0;

/// Half the range of that table's places: erf is 1 beyond.
pub const LIT_REACH: f64 = 3.6;

/// Both tables; square, of one side.
#[derive(Debug, Clone)]
pub struct GaussianTables {
    size: usize,
    means: Vec<u16>,
    light: Vec<f32>,
}

impl GaussianTables {
    /// Fills them, `size` ≥ 2 entries a side; `light`: also that of light.
    pub fn new(size: usize, light: bool) -> Self {
        GaussianTables { size, means: means(size), light: if light { lights(size) } else { Vec::new() } }
    }

    pub fn size(&self) -> usize {
        self.size
    }

    /// IGauss × 65535, by (x₁, x₂), each from −[`REACH`] to [`REACH`].
    pub fn means(&self) -> &[u16] {
        &self.means
    }

    /// J by (P, x), P from 0 to [`MAX_P`] and x from −[`LIT_REACH`] to [`LIT_REACH`]; empty where it was not asked for.
    pub fn light(&self) -> &[f32] {
        &self.light
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.means.as_slice()) + size_of_val(self.light.as_slice())
    }

    /// IGauss: the mean of e^(−x²) between two places.
    pub fn mean(&self, front: f64, back: f64) -> f64 {
        let place = |x: f64| (x + REACH) / (2.0 * REACH) * (self.size - 1) as f64;
        let at = Bilinear::new(place(front), place(back), self.size);
        at.read(|k| f64::from(self.means[k])) / f64::from(u16::MAX)
    }

    pub fn lit(&self, p: f64, x: f64) -> f64 {
        let last = (self.size - 1) as f64;
        let at = Bilinear::new(p / MAX_P * last, (x + LIT_REACH) / (2.0 * LIT_REACH) * last, self.size);
        at.read(|k| f64::from(self.light[k]))
    }
}

/// IGauss in 16 bits.
fn means(size: usize) -> Vec<u16> {
    let place = |k: usize| REACH * (2.0 * k as f64 / (size - 1) as f64 - 1.0);
    let entry = |k: usize| {
        let (a, b) = (place(k / size), place(k % size));
        let (mean, exponent) = gaussian_mean(a.min(b), a.max(b), (b - a).abs());
        (mean * (-exponent).exp() * f64::from(u16::MAX)).round() as u16
    };
    (0..size * size).map(entry).collect()
}

/// J, from its end backward: each step adds ∫ e^(−P (erf u − erf x)) du over it to what is behind, dimmed.
fn lights(size: usize) -> Vec<f32> {
    /// Parts of a step that Simpson's rule is taken over.
    const PARTS: usize = 4;
    let step = 2.0 * LIT_REACH / (size - 1) as f64;
    let place = |k: usize| k as f64 * step - LIT_REACH;
    let mut entries = vec![0.0; size * size];
    for (row, entries) in entries.chunks_exact_mut(size).enumerate() {
        let p = MAX_P * row as f64 / (size - 1) as f64;
        let mut behind = 0.0;
        for k in (0..size - 1).rev() {
            let x = place(k);
            let seen = |u: f64| (-p * (libm::erf(u) - libm::erf(x))).exp();
            let h = step / PARTS as f64;
            let simpson = |i: usize| {
                let u = x + i as f64 * h;
                h / 6.0 * (seen(u) + 4.0 * seen(u + 0.5 * h) + seen(u + h))
            };
            behind = seen(x + step) * behind + (0..PARTS).map(simpson).sum::<f64>();
            entries[k] = behind as f32;
        }
    }
    entries
}

#[derive(Debug, Clone)]
pub struct LaneGaussianTables {
    means: LaneSquare,
    /// J, where there is a constant-emitter.
    light: Option<LaneSquare>,
}

impl LaneGaussianTables {
    pub fn new(tables: &GaussianTables) -> LaneGaussianTables {
        let size = tables.size();
        let means: Vec<f32> = tables.means().iter().map(|x| f32::from(*x) / f32::from(u16::MAX)).collect();
        LaneGaussianTables {
            means: LaneSquare::new(&means, size),
            light: (!tables.light().is_empty()).then(|| LaneSquare::new(tables.light(), size)),
        }
    }

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
