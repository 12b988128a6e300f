//! Widgets that overlap on a segment, asked one after the other: their mix, what their order adds to it where every density
//! hardly bends ([`super::smooth`]), and how many steps of quadrature they want where that does not do.
//!
//! What a widget is alone is put down as it is asked, and the colours are summed once all are known, each by the one weight that
//! it then has: sums of every channel, of every power, would not fit into registers.

use super::elementary::mean_transparency;
use super::smooth::{DensityShape, Smooth, roughness};
use crate::{Float, Lanes, Mask};

/// Depth under which the order of a widget does not matter beside as much as quadrature serves; it may be as rough as it likes.
const THIN: f32 = 1e-9;

/// Stands for the square of a change of more than 1: A⁴ is then so much that the widget is served only where T_i T is under
/// 1e-8, which is all that its order can add.
const LARGE_CHANGE_SQUARED: f32 = 45.0;

/// Sums over the widgets of a vector of segments; symbols as in [`super::smooth`].
pub struct Sums<L: Lanes> {
    /// T = Σ T_i.
    pub total: L::F,
    /// Σ_{i<j} T_i T_j, without cancellation: a stiff widget must not hide a thin one.
    pub product: L::F,
    /// S = Σ a_i T_i.
    tilted: L::F,
    /// B = Σ b_i T_i.
    bent: L::F,
}

/// A widget of a vector of segments.
#[derive(Clone, Copy)]
pub struct Term<L: Lanes> {
    /// T_i.
    depth: L::F,
    /// a_i T_i; 0 where the density changes by more than 1.
    tilted: L::F,
    /// b_i T_i; 0 there, too.
    bent: L::F,
    change_squared: L::F,
    extent_squared: L::F,
    color: [f32; 3],
}

impl<L: Lanes> Term<L> {
    /// No widget.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = L::F::splat(0.0);
        let [depth, tilted, bent, change_squared, extent_squared] = [zero; 5];
        Term { depth, tilted, bent, change_squared, extent_squared, color: [0.0; 3] }
    }
}

impl<L: Lanes> Sums<L> {
    /// Most of T that [`Sums::ordered`] serves.
    pub const MAX_TOTAL: f32 = 2.0;

    /// No widget.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = L::F::splat(0.0);
        Sums { total: zero, product: zero, tilted: zero, bent: zero }
    }

    /// Takes a widget of this colour, and puts down what it is.
    #[inline(always)]
    pub fn add(&mut self, shape: &DensityShape<L>, color: [f32; 3], term: &mut Term<L>) {
        let &DensityShape { depth, tilt, bend, change_squared, extent_squared } = shape;
        let (zero, smooth) = (L::F::splat(0.0), change_squared.le(L::F::splat(1.0)));
        let tilted = L::F::select(smooth, tilt * depth, zero);
        let bent = L::F::select(smooth, bend * depth, zero);
        self.product = depth.mul_add(self.total, self.product);
        self.total = self.total + depth;
        self.tilted = self.tilted + tilted;
        self.bent = self.bent + bent;
        *term = Term { depth, tilted, bent, change_squared, extent_squared, color };
    }

    /// Colour and opacity of the mix of all `terms`.
    #[inline(always)]
    pub fn mixed(&self, terms: &[Term<L>]) -> [L::F; 4] {
        let mean = mean_transparency::<L>(self.total);
        let mut rgba = [L::F::splat(0.0); 4];
        for term in terms {
            add_color::<L>(&mut rgba, term.depth * mean, &term.color);
        }
        rgba[3] = self.total * mean;
        rgba
    }

    /// Result with the contribution of the order on the lanes `served`; 1e-8 is neglected of widgets that bend much and hardly absorb.
    #[inline(always)]
    pub fn ordered(&self, terms: &[Term<L>], served: L::M) -> [L::F; 4] {
        let zero = L::F::splat(0.0);
        let mean = mean_transparency::<L>(self.total);
        let smooth = Smooth::<L>::new(self.total, self.tilted, self.bent).only(served);
        let mut rgba = [zero; 4];
        for term in terms {
            let weight = smooth.weight(mean, term.depth, term.tilted, term.bent);
            add_color::<L>(&mut rgba, weight, &term.color);
        }
        // A weight may be a rounding under 0.
        let [r, g, b, _] = rgba;
        [r.max(zero), g.max(zero), b.max(zero), self.total * mean]
    }

    /// Lanes on which what [`Sums::ordered`] leaves out of each C_i/c_i is under 2e-7. Of two widgets that is
    /// 0.007 A³ (A + T²/16) T_i T_j, and A³ T²/16 ≤ ½ A⁴ + ½ A² (T²/16)²; each pair is counted by itself.
    #[inline(always)]
    pub fn is_smooth(&self, terms: &[Term<L>]) -> L::M {
        let splat = L::F::splat;
        let thickness = self.total * self.total * splat(1.0 / 16.0);
        let of_square = thickness * thickness * splat(0.5);
        let mut left_out = splat(0.0);
        for term in terms {
            let change = term.change_squared;
            let change = L::F::select(change.le(splat(1.0)), change, splat(LARGE_CHANGE_SQUARED));
            // With all others: Σ_{i<j} T_i T_j (A_i + A_j) = Σ_i A_i T_i (T − T_i).
            let changed = change * change.mul_add(splat(1.5), of_square) * term.depth;
            left_out = changed.mul_add(self.total - term.depth, left_out);
        }
        left_out.lt(splat(3e-5)).and(self.total.le(splat(Self::MAX_TOTAL)))
    }

    /// Number of steps for the quadrature: a depth of 1 and a [roughness](DensityShape::roughness) of 1 each.
    #[inline(always)]
    pub fn steps(&self, terms: &[Term<L>]) -> L::F {
        let mut most = L::F::splat(0.0);
        for term in terms {
            let rough = roughness::<L>(term.change_squared, term.extent_squared);
            most = L::F::select(L::F::splat(THIN).lt(term.depth), most.max(rough), most);
        }
        self.total.max(most.sqrt())
    }
}

/// Adds a colour by its weight.
#[inline(always)]
fn add_color<L: Lanes>(sum: &mut [L::F; 4], weight: L::F, color: &[f32; 3]) {
    for c in 0..3 {
        sum[c] = weight.mul_add(L::F::splat(color[c]), sum[c]);
    }
}
