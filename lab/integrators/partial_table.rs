//! The partial pre-integration table: the weights of the colours at both ends of a piece whose extinction and
//! colour are linear, tabulated (Moreland & Angel 2004; Song et al. 2009, sections 3.3.2 and 5).
//!
//! Symbols as in module `linear`: a = α_f D, b = α_b D; T = (a + b)/2 the depth of the piece; ψ, F, B, ζ. All
//! depend on a and b alone, so two dimensions hold them. Kept are
//!
//! - density-emitter: φ = (1 − ψ)/(1 − ζ), the front colour's share of the light; the back's is 1 − φ, since
//!   (1 − ψ) + (ψ − ζ) = 1 − ζ. Opacity stays exact, and a thin piece keeps its relative accuracy, which a table
//!   of ψ does not give it.
//! - constant-emitter: F (1 + √T) and B (1 + √T), which stay between bounds for all T.
//!
//! The axes are √r with r = a/(a + b), and u = √T/(1 + √T): r because at the origin φ depends on the ratio of a and
//! b, its root because for large T a layer of width 1/√T lies at r = 0, that of T because ψ falls like 1/√T. Bilinear; the error falls with the square of the side (bench `tables`).

use crate::square::{Bilinear, LaneSquare, Place};
use rayon::prelude::*;
use voltet_optics::linear::{emission_weights, front_back};
use voltet_optics::special::opacity;
use voltet_simd::{Float, Lanes, inlined};

#[derive(Debug, Clone)]
pub struct PartialTable {
    size: usize,
    /// φ, or F (1 + √T); rows of equal u.
    front: Vec<f32>,
    /// Empty, or B (1 + √T).
    back: Vec<f32>,
}

/// √T from u; 10⁶ stands for the infinite depth of the last row.
fn root_depth(u: f64) -> f64 {
    u / (1.0 - u).max(1e-6)
}

impl PartialTable {
    /// Fills the table, `size` ≥ 2 entries a side, on all cores.
    pub fn new(density_emitter: bool, size: usize) -> Self {
        let step = 1.0 / (size - 1) as f64;
        let fill = |value: &(dyn Fn(f64, f64, f64) -> f64 + Sync)| -> Vec<f32> {
            let mut entries = vec![0.0; size * size];
            entries.par_chunks_mut(size).enumerate().for_each(|(row, entries)| {
                let root = root_depth(row as f64 * step);
                let whole = 2.0 * root * root;
                for (column, entry) in entries.iter_mut().enumerate() {
                    let r = (column as f64 * step).powi(2);
                    *entry = value(r * whole, (1.0 - r) * whole, root) as f32;
                }
            });
            entries
        };
        let mut table = if density_emitter {
            PartialTable { size, front: fill(&front_share), back: Vec::new() }
        } else {
            PartialTable {
                size,
                front: fill(&|a, b, root| front_back(a, b).0 * (1.0 + root)),
                back: fill(&|a, b, root| front_back(a, b).1 * (1.0 + root)),
            }
        };
        if density_emitter {
            // Thin limit: ∫ (1 − x) ρ over ∫ ρ.
            for (column, entry) in table.front[..size].iter_mut().enumerate() {
                *entry = ((1.0 + (column as f64 * step).powi(2)) / 3.0) as f32;
            }
        }
        table
    }

    pub fn size(&self) -> usize {
        self.size
    }

    /// φ, or F (1 + √T), by (u, √r).
    pub fn front(&self) -> &[f32] {
        &self.front
    }

    /// Empty, or B (1 + √T).
    pub fn back(&self) -> &[f32] {
        &self.back
    }

    pub fn bytes_of(density_emitter: bool, size: usize) -> usize {
        let tables = if density_emitter { 1 } else { 2 };
        tables * size * size * size_of::<f32>()
    }

    pub fn bytes(&self) -> usize {
        (self.front.len() + self.back.len()) * size_of::<f32>()
    }

    /// Weights of the front and the back colour: (1 − ψ, ψ − ζ) or (F, B).
    #[inline]
    pub fn weights(&self, a: f64, b: f64) -> (f64, f64) {
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(f64::MAX);
        let ratio = if whole > 0.0 { a / whole } else { 0.5 };
        let root = (0.5 * whole).sqrt();
        let last = (self.size - 1) as f64;
        let at = Bilinear::new(root / (1.0 + root) * last, ratio.sqrt() * last, self.size);
        let read = |entries: &[f32]| at.read(|k| f64::from(entries[k]));
        if self.back.is_empty() {
            let share = read(&self.front);
            let light = opacity(0.5 * whole);
            (light * share, light * (1.0 - share))
        } else {
            let scale = 1.0 / (1.0 + root);
            (read(&self.front) * scale, read(&self.back) * scale)
        }
    }
}

fn front_share(a: f64, b: f64, _: f64) -> f64 {
    let (front, back) = emission_weights(a, b);
    front / (front + back)
}

#[derive(Debug, Clone)]
pub struct LanePartialTable {
    /// The front colour's share of the light, or F (1 + √T).
    front: LaneSquare,
    /// B (1 + √T), where it is kept.
    back: Option<LaneSquare>,
}

impl LanePartialTable {
    pub fn new(table: &PartialTable) -> LanePartialTable {
        let square = |entries: &[f32]| LaneSquare::new(entries, table.size());
        LanePartialTable {
            front: square(table.front()),
            back: (!table.back().is_empty()).then(|| square(table.back())),
        }
    }

    /// φ, the front colour's share of a piece's light (density-emitter).
    #[inline(always)]
    pub fn front_share<L: Lanes>(&self, a: L::F, b: L::F) -> L::F {
        self.front.read(&self.place::<L>(a, b).0)
    }

    #[inline(always)]
    pub fn front_back<L: Lanes>(&self, a: L::F, b: L::F) -> (L::F, L::F) {
        let (place, root) = self.place::<L>(a, b);
        let scale = L::F::splat(1.0) / (L::F::splat(1.0) + root);
        let back = match &self.back {
            Some(back) => back.read(&place),
            None => L::F::splat(0.0),
        };
        (self.front.read(&place) * scale, back * scale)
    }

    #[inline(always)]
    fn place<L: Lanes>(&self, a: L::F, b: L::F) -> (Place<L>, L::F) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(splat(f32::MAX));
        let least = splat(f32::MIN_POSITIVE);
        let ratio = L::F::select(whole.lt(least), splat(0.5), a / whole.max(least)).min(one);
        let root = (splat(0.5) * whole).sqrt();
        let last = splat(self.front.last());
        let within = inlined(
            #[inline(always)]
            |x: L::F| (x * last).max(zero).min(last),
        );
        (self.front.place(within(root / (one + root)), within(ratio.sqrt())), root)
    }
}
