//! Directions and lengths of a view: the box of the data with ticks, the axes, a scale bar.

use crate::canvas::{Align, Canvas, LEADING, Place, Rectangle, text_width};
use crate::scale::Side;
use crate::ticks::{Ticks, ticks, values};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::transfer::AxisScale;

/// Rows, of a font's size each, by which directions and scale bar give way to what stands at the lower border.
const MAX_ROWS: usize = 12;

const NAMES: [&str; 3] = ["x", "y", "z"];

/// Places of points in a camera's picture.
#[derive(Debug, Clone, Copy)]
pub struct View {
    camera: Camera,
    frame: Frame,
}

impl View {
    /// The view of a camera. Errors: a camera without axes.
    pub fn new(camera: Camera) -> Result<View> {
        Ok(View { frame: camera.frame()?, camera })
    }

    /// The place at which a point is seen; `None` before the near plane, and at the eye's depth or behind it.
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
        (depth >= self.camera.near && at.iter().all(|x| x.abs() < 1e9)).then(|| at.map(|x| x as f32))
    }

    /// The part of a line that is seen.
    fn line(&self, from: DVec3, to: DVec3) -> Option<[Place; 2]> {
        let depth = |point: DVec3| (point - self.camera.eye).dot(self.frame.forward);
        // A thousandth of its extent before the eye, since what is at the eye's depth is seen nowhere.
        let nearest = match self.camera.projection {
            Projection::Perspective { .. } => self.camera.near.max(1e-3 * (depth(from) - depth(to)).abs()),
            Projection::Orthographic { .. } => self.camera.near,
        };
        let cut = |point: DVec3, other: DVec3| {
            let needed = (nearest - depth(point)).max(0.0);
            let share =
                if needed > 0.0 { needed / (depth(other) - depth(point)) * (1.0 + 1e-9) } else { 0.0 };
            (0.0..1.0).contains(&share).then(|| point + share * (other - point))
        };
        Some([self.place(cut(from, to)?)?, self.place(cut(to, from)?)?])
    }

    /// True if a plane's side to which its unit normal points is seen from behind, or its edge alone: an edge of a box that lies before
    /// it is at the rim then.
    fn sees_inside(&self, on_plane: DVec3, outward: DVec3) -> bool {
        let ray = match self.camera.projection {
            Projection::Perspective { .. } => on_plane - self.camera.eye,
            Projection::Orthographic { .. } => self.frame.forward,
        };
        ray.dot(outward) > -1e-9 * ray.length()
    }
}

/// The box of the data, and which of its faces lie behind what is in it.
struct Faces<'a> {
    view: &'a View,
    ends: [DVec3; 2],
    is_behind: [[bool; 2]; 3],
}

/// An edge of the box: along an axis, at one end of each of the two others.
#[derive(Clone, Copy)]
struct Edge {
    axis: usize,
    at_end: [bool; 2],
}

impl Edge {
    fn others(self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }
}

impl<'a> Faces<'a> {
    fn new(view: &'a View, ends: [DVec3; 2]) -> Faces<'a> {
        let is_behind = [0, 1, 2].map(|axis| {
            [(ends[0], -1.0), (ends[1], 1.0)]
                .map(|(corner, sign)| view.sees_inside(corner, sign * DVec3::AXES[axis]))
        });
        Faces { view, ends, is_behind }
    }

    fn point(&self, edge: Edge, value: f64) -> DVec3 {
        let mut point = DVec3::ZERO;
        point[edge.axis] = value;
        for (other, is_high) in edge.others().into_iter().zip(edge.at_end) {
            point[other] = self.ends[usize::from(is_high)][other];
        }
        point
    }

    /// The edges along an axis, each with the number of its two faces that lie behind: at one the edge is at the rim.
    fn edges(&self, axis: usize) -> [(Edge, usize); 4] {
        [[false, false], [false, true], [true, false], [true, true]].map(|at_end| {
            let edge = Edge { axis, at_end };
            let faces = edge.others().into_iter().zip(at_end);
            (edge, faces.filter(|&(other, is_high)| self.is_behind[other][usize::from(is_high)]).count())
        })
    }

    fn line(&self, edge: Edge) -> Option<[Place; 2]> {
        let [from, to] = self.ends.map(|end| self.point(edge, end[edge.axis]));
        self.view.line(from, to)
    }
}

/// Draws the edges of the data's box at its rim, around what is taken, with ticks and names; the other edges and a grid of lines on the
/// faces that lie behind everything in it, behind what the picture shows. `unit` follows the names.
///
/// Gives the names of axes with an edge at the rim whose labels have no room.
pub fn box_axes(canvas: &mut Canvas, view: &View, ends: [DVec3; 2], unit: &str) -> Vec<&'static str> {
    let faces = Faces::new(view, ends);
    let along: [Ticks; 3] = [0, 1, 2].map(|axis| ticks(AxisScale::Linear, [ends[0][axis], ends[1][axis]], 6));
    for axis in 0..3 {
        for (end, _) in faces.is_behind[axis].iter().enumerate().filter(|(_, is_behind)| **is_behind) {
            for (across, other) in [((axis + 1) % 3, (axis + 2) % 3), ((axis + 2) % 3, (axis + 1) % 3)] {
                for (value, _) in &along[across].ticks {
                    let mut from = ends[end];
                    (from[across], from[other]) = (*value, ends[0][other]);
                    let mut to = from;
                    to[other] = ends[1][other];
                    if let Some([from, to]) = view.line(from, to) {
                        canvas.line_behind(from, to, 0.25);
                    }
                }
            }
        }
    }
    for (edge, behind_count) in [0, 1, 2].into_iter().flat_map(|axis| faces.edges(axis)) {
        match (faces.line(edge), behind_count) {
            (Some([from, to]), 1) => canvas.line_around(from, to),
            (Some([from, to]), 2) => canvas.line_behind(from, to, 0.8),
            _ => {}
        }
    }
    let has_no_room = |axis: &usize| !label(canvas, &faces, *axis, &along[*axis], unit);
    [0, 1, 2].into_iter().filter(has_no_room).map(|axis| NAMES[axis]).collect()
}

/// Labels that have room along an edge, on one of its sides.
struct Labels {
    /// Texts, the place of each, and the ends of its tick's mark.
    ticks: Vec<(String, Place, [Place; 2])>,
    name: Option<Place>,
    align: Align,
}

/// Writes the labels of an axis along the edge at the rim, and on the side of it, where most of them have room. False where there is
/// such an edge and no room.
fn label(canvas: &mut Canvas, faces: &Faces, axis: usize, ticks: &Ticks, unit: &str) -> bool {
    let at_rim = faces.edges(axis).into_iter().filter(|(_, behind_count)| *behind_count == 1);
    let mut edges: Vec<(Edge, [Place; 2])> =
        at_rim.filter_map(|(edge, _)| Some((edge, faces.line(edge)?))).collect();
    // The lower one to the left.
    let rank = |[from, to]: [Place; 2]| from[0] + to[0] - from[1] - to[1];
    edges.sort_by(|a, b| rank(a.1).total_cmp(&rank(b.1)));
    let note = ticks.note.as_ref().map_or(String::new(), |note| format!("  {note}"));
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    let name = format!("{}{unit}{note}", NAMES[axis]);
    let mut best: Option<(usize, Labels)> = None;
    // An axis along the view, or about the eye, has no edge at the rim that labels could stand at.
    let least = 3.0 * canvas.font();
    let is_long = |[from, to]: [Place; 2]| (to[0] - from[0]).hypot(to[1] - from[1]) >= least;
    for outward in [1.0, -1.0] {
        for &(edge, line) in edges.iter().filter(|(_, line)| is_long(*line)) {
            let labels = labels(canvas, faces, edge, line, outward, ticks, &name);
            let count = labels.ticks.len() + 2 * usize::from(labels.name.is_some());
            if count > best.as_ref().map_or(0, |(most, _)| *most) {
                best = Some((count, labels));
            }
        }
    }
    let Some((_, Labels { ticks, name: named_at, align })) = best else {
        return !edges.iter().any(|(_, line)| is_long(*line));
    };
    ticks.iter().for_each(|(_, _, [from, to])| canvas.line(*from, *to));
    let texts = ticks.into_iter().map(|(label, at, _)| (label, at));
    for (text, at) in texts.chain(named_at.map(|at| (name, at))) {
        canvas.take(canvas.place_of(&text, at, align));
        canvas.text(&text, at, align);
    }
    named_at.is_some()
}

/// The labels that have room along an edge whose line in the picture is given, away from the box for `outward` = 1 and into it for −1.
fn labels(
    canvas: &Canvas,
    faces: &Faces,
    edge: Edge,
    [from, to]: [Place; 2],
    outward: f32,
    ticks: &Ticks,
    name: &str,
) -> Labels {
    let font = canvas.font();
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let [x, y] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    let centre = faces.view.place(0.5 * (faces.ends[0] + faces.ends[1]));
    let centre = centre.unwrap_or(canvas.size().map(|side| 0.5 * side));
    let half = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    let is_left = (half[0] - centre[0]) * -y + (half[1] - centre[1]) * x > 0.0;
    let out = if is_left { [-y, x] } else { [y, -x] }.map(|component| outward * component);
    let (align, is_beside) = match out[0] {
        ..-0.35 => (Align::End, true),
        0.35.. => (Align::Start, true),
        _ => (Align::Middle, false),
    };
    let placed = |(value, label): &(f64, String)| {
        let [x, y] = faces.view.place(faces.point(edge, *value))?;
        let beside = |right: f32, down: f32| [x + right * font * out[0], y + down * font * out[1]];
        Some((label.clone(), beside(0.8, 1.1), [[x, y], beside(0.4, 0.4)]))
    };
    let all: Vec<_> = ticks.ticks.iter().filter_map(placed).collect();
    let rectangle = |(label, at, _): &(String, Place, [Place; 2])| canvas.place_of(label, *at, align);
    let is_apart = |[a, b]: [Rectangle; 2], gap: f32| {
        (0..2).any(|k| b[0][k] >= a[1][k] + [gap, 0.0][k] || b[1][k] + [gap, 0.0][k] <= a[0][k])
    };
    // Each k-th of them, so that neighbours leave each other room.
    let is_wide = |step: &usize| {
        let kept: Vec<_> = all.iter().step_by(*step).map(rectangle).collect();
        kept.windows(2).all(|pair| is_apart([pair[0], pair[1]], 0.4 * font))
    };
    let step = (1..=all.len().max(1)).find(is_wide).unwrap_or(1);
    let ticks: Vec<_> =
        all.into_iter().step_by(step).filter(|tick| canvas.is_free(rectangle(tick))).collect();
    let widest = ticks.iter().map(|(label, ..)| text_width(label, font)).fold(0.0, f32::max);
    let (from_edge, row) = (if is_beside { 1.4 * font + widest } else { 2.4 * font }, LEADING * font);
    let shares = [0.5, 0.3, 0.7, 0.15, 0.85, 0.0, 1.0];
    // Beside the labels, or farther out.
    let named_at =
        [0.0, row].into_iter().flat_map(|farther| shares.map(|share| (share, from_edge + farther)));
    let mut named_at = named_at.map(|(share, away): (f32, f32)| {
        let k = usize::from(!is_beside);
        let mut at = [0, 1].map(|k: usize| from[k] + share * (to[k] - from[k]));
        at[k] += if out[k] < 0.0 { -away } else { away };
        at
    });
    let has_room = |at: &Place| {
        let own = canvas.place_of(name, *at, align);
        canvas.is_free(own) && ticks.iter().all(|tick| is_apart([own, rectangle(tick)], 0.0))
    };
    let name = named_at.find(has_room);
    Labels { ticks, name, align }
}

/// Draws the directions of the axes in the lower corner of a side, or above what stands there, the nearest last. False where there is no
/// room.
pub fn directions(canvas: &mut Canvas, view: &View, side: Side) -> bool {
    let font = canvas.font();
    let (length, half) = (2.0 * font, 3.8 * font);
    let left = side.left(canvas, 2.0 * half);
    let centres = (0..MAX_ROWS).map(|row| [left + half, canvas.size()[1] - (0.5 + row as f32) * font - half]);
    let around = |centre: Place| [centre.map(|x| x - half), centre.map(|x| x + half)];
    let free: Option<Place> = centres.into_iter().find(|centre| canvas.is_free(around(*centre)));
    let Some(centre) = free.filter(|centre| canvas.take(around(*centre))) else { return false };
    let Frame { right, up, forward, .. } = view.frame;
    let mut axes = [0, 1, 2].map(|axis| (axis, DVec3::AXES[axis]));
    axes.sort_by(|a, b| b.1.dot(forward).total_cmp(&a.1.dot(forward)));
    let mut labelled: Vec<Place> = Vec::new();
    for (axis, direction) in axes {
        let [x, y] = [direction.dot(right) as f32, -direction.dot(up) as f32];
        canvas.line(centre, [centre[0] + length * x, centre[1] + length * y]);
        // Two axes may be seen as one line: the second label stands farther out.
        let far = (0..3).map(|k| length + (0.8 + 1.3 * k as f32) * font).map(|far| [far * x, far * y]);
        let is_apart =
            |at: &Place| labelled.iter().all(|other| (at[0] - other[0]).hypot(at[1] - other[1]) > font);
        let at = far.into_iter().find(is_apart).unwrap_or_default();
        labelled.push(at);
        canvas.text(NAMES[axis], [centre[0] + at[0], centre[1] + at[1]], Align::Middle);
    }
    true
}

/// Draws a line of a round length, at most a quarter of the picture wide, at its lower border: lengths are the same
/// everywhere in parallel projection, and in no other. Gives its length in world units; `None` in perspective, and where there is no room.
pub fn scale_bar(canvas: &mut Canvas, view: &View, unit: &str) -> Option<f64> {
    let Projection::Orthographic { .. } = view.camera.projection else { return None };
    let (font, [width, height], pixel) = (canvas.font(), canvas.size(), view.frame.pixel);
    let longest = 0.25 * f64::from(width) * pixel;
    let length = *values([0.0, longest], 2).last()?;
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let label = match length {
        1e-4..1e6 => format!("{length}{unit}"),
        _ => format!("{length:e}{unit}"),
    };
    let half = (0.5 * length / pixel) as f32;
    let around = half.max(0.5 * text_width(&label, font)) + 0.3 * font;
    // In the middle, or beside what stands in the corners, or above what stands at the border.
    let [low, high] = [around + 0.5 * font, width - around - 0.5 * font];
    let middles = [4, 3, 5, 2, 6, 1, 7, 0, 8].map(|k| low + k as f32 / 8.0 * (high - low));
    let heights = (0..MAX_ROWS).map(|row| height - (1.0 + row as f32) * font);
    let [x, y] = heights
        .flat_map(|y| middles.map(|x| [x, y]))
        .find(|[x, y]| canvas.take([[x - around, y - 1.9 * font], [x + around, y + 0.5 * font]]))?;
    canvas.line([x - half, y], [x + half, y]);
    for end in [x - half, x + half] {
        canvas.line([end, y - 0.4 * font], [end, y + 0.4 * font]);
    }
    canvas.text(&label, [x, y - 1.2 * font], Align::Middle);
    Some(length)
}
