//! Something that a plug-in offers, and what runs it: this process, one of its own, or a sandbox.

use crate::describe::Declared;
use crate::outcome::{Said, Whose};
use crate::task::{Outcome, Task};
use crate::values::{Owned, array_names};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{Gradient, GradientFilter, Plugin, check_scalar};
use voltet_core::grid::Grid;
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::{NoProgress, Progress};

/// Runs the functions of one plug-in.
pub(crate) trait Runner: Send + Sync {
    /// Whose functions they are.
    fn plugin(&self) -> &Plugin;

    /// Has the plug-in do it. What it says is not judged; a check must end within seconds.
    ///
    /// Errors: nothing came back.
    fn run(&self, of: &Declared, task: Task, progress: &dyn Progress) -> Result<(Said, Outcome)>;
}

/// A filter of a plug-in.
#[derive(Clone)]
pub(crate) struct Offered {
    pub runner: Arc<dyn Runner>,
    pub declared: Declared,
}

impl Offered {
    /// How messages begin.
    pub fn whose(&self) -> Whose<'_> {
        Whose::new(&self.declared, self.runner.plugin())
    }

    /// Has the plug-in's own check look at parameters, if it has one.
    pub fn check(&self, parameters: &Parameters) -> Result<()> {
        let values = Owned::new(&self.declared, parameters)?;
        if !self.declared.checks {
            return Ok(());
        }
        let (said, _) = self.runner.run(&self.declared, Task::Check(values), &NoProgress)?;
        self.whose().checked(said)
    }

    /// Has it do its work; an error where it failed or made something else.
    pub fn run<T>(
        &self,
        task: Task,
        progress: &dyn Progress,
        made: impl FnOnce(Outcome) -> Option<T>,
    ) -> Result<(Said, T)> {
        let (said, outcome) = self.runner.run(&self.declared, task, progress)?;
        self.whose().worked(&said, progress.cancelled())?;
        let made = made(outcome).ok_or_else(|| self.whose().error("answered what was not asked"))?;
        Ok((said, made))
    }
}

impl GradientFilter for Offered {
    fn declaration(&self) -> VariantSchema {
        self.declared.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(self.runner.plugin())
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        Offered::check(self, parameters)
    }

    fn arrays(&self, parameters: &Parameters) -> Result<Vec<String>> {
        Ok(array_names(&self.declared, parameters))
    }

    fn gradient(
        &self,
        grid: &Grid,
        scalar: &[f64],
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Gradient> {
        check_scalar(grid, scalar)?;
        let task = Task::gradient(&self.declared, grid, scalar, parameters)?;
        let (said, vectors) = self.run(task, progress, Outcome::vectors)?;
        let vectors = self.whose().every_point(grid, vectors)?;
        Ok(Gradient { vectors, fallbacks: said.fallbacks })
    }
}
