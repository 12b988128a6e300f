//! Widgets as they lie in the plane, drawn and dragged there.

use super::geometry::{Change, Handle, Scale, array, number};
use super::kinds::{natural_axes, shape};
use super::plane::{Plane, WidgetPainter, color, middle};
use super::region::Region;
use super::relative;
use super::shape::{PlaneContext, Shape};
use crate::theme;
use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, Ui, vec2};
use std::sync::Arc;
use voltet_core::parameters::Parameters;
use voltet_core::probing::Histogram;
use voltet_core::transfer::{self, ColorSource, WIDGET_KINDS, Widget};
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Field, LocatedValue, SourceSpan, find_setting};

/// A widget in the plane.
#[derive(Debug, Clone)]
pub(super) struct ScreenWidget {
    /// Its kind's name.
    pub kind: String,
    /// The widget, with placeholders for unknown numbers; `None` if it is invalid.
    widget: Option<Widget>,
    /// `None` where it lies along other axes, or is not known.
    pub shape: Option<Arc<dyn Shape>>,
    pub region: Region,
    /// Linear RGB.
    pub color: [f64; 3],
    pub extinction: f64,
    /// Its table as the file states it.
    pub stated: Vec<Field>,
    /// Error, or the reason for which it is not known yet.
    pub fault: Option<String>,
}

impl ScreenWidget {
    /// From what the file states, with numbers relative to data found by what is known of these.
    pub fn new(fields: &[Field], on: &PlaneContext) -> ScreenWidget {
        let read = || -> Result<(Widget, Vec<Field>)> {
            let numbers = relative::resolved(fields, on.known)?;
            let (kind, parameters) = keys(&numbers)?;
            Ok((transfer::read(kind, &parameters, &|path| Ok(on.images.texels(path)))?, numbers))
        };
        let is_flat = on.is_of_s_and_g();
        let mut drawn = ScreenWidget {
            kind: find_setting(fields, "kind").and_then(LocatedValue::text).unwrap_or_default().to_string(),
            widget: None,
            shape: None,
            region: Region::Whole,
            color: array(fields, "color").unwrap_or([1.0; 3]),
            extinction: number(fields, "extinction").unwrap_or(0.0),
            stated: fields.to_vec(),
            fault: None,
        };
        match read() {
            Ok((widget, numbers)) => {
                drawn.color = main_color(&widget);
                drawn.shape = shape(&widget, &numbers, on);
                drawn.region = if is_flat { Region::parse(&numbers) } else { Region::Whole };
                // Of other axes its region says nothing.
                let region = widget.region.clone().filter(|_| is_flat);
                drawn.widget = Some(Widget { region, ..widget });
                let image = find_setting(fields, "image").and_then(LocatedValue::text);
                drawn.fault = image.and_then(|path| on.images.fault(path));
            }
            Err(error) => {
                drawn.widget = with_placeholders(fields);
                drawn.fault = Some(error.to_string());
            }
        }
        drawn
    }

    /// Its largest extinction, where it is a curve of these.
    pub fn peak_of_curve(&self) -> Option<f64> {
        self.widget.as_ref()?.profile.properties().own_peak
    }

    /// True if it can be dragged wherever it is strong, unlike widgets drawn as lines alone.
    pub fn is_area(&self) -> bool {
        let is_line = self.widget.as_ref().is_some_and(|widget| {
            let properties = widget.profile.properties();
            properties.own_peak.is_some() || properties.bands.is_some()
        });
        !is_line || self.region != Region::Whole
    }

    /// True if it is strong in all of its region.
    pub fn is_its_region(&self) -> bool {
        self.widget.as_ref().is_some_and(|widget| widget.profile.properties().needs_region)
    }

    /// The axes on which it is seen.
    pub fn natural_axes(&self) -> Option<[ArrayRef; 2]> {
        self.widget.as_ref().map(natural_axes)
    }

    /// Its strength at a place, 0 to 1 of its peak; what it holds is where that is half or more.
    pub fn strength(&self, at: [f64; 2]) -> f64 {
        match (&self.widget, &self.shape) {
            (Some(widget), Some(shape)) => widget.weight_at(at, &shape.fields(at)),
            _ => 0.0,
        }
    }

    /// The share of the volume where it is at half of its peak or more; `None` where it does not lie in the plane.
    pub fn held(&self, histogram: &Histogram) -> Option<f64> {
        if !self.shape.as_ref()?.is_in_plane() {
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

    /// The handles, each with its place.
    pub fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let mut handles = self.shape.as_ref().map_or(Vec::new(), |shape| shape.handles(scale));
        handles.extend(self.region.handles(scale));
        handles
    }

    /// Changes of the numbers when a handle moves to a position.
    pub fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        let of_shape = || self.shape.as_ref().map_or(Vec::new(), |shape| shape.moved(handle, to, scale));
        self.region.moved(handle, to).unwrap_or_else(of_shape)
    }

    /// Changes of the numbers when the whole widget is moved.
    pub fn shifted(&self, by: [f64; 2], scale: &Scale) -> Vec<Change> {
        let mut changes = self.shape.as_ref().map_or(Vec::new(), |shape| shape.shifted(by, scale));
        changes.extend(self.region.shifted(by));
        changes
    }

    /// True if points can be added.
    pub fn has_points(&self) -> bool {
        self.shape.as_ref().is_some_and(|shape| shape.has_points())
            || matches!(self.region, Region::Polygon(_))
    }

    /// With a point more at a place, and which one that is.
    pub fn with_point(&self, at: [f64; 2], scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        match self.shape.as_ref().filter(|shape| shape.has_points()) {
            Some(shape) => shape.with_point(at, scale),
            None => self.region.with_point(at, scale),
        }
    }

    /// Without the point of a handle; `None` where it is none, or is needed.
    pub fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        let of_shape = self.shape.as_ref().and_then(|shape| shape.without_point(handle));
        of_shape.or_else(|| self.region.without_point(handle))
    }
}

/// The arrays that a widget's table names.
pub(super) fn arrays(fields: &[Field]) -> Vec<String> {
    let widget = with_placeholders(fields);
    let names = widget.as_ref().map_or(Vec::new(), |widget| widget.profile.properties().fields);
    names.into_iter().map(str::to_string).collect()
}

/// The widget's kind and keys.
fn keys(fields: &[Field]) -> Result<(&'static str, Parameters)> {
    let kind = find_setting(fields, "kind").and_then(LocatedValue::text).unwrap_or_default();
    let known = WIDGET_KINDS.iter().find(|known| known.name == kind);
    let known = known.ok_or_else(|| Error::usage("unknown kind of widget").got(kind))?;
    Ok((known.name, Parameters::check(known.parameters, fields, &SourceSpan::Nowhere, &["kind"])?))
}

/// A widget that looks at the same quantities, whatever its numbers are; `None` where what is stated makes none.
fn with_placeholders(fields: &[Field]) -> Option<Widget> {
    let (kind, parameters) = keys(fields).ok()?;
    let parameters = transfer::with_placeholders(&parameters).ok()?;
    transfer::read(kind, &parameters, &|_| Ok((1, 1, vec![[0.0; 4]]))).ok()
}

/// The colour that it is known by: of several the strongest, of a picture the mean.
fn main_color(widget: &Widget) -> [f64; 3] {
    match widget.profile.properties().color {
        ColorSource::Widget => widget.color,
        ColorSource::Points(points) => {
            let strongest = points.iter().max_by(|a, b| a.extinction.total_cmp(&b.extinction));
            strongest.map_or([1.0; 3], |point| point.color)
        }
        ColorSource::Texels(texels) => {
            let sum = |k: usize| texels.iter().map(|t| f64::from(t[k]) * f64::from(t[3])).sum::<f64>();
            let alpha: f64 = texels.iter().map(|t| f64::from(t[3])).sum();
            [0, 1, 2].map(|k| if alpha > 0.0 { sum(k) / alpha } else { 1.0 })
        }
    }
}

/// A drag: the widget as it was, what is held, and where that was and is.
pub(super) struct Drag {
    pub widget: ScreenWidget,
    pub handle: Option<Handle>,
    pub from: [f64; 2],
    pub at: [f64; 2],
    /// The extinction at the top of the plot stands still meanwhile.
    pub peak: f64,
}

/// `handles`: of the widget in hand, with the one that was taken last.
pub(super) fn draw(
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

fn grip(painter: &Painter, at: Pos2, handle: Handle, is_held: bool, base: Color32, dark: bool) {
    let edge = match (is_held, dark) {
        (true, _) => Stroke::new(2.0, theme::accent(dark)),
        (false, true) => Stroke::new(1.5, Color32::WHITE),
        (false, false) => Stroke::new(1.5, Color32::BLACK),
    };
    let square = |width: f32, height: f32| Rect::from_center_size(at, vec2(width, height));
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

#[cfg(test)]
#[path = "screen_widget_tests.rs"]
mod tests;
