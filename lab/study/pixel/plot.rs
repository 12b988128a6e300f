//! A pixel's ray drawn: values along it, and underneath what each cell adds.

use super::text::{number, srgb};
use super::trace::Pixel;
use crate::work_precision::canvas::{Anchor, Canvas, Color, Size};
use voltet_optics::trace::CellCrossing;

const SIZE: [f64; 2] = [900.0, 640.0];
/// Left and right end of the panels.
const ACROSS: [f64; 2] = [80.0, 880.0];
/// Top and bottom of the panels of s, of g and of contributions.
const PANELS: [[f64; 2]; 3] = [[50.0, 210.0], [240.0, 400.0], [430.0, 590.0]];
const INK: Color = [40, 40, 40];
const PALE: Color = [205, 205, 205];
const BLUE: Color = [31, 119, 180];
const GREEN: Color = [44, 120, 44];

/// s and g along the ray; underneath each cell's contribution to the pixel's opacity per length, in its own colour, and the
/// light from there that reaches the eye, dashed.
pub fn plot(pixel: &Pixel) -> Canvas {
    let [x, y] = pixel.place;
    let title = format!("{}: pixel X {x}, Y {y}", pixel.node);
    let mut canvas = Canvas::new(SIZE, &title);
    canvas.text([ACROSS[0], 24.0], &title, Size::Large, Anchor::Start, INK);
    let steps = &pixel.walk.steps;
    let (Some(first), Some(last)) = (steps.first(), steps.last()) else {
        let why = pixel.nothing.clone().unwrap_or_else(|| "the ray meets no cell".into());
        canvas.text([ACROSS[0], 60.0], &why, Size::Small, Anchor::Start, INK);
        return canvas;
    };
    let along = Axis::new([first.distance[0], last.distance[1]], ACROSS);
    for (q, color) in [(0, BLUE), (1, GREEN)] {
        let values = steps.iter().flat_map(|step| [step.front[q], step.back[q]]);
        let axis = Axis::over(values, PANELS[q]);
        frame(&mut canvas, PANELS[q], &pixel.names[q], &axis);
        // A line for each cell: neighbours meet, and gaps stay gaps.
        for step in steps {
            let front = [along.place(step.distance[0]), axis.place(step.front[q])];
            canvas.line(&[front, [along.place(step.distance[1]), axis.place(step.back[q])]], 1.6, color, &[]);
        }
    }
    contributions(&mut canvas, steps, &along);
    for k in 0..=4 {
        let distance = along.from + (along.to - along.from) * f64::from(k) / 4.0;
        let at = [along.place(distance), PANELS[2][1] + 14.0];
        canvas.text(at, &number(distance), Size::Small, Anchor::Middle, INK);
    }
    let middle = 0.5 * (ACROSS[0] + ACROSS[1]);
    canvas.text([middle, SIZE[1] - 18.0], "distance from the eye", Size::Small, Anchor::Middle, INK);
    canvas
}

/// Values of an axis and where its ends are drawn.
struct Axis {
    from: f64,
    to: f64,
    places: [f64; 2],
}

impl Axis {
    fn new([from, to]: [f64; 2], places: [f64; 2]) -> Axis {
        Axis { from, to, places }
    }

    /// Upward over all of these, in a panel.
    fn over(values: impl Iterator<Item = f64>, [top, bottom]: [f64; 2]) -> Axis {
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        // One value lies in the middle.
        let margin = if high > low { 0.0 } else { low.abs().max(1.0) };
        Axis { from: low - margin, to: high + margin, places: [bottom, top] }
    }

    fn place(&self, value: f64) -> f64 {
        let share = if self.to > self.from { (value - self.from) / (self.to - self.from) } else { 0.5 };
        self.places[0] + share * (self.places[1] - self.places[0])
    }
}

fn frame(canvas: &mut Canvas, [top, bottom]: [f64; 2], name: &str, axis: &Axis) {
    let [left, right] = ACROSS;
    canvas.ring(vec![[left, top], [right, top], [right, bottom], [left, bottom]], 1.0, PALE);
    for value in [axis.from, axis.to] {
        canvas.text([left - 6.0, axis.place(value)], &number(value), Size::Small, Anchor::End, INK);
    }
    canvas.text([left - 6.0, 0.5 * (top + bottom)], name, Size::Small, Anchor::End, INK);
}

fn contributions(canvas: &mut Canvas, steps: &[CellCrossing], along: &Axis) {
    let [top, bottom] = PANELS[2];
    let rate =
        |step: &CellCrossing| if step.length > 0.0 { step.contribution()[3] / step.length } else { 0.0 };
    let most = steps.iter().map(rate).fold(0.0, f64::max);
    let axis = Axis::new([0.0, if most > 0.0 { most } else { 1.0 }], [bottom, top]);
    for step in steps.iter().filter(|step| rate(step) > 0.0) {
        let ([left, right], height) = (step.distance.map(|d| along.place(d)), axis.place(rate(step)));
        let fill = srgb(step.part.color.map(|c| c / step.part.opacity));
        let corners = vec![[left, bottom], [left, height], [right, height], [right, bottom]];
        let adds = number(step.contribution()[3]);
        canvas.shape(corners, fill, fill, format!("tetrahedron {}: adds {adds} to the opacity", step.cell));
    }
    frame(canvas, PANELS[2], "adds/length", &axis);
    let light = Axis::new([0.0, 1.0], [bottom, top]);
    let mut points: Vec<[f64; 2]> =
        steps.iter().map(|step| [along.place(step.distance[0]), light.place(step.transmittance)]).collect();
    if let Some(last) = steps.last() {
        let behind = last.transmittance * (1.0 - last.part.opacity);
        points.push([along.place(last.distance[1]), light.place(behind)]);
    }
    canvas.line(&points, 1.2, INK, &[5.0, 4.0]);
    let [_, right] = ACROSS;
    let dashed = "dashed: light that reaches the eye, 0 to 1";
    canvas.text([right, top - 10.0], dashed, Size::Small, Anchor::End, INK);
}
