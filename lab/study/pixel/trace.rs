//! One pixel traced.

use super::record::{EnginePixel, Pixel, mean};
use super::{cells, integrators, invisible};
use crate::work_precision::Subject;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_graph::{Graph, Observer, Session, Value};
use voltet_optics::scene::Scene;
use voltet_optics::trace::TracedRay;
use voltet_reference::{REFERENCE, tracer, widget_depths};

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
    let nothing = invisible::why(&tracer, ray, &walk, &subject.scene);
    let names = ["s".to_string(), "g".into()];
    let fields = transfer_function.fields();
    Ok(Pixel {
        place,
        size: camera.size,
        samples: camera.samples,
        sample,
        ray: tracer.world(ray),
        cells: cells::source_cells(&volume.grid, &walk.steps),
        widgets: transfer_function.widgets.iter().map(|widget| widget.profile.name()).collect(),
        names: names.into_iter().chain(fields.iter().map(|name| name.to_string())).collect(),
        integrators: integrators::all(&subject.scene, &subject.integrators, &tracer, &rays, progress)?,
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
