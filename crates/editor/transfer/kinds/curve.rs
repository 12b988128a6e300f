//! Piecewise-linear curves over s; their height is the cube root of the extinction.

use super::super::geometry::{Change, Handle, Scale, extinction_at, height_of, rows};
use super::super::plane::{WidgetPainter, color};
use super::super::shape::Shape;
use crate::theme;
use eframe::egui::Stroke;
use voltet_core::transfer::ControlPoint;

/// Pieces that a stretch is drawn in: straight in extinction is no straight line here.
const PIECES: u32 = 16;

#[derive(Debug)]
pub(super) struct Curve {
    pub points: Vec<ControlPoint>,
}

/// The points as a file states them.
fn stated(points: &[ControlPoint]) -> Vec<Change> {
    let row = |p: &ControlPoint| [p.s, p.color[0], p.color[1], p.color[2], p.extinction];
    vec![("points", Some(rows(&points.iter().map(row).collect::<Vec<_>>())))]
}

impl Shape for Curve {
    fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let place = |p: &ControlPoint| [p.s, height_of(p.extinction, scale.peak) * scale.top()];
        self.points.iter().enumerate().map(|(i, p)| (Handle::Point(i), place(p))).collect()
    }

    fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        let Handle::Point(i) = handle else { return Vec::new() };
        let mut points = self.points.clone();
        let low = i.checked_sub(1).and_then(|i| points.get(i)).map_or(f64::NEG_INFINITY, |p| p.s);
        let high = points.get(i + 1).map_or(f64::INFINITY, |p| p.s);
        if let Some(point) = points.get_mut(i) {
            let gap = 1e-6 * scale.extent[0];
            point.s = to[0].clamp(low + gap, (high - gap).max(low + gap));
            point.extinction = extinction_at(to[1] / scale.top(), scale.peak);
        }
        stated(&points)
    }

    fn shifted(&self, by: [f64; 2], _: &Scale) -> Vec<Change> {
        stated(&self.points.iter().map(|p| ControlPoint { s: p.s + by[0], ..*p }).collect::<Vec<_>>())
    }

    /// Each stretch in its colours, level beyond the ends.
    fn draw(&self, pen: &WidgetPainter) {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return };
        let [low, high] = pen.plane.shown[0];
        let ends =
            [ControlPoint { s: low.min(first.s), ..*first }, ControlPoint { s: high.max(last.s), ..*last }];
        let all: Vec<ControlPoint> =
            [ends[0]].into_iter().chain(self.points.clone()).chain([ends[1]]).collect();
        let at = |s: f64, extinction: f64| {
            pen.plane.to_window([s, height_of(extinction, pen.scale.peak) * pen.scale.top()])
        };
        let width = if pen.is_chosen { 2.5 } else { 1.6 };
        for pair in all.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let along = |i: u32| {
                let t = f64::from(i) / f64::from(PIECES);
                at(a.s + t * (b.s - a.s), a.extinction + t * (b.extinction - a.extinction))
            };
            for i in 0..PIECES {
                let t = (f64::from(i) + 0.5) / f64::from(PIECES);
                let mixed = [0, 1, 2].map(|k: usize| a.color[k] + t * (b.color[k] - a.color[k]));
                let shade = theme::readable(color(mixed), pen.dark);
                pen.painter.line_segment([along(i), along(i + 1)], Stroke::new(width, shade));
            }
        }
    }

    fn has_points(&self) -> bool {
        true
    }

    /// In the colour that it has there.
    fn with_point(&self, at: [f64; 2], scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        if self.points.iter().any(|point| (point.s - at[0]).abs() <= 1e-6 * scale.extent[0]) {
            return None;
        }
        let place = self.points.partition_point(|point| point.s < at[0]);
        let here = ControlPoint::between(&self.points, at[0])?;
        let extinction = extinction_at(at[1] / scale.top(), scale.peak);
        let mut points = self.points.clone();
        points.insert(place, ControlPoint { extinction, ..here });
        Some((stated(&points), Handle::Point(place)))
    }

    fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        let Handle::Point(i) = handle else { return None };
        if self.points.len() < 2 || i >= self.points.len() {
            return None;
        }
        let mut points = self.points.clone();
        points.remove(i);
        Some(stated(&points))
    }
}
