//! Pictures of rays that end at opaque surfaces of other renderers, on the CPU.

use voltet::render_to_depth;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{Graph, NodeProgress, Observer, Session};
use voltet_study::work_precision::Subject;

/// Renders the picture of a node, each ray up to its depth.
pub fn render(
    graph: &Graph,
    session: &mut Session,
    node: &str,
    ends: &[f32],
    observer: &dyn Observer,
) -> Result<Picture> {
    let scene = Subject::gather(graph, Some(node), false, session, observer)?.scene;
    render_to_depth(&scene, ends, &NodeProgress { observer, node })
}
