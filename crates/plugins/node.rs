//! Nodes of a plug-in's filters: the shared parts.

use crate::runner::PluginItem;
use voltet_core::parameters::{DefaultValue, Parameters, VariantSchema};
use voltet_graph::Node;

/// A node with the shared fields, completed by `complete`; it lives as long as the program.
pub(crate) fn leaked_node(item: &PluginItem, complete: impl FnOnce(Node) -> Node) -> &'static Node {
    let check_item = item.clone();
    let VariantSchema { name, summary, parameters } = item.declaration.schema;
    leak(complete(Node {
        name,
        summary,
        parameters,
        plugin: Some(leak(item.runner.plugin().clone())),
        check: leak(move |parameters: &Parameters| check_item.check_parameters(parameters)),
        ..Node::BLANK
    }))
}

/// A value that lives as long as the program.
pub(crate) fn leak<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

/// Example in a pipeline file: behind the node `from` by the input `port`, and before nodes with the input `next`.
pub(crate) fn example(schema: VariantSchema, from: &str, port: &str, next: &str) -> &'static str {
    let required =
        schema.parameters.iter().filter(|parameter| matches!(parameter.default, DefaultValue::Required));
    let required: String = required.map(|parameter| format!("{} = …\n", parameter.name)).collect();
    format!(
        "# Between the node '{from}' and those that take what it gives ({next}):\n[nodes.filtered]\ntype = \"{}\"\n\
         {required}inputs = {{ {port} = \"{from}\" }}\n",
        schema.name
    )
    .leak()
}
