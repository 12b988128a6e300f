//! Integrals of Gaussians in tables, for [`Tabulated`](super::Tabulated).
//!
//! IGauss(x₁, x₂) (Kniss et al. 2003, Eq. 16), the mean of e^(−x²) between two places: 16-bit numbers over [−10, 10]² whose ends
//! hold on beyond.
//!
//! Light (Song et al. 2009, section 4.2): the paper's ∫ e^(−P erf x) dx and its prefactor leave the range of numbers at
//! P > 709, so kept is J(P, x) = ∫ from x to the table's end of e^(−P (erf u − erf x)) du, which is the same product.
//! Its P ends at 40, where the entry holds on.

use voltet_optics::special::gaussian_mean;

/// Half the side of IGauss's domain, by Kniss et al.
pub const REACH: f64 = 10.0;

/// The largest P of the table of light.
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

    /// Entries a side.
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

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.means.as_slice()) + size_of_val(self.light.as_slice())
    }

    /// IGauss: the mean of e^(−x²) between two places.
    pub fn mean(&self, front: f64, back: f64) -> f64 {
        let place = |x: f64| (x + REACH) / (2.0 * REACH);
        bilinear(self.size, place(front), place(back), |k| f64::from(self.means[k])) / f64::from(u16::MAX)
    }

    /// J(P, x).
    pub fn lit(&self, p: f64, x: f64) -> f64 {
        let place = (x + LIT_REACH) / (2.0 * LIT_REACH);
        bilinear(self.size, p / MAX_P, place, |k| f64::from(self.light[k]))
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

/// A square table read at places from 0 to 1, which hold on beyond.
fn bilinear(size: usize, row: f64, column: f64, entry: impl Fn(usize) -> f64) -> f64 {
    let last = (size - 1) as f64;
    let split = |place: f64| {
        let place = (place * last).clamp(0.0, last);
        let low = (place as usize).min(size - 2);
        (low, place - low as f64)
    };
    let ((i, u), (j, v)) = (split(row), split(column));
    let at = |di: usize, dj: usize| entry((i + di) * size + j + dj);
    let (low, high) = (at(0, 0) + v * (at(0, 1) - at(0, 0)), at(1, 0) + v * (at(1, 1) - at(1, 0)));
    low + u * (high - low)
}
