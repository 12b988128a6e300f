//! What a program gives in place of a node's work, such as a grid that it holds in memory.

use super::builder::{Graph, GraphNode};
use super::call::{Outputs, RunContext};
use std::sync::Arc;
use voltet_core::parameters::suggest;
use voltet_core::{Error, Result};

/// Work that a program does in place of a node's own. Clones are the same work: a session uses its former outputs again.
#[derive(Clone)]
pub struct NodeOverride(Arc<Work>);

type Work = dyn Fn(&mut RunContext) -> Result<Outputs> + Send + Sync;

impl NodeOverride {
    /// One value for each output that the node declares, for what is asked of it ([`Call::demand`]).
    pub fn new(work: impl Fn(&mut RunContext) -> Result<Outputs> + Send + Sync + 'static) -> NodeOverride {
        NodeOverride(Arc::new(work))
    }
}

impl PartialEq for NodeOverride {
    fn eq(&self, other: &NodeOverride) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::fmt::Debug for NodeOverride {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Given")
    }
}

impl Graph {
    /// Lets a program do the work of a node; what the node's type does before a run (files, steps) stays. Errors: there is no
    /// such node.
    pub fn give(&mut self, node: &str, given: NodeOverride) -> Result<()> {
        let Some(place) = self.nodes.iter().position(|known| known.name == node) else {
            let known = suggest(node, self.nodes.iter().map(|node| node.name.as_str()));
            return Err(Error::usage(format!("there is no node '{node}'")).expected(known));
        };
        self.nodes[place].given = Some(given);
        Ok(())
    }
}

impl GraphNode {
    /// Does the node's work, or what a program gives in its place.
    pub(super) fn run(&self, call: &mut RunContext) -> Result<Outputs> {
        match &self.given {
            Some(given) => (given.0)(call),
            None => (self.node.run)(call),
        }
        .map_err(|error| self.locate(error))
    }
}
