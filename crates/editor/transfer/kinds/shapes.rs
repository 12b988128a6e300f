//! Shapes of widgets in the plane: what is drawn, what a hand takes hold of, and what a drag makes of the numbers; and the simple ones.

use crate::picture::WHOLE;
use crate::theme;
use crate::transfer::images::Images;
use crate::transfer::plane::{
    Change, Handle, Plane, S_AND_G, WidgetPainter, changed_ranges, extinction_at, height_of, list,
    range_handles, rounded, rows, shifted, stretched,
};
use crate::worker::DataScales;
use eframe::egui::{self, Color32, Rect, Stroke, TextureId};
use std::fmt::Debug;
use voltet_core::transfer::{AxisScale, ControlPoint, Table, Wave};
use voltet_graph::{ArrayRef, Field, LocatedValue, find_setting};

/// A widget in the plane, but for its region. Places are values along the plane's axes.
pub(in crate::transfer) trait Shape: Debug {
    fn handles(&self, _plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        Vec::new()
    }

    /// Changes of the numbers when a handle moves to a position.
    fn moved(&self, _handle: Handle, _to: [f64; 2], _plane: &Plane) -> Vec<Change> {
        Vec::new()
    }

    /// Changes of the numbers when the whole shape is moved: by its centre.
    fn shifted(&self, by: [f64; 2], plane: &Plane) -> Vec<Change> {
        let centre = self.handles(plane).into_iter().find(|(handle, _)| *handle == Handle::Centre);
        centre.map_or(Vec::new(), |(handle, at)| self.moved(handle, plane.moved_place(at, by), plane))
    }

    fn draw(&self, _pen: &WidgetPainter) {}

    /// True if it has points, to which others can be added.
    fn has_points(&self) -> bool {
        false
    }

    /// With a point more at a place, and which one that is.
    fn with_point(&self, _at: [f64; 2], _plane: &Plane) -> Option<(Vec<Change>, Handle)> {
        None
    }

    /// Without the point of a handle; `None` where it is none, or is needed.
    fn without_point(&self, _handle: Handle) -> Option<Vec<Change>> {
        None
    }

    /// The values of its further fields at a place, in the order of its properties.
    fn fields(&self, _at: [f64; 2]) -> Vec<f64> {
        Vec::new()
    }

    /// True if the plane shows all of it: no field lies outside, and the widths do not depend on such a field.
    fn is_in_plane(&self) -> bool {
        true
    }

    /// The magnitude that it is drawn at, where it depends on one that is no axis.
    fn level(&self) -> Option<f64> {
        None
    }
}

pub(in crate::transfer) struct PlaneContext<'a> {
    pub axes: &'a [ArrayRef; 2],
    /// Scales of s and g.
    pub scales: [AxisScale; 2],
    /// Lengths along both axes that are equal on the screen, for angles.
    pub extent: [f64; 2],
    pub known: Option<&'a DataScales>,
    pub images: &'a Images,
}

impl PlaneContext<'_> {
    pub fn is_of_s_and_g(&self) -> bool {
        *self.axes == S_AND_G
    }
}

/// Its s, and its width in s a unit of g; or a field and the magnitude of its gradients.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Triangle {
    pub centre: f64,
    pub sigma: f64,
}

impl Triangle {
    /// The width when its handle is brought to a place.
    pub fn widened(&self, to: [f64; 2], plane: &Plane) -> f64 {
        let g = to[1].max(0.02 * plane.top());
        ((to[0] - self.centre) / g).abs().max(1e-9 * plane.extent[0] / plane.extent[1])
    }
}

impl Shape for Triangle {
    fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let high = 0.8 * plane.top();
        vec![
            (Handle::Centre, [self.centre, 0.0]),
            (Handle::Width(0), [self.centre + self.sigma * high, high]),
        ]
    }

    fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        match handle {
            Handle::Width(_) => vec![("sigma", Some(rounded(self.widened(to, plane)).into()))],
            _ => vec![("centre", Some(to[0].into()))],
        }
    }

    fn draw(&self, pen: &WidgetPainter) {
        let top = pen.plane.top();
        let foot = pen.plane.to_window([self.centre, 0.0]);
        let end = |side: f64| pen.plane.to_window([self.centre + side * self.sigma * top, top]);
        let fill = pen.stroke.color.gamma_multiply(0.15);
        let corners = vec![foot, end(-1.0), end(1.0)];
        pen.painter.add(egui::Shape::convex_polygon(corners, fill, pen.stroke));
    }
}

/// The band's handle lies beside the wave's line by so much of the axes.
const HANDLE_OFFSET: f64 = 0.07;

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
    fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let Wave { origin, angle, scale: factors, period, .. } = self.wave;
        let (sin, cos) = angle.sin_cos();
        let along = [cos * period / factors[0], sin * period / factors[1]];
        let (end, beside) = (0.5 + self.wave.half_band(self.sine), [-sin, cos]);
        let place = |k: usize| origin[k] + end * along[k] + HANDLE_OFFSET * beside[k] * plane.extent[k];
        vec![
            (Handle::Centre, origin),
            (Handle::Width(0), [origin[0] + along[0], origin[1] + along[1]]),
            (Handle::Band, [place(0), place(1)]),
        ]
    }

    fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        let Wave { origin, scale: factors, .. } = self.wave;
        match handle {
            Handle::Width(_) => {
                let v = [(to[0] - origin[0]) * factors[0], (to[1] - origin[1]) * factors[1]];
                let period = v[0].hypot(v[1]).max(1e-6 * plane.extent[0] * factors[0].abs());
                let angle = v[1].atan2(v[0]).to_degrees();
                let angle = if angle.abs() < 2.0 { 0.0 } else { angle };
                vec![("period", Some(rounded(period).into())), ("angle", Some(rounded(angle).into()))]
            }
            Handle::Band => {
                let half = (self.phase(to) - 0.5).clamp(0.005, 0.5);
                let width = Wave::band_width_of(half, self.sine);
                vec![("band_width", Some(rounded(width.min(1.0)).into()))]
            }
            _ => vec![("origin", Some(list(&to)))],
        }
    }

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

/// The least length of a side, as a share of what is shown: a range that is empty is refused.
const MIN_SIDE: f64 = 1e-3;

/// Opacity of the picture over the histogram.
const COVERS: f32 = 0.85;

#[derive(Debug)]
pub(super) struct Picture {
    ranges: [[f64; 2]; 2],
    texture: Option<TextureId>,
}

impl Picture {
    pub fn new(table: &Table, numbers: &[Field], on: &PlaneContext) -> Picture {
        let path = find_setting(numbers, "image").and_then(LocatedValue::text);
        Picture {
            ranges: [table.s, table.g],
            texture: path.and_then(|path| Some(on.images.get(path)?.ok()?.texture.id())),
        }
    }

    fn middle(&self) -> [f64; 2] {
        self.ranges.map(|[low, high]| 0.5 * low + 0.5 * high)
    }
}

impl Shape for Picture {
    fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let sides = range_handles(self.ranges, plane, Handle::Rim, Handle::Edge);
        std::iter::once((Handle::Centre, self.middle())).chain(sides).collect()
    }

    fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        let middle = self.middle();
        let moved = || shifted(self.ranges, [to[0] - middle[0], to[1] - middle[1]], plane);
        let least = |k: usize| MIN_SIDE * (plane.shown[k][1] - plane.shown[k][0]);
        let after = match stretched(self.ranges, handle, to) {
            Some(after) if (0..2).any(|k| after[k][1] - after[k][0] < least(k)) => return Vec::new(),
            after => after.unwrap_or_else(moved),
        };
        changed_ranges(["s", "g"], self.ranges, after)
    }

    fn draw(&self, pen: &WidgetPainter) {
        let [s, g] = self.ranges;
        if let Some(texture) = self.texture {
            let place =
                Rect::from_two_pos(pen.plane.to_window([s[0], g[0]]), pen.plane.to_window([s[1], g[1]]));
            let tint = Color32::WHITE.gamma_multiply(if pen.is_hidden { 0.3 * COVERS } else { COVERS });
            pen.painter.image(texture, place, WHOLE, tint);
        }
        pen.rectangle(self.ranges, pen.stroke, Color32::TRANSPARENT);
    }
}

/// Pieces that a stretch is drawn in: straight in extinction is no straight line here.
const PIECES: u32 = 16;

#[derive(Debug)]
pub(super) struct Curve {
    pub points: Vec<ControlPoint>,
    /// True if the points are the widget's own and can be moved; false of a colour map, which makes them.
    pub is_stated: bool,
}

fn changed_points(points: &[ControlPoint]) -> Vec<Change> {
    let row = |p: &ControlPoint| [p.s, p.color[0], p.color[1], p.color[2], p.extinction];
    vec![("points", Some(rows(&points.iter().map(row).collect::<Vec<_>>())))]
}

impl Shape for Curve {
    fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let place = |p: &ControlPoint| [p.s, height_of(p.extinction, plane.peak) * plane.top()];
        self.points
            .iter()
            .filter(|_| self.is_stated)
            .enumerate()
            .map(|(i, p)| (Handle::Point(i), place(p)))
            .collect()
    }

    fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        let Handle::Point(i) = handle else { return Vec::new() };
        let mut points = self.points.clone();
        let low = i.checked_sub(1).and_then(|i| points.get(i)).map_or(f64::NEG_INFINITY, |p| p.s);
        let high = points.get(i + 1).map_or(f64::INFINITY, |p| p.s);
        if let Some(point) = points.get_mut(i) {
            let gap = 1e-6 * plane.extent[0];
            point.s = to[0].clamp(low + gap, (high - gap).max(low + gap));
            point.extinction = extinction_at(to[1] / plane.top(), plane.peak);
        }
        changed_points(&points)
    }

    fn shifted(&self, by: [f64; 2], plane: &Plane) -> Vec<Change> {
        if !self.is_stated {
            return Vec::new();
        }
        let moved = |p: &ControlPoint| ControlPoint { s: plane.moved(0, p.s, by[0]), ..*p };
        changed_points(&self.points.iter().map(moved).collect::<Vec<_>>())
    }

    fn draw(&self, pen: &WidgetPainter) {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return };
        let [low, high] = pen.plane.shown[0];
        let ends =
            [ControlPoint { s: low.min(first.s), ..*first }, ControlPoint { s: high.max(last.s), ..*last }];
        let all: Vec<ControlPoint> =
            [ends[0]].into_iter().chain(self.points.clone()).chain([ends[1]]).collect();
        let at = |s: f64, extinction: f64| {
            pen.plane.to_window([s, height_of(extinction, pen.plane.peak) * pen.plane.top()])
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
                let shade = theme::readable(theme::on_screen(mixed), pen.dark);
                pen.painter.line_segment([along(i), along(i + 1)], Stroke::new(width, shade));
            }
        }
    }

    fn has_points(&self) -> bool {
        self.is_stated
    }

    /// In the colour that it has there.
    fn with_point(&self, at: [f64; 2], plane: &Plane) -> Option<(Vec<Change>, Handle)> {
        if !self.is_stated
            || self.points.iter().any(|point| (point.s - at[0]).abs() <= 1e-6 * plane.extent[0])
        {
            return None;
        }
        let place = self.points.partition_point(|point| point.s < at[0]);
        let here = ControlPoint::between(&self.points, at[0])?;
        let extinction = extinction_at(at[1] / plane.top(), plane.peak);
        let mut points = self.points.clone();
        points.insert(place, ControlPoint { extinction, ..here });
        Some((changed_points(&points), Handle::Point(place)))
    }

    fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        let Handle::Point(i) = handle else { return None };
        if !self.is_stated || self.points.len() < 2 || i >= self.points.len() {
            return None;
        }
        let mut points = self.points.clone();
        points.remove(i);
        Some(changed_points(&points))
    }
}

#[derive(Debug)]
pub(super) struct Everywhere;

impl Shape for Everywhere {}
