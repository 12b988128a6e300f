//! What a program gives in place of a node's work, such as a grid that it holds in memory.

use super::builder::{Graph, GraphNode};
use super::call::{Call, Outputs};
use std::sync::Arc;
use voltet_core::parameters::suggest;
use voltet_core::{Error, Result};

/// Work that a program does in place of a node's own. Clones are the same work: a session uses its former outputs again.
#[derive(Clone)]
pub struct Given(Arc<Work>);

type Work = dyn Fn(&mut Call) -> Result<Outputs> + Send + Sync;

impl Given {
    /// One value for each output that the node declares, for what is asked of it ([`Call::demand`]).
    pub fn new(work: impl Fn(&mut Call) -> Result<Outputs> + Send + Sync + 'static) -> Given {
        Given(Arc::new(work))
    }
}

impl PartialEq for Given {
    fn eq(&self, other: &Given) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::fmt::Debug for Given {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Given")
    }
}

impl Graph {
    /// Lets a program do the work of a node; what the node's type does before a run (files, steps) stays. Errors: there is no
    /// such node.
    pub fn give(&mut self, node: &str, given: Given) -> Result<()> {
        let Some(place) = self.nodes.iter().position(|known| known.name == node) else {
            let known = suggest(node, self.nodes.iter().map(|node| node.name.as_str()));
            return Err(Error::usage(format!("there is no node '{node}'")).accepted(known));
        };
        self.nodes[place].given = Some(given);
        Ok(())
    }
}

impl GraphNode {
    /// Does the node's work, or what a program gives in its place.
    pub(super) fn run(&self, call: &mut Call) -> Result<Outputs> {
        match &self.given {
            Some(given) => (given.0)(call),
            None => (self.node.run)(call),
        }
        .map_err(|error| self.blame(error))
    }
}
