//! Widgets that overlap on a segment, in their order along it: corrections of the mix, cheapest first, for profiles that
//! are smooth there. What these leave over is walked in panels ([`super::panels`]).

use crate::shade::along::{Along, lanes_of};
use crate::shade::kinds::LaneWidget;
use crate::shade::shaded::{Colors, MIX_PRODUCT};
use crate::shade::shapes::Shapes;
use voltet_core::optics::quadrature::{GAUSS_4, UP_TO_4};
use voltet_lanes::optics::elementary::{exp, one_minus_exp};
use voltet_lanes::optics::quadrature::{nodes, up_to};
use voltet_lanes::optics::smooth::{DensityShape, Smooth};
use voltet_lanes::{Float, Lanes, Mask, array, inlined};

/// One vector of segments with the shapes of its widgets.
pub(crate) struct Overlapping<'a, L: Lanes> {
    /// The scene's, of which `shapes` holds those that are met.
    pub widgets: &'a [LaneWidget],
    pub along: &'a Along<L>,
    pub shapes: &'a Shapes,
    /// Σ T.
    pub total: L::F,
    /// Σ_{i<j} T_i T_j.
    pub product: L::F,
}

impl<L: Lanes> Overlapping<'_, L> {
    /// Whether a widget is dense enough for its order to matter.
    #[inline(always)]
    fn matters(&self, shape: &DensityShape<L>) -> L::M {
        L::F::splat(MIX_PRODUCT).lt(shape.depth * self.total)
    }

    /// The ordered light in closed form where every density hardly bends ([`Smooth`]). Corrects the mix in `out`; returns
    /// the lanes it served.
    #[inline(always)]
    pub fn smooth(&self, overlapping: u32, at: usize, out: &mut Colors) -> u32 {
        let zero = L::F::splat(0.0);
        let (mut change, mut tilted, mut bent) = (zero, zero, zero);
        for (_, shape) in self.shapes.iter::<L>() {
            // A widget that does not matter may have an endless tilt.
            let matters = self.matters(&shape);
            let add = inlined(
                #[inline(always)]
                |sum: L::F, x: L::F| L::F::select(matters, x.mul_add(shape.depth, sum), sum),
            );
            change = L::F::select(matters, change.max(shape.change_squared), change);
            tilted = add(tilted, shape.tilt);
            bent = add(bent, shape.bend);
        }
        let served =
            overlapping & Smooth::<L>::holds(self.total, self.product, change, Smooth::<L>::BOUND).bits();
        if served == 0 {
            return 0;
        }
        let smooth = Smooth::<L>::new(self.total, tilted, bent);
        let mut correction = [zero; 3];
        for (number, shape) in self.shapes.iter::<L>() {
            let more = L::F::select(self.matters(&shape), smooth.correction(&shape), zero);
            for (sum, c) in correction.iter_mut().zip(self.widgets[number].color) {
                *sum = more.mul_add(L::F::splat(c), *sum);
            }
        }
        replace::<L>(
            served,
            at,
            out,
            #[inline(always)]
            |channel, mixed| (mixed + correction[channel]).max(zero),
        );
        served
    }

    /// The ordered integral ∫ Σ c_i ρ_i e^(−T) by Gauss-Legendre with 4 points on one or four equal steps, for
    /// segments on which every widget's profile is smooth and the depth moderate; the lanes it cannot serve are
    /// returned.
    #[inline(always)]
    pub fn quadrature(&self, overlapping: u32, at: usize, out: &mut Colors) -> u32 {
        let splat = L::F::splat;
        let &Overlapping { shapes, total, .. } = self;
        // How many steps the roughest lane wants: a cubic through four densities leaves 3e-5 of the depth where a Gaussian
        // extends over half a width; where the logarithm of a density changes by more than 0.7 to either side of a step's middle
        // more is left of a tail.
        let (mut widest, mut steepest) = (splat(0.0), splat(0.0));
        for (_, shape) in shapes.iter::<L>() {
            let matters = self.matters(&shape);
            widest = L::F::select(matters, widest.max(shape.extent_squared), widest);
            steepest = L::F::select(matters, steepest.max(shape.change_squared), steepest);
        }
        let wish = total.max(widest.sqrt() * splat(2.0)).max(steepest.sqrt() * splat(1.4));
        let served = overlapping & wish.le(splat(STEPS as f32)).bits();
        if served == 0 {
            return overlapping;
        }
        // Each lane by its own steps, so that no segment's light depends on its neighbours in the vector.
        let short = served & wish.le(splat(1.0)).bits();
        for (lanes, steps) in [(short, 1), (served & !short, STEPS)] {
            if lanes != 0 {
                self.step_through(steps, lanes, at, out);
            }
        }
        overlapping & !served
    }

    /// The quadrature on so many equal steps, for some lanes.
    #[inline(always)]
    fn step_through(&self, steps: usize, lanes: u32, at: usize, out: &mut Colors) {
        let splat = L::F::splat;
        let &Overlapping { widgets, along, shapes, total, .. } = self;
        let share = splat(1.0 / steps as f32);
        let (mut color, mut through) = ([splat(0.0); 3], splat(1.0));
        let mut light = splat(0.0);
        for step in 0..steps {
            let (mut density, mut weighted) = ([splat(0.0); 4], [[splat(0.0); 3]; 4]);
            let at_nodes = array(
                #[inline(always)]
                |j: usize| share * splat(step as f32 + NODES[j].0),
            );
            for (number, shape) in shapes.iter::<L>() {
                let (widget, matters) = (&widgets[number], self.matters(&shape));
                let values = widget.densities::<L>(along, at_nodes);
                for j in 0..4 {
                    let value = L::F::select(matters, values[j], splat(0.0));
                    density[j] = density[j] + value;
                    for (sum, c) in weighted[j].iter_mut().zip(widget.color) {
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
                let visible = through * exp::<L>(-(depth * length)) * length * splat(NODES[j].1);
                light = density[j].mul_add(visible, light);
                for (sum, w) in color.iter_mut().zip(weighted[j]) {
                    *sum = w.mul_add(visible, *sum);
                }
                whole = density[j].mul_add(splat(NODES[j].1), whole);
            }
            through = through * exp::<L>(-(whole * length));
        }
        // All light together is known in closed form; the quadrature only shares it out, so that where one widget is nearly all
        // there is, nearly nothing of its error stays. Widgets too thin for the order to matter are mixed in.
        let average = one_minus_exp::<L>(total) / total.max(splat(f32::MIN_POSITIVE));
        let (mut thin, mut mixed) = (splat(0.0), [splat(0.0); 3]);
        for (number, shape) in shapes.iter::<L>() {
            let depth = L::F::select(self.matters(&shape), splat(0.0), shape.depth);
            thin = thin + depth;
            for (sum, c) in mixed.iter_mut().zip(widgets[number].color) {
                *sum = depth.mul_add(splat(c), *sum);
            }
        }
        let exact = (total - thin) * average / light.max(splat(f32::MIN_POSITIVE));
        for (sum, mixed) in color.iter_mut().zip(mixed) {
            *sum = mixed.mul_add(average, *sum * exact);
        }
        replace::<L>(
            lanes,
            at,
            out,
            #[inline(always)]
            |channel, _| color[channel],
        );
    }
}

/// Puts new colours, made from channel and mixed colour, in the lanes that were served.
#[inline(always)]
fn replace<L: Lanes>(served: u32, at: usize, out: &mut Colors, color: impl Fn(usize, L::F) -> L::F) {
    let keep = lanes_of::<L>(served);
    for (channel, column) in out.iter_mut().enumerate().take(3) {
        let mixed = L::F::load(&column[at..]);
        L::F::select(keep, color(channel, mixed), mixed).store(&mut column[at..]);
    }
}

/// Steps of the ordered quadrature where one does not do.
const STEPS: usize = 4;

/// Gauss-Legendre on [0, 1] with 4 points.
const NODES: [(f32, f32); 4] = nodes(GAUSS_4);
/// ∫₀^{node j} of the Lagrange polynomial of node k.
const UP_TO: [[f32; 4]; 4] = up_to(UP_TO_4);
