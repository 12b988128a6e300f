//! Widgets drawn in the plane.

use super::handles::Handle;
use super::plane::Plane;
use super::scale::Scale;
use super::screen_widget::ScreenWidget;
use super::widget_painter::{WidgetPainter, color};
use crate::theme;
use crate::worker::PixelProbe;
use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, Ui};
use std::collections::BTreeMap;

/// Largest number of probed values that are drawn one by one.
const FEW: usize = 300;

/// A dot of a cloud of values, points.
const DOT: f32 = 2.0;

/// `handles`: of the widget in hand, with the one that was taken last.
pub(super) fn widget(
    ui: &Ui,
    plane: Plane,
    widget: &ScreenWidget,
    scale: &Scale,
    handles: Option<Option<Handle>>,
    is_hidden: bool,
) {
    let (dark, is_chosen) = (ui.visuals().dark_mode, handles.is_some());
    let base = theme::readable(color(widget.color), dark);
    let base = if is_hidden { base.gamma_multiply(0.35) } else { base };
    let stroke = Stroke::new(if is_chosen { 2.2 } else { 1.4 }, base);
    let painter = ui.painter().with_clip_rect(plane.rect.expand(1.0));
    let pen = WidgetPainter { painter, plane, scale, stroke, is_chosen, is_hidden, dark };
    if let Some(shape) = &widget.shape {
        shape.draw(&pen);
    }
    widget.region.draw(&pen, widget.is_its_region());
    if let Some(held) = handles {
        for (handle, at) in widget.handles(scale) {
            grip(&pen.painter, plane.to_window(at), handle, held == Some(handle), base, dark);
        }
    }
}

/// Values that a probe found: few as circles, the larger the more of it they are; many as a cloud.
pub(super) fn probed(ui: &Ui, plane: Plane, probed: &PixelProbe) {
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
        Handle::Width(_) | Handle::Rim(_) | Handle::Corner(_) | Handle::Point(_) => {
            painter.rect(square(8.0, 8.0), 1.0, base, edge);
        }
        Handle::Edge(0, _) | Handle::Side(0, _) => {
            painter.rect(square(5.0, 12.0), 1.0, base, edge);
        }
        Handle::Edge(..) | Handle::Side(..) => {
            painter.rect(square(12.0, 5.0), 1.0, base, edge);
        }
    }
}
