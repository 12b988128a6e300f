//! Widgets that overlap on a segment, asked one after the other: their mix, what their order adds to it where every density
//! hardly bends ([`super::smooth`]), and how many steps of quadrature they want where that does not do.

use super::elementary::mean_transparency;
use super::smooth::{DensityShape, Smooth};
use crate::{Float, Lanes, Mask, array};

/// Depth under which the order of a widget does not matter beside as much as quadrature serves; it may be as rough as it likes.
const THIN: f32 = 1e-9;

/// Stands for the square of a change of more than 1: A⁴ is then so much that the widget is served only where T_i T is under
/// 1e-8, which is all that its order can add.
const STEEP: f32 = 45.0;

/// What the widgets of a vector of segments come to; symbols as in [`super::smooth`].
pub struct Sums<L: Lanes> {
    /// T = Σ T_i.
    pub total: L::F,
    /// Σ_{i<j} T_i T_j, without cancellation: a stiff widget must not hide a thin one.
    pub product: L::F,
    /// Σ c_i T_i.
    color: [L::F; 3],
    /// Σ c_i a_i T_i, then Σ a_i T_i.
    tilted: [L::F; 4],
    /// Σ c_i b_i T_i, then Σ b_i T_i.
    bent: [L::F; 4],
    /// Σ A_i² T_i and Σ A_i⁴ T_i.
    changes: [L::F; 2],
    /// Σ_{i<j} T_i T_j (A_i² + A_j²), and of the fourth powers.
    pairs: [L::F; 2],
    /// The greatest [roughness](DensityShape::roughness).
    roughness: L::F,
}

impl<L: Lanes> Sums<L> {
    /// Most of T that [`Sums::correction`] serves.
    pub const TOTAL_MOST: f32 = 2.0;

    /// No widget.
    #[inline(always)]
    pub fn none() -> Self {
        let zero = L::F::splat(0.0);
        Sums {
            total: zero,
            product: zero,
            color: [zero; 3],
            tilted: [zero; 4],
            bent: [zero; 4],
            changes: [zero; 2],
            pairs: [zero; 2],
            roughness: zero,
        }
    }

    /// Takes a widget of this colour.
    #[inline(always)]
    pub fn add(&mut self, shape: &DensityShape<L>, color: [f32; 3]) {
        let (splat, zero) = (L::F::splat, L::F::splat(0.0));
        let depth = shape.depth;
        let smooth = shape.change_squared.le(splat(1.0));
        let second = L::F::select(smooth, shape.change_squared, splat(STEEP));
        for (k, change) in [second, second * second].into_iter().enumerate() {
            let changed = change * depth;
            self.pairs[k] = depth.mul_add(self.changes[k], changed.mul_add(self.total, self.pairs[k]));
            self.changes[k] = self.changes[k] + changed;
        }
        self.product = depth.mul_add(self.total, self.product);
        self.total = self.total + depth;
        let rough = self.roughness.max(shape.roughness());
        self.roughness = L::F::select(splat(THIN).lt(depth), rough, self.roughness);
        let tilted = L::F::select(smooth, shape.tilt * depth, zero);
        let bent = L::F::select(smooth, shape.bend * depth, zero);
        self.tilted[3] = self.tilted[3] + tilted;
        self.bent[3] = self.bent[3] + bent;
        for (i, c) in color.into_iter().enumerate() {
            self.color[i] = depth.mul_add(splat(c), self.color[i]);
            self.tilted[i] = tilted.mul_add(splat(c), self.tilted[i]);
            self.bent[i] = bent.mul_add(splat(c), self.bent[i]);
        }
    }

    /// Colour and opacity of the mix.
    #[inline(always)]
    pub fn mixed(&self) -> [L::F; 4] {
        let mean = mean_transparency::<L>(self.total);
        let [r, g, b] = self.color;
        [r * mean, g * mean, b * mean, self.total * mean]
    }

    /// Lanes on which what [`Sums::correction`] leaves out of each C_i/c_i is under 2e-7. Of two widgets that is
    /// 0.007 A³ (A + T²/16) T_i T_j, and A³ T²/16 ≤ ½ A⁴ + ½ A² (T²/16)²; each pair is counted by itself.
    #[inline(always)]
    pub fn is_smooth(&self) -> L::M {
        let splat = L::F::splat;
        let thickness = self.total * self.total * splat(1.0 / 16.0);
        let left_out =
            (thickness * thickness * splat(0.5)).mul_add(self.pairs[0], self.pairs[1] * splat(1.5));
        left_out.lt(splat(3e-5)).and(self.total.le(splat(Self::TOTAL_MOST)))
    }

    /// What the order adds to the mix; 1e-8 is left out of widgets that bend much and hardly absorb.
    #[inline(always)]
    pub fn correction(&self) -> [L::F; 3] {
        let smooth = Smooth::<L>::new(self.total, self.tilted[3], self.bent[3]);
        array(
            #[inline(always)]
            |c| smooth.correction(self.color[c], self.tilted[c], self.bent[c]),
        )
    }

    /// How many steps the quadrature wants: a depth of 1 and a [roughness](DensityShape::roughness) of 1 each.
    #[inline(always)]
    pub fn steps(&self) -> L::F {
        self.total.max(self.roughness.sqrt())
    }
}
