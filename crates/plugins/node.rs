//! The node that a plug-in's filter is: what all of them share.

use crate::runner::Offered;
use voltet_core::parameters::{DefaultValue, Parameters, VariantSchema};
use voltet_graph::Node;

/// A node with what every one has, completed by `own`; it lives from now on as long as the program.
pub(crate) fn leaked(offered: &Offered, own: impl FnOnce(Node) -> Node) -> &'static Node {
    let of_check = offered.clone();
    let VariantSchema { name, summary, parameters } = offered.declared.kind;
    leak(own(Node {
        name,
        summary,
        parameters,
        plugin: Some(leak(offered.runner.plugin().clone())),
        check: leak(move |parameters: &Parameters| of_check.check(parameters)),
        ..Node::BLANK
    }))
}

/// Something that lives as long as the program.
pub(crate) fn leak<T>(thing: T) -> &'static T {
    Box::leak(Box::new(thing))
}

/// How it stands in a pipeline file: between the node `from`, by its input `port`, and what takes it by `taken`.
pub(crate) fn example(kind: VariantSchema, from: &str, port: &str, taken: &str) -> &'static str {
    let required =
        kind.parameters.iter().filter(|parameter| matches!(parameter.default, DefaultValue::Required));
    let required: String = required.map(|parameter| format!("{} = …\n", parameter.name)).collect();
    format!(
        "# Between the node '{from}' and those that take what it gives ({taken}):\n[nodes.filtered]\ntype = \"{}\"\n\
         {required}inputs = {{ {port} = \"{from}\" }}\n",
        kind.name
    )
    .leak()
}
