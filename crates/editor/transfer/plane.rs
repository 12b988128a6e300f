//! The plane of s and g: from values to the window and back, its ticks, the histogram as a texture, probed values, the painter of widgets,
//! their handles, and numbers of a widget's table as they are read and written.

use crate::picture::{WHOLE, set_texture};
use crate::theme;
use crate::worker::{Distribution, PixelProbe, short, short_by};
use eframe::egui::{
    Align2, Color32, ColorImage, FontId, Galley, Painter, Pos2, Rect, Sense, Stroke, StrokeKind,
    TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, WidgetType, pos2, vec2,
};
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::arithmetic::decimal;
use voltet_core::probing::{Axis, Histogram};
use voltet_core::transfer::AxisScale;
use voltet_figure::ticks;
use voltet_graph::{ArrayRef, Field, LocatedValue, ParameterValue, find_setting};

/// Largest number of probed values that are drawn one by one.
const FEW: usize = 300;

/// A dot of a cloud of values, points.
const DOT: f32 = 2.0;

/// Decades of counts that are told apart.
const DECADES: f64 = 6.0;

/// The shown part of the plane in a rectangle of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    pub rect: Rect,
    /// From low to high, of s and of g.
    pub shown: [[f64; 2]; 2],
    /// Lengths along both axes that are equal on the screen, for the axes and angles of ellipses.
    pub extent: [f64; 2],
    /// The extinction at the top of the plot, for curves.
    pub peak: f64,
}

impl Plane {
    pub fn to_window(self, [s, g]: [f64; 2]) -> Pos2 {
        let share = |axis: usize, x: f64| {
            ((x - self.shown[axis][0]) / (self.shown[axis][1] - self.shown[axis][0])) as f32
        };
        // Far beyond the window is as good as farther.
        let clamped = |x: f32| x.clamp(-1e5, 1e5);
        pos2(
            clamped(self.rect.left() + share(0, s) * self.rect.width()),
            clamped(self.rect.bottom() - share(1, g) * self.rect.height()),
        )
    }

    pub fn to_values(self, at: Pos2) -> [f64; 2] {
        let x = f64::from((at.x - self.rect.left()) / self.rect.width());
        let y = f64::from((self.rect.bottom() - at.y) / self.rect.height());
        let [s, g] = self.shown;
        [s[0] + x * (s[1] - s[0]), g[0] + y * (g[1] - g[0])]
    }

    /// Length of a point of the window along an axis.
    pub fn step(self, axis: usize) -> f64 {
        let size = [self.rect.width(), self.rect.height()][axis];
        (self.shown[axis][1] - self.shown[axis][0]) / f64::from(size)
    }

    /// A value moved along an axis, as finely as a tenth of a point shows; one that is not moved stays as it is.
    pub fn moved(self, axis: usize, x: f64, by: f64) -> f64 {
        let step = 0.1 * self.step(axis);
        // An infinite end stays one; a plane without a size has no steps.
        if by == 0.0 || !x.is_finite() || !step.is_finite() { x + by } else { decimal(x + by, step) }
    }

    /// A place moved along both axes.
    pub fn moved_place(self, at: [f64; 2], by: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis: usize| self.moved(axis, at[axis], by[axis]))
    }

    /// The largest value shown along the second axis, where a curve reaches its peak.
    pub fn top(&self) -> f64 {
        self.shown[1][1]
    }

    /// Lengths along both axes that are equal on the screen, about as long as the axes.
    pub fn metric(self) -> [f64; 2] {
        let side = self.rect.width().max(1.0);
        self.drag_in_values(vec2(side, -side))
    }

    /// A way of the pointer, in values.
    pub fn drag_in_values(self, by: Vec2) -> [f64; 2] {
        let [s, g] = self.shown;
        let per_point =
            [(s[1] - s[0]) / f64::from(self.rect.width()), (g[1] - g[0]) / f64::from(self.rect.height())];
        [f64::from(by.x) * per_point[0], -f64::from(by.y) * per_point[1]]
    }
}

pub(super) fn middle(axis: Axis, i: usize) -> f64 {
    0.5 * axis.edge(i) + 0.5 * axis.edge(i + 1)
}

/// An axis zoomed about a value; no finer than its numbers tell apart.
pub(super) fn zoomed([low, high]: [f64; 2], factor: f64, about: f64) -> [f64; 2] {
    let to = [about - (about - low) / factor, about + (high - about) / factor];
    let finest = 1e-9 * to[0].abs().max(to[1].abs()).max(f64::MIN_POSITIVE);
    if to[1] - to[0] > finest && (to[1] - to[0]).is_finite() { to } else { [low, high] }
}

/// Both axes of a histogram, with a little room.
pub(super) fn whole(histogram: &Histogram) -> [[f64; 2]; 2] {
    histogram.axes.map(|axis| {
        let room = 0.03 * (axis.high - axis.low);
        [axis.low - room, axis.high + room]
    })
}

pub(super) fn axes(ui: &Ui, plane: Plane, scales: [AxisScale; 2], names: [&str; 2]) {
    let dark = ui.visuals().dark_mode;
    let (line, text) = (Stroke::new(1.0, theme::weak(dark).gamma_multiply(0.25)), theme::weak(dark));
    let font = FontId::proportional(10.5);
    let rect = plane.rect;
    let [x_name, y_name] =
        names.map(|name| ui.painter().layout_no_wrap(name.into(), FontId::proportional(12.0), text));
    let name_at = rect.right_bottom() + vec2(4.0 - x_name.size().x, 1.0);
    let [across, up] = [0, 1].map(|axis: usize| {
        let most = if axis == 0 { rect.width() / 75.0 } else { rect.height() / 36.0 };
        labelled(scales[axis], plane.shown[axis], most as usize)
    });
    for (s, label) in across {
        let x = plane.to_window([s, 0.0]).x;
        ui.painter().vline(x, rect.y_range(), line);
        let number = ui.painter().layout_no_wrap(label, font.clone(), text);
        // The axis' name comes before a number where both have no room.
        if x + 0.5 * number.size().x < name_at.x - 4.0 {
            ui.painter().galley(pos2(x - 0.5 * number.size().x, rect.bottom() + 2.0), number, text);
        }
    }
    for (g, label) in up {
        let y = plane.to_window([0.0, g]).y;
        ui.painter().hline(rect.x_range(), y, line);
        ui.painter().text(pos2(rect.left() - 4.0, y), Align2::RIGHT_CENTER, label, font.clone(), text);
    }
    ui.painter().galley(name_at, x_name, text);
    on_ground(ui, rect.left_top() + vec2(5.0, 3.0), y_name);
}

/// Ticks of a part of an axis, at most so many: positions, and their values in words.
fn labelled(scale: AxisScale, shown: [f64; 2], most: usize) -> Vec<(f64, String)> {
    if scale.is_curved() {
        return ticks::ticks(scale, shown, most).ticks;
    }
    let values = ticks::values(shown, most);
    let step = if let [a, b, ..] = values[..] { b - a } else { f64::INFINITY };
    values.into_iter().map(|value| (value, short_by(value, step))).collect()
}

/// Extinctions at the right, as curves have them: small ones are told apart by the cube root.
pub(super) fn extinctions(ui: &Ui, plane: Plane) {
    let text = theme::weak(ui.visuals().dark_mode);
    let font = FontId::proportional(10.5);
    let (rect, top, peak) = (plane.rect, plane.top(), plane.peak);
    let power = 10f64.powf(peak.log10().floor());
    let mut last = f32::INFINITY;
    for tick in [0.0, 1e-3, 1e-2, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0].map(|k| k * power) {
        let y = plane.to_window([0.0, height_of(tick, peak) * top]).y;
        if tick > peak || !rect.y_range().contains(y) || last - y < 14.0 {
            continue;
        }
        last = y;
        ui.painter().hline(rect.right()..=rect.right() + 4.0, y, Stroke::new(1.0, text));
        let at = pos2(rect.right() + 6.0, y);
        ui.painter().text(at, Align2::LEFT_CENTER, short(tick), font.clone(), text);
    }
    let name = ui.painter().layout_no_wrap("extinction, cube root".into(), FontId::proportional(11.0), text);
    on_ground(ui, rect.right_bottom() - name.size() - vec2(6.0, 4.0), name);
}

/// Words over the histogram, on a ground of their own.
pub(super) fn on_ground(ui: &Ui, at: Pos2, words: Arc<Galley>) {
    let place = Rect::from_min_size(at, words.size()).expand(3.0);
    ui.painter().rect_filled(place, 3.0, ui.visuals().extreme_bg_color.gamma_multiply(0.85));
    ui.painter().galley(at, words, ui.visuals().text_color());
}

/// The histogram as a texture, made again where it is another or the theme is.
#[derive(Default)]
pub(super) struct Counts {
    texture: Option<TextureHandle>,
    of: Option<(Arc<Distribution>, bool)>,
}

impl Counts {
    pub fn draw(&mut self, ui: &Ui, plane: Plane, found: &Arc<Distribution>) {
        let histogram = &found.histogram;
        let dark = ui.visuals().dark_mode;
        let same = self.of.as_ref().is_some_and(|(of, of_dark)| Arc::ptr_eq(of, found) && *of_dark == dark);
        if !same {
            let image = image(histogram, dark);
            set_texture(&mut self.texture, ui, "counts", image, TextureOptions::NEAREST);
            self.of = Some((found.clone(), dark));
        }
        let Some(texture) = &self.texture else { return };
        let [s, g] = histogram.axes;
        let place = Rect::from_two_pos(plane.to_window([s.low, g.low]), plane.to_window([s.high, g.high]));
        ui.painter().with_clip_rect(plane.rect).image(texture.id(), place, WHOLE, Color32::WHITE);
    }
}

/// Logarithms of the volumes, from the ground's colour to the brightest (or darkest).
fn image(histogram: &Histogram, dark: bool) -> ColorImage {
    let [wide, high] = [histogram.axes[0].bins, histogram.axes[1].bins];
    let most = histogram.volumes.iter().copied().fold(0.0, f64::max);
    let level = |volume: f64| {
        if volume <= 0.0 || most <= 0.0 {
            return 0.0;
        }
        (1.0 + (volume / most).log10() / DECADES).max(0.08)
    };
    let color = |volume: f64| {
        let level = level(volume) as f32;
        let [from, to] = if dark { [18.0, 185.0] } else { [255.0, 70.0] };
        Color32::from_gray((from + level * (to - from)) as u8)
    };
    // Rows of a texture go down, g goes up.
    let pixels = (0..high).rev().flat_map(|j| (0..wide).map(move |i| (i, j)));
    let pixels = pixels.map(|(i, j)| color(histogram.volumes[j * wide + i])).collect();
    ColorImage::new([wide, high], pixels)
}

/// The share of the volume in the bin under a place; none beyond the axes.
pub(super) fn share_at(histogram: &Histogram, [s, g]: [f64; 2]) -> Option<f64> {
    let bin = |axis: usize, x: f64| {
        let axis = histogram.axes[axis];
        let place = (x - axis.low) / (axis.high - axis.low) * axis.bins as f64;
        (place >= 0.0 && place < axis.bins as f64).then_some(place as usize)
    };
    let (i, j) = (bin(0, s)?, bin(1, g)?);
    Some(histogram.volumes[j * histogram.axes[0].bins + i] / histogram.total)
}

pub(super) struct WidgetPainter {
    pub painter: Painter,
    pub plane: Plane,
    pub stroke: Stroke,
    pub is_chosen: bool,
    pub is_hidden: bool,
    pub dark: bool,
}

impl WidgetPainter {
    /// Ranges, as far as they are shown.
    pub fn rectangle(&self, [s, g]: [[f64; 2]; 2], stroke: Stroke, fill: Color32) {
        let within = |axis: usize, [low, high]: [f64; 2]| {
            let [a, b] = self.plane.shown[axis];
            let over = b - a;
            [low.max(a - over), high.min(b + over)]
        };
        let ([s0, s1], [g0, g1]) = (within(0, s), within(1, g));
        let rect = Rect::from_two_pos(self.plane.to_window([s0, g0]), self.plane.to_window([s1, g1]));
        self.painter.rect(rect, 0.0, fill, stroke, StrokeKind::Middle);
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
        let at = pos2(x as f32, y as f32) * DOT;
        let dot = Rect::from_min_size(at, Vec2::splat(DOT));
        painter.rect_filled(dot, 0.0, color.gamma_multiply(0.25 + 0.75 * (share / densest).sqrt() as f32));
    }
}

/// Mark of the values that are seen first under the pointer in the picture.
pub(super) fn mark(ui: &Ui, plane: Plane, place: [f64; 2]) {
    let at = plane.to_window(place);
    if !place.iter().all(|x| x.is_finite()) || !plane.rect.contains(at) {
        return;
    }
    let stroke = Stroke::new(1.5, theme::accent(ui.visuals().dark_mode));
    ui.painter().circle_stroke(at, 6.0, stroke);
    for way in [vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(-1.0, 0.0), vec2(0.0, -1.0)] {
        ui.painter().line_segment([at + 3.0 * way, at + 10.0 * way], stroke);
    }
    let response =
        ui.interact(Rect::from_center_size(at, vec2(12.0, 12.0)), ui.id().with("mark"), Sense::empty());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "value under the pointer"));
}

/// The plane of the scalar and its gradient magnitude.
pub(crate) const S_AND_G: [ArrayRef; 2] = [ArrayRef::Named("s"), ArrayRef::Named("g")];

/// The height in the plot of an extinction, 0 to 1: its cube root, so that small ones are told apart.
pub(super) fn height_of(extinction: f64, peak: f64) -> f64 {
    (extinction / peak).max(0.0).cbrt()
}

pub(super) fn extinction_at(height: f64, peak: f64) -> f64 {
    let height = height.clamp(0.0, 1.5);
    // At the foot it is none at all.
    if height < 0.01 { 0.0 } else { rounded(height.powi(3) * peak) }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Handle {
    Centre,
    /// The end of a half axis.
    Width(usize),
    Angle,
    /// Width of the bands around a wave's peaks.
    Band,
    Rim(usize),
    /// A side of a picture's ranges: along which axis, and whether the upper end.
    Edge(usize, bool),
    Corner(usize),
    /// A side of the region, as of an edge.
    Side(usize, bool),
    Point(usize),
}

impl Handle {
    /// Name of what it holds: "centre", "width 1", "upper edge 2".
    pub fn name(self) -> String {
        let end = |is_upper: bool| if is_upper { "upper" } else { "lower" };
        match self {
            Handle::Centre => "centre".into(),
            Handle::Width(axis) => format!("width {}", axis + 1),
            Handle::Angle => "angle".into(),
            Handle::Band => "band".into(),
            Handle::Rim(i) => format!("rim {}", i + 1),
            Handle::Edge(axis, is_upper) => format!("{} edge {}", end(is_upper), axis + 1),
            Handle::Corner(i) => format!("corner {}", i + 1),
            Handle::Side(axis, is_upper) => format!("{} side {}", end(is_upper), axis + 1),
            Handle::Point(i) => format!("point {}", i + 1),
        }
    }
}

/// Handles of ranges that may be infinite: of the corners, against the clock from the lower left, where all ends are finite; and of the
/// finite sides, each in the middle of what is shown of it.
pub(super) fn range_handles(
    ranges: [[f64; 2]; 2],
    plane: &Plane,
    corner: fn(usize) -> Handle,
    side: fn(usize, bool) -> Handle,
) -> Vec<(Handle, [f64; 2])> {
    let [s, g] = ranges;
    let corners = [[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]];
    let is_closed = ranges.as_flattened().iter().all(|x| x.is_finite());
    let corners = corners.into_iter().enumerate().filter(|_| is_closed).map(|(i, at)| (corner(i), at));
    let sides = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().filter_map(|(axis, end)| {
        let [low, high] = plane.shown[1 - axis];
        let [a, b] = ranges[1 - axis].map(|x| x.clamp(low, high));
        let mut at = [0.5 * (a + b); 2];
        at[axis] = ranges[axis][end];
        at[axis].is_finite().then(|| (side(axis, end == 1), at))
    });
    corners.chain(sides).collect()
}

/// Ranges when a corner or a side of theirs is brought to a place: the lower end stays the lower one. `None` of other handles.
pub(super) fn stretched(mut ranges: [[f64; 2]; 2], handle: Handle, to: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    match handle {
        Handle::Rim(i) | Handle::Corner(i) => {
            ranges[0][usize::from(i == 1 || i == 2)] = to[0];
            ranges[1][usize::from(i >= 2)] = to[1];
        }
        Handle::Edge(axis, upper) | Handle::Side(axis, upper) => ranges[axis][usize::from(upper)] = to[axis],
        _ => return None,
    }
    Some(ranges.map(|[a, b]| [a.min(b), a.max(b)]))
}

/// Ranges moved along both axes.
pub(super) fn shifted(ranges: [[f64; 2]; 2], by: [f64; 2], plane: &Plane) -> [[f64; 2]; 2] {
    [0, 1].map(|k: usize| ranges[k].map(|x| plane.moved(k, x, by[k])))
}

/// The ranges as a file states them under these keys, as far as they changed.
pub(super) fn changed_ranges(
    keys: [&'static str; 2],
    before: [[f64; 2]; 2],
    after: [[f64; 2]; 2],
) -> Vec<Change> {
    (0..2).filter(|&k| before[k] != after[k]).map(|k| (keys[k], Some(list(&after[k])))).collect()
}

pub(super) fn array<const N: usize>(fields: &[Field], name: &str) -> Option<[f64; N]> {
    find_setting(fields, name)?.array()
}

pub(super) fn number(fields: &[Field], name: &str) -> Option<f64> {
    find_setting(fields, name).and_then(LocatedValue::number)
}

/// A change of a widget's table: a key, and its value or none to take it out.
pub(super) type Change = (&'static str, Option<ParameterValue>);

/// A list of all digits of each number: what is not moved is written as it was.
pub(super) fn list(numbers: &[f64]) -> ParameterValue {
    numbers.iter().copied().collect()
}

pub(super) fn rows<Row: AsRef<[f64]>>(rows: &[Row]) -> ParameterValue {
    rows.iter().map(|row| list(row.as_ref())).collect()
}

/// Six digits, of a length, an angle or a factor: finer than a pixel of any screen. A place may lie far from 0 in a small range, and
/// takes as many as [`Plane::moved`] gives it.
pub(super) fn rounded(x: f64) -> f64 {
    if x.is_finite() { format!("{x:.5e}").parse().unwrap_or(x) } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_and_the_values_are_inverse() {
        let rect = Rect::from_min_size(pos2(50.0, 20.0), vec2(400.0, 200.0));
        let plane = Plane { rect, shown: [[-2.0, 6.0], [0.0, 1e-3]], extent: [1.0; 2], peak: 1.0 };
        let [s, g] = plane.to_values(plane.to_window([1.5, 4e-4]));
        assert!((s - 1.5).abs() < 1e-5 && (g - 4e-4).abs() < 1e-9);
        assert_eq!(plane.to_window([-2.0, 0.0]), rect.left_bottom());
    }

    #[test]
    fn zooming_keeps_the_value_under_the_pointer_and_has_an_end() {
        let mut axis = zoomed([0.0, 10.0], 2.0, 4.0);
        assert_eq!(axis, [2.0, 7.0]);
        for _ in 0..1000 {
            axis = zoomed(axis, 1.5, 4.0);
        }
        assert!(axis[0] < axis[1]);
    }
}
