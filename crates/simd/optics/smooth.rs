//! Widgets that overlap on a segment and hardly bend along it: their ordered light in closed form, density-emitter.
//! Stands in for quadrature of `optics::overlap` where [`super::smooth::Sums::is_smooth`].
//!
//! With u = 2t − 1 each density is T_i (1 + a_i u + b_i P₂(u)) to third order in A, the largest change of its logarithm;
//! T = Σ T_i, S = Σ a_i T_i, B = Σ b_i T_i. In C_i = ∫ ρ_i e^(−∫ρ) the terms in a and b are expanded,
//! e^(−T t) is kept whole. Moments of e^(−T t) about the middle are e^(−T/2) times series in T²:
//! ∫ (1 − u²)/4 → k = 1/6 + T²/240 + T⁴/26880 + T⁶/5806080, ∫ u (1 − u²)/4 → −m, m = T (1/60 + T²/3360),
//! ∫ (1 − u²)²/16 → n = 1/30 + T²/1680, ∫ P₂ (u² − 1)/4 → 1/30. So
//! C_i = T_i ((1 − e^(−T))/T + e^(−T/2) ((S − a_i T) k + (b_i T − B − a_i S) m + ½ S² n + (a_i B − b_i S)/30)),
//! which vanishes for equal shapes, as it must. What is left out is under 0.007 A³ (A + T²/16) Σ_{i<j} T_i T_j for T ≤ 2
//! and A ≤ 1 (measured: the tests here and of [`super::wave`]).

use super::elementary::{exp, mean_transparency, polynomial};
use crate::{Float, Lanes, Mask};

/// A widget's density along a segment, in the symbols of the module's head.
#[derive(Clone, Copy)]
pub struct DensityShape<L: Lanes> {
    /// T_i.
    pub depth: L::F,
    /// a_i.
    pub tilt: L::F,
    /// b_i.
    pub bend: L::F,
    /// A_i²; ∞ where the density jumps.
    pub change_squared: L::F,
    /// The square of its extent in widths; ∞ where the density jumps.
    pub extent_squared: L::F,
}

impl<L: Lanes> DensityShape<L> {
    /// Constant density.
    #[inline(always)]
    pub fn even(depth: L::F) -> Self {
        let zero = L::F::splat(0.0);
        DensityShape { depth, tilt: zero, bend: zero, change_squared: zero, extent_squared: zero }
    }

    /// See [`roughness`].
    #[inline(always)]
    pub fn roughness(&self) -> L::F {
        roughness::<L>(self.change_squared, self.extent_squared)
    }

    /// Density cut to zero on lanes where `cut` covers a part of the segment only.
    #[inline(always)]
    pub fn cut(self, cut: L::M) -> Self {
        let endless = L::F::splat(f32::INFINITY);
        DensityShape {
            change_squared: L::F::select(cut, endless, self.change_squared),
            extent_squared: L::F::select(cut, endless, self.extent_squared),
            ..self
        }
    }
}

/// The square of the steps that quadrature with 4 points a step wants: a cubic through four densities leaves 3e-5 of the depth
/// where a Gaussian extends over half a width; where the logarithm of a density changes by more than 0.7 to either side of a
/// step's middle more is left of a tail.
#[inline(always)]
pub fn roughness<L: Lanes>(change_squared: L::F, extent_squared: L::F) -> L::F {
    (change_squared * L::F::splat(1.96)).max(extent_squared * L::F::splat(4.0))
}

/// Depth under which the order of a widget does not matter beside as much as quadrature serves; it may be as rough as it likes.
const THIN: f32 = 1e-9;

/// Stands for the square of a change of more than 1: A⁴ is then so much that the widget is served only where T_i T is under
/// 1e-8, which is all that its order can add.
const LARGE_CHANGE_SQUARED: f32 = 45.0;

/// Sums over the widgets of a vector of segments, asked one after the other; symbols as in the module's head. What a widget is alone is put
/// down as it is asked, and the colours are summed once all are known, each by the one weight that it then has: sums of every channel,
/// of every power, would not fit into registers.
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
        // In the symbols of the module's head; nothing on other lanes than those served.
        let splat = L::F::splat;
        let (total, tilted, bent) = (self.total, self.tilted, self.bent);
        let squared = total * total;
        let through = exp::<L>(total * splat(-0.5));
        let k = polynomial::<L, 4>(squared, [1.0 / 6.0, 1.0 / 240.0, 1.0 / 26_880.0, 1.0 / 5_806_080.0])
            * through;
        // ½ n = m/T.
        let n = polynomial::<L, 2>(squared, [1.0 / 60.0, 1.0 / 3_360.0]) * through;
        let m = n * total;
        let third = through * splat(1.0 / 30.0);
        let only = inlined!(|value: L::F| L::F::select(served, value, zero));
        let constant = only(tilted.mul_add(tilted.mul_add(n, k), -(bent * m)));
        let of_tilt = only(bent.mul_add(third, -(total.mul_add(k, tilted * m))));
        let of_bend = only(total.mul_add(m, -(tilted * third)));
        let mut rgba = [zero; 4];
        for term in terms {
            let correction = term.tilted.mul_add(of_tilt, term.bent.mul_add(of_bend, term.depth * constant));
            add_color::<L>(&mut rgba, term.depth.mul_add(mean, correction), &term.color);
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

#[inline(always)]
fn add_color<L: Lanes>(sum: &mut [L::F; 4], weight: L::F, color: &[f32; 3]) {
    for c in 0..3 {
        sum[c] = weight.mul_add(L::F::splat(color[c]), sum[c]);
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::optics::gaussian::shape;
    use crate::optics::smooth::{Sums, Term};
    use crate::portable::Portable as P;
    use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
    use voltet_optics::{CompiledTransferFunction, Segment, WidgetBlend};

    type F = <P as Lanes>::F;

    /// Numbers in [0, 1) of a sequence of low discrepancy (Roberts 2018).
    pub(in crate::optics) fn uniform(i: usize, j: i32) -> f64 {
        (0.5 + 0.911_587_f64.powi(j) * (i + 1) as f64).fract()
    }

    pub(in crate::optics) fn lane(x: F) -> f64 {
        let mut lanes = [0f32; P::WIDTH];
        x.store(&mut lanes);
        f64::from(lanes[0])
    }

    #[test]
    fn what_is_left_out_stays_under_its_bound() {
        let splat = |x: f64| F::splat(x as f32);
        let all = F::splat(0.0).le(F::splat(1.0));
        let (mut served, mut smooth_count, mut worst, mut most_left_out) = (0, 0, 0.0, 0.0);
        for i in 0..20_000 {
            let end = |j: i32| [uniform(i, j), uniform(i, j + 1)].map(|u| f64::from((2.0 * u - 1.0) as f32));
            let (front, toward) = (end(1), end(3));
            let size = 10f64.powf(-3.0 * uniform(i, 5));
            let back = [0, 1].map(|a| f64::from((front[a] + size * toward[a]) as f32));
            let widget = |channel: usize| {
                let u = |j: i32| uniform(i, 6 + 4 * channel as i32 + j);
                let mut color = [0.0; 3];
                color[channel] = 1.0;
                let centre = [0.0, 1.0].map(|a: f64| if a == 0.0 { u(0) } else { u(1) } - 0.5);
                let profile = Profile::Gaussian { centre, matrix: [[1.0 + u(2), 0.5], [0.0, 1.0]] };
                Widget { profile, color, extinction: 10f64.powf(1.0 - 4.7 * u(3)), region: None }
            };
            let widgets: Vec<Widget> = (0..3).map(widget).collect();
            let shapes: Vec<DensityShape<P>> = widgets
                .iter()
                .map(|widget| {
                    let Profile::Gaussian { centre, matrix: k } = &widget.profile else { unreachable!() };
                    let q = |v: [f64; 2]| {
                        let d = [v[0] - centre[0], v[1] - centre[1]];
                        k.map(|row| splat(row[0] * d[0] + row[1] * d[1]))
                    };
                    shape::<P, 2>(q(front), q(back), splat(widget.extinction), all)
                })
                .collect();
            let depths: Vec<f64> = shapes.iter().map(|shape| lane(shape.depth)).collect();
            let total: f64 = depths.iter().sum();
            let product = depths[0] * depths[1] + depths[2] * (depths[0] + depths[1]);
            let change = shapes.iter().map(|shape| lane(shape.change_squared).sqrt()).fold(0.0, f64::max);
            if change > 1.0 || total > f64::from(Sums::<P>::MAX_TOTAL) {
                continue;
            }
            served += 1;
            let (mut sums, mut terms) = (Sums::<P>::none(), [Term::none(); 3]);
            for ((shape, widget), term) in shapes.iter().zip(&widgets).zip(&mut terms) {
                sums.add(shape, widget.color.map(|c| c as f32), term);
            }
            let is_smooth = lane(F::select(sums.is_smooth(&terms), splat(1.0), splat(0.0))) == 1.0;
            smooth_count += u32::from(is_smooth);
            let model = OpticalModel::DensityEmitter;
            let function = TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
            let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
            let truth = CompiledTransferFunction::new(&function)
                .expect("three Gaussians")
                .integrate(&segment, WidgetBlend::Exact);
            for (found, exact) in sums.ordered(&terms, all).into_iter().zip(truth.color) {
                let found = lane(found);
                // Four roundings of the terms, and the twin of the depth: ε (8 + 4 |q|²), |q| up to 2.5.
                let bound = 0.007 * change.powi(3) * (change + total * total / 16.0) * product
                    + 36.0 * f64::from(f32::EPSILON) * exact;
                let ratio = (found - exact).abs() / bound;
                assert!(ratio <= 1.0, "case {i}: {found} for {exact}, {ratio:.2} of the bound, A = {change}");
                worst = f64::max(worst, ratio);
                if is_smooth {
                    let left_out = (found - exact).abs() - 36.0 * f64::from(f32::EPSILON) * exact;
                    assert!(left_out <= 2e-7, "case {i}: {left_out:e} of {exact} is left out");
                    most_left_out = f64::max(most_left_out, left_out);
                }
            }
        }
        println!(
            "{served} of moderate change, worst {worst:.2} of the bound; {smooth_count} served, {most_left_out:.1e} left out"
        );
        assert!(served > 5_000 && smooth_count > 1_000, "{served}, {smooth_count} served");
    }
}
