//! One pixel: its ray cell by cell, by the 64-bit referee, beside what the engine and every integrator make of it; as a table for a
//! terminal, CSV, JSON and a drawing.

use crate::columns::{aligned, csv_cell};
use crate::work_precision::canvas::{Anchor, Axis, BLACK, Canvas, Color, hex};
use crate::work_precision::{Numbers, Subject};
use serde_json::{Value, json as object};
use std::fmt::Write;
use std::sync::Arc;
use voltet_core::grid::{CellType, Grid};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, agreeing, counted};
use voltet_cpu::cull;
use voltet_graph::{Graph, Observer, Session};
use voltet_io::encode::srgb_from_linear;
use voltet_optics::curved_axes::{CurvedAxes, integrate_values};
use voltet_optics::integrators::{Integrator, SegmentIntegrator};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Shading;
use voltet_optics::trace::{CellCrossing, Ray, SegmentIntegral, Tracer, Walk};
use voltet_optics::{Contribution, Segment};
use voltet_reference::{REFERENCE, tracer, widget_depths};

/// A pixel and the parts that it is made of.
#[derive(Debug, Clone)]
pub struct Pixel {
    pub node: String,
    /// Column from the left and row from the top, from 0.
    pub place: [u32; 2],
    pub size: [u32; 2],
    pub samples: u32,
    /// The one of them that is shown cell by cell, from 0.
    pub sample: u32,
    /// Origin and direction of the ray (world units).
    pub ray: [[f64; 3]; 2],
    pub walk: Walk,
    /// Optical depth of each widget by itself, for each cell of the ray.
    pub depths: Vec<Vec<f64>>,
    /// For each step of `walk` the cell of the file, and its type.
    pub cells: Vec<(usize, String)>,
    pub widgets: Vec<&'static str>,
    /// Names of the values at a cell's ends: s, g, further fields.
    pub names: Vec<String>,
    /// The pixel by the 64-bit referee: C, A.
    pub referee: [f64; 4],
    pub drawn: EnginePixel,
    pub integrators: Vec<IntegratorPixel>,
    /// Background of the picture where the pipeline writes it (linear RGB).
    pub background: [f64; 3],
    /// Reason why the ray shows nothing, where it does.
    pub nothing: Option<String>,
    /// Warnings of the nodes that feed the one that draws.
    pub warnings: Vec<String>,
}

#[derive(Debug, Clone)]
pub struct EnginePixel {
    pub engine: String,
    pub rgba: [f64; 4],
}

#[derive(Debug, Clone)]
pub struct IntegratorPixel {
    pub name: &'static str,
    pub numbers: String,
    /// True if it is the one that the pipeline draws with.
    pub own: bool,
    /// C, A; or why it has none.
    pub rgba: std::result::Result<[f64; 4], String>,
}

impl Pixel {
    /// The largest difference of a channel from the referee.
    pub fn difference(&self, rgba: [f64; 4]) -> f64 {
        (0..4).map(|c| (rgba[c] - self.referee[c]).abs()).fold(0.0, f64::max)
    }

    /// Each widget's share of a step's optical depth, where it has one: its place and the share.
    pub fn shares(depths: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let whole: f64 = depths.iter().sum();
        depths.iter().enumerate().filter(|(_, depth)| **depth > 0.0).map(move |(k, depth)| (k, depth / whole))
    }
}

/// Traces a pixel of the node that draws.
///
/// `node`: which one, where the pipeline has several; `sample`: which ray of the pixel. Errors: a place outside the picture, no
/// such ray; what goes wrong with the pipeline.
pub fn pixel(
    graph: &Graph,
    node: Option<&str>,
    place: [i64; 2],
    sample: u32,
    session: &mut Session,
    (observer, progress): (&dyn Observer, &dyn Progress),
) -> Result<Pixel> {
    let subject = Subject::gather(graph, node, false, session, observer)?;
    let Scene { camera, transfer_function, volume, .. } = &subject.scene;
    let place = inside(place, camera.size)?;
    if sample >= camera.samples {
        return Err(Error::usage("the pixel has no such ray")
            .got(format!("--sample {sample}"))
            .expected(format!("0 to {}", camera.samples - 1)));
    }
    let tracer = tracer(&subject.scene)?;
    let rays = tracer.rays(place);
    let referee = tracer.pixel(&rays)?;
    let ray = &rays[sample as usize];
    let walk = tracer.walk(ray)?;
    let depths = widget_depths(transfer_function, &walk.steps)?;
    let drawn = match subject.scene.shading.integrator == REFERENCE {
        // It would take minutes to draw the rest of the picture.
        true => EnginePixel { engine: "reference".into(), rgba: referee.map(|x| f64::from(x as f32)) },
        false => drawn(graph, &subject.node, place, session, observer)?,
    };
    let nothing = why_invisible(&tracer, ray, &walk, &subject.scene);
    let names = ["s".to_string(), "g".into()];
    let fields = transfer_function.fields();
    Ok(Pixel {
        place,
        size: camera.size,
        samples: camera.samples,
        sample,
        ray: tracer.world(ray),
        cells: source_cells(&volume.grid, &walk.steps),
        widgets: transfer_function.widgets.iter().map(|widget| widget.profile.name()).collect(),
        names: names.into_iter().chain(fields.iter().map(|name| name.to_string())).collect(),
        integrators: all_integrators(&subject.scene, &subject.integrators, &rays, progress)?,
        background: subject.background,
        node: subject.node.clone(),
        walk,
        depths,
        referee,
        drawn,
        nothing,
        warnings: subject.warnings,
    })
}

/// The place, where the picture has it.
fn inside([x, y]: [i64; 2], [width, height]: [u32; 2]) -> Result<[u32; 2]> {
    let within = |k: i64, count: u32| u32::try_from(k).ok().filter(|k| *k < count);
    match (within(x, width), within(y, height)) {
        (Some(x), Some(y)) => Ok([x, y]),
        _ => Err(Error::usage("the pixel lies outside the picture")
            .got(format!("X {x}, Y {y}"))
            .expected(format!("X 0 to {}, Y 0 to {}, from its upper left corner", width - 1, height - 1))),
    }
}

/// The pixel as the pipeline draws it, by the engine that it comes to.
fn drawn(
    graph: &Graph,
    node: &str,
    [x, y]: [u32; 2],
    session: &mut Session,
    observer: &dyn Observer,
) -> Result<EnginePixel> {
    let missing = || Error::run("the picture of the node that draws goes nowhere").at_node(node);
    let place = graph.nodes.iter().position(|known| known.name == node).ok_or_else(missing)?;
    let takes = |&&k: &&usize| graph.nodes[k].inputs.iter().any(|edge| edge.node == place);
    let taker = *graph.order.iter().find(takes).ok_or_else(missing)?;
    let edge = graph.nodes[taker].inputs.iter().position(|edge| edge.node == place).ok_or_else(missing)?;
    let (values, report) = session.feed(graph, taker, &Default::default(), observer)?;
    let picture: &Arc<Picture> =
        values.get(edge).and_then(voltet_graph::Value::picture).ok_or_else(missing)?;
    let engine = report.engine.map(|(engine, _)| engine).unwrap_or_else(|| "the stages".into());
    let engine = [Some(engine), report.adapter].into_iter().flatten().collect::<Vec<_>>().join(", ");
    Ok(EnginePixel { engine, rgba: picture.pixel(x as usize, y as usize).map(f64::from) })
}

fn source_cells(grid: &Grid, steps: &[CellCrossing]) -> Vec<(usize, String)> {
    steps.iter().map(|step| (grid.source_cell(step.cell as usize), kind(grid, step.cell as usize))).collect()
}

/// Type of the cell that a tetrahedron is a part of. A grid keeps its file's cells by number only: where these are of several
/// types, the number of points tells which this is, or leaves some to choose from.
fn kind(grid: &Grid, tetrahedron: usize) -> String {
    let types = grid.origin.cells_by_type.keys().filter_map(|&code| CellType::from_code(code));
    let solid: Vec<&CellType> = types.filter(|kind| kind.dimension == 3).collect();
    let fitting: Vec<&str> = match solid.as_slice() {
        [one] => vec![one.name],
        several => {
            let count = point_count(grid, tetrahedron);
            let fits = |kind: &&&CellType| kind.point_count.is_none_or(|n| usize::from(n) == count);
            several.iter().filter(fits).map(|kind| kind.name).collect()
        }
    };
    if fitting.is_empty() { "tetrahedron".into() } else { fitting.join(" or ") }
}

/// Points of the cell that a tetrahedron is a part of. Tetrahedra of one cell stand together.
fn point_count(grid: &Grid, tetrahedron: usize) -> usize {
    let cell = grid.source_cell(tetrahedron);
    let same = |&k: &usize| grid.source_cell(k) == cell;
    let before = (0..tetrahedron).rev().take_while(same);
    let parts = before.chain((tetrahedron..grid.tetrahedra.len()).take_while(same));
    let mut points: Vec<u32> = parts.flat_map(|k| grid.tetrahedra[k]).collect();
    points.sort_unstable();
    points.dedup();
    points.len()
}

/// Entries a side of tables of three dimensions, where the pipeline does not say: such a table is built in a second.
const CUBE_SIDE: usize = 64;

/// The pixel by each of the integrators. Those that the pipeline does not draw with have their default numbers.
fn all_integrators(
    scene: &Scene,
    integrators: &[Integrator],
    rays: &[Ray],
    progress: &dyn Progress,
) -> Result<Vec<IntegratorPixel>> {
    let own = scene.shading.integrator;
    // The cells that the native engine draws decide what an integrator's tables hold.
    let cells = cull(&scene.volume, &scene.transfer_function, &scene.camera, progress)?;
    let mut all = Vec::new();
    for (number, kind) in integrators.iter().enumerate() {
        progress.check_cancelled()?;
        progress.report("integrators", number as f64 / integrators.len() as f64);
        let is_own = kind.is_kind_of(&own);
        let integrator = match is_own {
            true => own,
            false if kind.has_table_of_lengths() => kind.with("table_size", CUBE_SIDE as f64),
            false => *kind,
        };
        let shading = Shading { integrator, ..scene.shading };
        let ready = voltet_cpu::integrator(&cells, &scene.transfer_function, &shading);
        let rgba = ready.and_then(|ready| {
            Tracer::new(scene, Box::new(Integrated(ready, CurvedAxes::new(&scene.transfer_function))))?
                .pixel(rays)
        });
        // The reason, without alternatives.
        let rgba = rgba.map_err(|error| error.got.unwrap_or(error.what));
        let numbers = Numbers::of(&integrator).labels().join(", ");
        all.push(IntegratorPixel { name: integrator.name(), numbers, own: is_own, rgba });
    }
    Ok(all)
}

/// An integrator as rays ask for it.
struct Integrated(Box<dyn SegmentIntegrator>, Option<CurvedAxes>);

impl SegmentIntegral for Integrated {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        let Integrated(integrator, axes) = self;
        let crossing = Segment::of_values(length, front, back);
        let part = integrate_values(axes.as_ref(), &crossing, |segment| integrator.integrate(segment));
        integrator.failure().map_or(Ok(part), |error| Err(error.clone()))
    }
}

/// Smallest linear value that shows in 8 bits of sRGB, which is 12.92 times as steep there.
const MIN_SHOWN: f64 = 0.5 / 255.0 / 12.92;

/// A sentence for a ray without opacity and colour that show; `None` for others.
fn why_invisible(tracer: &Tracer, ray: &Ray, walk: &Walk, scene: &Scene) -> Option<String> {
    let most = walk.seen.color.iter().copied().fold(walk.seen.opacity, f64::max);
    if most >= MIN_SHOWN {
        return None;
    }
    if walk.steps.is_empty() {
        let cut = tracer.cut_away(ray);
        return Some(match cut {
            0 => "the ray meets no cell of the grid".into(),
            1 => "the one cell on the ray lies before the near plane".into(),
            cut => format!("all {cut} cells on the ray lie before the near plane"),
        });
    }
    let range = |q: usize| {
        let values = walk.steps.iter().flat_map(|step| [step.front[q], step.back[q]]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        format!("{low:.6} to {high:.6}")
    };
    let met = format!("the ray crosses {} with s from {}", counted(walk.steps.len(), "cell"), range(0));
    let met = match scene.transfer_function.uses_gradient_magnitude() {
        true => format!("{met} and g from {}", range(1)),
        false => met,
    };
    let depth: f64 = walk.steps.iter().map(|step| step.part.optical_depth).sum();
    Some(match () {
        () if scene.transfer_function.widgets.is_empty() => {
            format!("{met}; the transfer function has no widgets")
        }
        () if depth < MIN_SHOWN && most > 0.0 => {
            format!("{met}, where the widgets hardly absorb: an optical depth of {depth:.3e} in all")
        }
        () if depth > 0.0 => format!("{met}; silhouettes take most of its optical depth of {depth:.3e}"),
        () => format!("{met}; no widget takes any of these values"),
    })
}

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
