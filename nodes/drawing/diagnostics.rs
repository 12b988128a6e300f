//! Findings of the nodes that draw: counts of a picture, whatever engine counted them; bands of the transfer function that are finer than
//! the cells; parts of a scene that a picture does not show, with the reason and the remedy.

use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;
use std::sync::Arc;
use voltet_core::grid::extent;
use voltet_core::picture::Picture;
use voltet_core::probing::{BandCounts, bands};
use voltet_core::transfer::{ColorSource, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_core::{Result, SharedSlice, agreeing, counted};
use voltet_graph::{Diagnostics, RunContext, SavedWork};
use voltet_optics::engine::RenderStats;
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;

/// Notes what was counted: of a whole picture, or of one stage.
pub fn note(call: &mut RunContext, counts: &RenderStats) {
    let notes = &mut call.notes;
    let culled = counts.culled_by_transfer_function.zip(counts.culled_by_frustum).map(|(a, b)| a + b);
    for (name, count) in [
        ("cells_culled", culled),
        ("cells_projected", counts.cells_projected),
        ("segments", counts.segments),
        ("segments_exact", counts.segments_exact),
        ("evaluations", counts.evaluations),
        ("pixels_disordered", counts.pixels_disordered),
        ("tiles_stopped", counts.tiles_stopped),
        ("tables_built", counts.tables_built),
    ] {
        notes.counts.extend(count.map(|count| (name, count)));
    }
    if let Some(count @ 1..) = counts.pixels_disordered {
        let (pixels, were) = (counted(count, "pixel"), agreeing(&count, "was", "were"));
        notes.warnings.push(format!("{pixels} {were} composited in an order that is not exact"));
    }
    for (which, why, count) in [
        ("that show nothing", "no widget touches their values", counts.culled_by_transfer_function),
        ("out of view", "they lie outside the view", counts.culled_by_frustum),
        ("under a pixel's reach", "they cover no pixel centre", counts.under_a_pixel),
    ] {
        if let Some(count @ 1..) = count {
            notes.record_skipped(format!("cells {which}"), why, Some(SavedWork::Cells(count)));
        }
    }
    if let Some(tiles @ 1..) = counts.tiles_stopped {
        let what = format!("cells of {} that stopped early", counted(tiles, "tile"));
        let saving = counts.cells_hidden.map(SavedWork::Cells);
        notes.record_skipped(what, "every pixel of the tile is opaque", saving);
    }
}

/// Records that no order is needed; `segment_count`: of the segments that are not sorted, where it is known.
pub fn record_unsorted(notes: &mut Diagnostics, segment_count: Option<u64>) {
    let why = "one colour and no light: the picture does not depend on the order";
    notes.record_skipped("visibility order", why, segment_count.map(SavedWork::Segments));
}

/// Notes that a picture needed no order.
pub fn note_unsorted(call: &mut RunContext, scene: &Scene, counts: &RenderStats) {
    if scene.ordering(call.exhaustive()) == Ordering::Independent {
        record_unsorted(&mut call.notes, counts.segments);
    }
}

/// Band counts of one transfer function over one volume, kept between runs.
struct VolumeBands {
    scalar: SharedSlice<f64>,
    gradient_magnitude: Option<SharedSlice<f64>>,
    bands: Vec<BandCounts>,
}

impl VolumeBands {
    fn is_of(&self, volume: &Volume) -> bool {
        let (own, other) = (&self.gradient_magnitude, &volume.gradient_magnitude);
        let same_g =
            own.as_ref().zip(other.as_ref()).map_or(own.is_none() && other.is_none(), |(a, b)| a.is(b));
        self.scalar.is(&volume.scalar) && same_g
    }
}

/// Notes how many bands of each wave widget the cells cross. The transfer function is that at the input
/// `transfer_function`.
pub fn note_bands(
    call: &mut RunContext,
    volume: &Volume,
    transfer_function: &TransferFunction,
) -> Result<()> {
    let make = || {
        let bands = bands(volume, transfer_function)?;
        let (scalar, gradient_magnitude) = (volume.scalar.clone(), volume.gradient_magnitude.clone());
        Ok(VolumeBands { scalar, gradient_magnitude, bands })
    };
    let kept = call.keep(call.revision("transfer_function")?, make)?;
    // One transfer function may draw several volumes.
    let kept = if kept.is_of(volume) { kept } else { Arc::new(make()?) };
    for bands in &kept.bands {
        call.notes.find(sentence(bands), figures(bands));
    }
    Ok(())
}

fn sentence(bands: &BandCounts) -> String {
    let BandCounts { widget, kind, cell_count, median, percent_99, max: most, share_above_one } = bands;
    let finer = match *share_above_one > 0.0 {
        true => format!(
            "{:.2} % cross more than one, where the picture is finer than the grid",
            100.0 * share_above_one
        ),
        false => "none crosses more than one".to_string(),
    };
    format!(
        "bands of widget {widget} ({kind}): of {} half cross at most {median:.3}, 99 % at most {percent_99:.3}, the \
         widest {most:.3}; {finer}",
        counted(*cell_count, "cell")
    )
}

fn figures(bands: &BandCounts) -> serde_json::Value {
    json!({ "bands": {
        "widget": bands.widget,
        "kind": bands.kind,
        "cells": bands.cell_count,
        "median": bands.median,
        "percent_99": bands.percent_99,
        "most": bands.max,
        "share_above_one": bands.share_above_one,
    }})
}

/// Less than this in every channel is nothing in 8 bits; this near to 1, opaque.
const STEP: f32 = 1.0 / 255.0;

/// The share of the pixels that show something from which on a picture counts as opaque: at outlines rays are short.
const OPAQUE_SHARE: f64 = 0.999;

/// Warnings about a picture that shows nothing, next to nothing or only the front, and about colours beyond the usual range.
pub fn warnings(scene: &Scene, counts: &RenderStats, picture: &Picture) -> Vec<String> {
    let mut warnings = too_bright(scene);
    let widgets = &scene.transfer_function.widgets;
    let Some(seen) = PictureStatistics::from_picture(picture).filter(|_| !widgets.is_empty()) else {
        return warnings;
    };
    // An empty picture says why it is.
    warnings.extend(beside_values(scene).filter(|_| seen.max > 0.0));
    warnings.extend(match seen.max {
        0.0 => Some(format!("the picture is empty: {}", why_empty(scene, counts))),
        most if most < STEP => Some(nearly_empty(most, seen.opacity)),
        _ if scene.surfaces.is_empty() && seen.opaque as f64 >= OPAQUE_SHARE * seen.shown as f64 => Some(
            "every pixel that shows anything is opaque: what lies behind the first cells is hidden. A smaller extinction or a \
             larger unit_distance shows the inside"
                .into(),
        ),
        _ => None,
    });
    warnings
}

/// The words for widgets that all lie beside the values of the scalar: they were made for another, as a rule.
fn beside_values(scene: &Scene) -> Option<String> {
    let scalar = &scene.volume.scalar;
    let drawn = scene.transfer_function.widgets.iter().filter(|widget| widget.is_drawn());
    let axis = scene.transfer_function.axes[0];
    let values = |widget: &Widget| widget.scalar_range().map(|position| axis.value(position));
    let ranges: Vec<[f64; 2]> = drawn.map(values).collect();
    // The first values tell that a widget is not: all are looked at only where it is.
    let some = |holds: &dyn Fn(f64) -> bool| scalar.iter().any(|&s| s.is_finite() && holds(s));
    let is_beside = |&[first, last]: &[f64; 2]| !(some(&|s| s <= last) && some(&|s| first <= s));
    if ranges.is_empty() || !ranges.iter().all(is_beside) {
        return None;
    }
    let ([low, high], [first, last]) = (extent::range(scalar)?, extent::range(ranges.as_flattened())?);
    let name = &scene.volume.grid.scalar_name;
    Some(format!(
        "every widget lies outside the values of '{name}': these are from {low} to {high}, the widgets from {first} to {last}. \
         Were they made for another array? `voltet info` shows ranges, the node histogram where the volume lies"
    ))
}

struct PictureStatistics {
    /// The largest opacity or channel of any pixel.
    max: f32,
    opacity: f32,
    /// Pixels that hold anything.
    shown: usize,
    /// Pixels that hide what is behind them.
    opaque: usize,
}

impl PictureStatistics {
    /// `None` for a picture without pixels.
    fn from_picture(picture: &Picture) -> Option<PictureStatistics> {
        let of_pixel = |pixel: &[f32; 4]| {
            let most = pixel.iter().copied().fold(0.0, f32::max);
            let [shown, opaque] = [most > 0.0, pixel[3] > 1.0 - STEP].map(usize::from);
            PictureStatistics { max: most, opacity: pixel[3], shown, opaque }
        };
        picture.rgba.par_iter().map(of_pixel).reduce_with(|a, b| PictureStatistics {
            max: a.max.max(b.max),
            opacity: a.opacity.max(b.opacity),
            shown: a.shown + b.shown,
            opaque: a.opaque + b.opaque,
        })
    }
}

fn nearly_empty(most: f32, opacity: f32) -> String {
    let text =
        format!("the picture is nearly empty: no pixel reaches 1/255 (the largest opacity is {most:.1e})");
    // Optical depth is in proportion to the extinction; half opaque is ln 2 of it.
    let depth = -f64::from(-opacity).ln_1p();
    match depth > 0.0 {
        true => {
            let factor = std::f64::consts::LN_2 / depth;
            format!("{text}. With {factor:.1e} times the extinction its densest pixel is half opaque")
        }
        false => format!("{text}. A larger extinction or a smaller unit_distance shows more"),
    }
}

/// The reason for an empty picture, and the remedy. The transfer function has widgets.
fn why_empty(scene: &Scene, counts: &RenderStats) -> String {
    let widgets = &scene.transfer_function.widgets;
    if !widgets.iter().any(|widget| widget.is_drawn()) {
        // Colours over the range of values that are all the same are one point, at the beginning of the ramp of opacity.
        let is_one = |widget: &Widget| matches!(widget.profile.properties().color, ColorSource::Points([_]));
        return match extent::range(&scene.volume.scalar) {
            Some([low, high]) if low == high && widgets.iter().any(is_one) => format!(
                "every value of '{}' is {low}, where the opacity of a colour map begins. It shows them with opacity = \"constant\", or \
                 with a range that begins below them",
                scene.volume.grid.scalar_name
            ),
            _ => "the extinction of every widget is 0. Give one an extinction above it".into(),
        };
    }
    let is_kept = |p: &DVec3| scene.clips.iter().all(|clip| clip.keeps(*p));
    if !scene.clips.is_empty() && !scene.volume.grid.points.par_iter().any(is_kept) {
        return "no point of the grid lies where all of the clips keep the volume; an inverted clip keeps what is outside".into();
    }
    let total = scene.volume.grid.tetrahedra.len() as u64;
    let cells = counted(total, "cell");
    let untouched = counts.culled_by_transfer_function.unwrap_or(0);
    let out_of_view = counts.culled_by_frustum.unwrap_or(0);
    let values = || values(scene);
    if untouched == total {
        if let Some(why) = beside_values(scene) {
            return why;
        }
        return format!(
            "no widget reaches any of the {cells} ({}). Move the widgets there; `voltet info` shows ranges, the node \
             histogram where the volume lies",
            values()
        );
    }
    if untouched + out_of_view == total {
        let rest = match untouched {
            0 => format!("all {cells} lie out of the camera's view"),
            _ => format!(
                "no widget reaches {untouched} of the {cells} ({}), and the others lie out of the camera's view",
                values()
            ),
        };
        return format!("{rest}. Look {}", where_to_look(scene));
    }
    if counts.cells_projected == Some(0) || counts.segments == Some(0) {
        return format!(
            "no cell covers the middle of a pixel. Come nearer, or look {}",
            where_to_look(scene)
        );
    }
    "the opacity of every segment rounds to 0. A larger extinction or a smaller unit_distance shows them"
        .into()
}

/// The ranges of what the widgets look at.
fn values(scene: &Scene) -> String {
    let volume = &scene.volume;
    let range = |name: &str, values: &[f64]| match extent::range(values) {
        Some([low, high]) => format!("{name} lies within [{low}, {high}]"),
        None => format!("{name} is nowhere finite"),
    };
    let mut ranges = vec![range("s", &volume.scalar)];
    if scene.transfer_function.uses_gradient_magnitude() {
        ranges.extend(volume.gradient_magnitude.iter().map(|g| range("g", g)));
    }
    let fields = scene.transfer_function.fields().into_iter();
    let known = fields.filter_map(|name| Some((name, volume.grid.point_arrays.get(name)?)));
    ranges.extend(known.map(|(name, array)| range(&format!("\"{name}\""), &array.values)));
    ranges.join(", ")
}

fn where_to_look(scene: &Scene) -> String {
    let Some([low, high]) = scene.volume.grid.bounds() else { return "at the grid".into() };
    let vector = |v: DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    format!(
        "at the grid, which reaches from {} to {}: target = {}",
        vector(low),
        vector(high),
        vector(0.5 * low + 0.5 * high)
    )
}

/// Widgets whose colours are brighter than white.
fn too_bright(scene: &Scene) -> Vec<String> {
    let widgets = scene.transfer_function.widgets.iter().enumerate();
    let bright =
        widgets.map(|(i, widget)| (i, widget.max_emission())).filter(|(_, brightest)| *brightest > 1.0);
    let said = |(i, brightest): (usize, f64)| {
        let meant = match brightest > 2.0 && brightest <= 255.0 {
            true => "; was 0 to 255 meant? Then (c / 255)^2.2 is about the linear one",
            false => "",
        };
        format!(
            "a colour of widgets[{i}] has a component of {brightest}: linear RGB, brighter than white above 1{meant}"
        )
    };
    bright.map(said).collect()
}
