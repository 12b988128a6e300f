//! One pixel traced: its ray cell by cell, the pixel by the 64-bit referee, by the engine and by every integrator.

use crate::work_precision::{Numbers, Subject};
use std::sync::Arc;
use voltet_core::grid::{CellType, Grid};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_graph::{Graph, Observer, Session, Value};
use voltet_optics::Segment;
use voltet_optics::compositing::Composite;
use voltet_optics::integrators::{Integrator, SegmentIntegrator};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Shading;
use voltet_optics::trace::{CellCrossing, Ray, TracedRay, Tracer, Walk};
use voltet_reference::{REFERENCE, tracer, widget_depths};

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
    /// For each of its steps the file's own cell, and what that is.
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

fn mean(rays: impl ExactSizeIterator<Item = [f64; 4]>) -> [f64; 4] {
    let count = rays.len() as f64;
    rays.fold([0.0; 4], |sum, ray| std::array::from_fn(|c| sum[c] + ray[c] / count))
}

/// The node that draws, traced.
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
    let seen = rays.iter().map(|ray| tracer.trace(ray)).collect::<Result<Vec<TracedRay>>>()?;
    let of = |seen: &TracedRay| [seen.color[0], seen.color[1], seen.color[2], seen.opacity];
    let referee = mean(seen.iter().map(of));
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
        integrators: all_integrators(&subject.scene, &subject.integrators, &tracer, &rays, progress)?,
        background: subject.background,
        node: subject.node.clone(),
        walk,
        depths,
        referee,
        drawn,
        nothing,
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
    let Some(Value::Image(picture)) = values.get(edge) else { return Err(missing()) };
    let picture: &Arc<Picture> = picture;
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

/// All of them, in their order. Those that the pipeline does not draw with have the numbers that it would have by default.
fn all_integrators(
    scene: &Scene,
    integrators: &[Integrator],
    tracer: &Tracer,
    rays: &[Ray],
    progress: &dyn Progress,
) -> Result<Vec<IntegratorPixel>> {
    let own = scene.shading.integrator;
    let segments: Vec<Vec<Traced>> = rays.iter().map(|ray| traced(tracer, ray)).collect();
    let alone = voltet_introspect::SegmentProbe::new(scene, progress)?;
    let mut all = Vec::new();
    for (number, kind) in integrators.iter().enumerate() {
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        progress.report("integrators", number as f64 / integrators.len() as f64);
        let is_own = kind.is_kind_of(&own);
        let integrator = if is_own { own } else { usual(kind) };
        let ready = alone.integrator(&Shading { integrator, ..scene.shading });
        let rgba = ready.and_then(|ready| composite_rays(ready.as_ref(), &segments)).map_err(why);
        let numbers = Numbers::of(&integrator).labels().join(", ");
        all.push(IntegratorPixel { name: integrator.name(), numbers, own: is_own, rgba });
    }
    Ok(all)
}

/// Reason why an integrator is not supported, without alternatives.
fn why(error: Error) -> String {
    error.got.unwrap_or(error.what)
}

/// A segment with the factors of its opacity and colour.
struct Traced {
    length: f64,
    ends: [Vec<f64>; 2],
    surface: [f64; 2],
}

fn traced(tracer: &Tracer, ray: &Ray) -> Vec<Traced> {
    let of = |crossing| {
        let (length, ends) = tracer.segment(ray, crossing);
        Traced { length, ends, surface: tracer.surface(ray, crossing) }
    };
    tracer.crossings(ray).iter().map(of).collect()
}

fn composite_rays(integrator: &dyn SegmentIntegrator, rays: &[Vec<Traced>]) -> Result<[f64; 4]> {
    let of = |ray: &Vec<Traced>| {
        let mut sum = Composite::default();
        for Traced { length, ends: [front, back], surface: [silhouette, light] } in ray {
            let part = integrator.integrate(&Segment {
                length: *length,
                front: [front[0], front[1]],
                back: [back[0], back[1]],
                fields_front: &front[2..],
                fields_back: &back[2..],
            });
            sum.add(part.color.map(|c| c * silhouette * light), part.opacity * silhouette);
        }
        let [r, g, b] = sum.color;
        [r, g, b, sum.opacity()]
    };
    let pixel = mean(rays.iter().map(of));
    match integrator.failure() {
        Some(error) => Err(error.clone()),
        None => Ok(pixel),
    }
}

/// An integrator with the settings that a pipeline does not state.
fn usual(kind: &Integrator) -> Integrator {
    match kind.has_table_of_lengths() {
        true => kind.with("table_size", CUBE_SIDE as f64),
        false => *kind,
    }
}

/// Smallest value that shows in 8 bits.
const HALF_STEP: f64 = 0.5 / 255.0;

/// A sentence for a ray without opacity and colour that show; `None` for others.
fn why_invisible(tracer: &Tracer, ray: &Ray, walk: &Walk, scene: &Scene) -> Option<String> {
    let most = walk.seen.color.iter().copied().fold(walk.seen.opacity, f64::max);
    if most >= HALF_STEP {
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
    let met = format!("the ray crosses {} cells with s from {}", walk.steps.len(), range(0));
    let met = match scene.transfer_function.uses_gradient_magnitude() {
        true => format!("{met} and g from {}", range(1)),
        false => met,
    };
    let depth: f64 = walk.steps.iter().map(|step| step.part.optical_depth).sum();
    Some(match () {
        () if scene.transfer_function.widgets.is_empty() => {
            format!("{met}; the transfer function has no widgets")
        }
        () if depth < HALF_STEP && most > 0.0 => {
            format!("{met}, where the widgets hardly absorb: an optical depth of {depth:.3e} in all")
        }
        () if depth > 0.0 => format!("{met}; silhouettes take most of its optical depth of {depth:.3e}"),
        () => format!("{met}; no widget takes any of these values"),
    })
}
