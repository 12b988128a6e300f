//! Widgets drawn in the plane.

use super::form::Drawn;
use super::handles::Handle;
use super::plane::Plane;
use super::scale::{Scale, height_of};
use super::shape::{Form, Region};
use crate::theme;
use crate::worker::Probed;
use eframe::egui::{Color32, Painter, Pos2, Rect, Rgba, Shape, Stroke, Ui};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Points of an ellipse.
const ROUND: u32 = 72;

/// So many probed values are told apart.
const FEW: usize = 300;

/// A dot of a cloud of values, points.
const DOT: f32 = 2.0;

/// Bands that are drawn at most.
const BANDS: i64 = 200;

/// The colour on the screen; what is brighter than it is clamped.
pub(super) fn color(linear: [f64; 3]) -> Color32 {
    let [r, g, b] = linear.map(|x| x.clamp(0.0, 1.0) as f32);
    Color32::from(Rgba::from_rgb(r, g, b))
}

/// `handles`: of the widget in hand, with the one that was taken last.
pub(super) fn widget(
    ui: &Ui,
    plane: Plane,
    widget: &Drawn,
    scale: &Scale,
    handles: Option<Option<Handle>>,
    is_hidden: bool,
) {
    let painter = ui.painter().with_clip_rect(plane.rect.expand(1.0));
    let (dark, is_chosen, peak) = (ui.visuals().dark_mode, handles.is_some(), scale.peak);
    let base = color(widget.color);
    let base = if is_hidden { base.gamma_multiply(0.35) } else { base };
    let stroke = Stroke::new(if is_chosen { 2.2 } else { 1.4 }, base);
    let top = plane.shown[1][1];
    match &widget.form {
        Form::Gaussian { centre, axes } => ellipses(&painter, plane, *centre, axes, stroke, is_chosen),
        Form::Triangular { centre, sigma } => {
            let foot = plane.to_window([*centre, 0.0]);
            let end = |side: f64| plane.to_window([centre + side * sigma * top, top]);
            let fill = base.gamma_multiply(0.15);
            painter.add(Shape::convex_polygon(vec![foot, end(-1.0), end(1.0)], fill, stroke));
        }
        Form::Wave { origin, angle, scale, period, .. } => {
            bands(&painter, plane, *origin, angle.to_radians(), *scale, *period, stroke);
        }
        Form::Points(points) => curve(&painter, plane, points, peak, dark, is_chosen),
        Form::Table { s, g } => rectangle(&painter, plane, [*s, *g], stroke, base.gamma_multiply(0.1)),
        Form::Uniform | Form::Elsewhere => {}
    }
    match &widget.region {
        Region::Whole => {}
        Region::Box(limits) => {
            let fill = if matches!(widget.form, Form::Uniform) {
                base.gamma_multiply(0.15)
            } else {
                Color32::TRANSPARENT
            };
            let thin = Stroke::new(stroke.width * 0.6, base);
            rectangle(&painter, plane, *limits, thin, fill);
        }
        Region::Polygon(corners) => {
            let points: Vec<Pos2> = corners.iter().map(|at| plane.to_window(*at)).collect();
            painter.add(Shape::closed_line(points, Stroke::new(stroke.width * 0.6, base)));
        }
    }
    if let Some(held) = handles {
        for (handle, at) in widget.handles(scale) {
            grip(&painter, plane.to_window(at), handle, held == Some(handle), base, dark);
        }
    }
}

/// Values that a probe found: few as circles, the larger the more of it they are; many as a cloud.
pub(super) fn probed(ui: &Ui, plane: Plane, probed: &Probed) {
    let painter = ui.painter().with_clip_rect(plane.rect);
    let color = theme::accent(ui.visuals().dark_mode);
    let most = probed.values.iter().map(|(_, share)| *share).fold(1e-12, f64::max);
    if probed.values.len() <= FEW {
        for (value, share) in probed.values.iter().filter(|(_, share)| *share > 1e-3 * most) {
            let radius = 1.5 + 3.0 * (share / most).sqrt() as f32;
            painter.circle_stroke(plane.to_window(*value), radius, Stroke::new(1.2, color));
        }
        return;
    }
    let mut cloud: BTreeMap<(i32, i32), f64> = BTreeMap::new();
    for (value, share) in &probed.values {
        let at = plane.to_window(*value) / DOT;
        *cloud.entry((at.x as i32, at.y as i32)).or_default() += share;
    }
    let densest = cloud.values().copied().fold(1e-12, f64::max);
    for ((x, y), share) in cloud {
        let at = Pos2::new(x as f32, y as f32) * DOT;
        let dot = Rect::from_min_size(at, eframe::egui::Vec2::splat(DOT));
        painter.rect_filled(dot, 0.0, color.gamma_multiply(0.25 + 0.75 * (share / densest).sqrt() as f32));
    }
}

/// At one and at two standard deviations.
fn ellipses(
    painter: &Painter,
    plane: Plane,
    centre: [f64; 2],
    axes: &[[f64; 2]; 2],
    stroke: Stroke,
    is_chosen: bool,
) {
    let infinite = axes.iter().position(|axis| axis.iter().any(|x| !x.is_finite()));
    for times in [1.0, 2.0] {
        let thin = Stroke::new(stroke.width / times as f32, stroke.color);
        let fill = if times == 1.0 {
            stroke.color.gamma_multiply(if is_chosen { 0.12 } else { 0.05 })
        } else {
            Color32::TRANSPARENT
        };
        match infinite {
            None => {
                let at = |t: f64| {
                    let (sin, cos) = t.sin_cos();
                    let along = |k: usize| centre[k] + times * (cos * axes[0][k] + sin * axes[1][k]);
                    plane.to_window([along(0), along(1)])
                };
                let points = (0..ROUND).map(|i| at(TAU * f64::from(i) / f64::from(ROUND))).collect();
                painter.add(Shape::convex_polygon(points, fill, thin));
            }
            // A band along the axis that is ignored.
            Some(ignored) => {
                let kept = 1 - ignored;
                let width = times * axes[kept][kept];
                let mut limits = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
                if width.is_finite() {
                    limits[kept] = [centre[kept] - width, centre[kept] + width];
                }
                rectangle(painter, plane, limits, thin, fill);
            }
        }
    }
    if infinite.is_none() {
        let [a, b] = [centre, [centre[0] + 1.7 * axes[0][0], centre[1] + 1.7 * axes[0][1]]]
            .map(|at| plane.to_window(at));
        if is_chosen {
            painter.line_segment([a, b], Stroke::new(1.0, stroke.color.gamma_multiply(0.6)));
        }
    }
}

/// The ranges, as far as they are shown.
fn rectangle(painter: &Painter, plane: Plane, [s, g]: [[f64; 2]; 2], stroke: Stroke, fill: Color32) {
    let within = |axis: usize, [low, high]: [f64; 2]| {
        let [a, b] = plane.shown[axis];
        let over = b - a;
        [low.max(a - over), high.min(b + over)]
    };
    let ([s0, s1], [g0, g1]) = (within(0, s), within(1, g));
    let rect = Rect::from_two_pos(plane.to_window([s0, g0]), plane.to_window([s1, g1]));
    painter.rect(rect, 0.0, fill, stroke);
}

/// The peaks of the bands as lines across the plane.
fn bands(
    painter: &Painter,
    plane: Plane,
    origin: [f64; 2],
    angle: f64,
    scale: [f64; 2],
    period: f64,
    stroke: Stroke,
) {
    let (sin, cos) = angle.sin_cos();
    let across = [cos * scale[0], sin * scale[1]];
    let phase = |at: [f64; 2]| (across[0] * (at[0] - origin[0]) + across[1] * (at[1] - origin[1])) / period;
    let [s, g] = plane.shown;
    let corners = [[s[0], g[0]], [s[1], g[0]], [s[0], g[1]], [s[1], g[1]]].map(phase);
    let (low, high) =
        corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    if !(low.is_finite() && high.is_finite()) {
        return;
    }
    let (first, last) = (low.floor() as i64, high.ceil() as i64);
    for k in (first..=last).take(BANDS as usize) {
        let peak = k as f64 + 0.5;
        // The line phase = peak, from where it meets two sides of what is shown.
        let ends = if across[0].abs() * (s[1] - s[0]) >= across[1].abs() * (g[1] - g[0]) {
            [g[0], g[1]].map(|g| [origin[0] + (peak * period - across[1] * (g - origin[1])) / across[0], g])
        } else {
            [s[0], s[1]].map(|s| [s, origin[1] + (peak * period - across[0] * (s - origin[0])) / across[1]])
        };
        painter
            .line_segment(ends.map(|at| plane.to_window(at)), Stroke::new(stroke.width * 0.7, stroke.color));
    }
}

/// Extinction over s, each stretch in its colours; its height is the cube root.
fn curve(painter: &Painter, plane: Plane, points: &[[f64; 5]], peak: f64, dark: bool, is_chosen: bool) {
    let top = plane.shown[1][1];
    let at = |s: f64, extinction: f64| plane.to_window([s, height_of(extinction, peak) * top]);
    let width = if is_chosen { 2.5 } else { 1.6 };
    let line = |a: [f64; 5], b: [f64; 5]| {
        // Straight in extinction is no straight line here.
        let steps = 16;
        let along = |i: u32| {
            let t = f64::from(i) / f64::from(steps);
            at(a[0] + t * (b[0] - a[0]), a[4] + t * (b[4] - a[4]))
        };
        for i in 0..steps {
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let mixed = [1, 2, 3].map(|k| a[k] + t * (b[k] - a[k]));
            let mut shade = color(mixed);
            if dark && shade.r().max(shade.g()).max(shade.b()) < 60 {
                shade = theme::weak(dark);
            }
            painter.line_segment([along(i), along(i + 1)], Stroke::new(width, shade));
        }
    };
    for pair in points.windows(2) {
        line(pair[0], pair[1]);
    }
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        let [low, high] = plane.shown[0];
        line([low.min(first[0]), first[1], first[2], first[3], first[4]], *first);
        line(*last, [high.max(last[0]), last[1], last[2], last[3], last[4]]);
    }
}

fn grip(painter: &Painter, at: Pos2, handle: Handle, is_held: bool, base: Color32, dark: bool) {
    let edge = match (is_held, dark) {
        (true, _) => Stroke::new(2.0, theme::accent(dark)),
        (false, true) => Stroke::new(1.5, Color32::WHITE),
        (false, false) => Stroke::new(1.5, Color32::BLACK),
    };
    let square = |width: f32, height: f32| Rect::from_center_size(at, eframe::egui::vec2(width, height));
    match handle {
        Handle::Centre => {
            painter.circle(at, 5.0, base, edge);
        }
        Handle::Angle | Handle::Band => {
            painter.circle(at, 4.0, Color32::TRANSPARENT, edge);
        }
        Handle::Width(_) | Handle::Corner(_) | Handle::Point(_) => {
            painter.rect(square(8.0, 8.0), 1.0, base, edge);
        }
        Handle::Side(0, _) => {
            painter.rect(square(5.0, 12.0), 1.0, base, edge);
        }
        Handle::Side(..) => {
            painter.rect(square(12.0, 5.0), 1.0, base, edge);
        }
    }
}
