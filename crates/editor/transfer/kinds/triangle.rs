//! Triangular Gaussians: widths in s a unit of g.

use super::super::geometry::{Change, Handle, Scale, rounded};
use super::super::plane::WidgetPainter;
use super::super::shape::Shape;
use eframe::egui;
use voltet_graph::ParameterValue;

/// Its s, and its width in s a unit of g; or a field and the magnitude of its gradients.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangle {
    pub centre: f64,
    pub sigma: f64,
}

impl Triangle {
    /// The width when its handle is brought to a place.
    pub fn widened(&self, to: [f64; 2], scale: &Scale) -> f64 {
        let g = to[1].max(0.02 * scale.top());
        ((to[0] - self.centre) / g).abs().max(1e-9 * scale.extent[0] / scale.extent[1])
    }
}

impl Shape for Triangle {
    fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let high = 0.8 * scale.top();
        vec![
            (Handle::Centre, [self.centre, 0.0]),
            (Handle::Width(0), [self.centre + self.sigma * high, high]),
        ]
    }

    fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        match handle {
            Handle::Width(_) => {
                vec![("sigma", Some(ParameterValue::Number(rounded(self.widened(to, scale)))))]
            }
            _ => vec![("centre", Some(ParameterValue::Number(rounded(to[0]))))],
        }
    }

    fn draw(&self, pen: &WidgetPainter) {
        let top = pen.scale.top();
        let foot = pen.plane.to_window([self.centre, 0.0]);
        let end = |side: f64| pen.plane.to_window([self.centre + side * self.sigma * top, top]);
        let fill = pen.stroke.color.gamma_multiply(0.15);
        let corners = vec![foot, end(-1.0), end(1.0)];
        pen.painter.add(egui::Shape::convex_polygon(corners, fill, pen.stroke));
    }
}
