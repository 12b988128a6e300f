//! One pixel: its ray cell by cell, by the 64-bit referee, beside what the engine and every integrator make of it; as a table for a
//! terminal, CSV, JSON and a drawing.

mod plot;
mod text;

pub use plot::plot;
pub use text::{SHOWN, csv, json, text};

use crate::work_precision::{Numbers, Subject};
use std::sync::Arc;
use voltet_core::grid::{CellType, Grid};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, counted};
use voltet_cpu::cull;
use voltet_graph::{Graph, Observer, Session};
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
