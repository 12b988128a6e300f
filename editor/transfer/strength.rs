//! How strong a widget is at a place of the plane, and how much of the volume it holds.

use super::fields::OfFields;
use super::form::Drawn;
use super::shape::{Form, Region};
use std::f64::consts::PI;
use voltet_core::probing::{Axis, Histogram};

impl Drawn {
    /// Its strength at a place, 0 to 1 of its peak; what it holds is where that is half or more.
    pub fn strength(&self, at: [f64; 2]) -> f64 {
        let within = match &self.region {
            Region::Whole => true,
            Region::Box(limits) => (0..2).all(|k| at[k] >= limits[k][0] && at[k] <= limits[k][1]),
            Region::Polygon(corners) => holds(corners, at),
        };
        if !within {
            return 0.0;
        }
        match &self.form {
            Form::Gaussian { centre, axes } => {
                let v = [at[0] - centre[0], at[1] - centre[1]];
                (-0.5 * squared(axes, v)).exp()
            }
            Form::Triangular { centre, sigma } => {
                let q = (at[0] - centre) / (sigma * at[1]).abs().max(1e-300);
                (-q * q).exp()
            }
            Form::Wave { origin, angle, scale, period, band_width } => {
                let (sin, cos) = angle.to_radians().sin_cos();
                let across = (at[0] - origin[0]) * cos * scale[0] + (at[1] - origin[1]) * sin * scale[1];
                let phase = across / period;
                let profile = match self.kind.as_str() {
                    "sine-wave" => (PI * phase).sin().abs(),
                    _ => 1.0 - (2.0 * (phase - phase.floor()) - 1.0).abs(),
                };
                (1.0 - (1.0 - profile) / band_width).max(0.0)
            }
            Form::Points(points) => {
                let peak = self.peak_of_curve();
                if peak > 0.0 { along(points, at[0])[4] / peak } else { 0.0 }
            }
            Form::Table { s, g } => {
                f64::from(at[0] >= s[0] && at[0] <= s[1] && at[1] >= g[0] && at[1] <= g[1])
            }
            Form::Uniform => 1.0,
            Form::Elsewhere => 0.0,
        }
    }

    /// The share of the volume where it is at half of its peak or more; `None` where it does not lie in the plane.
    pub fn held(&self, histogram: &Histogram) -> Option<f64> {
        let in_plane = self.of_fields.as_ref().is_none_or(OfFields::is_in_plane);
        if matches!(self.form, Form::Elsewhere) || !in_plane {
            return None;
        }
        let [s, g] = histogram.axes;
        let mut sum = 0.0;
        for (j, row) in histogram.volumes.chunks(s.bins).enumerate() {
            let at_g = middle(g, j);
            for (i, volume) in row.iter().enumerate().filter(|(_, volume)| **volume > 0.0) {
                if self.strength([middle(s, i), at_g]) >= 0.5 {
                    sum += volume;
                }
            }
        }
        Some(sum / histogram.total)
    }
}

/// The value in the middle of a bin.
pub(super) fn middle(axis: Axis, i: usize) -> f64 {
    0.5 * axis.edge(i) + 0.5 * axis.edge(i + 1)
}

/// A curve at a value: [s, r, g, b, extinction].
pub(super) fn along(points: &[[f64; 5]], s: f64) -> [f64; 5] {
    let after = points.partition_point(|point| point[0] < s);
    let at = match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(low), Some(high)) => {
            let share = if high[0] > low[0] { (s - low[0]) / (high[0] - low[0]) } else { 1.0 };
            std::array::from_fn(|k| low[k] * (1.0 - share) + high[k] * share)
        }
        (Some(one), None) | (None, Some(one)) => *one,
        (None, None) => [0.0; 5],
    };
    [s, at[1], at[2], at[3], at[4]]
}

/// Squared length of a vector in half axes; those that are infinite count nothing.
fn squared(axes: &[[f64; 2]; 2], v: [f64; 2]) -> f64 {
    if axes[0][1] == 0.0 && axes[1][0] == 0.0 {
        return (v[0] / axes[0][0]).powi(2) + (v[1] / axes[1][1]).powi(2);
    }
    let det = axes[0][0] * axes[1][1] - axes[1][0] * axes[0][1];
    let a = (v[0] * axes[1][1] - v[1] * axes[1][0]) / det;
    let b = (axes[0][0] * v[1] - axes[0][1] * v[0]) / det;
    a * a + b * b
}

/// Whether a polygon holds a place.
fn holds(corners: &[[f64; 2]], at: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a[1] > at[1]) != (b[1] > at[1]) && at[0] < (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]) + a[0] {
            inside = !inside;
        }
    }
    inside
}
