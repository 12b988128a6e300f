//! An item that a plug-in offers, and the runner of its functions: this process, one of its own, or a sandbox.

use crate::declaration::Declaration;
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use crate::values::ParameterValues;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::parameters::Parameters;
use voltet_core::progress::{NoProgress, Progress};

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
