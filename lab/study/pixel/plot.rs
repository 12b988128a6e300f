//! Drawing of the values and contributions along a pixel's ray.

use super::Pixel;
use super::text::{number, srgb};
use crate::work_precision::canvas::{Anchor, Axis, BLACK, Canvas, Color};
use voltet_optics::trace::CellCrossing;

const SIZE: [f64; 2] = [900.0, 640.0];
/// Left and right end of the panels.
const ACROSS: [f64; 2] = [80.0, 880.0];
/// Top and bottom of the panels of s, of g and of contributions.
const PANELS: [[f64; 2]; 3] = [[50.0, 210.0], [240.0, 400.0], [430.0, 590.0]];
const PALE: Color = [205, 205, 205];
const BLUE: Color = [31, 119, 180];
const GREEN: Color = [44, 120, 44];

/// s and g along the ray; underneath each cell's contribution to the pixel's opacity per length, in its own colour, and the
/// light from there that reaches the eye, dashed.
pub fn plot(pixel: &Pixel) -> Canvas {
    let [x, y] = pixel.place;
    let title = format!("{}: pixel X {x}, Y {y}", pixel.node);
    let mut canvas = Canvas::new(SIZE, &title);
    canvas.heading([ACROSS[0], 24.0], &title);
    let steps = &pixel.walk.steps;
    let (Some(first), Some(last)) = (steps.first(), steps.last()) else {
        let why = pixel.nothing.clone().unwrap_or_else(|| "the ray meets no cell".into());
        canvas.text([ACROSS[0], 60.0], &why, Anchor::Start);
        return canvas;
    };
    let along = Axis::linear([first.distance[0], last.distance[1]], ACROSS);
    for (q, color) in [(0, BLUE), (1, GREEN)] {
        let values = steps.iter().flat_map(|step| [step.front[q], step.back[q]]);
        let axis = axis_over(values, PANELS[q]);
        frame(&mut canvas, PANELS[q], &pixel.names[q], &axis);
        // A line for each cell: neighbours meet, and gaps stay gaps.
        for step in steps {
            let front = [along.place(step.distance[0]), axis.place(step.front[q])];
            canvas.line(&[front, [along.place(step.distance[1]), axis.place(step.back[q])]], 1.6, color, &[]);
        }
    }
    contributions(&mut canvas, steps, &along);
    for k in 0..=4 {
        let distance = along.low + (along.high - along.low) * f64::from(k) / 4.0;
        let at = [along.place(distance), PANELS[2][1] + 14.0];
        canvas.text(at, &number(distance), Anchor::Middle);
    }
    let middle = 0.5 * (ACROSS[0] + ACROSS[1]);
    canvas.text([middle, SIZE[1] - 18.0], "distance from the eye", Anchor::Middle);
    canvas
}

/// A linear axis upward over all of these values, in a panel.
fn axis_over(values: impl Iterator<Item = f64>, [top, bottom]: [f64; 2]) -> Axis {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    // One value lies in the middle.
    let margin = if high > low { 0.0 } else { low.abs().max(1.0) };
    Axis::linear([low - margin, high + margin], [bottom, top])
}

fn frame(canvas: &mut Canvas, [top, bottom]: [f64; 2], name: &str, axis: &Axis) {
    let [left, right] = ACROSS;
    canvas.rectangle([left, top, right, bottom], None, PALE, "");
    for value in [axis.low, axis.high] {
        canvas.text([left - 6.0, axis.place(value)], &number(value), Anchor::End);
    }
    canvas.text([left - 6.0, 0.5 * (top + bottom)], name, Anchor::End);
}

fn contributions(canvas: &mut Canvas, steps: &[CellCrossing], along: &Axis) {
    let [top, bottom] = PANELS[2];
    let rate =
        |step: &CellCrossing| if step.length > 0.0 { step.contribution()[3] / step.length } else { 0.0 };
    let most = steps.iter().map(rate).fold(0.0, f64::max);
    let axis = Axis::linear([0.0, if most > 0.0 { most } else { 1.0 }], [bottom, top]);
    for step in steps.iter().filter(|step| rate(step) > 0.0) {
        let ([left, right], height) = (step.distance.map(|d| along.place(d)), axis.place(rate(step)));
        let fill = srgb(step.part.color.map(|c| c / step.part.opacity));
        let adds = number(step.contribution()[3]);
        let hint = format!("tetrahedron {}: adds {adds} to the opacity", step.cell);
        canvas.rectangle([left, height, right, bottom], Some(fill), fill, &hint);
    }
    frame(canvas, PANELS[2], "adds/length", &axis);
    let light = Axis::linear([0.0, 1.0], [bottom, top]);
    let mut points: Vec<[f64; 2]> =
        steps.iter().map(|step| [along.place(step.distance[0]), light.place(step.transmittance)]).collect();
    if let Some(last) = steps.last() {
        let behind = last.transmittance * (1.0 - last.part.opacity);
        points.push([along.place(last.distance[1]), light.place(behind)]);
    }
    canvas.line(&points, 1.2, BLACK, &[5.0, 4.0]);
    let [_, right] = ACROSS;
    let dashed = "dashed: light that reaches the eye, 0 to 1";
    canvas.text([right, top - 10.0], dashed, Anchor::End);
}
