//! An item that a plug-in offers: the runner of its functions (this process, one of its own, or a sandbox), and the node made of it.

use crate::declaration::Declaration;
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use crate::values::ParameterValues;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::parameters::{DefaultValue, Parameters, VariantSchema};
use voltet_core::progress::{NoProgress, Progress};
use voltet_graph::Node;

/// Runner of the functions of one plug-in.
pub(crate) trait Runner: Send + Sync {
    fn plugin(&self) -> &Plugin;

    /// Runs a task of an item. A check of parameters is given up after seconds. The status is not judged.
    ///
    /// Errors: nothing came back.
    fn run(
        &self,
        declaration: &Declaration,
        task: Box<dyn Task>,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)>;
}

/// A filter or reader of a plug-in.
#[derive(Clone)]
pub(crate) struct PluginItem {
    pub runner: Arc<dyn Runner>,
    pub declaration: Declaration,
}

impl PluginItem {
    /// Items of one plug-in.
    pub fn list(runner: Arc<dyn Runner>, declarations: Vec<Declaration>) -> Vec<PluginItem> {
        let item = |declaration| PluginItem { runner: runner.clone(), declaration };
        declarations.into_iter().map(item).collect()
    }

    /// Beginning of messages.
    pub fn label(&self) -> CallLabel<'_> {
        CallLabel::new(&self.declaration, self.runner.plugin())
    }

    /// Errors: the plug-in's own check, if it has one, refuses the parameters.
    pub fn check_parameters(&self, parameters: &Parameters) -> Result<()> {
        let values = ParameterValues::new(&self.declaration, parameters)?;
        if !self.declaration.checks {
            return Ok(());
        }
        let (status, _) = self.runner.run(&self.declaration, Box::new(CheckTask { values }), &NoProgress)?;
        self.label().check_parameters(status)
    }

    /// Runs a task. `output`: takes the output of the right kind.
    ///
    /// Errors: the call failed, or gave output of another kind.
    pub fn run<T>(
        &self,
        task: Box<dyn Task>,
        progress: &dyn Progress,
        output: impl FnOnce(Outcome) -> Option<T>,
    ) -> Result<(CallStatus, T)> {
        let (status, outcome) = self.runner.run(&self.declaration, task, progress)?;
        self.label().check_call(&status, progress.cancelled())?;
        let output = output(outcome).ok_or_else(|| self.label().error("answered what was not asked"))?;
        Ok((status, output))
    }
}

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
