//! `composite`: integrates every ray segment and composites the pixels.

use crate::drawing;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, counted};
use voltet_cpu::{Projection, prepare_scene};
use voltet_graph::{DemandContext, Node, Outputs, Parameter, Parameters, Port, PortType, RunContext};
use voltet_optics::engine::{RenderStats, Stage};
use voltet_optics::integrators::stated;
use voltet_optics::scene::Scene;
use voltet_simd::LaneSet;

pub const NODE: Node = Node {
    name: "composite",
    summary: "Integrates every ray segment and composites each pixel's segments front to back.",
    inputs: &[
        Port { name: "projection", port_type: PortType::Projection, summary: "the projected cells" },
        Port { name: "transfer_function", port_type: PortType::TransferFunction, summary: "what is drawn" },
    ],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &PARAMETERS,
    example: include_str!("examples/stages.toml"),
    optional_inputs: &[drawing::SURFACES],
    check: &check,
    demand: &|asking: &mut DemandContext| {
        let (engine, why) = match stated(asking.parameters)?.extension() {
            Some(engine) => (engine, drawing::registered_reason(engine)),
            None => (drawing::NATIVE, "the stages are nodes of their own, which the CPU runs".into()),
        };
        asking.notes.engine = Some((engine.name.into(), why));
        drawing::ask(asking, "projection", "transfer_function").map(drop)
    },
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 5] = {
    let [integrator, overlap, silhouette, light] = drawing::PARAMETERS;
    [integrator, overlap, silhouette, light, drawing::CLIP]
};

fn check(parameters: &Parameters) -> Result<()> {
    drawing::check(parameters)?;
    let integrator = drawing::shading(parameters)?.integrator;
    if integrator.kind().scene_preparation().is_some() {
        let name = integrator.name();
        let what = format!("the integrator '{name}' reads the grid's points, which no stage of its own has");
        let error = Error::usage(what).expected("a node of type renderer, or another integrator");
        return Err(parameters.locate("integrator", error));
    }
    Ok(())
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let projected = call.projection::<drawing::Projected>("projection")?;
    let look = call.look("transfer_function")?;
    let shading = drawing::shading(call.parameters)?;
    let revision = call.revision("projection")?;
    let cells = projected.projection.cells();
    let transfer_function = drawing::for_data(call, &look, &cells.volume, revision)?;
    if transfer_function != projected.transfer_function {
        let what = "the cells were culled for another transfer function than the one to draw";
        return Err(
            Error::usage(what).expected("the same transfer_function at the nodes of type cull and composite")
        );
    }
    drawing::note_bands(call, &cells.volume, &transfer_function)?;
    let scene = Scene {
        surfaces: call.surfaces("surfaces")?,
        clips: drawing::clips_of_data(call, |call| drawing::bounds(call, &cells.volume, revision))?,
        ..projected.scene(shading)
    };
    let picture = match shading.integrator.extension() {
        // Every projected cell is drawn.
        Some(engine) => drawing::draw_on(call, &scene, "projection", engine, false)?,
        None => composite(call, &projected.projection, &scene)?,
    };
    let cells = |_: &RunContext| Ok(projected.projection.cells().ids.clone());
    Ok(vec![drawing::image(call, &scene, picture, cells)?])
}

/// Integrates and composites on the CPU engine.
fn composite(call: &mut RunContext, projection: &Projection, scene: &Scene) -> Result<Picture> {
    let ready = call.stage(Stage::SetUp.name(), |_| prepare_scene(projection, scene))?;
    let composite = |progress: &dyn Progress| ready.composite_scene(scene, None, progress);
    let (picture, composited) = call.stage(Stage::Composite.name(), composite)?;
    let mut counts = RenderStats::default();
    composited.count(&mut counts);
    composited.note(&mut call.notes);
    drawing::note(call, &counts);
    drawing::note_unsorted(call, scene, &counts);
    // Of all stages: what the former ones left out may be the reason.
    projection.cells().count(&mut counts);
    projection.count(&mut counts);
    call.notes.warnings.extend(drawing::picture_warnings(scene, &counts, &picture));
    let threads = counted(rayon::current_num_threads(), "thread");
    call.notes.adapter = Some(format!("{}, {threads}", LaneSet::detect()?.name()));
    Ok(picture)
}
