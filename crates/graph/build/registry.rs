//! The registry of node types, gradient filters and variants of parameters: open, the same functions for those that ship, for plug-ins
//! and for a program's own.

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
        self.filters.iter().try_for_each(|filter| refuse_shared_names(node, filter.as_ref()))?;
        self.nodes.push(node);
        Ok(())
    }

    /// Adds a gradient filter. Errors as those of [`Registry::add`]; its parameters stand beside those of the node that
    /// names it, so they may not have the names of these.
    pub fn add_filter(&mut self, filter: Arc<dyn GradientFilter>) -> Result<()> {
        let known = self.filters.iter().map(|known| known.declaration().name);
        check_new("gradient filter", &filter.declaration(), known)?;
        self.nodes.iter().try_for_each(|node| refuse_shared_names(node, filter.as_ref()))?;
        self.filters.push(filter);
        Ok(())
    }

    /// Adds a variant of a parameter of type [`ParameterType::Registered`], in all nodes that have the parameter. Errors when its name
    /// is taken or its declaration contradicts itself or the nodes.
    pub fn add_variant(&mut self, parameter: &'static str, variant: Variant) -> Result<()> {
        let schema = &variant.schema;
        check_new(parameter, schema, self.variants(parameter).map(|other| other.schema.name))?;
        for node in self.nodes.iter().filter(|node| node.parameter(parameter).is_some()) {
            if let Some(shared) = schema.parameters.iter().find(|p| node.parameter(p.name).is_some()) {
                return Err(shared_name(
                    &format!("{parameter} '{}'", schema.name),
                    node,
                    shared,
                    schema.name,
                ));
            }
        }
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

    /// The node type of that name; an error that suggests the nearest otherwise.
    pub fn find(&self, name: &str) -> Result<&'static Node> {
        self.nodes.iter().copied().find(|n| n.name == name).ok_or_else(|| {
            Error::usage(format!("unknown node type '{name}'"))
                .expected(suggest(name, self.names()) + &self.plugin_list())
        })
    }

    /// The gradient filter of that name; an error that suggests the nearest otherwise.
    pub fn find_filter(&self, name: &str) -> Result<&Arc<dyn GradientFilter>> {
        self.filters.iter().find(|filter| filter.declaration().name == name).ok_or_else(|| {
            let names = self.filters.iter().map(|filter| filter.declaration().name);
            Error::usage(format!("unknown gradient filter '{name}'"))
                .expected(suggest(name, names) + &self.plugin_list())
        })
    }

    /// The clause behind the known names in an error.
    fn plugin_list(&self) -> String {
        self.plugins.as_ref().map(|clause| format!("; {clause}")).unwrap_or_default()
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

/// Refuses names that a filter and a node share: their parameters stand in one table.
fn refuse_shared_names(node: &Node, filter: &dyn GradientFilter) -> Result<()> {
    let kind = filter.declaration();
    let shared = kind.parameters.iter().find(|p| node.method().is_some() && node.parameter(p.name).is_some());
    let title = format!("gradient filter '{}'", kind.name);
    shared.map_or(Ok(()), |shared| Err(shared_name(&title, node, shared, kind.name)))
}

fn shared_name(title: &str, node: &Node, shared: &Parameter, item: &str) -> Error {
    let what = format!("the {title} declares a parameter that the node type '{}' has", node.name);
    Error::usage(what).got(shared.name).expected("a name of its own").at_item(item)
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
