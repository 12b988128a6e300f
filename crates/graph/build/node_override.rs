//! Work that a program does in place of a node's own, such as giving a grid that it holds in memory.

use crate::api::context::{Outputs, RunContext};
use std::sync::Arc;
use voltet_core::Result;

/// Work that a program does in place of a node's own. Clones are the same work: a session uses its former outputs again.
#[derive(Clone)]
pub struct NodeOverride(Arc<OverrideFn>);

type OverrideFn = dyn Fn(&mut RunContext) -> Result<Outputs> + Send + Sync;

impl NodeOverride {
    /// One value for each output that the node declares, for what is asked of it ([`RunContext::demand`]).
    pub fn new(work: impl Fn(&mut RunContext) -> Result<Outputs> + Send + Sync + 'static) -> NodeOverride {
        NodeOverride(Arc::new(work))
    }

    /// Does the work.
    pub(crate) fn run(&self, call: &mut RunContext) -> Result<Outputs> {
        (self.0)(call)
    }
}

impl PartialEq for NodeOverride {
    fn eq(&self, other: &NodeOverride) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::fmt::Debug for NodeOverride {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("NodeOverride")
    }
}
