//! The registry of node types: open, one function for nodes that ship and for plug-ins.

use super::declaration::{Node, Parameter, ParameterType};
use super::nearest::suggest;
use crate::{Error, Result};

/// The node types that a pipeline may name.
#[derive(Debug, Default)]
pub struct Registry {
    nodes: Vec<&'static Node>,
}

impl Registry {
    /// An empty registry.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a node type. Errors when its name is taken or its declaration contradicts itself.
    pub fn add(&mut self, node: &'static Node) -> Result<()> {
        let wrong = |what: String| Err(Error::usage(what).at_item(node.name));
        if node.name.is_empty() || node.summary.is_empty() {
            return wrong("a node type needs a name and a summary".into());
        }
        if self.nodes.iter().any(|n| n.name == node.name) {
            return wrong(format!("there is a node type '{}' already", node.name));
        }
        for ports in [node.inputs, node.optional_inputs, node.outputs] {
            if let Some(twice) = repeated(ports.iter().map(|p| p.name)) {
                return wrong(format!("the node type '{}' declares the port '{twice}' twice", node.name));
            }
        }
        check_declarations(node.name, node.parameters)?;
        self.nodes.push(node);
        Ok(())
    }

    /// The node type of that name; an error that suggests the nearest otherwise.
    pub fn find(&self, name: &str) -> Result<&'static Node> {
        self.nodes.iter().copied().find(|n| n.name == name).ok_or_else(|| {
            Error::usage(format!("unknown node type '{name}'")).accepted(suggest(name, self.names()))
        })
    }

    /// Every node type, in the order of registration.
    pub fn iter(&self) -> impl Iterator<Item = &'static Node> {
        self.nodes.iter().copied()
    }

    /// The names, in the order of registration.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.nodes.iter().map(|n| n.name)
    }
}

/// The first name that occurs twice.
fn repeated(names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let mut seen = Vec::new();
    for name in names {
        if seen.contains(&name) {
            return Some(name);
        }
        seen.push(name);
    }
    None
}

/// Names must differ and help must be there, also within tables. `type` and `inputs` belong to the file.
fn check_declarations(node: &str, parameters: &'static [Parameter]) -> Result<()> {
    if let Some(twice) = repeated(parameters.iter().map(|p| p.name).chain(["type", "inputs"])) {
        return Err(Error::usage(format!("the node type '{node}' declares '{twice}' twice")));
    }
    for parameter in parameters {
        if parameter.help.is_empty() {
            return Err(Error::usage(format!("the parameter '{}' of '{node}' has no help", parameter.name)));
        }
        match parameter.parameter_type {
            ParameterType::Table(fields) => check_declarations(node, fields)?,
            ParameterType::Kinds(kinds) => {
                kinds.iter().try_for_each(|kind| check_declarations(node, kind.parameters))?;
            }
            _ => {}
        }
    }
    Ok(())
}
