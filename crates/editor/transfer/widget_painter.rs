//! Drawing of widgets.

use super::plane::Plane;
use super::scale::Scale;
use eframe::egui::{Color32, Painter, Rect, Rgba, Stroke};

/// The colour on the screen; what is brighter than it is clamped.
pub(super) fn color(linear: [f64; 3]) -> Color32 {
    let [r, g, b] = linear.map(|x| x.clamp(0.0, 1.0) as f32);
    Color32::from(Rgba::from_rgb(r, g, b))
}

/// Painter of a widget.
pub(super) struct WidgetPainter<'a> {
    pub painter: Painter,
    pub plane: Plane,
    pub scale: &'a Scale,
    pub stroke: Stroke,
    pub is_chosen: bool,
    pub is_hidden: bool,
    pub dark: bool,
}

impl WidgetPainter<'_> {
    /// Ranges, as far as they are shown.
    pub fn rectangle(&self, [s, g]: [[f64; 2]; 2], stroke: Stroke, fill: Color32) {
        let within = |axis: usize, [low, high]: [f64; 2]| {
            let [a, b] = self.plane.shown[axis];
            let over = b - a;
            [low.max(a - over), high.min(b + over)]
        };
        let ([s0, s1], [g0, g1]) = (within(0, s), within(1, g));
        let rect = Rect::from_two_pos(self.plane.to_window([s0, g0]), self.plane.to_window([s1, g1]));
        self.painter.rect(rect, 0.0, fill, stroke);
    }
}
