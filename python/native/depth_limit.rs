//! Pictures of rays that end at opaque surfaces of other renderers, on the CPU.

use voltet::render_to_depth;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_graph::{Graph, Observer, Session};
use voltet_study::work_precision::Subject;

/// Progress that is reported as that of a node.
pub struct NodeProgress<'a> {
    pub observer: &'a dyn Observer,
    pub node: &'a str,
}

impl Progress for NodeProgress<'_> {
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
