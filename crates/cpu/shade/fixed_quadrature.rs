//! Fixed Gauss–Legendre quadrature of widgets that overlap on a segment, in their order along it, in equal steps: for profiles that are
//! smooth there and moderate depths. Other segments are integrated in panels ([`super::panels`]).

use crate::fragments::batch::{Batch, MAX_LANES};
use crate::shade::kinds::{LaneWidget, for_each_active_widget};
use crate::shade::segment_lanes::{SegmentGather, SegmentLanes};
use crate::shade::shaded_batch::{ShadedBatch, StepLanes, SteppedWidget};
use voltet_optics::quadrature::{GAUSS_4, UP_TO_4};
use voltet_simd::optics::elementary::exp;
use voltet_simd::optics::quadrature::{nodes, up_to};
use voltet_simd::{Float, Lanes, Mask, array, inlined, mask_of};

/// Interval (steps) at which densities are evaluated anew.
const STEPS_ON_END: usize = 4;

/// Integrates the colours of the segments `which` of a batch, whose opacities stand in `out`, in `steps` steps.
#[inline(always)]
pub(crate) fn integrate_fixed<L: Lanes>(
    widgets: &[LaneWidget],
    steps: usize,
    batch: &Batch,
    which: &[usize],
    out: &mut ShadedBatch,
) {
    let splat = L::F::splat;
    let mut gather = SegmentGather::new(batch.scalar_count.min(2));
    out.evaluation_count += (4 * steps * which.len()) as u64;
    for group in which.chunks(L::WIDTH) {
        gather.take(batch, group);
        let segments = gather.segments::<L>();
        out.active_widgets.clear();
        for_each_active_widget(
            widgets,
            &segments,
            inlined!(|number, widget: &LaneWidget, meets: L::M| {
                let rough = splat((steps * steps) as f32 * 1.01).lt(widget.roughness::<L>(&segments));
                out.active_widgets.push(SteppedWidget {
                    number,
                    there: meets.and(rough.not()).bits(),
                    rows: None,
                });
            }),
        );
        let mut opacity = [0f32; MAX_LANES];
        for (opacity, &k) in opacity.iter_mut().zip(group) {
            *opacity = out.rgba[3][k];
        }
        let color =
            step_through::<L>(widgets, &mut out.active_widgets, steps, &segments, L::F::load(&opacity));
        out.put::<L, 3>(group, color);
    }
}

/// The ordered integral ∫ Σ c_i ρ_i e^(−T) by Gauss-Legendre with 4 points a step.
#[inline(always)]
fn step_through<L: Lanes>(
    widgets: &[LaneWidget],
    met: &mut [SteppedWidget],
    steps: usize,
    segments: &SegmentLanes<L>,
    opacity: L::F,
) -> [L::F; 3] {
    let splat = L::F::splat;
    let share = 1.0 / steps as f32;
    let places = [NODES[0].0, NODES[1].0, NODES[2].0, NODES[3].0];
    let (mut color, mut through) = ([splat(0.0); 3], splat(1.0));
    let mut light = splat(0.0);
    for step in 0..steps {
        let (mut density, mut weighted) = ([splat(0.0); 4], [[splat(0.0); 3]; 4]);
        for SteppedWidget { number, there, rows } in &mut *met {
            let widget = &widgets[*number];
            let found = match rows {
                Some(rows) if step % STEPS_ON_END != 0 => Some(rows.steps::<L>().next()),
                _ => widget.steps::<L, 4>(segments, step, share, places, widget.density()),
            };
            let values = match &found {
                Some(found) => found.values,
                None => widget.densities::<L, 4>(segments, places.map(|place| share * (step as f32 + place))),
            };
            *rows = found.as_ref().map(StepLanes::new);
            let there = mask_of::<L>(*there);
            for j in 0..4 {
                let value = L::F::select(there, values[j], splat(0.0));
                density[j] = density[j] + value;
                for (sum, c) in weighted[j].iter_mut().zip(widget.color) {
                    *sum = value.mul_add(splat(c), *sum);
                }
            }
        }
        // Depth up to each node from the cubic through the four densities, then the emission there.
        let length = segments.length * splat(share);
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
    // there is, nearly nothing of its error stays.
    let exact = opacity / light.max(splat(f32::MIN_POSITIVE));
    array!(|c| color[c] * exact)
}

/// Gauss-Legendre on [0, 1] with 4 points.
const NODES: [(f32, f32); 4] = nodes(GAUSS_4);
/// ∫₀^{node j} of the Lagrange polynomial of node k.
const UP_TO: [[f32; 4]; 4] = up_to(UP_TO_4);
