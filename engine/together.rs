//! Widgets that overlap on a segment, in their order along it: corrections of the mix, cheapest first, for profiles that
//! are smooth there. What these leave over is walked in panels ([`super::walk`]).

use super::shade::{MIX_PRODUCT, Shaded};
use super::widget::{Along, LaneWidget, lanes_of};
use voltet_core::lanes::{Float, Lanes, Mask};
use voltet_core::optics::lanes::elementary::{exp, one_minus_exp, polynomial};

/// Bound of product · A² (T + A) under which [`Together::tilted`] serves: it leaves a sixtieth of that, 3e-8.
const TILTED_PRODUCT: f32 = 2e-6;

/// Widgets that are ordered here; more on one scene go the 64-bit way where they overlap.
pub(crate) const ORDERED_MOST: usize = 8;

/// One vector of segments with the optical depths of its widgets.
pub(crate) struct Together<'a, L: Lanes> {
    pub widgets: &'a [LaneWidget],
    pub along: &'a Along<L>,
    /// T of each widget.
    pub depths: [L::F; ORDERED_MOST],
    /// Σ T.
    pub total: L::F,
    /// Σ_{i<j} T_i T_j.
    pub product: L::F,
}

impl<L: Lanes> Together<'_, L> {
    /// The ordered integral where every density is nearly linear along the segment, ρ_i ∝ T_i (1 + a_i (2t − 1)): to
    /// first order in a, with S = Σ a_j T_j and K(T) = ∫₀¹ t (1 − t) e^(−T t) dt,
    /// C_i = T_i ((1 − e^(−T))/T − (a_i T − S) K(T)). Corrects the mix in `out`; returns the lanes it served.
    ///
    /// What is left out is of second order in a and in the bend of the profile, under product · A² (T + A)/60 with A
    /// the largest of both.
    #[inline(always)]
    pub fn tilted(&self, overlapping: u32, at: usize, out: &mut Shaded) -> u32 {
        let splat = L::F::splat;
        let &Together { widgets, along, ref depths, total, product } = self;
        let (mut largest, mut sum) = (splat(0.0), splat(0.0));
        for (widget, &depth) in widgets.iter().zip(depths) {
            // Half of the roughness is the extent in widths.
            let Some(roughness) = widget.roughness::<L>(along) else { return 0 };
            let tilt = widget.tilt::<L>(along);
            let matters = splat(MIX_PRODUCT).lt(depth * total);
            let bend = (roughness * splat(0.5)).max(tilt.abs());
            largest = L::F::select(matters, bend.max(largest), largest);
            sum = tilt.mul_add(depth, sum);
        }
        let left_out = product * (largest * largest) * (total + largest);
        let smooth = left_out.lt(splat(TILTED_PRODUCT)).and(largest.le(splat(0.5)));
        let served = overlapping & smooth.and(total.le(splat(1.0))).bits();
        if served == 0 {
            return 0;
        }
        // (−1)^k / (k! (k + 2) (k + 3)): six terms leave 2e-5 of K at T = 1.
        let kernel = polynomial::<L, 6>(
            -total,
            [1.0 / 6.0, 1.0 / 12.0, 1.0 / 40.0, 1.0 / 180.0, 1.0 / 1008.0, 1.0 / 6720.0],
        );
        let mut correction = [splat(0.0); 3];
        for (widget, &depth) in widgets.iter().zip(depths) {
            let change = (sum - widget.tilt::<L>(along) * total) * depth;
            for (sum, c) in correction.iter_mut().zip(widget.color()) {
                *sum = change.mul_add(splat(c), *sum);
            }
        }
        replace::<L>(
            served,
            at,
            out,
            #[inline(always)]
            |channel, mixed| correction[channel].mul_add(kernel, mixed).max(splat(0.0)),
        );
        served
    }

    /// The ordered integral ∫ Σ c_i ρ_i e^(−T) by Gauss-Legendre with 4 points on one or four equal steps, for
    /// segments on which every widget's profile is smooth and the depth moderate; the lanes it cannot serve are
    /// returned.
    #[inline(always)]
    pub fn ordered(&self, overlapping: u32, at: usize, out: &mut Shaded) -> u32 {
        let splat = L::F::splat;
        let &Together { widgets, along, ref depths, total, .. } = self;
        // How many steps the roughest lane wants.
        let mut wish = total;
        for (widget, &depth) in widgets.iter().zip(depths) {
            let Some(extent) = widget.roughness::<L>(along) else { return overlapping };
            let matters = splat(MIX_PRODUCT).lt(depth * total);
            wish = L::F::select(matters, extent.max(wish), wish);
        }
        let served = overlapping & wish.le(splat(STEPS as f32)).bits();
        if served == 0 {
            return overlapping;
        }
        let one_step = served & !wish.le(splat(1.0)).bits() == 0;
        let steps = if one_step { 1 } else { STEPS };
        let share = splat(1.0 / steps as f32);
        let (mut color, mut through) = ([splat(0.0); 3], splat(1.0));
        // Widgets too thin for the order to matter are mixed in.
        let average = one_minus_exp::<L>(total) / total.max(splat(f32::MIN_POSITIVE));
        for (widget, &depth) in widgets.iter().zip(depths) {
            let matters = splat(MIX_PRODUCT).lt(depth * total);
            let mixed = L::F::select(matters, splat(0.0), depth * average);
            for (sum, c) in color.iter_mut().zip(widget.color()) {
                *sum = mixed.mul_add(splat(c), *sum);
            }
        }
        for step in 0..steps {
            let (mut density, mut weighted) = ([splat(0.0); 4], [[splat(0.0); 3]; 4]);
            for (widget, &widget_depth) in widgets.iter().zip(depths) {
                let matters = splat(MIX_PRODUCT).lt(widget_depth * total);
                for j in 0..4 {
                    let t = share * splat(step as f32 + NODES[j]);
                    let value = L::F::select(matters, widget.density::<L>(along, t), splat(0.0));
                    density[j] = density[j] + value;
                    for (sum, c) in weighted[j].iter_mut().zip(widget.color()) {
                        *sum = value.mul_add(splat(c), *sum);
                    }
                }
            }
            // Depth up to each node from the cubic through the four densities, then the emission there.
            let length = along.length * share;
            let mut whole = splat(0.0);
            for j in 0..4 {
                let mut depth = splat(0.0);
                for k in 0..4 {
                    depth = density[k].mul_add(splat(UP_TO[j][k]), depth);
                }
                let visible = through * exp::<L>(-(depth * length)) * length * splat(WEIGHTS[j]);
                for (sum, w) in color.iter_mut().zip(weighted[j]) {
                    *sum = w.mul_add(visible, *sum);
                }
                whole = density[j].mul_add(splat(WEIGHTS[j]), whole);
            }
            through = through * exp::<L>(-(whole * length));
        }
        replace::<L>(
            served,
            at,
            out,
            #[inline(always)]
            |channel, _| color[channel],
        );
        overlapping & !served
    }
}

/// Puts new colours, made from channel and mixed colour, in the lanes that were served.
#[inline(always)]
fn replace<L: Lanes>(served: u32, at: usize, out: &mut Shaded, color: impl Fn(usize, L::F) -> L::F) {
    let keep = lanes_of::<L>(served);
    for (channel, column) in out.rgba.iter_mut().enumerate().take(3) {
        let mixed = L::F::load(&column[at..]);
        L::F::select(keep, color(channel, mixed), mixed).store(&mut column[at..]);
    }
}

/// Steps of the ordered quadrature where one does not do.
const STEPS: usize = 4;

/// Gauss-Legendre on [0, 1] with 4 points.
const NODES: [f32; 4] = [0.069_431_84, 0.330_009_5, 0.669_990_54, 0.930_568_2];
const WEIGHTS: [f32; 4] = [0.173_927_42, 0.326_072_58, 0.326_072_58, 0.173_927_42];
/// ∫₀^{node j} of the Lagrange polynomial of node k.
const UP_TO: [[f32; 4]; 4] = [
    [0.08696371, -0.02660418, 0.012627463, -0.0035551498],
    [0.18811812, 0.16303629, -0.027880428, 0.0067355004],
    [0.16719192, 0.353953, 0.16303629, -0.014190695],
    [0.17748258, 0.31344512, 0.35267675, 0.08696371],
];
