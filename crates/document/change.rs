//! Changes of parameters of a pipeline that was read: as those of a frame, which need not be written into the file.

use crate::{Edit, Path};
use voltet_core::Result;
use voltet_graph::{LinkEntry, NodeEntry, ParameterValue, SourceSpan, unknown_node};

/// A change of a parameter, or of a part of it, of a pipeline that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The node.
    pub node: String,
    /// The parameter, and keys and numbers that lead to a part of it, with points between: `widgets.0.centre`.
    pub parameter: String,
    /// Its new value; `None`: it is not stated any more.
    pub value: Option<ParameterValue>,
}

/// Begin of the name of an input in a change, in place of a parameter.
const INPUTS: &str = "inputs.";

impl Change {
    /// The change that sets a parameter.
    pub fn set(node: &str, parameter: &str, value: ParameterValue) -> Change {
        Change { node: node.into(), parameter: parameter.into(), value: Some(value) }
    }

    /// The change that lets an output (`"node"` or `"node.port"`) feed an input.
    pub fn wire(node: &str, port: &str, source: &str) -> Change {
        Change::set(node, &format!("{INPUTS}{port}"), ParameterValue::Text(source.into()))
    }

    /// The change that takes a parameter away.
    pub fn unset(node: &str, parameter: &str) -> Change {
        Change { node: node.into(), parameter: parameter.into(), value: None }
    }

    /// Carries it out on the nodes of a pipeline.
    ///
    /// # Errors
    /// - a node that there is not, a path that leads nowhere.
    pub fn apply(&self, nodes: &mut [NodeEntry]) -> Result<()> {
        let names = || nodes.iter().map(|entry| entry.name.as_str());
        let Some(place) = names().position(|name| name == self.node) else {
            return Err(unknown_node(&self.node, names()));
        };
        let entry = &mut nodes[place];
        if let (Some(port), Some(source)) = (self.parameter.strip_prefix(INPUTS), &self.value) {
            entry.inputs.retain(|link| link.port != port);
            let (origin, source) = (SourceSpan::Nowhere, source.clone().into());
            entry.inputs.push(LinkEntry { port: port.into(), origin, source });
            return Ok(());
        }
        let keys: Vec<&str> = self.parameter.split('.').collect();
        match &self.value {
            Some(value) => entry.set(keys[0], &keys[1..], value.clone().into()),
            None => {
                entry.settings.retain(|field| field.name != self.parameter);
                Ok(())
            }
        }
    }

    /// The edit of a file that says so.
    pub fn edit(&self) -> Edit {
        let (node, path) = (self.node.clone(), Path::from(self.parameter.as_str()));
        if let (Some(port), Some(ParameterValue::Text(source))) =
            (self.parameter.strip_prefix(INPUTS), &self.value)
        {
            return Edit::Connect { node, port: port.into(), source: source.clone(), beside: false };
        }
        match self.value.clone() {
            Some(value) => Edit::Set { node, path, value },
            None => Edit::Unset { node, path },
        }
    }
}
