//! A pixel for programs: the cells as CSV, everything as JSON.

use super::record::Pixel;
use serde_json::{Value, json as object};
use std::fmt::Write;

/// The cells of the ray, one a line, all of them. Numbers have all their digits; lengths are in world units.
pub fn csv(pixel: &Pixel) -> String {
    let quoted = |name: &str| match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_string(),
    };
    let mut text = String::from("number,entry,exit,length,cell,cell_type,tetrahedron");
    for name in &pixel.names {
        text += &format!(",{0},{1}", quoted(&format!("{name}_entry")), quoted(&format!("{name}_exit")));
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

/// Everything.
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
