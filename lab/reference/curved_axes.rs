//! Segments along curved axes: point values of the widgets at the positions of s and g, by the same rule in pieces that are halved until
//! they are smooth (docs/src/explanation/optics.md, section 5).
//!
//! Slower and less sharp than quadrature along straight axes, whose terms keep digits that point values lose: 1e-10 of the opacity.

use crate::segment::{NODES, RULE, estimated_error};
use voltet_core::transfer::{
    AxisOrigin, AxisScale, ColorSource, ControlPoint, OpticalModel, Profile, TransferFunction, Widget,
};
use voltet_core::{Error, Result};
use voltet_optics::Contribution;
use voltet_optics::trace::{CellCrossing, SegmentIntegral};

/// Error of a piece, by its part of the segment and by its own value.
const RELATIVE: f64 = 1e-10;

/// Error of a segment that is not noticed.
const ABSOLUTE: f64 = 1e-13;

/// A piece over which more optical depth piles up is halved.
const DEPTH_AT_ONCE: f64 = 3.0;

/// Behind so much optical depth nothing is seen.
const DARK_DEPTH: f64 = 60.0;

/// Halvings of one segment at most.
const MAX_HALVINGS: usize = 1_000_000;

/// Pieces shorter than this hold a jump.
const SHORTEST: f64 = 1e-13;

/// Distance of the cuts that every segment has along its axes, in decades.
const DECADE_SHARE: f64 = 0.125;

/// Samples between two cuts, in search of edges aslant.
const EDGE_SAMPLES: u32 = 8;

/// Quadrature along curved axes.
pub struct CurvedQuadrature {
    transfer_function: TransferFunction,
    /// Places of each widget's fields behind s and g.
    fields: Vec<Vec<usize>>,
}

/// Extinction at a place, then the emission of each channel (1/L).
type Density = [f64; 4];

impl CurvedQuadrature {
    /// Errors: those of [`TransferFunction::check`].
    pub fn new(transfer_function: &TransferFunction) -> Result<Self> {
        transfer_function.check()?;
        let names = transfer_function.fields();
        let places = |widget: &Widget| {
            let own = widget.profile.properties().fields;
            own.iter().filter_map(|name| Some(2 + names.iter().position(|other| other == name)?)).collect()
        };
        let fields = transfer_function.widgets.iter().map(places).collect();
        Ok(CurvedQuadrature { transfer_function: transfer_function.clone(), fields })
    }

    fn density(&self, values: &[f64]) -> Density {
        let TransferFunction { model, unit_distance, widgets, .. } = &self.transfer_function;
        let axes = self.transfer_function.axes_read();
        let place = [axes[0].position(values[0]), axes[1].position(values[1])];
        let mut sum = [0.0; 4];
        if place.contains(&f64::NEG_INFINITY) {
            return sum;
        }
        for (widget, own) in widgets.iter().zip(&self.fields) {
            let own: Vec<f64> = own.iter().map(|k| values[*k]).collect();
            let share = widget.weight_at(place, &own);
            let color = match widget.profile.properties().color {
                ColorSource::Widget => widget.color,
                ColorSource::Points(points) => {
                    ControlPoint::between(points, place[0]).map_or([0.0; 3], |point| point.color)
                }
                ColorSource::Texels(_) => match &widget.profile {
                    Profile::Table(table) => {
                        let [r, g, b, _] = table.at(place).map(f64::from);
                        [r, g, b]
                    }
                    _ => widget.color,
                },
            };
            let extinction = widget.peak() * share / unit_distance;
            let glow = match model {
                OpticalModel::DensityEmitter => extinction,
                OpticalModel::ConstantEmitter { cutoff } if share > *cutoff && widget.peak() > 0.0 => {
                    1.0 / unit_distance
                }
                OpticalModel::ConstantEmitter { .. } => 0.0,
            };
            sum[0] += extinction;
            (0..3).for_each(|c| sum[c + 1] += color[c] * glow);
        }
        sum
    }

    /// Shares of the segment at which it is cut from the beginning, ascending: positions of edges, control points and centres, and even
    /// steps along the axes.
    fn cuts(&self, front: &[f64], back: &[f64]) -> Vec<f64> {
        let mut cuts = vec![0.0, 1.0];
        for (axis, scale) in self.transfer_function.axes_read().into_iter().enumerate() {
            let (f, b) = (front[axis], back[axis]);
            let largest = f.abs().max(b.abs());
            if f == b || largest == 0.0 {
                continue;
            }
            let mut positions: Vec<f64> = Vec::new();
            for widget in &self.transfer_function.widgets {
                let properties = widget.profile.properties();
                let regions = widget.region.iter().chain(&properties.range);
                positions.extend(regions.flat_map(|region| &region.corners).map(|corner| corner[axis]));
                if let (ColorSource::Points(points), 0) = (properties.color, axis) {
                    positions.extend(points.iter().map(|point| point.s));
                }
                if let Some(AxisOrigin::Centre(centre)) = properties.axes.get(axis) {
                    let width = widget.profile.width(axis);
                    positions.extend((-12..=12).map(|k| centre + 0.5 * f64::from(k) * width));
                }
            }
            if scale.is_curved() {
                let end = scale.position(largest);
                let steps = (40.0 / DECADE_SHARE) as i32;
                positions.extend((0..steps).map(|k| end - DECADE_SHARE * f64::from(k)));
                if scale != AxisScale::Log {
                    positions.extend((0..steps).map(|k| -end + DECADE_SHARE * f64::from(k)));
                }
            }
            let shares = positions.into_iter().filter(|u| u.is_finite());
            cuts.extend(shares.map(|u| (scale.value(u) - f) / (b - f)));
            cuts.push(-f / (b - f));
        }
        cuts.retain(|share| (0.0..=1.0).contains(share));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let edges = self.crossed_edges(front, back, &cuts);
        cuts.extend(edges);
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// Shares at which the path passes edges of regions that lie aslant, or cutoffs: between two samples of different sides, halved.
    fn crossed_edges(&self, front: &[f64], back: &[f64], cuts: &[f64]) -> Vec<f64> {
        let TransferFunction { model, widgets, .. } = &self.transfer_function;
        let axes = self.transfer_function.axes_read();
        let values = |share: f64| -> Vec<f64> {
            front.iter().zip(back).map(|(front, back)| front + share * (back - front)).collect()
        };
        let place = |values: &[f64]| [0, 1].map(|axis| axes[axis].position(values[axis]));
        let mut found = Vec::new();
        for plane in widgets.iter().flat_map(Widget::half_planes).filter(|plane| !plane.normal.contains(&0.0))
        {
            let is_inside = |share: f64| {
                let at = place(&values(share));
                (0..2).map(|axis| plane.normal[axis] * (at[axis] - plane.corner[axis])).sum::<f64>() >= 0.0
            };
            add_changes(cuts, &is_inside, &mut found);
        }
        for (widget, fields) in widgets.iter().zip(&self.fields) {
            let Some(cutoff) = model.cutoff() else { break };
            let glows = |share: f64| {
                let values = values(share);
                let own: Vec<f64> = fields.iter().map(|k| values[*k]).collect();
                widget.weight_at(place(&values), &own) > cutoff
            };
            add_changes(cuts, &glows, &mut found);
        }
        found
    }
}

/// Optical depth of each widget by itself in the cells of a ray. Errors: what cannot be integrated.
pub(crate) fn widget_depths(
    transfer_function: &TransferFunction,
    cells: &[CellCrossing],
) -> Result<Vec<Vec<f64>>> {
    let alone = |widget: &Widget| {
        let widgets = vec![widget.clone()];
        CurvedQuadrature::new(&TransferFunction { widgets, ..transfer_function.clone() })
    };
    let alone = transfer_function.widgets.iter().map(alone).collect::<Result<Vec<_>>>()?;
    let all = transfer_function.fields();
    let own: Vec<Vec<usize>> =
        transfer_function.widgets.iter().map(|widget| own_values(widget, &all)).collect();
    let depths = |cell: &CellCrossing| -> Result<Vec<f64>> {
        let depth = |(integral, own): (&CurvedQuadrature, &Vec<usize>)| {
            let [front, back] =
                [&cell.front, &cell.back].map(|end| own.iter().map(|k| end[*k]).collect::<Vec<_>>());
            let found = integral.integrate(cell.length, &front, &back);
            found.map(|part| part.optical_depth).map_err(|error| error.at_item(format!("cell {}", cell.cell)))
        };
        alone.iter().zip(&own).map(depth).collect()
    };
    cells.iter().map(depths).collect()
}

/// Places of s, g and a widget's fields, in the order of their names, among the values of all widgets.
fn own_values(widget: &Widget, all: &[&str]) -> Vec<usize> {
    let mut fields = widget.profile.properties().fields;
    fields.sort_unstable();
    fields.dedup();
    let places = fields.iter().filter_map(|name| all.iter().position(|other| other == name));
    [0, 1].into_iter().chain(places.map(|place| 2 + place)).collect()
}

/// Adds the shares at which a property changes, as far as samples between cuts show it.
fn add_changes(cuts: &[f64], property: &dyn Fn(f64) -> bool, found: &mut Vec<f64>) {
    for pair in cuts.windows(2) {
        let at = |k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(EDGE_SAMPLES);
        for k in 0..EDGE_SAMPLES {
            let (mut low, mut high) = (at(k), at(k + 1));
            let first = property(low);
            if property(high) == first {
                continue;
            }
            loop {
                let middle = 0.5 * (low + high);
                if !(low < middle && middle < high) {
                    break;
                }
                if property(middle) == first { low = middle } else { high = middle }
            }
            found.push(high);
        }
    }
}

impl SegmentIntegral for CurvedQuadrature {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        let mut sum = Contribution::default();
        let mut pending: Vec<[f64; 2]> =
            self.cuts(front, back).windows(2).rev().map(|pair| [pair[0], pair[1]]).collect();
        let mut halvings = 0;
        let mut values = vec![0.0; front.len()];
        while let Some([from, to]) = pending.pop() {
            let mut densities = [[0.0; NODES]; 4];
            for (node, place) in RULE.nodes.iter().enumerate() {
                let t = from + (to - from) * place;
                for (value, (f, b)) in values.iter_mut().zip(front.iter().zip(back)) {
                    *value = f + t * (b - f);
                }
                let density = self.density(&values);
                densities.iter_mut().zip(density).for_each(|(channel, x)| channel[node] = x);
            }
            let part = (to - from) * length;
            let over = |weights: &[f64; NODES], values: &[f64; NODES]| {
                weights.iter().zip(values).map(|(w, x)| w * x).sum::<f64>() * part
            };
            let light = (-sum.optical_depth).exp();
            let through: [f64; NODES] =
                std::array::from_fn(|k| (-over(&RULE.running[k], &densities[0])).exp());
            let seen = |channel: &[f64; NODES]| std::array::from_fn(|k| channel[k] * through[k]);
            let integrands = [densities[0], seen(&densities[1]), seen(&densities[2]), seen(&densities[3])];
            let found = integrands.map(|f| [over(&RULE.kronrod, &f), over(&RULE.gauss, &f)]);
            let depth = found[0][0];
            let is_smooth = depth <= DEPTH_AT_ONCE
                && found.iter().all(|[kronrod, gauss]| {
                    let allowed = RELATIVE * kronrod + ABSOLUTE * (to - from).max(1e-3);
                    light * estimated_error(*kronrod, *gauss, *kronrod) <= allowed
                });
            if !is_smooth && sum.optical_depth < DARK_DEPTH && to - from > SHORTEST * to {
                halvings += 1;
                if halvings > MAX_HALVINGS {
                    return Err(Error::run(
                        "the reference did not converge on a segment along a curved axis",
                    )
                    .got(format!("{halvings} halvings")));
                }
                let middle = 0.5 * (from + to);
                pending.extend([[middle, to], [from, middle]]);
                continue;
            }
            for (color, [kronrod, _]) in sum.color.iter_mut().zip(&found[1..]) {
                *color += light * kronrod;
            }
            sum.optical_depth += depth;
        }
        sum.opacity = -(-sum.optical_depth).exp_m1();
        Ok(sum)
    }
}
