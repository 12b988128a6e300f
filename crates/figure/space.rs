//! What tells directions and lengths of a view: the box of the data with ticks, the axes, a scale bar.

use crate::canvas::{Align, Canvas, Place};
use crate::ticks::{Ticks, ticks, values};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::camera::{Camera, Frame, Projection};

const NAMES: [&str; 3] = ["x", "y", "z"];

/// A camera that tells where points are in its picture.
#[derive(Debug, Clone, Copy)]
pub struct View {
    camera: Camera,
    frame: Frame,
}

impl View {
    /// Errors: a camera without axes.
    pub fn new(camera: Camera) -> Result<View> {
        Ok(View { frame: camera.frame()?, camera })
    }

    /// Where a point is seen; `None` in front of the near plane, and at the eye's depth or behind it.
    fn place(&self, point: DVec3) -> Option<Place> {
        let Frame { right, up, forward, pixel } = self.frame;
        let ray = point - self.camera.eye;
        let depth = ray.dot(forward);
        let scale = match self.camera.projection {
            Projection::Perspective { .. } if depth > 0.0 => pixel * depth,
            Projection::Perspective { .. } => return None,
            Projection::Orthographic { .. } => pixel,
        };
        let [width, height] = self.camera.size.map(f64::from);
        let at = [0.5 * width + ray.dot(right) / scale, 0.5 * height - ray.dot(up) / scale];
        let is_near = at.iter().all(|x| x.abs() < 1e5) && depth >= self.camera.near;
        is_near.then(|| at.map(|x| x as f32))
    }

    /// True if a plane's side to which its normal points is seen from behind.
    fn sees_inside(&self, on_plane: DVec3, outward: DVec3) -> bool {
        let ray = match self.camera.projection {
            Projection::Perspective { .. } => on_plane - self.camera.eye,
            Projection::Orthographic { .. } => self.frame.forward,
        };
        ray.dot(outward) > 0.0
    }
}

/// Draws the faces of a box that lie behind everything in it, as frames with a grid of lines, behind what the picture shows; ticks and
/// names along three edges at the rim. `unit` follows the names.
pub fn box_axes(canvas: &mut Canvas, view: &View, [low, high]: [DVec3; 2], unit: &str) {
    let middle = 0.5 * (low + high);
    let font = canvas.font;
    let along: [Ticks; 3] = std::array::from_fn(|axis| ticks([low[axis], high[axis]], 6));
    let corner = |ends: [bool; 3]| {
        DVec3::from_array(std::array::from_fn(|axis| if ends[axis] { high[axis] } else { low[axis] }))
    };
    let is_behind = |axis: usize, end: bool| {
        let outward = DVec3::AXES[axis] * if end { 1.0 } else { -1.0 };
        let on_plane = corner([axis == 0 && end, axis == 1 && end, axis == 2 && end]);
        view.sees_inside(on_plane, outward)
    };
    let lines = |canvas: &mut Canvas, from: DVec3, to: DVec3, opacity: f32| {
        if let (Some(from), Some(to)) = (view.place(from), view.place(to)) {
            canvas.line_behind(from, to, opacity);
        }
    };
    for axis in 0..3 {
        for end in [false, true].into_iter().filter(|end| is_behind(axis, *end)) {
            for (across, other) in [((axis + 1) % 3, (axis + 2) % 3), ((axis + 2) % 3, (axis + 1) % 3)] {
                let mut from = corner([end; 3]);
                let inner = along[across].ticks.iter().map(|(value, _)| (*value, 0.25));
                for (value, opacity) in inner.chain([(low[across], 0.8), (high[across], 0.8)]) {
                    (from[across], from[other]) = (value, low[other]);
                    let mut to = from;
                    to[other] = high[other];
                    lines(canvas, from, to, opacity);
                }
            }
        }
    }
    let Some(centre) = view.place(middle) else { return };
    for axis in 0..3 {
        // An edge at the rim: one of its two faces lies behind, the other in front. Of these the lowest in the picture, for an upright
        // axis the leftmost.
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let edges = [[false, false], [false, true], [true, false], [true, true]].map(|ends| {
            let at = |value: f64| {
                let mut point = DVec3::ZERO;
                point[axis] = value;
                for (other, end) in others.into_iter().zip(ends) {
                    point[other] = if end { high[other] } else { low[other] };
                }
                point
            };
            let is_rim = is_behind(others[0], ends[0]) != is_behind(others[1], ends[1]);
            (is_rim, view.place(at(low[axis])), view.place(at(high[axis])), at(0.0))
        });
        let visible =
            edges.into_iter().filter_map(|(is_rim, from, to, base)| is_rim.then_some((from?, to?, base)));
        let is_upright = |from: Place, to: Place| (to[1] - from[1]).abs() > 1.5 * (to[0] - from[0]).abs();
        let rank = |&(from, to, _): &(Place, Place, DVec3)| {
            let k = if is_upright(from, to) { 0 } else { 1 };
            let sum = from[k] + to[k];
            if k == 0 { -sum } else { sum }
        };
        let Some((from, to, base)) = visible.max_by(|a, b| rank(a).total_cmp(&rank(b))) else { continue };
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        if length < 4.0 * font {
            continue;
        }
        // Away from the middle of the box.
        let [x, y] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        let half = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
        let is_outward = (half[0] - centre[0]) * -y + (half[1] - centre[1]) * x > 0.0;
        let out = if is_outward { [-y, x] } else { [y, -x] };
        let (align, wide) = match out[0] {
            ..-0.35 => (Align::End, 1.0),
            0.35.. => (Align::Start, 1.0),
            _ => (Align::Middle, 0.0),
        };
        let Ticks { ticks, note } = &along[axis];
        // No more labels than have room.
        let room = if wide > 0.0 && y.abs() > 0.5 { 1.6 } else { 3.6 };
        let keep = ((ticks.len() as f32 * room * font / length).ceil() as usize).max(1);
        let mut widest = 0.0_f32;
        for (value, label) in ticks.iter().step_by(keep) {
            let mut point = base;
            point[axis] = *value;
            let Some([px, py]) = view.place(point) else { continue };
            canvas.line([px, py], [px + 0.4 * font * out[0], py + 0.4 * font * out[1]]);
            let [left, right] =
                canvas.text(label, [px + 0.8 * font * out[0], py + 1.1 * font * out[1]], align);
            widest = widest.max(right - left);
        }
        let away = 2.6 * font * (1.0 - wide) + wide * (1.4 * font + widest);
        let at = [half[0] + away * out[0], half[1] + away.max(2.4 * font) * out[1]];
        let note = note.as_ref().map_or(String::new(), |note| format!("  {note}"));
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        canvas.text(&format!("{}{unit}{note}", NAMES[axis]), at, align);
    }
}

/// Draws the directions of the axes in the lower left corner, the nearest last.
pub fn directions(canvas: &mut Canvas, view: &View) {
    let font = canvas.font;
    let length = 2.6 * font;
    let centre = [3.9 * font, canvas.height() - 3.9 * font];
    let Frame { right, up, forward, .. } = view.frame;
    let mut axes = [0, 1, 2].map(|axis| (axis, DVec3::AXES[axis]));
    axes.sort_by(|a, b| b.1.dot(forward).total_cmp(&a.1.dot(forward)));
    for (axis, direction) in axes {
        let [x, y] = [direction.dot(right) as f32, -direction.dot(up) as f32];
        canvas.line(centre, [centre[0] + length * x, centre[1] + length * y]);
        let far = length + 0.8 * font;
        canvas.text(NAMES[axis], [centre[0] + far * x, centre[1] + far * y], Align::Middle);
    }
}

/// Draws a line of a round length, at most a quarter of the picture wide, at the middle of its lower border: lengths are the same
/// everywhere in parallel projection, and in no other. Gives its length in world units; `None` in perspective.
pub fn scale_bar(canvas: &mut Canvas, view: &View, unit: &str) -> Option<f64> {
    let Projection::Orthographic { .. } = view.camera.projection else { return None };
    let pixel = view.frame.pixel;
    let longest = 0.25 * f64::from(canvas.width()) * pixel;
    let length = *values([0.0, longest], 2).last()?;
    let half = (0.5 * length / pixel) as f32;
    let (x, y) = (0.5 * canvas.width(), canvas.height() - 1.4 * canvas.font);
    canvas.line([x - half, y], [x + half, y]);
    for end in [x - half, x + half] {
        canvas.line([end, y - 0.4 * canvas.font], [end, y + 0.4 * canvas.font]);
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    canvas.text(&format!("{length}{unit}"), [x, y - 1.2 * canvas.font], Align::Middle);
    Some(length)
}
