//! A gradient filter that runs in a process of its own.

use super::conversation::{End, hold};
use super::messages::{Answer, Request, failure};
use crate::describe::Declared;
use crate::library::state_of;
use crate::outcome::{Said, Whose};
use crate::values::{Owned, array_names};
use crate::work::Given;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::{Gradient, GradientFilter, Plugin, check_scalar};
use voltet_core::glam::DVec3;
use voltet_core::grid::Grid;
use voltet_core::parameters::{Kind, Parameters};
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// How long describing and checking may take.
const PATIENCE: Duration = Duration::from_secs(30);

/// A filter of a library that another process loads.
struct Remote {
    program: Arc<Path>,
    plugin: Arc<Plugin>,
    declared: Declared,
}

/// The filters of the library at `path`, which run in processes of `program`.
pub(crate) fn load(path: &Path, program: PathBuf) -> Result<Vec<Arc<dyn GradientFilter>>> {
    let (stated, _) = state_of(path)?;
    let start = Instant::now();
    let broken = |how: String| {
        Error::usage("the plug-in cannot be loaded").found(format!("its process {how}")).in_file(path)
    };
    let end = hold(&program, path, &Request::Describe, |_| start.elapsed() < PATIENCE);
    let answers = match end {
        End::Answered(answers) => answers,
        End::GivenUp => return Err(broken(format!("did not begin within {} s", PATIENCE.as_secs()))),
        End::Broken(how) => return Err(broken(how)),
    };
    let ([name, version], filters) = match answers.into_iter().next() {
        Some(Answer::Described(plugin, filters)) => (plugin, filters),
        Some(Answer::Failed(texts)) => return failure(texts).map_err(|error| error.in_file(path)),
        Some(Answer::Said(_) | Answer::Vectors(_) | Answer::Progress(_)) | None => {
            return Err(broken("did not describe it".into()));
        }
    };
    let (plugin, program) = (Arc::new(Plugin { name, version, ..stated }), Arc::<Path>::from(program));
    let remote =
        |declared| Arc::new(Remote { program: program.clone(), plugin: plugin.clone(), declared }) as _;
    Ok(filters.into_iter().map(remote).collect())
}

impl Remote {
    fn whose(&self) -> Whose<'_> {
        Whose { filter: self.declared.kind.name, plugin: &self.plugin }
    }

    /// What the process says to a request; `None` where it was given up.
    fn ask(&self, request: &Request, waits: impl FnMut(f64) -> bool) -> Result<Option<(Said, Vec<DVec3>)>> {
        let (now, _) = state_of(&self.plugin.path)?;
        if now.fingerprint != self.plugin.fingerprint {
            let error = self.whose().error("is not the one that was described: its file has changed");
            return Err(error.accepted("the program begun again"));
        }
        let broken =
            |how: String| self.whose().error(&how).accepted("a plug-in that answers; the program goes on");
        let answers = match hold(&self.program, &self.plugin.path, request, waits) {
            End::Answered(answers) => answers,
            End::GivenUp => return Ok(None),
            End::Broken(how) => return Err(broken(how)),
        };
        let mut answers = answers.into_iter();
        match (answers.next(), answers.next()) {
            (Some(Answer::Said(said)), Some(Answer::Vectors(vectors))) => Ok(Some((said, vectors))),
            (Some(Answer::Said(said)), None) => Ok(Some((said, Vec::new()))),
            (Some(Answer::Failed(texts)), _) => {
                failure(texts).map_err(|error| error.in_file(&self.plugin.path))
            }
            _ => Err(broken("did not answer".into())),
        }
    }
}

impl GradientFilter for Remote {
    fn declaration(&self) -> Kind {
        self.declared.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(&self.plugin)
    }

    fn check(&self, parameters: &Parameters) -> Result<()> {
        let values = Owned::new(&self.declared, parameters)?;
        if !self.declared.checks {
            return Ok(());
        }
        let start = Instant::now();
        let request = Request::Check(self.declared.kind.name.into(), values);
        match self.ask(&request, |_| start.elapsed() < PATIENCE)? {
            Some((said, _)) => self.whose().checked(said),
            None => Err(self.whose().error("does not come back from checking its parameters")),
        }
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
        let given = Given::new(&self.declared, grid, scalar, parameters)?;
        let request = Request::Gradient(self.declared.kind.name.into(), Box::new(given));
        let answered = self.ask(&request, |fraction| {
            progress.report("gradient", fraction);
            !progress.cancelled()
        })?;
        match answered {
            Some((said, vectors)) => self.whose().gradient(grid, said, vectors, progress.cancelled()),
            None => Err(Error::cancelled()),
        }
    }
}
