//! Pictures of rays that end at opaque surfaces that others draw, on the native engine.

use voltet::engine;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_graph::{Graph, Observer, Session};
use voltet_study::work_precision::Subject;

/// Progress that is told as that of a node.
pub struct Told<'a> {
    pub observer: &'a dyn Observer,
    pub node: &'a str,
}

impl Progress for Told<'_> {
    fn report(&self, stage: &str, fraction: f64) {
        self.observer.progress(self.node, stage, fraction);
    }

    fn cancelled(&self) -> bool {
        self.observer.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.observer.memory_left()
    }
}

/// Draws what the node draws, each ray as far as its end.
pub fn draw(
    graph: &Graph,
    session: &mut Session,
    node: &str,
    ends: &[f32],
    observer: &dyn Observer,
) -> Result<Picture> {
    let scene = Subject::gather(graph, Some(node), false, session, observer)?.scene;
    let progress = Told { observer, node };
    let gradient = engine::needs_gradient(&scene.shading);
    let cells = engine::cull(&scene.volume, &scene.transfer_function, &scene.camera, &progress)?;
    let cells = engine::sort(&cells, &scene.camera, scene.order)?;
    let projection = engine::project(&cells, &scene.transfer_function, &scene.camera, gradient, &progress)?;
    let ready = engine::prepare(&projection, &scene.transfer_function, &scene.shading)?;
    Ok(ready.composite_until(Some(ends), &progress)?.0)
}
