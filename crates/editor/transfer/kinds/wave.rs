//! Bands across s and g.

use super::super::geometry::{Change, Handle, Scale, list, rounded};
use super::super::plane::WidgetPainter;
use super::super::shape::Shape;
use eframe::egui::Stroke;
use voltet_core::transfer::Wave;
use voltet_graph::ParameterValue;

/// The band's handle lies beside the wave's line by so much of the axes.
const HANDLE_OFFSET: f64 = 0.07;

/// Bands that are drawn at most.
const MAX_BANDS: usize = 200;

#[derive(Debug)]
pub(super) struct Bands {
    pub wave: Wave,
    pub sine: bool,
}

impl Bands {
    /// Position across the bands (periods from the origin).
    fn phase(&self, at: [f64; 2]) -> f64 {
        let (step, origin) = (self.wave.step(), self.wave.origin);
        (at[0] - origin[0]) * step[0] + (at[1] - origin[1]) * step[1]
    }
}

impl Shape for Bands {
    fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let Wave { origin, angle, scale: factors, period, .. } = self.wave;
        let (sin, cos) = angle.sin_cos();
        let along = [cos * period / factors[0], sin * period / factors[1]];
        let (end, beside) = (0.5 + self.wave.half_band(self.sine), [-sin, cos]);
        let place = |k: usize| origin[k] + end * along[k] + HANDLE_OFFSET * beside[k] * scale.extent[k];
        vec![
            (Handle::Centre, origin),
            (Handle::Width(0), [origin[0] + along[0], origin[1] + along[1]]),
            (Handle::Band, [place(0), place(1)]),
        ]
    }

    fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        let Wave { origin, scale: factors, .. } = self.wave;
        match handle {
            Handle::Width(_) => {
                let v = [(to[0] - origin[0]) * factors[0], (to[1] - origin[1]) * factors[1]];
                let period = v[0].hypot(v[1]).max(1e-6 * scale.extent[0] * factors[0].abs());
                let angle = v[1].atan2(v[0]).to_degrees();
                let angle = if angle.abs() < 2.0 { 0.0 } else { angle };
                vec![
                    ("period", Some(ParameterValue::Number(rounded(period)))),
                    ("angle", Some(ParameterValue::Number(rounded(angle)))),
                ]
            }
            Handle::Band => {
                let half = (self.phase(to) - 0.5).clamp(0.005, 0.5);
                let width = Wave::band_width_of(half, self.sine);
                vec![("band_width", Some(ParameterValue::Number(rounded(width.min(1.0)))))]
            }
            _ => vec![("origin", Some(list(&to)))],
        }
    }

    /// The peaks as lines across the plane.
    fn draw(&self, pen: &WidgetPainter) {
        let (step, origin) = (self.wave.step(), self.wave.origin);
        let [s, g] = pen.plane.shown;
        let corners = [[s[0], g[0]], [s[1], g[0]], [s[0], g[1]], [s[1], g[1]]].map(|at| self.phase(at));
        let (low, high) =
            corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        if !(low.is_finite() && high.is_finite()) {
            return;
        }
        let (first, last) = (low.floor() as i64, high.ceil() as i64);
        for k in (first..=last).take(MAX_BANDS) {
            let peak = k as f64 + 0.5;
            // The line phase = peak, from where it meets two sides of what is shown.
            let ends = if step[0].abs() * (s[1] - s[0]) >= step[1].abs() * (g[1] - g[0]) {
                g.map(|g| [origin[0] + (peak - step[1] * (g - origin[1])) / step[0], g])
            } else {
                s.map(|s| [s, origin[1] + (peak - step[0] * (s - origin[0])) / step[1]])
            };
            let stroke = Stroke::new(pen.stroke.width * 0.7, pen.stroke.color);
            pen.painter.line_segment(ends.map(|at| pen.plane.to_window(at)), stroke);
        }
    }
}
