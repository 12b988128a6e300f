//! Widgets as they lie in the plane, drawn and dragged there; and their regions, outside of which a widget is 0.

use super::kinds::{PlaneContext, Shape, natural_axes, shape};
use super::plane::{
    Change, Handle, Plane, WidgetPainter, array, changed_ranges, middle, number, range_handles, rows,
    shifted, stretched,
};
use super::relative;
use crate::theme;
use crate::worker::Distribution;
use eframe::egui::{self, Color32, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2, vec2};
use std::sync::Arc;
use voltet_core::parameters::Parameters;
use voltet_core::probing::Histogram;
use voltet_core::transfer::{self, AxisScale, ColorSource, UnreadFiles, WIDGET_KINDS, Widget};
use voltet_core::{Error, Result};
use voltet_graph::{ArrayRef, Field, LocatedValue, SourceSpan, find_setting};

#[derive(Debug, Clone)]
pub(super) struct ScreenWidget {
    pub kind: String,
    /// Stated in the file, or its comment.
    pub name: Option<String>,
    /// The widget, with placeholders for unknown numbers; `None` if it is invalid.
    widget: Option<Widget>,
    /// `None` where it lies along other axes, or is not known.
    pub shape: Option<Arc<dyn Shape>>,
    pub region: Region,
    /// Linear RGB.
    pub color: [f64; 3],
    pub extinction: f64,
    pub stated: Vec<Field>,
    /// Error, or the reason for which it is not known yet.
    pub fault: Option<String>,
}

/// Axes of a plane and their scales.
pub(super) type ScaledAxes = ([ArrayRef; 2], [AxisScale; 2]);

/// Share of the volume that a widget holds. It is found anew where the widget, the data or the axes are others: the bins are too many for
/// each frame.
#[derive(Default)]
pub(super) struct HeldVolume(Option<(Option<Widget>, Arc<Distribution>, ScaledAxes, f64)>);

impl HeldVolume {
    /// `axes`: those that the widget is drawn on. `None` where it does not lie in their plane.
    pub fn share(
        &mut self,
        widget: &ScreenWidget,
        data: &Arc<Distribution>,
        axes: &ScaledAxes,
    ) -> Option<f64> {
        widget.shape.as_ref().filter(|shape| shape.is_in_plane())?;
        if let Some((of, known, on, share)) = &self.0
            && (of, on) == (&widget.widget, axes)
            && Arc::ptr_eq(known, data)
        {
            return Some(*share);
        }
        let share = widget.held(&data.histogram);
        self.0 = Some((widget.widget.clone(), data.clone(), axes.clone(), share));
        Some(share)
    }
}

impl ScreenWidget {
    /// From what the file states, with numbers relative to data found by what is known of these.
    pub fn new(fields: &[Field], on: &PlaneContext) -> ScreenWidget {
        let read = || -> Result<(Widget, Vec<Field>)> {
            let numbers = relative::in_plane(fields, on.known, &on.scales)?;
            let (kind, parameters) = keys(&numbers)?;
            Ok((transfer::read(kind, &parameters, on.images)?, numbers))
        };
        let is_flat = on.is_of_s_and_g();
        let mut drawn = ScreenWidget {
            kind: find_setting(fields, "kind").and_then(LocatedValue::text).unwrap_or_default().to_string(),
            name: find_setting(fields, "name").and_then(LocatedValue::text).map(str::to_string),
            widget: None,
            shape: None,
            region: Region::Whole,
            color: find_setting(fields, "color").and_then(LocatedValue::color).unwrap_or([1.0; 3]),
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
                drawn.fault = image.and_then(|path| on.images.get(path)?.err());
            }
            Err(error) => {
                drawn.widget = with_placeholders(fields);
                drawn.fault = Some(error.to_string());
            }
        }
        drawn
    }

    /// Its name, else its kind.
    pub fn title(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.kind)
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

    /// The share of the volume where it is at half of its peak or more; for one that lies in the plane.
    fn held(&self, histogram: &Histogram) -> f64 {
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
        sum / histogram.total
    }

    pub fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        let mut handles = self.shape.as_ref().map_or(Vec::new(), |shape| shape.handles(plane));
        handles.extend(self.region.handles(plane));
        handles
    }

    /// Its handles as they are drawn and taken: a centre, a width or an angle that would lie on one of these stands beside it. Points and
    /// corners lie where they are.
    pub fn grips(&self, plane: &Plane) -> Vec<Grip> {
        let mut spread: Vec<Pos2> = Vec::new();
        let grip = |(handle, at): (Handle, [f64; 2])| {
            let place = plane.to_window(at);
            if !matches!(handle, Handle::Centre | Handle::Width(_) | Handle::Angle) {
                return Grip { handle, at, place };
            }
            let is_free = |place: &Pos2| spread.iter().all(|other| other.distance(*place) >= APART);
            let around = (1..=3u8).flat_map(|ring| (0..8u8).map(move |turn| (ring, turn)));
            let around = around.map(|(ring, turn)| {
                place + APART * f32::from(ring) * Vec2::angled(f32::from(turn) * std::f32::consts::FRAC_PI_4)
            });
            let place = std::iter::once(place).chain(around).find(is_free).unwrap_or(place);
            spread.push(place);
            Grip { handle, at, place }
        };
        self.handles(plane).into_iter().map(grip).collect()
    }

    pub fn moved(&self, handle: Handle, to: [f64; 2], plane: &Plane) -> Vec<Change> {
        let of_shape = || self.shape.as_ref().map_or(Vec::new(), |shape| shape.moved(handle, to, plane));
        self.region.moved(handle, to).unwrap_or_else(of_shape)
    }

    pub fn shifted(&self, by: [f64; 2], plane: &Plane) -> Vec<Change> {
        let mut changes = self.shape.as_ref().map_or(Vec::new(), |shape| shape.shifted(by, plane));
        changes.extend(self.region.shifted(by, plane));
        changes
    }

    pub fn has_points(&self) -> bool {
        self.shape.as_ref().is_some_and(|shape| shape.has_points())
            || matches!(self.region, Region::Polygon(_))
    }

    pub fn with_point(&self, at: [f64; 2], plane: &Plane) -> Option<(Vec<Change>, Handle)> {
        match self.shape.as_ref().filter(|shape| shape.has_points()) {
            Some(shape) => shape.with_point(at, plane),
            None => self.region.with_point(at, plane),
        }
    }

    pub fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        let of_shape = self.shape.as_ref().and_then(|shape| shape.without_point(handle));
        of_shape.or_else(|| self.region.without_point(handle))
    }
}

pub(super) fn arrays(fields: &[Field]) -> Vec<String> {
    let widget = with_placeholders(fields);
    let names = widget.as_ref().map_or(Vec::new(), |widget| widget.profile.properties().fields);
    names.into_iter().map(str::to_string).collect()
}

fn keys(fields: &[Field]) -> Result<(&'static str, Parameters)> {
    let kind = find_setting(fields, "kind").and_then(LocatedValue::text).unwrap_or_default();
    let known = WIDGET_KINDS.iter().find(|known| known.name == kind);
    let known = known.ok_or_else(|| Error::usage("unknown kind of widget").got(kind))?;
    Ok((known.name, Parameters::check(known.parameters, fields, &SourceSpan::Nowhere, &["kind"])?))
}

/// True if a widget's table says that it looks at the gradient magnitude.
pub(super) fn looks_at_g(fields: &[Field]) -> bool {
    with_placeholders(fields).is_some_and(|widget| widget.uses_gradient_magnitude())
}

/// A widget that looks at the same quantities, whatever its numbers are; `None` where what is stated makes none.
fn with_placeholders(fields: &[Field]) -> Option<Widget> {
    let (kind, parameters) = keys(fields).ok()?;
    let parameters = transfer::with_placeholders(&parameters).ok()?;
    transfer::read(kind, &parameters, &UnreadFiles).ok()
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

/// A handle: where it lies in the plane, and where its grip is in the window.
pub(super) struct Grip {
    pub handle: Handle,
    pub at: [f64; 2],
    pub place: Pos2,
}

/// Least distance between the grips of a widget, points.
const APART: f32 = 11.0;

/// A drag: the widget as it was, what is held, and where that was and is.
pub(super) struct Drag {
    pub widget: ScreenWidget,
    pub handle: Option<Handle>,
    /// Place in the window of the grip, or of what was pressed.
    pub grip: Pos2,
    pub from: [f64; 2],
    pub at: [f64; 2],
    /// The extinction at the top of the plot stands still meanwhile.
    pub peak: f64,
}

/// `handles`: of the widget in hand, with the one that was taken last, or that the pointer is at.
pub(super) fn draw(
    ui: &Ui,
    plane: Plane,
    widget: &ScreenWidget,
    handles: Option<(&[Grip], Option<Handle>)>,
    is_hidden: bool,
) {
    let (dark, is_chosen) = (ui.visuals().dark_mode, handles.is_some());
    let base = theme::readable(theme::on_screen(widget.color), dark);
    let base = if is_hidden { base.gamma_multiply(0.35) } else { base };
    let stroke = Stroke::new(if is_chosen { 2.2 } else { 1.4 }, base);
    let painter = ui.painter().with_clip_rect(plane.rect.expand(1.0));
    let pen = WidgetPainter { painter, plane, stroke, is_chosen, is_hidden, dark };
    if let Some(shape) = &widget.shape {
        shape.draw(&pen);
    }
    let is_all = widget.widget.as_ref().is_some_and(|widget| widget.profile.properties().needs_region);
    widget.region.draw(&pen, is_all);
    if let Some((grips, held)) = handles {
        for &Grip { handle, at, place } in grips {
            pen.painter.line_segment([plane.to_window(at), place], Stroke::new(1.0, base));
            grip(&pen.painter, place, handle, held == Some(handle), base, dark);
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
            painter.rect(square(8.0, 8.0), 1.0, base, edge, StrokeKind::Middle);
        }
        Handle::Edge(0, _) | Handle::Side(0, _) => {
            painter.rect(square(5.0, 12.0), 1.0, base, edge, StrokeKind::Middle);
        }
        Handle::Edge(..) | Handle::Side(..) => {
            painter.rect(square(12.0, 5.0), 1.0, base, edge, StrokeKind::Middle);
        }
    }
}

#[cfg(test)]
#[path = "screen_widget_tests.rs"]
mod tests;

/// Support of a widget, as its table states it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Region {
    Whole,
    /// Ranges of s and g; infinite ones are no limit.
    Box([[f64; 2]; 2]),
    Polygon(Vec<[f64; 2]>),
}

const RANGES: [&str; 2] = ["region.s", "region.g"];

impl Region {
    /// Region of a widget's table, without numbers relative to data.
    pub fn parse(fields: &[Field]) -> Region {
        let Some(region) = find_setting(fields, "region").and_then(LocatedValue::table) else {
            return Region::Whole;
        };
        let corners: Option<Vec<[f64; 2]>> = find_setting(region, "polygon")
            .and_then(LocatedValue::list)
            .and_then(|list| list.iter().map(|row| row.numbers()?.try_into().ok()).collect());
        let limits = |name: &str| array(region, name).unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        corners.map_or_else(|| Region::Box([limits("s"), limits("g")]), Region::Polygon)
    }

    pub fn handles(&self, plane: &Plane) -> Vec<(Handle, [f64; 2])> {
        match self {
            Region::Whole => Vec::new(),
            Region::Box(limits) => range_handles(*limits, plane, Handle::Corner, Handle::Side),
            Region::Polygon(corners) => {
                corners.iter().enumerate().map(|(i, at)| (Handle::Corner(i), *at)).collect()
            }
        }
    }

    /// Changes of the numbers when a handle moves to a position; `None` if the handle is none of a region.
    pub fn moved(&self, handle: Handle, to: [f64; 2]) -> Option<Vec<Change>> {
        match (handle, self) {
            (Handle::Corner(_) | Handle::Side(..), Region::Box(limits)) => {
                Some(changed_ranges(RANGES, *limits, stretched(*limits, handle, to)?))
            }
            (Handle::Corner(i), Region::Polygon(corners)) => {
                let mut corners = corners.clone();
                if let Some(corner) = corners.get_mut(i) {
                    *corner = to;
                }
                // A region is convex: a hand that would dent it waits at its bounds.
                let is_convex = is_convex(&corners);
                Some(if is_convex { stated(&corners) } else { Vec::new() })
            }
            _ => None,
        }
    }

    pub fn shifted(&self, by: [f64; 2], plane: &Plane) -> Vec<Change> {
        match self {
            Region::Whole => Vec::new(),
            Region::Box(limits) => changed_ranges(RANGES, *limits, shifted(*limits, by, plane)),
            Region::Polygon(corners) => {
                let moved: Vec<[f64; 2]> = corners.iter().map(|at| plane.moved_place(*at, by)).collect();
                stated(&moved)
            }
        }
    }

    /// With a corner more at a place, and which one that is: on the nearest side, or there where that keeps it convex.
    pub fn with_point(&self, at: [f64; 2], plane: &Plane) -> Option<(Vec<Change>, Handle)> {
        let Region::Polygon(corners) = self else { return None };
        let (place, on_side) = nearest_side(corners, at, plane.extent)?;
        let with = |corner: [f64; 2]| {
            let mut corners = corners.clone();
            corners.insert(place, corner);
            corners
        };
        let corners = if is_convex(&with(at)) { with(at) } else { with(on_side) };
        Some((stated(&corners), Handle::Corner(place)))
    }

    pub fn without_point(&self, handle: Handle) -> Option<Vec<Change>> {
        match (handle, self) {
            (Handle::Corner(i), Region::Polygon(corners)) if corners.len() > 3 && i < corners.len() => {
                let mut corners = corners.clone();
                corners.remove(i);
                Some(stated(&corners))
            }
            _ => None,
        }
    }

    /// `is_all`: of a widget that is its region.
    pub fn draw(&self, pen: &WidgetPainter, is_all: bool) {
        let thin = Stroke::new(pen.stroke.width * 0.6, pen.stroke.color);
        let fill = if is_all { pen.stroke.color.gamma_multiply(0.15) } else { Color32::TRANSPARENT };
        match self {
            Region::Whole => {}
            Region::Box(limits) => pen.rectangle(*limits, thin, fill),
            Region::Polygon(corners) => {
                let points: Vec<Pos2> = corners.iter().map(|at| pen.plane.to_window(*at)).collect();
                pen.painter.add(egui::Shape::convex_polygon(points, fill, thin));
            }
        }
    }
}

fn stated(corners: &[[f64; 2]]) -> Vec<Change> {
    vec![("region.polygon", Some(rows(corners)))]
}

/// True if a polygon turns one way at all of its corners.
fn is_convex(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % n]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    n >= 3 && ((0..n).all(|i| turn(i) > 0.0) || (0..n).all(|i| turn(i) < 0.0))
}

/// The number that a corner on the nearest side would have, and its place there.
fn nearest_side(corners: &[[f64; 2]], at: [f64; 2], extent: [f64; 2]) -> Option<(usize, [f64; 2])> {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let v = [0, 1].map(|k| (b[k] - a[k]) / extent[k]);
        let w = [0, 1].map(|k| (at[k] - a[k]) / extent[k]);
        let length = v[0] * v[0] + v[1] * v[1];
        let share = if length > 0.0 { ((v[0] * w[0] + v[1] * w[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
        let place = [0, 1].map(|k: usize| a[k] + share * (b[k] - a[k]));
        let apart = ((at[0] - place[0]) / extent[0]).hypot((at[1] - place[1]) / extent[1]);
        (i + 1, place, apart)
    };
    let nearest = (0..corners.len()).map(side).min_by(|a, b| a.2.total_cmp(&b.2))?;
    Some((nearest.0, nearest.1))
}
