//! Handles of widgets: what a hand takes hold of, and where it lies.

use super::form::Drawn;
use super::scale::{Scale, height_of};
use super::shape::{Form, Region};

/// What a hand takes hold of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Handle {
    Centre,
    /// The end of a half axis.
    Width(usize),
    Angle,
    /// How much of a wave is kept around its peaks.
    Band,
    /// A corner of the region.
    Corner(usize),
    /// A side of the region: along which axis, and whether the upper end.
    Side(usize, bool),
    /// A point of a curve, by its place.
    Point(usize),
}

/// Where a turned axis is taken hold of, in half axes.
const ARM: f64 = 1.7;

/// The band's handle lies beside the wave's line by so much of the axes.
const BESIDE: f64 = 0.07;

impl Drawn {
    /// The handles, each with its place.
    pub fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let mut handles = Vec::new();
        let top = scale.top();
        match &self.form {
            Form::Gaussian { centre, axes } => {
                handles.push((Handle::Centre, *centre));
                let finite = |axis: &[f64; 2]| axis.iter().all(|x| x.is_finite());
                for (i, axis) in axes.iter().enumerate().filter(|(_, axis)| finite(axis)) {
                    handles.push((Handle::Width(i), [centre[0] + axis[0], centre[1] + axis[1]]));
                }
                if axes.iter().all(finite) {
                    let arm = [centre[0] + ARM * axes[0][0], centre[1] + ARM * axes[0][1]];
                    handles.push((Handle::Angle, arm));
                }
            }
            Form::Triangular { centre, sigma } => {
                handles.push((Handle::Centre, [*centre, 0.0]));
                handles.push((Handle::Width(0), [centre + sigma * 0.8 * top, 0.8 * top]));
            }
            Form::Wave { origin, angle, scale: factors, period, .. } => {
                handles.push((Handle::Centre, *origin));
                let (sin, cos) = angle.to_radians().sin_cos();
                let along = [cos * period / factors[0], sin * period / factors[1]];
                handles.push((Handle::Width(0), [origin[0] + along[0], origin[1] + along[1]]));
                let (end, beside) = (self.band_end(), [-sin, cos]);
                let place = |k: usize| origin[k] + end * along[k] + BESIDE * beside[k] * scale.extent[k];
                handles.push((Handle::Band, [place(0), place(1)]));
            }
            Form::Points(points) => {
                let place = |p: &[f64; 5]| [p[0], height_of(p[4], scale.peak) * top];
                handles.extend(points.iter().enumerate().map(|(i, p)| (Handle::Point(i), place(p))));
            }
            Form::Table { s, g } => {
                for (i, corner) in corners([*s, *g]).into_iter().enumerate() {
                    handles.push((Handle::Corner(i), corner));
                }
            }
            Form::Uniform | Form::Elsewhere => {}
        }
        match &self.region {
            Region::Whole => {}
            Region::Box(limits) => {
                if limits.as_flattened().iter().all(|x| x.is_finite()) {
                    let all = corners(*limits).into_iter().enumerate();
                    handles.extend(all.map(|(i, at)| (Handle::Corner(i), at)));
                }
                handles.extend(sides(*limits, scale));
            }
            Region::Polygon(corners) => {
                handles.extend(corners.iter().enumerate().map(|(i, at)| (Handle::Corner(i), *at)));
            }
        }
        handles
    }

    /// Where the first band ends, in periods from the wave's origin.
    fn band_end(&self) -> f64 {
        let Form::Wave { band_width, .. } = self.form else { return 1.0 };
        match self.kind.as_str() {
            "sine-wave" => 0.5 + 2.0 * (0.5 * band_width).sqrt().asin() / std::f64::consts::PI,
            _ => 0.5 + 0.5 * band_width,
        }
    }
}

/// The sides that limit, each in the middle of what is shown of it.
fn sides(limits: [[f64; 2]; 2], scale: &Scale) -> Vec<(Handle, [f64; 2])> {
    let mut handles = Vec::new();
    for axis in 0..2 {
        let other = 1 - axis;
        let [low, high] = scale.shown[other];
        let middle = 0.5 * (limits[other][0].clamp(low, high) + limits[other][1].clamp(low, high));
        for (end, limit) in limits[axis].into_iter().enumerate().filter(|(_, limit)| limit.is_finite()) {
            let mut at = [middle; 2];
            at[axis] = limit;
            handles.push((Handle::Side(axis, end == 1), at));
        }
    }
    handles
}

/// The corners of a box, against the clock from the lower left.
pub(super) fn corners([s, g]: [[f64; 2]; 2]) -> [[f64; 2]; 4] {
    [[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]]
}
