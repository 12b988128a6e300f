//! The registry of node types, gradient filters and variants of parameters: open, the same functions for those that ship, for plug-ins
//! and for a program's own.

use super::entry::NodeEntry;
use crate::api::node::Node;
use std::sync::Arc;
use voltet_core::field::GradientFilter;
use voltet_core::parameters::{
    Parameter, ParameterType, Variant, VariantSchema, refuse_contradictions, repeated, suggest,
};
use voltet_core::reading::GridReader;
use voltet_core::{Error, Result};

/// Keys of every node in a pipeline file, whatever its type.
const TAKEN: [&str; 2] = ["type", "inputs"];

/// The node types and the gradient filters that a pipeline may name.
#[derive(Default, Clone)]
pub struct Registry {
    nodes: Vec<&'static Node>,
    filters: Vec<Arc<dyn GradientFilter>>,
    /// Each with the parameter that it is registered for.
    variants: Vec<(&'static str, Variant)>,
    aliases: Vec<VariantAlias>,
    plugins: Option<String>,
}

/// A former name of a variant.
#[derive(Debug, Clone, Copy)]
pub struct VariantAlias {
    /// The parameter whose variant it is.
    pub parameter: &'static str,
    /// The former name.
    pub alias: &'static str,
    /// The name of the variant.
    pub name: &'static str,
}

impl Registry {
    /// An empty registry.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a node type. Errors when its name is taken or its declaration contradicts itself.
    pub fn add(&mut self, node: &'static Node) -> Result<()> {
        let wrong = |what: String| Err(Error::usage(what).at_item(node.name));
        let schema = VariantSchema { name: node.name, summary: node.summary, parameters: node.parameters };
        check_new("node type", &schema, self.names())?;
        for ports in [node.inputs, node.optional_inputs, node.outputs] {
            if let Some(twice) = repeated(ports.iter().map(|p| p.name)) {
                return wrong(format!("the node type '{}' declares the port '{twice}' twice", node.name));
            }
        }
        let methods =
            node.parameters.iter().filter(|p| matches!(p.parameter_type, ParameterType::GradientFilter));
        if methods.count() > 1 {
            return wrong(format!("the node type '{}' names several gradient filters", node.name));
        }
        let filters = self.filters.iter().filter(|_| node.method().is_some());
        filters
            .map(|filter| filter.declaration())
            .try_for_each(|filter| refuse_shared_names("gradient filter", &filter, node))?;
        self.nodes.push(node);
        Ok(())
    }

    /// Adds a gradient filter. Errors as those of [`Registry::add`]; its parameters stand beside those of the node that
    /// names it, so they may not have the names of these.
    pub fn add_filter(&mut self, filter: Arc<dyn GradientFilter>) -> Result<()> {
        let (sort, schema) = ("gradient filter", filter.declaration());
        check_new(sort, &schema, self.filters.iter().map(|known| known.declaration().name))?;
        let mut nodes = self.nodes.iter().filter(|node| node.method().is_some());
        nodes.try_for_each(|node| refuse_shared_names(sort, &schema, node))?;
        self.filters.push(filter);
        Ok(())
    }

    /// Adds a variant of a parameter of type [`ParameterType::Registered`], in all nodes that have the parameter. Errors when its name
    /// is taken or its declaration contradicts itself or the nodes.
    pub fn add_variant(&mut self, parameter: &'static str, variant: Variant) -> Result<()> {
        let schema = &variant.schema;
        check_new(parameter, schema, self.variants(parameter).map(|other| other.schema.name))?;
        let mut nodes = self.nodes.iter().filter(|node| node.parameter(parameter).is_some());
        nodes.try_for_each(|node| refuse_shared_names(parameter, schema, node))?;
        self.variants.push((parameter, variant));
        Ok(())
    }

    /// Adds a former name of a variant; a pipeline that has it gets a note.
    pub fn add_alias(&mut self, alias: VariantAlias) {
        self.aliases.push(alias);
    }

    /// The variants of a parameter, in the order of registration.
    pub fn variants(&self, parameter: &str) -> impl Iterator<Item = &Variant> {
        self.variants.iter().filter(move |(name, _)| *name == parameter).map(|(_, variant)| variant)
    }

    /// The former name of a variant that a parameter has, if it is one.
    pub(super) fn alias(&self, parameter: &str, word: &str) -> Option<&VariantAlias> {
        self.aliases.iter().find(|alias| alias.parameter == parameter && alias.alias == word)
    }

    /// The parameters that a node declares, and those of the variants of one of them; several variants may have the parameter, and
    /// that of the variant with the name `chosen` goes first.
    pub fn parameters(&self, node: &Node, chosen: Option<&str>) -> Vec<Parameter> {
        let mut parameters = node.parameters.to_vec();
        let Some(registered) = node.registered_parameter() else { return parameters };
        let (first, others): (Vec<&Variant>, Vec<&Variant>) =
            self.variants(registered.name).partition(|variant| Some(variant.schema.name) == chosen);
        for parameter in first.iter().chain(&others).flat_map(|variant| variant.schema.parameters) {
            if parameters.iter().all(|other| other.name != parameter.name) {
                parameters.push(*parameter);
            }
        }
        parameters
    }

    /// Names the plug-ins that were searched, for the error about an unknown filter or node type; a clause.
    pub fn tell_plugins(&mut self, clause: String) {
        self.plugins = Some(clause);
    }

    /// The clause that names the plug-ins that were searched.
    pub fn told_plugins(&self) -> Option<&str> {
        self.plugins.as_deref()
    }

    /// The node type of that name; an error that suggests the nearest otherwise.
    pub fn find(&self, name: &str) -> Result<&'static Node> {
        let found = self.nodes.iter().copied().find(|n| n.name == name);
        found.ok_or_else(|| self.unknown("node type", name, self.names()))
    }

    /// The type of a node; `None` where it states none that is known.
    pub fn node_type(&self, entry: &NodeEntry) -> Option<&'static Node> {
        let name = entry.node_type.text()?;
        self.nodes.iter().copied().find(|node| node.name == name)
    }

    /// The gradient filter of that name; an error that suggests the nearest otherwise.
    pub fn find_filter(&self, name: &str) -> Result<&Arc<dyn GradientFilter>> {
        let names = self.filters.iter().map(|filter| filter.declaration().name);
        let found = self.filters.iter().find(|filter| filter.declaration().name == name);
        found.ok_or_else(|| self.unknown("gradient filter", name, names))
    }

    fn unknown<'a>(&self, sort: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Error {
        let plugins = self.plugins.as_ref().map(|clause| format!("; {clause}")).unwrap_or_default();
        Error::usage(format!("unknown {sort} '{name}'")).expected(suggest(name, known) + &plugins)
    }

    /// Every node type, in the order of registration.
    pub fn iter(&self) -> impl Iterator<Item = &'static Node> {
        self.nodes.iter().copied()
    }

    /// The names of the node types, in the order of registration.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.nodes.iter().map(|n| n.name)
    }

    /// The formats that come from outside, with their nodes, in the order of registration.
    pub fn readers(&self) -> impl Iterator<Item = (&'static Node, &'static dyn GridReader)> {
        self.nodes.iter().filter_map(|node| Some((*node, node.reader?)))
    }

    /// Every gradient filter, in the order of registration.
    pub fn filters(&self) -> impl Iterator<Item = &Arc<dyn GradientFilter>> {
        self.filters.iter()
    }
}

/// Refuses names that a filter or a variant and a node share: their parameters stand in one table. `sort`: what it is, for messages.
fn refuse_shared_names(sort: &str, schema: &VariantSchema, node: &Node) -> Result<()> {
    let shared = schema.parameters.iter().find(|p| node.parameter(p.name).is_some());
    let Some(shared) = shared else { return Ok(()) };
    let VariantSchema { name, .. } = *schema;
    let what = format!("the {sort} '{name}' declares a parameter that the node type '{}' has", node.name);
    Err(Error::usage(what).got(shared.name).expected("a name of its own").at_item(name))
}

/// Refuses a node type, filter or variant without name or summary, with a name that is `taken`, or with parameters that contradict
/// themselves. `sort`: what it is, for messages.
fn check_new<'a>(sort: &str, schema: &VariantSchema, mut taken: impl Iterator<Item = &'a str>) -> Result<()> {
    let VariantSchema { name, summary, parameters } = *schema;
    let wrong = |what: String| Err(Error::usage(what).at_item(name));
    if name.is_empty() || summary.is_empty() {
        return wrong(format!("the {sort} '{name}' needs a name and a summary"));
    }
    if taken.any(|known| known == name) {
        let article = if sort.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
        return wrong(format!("there is {article} {sort} '{name}' already"));
    }
    refuse_contradictions(&format!("the {sort} '{name}'"), parameters, &TAKEN)
}
