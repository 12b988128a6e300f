//! A pixel as a table for a terminal, CSV and JSON.

use super::Pixel;
use crate::columns::{aligned, csv_cell};
use crate::work_precision::canvas::hex;
use serde_json::{Value, json as object};
use std::fmt::Write;
use voltet_core::{agreeing, counted};
use voltet_io::encode::srgb_from_linear;
use voltet_optics::trace::CellCrossing;

/// Cells that are shown where a ray crosses more and not all are asked for.
pub const SHOWN: usize = 24;

/// The pixel in words and tables. `all`: every cell of the ray, not only the [`SHOWN`] that add most.
pub fn text(pixel: &Pixel, all: bool) -> String {
    let Pixel { node, place: [x, y], size: [width, height], samples, sample, ray, walk, .. } = pixel;
    let mut text = format!("pixel X {x}, Y {y} of {width} × {height}, drawn by '{node}'\n");
    if *samples > 1 {
        text += &format!("ray {sample} of its rays 0 to {}; the pixel is the mean of all\n", samples - 1);
    }
    let vector = |v: [f64; 3]| v.map(number).join(", ");
    text += &format!("ray from ({}) along ({})\n", vector(ray[0]), vector(ray[1]));
    if let Some(why) = &pixel.nothing {
        text += &format!("nothing to be seen: {why}\n");
    }
    let shown = shown(&walk.steps, if all { usize::MAX } else { SHOWN });
    if !shown.is_empty() {
        text += &format!("\n{}", cells(pixel, &shown));
    }
    text += &left_out(pixel, &shown);
    text += &format!("\n{}", sums(pixel));
    text
}

/// The places of the steps that add most, in the order of the ray.
fn shown(steps: &[CellCrossing], most: usize) -> Vec<usize> {
    let mut places: Vec<usize> = (0..steps.len()).collect();
    if places.len() > most {
        let adds = |k: usize| steps[k].contribution().into_iter().fold(0.0, f64::max);
        places.sort_by(|&a, &b| adds(b).total_cmp(&adds(a)));
        places.truncate(most);
        places.sort_unstable();
    }
    places
}

fn left_out(pixel: &Pixel, shown: &[usize]) -> String {
    let mut text = String::new();
    let steps = &pixel.walk.steps;
    let rest = steps.iter().enumerate().filter(|(k, _)| !shown.contains(k));
    let (count, sum) = rest.fold((0, [0.0; 4]), |(count, sum), (_, step)| {
        let adds = step.contribution();
        (count + 1, std::array::from_fn(|c| sum[c] + adds[c]))
    });
    if count > 0 {
        let [r, g, b, a] = sum.map(number);
        let (cells, add) = (counted(count, "cell"), agreeing(&count, "adds less is", "add less are"));
        let them = agreeing(&count, "it", "them");
        text += &format!("{cells} that {add} left out, together {r} {g} {b} {a}; --all shows {them}\n");
    }
    if pixel.walk.hidden > 0 {
        let (cells, are) = (counted(pixel.walk.hidden, "cell"), agreeing(&pixel.walk.hidden, "is", "are"));
        text += &format!("{cells} behind these {are} hidden by them\n");
    }
    text
}

fn cells(pixel: &Pixel, shown: &[usize]) -> String {
    let steps = &pixel.walk.steps;
    let looks = |of: &dyn Fn(&CellCrossing) -> bool| steps.iter().any(of);
    let has_g = looks(&|step| step.front[1] != 0.0 || step.back[1] != 0.0);
    let (silhouettes, lit) = (looks(&|step| step.silhouette != 1.0), looks(&|step| step.light != 1.0));
    let mut head: Vec<String> =
        ["#", "entry", "exit", "length", "cell", "tetrahedron"].map(String::from).into();
    let values: Vec<usize> = (0..pixel.names.len()).filter(|&q| q != 1 || has_g).collect();
    head.extend(values.iter().map(|&q| pixel.names[q].clone()));
    head.extend(["widgets", "depth", "opacity"].map(String::from));
    head.extend(silhouettes.then(|| "silhouette".into()));
    head.extend(lit.then(|| "light".into()));
    head.extend(["colour", "reaches eye", "adds r", "g", "b", "a"].map(String::from));
    let mut rows = vec![head];
    for &k in shown {
        let (step, (cell, kind)) = (&steps[k], &pixel.cells[k]);
        let [entry, exit] = step.distance.map(number);
        let mut row = vec![k.to_string(), entry, exit, number(step.length), format!("{kind} {cell}")];
        row.push(step.cell.to_string());
        row.extend(values.iter().map(|&q| format!("{} to {}", number(step.front[q]), number(step.back[q]))));
        row.push(widgets(pixel, &pixel.depths[k]));
        row.extend([step.part.optical_depth, step.part.opacity].map(number));
        row.extend(silhouettes.then(|| number(step.silhouette)));
        row.extend(lit.then(|| number(step.light)));
        row.push(own_color(step));
        row.push(number(step.transmittance));
        row.extend(step.contribution().map(number));
        rows.push(row);
    }
    table(&rows)
}

/// Shares of the optical depth under this are not shown.
const NOTABLE: f64 = 1e-3;

/// The widgets met, the most first, each with its share of the optical depth where there are several.
fn widgets(pixel: &Pixel, depths: &[f64]) -> String {
    let mut met: Vec<(usize, f64)> = Pixel::shares(depths).filter(|(_, share)| *share >= NOTABLE).collect();
    met.sort_by(|a, b| b.1.total_cmp(&a.1));
    let one = met.len() == 1;
    let name = |&(k, share): &(usize, f64)| match one {
        true => format!("{k} {}", pixel.widgets[k]),
        false => format!("{k} {} {:.1}%", pixel.widgets[k], 100.0 * share),
    };
    if met.is_empty() { "none".into() } else { met.iter().map(name).collect::<Vec<_>>().join(", ") }
}

fn own_color(step: &CellCrossing) -> String {
    let opacity = step.part.opacity;
    if opacity > 0.0 { hex(srgb(step.part.color.map(|c| c / opacity))) } else { String::new() }
}

/// The pixel by the reference, as drawn, and by each integrator.
fn sums(pixel: &Pixel) -> String {
    let row = |name: String, rgba: [f64; 4], of: Option<f64>| {
        let mut row = vec![name];
        row.extend(rgba.map(|x| format!("{x:.7}")));
        let over: [f64; 3] = std::array::from_fn(|c| rgba[c] + (1.0 - rgba[3]) * pixel.background[c]);
        row.push(hex(srgb(over)));
        row.push(of.map(|difference| format!("{difference:.1e}")).unwrap_or_default());
        row
    };
    let head = ["", "r", "g", "b", "a", "shown", "from the referee"].map(String::from).to_vec();
    let mut rows = vec![head];
    let [r, g, b] = pixel.walk.seen.color;
    rows.push(row("this ray".into(), [r, g, b, pixel.walk.seen.opacity], None));
    rows.push(row("the pixel by the 64-bit referee".into(), pixel.referee, None));
    let drawn = &pixel.drawn;
    rows.push(row(format!("as drawn ({})", drawn.engine), drawn.rgba, Some(pixel.difference(drawn.rgba))));
    let mut cannot = String::new();
    for said in &pixel.integrators {
        let parts = [said.name, &said.numbers, if said.own { "the pipeline's" } else { "" }];
        let name = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
        match &said.rgba {
            Ok(rgba) => rows.push(row(name, *rgba, Some(pixel.difference(*rgba)))),
            Err(why) => cannot += &format!("{name}: cannot, {why}\n"),
        }
    }
    table(&rows) + &cannot
}

/// Linear colour in 8 bits of sRGB.
pub(super) fn srgb(linear: [f64; 3]) -> [u8; 3] {
    linear.map(|c| (srgb_from_linear(c.clamp(0.0, 1.0) as f32) * 255.0).round() as u8)
}

/// A number with five digits.
pub(super) fn number(x: f64) -> String {
    let size = x.abs();
    match () {
        () if x == 0.0 => "0".into(),
        () if !(1e-3..1e6).contains(&size) => format!("{x:.3e}"),
        // Five digits.
        () => {
            let before = size.log10().floor() as i32;
            let text = format!("{x:.*}", (4 - before).max(0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
                false => text,
            }
        }
    }
}

/// Rows in columns, those of numbers alone to the right. The first row is the head.
fn table(rows: &[Vec<String>]) -> String {
    let is_number = |text: &str| text.is_empty() || text.parse::<f64>().is_ok();
    aligned(rows, |c| !rows[1..].iter().all(|row| is_number(&row[c])))
}

/// The cells of the ray, one a line, all of them. Numbers have all their digits; lengths are in world units.
pub fn csv(pixel: &Pixel) -> String {
    let mut text = String::from("number,entry,exit,length,cell,cell_type,tetrahedron");
    for name in &pixel.names {
        text += &format!(",{0},{1}", csv_cell(&format!("{name}_entry")), csv_cell(&format!("{name}_exit")));
    }
    for (k, kind) in pixel.widgets.iter().enumerate() {
        text += &format!(",depth_{k}_{kind}");
    }
    text += ",optical_depth,silhouette,light,red,green,blue,opacity,transmittance";
    text += ",adds_red,adds_green,adds_blue,adds_opacity\n";
    for (k, (step, (cell, kind))) in pixel.walk.steps.iter().zip(&pixel.cells).enumerate() {
        let depths = &pixel.depths[k];
        let [entry, exit] = step.distance;
        // Writing to a String cannot fail.
        let _ = write!(text, "{k},{entry},{exit},{},{cell},{kind},{}", step.length, step.cell);
        let values = step.front.iter().zip(&step.back).flat_map(|(front, back)| [*front, *back]);
        let [r, g, b] = step.part.color;
        let rest = [step.part.optical_depth, step.silhouette, step.light, r, g, b, step.part.opacity];
        let adds = step.contribution();
        let all = values.chain(depths.iter().copied()).chain(rest).chain([step.transmittance]).chain(adds);
        for value in all {
            let _ = write!(text, ",{value}");
        }
        text += "\n";
    }
    text
}

pub fn json(pixel: &Pixel) -> Value {
    let cells = (0..pixel.walk.steps.len()).map(|k| cell_value(pixel, k));
    let said = pixel.integrators.iter().map(|said| {
        let (rgba, why) = (said.rgba.as_ref().ok(), said.rgba.as_ref().err());
        object!({
            "integrator": said.name, "numbers": said.numbers, "pipeline": said.own, "rgba": rgba,
            "difference": rgba.map(|rgba| pixel.difference(*rgba)), "why_not": why,
        })
    });
    let [r, g, b] = pixel.walk.seen.color;
    object!({
        "node": pixel.node, "x": pixel.place[0], "y": pixel.place[1], "size": pixel.size,
        "samples": pixel.samples, "sample": pixel.sample,
        "ray": { "origin": pixel.ray[0], "direction": pixel.ray[1] },
        "widgets": pixel.widgets, "nothing": pixel.nothing,
        "cells": cells.collect::<Vec<_>>(), "hidden_cells": pixel.walk.hidden,
        "ray_rgba": [r, g, b, pixel.walk.seen.opacity],
        "referee_rgba": pixel.referee,
        "drawn": {
            "engine": pixel.drawn.engine, "rgba": pixel.drawn.rgba, "difference": pixel.difference(pixel.drawn.rgba),
        },
        "integrators": said.collect::<Vec<_>>(),
    })
}

fn cell_value(pixel: &Pixel, k: usize) -> Value {
    let (step, depths, (cell, kind)) = (&pixel.walk.steps[k], &pixel.depths[k], &pixel.cells[k]);
    let values = |ends: &[f64]| -> serde_json::Map<String, Value> {
        pixel.names.iter().zip(ends).map(|(name, value)| (name.clone(), (*value).into())).collect()
    };
    let widgets = Pixel::shares(depths).map(|(k, share)| {
        object!({ "widget": k, "kind": pixel.widgets[k], "optical_depth": depths[k], "share": share })
    });
    object!({
        "cell": cell, "cell_type": kind, "tetrahedron": step.cell,
        "entry": step.distance[0], "exit": step.distance[1], "length": step.length,
        "at_entry": values(&step.front), "at_exit": values(&step.back),
        "widgets": widgets.collect::<Vec<_>>(),
        "optical_depth": step.part.optical_depth, "opacity": step.part.opacity, "color": step.part.color,
        "silhouette": step.silhouette, "light": step.light, "transmittance": step.transmittance,
        "adds": step.contribution(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_five_digits_and_no_idle_ones() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (-0.5, "-0.5"),
            (123.456789, "123.46"),
            (99999.0, "99999"),
            (123456.7, "123457"),
            (0.00123456, "0.0012346"),
            (1.5e-7, "1.500e-7"),
            (2e9, "2.000e9"),
            (1200.0, "1200"),
        ] {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn columns_of_numbers_stand_to_the_right() {
        let rows = [["#", "what"], ["1", "a"], ["23", ""]].map(|row| row.map(String::from).to_vec());
        assert_eq!(table(&rows), " #  what\n 1  a\n23\n");
    }
}
